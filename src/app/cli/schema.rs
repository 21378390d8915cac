//! `sceneloom schema`: the JSON Schema of all calls of `session` and `mcp`.

use std::io::Write;

use super::CommandResult;
use assist::schema;

/// Arguments.
#[derive(clap::Args)]
pub struct SchemaCommand {
    /// On one line.
    #[arg(long)]
    compact: bool,
}

impl SchemaCommand {
    pub(super) fn run(self) -> CommandResult {
        let document = schema::document();
        // (the reader may stop early)
        let mut out = std::io::stdout();
        let _ = match self.compact {
            true => writeln!(out, "{document}"),
            false => writeln!(out, "{document:#}"),
        };
        Ok(())
    }
}
