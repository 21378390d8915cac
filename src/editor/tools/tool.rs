//! Tools: their names, their rows of the table, and the state machine that each of them is.

use std::borrow::Cow;
use std::fmt::Debug;

use glam::DVec2;

use scene::Frame;

use super::{Act, Context, Event, Hand, ReadonlyContext, Response, ToolMark, ToolOption, Value, ViewKind};

/// Name of a tool; the action that takes the tool has the same name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ToolId(pub &'static str);

impl ToolId {
    /// The tool in hand at first.
    pub const SELECT: Self = Self("select_tool");
    /// The one that paints the map.
    pub const BRUSH: Self = Self("brush_tool");
    /// The one whose brush has a size in voxels.
    pub const VOXEL: Self = Self("voxel_brush");
}

/// A row of the table.
#[derive(Debug)]
pub struct ToolDef {
    /// Its name.
    pub id: ToolId,
    /// For a person.
    pub title: &'static str,
    /// Text of the tool bar for its key.
    pub key: &'static str,
    /// Name of its icon.
    pub icon: &'static str,
    /// Its part of the tool bar.
    pub group: ToolGroup,
    /// True for a brush: the keys for size change the brush, not the height of things.
    pub is_brush: bool,
    /// True if it paints the map or voxels: its letter keys work even if objects are chosen.
    pub paints: bool,
    /// Actions that take it, one for each way of using it.
    pub shortcuts: &'static [Shortcut],
    /// Makes the tool, in its initial state.
    pub make: fn() -> Box<dyn Tool>,
}

/// A part of the bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolGroup {
    /// For the map, boxes and voxels.
    Scene,
    /// For things beside the road.
    Beside,
}

/// An action that takes a tool, or changes how it is used.
#[derive(Debug)]
pub struct Shortcut {
    /// Its name in key files.
    pub id: &'static str,
    /// For a person.
    pub title: &'static str,
    /// Default chords, separated by blanks.
    pub keys: &'static str,
    /// Condition under which its chords count.
    pub when: When,
    /// Change of the hand: mostly it takes the tool.
    pub set: fn(&mut Hand),
}

/// Condition under which the chords of a shortcut count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Always.
    Always,
    /// With the pointer over the 3D view.
    OverSpace,
    /// While objects are chosen and no brush is in hand.
    Chosen,
}

/// Shape of the pointer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cursor {
    /// An arrow.
    #[default]
    Default,
    /// A cross.
    Crosshair,
    /// Hidden: the drawn marks show where it is.
    Hidden,
    /// No action is possible here.
    Forbidden,
    /// A click chooses an object here.
    Pointing,
    /// A drag moves an object here.
    Move,
    /// A drag turns an object here.
    Turn,
}

/// Hint for the mouse buttons, in a few parts.
pub type Hint = Vec<Cow<'static, str>>;

/// Parts of a hint that do not change.
pub fn hint_of(parts: &[&'static str]) -> Hint {
    parts.iter().map(|p| Cow::Borrowed(*p)).collect()
}

/// State machine of a tool, driven by pointer and keys.
pub trait Tool: Debug + Send {
    /// Handles an event.
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response;

    /// The hint for buttons and held keys, as they count in the view under the pointer.
    fn hint(&self, hand: &Hand, view: Option<ViewKind>) -> Hint;

    /// The cursor over a view.
    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor;

    /// Marks to draw over a view.
    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let _ = sight;
        Vec::new()
    }

    /// Its options, as they are.
    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        let _ = hand;
        Vec::new()
    }

    /// The user set an option.
    fn set(&mut self, hand: &mut Hand, frame: &Frame, id: &str, value: Value) -> Vec<Act> {
        let _ = (hand, frame, id, value);
        Vec::new()
    }

    /// Points set so far of a form that is drawn or measured point by point, ego frame, m.
    fn points_m(&self) -> &[DVec2] {
        &[]
    }

    /// The view in which the tool draws point by point, if it is only one: keys for points are sent there.
    fn draws_in(&self) -> Option<ViewKind> {
        None
    }

    /// The keys that it wants now.
    fn wants(&self) -> Wants {
        match self.points_m().is_empty() {
            true => Wants::Nothing,
            false => Wants::Points,
        }
    }

    /// Called when another tool is taken, or this one again.
    fn put_down(&mut self) {}

    /// Called when the tool will be used in another way: drops the points set so far.
    fn restart(&mut self) {}
}

/// Keys that a tool wants beside the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wants {
    /// No key.
    Nothing,
    /// Escape alone.
    Escape,
    /// Escape, Enter, Backspace and the double click.
    Points,
    /// Axes, digits, Enter and Backspace.
    Drag,
    /// The wheel.
    Wheel,
}
