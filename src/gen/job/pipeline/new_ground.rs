//! Ground that is new to a map. It has no source to invert: it is drawn from noise to suit the map around it.

use crate::contract::{ChosenDensities, GenParams};
use crate::region::{COLUMNS_PER_CELL, Region};
use scene::{Class, Density, Extent, Frame, Window};

/// Columns of a frame that its source knows, and those that are new.
pub(super) struct NewGround<'a> {
    frame: &'a Frame,
    /// `[x][y]`: columns of the map that are not new to it; all columns of the window if none is new.
    known: Vec<bool>,
    is_new: Vec<bool>,
}

impl<'a> NewGround<'a> {
    /// The known and new columns of a frame of the window.
    pub(super) fn from_frame(frame: &'a Frame) -> Self {
        let columns = || Extent::WINDOW.all_columns();
        let is_new: Vec<bool> = columns().map(|[x, y]| frame.is_new_ground(x, y)).collect();
        if !is_new.contains(&true) {
            let known = vec![true; is_new.len()];
            return Self { frame, known, is_new };
        }
        // Columns of the window beyond the map are free, and the map is a rectangle.
        let shown = |[x, y]: &[usize; 2]| frame.occupancy.column(*x, *y).iter().any(|l| *l != Class::FREE);
        let map = columns()
            .filter(shown)
            .fold(None, |map: Option<[usize; 4]>, [x, y]| {
                let [x0, x1, y0, y1] = map.unwrap_or([x, x, y, y]);
                Some([x0.min(x), x1.max(x), y0.min(y), y1.max(y)])
            });
        let on_map = |[x, y]: [usize; 2]| {
            map.is_some_and(|[x0, x1, y0, y1]| (x0..=x1).contains(&x) && (y0..=y1).contains(&y))
        };
        let known = columns().zip(&is_new).map(|(c, new)| on_map(c) && !new);
        Self {
            frame,
            known: known.collect(),
            is_new,
        }
    }

    /// True if at least an eighth of a region is new: a region around new ground also holds its surroundings.
    pub(super) fn is_in(&self, region: &Region) -> bool {
        let held = self.is_new.iter().zip(&region.columns).filter(|(_, held)| **held);
        let new = held.filter(|(new, _)| **new).count();
        new > 0 && 8 * new >= region.column_count()
    }

    /// Parameters with which a region that holds new ground is drawn.
    pub(super) fn params(params: &GenParams) -> GenParams {
        GenParams {
            strength: 1.0,
            guidance: params.guidance.max(GenParams::whole_scene().guidance),
            ..params.clone()
        }
    }

    /// Cells of a region, and cells without any known column. The latter are drawn without context, and their result is
    /// discarded.
    pub(super) fn drawn_with(&self, region: &Region) -> Vec<bool> {
        let side = Window::NX / COLUMNS_PER_CELL;
        let cell = |cell: usize| {
            let (x, y) = (cell / side * COLUMNS_PER_CELL, cell % side * COLUMNS_PER_CELL);
            let mut columns = (0..COLUMNS_PER_CELL * COLUMNS_PER_CELL)
                .map(|i| (x + i / COLUMNS_PER_CELL) * Window::NY + y + i % COLUMNS_PER_CELL);
            !columns.any(|c| self.known[c])
        };
        let unknown = (0..side * side).map(cell);
        region
            .latent_cells
            .iter()
            .zip(unknown)
            .map(|(held, u)| *held || u)
            .collect()
    }

    /// Densities that an edit keeps unless the user chooses others: those of the known columns. New ground is generated
    /// like the rest, and completely if there is no rest.
    pub(super) fn density(&self) -> ChosenDensities {
        if !self.known.contains(&true) {
            return ChosenDensities {
                completeness: Some(1.0),
                ..ChosenDensities::default()
            };
        }
        let source = &self.frame.source;
        let known = |x: usize, y: usize| self.known[x * Window::NY + y];
        ChosenDensities::default().or(&Density::of_columns(
            &source.occupancy,
            source.layout.cells(),
            known,
        ))
    }
}
