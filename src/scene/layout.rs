//! The bird's-eye-view layout: map layers on the grid's columns, and the polylines behind them.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{BevLayer, GridSpec, Relief};

/// What a polyline means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PolylineKind {
    /// Middle of a lane, in driving direction. Not drawn into a layer.
    LaneCenter,
    /// Line between opposite directions; layer `road_divider`.
    RoadDivider,
    /// Line between lanes of one direction; layer `lane_divider`.
    LaneDivider,
    /// Where to halt; layer `stop_line`.
    StopLine,
    /// Closed outline of a crossing; layer `ped_crossing`.
    PedCrossing,
}

/// A line on the ground, ego frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polyline {
    /// What it means.
    pub kind: PolylineKind,
    /// Vertices, m; a closed outline does not repeat its first vertex.
    pub points_m: Vec<DVec2>,
}

/// Map layers as one bit per [`BevLayer`] and cell (layers 0 to 7; boxes bring the others), and polylines.
#[derive(Clone, Debug, PartialEq)]
pub struct BevLayout {
    cells: Arc<Vec<u32>>, // [x][y], GridSpec::COLUMNS
    /// Lane centres, dividers, stop lines and crossings.
    pub polylines: Arc<Vec<Polyline>>,
    /// Height of the ground under it.
    pub relief: Relief,
}

impl Default for BevLayout {
    fn default() -> Self {
        Self {
            cells: Arc::new(vec![0; GridSpec::COLUMNS]),
            polylines: Arc::default(),
            relief: Relief::FLAT,
        }
    }
}

impl BevLayout {
    const MAP_BITS: u32 = 0xff;

    /// From cells `[x][y]` on flat ground; bits of object layers are dropped. Errors with the length found if it is not 40,000.
    pub fn from_cells(mut cells: Vec<u32>, polylines: Vec<Polyline>) -> Result<Self, usize> {
        if cells.len() != GridSpec::COLUMNS {
            return Err(cells.len());
        }
        cells.iter_mut().for_each(|c| *c &= Self::MAP_BITS);
        Ok(Self {
            cells: Arc::new(cells),
            polylines: Arc::new(polylines),
            relief: Relief::FLAT,
        })
    }

    /// True if both hold their cells in the same memory.
    pub fn shares_cells(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.cells, &other.cells)
    }

    /// Bits of every cell, `[x][y]`.
    #[inline]
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// Bits of one cell. Panics outside the grid.
    pub fn cell(&self, x: usize, y: usize) -> u32 {
        self.cells[x * GridSpec::NY + y]
    }

    /// True if `layer` is set in the cell.
    pub fn has(&self, layer: BevLayer, x: usize, y: usize) -> bool {
        self.cell(x, y) & layer.bit() != 0
    }

    /// Sets or clears a map layer in one cell; ignores object layers, which come from boxes.
    pub fn set(&mut self, layer: BevLayer, x: usize, y: usize, value: bool) {
        let bit = layer.bit() & Self::MAP_BITS;
        let old = self.cell(x, y);
        let new = if value { old | bit } else { old & !bit };
        if new != old {
            Arc::make_mut(&mut self.cells)[x * GridSpec::NY + y] = new;
        }
    }

    /// Number of cells in which `layer` is set.
    pub fn count(&self, layer: BevLayer) -> usize {
        self.cells.iter().filter(|c| **c & layer.bit() != 0).count()
    }
}
