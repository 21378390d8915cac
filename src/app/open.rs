//! Scenes from files and templates: what the command line and the window share.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};
use glam::DVec2;

use crate::formats::{opendrive, project};
use crate::generation::world::voxelize::{Vertical, complete};
use crate::generation::world::{World, template, traffic};
use crate::scene::{Frame, Scene, SensorRig, draft};

/// Largest text file that is read, bytes.
const LARGEST_TEXT: u64 = 256 << 20;

/// The scene that ships with the program.
pub fn bundled() -> anyhow::Result<Scene> {
    let bytes = include_bytes!("../../assets/scenes/first_light.loom");
    project::from_bytes(bytes).context("the bundled scene")
}

/// A scene from a file, its kind found by content: a `.loom` project or an OpenDRIVE road network.
pub fn scene(path: &Path) -> anyhow::Result<Scene> {
    let name = path.display();
    let mut head = [0u8; 4];
    let size = std::fs::metadata(path)
        .with_context(|| format!("open {name}"))?
        .len();
    if size >= 4 {
        let mut file = std::fs::File::open(path).with_context(|| format!("open {name}"))?;
        std::io::Read::read_exact(&mut file, &mut head).with_context(|| format!("read {name}"))?;
    }
    if head.starts_with(b"PK") || path.extension().is_some_and(|e| e == "loom") {
        return Ok(project::load(path)?);
    }
    Ok(import(path, &Placement::default())?.scene)
}

/// Where and how a road network becomes a scene.
#[derive(Clone, Debug, Default)]
pub struct Placement {
    /// Ego position in the file's frame, m; none means a good place on a lane.
    pub at_m: Option<DVec2>,
    /// Ego heading in the file's frame, rad; none means along the lane.
    pub heading_rad: Option<f64>,
    /// Fixes the traffic.
    pub seed: u64,
    /// No vehicles and people.
    pub empty: bool,
}

/// A scene made from a foreign file, and what was found in it.
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// Roads in the file.
    pub roads: usize,
    /// Lanes in the file.
    pub lanes: usize,
    /// What was not understood, counted by kind.
    pub skipped: BTreeMap<String, usize>,
    /// Where the ego stands in the file's frame: x, y in m and heading in rad.
    pub pose: (DVec2, f64),
}

/// Imports a road network: its layout, seeded traffic, and the draft as occupancy until it is generated.
pub fn import(path: &Path, placement: &Placement) -> anyhow::Result<Imported> {
    let name = path.display();
    let size = std::fs::metadata(path)
        .with_context(|| format!("open {name}"))?
        .len();
    if size > LARGEST_TEXT {
        bail!("{name}: {size} bytes, expected at most {LARGEST_TEXT}");
    }
    let bytes = std::fs::read(path).with_context(|| format!("read {name}"))?;
    let network = opendrive::read(&bytes).with_context(|| name.to_string())?;
    let (at, lane_heading) = match placement.at_m {
        Some(at) => network
            .pose_on_lane_near(at)
            .map_or((at, 0.0), |pose| (at, pose.heading_rad)),
        None => network.suggest_pose(),
    };
    let heading = placement.heading_rad.unwrap_or(lane_heading);
    let import = network.to_layout(at, heading);
    let spec = if placement.empty {
        traffic::TrafficSpec::EMPTY
    } else {
        traffic::TrafficSpec::NORMAL
    };
    let boxes = traffic::place(&import.layout, placement.seed, &spec);
    let occupancy = draft::draft(&import.layout, boxes.values());
    let stem = path.file_stem().map_or("import".into(), |s| s.to_string_lossy());
    let frame = Frame::new(import.layout, boxes, occupancy);
    let scene = Scene::single(&stem, frame, Arc::new(SensorRig::default()), placement.seed);
    Ok(Imported {
        scene,
        roads: import.road_count,
        lanes: import.lane_count,
        skipped: import.skipped,
        pose: (at, heading),
    })
}

/// A complete procedural world of a template: layout, traffic, occupancy. `None` for an unknown name.
pub fn from_template(name: &str, seed: u64) -> Option<Scene> {
    let layout = template::layout(name, seed)?;
    let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
    let world = World::new(layout, boxes, seed);
    let occupancy = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    Some(Scene::single(name, frame, Arc::new(SensorRig::default()), seed))
}
