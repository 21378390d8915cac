//! `sceneloom prompt`: a scene from words, or an edit of a scene by words.

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::json;

use super::new::class_counts;
use super::{Common, Outcome, Stop, output};
use crate::app::prompting::{How, Keep, Placer};
use crate::app::{enrich, open, text};
use crate::editor::Document;
use crate::formats::project;

/// Arguments.
#[derive(clap::Args)]
pub struct Prompt {
    /// What the scene should hold, or what should change in it.
    text: String,
    /// Scene to edit; without one a new scene is made.
    #[arg(long, value_name = "S.loom")]
    base: Option<PathBuf>,
    /// Fixes every random draw.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom")]
    output: PathBuf,
    /// Who places the objects.
    #[arg(long, value_enum, default_value_t)]
    placer: Placer,
    /// Fill in what the prompt leaves open from remembered scenes.
    #[arg(long, overrides_with = "no_memory")]
    memory: bool,
    /// Fill in nothing (the default).
    #[arg(long)]
    no_memory: bool,
    /// Folder of your own .loom scenes that are remembered too.
    #[arg(long, value_name = "DIR", requires = "memory")]
    memory_scenes: Option<PathBuf>,
    /// With --base: make a new scene that keeps the road of it, or its objects, instead of editing it.
    #[arg(long, value_name = "WHAT", value_parser = ["road", "objects"], requires = "base")]
    keep: Option<String>,
    /// Language model that fills in what the prompt leaves open: an OpenAI-compatible server, http:// only.
    #[arg(long, value_name = "URL", requires = "model")]
    endpoint: Option<String>,
    /// Its model.
    #[arg(long, value_name = "NAME", requires = "endpoint")]
    model: Option<String>,
    /// How long to wait for it, s.
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    timeout_s: f64,
    #[command(flatten)]
    common: Common,
}

impl Prompt {
    pub(super) fn run(self) -> Outcome {
        match self.base.clone() {
            Some(base) if self.keep.is_none() => self.edit(&base),
            _ => self.make(),
        }
    }

    fn make(self) -> Outcome {
        let mut reading = text::read(&self.text)?;
        if let (Some(endpoint), Some(model)) = (&self.endpoint, &self.model) {
            let timeout = std::time::Duration::try_from_secs_f64(self.timeout_s).context("--timeout-s")?;
            let notes = enrich::enrich(&mut reading.description, &self.text, endpoint, model, timeout)?;
            reading.notes.extend(notes);
        }
        let how = How {
            placer: self.placer,
            memory: self.memory && !self.no_memory,
            own_scenes: self.memory_scenes.clone(),
            weights: self.common.weights.clone(),
            keep: self.kept()?,
            ..How::default()
        };
        let made = text::make(&self.text, &reading.description, self.seed, &how);
        let shortfalls = text::shortfalls(&made.laid);
        project::save(&self.output, &made.scene)?;
        let frame = made.scene.frame();
        let report = json!({
            "description": made.laid.description,
            "graph": made.laid.graphed.graph,
            "placer": self.placer,
            "memory": made.laid.remembered,
            "diffusion": made.laid.diffused,
            "phrases": reading.phrases,
            "not_understood": reading.not_understood,
            "notes": reading.notes.iter().chain(&made.laid.notes).collect::<Vec<_>>(),
            "shortfalls": shortfalls,
            "template": made.laid.road.template,
            "layout_s": made.laid.wall_s,
            "boxes": frame.boxes.len(),
            "occupied_voxels": frame.occupancy.count_set(),
            "classes": class_counts(&made.scene),
            "seed": self.seed,
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            let mut lines = vec![format!(
                "{}: {} boxes; {}",
                self.output.display(),
                frame.boxes.len(),
                reading.description.summary
            )];
            lines.extend(reading.not_understood.iter().map(|u| match &u.why {
                Some(why) => format!("not understood: {:?} ({why})", u.text),
                None => format!("not understood: {:?}", u.text),
            }));
            if let Some(found) = &made.laid.remembered {
                let best = found.scenes.first().map_or("", |s| s.0.as_str());
                lines.push(format!(
                    "from memory: {} (nearest: {best})",
                    found.filled.join(", ")
                ));
            }
            if let Some(d) = &made.laid.diffused {
                lines.push(format!(
                    "by diffusion in {:.2} s; the projection moved boxes by {:.1} m on average, {:.1} m at most; {} placed by rules",
                    d.report.diffusion_s, d.mean_move_m, d.most_move_m, d.by_rules
                ));
            }
            lines.extend(
                reading
                    .notes
                    .iter()
                    .chain(&made.laid.notes)
                    .map(|n| format!("note: {n}")),
            );
            lines.extend(shortfalls.iter().map(|n| format!("short: {n}")));
            lines.join("\n")
        });
        if shortfalls.is_empty() {
            return Ok(());
        }
        Err(Stop::Short(shortfalls.join("; ")))
    }

    fn kept(&self) -> anyhow::Result<Keep> {
        let (Some(keep), Some(base)) = (&self.keep, &self.base) else {
            return Ok(Keep::Nothing);
        };
        let scene = open::scene(base)?;
        let frame = scene.frame();
        Ok(if keep == "road" {
            Keep::Road(std::sync::Arc::new(frame.layout.clone()))
        } else {
            Keep::Objects(std::sync::Arc::new(frame.boxes.clone()))
        })
    }

    fn edit(self, base: &Path) -> Outcome {
        if self.text.trim().is_empty() {
            return Err(anyhow::anyhow!(
                "the prompt is empty: say what should change, such as \"remove the parked car\""
            )
            .into());
        }
        if self.endpoint.is_some() {
            return Err(
                anyhow::anyhow!("--endpoint fills in new scenes; edits by text do not use it").into(),
            );
        }
        let scene = open::scene(base)?;
        let reading = text::read_edit(&self.text, &scene, self.seed);
        let edits = text::all_edits(&reading);
        let mut document = Document::new(scene);
        document
            .apply_all("Edit by text", &edits)
            .context("edit by text")?;
        let asked: Vec<String> = reading.questions.iter().map(|q| q.text.clone()).collect();
        let report = json!({
            "edits": edits,
            "questions": reading.questions,
            "phrases": reading.phrases,
            "not_understood": reading.not_understood,
            "notes": reading.notes,
            "boxes": document.scene().frame().boxes.len(),
            "things": document.scene().background.len(),
            "prompt": *document.scene().prompt,
            "seed": self.seed,
            "file": if asked.is_empty() && !edits.is_empty() { Some(&self.output) } else { None },
        });
        // With an open question nothing is written: the answer may change what the rest means.
        let write = asked.is_empty() && !edits.is_empty();
        if write {
            project::save(&self.output, document.scene())?;
        }
        output::report(&self.common, &report, || {
            let mut lines: Vec<String> = reading
                .phrases
                .iter()
                .map(|p| format!("{:?}: {}", p.text, p.meaning))
                .collect();
            for q in &reading.questions {
                lines.push(q.text.clone());
                lines.extend(
                    q.candidates
                        .iter()
                        .map(|c| format!("  {} {}: {}", c.says(), c.class.replace('_', " "), c.place)),
                );
            }
            lines.extend(reading.not_understood.iter().map(|u| match &u.why {
                Some(why) => format!("not understood: {:?} ({why})", u.text),
                None => format!("not understood: {:?}", u.text),
            }));
            lines.extend(reading.notes.iter().map(|n| format!("note: {n}")));
            lines.join("\n")
        });
        if !asked.is_empty() {
            return Err(Stop::Short(format!(
                "{} Name one, such as \"{}\"",
                asked.join(" "),
                first_answer(&reading)
            )));
        }
        if edits.is_empty() {
            let unread = reading.not_understood.iter().find_map(|u| u.why.clone());
            let why = (reading.notes.first().cloned())
                .or(unread)
                .unwrap_or_else(|| "nothing in the text changes the scene".into());
            return Err(Stop::Short(format!("nothing was changed: {why}")));
        }
        Ok(())
    }
}

fn first_answer(reading: &crate::generation::text::edit::EditReading) -> String {
    reading
        .questions
        .first()
        .and_then(|q| q.candidates.first())
        .map_or_else(|| "#1".into(), |c| c.says())
}
