//! Parts of `eval editing` that run only on request: many random edits, inversion schemes, many steps.

use std::sync::Arc;

use serde_json::{Value, json};

use super::edited;
use crate::suite::{Options, with_interval};
use calibration::MeasurementProgress;
use calibration::held_out::scene;
use calibration::trials::{KINDS, Trial};
use diffusion::solver::SolverKind;
use editor::Document;
use job::pipeline::OccPipeline;
use job::region::Region;
use job::{GenParams, Job, JobCtx, Pipeline};
use metrics::iou::Confusion;
use nets::tokens_of;
use scene::{Scene, VoxelGrid, Window};
use world::draw::Draw;

/// Number of edits in one world before the next is taken.
const EDITS_PER_WORLD: usize = 25;
/// Steps of random edits. Few are enough: what an edit must not change does not depend on the steps.
const RANDOM_EDIT_STEPS: u32 = 4;
const SCHEME_STEPS: [u32; 4] = [5, 10, 20, 50];
const REFERENCE_STEPS: u32 = 1000;

impl Options {
    /// Edits of random kinds and places, each on top of the last; the second figure is the number of voxels
    /// that changed outside their regions.
    pub(crate) fn random_edits(
        &self,
        pipeline: &mut OccPipeline,
        params: GenParams,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<(Value, usize)> {
        let params = GenParams {
            steps: RANDOM_EDIT_STEPS,
            ..params.clone()
        };
        let mut draw = Draw::new(self.edit_params.seed, "random edits");
        let (mut done, mut tried, mut untouched, mut changed) = (0, 0, 0, 0);
        let mut world = 0;
        while done < self.random_edits {
            let mut document = Document::new(scene(world));
            world += 1;
            let fresh = tried + 2 * EDITS_PER_WORLD; // some kinds find no place
            let last = (done + EDITS_PER_WORLD).min(self.random_edits);
            while done < last && tried < fresh {
                tried += 1;
                progress.at("random edits", done, self.random_edits);
                let kind = KINDS[draw.below(KINDS.len())];
                let frame = document.scene().frame().clone();
                let Some(trial) = Trial::propose(kind, &frame, draw.bits()) else {
                    continue; // no edit of that kind is possible here
                };
                document.apply("Edit", &trial.edit)?;
                let job = Job {
                    scene: document.scene().clone(),
                    params: params.clone(),
                };
                let result = pipeline.run(&job, &JobCtx::detached())?;
                // Counted here again, from the grids alone, to check the report's own count.
                let region = Region::of_edit(job.scene.frame(), params.halo_columns as usize);
                untouched += result.report.untouched_voxels_changed;
                untouched += outside(&frame.occupancy, &result.occupancy, &region);
                changed += result.report.voxels_changed;
                document.adopt(result.rev(), result.occupancy.clone())?;
                done += 1;
            }
        }
        let report = json!({ "edits": done, "worlds": world, "voxels_changed": changed, "untouched_voxels_changed": untouched });
        Ok((report, untouched))
    }

    /// Relative error of inverting a world and sampling it again, by scheme and number of steps.
    pub(crate) fn schemes(
        &self,
        pipeline: &mut OccPipeline,
        params: GenParams,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<Value> {
        let mut rows = Vec::new();
        for (name, solver, iterations) in [
            ("ddim", SolverKind::Ddim, 0),
            ("ddim, 3 damped updates", SolverKind::Ddim, 3),
            ("obelm", SolverKind::OBelm, 0),
        ] {
            for steps in SCHEME_STEPS {
                progress.at("inversion schemes", rows.len(), 12);
                let params = GenParams {
                    steps,
                    solver,
                    inversion_iterations: iterations,
                    ..params.clone()
                };
                let (mut error, mut noise_std) = (Vec::new(), Vec::new());
                for i in 0..self.scheme_frames {
                    let scene = Arc::new(scene(i as u64));
                    let found = pipeline.round_trip_of(&scene, &params, &JobCtx::detached())?;
                    error.push(found.error);
                    noise_std.push(found.noise_std);
                }
                rows.push(json!({
                    "scheme": name,
                    "steps": steps,
                    "round_trip_error": with_interval(&error),
                    "noise_std": with_interval(&noise_std),
                }));
            }
        }
        Ok(rows.into())
    }

    /// Two edits in regions apart, applied in either order: share of the voxels of the two regions that differ, per
    /// world.
    pub(crate) fn order(
        &self,
        pipeline: &mut OccPipeline,
        params: GenParams,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<Vec<f64>> {
        let mut differ = Vec::new();
        for i in 0..self.frames {
            progress.at("edit order", i, self.frames);
            let scene = scene(i as u64);
            let trials = ["remove", "add"].map(|kind| Trial::propose(kind, scene.frame(), i as u64));
            let [Some(one), Some(other)] = &trials else {
                continue;
            };
            let (one_region, other_region) = (region(&scene, one, &params)?, region(&scene, other, &params)?);
            let tokens =
                [&one_region, &other_region].map(|r| tokens_of(&r.latent_cells, params.halo_tokens as usize));
            if tokens[0].iter().any(|t| tokens[1].contains(t)) {
                continue;
            }
            let first = after_both(pipeline, &scene, [one, other], &params)?;
            let second = after_both(pipeline, &scene, [other, one], &params)?;
            let voxels = (one_region.column_count() + other_region.column_count()) * Window::NZ;
            differ.push(first.count_different(&second) as f64 / voxels.max(1) as f64);
        }
        Ok(differ)
    }

    /// Compares removals with the usual steps with those of many steps.
    pub(crate) fn reference(
        &self,
        pipeline: &mut OccPipeline,
        params: GenParams,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<Value> {
        let mut all = Confusion::default();
        let mut differ = Vec::new();
        for i in 0..self.reference_frames {
            progress.at("1000 steps", i, self.reference_frames);
            let scene = scene(i as u64);
            let Some(trial) = Trial::propose("remove", scene.frame(), i as u64) else {
                continue;
            };
            let many = GenParams {
                steps: REFERENCE_STEPS,
                ..params.clone()
            };
            let (few, report) = edited(pipeline, &scene, &trial, params.clone())?;
            let (reference, _) = edited(pipeline, &scene, &trial, many)?;
            all.add(&reference, &few);
            let voxels = report.region_columns * Window::NZ;
            differ.push(few.count_different(&reference) as f64 / voxels.max(1) as f64);
        }
        Ok(json!({
            "steps": params.steps,
            "miou": all.mean_iou().0,
            "region_voxels_that_differ": with_interval(&differ),
        }))
    }
}

/// The region that a trial inpaints.
fn region(scene: &Scene, trial: &Trial, params: &GenParams) -> anyhow::Result<Region> {
    let mut document = Document::new(scene.clone());
    document.apply("Edit", &trial.edit)?;
    Ok(Region::of_edit(
        document.scene().frame(),
        params.halo_columns as usize,
    ))
}

/// Occupancy after two edits, each generated and adopted.
fn after_both(
    pipeline: &mut OccPipeline,
    scene: &Scene,
    trials: [&Trial; 2],
    params: &GenParams,
) -> anyhow::Result<VoxelGrid> {
    let mut document = Document::new(scene.clone());
    for trial in trials {
        document.apply("Edit", &trial.edit)?;
        let job = Job {
            scene: document.scene().clone(),
            params: params.clone(),
        };
        let result = pipeline.run(&job, &JobCtx::detached())?;
        document.adopt(result.rev(), result.occupancy.clone())?;
    }
    Ok(document.scene().frame().occupancy.clone())
}

/// Voxels outside the region that differ.
fn outside(before: &VoxelGrid, after: &VoxelGrid, region: &Region) -> usize {
    let columns = (0..Window::COLUMNS).filter(|c| !region.columns[*c]);
    let different = columns.map(|c| {
        let (x, y) = (c / Window::NY, c % Window::NY);
        let both = before.column(x, y).iter().zip(after.column(x, y));
        both.filter(|(a, b)| a != b).count()
    });
    different.sum()
}
