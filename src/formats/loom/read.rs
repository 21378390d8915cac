//! A scene out of the entries of a project file, whatever its version.

use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::sync::Arc;

use scene::clip::ObjectVoxels;
use scene::grid::NOT_PAINTED;
use scene::label_sets;
use scene::message::quoted;
use scene::{
    Background, BoxId, Clip, DataLabels, Extent, Frame, Inferred, Lattice, ProjectHistory, Relief, Scene,
    SceneBox, SourceFrame, Track, Unobserved, VoxelGrid, VoxelPaint,
};

use super::archive::{MAX_JSON, Reader, parse, within, wrong_voxels};
use super::beside;
use super::check::check;
use super::header::{
    ClipHeader, DATA_LABELS, DataLabelsHeader, FrameHeader, SceneHeader, entry_name, track_entry,
    unobserved_entry,
};
use super::manifest::{AnyManifest, Manifest};
use super::migrate::{Migration, Old};
use super::{MANIFEST, ProjectError, SCENE};

/// The scene in a project file with all that is kept beside it. `migrations` lead from older versions to this one, each by one.
pub(super) fn read<R: Read + Seek>(reader: R, migrations: &[Migration]) -> Result<Scene, ProjectError> {
    read_with(reader, migrations, beside::read)
}

/// The scene in a project file without what is kept beside it. Files within files are read so: those may hold others, to any
/// depth.
pub(super) fn read_alone<R: Read + Seek>(reader: R, migrations: &[Migration]) -> Result<Scene, ProjectError> {
    read_with(reader, migrations, |file| {
        file.forget("");
        Ok(ProjectHistory::default())
    })
}

fn read_with<R: Read + Seek>(
    reader: R,
    migrations: &[Migration],
    beside: impl FnOnce(&mut Reader<R>) -> Result<ProjectHistory, ProjectError>,
) -> Result<Scene, ProjectError> {
    let mut file = Reader::new(reader)?;
    let text = file.bytes(MANIFEST, MAX_JSON)?;
    let version = AnyManifest::parse(&text)?.version(migrations)?;
    let manifest: Manifest = parse(MANIFEST, &text)?;
    let mut old = Old::new(&mut file, manifest.frames);
    for step in migrations.iter().filter(|step| step.from >= version) {
        old.migrate(step)?;
    }
    let text = old.finish()?;
    let header: SceneHeader = parse(SCENE, &text)?;
    let canvas = read_canvas(&mut file, header.canvas)?;
    let clip = match header.clip {
        Some(clip) => read_clip(&mut file, clip, canvas.extent().lattice())?,
        None => Clip::default(),
    };
    let kept = beside(&mut file)?;
    file.expect_all_read()?;
    let things = header.background.len();
    let background: Background = header.background.into_iter().collect();
    if background.len() != things {
        return Err(ProjectError::Unsound(
            "scene.json: two things of the background have the same id".into(),
        ));
    }
    let mut scene = Scene::single(&header.name, canvas, header.rig, header.seed);
    scene.prompt = header.prompt;
    scene.conditions = header.conditions;
    scene.words = Arc::new(header.words);
    scene.background = Arc::new(background);
    scene.roads = header.roads;
    scene.arranged = header.arranged;
    scene.kept = Arc::new(kept);
    scene.change_clip(|empty| *empty = clip);
    check(&scene)?;
    scene.show(header.shown_s);
    Ok(scene)
}

fn read_clip<R: Read + Seek>(
    file: &mut Reader<R>,
    header: ClipHeader,
    lattice: Lattice,
) -> Result<Clip, ProjectError> {
    within(
        "the number of tracks",
        header.tracks.len() as u64,
        Clip::MAX_TRACKS as u64,
    )?;
    let mut tracks = BTreeMap::new();
    for track in header.tracks {
        let id = track.made.id;
        let [nx, ny] = track.voxels_size;
        let count = nx.checked_mul(ny).filter(|n| *n <= ObjectVoxels::MAX_COLUMNS);
        let Some(count) = count else {
            return Err(ProjectError::Unsound(format!(
                "scene.json: track {}: voxels of {nx} x {ny} columns, expected at most {}",
                id.0,
                ObjectVoxels::MAX_COLUMNS
            )));
        };
        let labels = file.exactly(&track_entry(id), count * lattice.bins(), 1, "voxels")?;
        let voxels = match count {
            0 => ObjectVoxels::clone(&ObjectVoxels::empty()),
            _ => ObjectVoxels {
                lattice,
                from: track.voxels_from,
                size: track.voxels_size,
                labels,
            },
        };
        let track = Track {
            made: track.made,
            motion: track.motion,
            there_s: [track.from_s, track.to_s],
            voxels: Arc::new(voxels),
            settled: track.settled,
            own_shape: track.own_shape,
        };
        if tracks.insert(id, track).is_some() {
            return Err(ProjectError::Unsound(format!(
                "scene.json: two tracks have the id {}",
                id.0
            )));
        }
    }
    Ok(Clip {
        length_s: header.length_s,
        rate_hz: header.rate_hz,
        ego: header.ego,
        tracks,
    })
}

fn read_canvas<R: Read + Seek>(file: &mut Reader<R>, header: FrameHeader) -> Result<Frame, ProjectError> {
    let name = entry_name;
    let source = header.source;
    let extent = match &header.extent {
        None => Extent::WINDOW,
        Some(extent) => extent
            .extent()
            .map_err(|e| ProjectError::Unsound(format!("scene.json: canvas: {e}")))?,
    };
    let mut layout = file.layout(&name("layout.u32"), extent, header.polylines)?;
    if header.relief {
        layout.relief = read_relief(file, &name("relief.f32"), extent)?;
    }
    let occupancy = file.occupancy(&name("occupancy.u8"), &VoxelGrid::over(extent))?;
    let painted = match header.painted {
        true => {
            let entry = name("painted.u8");
            let dense = file.labels(&entry, extent, NOT_PAINTED)?;
            VoxelPaint::from_dense_over(extent, &dense)
                .map_err(|found| wrong_voxels(&entry, extent, found as u64))?
        }
        false => VoxelPaint::over(extent),
    };
    let unobserved = match header.inferred.unobserved {
        true => {
            let (entry, width) = unobserved_entry(extent);
            let bytes = file.exactly(&name(entry), extent.columns(), width, "columns")?;
            let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, b| word << 8 | u64::from(*b));
            Unobserved::from_words(extent, bytes.chunks_exact(width).map(word).collect())
        }
        false => None,
    };
    let data_labels = header.inferred.data_labels.as_ref();
    let data_labels = data_labels
        .map(|told| read_data_labels(file, told, extent))
        .transpose()?;
    let boxes = unique(header.boxes)?;
    if let Some(id) = header.inferred.boxes.iter().find(|id| !boxes.contains_key(id)) {
        return Err(ProjectError::Unsound(format!(
            "scene.json: canvas: box {} is marked as inferred, but there is none",
            id.0
        )));
    }
    let source_polylines = source.polylines.unwrap_or_else(|| layout.polylines.clone());
    let mut source_layout = match source.layout {
        true => file.layout(&name("source_layout.u32"), extent, source_polylines)?,
        false => {
            let mut same_cells = layout.clone();
            same_cells.polylines = source_polylines;
            same_cells
        }
    };
    source_layout.relief = match source.relief {
        true => read_relief(file, &name("source_relief.f32"), extent)?,
        false => layout.relief.clone(),
    };
    let source = SourceFrame {
        layout: source_layout,
        boxes: match source.boxes {
            Some(list) => unique(list)?,
            None => boxes.clone(),
        },
        // Bricks that are equal in both are shared in memory: the test for changes compares pointers.
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
            data_labels,
            recorded: Arc::new(header.inferred.recorded),
        },
        waivers: Arc::new(header.waivers),
        source: Arc::new(source),
        absent: Arc::default(),
        own_shapes: Arc::default(),
        covered_m: Arc::default(),
    })
}

/// Labels of a data set on a map. Errors on a set that is not known, and on voxels beyond the map.
fn read_data_labels<R: Read + Seek>(
    file: &mut Reader<R>,
    told: &DataLabelsHeader,
    extent: Extent,
) -> Result<DataLabels, ProjectError> {
    let unsound = |what: String| ProjectError::Unsound(format!("scene.json: canvas: data_labels: {what}"));
    let set = label_sets::from_id(&told.set).ok_or_else(|| {
        let known: Vec<&str> = label_sets::ALL.iter().map(|set| set.id).collect();
        unsound(format!(
            "set {}, expected one of {}",
            quoted(&told.set, 40),
            known.join(", ")
        ))
    })?;
    let most = extent.voxels().min(MOST_LABELS);
    if told.special > most {
        return Err(unsound(format!(
            "{} labels, expected at most {most}",
            told.special
        )));
    }
    let bytes = file.exactly(&entry_name(DATA_LABELS), told.special, 8, "labels")?;
    let words = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|word| u32::from_le_bytes(*word));
    let words: Vec<u32> = words.collect();
    let rows = words.as_chunks::<2>().0.iter();
    let rows: Option<Vec<(u32, u16)>> = rows
        .map(|[at, label]| Some((*at, u16::try_from(*label).ok()?)))
        .collect();
    let labels = rows.and_then(|rows| DataLabels::from_numbered(set, extent, told.free, rows));
    labels.ok_or_else(|| {
        unsound("labels that do not ascend by voxel, lie beyond the map or say no more than a class".into())
    })
}

/// Most labels of a data set that are read.
const MOST_LABELS: usize = 1 << 26;

fn unique(list: Vec<SceneBox>) -> Result<BTreeMap<BoxId, SceneBox>, ProjectError> {
    let mut boxes = BTreeMap::new();
    for b in list {
        if boxes.insert(b.id, b).is_some() {
            let id = b.id.0;
            return Err(ProjectError::Unsound(format!(
                "scene.json: canvas: two boxes have the id {id}"
            )));
        }
    }
    Ok(boxes)
}

fn read_relief<R: Read + Seek>(
    file: &mut Reader<R>,
    entry: &str,
    extent: Extent,
) -> Result<Relief, ProjectError> {
    let bytes = file.exactly(entry, extent.columns(), 4, "columns")?;
    let heights = bytes
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    Relief::from_heights(extent, heights.collect())
        .map_err(|e| ProjectError::Unsound(format!("{entry}: {e}")))
}
