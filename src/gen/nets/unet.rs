//! The shape that small networks over maps share: three levels of residual blocks on the way down, two on the way up,
//! which take in the features of the way down.

use crate::ModelError;
use crate::encoder::{EncoderLevel, PIECE, levels, steps};
use nn::map::FeatureMap;
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Ops};

/// The levels with their weights, on a backend. Each halves the sides of the map of the one before; the first works on
/// squares of 2 x 2 places.
pub struct UNet<B: Ops = Cpu> {
    stem: B::Linear,
    enter: Vec<EncoderLevel<B>>, // finest first
    down: Vec<B::Linear>,
    leave: Vec<EncoderLevel<B>>, // coarsest first
    up: Vec<B::Linear>,
}

impl<B: Ops> UNet<B> {
    /// Takes `stem`, `enter`, `down`, `leave` and `up` of a file: `inputs` numbers a place, `widths` and the kernels of
    /// the blocks on the way down finest first.
    pub fn new(
        ops: &B,
        w: &mut WeightFile<'_>,
        inputs: usize,
        widths @ [fine, middle, coarse]: [usize; 3],
        kernels: &[Vec<usize>; 3],
    ) -> Result<Self, WeightsError> {
        Ok(Self {
            stem: ops.linear(w, "stem", [4 * inputs, fine], &[1, 1])?,
            enter: levels(ops, w, "enter", &widths, kernels)?,
            down: steps(ops, w, "down", vec![[4 * fine, middle], [4 * middle, coarse]])?,
            leave: levels(ops, w, "leave", &[middle, fine], &[vec![3], vec![3]])?,
            up: steps(ops, w, "up", vec![[coarse, 4 * middle], [middle, 4 * fine]])?,
        })
    }

    /// Features of the levels on the way down, the finest first: at a half, a quarter and an eighth of the map's sides,
    /// which are multiples of 8.
    pub fn seen(&self, ops: &B, map: FeatureMap) -> Result<[B::Tensor; 3], ModelError> {
        let squares = ops.fold(&ops.upload(map)?)?;
        let fine = self.enter[0].apply(ops, ops.apply(&self.stem, &squares, PIECE)?)?;
        let below = |i: usize, finer: &B::Tensor| {
            let map = ops.apply(&self.down[i], &ops.fold(finer)?, PIECE)?;
            self.enter[i + 1].apply(ops, map)
        };
        let middle = below(0, &fine)?;
        let coarse = below(1, &middle)?;
        Ok([fine, middle, coarse])
    }

    /// Goes down and up again: gives a map of half the sides, as wide as the finest level.
    pub fn apply(&self, ops: &B, map: FeatureMap) -> Result<B::Tensor, ModelError> {
        let [fine, middle, mut map] = self.seen(ops, map)?;
        for ((up, level), before) in self.up.iter().zip(&self.leave).zip([&middle, &fine]) {
            let wide = ops.unfold(&ops.apply(up, &map, PIECE)?)?;
            map = level.apply(ops, ops.add(wide, before)?)?;
        }
        Ok(map)
    }
}
