//! Arguments for learned pictures: with which weights, and how.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use app::painting::PaintWish;
use sensors::painter::{PaintWith, SchedulerKind};

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
    /// What they do not show, in words.
    #[arg(long = "paint-negative", value_name = "WORDS")]
    negative: Option<String>,
    /// How public weights make a step: ddim, pndm, dpmpp2m, euler or unipc [default: as their folder has it].
    #[arg(long = "paint-scheduler", value_name = "NAME", value_parser = scheduler)]
    scheduler: Option<SchedulerKind>,
    /// How much of the rendered picture public weights paint anew, 0.1 to 1.
    #[arg(long = "paint-strength", value_name = "S", value_parser = within(PaintWish::STRENGTH))]
    strength: Option<f64>,
    /// Steps from noise to a learned picture.
    #[arg(long = "paint-steps", value_name = "N", value_parser = within(PaintWish::STEPS))]
    steps: Option<usize>,
    /// How strictly learned pictures obey what they are told.
    #[arg(long = "paint-guidance", value_name = "W", value_parser = within(PaintWish::GUIDANCE))]
    guidance: Option<f64>,
    /// Width of pictures by public weights, px.
    #[arg(long = "paint-width", value_name = "PX", value_parser = within(PaintWish::WIDTH_PX))]
    width: Option<usize>,
}

/// Reads numbers of a range.
fn within<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Send + Sync + Clone + 'static,
{
    move |text| {
        let number = text.parse().ok().filter(|n| range.contains(n));
        number.ok_or_else(|| format!("expected {} to {}", range.start(), range.end()))
    }
}

/// Reads the name of a scheduler.
fn scheduler(name: &str) -> Result<SchedulerKind, String> {
    let mut all = SchedulerKind::ALL.into_iter();
    let names = SchedulerKind::ALL.map(SchedulerKind::name);
    all.find(|kind| kind.name() == name)
        .ok_or_else(|| format!("expected {}", names.join(", ")))
}

impl Painting {
    /// The networks that the arguments ask for. Errors in one line if they are missing, damaged or foreign.
    pub fn open(&self) -> anyhow::Result<PaintWith> {
        let with = self.wish().open()?;
        if let Some(reason) = with.model.without_card() {
            eprintln!("sceneloom: pictures are painted on the processor: {reason}");
        }
        Ok(with)
    }

    /// What the arguments ask for.
    fn wish(&self) -> PaintWish {
        PaintWish {
            weights: self.weights.clone(),
            steps: self.steps,
            guidance: self.guidance,
            strength: self.strength,
            width_px: self.width,
            prompt: self.prompt.clone().unwrap_or_default(),
            negative: self.negative.clone().unwrap_or_default(),
            scheduler: self.scheduler,
        }
    }
}
