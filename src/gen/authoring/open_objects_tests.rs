//! Objects of simulated label frames: one box each, and taken out whole.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use scene::variants::{Variant, of_class};
use scene::{Background, BevLayout, BoxId, Class, SceneBox, SensorRig, VoxelGrid, infer};
use world::World;
use world::draw::Draw;
use world::voxelize::{Drive, Vertical, labels};

/// Frames that are looked at, and large objects in each.
const FRAMES: u64 = 20;
const OBJECTS: u32 = 4;

/// Large objects of all kinds around the vehicle, none in another's way.
fn large_objects(seed: u64) -> BTreeMap<BoxId, SceneBox> {
    let mut draw = Draw::new(seed, "large objects");
    let classes = [
        Class::Truck,
        Class::Bus,
        Class::Trailer,
        Class::ConstructionVehicle,
    ];
    let kinds: Vec<&Variant> = classes.into_iter().flat_map(of_class).collect();
    let mut out: BTreeMap<BoxId, SceneBox> = BTreeMap::new();
    while out.len() < OBJECTS as usize {
        let kind = kinds[draw.range(0.0, kinds.len() as f64) as usize % kinds.len()];
        let at = DVec2::from_angle(draw.range(0.0, std::f64::consts::TAU)) * draw.range(9.0, 28.0);
        let size_m = DVec3::from_array(kind.size_m);
        let reach = |b: &SceneBox| b.size_m.truncate().length() / 2.0;
        let b = SceneBox {
            id: BoxId(out.len() as u32 + 1),
            class: kind.class,
            center_m: at.extend(size_m.z / 2.0),
            size_m,
            yaw_rad: draw.range(0.0, std::f64::consts::TAU),
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let near = |other: &SceneBox| other.center_m.distance(b.center_m) < reach(other) + reach(&b) + 1.0;
        if !out.values().any(near) && at.length() > reach(&b) + 4.0 {
            out.insert(b.id, b);
        }
    }
    out
}

/// Voxels of a class within a box grown by a metre: all, and those not within any of these boxes grown by half a metre.
fn left_over(grid: &VoxelGrid, truth: &SceneBox, found: &[&SceneBox]) -> [usize; 2] {
    let extent = grid.extent();
    let mut out = [0; 2];
    for (x, y, z, _) in grid.iter_set().filter(|v| v.3 == truth.class.id()) {
        let at = extent.center(x, y, z).with_z(truth.center_m.z);
        if truth.contains(at, 1.0) {
            out[0] += 1;
            out[1] += usize::from(!found.iter().any(|b| b.contains(at.with_z(b.center_m.z), 0.5)));
        }
    }
    out
}

#[test]
fn a_large_object_is_one_box_and_all_its_voxels_are_in_it() {
    let pattern = &SensorRig::default().lidars[0];
    let (mut objects, mut boxes, mut voxels, mut left, mut length_gap_m) = (0, 0, 0, 0, 0.0);
    for seed in 0..FRAMES {
        let truth = large_objects(seed);
        let world = World::with_background(BevLayout::default(), truth.clone(), Background::default(), seed);
        let grid = labels(&world, pattern, &Drive::default(), Vertical::Occ3d, seed);
        let found = infer::boxes(&grid);
        for b in truth.values() {
            let [seen, _] = left_over(&grid, b, &[]);
            if seen < 60 {
                continue;
            }
            let own: Vec<&SceneBox> = found
                .values()
                .filter(|f| f.class == b.class && b.contains(f.center_m.with_z(b.center_m.z), 1.0))
                .collect();
            objects += 1;
            boxes += own.len();
            voxels += seen;
            left += left_over(&grid, b, &own)[1];
            if let [one] = own[..] {
                length_gap_m += (one.size_m.x - b.size_m.x).abs();
            }
        }
    }
    let per_object = f64::from(boxes as u32) / f64::from(objects);
    let share = left as f64 / voxels as f64;
    println!(
        "{objects} objects: {per_object:.3} boxes each, {:.2} % of their voxels in none, lengths off by {:.2} m",
        100.0 * share,
        length_gap_m / f64::from(objects)
    );
    assert!(objects > 50 && (0.97..=1.1).contains(&per_object), "{per_object}");
    assert!(share <= 0.05, "{share}");
    assert!(length_gap_m / f64::from(objects) < 1.5);
}

/// Objects in a row with a metre between them stay as many as they are.
#[test]
fn objects_that_stand_close_are_not_one() {
    let pattern = &SensorRig::default().lidars[0];
    let row = |class: Class, size_m: DVec3| -> BTreeMap<BoxId, SceneBox> {
        let place = |i: u32| SceneBox {
            id: BoxId(i + 1),
            class,
            center_m: DVec3::new(2.0 + f64::from(i) * (size_m.x + 1.2), 7.0, size_m.z / 2.0),
            size_m,
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        (0..2).map(place).map(|b| (b.id, b)).collect()
    };
    for (class, size_m) in [
        (Class::Truck, DVec3::new(5.3, 1.95, 1.9)),
        (Class::Truck, DVec3::new(8.0, 2.5, 3.2)),
        (Class::ConstructionVehicle, DVec3::new(4.0, 1.6, 2.4)),
    ] {
        let truth = row(class, size_m);
        let world = World::with_background(BevLayout::default(), truth, Background::default(), 1);
        let grid = labels(&world, pattern, &Drive::default(), Vertical::Occ3d, 1);
        let found = infer::boxes(&grid);
        assert_eq!(found.len(), 2, "{class:?} {size_m}: {found:?}");
    }
}
