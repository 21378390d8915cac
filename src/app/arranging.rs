//! Edits that group, hide and lock objects.

use editor::Edit;
use scene::{Arrangement, Members};

/// The edit that arranges some objects.
pub(crate) fn arranging(members: &Members, how: Arrangement) -> Edit {
    Edit::Arrange {
        boxes: members.boxes.iter().copied().collect(),
        things: members.things.iter().copied().collect(),
        how,
    }
}

/// The name of the undo step.
pub(crate) fn label(how: &Arrangement) -> &'static str {
    match how {
        Arrangement::Hide => "Hide",
        Arrangement::Show => "Show",
        Arrangement::Lock => "Lock",
        Arrangement::Unlock => "Unlock",
        Arrangement::Group { .. } => "Group",
        Arrangement::Ungroup => "Ungroup",
    }
}
