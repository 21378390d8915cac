//! The remembered scene that memory uses: a small map of it, its description, and its similarity to the words.

use std::sync::mpsc::{Receiver, channel};

use egui::{Sense, Ui, vec2};

use crate::memory::layout_of;
use crate::prompting::{Ask, Remembered, recall};
use language::{t, tf};
use runtime::guard::Panicked;
use scene::{BevLayout, SceneBox};
use widgets::theme;
use widgets::thumbnail;

/// Side of the map, points.
const SIDE: f32 = 84.0;

/// A remembered scene, ready to be shown.
#[derive(Clone, Debug)]
pub struct Recalled {
    text: String,
    similarity: f64,
    layout: BevLayout,
    boxes: Vec<SceneBox>,
}

impl Recalled {
    /// The nearest of the remembered scenes; `None` if its road cannot be read.
    pub fn from_retrieval(found: &Remembered) -> Option<Self> {
        let entry = found.nearest.as_ref()?;
        Some(Self {
            text: entry.text.clone(),
            similarity: found.scenes.first().map_or(0.0, |s| s.1),
            layout: layout_of(&entry.road).ok()?,
            boxes: entry.boxes().into_values().collect(),
        })
    }

    /// Draws the scene; hovering enlarges it.
    pub fn show(&self, ui: &mut Ui, title: &str) {
        ui.horizontal(|ui| {
            let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::hover());
            ui.painter().rect_filled(rect, theme::RADIUS, theme::well());
            thumbnail::scene(ui, rect, &self.layout, &self.boxes);
            let name = tf!("Remembered scene: {text}", text = self.text);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Image, true, &name));
            thumbnail::enlarged(&response, &self.layout, &self.boxes, &self.text);
            ui.vertical(|ui| {
                ui.spacing_mut().item_spacing.y = 2.0;
                let small = |text: &str, color| egui::RichText::new(text).small().color(color);
                ui.label(small(title, theme::text_weak()));
                let shown = egui::Label::new(small(&shortened(&self.text), theme::text())).wrap();
                ui.add(shown).on_hover_text(&self.text);
                let near = tf!("similarity {value}", value = format!("{:.2}", self.similarity));
                ui.label(small(&near, theme::text_weak()))
                    .on_hover_text(t("Cosine of what the two texts mean: 1 is the same"));
            });
        });
    }
}

/// A description cut to the length that fits beside the map.
fn shortened(text: &str) -> String {
    const MOST: usize = 72;
    if text.chars().count() <= MOST {
        return text.to_owned();
    }
    let cut: String = text.chars().take(MOST).collect();
    let whole = cut.rsplit_once(' ').map_or(cut.as_str(), |(words, _)| words);
    format!("{whole}…")
}

/// Words with the remembered scene for them, or why none could be looked up.
type RecallResult = (String, Result<Option<Recalled>, Panicked>);

/// Looks up the remembered scene for the words that are being typed, on a thread of its own.
#[derive(Default)]
pub struct Recall {
    shown: Option<RecallResult>,
    coming: Option<Receiver<RecallResult>>,
}

impl Recall {
    fn look_up(&mut self, ask: &Ask, ctx: &egui::Context) {
        let (send, coming) = channel();
        let (ask, wake) = (ask.clone(), ctx.clone());
        let words = ask.prompt.clone();
        let recall = move || {
            let found = recall(&ask.prompt, &ask.description, ask.seed);
            found.as_ref().and_then(Recalled::from_retrieval)
        };
        let thread = runtime::guard::spawn("recall", recall, move |found| {
            // The receiver is gone once the pane is closed.
            let _ = send.send((words, found));
            wake.request_repaint();
        });
        self.coming = thread.ok().map(|_| coming);
    }

    /// Draws the scene for these words; until it is found, the one before.
    pub fn show(&mut self, ui: &mut Ui, ask: &Ask) {
        if let Some(found) = self.coming.as_ref().and_then(|c| c.try_recv().ok()) {
            (self.shown, self.coming) = (Some(found), None);
        }
        let known = self.shown.as_ref().is_some_and(|(of, _)| *of == ask.prompt);
        if !known && self.coming.is_none() {
            self.look_up(ask, ui.ctx());
        }
        match &self.shown {
            Some((_, Ok(Some(found)))) => found.show(ui, t("Memory goes by")),
            Some((_, Err(panic))) => {
                let text = tf!("Memory could not be looked into: {problem}", problem = panic);
                ui.label(egui::RichText::new(text).small().color(theme::warn()));
            }
            Some((_, Ok(None))) => {
                ui.label(egui::RichText::new(t("Memory knows no scene like it")).small());
            }
            None => {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label(egui::RichText::new(t("Looking into memory…")).small());
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use words::describe::described;

    #[test]
    fn words_recall_a_scene_with_its_road_and_objects() {
        let words = "a busy junction downtown at night";
        let found = recall(
            words,
            &described("road intersection ; env downtown ; density busy ; time night").expect("valid"),
            1,
        )
        .expect("the bank that ships");
        let shown = Recalled::from_retrieval(&found).expect("a road that can be made again");
        assert!((0.0..=1.0).contains(&shown.similarity) && shown.text == found.scenes[0].0);
        assert!(!shown.layout.polylines.is_empty() && !shown.boxes.is_empty());
        let long = shortened(&"words ".repeat(40));
        assert!(long.chars().count() <= 73 && long.ends_with("words…"));
    }

    #[test]
    fn a_panic_is_told_and_the_next_words_are_looked_up() {
        let words = "a quiet road";
        let ask = Ask {
            prompt: words.into(),
            description: described("road straight").expect("valid"),
            graphed: None,
            seed: 1,
            how: crate::prompting::How::default(),
        };
        let mut recall = Recall::default();
        let mut found = || {
            recall.look_up(&ask, &egui::Context::default());
            let coming = recall.coming.take().expect("a thread");
            let (of, found) = coming.recv().expect("an answer");
            assert_eq!(of, words);
            found.map(|f| f.is_some()).map_err(|e| e.to_string())
        };
        runtime::guard::panic_next("recall");
        assert_eq!(found(), Err("recall panicked: asked for by a test".into()));
        assert_eq!(found(), Ok(true));
        let mut plan = super::super::plan::PromptPlan::default();
        runtime::guard::panic_next("variants");
        let first = plan.first_variant(&ask);
        assert_eq!(first, Err("variants panicked: asked for by a test".into()));
        assert_eq!(plan.first_variant(&ask), Ok(ask.seed));
    }
}
