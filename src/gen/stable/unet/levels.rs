//! Levels of the UNet: on the way down, at the bottom, on the way up.

use candle_core::{Result, Tensor};

use super::neighbours::NeighbourIndices;
use super::time::TimeEmbedding;
use super::transformer::Transformer;
use crate::StableError;
use crate::config::{UnetBlockKind, UnetConfig};
use crate::layers::{Conv, StableResidual};
use crate::weights::Names;

type StableResult<T> = std::result::Result<T, StableError>;

/// Residual blocks, each followed by a transformer if the level attends to the text.
struct Pairs {
    residuals: Vec<StableResidual>,
    transformers: Vec<Transformer>,
}

impl Pairs {
    fn forward(
        &self,
        i: usize,
        x: &Tensor,
        time: &Tensor,
        context: &Tensor,
        around: &NeighbourIndices,
    ) -> Result<Tensor> {
        let x = self.residuals[i].forward(x, Some(time))?;
        match self.transformers.get(i) {
            Some(transformer) => transformer.forward(&x, context, around),
            None => Ok(x),
        }
    }
}

/// A level on the way down.
pub(crate) struct Down {
    pairs: Pairs,
    resize: Option<Conv>,
}

impl Down {
    /// Pushes every map onto `kept`, for the way up.
    pub fn forward(
        &self,
        mut x: Tensor,
        time: &Tensor,
        context: &Tensor,
        around: &NeighbourIndices,
        kept: &mut Vec<Tensor>,
    ) -> Result<Tensor> {
        for i in 0..self.pairs.residuals.len() {
            x = self.pairs.forward(i, &x, time, context, around)?;
            kept.push(x.clone());
        }
        if let Some(resize) = &self.resize {
            x = resize.forward(&x)?;
            kept.push(x.clone());
        }
        Ok(x)
    }

    #[cfg(test)]
    pub fn parts(&self) -> (&StableResidual, &Transformer, Option<&Conv>) {
        (
            &self.pairs.residuals[0],
            &self.pairs.transformers[0],
            self.resize.as_ref(),
        )
    }
}

/// The level at the bottom.
pub(crate) struct UnetBottleneck {
    residuals: [StableResidual; 2],
    transformer: Transformer,
}

impl UnetBottleneck {
    /// Applies the blocks to the coarsest map.
    pub fn forward(
        &self,
        x: &Tensor,
        time: &Tensor,
        context: &Tensor,
        around: &NeighbourIndices,
    ) -> Result<Tensor> {
        let x = self.residuals[0].forward(x, Some(time))?;
        let x = self.transformer.forward(&x, context, around)?;
        self.residuals[1].forward(&x, Some(time))
    }
}

/// A level on the way up.
pub(crate) struct Up {
    pairs: Pairs,
    resize: Option<Conv>,
}

impl Up {
    /// Takes its skip maps from the end of `kept`. Grows to the size of the next one there, which need not be twice its
    /// own.
    pub fn forward(
        &self,
        mut x: Tensor,
        time: &Tensor,
        context: &Tensor,
        around: &NeighbourIndices,
        kept: &mut Vec<Tensor>,
    ) -> Result<Tensor> {
        for i in 0..self.pairs.residuals.len() {
            let Some(skip) = kept.pop() else {
                candle_core::bail!("the way up has more levels than the way down");
            };
            x = self
                .pairs
                .forward(i, &Tensor::cat(&[&x, &skip], 1)?, time, context, around)?;
        }
        if let (Some(resize), Some(next)) = (&self.resize, kept.last()) {
            let (_, _, rows, columns) = next.dims4()?;
            x = resize.forward(&x.contiguous()?.interpolate2d(rows, columns)?)?;
        }
        Ok(x)
    }

    #[cfg(test)]
    pub fn resize(&self) -> Option<&Conv> {
        self.resize.as_ref()
    }
}

/// Sizes of all levels, from the finest to the coarsest.
pub(crate) struct UnetLevels<'a> {
    config: &'a UnetConfig,
    heads: Vec<usize>,
    depths: Vec<usize>,
}

impl<'a> UnetLevels<'a> {
    /// Sizes of a configuration that has been checked.
    pub fn from_config(config: &'a UnetConfig) -> Self {
        Self {
            config,
            heads: config.heads().unwrap_or_default(),
            depths: config.depths().unwrap_or_default(),
        }
    }

    fn residual(&self, names: &Names<'_>, i: usize, channels: [usize; 2]) -> StableResult<StableResidual> {
        let config = self.config;
        let time = Some(TimeEmbedding::width(config));
        let names = names.at("resnets").at(i);
        StableResidual::load(&names, channels, time, config.norm_num_groups, config.norm_eps)
    }

    fn transformer(&self, names: &Names<'_>, i: usize, level: usize) -> StableResult<Transformer> {
        let width = self.config.block_out_channels[level];
        let sizes = [width, self.heads[level], self.depths[level]];
        Transformer::load(&names.at("attentions").at(i), self.config, sizes)
    }

    fn pairs(
        &self,
        names: &Names<'_>,
        kind: UnetBlockKind,
        level: usize,
        inputs: &[usize],
    ) -> StableResult<Pairs> {
        let width = self.config.block_out_channels[level];
        let listening = if kind == UnetBlockKind::Listens {
            inputs.len()
        } else {
            0
        };
        let residuals = inputs.iter().enumerate();
        Ok(Pairs {
            residuals: residuals
                .map(|(i, inputs)| self.residual(names, i, [*inputs, width]))
                .collect::<StableResult<_>>()?,
            transformers: (0..listening)
                .map(|i| self.transformer(names, i, level))
                .collect::<StableResult<_>>()?,
        })
    }

    /// All levels on the way down.
    pub fn down(&self, names: &Names<'_>) -> StableResult<Vec<Down>> {
        let widths = &self.config.block_out_channels;
        let level = |i: usize| {
            let names = names.at("down_blocks").at(i);
            let mut inputs = vec![widths[i]; self.config.layers_per_block];
            inputs[0] = widths[i.saturating_sub(1)];
            let resize = (i + 1 < widths.len()).then(|| {
                let names = names.at("downsamplers.0.conv");
                Conv::load_with(&names, [widths[i]; 2], 3, 2, 1)
            });
            Ok(Down {
                pairs: self.pairs(&names, self.config.down_block_types[i], i, &inputs)?,
                resize: resize.transpose()?,
            })
        };
        (0..widths.len()).map(level).collect()
    }

    /// Channels of all maps that the way down keeps.
    pub fn kept(&self) -> Vec<usize> {
        let widths = &self.config.block_out_channels;
        let mut kept = vec![widths[0]];
        for (i, width) in widths.iter().enumerate() {
            let resized = usize::from(i + 1 < widths.len());
            kept.extend(vec![*width; self.config.layers_per_block + resized]);
        }
        kept
    }

    /// The bottom.
    pub fn middle(&self, names: &Names<'_>) -> StableResult<UnetBottleneck> {
        let names = names.at("mid_block");
        let coarsest = self.config.block_out_channels.len() - 1;
        let width = self.config.block_out_channels[coarsest];
        Ok(UnetBottleneck {
            residuals: [
                self.residual(&names, 0, [width; 2])?,
                self.residual(&names, 1, [width; 2])?,
            ],
            transformer: self.transformer(&names, 0, coarsest)?,
        })
    }

    /// All levels on the way up, from the coarsest to the finest.
    pub fn up(&self, names: &Names<'_>) -> StableResult<Vec<Up>> {
        let widths = &self.config.block_out_channels;
        let mut kept = self.kept();
        let mut levels = Vec::new();
        let mut came = widths[widths.len() - 1];
        for (i, level) in (0..widths.len()).rev().enumerate() {
            let names = names.at("up_blocks").at(i);
            let mut inputs = Vec::new();
            for _ in 0..=self.config.layers_per_block {
                inputs.push(came + kept.pop().unwrap_or(0));
                came = widths[level];
            }
            let resize = (level > 0).then(|| Conv::load(&names.at("upsamplers.0.conv"), came, came));
            levels.push(Up {
                pairs: self.pairs(&names, self.config.up_block_types[i], level, &inputs)?,
                resize: resize.transpose()?,
            });
        }
        Ok(levels)
    }
}
