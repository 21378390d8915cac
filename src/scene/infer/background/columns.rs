//! Columns of labels that hold one class, and sets of columns: connected, grown, closed.

use glam::DVec2;

use crate::draft::ground_bin;
use crate::{BevLayout, Class, Extent, VoxelGrid};

/// Voxels of one class, column by column `[x][y]`, above the ground.
pub(super) struct ClassColumns {
    /// The map that the columns are of.
    pub map: Extent,
    /// Top of the highest voxel above the ground, m; 0 where there is none.
    pub top_m: Vec<f64>,
    /// Bits of the bins above the ground that hold the class.
    bins: Vec<u64>,
}

impl ClassColumns {
    pub fn from_labels(class: Class, labels: &VoxelGrid, layout: &BevLayout) -> Self {
        let map = labels.extent();
        let mut out = Self {
            map,
            top_m: vec![0.0; map.columns()],
            bins: vec![0; map.columns()],
        };
        for (c, [x, y]) in map.all_columns().enumerate() {
            let ground = ground_bin(layout, x, y);
            let column = labels.column(x, y);
            for z in (ground + 1..map.nz()).filter(|z| column[*z] == class.id()) {
                // Tops are exact; only the undersides of these labels reach down to the ground.
                let top = (z + 1) as f64 * map.voxel_m() + map.min_m().z;
                out.top_m[c] = (top - layout.relief.column_m(x, y)).max(0.1);
                out.bins[c] |= 1 << (z - ground);
            }
        }
        out
    }

    /// Number of voxels in a column.
    pub fn count(&self, c: usize) -> u32 {
        self.bins[c].count_ones()
    }

    /// Number of the four bins above the ground that hold the class.
    pub fn low(&self, c: usize) -> u32 {
        (self.bins[c] >> 1 & 0b1111).count_ones()
    }
}

/// Middle of a column on the ground, m.
pub(super) fn middle_m(map: Extent, c: usize) -> DVec2 {
    let [x, y] = map.column(c);
    map.center(x, y, 0).truncate()
}

/// The columns within `reach` of a column in x and y, itself among them.
pub(super) fn around(map: Extent, c: usize, reach: usize) -> impl Iterator<Item = usize> {
    let [x, y] = map.column(c);
    let ys = y.saturating_sub(reach)..=(y + reach).min(map.ny() - 1);
    let xs = x.saturating_sub(reach)..=(x + reach).min(map.nx() - 1);
    xs.flat_map(move |x| ys.clone().map(move |y| map.index(x, y)))
}

/// Columns that touch each other (8 neighbours), part by part.
pub(super) fn parts(map: Extent, set: &[bool]) -> Vec<Vec<usize>> {
    let mut seen = vec![false; set.len()];
    let mut out = Vec::new();
    for start in 0..set.len() {
        if !set[start] || std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut part = vec![start];
        let mut next = 0;
        while next < part.len() {
            for near in around(map, part[next], 1) {
                if set[near] && !std::mem::replace(&mut seen[near], true) {
                    part.push(near);
                }
            }
            next += 1;
        }
        out.push(part);
    }
    out
}

/// The set with gaps of up to `2 * reach` columns closed: grown, then shrunk again.
pub(super) fn closed(map: Extent, set: &[bool], reach: usize) -> Vec<bool> {
    let grown: Vec<bool> = (0..set.len())
        .map(|c| around(map, c, reach).any(|n| set[n]))
        .collect();
    let all = |c: usize| around(map, c, reach).all(|n| grown[n]);
    (0..set.len()).map(|c| set[c] || (grown[c] && all(c))).collect()
}
