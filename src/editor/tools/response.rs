//! Response of a tool to an event: changes of the document, and whether the drag goes on.

use glam::DVec2;

use crate::Edit;
use crate::document::Label;
use scene::Form;

/// One act for the caller to carry out, in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Act {
    /// Shows edits on top of the state in which the drag began.
    Preview(Vec<Edit>),
    /// Like `Preview`; edits that fail show nothing, and the error is reported when the button comes up.
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
    Mark(InpaintArea, bool),
    /// Says something to the user.
    Note(String),
    /// Runs the action of that name, as its key would.
    Ask(&'static str),
}

/// A part of the ground, ego frame, m.
#[derive(Clone, Debug, PartialEq)]
pub enum InpaintArea {
    /// From corner to corner.
    Rect(DVec2, DVec2),
    /// Inside of an outline.
    Outline(Vec<DVec2>),
    /// Stroke of a brush from the first point to the second, of that width.
    Stroke(DVec2, DVec2, f64),
    /// All of the map.
    All,
}

/// Response of a tool to an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// Acts to carry out.
    pub acts: Vec<Act>,
    /// True if a key or turn of the wheel was meant for the tool, so that no other handler gets it.
    pub taken: bool,
    /// After a press: the tool follows the pointer until the button comes up.
    pub holds: bool,
    /// After a key: the drag is over though the button is still down.
    pub done: bool,
}

impl Response {
    /// No response.
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

    /// Tells that the tool took the key.
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

    /// Adds one act.
    pub fn and(mut self, act: Act) -> Self {
        self.acts.push(act);
        self
    }

    /// Adds several acts.
    pub fn with(mut self, acts: impl IntoIterator<Item = Act>) -> Self {
        self.acts.extend(acts);
        self
    }
}
