//! States of the scene that are kept under a name for the time of the session.

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};

/// Longest name of a version, characters.
const LONGEST_NAME: usize = 60;

/// Arguments of `keep_version`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeepVersion {
    /// A name of 1 to 60 characters; a version of that name is replaced.
    name: String,
}

/// Arguments of `restore_version`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RestoreVersion {
    /// Its name.
    name: String,
}

/// Arguments of `list_versions`: none.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ListVersions {}

/// A state that was kept.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Version {
    /// Its name.
    name: String,
    /// Number of the state.
    revision: u64,
    /// Boxes in it.
    boxes: usize,
    /// Voxels that are not free.
    occupied_voxels: usize,
}

/// Receipt of `keep_version` and `list_versions`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct VersionList {
    /// All versions, the oldest first.
    versions: Vec<Version>,
    /// Number of the state that the scene is in now.
    revision: u64,
}

fn list(desk: &mut Desk) -> anyhow::Result<VersionList> {
    let all = desk.versions().to_vec();
    let of = |(name, scene): (String, std::sync::Arc<scene::Scene>)| Version {
        name,
        revision: desk.number(scene.content()),
        boxes: scene.frame().boxes.len(),
        occupied_voxels: scene.frame().occupancy.count_set(),
    };
    let versions = all.into_iter().map(of).collect();
    let now = desk.scene()?.content();
    Ok(VersionList {
        versions,
        revision: desk.number(now),
    })
}

impl Operation for KeepVersion {
    const NAME: &'static str = "keep_version";
    const ABOUT: &'static str = "Keeps the scene as it is now under a name, for diff and restore_version; at most 64. save writes them into the project file, open brings them back.";
    const EXAMPLE: &'static str = r#"{"name": "before"}"#;
    const CHANGES: bool = false;
    type Receipt = VersionList;

    fn run(self, desk: &mut Desk) -> anyhow::Result<VersionList> {
        let name = self.name.trim();
        let length = name.chars().count();
        if !(1..=LONGEST_NAME).contains(&length) || name.contains(char::is_control) {
            bail!("name has {length} characters, expected 1 to {LONGEST_NAME} and no control characters");
        }
        let scene = desk.scene()?;
        desk.keep(name.to_owned(), scene)?;
        list(desk)
    }
}

impl Operation for RestoreVersion {
    const NAME: &'static str = "restore_version";
    const ABOUT: &'static str = "Brings a kept version back, as one undo step.";
    const EXAMPLE: &'static str = r#"{"name": "before"}"#;
    const CHANGES: bool = true;
    type Receipt = Done;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Done> {
        let version = desk.version(&self.name)?;
        let from = desk.scene()?.content();
        desk.put(format!("Version {}", self.name), from, (*version).clone())
    }
}

impl Operation for ListVersions {
    const NAME: &'static str = "list_versions";
    const ABOUT: &'static str = "Lists the versions that were kept.";
    const EXAMPLE: &'static str = "{}";
    const CHANGES: bool = false;
    type Receipt = VersionList;

    fn run(self, desk: &mut Desk) -> anyhow::Result<VersionList> {
        list(desk)
    }
}
