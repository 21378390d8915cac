//! Requests to the generation worker and its answers, as plain values. A job is a pure function of its scene and
//! parameters: equal keys give equal results.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;
use thiserror::Error;

use diffusion::schedule::ScheduleError;
use diffusion::solver::SolverError;
use scene::message::one_line;
use scene::{Scene, SceneRev, VoxelGrid};

use runtime::worker::{Event, JobId};

pub use super::params::{ChosenDensities, GenParams, Quality, RegionMode};
pub use nn::Precision;

/// Input of a pipeline.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene as it was when the job was made.
    pub scene: Arc<Scene>,
    /// Parameters of the generation.
    pub params: GenParams,
}

impl Job {
    /// The key of this job's result.
    pub fn key(&self) -> JobKey {
        JobKey {
            rev: self.scene.content(),
            params: self.params.clone(),
        }
    }
}

/// Key of a cache of results: equal keys give equal results.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct JobKey {
    /// State of the scene, whatever moment is shown; see [`Scene::content`].
    pub rev: SceneRev,
    /// Parameters.
    pub params: GenParams,
}

/// Part of a generation, for progress and timing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Networks are read.
    Load,
    /// Labels to latent.
    Encode,
    /// Latent to noise, under the source's layout.
    Invert,
    /// Noise to latent, under the new layout.
    Denoise,
    /// Latent to labels.
    Decode,
    /// Region, composite and measures.
    Composite,
    /// LiDAR sweep.
    Lidar,
    /// Camera maps.
    Cameras,
}

impl Stage {
    /// Name as in reports: `denoise`.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Load => "load",
            Stage::Encode => "encode",
            Stage::Invert => "invert",
            Stage::Denoise => "denoise",
            Stage::Decode => "decode",
            Stage::Composite => "composite",
            Stage::Lidar => "lidar",
            Stage::Cameras => "cameras",
        }
    }
}

/// Statistics and cost of a generation. Serialises for `--report`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GenReport {
    /// Calls of the denoising network, inversion included.
    pub network_calls: usize,
    /// Number of those calls that inverted the source; 0 if its trajectory was in memory.
    pub inversion_calls: usize,
    /// Wall time by [`Stage::name`], s.
    pub wall_s: BTreeMap<&'static str, f64>,
    /// Columns in the region.
    pub region_columns: usize,
    /// Share of all columns of the map that are in the region.
    pub region_share: f64,
    /// Latent cells regenerated.
    pub region_cells: usize,
    /// Tokens that the denoising network worked on per call.
    pub tokens: usize,
    /// Voxels outside the region, not painted, that differ from the source: must be 0.
    pub untouched_voxels_changed: usize,
    /// Hash (FNV-1a) of the labels outside the region that are not painted: the same before and after.
    pub untouched_hash: u64,
    /// Share of voxels changed along the inner border of the region.
    pub seam_change_share: f64,
    /// Voxels that differ from the source.
    pub voxels_changed: usize,
    /// Voxels of the region that the edit does not concern, and that only the VAE's own error would have changed
    /// ([`keep_unchanged`]).
    ///
    /// [`keep_unchanged`]: super::guards::unchanged::keep_unchanged
    pub unchanged_kept: usize,
    /// Boxes that the networks left out and whose draft was put in ([`GenParams::keep_objects`]).
    pub objects_kept: usize,
    /// Columns in which the networks ignored the painted ground and it was put in.
    pub ground_kept: usize,
    /// Voxels that the networks put on the road or in a removed box's place unasked; they were cleared.
    pub invented_cleared: usize,
    /// Columns that the networks left without ground in a scene that should be complete; they got ground in the result.
    pub holes_closed: usize,
    /// Voxels where that ground was put in, in the generated window of the job's scene.
    #[serde(skip)]
    pub holes: Vec<[usize; 3]>,
    /// Number of things that describe the places beside the roads, so that the networks invented nothing there. Set for
    /// a whole scene.
    pub things_given: usize,
    /// Voxels added as stems under floating crowns.
    pub stems_added: usize,
    /// Voxels that were removed because they floated or belonged to an object without a box.
    pub loose_dropped: usize,
    /// Voxels that the networks put where no sensor of the source had looked; they were removed again.
    pub unobserved_kept: usize,
    /// Relative RMS error of encoding, inverting and sampling again, if it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub round_trip_error: Option<f64>,
    /// Standard deviation of the noise that inversion ended in, if an inversion ran or was in memory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_std: Option<f64>,
    /// Largest magnitude in that noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_max_abs: Option<f64>,
    /// Notes for the user: fallbacks, moments out of bounds. One line each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl GenReport {
    /// Runs `work` and adds its wall time to a stage.
    pub fn timed<T>(&mut self, stage: Stage, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = Instant::now();
        let out = work(self);
        *self.wall_s.entry(stage.name()).or_default() += start.elapsed().as_secs_f64();
        out
    }

    /// Records the numbers of stems and of removed floating voxels.
    pub fn grounded(&mut self, found: super::guards::grounded::Grounded) {
        (self.stems_added, self.loose_dropped) = (found.stems, found.dropped);
    }

    /// Records the holes that were closed.
    pub fn close(&mut self, holes: Vec<[usize; 3]>) {
        self.holes_closed = holes.len();
        self.holes = holes;
    }

    /// Adds the report of another part of the same job. The caller must set the share of the columns.
    pub fn add(&mut self, part: &Self) {
        let first = self.network_calls == 0 && self.region_columns == 0;
        for (stage, wall_s) in &part.wall_s {
            *self.wall_s.entry(stage).or_default() += wall_s;
        }
        let counts: [(&mut usize, usize); 15] = [
            (&mut self.network_calls, part.network_calls),
            (&mut self.inversion_calls, part.inversion_calls),
            (&mut self.region_columns, part.region_columns),
            (&mut self.region_cells, part.region_cells),
            (&mut self.untouched_voxels_changed, part.untouched_voxels_changed),
            (&mut self.voxels_changed, part.voxels_changed),
            (&mut self.unchanged_kept, part.unchanged_kept),
            (&mut self.objects_kept, part.objects_kept),
            (&mut self.ground_kept, part.ground_kept),
            (&mut self.invented_cleared, part.invented_cleared),
            (&mut self.holes_closed, part.holes_closed),
            (&mut self.stems_added, part.stems_added),
            (&mut self.loose_dropped, part.loose_dropped),
            (&mut self.unobserved_kept, part.unobserved_kept),
            (&mut self.tokens, part.tokens),
        ];
        for (sum, more) in counts {
            *sum += more;
        }
        self.untouched_hash = match first {
            true => part.untouched_hash,
            false => self.untouched_hash.rotate_left(1) ^ part.untouched_hash,
        };
        self.seam_change_share = self.seam_change_share.max(part.seam_change_share);
        // The worst of the parts.
        let worst = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::max);
        self.round_trip_error = worst(self.round_trip_error, part.round_trip_error);
        self.noise_std = worst(self.noise_std, part.noise_std);
        self.noise_max_abs = worst(self.noise_max_abs, part.noise_max_abs);
        let known: Vec<String> = part
            .notes
            .iter()
            .filter(|n| !self.notes.contains(n))
            .cloned()
            .collect();
        self.notes.extend(known);
    }

    /// Wall time of all stages, s.
    pub fn total_s(&self) -> f64 {
        self.wall_s.values().sum::<f64>() + 0.0 // an empty sum is -0
    }
}

/// A generated occupancy, finished or unfinished.
#[derive(Clone, Debug)]
pub struct GenResult {
    /// The job that it answers.
    pub key: JobKey,
    /// The new occupancy of [`Scene::for_generation`]'s frame, of its extent: the source outside the region, with
    /// painted voxels kept.
    pub occupancy: VoxelGrid,
    /// Statistics and cost.
    pub report: GenReport,
}

impl GenResult {
    /// State of the scene that the result belongs to.
    pub fn rev(&self) -> SceneRev {
        self.key.rev
    }
}

/// Reason why there is no result. Displays as one line.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GenError {
    /// A newer job waits, or the user cancelled. Not shown as an error.
    #[error("stopped for a newer job")]
    Superseded,
    /// A parameter out of range.
    #[error("{0}")]
    Params(String),
    /// The solver refused.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The pipeline panicked; it is built again for the next job.
    #[error("generation panicked: {0}")]
    Panicked(String),
    /// Any other error: weights, device, networks.
    #[error("{0}")]
    Failed(String),
}

impl GenError {
    /// Makes an error of any other error, on one line. Format an `anyhow::Error` with `{:#}` first.
    pub fn failed(error: impl Display) -> Self {
        Self::Failed(one_line(&error.to_string()))
    }
}

impl From<ScheduleError> for GenError {
    fn from(error: ScheduleError) -> Self {
        Self::Solver(error.into())
    }
}

/// Updates of a running job.
#[derive(Clone, Debug)]
pub enum JobUpdate {
    /// Steps done in a stage.
    Progress {
        /// Part of the work.
        stage: Stage,
        /// Steps done.
        step: usize,
        /// All steps of the stage.
        steps: usize,
    },
    /// An unfinished result to show meanwhile.
    Preview(Arc<GenResult>),
    /// The result. Terminal.
    Finished(Arc<GenResult>),
    /// There is no result. Terminal; later jobs run.
    Failed(GenError),
    /// Given up for a newer job or on request. Terminal.
    Superseded,
}

impl JobUpdate {
    /// True for the last update of a job.
    pub fn is_terminal(&self) -> bool {
        matches!(self, Self::Finished(_) | Self::Failed(_) | Self::Superseded)
    }
}

/// A [`JobUpdate`] with its job.
pub type JobEvent = Event<JobUpdate>;

/// Connection of a running job to its caller.
pub struct JobCtx<'a> {
    stop: &'a (dyn Fn() -> bool + Sync),
    report: &'a (dyn Fn(JobUpdate) + Sync),
    previews: bool,
}

impl<'a> JobCtx<'a> {
    /// `stop` is called between steps, `report` gets every update.
    pub fn new(stop: &'a (dyn Fn() -> bool + Sync), report: &'a (dyn Fn(JobUpdate) + Sync)) -> Self {
        Self {
            stop,
            report,
            previews: false,
        }
    }

    /// Requests previews of long jobs, for a caller that shows them.
    pub fn with_previews(self) -> Self {
        Self {
            previews: true,
            ..self
        }
    }

    /// True if previews are wanted.
    pub fn previews(&self) -> bool {
        self.previews
    }

    /// A context for a caller that waits for the result: it never stops the job and reports nothing.
    pub fn detached() -> JobCtx<'static> {
        JobCtx {
            stop: &|| false,
            report: &|_| {},
            previews: false,
        }
    }

    /// Fails if the job should end.
    pub fn check(&self) -> Result<(), GenError> {
        if (self.stop)() {
            Err(GenError::Superseded)
        } else {
            Ok(())
        }
    }

    /// Reports progress; fails if the job should end. Call it between steps, with `?`.
    pub fn progress(&self, stage: Stage, step: usize, steps: usize) -> Result<(), GenError> {
        self.check()?;
        (self.report)(JobUpdate::Progress { stage, step, steps });
        Ok(())
    }

    /// Passes an update on.
    pub fn report(&self, update: JobUpdate) {
        (self.report)(update);
    }

    /// Sends a preview; it is dropped if the receiver is slow.
    pub fn preview(&self, result: GenResult) {
        (self.report)(JobUpdate::Preview(Arc::new(result)));
    }
}

/// A generator of results. Runs on the worker's thread, or on the caller's in the command line.
pub trait Pipeline {
    /// Runs a job. The result must depend on `job` alone (and on caches that change no result).
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError>;
}

/// Filters updates. Drops those of a job that has ended, and those of a job older than the newest one that has sent an
/// update.
#[derive(Clone, Copy, Debug, Default)]
pub struct UpdateGate {
    newest: Option<JobId>,
    ended: Option<JobId>,
}

impl UpdateGate {
    /// True if the update should be shown.
    pub fn admit(&mut self, event: &JobEvent) -> bool {
        if Some(event.id) < self.newest || Some(event.id) <= self.ended {
            return false;
        }
        self.newest = Some(event.id);
        if event.update.is_terminal() {
            self.ended = Some(event.id);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn errors_are_one_line() {
        let error = GenError::failed("weights:\n\n  tensor \"a\" is missing\n");
        assert_eq!(error.to_string(), "weights:; tensor \"a\" is missing");
        let panicked = GenError::Panicked("a; b".into());
        assert_eq!(panicked.to_string(), "generation panicked: a; b");
    }

    #[test]
    fn a_context_reports_until_it_is_stopped() {
        let stop = std::sync::atomic::AtomicBool::new(false);
        let seen = Mutex::new(Vec::new());
        let stop_fn = || stop.load(std::sync::atomic::Ordering::Relaxed);
        let report = |u: JobUpdate| seen.lock().expect("one thread").push(u);
        let ctx = JobCtx::new(&stop_fn, &report);
        assert_eq!(ctx.progress(Stage::Denoise, 1, 3), Ok(()));
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        assert_eq!(ctx.progress(Stage::Denoise, 2, 3), Err(GenError::Superseded));
        assert_eq!(seen.lock().expect("one thread").len(), 1);
        assert_eq!(JobCtx::detached().progress(Stage::Load, 0, 1), Ok(()));
    }

    /// Row 61 of the extremes table: what arrives late is dropped by its job id.
    #[test]
    fn row_61_late_updates_are_dropped() {
        let mut gate = UpdateGate::default();
        let progress = JobUpdate::Progress {
            stage: Stage::Invert,
            step: 1,
            steps: 2,
        };
        let mut admit = |id, update: &JobUpdate| {
            gate.admit(&JobEvent {
                id: JobId(id),
                update: update.clone(),
            })
        };
        let failed = JobUpdate::Failed(GenError::failed("x"));
        assert!(admit(3, &progress));
        assert!(admit(3, &JobUpdate::Superseded));
        assert!(!admit(3, &progress), "after the end");
        assert!(!admit(3, &failed), "a second end");
        assert!(!admit(2, &failed), "an older job");
        assert!(admit(5, &progress));
        assert!(!admit(4, &failed), "older than the running one");
        assert!(admit(5, &failed));
        assert!(admit(6, &progress));
    }

    #[test]
    fn reports_add_up() {
        let mut report = GenReport::default();
        let seven = report.timed(Stage::Decode, |r| {
            r.network_calls += 1;
            7
        });
        report.timed(Stage::Decode, |_| ());
        assert_eq!((seven, report.network_calls, report.wall_s.len()), (7, 1, 1));
        assert!(report.total_s() >= 0.0);
        let text = serde_json::to_string(&report).expect("plain values");
        assert!(text.contains("\"untouched_voxels_changed\":0") && !text.contains("round_trip"));
    }
}
