//! `sceneloom render`: the sensors' view of a scene, as pictures and as data.

mod arguments;

use std::path::PathBuf;

use serde_json::json;

use super::painting::Painting;
use super::progress::{ProgressLine, in_words};
use super::{CommandResult, Common, Moment, output};
use app::camera_views::LidarModel;
use app::open;
use assist::render::{RenderProgress, Rendering, check_what};
use scene::{CameraMaps, LidarSweep, Scene, TimeOfDay, Weather};
use sensors::cameras::{SourceId, learned};
use sensors::lidar::recorded;
use sensors::splat::{self, GaussianCloud, SplatOptions};

pub use arguments::{size, source};

/// Arguments.
#[derive(clap::Args)]
pub struct Render {
    /// Scene to read.
    scene: PathBuf,
    #[arg(long, value_delimiter = ',', value_name = "LIST", help = arguments::what_help())]
    what: Vec<String>,
    /// JSON file with another sensor rig (as in assets/rigs).
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Size of camera pictures in pixels.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "800x450")]
    size: [u32; 2],
    /// Source that classes and depths are rendered from: Gaussians, exact rays to the voxels, those with boxes as
    /// shapes, or the very surfaces of the pictures.
    #[arg(long, value_name = "NAME", value_parser = source(), default_value = "truth")]
    source: SourceId,
    /// Weather of appearance: clear, overcast, rain, snow, fog, sandstorm; else the scene's.
    #[arg(long, value_name = "NAME")]
    weather: Option<Weather>,
    /// Time of day of appearance: dawn, day, dusk, night; else the scene's.
    #[arg(long, value_name = "NAME")]
    time: Option<TimeOfDay>,
    /// One sample per pixel for appearance: several times faster, rougher edges.
    #[arg(long)]
    preview: bool,
    /// How the LiDAR sweep comes about; recorded is exact for a scene that was not imported from a sweep.
    #[arg(long, value_name = "MODEL", value_parser = ["recorded", "exact", "learned"], default_value = "recorded")]
    lidar: String,
    /// Folder to write into.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    painting: Painting,
    #[command(flatten)]
    moment: Moment,
    #[command(flatten)]
    common: Common,
}

/// Renderings that take longer than this are announced beforehand, s.
const LONG_S: f64 = 20.0;

/// The six cameras' maps and the LiDAR sweep of a scene.
pub fn sense(scene: &Scene, [width, height]: [u32; 2]) -> (Vec<CameraMaps>, LidarSweep) {
    let scene = &*scene.for_sensors();
    let frame = scene.frame();
    let sweep = recorded::sweep_or_exact(scene);
    let cloud = GaussianCloud::from_grid(&frame.occupancy, frame.layout.cells());
    let maps = splat::render_rig(&cloud, &scene.rig, width, height, &SplatOptions::default());
    (maps, sweep)
}

impl Render {
    pub(super) fn run(self) -> CommandResult {
        check_what(&self.what, "--what")?;
        let mut scene = self.moment.apply_to(open::scene(&self.scene)?)?;
        if let Some(path) = &self.rig {
            scene.rig = open::rig(path)?.into();
        }
        let paints = self.what.iter().any(|w| w == learned::VIEW.id.name());
        self.painting.is_for(paints, &self.what.join(","))?;
        let paint = paints.then(|| self.painting.open()).transpose()?;
        let rendering = Rendering {
            what: self.what,
            size: self.size,
            source: self.source,
            weather: self.weather,
            time: self.time,
            preview: self.preview,
            lidar: match self.lidar.as_str() {
                "learned" => LidarModel::Learned,
                "exact" => LidarModel::Exact,
                _ => LidarModel::Recorded,
            },
            paint,
        };
        let progress = ProgressLine::new(&self.common);
        let made = rendering.write(&scene, &self.output, &mut |told| {
            match told {
                RenderProgress::Takes { pixels, seconds } if seconds >= LONG_S => eprintln!(
                    "sceneloom: {} million pixels will take about {} on this machine",
                    pixels / 1_000_000,
                    in_words(seconds)
                ),
                RenderProgress::Takes { .. } => {}
                RenderProgress::Made { pictures, of } => progress.at("pictures", pictures, of),
            }
            Ok(())
        })?;
        progress.done();
        let of_lidar = |[rays, returns]: [usize; 2]| json!({ "rays": rays, "returns": returns, "dropped": rays - returns });
        let report = json!({
            "files": made.files,
            "wall_s": made.wall_s,
            "lidar": made.lidar.map(of_lidar),
            "radar": made.radar.map(|returns| json!({ "returns": returns })),
            "peak_rss_mb": output::peak_rss_mb(),
        });
        output::report(&self.common, &report, || {
            made.files
                .iter()
                .map(|f| f.display().to_string())
                .collect::<Vec<_>>()
                .join("\n")
        });
        Ok(())
    }
}
