//! Scenes from files and templates: what the command line and the window share.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail};
use glam::DVec2;

use super::around;
use crate::formats::opendrive::{self, RoadNetwork};
use crate::formats::{atomic, occ3d, project};
use crate::generation::world::scenery::{self, Setting, Side, Style};
use crate::generation::world::terrain::Terrain;
use crate::generation::world::voxelize::{Vertical, complete};
use crate::generation::world::{World, template, traffic};
use crate::scene::{Frame, Inferred, Scene, SensorRig, Unobserved, draft, infer};

/// A file with fewer things beside the road in view says nothing about the place: scenery is drawn.
const ENOUGH_THINGS: usize = 5;

/// Largest text file that is read, bytes.
const LARGEST_TEXT: u64 = 256 << 20;

/// The scene that ships with the program.
pub fn bundled() -> anyhow::Result<Scene> {
    let bytes = include_bytes!("../../assets/scenes/first_light.loom");
    project::from_bytes(bytes).context("the bundled scene")
}

/// A sensor rig from a JSON file.
pub fn rig(path: &Path) -> anyhow::Result<SensorRig> {
    let name = path.display();
    let text = std::fs::read_to_string(path).with_context(|| format!("read {name}"))?;
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

/// What a file is, found by content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A `.loom` project.
    Project,
    /// A frame of Occ3D labels.
    Occ3d,
    /// An OpenDRIVE road network.
    OpenDrive,
}

/// The kind of a file; anything that is no archive is taken for a road network.
pub fn kind(path: &Path) -> anyhow::Result<Kind> {
    let name = path.display();
    let mut head = Vec::new();
    let file = std::fs::File::open(path).with_context(|| format!("open {name}"))?;
    std::io::Read::read_to_end(&mut std::io::Read::take(file, 4), &mut head)
        .with_context(|| format!("read {name}"))?;
    let has_extension = |wanted: &str| path.extension().is_some_and(|e| e == wanted);
    let is_archive = head.starts_with(b"PK");
    Ok(
        if has_extension("npz") || (is_archive && !has_extension("loom") && is_npz(path)?) {
            Kind::Occ3d
        } else if is_archive || has_extension("loom") {
            Kind::Project
        } else {
            Kind::OpenDrive
        },
    )
}

fn is_npz(path: &Path) -> anyhow::Result<bool> {
    let bytes = std::fs::read(path).with_context(|| format!("read {}", path.display()))?;
    Ok(occ3d::is_npz(&bytes))
}

/// A scene from a file of any kind.
pub fn scene(path: &Path) -> anyhow::Result<Scene> {
    match kind(path)? {
        Kind::Project => Ok(project::load(path)?),
        Kind::Occ3d => labels(path),
        Kind::OpenDrive => Ok(import(path, &Placement::default())?.scene),
    }
}

/// A scene from labels: their voxels as they are, layout and boxes inferred.
pub fn labels(path: &Path) -> anyhow::Result<Scene> {
    let frame = occ3d::load(path).with_context(|| path.display().to_string())?;
    let (layout, boxes) = (infer::layout(&frame.labels), infer::boxes(&frame.labels));
    // Data sets name the folder after the frame and the file `labels`.
    let stem = path.file_stem().map(|s| s.to_string_lossy());
    let folder = path
        .parent()
        .and_then(Path::file_name)
        .map(|s| s.to_string_lossy());
    let name = match (&stem, &folder) {
        (Some(stem), Some(folder)) if stem == "labels" => folder,
        (Some(stem), _) => stem,
        (None, _) => &std::borrow::Cow::Borrowed("import"),
    };
    // A voxel was seen if any sensor that the file tells of saw it.
    let seen = match (frame.lidar_observed, frame.camera_observed) {
        (Some(lidar), Some(camera)) => Some(lidar.iter().zip(&camera).map(|(a, b)| *a || *b).collect()),
        (one, other) => one.or(other),
    };
    let inferred = Inferred {
        layout: true,
        boxes: boxes.keys().copied().collect(),
        unobserved: seen.and_then(|seen: Vec<bool>| Unobserved::from_observed(&seen)),
    };
    let frame = Frame {
        inferred,
        ..Frame::new(layout, boxes, frame.labels)
    };
    Ok(Scene::single(name, frame, Arc::new(SensorRig::default()), 0))
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
    /// Nothing beside the road but what the file puts there.
    pub bare: bool,
}

/// A scene made from a foreign file, and what was found in it.
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// Roads in the file.
    pub roads: usize,
    /// Lanes in the file.
    pub lanes: usize,
    /// Columns that are drivable although no traffic lane lies there, by the kind of lane.
    pub drivable_beside_traffic: BTreeMap<String, usize>,
    /// Bridges: roads of the file that cross above the ground.
    pub bridges: usize,
    /// Things that the file puts beside the road, bridges not counted.
    pub things_of_file: usize,
    /// What was not understood, counted by kind.
    pub skipped: BTreeMap<String, usize>,
    /// Where the ego stands in the file's frame: x, y in m and heading in rad.
    pub pose: (DVec2, f64),
}

/// Reads an OpenDRIVE file.
pub fn road_network(path: &Path) -> anyhow::Result<RoadNetwork> {
    let name = path.display();
    let size = std::fs::metadata(path)
        .with_context(|| format!("open {name}"))?
        .len();
    if size > LARGEST_TEXT {
        bail!("{name}: {size} bytes, expected at most {LARGEST_TEXT}");
    }
    let bytes = std::fs::read(path).with_context(|| format!("read {name}"))?;
    opendrive::read(&bytes).with_context(|| name.to_string())
}

/// Imports a road network: its layout with relief and seeded traffic, as a complete world. What stands beside the road is
/// the file's; procedural scenery is drawn around it if the file has hardly anything there. [`Placement::bare`] leaves
/// scenery out, and the occupancy is the draft until it is generated.
pub fn import(path: &Path, placement: &Placement) -> anyhow::Result<Imported> {
    let network = road_network(path)?;
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
    let seed = placement.seed;
    let boxes = traffic::place(&import.layout, seed, &spec);
    let things_of_file = import.background.len() - import.bridge_count;
    let stem = path.file_stem().map_or("import".into(), |s| s.to_string_lossy());
    let mut scene = if placement.bare {
        let occupancy = draft::draft(&import.layout, boxes.values());
        let frame = Frame::new(import.layout, boxes, occupancy);
        let mut scene = Scene::single(&stem, frame, Arc::new(SensorRig::default()), seed);
        scene.background = Arc::new(import.background);
        scene
    } else {
        let background = match things_of_file < ENOUGH_THINGS {
            true => {
                let drawn = scenery::background(&import.layout, &boxes, seed);
                around::merged(import.background, &drawn)
            }
            false => import.background,
        };
        of_world(
            &World::with_background(import.layout, boxes, background, seed),
            &stem,
        )
    };
    scene.seed = seed;
    Ok(Imported {
        scene,
        roads: import.road_count,
        lanes: import.lane_count,
        drivable_beside_traffic: import.drivable_beside_traffic,
        bridges: import.bridge_count,
        things_of_file,
        skipped: import.skipped,
        pose: (at, heading),
    })
}

/// A complete procedural world of a template: layout, traffic, occupancy. `None` for an unknown name.
pub fn from_template(name: &str, seed: u64) -> Option<Scene> {
    from_template_on(name, seed, None, Terrain::Flat)
}

/// The same in a setting (none: one that suits the road) and on a terrain.
pub fn from_template_on(name: &str, seed: u64, setting: Option<Setting>, terrain: Terrain) -> Option<Scene> {
    let mut layout = template::layout(name, seed)?;
    layout.relief = terrain.relief(&layout, seed);
    let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
    let style = match setting {
        Some(setting) => Style::both(Side::usual(setting)),
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

/// The files of a folder with this extension, at any depth, in the order of their names; an error if
/// there is none, which says `what` they should hold.
pub fn files_below(dir: &Path, extension: &str, what: &str) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut folders = vec![dir.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).with_context(|| format!("read {}", folder.display()))?;
        for entry in entries {
            let entry = entry.with_context(|| format!("read {}", folder.display()))?;
            // Links are not followed: one that leads upwards would never end.
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
mod tests {
    use super::*;
    use crate::scene::{BevLayer, Class, Form, GridSpec};

    /// A straight road of one lane on each side with these objects, written for this test.
    fn road(dir: &Path, objects: &str) -> PathBuf {
        let path = dir.join("a.xodr");
        let lane = r#"<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>"#;
        let text = format!(
            r#"<OpenDRIVE><road length="300" id="1" junction="-1"><planView>
            <geometry s="0" x="0" y="0" hdg="0" length="300"><line/></geometry></planView>
            <elevationProfile><elevation s="0" a="30" b="0.03" c="0" d="0"/></elevationProfile>
            <lanes><laneSection s="0"><left><lane id="1" type="driving">{lane}</left><center><lane id="0" type="none"/></center>
            <right><lane id="-1" type="driving">{lane}</right></laneSection></lanes><objects>{objects}</objects></road></OpenDRIVE>"#
        );
        std::fs::write(&path, text).unwrap();
        path
    }

    fn at(bare: bool) -> Placement {
        Placement {
            at_m: Some(DVec2::new(150.0, -1.75)),
            bare,
            ..Placement::default()
        }
    }

    #[test]
    fn an_import_is_a_whole_world_unless_it_is_bare() {
        let dir = tempfile::tempdir().unwrap();
        let house = r#"<object type="building" id="1" s="165" t="-18" length="14" width="9" height="9"/>"#;
        let path = road(dir.path(), house);
        let whole = import(&path, &at(false)).unwrap();
        assert_eq!((whole.things_of_file, whole.bridges), (1, 0));
        assert!(
            whole.scene.background.len() > 8,
            "{} things",
            whole.scene.background.len()
        );
        assert_eq!(whole.scene.background.problem(), None);
        let counts = whole.scene.frame().occupancy.class_counts();
        assert!(counts[Class::Manmade.id() as usize] > 200 && counts[Class::Vegetation.id() as usize] > 200);
        let again = import(&path, &at(false)).unwrap();
        assert_eq!(whole.scene.frame(), again.scene.frame());
        // What was drawn keeps clear of the house.
        let house = whole.scene.background.iter().next().unwrap();
        assert!(matches!(house.form, Form::Building(_)));
        let (min, max) = house.form.bounds_m();
        let in_house = |p: &DVec2| p.cmpgt(min).all() && p.cmplt(max).all();
        let others = whole.scene.background.iter().skip(1);
        assert!(others.flat_map(|t| t.form.points_m()).all(|p| !in_house(&p)));

        let bare = import(&path, &at(true)).unwrap();
        assert_eq!(bare.scene.background.len(), 1);
        assert_eq!(bare.scene.frame().layout, whole.scene.frame().layout);
        assert_eq!(bare.scene.frame().boxes, whole.scene.frame().boxes);
        // The road climbs by 3 %, 1 m over 34 m: two bins up in the draft.
        let frame = bare.scene.frame();
        assert!((frame.layout.relief.height_m(DVec2::new(30.0, 0.0)) - 0.9).abs() < 0.01);
        let [x, y] = GridSpec::column_at(30.0, 0.0).unwrap();
        assert!(frame.layout.has(BevLayer::DrivableArea, x, y));
        assert_eq!(frame.occupancy.get(x, y, 0), Class::FREE);
        assert_eq!(frame.occupancy.get(x, y, 2), Class::DriveableSurface.id());
    }

    #[test]
    fn a_furnished_file_gets_no_scenery() {
        let dir = tempfile::tempdir().unwrap();
        let trees = r#"<object type="tree" id="1" s="130" t="8" height="6"><repeat s="130" length="40" distance="10"/></object>"#;
        let imported = import(&road(dir.path(), trees), &at(false)).unwrap();
        assert_eq!(imported.things_of_file, 5);
        assert_eq!(imported.scene.background.len(), 5);
        assert!(imported.scene.background.iter().all(|t| t.form.name() == "tree"));
    }
}
