//! Tests of clouds without and with labels.

use super::*;

/// A street: flat road with kerbs, pavements 0.15 m higher, a wall of 6 m, trees of scattered points, a car; ground at this
/// height.
pub(super) fn street(ground_m: f64) -> Vec<(DVec3, Class)> {
    let mut out = Vec::new();
    let mut put = |x: f64, y: f64, z: f64, class| out.push((DVec3::new(x, y, ground_m + z), class));
    for i in 0..400 {
        let x = f64::from(i) * 0.2 - 40.0;
        for j in 0..60 {
            let y = f64::from(j) * 0.2 - 6.0;
            match y.abs() < 4.0 {
                true => put(x, y, 0.0, Class::DriveableSurface),
                false => put(x, y, 0.15, Class::Sidewalk),
            }
        }
        (2..30).for_each(|k| put(x, 6.05, f64::from(k) * 0.2, Class::Manmade));
    }
    let mut draw = 1u64;
    let mut share = || {
        draw = draw
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (draw >> 40) as f64 / f64::from(1 << 24)
    };
    for tree in 0..8 {
        for _ in 0..900 {
            let at = DVec3::new(share(), share(), share()) * 3.0;
            put(
                f64::from(tree) * 10.0 - 38.0 + at.x,
                -9.5 + at.y,
                2.2 + at.z,
                Class::Vegetation,
            );
        }
    }
    for i in 0..20 {
        for j in 0..8 {
            put(
                10.0 + f64::from(i) * 0.2,
                -2.0,
                0.3 + f64::from(j) * 0.15,
                Class::Others,
            );
        }
    }
    out
}

fn made(points: &[(DVec3, Class)], with_labels: bool) -> VoxelGrid {
    let mut cloud = Cloud::default();
    for (at, class) in points {
        cloud.add(*at, with_labels.then_some(f64::from(class.id())), None);
    }
    let loaded = cloud.scene("street", BTreeMap::new()).expect("some");
    assert_eq!(loaded.inferred.contains(&"classes"), !with_labels);
    loaded.scene.frame().occupancy.clone()
}

pub(super) fn at(grid: &VoxelGrid, x: f64, y: f64, z: f64) -> Option<Class> {
    let [x, y, z] = Window::voxel_at(DVec3::new(x, y, z)).expect("inside");
    Class::from_id(grid.get(x, y, z))
}

#[test]
fn shape_tells_road_pavement_walls_trees_and_things() {
    let grid = made(&street(0.0), false);
    for (place, expected) in [
        ([3.0, 1.0, -0.8], Class::DriveableSurface),
        ([-30.0, -3.0, -0.8], Class::DriveableSurface),
        ([3.0, 5.0, -0.8], Class::OtherFlat),
        ([3.0, 6.1, 3.0], Class::Manmade),
        ([-20.0, 6.1, 5.0], Class::Manmade),
        ([-26.5, -8.0, 4.0], Class::Vegetation),
        ([12.1, -2.0, 0.9], Class::Others),
    ] {
        let [x, y, z] = place;
        assert_eq!(at(&grid, x, y, z), Some(expected), "{place:?}");
    }
}

/// Wherever the road lies within reason it comes to the lowest bin; what stands on it stays.
#[test]
fn ground_is_put_where_labels_have_it() {
    for ground_m in [-0.8, -0.6, -0.3, 0.0, 0.2] {
        for with_labels in [false, true] {
            let grid = made(&street(ground_m), with_labels);
            let lowest: Vec<usize> = grid
                .iter_set()
                .filter(|(.., l)| *l == Class::DriveableSurface.id())
                .map(|(_, _, z, _)| z)
                .collect();
            let in_lowest = lowest.iter().filter(|z| **z == 0).count();
            assert!(
                in_lowest as f64 > 0.95 * lowest.len() as f64,
                "{ground_m} {with_labels}"
            );
            let thing = at(&grid, 12.1, -2.0, ground_m + 1.2);
            assert_eq!(thing, Some(Class::Others), "{ground_m} {with_labels}");
        }
    }
    let hill = made(&street(1.0), true);
    assert_eq!(at(&hill, 3.0, 1.0, 1.1), Some(Class::DriveableSurface));
}

#[test]
fn echoes_of_the_own_roof_are_left_out_and_the_road_beside_it_is_not() {
    let mut cloud = Cloud::default();
    for (at, label) in [
        (DVec3::new(1.0, 0.2, 1.5), Label::None),
        (DVec3::new(1.0, 0.2, 1.5), Label::Class(Class::Others)),
        (DVec3::new(1.0, 0.2, 1.5), Label::Class(Class::Car)),
        (DVec3::new(1.0, 0.2, -0.8), Label::None),
        (DVec3::new(1.0, 3.0, 1.5), Label::Unknown),
        (DVec3::NAN, Label::None),
    ] {
        cloud.add_point(at, label, 0.0);
    }
    let found = cloud
        .scene("roof", BTreeMap::from([("ring".into(), 1)]))
        .expect("some");
    let skipped: Vec<(&str, usize)> = found.skipped.iter().map(|(k, n)| (k.as_str(), *n)).collect();
    assert_eq!(
        skipped,
        [
            ("labels without a class, taken as others", 1),
            ("points on the own vehicle", 2),
            ("points that are not finite", 1),
            ("ring", 1),
        ]
    );
    assert_eq!(found.scene.frame().occupancy.count_set(), 3);
}

/// More points than wait at once, and more in one voxel than are looked at, count all the same.
#[test]
fn many_points_are_counted_to_the_last() {
    let mut cloud = Cloud {
        level: Some(Pose::default()),
        ..Cloud::default()
    };
    let place = DVec3::new(5.1, 5.1, 1.1);
    for _ in 0..PENDING + 10 {
        cloud.add_point(place, Label::Class(Class::Car), 0.0);
    }
    for _ in 0..PENDING + 11 {
        cloud.add_point(place, Label::Class(Class::Truck), 0.0);
    }
    (0..1000).for_each(|_| cloud.add_point(DVec3::new(-5.1, 5.1, 1.1), Label::None, 0.0));
    assert_eq!(cloud.loose.len(), usize::from(MOST_PER_VOXEL));
    assert!(cloud.counted.len() + cloud.pending.len() < PENDING + 100);
    let grid = cloud
        .scene("many", BTreeMap::new())
        .expect("some")
        .scene
        .frame()
        .occupancy
        .clone();
    assert_eq!(at(&grid, 5.1, 5.1, 1.1), Some(Class::Truck));
    assert_eq!(grid.count_set(), 2);
    assert_eq!(
        Cloud::default().scene("none", BTreeMap::new()).map(drop),
        Err(NothingOnTheMap { points: 0, empty: 0 })
    );
}

/// How well shape tells classes apart, on sweeps of this program: `sceneloom export --format ply` into the folder that
/// `SCENELOOM_SWEEPS` names. docs/formats/points.md has the figures and the scenes.
#[test]
#[ignore = "needs a folder of sweeps"]
fn shares_of_points_with_the_right_group() {
    let folder = std::env::var("SCENELOOM_SWEEPS").expect("SCENELOOM_SWEEPS names a folder");
    let group = |class: Class| match class {
        Class::Manmade => 1,
        Class::Vegetation => 2,
        ground if ground.is_ground() => 0,
        _ => 3,
    };
    let mut counts = [[0usize; 4]; 4];
    let (mut shares, mut roads) = (Vec::new(), [0usize; 2]);
    let files = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|file| file.expect("a file").path());
    for path in files.filter(|path| path.extension().is_some_and(|e| e == "ply")) {
        let bytes = std::fs::read(&path).expect("read");
        let end = b"end_header\n";
        let body = bytes.windows(end.len()).position(|w| w == end).expect("a header") + end.len();
        let (mut points, mut truth) = (Vec::new(), Vec::new());
        for record in bytes[body..].chunks_exact(39) {
            let float = |i: usize| f32::from_le_bytes(record[4 * i..][..4].try_into().expect("four"));
            let at = DVec3::new(float(0).into(), float(1).into(), float(2).into());
            let class = Class::from_id(record[38]).expect("a class");
            if Window::voxel_at(at).is_some() && !(class == Class::Others && is_own(at)) {
                points.push(at);
                truth.push(class);
            }
        }
        let mut right = 0;
        for (truth, found) in truth
            .iter()
            .zip(geometry::shapes(&points, scene::Extent::WINDOW, &[geometry::Passed::HERE]).classes)
        {
            counts[group(*truth)][group(found)] += 1;
            right += usize::from(group(*truth) == group(found));
            if truth.is_ground() && found.is_ground() {
                let is_road = |class| class == Class::DriveableSurface;
                roads[0] += 1;
                roads[1] += usize::from(is_road(*truth) == is_road(found));
            }
        }
        shares.push(right as f64 / points.len() as f64);
        println!("{} {:.3}", path.display(), shares[shares.len() - 1]);
    }
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    println!(
        "mean {mean:.3}; road or not, of ground {:.3}",
        roads[1] as f64 / roads[0] as f64
    );
    println!("true ground, manmade, vegetation, things, as found: {counts:?}");
    assert!(mean > 0.7, "{mean}");
}
