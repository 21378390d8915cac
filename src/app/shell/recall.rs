//! What a result was made with: the seed and the knobs. It is kept with the version that the result is, told in pictures and
//! exports of that state, and can be used again.

use serde::{Deserialize, Serialize};

use super::app::SceneloomApp;
use super::toasts::Level;
use job::inpaint::InpaintMask;
use job::{GenParams, Named, RegionMode};
use language::{t, tf};
use scene::SceneRev;

/// How a result was made.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MadeWith {
    /// Name of the preset; empty for settings of one's own.
    pub preset: String,
    /// The knobs. Where it was to change is left out: that belongs to the scene.
    pub params: GenParams,
}

impl MadeWith {
    /// Of the parameters of a job.
    pub fn new(params: &GenParams, preset: Option<&str>) -> Self {
        Self {
            preset: preset.unwrap_or_default().to_owned(),
            params: GenParams {
                inpaint: InpaintMask::default(),
                ..params.clone()
            },
        }
    }

    /// As text on one line.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// From such a text; none if it is of another program or damaged.
    pub fn from_json(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    /// The knobs that one sets, for a person: seed, preset, steps, guidance, densities.
    pub fn in_words(&self) -> String {
        let params = &self.params;
        let mut parts = vec![tf!("seed {n}", n = params.seed)];
        if !self.preset.is_empty() {
            parts.push(t(&self.preset).to_owned());
        }
        parts.push(tf!("{n} steps", n = params.steps));
        if params.guidance != 1.0 {
            parts.push(tf!("guidance {n}", n = params.guidance));
        }
        if params.strength > 0.0 {
            parts.push(tf!("strength {n}", n = params.strength));
        }
        let names = [t("Vegetation"), t("Buildings"), t("Clutter"), t("Completeness")];
        let named = names.into_iter().zip(params.named.values());
        parts.extend(named.filter_map(|(name, value)| Some(format!("{name} {:.2}", value?))));
        parts.join(", ")
    }
}

/// The seed that generation is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeedWish {
    /// The seed; that of the scene if none.
    pub value: Option<u64>,
    /// Another one each time that something is generated on request.
    pub another: bool,
}

impl SeedWish {
    /// Largest seed that is drawn.
    pub const MOST: u64 = 999_999;

    /// The seed for this scene.
    pub fn of(&self, scene_seed: u64) -> u64 {
        self.value.unwrap_or(scene_seed)
    }

    /// Draws another seed.
    pub fn roll(&mut self) {
        let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let nanos = since.map_or(1, |d| d.as_nanos() as u64);
        // (clocks that tick slowly give the same twice)
        let mixed = nanos.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29) % Self::MOST;
        self.value = match self.value == Some(mixed) {
            true => Some(mixed + 1),
            false => Some(mixed),
        };
    }
}

impl SceneloomApp {
    /// How a job with these parameters makes its result.
    pub(crate) fn made_with(&self, params: &GenParams) -> MadeWith {
        let tuning = &self.generation.tuning;
        let preset = tuning.current(params).and_then(|i| tuning.presets.all.get(i));
        MadeWith::new(params, preset.map(|p| p.name.as_str()))
    }

    /// What is known of how the present state was made, for files that tell; null if nothing is.
    pub(crate) fn parameters(&self) -> serde_json::Value {
        let made = self
            .generation
            .versions
            .made(self.document.settled_scene().content());
        made.and_then(|made| serde_json::to_value(made).ok())
            .unwrap_or_default()
    }

    /// Sets the knobs to those of a version.
    pub(crate) fn use_again(&mut self, rev: SceneRev) {
        let Some(made) = self.generation.versions.made(rev).cloned() else {
            return;
        };
        let params = GenParams {
            named: Named::default(),
            strength: 0.0,
            ..made.params.clone()
        };
        match made.params.region {
            RegionMode::Full => self.generation.live.full_params = params,
            RegionMode::Auto => {
                self.generation.live.params = params;
                self.preferences.settings.quality.clone_from(&made.preset);
                // The source's trajectory belongs to its settings.
                self.generation.live.source_changed();
            }
        }
        if made.params.strength > 0.0 {
            self.state.tools.region_strength = made.params.strength;
        }
        self.state.named = made.params.named;
        self.state.seed = SeedWish {
            value: Some(made.params.seed),
            another: false,
        };
        let text = tf!("Set: {what}", what = made.in_words());
        let now_s = self.now_s();
        self.toasts.push(Level::Info, text, now_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_result_was_made_with_comes_back_from_text() {
        let params = GenParams {
            seed: u64::MAX,
            steps: 7,
            guidance: 2.5,
            named: Named {
                vegetation: Some(0.25),
                ..Named::default()
            },
            ..GenParams::default()
        };
        let made = MadeWith::new(&params, Some("fast"));
        let text = made.to_json();
        assert!(!text.contains('\n'), "{text}");
        let back = MadeWith::from_json(&text).expect("as written");
        assert_eq!((&back.params, back.preset.as_str()), (&params, "fast"));
        let words = back.in_words();
        for part in ["seed 18446744073709551615", "7 steps", "guidance 2.5", "Vegetation 0.25"] {
            assert!(words.contains(part), "{words}");
        }
        assert!(MadeWith::from_json("{\"preset\":\"\",\"params\":{\"of_tomorrow\":1}}").is_none());
    }

    #[test]
    fn a_seed_is_the_scenes_own_until_one_is_wanted() {
        let mut seed = SeedWish::default();
        assert_eq!(seed.of(5), 5);
        let mut drawn = std::collections::BTreeSet::new();
        for _ in 0..20 {
            let before = seed.value;
            seed.roll();
            assert_ne!(seed.value, before);
            drawn.insert(seed.of(5));
        }
        assert!(drawn.len() > 2 && drawn.iter().all(|n| *n <= SeedWish::MOST), "{drawn:?}");
    }
}
