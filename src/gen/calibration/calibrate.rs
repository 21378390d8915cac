//! Work beside the window: times the slider's presets on this machine, or measures how far the last edit's result lies
//! from the reference. Each in a thread of its own that can be stopped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, unbounded};

use super::cases::{self, Case};
use super::edits::Bench;
use crate::held_out::bare_scene;
use crate::machine::{Load, machine};
use job::composite::label_hash;
use job::pipeline::OccPipeline;
use job::{GenError, GenParams, GenReport, Job, JobCtx, JobUpdate, Pipeline};
use nets::OccModels;
use numeric::quantile::median;
use scene::{Scene, VoxelGrid};
use trade::{Cost, Preset, Presets, SizedTime};
use world::draw::Draw;

/// Calibration ends after this, with what was measured so far.
const AT_MOST: Duration = Duration::from_secs(28);

/// Kinds of measurement.
pub enum MeasurementTask {
    /// Times of all presets.
    Calibrate(Presets),
    /// Error of a result.
    Refine(Box<Refine>),
}

/// An edit's result and the scene it came from.
pub struct Refine {
    /// The scene with the edit, before it was generated.
    pub edited: Arc<Scene>,
    /// Parameters of the generation.
    pub params: GenParams,
    /// Result of the generation.
    pub result: VoxelGrid,
    /// The reference's settings.
    pub reference: Preset,
}

/// Messages from the thread.
#[derive(Clone, Debug)]
pub enum CalibrationEvent {
    /// Parts done, and all parts.
    Progress(usize, usize),
    /// Presets with this machine's times. True if the results are bit by bit those whose errors are known.
    Calibrated(Presets, bool),
    /// Share of the region's voxels in which the result differs from the reference.
    Refined(f64),
    /// Error in one line.
    Failed(String),
}

/// A running task. Dropping it stops the thread soon.
pub struct Measurement {
    news: Receiver<CalibrationEvent>,
    stop: Arc<AtomicBool>,
}

impl Measurement {
    /// Starts the thread; `wake` is called after each piece of news. Errors if the system gives no thread.
    pub fn start(task: MeasurementTask, wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let (out, news) = unbounded();
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let wake = Arc::new(wake);
        let (out_last, wake_last) = (out.clone(), wake.clone());
        let measure = move || {
            let told = CalibrationSender { out, wake: &*wake };
            let should_stop = || stopped.load(Ordering::Relaxed);
            match task {
                MeasurementTask::Calibrate(presets) => calibrate(presets, &should_stop, &told),
                MeasurementTask::Refine(refine) => refined(&refine, &should_stop, &told),
            }
        };
        runtime::guard::spawn("measure", measure, move |answer| {
            let told = CalibrationSender {
                out: out_last,
                wake: &*wake_last,
            };
            match answer.unwrap_or_else(|panic| Err(GenError::failed(panic))) {
                Ok(news) => told.say(news),
                Err(GenError::Superseded) => {}
                Err(error) => told.say(CalibrationEvent::Failed(error.to_string())),
            }
        })?;
        Ok(Self { news, stop })
    }

    /// The next piece of news.
    pub fn next(&self) -> Option<CalibrationEvent> {
        self.news.try_recv().ok()
    }
}

impl Drop for Measurement {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

struct CalibrationSender<'a> {
    out: Sender<CalibrationEvent>,
    wake: &'a (dyn Fn() + Send + Sync),
}

impl CalibrationSender<'_> {
    fn say(&self, news: CalibrationEvent) {
        // Sending fails once the window has let go of the measurement; that is fine.
        let _ = self.out.send(news);
        (self.wake)();
    }
}

/// A preset whose source is prepared, and the times of its runs.
struct PreparedPreset {
    preset: usize,
    pipeline: OccPipeline,
    times: Vec<Vec<SizedTime>>, // by case
}

fn run(
    pipeline: &OccPipeline,
    case: &Case,
    params: GenParams,
    ctx: &JobCtx<'_>,
) -> Result<(SizedTime, u64), GenError> {
    let mut pipeline = pipeline.clone();
    let job = Job {
        scene: case.after.clone(),
        params,
    };
    let start = Instant::now();
    let result = pipeline.run(&job, ctx)?;
    let time = SizedTime {
        tokens: result.report.tokens as f64,
        wall_s: start.elapsed().as_secs_f64(),
    };
    Ok((time, label_hash(&result.occupancy)))
}

/// Times every preset on the edits of one world, each at least once, then in random turns until the time is up.
fn calibrate(
    mut presets: Presets,
    stop: &(dyn Fn() -> bool + Sync),
    told: &CalibrationSender<'_>,
) -> Result<CalibrationEvent, GenError> {
    let ctx = JobCtx::new(stop, &|_| {});
    let deadline = Instant::now() + AT_MOST;
    let models = OccModels::bundled().map_err(GenError::failed)?;
    let cases = cases::of_scene(&bare_scene(0), "world 0", 0);
    let timed: Vec<usize> = (0..presets.all.len())
        .filter(|i| presets.all[*i].name != "reference")
        .collect();
    let parts = timed.len() + 1;
    let mut same = true;
    let mut ready: Vec<PreparedPreset> = Vec::new();
    let mut slower = Vec::new(); // than where the presets were measured
    for (k, i) in timed.into_iter().enumerate() {
        told.say(CalibrationEvent::Progress(k, parts));
        let of = &mut presets.all[i];
        let params = of.knobs.on(GenParams::default());
        let mut pipeline = OccPipeline::new(models.clone());
        let start = Instant::now();
        let job = Job {
            scene: cases[0].before.clone(),
            params: params.clone(),
        };
        pipeline.prepare(&job, &ctx)?;
        let invert_s = start.elapsed().as_secs_f64();
        slower.push(invert_s / of.invert_s);
        of.invert_s = invert_s;
        let mut times = vec![Vec::new(); cases.len()];
        for (c, case) in cases.iter().enumerate() {
            let (time, hash) = run(&pipeline, case, params.clone(), &ctx)?;
            same &= of.probe.get(c) == Some(&hash);
            // The very first run only warms up.
            if k > 0 || c > 0 {
                times[c].push(time);
            }
        }
        ready.push(PreparedPreset {
            preset: i,
            pipeline,
            times,
        });
    }
    told.say(CalibrationEvent::Progress(parts - 1, parts));
    let mut draw = Draw::new(0, "calibration");
    while Instant::now() < deadline && !ready.is_empty() {
        let (r, c) = (draw.below(ready.len()), draw.below(cases.len()));
        let params = presets.all[ready[r].preset].knobs.on(GenParams::default());
        let (time, _) = run(&ready[r].pipeline, &cases[c], params, &ctx)?;
        ready[r].times[c].push(time);
    }
    for r in &ready {
        let middle: Vec<SizedTime> = r
            .times
            .iter()
            .filter(|t| !t.is_empty())
            .map(|t| SizedTime {
                tokens: t[0].tokens,
                wall_s: median(&t.iter().map(|t| t.wall_s).collect::<Vec<_>>()),
            })
            .collect();
        let of = &mut presets.all[r.preset];
        if let Some(cost) = Cost::fit(&middle) {
            of.cost = cost;
        }
    }
    // The reference takes minutes: its time is scaled as the others' inversions are.
    let slower = median(&slower);
    let reference = presets.all.iter_mut().find(|s| s.name == "reference");
    if let Some(reference) = reference.filter(|_| slower.is_finite()) {
        reference.invert_s *= slower;
        reference.cost.fixed_s *= slower;
    }
    presets.machine = machine();
    presets.build = build();
    presets.load_per_core = Load::now().per_core;
    Ok(CalibrationEvent::Calibrated(presets, same))
}

/// Name of this build of the program: figures of another build may not hold.
pub fn build() -> String {
    let exe = std::env::current_exe().and_then(std::fs::metadata);
    let stamp = exe.ok().and_then(|m| {
        let made = m.modified().ok()?.duration_since(std::time::UNIX_EPOCH).ok()?;
        Some(format!("{}-{}", m.len(), made.as_secs()))
    });
    format!("{} {}", env!("CARGO_PKG_VERSION"), stamp.unwrap_or_default())
}

/// Runs the reference on the same edit.
fn refined(
    of: &Refine,
    stop: &(dyn Fn() -> bool + Sync),
    told: &CalibrationSender<'_>,
) -> Result<CalibrationEvent, GenError> {
    let params = of.reference.knobs.on(of.params.clone());
    // Inversion and sampling take the same number of steps each.
    let steps = 2 * params.steps as usize;
    let half = std::sync::atomic::AtomicUsize::new(0);
    let report = |update: JobUpdate| {
        if let JobUpdate::Progress { stage, step, .. } = update {
            let done = match stage {
                job::Stage::Denoise => params.steps as usize + step,
                _ => step,
            };
            if half.fetch_max(done, Ordering::Relaxed) < done {
                told.say(CalibrationEvent::Progress(done, steps));
            }
        }
    };
    let ctx = JobCtx::new(stop, &report);
    let mut pipeline = OccPipeline::new(OccModels::bundled().map_err(GenError::failed)?);
    let job = Job {
        scene: of.edited.clone(),
        params: params.clone(),
    };
    let truth = pipeline.run(&job, &ctx)?;
    let case = Case {
        name: String::new(),
        before: of.edited.clone(),
        after: of.edited.clone(),
    };
    let reference = super::edits::Reference {
        occupancy: truth.occupancy,
        latent: Vec::new(),
    };
    let outcome = Bench::compare(
        &case,
        &of.params,
        &of.result,
        None,
        &GenReport::default(),
        &reference,
    );
    Ok(CalibrationEvent::Refined(outcome.error))
}
