//! Rays with one origin and nearly one azimuth, as a spinning LiDAR fires them, cast together. The packet goes
//! along its main axis slab by slab as `scan` does for one ray: the columns that any of its rays may touch are
//! united once, and each ray compares them with the heights it passes. Where a ray may meet something it is
//! settled alone, so it finds what a cast of its own finds, bit for bit.

use std::array::from_fn;

use glam::DVec3;

use super::walk::{Start, inverse_of, walk};
use super::{BLOCK, BLOCK_STRIDE, BORDER, ColumnMasks, STRIDE};
use crate::scene::GridSpec;

/// Rays in a packet.
pub const LANES: usize = 8;
/// What a ray meets: the distance in units of its direction's length, and the voxel.
pub type Met = Option<(f64, [usize; 3])>;

/// Positions are integers in 1/2^22 voxel.
const FRACTION: u32 = 22;
/// Widens what a ray may touch, 2^-12 voxel. Each slab adds at most 2^-23 voxel of rounding, 200 of them 2^-15.
const MARGIN: i32 = 1 << (FRACTION - 12);
/// Rays that run this much faster across than along the packet's main axis are cast alone.
const ASKEW: f64 = 1.25;
/// Columns on one axis, border included.
const WIDE: usize = GridSpec::NX + 2 * BORDER;

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
        met: impl FnMut(usize, [Met; LANES]),
    ) {
        struct Cast<'a, P, M>(&'a ColumnMasks, usize, f64, P, M);
        impl<P: Fn(usize) -> Packet, M: FnMut(usize, [Met; LANES])> pulp::WithSimd for Cast<'_, P, M> {
            type Output = ();
            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) {
                let Cast(masks, count, max_t, packet, mut met) = self;
                for i in 0..count {
                    met(i, masks.cast_packet(&packet(i), max_t));
                }
            }
        }
        pulp::Arch::new().dispatch(Cast(self, count, max_t, packet, met));
    }

    #[inline(always)]
    fn cast_packet(&self, packet: &Packet, max_t: f64) -> [Met; LANES] {
        let mut met = [None; LANES];
        let mut lanes = Lanes::new(packet, max_t);
        lanes.cast(self, &mut met);
        for (lane, met) in met.iter_mut().enumerate() {
            if lanes.alone[lane] {
                *met = self.cast_in_voxels(packet.origin, packet.directions[lane], max_t);
            }
        }
        met
    }

    /// The columns from `low` to `high` across, united.
    #[inline(always)]
    fn united(cells: &[u16], along: usize, strides: [usize; 2], low: i32, high: i32, wide: usize) -> u32 {
        let (low, high) = (low.max(0) as usize, high.min(wide as i32 - 1));
        if high < low as i32 {
            return 0;
        }
        let high = high as usize;
        let at = |across: usize| cells.get(along * strides[0] + across * strides[1]).copied().unwrap_or(0);
        let mut union = at(low) | at(high);
        for across in low + 1..high {
            union |= at(across);
        }
        u32::from(union)
    }
}

/// A packet on its way.
struct Lanes {
    origin: DVec3,
    main: usize,
    forward: bool,
    first_cell: usize,
    direction: [[f64; LANES]; 3],
    inverse: [[f64; LANES]; 3],
    t_end: [f64; LANES],
    /// Rays that are not part of the packet.
    alone: [bool; LANES],
    /// Slabs that a ray has to look at, 0 once it is settled.
    slabs: [i32; LANES],
    /// Position across at the entry of the first slab, border included, and growth per slab.
    across: [i32; LANES],
    across_step: [i32; LANES],
    /// Height at the entry of the slab reached, and growth per slab.
    height: [i32; LANES],
    height_step: [i32; LANES],
}

/// A position as an integer in 1/2^[`FRACTION`] voxel, for |`v`| < 512; that bound is held by all callers.
#[inline(always)]
fn fixed(v: f64) -> i32 {
    // The lowest bits of the sum are those of the rounded integer: one addition for all lanes at once.
    const MAGIC: f64 = (3u64 << (51 - FRACTION)) as f64;
    (v + MAGIC).to_bits() as i32
}

impl Lanes {
    #[inline(always)]
    fn new(packet: &Packet, max_t: f64) -> Self {
        let (origin, n) = (packet.origin, [GridSpec::NX, GridSpec::NY, GridSpec::NZ].map(|n| n as f64));
        let direction: [[f64; LANES]; 3] = from_fn(|axis| from_fn(|lane| packet.directions[lane][axis]));
        let lead = packet.directions[LANES / 2];
        let main = usize::from(lead.y.abs() > lead.x.abs());
        let forward = lead[main] > 0.0;
        let other = 1 - main;
        let sign = if forward { 1.0 } else { -1.0 };
        // Only from inside do all rays begin in one slab.
        let inside = (0..3).all(|axis| origin[axis] >= 0.0 && origin[axis] < n[axis]) && max_t >= 0.0;
        let mut lanes = Self {
            origin,
            main,
            forward,
            first_cell: if inside { origin[main] as usize } else { 0 },
            direction,
            inverse: from_fn(|axis| from_fn(|lane| inverse_of(direction[axis][lane]))),
            t_end: [0.0; LANES],
            alone: [true; LANES],
            slabs: [0; LANES],
            across: [0; LANES],
            across_step: [0; LANES],
            height: [0; LANES],
            height_step: [0; LANES],
        };
        if !inside {
            return lanes;
        }
        let (d, inverse) = (&lanes.direction, &lanes.inverse);
        let plane = (lanes.first_cell + usize::from(!forward)) as f64;
        let back = plane - origin[main];
        let end = max_t.next_up();
        for lane in 0..LANES {
            let (along, across, up) = (d[main][lane] * sign, d[other][lane], d[2][lane]);
            // Written so that NaN and infinity end here too.
            let fits = along > 1e-9 && along < 1e9 && across.abs() <= ASKEW * along && up.abs() <= along;
            let mut leave = f64::INFINITY;
            for axis in 0..3 {
                let (a, b) = ((0.0 - origin[axis]) * inverse[axis][lane], (n[axis] - origin[axis]) * inverse[axis][lane]);
                leave = leave.min(a.max(b));
            }
            let t_end = leave.min(end);
            let last = (origin[main] + d[main][lane] * t_end).max(0.0).min(n[main] - 1.0) as i32;
            // One more: by rounding the last may be one short, and past the end is empty space.
            let slabs = (last - lanes.first_cell as i32).abs() + 2;
            let of = |d: f64| (back * (d * inverse[main][lane]), d * inverse[main][lane].abs());
            let (across, across_step) = of(if fits { across } else { 0.0 });
            let (height, height_step) = of(if fits { up } else { 0.0 });
            lanes.alone[lane] = !fits;
            lanes.t_end[lane] = t_end;
            lanes.slabs[lane] = if fits { slabs } else { 0 };
            lanes.across[lane] = fixed(origin[other] + across + BORDER as f64);
            lanes.across_step[lane] = fixed(across_step);
            lanes.height[lane] = fixed(origin[2] + height);
            lanes.height_step[lane] = fixed(height_step);
        }
        lanes
    }

    /// From slab to slab until every ray of the packet is settled.
    #[inline(always)]
    fn cast(&mut self, masks: &ColumnMasks, met: &mut [Met; LANES]) {
        let mut end = self.end();
        if end == 0 {
            return;
        }
        let bounds = |values: &[i32; LANES], alone: &[bool; LANES]| {
            let (mut low, mut high) = (i32::MAX, i32::MIN);
            for lane in 0..LANES {
                low = low.min(if alone[lane] { i32::MAX } else { values[lane] });
                high = high.max(if alone[lane] { i32::MIN } else { values[lane] });
            }
            (low, high)
        };
        let (low, high) = bounds(&self.across, &self.alone);
        let (low_step, high_step) = bounds(&self.across_step, &self.alone);
        let cells = |slab: i32, slabs: i32, shift: u32| {
            let (a, b) = (low + slab * low_step, high + slab * high_step);
            (
                (a.min(a + slabs * low_step) - MARGIN) >> shift,
                (b.max(b + slabs * high_step) + MARGIN) >> shift,
            )
        };
        let of_axes = |strides: [usize; 2]| [strides[self.main], strides[1 - self.main]];
        let (strides, block_strides) = (of_axes([STRIDE, 1]), of_axes([BLOCK_STRIDE, 1]));
        let mut slab = 0;
        while slab < end {
            let cell = self.cell(slab);
            let within = cell % BLOCK;
            let to_border = if self.forward { BLOCK - within } else { within + 1 };
            let in_block = (to_border as i32).min(end - slab);
            let (a, b) = cells(slab, in_block, FRACTION + BLOCK.trailing_zeros());
            let along = (cell + BORDER) / BLOCK;
            let union = ColumnMasks::united(&masks.blocks, along, block_strides, a, b, WIDE / BLOCK);
            if union == 0 || self.touching(union, slab, in_block).1 == 0 {
                slab += in_block;
                self.climb(in_block);
                continue;
            }
            for _ in 0..in_block {
                let (a, b) = cells(slab, 1, FRACTION);
                let along = self.cell(slab) + BORDER;
                let union = ColumnMasks::united(&masks.columns, along, strides, a, b, WIDE);
                let (touching, any) = self.touching(union, slab, 1);
                if any != 0 {
                    for lane in 0..LANES {
                        if touching[lane] != 0 {
                            self.settle(masks, lane, slab, strides, &mut met[lane]);
                        }
                    }
                    end = self.end();
                }
                slab += 1;
                self.climb(1);
                if slab >= end {
                    return;
                }
            }
        }
    }

    #[inline(always)]
    fn end(&self) -> i32 {
        self.slabs.iter().fold(0, |end, slabs| end.max(*slabs))
    }

    /// Index along the main axis of a slab, counted from the first; held inside the grid.
    #[inline(always)]
    fn cell(&self, slab: i32) -> usize {
        let n = [GridSpec::NX, GridSpec::NY][self.main];
        if self.forward {
            (self.first_cell + slab as usize).min(n - 1)
        } else {
            self.first_cell.saturating_sub(slab as usize)
        }
    }

    #[inline(always)]
    fn climb(&mut self, slabs: i32) {
        for lane in 0..LANES {
            self.height[lane] += slabs * self.height_step[lane];
        }
    }

    /// Per ray the occupied heights among those that it may pass in the next `slabs` slabs, and all of them united.
    #[inline(always)]
    fn touching(&self, union: u32, slab: i32, slabs: i32) -> ([u32; LANES], u32) {
        let mut touching = [0u32; LANES];
        let mut any = 0;
        for lane in 0..LANES {
            let entry = self.height[lane];
            let exit = entry + slabs * self.height_step[lane];
            // Below the grid and above it there is one free cell each: bits 0 and 17.
            let cell = |height: i32| ((height >> FRACTION).max(-1).min(16) + 1) as u32;
            let (low, high) = (cell(entry.min(exit) - MARGIN), cell(entry.max(exit) + MARGIN));
            let passed = (2u32 << high) - (1u32 << low);
            let alive = if slab < self.slabs[lane] { u32::MAX } else { 0 };
            touching[lane] = passed & (union << 1) & alive;
            any |= touching[lane];
        }
        (touching, any)
    }

    /// Looks closely at one ray in one slab; a ray that meets something there or ends before it is settled.
    #[inline(always)]
    fn settle(&mut self, masks: &ColumnMasks, lane: usize, slab: i32, strides: [usize; 2], met: &mut Met) {
        let (cell, main) = (self.cell(slab), self.main);
        let t = |plane: usize| (plane as f64 - self.origin[main]) * self.inverse[main][lane];
        let (t_in, t_out) = (
            t(cell + usize::from(!self.forward)),
            t(cell + usize::from(self.forward)),
        );
        let t_end = self.t_end[lane];
        if slab > 0 {
            if t_in >= t_end {
                self.slabs[lane] = 0;
                return;
            }
            let at = self.across[lane] + slab * self.across_step[lane];
            let to = at + self.across_step[lane];
            let (low, high) = ((at.min(to) - MARGIN) >> FRACTION, (at.max(to) + MARGIN) >> FRACTION);
            let union = ColumnMasks::united(&masks.columns, cell + BORDER, strides, low, high, WIDE);
            let (entry, exit) = (self.height[lane], self.height[lane] + self.height_step[lane]);
            let bottom = (entry.min(exit) - MARGIN) >> FRACTION;
            let top = (entry.max(exit) + MARGIN) >> FRACTION;
            let passed = (2u32 << (top.clamp(-1, 16) + 1)) - (1u32 << (bottom.clamp(-1, 16) + 1));
            if passed & (union << 1) == 0 {
                return;
            }
            // One column and at most two heights, the usual case: which comes first is beyond doubt.
            if low == high && bottom >= 0 && top < GridSpec::NZ as i32 {
                let voxel = |z: i32| {
                    let across = low as usize - BORDER;
                    let [x, y] = if main == 0 { [cell, across] } else { [across, cell] };
                    [x, y, z as usize]
                };
                if bottom == top {
                    *met = Some((t_in, voxel(bottom)));
                    self.slabs[lane] = 0;
                    return;
                }
                let t_z = (f64::from(top) - self.origin.z) * self.inverse[2][lane];
                if top == bottom + 1 && t_z > t_in && t_z < t_out {
                    let (first, then) = if exit < entry { (top, bottom) } else { (bottom, top) };
                    if union >> first & 1 == 1 {
                        *met = Some((t_in, voxel(first)));
                    } else if t_z < t_end {
                        *met = Some((t_z, voxel(then)));
                    }
                    self.slabs[lane] = 0;
                    return;
                }
            }
        }
        let start = Start {
            origin: self.origin,
            direction: from_fn(|axis| self.direction[axis][lane]).into(),
            inverse: from_fn(|axis| self.inverse[axis][lane]).into(),
            t_in: 0.0,
            t_end,
        };
        let state = if slab == 0 { start.state() } else { start.state_at(main, cell, t_in) };
        // Up to and with the step into the next slab: on a tie another axis may go before it.
        *met = walk(masks, state, t_out.next_up().min(t_end), |_| ());
        if met.is_some() {
            self.slabs[lane] = 0;
        }
    }
}
