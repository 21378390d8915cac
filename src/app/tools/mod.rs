//! The window's part of the tools: commands besides the pointer, options as rows of controls, and state that the editor
//! does not have. This module does not use the canvases, the panes or the application.

pub mod command;
pub mod option_rows;
mod state;
pub mod things;

pub use command::ToolCommand;
pub use editor::tools::{Choose, Hand, PaintShape, RegionShape, ToolId, Toolbox, VoxelMode, VoxelVerb};
pub use state::ToolState;
