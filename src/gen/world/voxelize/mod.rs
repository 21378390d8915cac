//! Worlds to voxels, in two ways: complete (every voxel of every solid), and made like real labels (LiDAR sweeps along
//! a drive, accumulated, majority per voxel, with holes and occlusion).

mod drive;
mod labels;
mod observed;

use super::World;
pub use drive::Drive;
pub use labels::{Labelled, labelled, labels, observed_labels};
use scene::raster::bev_channels;
use scene::solid::fill::{SMEAR, fill, smear_down};
use scene::{BevLayer, Class, Extent, VoxelGrid, Window};

/// Vertical position of the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Vertical {
    /// The convention of the Occ3D labels: the ground two bins below its true height, in bin 0, and every other voxel
    /// extended two bins down (`real_statistics.md`, 2.2).
    #[default]
    Occ3d,
    /// The measured position: the ground in bin 2.
    Physical,
}

/// Every voxel that a solid fills, and the ground under them: the labels that a sensor which sees everything would
/// give; see [`fill`]. An object's voxels stay in the columns of its box's footprint, as the layout's do: parts that
/// stick out by less than half a column belong to no column.
pub fn complete(world: &World, vertical: Vertical) -> VoxelGrid {
    let mut best = vec![(0u8, Class::FREE); Window::VOXELS]; // votes, class
    let bev = bev_channels(&world.layout, world.boxes.values());
    for s in world.solids() {
        let layer = BevLayer::of_object(s.class).map_or(0, BevLayer::bit);
        let counts = |x: usize, y: usize| layer == 0 || bev[x * Window::NY + y] & layer != 0;
        fill(Extent::WINDOW, s, counts, |x, y, z, votes| {
            let cell = &mut best[(x * Window::NY + y) * Window::NZ + z];
            if votes > cell.0 {
                *cell = (votes, s.class.id());
            }
        });
    }
    let mut grid = VoxelGrid::new();
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            let at = (x * Window::NY + y) * Window::NZ;
            let mut column = [Class::FREE; Window::NZ];
            for (z, (_, class)) in best[at..at + Window::NZ].iter().enumerate() {
                column[z] = *class;
            }
            let ground = (ground_bin(world, x, y), world.ground_class(x, y).id());
            finish_column(&mut column, Some(ground), vertical);
            close_step(&mut column, world, [x, y], vertical);
            grid.column_mut(x, y).copy_from_slice(&column);
        }
    }
    grid
}

/// Bin of the ground in a column, at its measured height.
fn ground_bin(world: &World, x: usize, y: usize) -> usize {
    scene::Lattice::OCC3D.bin(world.ground_height(Window::center(x, y, 0).truncate()))
}

/// Fills the side of a step: where the ground falls to a neighbour by more than a bin, its side is ground too, because
/// one could look under it otherwise.
fn close_step(column: &mut [u8; Window::NZ], world: &World, [x, y]: [usize; 2], vertical: Vertical) {
    if world.layout.relief.is_flat() {
        return;
    }
    let beside = [
        (x.wrapping_sub(1), y),
        (x + 1, y),
        (x, y.wrapping_sub(1)),
        (x, y + 1),
    ];
    let inside = beside
        .into_iter()
        .filter(|(x, y)| *x < Window::NX && *y < Window::NY);
    let lowest = inside.map(|(x, y)| ground_bin(world, x, y)).min().unwrap_or(0);
    let shift = if vertical == Vertical::Occ3d { SMEAR } else { 0 };
    let own = ground_bin(world, x, y).saturating_sub(shift);
    let from = (lowest + 1).saturating_sub(shift).min(own);
    column[from..own].fill(world.ground_class(x, y).id());
}

/// Puts the ground below the objects that stand on it and applies the vertical convention.
fn finish_column(column: &mut [u8; Window::NZ], ground: Option<(usize, u8)>, vertical: Vertical) {
    if vertical == Vertical::Occ3d {
        smear_down(column, SMEAR);
    }
    if let Some((bin, class)) = ground {
        let shift = if vertical == Vertical::Occ3d { SMEAR } else { 0 };
        let bin = bin.saturating_sub(shift);
        // Objects replace the ground they stand on.
        if column[bin] == Class::FREE {
            column[bin] = class;
        }
        for cell in &mut column[..bin] {
            *cell = Class::FREE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::SensorRig;

    #[test]
    fn ground_is_where_the_convention_says() {
        let world = World::random(2);
        for (vertical, bin) in [(Vertical::Occ3d, 0), (Vertical::Physical, 2)] {
            let grid = complete(&world, vertical);
            let road = grid.iter_set().filter(|v| v.3 == Class::DriveableSurface.id());
            let (at, all) = road.fold((0, 0), |(at, all), v| (at + usize::from(v.2 == bin), all + 1));
            assert!(
                all > 2000 && at == all,
                "{vertical:?}: {at} of {all} road voxels in bin {bin}"
            );
        }
    }

    #[test]
    fn labels_are_repeatable_sparser_and_agree_where_they_see() {
        let world = World::random(4);
        let full = complete(&world, Vertical::Occ3d);
        let pattern = &SensorRig::default().lidars[0];
        let drive = Drive {
            sweeps: 6,
            step_m: 6.0,
            ..Drive::default()
        };
        let seen = labels(&world, pattern, &drive, Vertical::Occ3d, 9);
        assert_eq!(seen, labels(&world, pattern, &drive, Vertical::Occ3d, 9));
        assert!(seen.count_set() < full.count_set() && seen.count_set() > 5000);
        let (mut same, mut both) = (0, 0);
        for (x, y, z, class) in seen.iter_set() {
            let truth = full.get(x, y, z);
            if truth != Class::FREE {
                both += 1;
                same += usize::from(truth == class);
            }
        }
        assert!(same * 100 > both * 93, "{same} of {both} agree");
    }
}
