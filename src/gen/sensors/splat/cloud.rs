//! Voxels as Gaussians: one per occupied voxel, at its centre, half a voxel wide.

use crate::raycast::ColumnMasks;
use scene::sensor_data::RenderId;
pub use scene::splats::Gaussian;
use scene::{BevLayer, Class, Extent, VoxelGrid};

/// Standard deviation of a voxel's Gaussian: half a voxel (UniScene; X-Scene uses 0.135 m).
pub const VOXEL_STD_M: f32 = 0.2;

/// Lines on the road and what they turn its voxels into; later ones win.
const LINES: [(BevLayer, RenderId); 3] = [
    (BevLayer::PedCrossing, 17),
    (BevLayer::RoadDivider, 18),
    (BevLayer::LaneDivider, 19),
];

/// Gaussians that the splat renderer draws.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GaussianCloud {
    gaussians: Vec<Gaussian>,
}

impl GaussianCloud {
    /// A cloud of any Gaussians, for tests and imports.
    pub fn from_gaussians(gaussians: Vec<Gaussian>) -> Self {
        Self { gaussians }
    }

    /// The cloud of every voxel that is not free. `bev` holds one bit per [`BevLayer`] for each cell of the grid,
    /// `[x][y]`; driveable voxels under a crossing or a divider become render ids 17 to 19. Cells that `bev` lacks have
    /// no lines, so an empty slice draws none.
    pub fn from_grid(grid: &VoxelGrid, bev: &[u32]) -> Self {
        Self::build(grid, &ColumnMasks::from_grid(grid), bev, |_, _, mask| mask)
    }

    /// The cloud of the voxels at most `layers` steps (over faces) from a free one. Space around and above the grid
    /// counts as free, below as solid. Voxels deeper inside get little light, so this draws almost the same picture
    /// sooner: gaps between Gaussians let some 15 % of the light past each layer.
    pub fn from_grid_shell(grid: &VoxelGrid, bev: &[u32], layers: usize) -> Self {
        let masks = ColumnMasks::from_grid(grid);
        let extent = grid.extent();
        let mut inside: Vec<u16> = extent.all_columns().map(|[x, y]| masks.column(x, y)).collect();
        for _ in 0..layers {
            inside = eroded(extent, &inside);
        }
        Self::build(grid, &masks, bev, |x, y, mask| mask & !inside[extent.index(x, y)])
    }

    fn build(
        grid: &VoxelGrid,
        masks: &ColumnMasks,
        bev: &[u32],
        keep: impl Fn(usize, usize, u16) -> u16,
    ) -> Self {
        let extent = grid.extent();
        let (nx, ny) = (extent.nx(), extent.ny());
        let mut gaussians = Vec::new();
        for x in 0..nx {
            for y in 0..ny {
                let mut left = keep(x, y, masks.column(x, y));
                if left == 0 {
                    continue;
                }
                let column = grid.column(x, y);
                let road = road_id(bev.get(x * ny + y).copied().unwrap_or(0));
                while left != 0 {
                    let z = left.trailing_zeros() as usize;
                    left &= left - 1;
                    let label = column[z];
                    gaussians.push(Gaussian {
                        position_m: extent.center(x, y, z).as_vec3().to_array(),
                        std_m: VOXEL_STD_M,
                        opacity: 1.0,
                        id: render_id(label, road),
                    });
                }
            }
        }
        Self { gaussians }
    }

    /// The Gaussians, x then y then z.
    pub fn gaussians(&self) -> &[Gaussian] {
        &self.gaussians
    }

    /// Number of Gaussians.
    pub fn len(&self) -> usize {
        self.gaussians.len()
    }

    /// True if there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.gaussians.is_empty()
    }
}

/// The render id of a voxel that is not free, in a cell where driveable voxels have the id `road`.
pub(crate) fn render_id(label: u8, road: RenderId) -> RenderId {
    match label {
        v if v == Class::DriveableSurface.id() => road,
        // A label outside the table means a damaged grid: shown as others.
        v if v > Class::FREE => Class::Others.id(),
        v => v,
    }
}

/// The render id of a driveable voxel in a cell with these layers.
pub(crate) fn road_id(layers: u32) -> RenderId {
    let lines = LINES.iter().rev();
    lines
        .filter(|(layer, _)| layers & layer.bit() != 0)
        .map(|(_, id)| *id)
        .next()
        .unwrap_or(Class::DriveableSurface.id())
}

/// Columns `[x][y]` without the voxels that have a free neighbour.
fn eroded(extent: Extent, columns: &[u16]) -> Vec<u16> {
    let at = |x: usize, y: usize| match extent.holds(x, y) {
        true => columns[extent.index(x, y)],
        false => 0,
    };
    let cell = |i: usize| {
        let [x, y] = extent.column(i);
        let m = columns[i];
        // Below bin 0 is earth; above bin 15 is air.
        let beside = at(x.wrapping_sub(1), y) & at(x + 1, y) & at(x, y.wrapping_sub(1)) & at(x, y + 1);
        m & (m << 1 | 1) & (m >> 1) & beside
    };
    (0..columns.len()).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Window;

    #[test]
    fn lines_repaint_the_road_only_and_the_later_wins() {
        let mut grid = VoxelGrid::new();
        let (road, walk) = (Class::DriveableSurface.id(), Class::Sidewalk.id());
        for y in 0..5 {
            grid.set(10, y, 0, road);
            grid.set(11, y, 0, walk);
            grid.set(10, y, 1, Class::Car.id());
        }
        let mut bev = vec![0; Window::COLUMNS];
        let layers = [
            vec![],
            vec![BevLayer::PedCrossing],
            vec![BevLayer::PedCrossing, BevLayer::RoadDivider],
            vec![
                BevLayer::LaneDivider,
                BevLayer::PedCrossing,
                BevLayer::RoadDivider,
            ],
            vec![BevLayer::StopLine, BevLayer::DrivableArea],
        ];
        for x in [10, 11] {
            for (y, layers) in layers.iter().enumerate() {
                bev[x * Window::NY + y] = layers.iter().fold(0, |bits, l| bits | l.bit());
            }
        }
        let cloud = GaussianCloud::from_grid(&grid, &bev);
        let ids = |x: usize, z: usize| -> Vec<u8> {
            let p = |y| Window::center(x, y, z).as_vec3().to_array();
            let find = |y| cloud.gaussians().iter().find(|g| g.position_m == p(y));
            (0..5).map(|y| find(y).expect("a voxel").id).collect()
        };
        assert_eq!(ids(10, 0), vec![road, 17, 18, 19, road]);
        assert_eq!(ids(11, 0), vec![walk; 5]);
        assert_eq!(ids(10, 1), vec![Class::Car.id(); 5]);
        assert!(
            GaussianCloud::from_grid(&grid, &[])
                .gaussians()
                .iter()
                .all(|g| g.id < 17)
        );
    }

    #[test]
    fn shell_keeps_what_is_near_the_air() {
        let mut grid = VoxelGrid::new();
        for (x, y, z) in (50..59).flat_map(|x| (60..69).flat_map(move |y| (0..9).map(move |z| (x, y, z)))) {
            grid.set(x, y, z, Class::Manmade.id());
        }
        let len = |layers| GaussianCloud::from_grid_shell(&grid, &[], layers).len();
        // 9 wide, 9 high, standing on the lower border: that side is not a surface.
        assert_eq!(len(1), 729 - 7 * 7 * 8);
        assert_eq!(len(2), 729 - 5 * 5 * 7);
        assert_eq!(len(5), 729);
        assert_eq!(len(0), 0);
        assert_eq!(
            GaussianCloud::from_grid_shell(&grid, &[], 99),
            GaussianCloud::from_grid(&grid, &[])
        );
        assert!(GaussianCloud::from_grid(&VoxelGrid::new(), &[]).is_empty());
        grid.set(0, 0, 15, 200);
        let odd = GaussianCloud::from_grid(&grid, &[]);
        assert_eq!(odd.gaussians()[0].id, 0);
    }
}
