//! `eval layout`: prompts and text edits of `tests/words`, each placed and judged on the map.

mod check;
mod placers;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::options::Who;
use crate::suite::{Bar, Options, SuiteFigures, with_interval};
use authoring::prompting::{How, Laid, lay_out};
use authoring::text;
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use check::Judge;
use editor::Document;
use formats::input;
use numeric::quantile::median;
use place::description::Description;
use scene::{Frame, Scene, SceneBox, SensorRig};
use words::account::missing;
use words::carry_out::carry_out;
use words::describe::describe;
use words::grammar;
use words::hear::hear;
use words::notation;
use words::reader::{LearnedReader, Mode};
use words::reading::Reading;
use words::remark::Remark;
use words::stage::OpenScene;
use words::tokens::tokens;

/// Folder of the judged sets in the source tree.
const SETS: &str = "tests/words/dev";

/// Files with their contents: `path` itself, or all `.jsonl` of a folder, in the order of their names.
fn sets(path: &Path) -> anyhow::Result<Vec<(String, String)>> {
    let mut files = vec![path.to_owned()];
    if path.is_dir() {
        let entries = std::fs::read_dir(path).with_context(|| format!("read {}", path.display()))?;
        let all: Result<Vec<_>, _> = entries.map(|e| e.map(|e| e.path())).collect();
        files = all.with_context(|| format!("read {}", path.display()))?;
        files.retain(|f| f.extension().is_some_and(|e| e == "jsonl"));
        files.sort();
        anyhow::ensure!(!files.is_empty(), "{}: no .jsonl files in it", path.display());
    }
    let read = |file: PathBuf| {
        let text = input::read_text(&file, input::LARGEST_TEXT);
        let text = text.context("sentences (--prompts names others)")?;
        Ok((file.display().to_string(), text))
    };
    files.into_iter().map(read).collect()
}

fn cases_of(name: &str, text: &str) -> anyhow::Result<Vec<Case>> {
    text.lines()
        .filter(|l| !l.trim().is_empty())
        .enumerate()
        .map(|(i, l)| {
            let case: Case = serde_json::from_str(l).with_context(|| format!("{name}, line {}", i + 1))?;
            Ok(Case {
                line: i as u64,
                ..case
            })
        })
        .collect()
}

/// One line of a file of sentences.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Case {
    pub text: String,
    /// A prompt that makes the scene to edit; `None` if `text` itself makes a scene.
    #[serde(default)]
    pub base: Option<String>,
    /// Number of boxes by class (or `vehicle`), exact or as least and most.
    #[serde(default)]
    counts: BTreeMap<String, ExpectedCount>,
    #[serde(default)]
    relations: Vec<Relation>,
    #[serde(default)]
    time: Option<String>,
    #[serde(default)]
    weather: Option<String>,
    #[serde(default)]
    road: Option<String>,
    /// Number of candidates that the edit must ask about.
    #[serde(default)]
    asks: Option<usize>,
    /// Reading of the text, in notation.
    #[serde(default)]
    reading: Option<String>,
    /// Line in its file, from 0: seeds depend on it.
    #[serde(skip)]
    pub line: u64,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum ExpectedCount {
    Exactly(usize),
    Between([usize; 2]),
}

/// `[a, relation, b]`, with the number of `a`, the distance and a second target beside `b`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Relation {
    a: String,
    rel: String,
    b: String,
    #[serde(default)]
    c: Option<String>,
    #[serde(default)]
    n: Option<usize>,
    #[serde(default)]
    m: Option<f64>,
}

/// Shares of one group of cases.
#[derive(Default)]
pub(super) struct CaseTally {
    cases: usize,
    counts: Vec<f64>,
    relations: Vec<f64>,
    style: Vec<f64>,
    asks: Vec<f64>,
    overlaps: (usize, usize),
    drivable: (usize, usize),
    headings: (usize, usize),
    wall_s: Vec<f64>,
    slowest: Vec<(f64, String)>,
    failed: Vec<Value>,
    /// Right cases with a needless remark, and the remarks of the first of them.
    spoke: usize,
    needless: Vec<Value>,
    /// Failed cases without any remark: no note, no question, no word named as not understood.
    silent: usize,
    /// Failed edits of a scene whose own prompt was read with doubts.
    doubtful_base: usize,
}

/// Remarks of the program on a case.
#[derive(Default)]
pub(super) struct CaseRemarks {
    /// True if there was any remark.
    pub spoke: bool,
    /// Details for the report of a failed case.
    pub details: Value,
    /// True if the edited scene comes from a prompt that was read with doubts.
    pub doubtful_base: bool,
}

/// Number of right cases with a remark that the report names.
const NEEDLESS: usize = 400;
/// Number of the slowest cases that the report names.
const SLOWEST: usize = 8;

/// Share and the half width of its 95 % interval (Wilson), as text for the report.
fn share(good: usize, n: usize) -> Value {
    if n == 0 {
        return Value::Null;
    }
    let (n_f, p, z) = (n as f64, good as f64 / n as f64, 1.96f64);
    let middle = (p + z * z / (2.0 * n_f)) / (1.0 + z * z / n_f);
    let half = z / (1.0 + z * z / n_f) * (p * (1.0 - p) / n_f + z * z / (4.0 * n_f * n_f)).sqrt();
    let round = |v: f64| (v * 1e4).round() / 1e4;
    json!({ "share": round(p), "low": round(middle - half), "high": round((middle + half).min(1.0)), "n": n })
}

fn ratio(pair: (usize, usize)) -> f64 {
    if pair.1 == 0 {
        1.0
    } else {
        pair.0 as f64 / pair.1 as f64
    }
}

fn mean(values: &[f64]) -> f64 {
    if values.is_empty() {
        1.0
    } else {
        values.iter().sum::<f64>() / values.len() as f64
    }
}

/// The scene that the program makes of a prompt.
pub(super) fn place(prompt: &str, seed: u64, how: &How) -> (Scene, Laid) {
    let started = Instant::now();
    let reading = hear(prompt, Mode::Prompt).map(|h| h.reading).unwrap_or_default();
    place_description(prompt, &describe(&reading).description, started, seed, how)
}

fn place_description(
    prompt: &str,
    description: &Description,
    started: Instant,
    seed: u64,
    how: &How,
) -> (Scene, Laid) {
    let mut laid = lay_out(prompt, description, seed, how);
    laid.wall_s = started.elapsed().as_secs_f64();
    let boxes = laid.placement.boxes.iter().map(|b| (b.id, *b)).collect();
    let frame = Frame::new(laid.road.layout.clone(), boxes, scene::VoxelGrid::new());
    let mut scene = Scene::single(
        laid.road.template,
        frame,
        std::sync::Arc::new(SensorRig::default()),
        seed,
    );
    scene.prompt = laid.description.style().into();
    scene.conditions = laid.description.conditions(scene.seed);
    (scene, laid)
}

/// The edits without those over time: the cases are about one moment.
fn at_the_start(edits: &[scene::Edit]) -> Vec<scene::Edit> {
    let of_time =
        |edit: &&scene::Edit| !matches!(edit, scene::Edit::LetMove { .. } | scene::Edit::SetLength { .. });
    edits.iter().filter(of_time).cloned().collect()
}

/// Each box in a few words: class, centre (m), heading (deg), speed (m/s).
fn in_short(scene: &Scene) -> Vec<String> {
    let boxes = scene.frame().boxes.values();
    boxes
        .map(|b| {
            let (p, yaw) = (b.center_m, b.yaw_rad.to_degrees());
            let speed = b.velocity_mps.length();
            format!("{} {:.1} {:.1} {yaw:.0} {speed:.0}", b.class.label(), p.x, p.y)
        })
        .collect()
}

impl CaseTally {
    /// Judges the scene of a case; `wrong` holds faults that are known already. `told` is called for a failed case
    /// only.
    pub(super) fn add(
        &mut self,
        case: &Case,
        scene: &Scene,
        wall_s: f64,
        mut wrong: Vec<String>,
        told: impl FnOnce() -> CaseRemarks,
    ) {
        self.cases += 1;
        self.wall_s.push(wall_s);
        self.slowest.push((wall_s, case.text.clone()));
        self.slowest.sort_by(|a, b| b.0.total_cmp(&a.0));
        self.slowest.truncate(SLOWEST);
        let frame = scene.frame();
        let boxes: Vec<SceneBox> = frame.boxes.values().copied().collect();
        let judge = Judge {
            layout: &frame.layout,
            boxes: &boxes,
        };
        for (class, number) in &case.counts {
            let found = judge.count(class);
            let (low, high) = match number {
                ExpectedCount::Exactly(n) => (*n, *n),
                ExpectedCount::Between([a, b]) => (*a, *b),
            };
            let good = (low..=high).contains(&found);
            self.counts.push(f64::from(u8::from(good)));
            if !good {
                wrong.push(format!("{class}: {found}, expected {low} to {high}"));
            }
        }
        for r in &case.relations {
            let good = judge.holds(&r.a, &r.rel, &r.b, r.c.as_deref(), r.n, r.m);
            self.relations.push(f64::from(u8::from(good)));
            if !good {
                wrong.push(format!("{} {} {}", r.a, r.rel, r.b));
            }
        }
        let style = &*scene.prompt;
        let said = |what: &Option<String>| what.as_ref().map(|w| style.split(", ").any(|s| s == w));
        let road = case.road.as_ref().map(|r| scene.name.as_ref() == r);
        for (good, what) in [
            (said(&case.time), &case.time),
            (said(&case.weather), &case.weather),
            (road, &case.road),
        ] {
            let Some(good) = good else {
                continue;
            };
            self.style.push(f64::from(u8::from(good)));
            if !good {
                wrong.push(format!("{what:?} expected, {style:?} {:?} found", scene.name));
            }
        }
        let sum = |a: (usize, usize), b: (usize, usize)| (a.0 + b.0, a.1 + b.1);
        self.overlaps = sum(self.overlaps, judge.overlaps());
        self.drivable = sum(self.drivable, judge.on_drivable());
        self.headings = sum(self.headings, judge.headings());
        let told = told();
        if told.spoke && wrong.is_empty() {
            self.spoke += 1;
            if self.needless.len() < NEEDLESS {
                self.needless
                    .push(json!({ "text": case.text, "told": told.details }));
            }
        }
        if !wrong.is_empty() {
            let after = in_short(scene);
            self.silent += usize::from(!told.spoke);
            self.doubtful_base += usize::from(told.doubtful_base);
            self.failed.push(json!({
                "text": case.text, "wrong": wrong, "after": after, "silent": !told.spoke, "told": told.details,
            }));
        }
    }

    pub(super) fn report(&self) -> Value {
        json!({
            "cases": self.cases,
            "wholly_right": share(self.cases - self.failed.len(), self.cases),
            "silently_wrong": share(self.silent, self.cases),
            "failed_on_a_doubtful_base": share(self.doubtful_base, self.failed.len()),
            "right_with_a_remark": share(self.spoke, self.cases),
            "counts_exact": with_interval(&self.counts),
            "relations_satisfied": with_interval(&self.relations),
            "style_and_road": with_interval(&self.style),
            "asked_back": with_interval(&self.asks),
            "overlapping_pairs": share(self.overlaps.0, self.overlaps.1),
            "vehicles_on_drivable": share(self.drivable.0, self.drivable.1),
            "moving_headings_within_15_deg": share(self.headings.0, self.headings.1),
            "wall_s_median": median(&self.wall_s),
            "wall_s_max": self.wall_s.iter().copied().fold(0.0, f64::max),
            "slowest": self.slowest.iter().map(|(wall_s, text)| json!({ "wall_s": wall_s, "text": text })).collect::<Vec<_>>(),
            "failed": self.failed,
            "needless": self.needless,
        })
    }
}

/// A reading, and whether there is a remark on how it was read.
struct Read {
    reading: Reading,
    doubts: Value,
    spoke: bool,
    wall_s: f64,
}

impl Who {
    /// The reading of a case.
    fn reading(self, case: &Case) -> anyhow::Result<Read> {
        let mode = if case.base.is_some() {
            Mode::Edit
        } else {
            Mode::Prompt
        };
        let plainly = |reading| Read {
            reading,
            doubts: Value::Null,
            spoke: false,
            wall_s: 0.0,
        };
        let started = Instant::now();
        let mut read = match self {
            Self::Given => {
                let line = case.reading.as_ref();
                let line = line.with_context(|| format!("no reading stands beside {:?}", case.text))?;
                let reading = notation::parse(line).with_context(|| format!("{:?}", case.text))?;
                // (words of a right reading that are named as not understood count as needless remarks)
                let reader = LearnedReader::bundled()?;
                let tokens = tokens(&case.text, Some(reader.speller()));
                let missing = missing(&case.text, &tokens, &reading, reader.speller());
                Read {
                    spoke: !missing.is_empty(),
                    doubts: json!(missing),
                    ..plainly(reading)
                }
            }
            Self::Learned => plainly(LearnedReader::bundled()?.read(&case.text, mode).reading),
            Self::Grammar => {
                let tokens = tokens(&case.text, Some(LearnedReader::bundled()?.speller()));
                let plain = grammar::read(&tokens, mode);
                let whole = plain.is_whole();
                Read {
                    reading: if whole { plain.reading } else { Reading::default() },
                    doubts: json!(plain.left_over),
                    spoke: !whole,
                    wall_s: 0.0,
                }
            }
            Self::Both => {
                let heard = hear(&case.text, mode)?;
                Read {
                    spoke: !heard.is_plain(),
                    doubts: json!({ "by": heard.by, "other": heard.other.as_ref().map(notation::write), "unsure": heard.unsure, "missing": heard.missing }),
                    reading: heard.reading,
                    wall_s: 0.0,
                }
            }
        };
        read.wall_s = started.elapsed().as_secs_f64();
        Ok(read)
    }
}

/// Makes and judges a prompt.
fn made(tally: &mut CaseTally, case: &Case, read: &Read, seed: u64, how: &How) {
    let started = Instant::now();
    let (reading, doubts) = (&read.reading, &read.doubts);
    let described = describe(reading);
    let remarks = &described.remarks;
    let (scene, laid) = place_description(&case.text, &described.description, started, seed, how);
    let short = text::shortfalls(&laid);
    let told = || CaseRemarks {
        spoke: read.spoke || !(remarks.is_empty() && short.is_empty()),
        details: json!({ "reading": notation::write(reading), "doubts": doubts, "remarks": remarks, "shortfalls": short }),
        doubtful_base: false,
    };
    tally.add(case, &scene, read.wall_s + laid.wall_s, Vec::new(), told);
}

/// Carries out and judges an edit.
fn changed(
    tally: &mut CaseTally,
    case: &Case,
    base: &str,
    read: &Read,
    seed: u64,
    how: &How,
) -> anyhow::Result<()> {
    let (reading, doubts) = (&read.reading, &read.doubts);
    let (scene, _) = place(base, seed, how);
    let started = Instant::now();
    let frame = scene.frame();
    let open = OpenScene {
        boxes: &frame.boxes,
        layout: &frame.layout,
        prompt: &scene.prompt,
        conditions: scene.conditions,
        clip: None,
        ego_moves: false,
        length_s: 0.0,
    };
    let outcome = carry_out(reading, &open, seed);
    let wall_s = read.wall_s + started.elapsed().as_secs_f64();
    let asked = outcome.questions.first().map(|q| q.candidates.len());
    let mut wrong = Vec::new();
    if case.asks.is_some() || asked.is_some() {
        let good = asked == case.asks;
        tally.asks.push(f64::from(u8::from(good)));
        if !good {
            wrong.push(format!("asked {asked:?}, expected {:?}", case.asks));
        }
    }
    let before = in_short(&scene);
    let mut document = Document::new(scene);
    document
        .apply_all("Edit by text", &at_the_start(&outcome.edits))
        .with_context(|| format!("{:?}", case.text))?;
    let told = || CaseRemarks {
        // (which candidate was taken, or that the scene is so already, is no doubt)
        spoke: read.spoke
            || !outcome.questions.is_empty()
            || outcome
                .remarks
                .iter()
                .any(|r| !matches!(r.1, Remark::Chosen { .. } | Remark::Already)),
        details: json!({ "before": before, "reading": notation::write(reading), "doubts": doubts, "remarks": outcome.remarks, "questions": outcome.questions }),
        doubtful_base: !hear(base, Mode::Prompt).is_ok_and(|h| h.is_plain()),
    };
    tally.add(case, document.scene(), wall_s, wrong, told);
    Ok(())
}

impl Options {
    /// Judges prompts and text edits by [`Judge`].
    pub(crate) fn layout(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures> {
        let mut cases: Vec<Case> = Vec::new();
        for (name, text) in sets(self.prompts.as_deref().unwrap_or(Path::new(SETS)))? {
            cases.extend(cases_of(&name, &text)?);
        }
        if let Some(most) = self.sentences.filter(|n| *n < cases.len()) {
            let all = std::mem::take(&mut cases);
            let of = all.len();
            let kept = |i: usize| (i + 1) * most / of > i * most / of;
            cases.extend(
                all.into_iter()
                    .enumerate()
                    .filter_map(|(i, case)| kept(i).then_some(case)),
            );
        }
        let how = How::default();
        let (mut prompts, mut edits) = (CaseTally::default(), CaseTally::default());
        for (i, case) in cases.iter().enumerate() {
            progress.at("layout", i, cases.len());
            let seed = TEST_SEED + case.line;
            let reading = self.reader.reading(case)?;
            match &case.base {
                None => made(&mut prompts, case, &reading, seed, &how),
                Some(base) => changed(&mut edits, case, base, &reading, seed, &how)?,
            }
        }
        let both = |f: fn(&CaseTally) -> f64| f(&prompts).min(f(&edits));
        let bars: Vec<Bar> = vec![
            ("counts_exact", both(|t| mean(&t.counts)), 0.96),
            ("relations_satisfied", both(|t| mean(&t.relations)), 0.88),
            (
                "pairs_apart",
                both(|t| 1.0 - if t.overlaps.1 == 0 { 0.0 } else { ratio(t.overlaps) }),
                0.995,
            ),
            ("vehicles_on_drivable", both(|t| ratio(t.drivable)), 0.99),
            ("moving_headings", both(|t| ratio(t.headings)), 0.95),
        ];
        let placers = self.placers(&cases, progress);
        let report = json!({ "prompts": cases.len(), "made": prompts.report(), "edited": edits.report(), "placers": placers });
        Ok((report, bars))
    }
}
