//! Scenes of noise: as many findings as are listed, in bounded time.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::*;
use scene::{BevLayout, SensorRig, VoxelGrid, Window, infer};

/// Random numbers from a counter (SplitMix64).
pub(crate) fn random(seed: u64) -> impl FnMut(u64) -> u64 {
    let mut state = seed;
    move |below| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ z >> 31) % below
    }
}

/// A random label in a share of the voxels, a random layout, and the boxes that an import would see in them.
pub(crate) fn noise(seed: u64, percent: u64) -> Scene {
    let mut next = random(seed);
    let mut grid = VoxelGrid::new();
    for x in 0..Extent::WINDOW.nx() {
        for y in 0..Extent::WINDOW.ny() {
            for z in 0..Window::NZ {
                if next(100) < percent {
                    grid.set(x, y, z, next(u64::from(Class::FREE) + 1) as u8);
                }
            }
        }
    }
    let cells = (0..Extent::WINDOW.columns())
        .map(|_| next(1 << 8) as u32)
        .collect();
    let layout = BevLayout::from_cells(cells, Vec::new()).expect("40,000 cells");
    let boxes = infer::boxes(&grid);
    let rig = Arc::new(SensorRig::default());
    Scene::single("noise", Frame::new(layout, boxes, grid), rig, 1)
}

#[test]
fn noise_is_checked_in_bounds() {
    for (seed, percent) in [(1, 100), (2, 8)] {
        let scene = noise(seed, percent);
        assert!(scene.frame().boxes.len() <= Frame::MAX_BOXES);
        let start = Instant::now();
        let findings = run_checks(&scene, Some(&VisibilityCounts::default()));
        let checked_in = start.elapsed();
        for name in names() {
            let of = findings.iter().filter(|f| f.check == name);
            let (listed, more): (Vec<_>, Vec<_>) = of.partition(|f| !f.text.starts_with("and "));
            assert!(
                listed.len() <= MOST && more.len() <= 1,
                "{name}: {}",
                listed.len()
            );
            assert!(more.is_empty() || listed.len() == MOST, "{name}");
        }
        let overlaps = |f: &&Finding| f.check == "overlapping_boxes" && f.text.starts_with("and ");
        assert!(
            findings.iter().any(|f| overlaps(&f)),
            "{} boxes",
            scene.frame().boxes.len()
        );
        let cells: usize = findings.iter().map(|f| f.cells.len()).sum();
        assert!(
            cells <= 8 * Extent::WINDOW.columns() * Window::NZ,
            "{cells} cells in findings"
        );
        assert!(checked_in < Duration::from_secs(300), "{checked_in:?}");
    }
}

/// What is not listed is counted, and an error among it stays one.
#[test]
fn what_is_not_listed_is_counted() {
    let finding = |severity, x: f64| Finding {
        check: "off_road",
        severity,
        where_m: DVec3::new(x, 0.0, 0.0),
        box_id: None,
        time_s: None,
        cells: Vec::new(),
        text: "off".into(),
        fixes: Vec::new(),
    };
    let mut all = Findings::listing(MOST);
    for i in 0..MOST + 3 {
        let severity = match i == MOST + 1 {
            true => Severity::Error,
            false => Severity::Warning,
        };
        all.push(finding(severity, i as f64));
    }
    all.end("off_road");
    all.push(finding(Severity::Warning, 7.0));
    all.end("other");
    let (all, tally) = all.done();
    assert_eq!((tally.counts().errors, tally.counts().warnings), (1, MOST + 3));
    assert_eq!(all.len(), MOST + 2);
    assert_eq!(
        (all[0].severity, all[0].where_m.x),
        (Severity::Error, MOST as f64)
    );
    assert_eq!(all[0].text, "and 3 more of off_road");
}
