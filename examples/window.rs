//! Opens the window on a random world with a stand-in for the networks, to look at the user
//! interface alone: `cargo run --release --example window -- [seed]`.

use std::sync::Arc;
use std::time::Duration;

use sceneloom::app::{AppConfig, run_window_with};
use sceneloom::generation::composite::{composite, untouched_voxels_changed};
use sceneloom::generation::job::{
    GenError, GenParams, GenReport, GenResult, Job, JobCtx, Pipeline, RegionMode, Stage,
};
use sceneloom::generation::region::Region;
use sceneloom::generation::world::{World, voxelize};
use sceneloom::scene::{Frame, Scene, draft};

/// Redraws the region as a draft, with pauses where the networks would work.
struct StandIn;

impl Pipeline for StandIn {
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        let (frame, steps) = (job.scene.frame(), job.params.steps as usize);
        let region = match job.params.region {
            RegionMode::Auto => Region::of_edit(frame, job.params.halo_columns as usize),
            RegionMode::Full => Region::full(),
        };
        for step in 0..steps {
            ctx.progress(Stage::Denoise, step, steps)?;
            std::thread::sleep(Duration::from_millis(150));
        }
        let new = draft::draft(&frame.layout, frame.boxes.values());
        let source = &frame.source.occupancy;
        let occupancy = composite(source, &new, &region, &frame.painted);
        let report = GenReport {
            network_calls: 2 * steps,
            untouched_voxels_changed: untouched_voxels_changed(source, &occupancy, &region, &frame.painted),
            voxels_changed: source.count_different(&occupancy),
            ..GenReport::default()
        };
        Ok(GenResult {
            key: job.key(),
            frame: job.scene.current,
            occupancy,
            report,
        })
    }
}

fn world(seed: u64) -> Scene {
    let world = World::random(seed);
    let occupancy = voxelize::complete(&world, voxelize::Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    Scene::single(&format!("World {seed}"), frame, Arc::default(), seed)
}

fn main() -> anyhow::Result<()> {
    let seed = std::env::args().nth(1).map_or(Ok(7), |s| s.parse())?;
    run_window_with(AppConfig {
        scene: world(seed),
        path: None,
        build_pipeline: Box::new(|| Ok(Box::new(StandIn))),
        params: GenParams::default(),
        full_params: GenParams {
            region: RegionMode::Full,
            ..GenParams::default()
        },
        warm_up: false,
        open: Arc::new(|path| anyhow::bail!("this example opens nothing, not {}", path.display())),
        save: Arc::new(|_, path| anyhow::bail!("this example saves nothing, not {}", path.display())),
        new_scene: Arc::new(move || Ok(world(seed + 1))),
        native_dialogs: true,
    })
}
