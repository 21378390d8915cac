//! Training and evaluation data from procedural worlds, as safetensors shards.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use safetensors::tensor::{Dtype, TensorView};

use super::world::draw::hash;
use super::world::voxelize::{Drive, Vertical, complete, labels};
use super::world::{World, template, traffic};
use crate::scene::{BevLayout, GridSpec, SensorRig, VoxelGrid, draft, infer, raster};

/// Arrays of a shard.
const ARRAYS: [&str; 5] = ["dense", "labels", "draft", "bev", "heading"];
/// Frames per shard.
pub const SHARD_FRAMES: usize = 32;

/// One training frame of the occupancy networks.
pub struct OccupancyFrame {
    /// Every voxel of the world.
    pub dense: VoxelGrid,
    /// What a labelling drive through the world saw.
    pub labels: VoxelGrid,
    /// The layout extruded naively: a condition of the diffusion transformer.
    pub draft: VoxelGrid,
    /// 18 BEV layers as bits, `[x][y]`.
    pub bev: Vec<u32>,
    /// Headings of objects as [`raster::headings`] gives them, `[x][y]`.
    pub heading: Vec<u8>,
}

/// The world of frame `index` of the data set of `seed`, and the frame's own seed. `roads` may give a
/// layout for that seed, such as a place on an imported road; where it gives none, a template does.
pub fn world_of(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> (World, u64) {
    let seed = hash(hash(seed) ^ index);
    let layout = roads(seed).unwrap_or_else(|| template::any_layout(seed));
    let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
    (World::new(layout, boxes, seed), seed)
}

/// Frame `index` of the data set of `seed`; the same arguments give the same frame.
pub fn occupancy_frame(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> OccupancyFrame {
    let (world, seed) = world_of(seed, index, roads);
    let rig = SensorRig::default();
    OccupancyFrame {
        dense: complete(&world, Vertical::Occ3d),
        labels: labels(&world, &rig.lidars[0], &Drive::default(), Vertical::Occ3d, seed),
        draft: draft::draft(&world.layout, world.boxes.values()),
        bev: raster::bev_channels(&world.layout, world.boxes.values()),
        heading: raster::headings(world.boxes.values()),
    }
}

impl OccupancyFrame {
    /// A frame of a data set that has labels and nothing else: they are both what is seen and what is
    /// aimed at; layout and boxes are inferred.
    pub fn of_labels(labels: VoxelGrid) -> Self {
        let (layout, boxes) = (infer::layout(&labels), infer::boxes(&labels));
        Self {
            draft: draft::draft(&layout, boxes.values()),
            bev: raster::bev_channels(&layout, boxes.values()),
            heading: raster::headings(boxes.values()),
            dense: labels.clone(),
            labels,
        }
    }
}

/// What was written.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct DatasetReport {
    /// Frames in the folder.
    pub frames: usize,
    /// Bytes written by this run.
    pub bytes: u64,
    /// Shards that were there already and were left alone.
    pub resumed_shards: usize,
}

/// Writes `frames` frames as `shard_NNNNN.safetensors` into `dir`: u8 `dense`, `labels`, `draft`
/// `[N,200,200,16]`, i32 `bev` and u8 `heading` `[N,200,200]`. Shards that hold all of these are kept, so an interrupted run resumes.
/// `make` makes frame i ([`occupancy_frame`], or a file's); its first error ends the run. `progress` gets
/// the number of finished frames and may end the run by returning false.
pub fn write_occupancy<E: From<std::io::Error> + Send>(
    dir: &Path,
    frames: usize,
    make: impl Fn(usize) -> Result<OccupancyFrame, E> + Sync,
    progress: impl Fn(usize) -> bool + Sync,
) -> Result<DatasetReport, E> {
    std::fs::create_dir_all(dir)?;
    let mut report = DatasetReport {
        frames,
        ..Default::default()
    };
    let done = AtomicUsize::new(0);
    for (shard, first) in (0..frames).step_by(SHARD_FRAMES).enumerate() {
        let path = dir.join(format!("shard_{shard:05}.safetensors"));
        let n = SHARD_FRAMES.min(frames - first);
        if is_complete(&path) {
            report.resumed_shards += 1;
            done.fetch_add(n, Ordering::Relaxed);
            continue;
        }
        let made: Result<Vec<OccupancyFrame>, E> = (first..first + n)
            .into_par_iter()
            .map(|i| {
                let frame = make(i)?;
                done.fetch_add(1, Ordering::Relaxed);
                Ok(frame)
            })
            .collect();
        let made = made?;
        report.bytes += write_shard(&path, &made)?;
        if !progress(done.load(Ordering::Relaxed)) {
            break;
        }
    }
    Ok(report)
}

/// True for a shard that holds every array; older ones lack some.
fn is_complete(path: &Path) -> bool {
    let header = || -> Option<serde_json::Value> {
        let mut file = std::fs::File::open(path).ok()?;
        let mut length = [0; 8];
        file.read_exact(&mut length).ok()?;
        let length = u64::from_le_bytes(length).min(1 << 20);
        let mut header = Vec::new();
        file.take(length).read_to_end(&mut header).ok()?;
        serde_json::from_slice(&header).ok()
    };
    header().is_some_and(|h| ARRAYS.iter().all(|name| h.get(name).is_some()))
}

fn write_shard(path: &PathBuf, frames: &[OccupancyFrame]) -> std::io::Result<u64> {
    let grids = |pick: fn(&OccupancyFrame) -> &VoxelGrid| -> Vec<u8> {
        frames.iter().flat_map(|f| pick(f).to_dense()).collect()
    };
    let voxels = vec![frames.len(), GridSpec::NX, GridSpec::NY, GridSpec::NZ];
    let (dense, labels, draft) = (grids(|f| &f.dense), grids(|f| &f.labels), grids(|f| &f.draft));
    let bev: Vec<u8> = frames
        .iter()
        .flat_map(|f| f.bev.iter().flat_map(|b| b.to_le_bytes()))
        .collect();
    let heading: Vec<u8> = frames.iter().flat_map(|f| &f.heading).copied().collect();
    let view = |dtype, shape: &[usize], data| TensorView::new(dtype, shape.to_vec(), data);
    let tensors = [
        ("dense", view(Dtype::U8, &voxels, &dense)),
        ("labels", view(Dtype::U8, &voxels, &labels)),
        ("draft", view(Dtype::U8, &voxels, &draft)),
        ("bev", view(Dtype::I32, &voxels[..3], &bev)),
        ("heading", view(Dtype::U8, &voxels[..3], &heading)),
    ];
    let tensors = tensors
        .into_iter()
        .map(|(name, t)| t.map(|t| (name, t)))
        .collect::<Result<Vec<_>, _>>()
        .and_then(|t| safetensors::serialize(t, None));
    let bytes = tensors.map_err(std::io::Error::other)?;
    let mut file = tempfile::NamedTempFile::new_in(path.parent().unwrap_or(Path::new(".")))?;
    std::io::Write::write_all(&mut file, &bytes)?;
    file.persist(path)?;
    Ok(bytes.len() as u64)
}
