//! Sweeps in their sensor's frame: made ones, and real ones where they are.

use std::path::{Path, PathBuf};

use scene::BevLayer;

use super::tests::{at, street};
use super::*;
use crate::import::TrackedObject;
use crate::import::{self, Content};

fn loaded(points: &[(DVec3, Class)], with_labels: bool, lift_m: Option<f64>) -> ImportedScene {
    let mut cloud = Cloud {
        level: lift_m.map(lifted),
        is_asked: lift_m.is_some(),
        ..Cloud::default()
    };
    for (at, class) in points {
        cloud.add(*at, with_labels.then_some(f64::from(class.id())), None);
    }
    cloud.scene("sweep", BTreeMap::new()).expect("some")
}

/// A street seen by a sensor above its road, on level ground and on a slope of 3 degrees.
#[test]
fn a_sweep_in_its_sensors_frame_keeps_its_road_and_says_so() {
    for (mount_m, slope, with_labels) in [
        (1.84, 0.0, false),
        (1.84, 0.0, true),
        (2.26, 0.0, false),
        (1.84, 0.05, false),
        (2.8, 0.0, true),
    ] {
        let seen = |(p, class): (DVec3, Class)| (p - DVec3::Z * (mount_m - slope * p.x), class);
        let points: Vec<(DVec3, Class)> = street(0.0).into_iter().map(seen).collect();
        let found = loaded(&points, with_labels, None);
        let grid = &found.scene.frame().occupancy;
        let told = found.notes.join("; ");
        assert!(
            told.starts_with("the sweep lies in its sensor's frame: lifted by "),
            "{told}"
        );
        let lifted_m: f64 = told.trim_start_matches(|c: char| !c.is_ascii_digit())[..4]
            .parse()
            .expect("metres");
        // The walks are 0.15 m higher than the road.
        assert!((lifted_m - mount_m).abs() < 0.15, "{told}");
        assert_eq!(told.contains("turned by 2."), slope > 0.0, "{told}");
        if slope == 0.0 {
            assert_eq!(at(grid, 3.0, 1.0, -0.8), Some(Class::DriveableSurface), "{told}");
        }
        // By hand, as it is without a lift, and not at all.
        let road = |loaded: &ImportedScene| loaded.scene.frame().layout.count(BevLayer::DrivableArea);
        let by_hand = loaded(&points, with_labels, Some(mount_m));
        let (found, by_hand) = (road(&found) as f64, road(&by_hand) as f64);
        // On the slope, more of it lies on the map once it is level.
        match slope > 0.0 {
            true => assert!(found > 2.0 * by_hand, "{found} {by_hand}"),
            false => assert!((found / by_hand - 1.0).abs() < 0.05, "{found} {by_hand}"),
        }
    }
}

/// Clouds in the ego frame, with labels' ground or the wheels', and hills are not moved; what is asked for is done.
#[test]
fn a_cloud_on_the_map_is_not_moved_unless_that_is_asked_for() {
    for ground_m in [-0.8, -0.4, 0.0, 1.0] {
        assert_eq!(
            loaded(&street(ground_m), true, None).notes,
            Vec::<String>::new(),
            "{ground_m}"
        );
    }
    // Without labels the ground is where vehicles stand.
    for (ground_m, told) in [
        (-0.5, "lifted by 0."),
        (0.0, ""),
        (1.0, "lowered by 1."),
        (3.5, "lowered by 3."),
    ] {
        let found = loaded(&street(ground_m), false, None);
        let notes = found.notes.concat();
        assert_eq!(
            notes.contains("the ground lies at"),
            !told.is_empty(),
            "{ground_m}: {notes}"
        );
        assert!(notes.contains(told), "{ground_m}: {notes}");
        let sweep = found.sweep.expect("a sweep");
        assert!(
            found.scene.frame().layout.count(BevLayer::DrivableArea) > 500,
            "{ground_m}"
        );
        assert!(sweep.returns.iter().all(|r| r[2] > -0.5), "{ground_m}");
    }
    let asked = loaded(&street(-1.84), true, Some(1.84));
    assert_eq!(asked.notes, ["lifted by 1.84 m, as asked for"]);
    let grid = &asked.scene.frame().occupancy;
    assert_eq!(at(grid, 12.1, -2.0, 1.2), Some(Class::Others));
    // A wall without any ground is left where it is, and that is told.
    let wall: Vec<(DVec3, Class)> = (0..400)
        .map(|i| {
            let (along, up) = (f64::from(i % 40) * 0.2, f64::from(i / 40) * 0.2);
            (DVec3::new(8.0, along, up), Class::Manmade)
        })
        .collect();
    let told = loaded(&wall, false, None).notes.concat();
    assert!(told.starts_with("no ground found around the sensor"), "{told}");
    assert_eq!(loaded(&wall, true, None).notes, Vec::<String>::new());
    let three = &wall[..3];
    assert_eq!(loaded(three, false, None).scene.frame().occupancy.count_set(), 2);
}

#[test]
fn places_at_the_sensor_and_no_places_are_no_returns() {
    let mut cloud = Cloud::default();
    for at in [
        DVec3::ZERO,
        DVec3::splat(3e-5),
        DVec3::new(0.0, 0.05, 0.0),
        DVec3::NAN,
    ] {
        cloud.add(at, None, None);
    }
    let line = cloud
        .scene("none", BTreeMap::new())
        .map(drop)
        .expect_err("nothing")
        .to_string();
    assert_eq!(
        line,
        "no return among 4 points: none has a place away from the sensor"
    );
    let mut cloud = Cloud::default();
    cloud.add(DVec3::ZERO, None, None);
    cloud.add(DVec3::new(90.0, 0.0, 0.0), None, None);
    let line = cloud
        .scene("off", BTreeMap::new())
        .map(drop)
        .expect_err("nothing")
        .to_string();
    assert!(line.starts_with("none of 2 points lies on the map"), "{line}");
}

/// More points than wait for the ground: those that came first tell it, and the others follow.
#[test]
fn points_beyond_those_that_wait_are_lifted_with_them() {
    let mut cloud = Cloud::default();
    for (at, _) in street(-1.84) {
        cloud.add(at, None, None);
    }
    cloud.find_level();
    cloud.add(DVec3::new(20.1, 2.1, -0.2), None, None);
    let found = cloud.scene("late", BTreeMap::new()).expect("some");
    assert!(found.notes.concat().contains("lifted by 1."), "{:?}", found.notes);
    let [x, y, _] = Window::voxel_at(DVec3::new(20.1, 2.1, 0.0)).expect("inside");
    let column = found.scene.frame().occupancy.column(x, y);
    assert!(column[5..8].iter().any(|l| *l != Class::FREE), "{column:?}");
}

fn real_sweeps() -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("SCENELOOM_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let folder = folder.join("sweeps");
    match folder.is_dir() {
        true => Some(folder),
        false => {
            println!("{}: no real sweeps there", folder.display());
            None
        }
    }
}

fn road_of(path: &Path, lift_m: Option<f64>) -> (usize, Vec<String>) {
    match import::read_with(
        path,
        import::ImportOptions {
            lift_m,
            ..Default::default()
        },
    )
    .expect("a sweep")
    .1
    {
        Content::Scene(loaded) => (
            loaded.scene.frame().layout.count(BevLayer::DrivableArea),
            loaded.notes,
        ),
        other => panic!("{other:?}"),
    }
}

/// Heights of the sensors above the road as the folder's README has them, found by other means.
#[test]
fn real_sweeps_keep_their_road() {
    let Some(folder) = real_sweeps() else { return };
    for (name, by_hand_m) in [
        ("vls128_junction.pcd", 1.96),
        ("os1_drive/000000.pcd", 1.95),
        ("os1_drive/000001.pcd", 1.95),
        ("os1_drive/000002.pcd", 1.95),
        ("os1_drive/map.ply", 1.95),
        ("two_sensors/second.ply", 2.26),
    ] {
        let path = folder.join(name);
        let (found, notes) = road_of(&path, None);
        let (by_hand, _) = road_of(&path, Some(by_hand_m));
        let (left, _) = road_of(&path, Some(0.0));
        println!("{name}: {found} columns of road, {by_hand} by hand, {left} where it lies; {notes:?}");
        assert!(
            (found as f64 / by_hand as f64 - 1.0).abs() <= 0.05,
            "{name}: {found} {by_hand}"
        );
        assert!(left < found / 3, "{name}: {left} {found}");
        assert!(notes.concat().contains("lifted by"), "{notes:?}");
    }
    // Tilted by 6 degrees.
    for name in ["registration/source.ply", "registration/target.ply"] {
        let (found, notes) = road_of(&folder.join(name), None);
        println!("{name}: {found} columns of road; {notes:?}");
        let told = notes.join("; ");
        assert!(
            told.contains("lifted by") && told.contains("turned by "),
            "{told}"
        );
        assert!(found > 1500, "{name}: {found}");
    }
    // Forms whose sensor has a usual place on the vehicle, but the ground shows how high it is.
    for (name, told) in [("os0_street.pcd.bin", "2.2"), ("two_sensors/first.bin", "2.1")] {
        let (found, notes) = road_of(&folder.join(name), None);
        println!("{name}: {found} columns of road; {notes:?}");
        let told = format!("the sensor stands {told}");
        assert!(
            found > 1000 && notes.concat().starts_with(&told),
            "{name}: {found} {notes:?}"
        );
    }
    // Indoors there is no road to find, and nothing is lifted on one.
    for name in ["vlp16.pcd", "xt16.pcd", "ot128.pcd", "at128.pcd"] {
        let (found, notes) = road_of(&folder.join("sensors").join(name), None);
        println!("{name}: {found} columns of road; {notes:?}");
        assert!(notes.concat().contains("no ground found"), "{name}: {notes:?}");
    }
}

/// A car on the road becomes a box, its voxels get its class, and the sensor of the rig is where that of the sweep is.
#[test]
fn objects_of_a_sweep_become_boxes_with_their_voxels() {
    let seen = |(p, class): (DVec3, Class)| (p - DVec3::Z * 1.84, class);
    let points: Vec<(DVec3, Class)> = street(0.0).into_iter().map(seen).collect();
    let found = loaded(&points, false, None);
    let sweep = found.sweep.as_ref().expect("a sweep");
    assert!((sweep.sensor_m.z - 1.84).abs() < 0.15, "{}", sweep.sensor_m);
    let road = sweep
        .returns
        .iter()
        .filter(|r| r[0].hypot(r[1]) < 5.0)
        .map(|r| r[2]);
    assert!(road.fold(f32::INFINITY, f32::min).abs() < 0.2);
    let car = |size_m: DVec3| TrackedObject {
        class: Class::Car,
        size_m,
        places: vec![(0, glam::DVec2::new(12.1, -2.0), 0.0)],
    };
    let objects = [car(DVec3::NAN), car(DVec3::new(4.0, 1.8, 1.6))];
    let after = found.with_tracked(&objects, &[]).scene;
    let frame = after.frame();
    assert_eq!(frame.boxes.len(), 1);
    let (id, b) = frame.boxes.first_key_value().expect("a box");
    assert!(frame.inferred.boxes.contains(id) && frame.source.boxes.len() == 1);
    let own = frame.occupancy.iter_set().filter(|v| v.3 == Class::Car.id());
    let own: Vec<DVec3> = own.map(|(x, y, z, _)| Window::center(x, y, z)).collect();
    assert!(
        own.len() > 3 && own.iter().all(|p| b.contains(*p, 0.5)),
        "{own:?}"
    );
    let lidar = after.rig.lidars.first().expect("one").translation_m;
    assert!((lidar[2] - 1.84).abs() < 0.15, "{lidar:?}");
    // Labelled clouds have their objects.
    let labelled = loaded(&points, true, None).sweep;
    assert!(labelled.is_none_or(|sweep| sweep.returns.is_empty()));
}
