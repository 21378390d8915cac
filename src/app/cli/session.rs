//! `sceneloom session`: calls as JSON lines.

use std::io::{BufReader, stdin, stdout};
use std::path::PathBuf;

use anyhow::Context;

use super::{CommandResult, document};
use app::open;
use assist::{Desk, Folder, Holder};
use nets::OccModels;

/// Arguments.
#[derive(clap::Args)]
pub struct Session {
    #[command(flatten)]
    pub(super) on: On,
}

/// Scene, folder and weights of a session; `mcp` takes the same.
#[derive(clap::Args, Clone)]
pub struct On {
    /// Scene to begin with; the one that ships with the program if left out.
    scene: Option<PathBuf>,
    /// The one folder whose files calls may read and write.
    #[arg(long, value_name = "DIR", default_value = ".")]
    folder: PathBuf,
    /// Folder of weights instead of the bundled ones.
    #[arg(long, value_name = "DIR")]
    weights: Option<PathBuf>,
}

impl On {
    /// The scene and its folder. Errors in one line.
    pub(super) fn desk(self) -> anyhow::Result<Desk> {
        let folder = Folder::new(&self.folder)?;
        let scene = match &self.scene {
            Some(path) => open::scene(path)?,
            None => open::bundled()?,
        };
        // Weights that are asked for by name are refused now, not at the first call that needs them.
        if self.weights.is_some() {
            OccModels::open(self.weights.as_deref()).context("--weights")?;
        }
        let document = Box::new(document::opened(scene));
        Ok(Desk::new(Holder::Own(document), folder, self.weights))
    }
}

impl Session {
    pub(super) fn run(self) -> CommandResult {
        let mut desk = self.on.desk()?;
        let input = BufReader::new(stdin().lock());
        assist::session(&mut desk, input, stdout().lock()).context("standard input or output")?;
        Ok(())
    }
}
