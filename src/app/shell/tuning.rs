//! The quality slider: its presets, their predicted costs, the real cost of the last edit, and the background work that
//! measures both.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use calibration::calibrate::{CalibrationEvent, Measurement, MeasurementTask, Refine, build};
use calibration::figures::{percent, seconds};
use calibration::machine::machine;
use formats::input;
use job::inpaint;
use job::region::Region;
use job::{GenParams, GenReport, GenResult};
use language::{t, tf};
use nets::{OccModels, tokens_of};
use numeric::quantile::median;
use scene::Scene;
use trade::{Preset, Presets};

/// Number of edits that the window's own pace is taken from.
const REMEMBERED: usize = 9;
/// Tokens of an edit of one vehicle, used before the first edit.
const TYPICAL_TOKENS: f64 = 36.0;

/// The machine whose times predictions are based on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimesOf {
    /// This machine: it was calibrated, or has made edits since the window opened.
    ThisMachine,
    /// Another machine with the same processor, without other load.
    OneLikeIt,
    /// Another machine.
    Another,
}

impl TimesOf {
    /// A time as text, with its machine unless that is this one.
    pub fn told(self, s: f64) -> String {
        let time = seconds(s);
        match self {
            Self::ThisMachine => time,
            Self::OneLikeIt => tf!("{time} on another machine like this", time = time),
            Self::Another => tf!("{time} on another machine", time = time),
        }
    }
}

/// A line with the predicted time, error and invented voxels of a preset.
pub fn predicted(preset: &Preset, wall_s: f64, of: TimesOf) -> String {
    let time = of.told(wall_s);
    if preset.error.high == 0.0 {
        return format!("{time}  ·  {}", t("what the others are measured against"));
    }
    let [low, high] = preset.error_of_one.map(percent);
    let middle = percent(preset.error.median);
    let invented = preset.invented.map_or(String::new(), |n| match n {
        n if n < 0.05 => format!("  ·  {}", t("invents nothing")),
        n => format!("  ·  {}", tf!("invents {n} voxels", n = format!("{n:.1}"))),
    });
    let differ = tf!(
        "{share} of its voxels differ ({low} to {high})",
        share = t(&middle),
        low = t(&low),
        high = t(&high),
    );
    // Most of a region is empty space, in which no visible voxel can differ.
    let occupied = preset.error_of_occupied.map_or(String::new(), |of_occupied| {
        let share = percent(of_occupied.median);
        format!(", {}", tf!("{share} of the occupied ones", share = t(&share)))
    });
    let differ = format!("{differ}{occupied}");
    format!("{time}  ·  {differ}{invented}")
}

/// Result and cost of the last edit, beside the predictions.
pub struct LastEdit {
    /// Parameters of its generation.
    pub params: GenParams,
    /// Report of the pipeline.
    pub report: GenReport,
    /// Time from the edit to the settled scene, s.
    pub settled_s: f64,
    /// Tokens around the edit, whether or not others were computed too: the size of the edit.
    pub local_tokens: usize,
    /// Predicted wall time of the generation, s.
    pub predicted_s: Option<f64>,
    /// The machine that the predicted time is based on.
    pub predicted_of: TimesOf,
    /// Predicted share of voxels that differ from the reference: the median, and the range of nine of ten edits.
    pub predicted_error: Option<[f64; 3]>,
    /// Measured share of voxels that differ from the reference; `None` before it is measured.
    pub measured_error: Option<f64>,
    /// Columns and latent cells that were inpainted.
    pub region: Region,
    /// Tokens that were computed, of 625.
    pub tokens: Vec<usize>,
    /// Bricks that changed; the others were neither meshed nor cast again.
    pub bricks: Vec<usize>,
    edited: Arc<Scene>,
    result: Arc<GenResult>,
}

/// Counts of failures and near failures since the start.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stability {
    /// Number of generations.
    pub runs: usize,
    /// Generations with a fallback or a warning.
    pub fallbacks: usize,
    /// Generations that ended without a result.
    pub failures: usize,
    /// Failed generations in which a number was not finite.
    pub not_finite: usize,
    /// Changed voxels outside a region: must be 0.
    pub untouched_changed: usize,
}

/// Kind of a measurement in the background.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measuring {
    /// Times of the presets.
    Presets,
    /// Error of the last edit.
    Error,
}

/// State of the slider and its pane.
pub struct Tuning {
    /// The presets, with this machine's times if they were measured.
    pub presets: Presets,
    /// True if the times are of this machine and build.
    pub calibrated: bool,
    /// The last edit.
    pub last: Option<LastEdit>,
    /// Stability since the start.
    pub stability: Stability,
    /// True: draws the parts that were computed for the last edit in the bird's-eye view.
    pub show_modelled: bool,
    /// Outcome of the last measurement, one line.
    pub message: Option<String>,
    /// Ratios of the times of the last edits to those without other load: the window draws on the same cores.
    slower: VecDeque<f64>,
    /// True if the presets were measured on this machine's processor.
    is_like_this: bool,
    running: Option<(Measuring, Measurement, (usize, usize))>,
    file: Option<PathBuf>,
}

impl Tuning {
    /// The state with the times measured on this machine before, if their file (beside the settings) is of this build.
    pub fn new(settings_file: Option<&Path>) -> Self {
        let file = settings_file
            .and_then(Path::parent)
            .map(|f| f.join("calibration.json"));
        let shipped = Presets::bundled();
        let text = file
            .as_ref()
            .and_then(|f| input::read_text(f, input::LARGEST_TEXT).ok());
        let kept = text.and_then(|t| Presets::parse(&t, shipped.weights).ok());
        let ours = kept.filter(|s| s.machine == machine() && s.build == build());
        let is_like_this = shipped.machine == machine();
        Self {
            calibrated: ours.is_some(),
            presets: ours.unwrap_or(shipped),
            last: None,
            stability: Stability::default(),
            show_modelled: false,
            message: None,
            slower: VecDeque::new(),
            is_like_this,
            running: None,
            file,
        }
    }

    /// The running measurement, and its progress: steps done, all steps.
    pub fn measuring(&self) -> Option<(Measuring, usize, usize)> {
        self.running
            .as_ref()
            .map(|(what, _, (done, all))| (*what, *done, *all))
    }

    /// Starts timing the presets.
    pub fn calibrate(&mut self, wake: impl Fn() + Send + Sync + 'static) {
        self.start(
            Measuring::Presets,
            MeasurementTask::Calibrate(self.presets.clone()),
            wake,
        );
    }

    /// Starts to measure the distance of the last edit from the reference.
    pub fn refine(&mut self, wake: impl Fn() + Send + Sync + 'static) {
        let (Some(last), Some(reference)) = (&self.last, self.presets.named("reference")) else {
            return;
        };
        let task = MeasurementTask::Refine(Box::new(Refine {
            edited: last.edited.clone(),
            params: last.params.clone(),
            result: last.result.occupancy.clone(),
            reference: reference.clone(),
        }));
        self.start(Measuring::Error, task, wake);
    }

    fn start(&mut self, what: Measuring, task: MeasurementTask, wake: impl Fn() + Send + Sync + 'static) {
        self.message = None;
        match Measurement::start(task, wake) {
            Ok(background) => self.running = Some((what, background, (0, 0))),
            Err(error) => self.message = Some(tf!("Nothing can be measured: {error}", error = error)),
        }
    }

    /// Stops the measurement.
    pub fn stop(&mut self) {
        self.running = None;
    }

    /// Takes in the news of the measurement.
    pub fn update(&mut self) {
        while let Some(news) = self.running.as_ref().and_then(|(_, b, _)| b.next()) {
            match news {
                CalibrationEvent::Progress(done, all) => {
                    if let Some((_, _, progress)) = &mut self.running {
                        *progress = (done, all);
                    }
                }
                CalibrationEvent::Calibrated(presets, same) => {
                    self.running = None;
                    (self.presets, self.calibrated) = (presets, true);
                    let errors = if same {
                        t("results are bit for bit those whose errors are known")
                    } else {
                        t(
                            "results differ in bits from those whose errors are known: `sceneloom trade` measures errors here",
                        )
                    };
                    self.message = Some(match self.keep() {
                        Ok(()) => tf!("Calibrated; {results}", results = errors),
                        Err(error) => tf!(
                            "Calibrated until the window closes: {error}; {results}",
                            error = error,
                            results = errors,
                        ),
                    });
                }
                CalibrationEvent::Refined(error) => {
                    self.running = None;
                    if let Some(last) = &mut self.last {
                        last.measured_error = Some(error);
                    }
                }
                CalibrationEvent::Failed(line) => {
                    self.running = None;
                    self.message = Some(line);
                }
            }
        }
    }

    fn keep(&self) -> Result<(), String> {
        let Some(file) = &self.file else { return Ok(()) };
        let write = || -> anyhow::Result<()> {
            std::fs::create_dir_all(file.parent().unwrap_or(Path::new(".")))?;
            calibration::plan::write_presets(file, &self.presets)
        };
        write().map_err(|e| e.to_string())
    }

    /// Factor between the times of edits in this window and those without other load: the median of the last edits.
    pub fn window_factor(&self) -> f64 {
        let known: Vec<f64> = self.slower.iter().copied().collect();
        if known.is_empty() {
            return 1.0;
        }
        median(&known).clamp(0.25, 20.0)
    }

    /// The machine that predictions are based on now. Edits in this window give times of this machine.
    pub fn times_of(&self) -> TimesOf {
        match (self.calibrated || !self.slower.is_empty(), self.is_like_this) {
            (true, _) => TimesOf::ThisMachine,
            (false, true) => TimesOf::OneLikeIt,
            (false, false) => TimesOf::Another,
        }
    }

    /// Predicted wall time of an edit of so many tokens in this window, s.
    pub fn predicted_s(&self, preset: &Preset, tokens: f64) -> f64 {
        preset.cost.wall_s(tokens) * self.window_factor()
    }

    /// Tokens of the last edit; of a typical one before the first edit.
    pub fn tokens_of_next(&self) -> f64 {
        self.last
            .as_ref()
            .map_or(TYPICAL_TOKENS, |l| l.local_tokens as f64)
    }

    /// Predicted time of an edit like the last one with these parameters, s; 0 if they are not those of a preset.
    pub fn predicted_now_s(&self, params: &GenParams) -> f64 {
        let preset = self.current(params).map(|i| &self.presets.all[i]);
        preset.map_or(0.0, |preset| self.predicted_s(preset, self.tokens_of_next()))
    }

    /// Name of each preset, with its predicted cost.
    pub fn predicted(&self) -> Vec<(String, String)> {
        let tokens = self.tokens_of_next();
        let line = |s: &Preset| predicted(s, self.predicted_s(s, tokens), self.times_of());
        let of = |s: &Preset| (s.name.clone(), line(s));
        self.presets.all.iter().map(of).collect()
    }

    /// Index of the preset that has these parameters.
    pub fn current(&self, params: &GenParams) -> Option<usize> {
        self.presets.index_of(params)
    }

    /// Notes the result of an edit. `edited` is the scene with the edit, before the result.
    pub fn note(&mut self, edited: Arc<Scene>, result: Arc<GenResult>, settled_s: f64) {
        let (params, report) = (result.key.params.clone(), result.report.clone());
        let predicted_of = self.times_of();
        self.stability.runs += 1;
        self.stability.fallbacks += usize::from(!report.notes.is_empty());
        self.stability.untouched_changed += report.untouched_voxels_changed;
        // A measurement of the edit before does not apply to this one.
        let beside = self.running.is_some();
        if self
            .measuring()
            .is_some_and(|(what, ..)| what == Measuring::Error)
        {
            self.running = None;
            self.message = Some(t("The measurement stopped: another edit came").into());
        }
        // The presets were measured on edits, not on regions inpainted from fresh noise.
        let preset = self.current(&params).filter(|_| params.strength == 0.0);
        let preset = preset.map(|i| self.presets.all[i].clone());
        let preset = preset.as_ref();
        let region = inpaint::region_of(edited.frame(), &params);
        let all = OccModels::TOKENS;
        let local = tokens_of(&region.latent_cells, params.halo_tokens as usize);
        let local_tokens = local.len();
        let tokens = match report.tokens >= all {
            true => (0..all).collect(),
            false => local,
        };
        let tokens_computed = report.tokens as f64;
        let predicted_s = preset.map(|s| {
            let inverted = if report.inversion_calls > 0 {
                s.invert_s
            } else {
                0.0
            };
            self.predicted_s(s, tokens_computed) + inverted * self.window_factor()
        });
        if let Some(quiet_s) = preset.map(|s| s.cost.wall_s(tokens_computed))
            && report.inversion_calls == 0
            && !beside // a measurement uses the same cores
            && quiet_s > 0.0
            && report.network_calls > 0
        {
            self.slower.push_back(report.total_s() / quiet_s);
            if self.slower.len() > REMEMBERED {
                self.slower.pop_front();
            }
        }
        self.last = Some(LastEdit {
            local_tokens,
            predicted_s,
            predicted_of,
            predicted_error: preset.map(|s| [s.error.median, s.error_of_one[0], s.error_of_one[1]]),
            measured_error: None,
            bricks: edited.frame().source.occupancy.changed_bricks(&result.occupancy),
            params,
            report,
            settled_s,
            region,
            tokens,
            edited,
            result,
        });
    }

    /// Notes that a generation failed.
    pub fn note_failure(&mut self, line: &str) {
        self.stability.runs += 1;
        self.stability.failures += 1;
        self.stability.not_finite += usize::from(line.contains("expected finite"));
    }

    /// Forgets the last edit, because another scene was opened.
    pub fn reset(&mut self) {
        self.last = None;
        if self
            .measuring()
            .is_some_and(|(what, ..)| what == Measuring::Error)
        {
            self.running = None;
        }
    }
}
