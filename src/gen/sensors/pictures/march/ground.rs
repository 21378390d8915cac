//! The ground at its physical height: ground labels lie two bins low and everything else is smeared two bins down
//! (`real_statistics.md`, 2.2). Here the ground becomes a height per column and the smear is removed.

use std::collections::VecDeque;

use glam::DVec3;

use scene::{Class, Extent, Lattice, VoxelGrid};

/// Height at which the ground is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum GroundHeight {
    /// In the voxels labelled as ground: the road's surface at z = -0.6 m.
    #[default]
    AsLabelled,
    /// At its measured height: bin 0 at z = 0, bin k at the lower face of bin k + 2, the lowest height that the labels
    /// allow (a kerb of 0.2 m); things that hang in the air lose their smear.
    Physical,
}

const SMEAR: usize = 2;
/// Thickness of a ground voxel in voxels: seen only from the side or from below.
const THICK: f64 = 1.0;

/// Heights of the ground in voxel units, `[x][y]`; empty if the ground stays among the voxels.
#[derive(Clone, Debug, Default)]
pub struct GroundHeightField {
    extent: Extent,
    top: Vec<f64>, // NaN: none
    class: Vec<u8>,
    wanted: Vec<bool>,
    lowest: f64,
    highest: f64,
}

/// Where a ray meets the ground, in voxel units.
#[derive(Clone, Copy, Debug)]
pub struct GroundHit {
    /// Distance in units of the direction's length.
    pub t: f64,
    /// Label.
    pub class: u8,
    /// Normal of the face.
    pub normal: DVec3,
}

fn is_ground(label: u8) -> bool {
    Class::from_id(label).is_some_and(Class::is_ground)
}

/// Splits a grid into the voxels that stand on the ground, and the ground. With [`GroundHeight::AsLabelled`] the ground
/// stays among the voxels.
pub fn split(grid: &VoxelGrid, height: GroundHeight) -> (VoxelGrid, GroundHeightField) {
    if height == GroundHeight::AsLabelled {
        let none = GroundHeightField {
            extent: grid.extent(),
            ..GroundHeightField::default()
        };
        return (grid.clone(), none);
    }
    let split = SplitGrid::new(grid, None);
    (split.standing, split.ground)
}

/// A grid split into what stands and the ground at its physical height.
pub struct SplitGrid {
    grid: VoxelGrid,
    /// The voxels that stand on the ground.
    pub standing: VoxelGrid,
    /// The ground.
    pub ground: GroundHeightField,
}

impl SplitGrid {
    /// Splits a grid. Bricks that it shares with the grid of `before` are taken from there.
    pub fn new(grid: &VoxelGrid, before: Option<&Self>) -> Self {
        let extent = grid.extent();
        let before = before.filter(|before| before.grid.extent() == extent);
        let (mut standing, mut ground, changed) = match before {
            Some(before) => (
                before.standing.clone(),
                before.ground.clone(),
                grid.changed_bricks(&before.grid),
            ),
            None => (
                VoxelGrid::over(extent),
                GroundHeightField {
                    extent,
                    top: vec![f64::NAN; extent.columns()],
                    class: vec![Class::FREE; extent.columns()],
                    wanted: vec![false; extent.columns()],
                    lowest: f64::INFINITY,
                    highest: f64::NEG_INFINITY,
                },
                (0..grid.bricks().len()).collect(),
            ),
        };
        for brick in changed {
            let (from, size) = grid.brick_columns(brick);
            for [x, y] in (0..size[0]).flat_map(|x| (0..size[1]).map(move |y| [from[0] + x, from[1] + y])) {
                let (upper, bin) = split_column(grid.window_column(x, y));
                match bin {
                    Some(bin) => ground.set(extent.index(x, y), top_of(bin), grid.get(x, y, bin)),
                    None => ground.clear(extent.index(x, y)),
                }
                if upper != *standing.window_column(x, y) {
                    *standing.window_column_mut(x, y) = upper;
                }
            }
        }
        ground.bound();
        Self {
            grid: grid.clone(),
            standing,
            ground,
        }
    }
}

type Column = [u8; Lattice::OCC3D.bins()];

/// What stands in a column, and the bin of its ground.
fn split_column(column: &Column) -> (Column, Option<usize>) {
    let mut upper = *column;
    if upper == [Class::FREE; Lattice::OCC3D.bins()] {
        return (upper, None);
    }
    let ground = (0..Lattice::OCC3D.bins()).rev().find(|z| is_ground(column[*z]));
    if ground.is_some() {
        upper
            .iter_mut()
            .filter(|l| is_ground(**l))
            .for_each(|label| *label = Class::FREE);
    }
    unsmear(&mut upper, ground.unwrap_or(0));
    (upper, ground)
}

/// Height of the ground labelled in `bin`, in voxel units above the grid's floor.
pub fn top_of(bin: usize) -> f64 {
    match bin {
        0 => 2.5,
        _ => (bin + SMEAR) as f64,
    }
}

/// Removes the two lowest voxels of every run that hangs in the air, and the voxels below the ground, which is labelled in the
/// bin `ground` and lies two bins higher: of what stands on it one voxel is below.
fn unsmear(column: &mut Column, ground: usize) {
    let labels = *column;
    // A run from bin 1 stands on a pavement.
    for z in SMEAR..Lattice::OCC3D.bins() {
        let begins = labels[z] != Class::FREE && labels[z - 1] == Class::FREE;
        let run = labels[z..].iter().take_while(|l| **l != Class::FREE).count();
        let below = match z == ground + 1 {
            true => SMEAR - 1,
            false => SMEAR,
        };
        if begins && run > SMEAR {
            column[z..z + below].fill(Class::FREE);
        }
    }
    column[..SMEAR].fill(Class::FREE);
}

impl GroundHeightField {
    fn set(&mut self, at: usize, top: f64, class: u8) {
        (self.top[at], self.class[at]) = (top, class);
        self.lowest = self.lowest.min(top);
        self.highest = self.highest.max(top);
    }

    /// Label and height in m above the ego's ground of a column, if there is ground.
    pub fn at(&self, x: usize, y: usize) -> Option<(u8, f64)> {
        let i = self.extent.index(x, y);
        let top = *self.top.get(i)?;
        (!top.is_nan()).then(|| {
            (
                self.class[i],
                top * Lattice::OCC3D.voxel_m() + Lattice::OCC3D.bottom_m(),
            )
        })
    }

    fn clear(&mut self, at: usize) {
        (self.top[at], self.class[at]) = (f64::NAN, Class::FREE);
    }

    /// Finds the lowest and the highest ground.
    fn bound(&mut self) {
        (self.lowest, self.highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for top in self.top.iter().filter(|top| !top.is_nan()) {
            (self.lowest, self.highest) = (self.lowest.min(*top), self.highest.max(*top));
        }
    }

    /// The bin of voxels that stand on the ground of a column at its physical height; on level ground without one.
    pub fn bin_on(&self, x: usize, y: usize) -> usize {
        let top = self.top.get(self.extent.index(x, y)).copied().unwrap_or(f64::NAN);
        if top.is_nan() { SMEAR } else { top as usize }
    }

    /// Marks a column whose ground an object hid, for [`Self::fill_wanted`].
    pub fn want(&mut self, x: usize, y: usize) {
        if let Some(wanted) = self.wanted.get_mut(self.extent.index(x, y)) {
            *wanted = true;
        }
    }

    /// Gives each marked column the ground of the nearest one that has some (steps over faces).
    pub fn fill_wanted(&mut self) {
        if !self.wanted.contains(&true) {
            return;
        }
        let mut source: Vec<u32> = vec![u32::MAX; self.top.len()];
        let mut queue: VecDeque<usize> = VecDeque::new();
        for (i, top) in self.top.iter().enumerate() {
            if !top.is_nan() {
                source[i] = i as u32;
                queue.push_back(i);
            }
        }
        while let Some(i) = queue.pop_front() {
            let [x, y] = self.extent.column(i);
            for (nx, ny) in [
                (x.wrapping_sub(1), y),
                (x + 1, y),
                (x, y.wrapping_sub(1)),
                (x, y + 1),
            ] {
                if self.extent.holds(nx, ny) {
                    let n = self.extent.index(nx, ny);
                    if source[n] == u32::MAX {
                        source[n] = source[i];
                        queue.push_back(n);
                    }
                }
            }
        }
        for (i, &nearest) in source.iter().enumerate() {
            if self.wanted[i] && self.top[i].is_nan() && nearest != u32::MAX {
                let from = nearest as usize;
                self.set(i, self.top[from], self.class[from]);
            }
        }
    }

    /// The first ground along a ray in voxel units before `t_max`; the input is finite.
    pub fn cast(&self, o: DVec3, d: DVec3, t_max: f64) -> Option<GroundHit> {
        if self.top.is_empty() || self.lowest > self.highest {
            return None;
        }
        let (mut t0, mut t1) = (0.0, t_max);
        let n = [self.extent.nx(), self.extent.ny()];
        let limits = [
            (0.0, n[0] as f64),
            (0.0, n[1] as f64),
            (self.lowest - THICK, self.highest),
        ];
        let mut entered = 2; // axis by whose plane the ray comes in
        for axis in [0, 1, 2] {
            let (lo, hi) = limits[axis];
            if d[axis] == 0.0 {
                if !(lo..=hi).contains(&o[axis]) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((lo - o[axis]) / d[axis], (hi - o[axis]) / d[axis]);
            if a.min(b) > t0 {
                (t0, entered) = (a.min(b), axis);
            }
            t1 = f64::min(t1, a.max(b));
        }
        // Written so that NaN ends here too.
        let inside = t0 <= t1;
        if !inside {
            return None;
        }
        let start = |axis: usize| ((o[axis] + d[axis] * t0).max(0.0) as usize).min(n[axis] - 1);
        let mut cell = [start(0), start(1)];
        let next = |cell: [usize; 2], axis: usize| {
            if d[axis] == 0.0 {
                return f64::INFINITY;
            }
            ((cell[axis] + usize::from(d[axis] > 0.0)) as f64 - o[axis]) / d[axis]
        };
        let mut t_in = t0;
        for _ in 0..n[0] + n[1] + 2 {
            let (tx, ty) = (next(cell, 0), next(cell, 1));
            let axis = usize::from(ty < tx);
            let t_out = tx.min(ty).min(t1).max(t_in);
            let at = cell[0] * n[1] + cell[1];
            let top = self.top[at];
            if !top.is_nan() {
                let hit = |t: f64, normal: DVec3| {
                    Some(GroundHit {
                        t,
                        class: self.class[at],
                        normal,
                    })
                };
                let (za, zb) = (o.z + d.z * t_in, o.z + d.z * t_out);
                if za <= top && za >= top - THICK {
                    let mut side = DVec3::Z;
                    if entered < 2 {
                        side = DVec3::ZERO;
                        side[entered] = -d[entered].signum();
                    }
                    return hit(t_in, side);
                }
                if za > top && zb <= top {
                    return hit((top - o.z) / d.z, DVec3::Z);
                }
                if za < top - THICK && zb >= top - THICK {
                    return hit((top - THICK - o.z) / d.z, -DVec3::Z);
                }
            }
            if tx.min(ty) >= t1 {
                return None;
            }
            t_in = t_out;
            entered = axis;
            let moved = cell[axis].wrapping_add_signed(if d[axis] > 0.0 { 1 } else { -1 });
            if moved >= n[axis] {
                return None;
            }
            cell[axis] = moved;
        }
        None
    }
}
