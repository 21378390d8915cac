//! `sceneloom demo`: the main job without a window, with pictures and a report.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use glam::{DVec2, DVec3};
use serde_json::json;

use super::generate::run_and_adopt;
use super::progress::ProgressLine;
use super::render::sense;
use super::{CommandResult, Common, Weights, output};
use app::look::Look;
use app::open;
use app::picture::{self, RgbaPicture, View3d};
use app::text::with_conditions;
use editor::{Document, Edit, Shape};
use formats::loom;
use job::pipeline::OccPipeline;
use job::{GenParams, Job};
use nets::OccModels;
use scene::{BevLayer, BoxId, Class, Scene};
use sensors::pictures::color;

/// Arguments.
#[derive(clap::Args, Default)]
pub struct Demo {
    /// Folder to write into.
    #[arg(short, long, value_name = "DIR", default_value = "sceneloom-demo")]
    output: PathBuf,
    #[command(flatten)]
    weights: Weights,
    #[command(flatten)]
    common: Common,
}

/// The nearest car in front of the ego, by distance.
fn nearest_car(scene: &Scene) -> Option<BoxId> {
    let cars = scene.frame().boxes.values().filter(|b| b.class == Class::Car);
    let nearest = cars.min_by(|a, b| a.center_m.length().total_cmp(&b.center_m.length()))?;
    Some(nearest.id)
}

/// The edits of the demo for a scene: each step's name and its edits.
fn edits(scene: &Scene) -> Vec<(&'static str, Vec<Edit>)> {
    let mut list = Vec::new();
    if let Some(id) = nearest_car(scene) {
        list.push(("car removed", vec![Edit::RemoveBox { id }]));
    }
    let cone = |x: f64, y: f64| Edit::AddBox {
        class: Class::TrafficCone,
        center_m: DVec3::new(x, y, 0.45),
        size_m: DVec3::new(0.45, 0.45, 0.9),
        yaw_deg: 0.0,
        velocity_mps: None,
        id: None,
        label: Default::default(),
    };
    list.push((
        "cones added",
        (0..5)
            .map(|i| cone(8.0 + 2.2 * f64::from(i), -1.4 + 0.5 * f64::from(i)))
            .collect(),
    ));
    // A lane beside the road, where the drivable area ends on the right.
    let frame = scene.frame();
    let edge = (2..95)
        .find(|y| !frame.layout.has(BevLayer::DrivableArea, 110, 100 - y))
        .unwrap_or(15);
    let y_m = frame.extent().center(110, 100 - edge, 0).y - 1.5;
    let line = Shape::Line {
        points_m: vec![DVec2::new(-38.0, y_m), DVec2::new(38.0, y_m)],
        width_m: 3.4,
    };
    list.push((
        "lane painted",
        vec![
            Edit::PaintBev {
                layer: BevLayer::Walkway,
                shape: line.clone(),
                value: false,
            },
            Edit::PaintBev {
                layer: BevLayer::DrivableArea,
                shape: line,
                value: true,
            },
        ],
    ));
    let wall: Vec<[usize; 3]> = (0..12)
        .flat_map(|i| (0..6).map(move |z| [150, 94 + i, z]))
        .collect();
    list.push((
        "voxel wall",
        vec![Edit::PaintVoxels {
            cells: wall,
            class: Class::Manmade,
        }],
    ));
    list.push((
        "prompt set",
        vec![Edit::SetPrompt {
            prompt: "night, rain".into(),
        }],
    ));
    list
}

/// Six semantic and six depth pictures as two rows.
fn camera_sheet(scene: &Scene) -> RgbaPicture {
    let (maps, _) = sense(scene, [320, 180]);
    let picture = |rgba: Vec<u8>, m: &scene::CameraMaps| RgbaPicture {
        width: m.width,
        height: m.height,
        rgba,
    };
    let semantic = maps
        .iter()
        .map(|m| picture(color::semantic_rgba(m, true), m))
        .collect();
    let depth = maps
        .iter()
        .map(|m| picture(color::depth_rgba(&m.depth_m, 1.0, 60.0), m))
        .collect();
    RgbaPicture::sheet(&[semantic, depth], 8)
}

struct Sink<'a> {
    dir: &'a Path,
    files: Vec<String>,
    view: Option<View3d>,
}

impl Sink<'_> {
    fn png(&mut self, name: &str, picture: &RgbaPicture) -> anyhow::Result<()> {
        output::write_png(&self.dir.join(name), picture.width, picture.height, &picture.rgba)?;
        self.files.push(name.into());
        Ok(())
    }

    /// Layout, occupancy and LiDAR from above, and the 3D view where there is an adapter.
    fn row(&mut self, scene: &Scene) -> anyhow::Result<Vec<RgbaPicture>> {
        let frame = scene.frame();
        let (_, sweep) = sense(scene, [1, 1]);
        let mut row = vec![
            picture::layout_top(frame, 2),
            picture::occupancy_top(&frame.occupancy, 2),
            picture::lidar_top(frame.extent(), &sweep, 2),
        ];
        if let Some(view) = &mut self.view {
            let options = picture::ShotOptions {
                size: [640, 400],
                ..Default::default()
            };
            row.push(view.shot(scene, &options)?);
        }
        Ok(row)
    }
}

impl Demo {
    pub(super) fn run(self) -> CommandResult {
        let dir = if self.output.as_os_str().is_empty() {
            PathBuf::from("sceneloom-demo")
        } else {
            self.output
        };
        std::fs::create_dir_all(&dir).with_context(|| format!("create {}", dir.display()))?;
        let progress = ProgressLine::new(&self.common);
        let start = Instant::now();
        let mut pipeline = OccPipeline::new(OccModels::open(self.weights.folder.as_deref())?);
        let mut document = Document::new(open::bundled()?);
        let mut sink = Sink {
            dir: &dir,
            files: Vec::new(),
            view: None,
        };
        match View3d::new(Look::Voxels) {
            Ok(view) => sink.view = Some(view),
            // The demo's pictures from above and of the cameras need no graphics adapter.
            Err(error) => eprintln!("no 3D pictures: {}", output::one_line(&error)),
        }
        loom::save(&dir.join("0_scene.loom"), document.scene())?;
        sink.files.push("0_scene.loom".into());
        sink.png("0_cameras.png", &camera_sheet(document.scene()))?;
        let params = GenParams::default();
        let job = Job {
            scene: document.scene().clone(),
            params: params.clone(),
        };
        let calls = progress.with_ctx(|ctx| pipeline.prepare(&job, ctx))?;
        let invert_s = start.elapsed().as_secs_f64();
        let mut rows = Vec::new();
        let seed = document.scene().conditions.seed;
        for (i, (label, edits)) in edits(document.scene()).into_iter().enumerate() {
            let before = sink.row(document.scene())?;
            let edit_start = Instant::now();
            document
                .apply_all(label, &with_conditions(&edits, seed))
                .with_context(|| label.to_string())?;
            let result = run_and_adopt(&mut document, &mut pipeline, params.clone(), &progress, None)?;
            let wall_s = edit_start.elapsed().as_secs_f64();
            let stem = format!("{}_{}", i + 1, label.replace(' ', "_"));
            let after = sink.row(document.scene())?;
            sink.png(
                &format!("{stem}_before_after.png"),
                &RgbaPicture::sheet(&[before, after], 8),
            )?;
            sink.png(&format!("{stem}_cameras.png"), &camera_sheet(document.scene()))?;
            loom::save(&dir.join(format!("{stem}.loom")), document.scene())?;
            sink.files.push(format!("{stem}.loom"));
            let r = &result.report;
            rows.push(json!({
                "label": label,
                "wall_s": wall_s,
                "network_calls": r.network_calls,
                "voxels_changed": r.voxels_changed,
                "region_share": r.region_share,
                "untouched_voxels_changed": r.untouched_voxels_changed,
            }));
        }
        sink.files.push("report.json".into());
        let report = json!({
            "edits": rows,
            "files": sink.files,
            "inversion": { "network_calls": calls, "wall_s": invert_s },
            "model": pipeline.models().card.name,
            "peak_rss_mb": output::peak_rss_mb(),
            "wall_s": start.elapsed().as_secs_f64(),
        });
        output::write_file(
            &dir.join("report.json"),
            serde_json::to_string_pretty(&report)?.as_bytes(),
        )?;
        output::report(&self.common, &report, || {
            let mut text = format!(
                "{:<14} {:>8} {:>6} {:>9} {:>10}\n",
                "edit", "seconds", "calls", "changed", "untouched"
            );
            for row in &rows {
                let seconds = row["wall_s"].as_f64().unwrap_or(0.0);
                text += &format!(
                    "{:<14} {seconds:>8.2} {:>6} {:>9} {:>10}\n",
                    row["label"].as_str().unwrap_or(""),
                    row["network_calls"],
                    row["voxels_changed"],
                    row["untouched_voxels_changed"],
                );
            }
            format!("{text}pictures, scenes and report.json in {}", dir.display())
        });
        Ok(())
    }
}
