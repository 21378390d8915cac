//! `sceneloom history`: the steps that led to a scene, as its file keeps them: listed, replayed, one of them left out.

use std::path::PathBuf;

use anyhow::{Context, anyhow};
use serde_json::json;

use super::{CommandResult, Common, Stop, document, output};
use app::open;
use editor::{Document, HistoryStep};

/// Arguments.
#[derive(clap::Args)]
pub struct History {
    /// Scene whose history is meant.
    scene: PathBuf,
    /// Replay all steps from the origin; exit 1 if that gives another scene than the file holds, or the history is damaged.
    #[arg(long)]
    replay: bool,
    /// Leave this step out and apply the later ones again; its number as listed.
    #[arg(long, value_name = "STEP", requires = "output")]
    leave_out: Option<usize>,
    /// Scene to write with --leave-out.
    #[arg(short, long, value_name = "S.loom", requires = "leave_out")]
    output: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl History {
    pub(super) fn run(self) -> CommandResult {
        let (mut document, note) = Document::open(open::scene(&self.scene)?);
        match note {
            Some(note) if self.replay => return Err(Stop::Short(note)),
            Some(note) => eprintln!("sceneloom: {note}"),
            None => {}
        }
        let name = || self.scene.display().to_string();
        let replayed = match self.replay {
            true => Some(document.replays().map_err(|e| anyhow!(e)).with_context(name)?),
            false => None,
        };
        let left = self.leave_out.map(|step| document.leave_out(step)).transpose();
        let left = left.with_context(name)?;
        if let Some(path) = &self.output {
            document::save(path, &document)?;
        }
        let (steps, shown) = (document.history_steps(), document.position());
        let of = |(i, step): (usize, &HistoryStep<'_>)| {
            json!({
                "step": i,
                "name": step.label,
                "author": step.author.map(|author| author.name()),
                "left_out": step.is_left_out,
            })
        };
        let report = json!({
            "steps": steps.iter().enumerate().map(of).collect::<Vec<_>>(),
            "shown": shown,
            "replays": replayed,
            "skipped": left.as_ref().map(|left| &left.skipped),
            "files": self.output.iter().collect::<Vec<_>>(),
        });
        output::report(&self.common, &report, || {
            let line = |(i, step): (usize, &HistoryStep<'_>)| {
                let here = if i == shown { ">" } else { " " };
                let author = step.author.map_or(String::new(), |a| format!(" ({})", a.name()));
                let out = if step.is_left_out { ", left out" } else { "" };
                format!("{here}{i:4} {}{author}{out}", step.label)
            };
            let mut lines: Vec<String> = steps.iter().enumerate().map(line).collect();
            if replayed == Some(true) {
                lines.push("replayed from its origin: the same scene".into());
            }
            let skipped = left.iter().flat_map(|left| &left.skipped);
            lines.extend(skipped.map(|skipped| format!("not applied: {skipped}")));
            lines.join("\n")
        });
        match replayed {
            Some(false) => Err(Stop::Short("replaying the history gives another scene".into())),
            _ => Ok(()),
        }
    }
}
