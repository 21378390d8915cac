//! The encoder of the occupancy VAE up to its last norm: what the latents, and the features of F3D, are made from.

use rayon::prelude::*;

use super::ModelError;
use nn::layers::{Linear, Norm, ResBlock};
use nn::map::{Map, Window};
use nn::weights::{WeightFile, WeightsError};
use scene::{Class, GridSpec, VoxelGrid};

/// Voxels of a column.
pub const HEIGHT: usize = GridSpec::NZ;
/// Classes that are not free; free is the last class.
pub const OCCUPIED: usize = Class::FREE as usize;
/// Rows of a map that go through a linear layer in one piece.
pub const PIECE: usize = 200;

/// Residual blocks of one width.
pub struct Level(Vec<ResBlock>);

impl Level {
    /// The blocks `name.blocks.0` and so on.
    pub fn new(
        w: &mut WeightFile<'_>,
        name: &str,
        width: usize,
        kernels: &[usize],
    ) -> Result<Self, WeightsError> {
        let all = kernels.iter().enumerate();
        let blocks = all.map(|(i, k)| ResBlock::new(w, &format!("{name}.blocks.{i}"), width, *k));
        Ok(Self(blocks.collect::<Result<_, _>>()?))
    }

    /// In place.
    pub fn apply(&self, map: &mut Map) {
        self.0.iter().for_each(|block| block.apply(map));
    }

    /// How many places around a changed one may change.
    pub fn reach(&self) -> usize {
        self.0.iter().map(ResBlock::reach).sum()
    }
}

/// Levels `name.0` and so on.
pub fn levels(
    w: &mut WeightFile<'_>,
    name: &str,
    widths: &[usize],
    kernels: &[Vec<usize>],
) -> Result<Vec<Level>, WeightsError> {
    let each = widths.iter().zip(kernels).enumerate();
    each.map(|(i, (width, kernels))| Level::new(w, &format!("{name}.{i}"), *width, kernels))
        .collect()
}

/// Linear layers `name.0` and so on, of these inputs and outputs.
pub fn steps(
    w: &mut WeightFile<'_>,
    name: &str,
    sizes: Vec<(usize, usize)>,
) -> Result<Vec<Linear>, WeightsError> {
    let each = sizes.into_iter().enumerate();
    each.map(|(i, (from, to))| Linear::new(w, &format!("{name}.{i}"), from, to, &[1, 1]))
        .collect()
}

/// One vector per bin and class.
pub struct VoxelTable {
    width: usize,
    entries: Vec<f32>, // [z][class][width]
}

impl VoxelTable {
    /// Takes the tensor `name.weight`.
    pub fn new(w: &mut WeightFile<'_>, name: &str, width: usize) -> Result<Self, WeightsError> {
        Ok(Self {
            width,
            entries: w.take(&format!("{name}.weight"), &[HEIGHT * OCCUPIED, width])?,
        })
    }

    /// Adds to every column of a window the sum over its occupied voxels; `map` has one place per column.
    pub fn add_to(&self, map: &mut Map, grid: &VoxelGrid, window: Window) -> Result<(), ModelError> {
        let width = self.width;
        let corner = [window.x, window.y].map(|cell| cell * (GridSpec::NX / window.side));
        let wide = map.columns * width;
        map.data
            .par_chunks_mut(wide)
            .enumerate()
            .try_for_each(|(row_index, row)| {
                for (column_index, sum) in row.chunks_exact_mut(width).enumerate() {
                    let (x, y) = (corner[0] + row_index, corner[1] + column_index);
                    for (z, label) in grid.column(x, y).iter().enumerate() {
                        if *label == Class::FREE {
                            continue;
                        }
                        if *label > Class::FREE {
                            let found = *label;
                            return Err(ModelError::Label { x, y, z, found });
                        }
                        let entry = z * OCCUPIED + usize::from(*label);
                        let vector = &self.entries[entry * width..][..width];
                        sum.iter_mut().zip(vector).for_each(|(s, e)| *s += e);
                    }
                }
                Ok(())
            })
    }
}

/// Labels to one vector per latent cell.
pub struct Encoder {
    embed: VoxelTable,
    levels: Vec<Level>, // finest first
    down: Vec<Linear>,
    norm: Norm,
}

impl Encoder {
    /// Takes the encoder's tensors of a file; `widths` and `kernels` are of every level, finest first.
    pub fn new(
        w: &mut WeightFile<'_>,
        widths: &[usize],
        kernels: &[Vec<usize>],
    ) -> Result<Self, WeightsError> {
        Ok(Self {
            embed: VoxelTable::new(w, "embed", widths[0])?,
            levels: levels(w, "encoder", widths, kernels)?,
            down: steps(w, "down", widths.windows(2).map(|p| (4 * p[0], p[1])).collect())?,
            norm: Norm::new(w, "encoder_norm", widths[widths.len() - 1])?,
        })
    }

    /// How many cells around an edited one may get other features.
    pub fn reach(&self) -> usize {
        let (finest, rest) = self.levels.split_first().expect("two levels or more");
        // From the last column of a cell outwards.
        let first = (1 << rest.len()) - 1 + finest.reach();
        rest.iter().fold(first, |reach, level| reach / 2 + level.reach())
    }

    /// Features of the cells of a window, as if nothing were around it.
    pub fn features(&self, grid: &VoxelGrid, window: Window) -> Result<Map, ModelError> {
        let per_cell = GridSpec::NX / window.side;
        let (rows, columns, width) = (
            window.rows * per_cell,
            window.columns * per_cell,
            self.embed.width,
        );
        let mut map = Map {
            data: vec![0.0; rows * columns * width],
            rows,
            columns,
            width,
        };
        self.embed.add_to(&mut map, grid, window)?;
        self.levels[0].apply(&mut map);
        for (down, level) in self.down.iter().zip(&self.levels[1..]) {
            map = through(down, &map.fold());
            level.apply(&mut map);
        }
        let mut normed = vec![0.0; map.data.len()];
        self.norm.rows(&map.data, &mut normed);
        map.data = normed;
        Ok(map)
    }
}

/// A linear layer at every place of a map.
pub fn through(linear: &Linear, map: &Map) -> Map {
    let data = linear.parallel(&map.data, PIECE);
    Map {
        width: data.len() / (map.rows * map.columns),
        data,
        ..*map
    }
}
