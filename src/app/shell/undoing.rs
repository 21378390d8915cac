//! Undo while a requested operation runs: undo cancels that operation, and changes no other step.

use super::app::SceneloomApp;
use super::toasts::MessageLevel;
use language::t;

impl SceneloomApp {
    /// Undoes one step. If a requested operation runs that would become its own step, it is cancelled instead.
    pub(crate) fn undo(&mut self) {
        if self.document.is_dragging() || self.asked_for().is_none() {
            self.document.undo();
            return;
        }
        let now_s = self.now_s();
        let made = self.files.opening.take_if(|opening| opening.step.is_some());
        if made.is_none() && self.generation.drawing.take().is_none() {
            // Scenery that was drawn for the generation belongs to the same step.
            self.take_scenery_back();
            self.generation.cancel();
        }
        self.toasts
            .push(MessageLevel::Info, t("Generation cancelled"), now_s);
    }

    /// Label of the step that undo reverts, in English.
    pub fn undo_step(&self) -> Option<&str> {
        self.asked_for().or_else(|| self.document.undo_label())
    }

    /// Label of the step that the running operation will become, if it was requested in the state shown.
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
