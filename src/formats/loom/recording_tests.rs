//! Tests of recorded sweeps in project files.

use std::sync::Arc;

use glam::DVec3;
use scene::{Pose, Scene, SweepRecording};

use super::tests::{assert_same, pack, sample, unpack};
use super::*;
use crate::sweep_file::SweepFile;

/// Two sweeps of a vehicle that moves: two returns and an empty slot each, as scans of KITTI.
pub(super) fn recorded(mut before: Scene) -> Vec<Arc<SweepRecording>> {
    before.kept = Arc::default();
    let before = Arc::new(before);
    let sweep = |i: u8| {
        let numbers = [
            10.0f32,
            1.0,
            -1.5,
            0.25,
            0.0,
            0.0,
            0.0,
            0.0,
            -3.0,
            1.0 / 3.0,
            2.0,
            f32::from(i),
        ];
        let bytes: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
        let world_from_file = Pose::planar(0.9 + f64::from(i), -0.1, 0.2);
        let records = SweepFile::open("kitti", &bytes).expect("a scan");
        Arc::new(SweepRecording {
            returns: Arc::new(records.returns(&world_from_file)),
            file: format!("{i:06}.bin").into(),
            format: "kitti".into(),
            time_s: f64::from(i) / 3.0,
            bytes: Arc::new(bytes),
            world_from_file,
            sensor_m: DVec3::new(0.9 + f64::from(i), -0.1, 1.73),
            before: before.clone(),
        })
    };
    vec![sweep(0), sweep(1)]
}

/// Panics where two scenes have not the same sweeps.
pub(super) fn assert_same_sweeps(a: &Scene, b: &Scene) {
    assert_eq!(a.kept.sweeps.len(), b.kept.sweeps.len());
    for (x, y) in a.kept.sweeps.iter().zip(&b.kept.sweeps) {
        let about = |s: &SweepRecording| {
            (
                s.file.clone(),
                s.time_s,
                s.bytes.clone(),
                s.world_from_file,
                s.sensor_m,
            )
        };
        assert_eq!(about(x), about(y));
        assert_eq!(x.returns, y.returns);
        assert_same(&x.before, &y.before);
    }
}

/// A recording that is damaged is named in one line, and none makes a scene of it.
#[test]
fn a_damaged_recording_is_refused() {
    let entries = unpack(&to_bytes(&sample(VERSION)).expect("sound"));
    let with = |name: &str, change: &dyn Fn(&mut Vec<u8>)| {
        let mut entries = entries.clone();
        let entry = entries.iter_mut().find(|e| e.0 == name).expect("there");
        change(&mut entry.1);
        let refused = from_bytes(&pack(&entries)).map(drop).expect_err(name);
        refused.to_string()
    };
    let text = |from: &'static str, to: &'static str| {
        move |bytes: &mut Vec<u8>| {
            let json = String::from_utf8(std::mem::take(bytes)).expect("text");
            assert!(json.contains(from), "{json}");
            *bytes = json.replace(from, to).into_bytes();
        }
    };
    assert!(with("sweeps/0000", &|b| b.truncate(17)).contains("17 bytes, expected records of 16"));
    assert_eq!(
        with("sweeps/before.loom", &|b| b.truncate(100)).lines().count(),
        1
    );
    assert!(with("sweeps.json", &text("1.73", "1e999")).contains("sweeps.json"));
    assert!(
        with(
            "sweeps.json",
            &text("\"translation_m\":[0.9", "\"translation_m\":[null")
        )
        .contains("sweeps.json")
    );
    let mut without = entries.clone();
    without.retain(|e| e.0 != "sweeps/0000");
    let line = from_bytes(&pack(&without))
        .map(drop)
        .expect_err("missing")
        .to_string();
    assert!(line.contains("sweeps/0000"), "{line}");
}
