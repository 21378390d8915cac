//! `sceneloom shot`: the 3D viewport alone, off screen.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context;
use serde_json::json;

use super::render::size;
use super::{Common, Moment, Outcome, output};
use app::export::view_camera;
use app::{open, picture};
use sensors::cameras::bounds;

/// Arguments.
#[derive(clap::Args)]
pub struct Shot {
    /// Scene to read.
    scene: PathBuf,
    /// Viewpoint: perspective, top, front, side, ego, or a camera of the rig (CAM_FRONT).
    #[arg(long, value_name = "NAME", default_value = "perspective")]
    view: String,
    /// Size in pixels.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1280x720")]
    size: [u32; 2],
    /// Supersampling per axis, 1 to 8.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=8))]
    scale: u32,
    /// Without background.
    #[arg(long)]
    transparent: bool,
    /// With LiDAR returns.
    #[arg(long)]
    lidar: bool,
    /// Picture to write.
    #[arg(short, long, value_name = "F.png")]
    output: PathBuf,
    #[command(flatten)]
    moment: Moment,
    #[command(flatten)]
    common: Common,
}

impl Shot {
    pub(super) fn run(self) -> Outcome {
        let scene = self.moment.of(open::scene(&self.scene)?)?;
        let camera = view_camera(&scene, &self.view)?;
        bounds::check(self.size, picture::SHOT_BYTES_PER_PIXEL, 0).context("--size")?;
        let options = picture::ShotOptions {
            camera,
            size: self.size,
            supersample: self.scale,
            transparent: self.transparent,
            lidar: self.lidar,
            boxes: true,
        };
        let start = Instant::now();
        let mut view = picture::View3d::new()?;
        let shot = view.shot(&scene, &options)?;
        output::write_png(&self.output, shot.width, shot.height, &shot.rgba)?;
        let wall_s = start.elapsed().as_secs_f64();
        let report = json!({ "adapter": view.adapter, "wall_s": wall_s, "file": self.output });
        output::report(&self.common, &report, || {
            format!(
                "{}: {} in {wall_s:.2} s on {}",
                self.output.display(),
                self.view,
                view.adapter
            )
        });
        Ok(())
    }
}
