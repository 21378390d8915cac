//! How the user wants learned pictures to be painted: with which weights, and with numbers of their own or the usual ones.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use sensors::painter::{PaintError, PaintModel, PaintOptions, PaintWith, SchedulerKind};

/// A wish; what is none is as usual with the weights.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PaintWish {
    /// Folder of the weights: the program's own kind, or public ones with a `model_index.json`; those that ship if none.
    pub weights: Option<PathBuf>,
    /// Steps from noise to a picture.
    pub steps: Option<usize>,
    /// How strictly the pictures obey what they are told.
    pub guidance: Option<f64>,
    /// Public weights alone: how much of the rendered picture is painted anew.
    pub strength: Option<f64>,
    /// Public weights alone: width of a picture, px.
    pub width_px: Option<usize>,
    /// Public weights alone: what the pictures show, in words.
    pub prompt: String,
    /// Public weights alone: what they do not show, in words.
    pub negative: String,
    /// Public weights alone: how a step is made of what the network says; as their folder has it if none.
    pub scheduler: Option<SchedulerKind>,
}

impl PaintWish {
    /// Steps that can be chosen.
    pub const STEPS: std::ops::RangeInclusive<usize> = 1..=50;
    /// Guidance that can be chosen.
    pub const GUIDANCE: std::ops::RangeInclusive<f64> = 1.0..=15.0;
    /// Shares of the rendered picture that can be painted anew.
    pub const STRENGTH: std::ops::RangeInclusive<f64> = 0.1..=1.0;
    /// Widths that can be chosen, px.
    pub const WIDTH_PX: std::ops::RangeInclusive<usize> = 64..=1024;

    /// True if its weights are public ones.
    pub fn is_public(&self) -> bool {
        self.weights.as_deref().is_some_and(PaintModel::is_public)
    }

    /// What is usual with its weights.
    pub fn usual(&self) -> PaintOptions {
        match self.is_public() {
            true => PaintOptions::public(),
            false => PaintOptions::default(),
        }
    }

    /// Its numbers, within what networks take, whatever a file said; for the rest what is usual.
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

    /// Opens its weights. Errors in one line if they are missing, damaged or foreign.
    pub fn open(&self) -> Result<PaintWith, PaintError> {
        Ok(self.with(self.model()?))
    }

    /// Its weights alone. Errors as [`PaintWish::open`].
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

    /// Its numbers and words, with weights that are open already.
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
