//! `--trace FILE`: the measurements of `perf.rs` as JSON lines. A thread of its own writes them, and samples the
//! processor time of the process once a second. The last line is a summary.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::Context;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, unbounded};
use serde_json::{Value, json};

use super::perf::IDLE_AFTER_S;

/// Time between two samples of the processor time.
const EVERY: Duration = Duration::from_secs(1);

enum TraceMessage {
    Line(String),
    Finish(Value),
}

/// A trace that is being written.
pub struct Trace {
    orders: Sender<TraceMessage>,
    active_ms: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
}

impl Trace {
    /// Creates the file and starts the thread. All times are counted from `clock`. Errors name the file.
    pub fn start(path: &Path, clock: Instant, first: &Value) -> anyhow::Result<Self> {
        let file = File::create(path).with_context(|| format!("trace {}", path.display()))?;
        let mut out = BufWriter::new(file);
        writeln!(out, "{first}").with_context(|| format!("trace {}", path.display()))?;
        let (orders, orders_in) = unbounded();
        let active_ms = Arc::new(AtomicU64::new(0));
        let seen = active_ms.clone();
        let work = move || write(out, &orders_in, &seen, clock);
        // A panic has been printed by then; the editor goes on without a trace, as with a full disk.
        let thread = runtime::guard::spawn("trace", work, drop).context("trace")?;
        Ok(Self {
            orders,
            active_ms,
            thread: Some(thread),
        })
    }

    /// Adds a line.
    pub fn line(&self, value: &Value) {
        // The thread ends early only if the disk is full; the editor goes on without a trace.
        let _ = self.orders.send(TraceMessage::Line(value.to_string()));
    }

    /// Notes the time at which the window was last active, s.
    pub fn active(&self, at_s: f64) {
        self.active_ms.store((at_s * 1e3) as u64, Ordering::Relaxed);
    }

    /// Adds the summary, with the processor time, and closes the file.
    pub fn finish(mut self, summary: Value) {
        let _ = self.orders.send(TraceMessage::Finish(summary));
        if let Some(thread) = self.thread.take() {
            // An error would be a panic in the thread, and the trace is ending.
            let _ = thread.join();
        }
    }
}

/// Wall and processor time, s.
#[derive(Clone, Copy, Default)]
struct Used {
    wall_s: f64,
    cpu_s: f64,
}

impl Used {
    fn share(self) -> Option<f64> {
        (self.wall_s > 0.0).then(|| (self.cpu_s / self.wall_s * 1e4).round() / 1e4)
    }
}

fn write(mut out: BufWriter<File>, orders: &Receiver<TraceMessage>, active_ms: &AtomicU64, clock: Instant) {
    let now_s = || clock.elapsed().as_secs_f64();
    let mut before = cpu_time_s().map(|cpu_s| (now_s(), cpu_s));
    let (mut all, mut idle) = (Used::default(), Used::default());
    let mut due = Instant::now() + EVERY;
    loop {
        let order = orders.recv_timeout(due.saturating_duration_since(Instant::now()));
        let done = match order {
            Ok(TraceMessage::Line(line)) => writeln!(out, "{line}"),
            Ok(TraceMessage::Finish(mut summary)) => {
                summary["cpu_share"] = json!(all.share());
                summary["idle_s"] = json!((idle.wall_s * 10.0).round() / 10.0);
                summary["idle_cpu_share"] = json!(idle.share());
                // A full disk cannot be reported any more.
                let _ = writeln!(out, "{summary}").and_then(|()| out.flush());
                return;
            }
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => Ok(()),
        };
        if done.is_err() {
            return;
        }
        if Instant::now() < due {
            continue;
        }
        due = Instant::now() + EVERY;
        let (Some(cpu_s), Some((at_s, before_s))) = (cpu_time_s(), before) else {
            continue;
        };
        let now_s = now_s();
        let step = Used {
            wall_s: now_s - at_s,
            cpu_s: cpu_s - before_s,
        };
        // An interval counts as idle only if all of it was idle.
        let active_s = active_ms.load(Ordering::Relaxed) as f64 / 1e3;
        let was_idle = at_s >= active_s + IDLE_AFTER_S;
        for sum in std::iter::once(&mut all).chain(was_idle.then_some(&mut idle)) {
            sum.wall_s += step.wall_s;
            sum.cpu_s += step.cpu_s;
        }
        before = Some((now_s, cpu_s));
        let line = json!({"kind": "cpu", "t_s": (now_s * 1e3).round() / 1e3, "share": step.share(), "idle": was_idle});
        if writeln!(out, "{line}").and_then(|()| out.flush()).is_err() {
            return;
        }
    }
}

/// Processor time of all threads of the process, s; `None` without `/proc`. proc(5): fields 14 and 15 of `stat`, in
/// ticks of 1/100 s.
pub fn cpu_time_s() -> Option<f64> {
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in brackets, may contain spaces.
    let (_, rest) = stat.rsplit_once(')')?;
    let mut fields = rest.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / TICKS_PER_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trace_is_lines_of_json_with_a_summary() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("trace.jsonl");
        let clock = Instant::now();
        let trace = Trace::start(&path, clock, &json!({"kind": "start"})).expect("started");
        for i in 0..50 {
            trace.line(&json!({"kind": "frame", "i": i}));
        }
        // Time for two samples of the processor time.
        std::thread::sleep(EVERY * 2 + EVERY / 4);
        trace.finish(json!({"kind": "summary"}));
        let text = std::fs::read_to_string(&path).expect("written");
        let lines: Vec<Value> = text
            .lines()
            .map(|l| serde_json::from_str(l).expect("JSON"))
            .collect();
        let kinds = |kind: &str| lines.iter().filter(|l| l["kind"] == kind).count();
        assert_eq!((kinds("start"), kinds("frame"), kinds("summary")), (1, 50, 1));
        assert_eq!(lines.last().expect("lines")["kind"], "summary");
        if cpu_time_s().is_some() {
            assert!(kinds("cpu") >= 1);
            assert!(lines.last().expect("lines")["cpu_share"].is_number());
        }
        // A panic of the thread ends the trace only.
        runtime::guard::panic_next("trace");
        let trace = Trace::start(&path, clock, &json!({"kind": "start"})).expect("started");
        trace.line(&json!({}));
        trace.finish(json!({"kind": "summary"}));
        let nowhere = folder.path().join("no").join("such").join("folder");
        let error = Trace::start(&nowhere, clock, &json!({})).err().expect("refused");
        assert!(format!("{error:#}").contains("trace "), "{error:#}");
    }
}
