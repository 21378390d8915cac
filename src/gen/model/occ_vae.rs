//! Occupancy VAE: 200x200x16 labels to a 50x50x8 latent and back. After UniScene's (design/models.md
//! 5.1), rebuilt for a CPU: an embedding bag, few convolutions, norms that look at one cell only.
//! Twin of `training/models/occ_vae.py`.

use rayon::prelude::*;
use serde::Deserialize;

use super::layers::{Linear, Map, Norm, ResBlock};
use super::{CELLS, CHANNELS, LATENT, ModelError, SIDE, check_finite, check_length, kernels};
use crate::generation::weights::{WeightFile, WeightsError};
use crate::scene::{Class, GridSpec, VoxelGrid};

/// Columns along one side of a cell.
const COLUMNS: usize = GridSpec::NX / SIDE;
/// Voxels of a cell; voxel (dx, dy, z) is number `(dx * 4 + dy) * 16 + z`.
const VOXELS: usize = COLUMNS * COLUMNS * GridSpec::NZ;
/// Numbers per voxel before the class table.
const FEATURES: usize = 8;
/// Cells that are given labels in one piece.
const PIECE_CELLS: usize = 25;
const CLASSES: usize = Class::COUNT;
const OCCUPIED: usize = Class::FREE as usize; // free is the last class

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VaeConfig {
    /// Numbers per latent cell; 8.
    pub latent: usize,
    /// Channels of the encoder.
    pub encoder_width: usize,
    /// Kernel of each encoder block, 1 or 3.
    pub encoder_kernels: Vec<usize>,
    /// Channels of the decoder.
    pub decoder_width: usize,
    /// Kernel of each decoder block, 1 or 3.
    pub decoder_kernels: Vec<usize>,
}

impl VaeConfig {
    fn check(&self) -> Result<(), String> {
        let widths = [self.encoder_width, self.decoder_width];
        let mut kernels = self.encoder_kernels.iter().chain(&self.decoder_kernels);
        if self.latent != CHANNELS {
            Err(format!("latent: expected {CHANNELS}, found {}", self.latent))
        } else if widths.iter().any(|w| !(1..=4096).contains(w)) {
            Err(format!("widths: expected 1 to 4096, found {widths:?}"))
        } else if self.encoder_kernels.len() + self.decoder_kernels.len() > 256 {
            Err("more than 256 blocks".into())
        } else if let Some(k) = kernels.find(|k| ![1, 3].contains(*k)) {
            Err(format!("kernels: expected 1 or 3, found {k}"))
        } else {
            Ok(())
        }
    }
}

/// The network with its weights.
pub struct OccVae {
    config: VaeConfig,
    embed: Vec<f32>, // [voxel][class][encoder_width]
    encoder: Vec<ResBlock>,
    encoder_norm: Norm,
    encoder_head: Linear,
    decoder_stem: Linear,
    decoder: Vec<ResBlock>,
    decoder_norm: Norm,
    decoder_head: Linear,  // outputs ordered [feature][voxel]
    class_table: Vec<f32>, // [class][feature]
    class_bias: Vec<f32>,
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
        let (wide, deep) = (config.encoder_width, config.decoder_width);
        let w = &mut file;
        let blocks = |w: &mut WeightFile<'_>, name: &str, width, kernels: &[usize]| {
            let all = kernels.iter().enumerate();
            all.map(|(i, k)| ResBlock::new(w, &format!("{name}.{i}"), width, *k))
                .collect::<Result<Vec<_>, _>>()
        };
        let mut decoder_head = Linear::new(w, "decoder_head", deep, VOXELS * FEATURES, &[1, 1])?;
        decoder_head.reorder_outputs(|o| o % FEATURES * VOXELS + o / FEATURES);
        let vae = Self {
            embed: w.take("embed.weight", &[VOXELS * OCCUPIED, wide])?,
            encoder: blocks(w, "encoder", wide, &config.encoder_kernels)?,
            encoder_norm: Norm::new(w, "encoder_norm", wide)?,
            encoder_head: Linear::new(w, "encoder_head", wide, 2 * CHANNELS, &[1, 1])?,
            decoder_stem: Linear::new(w, "decoder_stem", CHANNELS, deep, &[1, 1])?,
            decoder: blocks(w, "decoder", deep, &config.decoder_kernels)?,
            decoder_norm: Norm::new(w, "decoder_norm", deep)?,
            decoder_head,
            class_table: w.take("class_table", &[CLASSES, FEATURES])?,
            class_bias: w.take("class_bias", &[CLASSES])?,
            latent_mean: w.take("latent_mean", &[CHANNELS])?,
            latent_std: w.take("latent_std", &[CHANNELS])?,
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

    /// How many cells around an edited one may get another latent.
    pub fn encoder_reach(&self) -> usize {
        self.encoder.iter().map(ResBlock::reach).sum()
    }

    /// How many cells around a changed latent may get other labels.
    pub fn decoder_reach(&self) -> usize {
        self.decoder.iter().map(ResBlock::reach).sum()
    }

    /// The mean latent `[x][y][channel]`, 50x50x8, of zero mean and unit spread over the training set.
    pub fn encode(&self, grid: &VoxelGrid) -> Result<Vec<f32>, ModelError> {
        let mut map = Map {
            data: self.embed_cells(grid)?,
            rows: SIDE,
            columns: SIDE,
            width: self.config.encoder_width,
        };
        for block in &self.encoder {
            block.apply(&mut map);
        }
        let mut normed = vec![0.0; map.data.len()];
        self.encoder_norm.rows(&map.data, &mut normed);
        let moments = self.encoder_head.parallel(&normed, SIDE);
        let mut latent = Vec::with_capacity(LATENT);
        for cell in moments.chunks_exact(2 * CHANNELS) {
            let channels = cell.iter().zip(&self.latent_mean).zip(&self.latent_std);
            latent.extend(channels.map(|((v, mean), std)| (v - mean) / std));
        }
        check_finite("encoded latent", &latent)?;
        Ok(latent)
    }

    /// The sum of one embedding per occupied voxel, for every cell.
    fn embed_cells(&self, grid: &VoxelGrid) -> Result<Vec<f32>, ModelError> {
        let width = self.config.encoder_width;
        let mut out = vec![0.0; CELLS * width];
        out.par_chunks_mut(width)
            .enumerate()
            .try_for_each(|(cell, sum)| {
                let (x0, y0) = (cell / SIDE * COLUMNS, cell % SIDE * COLUMNS);
                for column in 0..COLUMNS * COLUMNS {
                    let (x, y) = (x0 + column / COLUMNS, y0 + column % COLUMNS);
                    for (z, label) in grid.column(x, y).iter().enumerate() {
                        if *label == Class::FREE {
                            continue;
                        }
                        if *label > Class::FREE {
                            return Err(ModelError::Label {
                                x,
                                y,
                                z,
                                found: *label,
                            });
                        }
                        let entry = (column * GridSpec::NZ + z) * OCCUPIED + usize::from(*label);
                        let embedding = &self.embed[entry * width..][..width];
                        sum.iter_mut().zip(embedding).for_each(|(s, e)| *s += e);
                    }
                }
                Ok(())
            })?;
        Ok(out)
    }

    /// The likeliest label of every voxel; the lowest class wins a tie.
    pub fn decode(&self, latent: &[f32]) -> Result<VoxelGrid, ModelError> {
        self.decode_cells(latent, &[true; CELLS])
    }

    /// The same for some of the 2,500 cells; the others stay free. Computes only what those cells
    /// can see, and gives them the labels that [`decode`](Self::decode) gives.
    pub fn decode_cells(&self, latent: &[f32], cells: &[bool]) -> Result<VoxelGrid, ModelError> {
        check_length("cell mask", cells.len(), CELLS)?;
        let mut grid = VoxelGrid::new();
        let Some(window) = Window::around(cells, self.decoder_reach()) else {
            check_length("latent", latent.len(), LATENT)?;
            return Ok(grid);
        };
        let map = self.decoder_map(latent, window)?;
        let wanted: Vec<usize> = window.cells().filter(|c| cells[*c]).collect();
        let pieces = wanted.par_chunks(PIECE_CELLS);
        let labels: Vec<[u8; VOXELS]> = pieces
            .flat_map_iter(|cells| self.label_cells(&map, window, cells))
            .collect();
        for (cell, labels) in wanted.iter().zip(&labels) {
            let (x0, y0) = (cell / SIDE * COLUMNS, cell % SIDE * COLUMNS);
            for (column, labels) in labels.chunks_exact(GridSpec::NZ).enumerate() {
                if labels.iter().any(|l| *l != Class::FREE) {
                    let (x, y) = (x0 + column / COLUMNS, y0 + column % COLUMNS);
                    grid.column_mut(x, y).copy_from_slice(labels);
                }
            }
        }
        Ok(grid)
    }

    /// Class logits `[voxel][class]` of one cell, for tests and uncertainty.
    pub fn logits(&self, latent: &[f32], cell: usize) -> Result<Vec<f32>, ModelError> {
        let mut cells = [false; CELLS];
        cells[cell] = true;
        let Some(window) = Window::around(&cells, self.decoder_reach()) else {
            return Ok(Vec::new());
        };
        let map = self.decoder_map(latent, window)?;
        let features = self.decoder_head.vector(map.cell(window, cell)); // [feature][voxel]
        let mut out = vec![0.0; VOXELS * CLASSES];
        for (voxel, logits) in out.chunks_exact_mut(CLASSES).enumerate() {
            for (class, logit) in logits.iter_mut().enumerate() {
                let row = &self.class_table[class * FEATURES..][..FEATURES];
                let dot: f32 = row
                    .iter()
                    .enumerate()
                    .map(|(f, t)| t * features[f * VOXELS + voxel])
                    .sum();
                *logit = dot + self.class_bias[class];
            }
        }
        Ok(out)
    }

    /// The decoder's blocks over a window, up to its last norm.
    fn decoder_map(&self, latent: &[f32], window: Window) -> Result<Map, ModelError> {
        check_length("latent", latent.len(), LATENT)?;
        check_finite("latent", latent)?;
        let mut scaled = Vec::with_capacity(window.rows * window.columns * CHANNELS);
        for cell in window.cells() {
            let values = latent[cell * CHANNELS..][..CHANNELS].iter();
            scaled.extend(
                values
                    .zip(&self.latent_std)
                    .zip(&self.latent_mean)
                    .map(|((v, std), mean)| v * std + mean),
            );
        }
        let mut map = Map {
            data: self.decoder_stem.parallel(&scaled, SIDE),
            rows: window.rows,
            columns: window.columns,
            width: self.config.decoder_width,
        };
        for block in &self.decoder {
            block.apply(&mut map);
        }
        let mut normed = vec![0.0; map.data.len()];
        self.decoder_norm.rows(&map.data, &mut normed);
        check_finite("decoder features", &normed)?;
        map.data = normed;
        Ok(map)
    }

    /// Labels of a few cells: one product with the decoder's head for all of them.
    fn label_cells(&self, map: &Map, window: Window, cells: &[usize]) -> Vec<[u8; VOXELS]> {
        let rows: Vec<f32> = cells.iter().flat_map(|c| map.cell(window, *c)).copied().collect();
        let mut features = vec![0.0; cells.len() * VOXELS * FEATURES];
        self.decoder_head.rows(&rows, &mut features);
        // Weights and normed features are finite and small, so no logit can be NaN.
        let label = |features: &[f32]| {
            let mut labels = [0; VOXELS];
            kernels::likeliest(features, &self.class_table, &self.class_bias, &mut labels);
            labels
        };
        features.chunks_exact(VOXELS * FEATURES).map(label).collect()
    }
}

/// A rectangle of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    x: usize,
    y: usize,
    rows: usize,
    columns: usize,
}

impl Window {
    /// The wanted cells and `reach` more on every side, cut to the map; `None` if none is wanted.
    fn around(cells: &[bool], reach: usize) -> Option<Self> {
        let wanted = || (0..CELLS).filter(|c| cells[*c]);
        let (x0, x1) = (
            wanted().map(|c| c / SIDE).min()?,
            wanted().map(|c| c / SIDE).max()?,
        );
        let (y0, y1) = (
            wanted().map(|c| c % SIDE).min()?,
            wanted().map(|c| c % SIDE).max()?,
        );
        let (x, y) = (x0.saturating_sub(reach), y0.saturating_sub(reach));
        let (x_end, y_end) = ((x1 + reach + 1).min(SIDE), (y1 + reach + 1).min(SIDE));
        Some(Self {
            x,
            y,
            rows: x_end - x,
            columns: y_end - y,
        })
    }

    fn cells(self) -> impl Iterator<Item = usize> {
        (self.x..self.x + self.rows)
            .flat_map(move |x| (self.y..self.y + self.columns).map(move |y| x * SIDE + y))
    }
}

impl Map {
    fn cell(&self, window: Window, cell: usize) -> &[f32] {
        let (x, y) = (cell / SIDE - window.x, cell % SIDE - window.y);
        &self.data[(x * self.columns + y) * self.width..][..self.width]
    }
}
