//! Seed and knobs that a result was made with. They are kept with the version, written into pictures and exports of
//! that state, and can be used again.

use serde::{Deserialize, Serialize};

use job::GenParams;
use job::inpaint::InpaintMask;
use language::{t, tf};

/// Settings that a result was made with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MadeWith {
    /// Name of the preset; empty for custom settings.
    pub preset: String,
    /// The knobs, without the inpainted region, which belongs to the scene.
    pub params: GenParams,
}

impl MadeWith {
    /// The settings of a job's parameters.
    pub fn new(params: &GenParams, preset: Option<&str>) -> Self {
        Self {
            preset: preset.unwrap_or_default().to_owned(),
            params: GenParams {
                inpaint: InpaintMask::default(),
                ..params.clone()
            },
        }
    }

    /// The settings as JSON on one line.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Parses such a text; `None` if it is invalid.
    pub fn from_json(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    /// The knobs that a user sets, in words: seed, preset, steps, guidance, densities.
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

#[cfg(test)]
mod tests {
    use super::*;
    use job::ChosenDensities;

    #[test]
    fn what_a_result_was_made_with_comes_back_from_text() {
        let params = GenParams {
            seed: u64::MAX,
            steps: 7,
            guidance: 2.5,
            named: ChosenDensities {
                vegetation: Some(0.25),
                ..ChosenDensities::default()
            },
            ..GenParams::default()
        };
        let made = MadeWith::new(&params, Some("fast"));
        let text = made.to_json();
        assert!(!text.contains('\n'), "{text}");
        let back = MadeWith::from_json(&text).expect("as written");
        assert_eq!((&back.params, back.preset.as_str()), (&params, "fast"));
        let words = back.in_words();
        for part in [
            "seed 18446744073709551615",
            "7 steps",
            "guidance 2.5",
            "Vegetation 0.25",
        ] {
            assert!(words.contains(part), "{words}");
        }
        assert!(MadeWith::from_json("{\"preset\":\"\",\"params\":{\"of_tomorrow\":1}}").is_none());
    }
}
