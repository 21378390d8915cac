//! `eval forecast`: forecasts of drives. Of each drive through a held-out world the first two frames are known. The
//! other six are forecast by the temporal networks and by the methods that they must beat, and compared with the frames
//! that came.

mod figures;
mod methods;
mod stacks;

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::suite::{Options, SuiteFigures, with_interval};
use authoring::drives::{FRAMES, STEP_S, drive_scene_of, frames_of};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use figures::{ForecastFigures, flicker, shape_spread};
use job::pipeline::OccPipeline;
use methods::{Drives, KNOWN, METHODS, Wish};
use metrics::extractor::Extractor;
use metrics::iou::Confusion;
use metrics::local::Windows;
use scene::VoxelGrid;
use stacks::Stack;

/// One comparison of all methods.
struct Comparison {
    name: &'static str,
    /// Source of the layouts of the frames to come: the layouts that came, or those expected from the last known frame.
    wish: Wish,
    /// Frames of a drive.
    frames: usize,
    /// Frames that are compared with what came, by their time after the last known one.
    compared: &'static [(&'static str, usize)],
    /// Stride: one of so many drives is taken.
    every: usize,
}

const COMPARISONS: [Comparison; 3] = [
    Comparison {
        name: "layouts that came",
        wish: Wish::Came,
        frames: FRAMES,
        compared: &[("1 s", 3), ("2 s", 5), ("3 s", 7)],
        every: 1,
    },
    Comparison {
        name: "layouts expected",
        wish: Wish::Expected,
        frames: FRAMES,
        compared: &[("1 s", 3), ("2 s", 5), ("3 s", 7)],
        every: 1,
    },
    Comparison {
        name: "rollout over 14 frames, layouts that came",
        wish: Wish::Came,
        frames: 2 * FRAMES - KNOWN,
        compared: &[("2 s", 5), ("4 s", 9), ("6 s", 13)],
        every: 2,
    },
];

/// Results of a method.
#[derive(Default)]
struct ForecastScores {
    rows: ForecastFigures,
    places: Vec<Windows>,
}

impl Options {
    /// Runs all comparisons.
    pub(crate) fn forecast(
        &self,
        pipeline: &OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<SuiteFigures> {
        let drives = Drives::new(pipeline.models(), self.weights.as_deref())?;
        let extractor = Extractor::bundled()?;
        let mut report = serde_json::Map::new();
        for comparison in &COMPARISONS {
            let rows = self.compare(comparison, (&drives, &extractor), progress)?;
            report.insert(comparison.name.to_owned(), rows);
        }
        report.insert("step_s".into(), json!(STEP_S));
        Ok((report.into(), Vec::new()))
    }

    fn compare(
        &self,
        comparison: &Comparison,
        (drives, extractor): (&Drives<'_>, &Extractor),
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<Value> {
        let mut made: BTreeMap<&str, ForecastScores> = BTreeMap::new();
        let mut came: Vec<Windows> = Vec::new();
        let count = self.frames.div_ceil(comparison.every);
        for i in 0..count {
            progress.at(comparison.name, i, count);
            let scene = drive_scene_of(TEST_SEED, i as u64, comparison.frames, |_| None);
            let truth = frames_of(&scene).0;
            let later: Vec<VoxelGrid> = truth[KNOWN..].iter().map(|f| f.dense.clone()).collect();
            came.push(Stack::from_frames(extractor, &later)?.places());
            for method in METHODS {
                let Some(found) = drives.forecast(method, &truth, comparison.wish, i as u64)? else {
                    continue;
                };
                let ForecastScores { rows, places } = made.entry(method.name).or_default();
                for (name, at) in comparison.compared {
                    let mut one = Confusion::default();
                    one.add(&truth[*at].dense, &found[at - KNOWN]);
                    rows.add(&format!("mIoU {name}"), one.mean_iou().0);
                    rows.add(&format!("IoU {name}"), one.occupied_iou());
                }
                rows.add("flicker", flicker(&truth[KNOWN..], &found));
                rows.add("shape spread", shape_spread(&truth[KNOWN..], &found));
                let stack = Stack::from_frames(extractor, &found)?;
                rows.add("steadiness", Some(stack.steadiness()));
                places.push(stack.places());
            }
        }
        let report = |made: &ForecastScores| -> anyhow::Result<Value> {
            let mut row = made.rows.report();
            if count >= 2 {
                let [frechet, kernel] = stacks::distances(&came, &made.places)?;
                row["stack Fréchet"] = json!(frechet);
                row["stack kernel"] = json!(kernel);
            }
            Ok(row)
        };
        let rows: anyhow::Result<serde_json::Map<String, Value>> = made
            .iter()
            .map(|(name, made)| Ok(((*name).to_owned(), report(made)?)))
            .collect();
        Ok(rows?.into())
    }
}

/// The report as a table.
pub(crate) fn table(report: &Value) -> String {
    let mut out = String::new();
    for Comparison { name: kind, .. } in COMPARISONS {
        out += &format!("{kind}\n");
        let Some(rows) = report[kind].as_object() else {
            continue;
        };
        let names: Vec<&String> = rows
            .values()
            .next()
            .and_then(Value::as_object)
            .map_or(Vec::new(), |r| r.keys().collect());
        out += &format!("{:22}", "");
        names.iter().for_each(|n| out += &format!("{n:>15}"));
        out.push('\n');
        for method in METHODS {
            let Some(row) = rows.get(method.name) else {
                continue;
            };
            out += &format!("{:22}", method.name);
            for name in &names {
                let (mean, ci) = (&row[*name]["mean"], &row[*name]["ci95"]);
                let cell = format!(
                    "{:.3} ± {:.3}",
                    mean.as_f64().unwrap_or(f64::NAN),
                    ci.as_f64().unwrap_or(f64::NAN)
                );
                out += &format!("{cell:>15}");
            }
            out.push('\n');
        }
    }
    out
}

/// Rows of a report.
impl ForecastFigures {
    fn report(&self) -> Value {
        self.0
            .iter()
            .map(|(name, values)| (name.clone(), with_interval(values)))
            .collect()
    }
}
