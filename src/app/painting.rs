//! Settings for painting learned pictures: the weights, and numbers set by the user or the defaults.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use sensors::pictures::painter::{PaintError, PaintModel, PaintOptions, PaintWith, SchedulerKind};

/// The user's settings. A value of `None` stands for the default of the weights.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PaintWish {
    /// Folder of the weights: the program's own format, or public weights with a `model_index.json`; the bundled
    /// weights if `None`.
    pub weights: Option<PathBuf>,
    /// Steps from noise to a picture.
    pub steps: Option<usize>,
    /// Guidance: how strictly the pictures follow the condition.
    pub guidance: Option<f64>,
    /// Public weights only: the share of the rendered picture that is painted anew.
    pub strength: Option<f64>,
    /// Public weights only: width of a picture, px.
    pub width_px: Option<usize>,
    /// Public weights only: prompt.
    pub prompt: String,
    /// Public weights only: negative prompt.
    pub negative: String,
    /// Public weights only: the scheduler; the one that their folder names if `None`.
    pub scheduler: Option<SchedulerKind>,
}

impl PaintWish {
    /// Range of the number of steps.
    pub const STEPS: std::ops::RangeInclusive<usize> = 1..=50;
    /// Range of the guidance.
    pub const GUIDANCE: std::ops::RangeInclusive<f64> = 1.0..=15.0;
    /// Range of the strength.
    pub const STRENGTH: std::ops::RangeInclusive<f64> = 0.1..=1.0;
    /// Range of the width, px.
    pub const WIDTH_PX: std::ops::RangeInclusive<usize> = 64..=1024;

    /// True if the weights are public ones.
    pub fn is_public(&self) -> bool {
        self.weights.as_deref().is_some_and(PaintModel::is_public)
    }

    /// The default options of the weights.
    pub fn usual(&self) -> PaintOptions {
        match self.is_public() {
            true => PaintOptions::public(),
            false => PaintOptions::default(),
        }
    }

    /// The options: the numbers set by the user, clamped to what the networks take whatever a file says, else the
    /// defaults.
    pub fn options(&self) -> PaintOptions {
        let usual = self.usual();
        let within = |value: Option<f64>, range: std::ops::RangeInclusive<f64>, usual: f64| match value {
            Some(value) if value.is_finite() => value.clamp(*range.start(), *range.end()),
            _ => usual,
        };
        let whole = |value: Option<usize>, range: std::ops::RangeInclusive<usize>, usual: usize| {
            value.unwrap_or(usual).clamp(*range.start(), *range.end())
        };
        PaintOptions {
            steps: whole(self.steps, Self::STEPS, usual.steps),
            guidance: within(self.guidance, Self::GUIDANCE, usual.guidance),
            strength: within(self.strength, Self::STRENGTH, usual.strength),
            width_px: whole(self.width_px, Self::WIDTH_PX, usual.width_px),
            prompt: self.prompt.clone(),
            negative: self.negative.clone(),
            scheduler: self.scheduler,
            ..usual
        }
    }

    /// Opens the weights and takes the options. Errors in one line if the weights are missing, damaged or foreign.
    pub fn open(&self) -> Result<PaintWith, PaintError> {
        Ok(self.with(self.model()?))
    }

    /// Opens the weights only. Errors as [`PaintWish::open`].
    pub fn model(&self) -> Result<PaintModel, PaintError> {
        let model = match &self.weights {
            Some(folder) => PaintModel::open(folder)?,
            None => PaintModel::bundled()?,
        };
        if let Some(reason) = model.without_card() {
            tracing::warn!("pictures are painted on the processor: {reason}");
        }
        Ok(model)
    }

    /// The options together with weights that are open already.
    pub fn with(&self, model: PaintModel) -> PaintWith {
        PaintWith {
            model,
            options: self.options(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wild_numbers_become_usual_ones() {
        let wish = PaintWish {
            steps: Some(100_000),
            guidance: Some(f64::NAN),
            strength: Some(-3.0),
            width_px: Some(0),
            ..PaintWish::default()
        };
        let options = wish.options();
        assert_eq!(
            (options.steps, options.guidance),
            (50, PaintOptions::default().guidance)
        );
        assert_eq!((options.strength, options.width_px), (0.1, 64));
        let missing = PaintWish {
            weights: Some("no such folder".into()),
            ..PaintWish::default()
        };
        let error = missing.open().expect_err("no weights").to_string();
        assert!(
            error.contains("no such folder") && !error.contains('\n'),
            "{error}"
        );
    }
}
