//! Training and evaluation data from procedural worlds, as safetensors shards.

pub mod layout;
pub mod lidar;
pub mod text;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use safetensors::tensor::{Dtype, TensorView};

use super::world::draw::hash;
use super::world::voxelize::{Drive, Vertical, complete, labels};
use super::world::{World, template, terrain::Terrain, traffic};
use crate::scene::{BevLayout, GridSpec, SensorRig, VoxelGrid, draft, infer, raster};

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
    let mut layout = roads(seed).unwrap_or_else(|| template::any_layout(seed));
    if layout.relief.is_flat() {
        layout.relief = Terrain::drawn(seed).relief(&layout, seed);
    }
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

/// A kind of frame that shards are made of.
pub trait Shard: Send + Sized {
    /// Names of its arrays.
    const ARRAYS: &'static [&'static str];

    /// Type, shape and bytes of each array, in that order, for some frames; the frames come first in the shape.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)>;
}

/// Writes `frames` frames as `shard_NNNNN.safetensors` into `dir`. Shards that hold all arrays of their frames are kept,
/// so an interrupted run resumes, and a larger one adds to what is there. `make` makes frame i; its first error ends the run. `progress` gets the number of
/// finished frames and may end the run by returning false.
pub fn write<F: Shard, E: From<std::io::Error> + Send>(
    dir: &Path,
    frames: usize,
    make: impl Fn(usize) -> Result<F, E> + Sync,
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
        if is_complete(&path, F::ARRAYS, n) {
            report.resumed_shards += 1;
            done.fetch_add(n, Ordering::Relaxed);
            continue;
        }
        let made: Result<Vec<F>, E> = (first..first + n)
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

/// True for a shard that holds every array, older ones lack some, of at least `frames` frames: that of an end that is no
/// longer the end has fewer.
fn is_complete(path: &Path, arrays: &[&str], frames: usize) -> bool {
    let header = || -> Option<serde_json::Value> {
        let mut file = std::fs::File::open(path).ok()?;
        let mut length = [0; 8];
        file.read_exact(&mut length).ok()?;
        let length = u64::from_le_bytes(length).min(1 << 20);
        let mut header = Vec::new();
        file.take(length).read_to_end(&mut header).ok()?;
        serde_json::from_slice(&header).ok()
    };
    let holds = |h: &serde_json::Value, name: &str| {
        let count = h.pointer(&format!("/{name}/shape/0"));
        count
            .and_then(serde_json::Value::as_u64)
            .is_some_and(|n| n >= frames as u64)
    };
    header().is_some_and(|h| arrays.iter().all(|name| holds(&h, name)))
}

fn write_shard<F: Shard>(path: &PathBuf, frames: &[F]) -> std::io::Result<u64> {
    let arrays = F::arrays(frames);
    let tensors: Result<Vec<_>, _> = F::ARRAYS
        .iter()
        .zip(&arrays)
        .map(|(name, (dtype, shape, data))| {
            let shape = [&[frames.len()], &shape[..]].concat();
            TensorView::new(*dtype, shape, data).map(|t| (*name, t))
        })
        .collect();
    let bytes = tensors
        .and_then(|t| safetensors::serialize(t, None))
        .map_err(std::io::Error::other)?;
    let mut file = tempfile::NamedTempFile::new_in(path.parent().unwrap_or(Path::new(".")))?;
    std::io::Write::write_all(&mut file, &bytes)?;
    file.persist(path)?;
    Ok(bytes.len() as u64)
}

/// Voxels of some frames, one after another.
fn voxels<'a>(grids: impl Iterator<Item = &'a VoxelGrid>) -> Vec<u8> {
    grids.flat_map(VoxelGrid::to_dense).collect()
}

impl Shard for OccupancyFrame {
    const ARRAYS: &'static [&'static str] = &["dense", "labels", "draft", "bev", "heading"];

    /// u8 `dense`, `labels`, `draft` `[N,200,200,16]`, i32 `bev` and u8 `heading` `[N,200,200]`.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let (grid, columns) = (VOXELS.to_vec(), VOXELS[..2].to_vec());
        let bev = frames.iter().flat_map(|f| &f.bev).flat_map(|b| b.to_le_bytes());
        let heading = frames.iter().flat_map(|f| &f.heading).copied();
        vec![
            (Dtype::U8, grid.clone(), voxels(frames.iter().map(|f| &f.dense))),
            (Dtype::U8, grid.clone(), voxels(frames.iter().map(|f| &f.labels))),
            (Dtype::U8, grid, voxels(frames.iter().map(|f| &f.draft))),
            (Dtype::I32, columns.clone(), bev.collect()),
            (Dtype::U8, columns, heading.collect()),
        ]
    }
}

/// Shape of a grid.
const VOXELS: [usize; 3] = [GridSpec::NX, GridSpec::NY, GridSpec::NZ];

#[cfg(test)]
mod tests {
    use super::*;

    struct Small(u8);

    impl Shard for Small {
        const ARRAYS: &'static [&'static str] = &["value"];

        fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
            vec![(Dtype::U8, Vec::new(), frames.iter().map(|f| f.0).collect())]
        }
    }

    /// A short last shard is made anew when more frames are asked for, a full one is left alone; fewer ask for nothing.
    #[test]
    fn a_short_shard_is_not_complete_for_more_frames() {
        let folder = tempfile::tempdir().expect("a folder");
        let run = |frames| {
            let make = |i: usize| -> std::io::Result<Small> { Ok(Small(i as u8)) };
            write(folder.path(), frames, make, |_| true)
                .expect("written")
                .resumed_shards
        };
        let counts = || -> Vec<Vec<u8>> {
            let read =
                |shard: usize| std::fs::read(folder.path().join(format!("shard_{shard:05}.safetensors")));
            let values = |bytes: Vec<u8>| {
                let file = safetensors::SafeTensors::deserialize(&bytes).expect("a shard");
                file.tensor("value").expect("its array").data().to_vec()
            };
            (0..3).map_while(|s| read(s).ok()).map(values).collect()
        };
        assert_eq!(run(SHARD_FRAMES + 3), 0);
        assert_eq!(run(SHARD_FRAMES + 3), 2);
        assert_eq!(run(SHARD_FRAMES + 5), 1, "the second is short");
        assert_eq!(counts(), [(0..32).collect::<Vec<u8>>(), (32..37).collect()]);
        assert_eq!(run(2 * SHARD_FRAMES + 1), 1);
        assert_eq!(run(7), 1);
        assert_eq!(counts().iter().map(Vec::len).collect::<Vec<_>>(), [32, 32, 1]);
    }
}
