//! The scene as plain data. This room knows no window, graphics card, network, thread or file.

pub mod appearance;
pub mod arranged;
pub mod background;
pub mod box_label;
pub mod boxes;
pub mod classes;
pub mod clip;
pub mod conditions;
pub mod density;
pub mod distance;
pub mod draft;
pub mod drawn;
pub mod edit;
pub mod ego_frame;
pub mod footprint;
pub mod frame;
pub mod gaussians;
pub mod graph;
pub mod grid;
pub mod infer;
pub mod inferred;
pub mod kept;
pub mod label_set;
pub mod label_sets;
pub mod layout;
pub mod lens;
pub mod message;
pub mod model;
pub mod moved;
pub mod op;
pub mod plain_name;
pub mod pose;
mod radar;
pub mod raster;
pub mod recorded;
mod recording;
pub mod relations;
pub mod relief;
pub mod resample;
pub mod returns;
pub mod rig;
mod rig_names;
pub mod rig_presets;
pub mod road_map;
pub mod roads;
pub mod sensor_data;
mod settle;
pub mod shape;
pub mod solid;
pub mod speed_limits;
pub mod splats;
pub mod support;
mod sweep_recording;
pub mod truth;
pub mod variants;
pub mod waiver;

use clip::ComposedFrame;
use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

pub use arranged::{Arranged, Arrangement, Members, ObjectGroup};
pub use background::{Background, Form, Thing, ThingId};
pub use box_label::{BoxLabel, BoxName, Paint};
pub use boxes::{BoxId, SceneBox};
pub use classes::{BevLayer, Class};
pub use clip::{Clip, Key, Motion, Moving, Scope, Template, Track};
pub use conditions::{Conditions, Sun, TimeOfDay, Weather};
pub use density::Density;
pub use edit::{Edit, EditError};
pub use frame::{Frame, SourceFrame};
pub use gaussians::{Baking, GaussianScene, SceneGaussian};
pub use grid::{Extent, Lattice, VoxelGrid, VoxelPaint, Window};
pub use inferred::{Inferred, Unobserved};
pub use kept::{KeptVersion, ProjectHistory};
pub use label_set::{DataLabels, LabelSet};
pub use layout::{BevLayout, Polyline, PolylineKind};
pub use lens::{Lens, Optics, ReadOut, Shutter};
pub use model::Model;
pub use numeric::splitmix as draw;
pub use op::{Author, Change, LoggedState, Op, OpId, OpLog};
pub use pose::Pose;
pub use radar::{RadarField, RadarPattern, RadarReturn, RadarScan};
pub use recorded::Recorded;
pub use relief::Relief;
pub use returns::Returns;
pub use rig::{Camera, LidarPattern, SensorRig};
pub use roads::{Road, RoadChange, RoadId, RoadLane, RoadNetwork, RoadNode, RoadWish};
pub use sensor_data::{CameraMaps, LidarPoint, LidarSweep, MultiPlaneImage, PerspectiveMap};
pub use shape::Shape;
pub use sweep_recording::{Provenance, RecordedReturn, SweepEdits, SweepRecording, SyntheticReturn};
pub use truth::{CameraTruth, SeenBox, TruthPixel};
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

/// A driving scene: the canvas that stands still, the moving objects, and the sensors that see them.
///
/// The frame of one moment is shown. Two revisions identify the scene: [`rev`](Self::rev) the moment that is shown,
/// `content` the scene at all times.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Identifies this state, including the moment that is shown.
    pub rev: SceneRev,
    /// Name shown to the user.
    pub name: Arc<str>,
    /// Free text that describes the style; empty if there is none. Its statements on light and air are in `conditions`.
    pub prompt: Arc<str>,
    /// Light and air.
    pub conditions: Conditions,
    /// Texts typed to make it and to change it, in order.
    pub words: Arc<Vec<String>>,
    /// Cameras and LiDARs, in the ego frame.
    pub rig: Arc<SensorRig>,
    /// Things beside the roads, in the world frame.
    pub background: Arc<Background>,
    /// The road network behind the layout, in the world frame; empty until a road is reshaped.
    pub roads: Arc<RoadNetwork>,
    /// Groups, hidden objects, locked objects.
    pub arranged: Arc<Arranged>,
    /// Seed of every random draw made for this scene.
    pub seed: u64,
    /// Versions and texts that its file keeps beside it: they are no part of any state, so neither revision covers
    /// them.
    pub kept: Arc<ProjectHistory>,
    content: SceneRev,
    canvas: Arc<Frame>,
    clip: Arc<Clip>,
    view: Arc<Frame>, // the canvas at the moment that is shown
}

impl Scene {
    /// Characters of the longest name that a scene gets.
    pub const LONGEST_NAME: usize = 200;

    /// A scene that stands still, on a clear day. Of its name a line of at most [`Self::LONGEST_NAME`] characters is kept.
    pub fn single(name: &str, frame: Frame, rig: Arc<SensorRig>, seed: u64) -> Self {
        let (rev, canvas) = (SceneRev::fresh(), Arc::new(frame));
        Self {
            rev,
            content: rev,
            name: message::quoted(name, Self::LONGEST_NAME).into(),
            prompt: "".into(),
            conditions: Conditions {
                seed,
                ..Conditions::default()
            },
            words: Arc::default(),
            rig,
            background: Arc::default(),
            roads: Arc::default(),
            arranged: Arc::default(),
            view: canvas.clone(),
            canvas,
            clip: Arc::default(),
            seed,
            kept: Arc::default(),
        }
    }

    /// The moment that is shown: it is drawn, edited and seen by the sensors.
    pub fn frame(&self) -> &Arc<Frame> {
        &self.view
    }

    /// The canvas: the parts that stand still.
    pub fn canvas(&self) -> &Arc<Frame> {
        &self.canvas
    }

    /// The clip: the parts that move.
    pub fn clip(&self) -> &Arc<Clip> {
        &self.clip
    }

    /// Identifies this state, whatever moment is shown.
    pub fn content(&self) -> SceneRev {
        self.content
    }

    /// The moment that is shown, s.
    pub fn time_s(&self) -> f64 {
        self.view.time_s
    }

    /// True if another scene is equal at all times, in all but its revisions, the moment shown, and its name.
    pub fn is_same(&self, other: &Self) -> bool {
        (self.seed, self.conditions) == (other.seed, other.conditions)
            && (&self.prompt, &self.words) == (&other.prompt, &other.words)
            && (&self.rig, &self.arranged) == (&other.rig, &other.arranged)
            && (&self.background, &self.roads) == (&other.background, &other.roads)
            && (&self.clip, &self.canvas) == (&other.clip, &other.canvas)
    }

    /// The same state without the log of the file that it came from: a document has its own.
    pub fn without_log(mut self) -> Self {
        if self.kept.log.is_some() || self.kept.log_problem.is_some() {
            let kept = Arc::make_mut(&mut self.kept);
            (kept.log, kept.log_problem) = (None, None);
        }
        self
    }

    /// The same state with the recorded sweeps of another scene, unless it has its own: versions in a file have them of the file.
    pub fn with_sweeps_of(mut self, other: &Self) -> Self {
        if self.kept.sweeps.is_empty() && !other.kept.sweeps.is_empty() {
            Arc::make_mut(&mut self.kept).sweeps = other.kept.sweeps.clone();
        }
        self
    }

    /// Sets fresh revisions, after a change of its public fields.
    pub fn touch(&mut self) {
        self.rev = SceneRev::fresh();
        self.content = self.rev;
    }

    /// Shows another moment of the clip. Returns false if it is shown already.
    pub fn show(&mut self, time_s: f64) -> bool {
        let time_s = match self.clip.length_s > 0.0 {
            true => time_s.clamp(0.0, self.clip.length_s),
            false => self.canvas.time_s,
        };
        if time_s == self.time_s() || time_s.is_nan() {
            return false;
        }
        self.view = self.clip.view(&self.canvas, time_s);
        self.rev = SceneRev::fresh();
        true
    }

    /// The scene at another moment.
    pub fn at(&self, time_s: f64) -> Scene {
        let mut scene = self.clone();
        scene.show(time_s);
        scene
    }

    /// Changes the frame that is shown: parts that stand still change for all moments, moving objects as `scope` says.
    pub fn change<R>(&mut self, scope: Scope, change: impl FnOnce(&mut Frame) -> R) -> R {
        let mut frame = Frame::clone(&self.view);
        let out = change(&mut frame);
        self.set_frame(frame, scope);
        out
    }

    /// Replaces the frame that is shown by a changed version; see [`change`](Self::change).
    pub fn set_frame(&mut self, after: Frame, scope: Scope) {
        self.touch();
        if self.clip.is_still() {
            let after = Arc::new(after);
            self.canvas = after.clone();
            self.view = after;
            return;
        }
        let time_s = self.time_s();
        let boxes = self.clip.boxes_at(time_s, &self.canvas);
        let seen = ComposedFrame {
            frame: &self.view,
            boxes: &boxes,
            time_s,
        };
        let (canvas, clip) = clip::fold(&self.canvas, &self.clip, &seen, &after, scope);
        self.set_parts(canvas, clip);
    }

    /// Changes only the parts that stand still.
    pub fn change_canvas<R>(&mut self, change: impl FnOnce(&mut Frame) -> R) -> R {
        let out = change(Arc::make_mut(&mut self.canvas));
        self.touch();
        self.show_within();
        out
    }

    /// Changes the parts that move. The caller makes sure that the clip is sound.
    pub fn change_clip<R>(&mut self, change: impl FnOnce(&mut Clip) -> R) -> R {
        let out = change(Arc::make_mut(&mut self.clip));
        self.touch();
        self.show_within();
        out
    }

    /// Replaces the canvas and the clip.
    pub fn set_parts(&mut self, canvas: Frame, clip: Clip) {
        self.canvas = Arc::new(canvas);
        self.clip = Arc::new(clip);
        self.touch();
        self.show_within();
    }

    fn show_within(&mut self) {
        let time_s = match self.clip.length_s > 0.0 {
            true => self.time_s().clamp(0.0, self.clip.length_s),
            false => self.canvas.time_s,
        };
        self.view = self.clip.view(&self.canvas, time_s);
    }

    /// The scene that the networks generate from: it stands still, and shows the canvas with those moving objects whose
    /// voxels are not generated yet. The scene itself if nothing moves. The content's revision stays.
    pub fn for_generation(&self) -> Cow<'_, Scene> {
        if self.clip.is_still() {
            return Cow::Borrowed(self);
        }
        let frame = self.clip.unsettled(&self.canvas);
        Cow::Owned(Scene {
            canvas: frame.clone(),
            view: frame,
            clip: Arc::default(),
            rev: self.content,
            ..self.clone()
        })
    }

    /// Takes over the result that was generated from [`for_generation`](Self::for_generation)'s frame.
    pub fn set_generated(&mut self, after: Frame) {
        if self.clip.is_still() {
            self.set_frame(after, Scope::default());
            return;
        }
        let before = self.clip.unsettled(&self.canvas);
        let drafts = self.clip.tracks.values().filter(|t| !t.settled);
        let boxes: Vec<SceneBox> = drafts.map(|t| t.made).collect();
        let seen = ComposedFrame {
            frame: &before,
            boxes: &boxes,
            time_s: self.canvas.time_s,
        };
        let (canvas, clip) = clip::fold(&self.canvas, &self.clip, &seen, &after, Scope::default());
        self.set_parts(canvas, clip);
    }

    /// The part of the scene in the networks' window after a move by whole columns, with the whole scene moved. It
    /// stands still and shows the frame that this scene shows. The content's revision stays.
    pub fn window_at(&self, by: moved::ColumnShift) -> Scene {
        let mut scene = self.still();
        scene.view = Arc::new(self.frame().crop(by.back().extent(Extent::WINDOW)));
        scene.canvas = scene.view.clone();
        scene.moved(by)
    }
}
