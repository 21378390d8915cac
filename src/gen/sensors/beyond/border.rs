//! The edge of the grid of a scene: its ground, the ground's height, and what stands near. The continuation beyond the
//! grid ([`crate::beyond::backdrop`]) is drawn up from this, so it is the same for a procedural world and for voxels.

use glam::{DVec2, DVec3};

use scene::{Class, Extent, Lattice, VoxelGrid};
use world::World;

/// Depths at which the ground is sampled, in cells from the edge.
pub const DEPTHS: [usize; 5] = [0, 5, 10, 15, 20];
/// Spacing of the samples of what stands there, cells.
const STRIDE: usize = 5;
/// Depth from the edge up to which samples are taken, cells.
const DEEP: usize = 20;
/// Least height of a solid that counts as lining a street, m.
const LOW_M: f64 = 0.5;
/// Height over the ground at which the search for the highest thing begins, m.
const SKY_M: f64 = 60.0;

/// One side of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSide {
    /// 0 for x, 1 for y: the axis that leads out.
    pub axis: usize,
    /// True for the side at the upper corner.
    pub high: bool,
}

/// The four sides.
pub const SIDES: [GridSide; 4] = [
    GridSide { axis: 0, high: false },
    GridSide { axis: 0, high: true },
    GridSide { axis: 1, high: false },
    GridSide { axis: 1, high: true },
];

impl GridSide {
    /// Number of the side, as in [`SIDES`].
    pub fn index(self) -> usize {
        self.axis * 2 + usize::from(self.high)
    }

    /// Cells along the side.
    pub fn cells(self, extent: Extent) -> usize {
        [extent.ny(), extent.nx()][self.axis]
    }

    /// The cell at a depth and a place along the side; beyond the depth of the grid the last cell across.
    pub fn cell(self, extent: Extent, depth: usize, along: usize) -> [usize; 2] {
        let last = [extent.nx(), extent.ny()][self.axis] - 1;
        let depth = depth.min(last);
        let out = if self.high { last - depth } else { depth };
        if self.axis == 0 {
            [out, along]
        } else {
            [along, out]
        }
    }

    /// Middle of a cell, m.
    pub fn point(self, extent: Extent, depth: usize, along: usize) -> DVec2 {
        let [x, y] = self.cell(extent, depth, along);
        extent.center(x, y, 0).truncate()
    }

    /// Outward unit normal.
    pub fn normal(self) -> DVec2 {
        let sign = if self.high { 1.0 } else { -1.0 };
        if self.axis == 0 {
            DVec2::X * sign
        } else {
            DVec2::Y * sign
        }
    }
}

/// The rectangle of ground that a grid covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covered {
    /// Lower corner, m.
    pub low: DVec2,
    /// Upper corner, m.
    pub high: DVec2,
}

impl Covered {
    /// The rectangle of an extent.
    pub fn by(extent: Extent) -> Self {
        Self {
            low: extent.min_m().truncate(),
            high: extent.max_m().truncate(),
        }
    }

    /// The rectangle grown by `by_m` on every side.
    pub fn wider(self, by_m: f64) -> Self {
        Self {
            low: self.low - by_m,
            high: self.high + by_m,
        }
    }

    /// How far a point lies beyond it along each axis, m; less than 0 inside.
    pub fn beyond_m(&self, p: DVec2) -> DVec2 {
        (self.low - p).max(p - self.high)
    }

    /// How far a point lies beyond it along one axis at least, m; less than 0 inside.
    pub fn out_m(&self, p: DVec2) -> f64 {
        self.beyond_m(p).max_element()
    }

    /// Distance at which a ray leaves it for good; 0 for a ray that begins beyond it, infinite for a vertical one.
    pub fn left_by(&self, origin: DVec3, dir: DVec3) -> f64 {
        let side = |axis: usize| match dir[axis] {
            d if d.abs() < 1e-12 => f64::INFINITY,
            d if d > 0.0 => (self.high[axis] - origin[axis]) / d,
            d => (self.low[axis] - origin[axis]) / d,
        };
        let from = origin.truncate();
        if from.cmple(self.low).any() || from.cmpge(self.high).any() {
            return 0.0;
        }
        side(0).min(side(1)).max(0.0)
    }
}

/// A thing near the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stands {
    /// Position, m.
    pub at: DVec2,
    /// Class; free if nothing stands there.
    pub class: Class,
    /// Its height above the ground, m.
    pub height_m: f64,
}

/// The edge of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Border {
    extent: Extent,
    covered: Covered,
    ground: Vec<Class>,  // [side][depth][along], free where nothing is known
    height_m: Vec<f64>,  // [side][along], at the very edge
    stands: Vec<Stands>, // samples, also of places where nothing stands (class free)
}

impl Border {
    /// The edge of a procedural world.
    pub fn of_world(world: &World) -> Self {
        let extent = world.layout.extent();
        Self::new(
            extent,
            |x, y| {
                let at = extent.center(x, y, 0).truncate();
                (world.ground_class(x, y), world.ground_height(at))
            },
            |x, y, ground_m| {
                let at = extent.center(x, y, 0).truncate().extend(ground_m + SKY_M);
                // A hit without a solid is the ground.
                let hit = world.cast(at, DVec3::NEG_Z, SKY_M)?;
                hit.solid?;
                Some((hit.class, SKY_M - hit.range_m))
            },
        )
    }

    /// The edge of a voxel grid; `lift_m` is the height by which labels put the ground too low.
    pub fn of_grid(grid: &VoxelGrid, lift_m: f64) -> Self {
        let top = |z: usize| Lattice::OCC3D.bottom_m() + Lattice::OCC3D.voxel_m() * (z + 1) as f64;
        let known = |label: u8| Class::from_id(label).filter(|c| *c != Class::Free);
        Self::new(
            grid.extent(),
            |x, y| {
                let column = grid.column(x, y);
                let ground = (0..Lattice::OCC3D.bins()).find_map(|z| {
                    let class = known(column[z]).filter(|c| c.is_ground())?;
                    Some((class, top(z) + lift_m))
                });
                ground.unwrap_or((Class::Free, 0.0))
            },
            |x, y, ground_m| {
                let column = grid.column(x, y);
                (0..Lattice::OCC3D.bins()).rev().find_map(|z| {
                    let class = known(column[z]).filter(|c| !c.is_ground())?;
                    // The height of a thing that reaches the ceiling is unknown: some storeys are added.
                    let more = if z + 1 == Lattice::OCC3D.bins() { 4.0 } else { 0.0 };
                    Some((class, top(z) + more - ground_m))
                })
            },
        )
    }

    fn new(
        extent: Extent,
        ground_at: impl Fn(usize, usize) -> (Class, f64),
        stands_at: impl Fn(usize, usize, f64) -> Option<(Class, f64)>,
    ) -> Self {
        let (mut ground, mut height_m, mut stands) = (Vec::new(), Vec::new(), Vec::new());
        let mut at_edge = Vec::new();
        for side in SIDES {
            let (cells, edge) = (side.cells(extent), height_m.len());
            for depth in DEPTHS {
                for along in 0..cells {
                    let [x, y] = side.cell(extent, depth, along);
                    let (class, at_m) = ground_at(x, y);
                    ground.push(class);
                    if depth == 0 {
                        at_edge.push(class);
                        height_m.push(at_m);
                    }
                }
            }
            for depth in (2..DEEP).step_by(STRIDE) {
                for along in (2..cells).step_by(STRIDE) {
                    let [x, y] = side.cell(extent, depth, along);
                    let ground_m = height_m[edge + along];
                    let found = stands_at(x, y, ground_m).filter(|(_, h)| *h > LOW_M);
                    let (class, height_m) = found.unwrap_or((Class::Free, 0.0));
                    let at = side.point(extent, depth, along);
                    stands.push(Stands { at, class, height_m });
                }
            }
        }
        // Unknown ground lies as high as the last known.
        let first = at_edge.iter().position(|class| *class != Class::Free);
        let mut last = first.map_or(0.0, |i| height_m[i]);
        for (class, height_m) in at_edge.iter().zip(&mut height_m) {
            if *class == Class::Free || !height_m.is_finite() {
                *height_m = last;
            }
            last = *height_m;
        }
        Self {
            extent,
            covered: Covered::by(extent),
            ground,
            height_m,
            stands,
        }
    }

    /// True if a change of the columns from `low` to `high` may change the edge.
    pub fn is_touched(extent: Extent, low: [f64; 2], high: [f64; 2]) -> bool {
        let deep = DEEP as f64 + 1.0;
        let inner = [extent.nx(), extent.ny()].map(|n| n as f64 - deep);
        (0..2).any(|axis| low[axis] <= deep || high[axis] >= inner[axis])
    }

    /// Extent of the grid.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// The ground that the grid covers.
    pub fn covered(&self) -> Covered {
        self.covered
    }

    /// Place of a cell of the edge in arrays `[side][along]`.
    fn at_edge(&self, side: GridSide, along: usize) -> usize {
        let before = match side.axis {
            0 => 0,
            _ => 2 * self.extent.ny(),
        };
        before + usize::from(side.high) * side.cells(self.extent) + along
    }

    /// Ground of a cell; `depth` counts in [`DEPTHS`].
    pub fn ground(&self, side: GridSide, depth: usize, along: usize) -> Class {
        self.ground[self.at_edge(side, 0) * DEPTHS.len() + depth * side.cells(self.extent) + along]
    }

    /// True if nothing is known of the ground at the edge: then there is no continuation.
    pub fn is_empty(&self) -> bool {
        let is_free = |side: &GridSide| {
            (0..side.cells(self.extent)).all(|along| self.ground(*side, 0, along) == Class::Free)
        };
        SIDES.iter().all(is_free)
    }

    /// Height of the ground beyond the grid: that of the nearest place at the edge, m.
    pub fn height_m(&self, p: DVec2) -> f64 {
        let (side, along) = self.nearest(p);
        self.height_m[self.at_edge(side, along)]
    }

    /// Class of the ground at the nearest place at the edge.
    pub fn nearest_ground(&self, p: DVec2) -> Class {
        let (side, along) = self.nearest(p);
        self.ground(side, 0, along)
    }

    /// Lowest and highest ground, m.
    pub fn heights_m(&self) -> [f64; 2] {
        let fold = |f: fn(f64, f64) -> f64, from: f64| self.height_m.iter().copied().fold(from, f);
        [fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY)]
    }

    /// Things near the edge, sampled evenly; class free where nothing stands.
    pub fn stands(&self) -> &[Stands] {
        &self.stands
    }

    /// The place at the edge that is nearest to a point beyond it.
    fn nearest(&self, p: DVec2) -> (GridSide, usize) {
        let Covered { low, high } = self.covered;
        let beyond_m = self.covered.beyond_m(p);
        let axis = usize::from(beyond_m.y > beyond_m.x);
        let side = GridSide {
            axis,
            high: p[axis] > (low[axis] + high[axis]) / 2.0,
        };
        // Casts saturate; NaN is 0.
        let along = ((p[1 - axis] - low[1 - axis]) / Lattice::OCC3D.voxel_m()) as usize;
        (side, along.min(side.cells(self.extent) - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Window;
    use world::voxelize::{Vertical, complete};

    #[test]
    fn a_world_and_its_voxels_have_the_same_edge() {
        let world = World::random_level(4);
        let (exact, voxels) = (
            Border::of_world(&world),
            Border::of_grid(&complete(&world, Vertical::Occ3d), 0.6),
        );
        let (mut same, mut of) = (0, 0);
        for side in SIDES {
            for along in 0..Window::NX {
                let found = voxels.ground(side, 0, along);
                if found != Class::Free {
                    of += 1;
                    same += usize::from(found == exact.ground(side, 0, along));
                }
                let p = side.point(Extent::WINDOW, 0, along) + side.normal() * 20.0;
                assert!((voxels.height_m(p) - exact.height_m(p)).abs() < 0.5);
            }
        }
        assert!(of > 600 && same * 10 > of * 9, "{same} of {of}");
        let touched = |low, high| Border::is_touched(Extent::WINDOW, low, high);
        let tall = |b: &Border| b.stands().iter().filter(|s| s.class != Class::Free).count();
        let (a, b) = (tall(&exact), tall(&voxels));
        assert!(a > 10 && b * 2 > a && a * 2 > b, "{a} {b}");
        assert!(touched([100.0, 10.0], [110.0, 14.0]) && touched([181.0; 2], [182.0; 2]));
        assert!(!touched([30.0; 2], [170.0; 2]));
        assert!(!exact.is_empty() && Border::of_grid(&VoxelGrid::new(), 0.0).is_empty());
    }
}
