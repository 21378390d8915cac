//! The tools of the window: what they hold, what they do in either view, their options.

pub mod bev;
pub mod bev_draw;
mod boxes;
pub mod command;
pub mod dialogs;
pub mod gizmo;
pub mod options;
pub mod panel;
pub mod things;
pub mod view3d;
pub mod view3d_things;

pub use command::{Choose, ToolCommand};
pub use options::{PaintShape, RegionShape, ToolState, VoxelMode};
