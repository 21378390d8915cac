//! Arguments for learned pictures: with which weights, and how.

use app::painting::PaintWish;

/// How learned pictures are painted.
#[derive(clap::Args, Clone, Debug, Default)]
pub(super) struct Painting {
    /// What learned pictures show, in words, for public weights (a folder with model_index.json as --weights); time, weather and
    /// camera are added.
    #[arg(long = "paint-prompt", value_name = "WORDS")]
    prompt: Option<String>,
    /// How much of the rendered picture public weights paint anew, 0 to 1.
    #[arg(long = "paint-strength", value_name = "S")]
    strength: Option<f64>,
    /// Steps from noise to a learned picture.
    #[arg(long = "paint-steps", value_name = "N")]
    steps: Option<usize>,
    /// How strictly learned pictures obey what they are told.
    #[arg(long = "paint-guidance", value_name = "W")]
    guidance: Option<f64>,
    /// Width of pictures by public weights, px.
    #[arg(long = "paint-width", value_name = "PX")]
    width: Option<usize>,
}

impl Painting {
    /// With the weights of a folder, or those that ship.
    pub fn wish(&self, weights: Option<&std::path::Path>) -> PaintWish {
        PaintWish {
            weights: weights.map(Into::into),
            steps: self.steps,
            guidance: self.guidance,
            strength: self.strength,
            width_px: self.width,
            prompt: self.prompt.clone().unwrap_or_default(),
        }
    }
}
