//! Words: typed into the prompt, they change the scene or make another one, and all of it can be undone.

use editor::tools::InpaintArea;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::DVec2;
use scene::BoxId;
use sensors::cameras::pictures;

use super::bench::Bench;

fn say(bench: &mut Bench, words: &str) {
    bench.key(Modifiers::NONE, Key::Slash);
    bench.steps(3);
    bench.harness.get_by_label("Prompt").type_text(words);
    bench.steps(3);
}

#[test]
fn a_sentence_names_its_step_and_the_next_one_replaces_it() {
    let mut bench = Bench::new();
    bench.off();
    say(&mut bench, "make it night");
    bench.key(Modifiers::NONE, Key::Enter);
    assert_eq!(bench.history(), ["Open", "“make it night”"]);
    assert_eq!(
        bench.app().state.cameras.view,
        pictures::VIEW.id,
        "night is seen in pictures"
    );
    // The field keeps the keyboard: undo is still that of the scene, letters are no shortcuts.
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.app().document.position(), 0);
    bench
        .harness
        .get_by_label("Prompt")
        .type_text("add a bus 20 m ahead");
    bench.steps(3);
    bench.key(Modifiers::NONE, Key::Enter);
    assert_eq!(bench.history(), ["Open", "“add a bus 20 m ahead”"]);
    let bus = bench
        .frame()
        .boxes
        .values()
        .find(|b| b.class.name() == "bus")
        .map(|b| b.id);
    assert!(
        bus.is_some() && bench.app().state.selected == bus,
        "what came is chosen"
    );
}

#[test]
fn tab_completes_the_word_at_the_caret() {
    let mut bench = Bench::new();
    bench.off();
    say(&mut bench, "add two pede");
    bench.harness.get_by_label("Complete with pedestrians");
    bench.key(Modifiers::NONE, Key::Tab);
    bench.harness.get_by_label("Prompt").type_text("20 m ahead");
    bench.steps(3);
    bench.key(Modifiers::NONE, Key::Enter);
    assert_eq!(bench.history(), ["Open", "“add two pedestrians 20 m ahead”"]);
}

#[test]
fn a_scene_of_words_can_be_undone() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame().boxes.len();
    say(&mut bench, "straight street, three parked cars, a bus 20 m ahead");
    bench.key(Modifiers::CTRL, Key::Enter);
    bench.wait_until("the scene", |b| b.history().len() == 2);
    assert_eq!(bench.history(), ["Open", "Scene from words"]);
    assert!(bench.app().document.is_dirty(), "it is in no file");
    assert_eq!(bench.app().path(), None, "saving asks where to");
    assert_eq!(bench.frame().boxes.len(), 4);
    // Another roll is another step.
    bench.click("Re-roll");
    bench.wait_until("another scene", |b| b.history().len() == 3);
    bench.app().document.jump_to(0);
    assert_eq!(bench.frame().boxes.len(), before);
}

#[test]
fn variants_and_what_memory_goes_by_are_pictures() {
    let mut bench = Bench::new();
    bench.off();
    bench.harness.get_by_label("Prompt").click();
    bench.steps(2);
    bench
        .harness
        .get_by_label("Prompt")
        .type_text("two cars ahead at a junction");
    bench.steps(3);
    bench.click("Memory");
    bench.wait_until("the remembered scene", |b| {
        b.harness.query_by_label_contains("Remembered scene: ").is_some()
    });
    assert!(bench.harness.query_by_label_contains("similarity 0.").is_some());
    bench.harness.get_by_label("Variants").scroll_to_me();
    bench.steps(30);
    bench.click("Variants");
    bench.steps(3);
    let first = bench.harness.get_by_label("Variant of seed 0").rect();
    assert!(
        first.width() > 100.0 && (first.width() - first.height()).abs() < 0.5,
        "{first:?}"
    );
    bench.harness.get_by_label("Variant of seed 0").scroll_to_me();
    bench.steps(30);
    let says = "A click makes this scene";
    bench.wait_until("the enlarged variant", |b| {
        let at = b.harness.get_by_label("Variant of seed 0").rect().center();
        b.harness.hover_at(at);
        // It shows when the pointer rests.
        b.steps(60);
        b.harness.query_by_label(says).is_some()
    });
}

#[test]
fn what_was_carried_out_is_not_said_to_be_not_understood() {
    let mut bench = Bench::new();
    bench.off();
    say(&mut bench, "remove the cars ahead of me");
    bench.key(Modifiers::NONE, Key::Enter);
    bench.steps(3);
    assert_eq!(bench.history(), ["Open", "“remove the cars ahead of me”"]);
    assert_eq!(
        bench
            .harness
            .query_all_by_label_contains("Not understood")
            .count(),
        0
    );
}

#[test]
fn words_change_only_what_lies_in_the_marked_region() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::A);
    let at = bench.bev(-15.0, 2.0);
    bench.drag(&[at], Modifiers::NONE);
    assert_eq!(bench.frame().boxes.len(), 2);
    // What is marked lies behind us, the car of the scene ahead.
    let extent = bench.frame().extent();
    let behind = InpaintArea::Rect(DVec2::new(-30.0, -10.0), DVec2::new(-5.0, 10.0));
    bench.app().state.tools.mark(extent, &behind, true);
    bench.steps(2);
    bench.click("Only in the marked region");
    say(&mut bench, "remove all cars");
    bench.key(Modifiers::NONE, Key::Enter);
    let left: Vec<_> = bench.frame().boxes.keys().copied().collect();
    assert_eq!(left, [BoxId(7)]);
    let told = bench.harness.query_by_label_contains("outside the marked region");
    assert!(told.is_some());
    // What is added comes there.
    say(&mut bench, "add a bus 20 m ahead");
    bench.key(Modifiers::NONE, Key::Enter);
    let frame = bench.frame();
    let bus = frame.boxes.values().find(|b| b.id != BoxId(7)).expect("a bus");
    assert!((-30.0..-5.0).contains(&bus.center_m.x), "{bus:?}");
}

#[test]
fn wildcards_are_drawn_by_the_seed_and_what_was_drawn_is_recorded() {
    let mut bench = Bench::new();
    bench.off();
    say(&mut bench, "make it {night|dusk}");
    let drawn = app::wildcards::drawn("make it {night|dusk}", 0);
    let told = format!("Drawn by the seed: {drawn}");
    assert!(bench.harness.query_by_label(&told).is_some());
    bench.key(Modifiers::NONE, Key::Enter);
    assert_eq!(bench.history(), ["Open".to_owned(), format!("“{drawn}”")]);
    let words = bench.app().document.scene().words.clone();
    assert_eq!(words.last(), Some(&drawn));
    // What was typed is what is typed again.
    assert!(
        bench
            .app()
            .views
            .prompt
            .typed()
            .iter()
            .any(|t| t == "make it {night|dusk}")
    );
}

#[test]
fn kept_words_stand_first_and_outlive_the_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("settings.json");
    let mut bench = Bench::with_settings(&file);
    bench.off();
    bench.click("Go on with this scene");
    bench.app().views.prompt.star("add a {car|bus} 20 m ahead");
    bench.key(Modifiers::NONE, Key::Slash);
    bench.click("add a {car|bus} 20 m ahead");
    bench.key(Modifiers::NONE, Key::Enter);
    assert_eq!(bench.frame().boxes.len(), 2);
    let kept = ["add a {car|bus} 20 m ahead"];
    bench.wait_until("settings", |_| {
        app::settings::Settings::load(&file).is_ok_and(|s| s.kept_words == kept)
    });
    drop(bench);
    let mut again = Bench::with_settings(&file);
    assert_eq!(again.app().views.prompt.favourites, kept);
}

#[test]
fn a_change_is_drawn_again_by_the_next_seed_and_takes_no_scene_away() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame().boxes.len();
    say(&mut bench, "add {2|3|4|5} cars");
    bench.key(Modifiers::NONE, Key::Enter);
    bench.steps(3);
    let name = bench.app().document.scene().name.clone();
    let added = |b: &Bench| b.frame().boxes.len() - before;
    assert_eq!(bench.history().len(), 2);
    let mut counts = std::collections::BTreeSet::from([added(&bench)]);
    for _ in 0..8 {
        bench.click("Re-roll");
        bench.steps(4);
        assert_eq!(bench.history().len(), 2, "in place of the one before");
        counts.insert(added(&bench));
    }
    assert!(
        counts.len() > 1 && counts.iter().all(|n| (1..6).contains(n)),
        "{counts:?}"
    );
    assert_eq!(bench.app().document.scene().name, name);
    // With something after it there is a word about it.
    let ctx = bench.harness.ctx.clone();
    let id = BoxId(7);
    let remove = app::Command::Apply("Remove", vec![editor::Edit::RemoveBox { id }]);
    bench.app().execute(remove, &ctx);
    let after = bench.frame();
    bench.click("Re-roll");
    bench.steps(4);
    assert_eq!(bench.frame(), after);
    let told = "Something came after this change: take that back first, or type the change anew.";
    assert!(bench.harness.query_by_label(told).is_some());
}
