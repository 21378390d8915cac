//! The worker, the scheduler that decides when it gets a job, and its results.

use std::sync::Arc;

use job::worker::GenWorker;
use job::{GenParams, GenResult, Job, JobEvent, UpdateGate};
use scene::{Scene, SceneRev};

use super::live::{Bounds, Live, Purpose, RunningJob};
use super::scenery_thread::SceneryJob;
use super::staged::Staged;
use super::status::Receipt;
use super::tuning::Tuning;
use super::versions::Versions;

/// Owner of the worker and its results.
pub struct Generation {
    pub(crate) worker: GenWorker,
    gate: UpdateGate,
    /// The scheduler.
    pub live: Live,
    /// The quality slider.
    pub tuning: Tuning,
    /// Receipt of the last generation.
    pub receipt: Option<Receipt>,
    /// Versions generated so far.
    pub versions: Versions,
    /// A result that came during a drag, and its label if it becomes its own step.
    pub(crate) finished: Option<(Arc<GenResult>, Option<&'static str>)>,
    /// State whose generation is running, and the preview of its result.
    pub(crate) preview: Option<(SceneRev, Arc<Scene>)>,
    /// The state that a sentence made, and the state before it.
    pub(crate) words: Option<(SceneRev, Arc<Scene>)>,
    /// Scenery that was drawn for a generation that still runs, as the state with it and the state before.
    pub(crate) drawn_first: Option<(SceneRev, Arc<Scene>)>,
    pub(crate) drawing: Option<SceneryJob>,
    /// A result that waits for the user's decision.
    pub(crate) staged: Option<Staged>,
    /// Regions that are still to be generated.
    pub(crate) unsettled: Arc<[Bounds]>,
}

impl Generation {
    /// The generation before any job was submitted.
    pub fn new(worker: GenWorker, live: Live, tuning: Tuning, versions: Versions) -> Self {
        Self {
            worker,
            gate: UpdateGate::default(),
            live,
            tuning,
            receipt: None,
            versions,
            finished: None,
            preview: None,
            words: None,
            drawn_first: None,
            drawing: None,
            staged: None,
            unsettled: Arc::default(),
        }
    }

    /// Updates of the worker, in order, without those of replaced jobs.
    pub(crate) fn news(&mut self) -> Vec<JobEvent> {
        let events: Vec<JobEvent> = self.worker.updates().try_iter().collect();
        events
            .into_iter()
            .filter(|event| self.gate.admit(event))
            .collect()
    }

    /// Sends a job to the worker.
    pub(crate) fn submit(&mut self, scene: Arc<Scene>, params: GenParams, now_s: f64) {
        let job = Job { scene, params };
        let key = job.key();
        let id = self.worker.submit(job);
        self.live.submitted(id, key, now_s);
    }

    /// Cancels the running job. Returns false if none runs.
    pub(crate) fn cancel(&mut self) -> bool {
        let Some(running) = &mut self.live.running else {
            return false;
        };
        running.cancelled = true;
        self.worker.cancel();
        true
    }

    /// True while the whole scene is generated.
    pub(crate) fn runs_whole(&self) -> bool {
        let running = self.live.running.as_ref();
        running.is_some_and(|r| r.purpose == Purpose::Full)
    }

    /// Forgets everything that belongs to the scene that was open.
    pub(crate) fn forget_scene(&mut self) {
        self.worker.cancel();
        self.live.reset();
        (self.receipt, self.finished, self.preview) = (None, None, None);
        (self.words, self.drawn_first, self.drawing) = (None, None, None);
        self.tuning.reset();
    }

    /// True while a generation of the whole scene shows a preview for that state, which the user may keep as the
    /// result.
    pub(crate) fn shows_what_comes(&self, rev: SceneRev) -> bool {
        let whole = |r: &RunningJob| r.purpose == Purpose::Full && r.key.rev == rev && !r.cancelled;
        self.live.running.as_ref().is_some_and(whole)
            && self.preview.as_ref().is_some_and(|(of, _)| *of == rev)
    }
}
