//! Finished parts of a whole map whose generation was stopped: the next generation of the same map goes on from there.

use std::sync::Arc;

use crate::contract::{GenParams, GenResult, Job, RegionMode};
use scene::Scene;

/// The finished parts of a job, in their order.
#[derive(Clone, Default)]
pub(super) struct Unfinished {
    of: Option<(Arc<Scene>, GenParams)>,
    made: Vec<GenResult>,
}

impl Unfinished {
    /// Starts or resumes a job, and forgets the parts of another job. `None` for an edit: it is short, and the parts of
    /// a whole map stay.
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

    /// A finished part, by its index in the order of the job's parts.
    pub(super) fn part(&self, i: usize) -> Option<GenResult> {
        self.made.get(i).cloned()
    }

    /// Keeps the next part.
    pub(super) fn keep(&mut self, result: &GenResult) {
        self.made.push(result.clone());
    }

    /// Forgets all parts: the job is done.
    pub(super) fn end(&mut self) {
        *self = Self::default();
    }
}

/// True if a job has equal parameters and an equal scene, whatever its name and revision.
fn is_same((scene, params): &(Arc<Scene>, GenParams), job: &Job) -> bool {
    let (a, b) = (scene, &job.scene);
    let same_content = a.content() == b.content() || a.frame() == b.frame() && a.background == b.background;
    *params == job.params && same_content
}
