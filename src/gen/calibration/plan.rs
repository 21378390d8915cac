//! A run of `sceneloom trade`: the plan of its measurements, and what is made of them.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::bail;
use serde_json::{Value, json};

use super::cases::{self, Case};
use super::choose::presets_of;
pub use super::choose::write_presets;
use super::edits::{Bench, CaseOutcome, reference_params};
use super::measure::Raw;
use super::report::{SettingOutcomes, sensor_json, untouched_the_same};
use super::sensors;
use super::settings::{self, CandidateSetting};
use crate::MeasurementProgress;
use crate::held_out::bare_scene;
use crate::machine::told;
use job::{GenParams, JobCtx};
use nets::OccModels;
use scene::Scene;
use trade::{PresetKnobs, Presets, TradePoint, front, hypervolume};

/// Parts that can be measured.
pub const PARTS: [&str; 5] = ["edit", "scene", "lidar", "splat", "vae"];

/// Scenes, parts and numbers of a measurement.
#[derive(Clone, Debug, Default)]
pub struct TradeoffPlan {
    /// Scene whose edits are measured; without one, held-out worlds.
    pub scene: Option<PathBuf>,
    /// Some of [`PARTS`].
    pub parts: Vec<String>,
    /// Number of held-out worlds, 1 to 1000.
    pub frames: usize,
    /// Timed runs of each setting on each case, 1 to 1000.
    pub repeats: usize,
    /// Steps of the reference, 2 to 1000.
    pub reference_steps: u32,
    /// Number of random settings across all knobs, beside each knob by itself.
    pub draws: usize,
    /// Settings to measure, by their names in the report; empty for all.
    pub only: Vec<String>,
    /// Folder that keeps the references between runs.
    pub keep_references: Option<PathBuf>,
    /// Seed of draws and turns.
    pub seed: u64,
    /// Number of this process in a larger run; it changes the turns.
    pub process: u64,
}

/// A setting in a plot of time against error.
#[derive(Clone, Debug)]
pub struct TradeoffPoint {
    /// Its name.
    pub name: String,
    /// Wall time, s: median and interval.
    pub wall_s: [f64; 3],
    /// Error, share of voxels: median and interval.
    pub error: [f64; 3],
    /// True if it lies on the front: no setting beats it in time and error.
    pub on_front: bool,
    /// Name of the preset of the slider that this setting became, if it became one.
    pub preset: Option<String>,
}

/// Results of a run.
#[derive(Default)]
pub struct TradeResults {
    /// One entry per setting of every part.
    pub points: Vec<Value>,
    /// The settings of edits, to be plotted.
    pub marks: Vec<TradeoffPoint>,
    /// The presets of the slider, if edits were measured.
    pub presets: Option<Presets>,
    /// Figures over all settings of a part.
    pub figures: Value,
    /// Difference between half of the reference's steps and the reference; null if edits were not measured.
    pub self_check: Value,
}

impl TradeoffPlan {
    /// Checks the numbers. Errors are one line: the option, the value found and the value expected.
    pub fn check(&self) -> anyhow::Result<()> {
        if let Some(unknown) = self.parts.iter().find(|p| !PARTS.contains(&p.as_str())) {
            bail!("--parts {unknown}: expected {}", PARTS.join(", "));
        }
        if !(2..=1000).contains(&self.reference_steps) {
            bail!("--reference-steps {}: expected 2 to 1000", self.reference_steps);
        }
        for (name, number) in [("--frames", self.frames), ("--repeats", self.repeats)] {
            if !(1..=1000).contains(&number) {
                bail!("{name} {number}: expected 1 to 1000");
            }
        }
        Ok(())
    }

    /// Base and settings of edits or scenes.
    pub(super) fn settings(&self, part: &str) -> (GenParams, Vec<CandidateSetting>) {
        let (base, mut settings) = if part == "edit" {
            let base = GenParams::default();
            (base.clone(), settings::of_edits(base, self.draws, self.seed))
        } else {
            let base = GenParams::whole_scene();
            (base.clone(), settings::of_scenes(base))
        };
        settings.retain(|s| self.only.is_empty() || self.only.contains(&s.name));
        (base, settings)
    }

    /// Cases of a part. Errors name the scene's file.
    pub(super) fn cases(&self, part: &str) -> anyhow::Result<Vec<Case>> {
        let whole = |scene: Scene, name: String| {
            let scene = Arc::new(scene);
            vec![Case {
                name,
                before: scene.clone(),
                after: scene,
            }]
        };
        let of = |scene: Scene, name: String, seed: u64| match part {
            "edit" => cases::of_scene(&scene, &name, seed),
            _ => whole(scene, name),
        };
        if let Some(path) = &self.scene {
            let found = of(authoring::open::scene(path)?, told(path), self.seed);
            if found.is_empty() {
                bail!("{}: nothing to edit: no car and no road", path.display());
            }
            return Ok(found);
        }
        let worlds = 0..self.frames as u64;
        Ok(worlds
            .flat_map(|i| of(bare_scene(i), format!("world {i}"), i))
            .collect())
    }

    /// True if a part is to be measured.
    pub(super) fn has(&self, part: &str) -> bool {
        self.parts.iter().any(|p| p == part)
    }

    /// Summarises the outcomes, and measures the cost of the sensors' knobs. Errors if weights or the scene cannot be
    /// used.
    pub fn report(
        &self,
        raw: &Raw,
        models: &Arc<OccModels>,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<TradeResults> {
        let mut found = TradeResults {
            figures: json!({}),
            ..TradeResults::default()
        };
        for (part, cases) in &raw.parts {
            self.add_part(part, cases, models, &mut found);
        }
        self.sensors(models, &mut found)?;
        if let Some(presets) = &found.presets {
            let usual = PresetKnobs::from_params(&GenParams::default());
            for mark in &mut found.marks {
                let named = |s: &&trade::Preset| settings::name_of(&s.knobs, &usual) == mark.name;
                mark.preset = presets.all.iter().find(named).map(|s| s.name.clone());
            }
        }
        found.self_check = self.self_check(models, progress)?;
        Ok(found)
    }

    /// Edits or scenes: points, marks, presets, figures.
    fn add_part(
        &self,
        part: &str,
        cases: &[(String, Vec<CaseOutcome>)],
        models: &OccModels,
        found: &mut TradeResults,
    ) {
        let (base, settings) = self.settings(part);
        let of_setting = |i: usize| cases.iter().filter_map(move |(_, o)| o.get(i)).cloned().collect();
        let rows = settings
            .into_iter()
            .enumerate()
            .map(|(i, setting)| SettingOutcomes {
                setting,
                outcomes: of_setting(i),
            });
        let rows: Vec<SettingOutcomes> = rows.collect();
        let same_target: Vec<&SettingOutcomes> = rows.iter().filter(|r| !r.setting.other_target).collect();
        let points: Vec<TradePoint> = same_target.iter().map(|r| r.point()).collect();
        let mut on_front = front(&points).into_iter();
        for row in &rows {
            let on_front = !row.setting.other_target && on_front.next().unwrap_or(false);
            found.points.push(row.json(part, on_front));
            if part == "edit" && !row.setting.other_target {
                let p = row.point();
                found.marks.push(TradeoffPoint {
                    name: row.setting.name.clone(),
                    wall_s: [p.wall_s.median, p.wall_s.low, p.wall_s.high],
                    error: [p.error.median, p.error.low, p.error.high],
                    on_front,
                    preset: None,
                });
            }
        }
        found.figures[format!("hypervolume_{part}")] = hypervolume(&points, 30.0, 0.2).into();
        let same = cases.iter().all(|(_, o)| untouched_the_same(o, &rows));
        found.figures[format!("untouched_identical_{part}")] = same.into();
        if part == "edit" {
            let reference = reference_params(base, self.reference_steps);
            found.presets = Some(presets_of(&same_target, reference, models));
        }
    }

    fn sensors(&self, models: &Arc<OccModels>, found: &mut TradeResults) -> anyhow::Result<()> {
        let (frames, repeats) = (self.frames.min(4), self.repeats);
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
        found.points.extend(out.iter().map(sensor_json));
        Ok(())
    }

    /// Difference between half of the reference's steps and the reference, on the first case: an estimate of the
    /// reference's own error.
    fn self_check(
        &self,
        models: &Arc<OccModels>,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<Value> {
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
            reference_steps: self.reference_steps,
            kept_in: self.keep_references.clone(),
        };
        let half = CandidateSetting {
            name: "half".into(),
            params: reference_params(GenParams::default(), self.reference_steps / 2),
            other_target: false,
        };
        let ctx = JobCtx::detached();
        let outcomes = bench.run(&found[..1], &[half], 0, GenParams::default(), 0, &ctx, |_| {})?;
        Ok(outcomes[0].first().map_or(Value::Null, |o| {
            json!({ "case": found[0].name, "steps": self.reference_steps / 2, "error": o.error, "latent_error": o.latent_error })
        }))
    }
}
