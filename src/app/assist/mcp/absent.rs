//! Face of the servers for assistants in a program that was built without them: none can be begun.

use std::convert::Infallible;
use std::io::{BufRead, Write};
use std::net::SocketAddr;

use anyhow::bail;

use crate::service::Service;

const HOW: &str = "servers for assistants are not in this program; build it with cargo build --release --features mcp, or use \
                   sceneloom session";

/// A server that listens; there is none.
pub struct Http(Infallible);

impl Http {
    /// Its address.
    pub fn url(&self) -> String {
        match self.0 {}
    }

    /// Waits until it ends.
    pub fn wait(self) {
        match self.0 {}
    }
}

/// Errors with how to get a program that has servers.
pub fn random_token() -> anyhow::Result<String> {
    bail!(HOW)
}

/// Errors as [`random_token`] does.
pub fn http(_: Service, _: SocketAddr, _: String) -> anyhow::Result<Http> {
    bail!(HOW)
}

/// Errors as [`random_token`] does.
pub fn stdio(
    _: Service,
    _: impl BufRead + Send + 'static,
    _: impl Write + Send + 'static,
) -> anyhow::Result<()> {
    bail!(HOW)
}
