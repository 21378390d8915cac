//! Solids to voxels: which voxels of a map a solid fills, and how much of each.

use glam::DVec3;

use super::Solid;
use crate::{Class, Extent};

/// Labels are extended downward by so many bins in the Occ3D convention.
pub const SMEAR: usize = 2;

/// Extends what stands in a column of any height downward by [`SMEAR`] bins, as far as there is free space: the Occ3D
/// convention.
pub fn smear_down<const BINS: usize>(column: &mut [u8; BINS]) {
    let solid = *column;
    for (z, class) in solid.iter().enumerate().filter(|(_, c)| **c != Class::FREE) {
        for down in 1..=SMEAR.min(z) {
            if solid[z - down] != Class::FREE {
                break;
            }
            column[z - down] = *class;
        }
    }
}

/// Sub-voxel samples along each axis.
const SAMPLES: usize = 3;
/// Samples at the corners of a voxel, and in its middle.
const CORNERS: [usize; 8] = [0, 2, 6, 8, 18, 20, 24, 26];
const MIDDLE: usize = 13;
/// Half width below which a pole or plate could pass between the samples, m.
const THINNEST_M: f64 = 0.095;
/// Samples in a voxel that make it the solid's, of 27: a third.
const NEEDED: u8 = 9;

/// Visits every voxel that the solid fills, with the number of the voxel's 27 samples inside it: those a third full, or
/// touched at all if the solid is thinner than a voxel. `column` says which columns count.
pub fn fill(
    extent: Extent,
    solid: &Solid,
    mut column: impl FnMut(usize, usize) -> bool,
    mut visit: impl FnMut(usize, usize, usize, u8),
) {
    let solid = &solid.at_least(THINNEST_M);
    let reach = solid.reach();
    let lo = extent.to_voxel_units(solid.center - reach);
    let hi = extent.to_voxel_units(solid.center + reach);
    let n = extent.shape();
    let span = |axis: usize| {
        (lo[axis].floor().max(0.0) as usize)..(hi[axis].ceil().clamp(0.0, n[axis] as f64) as usize)
    };
    let thin = reach.min_element() < Extent::VOXEL_M * 0.75;
    let needed = if thin { 1 } else { NEEDED };
    for x in span(0) {
        for y in span(1) {
            if !column(x, y) {
                continue;
            }
            for z in span(2) {
                let sample = |i: usize| {
                    let f = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
                    let u = DVec3::new(
                        x as f64 + f(i % SAMPLES),
                        y as f64 + f(i / SAMPLES % SAMPLES),
                        z as f64 + f(i / SAMPLES.pow(2)),
                    );
                    u8::from(solid.contains(extent.from_voxel_units(u)))
                };
                let corners: u8 = CORNERS.map(sample).iter().sum();
                // Without pores a voxel whose corners are all inside is full; a third of one needs a corner or the middle.
                let votes = match corners {
                    8 if solid.porosity <= 0.0 => 27,
                    0 if !thin && solid.porosity <= 0.0 && sample(MIDDLE) == 0 => 0,
                    _ => {
                        corners
                            + (0..SAMPLES.pow(3))
                                .filter(|i| !CORNERS.contains(i))
                                .map(sample)
                                .sum::<u8>()
                    }
                };
                if votes >= needed {
                    visit(x, y, z, votes);
                }
            }
        }
    }
}
