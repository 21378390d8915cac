//! The voxels as a smooth field: occupancy blurred a little and interpolated between the middles of
//! voxels, so that walls, crowns and poles lose their steps. What reaches the top of the grid goes on
//! above it: buildings up to a height of their own, crowns as domes.

mod build;
pub(super) mod owners;
mod structures;

use glam::{Vec2, Vec3};

use super::noise::{floor, value3};
use build::{raise, spread, trunks, weights};
use owners::Owners;
use scene::appearance::{
    AppearanceData, AppearanceSection, BLOCK, FieldShape, LEAVES, NZ, PER_M, SURFACE, VOXEL_M,
};
use scene::{Class, VoxelGrid};
#[cfg(test)]
pub(super) use structures::FARTHEST_M;
use structures::structures;

/// A cell whose corners all stay below this cannot hold a surface, roughness of leaves included.
const FLOOR: u8 = 40;

/// A building, wall or pole: columns of voxels that look alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Structure {
    /// Direction of its walls, a unit vector.
    pub axis: Vec2,
    /// Columns.
    pub columns: u32,
    /// Top above the ground, m.
    pub height_m: f32,
    /// Number that varies its look.
    pub id: u32,
    /// True for a pole, a sign or a lamp: no part of it is wider than two voxels.
    pub thin: bool,
    /// Middle of its highest columns, ego frame, m.
    pub top: Vec2,
    /// True if its height is known above the grid too.
    pub known: bool,
}

/// Occupancy as a field.
pub struct OccupancyField {
    shape: FieldShape,
    cells: [usize; 2],   // between the middles of voxels
    end: Vec3,           // the same along all axes
    weight: Vec<u8>,     // [x][y][z], padded
    label: Vec<u8>,      // the same; free voxels hold a neighbour's
    mask: Vec<u64>,      // cells [x][y]
    blocks: Vec<u64>,    // union over blocks of columns
    structure: Vec<u16>, // [x][y] padded, 0 = none, else index + 1
    /// Buildings and poles.
    pub structures: Vec<Structure>,
    highest: f32,
}

/// Where a ray meets the field.
#[derive(Clone, Copy, Debug)]
pub struct FieldHit {
    /// Distance, m.
    pub t: f32,
    /// Class.
    pub label: u8,
}

impl OccupancyField {
    /// Builds the field from the voxels that stand on the ground (physical heights) and the things that own some of
    /// them.
    pub fn new(grid: &VoxelGrid, owners: &Owners, seed: u32) -> Self {
        let shape = FieldShape::from_extent(grid.extent());
        let at = |x: usize, y: usize, z: usize| shape.at(x, y, z);
        let mut solid = vec![Class::FREE; shape.nx * shape.ny * NZ];
        for (x, y, z, label) in grid.iter_set() {
            solid[at(x + 1, y + 1, z + 1)] = if label > Class::FREE { 0 } else { label };
        }
        let (structure, mut structures) = structures(&shape, &solid, owners, seed);
        raise(&shape, &mut solid, &structure, &mut structures);
        trunks(&shape, &mut solid);
        let weight = weights(&shape, &solid, &structure, &structures);
        let label = spread(&shape, &solid);
        let [cx, cy] = [shape.nx - 1, shape.ny - 1];
        let [blocks_x, blocks_y] = shape.blocks;
        let (mut mask, mut blocks) = (vec![0u64; cx * cy], vec![0u64; blocks_x * blocks_y]);
        let mut top = 0;
        for x in 0..cx {
            for y in 0..cy {
                let mut column = 0u64;
                for (dx, dy) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let from = at(x + dx, y + dy, 0);
                    for (z, w) in weight[from..from + NZ].iter().enumerate() {
                        if *w > FLOOR {
                            // Corner z belongs to the cells below and above it.
                            column |= 1 << z | 1u64 << z.saturating_sub(1);
                        }
                    }
                }
                mask[x * cy + y] = column;
                blocks[x / BLOCK * blocks_y + y / BLOCK] |= column;
                top = top.max(64 - column.leading_zeros());
            }
        }
        Self {
            shape,
            cells: [cx, cy],
            end: Vec3::new(cx as f32, cy as f32, (NZ - 1) as f32),
            weight,
            label,
            mask,
            blocks,
            structure,
            structures,
            highest: top as f32 * VOXEL_M - 1.2,
        }
    }

    /// Shape by which it covers the map.
    pub fn shape(&self) -> &FieldShape {
        &self.shape
    }

    /// Converts a point of the ego frame to field units: cell = floor, corner i is voxel i - 1.
    #[inline(always)]
    fn to_field(&self, p: Vec3) -> Vec3 {
        (p - self.shape.low_m) * PER_M + 0.5
    }

    #[inline(always)]
    fn inside(&self, q: Vec3) -> bool {
        q.x >= 0.0 && q.y >= 0.0 && q.z >= 0.0 && q.x < self.end.x && q.y < self.end.y && q.z < self.end.z
    }

    /// Packs the field for the graphics card.
    pub fn pack(&self, out: &mut AppearanceData) {
        let halves = |v: &u64| [*v as u32, (*v >> 32) as u32];
        out.push_bytes(AppearanceSection::Weight, &self.weight);
        out.push_bytes(AppearanceSection::Label, &self.label);
        out.push(AppearanceSection::Mask, self.mask.iter().flat_map(halves));
        out.push(AppearanceSection::Blocks, self.blocks.iter().flat_map(halves));
        out.push(
            AppearanceSection::StructureOf,
            self.structure.iter().map(|i| u32::from(*i)),
        );
        let structures = self.structures.iter().flat_map(|s| {
            let [x, y, height] = [s.axis.x, s.axis.y, s.height_m].map(f32::to_bits);
            [x, y, s.columns, height, s.id, u32::from(s.thin), 0, 0]
        });
        out.push(AppearanceSection::Structures, structures);
    }

    /// Height above which there is nothing, m.
    pub fn highest_m(&self) -> f32 {
        self.highest
    }

    /// True if the block holds anything.
    #[inline]
    pub fn block(&self, index: usize) -> bool {
        self.blocks[index] != 0
    }

    /// The structure over a point.
    pub fn structure_at(&self, p: Vec3) -> Option<&Structure> {
        let q = self.to_field(p).truncate().round().max(Vec2::ZERO).as_uvec2();
        let FieldShape { nx, ny, .. } = self.shape;
        let (x, y) = ((q.x as usize).min(nx - 1), (q.y as usize).min(ny - 1));
        // The surface may lie half a voxel outside.
        for (dx, dy) in [
            (1, 1),
            (0, 1),
            (2, 1),
            (1, 0),
            (1, 2),
            (0, 0),
            (0, 2),
            (2, 0),
            (2, 2),
        ] {
            let (x, y) = (
                (x + dx).saturating_sub(1).min(nx - 1),
                (y + dy).saturating_sub(1).min(ny - 1),
            );
            if let i @ 1.. = self.structure[x * ny + y] {
                return self.structures.get(usize::from(i) - 1);
            }
        }
        None
    }

    /// The field without leaves at a point.
    #[inline]
    pub fn value(&self, p: Vec3) -> f32 {
        let q = self.to_field(p);
        let c = q.map(floor);
        if !(c.x >= 0.0 && c.y >= 0.0 && c.z >= 0.0)
            || c.x >= self.end.x
            || c.y >= self.end.y
            || c.z >= self.end.z
        {
            return 0.0;
        }
        self.blend(q, c)
    }

    /// The field without leaves at a point, as [`Self::value`] gives it, but 0 in cells that hold no surface.
    #[inline]
    pub fn dense(&self, p: Vec3) -> f32 {
        let q = self.to_field(p);
        // Written so that NaN fails too.
        if !self.inside(q) || self.mask[q.x as usize * self.cells[1] + q.y as usize] >> (q.z as u32) & 1 == 0
        {
            return 0.0;
        }
        self.blend(q, q.map(floor))
    }

    #[inline(always)]
    fn blend(&self, q: Vec3, c: Vec3) -> f32 {
        let f = q - c;
        let i = self.shape.at(c.x as usize, c.y as usize, c.z as usize);
        let w = |i: usize| f32::from(self.weight[i]);
        let column = |i: usize| w(i) + (w(i + 1) - w(i)) * f.z;
        let low = column(i) + (column(i + NZ) - column(i)) * f.y;
        let j = i + self.shape.ny * NZ;
        let high = column(j) + (column(j + NZ) - column(j)) * f.y;
        (low + (high - low) * f.x) * (1.0 / 255.0)
    }

    #[inline(always)]
    fn label_near(&self, q: Vec3) -> u8 {
        let r = q + 0.5;
        let (x, y, z) = (
            (r.x as usize).min(self.shape.nx - 1),
            (r.y as usize).min(self.shape.ny - 1),
            (r.z as usize).min(NZ - 1),
        );
        self.label[self.shape.at(x, y, z)]
    }

    /// True if the field, with the roughness of leaves where plants are, is solid at a point `p` of the ego frame, which is `q`
    /// in the field and whose smooth value is known. `anchor` takes it to the frame in which textures are anchored.
    #[inline]
    fn is_solid_with_leaves(&self, value: f32, (p, q): (Vec3, Vec3), anchor: &impl Fn(Vec3) -> Vec3) -> bool {
        if value <= 0.1 || self.label_near(q) != Class::Vegetation.id() {
            return value > SURFACE;
        }
        // Clumps alone decide for most points, whatever the leaves are there.
        let p = anchor(p);
        let clumps = clumps(p);
        let [least, most] = [0.0, 1.0].map(|leaf| value + rough(clumps, leaf) * LEAVES);
        if least > SURFACE + 1e-3 || most < SURFACE - 1e-3 {
            return least > SURFACE;
        }
        value + leaves(p) * LEAVES > SURFACE
    }

    /// Outward normal at a surface point: the field's gradient, leaves included.
    pub fn normal(&self, p: Vec3, label: u8, anchor: &impl Fn(Vec3) -> Vec3) -> Vec3 {
        let h = match label {
            v if v == Class::Vegetation.id() => 0.06,
            // Wide enough to see past the steps of a wall that runs across the grid.
            v if v == Class::Manmade.id()
                && self.structure_at(p).is_some_and(|s| !s.thin && s.height_m > 2.6) =>
            {
                0.5
            }
            _ => 0.15,
        };
        let f = |d: Vec3| {
            if label == Class::Vegetation.id() {
                self.value(p + d * 4.0) * 1.5 + leaves(anchor(p + d)) * LEAVES
            } else {
                self.value(p + d)
            }
        };
        let g = |axis: Vec3| f(axis * -h) - f(axis * h);
        Vec3::new(g(Vec3::X), g(Vec3::Y), g(Vec3::Z)).normalize_or(Vec3::Z)
    }

    /// The first surface in one block between `t_in` and `t_out`, stepping about `step` m. With `leaves`
    /// plants are rough. The origin's distance to the block does not matter: steps lie at multiples of
    /// `step` from the origin.
    #[inline]
    pub fn cast_block(
        &self,
        index: usize,
        (o, d): (Vec3, Vec3),
        (t_in, t_out): (f32, f32),
        step: f32,
        leaves: bool,
        anchor: &impl Fn(Vec3) -> Vec3,
    ) -> Option<FieldHit> {
        let z_bits = |a: f32, b: f32| {
            let (lo, hi) = (floor(a.min(b)).max(0.0), floor(a.max(b)).min((NZ - 2) as f32));
            if hi < lo {
                return 0;
            }
            (u64::MAX << lo as u32) & (u64::MAX >> (63 - hi as u32))
        };
        let (qo, qd) = (self.to_field(o), d * PER_M);
        let z = |t: f32| qo.z + qd.z * t;
        if self.blocks[index] & z_bits(z(t_in), z(t_out)) == 0 {
            return None;
        }
        let [cx, cy] = self.cells;
        let [_, blocks_y] = self.shape.blocks;
        let (bx, by) = (index / blocks_y * BLOCK, index % blocks_y * BLOCK);
        let middle = (t_in + t_out) * 0.5;
        let clamp = |v: f32, lo: usize, n: usize| (v.max(0.0) as usize).clamp(lo, (lo + BLOCK).min(n) - 1);
        // Columns of the block along the ray.
        let enter = t_in + (middle - t_in) * 1e-4;
        let mut cell = [
            clamp(qo.x + qd.x * enter, bx, cx),
            clamp(qo.y + qd.y * enter, by, cy),
        ];
        let inv = [1.0 / qd.x, 1.0 / qd.y];
        let mut t = t_in;
        for _ in 0..2 * BLOCK + 1 {
            let next = |a: usize| {
                if qd[a] == 0.0 {
                    return f32::INFINITY;
                }
                ((cell[a] + usize::from(qd[a] > 0.0)) as f32 - qo[a]) * inv[a]
            };
            let (tx, ty) = (next(0), next(1));
            let t_end = tx.min(ty).min(t_out);
            let mask = self.mask[cell[0] * cy + cell[1]];
            if mask & z_bits(z(t), z(t_end)) != 0 {
                let mut k = (t / step).ceil() * step;
                while k < t_end {
                    let p = o + d * k;
                    let q = self.to_field(p);
                    if q.z >= 0.0 && q.z < (NZ - 1) as f32 && mask >> (q.z as u32) & 1 == 1 {
                        let solid = |p: Vec3| {
                            let q = self.to_field(p);
                            let value = self.blend(q, q.map(floor));
                            match leaves {
                                true => self.is_solid_with_leaves(value, (p, q), anchor),
                                false => value > SURFACE,
                            }
                        };
                        if self.inside(q) && solid(p) {
                            return Some(self.refine(o, d, (k - step).max(0.0), k, |p| {
                                self.inside(self.to_field(p)) && solid(p)
                            }));
                        }
                    }
                    k += step;
                }
            }
            if t_end >= t_out {
                return None;
            }
            let axis = usize::from(ty < tx);
            let moved = cell[axis].wrapping_add_signed(if qd[axis] > 0.0 { 1 } else { -1 });
            let (lo, n) = ([bx, by][axis], [cx, cy][axis]);
            if moved < lo || moved >= (lo + BLOCK).min(n) {
                return None;
            }
            cell[axis] = moved;
            t = t_end;
        }
        None
    }

    fn refine(
        &self,
        o: Vec3,
        d: Vec3,
        mut out: f32,
        mut within: f32,
        solid: impl Fn(Vec3) -> bool,
    ) -> FieldHit {
        for _ in 0..4 {
            let middle = (out + within) * 0.5;
            if solid(o + d * middle) {
                within = middle;
            } else {
                out = middle;
            }
        }
        FieldHit {
            t: within,
            label: self.label_near(self.to_field(o + d * within)),
        }
    }
}

/// Roughness of leaves in -0.5..0.5: clumps and leaves.
#[inline]
fn leaves(p: Vec3) -> f32 {
    rough(clumps(p), value3(p * 8.5, 72))
}

#[inline]
fn clumps(p: Vec3) -> f32 {
    value3(p * 2.6, 71)
}

/// Roughness of a clump and a leaf, each in 0..1.
#[inline]
fn rough(clump: f32, leaf: f32) -> f32 {
    0.62 * clump + 0.38 * leaf - 0.5
}
