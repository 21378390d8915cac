//! `sceneloom dataset`: training and evaluation data from procedural worlds.

use std::path::PathBuf;

use anyhow::Context;

use super::progress::Progress;
use super::{Common, Outcome, output};
use crate::generation::dataset;

/// Arguments.
#[derive(clap::Args)]
pub struct Dataset {
    /// What the frames hold.
    #[arg(value_parser = ["occupancy"])]
    kind: String,
    /// Number of frames.
    #[arg(long, value_name = "N")]
    frames: usize,
    /// Fixes the worlds; use different seeds for training, validation and test.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder to write shards into; shards that are there already are kept.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    common: Common,
}

impl Dataset {
    pub(super) fn run(self) -> Outcome {
        let progress = Progress::new(&self.common);
        let start = std::time::Instant::now();
        let report = dataset::write_occupancy(&self.output, self.frames, self.seed, |done| {
            progress.at(&self.kind, done, self.frames);
            true
        })
        .with_context(|| format!("write {}", self.output.display()))?;
        progress.done();
        let mut json = serde_json::to_value(&report)?;
        json["frames_per_s"] = (self.frames as f64 / start.elapsed().as_secs_f64()).into();
        output::report(&self.common, &json, || {
            format!(
                "{}: {} frames, {} bytes written",
                self.output.display(),
                report.frames,
                report.bytes
            )
        });
        Ok(())
    }
}
