//! Frames of the occupancy networks: worlds, complete and as labels, with their layout and draft.

use safetensors::tensor::Dtype;

use super::shard::Shard;
use scene::inferred::KNOWN;
use scene::{BevLayout, Extent, SensorRig, VoxelGrid, Window, draft, infer, raster};
use world::draw::hash;
use world::terrain::Terrain;
use world::voxelize::{Drive, Vertical, complete, observed_labels};
use world::{World, template, traffic};

/// One training frame of the occupancy networks.
pub struct OccupancyFrame {
    /// Every voxel of the world.
    pub dense: VoxelGrid,
    /// Labels from a simulated labelling drive through the world.
    pub labels: VoxelGrid,
    /// The layout extruded naively: a condition of the diffusion transformer.
    pub draft: VoxelGrid,
    /// 18 BEV layers as bits, `[x][y]`.
    pub bev: Vec<u32>,
    /// Headings of objects as [`raster::headings`] gives them, `[x][y]`.
    pub heading: Vec<u8>,
    /// Voxels that the labelling drive observed, `[x][y]`: a bit per voxel, and [`KNOWN`].
    pub observed: Vec<u32>,
}

/// The world of frame `index` of the data set of `seed`, and the frame's own seed. `roads` may give a layout for that
/// seed, such as a place on an imported road; if it gives `None`, a template does.
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
    let (labels, observed) = observed_labels(
        &world,
        rig.lidars.first(),
        &Drive::default(),
        Vertical::Occ3d,
        seed,
    );
    let bits = |column: &[bool]| {
        let seen = column.iter().enumerate().filter(|(_, seen)| **seen);
        seen.fold(KNOWN, |bits, (z, _)| bits | 1 << z)
    };
    OccupancyFrame {
        dense: complete(&world, Vertical::Occ3d),
        labels,
        observed: observed.chunks_exact(Window::NZ).map(bits).collect(),
        draft: draft::draft(&world.layout, world.boxes.values()),
        bev: raster::bev_channels(&world.layout, world.boxes.values()),
        heading: raster::headings(Extent::WINDOW, world.boxes.values()),
    }
}

impl OccupancyFrame {
    /// A frame of a data set that has labels alone: they are both input and target. Layout and boxes are inferred, and
    /// no voxel counts as observed.
    pub fn of_labels(labels: VoxelGrid) -> Self {
        let (layout, boxes) = (infer::layout(&labels), infer::boxes(&labels));
        Self {
            draft: draft::draft(&layout, boxes.values()),
            bev: raster::bev_channels(&layout, boxes.values()),
            heading: raster::headings(Extent::WINDOW, boxes.values()),
            dense: labels.clone(),
            labels,
            observed: vec![0; Window::COLUMNS],
        }
    }
}

impl Shard for OccupancyFrame {
    const ARRAYS: &'static [&'static str] = &["dense", "labels", "draft", "bev", "heading", "observed"];

    /// u8 `dense`, `labels`, `draft` `[N,200,200,16]`, i32 `bev` and `observed` and u8 `heading` `[N,200,200]`.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let (grid, columns) = (VOXELS.to_vec(), VOXELS[..2].to_vec());
        let bev = frames.iter().flat_map(|f| &f.bev).flat_map(|b| b.to_le_bytes());
        let observed = frames.iter().flat_map(|f| &f.observed);
        let observed = observed.flat_map(|b| b.to_le_bytes());
        let heading = frames.iter().flat_map(|f| &f.heading).copied();
        vec![
            (Dtype::U8, grid.clone(), voxels(frames.iter().map(|f| &f.dense))),
            (Dtype::U8, grid.clone(), voxels(frames.iter().map(|f| &f.labels))),
            (Dtype::U8, grid, voxels(frames.iter().map(|f| &f.draft))),
            (Dtype::I32, columns.clone(), bev.collect()),
            (Dtype::U8, columns.clone(), heading.collect()),
            (Dtype::I32, columns, observed.collect()),
        ]
    }
}

/// Shape of a grid.
pub(super) const VOXELS: [usize; 3] = [Window::NX, Window::NY, Window::NZ];

/// Voxels of some frames, one after another.
pub(super) fn voxels<'a>(grids: impl Iterator<Item = &'a VoxelGrid>) -> Vec<u8> {
    grids.flat_map(VoxelGrid::to_dense).collect()
}
