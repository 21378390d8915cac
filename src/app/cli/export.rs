//! `sceneloom export`: a scene to files of other programs.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::Thread;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};
use serde_json::json;

use super::progress::ProgressLine;
use super::render::{size, source};
use super::viewpoint::Viewpoint;
use super::{CommandResult, Common, Moment, output};
use app::camera_views::LidarModel;
use app::export::{ExportOptions, ExportProgress, Format, export_all};
use app::open;
use app::picture::ShotOptions;
use sensors::cameras::SourceId;

/// How often is looked how far an export is.
const LOOK: Duration = Duration::from_millis(200);

/// Arguments.
#[derive(clap::Args)]
pub struct Export {
    /// Scene to read.
    scene: Option<PathBuf>,
    #[arg(long, value_name = "NAME", help = format!("Kind of file: {}; `list` tells what each holds, `all` writes every kind into a folder", names()))]
    format: String,
    /// File or folder to write.
    #[arg(short, long, value_name = "PATH")]
    output: Option<PathBuf>,
    /// Size of camera pictures and maps in pixels.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "800x450")]
    size: [u32; 2],
    /// Source that classes and depths are rendered from.
    #[arg(long, value_name = "NAME", value_parser = source(), default_value = "truth")]
    source: SourceId,
    /// How the LiDAR sweep comes about; recorded is exact for a scene that was not imported from a sweep.
    #[arg(long, value_name = "MODEL", value_parser = ["recorded", "exact", "learned"], default_value = "recorded")]
    lidar: String,
    #[command(flatten)]
    viewpoint: Viewpoint,
    /// Size of the 3D view in pixels.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1280x720")]
    view_size: [u32; 2],
    /// Supersampling of the 3D view per axis, 1 to 8.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=8))]
    scale: u32,
    /// The 3D view without background.
    #[arg(long)]
    transparent: bool,
    #[command(flatten)]
    moment: Moment,
    #[command(flatten)]
    common: Common,
}

/// Names of the formats.
fn names() -> String {
    let ids = formats::export::all().iter().map(|f| f.id);
    ids.collect::<Vec<_>>().join(", ")
}

/// Ends the thread that shows how far an export is, also where the export panics.
struct Watched<'a> {
    ended: &'a AtomicBool,
    by: &'a Thread,
}

impl Drop for Watched<'_> {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        self.by.unpark();
    }
}

/// Runs an export and shows meanwhile how far it is.
fn watched<T>(common: &Common, export: &ExportProgress, run: impl FnOnce() -> T) -> T {
    let shown = ProgressLine::new(common);
    let ended = AtomicBool::new(false);
    let out = std::thread::scope(|threads| {
        let watch = threads.spawn(|| {
            while !ended.load(Ordering::Relaxed) {
                match (export.baked_percent(), export.pictures()) {
                    (Some(percent), _) => shown.at("baking", percent, 100),
                    (None, Some((done, of))) => shown.at("pictures", done, of),
                    (None, None) => {}
                }
                std::thread::park_timeout(LOOK);
            }
        });
        let _watched = Watched {
            ended: &ended,
            by: watch.thread(),
        };
        run()
    });
    shown.done();
    out
}

impl Export {
    pub(super) fn run(self) -> CommandResult {
        if self.format == "list" {
            let line = |f: &Format| json!({ "name": f.id, "holds": f.title, "read": !f.lost.is_empty() || formats::import::all().iter().any(|i| i.id == f.id), "lost": f.lost });
            let list: Vec<_> = formats::export::all().iter().map(line).collect();
            output::report(&self.common, &json!({ "formats": list }), || {
                let line = |f: &Format| format!("{:<16} {}", f.id, f.title);
                formats::export::all()
                    .iter()
                    .map(line)
                    .collect::<Vec<_>>()
                    .join("\n")
            });
            return Ok(());
        }
        let one = formats::export::from_id(&self.format);
        if one.is_none() && self.format != "all" {
            return Err(anyhow!(
                "--format is {:?}, expected one of {}, all, list",
                self.format,
                names()
            )
            .into());
        }
        let path = self
            .output
            .context("-o PATH is missing: where should the files go?")?;
        let scene = self
            .moment
            .apply_to(open::scene(&self.scene.context("the scene to read is missing")?)?)?;
        let formats = one.map_or_else(|| formats::export::usual(&scene), |format| vec![format]);
        let options = ExportOptions {
            camera_size: self.size,
            source: self.source,
            lidar: match self.lidar.as_str() {
                "learned" => LidarModel::Learned,
                "exact" => LidarModel::Exact,
                _ => LidarModel::Recorded,
            },
            shot: ShotOptions {
                camera: self.viewpoint.camera(&scene)?,
                size: self.view_size,
                boxes: self.viewpoint.boxes(),
                supersample: self.scale,
                transparent: self.transparent,
                ..ShotOptions::default()
            },
            parameters: serde_json::Value::Null,
        };
        let start = Instant::now();
        let progress = ExportProgress::default();
        let files = watched(&self.common, &progress, || {
            export_all(&scene, &formats, &options, &path, &progress)
        })?;
        let bytes: u64 = files.iter().map(|(_, bytes)| bytes).sum();
        let paths: Vec<&PathBuf> = files.iter().map(|(path, _)| path).collect();
        let report = json!({ "files": paths, "bytes": bytes, "wall_s": start.elapsed().as_secs_f64() });
        output::report(&self.common, &report, || {
            let lines = files
                .iter()
                .map(|(path, bytes)| format!("{} ({bytes} bytes)", path.display()));
            lines.collect::<Vec<_>>().join("\n")
        });
        Ok(())
    }
}
