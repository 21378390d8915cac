//! Progress on stderr: stage, step and time left, only on a terminal or when asked for.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::Instant;

use super::Common;
use job::{JobCtx, JobUpdate};

/// Draws one line over itself.
pub struct ProgressLine {
    shown: bool,
    state: Mutex<(String, Instant)>,
}

impl calibration::MeasurementProgress for ProgressLine {
    fn at(&self, stage: &str, step: usize, steps: usize) {
        Self::at(self, stage, step, steps);
    }
}

impl ProgressLine {
    /// Shown if stderr is a terminal or `--progress` was given.
    pub fn new(common: &Common) -> Self {
        let shown = common.progress || std::io::stderr().is_terminal();
        Self {
            shown,
            state: Mutex::new((String::new(), Instant::now())),
        }
    }

    /// `step` of `steps` of `stage` are done.
    pub fn at(&self, stage: &str, step: usize, steps: usize) {
        if !self.shown {
            return;
        }
        let Ok(mut state) = self.state.lock() else { return };
        if state.0 != stage {
            *state = (stage.into(), Instant::now());
        }
        let spent = state.1.elapsed().as_secs_f64();
        let left = if step > 0 {
            spent / step as f64 * (steps.max(step) - step) as f64
        } else {
            0.0
        };
        let filled = 20 * step / steps.max(1);
        let bar: String = (0..20).map(|i| if i < filled { '#' } else { '.' }).collect();
        eprint!("\r\x1b[K{stage:<10} [{bar}] {step}/{steps}  {left:.1} s left");
        let _ = std::io::stderr().flush();
    }

    /// Clears the line.
    pub fn done(&self) {
        if self.shown {
            eprint!("\r\x1b[K");
        }
    }

    /// Runs a generation with this as its listener.
    pub fn with_ctx<T>(&self, run: impl FnOnce(&JobCtx<'_>) -> T) -> T {
        let report = |update: JobUpdate| {
            if let JobUpdate::Progress { stage, step, steps } = update {
                self.at(stage.name(), step, steps);
            }
        };
        let out = run(&JobCtx::new(&|| false, &report));
        self.done();
        out
    }
}

/// A time for a person: `40 s`, `3 min`, `2 h`, to the accuracy that a forecast has.
pub fn in_words(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{:.0} s", (s / 5.0).ceil() * 5.0),
        s if s < 6000.0 => format!("{:.0} min", (s / 60.0).ceil()),
        s => format!("{:.0} h", (s / 3600.0).ceil()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_as_exact_as_forecasts_are() {
        let words = [21.0, 99.0, 101.0, 150.0, 7300.0].map(in_words);
        assert_eq!(words, ["25 s", "100 s", "2 min", "3 min", "3 h"]);
    }
}
