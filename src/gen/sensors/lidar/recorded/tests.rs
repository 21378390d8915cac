//! Tests on a made sweep: 32 beams over level ground, a wall 20 m ahead, a car between.

use std::collections::BTreeMap;

use scene::{BevLayout, BoxId, Extent, Frame, VoxelGrid};

use super::*;

const SENSOR: DVec3 = DVec3::new(0.0, 0.0, 2.0);
const WALL_M: f64 = 20.0;
const COLUMNS: u32 = 720;

fn car(id: u32, x: f64, y: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x, y, 0.8),
        size_m: DVec3::new(4.4, 1.8, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn elevations_deg() -> impl Iterator<Item = f64> {
    (0..32).map(|i| -24.0 + 0.9 * f64::from(i))
}

/// Distance at which a ray meets ground or wall, m.
fn free_m(direction: DVec3) -> Option<f64> {
    let ground = (direction.z < 0.0).then(|| -SENSOR.z / direction.z);
    let wall = (direction.x > 0.0).then(|| WALL_M / direction.x);
    let wall = wall.filter(|t| (SENSOR + direction * t).z < 5.0 && (SENSOR + direction * t).y.abs() < 15.0);
    let met = [ground, wall].into_iter().flatten().min_by(f64::total_cmp)?;
    (met < 60.0).then_some(met)
}

/// The sweep of a scene with these boxes, with rings or without; returns on boxes lie on their faces.
fn recording(boxes: &[SceneBox], rings: bool) -> Arc<SweepRecording> {
    let (mut returns, mut grid) = (Vec::new(), VoxelGrid::new());
    for (ring, elevation_deg) in (0u16..).zip(elevations_deg()) {
        for column in 0..COLUMNS {
            let turn = TAU * f64::from(column) / f64::from(COLUMNS);
            let direction = crate::lidar::direction_in_sensor(elevation_deg, turn);
            let on_box = boxes.iter().filter_map(|b| entered(b, SENSOR, direction));
            let met = on_box
                .map(|t| t + 0.01)
                .chain(free_m(direction))
                .min_by(f64::total_cmp);
            returns.push(met.map(|t| RecordedReturn {
                at_m: (SENSOR + direction * t).as_vec3().to_array(),
                strength: 20.0,
                ring: if rings { ring } else { RecordedReturn::NO_RING },
            }));
        }
    }
    for r in returns.iter().flatten() {
        if let Some([x, y, z]) = Extent::WINDOW.voxel_at(r.place()) {
            let class = if r.at_m[2] < 0.1 {
                Class::DriveableSurface
            } else {
                Class::Manmade
            };
            grid.set(x, y, z, class.id());
        }
    }
    let boxes: BTreeMap<_, _> = boxes.iter().map(|b| (b.id, *b)).collect();
    let frame = Frame::new(BevLayout::default(), boxes, grid);
    let mut scene = Scene::single("made", frame, Arc::new(SensorRig::default()), 0);
    let mut rig = SensorRig::default();
    rig.lidars[0].translation_m = SENSOR.to_array();
    scene.rig = Arc::new(rig);
    Arc::new(SweepRecording {
        file: "made.pcd".into(),
        format: "pcd".into(),
        time_s: 0.0,
        bytes: Arc::default(),
        world_from_file: Pose {
            translation_m: SENSOR,
            ..Pose::IDENTITY
        },
        sensor_m: SENSOR,
        returns: Arc::new(returns),
        before: Arc::new(scene),
    })
}

/// The scene of a recording with other boxes.
fn with_boxes(recording: &SweepRecording, boxes: &[SceneBox]) -> Scene {
    let mut scene = Scene::clone(&recording.before);
    scene.change_canvas(|canvas| canvas.boxes = boxes.iter().map(|b| (b.id, *b)).collect());
    scene
}

#[test]
fn a_removed_car_opens_ground_and_wall_where_they_are() {
    for rings in [true, false] {
        let recording = recording(&[car(1, 10.0, 1.0)], rings);
        let sweep = EditableSweep::new(recording.clone(), &[]);
        assert!(sweep.edits(&recording.before).is_empty());
        let edits = sweep.edits(&with_boxes(&recording, &[]));
        let mut wrong = 0;
        for (record, new) in &edits.changed {
            let was = recording.returns[*record as usize].expect("a return").place();
            assert!(car(1, 10.0, 1.0).contains(was, 0.15), "{was}");
            let direction = (was - SENSOR).normalize();
            let told = new.map(|new| new.at_m.distance(SENSOR));
            let off = told
                .zip(free_m(direction))
                .map(|(told, free)| (told - free).abs());
            wrong += usize::from(off.is_none_or(|off| off > 0.15));
        }
        let n = edits.changed.len();
        println!("rings {rings}: {n} returns, {wrong} told wrong");
        assert!(n > 200 && wrong * 20 <= n);
    }
}

#[test]
fn a_new_car_hides_what_is_behind_and_nothing_else() {
    let recording = recording(&[], true);
    let sweep = EditableSweep::new(recording.clone(), &[]);
    let new = car(5, 12.0, -3.0);
    let edits = sweep.edits(&with_boxes(&recording, &[new]));
    for (record, now) in &edits.changed {
        let was = recording.returns[*record as usize].expect("a return").place();
        let now = now.expect("each of these rays meets the car");
        assert!(now.provenance == Provenance::Added && now.class == Class::Car);
        assert!(new.contains(now.at_m, 0.1) && now.at_m.distance(SENSOR) < was.distance(SENSOR));
    }
    // Rays into the sky that the roof meets come back now, like a return of their own beam.
    let tall = SceneBox {
        size_m: DVec3::new(8.0, 2.5, 3.6),
        center_m: DVec3::new(-12.0, 3.0, 1.8),
        class: Class::Truck,
        ..new
    };
    let edits = sweep.edits(&with_boxes(&recording, &[tall]));
    assert!(edits.changed.len() > 100);
    for added in &edits.added {
        assert!(tall.contains(added.at_m, 0.1) && added.provenance == Provenance::Added);
    }
}

#[test]
fn corrected_labels_change_no_return_and_say_what_is_removed() {
    let recording = recording(&[car(1, 10.0, 1.0)], true);
    let sweep = EditableSweep::new(recording.clone(), &[]);
    let corrected = |boxes: &[SceneBox], labels: &[(u32, Option<SceneBox>)]| {
        let mut scene = with_boxes(&recording, boxes);
        scene.change_canvas(|canvas| {
            let recorded = Arc::make_mut(&mut canvas.inferred.recorded);
            *recorded = scene::Recorded::of_voxels();
            labels
                .iter()
                .for_each(|(id, label)| recorded.correct(BoxId(*id), *label));
        });
        sweep.edits(&scene)
    };
    let fitted = SceneBox {
        size_m: DVec3::new(4.6, 1.9, 1.7),
        ..car(1, 10.0, 1.05)
    };
    assert!(
        !corrected(&[fitted], &[]).is_empty(),
        "moved, it takes its returns along"
    );
    assert!(corrected(&[fitted], &[(1, Some(fitted))]).is_empty());
    assert!(corrected(&[], &[(1, None)]).is_empty(), "it was no object");
    // A car without a box is labelled, then removed.
    let missed = car(7, WALL_M, 4.0);
    assert!(corrected(&[car(1, 10.0, 1.0), missed], &[(7, Some(missed))]).is_empty());
    assert!(
        corrected(&[car(1, 10.0, 1.0)], &[(7, Some(missed))])
            .changed
            .len()
            > 20
    );
    // A label of where it was moved to says nothing of the recording.
    let away = car(1, 10.0, -8.0);
    assert!(corrected(&[away], &[(1, Some(away))]).changed.len() > 100);
    let moved = corrected(&[away], &[]);
    let is_there = |what: Provenance| moved.changed.values().flatten().any(|new| new.provenance == what);
    assert!(is_there(Provenance::Ground) && is_there(Provenance::Added));
}

/// A car that is longer than its box goes as a whole; a wall that a box touches stays.
#[test]
fn bumpers_go_with_the_car_and_walls_do_not() {
    let whole = recording(&[car(1, 6.0, 6.0)], true);
    let short = SceneBox {
        size_m: DVec3::new(3.8, 1.8, 1.6),
        ..car(1, 6.2, 6.0)
    };
    let with = |b: SceneBox| {
        let mut before = Scene::clone(&whole.before);
        before.change_canvas(|canvas| canvas.boxes = [(b.id, b)].into());
        let recording = SweepRecording {
            before: Arc::new(before),
            ..SweepRecording::clone(&whole)
        };
        EditableSweep::new(Arc::new(recording), &[]).edits(&with_boxes(&whole, &[]))
    };
    let all = with(car(1, 6.0, 6.0)).changed.len();
    let of_short = with(short).changed.len();
    println!("{of_short} of {all} returns go with a short box");
    assert!(of_short * 100 >= all * 97);
    let at_wall = with(car(1, WALL_M - 1.0, 8.0));
    let near = car(1, WALL_M - 1.0, 8.0);
    for record in at_wall.changed.keys() {
        let was = whole.returns[*record as usize].expect("a return").place();
        let beside = near.to_local(was).truncate().abs() - near.size_m.truncate() / 2.0;
        assert!(beside.max_element() <= BESIDE_M + 1e-6, "{was}");
    }
}

#[test]
fn painted_voxels_count_and_generated_ones_do_not() {
    let recording = recording(&[], true);
    let sweep = EditableSweep::new(recording.clone(), &[]);
    let wall = Extent::WINDOW
        .voxel_at(DVec3::new(WALL_M, 2.0, 1.5))
        .expect("on the map");
    let [x, y, z] = wall;
    let mut scene = Scene::clone(&recording.before);
    scene.change_canvas(|canvas| canvas.occupancy.set(x, y, z, Class::FREE));
    assert!(sweep.edits(&scene).is_empty(), "generation changes no return");
    scene.change_canvas(|canvas| canvas.painted.set(x, y, z, Class::FREE));
    let edits = sweep.edits(&scene);
    assert!(!edits.changed.is_empty());
    for record in edits.changed.keys() {
        let was = recording.returns[*record as usize].expect("a return").place();
        assert_eq!(Extent::WINDOW.voxel_at(was), Some(wall));
    }
    let [x, y, z] = Extent::WINDOW
        .voxel_at(DVec3::new(8.0, 0.1, 1.1))
        .expect("on the map");
    let mut scene = Scene::clone(&recording.before);
    scene.change_canvas(|canvas| {
        canvas.occupancy.set(x, y, z, Class::Manmade.id());
        canvas.painted.set(x, y, z, Class::Manmade.id());
    });
    let edits = sweep.edits(&scene);
    assert!(edits.synthetic().count() > 0);
    for new in edits.synthetic() {
        assert!(
            new.at_m.distance(Extent::WINDOW.center(x, y, z)) < 0.5,
            "{}",
            new.at_m
        );
    }
}

/// Objects beyond the map of the import count too, once the map is larger.
#[test]
fn a_larger_map_is_no_limit() {
    let recording = recording(&[], true);
    let sweep = EditableSweep::new(recording.clone(), &[]);
    let far = SceneBox {
        size_m: DVec3::new(10.0, 3.0, 3.5),
        center_m: DVec3::new(-50.0, 0.0, 1.75),
        class: Class::Truck,
        ..car(1, 0.0, 0.0)
    };
    let extent = Extent::new([-200, -100], [300, 200]).expect("sound");
    let mut larger = Scene::clone(&recording.before);
    larger.change_canvas(|canvas| {
        *canvas = canvas.crop(extent);
        canvas.boxes.insert(far.id, far);
    });
    let edits = sweep.edits(&larger);
    assert!(edits.synthetic().any(|new| new.provenance == Provenance::Added));
}

#[test]
fn the_pattern_is_that_of_the_sensor() {
    for rings in [true, false] {
        let recording = recording(&[], rings);
        let sweep = EditableSweep::new(recording.clone(), &[]);
        let pattern = sweep.pattern(&SensorRig::default().lidars[0]).expect("beams");
        let wanted: Vec<f64> = elevations_deg().collect();
        assert_eq!(pattern.elevations_deg.len(), wanted.len());
        for (a, b) in pattern.elevations_deg.iter().zip(wanted) {
            assert!((a - b).abs() < 0.05, "{a} {b}");
        }
        assert_eq!((pattern.columns, pattern.sector_deg), (COLUMNS, 360.0));
    }
}

/// Rings that are none, returns in one place, next to none, not a number: nothing breaks, nothing is made up.
#[test]
fn odd_sweeps_are_taken_as_they_are() {
    let sound = recording(&[], true);
    let with = |change: &dyn Fn(usize, &mut RecordedReturn)| {
        let mut returns = sound.returns.to_vec();
        for (i, r) in returns.iter_mut().enumerate() {
            if let Some(r) = r {
                change(i, r);
            }
        }
        let odd = SweepRecording {
            returns: Arc::new(returns),
            ..SweepRecording::clone(&sound)
        };
        EditableSweep::new(Arc::new(odd), &[])
    };
    let one_ring = with(&|_, r| r.ring = 0);
    assert_eq!(
        one_ring
            .pattern(&SensorRig::default().lidars[0])
            .map(|p| p.elevations_deg.len()),
        Some(32)
    );
    let together = with(&|i, r| r.at_m = [1.0 + 1e-6 * i as f32, 1.0, 1.0]);
    let far = with(&|_, r| r.at_m = [9e5; 3]);
    let empty = EditableSweep::new(
        Arc::new(SweepRecording {
            returns: Arc::default(),
            ..SweepRecording::clone(&sound)
        }),
        &[],
    );
    for odd in [one_ring, together, far, empty] {
        assert!(odd.beams.empty.len() < 100_000);
        let edits = odd.edits(&with_boxes(&sound, &[car(1, 10.0, 0.0)]));
        assert!(edits.synthetic().all(|new| new.at_m.is_finite()));
        let sweep = odd.sweep(&edits, &sound.before);
        assert_eq!(sweep.points.len(), sweep.provenance.len());
    }
}

/// Other sweeps tell what a removed car hid: a block behind it that no other return shows.
#[test]
fn other_sweeps_tell_what_was_hidden() {
    let block = car(9, 15.0, 1.0);
    let hidden_by_car = recording(&[car(1, 10.0, 1.0), block], true);
    let beside = recording(&[block], true);
    let scene = with_boxes(&hidden_by_car, &[block]);
    let truth = |direction: DVec3| entered(&block, SENSOR, direction);
    let right = |others: &[Arc<SweepRecording>]| {
        let edits = EditableSweep::new(hidden_by_car.clone(), others).edits(&scene);
        let of_block = edits.changed.iter().filter_map(|(record, new)| {
            let was = hidden_by_car.returns[*record as usize]?.place();
            Some((truth((was - SENSOR).normalize())?, *new))
        });
        let (mut right, mut all) = (0, 0);
        for (free_m, new) in of_block {
            let is_right = |new: SyntheticReturn| {
                new.provenance == Provenance::OtherSweep && (new.at_m.distance(SENSOR) - free_m).abs() < 0.15
            };
            (right, all) = (right + usize::from(new.is_some_and(is_right)), all + 1);
        }
        [right, all]
    };
    let drive = [
        &hidden_by_car,
        &beside,
        &recording(&[block], true),
        &recording(&[block], true),
    ];
    let [told, all] = right(&drive.map(Arc::clone));
    assert!(all > 20 && told * 10 >= all * 9, "{told} of {all}");
    assert_eq!(right(&[])[0], 0, "nobody else saw it");
}

/// The same on any number of threads.
#[test]
fn threads_do_not_change_edits() {
    let recording = recording(&[car(1, 10.0, 1.0)], true);
    let scene = with_boxes(&recording, &[car(2, 14.0, -4.0)]);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool")
            .install(|| EditableSweep::new(recording.clone(), &[]).edits(&scene))
    };
    assert_eq!(run(1), run(3));
}
