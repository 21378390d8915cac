//! Voxels to rectangles: the visible faces of a brick, merged greedily per class. CPU only.

use std::ops::Range;

use rayon::prelude::*;

use super::pool;
use scene::grid::{BRICK, Brick, brick_columns};
use scene::{Class, Extent, Lattice, VoxelGrid};

/// Which voxels are drawn: one bit per bin of every column, after hidden classes and the height clip.
/// Empty columns border the grid on all sides, so that looking [`Solidity::MARGIN`] beyond it is no
/// special case.
#[derive(Clone, Debug, PartialEq)]
pub struct Solidity {
    extent: Extent,
    columns: Vec<u64>, // [x + MARGIN][y + MARGIN]
}

/// A rectangle of columns: lower corner, and upper corner exclusive.
pub type ColumnBox = ([usize; 2], [usize; 2]);

impl Solidity {
    /// Empty columns on each side of the grid.
    pub const MARGIN: usize = 16;

    /// The solidity of a grid that holds nothing.
    pub fn empty(extent: Extent) -> Self {
        let [w, h] = [extent.nx(), extent.ny()].map(|n| n + 2 * Self::MARGIN);
        Self {
            extent,
            columns: vec![0; w * h],
        }
    }

    /// The solidity of a whole grid; see [`Visible`].
    pub fn from_grid(grid: &VoxelGrid, visible: Visible) -> Self {
        let mut solid = Self::empty(grid.extent());
        for (brick, voxels) in grid.bricks().iter().enumerate() {
            solid.update(brick, voxels, visible);
        }
        solid
    }

    /// Which part of the ground it covers, without the margins.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Distance from a column to the one beside it along x, in [`Solidity::padded`].
    #[inline]
    pub fn stride(&self) -> usize {
        self.extent.ny() + 2 * Self::MARGIN
    }

    /// Takes over one brick; returns the box around the columns that changed, if any did.
    pub fn update(&mut self, brick: usize, voxels: &Brick, visible: Visible) -> Option<ColumnBox> {
        let ([x0, y0], [nx, ny]) = brick_columns(self.extent, brick);
        let bins = self.extent.nz();
        let mut changed: Option<ColumnBox> = None;
        for x in x0..x0 + nx {
            let row = self.index(x, 0);
            for y in y0..y0 + ny {
                let at = ((x - x0) * BRICK + y - y0) * bins;
                let mut bits = 0u64;
                for (z, &class) in voxels[at..at + bins].iter().enumerate() {
                    bits |= u64::from(visible.class(class)) << z;
                }
                bits &= visible.below_clip;
                let old = std::mem::replace(&mut self.columns[row + y], bits);
                if old != bits {
                    changed = join(changed, Some(([x, y], [x + 1, y + 1])));
                }
            }
        }
        changed
    }

    /// The bits of a column, lowest bin first; x and y may reach [`Solidity::MARGIN`] beyond the grid.
    #[inline]
    pub fn column(&self, x: isize, y: isize) -> u64 {
        let margin = Self::MARGIN as isize;
        self.columns[(x + margin) as usize * self.stride() + (y + margin) as usize]
    }

    /// All columns, margins included; see [`Solidity::index`].
    #[inline]
    pub fn padded(&self) -> &[u64] {
        &self.columns
    }

    /// Where a column of the grid is in [`Solidity::padded`].
    #[inline]
    pub fn index(&self, x: usize, y: usize) -> usize {
        (x + Self::MARGIN) * self.stride() + y + Self::MARGIN
    }
}

/// The box around two boxes.
pub fn join(a: Option<ColumnBox>, b: Option<ColumnBox>) -> Option<ColumnBox> {
    let (Some(a), Some(b)) = (a, b) else {
        return a.or(b);
    };
    let low = [0, 1].map(|i| a.0[i].min(b.0[i]));
    let high = [0, 1].map(|i| a.1[i].max(b.1[i]));
    Some((low, high))
}

/// The visible part of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visible {
    /// Bit c hides class c.
    pub hidden_classes: u32,
    /// Bit z shows bin z.
    pub below_clip: u64,
}

impl Visible {
    /// All voxels that are not free.
    pub const ALL: Visible = Visible {
        hidden_classes: 0,
        below_clip: u64::MAX,
    };

    fn class(self, class: u8) -> bool {
        class < Class::FREE && self.hidden_classes >> class & 1 == 0
    }
}

/// Faces of one brick: four vertices per rectangle, counter-clockwise from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BrickMesh {
    /// `x | y << 5 | z << 10 | direction << 21 | class << 24`: the corner in voxel units of the brick.
    pub vertices: Vec<u32>,
    /// Rectangles of each direction: +x, -x, +y, -y, +z, -z.
    pub quads: [Range<u32>; 6],
}

/// Outward normals of the six directions, in the order of [`BrickMesh::quads`].
pub const NORMALS: [[i32; 3]; 6] = [
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
];

const NONE: u8 = u8::MAX;

/// Bricks up to which meshing goes on in this thread: others would take longer to wake.
const FEW: usize = 16;

/// Meshes of several bricks, in parallel if they are many; the result does not depend on the number of threads.
pub fn mesh_bricks(grid: &VoxelGrid, solid: &Solidity, bricks: &[usize]) -> Vec<BrickMesh> {
    let mesh = |&b: &usize| mesh_brick(&grid.bricks()[b], b, solid);
    match bricks.len() {
        0..=FEW => bricks.iter().map(mesh).collect(),
        _ => pool::run(|| bricks.par_iter().map(mesh).collect()),
    }
}

/// The faces of a brick between a drawn voxel and one that is not drawn.
pub fn mesh_brick(voxels: &Brick, brick: usize, solid: &Solidity) -> BrickMesh {
    let ([x0, y0], [nx, ny]) = brick_columns(solid.extent, brick);
    let mut mesh = BrickMesh::default();
    let mut exposed = [0u64; BRICK * BRICK];
    for (direction, normal) in NORMALS.iter().enumerate() {
        let start = mesh.vertices.len() as u32 / 4;
        let mut any = 0;
        for x in 0..nx {
            for y in 0..ny {
                let (gx, gy) = ((x0 + x) as isize, (y0 + y) as isize);
                let own = solid.column(gx, gy);
                let covered = match normal[2] {
                    1 => own >> 1,
                    -1 => own << 1,
                    _ => solid.column(gx + normal[0] as isize, gy + normal[1] as isize),
                };
                exposed[x * BRICK + y] = own & !covered;
                any |= exposed[x * BRICK + y];
            }
        }
        if any != 0 {
            let face = FaceSlices {
                voxels,
                exposed: &exposed,
                axis: direction / 2,
                size: [nx, ny, solid.extent.nz()],
            };
            face.merge(|class, slice, low, high| {
                emit(&mut mesh.vertices, direction, class, slice, low, high);
            });
        }
        mesh.quads[direction] = start..mesh.vertices.len() as u32 / 4;
    }
    mesh
}

struct FaceSlices<'a> {
    voxels: &'a Brick,
    exposed: &'a [u64; BRICK * BRICK],
    axis: usize,
    size: [usize; 3],
}

impl FaceSlices<'_> {
    /// Visits every merged rectangle: class, slice along the axis, lower and upper corner in the plane.
    fn merge(&self, mut visit: impl FnMut(u8, usize, [usize; 2], [usize; 2])) {
        let (a_axis, b_axis) = plane_axes(self.axis);
        let (na, nb) = (self.size[a_axis], self.size[b_axis]);
        let mut cells = [NONE; BRICK * Lattice::MAX_BINS]; // [b][a]; a is never the height
        for slice in 0..self.size[self.axis] {
            let mut any = false;
            for b in 0..nb {
                for a in 0..na {
                    let mut v = [0; 3];
                    (v[self.axis], v[a_axis], v[b_axis]) = (slice, a, b);
                    let column = v[0] * BRICK + v[1];
                    let open = self.exposed[column] >> v[2] & 1 == 1;
                    any |= open;
                    cells[b * BRICK + a] = if open {
                        self.voxels[column * self.size[2] + v[2]]
                    } else {
                        NONE
                    };
                }
            }
            if !any {
                continue;
            }
            for b in 0..nb {
                let mut a = 0;
                while a < na {
                    let class = cells[b * BRICK + a];
                    if class == NONE {
                        a += 1;
                        continue;
                    }
                    let mut a1 = a + 1;
                    while a1 < na && cells[b * BRICK + a1] == class {
                        a1 += 1;
                    }
                    let mut b1 = b + 1;
                    while b1 < nb && cells[b1 * BRICK..][a..a1].iter().all(|c| *c == class) {
                        b1 += 1;
                    }
                    for row in b..b1 {
                        cells[row * BRICK..][a..a1].fill(NONE);
                    }
                    visit(class, slice, [a, b], [a1, b1]);
                    a = a1;
                }
            }
        }
    }
}

/// The two axes of a face plane, in ascending order.
fn plane_axes(axis: usize) -> (usize, usize) {
    match axis {
        0 => (1, 2),
        1 => (0, 2),
        _ => (0, 1),
    }
}

/// True where going round the corners as (a, then b) is clockwise seen from outside.
pub fn is_reversed(direction: usize) -> bool {
    matches!(direction, 1 | 2 | 5)
}

fn emit(out: &mut Vec<u32>, direction: usize, class: u8, slice: usize, low: [usize; 2], high: [usize; 2]) {
    let axis = direction / 2;
    let (a_axis, b_axis) = plane_axes(axis);
    let mut corners = [
        [low[0], low[1]],
        [high[0], low[1]],
        [high[0], high[1]],
        [low[0], high[1]],
    ];
    if is_reversed(direction) {
        corners.swap(1, 3);
    }
    for [a, b] in corners {
        let mut p = [0; 3];
        p[axis] = slice + usize::from(direction.is_multiple_of(2));
        (p[a_axis], p[b_axis]) = (a, b);
        let [x, y, z] = p;
        out.push((x | y << 5 | z << 10 | direction << 21) as u32 | u32::from(class) << 24);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small generator, so that the test needs no crate for it.
    fn noise(state: &mut u64) -> u64 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        *state >> 33
    }

    fn speckled(extent: Extent, percent: u64, classes: u64) -> VoxelGrid {
        let mut grid = VoxelGrid::over(extent);
        let mut state = 7 + percent;
        for x in (0..extent.nx()).filter(|x| x % 29 < 17) {
            for y in (0..extent.ny()).filter(|y| y % 23 < 19) {
                for z in 0..extent.nz() {
                    if noise(&mut state) % 100 < percent {
                        grid.set(x, y, z, (noise(&mut state) % classes) as u8);
                    }
                }
            }
        }
        grid
    }

    fn unpack(v: u32) -> ([i64; 3], usize, u8) {
        let p = [v & 31, v >> 5 & 31, v >> 10 & 127].map(i64::from);
        (p, (v >> 21 & 7) as usize, (v >> 24) as u8)
    }

    /// Every unit face of the mesh with its class, or an error text if two overlap or one is not flat.
    fn unit_faces(mesh: &BrickMesh) -> Result<std::collections::BTreeMap<([i64; 3], usize), u8>, String> {
        let mut faces = std::collections::BTreeMap::new();
        for (direction, range) in mesh.quads.iter().enumerate() {
            for q in range.clone() {
                let quad: Vec<_> = mesh.vertices[q as usize * 4..][..4]
                    .iter()
                    .map(|v| unpack(*v))
                    .collect();
                let (class, axis) = (quad[0].2, direction / 2);
                let sub = |a: [i64; 3], b: [i64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
                let (e, f) = (sub(quad[1].0, quad[0].0), sub(quad[2].0, quad[1].0));
                let cross = [
                    e[1] * f[2] - e[2] * f[1],
                    e[2] * f[0] - e[0] * f[2],
                    e[0] * f[1] - e[1] * f[0],
                ];
                let outward: i64 = (0..3).map(|i| cross[i] * i64::from(NORMALS[direction][i])).sum();
                if outward <= 0 || outward != cross.iter().map(|c| c.abs()).sum::<i64>() {
                    return Err(format!("rectangle {quad:?} does not face outward"));
                }
                let low: Vec<i64> = (0..3)
                    .map(|i| quad.iter().map(|v| v.0[i]).min().unwrap_or(0))
                    .collect();
                let high: Vec<i64> = (0..3)
                    .map(|i| quad.iter().map(|v| v.0[i]).max().unwrap_or(0))
                    .collect();
                let span = |i: usize| {
                    if i == axis {
                        low[i]..low[i] + 1
                    } else {
                        low[i]..high[i]
                    }
                };
                for x in span(0) {
                    for y in span(1) {
                        for z in span(2) {
                            if faces.insert(([x, y, z], direction), class).is_some() {
                                return Err(format!("face {x} {y} {z} {direction} twice"));
                            }
                        }
                    }
                }
            }
        }
        Ok(faces)
    }

    fn check(grid: &VoxelGrid, visible: Visible) {
        let solid = Solidity::from_grid(grid, visible);
        let bricks: Vec<usize> = (0..grid.bricks().len()).collect();
        let mut found = std::collections::BTreeMap::new();
        for (brick, mesh) in mesh_bricks(grid, &solid, &bricks).into_iter().enumerate() {
            let (from, _) = grid.brick_columns(brick);
            assert_eq!(mesh.quads[5].end as usize * 4, mesh.vertices.len());
            assert!(mesh.vertices.len() <= 65536, "indices are 16 bit");
            let faces = unit_faces(&mesh).expect("flat and disjoint");
            found.extend(faces.into_iter().map(|((p, direction), class)| {
                let at = [p[0] + from[0] as i64, p[1] + from[1] as i64, p[2]];
                ((at, direction), class)
            }));
        }
        let shown = |p: [i64; 3]| -> Option<u8> {
            let n = grid.extent().shape();
            if (0..3).any(|i| p[i] < 0 || p[i] >= n[i] as i64) {
                return None;
            }
            let class = grid.get(p[0] as usize, p[1] as usize, p[2] as usize);
            let below = visible.below_clip >> p[2] & 1 == 1;
            (class < 17 && visible.hidden_classes >> class & 1 == 0 && below).then_some(class)
        };
        let mut expected = std::collections::BTreeMap::new();
        for (x, y, z, _) in grid.iter_set() {
            let p = [x as i64, y as i64, z as i64];
            let Some(class) = shown(p) else { continue };
            for (direction, n) in NORMALS.iter().enumerate() {
                let q = [0, 1, 2].map(|i| p[i] + i64::from(n[i]));
                if shown(q).is_none() {
                    let mut at = p;
                    at[direction / 2] += i64::from(direction % 2 == 0);
                    expected.insert((at, direction), class);
                }
            }
        }
        assert_eq!(found.len(), expected.len());
        assert!(found == expected, "same faces, same classes");
    }

    #[test]
    fn merged_rectangles_are_exactly_the_exposed_faces() {
        for (percent, classes) in [(3, 17), (50, 2), (97, 3), (100, 1)] {
            check(&speckled(Extent::WINDOW, percent, classes), Visible::ALL);
        }
        for size in [[1, 1], [17, 300], [33, 16]] {
            let extent = Extent::new([-7, 90], size).expect("sound");
            check(&speckled(extent, 60, 3), Visible::ALL);
        }
        check(&VoxelGrid::new(), Visible::ALL);
        let some = Visible {
            hidden_classes: 0b101,
            below_clip: 0x03ff,
        };
        check(&speckled(Extent::WINDOW, 60, 5), some);
        // Labels outside of the palette are not drawn and harm nothing.
        let mut odd = VoxelGrid::new();
        odd.set(3, 3, 3, 200);
        check(&odd, Visible::ALL);
    }

    #[test]
    fn a_flat_plane_is_one_rectangle_per_brick() {
        let mut grid = VoxelGrid::over(Extent::new([-150, -110], [470, 320]).expect("sound"));
        for [x, y] in grid.extent().all_columns() {
            grid.set(x, y, 0, 11);
        }
        let solid = Solidity::from_grid(&grid, Visible::ALL);
        for b in 0..grid.bricks().len() {
            let mesh = mesh_brick(&grid.bricks()[b], b, &solid);
            assert_eq!(mesh.quads[4].len(), 1);
        }
    }

    #[test]
    fn solidity_reports_changes_of_shape_only() {
        let mut grid = VoxelGrid::new();
        grid.set(20, 20, 5, 4);
        let mut solid = Solidity::from_grid(&grid, Visible::ALL);
        grid.set(20, 20, 5, 9);
        let brick = grid.bricks_along()[1] + 1;
        assert_eq!(solid.update(brick, &grid.bricks()[brick], Visible::ALL), None);
        grid.set(20, 20, 6, 9);
        let changed = solid.update(brick, &grid.bricks()[brick], Visible::ALL);
        assert_eq!(changed, Some(([20, 20], [21, 21])));
        assert_eq!(join(changed, Some(([3, 30], [4, 31]))), Some(([3, 20], [21, 31])));
        assert_eq!(solid.column(20, 20), 0b110_0000);
        assert_eq!(solid.column(-1, 20), 0);
        assert_eq!(solid.column(20, 200), 0);
    }
}
