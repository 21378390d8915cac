//! What a tool answers: what becomes of the document, and whether it goes on.

use glam::DVec2;

use crate::Edit;
use crate::document::Label;
use scene::Form;

/// One thing that should happen, in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Act {
    /// Shows edits on top of the state in which the drag began.
    Preview(Vec<Edit>),
    /// The same; what cannot be is not shown, and is said when the button comes up.
    Try(Vec<Edit>),
    /// Ends the drag as one undo step of this name.
    Commit(Label),
    /// Ends the drag without a change.
    Cancel,
    /// Applies edits as one undo step of this name.
    Apply(Label, Vec<Edit>),
    /// Applies edits that add boxes, and chooses these.
    AddBoxes(Label, Vec<Edit>, Vec<scene::BoxId>),
    /// Adds things (ego frame) as one undo step, and chooses them.
    AddThings(Vec<Form>),
    /// Marks an area to inpaint, or takes the mark away.
    Mark(Area, bool),
    /// Says something to the user.
    Note(String),
    /// Runs the action of that name, as its key would.
    Ask(&'static str),
}

/// A part of the ground, ego frame, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Area {
    /// From corner to corner.
    Rect(DVec2, DVec2),
    /// What an outline goes around.
    Outline(Vec<DVec2>),
    /// What a brush of that width passes on its way.
    Stroke(DVec2, DVec2, f64),
    /// All of the map.
    All,
}

/// What comes of an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// What should happen.
    pub acts: Vec<Act>,
    /// A key or turn of the wheel was meant for the tool, and is nobody else's.
    pub taken: bool,
    /// After a press: the tool follows the pointer until the button comes up.
    pub holds: bool,
    /// After a key: the drag is over though the button is still down.
    pub done: bool,
}

impl Response {
    /// Nothing.
    pub fn none() -> Self {
        Self::default()
    }

    /// The tool follows the pointer.
    pub fn hold() -> Self {
        Self {
            holds: true,
            ..Self::default()
        }
    }

    /// The key was the tool's.
    pub fn taken() -> Self {
        Self {
            taken: true,
            ..Self::default()
        }
    }

    /// One act.
    pub fn act(act: Act) -> Self {
        Self::default().and(act)
    }

    /// One act more.
    pub fn and(mut self, act: Act) -> Self {
        self.acts.push(act);
        self
    }

    /// Acts more.
    pub fn with(mut self, acts: impl IntoIterator<Item = Act>) -> Self {
        self.acts.extend(acts);
        self
    }
}
