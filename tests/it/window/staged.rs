//! Results that wait for a verdict beside what was there before.

use app::command::{Command, GenerationCommand};
use app::compare::CompareMode;
use app::scenery::SceneryMethod;
use editor::Edit;
use egui::Modifiers;
use egui_kittest::kittest::Queryable;
use job::RegionMode;
use job::inpaint::InpaintMask;
use scene::{Class, VoxelGrid, Window};
use world::scenery::RoadsideKind;

use super::bench::{Bench, Do, PATIENCE};

/// A window in which everything was generated: all columns are vegetation now.
fn generated() -> (Bench, VoxelGrid) {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame().occupancy.clone();
    bench.click("Generate everything");
    finish(&mut bench);
    (bench, before)
}

fn finish(bench: &mut Bench) {
    let started = bench.started.recv_timeout(PATIENCE);
    assert_eq!(started, Ok(RegionMode::Full));
    bench.orders.send(Do::Finish).expect("the pipeline listens");
    bench.wait_until("the end", |b| b.app().generation.live.running.is_none());
    bench.steps(3);
}

fn seed_of(bench: &mut Bench) -> Option<u64> {
    let staged = bench.app().staged();
    staged.and_then(|s| s.again.as_ref()).map(|again| again.seed())
}

fn vegetation(bench: &Bench) -> usize {
    let frame = bench.frame();
    let column = |c: usize| frame.occupancy.column(c / Window::NY, c % Window::NY)[0];
    (0..Window::COLUMNS)
        .filter(|c| column(*c) == Class::Vegetation.id())
        .count()
}

#[test]
fn a_result_is_shown_beside_the_old_and_declined_or_accepted() {
    let (mut bench, before) = generated();
    assert_eq!(bench.history(), ["Open", "Generate"]);
    assert_eq!(bench.app().state.compare.mode, CompareMode::Wipe);
    bench.click("Decline");
    assert!(bench.frame().occupancy == before);
    assert!(bench.app().staged().is_none());
    assert_eq!(bench.app().state.compare.mode, CompareMode::Off);
    // What was declined can be had back.
    bench.key(Modifiers::COMMAND, egui::Key::Y);
    assert_eq!(vegetation(&bench), Window::COLUMNS);
    let (mut bench, _) = generated();
    bench.click("Accept");
    assert_eq!(vegetation(&bench), Window::COLUMNS);
    assert!(bench.app().staged().is_none());
    assert_eq!(bench.app().state.compare.mode, CompareMode::Off);
    assert!(bench.harness.query_by_label("Decline").is_none());
}

#[test]
fn going_on_without_a_verdict_accepts() {
    let (mut bench, _) = generated();
    bench.key(Modifiers::NONE, egui::Key::J);
    bench.key(Modifiers::NONE, egui::Key::Delete);
    assert_eq!(bench.history(), ["Open", "Generate", "Delete box"]);
    assert!(bench.app().staged().is_none());
    assert_eq!(bench.app().state.compare.mode, CompareMode::Off);
}

#[test]
fn another_seed_takes_its_place() {
    let (mut bench, before) = generated();
    let seed = seed_of(&mut bench).expect("staged");
    let things = |b: &mut Bench| b.app().document.scene().background.clone();
    let first = things(&mut bench);
    bench.click("Next seed");
    // Other scenery, on which it is generated.
    assert!(bench.frame().occupancy != before && things(&mut bench) != first);
    let params = bench
        .app()
        .generation
        .live
        .running
        .as_ref()
        .expect("asked for")
        .key
        .params
        .clone();
    assert_eq!((params.seed, params.region), (seed + 1, RegionMode::Full));
    finish(&mut bench);
    assert_eq!(bench.history(), ["Open", "Generate"]);
    assert_eq!(seed_of(&mut bench), Some(seed + 1));
}

#[test]
fn a_part_is_accepted_by_region_or_class() {
    let (mut bench, before) = generated();
    bench.click("Accept a part");
    bench.click("Mark a region…");
    bench.click("Lasso");
    let around = [[4.0, 12.0], [12.0, 12.0], [12.0, 20.0], [4.0, 20.0]];
    let way = around.map(|[x, y]| bench.bev(x, y));
    bench.drag(&way, Modifiers::NONE);
    let cells = bench.app().state.tools.region.count();
    assert!((16..=49).contains(&cells), "{cells}");
    bench.click("Accept a part");
    bench.click("In the marked region");
    assert_eq!(bench.history(), ["Open", "Accept a part"]);
    let [x, y] = Window::column_at(8.0, 16.0).expect("inside");
    let frame = bench.frame();
    assert_eq!(frame.occupancy.column(x, y)[0], Class::Vegetation.id());
    let changed = (0..Window::COLUMNS)
        .filter(|c| {
            let (x, y) = (c / Window::NY, c % Window::NY);
            frame.occupancy.column(x, y) != before.column(x, y)
        })
        .count();
    assert!(
        changed <= cells * 16 && changed > 100,
        "{changed} of {cells} cells"
    );
    assert!(bench.app().staged().is_none());

    let (mut bench, before) = generated();
    bench.click("Accept a part");
    let n = before.count_different(&bench.frame().occupancy);
    let entry = {
        let all = bench.harness.query_all_by_label_contains("Only car,");
        all.count()
    };
    assert_eq!(entry, 1, "of {n} voxels");
    bench.harness.get_by_label_contains("Only car,").click();
    bench.steps(3);
    let frame = bench.frame();
    let cars = |g: &VoxelGrid| {
        let columns = (0..Window::COLUMNS).map(|c| *g.window_column(c / Window::NY, c % Window::NY));
        columns.flatten().filter(|l| *l == Class::Car.id()).count()
    };
    assert!(cars(&before) > 0 && cars(&frame.occupancy) == 0);
    assert_eq!(before.count_different(&frame.occupancy), cars(&before));
}

#[test]
fn a_generation_is_stopped_with_what_it_shows() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame().occupancy.clone();
    bench.click("Generate everything");
    assert_eq!(bench.started.recv_timeout(PATIENCE), Ok(RegionMode::Full));
    assert!(bench.harness.query_by_label("Keep this").is_none());
    bench.orders.send(Do::Show).expect("the pipeline listens");
    bench.wait_until("what comes", |b| b.harness.query_by_label("Keep this").is_some());
    bench.click("Keep this");
    bench.wait_until("the end", |b| b.app().generation.live.running.is_none());
    assert_eq!(bench.history(), ["Open", "Generate"]);
    assert!(bench.frame().occupancy == VoxelGrid::new());
    bench.click("Decline");
    assert!(bench.frame().occupancy == before);
}

#[test]
fn scenery_is_regenerated_by_rules_everywhere_or_in_a_region() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame().occupancy.clone();
    bench.app().state.tools.drawer = SceneryMethod::Rules(Some(RoadsideKind::OldTown));
    let ctx = bench.harness.ctx.clone();
    bench
        .app()
        .execute(Command::Generation(GenerationCommand::DrawScenery), &ctx);
    bench.steps(3);
    bench.steps(3);
    assert_eq!(bench.history(), ["Open", "Draw scenery"]);
    let things = |b: &mut Bench| b.app().document.scene().background.clone();
    let first = things(&mut bench);
    assert!(first.len() > 10, "{}", first.len());
    let seed = seed_of(&mut bench).expect("staged");
    bench.click("Next seed");
    assert_eq!(seed_of(&mut bench), Some(seed + 1));
    assert_eq!(bench.history(), ["Open", "Draw scenery"]);
    let second = things(&mut bench);
    assert_ne!(first, second);
    // So does drawing again while it waits.
    bench
        .app()
        .execute(Command::Generation(GenerationCommand::DrawScenery), &ctx);
    bench.steps(3);
    assert_eq!(bench.history(), ["Open", "Draw scenery"]);
    assert_ne!(things(&mut bench), second);
    let second = things(&mut bench);
    // Only what lies in a region is taken.
    bench.app().state.tools.region =
        InpaintMask::of_rect(scene::Extent::WINDOW, [0.0, -40.0].into(), [40.0, 40.0].into());
    bench.steps(2);
    bench.click("Accept a part");
    bench.click("In the marked region");
    assert!(bench.app().staged().is_none());
    let part = things(&mut bench);
    assert!(part.len() > 2 && part.len() < second.len(), "{}", part.len());
    let frame = bench.frame();
    let behind = (0..99).flat_map(|x| (0..Window::NY).map(move |y| (x, y)));
    for (x, y) in behind {
        let columns = [&frame.occupancy, &before].map(|g| *g.window_column(x, y));
        assert_eq!(columns[0], columns[1], "({x}, {y})");
    }
    bench.key(Modifiers::COMMAND, egui::Key::Z);
    assert!(bench.frame().occupancy == before);
}

#[test]
fn a_network_draws_scenery_while_the_window_goes_on() {
    let mut bench = Bench::new();
    bench.off();
    bench.app().state.tools.drawer = SceneryMethod::Network;
    let ctx = bench.harness.ctx.clone();
    bench
        .app()
        .execute(Command::Generation(GenerationCommand::DrawScenery), &ctx);
    assert_eq!(bench.history(), ["Open"]);
    bench.wait_until("the scenery", |b| b.app().staged().is_some());
    assert_eq!(bench.history(), ["Open", "Draw scenery"]);
    assert!(!bench.app().document.scene().background.is_empty());
    bench.steps(3);
    bench.click("Decline");
    assert!(bench.app().document.scene().background.is_empty());
    // Who edits meanwhile keeps the edit, and is told.
    bench
        .app()
        .execute(Command::Generation(GenerationCommand::DrawScenery), &ctx);
    let id = *bench.frame().boxes.keys().next().expect("a box");
    let edits = vec![Edit::RemoveBox { id }];
    bench.app().execute(Command::Apply("Delete", edits), &ctx);
    let told = "The scene changed meanwhile: no scenery was drawn";
    bench.wait_until("the end", |b| b.harness.query_by_label(told).is_some());
    assert_eq!(bench.history(), ["Open", "Delete"]);
}

#[test]
fn scenery_drawn_for_a_generation_that_is_cancelled_goes_with_it() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame().occupancy.clone();
    bench.click("Generate everything");
    assert_eq!(bench.started.recv_timeout(PATIENCE), Ok(RegionMode::Full));
    // Something to look at before the first step of the networks.
    assert!(bench.frame().occupancy != before);
    assert!(!bench.app().document.scene().background.is_empty());
    bench.key(Modifiers::CTRL, egui::Key::Backspace);
    bench.wait_until("the end", |b| b.app().generation.live.running.is_none());
    assert!(bench.frame().occupancy == before);
    assert!(bench.app().document.scene().background.is_empty());
}

#[test]
fn the_seed_that_made_a_result_is_kept_with_it_and_used_again() {
    let mut bench = Bench::new();
    bench.off();
    bench.app().state.seed.value = Some(77);
    bench.app().state.named.vegetation = Some(0.5);
    bench.click("Generate everything");
    finish(&mut bench);
    assert_eq!(seed_of(&mut bench), Some(77));
    bench.click("Next seed");
    finish(&mut bench);
    assert_eq!(bench.app().state.seed.value, Some(78), "the field shows it");
    bench.click("Accept");
    let rev = bench.app().document.settled_scene().content();
    let made = bench.app().generation.versions.made(rev).cloned().expect("known");
    assert_eq!((made.params.seed, made.params.named.vegetation), (78, Some(0.5)));
    // It comes back with the file.
    let path = bench.open_path();
    bench.key(Modifiers::CTRL, egui::Key::S);
    bench.give_path(&path, "Save file");
    let ctx = bench.harness.ctx.clone();
    let open = app::command::FileCommand::OpenPath(path);
    bench.app().execute(Command::File(open), &ctx);
    bench.wait_until("the scene", |b| b.app().state.seed.value.is_none());
    assert_eq!(bench.app().state.seed.value, None, "the scene's own");
    let list = bench.app().generation.versions.list();
    let found = list
        .iter()
        .find(|v| v.made.as_ref().is_some_and(|m| m.params.seed == 78));
    let rev = found.expect("it is kept").scene.content();
    bench
        .app()
        .execute(Command::Generation(GenerationCommand::UseAgain(rev)), &ctx);
    assert_eq!(bench.app().state.seed.value, Some(78));
    assert_eq!(bench.app().state.named.vegetation, Some(0.5));
}

#[test]
fn another_seed_each_time_is_drawn_and_recorded() {
    let mut bench = Bench::new();
    bench.off();
    bench.app().state.seed.another = true;
    let mut seeds = std::collections::BTreeSet::new();
    for _ in 0..2 {
        bench.click("Generate everything");
        finish(&mut bench);
        let rev = bench.app().document.settled_scene().content();
        let seed = bench
            .app()
            .generation
            .versions
            .made(rev)
            .expect("known")
            .params
            .seed;
        seeds.insert(seed);
        assert_eq!(bench.app().state.seed.value, Some(seed));
        // Accepted, the next one would be no other: this pipeline makes one result.
        bench.click("Decline");
    }
    assert_eq!(seeds.len(), 2);
    // A seed that is typed or drawn by hand is used as it is.
    bench.app().state.seed.another = false;
    bench.click("Draw a seed");
    let drawn = bench.app().state.seed.value;
    bench.click("Generate everything");
    finish(&mut bench);
    assert_eq!(seed_of(&mut bench), drawn);
    // Edits keep the seed of the scene.
    let scene = bench.app().document.settled_scene().clone();
    let params = bench.app().generation.live.params_for(&scene, false);
    assert_eq!(params.seed, scene.seed);
}

/// One undo is one step: while something is generated it ends that, and takes the edit before back only when it is asked again.
#[test]
fn undo_while_generating_takes_nothing_else_back() {
    for scenery_first in [true, false] {
        let mut bench = Bench::new();
        bench.off();
        bench.app().state.tools.things.locked = !scenery_first;
        let opened = bench.app().document.settled_scene().content();
        bench.key(Modifiers::NONE, egui::Key::J);
        bench.key(Modifiers::NONE, egui::Key::Delete);
        let edited = bench.app().document.settled_scene().content();
        bench.click("Generate everything");
        let started = bench.started.recv_timeout(PATIENCE);
        assert_eq!(started, Ok(RegionMode::Full));
        assert_eq!(bench.app().undo_step(), Some("Generate"));
        bench.key(Modifiers::COMMAND, egui::Key::Z);
        bench.wait_until("the end", |b| b.app().generation.live.running.is_none());
        bench.steps(3);
        let now = bench.app().document.settled_scene().content();
        assert_eq!(now, edited, "scenery first: {scenery_first}");
        assert_eq!(bench.app().undo_step(), Some("Delete box"));
        bench.key(Modifiers::COMMAND, egui::Key::Z);
        assert_eq!(bench.app().document.settled_scene().content(), opened);
    }
}
