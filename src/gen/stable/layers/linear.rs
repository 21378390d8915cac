//! A linear layer.

use candle_core::{Result, Tensor};

use crate::StableError;
use crate::weights::Names;

/// y = x W^T + b.
#[derive(Clone, Debug)]
pub(crate) struct TransposedLinear {
    weight: Tensor, // [outputs, inputs]
    bias: Option<Tensor>,
}

impl TransposedLinear {
    /// Loads `weight` of `[outputs, inputs]` and `bias` below a prefix.
    pub fn load(names: &Names<'_>, inputs: usize, outputs: usize) -> std::result::Result<Self, StableError> {
        Ok(Self {
            bias: Some(names.tensor("bias", &[outputs])?),
            ..Self::load_without_bias(names, inputs, outputs)?
        })
    }

    /// Loads `weight` alone.
    pub fn load_without_bias(
        names: &Names<'_>,
        inputs: usize,
        outputs: usize,
    ) -> std::result::Result<Self, StableError> {
        Ok(Self {
            weight: names.matrix("weight", [outputs, inputs])?,
            bias: None,
        })
    }

    /// Applies the layer to `[.., inputs]`, in two or three dimensions.
    pub fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let mut dims = x.dims().to_vec();
        let inputs = dims.pop().unwrap_or(0);
        let rows = dims.iter().product::<usize>();
        dims.push(self.weight.dim(0)?);
        let y = x
            .contiguous()?
            .reshape((rows, inputs))?
            .matmul(&self.weight.t()?)?;
        let y = match &self.bias {
            Some(bias) => y.broadcast_add(bias)?,
            None => y,
        };
        y.reshape(dims)
    }
}
