//! `eval forecast`: how a drive goes on. Of drives through held-out worlds the first two frames are known; the other six are
//! forecast by the temporal networks and by what they must beat, and compared with what came.

mod figures;
mod methods;

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::Progress;
use crate::held_out::TEST_SEED;
use crate::suite::{Found, Options, with_interval};
use authoring::drives::{STEP_S, drive_scene, frames_of};
use figures::{Rows, flicker, shape_spread, steadiness};
use job::pipeline::OccPipeline;
use methods::{Drives, KNOWN, METHODS, Wish};
use metrics::extractor::Extractor;
use metrics::iou::Confusion;

/// Frames that are compared: one, two and three seconds after the last known one.
const COMPARED: [(&str, usize); 3] = [("1 s", 3), ("2 s", 5), ("3 s", 7)];
/// Which layouts the frames to come are drawn from: those that came, or those that the last frame lets expect.
const LAYOUTS: [(&str, Wish); 2] = [
    ("layouts that came", Wish::Came),
    ("layouts expected", Wish::Expected),
];

impl Options {
    /// Forecasts, side by side.
    pub(crate) fn forecast(&self, pipeline: &OccPipeline, progress: &dyn Progress) -> anyhow::Result<Found> {
        let drives = Drives::new(pipeline.models(), self.weights.as_deref())?;
        let extractor = Extractor::bundled()?;
        let mut report = serde_json::Map::new();
        let mut rows: BTreeMap<(usize, &str), Rows> = BTreeMap::new();
        for i in 0..self.frames {
            progress.at("forecast", i, self.frames);
            let scene = drive_scene(TEST_SEED, i as u64, |_| None);
            let truth = frames_of(&scene).0;
            for (kind, (_, wish)) in LAYOUTS.iter().enumerate() {
                for method in METHODS {
                    let Some(found) = drives.forecast(method, &truth, *wish, i as u64)? else {
                        continue;
                    };
                    let row = rows.entry((kind, method.name)).or_default();
                    for (name, at) in COMPARED {
                        let mut one = Confusion::default();
                        one.add(&truth[at].dense, &found[at - KNOWN]);
                        row.add(&format!("mIoU {name}"), one.mean_iou().0);
                        row.add(&format!("IoU {name}"), one.occupied_iou());
                    }
                    row.add("flicker", flicker(&truth[KNOWN..], &found));
                    row.add("shape spread", shape_spread(&truth[KNOWN..], &found));
                    row.add("steadiness", Some(steadiness(&extractor, &found)?));
                }
            }
        }
        for (kind, (name, _)) in LAYOUTS.iter().enumerate() {
            let of_kind: serde_json::Map<String, Value> = rows
                .iter()
                .filter(|((k, _), _)| *k == kind)
                .map(|((_, method), row)| ((*method).to_owned(), row.report()))
                .collect();
            report.insert((*name).to_owned(), of_kind.into());
        }
        report.insert("step_s".into(), json!(STEP_S));
        Ok((report.into(), Vec::new()))
    }
}

/// The report as a table.
pub(crate) fn table(report: &Value) -> String {
    let mut out = String::new();
    for (kind, _) in LAYOUTS {
        out += &format!("{kind}\n");
        let Some(rows) = report[kind].as_object() else {
            continue;
        };
        let names: Vec<&String> = rows
            .values()
            .next()
            .and_then(Value::as_object)
            .map_or(Vec::new(), |r| r.keys().collect());
        out += &format!("{:28}", "");
        names.iter().for_each(|n| out += &format!("{n:>16}"));
        out.push('\n');
        for method in METHODS {
            let Some(row) = rows.get(method.name) else {
                continue;
            };
            out += &format!("{:28}", method.name);
            for name in &names {
                let (mean, ci) = (&row[*name]["mean"], &row[*name]["ci95"]);
                let cell = format!(
                    "{:.3} ± {:.3}",
                    mean.as_f64().unwrap_or(f64::NAN),
                    ci.as_f64().unwrap_or(f64::NAN)
                );
                out += &format!("{cell:>16}");
            }
            out.push('\n');
        }
    }
    out
}

/// A row for a report.
impl Rows {
    fn report(&self) -> Value {
        self.0
            .iter()
            .map(|(name, values)| (name.clone(), with_interval(values)))
            .collect()
    }
}
