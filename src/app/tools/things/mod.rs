//! The tools for things beside the road: what they hold, how they draw, what becomes of what is chosen. Each tool is a
//! state machine of its own that knows no window; both large views feed it the pointer.

pub mod building;
pub mod carry;
pub mod command;
pub mod draft;
pub mod drag;
pub mod draw;
pub mod execute;
pub mod line;
pub mod options;
pub mod panel;
pub mod post;
pub mod press;
pub mod shrubs;
pub mod trees;
pub mod words;

pub use command::ThingCommand;
pub use draft::{Draft, Outcome, Phase, Pointer, Site};
pub use options::{ThingKind, ThingState, ThingTool};
