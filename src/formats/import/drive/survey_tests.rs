//! Tests of what sweeps see together, on a made street: what moved leaves the voxels, what stands stays.

use super::*;

const MOUNT_M: f64 = 2.0;

/// A level road with a wall on its left, a parked car on its right and one that drives 3 m from sweep to sweep, from a sensor that is
/// 1 m farther in each.
fn drive(wrong: impl Fn(usize) -> Pose) -> SurveyedDrive {
    let sweep = |i: usize| {
        let sensor = DVec3::new(i as f64, 0.0, MOUNT_M);
        let mut seen = Vec::new();
        for (x, y) in (-60..120).flat_map(|x| (-20..20).map(move |y| (x, y))) {
            seen.push(DVec3::new(f64::from(x) * 0.5, f64::from(y) * 0.5, 0.0));
        }
        for (x, z) in (-60..120).flat_map(|x| (1..12).map(move |z| (x, z))) {
            // (bays, so that the wall is not the same everywhere)
            let y = if x / 8 % 2 == 0 { 9.0 } else { 9.9 };
            seen.push(DVec3::new(f64::from(x) * 0.5, y, f64::from(z) * 0.3));
        }
        for middle in [DVec2::new(14.0, -4.0), DVec2::new(6.0 + 3.0 * i as f64, 3.0)] {
            for (u, z) in (-8..=8).flat_map(|u| (2..6).map(move |z| (u, z))) {
                seen.push((middle + DVec2::new(f64::from(u) * 0.25, 0.0)).extend(f64::from(z) * 0.25));
            }
        }
        let survey = Survey::new(seen.into_iter().map(|p| p - sensor));
        let up = Pose {
            translation_m: DVec3::Z * MOUNT_M,
            ..Pose::IDENTITY
        };
        let world_from_sensor = Pose {
            translation_m: sensor,
            ..Pose::IDENTITY
        };
        PlacedSurvey::of_sensor(survey, world_from_sensor * wrong(i), &up)
    };
    SurveyedDrive::new((0..10).map(sweep).collect())
}

/// Voxels above the ground in the lane of the car that drives, as far as others look beyond it, and those of the one that is parked.
fn standing(world: &SurveyedWorld) -> [usize; 2] {
    let above = |low: DVec2, high: DVec2| {
        let of = world.voxels.iter_set().filter(|&(x, y, z, _)| {
            let p = world.voxels.extent().center(x, y, z);
            p.z > 0.3 && p.truncate().cmpge(low).all() && p.truncate().cmple(high).all()
        });
        of.count()
    };
    [
        above(DVec2::new(2.0, 2.0), DVec2::new(20.0, 4.0)),
        above(DVec2::new(11.5, -5.0), DVec2::new(16.5, -3.0)),
    ]
}

#[test]
fn what_moved_leaves_the_voxels_and_what_stands_stays() {
    let drive = drive(|_| Pose::IDENTITY);
    let world = drive.world(&[], &[]).expect("a world");
    let [moved, parked] = standing(&world);
    assert!(parked >= 20, "{parked}");
    println!("{moved} voxels of the car that drives, {parked} of the one that is parked");
    assert!(moved <= 15, "{moved} voxels of the car that drives");
    assert!(world.seen_through > 100 && world.layout.relief.is_flat());
    let note = world.notes().concat();
    assert!(note.contains("points of what moves"), "{note}");
    // Where others tell what moves, its returns are left out at once.
    let boxes = (0..10).map(|i| {
        vec![SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(6.0 + 3.0 * f64::from(i), 3.0, 0.8),
            size_m: DVec3::new(4.5, 1.0, 1.6),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }]
    });
    let told = drive.world(&boxes.collect::<Vec<_>>(), &[]).expect("a world");
    assert_eq!(standing(&told)[0], 0);
}

#[test]
fn poses_that_do_not_fit_are_told() {
    let turned = |i: usize| Pose::planar(0.0, 0.0, 0.25 * i as f64);
    let note = drive(turned).world(&[], &[]).expect("a world").notes().concat();
    assert!(note.contains("the poses do not fit"), "{note}");
}
