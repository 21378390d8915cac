//! A synthetic street for looking at the viewport: road, walkways, cars, buildings, trees, a sweep.

use glam::{DVec2, DVec3};
use scene::{
    BevLayer, BevLayout, BoxId, BoxLabel, Class, LidarPoint, LidarSweep, Polyline, PolylineKind, SceneBox,
    VoxelGrid, Window, raster,
};

pub struct Street {
    pub grid: VoxelGrid,
    pub bev: Vec<u32>,
    pub boxes: Vec<SceneBox>,
    pub sweep: LidarSweep,
}

fn noise(x: usize, y: usize, z: usize) -> f64 {
    let mut h = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F)
        ^ (z as u64).wrapping_mul(0x1656_67B1_9E37_79F9);
    h = (h ^ h >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((h ^ h >> 32) & 0xffff) as f64 / 65536.0
}

pub fn street() -> Street {
    let mut layout = BevLayout::default();
    let mut grid = VoxelGrid::new();
    // A main road along x and a side road along y at x = 14 m.
    let road = |x: f64, y: f64| (-8.0..8.0).contains(&y) || (10.0..19.0).contains(&x);
    let walk = |x: f64, y: f64| (-11.5..11.5).contains(&y) || (6.8..22.2).contains(&x);
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            let c = Window::center(x, y, 0);
            if road(c.x, c.y) {
                layout.set(BevLayer::DrivableArea, x, y, true);
                grid.set(x, y, 0, Class::DriveableSurface.id());
            } else if walk(c.x, c.y) {
                layout.set(BevLayer::Walkway, x, y, true);
                grid.set(x, y, 0, Class::Sidewalk.id());
            } else {
                grid.set(x, y, 0, Class::Terrain.id());
                if noise(x / 6, y / 6, 1) > 0.7 && noise(x, y, 2) > 0.35 {
                    grid.set(x, y, 1, Class::Terrain.id());
                }
            }
        }
    }
    let line = |kind, points: &[[f64; 2]]| Polyline {
        kind,
        points_m: points.iter().map(|p| DVec2::from_array(*p)).collect(),
    };
    for (from, to) in [(-40.0, 9.0), (20.0, 40.0)] {
        let divider = line(PolylineKind::RoadDivider, &[[from, 0.1], [to, 0.1]]);
        raster::draw_polyline(&mut layout, &divider);
        for side in [-4.0, 4.0] {
            let mut x = from;
            while x < to {
                let lane = line(PolylineKind::LaneDivider, &[[x, side], [(x + 2.2).min(to), side]]);
                raster::draw_polyline(&mut layout, &lane);
                x += 4.4;
            }
        }
    }
    for x in [7.6, 20.4] {
        let outline = [[x - 1.4, -7.8], [x + 1.4, -7.8], [x + 1.4, 7.8], [x - 1.4, 7.8]];
        raster::draw_polyline(&mut layout, &line(PolylineKind::PedCrossing, &outline));
    }
    for (x, y0, y1) in [(4.9, -7.8, 0.0), (23.0, 0.0, 7.8)] {
        raster::draw_polyline(&mut layout, &line(PolylineKind::StopLine, &[[x, y0], [x, y1]]));
    }

    buildings(&mut grid);
    for (x, y) in [
        (-30.0, 10.0),
        (-20.0, 10.2),
        (-10.5, 9.8),
        (0.5, 10.1),
        (27.0, 10.0),
        (35.0, 9.9),
        (-34.0, -10.0),
        (-23.0, -10.3),
        (-12.0, -9.9),
        (-1.0, -10.0),
        (25.5, -10.1),
        (33.5, -10.0),
        (8.0, 26.0),
        (8.2, 34.0),
        (21.0, -24.0),
        (21.2, -33.0),
        (-31.0, 26.0),
        (-24.0, 30.0),
        (-36.0, 33.0),
        (-29.0, 36.0),
        (31.0, -31.0),
        (36.0, -36.0),
        (28.0, -37.0),
    ] {
        tree(&mut grid, x, y);
    }
    let mut boxes = Vec::new();
    let spots: &[(Class, f64, f64, f64)] = &[
        (Class::Car, 16.0, 2.0, 180.0),
        (Class::Car, -12.0, -6.1, 0.0),
        (Class::Car, -19.0, -6.0, 1.0),
        (Class::Car, -12.5, 6.1, 180.0),
        (Class::Car, 29.0, -2.0, 2.0),
        (Class::Truck, 12.2, -18.0, 90.0),
        (Class::Bus, -25.0, 2.1, 180.0),
        (Class::Car, 16.8, 22.0, -91.0),
        (Class::Bicycle, 3.0, -6.9, 0.0),
        (Class::Motorcycle, 30.5, 6.4, 175.0),
        (Class::Pedestrian, 7.5, 4.0, 90.0),
        (Class::Pedestrian, 7.9, 3.0, 90.0),
        (Class::Pedestrian, -3.0, 9.6, 10.0),
        (Class::Pedestrian, 20.2, -5.0, -90.0),
        (Class::TrafficCone, 25.0, -6.6, 0.0),
        (Class::TrafficCone, 27.5, -6.6, 0.0),
        (Class::Barrier, 31.0, -7.2, 0.0),
        (Class::Trailer, 36.0, 2.2, 180.0),
        (Class::ConstructionVehicle, 34.5, -6.0, 15.0),
    ];
    for (i, (class, x, y, yaw)) in spots.iter().enumerate() {
        let size = DVec3::from_array(class.typical_size_m().expect("an object"));
        let b = SceneBox {
            id: BoxId(i as u32 + 1),
            class: *class,
            center_m: DVec3::new(*x, *y, size.z / 2.0),
            size_m: size,
            yaw_rad: yaw.to_radians(),
            velocity_mps: DVec2::ZERO,
            label: BoxLabel::default(),
        };
        solid_box(&mut grid, &b);
        boxes.push(b);
    }
    let bev = raster::bev_channels(&layout, boxes.iter());
    let sweep = sweep(&grid);
    Street {
        grid,
        bev,
        boxes,
        sweep,
    }
}

fn buildings(grid: &mut VoxelGrid) {
    let blocks = [
        (-39.0, -22.0, 12.5, 22.0, 16),
        (-20.0, -6.0, 12.5, 25.0, 12),
        (-4.0, 6.0, 13.0, 21.0, 16),
        (23.5, 39.5, 13.0, 30.0, 16),
        (-40.0, -27.0, -24.0, -12.5, 14),
        (-25.0, -13.0, -30.0, -13.0, 9),
        (-10.0, 5.5, -22.0, -12.8, 16),
        (24.0, 39.8, -27.0, -13.0, 13),
    ];
    for (x0, x1, y0, y1, top) in blocks {
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                let c = Window::center(x, y, 0);
                if !((x0..x1).contains(&c.x) && (y0..y1).contains(&c.y)) {
                    continue;
                }
                for z in 1..top {
                    // Windows, one voxel deep, in rows.
                    let rim = c.x - x0 < 0.4 || x1 - c.x < 0.4 || c.y - y0 < 0.4 || y1 - c.y < 0.4;
                    let window = rim && z % 5 >= 3 && (x % 6 < 3) && (y % 6 < 3);
                    if !window {
                        grid.set(x, y, z, Class::Manmade.id());
                    }
                }
            }
        }
    }
}

fn tree(grid: &mut VoxelGrid, x_m: f64, y_m: f64) {
    let Some([cx, cy]) = Window::column_at(x_m, y_m) else {
        return;
    };
    let size = 3.2 + 2.2 * noise(cx, cy, 3);
    for z in 1..6 {
        grid.set(cx, cy, z, Class::Vegetation.id());
    }
    for x in cx.saturating_sub(7)..(cx + 8).min(Window::NX) {
        for y in cy.saturating_sub(7)..(cy + 8).min(Window::NY) {
            for z in 4..Window::NZ {
                let d = DVec3::new(
                    x as f64 - cx as f64,
                    y as f64 - cy as f64,
                    (z as f64 - 9.0) * 0.95,
                );
                let r = d.length() / size + 0.45 * (noise(x, y, z) - 0.5);
                if r < 0.95 {
                    grid.set(x, y, z, Class::Vegetation.id());
                }
            }
        }
    }
}

/// Voxels of a box, two bins lower than physical, rounded like a car where it is one.
fn solid_box(grid: &mut VoxelGrid, b: &SceneBox) {
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            for z in 0..Window::NZ {
                let p = b.to_local(Window::center(x, y, z) + DVec3::Z * 0.6) / (b.size_m / 2.0);
                let cabin = !matches!(b.class, Class::Car) || p.z < 0.1 || (-0.75..0.35).contains(&p.x);
                if p.abs().max_element() <= 1.05 && cabin {
                    grid.set(x, y, z, b.class.id());
                }
            }
        }
    }
}

/// Marches 32 beams of 1084 columns through the voxels; coarse, but it lands on them.
fn sweep(grid: &VoxelGrid) -> LidarSweep {
    let origin = DVec3::new(0.9, 0.0, 1.24);
    let mut points = Vec::new();
    for ring in 0..32u16 {
        let elevation = (-30.67 + f64::from(ring) * 1.333).to_radians();
        for azimuth in 0..1084u16 {
            let a = f64::from(azimuth) / 1084.0 * std::f64::consts::TAU;
            let dir = DVec3::new(
                a.cos() * elevation.cos(),
                a.sin() * elevation.cos(),
                elevation.sin(),
            );
            let mut t = 2.5;
            while t < 60.0 {
                let p = origin + dir * t;
                if let Some([x, y, z]) = Window::voxel_at(p)
                    && let Some(class) = Class::from_id(grid.get(x, y, z)).filter(|c| *c != Class::Free)
                {
                    points.push(LidarPoint {
                        position_in_ego: p.as_vec3().to_array(),
                        range_m: t as f32,
                        ring,
                        azimuth,
                        class,
                        intensity: 0.0,
                        drop_probability: 0.0,
                        time_s: 0.0,
                        velocity_mps: [0.0; 2],
                    });
                    break;
                }
                t += 0.03;
            }
        }
    }
    LidarSweep {
        points,
        rays: 32 * 1084,
        physical: false,
        provenance: Vec::new(),
    }
}
