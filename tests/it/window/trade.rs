//! The quality slider, the receipt, what was computed, as the window shows them.

use app::shell::tuning::TimesOf;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use scene::BoxId;
use trade::PresetKnobs;

use super::bench::{Bench, Do};

#[test]
fn a_preset_changes_the_next_edit_and_the_receipt_tells_what_the_last_one_cost() {
    let mut bench = Bench::new();
    bench.click("Trade");
    bench.steps(3);
    assert!(
        bench
            .harness
            .query_by_label("Edit something: what it cost is written here.")
            .is_some()
    );
    // Nothing was timed here yet, and every prediction says so.
    assert_ne!(bench.app().generation.tuning.times_of(), TimesOf::ThisMachine);
    let told = |b: &mut Bench| b.app().generation.tuning.predicted();
    assert!(
        told(&mut bench)
            .iter()
            .all(|(_, line)| line.contains("on another machine"))
    );
    let presets = bench.app().generation.tuning.presets.all.clone();
    let draft = presets.iter().position(|s| s.name == "draft").expect("shipped");
    let params = bench.app().generation.live.params.clone();
    let now = bench
        .app()
        .generation
        .tuning
        .current(&params)
        .map_or("own settings".to_owned(), |i| presets[i].name.clone());
    bench.click(&format!("Quality: {now} menu"));
    bench.steps(2);
    let predicted = bench.app().generation.tuning.predicted()[draft].1.clone();
    bench.click(&format!("Draft   {predicted}"));
    bench.steps(2);
    let params = bench.app().generation.live.params.clone();
    assert_eq!(PresetKnobs::from_params(&params), presets[draft].knobs);
    assert_eq!(bench.app().generation.tuning.current(&params), Some(draft));
    assert!(bench.harness.query_by_label("Quality: draft").is_some());

    bench.app().state.selected = Some(BoxId(7));
    bench.key(Modifiers::NONE, Key::Delete);
    bench.wait_until("generation", |b| b.app().generation.live.running.is_some());
    bench.orders.send(Do::Finish).expect("the worker listens");
    bench.wait_until("receipt", |b| b.app().generation.tuning.last.is_some());
    bench.steps(3);
    let last = bench.app().generation.tuning.last.as_ref().expect("noted");
    assert!(last.predicted_s.is_some() && last.predicted_error.is_some() && last.measured_error.is_none());
    assert!(last.region.column_count() > 0 && !last.tokens.is_empty() && !last.bricks.is_empty());
    assert_ne!(
        last.predicted_of,
        TimesOf::ThisMachine,
        "what was predicted before it"
    );
    let (shares, bricks) = (last.tokens.len(), last.bricks.len());
    assert!(
        shares < 100 && bricks < 12,
        "{shares} tokens, {bricks} bricks for one car"
    );
    assert_eq!(bench.app().generation.tuning.stability.untouched_changed, 0);
    assert_eq!(bench.app().generation.tuning.stability.runs, 1);
    assert_eq!(bench.app().generation.tuning.times_of(), TimesOf::ThisMachine);
    assert!(
        !told(&mut bench)
            .iter()
            .any(|(_, line)| line.contains("another machine"))
    );
    assert!(
        bench
            .harness
            .query_by_label_contains("on another machine; on screen")
            .is_some()
    );
    assert!(bench.harness.query_by_label("Refine").is_some());
    bench.click("Show what was computed");
    assert!(bench.app().generation.tuning.show_modelled);
    bench.steps(2);
}
