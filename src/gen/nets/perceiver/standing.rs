//! What stands in each column of a grid: the truth that the map of the perceiver is held against.

use rayon::prelude::*;

use scene::{Class, VoxelGrid};

/// Label of a column of which nothing is known: it holds no voxel.
pub const UNKNOWN: u8 = Class::FREE;
/// Voxels above the lowest one that are looked at: what hangs higher than 2 m, such as the crown of a tree, does not stand there.
const LOOK: usize = 5;

/// Of each column `[x][y]` the label of what stands on its ground up to 2 m: an object before a building or a plant,
/// those before the ground itself; [`UNKNOWN`] without any voxel. Both vertical conventions give the same.
pub fn standing(grid: &VoxelGrid) -> Vec<u8> {
    let (nx, ny) = (grid.extent().nx(), grid.extent().ny());
    (0..nx * ny)
        .into_par_iter()
        .map(|at| in_column(grid.column(at / ny, at % ny)))
        .collect()
}

fn in_column(column: &[u8]) -> u8 {
    let Some(low) = column.iter().position(|label| *label != Class::FREE) else {
        return UNKNOWN;
    };
    let near = &column[low..(low + LOOK + 1).min(column.len())];
    let seen = near.iter().filter_map(|label| Class::from_id(*label));
    let best = seen.max_by_key(|class| match class {
        Class::Free => 0,
        c if c.is_ground() => 1,
        Class::Vegetation => 2,
        Class::Manmade | Class::Others => 3,
        _ => 4,
    });
    best.map_or(UNKNOWN, Class::id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_counts_and_what_hangs_does_not() {
        let column = |set: &[(usize, Class)]| {
            let mut column = [Class::FREE; 16];
            set.iter().for_each(|(z, class)| column[*z] = class.id());
            in_column(&column)
        };
        let road = (0, Class::DriveableSurface);
        assert_eq!(column(&[]), UNKNOWN);
        assert_eq!(column(&[road]), Class::DriveableSurface.id());
        assert_eq!(
            column(&[road, (6, Class::Vegetation)]),
            Class::DriveableSurface.id()
        );
        assert_eq!(column(&[road, (5, Class::Vegetation)]), Class::Vegetation.id());
        let under = [(2, Class::Car), (3, Class::Vegetation), (4, Class::Manmade)];
        assert_eq!(column(&under), Class::Car.id());
        assert_eq!(column(&[(15, Class::Manmade)]), Class::Manmade.id());
    }

    #[test]
    fn every_column_has_its_place() {
        let mut grid = VoxelGrid::new();
        grid.set(3, 7, 0, Class::Sidewalk.id());
        let found = standing(&grid);
        assert_eq!(found.len(), 200 * 200);
        assert_eq!(found[3 * 200 + 7], Class::Sidewalk.id());
        assert_eq!(found.iter().filter(|c| **c != UNKNOWN).count(), 1);
    }
}
