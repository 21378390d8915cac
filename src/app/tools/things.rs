//! What a user can ask of the tools for things, as values; carried out in `chosen/things.rs`.

use editor::Edit;
use editor::tools::Choose;
use scene::ThingId;

pub use editor::tools::beside::{ThingKind, ThingState, building, line, post, shrubs, tree, words};

/// One wish of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum ThingCommand {
    /// Chooses things.
    Choose(Vec<ThingId>, Choose),
    /// Makes the chosen things higher by a step (1), or lower (-1): a storey, or half a metre.
    Raise(i32),
    /// Applies edits as one undo step of this name.
    Apply(String, Vec<Edit>),
    /// Ends a drag as one undo step of this name.
    Commit(String),
    /// Takes a tool with a kind.
    Take(ThingKind),
    /// Shows or hides the outlines.
    ToggleShown,
    /// Locks or unlocks the things.
    ToggleLocked,
}
