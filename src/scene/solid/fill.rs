//! Solids to voxels: the voxels of a map that a solid fills, and how much of each.

use glam::DVec3;

use super::Solid;
use crate::{Class, Extent, Lattice};

/// Number of bins by which labels are extended downward in the Occ3D convention.
pub const SMEAR: usize = Lattice::OCC3D.lowered();

/// Extends the labels in a column of any height downward by a number of bins, as far as there is free space: with
/// [`SMEAR`], the Occ3D convention.
pub fn smear_down(column: &mut [u8], bins: usize) {
    // From below: what is filled lies under the voxel that it comes from and is not looked at again.
    for z in 0..column.len() {
        let class = column[z];
        if class == Class::FREE {
            continue;
        }
        for down in 1..=bins.min(z) {
            if column[z - down] != Class::FREE {
                break;
            }
            column[z - down] = class;
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
/// Samples of a voxel, of 27, that must be inside for the voxel to be the solid's: a third.
const NEEDED: u8 = 9;

/// Visits every voxel that the solid fills, with the number of the voxel's 27 samples inside it: voxels a third full,
/// or touched at all if the solid is thinner than a voxel. `column` is true for columns that count.
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
    let thin = reach.min_element() < extent.voxel_m() * 0.75;
    let needed = if thin { 1 } else { NEEDED };
    // Samples are `x + 3 y + 9 z`; their places in voxel units.
    let place = |x: usize, y: usize, z: usize, i: usize| {
        let f = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
        let within = DVec3::new(f(i % SAMPLES), f(i / SAMPLES % SAMPLES), f(i / SAMPLES.pow(2)));
        extent.from_voxel_units(DVec3::new(x as f64, y as f64, z as f64) + within)
    };
    let upright = solid.is_upright();
    for x in span(0) {
        for y in span(1) {
            if !column(x, y) {
                continue;
            }
            let footprint = upright.then(|| {
                let inside = |i: usize| solid.contains(place(x, y, 0, i).truncate().extend(solid.center.z));
                std::array::from_fn::<bool, { SAMPLES * SAMPLES }, _>(inside)
            });
            if footprint == Some([false; SAMPLES * SAMPLES]) {
                continue;
            }
            for z in span(2) {
                let votes = match &footprint {
                    Some(footprint) => {
                        let level = |k: usize| solid.spans(place(x, y, z, k * SAMPLES.pow(2)).z);
                        let levels: [bool; SAMPLES] = std::array::from_fn(level);
                        votes(solid, thin, |i| {
                            footprint[i % footprint.len()] && levels[i / footprint.len()]
                        })
                    }
                    None => votes(solid, thin, |i| solid.contains(place(x, y, z, i))),
                };
                if votes >= needed {
                    visit(x, y, z, votes);
                }
            }
        }
    }
}

/// Number of a voxel's 27 samples that are inside.
fn votes(solid: &Solid, thin: bool, inside: impl Fn(usize) -> bool) -> u8 {
    let sample = |i: usize| u8::from(inside(i));
    let corners: u8 = CORNERS.map(sample).iter().sum();
    // In a solid without pores a voxel whose corners are all inside is full; a third full takes a corner or the middle.
    match corners {
        8 if solid.porosity <= 0.0 => 27,
        0 if !thin && solid.porosity <= 0.0 && sample(MIDDLE) == 0 => 0,
        _ => {
            let others = (0..SAMPLES.pow(3)).filter(|i| !CORNERS.contains(i));
            corners + others.map(sample).sum::<u8>()
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// Tests every sample of every voxel; the code itself samples columns and levels once each.
    #[test]
    fn a_prism_fills_what_each_of_its_samples_says() {
        let corners = |turn: f64, n: usize, far: f64, near: f64| -> Vec<DVec2> {
            let corner = |k: usize| {
                let angle = turn + std::f64::consts::TAU * k as f64 / n as f64;
                DVec2::from_angle(angle) * if k.is_multiple_of(2) { far } else { near }
            };
            (0..n).map(corner).collect()
        };
        let extent = Extent::WINDOW;
        for (k, [bottom, top]) in [[-0.9, 3.1], [0.05, 0.17], [-3.0, 9.0], [1.0, 1.5]]
            .into_iter()
            .enumerate()
        {
            for (far, near) in [(7.3, 7.3), (6.0, 1.1), (0.5, 0.2)] {
                let outline = corners(0.3 + k as f64, 8, far, near);
                let prism = Solid::prism(Class::Manmade, &outline, bottom, top);
                let thin = prism.reach().min_element() < extent.voxel_m() * 0.75;
                let needed = if thin { 1 } else { NEEDED };
                let mut filled = std::collections::BTreeMap::new();
                fill(
                    extent,
                    &prism,
                    |_, _| true,
                    |x, y, z, n| {
                        filled.insert([x, y, z], n);
                    },
                );
                assert!(!filled.is_empty());
                let mut found = 0;
                for [x, y] in extent.all_columns() {
                    for z in 0..extent.nz() {
                        let inside = |i: usize| {
                            let f = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
                            let within = DVec3::new(f(i % 3), f(i / 3 % 3), f(i / 9));
                            let corner = DVec3::new(x as f64, y as f64, z as f64);
                            prism.contains(extent.from_voxel_units(corner + within))
                        };
                        let n = votes(&prism, thin, inside);
                        if n >= needed {
                            found += 1;
                            assert_eq!(filled.get(&[x, y, z]), Some(&n), "{x} {y} {z}");
                        }
                    }
                }
                assert_eq!(found, filled.len());
            }
        }
    }
}
