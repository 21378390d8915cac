//! Groups, hidden and locked objects, and pictures, in the window.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::DVec2;
use scene::{BoxId, Class};

use super::bench::Bench;

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Two cars: 7 at (14, 3), and 8 at (-15, 2).
fn two_cars() -> Bench {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::A);
    let at = bench.bev(-15.0, 2.0);
    bench.drag(&[at], Modifiers::NONE);
    bench.key(Modifiers::NONE, Key::V);
    bench
}

fn at(bench: &Bench, id: u32) -> DVec2 {
    bench.frame().boxes[&BoxId(id)].center_m.truncate()
}

fn click(bench: &mut Bench, p: DVec2) {
    let p = bench.bev(p.x, p.y);
    bench.drag(&[p], Modifiers::NONE);
}

#[test]
fn a_group_is_chosen_by_one_click_and_moves_together() {
    let mut bench = two_cars();
    bench.key(Modifiers::COMMAND, Key::A);
    bench.key(Modifiers::COMMAND, Key::G);
    assert_eq!(bench.history().last().map(String::as_str), Some("Group"));
    bench.key(COMMAND_SHIFT, Key::A);
    assert!(bench.app().state.chosen().is_empty());
    let first = at(&bench, 7);
    click(&mut bench, first);
    assert_eq!(bench.app().state.chosen(), [BoxId(7), BoxId(8)]);
    // A second click goes on to the one under the pointer.
    click(&mut bench, first);
    assert_eq!(bench.app().state.chosen(), [BoxId(7)]);
    bench.key(COMMAND_SHIFT, Key::A);
    let before = [at(&bench, 7), at(&bench, 8)];
    let second = at(&bench, 8);
    let way = [bench.bev(second.x, second.y), bench.bev(second.x, second.y + 5.0)];
    bench.drag(&way, Modifiers::NONE);
    for (id, before) in [7, 8].into_iter().zip(before) {
        assert!(
            (at(&bench, id) - before - DVec2::Y * 5.0).length() < 0.2,
            "box {id}"
        );
    }
    assert!(bench.harness.query_by_label("Group Group of 2").is_some());
    bench.key(COMMAND_SHIFT, Key::G);
    assert!(bench.app().document.scene().arranged.is_empty());
}

#[test]
fn what_is_locked_stays_and_what_is_hidden_cannot_be_clicked() {
    let mut bench = two_cars();
    let first = at(&bench, 7);
    click(&mut bench, first);
    bench.key(Modifiers::COMMAND, Key::L);
    let way = [bench.bev(first.x, first.y), bench.bev(first.x + 6.0, first.y)];
    bench.drag(&way, Modifiers::NONE);
    assert_eq!(at(&bench, 7), first);
    bench.key(Modifiers::COMMAND, Key::A);
    bench.key(Modifiers::NONE, Key::Delete);
    let left: Vec<BoxId> = bench.frame().boxes.keys().copied().collect();
    assert_eq!(left, [BoxId(7)]);
    assert!(bench.harness.query_by_label_contains("Box 7 is locked").is_some());
    bench.key(COMMAND_SHIFT, Key::L);
    // Its voxels go from the views, not from the scene.
    click(&mut bench, first);
    bench.key(Modifiers::COMMAND, Key::H);
    assert!(bench.app().state.chosen().is_empty());
    click(&mut bench, first);
    assert!(bench.app().state.chosen().is_empty());
    let cars = |bench: &Bench| {
        let frame = bench.frame();
        frame
            .occupancy
            .iter_set()
            .filter(|v| v.3 == Class::Car.id())
            .count()
    };
    assert!(cars(&bench) > 0 && bench.frame().boxes.contains_key(&BoxId(7)));
    bench.key(COMMAND_SHIFT, Key::H);
    click(&mut bench, first);
    assert_eq!(bench.app().state.chosen(), [BoxId(7)]);
    // The eye in the list does the same.
    bench.click("Show Box 7 car");
    assert!(
        bench
            .app()
            .document
            .scene()
            .arranged
            .hidden
            .boxes
            .contains(&BoxId(7))
    );
}

#[test]
fn a_screen_reader_chooses_a_box_of_the_map() {
    let mut bench = two_cars();
    bench.key(COMMAND_SHIFT, Key::A);
    let label = "car 8 on the map: 15 m behind, 2 m to the left";
    bench.harness.get_by_label(label).click_accesskit();
    bench.steps(3);
    assert_eq!(bench.app().state.chosen(), [BoxId(8)]);
}

#[test]
fn a_picture_of_the_map_is_saved_from_the_dialog() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(COMMAND_SHIFT, Key::P);
    bench.click("Map");
    bench.click("Save picture…");
    let path = bench.folder.path().join("map.png");
    bench.give_path(&path, "Save file");
    bench.wait_until("the picture", |_| path.exists());
    let bytes = std::fs::read(&path).expect("there");
    let inside = formats::png::notes_inside(&bytes).expect("a PNG");
    assert!(inside.scene.is_some());
    let picture = image::load_from_memory(&bytes).expect("a PNG");
    assert_eq!(
        [picture.width(), picture.height()],
        [1280, 720],
        "map and legend together"
    );
}
