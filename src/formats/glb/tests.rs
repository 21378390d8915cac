//! Files as other programs write them, and ours after a stay elsewhere.

use std::collections::BTreeSet;
use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DQuat, DVec2, DVec3};
use scene::moved::Columns;
use scene::{BevLayer, BoxId, Class, Extent, Scene, SceneBox, SensorRig};
use serde_json::{Value, json};

use super::container;
use crate::FormatError;
use crate::export::glb::to_bytes;
use crate::import::glb::IMPORTER;
use crate::import::{Content, Loaded, Source};
use crate::table_tests::random_scene;

fn read_at(bytes: &[u8], name: &str, path: Option<PathBuf>) -> Result<Loaded, FormatError> {
    let source = Source {
        bytes,
        name,
        path: path.as_deref(),
    };
    match (IMPORTER.read)(&source)? {
        Content::Scene(loaded) => Ok(*loaded),
        Content::Roads(_) => panic!("no roads in meshes"),
    }
}

fn read(bytes: &[u8]) -> Loaded {
    read_at(bytes, "a file", None).expect("sound")
}

fn refusal(bytes: &[u8]) -> String {
    let line = read_at(bytes, "a file", None).err().expect("refused").to_string();
    assert!(!line.contains('\n') && line.chars().count() <= 300, "{line}");
    line
}

/// A document of blocks as a foreign program writes it: name, place of the middle and size, all in the axes of glTF (y up).
struct Blocks {
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    bytes: Vec<u8>,
}

impl Blocks {
    fn new() -> Self {
        Self {
            nodes: Vec::new(),
            meshes: Vec::new(),
            accessors: Vec::new(),
            views: Vec::new(),
            bytes: Vec::new(),
        }
    }

    fn of(blocks: &[(&str, DVec3, DVec3)]) -> Value {
        let mut out = Self::new();
        blocks
            .iter()
            .for_each(|(name, at, size)| out.block(name, *at, *size));
        out.document()
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn block(&mut self, name: &str, at: DVec3, size: DVec3) {
        let corners: Vec<u8> = (0..8u32)
            .flat_map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -0.5 } else { 0.5 } * size[axis]))
            .flat_map(|v| (v as f32).to_le_bytes())
            .collect();
        let faces: [u8; 36] = [
            0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3,
            5, 3, 7, 5,
        ];
        let (corners, faces) = (self.view(&corners), self.view(&faces));
        let n = self.accessors.len();
        self.accessors
            .push(json!({"bufferView": corners, "componentType": 5126, "count": 8, "type": "VEC3"}));
        self.accessors
            .push(json!({"bufferView": faces, "componentType": 5121, "count": 36, "type": "SCALAR"}));
        self.meshes
            .push(json!({"primitives": [{"attributes": {"POSITION": n}, "indices": n + 1}]}));
        self.nodes
            .push(json!({"name": name, "mesh": self.meshes.len() - 1, "translation": at.to_array()}));
    }

    fn document(self) -> Value {
        let data = format!(
            "data:application/octet-stream;base64,{}",
            STANDARD.encode(&self.bytes)
        );
        json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": (0..self.nodes.len()).collect::<Vec<_>>()}],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.bytes.len(), "uri": data}],
        })
    }
}

fn text(document: &Value) -> Vec<u8> {
    serde_json::to_vec(document).expect("JSON")
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
    let mut map = Scene::single(
        "a \"map\"",
        frame,
        std::sync::Arc::new(SensorRig::default()),
        u64::MAX,
    );
    map.prompt = "rain\nand fog".into();
    let back = read(&to_bytes(&map).expect("sound"));
    assert!(back.scene.frame().occupancy == map.frame().occupancy && back.skipped.is_empty());
    assert_eq!(
        (&back.scene.name, &back.scene.prompt, back.scene.seed),
        (&map.name, &map.prompt, u64::MAX)
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
    let cars = |loaded: &Loaded| -> Vec<[usize; 3]> {
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
    let road = |loaded: &Loaded| -> BTreeSet<[usize; 3]> {
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

/// The marker of every import format: a single car ahead to the left, a cone to the right.
#[test]
fn a_foreign_scene_has_its_things_where_they_are() {
    let document = Blocks::of(&[
        // 12 m along x of glTF and 5 m against z: ahead and left.
        ("Car_01", DVec3::new(12.0, 0.8, -5.0), DVec3::new(4.5, 1.6, 1.8)),
        (
            "traffic cone",
            DVec3::new(8.0, 0.4, 3.0),
            DVec3::new(0.4, 0.8, 0.4),
        ),
        ("road", DVec3::new(0.0, -0.05, 0.0), DVec3::new(60.0, 0.1, 30.0)),
        (
            "house wall",
            DVec3::new(0.0, 2.0, -12.0),
            DVec3::new(20.0, 4.0, 0.2),
        ),
        ("SkyDome", DVec3::ZERO, DVec3::splat(5000.0)),
        (
            "grass field",
            DVec3::new(0.0, -0.05, 25.0),
            DVec3::new(60.0, 0.1, 20.0),
        ),
    ]);
    let loaded = read(&text(&document));
    let frame = loaded.scene.frame();
    assert_eq!(loaded.skipped["meshes of the sky"], 1);
    assert_eq!(frame.extent(), Extent::WINDOW);
    let of = |class: Class| frame.boxes.values().find(|b| b.class == class).expect("that box");
    let car = of(Class::Car);
    assert!(
        (car.center_m - DVec3::new(12.0, 5.0, 0.8)).length() < 1e-6,
        "{}",
        car.center_m
    );
    assert!(
        (car.size_m - DVec3::new(4.5, 1.8, 1.6)).length() < 1e-6,
        "{}",
        car.size_m
    );
    assert!((of(Class::TrafficCone).center_m - DVec3::new(8.0, -3.0, 0.4)).length() < 1e-6);
    assert_eq!(frame.boxes.len(), 2);
    let label = |x: f64, y: f64, z: usize| {
        let [x, y] = Extent::WINDOW.column_at(x, y).expect("on the map");
        frame.occupancy.get(x, y, z)
    };
    // In the convention of the labels: the ground in bin 0, a car from there to its roof (1.6 m: bin 6).
    let column: Vec<u8> = (0..8).map(|z| label(12.1, 5.1, z)).collect();
    assert_eq!(column, [4, 4, 4, 4, 4, 4, 4, Class::FREE]);
    assert_eq!((label(-10.1, 0.1, 0), label(-10.1, 0.1, 1)), (11, Class::FREE));
    assert_eq!(label(0.1, -25.1, 0), Class::Terrain.id());
    // The wall has no holes, from the ground to 4 m.
    for x in -24..=24 {
        let wall = (0..12).all(|z| label(f64::from(x) * 0.4, 12.0, z) == Class::Manmade.id());
        assert!(wall, "column {x} of the wall");
    }
    assert!(frame.layout.count(BevLayer::DrivableArea) > 10_000);
}

#[test]
fn the_order_of_quaternions_and_sizes_is_that_of_the_standard() {
    // 30 degrees counter-clockwise from above; glTF has x, y, z, w, and up is y.
    let turn = DQuat::from_rotation_y(30f64.to_radians());
    let mut blocks = Blocks::new();
    blocks.block("bus", DVec3::new(-9.0, 1.5, -11.0), DVec3::new(2.6, 3.0, 11.0));
    blocks.block("street", DVec3::ZERO, DVec3::new(70.0, 0.01, 70.0));
    let mut document = blocks.document();
    document["nodes"][0]["rotation"] = json!(turn.to_array());
    let b = |document: &Value| {
        *read(&text(document))
            .scene
            .frame()
            .boxes
            .values()
            .next()
            .expect("a bus")
    };
    let found = b(&document);
    assert!(
        (found.size_m - DVec3::new(11.0, 2.6, 3.0)).length() < 1e-6,
        "{}",
        found.size_m
    );
    assert!((found.center_m - DVec3::new(-9.0, 11.0, 1.5)).length() < 1e-6);
    // Its front is +z of glTF, our -y, turned by 30 degrees.
    assert!(
        (found.yaw_rad.to_degrees() + 60.0).abs() < 1e-4,
        "{}",
        found.yaw_rad.to_degrees()
    );
    // The same as a matrix, column by column.
    let m = glam::DMat4::from_rotation_translation(turn, DVec3::new(-9.0, 1.5, -11.0));
    let node = document["nodes"][0].as_object_mut().expect("a node");
    node.remove("rotation");
    node.remove("translation");
    node.insert("matrix".into(), json!(m.to_cols_array()));
    let again = b(&document);
    assert!(
        (again.center_m - found.center_m).length() < 1e-5 && (again.yaw_rad - found.yaw_rad).abs() < 1e-6
    );
}

#[test]
fn a_group_of_cars_is_several_and_a_joined_mesh_is_voxels() {
    let mut blocks = Blocks::new();
    for (i, name) in ["first", "second", "third"].into_iter().enumerate() {
        blocks.block(
            name,
            DVec3::new(0.0, 0.8, -3.0 * i as f64),
            DVec3::new(4.5, 1.6, 1.8),
        );
    }
    let mut document = blocks.document();
    document["nodes"]
        .as_array_mut()
        .expect("nodes")
        .push(json!({"name": "Cars", "children": [0, 1, 2]}));
    document["scenes"][0]["nodes"] = json!([3]);
    let loaded = read(&text(&document));
    let frame = loaded.scene.frame();
    assert_eq!(frame.boxes.len(), 3);
    assert!(
        frame
            .boxes
            .values()
            .all(|b| b.class == Class::Car && b.size_m.x == 4.5)
    );
    let long = Blocks::of(&[("cars", DVec3::new(0.0, 0.8, 0.0), DVec3::new(60.0, 1.6, 2.0))]);
    let loaded = read(&text(&long));
    assert!(loaded.scene.frame().boxes.is_empty());
    assert!(
        loaded
            .scene
            .frame()
            .occupancy
            .iter_set()
            .filter(|v| v.3 == 4)
            .count()
            > 500
    );
}

#[test]
fn a_single_model_is_one_box_ahead_of_the_vehicle() {
    let car = Blocks::of(&[("body", DVec3::new(0.0, 0.3, 0.0), DVec3::new(1.9, 1.5, 4.4))]);
    let loaded = read_at(&text(&car), "my_sedan", None).expect("a car");
    let b = loaded.scene.frame().boxes[&BoxId(1)];
    assert_eq!((b.class, b.label.name.as_str()), (Class::Car, "my_sedan"));
    assert!(
        (b.center_m - DVec3::new(10.2, 0.0, 0.75)).length() < 1e-5 && b.yaw_rad == 0.0,
        "{}",
        b.center_m
    );
    assert!((b.size_m - DVec3::new(4.4, 1.9, 1.5)).length() < 1e-6);
    let voxels = loaded
        .scene
        .frame()
        .occupancy
        .iter_set()
        .filter(|v| v.3 == 4)
        .count();
    assert!((44 * 6..60 * 8).contains(&voxels), "{voxels} voxels");
    assert!(loaded.inferred.is_empty());
    // By its size, where no name tells: a guess.
    let loaded = read_at(&text(&car), "untitled", None).expect("a car");
    assert_eq!(loaded.scene.frame().boxes[&BoxId(1)].class, Class::Car);
    assert_eq!(
        (loaded.inferred, loaded.scene.frame().inferred.boxes.len()),
        (&["boxes"][..], 1)
    );
    // Where it stands elsewhere on the map it stays, on the ground.
    let aside = Blocks::of(&[("bench", DVec3::new(6.0, 7.0, 9.0), DVec3::new(2.0, 1.0, 1.0))]);
    let loaded = read(&text(&aside));
    let frame = loaded.scene.frame();
    assert!(frame.boxes.is_empty());
    let bench: Vec<_> = frame
        .occupancy
        .iter_set()
        .filter(|v| v.3 == Class::Manmade.id())
        .collect();
    let [x, y] = Extent::WINDOW.column_at(6.0, -9.0).expect("on the map");
    assert!(
        !bench.is_empty()
            && bench
                .iter()
                .all(|v| v.0.abs_diff(x) < 4 && v.1.abs_diff(y) < 4 && v.2 < 6)
    );
}

#[test]
fn far_maps_come_to_the_origin_and_large_ones_are_cut() {
    let far = Blocks::of(&[
        (
            "road",
            DVec3::new(9000.2, 112.0, -70.0),
            DVec3::new(300.0, 0.1, 20.0),
        ),
        (
            "house",
            DVec3::new(9050.0, 114.0, -90.0),
            DVec3::new(10.0, 4.0, 10.0),
        ),
    ]);
    let loaded = read(&text(&far));
    let extent = loaded.scene.frame().extent();
    assert_eq!(
        (
            extent.nx().abs_diff(750) <= 1,
            extent.from()[0].abs_diff(-375) <= 2
        ),
        (true, true),
        "{extent}"
    );
    assert!(loaded.scene.frame().layout.count(BevLayer::DrivableArea) > 30_000);
    let large = Blocks::of(&[("terrain", DVec3::ZERO, DVec3::new(5e4, 0.1, 5e4))]);
    let extent = read(&text(&large)).scene.frame().extent();
    assert_eq!([extent.nx(), extent.ny()], [2048, 2048]);
    // The labels' own moves agree with ours.
    assert_eq!(Columns([5, -5]).way_m(), DVec2::new(2.0, -2.0));
}

#[test]
fn other_ways_to_store_numbers_are_read() {
    let plain = Blocks::of(&[
        ("house", DVec3::new(9.0, 2.0, 0.0), DVec3::new(8.0, 4.0, 6.0)),
        ("road", DVec3::ZERO, DVec3::new(50.0, 0.1, 8.0)),
    ]);
    let expected = read(&text(&plain)).scene.frame().occupancy.clone();
    let same = |document: &Value, what: &str| {
        assert!(
            read(&text(document)).scene.frame().occupancy == expected,
            "{what}"
        );
    };
    // Quantised to 16 bits, normalised.
    let corners: Vec<u8> = (0..8u32)
        .flat_map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -32767i16 } else { 32767 }))
        .flat_map(i16::to_le_bytes)
        .collect();
    let with = |bytes: &[u8], accessor: Value, scale: Option<[f64; 3]>| {
        let mut document = plain.clone();
        let data = format!("data:;base64,{}", STANDARD.encode(bytes));
        document["buffers"]
            .as_array_mut()
            .expect("buffers")
            .push(json!({"byteLength": bytes.len(), "uri": data}));
        document["bufferViews"]
            .as_array_mut()
            .expect("views")
            .push(json!({"buffer": 1, "byteLength": bytes.len()}));
        document["accessors"][0] = accessor;
        if let Some(scale) = scale {
            document["nodes"][0]["scale"] = json!(scale);
        }
        document
    };
    let quantised =
        json!({"bufferView": 4, "componentType": 5122, "normalized": true, "count": 8, "type": "VEC3"});
    let mut document = with(&corners, quantised, Some([4.0, 2.0, 3.0]));
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    same(&document, "quantised");
    // Zeros, all of them replaced.
    let mut sparse: Vec<u8> = (0..8u8).collect();
    sparse.extend(
        (0..8u32)
            .flat_map(|i| {
                let half = [4.0f32, 2.0, 3.0];
                [0, 1, 2].map(|axis| {
                    if i >> axis & 1 == 0 {
                        -half[axis]
                    } else {
                        half[axis]
                    }
                })
            })
            .flat_map(f32::to_le_bytes),
    );
    let replaced = json!({"componentType": 5126, "count": 8, "type": "VEC3", "sparse": {"count": 8,
        "indices": {"bufferView": 4, "componentType": 5121}, "values": {"bufferView": 4, "byteOffset": 8}}});
    same(&with(&sparse, replaced, None), "sparse");
    // Triangles that are listed corner by corner, as a fan and as a strip of their own.
    let mut document = plain.clone();
    document["meshes"][0]["primitives"][0]["mode"] = json!(1);
    assert_eq!(read(&text(&document)).skipped["meshes of points or lines"], 1);
    document["meshes"][0]["primitives"][0]["mode"] = json!(5);
    read(&text(&document));
}

#[test]
fn strips_and_fans_have_their_triangles() {
    for (mode, order) in [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let corners: Vec<u8> = order
            .into_iter()
            .flat_map(|i: u32| {
                [
                    f64::from(i % 2) * 30.0 - 15.0,
                    0.0,
                    f64::from(i / 2) * 30.0 - 15.0,
                ]
            })
            .flat_map(|v| (v as f32).to_le_bytes())
            .collect();
        let document = json!({
            "asset": {"version": "2.0"},
            "nodes": [{"mesh": 0, "name": "road"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": mode}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}],
            "buffers": [{"byteLength": 48, "uri": format!("data:;base64,{}", STANDARD.encode(corners))}],
        });
        let road = read(&text(&document)).scene.frame().occupancy.count_set();
        assert!((75 * 75..77 * 77).contains(&road), "mode {mode}: {road} voxels");
    }
}

#[test]
fn buffers_beside_the_file_are_read_and_no_others() {
    let mut document = Blocks::of(&[("house", DVec3::new(20.0, 2.0, 0.0), DVec3::new(8.0, 4.0, 6.0))]);
    let data = document["buffers"][0]["uri"].as_str().expect("a data address");
    let bytes = STANDARD
        .decode(data.split_once(',').expect("data").1)
        .expect("base64");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("a file")).expect("a folder");
    std::fs::create_dir(folder.path().join("a file/buffers")).expect("a folder");
    std::fs::write(folder.path().join("a file/buffers/mesh 1.bin"), &bytes).expect("written");
    std::fs::write(folder.path().join("secret.bin"), &bytes).expect("written");
    let path = folder.path().join("a file/scene.gltf");
    let mut read_from = |uri: &str| {
        document["buffers"][0]["uri"] = json!(uri);
        read_at(&text(&document), "a file", Some(path.clone()))
    };
    read_from("buffers/mesh%201.bin").expect("beside it");
    read_from("./buffers/mesh%201.bin").expect("beside it");
    for uri in [
        "../secret.bin",
        "buffers/../../secret.bin",
        "%2e%2e/secret.bin",
        "..\\secret.bin",
        "/etc/hostname",
        "file:///etc/hostname",
        "https://example.org/mesh.bin",
        "",
    ] {
        let line = read_from(uri).err().expect(uri).to_string();
        assert!(
            line.contains("expected the name of a file in the same folder"),
            "{uri}: {line}"
        );
    }
    assert!(
        read_from("missing.bin")
            .err()
            .expect("missing")
            .to_string()
            .contains("missing.bin")
    );
    let line = read_at(&text(&document), "a file", None)
        .err()
        .expect("no folder")
        .to_string();
    assert!(line.contains("read from memory"), "{line}");
}

#[test]
fn bad_foreign_files_are_one_line() {
    let sound = Blocks::of(&[("house", DVec3::new(20.0, 2.0, 0.0), DVec3::new(8.0, 4.0, 6.0))]);
    let with = |pointer: &str, value: Value| {
        let mut document = sound.clone();
        *document.pointer_mut(pointer).expect(pointer) = value;
        refusal(&text(&document))
    };
    assert!(with("/asset/version", json!("1.0")).contains("expected 2.0"));
    assert!(with("/accessors/0/count", json!(4_000_000_000u64)).contains("4000000000 elements"));
    assert!(with("/accessors/1/count", json!(4_000_000_000u64)).contains("triangles, expected at most"));
    assert!(with("/accessors/1/count", json!(100_000)).contains("100000 elements"));
    assert!(with("/bufferViews/0/byteLength", json!(4_000_000_000u64)).contains("4000000000 bytes"));
    assert!(with("/bufferViews/0/byteOffset", json!(u64::MAX)).contains("18446744073709551615"));
    assert!(with("/buffers/0/byteLength", json!(1 << 30)).contains("expected 1073741824"));
    assert!(with("/buffers/0/uri", json!("data:;base64,!!!")).contains("buffer 0"));
    assert!(with("/buffers/0/uri", json!("data:text/plain,abc")).contains("not base64"));
    assert!(with("/nodes/0/mesh", json!(7)).contains("mesh 7"));
    assert!(with("/scene", json!(3)).contains("scene 3"));
    assert!(with("/scenes/0/nodes", json!([0, 0])).contains("two parents"));
    assert!(with("/scenes/0/nodes", json!([])).contains("no triangles"));
    assert!(with("/accessors/0/type", json!("SCALAR")).contains("expected positions"));
    assert!(with("/accessors/0/componentType", json!(1)).contains("accessor 0"));
    assert!(with("/meshes/0/primitives/0/attributes", json!({"POSITION": 1})).contains("expected positions"));
    assert!(with("/nodes/0", json!({"children": [0], "name": "x".repeat(100_000)})).contains("two parents"));
    let mut document = sound.clone();
    document["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(refusal(&text(&document)).contains("KHR_draco_mesh_compression"));
    // A chain of nodes.
    let mut document = sound.clone();
    let mut chain: Vec<Value> = (1..5000).map(|i| json!({"children": [i]})).collect();
    chain.push(json!({"mesh": 0}));
    document["nodes"] = json!(chain);
    assert!(refusal(&text(&document)).contains("below 257 others"));
    // Numbers that are not finite are left out.
    let bytes: Vec<u8> = [f32::NAN; 24].into_iter().flat_map(f32::to_le_bytes).collect();
    let mut document = sound;
    let data = format!("data:;base64,{}", STANDARD.encode(&bytes));
    document["buffers"]
        .as_array_mut()
        .expect("buffers")
        .push(json!({"byteLength": bytes.len(), "uri": data}));
    document["bufferViews"][0] = json!({"buffer": 1, "byteLength": bytes.len()});
    assert!(refusal(&text(&document)).contains("no triangles"));
    document["nodes"] = json!([document["nodes"][0], {"mesh": 1, "name": "road"}]);
    let second = Blocks::of(&[
        ("road", DVec3::ZERO, DVec3::ONE),
        ("road", DVec3::ZERO, DVec3::new(50.0, 0.1, 9.0)),
    ]);
    for list in ["accessors", "bufferViews", "meshes"] {
        let mut all = second[list].as_array().expect("a list").clone();
        all.extend(document[list].as_array().expect("a list").iter().cloned());
        document[list] = json!(all);
    }
    document["buffers"] = json!([second["buffers"][0], document["buffers"][1]]);
    document["accessors"][0]["bufferView"] = json!(4);
    document["scenes"][0]["nodes"] = json!([0, 1]);
    document["nodes"][0]["mesh"] = json!(0);
    assert_eq!(
        read(&text(&document)).skipped["triangles with numbers that are not finite"],
        12
    );
}

/// The sample models, where they are: real files of another program.
#[test]
fn sample_models_are_read() {
    let folder =
        std::env::var_os("SCENELOOM_DATA").map_or_else(|| PathBuf::from("/work/shared/data"), PathBuf::from);
    let folder = folder.join("gltf");
    if !folder.is_dir() {
        return println!("{}: no sample models there", folder.display());
    }
    let read = |name: &str| {
        let path = folder.join(name);
        let bytes = std::fs::read(&path).expect(name);
        let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
        read_at(&bytes, &stem, Some(path)).expect(name).scene
    };
    for (name, class, size_m) in [
        ("racing/vehicle-truck-yellow.glb", Class::Truck, [2.8, 1.5, 1.55]),
        (
            "racing/vehicle-motorcycle.glb",
            Class::Motorcycle,
            [2.44, 1.09, 1.27],
        ),
        ("platformer/character.glb", Class::Pedestrian, [0.64, 1.2, 1.1]),
    ] {
        let scene = read(name);
        let b = scene.frame().boxes[&BoxId(1)];
        assert_eq!(b.class, class, "{name}");
        assert!(
            (b.size_m - DVec3::from_array(size_m)).abs().max_element() < 0.02,
            "{name}: {}",
            b.size_m
        );
        assert!(b.yaw_rad == 0.0 && (b.center_m.z - b.size_m.z / 2.0).abs() < 1e-6);
        let own = scene.frame().occupancy.iter_set().filter(|v| v.3 == class.id());
        assert!(own.count() >= 6, "{name}");
    }
    for (name, class) in [
        ("city/building-small-c.glb", Class::Manmade),
        ("city/building-garage.glb", Class::Manmade),
        ("city/grass-trees-tall.glb", Class::Vegetation),
    ] {
        let scene = read(name);
        assert!(scene.frame().boxes.is_empty(), "{name}");
        let voxels = scene.frame().occupancy.iter_set().filter(|v| v.3 == class.id());
        assert!(voxels.count() >= 6, "{name}");
    }
}
