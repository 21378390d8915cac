//! The two halves of the autoencoder.

use candle_core::{Result, Tensor};

use crate::StableError;
use crate::config::VaeConfig;
use crate::layers::{Attention, Conv, GroupNorm, StableResidual};
use crate::weights::Names;

/// Epsilon of the norms.
const EPSILON: f64 = 1e-6;

type StableResult<T> = std::result::Result<T, StableError>;

/// Attention of all cells of a map to each other, with one head.
pub(crate) struct Everywhere {
    norm: GroupNorm,
    attention: Attention,
}

impl Everywhere {
    /// Loads the layers, by the names of current files or of older ones.
    fn load(names: &Names<'_>, width: usize, groups: usize) -> StableResult<Self> {
        let layers: [&[&str]; 4] = [
            &["to_q", "query"],
            &["to_k", "key"],
            &["to_v", "value"],
            &["to_out.0", "proj_attn"],
        ];
        Ok(Self {
            norm: GroupNorm::load(&names.at("group_norm"), width, groups, EPSILON)?,
            attention: Attention::load_named(names, layers, width, 1)?,
        })
    }

    pub fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let (batch, width, rows, columns) = x.dims4()?;
        let tokens = self.norm.forward(x)?.reshape((batch, width, rows * columns))?;
        let tokens = tokens.transpose(1, 2)?.contiguous()?;
        let y = self.attention.forward(&tokens, &tokens, None)?;
        x + y
            .transpose(1, 2)?
            .contiguous()?
            .reshape((batch, width, rows, columns))?
    }
}

/// The coarsest level.
pub(crate) struct VaeBottleneck {
    pub(crate) residuals: [StableResidual; 2],
    pub(crate) everywhere: Everywhere,
}

impl VaeBottleneck {
    fn load(names: &Names<'_>, width: usize, groups: usize) -> StableResult<Self> {
        let residual = |i: usize| {
            let names = names.at("resnets").at(i);
            StableResidual::load(&names, [width; 2], None, groups, EPSILON)
        };
        Ok(Self {
            residuals: [residual(0)?, residual(1)?],
            everywhere: Everywhere::load(&names.at("attentions.0"), width, groups)?,
        })
    }

    fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let x = self.everywhere.forward(&self.residuals[0].forward(x, None)?)?;
        self.residuals[1].forward(&x, None)
    }
}

/// A level: residual blocks, and a convolution to the next size.
struct VaeLevel {
    residuals: Vec<StableResidual>,
    resize: Option<Conv>,
}

impl VaeLevel {
    fn load(
        names: &Names<'_>,
        [inputs, outputs]: [usize; 2],
        count: usize,
        groups: usize,
        resize: Option<(&str, usize)>,
    ) -> StableResult<Self> {
        let residual = |i: usize| {
            let inputs = if i == 0 { inputs } else { outputs };
            StableResidual::load(
                &names.at("resnets").at(i),
                [inputs, outputs],
                None,
                groups,
                EPSILON,
            )
        };
        let resize = resize.map(|(name, stride)| {
            let padding = 2 - stride;
            Conv::load_with(&names.at(name), [outputs; 2], 3, stride, padding)
        });
        Ok(Self {
            residuals: (0..count).map(residual).collect::<StableResult<_>>()?,
            resize: resize.transpose()?,
        })
    }

    fn residuals(&self, x: Tensor) -> Result<Tensor> {
        self.residuals
            .iter()
            .try_fold(x, |x, residual| residual.forward(&x, None))
    }
}

/// Encoder of pictures to mean and log variance.
pub(crate) struct VaeEncoder {
    first: Conv,
    levels: Vec<VaeLevel>,
    pub(crate) middle: VaeBottleneck,
    norm: GroupNorm,
    last: Conv,
}

impl VaeEncoder {
    pub fn load(names: &Names<'_>, config: &VaeConfig) -> StableResult<Self> {
        let (widths, groups) = (&config.block_out_channels, config.norm_num_groups);
        let (finest, coarsest) = (widths[0], widths[widths.len() - 1]);
        let level = |i: usize| {
            let inputs = widths[i.saturating_sub(1)];
            let resize = (i + 1 < widths.len()).then_some(("downsamplers.0.conv", 2));
            let names = names.at("down_blocks").at(i);
            VaeLevel::load(
                &names,
                [inputs, widths[i]],
                config.layers_per_block,
                groups,
                resize,
            )
        };
        Ok(Self {
            first: Conv::load(&names.at("conv_in"), 3, finest)?,
            levels: (0..widths.len()).map(level).collect::<StableResult<_>>()?,
            middle: VaeBottleneck::load(&names.at("mid_block"), coarsest, groups)?,
            norm: GroupNorm::load(&names.at("conv_norm_out"), coarsest, groups, EPSILON)?,
            last: Conv::load(&names.at("conv_out"), coarsest, 2 * config.latent_channels)?,
        })
    }

    pub fn forward(&self, pictures: &Tensor) -> Result<Tensor> {
        let mut x = self.first.forward(pictures)?;
        for level in &self.levels {
            x = level.residuals(x)?;
            if let Some(resize) = &level.resize {
                // One row below and one column on the right, as in training.
                x = resize.forward(&x.pad_with_zeros(2, 0, 1)?.pad_with_zeros(3, 0, 1)?)?;
            }
        }
        let x = self.middle.forward(&x)?;
        self.last.forward(&self.norm.forward(&x)?.silu()?)
    }
}

/// Decoder of latents to pictures.
pub(crate) struct Decoder {
    first: Conv,
    middle: VaeBottleneck,
    levels: Vec<VaeLevel>,
    norm: GroupNorm,
    last: Conv,
}

impl Decoder {
    pub fn load(names: &Names<'_>, config: &VaeConfig) -> StableResult<Self> {
        let groups = config.norm_num_groups;
        let widths: Vec<usize> = config.block_out_channels.iter().rev().copied().collect();
        let (coarsest, finest) = (widths[0], widths[widths.len() - 1]);
        let level = |i: usize| {
            let inputs = widths[i.saturating_sub(1)];
            let resize = (i + 1 < widths.len()).then_some(("upsamplers.0.conv", 1));
            let names = names.at("up_blocks").at(i);
            VaeLevel::load(
                &names,
                [inputs, widths[i]],
                config.layers_per_block + 1,
                groups,
                resize,
            )
        };
        Ok(Self {
            first: Conv::load(&names.at("conv_in"), config.latent_channels, coarsest)?,
            middle: VaeBottleneck::load(&names.at("mid_block"), coarsest, groups)?,
            levels: (0..widths.len()).map(level).collect::<StableResult<_>>()?,
            norm: GroupNorm::load(&names.at("conv_norm_out"), finest, groups, EPSILON)?,
            last: Conv::load(&names.at("conv_out"), finest, 3)?,
        })
    }

    pub fn forward(&self, latents: &Tensor) -> Result<Tensor> {
        let mut x = self.middle.forward(&self.first.forward(latents)?)?;
        for level in &self.levels {
            x = level.residuals(x)?;
            if let Some(resize) = &level.resize {
                let (_, _, rows, columns) = x.dims4()?;
                x = resize.forward(&x.contiguous()?.interpolate2d(2 * rows, 2 * columns)?)?;
            }
        }
        self.last.forward(&self.norm.forward(&x)?.silu()?)
    }
}
