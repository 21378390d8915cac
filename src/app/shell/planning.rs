//! Plans repairs of what the checks found, on a thread of its own, which starts when the first plan is asked for.

use std::ops::ControlFlow;
use std::sync::Arc;

use editor::Edit;
use editor::checks::{self, Finding};
use editor::fix::{Plan, Progress, plan_all, plan_these};
use job::JobId;
use job::guard::Panicked;
use job::product::{Ctx, Event, Product, Wake, Worker};
use scene::Scene;

/// How edits are applied in the end, for example as corrections.
pub(crate) type Meaning = Box<dyn Fn(Vec<Edit>) -> Vec<Edit> + Send>;

/// What is to be planned.
pub(crate) struct Request {
    pub(crate) scene: Arc<Scene>,
    pub(crate) findings: Vec<Finding>,
    /// The findings are of an earlier state: what of them is still there is looked up first.
    pub(crate) again: bool,
    /// What the repairs leave is repaired, too.
    pub(crate) all: bool,
    pub(crate) meaning: Meaning,
}

enum News {
    Tried(Progress),
    Planned(Box<Plan>),
    GivenUp,
    Failed(Panicked),
}

struct Planner;

impl Product for Planner {
    type Request = Request;
    type Update = News;

    fn make(&mut self, request: &Request, ctx: &Ctx<'_, News>) -> News {
        let mut watch = |progress: Progress| {
            ctx.tell(News::Tried(progress));
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
        News::Planned(Box::new(plan(
            &request.scene,
            &findings,
            &*request.meaning,
            &mut watch,
        )))
    }

    fn reset(&mut self) {}

    fn given_up() -> News {
        News::GivenUp
    }

    fn panicked(panic: Panicked) -> News {
        News::Failed(panic)
    }

    fn is_terminal(news: &News) -> bool {
        !matches!(news, News::Tried(_))
    }
}

/// What the window of repairs shows.
#[derive(Clone, Debug)]
pub enum Shown {
    /// A plan is made; how far it is, once that is known.
    Planning(Option<Progress>),
    /// It is there.
    Planned(Arc<Plan>),
}

/// The plan that is made or shown, and the thread that makes plans.
#[derive(Default)]
pub struct Planning {
    worker: Option<Worker<Request, News>>,
    job: Option<JobId>,
    shown: Option<Shown>,
    /// What was asked about, to ask again.
    pub(crate) about: Option<(Vec<Finding>, bool)>,
}

impl Planning {
    /// Begins a plan in place of the one before. Errors if the system gives no thread.
    pub(crate) fn begin(&mut self, request: Request, wake: Wake) -> std::io::Result<()> {
        let worker = match &mut self.worker {
            Some(worker) => worker,
            none => none.insert(Worker::start("repairs", || Planner, wake)?),
        };
        self.about = Some((request.findings.clone(), request.all));
        self.job = Some(worker.submit(request));
        self.shown = Some(Shown::Planning(None));
        Ok(())
    }

    /// Takes in what has arrived; what went wrong, if anything did.
    pub(crate) fn update(&mut self) -> Option<Panicked> {
        let news: Vec<_> = self.worker.as_ref()?.updates().try_iter().collect();
        let mut problem = None;
        for Event { id, update } in news {
            if self.job != Some(id) {
                continue;
            }
            match update {
                News::Tried(progress) => self.shown = Some(Shown::Planning(Some(progress))),
                News::Planned(plan) => self.shown = Some(Shown::Planned(Arc::new(*plan))),
                News::GivenUp => self.close(),
                News::Failed(panic) => {
                    self.close();
                    problem = Some(panic);
                }
            }
        }
        problem
    }

    /// What there is to show; none while nobody asked for repairs.
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// Ends the planning: what is planned by then is shown.
    pub(crate) fn stop(&self) {
        if let Some(worker) = &self.worker {
            worker.cancel();
        }
    }

    /// Forgets the plan, and whatever is still on its way.
    pub(crate) fn close(&mut self) {
        self.stop();
        (self.job, self.shown, self.about) = (None, None, None);
    }
}
