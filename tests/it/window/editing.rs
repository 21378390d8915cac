//! Strokes, boxes and what is generated after them.

use editor::tools::brush;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::DVec2;
use job::RegionMode;
use scene::{BevLayer, BoxId, Class, Window};

use super::bench::{Bench, Do, car};

#[test]
fn a_stroke_is_one_undo_step_and_shows_at_once() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Paint carpark area");
    assert_eq!(
        (bench.app().state.tool, bench.app().state.layer),
        (brush::ID, BevLayer::CarparkArea)
    );
    let before = bench.frame();
    let way = [bench.bev(-20.0, 25.0), bench.bev(0.0, 25.0), bench.bev(0.0, 32.0)];
    bench.press_and_move(&way, Modifiers::NONE);
    assert!(bench.app().document.is_dragging());
    assert!(
        bench.frame().layout.count(BevLayer::CarparkArea) > 300,
        "shown while painting"
    );
    bench.button(way[2], false, Modifiers::NONE);
    bench.steps(2);
    assert_eq!(bench.history(), ["Open", "Paint layer"]);
    let painted = bench.frame();
    let [x, y] = Window::column_at(-10.0, 25.0).expect("inside");
    assert!(painted.layout.has(BevLayer::CarparkArea, x, y));
    assert_eq!(painted.occupancy.get(x, y, 0), Class::DriveableSurface.id());
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.frame(), before);
    bench.key(Modifiers::CTRL, Key::Y);
    assert_eq!(bench.frame(), painted);
    bench.click("Undo");
    assert_eq!(bench.frame(), before);
    bench.key(Modifiers::CTRL | Modifiers::SHIFT, Key::Z);
    assert_eq!(bench.frame(), painted);
    // Shift erases; Escape takes a stroke back.
    let back = [bench.bev(-12.0, 25.0), bench.bev(-8.0, 25.0)];
    bench.drag(&back, Modifiers::SHIFT);
    assert!(!bench.frame().layout.has(BevLayer::CarparkArea, x, y));
    let erased = bench.frame();
    bench.press_and_move(&way, Modifiers::NONE);
    assert_ne!(bench.frame(), erased);
    bench.key(Modifiers::NONE, Key::Escape);
    assert_eq!(bench.frame(), erased);
    bench.button(way[2], false, Modifiers::NONE);
    assert_eq!(bench.history(), ["Open", "Paint layer", "Erase layer"]);
}

#[test]
fn a_box_is_added_moved_turned_copied_and_deleted() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::A);
    bench.click("Add truck");
    let at = bench.bev(-15.0, 2.0);
    bench.drag(&[at], Modifiers::NONE);
    let truck = bench.frame().boxes[&BoxId(8)];
    assert_eq!(truck.class, Class::Truck);
    assert!(
        (truck.center_m.truncate() - DVec2::new(-15.0, 2.0)).length() < 0.1,
        "{truck:?}"
    );
    assert!(
        (truck.center_m.z - truck.size_m.z / 2.0).abs() < 1e-9,
        "stands on the ground"
    );
    assert!(bench.app().state.selected == Some(BoxId(8)));
    let [x, y] = Window::column_at(-15.0, 2.0).expect("inside");
    assert_eq!(
        bench.frame().occupancy.get(x, y, 1),
        Class::Truck.id(),
        "voxels at once"
    );

    bench.key(Modifiers::NONE, Key::V);
    let way = [bench.bev(-15.0, 2.0), bench.bev(-9.0, 4.0)];
    bench.drag(&way, Modifiers::NONE);
    let moved = bench.frame().boxes[&BoxId(8)];
    assert!(
        (moved.center_m - truck.center_m)
            .truncate()
            .distance(DVec2::new(6.0, 2.0))
            < 0.15,
        "{moved:?}"
    );
    let knob = editor::pick::rotate_knob(&moved);
    let aim = moved.center_m.truncate() + DVec2::new(0.0, 6.0);
    let way = [bench.bev(knob.x, knob.y), bench.bev(aim.x, aim.y)];
    bench.drag(&way, Modifiers::NONE);
    let turned = bench.frame().boxes[&BoxId(8)];
    assert!(
        (turned.yaw_rad.to_degrees() - 90.0).abs() < 1.5,
        "{}",
        turned.yaw_rad.to_degrees()
    );

    bench.key(Modifiers::NONE, Key::ArrowUp);
    let nudged = bench.frame().boxes[&BoxId(8)];
    assert!((nudged.center_m.x - turned.center_m.x - 0.1).abs() < 1e-9);
    bench.key(Modifiers::CTRL, Key::D);
    assert!(bench.frame().boxes.contains_key(&BoxId(9)));
    assert_eq!(bench.app().state.selected, Some(BoxId(9)));
    bench.key(Modifiers::NONE, Key::Delete);
    assert!(!bench.frame().boxes.contains_key(&BoxId(9)));
    assert_eq!(bench.app().state.selected, None);
    assert_eq!(
        bench.history(),
        [
            "Open",
            "Add box",
            "Move box",
            "Turn box",
            "Nudge box",
            "Duplicate box",
            "Delete box"
        ]
    );
    // Chosen by name in the list, deleted by the button of the inspector, brought back.
    bench.click("Box 7 car");
    bench.click("Delete box");
    assert!(!bench.frame().boxes.contains_key(&BoxId(7)));
    bench.click("Undo");
    assert!(bench.frame().boxes.contains_key(&BoxId(7)));
    // A step of the history is one click away.
    bench.click("History 5 Duplicate box");
    assert!(bench.frame().boxes.contains_key(&BoxId(9)), "the copy is back");
    assert_eq!(bench.app().document.position(), 5);
}

#[test]
fn an_edit_is_generated_in_the_background_and_adopted() {
    let mut bench = Bench::new();
    bench.steps(3);
    assert!(bench.started.is_empty(), "nothing was edited");
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::Delete);
    let rough = bench.frame();
    bench.wait_until("the job", |b| !b.started.is_empty());
    assert_eq!(bench.started.recv(), Ok(RegionMode::Auto));
    bench.orders.send(Do::Step).expect("listens");
    bench.wait_until("progress", |b| {
        b.harness.query_by_label_contains("Denoising 1/3").is_some()
    });
    assert!(bench.harness.query_by_label("Generation progress").is_some());
    assert_eq!(bench.frame(), rough, "nothing changes before it is done");
    bench.orders.send(Do::Finish).expect("listens");
    bench.wait_until("the result", |b| b.app().generation.live.running.is_none());
    bench.steps(3);
    let frame = bench.frame();
    let [x, y] = Window::column_at(14.0, 3.0).expect("inside");
    assert_eq!(frame.occupancy.get(x, y, 0), Class::Vegetation.id(), "adopted");
    assert_eq!(
        frame.occupancy, frame.source.occupancy,
        "the source of what comes next"
    );
    let receipt = bench.app().generation.receipt.clone().expect("a receipt");
    assert_eq!((receipt.network_calls, receipt.untouched_voxels_changed), (20, 0));
    assert!(
        bench
            .harness
            .query_by_label_contains("untouched voxels changed: 0")
            .is_some()
    );
    // No second job for the same state; undo and redo need none either.
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.frame().boxes.len(), 1);
    bench.key(Modifiers::CTRL, Key::Y);
    bench.steps(10);
    assert!(bench.started.is_empty());
    assert_eq!(bench.frame().occupancy.get(x, y, 0), Class::Vegetation.id());
    assert_eq!(
        bench.history(),
        ["Open", "Delete box"],
        "adopting is no undo step"
    );
}

#[test]
fn everything_is_generated_on_request_and_cancelled_on_request() {
    let mut bench = Bench::new();
    let before = bench.frame();
    bench.key(Modifiers::CTRL, Key::Enter);
    bench.wait_until("the job", |b| !b.started.is_empty());
    assert_eq!(bench.started.recv(), Ok(RegionMode::Full));
    bench.click("Cancel generation");
    bench.wait_until("its end", |b| b.app().generation.live.running.is_none());
    bench.steps(5);
    assert_eq!(bench.frame(), before);
    assert!(
        bench.started.is_empty(),
        "a cancelled job does not come back by itself"
    );
    bench.click("Generate everything");
    bench.wait_until("the job", |b| !b.started.is_empty());
    bench.started.recv().expect("it started");
    bench.orders.send(Do::Finish).expect("listens");
    bench.wait_until("the result", |b| b.app().generation.live.running.is_none());
    bench.steps(2);
    assert_eq!(bench.frame().occupancy.get(3, 3, 0), Class::Vegetation.id());
}

#[test]
fn the_newest_edit_wins_and_undo_stops_what_is_useless() {
    let mut bench = Bench::new();
    bench.click("Box 7 car");
    bench.key(Modifiers::NONE, Key::ArrowUp);
    bench.wait_until("the first job", |b| b.started.len() == 1);
    bench.key(Modifiers::NONE, Key::ArrowUp);
    bench.wait_until("the second job", |b| b.started.len() == 2);
    bench.key(Modifiers::CTRL, Key::Z);
    bench.wait_until("a job for the state before", |b| b.started.len() == 3);
    bench.key(Modifiers::CTRL, Key::Z);
    bench.wait_until("rest", |b| b.app().generation.live.running.is_none());
    bench.steps(5);
    assert_eq!((bench.started.len(), bench.frame().boxes[&BoxId(7)]), (3, car()));
}
