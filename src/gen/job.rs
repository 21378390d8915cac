//! What is asked of the generation worker and what it answers, as plain values.
//! A job is a pure function of its scene and parameters: same key, same result.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::hash::{Hash, Hasher};
use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::schedule::ScheduleError;
use super::solver::{Guidance, SolverError, SolverKind};
use crate::scene::{Density, Scene, SceneRev, VoxelGrid};

/// What part of the scene is regenerated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RegionMode {
    /// What the edit touches; everything else stays bit-identical.
    #[default]
    Auto,
    /// All of it, from fresh noise.
    Full,
}

/// How much work a result is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// Something to look at while editing: results may be coarser.
    Preview,
    /// The result to keep.
    #[default]
    Final,
}

/// Numbers of [`Density`] that the user names; what is not named is left to the networks (all of a scene) or
/// stays as it is (an edit). Each 0 to 1.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Named {
    /// How much grows.
    pub vegetation: Option<f32>,
    /// How much is built.
    pub building: Option<f32>,
    /// How much low furniture stands about.
    pub clutter: Option<f32>,
    /// 1 for complete worlds, about 0.4 for what real labels hold.
    pub completeness: Option<f32>,
}

impl Named {
    /// In the networks' order.
    pub fn values(&self) -> [Option<f32>; 4] {
        [self.vegetation, self.building, self.clutter, self.completeness]
    }

    /// With those of `other` where none is named.
    pub fn or_else(&self, other: &Self) -> Self {
        Self {
            vegetation: self.vegetation.or(other.vegetation),
            building: self.building.or(other.building),
            clutter: self.clutter.or(other.clutter),
            completeness: self.completeness.or(other.completeness),
        }
    }

    /// With those of `density` where none is named.
    pub fn or(&self, density: &Density) -> Self {
        self.or_else(&Self {
            vegetation: Some(density.vegetation),
            building: Some(density.building),
            clutter: Some(density.clutter),
            completeness: Some(density.completeness),
        })
    }
}

/// Every knob of a generation. Equal parameters are equal bit for bit, so they can name a cache entry.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GenParams {
    /// Sampling steps, 1 to 1000.
    pub steps: u32,
    /// How a step is made; with O-BELM the inversion is exact.
    pub solver: SolverKind,
    /// Classifier-free guidance weight; 1 = none, half the network calls, where inversion is good.
    pub guidance: f64,
    /// See [`Guidance::rescale`].
    pub guidance_rescale: f64,
    /// Fixes all noise.
    pub seed: u64,
    /// What is regenerated.
    pub region: RegionMode,
    /// How far the region's noise leaves the inverted one, 0 to 1 (see `RegionNoise`).
    pub strength: f64,
    /// Fixed-point updates per inversion step; 0 = plain DDIM inversion.
    pub inversion_iterations: u32,
    /// Columns around an edit that are redrawn with it.
    pub halo_columns: u32,
    /// Computes only the tokens around an edit; the others show what they held in the source.
    pub local: bool,
    /// Tokens (3.2 m) around an edited region that are computed with it.
    pub halo_tokens: u32,
    /// How much work the result is worth.
    pub quality: Quality,
    /// Densities and completeness asked for.
    pub named: Named,
    /// Puts the draft of an added or changed box in where the networks left out most of it, so that
    /// what the user placed never vanishes.
    pub keep_objects: bool,
}

impl Default for GenParams {
    fn default() -> Self {
        Self {
            steps: 10,
            solver: SolverKind::Ddim,
            guidance: 1.0,
            guidance_rescale: 0.0,
            seed: 0,
            region: RegionMode::Auto,
            strength: 0.0,
            inversion_iterations: 0,
            halo_columns: 2,
            local: true,
            halo_tokens: 1,
            quality: Quality::Final,
            named: Named::default(),
            keep_objects: true,
        }
    }
}

impl GenParams {
    /// Everything as bits: the basis of equality and hashing.
    fn bits(
        &self,
    ) -> (
        [u32; 4],
        [u64; 4],
        [Option<u32>; 4],
        SolverKind,
        RegionMode,
        Quality,
        [bool; 2],
    ) {
        // Adding 0 turns -0 into 0.
        let bits = |v: f64| (v + 0.0).to_bits();
        (
            [
                self.steps,
                self.inversion_iterations,
                self.halo_columns,
                self.halo_tokens,
            ],
            [
                self.seed,
                bits(self.guidance),
                bits(self.guidance_rescale),
                bits(self.strength),
            ],
            self.named.values().map(|v| v.map(|v| (v + 0.0).to_bits())),
            self.solver,
            self.region,
            self.quality,
            [self.keep_objects, self.local],
        )
    }

    /// Fails with one line if a value is out of range.
    pub fn check(&self) -> Result<(), GenError> {
        let in_range = |name: &str, value: f64, lo: f64, hi: f64| {
            // Written so that NaN fails too.
            if value >= lo && value <= hi {
                return Ok(());
            }
            Err(GenError::Params(format!(
                "{name} is {value}, expected {lo} to {hi}"
            )))
        };
        in_range("steps", f64::from(self.steps), 1.0, 1000.0)?;
        in_range("guidance", self.guidance, -100.0, 100.0)?;
        in_range("guidance_rescale", self.guidance_rescale, 0.0, 1.0)?;
        in_range("strength", self.strength, 0.0, 1.0)?;
        for (name, value) in ["vegetation", "building", "clutter", "completeness"]
            .iter()
            .zip(self.named.values())
        {
            in_range(name, f64::from(value.unwrap_or(0.0)), 0.0, 1.0)?;
        }
        let iterations = f64::from(self.inversion_iterations);
        in_range("inversion_iterations", iterations, 0.0, 100.0)?;
        in_range("halo_columns", f64::from(self.halo_columns), 0.0, 200.0)
    }

    /// The guidance that these parameters ask for.
    pub fn guidance(&self) -> Guidance {
        Guidance {
            weight: self.guidance,
            rescale: self.guidance_rescale,
        }
    }
}

impl PartialEq for GenParams {
    fn eq(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }
}

impl Eq for GenParams {}

impl Hash for GenParams {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.bits().hash(state);
    }
}

/// All that a pipeline may read.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene as it was when the job was made.
    pub scene: Arc<Scene>,
    /// How to generate.
    pub params: GenParams,
}

impl Job {
    /// What names this job's result.
    pub fn key(&self) -> JobKey {
        JobKey {
            rev: self.scene.rev,
            params: self.params,
        }
    }
}

/// Same key, same result: the key of a cache of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct JobKey {
    /// State of the scene.
    pub rev: SceneRev,
    /// Parameters.
    pub params: GenParams,
}

/// Names a submitted job; later jobs have greater ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(pub u64);

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

/// What a generation did and what it cost. Serialises for `--report`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GenReport {
    /// Calls of the denoising network, inversion included.
    pub network_calls: usize,
    /// Calls of them for inversion; 0 if the trajectory was at hand.
    pub inversion_calls: usize,
    /// Wall time by [`Stage::name`], s.
    pub wall_s: BTreeMap<&'static str, f64>,
    /// Columns in the region.
    pub region_columns: usize,
    /// Share of all columns.
    pub region_share: f64,
    /// Latent cells regenerated.
    pub region_cells: usize,
    /// Tokens that the denoising network worked on per call.
    pub tokens: usize,
    /// Voxels outside the region, not painted, that differ from the source: must be 0.
    pub untouched_voxels_changed: usize,
    /// Share of voxels changed along the inner border of the region.
    pub seam_change_share: f64,
    /// Voxels that differ from the source.
    pub voxels_changed: usize,
    /// Boxes that the networks left out and whose draft was put in ([`GenParams::keep_objects`]).
    pub objects_kept: usize,
    /// Columns whose painted ground the networks did not follow, and that were given it.
    pub ground_kept: usize,
    /// Relative RMS error of encode, invert and sample again, where it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub round_trip_error: Option<f64>,
    /// Standard deviation of the noise that inversion ended in, where one ran or was at hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_std: Option<f64>,
    /// Largest magnitude in that noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_max_abs: Option<f64>,
    /// What the user should know: fallbacks, moments out of bounds. One line each.
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

    /// Wall time of all stages, s.
    pub fn total_s(&self) -> f64 {
        self.wall_s.values().sum()
    }
}

/// A generated occupancy, finished or on the way.
#[derive(Clone, Debug)]
pub struct GenResult {
    /// The job that it answers.
    pub key: JobKey,
    /// Index of the frame that was generated.
    pub frame: usize,
    /// The new occupancy: source outside the region, painted voxels kept.
    pub occupancy: VoxelGrid,
    /// What it cost.
    pub report: GenReport,
}

impl GenResult {
    /// State of the scene that it belongs to.
    pub fn rev(&self) -> SceneRev {
        self.key.rev
    }
}

/// Why there is no result. Displays as one line.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GenError {
    /// A newer job waits, or the user cancelled. Not an error to show.
    #[error("stopped for a newer job")]
    Superseded,
    /// A parameter out of range.
    #[error("{0}")]
    Params(String),
    /// A solver refused.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The pipeline panicked; it is built anew for the next job.
    #[error("generation panicked: {0}")]
    Panicked(String),
    /// Anything else: weights, device, networks.
    #[error("{0}")]
    Failed(String),
}

impl GenError {
    /// From any error, on one line; for an `anyhow::Error` format it with `{:#}` first.
    pub fn failed(error: impl Display) -> Self {
        Self::Failed(one_line(&error.to_string()))
    }

    /// From what a panic left behind.
    pub fn panicked(payload: &(dyn std::any::Any + Send)) -> Self {
        let text = payload
            .downcast_ref::<&str>()
            .copied()
            .or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        Self::Panicked(one_line(text.unwrap_or("no message")))
    }
}

impl From<ScheduleError> for GenError {
    fn from(error: ScheduleError) -> Self {
        Self::Solver(error.into())
    }
}

fn one_line(text: &str) -> String {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|l| !l.is_empty()).collect();
    lines.join("; ")
}

/// News about a job.
#[derive(Clone, Debug)]
pub enum JobUpdate {
    /// Where it is: `step` of `steps` of a stage are done.
    Progress {
        /// Part of the work.
        stage: Stage,
        /// Steps done.
        step: usize,
        /// All steps of the stage.
        steps: usize,
    },
    /// Something to look at on the way.
    Preview(Arc<GenResult>),
    /// The result. Terminal.
    Finished(Arc<GenResult>),
    /// No result. Terminal; later jobs run.
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
#[derive(Clone, Debug)]
pub struct JobEvent {
    /// Which job.
    pub id: JobId,
    /// What became of it.
    pub update: JobUpdate,
}

/// How a running job talks to whoever asked for it.
pub struct JobCtx<'a> {
    stop: &'a (dyn Fn() -> bool + Sync),
    report: &'a (dyn Fn(JobUpdate) + Sync),
}

impl<'a> JobCtx<'a> {
    /// `stop` is asked between steps, `report` gets every update.
    pub fn new(stop: &'a (dyn Fn() -> bool + Sync), report: &'a (dyn Fn(JobUpdate) + Sync)) -> Self {
        Self { stop, report }
    }

    /// For a caller that waits: never stopped, tells nobody.
    pub fn detached() -> JobCtx<'static> {
        JobCtx {
            stop: &|| false,
            report: &|_| {},
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

    /// Says where the job is; fails if it should end. Call it between steps and leave with `?`.
    pub fn progress(&self, stage: Stage, step: usize, steps: usize) -> Result<(), GenError> {
        self.check()?;
        (self.report)(JobUpdate::Progress { stage, step, steps });
        Ok(())
    }

    /// Shows something on the way; may be dropped if the receiver is slow.
    pub fn preview(&self, result: GenResult) {
        (self.report)(JobUpdate::Preview(Arc::new(result)));
    }
}

/// Makes results. Runs on the worker's thread, or on the caller's in the command line.
pub trait Pipeline {
    /// Does a job. Must depend on nothing but `job` (and on caches that change no result).
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError>;
}

/// Lets through only what may still change the screen: nothing of a job that has ended, and nothing of a
/// job older than the newest one that was heard of.
#[derive(Clone, Copy, Debug, Default)]
pub struct UpdateGate {
    newest: Option<JobId>,
    ended: Option<JobId>,
}

impl UpdateGate {
    /// True if the update is news.
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
    use std::collections::hash_map::DefaultHasher;
    use std::sync::Mutex;

    #[test]
    fn parameters_are_a_key() {
        let a = GenParams::default();
        let hash = |p: &GenParams| {
            let mut h = DefaultHasher::new();
            p.hash(&mut h);
            h.finish()
        };
        let same = GenParams { strength: -0.0, ..a };
        assert_eq!((a, hash(&a)), (same, hash(&same)));
        let changes: [fn(&mut GenParams); 9] = [
            |p| p.steps = 11,
            |p| p.guidance = 1.0 + f64::EPSILON,
            |p| p.guidance_rescale = 0.7,
            |p| p.seed = 1,
            |p| p.region = RegionMode::Full,
            |p| p.strength = 0.5,
            |p| p.inversion_iterations = 3,
            |p| p.halo_columns = 3,
            |p| p.quality = Quality::Preview,
        ];
        for change in changes {
            let mut other = a;
            change(&mut other);
            assert!(other != a && hash(&other) != hash(&a), "{other:?}");
            let text = serde_json::to_string(&other).expect("plain values");
            assert_eq!(
                serde_json::from_str::<GenParams>(&text).expect("round trip"),
                other
            );
        }
        assert_eq!(serde_json::from_str::<GenParams>("{}").expect("all defaults"), a);
        assert!(serde_json::from_str::<GenParams>(r#"{"stepps": 3}"#).is_err());
    }

    #[test]
    fn parameters_out_of_range_are_refused_in_one_line() {
        assert_eq!(GenParams::default().check(), Ok(()));
        let changes: [fn(&mut GenParams); 7] = [
            |p| p.steps = 0,
            |p| p.steps = 1001,
            |p| p.guidance = f64::NAN,
            |p| p.guidance = f64::INFINITY,
            |p| p.strength = 1.5,
            |p| p.inversion_iterations = 101,
            |p| p.halo_columns = 201,
        ];
        for change in changes {
            let mut bad = GenParams::default();
            change(&mut bad);
            let text = bad.check().expect_err("out of range").to_string();
            assert!(
                text.contains(", expected ") && text.lines().count() == 1,
                "{text}"
            );
        }
        let zero = GenParams {
            steps: 0,
            ..GenParams::default()
        };
        let text = zero.check().expect_err("0").to_string();
        assert_eq!(text, "steps is 0, expected 1 to 1000");
    }

    #[test]
    fn errors_are_one_line() {
        let error = GenError::failed("weights:\n\n  tensor \"a\" is missing\n");
        assert_eq!(error.to_string(), "weights:; tensor \"a\" is missing");
        let payload: Box<dyn std::any::Any + Send> = Box::new("a\nb");
        assert_eq!(
            GenError::panicked(&*payload).to_string(),
            "generation panicked: a; b"
        );
        let payload: Box<dyn std::any::Any + Send> = Box::new(7);
        assert_eq!(
            GenError::panicked(&*payload).to_string(),
            "generation panicked: no message"
        );
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
