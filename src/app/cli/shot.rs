//! `sceneloom shot`: a picture of any size for people: the 3D view, the map, all cameras on a sheet, LiDAR. The dialog
//! of pictures makes the same.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use serde_json::json;

use super::render::size;
use super::viewpoint::Viewpoint;
use super::{CommandResult, Common, Moment, output};
use app::capture::{CaptureOptions, Subject, capture, to_png};
use app::{open, picture};
use scene::Scene;
use sensors::cameras::{self, bounds};

/// Arguments.
#[derive(clap::Args)]
pub struct Shot {
    /// Scene to read.
    scene: PathBuf,
    /// Picture to make: view (the 3D view), map, occupancy, cameras (all on one sheet) or lidar.
    #[arg(long, value_name = "WHAT", default_value = "view")]
    what: String,
    /// Camera pictures to make: semantic, depth, appearance, learned, perceived, normals and so on.
    #[arg(long, value_name = "VIEW", default_value = "semantic")]
    show: String,
    /// With names, a legend and a scale.
    #[arg(long)]
    legend: bool,
    #[command(flatten)]
    viewpoint: Viewpoint,
    /// Size in pixels: of the 3D view, of the frame that a map fills, or of each camera (then 800x450 if left out).
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
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
    pub(super) fn run(self) -> CommandResult {
        let scene = self.moment.apply_to(open::scene(&self.scene)?)?;
        let options = self.options(&scene)?;
        let start = Instant::now();
        let (shot, adapter) = match options.subject {
            // (also without a legend, the report names the adapter)
            Subject::View if !options.legend => {
                let mut view = picture::View3d::new(options.shot.look)?;
                (view.shot(&scene, &options.shot)?, Some(view.adapter))
            }
            _ => (capture(&scene, &options)?, None),
        };
        output::write_file(&self.output, &to_png(&scene, &shot)?)?;
        let wall_s = start.elapsed().as_secs_f64();
        let report = json!({
            "adapter": adapter, "wall_s": wall_s, "file": self.output, "size": [shot.width, shot.height],
        });
        output::report(&self.common, &report, || {
            let shown = match options.subject {
                Subject::View => self.viewpoint.name(),
                _ => &self.what,
            };
            let on = adapter
                .as_ref()
                .map_or(String::new(), |adapter| format!(" on {adapter}"));
            format!(
                "{}: {shown}, {} x {}, in {wall_s:.2} s{on}",
                self.output.display(),
                shot.width,
                shot.height,
            )
        });
        Ok(())
    }

    fn options(&self, scene: &Scene) -> anyhow::Result<CaptureOptions> {
        let names: Vec<&str> = Subject::ALL.iter().map(|s| s.1).collect();
        let subject = Subject::ALL.iter().find(|s| s.1 == self.what).map(|s| s.0);
        let Some(subject) = subject else {
            bail!("--what is {:?}, expected {}", self.what, names.join(", "));
        };
        self.viewpoint.is_for(subject == Subject::View, &self.what)?;
        let views = cameras::views();
        let Some(view) = views.iter().find(|v| v.id.name() == self.show) else {
            let names: Vec<&str> = views.iter().map(|v| v.id.name()).collect();
            bail!("--show is {:?}, expected {}", self.show, names.join(", "));
        };
        let usual = CaptureOptions::default();
        let shot = picture::ShotOptions {
            camera: self.viewpoint.camera(scene)?,
            size: self.size.unwrap_or(usual.shot.size),
            supersample: self.scale,
            transparent: self.transparent,
            lidar: self.lidar,
            boxes: self.viewpoint.boxes(),
            look: self.viewpoint.look(),
        };
        bounds::check(shot.size, picture::SHOT_BYTES_PER_PIXEL, 0).context("--size")?;
        Ok(CaptureOptions {
            subject,
            shot,
            camera_size: self.size.unwrap_or(usual.camera_size),
            view: view.id,
            legend: self.legend,
            ..usual
        })
    }
}
