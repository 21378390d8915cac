//! Traffic made to drive on real and bundled places: the clips have no errors of the program's own making.

use std::path::{Path, PathBuf};

use editor::checks::{Finding, Severity, run_checks};
use editor::{Apply, Edit, apply_all, traffic_drives};
use scene::Scene;

use super::open::{self, Placement};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..")
}

/// Real road files that lie beside the checkout, and the bundled ones.
fn places() -> Vec<PathBuf> {
    let beside = root().join("../shared/data");
    let data = std::env::var_os("SCENELOOM_DATA").map_or(beside, PathBuf::from);
    let real = ["Town01.xodr", "Town03.xodr", "multi_intersections.xodr"];
    let real: Vec<PathBuf> = real
        .iter()
        .map(|f| data.join("roads/opendrive").join(f))
        .collect();
    let mut out = match real.iter().all(|f| f.is_file()) {
        true => real,
        false => {
            println!("no real road files here (../shared/data or SCENELOOM_DATA): only bundled ones");
            Vec::new()
        }
    };
    let bundled = [
        "four_arm_junction.xodr",
        "straight_two_way.xodr",
        "parking_street.xodr",
    ];
    out.extend(bundled.iter().map(|f| root().join("assets/roads").join(f)));
    out
}

fn errors(scene: &Scene) -> Vec<Finding> {
    let mut found = run_checks(scene, None);
    found.retain(|f| f.severity == Severity::Error);
    found
}

/// The errors of a scene after its traffic was made to drive, and the numbers of vehicles that drive and that stay.
fn driven(scene: &Scene) -> (Vec<Finding>, [usize; 2]) {
    let mut clip = scene.clone();
    let long = Edit::SetLength {
        length_s: 8.0,
        rate_hz: None,
    };
    long.apply(&mut clip).expect("sound");
    let start = traffic_drives(&clip).expect("sound");
    apply_all(&start.edits, &mut clip).expect("sound edits");
    (errors(&clip), [start.starts, start.stays.len()])
}

#[test]
fn traffic_drives_without_errors() {
    let (mut starts, mut stays) = (0, 0);
    for path in places() {
        for seed in 0..3 {
            let placement = Placement {
                seed,
                ..Placement::default()
            };
            let scene = open::import(&path, &placement).expect("a road file").scene;
            let before = errors(&scene);
            let (after, [goes, stay]) = driven(&scene);
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let texts = |list: &[Finding]| list.iter().map(|f| f.text.clone()).collect::<Vec<_>>();
            println!("{name} {seed}: {goes} drive, {stay} stay, {} errors", after.len());
            let known = texts(&before);
            let new: Vec<String> = texts(&after).into_iter().filter(|t| !known.contains(t)).collect();
            assert!(new.is_empty(), "{name}, seed {seed}: {new:?}");
            let met = after
                .iter()
                .filter(|f| matches!(f.check, "collision" | "through_wall"));
            assert_eq!(met.count(), 0, "{name}, seed {seed}");
            (starts, stays) = (starts + goes, stays + stay);
        }
    }
    // (much of it must drive, or standing still would pass the test)
    assert!(starts > 0 && 2 * starts > stays, "{starts} drive, {stays} stay");
}

#[test]
fn bundled_worlds_drive_without_errors() {
    let (mut starts, mut stays) = (0, 0);
    for name in ["intersection", "straight", "parking"] {
        for seed in 0..4 {
            let Some(scene) = open::from_template(name, seed) else {
                continue;
            };
            let known: Vec<String> = errors(&scene).into_iter().map(|f| f.text).collect();
            let (found, [goes, stay]) = driven(&scene);
            let new: Vec<&String> = found
                .iter()
                .map(|f| &f.text)
                .filter(|t| !known.contains(t))
                .collect();
            assert!(new.is_empty(), "{name}, seed {seed}: {new:?}");
            (starts, stays) = (starts + goes, stays + stay);
        }
    }
    println!("{starts} drive, {stays} stay");
    assert!(starts > 0 && 2 * starts > stays, "{starts} drive, {stays} stay");
    let first = open::scene(&root().join("assets/scenes/first_light.loom")).expect("the first scene");
    let known = errors(&first).len();
    assert_eq!(driven(&first).0.len(), known);
}
