//! Condition of generating an occupancy, and its form for each token of the transformer.

use rayon::prelude::*;

use super::tokens::{PATCH_CELLS, patch};
use crate::column_heights::{ColumnHeights, GROUPS};
use crate::{CELLS, CHANNELS, LATENT, ModelError, SIDE, check_finite, check_length};
use scene::Window;
use scene::raster::HEADINGS;

const COLUMNS: usize = Window::NX / SIDE;
const LAYERS: usize = 18;
/// Layout channels of a cell: one per column and layer, `(dx * 4 + dy) * 18 + layer`.
const LAYOUT: usize = COLUMNS * COLUMNS * LAYERS;
/// Mean cosine and sine of headings in a cell.
const HEADING: usize = 2;
/// Columns of a cell.
const CELL_COLUMNS: usize = COLUMNS * COLUMNS;
/// Numbers of a group of the background in a cell: mask, base and top in each column.
const STANDING: usize = 3 * CELL_COLUMNS;
/// Numbers of a cell's condition: mask, context, draft, layout, heading; whether the groups of the background are
/// given, and what they are; whether the ground's height is given, and that in each column.
pub(super) const CONDITION: usize =
    1 + 2 * CHANNELS + LAYOUT + HEADING + GROUPS + GROUPS * STANDING + 1 + CELL_COLUMNS;
/// Numbers given by name.
pub(super) const NAMED: usize = 4;

/// Condition that a scene is generated from.
#[derive(Clone, Debug, PartialEq)]
pub struct DitCondition {
    /// Bits of the 18 layers, `[x][y]`, 200x200.
    pub bev: Vec<u32>,
    /// Headings of objects as [`headings`](scene::raster::headings) gives them, `[x][y]`, 200x200.
    pub heading: Vec<u8>,
    /// Vegetation, building, clutter, completeness where they are given (`Density`), 0 to 1.
    pub named: [Option<f32>; NAMED],
    /// Latent of the layout extruded naively, with the background where it is given, 50x50x8.
    pub draft_latent: Vec<f32>,
    /// Per group of the background: 1 where `columns` holds it and nothing else of it is to stand there, 0 where the network
    /// invents it, 50x50. Where both are 1 the draft holds them too.
    pub given: Vec<[f32; GROUPS]>,
    /// Background and ground of each column, 200x200.
    pub columns: Vec<ColumnHeights>,
    /// True if the ground's height is given.
    pub ground: bool,
    /// 1 where a cell is to be generated, 0 where it is kept, 50x50.
    pub mask: Vec<f32>,
    /// Latent of what is kept, 50x50x8; 0 where the mask is 1.
    pub context: Vec<f32>,
}

impl DitCondition {
    /// The condition for guidance, without everything that is asked for, as training shows it one time in fourteen.
    pub fn without_wishes(&self) -> Self {
        Self {
            bev: vec![0; self.bev.len()],
            heading: vec![0; self.heading.len()],
            named: [None; NAMED],
            draft_latent: vec![0.0; self.draft_latent.len()],
            given: vec![[0.0; GROUPS]; self.given.len()],
            ground: false,
            ..self.clone()
        }
    }

    /// Fails if an input has another length or is not finite.
    pub(super) fn check(&self) -> Result<(), ModelError> {
        check_length("layout", self.bev.len(), Window::COLUMNS)?;
        check_length("headings", self.heading.len(), Window::COLUMNS)?;
        check_finite("named numbers", &self.named.map(|n| n.unwrap_or(0.0)))?;
        check_length("draft latent", self.draft_latent.len(), LATENT)?;
        check_length("given background", self.given.len(), CELLS)?;
        check_finite("given background", self.given.as_flattened())?;
        check_length("columns", self.columns.len(), Window::COLUMNS)?;
        check_length("mask", self.mask.len(), CELLS)?;
        check_length("context", self.context.len(), LATENT)?;
        check_finite("draft latent", &self.draft_latent)?;
        check_finite("mask", &self.mask)?;
        check_finite("context", &self.context)
    }

    /// Features of some tokens, `[token][cell][number]`.
    pub(super) fn features(&self, tokens: &[usize]) -> Vec<f32> {
        let row = PATCH_CELLS * CONDITION;
        let mut features = vec![0.0; tokens.len() * row];
        features
            .par_chunks_mut(row)
            .zip(tokens)
            .for_each(|(values, token)| {
                for (cell, values) in patch(*token).zip(values.chunks_exact_mut(CONDITION)) {
                    self.cell_features(cell, values);
                }
            });
        features
    }

    /// The named numbers, whether each is given, and whether there is a draft.
    pub(super) fn named_numbers(&self) -> Vec<f32> {
        let told = self.named.map(|n| f32::from(u8::from(n.is_some())));
        let values = self.named.map(|n| n.unwrap_or(0.0));
        let drafted = f32::from(u8::from(self.draft_latent.iter().any(|v| *v != 0.0)));
        [&values[..], &told[..], &[drafted]].concat()
    }

    /// Features of one cell, in the order of [`CONDITION`].
    fn cell_features(&self, cell: usize, values: &mut [f32]) {
        values[0] = self.mask[cell];
        let of = |latent: &[f32], to: &mut [f32]| to.copy_from_slice(&latent[cell * CHANNELS..][..CHANNELS]);
        of(&self.context, &mut values[1..][..CHANNELS]);
        of(&self.draft_latent, &mut values[1 + CHANNELS..][..CHANNELS]);
        let (layout, rest) = values[1 + 2 * CHANNELS..].split_at_mut(LAYOUT);
        let (heading, rest) = rest.split_at_mut(HEADING);
        let (given, rest) = rest.split_at_mut(GROUPS);
        let (standing, ground) = rest.split_at_mut(GROUPS * STANDING);
        given.copy_from_slice(&self.given[cell]);
        ground[0] = f32::from(u8::from(self.ground));
        let bins = |n: u8| f32::from(n) / Window::NZ as f32;
        let [mut cos_sum, mut sin_sum] = [0.0; 2];
        for (column, layers) in layout.chunks_exact_mut(LAYERS).enumerate() {
            let x = cell / SIDE * COLUMNS + column / COLUMNS;
            let y = cell % SIDE * COLUMNS + column % COLUMNS;
            let bits = self.bev[x * Window::NY + y];
            for (layer, value) in layers.iter_mut().enumerate() {
                *value = (bits >> layer & 1) as f32;
            }
            let heights = &self.columns[x * Window::NY + y];
            for (group, [base, top]) in heights.standing.iter().enumerate() {
                if *top > 0 {
                    let known = given[group];
                    let told = [known, bins(base.saturating_sub(1)) * known, bins(*top) * known];
                    for (number, value) in told.into_iter().enumerate() {
                        standing[group * STANDING + number * CELL_COLUMNS + column] = value;
                    }
                }
            }
            ground[1 + column] = bins(heights.ground) * ground[0];
            let code = self.heading[x * Window::NY + y];
            if code > 0 {
                let angle = f32::from(code - 1) * (std::f32::consts::TAU / f32::from(HEADINGS));
                cos_sum += angle.cos();
                sin_sum += angle.sin();
            }
        }
        let columns = CELL_COLUMNS as f32;
        heading.copy_from_slice(&[cos_sum / columns, sin_sum / columns]);
    }
}
