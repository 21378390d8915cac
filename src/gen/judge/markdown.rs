//! Runs all suites one after another and writes their figures as Markdown: `docs/figures.md` is made of it.

use std::fmt::Write;
use std::time::Instant;

use serde_json::{Value, json};

use crate::origin::Origin;
use crate::suite::{Options, Suite, SuiteReport};
use calibration::MeasurementProgress;

/// A figure of a suite.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureRow {
    /// Name of the figure.
    pub figure: String,
    /// Its value; `None` if the run was too small to give one.
    pub value: Option<f64>,
    /// Its 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// Number of values behind it, if they were counted.
    pub n: Option<u64>,
    /// The bar: the least that it should be.
    pub least: Option<f64>,
}

/// Outcome of a suite.
pub struct MeasuredSuite {
    /// Its name.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The command line that measures this suite alone.
    pub command: String,
    /// Time it took, s.
    pub wall_s: f64,
    /// Report and rows, or one line that says why it was not measured.
    pub found: Result<(SuiteReport, Vec<FigureRow>), String>,
}

/// The row of a value of a report: a number, a mean with the half width of its interval, or a share with its interval.
fn row(figure: &str, value: Option<&Value>) -> FigureRow {
    let number = |name: &str| value.and_then(|v| v.get(name)?.as_f64());
    let plain = value.and_then(Value::as_f64);
    let around = number("mean")
        .zip(number("ci95"))
        .map(|(mean, half)| [mean - half, mean + half]);
    let n = value.and_then(|v| v.get("n")?.as_u64());
    if n == Some(0) {
        // A mean over no values is left out.
        return FigureRow {
            figure: figure.to_owned(),
            value: None,
            interval: None,
            n,
            least: None,
        };
    }
    FigureRow {
        figure: figure.to_owned(),
        value: plain.or_else(|| number("mean")).or_else(|| number("share")),
        interval: around.or_else(|| number("low").zip(number("high")).map(|(low, high)| [low, high])),
        n,
        least: None,
    }
}

/// The figures of a suite that are shown, then its bars.
fn rows(suite: &Suite, report: &SuiteReport) -> Vec<FigureRow> {
    let shown = suite
        .figures
        .iter()
        .map(|(name, at)| row(name, report.json.pointer(at)));
    let bars = report.bars.iter().map(|(name, found, least)| FigureRow {
        figure: (*name).to_owned(),
        value: found.is_finite().then_some(*found),
        interval: None,
        n: None,
        least: Some(*least),
    });
    shown.chain(bars).collect()
}

/// The command line that runs a suite alone; names the options that differ from the defaults.
fn command(suite: &Suite, options: &Options) -> String {
    let usual = Options::default();
    let mut out = format!("sceneloom eval {} --frames {}", suite.name, options.frames);
    let mut number = |name: &str, value: usize, usual: usize| {
        if value != usual {
            let _ = write!(out, " --{name} {value}");
        }
    };
    number("vehicles", options.vehicles, usual.vehicles);
    number("band-worlds", options.band_worlds, usual.band_worlds);
    number("random-edits", options.random_edits, usual.random_edits);
    number("scheme-frames", options.scheme_frames, usual.scheme_frames);
    number(
        "reference-frames",
        options.reference_frames,
        usual.reference_frames,
    );
    number("sentences", options.sentences.unwrap_or(0), 0);
    number("placer-prompts", options.placer_prompts, usual.placer_prompts);
    for (name, path) in [
        ("data", &options.data),
        ("prompts", &options.prompts),
        ("weights", &options.weights),
    ] {
        if let Some(path) = path {
            let _ = write!(out, " --{name} {}", calibration::machine::told(path));
        }
    }
    if !options.presets.is_empty() {
        let _ = write!(out, " --presets {}", options.presets.join(","));
    }
    if options.rows_only {
        out += " --rows-only";
    }
    out
}

/// Runs suites one after another, each with its own options. A suite that cannot run does not stop the others.
pub fn measure_all(
    suites: impl Iterator<Item = &'static Suite>,
    options: &dyn Fn(&Suite) -> Options,
    progress: &dyn MeasurementProgress,
) -> Vec<MeasuredSuite> {
    let measure = |suite: &'static Suite| {
        let options = options(suite);
        let start = Instant::now();
        let found = suite.measure(&options, progress);
        MeasuredSuite {
            name: suite.name,
            title: suite.title,
            command: command(suite, &options),
            wall_s: start.elapsed().as_secs_f64(),
            found: match found {
                Ok(report) => {
                    let rows = rows(suite, &report);
                    Ok((report, rows))
                }
                Err(error) => Err(format!("{error:#}").replace('\n', "; ")),
            },
        }
    };
    suites.map(measure).collect()
}

impl MeasuredSuite {
    /// JSON of the table for a report of all suites.
    pub fn json(&self) -> Value {
        let mut out = match &self.found {
            Ok((report, _)) => report.json.clone(),
            Err(error) => json!({ "error": error }),
        };
        out["command"] = self.command.as_str().into();
        out["suite_wall_s"] = self.wall_s.into();
        out
    }
}

/// Four digits behind the point for small numbers, fewer for larger ones; whole numbers whole.
fn number(value: f64) -> String {
    match value.abs() {
        v if v.fract() == 0.0 && v < 1e9 => format!("{value:.0}"),
        v if v >= 100.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        v if v >= 0.01 => format!("{value:.3}"),
        _ => format!("{value:.2e}"),
    }
}

/// Text that a cell of a table may hold.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// The figures as Markdown: where they come from, then a section a suite.
pub fn markdown(origin: &Origin, tables: &[MeasuredSuite]) -> String {
    let mut out = String::from("# Figures\n\n");
    let Origin {
        commit,
        date,
        machine,
        cores,
        command,
    } = origin;
    let _ = write!(
        out,
        "Made by `{command}`; do not edit.\n\n- Commit: {commit}\n- Date: {date} (UTC)\n- Machine: {machine}, {cores} cores\n"
    );
    out += "\nIntervals are 95 % over scenes. A bar is the least that a figure should be.\n";
    for table in tables {
        let _ = write!(out, "\n## {}: {}\n\n`{}`", table.name, table.title, table.command);
        match &table.found {
            Err(error) => {
                let _ = write!(out, "\n\nNot measured: {}\n", cell(error));
            }
            Ok((report, rows)) => {
                let _ = write!(out, " (n = {}, {:.0} s)\n\n", report.json["n"], table.wall_s);
                out += "| figure | found | 95 % interval | n | bar |\n|---|---:|---:|---:|---|\n";
                rows.iter().for_each(|row| out += &line(row));
            }
        }
    }
    out
}

/// One line of a table.
fn line(row: &FigureRow) -> String {
    let found = row.value.map_or("–".into(), number);
    let interval = row.interval.map_or(String::new(), |[low, high]| {
        format!("{} to {}", number(low), number(high))
    });
    let n = row.n.map_or(String::new(), |n| n.to_string());
    let bar = row.least.map_or(String::new(), |least| {
        let missed = row.value.is_none_or(|found| found < least);
        format!("≥ {}{}", number(least), if missed { ", **missed**" } else { "" })
    });
    format!("| {} | {found} | {interval} | {n} | {bar} |\n", cell(&row.figure))
}

#[cfg(test)]
#[path = "markdown_tests.rs"]
mod tests;
