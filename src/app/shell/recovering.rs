//! Recovery in the window: keeps copies of unsaved work, and offers copies from sessions that died.

use std::time::Duration;

use super::app::SceneloomApp;
use super::recovery::Recovery;
use super::toasts::MessageLevel;
use crate::windows::recovery::{RecoveryChoice, recovery_ui};
use language::tf;
use scene::Scene;

impl SceneloomApp {
    /// Starts to keep copies of unsaved work. Without a writable folder it reports that and goes on.
    pub(crate) fn keep_copies(&mut self, ctx: &egui::Context) {
        let wake = ctx.clone();
        match Recovery::at_start(move || wake.request_repaint()) {
            Ok(recovery) => self.files.recovery = Some(recovery),
            Err(error) => {
                let now_s = self.now_s();
                let text = tf!("No recovery copies of unsaved work: {error}", error = error);
                self.toasts.push(MessageLevel::Error, text, now_s);
            }
        }
    }

    pub(crate) fn update_recovery(&mut self, ctx: &egui::Context) {
        let now_s = self.now_s();
        if self.generation.versions.changed {
            self.document.mark_unsaved();
        }
        let Some(mut recovery) = self.files.recovery.take() else {
            return;
        };
        let with_kept = |scene: &Scene| self.with_kept(scene);
        let path = self.files.path.as_deref();
        let (wait_s, problem) = recovery.tick(&self.document, path, with_kept, now_s);
        self.files.recovery = Some(recovery);
        if let Some(seconds) = wait_s {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds));
        }
        if let Some(problem) = problem {
            let text = tf!("No recovery copy can be written: {problem}", problem = problem);
            self.toasts.push(MessageLevel::Error, text, now_s);
        }
    }

    /// True while an offer of a session that died has no answer.
    pub(crate) fn asks_to_recover(&self) -> bool {
        self.files.recovery.as_ref().is_some_and(|r| !r.offers.is_empty())
    }

    /// Asks about the newest offer, if there is one.
    pub(crate) fn recovery_dialog(&mut self, ui: &egui::Ui) {
        if self.files.opening.is_some() || self.files.arrived.is_some() {
            return;
        }
        let Some(recovery) = &mut self.files.recovery else {
            return;
        };
        let Some(offer) = recovery.offers.first() else {
            return;
        };
        let Some(answer) = recovery_ui(ui, offer, recovery.offers.len() - 1) else {
            return;
        };
        match answer {
            RecoveryChoice::Later => recovery.offers.clear(),
            RecoveryChoice::Discard => recovery.offers.remove(0).discard(),
            RecoveryChoice::Recover => {
                let offer = recovery.offers.remove(0);
                let (file, original) = (offer.file(), offer.original.clone());
                let what = tf!("Recovering {name}", name = offer.name);
                recovery.opening = Some(offer);
                self.state.windows.start = false;
                let open = self.files.disk.open.clone();
                self.load(what, original, false, ui.ctx(), move || open(&file));
                if let Some(opening) = &mut self.files.opening {
                    opening.recovers = true;
                }
            }
        }
    }

    /// Notes that a scene was read, or could not be. A recovered scene is marked unsaved, and its copy is kept until
    /// there is another.
    pub(crate) fn note_opened(&mut self, recovers: bool, is_open: bool) {
        let Some(recovery) = &mut self.files.recovery else {
            return;
        };
        if let Some(recovered) = recovery.opening.take_if(|_| recovers)
            && is_open
        {
            self.document.mark_unsaved();
            recovery.replaced.push(recovered);
        }
    }
}
