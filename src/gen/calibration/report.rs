//! The report on each setting, as JSON and for a person.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::edits::CaseOutcome;
use super::figures::{percent, seconds};
use super::sensors::SettingMeasurement;
use super::settings::CandidateSetting;
use numeric::quantile::{median, quantile};
use trade::{Cost, SizedTime, TradePoint, bootstrap_median};

/// A setting with its outcomes, as a row of the report.
pub(super) struct SettingOutcomes {
    pub(super) setting: CandidateSetting,
    pub(super) outcomes: Vec<CaseOutcome>,
}

impl SettingOutcomes {
    pub(super) fn all(&self, of: impl Fn(&CaseOutcome) -> f64) -> Vec<f64> {
        self.outcomes.iter().map(of).collect()
    }

    pub(super) fn point(&self) -> TradePoint {
        TradePoint {
            wall_s: bootstrap_median(&self.all(|o| median(&o.wall_s)), 1),
            error: bootstrap_median(&self.all(|o| o.error), 2),
        }
    }

    pub(super) fn cost(&self) -> Option<Cost> {
        let times = self.outcomes.iter().map(|o| SizedTime {
            tokens: o.tokens as f64,
            wall_s: median(&o.wall_s),
        });
        Cost::fit(&times.collect::<Vec<_>>())
    }

    pub(super) fn json(&self, part: &str, on_front: bool) -> Value {
        let point = self.point();
        let every: Vec<f64> = self.outcomes.iter().flat_map(|o| o.wall_s.clone()).collect();
        let mean = |of: &dyn Fn(&CaseOutcome) -> f64| {
            let values = self.all(of);
            values.iter().sum::<f64>() / values.len().max(1) as f64
        };
        let mut stages: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for (name, s) in self.outcomes.iter().flat_map(|o| &o.stages_s) {
            stages.entry(name).or_default().push(*s);
        }
        let stages: BTreeMap<_, _> = stages.into_iter().map(|(k, v)| (k, median(&v))).collect();
        let mut notes: Vec<&str> = self
            .outcomes
            .iter()
            .flat_map(|o| &o.notes)
            .map(String::as_str)
            .collect();
        notes.sort_unstable();
        notes.dedup();
        json!({
            "part": part,
            "name": self.setting.name,
            "knobs": self.setting.params,
            "other_target": self.setting.other_target,
            "on_front": on_front,
            "wall_s": point.wall_s,
            "wall_s_p95": quantile(&every, 0.95),
            "wall_s_least": every.iter().copied().fold(f64::INFINITY, f64::min),
            "runs": every.len(),
            "invert_s": median(&self.all(|o| o.invert_s)),
            "stages_s": stages,
            "cost": self.cost(),
            "network_calls": mean(&|o| o.network_calls as f64),
            "tokens": mean(&|o| o.tokens as f64),
            "error": point.error,
            "error_of_occupied": bootstrap_median(&self.all(|o| o.error_of_occupied), 3),
            "miou": bootstrap_median(&self.all(|o| o.miou), 4),
            "latent_error": bootstrap_median(&self.all(|o| o.latent_error), 5),
            "invented_voxels": mean(&|o| o.invented),
            "seam_change_share": mean(&|o| o.seam),
            "untouched_voxels_changed": self.outcomes.iter().map(|o| o.untouched_voxels_changed).sum::<usize>(),
            "failed": self.outcomes.iter().filter(|o| o.error.is_infinite()).count(),
            "peak_rss_mb": self.outcomes.iter().filter_map(|o| o.peak_rss_mb).fold(0.0, f64::max),
            "notes": notes,
        })
    }
}

/// True if all settings left the same voxels outside the region.
pub(super) fn untouched_the_same(outcomes: &[CaseOutcome], rows: &[SettingOutcomes]) -> bool {
    let same_region = outcomes
        .iter()
        .zip(rows)
        .filter(|(o, r)| !r.setting.other_target && o.error.is_finite());
    let mut hashes = same_region.map(|(o, _)| (o.untouched_hash, o.untouched_voxels_changed));
    let first = hashes.next();
    first.is_none_or(|(hash, changed)| changed == 0 && hashes.all(|h| h == (hash, 0)))
}

pub(super) fn sensor_json(m: &SettingMeasurement) -> Value {
    json!({
        "part": m.part,
        "name": m.name,
        "wall_s": m.wall_s,
        "error": m.error,
        "figures": m.figures,
        "peak_rss_mb": m.peak_rss_mb,
        "other_target": m.other_target,
    })
}

/// The report for a person.
pub fn table(report: &Value) -> String {
    let mut lines = vec![format!(
        "{:<44} {:>9} {:>19} {:>9} {:>9}",
        "setting", "time", "differs (95 %)", "invented", "memory"
    )];
    let points = report["points"].as_array().cloned().unwrap_or_default();
    let mut part = String::new();
    for p in &points {
        let of = p["part"].as_str().unwrap_or("");
        if of != part {
            part = of.into();
            lines.push(format!("-- {part}"));
        }
        let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
        let error = match of {
            "lidar" if p["error"]["median"].is_null() => "no hit".into(),
            "lidar" => format!("{:.3} m", number(&p["error"]["median"])),
            _ => format!(
                "{} ({} to {})",
                percent(number(&p["error"]["median"])),
                percent(number(&p["error"]["low"])),
                percent(number(&p["error"]["high"]))
            ),
        };
        let front = if p["on_front"] == true { "*" } else { " " };
        lines.push(format!(
            "{front} {:<42} {:>9} {:>19} {:>9} {:>6.0} MB",
            p["name"].as_str().unwrap_or(""),
            seconds(number(&p["wall_s"]["median"])),
            error,
            p["invented_voxels"]
                .as_f64()
                .map_or(String::new(), |n| format!("{n:.1}")),
            number(&p["peak_rss_mb"]),
        ));
    }
    lines.push("* nothing is both faster and nearer".into());
    lines.join("\n")
}
