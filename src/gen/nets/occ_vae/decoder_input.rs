//! Additional input of the decoder about the columns that it decodes.

use crate::ModelError;
use crate::encoder::{HEIGHT, VoxelTable};
use nn::Ops;
use nn::map::CellRect;
use nn::weights::{WeightFile, WeightsError};
use scene::{VoxelGrid, Window};

/// Additional input of the decoder about the columns that it decodes.
#[derive(Clone, Copy, Default)]
pub struct DecoderInput<'a> {
    /// The draft of the layout, with the background where that is given.
    pub draft: Option<&'a VoxelGrid>,
    /// Which voxels of a labelled frame were observed ([`Unobserved::observed`]), 200x200.
    ///
    /// [`Unobserved::observed`]: scene::Unobserved::observed
    pub observed: Option<&'a [u32]>,
}

/// The tensors that turn a decoder's input into features of columns.
pub(super) struct InputEmbedding<B: Ops> {
    drafted: VoxelTable<B>,
    observed: B::Table, // one vector per bit
}

impl<B: Ops> InputEmbedding<B> {
    /// Takes the tensors `observed` and `drafted`.
    pub fn new(ops: &B, w: &mut WeightFile<'_>, width: usize) -> Result<Self, WeightsError> {
        let bits = HEIGHT + 1;
        let weight = w.take("observed.weight", &[width, bits])?;
        let turned = (0..bits * width).map(|i| weight[i % width * bits + i / width]);
        let observed = ops.table_from(turned.collect(), width);
        Ok(Self {
            observed: observed.map_err(|e| w.backend_error(e))?,
            drafted: VoxelTable::new(ops, w, "drafted", width)?,
        })
    }

    /// Adds the input to every column of a window; `map` has one place per column.
    pub fn add_to(
        &self,
        ops: &B,
        mut map: B::Tensor,
        input: DecoderInput<'_>,
        window: CellRect,
    ) -> Result<B::Tensor, ModelError> {
        if let Some(draft) = input.draft {
            map = self.drafted.add_to(ops, map, draft, window)?;
        }
        let Some(observed) = input.observed else {
            return Ok(map);
        };
        let corner = [window.x, window.y].map(|cell| cell * (Window::NX / window.side));
        let bits = |row: usize, column: usize| {
            let told = observed[(corner[0] + row) * Window::NY + corner[1] + column];
            (0..HEIGHT + 1).filter(move |bit| told >> bit & 1 == 1)
        };
        Ok(ops.bag(&self.observed, map, bits)?)
    }
}
