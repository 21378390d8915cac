//! Assistants and scripts drive the editor: one vocabulary of typed calls on one document. `sceneloom session` speaks it as
//! JSON lines, `sceneloom mcp` as an MCP server. No call runs code, and none reaches a file outside one folder.

mod call;
pub mod calls;
mod change;
mod desk;
mod folder;
mod lines;
mod mcp;
pub mod render;
pub mod schema;
mod service;
mod session;
mod window;

pub use call::{Answer, Call, CallDef, Operation, Receipt, find, table};
pub use change::{Change, Counts, Gained, changed_voxels, gained_and_lost};
pub use desk::{Desk, Done, Holder, Stop, Task};
pub use folder::{FileEntry, Folder};
pub use mcp::{Http, http, random_token, stdio};
pub use service::{Busy, MOST_WAITING, Service};
pub use session::session;
pub use window::{PORT, WindowDoor};

/// Bytes of the longest call with its arguments.
pub const LONGEST_CALL: usize = 1 << 20;
