//! The tools: each is one file with a state machine that knows no window. Plain events go in, edits come out; marks and
//! options are data. A new tool takes its file and its line in [`all`].

pub mod add_box;
pub mod beside;
pub mod brush;
pub mod circle;
mod corners;
mod hand;
mod mark;
pub mod measure;
mod modes;
mod paints;
pub mod path;
mod rays;
pub mod region;
mod response;
pub mod road;
pub mod saved;
pub mod select;
pub mod setting;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod tool;
mod toolbox;
mod view;
pub mod voxel;

pub use hand::{Choose, DRAW_ORDER, Hand, lane_heading};
pub use mark::{At, Role, ToolMark};
pub use modes::{ChooseBy, PaintShape, RegionShape, VoxelMode, VoxelTip, VoxelVerb};
pub use response::{Act, InpaintArea, Response};
pub use setting::{ToolOption, Value};
pub use tool::{Cursor, Hint, Shortcut, Tool, ToolDef, ToolGroup, ToolId, Wants, When, hint_of};
pub use toolbox::Toolbox;
pub use view::{
    CLICK_SLACK, Context, Event, HANDLE_REACH, Key, Modifiers, Pointer, ReadonlyContext, ScreenProjection,
    ViewKind, farthest_m, point_of,
};

/// The table: one line for each tool, in the order of the bar.
static TOOLS: &[&ToolDef] = &[
    &select::DEF,
    &brush::DEF,
    &circle::DEF,
    &add_box::DEF,
    &voxel::DEF,
    &measure::DEF,
    &region::DEF,
    &road::DEF,
    &path::DEF,
    &beside::building::DEF,
    &beside::tree::DEF,
    &beside::line::DEF,
    &beside::shrubs::DEF,
    &beside::post::DEF,
];

/// Every tool, in the order of the bar.
pub fn all() -> &'static [&'static ToolDef] {
    TOOLS
}

impl ToolId {
    /// The table's row of this tool; the first tool for an unknown name.
    pub fn def(self) -> &'static ToolDef {
        let tools = all();
        tools.iter().find(|t| t.id == self).unwrap_or(&tools[0])
    }
}

/// The shortcut of that name, and its tool.
pub fn shortcut(id: &str) -> Option<(&'static ToolDef, &'static Shortcut)> {
    let of = |tool: &&'static ToolDef| Some((*tool, tool.shortcuts.iter().find(|s| s.id == id)?));
    all().iter().find_map(of)
}
