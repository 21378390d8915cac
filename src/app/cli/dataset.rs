//! `sceneloom dataset`: training and evaluation data from procedural worlds or a folder of labels.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use serde_json::json;

use super::dataset_recipe::{Recipe, SourceFolder};
use super::dataset_recorded::Pairs;
use super::progress::ProgressLine;
use super::render::size;
use super::{CommandResult, Common, output};
use super::{dataset_occ3d, dataset_recipe};
use app::memory;
use app::open;
use authoring::drives::{drive_scene, frames_of};
use authoring::roads::RoadNetworkPool;
use dataset::layout::layout_frame;
use dataset::lidar::lidar_frame;
use dataset::pictures::picture_frame;
use dataset::text::text_frame;
use dataset::{self, DatasetReport, OccupancyFrame, occupancy_frame};
use formats::occ3d;
use formats::out_folder::OutFolder;

/// Arguments.
#[derive(clap::Args)]
pub struct Dataset {
    /// Content of the frames, as shards for training; `occ3d` writes simulated labels with their masks as Occ3D files,
    /// `memory` the bank of remembered scenes.
    #[arg(value_parser = ["occupancy", "drives", "lidar", "layout", "text", "pictures", "occ3d", "memory"])]
    kind: String,
    /// Number of frames; of a folder, all by default.
    #[arg(long, value_name = "N", required_unless_present = "from")]
    frames: Option<usize>,
    /// Folder to take instead of procedural worlds: of Occ3D frames (`labels.npz`, at any depth; kind `occupancy`), or of nuScenes
    /// tables with pictures of six cameras (kind `pictures`: two key frames each, as `train_pictures.py` learns from).
    #[arg(long, value_name = "DIR")]
    from: Option<PathBuf>,
    /// Folder of OpenDRIVE files (`.xodr`, at any depth): a third of the worlds stand on their roads, the
    /// rest on templates.
    #[arg(long, value_name = "DIR", conflicts_with = "from")]
    roads: Option<PathBuf>,
    /// Range of the drives of --from, in the order of their names: from A on, before B. It serves to hold some out.
    #[arg(long, value_name = "A..B", value_parser = drives, requires = "from")]
    drives: Option<Range<usize>>,
    /// Size of camera pictures (kind `pictures`): 400x225 if left out, 256x144 with --from.
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Fixes the worlds; use different seeds for training, validation and test.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder to write shards into; those that are there already are kept, if they were made with the same arguments.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    common: Common,
}

impl Dataset {
    pub(super) fn run(self) -> CommandResult {
        let progress = ProgressLine::new(&self.common);
        let start = Instant::now();
        if let (Some(from), "pictures") = (&self.from, self.kind.as_str()) {
            let pairs = Pairs::open(from, (self.drives.clone(), self.frames), self.size_px())?;
            dataset_recipe::claim(&self.output, &self.recipe()?)?;
            let step = |done| {
                progress.at(&self.kind, done, pairs.count());
                true
            };
            let (report, incomplete) = pairs.write(&self.output, step)?;
            progress.done();
            return self.report(&report, Some(incomplete), start);
        }
        self.check_from()?;
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
            Some(dir) => RoadNetworkPool::open(dir)?,
            None => RoadNetworkPool::default(),
        };
        if self.kind != "memory" {
            dataset_recipe::claim(&self.output, &self.recipe()?)?;
        }
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
                let size = self.size_px();
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
        self.report(&report, None, start)
    }

    /// Size of camera pictures, px: as given, or the usual size of the source.
    fn size_px(&self) -> [u32; 2] {
        let usual = match self.from {
            Some(_) => [256, 144],
            None => [400, 225],
        };
        self.size.unwrap_or(usual)
    }

    /// All arguments that the data depend on; a larger number of frames is the same recipe.
    fn recipe(&self) -> anyhow::Result<Recipe> {
        let size = (self.kind == "pictures").then(|| self.size_px());
        let drives = self.drives.as_ref().map(|d| [d.start, d.end]);
        let arguments = [
            ("kind", json!(self.kind)),
            ("seed", json!(self.seed)),
            ("drives", json!(drives)),
            ("size", json!(size)),
        ];
        let (tables, labels) = (("json", "nuScenes tables"), ("npz", "Occ3D frames"));
        let (extension, what) = if self.kind == "pictures" { tables } else { labels };
        let made = |dir: &Option<PathBuf>, extension, what| {
            dir.as_ref()
                .map(|dir| SourceFolder::read_from(dir, extension, what))
                .transpose()
        };
        Ok(Recipe {
            arguments: arguments
                .map(|(what, value)| (what.to_owned(), value))
                .into_iter()
                .collect(),
            folders: vec![
                ("from", made(&self.from, extension, what)?),
                ("roads", made(&self.roads, "xodr", "OpenDRIVE roads")?),
            ],
        })
    }

    /// Errors if --from or --drives is given and this kind does not take it.
    fn check_from(&self) -> anyhow::Result<()> {
        match (self.kind.as_str(), &self.from, &self.drives) {
            ("occupancy", _, None) | (_, None, _) => Ok(()),
            ("occupancy", ..) => bail!("--drives is of kind pictures alone"),
            (kind, ..) => bail!(
                "--from gives labels or pictures, kind {kind} needs more: expected occupancy, pictures or procedural worlds"
            ),
        }
    }

    /// `incomplete`: key frames of a folder that were left out, since they lack pictures.
    fn report(&self, report: &DatasetReport, incomplete: Option<usize>, start: Instant) -> CommandResult {
        let mut json = serde_json::to_value(report)?;
        if let Some(n) = incomplete {
            json["key_frames_without_pictures"] = n.into();
        }
        json["frames_per_s"] = (report.frames as f64 / start.elapsed().as_secs_f64()).into();
        output::report(&self.common, &json, || {
            let kept = match report.resumed_shards {
                0 => String::new(),
                n => format!("; {n} shards were there and stay as they are"),
            };
            let left_out = match incomplete {
                None | Some(0) => String::new(),
                Some(n) => format!("; {n} key frames lack pictures of six cameras"),
            };
            format!(
                "{}: {} frames, {} bytes written{kept}{left_out}",
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
        OutFolder::make(&self.output)?.write("bank.json", text.as_bytes())?;
        Ok(DatasetReport {
            frames: bank.entries.len(),
            bytes: text.len() as u64,
            resumed_shards: 0,
        })
    }
}

/// `A..B`.
fn drives(text: &str) -> anyhow::Result<Range<usize>> {
    let expected = || "expected two numbers as in 0..8";
    let (from, to) = text.split_once("..").with_context(expected)?;
    Ok(from.parse().with_context(expected)?..to.parse().with_context(expected)?)
}
