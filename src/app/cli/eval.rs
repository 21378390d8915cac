//! `sceneloom eval`: quality on held-out worlds, with 95 % intervals over scenes. The networks' own
//! output is judged: drafts are not put in for boxes that they left out.

use std::path::PathBuf;

use anyhow::Context;
use serde_json::{Value, json};

use crate::progress::ProgressLine;
use crate::{CommandResult, Common, Gen, Stop, Weights, output};
use job::GenParams;
use judge::markdown::{MeasuredSuite, markdown, measure_all};
use judge::options::Options;
use judge::options::Who;
use judge::origin::Origin;
use judge::suite::Suite;
use judge::table::{SUITES, named};

/// Name that stands for every suite.
const ALL: &str = "all";

/// Names of the suites, and of all of them.
fn suites() -> clap::builder::PossibleValuesParser {
    SUITES.iter().map(|s| s.name).chain([ALL]).into()
}

/// Arguments.
#[derive(clap::Args)]
pub struct Eval {
    /// Suite that is measured; `all`: every suite, one after another.
    #[arg(value_parser = suites())]
    suite: String,
    /// Number of held-out worlds, or of frames of --data [default: 24, quick: a few].
    #[arg(long, value_name = "N")]
    frames: Option<usize>,
    /// Folder of Occ3D frames (`labels.npz`, at any depth) to judge the VAE or edits by instead; of `map` a project file of a map.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Vehicles of a scene that are removed, moved and changed, one by one, at most (editing) [default: 6, quick: 1].
    #[arg(long, value_name = "N")]
    vehicles: Option<usize>,
    /// Worlds whose objects say how many voxels a class has, at least (editing) [default: 40, quick: 2].
    #[arg(long, value_name = "N")]
    band_worlds: Option<usize>,
    /// Presets of the quality slider to judge, comma-separated; all but the reference if none is named (editing).
    #[arg(long, value_name = "PRESETS", value_delimiter = ',')]
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
    /// At most so many of the sentences, spread evenly (layout) [default: all, quick: 240].
    #[arg(long, value_name = "N")]
    sentences: Option<usize>,
    /// Reader of the sentences (layout).
    #[arg(long, value_enum, default_value_t)]
    reader: Who,
    /// Prompts on which the placers are compared, with and without memory (layout); 0 leaves that out [default: 60, quick: 2].
    #[arg(long, value_name = "N")]
    placer_prompts: Option<usize>,
    /// Only the table of worlds, generated scenes and drafts: no ablations of layout and boxes, no inpainted squares (generation).
    #[arg(long)]
    rows_only: bool,
    /// Fail (exit 1) if a bar of the suite is missed.
    #[arg(long)]
    bar: bool,
    /// Small numbers: all suites together in a few minutes on two cores. Options beside it go first.
    #[arg(long)]
    quick: bool,
    /// Print the figures as Markdown, with commit, date and machine.
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    #[command(flatten)]
    generation: Gen,
    #[command(flatten)]
    weights: Weights,
    #[command(flatten)]
    common: Common,
}

impl Eval {
    /// The options of a suite: the usual ones, or the quick ones, with the command line's on top.
    fn options(&self, suite: &Suite, params: [GenParams; 2]) -> Options {
        let mut options = Options::default();
        if self.quick {
            (suite.quick)(&mut options);
        }
        let presets = std::mem::take(&mut options.presets);
        let [scene_params, edit_params] = params;
        Options {
            frames: self.frames.unwrap_or(options.frames),
            data: self
                .data
                .clone()
                .filter(|_| suite.takes_data || self.suite != ALL),
            vehicles: self.vehicles.unwrap_or(options.vehicles),
            presets: if self.presets.is_empty() {
                presets
            } else {
                self.presets.clone()
            },
            band_worlds: self.band_worlds.unwrap_or(options.band_worlds),
            random_edits: self.random_edits,
            scheme_frames: self.scheme_frames,
            reference_frames: self.reference_frames,
            prompts: self.prompts.clone(),
            sentences: self.sentences.or(options.sentences),
            reader: self.reader,
            placer_prompts: self.placer_prompts.unwrap_or(options.placer_prompts),
            rows_only: self.rows_only || options.rows_only,
            scene_params,
            edit_params,
            weights: self.weights.folder.clone(),
        }
    }

    pub(super) fn run(self) -> CommandResult {
        if self.generation.fine_steps.is_some() {
            self.generation.models(&self.weights)?;
        }
        let params = [
            self.generation.params(GenParams::whole_scene())?,
            self.generation.params(GenParams::default())?,
        ];
        let of = |suite: &Suite| self.options(suite, params.clone());
        let progress = ProgressLine::new(&self.common);
        if self.suite == ALL || self.markdown {
            let chosen = SUITES
                .iter()
                .filter(|s| [s.name, ALL].contains(&self.suite.as_str()));
            let tables = measure_all(chosen, &of, &progress);
            progress.done();
            return self.tell(&tables);
        }
        let suite = named(&self.suite).context("no such suite")?;
        let report = suite.measure(&of(suite), &progress)?;
        progress.done();
        output::report(&self.common, &report.json, || suite.text(&report.json));
        self.against_bars(report.missed())
    }

    /// Prints the tables of all suites. Errors if one could not be measured.
    fn tell(&self, tables: &[MeasuredSuite]) -> CommandResult {
        let called: Vec<String> = std::env::args().skip(1).collect();
        let origin = Origin::now(format!("sceneloom {}", called.join(" ")));
        let suites: serde_json::Map<String, Value> =
            tables.iter().map(|t| (t.name.to_owned(), t.json())).collect();
        let report = json!({ "origin": origin, "quick": self.quick, "suites": suites });
        output::report(&self.common, &report, || {
            markdown(&origin, tables).trim_end().to_owned()
        });
        let mut missed = Vec::new();
        for table in tables {
            match &table.found {
                Ok((report, _)) => missed.extend(report.missed()),
                Err(error) => return Err(anyhow::anyhow!("eval {}: {error}", table.name).into()),
            }
        }
        self.against_bars(missed)
    }

    fn against_bars(&self, missed: Vec<String>) -> CommandResult {
        if self.bar && !missed.is_empty() {
            return Err(Stop::Short(missed.join("; ")));
        }
        Ok(())
    }
}
