//! Every knob of a generation, as plain values that name a cache entry.

use std::hash::{Hash, Hasher};

use serde::{Deserialize, Serialize};

use super::inpaint::InpaintMask;
use crate::contract::GenError;
use diffusion::solver::{Guidance, SolverKind};
use nn::Precision;
use scene::Density;

/// Part of the scene that is regenerated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RegionMode {
    /// The edited region; everything else stays bit-identical.
    #[default]
    Auto,
    /// The whole scene, from fresh noise.
    Full,
}

/// Quality of a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// A quick result to show while editing; it may be coarser.
    Preview,
    /// The result to keep.
    #[default]
    Final,
}

/// Numbers of [`Density`] that the user chose, each 0 to 1. An edit keeps the numbers that are not chosen; in a new
/// scene the networks decide them (except completeness, which is 1 there).
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChosenDensities {
    /// Density of vegetation.
    pub vegetation: Option<f32>,
    /// Density of buildings.
    pub building: Option<f32>,
    /// Density of low furniture.
    pub clutter: Option<f32>,
    /// 1 for complete worlds, about 0.4 for real labels.
    pub completeness: Option<f32>,
}

impl ChosenDensities {
    /// The values in the networks' order.
    pub fn values(&self) -> [Option<f32>; 4] {
        [self.vegetation, self.building, self.clutter, self.completeness]
    }

    /// These numbers, with those not chosen taken from `other`.
    pub fn or_else(&self, other: &Self) -> Self {
        Self {
            vegetation: self.vegetation.or(other.vegetation),
            building: self.building.or(other.building),
            clutter: self.clutter.or(other.clutter),
            completeness: self.completeness.or(other.completeness),
        }
    }

    /// These numbers, with those not chosen taken from `density`.
    pub fn or(&self, density: &Density) -> Self {
        self.or_else(&Self {
            vegetation: Some(density.vegetation),
            building: Some(density.building),
            clutter: Some(density.clutter),
            completeness: Some(density.completeness),
        })
    }
}

/// Every knob of a generation. Equality is bit for bit, so parameters can name a cache entry.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GenParams {
    /// Sampling steps, 1 to 1000.
    pub steps: u32,
    /// Solver of the steps; with O-BELM the inversion is exact.
    pub solver: SolverKind,
    /// Classifier-free guidance weight. 1 means no guidance: half the network calls, and inversion is good.
    pub guidance: f64,
    /// See [`Guidance::rescale`].
    pub guidance_rescale: f64,
    /// Seed of all noise.
    pub seed: u64,
    /// Part of the scene that is regenerated.
    pub region: RegionMode,
    /// Cells that are regenerated in automatic mode although they were not edited. They change only if `strength` is
    /// above 0.
    #[serde(rename = "redraw", alias = "inpaint")]
    pub inpaint: InpaintMask,
    /// Strength of fresh noise. 0: the region starts from the noise that its source comes from (inversion). Above 0: it
    /// starts from the source with fresh noise added, at this share of the steps (SDEdit), and all tokens are computed;
    /// 1 keeps nothing of the source.
    pub strength: f64,
    /// Fixed-point updates per inversion step; 0 = plain DDIM inversion.
    pub inversion_iterations: u32,
    /// Columns around an edit that are inpainted with it.
    pub halo_columns: u32,
    /// True to compute only the tokens around an edit; the others take part with their keys and values from the source.
    pub local: bool,
    /// Tokens (3.2 m) around an edited region that are computed with it.
    pub halo_tokens: u32,
    /// Number format of the denoising network's matrix products.
    pub precision: Precision,
    /// Interval, in steps, at which the middle blocks of the network are computed; they are reused in between. 1 =
    /// every step.
    pub reuse_steps: u32,
    /// Steps of the fine stage; 0 = none.
    pub fine_steps: u32,
    /// Quality of the result.
    pub quality: Quality,
    /// Densities and completeness that the user chose.
    pub named: ChosenDensities,
    /// True to correct the networks where they ignore the user: for example, puts in the draft of a placed box that is
    /// mostly missing.
    pub keep_objects: bool,
}

impl Default for GenParams {
    fn default() -> Self {
        Self {
            steps: 10,
            solver: SolverKind::Ddim,
            guidance: 1.0,
            guidance_rescale: 0.0,
            seed: 0,
            region: RegionMode::Auto,
            inpaint: InpaintMask::default(),
            strength: 0.0,
            inversion_iterations: 0,
            halo_columns: 2,
            local: true,
            halo_tokens: 1,
            precision: Precision::F32,
            reuse_steps: 1,
            fine_steps: 2,
            quality: Quality::Final,
            named: ChosenDensities::default(),
            keep_objects: true,
        }
    }
}

/// Counts, numbers, named numbers, choices.
type Bits = ([u32; 6], [u64; 4], [Option<u32>; 4], Choices);
type Choices = (SolverKind, RegionMode, InpaintMask, Quality, Precision, [bool; 2]);

impl GenParams {
    /// Range of guidance in which layouts come out as asked for, see docs/trade.md.
    pub const MEASURED_GUIDANCE: [f64; 2] = [0.5, 2.0];

    /// Parameters for a whole scene from its layout and boxes alone.
    pub fn whole_scene() -> Self {
        Self {
            region: RegionMode::Full,
            steps: 20,
            guidance: 1.5,
            named: ChosenDensities {
                completeness: Some(1.0),
                ..ChosenDensities::default()
            },
            ..Self::default()
        }
    }

    /// All parameters as bits: the basis of equality and hashing.
    fn bits(&self) -> Bits {
        // Adding 0 turns -0 into 0.
        let bits = |v: f64| (v + 0.0).to_bits();
        (
            [
                self.steps,
                self.inversion_iterations,
                self.halo_columns,
                self.halo_tokens,
                self.reuse_steps,
                self.fine_steps,
            ],
            [
                self.seed,
                bits(self.guidance),
                bits(self.guidance_rescale),
                bits(self.strength),
            ],
            self.named.values().map(|v| v.map(|v| (v + 0.0).to_bits())),
            (
                self.solver,
                self.region,
                self.inpaint.clone(),
                self.quality,
                self.precision,
                [self.keep_objects, self.local],
            ),
        )
    }

    /// Fails with one line if a value is out of range.
    pub fn check(&self) -> Result<(), GenError> {
        let in_range = |name: &str, value: f64, lo: f64, hi: f64| {
            // Written so that NaN fails too.
            if value >= lo && value <= hi {
                return Ok(());
            }
            Err(GenError::Params(format!(
                "{name} is {value}, expected {lo} to {hi}"
            )))
        };
        in_range("steps", f64::from(self.steps), 1.0, 1000.0)?;
        in_range("guidance", self.guidance, 0.0, 100.0)?;
        in_range("guidance_rescale", self.guidance_rescale, 0.0, 1.0)?;
        in_range("strength", self.strength, 0.0, 1.0)?;
        for (name, value) in ["vegetation", "building", "clutter", "completeness"]
            .iter()
            .zip(self.named.values())
        {
            in_range(name, f64::from(value.unwrap_or(0.0)), 0.0, 1.0)?;
        }
        let iterations = f64::from(self.inversion_iterations);
        in_range("inversion_iterations", iterations, 0.0, 100.0)?;
        in_range("halo_columns", f64::from(self.halo_columns), 0.0, 200.0)?;
        in_range("halo_tokens", f64::from(self.halo_tokens), 0.0, 25.0)?;
        in_range("fine_steps", f64::from(self.fine_steps), 0.0, 100.0)?;
        in_range("reuse_steps", f64::from(self.reuse_steps), 1.0, 100.0)
    }

    /// Notes on values that are in range but outside the measured range, a line each.
    pub fn notes(&self) -> Vec<String> {
        let [low, high] = Self::MEASURED_GUIDANCE;
        let guidance = (!(low..=high).contains(&self.guidance)).then(|| {
            format!(
                "guidance is {}, measured is {low} to {high}: beyond that the networks leave out what the layout asks for, such as \
                 road",
                self.guidance
            )
        });
        guidance.into_iter().collect()
    }

    /// Weight and rescaling of the guidance.
    pub fn guidance(&self) -> Guidance {
        Guidance {
            weight: self.guidance,
            rescale: self.guidance_rescale,
        }
    }
}

impl PartialEq for GenParams {
    fn eq(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }
}

impl Eq for GenParams {}

impl Hash for GenParams {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.bits().hash(state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::hash_map::DefaultHasher;

    #[test]
    fn parameters_are_a_key() {
        let a = GenParams::default();
        let hash = |p: &GenParams| {
            let mut h = DefaultHasher::new();
            p.hash(&mut h);
            h.finish()
        };
        let same = GenParams {
            strength: -0.0,
            ..a.clone()
        };
        assert_eq!((&a, hash(&a)), (&same, hash(&same)));
        let changes: [fn(&mut GenParams); 15] = [
            |p| p.fine_steps = 0,
            |p| p.precision = Precision::Int8,
            |p| p.reuse_steps = 2,
            |p| p.inpaint.set([3, 4], true),
            |p| p.steps = 11,
            |p| p.guidance = 1.0 + f64::EPSILON,
            |p| p.guidance_rescale = 0.7,
            |p| p.seed = 1,
            |p| p.region = RegionMode::Full,
            |p| p.strength = 0.5,
            |p| p.inversion_iterations = 3,
            |p| p.halo_columns = 3,
            |p| p.quality = Quality::Preview,
            |p| p.named.vegetation = Some(0.0),
            |p| p.named.completeness = Some(0.4),
        ];
        for change in changes {
            let mut other = a.clone();
            change(&mut other);
            assert!(other != a && hash(&other) != hash(&a), "{other:?}");
            let text = serde_json::to_string(&other).expect("plain values");
            assert_eq!(
                serde_json::from_str::<GenParams>(&text).expect("round trip"),
                other
            );
        }
        assert_eq!(serde_json::from_str::<GenParams>("{}").expect("all defaults"), a);
        assert!(serde_json::from_str::<GenParams>(r#"{"stepps": 3}"#).is_err());
    }

    #[test]
    fn parameters_out_of_range_are_refused_in_one_line() {
        assert_eq!(GenParams::default().check(), Ok(()));
        let changes: [fn(&mut GenParams); 14] = [
            |p| p.guidance = -0.5,
            |p| p.guidance = 100.5,
            |p| p.fine_steps = 101,
            |p| p.reuse_steps = 0,
            |p| p.halo_tokens = 26,
            |p| p.steps = 0,
            |p| p.steps = 1001,
            |p| p.guidance = f64::NAN,
            |p| p.guidance = f64::INFINITY,
            |p| p.strength = 1.5,
            |p| p.inversion_iterations = 101,
            |p| p.halo_columns = 201,
            |p| p.named.clutter = Some(1.5),
            |p| p.named.building = Some(f32::NAN),
        ];
        for change in changes {
            let mut bad = GenParams::default();
            change(&mut bad);
            let text = bad.check().expect_err("out of range").to_string();
            assert!(
                text.contains(", expected ") && text.lines().count() == 1,
                "{text}"
            );
        }
        let zero = GenParams {
            steps: 0,
            ..GenParams::default()
        };
        let text = zero.check().expect_err("0").to_string();
        assert_eq!(text, "steps is 0, expected 1 to 1000");
    }

    /// Guidance 50 left 2 % of the road, and nobody was told.
    #[test]
    fn what_was_not_measured_is_said() {
        for params in [GenParams::default(), GenParams::whole_scene()] {
            assert!(params.notes().is_empty(), "{params:?}");
        }
        for guidance in [0.0, 0.4, 2.5, 50.0, 100.0] {
            let params = GenParams {
                guidance,
                ..GenParams::default()
            };
            assert_eq!(params.check(), Ok(()));
            let [note] = &params.notes()[..] else {
                panic!("one note for {guidance}");
            };
            let told = format!("guidance is {guidance}, measured is 0.5 to 2: ");
            assert!(note.starts_with(&told) && note.lines().count() == 1, "{note}");
        }
    }
}
