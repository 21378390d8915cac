//! Findings in the window: requests checks, plans and applies repairs, and goes to places of findings.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::app::SceneloomApp;
use super::planning::{RepairPlanState, RepairRequest};
use crate::command::RepairCommand;
use editor::checks::Finding;
use language::tf;
use scene::{BoxId, BoxLabel, Class, SceneBox};

impl SceneloomApp {
    /// Requests a check of the settled scene when it is time.
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
        if let Some(problem) = self.threads.planning.update() {
            self.fail(tf!("No repairs can be planned: {error}", error = problem));
        }
    }

    /// Carries out a command about repairs.
    pub(crate) fn repair(&mut self, command: RepairCommand, ctx: &egui::Context) {
        match command {
            RepairCommand::PlanAll => {
                let rev = self.document.settled_scene().rev;
                let current = !self.threads.checking.is_stale(rev);
                if let Some(findings) = self.threads.checking.findings().filter(|_| current) {
                    self.plan_repairs(findings.to_vec(), [true, false], ctx);
                }
            }
            RepairCommand::PlanThese(findings) => self.plan_repairs(findings, [false; 2], ctx),
            RepairCommand::Again => {
                if let Some((findings, all)) = self.threads.planning.about.take() {
                    self.plan_repairs(findings, [all, true], ctx);
                }
            }
            RepairCommand::Stop => self.threads.planning.stop(),
            RepairCommand::Apply => self.do_repairs(),
            RepairCommand::Close => self.threads.planning.close(),
        }
    }

    fn plan_repairs(&mut self, findings: Vec<Finding>, [all, again]: [bool; 2], ctx: &egui::Context) {
        let wake = ctx.clone();
        let request = RepairRequest {
            scene: self.document.settled_scene().clone(),
            findings,
            again,
            all,
            meaning: Box::new(self.meaning()),
        };
        let begun = self
            .threads
            .planning
            .begin(request, Arc::new(move || wake.request_repaint()));
        if let Err(error) = begun {
            self.fail(tf!("No repairs can be planned: {error}", error = error));
        }
    }

    /// Applies the listed repairs, if they were planned for the present state.
    fn do_repairs(&mut self) {
        let now = self.document.settled_scene().rev;
        let Some(RepairPlanState::Planned(plan)) = self.threads.planning.shown() else {
            return;
        };
        let plan = plan.clone();
        if plan.of != now || self.document.is_dragging() {
            return;
        }
        self.threads.planning.close();
        if let Err(error) = self.document.apply_all("Repair findings", &plan.edits()) {
            self.fail(error.to_string());
        }
        self.note_correction();
    }

    /// Centres a place in both large views.
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
