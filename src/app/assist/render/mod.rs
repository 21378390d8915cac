//! Pictures and data of the sensors, as files of a folder: shared by `sceneloom render` and the call `render`.

mod forecast;
mod plan;
mod truth;
mod write;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::bail;

use app::camera_views::{self, camera_input};
use app::graphics::Graphics;
use app::picture::{self, RgbaPicture};
use formats::recipe::Recipe;
use scene::{Scene, TimeOfDay, Weather};
use sensors::cameras::{self, CameraInput, Card, Detail, PreparedSource, RenderOptions, SourceId};
use sensors::pictures::appearance::Quality;
use sensors::pictures::painter::PaintWith;
use sensors::radar;

pub use forecast::{Listen, RenderProgress};
use plan::{Cameras, RenderPlan};
use write::Writer;

/// Kinds of output besides the views of cameras.
const OTHERS: [&str; 5] = ["truth", "lidar", "radar", "bev", "view"];

/// Options of a rendering.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Names from [`kinds`].
    pub what: Vec<String>,
    /// Size of camera pictures in pixels.
    pub size: [u32; 2],
    /// Source that classes and depths are rendered from.
    pub source: SourceId,
    /// Weather of pictures; `None` for the scene's.
    pub weather: Option<Weather>,
    /// Time of day of pictures; `None` for the scene's.
    pub time: Option<TimeOfDay>,
    /// One sample per pixel for pictures.
    pub preview: bool,
    /// How the LiDAR sweep comes about.
    pub lidar: camera_views::LidarModel,
    /// Network that paints learned pictures; `None` for the bundled weights.
    pub paint: Option<PaintWith>,
}

/// Result of a rendering.
#[derive(Debug, Default)]
pub struct RenderedFiles {
    /// The files, in the order in which they were written.
    pub files: Vec<PathBuf>,
    /// Seconds that each part took, by its name in the report.
    pub wall_s: BTreeMap<&'static str, f64>,
    /// Rays and returns of the LiDAR, if it was asked for.
    pub lidar: Option<[usize; 2]>,
    /// Returns of all radars, if they were asked for.
    pub radar: Option<usize>,
    /// One of the pictures, to be looked at.
    pub first: Option<RgbaPicture>,
}

/// Names of everything that can be rendered.
pub fn kinds() -> Vec<&'static str> {
    let views = cameras::views().into_iter().map(|v| v.id.name());
    views.chain(OTHERS).collect()
}

/// Errors if the list is empty, or holds an unknown name; `key` is the name of the list.
pub fn check_what(what: &[String], key: &str) -> anyhow::Result<()> {
    let kinds = kinds();
    if what.is_empty() {
        bail!("{key} is empty, expected some of {}", kinds.join(", "));
    }
    if let Some(unknown) = what.iter().find(|w| !kinds.contains(&w.as_str())) {
        bail!("{key} holds {unknown:?}, expected {}", kinds.join(", "));
    }
    Ok(())
}

impl Rendering {
    /// The scene as camera sources take it, under the weather and time that were asked for.
    fn input<'a>(&'a self, scene: &'a Scene) -> CameraInput<'a> {
        let own = scene.conditions;
        let timed = self.time.map_or(own, |time| own.at(time));
        CameraInput {
            conditions: self.weather.map_or(timed, |weather| timed.under(weather)),
            paint: self.paint.as_ref(),
            ..camera_input(scene, Detail::Full)
        }
    }

    /// Recipe of the pictures, under the weather and time that were asked for.
    fn recipe(&self, scene: &Scene) -> Recipe {
        Recipe {
            conditions: self.input(scene).conditions,
            ..Recipe::of(scene)
        }
    }

    /// Renders and writes the pictures of one source, a few cameras at a time if they are small, else one; `made` is called for
    /// each.
    fn cameras(
        &self,
        scene: &Scene,
        cameras: &Cameras,
        (writer, out): (&mut Writer, &mut RenderedFiles),
        made: &mut dyn FnMut() -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let mut time_s = 0.0;
        let start = Instant::now();
        let ready = PreparedSource::new(cameras.source, &self.input(scene));
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
                made()?;
            }
        }
        writer.finish_sheet(&cameras.views)?;
        *out.wall_s.entry(cameras.source.about().report_key).or_default() += time_s;
        Ok(())
    }

    /// Renders the moment that a scene shows, and writes the files into a folder, which is made; `listen` gets the
    /// forecast of the time and the progress. Errors in one line, also those of `listen`; a missing sensor or network
    /// is reported before anything is written.
    pub fn write(
        &self,
        scene: &Scene,
        folder: &Path,
        listen: &mut Listen<'_>,
    ) -> anyhow::Result<RenderedFiles> {
        let of_file = scene;
        let scene = &*of_file.for_sensors();
        let plan = RenderPlan::new(self, scene)?;
        self.forecast(&plan, scene, listen)?;
        let (mut pictures, of) = (0, plan.pictures(scene));
        let mut made = || {
            pictures += 1;
            listen(RenderProgress::Made { pictures, of })
        };
        let mut writer = Writer::new(folder, self.recipe(of_file))?;
        let mut out = RenderedFiles::default();
        let frame = scene.frame();
        for cameras in &plan.cameras {
            self.cameras(scene, cameras, (&mut writer, &mut out), &mut made)?;
        }
        if plan.truth {
            let time_s = self.truth(scene, &mut writer, &mut made)?;
            out.wall_s.insert("truth", time_s);
        }
        if plan.truth || !plan.cameras.is_empty() || plan.lidar.is_some() || plan.radar {
            writer.calibration(of_file, &frame.world_from_ego, self.size)?;
        }
        if let Some(model) = &plan.lidar {
            let start = Instant::now();
            let sweep = model.sweep(scene)?;
            out.wall_s.insert("lidar", start.elapsed().as_secs_f64());
            out.lidar = Some([sweep.rays, sweep.points.len()]);
            writer.lidar(frame, &sweep)?;
        }
        if plan.radar {
            let start = Instant::now();
            let scans = radar::scans(scene);
            out.wall_s.insert("radar", start.elapsed().as_secs_f64());
            out.radar = Some(scans.iter().map(|scan| scan.returns.len()).sum());
            writer.radar(frame, &scans)?;
        }
        if plan.bev {
            let start = Instant::now();
            writer.picture("bev.png", &picture::layout_top(frame, 4))?;
            writer.picture("occupancy_top.png", &picture::occupancy_top(&frame.occupancy, 4))?;
            out.wall_s.insert("bev", start.elapsed().as_secs_f64());
        }
        if let Some(mut view) = plan.view {
            let start = Instant::now();
            let shot = view.shot(scene, &Default::default())?;
            writer.picture("view.png", &shot)?;
            out.wall_s.insert("view", start.elapsed().as_secs_f64());
        }
        (out.files, out.first) = (writer.files, writer.first);
        Ok(out)
    }
}
