//! Sensors on maps that are larger than the networks' window.

use glam::{DVec2, DVec3};

use crate::beyond::border::{Border, Covered};
use crate::cameras::{
    self, CameraInput, CameraPicture, Detail, PreparedSource, RenderContext, RenderOptions,
};
use crate::lidar;
use crate::lidar::caster::Caster;
use crate::lidar::learned::{self, Drops};
use crate::lidar::learned_caster::LearnedCaster;
use crate::lidar::surroundings::{is_beyond, is_own};
use crate::pictures::mpi::{self, RenderIds};
use crate::raycast::ColumnMasks;
use crate::splat::cloud::GaussianCloud;
use nets::lidar::LidarNet;
use scene::sensor_data::PlaneDepths;
use scene::{
    Background, BevLayer, BevLayout, Camera, CameraMaps, Class, Conditions, Extent, Frame, LidarPattern,
    SensorRig, VoxelGrid, Window,
};
use world::World;
use world::voxelize::{Vertical, complete};

/// Where the wall stands, m ahead.
const WALL_M: f64 = 100.0;
/// Width of the pictures here; the middle pixel looks straight ahead.
const SIZE: [u32; 2] = [401, 225];

fn map() -> Extent {
    Extent::new([-150, -110], [480, 320]).expect("sound")
}

/// Road everywhere and a wall across it.
fn walled() -> VoxelGrid {
    let extent = map();
    let mut grid = VoxelGrid::over(extent);
    for [x, y] in extent.all_columns() {
        grid.set(x, y, 0, Class::DriveableSurface.id());
    }
    let [x, _] = extent.column_at(WALL_M + 0.2, 0.0).expect("inside");
    for (y, z) in (0..extent.ny()).flat_map(|y| (1..Window::NZ).map(move |z| (y, z))) {
        grid.set(x, y, z, Class::Manmade.id());
    }
    grid
}

/// One beam straight ahead.
fn one_ray() -> LidarPattern {
    LidarPattern {
        elevations_deg: vec![0.0],
        columns: 1,
        rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
        translation_m: [0.9, 0.1, 1.5],
        max_range_m: 150.0,
        own_body: false,
        beyond_grid: false,
        ..SensorRig::default().lidars[0].clone()
    }
}

fn ahead() -> Camera {
    let mut camera = SensorRig::default().cameras[1].clone();
    camera.rotation_wxyz = [0.5, -0.5, 0.5, -0.5];
    camera.translation_m = [1.5, 0.1, 1.5];
    [camera.width, camera.height] = SIZE;
    (camera.focal_px, camera.center_px) = ([320.0; 2], [200.5, 112.5]);
    camera
}

fn picture(name: &str, grid: &VoxelGrid) -> CameraPicture {
    let mut layout = BevLayout::over(grid.extent());
    let shown = grid.extent();
    for [x, y] in shown.all_columns() {
        layout.set(BevLayer::DrivableArea, x, y, true);
    }
    let source = cameras::all().iter().find(|s| s.id().name() == name);
    let input = CameraInput {
        frame: &Frame::new(layout, Default::default(), grid.clone()),
        rig: &SensorRig::default(),
        background: &Background::default(),
        conditions: Conditions::default(),
        detail: Detail::Live,
        paint: None,
        cache: None,
    };
    let options = RenderOptions {
        size: SIZE,
        quality: crate::pictures::appearance::Quality::Preview,
    };
    let ready = PreparedSource::new(*source.expect("a source"), &input);
    let picture = ready.render(&ahead(), &options, RenderContext::processor());
    picture.expect("a small picture")
}

fn maps(name: &str, grid: &VoxelGrid) -> CameraMaps {
    match picture(name, grid) {
        CameraPicture::Maps(maps) => maps,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_pulse_meets_a_wall_far_beyond_the_window() {
    let (grid, pattern) = (walled(), one_ray());
    let point = lidar::sweep(&grid, &pattern, None).points[0];
    assert_eq!(point.class, Class::Manmade);
    assert!(
        (f64::from(point.range_m) - (WALL_M - 0.9)).abs() < 1e-5,
        "{point:?}"
    );
    assert!(
        lidar::sweep(&grid.crop(Extent::WINDOW), &pattern, None)
            .points
            .is_empty()
    );
    let masks = ColumnMasks::from_grid(&grid);
    let hit = masks
        .cast(pattern.translation_m.into(), DVec3::X, 1e3)
        .expect("the wall");
    assert_eq!(hit.voxel, [400, 110, 6]);
    assert!((hit.range_m - (WALL_M - 0.9)).abs() < 1e-9);
}

/// Splats, voxels and shapes show the wall and the road before it.
#[test]
fn cameras_see_a_wall_far_beyond_the_window() {
    let (grid, [width, height]) = (walled(), SIZE.map(|n| n as usize));
    let middle = height / 2 * width + width / 2;
    let far_m = WALL_M - 1.5;
    for name in ["splats", "voxels", "shapes"] {
        let found = maps(name, &grid);
        assert_eq!(found.semantic[middle], Class::Manmade.id(), "{name}");
        let depth_m = f64::from(found.depth_m[middle]);
        assert!(
            (far_m - 1e-4..far_m + 0.5).contains(&depth_m),
            "{name}: {depth_m}"
        );
        // 60 m ahead, where the window has ended.
        let ground_m = if name == "shapes" { 0.0 } else { -0.6 };
        let row = 112 + (320.0 * (1.5 - ground_m) / 58.5) as usize;
        let at = row * width + width / 2;
        assert_eq!(found.semantic[at], Class::DriveableSurface.id(), "{name}");
        assert!(
            (50.0..66.0).contains(&found.depth_m[at]),
            "{name}: {}",
            found.depth_m[at]
        );
        let window = maps(name, &grid.crop(Extent::WINDOW));
        assert!(window.semantic[middle] != Class::Manmade.id(), "{name}");
        assert!(window.depth_m.iter().all(|d| *d < 40.0), "{name}");
    }
    let CameraPicture::Layout(found) = picture("layout", &grid) else {
        panic!("a layout");
    };
    let at = (112 + (320.0 * 1.5 / 58.5) as usize) * width + width / 2;
    assert_eq!(found.channels[at], 1 << 3, "drivable");
}

#[test]
fn planes_and_clouds_reach_as_far_as_the_map() {
    let grid = walled();
    let planes = PlaneDepths {
        count: 400,
        near_m: 90.0,
        far_m: 110.0,
    };
    let camera = ahead();
    let image = mpi::render(&RenderIds::new(&grid, &[]), &camera, SIZE[0], SIZE[1], planes);
    let [run] = *image.pixel(112 * SIZE[0] as usize + 200) else {
        panic!("one wall");
    };
    let (from_m, to_m) = (planes.depth_m(run.first), planes.depth_m(run.end));
    assert_eq!(run.id, Class::Manmade.id());
    assert!(
        (from_m - 98.5).abs() < 0.06 && (to_m - 98.9).abs() < 0.06,
        "{from_m} {to_m}"
    );
    let cloud = GaussianCloud::from_grid(&grid, &vec![0; map().columns()]);
    assert_eq!(cloud.len(), grid.count_set());
    // Of the lowest row of the wall all but the ends have no free neighbour.
    let shell = GaussianCloud::from_grid_shell(&grid, &[], 1);
    assert_eq!(shell.len(), grid.count_set() - (map().ny() - 2));
}

/// What lies in the window is met the same, cast as a window and as a part of a map. The map has no ground outside, so
/// that the continuation, which goes on from the edge of either, is left out.
#[test]
fn a_window_in_a_map_is_swept_as_it_is_alone() {
    let window = complete(&World::random(6), Vertical::Occ3d);
    let mut grid = VoxelGrid::over(map());
    grid.paste(&window);
    let mut pattern = SensorRig::default().lidars[0].clone();
    (pattern.own_body, pattern.beyond_grid) = (false, false);
    let sweep = |grid: &VoxelGrid| lidar::sweep(grid, &pattern, None).points;
    let (alone, part) = (sweep(&window), sweep(&grid));
    assert!(alone.len() > 10_000 && alone.len() == part.len());
    for (a, b) in alone.iter().zip(&part) {
        assert_eq!((a.ring, a.azimuth, a.class), (b.ring, b.azimuth, b.class));
        // One step of f32.
        assert!((a.range_m - b.range_m).abs() <= a.range_m * 2e-7, "{a:?} {b:?}");
    }
    let (alone, part) = (ColumnMasks::from_grid(&window), ColumnMasks::from_grid(&grid));
    let rays = lidar::Rays::new(&pattern, DVec3::ZERO);
    for i in 0..rays.directions.len() {
        let (origin, direction) = rays.get(i);
        let range_m = |masks: &ColumnMasks| masks.cast(origin, direction, 100.0).map(|h| h.range_m);
        match (range_m(&alone), range_m(&part)) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-6, "{a} {b}"),
            (a, b) => assert_eq!(a, b),
        }
    }
}

/// The continuation begins where the map ends and lies as high as the ground there, on maps of any shape.
#[test]
fn the_scene_goes_on_from_the_edge_of_the_map() {
    let mut pattern = SensorRig::default().lidars[0].clone();
    (pattern.own_body, pattern.max_range_m) = (false, 120.0);
    for (from, size) in [
        ([-150, -110], [480, 320]),
        ([-40, -50], [90, 130]),
        ([-3, -4], [5, 9]),
    ] {
        let extent = Extent::new(from, size).expect("sound");
        let mut grid = VoxelGrid::over(extent);
        for [x, y] in extent.all_columns() {
            grid.set(x, y, 0, Class::Sidewalk.id());
        }
        let sweep = lidar::sweep(&grid, &pattern, None);
        let covered = Covered::by(extent);
        let (mut inside, mut ground) = (0, 0);
        for p in &sweep.points {
            let at = DVec3::from_array(p.position_in_ego.map(f64::from));
            let is_ground = Class::is_ground(p.class);
            assert!(is_ground || covered.out_m(at.truncate()) < 88.0, "{p:?}");
            assert!(!is_ground || (at.z + 0.6).abs() < 1e-3, "{p:?}");
            match is_beyond(extent, p) {
                true => ground += usize::from(is_ground),
                false => inside += 1,
            }
        }
        assert!(
            ground > 100 && (inside > 100 || size[0] < 10),
            "{size:?}: {inside} {ground}"
        );
        let border = Border::of_grid(&grid, 0.0);
        assert_eq!(
            border.height_m(covered.high + DVec2::new(1.0, 5.0)),
            border.heights_m()[0]
        );
    }
}

/// A kept sweep may be given a map of another shape.
#[test]
fn a_kept_sweep_takes_another_extent() {
    let window = complete(&World::random(3), Vertical::Occ3d);
    let mut grid = walled();
    grid.paste(&window);
    let pattern = &SensorRig::default().lidars[0];
    let mut caster = Caster::new(&window, pattern, DVec3::ZERO, None);
    for grid in [&grid, &window, &grid] {
        caster.update(grid);
        assert_eq!(
            caster.sweep(),
            Caster::new(grid, pattern, DVec3::ZERO, None).sweep()
        );
    }
    grid.set(470, 200, 3, Class::Car.id());
    grid.set(151, 118, 3, Class::Car.id());
    caster.update(&grid);
    assert!(caster.cast_last() < pattern.rays());
    assert_eq!(
        caster.sweep(),
        Caster::new(&grid, pattern, DVec3::ZERO, None).sweep()
    );
}

/// What a vehicle sees goes with it over the map.
#[test]
fn a_learned_sweep_is_around_the_vehicle() {
    let net = LidarNet::bundled().expect("the shipped weights");
    let mut rig = SensorRig::default();
    (rig.lidars[0].columns, rig.lidars[0].max_range_m) = (120, 150.0);
    let grid = walled();
    let here = learned::rig_sweep(&net, &grid, &rig, Drops::Keep).expect("finite");
    let by = scene::moved::ColumnShift([300, -175]);
    let way_m = by.way_m().extend(0.0);
    let there = rig.standing_at(&scene::Pose {
        translation_m: way_m,
        ..scene::Pose::IDENTITY
    });
    let moved = by.grid(&grid);
    let found = learned::rig_sweep(&net, &moved, &there, Drops::Keep).expect("finite");
    assert_eq!(found.points.len(), here.points.len());
    for (a, b) in here.points.iter().zip(&found.points) {
        let [a_m, b_m] = [a, b].map(|p| DVec3::from_array(p.position_in_ego.map(f64::from)));
        assert!((a_m + way_m).distance(b_m) < 1e-3, "{a_m} {b_m}");
        assert_eq!((a.ring, a.azimuth, a.class), (b.ring, b.azimuth, b.class));
    }
    let kept = LearnedCaster::of_rig(net.clone(), &moved, &there)
        .expect("finite")
        .expect("a LiDAR");
    assert_eq!(kept.sweep(Drops::Keep), found);
}

/// The network sees the window; the rest of the map is met by the exact cast, at its physical height.
#[test]
fn a_learned_sweep_goes_on_beyond_the_window() {
    let net = LidarNet::bundled().expect("the shipped weights");
    let mut rig = SensorRig::default();
    (rig.lidars[0].columns, rig.lidars[0].max_range_m) = (240, 150.0);
    let grid = walled();
    let sweep = learned::rig_sweep(&net, &grid, &rig, Drops::Keep).expect("finite");
    let (mut wall, mut ground, mut level) = (0, 0, 0);
    for p in sweep.points.iter().filter(|p| is_beyond(Extent::WINDOW, p)) {
        let at = DVec3::from_array(p.position_in_ego.map(f64::from));
        match p.class {
            Class::Manmade if !is_beyond(map(), p) => {
                wall += usize::from((at.x - WALL_M).abs() < 1e-3);
            }
            Class::DriveableSurface => {
                ground += 1;
                level += usize::from(at.z.abs() < 1e-3);
            }
            _ => {}
        }
    }
    // Few that the network let through below the ground begin there.
    assert!(
        wall > 20 && ground > 100 && level * 100 > ground * 95,
        "{wall} {ground} {level}"
    );
    // Edits outside the window come through, and those inside.
    let mut kept = LearnedCaster::of_rig(net.clone(), &grid, &rig)
        .expect("finite")
        .expect("a LiDAR");
    assert_eq!(kept.sweep(Drops::Keep), sweep);
    let mut edited = grid.clone();
    for (at, is_seen) in [([90.0, 3.0], false), ([12.0, -2.0], true)] {
        let [x, y] = edited.extent().column_at(at[0], at[1]).expect("inside");
        for (dy, z) in (0..20).flat_map(|dy| (1..9).map(move |z| (dy, z))) {
            edited.set(x, y + dy, z, Class::Truck.id());
        }
        let before = kept.sweep(Drops::Keep);
        kept.update(&edited).expect("finite");
        assert_eq!(kept.shot_last() > 0, is_seen);
        let after = kept.sweep(Drops::Keep);
        assert!(after != before && after.points.iter().any(|p| p.class == Class::Truck && !is_own(p)));
        let fresh = learned::rig_sweep(&net, &edited, &rig, Drops::Keep).expect("finite");
        assert_eq!(after, fresh);
    }
}
