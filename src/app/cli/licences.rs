//! `sceneloom licences`: the notices of everything that travels inside the program.

use std::io::Write;

use super::CommandResult;

/// Arguments.
#[derive(clap::Args)]
pub struct Licences {}

impl Licences {
    pub(super) fn run(self) -> CommandResult {
        // (the reader may stop early)
        let _ = std::io::stdout().write_all(assets::licences::NOTICES.as_bytes());
        Ok(())
    }
}
