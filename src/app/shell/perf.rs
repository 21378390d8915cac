//! Performance measurements of the window: frame times, time from an edit to its first visible change, frames that
//! block the input, stages of the worker, processor time. The performance overlay shows them, and `--trace` writes them
//! (see `trace.rs`).

use std::collections::{BTreeMap, VecDeque};

use serde_json::json;

use super::trace::Trace;
use job::Stage;
use numeric::quantile::Sorted;

/// Frames longer than this noticeably block the input, s.
pub const BLOCKED_S: f64 = 0.05;
/// Time after the last input and the last work from which the window counts as idle, s.
pub const IDLE_AFTER_S: f64 = 2.0;
/// Most samples that quantiles are taken of; older ones are dropped.
const KEPT: usize = 20_000;
/// Number of frames that the overlay draws.
pub const SHOWN: usize = 160;

/// Median, 95th percentile and largest of some samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantiles {
    /// Number of samples ever taken.
    pub n: usize,
    /// Median.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

/// Samples of one quantity, s.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    newest: VecDeque<f64>,
    n: usize,
    max: f64,
}

impl Samples {
    /// Adds a sample; values that are not finite are left out.
    pub fn push(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.n += 1;
        self.max = self.max.max(value);
        if self.newest.len() == KEPT {
            self.newest.pop_front();
        }
        self.newest.push_back(value);
    }

    /// Nearest-rank quantiles of the newest samples, and the largest ever; all 0 without any.
    pub fn quantiles(&self) -> Quantiles {
        let sorted = Sorted::new(self.newest.iter().copied());
        let at = |part: f64| match self.newest.is_empty() {
            true => 0.0,
            false => sorted.quantile(part),
        };
        Quantiles {
            n: self.n,
            p50: at(0.5),
            p95: at(0.95),
            max: self.max,
        }
    }

    /// The newest samples, oldest first.
    pub fn newest(&self, count: usize) -> impl Iterator<Item = f64> + '_ {
        self.newest
            .iter()
            .skip(self.newest.len().saturating_sub(count))
            .copied()
    }
}

impl Quantiles {
    /// The quantiles in milliseconds, as JSON.
    fn ms(&self) -> serde_json::Value {
        json!({
            "n": self.n,
            "p50": round(self.p50 * 1e3),
            "p95": round(self.p95 * 1e3),
            "max": round(self.max * 1e3),
        })
    }
}

/// Rounds to a thousandth, because people read traces too.
fn round(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// An edit that is not visible yet.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pending {
    /// Made in the frame that began at this time; that frame still shows the state before.
    Made(f64),
    /// Drawn, in a frame that has not ended yet; the time is that of [`Self::Made`].
    Drawn(f64),
}

/// A frame being drawn.
#[derive(Clone, Copy, Debug)]
struct OngoingFrame {
    began_s: f64,
    /// Time spent waiting for the graphics card, only to measure; not counted as work, s.
    waited_s: f64,
    logic_s: f64,
    draw_s: f64,
    events: usize,
    working: bool,
}

/// All measurements.
#[derive(Default)]
pub struct Perf {
    /// True while the overlay is open.
    pub open: bool,
    /// Work of the main thread per frame, from layout to presentation, s.
    pub frames: Samples,
    /// Work of the main thread per frame while the worker generates, s.
    pub frames_while_working: Samples,
    /// Time from the beginning of the frame that took an input to the end of the frame that shows its effect, s.
    pub visible: Samples,
    /// Time from an edit to its generated result, s.
    pub settled: Samples,
    /// Number of frames that blocked the input: all, and those while the worker generates.
    pub blocked: [usize; 2],
    /// Share of one core that the process used recently; `None` if the system does not report it.
    pub cpu_share: Option<f64>,
    /// Time in each stage of the running job, or of the last one, s.
    pub stages: BTreeMap<&'static str, f64>,
    pub(crate) trace: Option<Trace>,
    frame: Option<OngoingFrame>,
    pending: Option<Pending>,
    stage: Option<(Stage, f64)>,
    cpu: Option<(f64, f64)>, // wall and processor time, s
    active_s: f64,
}

impl Perf {
    /// True if the overlay or a trace uses the measurements; latencies are then worth an extra frame.
    pub fn watches(&self) -> bool {
        self.open || self.trace.is_some()
    }

    /// Notes that a frame begins. `before_s` is the time of the frame before, presentation included (`None` if
    /// unknown). `wait` waits until the graphics card has drawn everything and returns the time after that.
    pub fn frame_begins(&mut self, now_s: f64, before_s: Option<f64>, wait: impl FnOnce() -> f64) {
        self.frame_ended(before_s);
        let mut began_s = now_s;
        if let Some(Pending::Drawn(at_s)) = self.pending {
            self.pending = None;
            // Without an overlay or a trace there is no wait, and no latency is measured.
            if self.watches() {
                began_s = wait();
                self.edit_visible(began_s, at_s);
            }
        }
        self.frame = Some(OngoingFrame {
            began_s,
            waited_s: began_s - now_s,
            logic_s: 0.0,
            draw_s: 0.0,
            events: 0,
            working: false,
        });
        if self.open {
            self.sample_cpu(now_s);
        }
    }

    fn edit_visible(&mut self, now_s: f64, at_s: f64) {
        let took_s = now_s - at_s;
        self.visible.push(took_s);
        self.tell(|| json!({"kind": "edit", "t_s": round(at_s), "visible_ms": round(took_s * 1e3)}));
    }

    /// Notes that the window closed the last frame; `took_s` is its time with presentation.
    fn frame_ended(&mut self, took_s: Option<f64>) {
        let Some(frame) = self.frame.take() else { return };
        let busy_s = (took_s.unwrap_or(0.0) - frame.waited_s).max(frame.logic_s + frame.draw_s);
        self.frames.push(busy_s);
        if frame.working {
            self.frames_while_working.push(busy_s);
        }
        if busy_s > BLOCKED_S {
            self.blocked[0] += 1;
            self.blocked[1] += usize::from(frame.working);
        }
        self.tell(|| {
            json!({
                "kind": "frame",
                "t_s": round(frame.began_s),
                "busy_ms": round(busy_s * 1e3),
                "waited_ms": round(frame.waited_s * 1e3),
                "logic_ms": round(frame.logic_s * 1e3),
                "draw_ms": round(frame.draw_s * 1e3),
                "events": frame.events,
                "working": frame.working,
            })
        });
    }

    /// Notes that so many new pictures of cameras came, and whether one of the camera shown large was among them.
    pub fn pictures(&self, now_s: f64, cameras: usize, large: bool) {
        self.tell(|| json!({ "kind": "pictures", "t_s": round(now_s), "cameras": cameras, "large": large }));
    }

    /// Notes that the news of the worker and of files were taken in.
    pub fn logic_done(&mut self, now_s: f64) {
        if let Some(frame) = &mut self.frame {
            frame.logic_s = now_s - frame.began_s;
        }
    }

    /// Notes that the frame was drawn and its commands were carried out. `events` counts events of the window system;
    /// `edited` is true if the scene changed, `active` if background work runs. Returns true if another frame is needed
    /// to measure when this one reached the screen.
    pub fn drawn(&mut self, now_s: f64, events: usize, edited: bool, active: bool, working: bool) -> bool {
        let Some(frame) = &mut self.frame else {
            return false;
        };
        frame.draw_s += (now_s - frame.began_s - frame.logic_s - frame.draw_s).max(0.0);
        frame.events += events;
        frame.working = working;
        let began_s = frame.began_s;
        self.pending = match self.pending {
            None if edited => Some(Pending::Made(began_s)),
            // The edit was made in the frame before; this frame shows it.
            Some(Pending::Made(at_s)) if at_s < began_s => Some(Pending::Drawn(at_s)),
            pending => pending,
        };
        if events > 0 || active || working {
            self.active_s = now_s;
        }
        if let Some(trace) = &self.trace {
            trace.active(self.active_s);
        }
        self.watches() && matches!(self.pending, Some(Pending::Drawn(_)))
    }

    /// Notes that a second pass of the same frame shows its edit.
    pub fn shown_at_once(&mut self) {
        if let Some(Pending::Made(at_s)) = self.pending {
            self.pending = Some(Pending::Drawn(at_s));
        }
    }

    /// Notes that the worker entered a stage.
    pub fn stage(&mut self, stage: Stage, now_s: f64) {
        if self.stage.is_some_and(|(of, _)| of == stage) {
            return;
        }
        self.end_stage(now_s);
        self.stage = Some((stage, now_s));
    }

    /// Notes that a job was submitted.
    pub fn job_begins(&mut self) {
        self.stage = None;
        self.stages.clear();
    }

    /// Notes that a job ended. `settled_s` is the time since the edit that it settles, if it settles one.
    pub fn job_ended(&mut self, now_s: f64, settled_s: Option<f64>, what: &str) {
        self.end_stage(now_s);
        if let Some(settled_s) = settled_s {
            self.settled.push(settled_s);
        }
        let stages = self.stages.clone();
        self.tell(|| {
            let stages: BTreeMap<_, _> = stages.iter().map(|(k, v)| (*k, round(*v * 1e3))).collect();
            json!({
                "kind": "job",
                "t_s": round(now_s),
                "end": what,
                "settled_ms": settled_s.map(|s| round(s * 1e3)),
                "stages_ms": stages,
            })
        });
    }

    fn end_stage(&mut self, now_s: f64) {
        if let Some((stage, since_s)) = self.stage.take() {
            *self.stages.entry(stage.name()).or_default() += now_s - since_s;
        }
    }

    fn sample_cpu(&mut self, now_s: f64) {
        const EVERY_S: f64 = 0.5;
        if self.cpu.is_some_and(|(at_s, _)| now_s - at_s < EVERY_S) {
            return;
        }
        let Some(used_s) = super::trace::cpu_time_s() else {
            return;
        };
        if let Some((at_s, before_s)) = self.cpu {
            self.cpu_share = Some((used_s - before_s) / (now_s - at_s));
        }
        self.cpu = Some((now_s, used_s));
    }

    fn tell(&self, line: impl FnOnce() -> serde_json::Value) {
        if let Some(trace) = &self.trace {
            trace.line(&line());
        }
    }

    /// Writes the summary and ends the trace, if there is one.
    pub fn finish(&mut self, before_s: Option<f64>) {
        self.frame_ended(before_s);
        let summary = self.summary();
        if let Some(trace) = self.trace.take() {
            trace.finish(summary);
        }
    }

    /// A summary of all measurements; the trace adds the processor time.
    pub fn summary(&self) -> serde_json::Value {
        json!({
            "kind": "summary",
            "frame_ms": self.frames.quantiles().ms(),
            "frame_while_working_ms": self.frames_while_working.quantiles().ms(),
            "edit_to_visible_ms": self.visible.quantiles().ms(),
            "edit_to_settled_ms": self.settled.quantiles().ms(),
            "frames_over_50_ms": self.blocked[0],
            "frames_over_50_ms_while_working": self.blocked[1],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_nearest_rank() {
        let mut samples = Samples::default();
        assert_eq!(samples.quantiles(), Quantiles::default());
        samples.push(f64::NAN);
        (1..=100).rev().for_each(|v| samples.push(f64::from(v)));
        let q = samples.quantiles();
        assert_eq!((q.n, q.p50, q.p95, q.max), (100, 50.0, 95.0, 100.0));
        (0..KEPT).for_each(|_| samples.push(1.0));
        let q = samples.quantiles();
        assert_eq!((q.p95, q.max), (1.0, 100.0), "old samples go, the largest stays");
    }

    /// The input arrives in one frame, the next frame shows it, and the frame after that measures when.
    #[test]
    fn an_edit_is_timed_to_the_end_of_the_frame_that_shows_it() {
        let mut perf = Perf {
            open: true,
            ..Perf::default()
        };
        perf.frame_begins(1.0, None, || 0.0);
        perf.logic_done(1.001);
        assert!(!perf.drawn(1.010, 3, true, false, false));
        perf.frame_begins(1.012, Some(0.011), || panic!("nothing was drawn yet"));
        perf.logic_done(1.013);
        assert!(perf.drawn(1.030, 0, false, false, true), "wants to know the end");
        let mut waited = false;
        perf.frame_begins(1.035, Some(0.060), || {
            waited = true;
            1.036
        });
        assert!(waited);
        let visible = perf.visible.quantiles();
        assert!(
            visible.n == 1 && (visible.max - 0.036).abs() < 1e-9,
            "{visible:?}"
        );
        assert_eq!(perf.blocked, [1, 1], "the second took 60 ms while the worker ran");
        assert_eq!(perf.frames.quantiles().n, 2);
        // A frame in two passes shows its own edit.
        perf.drawn(1.040, 1, true, false, false);
        perf.shown_at_once();
        assert!(perf.drawn(1.045, 0, false, false, false));
        perf.frame_begins(1.050, Some(0.012), || 1.050);
        assert!((perf.visible.newest(1).sum::<f64>() - 0.014).abs() < 1e-9);
    }

    #[test]
    fn stages_add_up() {
        let mut perf = Perf::default();
        perf.job_begins();
        perf.stage(Stage::Encode, 1.0);
        perf.stage(Stage::Denoise, 1.25);
        perf.stage(Stage::Denoise, 1.5);
        perf.stage(Stage::Decode, 2.0);
        perf.job_ended(2.5, Some(1.5), "finished");
        let of = |s: Stage| perf.stages[s.name()];
        assert_eq!(
            [of(Stage::Encode), of(Stage::Denoise), of(Stage::Decode)],
            [0.25, 0.75, 0.5]
        );
        assert_eq!(perf.summary()["edit_to_settled_ms"]["max"], 1500.0);
    }
}
