//! `sceneloom trade`: what each knob costs and what it buys, measured on this machine.

mod measure;
mod report;
mod stops;

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, bail};
use serde_json::{Value, json};

use super::generate::{full_params, models};
use super::progress::Progress;
use super::{Common, Outcome, Stop, output};
use crate::open;
use crate::trade::cases::{self, Case};
use crate::trade::edits::{Bench, reference_params};
use crate::trade::load::{Load, machine};
use crate::trade::plot::{self, Mark};
use crate::trade::sensors::{self, Measured};
use crate::trade::settings::{self, Setting};
use job::{GenParams, JobCtx};
use nets::OccModels;
use report::{Row, sensor_json, table, untouched_the_same};
use trade::{Placed, StopKnobs, front, hypervolume};

pub use stops::write_stops;

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

    fn settings(&self, part: &str) -> (GenParams, Vec<Setting>) {
        let (base, mut settings) = if part == "edit" {
            let base = GenParams::default();
            (base, settings::of_edits(base, self.draws, self.seed))
        } else {
            let base = full_params();
            (base, settings::of_scenes(base))
        };
        settings.retain(|s| self.only.is_empty() || self.only.contains(&s.name));
        (base, settings)
    }

    fn cases(&self, part: &str) -> anyhow::Result<Vec<Case>> {
        let whole = |scene: scene::Scene, name: String| {
            let scene = Arc::new(scene);
            vec![Case {
                name,
                before: scene.clone(),
                after: scene,
            }]
        };
        let of = |scene: scene::Scene, name: String, seed: u64| match part {
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

    fn has(&self, part: &str) -> bool {
        self.parts.iter().any(|p| p == part)
    }

    pub(super) fn run(self) -> Outcome {
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
                return Err(Stop::Short(line));
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
            let (base, settings) = self.settings(part);
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
}

/// What can be measured.
const PARTS: [&str; 5] = ["edit", "scene", "lidar", "splat", "vae"];
