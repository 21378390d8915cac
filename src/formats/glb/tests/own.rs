//! Scenes of ours, as they were written and after a stay elsewhere.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{BevLayer, BoxId, Class, Extent, Scene, SceneBox, SensorRig};
use serde_json::{Value, json};

use super::{Blocks, read, refusal, text};
use crate::export;
use crate::glb::container;
use crate::import::ImportedScene;
use crate::recipe::Recipe;
use crate::table_tests::random_scene;

fn to_bytes(scene: &Scene) -> Result<Vec<u8>, crate::FormatError> {
    export::glb::to_bytes(scene, &Recipe::of(scene))
}

/// A file of ours as JSON and bytes, to be edited as other programs do.
fn edited(bytes: &[u8], edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let chunks = container::split(bytes).expect("ours");
    let mut document: Value = serde_json::from_slice(chunks.json).expect("JSON");
    edit(&mut document);
    container::join(&text(&document), chunks.bin.unwrap_or_default()).expect("small")
}

fn node<'a>(document: &'a mut Value, name: &str) -> &'a mut Value {
    let nodes = document["nodes"].as_array_mut().expect("nodes");
    nodes.iter_mut().find(|n| n["name"] == name).expect("that node")
}

#[test]
fn maps_of_other_extents_come_back() {
    let extent = Extent::new([-317, 45], [230, 480]).expect("sound");
    let mut layout = scene::BevLayout::over(extent);
    let mut occupancy = scene::VoxelGrid::over(extent);
    for [x, y] in extent.all_columns() {
        occupancy.set(x, y, 0, if y % 90 < 30 { 11 } else { 14 });
        layout.set(BevLayer::DrivableArea, x, y, y % 90 < 30);
        if (x / 7 + y / 5) % 11 == 0 {
            (1..1 + (x + y) % 9).for_each(|z| occupancy.set(x, y, z, 15));
        }
    }
    let frame = scene::Frame::new(layout, Default::default(), occupancy);
    let mut map = Scene::single("a \"map\"", frame, Arc::new(SensorRig::default()), u64::MAX);
    map.prompt = "rain\nand fog".into();
    map.words = Arc::new(vec!["a road".into(), "a house".into()]);
    map.conditions.seed = 3;
    let back = read(&to_bytes(&map).expect("sound"));
    assert!(back.scene.frame().occupancy == map.frame().occupancy && back.skipped.is_empty());
    assert_eq!(
        (&back.scene.name, &back.scene.prompt, back.scene.seed),
        (&map.name, &map.prompt, u64::MAX)
    );
    assert_eq!(
        (&back.scene.words, back.scene.conditions),
        (&map.words, map.conditions)
    );
    let layout = &back.scene.frame().layout;
    assert_eq!(layout.extent(), extent);
    assert!(layout.has(BevLayer::DrivableArea, 3, 100) && !layout.has(BevLayer::DrivableArea, 3, 50));
}

#[test]
fn the_same_scene_is_the_same_bytes() {
    let files: BTreeSet<Vec<u8>> = (0..3)
        .map(|_| to_bytes(&random_scene(5)).expect("sound"))
        .collect();
    assert_eq!(files.len(), 1);
}

/// A car of voxels on a road.
fn car_on_a_road() -> Scene {
    let mut scene = crate::table_tests::scene();
    let b = SceneBox {
        id: BoxId(4),
        class: Class::Car,
        center_m: DVec3::new(10.0, 4.0, 0.8),
        size_m: DVec3::new(4.8, 2.0, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::new(5.0, 0.0),
        label: Default::default(),
    };
    scene.change(Default::default(), |frame| {
        frame.occupancy = scene::VoxelGrid::new();
        (0..200).for_each(|x| (90..115).for_each(|y| frame.occupancy.set(x, y, 0, 11)));
        for (x, y, layers) in scene::draft::box_columns(frame.extent(), &b) {
            (0..layers).for_each(|z| frame.occupancy.set(x, y, z, 4));
        }
        frame.boxes = [(b.id, b)].into();
    });
    scene
}

#[test]
fn what_is_moved_copied_or_deleted_elsewhere_reads_back_as_it_is_seen() {
    let scene = car_on_a_road();
    let bytes = to_bytes(&scene).expect("sound");
    let cars = |loaded: &ImportedScene| -> Vec<[usize; 3]> {
        let all = loaded.scene.frame().occupancy.iter_set();
        all.filter(|v| v.3 == 4).map(|(x, y, z, _)| [x, y, z]).collect()
    };
    let before = cars(&read(&bytes));
    // Moved by whole voxels: 10 ahead, 5 to the right, in the axes below the root.
    let moved = edited(&bytes, |d| {
        node(d, "car 4")["translation"] = json!([14.0, 2.0, 0.8])
    });
    let loaded = read(&moved);
    let there: Vec<[usize; 3]> = before.iter().map(|[x, y, z]| [x + 10, y - 5, *z]).collect();
    assert_eq!(cars(&loaded), there);
    let b = loaded.scene.frame().boxes[&BoxId(4)];
    assert!((b.center_m - DVec3::new(14.0, 2.0, 0.8)).length() < 1e-6 && b.velocity_mps.x == 5.0);
    // The road is whole where the car was: it is a mesh of its own.
    let road = loaded.scene.frame().occupancy.get(125, 110, 0);
    assert_eq!(road, Class::FREE, "nothing was below the car");
    // Turned by a quarter and twice as long.
    let turned = edited(&bytes, |d| {
        let node = node(d, "car 4");
        node["rotation"] = json!([0.0, 0.0, 0.5f64.sqrt(), 0.5f64.sqrt()]);
        node["scale"] = json!([2.0, 1.0, 1.0]);
    });
    let loaded = read(&turned);
    let b = loaded.scene.frame().boxes[&BoxId(4)];
    assert!((b.yaw_rad.to_degrees() - 90.0).abs() < 1e-4 && (b.size_m.x - 9.6).abs() < 1e-5);
    assert!(b.velocity_mps.distance(DVec2::new(0.0, 5.0)) < 1e-5);
    let of = |axis: usize| {
        cars(&loaded)
            .iter()
            .map(|v| v[axis])
            .collect::<BTreeSet<_>>()
            .len()
    };
    assert!(of(1) >= 23 && of(0) <= 6, "{} x {}", of(0), of(1));
    // A copy has an id of its own, and what is deleted is gone.
    let copied = edited(&bytes, |d| {
        let mut copy = node(d, "car 4").clone();
        copy["name"] = json!("car 4.001");
        copy["translation"] = json!([-20.0, 4.0, 0.8]);
        let nodes = d["nodes"].as_array_mut().expect("nodes");
        nodes.push(copy);
        let at = nodes.len() - 1;
        node(d, "boxes")["children"]
            .as_array_mut()
            .expect("children")
            .push(json!(at));
    });
    let loaded = read(&copied);
    assert_eq!(
        loaded
            .scene
            .frame()
            .boxes
            .keys()
            .map(|id| id.0)
            .collect::<Vec<_>>(),
        [1, 4]
    );
    assert_eq!(cars(&loaded).len(), 2 * before.len());
    let deleted = edited(&bytes, |d| node(d, "boxes")["children"] = json!([]));
    let loaded = read(&deleted);
    assert!(loaded.scene.frame().boxes.is_empty() && cars(&loaded).is_empty());
}

#[test]
fn parts_that_were_cut_off_and_things_that_were_added_are_seen() {
    let bytes = to_bytes(&car_on_a_road()).expect("sound");
    // The last rectangle of the road's upper side is gone: there its lower side is seen.
    let cut = edited(&bytes, |d| {
        let mesh = node(d, "driveable_surface")["mesh"].as_u64().expect("a mesh") as usize;
        let indices = d["meshes"][mesh]["primitives"][0]["indices"]
            .as_u64()
            .expect("indices") as usize;
        let count = d["accessors"][indices]["count"].as_u64().expect("a count");
        d["accessors"][indices]["count"] = json!(count - 6);
    });
    let road = |loaded: &ImportedScene| -> BTreeSet<[usize; 3]> {
        let all = loaded.scene.frame().occupancy.iter_set();
        all.filter(|v| v.3 == 11).map(|(x, y, z, _)| [x, y, z]).collect()
    };
    assert_eq!(road(&read(&bytes)), road(&read(&cut)));
    // A node without extras below the root: a house that somebody modelled into it.
    let mut blocks = Blocks::new();
    blocks.block("house", DVec3::ZERO, DVec3::new(8.0, 4.0, 6.0));
    let foreign = blocks.document();
    let added = edited(&bytes, |d| {
        let shift = |list: &str, d: &Value| d[list].as_array().map_or(0, Vec::len);
        let (accessors, views, meshes) = (shift("accessors", d), shift("bufferViews", d), shift("meshes", d));
        let list = |d: &mut Value, list: &str, v: Value| d[list].as_array_mut().expect("a list").push(v);
        for i in 0..2 {
            let mut accessor = foreign["accessors"][i].clone();
            accessor["bufferView"] = json!(views + i);
            list(d, "accessors", accessor);
            let mut view = foreign["bufferViews"][i].clone();
            view["buffer"] = json!(1);
            list(d, "bufferViews", view);
        }
        let mut mesh = foreign["meshes"][0].clone();
        mesh["primitives"][0]["attributes"]["POSITION"] = json!(accessors);
        mesh["primitives"][0]["indices"] = json!(accessors + 1);
        list(d, "meshes", mesh);
        list(d, "buffers", foreign["buffers"][0].clone());
        let mut house = foreign["nodes"][0].clone();
        house["mesh"] = json!(meshes);
        house["translation"] = json!([0.0, 2.0, 20.0]);
        list(d, "nodes", house);
        let at = d["nodes"].as_array().expect("nodes").len() - 1;
        d["scenes"][0]["nodes"]
            .as_array_mut()
            .expect("nodes")
            .push(json!(at));
    });
    let loaded = read(&added);
    let all = loaded.scene.frame().occupancy.iter_set();
    let house: Vec<_> = all.filter(|v| v.3 == Class::Manmade.id()).collect();
    // 20 m to the right of the origin: +z of glTF is our -y.
    assert!(
        house.len() > 500 && house.iter().all(|v| (40..60).contains(&v.1)),
        "{}",
        house.len()
    );
    assert_eq!(road(&loaded), road(&read(&bytes)));
}

#[test]
fn bad_files_of_ours_are_one_line() {
    let bytes = to_bytes(&car_on_a_road()).expect("sound");
    let root = "small (z up)";
    let with = |key: &str, value: Value| {
        refusal(&edited(&bytes, |d| {
            node(d, root)["extras"]["sceneloom"][key] = value
        }))
    };
    assert!(with("version", json!(2)).contains("version 2"));
    assert!(with("class_map", json!("x".repeat(9999))).contains("occ3d-nuscenes"));
    assert!(with("seed", json!("-1")).contains("expected digits"));
    assert!(
        with("extent", json!({"from": [0, 0], "columns": [9999999, 9999999]})).contains("expected sides")
    );
    assert!(with("extent", json!({"from": [9999999, 0], "columns": [9, 9]})).contains("from column"));
    assert!(with("extent", json!({"from": ["x"]})).contains("extras of the scene's node"));
    // Extras of a box that make no sense: its voxels are there, the box is not.
    let wrong = edited(&bytes, |d| node(d, "car 4")["extras"]["size_m"] = json!("large"));
    let loaded = read(&wrong);
    assert_eq!(loaded.skipped["boxes whose extras are not readable"], 1);
    assert!(loaded.scene.frame().boxes.is_empty());
    assert!(loaded.scene.frame().occupancy.iter_set().any(|v| v.3 == 4));
    let huge = edited(&bytes, |d| {
        node(d, "car 4")["translation"] = json!([1e9, 0.0, 0.0])
    });
    assert_eq!(read(&huge).skipped["boxes that are upright or finite no more"], 1);
}

/// How large and how quickly made the file of a full scene is: `SCENELOOM_SCENES` names a folder of `.loom` files.
#[test]
#[ignore = "measures; run with --release and a folder of scenes"]
fn full_scenes_are_small_and_quick() {
    let folder = std::env::var_os("SCENELOOM_SCENES").expect("SCENELOOM_SCENES names a folder");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    for path in paths {
        let bytes = std::fs::read(&path).expect("a file");
        let scene = crate::loom::from_bytes(&bytes).expect("a scene");
        let scene = scene.in_ego();
        let begin = std::time::Instant::now();
        let file = to_bytes(&scene).expect("sound");
        let (written_s, begin) = (begin.elapsed().as_secs_f64(), std::time::Instant::now());
        let back = read(&file);
        println!(
            "{}: {} voxels, {:.2} MB, written in {written_s:.3} s, read in {:.3} s",
            path.display(),
            scene.frame().occupancy.count_set(),
            file.len() as f64 / 1e6,
            begin.elapsed().as_secs_f64()
        );
        assert!(back.scene.frame().occupancy == scene.frame().occupancy);
        assert_eq!(back.scene.frame().boxes, scene.frame().boxes);
        assert!(file.len() < 5_000_000 && written_s < 0.5);
    }
}
