//! Diffusion in two dimensions that draws scenery as a map of 100x100 cells of 0.8 m: v from a noisy map, a timestep
//! and a condition (layout, ground, which cells are drawn and what stays). A U-net of the VAE's blocks. Twin of
//! `training/models/scenery.py`, which says what the numbers of a cell mean.

use std::sync::{Arc, OnceLock};

use serde::Deserialize;

use super::encoder::{EncoderLevel, PIECE, levels, steps};
use super::occ_dit::timestep_embedding;
use super::{ColumnHeights, ModelError, check_finite, check_length};
use nn::map::FeatureMap;
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Ops};
use scene::Window;

/// File name of the weights.
pub const FILE: &str = "scenery.safetensors";
/// Cells along x and along y.
pub const SIDE: usize = 100;
/// Cells in all.
pub const CELLS: usize = SIDE * SIDE;
/// Numbers of a cell.
pub const NUMBERS: usize = 7;
/// Numbers given by name: vegetation, building, clutter.
pub const NAMED: usize = 3;
/// Bins above the ground that the heights of a map span.
const HEIGHTS: f32 = 14.0;
/// Man-made things whose top is no higher than this, in bins, are low.
const LOW: u8 = 8;
/// Map layers of the layout, and whether any object stands there.
const LAYERS: usize = 8 + 1;
/// Numbers of a cell's condition: layout, ground, whether it is drawn, what stands in it where it stays.
const CONDITION: usize = LAYERS + 1 + 1 + NUMBERS;
/// Columns along one side of a cell.
const COLUMNS: usize = Window::NX / SIDE;

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneryConfig {
    /// Channels of each level, finest first.
    pub widths: Vec<usize>,
    /// Kernels of each level's blocks, finest first.
    pub kernels: Vec<Vec<usize>>,
    /// Numbers of the timestep embedding.
    pub frequencies: usize,
}

impl SceneryConfig {
    fn check(&self) -> Result<(), String> {
        let levels = self.widths.len();
        if !(2..=3).contains(&levels) || self.kernels.len() != levels {
            Err(format!(
                "widths and kernels: expected 2 or 3 levels, found {levels}"
            ))
        } else if self.widths.iter().any(|w| !(1..=4096).contains(w)) {
            Err(format!("widths: expected 1 to 4096, found {:?}", self.widths))
        } else if let Some(k) = self.kernels.iter().flatten().find(|k| ![1, 3].contains(*k)) {
            Err(format!("kernels: expected 1 or 3, found {k}"))
        } else if !(2..=4096).contains(&self.frequencies) || !self.frequencies.is_multiple_of(2) {
            let found = self.frequencies;
            Err(format!(
                "frequencies: expected an even number up to 4096, found {found}"
            ))
        } else {
            Ok(())
        }
    }
}

/// Condition that a map is drawn for.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneryCondition {
    /// Bits of the 18 layers, `[x][y]`, 200x200.
    pub bev: Vec<u32>,
    /// Highest bin of the ground of each column, one more than the bin, 200x200.
    pub ground: Vec<u8>,
    /// Which cells are drawn, 100x100.
    pub drawn: Vec<bool>,
    /// The map of what stands; an input where it is not drawn.
    pub stands: Vec<f32>,
    /// Vegetation, building, clutter where they are given, 0 to 1 (`Density`).
    pub named: [Option<f32>; NAMED],
}

/// The map of what stands in some columns, `[cell][number]`: a building or a plant fills a cell if it fills two of its columns,
/// low things if they touch it.
pub fn map_of(columns: &[ColumnHeights]) -> Vec<f32> {
    let mut out = Vec::with_capacity(CELLS * NUMBERS);
    for cell in 0..CELLS {
        let own: Vec<&ColumnHeights> = columns_of(cell).map(|c| &columns[c]).collect();
        let ground = own.iter().map(|c| c.ground).max().unwrap_or(0);
        let height = |bins: u8| {
            let above = f32::from(bins) - f32::from(ground);
            (2.0 * above / HEIGHTS - 1.0).clamp(-1.0, 1.0)
        };
        let kinds: [(usize, Option<bool>, usize); 3] =
            [(0, Some(true), 2), (0, Some(false), 1), (1, None, 2)];
        for (group, high, least) in kinds {
            let standing = own.iter().map(|c| c.standing[group]);
            let held = standing.filter(|[_, top]| *top > 0 && high.is_none_or(|h| (*top > LOW) == h));
            let held: Vec<[u8; 2]> = held.collect();
            let stands = held.len() >= least;
            let top = held.iter().map(|[_, top]| *top).max().unwrap_or(0);
            out.push(if stands { 1.0 } else { -1.0 });
            out.push(if stands { height(top) } else { -1.0 });
            if high.is_none() {
                let base = held.iter().map(|[base, _]| base - 1).min().unwrap_or(0);
                out.push(if stands { height(base) } else { -1.0 });
            }
        }
    }
    out
}

/// The columns of a cell.
pub fn columns_of(cell: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (cell / SIDE * COLUMNS, cell % SIDE * COLUMNS);
    (0..COLUMNS * COLUMNS).map(move |i| (x + i / COLUMNS) * Window::NY + y + i % COLUMNS)
}

/// A height of a map in bins above the ground.
pub fn bins_above(number: f32) -> f32 {
    (number + 1.0) * HEIGHTS / 2.0
}

/// The network with its weights, on a backend.
pub struct SceneryNet<B: Ops = Cpu> {
    ops: B,
    config: SceneryConfig,
    stem: B::Linear,
    time1: B::Linear,
    time2: B::Linear,
    named: B::Linear,
    tell: Vec<B::Linear>,
    enter: Vec<EncoderLevel<B>>,
    down: Vec<B::Linear>,
    middle: EncoderLevel<B>,
    up: Vec<B::Linear>,
    leave: Vec<EncoderLevel<B>>,
    norm: B::Norm,
    head: B::Linear,
}

impl SceneryNet {
    /// The weights that ship with the program, on the processor; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NET: OnceLock<Arc<SceneryNet>> = OnceLock::new();
        if let Some(net) = NET.get() {
            return Ok(net.clone());
        }
        let bytes = assets::weights::SCENERY;
        let net = Self::on(Cpu, WeightFile::parse(FILE, bytes)?)?;
        Ok(NET.get_or_init(|| Arc::new(net)).clone())
    }
}

impl<B: Ops> SceneryNet<B> {
    /// Takes all tensors of the file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: SceneryConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (widths, w) = (config.widths.clone(), &mut file);
        let coarsest = widths.len() - 1;
        let wide = widths[coarsest];
        let back: Vec<usize> = widths[..coarsest].iter().rev().copied().collect();
        let back_kernels: Vec<Vec<usize>> = config.kernels[..coarsest].iter().rev().cloned().collect();
        let told = widths.iter().chain(&back).enumerate();
        let told = told.map(|(i, width)| ops.linear(w, &format!("tell.{i}"), [wide, *width], &[]));
        let tell = told.collect::<Result<_, _>>()?;
        let downwards = widths.windows(2).map(|p| [4 * p[0], p[1]]).collect();
        let upwards = widths.windows(2).rev().map(|p| [p[1], 4 * p[0]]).collect();
        let net = Self {
            tell,
            stem: ops.linear(w, "stem", [NUMBERS + CONDITION, widths[0]], &[1, 1])?,
            time1: ops.linear(w, "time1", [config.frequencies, wide], &[])?,
            time2: ops.linear(w, "time2", [wide, wide], &[])?,
            named: ops.linear(w, "named", [2 * NAMED, wide], &[])?,
            enter: levels(&ops, w, "enter", &widths[..coarsest], &config.kernels)?,
            down: steps(&ops, w, "down", downwards)?,
            middle: EncoderLevel::new(&ops, w, "middle", wide, &config.kernels[coarsest])?,
            up: steps(&ops, w, "up", upwards)?,
            leave: levels(&ops, w, "leave", &back, &back_kernels)?,
            norm: ops.load_norm(w, "norm", widths[0])?,
            head: ops.linear(w, "head", [widths[0], NUMBERS], &[1, 1])?,
            config,
            ops,
        };
        file.finish()?;
        Ok(net)
    }

    /// v for the noisy map `x` (`[cell][number]`) at training step `t` (0 to 999, fractions allowed).
    pub fn forward(&self, x: &[f32], t: f32, condition: &SceneryCondition) -> Result<Vec<f32>, ModelError> {
        check_length("state", x.len(), CELLS * NUMBERS)?;
        check_finite("state", x)?;
        if !(0.0..1000.0).contains(&t) {
            return Err(ModelError::Timestep(t));
        }
        let ops = &self.ops;
        let features = ops.upload(FeatureMap {
            data: condition.features(x)?,
            rows: SIDE,
            columns: SIDE,
            width: NUMBERS + CONDITION,
        })?;
        let mut map = ops.apply(&self.stem, &features, PIECE)?;
        let time = ops.vector(timestep_embedding(t, self.config.frequencies))?;
        let time = ops.silu(ops.apply(&self.time1, &time, 1)?)?;
        let named = ops.apply(&self.named, &ops.vector(condition.numbers())?, 1)?;
        let time = ops.silu(ops.add(ops.apply(&self.time2, &time, 1)?, &named)?)?;
        let mut tell = self.tell.iter();
        let mut told = |map: B::Tensor| match tell.next() {
            Some(tell) => ops.add(map, &ops.apply(tell, &time, 1)?),
            None => Ok(map),
        };
        let mut kept = Vec::new();
        for (level, down) in self.enter.iter().zip(&self.down) {
            map = level.apply(ops, told(map)?)?;
            let coarser = ops.apply(down, &ops.fold(&map)?, PIECE)?;
            kept.push(std::mem::replace(&mut map, coarser));
        }
        map = self.middle.apply(ops, told(map)?)?;
        for (up, level) in self.up.iter().zip(&self.leave) {
            map = ops.unfold(&ops.apply(up, &map, PIECE)?)?;
            if let Some(before) = kept.pop() {
                map = ops.add(map, &before)?;
            }
            map = level.apply(ops, told(map)?)?;
        }
        let normed = ops.norm(&self.norm, map)?;
        let v = ops.download(ops.apply(&self.head, &normed, PIECE)?)?.data;
        check_finite("predicted v", &v)?;
        Ok(v)
    }
}

impl SceneryCondition {
    /// Named numbers, 0 where they are not given, then their flags.
    fn numbers(&self) -> Vec<f32> {
        let values = self.named.iter().map(|n| n.unwrap_or(0.0));
        let flags = self.named.iter().map(|n| f32::from(u8::from(n.is_some())));
        values.chain(flags).collect()
    }

    /// State and condition, `[cell][number]`.
    fn features(&self, x: &[f32]) -> Result<Vec<f32>, ModelError> {
        check_length("layout", self.bev.len(), Window::COLUMNS)?;
        check_length("ground", self.ground.len(), Window::COLUMNS)?;
        check_length("drawn cells", self.drawn.len(), CELLS)?;
        check_length("what stands", self.stands.len(), CELLS * NUMBERS)?;
        check_finite("what stands", &self.stands)?;
        check_finite("named numbers", &self.numbers())?;
        let mut out = Vec::with_capacity(CELLS * (NUMBERS + CONDITION));
        for (cell, drawn) in self.drawn.iter().enumerate() {
            out.extend(&x[cell * NUMBERS..][..NUMBERS]);
            let bits = columns_of(cell).fold(0, |bits, c| bits | self.bev[c]);
            let object = LAYERS - 1;
            out.extend((0..object).map(|layer| (bits >> layer & 1) as f32));
            out.push(f32::from(u8::from(bits >> object != 0)));
            let first = columns_of(cell).next().unwrap_or(0);
            out.push(f32::from(self.ground[first]) / Window::NZ as f32);
            out.push(f32::from(u8::from(*drawn)));
            let stands = &self.stands[cell * NUMBERS..][..NUMBERS];
            out.extend(stands.iter().map(|v| if *drawn { 0.0 } else { *v }));
        }
        Ok(out)
    }
}
