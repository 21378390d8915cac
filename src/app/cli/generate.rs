//! `sceneloom generate`: occupancy from layout and boxes, then the sensors.

use std::path::PathBuf;
use std::time::Instant;

use serde_json::json;

use super::document;
use super::progress::ProgressLine;
use super::{CommandResult, Common, Gen, Weights, output};
use app::open;
use authoring::whole::scenery_first;
use editor::Document;
use job::pipeline::OccPipeline;
use job::{GenParams, GenResult, Job, Pipeline};
use metrics::agreement::layout_agreement;
use scene::Scene;
use sensors::splat::cloud::GaussianCloud;
use sensors::{lidar, splat};

/// Arguments.
#[derive(clap::Args)]
pub struct GenerateArgs {
    /// Scene to read.
    scene: PathBuf,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom")]
    output: PathBuf,
    /// Let the networks invent what stands beside the roads of a scene that says nothing of it, instead of drawing it by
    /// rules first.
    #[arg(long)]
    bare: bool,
    #[command(flatten)]
    generation: Gen,
    #[command(flatten)]
    weights: Weights,
    #[command(flatten)]
    common: Common,
}

/// Runs the pipeline on a document's scene and adopts the result: as an undo step of that name, or into the step shown.
pub fn run_and_adopt(
    document: &mut Document,
    pipeline: &mut OccPipeline,
    params: GenParams,
    progress: &ProgressLine,
    step: Option<&'static str>,
) -> anyhow::Result<GenResult> {
    let job = Job {
        scene: document.scene().clone(),
        params,
    };
    let result = progress.with_ctx(|ctx| pipeline.run(&job, ctx))?;
    let (of, occupancy) = (result.rev(), result.occupancy.clone());
    match step {
        Some(step) => document.adopt_as_step(step, of, occupancy)?,
        None => document.adopt(of, occupancy)?,
    };
    Ok(result)
}

/// Seconds that a LiDAR sweep and six camera maps of the scene take.
pub fn sense(scene: &Scene) -> (f64, f64) {
    let scene = &*scene.for_sensors();
    let frame = scene.frame();
    let start = Instant::now();
    lidar::rig_sweep(&frame.occupancy, &scene.rig);
    let lidar_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let cloud = GaussianCloud::from_grid(&frame.occupancy, &frame.bev_channels());
    splat::render_rig(&cloud, &scene.rig, 400, 225, &splat::SplatOptions::default());
    (lidar_s, start.elapsed().as_secs_f64())
}

/// Draws scenery first if the scene does not say what kind of place it is; true if it did.
fn draw_scenery(document: &mut Document, params: &GenParams) -> anyhow::Result<bool> {
    let edits = scenery_first(document.scene(), params)?;
    document.apply_all("Generate", &edits)?;
    Ok(!edits.is_empty())
}

impl GenerateArgs {
    pub(super) fn run(self) -> CommandResult {
        let scene = open::scene(&self.scene)?;
        let mut pipeline = OccPipeline::new(self.generation.models(&self.weights)?);
        let progress = ProgressLine::new(&self.common);
        let params = self.generation.params(GenParams::whole_scene())?;
        let before = scene.frame().occupancy.clone();
        let mut document = document::opened(scene);
        let drawn = !self.bare && draw_scenery(&mut document, &params)?;
        let step = (!drawn).then_some("Generate");
        let result = run_and_adopt(&mut document, &mut pipeline, params.clone(), &progress, step)?;
        document::save(&self.output, &document)?;
        let scene = document.scene();
        let (lidar_s, cameras_s) = sense(scene);
        let agreement = layout_agreement(scene.frame());
        let occupied = scene.frame().occupancy.count_set();
        let mut wall_s = serde_json::to_value(&result.report.wall_s)?;
        wall_s["lidar"] = lidar_s.into();
        wall_s["cameras"] = cameras_s.into();
        let report = json!({
            "occupancy": { "occupied_voxels": occupied, "layout_agreement": agreement },
            "network_calls": result.report.network_calls,
            "wall_s": wall_s,
            "peak_rss_mb": output::peak_rss_mb(),
            "scenery_drawn": drawn,
            "objects_kept": result.report.objects_kept,
            "holes_closed": result.report.holes_closed,
            "stems_added": result.report.stems_added,
            "loose_dropped": result.report.loose_dropped,
            "voxels_differ": before.count_different(&scene.frame().occupancy),
            "things_given": result.report.things_given,
            "notes": result.report.notes,
            "seed": params.seed,
            "steps": params.steps,
            "guidance": params.guidance,
            "model": pipeline.models().card.name,
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            let percent = |v: Option<f64>| v.map_or("none".into(), |v| format!("{:.0} %", v * 100.0));
            let notes = result.report.notes.iter().map(|note| format!("\n{note}"));
            let notes: String = notes.collect();
            format!(
                "{}: {occupied} occupied voxels, layout agreement drivable {} vehicles {}, {} network calls, {:.1} s{notes}",
                self.output.display(),
                percent(agreement.drivable),
                percent(agreement.vehicles),
                result.report.network_calls,
                result.report.total_s(),
            )
        });
        Ok(())
    }
}
