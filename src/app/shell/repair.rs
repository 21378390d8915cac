//! What the window does about the findings of the checks: asks for them, repairs them, goes there.

use glam::{DVec2, DVec3};

use super::app::SceneloomApp;
use crate::command::Command;
use language::tf;
use scene::{BoxId, BoxLabel, Class, SceneBox};

impl SceneloomApp {
    /// Asks for a check of the settled scene when it is time.
    pub(crate) fn update_checks(&mut self, ctx: &egui::Context) {
        let now_s = self.now_s();
        let scene = self.document.settled_scene();
        if let Some(seconds) = self
            .threads
            .checking
            .update(scene, self.document.is_dragging(), now_s)
        {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(seconds));
        }
        if let Some(problem) = self.threads.checking.take_problem() {
            self.fail(tf!("The scene was not checked: {problem}", problem = problem));
        }
    }

    /// Repairs all that can be repaired, as one undo step.
    pub(crate) fn fix_all(&mut self, ctx: &egui::Context) {
        let scene = self.document.settled_scene();
        let Some(findings) = self
            .threads
            .checking
            .findings()
            .filter(|_| !self.threads.checking.is_stale(scene.rev))
        else {
            return;
        };
        let edits = editor::fix::fix_all(scene, findings);
        if !edits.is_empty() {
            self.execute(Command::Apply("Fix all findings", edits), ctx);
        }
    }

    /// Brings a place into the middle of both large views.
    pub(crate) fn frame_at(&mut self, p_in_ego: DVec3) {
        let around = SceneBox {
            id: BoxId(0),
            class: Class::Car,
            center_m: p_in_ego,
            size_m: DVec3::splat(4.0),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: BoxLabel::default(),
        };
        self.views.frame_box(&around);
    }
}
