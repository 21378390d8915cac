//! Arguments for learned pictures: with which weights, and how.

use std::path::PathBuf;

use app::painting::PaintWish;

/// How learned pictures are painted.
#[derive(clap::Args, Clone, Debug, Default)]
pub(super) struct Painting {
    /// Folder of weights that paint learned pictures instead of the bundled ones: of the same training, or public ones with
    /// model_index.json.
    #[arg(long, value_name = "DIR")]
    weights: Option<PathBuf>,
    /// What learned pictures show, in words, for public weights; time, weather and
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
    /// What the arguments ask for.
    pub fn wish(&self) -> PaintWish {
        PaintWish {
            weights: self.weights.clone(),
            steps: self.steps,
            guidance: self.guidance,
            strength: self.strength,
            width_px: self.width,
            prompt: self.prompt.clone().unwrap_or_default(),
        }
    }
}
