//! The encoder of the occupancy VAE up to its last norm: the source of the latents and of the features of F3D.

use rayon::prelude::*;

use super::ModelError;
use nn::Cpu;
use nn::map::{CellRect, FeatureMap};
use nn::ops::{Ops, OpsError};
use nn::weights::{WeightFile, WeightsError};
use scene::{Class, VoxelGrid, Window};

/// Voxels of a column.
pub const HEIGHT: usize = Window::NZ;
/// Classes that are not free; free is the last class.
pub const OCCUPIED: usize = Class::FREE as usize;
/// Places of a map that go through a linear layer in one piece.
pub const PIECE: usize = 200;

/// Residual blocks of one width.
pub struct EncoderLevel<B: Ops = Cpu>(Vec<B::Residual>);

impl<B: Ops> EncoderLevel<B> {
    /// The blocks `name.blocks.0` and so on.
    pub fn new(
        ops: &B,
        w: &mut WeightFile<'_>,
        name: &str,
        width: usize,
        kernels: &[usize],
    ) -> Result<Self, WeightsError> {
        let all = kernels.iter().enumerate();
        let blocks = all.map(|(i, k)| ops.load_residual(w, &format!("{name}.blocks.{i}"), width, *k));
        Ok(Self(blocks.collect::<Result<_, _>>()?))
    }

    /// Applies one block after the other.
    pub fn apply(&self, ops: &B, map: B::Tensor) -> Result<B::Tensor, OpsError> {
        self.0.iter().try_fold(map, |map, block| ops.residual(block, map))
    }

    /// How many places around a changed one may change.
    pub fn reach(&self) -> usize {
        self.0.iter().map(B::reach).sum()
    }
}

/// Levels `name.0` and so on.
pub fn levels<B: Ops>(
    ops: &B,
    w: &mut WeightFile<'_>,
    name: &str,
    widths: &[usize],
    kernels: &[Vec<usize>],
) -> Result<Vec<EncoderLevel<B>>, WeightsError> {
    let each = widths.iter().zip(kernels).enumerate();
    each.map(|(i, (width, kernels))| EncoderLevel::new(ops, w, &format!("{name}.{i}"), *width, kernels))
        .collect()
}

/// Linear layers `name.0` and so on, of these inputs and outputs.
pub fn steps<B: Ops>(
    ops: &B,
    w: &mut WeightFile<'_>,
    name: &str,
    sizes: Vec<[usize; 2]>,
) -> Result<Vec<B::Linear>, WeightsError> {
    let each = sizes.into_iter().enumerate();
    each.map(|(i, sizes)| ops.linear(w, &format!("{name}.{i}"), sizes, &[1, 1]))
        .collect()
}

/// One vector per bin and class.
pub struct VoxelTable<B: Ops = Cpu>(B::Table);

impl<B: Ops> VoxelTable<B> {
    /// Takes the tensor `name.weight`.
    pub fn new(ops: &B, w: &mut WeightFile<'_>, name: &str, width: usize) -> Result<Self, WeightsError> {
        let entries = w.take(&format!("{name}.weight"), &[HEIGHT * OCCUPIED, width])?;
        let table = ops.table_from(entries, width);
        Ok(Self(table.map_err(|e| w.backend_error(e))?))
    }

    /// Adds to every column of a window the sum over its occupied voxels; `map` has one place per column.
    pub fn add_to(
        &self,
        ops: &B,
        map: B::Tensor,
        grid: &VoxelGrid,
        window: CellRect,
    ) -> Result<B::Tensor, ModelError> {
        let per_cell = Window::NX / window.side;
        let corner = [window.x * per_cell, window.y * per_cell];
        let column = |row: usize, column: usize| grid.column(corner[0] + row, corner[1] + column);
        (0..window.rows * per_cell).into_par_iter().try_for_each(|row| {
            for at in 0..window.columns * per_cell {
                let labels = column(row, at);
                if let Some(z) = labels.iter().position(|label| *label > Class::FREE) {
                    let (x, y) = (corner[0] + row, corner[1] + at);
                    let found = labels[z];
                    return Err(ModelError::Label { x, y, z, found });
                }
            }
            Ok(())
        })?;
        let entries = |row: usize, at: usize| {
            let occupied = column(row, at)
                .iter()
                .enumerate()
                .filter(|(_, l)| **l != Class::FREE);
            occupied.map(|(z, label)| z * OCCUPIED + usize::from(*label))
        };
        Ok(ops.bag(&self.0, map, entries)?)
    }
}

/// The encoder: labels to one vector per latent cell.
pub struct OccupancyEncoder<B: Ops = Cpu> {
    width: usize,
    embed: VoxelTable<B>,
    levels: Vec<EncoderLevel<B>>, // finest first
    down: Vec<B::Linear>,
    norm: B::Norm,
}

impl<B: Ops> OccupancyEncoder<B> {
    /// Takes the encoder's tensors of a file; `widths` and `kernels` are of every level, finest first.
    pub fn new(
        ops: &B,
        w: &mut WeightFile<'_>,
        widths: &[usize],
        kernels: &[Vec<usize>],
    ) -> Result<Self, WeightsError> {
        let down = widths.windows(2).map(|p| [4 * p[0], p[1]]).collect();
        Ok(Self {
            width: widths[0],
            embed: VoxelTable::new(ops, w, "embed", widths[0])?,
            levels: levels(ops, w, "encoder", widths, kernels)?,
            down: steps(ops, w, "down", down)?,
            norm: ops.load_norm(w, "encoder_norm", widths[widths.len() - 1])?,
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
    pub fn features(&self, ops: &B, grid: &VoxelGrid, window: CellRect) -> Result<B::Tensor, ModelError> {
        let per_cell = Window::NX / window.side;
        let (rows, columns, width) = (window.rows * per_cell, window.columns * per_cell, self.width);
        let map = ops.upload(FeatureMap {
            data: vec![0.0; rows * columns * width],
            rows,
            columns,
            width,
        })?;
        let map = self.embed.add_to(ops, map, grid, window)?;
        let mut map = self.levels[0].apply(ops, map)?;
        for (down, level) in self.down.iter().zip(&self.levels[1..]) {
            map = level.apply(ops, ops.apply(down, &ops.fold(&map)?, PIECE)?)?;
        }
        Ok(ops.norm(&self.norm, map)?)
    }
}
