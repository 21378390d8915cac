//! Arguments for learned pictures: with which weights, and how.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::bail;
use app::painting::PaintWish;
use sensors::pictures::painter::{PaintWith, SchedulerKind};

/// How learned pictures are painted.
#[derive(clap::Args, Clone, Debug, Default, PartialEq)]
pub(super) struct Painting {
    /// Folder of weights that paint learned pictures instead of the bundled ones: of the same training, or public ones with
    /// model_index.json.
    #[arg(long, value_name = "DIR")]
    weights: Option<PathBuf>,
    /// Content of learned pictures, in words, for public weights; time, weather and camera are added.
    #[arg(long = "paint-prompt", value_name = "WORDS")]
    prompt: Option<String>,
    /// Content that they must not show, in words.
    #[arg(long = "paint-negative", value_name = "WORDS")]
    negative: Option<String>,
    /// How public weights make a step: ddim, pndm, dpmpp2m, euler or unipc [default: as their folder has it].
    #[arg(long = "paint-scheduler", value_name = "NAME", value_parser = scheduler)]
    scheduler: Option<SchedulerKind>,
    /// How much of the rendered picture public weights paint anew, 0.1 to 1 [default: 0.6].
    #[arg(long = "paint-strength", value_name = "S", value_parser = within(PaintWish::STRENGTH))]
    strength: Option<f64>,
    /// Steps from noise to a learned picture, 1 to 50 [default: 4, public weights: 20].
    #[arg(long = "paint-steps", value_name = "N", value_parser = within(PaintWish::STEPS))]
    steps: Option<usize>,
    /// How strictly learned pictures obey what they are told, 1 to 15 [default: 2, public weights: 7.5].
    #[arg(long = "paint-guidance", value_name = "W", value_parser = within(PaintWish::GUIDANCE))]
    guidance: Option<f64>,
    /// Width of pictures by public weights, 64 to 1024 px [default: 512].
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
    /// Errors if they are given though nothing is painted.
    pub fn is_for(&self, paints: bool, what: &str) -> anyhow::Result<()> {
        if !paints && *self != Self::default() {
            bail!("--weights and --paint-… are of learned pictures alone, but --what is {what}");
        }
        Ok(())
    }

    /// The networks that the arguments ask for. Errors in one line if they are missing, damaged or foreign, or if they
    /// are of the program's own kind and get options of public ones.
    pub fn open(&self) -> anyhow::Result<PaintWith> {
        let wish = self.wish();
        let with = wish.open()?;
        if let (false, Some(name)) = (wish.is_public(), self.public()) {
            bail!("{name} is of public weights alone: a folder with model_index.json");
        }
        if let Some(reason) = with.model.without_card() {
            eprintln!("sceneloom: pictures are painted on the processor: {reason}");
        }
        Ok(with)
    }

    /// An option that is given and that public weights alone take.
    fn public(&self) -> Option<&'static str> {
        let given = [
            ("--paint-prompt", self.prompt.is_some()),
            ("--paint-negative", self.negative.is_some()),
            ("--paint-scheduler", self.scheduler.is_some()),
            ("--paint-strength", self.strength.is_some()),
            ("--paint-width", self.width.is_some()),
        ];
        given.into_iter().find_map(|(name, given)| given.then_some(name))
    }

    /// The options that the arguments ask for.
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
