//! A scene drawn anew in voxels of another size.

use std::sync::Arc;

use super::{Class, Lattice, Scene, SourceFrame, VoxelPaint, draft};

impl Scene {
    /// The scene in another lattice, its ground, things and boxes drawn in voxels of that size. Voxels that none of these explains
    /// are left out. The scene as it is if it has that lattice. The revisions are new.
    pub fn drawn_in(&self, lattice: Lattice) -> Scene {
        if self.frame().extent().lattice() == lattice {
            return self.clone();
        }
        let mut scene = self.in_lattice(lattice).into_owned();
        let background = scene.background.clone();
        scene.change_canvas(|frame| {
            let mut grid = draft::draft(&frame.layout, std::iter::empty());
            for thing in background.iter() {
                for ([x, y], labels) in thing.columns(&frame.layout) {
                    put(grid.column_mut(x, y), &labels);
                }
            }
            frame.boxes.values().for_each(|b| draft::stamp_box(&mut grid, b));
            frame.source = Arc::new(SourceFrame {
                layout: frame.layout.clone(),
                boxes: frame.boxes.clone(),
                occupancy: grid.clone(),
            });
            frame.painted = VoxelPaint::over(frame.layout.extent());
            frame.occupancy = grid;
        });
        scene
    }
}

fn put(column: &mut [u8], labels: &[u8]) {
    for (at, label) in column.iter_mut().zip(labels) {
        if *label != Class::FREE {
            *at = *label;
        }
    }
}

/// The lattice of a new scene: that of Occ3D, or one of other voxels that begins about 1 m below the road, at a whole voxel. As
/// high as that of Occ3D if the number of bins is left out, as far as there may be so many. Errors in one line on numbers out of
/// range, and without room for what stands on the road.
pub fn new_lattice(voxel_m: f64, bins: Option<usize>) -> Result<Lattice, String> {
    const BELOW_M: f64 = 1.0;
    const LEAST_ABOVE_M: f64 = 3.0;
    let height_m = Lattice::OCC3D.top_m() - Lattice::OCC3D.bottom_m();
    let usual = (height_m / voxel_m).ceil().clamp(1.0, Lattice::MAX_BINS as f64);
    let bins = bins.unwrap_or(usual as usize);
    if voxel_m == Lattice::OCC3D.voxel_m() && bins == Lattice::OCC3D.bins() {
        return Ok(Lattice::OCC3D);
    }
    let bins_below = (BELOW_M / voxel_m).round();
    let lattice = Lattice::new(voxel_m, bins, -bins_below * voxel_m)?;
    match lattice.top_m() >= LEAST_ABOVE_M {
        true => Ok(lattice),
        false => Err(format!(
            "{bins} bins of {voxel_m} m end {:.1} m above the ground, expected {LEAST_ABOVE_M} m or more",
            lattice.top_m()
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattices_have_room_above_the_ground() {
        assert_eq!(new_lattice(0.4, None), Ok(Lattice::OCC3D));
        let lattice = new_lattice(0.2, Some(40)).expect("sound");
        assert_eq!((lattice.bottom_m(), lattice.top_m()), (-1.0, 7.0));
        let usual = new_lattice(0.2, None).expect("sound");
        assert_eq!((usual.bins(), usual.top_m()), (32, 5.4));
        assert!(
            new_lattice(0.2, Some(15))
                .is_err_and(|line| line.starts_with("15 bins of 0.2 m end 2.0 m above"))
        );
        for (voxel_m, bins) in [(0.0, 16), (f64::NAN, 16), (0.2, 0), (0.2, 65), (1e99, 16)] {
            assert!(new_lattice(voxel_m, Some(bins)).is_err(), "{voxel_m}, {bins}");
        }
    }
}
