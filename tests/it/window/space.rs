//! More map, more time, a place on roads.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use super::bench::Bench;

#[test]
fn the_map_grows_by_a_click_beyond_its_edge() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.app().document.scene().clone();
    let (extent, history) = (before.canvas().extent(), bench.history());
    bench.click("More map ahead");
    let after = bench.app().document.scene().clone();
    let grown = after.canvas().extent();
    assert_eq!((grown.nx(), grown.ny()), (extent.nx() + 100, extent.ny()));
    assert_eq!(bench.history().len(), history.len() + 1);
    assert_eq!(after.canvas().occupancy.crop(extent), before.canvas().occupancy);
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.app().document.scene().canvas().extent(), extent);
}

#[test]
fn a_place_is_chosen_on_the_roads_of_a_file() {
    let mut bench = Bench::new();
    bench.off();
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/roads/four_arm_junction.xodr");
    bench.key(Modifiers::CTRL, Key::O);
    bench.give_path(&path, "Open file");
    let shows = |b: &Bench, label: &str| b.harness.query_by_label(label).is_some();
    bench.wait_until("the roads", |b| shows(b, "Make the scene"));
    let before = bench.app().document.scene().content();
    bench.click("300 × 100");
    bench.click("Make the scene");
    bench.wait_until("the scene", |b| b.app().document.scene().content() != before);
    let extent = bench.app().document.scene().canvas().extent();
    assert_eq!((extent.nx(), extent.ny()), (750, 250));
    assert!(!shows(&bench, "Make the scene"));
}

#[test]
fn a_forecast_waits_to_be_accepted() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Clip");
    bench.click("Motion of the ego vehicle…");
    bench.click("Drive along the lane");
    let length_s = |b: &mut Bench| b.app().document.scene().clip().length_s;
    let before_s = length_s(&mut bench);
    bench.click("Forecast");
    assert!((length_s(&mut bench) - before_s - 3.0).abs() < 1e-9);
    bench.click("Decline");
    assert_eq!(length_s(&mut bench), before_s);
    bench.click("Forecast");
    bench.click("Accept");
    assert!((length_s(&mut bench) - before_s - 3.0).abs() < 1e-9);
    assert!(bench.harness.query_by_label("Decline").is_none());
}
