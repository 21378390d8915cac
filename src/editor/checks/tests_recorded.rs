//! What a recording shows is worth knowing and nobody's mistake; what is made of it is judged as ever.

use std::sync::Arc;

use scene::clip::ObjectVoxels;
use scene::{Clip, Key, Motion, Recorded, Track};

use glam::DVec2;

use super::tests::{object, street};
use super::*;
use crate::Apply;

/// A drive: two barriers whose boxes overlap, one more that jitters as annotations do, and a car that brakes as annotations do and
/// passes through it and off the map.
fn drive() -> Scene {
    let standing = [
        object(1, Class::Barrier, 10.0, 20.0, 0.0),
        object(2, Class::Barrier, 10.3, 20.0, 0.0),
    ];
    let mut scene = street(&standing);
    let key = |time_s: f64, x: f64, y: f64| Key {
        time_s,
        at_m: DVec2::new(x, y),
        yaw_deg: 0.0,
    };
    let track = |id: u32, class: Class, keys: Vec<Key>| {
        let made = object(id, class, keys[0].at_m.x, keys[0].at_m.y, 0.0);
        let track = Track {
            made,
            motion: Motion::Keys(keys),
            there_s: [None; 2],
            voxels: ObjectVoxels::drafted(scene::Lattice::OCC3D, &made),
            settled: true,
            own_shape: false,
        };
        (BoxId(id), track)
    };
    let jitter = (0..9).map(|i| key(f64::from(i) * 0.5, 20.0 + 0.4 * f64::from(i % 2), 0.0));
    let places = [0.0, 5.0, 10.0, 19.0, 20.0, 24.0, 30.0, 38.0, 50.0];
    let car = places
        .iter()
        .enumerate()
        .map(|(i, x)| key(i as f64 * 0.5, *x, 0.0));
    let tracks = [
        track(3, Class::Barrier, jitter.collect()),
        track(4, Class::Car, car.collect()),
    ];
    scene.change_clip(|clip| {
        *clip = Clip {
            length_s: 4.0,
            tracks: tracks.into(),
            ..Clip::default()
        }
    });
    scene
}

fn recorded(mut scene: Scene) -> Scene {
    let marks = Arc::new(Recorded::all_of(&scene));
    scene.change_canvas(|canvas| canvas.inferred.recorded = marks);
    scene
}

/// Checks whose findings are worse than worth knowing, about one box.
fn faults(scene: &Scene, about: u32) -> Vec<&'static str> {
    let found = run_checks(scene, None).into_iter();
    let found = found.filter(|f| f.severity > Severity::Info && f.box_id == Some(BoxId(about)));
    found.map(|f| f.check).collect()
}

#[test]
fn a_recorded_drive_has_no_faults_and_the_same_made_by_hand_has() {
    let (made, drive) = (drive(), recorded(drive()));
    for check in [
        overlapping_boxes::NAME,
        over_time::COLLISION,
        over_time::TOO_FAST,
        over_time::LEAVES_MAP,
    ] {
        let severities = |scene: &Scene| {
            let found = run_checks(scene, None).into_iter().filter(|f| f.check == check);
            found.map(|f| f.severity).collect::<Vec<_>>()
        };
        let (made, recorded) = (severities(&made), severities(&drive));
        assert!(made.iter().any(|s| *s > Severity::Info), "{check}: {made:?}");
        assert_eq!(recorded, vec![Severity::Info; made.len()], "{check}");
    }
    assert!((1..=4).all(|id| faults(&drive, id).is_empty()));
    assert!(tally(&drive).counts().errors == 0 && tally(&made).counts().errors > 0);
}

#[test]
fn what_is_made_of_a_recording_is_judged_as_ever() {
    // A box that is moved into a recorded one, one that is set in the way of a recorded car, and a wall that is painted there.
    let mut scene = recorded(drive());
    let into = Edit::MoveBox {
        id: BoxId(1),
        center_m: Some(DVec3::new(10.6, 20.0, 0.5)),
        yaw_deg: None,
        size_m: None,
    };
    into.apply(&mut scene).expect("sound");
    assert_eq!(faults(&scene, 2), [overlapping_boxes::NAME]);
    let mut scene = recorded(drive());
    let car = object(9, Class::Car, 30.0, 0.0, 0.0);
    scene.change_canvas(|canvas| canvas.boxes.insert(car.id, car));
    assert_eq!(faults(&scene, 4), [over_time::COLLISION]);
    let mut scene = recorded(drive());
    let [x, y] = scene.canvas().extent().column_at(30.0, 0.0).expect("inside");
    let wall = Edit::PaintVoxels {
        cells: (y - 4..y + 4)
            .flat_map(|y| (1..8).map(move |z| [x, y, z]))
            .collect(),
        class: Class::Manmade,
    };
    assert!(faults(&scene, 4).is_empty());
    wall.apply(&mut scene).expect("sound");
    assert_eq!(faults(&scene, 4), [over_time::THROUGH_WALL]);
}

/// Voxels of a sweep hang where nothing was measured below them; what was painted hangs because somebody painted it.
#[test]
fn voxels_of_a_recording_may_hang_and_painted_ones_may_not() {
    let hanging = |scene: &Scene| {
        let found = run_checks(scene, None)
            .into_iter()
            .filter(|f| f.check == floating_voxels::NAME);
        found.map(|f| f.severity).collect::<Vec<_>>()
    };
    let mut scene = street(&[]);
    let cells: Vec<[usize; 3]> = (0..5).map(|i| [50 + i, 20, 9]).collect();
    scene.change_canvas(|canvas| {
        cells
            .iter()
            .for_each(|&[x, y, z]| canvas.occupancy.set(x, y, z, Class::Others.id()));
    });
    assert_eq!(hanging(&scene), [Severity::Warning]);
    let mut scene = recorded(scene);
    assert_eq!(hanging(&scene), [Severity::Info]);
    let paint = Edit::PaintVoxels {
        cells: (0..5).map(|i| [150 + i, 20, 9]).collect(),
        class: Class::Manmade,
    };
    paint.apply(&mut scene).expect("sound");
    assert_eq!(hanging(&scene), [Severity::Warning, Severity::Info]);
}
