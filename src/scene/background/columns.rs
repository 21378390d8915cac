//! The voxels of a thing, as labels have them.

use std::collections::BTreeMap;

use super::Thing;
use crate::draft::ground_bin;
use crate::solid::fill::{fill, smear_down};
use crate::{BevLayout, Class, Extent};

/// Labels by column `[x, y]`; free where a thing leaves a bin alone.
pub type ColumnLabels = BTreeMap<[usize; 2], [u8; Extent::NZ]>;

impl Thing {
    /// Its voxels in the Occ3D convention, from the bin of the ground upward, on the relief of a layout of the same
    /// frame.
    pub fn columns(&self, layout: &BevLayout) -> ColumnLabels {
        let mut solids = Vec::new();
        self.solids(&|p| layout.relief.height_m(p), &mut solids);
        let mut columns = ColumnLabels::new();
        for solid in &solids {
            fill(
                layout.extent(),
                solid,
                |_, _| true,
                |x, y, z, _| {
                    let column = columns.entry([x, y]).or_insert([Class::FREE; Extent::NZ]);
                    column[z] = solid.class.id();
                },
            );
        }
        for ([x, y], column) in &mut columns {
            smear_down(column);
            column[..ground_bin(layout, *x, *y)].fill(Class::FREE);
        }
        columns
    }
}
