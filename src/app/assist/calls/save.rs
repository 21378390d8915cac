//! `save`: the scene as a project file.

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::Desk;
use crate::folder::FileEntry;
use formats::loom;

/// Arguments of `save`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Save {
    /// File in the folder of this session; it ends in `.loom`.
    file: String,
    /// Write over a file that is there.
    #[serde(default)]
    replace: bool,
}

/// Receipt of `save`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Saved {
    /// The file.
    file: FileEntry,
    /// Number of the state that was saved.
    revision: u64,
}

impl Operation for Save {
    const NAME: &'static str = "save";
    const ABOUT: &'static str = "Writes the scene with everything in it, its history and the kept versions as a project file (.loom), whole or not at all.";
    const EXAMPLE: &'static str = r#"{"file": "a.loom", "replace": true}"#;
    const CHANGES: bool = false;
    type Receipt = Saved;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Saved> {
        if !self.file.ends_with(".loom") {
            bail!("file is {:?}, expected a name that ends in .loom", self.file);
        }
        let path = desk.folder.target(&self.file, self.replace)?;
        let scene = desk.to_save()?;
        let bytes = loom::save(&path, &scene)?;
        // (a window knows its own file)
        if desk.is_own() {
            desk.with(|document| document.mark_saved())?;
        }
        Ok(Saved {
            file: FileEntry {
                name: self.file,
                bytes,
            },
            revision: desk.number(scene.content()),
        })
    }
}
