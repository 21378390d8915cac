//! Kinds of things that stand in columns, and those of a grid: the ground truth that the perceiver's map is compared
//! with.

use rayon::prelude::*;

use scene::{Class, VoxelGrid};

/// Kind of thing that stands in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stands {
    /// Empty ground for driving.
    Drivable,
    /// Empty ground for walking.
    Walkway,
    /// Empty ground of another kind.
    OtherGround,
    /// A plant.
    Vegetation,
    /// A building, a wall, a pole.
    Structure,
    /// A car, or another vehicle with four wheels or more.
    Vehicle,
    /// A bicycle or a motorcycle.
    Cycle,
    /// A person on foot.
    Person,
    /// A barrier or a traffic cone.
    Barrier,
}

impl Stands {
    /// All, in the order of the network's outputs.
    pub const ALL: [Self; 9] = [
        Self::Drivable,
        Self::Walkway,
        Self::OtherGround,
        Self::Vegetation,
        Self::Structure,
        Self::Vehicle,
        Self::Cycle,
        Self::Person,
        Self::Barrier,
    ];

    /// Kind of a label, as [`standing`] gives them; `None` if nothing is known.
    pub fn of_label(label: u8) -> Option<Self> {
        Some(match Class::from_id(label)? {
            Class::Free => return None,
            Class::DriveableSurface => Self::Drivable,
            Class::Sidewalk => Self::Walkway,
            Class::OtherFlat | Class::Terrain => Self::OtherGround,
            Class::Vegetation => Self::Vegetation,
            Class::Manmade | Class::Others => Self::Structure,
            Class::Bicycle | Class::Motorcycle => Self::Cycle,
            Class::Pedestrian => Self::Person,
            Class::Barrier | Class::TrafficCone => Self::Barrier,
            Class::Bus | Class::Car | Class::ConstructionVehicle | Class::Trailer | Class::Truck => {
                Self::Vehicle
            }
        })
    }

    /// Class whose colour and name stand for the kind.
    pub fn class(self) -> Class {
        match self {
            Self::Drivable => Class::DriveableSurface,
            Self::Walkway => Class::Sidewalk,
            Self::OtherGround => Class::Terrain,
            Self::Vegetation => Class::Vegetation,
            Self::Structure => Class::Manmade,
            Self::Vehicle => Class::Car,
            Self::Cycle => Class::Bicycle,
            Self::Person => Class::Pedestrian,
            Self::Barrier => Class::Barrier,
        }
    }

    /// Name in English.
    pub fn label(self) -> String {
        match self {
            Self::Vehicle => "any vehicle".to_owned(),
            Self::Cycle => "any cycle".to_owned(),
            other => other.class().label(),
        }
    }

    /// Kind of the largest logit; on a tie the first one.
    pub fn likeliest(logits: &[f32; Self::ALL.len()]) -> Self {
        let mut best = 0;
        for (i, logit) in logits.iter().enumerate() {
            if *logit > logits[best] {
                best = i;
            }
        }
        Self::ALL[best]
    }
}

/// Label of a column of which nothing is known: it holds no voxel.
pub const UNKNOWN: u8 = Class::FREE;
/// Voxels above the lowest one that are considered: a thing that hangs higher than 2 m, such as the crown of a tree,
/// does not stand there.
const LOOK: usize = 5;

/// Label of what stands on the ground of each column `[x][y]`, up to 2 m: an object before a building or a plant, those
/// before the ground itself; [`UNKNOWN`] without any voxel. Both vertical conventions give the same.
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
    fn every_label_but_free_is_something() {
        for class in Class::ALL {
            let stands = Stands::of_label(class.id());
            assert_eq!(stands.is_none(), class == Class::Free);
            if let Some(stands) = stands {
                assert_eq!(Stands::of_label(stands.class().id()), Some(stands));
            }
        }
        assert_eq!(Stands::of_label(18), None);
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
