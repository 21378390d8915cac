//! Occupancy VAE: 200x200x16 labels to a latent of 50x50x8 (or 100x100x16, the fine one) and back. After
//! UniScene's (design/models.md 5.1), rebuilt for a CPU: an embedding bag, columns that share their weights
//! at two or three levels of the top view (0.4, 0.8, 1.6 m), norms that look at one place only. Twin of
//! `training/models/occ_vae.py`.

use rayon::prelude::*;
use serde::Deserialize;

use super::encoder::{Encoder, HEIGHT, Level, PIECE, VoxelTable, levels, steps, through};
use super::{ModelError, check_finite, check_length};
use crate::pieces::pieces;
use nn::kernels;
use nn::layers::{Linear, Norm};
use nn::map::{Map, Window};
use nn::weights::{WeightFile, WeightsError};
use numeric::philox::{self, Stream};
use scene::{Class, GridSpec, VoxelGrid};

/// Numbers per voxel before the class table.
const FEATURES: usize = 8;
const CLASSES: usize = Class::COUNT;
/// Bounds of the encoder's log variance: beyond them exp leaves f32.
const LOG_VARIANCE: [f32; 2] = [-30.0, 20.0];

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VaeConfig {
    /// Numbers per latent cell.
    pub latent: usize,
    /// Channels at 0.4, 0.8 and (if latent cells are that large) 1.6 m.
    pub widths: Vec<usize>,
    /// Kernels (1 or 3) of the encoder's blocks at every level, finest first.
    pub encoder_kernels: Vec<Vec<usize>>,
    /// Kernels (1 or 3) of the decoder's blocks at every level, coarsest first.
    pub decoder_kernels: Vec<Vec<usize>>,
    /// The decoder hears the draft of the layout, and which voxels were observed.
    #[serde(default)]
    pub hears: bool,
}

/// What the decoder is told of the columns that it decodes.
#[derive(Clone, Copy, Default)]
pub struct Heard<'a> {
    /// The draft of the layout, with the background where that is given.
    pub draft: Option<&'a VoxelGrid>,
    /// Which voxels of a labelled frame were observed ([`Unobserved::observed`]), 200x200.
    ///
    /// [`Unobserved::observed`]: scene::Unobserved::observed
    pub observed: Option<&'a [u32]>,
}

impl VaeConfig {
    fn check(&self) -> Result<(), String> {
        let kernels = || self.encoder_kernels.iter().chain(&self.decoder_kernels).flatten();
        let levels = self.widths.len();
        if !(1..=64).contains(&self.latent) {
            Err(format!("latent: expected 1 to 64, found {}", self.latent))
        } else if !(2..=3).contains(&levels) {
            Err(format!("widths: expected 2 or 3 levels, found {levels}"))
        } else if [&self.encoder_kernels, &self.decoder_kernels]
            .iter()
            .any(|k| k.len() != levels)
        {
            Err(format!("kernels: expected {levels} levels, as many as widths"))
        } else if self.widths.iter().any(|w| !(1..=4096).contains(w)) {
            Err(format!("widths: expected 1 to 4096, found {:?}", self.widths))
        } else if kernels().count() > 256 {
            Err("more than 256 blocks".into())
        } else if let Some(k) = kernels().find(|k| ![1, 3].contains(*k)) {
            Err(format!("kernels: expected 1 or 3, found {k}"))
        } else {
            Ok(())
        }
    }

    /// Latent cells along one side of the map.
    pub fn side(&self) -> usize {
        GridSpec::NX >> (self.widths.len() - 1)
    }
}

/// The network with its weights.
pub struct OccVae {
    config: VaeConfig,
    encoder: Encoder,
    encoder_head: Linear,
    decoder_stem: Linear,
    decoder: Vec<Level>, // coarsest first
    up: Vec<Linear>,
    ears: Option<Ears>,
    decoder_norm: Norm,
    decoder_head: Linear, // with the class table multiplied in: logits of a column, [class][z]
    latent_mean: Vec<f32>,
    latent_std: Vec<f32>,
}

impl OccVae {
    /// Takes all tensors of the file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn new(mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: VaeConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (widths, latent) = (config.widths.clone(), config.latent);
        let (fine, coarse) = (widths[0], widths[widths.len() - 1]);
        let upwards: Vec<usize> = widths.iter().rev().copied().collect();
        let w = &mut file;
        let vae = Self {
            encoder: Encoder::new(w, &widths, &config.encoder_kernels)?,
            encoder_head: Linear::new(w, "encoder_head", coarse, 2 * latent, &[1, 1])?,
            decoder_stem: Linear::new(w, "decoder_stem", latent, coarse, &[1, 1])?,
            decoder: levels(w, "decoder", &upwards, &config.decoder_kernels)?,
            up: steps(w, "up", upwards.windows(2).map(|p| (p[0], 4 * p[1])).collect())?,
            ears: match config.hears {
                true => Some(Ears::new(w, fine)?),
                false => None,
            },
            decoder_norm: Norm::new(w, "decoder_norm", fine)?,
            decoder_head: head(w, fine)?,
            latent_mean: w.take("latent_mean", &[latent])?,
            latent_std: w.take("latent_std", &[latent])?,
            config,
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
        GridSpec::NX / self.config.side()
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
        Ok(self.encode_window(grid, Window::whole(self.config.side()))?.0)
    }

    /// A latent drawn from the encoder's normal distribution, as training sees them; the same seed gives the
    /// same latent.
    pub fn encode_sampled(&self, grid: &VoxelGrid, seed: u64) -> Result<Vec<f32>, ModelError> {
        let (mut latent, spread) = self.encode_window(grid, Window::whole(self.config.side()))?;
        let noise = philox::normal_field(seed, Stream::Encoder, self.cells(), self.config.latent);
        for ((value, spread), noise) in latent.iter_mut().zip(&spread).zip(&noise) {
            *value += spread * *noise as f32;
        }
        Ok(latent)
    }

    /// Renews the latents of some cells, those that [`encode`](Self::encode) would give; the others stay.
    /// Computes only what those cells can see.
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
            let Some(window) = Window::around(&cells, reach) else {
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
        window: Window,
    ) -> Result<(Vec<f32>, Vec<f32>), ModelError> {
        let channels = self.config.latent;
        let features = self.encoder.features(grid, window)?;
        let moments = self.encoder_head.parallel(&features.data, PIECE);
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

    /// The same for some of the cells; the others stay free. Computes only what those cells
    /// can see, and gives them the labels that [`decode`](Self::decode) gives.
    pub fn decode_cells(&self, latent: &[f32], cells: &[bool]) -> Result<VoxelGrid, ModelError> {
        self.decode_told(latent, cells, Heard::default())
    }

    /// The same where more is known of the columns; networks that do not listen decode as without.
    pub fn decode_told(
        &self,
        latent: &[f32],
        cells: &[bool],
        heard: Heard<'_>,
    ) -> Result<VoxelGrid, ModelError> {
        check_length("cell mask", cells.len(), self.cells())?;
        check_length("latent", latent.len(), self.cells() * self.config.latent)?;
        if let Some(observed) = heard.observed {
            check_length("observed columns", observed.len(), GridSpec::COLUMNS)?;
        }
        let mut grid = VoxelGrid::new();
        let reach = self.decoder_reach();
        for cells in pieces(cells, reach) {
            if let Some(window) = Window::around(&cells, reach) {
                let map = self.decoder_map(latent, window, heard)?;
                self.labels_of(&map, &cells, window, &mut grid);
            }
        }
        Ok(grid)
    }

    /// Puts the labels of the wanted cells of a window into a grid.
    fn labels_of(&self, map: &Map, cells: &[bool], window: Window, grid: &mut VoxelGrid) {
        let (side, per_cell) = (self.config.side(), self.columns());
        let wanted: Vec<usize> = window.cells().filter(|c| cells[*c]).collect();
        let labels: Vec<Vec<u8>> = wanted
            .par_iter()
            .map(|cell| {
                let mut labels = vec![0; per_cell * per_cell * HEIGHT];
                let logits = self.cell_logits(map, window, *cell);
                let columns = logits
                    .chunks_exact(CLASSES * HEIGHT)
                    .zip(labels.chunks_exact_mut(HEIGHT));
                // Weights and normed features are finite and small, so no logit can be NaN.
                columns.for_each(|(logits, labels)| kernels::likeliest(logits, labels));
                labels
            })
            .collect();
        for (cell, labels) in wanted.iter().zip(&labels) {
            let (x0, y0) = (cell / side * per_cell, cell % side * per_cell);
            for (column, labels) in labels.chunks_exact(HEIGHT).enumerate() {
                if labels.iter().any(|l| *l != Class::FREE) {
                    let (x, y) = (x0 + column / per_cell, y0 + column % per_cell);
                    grid.column_mut(x, y).copy_from_slice(labels);
                }
            }
        }
    }

    /// Class logits `[dx][dy][z][class]` of one cell, for tests and uncertainty.
    pub fn logits(&self, latent: &[f32], cell: usize, heard: Heard<'_>) -> Result<Vec<f32>, ModelError> {
        let mut cells = vec![false; self.cells()];
        cells[cell] = true;
        check_length("latent", latent.len(), self.cells() * self.config.latent)?;
        let Some(window) = Window::around(&cells, self.decoder_reach()) else {
            return Ok(Vec::new());
        };
        let map = self.decoder_map(latent, window, heard)?;
        let logits = self.cell_logits(&map, window, cell);
        let columns = logits.chunks_exact(CLASSES * HEIGHT);
        Ok(columns
            .flat_map(|column| (0..HEIGHT * CLASSES).map(|i| column[i % CLASSES * HEIGHT + i / CLASSES]))
            .collect())
    }

    /// The decoder's blocks over a window, up to its last norm: one place per column of voxels.
    fn decoder_map(&self, latent: &[f32], window: Window, heard: Heard<'_>) -> Result<Map, ModelError> {
        check_finite("latent", latent)?;
        let channels = self.config.latent;
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
        let mut map = Map {
            data: self.decoder_stem.parallel(&scaled, PIECE),
            rows: window.rows,
            columns: window.columns,
            width: self.config.widths[self.config.widths.len() - 1],
        };
        self.decoder[0].apply(&mut map);
        for (i, (up, level)) in self.up.iter().zip(&self.decoder[1..]).enumerate() {
            map = through(up, &map).unfold();
            if let (true, Some(ears)) = (i + 1 == self.up.len(), &self.ears) {
                ears.add_to(&mut map, heard, window)?;
            }
            level.apply(&mut map);
        }
        let mut normed = vec![0.0; map.data.len()];
        normed
            .par_chunks_mut(PIECE * map.width)
            .zip(map.data.par_chunks(PIECE * map.width))
            .for_each(|(out, x)| self.decoder_norm.rows(x, out));
        check_finite("decoder features", &normed)?;
        map.data = normed;
        Ok(map)
    }

    /// Logits `[dx][dy][class][z]` of a cell of the window.
    fn cell_logits(&self, map: &Map, window: Window, cell: usize) -> Vec<f32> {
        let (side, per_cell) = (self.config.side(), self.columns());
        let (x, y) = (
            (cell / side - window.x) * per_cell,
            (cell % side - window.y) * per_cell,
        );
        let mut columns = Vec::with_capacity(per_cell * per_cell * map.width);
        for dx in 0..per_cell {
            let from = ((x + dx) * map.columns + y) * map.width;
            columns.extend_from_slice(&map.data[from..from + per_cell * map.width]);
        }
        let mut logits = vec![0.0; per_cell * per_cell * CLASSES * HEIGHT];
        self.decoder_head.rows(&columns, &mut logits);
        logits
    }
}

/// What the decoder's columns hear.
struct Ears {
    drafted: VoxelTable,
    observed: Vec<f32>, // [bit][width]
}

impl Ears {
    fn new(w: &mut WeightFile<'_>, width: usize) -> Result<Self, WeightsError> {
        let bits = HEIGHT + 1;
        let weight = w.take("observed.weight", &[width, bits])?;
        Ok(Self {
            drafted: VoxelTable::new(w, "drafted", width)?,
            observed: (0..bits * width)
                .map(|i| weight[i % width * bits + i / width])
                .collect(),
        })
    }

    fn add_to(&self, map: &mut Map, heard: Heard<'_>, window: Window) -> Result<(), ModelError> {
        if let Some(draft) = heard.draft {
            self.drafted.add_to(map, draft, window)?;
        }
        let Some(observed) = heard.observed else {
            return Ok(());
        };
        let (width, wide) = (map.width, map.columns);
        let corner = [window.x, window.y].map(|cell| cell * (GridSpec::NX / window.side));
        map.data
            .par_chunks_mut(wide * width)
            .enumerate()
            .for_each(|(row, columns)| {
                let told = &observed[(corner[0] + row) * GridSpec::NY + corner[1]..][..wide];
                for (values, told) in columns.chunks_exact_mut(width).zip(told) {
                    let bits = self.observed.chunks_exact(width).enumerate();
                    for (_, adds) in bits.filter(|(bit, _)| told >> bit & 1 == 1) {
                        values.iter_mut().zip(adds).for_each(|(v, a)| *v += a);
                    }
                }
            });
        Ok(())
    }
}

/// The decoder's head with the class table multiplied in: logit(class, z) = table(class) . feature(z)
/// + bias(class) is one linear map of a column's channels.
fn head(w: &mut WeightFile<'_>, width: usize) -> Result<Linear, WeightsError> {
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
    Ok(Linear::from_parts(&folded, folded_bias, width))
}
