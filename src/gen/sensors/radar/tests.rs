use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::*;
use scene::rig_presets::RADARS;
use scene::{BevLayout, BoxId, Class, Frame, Lattice, RadarReturn, SceneBox, SensorRig};

/// Cars and trucks on a flat road, the vehicle at a speed, and a radar at its front.
fn road(boxes: &[SceneBox], ego_mps: f64, preset: usize) -> Scene {
    let layout = BevLayout::default();
    let voxels = scene::draft::draft(&layout, boxes.iter());
    let boxes: BTreeMap<_, _> = boxes.iter().map(|b| (b.id, *b)).collect();
    let rig = SensorRig {
        ego_speed_mps: ego_mps,
        radars: vec![(RADARS[preset].build)()],
        ..SensorRig::default()
    };
    let mut scene = Scene::single("road", Frame::new(layout, boxes, voxels), Arc::new(rig), 1);
    scene.seed = 7;
    scene
}

fn standing(id: u32, class: Class, x: f64, y: f64, velocity: [f64; 2]) -> SceneBox {
    let size = DVec3::from_array(class.typical_size_m().expect("an object"));
    SceneBox {
        id: BoxId(id),
        class,
        center_m: DVec3::new(x, y, size.z / 2.0),
        size_m: size,
        yaw_rad: 0.0,
        velocity_mps: DVec2::from_array(velocity),
        label: Default::default(),
    }
}

/// Returns that lie in a box, or a step of range before it.
fn within(scene: &Scene, scan: &RadarScan, id: u32) -> Vec<RadarReturn> {
    let b = scene.frame().boxes[&BoxId(id)];
    let holds = |r: &&RadarReturn| {
        let local = b.to_local(
            DVec3::from_array(r.position_m.map(f64::from))
                .truncate()
                .extend(b.center_m.z),
        );
        (local.truncate().abs() - b.size_m.truncate() / 2.0).max_element() < 1.0
    };
    scan.returns.iter().filter(holds).copied().collect()
}

fn mean(values: impl Iterator<Item = f32>) -> f64 {
    let all: Vec<f64> = values.map(f64::from).collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

/// Scans of a scene at several moments of chance.
fn often(scene: &Scene, times: u64) -> Vec<RadarScan> {
    let one = |seed| {
        let mut scene = scene.clone();
        scene.seed = seed;
        scan(&scene, &scene.rig.radars[0])
    };
    (0..times).map(one).collect()
}

#[test]
fn range_azimuth_and_speed_are_those_of_the_car() {
    // Ahead a car that drives at 20 m/s while we drive at 15, to the left one that comes towards us at 10.
    let cars = [
        standing(1, Class::Car, 40.0, 0.0, [20.0, 0.0]),
        standing(2, Class::Car, 25.0, 10.0, [-10.0, 0.0]),
    ];
    let scene = road(&cars, 15.0, 0);
    let scans = often(&scene, 20);
    let of = |id| -> Vec<RadarReturn> { scans.iter().flat_map(|scan| within(&scene, scan, id)).collect() };
    let (ahead, left) = (of(1), of(2));
    assert!(
        ahead.len() >= 15 && left.len() >= 15,
        "{} {}",
        ahead.len(),
        left.len()
    );
    // Its rear is 40 - 2.3 m from the axle, the radar 3.4 m before that.
    let rear_m = 40.0 - scene.frame().boxes[&BoxId(1)].size_m.x / 2.0 - 3.4;
    assert!((mean(ahead.iter().map(|r| r.range_m)) - rear_m).abs() < 1.0);
    assert!(mean(ahead.iter().map(|r| r.azimuth_rad)).abs() < 0.03);
    assert!((mean(ahead.iter().map(|r| r.speed_mps)) - 5.0).abs() < 0.1);
    assert!((mean(ahead.iter().map(|r| r.speed_over_ground_mps)) - 20.0).abs() < 0.1);
    // The other one: the part of 10 m/s along the ray, and of our speed.
    for r in &left {
        let along = f64::from(r.azimuth_rad).cos();
        assert!(
            (f64::from(r.speed_over_ground_mps) + 10.0 * along).abs() < 0.5,
            "{r:?}"
        );
        assert!((f64::from(r.speed_mps) + 25.0 * along).abs() < 0.5, "{r:?}");
        assert_eq!((r.class, r.elevation_rad), (Class::Car, None));
    }
}

#[test]
fn strength_follows_class_and_distance() {
    let one = |class, x| {
        let scene = road(&[standing(1, class, x, 0.0, [0.0; 2])], 0.0, 0);
        let scans = often(&scene, 40);
        let strongest = scans.iter().filter_map(|scan| {
            let own = within(&scene, scan, 1);
            own.into_iter().max_by(|a, b| a.rcs_dbsm.total_cmp(&b.rcs_dbsm))
        });
        let found: Vec<RadarReturn> = strongest.collect();
        let rcs = mean(found.iter().map(|r| r.rcs_dbsm));
        (found.len(), rcs, mean(found.iter().map(|r| r.snr_db)))
    };
    let (cars, car, near_db) = one(Class::Car, 30.0);
    let (_, truck, _) = one(Class::Truck, 30.0);
    let (people, person, _) = one(Class::Pedestrian, 15.0);
    assert!(cars >= 38 && people >= 30, "{cars} {people}");
    assert!((4.0..16.0).contains(&car), "a car of {car} dBsm");
    assert!(truck > car + 4.0 && person < car - 8.0, "{truck} {car} {person}");
    // Twelve decibels for twice the distance, less what more of the car in one cell gives.
    let (_, _, close_db) = one(Class::Car, 18.0);
    assert!(
        (6.0..13.0).contains(&(close_db - near_db)),
        "{close_db} {near_db}"
    );
}

#[test]
fn a_car_hides_what_is_behind_and_a_radar_with_heights_tells_them() {
    let boxes = [
        standing(1, Class::Truck, 20.0, 0.0, [0.0; 2]),
        standing(2, Class::Car, 34.0, 0.0, [0.0; 2]),
    ];
    let scene = road(&boxes, 0.0, 2);
    let scan = scan(&scene, &scene.rig.radars[0]);
    let truck = within(&scene, &scan, 1);
    assert!(truck.len() > 3 && within(&scene, &scan, 2).is_empty());
    let up: Vec<f32> = truck.iter().filter_map(|r| r.elevation_rad).collect();
    assert_eq!(up.len(), truck.len());
    let highest = up.iter().copied().fold(f32::MIN, f32::max);
    assert!(highest > 0.04, "{highest}");
}

#[test]
fn a_scan_is_one_function_of_its_scene() {
    let cars = [standing(1, Class::Car, 40.0, 0.0, [20.0, 0.0])];
    let scene = road(&cars, 15.0, 0);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| scans(&scene))
    };
    let scans = run(1);
    assert_eq!(scans, run(3));
    assert!(scans[0].returns.len() <= scene.rig.radars[0].most_returns as usize);
    assert!(scans[0].returns.is_sorted_by(|a, b| a.snr_db >= b.snr_db));
    // The strongest stay where fewer are wanted.
    let mut few = scene.rig.radars[0].clone();
    few.most_returns = 2;
    assert_eq!(scan(&scene, &few).returns, scans[0].returns[..2]);
}

#[test]
fn extreme_radars_give_finite_returns_or_none() {
    let cars = [standing(1, Class::Car, 12.0, 0.0, [1e3, -1e3])];
    for change in [
        (|r: &mut RadarPattern| r.car_range_m = 10_000.0) as fn(&mut RadarPattern),
        |r| r.car_range_m = 0.1,
        |r| r.fields[0].half_azimuth_deg = 180.0,
        |r| r.half_elevation_deg = 90.0,
        |r| r.speeds_mps = [-0.06, 0.06],
        |r| r.translation_m = [12.0, 0.0, 0.9],
        |r| r.rotation_wxyz = [0.0, 1.0, 0.0, 0.0],
        |r| r.translation_m = [1e6, 0.0, 0.0],
    ] {
        let mut scene = road(&cars, 190.0, 0);
        change(&mut Arc::make_mut(&mut scene.rig).radars[0]);
        assert_eq!(scene.rig.problem(), None);
        for r in &scan(&scene, &scene.rig.radars[0]).returns {
            let numbers = [
                r.range_m,
                r.azimuth_rad,
                r.speed_mps,
                r.speed_over_ground_mps,
                r.rcs_dbsm,
                r.snr_db,
            ];
            assert!(
                numbers.iter().chain(&r.position_m).all(|v| v.is_finite()),
                "{r:?}"
            );
        }
    }
    let mut none = road(&cars, 0.0, 0);
    Arc::make_mut(&mut none.rig).radars.clear();
    assert!(scans(&none).is_empty() && none.canvas().extent().lattice() == Lattice::OCC3D);
}

#[test]
fn in_a_clip_the_own_motion_counts_with_its_turn_and_labels_of_what_stands_do_not() {
    // The vehicle reverses at 5 m/s; a car whose label says 10 m/s has no motion of its own.
    let mut scene = road(&[standing(1, Class::Car, 25.0, 0.0, [10.0, 0.0])], 0.0, 0);
    let key = |time_s: f64, x: f64| scene::Key {
        time_s,
        at_m: DVec2::new(x, 0.0),
        yaw_deg: 0.0,
    };
    scene.change_clip(|clip| {
        clip.length_s = 4.0;
        clip.ego = Some(scene::Motion::Keys(vec![key(0.0, 0.0), key(4.0, -20.0)]));
    });
    let scene = scene.at(1.0).for_sensors().into_owned();
    let scans = often(&scene, 10);
    let ahead: Vec<RadarReturn> = scans.iter().flat_map(|scan| within(&scene, scan, 1)).collect();
    assert!(ahead.len() >= 8, "{}", ahead.len());
    assert!((mean(ahead.iter().map(|r| r.speed_mps)) - 5.0).abs() < 0.2);
    assert!(mean(ahead.iter().map(|r| r.speed_over_ground_mps)).abs() < 0.2);
}

#[test]
fn the_road_is_no_target_and_rays_end_on_it() {
    let scene = road(&[], 0.0, 0);
    let mut radar = scene.rig.radars[0].clone();
    (radar.car_range_m, radar.most_returns) = (5000.0, 1000);
    let found = scan(&scene, &radar).returns;
    assert!(found.iter().all(|r| r.rcs_dbsm >= -20.1), "{found:?}");
    // A ray to labels below the road ends at its true height.
    let origin = glam::DVec3::new(3.4, 0.0, 0.5);
    let below = scene::LidarPoint {
        position_in_ego: [8.4, 0.0, -0.6],
        range_m: 5.1,
        ring: 0,
        azimuth: 0,
        class: Class::Manmade,
        intensity: 0.0,
        drop_probability: 0.0,
        time_s: 0.0,
        velocity_mps: [0.0; 2],
    };
    let (at, class) = above_ground(&scene, origin, &below);
    assert!(
        at.z.abs() < 1e-6 && class.is_ground() && (at.x - 5.673).abs() < 0.01,
        "{at}"
    );
}
