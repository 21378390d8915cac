//! `sceneloom render`: what the sensors see, as pictures and as data.

mod write;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use serde_json::json;

use super::{Common, Outcome, output};
use crate::camera_views::march;
use crate::graphics::{Graphics, OnCard};
use crate::{open, picture};
use nets::lidar::LidarNet;
use scene::sensor_data::Planes;
use scene::{CameraMaps, LidarSweep, Scene, TimeOfDay, Weather};
use sensors::appearance::{CameraImage, Quality, RayMarched, SynthesisInput, ViewSynthesizer};
use sensors::learned::{self, Drops};
use sensors::splat::{self, GaussianCloud, SplatOptions};
use sensors::{lidar, mpi, perspective};
use write::Writer;

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
    /// What classes and depths are rendered from: Gaussians, exact rays to the voxels, or those with boxes as shapes.
    #[arg(long, value_name = "NAME", value_parser = ["splats", "voxels", "shapes"], default_value = "splats")]
    source: String,
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
    common: Common,
}

/// `WxH`, each 1 to 8192.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides: Option<Vec<u32>> = text.split('x').map(|v| v.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[w, h]) if (1..=8192).contains(&w) && (1..=8192).contains(&h) => Ok([w, h]),
        _ => Err("expected WxH, each 1 to 8192 pixels".into()),
    }
}

/// The six cameras' maps and the LiDAR sweep of a scene.
pub fn sense(scene: &Scene, size: [u32; 2]) -> (Vec<CameraMaps>, LidarSweep) {
    let sweep = lidar::rig_sweep(&scene.frame().occupancy, &scene.rig).unwrap_or_default();
    (splats(scene, size), sweep)
}

fn splats(scene: &Scene, [width, height]: [u32; 2]) -> Vec<CameraMaps> {
    let frame = scene.frame();
    let cloud = GaussianCloud::from_grid(&frame.occupancy, &frame.bev_channels());
    splat::render_rig(&cloud, &scene.rig, width, height, &SplatOptions::default())
}

impl Render {
    fn maps(&self, scene: &Scene) -> Vec<CameraMaps> {
        let [width, height] = self.size;
        match self.source.as_str() {
            "splats" => splats(scene, self.size),
            source => march(scene, source == "shapes").render_rig(&scene.rig, width, height),
        }
    }

    fn appearance(&self, scene: &Scene) -> anyhow::Result<Vec<CameraImage>> {
        let own = scene.conditions;
        let timed = self.time.map_or(own, |time| own.at(time));
        // The same bytes on every machine, unless a card is asked for.
        let marched: Box<dyn ViewSynthesizer> = match Graphics::forced() {
            Some(card) => Box::new(OnCard::new(card)),
            None => Box::new(RayMarched),
        };
        let images = marched.synthesize(&SynthesisInput {
            frame: scene.frame(),
            rig: &scene.rig,
            size: self.size,
            prompt: &scene.prompt,
            conditions: self.weather.map_or(timed, |weather| timed.under(weather)),
            quality: if self.preview {
                Quality::Preview
            } else {
                Quality::Full
            },
        })?;
        Ok(images)
    }

    fn sweep(&self, scene: &Scene) -> anyhow::Result<LidarSweep> {
        if scene.rig.lidars.is_empty() {
            bail!("the rig {:?} has no lidar", scene.rig.name);
        }
        let occupancy = &scene.frame().occupancy;
        if self.lidar == "exact" {
            return Ok(lidar::rig_sweep(occupancy, &scene.rig).unwrap_or_default());
        }
        let net = LidarNet::bundled().context("the LiDAR network")?;
        learned::rig_sweep(&net, occupancy, &scene.rig, Drops::Likely).context("the LiDAR network")
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
        let mut writer = Writer::new(&self.output)?;
        let mut wall_s = BTreeMap::new();
        let mut lidar_report = serde_json::Value::Null;
        let wants = |kind: &str| self.what.iter().any(|w| w == kind);
        let frame = scene.frame().clone();
        let [width, height] = self.size;
        if wants("semantic") || wants("depth") {
            let start = Instant::now();
            let maps = self.maps(&scene);
            wall_s.insert("cameras", start.elapsed().as_secs_f64());
            for maps in &maps {
                writer.maps(maps, wants("semantic"), wants("depth"))?;
            }
        }
        if wants("appearance") {
            let start = Instant::now();
            let images = self.appearance(&scene)?;
            wall_s.insert("appearance", start.elapsed().as_secs_f64());
            writer.appearance(images)?;
        }
        if wants("perspective") {
            let start = Instant::now();
            let cameras = scene.rig.cameras.iter();
            let maps: Vec<_> = cameras
                .map(|c| perspective::render(&frame.layout, frame.boxes.values(), c, width, height))
                .collect();
            wall_s.insert("perspective", start.elapsed().as_secs_f64());
            maps.iter().try_for_each(|map| writer.perspective(map))?;
        }
        if wants("mpi") {
            let start = Instant::now();
            let ids = mpi::RenderIds::new(&frame.occupancy, &frame.bev_channels());
            let cameras = scene.rig.cameras.iter();
            let images: Vec<_> = cameras
                .map(|c| mpi::render(&ids, c, width, height, Planes::default()))
                .collect();
            wall_s.insert("mpi", start.elapsed().as_secs_f64());
            images.iter().try_for_each(|image| writer.planes(image))?;
        }
        if wants("lidar") {
            let start = Instant::now();
            let sweep = self.sweep(&scene)?;
            wall_s.insert("lidar", start.elapsed().as_secs_f64());
            let returns = sweep.points.len();
            lidar_report = json!({ "rays": sweep.rays, "returns": returns, "dropped": sweep.rays - returns });
            writer.lidar(&sweep)?;
        }
        if wants("bev") {
            let start = Instant::now();
            writer.picture("bev.png", &picture::layout_top(&frame, 4))?;
            writer.picture("occupancy_top.png", &picture::occupancy_top(&frame.occupancy, 4))?;
            wall_s.insert("bev", start.elapsed().as_secs_f64());
        }
        if wants("view") {
            let start = Instant::now();
            let shot = picture::View3d::new()?.shot(&scene, &Default::default())?;
            writer.picture("view.png", &shot)?;
            wall_s.insert("view", start.elapsed().as_secs_f64());
        }
        let files = writer.files;
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
