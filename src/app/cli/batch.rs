//! `sceneloom batch`: many variants of a scene by a plan.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::json;

use super::progress::ProgressLine;
use super::{CommandResult, Common, Stop, output};
use app::batch::{self, BatchPlan, Shard};

/// Arguments.
#[derive(clap::Args)]
pub struct Batch {
    /// JSON plan (docs/batches.md).
    plan: PathBuf,
    /// Folder to write into; what is there already of the same plan is kept.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Make this part of the batch alone: I of N, from 0. Parts need not know of each other.
    #[arg(long, value_name = "I/N", default_value = "0/1")]
    shard: Shard,
    /// Read the plan, say how many variants it has, and write nothing.
    #[arg(long)]
    dry: bool,
    #[command(flatten)]
    common: Common,
}

impl Batch {
    pub(super) fn run(self) -> CommandResult {
        let plan = BatchPlan::read(&self.plan)?;
        if self.dry {
            let count = plan.count();
            output::report(&self.common, &json!({ "variants": count }), || {
                format!("{count} variants")
            });
            return Ok(());
        }
        let start = Instant::now();
        let folder = self.plan.parent().unwrap_or(Path::new(""));
        let batch = batch::Batch::new(plan, folder, &self.output)?;
        let progress = ProgressLine::new(&self.common);
        let report = batch.run(self.shard, &mut |p| {
            progress.at("variants", p.done, p.of);
            true
        })?;
        progress.done();
        let value = json!({
            "variants": report.variants,
            "done": report.made + report.kept,
            "made": report.made,
            "kept": report.kept,
            "failed": report.failed.iter().map(|(v, why)| json!({ "variant": v, "error": why })).collect::<Vec<_>>(),
            "open": report.open,
            "index": report.index,
            "wall_s": start.elapsed().as_secs_f64(),
        });
        output::report(&self.common, &value, || {
            let mut lines = vec![format!(
                "{}: {} made, {} there already, {} failed, {} open",
                self.output.display(),
                report.made,
                report.kept,
                report.failed.len(),
                report.open
            )];
            lines.extend(report.failed.iter().map(|(v, why)| format!("variant {v}: {why}")));
            lines.join("\n")
        });
        match report.failed.first() {
            None => Ok(()),
            Some((v, why)) => Err(Stop::Short(format!(
                "{} variants could not be made; the first is {v}: {why}",
                report.failed.len()
            ))),
        }
    }
}
