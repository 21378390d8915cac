//! Measures settings on edits and scenes, in this process or in several of their own, one after another.

use std::collections::BTreeMap;
use std::sync::Arc;

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use super::{Progress, Trade};
use crate::trade::cases::Case;
use crate::trade::edits::{Bench, Outcome};
use formats::input;
use job::JobCtx;
use nets::OccModels;

/// Outcomes of every setting on every case, as one process found them.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Raw {
    /// By part: names of cases and, for each, outcomes in the order of the settings.
    pub(super) parts: BTreeMap<String, Vec<(String, Vec<Outcome>)>>,
}

impl Trade {
    /// Measures in this process.
    pub(super) fn measure(&self, models: &Arc<OccModels>, progress: &Progress) -> anyhow::Result<Raw> {
        let bench = Bench {
            models: models.clone(),
            reference_steps: self.reference_steps(),
            kept_in: self.keep_references.clone(),
        };
        if let Some(dir) = &bench.kept_in {
            std::fs::create_dir_all(dir).with_context(|| format!("create {}", dir.display()))?;
        }
        let mut raw = Raw::default();
        for part in ["edit", "scene"].into_iter().filter(|p| self.has(p)) {
            let (base, settings) = self.settings(part);
            let found = self.cases(part)?;
            // Those of one scene share what makes it ready.
            let scenes: Vec<&[Case]> = found.chunk_by(|a, b| Arc::ptr_eq(&a.before, &b.before)).collect();
            for (i, some) in scenes.iter().enumerate() {
                let seed = self.seed ^ i as u64 ^ self.process << 32;
                let all = scenes.len() * settings.len();
                let told = |k| progress.at(part, i * settings.len() + k, all);
                let ctx = JobCtx::detached();
                let outcomes = bench.run(some, &settings, self.repeats(), base, seed, &ctx, told)?;
                let named = some.iter().map(|c| c.name.clone()).zip(outcomes);
                raw.parts.entry(part.into()).or_default().extend(named);
            }
        }
        Ok(raw)
    }

    /// Measures in processes of their own, one after another, and puts their times together. Errors must not differ.
    pub(super) fn measure_in_processes(&self, processes: usize, progress: &Progress) -> anyhow::Result<Raw> {
        let dir = tempfile::tempdir().context("make a folder for the processes' reports")?;
        let references = self
            .keep_references
            .clone()
            .unwrap_or_else(|| dir.path().join("references"));
        let mut all: Option<Raw> = None;
        for i in 0..processes {
            progress.at("process", i, processes);
            let file = dir.path().join(format!("{i}.json"));
            let mut command =
                std::process::Command::new(std::env::current_exe().context("find this program")?);
            command
                .arg("trade")
                .args(&self.scene)
                .args(["--raw", "--suite", &self.suite]);
            let numbers = [
                ("--frames", self.frames().to_string()),
                ("--repeats", self.repeats().to_string()),
                ("--reference-steps", self.reference_steps().to_string()),
                ("--draws", self.draws.to_string()),
                ("--seed", self.seed.to_string()),
                ("--process", i.to_string()),
                ("--parts", self.parts.join(",")),
            ];
            for (name, value) in numbers {
                command.args([name, &value]);
            }
            if !self.only.is_empty() {
                command.args(["--only", &self.only.join(";")]);
            }
            command
                .arg("--keep-references")
                .arg(&references)
                .arg("-o")
                .arg(&file);
            if let Some(weights) = &self.common.weights {
                command.arg("--weights").arg(weights);
            }
            let ended = command
                .stdout(std::process::Stdio::null())
                .status()
                .context("start a process")?;
            if !ended.success() {
                bail!("process {i} ended with {ended}");
            }
            let text = input::read_text(&file, input::LARGEST_TEXT)?;
            let raw: Raw = serde_json::from_str(&text).with_context(|| file.display().to_string())?;
            match &mut all {
                None => all = Some(raw),
                Some(all) => add_times(all, raw)?,
            }
        }
        all.context("no process")
    }
}

/// Adds the times of another process; everything else must be the same.
fn add_times(all: &mut Raw, more: Raw) -> anyhow::Result<()> {
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
