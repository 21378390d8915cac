//! `sceneloom eval` in a program without the suites of quality.

use super::CommandResult;

/// Arguments, which are not read.
#[derive(clap::Args)]
pub struct Eval {
    /// A suite and its options.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<String>,
}

impl Eval {
    /// Errors with how to get a program that has them.
    pub(super) fn run(self) -> CommandResult {
        Err(anyhow::anyhow!(
            "the suites of quality are not in this program; from the sources: cargo run --release --features eval -- eval …"
        )
        .into())
    }
}
