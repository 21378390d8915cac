//! `eval world`, complete worlds: their shape, and what the checks find in them.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde_json::{Value, json};

use crate::suite::{Options, with_interval};
use calibration::MeasurementProgress;
use calibration::held_out::scene;
use editor::checks::{Severity, run_checks};
use metrics::shape::{FIGURES, shape};

/// Share of worlds that may have an error finding.
const MOST_WITH_ERRORS: f64 = 0.01;

impl Options {
    /// Shape figures and findings of complete worlds, one per frame asked for; and whether few enough have an error.
    pub(super) fn world_complete(&self, progress: &dyn MeasurementProgress) -> (Value, bool) {
        let indices: Vec<usize> = (0..self.frames).collect();
        let mut shapes: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        let mut findings: BTreeMap<&str, usize> = BTreeMap::new();
        let (mut with_errors, mut all, mut with_any) = (Vec::new(), Vec::new(), 0);
        for some in indices.chunks(16) {
            progress.at("complete worlds", some[0], self.frames);
            let seen: Vec<_> = some
                .par_iter()
                .map(|i| {
                    let world = scene(*i as u64);
                    (*i, shape(&world.frame().occupancy), run_checks(&world, None))
                })
                .collect();
            for (i, figures, found) in seen {
                for (name, _) in FIGURES {
                    shapes.entry(name).or_default().extend(figures.get(name).copied());
                }
                all.push(found.len() as f64);
                with_any += usize::from(!found.is_empty());
                if found.iter().any(|f| f.severity == Severity::Error) {
                    with_errors.push(i);
                }
                for finding in found {
                    *findings.entry(finding.check).or_default() += 1;
                }
            }
        }
        let share = with_errors.len() as f64 / self.frames.max(1) as f64;
        let shapes: BTreeMap<_, _> = shapes.iter().map(|(name, v)| (*name, with_interval(v))).collect();
        let report = json!({
            "shape": shapes,
            "findings_by_check": findings,
            "findings_per_world": with_interval(&all),
            "worlds_with_findings": with_any,
            "worlds_with_errors": with_errors,
            "share_with_errors": share,
        });
        (report, share <= MOST_WITH_ERRORS)
    }
}
