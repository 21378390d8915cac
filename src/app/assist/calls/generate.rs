//! `generate`: voxels by the networks.

use std::collections::BTreeMap;

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::names;
use crate::call::Operation;
use crate::desk::{Desk, Done};
use authoring::whole::scenery_first;
use editor::Document;
use job::{GenParams, Job, JobCtx, Pipeline};
use scene::Scene;
use scene::message::quoted;
use trade::Presets;

/// Arguments of `generate`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GenerateCall {
    /// A preset of speed against accuracy, the fastest first; a usual one if left out.
    #[serde(default)]
    #[schemars(schema_with = "names::preset")]
    quality: Option<String>,
    /// Sampling steps instead of the preset's: more are slower and nearer to the reference, which is not less invented.
    #[serde(default)]
    #[schemars(range(min = 1, max = 1000))]
    steps: Option<u32>,
    /// Fixes every random draw.
    #[serde(default)]
    seed: u64,
    /// All of the map from fresh noise; otherwise only what was edited since it was generated, and everything else stays
    /// bit-identical.
    #[serde(default)]
    whole: bool,
}

/// Receipt of `generate`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Generated {
    /// Changes of the scene.
    #[serde(flatten)]
    done: Done,
    /// Columns that were generated.
    region_columns: usize,
    /// Voxels outside of them that changed: 0.
    untouched_voxels_changed: usize,
    /// Calls of the denoising network.
    network_calls: usize,
    /// Time by stage, s.
    wall_s: BTreeMap<String, f64>,
    /// Remarks on the generation.
    notes: Vec<String>,
}

impl GenerateCall {
    fn params(&self) -> anyhow::Result<GenParams> {
        let usual = match self.whole {
            true => GenParams::whole_scene(),
            false => GenParams::default(),
        };
        let preset = match &self.quality {
            None => usual,
            Some(name) => match Presets::bundled().named(name) {
                Some(preset) => preset.knobs.on(usual),
                None => {
                    let shown = quoted(name, 60);
                    bail!(
                        "quality is {shown:?}, expected one of {}",
                        names::presets().join(", ")
                    );
                }
            },
        };
        Ok(GenParams {
            steps: self.steps.unwrap_or(preset.steps),
            seed: self.seed,
            ..preset
        })
    }
}

impl Operation for GenerateCall {
    const NAME: &'static str = "generate";
    const ABOUT: &'static str = "Lets the networks draw the voxels under what was edited since they last did (or of the whole map), so that they follow map and boxes. One undo step. Takes from a second to minutes: the quality decides.";
    const EXAMPLE: &'static str = r#"{"quality": "draft", "seed": 0}"#;
    const CHANGES: bool = true;
    type Receipt = Generated;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Generated> {
        let params = self.params()?;
        let scene = desk.scene()?;
        // On a copy: scenery and voxels become one step of the document together.
        let mut copy = Document::new(Scene::clone(&scene));
        copy.apply_all("Draw scenery", &scenery_first(&scene, &params)?)?;
        let job = Job {
            scene: copy.scene().clone(),
            params,
        };
        let stop = desk.stop.clone();
        let (stop, report) = (|| stop(), |_| {});
        let result = desk.pipeline()?.run(&job, &JobCtx::new(&stop, &report))?;
        copy.adopt(result.rev(), result.occupancy.clone())?;
        let report = result.report;
        let wall_s = report.wall_s.iter().map(|(stage, s)| ((*stage).to_owned(), *s));
        Ok(Generated {
            done: desk.take_over("Generate".into(), copy)?,
            region_columns: report.region_columns,
            untouched_voxels_changed: report.untouched_voxels_changed,
            network_calls: report.network_calls,
            wall_s: wall_s.collect(),
            notes: report.notes,
        })
    }
}
