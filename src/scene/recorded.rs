//! Which boxes, tracks and motion of the ego vehicle are as a recording has them: what is odd about them is what was measured, and no
//! mistake of a designer. Each is known by a mark of its place, size and motion, so what is edited is recorded no more, however it
//! was edited, and undo makes it so again.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::BoxId;

/// Marks of what a recording holds. Empty for a scene that was made.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Boxes and tracks as they came.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) boxes: BTreeMap<BoxId, u64>,
    /// The ego vehicle's motion as it came.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ego: Option<u64>,
    /// Voxels are what sensors measured, with gaps where they saw nothing, but for those that were painted.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) voxels: bool,
}

impl Recorded {
    /// Voxels alone, as of a sweep.
    pub fn of_voxels() -> Self {
        Self {
            voxels: true,
            ..Self::default()
        }
    }

    /// True for a scene that was made.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty() && self.ego.is_none() && !self.voxels
    }
}
