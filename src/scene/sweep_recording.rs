//! Recorded sweeps that are kept with the scene that was imported from them, and what edits of the scene change in one.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;

use crate::{Class, Pose, Scene};

/// A file of LiDAR returns, byte for byte, and the scene as it was imported from it.
#[derive(Clone, Debug)]
pub struct SweepRecording {
    /// Name of the file, without folders.
    pub file: Arc<str>,
    /// Id of its format in the table of importers.
    pub format: Arc<str>,
    /// Moment of the clip at which it was recorded, s.
    pub time_s: f64,
    /// Bytes of the file.
    pub bytes: Arc<Vec<u8>>,
    /// Pose of the file's frame in the world frame.
    pub world_from_file: Pose,
    /// Place of the sensor in the world frame, m.
    pub sensor_m: DVec3,
    /// One for each record of the file, in its order; `None` where nothing came back.
    pub returns: Arc<Vec<Option<RecordedReturn>>>,
    /// The scene before any edit, with nothing kept beside it.
    pub before: Arc<Scene>,
}

impl SweepRecording {
    /// Most bytes of the files of a scene that are kept.
    pub const LARGEST: usize = 128 << 20;
    /// Most sweeps of a scene.
    pub const MOST: usize = 200;
}

/// A return of a recorded sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedReturn {
    /// Place in the world frame, m.
    pub at_m: [f32; 3],
    /// Strength of the echo as the file has it; NaN if it has none.
    pub strength: f32,
    /// Ring as the file has it; [`Self::NO_RING`] if it has none.
    pub ring: u16,
}

impl RecordedReturn {
    /// Ring of returns in files that tell none.
    pub const NO_RING: u16 = u16::MAX;

    /// Place in the world frame, m.
    pub fn place(&self) -> DVec3 {
        DVec3::from_array(self.at_m.map(f64::from))
    }
}

/// Origin of a return in an edited sweep; the number is what files of provenance hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Provenance {
    /// The sensor measured it.
    Recorded = 0,
    /// Other sweeps of the drive measured it.
    OtherSweep = 2,
    /// The ground around it was measured.
    Ground = 3,
    /// A ray was cast on an object, a thing or voxels that were added.
    Added = 4,
    /// A surface that was measured nearby is continued.
    Continued = 5,
    /// A record whose return is not there any more.
    Emptied = 6,
}

/// A return that was not measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SyntheticReturn {
    /// Place in the world frame, m.
    pub at_m: DVec3,
    /// Strength of the echo in the unit of the file; NaN if the file has none.
    pub strength: f32,
    /// Class of what it lies on.
    pub class: Class,
    /// Origin, not [`Provenance::Recorded`].
    pub provenance: Provenance,
    /// Record of the file whose ring, time and other fields it has.
    pub like: u32,
    /// Record of the file that lies where its ray belongs, if the file has a record for it.
    pub slot: Option<u32>,
}

/// Changes that edits make to a recorded sweep. Records that it does not name stay as they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepEdits {
    /// Records that are not there any more, with the return that their ray has instead, if there is one.
    pub changed: BTreeMap<u32, Option<SyntheticReturn>>,
    /// Returns of rays from which nothing came back before.
    pub added: Vec<SyntheticReturn>,
}

impl SweepEdits {
    /// True if the sweep is as recorded.
    pub fn is_empty(&self) -> bool {
        self.changed.is_empty() && self.added.is_empty()
    }

    /// All returns that were not measured.
    pub fn synthetic(&self) -> impl Iterator<Item = &SyntheticReturn> {
        self.changed.values().flatten().chain(&self.added)
    }
}
