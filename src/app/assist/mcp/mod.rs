//! The calls as tools of the Model Context Protocol: over standard input and output, and over HTTP on this machine.

#[cfg(not(feature = "mcp"))]
mod absent;
#[cfg(feature = "mcp")]
mod http;
#[cfg(feature = "mcp")]
mod server;
#[cfg(feature = "mcp")]
mod stdio;

#[cfg(not(feature = "mcp"))]
pub use absent::{Http, http, random_token, stdio};
#[cfg(feature = "mcp")]
pub use http::{Http, http, random_token};
#[cfg(feature = "mcp")]
pub use stdio::stdio;
