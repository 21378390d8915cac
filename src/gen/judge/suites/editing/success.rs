//! One edit of every kind per complete world: does it do what it says, and nothing else?

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::{Value, json};

use super::edited;
use crate::suite::{Bar, Options, with_interval};
use calibration::MeasurementProgress;
use calibration::held_out::scene;
use calibration::trials::{KINDS, Reached, Trial};
use job::pipeline::OccPipeline;
use job::{GenParams, GenReport, Job, JobCtx};
use metrics::stats::mean_ci95;
use numeric::quantile::median;
use scene::Window;

/// Figures of one kind of edit.
#[derive(Default)]
struct EditKindFigures {
    success: Vec<f64>,
    success_in_editor: Vec<f64>,
    gone: Vec<f64>,
    filled: Vec<f64>,
    road: Vec<f64>,
    wall_s: Vec<f64>,
    tokens: Vec<f64>,
    seam: Vec<f64>,
    dense_wall_s: Vec<f64>,
    differs_from_dense: Vec<f64>,
}

impl EditKindFigures {
    fn add(&mut self, reached: Reached, report: &GenReport) {
        self.success.push(f64::from(u8::from(reached.success())));
        self.gone.extend(reached.gone);
        self.filled.extend(reached.filled);
        self.road.extend(reached.road);
        self.wall_s.push(report.total_s());
        self.tokens.push(report.tokens as f64);
        self.seam.push(report.seam_change_share);
    }

    fn report(&self) -> Value {
        let mut out = json!({
            "success_of_networks": with_interval(&self.success),
            "success": with_interval(&self.success_in_editor),
            "wall_s_median": median(&self.wall_s),
            "tokens_median": median(&self.tokens),
            "seam_change_share": with_interval(&self.seam),
        });
        if !self.dense_wall_s.is_empty() {
            out["dense_wall_s_median"] = median(&self.dense_wall_s).into();
        }
        for (name, shares) in [
            ("region_voxels_that_differ_from_dense", &self.differs_from_dense),
            ("voxels_gone", &self.gone),
            ("columns_filled", &self.filled),
            ("columns_road", &self.road),
        ] {
            if !shares.is_empty() {
                out[name] = with_interval(shares);
            }
        }
        out
    }
}

impl Options {
    /// Tries one edit of every kind per world; they share the inversion of their source, as in the window.
    pub(crate) fn success(
        &self,
        pipeline: &mut OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<(Value, Vec<Bar>)> {
        let params = GenParams {
            keep_objects: false,
            ..self.edit_params.clone()
        };
        let ctx = JobCtx::detached();
        let mut kinds: BTreeMap<&str, EditKindFigures> = BTreeMap::new();
        let (mut invert_s, mut round_trip) = (Vec::new(), Vec::new());
        let mut untouched = 0;
        for i in 0..self.frames {
            progress.at("editing", i, self.frames);
            let scene = scene(i as u64);
            let start = std::time::Instant::now();
            let job = Job {
                scene: Arc::new(scene.clone()),
                params: params.clone(),
            };
            pipeline.prepare(&job, &ctx)?;
            invert_s.push(start.elapsed().as_secs_f64());
            round_trip.push(pipeline.round_trip(&job, &ctx)?);
            for kind in KINDS {
                let Some(trial) = Trial::propose(kind, scene.frame(), i as u64) else {
                    continue;
                };
                let (after, report) = edited(pipeline, &scene, &trial, params.clone())?;
                let reached = trial.judge(&scene.frame().occupancy, &after);
                untouched += report.untouched_voxels_changed;
                let entry = kinds.entry(kind).or_default();
                entry.add(reached, &report);
                // As the editor and `sceneloom edit` show it: objects that the networks left out are put in.
                let kept = GenParams {
                    keep_objects: true,
                    ..params.clone()
                };
                let (shown, report) = edited(pipeline, &scene, &trial, kept)?;
                untouched += report.untouched_voxels_changed;
                let reached = trial.judge(&scene.frame().occupancy, &shown);
                entry
                    .success_in_editor
                    .push(f64::from(u8::from(reached.success())));
                if params.local && report.region_columns > 0 {
                    // Measures the accuracy that the stored keys and values of other tokens cost, and the time they
                    // save.
                    let dense = GenParams {
                        local: false,
                        ..params.clone()
                    };
                    let (all, dense_report) = edited(pipeline, &scene, &trial, dense)?;
                    let voxels = report.region_columns * Window::NZ;
                    let share = all.count_different(&after) as f64 / voxels as f64;
                    entry.differs_from_dense.push(share);
                    entry.dense_wall_s.push(dense_report.total_s());
                }
            }
        }
        let mut report = json!({
            "kinds": kinds.iter().map(|(name, kind)| (*name, kind.report())).collect::<BTreeMap<_, _>>(),
            "round_trip_error": with_interval(&round_trip),
            "inversion_s_median": median(&invert_s),
            "steps": params.steps,
            "solver": params.solver.name(),
            "local": params.local,
        });
        let success = |name: &str| {
            let kind = kinds.get(name);
            kind.map_or(f64::NAN, |kind| mean_ci95(&kind.success_in_editor).0)
        };
        let mut bars = vec![
            ("removed", success("remove"), 0.97),
            ("added", success("add"), 0.97),
            ("moved", success("move"), 0.90),
            ("class changed", success("class"), 0.90),
            ("road widened", success("road"), 0.90),
            ("crossing painted", success("crossing"), 0.90),
        ];
        let order = self.order(pipeline, params.clone(), progress)?;
        report["two_edits_in_either_order_differ"] = with_interval(&order);
        let most = order.iter().fold(0.0, |m: f64, v| m.max(*v));
        report["two_edits_in_either_order_differ_at_most"] = most.into();
        if self.random_edits > 0 {
            let (random, changed) = self.random_edits(pipeline, params.clone(), progress)?;
            untouched += changed;
            report["random_edits"] = random;
        }
        if self.scheme_frames > 0 {
            report["inversion_schemes"] = self.schemes(pipeline, params.clone(), progress)?;
        }
        if self.reference_frames > 0 {
            report["against_1000_steps"] = self.reference(pipeline, params, progress)?;
        }
        report["untouched_voxels_changed"] = untouched.into();
        bars.push((
            "untouched voxels kept",
            if untouched == 0 { 1.0 } else { 0.0 },
            1.0,
        ));
        Ok((report, bars))
    }
}
