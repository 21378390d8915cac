//! What is known of a variant that was made: a line of the index.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::plan::Change;
use scene::{Conditions, SceneBox};

/// Name of its file in the variant's folder.
pub const FILE: &str = "variant.json";

/// A variant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its number in the plan.
    pub variant: usize,
    /// The changes that it took, by the name of the axis.
    pub changes: BTreeMap<String, Vec<Change>>,
    /// The seed of its scene.
    pub seed: u64,
    /// SHA-256 of its scene as a `.loom` file.
    pub scene_sha256: String,
    /// Boxes at the first moment, ego frame.
    pub boxes: Vec<SceneBox>,
    /// Light and air.
    pub conditions: Conditions,
    /// How often each check found something, where checks were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub findings: Option<Findings>,
    /// Moments that were written.
    pub frames: usize,
    /// The files, relative to the variant's folder, in order.
    pub files: Vec<FileRecord>,
    /// Why it could not be made; the rest is empty then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// What the checks found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Of severity error.
    pub errors: usize,
    /// Of severity warning.
    pub warnings: usize,
    /// Worth knowing and no mistakes: what no sensor sees.
    #[serde(default)]
    pub infos: usize,
    /// By the name of the check.
    pub by_check: BTreeMap<String, usize>,
}

/// A file of a variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileRecord {
    /// Its path in the variant's folder, with `/`.
    pub path: String,
    /// Its length.
    pub bytes: u64,
    /// SHA-256.
    pub sha256: String,
}
