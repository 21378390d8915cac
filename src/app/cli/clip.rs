//! `sceneloom clip`: a scene that lasts, as moving pictures.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::bail;
use serde_json::json;

use super::painting::Painting;
use super::progress::ProgressLine;
use super::render::size;
use super::viewpoint::Viewpoint;
use super::{CommandResult, Common, output};
use app::capture::{Turntable, turntable};
use app::clip_export::{ClipOptions, ClipView, clip};
use app::open;
use app::picture::ShotOptions;
use formats::video::VideoKind;
use scene::Scene;
use sensors::cameras::{self, learned};

/// Arguments.
#[derive(clap::Args)]
pub struct ClipCommand {
    /// Scene to read.
    scene: PathBuf,
    /// Picture of the clip: view (the 3D view), turntable (it turns once around; also of a scene of one moment), bev,
    /// map (as large as fits the size), or what cameras see (semantic, depth, appearance, learned, perceived, normals
    /// and so on).
    #[arg(long, value_name = "WHAT", default_value = "view")]
    what: String,
    #[command(flatten)]
    viewpoint: Viewpoint,
    /// The 3D view stays where it is and does not go along with the ego vehicle.
    #[arg(long)]
    fixed: bool,
    /// One camera of the rig; all of them if left out.
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Size in pixels: of the 3D view or the map, or of each camera.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "640x360")]
    size: [u32; 2],
    /// First moment, s.
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    from: f64,
    /// Last moment, s; the end if left out.
    #[arg(long, value_name = "S")]
    to: Option<f64>,
    /// How long one turn of the turntable takes, s.
    #[arg(long, value_name = "S", default_value_t = 6.0)]
    turn: f64,
    /// Frames per second; those of the scene if left out.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// File to write: .gif, .png (an APNG) or .mp4.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    painting: Painting,
    #[command(flatten)]
    common: Common,
}

impl ClipCommand {
    pub(super) fn run(self) -> CommandResult {
        let kind = VideoKind::of_path(&self.output).map_err(anyhow::Error::new)?;
        let paints = self.what == learned::VIEW.id.name();
        self.painting.is_for(paints, &self.what)?;
        let scene = open::scene(&self.scene)?;
        let start = Instant::now();
        let progress = ProgressLine::new(&self.common);
        let go_on = |done, all| {
            progress.at("clip", done, all);
            true
        };
        let (bytes, frames) = match self.what.as_str() {
            "turntable" => {
                let turn = self.turntable(&scene)?;
                let bytes = turntable(&scene.at(self.from), &turn, kind, &go_on)?;
                (bytes, turn.frames() as usize)
            }
            _ => {
                let options = self.options(&scene)?;
                let [from, to] = options.span_s;
                let frames = ((to - from) * options.rate_hz + 1e-6) as usize + 1;
                (clip(&scene, &options, kind, &go_on)?, frames)
            }
        };
        progress.done();
        output::write_file(&self.output, &bytes)?;
        let wall_s = start.elapsed().as_secs_f64();
        let report = json!({
            "file": self.output, "bytes": bytes.len(), "frames": frames, "wall_s": wall_s,
            "frames_per_s": frames as f64 / wall_s,
        });
        output::report(&self.common, &report, || {
            format!(
                "{}: {frames} frames, {} kB, {wall_s:.1} s",
                self.output.display(),
                bytes.len() / 1000
            )
        });
        Ok(())
    }

    fn turntable(&self, scene: &Scene) -> anyhow::Result<Turntable> {
        Ok(Turntable {
            shot: ShotOptions {
                camera: self.viewpoint.camera(&scene.at(self.from))?,
                size: self.size,
                boxes: self.viewpoint.boxes(),
                look: self.viewpoint.look(),
                supersample: 1,
                ..ShotOptions::default()
            },
            seconds: self.turn,
            rate_hz: self.rate.unwrap_or(15.0),
        })
    }

    fn options(&self, scene: &Scene) -> anyhow::Result<ClipOptions> {
        let view = self.shown(scene)?;
        self.viewpoint.is_for(self.what == "view", &self.what)?;
        let length_s = scene.clip().length_s;
        if length_s == 0.0 {
            bail!(
                "{}: the scene is one moment; set_length and set_motion make it longer",
                self.scene.display()
            );
        }
        let mut options = ClipOptions {
            view,
            size: self.size,
            span_s: [self.from, self.to.unwrap_or(length_s)],
            rate_hz: self.rate.unwrap_or(scene.clip().rate_hz),
            paint: None,
        };
        if options.paints() {
            options.paint = Some(self.painting.open()?);
        }
        Ok(options)
    }

    fn shown(&self, scene: &Scene) -> anyhow::Result<ClipView> {
        match self.what.as_str() {
            "view" => Ok(ClipView::View3d {
                camera: Box::new(self.viewpoint.camera(&scene.at(self.from))?),
                follow: !self.fixed,
                boxes: self.viewpoint.boxes(),
                look: self.viewpoint.look(),
            }),
            "bev" => Ok(ClipView::Bev),
            "map" => Ok(ClipView::Map),
            what => {
                let views = cameras::views();
                let Some(view) = views.iter().find(|v| v.id.name() == what) else {
                    let names: Vec<&str> = views.iter().map(|v| v.id.name()).collect();
                    bail!(
                        "--what is {what:?}, expected view, turntable, bev, map, {}",
                        names.join(", ")
                    );
                };
                let camera = match &self.camera {
                    None => None,
                    Some(name) => match scene.rig.cameras.iter().position(|c| c.name == *name) {
                        Some(index) => Some(index),
                        None => {
                            let names: Vec<&str> =
                                scene.rig.cameras.iter().map(|c| c.name.as_str()).collect();
                            bail!("--camera is {name:?}, expected one of {}", names.join(", "));
                        }
                    },
                };
                Ok(ClipView::Cameras {
                    view: view.id,
                    source: cameras::shapes::ID,
                    camera,
                })
            }
        }
    }
}
