//! `sceneloom render`: what the sensors see, as pictures and as data.

mod arguments;
mod plan;
mod truth;
mod write;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use serde_json::json;

use super::{Common, Moment, Outcome, output};
use app::camera_views::camera_input;
use app::graphics::Graphics;
use app::{open, picture};
use formats::recipe::Recipe;
use scene::{CameraMaps, LidarSweep, Scene, TimeOfDay, Weather};
use sensors::appearance::Quality;
use sensors::cameras::{CameraInput, Card, Detail, Ready, RenderOptions, SourceId};
use sensors::rolling;
use sensors::splat::{self, GaussianCloud, SplatOptions};

pub use arguments::{size, source};
use plan::{Cameras, Plan};
use write::Writer;

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
    /// What classes and depths are rendered from: Gaussians, exact rays to the voxels, those with boxes as shapes, or the
    /// very surfaces of the pictures.
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
    /// How the LiDAR sweep comes about.
    #[arg(long, value_name = "MODEL", value_parser = ["exact", "learned"], default_value = "exact")]
    lidar: String,
    /// Folder to write into.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    moment: Moment,
    #[command(flatten)]
    common: Common,
}

/// The six cameras' maps and the LiDAR sweep of a scene.
pub fn sense(scene: &Scene, [width, height]: [u32; 2]) -> (Vec<CameraMaps>, LidarSweep) {
    let scene = &*scene.with_rig_in_world();
    let frame = scene.frame();
    let sweep = rolling::exact(scene);
    let cloud = GaussianCloud::from_grid(&frame.occupancy, frame.layout.cells());
    let maps = splat::render_rig(&cloud, &scene.rig, width, height, &SplatOptions::default());
    (maps, sweep)
}

/// Seconds that each part took, by its name in the report.
type Times = BTreeMap<&'static str, f64>;

impl Render {
    /// The scene as camera sources take it, under the weather and time that were asked for.
    fn input<'a>(&self, scene: &'a Scene) -> CameraInput<'a> {
        let own = scene.conditions;
        let timed = self.time.map_or(own, |time| own.at(time));
        CameraInput {
            conditions: self.weather.map_or(timed, |weather| timed.under(weather)),
            ..camera_input(scene, Detail::Full)
        }
    }

    /// How the pictures come to be: under the weather and time that were asked for.
    fn recipe(&self, scene: &Scene) -> Recipe {
        Recipe {
            conditions: self.input(scene).conditions,
            ..Recipe::of(scene)
        }
    }

    /// Renders and writes the pictures of one source, a few cameras at a time if they are small, else one.
    fn cameras(
        &self,
        scene: &Scene,
        cameras: &Cameras,
        (writer, wall_s): (&mut Writer, &mut Times),
    ) -> anyhow::Result<()> {
        let mut time_s = 0.0;
        let start = Instant::now();
        let ready = Ready::new(cameras.source, &self.input(scene));
        // The same bytes on every machine, unless a card is asked for.
        let mut card = Graphics::forced();
        let on_card = ready.upload_to(|| card.as_mut().map(|card| card as &mut dyn Card));
        time_s += start.elapsed().as_secs_f64();
        let options = RenderOptions {
            size: self.size,
            quality: if self.preview {
                Quality::Preview
            } else {
                Quality::Full
            },
        };
        let all = &scene.rig.cameras;
        let mut place = 0;
        for group in all.chunks(ready.side_by_side(&options)) {
            let start = Instant::now();
            let card = card.as_mut().filter(|_| on_card);
            let pictures = ready.render_all(group, &options, card.map(|card| card as &mut dyn Card))?;
            time_s += start.elapsed().as_secs_f64();
            for picture in pictures {
                writer.camera(picture, &cameras.views, (place, all.len()))?;
                place += 1;
            }
        }
        writer.finish_sheet(&cameras.views)?;
        *wall_s.entry(cameras.source.report_key()).or_default() += time_s;
        Ok(())
    }

    pub(super) fn run(self) -> Outcome {
        arguments::check_what(&self.what)?;
        let mut scene = self.moment.of(open::scene(&self.scene)?)?;
        if let Some(path) = &self.rig {
            scene.rig = open::rig(path)?.into();
        }
        let of_file = scene.clone();
        let scene = scene.with_rig_in_world().into_owned();
        // Whatever cannot be had is told before anything is written.
        let plan = Plan::new(&self, &scene)?;
        let mut writer = Writer::new(&self.output, self.recipe(&of_file))?;
        let mut wall_s = Times::new();
        let mut lidar_report = serde_json::Value::Null;
        let frame = scene.frame();
        for cameras in &plan.cameras {
            self.cameras(&scene, cameras, (&mut writer, &mut wall_s))?;
        }
        if plan.truth {
            let time_s = self.truth(&scene, &mut writer)?;
            wall_s.insert("truth", time_s);
        }
        if plan.truth || !plan.cameras.is_empty() || plan.lidar.is_some() {
            writer.calibration(&of_file, &frame.world_from_ego, self.size)?;
        }
        if let Some(model) = &plan.lidar {
            let start = Instant::now();
            let sweep = model.sweep(&scene)?;
            wall_s.insert("lidar", start.elapsed().as_secs_f64());
            let returns = sweep.points.len();
            lidar_report = json!({ "rays": sweep.rays, "returns": returns, "dropped": sweep.rays - returns });
            writer.lidar(frame.extent(), &sweep)?;
        }
        if plan.bev {
            let start = Instant::now();
            writer.picture("bev.png", &picture::layout_top(frame, 4))?;
            writer.picture("occupancy_top.png", &picture::occupancy_top(&frame.occupancy, 4))?;
            wall_s.insert("bev", start.elapsed().as_secs_f64());
        }
        if let Some(mut view) = plan.view {
            let start = Instant::now();
            let shot = view.shot(&scene, &Default::default())?;
            writer.picture("view.png", &shot)?;
            wall_s.insert("view", start.elapsed().as_secs_f64());
        }
        let files = writer.files;
        let peak = output::peak_rss_mb();
        let report = json!({ "files": files, "wall_s": wall_s, "lidar": lidar_report, "peak_rss_mb": peak });
        output::report(&self.common, &report, || {
            files
                .iter()
                .map(|f| f.display().to_string())
                .collect::<Vec<_>>()
                .join("\n")
        });
        Ok(())
    }
}
