//! Tests of the marched camera maps.

use super::*;
use scene::{Polyline, PolylineKind, Window};
use world::World;
use world::voxelize::{Vertical, complete};

fn everything() -> [MarchOptions; 4] {
    let options = |ground, boxes| MarchOptions {
        ground,
        boxes,
        ..MarchOptions::default()
    };
    [
        options(GroundHeight::AsLabelled, false),
        options(GroundHeight::AsLabelled, true),
        options(GroundHeight::Physical, false),
        options(GroundHeight::Physical, true),
    ]
}

fn of_world(seed: u64, options: &MarchOptions) -> (World, MarchScene) {
    let world = World::random_level(seed);
    let grid = complete(&world, Vertical::Occ3d);
    let scene = MarchScene::new(&grid, &world.layout, &world.boxes, options);
    (world, scene)
}

fn empty(grid: &VoxelGrid, options: &MarchOptions) -> MarchScene {
    MarchScene::new(grid, &BevLayout::default(), &BTreeMap::new(), options)
}

#[test]
fn plain_march_is_the_exact_ray_cast() {
    let world = World::random(11);
    let grid = complete(&world, Vertical::Occ3d);
    let scene = empty(&grid, &everything()[0]);
    let masks = ColumnMasks::from_grid(&grid);
    let rig = SensorRig::default();
    let maps = scene.render(&rig.cameras[1], 80, 45);
    let rays = CameraRays::new(&rig.cameras[1], 80, 45);
    let mut hits = 0;
    for (i, found) in maps.hits.iter().enumerate() {
        let dir = rays.at((i % 80) as f64 + 0.5, (i / 80) as f64 + 0.5).direction;
        let truth = masks.cast(rays.origin, dir.normalize(), 1e9);
        assert_eq!(found.is_some(), truth.is_some());
        if let (Some(f), Some(t)) = (found, truth) {
            hits += 1;
            assert!((f.t * dir.length() - t.range_m).abs() < 1e-9);
            assert_eq!(f.id, grid.get(t.voxel[0], t.voxel[1], t.voxel[2]));
            assert!((f.normal.length() - 1.0).abs() < 1e-12 && f.normal.dot(dir) < 0.0);
        }
    }
    assert!(hits > 1500, "{hits}");
}

#[test]
fn physical_ground_lies_where_the_world_has_it() {
    for (seed, options) in [(3, &everything()[2]), (8, &everything()[3])] {
        let (world, scene) = of_world(seed, options);
        let rays = CameraRays::new(&SensorRig::default().cameras[1], 80, 45);
        let (mut n, mut near) = (0, 0);
        for i in 0..80 * 45 {
            let dir = rays
                .at(f64::from(i % 80) + 0.5, f64::from(i / 80) + 0.5)
                .direction
                .normalize();
            let truth = world.cast(rays.origin, dir, 1e3);
            if let (Some(truth), Some(found)) = (truth, scene.cast(rays.origin, dir))
                && truth.class == Class::DriveableSurface
                && found.id == truth.class.id()
            {
                n += 1;
                near += usize::from((found.t - truth.range_m).abs() < 0.02);
            }
        }
        assert!(n > 500 && near * 100 > n * 97, "{near} of {n}");
    }
}

#[test]
fn boxes_replace_their_voxels_and_the_road_below_them_returns() {
    let (world, scene) = of_world(3, &everything()[3]);
    let b = world
        .boxes
        .values()
        .find(|b| b.class == Class::Car)
        .expect("traffic has cars");
    let above = b.center_m + DVec3::Z * 30.0;
    let hit = scene.cast(above, -DVec3::Z).expect("a roof");
    assert_eq!((hit.id, hit.box_id), (Class::Car.id(), Some(b.id)));
    let top = b.center_m.z + b.size_m.z / 2.0;
    assert!((above.z - hit.t - top).abs() < 0.02, "{hit:?}");
    // Between the wheels, below the sill, one looks through to the other side or onto the ground.
    let side = b.to_ego(DVec3::new(0.0, b.size_m.y / 2.0 + 0.25, 0.0));
    let low = scene
        .cast(side.truncate().extend(1.0), -DVec3::Z)
        .expect("ground");
    assert!(low.box_id.is_none() && low.t > 0.7, "{low:?}");
}

/// The lists of boxes per piece of a row leave none out.
#[test]
fn pictures_equal_single_rays() {
    let (_, scene) = of_world(6, &everything()[3]);
    let mut rig = SensorRig::default();
    rig.cameras[0].focal_px = [700.0 / 2.0 / 85f64.to_radians().tan(); 2];
    rig.cameras[2].translation_m = [12.0, 3.0, 0.6];
    let mut on_boxes = 0;
    for camera in &rig.cameras {
        let maps = scene.render(camera, 101, 57);
        let rays = CameraRays::new(camera, 101, 57);
        for (i, found) in maps.hits.iter().enumerate() {
            let dir = rays.at((i % 101) as f64 + 0.5, (i / 101) as f64 + 0.5).direction;
            assert_eq!(*found, scene.cast(rays.origin, dir));
            on_boxes += usize::from(found.is_some_and(|h| h.box_id.is_some()));
        }
    }
    assert!(on_boxes > 150, "{on_boxes}");
}

#[test]
fn lines_are_finer_than_voxels_and_follow_the_cells() {
    let mut grid = VoxelGrid::new();
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            grid.set(x, y, 0, Class::DriveableSurface.id());
        }
    }
    let line = Polyline {
        kind: PolylineKind::LaneDivider,
        points_m: vec![DVec2::new(-30.0, 1.0), DVec2::new(30.0, 4.0)],
    };
    let mut cells = BevLayout::default();
    scene::raster::draw_polyline(&mut cells, &line);
    cells.set(scene::BevLayer::RoadDivider, 150, 60, true);
    let erased = 5;
    for x in 0..erased {
        for y in 0..Window::NY {
            cells.set(scene::BevLayer::LaneDivider, 25 + x, y, false);
        }
    }
    let layout = BevLayout::from_cells(cells.cells().to_vec(), vec![line]).expect("40,000");
    for options in everything() {
        let scene = MarchScene::new(&grid, &layout, &BTreeMap::new(), &options);
        let id = |x: f64, y: f64| scene.cast(DVec3::new(x, y, 3.0), -DVec3::Z).expect("road").id;
        for x in [-20.0, 0.3, 17.7] {
            let y = 2.5 + x * 0.05;
            assert_eq!((id(x, y), id(x, y + 0.18), id(x, y - 0.18)), (19, 19, 19));
            assert_eq!((id(x, y + 0.22), id(x, y - 0.22)), (11, 11));
        }
        let p = Window::center(150, 60, 0);
        assert_eq!(
            (id(p.x, p.y), id(p.x + 0.19, p.y - 0.19), id(p.x + 0.21, p.y)),
            (18, 18, 11)
        );
        let x = Window::center(27, 0, 0).x;
        assert_eq!(id(x, 2.5 + x * 0.05), 11, "erased");
    }
}

/// Row 45 of the extremes table, and what else may come.
#[test]
fn row_45_march_bears_anything() {
    let mut full = VoxelGrid::new();
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            full.column_mut(x, y).fill(if (x + y) % 7 == 0 { 11 } else { 16 });
        }
    }
    let world = World::random(2);
    let street = complete(&world, Vertical::Occ3d);
    let mut camera = SensorRig::default().cameras[1].clone();
    let pick = [
        0.0,
        -0.0,
        1e-300,
        1.0,
        -1.0,
        0.4,
        40.0,
        -40.0,
        1e6,
        f64::NAN,
        f64::INFINITY,
    ];
    for grid in [&VoxelGrid::new(), &full, &street] {
        for options in everything() {
            let scene = MarchScene::new(grid, &world.layout, &world.boxes, &options);
            for (i, &ox) in pick.iter().enumerate() {
                for (k, &dx) in pick.iter().enumerate() {
                    let o = DVec3::new(ox, pick[(i * 3 + k) % 9], [-0.6, 0.0, 1.5, 5.4][k % 4]);
                    for d in [
                        DVec3::new(dx, 0.0, 0.0),
                        DVec3::new(0.0, dx, -0.0),
                        DVec3::new(0.0, 0.0, -dx),
                        DVec3::new(dx, dx, dx),
                        DVec3::new(dx, -dx, -1e-9),
                        DVec3::new(1.0, dx, -0.02),
                    ] {
                        if let Some(hit) = scene.cast(o, d) {
                            assert!(hit.t >= 0.0 && hit.t.is_finite(), "{o} {d} {hit:?}");
                            assert!((hit.normal.length() - 1.0).abs() < 1e-6, "{o} {d} {hit:?}");
                            assert!(hit.id < 20);
                        }
                    }
                }
            }
            // A lens of 170 degrees, a camera inside a voxel, a broken pose.
            camera.focal_px = [800.0 / 2.0 / 85f64.to_radians().tan(); 2];
            for place in [
                [1.5, 0.0, 1.5],
                [0.0, 0.0, -0.8],
                [f64::NAN, 0.0, 0.0],
                [1e9, 0.0, 1.0],
            ] {
                camera.translation_m = place;
                let maps = scene.render(&camera, 61, 33).into_camera_maps("X");
                assert_eq!(maps.semantic.len(), 61 * 33);
                assert!(maps.depth_m.iter().all(|d| *d == -1.0 || *d >= 0.0));
            }
            assert!(scene.render(&camera, 0, 9).hits.is_empty());
        }
    }
    let inside = empty(&full, &everything()[0]).cast(DVec3::new(0.1, 0.1, 1.0), DVec3::X);
    assert_eq!(inside.expect("full").t, 0.0);
    assert!(
        empty(&VoxelGrid::new(), &everything()[2])
            .cast(DVec3::Z, -DVec3::Z)
            .is_none()
    );
}

#[test]
fn threads_do_not_matter() {
    let (_, scene) = of_world(6, &everything()[3]);
    let rig = SensorRig::default();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| scene.render_rig(&rig, 160, 90))
    };
    assert_eq!(on(1), on(3));
}
