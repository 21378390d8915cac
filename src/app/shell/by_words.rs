//! Commands of the prompt for the document: edits by a sentence, and scenes made of words.

use egui::Context;

use super::app::SceneloomApp;
use super::toasts::MessageLevel;
use crate::command::step_name;
use crate::prompting::Ask;
use crate::tools::Choose;
use editor::Edit;
use language::{t, tf};
use scene::{BoxId, Frame};
use sensors::cameras::pictures;

/// Most boxes that are chosen after an edit; a larger selection would not help to see the change.
const MOST_CHOSEN: usize = 12;

impl SceneloomApp {
    /// Applies the edits of a sentence as one undo step named after it. Chooses the boxes that were added or changed.
    /// If time or weather changed, the cameras show pictures, because classes and depths do not depend on them.
    pub(crate) fn apply_words(&mut self, words: &str, edits: &[Edit]) {
        let before = self.document.settled_scene().clone();
        let tools = &self.state.tools;
        let (mut edits, left) = match tools.words_within {
            true => tools.within_region(&before, edits.to_vec()),
            false => (edits.to_vec(), 0),
        };
        if left > 0 {
            let text = match left {
                1 => t("1 change lies outside the marked region and was left out").to_owned(),
                n => tf!(
                    "{n} changes lie outside the marked region and were left out",
                    n = n
                ),
            };
            let now_s = self.now_s();
            self.toasts.push(MessageLevel::Info, text, now_s);
        }
        edits.push(Edit::KeepWords {
            words: words.to_owned(),
        });
        self.apply(step_name(words), &edits);
        let after = self.document.settled_scene();
        self.generation.words =
            (after.content() != before.content()).then(|| (after.content(), before.clone()));
        let changed = changed_boxes(before.frame(), after.frame());
        let other_light = before.conditions != after.conditions;
        if !changed.is_empty() && changed.len() <= MOST_CHOSEN {
            self.state.choose(&changed, Choose::Only);
        }
        if other_light && !self.state.cameras.shown_source().about().needs.conditions {
            self.state.cameras.view = pictures::VIEW.id;
            let now_s = self.now_s();
            let text = t("Time and weather changed: the cameras show pictures now").to_owned();
            self.toasts.push(MessageLevel::Info, text, now_s);
        }
    }

    /// Makes a scene of words on a thread of its own; it becomes an undo step.
    pub(crate) fn scene_from_words(&mut self, ask: Ask, ctx: &Context) {
        let told = self.views.prompt.told();
        let make = move || {
            let mut made = crate::text::made(ask.lay_out(), ask.seed);
            told.tell(&made.laid);
            made.scene.words = std::sync::Arc::new(vec![ask.prompt.clone()]);
            made.scene.name = crate::text::title(&ask.prompt).into();
            Ok(made.scene)
        };
        self.load(t(SCENE_FROM_WORDS).into(), None, false, ctx, make);
        if let Some(opening) = &mut self.files.opening {
            opening.step = Some(SCENE_FROM_WORDS);
        }
    }
}

const SCENE_FROM_WORDS: &str = "Scene from words";

/// Boxes of `after` that `before` lacks or has with other values.
fn changed_boxes(before: &Frame, after: &Frame) -> Vec<BoxId> {
    let changed = after
        .boxes
        .iter()
        .filter(|(id, b)| before.boxes.get(id) != Some(b));
    changed.map(|(id, _)| *id).collect()
}
