//! `sceneloom scenery`: the scenery beside the roads, regenerated.

use std::path::PathBuf;

use anyhow::bail;
use serde_json::json;

use super::document;
use super::region_arg::RegionArg;
use super::{CommandResult, Common, output};
use app::open;
use app::scenery::{SceneryMethod, SceneryWish};
use job::inpaint::InpaintMask;
use world::scenery::RoadsideKind;

/// Generator of scenery.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum By {
    Rules,
    Network,
}

/// Arguments.
#[derive(clap::Args)]
pub struct Scenery {
    /// Scene to read.
    scene: PathBuf,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom")]
    output: PathBuf,
    /// Generator of the scenery: rules for a kind of place, or a network.
    #[arg(long, value_enum, default_value_t = By::Rules)]
    by: By,
    /// Kind of place that the rules draw; one that suits the road if left out.
    #[arg(long, value_enum, value_name = "NAME")]
    setting: Option<RoadsideKind>,
    /// Number of plants, 1 = usual there; 0 is none.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    green: f64,
    /// Number of buildings, 1 = usual there; 0 is none.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    built: f64,
    /// Rectangle X0,Y0,X1,Y1 of the ego frame in metres outside of which nothing changes; everywhere if left out.
    #[arg(long, value_name = "RECT", allow_hyphen_values = true)]
    region: Option<RegionArg>,
    /// Fixes every random draw.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

impl Scenery {
    /// The wish that the arguments ask for; errors if a number is out of range.
    fn wish(&self) -> anyhow::Result<SceneryWish> {
        for (name, value) in [("--green", self.green), ("--built", self.built)] {
            if !(0.0..=4.0).contains(&value) {
                bail!("{name} is {value}, expected 0 to 4");
            }
        }
        let region = match &self.region {
            None | Some(RegionArg::Full) => InpaintMask::default(),
            Some(RegionArg::Rect(mask)) => mask.clone(),
            Some(RegionArg::Auto) => bail!("--region is auto, expected full or four numbers X0,Y0,X1,Y1"),
        };
        let by = match (self.by, self.setting) {
            (By::Rules, setting) => SceneryMethod::Rules(setting),
            (By::Network, None) => SceneryMethod::Network,
            (By::Network, Some(_)) => {
                bail!("--setting is for rules, the network chooses what suits the road")
            }
        };
        Ok(SceneryWish {
            seed: self.seed,
            by,
            green: self.green,
            built: self.built,
            region,
        })
    }

    pub(super) fn run(self) -> CommandResult {
        let wish = self.wish()?;
        let scene = open::scene(&self.scene)?;
        let before = scene.frame().occupancy.clone();
        let edits = wish.edits(&scene)?;
        let mut document = document::opened(scene);
        document.apply_all("Draw scenery", &edits)?;
        document::save(&self.output, &document)?;
        let scene = document.scene();
        let (things, changed) = (
            scene.background.len(),
            before.count_different(&scene.frame().occupancy),
        );
        let locked = &scene.arranged.locked.things;
        let kept = scene
            .background
            .iter()
            .filter(|t| t.placed || locked.contains(&t.id))
            .count();
        let report = json!({
            "things": things,
            "things_kept": kept,
            "voxels_changed": changed,
            "seed": self.seed,
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            format!(
                "{}: {things} things beside the road, {kept} of them placed or locked and kept, {changed} voxels changed",
                self.output.display()
            )
        });
        Ok(())
    }
}
