use std::sync::LazyLock;

use glam::DVec3;
use scene::{Extent, Pose, Scene, VoxelGrid};

use super::*;
use crate::export::{openoccupancy, surroundocc};
use crate::npy::tests::npy;
use crate::sparse_npy::{KINDS, SURROUND_OCC};
use crate::table_tests::{Small, random_scene, scene};
use crate::voxels::Physical;

/// A small scene as OpenOccupancy.
pub(super) fn sample() -> Vec<u8> {
    write(&openoccupancy::EXPORTER, &scene())
}

const RESAMPLED: super::super::ImportOptions = super::super::ImportOptions {
    lift_m: None,
    resample: true,
};

fn write(exporter: &crate::export::Exporter, scene: &Scene) -> Vec<u8> {
    (exporter.write)(scene, &mut Small)
        .expect("written")
        .remove(0)
        .bytes
}

fn rows(of: &[[i64; 4]]) -> Vec<u8> {
    let values: Vec<u8> = of.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    npy("<i8", false, &format!("({}, 4)", of.len()), &values)
}

fn loaded(bytes: &[u8]) -> ImportedScene {
    let source = ImportFile {
        bytes,
        name: "list",
        path: None,
        options: RESAMPLED,
    };
    match read(&source).expect("read") {
        Content::Scene(loaded) => *loaded,
        other => panic!("expected a scene, not {other:?}"),
    }
}

fn refusal(bytes: &[u8]) -> String {
    let source = ImportFile {
        bytes,
        name: "list",
        path: None,
        options: RESAMPLED,
    };
    read(&source).expect_err("refused")
}

/// A car ahead to the left, told in each of the four grids, lands at the same place.
#[test]
fn one_car_lands_at_one_place_from_every_kind() {
    // The middle of a voxel, a metre above the ground.
    let extent = Extent::WINDOW;
    let [x, y, z] = extent.voxel_at(DVec3::new(15.0, 6.2, 1.0)).expect("inside");
    for kind in KINDS {
        let p = LIDAR_FROM_EGO.apply(extent.center(x, y, z));
        let [i, j, k] = kind.lattice.cell_at(p).expect("inside").map(|v| v as i64);
        // Far corners, so that the grid can be told.
        let [ni, nj, nk] = kind.lattice.size.map(|n| n as i64 - 1);
        let cells = [[i, j, k, 4], [ni, 0, 0, 11], [0, nj, nk, 16]];
        let of_kind = |[i, j, k, class]: [i64; 4]| match kind.z_first {
            true => [k, j, i, class],
            false => [i, j, k, class],
        };
        let found = loaded(&rows(&cells.map(of_kind)));
        assert_eq!(found.skipped.get(kind.assumed), Some(&3), "{:?}", found.skipped);
        // A lone hit is a run of three in Occ3D's labels; its top is where it was.
        let occupancy = found.scene.frame().occupancy.crop(extent);
        for down in 0..3 {
            assert_eq!(occupancy.get(x, y, z - down), Class::Car.id(), "{}", kind.assumed);
        }
        assert_ne!(occupancy.get(x, y, z + 1), Class::Car.id(), "{}", kind.assumed);
    }
}

static LIDAR_FROM_EGO: LazyLock<Pose> =
    LazyLock::new(|| SensorRig::default().lidars[0].ego_from_sensor().inverse());

/// Voxels where things are, without the class that is noise there.
fn without_others(scene: &Scene) -> Physical {
    let mut physical = Physical::raised(&scene.frame().occupancy);
    for [x, y] in physical.extent().all_columns() {
        let column = physical.column_mut(x, y).iter_mut();
        column
            .filter(|label| **label == Class::Others.id())
            .for_each(|label| *label = Class::FREE);
    }
    physical
}

/// Through OpenOccupancy's cells every column of a hundred scenes comes back that has nothing above their top: without the
/// class others, and with nothing less than three voxels high.
#[test]
fn openoccupancy_brings_back_all_but_what_is_told() {
    let mut same = 0;
    for seed in 0..100 {
        let scene = random_scene(seed);
        let back = labels(&write(&openoccupancy::EXPORTER, &scene)).expect("read");
        let physical = without_others(&scene);
        let expected = physical.lowered();
        assert_eq!(back.extent(), Extent::WINDOW, "seed {seed}");
        for [x, y] in Extent::WINDOW.all_columns() {
            let top = physical.column(x, y).iter().rposition(|l| *l != Class::FREE);
            let top = LIDAR_FROM_EGO.apply(Extent::WINDOW.center(x, y, top.unwrap_or(0)));
            if top.z < 3.0 - 0.4 {
                assert_eq!(back.column(x, y), expected.column(x, y), "seed {seed}: {x}, {y}");
                same += back.column(x, y).iter().filter(|l| **l != Class::FREE).count();
            }
        }
    }
    assert!(same > 500_000, "{same} voxels tell nothing");
}

/// Through SurroundOcc's cells a hundred scenes come back as told: a voxel with the most frequent class of those in the cell
/// of its middle.
#[test]
fn surroundocc_brings_back_the_most_frequent_class_of_each_cell() {
    let lattice = SURROUND_OCC.lattice;
    for seed in 0..100 {
        let scene = random_scene(seed);
        let back = labels(&write(&surroundocc::EXPORTER, &scene)).expect("read");
        let physical = without_others(&scene);
        // Others take part in the vote, as the file's noise.
        let voters = Physical::raised(&scene.frame().occupancy);
        let mut votes: BTreeMap<[usize; 3], [usize; 17]> = BTreeMap::new();
        let cell_of = |x, y, z| lattice.cell_at(LIDAR_FROM_EGO.apply(Extent::WINDOW.center(x, y, z)));
        for (x, y, z, class) in voters.iter_set() {
            if let Some(cell) = cell_of(x, y, z) {
                votes.entry(cell).or_insert([0; 17])[usize::from(class)] += 1;
            }
        }
        let winner = |votes: &[usize; 17]| {
            let most = votes.iter().copied().max().unwrap_or(0);
            (1..17)
                .chain([0])
                .find(|class| votes[*class] == most)
                .unwrap_or(0) as u8
        };
        let mut expected = Physical::over(Extent::WINDOW);
        for [x, y] in Extent::WINDOW.all_columns() {
            for z in 0..Physical::NZ {
                let voted = cell_of(x, y, z).and_then(|cell| votes.get(&cell)).map(winner);
                let class = voted.filter(|class| *class != Class::Others.id());
                expected.column_mut(x, y)[z] = class.unwrap_or(Class::FREE);
            }
        }
        assert!(back.crop(Extent::WINDOW) == expected.lowered(), "seed {seed}");
        assert!(
            expected.iter_set().count() > physical.iter_set().count() / 2,
            "seed {seed}"
        );
    }
}

#[test]
fn noise_free_and_unknown_classes_are_counted() {
    let found = loaded(&rows(&[
        [20, 256, 300, 4],
        [20, 256, 301, 0],
        [20, 256, 302, 255],
        [20, 256, 303, 17],
        [20, 256, 304, 40],
        [39, 511, 511, 16],
        [0, 0, 0, 16],
    ]));
    let skipped = |what: &str| found.skipped.get(what).copied();
    assert_eq!(skipped("rows of class 0 or 255, noise"), Some(2));
    assert_eq!(skipped("rows of class 17, free"), Some(1));
    assert_eq!(skipped("classes above 17, taken as others"), Some(1));
    assert_eq!(skipped("cells above or below the map"), Some(1));
    let counts = found.scene.frame().occupancy.class_counts();
    assert!(counts[usize::from(Class::Car.id())] > 0 && counts[0] > 0);
}

#[test]
fn velocities_and_floats_are_read_past() {
    let row = [20.0f32, 256.0, 300.0, 0.5, -0.5, 0.0, 4.0];
    let bad = [20.0f32, 256.0, f32::NAN, 0.0, 0.0, 0.0, 4.0];
    let values: Vec<u8> = [row, bad]
        .iter()
        .flatten()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let found = loaded(&npy("<f4", false, "(2, 7)", &values));
    assert_eq!(found.skipped.get("velocities of voxels"), Some(&2));
    assert_eq!(found.skipped.get("rows that are not finite"), Some(&1));
}

#[test]
fn what_is_no_list_of_voxels_is_one_line() {
    let points: Vec<u8> = [1.5f32, -2.0, 0.5, 30.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    for (file, expected) in [
        (
            npy("<f4", false, "(1, 4)", &points),
            "row 0, column 0: 1.5, expected the index of a voxel",
        ),
        (
            rows(&[[-1, 0, 0, 4]]),
            "row 0, column 0: -1, expected the index of a voxel",
        ),
        (
            rows(&[[600, 600, 600, 4]]),
            "indices up to 600, 600, 600, expected those of OpenOccupancy",
        ),
        (
            npy("|u1", false, "(1, 7)", &[100, 100, 3, 0, 0, 0, 4]),
            "indices up to 100, 100, 3, expected",
        ),
        (
            npy("|u1", false, "(2, 5)", &[0; 10]),
            "2 rows of 5, expected rows of 4",
        ),
        (
            npy("|u1", false, "(0, 4)", &[]),
            "0 rows of 4, expected rows of 4",
        ),
        (
            npy("|u1", false, "(200, 200, 16)", &[0; 640_000]),
            "an array of shape [200, 200, 16], expected rows",
        ),
        (
            rows(&[[0, 0, 0, 4], [39, 0, 0, 0]]),
            "none of 2 rows is a voxel of the map",
        ),
    ] {
        let line = refusal(&file);
        assert!(line.starts_with(expected), "{line}");
    }
    let whole = sample();
    for cut in 0..whole.len().min(2000) {
        assert!(!refusal(&whole[..cut]).is_empty());
    }
}

/// Labels whose ground lies where Occ3D has it are left as they are.
#[test]
fn ground_that_is_lowered_already_stays() {
    let kind = SURROUND_OCC;
    let mut all = Vec::new();
    for (x, y) in (0..200).flat_map(|x| (95..105).map(move |y| (x, y))) {
        let p = LIDAR_FROM_EGO.apply(Extent::WINDOW.center(x, y, 0));
        all.push(kind.lattice.cell_at(p).expect("inside").map(|v| v as i64));
    }
    let cells: Vec<[i64; 4]> = all.iter().map(|[i, j, k]| [*i, *j, *k, 11]).collect();
    let found = loaded(&rows(&cells));
    assert_eq!(
        found.skipped.get("ground below -0.6 m, taken as Occ3D has it"),
        Some(&1)
    );
    let occupancy = &found.scene.frame().occupancy;
    let lowest = occupancy.iter_set().filter(|v| v.2 <= 1).count();
    assert!(lowest == occupancy.count_set() && lowest > 1000, "{lowest}");
}

#[test]
fn a_scene_without_lidar_or_voxels_is_not_written() {
    let refused = |scene: &Scene| {
        let result = (surroundocc::EXPORTER.write)(scene, &mut Small);
        result.expect_err("refused").to_string()
    };
    let mut scene = scene();
    scene.change_canvas(|frame| frame.occupancy = VoxelGrid::new());
    assert!(refused(&scene).starts_with("no voxel around the vehicle"));
    let mut rig = SensorRig::clone(&scene.rig);
    rig.lidars.clear();
    scene.rig = rig.into();
    assert!(refused(&scene).starts_with("the rig has no LiDAR"));
}
