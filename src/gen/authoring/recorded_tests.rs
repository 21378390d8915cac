//! Edits of real sweeps, where these are: what is not touched stays as it was recorded.

use std::time::Instant;

use editor::Document;
use formats::loom;
use formats::sweep_file::SweepFile;
use glam::DVec3;
use scene::{BoxId, Class, Edit, Provenance, Scene, SceneBox, SweepEdits};
use sensors::lidar::recorded::{EditableSweep, trial};

use super::tests::{opened, real_sweeps};

/// Sweeps of four forms: PCD with and without rings, a scan of nuScenes with empty slots, a scan of KITTI, PLY.
const SWEEPS: [&str; 6] = [
    "os1_drive/000000.pcd",
    "vls128_junction.pcd",
    "os0_street.pcd.bin",
    "two_sensors/first.bin",
    "two_sensors/second.ply",
    "registration/source.ply",
];

/// A scene after edits, without what is generated.
fn edited(scene: &Scene, edits: Vec<Edit>) -> Scene {
    let mut document = Document::new(scene.clone());
    for edit in edits {
        document.apply("edit", &edit).expect("an edit");
    }
    Scene::clone(document.scene())
}

/// The bytes of the file after edits, with the origin of each record.
fn written(scene: &Scene, edits: &SweepEdits) -> (Vec<u8>, Vec<Provenance>) {
    let recording = scene.kept.sweeps.first().expect("a recording");
    let file = SweepFile::open(&recording.format, &recording.bytes).expect("its own file");
    file.edited(edits, &recording.world_from_file.inverse())
}

/// A car on the road beside the sensor, in the lane to its left.
fn car(id: u32, at: [f64; 2]) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(at[0], at[1], 0.8),
        size_m: DVec3::new(4.5, 1.9, 1.6),
        yaw_rad: 0.0,
        velocity_mps: glam::DVec2::ZERO,
        label: Default::default(),
    }
}

#[test]
fn a_sweep_that_nobody_edits_is_the_file_and_survives_a_project_file() {
    let Some(folder) = real_sweeps() else { return };
    for name in SWEEPS {
        let scene = opened(&folder.join(name));
        let bytes = std::fs::read(folder.join(name)).expect("readable");
        let recording = scene.kept.sweeps.first().expect(name);
        assert!(*recording.bytes == bytes, "{name}");
        let edits = EditableSweep::new(recording.clone(), &[]).edits(&scene);
        assert!(edits.is_empty(), "{name}");
        let saved = loom::to_bytes(&scene).expect("sound");
        let again = loom::from_bytes(&saved).expect("its own");
        let kept = again.kept.sweeps.first().expect("kept");
        let places = |r: &scene::SweepRecording| -> Vec<_> {
            r.returns
                .iter()
                .map(|r| r.map(|r| (r.at_m.map(f32::to_bits), r.ring)))
                .collect()
        };
        assert!(
            kept.bytes == recording.bytes && places(kept) == places(recording),
            "{name}"
        );
        let edits = EditableSweep::new(kept.clone(), &[]).edits(&again);
        assert!(written(&again, &edits).0 == bytes, "{name}");
        println!(
            "{name}: {} KB, as a project {} KB",
            bytes.len() / 1024,
            saved.len() / 1024
        );
    }
}

/// Each box that was found is removed, alone: its returns go, and no other return changes.
#[test]
fn a_removed_object_takes_its_returns_and_no_others() {
    let Some(folder) = real_sweeps() else { return };
    let (mut removed, mut left, mut slowest_s) = (0, 0, 0.0f64);
    for name in SWEEPS {
        let scene = opened(&folder.join(name));
        let recording = scene.kept.sweeps.first().cloned().expect(name);
        let since = Instant::now();
        let sweep = EditableSweep::new(recording.clone(), &[]);
        let ready = since.elapsed();
        let boxes: Vec<SceneBox> = scene.frame().boxes.values().copied().take(6).collect();
        for b in boxes {
            let after = edited(&scene, vec![Edit::RemoveBox { id: b.id }]);
            let since = Instant::now();
            let edits = sweep.edits(&after);
            slowest_s = slowest_s.max(since.elapsed().as_secs_f64());
            // All that changed lay in the box, or hung together with what is in it.
            for record in edits.changed.keys() {
                let r = recording.returns[*record as usize].expect("a return");
                let beside = b.to_local(r.place()).truncate().abs() - b.size_m.truncate() / 2.0;
                assert!(beside.max_element() <= 0.81, "{name} {beside}");
            }
            assert!(
                edits.synthetic().all(|new| new.provenance != Provenance::Added),
                "{name}"
            );
            // What was told instead lies behind, not in the box.
            let inside = edits.synthetic().filter(|new| {
                let in_plan = b.contains(new.at_m.with_z(b.center_m.z), 0.0);
                in_plan && new.at_m.z > 0.4
            });
            left += inside.count();
            removed += edits.changed.len();
            let (bytes, origins) = written(&after, &edits);
            let again = SweepFile::open(&recording.format, &bytes).expect("a sweep");
            assert_eq!(
                again.returns(&recording.world_from_file).len(),
                origins.len(),
                "{name}"
            );
        }
        println!("{name}: ready after {ready:?}");
    }
    println!("{removed} returns removed, {left} told again within the boxes; slowest edit {slowest_s:.3} s");
    assert!(removed > 1000 && left * 20 <= removed);
}

#[test]
fn an_added_car_hides_what_is_behind_it() {
    let Some(folder) = real_sweeps() else { return };
    let scene = opened(&folder.join("os1_drive/000000.pcd"));
    let recording = scene.kept.sweeps.first().cloned().expect("a recording");
    let sweep = EditableSweep::new(recording.clone(), &[]);
    let added = car(900, [9.0, -0.5]);
    let add = Edit::AddBox {
        class: added.class,
        center_m: added.center_m,
        size_m: added.size_m,
        yaw_deg: 0.0,
        velocity_mps: None,
        id: Some(added.id),
        label: added.label,
    };
    let after = edited(&scene, vec![add]);
    let edits = sweep.edits(&after);
    let new = edits
        .synthetic()
        .filter(|new| new.provenance == Provenance::Added)
        .count();
    // No return that stays lies behind the middle of the car.
    let shows = |at: DVec3| {
        let (from, way) = (recording.sensor_m, at - recording.sensor_m);
        (1..200).any(|i| {
            let p = from + way * (f64::from(i) / 200.0);
            let inner = SceneBox {
                size_m: added.size_m * DVec3::new(0.8, 0.7, 0.4),
                ..added
            };
            inner.contains(p.with_z(p.z + 0.25), 0.0)
        })
    };
    let stays = recording
        .returns
        .iter()
        .zip(0u32..)
        .filter(|(_, i)| !edits.changed.contains_key(i));
    let behind = stays.filter(|(r, _)| r.is_some_and(|r| shows(r.place()))).count();
    println!("{new} returns on the car, {behind} that stay behind it");
    assert!(new > 300 && behind == 0);
    // Taken away again, all is as recorded.
    let back = edited(&after, vec![Edit::RemoveBox { id: BoxId(900) }]);
    assert!(sweep.edits(&back).is_empty());
}

/// A box that is corrected changes no return, and is what a removal goes by; one that is moved takes its returns along.
#[test]
fn a_corrected_label_changes_no_return() {
    let Some(folder) = real_sweeps() else { return };
    let scene = opened(&folder.join("os1_drive/000000.pcd"));
    let sweep = EditableSweep::new(scene.kept.sweeps.first().cloned().expect("a recording"), &[]);
    let b = *scene.frame().boxes.values().next().expect("a box");
    let resize = Edit::MoveBox {
        id: b.id,
        center_m: None,
        yaw_deg: None,
        size_m: Some(b.size_m + DVec3::new(0.6, 0.2, 0.1)),
    };
    let removed = |edits: Vec<Edit>| sweep.edits(&edited(&scene, edits));
    let remove = Edit::RemoveBox { id: b.id };
    let correct = Edit::Correct {
        edit: resize.clone().into(),
    };
    assert!(removed(vec![correct.clone()]).is_empty());
    assert!(!removed(vec![resize]).is_empty());
    let by_found = removed(vec![remove.clone()]).changed.len();
    let by_corrected = removed(vec![correct, remove]).changed.len();
    println!("{by_found} returns go with the box that was found, {by_corrected} with the corrected one");
    assert!(by_corrected >= by_found);
}

/// What is told behind a car that was never there, against what the sensor measured.
#[test]
fn the_ground_behind_a_removed_car_is_where_it_was() {
    let Some(folder) = real_sweeps() else { return };
    for name in SWEEPS {
        let scene = opened(&folder.join(name));
        let trials = trial::holes(scene.kept.sweeps.first().expect(name), &[]);
        let mut off_m: Vec<f64> = trials.iter().flat_map(|t| &t.errors_m).map(|e| e.abs()).collect();
        off_m.sort_by(f64::total_cmp);
        let hidden: usize = trials.iter().map(|t| t.hidden).sum();
        let within = |m: f64| off_m.iter().filter(|e| **e <= m).count() as f64 / hidden.max(1) as f64;
        println!(
            "{name}: {} holes, {hidden} rays, median {:.3} m, within .1 m {:.2}, .5 m {:.2}; none {:.2}",
            trials.len(),
            off_m.get(hidden / 2).copied().unwrap_or(f64::NAN),
            within(0.1),
            within(0.5),
            1.0 - off_m.len() as f64 / hidden.max(1) as f64
        );
        // Voxels of the same sweeps told 6 and 36 % of such rays within these distances.
        assert!(hidden < 1000 || within(0.1) > 0.25 && within(0.5) > 0.5, "{name}");
    }
}

/// Errors behind cars that were never there, with the other sweeps of a drive and without, over all of its sweeps.
#[test]
fn other_sweeps_of_a_drive_tell_what_a_removed_car_hid() {
    let Some(folder) = real_sweeps() else { return };
    let scene = opened(&folder.join("os1_drive"));
    let sweeps = &scene.kept.sweeps;
    assert_eq!(sweeps.len(), 3);
    assert!((scene.clip().length_s - 0.199_959).abs() < 1e-6);
    let end = scene.at(0.2).frame().world_from_ego.translation_m;
    assert!(
        end.truncate().distance(glam::DVec2::new(0.495, 0.0136)) < 0.01,
        "{end}"
    );
    for (i, recording) in sweeps.iter().enumerate() {
        let bytes = std::fs::read(folder.join(format!("os1_drive/{i:06}.pcd"))).expect("readable");
        let then = scene.at(recording.time_s);
        let edits = EditableSweep::new(recording.clone(), sweeps).edits(&then);
        assert!(edits.is_empty() && *recording.bytes == bytes);
    }
    let mut medians_m = Vec::new();
    for others in [&sweeps[..0], sweeps] {
        let trials: Vec<_> = sweeps
            .iter()
            .flat_map(|sweep| trial::holes(sweep, others))
            .collect();
        let mut off_m: Vec<f64> = trials.iter().flat_map(|t| &t.errors_m).map(|e| e.abs()).collect();
        off_m.sort_by(f64::total_cmp);
        let hidden: usize = trials.iter().map(|t| t.hidden).sum();
        let within = |m: f64| off_m.iter().filter(|e| **e <= m).count() as f64 / hidden as f64;
        medians_m.push(off_m[hidden / 2]);
        println!(
            "{} other sweeps: {} holes, {hidden} rays, median {:.3} m, within .1 m {:.2}, .5 m {:.2}; none {:.2}",
            others.len().saturating_sub(1),
            trials.len(),
            off_m[hidden / 2],
            within(0.1),
            within(0.5),
            1.0 - off_m.len() as f64 / hidden as f64
        );
    }
    assert!(medians_m[1] < 0.06 && medians_m[1] < medians_m[0]);
}
