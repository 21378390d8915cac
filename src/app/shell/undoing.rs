//! Undo while a requested operation runs: undo cancels that operation, and changes no other step.

use super::app::SceneloomApp;
use super::toasts::MessageLevel;
use editor::{LeftOut, Undone};
use language::{t, tf};

impl SceneloomApp {
    /// Undoes one step. If a requested operation runs that would become its own step, it is cancelled instead.
    pub(crate) fn undo(&mut self) {
        if self.document.is_dragging() || self.asked_for().is_none() {
            if let Some(Undone::LeftOut(left)) = self.document.undo_own() {
                self.tell_left_out(&left);
            }
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

    /// Leaves a step out of the history; the later ones are applied again.
    pub(crate) fn leave_out(&mut self, index: usize) {
        match self.document.leave_out(index) {
            Ok(left) => self.tell_left_out(&left),
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Replays the history from its origin and says whether that gives the scene shown.
    pub(crate) fn replay_history(&mut self) {
        let steps = self.document.position();
        match self.document.replays() {
            Ok(true) => {
                let text = tf!(
                    "{n} steps replayed from the origin: the same scene, bit for bit",
                    n = steps
                );
                let now_s = self.now_s();
                self.toasts.push(MessageLevel::Info, text, now_s);
            }
            Ok(false) => self.fail(t("Replaying the history gives another scene").into()),
            Err(error) => self.fail(tf!("The history cannot be replayed: {error}", error = error)),
        }
    }

    /// Says which later steps could not follow when a step was left out.
    fn tell_left_out(&mut self, left: &LeftOut) {
        let step = t(&left.label);
        let mut text = match left.changed {
            true => tf!("Left out: {step}. Later steps stay", step = step),
            false => tf!("Left out: {step}. Later steps replace all it did", step = step),
        };
        let now_s = self.now_s();
        for skipped in &left.skipped {
            let text = tf!("Not applied without it: {skipped}", skipped = skipped);
            self.toasts.log(text, now_s);
        }
        if !left.skipped.is_empty() {
            let n = left.skipped.len();
            text = tf!(
                "Left out: {step}. {n} later steps do not apply without it: see the log",
                step = step,
                n = n
            );
        }
        self.toasts.push(MessageLevel::Info, text, now_s);
    }

    /// Label of the step that undo reverts, in English.
    pub fn undo_step(&self) -> Option<&str> {
        self.asked_for().or_else(|| self.document.undo_own_label())
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
