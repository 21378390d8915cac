//! Rays with one origin and nearly one azimuth, as a spinning LiDAR fires them, cast together. The packet goes
//! along its main axis slab by slab as `scan` does for one ray: the columns that any of its rays may touch are
//! united once, and each ray compares them with the heights it passes. Where a ray may meet something it is
//! settled alone, with the sums of the walk, so it finds what a cast of its own finds, bit for bit.

use glam::DVec3;

use super::walk::{GridEntry, inverse_of, walk};
use super::wide::{Wide, WideKernel, heights, run};
use super::{BLOCK, BORDER, ColumnMasks};
use scene::{Extent, Lattice};

/// Rays in a packet.
pub const LANES: usize = 8;
/// Hit of a ray: the distance in units of its direction's length, and the voxel; `None` if it meets nothing.
pub type PacketHit = Option<(f64, [u16; 3])>;

/// Positions are integers in 1/2^22 voxel.
pub(super) const FRACTION: u32 = 22;
/// Margin by which the space that a ray may touch is widened, 2^-12 voxel. Each slab adds at most 2^-23 voxel of
/// rounding, [`MOST`] of them 2^-14.
pub(super) const MARGIN: i32 = 1 << (FRACTION - 12);
/// Slabs that a packet goes through together: 153 m. Rays that go on are then cast alone. Positions count from beside
/// the origin, so that they stay below 512 voxels.
const MOST: i32 = 384;
/// Rays that run this much faster across than along the packet's main axis are cast alone.
const ASKEW: f64 = 1.25;
const _: () = assert!(Extent::MAX_SIDE < 1 << 16 && Lattice::OCC3D.bins() == 16);
const _: () = assert!(MOST as f64 * ASKEW + 3.0 * (BLOCK as f64) < 512.0);

/// Rays from one origin. Fewer than [`LANES`] rays: repeat one.
#[derive(Clone, Copy, Debug)]
pub struct Packet {
    /// Common origin, voxel units.
    pub origin: DVec3,
    /// Direction of each ray.
    pub directions: [DVec3; LANES],
}

impl ColumnMasks {
    /// Casts packets 0 to `count` - 1 and hands over what the rays of each meet, in order. Any packet is allowed;
    /// one whose rays have nearly the same azimuth is fast. The result of a ray is that of
    /// [`Self::cast_in_voxels`].
    pub fn cast_packets(
        &self,
        count: usize,
        max_t: f64,
        packet: impl Fn(usize) -> Packet,
        met: impl FnMut(usize, &[PacketHit; LANES]),
    ) {
        struct Cast<'a, P, M>(&'a ColumnMasks, usize, f64, P, M);
        impl<P: Fn(usize) -> Packet, M: FnMut(usize, &[PacketHit; LANES])> WideKernel for Cast<'_, P, M> {
            #[inline(always)]
            fn with(self, wide: impl Wide) {
                let Cast(masks, count, max_t, packet, mut met) = self;
                for i in 0..count {
                    let packet = packet(i);
                    let mut found = [None; LANES];
                    let lanes = Lanes::new(masks.shape, &packet, max_t);
                    let going = lanes.cast(wide, masks, &mut found);
                    let mut left = !lanes.fits | going & lanes.long;
                    while left != 0 {
                        let lane = left.trailing_zeros() as usize;
                        left &= left - 1;
                        found[lane] = masks.cast_alone(packet.origin, packet.directions[lane], max_t);
                    }
                    met(i, &found);
                }
            }
        }
        run(Cast(self, count, max_t, packet, met));
    }

    #[inline(never)]
    fn cast_alone(&self, origin: DVec3, direction: DVec3, max_t: f64) -> PacketHit {
        let (t, voxel) = self.cast_in_voxels(origin, direction, max_t)?;
        Some((t, voxel.map(|v| v as u16)))
    }
}

/// A packet on its way. Axes in the order along the main one, across, up.
struct Lanes {
    /// Voxels along each axis.
    shape: [usize; 3],
    /// 0: the main axis is x, 1: y.
    main: usize,
    forward: bool,
    origin: [f64; 3],
    first_cell: usize,
    direction: [[f64; LANES]; 3],
    inverse: [[f64; LANES]; 3],
    t_end: [f64; LANES],
    /// Slabs that a ray has to look at.
    slabs: [i32; LANES],
    /// Column across from which positions count, border included: the first of a block.
    base: usize,
    /// Position across at the entry of the first slab, and growth per slab.
    across: [i32; LANES],
    across_step: [i32; LANES],
    /// Height at the entry of the first slab, and growth per slab.
    height: [i32; LANES],
    height_step: [i32; LANES],
    /// One bit per ray: part of the packet.
    fits: u8,
    /// One bit per ray: true if it has more slabs than are gone through here.
    long: u8,
}

/// A position as an integer in 1/2^[`FRACTION`] voxel, for |`v`| < 512; all callers hold that bound.
#[inline(always)]
fn fixed(v: f64) -> i32 {
    // The lowest bits of the sum are those of the rounded integer: one addition for all lanes at once.
    const MAGIC: f64 = (3u64 << (51 - FRACTION)) as f64;
    (v + MAGIC).to_bits() as i32
}

impl Lanes {
    /// No ray fits if they do not begin inside the grid.
    #[inline(always)]
    fn new(shape: [usize; 3], packet: &Packet, max_t: f64) -> Self {
        let lead = packet.directions[LANES / 2];
        let main = usize::from(lead.y.abs() > lead.x.abs());
        let axes = if main == 0 { [0, 1, 2] } else { [1, 0, 2] };
        let given = packet.origin.to_array();
        let origin = [given[axes[0]], given[axes[1]], given[2]];
        let shape = axes.map(|axis| shape[axis]);
        let n = shape.map(|n| n as f64);
        // Written so that NaN ends here too.
        let inside = (0..3).all(|axis| origin[axis] >= 0.0 && origin[axis] < n[axis]) && max_t >= 0.0;
        // Loops and not closures: they are sure to become code for wide registers.
        let (mut direction, mut inverse) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for (lane, given) in packet.directions.iter().enumerate() {
            let [x, y, z] = given.to_array();
            direction[0][lane] = if main == 0 { x } else { y };
            direction[1][lane] = if main == 0 { y } else { x };
            direction[2][lane] = z;
        }
        for axis in 0..3 {
            for lane in 0..LANES {
                inverse[axis][lane] = inverse_of(direction[axis][lane]);
            }
        }
        let forward = lead[main] > 0.0;
        let sign = if forward { 1.0 } else { -1.0 };
        let (first_cell, beside) = if inside {
            (origin[0] as usize, origin[1] as usize)
        } else {
            (0, 0)
        };
        let base = (beside + BORDER) / BLOCK * BLOCK;
        let from_base = BORDER as f64 - base as f64;
        let back = (first_cell + usize::from(!forward)) as f64 - origin[0];
        let mut lanes = Self {
            shape,
            main,
            forward,
            origin,
            first_cell,
            direction,
            inverse,
            t_end: [0.0; LANES],
            slabs: [0; LANES],
            base,
            across: [0; LANES],
            across_step: [0; LANES],
            height: [0; LANES],
            height_step: [0; LANES],
            fits: 0,
            long: 0,
        };
        let end = max_t.next_up();
        let to_border = (if forward {
            shape[0] - first_cell
        } else {
            first_cell + 1
        }) as i32;
        let (mut fits, mut long) = ([false; LANES], [false; LANES]);
        for lane in 0..LANES {
            let (along, across, up) = (direction[0][lane] * sign, direction[1][lane], direction[2][lane]);
            let inverse = [inverse[0][lane], inverse[1][lane], inverse[2][lane]];
            // Written so that NaN and infinity end here too.
            let fit = inside
                & (along > 1e-9)
                & (along < 1e9)
                & (across.abs() <= ASKEW * along)
                & (up.abs() <= along);
            // As in the span of a single ray: the plane ahead on each axis.
            let leave = |axis: usize| {
                (if inverse[axis] > 0.0 { n[axis] } else { 0.0 } - origin[axis]) * inverse[axis]
            };
            let less = |a: f64, b: f64| if a < b { a } else { b };
            let t_end = less(less(less(leave(0), leave(1)), leave(2)), end);
            // Rounded, and the slab of the start, but none past the grid.
            let slabs = ((along * t_end + (1u64 << 52) as f64).to_bits() as i32)
                .wrapping_add(2)
                .min(to_border);
            let per_slab = inverse[0] * sign;
            let (across, up) = (across * per_slab, up * per_slab);
            lanes.t_end[lane] = t_end;
            lanes.slabs[lane] = slabs.min(MOST);
            long[lane] = slabs > MOST;
            lanes.across[lane] = fixed(origin[1] + back * sign * across + from_base);
            lanes.across_step[lane] = fixed(across);
            lanes.height[lane] = fixed(origin[2] + back * sign * up);
            lanes.height_step[lane] = fixed(up);
            fits[lane] = fit;
        }
        for (lane, (fit, long)) in fits.into_iter().zip(long).enumerate() {
            lanes.fits |= u8::from(fit) << lane;
            lanes.long |= u8::from(long) << lane;
        }
        if lanes.fits != u8::MAX {
            lanes.leave_out();
        }
        lanes
    }

    /// Lets rays outside the packet follow one that is part of it.
    #[inline(always)]
    fn leave_out(&mut self) {
        let one = self.fits.trailing_zeros() as usize % LANES;
        for lane in (0..LANES).filter(|lane| self.fits >> lane & 1 == 0) {
            for values in [
                &mut self.across,
                &mut self.across_step,
                &mut self.height,
                &mut self.height_step,
            ] {
                values[lane] = values[one];
            }
        }
    }

    /// From slab to slab until every ray of the packet is settled, or at its end. One bit per ray that is not settled.
    #[inline(always)]
    fn cast(&self, wide: impl Wide, masks: &ColumnMasks, met: &mut [PacketHit; LANES]) -> u8 {
        let mut alive = self.fits;
        let mut end = self.end(alive);
        let (low, high) = wide.bounds(&self.across);
        let (mut low, mut high) = (low - MARGIN, high + MARGIN);
        let (low_step, high_step) = wide.bounds(&self.across_step);
        let (strides, block_strides, across): ([usize; 2], [usize; 2], usize) = match self.main {
            0 => ([masks.stride, 1], [masks.block_stride, 1], masks.stride),
            _ => ([1, masks.stride], [1, masks.block_stride], masks.rows),
        };
        let (base, across) = (self.base as i32, across as i32);
        let (base_block, across_blocks) = (base / BLOCK as i32, across / BLOCK as i32);
        let mut height = self.height;
        let mut slab = 0;
        while slab < end {
            let cell = self.cell(slab);
            let within = cell % BLOCK;
            let to_border = if self.forward { BLOCK - within } else { within + 1 };
            let in_block = (to_border as i32).min(end - slab);
            const SHIFT: u32 = FRACTION + BLOCK.trailing_zeros();
            let from = base_block + (low.min(low + in_block * low_step) >> SHIFT);
            let to = base_block + (high.max(high + in_block * high_step) >> SHIFT);
            let row = (cell + BORDER) / BLOCK * block_strides[0];
            let union = united(&masks.blocks, row, block_strides[1], from, to, across_blocks);
            if union == 0 || wide.touching(&height, &self.height_step, in_block, union << 1) & alive == 0 {
                slab += in_block;
                (low, high) = (low + in_block * low_step, high + in_block * high_step);
                wide.climb(&mut height, &self.height_step, in_block);
                continue;
            }
            for _ in 0..in_block {
                let from = base + (low.min(low + low_step) >> FRACTION);
                let to = base + (high.max(high + high_step) >> FRACTION);
                let row = (self.cell(slab) + BORDER) * strides[0];
                let union = united(&masks.columns, row, strides[1], from, to, across);
                let mut touching = wide.touching(&height, &self.height_step, 1, union << 1) & alive;
                if touching != 0 {
                    while touching != 0 {
                        let lane = touching.trailing_zeros() as usize;
                        touching &= touching - 1;
                        if self.settle(masks, lane, slab, strides, &mut met[lane]) {
                            alive &= !(1 << lane);
                        }
                    }
                    end = self.end(alive);
                }
                slab += 1;
                (low, high) = (low + low_step, high + high_step);
                wide.climb(&mut height, &self.height_step, 1);
                if slab >= end {
                    break;
                }
            }
        }
        alive
    }

    /// Slabs that the rays in `alive` have to look at.
    #[inline(always)]
    fn end(&self, alive: u8) -> i32 {
        let mut end = 0;
        for lane in 0..LANES {
            end = end.max(if u32::from(alive) >> lane & 1 == 1 {
                self.slabs[lane]
            } else {
                0
            });
        }
        end
    }

    /// Index along the main axis of a slab, counted from the first.
    #[inline(always)]
    fn cell(&self, slab: i32) -> usize {
        let slab = if self.forward {
            slab as isize
        } else {
            -(slab as isize)
        };
        self.first_cell.wrapping_add_signed(slab)
    }

    /// Looks closely at one ray in one slab. True if it meets something there or has ended before.
    #[inline(always)]
    fn settle(
        &self,
        masks: &ColumnMasks,
        lane: usize,
        slab: i32,
        strides: [usize; 2],
        met: &mut PacketHit,
    ) -> bool {
        let cell = self.cell(slab);
        let t = |axis: usize, plane: i32| (f64::from(plane) - self.origin[axis]) * self.inverse[axis][lane];
        let (t_in, t_out) = (
            t(0, cell as i32 + i32::from(!self.forward)),
            t(0, cell as i32 + i32::from(self.forward)),
        );
        let t_end = self.t_end[lane];
        if slab == 0 {
            *met = self.walked(masks, lane, None, t_out.next_up().min(t_end));
            return met.is_some();
        }
        if t_in >= t_end {
            return true;
        }
        // Entry and exit across, border included, and their cells, widened.
        let step = self.across_step[lane];
        let at = self.across[lane] + slab * step;
        let (low, high) = (
            self.base as i32 + ((at.min(at + step) - MARGIN) >> FRACTION),
            self.base as i32 + ((at.max(at + step) + MARGIN) >> FRACTION),
        );
        let rise = self.height_step[lane];
        let height = self.height[lane] + slab * rise;
        let (bottom, top) = (
            height.min(height + rise) - MARGIN,
            height.max(height + rise) + MARGIN,
        );
        let column = |across: i32| {
            let index = (cell + BORDER) * strides[0] + across as usize * strides[1];
            u32::from(masks.columns.get(index).copied().unwrap_or(0)) << 1
        };
        let (first, then) = if step < 0 { (high, low) } else { (low, high) };
        let (near, far) = (column(first), column(then));
        if high - low <= 1 && heights(bottom, top) & (near | far) == 0 {
            return false;
        }
        let (bottom, top) = (bottom >> FRACTION, top >> FRACTION);
        // The usual case: at most one plane across and one of height is crossed, beyond doubt within the slab and
        // one before the other.
        if high - low <= 1 && top - bottom <= 1 && bottom >= -1 && top <= 16 {
            let (mut t_across, mut t_up) = (f64::INFINITY, f64::INFINITY);
            let mut sure = true;
            if low != high {
                t_across = t(1, high - BORDER as i32);
                sure = t_across > t_in && t_across < t_out;
            }
            if bottom != top {
                t_up = t(2, top);
                sure &= t_up > t_in && t_up < t_out && t_up != t_across;
            }
            if sure {
                let (start, finish) = if rise < 0 { (top, bottom) } else { (bottom, top) };
                let side_first = t_across < t_up;
                let (t_1, t_2) = if side_first {
                    (t_across, t_up)
                } else {
                    (t_up, t_across)
                };
                // The second cell is beside the first or above or below it; the third is beside and above or below.
                let (across_1, up_1) = if side_first {
                    (then, start)
                } else {
                    (first, finish)
                };
                let occupied = |column: u32, height: i32| column >> (height + 1) & 1 == 1;
                let (t_hit, across, up) = if occupied(near, start) {
                    (t_in, first, start)
                } else if t_1 < t_end && occupied(if side_first { far } else { near }, up_1) {
                    (t_1, across_1, up_1)
                } else if t_2 < t_end && occupied(far, finish) {
                    (t_2, then, finish)
                } else {
                    return t_1 >= t_end;
                };
                let (along, across) = (cell as u16, (across - BORDER as i32) as u16);
                let [x, y] = if self.main == 0 {
                    [along, across]
                } else {
                    [across, along]
                };
                *met = Some((t_hit, [x, y, up as u16]));
                return true;
            }
        }
        // Up to and with the step into the next slab: on a tie another axis may go before it.
        *met = self.walked(masks, lane, Some((cell, t_in)), t_out.next_up().min(t_end));
        met.is_some()
    }

    /// The walk of one ray from its start, or from where it enters a cell along the main axis.
    #[inline(never)]
    fn walked(&self, masks: &ColumnMasks, lane: usize, from: Option<(usize, f64)>, t_end: f64) -> PacketHit {
        let places = [[0, 1, 2], [1, 0, 2]][self.main];
        let start = GridEntry {
            shape: places.map(|axis| self.shape[axis]),
            origin: places.map(|axis| self.origin[axis]).into(),
            direction: places.map(|axis| self.direction[axis][lane]).into(),
            inverse: places.map(|axis| self.inverse[axis][lane]).into(),
            t_in: 0.0,
            t_end: self.t_end[lane],
        };
        let state = match from {
            None => start.state(),
            Some((cell, t_in)) => start.state_at(self.main, cell, t_in),
        };
        let (t, voxel) = walk(masks, state, t_end, |_| ())?;
        Some((t, voxel.map(|v| v as u16)))
    }
}

/// The cells from `low` to `high` of a row, those inside the border united.
#[inline(always)]
fn united(cells: &[u16], row: usize, stride: usize, low: i32, high: i32, wide: i32) -> u32 {
    let (low, high) = (low.max(0), high.min(wide - 1));
    let at = |across: i32| cells.get(row + across as usize * stride).copied().unwrap_or(0);
    // Mostly one or two.
    let mut union = at(low) | at(high);
    for across in low + 1..high {
        union |= at(across);
    }
    u32::from(union)
}
