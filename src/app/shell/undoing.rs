//! Undo while something runs that was asked for: it is the step that is taken back, and nothing else.

use super::app::SceneloomApp;
use super::toasts::Level;
use language::t;

impl SceneloomApp {
    /// One step back. What was asked for last, still runs and would become a step of its own is that step: it ends.
    pub(crate) fn undo(&mut self) {
        if self.document.is_dragging() || self.asked_for().is_none() {
            self.document.undo();
            return;
        }
        let now_s = self.now_s();
        let made = self.files.opening.take_if(|opening| opening.step.is_some());
        if made.is_none() && self.generation.drawing.take().is_none() {
            // Scenery that was drawn for it is of the same step.
            self.take_scenery_back();
            self.generation.cancel();
        }
        self.toasts.push(Level::Info, t("Generation cancelled"), now_s);
    }

    /// What undo takes back, in English.
    pub fn undo_step(&self) -> Option<&str> {
        self.asked_for().or_else(|| self.document.undo_label())
    }

    /// The step that will come of what runs, if it was asked for in the state that is shown.
    fn asked_for(&self) -> Option<&'static str> {
        let shown = self.document.settled_scene().content();
        if let Some(step) = self.files.opening.as_ref().and_then(|opening| opening.step) {
            return Some(step);
        }
        let drawing = self.generation.drawing.as_ref();
        if drawing.is_some_and(|drawing| drawing.is_of(shown)) {
            return Some("Draw scenery");
        }
        let running = self.generation.live.running.as_ref();
        let running = running.filter(|r| r.key.rev == shown && !r.cancelled);
        running.and_then(|r| r.own_step())
    }
}
