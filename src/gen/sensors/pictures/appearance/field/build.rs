//! Steps that build the field: continuations above the grid, trunks, softened occupancy.

use glam::IVec3;

use super::super::noise::{hash1, unit};
use super::Structure;
use scene::appearance::{FieldShape, NZ, TOP_M, TRUNK, VOXEL_M};
use scene::{Class, Lattice};

/// Continues above the grid the structures and crowns that reach its top.
pub fn raise(shape: &FieldShape, solid: &mut [u8], structure: &[u16], structures: &mut [Structure]) {
    let FieldShape { nx, ny, .. } = *shape;
    let at = |x: usize, y: usize, z: usize| shape.at(x, y, z);
    let top = Lattice::OCC3D.bins(); // padded index of the highest voxel
    let (made, green) = (Class::Manmade.id(), Class::Vegetation.id());
    for s in structures.iter_mut() {
        if s.height_m > 5.3 && !s.thin && !s.known {
            s.height_m = 7.0 + 6.5 * unit(hash1(s.id, 9));
        }
    }
    // Distance to the edge of the crowns cut off, in voxels.
    let cut = |x: usize, y: usize, solid: &[u8]| solid[at(x, y, top)] == green;
    let mut depth = vec![0i32; nx * ny];
    for round in 1..=5 {
        let before = depth.clone();
        for x in 1..nx - 1 {
            for y in 1..ny - 1 {
                let around = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
                if cut(x, y, solid) && around.iter().all(|(x, y)| before[x * ny + y] >= round - 1) {
                    depth[x * ny + y] = round;
                }
            }
        }
    }
    for x in 1..nx - 1 {
        for y in 1..ny - 1 {
            let below = solid[at(x, y, top)];
            let more = if below == green {
                (depth[x * ny + y] * 3).min(NZ as i32) as usize / 2 + 1
            } else if below == made && structure[x * ny + y] > 0 {
                let s = &structures[usize::from(structure[x * ny + y]) - 1];
                (((s.height_m - TOP_M) / VOXEL_M).max(0.0)) as usize
            } else {
                0
            };
            solid[at(x, y, top) + 1..at(x, y, top) + 1 + more.min(NZ - top - 3)].fill(below);
        }
    }
}

/// Marks the trunks: slim columns of plants from the ground up to a crown.
pub fn trunks(shape: &FieldShape, solid: &mut [u8]) {
    let FieldShape { nx, ny, .. } = *shape;
    let at = |x: usize, y: usize, z: usize| shape.at(x, y, z);
    let green = Class::Vegetation.id();
    let before = solid.to_vec();
    let around = |x: usize, y: usize, z: usize| {
        let near = (0..9).filter(|k| *k != 4);
        near.filter(|k| before[at(x + k / 3 - 1, y + k % 3 - 1, z)] == green)
            .count()
    };
    for x in 1..nx - 1 {
        for y in 1..ny - 1 {
            let Some(first) = (1..8).find(|z| before[at(x, y, *z)] == green) else {
                continue;
            };
            let slim = (first..NZ - 1)
                .take_while(|z| before[at(x, y, *z)] == green && around(x, y, *z) <= 4)
                .count();
            let crown = before[at(x, y, first + slim)] == green;
            if first <= 4 && slim >= 2 && crown {
                for z in first..first + slim {
                    solid[at(x, y, z)] = TRUNK;
                }
            }
        }
    }
}

/// Occupancy softened: 55 % of the voxel itself and 45 % of its binomial 3x3x3 blur; a single voxel
/// keeps a surface, poles become slim.
pub fn weights(shape: &FieldShape, solid: &[u8], structure: &[u16], structures: &[Structure]) -> Vec<u8> {
    let FieldShape { nx, ny, .. } = *shape;
    let at = |x: usize, y: usize, z: usize| shape.at(x, y, z);
    let n = solid.len();
    let own: Vec<u8> = solid
        .iter()
        .map(|l| if *l == Class::FREE { 0 } else { 255 })
        .collect();
    let mut blurred: Vec<u8> = own.clone();
    for stride in [1, NZ, ny * NZ] {
        let from = blurred.clone();
        for i in stride..n - stride {
            let sum = u32::from(from[i - stride]) + 2 * u32::from(from[i]) + u32::from(from[i + stride]);
            blurred[i] = (sum / 4) as u8;
        }
    }
    let mut out: Vec<u8> = (0..n)
        .map(|i| ((u32::from(own[i]) * 55 + u32::from(blurred[i]) * 45) / 100) as u8)
        .collect();
    for (out, label) in out.iter_mut().zip(solid) {
        if *label == Class::Vegetation.id() {
            // Thin plants do not fall to pieces under their leaves.
            *out = (*out).max(205);
        } else if *label == TRUNK {
            *out = 186;
        }
    }
    for x in 1..nx - 1 {
        for y in 1..ny - 1 {
            let i = structure[x * ny + y];
            if i > 0 && structures[usize::from(i) - 1].thin {
                for z in 0..NZ {
                    let v = at(x, y, z);
                    if solid[v] == Class::Manmade.id() {
                        out[v] = 172;
                    } else {
                        out[v] = out[v].min(40);
                    }
                }
            }
        }
    }
    out
}

/// Labels with those of free voxels taken from a neighbour, plants last.
pub fn spread(shape: &FieldShape, solid: &[u8]) -> Vec<u8> {
    let ny = shape.ny;
    let mut out = solid.to_vec();
    let steps: Vec<isize> = [
        IVec3::X,
        IVec3::Y,
        IVec3::Z,
        IVec3::new(1, 1, 0),
        IVec3::new(1, -1, 0),
        IVec3::new(1, 0, 1),
        IVec3::new(1, 0, -1),
        IVec3::new(0, 1, 1),
        IVec3::new(0, 1, -1),
    ]
    .iter()
    .map(|s| (s.x as isize * ny as isize + s.y as isize) * NZ as isize + s.z as isize)
    .collect();
    for (i, label) in solid.iter().enumerate() {
        if *label == Class::FREE {
            continue;
        }
        for step in &steps {
            for j in [i as isize + step, i as isize - step] {
                if let Some(to) = out.get_mut(j as usize)
                    && (*to == Class::FREE
                        || (*to == Class::Vegetation.id() && solid[j as usize] == Class::FREE))
                {
                    *to = *label;
                }
            }
        }
    }
    out
}
