//! A convolution.

use candle_core::{Result, Tensor};

use crate::StableError;
use crate::weights::Names;

/// A convolution with a square kernel.
#[derive(Clone, Debug)]
pub(crate) struct Conv {
    weight: Tensor, // [outputs, inputs, kernel, kernel]
    bias: Tensor,   // [1, outputs, 1, 1]
    stride: usize,
    padding: usize,
}

impl Conv {
    /// 3x3, which keeps the size of the map.
    pub fn load(names: &Names<'_>, inputs: usize, outputs: usize) -> std::result::Result<Self, StableError> {
        Self::load_with(names, [inputs, outputs], 3, 1, 1)
    }

    /// 1x1.
    pub fn load_point(
        names: &Names<'_>,
        inputs: usize,
        outputs: usize,
    ) -> std::result::Result<Self, StableError> {
        Self::load_with(names, [inputs, outputs], 1, 1, 0)
    }

    /// With a kernel, stride and padding of its own.
    pub fn load_with(
        names: &Names<'_>,
        [inputs, outputs]: [usize; 2],
        kernel: usize,
        stride: usize,
        padding: usize,
    ) -> std::result::Result<Self, StableError> {
        Ok(Self {
            weight: names.tensor("weight", &[outputs, inputs, kernel, kernel])?,
            bias: names.tensor("bias", &[outputs])?.reshape((1, outputs, 1, 1))?,
            stride,
            padding,
        })
    }

    /// Of a map.
    pub fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let y = x
            .contiguous()?
            .conv2d(&self.weight, self.padding, self.stride, 1, 1)?;
        y.broadcast_add(&self.bias)
    }
}
