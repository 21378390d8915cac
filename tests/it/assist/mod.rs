//! `sceneloom session`, `mcp` and `schema` as other programs use them: over their pipes and over HTTP.

mod hostile;
pub mod http;
mod mcp;
mod process;
mod schema;
mod session;
