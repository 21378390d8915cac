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

pub use call::{Call, CallAnswer, CallDef, Operation, Receipt, find, table};
pub use change::{ChangeCounts, ChangeSummary, Gained, changed_voxels, gained_and_lost};
pub use desk::{Desk, DocumentTask, Done, Holder, Stop};
pub use folder::{FileEntry, Folder};
pub use mcp::{Http, http, random_token, stdio};
pub use service::{Busy, MOST_WAITING, Service};
pub use session::session;
pub use window::{PORT, WindowDoor};

/// Bytes of the longest call with its arguments.
pub const LONGEST_CALL: usize = 1 << 20;
