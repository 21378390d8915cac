//! Latent diffusion transformer for the pictures of a ring of cameras: residual blocks on cells, transformer blocks on
//! tokens of 2x2 cells, some of which attend to the neighbours in the ring.

use std::path::Path;

use rayon::prelude::*;

use super::condition::{Light, Teller};
use super::warp::BEFORE;
use super::{EncodedCondition, PictureDitConfig, RingSize, TOKEN, WarpedLatents, check_kind};
use crate::encoder::{EncoderLevel, PIECE};
use crate::occ_dit::{positions, timestep_embedding};
use crate::{ModelError, check_finite, check_length};
use nn::map::FeatureMap;
use nn::ring::{AcrossParts, RingBlockParts};
use nn::weights::{self, WeightFile, WeightsError};
use nn::{Cpu, Ops};

/// Base of the positions' wavelengths: maps are small.
const POSITION_BASE: f64 = 1000.0;

/// The network with its weights, on a backend.
pub struct PictureDit<B: Ops = Cpu> {
    pub(super) ops: B,
    config: PictureDitConfig,
    pub(super) teller: Teller<B>,
    pub(super) light: Light<B>,
    stem: B::Linear,
    stem_before: B::Linear,
    time1: B::Linear,
    time2: B::Linear,
    ada: B::Linear,
    tell: [B::Linear; 2],
    enter: EncoderLevel<B>,
    down: B::Linear,
    blocks: Vec<B::RingBlock>,
    up: B::Linear,
    leave: EncoderLevel<B>,
    norm: B::Norm,
    head: B::Linear,
}

impl PictureDit {
    /// Loads the network of a file onto the processor. Errors name the file, in one line.
    pub fn load(path: &Path) -> Result<Self, WeightsError> {
        Self::new(WeightFile::parse(
            &path.display().to_string(),
            &weights::read(path)?,
        )?)
    }

    /// Loads the network onto the processor. Takes all tensors of the file; refuses one that is missing, misshapen, not
    /// finite or unknown.
    pub fn new(file: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, file)
    }
}

impl<B: Ops> PictureDit<B> {
    /// Loads the network onto a backend; otherwise as [`PictureDit::new`].
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        check_kind(&file, "picture_dit")?;
        let config: PictureDitConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (w, point) = (&mut file, &[1, 1]);
        let (latent, cells, width) = (config.latent, config.cells, config.width);
        let blocks = (0..config.depth).map(|i| ring_block(&ops, w, &config, i));
        let blocks = blocks.collect::<Result<_, _>>()?;
        let dit = Self {
            teller: Teller::new(&ops, w, &config)?,
            light: Light::new(&ops, w, width)?,
            stem: ops.linear(w, "stem", [latent, cells], &[])?,
            stem_before: ops.linear(w, "stem_before", [BEFORE * latent + 3, cells], &[])?,
            time1: ops.linear(w, "time1", [config.frequencies, width], &[])?,
            time2: ops.linear(w, "time2", [width, width], &[])?,
            ada: ops.linear(w, "ada", [width, 6 * width], &[])?,
            tell: [
                ops.linear(w, "tell.0", [width, cells], &[])?,
                ops.linear(w, "tell.1", [width, cells], &[])?,
            ],
            enter: EncoderLevel::new(&ops, w, "enter", cells, &config.kernels)?,
            down: ops.linear(w, "down", [4 * cells, width], point)?,
            blocks,
            up: ops.linear(w, "up", [width, 4 * cells], point)?,
            leave: EncoderLevel::new(&ops, w, "leave", cells, &config.kernels)?,
            norm: ops.load_norm(w, "norm", cells)?,
            head: ops.linear(w, "head", [cells, latent], point)?,
            config,
            ops,
        };
        file.finish()?;
        Ok(dit)
    }

    /// Sizes of the network.
    pub fn config(&self) -> &PictureDitConfig {
        &self.config
    }

    /// v for the noisy latents `x`, `[view][row][column][8]`, at training step `t` (0 to 999, fractions allowed). `told` is what
    /// [`tell`](Self::tell) made, `before` what [`warp`](super::warp()) made of the frame before, if there is one. Errors if the
    /// sizes do not fit or a number is not finite.
    pub fn v(
        &self,
        x: &[f32],
        t: f32,
        told: &EncodedCondition<B::Tensor>,
        before: Option<&WarpedLatents>,
    ) -> Result<Vec<f32>, ModelError> {
        let (ops, size) = (&self.ops, told.size);
        let numbers = size.view_cells() * self.config.latent;
        check_length("state", x.len(), size.views() * numbers)?;
        check_finite("state", x)?;
        if !(0.0..1000.0).contains(&t) {
            return Err(ModelError::Timestep(t));
        }
        if let Some(before) = before {
            let wide = BEFORE * self.config.latent + 3;
            let expected = size.views() * size.view_cells() * wide;
            check_length("frame before", before.numbers().len(), expected)?;
        }
        let time = ops.vector(timestep_embedding(t, self.config.frequencies))?;
        let time = ops.silu(ops.apply(&self.time1, &time, 1)?)?;
        let time = ops.apply(&self.time2, &time, 1)?;
        let heard = told
            .light
            .iter()
            .map(|light| ops.silu(ops.add(time.clone(), light)?));
        let heard: Vec<B::Tensor> = heard.collect::<Result<_, _>>()?;

        let kept = each_view(size, |view| {
            let x = &x[view * numbers..][..numbers];
            let before = before.map(|before| before.view(view, size));
            self.enter(x, before, &told.cells[view], &heard[view], size)
        })?;
        let mut tokens = each_view(size, |view| {
            let tokens = ops.apply(&self.down, &ops.fold(&kept[view])?, PIECE)?;
            Ok(ops.add(tokens, &told.positions)?)
        })?;
        let ada = each_view(size, |view| Ok(ops.apply(&self.ada, &heard[view], 1)?))?;
        for block in &self.blocks {
            tokens = ops.ring_block(block, tokens, &ada)?;
        }
        let v = each_view(size, |view| self.leave(&tokens[view], &kept[view], &heard[view]))?;
        let v = v.concat();
        check_finite("predicted v", &v)?;
        Ok(v)
    }

    /// Cells of a view before they are folded into tokens.
    fn enter(
        &self,
        x: &[f32],
        before: Option<&[f32]>,
        cells: &B::Tensor,
        heard: &B::Tensor,
        size: RingSize,
    ) -> Result<B::Tensor, ModelError> {
        let ops = &self.ops;
        let [rows, columns] = size.cells();
        let map = |data: &[f32]| {
            ops.upload(FeatureMap {
                data: data.to_vec(),
                rows,
                columns,
                width: data.len() / (rows * columns),
            })
        };
        let mut y = ops.apply(&self.stem, &map(x)?, PIECE)?;
        if let Some(before) = before {
            y = ops.add(y, &ops.apply(&self.stem_before, &map(before)?, PIECE)?)?;
        }
        let y = ops.add(ops.add(y, cells)?, &ops.apply(&self.tell[0], heard, 1)?)?;
        Ok(self.enter.apply(ops, y)?)
    }

    /// v of a view, from the output of the last block.
    fn leave(&self, tokens: &B::Tensor, kept: &B::Tensor, heard: &B::Tensor) -> Result<Vec<f32>, ModelError> {
        let ops = &self.ops;
        let y = ops.unfold(&ops.apply(&self.up, tokens, PIECE)?)?;
        let y = ops.add(ops.add(y, kept)?, &ops.apply(&self.tell[1], heard, 1)?)?;
        let normed = ops.norm(&self.norm, self.leave.apply(ops, y)?)?;
        Ok(ops.download(ops.apply(&self.head, &normed, PIECE)?)?.data)
    }

    /// Positions of the tokens of a view.
    pub(super) fn positions(&self, size: RingSize) -> Result<B::Tensor, ModelError> {
        let [rows, columns] = size.cells().map(|n| n / TOKEN);
        Ok(self.ops.upload(FeatureMap {
            data: positions([rows, columns], self.config.width, POSITION_BASE),
            rows,
            columns,
            width: self.config.width,
        })?)
    }
}

/// Computes a value for every view, on all cores.
pub(super) fn each_view<T: Send>(
    size: RingSize,
    of: impl Fn(usize) -> Result<T, ModelError> + Sync + Send,
) -> Result<Vec<T>, ModelError> {
    (0..size.views()).into_par_iter().map(of).collect()
}

/// Block `blocks.i` of a file.
fn ring_block<B: Ops>(
    ops: &B,
    w: &mut WeightFile<'_>,
    config: &PictureDitConfig,
    i: usize,
) -> Result<B::RingBlock, WeightsError> {
    let (width, name) = (config.width, |part: &str| format!("blocks.{i}.{part}"));
    let mut linear = |part: &str, inputs, outputs| ops.linear(w, &name(part), [inputs, outputs], &[]);
    let (qkv, proj) = (linear("qkv", width, 3 * width)?, linear("proj", width, width)?);
    let (fc1, fc2) = (linear("fc1", width, 4 * width)?, linear("fc2", 4 * width, width)?);
    let across = match config.across.contains(&i) {
        true => Some(AcrossParts {
            qkv: linear("ring_qkv", width, 3 * width)?,
            proj: linear("ring_proj", width, width)?,
            norm: ops.load_norm(w, &name("norm"), width)?,
            side: w.take(&name("side"), &[2, width])?,
        }),
        false => None,
    };
    let parts = RingBlockParts {
        offset: w.take(&name("offset"), &[6, width])?,
        qkv,
        proj,
        fc1,
        fc2,
        local: (
            w.take(&name("local.weight"), &[width, 1, 3, 3])?,
            w.take(&name("local.bias"), &[width])?,
        ),
        across,
        heads: config.heads,
    };
    ops.ring_block_from(parts).map_err(|e| w.backend_error(e))
}
