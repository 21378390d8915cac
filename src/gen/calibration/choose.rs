//! Chooses the presets of the quality slider from the measurements.

use std::path::Path;

use anyhow::Context;

use super::cases;
use super::edits::CaseOutcome;
use super::report::SettingOutcomes;
use crate::machine::{Load, machine};
use formats::atomic;
use job::GenParams;
use metrics::stats::mean_ci95;
use nets::OccModels;
use numeric::quantile::{median, quantile};
use trade::{Cost, Interval, Preset, PresetKnobs, Presets, TradePoint, bootstrap_median, front, knee};

/// Presets from the front: the fastest, the knee, the most exact, those between them that lie well apart, and the
/// reference.
pub fn presets_of(rows: &[&SettingOutcomes], reference: GenParams, models: &OccModels) -> Presets {
    let points: Vec<TradePoint> = rows.iter().map(|r| r.point()).collect();
    let kept = well_apart(rows, &points);
    let names = names(&kept.iter().map(|i| points[*i]).collect::<Vec<_>>());
    let mut presets: Vec<Preset> = Vec::new();
    for (i, name) in kept.iter().zip(names) {
        presets.extend(preset(name, rows[*i], points[*i]));
    }
    presets.extend(reference_preset(rows, reference.clone()));
    Presets {
        weights: models.card.hashes,
        machine: machine(),
        build: String::new(),
        load_per_core: Load::now().per_core,
        reference: format!("{} steps, every token, f32", reference.steps),
        all: presets,
    }
}

/// Rows of the front in the order of their times. Keeps a row only if its time rises and its error falls enough to be
/// noticed.
fn well_apart(rows: &[&SettingOutcomes], points: &[TradePoint]) -> Vec<usize> {
    let on_front = front(points);
    let mut order: Vec<usize> = (0..rows.len())
        .filter(|i| on_front[*i] && rows[*i].cost().is_some())
        .collect();
    order.sort_by(|a, b| points[*a].wall_s.median.total_cmp(&points[*b].wall_s.median));
    let mut kept: Vec<usize> = Vec::new();
    for i in order {
        let of = |k: usize| (points[k].wall_s.median, points[k].error.median);
        match kept.last().map(|k| of(*k)) {
            Some((_, error)) if of(i).1 >= 0.85 * error => {}
            // Nearly as fast and far more exact: it replaces the row before.
            Some((wall_s, error)) if of(i).0 <= 1.1 * wall_s => {
                if of(i).1 < 0.5 * error {
                    kept.pop();
                    kept.push(i);
                }
            }
            _ => kept.push(i),
        }
    }
    kept
}

/// Names of the kept rows, from the fastest to the most exact.
fn names(kept: &[TradePoint]) -> Vec<String> {
    let last = kept.len().saturating_sub(1);
    let middle = knee(kept).unwrap_or(0);
    let middle = if last >= 2 {
        middle.clamp(1, last - 1)
    } else {
        middle
    };
    let numbered = |name: &str, nth: usize| match nth {
        0 => name.to_owned(),
        n => format!("{name} {}", n + 1),
    };
    let name = |k: usize| match k {
        0 => "draft".to_owned(),
        k if k == middle => "balanced".into(),
        k if k < middle => numbered("quick", k - 1),
        k => numbered("careful", k - middle - 1),
    };
    (0..kept.len()).map(name).collect()
}

/// A row as a preset; `None` if its time cannot be predicted.
fn preset(name: String, row: &SettingOutcomes, point: TradePoint) -> Option<Preset> {
    let errors = row.all(|o| o.error);
    let probe = row.outcomes.iter().take(cases::KINDS.len());
    Some(Preset {
        name,
        knobs: PresetKnobs::from_params(&row.setting.params),
        error: point.error,
        error_of_occupied: Some(bootstrap_median(&row.all(|o| o.error_of_occupied), 3)),
        error_of_one: [quantile(&errors, 0.05), quantile(&errors, 0.95)],
        invented: Some(mean_ci95(&row.all(|o| o.invented)).0),
        cost: row.cost()?,
        invert_s: median(&row.all(|o| o.invert_s)),
        probe: probe.map(|o| o.result_hash).collect(),
    })
}

/// The reference as a preset. Its time is computed from one step of all tokens in the dense setting; `None` if that
/// setting was not measured.
fn reference_preset(rows: &[&SettingOutcomes], reference: GenParams) -> Option<Preset> {
    let dense = rows.iter().find(|r| {
        let p = &r.setting.params;
        !p.local && p.steps == 10 && p.reuse_steps == 1
    })?;
    let step_s = |o: &CaseOutcome| o.stages_s.get("denoise").copied().unwrap_or(0.0) / 10.0;
    let (step, total) = (
        median(&dense.all(step_s)),
        median(&dense.all(|o| median(&o.wall_s))),
    );
    let none = Interval {
        median: 0.0,
        low: 0.0,
        high: 0.0,
        n: dense.outcomes.len(),
    };
    let steps = f64::from(reference.steps);
    Some(Preset {
        name: "reference".into(),
        knobs: PresetKnobs::from_params(&reference),
        error: none,
        error_of_occupied: None,
        error_of_one: [0.0, 0.0],
        invented: None,
        cost: Cost {
            fixed_s: total + step * (steps - 10.0),
            per_token_s: 0.0,
        },
        invert_s: step * steps,
        probe: Vec::new(),
    })
}

/// Writes presets where they are to be read by [`Presets::parse`]. Errors name the file.
pub fn write_presets(path: &Path, presets: &Presets) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(presets).context("write presets")?;
    atomic::write(path, text.as_bytes()).with_context(|| format!("write {}", path.display()))
}
