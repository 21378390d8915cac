//! What a user can ask of the tools for things, as values; carried out in `execute.rs`.

use crate::tools::Choose;
use editor::Edit;
use scene::ThingId;

use super::{Pointer, ThingKind};

/// One wish of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum ThingCommand {
    /// The pointer moved with a tool for things in hand.
    Pointer(Pointer),
    /// Ends what is drawn point by point.
    Finish,
    /// Takes its last point back.
    DropPoint,
    /// Drops all of it.
    Abandon,
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
