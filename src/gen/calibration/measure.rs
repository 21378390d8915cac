//! Measures settings on edits and scenes, and merges the measurements of several processes.

use std::collections::BTreeMap;
use std::sync::Arc;

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use super::cases::Case;
use super::edits::{Bench, CaseOutcome};
use super::plan::TradeoffPlan;
use crate::MeasurementProgress;
use job::JobCtx;
use nets::OccModels;

/// Outcomes of every setting on every case, as one process found them.
#[derive(Default, Serialize, Deserialize)]
pub struct Raw {
    /// Names of cases by part, each with its outcomes in the order of the settings.
    pub parts: BTreeMap<String, Vec<(String, Vec<CaseOutcome>)>>,
}

impl TradeoffPlan {
    /// Measures in this process. Errors if the scene or the folder for references cannot be used.
    pub fn measure(
        &self,
        models: &Arc<OccModels>,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<Raw> {
        let bench = Bench {
            models: models.clone(),
            reference_steps: self.reference_steps,
            kept_in: self.keep_references.clone(),
        };
        if let Some(dir) = &bench.kept_in {
            std::fs::create_dir_all(dir).with_context(|| format!("create {}", dir.display()))?;
        }
        let mut raw = Raw::default();
        for part in ["edit", "scene"].into_iter().filter(|p| self.has(p)) {
            let (base, settings) = self.settings(part);
            let found = self.cases(part)?;
            // Cases of one scene share its preparation.
            let scenes: Vec<&[Case]> = found.chunk_by(|a, b| Arc::ptr_eq(&a.before, &b.before)).collect();
            for (i, some) in scenes.iter().enumerate() {
                let seed = self.seed ^ i as u64 ^ self.process << 32;
                let all = scenes.len() * settings.len();
                let told = |k| progress.at(part, i * settings.len() + k, all);
                let ctx = JobCtx::detached();
                let outcomes = bench.run(some, &settings, self.repeats, base.clone(), seed, &ctx, told)?;
                let named = some.iter().map(|c| c.name.clone()).zip(outcomes);
                raw.parts.entry(part.into()).or_default().extend(named);
            }
        }
        Ok(raw)
    }
}

/// Adds the times of another process. Errors if its cases, errors or hashes differ.
pub fn add_times(all: &mut Raw, more: Raw) -> anyhow::Result<()> {
    for (part, cases) in more.parts {
        let known = all
            .parts
            .get_mut(&part)
            .context("a process measured another part")?;
        for ((name, known), (other, outcomes)) in known.iter_mut().zip(cases) {
            if *name != other || known.len() != outcomes.len() {
                bail!("processes measured different cases: {name}, {other}");
            }
            for (known, outcome) in known.iter_mut().zip(outcomes) {
                if known.error.to_bits() != outcome.error.to_bits()
                    || known.untouched_hash != outcome.untouched_hash
                {
                    bail!(
                        "{name}: two processes disagree ({} and {} of the voxels differ)",
                        known.error,
                        outcome.error
                    );
                }
                known.wall_s.extend(outcome.wall_s);
            }
        }
    }
    Ok(())
}
