//! The presets of the quality slider: settings on the measured front, from draft to reference.

use serde::{Deserialize, Serialize};

use super::{Cost, Interval};
use diffusion::solver::SolverKind;
use job::params::GenParams;
use nn::Precision;

/// The knobs that a preset sets; all other parameters stay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PresetKnobs {
    /// Sampling steps.
    pub steps: u32,
    /// Solver of the sampling steps.
    pub solver: SolverKind,
    /// Precision of the network's products.
    pub precision: Precision,
    /// Compute only the tokens around the edit.
    pub local: bool,
    /// Tokens around the region that are computed with it.
    pub halo_tokens: u32,
    /// Fixed-point updates per inversion step.
    pub inversion_iterations: u32,
    /// See [`GenParams::reuse_steps`].
    pub reuse_steps: u32,
    /// See [`GenParams::fine_steps`].
    #[serde(default)]
    pub fine_steps: u32,
}

impl PresetKnobs {
    /// The knobs of the given parameters.
    pub fn from_params(params: &GenParams) -> Self {
        Self {
            steps: params.steps,
            solver: params.solver,
            precision: params.precision,
            local: params.local,
            halo_tokens: params.halo_tokens,
            inversion_iterations: params.inversion_iterations,
            reuse_steps: params.reuse_steps,
            fine_steps: params.fine_steps,
        }
    }

    /// The parameters with these knobs.
    pub fn on(&self, params: GenParams) -> GenParams {
        GenParams {
            steps: self.steps,
            solver: self.solver,
            precision: self.precision,
            local: self.local,
            halo_tokens: self.halo_tokens,
            inversion_iterations: self.inversion_iterations,
            reuse_steps: self.reuse_steps,
            fine_steps: self.fine_steps,
            ..params
        }
    }
}

/// Former and present names of presets, since files and settings may hold the former.
const BEFORE: [(&str, &str); 1] = [("accurate", "careful")];

/// One preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Name that users see, such as `draft`.
    pub name: String,
    /// Its settings.
    pub knobs: PresetKnobs,
    /// Share of the region's voxels that differ from the reference: median over edits and its interval.
    pub error: Interval,
    /// Number of differing voxels over the number of the region's voxels that either grid holds occupied, if it was
    /// measured: most of a region is air.
    #[serde(default)]
    pub error_of_occupied: Option<Interval>,
    /// Interval of the share of differing voxels that nine of ten single edits fall into.
    pub error_of_one: [f64; 2],
    /// Invented voxels: voxels above the ground that an edit adds though they are in neither the source nor the
    /// request. Mean over edits, if it was counted. A result nearer to the reference is not always less invented, so no
    /// preset is called accurate.
    #[serde(default)]
    pub invented: Option<f64>,
    /// Wall time of an edit whose source is prepared.
    pub cost: Cost,
    /// Wall time of inverting the source first, s.
    pub invert_s: f64,
    /// Hashes of the results on the edits of the first held-out world (`label_hash`): a machine with the same hashes
    /// has the same errors.
    pub probe: Vec<u64>,
}

/// All presets, from the fastest to the reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Presets {
    /// Weights that the presets were measured with: `hashes` of the `ModelCard` in `nets`.
    pub weights: [u64; 3],
    /// The machine on which the times were taken.
    pub machine: String,
    /// The build of the program that took the times; empty for the presets that ship.
    #[serde(default)]
    pub build: String,
    /// Running processes per core while the times were taken.
    #[serde(default)]
    pub load_per_core: Option<f64>,
    /// Reference that the errors are measured against.
    pub reference: String,
    /// The presets. Files use the name that this field had first.
    #[serde(rename = "stops", alias = "presets")]
    pub all: Vec<Preset>,
}

impl Presets {
    /// The presets measured for the shipped weights. Times are of the machine named in them until the user calibrates.
    pub fn bundled() -> Self {
        let text = assets::trade::PRESETS;
        serde_json::from_str(text).unwrap_or_else(|_| Self {
            weights: [0; 3],
            machine: String::new(),
            build: String::new(),
            load_per_core: None,
            reference: String::new(),
            all: Vec::new(),
        })
    }

    /// Reads presets that were measured on a user's machine. Refuses other weights and figures out of range, in one
    /// line.
    pub fn parse(text: &str, weights: [u64; 3]) -> Result<Self, String> {
        let read: Self = serde_json::from_str(text).map_err(|e| e.to_string())?;
        if read.weights != weights {
            return Err("measured with other weights".into());
        }
        let sound = |s: &Preset| {
            let ends = [
                s.error.low,
                s.error.median,
                s.error.high,
                s.invert_s,
                s.cost.fixed_s,
                s.cost.per_token_s,
            ];
            ends.iter()
                .chain(&s.error_of_one)
                .chain(&s.invented)
                .chain(
                    s.error_of_occupied
                        .iter()
                        .flat_map(|i| [&i.low, &i.median, &i.high]),
                )
                .all(|v| v.is_finite() && *v >= 0.0)
                && s.knobs.on(GenParams::default()).check().is_ok()
        };
        match read.all.iter().find(|s| !sound(s)) {
            _ if read.all.is_empty() => Err("no presets".into()),
            Some(bad) => Err(format!("preset {:?}: a figure is out of range", bad.name)),
            None => Ok(read),
        }
    }

    /// The preset of that name, present or former.
    pub fn named(&self, name: &str) -> Option<&Preset> {
        self.index_named(name).map(|i| &self.all[i])
    }

    /// Index of the preset of that name, present or former.
    pub fn index_named(&self, name: &str) -> Option<usize> {
        let of = |name: &str| self.all.iter().position(|s| s.name == name);
        of(name).or_else(|| of(BEFORE.iter().find(|(old, _)| *old == name)?.1))
    }

    /// The preset whose knobs these parameters have.
    pub fn index_of(&self, params: &GenParams) -> Option<usize> {
        let knobs = PresetKnobs::from_params(params);
        self.all.iter().position(|s| s.knobs == knobs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nets::OccModels;

    /// Row 64: from the fastest preset to the slowest, time rises and the error falls; every preset can be run.
    #[test]
    fn row_64_the_shipped_presets_are_a_front() {
        let presets = Presets::bundled();
        assert!(presets.all.len() >= 4);
        for pair in presets.all.windows(2) {
            assert!(
                pair[0].error.median > pair[1].error.median,
                "{} {}",
                pair[0].name,
                pair[1].name
            );
            for tokens in [20.0, 60.0] {
                assert!(pair[0].cost.wall_s(tokens) < pair[1].cost.wall_s(tokens));
            }
        }
        for name in ["draft", "balanced", "careful", "reference"] {
            assert!(presets.named(name).is_some(), "{name}");
        }
        assert_eq!(presets.named("accurate"), presets.named("careful"), "of before");
        // What is nearer to the reference may invent more: its name promises nothing else.
        for pair in presets.all.windows(2) {
            let more = pair[1].invented.zip(pair[0].invented).is_some_and(|(b, a)| b > a);
            let promises = ["accurate", "exact", "precise", "best"]
                .iter()
                .any(|w| pair[1].name.contains(w));
            assert!(
                !(more && promises),
                "{} invents more than {}",
                pair[1].name,
                pair[0].name
            );
        }
        for preset in &presets.all {
            let occupied = preset.error_of_occupied.map_or(f64::INFINITY, |i| i.median);
            assert!(occupied >= preset.error.median, "{}", preset.name);
        }
        for (i, preset) in presets.all.iter().enumerate() {
            let params = preset.knobs.on(GenParams::default());
            assert_eq!((params.check(), presets.index_of(&params)), (Ok(()), Some(i)));
            assert!(
                preset.error_of_one[0] <= preset.error.median
                    && preset.error.median <= preset.error_of_one[1]
            );
        }
        assert!(presets.all[0].cost.wall_s(40.0) <= 0.15, "the fastest preset");
    }

    #[test]
    fn the_shipped_presets_were_measured_with_the_shipped_weights() {
        let models = OccModels::bundled().expect("weights");
        assert_eq!(
            Presets::bundled().weights,
            models.card.hashes,
            "run `sceneloom trade --presets`"
        );
    }

    #[test]
    fn foreign_files_are_refused_in_one_line() {
        let presets = Presets::bundled();
        let text = serde_json::to_string(&presets).expect("plain values");
        assert_eq!(Presets::parse(&text, presets.weights), Ok(presets.clone()));
        assert!(Presets::parse(&text, [1, 2, 3]).is_err());
        let mut bad = presets.clone();
        bad.all[0].knobs.steps = 0;
        let refused = |s: &str| {
            let error = Presets::parse(s, presets.weights).expect_err("refused");
            assert_eq!(error.lines().count(), 1, "{error}");
        };
        refused(&serde_json::to_string(&bad).expect("plain values"));
        refused(&text[..text.len() / 2]);
        refused(&text.replace("\"steps\"", "\"stepps\""));
        bad.all.clear();
        refused(&serde_json::to_string(&bad).expect("plain values"));
    }
}
