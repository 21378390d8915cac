//! The walk of Amanatides and Woo (1987) in voxel units and f64. The distance to a plane is always
//! computed from the ray's start, never accumulated, so it does not drift; ties go to x, then y,
//! then z. An axis that the ray does not move along is handled by a branch.

use glam::DVec3;

use super::{BORDER, ColumnMasks};
use scene::Extent;

/// A slower component moves a ray by less than a rounding error over any distance that f64 can tell.
const STILL: f64 = 1e-30;

/// The part of a ray inside the grid, in units of its direction's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaySpan {
    /// Distance at which the ray enters; 0 if it starts inside.
    pub enter: f64,
    /// Distance at which the ray leaves.
    pub leave: f64,
}

/// The part of the ray inside the half-open box of the grid, in voxel units of that grid. `None` if there is
/// none (a start inside counts, a mere touch does not), or for NaN and a zero direction. A ray
/// parallel to a face is inside if its origin is at or above the lower plane and below the upper one.
pub fn grid_span(extent: Extent, origin: DVec3, direction: DVec3) -> Option<RaySpan> {
    let inverse = direction.to_array().map(inverse_of).into();
    span_of(extent.shape(), origin, direction, inverse)
}

/// 1 / a component of the direction, infinite for an axis at rest.
#[inline(always)]
pub(super) fn inverse_of(d: f64) -> f64 {
    if d.abs() < STILL { f64::INFINITY } else { 1.0 / d }
}

#[inline]
fn span_of(shape: [usize; 3], origin: DVec3, direction: DVec3, inverse: DVec3) -> Option<RaySpan> {
    if !origin.is_finite() || !direction.is_finite() {
        return None;
    }
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    let mut starts_inside = true;
    for axis in 0..3 {
        let (o, n) = (origin[axis], shape[axis] as f64);
        let within = o >= 0.0 && o < n;
        starts_inside &= within;
        if inverse[axis].is_infinite() {
            if !within {
                return None;
            }
            continue;
        }
        let (a, b) = ((0.0 - o) * inverse[axis], (n - o) * inverse[axis]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    // A start on a lower face is inside, even if the ray leaves at once. Infinity is left only if
    // no axis moved.
    ((enter < leave || starts_inside) && leave.is_finite()).then_some(RaySpan { enter, leave })
}

/// A ray that meets the grid.
pub(super) struct GridEntry {
    /// Voxels of the grid along each axis.
    pub shape: [usize; 3],
    pub origin: DVec3,
    pub direction: DVec3,
    /// 1 / direction; infinite for an axis at rest.
    pub inverse: DVec3,
    /// Distance at which the ray enters the grid.
    pub t_in: f64,
    /// End of the walk: voxels entered at this distance or later do not count.
    pub t_end: f64,
}

/// State of a walk: the voxel entered at `t_in`.
pub(super) struct WalkState {
    t_in: f64,
    axes: [AxisStepper; 3],
}

#[derive(Clone, Copy)]
struct AxisStepper {
    cell: usize,
    step: isize,
    /// Distance at which the ray leaves this cell along this axis.
    t_next: f64,
    plane: f64,
    plane_step: f64,
    origin: f64,
    inverse: f64,
}

impl GridEntry {
    /// Prepares a walk; `None` if the ray misses the grid or its range ends before.
    #[inline]
    pub fn new(shape: [usize; 3], origin: DVec3, direction: DVec3, max_t: f64) -> Option<GridEntry> {
        let inverse = DVec3::from_array(direction.to_array().map(inverse_of));
        let span = span_of(shape, origin, direction, inverse)?;
        if max_t.is_nan() || span.enter > max_t {
            return None;
        }
        Some(GridEntry {
            shape,
            origin,
            direction,
            inverse,
            t_in: span.enter,
            // A voxel entered exactly at the range still counts.
            t_end: span.leave.min(max_t.next_up()),
        })
    }

    /// The cell along an axis in which the ray starts.
    #[inline]
    pub fn first_cell(&self, axis: usize) -> usize {
        let (o, d, n) = (self.origin[axis], self.direction[axis], self.shape[axis]);
        if self.t_in > 0.0 && self.inverse[axis].is_finite() {
            // On the axis whose face is entered the cell is known.
            let (face, plane) = if d > 0.0 { (0, 0.0) } else { (n - 1, n as f64) };
            if (plane - o) * self.inverse[axis] >= self.t_in {
                return face;
            }
        }
        self.cell_at(axis, self.t_in)
    }

    /// The cell along an axis at `t`, to rounding; held inside the grid.
    #[inline]
    pub fn cell_at(&self, axis: usize, t: f64) -> usize {
        let at = self.origin[axis] + self.direction[axis] * t;
        (at.max(0.0).min((self.shape[axis] - 1) as f64) as i32) as usize
    }

    /// The walk at its beginning.
    #[inline]
    pub fn state(&self) -> WalkState {
        let axis = |a: usize| self.axis(a, self.first_cell(a));
        WalkState {
            t_in: self.t_in,
            axes: [axis(0), axis(1), axis(2)],
        }
    }

    /// The walk right after it entered cell `cell` along axis `main` (0 or 1) at `t`, as if it had
    /// come there step by step: the other axes have passed the planes before `t`, and those at `t`
    /// if they go first on a tie.
    #[inline]
    pub fn state_at(&self, main: usize, cell: usize, t: f64) -> WalkState {
        let axis = |a: usize| {
            if a == main {
                return self.axis(a, cell);
            }
            let axis = self.axis(a, self.cell_at(a, t));
            let passed = |t_plane: f64| if a < main { t_plane <= t } else { t_plane < t };
            // Rounding of the position may be a cell off, beside a plane. A plane at the start itself
            // was passed: the start's cell is the one above it.
            let t_back = (axis.plane - axis.plane_step - axis.origin) * axis.inverse;
            if axis.step == 0 {
                axis
            } else if passed(axis.t_next) {
                self.axis(a, axis.cell.wrapping_add_signed(axis.step))
            } else if !passed(t_back) && t_back > self.t_in {
                self.axis(a, axis.cell.wrapping_add_signed(-axis.step))
            } else {
                axis
            }
        };
        WalkState {
            t_in: t,
            axes: [axis(0), axis(1), axis(2)],
        }
    }

    #[inline(always)]
    fn axis(&self, a: usize, cell: usize) -> AxisStepper {
        let (origin, direction, inverse) = (self.origin[a], self.direction[a], self.inverse[a]);
        if inverse.is_infinite() {
            return AxisStepper {
                cell,
                step: 0,
                t_next: f64::INFINITY,
                plane: 0.0,
                plane_step: 0.0,
                origin: 0.0,
                inverse,
            };
        }
        let plane = (cell + usize::from(direction > 0.0)) as f64;
        AxisStepper {
            cell,
            step: if direction > 0.0 { 1 } else { -1 },
            t_next: (plane - origin) * inverse,
            plane,
            plane_step: direction.signum(),
            origin,
            inverse,
        }
    }
}

impl AxisStepper {
    /// Moves to the next cell.
    #[inline(always)]
    fn advance(&mut self) {
        self.cell = self.cell.wrapping_add_signed(self.step);
        self.plane += self.plane_step;
        self.t_next = (self.plane - self.origin) * self.inverse;
    }
}

/// Goes from voxel to voxel until one is occupied or would be entered at `t_end` or later. `visit`
/// sees each voxel looked at.
#[inline(always)]
pub(super) fn walk(
    masks: &ColumnMasks,
    state: WalkState,
    t_end: f64,
    mut visit: impl FnMut([usize; 3]),
) -> Option<(f64, [usize; 3])> {
    let stride = masks.stride;
    let WalkState {
        mut t_in,
        axes: [mut ax, mut ay, mut az],
    } = state;
    loop {
        let along_x = ax.t_next <= ay.t_next;
        let t_out = if along_x { ax.t_next } else { ay.t_next };
        let column = masks.columns[(ax.cell + BORDER) * stride + ay.cell + BORDER];
        loop {
            visit([ax.cell, ay.cell, az.cell]);
            if column >> az.cell & 1 == 1 {
                return Some((t_in, [ax.cell, ay.cell, az.cell]));
            }
            if az.t_next >= t_out {
                break;
            }
            t_in = az.t_next;
            if t_in >= t_end {
                return None;
            }
            az.advance();
        }
        if t_out >= t_end {
            return None;
        }
        t_in = t_out;
        if along_x {
            ax.advance();
        } else {
            ay.advance();
        }
    }
}
