//! `sceneloom render`: pictures of what the sensors see.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context;
use serde_json::json;

use super::{Common, Outcome, output};
use crate::app::picture::Picture;
use crate::app::{open, picture};
use crate::formats::multi_plane;
use crate::generation::model::lidar::LidarNet;
use crate::generation::sensors::appearance::{
    Conditions, Quality, RayMarched, SynthesisInput, TimeOfDay, ViewSynthesizer, Weather,
};
use crate::generation::sensors::learned::{self, Drops};
use crate::generation::sensors::{cloud::GaussianCloud, color, lidar, mpi, perspective, splat};
use crate::scene::sensor_data::Planes;
use crate::scene::{CameraMaps, LidarSweep, Scene};

/// What can be rendered.
const KINDS: [&str; 8] = [
    "semantic",
    "depth",
    "appearance",
    "perspective",
    "mpi",
    "lidar",
    "bev",
    "view",
];

/// Arguments.
#[derive(clap::Args)]
pub struct Render {
    /// Scene to read.
    scene: PathBuf,
    /// Comma-separated: semantic, depth, appearance, perspective, mpi, lidar, bev, view.
    #[arg(long, value_delimiter = ',', value_name = "LIST")]
    what: Vec<String>,
    /// JSON file with another sensor rig (as in assets/rigs).
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Size of camera pictures in pixels.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "800x450")]
    size: [u32; 2],
    /// Weather of appearance: clear, overcast, rain, snow, fog, sandstorm; else the prompt's.
    #[arg(long, value_name = "NAME")]
    weather: Option<Weather>,
    /// Time of day of appearance: dawn, day, dusk, night; else the prompt's.
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
    common: Common,
}

/// `WxH`, each 1 to 8192.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides: Vec<u32> = text.split('x').filter_map(|v| v.parse().ok()).collect();
    match sides[..] {
        [w, h] if (1..=8192).contains(&w) && (1..=8192).contains(&h) => Ok([w, h]),
        _ => Err("expected WxH, each 1 to 8192 pixels".into()),
    }
}

/// The six cameras' maps and the LiDAR sweep of a scene.
pub fn sense(scene: &Scene, [width, height]: [u32; 2]) -> (Vec<CameraMaps>, LidarSweep) {
    let frame = scene.frame();
    let cloud = GaussianCloud::from_grid(&frame.occupancy, &frame.bev_channels());
    let maps = splat::render_rig(&cloud, &scene.rig, width, height, &splat::SplatOptions::default());
    let sweep = lidar::rig_sweep(&frame.occupancy, &scene.rig).unwrap_or_default();
    (maps, sweep)
}

/// Points as a binary little-endian PLY: x, y, z in the ego frame, range, intensity, drop probability, ring, class.
fn ply(sweep: &LidarSweep) -> Vec<u8> {
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property float range_m\nproperty float intensity\nproperty float drop_probability\nproperty ushort ring\n\
         property uchar class\nend_header\n",
        sweep.points.len()
    )
    .into_bytes();
    for p in &sweep.points {
        for v in p
            .position_in_ego
            .iter()
            .chain([&p.range_m, &p.intensity, &p.drop_probability])
        {
            out.extend(v.to_le_bytes());
        }
        out.extend(p.ring.to_le_bytes());
        out.push(p.class.id());
    }
    out
}

/// Pictures of all cameras in one, three to a row.
pub fn contact_sheet(pictures: &[Picture]) -> Picture {
    let rows: Vec<Vec<Picture>> = pictures.chunks(3).map(<[Picture]>::to_vec).collect();
    Picture::sheet(&rows, 6)
}

impl Render {
    /// Pictures as the cameras would take them, and a sheet of all; the paths written.
    fn appearance(&self, scene: &Scene) -> anyhow::Result<Vec<PathBuf>> {
        let said = Conditions::from_prompt(&scene.prompt);
        let images = RayMarched.synthesize(&SynthesisInput {
            frame: scene.frame(),
            rig: &scene.rig,
            size: self.size,
            prompt: &scene.prompt,
            conditions: Conditions {
                time: self.time.unwrap_or(said.time),
                weather: self.weather.unwrap_or(said.weather),
                seed: scene.seed,
            },
            quality: if self.preview {
                Quality::Preview
            } else {
                Quality::Full
            },
        })?;
        let mut files = Vec::new();
        let mut pictures = Vec::new();
        for image in images {
            let path = self.output.join(format!("{}_appearance.png", image.camera));
            output::write_png(&path, image.width, image.height, &image.rgba)?;
            files.push(path);
            pictures.push(Picture {
                width: image.width,
                height: image.height,
                rgba: image.rgba,
            });
        }
        let sheet = contact_sheet(&pictures);
        let path = self.output.join("appearance.png");
        output::write_png(&path, sheet.width, sheet.height, &sheet.rgba)?;
        files.push(path);
        Ok(files)
    }

    pub(super) fn run(self) -> Outcome {
        if self.what.is_empty() {
            return Err(anyhow::anyhow!("--what is empty, expected some of {}", KINDS.join(", ")).into());
        }
        if let Some(unknown) = self.what.iter().find(|w| !KINDS.contains(&w.as_str())) {
            return Err(anyhow::anyhow!("--what holds {unknown:?}, expected {}", KINDS.join(", ")).into());
        }
        let mut scene = open::scene(&self.scene)?;
        if let Some(path) = &self.rig {
            scene.rig = open::rig(path)?.into();
        }
        let dir = &self.output;
        std::fs::create_dir_all(dir).with_context(|| format!("create {}", dir.display()))?;
        let frame = scene.frame().clone();
        let wants = |kind: &str| self.what.iter().any(|w| w == kind);
        let mut files = Vec::new();
        let mut wall_s = BTreeMap::new();
        let mut lidar_report = serde_json::Value::Null;
        if wants("semantic") || wants("depth") {
            let start = Instant::now();
            let cloud = GaussianCloud::from_grid(&frame.occupancy, &frame.bev_channels());
            let [width, height] = self.size;
            let maps = splat::render_rig(&cloud, &scene.rig, width, height, &splat::SplatOptions::default());
            wall_s.insert("cameras", start.elapsed().as_secs_f64());
            for m in &maps {
                if wants("semantic") {
                    let path = dir.join(format!("{}_semantic.png", m.camera));
                    output::write_png(&path, m.width, m.height, &color::semantic_rgba(m, true))?;
                    files.push(path);
                }
                if wants("depth") {
                    let path = dir.join(format!("{}_depth.png", m.camera));
                    output::write_png(
                        &path,
                        m.width,
                        m.height,
                        &color::depth_rgba(&m.depth_m, 1.0, 60.0),
                    )?;
                    files.push(path);
                    let path = dir.join(format!("{}_depth_mm.png", m.camera));
                    output::write_png16(&path, m.width, m.height, &color::depth_mm(&m.depth_m))?;
                    files.push(path);
                }
            }
        }
        if wants("appearance") {
            let start = Instant::now();
            files.extend(self.appearance(&scene)?);
            wall_s.insert("appearance", start.elapsed().as_secs_f64());
        }
        if wants("perspective") {
            let start = Instant::now();
            let [width, height] = self.size;
            for camera in &scene.rig.cameras {
                let map = perspective::render(&frame.layout, frame.boxes.values(), camera, width, height);
                let path = dir.join(format!("{}_perspective.png", map.camera));
                output::write_png(&path, map.width, map.height, &color::perspective_rgba(&map))?;
                files.push(path);
                let path = dir.join(format!("{}_perspective_bits.png", map.camera));
                output::write_png16(&path, map.width, map.height, &map.channels)?;
                files.push(path);
            }
            wall_s.insert("perspective", start.elapsed().as_secs_f64());
        }
        if wants("mpi") {
            let start = Instant::now();
            let ids = mpi::RenderIds::new(&frame.occupancy, &frame.bev_channels());
            let [width, height] = self.size;
            for camera in &scene.rig.cameras {
                let image = mpi::render(&ids, camera, width, height, Planes::default());
                let path = dir.join(format!("{}_mpi.npz", image.camera));
                output::write_file(&path, &multi_plane::sparse(&image))?;
                files.push(path);
                let path = dir.join(format!("{}_mpi.png", image.camera));
                let sheet = picture::plane_sheet(&image);
                output::write_png(&path, sheet.width, sheet.height, &sheet.rgba)?;
                files.push(path);
            }
            wall_s.insert("mpi", start.elapsed().as_secs_f64());
        }
        if wants("lidar") {
            let start = Instant::now();
            if scene.rig.lidars.is_empty() {
                return Err(anyhow::anyhow!("the rig {:?} has no lidar", scene.rig.name).into());
            }
            let sweep = if self.lidar == "learned" {
                let net = LidarNet::bundled().context("the LiDAR network")?;
                learned::rig_sweep(&net, &frame.occupancy, &scene.rig, Drops::Likely)
                    .context("the LiDAR network")?
            } else {
                lidar::rig_sweep(&frame.occupancy, &scene.rig).unwrap_or_default()
            };
            wall_s.insert("lidar", start.elapsed().as_secs_f64());
            let returns = sweep.points.len();
            lidar_report = json!({ "rays": sweep.rays, "returns": returns, "dropped": sweep.rays - returns });
            let path = dir.join("lidar.ply");
            output::write_file(&path, &ply(&sweep))?;
            files.push(path);
            let path = dir.join("lidar.png");
            let top = picture::lidar_top(&sweep, 4);
            output::write_png(&path, top.width, top.height, &top.rgba)?;
            files.push(path);
        }
        if wants("bev") {
            let start = Instant::now();
            for (name, shot) in [
                ("bev.png", picture::layout_top(&frame, 4)),
                ("occupancy_top.png", picture::occupancy_top(&frame.occupancy, 4)),
            ] {
                let path = dir.join(name);
                output::write_png(&path, shot.width, shot.height, &shot.rgba)?;
                files.push(path);
            }
            wall_s.insert("bev", start.elapsed().as_secs_f64());
        }
        if wants("view") {
            let start = Instant::now();
            let path = dir.join("view.png");
            let shot = picture::View3d::new()?.shot(&scene, &Default::default())?;
            output::write_png(&path, shot.width, shot.height, &shot.rgba)?;
            files.push(path);
            wall_s.insert("view", start.elapsed().as_secs_f64());
        }
        let report = json!({ "files": files, "wall_s": wall_s, "lidar": lidar_report });
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
