//! Value of inversion: the same edits from the noise that the source comes from, and from fresh noise.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::{Value, json};

use super::tally::InventionTally;
use super::trial_run::try_edit;
use calibration::trials::Trial;
use job::pipeline::OccPipeline;
use job::{GenParams, Job, JobCtx};
use scene::Scene;

/// Starts: name, and share of the steps at which fresh noise is put in; 0 is inversion.
const STARTS: [(&str, f64); 3] = [
    ("inversion", 0.0),
    ("fresh_noise_half", 0.5),
    ("fresh_noise_all", 1.0),
];
/// Edits of a kind in a scene, at most: fresh noise computes every token.
const MOST: usize = 2;

/// Figures by kind of edit and start.
#[derive(Default)]
pub struct Fresh(BTreeMap<&'static str, [InventionTally; 3]>);

impl Fresh {
    /// Tries the first removals and additions of a scene from every start, with the same steps.
    pub fn add(
        &mut self,
        pipeline: &OccPipeline,
        scene: &Scene,
        trials: &[(&'static str, Trial)],
        params: GenParams,
    ) -> anyhow::Result<()> {
        let mut ready = pipeline.clone();
        let job = Job {
            scene: Arc::new(scene.clone()),
            params: params.clone(),
        };
        ready.prepare(&job, &JobCtx::detached())?;
        for kind in ["remove", "add"] {
            let chosen = trials.iter().filter(|(k, _)| *k == kind).take(MOST);
            for (kind, trial) in chosen {
                for (i, (_, strength)) in STARTS.iter().enumerate() {
                    let params = GenParams {
                        strength: *strength,
                        ..params.clone()
                    };
                    let tried = try_edit(&ready, scene, trial, params)?;
                    self.0.entry(kind).or_default()[i].add(&tried);
                }
            }
        }
        Ok(())
    }

    /// Figures by kind and start.
    pub fn report(&self) -> Value {
        let each = self.0.iter().map(|(kind, starts)| {
            let by_start = STARTS.iter().zip(starts);
            let by_start: Value = by_start
                .map(|((name, _), t)| ((*name).to_owned(), t.report()))
                .collect();
            ((*kind).to_owned(), json!(by_start))
        });
        each.collect()
    }
}
