//! Each check on a scene in which all is well, and on the same scene with one thing wrong.

use crate::Apply;
use std::sync::Arc;

use glam::DVec2;

use super::*;
use crate::{Document, EditError};
use scene::draft::draft;
use scene::{BevLayer, BevLayout, Polyline, PolylineKind, SensorRig, Window};

pub(crate) fn object(id: u32, class: Class, x: f64, y: f64, yaw_deg: f64) -> SceneBox {
    let size_m = DVec3::from_array(class.typical_size_m().expect("an object"));
    SceneBox {
        id: BoxId(id),
        class,
        center_m: DVec3::new(x, y, size_m.z / 2.0),
        size_m,
        yaw_rad: yaw_deg.to_radians(),
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

/// A road along x, 14 m wide, with a lane each way; two cars, a truck, a pedestrian beside it.
pub(crate) fn street(objects: &[SceneBox]) -> Scene {
    let lane = |points: [(f64, f64); 2]| Polyline {
        kind: PolylineKind::LaneCenter,
        points_m: points.map(|(x, y)| DVec2::new(x, y)).to_vec(),
    };
    let lanes = vec![
        lane([(-40.0, -1.75), (40.0, -1.75)]),
        lane([(40.0, 1.75), (-40.0, 1.75)]),
    ];
    let mut layout = BevLayout::from_cells(vec![0; Extent::WINDOW.columns()], lanes).expect("40,000 cells");
    for x in 0..Extent::WINDOW.nx() {
        for y in 83..118 {
            layout.set(BevLayer::DrivableArea, x, y, true);
        }
    }
    let boxes: BTreeMap<_, _> = objects.iter().map(|b| (b.id, *b)).collect();
    let occupancy = draft(&layout, boxes.values());
    Scene::single(
        "street",
        Frame::new(layout, boxes, occupancy),
        Arc::new(SensorRig::default()),
        1,
    )
}

pub(crate) fn traffic() -> Vec<SceneBox> {
    vec![
        object(1, Class::Car, 10.0, -1.7, 1.0),
        object(2, Class::Car, 20.0, 1.8, 178.0),
        object(3, Class::Truck, -15.0, -1.6, 0.0),
        object(4, Class::Pedestrian, 5.0, 12.0, 77.0),
        object(5, Class::Car, -5.0, 5.5, 180.0),
    ]
}

fn checks(findings: &[Finding]) -> Vec<&'static str> {
    findings.iter().map(|f| f.check).collect()
}

/// Applies a fix and returns the names of the checks that still fire.
fn after(scene: &Scene, fix: &Fix) -> Vec<&'static str> {
    let mut document = Document::new(scene.clone());
    document.apply_all(fix.label, &fix.edits).expect("a fix applies");
    checks(&run_checks(document.scene(), None))
}

/// Exactly one finding, of that check, about that box; every fix of it leaves nothing to find.
fn only(scene: &Scene, check: &str, id: Option<u32>) -> Finding {
    let findings = run_checks(scene, None);
    assert_eq!(checks(&findings), [check], "{findings:?}");
    let finding = findings[0].clone();
    assert_eq!(finding.box_id, id.map(BoxId));
    assert!(finding.where_m.is_finite() && !finding.text.is_empty() && !finding.text.contains('\n'));
    for fix in &finding.fixes {
        assert_eq!(after(scene, fix), Vec::<&str>::new(), "{}", fix.label);
    }
    finding
}

fn apply(scene: &mut Scene, edit: Edit) {
    edit.apply(scene).expect("sound");
}

fn paint(scene: &mut Scene, class: Class, cells: Vec<[usize; 3]>) {
    apply(scene, Edit::PaintVoxels { cells, class });
}

#[test]
fn all_is_well_on_a_good_street() {
    assert_eq!(run_checks(&street(&traffic()), None), []);
    assert_eq!(run_checks(&street(&[]), None), []);
    let empty = Frame::new(BevLayout::default(), BTreeMap::new(), scene::VoxelGrid::new());
    assert_eq!(
        run_checks(&Scene::single("empty", empty, Arc::default(), 0), None),
        []
    );
}

#[test]
fn floating_voxels_are_found_and_removed() {
    let mut scene = street(&traffic());
    paint(
        &mut scene,
        Class::Vegetation,
        vec![[50, 50, 9], [51, 51, 10], [50, 51, 9]],
    );
    let finding = only(&scene, "floating_voxels", None);
    assert_eq!(finding.severity, Severity::Warning);
    assert_eq!(
        finding.text,
        "3 voxels of vegetation float 2.6 m above the ground"
    );
    assert!(finding.where_m.distance(Extent::WINDOW.center(50, 50, 9)) < 1.0);
    // A stem makes it a tree.
    let stem = (1..9).map(|z| [50, 50, z]).collect();
    paint(&mut scene, Class::Vegetation, stem);
    assert_eq!(run_checks(&scene, None), []);
    // A crown is offered one.
    let mut scene = street(&[]);
    let crown = (0..27).map(|i| [60 + i % 3, 40 + i / 3 % 3, 8 + i / 9]).collect();
    paint(&mut scene, Class::Vegetation, crown);
    let finding = only(&scene, "floating_voxels", None);
    let labels: Vec<_> = finding.fixes.iter().map(|f| f.label).collect();
    assert_eq!(labels, ["Put a stem under it", "Remove floating voxels"]);
    finding.fixes[0].edits[0].apply(&mut scene).expect("sound");
    assert_eq!(scene.frame().occupancy.get(61, 41, 4), Class::Vegetation.id());
    // What may be held from outside the grid is not judged.
    let mut scene = street(&[]);
    paint(
        &mut scene,
        Class::Manmade,
        vec![[0, 60, 9], [1, 60, 9], [80, 60, 15]],
    );
    assert_eq!(run_checks(&scene, None), []);
    // Nor what stands on voxels that nobody observed.
    let mut scene = street(&[]);
    paint(&mut scene, Class::Manmade, vec![[60, 60, 8]]);
    only(&scene, "floating_voxels", None);
    let mut observed = vec![true; Extent::WINDOW.voxels()];
    observed[(Extent::WINDOW.index(60, 60)) * Window::NZ + 7] = false;
    scene.change_canvas(|f| f.inferred.unobserved = scene::Unobserved::from_observed(&observed));
    assert_eq!(run_checks(&scene, None), []);
}

#[test]
fn many_floating_groups_are_one_line_more() {
    let mut scene = street(&[]);
    let cells = (0..50).map(|i| [10 + 3 * i, 40, 8]).collect();
    paint(&mut scene, Class::Manmade, cells);
    let findings = run_checks(&scene, None);
    assert_eq!(findings.len(), 41);
    assert_eq!(findings[40].text, "10 smaller groups float, 10 voxels");
    let edits = crate::fix::plan_at_once(&scene, &findings).edits();
    edits.iter().for_each(|e| e.apply(&mut scene).expect("sound"));
    assert_eq!(run_checks(&scene, None), []);
}

#[test]
fn a_box_needs_voxels_and_voxels_need_a_box() {
    let mut scene = street(&traffic());
    let emptied = |scene: &mut Scene, b: &SceneBox| {
        scene.change_canvas(|frame| {
            for (x, y, layers) in scene::draft::box_columns(Extent::WINDOW, b) {
                frame.occupancy.column_mut(x, y)[..layers].fill(Class::FREE);
                frame.occupancy.set(x, y, 0, Class::DriveableSurface.id());
            }
        });
    };
    emptied(&mut scene, &traffic()[0]);
    let finding = only(&scene, "box_without_occupancy", Some(1));
    assert_eq!(
        (finding.severity, finding.text.as_str()),
        (Severity::Error, "car 1 has no voxel of its class")
    );
    assert_eq!(finding.fixes.len(), 2);
    // The other way round: the box goes, its voxels stay.
    let mut scene = street(&traffic());
    scene.change_canvas(|f| f.boxes.remove(&BoxId(3)));
    let finding = only(&scene, "occupancy_without_box", None);
    assert!(
        finding.text.ends_with("voxels of truck belong to no box"),
        "{}",
        finding.text
    );
    assert!(finding.where_m.truncate().distance(DVec2::new(-15.0, -1.6)) < 0.5);
    let before = scene.frame().occupancy.clone();
    let mut document = Document::new(scene.clone());
    document.apply_all("Add", &finding.fixes[0].edits).expect("sound");
    let frame = document.scene().frame();
    assert_eq!(frame.occupancy, before, "a box around voxels changes no voxel");
    let added = frame
        .boxes
        .values()
        .find(|b| b.class == Class::Truck)
        .expect("a truck");
    assert!(added.center_m.truncate().distance(DVec2::new(-15.0, -1.6)) < 0.8 && added.id > BoxId(5));
    // Removed, the road under it is whole.
    document.undo();
    document
        .apply_all("Remove", &finding.fixes[1].edits)
        .expect("sound");
    let [x, y] = Extent::WINDOW.column_at(-15.0, -1.6).expect("inside");
    assert_eq!(
        document.scene().frame().occupancy.get(x, y, 0),
        Class::DriveableSurface.id()
    );
}

#[test]
fn overlaps_are_moved_apart_or_removed() {
    let mut objects = traffic();
    objects.push(object(6, Class::Car, 13.9, -1.7, 0.0)); // 0.7 m into car 1
    let finding = only(&street(&objects), "overlapping_boxes", Some(6));
    assert_eq!(
        (finding.severity, finding.fixes[0].label),
        (Severity::Warning, "Move apart")
    );
    objects.pop();
    objects.push(object(6, Class::Car, 11.5, -1.7, 0.0));
    let finding = only(&street(&objects), "overlapping_boxes", Some(6));
    assert_eq!(
        (finding.severity, finding.fixes[0].label),
        (Severity::Error, "Move apart")
    );
    assert!(
        finding.text.starts_with("car 1 and car 6 overlap by 6"),
        "{}",
        finding.text
    );
    // A bridge deck over a car is no overlap.
    let mut high = object(6, Class::Barrier, 10.0, -1.7, 0.0);
    high.center_m.z = 2.7;
    objects.pop();
    objects.push(high);
    assert!(!checks(&run_checks(&street(&objects), None)).contains(&"overlapping_boxes"));
}

#[test]
fn three_in_one_place_are_fixed_at_once() {
    let mut objects = traffic();
    objects.extend([6, 7].map(|id| object(id, Class::Car, 10.0 + f64::from(id) * 0.3, -1.7, 0.0)));
    let mut scene = street(&objects);
    let findings = run_checks(&scene, None);
    assert_eq!(checks(&findings), ["overlapping_boxes"; 3]);
    let edits = crate::fix::plan_at_once(&scene, &findings).edits();
    assert!(
        edits.iter().all(|e| matches!(e, Edit::MoveBox { .. })),
        "nothing is taken away unasked: {edits:?}"
    );
    edits.iter().for_each(|e| e.apply(&mut scene).expect("sound"));
    assert!(!checks(&run_checks(&scene, None)).contains(&"overlapping_boxes"));
}

#[test]
fn vehicles_belong_on_the_road_in_its_direction() {
    let mut objects = traffic();
    objects[0] = object(1, Class::Car, 10.0, -10.0, 30.0);
    let finding = only(&street(&objects), "off_road", Some(1));
    assert_eq!(finding.text, "car 1 stands off the road");
    // No lane near: nothing is offered. Machines and two-wheelers may stand there.
    objects[0].center_m.y = -25.0;
    assert!(run_checks(&street(&objects), None)[0].fixes.is_empty());
    for class in [Class::Bicycle, Class::Motorcycle, Class::Pedestrian] {
        objects[0] = object(1, class, 10.0, -25.0, 30.0);
        assert_eq!(run_checks(&street(&objects), None), []);
    }
    // Works stand on the road, or with a part of them.
    for class in [Class::ConstructionVehicle, Class::Barrier, Class::TrafficCone] {
        objects[0] = object(1, class, 10.0, -6.6, 0.0);
        assert_eq!(run_checks(&street(&objects), None), []);
        objects[0] = object(1, class, 10.0, -25.0, 0.0);
        let mut scene = street(&objects);
        let finding = only(&scene, "off_road", Some(1));
        assert!(
            finding.text.ends_with(" 1 stands off the road"),
            "{}",
            finding.text
        );
        assert_eq!(finding.fixes[0].label, "Move to the road");
        // What was fitted to voxels of a data set stands where it was seen.
        scene.change_canvas(|f| f.inferred.boxes.insert(BoxId(1)));
        assert_eq!(run_checks(&scene, None), []);
    }
    // Against the lane, standing and driving.
    objects[0] = object(1, Class::Car, 10.0, -1.7, 175.0);
    let finding = only(&street(&objects), "against_lane", Some(1));
    assert_eq!(finding.text, "car 1 faces against its lane, 175 degrees from it");
    objects[0].velocity_mps = DVec2::new(-5.0, 0.0);
    let scene = street(&objects);
    let finding = only(&scene, "against_lane", Some(1));
    assert!(finding.text.contains("drives against"));
    let mut fixed = scene.clone();
    finding.fixes[0]
        .edits
        .iter()
        .for_each(|e| e.apply(&mut fixed).expect("sound"));
    let b = fixed.frame().boxes[&BoxId(1)];
    assert!(b.velocity_mps.x > 4.9 && b.heading().x > 0.999, "{b:?}");
    objects[0] = object(1, Class::Car, 10.0, -1.7, 90.0);
    assert!(
        only(&street(&objects), "against_lane", Some(1))
            .text
            .contains("across")
    );
    // Beside the lanes any heading will do.
    objects[0] = object(1, Class::Car, 10.0, -5.6, 180.0);
    assert_eq!(run_checks(&street(&objects), None), []);
}

#[test]
fn sensors_that_see_nothing_are_told() {
    let scene = street(&traffic());
    let counts = |missing: u32| {
        (1..=5)
            .filter(|id| *id != missing)
            .map(|id| (BoxId(id), 9))
            .collect()
    };
    let seen = VisibilityCounts {
        camera_pixels: Some(counts(2)),
        lidar_returns: Some(counts(4)),
    };
    let findings = run_checks(&scene, Some(&seen));
    assert_eq!(checks(&findings), ["unseen_by_cameras", "no_lidar_returns"]);
    assert_eq!(
        [findings[0].box_id, findings[1].box_id],
        [Some(BoxId(2)), Some(BoxId(4))]
    );
    // A count of 0 is no sight either; a sensor that was not asked says nothing.
    let zero = VisibilityCounts {
        camera_pixels: None,
        lidar_returns: Some([(BoxId(1), 0)].into()),
    };
    assert_eq!(checks(&run_checks(&scene, Some(&zero))), ["no_lidar_returns"; 5]);
    assert_eq!(run_checks(&scene, Some(&VisibilityCounts::default())), []);
}

#[test]
fn heights_and_places_are_checked() {
    for (z, severity, text) in [
        (-0.2, Severity::Warning, "car 1 sticks 1.1 m in the ground"),
        (
            -1.5,
            Severity::Error,
            "car 1 lies under the ground, its top at -0.7 m",
        ),
        (2.0, Severity::Warning, "car 1 hovers 1.1 m above the ground"),
        (
            4.95,
            Severity::Warning,
            "car 1 is cut off at 5.4 m, its top is at 5.8 m",
        ),
        (
            7.0,
            Severity::Error,
            "car 1 flies above the grid, its bottom at 6.2 m",
        ),
    ] {
        let mut scene = street(&traffic());
        scene.change_canvas(|f| f.boxes.get_mut(&BoxId(1)).expect("there").center_m.z = z);
        let findings = run_checks(&scene, None);
        let found = findings
            .iter()
            .find(|f| f.check == "out_of_range")
            .unwrap_or_else(|| panic!("{z}: {findings:?}"));
        assert_eq!((found.severity, found.text.as_str()), (severity, text));
        let left = after(&scene, &found.fixes[0]);
        assert_eq!(left, Vec::<&str>::new(), "{z}");
    }
    let mut scene = street(&[]);
    let mut far = object(1, Class::Car, 60.0, 0.0, 0.0);
    scene.change_canvas(|f| f.boxes.insert(BoxId(1), far));
    assert_eq!(
        run_checks(&scene, None)[0].text,
        "car 1 stands outside the map, at 60.0, 0.0 m"
    );
    // Taller than the grid: dropping does not help.
    far = object(1, Class::Car, 10.0, -1.7, 0.0);
    (far.size_m.z, far.center_m.z) = (6.0, 3.0);
    let finding = &run_checks(&street(&[far]), None)[0];
    assert!(finding.check == "out_of_range" && finding.fixes.is_empty());
}

#[test]
fn what_is_not_sound_is_named_and_stops_no_other_check() {
    let mut scene = street(&traffic());
    let mut frame = Frame::clone(scene.frame());
    let bad = frame.boxes.get_mut(&BoxId(2)).expect("there");
    bad.center_m.x = f64::NAN;
    frame.boxes.get_mut(&BoxId(3)).expect("there").id = BoxId(33);
    let twin = SceneBox {
        id: BoxId(9),
        ..frame.boxes[&BoxId(1)]
    };
    frame.boxes.insert(BoxId(9), twin);
    frame.occupancy.set(3, 3, 3, 40);
    frame.time_s = f64::INFINITY;
    let mut lines = frame.layout.polylines.to_vec();
    lines[0].points_m[0].x = f64::NAN;
    frame.layout.polylines = Arc::new(lines);
    scene.change_canvas(|canvas| *canvas = frame);
    let findings = run_checks(&scene, None);
    let errors: Vec<&Finding> = findings.iter().filter(|f| f.check == "unsound").collect();
    assert_eq!(errors.len(), 6, "{findings:?}");
    assert!(
        errors
            .iter()
            .all(|f| f.severity == Severity::Error && f.where_m.is_finite())
    );
    for (finding, text) in errors.iter().zip([
        "box 2: center_m is [NaN",
        "box 33 is filed under id 3",
        "car 1 is there twice, as 9 too",
        "polyline 0 has a vertex at",
        "time or pose",
        "1 voxels hold label 40, expected 0 to 17",
    ]) {
        assert!(finding.text.starts_with(text), "{} is not {text}", finding.text);
    }
    let fixed = crate::fix::plan_at_once(&scene, &findings).edits();
    fixed.iter().for_each(|e| e.apply(&mut scene).expect("sound"));
    let boxes: Vec<u32> = scene.frame().boxes.keys().map(|id| id.0).collect();
    assert_eq!(
        boxes.iter().filter(|id| [2, 3, 9].contains(id)).count(),
        0,
        "{boxes:?}"
    );
}

#[test]
fn names_are_unique_and_results_repeat() {
    let all: std::collections::BTreeSet<&str> = names().collect();
    assert_eq!(all.len(), CHECKS.len());
    let mut objects = traffic();
    objects.extend((10..200).map(|id| {
        object(
            id,
            Class::Car,
            f64::from(id % 40) - 20.0,
            f64::from(id % 17) - 8.0,
            f64::from(id),
        )
    }));
    let scene = street(&objects);
    assert_eq!(run_checks(&scene, None), run_checks(&scene, None));
}

#[test]
fn waived_findings_stay_until_they_are_taken_back() {
    let mut scene = street(&[
        object(1, Class::Car, 10.0, -1.7, 1.0),
        object(2, Class::Car, 11.0, -1.7, 1.0),
    ]);
    let findings = run_checks(&scene, None);
    let open = |scene: &Scene| waive::open(scene.frame(), &run_checks(scene, None)).count();
    assert!(!findings.is_empty() && open(&scene) == findings.len());
    assert!(!crate::fix::plan_at_once(&scene, &findings).repairs.is_empty());
    let waive_edit = |f: &Finding, reason: &str| Edit::Waive {
        check: f.check.into(),
        box_id: f.box_id,
        where_m: f.where_m,
        reason: reason.into(),
    };
    for finding in &findings {
        waive_edit(finding, "seen").apply(&mut scene).expect("sound");
    }
    assert_eq!((open(&scene), scene.frame().waivers.len()), (0, findings.len()));
    assert!(
        crate::fix::plan_at_once(&scene, &findings).repairs.is_empty(),
        "what is waived is not repaired"
    );
    // A new reason takes the place of the old one.
    waive_edit(&findings[0], "  looked again ")
        .apply(&mut scene)
        .expect("sound");
    assert_eq!(scene.frame().waivers.len(), findings.len());
    let waiver = waive::of(scene.frame(), &findings[0]).expect("waived");
    assert_eq!(&*waiver.reason, "looked again");
    // It goes through JSON.
    let edit = waive_edit(&findings[0], "x");
    let json = serde_json::to_string(&edit).expect("JSON");
    assert_eq!(serde_json::from_str::<Edit>(&json).expect("read"), edit);
    let f = &findings[0];
    let back = Edit::Unwaive {
        check: f.check.into(),
        box_id: f.box_id,
        where_m: f.where_m,
    };
    back.apply(&mut scene).expect("sound");
    assert_eq!(open(&scene), 1);
    let rev = scene.rev;
    back.apply(&mut scene).expect("nothing to take back");
    assert_eq!(scene.rev, rev);
    for (check, reason, where_m) in [
        ("no_such_check", "x", DVec3::ZERO),
        (findings[0].check, "  ", DVec3::ZERO),
        (findings[0].check, "x", DVec3::NAN),
    ] {
        let edit = Edit::Waive {
            check: check.into(),
            box_id: None,
            where_m,
            reason: reason.into(),
        };
        assert!(matches!(edit.apply(&mut scene), Err(EditError::BadWaiver(_))));
    }
}

#[path = "tests_standing.rs"]
mod standing;
