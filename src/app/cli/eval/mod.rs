//! `sceneloom eval`: quality on held-out worlds, with 95 % intervals over scenes. The networks' own
//! output is judged: drafts are not put in for boxes that they left out.

mod editing;
mod generation;
mod layout;
mod layout_check;
mod layout_placers;
mod lidar;
mod splat;
mod vae;
mod vae_slopes;
mod world;
mod world_complete;
mod world_lidar;

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::cli::generate::models;
use crate::cli::progress::Progress;
use crate::cli::{Common, Gen, Outcome, Stop, output};
use crate::open;
use dataset::world_of;
use job::pipeline::OccPipeline;
use metrics::stats::mean_ci95;
use scene::Scene;

/// Seed of the held-out worlds; training uses 1, validation 2.
const TEST_SEED: u64 = 3;

/// Arguments.
#[derive(clap::Args)]
pub struct Eval {
    /// What is measured.
    #[arg(value_parser = ["world", "splat", "vae", "generation", "editing", "lidar", "layout"])]
    suite: String,
    /// Number of held-out worlds, or of frames of --data.
    #[arg(long, value_name = "N", default_value_t = 24)]
    frames: usize,
    /// Folder of Occ3D frames (`labels.npz`, at any depth) to judge the VAE or edits by instead.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Vehicles of a scene that are removed, moved and changed, one by one, at most (editing).
    #[arg(long, value_name = "N", default_value_t = 6)]
    vehicles: usize,
    /// Stops of the quality slider to judge, comma-separated; all but the reference if none is named (editing).
    #[arg(long, value_name = "STOPS", value_delimiter = ',')]
    presets: Vec<String>,
    /// Random edits, one after another, that must change nothing outside their regions (editing).
    #[arg(long, value_name = "N", default_value_t = 0)]
    random_edits: usize,
    /// Worlds on which every inversion scheme is tried with 5, 10, 20 and 50 steps (editing).
    #[arg(long, value_name = "N", default_value_t = 0)]
    scheme_frames: usize,
    /// Worlds on which a removal is compared with one of 1000 steps (editing); minutes each.
    #[arg(long, value_name = "N", default_value_t = 0)]
    reference_frames: usize,
    /// Sentences to judge (layout): a file of one JSON object a line, or a folder of such files; tests/words/dev if none is named.
    #[arg(long, value_name = "FILE")]
    prompts: Option<PathBuf>,
    /// Who reads the sentences (layout).
    #[arg(long, value_enum, default_value_t)]
    reader: layout::Who,
    /// Prompts on which the placers are compared, with and without memory (layout); 0 leaves that out.
    #[arg(long, value_name = "N", default_value_t = 60)]
    placer_prompts: usize,
    /// Only the table of worlds, generated scenes and drafts: no ablations of layout and boxes, no redrawn squares (generation).
    #[arg(long)]
    rows_only: bool,
    /// Fail (exit 1) if a bar of the suite is missed.
    #[arg(long)]
    bar: bool,
    #[command(flatten)]
    generation: Gen,
    #[command(flatten)]
    common: Common,
}

fn with_interval(values: &[f64]) -> Value {
    let (mean, half) = mean_ci95(values);
    let round = |v: f64| (v * 1e4).round() / 1e4;
    json!({ "mean": round(mean), "ci95": round(half), "n": values.len() })
}

/// Held-out world `index` as a scene with complete occupancy.
fn scene(index: u64) -> Scene {
    let (world, seed) = world_of(TEST_SEED, index, |_| None);
    let mut scene = open::of_world(&world, "held out");
    scene.seed = seed;
    scene
}

/// One bar: name, figure, the least it should be.
type Bar = (&'static str, f64, f64);

impl Eval {
    pub(super) fn run(self) -> Outcome {
        let progress = Progress::new(&self.common);
        let (mut report, bars) = if self.suite == "world" {
            self.world(&progress)?
        } else if self.suite == "splat" {
            self.splat(&progress)?
        } else if self.suite == "lidar" {
            self.lidar(&progress)?
        } else if self.suite == "layout" {
            self.layout(&progress)?
        } else {
            let mut pipeline = OccPipeline::new(models(self.common.weights.as_deref())?);
            let (mut report, bars) = match self.suite.as_str() {
                "vae" => match &self.data {
                    Some(dir) => self.vae_on_files(dir, &pipeline, &progress)?,
                    None => self.vae(&pipeline, &progress)?,
                },
                "generation" => self.generation(&mut pipeline, &progress)?,
                _ => self.editing(&mut pipeline, &progress)?,
            };
            report["model"] = pipeline.models().card.name.clone().into();
            (report, bars)
        };
        progress.done();
        report["seeds"] = json!({ "test": TEST_SEED });
        let n = report.get("files").or(report.get("prompts")).cloned();
        report["n"] = n.unwrap_or_else(|| self.frames.into());
        let missed: Vec<String> = bars
            .iter()
            .filter(|(_, found, least)| found.is_nan() || found < least)
            .map(|(name, found, least)| format!("{name} {found:.3} below {least}"))
            .collect();
        report["bars"] = bars
            .iter()
            .map(|(name, found, least)| json!({ "name": name, "found": found, "least": least }))
            .collect();
        output::report(&self.common, &report, || match self.suite.as_str() {
            "generation" => generation::table(&report),
            _ => serde_json::to_string_pretty(&report).unwrap_or_default(),
        });
        if self.bar && !missed.is_empty() {
            return Err(Stop::Short(missed.join("; ")));
        }
        Ok(())
    }
}
