//! Exact ray cast through the voxels, over one 16-bit mask per column.
//!
//! Two parts work together: `scan` finds, in whole steps along the ray's main axis, the next slab
//! of columns that may hold a hit, and `walk` goes through that slab voxel by voxel. The scan only
//! ever leaves out slabs that are provably empty, so the result is the walk's.

mod packet;
pub mod rays;
mod scan;
pub(crate) mod units;
mod walk;
mod wide;

use glam::DVec3;

pub use packet::{LANES, Packet, PacketHit};
use scan::{Scan, Slab};
use scene::grid::bricks_along;
use scene::{Class, Extent, Lattice, VoxelGrid};
use walk::{GridEntry, walk};
pub use walk::{RaySpan, grid_span};

/// Free columns around the grid, so that the scan needs no bounds of its own; one block wide, or up to two at the
/// upper sides.
const BORDER: usize = BLOCK;
/// Edge of a block of columns; divides the edge of a brick.
const BLOCK: usize = 8;

/// Occupancy as one bit per voxel: bit z of column (x, y) is set where the voxel is not free.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnMasks {
    extent: Extent,
    /// Voxels along x, y and z.
    shape: [usize; 3],
    /// Columns along x, border included: whole blocks.
    rows: usize,
    /// Columns from one x to the next: whole blocks.
    stride: usize,
    /// Blocks from one x to the next.
    block_stride: usize,
    /// `[x][y]` with a border of free columns.
    columns: Vec<u16>,
    /// Union over the columns of each block.
    blocks: Vec<u16>,
}

/// Where a ray meets the first occupied voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance from the origin in m (0 if the origin is inside the voxel).
    pub range_m: f64,
    /// Indices of the voxel, x, y, z.
    pub voxel: [usize; 3],
}

impl ColumnMasks {
    /// The masks of a grid.
    pub fn from_grid(grid: &VoxelGrid) -> Self {
        let extent = grid.extent();
        let [rows, stride] = [extent.nx(), extent.ny()].map(|n| n.next_multiple_of(BLOCK) + 2 * BORDER);
        let mut masks = Self {
            extent,
            shape: extent.shape(),
            rows,
            stride,
            block_stride: stride / BLOCK,
            columns: vec![0; rows * stride],
            blocks: vec![0; rows / BLOCK * (stride / BLOCK)],
        };
        for brick in 0..grid.bricks().len() {
            masks.update_brick(grid, brick);
        }
        masks
    }

    /// Part of the ground that they cover.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Updates the masks of the listed bricks (see [`VoxelGrid::changed_bricks`]) to `grid`; indices beyond the last
    /// brick are ignored. For a grid with another extent all masks are made anew.
    pub fn update(&mut self, grid: &VoxelGrid, changed_bricks: &[usize]) {
        if grid.extent() != self.extent {
            *self = Self::from_grid(grid);
            return;
        }
        let bricks: usize = bricks_along(self.extent).iter().product();
        for &brick in changed_bricks {
            if brick < bricks {
                self.update_brick(grid, brick);
            }
        }
    }

    fn update_brick(&mut self, grid: &VoxelGrid, brick: usize) {
        let ([x0, y0], [along_x, along_y]) = grid.brick_columns(brick);
        let (x1, y1) = (x0 + along_x, y0 + along_y);
        for x in x0..x1 {
            for y in y0..y1 {
                let at = self.at(x, y);
                self.columns[at] = column_mask(grid.window_column(x, y));
            }
        }
        for x in (x0..x1).step_by(BLOCK) {
            for y in (y0..y1).step_by(BLOCK) {
                self.update_block(x, y);
            }
        }
    }

    /// Unites the columns of the block that holds (x, y).
    fn update_block(&mut self, x: usize, y: usize) {
        let (bx, by) = ((x + BORDER) / BLOCK, (y + BORDER) / BLOCK);
        let mut union = 0;
        for row in 0..BLOCK {
            let from = (bx * BLOCK + row) * self.stride + by * BLOCK;
            union = self.columns[from..from + BLOCK].iter().fold(union, |u, m| u | m);
        }
        self.blocks[bx * self.block_stride + by] = union;
    }

    #[inline]
    fn at(&self, x: usize, y: usize) -> usize {
        (x + BORDER) * self.stride + y + BORDER
    }

    /// Bits of the occupied voxels above a cell, lowest voxel in bit 0. Panics outside the grid.
    #[inline]
    pub fn column(&self, x: usize, y: usize) -> u16 {
        assert!(x < self.shape[0] && y < self.shape[1], "column ({x}, {y})");
        self.columns[self.at(x, y)]
    }

    /// True where a voxel is occupied. Panics outside the grid.
    pub fn occupied(&self, x: usize, y: usize, z: usize) -> bool {
        assert!(z < Lattice::OCC3D.bins(), "height {z}");
        self.column(x, y) >> z & 1 == 1
    }

    /// Marks one voxel as occupied or free. Panics outside the grid.
    pub fn set(&mut self, x: usize, y: usize, z: usize, occupied: bool) {
        let [nx, ny, nz] = self.shape;
        assert!(x < nx && y < ny && z < nz, "voxel ({x}, {y}, {z})");
        let at = self.at(x, y);
        let column = &mut self.columns[at];
        *column = *column & !(1 << z) | (u16::from(occupied) << z);
        self.update_block(x, y);
    }

    /// Casts a ray given in the ego frame. `direction_in_ego` has unit length; the origin may lie
    /// anywhere. `None` if nothing is met within `max_range_m`, or if an input is NaN or the
    /// direction zero.
    pub fn cast(&self, origin_in_ego: DVec3, direction_in_ego: DVec3, max_range_m: f64) -> Option<RayHit> {
        let (t, voxel) = self.cast_in_voxels(
            self.extent.to_voxel_units(origin_in_ego),
            direction_in_ego,
            max_range_m / Lattice::OCC3D.voxel_m(),
        )?;
        Some(RayHit {
            range_m: t * Lattice::OCC3D.voxel_m(),
            voxel,
        })
    }

    /// Casts a ray given in voxel units: 0 is the grid's lower corner and a voxel has edge 1. Returns the distance in
    /// units of the direction's length, and the voxel.
    pub fn cast_in_voxels(&self, origin: DVec3, direction: DVec3, max_t: f64) -> Option<(f64, [usize; 3])> {
        let start = GridEntry::new(self.shape, origin, direction, max_t)?;
        let Some(mut scan) = Scan::new(self, &start) else {
            return walk(self, start.state(), start.t_end, |_| ());
        };
        while let Some(slab) = scan.next_slab(self) {
            if slab.t_in >= start.t_end {
                return None;
            }
            // Up to and with the step into the next slab: on a tie another axis may go before it.
            let t_end = slab.t_out.next_up().min(start.t_end);
            let state = match slab {
                Slab { first: true, .. } => start.state(),
                Slab { main, cell, t_in, .. } => start.state_at(main, cell, t_in),
            };
            let hit = walk(self, state, t_end, |_| ());
            if hit.is_some() {
                return hit;
            }
        }
        None
    }

    /// Casts a ray given in voxel units, voxel by voxel: `visit` sees every voxel on the way, in order, and the one
    /// that is met.
    pub fn walk_in_voxels(
        &self,
        origin: DVec3,
        direction: DVec3,
        max_t: f64,
        visit: impl FnMut([usize; 3]),
    ) -> Option<(f64, [usize; 3])> {
        let start = GridEntry::new(self.shape, origin, direction, max_t)?;
        walk(self, start.state(), start.t_end, visit)
    }
}

/// Bits of the voxels that are not free.
#[inline]
fn column_mask(column: &[u8; Lattice::OCC3D.bins()]) -> u16 {
    if *column == [Class::FREE; Lattice::OCC3D.bins()] {
        return 0;
    }
    let bits = column.iter().enumerate();
    bits.fold(0, |mask, (z, &v)| mask | u16::from(v != Class::FREE) << z)
}

#[cfg(test)]
mod tests;
