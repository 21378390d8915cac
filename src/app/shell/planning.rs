//! Plans repairs of findings on a thread of its own, which starts with the first plan.

use std::ops::ControlFlow;
use std::sync::Arc;

use editor::Edit;
use editor::checks::{self, Finding};
use editor::fix::{RepairPlan, RepairProgress, plan_all, plan_these};
use runtime::guard::Panicked;
use runtime::worker::JobId;
use runtime::worker::{Ctx, Event, Product, Wake, Worker};
use scene::Scene;

/// Function that turns edits into the edits to apply, for example into corrections.
pub(crate) type Meaning = Box<dyn Fn(Vec<Edit>) -> Vec<Edit> + Send>;

/// A request for a plan.
pub(crate) struct RepairRequest {
    pub(crate) scene: Arc<Scene>,
    pub(crate) findings: Vec<Finding>,
    /// True if the findings are of an earlier state; the checks run first to see which remain.
    pub(crate) again: bool,
    /// True if findings that remain after the repairs are repaired too.
    pub(crate) all: bool,
    pub(crate) meaning: Meaning,
}

enum PlanningEvent {
    Tried(RepairProgress),
    Planned(Box<RepairPlan>),
    GivenUp,
    Failed(Panicked),
}

struct Planner;

impl Product for Planner {
    type Request = RepairRequest;
    type Update = PlanningEvent;

    fn make(&mut self, request: &RepairRequest, ctx: &Ctx<'_, PlanningEvent>) -> PlanningEvent {
        let mut watch = |progress: RepairProgress| {
            ctx.tell(PlanningEvent::Tried(progress));
            match ctx.should_stop() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let plan = match request.all {
            true => plan_all,
            false => plan_these,
        };
        let still = |f: &Finding| {
            let of = |asked: &Finding| (asked.check, asked.box_id) == (f.check, f.box_id);
            request.all || request.findings.iter().any(of)
        };
        let findings = match request.again {
            true => checks::run_checks(&request.scene, None)
                .into_iter()
                .filter(still)
                .collect(),
            false => request.findings.clone(),
        };
        PlanningEvent::Planned(Box::new(plan(
            &request.scene,
            &findings,
            &*request.meaning,
            &mut watch,
        )))
    }

    fn reset(&mut self) {}

    fn given_up() -> PlanningEvent {
        PlanningEvent::GivenUp
    }

    fn panicked(panic: Panicked) -> PlanningEvent {
        PlanningEvent::Failed(panic)
    }

    fn is_terminal(news: &PlanningEvent) -> bool {
        !matches!(news, PlanningEvent::Tried(_))
    }
}

/// Content of the window of repairs.
#[derive(Clone, Debug)]
pub enum RepairPlanState {
    /// A plan is being made; with its progress, once that is known.
    Planning(Option<RepairProgress>),
    /// The finished plan.
    Planned(Arc<RepairPlan>),
}

/// The plan that is being made or shown, and the thread that makes plans.
#[derive(Default)]
pub struct Planning {
    worker: Option<Worker<RepairRequest, PlanningEvent>>,
    job: Option<JobId>,
    shown: Option<RepairPlanState>,
    /// Findings of the last request and its `all` flag, to plan again.
    pub(crate) about: Option<(Vec<Finding>, bool)>,
}

impl Planning {
    /// Starts a plan that replaces the one before. Errors if the system gives no thread.
    pub(crate) fn begin(&mut self, request: RepairRequest, wake: Wake) -> std::io::Result<()> {
        let worker = match &mut self.worker {
            Some(worker) => worker,
            none => none.insert(Worker::start("repairs", || Planner, wake)?),
        };
        self.about = Some((request.findings.clone(), request.all));
        self.job = Some(worker.submit(request));
        self.shown = Some(RepairPlanState::Planning(None));
        Ok(())
    }

    /// Takes in the news of the thread. Returns a failure, if there was one.
    pub(crate) fn update(&mut self) -> Option<Panicked> {
        let news: Vec<_> = self.worker.as_ref()?.updates().try_iter().collect();
        let mut problem = None;
        for Event { id, update } in news {
            if self.job != Some(id) {
                continue;
            }
            match update {
                PlanningEvent::Tried(progress) => {
                    self.shown = Some(RepairPlanState::Planning(Some(progress)))
                }
                PlanningEvent::Planned(plan) => self.shown = Some(RepairPlanState::Planned(Arc::new(*plan))),
                PlanningEvent::GivenUp => self.close(),
                PlanningEvent::Failed(panic) => {
                    self.close();
                    problem = Some(panic);
                }
            }
        }
        problem
    }

    /// Content of the window; `None` if no repairs were requested.
    pub fn shown(&self) -> Option<&RepairPlanState> {
        self.shown.as_ref()
    }

    /// Ends the planning; repairs planned so far are shown.
    pub(crate) fn stop(&self) {
        if let Some(worker) = &self.worker {
            worker.cancel();
        }
    }

    /// Forgets the plan, and the one that is being made.
    pub(crate) fn close(&mut self) {
        self.stop();
        (self.job, self.shown, self.about) = (None, None, None);
    }
}
