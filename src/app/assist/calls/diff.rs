//! `diff`: differences between the scene and another state.

use anyhow::{Context, bail};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::change::ChangeSummary;
use crate::desk::Desk;
use authoring::open;

/// Arguments of `diff`: exactly one of them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Diff {
    /// Name of a version that was kept.
    #[serde(default)]
    version: Option<String>,
    /// A file in the folder of this session, such as `a.loom`.
    #[serde(default)]
    file: Option<String>,
}

/// Receipt of `diff`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct DiffReceipt {
    /// Name of the version or file it was compared with.
    against: String,
    /// From there to the scene as it is now.
    changed: ChangeSummary,
    /// Number of the state that the scene is in.
    revision: u64,
}

impl Operation for Diff {
    const NAME: &'static str = "diff";
    const ABOUT: &'static str = "Counts what changed from a kept version or a file to the scene as it is now: boxes, cells of the map, voxels by class.";
    const EXAMPLE: &'static str = r#"{"version": "before"}"#;
    const CHANGES: bool = false;
    type Receipt = DiffReceipt;

    fn run(self, desk: &mut Desk) -> anyhow::Result<DiffReceipt> {
        let now = desk.scene()?;
        let (against, before) = match (&self.version, &self.file) {
            (Some(name), None) => (name.clone(), desk.version(name)?),
            (None, Some(file)) => {
                let path = desk.folder.existing(file)?;
                let scene = open::scene(&path).with_context(|| file.clone())?;
                (file.clone(), std::sync::Arc::new(scene))
            }
            _ => bail!("expected exactly one of version and file"),
        };
        Ok(DiffReceipt {
            against,
            changed: ChangeSummary::between(&before, &now),
            revision: desk.number(now.content()),
        })
    }
}
