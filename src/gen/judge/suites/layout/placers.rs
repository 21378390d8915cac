//! Compares the placers: by rules and by diffusion, with memory and without, on the same prompts and seeds.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::{Case, CaseRemarks, CaseTally, place};
use crate::suite::Options;
use authoring::prompting::{How, PlacementMethod};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use metrics::layout::{LayoutFigures, diversity};
use numeric::quantile::median;
use scene::SceneBox;
use scene::road_map::RoadMap;

/// Number of prompts whose diversity across four seeds is measured.
const DIVERSE: usize = 8;

impl Options {
    /// Figures of each way to place, and the statistics beside those of real drives (`reference/real_statistics`).
    pub(super) fn placers(&self, cases: &[Case], progress: &dyn MeasurementProgress) -> Value {
        // Spread over the sets.
        let prompts: Vec<&Case> = cases.iter().filter(|c| c.base.is_none()).collect();
        let n = self.placer_prompts.min(prompts.len());
        let chosen: Vec<&Case> = (0..n).map(|k| prompts[k * prompts.len() / n.max(1)]).collect();
        let mut out = serde_json::Map::new();
        for (placer, memory, name) in [
            (PlacementMethod::Rules, false, "rules"),
            (PlacementMethod::Rules, true, "rules_memory"),
            (PlacementMethod::Diffusion, false, "diffusion"),
            (PlacementMethod::Diffusion, true, "diffusion_memory"),
        ] {
            if n == 0 {
                break;
            }
            let how = How {
                placer,
                memory,
                weights: self.weights.clone(),
                ..How::default()
            };
            let mut tally = CaseTally::default();
            let mut figures = LayoutFigures::default();
            let (mut moved, mut network_s, mut projection_s) = (Vec::new(), Vec::new(), Vec::new());
            let (mut by_rules, mut objects) = (0, 0);
            let mut spread: Vec<(f64, f64)> = Vec::new();
            for (i, case) in chosen.iter().enumerate() {
                progress.at(name, i, n);
                let seed = TEST_SEED + case.line;
                let (scene, laid) = place(&case.text, seed, &how);
                tally.add(case, &scene, laid.wall_s, Vec::new(), CaseRemarks::default);
                figures.add(&RoadMap::new(&laid.road.layout), &laid.placement.boxes);
                objects += laid.placement.boxes.len();
                if let Some(d) = &laid.diffused {
                    moved.push(d.mean_move_m);
                    network_s.push(d.report.diffusion_s);
                    projection_s.push(d.report.projection_s);
                    by_rules += d.by_rules;
                }
                if i < DIVERSE {
                    let runs: Vec<BTreeMap<u32, SceneBox>> = (0..4)
                        .map(|k| {
                            let (_, laid) = place(&case.text, seed + 1000 * k, &how);
                            laid.placement.boxes.iter().map(|b| (b.id.0, *b)).collect()
                        })
                        .collect();
                    let found = diversity(&runs);
                    if found.pairs > 0 {
                        spread.push((found.footprints, found.displacement_m));
                    }
                }
            }
            let mean =
                |f: fn(&(f64, f64)) -> f64| spread.iter().map(f).sum::<f64>() / spread.len().max(1) as f64;
            let mut report = tally.report();
            report["objects"] = objects.into();
            report["rows"] = json!(figures.rows());
            // Distance of the medians from those of real drives, in units of the width between their 5th and 95th
            // percentiles.
            let off: Vec<f64> = figures
                .rows()
                .iter()
                .filter(|r| r.real.p95 > r.real.p5 && r.found.p50.is_finite())
                .map(|r| ((r.found.p50 - r.real.p50) / (r.real.p95 - r.real.p5)).abs())
                .collect();
            report["medians_off_real"] = json!(off.iter().sum::<f64>() / off.len().max(1) as f64);
            report["diversity"] = json!({ "footprints": mean(|s| s.0), "displacement_m": mean(|s| s.1), "prompts": spread.len() });
            if placer == PlacementMethod::Diffusion {
                report["diffusion"] = json!({
                    "network_s_median": median(&network_s),
                    "projection_s_median": median(&projection_s),
                    "mean_move_m": moved.iter().sum::<f64>() / moved.len().max(1) as f64,
                    "placed_by_rules": by_rules as f64 / objects.max(1) as f64,
                });
            }
            out.insert(name.to_string(), report);
        }
        out.into()
    }
}
