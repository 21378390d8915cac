//! The settings that a version was made with: written into files, and used again.

use super::app::SceneloomApp;
use super::made_with::MadeWith;
use super::toasts::MessageLevel;
use crate::seed_wish::SeedWish;
use job::{ChosenDensities, GenParams, RegionMode};
use language::tf;
use scene::SceneRev;

impl SceneloomApp {
    /// The settings of a job with these parameters.
    pub(crate) fn made_with(&self, params: &GenParams) -> MadeWith {
        let tuning = &self.generation.tuning;
        let preset = tuning.current(params).and_then(|i| tuning.presets.all.get(i));
        MadeWith::new(params, preset.map(|p| p.name.as_str()))
    }

    /// The settings that made the present state, for files that carry them; null if unknown.
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
        if let Some(made) = self.generation.versions.made(rev).cloned() {
            self.take_knobs(&made);
        }
    }

    /// Sets the knobs to those that a result was made with.
    pub(crate) fn take_knobs(&mut self, made: &MadeWith) {
        let params = GenParams {
            named: ChosenDensities::default(),
            strength: 0.0,
            ..made.params.clone()
        };
        match made.params.region {
            RegionMode::Full => {
                self.generation.live.full_params = params;
                // The quality of a whole generation is also set for edits.
                if let Some(preset) = self.generation.tuning.presets.index_named(&made.preset) {
                    self.set_quality(preset);
                }
            }
            RegionMode::Auto => {
                self.generation.live.params = params;
                self.preferences.settings.quality.clone_from(&made.preset);
                // The source's trajectory was made with the old settings.
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
        self.toasts.push(MessageLevel::Info, text, now_s);
    }
}
