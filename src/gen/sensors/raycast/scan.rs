//! The quick look ahead: goes along the ray's main axis in whole slabs of columns, first by blocks
//! of eight, and stops where the columns that the ray may touch are not free at its height.
//!
//! Positions are integers in 1/2^32 voxel that only grow by a constant, so a slab costs a few
//! integer operations. A margin far above the rounding error widens every range looked at.

use super::walk::GridEntry;
use super::{BLOCK, BORDER, ColumnMasks};
use scene::Extent;

const FRACTION: u32 = 32;
const BLOCK_SHIFT: u32 = BLOCK.trailing_zeros();
/// Added on both sides of a range: 1e-5 voxel. Steps are off by 1/2^32 each, up to a map's longest side of them.
const MARGIN: i64 = 1 << (FRACTION - 17);
const _: () = assert!(2 * Extent::MAX_SIDE as i64 <= MARGIN);
/// Distance beyond which a start is too coarse for the margin, voxels.
const FAR: f64 = 1e7;
/// Steeper rays see few columns and many heights; the walk alone is right for them.
const STEEP: f64 = 1.0;
/// Heights from this far below the grid have a bit of their own: a ray at most this steep, seen for
/// a block of slabs before its start or beyond its end, stays within 64 bits.
const BELOW: i64 = 16;

/// A slab that may hold a hit.
pub(super) struct Slab {
    /// The main axis: 0 is x, 1 is y.
    pub main: usize,
    /// Index of the slab along it.
    pub cell: usize,
    /// True for the slab in which the ray starts.
    pub first: bool,
    /// Distances at which the ray enters the slab and leaves it.
    pub t_in: f64,
    pub t_out: f64,
}

/// State of the scan before the slab `cell`.
pub(super) struct Scan {
    main: usize,
    cell: usize,
    forward: bool,
    first: bool,
    slabs_left: usize,
    /// Strides of columns and of blocks along the main axis and across it.
    strides: [usize; 2],
    block_strides: [usize; 2],
    /// Position across at the slab's entry, widened, border included; and its growth per slab.
    across: SlabCoordinate,
    /// Height at the slab's entry, widened, without border; and its growth per slab.
    height: SlabCoordinate,
    origin: f64,
    inverse: f64,
}

/// A coordinate that grows from slab to slab.
#[derive(Clone, Copy)]
struct SlabCoordinate {
    entry: i64,
    per_slab: i64,
    /// Distance from the widened entry to the widened exit of one slab.
    width: i64,
}

impl SlabCoordinate {
    fn new(entry: f64, per_slab: f64) -> SlabCoordinate {
        const ONE: f64 = (1u64 << FRACTION) as f64;
        let per_slab = (per_slab * ONE) as i64;
        let outward = if per_slab < 0 { -MARGIN } else { MARGIN };
        SlabCoordinate {
            entry: (entry * ONE) as i64 - outward,
            per_slab,
            width: per_slab + 2 * outward,
        }
    }

    /// Cells at the entry of this slab and the exit of the one `slabs - 1` later; low and high end.
    #[inline(always)]
    fn cells(&self, slabs: usize, shift: u32) -> (i64, i64) {
        let exit = self.entry + self.width + (slabs as i64 - 1) * self.per_slab;
        (self.entry.min(exit) >> shift, self.entry.max(exit) >> shift)
    }

    #[inline(always)]
    fn skip(&mut self, slabs: usize) {
        self.entry += slabs as i64 * self.per_slab;
    }
}

impl Scan {
    /// Starts a scan; `None` for rays that are better walked: steep ones and those from very far.
    #[inline]
    pub fn new(masks: &ColumnMasks, start: &GridEntry) -> Option<Scan> {
        let (o, d) = (start.origin, start.direction);
        let main = usize::from(d.y.abs() > d.x.abs());
        let (om, dm) = (o[main], d[main]);
        // Written so that a main component of 0 ends here too.
        let walkable = d.z.abs() <= STEEP * dm.abs() && dm.abs() > 1e-9 && o.abs().max_element() < FAR;
        if !walkable {
            return None;
        }
        let n = start.shape[main];
        let forward = dm > 0.0;
        let inverse = start.inverse[main];
        let per_slab = inverse.abs();
        let cell = start.first_cell(main);
        let last = start.cell_at(main, start.t_end);
        // One more: by rounding the last may be one short, and past the end is empty space.
        let last = if forward {
            (last + 1).min(n - 1)
        } else {
            last.saturating_sub(1)
        };
        let plane = (cell + usize::from(!forward)) as f64;
        let other = 1 - main;
        let entry = |axis: usize| o[axis] + (plane - om) * (d[axis] * inverse);
        let strides = [masks.stride, 1];
        let block_strides = [masks.block_stride, 1];
        Some(Scan {
            main,
            cell,
            forward,
            first: true,
            slabs_left: cell.abs_diff(last) + 1,
            strides: [strides[main], strides[other]],
            block_strides: [block_strides[main], block_strides[other]],
            across: SlabCoordinate::new(entry(other) + BORDER as f64, d[other] * per_slab),
            height: SlabCoordinate::new(entry(2), d.z * per_slab),
            origin: om,
            inverse,
        })
    }

    /// The next slab that may hold a hit.
    #[inline]
    pub fn next_slab(&mut self, masks: &ColumnMasks) -> Option<Slab> {
        while self.slabs_left > 0 {
            let within = self.cell % BLOCK;
            let to_border = if self.forward { BLOCK - within } else { within + 1 };
            let in_block = to_border.min(self.slabs_left);
            if self.is_free(
                in_block,
                &masks.blocks,
                (self.cell + BORDER) / BLOCK,
                self.block_strides,
                BLOCK_SHIFT,
            ) {
                self.skip(in_block);
                continue;
            }
            for _ in 0..in_block {
                let free = self.is_free(1, &masks.columns, self.cell + BORDER, self.strides, 0);
                let slab = (!free).then(|| self.slab());
                self.skip(1);
                if slab.is_some() {
                    return slab;
                }
            }
        }
        None
    }

    /// True if the ray surely meets nothing in the next `slabs` slabs, seen in cells of 2^`shift` columns.
    #[inline(always)]
    fn is_free(&self, slabs: usize, cells: &[u16], along: usize, strides: [usize; 2], shift: u32) -> bool {
        let (low, high) = self.across.cells(slabs, FRACTION + shift);
        let at = |across: i64| {
            let index = along * strides[0] + across as usize * strides[1];
            // Beyond the border there is nothing.
            cells.get(index).copied().unwrap_or(0)
        };
        // Main means that the ray moves across at most as far as along: two cells, a third only by
        // the margin.
        let mut union = at(low) | at(high);
        if high - low > 1 {
            union |= at(low + 1);
        }
        let (low, high) = self.height.cells(slabs, FRACTION);
        let up_to = |height: i64| 1u64.wrapping_shl((height + BELOW) as u32);
        let bits = up_to(high + 1).wrapping_sub(up_to(low)) >> BELOW;
        u64::from(union) & bits == 0
    }

    #[inline(always)]
    fn skip(&mut self, slabs: usize) {
        self.across.skip(slabs);
        self.height.skip(slabs);
        let step = if self.forward {
            slabs as isize
        } else {
            -(slabs as isize)
        };
        self.cell = self.cell.wrapping_add_signed(step);
        self.slabs_left -= slabs;
        self.first = false;
    }

    fn slab(&self) -> Slab {
        let entry = self.cell + usize::from(!self.forward);
        let exit = self.cell + usize::from(self.forward);
        let t = |plane: usize| (plane as f64 - self.origin) * self.inverse;
        Slab {
            main: self.main,
            cell: self.cell,
            first: self.first,
            t_in: if self.first { f64::NEG_INFINITY } else { t(entry) },
            t_out: t(exit),
        }
    }
}
