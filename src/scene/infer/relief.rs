//! The height of the ground from labels: where ground classes lie above the lowest bin, a slope is read from them.

use crate::{Class, Extent, Relief, VoxelGrid};

/// Share of the ground's columns that must lie higher than flat ground does, or the ground is called flat.
const UNEVEN_SHARE: f64 = 0.03;
/// Height of a kerb, m: a sidewalk lies so much above the road beside it.
const KERB_M: f32 = 0.2;
/// Passes and radius, m, of the smoothing that turns bins into slopes.
const PASSES: usize = 3;
const RADIUS_M: f64 = 1.2;

/// Heights of the ground, m; [`Relief::FLAT`] where all of it lies in the bins of flat ground.
pub fn relief(labels: &VoxelGrid) -> Relief {
    let (extent, lattice) = (labels.extent(), labels.extent().lattice());
    // Bins of flat ground: 0 for a road in the labels of Occ3D.
    let level = lattice.ground_bin(0.0);
    let (mut known, mut uneven, mut ground) = (vec![f32::NAN; extent.columns()], 0, 0);
    for ([x, y], height) in extent.all_columns().zip(&mut known) {
        let column = labels.column(x, y);
        let found = column.iter().enumerate().find_map(|(z, l)| {
            Class::from_id(*l)
                .filter(|class| class.is_ground())
                .map(|class| (z, class))
        });
        let Some((bin, class)) = found else { continue };
        // A road lies in that bin, a sidewalk in it or one higher, a verge may be bumpy.
        let flat_bins = level + usize::from(class != Class::DriveableSurface);
        ground += 1;
        // In the labels of Occ3D nothing lies lower.
        uneven += usize::from(bin > flat_bins || bin + 1 < level);
        let above = if class == Class::Sidewalk && bin > level {
            KERB_M
        } else {
            0.0
        };
        *height = ((bin as f64 - level as f64) * lattice.voxel_m()) as f32 - above;
    }
    if (uneven as f64) < UNEVEN_SHARE * f64::from(ground.max(1)) {
        return Relief::FLAT;
    }
    smooth_relief(extent, &known)
}

/// A relief of heights that are known in some of the columns, `[x][y]`, m, NaN elsewhere: continued from the nearest and smoothed
/// over 3 m.
pub fn smooth_relief(extent: Extent, known_m: &[f32]) -> Relief {
    let mut heights = filled(known_m, extent.nx(), extent.ny());
    for _ in 0..PASSES {
        heights = blurred(extent, &heights);
    }
    Relief::from_heights(extent, heights).unwrap_or_default()
}

/// Unknown cells (NaN) get the mean of what is known around them, from the nearest scale that knows any.
fn filled(cells: &[f32], nx: usize, ny: usize) -> Vec<f32> {
    if cells.iter().all(|v| !v.is_nan()) {
        return cells.to_vec();
    }
    if nx <= 1 && ny <= 1 {
        return vec![0.0; cells.len()]; // nothing is known anywhere
    }
    let (hx, hy) = (nx.div_ceil(2), ny.div_ceil(2));
    let mut coarse = vec![(0.0f32, 0.0f32); hx * hy];
    for (i, v) in cells.iter().enumerate().filter(|(_, v)| !v.is_nan()) {
        let at = &mut coarse[i / ny / 2 * hy + i % ny / 2];
        *at = (at.0 + v, at.1 + 1.0);
    }
    let coarse: Vec<f32> = coarse
        .iter()
        .map(|(sum, n)| if *n > 0.0 { sum / n } else { f32::NAN })
        .collect();
    let coarse = filled(&coarse, hx, hy);
    let pick = |(i, v): (usize, &f32)| match v.is_nan() {
        true => coarse[i / ny / 2 * hy + i % ny / 2],
        false => *v,
    };
    cells.iter().enumerate().map(pick).collect()
}

/// Means over a square around each column.
fn blurred(extent: Extent, heights: &[f32]) -> Vec<f32> {
    let (nx, ny) = (extent.nx(), extent.ny());
    let radius = (RADIUS_M * extent.lattice().per_m()).round() as usize;
    let along = |values: &[f32], stride: usize, n: usize, place: &dyn Fn(usize) -> usize| -> Vec<f32> {
        (0..values.len())
            .map(|i| {
                let at = place(i);
                let (from, to) = (at.saturating_sub(radius), (at + radius).min(n - 1));
                let sum: f32 = (from..=to).map(|k| values[i - at * stride + k * stride]).sum();
                sum / (to - from + 1) as f32
            })
            .collect()
    };
    let rows = along(heights, 1, ny, &|i| i % ny);
    along(&rows, ny, nx, &|i| i / ny)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lattice, Window};
    use glam::DVec2;

    fn sloped(grade: f64, hole: bool) -> VoxelGrid {
        let mut grid = VoxelGrid::new();
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                if hole && (130..150).contains(&x) && (60..90).contains(&y) {
                    continue;
                }
                let p = Window::center(x, y, 0);
                grid.set(
                    x,
                    y,
                    Lattice::OCC3D.ground_bin(grade * p.x),
                    Class::DriveableSurface.id(),
                );
            }
        }
        grid
    }

    #[test]
    fn a_slope_is_read_to_a_quarter_of_a_metre_also_over_a_hole() {
        let found = relief(&sloped(0.06, true));
        for p in [
            DVec2::new(30.0, 0.0),
            DVec2::new(10.0, 20.0),
            DVec2::new(16.0, -10.0),
        ] {
            let error = found.height_m(p) - 0.06 * p.x;
            assert!(error.abs() < 0.25, "{p}: {error}");
        }
    }

    #[test]
    fn flat_ground_and_no_ground_are_flat() {
        assert!(relief(&sloped(0.0, true)).is_flat());
        assert!(relief(&VoxelGrid::new()).is_flat());
        let mut kerb = sloped(0.0, false);
        for x in 0..200 {
            for y in 0..40 {
                kerb.set(x, y, 0, Class::FREE);
                kerb.set(x, y, 1, Class::Sidewalk.id());
            }
        }
        assert!(relief(&kerb).is_flat());
    }
}
