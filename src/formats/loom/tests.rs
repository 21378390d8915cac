//! Tests of versions: files of every one open, steps lead from the oldest to the present one, a newer one is refused.

use std::io::{Cursor, Read, Write};
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::background::{Background, Form, Post, PostKind, Tree, TreeKind};
use scene::clip::ObjectVoxels;
use scene::roads::{LaneKind, NodeId, NodeKind, RoadCrossing, RoadStop};
use scene::{Arranged, Arrangement, BoxName, Members, Road, RoadId, RoadLane, RoadNetwork};
use scene::{
    BevLayer, BevLayout, BoxId, Class, Clip, Conditions, Extent, Frame, KeptVersion, Key, Motion,
    ProjectHistory, Relief, Scene, SceneBox, SensorRig, TimeOfDay, Track, VoxelGrid, Weather,
};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use super::migrate::{self, Entries, Migration, MigrationChange};
use super::*;

/// What the bundled file of a version holds.
pub(super) fn sample(version: u32) -> Scene {
    // Version 4 has maps of any extent.
    let extent = match version {
        4.. => Extent::new([-120, -100], [230, 203]).expect("sound"),
        _ => Extent::WINDOW,
    };
    let mut layout = BevLayout::over(extent);
    for x in 20..180 {
        (90..110).for_each(|y| layout.set(BevLayer::DrivableArea, x, y, true));
    }
    if version >= 2 {
        layout.relief = Relief::from_fn(layout.extent(), |p| 0.03 * p.x);
    }
    let car = SceneBox {
        id: BoxId(4),
        class: Class::Car,
        center_m: DVec3::new(10.0 / 3.0, -1.0, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.1,
        velocity_mps: DVec2::new(3.0, 0.0),
        label: Default::default(),
    };
    let mut occupancy = VoxelGrid::over(extent);
    (0..100).for_each(|i| occupancy.set(50 + i, 95, i % 16, (i % 17) as u8));
    let mut frame = Frame::new(layout, [(car.id, car)].into(), occupancy);
    frame.painted.set(1, 2, 3, Class::Manmade.id());
    frame.occupancy.set(1, 2, 3, Class::Manmade.id());
    frame.time_s = 1.0 / 3.0;
    let name = format!("version {version}");
    // The files are older than radars.
    let rig = SensorRig {
        radars: Vec::new(),
        ..SensorRig::default()
    };
    let mut scene = Scene::single(&name, frame, Arc::new(rig), u64::MAX);
    scene.prompt = "night, rain".into();
    scene.words = Arc::new(vec!["a street at night".into()]);
    // Versions 1 and 2 had the prompt alone; version 3 says what it means, and more.
    scene.conditions = Conditions::usual(TimeOfDay::Night, Weather::Rain, u64::MAX);
    if version >= 3 {
        scene.conditions.visibility_m = 300.0;
        scene.conditions.seed = 7;
    }
    if version >= 2 {
        let mut background = Background::default();
        background.add(Form::Tree(Tree {
            position_m: DVec2::new(1.0 / 3.0, -7.1),
            height_m: 6.3,
            crown_radius_m: 1.7,
            kind: TreeKind::Conifer,
        }));
        if version >= 9 {
            let lamp = Post::typical(PostKind::StreetLight, DVec2::new(2.0 / 3.0, 7.1), 0.1);
            background.add_as(Form::Post(lamp), true);
        }
        scene.background = Arc::new(background);
    }
    if version >= 5 {
        scene.change_clip(|clip| *clip = sample_clip());
        scene.show(0.8);
    }
    if version >= 6 {
        scene.kept = Arc::new(kept());
    }
    if version >= 7 {
        scene.roads = Arc::new(roads());
    }
    if version >= 8 {
        scene.arranged = Arc::new(arranged(&scene));
    }
    if version >= 10 {
        Arc::make_mut(&mut scene.kept).log = Some(Arc::new(super::log_tests::log()));
    }
    if version >= 12 {
        let before = sample(8);
        Arc::make_mut(&mut scene.kept).sweeps = super::recording_tests::recorded(before);
    }
    scene
}

/// All that there is in one group, its boxes hidden, its things locked.
fn arranged(scene: &Scene) -> Arranged {
    let standing = scene.canvas().boxes.keys();
    let boxes = standing.chain(scene.clip().tracks.keys()).copied();
    let things = scene.background.iter().map(|t| t.id);
    let all = Members::of(boxes, things);
    let mut arranged = Arranged::default();
    let name = BoxName::new("all of it");
    arranged.arrange(&all, &Arrangement::Group { name });
    arranged.arrange(&Members::of(all.boxes, []), &Arrangement::Hide);
    arranged.arrange(&Members::of([], all.things), &Arrangement::Lock);
    arranged
}

/// Two roads between three nodes.
fn roads() -> RoadNetwork {
    let mut net = RoadNetwork::default();
    let ends = [[-40.0, 1.0 / 3.0], [0.0, 0.0], [30.0, 20.0]].map(|p| net.add_node(DVec2::from_array(p)));
    if let Some(node) = net.node_mut(ends[1]) {
        node.kind = NodeKind::Roundabout {
            island_m: 6.1,
            ring_m: 5.0,
        };
    }
    for (from, to) in [(ends[0], ends[1]), (ends[1], ends[2])] {
        net.add_road(Road {
            id: RoadId(0),
            ends: [from, to],
            via_m: vec![DVec2::new(-0.1, 7.0)],
            offset_m: 0.0,
            left: vec![RoadLane::usual(LaneKind::Bus)],
            right: vec![RoadLane::usual(LaneKind::Drive), RoadLane::usual(LaneKind::Walk)],
            limit_kph: Some(30.0),
            crossings: vec![RoadCrossing {
                at_m: 5.0,
                width_m: 3.0,
            }],
            stops: vec![RoadStop {
                at_m: 3.0,
                right: true,
            }],
        });
    }
    net
}

/// A version with a star and a name, one without, and two lines.
fn kept() -> ProjectHistory {
    let version = |name: &str, starred, of: u32| KeptVersion {
        name: name.into(),
        label: "Add a car".into(),
        note: if starred { "0.4 s".into() } else { String::new() },
        starred,
        loom: Arc::new(alone_to_bytes(&sample(of)).expect("sound")),
    };
    ProjectHistory {
        versions: vec![version("before the rain", true, 1), version("", false, 2)],
        typed: vec!["add a car".into(), "regen \"x\"".into()],
        ..ProjectHistory::default()
    }
}

/// A bus that drives a path from the first half second on, a trailer behind it, and an ego vehicle that follows keyframes.
fn sample_clip() -> Clip {
    let object = |id: u32, class, x: f64| SceneBox {
        id: BoxId(id),
        class,
        center_m: DVec3::new(x, 4.0, 1.4),
        size_m: DVec3::new(6.0, 2.4, 2.8),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let voxels = |label: u8| {
        Arc::new(ObjectVoxels {
            lattice: scene::Lattice::OCC3D,
            from: [-9, 7],
            size: [3, 2],
            labels: (0..6 * 16)
                .map(|at| match (at / 16, at % 16) {
                    (i, 0..7) if i != 1 => label,
                    _ => Class::FREE,
                })
                .collect(),
        })
    };
    let track = |made: SceneBox, motion, settled| Track {
        made,
        motion,
        there_s: [Some(0.5), None],
        voxels: voxels(made.class.id()),
        settled,
        own_shape: false,
    };
    let path = Motion::Path(scene::clip::Path {
        points_m: vec![
            DVec2::new(-5.0, 4.0),
            DVec2::new(1.0 / 3.0, 4.0),
            DVec2::new(30.0, 9.0),
        ],
        start_m: 0.1,
        speeds: vec![
            scene::clip::Speed {
                time_s: 0.0,
                mps: 3.0,
            },
            scene::clip::Speed {
                time_s: 2.0,
                mps: 7.5,
            },
        ],
        rear_first: false,
    });
    let behind = Motion::Attached {
        to: BoxId(9),
        at_m: DVec2::new(-7.0, 0.0),
        yaw_deg: 2.0,
    };
    let key = |time_s: f64, x: f64| Key {
        time_s,
        at_m: DVec2::new(x, 0.0),
        yaw_deg: x,
    };
    let tracks = [
        track(object(9, Class::Bus, -5.0), path, true),
        track(object(10, Class::Trailer, -12.0), behind, false),
    ];
    Clip {
        length_s: 2.5,
        rate_hz: 12.0,
        ego: Some(Motion::Keys(vec![key(0.0, 0.0), key(2.0, 1.0 / 3.0)])),
        tracks: tracks.into_iter().map(|t| (t.made.id, t)).collect(),
    }
}

fn bundled(version: u32) -> PathBuf {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/reference/loom");
    PathBuf::from(root).join(format!("v{version}.loom"))
}

pub(super) fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(
        (
            &a.name,
            &a.prompt,
            &a.conditions,
            &a.words,
            &a.rig,
            &a.background,
            a.time_s(),
            a.seed
        ),
        (
            &b.name,
            &b.prompt,
            &b.conditions,
            &b.words,
            &b.rig,
            &b.background,
            b.time_s(),
            b.seed
        )
    );
    assert!(a.canvas() == b.canvas(), "the canvas differs");
    assert!(a.clip() == b.clip(), "the clip differs");
    assert_eq!(a.kept.typed, b.kept.typed);
    assert_eq!(a.kept.versions.len(), b.kept.versions.len());
    for (x, y) in a.kept.versions.iter().zip(&b.kept.versions) {
        let about = |v: &KeptVersion| (v.name.clone(), v.label.clone(), v.note.clone(), v.starred);
        assert_eq!(about(x), about(y));
        // A version inside a file is of the version that wrote it.
        let [x, y] = [x, y].map(|v| from_bytes(&v.loom).expect("sound"));
        assert_same(&x, &y);
    }
    assert_eq!(a.roads, b.roads);
    assert_eq!(a.arranged, b.arranged);
    super::recording_tests::assert_same_sweeps(a, b);
    match (&a.kept.log, &b.kept.log) {
        (Some(a), Some(b)) => super::log_tests::assert_same_log(a, b),
        (a, b) => assert!(a.is_none() && b.is_none(), "one has a log"),
    }
}

#[test]
fn unsound_groups_are_refused() {
    let mut scene = sample(VERSION);
    let mut arranged = arranged(&scene);
    arranged.groups.push(arranged.groups[0].clone());
    scene.arranged = Arc::new(arranged);
    let error = to_bytes(&scene).expect_err("refused").to_string();
    assert!(error.contains("group 1 has a member of another group"), "{error}");
}

#[test]
fn a_file_of_every_version_opens_as_what_it_holds() {
    let oldest = migrate::ALL.first().map_or(VERSION, |step| step.from);
    for version in oldest..=VERSION {
        let found = load(&bundled(version)).expect("a bundled file");
        assert_same(&found, &sample(version));
        // And it is itself of that version, not rewritten by accident.
        let entries = unpack(&std::fs::read(bundled(version)).expect("there"));
        let manifest = String::from_utf8(entries[0].1.clone()).expect("JSON");
        assert!(manifest.contains(&format!("\"version\":{version}")), "{manifest}");
    }
}

#[test]
fn unsound_roads_are_refused() {
    let mut scene = sample(VERSION);
    let mut net = roads();
    net.roads[0].ends[1] = NodeId(99);
    scene.roads = Arc::new(net);
    let error = to_bytes(&scene).expect_err("refused").to_string();
    assert!(
        error.contains("road 1 ends at node 99, which does not exist"),
        "{error}"
    );
}

#[test]
fn objects_whose_voxels_are_their_own_stay_so() {
    let mut scene = sample(VERSION);
    scene.change_clip(|clip| clip.tracks.values_mut().for_each(|t| t.own_shape = t.settled));
    let read = from_bytes(&to_bytes(&scene).expect("sound")).expect("sound");
    assert_same(&read, &scene);
    assert!(read.clip().tracks.values().any(|t| t.own_shape));
}

/// Written once when a version begins, and kept: `cargo test -p sceneloom-formats --lib -- --ignored bundled_file`.
#[test]
#[ignore = "writes the bundled file of the present version"]
fn write_the_bundled_file() {
    let path = bundled(VERSION);
    assert!(!path.exists(), "{} is there and stays", path.display());
    save(&path, &sample(VERSION)).expect("written");
}

#[test]
fn each_step_leads_to_the_next_and_the_last_to_the_present() {
    let from: Vec<u32> = migrate::ALL.iter().map(|step| step.from).collect();
    let first = from.first().copied().unwrap_or(VERSION);
    assert_eq!(from, (first..VERSION).collect::<Vec<_>>());
    assert!(migrate::ALL.iter().all(|step| !step.what.is_empty()));
}

pub(super) fn unpack(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut zip = ZipArchive::new(Cursor::new(bytes)).expect("a zip");
    let mut entry = |i| {
        let mut entry = zip.by_index(i).expect("listed");
        let mut content = Vec::new();
        entry.read_to_end(&mut content).expect("whole");
        (entry.name().expect("a name").into_owned(), content)
    };
    (0..zip_len(bytes)).map(&mut entry).collect()
}

fn zip_len(bytes: &[u8]) -> usize {
    ZipArchive::new(Cursor::new(bytes)).expect("a zip").len()
}

pub(super) fn pack(entries: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        zip.start_file(name.as_str(), SimpleFileOptions::default())
            .expect("written");
        zip.write_all(content).expect("written");
    }
    zip.finish().expect("written").into_inner()
}

/// A version that never was: the prompt was called `style`, and a voxel that is free held 255.
fn of_version_0() -> Vec<u8> {
    let mut entries = unpack(&std::fs::read(bundled(1)).expect("there"));
    for (name, content) in &mut entries {
        let text = |content: &[u8], from, to| {
            let text = String::from_utf8(content.to_vec()).expect("JSON");
            assert!(text.contains(from), "{from}");
            text.replace(from, to).into_bytes()
        };
        match name.as_str() {
            "manifest.json" => *content = text(content, "\"version\":1", "\"version\":0"),
            "scene.json" => *content = text(content, "\"prompt\":", "\"style\":"),
            "frames/00000/occupancy.u8" => {
                "frames/00000/grid.u8".clone_into(name);
                content
                    .iter_mut()
                    .filter(|v| **v == Class::FREE)
                    .for_each(|v| *v = 255);
            }
            _ => {}
        }
    }
    pack(&entries)
}

const FROM_0: Migration = Migration {
    from: 0,
    what: "the prompt by its name, and 17 for free voxels",
    change: MigrationChange::Rewrites(|old: &mut dyn Entries| {
        let scene = old.scene()?;
        let style = scene.as_object_mut().and_then(|o| o.remove("style"));
        let style = style.ok_or_else(|| ProjectError::Unsound("scene.json: style is missing".into()))?;
        scene["prompt"] = style;
        let mut grid = old.take("frames/00000/grid.u8", 640_000)?;
        grid.iter_mut()
            .filter(|v| **v == 255)
            .for_each(|v| *v = Class::FREE);
        old.put("frames/00000/occupancy.u8", grid);
        Ok(())
    }),
};

#[test]
fn an_older_version_goes_through_every_step() {
    let [v1, v2, v3, v4, v5, v6, v7, v8, v9, v10, v11] = migrate::ALL;
    let chain = [FROM_0, v1, v2, v3, v4, v5, v6, v7, v8, v9, v10, v11];
    let found = read::read(Cursor::new(of_version_0()), &chain).expect("version 0 opens");
    assert_same(&found, &sample(1));
    // The steps are for their versions only.
    let now = to_bytes(&sample(VERSION)).expect("sound");
    assert_same(
        &read::read(Cursor::new(now), &chain).expect("the present version"),
        &sample(VERSION),
    );
    // What a step cannot take over is one line, and what it leaves lying is named.
    let mut entries = unpack(&of_version_0());
    entries.push(("frames/00000/more.u8".into(), vec![0; 3]));
    let line = read::read(Cursor::new(pack(&entries)), &chain)
        .expect_err("too much")
        .to_string();
    assert_eq!(line, "entry \"frames/00000/more.u8\" is not known");
    let mut entries = unpack(&of_version_0());
    entries[1].1 = b"{}".to_vec();
    let line = read::read(Cursor::new(pack(&entries)), &chain)
        .expect_err("no style")
        .to_string();
    assert_eq!(line, "scene.json: style is missing");
}

/// Frames of versions 1 to 4 that show an object elsewhere are a track, and a vehicle that is elsewhere a motion.
#[test]
fn frames_of_an_older_version_become_a_clip() {
    let mut entries = unpack(&std::fs::read(bundled(4)).expect("there"));
    entries[0].1 = br#"{"format":"sceneloom","version":4,"frames":2}"#.to_vec();
    let mut scene: serde_json::Value = serde_json::from_slice(&entries[1].1).expect("JSON");
    let first = scene["frames"][0].clone();
    let mut second = first.clone();
    second["time_s"] = (first["time_s"].as_f64().expect("a time") + 0.5).into();
    second["world_from_ego"]["translation_m"] = serde_json::json!([2.0, 0.0, 0.0]);
    second["boxes"][0]["center_m"][0] = 8.0.into(); // 10 m ahead of where the vehicle was
    scene["frames"] = serde_json::json!([first, second]);
    scene["current"] = 1.into();
    entries[1].1 = serde_json::to_vec(&scene).expect("JSON");
    let copies: Vec<_> = entries[2..]
        .iter()
        .map(|(name, bytes)| (name.replace("00000", "00001"), bytes.clone()))
        .collect();
    entries.extend(copies);
    let found = from_bytes(&pack(&entries)).expect("opens");
    let clip = found.clip();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(near(clip.length_s, 0.5) && near(clip.rate_hz, 2.0) && near(found.time_s(), 0.5));
    assert!(found.canvas().boxes.is_empty());
    let b = found.frame().boxes[&BoxId(4)];
    assert!((b.center_m.x - 10.0).abs() < 1e-9, "{b:?}");
    assert!((found.at(0.0).frame().boxes[&BoxId(4)].center_m.x - 10.0 / 3.0).abs() < 1e-9);
    assert_eq!(found.frame().world_from_ego.translation_m.x, 2.0);
    let cars = |s: &Scene| s.frame().occupancy.class_counts()[Class::Car as usize];
    assert!(cars(&found) > 100, "{} voxels", cars(&found));
    // It is a scene like any other.
    let again = from_bytes(&to_bytes(&found).expect("sound")).expect("opens");
    assert_same(&found, &again);
}

#[test]
fn a_clip_that_is_not_sound_is_refused_in_one_line() {
    let bytes = to_bytes(&sample(VERSION)).expect("sound");
    for (from, to, line) in [
        (
            "\"length_s\":2.5",
            "\"length_s\":1e6",
            "scene.json: clip: a clip of 1000000 s, expected 0 to 600",
        ),
        (
            "\"time_s\":2.0,\"mps\":7.5",
            "\"time_s\":0.0,\"mps\":7.5",
            "scene.json: clip: track 9: speed 1 at 0 s is at the same time",
        ),
        (
            "\"to\":9",
            "\"to\":10",
            "scene.json: clip: track 10: attached in a circle",
        ),
        (
            "\"voxels_size\":[3,2]",
            "\"voxels_size\":[3,3]",
            "entry \"tracks/0000000009.u8\" has the wrong size: expected 144 voxels",
        ),
        (
            "\"voxels_size\":[3,2]",
            "\"voxels_size\":[3,999999999]",
            "scene.json: track 9: voxels of 3 x 999999999 columns",
        ),
    ] {
        let mut entries = unpack(&bytes);
        let text = String::from_utf8(entries[1].1.clone()).expect("JSON");
        assert!(text.contains(from), "{text}");
        entries[1].1 = text.replace(from, to).into_bytes();
        let found = from_bytes(&pack(&entries)).expect_err("no clip").to_string();
        assert!(found.starts_with(line) && found.lines().count() == 1, "{found}");
    }
}

#[test]
fn a_map_that_is_none_is_refused_in_one_line() {
    let bytes = to_bytes(&sample(VERSION)).expect("sound");
    for (from, to, line) in [
        (
            "\"columns\":[230,203]",
            "\"columns\":[230,0]",
            "scene.json: canvas: a map of 230 x 0 columns, expected sides of 1 to 8192",
        ),
        (
            "\"columns\":[230,203]",
            "\"columns\":[8192,8192]",
            "scene.json: canvas: a map of 8192 x 8192 columns",
        ),
        (
            "\"columns\":[230,203]",
            "\"columns\":[203,203]",
            "entry \"canvas/layout.u32\" has the wrong size: expected 41209 cells",
        ),
        (
            "\"from\":[-120,-100]",
            "\"from\":[2147483647,-100]",
            "scene.json: canvas: a map from column [2147483647, -100]",
        ),
    ] {
        let mut entries = unpack(&bytes);
        let text = String::from_utf8(entries[1].1.clone()).expect("JSON");
        assert!(text.contains(from), "{text}");
        entries[1].1 = text.replace(from, to).into_bytes();
        let found = from_bytes(&pack(&entries)).expect_err("no map").to_string();
        assert!(found.starts_with(line) && found.lines().count() == 1, "{found}");
    }
}

#[test]
fn versions_that_nobody_knows_are_refused_in_one_line() {
    let line = from_bytes(&of_version_0())
        .expect_err("no step from 0")
        .to_string();
    assert_eq!(
        line,
        format!("manifest.json: version is 0, expected {VERSION}; open it with the sceneloom that wrote it")
    );
    let next = (VERSION + 1).to_string();
    for version in [&next, "4294967298", "18446744073709551615"] {
        let manifest = format!("{{\"format\":\"sceneloom\",\"version\":{version},\"new\":[]}}");
        let bytes = pack(&[("manifest.json".to_owned(), manifest.into_bytes())]);
        let line = from_bytes(&bytes).expect_err("newer").to_string();
        assert!(
            line.starts_with(&format!(
                "manifest.json: version is {version}, expected {VERSION};"
            )),
            "{line}"
        );
    }
}
