//! Things that stand on the road, and parts that rest on nothing.

use super::*;

/// A stem at a column, up to a crown of 3 x 3 x 3 voxels.
fn tree(x: usize, y: usize, from: usize) -> Vec<[usize; 3]> {
    let stem = (from..8).map(|z| [x, y, z]);
    stem.chain((0..27).map(|i| [x - 1 + i % 3, y - 1 + i / 3 % 3, 8 + i / 9]))
        .collect()
}

#[test]
fn trees_poles_and_walls_on_the_road_are_found() {
    // A tree in the lane: stem and crown are one finding, and clearing it leaves the road whole.
    let mut scene = street(&traffic());
    paint(&mut scene, Class::Vegetation, tree(100, 96, 1));
    let finding = only(&scene, "on_the_road", None);
    assert_eq!(finding.severity, Severity::Warning);
    assert_eq!(finding.text, "34 voxels of vegetation stand on the road");
    assert!(
        finding
            .where_m
            .truncate()
            .distance(Extent::WINDOW.center(100, 96, 0).truncate())
            < 0.5
    );
    // A pole, and a wall that covers its ground.
    for cells in [
        (1..12).map(|z| [60, 100, z]).collect::<Vec<_>>(),
        (0..60).map(|i| [60 + i % 10, 100, i / 10]).collect(),
    ] {
        let mut scene = street(&traffic());
        paint(&mut scene, Class::Manmade, cells.clone());
        let finding = only(&scene, "on_the_road", None);
        assert_eq!(finding.cells.len(), cells.len(), "{}", finding.text);
        let fixed = crate::fix::plan_at_once(&scene, std::slice::from_ref(&finding)).edits();
        fixed.iter().for_each(|e| apply(&mut scene, e.clone()));
        assert_eq!(
            scene.frame().occupancy.get(60, 100, 0),
            Class::DriveableSurface.id()
        );
    }
}

#[test]
fn what_hangs_over_the_road_or_stands_beside_it_is_fine() {
    let mut scene = street(&traffic());
    // A tree beside the road whose crown reaches over it, and a lamp with an arm.
    paint(&mut scene, Class::Vegetation, tree(100, 81, 1));
    let crown = (0..27).map(|i| [99 + i % 3, 83 + i / 3 % 3, 8 + i / 9]).collect();
    paint(&mut scene, Class::Vegetation, crown);
    let mut lamp: Vec<_> = (1..12).map(|z| [60, 119, z]).collect();
    lamp.extend((110..119).map(|y| [60, y, 12]));
    paint(&mut scene, Class::Manmade, lamp);
    // A hedge on the kerb's own cells, a voxel of noise in the lane, works on a closed strip.
    paint(
        &mut scene,
        Class::Vegetation,
        (20..30).flat_map(|x| [[x, 82, 1], [x, 83, 1]]).collect(),
    );
    paint(&mut scene, Class::Manmade, vec![[140, 100, 1]]);
    for x in 150..160 {
        for y in 85..95 {
            scene.change_canvas(|f| f.layout.set(BevLayer::RoadBlock, x, y, true));
        }
    }
    paint(&mut scene, Class::Manmade, (1..5).map(|z| [155, 90, z]).collect());
    assert_eq!(run_checks(&scene, None), []);
}

#[test]
fn on_raised_road_heights_count_from_the_road() {
    let mut scene = street(&[]);
    scene.change_canvas(|frame| {
        for [x, y] in Extent::WINDOW.all_columns() {
            let column = frame.occupancy.column_mut(x, y);
            column[4] = column[0];
            column[0] = Class::FREE;
        }
    });
    paint(
        &mut scene,
        Class::Vegetation,
        (0..12).map(|i| [99 + i % 3, 96, 10 + i / 3]).collect(),
    );
    let hangs = run_checks(&scene, None);
    assert!(!checks(&hangs).contains(&"on_the_road"), "{hangs:?}");
    paint(
        &mut scene,
        Class::Vegetation,
        (5..10).map(|z| [100, 96, z]).collect(),
    );
    assert_eq!(checks(&run_checks(&scene, None)), ["on_the_road"]);
}

#[test]
fn many_things_on_the_road_are_one_line_more() {
    let mut scene = street(&[]);
    let posts = (0..45).flat_map(|i| (1..5).map(move |z| [10 + 3 * i, 100, z]));
    paint(&mut scene, Class::Manmade, posts.collect());
    let findings = run_checks(&scene, None);
    assert_eq!(findings.len(), 41);
    assert_eq!(findings[40].text, "5 smaller things stand on the road, 20 voxels");
    let edits = crate::fix::plan_at_once(&scene, &findings).edits();
    edits.iter().for_each(|e| apply(&mut scene, e.clone()));
    assert_eq!(run_checks(&scene, None), []);
}

#[test]
fn a_part_that_only_leans_is_found() {
    // A wall, and a crown beside it that nothing of its own carries.
    let wall = || (0..100).map(|i| [40 + i % 10, 40, i / 10]).collect::<Vec<_>>();
    let crown = || (0..27).map(|i| [44 + i % 3, 41 + i / 3 % 3, 5 + i / 9]);
    let mut scene = street(&[]);
    paint(&mut scene, Class::Manmade, wall());
    assert_eq!(run_checks(&scene, None), []);
    paint(&mut scene, Class::Vegetation, crown().collect());
    let finding = only(&scene, "unsupported_parts", None);
    assert_eq!(
        finding.text,
        "27 voxels of vegetation rest on nothing, 1.0 m above the ground"
    );
    let labels: Vec<_> = finding.fixes.iter().map(|f| f.label).collect();
    assert_eq!(labels, ["Put a stem under it", "Remove the part"]);
    // On top of the wall it rests, and on a stem of its own; a few voxels are noise.
    let mut scene = street(&[]);
    paint(&mut scene, Class::Manmade, wall());
    paint(
        &mut scene,
        Class::Vegetation,
        (0..27)
            .map(|i| [44 + i % 3, 40 + i / 3 % 3, 10 + i / 9])
            .collect(),
    );
    paint(
        &mut scene,
        Class::Vegetation,
        vec![[48, 41, 5], [48, 41, 6], [48, 42, 5]],
    );
    assert_eq!(run_checks(&scene, None), []);
}

#[test]
fn a_bush_on_a_hill_stands_in_its_ground() {
    let mut scene = street(&[]);
    let columns = || (0..900).map(|i| [20 + i % 30, 20 + i / 30]);
    let cells = |z: usize| columns().map(|[x, y]| [x, y, z]).collect::<Vec<_>>();
    (0..3).for_each(|z| paint(&mut scene, Class::Free, cells(z)));
    paint(&mut scene, Class::Terrain, cells(4));
    let bush = |from: usize| {
        (0..48)
            .map(move |i| [30 + i % 4, 30 + i / 4 % 4, from + i / 16])
            .collect::<Vec<_>>()
    };
    paint(&mut scene, Class::Vegetation, bush(4));
    let found = run_checks(&scene, None);
    assert!(!checks(&found).contains(&"unsupported_parts"), "{found:?}");
}
