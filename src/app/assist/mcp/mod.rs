//! The calls as tools of the Model Context Protocol: over standard input and output, and over HTTP on this machine.

mod http;
mod server;
mod stdio;

pub use http::{Http, http, random_token};
pub use stdio::stdio;
