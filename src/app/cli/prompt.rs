//! `sceneloom prompt`: a scene from words, or an edit of a scene by words.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use serde_json::json;

use super::document;
use super::generate::run_and_adopt;
use super::new::class_counts;
use super::progress::ProgressLine;
use super::{CommandResult, Common, Stop, Weights, output};
use crate::endpoint::{self, Endpoint};
use app::open;
use app::prompting::{How, Keep, PlacementMethod};
use app::text::{self, Prompted, doubts};
use app::wildcards;
use authoring::new_ground::with_scenery;
use editor::{Document, Edit};
use formats::loom;
use job::GenParams;
use job::pipeline::OccPipeline;
use nets::OccModels;
use scene::Scene;
use words::hear::{CheckedReading, against};
use words::notation;
use words::reader::Mode;
use words::stage::Candidate;

/// Arguments.
#[derive(clap::Args)]
pub struct PromptArgs {
    /// Content of the new scene, or changes of the given one. {car|bus} and {2-5} are wildcards: the seed draws one.
    #[arg(required_unless_present = "schema", default_value = "")]
    text: String,
    /// Scene to edit; without one a new scene is made.
    #[arg(long, value_name = "S.loom")]
    base: Option<PathBuf>,
    /// Fixes every random draw.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom", required_unless_present_any = ["reading", "schema"])]
    output: Option<PathBuf>,
    /// Let the networks generate the occupancy: all of a new scene, and of an edited one what the edits touch.
    #[arg(long)]
    generate: bool,
    /// Print what the text asks for, as values and as a line of notation, and write nothing.
    #[arg(long)]
    reading: bool,
    /// Print the JSON Schema of readings, and read nothing.
    #[arg(long)]
    schema: bool,
    /// Placer of the objects.
    #[arg(long, value_enum, default_value_t)]
    placer: PlacementMethod,
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
    /// Language model that reads the text, instead of the readers of this program: an OpenAI-compatible server, http:// only.
    #[arg(long, value_name = "URL", requires = "model")]
    endpoint: Option<String>,
    /// Its model.
    #[arg(long, value_name = "NAME", requires = "endpoint")]
    model: Option<String>,
    /// How long to wait for it, s.
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    timeout_s: f64,
    #[command(flatten)]
    weights: Weights,
    #[command(flatten)]
    common: Common,
}

impl PromptArgs {
    pub(super) fn run(mut self) -> CommandResult {
        self.text = wildcards::drawn(&self.text, self.seed);
        if self.schema {
            println!("{:#}", endpoint::schema());
            return Ok(());
        }
        if self.weights.folder.is_some() && !self.generate && self.placer == PlacementMethod::Rules {
            let line = "--weights is of networks, but neither --generate nor --placer diffusion asks for one";
            return Err(anyhow!(line).into());
        }
        match self.base.clone() {
            Some(base) if self.keep.is_none() => self.edit(&base),
            _ => self.make(),
        }
    }

    /// The language model's reading of the text, if one is named, with the program's own reading beside it.
    fn by_endpoint(
        &self,
        heard: Option<&CheckedReading>,
        mode: Mode,
        scene: Option<&Scene>,
    ) -> anyhow::Result<Option<CheckedReading>> {
        let (Some(url), Some(model)) = (&self.endpoint, &self.model) else {
            return Ok(None);
        };
        let endpoint = Endpoint {
            url: url.clone(),
            model: model.clone(),
            timeout: std::time::Duration::try_from_secs_f64(self.timeout_s).context("--timeout-s")?,
        };
        let reading = endpoint::read(&endpoint, &self.text, mode, scene)?;
        Ok(Some(against(&self.text, reading, heard, mode)?))
    }

    /// The occupancy of a document's scene by the networks, and how it went.
    fn generated(&self, document: &mut Document, params: GenParams) -> anyhow::Result<serde_json::Value> {
        let mut pipeline = OccPipeline::new(OccModels::open(self.weights.folder.as_deref())?);
        let params = GenParams {
            seed: self.seed,
            ..params
        };
        let result = run_and_adopt(
            document,
            &mut pipeline,
            params,
            &ProgressLine::new(&self.common),
            None,
        )?;
        Ok(json!({ "network_calls": result.report.network_calls, "wall_s": result.report.wall_s }))
    }

    /// Prints a reading.
    fn print(&self, heard: &CheckedReading) -> CommandResult {
        let report = json!({
            "reading": heard.reading,
            "notation": notation::write(&heard.reading),
            "by": heard.by,
            "other": heard.other,
            "unsure": heard.unsure,
            "missing": heard.missing,
            "mended": heard.mended,
        });
        output::report(&self.common, &report, || {
            let mut lines = vec![notation::write(&heard.reading)];
            lines.push(serde_json::to_string_pretty(&heard.reading).unwrap_or_default());
            lines.extend(doubts(heard).into_iter().map(|d| format!("note: {d}")));
            lines.join("\n")
        });
        Ok(())
    }

    fn make(self) -> CommandResult {
        let own = text::read(&self.text);
        let heard = own.as_ref().ok().map(|p| &p.heard);
        let mut prompted = match self.by_endpoint(heard, Mode::Prompt, None)? {
            Some(heard) => Prompted::new(heard),
            None => own?,
        };
        if self.reading {
            return self.print(&prompted.heard);
        }
        let output = self.output.clone().context("-o is missing")?;
        let how = How {
            placer: self.placer,
            memory: self.memory && !self.no_memory,
            own_scenes: self.memory_scenes.clone(),
            weights: self.weights.folder.clone(),
            keep: self.kept()?,
            ..How::default()
        };
        how.check().context("--weights")?;
        let description = std::mem::take(&mut prompted.described.description);
        let mut made = text::make(&self.text, &description, self.seed, &how);
        made.scene.words = std::sync::Arc::new(vec![self.text.clone()]);
        made.scene.name = text::title(&self.text).into();
        let generated = if self.generate {
            let mut document = Document::new(made.scene);
            let report = self.generated(&mut document, GenParams::whole_scene())?;
            made.scene = Scene::clone(document.scene());
            Some(report)
        } else {
            None
        };
        let shortfalls = text::shortfalls(&made.laid);
        loom::save(&output, &made.scene)?;
        let remarks: Vec<String> = prompted
            .described
            .remarks
            .iter()
            .map(|r| r.1.to_string())
            .collect();
        let notes: Vec<String> = doubts(&prompted.heard).into_iter().chain(remarks).collect();
        let answer = prompted.answer();
        let frame = made.scene.frame();
        let report = json!({
            "text": self.text,
            "description": made.laid.description,
            "graph": made.laid.graphed.graph,
            "placer": self.placer,
            "memory": made.laid.remembered,
            "diffusion": made.laid.diffused,
            "reading": prompted.heard.reading,
            "notation": notation::write(&prompted.heard.reading),
            "read_by": prompted.heard.by,
            "answer": answer,
            "not_understood": prompted.heard.missing,
            "notes": notes.iter().chain(&made.laid.notes).collect::<Vec<_>>(),
            "shortfalls": shortfalls,
            "template": made.laid.road.template,
            "layout_s": made.laid.wall_s,
            "boxes": frame.boxes.len(),
            "occupied_voxels": frame.occupancy.count_set(),
            "classes": class_counts(&made.scene),
            "generated": generated,
            "seed": self.seed,
            "file": output,
        });
        output::report(&self.common, &report, || {
            let mut lines = vec![format!(
                "{}: {} boxes. {answer}",
                output.display(),
                frame.boxes.len()
            )];
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
            lines.extend(notes.iter().chain(&made.laid.notes).map(|n| format!("note: {n}")));
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

    fn edit(self, base: &Path) -> CommandResult {
        if self.text.trim().is_empty() {
            return Err(anyhow::anyhow!(
                "the prompt is empty: say what should change, such as \"remove the parked car\""
            )
            .into());
        }
        let scene = open::scene(base)?;
        let mut edited = text::read_edit(&self.text, &scene, self.seed)?;
        if let Some(heard) = self.by_endpoint(Some(&edited.heard), Mode::Edit, Some(&scene))? {
            edited = text::edited(heard, &scene, self.seed);
        }
        if self.reading {
            return self.print(&edited.heard);
        }
        let output = self.output.clone().context("-o is missing")?;
        let (edits, answer) = (edited.edits(), edited.answer_on(&scene));
        let mut document = document::opened(scene);
        if !edits.is_empty() {
            let words = self.text.clone();
            let all = [edits.as_slice(), &[Edit::KeepWords { words }]].concat();
            let all = with_scenery(document.scene(), all);
            document.apply_all("Edit by text", &all).context("edit by text")?;
        }
        let questions = &edited.outcome.questions;
        let asked: Vec<&str> = questions
            .iter()
            .map(|q| q.text.as_str())
            .chain(edited.things.questions.iter().map(|q| q.text.as_str()))
            .collect();
        // With an open question nothing is written: the answer may change the meaning of the rest.
        let write = asked.is_empty() && !edits.is_empty();
        let generated = match self.generate && write {
            true => Some(self.generated(&mut document, GenParams::default())?),
            false => None,
        };
        let scene = document.scene();
        let remarks: Vec<String> = edited.outcome.remarks.iter().map(|r| r.1.to_string()).collect();
        let notes = doubts(&edited.heard);
        let report = json!({
            "text": self.text,
            "edits": edits,
            "answer": answer,
            "questions": questions,
            "thing_questions": edited.things.questions,
            "reading": edited.heard.reading,
            "notation": notation::write(&edited.heard.reading),
            "read_by": edited.heard.by,
            "not_understood": edited.heard.missing,
            "notes": notes,
            "remarks": edited.outcome.remarks.iter().map(|r| &r.1).collect::<Vec<_>>(),
            "boxes": scene.frame().boxes.len(),
            "things": scene.background.len(),
            "prompt": *scene.prompt,
            "generated": generated,
            "seed": self.seed,
            "file": write.then_some(&output),
        });
        if write {
            document::save(&output, &document)?;
        }
        output::report(&self.common, &report, || {
            let mut lines = Vec::from_iter(Some(answer.clone()).filter(|a| !a.is_empty()));
            for q in questions {
                lines.push(q.text.clone());
                let one = |c: &Candidate| format!("  #{} {}: {}", c.id.0, c.class.replace('_', " "), c.place);
                lines.extend(q.candidates.iter().map(one));
            }
            for q in &edited.things.questions {
                lines.push(q.text.clone());
                lines.extend(
                    q.candidates
                        .iter()
                        .map(|c| format!("  {}: {}", c.answer(), c.place)),
                );
            }
            lines.extend(notes.iter().map(|n| format!("note: {n}")));
            lines.join("\n")
        });
        if !asked.is_empty() {
            return Err(Stop::Short(format!(
                "{} Name one, such as \"{}\"",
                asked.join(" "),
                first_answer(&edited)
            )));
        }
        if edits.is_empty() {
            let why = (remarks.first().cloned())
                .or(edited.things.cannot.first().cloned())
                .unwrap_or_else(|| "nothing in the text changes the scene".into());
            return Err(Stop::Short(format!("nothing was changed: {why}")));
        }
        Ok(())
    }
}

fn first_answer(edited: &text::Edited) -> String {
    let thing = || {
        let q = edited.things.questions.first()?;
        q.candidates.first().map(|c| c.answer())
    };
    let boxes = edited
        .outcome
        .questions
        .first()
        .and_then(|q| q.candidates.first());
    boxes
        .map(|c| format!("#{}", c.id.0))
        .or_else(thing)
        .unwrap_or_else(|| "#1".into())
}
