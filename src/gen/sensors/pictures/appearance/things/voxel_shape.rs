//! An object that has voxels of its own, as blocks in its paint.

use std::collections::BTreeSet;

use glam::Vec3;

use super::PartMaterial;
use super::build::ObjectBuilder;
use scene::clip::OwnShape;
use scene::{Lattice, SceneBox};

/// Most blocks: a number that the lists of a graphics card hold easily.
const MOST: usize = 400;
/// Bevel of the edges, m.
const BEVEL_M: f32 = 0.03;

/// Adds the voxels of an object as blocks, as few as are needed; see [`scene::Edit::SetShape`] for the cells. Parts
/// beyond the box are cut off.
pub(super) fn voxel_shape(build: &mut ObjectBuilder, b: &SceneBox, shape: &OwnShape, material: PartMaterial) {
    let voxel = Lattice::OCC3D.voxel_m() as f32;
    let below = shape.bottom_m(b) as f32;
    let half = build.s / 2.0;
    for (lo, hi) in blocks(&shape.cells()).into_iter().take(MOST) {
        let meters = |cell: [i32; 3]| Vec3::from_array(cell.map(|v| v as f32)) * voxel + Vec3::Z * below;
        let least = Vec3::new(-half.x, -half.y, 0.0);
        let most = Vec3::new(half.x, half.y, build.s.z);
        let (lo, hi) = (meters(lo).max(least), meters(hi).min(most));
        if (hi - lo).min_element() > 1e-3 {
            build.block(
                (lo / build.s).to_array(),
                (hi / build.s).to_array(),
                BEVEL_M,
                material,
            );
        }
    }
}

/// The cells as blocks from a lower corner to one beyond the upper, each as large as it can be made from its first cell on.
fn blocks(cells: &[[i32; 3]]) -> Vec<([i32; 3], [i32; 3])> {
    let mut left: BTreeSet<[i32; 3]> = cells.iter().copied().filter(|cell| cell[2] >= 0).collect();
    let mut out = Vec::new();
    while let Some(&lo) = left.first() {
        let mut hi = lo.map(|v| v + 1);
        // Upwards first: columns hang together.
        for axis in [2, 0, 1] {
            loop {
                let (mut from, mut to) = (lo, hi);
                (from[axis], to[axis]) = (hi[axis], hi[axis] + 1);
                if !each(from, to).all(|cell| left.contains(&cell)) {
                    break;
                }
                hi[axis] += 1;
            }
        }
        each(lo, hi).for_each(|cell| {
            left.remove(&cell);
        });
        out.push((lo, hi));
    }
    out
}

fn each(lo: [i32; 3], hi: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (lo[0]..hi[0]).flat_map(move |x| (lo[1]..hi[1]).flat_map(move |y| (lo[2]..hi[2]).map(move |z| [x, y, z])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_the_cells_and_nothing_else() {
        let mut cells: Vec<[i32; 3]> = each([-5, -2, -2], [5, 2, 2]).collect();
        cells.extend(each([-5, -2, 2], [-1, 2, 5]));
        let blocks = blocks(&cells);
        assert_eq!(blocks.len(), 2);
        let mut covered: Vec<[i32; 3]> = blocks.iter().flat_map(|(lo, hi)| each(*lo, *hi)).collect();
        covered.sort_unstable();
        let mut shown: Vec<[i32; 3]> = cells.into_iter().filter(|c| c[2] >= 0).collect();
        shown.sort_unstable();
        assert_eq!(covered, shown);
    }
}
