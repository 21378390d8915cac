//! `eval generation`: scenes from their layout alone, against the layout and against worlds.

use std::sync::Arc;

use serde_json::{Value, json};

use super::{Bar, Eval, scene, with_interval};
use crate::app::cli::generate::full_params;
use crate::app::cli::progress::Progress;
use crate::generation::job::{GenParams, Job, JobCtx, Named, Pipeline, RegionMode};
use crate::generation::metrics::agreement::AgreementCount;
use crate::generation::metrics::extractor::Extractor;
use crate::generation::metrics::frechet::frechet_distance;
use crate::generation::metrics::iou::Confusion;
use crate::generation::metrics::kernel::{Kernel, mmd2_with_interval};
use crate::generation::metrics::stats::median;
use crate::generation::pipeline::{Ablation, OccPipeline};
use crate::generation::region::Region;
use crate::scene::{Class, Density, GridSpec, Scene, VoxelGrid, draft};

/// Parts that the sets are split into for the intervals of MMD and KID.
const SUBSETS: usize = 8;
/// Frames that are generated a second time, from another seed.
const DIVERSITY_FRAMES: usize = 8;
/// Added to a seed for a draw that has nothing in common with the first.
const OTHER_SEED: u64 = 1_000_000;
/// Side of the square that is redrawn with and without its context, columns, how often, and the step of its places.
const REDRAWN: usize = 28;
const DRAWS: u64 = 3;
const PLACE_STEP: usize = 12;

/// Agreement with the layout over frames.
#[derive(Default)]
struct Agreement {
    all: AgreementCount,
    drivable: Vec<f64>,
    vehicles: Vec<f64>,
}

impl Agreement {
    fn add(&mut self, scene: &Scene, occupancy: &VoxelGrid) {
        self.all.add(scene.frame(), occupancy);
        let mut one = AgreementCount::default();
        one.add(scene.frame(), occupancy);
        self.drivable.extend(one.iou().drivable);
        self.vehicles.extend(one.iou().vehicles);
    }

    fn report(&self) -> Value {
        json!({
            "columns": self.all.iou(),
            "drivable_per_frame": with_interval(&self.drivable),
            "vehicles_per_frame": with_interval(&self.vehicles),
        })
    }
}

impl Eval {
    /// Occupancy from the layout alone.
    pub(super) fn generation(
        &self,
        pipeline: &mut OccPipeline,
        progress: &Progress,
    ) -> anyhow::Result<(Value, Vec<Bar>)> {
        let extractor = Extractor::bundled()?;
        let mut params = GenParams {
            keep_objects: false,
            ..self.generation.params(full_params())?
        };
        let [mut found, mut worlds, mut bare, mut boxless] = <[Agreement; 4]>::default();
        let mut likeness = Confusion::default();
        // Features of other worlds, of the worlds that lent their layouts, of what was generated, of drafts.
        let mut features: [Vec<Vec<f64>>; 4] = Default::default();
        let (mut diversity, mut wall_s) = (Vec::new(), Vec::new());
        // With context and without: of the square, of its seam.
        let mut redrawn: [[Vec<f64>; 2]; 2] = Default::default();
        for i in 0..self.frames {
            progress.at("generation", i, self.frames);
            let world = scene(i as u64);
            let truth = world.frame().occupancy.clone();
            let naive = draft::draft(&world.frame().layout, world.frame().boxes.values());
            worlds.add(&world, &truth);
            params.seed = self.generation.seed.wrapping_add(i as u64);
            let job = Job {
                scene: Arc::new(world),
                params,
            };
            let mut run = |ablation, job: &Job| {
                pipeline.ablate(ablation);
                let result = pipeline.run(job, &JobCtx::detached());
                pipeline.ablate(None);
                result
            };
            let result = run(None, &job)?;
            wall_s.push(result.report.total_s());
            found.add(&job.scene, &result.occupancy);
            bare.add(&job.scene, &run(Some(Ablation::Layout), &job)?.occupancy);
            boxless.add(&job.scene, &run(Some(Ablation::Boxes), &job)?.occupancy);
            likeness.add(&truth, &result.occupancy);
            let other = scene((self.frames + i) as u64);
            for (set, grid) in
                features
                    .iter_mut()
                    .zip([&other.frame().occupancy, &truth, &result.occupancy, &naive])
            {
                set.push(extractor.features(grid)?);
            }
            if i < DIVERSITY_FRAMES {
                let again = Job {
                    params: GenParams {
                        seed: params.seed.wrapping_add(OTHER_SEED),
                        ..params
                    },
                    ..job.clone()
                };
                let mut same = Confusion::default();
                same.add(&result.occupancy, &run(None, &again)?.occupancy);
                diversity.extend(same.occupied_iou().map(|iou| 1.0 - iou));
            }
            for (shares, of) in redrawn.iter_mut().zip(redrawn_iou(pipeline, &job)?) {
                shares.iter_mut().zip(of).for_each(|(all, one)| all.push(one));
            }
        }
        let (mut report, bars) = (json!({}), bars(&found));
        report["layout_agreement"] = found.report();
        report["layout_agreement_of_the_worlds_themselves"] = worlds.report();
        report["ablations"] = json!({
            "without_layout": bare.report(),
            "without_boxes": boxless.report(),
            "redrawn_square_iou": with_interval(&redrawn[0][0]),
            "redrawn_square_iou_without_context": with_interval(&redrawn[1][0]),
            "seam_iou": with_interval(&redrawn[0][1]),
            "seam_iou_without_context": with_interval(&redrawn[1][1]),
            "redrawn_square_iou_gain_of_context": gain(&redrawn, 0),
            "seam_iou_gain_of_context": gain(&redrawn, 1),
        });
        report["against_the_worlds"] =
            json!({ "miou": likeness.mean_iou().0, "iou": likeness.occupied_iou() });
        report["diversity_across_seeds"] = with_interval(&diversity);
        report["distribution"] = distribution(&features)?;
        report["wall_s_median"] = median(&wall_s).into();
        report["steps"] = params.steps.into();
        report["guidance"] = params.guidance.into();
        Ok((report, bars))
    }
}

fn bars(found: &Agreement) -> Vec<Bar> {
    let iou = found.all.iou();
    vec![
        ("drivable agreement", iou.drivable.unwrap_or(f64::NAN), 0.95),
        ("vehicle agreement", iou.vehicles.unwrap_or(f64::NAN), 0.92),
    ]
}

/// F3D, KID and MMD of generated frames, with what equally many other worlds give (the floor) and what the
/// layouts' drafts give. Empty below two frames.
fn distribution(features: &[Vec<Vec<f64>>; 4]) -> anyhow::Result<Value> {
    let [others, worlds, generated, drafts] = features;
    if others.len() < 2 {
        return Ok(Value::Null);
    }
    let gaussian = Kernel::median_gaussian(others, worlds);
    let mut report = json!({ "n": others.len(), "extractor": "f3d.safetensors, 192 features" });
    for (name, set) in [("worlds", worlds), ("generated", generated), ("drafts", drafts)] {
        let kernel = |kernel| -> anyhow::Result<Value> {
            let (mean, half) = mmd2_with_interval(kernel, others, set, SUBSETS)?;
            Ok(json!({ "mean": mean, "ci95": half }))
        };
        report[name] = json!({
            "f3d": frechet_distance(others, set)?,
            "kid": kernel(Kernel::Cubic)?,
            "mmd2_gaussian": kernel(gaussian)?,
        });
    }
    Ok(report)
}

/// True if a voxel above the ground is occupied: the road is the layout's business.
fn standing(grid: &VoxelGrid, x: usize, y: usize) -> impl Iterator<Item = bool> {
    grid.column(x, y)[1..].iter().map(|l| *l != Class::FREE)
}

/// The columns of the square in which most stands.
fn fullest_square(grid: &VoxelGrid) -> Vec<[usize; 2]> {
    let square = |x0: usize, y0: usize| {
        let ys = move |x| (y0..y0 + REDRAWN).map(move |y| [x, y]);
        (x0..x0 + REDRAWN).flat_map(ys).collect::<Vec<_>>()
    };
    let starts = || (PLACE_STEP..GridSpec::NX - REDRAWN - PLACE_STEP).step_by(PLACE_STEP);
    let squares = starts().flat_map(|x| starts().map(move |y| square(x, y)));
    let count = |c: &Vec<[usize; 2]>| {
        let each = c
            .iter()
            .map(|[x, y]| standing(grid, *x, *y).filter(|s| *s).count());
        each.sum::<usize>()
    };
    squares.max_by_key(count).unwrap_or_default()
}

/// Draws a whole scene of a world's layout, character and steps that sees nothing of the world, puts what it drew into the
/// world's fullest square, and redraws that square from fresh noise: so nothing, not even the latents around, knows what
/// stood there. Of the redrawn square and of the whole scene's, IoU of what stands in it with the world there, and of what
/// stands along its border with the world's columns right outside: walls and hedges should go on. Means of some draws.
fn redrawn_iou(pipeline: &mut OccPipeline, job: &Job) -> anyhow::Result<[[f64; 2]; 2]> {
    let frame = job.scene.frame();
    let truth = &frame.occupancy;
    let square = fullest_square(truth);
    let mut columns = vec![false; GridSpec::COLUMNS];
    square
        .iter()
        .for_each(|[x, y]| columns[x * GridSpec::NY + y] = true);
    let density = Density::of(truth, frame.layout.cells());
    let mut job = Job {
        params: GenParams {
            strength: 1.0,
            keep_objects: false,
            seed: job.params.seed,
            named: Named::default().or(&density),
            ..GenParams::default()
        },
        ..job.clone()
    };
    let ctx = JobCtx::detached();
    let region = Region::of_columns(columns.clone());
    // What stands in the square, and right beside it against what was drawn along its border.
    let shares = |drawn: &VoxelGrid| {
        let [mut inside, mut seam] = [[0u64; 2]; 2];
        let count = |sums: &mut [u64; 2], a: [usize; 2], b: [usize; 2]| {
            for (a, b) in standing(truth, a[0], a[1]).zip(standing(drawn, b[0], b[1])) {
                sums[0] += u64::from(a && b);
                sums[1] += u64::from(a || b);
            }
        };
        for [x, y] in &square {
            count(&mut inside, [*x, *y], [*x, *y]);
            for outside in [[x - 1, *y], [x + 1, *y], [*x, y - 1], [*x, y + 1]] {
                if !columns[outside[0] * GridSpec::NY + outside[1]] {
                    count(&mut seam, outside, [*x, *y]);
                }
            }
        }
        [inside, seam].map(|[both, either]| both as f64 / either.max(1) as f64)
    };
    let mut mean = [[0.0; 2]; 2];
    for draw in 0..DRAWS {
        job.params.seed = job.params.seed.wrapping_add(draw);
        job.params.region = RegionMode::Full;
        let blind = pipeline.run(&job, &ctx)?;
        let mut other = job.clone();
        other.params.region = RegionMode::Auto;
        other.params.seed = job.params.seed.wrapping_add(OTHER_SEED);
        let frame = Arc::make_mut(&mut other.scene).frame_mut();
        let source = Arc::make_mut(&mut frame.source);
        for [x, y] in &square {
            let drawn = blind.occupancy.column(*x, *y);
            source.occupancy.column_mut(*x, *y).copy_from_slice(drawn);
        }
        frame.occupancy = source.occupancy.clone();
        let seen = pipeline.redraw_region(&other, region.clone(), &ctx)?;
        for (mean, result) in mean.iter_mut().zip([seen, blind]) {
            for (mean, share) in mean.iter_mut().zip(shares(&result.occupancy)) {
                *mean += share / DRAWS as f64;
            }
        }
    }
    Ok(mean)
}

/// What context adds, frame by frame: of the square (0) or of its seam (1).
fn gain(redrawn: &[[Vec<f64>; 2]; 2], of: usize) -> Value {
    let pairs = redrawn[0][of].iter().zip(&redrawn[1][of]);
    with_interval(&pairs.map(|(seen, blind)| seen - blind).collect::<Vec<_>>())
}
