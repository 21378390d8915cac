//! Occupancy VAE: 200x200x16 labels to a latent of 50x50x8 (or 100x100x16, the fine one) and back. After
//! UniScene's, rebuilt for a CPU: an embedding bag, columns that share their weights
//! at two or three levels of the top view (0.4, 0.8, 1.6 m), norms that look at one place only. Twin of
//! `training/models/occ_vae.py`.

mod config;
mod decoder_input;

use super::encoder::{EncoderLevel, HEIGHT, OccupancyEncoder, PIECE, levels, steps};
use super::{ModelError, check_finite, check_length};
use crate::pieces::pieces;
use nn::map::{CellRect, FeatureMap};
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Ops};
use numeric::philox::{self, Stream};
use scene::{Class, VoxelGrid, Window};

pub use config::VaeConfig;
pub use decoder_input::DecoderInput;
use decoder_input::InputEmbedding;

/// Numbers per voxel before the class table.
const FEATURES: usize = 8;
const CLASSES: usize = Class::COUNT;
/// Bounds of the encoder's log variance: beyond them exp leaves f32.
const LOG_VARIANCE: [f32; 2] = [-30.0, 20.0];

/// The network with its weights, on a backend.
pub struct OccVae<B: Ops = Cpu> {
    ops: B,
    config: VaeConfig,
    encoder: OccupancyEncoder<B>,
    encoder_head: B::Linear,
    decoder_stem: B::Linear,
    decoder: Vec<EncoderLevel<B>>, // coarsest first
    up: Vec<B::Linear>,
    input: Option<InputEmbedding<B>>,
    decoder_norm: B::Norm,
    decoder_head: B::Linear, // with the class table multiplied in: logits of a column, [class][z]
    latent_mean: Vec<f32>,
    latent_std: Vec<f32>,
}

impl OccVae {
    /// Loads the network onto the processor. Takes all tensors of the file; refuses one that is missing, misshapen, not
    /// finite or unknown.
    pub fn new(file: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, file)
    }
}

impl<B: Ops> OccVae<B> {
    /// Loads the network onto a backend; otherwise as [`OccVae::new`].
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: VaeConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (widths, latent) = (config.widths.clone(), config.latent);
        let (fine, coarse) = (widths[0], widths[widths.len() - 1]);
        let upwards: Vec<usize> = widths.iter().rev().copied().collect();
        let w = &mut file;
        let vae = Self {
            encoder: OccupancyEncoder::new(&ops, w, &widths, &config.encoder_kernels)?,
            encoder_head: ops.linear(w, "encoder_head", [coarse, 2 * latent], &[1, 1])?,
            decoder_stem: ops.linear(w, "decoder_stem", [latent, coarse], &[1, 1])?,
            decoder: levels(&ops, w, "decoder", &upwards, &config.decoder_kernels)?,
            up: steps(
                &ops,
                w,
                "up",
                upwards.windows(2).map(|p| [p[0], 4 * p[1]]).collect(),
            )?,
            input: match config.hears {
                true => Some(InputEmbedding::new(&ops, w, fine)?),
                false => None,
            },
            decoder_norm: ops.load_norm(w, "decoder_norm", fine)?,
            decoder_head: head(&ops, w, fine)?,
            latent_mean: w.take("latent_mean", &[latent])?,
            latent_std: w.take("latent_std", &[latent])?,
            config,
            ops,
        };
        if let Some(i) = vae.latent_std.iter().position(|s| *s < 1e-6) {
            let reason = format!(
                "latent_std {i}: expected more than 1e-6, found {}",
                vae.latent_std[i]
            );
            return Err(file.config_error("config", reason));
        }
        file.finish()?;
        Ok(vae)
    }

    /// Sizes of the network.
    pub fn config(&self) -> &VaeConfig {
        &self.config
    }

    /// Latent cells in all.
    fn cells(&self) -> usize {
        self.config.side().pow(2)
    }

    /// Columns of voxels along one side of a cell.
    fn columns(&self) -> usize {
        Window::NX / self.config.side()
    }

    /// How many cells around an edited one may get another latent.
    pub fn encoder_reach(&self) -> usize {
        self.encoder.reach()
    }

    /// How many cells around a changed latent may get other labels.
    pub fn decoder_reach(&self) -> usize {
        let (coarsest, rest) = self.decoder.split_first().expect("two levels or more");
        let columns = rest
            .iter()
            .fold(coarsest.reach(), |reach, level| 2 * reach + 1 + level.reach());
        columns / self.columns()
    }

    /// The mean latent `[x][y][channel]`, 50x50x8 (fine: 100x100x16), of zero mean and unit spread over the
    /// training set.
    pub fn encode(&self, grid: &VoxelGrid) -> Result<Vec<f32>, ModelError> {
        Ok(self.encode_window(grid, CellRect::whole(self.config.side()))?.0)
    }

    /// A latent drawn from the encoder's normal distribution, as training sees them; the same seed gives the
    /// same latent.
    pub fn encode_sampled(&self, grid: &VoxelGrid, seed: u64) -> Result<Vec<f32>, ModelError> {
        let (mut latent, spread) = self.encode_window(grid, CellRect::whole(self.config.side()))?;
        let noise = philox::normal_field(seed, Stream::Encoder, self.cells(), self.config.latent);
        for ((value, spread), noise) in latent.iter_mut().zip(&spread).zip(&noise) {
            *value += spread * *noise as f32;
        }
        Ok(latent)
    }

    /// Computes the latents of some cells, as [`encode`](Self::encode) would; the others stay. Reads only what those cells
    /// can see.
    pub fn encode_cells(
        &self,
        grid: &VoxelGrid,
        cells: &[bool],
        latent: &mut [f32],
    ) -> Result<(), ModelError> {
        let channels = self.config.latent;
        check_length("cell mask", cells.len(), self.cells())?;
        check_length("latent", latent.len(), self.cells() * channels)?;
        let reach = self.encoder_reach();
        for cells in pieces(cells, reach) {
            let Some(window) = CellRect::around(&cells, reach) else {
                continue;
            };
            let (found, _) = self.encode_window(grid, window)?;
            for (cell, values) in window.cells().zip(found.chunks_exact(channels)) {
                if cells[cell] {
                    latent[cell * channels..][..channels].copy_from_slice(values);
                }
            }
        }
        Ok(())
    }

    /// Means and standard deviations of the cells of a window, as if nothing were around it, in units of the
    /// latent's spread over the training set.
    pub fn encode_window(
        &self,
        grid: &VoxelGrid,
        window: CellRect,
    ) -> Result<(Vec<f32>, Vec<f32>), ModelError> {
        let channels = self.config.latent;
        let ops = &self.ops;
        let features = self.encoder.features(ops, grid, window)?;
        let moments = ops
            .download(ops.apply(&self.encoder_head, &features, PIECE)?)?
            .data;
        let mut latent = Vec::with_capacity(window.rows * window.columns * channels);
        let mut spread = Vec::with_capacity(latent.capacity());
        for cell in moments.chunks_exact(2 * channels) {
            let (means, logvars) = cell.split_at(channels);
            let of = means.iter().zip(&self.latent_mean).zip(&self.latent_std);
            latent.extend(of.map(|((v, mean), std)| (v - mean) / std));
            let of = logvars.iter().zip(&self.latent_std);
            spread.extend(of.map(|(v, std)| (0.5 * v.clamp(LOG_VARIANCE[0], LOG_VARIANCE[1])).exp() / std));
        }
        check_finite("encoded latent", &latent)?;
        Ok((latent, spread))
    }

    /// The likeliest label of every voxel; the lowest class wins a tie.
    pub fn decode(&self, latent: &[f32]) -> Result<VoxelGrid, ModelError> {
        self.decode_cells(latent, &vec![true; self.cells()])
    }

    /// Decodes some of the cells; the others stay free. Computes only what those cells can see, and gives them the
    /// labels that [`decode`](Self::decode) gives.
    pub fn decode_cells(&self, latent: &[f32], cells: &[bool]) -> Result<VoxelGrid, ModelError> {
        self.decode_with(latent, cells, DecoderInput::default())
    }

    /// Decodes some of the cells with a [`DecoderInput`]; networks that were trained without one ignore it.
    pub fn decode_with(
        &self,
        latent: &[f32],
        cells: &[bool],
        input: DecoderInput<'_>,
    ) -> Result<VoxelGrid, ModelError> {
        check_length("cell mask", cells.len(), self.cells())?;
        check_length("latent", latent.len(), self.cells() * self.config.latent)?;
        if let Some(observed) = input.observed {
            check_length("observed columns", observed.len(), Window::COLUMNS)?;
        }
        let mut grid = VoxelGrid::new();
        let reach = self.decoder_reach();
        for cells in pieces(cells, reach) {
            if let Some(window) = CellRect::around(&cells, reach) {
                let map = self.decoder_map(latent, window, input)?;
                self.labels_of(&map, &cells, window, &mut grid)?;
            }
        }
        Ok(grid)
    }

    /// Puts the labels of the wanted cells of a window into a grid.
    fn labels_of(
        &self,
        map: &B::Tensor,
        cells: &[bool],
        window: CellRect,
        grid: &mut VoxelGrid,
    ) -> Result<(), ModelError> {
        let (side, per_cell) = (self.config.side(), self.columns());
        let wanted: Vec<usize> = window.cells().filter(|c| cells[*c]).collect();
        let places = wanted.iter().flat_map(|cell| self.places_of(*cell, window));
        let places: Vec<usize> = places.collect();
        let piece = per_cell * per_cell;
        // Weights and normed features are finite and small, so no logit can be NaN.
        let labels = self
            .ops
            .likeliest(&self.decoder_head, map, &places, HEIGHT, piece)?;
        for (cell, labels) in wanted.iter().zip(labels.chunks_exact(piece * HEIGHT)) {
            let (x0, y0) = (cell / side * per_cell, cell % side * per_cell);
            for (column, labels) in labels.chunks_exact(HEIGHT).enumerate() {
                if labels.iter().any(|l| *l != Class::FREE) {
                    let (x, y) = (x0 + column / per_cell, y0 + column % per_cell);
                    grid.column_mut(x, y).copy_from_slice(labels);
                }
            }
        }
        Ok(())
    }

    /// Places of a cell's columns in a map of the window, `[dx][dy]`.
    fn places_of(&self, cell: usize, window: CellRect) -> impl Iterator<Item = usize> {
        let (side, per_cell) = (self.config.side(), self.columns());
        let x = (cell / side - window.x) * per_cell;
        let y = (cell % side - window.y) * per_cell;
        let wide = window.columns * per_cell;
        (0..per_cell * per_cell).map(move |i| (x + i / per_cell) * wide + y + i % per_cell)
    }

    /// Class logits `[dx][dy][z][class]` of one cell, for tests and uncertainty.
    pub fn logits(
        &self,
        latent: &[f32],
        cell: usize,
        input: DecoderInput<'_>,
    ) -> Result<Vec<f32>, ModelError> {
        let mut cells = vec![false; self.cells()];
        cells[cell] = true;
        check_length("latent", latent.len(), self.cells() * self.config.latent)?;
        let Some(window) = CellRect::around(&cells, self.decoder_reach()) else {
            return Ok(Vec::new());
        };
        let map = self.decoder_map(latent, window, input)?;
        let logits = self.ops.apply(&self.decoder_head, &map, PIECE)?;
        let logits = self.ops.download(logits)?.data;
        let column = |place: usize| &logits[place * CLASSES * HEIGHT..][..CLASSES * HEIGHT];
        Ok(self
            .places_of(cell, window)
            .map(column)
            .flat_map(|column| (0..HEIGHT * CLASSES).map(|i| column[i % CLASSES * HEIGHT + i / CLASSES]))
            .collect())
    }

    /// The decoder's blocks over a window, up to its last norm: one place per column of voxels.
    fn decoder_map(
        &self,
        latent: &[f32],
        window: CellRect,
        input: DecoderInput<'_>,
    ) -> Result<B::Tensor, ModelError> {
        check_finite("latent", latent)?;
        let (ops, channels) = (&self.ops, self.config.latent);
        let mut scaled = Vec::with_capacity(window.rows * window.columns * channels);
        for cell in window.cells() {
            let values = latent[cell * channels..][..channels].iter();
            scaled.extend(
                values
                    .zip(&self.latent_std)
                    .zip(&self.latent_mean)
                    .map(|((v, std), mean)| v * std + mean),
            );
        }
        let scaled = ops.upload(FeatureMap {
            data: scaled,
            rows: window.rows,
            columns: window.columns,
            width: channels,
        })?;
        let map = ops.apply(&self.decoder_stem, &scaled, PIECE)?;
        let mut map = self.decoder[0].apply(ops, map)?;
        for (i, (up, level)) in self.up.iter().zip(&self.decoder[1..]).enumerate() {
            map = ops.unfold(&ops.apply(up, &map, PIECE)?)?;
            if let (true, Some(embedding)) = (i + 1 == self.up.len(), &self.input) {
                map = embedding.add_to(ops, map, input, window)?;
            }
            map = level.apply(ops, map)?;
        }
        let normed = ops.norm(&self.decoder_norm, map)?;
        self.check_features(normed)
    }

    /// Checks features, which a latent far outside of the training set may have driven to infinity.
    fn check_features(&self, normed: B::Tensor) -> Result<B::Tensor, ModelError> {
        let map = self.ops.download(normed)?;
        check_finite("decoder features", &map.data)?;
        Ok(self.ops.upload(map)?)
    }
}

/// The decoder's head with the class table multiplied in: logit(class, z) = table(class) . feature(z)
/// + bias(class) is one linear map of a column's channels.
fn head<B: Ops>(ops: &B, w: &mut WeightFile<'_>, width: usize) -> Result<B::Linear, WeightsError> {
    let weight = w.take("decoder_head.weight", &[HEIGHT * FEATURES, width, 1, 1])?;
    let bias = w.take("decoder_head.bias", &[HEIGHT * FEATURES])?;
    let table = w.take("class_table", &[CLASSES, FEATURES])?;
    let class_bias = w.take("class_bias", &[CLASSES])?;
    let mut folded = vec![0.0; CLASSES * HEIGHT * width];
    let mut folded_bias = vec![0.0; CLASSES * HEIGHT];
    for (at, row) in folded.chunks_exact_mut(width).enumerate() {
        let (class, z) = (at / HEIGHT, at % HEIGHT);
        folded_bias[at] = class_bias[class];
        for f in 0..FEATURES {
            let (t, feature) = (table[class * FEATURES + f], z * FEATURES + f);
            folded_bias[at] += t * bias[feature];
            let from = weight[feature * width..][..width].iter();
            row.iter_mut().zip(from).for_each(|(r, v)| *r += t * v);
        }
    }
    ops.linear_from(&folded, folded_bias, width)
        .map_err(|e| w.backend_error(e))
}
