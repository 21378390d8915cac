//! The bird's-eye-view layout: map layers on the columns of a map, and the polylines behind them.

use std::sync::Arc;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BevLayer, Extent, Relief};

/// Kind of a polyline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
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
    /// A speed limit along the middle of a lane, in driving direction. Not drawn into a layer.
    SpeedLimit {
        /// The limit, mm/s: whole numbers of km/h and mph come back as they were.
        mm_per_s: u32,
    },
}

impl PolylineKind {
    /// Number of a kind of line for drawing (`shaders/appearance/paint.wgsl`); 0 for kinds that are not drawn.
    pub fn drawn_as(self) -> u32 {
        match self {
            Self::LaneCenter | Self::SpeedLimit { .. } => 0,
            Self::RoadDivider => 1,
            Self::LaneDivider => 2,
            Self::StopLine => 3,
            Self::PedCrossing => 4,
        }
    }
}

/// A line on the ground, world frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Polyline {
    /// Kind of the line.
    pub kind: PolylineKind,
    /// Vertices, m; a closed outline does not repeat its first vertex.
    #[schemars(with = "Vec<[f64; 2]>")]
    pub points_m: Vec<DVec2>,
}

/// Map layers as one bit per [`BevLayer`] and cell (layers 0 to 7; boxes bring the others), and polylines.
#[derive(Clone, Debug, PartialEq)]
pub struct BevLayout {
    extent: Extent,
    cells: Arc<Vec<u32>>, // [x][y]
    /// Lane centres, dividers, stop lines and crossings.
    pub polylines: Arc<Vec<Polyline>>,
    /// Height of the ground under it.
    pub relief: Relief,
}

impl Default for BevLayout {
    /// An empty window.
    fn default() -> Self {
        Self::over(Extent::WINDOW)
    }
}

impl BevLayout {
    const MAP_BITS: u32 = 0xff;

    /// An empty map on flat ground.
    pub fn over(extent: Extent) -> Self {
        Self {
            extent,
            cells: Arc::new(vec![0; extent.columns()]),
            polylines: Arc::default(),
            relief: Relief::FLAT,
        }
    }

    /// A window from cells `[x][y]` on flat ground; bits of object layers are dropped. Errors with the length found if it is
    /// not 40,000.
    pub fn from_cells(cells: Vec<u32>, polylines: Vec<Polyline>) -> Result<Self, usize> {
        Self::from_cells_over(Extent::WINDOW, cells, polylines)
    }

    /// A layout from cells `[x][y]` of a map on flat ground; bits of object layers are dropped. Errors with the length
    /// found if it is another one.
    pub fn from_cells_over(
        extent: Extent,
        mut cells: Vec<u32>,
        polylines: Vec<Polyline>,
    ) -> Result<Self, usize> {
        if cells.len() != extent.columns() {
            return Err(cells.len());
        }
        cells.iter_mut().for_each(|c| *c &= Self::MAP_BITS);
        Ok(Self {
            extent,
            cells: Arc::new(cells),
            polylines: Arc::new(polylines),
            relief: Relief::FLAT,
        })
    }

    /// Which part of the ground it covers.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// The part of it that lies in another extent, with all polylines. Where this one has no columns, no layer is set
    /// and the ground continues level.
    pub fn crop(&self, extent: Extent) -> Self {
        if extent == self.extent {
            return self.clone();
        }
        Self {
            extent,
            cells: Arc::new(extent.crop(&self.extent, &self.cells, 0)),
            polylines: self.polylines.clone(),
            relief: self.relief.crop(extent),
        }
    }

    /// The part of it that lies in another extent; beyond its border layers and ground continue as they are at the
    /// border.
    pub fn crop_continued(&self, extent: Extent) -> Self {
        let mut out = self.crop(extent);
        if extent == self.extent {
            return out;
        }
        let (own, other) = (self.extent.from(), extent.from());
        let last = [self.extent.nx(), self.extent.ny()].map(|n| n as i32 - 1);
        let nearest = |axis: usize, at: usize| (at as i32 + other[axis] - own[axis]).clamp(0, last[axis]);
        let cells = extent
            .all_columns()
            .map(|[x, y]| self.cell(nearest(0, x) as usize, nearest(1, y) as usize));
        out.cells = Arc::new(cells.collect());
        out
    }

    /// These cells and heights over another extent of the same size; polylines stay where they are.
    pub(crate) fn relabelled(&self, extent: Extent) -> Self {
        assert_eq!(extent.columns(), self.extent.columns(), "another size");
        Self {
            extent,
            relief: self.relief.relabelled(extent),
            ..self.clone()
        }
    }

    /// Takes over cells and heights of another layout wherever both have columns, and its polylines.
    pub fn paste(&mut self, other: &Self) {
        if other.extent == self.extent {
            self.clone_from(other);
            return;
        }
        self.extent.paste(
            Arc::make_mut(&mut self.cells).as_mut_slice(),
            &other.extent,
            &other.cells,
        );
        self.polylines = other.polylines.clone();
        self.relief.paste(self.extent, &other.relief, other.extent);
    }

    /// Sets the height of the ground in one column, m; the caller keeps it finite and within the limit.
    pub fn set_height(&mut self, x: usize, y: usize, height_m: f32) {
        self.relief.set(self.extent, x, y, height_m);
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
        self.cells[self.extent.index(x, y)]
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
            Arc::make_mut(&mut self.cells)[self.extent.index(x, y)] = new;
        }
    }

    /// Number of cells in which `layer` is set.
    pub fn count(&self, layer: BevLayer) -> usize {
        self.cells.iter().filter(|c| **c & layer.bit() != 0).count()
    }
}
