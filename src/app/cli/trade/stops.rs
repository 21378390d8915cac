//! The stops of the quality slider, chosen from what was measured.

use std::path::Path;

use anyhow::Context;

use super::report::Row;
use super::{Trade, output};
use crate::trade::cases;
use crate::trade::edits::Outcome;
use crate::trade::load::{Load, machine};
use job::GenParams;
use metrics::stats::mean_ci95;
use nets::OccModels;
use numeric::quantile::{median, quantile};
use trade::{Cost, Interval, Placed, Stop, StopKnobs, Stops, front, knee};

impl Trade {
    /// Stops from the front: the fastest, the knee, the most exact, and those between them that lie well apart, and the
    /// reference.
    pub(super) fn stops_of(&self, rows: &[&Row], reference: GenParams, models: &OccModels) -> Stops {
        let placed: Vec<Placed> = rows.iter().map(|r| r.placed()).collect();
        let on_front = front(&placed);
        let mut order: Vec<usize> = (0..rows.len())
            .filter(|i| on_front[*i] && rows[*i].cost().is_some())
            .collect();
        order.sort_by(|a, b| placed[*a].wall_s.median.total_cmp(&placed[*b].wall_s.median));
        // Only those whose time rises and whose error falls by enough to be felt.
        let mut kept: Vec<usize> = Vec::new();
        for i in order {
            let of = |k: usize| (placed[k].wall_s.median, placed[k].error.median);
            match kept.last().map(|k| of(*k)) {
                Some((_, error)) if of(i).1 >= 0.85 * error => {}
                // Nearly as fast and much nearer: nobody would choose the other.
                Some((wall_s, error)) if of(i).0 <= 1.1 * wall_s => {
                    if of(i).1 < 0.5 * error {
                        kept.pop();
                        kept.push(i);
                    }
                }
                _ => kept.push(i),
            }
        }
        let middle = knee(&kept.iter().map(|i| placed[*i]).collect::<Vec<_>>()).unwrap_or(0);
        let last = kept.len().saturating_sub(1);
        let middle = if last >= 2 {
            middle.clamp(1, last - 1)
        } else {
            middle
        };
        let numbered = |name: &str, nth: usize| {
            if nth == 0 {
                name.to_owned()
            } else {
                format!("{name} {}", nth + 1)
            }
        };
        let name = |k: usize| match k {
            0 => "draft".to_owned(),
            k if k == last => "accurate".into(),
            k if k == middle => "balanced".into(),
            k if k < middle => numbered("quick", k - 1),
            k => numbered("careful", k - middle - 1),
        };
        let mut stops: Vec<Stop> = Vec::new();
        for (k, i) in kept.iter().enumerate() {
            let (row, placed) = (rows[*i], placed[*i]);
            let errors = row.all(|o| o.error);
            if let Some(cost) = row.cost() {
                stops.push(Stop {
                    name: name(k),
                    knobs: StopKnobs::of(&row.setting.params),
                    error: placed.error,
                    error_of_one: [quantile(&errors, 0.05), quantile(&errors, 0.95)],
                    invented: Some(mean_ci95(&row.all(|o| o.invented)).0),
                    cost,
                    invert_s: median(&row.all(|o| o.invert_s)),
                    probe: row
                        .outcomes
                        .iter()
                        .take(cases::KINDS.len())
                        .map(|o| o.result_hash)
                        .collect(),
                });
            }
        }
        // One step of all tokens, from the dense setting, gives what the reference takes.
        let dense = rows.iter().find(|r| {
            let p = &r.setting.params;
            !p.local && p.steps == 10 && p.reuse_steps == 1
        });
        if let Some(dense) = dense {
            let step_s = |o: &Outcome| o.stages_s.get("denoise").copied().unwrap_or(0.0) / 10.0;
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
            stops.push(Stop {
                name: "reference".into(),
                knobs: StopKnobs::of(&reference),
                error: none,
                error_of_one: [0.0, 0.0],
                invented: None,
                cost: Cost {
                    fixed_s: total + step * (steps - 10.0),
                    per_token_s: 0.0,
                },
                invert_s: step * steps,
                probe: Vec::new(),
            });
        }
        Stops {
            weights: models.card.hashes,
            machine: machine(),
            build: String::new(),
            load_per_core: Load::now().per_core,
            reference: format!("{} steps, every token, f32", reference.steps),
            stops,
        }
    }
}

/// Writes stops where they are to be read by [`Stops::parse`].
pub fn write_stops(path: &Path, stops: &Stops) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(stops).context("write stops")?;
    output::write_file(path, text.as_bytes())
}
