//! What a user can ask of the tools, as values; carried out in `chosen/`.

use glam::{DVec2, DVec3};

use editor::rows::Row;
use editor::tools::{Act, Choose};
use scene::{Arrangement, BoxId};

/// One wish of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum ToolCommand {
    /// Chooses these boxes.
    Choose(Vec<BoxId>, Choose),
    /// Chooses every box.
    ChooseAll,
    /// Chooses none.
    ChooseNone,
    /// Chooses the boxes that are not chosen.
    ChooseOthers,
    /// Deletes the chosen boxes, or the chosen voxels.
    Delete,
    /// Copies the chosen boxes beside themselves.
    Duplicate,
    /// Takes the chosen boxes along.
    Copy,
    /// The same, and deletes them.
    Cut,
    /// Puts down what was taken along: at the pointer over the bird's-eye view, else beside where it was.
    Paste,
    /// Puts it down at a place of the ground, world frame, m.
    PasteAt(DVec2),
    /// Groups, hides or locks what is chosen, or the opposite.
    Arrange(Arrangement),
    /// Hides all boxes that are not chosen.
    HideOthers,
    /// Shows everything that is hidden.
    ShowAll,
    /// Unlocks everything.
    UnlockAll,
    /// Shifts the chosen boxes in the ego frame, m.
    Nudge(DVec3),
    /// Turns the chosen boxes counter-clockwise, degrees.
    Turn(f64),
    /// Opens the dialog of rows.
    AskRow,
    /// Adds rows of copies of the chosen boxes.
    Row(Row),
    /// Mirrors the chosen boxes about the ego x axis; true adds mirrored copies instead.
    Mirror(bool),
    /// Lets the chosen boxes stand on the ground.
    DropToGround,
    /// Fits the chosen boxes to their voxels.
    Fit,
    /// Puts the chosen boxes on the middle of their lane, in its direction.
    ToLane,
    /// What a tool made of an event, or of an option that was set.
    Act(Act),
    /// The action of a tool of that name: takes it, or changes how it is used.
    Shortcut(&'static str),
    /// Of the tools for things.
    Thing(super::things::ThingCommand),
}

impl ToolCommand {
    /// Chooses the box that was clicked, or nothing; with Shift it joins what is chosen, or leaves it.
    pub fn clicked(id: Option<BoxId>, shift: bool) -> Self {
        let how = if shift { Choose::Toggle } else { Choose::Only };
        Self::Choose(id.into_iter().collect(), how)
    }
}
