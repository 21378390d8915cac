//! Objects of real sweeps, where these are: see `shared/data/sweeps/README.md`.

use std::path::PathBuf;

use glam::DVec2;
use scene::Scene;

use super::*;

pub(super) fn real_sweeps() -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data");
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

pub(super) fn opened(path: &Path) -> Scene {
    match file_with(path, ImportOptions::default()).expect("a sweep").1 {
        Content::Scene(loaded) => loaded.scene,
        other => panic!("{other:?}"),
    }
}

/// Distance from a place to the nearest box, m.
fn nearest_m(scene: &Scene, at: DVec2) -> f64 {
    let boxes = scene.frame().boxes.values();
    boxes
        .map(|b| b.center_m.truncate().distance(at))
        .fold(f64::INFINITY, f64::min)
}

/// Where a place of a file's frame comes to lie: forms of scans have the sensor where the default rig has it.
fn placed(name: &str, [x, y]: [f64; 2]) -> DVec2 {
    match name {
        n if n.ends_with(".pcd.bin") => DVec2::new(y + 0.94, -x),
        n if n.ends_with(".bin") => DVec2::new(x + 0.94, y),
        _ => DVec2::new(x, y),
    }
}

/// Cars that a person marked in four sweeps are boxes: seven of the nine that are sure.
#[test]
fn cars_of_real_sweeps_become_boxes() {
    let Some(folder) = real_sweeps() else { return };
    let text = std::fs::read_to_string(folder.join("boxes_by_eye.json")).expect("readable");
    let marks: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let (mut sure, mut found) = (0, 0);
    for mark in marks["boxes"].as_array().expect("a list") {
        let name = mark["file"].as_str().expect("a name");
        let center = |i: usize| mark["center_m"][i].as_f64().expect("a number");
        let scene = opened(&folder.join(name));
        let off_m = nearest_m(&scene, placed(name, [center(0), center(1)]));
        println!("{name} sure {}: {off_m:.2} m", mark["sure"]);
        if mark["sure"] == true {
            sure += 1;
            found += i32::from(off_m < 2.0);
        }
    }
    assert!(sure == 9 && found >= 7, "{found} of {sure}");
}

/// Three sweeps of a drive show nearly the same objects, each a guess.
#[test]
fn sweeps_of_a_drive_agree() {
    let Some(folder) = real_sweeps() else { return };
    let [first, third] = ["000000.pcd", "000002.pcd"].map(|n| opened(&folder.join("os1_drive").join(n)));
    // Half a metre forward from the first to the third.
    let boxes = first.frame().boxes.values();
    let near = boxes.filter(|b| nearest_m(&third, b.center_m.truncate() - DVec2::X * 0.5) < 1.0);
    assert!(
        near.count() >= 5,
        "{} and {}",
        first.frame().boxes.len(),
        third.frame().boxes.len()
    );
    let frame = first.frame();
    assert_eq!(frame.inferred.boxes.len(), frame.boxes.len());
    for b in frame.boxes.values().filter(|b| b.class == scene::Class::Car) {
        let own = frame.occupancy.iter_set().filter(|v| v.3 == b.class.id());
        let inside = own.filter(|&(x, y, z, _)| b.contains(frame.extent().center(x, y, z), 0.6));
        assert!(inside.count() > 3, "{b:?}");
    }
}
