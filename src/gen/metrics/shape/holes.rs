//! Holes in the ground: columns inside the area of a ground class that hold neither ground nor anything on it.

use super::{ShapeFigures, share};
use scene::{Class, VoxelGrid, Window};

/// Classes of ground, and the names of their figures.
const CLASSES: [Class; 4] = [
    Class::DriveableSurface,
    Class::OtherFlat,
    Class::Sidewalk,
    Class::Terrain,
];
/// Share of holes in the closed area of each class.
pub const NAMES: [&str; 4] = [
    "holes.driveable_surface",
    "holes.other_flat",
    "holes.sidewalk",
    "holes.terrain",
];
/// Radius of the disc that closes areas, columns: gaps narrower than 2.4 m belong to the area around them.
const RADIUS: usize = 3;
/// Width of the margin around the grid, columns, so that the area outside does not limit the closing.
const PAD: usize = 2 * RADIUS;
const SIDE: usize = Window::NX + 2 * PAD;
const NY: usize = Window::NY;

/// Index of a column in a padded map.
fn padded(c: usize) -> usize {
    (c / NY + PAD) * SIDE + c % NY + PAD
}

/// The offsets of a disc in a padded map.
fn disc() -> Vec<isize> {
    let r = RADIUS as isize;
    (-r..=r)
        .flat_map(|dx| (-r..=r).map(move |dy| (dx, dy)))
        .filter(|(dx, dy)| dx * dx + dy * dy <= r * r)
        .map(|(dx, dy)| dx * SIDE as isize + dy)
        .collect()
}

/// Grows the highest values over the disc.
fn grow(map: &[i8], disc: &[isize]) -> Vec<i8> {
    let mut out = map.to_vec();
    for x in RADIUS..SIDE - RADIUS {
        for at in x * SIDE + RADIUS..(x + 1) * SIDE - RADIUS {
            let value = map[at];
            if value >= 0 {
                for d in disc {
                    let near = &mut out[(at as isize + d) as usize];
                    *near = value.max(*near);
                }
            }
        }
    }
    out
}

/// Cells whose disc touches no cell that is unset.
fn shrink(map: &[i8], disc: &[isize]) -> Vec<bool> {
    let mut out: Vec<bool> = map.iter().map(|v| *v >= 0).collect();
    for x in RADIUS..SIDE - RADIUS {
        for at in x * SIDE + RADIUS..(x + 1) * SIDE - RADIUS {
            if map[at] < 0 {
                disc.iter().for_each(|d| out[(at as isize + d) as usize] = false);
            }
        }
    }
    out
}

pub fn figures(grid: &VoxelGrid, out: &mut ShapeFigures) {
    let disc = disc();
    for (class, name) in CLASSES.into_iter().zip(NAMES) {
        // The bin of the ground, -1 for columns without this class.
        let mut area = vec![-1i8; SIDE * SIDE];
        for c in 0..Window::COLUMNS {
            let column = grid.column(c / NY, c % NY);
            if let Some(bin) = column.iter().rposition(|l| *l == class.id()) {
                area[padded(c)] = bin as i8;
            }
        }
        let around = grow(&area, &disc);
        let closed = shrink(&around, &disc);
        let (mut holes, mut columns) = (0, 0);
        for c in (0..Window::COLUMNS).filter(|c| closed[padded(*c)]) {
            // A column without any voxel up to one bin above the highest ground around it is a hole.
            let highest = around[padded(c)].max(0) as usize + 1;
            let column = grid.column(c / NY, c % NY);
            columns += 1;
            let empty = |l: &u8| *l == Class::FREE;
            holes += usize::from(column[..=highest.min(Window::NZ - 1)].iter().all(empty));
        }
        share(out, name, holes, columns);
    }
}
