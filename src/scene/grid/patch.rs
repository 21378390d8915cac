//! Difference between two grids of one map, voxel by voxel: a generated result as the log of a document keeps it.

use std::sync::Arc;

use super::{BRICK, Extent, VoxelGrid};
use crate::Class;

/// Voxels of one brick that differ.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BrickPatch {
    /// Number of the brick.
    pub brick: u32,
    /// Numbers of the voxels within the brick, increasing.
    pub voxels: Vec<u16>,
    /// Class labels of those voxels before.
    pub before: Vec<u8>,
    /// Class labels of those voxels after.
    pub after: Vec<u8>,
}

/// Voxels in which two grids of the same extent differ, with their labels before and after.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VoxelPatch {
    extent: Extent,
    bricks: Vec<BrickPatch>,
}

impl VoxelPatch {
    /// The difference from one grid to another; `None` if they are of different extents.
    pub fn between(before: &VoxelGrid, after: &VoxelGrid) -> Option<Self> {
        if before.extent() != after.extent() {
            return None;
        }
        let in_brick = |brick: usize| {
            let mut patch = BrickPatch {
                brick: brick as u32,
                ..BrickPatch::default()
            };
            let pairs = before.bricks()[brick].iter().zip(after.bricks()[brick].iter());
            for (voxel, (old, new)) in pairs.enumerate().filter(|(_, (old, new))| old != new) {
                patch.voxels.push(voxel as u16);
                patch.before.push(*old);
                patch.after.push(*new);
            }
            (!patch.voxels.is_empty()).then_some(patch)
        };
        let changed = before.changed_bricks(after).into_iter();
        Some(Self {
            extent: before.extent(),
            bricks: changed.filter_map(in_brick).collect(),
        })
    }

    /// A patch of a map from its parts. Errors in one line on bricks or voxels out of order or outside the map, on labels
    /// that no class has, and on lists of different lengths.
    pub fn new(extent: Extent, bricks: Vec<BrickPatch>) -> Result<Self, String> {
        let [along_x, along_y] = super::bricks_along(extent);
        let mut last = None;
        for patch in &bricks {
            let (brick, most) = (patch.brick as usize, along_x * along_y);
            if brick >= most || last.is_some_and(|last| last >= brick) {
                return Err(format!(
                    "brick {brick} is out of order or outside the map of {extent}"
                ));
            }
            last = Some(brick);
            let count = patch.voxels.len();
            if count == 0 || patch.before.len() != count || patch.after.len() != count {
                return Err(format!("brick {brick}: lists of different lengths"));
            }
            let (_, size) = super::brick_columns(extent, brick);
            let inside = |voxel: &u16| {
                let voxel = usize::from(*voxel);
                let column = voxel / extent.nz();
                let (x, y) = (column / BRICK, column % BRICK);
                x < size[0] && y < size[1]
            };
            let increasing = patch.voxels.is_sorted_by(|a, b| a < b);
            if !increasing || !patch.voxels.iter().all(inside) {
                return Err(format!(
                    "brick {brick}: a voxel is out of order or outside the map"
                ));
            }
            let known = |label: &u8| usize::from(*label) < Class::COUNT;
            if !patch.before.iter().chain(&patch.after).all(known) {
                return Err(format!("brick {brick}: a label that no class has"));
            }
        }
        Ok(Self { extent, bricks })
    }

    /// Map that it belongs to.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// The bricks that differ, in increasing order.
    pub fn bricks(&self) -> &[BrickPatch] {
        &self.bricks
    }

    /// Number of voxels that differ.
    pub fn voxels(&self) -> usize {
        self.bricks.iter().map(|patch| patch.voxels.len()).sum()
    }

    /// Puts the labels after into a grid wherever it has those before. Returns the number of voxels that have neither, which
    /// stay; `None`, with nothing changed, if the grid is of another extent.
    pub fn apply(&self, grid: &mut VoxelGrid) -> Option<usize> {
        if grid.extent() != self.extent {
            return None;
        }
        let mut unmatched = 0;
        for patch in &self.bricks {
            let brick = Arc::make_mut(&mut grid.bricks[patch.brick as usize]);
            let labels = patch.before.iter().zip(&patch.after);
            for (voxel, (before, after)) in patch.voxels.iter().zip(labels) {
                let label = &mut brick[usize::from(*voxel)];
                if label == before {
                    *label = *after;
                } else if label != after {
                    unmatched += 1;
                }
            }
        }
        Some(unmatched)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_leads_from_one_grid_to_the_other() {
        let extent = Extent::new([0, 0], [40, 20]).expect("sound");
        let mut before = VoxelGrid::over(extent);
        before.set(1, 2, 3, 4);
        before.set(39, 19, 15, 11);
        let mut after = before.clone();
        after.set(1, 2, 3, 17);
        after.set(20, 10, 0, 9);
        let patch = VoxelPatch::between(&before, &after).expect("one map");
        assert_eq!((patch.voxels(), patch.bricks().len()), (2, 2));
        let mut grid = before.clone();
        assert_eq!((patch.apply(&mut grid), &grid), (Some(0), &after));
        assert_eq!(patch.apply(&mut grid), Some(0), "a second time it does nothing");
        // A voxel that is neither as before nor as after stays.
        let mut other = before.clone();
        other.set(1, 2, 3, 10);
        assert_eq!(patch.apply(&mut other), Some(1));
        assert_eq!((other.get(1, 2, 3), other.get(20, 10, 0)), (10, 9));
        assert_eq!(patch.apply(&mut VoxelGrid::new()), None);
        assert_eq!(VoxelPatch::between(&before, &VoxelGrid::new()), None);
        assert_eq!(VoxelPatch::new(extent, patch.bricks().to_vec()), Ok(patch));
    }

    #[test]
    fn unsound_parts_are_refused() {
        let extent = Extent::new([0, 0], [40, 20]).expect("sound");
        let good = BrickPatch {
            brick: 1,
            voxels: vec![0, 5],
            before: vec![0, 1],
            after: vec![2, 3],
        };
        let refused = |change: &dyn Fn(&mut BrickPatch)| {
            let mut patch = good.clone();
            change(&mut patch);
            VoxelPatch::new(extent, vec![patch]).expect_err("unsound")
        };
        VoxelPatch::new(extent, vec![good.clone()]).expect("sound");
        VoxelPatch::new(extent, vec![good.clone(), good.clone()]).expect_err("twice");
        assert!(refused(&|p| p.brick = 6).contains("brick 6"));
        refused(&|p| p.voxels = vec![5, 5]);
        refused(&|p| p.voxels.push(9));
        refused(&|p| p.voxels = vec![0, 4096]);
        refused(&|p| p.after = vec![2, 18]);
        // The last brick along y has 4 columns.
        refused(&|p| p.voxels = vec![0, (4 * BRICK) as u16]);
    }
}
