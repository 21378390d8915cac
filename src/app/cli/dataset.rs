//! `sceneloom dataset`: training and evaluation data from procedural worlds or a folder of labels.

use std::path::PathBuf;

use anyhow::{Context, bail};

use super::dataset_occ3d;
use super::progress::Progress;
use super::render::size;
use super::{Common, Outcome, output};
use app::memory;
use app::open;
use authoring::drives::{drive_scene, frames_of};
use authoring::roads::Roads;
use dataset::layout::layout_frame;
use dataset::lidar::lidar_frame;
use dataset::pictures::picture_frame;
use dataset::text::text_frame;
use dataset::{self, DatasetReport, OccupancyFrame, occupancy_frame};
use formats::occ3d;

/// Arguments.
#[derive(clap::Args)]
pub struct Dataset {
    /// What the frames hold, as shards for training; `occ3d` writes simulated labels with their masks as Occ3D files,
    /// `memory` the bank of remembered scenes.
    #[arg(value_parser = ["occupancy", "drives", "lidar", "layout", "text", "pictures", "occ3d", "memory"])]
    kind: String,
    /// Number of frames; of a folder, all by default.
    #[arg(long, value_name = "N", required_unless_present = "from")]
    frames: Option<usize>,
    /// Folder of Occ3D frames (`labels.npz`, at any depth) to take instead of procedural worlds.
    #[arg(long, value_name = "DIR")]
    from: Option<PathBuf>,
    /// Folder of OpenDRIVE files (`.xodr`, at any depth): a third of the worlds stand on their roads, the
    /// rest on templates.
    #[arg(long, value_name = "DIR", conflicts_with = "from")]
    roads: Option<PathBuf>,
    /// Size of camera pictures (kind `pictures`).
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "400x225")]
    size: [u32; 2],
    /// Fixes the worlds; use different seeds for training, validation and test.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder to write shards into; shards that are there already are kept.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    common: Common,
}

impl Dataset {
    pub(super) fn run(self) -> Outcome {
        let progress = Progress::new(&self.common);
        let start = std::time::Instant::now();
        if self.kind != "occupancy" && self.from.is_some() {
            (|| -> anyhow::Result<()> {
                bail!(
                    "--from gives labels, kind {} needs more: expected procedural worlds",
                    self.kind
                )
            })()?;
        }
        let files = match &self.from {
            Some(dir) => open::files_below(dir, "npz", "Occ3D frames")?,
            None => Vec::new(),
        };
        let frames = self.frames.unwrap_or(files.len());
        if self.from.is_some() && frames > files.len() {
            (|| -> anyhow::Result<()> {
                bail!(
                    "--frames is {frames}, expected at most {}, the frames of the folder",
                    files.len()
                )
            })()?;
        }
        let roads = match &self.roads {
            Some(dir) => Roads::open(dir)?,
            None => Roads::default(),
        };
        let make = |i: usize| -> anyhow::Result<OccupancyFrame> {
            Ok(match files.get(i) {
                Some(path) => {
                    let frame = occ3d::load(path).with_context(|| path.display().to_string())?;
                    OccupancyFrame::of_labels(frame.labels)
                }
                None => occupancy_frame(self.seed, i as u64, |seed| roads.layout(seed)),
            })
        };
        let step = |done| {
            progress.at(&self.kind, done, frames);
            true
        };
        let report = match self.kind.as_str() {
            "lidar" => {
                let make = |i: usize| anyhow::Ok(lidar_frame(self.seed, i as u64, |seed| roads.layout(seed)));
                dataset::write(&self.output, frames, make, step)
            }
            "layout" => {
                let make =
                    |i: usize| anyhow::Ok(layout_frame(self.seed, i as u64, |seed| roads.layout(seed)));
                dataset::write(&self.output, frames, make, step)
            }
            "text" => {
                let make = |i: usize| anyhow::Ok(text_frame(self.seed, i as u64, |seed| roads.layout(seed)));
                dataset::write(&self.output, frames, make, step)
            }
            "pictures" => {
                let size = self.size;
                let make = |i: usize| {
                    anyhow::Ok(picture_frame(self.seed, i as u64, size, |seed| {
                        roads.layout(seed)
                    }))
                };
                dataset::write(&self.output, frames, make, step)
            }
            "drives" => {
                let make = |i: usize| {
                    anyhow::Ok(frames_of(&drive_scene(self.seed, i as u64, |seed| {
                        roads.layout(seed)
                    })))
                };
                dataset::write(&self.output, frames, make, step)
            }
            "occ3d" => {
                let layouts = |seed| roads.layout(seed);
                dataset_occ3d::write(&self.output, frames, self.seed, layouts, |done| {
                    step(done);
                })
            }
            "memory" => self.memory(frames),
            _ => dataset::write(&self.output, frames, make, step),
        }
        .with_context(|| format!("write {}", self.output.display()))?;
        progress.done();
        let mut json = serde_json::to_value(&report)?;
        json["frames_per_s"] = (frames as f64 / start.elapsed().as_secs_f64()).into();
        output::report(&self.common, &json, || {
            format!(
                "{}: {} frames, {} bytes written",
                self.output.display(),
                report.frames,
                report.bytes
            )
        });
        Ok(())
    }
    /// `bank.json` of that many remembered scenes on templates and the project's own roads.
    fn memory(&self, frames: usize) -> anyhow::Result<DatasetReport> {
        let bank = memory::make_bank(frames, self.seed)?;
        let text = serde_json::to_string(&bank)?;
        std::fs::create_dir_all(&self.output)?;
        std::fs::write(self.output.join("bank.json"), &text)?;
        Ok(DatasetReport {
            frames: bank.entries.len(),
            bytes: text.len() as u64,
            resumed_shards: 0,
        })
    }
}
