//! The table of suites: what each measures, on how much data, and which figures of its report are shown.

use anyhow::bail;
use serde_json::{Value, json};

pub use crate::options::Options;

use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use metrics::stats::mean_ci95;

/// One bar: name, figure, the least it should be.
pub type Bar = (&'static str, f64, f64);

/// A report with its bars.
pub(crate) type SuiteFigures = (Value, Vec<Bar>);

/// Mean, half width of its 95 % interval and number of values, for a report.
pub(crate) fn with_interval(values: &[f64]) -> Value {
    let (mean, half) = mean_ci95(values);
    let round = |v: f64| (v * 1e4).round() / 1e4;
    json!({ "mean": round(mean), "ci95": round(half), "n": values.len() })
}

/// A kind of evaluation.
pub struct Suite {
    /// Name on the command line.
    pub name: &'static str,
    /// Title in one line.
    pub title: &'static str,
    /// Figures of the report that are shown: name with unit, and JSON pointer to a number, to `mean` with `ci95`, or to `share`
    /// with `low` and `high`.
    pub figures: &'static [(&'static str, &'static str)],
    /// True if it judges the files of `--data`, where they are given.
    pub takes_data: bool,
    /// Makes options small, so that all suites together take about five minutes on two cores.
    pub quick: fn(&mut Options),
    /// The report as a table for a person, where JSON is hard to read.
    pub(crate) table: Option<fn(&Value) -> String>,
    /// Measures.
    pub(crate) run: fn(&Options, &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures>,
}

/// Outcome of a suite.
pub struct SuiteReport {
    /// The whole report, with `bars`, `seeds` and `n`.
    pub json: Value,
    /// Its bars.
    pub bars: Vec<Bar>,
}

/// True if a bar is missed; a figure that is not a number misses it.
fn is_missed((_, found, least): &Bar) -> bool {
    found.is_nan() || found < least
}

impl SuiteReport {
    /// The bars that were missed, in words.
    pub fn missed(&self) -> Vec<String> {
        let missed = self.bars.iter().filter(|b| is_missed(b));
        missed
            .map(|(name, found, least)| format!("{name} {found:.3} below {least}"))
            .collect()
    }
}

impl Suite {
    /// Runs it. Errors are one line: weights, files or options that will not do.
    pub fn measure(
        &self,
        options: &Options,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<SuiteReport> {
        if options.frames == 0 {
            bail!("--frames is 0, expected at least 1");
        }
        if options.data.is_some() && !self.takes_data {
            bail!(
                "--data is given, but {} makes its own: expected no --data",
                self.name
            );
        }
        let (mut json, bars) = (self.run)(options, progress)?;
        json["seeds"] = json!({ "test": TEST_SEED });
        let n = json.get("files").or(json.get("prompts")).cloned();
        json["n"] = n.unwrap_or_else(|| options.frames.into());
        json["bars"] = bars
            .iter()
            .map(|(name, found, least)| json!({ "name": name, "found": found, "least": least }))
            .collect();
        Ok(SuiteReport { json, bars })
    }

    /// The report for a person.
    pub fn text(&self, report: &Value) -> String {
        match self.table {
            Some(table) => table(report),
            None => serde_json::to_string_pretty(report).unwrap_or_default(),
        }
    }
}
