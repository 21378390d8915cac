//! Occupancy as voxel faces, brick by brick; only bricks whose memory changed are meshed again, and only voxels and light
//! that differ count as changed.

use std::sync::Arc;

use glam::DMat4;

use super::change::{Change, Part, may_be_seen};
use super::drawable::{Drawable, Gpu, Layer, Pipelines, Shown, View};
use super::light::{LightBlock, LightRays, REACH};
use super::meshing::{BrickMesh, ColumnBox, NORMALS, Solidity, Visible, brick_origin, join, mesh_bricks};
use super::shared::{PipelineSpec, VertexBuffer};
use super::{ViewCamera, ViewOptions};
use scene::grid::{BRICK, BRICKS, Brick};
use scene::{GridSpec, VoxelGrid};

/// A vertex is one word; see [`BrickMesh::vertices`].
const STRIDE: usize = 4;

/// How far the picture of a voxel reaches beyond its projection, px.
const EDGE_PX: f64 = 2.0;

/// Drawable of the occupancy.
#[derive(Debug)]
pub(super) struct Voxels {
    pipelines: Pipelines,
    grid: VoxelGrid, // as last uploaded; holding it keeps the addresses of its bricks unique
    visible: Visible,
    solid: Solidity,
    rays: LightRays,
    light: Vec<[u8; 2]>, // as uploaded, `[z][y][x]`
    bricks: Vec<BrickBuffer>,
}

#[derive(Debug, Default)]
struct BrickBuffer {
    vertices: VertexBuffer,
    quads: [std::ops::Range<u32>; 6],
}

/// What is shown under these options.
pub(super) fn visible(options: &ViewOptions) -> Visible {
    if !options.voxels {
        return Visible {
            hidden_classes: u32::MAX,
            below_clip: 0,
        };
    }
    let bins = match options.clip_above_m {
        // The bin that holds the height is still shown; NaN clips nothing.
        Some(z) if z.is_finite() => ((z - GridSpec::MIN_M[2]) * 2.5).ceil().clamp(0.0, 16.0) as u32,
        _ => GridSpec::NZ as u32,
    };
    Visible {
        hidden_classes: options.hidden_classes,
        below_clip: ((1u32 << bins) - 1) as u16,
    }
}

impl Drawable for Voxels {
    fn name(&self) -> &'static str {
        "voxels"
    }

    fn prepare(&mut self, gpu: Gpu<'_>, shown: Shown<'_>) -> Change {
        let (grid, visible) = (shown.scene.grid, visible(shown.scene.options));
        if visible == self.visible && same_bricks(grid, &self.grid) {
            return Change::None;
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

    /// Draws the bricks in view, nearest first, and of each only the sides that face the eye. What `clip` maps beyond -1
    /// or 1 is out of view.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &View<'_>, layer: Layer) {
        if layer != Layer::Opaque || !self.pipelines.set(pass, view) {
            return;
        }
        for (b, _) in self.in_view(view.camera, &view.clip) {
            let brick = &self.bricks[b];
            for range in facing(b, &brick.quads, view.camera) {
                brick.vertices.draw_quads(pass, view.shared, range);
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

impl Voxels {
    pub fn new() -> Self {
        let grid = VoxelGrid::new();
        let visible = Visible::ALL;
        Self {
            pipelines: Pipelines::default(),
            solid: Solidity::of(&grid, visible),
            grid,
            visible,
            rays: LightRays::new(),
            light: vec![[255; 2]; GridSpec::COLUMNS * GridSpec::NZ],
            bricks: (0..BRICKS * BRICKS).map(|_| BrickBuffer::default()).collect(),
        }
    }

    /// Takes over a grid; what of it is seen differently now.
    fn update(&mut self, gpu: Gpu<'_>, grid: &VoxelGrid, visible: Visible) -> Change {
        let same_view = visible == self.visible;
        let changed: Vec<usize> = if same_view {
            grid.changed_bricks(&self.grid)
        } else {
            (0..BRICKS * BRICKS).collect()
        };
        self.visible = visible;
        if changed.is_empty() {
            return Change::None;
        }
        let mut seen = match same_view {
            true => self.differing(grid, &changed),
            false => Change::All,
        };
        let mut stale = [false; BRICKS * BRICKS];
        let mut shape_changed = None;
        for &b in &changed {
            stale[b] = true;
            let columns = self.solid.update(b, &grid.bricks()[b], visible);
            if columns.is_some() {
                // Faces at a brick's border depend on its neighbours.
                neighbours(b).for_each(|n| stale[n] = true);
            }
            shape_changed = join(shape_changed, columns);
        }
        self.grid = grid.clone();
        let stale: Vec<usize> = (0..BRICKS * BRICKS).filter(|&b| stale[b]).collect();
        let meshes = mesh_bricks(grid, &self.solid, &stale);
        for (&b, mesh) in stale.iter().zip(meshes) {
            let BrickMesh { vertices, quads } = mesh;
            self.bricks[b].quads = quads;
            self.bricks[b]
                .vertices
                .write(gpu.device, gpu.queue, "voxel brick", &vertices);
        }
        if let Some((origin, size)) = shape_changed.map(lit_area) {
            let block: LightBlock = self.rays.bake(&self.solid, origin, size);
            gpu.shared.write_light(gpu.queue, &block);
            seen.add(self.keep_light(&block));
        }
        seen
    }

    /// Where the labels of some bricks differ from those held.
    fn differing(&self, grid: &VoxelGrid, bricks: &[usize]) -> Change {
        let mut seen = Change::None;
        for &b in bricks {
            if let Some(part) = differing_part(b, &grid.bricks()[b], &self.grid.bricks()[b]) {
                seen.add(Change::part(part, EDGE_PX));
            }
        }
        seen
    }

    /// Remembers baked light; where surfaces look different by it.
    fn keep_light(&mut self, block: &LightBlock) -> Change {
        let ([x0, y0], [w, h]) = (block.origin, block.size);
        let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
        for (i, new) in block.cells.iter().enumerate() {
            let at = [x0 + i % w, y0 + i / w % h, i / (w * h)];
            let old = &mut self.light[(at[2] * GridSpec::NY + at[1]) * GridSpec::NX + at[0]];
            if std::mem::replace(old, *new) != *new {
                low = [0, 1, 2].map(|k| low[k].min(at[k]));
                high = [0, 1, 2].map(|k| high[k].max(at[k] + 1));
            }
        }
        if low[0] == usize::MAX {
            return Change::None;
        }
        // Light is interpolated half a voxel off a surface.
        let part = Part::of_voxels(low, high);
        let wider = Part {
            low_m: part.low_m - 2.0 * GridSpec::VOXEL_M,
            high_m: part.high_m + 2.0 * GridSpec::VOXEL_M,
        };
        Change::part(wider, EDGE_PX)
    }

    fn in_view(&self, camera: &ViewCamera, clip: &DMat4) -> Vec<(usize, f64)> {
        let (eye, forward) = (camera.eye_m(), camera.axes()[2]);
        let mut seen: Vec<(usize, f64)> = (0..self.bricks.len())
            .filter(|&b| self.bricks[b].vertices.quads() > 0)
            .filter_map(|b| {
                let (low, high) = bounds_m(b);
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
}

fn bounds_m(brick: usize) -> (glam::DVec3, glam::DVec3) {
    let [x, y] = brick_origin(brick).map(|v| v as f64);
    let side = BRICK as f64;
    let corner = |dx: f64, z: f64| GridSpec::from_voxel_units(glam::DVec3::new(x + dx, y + dx, z));
    (corner(0.0, 0.0), corner(side, side))
}

/// Ranges of rectangles whose side can be seen at all, neighbouring ranges joined.
fn facing(brick: usize, quads: &[std::ops::Range<u32>; 6], camera: &ViewCamera) -> Vec<std::ops::Range<u32>> {
    let (low, high) = bounds_m(brick);
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
fn differing_part(brick: usize, new: &Brick, old: &Brick) -> Option<Part> {
    let [x0, y0] = brick_origin(brick);
    let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
    for (column, (new, old)) in new.chunks(BRICK).zip(old.chunks(BRICK)).enumerate() {
        if new == old {
            continue;
        }
        for z in (0..BRICK).filter(|&z| new[z] != old[z]) {
            let at = [x0 + column / BRICK, y0 + column % BRICK, z];
            low = [0, 1, 2].map(|k| low[k].min(at[k]));
            high = [0, 1, 2].map(|k| high[k].max(at[k] + 1));
        }
    }
    (low[0] < usize::MAX).then(|| Part::of_voxels(low, high))
}

fn neighbours(brick: usize) -> impl Iterator<Item = usize> {
    let (bx, by) = (brick / BRICKS, brick % BRICKS);
    [
        (bx.wrapping_sub(1), by),
        (bx + 1, by),
        (bx, by.wrapping_sub(1)),
        (bx, by + 1),
    ]
    .into_iter()
    .filter(|(x, y)| *x < BRICKS && *y < BRICKS)
    .map(|(x, y)| x * BRICKS + y)
}

/// Columns whose light may differ, lower corner and size: as far as light looks.
fn lit_area((low, high): ColumnBox) -> ([usize; 2], [usize; 2]) {
    let n = [GridSpec::NX, GridSpec::NY];
    let low = low.map(|v| v.saturating_sub(REACH));
    (low, [0, 1].map(|i| (high[i] + REACH).min(n[i]) - low[i]))
}

/// True if both hold the same bricks in memory.
pub(super) fn same_bricks(a: &VoxelGrid, b: &VoxelGrid) -> bool {
    a.bricks().iter().zip(b.bricks()).all(|(a, b)| Arc::ptr_eq(a, b))
}
