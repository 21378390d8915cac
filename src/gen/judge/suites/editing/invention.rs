//! Voxels that edits invent, by preset of the quality slider and kind of edit, for every vehicle of a scene.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use anyhow::bail;
use serde_json::{Value, json};

use super::fit::{Bands, Fit};
use super::materials::TrialScenes;
use super::tally::{InventionTally, MUCH};
use super::trial_run::{STATES, try_edit};
use crate::suite::Options;
use calibration::MeasurementProgress;
use calibration::trials::{Trial, vehicles};
use job::pipeline::OccPipeline;
use job::{GenParams, Job, JobCtx};
use scene::{Class, Scene};
use trade::{Preset, Presets};

/// Classes that are added to every scene, in this order, as many as `--vehicles` allows.
const ADDED: [Class; 6] = [
    Class::Car,
    Class::Truck,
    Class::Bus,
    Class::Trailer,
    Class::ConstructionVehicle,
    Class::Pedestrian,
];
/// The preset that the bars are about.
const USUAL: &str = "balanced";
/// Smallest difference in the mean number of invented voxels that counts.
const CLEARLY: f64 = 1.0;
/// Figures of one material.
pub struct Invention {
    /// All figures.
    pub report: Value,
    /// Share of the removals, as shown with the usual preset, that invent no more than [`MUCH`] voxels; `None` if that
    /// preset was not judged.
    pub removals_clear: Option<f64>,
}

/// Figures of one preset.
#[derive(Default)]
struct OfPreset {
    kinds: BTreeMap<&'static str, InventionTally>,
    added: Fit,
    moved: Fit,
}

/// Every edit that suits a scene, with its kind; the list is the same for every preset.
pub(super) fn trials(scene: &Scene, most: usize, seed: u64) -> Vec<(&'static str, Trial)> {
    let frame = scene.frame();
    let mut out = Vec::new();
    for vehicle in vehicles(frame, most) {
        for kind in ["remove", "move", "class"] {
            out.extend(Trial::of_vehicle(kind, frame, vehicle, seed).map(|t| (kind, t)));
        }
    }
    for class in ADDED.into_iter().take(most) {
        out.extend(Trial::adding(frame, class, seed).map(|t| ("add", t)));
    }
    for kind in ["road", "crossing"] {
        out.extend(Trial::propose(kind, frame, seed).map(|t| (kind, t)));
    }
    out
}

impl Options {
    /// The presets to judge.
    pub(super) fn presets(&self) -> anyhow::Result<Vec<Preset>> {
        let all = Presets::bundled().all;
        if self.presets.is_empty() {
            // The reference is left out: it takes seconds an edit.
            return Ok(all.into_iter().filter(|s| s.error.high > 0.0).collect());
        }
        let named = |name: &String| match all.iter().find(|s| s.name == *name) {
            Some(preset) => Ok(preset.clone()),
            None => {
                let names: Vec<&str> = all.iter().map(|s| s.name.as_str()).collect();
                bail!("--presets {name}: expected some of {}", names.join(", "))
            }
        };
        self.presets.iter().map(named).collect()
    }

    /// Tries every edit of every scene with every preset, and compares inversion with fresh noise.
    pub(super) fn invention(
        &self,
        material: &TrialScenes,
        presets: &[Preset],
        pipeline: &OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<Invention> {
        let base = GenParams {
            keep_objects: false,
            ..self.edit_params.clone()
        };
        let mut found: Vec<OfPreset> = presets.iter().map(|_| OfPreset::default()).collect();
        let mut bands = Bands::default();
        let mut fresh = super::fresh::Fresh::default();
        let name = material.name();
        for i in 0..material.count() {
            progress.at(name, i, material.count());
            let scene = material.scene(i)?;
            bands.add(scene.frame());
            let trials = trials(&scene, self.vehicles, i as u64);
            for (preset, found) in presets.iter().zip(&mut found) {
                let params = preset.knobs.on(base.clone());
                // Every edit starts from the inverted source, never from what another edit left in memory.
                let mut ready = pipeline.clone();
                let job = Job {
                    scene: Arc::new(scene.clone()),
                    params: params.clone(),
                };
                ready.prepare(&job, &JobCtx::detached())?;
                for (kind, trial) in &trials {
                    let tried = try_edit(&ready, &scene, trial, params.clone())?;
                    found.kinds.entry(kind).or_default().add(&tried);
                    match (*kind, &tried.brought) {
                        ("add", Some(brought)) => found.added.add(brought),
                        ("move", Some(brought)) => found.moved.add(brought),
                        _ => {}
                    }
                }
            }
            fresh.add(pipeline, &scene, &trials, base.clone())?;
        }
        if !matches!(material, TrialScenes::Files(_)) {
            for i in material.count()..self.band_worlds {
                progress.at("voxels of objects", i, self.band_worlds);
                bands.add(material.scene(i)?.frame());
            }
        }
        let by_preset: BTreeMap<&str, Value> = presets
            .iter()
            .zip(&found)
            .map(|(preset, found)| (preset.name.as_str(), found.report(&bands)))
            .collect();
        let usual = presets.iter().position(|s| s.name == USUAL);
        let removals = usual.and_then(|i| found[i].kinds.get("remove"));
        Ok(Invention {
            removals_clear: removals.map(|t| 1.0 - t.invents(STATES.len() - 1).1),
            report: json!({
                "scenes": material.count(),
                "much_is_more_than_voxels": MUCH,
                "presets": table(presets, &found),
                "slower_but_invents_more": contradictions(presets, &found),
                "by_preset": by_preset,
                "inversion_and_fresh_noise": fresh.report(),
                "voxels_of_objects": bands.report(),
            }),
        })
    }
}

impl OfPreset {
    fn report(&self, bands: &Bands) -> Value {
        let kinds: BTreeMap<&str, Value> = self.kinds.iter().map(|(k, t)| (*k, t.report())).collect();
        json!({ "kinds": kinds, "added": self.added.report(bands), "moved": self.moved.report(bands) })
    }
}

/// One row per preset, from the fastest to the slowest: its distance to the slider's reference, and what it invents.
fn table(presets: &[Preset], found: &[OfPreset]) -> Value {
    let rows = presets.iter().zip(found).map(|(preset, found)| {
        let kinds = found.kinds.iter().map(|(kind, tally)| {
            let of = |state: usize| {
                let (mean, much) = tally.invents(state);
                let round = |v: f64| (v * 1e3).round() / 1e3;
                json!({ "invented": round(mean), "invent_much": round(much) })
            };
            ((*kind).to_owned(), json!({ "networks": of(0), "shown": of(2) }))
        });
        json!({
            "preset": preset.name,
            "steps": preset.knobs.steps,
            "differs_from_reference": preset.error.median,
            "kinds": kinds.collect::<Value>(),
        })
    });
    rows.collect()
}

/// Kinds of edits in which the networks alone invent more with a preset than with a faster one: such a preset is nearer
/// to the slider's reference, but not more accurate.
fn contradictions(presets: &[Preset], found: &[OfPreset]) -> Vec<String> {
    let kinds: BTreeSet<&str> = found.iter().flat_map(|f| f.kinds.keys().copied()).collect();
    let mut out = Vec::new();
    for kind in kinds {
        let mut least: Option<(&str, f64)> = None; // of the faster presets
        for (preset, found) in presets.iter().zip(found) {
            let Some(tally) = found.kinds.get(kind) else {
                continue;
            };
            let (name, invents) = (preset.name.as_str(), tally.invents(0).0);
            match least {
                Some((fast, less)) if invents > less + CLEARLY => out.push(format!(
                    "{kind}: {name} invents {invents:.1} voxels per edit, {fast} {less:.1}: it is not more accurate"
                )),
                Some((_, less)) if invents >= less => {}
                _ => least = Some((name, invents)),
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suites::editing::trial_run::Tried;
    use job::invented::Invented;

    #[test]
    fn a_slower_preset_that_invents_more_is_named() {
        let presets = &Presets::bundled().all[..3];
        let of = |voxels: usize| {
            let mut invented = Invented::default();
            invented.by_class[usize::from(Class::Vegetation.id())] = voxels;
            let mut found = OfPreset::default();
            found.kinds.entry("remove").or_default().add(&Tried {
                reached: Default::default(),
                invented: [invented.clone(), invented.clone(), invented],
                brought: None,
            });
            found
        };
        let said = |voxels: [usize; 3]| contradictions(presets, &voxels.map(of));
        assert_eq!(said([9, 5, 5]), Vec::<String>::new());
        let lines = said([0, 533, 603]);
        assert_eq!(lines.len(), 2);
        let [fastest, _, slowest] = [0, 1, 2].map(|i: usize| &presets[i].name);
        assert_eq!(
            lines[1],
            format!(
                "remove: {slowest} invents 603.0 voxels per edit, {fastest} 0.0: it is not more accurate"
            )
        );
    }
}
