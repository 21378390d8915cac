//! Scenes from files and templates: shared by the command line and the window.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail};
use glam::DVec2;

use super::{large, read, scenery_around};
use formats::import::{self, Content, ImportOptions};
use formats::opendrive::RoadNetwork;
use formats::{atomic, input, loom};
use scene::{Extent, Frame, Lattice, Scene, SensorRig, Window, draft};
use world::scenery::{self, RoadsideKind, RoadsideStyle, Style};
use world::terrain::Terrain;
use world::voxelize::{Vertical, complete};
use world::{World, template, traffic};

/// Number of things beside the road in view below which a file does not describe the place, so that scenery is drawn.
const ENOUGH_THINGS: usize = 5;

/// The scene that ships with the program.
pub fn bundled() -> anyhow::Result<Scene> {
    let bytes = assets::scenes::FIRST_LIGHT;
    loom::from_bytes(bytes).context("the bundled scene")
}

/// A sensor rig from a JSON file.
pub fn rig(path: &Path) -> anyhow::Result<SensorRig> {
    let name = path.display();
    let text = input::read_text(path, input::LARGEST_TEXT)?;
    let rig: SensorRig = serde_json::from_str(&text).with_context(|| name.to_string())?;
    match rig.problem() {
        Some(problem) => bail!("{name}: {problem}"),
        None => Ok(rig),
    }
}

/// Writes a sensor rig as JSON.
pub fn save_rig(rig: &SensorRig, path: &Path) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(rig).context("the sensors")?;
    atomic::write(path, text.as_bytes()).with_context(|| format!("write {}", path.display()))
}

/// A scene from a file, with notes for the user on how it was read.
pub struct OpenedScene {
    /// The scene.
    pub scene: Scene,
    /// Changes made without being asked for, one line each.
    pub notes: Vec<String>,
}

impl From<Scene> for OpenedScene {
    fn from(scene: Scene) -> Self {
        Self {
            scene,
            notes: Vec::new(),
        }
    }
}

/// A scene from a file of any format that is read, see [`formats::import`].
pub fn scene(path: &Path) -> anyhow::Result<Scene> {
    Ok(file(path)?.scene)
}

/// The scene of a file, with notes on how it was read.
pub fn file(path: &Path) -> anyhow::Result<OpenedScene> {
    match read::file_with(path, ImportOptions::default())?.1 {
        Content::Scene(loaded) => Ok(OpenedScene {
            scene: loaded.scene,
            notes: loaded.notes,
        }),
        Content::Roads(network) => Ok(
            on_roads(*network, &import::scene_name(path), &Placement::default())
                .scene
                .into(),
        ),
        Content::Recipe(_) => bail!(
            "{}: words to make a scene of, expected a scene: import it first",
            path.display()
        ),
    }
}

/// A scene from Occ3D labels: their voxels, in those of the networks, layout, boxes and background inferred.
pub fn labels(path: &Path) -> anyhow::Result<Scene> {
    match import::read_as(&import::occ3d::IMPORTER, path)? {
        Content::Scene(loaded) => Ok(loaded.scene.in_lattice(Lattice::OCC3D).into_owned()),
        _ => bail!("{}: roads or words, expected labels", path.display()),
    }
}

/// Options for making a scene from a road network.
#[derive(Clone, Debug, Default)]
pub struct Placement {
    /// Ego position in the file's frame, m; none means a good place on a lane.
    pub at_m: Option<DVec2>,
    /// Ego heading in the file's frame, rad; none means along the lane.
    pub heading_rad: Option<f64>,
    /// Length along the heading and width of the map, m; none means the networks' window.
    pub size_m: Option<[f64; 2]>,
    /// True for a map that holds the whole network, whatever size was asked for.
    pub whole: bool,
    /// Seed of the traffic.
    pub seed: u64,
    /// True for no vehicles and people.
    pub empty: bool,
    /// True for no scenery beyond that of the file.
    pub bare: bool,
}

/// Distance behind the ego vehicle at which a long map begins, m.
const BEHIND_M: f64 = 60.0;

impl Placement {
    /// Largest side of a map, m.
    pub const MAX_SIZE_M: f64 = 3200.0;

    /// The map in the ego frame: around the ego vehicle, most of a long one ahead of it; or the whole network, seen
    /// from a place and heading (m, rad) of its frame.
    pub fn extent(&self, network: &RoadNetwork, from: (DVec2, f64)) -> Extent {
        // A file that Sceneloom wrote states its map itself.
        if self.size_m.is_none()
            && let Some(own) = network.own_extent(from.0, from.1)
        {
            return own;
        }
        if self.whole {
            return whole_extent(network, from).unwrap_or(Extent::WINDOW);
        }
        let Some([length_m, width_m]) = self.size_m else {
            return Extent::WINDOW;
        };
        let columns = |m: f64| {
            (m * Lattice::OCC3D.per_m())
                .round()
                .clamp(1.0, Extent::MAX_SIDE as f64) as usize
        };
        let (nx, ny) = (columns(length_m), columns(width_m));
        let behind = columns((length_m / 2.0).min(BEHIND_M)) as i32;
        Extent::new([-behind, -(ny as i32 / 2)], [nx, ny]).unwrap_or(Extent::WINDOW)
    }

    /// The first problem with it on a network, in one line; `None` if it is sound.
    pub fn problem_on(&self, network: &RoadNetwork) -> Option<String> {
        match self.whole {
            true => whole_extent(
                network,
                (
                    self.at_m.unwrap_or_default(),
                    self.heading_rad.unwrap_or_default(),
                ),
            )
            .err(),
            false => self.problem(),
        }
    }

    /// The problem with its size, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let [length_m, width_m] = self.size_m?;
        // Written so that NaN fails too.
        let sound = |m: f64| (20.0..=Self::MAX_SIZE_M).contains(&m);
        let fits = length_m * width_m * 6.25 <= Extent::MAX_COLUMNS as f64;
        (!(sound(length_m) && sound(width_m) && fits)).then(|| {
            format!(
                "a map of {length_m} x {width_m} m, expected sides of 20 to {} m and at most {:.1} km²",
                Self::MAX_SIZE_M,
                Extent::MAX_COLUMNS as f64 / 6.25e6
            )
        })
    }
}

/// Margin around the roads of a whole network, m.
const MARGIN_M: f64 = 24.0;

/// The map that holds all roads, seen from a place and heading of the file's frame. Errors if it would be too large.
fn whole_extent(network: &RoadNetwork, (at_m, heading_rad): (DVec2, f64)) -> Result<Extent, String> {
    let back = DVec2::from_angle(-heading_rad);
    let (low, high) = network.bounds_from(|p| back.rotate(p - at_m));
    let column = |m: f64| (m / Window::VOXEL_M).floor().clamp(-1e8, 1e8) as i32;
    let from = (low - MARGIN_M).to_array().map(column);
    let to = (high + MARGIN_M).to_array().map(column);
    let size = [0, 1].map(|axis| (i64::from(to[axis]) - i64::from(from[axis]) + 1).max(1) as usize);
    Extent::new(from, size).map_err(|problem| format!("all of the network is {problem}"))
}

/// A scene made from a foreign file, with statistics of the file.
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// Roads in the file.
    pub roads: usize,
    /// Lanes in the file.
    pub lanes: usize,
    /// Columns that are drivable without a traffic lane, by the kind of lane.
    pub drivable_beside_traffic: BTreeMap<String, usize>,
    /// True if the layout is the one that Sceneloom wrote the file from, to the last cell.
    pub is_own: bool,
    /// Bridges: roads of the file that cross above the ground.
    pub bridges: usize,
    /// Things that the file puts beside the road, bridges not counted.
    pub things_of_file: usize,
    /// Things of procedural scenery that were left out because a scene cannot hold so many.
    pub scenery_left_out: usize,
    /// Parts of the file that were not understood, counted by kind.
    pub skipped: BTreeMap<String, usize>,
    /// Place of the ego in the file's frame: x, y in m and heading in rad.
    pub pose: (DVec2, f64),
}

/// Reads an OpenDRIVE file.
pub fn road_network(path: &Path) -> anyhow::Result<RoadNetwork> {
    match import::read_as(&import::opendrive::IMPORTER, path)? {
        Content::Roads(network) => Ok(*network),
        _ => bail!("{}: a scene, expected roads", path.display()),
    }
}

/// Imports a road network from a file, see [`on_roads`].
pub fn import(path: &Path, placement: &Placement) -> anyhow::Result<Imported> {
    Ok(on_roads(
        road_network(path)?,
        &import::scene_name(path),
        placement,
    ))
}

/// A scene on a road network: its layout with relief and the file's traffic, seeded if it has none, as a complete
/// world. The scenery is the file's; procedural scenery is drawn around it if the file has hardly any.
/// [`Placement::bare`] leaves scenery out, and the occupancy is the draft until it is generated.
pub fn on_roads(network: RoadNetwork, name: &str, placement: &Placement) -> Imported {
    let (at, lane_heading) = match placement.at_m {
        Some(at) => network
            .pose_on_lane_near(at)
            .map_or((at, 0.0), |pose| (at, pose.heading_rad)),
        None => network.suggest_pose(),
    };
    let heading = placement.heading_rad.unwrap_or(lane_heading);
    let extent = placement.extent(&network, (at, heading));
    let import = network.to_layout_over(extent, at, heading);
    let spec = if placement.empty {
        traffic::TrafficSpec::EMPTY
    } else {
        traffic::TrafficSpec::NORMAL
    };
    let seed = placement.seed;
    let boxes = match import.boxes.is_empty() || placement.empty {
        true => traffic::place(&import.without_lanes_of_junctions(), seed, &spec),
        false => import.boxes.clone(), // the file's own
    };
    let things_of_file = import.background.len() - import.bridge_count;
    let mut scenery_left_out = 0;
    let mut scene = if placement.bare {
        let occupancy = draft::draft(&import.layout, boxes.values());
        let frame = Frame::new(import.layout, boxes, occupancy);
        let mut scene = Scene::single(name, frame, Arc::new(SensorRig::default()), seed);
        scene.background = Arc::new(import.background);
        scene
    } else {
        let is_bare = things_of_file < ENOUGH_THINGS;
        if extent == Extent::WINDOW {
            let background = match is_bare {
                true => {
                    let drawn = scenery::background(&import.layout, &boxes, seed);
                    scenery_around::merged(extent, import.background, &drawn)
                }
                false => import.background,
            };
            of_world(
                &World::with_background(import.layout, boxes, background, seed),
                name,
            )
        } else {
            let background = match is_bare {
                true => {
                    let (background, left_out) =
                        large::scenery_over(&import.layout, &boxes, import.background, seed);
                    scenery_left_out = left_out;
                    background
                }
                false => import.background,
            };
            let occupancy = large::occupancy_over(&import.layout, &boxes, &background, seed);
            let frame = Frame::new(import.layout, boxes, occupancy);
            let mut scene = Scene::single(name, frame, Arc::new(SensorRig::default()), seed);
            scene.background = Arc::new(background);
            scene
        }
    };
    scene.seed = seed;
    Imported {
        scene,
        roads: import.road_count,
        lanes: import.lane_count,
        drivable_beside_traffic: import.drivable_beside_traffic,
        is_own: import.is_own,
        bridges: import.bridge_count,
        things_of_file,
        scenery_left_out,
        skipped: import.skipped,
        pose: (at, heading),
    }
}

/// A complete procedural world of a template: layout, traffic, occupancy. `None` for an unknown name.
pub fn from_template(name: &str, seed: u64) -> Option<Scene> {
    from_template_on(name, seed, None, Terrain::Flat)
}

/// A complete procedural world of a template, in a setting (none: one that suits the road) and on a terrain.
pub fn from_template_on(
    name: &str,
    seed: u64,
    setting: Option<RoadsideKind>,
    terrain: Terrain,
) -> Option<Scene> {
    let mut layout = template::layout(name, seed)?;
    layout.relief = terrain.relief(&layout, seed);
    let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
    let style = match setting {
        Some(setting) => Style::both(RoadsideStyle::usual(setting)),
        None => Style::drawn(&layout, seed),
    };
    let background = scenery::background_of(&layout, &boxes, &style, seed);
    let world = World::with_background(layout, boxes, background, seed);
    let mut scene = of_world(&world, name);
    scene.seed = seed;
    Some(scene)
}

/// A world as a scene: every voxel of it, and its background as things.
pub fn of_world(world: &World, name: &str) -> Scene {
    let occupancy = complete(world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    let rig = Arc::new(SensorRig::default());
    let mut scene = Scene::single(name, frame, rig, world.seed());
    scene.background = Arc::new(world.background.clone());
    scene
}

/// The files of a folder with this extension, at any depth, in the order of their names. Errors if there are none; the
/// error names `what` they should hold.
pub fn files_below(dir: &Path, extension: &str, what: &str) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut folders = vec![dir.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).with_context(|| format!("read {}", folder.display()))?;
        for entry in entries {
            let entry = entry.with_context(|| format!("read {}", folder.display()))?;
            // Links are not followed: a link to a folder above would never end.
            if entry.file_type().is_ok_and(|t| t.is_dir()) {
                folders.push(entry.path());
            } else if entry.path().extension().is_some_and(|e| e == extension) {
                found.push(entry.path());
            }
        }
    }
    if found.is_empty() {
        bail!("{}: no .{extension} files, expected {what}", dir.display());
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
#[path = "open_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "open_background_tests.rs"]
mod background_tests;

#[cfg(test)]
#[path = "open_objects_tests.rs"]
mod objects_tests;
