//! Value of context: a square of a world inpainted, with and without its surroundings.

use std::sync::Arc;

use serde_json::{Value, json};

use super::OTHER_SEED;
use crate::suite::with_interval;
use job::pipeline::OccPipeline;
use job::region::Region;
use job::{ChosenDensities, GenParams, Job, JobCtx, Pipeline, RegionMode};
use scene::{Class, Density, VoxelGrid, Window};

/// Side of the square, columns; how often it is inpainted; and the step of its places.
const SIDE: usize = 28;
const DRAWS: u64 = 3;
const PLACE_STEP: usize = 12;

/// IoU of inpainted squares frame by frame: with context and without; in the square, along its seam.
#[derive(Default)]
pub struct Inpainted([[Vec<f64>; 2]; 2]);

impl Inpainted {
    /// Inpaints the fullest square of the job's world.
    pub fn add(&mut self, pipeline: &mut OccPipeline, job: &Job) -> anyhow::Result<()> {
        for (shares, of) in self.0.iter_mut().zip(inpainted_iou(pipeline, job)?) {
            shares.iter_mut().zip(of).for_each(|(all, one)| all.push(one));
        }
        Ok(())
    }

    /// Means with intervals, and what context adds.
    pub fn report(&self) -> Value {
        json!({
            "redrawn_square_iou": with_interval(&self.0[0][0]),
            "redrawn_square_iou_without_context": with_interval(&self.0[1][0]),
            "seam_iou": with_interval(&self.0[0][1]),
            "seam_iou_without_context": with_interval(&self.0[1][1]),
            "redrawn_square_iou_gain_of_context": gain(&self.0, 0),
            "seam_iou_gain_of_context": gain(&self.0, 1),
        })
    }
}

/// Whether each voxel above the ground is occupied; the road is left out, since the layout gives it.
fn standing(grid: &VoxelGrid, x: usize, y: usize) -> impl Iterator<Item = bool> {
    grid.column(x, y)[1..].iter().map(|l| *l != Class::FREE)
}

/// The columns of the square with the most occupied voxels above the ground.
fn fullest_square(grid: &VoxelGrid) -> Vec<[usize; 2]> {
    let square = |x0: usize, y0: usize| {
        let ys = move |x| (y0..y0 + SIDE).map(move |y| [x, y]);
        (x0..x0 + SIDE).flat_map(ys).collect::<Vec<_>>()
    };
    let starts = || (PLACE_STEP..Window::NX - SIDE - PLACE_STEP).step_by(PLACE_STEP);
    let squares = starts().flat_map(|x| starts().map(move |y| square(x, y)));
    let count = |c: &Vec<[usize; 2]>| {
        let each = c
            .iter()
            .map(|[x, y]| standing(grid, *x, *y).filter(|s| *s).count());
        each.sum::<usize>()
    };
    squares.max_by_key(count).unwrap_or_default()
}

/// Mean IoU with the world over some draws, inside the square and along its seam: first of an inpainted square, then of
/// a whole scene drawn without context.
///
/// A whole scene is drawn from the world's layout, character and steps, and sees nothing of the world. It is put into
/// the world's fullest square, and that square is inpainted from fresh noise: neither labels nor latents around carry
/// what stood there. Each IoU is taken inside the square, and along its border against the world's columns right
/// outside: walls and hedges should go on.
fn inpainted_iou(pipeline: &mut OccPipeline, job: &Job) -> anyhow::Result<[[f64; 2]; 2]> {
    let frame = job.scene.frame();
    let truth = &frame.occupancy;
    let square = fullest_square(truth);
    let mut columns = vec![false; Window::COLUMNS];
    square
        .iter()
        .for_each(|[x, y]| columns[x * Window::NY + y] = true);
    let density = Density::from_grid(truth, frame.layout.cells());
    let mut job = Job {
        params: GenParams {
            strength: 1.0,
            keep_objects: false,
            seed: job.params.seed,
            named: ChosenDensities::default().or(&density),
            ..GenParams::default()
        },
        ..job.clone()
    };
    let ctx = JobCtx::detached();
    let region = Region::of_columns(columns.clone());
    // Compares the square, and the columns drawn along its border with the world's columns right beside it.
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
                if !columns[outside[0] * Window::NY + outside[1]] {
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
        Arc::make_mut(&mut other.scene).change_canvas(|frame| {
            let source = Arc::make_mut(&mut frame.source);
            for [x, y] in &square {
                let drawn = blind.occupancy.column(*x, *y);
                source.occupancy.column_mut(*x, *y).copy_from_slice(drawn);
            }
            frame.occupancy = source.occupancy.clone();
        });
        let seen = pipeline.inpaint_region(&other, region.clone(), &ctx)?;
        for (mean, result) in mean.iter_mut().zip([seen, blind]) {
            for (mean, share) in mean.iter_mut().zip(shares(&result.occupancy)) {
                *mean += share / DRAWS as f64;
            }
        }
    }
    Ok(mean)
}

/// Gain by context, frame by frame: in the square (0) or along its seam (1).
fn gain(inpainted: &[[Vec<f64>; 2]; 2], of: usize) -> Value {
    let pairs = inpainted[0][of].iter().zip(&inpainted[1][of]);
    with_interval(&pairs.map(|(seen, blind)| seen - blind).collect::<Vec<_>>())
}
