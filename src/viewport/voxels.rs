//! Occupancy as voxel faces, brick by brick; only bricks whose memory changed are meshed again, and only voxels and light
//! that differ count as changed.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::change::{EgoBounds, PictureChange, may_be_seen};
use super::drawable::{DrawContext, DrawInput, DrawLayer, Drawable, Gpu, Pipelines};
use super::light::{LightBlock, LightRays, REACH};
use super::meshing::{BrickMesh, ColumnBox, NORMALS, Solidity, Visible, join, mesh_bricks};
use super::shared::{PipelineSpec, VertexBuffer};
use super::view::nothing;
use super::{ViewCamera, ViewOptions};
use scene::grid::{BRICK, Brick, brick_columns, bricks_along};
use scene::{Extent, Lattice, VoxelGrid};

/// A vertex is one word; see [`BrickMesh::vertices`].
const STRIDE: usize = 4;

/// Light is baked in squares of so many columns, so that the cost of one is bounded whatever the map's size.
const TILE: usize = 256;

/// How far the picture of a voxel reaches beyond its projection, px.
const EDGE_PX: f64 = 2.0;

/// Drawable of the occupancy.
#[derive(Debug)]
pub(super) struct VoxelDrawable {
    pipelines: Pipelines,
    held: UploadedVoxels,
    rays: LightRays,
    lit: [usize; 2],     // columns that have light
    light: Vec<[u8; 2]>, // theirs as uploaded, `[z][y][x]`
    bricks: Vec<BrickBuffer>,
}

/// The voxels that are shown, as last uploaded.
#[derive(Debug)]
struct UploadedVoxels {
    grid: VoxelGrid, // holding it keeps the addresses of its bricks unique
    visible: Visible,
    solid: Solidity,
}

#[derive(Debug, Default)]
struct BrickBuffer {
    vertices: VertexBuffer,
    quads: [std::ops::Range<u32>; 6],
}

/// The visible part of a grid under these options.
pub(super) fn visible(lattice: Lattice, options: &ViewOptions) -> Visible {
    if !options.voxels {
        return Visible {
            hidden_classes: u32::MAX,
            below_clip: 0,
        };
    }
    let bins = match options.clip_above_m {
        // The bin that holds the height is still shown; NaN clips nothing.
        Some(z) if z.is_finite() => ((z - lattice.bottom_m()) * lattice.per_m())
            .ceil()
            .clamp(0.0, lattice.bins() as f64) as u32,
        _ => lattice.bins() as u32,
    };
    Visible {
        hidden_classes: options.hidden_classes,
        below_clip: ((1u128 << bins) - 1) as u64,
    }
}

impl Drawable for VoxelDrawable {
    fn name(&self) -> &'static str {
        "voxels"
    }

    fn prepare(&mut self, gpu: Gpu<'_>, shown: DrawInput<'_>) -> PictureChange {
        let grid = shown.scene.grid;
        let visible = visible(grid.extent().lattice(), shown.scene.options);
        if visible == self.held.visible && same_bricks(grid, &self.held.grid) {
            return PictureChange::None;
        }
        self.update(gpu, grid, visible)
    }

    fn build(&mut self, gpu: Gpu<'_>, samples: u32) {
        let spec = PipelineSpec {
            shader: "voxels",
            stride: STRIDE,
            attributes: &wgpu::vertex_attr_array![0 => Uint32],
            cull: true,
            ..PipelineSpec::OPAQUE
        };
        self.pipelines
            .build(samples, || spec.build(gpu.device, gpu.shared, samples));
    }

    /// Draws the bricks in view, nearest first, and of each only the sides that face the eye. A brick beyond -1 or 1 in
    /// the space of `clip` is out of view.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer) {
        if layer != DrawLayer::Opaque || !self.pipelines.set(pass, view) {
            return;
        }
        for (b, _) in self.in_view(view.camera, &view.clip) {
            let brick = &self.bricks[b];
            let ([x, y], _) = self.held.grid.brick_columns(b);
            let place = ((x / BRICK) | ((y / BRICK) << 16)) as u32;
            for range in facing(self.bounds_m(b), &brick.quads, view.camera) {
                brick.vertices.draw_quads_as(pass, view.shared, range, place);
            }
        }
    }

    fn memory_bytes(&self) -> u64 {
        self.bricks.iter().map(|b| b.vertices.memory_bytes()).sum()
    }

    fn quads(&self) -> usize {
        self.bricks.iter().map(|b| b.vertices.quads() as usize).sum()
    }
}

impl UploadedVoxels {
    fn nothing_of(extent: Extent) -> Self {
        Self {
            grid: VoxelGrid::over(extent),
            visible: Visible::ALL,
            solid: Solidity::empty(extent),
        }
    }

    /// Takes over a grid of the same extent. Returns the bricks to mesh again, and the columns whose shape changed.
    fn take(
        &mut self,
        grid: &VoxelGrid,
        changed: &[usize],
        visible: Visible,
    ) -> (Vec<usize>, Option<ColumnBox>) {
        let mut stale = vec![false; grid.bricks().len()];
        let mut shape_changed = None;
        for &b in changed {
            stale[b] = true;
            let columns = self.solid.update(b, &grid.bricks()[b], visible);
            if columns.is_some() {
                // Faces at a brick's border depend on its neighbours.
                neighbours(grid.extent(), b).for_each(|n| stale[n] = true);
            }
            shape_changed = join(shape_changed, columns);
        }
        self.grid = grid.clone();
        self.visible = visible;
        let stale = (0..stale.len()).filter(|&b| stale[b]).collect();
        (stale, shape_changed)
    }
}

impl VoxelDrawable {
    pub fn new() -> Self {
        Self {
            pipelines: Pipelines::default(),
            held: UploadedVoxels::nothing_of(nothing()),
            rays: LightRays::new(),
            lit: [0; 2],
            light: Vec::new(),
            bricks: vec![BrickBuffer::default()],
        }
    }

    /// Starts with an empty map of another extent.
    fn resize(&mut self, extent: Extent, lit: [usize; 2]) {
        self.held = UploadedVoxels::nothing_of(extent);
        self.lit = lit;
        self.light = vec![[255; 2]; lit[0] * lit[1] * extent.nz()];
        self.bricks.clear();
        self.bricks
            .resize_with(self.held.grid.bricks().len(), BrickBuffer::default);
    }

    /// Takes over a grid. Returns which part of the picture changes.
    fn update(&mut self, gpu: Gpu<'_>, grid: &VoxelGrid, visible: Visible) -> PictureChange {
        let resized = grid.extent() != self.held.grid.extent();
        if resized {
            self.resize(grid.extent(), gpu.shared.lit_columns());
        }
        // An empty map looks the same under any options.
        let (same, all) = (visible == self.held.visible, 0..self.bricks.len());
        let changed: Vec<usize> = match same || resized {
            true => grid.changed_bricks(&self.held.grid),
            false => all.collect(),
        };
        let mut seen = match same && !resized {
            true => self.differing(grid, &changed),
            false => PictureChange::All,
        };
        let (stale, shape_changed) = self.held.take(grid, &changed, visible);
        let meshes = mesh_bricks(grid, &self.held.solid, &stale);
        for (&b, mesh) in stale.iter().zip(meshes) {
            let BrickMesh { vertices, quads } = mesh;
            self.bricks[b].quads = quads;
            self.bricks[b]
                .vertices
                .write(gpu.device, gpu.queue, "voxel brick", &vertices);
        }
        let lit = self.lit;
        for (origin, size) in shape_changed.into_iter().flat_map(|b| lit_tiles(b, lit)) {
            let block: LightBlock = self.rays.bake(&self.held.solid, origin, size);
            gpu.shared.write_light(gpu.queue, &block);
            seen.add(self.keep_light(&block));
        }
        seen
    }

    /// Where the labels of some bricks differ from those held.
    fn differing(&self, grid: &VoxelGrid, bricks: &[usize]) -> PictureChange {
        let (mut seen, held) = (PictureChange::None, self.held.grid.bricks());
        for &b in bricks {
            if let Some(part) = differing_part(grid.extent(), b, &grid.bricks()[b], &held[b]) {
                seen.add(PictureChange::part(part, EDGE_PX));
            }
        }
        seen
    }

    /// Remembers baked light; where surfaces look different by it.
    fn keep_light(&mut self, block: &LightBlock) -> PictureChange {
        let ([x0, y0], [w, h]) = (block.origin, block.size);
        let [lit_x, lit_y] = self.lit;
        let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
        for (i, new) in block.cells.iter().enumerate() {
            let at = [x0 + i % w, y0 + i / w % h, i / (w * h)];
            let old = &mut self.light[(at[2] * lit_y + at[1]) * lit_x + at[0]];
            if std::mem::replace(old, *new) != *new {
                low = [0, 1, 2].map(|k| low[k].min(at[k]));
                high = [0, 1, 2].map(|k| high[k].max(at[k] + 1));
            }
        }
        if low[0] == usize::MAX {
            return PictureChange::None;
        }
        // Light is interpolated half a voxel off a surface.
        let part = EgoBounds::of_voxels(self.held.grid.extent(), low, high);
        let off_m = 2.0 * self.held.grid.extent().voxel_m();
        let wider = EgoBounds {
            low_m: part.low_m - off_m,
            high_m: part.high_m + off_m,
        };
        PictureChange::part(wider, EDGE_PX)
    }

    fn in_view(&self, camera: &ViewCamera, clip: &DMat4) -> Vec<(usize, f64)> {
        let (eye, forward) = (camera.eye_m(), camera.axes()[2]);
        let mut seen: Vec<(usize, f64)> = (0..self.bricks.len())
            .filter(|&b| self.bricks[b].vertices.quads() > 0)
            .filter_map(|b| {
                let (low, high) = self.bounds_m(b);
                let middle = (low + high) / 2.0;
                let distance = if camera.ortho {
                    middle.dot(forward)
                } else {
                    (middle - eye).length()
                };
                may_be_seen(low, high, clip).then_some((b, distance))
            })
            .collect();
        seen.sort_by(|a, b| a.1.total_cmp(&b.1));
        seen
    }

    fn bounds_m(&self, brick: usize) -> (DVec3, DVec3) {
        let ([x, y], _) = self.held.grid.brick_columns(brick);
        let extent = self.held.grid.extent();
        let low = DVec3::new(x as f64, y as f64, 0.0);
        let side = DVec3::new(BRICK as f64, BRICK as f64, extent.nz() as f64);
        (extent.from_voxel_units(low), extent.from_voxel_units(low + side))
    }
}

/// Ranges of rectangles whose side can be seen at all, neighbouring ranges joined.
fn facing(
    (low, high): (DVec3, DVec3),
    quads: &[std::ops::Range<u32>; 6],
    camera: &ViewCamera,
) -> Vec<std::ops::Range<u32>> {
    let (eye, forward) = (camera.eye_m(), camera.axes()[2]);
    let mut out: Vec<std::ops::Range<u32>> = Vec::with_capacity(6);
    for (direction, range) in quads.iter().enumerate() {
        let (axis, positive) = (direction / 2, NORMALS[direction][direction / 2] > 0);
        let seen = match (camera.ortho, positive) {
            (true, true) => forward[axis] < 0.0,
            (true, false) => forward[axis] > 0.0,
            (false, true) => eye[axis] > low[axis],
            (false, false) => eye[axis] < high[axis],
        };
        if !seen || range.is_empty() {
            continue;
        }
        match out.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => out.push(range.clone()),
        }
    }
    out
}

/// The box around the voxels whose label differs.
fn differing_part(extent: Extent, brick: usize, new: &Brick, old: &Brick) -> Option<EgoBounds> {
    let ([x0, y0], _) = brick_columns(extent, brick);
    let bins = extent.nz();
    let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
    for (column, (new, old)) in new.chunks(bins).zip(old.chunks(bins)).enumerate() {
        if new == old {
            continue;
        }
        for z in (0..bins).filter(|&z| new[z] != old[z]) {
            let at = [x0 + column / BRICK, y0 + column % BRICK, z];
            low = [0, 1, 2].map(|k| low[k].min(at[k]));
            high = [0, 1, 2].map(|k| high[k].max(at[k] + 1));
        }
    }
    (low[0] < usize::MAX).then(|| EgoBounds::of_voxels(extent, low, high))
}

fn neighbours(extent: Extent, brick: usize) -> impl Iterator<Item = usize> {
    let [along_x, along_y] = bricks_along(extent);
    let (bx, by) = (brick / along_y, brick % along_y);
    [
        (bx.wrapping_sub(1), by),
        (bx + 1, by),
        (bx, by.wrapping_sub(1)),
        (bx, by + 1),
    ]
    .into_iter()
    .filter(move |(x, y)| *x < along_x && *y < along_y)
    .map(move |(x, y)| x * along_y + y)
}

/// Columns whose light may differ, as far as light looks, within the lit ones: lower corners and sizes of tiles.
fn lit_tiles((low, high): ColumnBox, lit: [usize; 2]) -> impl Iterator<Item = ([usize; 2], [usize; 2])> {
    let low = low.map(|v| v.saturating_sub(REACH));
    let high = [0, 1].map(|i| (high[i] + REACH).min(lit[i]));
    let starts = move |i: usize| (low[i]..high[i]).step_by(TILE);
    starts(0).flat_map(move |x| {
        let tile = move |y: usize| ([x, y], [TILE.min(high[0] - x), TILE.min(high[1] - y)]);
        starts(1).map(tile)
    })
}

/// True if both hold the same bricks in memory.
fn same_bricks(a: &VoxelGrid, b: &VoxelGrid) -> bool {
    let mut pairs = a.bricks().iter().zip(b.bricks());
    a.extent() == b.extent() && pairs.all(|(a, b)| Arc::ptr_eq(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edit_meshes_its_brick_again_and_those_beside_it() {
        let extent = Extent::new([-150, -110], [480, 320]).expect("sound");
        let mut grid = VoxelGrid::over(extent);
        let mut held = UploadedVoxels::nothing_of(extent);
        assert_eq!(held.take(&grid, &[], Visible::ALL), (vec![], None));
        let [x, y] = extent.column_at(100.0, 5.0).expect("inside");
        grid.set(x, y, 3, 4);
        let changed = grid.changed_bricks(&held.grid);
        let (stale, columns) = held.take(&grid, &changed, Visible::ALL);
        let brick = x / BRICK * 20 + y / BRICK;
        assert_eq!(changed, [brick]);
        assert_eq!(stale, [brick - 20, brick - 1, brick, brick + 1, brick + 20]);
        assert_eq!(columns, Some(([x, y], [x + 1, y + 1])));
        // Another class has the same shape.
        grid.set(x, y, 3, 5);
        let changed = grid.changed_bricks(&held.grid);
        assert_eq!(held.take(&grid, &changed, Visible::ALL), (vec![brick], None));
    }

    #[test]
    fn light_is_baked_once_wherever_it_may_differ() {
        let mut seen = vec![0; 500 * 300];
        for ([x, y], [w, h]) in lit_tiles(([5, 40], [480, 290]), [500, 300]) {
            assert!(w <= TILE && h <= TILE);
            (x..x + w).for_each(|x| (y..y + h).for_each(|y| seen[x * 300 + y] += 1));
        }
        let within = |i: usize| i / 300 < 494 && i % 300 >= 26;
        assert!(seen.iter().enumerate().all(|(i, n)| *n == u32::from(within(i))));
        // What is beyond the lit columns has none.
        assert_eq!(lit_tiles(([600, 0], [610, 5]), [500, 300]).count(), 0);
    }
}
