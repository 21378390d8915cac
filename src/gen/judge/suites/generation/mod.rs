//! `eval generation`: scenes from their layout alone, compared with the layout and with worlds. Every figure is given
//! for several sets of scenes side by side, so that the figures of the worlds themselves, the VAE and the draft are
//! seen too.

mod agreement;
mod distribution;
mod follow;
mod given_background;
mod inpainted;
pub(super) mod row;
mod table;
mod two_sample;

use std::sync::Arc;

use rayon::prelude::*;
use serde_json::json;

use crate::suite::{Options, SuiteFigures, with_interval};
use agreement::Agreement;
use authoring::scenery::{SceneryMethod, SceneryWish};
use calibration::MeasurementProgress;
use calibration::held_out::scene;
use editor::Document;
use follow::Follow;
use given_background::Given;
use inpainted::Inpainted;
use job::pipeline::{Ablation, OccPipeline};
use job::{GenParams, Job, JobCtx, Pipeline};
use metrics::extractor::Extractor;
use metrics::iou::Confusion;
use nets::fine_vae;
use numeric::quantile::median;
use row::{ROWS, SceneFeatures, SceneSet};
use scene::{Scene, VoxelGrid, draft};
pub(crate) use table::{rows_table, table};
use world::World;
use world::voxelize::{Vertical, complete};

/// Frames that are generated a second time, from another seed.
const DIVERSITY_FRAMES: usize = 8;
/// Offset of the seed for a second draw that shares nothing with the first.
const OTHER_SEED: u64 = 1_000_000;
/// Index of the generated scenes among the rows.
const GENERATED: usize = 5;

/// Figures of all frames.
#[derive(Default)]
struct GenerationFigures {
    rows: [SceneSet; ROWS.len()],
    bare: Agreement,
    boxless: Agreement,
    likeness: Confusion,
    wall_s: Vec<f64>,
    inpainted: Inpainted,
    /// One for generated scenes, one for worlds.
    follow: [Follow; 2],
    /// One with the fine stage, one without.
    given: [Given; 2],
}

impl Options {
    /// Judges occupancy generated from the layout alone.
    pub(crate) fn generation(
        &self,
        pipeline: &mut OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<SuiteFigures> {
        let extractor = Extractor::bundled()?;
        let params = GenParams {
            keep_objects: false,
            ..self.scene_params.clone()
        };
        let mut measured = GenerationFigures::default();
        for i in 0..self.frames {
            progress.at("generation", i, self.frames);
            self.frame(i, pipeline, params.clone(), &extractor, &mut measured)?;
        }
        progress.at("judge", 0, 1);
        let found = &measured.rows[GENERATED];
        let mut report = json!({});
        if !self.rows_only {
            report["ablations"] = measured.inpainted.report();
            report["ablations"]["without_layout"] = measured.bare.report();
            report["ablations"]["without_boxes"] = measured.boxless.report();
        }
        report["against_the_worlds"] = json!({
            "miou": measured.likeness.mean_iou().0,
            "iou": measured.likeness.occupied_iou(),
        });
        report["diversity_across_seeds"] = with_interval(&measured.follow[0].diversity());
        report["background"] = json!({
            "generated": measured.follow[0].report(),
            "worlds": measured.follow[1].report(),
        });
        report["background_given"] = measured.given[0].report();
        report["background_given_coarse"] = measured.given[1].report();
        report["rows"] = json!({});
        for (row, (name, what)) in measured.rows.iter().zip(ROWS) {
            report["rows"][name] = row.report(&measured.rows[0], params.seed)?;
            report["rows"][name]["what"] = what.into();
        }
        report["wall_s_median"] = median(&measured.wall_s).into();
        report["steps"] = params.steps.into();
        report["guidance"] = params.guidance.into();
        Ok((report, found.agreement.bars()))
    }

    /// Judges world `i` and everything that is made from its layout.
    fn frame(
        &self,
        i: usize,
        pipeline: &mut OccPipeline,
        mut params: GenParams,
        extractor: &Extractor,
        measured: &mut GenerationFigures,
    ) -> anyhow::Result<()> {
        let (world, other) = (scene(i as u64), scene((self.frames + i) as u64));
        let truth = world.frame().occupancy.clone();
        let common = params.seed.wrapping_add(OTHER_SEED);
        params.seed = params.seed.wrapping_add(i as u64);
        let job = Job {
            scene: Arc::new(world),
            params: params.clone(),
        };
        let given = pipeline.run(&job, &JobCtx::detached())?.occupancy;
        let coarse = Job {
            params: GenParams {
                fine_steps: 0,
                ..params.clone()
            },
            ..job.clone()
        };
        let given_coarse = pipeline.run(&coarse, &JobCtx::detached())?.occupancy;
        measured.given[0].add(&given, &truth);
        measured.given[1].add(&given_coarse, &truth);
        let told = pipeline.reconstruct(&job.scene)?;
        let seed = common.wrapping_add(i as u64);
        let mut on_scenery = |by| -> anyhow::Result<VoxelGrid> {
            let scene = with_drawn_scenery(&job.scene, by, seed)?;
            let params = GenParams {
                keep_objects: true, // as it is shown
                ..params.clone()
            };
            let result = pipeline.run(&Job { scene, params }, &JobCtx::detached())?;
            Ok(result.occupancy)
        };
        let drawn = on_scenery(SceneryMethod::Rules(None))?;
        let learned = on_scenery(SceneryMethod::Network)?;
        let mut bare = Scene::clone(&job.scene);
        bare.background = Arc::default();
        let job = Job {
            scene: Arc::new(bare),
            params: params.clone(),
        };
        let mut run = |ablation, job: &Job| {
            pipeline.ablate(ablation);
            let result = pipeline.run(job, &JobCtx::detached());
            pipeline.ablate(None);
            result
        };
        let result = run(None, &job)?;
        measured.wall_s.push(result.report.total_s());
        let undrafted = run(Some(Ablation::Draft), &job)?.occupancy;
        if measured.follow[0].len() < DIVERSITY_FRAMES {
            let again = Job {
                params: GenParams {
                    seed: common,
                    ..params.clone()
                },
                ..job.clone()
            };
            let again = run(None, &again)?.occupancy;
            let layout = &job.scene.frame().layout;
            measured.follow[0].add(layout, result.occupancy.clone(), again);
            measured.follow[1].add(layout, truth.clone(), world_of_seed(&job.scene, common));
        }
        if !self.rows_only {
            let bare = run(Some(Ablation::Layout), &job)?.occupancy;
            measured.bare.add(&job.scene, &bare);
            let boxless = run(Some(Ablation::Boxes), &job)?.occupancy;
            measured.boxless.add(&job.scene, &boxless);
            measured.inpainted.add(pipeline, &job)?;
        }
        measured.likeness.add(&truth, &result.occupancy);
        let vae = &pipeline.models().vae;
        let decoded = vae.decode(&vae.encode(&truth)?)?;
        let fine = fine_vae()?;
        let fine = fine.decode(&fine.encode(&truth)?)?;
        let frame = job.scene.frame();
        let naive = draft::draft(&frame.layout, frame.boxes.values());
        let other_truth = &other.frame().occupancy;
        let grids = [
            other_truth,
            &truth,
            &decoded,
            &told,
            &fine,
            &result.occupancy,
            &given,
            &given_coarse,
            &drawn,
            &learned,
            &undrafted,
            &naive,
        ];
        let seen: Result<Vec<SceneFeatures>, _> = (0..ROWS.len())
            .into_par_iter()
            .map(|r| SceneFeatures::from_scene(of(r, &other, &job.scene), grids[r], i as u64, extractor))
            .collect();
        for (r, seen) in seen?.into_iter().enumerate() {
            measured.rows[r].add(of(r, &other, &job.scene), grids[r], seen);
        }
        Ok(())
    }
}

/// The scene whose layout a row's occupancy is made for.
fn of<'a>(row: usize, other: &'a Scene, world: &'a Scene) -> &'a Scene {
    if row == 0 { other } else { world }
}

/// A scene with its scenery regenerated. The window does this by rules before it generates.
fn with_drawn_scenery(scene: &Arc<Scene>, by: SceneryMethod, seed: u64) -> anyhow::Result<Arc<Scene>> {
    let mut document = Document::new((**scene).clone());
    let wish = SceneryWish {
        by,
        ..SceneryWish::of_seed(seed)
    };
    document.apply_all("Draw scenery", &wish.edits(scene)?)?;
    Ok(document.scene().clone())
}

/// A world of another seed on the layout and boxes of a scene.
fn world_of_seed(scene: &Scene, seed: u64) -> VoxelGrid {
    let frame = scene.frame();
    let world = World::new(frame.layout.clone(), frame.boxes.clone(), seed);
    complete(&world, Vertical::Occ3d)
}
