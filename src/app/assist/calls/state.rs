//! `state`: a description of the scene.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, draft_columns};
use scene::{BevLayer, BoxLabel, Class, Conditions, Frame, PolylineKind, Scene, SceneBox};

/// Lines of the map that are listed at most, of each kind.
const MOST_LINES: usize = 60;
/// Points that a listed line has at most.
const MOST_POINTS: usize = 8;
/// Boxes that are listed at most.
const MOST_BOXES: usize = 1000;

/// Arguments of `state`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GetState {
    /// Boxes that are listed, the nearest to the ego vehicle first; at most 1000.
    #[serde(default = "usual_boxes")]
    #[schemars(range(max = 1000))]
    most_boxes: usize,
    /// List the lanes, dividers, stop lines and crossings too.
    #[serde(default = "yes")]
    roads: bool,
}

fn usual_boxes() -> usize {
    100
}

fn yes() -> bool {
    true
}

/// Receipt of `state`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct StateReceipt {
    /// Number of the state that the scene is in.
    revision: u64,
    /// Name of the scene.
    name: String,
    /// Text that describes its style; empty when none.
    prompt: String,
    /// Words that were typed to make it and to change it.
    words: Vec<String>,
    /// Light and air.
    conditions: Conditions,
    /// The area that the map covers.
    map: MapArea,
    /// Time.
    clip: ClipState,
    /// How much of what there is.
    counts: StateCounts,
    /// Boxes, the nearest first.
    boxes: Vec<BoxState>,
    /// True if there are more boxes than are listed.
    more_boxes: bool,
    /// Lines of the map, if they were asked for.
    roads: Option<MapLines>,
    /// Columns of voxels that only sketch what was edited; `generate` draws them.
    draft_columns: usize,
    /// Name of the step that undo takes back; none if there is none.
    undo: Option<String>,
    /// Name of the step that redo brings back.
    redo: Option<String>,
    /// True if there are changes that no file has.
    unsaved: bool,
    /// Names of the cameras.
    cameras: Vec<String>,
}

/// The area that a map covers, world frame.
#[derive(Debug, Serialize, JsonSchema)]
pub struct MapArea {
    /// Its lower corner, x and y, m.
    min_m: [f64; 2],
    /// Its upper corner, m.
    max_m: [f64; 2],
    /// Cells along x and y, 0.4 m each.
    cells: [usize; 2],
    /// Where the ego vehicle is: x, y, z in m.
    ego_m: [f64; 3],
}

/// Time.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ClipState {
    /// How long the scene lasts, s; 0 for one moment.
    length_s: f64,
    /// The moment that is shown, s.
    time_s: f64,
    /// Frames per second of what is exported.
    rate_hz: f64,
    /// True if the ego vehicle moves.
    ego_moves: bool,
    /// Objects that move.
    tracks: usize,
}

/// How much of what there is.
#[derive(Debug, Serialize, JsonSchema)]
pub struct StateCounts {
    /// Boxes.
    boxes: usize,
    /// Boxes by class.
    boxes_by_class: BTreeMap<String, usize>,
    /// Things beside the road by kind.
    things: BTreeMap<String, usize>,
    /// Voxels that are not free.
    occupied_voxels: usize,
    /// Voxels by class.
    voxels_by_class: BTreeMap<String, usize>,
    /// Area of each map layer, m2.
    layers_m2: BTreeMap<String, f64>,
}

/// A box as it is at the moment that is shown.
#[derive(Debug, Serialize, JsonSchema)]
pub struct BoxState {
    /// Its number, by which edits name it.
    id: u32,
    /// Its class.
    class: Class,
    /// Its name and its paint.
    label: BoxLabel,
    /// Its middle, world frame, m.
    center_m: [f64; 3],
    /// Length, width, height, m.
    size_m: [f64; 3],
    /// Heading, degrees counter-clockwise from x.
    yaw_deg: f64,
    /// Velocity over ground, world frame, m/s.
    velocity_mps: [f64; 2],
    /// Its place in words, as seen from the ego vehicle.
    place: String,
    /// True if it has a track.
    moves: bool,
}

/// Lines of the map, world frame, m; long ones are thinned out.
#[derive(Debug, Serialize, JsonSchema)]
pub struct MapLines {
    /// Middles of lanes, in driving direction.
    lanes: Vec<Vec<[f64; 2]>>,
    /// Lines between opposite directions.
    road_dividers: Vec<Vec<[f64; 2]>>,
    /// Stop lines.
    stop_lines: Vec<Vec<[f64; 2]>>,
    /// Outlines of crossings.
    crossings: Vec<Vec<[f64; 2]>>,
    /// True if there are more lines than are listed.
    more: bool,
}

/// Rounded to centimetres: numbers to look at.
fn tidy(v: f64) -> f64 {
    (v * 100.0).round() / 100.0 + 0.0
}

/// Place of a box in words, as seen from the ego vehicle: `12 m ahead, 3 m left`.
fn place(frame: &Frame, b: &SceneBox) -> String {
    let p = frame.world_from_ego.inverse().apply(b.center_m);
    let along = if p.x >= 0.0 { "ahead" } else { "behind" };
    let across = match p.y {
        y if y > 0.5 => format!(", {y:.0} m left"),
        y if y < -0.5 => format!(", {:.0} m right", -y),
        _ => String::new(),
    };
    format!("{:.0} m {along}{across}", p.x.abs())
}

fn box_state(scene: &Scene, b: &SceneBox) -> BoxState {
    BoxState {
        id: b.id.0,
        class: b.class,
        label: b.label,
        center_m: b.center_m.to_array().map(tidy),
        size_m: b.size_m.to_array().map(tidy),
        yaw_deg: tidy(b.yaw_rad.to_degrees()),
        velocity_mps: b.velocity_mps.to_array().map(tidy),
        place: place(scene.frame(), b),
        moves: scene.clip().tracks.get(&b.id).is_some_and(|t| !t.stands()),
    }
}

fn roads(frame: &Frame) -> MapLines {
    let mut more = false;
    let mut of = |kind: PolylineKind| -> Vec<Vec<[f64; 2]>> {
        let lines = frame.layout.polylines.iter().filter(|l| l.kind == kind);
        more |= lines.clone().count() > MOST_LINES;
        let thin = |points: &[glam::DVec2]| {
            let last = points.len().saturating_sub(1);
            let step = last.div_ceil(MOST_POINTS - 1).max(1);
            let kept = points
                .iter()
                .enumerate()
                .filter(|(i, _)| i % step == 0 || *i == last);
            kept.map(|(_, p)| p.to_array().map(tidy)).collect()
        };
        lines.take(MOST_LINES).map(|l| thin(&l.points_m)).collect()
    };
    let (lanes, road_dividers) = (of(PolylineKind::LaneCenter), of(PolylineKind::RoadDivider));
    let (stop_lines, crossings) = (of(PolylineKind::StopLine), of(PolylineKind::PedCrossing));
    MapLines {
        lanes,
        road_dividers,
        stop_lines,
        crossings,
        more,
    }
}

fn counts(scene: &Scene) -> StateCounts {
    let frame = scene.frame();
    let (mut boxes_by_class, mut things) = (BTreeMap::new(), BTreeMap::new());
    for b in frame.boxes.values() {
        *boxes_by_class.entry(b.class.name().to_owned()).or_default() += 1;
    }
    for thing in scene.background.iter() {
        *things.entry(thing.form.name().to_owned()).or_default() += 1;
    }
    let of_classes = frame.occupancy.class_counts();
    let voxels = Class::ALL.into_iter().filter(|c| *c != Class::Free);
    let voxels = voxels.map(|c| (c.name().to_owned(), of_classes[usize::from(c.id())]));
    let voxel_m = frame.extent().voxel_m();
    let area = |layer: BevLayer| tidy(frame.layout.count(layer) as f64 * voxel_m * voxel_m);
    let layers = BevLayer::MAP.into_iter().map(|l| (l.name().to_owned(), area(l)));
    StateCounts {
        boxes: frame.boxes.len(),
        boxes_by_class,
        things,
        occupied_voxels: frame.occupancy.count_set(),
        voxels_by_class: voxels.filter(|(_, n)| *n > 0).collect(),
        layers_m2: layers.filter(|(_, m2)| *m2 > 0.0).collect(),
    }
}

impl Operation for GetState {
    const NAME: &'static str = "state";
    const ABOUT: &'static str = "Tells what is in the scene at the moment that is shown: boxes with id, class and place, lanes and crossings of the map, light and air, length, counts of voxels. World frame: x ahead at the start, y left, z up, m and degrees. Call it first, and whenever ids or places are needed.";
    const EXAMPLE: &'static str = r#"{"most_boxes": 50, "roads": true}"#;
    const CHANGES: bool = false;
    type Receipt = StateReceipt;

    fn run(self, desk: &mut Desk) -> anyhow::Result<StateReceipt> {
        let own = desk.is_own();
        let (scene, undo, redo, unsaved) = desk.look(move |document| {
            let name = |label: Option<&str>| label.map(str::to_owned);
            (
                document.settled_scene().clone(),
                name(if own {
                    document.undo_label()
                } else {
                    document.undo_own_label()
                }),
                name(if own {
                    document.redo_label()
                } else {
                    document.redo_own_label()
                }),
                document.is_dirty(),
            )
        })?;
        let (frame, clip) = (scene.frame(), scene.clip());
        let ego_m = frame.world_from_ego.translation_m;
        let mut nearest: Vec<&SceneBox> = frame.boxes.values().collect();
        nearest.sort_by(|a, b| {
            let far = |b: &SceneBox| b.center_m.distance(ego_m);
            far(a).total_cmp(&far(b)).then(a.id.cmp(&b.id))
        });
        let most = self.most_boxes.min(MOST_BOXES);
        let (min, max) = (frame.extent().min_m(), frame.extent().max_m());
        Ok(StateReceipt {
            revision: desk.number(scene.content()),
            name: scene.name.to_string(),
            prompt: scene.prompt.to_string(),
            words: scene.words.to_vec(),
            conditions: scene.conditions,
            map: MapArea {
                min_m: [min.x, min.y].map(tidy),
                max_m: [max.x, max.y].map(tidy),
                cells: [frame.extent().nx(), frame.extent().ny()],
                ego_m: ego_m.to_array().map(tidy),
            },
            clip: ClipState {
                length_s: clip.length_s,
                time_s: scene.time_s(),
                rate_hz: clip.rate_hz,
                ego_moves: clip.ego.is_some(),
                tracks: clip.tracks.len(),
            },
            counts: counts(&scene),
            more_boxes: nearest.len() > most,
            boxes: nearest.iter().take(most).map(|b| box_state(&scene, b)).collect(),
            roads: self.roads.then(|| roads(frame)),
            draft_columns: draft_columns(&scene),
            undo,
            redo,
            unsaved,
            cameras: scene.rig.cameras.iter().map(|c| c.name.clone()).collect(),
        })
    }
}
