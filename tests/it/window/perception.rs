//! What a camera network sees, in the window: the list, a search, a corner case taken and one kept.

use std::sync::Arc;

use app::command::{Command, ViewCommand};
use app::panes::id::PaneId;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use scene::{BoxId, Weather};

use super::bench::Bench;

fn command(bench: &mut Bench, command: Command) {
    let ctx = bench.harness.ctx.clone();
    bench.app().execute(command, &ctx);
    bench.steps(3);
}

fn shows(bench: &Bench, label: &str) -> bool {
    bench.harness.query_by_label_contains(label).is_some()
}

/// The rows of boxes, as they are labelled.
fn rows(bench: &Bench) -> Vec<String> {
    let rows = bench.harness.query_all_by_label_contains("Car #7");
    rows.filter_map(|node| node.accesskit_node().label()).collect()
}

#[test]
fn a_box_is_listed_and_a_change_is_found_after_which_it_is_missed() {
    let mut bench = Bench::new();
    bench.off();
    command(
        &mut bench,
        Command::View(ViewCommand::ShowPane(PaneId::named("perception"))),
    );
    bench.wait_until("what the network sees", |b| !rows(b).is_empty());
    assert!(shows(
        &bench,
        "Choose a box, and a change of the scene is searched after which the network misses it."
    ));
    let row = rows(&bench).remove(0);
    assert!(row.contains("Front") && row.ends_with('%'), "{row}");
    bench.click(&row);
    assert_eq!(bench.app().state.selected, Some(BoxId(7)));

    // In fog it vanishes in the end.
    let vary = bench.harness.get_by_role_and_label(Role::ComboBox, "Vary");
    vary.click();
    bench.steps(3);
    bench.click("Fog");
    bench.click("Search");
    bench.wait_until("the end of the search", |b| {
        b.harness.query_by_label_contains("Missed: visibility").is_some()
    });
    let before = bench.app().document.scene().content();
    bench.click("Keep as a version");
    assert_eq!(bench.app().document.scene().content(), before, "the scene stays");
    let versions = bench.app().generation.versions.list();
    assert!(
        versions
            .iter()
            .any(|v| v.label == "Corner case" && v.note.starts_with("#7: visibility"))
    );
    bench.click("Take it");
    assert_eq!(bench.app().document.scene().conditions.weather, Weather::Fog);
    assert_eq!(bench.history().last().map(String::as_str), Some("Corner case"));
    // What was searched for another state cannot be taken again.
    assert!(shows(&bench, "the scene has changed since"));
    bench.wait_until("what it sees in fog", |b| {
        rows(b).iter().any(|now| *now != row) && !shows(b, &row)
    });
}

#[test]
fn what_both_sensors_tell_is_shown_in_place_of_the_scene() {
    let mut bench = Bench::new();
    bench.off();
    let pane = PaneId::named("perception");
    command(&mut bench, Command::View(ViewCommand::ShowPane(pane)));
    bench.wait_until("what the cameras see", |b| !rows(b).is_empty());
    // The map's control of the same name is above it.
    let all = bench.harness.query_all_by_label("Both");
    let lowest = all.max_by(|a, b| a.rect().top().total_cmp(&b.rect().top()));
    lowest.expect("the choice").click();
    bench.steps(3);
    bench.wait_until("what both tell", |b| {
        b.app().state.shown.detection_marks.is_some() && shows(b, "the network's voxels, to look at alone")
    });
    let told = |b: &mut Bench| {
        let marks = b.app().state.shown.detection_marks.clone();
        marks.expect("marks").told.clone()
    };
    let of = bench.app().document.scene().clone();
    let shown = told(&mut bench).expect("voxels that are told");
    assert!(shown.frame().occupancy.count_set() > 1000);
    assert!(shown.frame().occupancy.count_different(&of.frame().occupancy) > 0);
    assert!(Arc::ptr_eq(&of, bench.app().document.scene()), "the scene stays");
    bench.click("Its voxels in the 3D view");
    assert!(told(&mut bench).is_none() && !shows(&bench, "the network's voxels, to look at alone"));
}
