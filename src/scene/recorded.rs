//! Marks of the boxes, tracks and motion of the ego vehicle that are as a recording has them: oddities in them were
//! measured, and are not mistakes of a designer. Each is identified by a hash of its place, size and motion, so an
//! edited one no longer counts as recorded, however it was edited, and undo makes it count again.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{BoxId, SceneBox};

/// Marks of the contents of a recording. Empty for a scene that was made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Hashes of boxes and tracks as they were recorded.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) boxes: BTreeMap<BoxId, u64>,
    /// Hash of the ego vehicle's motion as it was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ego: Option<u64>,
    /// True if the voxels, except painted ones, were measured by sensors, with gaps where these saw nothing.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) voxels: bool,
    /// Boxes as a person corrected them: what the recording has there, `None` where it has no object.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) labels: BTreeMap<BoxId, Option<SceneBox>>,
}

impl Recorded {
    /// Marks of voxels alone, as for a sweep.
    pub fn of_voxels() -> Self {
        Self {
            voxels: true,
            ..Self::default()
        }
    }

    /// Boxes of a recording as a person corrected them; `None` for those that are no objects.
    pub fn labels(&self) -> &BTreeMap<BoxId, Option<SceneBox>> {
        &self.labels
    }

    /// Takes a corrected box of a recording of voxels; none if there is no object. Of a scene that was made nothing is taken.
    pub fn correct(&mut self, id: BoxId, corrected: Option<SceneBox>) {
        if self.voxels {
            self.labels.insert(id, corrected);
        }
    }

    /// True for a scene that was made.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty() && self.ego.is_none() && !self.voxels
    }
}
