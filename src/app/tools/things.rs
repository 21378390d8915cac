//! Commands of the user for the tools for things, as values; carried out in `chosen/things.rs`.

use editor::Edit;
use editor::tools::Choose;
use scene::ThingId;

pub use editor::tools::beside::{ThingKind, ThingState, building, line, post, shrubs, tree, words};

/// One command for the tools for things.
#[derive(Clone, Debug, PartialEq)]
pub enum ThingCommand {
    /// Chooses things.
    Choose(Vec<ThingId>, Choose),
    /// Raises the chosen things by a step (1), or lowers them (-1): a storey, or half a metre.
    Raise(i32),
    /// Applies edits as one undo step of this name.
    Apply(String, Vec<Edit>),
    /// Ends a drag as one undo step of this name.
    Commit(String),
    /// Takes the tool for a kind of thing.
    Take(ThingKind),
    /// Shows or hides the outlines.
    ToggleShown,
    /// Locks or unlocks the things.
    ToggleLocked,
}
