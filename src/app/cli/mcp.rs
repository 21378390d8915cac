//! `sceneloom mcp`: a server of the Model Context Protocol.

use std::io::{BufReader, stdin, stdout};
use std::net::SocketAddr;

use anyhow::{Context as _, anyhow};

use super::CommandResult;
use super::session::On;
use assist::{Desk, Service, http};

/// Arguments.
#[derive(clap::Args)]
pub struct Mcp {
    #[command(flatten)]
    on: On,
    /// Listen on a loopback address (such as 127.0.0.1:7333) for clients over HTTP, instead of serving one over standard
    /// input and output.
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: Option<SocketAddr>,
    /// Token that clients must show, at least 16 letters, digits or signs; else that of SCENELOOM_MCP_TOKEN, which
    /// other users of this machine cannot see; else a random one, which is told on stderr.
    #[arg(long, value_name = "TOKEN", requires = "listen")]
    token: Option<String>,
}

impl Mcp {
    pub(super) fn run(self) -> CommandResult {
        let desk = self.on.desk()?;
        let (service, thread) = Service::start(move || -> Desk { desk }).context("start the session")?;
        match self.listen {
            None => {
                assist::stdio(service, BufReader::new(stdin()), stdout())?;
                thread.join().map_err(|_| anyhow!("the session panicked"))?;
            }
            Some(address) => {
                let given = self.token.or_else(|| std::env::var("SCENELOOM_MCP_TOKEN").ok());
                let drawn = given.is_none();
                let token = match given {
                    Some(token) => token,
                    None => assist::random_token()?,
                };
                let server = http(service, address, token.clone())?;
                eprintln!("listening on {}", server.url());
                if drawn {
                    eprintln!("token: {token}");
                }
                server.wait();
            }
        }
        Ok(())
    }
}
