//! Exact ray cast through the voxels: an integer-stepped walk over one 16-bit mask per column.
//!
//! The walk is that of Amanatides and Woo (1987) in voxel units and f64. The distance to a plane is
//! always computed from the ray's start, never accumulated, so it does not drift; ties go to x, then
//! y, then z. An axis that the ray does not move along is handled by a branch, not by infinities.

use glam::DVec3;

use crate::scene::grid::{BRICK, BRICKS};
use crate::scene::{Class, GridSpec, VoxelGrid};

const N: [usize; 3] = [GridSpec::NX, GridSpec::NY, GridSpec::NZ];
/// A slower component moves a ray by less than a rounding error over any distance that f64 can tell.
const STILL: f64 = 1e-30;

/// Occupancy as one bit per voxel: bit z of column (x, y) is set where the voxel is not free.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnMasks {
    columns: Vec<u16>, // [x][y]
}

/// Where a ray meets the first occupied voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance from the origin in m (0 if the origin is inside the voxel).
    pub range_m: f64,
    /// Indices of the voxel, x, y, z.
    pub voxel: [usize; 3],
}

/// The part of a ray inside the grid, in units of its direction's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Where the ray enters; 0 if it starts inside.
    pub enter: f64,
    /// Where it leaves.
    pub leave: f64,
}

impl ColumnMasks {
    /// The masks of a grid.
    pub fn from_grid(grid: &VoxelGrid) -> Self {
        let mut masks = Self {
            columns: vec![0; GridSpec::COLUMNS],
        };
        for brick in 0..BRICKS * BRICKS {
            masks.update_brick(grid, brick);
        }
        masks
    }

    /// Brings the masks of the listed bricks (see [`VoxelGrid::changed_bricks`]) up to date with
    /// `grid`; indices beyond the last brick are ignored.
    pub fn update(&mut self, grid: &VoxelGrid, changed_bricks: &[usize]) {
        for &brick in changed_bricks {
            if brick < BRICKS * BRICKS {
                self.update_brick(grid, brick);
            }
        }
    }

    fn update_brick(&mut self, grid: &VoxelGrid, brick: usize) {
        let (x0, y0) = ((brick / BRICKS) * BRICK, (brick % BRICKS) * BRICK);
        for x in x0..(x0 + BRICK).min(GridSpec::NX) {
            for y in y0..(y0 + BRICK).min(GridSpec::NY) {
                self.columns[x * GridSpec::NY + y] = column_mask(grid.column(x, y));
            }
        }
    }

    /// Bits of the occupied voxels above a cell, lowest voxel in bit 0. Panics outside the grid.
    #[inline]
    pub fn column(&self, x: usize, y: usize) -> u16 {
        assert!(x < GridSpec::NX && y < GridSpec::NY, "column ({x}, {y})");
        self.columns[x * GridSpec::NY + y]
    }

    /// True where a voxel is occupied. Panics outside the grid.
    pub fn occupied(&self, x: usize, y: usize, z: usize) -> bool {
        assert!(z < GridSpec::NZ, "height {z}");
        self.column(x, y) >> z & 1 == 1
    }

    /// Marks one voxel as occupied or free. Panics outside the grid.
    pub fn set(&mut self, x: usize, y: usize, z: usize, occupied: bool) {
        assert!(
            x < GridSpec::NX && y < GridSpec::NY && z < GridSpec::NZ,
            "voxel ({x}, {y}, {z})"
        );
        let column = &mut self.columns[x * GridSpec::NY + y];
        *column = *column & !(1 << z) | (u16::from(occupied) << z);
    }

    /// Casts a ray given in the ego frame. `direction_in_ego` has unit length; the origin may lie
    /// anywhere. `None` if nothing is met within `max_range_m`, or if an input is NaN or the
    /// direction zero.
    pub fn cast(&self, origin_in_ego: DVec3, direction_in_ego: DVec3, max_range_m: f64) -> Option<RayHit> {
        let (t, voxel) = self.cast_in_voxels(
            GridSpec::to_voxel_units(origin_in_ego),
            direction_in_ego,
            max_range_m / GridSpec::VOXEL_M,
        )?;
        Some(RayHit {
            range_m: t * GridSpec::VOXEL_M,
            voxel,
        })
    }

    /// The same in voxel units: 0 is the grid's lower corner and a voxel has edge 1. Returns the
    /// distance in units of the direction's length, and the voxel.
    #[inline]
    pub fn cast_in_voxels(&self, origin: DVec3, direction: DVec3, max_t: f64) -> Option<(f64, [usize; 3])> {
        self.walk(origin, direction, max_t, |_| ())
    }

    /// Visits voxels along the ray until one is occupied; `visit` sees each voxel looked at.
    #[inline(always)]
    fn walk(
        &self,
        origin: DVec3,
        direction: DVec3,
        max_t: f64,
        mut visit: impl FnMut([usize; 3]),
    ) -> Option<(f64, [usize; 3])> {
        let span = grid_span(origin, direction)?;
        if max_t.is_nan() || span.enter > max_t {
            return None;
        }
        // A voxel entered exactly at the range still counts.
        let t_end = span.leave.min(max_t.next_up());
        let [mut ax, mut ay, mut az] =
            [0, 1, 2].map(|axis| Axis::new(origin[axis], direction[axis], span.enter, N[axis]));
        let mut at = ax.cell * GridSpec::NY + ay.cell;
        let (stride_x, stride_y) = (
            (GridSpec::NY as isize * ax.step) as usize,
            ay.step as usize, // two's complement: adding it wraps to the step
        );
        let mut t_in = span.enter;
        loop {
            let along_x = ax.t_next <= ay.t_next;
            let t_out = if along_x { ax.t_next } else { ay.t_next };
            let column = self.columns[at];
            loop {
                visit([at / GridSpec::NY, at % GridSpec::NY, az.cell]);
                if column >> az.cell & 1 == 1 {
                    return Some((t_in, [at / GridSpec::NY, at % GridSpec::NY, az.cell]));
                }
                if az.t_next >= t_out {
                    break;
                }
                t_in = az.t_next;
                if t_in >= t_end {
                    return None;
                }
                az.cell = az.cell.wrapping_add(az.step as usize);
                az.advance(true);
            }
            if t_out >= t_end {
                return None;
            }
            t_in = t_out;
            at = at.wrapping_add(if along_x { stride_x } else { stride_y });
            // Both axes are updated without a branch: which one steps is unpredictable.
            ax.advance(along_x);
            ay.advance(!along_x);
        }
    }
}

/// State of the walk along one axis.
struct Axis {
    cell: usize,
    step: isize,
    t_next: f64,
    plane: f64,
    plane_step: f64,
    origin: f64,
    inverse: f64,
}

impl Axis {
    fn new(origin: f64, direction: f64, t: f64, n: usize) -> Self {
        // Clamped: at the entry face, rounding may put the point just outside.
        let mut cell = ((origin + direction * t).max(0.0) as usize).min(n - 1);
        let still = Axis {
            cell,
            step: 0,
            t_next: f64::INFINITY,
            plane: 0.0,
            plane_step: 0.0,
            origin: 0.0,
            inverse: f64::INFINITY,
        };
        if direction.abs() < STILL {
            return still;
        }
        let inverse = 1.0 / direction;
        // A start outside: rounding of the entry point must not skip or repeat a cell.
        if t > 0.0 {
            let face = if direction > 0.0 { 0 } else { n - 1 };
            let entry = if direction > 0.0 { 0.0 } else { n as f64 };
            if (entry - origin) * inverse >= t {
                cell = face;
            }
        }
        let plane = (cell + usize::from(direction > 0.0)) as f64;
        Axis {
            cell,
            step: if direction > 0.0 { 1 } else { -1 },
            t_next: (plane - origin) * inverse,
            plane,
            plane_step: direction.signum(),
            origin,
            inverse,
        }
    }

    /// Moves to the next plane if `now`.
    #[inline(always)]
    fn advance(&mut self, now: bool) {
        self.plane += if now { self.plane_step } else { 0.0 };
        // For an axis at rest this is (0 - 0) * inf = NaN; the branch keeps infinity.
        let t = (self.plane - self.origin) * self.inverse;
        self.t_next = if now { t } else { self.t_next };
    }
}

/// The part of the ray inside the half-open box of the grid, in voxel units. `None` if there is
/// none (a start inside counts, a mere touch does not), or for NaN and a zero direction. A ray
/// parallel to a face is inside if its origin is at or above the lower plane and below the upper one.
pub fn grid_span(origin: DVec3, direction: DVec3) -> Option<Span> {
    let mut span = Span {
        enter: 0.0,
        leave: f64::INFINITY,
    };
    for axis in 0..3 {
        let (o, d, n) = (origin[axis], direction[axis], N[axis] as f64);
        if !o.is_finite() || !d.is_finite() {
            return None;
        }
        if d.abs() < STILL {
            if !(0.0..n).contains(&o) {
                return None;
            }
            continue;
        }
        let inverse = 1.0 / d;
        let (a, b) = ((0.0 - o) * inverse, (n - o) * inverse);
        span.enter = span.enter.max(a.min(b));
        span.leave = span.leave.min(a.max(b));
    }
    // A start on a lower face is inside, even if the ray leaves at once.
    let starts_inside = (0..3).all(|axis| (0.0..N[axis] as f64).contains(&origin[axis]));
    // Infinity is left only if no axis moved.
    ((span.enter < span.leave || starts_inside) && span.leave.is_finite()).then_some(span)
}

/// Bits of the voxels that are not free.
#[inline]
fn column_mask(column: &[u8; GridSpec::NZ]) -> u16 {
    if *column == [Class::FREE; GridSpec::NZ] {
        return 0;
    }
    let bits = column.iter().enumerate();
    bits.fold(0, |mask, (z, &v)| mask | u16::from(v != Class::FREE) << z)
}

#[cfg(test)]
mod tests;
