//! Columns of labels that hold one class, and sets of columns: connected, grown, closed.

use glam::DVec2;

use crate::draft::ground_bin;
use crate::{BevLayout, Class, VoxelGrid, Window};

/// Voxels of one class, column by column `[x][y]`, above the ground.
pub(super) struct ClassColumns {
    /// Top of the highest voxel above the ground, m; 0 where there is none.
    pub top_m: Vec<f64>,
    /// Bits of the bins above the ground that hold the class.
    bins: Vec<u16>,
}

impl ClassColumns {
    pub fn from_labels(class: Class, labels: &VoxelGrid, layout: &BevLayout) -> Self {
        let mut out = Self {
            top_m: vec![0.0; Window::COLUMNS],
            bins: vec![0; Window::COLUMNS],
        };
        for c in 0..Window::COLUMNS {
            let (x, y) = (c / Window::NY, c % Window::NY);
            let ground = ground_bin(layout, x, y);
            let column = labels.column(x, y);
            for z in (ground + 1..Window::NZ).filter(|z| column[*z] == class.id()) {
                // Tops are exact; only the undersides of these labels reach down to the ground.
                let top = (z + 1) as f64 * Window::VOXEL_M + Window::MIN_M[2];
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
pub(super) fn middle_m(c: usize) -> DVec2 {
    Window::center(c / Window::NY, c % Window::NY, 0).truncate()
}

/// The columns within `reach` of a column in x and y, itself among them.
pub(super) fn around(c: usize, reach: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (c / Window::NY, c % Window::NY);
    let ys = y.saturating_sub(reach)..=(y + reach).min(Window::NY - 1);
    let xs = x.saturating_sub(reach)..=(x + reach).min(Window::NX - 1);
    xs.flat_map(move |x| ys.clone().map(move |y| x * Window::NY + y))
}

/// Columns that touch each other (8 neighbours), part by part.
pub(super) fn parts(set: &[bool]) -> Vec<Vec<usize>> {
    let mut seen = vec![false; set.len()];
    let mut out = Vec::new();
    for start in 0..set.len() {
        if !set[start] || std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut part = vec![start];
        let mut next = 0;
        while next < part.len() {
            for near in around(part[next], 1) {
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
pub(super) fn closed(set: &[bool], reach: usize) -> Vec<bool> {
    let grown: Vec<bool> = (0..set.len()).map(|c| around(c, reach).any(|n| set[n])).collect();
    let all = |c: usize| around(c, reach).all(|n| grown[n]);
    (0..set.len()).map(|c| set[c] || (grown[c] && all(c))).collect()
}
