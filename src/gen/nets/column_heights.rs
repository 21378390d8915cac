//! Heights in each column of a draft: of what stands there, and of the ground. The transformer gets the background in
//! this form. Twin of `columns_of` in `training/pack.py`.

use scene::{Class, VoxelGrid, Window};

/// Groups of the background that can be given or left open: man-made, grown.
pub const GROUPS: usize = 2;
const LABELS: [Class; GROUPS] = [Class::Manmade, Class::Vegetation];

/// Heights of one column, in bins, one more than the bin; 0 where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ColumnHeights {
    /// Lowest and highest bin of each group.
    pub standing: [[u8; 2]; GROUPS],
    /// Highest bin of the ground.
    pub ground: u8,
}

/// Heights of all columns, `[x][y]`: the ground of `draft`, the background of `full`, which is the draft with the
/// scenery in it.
pub fn column_heights(draft: &VoxelGrid, full: &VoxelGrid) -> Vec<ColumnHeights> {
    let columns = (0..Window::COLUMNS).map(|c| (c / Window::NY, c % Window::NY));
    let heights = columns.map(|(x, y)| {
        let bins = |grid: &VoxelGrid, wanted: &dyn Fn(Class) -> bool| {
            let taken = |label: &u8| Class::from_id(*label).is_some_and(wanted);
            let column = grid.column(x, y);
            let [base, top] = [column.iter().position(taken), column.iter().rposition(taken)];
            [base, top].map(|bin| bin.map_or(0, |bin| bin as u8 + 1))
        };
        ColumnHeights {
            standing: LABELS.map(|label| bins(full, &|class| class == label)),
            ground: bins(draft, &Class::is_ground)[1],
        }
    });
    heights.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same case as in `training/test_training.py`.
    #[test]
    fn base_and_top_of_each_group_and_the_ground() {
        let mut draft = VoxelGrid::new();
        for c in 0..Window::COLUMNS {
            draft.set(c / Window::NY, c % Window::NY, 2, Class::DriveableSurface as u8);
        }
        let mut full = draft.clone();
        for z in 3..7 {
            full.set(3, 4, z, Class::Manmade as u8);
        }
        for (x, y, z) in [(3, 4, 9), (5, 6, 2), (5, 6, 3)] {
            full.set(x, y, z, Class::Vegetation as u8);
        }
        let found = column_heights(&draft, &full);
        let at = |x: usize, y: usize| found[x * Window::NY + y];
        let heights = |standing, ground| ColumnHeights { standing, ground };
        assert_eq!(at(3, 4), heights([[4, 7], [10, 10]], 3));
        assert_eq!(at(5, 6), heights([[0, 0], [3, 4]], 3));
        assert_eq!(at(0, 0), heights([[0, 0]; 2], 3));
    }
}
