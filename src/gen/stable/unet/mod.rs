//! The UNet: from noisy latents, a timestep and the text input to noise or v. Ronneberger et al. 2015; Rombach et al.
//! 2022.

mod levels;
mod neighbours;
mod time;
mod transformer;

pub(crate) use levels::{Down, UnetBottleneck, UnetLevels};
pub(crate) use time::TimeEmbedding;

use candle_core::Tensor;

use crate::config::UnetConfig;
use crate::layers::{Conv, GroupNorm};
use crate::weights::{Names, Weights};
use crate::{Machine, StableError, wrong};
use levels::Up;
pub(crate) use neighbours::NeighbourIndices;

/// Largest side of an input, cells.
const MOST_SIDE: usize = 4096;

/// Values that conditions add to the UNet's maps.
#[derive(Clone, Debug, Default)]
pub struct Extra {
    /// Added to the map behind the first convolution: the planes of SyntheOcc's paper.
    pub first: Option<Tensor>,
    /// Added to every map that is passed on to the way up, from the finest on; empty, or one for each map.
    pub down: Vec<Tensor>,
    /// Added to the coarsest map.
    pub middle: Option<Tensor>,
}

/// The network.
pub struct Unet {
    config: UnetConfig,
    neighbours: Vec<Vec<usize>>,
    pub(crate) time: TimeEmbedding,
    first: Conv,
    pub(crate) down: Vec<Down>,
    pub(crate) middle: UnetBottleneck,
    pub(crate) up: Vec<Up>,
    norm: GroupNorm,
    last: Conv,
    machine: Machine,
}

impl Unet {
    /// Loads the network from weights. Errors if they do not fit the configuration.
    pub fn load(config: UnetConfig, weights: &Weights, machine: &Machine) -> Result<Self, StableError> {
        weights.build(machine, &[], |names| Self::of(&config, names, machine))
    }

    /// Checks that weights fit a configuration, by names, shapes and types alone. Errors list the first few that do
    /// not.
    pub fn check(config: &UnetConfig, weights: &Weights) -> Result<(), StableError> {
        weights.check(&[], |names| Self::of(config, names, &Machine::cpu()))
    }

    fn of(config: &UnetConfig, names: &Names<'_>, machine: &Machine) -> Result<Self, StableError> {
        let levels = UnetLevels::from_config(config);
        let (finest, groups) = (config.block_out_channels[0], config.norm_num_groups);
        Ok(Self {
            neighbours: config.neighbours().unwrap_or_default(),
            time: TimeEmbedding::load(&names.at("time_embedding"), config)?,
            first: Conv::load(&names.at("conv_in"), config.in_channels, finest)?,
            down: levels.down(names)?,
            middle: levels.middle(names)?,
            up: levels.up(names)?,
            norm: GroupNorm::load(&names.at("conv_norm_out"), finest, groups, config.norm_eps)?,
            last: Conv::load(&names.at("conv_out"), finest, config.out_channels)?,
            config: config.clone(),
            machine: machine.clone(),
        })
    }

    /// Sizes of the network.
    pub fn config(&self) -> &UnetConfig {
        &self.config
    }

    /// Number of views that it draws together: 1 if it draws them one by one.
    pub fn views(&self) -> usize {
        self.neighbours.len().max(1)
    }

    /// Whether frames attend to each other.
    pub fn hears_frames(&self) -> bool {
        self.config.cross_frame_attn_type.is_some()
    }

    /// The prediction for latents `[frames * views, channels, rows, columns]` (all views of the first frame, then of
    /// the next) at training step `t`. `context` `[n or 1, tokens, width]` is the text input, for each or for all.
    /// Errors if sizes do not fit.
    pub fn forward(
        &self,
        x: &Tensor,
        t: f64,
        context: &Tensor,
        extra: &Extra,
        frames: usize,
    ) -> Result<Tensor, StableError> {
        let (batch, _, rows, columns) = x.dims4()?;
        if !(1..=MOST_SIDE).contains(&rows) || !(1..=MOST_SIDE).contains(&columns) {
            let sides = format!("{rows} x {columns}");
            return Err(wrong(
                "size of latents",
                sides,
                format!("1 to {MOST_SIDE} a side"),
            ));
        }
        let around = NeighbourIndices::from_neighbours(&self.neighbours, frames, batch)?;
        let dtype = self.machine.dtype;
        let x = x.to_dtype(dtype)?;
        let context = told_to_each(context, batch)?.to_dtype(dtype)?;
        let time = self.time.forward(t, &self.machine)?;
        let mut x = self.first.forward(&x)?;
        if let Some(first) = &extra.first {
            x = (x + first.to_dtype(dtype)?)?;
        }
        let mut kept = vec![x.clone()];
        for level in &self.down {
            x = level.forward(x, &time, &context, &around, &mut kept)?;
        }
        if !extra.down.is_empty() {
            crate::check_length("residuals of a ControlNet", extra.down.len(), kept.len())?;
            for (kept, more) in kept.iter_mut().zip(&extra.down) {
                *kept = (&*kept + more.to_dtype(dtype)?)?;
            }
        }
        x = self.middle.forward(&x, &time, &context, &around)?;
        if let Some(more) = &extra.middle {
            x = (x + more.to_dtype(dtype)?)?;
        }
        for level in &self.up {
            x = level.forward(x, &time, &context, &around, &mut kept)?;
        }
        Ok(self.last.forward(&self.norm.forward(&x)?.silu()?)?)
    }
}

/// The text input as `[batch, tokens, width]`: one for all items is repeated.
pub(crate) fn told_to_each(context: &Tensor, batch: usize) -> Result<Tensor, StableError> {
    let (given, tokens, width) = context.dims3()?;
    if given == batch {
        return Ok(context.contiguous()?);
    }
    crate::check_length("texts", given, 1)?;
    Ok(context.broadcast_as((batch, tokens, width))?.contiguous()?)
}
