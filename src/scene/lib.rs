//! What a scene is, as plain data. This room knows no window, graphics card, network, thread or file.

pub mod appearance;
pub mod background;
pub mod box_label;
pub mod boxes;
pub mod classes;
pub mod conditions;
pub mod density;
pub mod distance;
pub mod draft;
pub mod edit;
pub mod footprint;
pub mod graph;
pub mod grid;
pub mod infer;
pub mod inferred;
pub mod layout;
pub mod message;
pub mod pose;
pub mod raster;
pub mod relations;
pub mod relief;
pub mod rig;
pub mod rig_presets;
pub mod road_map;
pub mod sensor_data;
pub mod shape;
pub mod solid;
pub mod splats;
pub mod support;
pub mod variants;
pub mod waiver;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

pub use background::{Background, Form, Thing, ThingId};
pub use box_label::{BoxLabel, BoxName, Paint};
pub use boxes::{BoxId, SceneBox};
pub use classes::{BevLayer, Class};
pub use conditions::{Conditions, Sun, TimeOfDay, Weather};
pub use density::Density;
pub use edit::{Edit, EditError};
pub use grid::{Extent, VoxelGrid, VoxelPaint, Window};
pub use inferred::{Inferred, Unobserved};
pub use layout::{BevLayout, Polyline, PolylineKind};
pub use numeric::splitmix as draw;
pub use pose::Pose;
pub use relief::Relief;
pub use rig::{Camera, LidarPattern, SensorRig};
pub use sensor_data::{CameraMaps, LidarPoint, LidarSweep, MultiPlaneImage, PerspectiveMap};
pub use shape::Shape;
pub use waiver::Waiver;

/// Identifies one state of a scene: two scenes with the same `SceneRev` are equal. It is part of the scene, so undo brings
/// it back. Compare it for equality only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SceneRev(u64);

impl SceneRev {
    /// A revision that no scene of this process has yet.
    pub fn fresh() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// The state in which a frame's occupancy was last generated, imported or accepted. The next generation inpaints what
/// differs between it and the frame; all else stays bit-identical.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFrame {
    /// Map layers and polylines the occupancy belongs to.
    pub layout: BevLayout,
    /// Boxes the occupancy belongs to.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    /// The occupancy itself.
    pub occupancy: VoxelGrid,
}

/// One instant of a clip. All coordinates are in that instant's ego frame (x forward, y left, z up).
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time since the start of the clip, s.
    pub time_s: f64,
    /// Ego pose in the world frame of the clip.
    pub world_from_ego: Pose,
    /// Objects; the same id in several frames is one track.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    /// Map layers and the polylines they come from.
    pub layout: BevLayout,
    /// The voxels that are shown and that the sensors see: the source with the rough version of the user's edits, or the
    /// last result.
    pub occupancy: VoxelGrid,
    /// Voxels the user painted (or removed, painted as free): locked, generation keeps them.
    pub painted: VoxelPaint,
    /// Which parts of layout and boxes are guesses of an import.
    pub inferred: Inferred,
    /// Findings of the checks that the user accepted.
    pub waivers: Arc<Vec<Waiver>>,
    /// See [`SourceFrame`].
    pub source: Arc<SourceFrame>,
}

impl Frame {
    /// Boxes that a frame holds at most.
    pub const MAX_BOXES: usize = 20_000;
    /// Waivers that a frame holds at most.
    pub const MAX_WAIVERS: usize = 10_000;

    /// A frame whose occupancy is its own source. Layout and occupancy have the same extent.
    pub fn new(layout: BevLayout, boxes: BTreeMap<BoxId, SceneBox>, occupancy: VoxelGrid) -> Self {
        let source = Arc::new(SourceFrame {
            layout: layout.clone(),
            boxes: boxes.clone(),
            occupancy: occupancy.clone(),
        });
        Self {
            time_s: 0.0,
            world_from_ego: Pose::IDENTITY,
            boxes,
            painted: VoxelPaint::over(layout.extent()),
            layout,
            occupancy,
            inferred: Inferred::default(),
            waivers: Arc::default(),
            source,
        }
    }

    /// Which part of the ground its layout and its grids cover.
    pub fn extent(&self) -> Extent {
        self.layout.extent()
    }

    /// The part of it that lies in another extent. Boxes, lines and waivers stay, wherever they are. Costs pointers alone
    /// if the extent is its own.
    pub fn crop(&self, extent: Extent) -> Self {
        if extent == self.extent() {
            return self.clone();
        }
        let source = SourceFrame {
            layout: self.source.layout.crop(extent),
            boxes: self.source.boxes.clone(),
            occupancy: self.source.occupancy.crop(extent),
        };
        Self {
            layout: self.layout.crop(extent),
            occupancy: self.occupancy.crop(extent),
            painted: self.painted.crop(extent),
            inferred: Inferred {
                unobserved: self.inferred.unobserved.as_ref().map(|u| u.crop(extent)),
                ..self.inferred.clone()
            },
            source: Arc::new(source),
            ..self.clone()
        }
    }

    /// All 18 BEV channels, one bit per [`BevLayer`] and cell, row-major `[x][y]`:
    /// the layout's map layers and the footprints of the boxes.
    pub fn bev_channels(&self) -> Vec<u32> {
        raster::bev_channels(&self.layout, self.boxes.values())
    }

    /// The lowest id not in use.
    pub fn next_box_id(&self) -> BoxId {
        BoxId(self.boxes.keys().next_back().map_or(1, |id| id.0 + 1))
    }
}

/// A driving scene: a clip of one or more frames, seen by one sensor rig.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Which state this is.
    pub rev: SceneRev,
    /// Name shown to the user.
    pub name: Arc<str>,
    /// Free text that describes the style; empty when none. What it says of light and air is in `conditions`.
    pub prompt: Arc<str>,
    /// Light and air.
    pub conditions: Conditions,
    /// What was typed to make it and to change it, in order.
    pub words: Arc<Vec<String>>,
    /// Cameras and LiDARs.
    pub rig: Arc<SensorRig>,
    /// What stands beside the roads, in the world frame of the clip; all frames see it.
    pub background: Arc<Background>,
    /// At least one.
    pub frames: Vec<Arc<Frame>>,
    /// Index of the frame being edited.
    pub current: usize,
    /// Seed of every random draw made for this scene.
    pub seed: u64,
}

impl Scene {
    /// A clip of a single frame on a clear day.
    pub fn single(name: &str, frame: Frame, rig: Arc<SensorRig>, seed: u64) -> Self {
        Self {
            rev: SceneRev::fresh(),
            name: name.into(),
            prompt: "".into(),
            conditions: Conditions {
                seed,
                ..Conditions::default()
            },
            words: Arc::default(),
            rig,
            background: Arc::default(),
            frames: vec![Arc::new(frame)],
            current: 0,
            seed,
        }
    }

    /// The frame being edited.
    pub fn frame(&self) -> &Arc<Frame> {
        &self.frames[self.current]
    }

    /// The scene with the frame being edited cut to the networks' window; itself if the frame is one. The revision stays.
    pub fn in_window(&self) -> Cow<'_, Scene> {
        if self.frame().extent() == Extent::WINDOW {
            return Cow::Borrowed(self);
        }
        let mut scene = self.clone();
        scene.frames[scene.current] = Arc::new(self.frame().crop(Extent::WINDOW));
        Cow::Owned(scene)
    }

    /// The frame being edited, copied if it is shared, and a fresh revision.
    pub fn frame_mut(&mut self) -> &mut Frame {
        self.rev = SceneRev::fresh();
        Arc::make_mut(&mut self.frames[self.current])
    }
}
