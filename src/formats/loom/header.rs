//! `scene.json`: all of a scene but its grids, as versions 5 to 12 keep it. A change here is a new version, see `migrate`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use scene::{
    Arranged, BoxId, Clip, Conditions, DataLabels, Extent, Frame, Lattice, Motion, Polyline, Pose, Recorded,
    RoadNetwork, Scene, SceneBox, SensorRig, Thing, Track, Waiver,
};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneHeader {
    pub(super) name: Arc<str>,
    pub(super) prompt: Arc<str>,
    pub(super) conditions: Conditions,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) words: Vec<String>,
    pub(super) seed: u64,
    /// The moment that is shown, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(super) shown_s: f64,
    pub(super) rig: Arc<SensorRig>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) background: Vec<Thing>,
    #[serde(default, skip_serializing_if = "has_no_roads")]
    pub(super) roads: Arc<RoadNetwork>,
    #[serde(default, skip_serializing_if = "is_plain")]
    pub(super) arranged: Arc<Arranged>,
    pub(super) canvas: FrameHeader,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) clip: Option<ClipHeader>,
}

/// The moving parts of a scene, but for their voxels.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ClipHeader {
    pub(super) length_s: f64,
    pub(super) rate_hz: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) ego: Option<Motion>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) tracks: Vec<TrackHeader>,
}

/// An object that moves.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TrackHeader {
    pub(super) made: SceneBox,
    pub(super) motion: Motion,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) from_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) to_s: Option<f64>,
    pub(super) settled: bool,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) own_shape: bool,
    /// Column at the lower corner of its voxels, counted from the world frame's origin.
    pub(super) voxels_from: [i32; 2],
    /// Columns of them along x and y.
    pub(super) voxels_size: [usize; 2],
}

impl ClipHeader {
    /// The header of a clip; `None` for the default clip, that of a scene of one moment.
    fn from_clip(clip: &Clip) -> Option<Self> {
        let track = |t: &Track| TrackHeader {
            made: t.made,
            motion: t.motion.clone(),
            from_s: t.there_s[0],
            to_s: t.there_s[1],
            settled: t.settled,
            own_shape: t.own_shape,
            voxels_from: t.voxels.from,
            voxels_size: t.voxels.size,
        };
        (*clip != Clip::default()).then(|| Self {
            length_s: clip.length_s,
            rate_hz: clip.rate_hz,
            ego: clip.ego.clone(),
            tracks: clip.tracks.values().map(track).collect(),
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FrameHeader {
    pub(super) time_s: f64,
    pub(super) world_from_ego: Pose,
    /// Columns of its grids; absent for the networks' window.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) extent: Option<ExtentHeader>,
    pub(super) boxes: Vec<SceneBox>,
    pub(super) polylines: Arc<Vec<Polyline>>,
    /// Whether `relief.f32` is there.
    #[serde(default, skip_serializing_if = "is_false")]
    pub(super) relief: bool,
    /// Whether `painted.u8` is there.
    pub(super) painted: bool,
    #[serde(default, skip_serializing_if = "InferredHeader::is_empty")]
    pub(super) inferred: InferredHeader,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) waivers: Vec<Waiver>,
    pub(super) source: SourceHeader,
}

/// Columns that a frame's grids cover.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ExtentHeader {
    /// The lower corner along x and y, counted from the world frame's origin.
    from: [i32; 2],
    /// How many along x and y.
    columns: [usize; 2],
    /// Voxels; those of Occ3D if it does not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lattice: Option<LatticeHeader>,
}

/// Lattice of a frame's voxels.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LatticeHeader {
    /// Edge of a voxel, m.
    voxel_m: f64,
    /// Bins above one another.
    bins: usize,
    /// Height of the lowest bin's bottom, m.
    bottom_m: f64,
    /// Bins by which labels let the ground down.
    #[serde(default)]
    lowered: usize,
}

impl LatticeHeader {
    pub(super) fn from_lattice(lattice: Lattice) -> Option<Self> {
        (lattice != Lattice::OCC3D).then(|| Self {
            voxel_m: lattice.voxel_m(),
            bins: lattice.bins(),
            bottom_m: lattice.bottom_m(),
            lowered: lattice.lowered(),
        })
    }

    fn lattice(self) -> Result<Lattice, String> {
        Lattice::new(self.voxel_m, self.bins, self.bottom_m)?.lowered_by(self.lowered)
    }
}

/// Entry of the labels of a data set.
pub(super) const DATA_LABELS: &str = "data_labels.u32";

/// Entry of the unobserved voxels of a map, and bytes of a column's word.
pub(super) fn unobserved_entry(extent: Extent) -> (&'static str, usize) {
    match extent.nz() {
        0..=16 => ("unobserved.u16", 2),
        _ => ("unobserved.u64", 8),
    }
}

impl ExtentHeader {
    fn from_extent(extent: Extent) -> Option<Self> {
        let columns = [extent.nx(), extent.ny()];
        (extent != Extent::WINDOW).then(|| Self {
            from: extent.from(),
            columns,
            lattice: LatticeHeader::from_lattice(extent.lattice()),
        })
    }

    /// The extent; errors in one line if there is no such map.
    pub(super) fn extent(&self) -> Result<Extent, String> {
        let lattice = self.lattice.map_or(Ok(Lattice::OCC3D), LatticeHeader::lattice)?;
        Extent::over(lattice, self.from, self.columns)
    }
}

/// The guessed parts of an imported frame.
#[derive(Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct InferredHeader {
    pub(super) layout: bool,
    pub(super) boxes: BTreeSet<BoxId>,
    #[serde(skip_serializing_if = "is_false")]
    pub(super) background: bool,
    /// Whether `unobserved.u16` is there.
    pub(super) unobserved: bool,
    /// Labels of the data set, if `data_labels.u32` is there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) data_labels: Option<DataLabelsHeader>,
    #[serde(skip_serializing_if = "Recorded::is_empty")]
    pub(super) recorded: Recorded,
}

/// What the entry of labels of a data set does not say.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DataLabelsHeader {
    /// Id of the label set.
    pub(super) set: String,
    /// Label of free voxels.
    pub(super) free: u16,
    /// Labels in the entry: the number of a voxel `[x][y][z]` and its label each.
    pub(super) special: usize,
}

impl DataLabelsHeader {
    fn from_labels(labels: &DataLabels) -> Self {
        Self {
            set: labels.set().id.to_owned(),
            free: labels.free(),
            special: labels.special().len(),
        }
    }
}

impl InferredHeader {
    fn is_empty(&self) -> bool {
        let none_inferred = !self.layout && self.boxes.is_empty() && !self.background && !self.unobserved;
        none_inferred && self.recorded.is_empty() && self.data_labels.is_none()
    }
}

/// Header of the frame's source. A part that is left out, or false, is as on the canvas.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SourceHeader {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) boxes: Option<Vec<SceneBox>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) polylines: Option<Arc<Vec<Polyline>>>,
    /// Whether `source_layout.u32` is there.
    pub(super) layout: bool,
    /// Whether `source_relief.f32` is there.
    #[serde(default, skip_serializing_if = "is_false")]
    pub(super) relief: bool,
    /// Whether `source_occupancy.u8` is there.
    pub(super) occupancy: bool,
}

fn is_plain(arranged: &Arc<Arranged>) -> bool {
    arranged.is_empty()
}

fn has_no_roads(roads: &Arc<RoadNetwork>) -> bool {
    roads.is_empty()
}

fn is_false(flag: &bool) -> bool {
    !flag
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

impl SceneHeader {
    /// The header of a scene.
    pub(super) fn from_scene(scene: &Scene) -> Self {
        Self {
            name: scene.name.clone(),
            prompt: scene.prompt.clone(),
            conditions: scene.conditions,
            words: scene.words.to_vec(),
            seed: scene.seed,
            shown_s: if scene.clip().length_s > 0.0 {
                scene.time_s()
            } else {
                0.0
            },
            rig: scene.rig.clone(),
            background: scene.background.iter().cloned().collect(),
            roads: scene.roads.clone(),
            arranged: scene.arranged.clone(),
            canvas: frame_header(scene.canvas()),
            clip: ClipHeader::from_clip(scene.clip()),
        }
    }
}

/// Name of a part of the canvas within the zip.
pub(super) fn entry_name(part: &str) -> String {
    format!("canvas/{part}")
}

/// Name of a track's voxels within the zip.
pub(super) fn track_entry(id: BoxId) -> String {
    format!("tracks/{:010}.u8", id.0)
}

fn frame_header(frame: &Frame) -> FrameHeader {
    let source = &frame.source;
    let list = |boxes: &BTreeMap<BoxId, SceneBox>| boxes.values().copied().collect::<Vec<_>>();
    FrameHeader {
        time_s: frame.time_s,
        world_from_ego: frame.world_from_ego,
        extent: ExtentHeader::from_extent(frame.extent()),
        boxes: list(&frame.boxes),
        polylines: frame.layout.polylines.clone(),
        relief: !frame.layout.relief.is_flat(),
        painted: frame.painted.count_set() > 0,
        inferred: InferredHeader {
            layout: frame.inferred.layout,
            boxes: frame.inferred.boxes.clone(),
            background: frame.inferred.background,
            unobserved: frame.inferred.unobserved.is_some(),
            data_labels: frame
                .inferred
                .data_labels
                .as_ref()
                .map(DataLabelsHeader::from_labels),
            recorded: (*frame.inferred.recorded).clone(),
        },
        waivers: frame.waivers.to_vec(),
        source: SourceHeader {
            boxes: (source.boxes != frame.boxes).then(|| list(&source.boxes)),
            polylines: (source.layout.polylines != frame.layout.polylines)
                .then(|| source.layout.polylines.clone()),
            layout: source.layout.cells() != frame.layout.cells(),
            relief: source.layout.relief != frame.layout.relief,
            occupancy: source.occupancy != frame.occupancy,
        },
    }
}
