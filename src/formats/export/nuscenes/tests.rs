use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::*;
use crate::clip_tests::{Plain, clip_scene};

/// Every file by its path; tables as JSON.
fn written(scene: &Scene) -> (BTreeMap<String, Vec<u8>>, BTreeMap<String, Vec<Value>>) {
    let files = write(scene, &mut Plain::of(scene)).expect("written");
    let files: BTreeMap<String, Vec<u8>> = files.into_iter().map(|f| (f.name, f.bytes)).collect();
    let table = |(name, bytes): (&String, &Vec<u8>)| {
        let table = name.strip_prefix("v1.0-mini/")?.strip_suffix(".json")?;
        if table == "splits" {
            return None;
        }
        Some((table.to_owned(), serde_json::from_slice(bytes).expect("JSON")))
    };
    let tables = files.iter().filter_map(table).collect();
    (files, tables)
}

fn text(row: &Value, key: &str) -> String {
    row[key]
        .as_str()
        .unwrap_or_else(|| panic!("{key} in {row}"))
        .to_owned()
}

#[test]
fn every_key_leads_to_a_row_and_every_file_is_there() {
    let (files, tables) = written(&clip_scene(4));
    let tokens =
        |table: &str| -> BTreeSet<String> { tables[table].iter().map(|r| text(r, "token")).collect() };
    let all: BTreeMap<&str, BTreeSet<String>> = tables.keys().map(|t| (t.as_str(), tokens(t))).collect();
    assert_eq!(all.len(), 14, "{:?}", all.keys());
    for (table, rows) in &tables {
        assert_eq!(rows.len(), all[table.as_str()].len(), "{table}: a token twice");
        for row in rows {
            for (key, value) in row.as_object().expect("a row") {
                let of = match key.as_str() {
                    "token" => continue,
                    "prev" | "next" => table,
                    "first_sample_token" | "last_sample_token" => "sample",
                    "first_annotation_token" | "last_annotation_token" => "sample_annotation",
                    key => match key.strip_suffix("_token").or(key.strip_suffix("_tokens")) {
                        Some(table) => table,
                        None => continue,
                    },
                };
                let list = value.as_array().cloned().unwrap_or_else(|| vec![value.clone()]);
                for token in list.iter().map(|v| v.as_str().expect("a token")) {
                    let end = token.is_empty() && matches!(key.as_str(), "prev" | "next");
                    assert!(end || all[of].contains(token), "{table}.{key}: {token}");
                }
            }
        }
    }
    let named = tables["sample_data"]
        .iter()
        .chain(&tables["lidarseg"])
        .chain(&tables["map"]);
    let named: BTreeSet<String> = named.map(|row| text(row, "filename")).collect();
    let data = files
        .keys()
        .filter(|f| !f.starts_with("v1.0-mini/") && !f.starts_with("maps/expansion/"));
    assert_eq!(data.cloned().collect::<BTreeSet<_>>(), named);
    // 5 key frames with a sweep, five scans and six pictures, four sweeps and four times five scans between each two.
    assert_eq!(tables["sample"].len(), 5);
    assert_eq!(tables["sample_data"].len(), 5 * 12 + 4 * 4 * 6);
    assert_eq!(tables["lidarseg"].len(), 5);
}

#[test]
fn chains_run_through_all_in_order_of_time() {
    let (_, tables) = written(&clip_scene(5));
    for (table, chains) in [("sample", 1), ("sample_data", 12), ("sample_annotation", 12)] {
        let rows: BTreeMap<String, &Value> = tables[table].iter().map(|r| (text(r, "token"), r)).collect();
        let starts: Vec<&Value> = rows.values().copied().filter(|r| r["prev"] == "").collect();
        assert_eq!(starts.len(), chains, "{table}");
        let mut passed = 0;
        for start in starts {
            let mut at = start;
            loop {
                passed += 1;
                let next = text(at, "next");
                if next.is_empty() {
                    break;
                }
                assert_eq!(rows[&next]["prev"], at["token"]);
                let time = |row: &Value| row["timestamp"].as_i64().unwrap_or(i64::MAX);
                assert!(time(rows[&next]) > time(at) || time(at) == i64::MAX);
                at = rows[&next];
            }
        }
        assert_eq!(passed, rows.len(), "{table}");
    }
}

#[test]
fn boxes_and_points_are_where_the_devkit_looks_for_them() {
    let scene = clip_scene(6);
    let (files, tables) = written(&scene);
    let now = scene.at(0.5);
    let sample = text(&tables["sample"][1], "token");
    let at = |row: &&Value| row["sample_token"] == sample.as_str();
    let boxes: Vec<&Value> = tables["sample_annotation"].iter().filter(at).collect();
    assert_eq!(boxes.len(), now.frame().boxes.len());
    for (row, b) in boxes.iter().zip(now.frame().boxes.values()) {
        let list = |key: &str| serde_json::from_value::<Vec<f64>>(row[key].clone()).expect("numbers");
        let center = b.center_m + DVec3::new(40.0, 40.0, 0.0);
        assert_eq!(list("translation"), center.to_array());
        assert_eq!(list("size"), [b.size_m.y, b.size_m.x, b.size_m.z]);
        let q = list("rotation");
        assert_eq!([q[1], q[2]], [0.0; 2]);
        assert!((2.0 * q[3].atan2(q[0]) - b.yaw_rad).sin().abs() < 1e-9);
        // Seen by 0, 25, 50, 75 or 100 %.
        let bin = [1, 1, 2, 3, 4][(b.id.0 % 5) as usize];
        assert_eq!(row["visibility_token"], bin.to_string());
    }
    // The sweep of that key frame: in the sensor's frame, a label for each point, the ground where boxes stand.
    let is_sweep = |row: &&Value| at(row) && row["fileformat"] == "pcd" && row["is_key_frame"] == true;
    let row = tables["sample_data"].iter().find(is_sweep).expect("a sweep");
    let labels = tables["lidarseg"]
        .iter()
        .find(|l| l["sample_data_token"] == row["token"])
        .expect("labels");
    let (points, labels) = (&files[&text(row, "filename")], &files[&text(labels, "filename")]);
    assert_eq!(points.len(), labels.len() * 20);
    let lidar = scene.rig.lidars[0].ego_from_sensor();
    let mut on_boxes = 0;
    for (point, label) in points.chunks_exact(20).zip(labels) {
        let [x, y, z] = [0, 4, 8].map(|i| {
            f64::from(f32::from_le_bytes(
                point[i..i + 4].try_into().expect("four bytes"),
            ))
        });
        let in_ego = lidar.apply(DVec3::new(x, y, z));
        let in_world = now.frame().world_from_ego.apply(in_ego);
        match categories::ALL[usize::from(*label)].0 {
            "flat.driveable_surface" | "flat.terrain" | "flat.sidewalk" => {
                assert!(in_ego.z.abs() < 1e-3, "{in_ego}");
            }
            _ => {
                assert!(
                    now.frame().boxes.values().any(|b| b.contains(in_world, 1e-3)),
                    "{in_world}"
                );
                on_boxes += 1;
            }
        }
    }
    assert!(on_boxes > 10, "{on_boxes}");
}

/// Where the devkit's `points_in_box` has a point and a box, both in the sensor's frame.
fn is_in(point: DVec3, b: &SceneBox, sensor_from_world: &Pose) -> bool {
    let half = b.size_m / 2.0;
    let corner = |x: f64, y: f64, z: f64| sensor_from_world.apply(b.to_ego(half * DVec3::new(x, y, z)));
    let first = corner(1.0, 1.0, 1.0);
    let sides = [
        corner(-1.0, 1.0, 1.0),
        corner(1.0, -1.0, 1.0),
        corner(1.0, 1.0, -1.0),
    ];
    sides.into_iter().all(|side| {
        let (side, way) = (side - first, point - first);
        (0.0..=side.dot(side)).contains(&side.dot(way))
    })
}

#[test]
fn counts_of_boxes_are_those_of_the_points_in_the_files() {
    let scene = clip_scene(6);
    let (files, tables) = written(&scene);
    let mut all = 0;
    for (i, sample) in tables["sample"].iter().enumerate() {
        let now = scene.at(0.5 * i as f64);
        let sensor_from_world =
            (now.frame().world_from_ego * scene.rig.lidars[0].ego_from_sensor()).inverse();
        let at = |row: &&Value| row["sample_token"] == sample["token"];
        let is_sweep = |row: &&Value| at(row) && row["fileformat"] == "pcd" && row["is_key_frame"] == true;
        let row = tables["sample_data"].iter().find(is_sweep).expect("a sweep");
        let point = |bytes: &[u8]| {
            let value =
                |i: usize| f32::from_le_bytes(bytes[4 * i..4 * i + 4].try_into().expect("four bytes"));
            DVec3::new(value(0).into(), value(1).into(), value(2).into())
        };
        let points: Vec<DVec3> = files[&text(row, "filename")]
            .chunks_exact(20)
            .map(point)
            .collect();
        let boxes = tables["sample_annotation"].iter().filter(at);
        for (row, b) in boxes.zip(now.frame().boxes.values()) {
            let inside = points
                .iter()
                .filter(|p| is_in(**p, b, &sensor_from_world))
                .count();
            assert_eq!(row["num_lidar_pts"], inside, "{b:?}");
            all += inside;
        }
    }
    assert!(all > 50, "{all}");
}

#[test]
fn the_scene_has_a_name_as_the_devkit_knows_them_and_is_in_a_split() {
    let scene = clip_scene(2);
    let (files, tables) = written(&scene);
    let name = text(&tables["scene"][0], "name");
    let number: u32 = name
        .strip_prefix("scene-")
        .expect("a name")
        .parse()
        .expect("a number");
    assert!((2000..10_000).contains(&number), "{name}");
    let splits: Value = serde_json::from_slice(&files["v1.0-mini/splits.json"]).expect("JSON");
    assert_eq!(splits, serde_json::json!({ "all": [name] }));
    // Equal scenes have equal names, others others.
    assert_eq!(scene_name(&Tokens::from_scene(&scene)), name);
    assert_ne!(scene_name(&Tokens::from_scene(&clip_scene(3))), name);
}

#[test]
fn a_scene_that_stands_still_is_one_sample_and_equal_scenes_give_equal_bytes() {
    let mut scene = crate::table_tests::scene();
    scene.name = "a \"name\"\n".into();
    let (files, tables) = written(&scene);
    assert_eq!(tables["sample"].len(), 1);
    assert_eq!(tables["scene"][0]["title"], "a \"name\"\n");
    assert_eq!(tables["scene"][0]["description"], "fog");
    assert_eq!(files, written(&scene).0);
    let picture = files
        .iter()
        .find(|(name, _)| name.starts_with("samples/CAM_BACK_LEFT/"));
    let picture = image::load_from_memory(picture.expect("a picture").1).expect("a JPEG");
    assert_eq!((picture.width(), picture.height()), (32, 18));
    // The intrinsics are those of the pictures.
    let wide = |row: &&Value| !row["camera_intrinsic"].as_array().expect("a list").is_empty();
    let first = tables["calibrated_sensor"].iter().find(wide).expect("a camera");
    let focal = scene.rig.cameras[0].focal_px[0] * 32.0 / 1600.0;
    assert_eq!(first["camera_intrinsic"][0][0], focal);
}

#[test]
fn what_cannot_be_written_is_one_line() {
    let mut scene = crate::table_tests::scene();
    scene.change_canvas(|canvas| {
        canvas.boxes.values_mut().for_each(|b| b.size_m.x = f64::NAN);
    });
    let line = write(&scene, &mut Plain::of(&scene))
        .expect_err("NaN")
        .to_string();
    assert!(line.contains("size_m"), "{line}");
    // Without sensors there are boxes and the map alone.
    let mut bare = clip_scene(1);
    let rig = std::sync::Arc::make_mut(&mut bare.rig);
    rig.cameras.clear();
    rig.lidars.clear();
    rig.radars.clear();
    let (_, tables) = written(&bare);
    assert!(tables["sample_data"].is_empty() && tables["sample_annotation"].len() > 20);
    assert!(!tables.contains_key("lidarseg"));
}
