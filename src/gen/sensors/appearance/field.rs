//! The voxels as a smooth field: occupancy blurred a little and interpolated between the middles of
//! voxels, so that walls, crowns and poles lose their steps. What reaches the top of the grid goes on
//! above it: buildings up to a height of their own, crowns as domes.

use glam::{IVec3, Vec2, Vec3};

use super::noise::{floor, hash1, unit, value3};
use scene::appearance::{AppearanceData, BLOCK, BLOCKS, LEAVES, NX, NY, NZ, SURFACE, Section, TRUNK};
use scene::{Class, GridSpec, VoxelGrid};

/// Cells between the middles of voxels.
const CX: usize = NX - 1;
const CY: usize = NY - 1;
/// A cell whose corners all stay below this cannot hold a surface, roughness of leaves included.
const FLOOR: u8 = 40;

/// A building, wall or pole: columns of voxels that hang together.
#[derive(Clone, Copy, Debug)]
pub struct Structure {
    /// Direction of its walls, a unit vector.
    pub axis: Vec2,
    /// Columns.
    pub columns: u32,
    /// Top above the ground, m.
    pub height_m: f32,
    /// Varies its look.
    pub id: u32,
    /// A pole, a sign, a lamp: nothing is wider than two voxels.
    pub thin: bool,
    /// Middle of its highest columns, ego frame, m.
    pub top: Vec2,
}

/// Occupancy as a field.
pub struct Field {
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

#[inline]
fn at(x: usize, y: usize, z: usize) -> usize {
    (x * NY + y) * NZ + z
}

/// Ego frame to field units: cell = floor, corner i is voxel i - 1.
#[inline]
fn to_field(p: Vec3) -> Vec3 {
    (p + Vec3::new(40.0, 40.0, 1.0)) * 2.5 + 0.5
}

impl Field {
    /// From what stands on the ground (physical heights).
    pub fn new(grid: &VoxelGrid, seed: u32) -> Self {
        let mut solid = vec![Class::FREE; NX * NY * NZ];
        for (x, y, z, label) in grid.iter_set() {
            solid[at(x + 1, y + 1, z + 1)] = if label > Class::FREE { 0 } else { label };
        }
        let (structure, mut structures) = structures(&solid, seed);
        raise(&mut solid, &structure, &mut structures);
        trunks(&mut solid);
        let weight = weights(&solid, &structure, &structures);
        let label = spread(&solid);
        let (mut mask, mut blocks) = (vec![0u64; CX * CY], vec![0u64; BLOCKS * BLOCKS]);
        let mut top = 0;
        for x in 0..CX {
            for y in 0..CY {
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
                mask[x * CY + y] = column;
                blocks[x / BLOCK * BLOCKS + y / BLOCK] |= column;
                top = top.max(64 - column.leading_zeros());
            }
        }
        Self {
            weight,
            label,
            mask,
            blocks,
            structure,
            structures,
            highest: top as f32 * 0.4 - 1.2,
        }
    }

    /// For the graphics card.
    pub fn pack(&self, out: &mut AppearanceData) {
        let halves = |v: &u64| [*v as u32, (*v >> 32) as u32];
        out.push_bytes(Section::Weight, &self.weight);
        out.push_bytes(Section::Label, &self.label);
        out.push(Section::Mask, self.mask.iter().flat_map(halves));
        out.push(Section::Blocks, self.blocks.iter().flat_map(halves));
        out.push(Section::StructureOf, self.structure.iter().map(|i| u32::from(*i)));
        let structures = self.structures.iter().flat_map(|s| {
            let [x, y, height] = [s.axis.x, s.axis.y, s.height_m].map(f32::to_bits);
            [x, y, s.columns, height, s.id, u32::from(s.thin), 0, 0]
        });
        out.push(Section::Structures, structures);
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
        let q = to_field(p).truncate().round().max(Vec2::ZERO).as_uvec2();
        let (x, y) = ((q.x as usize).min(NX - 1), (q.y as usize).min(NY - 1));
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
                (x + dx).saturating_sub(1).min(NX - 1),
                (y + dy).saturating_sub(1).min(NY - 1),
            );
            if let i @ 1.. = self.structure[x * NY + y] {
                return self.structures.get(usize::from(i) - 1);
            }
        }
        None
    }

    /// The field without leaves at a point.
    #[inline]
    pub fn value(&self, p: Vec3) -> f32 {
        let q = to_field(p);
        let c = q.map(floor);
        if !(c.x >= 0.0 && c.y >= 0.0 && c.z >= 0.0)
            || c.x >= CX as f32
            || c.y >= CY as f32
            || c.z >= (NZ - 1) as f32
        {
            return 0.0;
        }
        self.blend(q, c)
    }

    /// The same, but 0 in cells that hold no surface.
    #[inline]
    pub fn dense(&self, p: Vec3) -> f32 {
        let q = to_field(p);
        // Written so that NaN fails too.
        if !inside(q) || self.mask[q.x as usize * CY + q.y as usize] >> (q.z as u32) & 1 == 0 {
            return 0.0;
        }
        self.blend(q, q.map(floor))
    }

    #[inline(always)]
    fn blend(&self, q: Vec3, c: Vec3) -> f32 {
        let f = q - c;
        let i = at(c.x as usize, c.y as usize, c.z as usize);
        let w = |i: usize| f32::from(self.weight[i]);
        let column = |i: usize| w(i) + (w(i + 1) - w(i)) * f.z;
        let low = column(i) + (column(i + NZ) - column(i)) * f.y;
        let j = i + NY * NZ;
        let high = column(j) + (column(j + NZ) - column(j)) * f.y;
        (low + (high - low) * f.x) * (1.0 / 255.0)
    }

    #[inline(always)]
    fn label_near(&self, q: Vec3) -> u8 {
        let r = q + 0.5;
        let (x, y, z) = (
            (r.x as usize).min(NX - 1),
            (r.y as usize).min(NY - 1),
            (r.z as usize).min(NZ - 1),
        );
        self.label[at(x, y, z)]
    }

    /// The field with the roughness of leaves where plants are; `p` in the ego frame, `anchor` takes it
    /// to the frame in which the leaves stay.
    #[inline]
    fn rough(&self, p: Vec3, anchor: &impl Fn(Vec3) -> Vec3) -> f32 {
        let q = to_field(p);
        let value = self.blend(q, q.map(floor));
        if value > 0.1 && self.label_near(q) == Class::Vegetation.id() {
            return value + leaves(anchor(p)) * LEAVES;
        }
        value
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
        let (qo, qd) = (to_field(o), d * 2.5);
        let z = |t: f32| qo.z + qd.z * t;
        if self.blocks[index] & z_bits(z(t_in), z(t_out)) == 0 {
            return None;
        }
        let (bx, by) = (index / BLOCKS * BLOCK, index % BLOCKS * BLOCK);
        let middle = (t_in + t_out) * 0.5;
        let clamp = |v: f32, lo: usize, n: usize| (v.max(0.0) as usize).clamp(lo, (lo + BLOCK).min(n) - 1);
        // Columns of the block along the ray.
        let enter = t_in + (middle - t_in) * 1e-4;
        let mut cell = [
            clamp(qo.x + qd.x * enter, bx, CX),
            clamp(qo.y + qd.y * enter, by, CY),
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
            let mask = self.mask[cell[0] * CY + cell[1]];
            if mask & z_bits(z(t), z(t_end)) != 0 {
                let mut k = (t / step).ceil() * step;
                while k < t_end {
                    let p = o + d * k;
                    let q = to_field(p);
                    if q.z >= 0.0 && q.z < (NZ - 1) as f32 && mask >> (q.z as u32) & 1 == 1 {
                        let value = |p: Vec3| {
                            if leaves {
                                self.rough(p, anchor)
                            } else {
                                let q = to_field(p);
                                self.blend(q, q.map(floor))
                            }
                        };
                        if inside(q) && value(p) > SURFACE {
                            return Some(self.refine(o, d, (k - step).max(0.0), k, |p| {
                                inside(to_field(p)) && value(p) > SURFACE
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
            let (lo, n) = ([bx, by][axis], [CX, CY][axis]);
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
            label: self.label_near(to_field(o + d * within)),
        }
    }
}

#[inline(always)]
fn inside(q: Vec3) -> bool {
    q.x >= 0.0
        && q.y >= 0.0
        && q.z >= 0.0
        && q.x < (NX - 1) as f32
        && q.y < (NY - 1) as f32
        && q.z < (NZ - 1) as f32
}

/// Roughness of leaves in -0.5..0.5: clumps and leaves.
#[inline]
fn leaves(p: Vec3) -> f32 {
    0.62 * value3(p * 2.6, 71) + 0.38 * value3(p * 8.5, 72) - 0.5
}

/// Buildings and poles by 8-connected columns of "manmade", with the direction of their walls.
fn structures(solid: &[u8], seed: u32) -> (Vec<u16>, Vec<Structure>) {
    let made = Class::Manmade.id();
    let has = |x: usize, y: usize| solid[at(x, y, 0)..at(x, y, 0) + NZ].contains(&made);
    let mut of = vec![0u16; NX * NY];
    let mut all = Vec::new();
    for start in 0..NX * NY {
        let (sx, sy) = (start / NY, start % NY);
        if of[start] != 0 || sx == 0 || sy == 0 || sx == NX - 1 || sy == NY - 1 || !has(sx, sy) {
            continue;
        }
        let id = (all.len() as u16).saturating_add(1);
        let mut stack = vec![start];
        let mut columns: Vec<usize> = Vec::new();
        of[start] = id;
        while let Some(c) = stack.pop() {
            columns.push(c);
            for k in 0..9 {
                let (x, y) = (c / NY + k / 3 - 1, c % NY + k % 3 - 1);
                if x > 0 && y > 0 && x < NX - 1 && y < NY - 1 && of[x * NY + y] == 0 && has(x, y) {
                    of[x * NY + y] = id;
                    stack.push(x * NY + y);
                }
            }
        }
        // Wall directions from the gradient of the footprint; those at right angles count alike (angle times 4).
        let member = |x: i32, y: i32| {
            let inside = (0..NX as i32).contains(&x) && (0..NY as i32).contains(&y);
            f32::from(u8::from(inside && of[x as usize * NY + y as usize] == id))
        };
        let mut sum = Vec2::ZERO;
        let mut top = 0;
        let mut wide = false;
        for &c in &columns {
            let (x, y) = ((c / NY) as i32, (c % NY) as i32);
            let mut g = Vec2::ZERO;
            for dx in -3..=3i32 {
                for dy in -3..=3i32 {
                    g += Vec2::new(dx as f32, dy as f32) * member(x + dx, y + dy);
                }
            }
            if g.length() > 4.0 {
                sum += Vec2::from_angle(g.to_angle() * 4.0) * g.length();
            }
            wide |= member(x + 1, y)
                * member(x, y + 1)
                * member(x + 1, y + 1)
                * member(x + 2, y)
                * member(x, y + 2)
                > 0.5;
            let column = &solid[at(c / NY, c % NY, 0)..at(c / NY, c % NY, 0) + NZ];
            top = top.max(column.iter().rposition(|l| *l == made).unwrap_or(0));
        }
        let highest = |c: &&usize| solid[at(**c / NY, **c % NY, 0) + top] == made;
        let tops: Vec<Vec2> = columns
            .iter()
            .filter(highest)
            .map(|c| Vec2::new((c / NY) as f32, (c % NY) as f32) * 0.4 - 40.2)
            .collect();
        let first = columns.iter().min().copied().unwrap_or(0);
        all.push(Structure {
            axis: if sum == Vec2::ZERO {
                Vec2::X
            } else {
                Vec2::from_angle(sum.to_angle() / 4.0)
            },
            columns: columns.len() as u32,
            height_m: top as f32 * 0.4 - 1.0,
            id: hash1(first as u32, seed),
            thin: columns.len() <= 16 && !wide,
            top: tops.iter().sum::<Vec2>() / tops.len().max(1) as f32,
        });
        if all.len() == usize::from(u16::MAX) - 1 {
            break;
        }
    }
    (of, all)
}

/// Continues above the grid what reaches its top.
fn raise(solid: &mut [u8], structure: &[u16], structures: &mut [Structure]) {
    let top = GridSpec::NZ; // padded index of the highest voxel
    let (made, green) = (Class::Manmade.id(), Class::Vegetation.id());
    for s in structures.iter_mut() {
        if s.height_m > 5.3 && !s.thin {
            s.height_m = 7.0 + 6.5 * unit(hash1(s.id, 9));
        }
    }
    // Distance to the edge of the crowns cut off, in voxels.
    let cut = |x: usize, y: usize, solid: &[u8]| solid[at(x, y, top)] == green;
    let mut depth = vec![0i32; NX * NY];
    for round in 1..=5 {
        let before = depth.clone();
        for x in 1..NX - 1 {
            for y in 1..NY - 1 {
                let around = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
                if cut(x, y, solid) && around.iter().all(|(x, y)| before[x * NY + y] >= round - 1) {
                    depth[x * NY + y] = round;
                }
            }
        }
    }
    for x in 1..NX - 1 {
        for y in 1..NY - 1 {
            let below = solid[at(x, y, top)];
            let more = if below == green {
                (depth[x * NY + y] * 3).min(NZ as i32) as usize / 2 + 1
            } else if below == made && structure[x * NY + y] > 0 {
                let s = &structures[usize::from(structure[x * NY + y]) - 1];
                (((s.height_m - 5.4) / 0.4).max(0.0)) as usize
            } else {
                0
            };
            solid[at(x, y, top) + 1..at(x, y, top) + 1 + more.min(NZ - top - 3)].fill(below);
        }
    }
}

/// Marks the trunks: slim columns of plants from the ground up to a crown.
fn trunks(solid: &mut [u8]) {
    let green = Class::Vegetation.id();
    let before = solid.to_vec();
    let around = |x: usize, y: usize, z: usize| {
        let near = (0..9).filter(|k| *k != 4);
        near.filter(|k| before[at(x + k / 3 - 1, y + k % 3 - 1, z)] == green)
            .count()
    };
    for x in 1..NX - 1 {
        for y in 1..NY - 1 {
            let Some(first) = (1..8).find(|z| before[at(x, y, *z)] == green) else {
                continue;
            };
            let slim = (first..NZ - 1)
                .take_while(|z| before[at(x, y, *z)] == green && around(x, y, *z) <= 4)
                .count();
            let crown = before[at(x, y, first + slim)] == green;
            if first <= 4 && slim >= 2 && crown {
                for z in first..first + slim {
                    solid[at(x, y, z)] = TRUNK;
                }
            }
        }
    }
}

/// Occupancy softened: 55 % of the voxel itself and 45 % of its binomial 3x3x3 blur; a single voxel
/// keeps a surface, poles become slim.
fn weights(solid: &[u8], structure: &[u16], structures: &[Structure]) -> Vec<u8> {
    let n = solid.len();
    let own: Vec<u8> = solid
        .iter()
        .map(|l| if *l == Class::FREE { 0 } else { 255 })
        .collect();
    let mut blurred: Vec<u8> = own.clone();
    for stride in [1, NZ, NY * NZ] {
        let from = blurred.clone();
        for i in stride..n - stride {
            let sum = u32::from(from[i - stride]) + 2 * u32::from(from[i]) + u32::from(from[i + stride]);
            blurred[i] = (sum / 4) as u8;
        }
    }
    let mut out: Vec<u8> = (0..n)
        .map(|i| ((u32::from(own[i]) * 55 + u32::from(blurred[i]) * 45) / 100) as u8)
        .collect();
    for (out, label) in out.iter_mut().zip(solid) {
        if *label == Class::Vegetation.id() {
            // Thin plants do not fall to pieces under their leaves.
            *out = (*out).max(205);
        } else if *label == TRUNK {
            *out = 186;
        }
    }
    for x in 1..NX - 1 {
        for y in 1..NY - 1 {
            let i = structure[x * NY + y];
            if i > 0 && structures[usize::from(i) - 1].thin {
                for z in 0..NZ {
                    let v = at(x, y, z);
                    if solid[v] == Class::Manmade.id() {
                        out[v] = 172;
                    } else {
                        out[v] = out[v].min(40);
                    }
                }
            }
        }
    }
    out
}

/// Labels with those of free voxels taken from a neighbour, plants last.
fn spread(solid: &[u8]) -> Vec<u8> {
    let mut out = solid.to_vec();
    let steps: Vec<isize> = [
        IVec3::X,
        IVec3::Y,
        IVec3::Z,
        IVec3::new(1, 1, 0),
        IVec3::new(1, -1, 0),
        IVec3::new(1, 0, 1),
        IVec3::new(1, 0, -1),
        IVec3::new(0, 1, 1),
        IVec3::new(0, 1, -1),
    ]
    .iter()
    .map(|s| (s.x as isize * NY as isize + s.y as isize) * NZ as isize + s.z as isize)
    .collect();
    for (i, label) in solid.iter().enumerate() {
        if *label == Class::FREE {
            continue;
        }
        for step in &steps {
            for j in [i as isize + step, i as isize - step] {
                if let Some(to) = out.get_mut(j as usize)
                    && (*to == Class::FREE
                        || (*to == Class::Vegetation.id() && solid[j as usize] == Class::FREE))
                {
                    *to = *label;
                }
            }
        }
    }
    out
}
