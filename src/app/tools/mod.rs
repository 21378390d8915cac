//! What the window adds to the tools of the editor: what a user can ask beside the pointer, their options as rows of controls, and
//! what they hold that the editor does not know. Nothing here knows the canvases, the panes or the application.

pub mod command;
pub mod option_rows;
mod state;
pub mod things;

pub use command::ToolCommand;
pub use editor::tools::{Choose, Hand, PaintShape, RegionShape, ToolId, Toolbox, VoxelMode, VoxelVerb};
pub use state::ToolState;
