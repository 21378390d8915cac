//! `sceneloom session`, `mcp` and `schema` as other programs use them: over their pipes and over HTTP.

mod history;
mod hostile;
pub mod http;
pub mod mcp;
pub mod process;
mod schema;
mod session;
mod soak;
