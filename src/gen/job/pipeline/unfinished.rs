//! What a generation of a whole map had made when it was stopped: the next one of the same map goes on from there.

use std::sync::Arc;

use crate::contract::{GenParams, GenResult, Job, RegionMode};
use scene::Scene;

/// The parts of a job that are made, in their order.
#[derive(Clone, Default)]
pub(super) struct Unfinished {
    of: Option<(Arc<Scene>, GenParams)>,
    made: Vec<GenResult>,
}

impl Unfinished {
    /// Keeps what is made of this job and forgets what was made of another one. `None` for an edit: it is short, and what
    /// was made of a whole map stays.
    pub(super) fn begin(&mut self, job: &Job) -> Option<&mut Self> {
        if job.params.region != RegionMode::Full {
            return None;
        }
        if !self.of.as_ref().is_some_and(|of| is_same(of, job)) {
            self.of = Some((job.scene.clone(), job.params.clone()));
            self.made.clear();
        }
        Some(self)
    }

    /// A part that was made already, by its place in the order of the job's parts.
    pub(super) fn part(&self, i: usize) -> Option<GenResult> {
        self.made.get(i).cloned()
    }

    /// Keeps the part that follows those made so far.
    pub(super) fn keep(&mut self, result: &GenResult) {
        self.made.push(result.clone());
    }

    /// Forgets everything: the job is done.
    pub(super) fn end(&mut self) {
        *self = Self::default();
    }
}

/// True if a job asks for the same of the same scene, whatever it is called and whatever its revision.
fn is_same((scene, params): &(Arc<Scene>, GenParams), job: &Job) -> bool {
    let (a, b) = (scene, &job.scene);
    let same_content = a.content() == b.content() || a.frame() == b.frame() && a.background == b.background;
    *params == job.params && same_content
}
