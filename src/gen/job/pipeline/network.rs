//! The network as solvers see it, and its condition.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::standing::SceneryVoxels;
use crate::contract::{ChosenDensities, GenError};
use diffusion::solver::{Branch, Denoiser};
use nets::{BlockReuse, ColumnHeights, DecoderInput, KeysValues, OccModels, Prepared, column_heights};
use nn::{Ops, Precision};
use scene::{BevLayout, BoxId, Density, Extent, Frame, SceneBox, VoxelGrid, draft, raster};

/// Keys and values by training step (the bits of the step).
pub type StepKeysValues<T> = BTreeMap<u64, KeysValues<T>>;

/// A part of the condition that is hidden, as in UniScene's table 8 and X-Scene's table 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ablation {
    /// No map layers: neither as channels nor in the draft.
    Layout,
    /// No boxes.
    Boxes,
    /// No background: the network invents it.
    Background,
    /// No draft: its latent is shown as zeros, as training shows one frame in four (mostly with the layout).
    Draft,
}

/// A layout as the networks read it.
pub struct Condition {
    /// Bits of the 18 layers.
    pub bev: Vec<u32>,
    /// Headings of objects.
    pub heading: Vec<u8>,
    /// Densities and completeness that the user chose.
    pub named: ChosenDensities,
    /// The layout extruded naively, with the background if it is given.
    pub draft: VoxelGrid,
    /// True if the background is given.
    pub given: bool,
    /// True if the networks do not get the draft.
    pub draft_hidden: bool,
    /// Heights of standing things and of the ground in each column of the draft.
    pub columns: Vec<ColumnHeights>,
}

impl Condition {
    /// Makes the condition from layout, boxes and the background's voxels, without the part that the ablation hides.
    pub fn new(
        layout: &BevLayout,
        boxes: &BTreeMap<BoxId, SceneBox>,
        standing: Option<&SceneryVoxels>,
        named: ChosenDensities,
        ablation: Option<Ablation>,
    ) -> Self {
        let (empty, none) = (BevLayout::default(), BTreeMap::new());
        let layout = if ablation == Some(Ablation::Layout) {
            &empty
        } else {
            layout
        };
        let boxes = if ablation == Some(Ablation::Boxes) {
            &none
        } else {
            boxes
        };
        let standing = standing.filter(|_| ablation != Some(Ablation::Background));
        let bare = draft::draft(layout, boxes.values());
        let mut draft = bare.clone();
        if let Some(standing) = standing {
            standing.stand_in(&mut draft);
        }
        Self {
            bev: raster::bev_channels(layout, boxes.values()),
            heading: raster::headings(Extent::WINDOW, boxes.values()),
            named,
            given: standing.is_some(),
            columns: column_heights(&bare, &draft),
            draft_hidden: ablation == Some(Ablation::Draft),
            draft,
        }
    }
}

impl Condition {
    /// The input of the decoder; empty if the draft is hidden.
    pub fn decoder_input(&self) -> DecoderInput<'_> {
        DecoderInput {
            draft: (!self.draft_hidden).then_some(&self.draft),
            observed: None,
        }
    }
}

/// The densities of a frame's source.
pub fn density_of_source(frame: &Frame) -> Density {
    Density::from_grid(&frame.source.occupancy, frame.source.layout.cells())
}

/// The network as a solver sees it, under one condition.
pub struct Network<B: Ops> {
    /// Its weights.
    pub models: Arc<OccModels<B>>,
    /// Its condition.
    pub condition: Prepared<B::Tensor>,
    /// The condition without layout and draft, for guidance.
    pub without: Option<Prepared<B::Tensor>>,
    /// Keys and values of the conditional branch. Each prediction renews those of the tokens that it computes and reads
    /// the others. `None` if all tokens are computed and the keys and values are not needed later.
    pub keys_values: Option<StepKeysValues<B::Tensor>>,
    /// Precision of the denoising network's products.
    pub precision: Precision,
    /// Interval, in predictions, at which the middle blocks are computed; 1 = every prediction.
    pub reuse_steps: u32,
    /// Number of predictions so far.
    pub predictions: u32,
    /// Output that the middle blocks added when they were last computed.
    pub added: Vec<f32>,
}

impl<B: Ops> Denoiser for Network<B> {
    type Error = GenError;

    fn predict(&mut self, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, GenError> {
        let x: Vec<f32> = x.iter().map(|v| *v as f32).collect();
        let (dit, step) = (&self.models.dit, t as f32);
        let mut fresh = KeysValues::default();
        let v = match (branch, &self.without) {
            (Branch::Unconditional, Some(without)) => dit.forward_in(
                &x,
                step,
                without,
                &mut fresh,
                self.precision,
                BlockReuse::Computed,
            ),
            _ => {
                let kept = match &mut self.keys_values {
                    Some(kept) => kept.entry(t.to_bits()).or_default(),
                    None => &mut fresh,
                };
                let middle = match self.reuse_steps {
                    0 | 1 => BlockReuse::Computed,
                    n if self.predictions.is_multiple_of(n) => BlockReuse::Kept(&mut self.added),
                    _ => BlockReuse::Reused(&self.added),
                };
                self.predictions += 1;
                dit.forward_in(&x, step, &self.condition, kept, self.precision, middle)
            }
        };
        Ok(v.map_err(GenError::failed)?.into_iter().map(f64::from).collect())
    }
}
