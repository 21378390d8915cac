//! A street made of boxes of voxels, for the sensors' tests and benchmarks.

use scene::{BevLayer, Class, VoxelGrid, Window};

/// Fills the voxels between two corners (ego frame, metres) with a class.
pub fn fill(grid: &mut VoxelGrid, min_m: [f64; 3], max_m: [f64; 3], class: Class) {
    let u = |p: [f64; 3]| Window::to_voxel_units(p.into()).round().max(glam::DVec3::ZERO);
    let (low, high) = (u(min_m), u(max_m));
    for x in low.x as usize..(high.x as usize).min(Window::NX) {
        for y in low.y as usize..(high.y as usize).min(Window::NY) {
            for z in low.z as usize..(high.z as usize).min(Window::NZ) {
                grid.set(x, y, z, class.id());
            }
        }
    }
}

/// A street along x with pavements, houses, trees, parked cars, a truck ahead, a bus behind, a
/// pedestrian on the left: about 60,000 voxels; and its layout bits with lines and a crossing.
pub fn street() -> (VoxelGrid, Vec<u32>) {
    let mut grid = VoxelGrid::new();
    let g = &mut grid;
    let (ground, top) = (-1.0, -0.6);
    fill(g, [-40.0, -40.0, ground], [40.0, 40.0, top], Class::Terrain);
    fill(
        g,
        [-40.0, -7.2, ground],
        [40.0, 7.2, top],
        Class::DriveableSurface,
    );
    for side in [-1.0, 1.0] {
        let across = |a: f64, b: f64| {
            let (a, b) = (side * a, side * b);
            [a.min(b), a.max(b)]
        };
        let [a, b] = across(7.2, 10.0);
        fill(g, [-40.0, a, ground], [40.0, b, top], Class::Sidewalk);
        for i in 0..5 {
            let x = -38.0 + 16.0 * f64::from(i);
            // Houses are shells, as a LiDAR would have seen them.
            let [near, deep] = [across(12.0, 12.8), across(12.0, 20.0)];
            fill(g, [x, near[0], top], [x + 10.0, near[1], 5.4], Class::Manmade);
            fill(g, [x, deep[0], top], [x + 0.8, deep[1], 5.4], Class::Manmade);
            fill(
                g,
                [x + 9.2, deep[0], top],
                [x + 10.0, deep[1], 5.4],
                Class::Manmade,
            );
            let trunk = across(9.2, 9.6);
            fill(
                g,
                [x + 12.0, trunk[0], top],
                [x + 12.4, trunk[1], 2.2],
                Class::Vegetation,
            );
            let crown = across(8.4, 10.4);
            fill(
                g,
                [x + 11.2, crown[0], 2.2],
                [x + 13.2, crown[1], 4.2],
                Class::Vegetation,
            );
            let car = across(5.2, 7.2);
            fill(g, [x + 3.0, car[0], ground], [x + 7.4, car[1], 1.0], Class::Car);
            fill(g, [x + 4.2, car[0], 1.0], [x + 6.6, car[1], 1.8], Class::Car);
        }
    }
    fill(g, [14.0, -2.8, ground], [20.8, -0.4, 3.0], Class::Truck);
    fill(g, [-22.0, 0.6, ground], [-11.0, 3.4, 3.4], Class::Bus);
    fill(g, [8.0, 4.0, ground], [8.8, 4.8, 1.8], Class::Pedestrian);
    let mut bev = vec![0; Window::COLUMNS];
    for x in 0..Window::NX {
        bev[x * Window::NY + 100] |= BevLayer::RoadDivider.bit();
        if x % 10 < 5 {
            bev[x * Window::NY + 91] |= BevLayer::LaneDivider.bit();
            bev[x * Window::NY + 109] |= BevLayer::LaneDivider.bit();
        }
        if (122..130).contains(&x) {
            for y in 82..118 {
                bev[x * Window::NY + y] |= BevLayer::PedCrossing.bit();
            }
        }
    }
    (grid, bev)
}
