//! Voxels that a brush would change: a block or a ball in front of the face under the ray, or behind it.

use crate::pick::{self, PickRay, VoxelHit};
use crate::tools::{VoxelTip, VoxelVerb};
use scene::{Class, Frame};

/// Voxels of the first face along the ray that a block covers: free ones in front of it to attach, others behind it to remove
/// or recolour.
pub(super) fn target(frame: &Frame, verb: VoxelVerb, size: [usize; 2], ray: &PickRay) -> Vec<[usize; 3]> {
    tipped(frame, verb, (VoxelTip::Block, size), ray)
}

/// Like [`target`], with any tip.
pub(super) fn tipped(
    frame: &Frame,
    verb: VoxelVerb,
    brush: (VoxelTip, [usize; 2]),
    ray: &PickRay,
) -> Vec<[usize; 3]> {
    let Some(hit) = pick::ray_voxels(ray, &frame.occupancy, |_, _| true) else {
        // On empty ground voxels are attached to the floor of the grid.
        if verb != VoxelVerb::Attach {
            return Vec::new();
        }
        let lattice = frame.extent().lattice();
        let floor = lattice.ground_bin(0.0);
        let floor_m = frame.extent().center(0, 0, floor).z;
        let ground = pick::ray_ground(ray, floor_m).and_then(|p| frame.extent().voxel_at(p));
        let floor = ground.map(|[x, y, _]| VoxelHit {
            cell: [x, y, floor],
            label: Class::FREE,
            normal: [0, 0, 1],
            distance_m: 0.0,
        });
        return floor.map_or_else(Vec::new, |hit| covered(frame, hit.cell, hit.normal, brush, true));
    };
    match verb {
        VoxelVerb::Attach => hit
            .neighbour(frame.extent())
            .map_or_else(Vec::new, |cell| covered(frame, cell, hit.normal, brush, true)),
        _ => covered(frame, hit.cell, hit.normal.map(|n| -n), brush, false),
    }
}

/// The voxels of a brush that begins at `cell` and reaches along `direction`, centred across it; only those that are
/// free, or only those that are not.
fn covered(
    frame: &Frame,
    cell: [usize; 3],
    direction: [i32; 3],
    (tip, [across, height]): (VoxelTip, [usize; 2]),
    free: bool,
) -> Vec<[usize; 3]> {
    let limit = frame.extent().shape();
    let whole = |axis: usize| {
        let at = cell[axis] as i64;
        let size = if direction[axis] == 0 { across } else { height } as i64;
        let low = match direction[axis] {
            0 => at - (size - 1) / 2,
            d if d > 0 => at,
            _ => at - size + 1,
        };
        [low, low + size]
    };
    let range = |axis: usize| {
        let [low, end] = whole(axis);
        low.max(0)..end.min(limit[axis] as i64)
    };
    let is_in_ball = |at: [i64; 3]| {
        let part = |axis: usize| {
            let [low, end] = whole(axis).map(|v| v as f64);
            let half = (end - low) / 2.0;
            (at[axis] as f64 + 0.5 - low - half) / half
        };
        (0..3).map(|axis| part(axis).powi(2)).sum::<f64>() <= 1.0
    };
    let mut cells = Vec::new();
    for x in range(0) {
        for y in range(1) {
            for z in range(2) {
                if tip == VoxelTip::Round && !is_in_ball([x, y, z]) {
                    continue;
                }
                let [x, y, z] = [x, y, z].map(|v| v as usize);
                if (frame.occupancy.get(x, y, z) == Class::FREE) == free {
                    cells.push([x, y, z]);
                }
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use glam::DVec3;

    use super::*;
    use scene::{BevLayout, Extent, VoxelGrid};

    fn frame() -> Frame {
        let mut grid = VoxelGrid::new();
        for x in 90..110 {
            for y in 90..110 {
                grid.set(x, y, 0, Class::Terrain.id());
            }
        }
        grid.set(100, 100, 1, Class::Manmade.id());
        Frame::new(BevLayout::default(), BTreeMap::new(), grid)
    }

    fn down(x: usize, y: usize) -> PickRay {
        let p = Extent::WINDOW.center(x, y, 15);
        PickRay::new(p + DVec3::Z * 5.0, -DVec3::Z).expect("a direction")
    }

    #[test]
    fn attaching_builds_up_and_removing_digs_down() {
        let frame = frame();
        let at = |verb, size, x, y| target(&frame, verb, [size; 2], &down(x, y));
        assert_eq!(at(VoxelVerb::Attach, 1, 100, 100), vec![[100, 100, 2]]);
        assert_eq!(at(VoxelVerb::Remove, 1, 100, 100), vec![[100, 100, 1]]);
        assert_eq!(at(VoxelVerb::Recolour, 1, 95, 95), vec![[95, 95, 0]]);
        // Three cells on a side stand on the face; a voxel that is there already stays.
        assert_eq!(at(VoxelVerb::Attach, 3, 99, 99).len(), 27 - 1);
        assert!(
            at(VoxelVerb::Attach, 3, 99, 99)
                .iter()
                .all(|c| (1..=3).contains(&c[2]))
        );
        // Digging below the floor is not possible.
        assert_eq!(at(VoxelVerb::Remove, 3, 95, 95).len(), 9);
        // Where nothing was seen voxels are put on the floor, and nothing can be removed.
        assert_eq!(at(VoxelVerb::Attach, 1, 10, 10), vec![[10, 10, 0]]);
        assert!(at(VoxelVerb::Remove, 1, 10, 10).is_empty());
    }

    #[test]
    fn the_floor_is_that_of_the_whole_map() {
        let extent = Extent::new([-150, -110], [480, 320]).expect("sound");
        let frame = Frame::new(BevLayout::over(extent), BTreeMap::new(), VoxelGrid::over(extent));
        let ray = PickRay::new(DVec3::new(100.1, 60.1, 9.0), -DVec3::Z).expect("a direction");
        let cells = target(&frame, VoxelVerb::Attach, [3, 1], &ray);
        assert_eq!((cells.len(), cells[4]), (9, [400, 260, 0]));
        let ray = PickRay::new(DVec3::new(131.9, 83.9, 9.0), -DVec3::Z).expect("a direction");
        assert_eq!(
            target(&frame, VoxelVerb::Attach, [3, 1], &ray).len(),
            4,
            "cut at the rim"
        );
        let ray = PickRay::new(DVec3::new(132.1, 60.1, 9.0), -DVec3::Z).expect("a direction");
        assert!(target(&frame, VoxelVerb::Attach, [3, 1], &ray).is_empty());
    }

    #[test]
    fn a_round_tip_covers_a_ball() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let count = |size: [usize; 2]| {
            let brush = (VoxelTip::Round, size);
            let cells = tipped(&frame, VoxelVerb::Attach, brush, &down(100, 100));
            let block = target(&frame, VoxelVerb::Attach, size, &down(100, 100));
            assert!(cells.iter().all(|c| block.contains(c)));
            cells.len()
        };
        assert_eq!([count([1, 1]), count([2, 2])], [1, 8]);
        // Without the eight corners.
        assert_eq!(count([3, 3]), 27 - 8);
        // About pi / 6 of the block, and of the higher one as well.
        let [ball, egg] = [count([5, 5]), count([5, 9])];
        assert!(
            (60..=90).contains(&ball) && (105..=155).contains(&egg),
            "{ball} {egg}"
        );
    }

    #[test]
    fn faces_from_the_side() {
        let frame = frame();
        let from = Extent::WINDOW.center(80, 100, 1);
        let ray = PickRay::new(from, DVec3::X).expect("a direction");
        assert_eq!(
            target(&frame, VoxelVerb::Attach, [1, 1], &ray),
            vec![[99, 100, 1]]
        );
        assert_eq!(target(&frame, VoxelVerb::Attach, [1, 3], &ray).len(), 3);
        assert_eq!(target(&frame, VoxelVerb::Remove, [2, 2], &ray).len(), 1);
        // The top of the grid is a limit, not an error.
        let mut tall = frame.clone();
        tall.occupancy.set(50, 50, 15, 1);
        assert!(target(&tall, VoxelVerb::Attach, [1, 1], &down(50, 50)).is_empty());
    }
}
