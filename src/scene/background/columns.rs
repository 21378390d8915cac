//! The voxels of a thing, as labels have them.

use std::collections::BTreeMap;

use super::Thing;
use crate::draft::ground_bin;
use crate::solid::fill::{fill, smear_down};
use crate::{BevLayout, Class};

/// Labels by column `[x, y]`; free where a thing leaves a bin alone.
pub type ColumnLabels = BTreeMap<[usize; 2], Vec<u8>>;

impl Thing {
    /// Its voxels in the convention of the lattice, from the ground upward, on the relief of a layout of the same
    /// frame.
    pub fn columns(&self, layout: &BevLayout) -> ColumnLabels {
        let mut solids = Vec::new();
        self.solids(&|p| layout.relief.height_m(p), &mut solids);
        let mut columns = ColumnLabels::new();
        let (extent, lattice) = (layout.extent(), layout.extent().lattice());
        for solid in &solids {
            fill(
                extent,
                solid,
                |_, _| true,
                |x, y, z, _| {
                    let column = columns
                        .entry([x, y])
                        .or_insert_with(|| vec![Class::FREE; lattice.bins()]);
                    column[z] = solid.class.id();
                },
            );
        }
        for ([x, y], column) in &mut columns {
            smear_down(column, lattice.lowered());
            column[..lattice.foot_bin(ground_bin(layout, *x, *y))].fill(Class::FREE);
        }
        columns
    }
}
