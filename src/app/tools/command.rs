//! Commands of the user for the tools, as values; carried out in `chosen/`.

use glam::{DVec2, DVec3};

use editor::rows::CopyRows;
use editor::tools::{Act, Choose};
use scene::{Arrangement, BoxId};

/// One command for the tools.
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
    /// Copies the chosen boxes to the clipboard.
    Copy,
    /// Copies the chosen boxes to the clipboard and deletes them.
    Cut,
    /// Pastes from the clipboard: at the pointer over the bird's-eye view, else beside the originals.
    Paste,
    /// Pastes at a place of the ground, world frame, m.
    PasteAt(DVec2),
    /// Groups, hides or locks the selection, or undoes that.
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
    Row(CopyRows),
    /// Mirrors the chosen boxes about the ego x axis; true adds mirrored copies instead.
    Mirror(bool),
    /// Puts the chosen boxes on the ground.
    DropToGround,
    /// Fits the chosen boxes to their voxels.
    Fit,
    /// Puts the chosen boxes on the centre line of their lane, in its direction.
    ToLane,
    /// An act of a tool, from an event or from an option that was set.
    Act(Act),
    /// A shortcut of a tool, by its id: takes the tool, or changes its options.
    Shortcut(&'static str),
    /// A command of the tools for things.
    Thing(super::things::ThingCommand),
}

impl ToolCommand {
    /// Chooses the clicked box, or none; with Shift, adds it to the selection or removes it.
    pub fn clicked(id: Option<BoxId>, shift: bool) -> Self {
        let how = if shift { Choose::Toggle } else { Choose::Only };
        Self::Choose(id.into_iter().collect(), how)
    }
}
