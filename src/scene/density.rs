//! Contents of a frame in four numbers: a condition of the generation, and the meaning of its sliders. Twin of `named`
//! in `training/data.py`.

use super::{BevLayer, Class, VoxelGrid};

/// Man-made things that stay below this bin, 2.2 m above the ground, are clutter; others are buildings.
const LOW: usize = 8;

/// Amount of scenery, and share of the frame that is known; each 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Density {
    /// Trees and bushes: twice the root of the share of columns off the road that hold any.
    pub vegetation: f32,
    /// Man-made things above 2.2 m: 1.6 times the root of their share of those columns.
    pub building: f32,
    /// Lower man-made things and `others`: 6 times the root of their share.
    pub clutter: f32,
    /// Share of all columns that hold anything: 1 for complete worlds, about 0.4 for labels made from LiDAR.
    pub completeness: f32,
}

impl Density {
    /// The density of a frame's labels; `bev` are its layout's bits per column, `[x][y]`.
    pub fn from_grid(grid: &VoxelGrid, bev: &[u32]) -> Self {
        Self::of_columns(grid, bev, |_, _| true)
    }

    /// The density of some columns alone; all 0 if there are none.
    pub fn of_columns(grid: &VoxelGrid, bev: &[u32], counts: impl Fn(usize, usize) -> bool) -> Self {
        let (extent, mut columns) = (grid.extent(), 0u32);
        let [mut off_road, mut vegetation, mut building, mut clutter, mut any] = [0u32; 5];
        for (c, bits) in bev.iter().enumerate().take(extent.columns()) {
            let [x, y] = extent.column(c);
            if !counts(x, y) {
                continue;
            }
            columns += 1;
            let column = grid.column(x, y);
            let holds = |class: Class| column.contains(&class.id());
            any += u32::from(column.iter().any(|l| *l != Class::FREE));
            if bits & BevLayer::DrivableArea.bit() != 0 {
                continue;
            }
            let high = column[LOW..].contains(&Class::Manmade.id());
            off_road += 1;
            vegetation += u32::from(holds(Class::Vegetation));
            building += u32::from(high);
            clutter += u32::from(!high && holds(Class::Manmade) || holds(Class::Others));
        }
        let part = |scale: f32, n: u32| (scale * (n as f32 / off_road.max(1) as f32).sqrt()).min(1.0);
        Self {
            vegetation: part(2.0, vegetation),
            building: part(1.6, building),
            clutter: part(6.0, clutter),
            completeness: any as f32 / columns.max(1) as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Window;

    #[test]
    fn counts_columns_off_the_road() {
        let road = BevLayer::DrivableArea.bit();
        let mut grid = VoxelGrid::new();
        assert_eq!(
            Density::from_grid(&grid, &vec![road; Window::COLUMNS]),
            Density::default()
        );
        let mut bev = vec![road; Window::COLUMNS];
        bev[..100 * Window::NY].fill(0);
        for x in 0..100 {
            for y in 0..50 {
                grid.set(x, y, 3, Class::Vegetation.id());
            }
        }
        // A quarter of the columns off the road, an eighth of all.
        let found = Density::from_grid(&grid, &bev);
        assert_eq!((found.vegetation, found.building, found.clutter), (1.0, 0.0, 0.0));
        assert_eq!(found.completeness, 0.125);
        grid.set(150, 3, 9, Class::Manmade.id()); // on the road: not counted
        grid.set(50, 150, 9, Class::Manmade.id());
        grid.set(51, 150, 2, Class::Manmade.id());
        let found = Density::from_grid(&grid, &bev);
        let one = (1.0f32 / 20_000.0).sqrt();
        assert!((found.building - 1.6 * one).abs() < 1e-6 && (found.clutter - 6.0 * one).abs() < 1e-6);
    }
}
