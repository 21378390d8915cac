//! `sceneloom trade`: cost and benefit of each knob, measured on this machine.

use std::path::PathBuf;

use anyhow::{Context, bail};
use serde_json::json;

use super::progress::ProgressLine;
use super::{CommandResult, Common, Stop, Weights, output};
use app::trade_plot;
use calibration::held_out::TEST_SEED;
use calibration::machine::{Load, machine};
use calibration::measure::{Raw, add_times};
use calibration::plan::{TradeoffPlan, write_presets};
use calibration::report::table;
use nets::OccModels;

/// Arguments.
#[derive(clap::Args)]
pub struct Trade {
    /// Scene whose edits are measured; without one, held-out worlds.
    scene: Option<PathBuf>,
    /// How thorough: `quick` (minutes; reference of 200 steps) or `full` (hours; 1000 steps).
    #[arg(long, default_value = "quick", value_parser = ["quick", "full"])]
    suite: String,
    /// Parts that are measured, comma-separated: edit, scene, lidar, splat, vae.
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
    /// Write the presets of the quality slider that this run found.
    #[arg(long, alias = "stops", value_name = "PRESETS.json")]
    presets: Option<PathBuf>,
    /// For a process of a larger run: write raw outcomes.
    #[arg(long, hide = true)]
    raw: bool,
    /// Which process of a larger run this is: its turns are its own.
    #[arg(long, hide = true, default_value_t = 0)]
    process: u64,
    #[command(flatten)]
    weights: Weights,
    #[command(flatten)]
    common: Common,
}

impl Trade {
    fn plan(&self) -> TradeoffPlan {
        let of = |quick, full| if self.suite == "full" { full } else { quick };
        TradeoffPlan {
            scene: self.scene.clone(),
            parts: self.parts.clone(),
            frames: self.frames.unwrap_or(of(3, 20)),
            repeats: self.repeats.unwrap_or(of(3, 10)),
            reference_steps: self.reference_steps.unwrap_or(of(200, 1000) as u32),
            draws: self.draws,
            only: self.only.clone(),
            keep_references: self.keep_references.clone(),
            seed: self.seed,
            process: self.process,
        }
    }

    /// Warns if other programs take the time, or refuses if that is wanted.
    fn look_at_load(&self) -> Result<Load, Stop> {
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
        Ok(load)
    }

    pub(super) fn run(self) -> CommandResult {
        let plan = self.plan();
        plan.check()?;
        let load = self.look_at_load()?;
        let models = OccModels::open(self.weights.folder.as_deref())?;
        let progress = ProgressLine::new(&self.common);
        let processes = self.processes.unwrap_or(if self.suite == "full" { 3 } else { 1 });
        let raw = if processes > 1 && !self.raw {
            self.measure_in_processes(processes, &progress)?
        } else {
            plan.measure(&models, &progress)?
        };
        if self.raw {
            output::write_file(&self.output, &serde_json::to_vec(&raw).context("write outcomes")?)?;
            return Ok(());
        }
        let found = plan.report(&raw, &models, &progress)?;
        progress.done();
        let report = json!({
            "points": found.points,
            "reference": {
                "edit": format!("same weights and seed, ddim, {} steps, every token, f32", plan.reference_steps),
                "self_check": found.self_check,
                "lidar": "4096 samples on every ray",
                "splat": "nothing cut off",
                "vae": "the labels themselves",
            },
            "figures": found.figures,
            "stops": found.presets,
            "load": { "at_start": load, "at_end": Load::now(), "busy": load.is_busy() },
            "machine": machine(),
            "model": models.card.name,
            "n": { "worlds": plan.frames, "repeats": plan.repeats, "processes": processes },
            "seeds": { "test": TEST_SEED, "turns": self.seed },
            "file": self.output,
        });
        let text = serde_json::to_string_pretty(&report).context("write report")?;
        output::write_file(&self.output, text.as_bytes())?;
        if let Some(path) = &self.plot {
            let picture = trade_plot::picture(&found.marks, [820.0, 480.0]);
            output::write_png(path, picture.width, picture.height, &picture.rgba)?;
        }
        if let (Some(path), Some(presets)) = (&self.presets, &found.presets) {
            write_presets(path, presets)?;
        }
        output::report(&self.common, &report, || table(&report));
        Ok(())
    }

    /// Measures in processes of their own, one after another, and puts their times together. Errors must not differ.
    fn measure_in_processes(&self, processes: usize, progress: &ProgressLine) -> anyhow::Result<Raw> {
        let dir = tempfile::tempdir().context("make a folder for the processes' reports")?;
        let plan = self.plan();
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
                ("--frames", plan.frames.to_string()),
                ("--repeats", plan.repeats.to_string()),
                ("--reference-steps", plan.reference_steps.to_string()),
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
            if let Some(weights) = &self.weights.folder {
                command.arg("--weights").arg(weights);
            }
            let ended = command
                .stdout(std::process::Stdio::null())
                .status()
                .context("start a process")?;
            if !ended.success() {
                bail!("process {i} ended with {ended}");
            }
            let text = formats::input::read_text(&file, formats::input::LARGEST_TEXT)?;
            let raw: Raw = serde_json::from_str(&text).with_context(|| file.display().to_string())?;
            match &mut all {
                None => all = Some(raw),
                Some(all) => add_times(all, raw)?,
            }
        }
        all.context("no process")
    }
}
