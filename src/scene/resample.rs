//! Scenes in voxels of another size: what networks and sensors, which know the lattice of Occ3D, see of a map of another one.

use std::borrow::Cow;
use std::cmp::Reverse;
use std::sync::Arc;

use glam::DVec3;

use crate::clip::ObjectVoxels;
use crate::grid::{BrickGrid, NOT_PAINTED, lower, raise};
use crate::{
    BevLayer, BevLayout, Class, Clip, Extent, Frame, Inferred, Lattice, Relief, Scene, SourceFrame,
    Unobserved, VoxelGrid, VoxelPaint,
};

impl Scene {
    /// The scene with voxels of another lattice; the scene itself if it has that one. A voxel that is no smaller than those
    /// before has the most frequent class of those with their middle in it, a smaller one that of the voxel that holds its own
    /// middle. The revisions stay.
    pub fn in_lattice(&self, lattice: Lattice) -> Cow<'_, Scene> {
        if self.canvas().extent().lattice() == lattice {
            return Cow::Borrowed(self);
        }
        let mut scene = self.clone();
        scene.canvas = Arc::new(frame_in(self.canvas(), lattice));
        scene.view = match Arc::ptr_eq(&self.canvas, &self.view) {
            true => scene.canvas.clone(),
            false => Arc::new(frame_in(&self.view, lattice)),
        };
        if !self.clip().is_still() {
            scene.clip = Arc::new(clip_in(self.clip(), lattice));
        }
        Cow::Owned(scene)
    }
}

/// A shared scene with voxels of another lattice; see [`Scene::in_lattice`].
pub fn shared_in(scene: &Arc<Scene>, lattice: Lattice) -> Arc<Scene> {
    match scene.in_lattice(lattice) {
        Cow::Borrowed(_) => scene.clone(),
        Cow::Owned(other) => Arc::new(other),
    }
}

/// Columns from the origin to each side of a map whose columns are too many in another lattice.
const MOST_FROM_ORIGIN: i32 = 1024;

impl Extent {
    /// The smallest extent of another lattice that covers the same ground, or, where none may be so large, its part around the
    /// origin.
    pub fn in_lattice(&self, lattice: Lattice) -> Self {
        if self.lattice() == lattice {
            return *self;
        }
        let (low, high) = (self.min_m() * lattice.per_m(), self.max_m() * lattice.per_m());
        // A corner on a border of columns, but for rounding, begins no further column.
        let from = [low.x, low.y].map(|v| (v + 1e-6).floor() as i32);
        let to = [high.x, high.y].map(|v| (v - 1e-6).ceil() as i32);
        let over = |from: [i32; 2], to: [i32; 2]| {
            let size = [0, 1].map(|axis| (to[axis] - from[axis]).max(1) as usize);
            Self::over(lattice, from, size)
        };
        let near = |v: i32| v.clamp(-MOST_FROM_ORIGIN, MOST_FROM_ORIGIN);
        over(from, to)
            .or_else(|_| over(from.map(near), to.map(near)))
            .unwrap_or(Self::WINDOW)
    }
}

fn clip_in(clip: &Clip, lattice: Lattice) -> Clip {
    let mut clip = clip.clone();
    for track in clip.tracks.values_mut() {
        track.voxels = ObjectVoxels::drafted(lattice, &track.made);
        track.own_shape = false;
    }
    clip
}

fn frame_in(frame: &Frame, lattice: Lattice) -> Frame {
    let (from, to) = (frame.extent(), frame.extent().in_lattice(lattice));
    let occupancy = voxels_in(&frame.occupancy, to);
    let source = SourceFrame {
        layout: layout_in(&frame.source.layout, to),
        boxes: frame.source.boxes.clone(),
        occupancy: match frame.source.occupancy == frame.occupancy {
            true => occupancy.clone(),
            false => voxels_in(&frame.source.occupancy, to),
        },
    };
    let unobserved = frame.inferred.unobserved.as_ref();
    Frame {
        layout: layout_in(&frame.layout, to),
        painted: paint_in(&frame.painted, &occupancy),
        inferred: Inferred {
            unobserved: unobserved.and_then(|unobserved| unobserved_in(unobserved, from, to)),
            data_labels: None,
            ..frame.inferred.clone()
        },
        occupancy,
        source: Arc::new(source),
        own_shapes: Arc::default(),
        ..frame.clone()
    }
}

/// A voxel's number at its true height, and a label.
type Vote = (u32, u8);

/// Labels of a map in the voxels of another one.
pub fn voxels_in(grid: &VoxelGrid, to: Extent) -> VoxelGrid {
    let from = grid.extent();
    if from == to {
        return grid.clone();
    }
    let mut out = VoxelGrid::over(to);
    if from.voxel_m() <= to.voxel_m() {
        let mut votes = votes(grid, to);
        votes.sort_unstable();
        let bins = to.lattice().true_bins();
        let mut column = vec![Class::FREE; bins];
        for of_column in votes.chunk_by(|a, b| a.0 as usize / bins == b.0 as usize / bins) {
            column.fill(Class::FREE);
            for of_voxel in of_column.chunk_by(|a, b| a.0 == b.0) {
                column[of_voxel[0].0 as usize % bins] = winner(of_voxel);
            }
            put(&mut out, of_column[0].0 as usize / bins, &mut column);
        }
        return out;
    }
    let mut raised = vec![Class::FREE; from.lattice().true_bins()];
    let mut column = vec![Class::FREE; to.lattice().true_bins()];
    for at in 0..to.columns() {
        let [x, y] = to.column(at);
        let p = to.center(x, y, 0);
        let Some([i, j]) = from.column_at(p.x, p.y) else {
            continue;
        };
        let labels = grid.column(i, j);
        if labels.iter().all(|label| *label == Class::FREE) {
            continue;
        }
        raise(from.lattice(), labels, &mut raised);
        for (z, label) in column.iter_mut().enumerate() {
            let bin = from.to_voxel_units(to.center(x, y, z)).z.floor();
            let held = (bin >= 0.0).then_some(bin as usize);
            *label = held
                .and_then(|bin| raised.get(bin))
                .copied()
                .unwrap_or(Class::FREE);
        }
        put(&mut out, at, &mut column);
    }
    out
}

/// The labels of all voxels that are not free, each for the voxel of another map that holds its middle.
fn votes(grid: &VoxelGrid, to: Extent) -> Vec<Vote> {
    let from = grid.extent();
    let bins = to.lattice().true_bins();
    let mut raised = vec![Class::FREE; from.lattice().true_bins()];
    let mut votes = Vec::new();
    for [x, y] in from.all_columns() {
        let labels = grid.column(x, y);
        let p = from.center(x, y, 0);
        let Some([i, j]) = to.column_at(p.x, p.y) else {
            continue;
        };
        if labels.iter().all(|label| *label == Class::FREE) {
            continue;
        }
        raise(from.lattice(), labels, &mut raised);
        for (z, label) in raised.iter().enumerate().filter(|(_, l)| **l != Class::FREE) {
            let bin = to.to_voxel_units(from.center(x, y, z)).z.floor();
            if bin >= 0.0 && bin < bins as f64 {
                votes.push(((to.index(i, j) * bins + bin as usize) as u32, *label));
            }
        }
    }
    votes
}

/// The most frequent label of sorted votes on one voxel; of equally many the lowest, "others" last.
fn winner(votes: &[Vote]) -> u8 {
    let of_one = votes.chunk_by(|a, b| a.1 == b.1);
    let best = of_one.max_by_key(|v| (v.len(), v[0].1 != Class::Others.id(), Reverse(v[0].1)));
    best.map_or(Class::FREE, |v| v[0].1)
}

/// Puts a column at true heights into a grid, lowered as the grid's labels are.
fn put(grid: &mut VoxelGrid, at: usize, column: &mut [u8]) {
    let extent = grid.extent();
    lower(extent.lattice(), column);
    let labels = &column[..extent.nz()];
    if labels.iter().any(|label| *label != Class::FREE) {
        let [x, y] = extent.column(at);
        grid.column_mut(x, y).copy_from_slice(labels);
    }
}

/// Layers of a map in the columns of another one: areas as the column that holds a middle has them, lines wherever a column
/// touches one. Heights of the ground between middles.
fn layout_in(layout: &BevLayout, to: Extent) -> BevLayout {
    let from = layout.extent();
    let areas: u32 = BevLayer::GROUND.iter().map(|layer| layer.bit()).sum();
    let mut cells = vec![0; to.columns()];
    for (at, cell) in cells.iter_mut().enumerate() {
        let [x, y] = to.column(at);
        let p = to.center(x, y, 0);
        if let Some([i, j]) = from.column_at(p.x, p.y) {
            let word = layout.cell(i, j);
            *cell = if from.voxel_m() > to.voxel_m() {
                word
            } else {
                word & areas
            };
        }
    }
    if from.voxel_m() <= to.voxel_m() {
        for [x, y] in from.all_columns() {
            let p = from.center(x, y, 0);
            if let Some([i, j]) = to.column_at(p.x, p.y) {
                cells[to.index(i, j)] |= layout.cell(x, y) & !areas;
            }
        }
    }
    let mut out = BevLayout::over(to);
    if let Ok(layers) = BevLayout::from_cells_over(to, cells, Vec::new()) {
        out = layers;
    }
    out.polylines = layout.polylines.clone();
    if !layout.relief.is_flat() {
        out.relief = Relief::from_fn(to, |p| layout.relief.height_m(p));
    }
    out
}

/// Painted voxels: those that hold the middle of a painted one or lie in it, with the label that is there.
fn paint_in(painted: &VoxelPaint, occupancy: &VoxelGrid) -> VoxelPaint {
    let (from, to) = (painted.extent(), occupancy.extent());
    let mut out: VoxelPaint = BrickGrid::over(to);
    let mut put = |[x, y, z]: [usize; 3]| out.set(x, y, z, occupancy.get(x, y, z));
    if from.voxel_m() <= to.voxel_m() {
        for (x, y, z, _) in painted.iter_set() {
            to.voxel_at(from.center(x, y, z)).into_iter().for_each(&mut put);
        }
        return out;
    }
    for [x, y] in to.all_columns() {
        for z in 0..to.nz() {
            let held = from.voxel_at(to.center(x, y, z));
            if held.is_some_and(|[i, j, k]| painted.get(i, j, k) != NOT_PAINTED) {
                put([x, y, z]);
            }
        }
    }
    out
}

/// Voxels that nothing observed: of all bins that a label may stand for, its own and those above by which its lattice lets
/// labels down, the middle lies in one that nothing observed.
fn unobserved_in(unobserved: &Unobserved, from: Extent, to: Extent) -> Option<Unobserved> {
    let word = |[x, y]: [usize; 2]| {
        let p = to.center(x, y, 0);
        let Some([i, j]) = from.column_at(p.x, p.y) else {
            return 0;
        };
        let of = unobserved.words()[from.index(i, j)];
        let is_hidden = |z: usize| {
            let bin = from.to_voxel_units(DVec3::new(p.x, p.y, to.center(x, y, z).z)).z;
            bin >= 0.0 && bin < from.nz() as f64 && of >> bin as u64 & 1 == 1
        };
        let is_set = |z: usize| (z..=z + to.lattice().lowered()).all(is_hidden);
        (0..to.nz())
            .filter(|z| is_set(*z))
            .fold(0, |word, z| word | 1 << z)
    };
    Unobserved::from_words(to, to.all_columns().map(word).collect())
}
