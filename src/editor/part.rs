//! Accepts a part of a result: takes some of the voxels that differ between two states, and leaves the rest as it was.

use scene::{Class, VoxelGrid};

/// Part of a result that is accepted.
#[derive(Clone, Debug, PartialEq)]
pub enum AcceptedPart {
    /// Every voxel of these columns, `[x][y]` of the map.
    Columns(Vec<bool>),
    /// Voxels that were or become of this class.
    Class(Class),
}

impl AcceptedPart {
    /// `before`, with this part of `after`; `before` alone if the two are of different maps.
    pub fn taken(&self, before: &VoxelGrid, after: &VoxelGrid) -> VoxelGrid {
        let extent = before.extent();
        let mut out = before.clone();
        each_different(before, after, |x, y, old, new| match self {
            Self::Columns(columns) => {
                if columns.get(extent.index(x, y)) == Some(&true) {
                    out.column_mut(x, y).copy_from_slice(new);
                }
            }
            Self::Class(class) => {
                for z in (0..extent.nz()).filter(|z| old[*z] != new[*z]) {
                    if [old[z], new[z]].contains(&class.id()) {
                        out.set(x, y, z, new[z]);
                    }
                }
            }
        });
        out
    }
}

/// How many voxels differ in `after`, by class, most first. A voxel counts for its new class, or for its old one if it
/// becomes free.
pub fn changed_by_class(before: &VoxelGrid, after: &VoxelGrid) -> Vec<(Class, usize)> {
    let mut counts = [0usize; 256];
    each_different(before, after, |_, _, old, new| {
        for (old, new) in old.iter().zip(new).filter(|(a, b)| a != b) {
            let label = if *new == Class::FREE { *old } else { *new };
            counts[usize::from(label)] += 1;
        }
    });
    let class = |(label, count): (usize, &usize)| {
        let class = u8::try_from(label).ok().and_then(Class::from_id)?;
        (*count > 0).then_some((class, *count))
    };
    let mut found: Vec<_> = counts.iter().enumerate().filter_map(class).collect();
    found.sort_by_key(|(class, count)| (std::cmp::Reverse(*count), class.id()));
    found
}

fn each_different(before: &VoxelGrid, after: &VoxelGrid, mut visit: impl FnMut(usize, usize, &[u8], &[u8])) {
    if before.extent() != after.extent() {
        return;
    }
    for brick in before.changed_bricks(after) {
        let ([x0, y0], [nx, ny]) = before.brick_columns(brick);
        for [x, y] in (x0..x0 + nx).flat_map(|x| (y0..y0 + ny).map(move |y| [x, y])) {
            let (old, new) = (before.column(x, y), after.column(x, y));
            if old != new {
                visit(x, y, old, new);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Extent;

    fn grid(voxels: &[([usize; 3], Class)]) -> VoxelGrid {
        let mut grid = VoxelGrid::new();
        for ([x, y, z], class) in voxels {
            grid.set(*x, *y, *z, class.id());
        }
        grid
    }

    #[test]
    fn a_part_is_taken_and_the_rest_stays() {
        let before = grid(&[([1, 1, 3], Class::Vegetation), ([5, 5, 2], Class::Manmade)]);
        let after = grid(&[([1, 1, 3], Class::Manmade), ([9, 9, 4], Class::Car)]);
        assert_eq!(
            changed_by_class(&before, &after),
            [(Class::Manmade, 2), (Class::Car, 1)]
        );
        // What goes and what comes of a class.
        let manmade = AcceptedPart::Class(Class::Manmade).taken(&before, &after);
        assert_eq!(manmade, grid(&[([1, 1, 3], Class::Manmade)]));
        let cars = AcceptedPart::Class(Class::Car).taken(&before, &after);
        assert_eq!(before.count_different(&cars), 1);
        let mut columns = vec![false; Extent::WINDOW.columns()];
        columns[Extent::WINDOW.index(5, 5)] = true;
        let place = AcceptedPart::Columns(columns).taken(&before, &after);
        assert_eq!(place, grid(&[([1, 1, 3], Class::Vegetation)]));
        // Columns that nobody named are not taken.
        assert_eq!(AcceptedPart::Columns(Vec::new()).taken(&before, &after), before);
    }
}
