//! `sceneloom trade`: what each knob costs and what it buys, measured on this machine.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::generate::{full_params, models};
use super::progress::Progress;
use super::{Common, Outcome as Ended, Stop as Ending, output};
use crate::app::open;
use crate::app::trade::cases::{self, Case};
use crate::app::trade::edits::{Bench, Outcome, reference_params};
use crate::app::trade::load::{Load, machine};
use crate::app::trade::plot::{self, Mark};
use crate::app::trade::sensors::{self, Measured};
use crate::app::trade::settings::{self, Setting};
use crate::generation::job::{GenParams, JobCtx};
use crate::generation::metrics::stats::{median, quantile};
use crate::generation::model::OccModels;
use crate::generation::trade::{
    Cost, Placed, SizedTime, Stop, StopKnobs, Stops, bootstrap_median, front, hypervolume, knee,
};

/// Arguments.
#[derive(clap::Args)]
pub struct Trade {
    /// Scene whose edits are measured; without one, held-out worlds.
    scene: Option<PathBuf>,
    /// How thorough: `quick` (minutes; reference of 200 steps) or `full` (hours; 1000 steps).
    #[arg(long, default_value = "quick", value_parser = ["quick", "full"])]
    suite: String,
    /// What is measured, comma-separated: edit, scene, lidar, splat, vae.
    #[arg(long, value_delimiter = ',', default_value = "edit,scene,lidar,splat,vae")]
    parts: Vec<String>,
    /// Number of held-out worlds [default: 3, full: 20].
    #[arg(long, value_name = "N")]
    frames: Option<usize>,
    /// Timed runs of each setting on each case, per process [default: 3, full: 10].
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// Processes that measure one after another [default: 1, full: 3].
    #[arg(long, value_name = "N")]
    processes: Option<usize>,
    /// Steps of the reference [default: 200, full: 1000].
    #[arg(long, value_name = "N")]
    reference_steps: Option<u32>,
    /// Random settings across all knobs, beside each knob by itself.
    #[arg(long, value_name = "N", default_value_t = 8)]
    draws: usize,
    /// Only these settings, separated by semicolons, as the report names them: `4 steps;10 steps, int8`.
    #[arg(long, value_name = "NAMES", value_delimiter = ';')]
    only: Vec<String>,
    /// Folder that keeps the references between runs.
    #[arg(long, value_name = "DIR")]
    keep_references: Option<PathBuf>,
    /// Fixes draws and turns.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Refuse (exit 1) if the machine is busy: more than 0.5 running processes per core.
    #[arg(long)]
    refuse_if_busy: bool,
    /// Report to write.
    #[arg(short, long, value_name = "T.json")]
    output: PathBuf,
    /// Picture of time against error.
    #[arg(long, value_name = "F.png")]
    plot: Option<PathBuf>,
    /// Write the stops of the quality slider that this run found.
    #[arg(long, value_name = "STOPS.json")]
    stops: Option<PathBuf>,
    /// Of a process of a larger run: write raw outcomes.
    #[arg(long, hide = true)]
    raw: bool,
    /// Which process of a larger run this is: its turns are its own.
    #[arg(long, hide = true, default_value_t = 0)]
    process: u64,
    #[command(flatten)]
    common: Common,
}

/// Outcomes of every setting on every case, as one process found them.
#[derive(Default, Serialize, Deserialize)]
struct Raw {
    /// By part: names of cases and, for each, outcomes in the order of the settings.
    parts: BTreeMap<String, Vec<(String, Vec<Outcome>)>>,
}

/// What the report says of a setting.
struct Row {
    setting: Setting,
    outcomes: Vec<Outcome>,
}

impl Row {
    fn all(&self, of: impl Fn(&Outcome) -> f64) -> Vec<f64> {
        self.outcomes.iter().map(of).collect()
    }

    fn placed(&self) -> Placed {
        Placed {
            wall_s: bootstrap_median(&self.all(|o| median(&o.wall_s)), 1),
            error: bootstrap_median(&self.all(|o| o.error), 2),
        }
    }

    fn cost(&self) -> Option<Cost> {
        let times = self.outcomes.iter().map(|o| SizedTime {
            tokens: o.tokens as f64,
            wall_s: median(&o.wall_s),
        });
        Cost::fit(&times.collect::<Vec<_>>())
    }

    fn json(&self, part: &str, on_front: bool) -> Value {
        let placed = self.placed();
        let every: Vec<f64> = self.outcomes.iter().flat_map(|o| o.wall_s.clone()).collect();
        let mean = |of: &dyn Fn(&Outcome) -> f64| {
            let values = self.all(of);
            values.iter().sum::<f64>() / values.len().max(1) as f64
        };
        let mut stages: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for (name, s) in self.outcomes.iter().flat_map(|o| &o.stages_s) {
            stages.entry(name).or_default().push(*s);
        }
        let stages: BTreeMap<_, _> = stages.into_iter().map(|(k, v)| (k, median(&v))).collect();
        let mut notes: Vec<&str> = self
            .outcomes
            .iter()
            .flat_map(|o| &o.notes)
            .map(String::as_str)
            .collect();
        notes.sort_unstable();
        notes.dedup();
        json!({
            "part": part,
            "name": self.setting.name,
            "knobs": self.setting.params,
            "other_target": self.setting.other_target,
            "on_front": on_front,
            "wall_s": placed.wall_s,
            "wall_s_p95": quantile(&every, 0.95),
            "wall_s_least": every.iter().copied().fold(f64::INFINITY, f64::min),
            "runs": every.len(),
            "invert_s": median(&self.all(|o| o.invert_s)),
            "stages_s": stages,
            "cost": self.cost(),
            "network_calls": mean(&|o| o.network_calls as f64),
            "tokens": mean(&|o| o.tokens as f64),
            "error": placed.error,
            "error_of_occupied": bootstrap_median(&self.all(|o| o.error_of_occupied), 3),
            "miou": bootstrap_median(&self.all(|o| o.miou), 4),
            "latent_error": bootstrap_median(&self.all(|o| o.latent_error), 5),
            "seam_change_share": mean(&|o| o.seam),
            "untouched_voxels_changed": self.outcomes.iter().map(|o| o.untouched_voxels_changed).sum::<usize>(),
            "failed": self.outcomes.iter().filter(|o| o.error.is_infinite()).count(),
            "peak_rss_mb": self.outcomes.iter().filter_map(|o| o.peak_rss_mb).fold(0.0, f64::max),
            "notes": notes,
        })
    }
}

impl Trade {
    fn full(&self) -> bool {
        self.suite == "full"
    }

    fn frames(&self) -> usize {
        self.frames.unwrap_or(if self.full() { 20 } else { 3 })
    }

    fn repeats(&self) -> usize {
        self.repeats.unwrap_or(if self.full() { 10 } else { 3 })
    }

    fn reference_steps(&self) -> u32 {
        self.reference_steps
            .unwrap_or(if self.full() { 1000 } else { 200 })
    }

    fn settings(&self, part: &str, models: &OccModels) -> (GenParams, Vec<Setting>) {
        let (base, mut settings) = if part == "edit" {
            let base = GenParams::default();
            let distilled = models.distilled.is_some();
            (base, settings::of_edits(base, distilled, self.draws, self.seed))
        } else {
            let base = full_params();
            (base, settings::of_scenes(base))
        };
        settings.retain(|s| self.only.is_empty() || self.only.contains(&s.name));
        (base, settings)
    }

    fn cases(&self, part: &str) -> anyhow::Result<Vec<Case>> {
        let whole = |scene: crate::scene::Scene, name: String| {
            let scene = Arc::new(scene);
            vec![Case {
                name,
                before: scene.clone(),
                after: scene,
            }]
        };
        let of = |scene: crate::scene::Scene, name: String, seed: u64| match part {
            "edit" => cases::of_scene(&scene, &name, seed),
            _ => whole(scene, name),
        };
        if let Some(path) = &self.scene {
            let found = of(open::scene(path)?, path.display().to_string(), self.seed);
            if found.is_empty() {
                bail!("{}: nothing to edit: no car and no road", path.display());
            }
            return Ok(found);
        }
        let worlds = 0..self.frames() as u64;
        Ok(worlds
            .flat_map(|i| of(cases::held_out(i), format!("world {i}"), i))
            .collect())
    }

    /// Measures in this process.
    fn measure(&self, models: &Arc<OccModels>, progress: &Progress) -> anyhow::Result<Raw> {
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
            let (base, settings) = self.settings(part, models);
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

    fn has(&self, part: &str) -> bool {
        self.parts.iter().any(|p| p == part)
    }

    /// Measures in processes of their own, one after another, and puts their times together. Errors must not differ.
    fn measure_in_processes(&self, processes: usize, progress: &Progress) -> anyhow::Result<Raw> {
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
            let text = std::fs::read_to_string(&file).with_context(|| format!("read {}", file.display()))?;
            let raw: Raw = serde_json::from_str(&text).with_context(|| file.display().to_string())?;
            match &mut all {
                None => all = Some(raw),
                Some(all) => add_times(all, raw)?,
            }
        }
        all.context("no process")
    }

    pub(super) fn run(self) -> Ended {
        if let Some(unknown) = self.parts.iter().find(|p| !PARTS.contains(&p.as_str())) {
            return Err(anyhow::anyhow!("--parts {unknown}: expected {}", PARTS.join(", ")).into());
        }
        if !(2..=100_000).contains(&self.reference_steps()) || self.reference_steps() > 1000 {
            return Err(
                anyhow::anyhow!("--reference-steps {}: expected 2 to 1000", self.reference_steps()).into(),
            );
        }
        for (name, number) in [("--frames", self.frames()), ("--repeats", self.repeats())] {
            if !(1..=1000).contains(&number) {
                return Err(anyhow::anyhow!("{name} {number}: expected 1 to 1000").into());
            }
        }
        let load = Load::now();
        if load.is_busy() && !self.raw {
            let line = format!(
                "the machine is busy ({}): times will be too long",
                load.describe()
            );
            if self.refuse_if_busy {
                return Err(Ending::Short(line));
            }
            eprintln!("warning: {line}");
        }
        let models = models(self.common.weights.as_deref())?;
        let progress = Progress::new(&self.common);
        let processes = self.processes.unwrap_or(if self.full() { 3 } else { 1 });
        let raw = if processes > 1 && !self.raw {
            self.measure_in_processes(processes, &progress)?
        } else {
            self.measure(&models, &progress)?
        };
        if self.raw {
            output::write_file(&self.output, &serde_json::to_vec(&raw).context("write outcomes")?)?;
            return Ok(());
        }
        let mut points = Vec::new();
        let mut marks: Vec<Mark> = Vec::new();
        let mut stops = None;
        let mut figures = json!({});
        for (part, cases) in &raw.parts {
            let (base, settings) = self.settings(part, &models);
            let rows: Vec<Row> = settings
                .into_iter()
                .enumerate()
                .map(|(i, setting)| Row {
                    setting,
                    outcomes: cases.iter().filter_map(|(_, o)| o.get(i)).cloned().collect(),
                })
                .collect();
            let same_target: Vec<&Row> = rows.iter().filter(|r| !r.setting.other_target).collect();
            let placed: Vec<Placed> = same_target.iter().map(|r| r.placed()).collect();
            let mut on_front = front(&placed).into_iter();
            for row in &rows {
                let on_front = !row.setting.other_target && on_front.next().unwrap_or(false);
                points.push(row.json(part, on_front));
                if part == "edit" && !row.setting.other_target {
                    let p = row.placed();
                    marks.push(Mark {
                        name: row.setting.name.clone(),
                        wall_s: [p.wall_s.median, p.wall_s.low, p.wall_s.high],
                        error: [p.error.median, p.error.low, p.error.high],
                        on_front,
                        stop: None,
                    });
                }
            }
            figures[format!("hypervolume_{part}")] = hypervolume(&placed, 30.0, 0.2).into();
            let hashes: Vec<bool> = cases.iter().map(|(_, o)| untouched_the_same(o, &rows)).collect();
            figures[format!("untouched_identical_{part}")] = hashes.iter().all(|h| *h).into();
            if part == "edit" {
                let reference = reference_params(base, self.reference_steps());
                stops = Some(self.stops_of(&same_target, reference, &models));
            }
        }
        let sensors = self.sensors(&models)?;
        points.extend(sensors.iter().map(sensor_json));
        if let Some(stops) = &stops {
            for mark in &mut marks {
                let stop = stops.stops.iter().find(|s| {
                    settings::name_of(&s.knobs, &StopKnobs::of(&GenParams::default())) == mark.name
                });
                mark.stop = stop.map(|s| s.name.clone());
            }
        }
        let self_check = self.self_check(&models, &progress)?;
        progress.done();
        let report = json!({
            "points": points,
            "reference": {
                "edit": format!("same weights and seed, ddim, {} steps, every token, f32", self.reference_steps()),
                "self_check": self_check,
                "lidar": "4096 samples on every ray",
                "splat": "nothing cut off",
                "vae": "the labels themselves",
            },
            "figures": figures,
            "stops": stops,
            "load": { "at_start": load, "at_end": Load::now(), "busy": load.is_busy() },
            "machine": machine(),
            "model": models.card.name,
            "n": { "worlds": self.frames(), "repeats": self.repeats(), "processes": processes },
            "seeds": { "test": cases::TEST_SEED, "turns": self.seed },
            "file": self.output,
        });
        output::write_file(
            &self.output,
            serde_json::to_string_pretty(&report)
                .context("write report")?
                .as_bytes(),
        )?;
        if let Some(path) = &self.plot {
            let picture = plot::picture(&marks, [820.0, 480.0]);
            output::write_png(path, picture.width, picture.height, &picture.rgba)?;
        }
        if let (Some(path), Some(stops)) = (&self.stops, &stops) {
            write_stops(path, stops)?;
        }
        output::report(&self.common, &report, || table(&report));
        Ok(())
    }

    fn sensors(&self, models: &Arc<OccModels>) -> anyhow::Result<Vec<Measured>> {
        let (frames, repeats) = (self.frames().min(4), self.repeats());
        let mut out = Vec::new();
        if self.has("lidar") {
            out.extend(sensors::lidars(frames, repeats)?);
        }
        if self.has("splat") {
            out.extend(sensors::splats(frames, repeats));
        }
        if self.has("vae") {
            out.extend(sensors::vaes(models, frames, repeats)?);
        }
        Ok(out)
    }

    /// How far half of the reference's steps lie from the reference, on the first case: what its own error is like.
    fn self_check(&self, models: &Arc<OccModels>, progress: &Progress) -> anyhow::Result<Value> {
        if !self.has("edit") {
            return Ok(Value::Null);
        }
        let found = self.cases("edit")?;
        if found.is_empty() {
            return Ok(Value::Null);
        }
        progress.at("self-check", 0, 1);
        let bench = Bench {
            models: models.clone(),
            reference_steps: self.reference_steps(),
            kept_in: self.keep_references.clone(),
        };
        let half = Setting {
            name: "half".into(),
            params: reference_params(GenParams::default(), self.reference_steps() / 2),
            other_target: false,
        };
        let ctx = JobCtx::detached();
        let outcomes = bench.run(&found[..1], &[half], 0, GenParams::default(), 0, &ctx, |_| {})?;
        Ok(outcomes[0].first().map_or(Value::Null, |o| {
            json!({ "case": found[0].name, "steps": self.reference_steps() / 2, "error": o.error, "latent_error": o.latent_error })
        }))
    }

    /// Stops from the front: the fastest, the knee, the most exact, and those between them that lie well apart, and the
    /// reference.
    fn stops_of(&self, rows: &[&Row], reference: GenParams, models: &OccModels) -> Stops {
        let placed: Vec<Placed> = rows.iter().map(|r| r.placed()).collect();
        let on_front = front(&placed);
        let mut order: Vec<usize> = (0..rows.len())
            .filter(|i| on_front[*i] && rows[*i].cost().is_some())
            .collect();
        order.sort_by(|a, b| placed[*a].wall_s.median.total_cmp(&placed[*b].wall_s.median));
        // Only those whose time rises and whose error falls by enough to be felt.
        let mut kept: Vec<usize> = Vec::new();
        for i in order {
            let of = |k: usize| (placed[k].wall_s.median, placed[k].error.median);
            match kept.last().map(|k| of(*k)) {
                Some((_, error)) if of(i).1 >= 0.85 * error => {}
                // Nearly as fast and much nearer: nobody would choose the other.
                Some((wall_s, error)) if of(i).0 <= 1.1 * wall_s => {
                    if of(i).1 < 0.5 * error {
                        kept.pop();
                        kept.push(i);
                    }
                }
                _ => kept.push(i),
            }
        }
        let middle = knee(&kept.iter().map(|i| placed[*i]).collect::<Vec<_>>()).unwrap_or(0);
        let last = kept.len().saturating_sub(1);
        let middle = if last >= 2 {
            middle.clamp(1, last - 1)
        } else {
            middle
        };
        let numbered = |name: &str, nth: usize| {
            if nth == 0 {
                name.to_owned()
            } else {
                format!("{name} {}", nth + 1)
            }
        };
        let name = |k: usize| match k {
            0 => "draft".to_owned(),
            k if k == last => "accurate".into(),
            k if k == middle => "balanced".into(),
            k if k < middle => numbered("quick", k - 1),
            k => numbered("fine", k - middle - 1),
        };
        let mut stops: Vec<Stop> = Vec::new();
        for (k, i) in kept.iter().enumerate() {
            let (row, placed) = (rows[*i], placed[*i]);
            let errors = row.all(|o| o.error);
            if let Some(cost) = row.cost() {
                stops.push(Stop {
                    name: name(k),
                    knobs: StopKnobs::of(&row.setting.params),
                    error: placed.error,
                    error_of_one: [quantile(&errors, 0.05), quantile(&errors, 0.95)],
                    cost,
                    invert_s: median(&row.all(|o| o.invert_s)),
                    probe: row
                        .outcomes
                        .iter()
                        .take(cases::KINDS.len())
                        .map(|o| o.result_hash)
                        .collect(),
                });
            }
        }
        // One step of all tokens, from the dense setting, gives what the reference takes.
        let dense = rows.iter().find(|r| {
            let p = &r.setting.params;
            !p.local && p.steps == 10 && p.reuse_steps == 1
        });
        if let Some(dense) = dense {
            let step_s = |o: &Outcome| o.stages_s.get("denoise").copied().unwrap_or(0.0) / 10.0;
            let (step, total) = (
                median(&dense.all(step_s)),
                median(&dense.all(|o| median(&o.wall_s))),
            );
            let none = crate::generation::trade::Interval {
                median: 0.0,
                low: 0.0,
                high: 0.0,
                n: dense.outcomes.len(),
            };
            let steps = f64::from(reference.steps);
            stops.push(Stop {
                name: "reference".into(),
                knobs: StopKnobs::of(&reference),
                error: none,
                error_of_one: [0.0, 0.0],
                cost: Cost {
                    fixed_s: total + step * (steps - 10.0),
                    per_token_s: 0.0,
                },
                invert_s: step * steps,
                probe: Vec::new(),
            });
        }
        Stops {
            weights: models.card.hashes,
            machine: machine(),
            build: String::new(),
            load_per_core: Load::now().per_core,
            reference: format!("{} steps, every token, f32", reference.steps),
            stops,
        }
    }
}

/// What can be measured.
const PARTS: [&str; 5] = ["edit", "scene", "lidar", "splat", "vae"];

/// Writes stops where they are to be read by [`Stops::parse`].
pub fn write_stops(path: &Path, stops: &Stops) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(stops).context("write stops")?;
    output::write_file(path, text.as_bytes())
}

/// True if all settings left the same voxels outside the region.
fn untouched_the_same(outcomes: &[Outcome], rows: &[Row]) -> bool {
    let same_region = outcomes
        .iter()
        .zip(rows)
        .filter(|(o, r)| !r.setting.other_target && o.error.is_finite());
    let mut hashes = same_region.map(|(o, _)| (o.untouched_hash, o.untouched_voxels_changed));
    let first = hashes.next();
    first.is_none_or(|(hash, changed)| changed == 0 && hashes.all(|h| h == (hash, 0)))
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

fn sensor_json(m: &Measured) -> Value {
    json!({
        "part": m.part,
        "name": m.name,
        "wall_s": m.wall_s,
        "error": m.error,
        "figures": m.figures,
        "peak_rss_mb": m.peak_rss_mb,
        "other_target": m.other_target,
    })
}

/// The report for a person.
fn table(report: &Value) -> String {
    let mut lines = vec![format!(
        "{:<44} {:>9} {:>19} {:>9}",
        "setting", "time", "differs (95 %)", "memory"
    )];
    let points = report["points"].as_array().cloned().unwrap_or_default();
    let mut part = String::new();
    for p in &points {
        let of = p["part"].as_str().unwrap_or("");
        if of != part {
            part = of.into();
            lines.push(format!("-- {part}"));
        }
        let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
        let error = match of {
            "lidar" if p["error"]["median"].is_null() => "no hit".into(),
            "lidar" => format!("{:.3} m", number(&p["error"]["median"])),
            _ => format!(
                "{} ({} to {})",
                plot::percent(number(&p["error"]["median"])),
                plot::percent(number(&p["error"]["low"])),
                plot::percent(number(&p["error"]["high"]))
            ),
        };
        let front = if p["on_front"] == true { "*" } else { " " };
        lines.push(format!(
            "{front} {:<42} {:>9} {:>19} {:>6.0} MB",
            p["name"].as_str().unwrap_or(""),
            plot::seconds(number(&p["wall_s"]["median"])),
            error,
            number(&p["peak_rss_mb"]),
        ));
    }
    lines.push("* nothing is both faster and nearer".into());
    lines.join("\n")
}
