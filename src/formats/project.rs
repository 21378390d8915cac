//! The project file `.loom`: a zip with the whole scene. Equal scenes give equal bytes.
//!
//! | entry | holds |
//! |---|---|
//! | `manifest.json` | `format`, `version`, `frames` |
//! | `scene.json` | all but the grids: name, prompt, conditions, words, seed, rig, background, and of each frame time, pose, boxes, polylines |
//! | `frames/00000/layout.u32` | map layers as bits, `[x][y]`, 40,000 little-endian words |
//! | `frames/00000/relief.f32` | height of the ground in each column, `[x][y]`, 40,000 little-endian numbers in m; only if it is not flat |
//! | `frames/00000/occupancy.u8` | class labels, `[x][y][z]`, 640,000 bytes |
//! | `frames/00000/painted.u8` | painted voxels, 255 where none; only if there are any |
//! | `frames/00000/unobserved.u16` | voxels that a data set's sensors did not see, a bit each; only if it says |
//! | `frames/00000/source_layout.u32`, `source_relief.f32`, `source_occupancy.u8` | of the source, only where it differs from the frame |
//!
//! Version 2 added background and relief; files of version 1 open as scenes without either. Version 3 added the conditions;
//! in older files the prompt holds them, see `old_prompt`.

mod archive;
mod check;
mod error;
mod old_prompt;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use scene::grid::NOT_PAINTED;
use scene::{
    Background, BevLayout, BoxId, Conditions, Frame, GridSpec, Inferred, Polyline, Pose, Relief, Scene,
    SceneBox, SceneRev, SensorRig, SourceFrame, Thing, Unobserved, VoxelGrid, VoxelPaint, Waiver,
};

use super::atomic;
use archive::{MAX_JSON, Reader, Writer, parse, within, wrong_voxels};
use check::check;
pub use error::ProjectError;

/// Version written.
pub const VERSION: u32 = 3;
/// Oldest version read.
const OLDEST: u32 = 1;
/// Frames a project may hold.
pub const MAX_FRAMES: usize = 10_000;

const FORMAT: &str = "sceneloom";
const MANIFEST: &str = "manifest.json";
const SCENE: &str = "scene.json";
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    format: String,
    version: u32,
    frames: usize,
}

/// The part of a manifest that every version has.
#[derive(Deserialize)]
struct AnyManifest {
    format: String,
    version: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneHeader {
    name: Arc<str>,
    prompt: Arc<str>,
    /// Since version 3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    conditions: Option<Conditions>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    words: Vec<String>,
    seed: u64,
    current: usize,
    rig: Arc<SensorRig>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    background: Vec<Thing>,
    frames: Vec<FrameHeader>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameHeader {
    time_s: f64,
    world_from_ego: Pose,
    boxes: Vec<SceneBox>,
    polylines: Arc<Vec<Polyline>>,
    /// Whether `relief.f32` is there.
    #[serde(default, skip_serializing_if = "is_false")]
    relief: bool,
    /// Whether `painted.u8` is there.
    painted: bool,
    #[serde(default, skip_serializing_if = "InferredHeader::is_empty")]
    inferred: InferredHeader,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    waivers: Vec<Waiver>,
    source: SourceHeader,
}

/// What of an imported frame is a guess.
#[derive(Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct InferredHeader {
    layout: bool,
    boxes: BTreeSet<BoxId>,
    #[serde(skip_serializing_if = "is_false")]
    background: bool,
    /// Whether `unobserved.u16` is there.
    unobserved: bool,
}

impl InferredHeader {
    fn is_empty(&self) -> bool {
        !self.layout && self.boxes.is_empty() && !self.background && !self.unobserved
    }
}

/// What is left out, or false, is as in the frame.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SourceHeader {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    boxes: Option<Vec<SceneBox>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    polylines: Option<Arc<Vec<Polyline>>>,
    /// Whether `source_layout.u32` is there.
    layout: bool,
    /// Whether `source_relief.f32` is there.
    #[serde(default, skip_serializing_if = "is_false")]
    relief: bool,
    /// Whether `source_occupancy.u8` is there.
    occupancy: bool,
}

fn is_false(flag: &bool) -> bool {
    !flag
}

/// Writes the scene to `path`, whole or not at all; the number of bytes written.
pub fn save(path: &Path, scene: &Scene) -> Result<u64, ProjectError> {
    let bytes = to_bytes(scene).map_err(|e| e.at(path))?;
    atomic::write(path, &bytes).map_err(|e| ProjectError::from(e).at(path))?;
    Ok(bytes.len() as u64)
}

/// Reads the scene at `path`. It carries a fresh revision.
pub fn load(path: &Path) -> Result<Scene, ProjectError> {
    let file = File::open(path).map_err(|e| ProjectError::from(e).at(path))?;
    read(BufReader::new(file)).map_err(|e| e.at(path))
}

/// The scene as the bytes of a project file.
pub fn to_bytes(scene: &Scene) -> Result<Vec<u8>, ProjectError> {
    check(scene)?;
    let mut out = Writer::new();
    let manifest = Manifest {
        format: FORMAT.into(),
        version: VERSION,
        frames: scene.frames.len(),
    };
    out.json(MANIFEST, &manifest)?;
    let header = SceneHeader {
        name: scene.name.clone(),
        prompt: scene.prompt.clone(),
        conditions: Some(scene.conditions),
        words: scene.words.to_vec(),
        seed: scene.seed,
        current: scene.current,
        rig: scene.rig.clone(),
        background: scene.background.iter().cloned().collect(),
        frames: scene.frames.iter().map(|f| frame_header(f)).collect(),
    };
    out.json(SCENE, &header)?;
    for ((index, frame), header) in scene.frames.iter().enumerate().zip(&header.frames) {
        let name = |part: &str| entry_name(index, part);
        out.put(&name("layout.u32"), &layout_bytes(&frame.layout))?;
        if header.relief {
            out.put(&name("relief.f32"), &relief_bytes(&frame.layout.relief))?;
        }
        out.labels(&name("occupancy.u8"), &frame.occupancy)?;
        if header.painted {
            out.labels(&name("painted.u8"), &frame.painted)?;
        }
        if let Some(unobserved) = &frame.inferred.unobserved {
            let words = unobserved.words().iter();
            let bytes: Vec<u8> = words.flat_map(|w| w.to_le_bytes()).collect();
            out.put(&name("unobserved.u16"), &bytes)?;
        }
        if header.source.layout {
            out.put(&name("source_layout.u32"), &layout_bytes(&frame.source.layout))?;
        }
        if header.source.relief {
            let bytes = relief_bytes(&frame.source.layout.relief);
            out.put(&name("source_relief.f32"), &bytes)?;
        }
        if header.source.occupancy {
            out.labels(&name("source_occupancy.u8"), &frame.source.occupancy)?;
        }
    }
    out.finish()
}

/// The scene in the bytes of a project file. It carries a fresh revision.
pub fn from_bytes(bytes: &[u8]) -> Result<Scene, ProjectError> {
    read(Cursor::new(bytes))
}

fn entry_name(frame: usize, part: &str) -> String {
    format!("frames/{frame:05}/{part}")
}

fn frame_header(frame: &Frame) -> FrameHeader {
    let source = &frame.source;
    let list = |boxes: &BTreeMap<BoxId, SceneBox>| boxes.values().copied().collect::<Vec<_>>();
    FrameHeader {
        time_s: frame.time_s,
        world_from_ego: frame.world_from_ego,
        boxes: list(&frame.boxes),
        polylines: frame.layout.polylines.clone(),
        relief: !frame.layout.relief.is_flat(),
        painted: frame.painted.count_set() > 0,
        inferred: InferredHeader {
            layout: frame.inferred.layout,
            boxes: frame.inferred.boxes.clone(),
            background: frame.inferred.background,
            unobserved: frame.inferred.unobserved.is_some(),
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

fn layout_bytes(layout: &BevLayout) -> Vec<u8> {
    layout.cells().iter().flat_map(|c| c.to_le_bytes()).collect()
}

/// Heights of all columns; zeros if flat.
fn relief_bytes(relief: &Relief) -> Vec<u8> {
    match relief.heights_m() {
        Some(heights) => heights.iter().flat_map(|h| h.to_le_bytes()).collect(),
        None => vec![0; 4 * GridSpec::COLUMNS],
    }
}

fn read_relief<R: Read + Seek>(file: &mut Reader<R>, entry: &str) -> Result<Relief, ProjectError> {
    let bytes = file.exactly(entry, GridSpec::COLUMNS, 4, "columns")?;
    let heights = bytes
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    Relief::from_heights(heights.collect()).map_err(|e| ProjectError::Unsound(format!("{entry}: {e}")))
}

fn read<R: Read + Seek>(reader: R) -> Result<Scene, ProjectError> {
    let mut file = Reader::new(reader)?;
    let any: AnyManifest = parse(MANIFEST, &file.bytes(MANIFEST, MAX_JSON)?)?;
    if any.format != FORMAT {
        return Err(ProjectError::Format { found: any.format });
    }
    if !(u64::from(OLDEST)..=u64::from(VERSION)).contains(&any.version) {
        return Err(ProjectError::Version { found: any.version });
    }
    let manifest: Manifest = parse(MANIFEST, &file.bytes(MANIFEST, MAX_JSON)?)?;
    within("the number of frames", manifest.frames as u64, MAX_FRAMES as u64)?;
    let header: SceneHeader = parse(SCENE, &file.bytes(SCENE, MAX_JSON)?)?;
    if header.frames.len() != manifest.frames {
        return Err(ProjectError::Unsound(format!(
            "scene.json: {} frames, expected {} as in manifest.json",
            header.frames.len(),
            manifest.frames
        )));
    }
    let mut frames = Vec::with_capacity(header.frames.len());
    for (index, frame) in header.frames.into_iter().enumerate() {
        frames.push(Arc::new(read_frame(&mut file, index, frame)?));
    }
    file.expect_all_read()?;
    let things = header.background.len();
    let background: Background = header.background.into_iter().collect();
    if background.len() != things {
        return Err(ProjectError::Unsound(
            "scene.json: two things of the background have the same id".into(),
        ));
    }
    let conditions = match (header.conditions, any.version) {
        (Some(conditions), _) => conditions,
        (None, 1 | 2) => old_prompt::conditions(&header.prompt, header.seed),
        (None, _) => {
            let text = "scene.json: conditions are missing, expected them since version 3";
            return Err(ProjectError::Unsound(text.into()));
        }
    };
    let scene = Scene {
        rev: SceneRev::fresh(),
        name: header.name,
        conditions,
        prompt: header.prompt,
        words: Arc::new(header.words),
        rig: header.rig,
        background: Arc::new(background),
        frames,
        current: header.current,
        seed: header.seed,
    };
    check(&scene)?;
    Ok(scene)
}

fn read_frame<R: Read + Seek>(
    file: &mut Reader<R>,
    index: usize,
    header: FrameHeader,
) -> Result<Frame, ProjectError> {
    let name = |part: &str| entry_name(index, part);
    let source = header.source;
    let mut layout = file.layout(&name("layout.u32"), header.polylines)?;
    if header.relief {
        layout.relief = read_relief(file, &name("relief.f32"))?;
    }
    let occupancy = file.occupancy(&name("occupancy.u8"), &VoxelGrid::new())?;
    let painted = match header.painted {
        true => {
            let entry = name("painted.u8");
            let dense = file.labels(&entry, NOT_PAINTED)?;
            VoxelPaint::from_dense(&dense).map_err(|found| wrong_voxels(&entry, found as u64))?
        }
        false => VoxelPaint::new(),
    };
    let unobserved = match header.inferred.unobserved {
        true => {
            let bytes = file.exactly(&name("unobserved.u16"), GridSpec::COLUMNS, 2, "columns")?;
            let words = bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]]));
            Unobserved::from_words(words.collect())
        }
        false => None,
    };
    let boxes = unique(index, header.boxes)?;
    if let Some(id) = header.inferred.boxes.iter().find(|id| !boxes.contains_key(id)) {
        return Err(ProjectError::Unsound(format!(
            "scene.json: frame {index}: box {} is marked as inferred, but there is none",
            id.0
        )));
    }
    let source_polylines = source.polylines.unwrap_or_else(|| layout.polylines.clone());
    let mut source_layout = match source.layout {
        true => file.layout(&name("source_layout.u32"), source_polylines)?,
        false => {
            let mut same_cells = layout.clone();
            same_cells.polylines = source_polylines;
            same_cells
        }
    };
    source_layout.relief = match source.relief {
        true => read_relief(file, &name("source_relief.f32"))?,
        false => layout.relief.clone(),
    };
    let source = SourceFrame {
        layout: source_layout,
        boxes: match source.boxes {
            Some(list) => unique(index, list)?,
            None => boxes.clone(),
        },
        // Bricks in which the two agree stay one memory: "what changed" compares pointers.
        occupancy: match source.occupancy {
            true => file.occupancy(&name("source_occupancy.u8"), &occupancy)?,
            false => occupancy.clone(),
        },
    };
    Ok(Frame {
        time_s: header.time_s,
        world_from_ego: header.world_from_ego,
        boxes,
        layout,
        occupancy,
        painted,
        inferred: Inferred {
            layout: header.inferred.layout,
            boxes: header.inferred.boxes,
            background: header.inferred.background,
            unobserved,
        },
        waivers: Arc::new(header.waivers),
        source: Arc::new(source),
    })
}

fn unique(frame: usize, list: Vec<SceneBox>) -> Result<BTreeMap<BoxId, SceneBox>, ProjectError> {
    let mut boxes = BTreeMap::new();
    for b in list {
        if boxes.insert(b.id, b).is_some() {
            let id = b.id.0;
            return Err(ProjectError::Unsound(format!(
                "scene.json: frame {frame}: two boxes have the id {id}"
            )));
        }
    }
    Ok(boxes)
}
