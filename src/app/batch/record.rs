//! The record of a variant that was made: a row of the index.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::plan::VariantChange;
use scene::{Conditions, SceneBox};

/// Name of the record's file in the variant's folder.
pub const FILE: &str = "variant.json";

/// The record of a variant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VariantRecord {
    /// Its number in the plan.
    pub variant: usize,
    /// The changes that it took, by the name of the axis.
    pub changes: BTreeMap<String, Vec<VariantChange>>,
    /// The seed of its scene.
    pub seed: u64,
    /// SHA-256 of its scene as a `.loom` file.
    pub scene_sha256: String,
    /// Boxes at the first moment, ego frame.
    pub boxes: Vec<SceneBox>,
    /// Conditions: time of day and weather.
    pub conditions: Conditions,
    /// Counts of the findings; `None` if no checks were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub findings: Option<Findings>,
    /// Number of written moments.
    pub frames: usize,
    /// The files, relative to the variant's folder, in order.
    pub files: Vec<FileRecord>,
    /// Why it could not be made; the rest is empty then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// Findings of the checks, counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Findings of severity error.
    pub errors: usize,
    /// Findings of severity warning.
    pub warnings: usize,
    /// Findings of severity info, such as objects that no sensor sees. They are no mistakes.
    #[serde(default)]
    pub infos: usize,
    /// Counts by the name of the check.
    pub by_check: BTreeMap<String, usize>,
}

/// A file of a variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileRecord {
    /// Its path in the variant's folder, with `/`.
    pub path: String,
    /// Its length, bytes.
    pub bytes: u64,
    /// SHA-256.
    pub sha256: String,
}
