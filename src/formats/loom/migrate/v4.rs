//! From version 4 to 5: frames, each with grids of its own in its ego frame, become one canvas and tracks.
//!
//! The first frame is the canvas, its ego frame the world frame. Boxes that later frames show elsewhere, or do not
//! show, become tracks through those places, with draft voxels. The grids of later frames are left out: no program ever
//! wrote more than one frame of different ground.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::draft::{box_columns, ground_class};
use scene::{BoxId, Class, Extent, Key, Motion, Pose, SceneBox, Thing, Window};
use serde_json::{Map, Value, json};

use super::super::archive::MAX_JSON;
use super::super::header::{ExtentHeader, entry_name, track_entry};
use super::super::names::MAX_FRAMES;
use super::super::{ProjectError, SCENE};
use super::{Entries, Migration, MigrationChange};

pub(super) const TO_V5: Migration = Migration {
    from: 4,
    what: "one canvas in the world frame, and tracks, in place of frames",
    change: MigrationChange::Rewrites(canvas_and_clip),
};

/// Parts of a frame that are entries.
const GRIDS: [(&str, &str); 4] = [
    ("relief", "relief.f32"),
    ("painted", "painted.u8"),
    ("inferred.unobserved", "unobserved.u16"),
    ("", "layout.u32"),
];
const SOURCE_GRIDS: [(&str, &str); 2] = [("layout", "source_layout.u32"), ("relief", "source_relief.f32")];
/// How far a box may be from where it was and still stand, m (and its heading, rad).
const STILL: f64 = 0.05;
/// Largest grid of a file, bytes: four a column.
const LARGEST_GRID: u64 = (Extent::MAX_COLUMNS * Window::NZ) as u64;

fn bad(detail: impl Into<String>) -> ProjectError {
    ProjectError::Json {
        entry: SCENE.into(),
        detail: detail.into(),
    }
}

fn typed<T: serde::de::DeserializeOwned>(value: &Value, what: &str) -> Result<T, ProjectError> {
    serde_json::from_value(value.clone()).map_err(|e| bad(format!("{what}: {e}")))
}

/// A frame as far as tracks need it.
struct OldFrame {
    time_s: f64,
    world_from_ego: Pose,
    boxes: BTreeMap<BoxId, SceneBox>,
}

fn canvas_and_clip(entries: &mut dyn Entries) -> Result<(), ProjectError> {
    let counted = entries.frames();
    let scene = entries.scene()?;
    let scene = scene.as_object_mut().ok_or_else(|| bad("expected an object"))?;
    let current = scene
        .remove("current")
        .ok_or_else(|| bad("missing field `current`"))?;
    let current: usize = typed(&current, "current")?;
    let frames = scene
        .remove("frames")
        .ok_or_else(|| bad("missing field `frames`"))?;
    let Value::Array(mut frames) = frames else {
        return Err(bad("frames: expected a list"));
    };
    super::super::archive::within("the number of frames", frames.len() as u64, MAX_FRAMES as u64)?;
    if counted != Some(frames.len() as u64) || current >= frames.len() {
        return Err(ProjectError::Unsound(format!(
            "scene.json: {} frames and current {current}, expected {} as in manifest.json",
            frames.len(),
            counted.unwrap_or(0)
        )));
    }
    let old: Vec<OldFrame> = frames.iter().map(old_frame).collect::<Result<_, _>>()?;
    let first = old[0].world_from_ego;
    if first != Pose::IDENTITY
        && let Some(things) = scene.get_mut("background")
    {
        let list: Vec<Thing> = typed(things, "background")?;
        let to_ego = first.inverse();
        let moved = list.into_iter().map(|t| Thing {
            form: t.form.in_frame(&to_ego),
            ..t
        });
        *things = serde_json::to_value(moved.collect::<Vec<_>>()).map_err(|e| bad(e.to_string()))?;
    }
    let (clip, moving) = clip_of(&old);
    let mut canvas = frames.swap_remove(0);
    let fields = canvas
        .as_object_mut()
        .ok_or_else(|| bad("frames: expected objects"))?;
    fields.insert("world_from_ego".into(), value(&Pose::IDENTITY)?);
    let standing = |b: &&SceneBox| !moving.iter().any(|m| m.id == b.id);
    if !moving.is_empty() {
        let boxes: Vec<SceneBox> = old[0].boxes.values().filter(standing).copied().collect();
        fields.insert("boxes".into(), value(&boxes)?);
        fields.insert("time_s".into(), json!(0.0));
    }
    let here: Map<String, Value> = fields.clone();
    if let Some(source) = fields.get_mut("source").and_then(Value::as_object_mut)
        && let Some(boxes) = source.get_mut("boxes")
        && !moving.is_empty()
    {
        let mut list: Vec<SceneBox> = typed(boxes, "source")?;
        list.retain(|b| standing(&b));
        *boxes = value(&list)?;
    }
    scene.insert("canvas".into(), canvas);
    if let Some(clip) = clip {
        scene.insert("shown_s".into(), json!(old[current].time_s - old[0].time_s));
        scene.insert("clip".into(), clip);
    }
    move_entries(entries, &here, &old, &moving)
}

fn value(of: &impl serde::Serialize) -> Result<Value, ProjectError> {
    serde_json::to_value(of).map_err(|e| bad(e.to_string()))
}

fn old_frame(frame: &Value) -> Result<OldFrame, ProjectError> {
    let field = |name: &str| {
        frame
            .get(name)
            .ok_or_else(|| bad(format!("frames: missing field `{name}`")))
    };
    let boxes: Vec<SceneBox> = typed(field("boxes")?, "boxes")?;
    Ok(OldFrame {
        time_s: typed(field("time_s")?, "time_s")?,
        world_from_ego: typed(field("world_from_ego")?, "world_from_ego")?,
        boxes: boxes.into_iter().map(|b| (b.id, b)).collect(),
    })
}

/// The clip of several frames as JSON (none of one frame), and the boxes that move, where they are first seen.
fn clip_of(frames: &[OldFrame]) -> (Option<Value>, Vec<SceneBox>) {
    if frames.len() == 1 {
        return (None, Vec::new());
    }
    let start_s = frames[0].time_s;
    let to_world = |f: &OldFrame| frames[0].world_from_ego.inverse() * f.world_from_ego;
    let mut seen: BTreeMap<BoxId, Vec<(usize, SceneBox)>> = BTreeMap::new();
    for (i, frame) in frames.iter().enumerate() {
        let pose = to_world(frame);
        let turn_rad = turned(&pose);
        for b in frame.boxes.values() {
            let mut b = *b;
            b.center_m = pose.apply(b.center_m);
            b.yaw_rad += turn_rad;
            seen.entry(b.id).or_default().push((i, b));
        }
    }
    let key = |i: usize, at: DVec3, yaw_rad: f64| Key {
        time_s: frames[i].time_s - start_s,
        at_m: at.truncate(),
        yaw_deg: yaw_rad.to_degrees(),
    };
    let (mut tracks, mut moving) = (Vec::new(), Vec::new());
    for places in seen.values() {
        let first = places[0].1;
        let stands = places.iter().all(|(_, b)| {
            (b.center_m - first.center_m).length() < STILL && (b.yaw_rad - first.yaw_rad).abs() < STILL
        });
        if stands && places.len() == frames.len() {
            continue;
        }
        let keys: Vec<Key> = places
            .iter()
            .map(|(i, b)| key(*i, b.center_m, b.yaw_rad))
            .collect();
        let (from, last) = (places[0].0, places[places.len() - 1].0);
        let to_s = frames.get(last + 1).map(|f| f.time_s - start_s);
        let from_s = (from > 0).then(|| frames[from].time_s - start_s);
        let (low, size, _) = draft_voxels(&first);
        tracks.push(json!({
            "made": first, "motion": Motion::Keys(keys), "from_s": from_s, "to_s": to_s, "settled": false,
            "voxels_from": low, "voxels_size": size,
        }));
        moving.push(first);
    }
    let ego: Vec<Key> = frames
        .iter()
        .enumerate()
        .map(|(i, f)| {
            let pose = to_world(f);
            key(i, pose.translation_m, turned(&pose))
        })
        .collect();
    let drives = ego
        .iter()
        .any(|k| k.at_m.length() > STILL || k.yaw_deg.abs() > STILL);
    let length_s = frames[frames.len() - 1].time_s - start_s;
    let rate_hz = match length_s > 0.0 {
        true => ((frames.len() - 1) as f64 / length_s).clamp(0.1, 100.0),
        false => 10.0,
    };
    let ego = drives.then_some(Motion::Keys(ego));
    (
        Some(json!({ "length_s": length_s, "rate_hz": rate_hz, "ego": ego, "tracks": tracks })),
        moving,
    )
}

/// The heading of a pose's x axis, rad.
fn turned(pose: &Pose) -> f64 {
    (pose.rotation * DVec3::X).truncate().to_angle()
}

/// The rough profile of a box as voxels: lower corner, size, labels.
fn draft_voxels(b: &SceneBox) -> ([i32; 2], [usize; 2], Vec<u8>) {
    // A map around it; a box that stands nowhere has no voxels.
    let at = (b.center_m * 2.5).floor();
    let from = [at.x as i32 - 64, at.y as i32 - 64];
    let Ok(extent) = Extent::new(from, [128, 128]) else {
        return ([0; 2], [0; 2], Vec::new());
    };
    let columns = box_columns(extent, b);
    let low = [0, 1].map(|axis| columns.iter().map(|c| [c.0, c.1][axis]).min().unwrap_or(0));
    let high = [0, 1].map(|axis| columns.iter().map(|c| [c.0, c.1][axis] + 1).max().unwrap_or(0));
    let size = [high[0] - low[0].min(high[0]), high[1] - low[1].min(high[1])];
    let mut labels = vec![Class::FREE; size[0] * size[1] * Window::NZ];
    for (x, y, layers) in columns {
        let column = ((x - low[0]) * size[1] + y - low[1]) * Window::NZ;
        labels[column..column + layers].fill(b.class.id());
    }
    ([from[0] + low[0] as i32, from[1] + low[1] as i32], size, labels)
}

/// Puts the first frame's grids where the canvas has them, without the voxels of moving objects, drops those of other
/// frames, and adds the voxels of tracks.
fn move_entries(
    entries: &mut dyn Entries,
    first: &Map<String, Value>,
    frames: &[OldFrame],
    moving: &[SceneBox],
) -> Result<(), ProjectError> {
    let flag = |fields: &Map<String, Value>, name: &str| {
        let mut at = fields.get(name.split('.').next().unwrap_or_default());
        if let Some((_, inner)) = name.split_once('.') {
            at = at.and_then(|v| v.get(inner));
        }
        name.is_empty() || at.and_then(Value::as_bool).unwrap_or(false)
    };
    let source = first
        .get("source")
        .and_then(Value::as_object)
        .cloned()
        .unwrap_or_default();
    let extent = match first.get("extent") {
        Some(extent) => typed::<ExtentHeader>(extent, "extent")?
            .extent()
            .map_err(|e| bad(format!("frame 0: {e}")))?,
        None => Extent::WINDOW,
    };
    let old_name = |frame: usize, part: &str| format!("frames/{frame:05}/{part}");
    let own = GRIDS.iter().filter(|(name, _)| flag(first, name));
    let of_source = SOURCE_GRIDS.iter().filter(|(name, _)| flag(&source, name));
    for (_, part) in own.chain(of_source) {
        let bytes = entries.take(&old_name(0, part), LARGEST_GRID)?;
        entries.put(&entry_name(part), bytes);
    }
    let layout = match moving.is_empty() {
        true => Vec::new(),
        false => entries.take(&entry_name("layout.u32"), LARGEST_GRID)?,
    };
    if !moving.is_empty() {
        entries.put(&entry_name("layout.u32"), layout.clone());
    }
    for part in ["occupancy.u8", "source_occupancy.u8"] {
        if part.starts_with("source") && !flag(&source, "occupancy") {
            continue;
        }
        let mut bytes = entries.take(&old_name(0, part), LARGEST_GRID)?;
        for b in moving.iter().filter(|b| frames[0].boxes.contains_key(&b.id)) {
            lift(&mut bytes, &layout, extent, b);
        }
        entries.put(&entry_name(part), bytes);
    }
    for b in moving {
        entries.put(&track_entry(b.id), draft_voxels(b).2);
    }
    for frame in 1..frames.len() {
        for part in [
            "layout.u32",
            "relief.f32",
            "occupancy.u8",
            "painted.u8",
            "unobserved.u16",
            "source_layout.u32",
            "source_relief.f32",
            "source_occupancy.u8",
        ] {
            match entries.take(&old_name(frame, part), LARGEST_GRID.max(MAX_JSON)) {
                Ok(_) | Err(ProjectError::MissingEntry { .. }) => {}
                Err(e) => return Err(e),
            }
        }
    }
    Ok(())
}

/// Takes the voxels of a box's class out of its footprint and lays ground there.
fn lift(labels: &mut [u8], layout: &[u8], extent: Extent, b: &SceneBox) {
    if labels.len() != extent.voxels() || layout.len() != 4 * extent.columns() {
        return; // refused later, with its size
    }
    scene::raster::box_cells(extent, b, scene::clip::MARGIN_M, |x, y| {
        let at = extent.index(x, y);
        let column = &mut labels[at * Window::NZ..(at + 1) * Window::NZ];
        let word = &layout[4 * at..4 * at + 4];
        let ground = ground_class(u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
        for (z, label) in column.iter_mut().enumerate().filter(|(_, l)| **l == b.class.id()) {
            *label = if z == 0 { ground.id() } else { Class::FREE };
        }
    });
}
