//! The memory of scenes as the program fills it: the bank that ships, the user's own scenes, and the roads of entries.

use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;

use super::open;
use formats::opendrive::{self, RoadNetwork};
use graph_layout::memory::{Bank, RememberedScene, RoadRef, VERSION};
use scene::{BevLayer, BevLayout, Window};
use world::draw::{Draw, hash};
use world::{template, traffic};

/// The project's own roads.
const ROADS: [(&str, &[u8]); 6] = [
    ("every_geometry.xodr", assets::roads::EVERY_GEOMETRY),
    ("four_arm_junction.xodr", assets::roads::FOUR_ARM_JUNCTION),
    ("left_hand_bend.xodr", assets::roads::LEFT_HAND_BEND),
    ("motorway_exit.xodr", assets::roads::MOTORWAY_EXIT),
    ("parking_street.xodr", assets::roads::PARKING_STREET),
    ("straight_two_way.xodr", assets::roads::STRAIGHT_TWO_WAY),
];
/// Share of the bank's entries on these roads.
const SHARE: f64 = 0.25;
/// Least share of a place's map that is drivable.
const LEAST_DRIVABLE: f64 = 0.08;

/// The layout of an entry's road. Errors name the file that could not be read.
pub fn layout_of(road: &RoadRef) -> anyhow::Result<BevLayout> {
    match road {
        RoadRef::Template { name, .. } => road
            .layout()
            .with_context(|| format!("template {name:?} is not known")),
        RoadRef::Imported {
            file,
            position_m,
            heading_rad,
        } => {
            let network = match ROADS.iter().find(|(name, _)| name == file) {
                Some((name, bytes)) => opendrive::read(bytes).with_context(|| (*name).to_owned())?,
                None => open::road_network(Path::new(file))?,
            };
            Ok(network.to_layout(*position_m, *heading_rad).layout)
        }
        RoadRef::Scene { path } => Ok(open::scene(Path::new(path))?.frame().layout.clone()),
    }
}

/// Entry `index` of the bank of `seed`: a street with traffic, a quarter of them on the project's own roads.
fn entry(seed: u64, index: u64, networks: &[(&str, RoadNetwork)]) -> Option<RememberedScene> {
    let seed = hash(hash(seed) ^ index);
    let mut draw = Draw::new(seed, "memory");
    let (layout, road) = if draw.chance(SHARE) && !networks.is_empty() {
        let (name, network) = &networks[draw.below(networks.len())];
        let lengths: Vec<f64> = network.roads.iter().map(|r| r.length_m()).collect();
        let on = network.roads.get(draw.weighted(&lengths))?;
        let near = on.reference.at(draw.range(0.0, on.length_m())).position_m;
        let pose = network.pose_on_lane_near(near)?;
        let layout = network.to_layout(pose.position_m, pose.heading_rad).layout;
        let file = (*name).to_owned();
        let (position_m, heading_rad) = (pose.position_m, pose.heading_rad);
        (
            layout,
            RoadRef::Imported {
                file,
                position_m,
                heading_rad,
            },
        )
    } else {
        let name = template::TEMPLATES[draw.below(template::TEMPLATES.len())];
        let seed = draw.bits() >> 11; // a JSON number holds 53 bits
        let name = name.to_owned();
        (template::layout(&name, seed)?, RoadRef::Template { name, seed })
    };
    let drivable = layout.count(BevLayer::DrivableArea) as f64 / Window::COLUMNS as f64;
    let spec = traffic::TrafficSpec {
        vehicles: draw.range(0.1, 1.4),
        people: draw.range(0.1, 1.2),
        works: draw.range(0.0, 1.6),
    };
    let boxes = traffic::place(&layout, seed, &spec);
    (drivable >= LEAST_DRIVABLE).then(|| RememberedScene::new("", &layout, &boxes, road, seed))
}

/// A bank of `count` scenes; the same arguments give the same bank.
pub fn make_bank(count: usize, seed: u64) -> anyhow::Result<Bank> {
    let networks: anyhow::Result<Vec<_>> = ROADS
        .iter()
        .map(|(name, bytes)| Ok((*name, opendrive::read(bytes).with_context(|| (*name).to_owned())?)))
        .collect();
    let networks = networks?;
    // Some places have too little road: a third more places are tried.
    let made: Vec<Option<RememberedScene>> = (0..count + count / 3 + 1)
        .into_par_iter()
        .map(|i| entry(seed, i as u64, &networks))
        .collect();
    Ok(Bank {
        version: VERSION,
        entries: made.into_iter().flatten().take(count).collect(),
    })
}

/// Entries of every .loom file below a folder, and one line for each that could not be read.
pub fn own_scenes(folder: &Path) -> (Vec<RememberedScene>, Vec<String>) {
    let files = match open::files_below(folder, "loom", "scenes") {
        Ok(files) => files,
        Err(e) => return (Vec::new(), vec![format!("{e:#}")]),
    };
    let (mut entries, mut problems) = (Vec::new(), Vec::new());
    for path in files {
        match open::scene(&path) {
            Ok(scene) => {
                let (frame, path) = (scene.frame(), path.display().to_string());
                let road = RoadRef::Scene { path };
                entries.push(RememberedScene::new(
                    &scene.prompt,
                    &frame.layout,
                    &frame.boxes,
                    road,
                    scene.seed,
                ));
            }
            Err(e) => problems.push(format!("{e:#}")),
        }
    }
    (entries, problems)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bank_is_repeatable_and_its_roads_can_be_made_again() {
        let bank = make_bank(12, 7).expect("own roads");
        assert_eq!(bank.entries.len(), 12);
        assert_eq!(bank, make_bank(12, 7).expect("own roads"));
        let text = serde_json::to_string(&bank).expect("serializable");
        assert_eq!(Bank::parse(&text).expect("readable"), bank);
        for entry in &bank.entries {
            let layout = layout_of(&entry.road).expect("a road");
            assert!(layout.count(BevLayer::DrivableArea) > 1000);
            assert_eq!(entry.graph(&layout).problem(), None);
            assert!(entry.boxes().values().all(|b| b.problem().is_none()));
        }
        assert!(Bank::parse("{").is_err() && Bank::parse("{\"version\":9,\"entries\":[]}").is_err());
    }

    #[test]
    fn own_scenes_are_remembered() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(own_scenes(folder.path()).0.len(), 0);
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../assets/scenes/first_light.loom");
        std::fs::copy(from, folder.path().join("mine.loom")).expect("copied");
        std::fs::write(folder.path().join("bad.loom"), "nothing").expect("written");
        let (entries, problems) = own_scenes(folder.path());
        assert_eq!((entries.len(), problems.len()), (1, 1), "{problems:?}");
        assert!(
            !problems[0].contains('\n') && problems[0].contains("bad.loom"),
            "{problems:?}"
        );
        layout_of(&entries[0].road).expect("the scene's own layout");
    }
}
