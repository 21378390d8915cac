//! Project files: what is saved comes back, equal scenes give equal bytes, and no bad file does harm.

use editor::Apply;
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::sync::Arc;

use editor::{Document, Edit, Shape};
use formats::loom::{self, ProjectError};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use scene::draft::draft;
use scene::{
    BevLayer, BevLayout, BoxId, Class, Conditions, Frame, Key, Motion, Polyline, PolylineKind, Pose, Scene,
    SceneBox, SensorRig, TimeOfDay, VoxelGrid, Weather,
};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// A canvas with edits since its source and paint, a truck that moves, and a vehicle that does.
fn clip() -> Scene {
    let mut layout = BevLayout::default();
    for x in 0..200 {
        for y in 80..120 {
            layout.set(BevLayer::DrivableArea, x, y, true);
            layout.set(BevLayer::LaneDivider, x, y, y == 100);
        }
    }
    layout.polylines = Arc::new(vec![Polyline {
        kind: PolylineKind::LaneDivider,
        points_m: vec![
            DVec2::new(-40.0, 0.2),
            DVec2::new(0.1 + 0.2, 1.0 / 3.0),
            DVec2::new(40.0, -0.0),
        ],
    }]);
    let car = SceneBox {
        id: BoxId(4),
        class: Class::Car,
        center_m: DVec3::new(10.0 / 3.0, -std::f64::consts::PI, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.123_456_789_012_345_68,
        velocity_mps: DVec2::new(5e-324, -1.0),
        label: Default::default(),
    };
    let boxes: BTreeMap<_, _> = [(car.id, car)].into();
    let occupancy = draft(&layout, boxes.values());
    let settled = Frame::new(layout, boxes, occupancy);
    let mut scene = Scene::single(
        "Ümläut \"quoted\"\n",
        settled.clone(),
        Arc::new(SensorRig::default()),
        u64::MAX,
    );
    scene.prompt = "night, rain".into();
    scene.conditions = Conditions {
        wetness: 0.3,
        visibility_m: 1e3 / 3.0,
        sun: Some(scene::Sun {
            azimuth_deg: -12.5,
            elevation_deg: 1.0 / 3.0,
        }),
        ..Conditions::usual(TimeOfDay::Dusk, Weather::Snow, u64::MAX)
    };
    scene.change_canvas(|f| {
        f.world_from_ego = Pose::from_wxyz([0.7, -0.1, 0.2, -0.6], [1e3 / 3.0, -2.0, 0.1])
    });
    for edit in [
        Edit::RemoveBox { id: BoxId(4) },
        Edit::PaintBev {
            layer: BevLayer::Walkway,
            shape: Shape::Disc {
                center_m: DVec2::new(3.0, 9.0),
                radius_m: 2.0,
            },
            value: true,
        },
    ] {
        edit.apply(&mut scene).expect("sound");
    }
    let paint = Edit::PaintVoxels {
        cells: vec![[0, 0, 0], [199, 199, 15], [100, 100, 8]],
        class: Class::Manmade,
    };
    paint.apply(&mut scene).expect("inside");
    let erase = Edit::PaintVoxels {
        cells: vec![[100, 100, 0]],
        class: Class::Free,
    };
    erase.apply(&mut scene).expect("inside");
    // A source whose lines differ from the canvas's.
    scene.change_canvas(|f| f.layout.polylines = Arc::default());
    let truck = SceneBox {
        id: BoxId(11),
        class: Class::Truck,
        center_m: DVec3::new(-20.0, 2.0, 1.5),
        size_m: DVec3::new(8.0, 2.5, 3.0),
        ..car
    };
    let key = |time_s: f64, x: f64| Key {
        time_s,
        at_m: DVec2::new(x, 2.0),
        yaw_deg: 1.0 / 3.0,
    };
    let moves = |id, keys| Edit::SetMotion {
        id,
        motion: Some(Motion::Keys(keys)),
        from_s: None,
        to_s: Some(1.9),
    };
    for edit in [
        Edit::from(truck),
        moves(Some(truck.id), vec![key(0.0, -20.0), key(2.0, 1.0 / 3.0)]),
        moves(None, vec![key(0.0, 0.0), key(1.5, 9.0)]),
    ] {
        edit.apply(&mut scene).expect("sound");
    }
    scene.show(1.0);
    scene
}

fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(
        (&a.name, &a.prompt, a.conditions, a.time_s(), a.seed),
        (&b.name, &b.prompt, b.conditions, b.time_s(), b.seed)
    );
    assert_eq!(a.rig, b.rig);
    assert!(a.canvas() == b.canvas(), "the canvas differs");
    assert!(a.clip() == b.clip(), "the clip differs");
    assert!(a.frame() == b.frame(), "the frame that is shown differs");
}

fn bytes() -> Vec<u8> {
    loom::to_bytes(&clip()).expect("sound")
}

/// The entries of a project, to be changed and packed again.
fn unpack(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut zip = ZipArchive::new(Cursor::new(bytes)).expect("a zip");
    (0..zip.len())
        .map(|i| {
            let mut entry = zip.by_index(i).expect("listed");
            let mut content = Vec::new();
            entry.read_to_end(&mut content).expect("whole");
            (entry.name().expect("a name").into_owned(), content)
        })
        .collect()
}

fn pack(entries: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        zip.start_file(name.as_str(), SimpleFileOptions::default())
            .expect("written");
        zip.write_all(content).expect("written");
    }
    zip.finish().expect("written").into_inner()
}

/// What is said about a project in which one entry was changed (`None`: left out).
fn refusal(entry: &str, change: impl FnOnce(Vec<u8>) -> Option<Vec<u8>>) -> String {
    let mut entries = unpack(&bytes());
    let at = entries
        .iter()
        .position(|(name, _)| name == entry)
        .expect("an entry of the clip");
    let (name, content) = entries.remove(at);
    if let Some(content) = change(content) {
        entries.insert(at, (name, content));
    }
    text_of(loom::from_bytes(&pack(&entries)))
}

fn text_of(result: Result<Scene, ProjectError>) -> String {
    let text = match result {
        Err(e) => e.to_string(),
        Ok(_) => panic!("expected an error"),
    };
    assert!(!text.contains('\n') && !text.is_empty(), "one line: {text:?}");
    text
}

/// The same with a piece of text replaced.
fn json_refusal(entry: &str, from: &str, to: &str) -> String {
    refusal(entry, |content| {
        let text = String::from_utf8(content).expect("JSON is UTF-8");
        assert!(text.contains(from), "{from} in {entry}");
        Some(text.replacen(from, to, 1).into_bytes())
    })
}

#[test]
fn what_is_saved_comes_back() {
    let scene = clip();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("clip.loom");
    let written = loom::save(&path, &scene).expect("saved");
    assert_eq!(written, std::fs::metadata(&path).expect("there").len());
    let loaded = loom::load(&path).expect("loaded");
    assert_same(&scene, &loaded);
    assert_ne!(scene.rev, loaded.rev);
    println!("a clip: {written} bytes");
    // What was one memory is one memory again.
    let edited = loaded.canvas();
    let bricks = edited.source.occupancy.changed_bricks(&edited.occupancy).len();
    assert!(
        (1..12).contains(&bricks),
        "{bricks} bricks of a removed car, a dab and paint"
    );
}

#[test]
fn equal_scenes_give_equal_bytes() {
    let first = bytes();
    assert_eq!(first, bytes());
    let loaded = loom::from_bytes(&first).expect("sound");
    assert_eq!(first, loom::to_bytes(&loaded).expect("sound"));
    // And after a detour of edits that are undone.
    let mut document = Document::new(loaded);
    document
        .apply("Prompt", &Edit::SetPrompt { prompt: "x".into() })
        .expect("sound");
    document.apply("Clear", &Edit::ClearPaint {}).expect("sound");
    document.undo();
    document.undo();
    assert_eq!(first, loom::to_bytes(document.scene()).expect("sound"));
}

#[test]
fn only_what_differs_is_stored() {
    let names: Vec<String> = unpack(&bytes()).into_iter().map(|(name, _)| name).collect();
    assert_eq!(
        names,
        [
            "manifest.json",
            "scene.json",
            "canvas/layout.u32",
            "canvas/occupancy.u8",
            "canvas/painted.u8",
            "canvas/source_layout.u32",
            "canvas/source_occupancy.u8",
            "tracks/0000000011.u8",
        ]
    );
    // Packing by another tool, in another order, is as good.
    let mut entries = unpack(&bytes());
    entries.reverse();
    assert_same(&loom::from_bytes(&pack(&entries)).expect("sound"), &clip());
}

/// Row 62 of the extremes table: a file cut short anywhere.
#[test]
fn row_62_truncated() {
    let whole = bytes();
    let lengths = (0..64)
        .chain((64..whole.len()).step_by(97))
        .chain(whole.len().saturating_sub(600)..whole.len());
    for length in lengths {
        text_of(loom::from_bytes(&whole[..length]));
    }
    assert_eq!(
        text_of(loom::from_bytes(b"")).split(" (").next(),
        Some("not a .loom project, or cut short")
    );
    text_of(loom::from_bytes(b"{\"format\": \"sceneloom\"}"));
    text_of(loom::from_bytes(&[0xff; 4096]));
}

/// Row 62: any flipped bit is noticed, or lies where it means nothing (a time stamp, say).
#[test]
fn row_62_flipped_bits() {
    let scene = clip();
    let whole = loom::to_bytes(&scene).expect("sound");
    let (mut noticed, mut harmless) = (0, 0);
    // The ends are the zip's own records, with the largest share of bytes that say nothing.
    let tail = whole.len() - 400;
    let places = (0..200).chain((200..tail).step_by(23)).chain(tail..whole.len());
    for (i, at) in places.enumerate() {
        let mut bad = whole.clone();
        bad[at] ^= 1 << (i % 8);
        match loom::from_bytes(&bad) {
            Ok(loaded) => {
                assert_same(&loaded, &scene);
                harmless += 1;
            }
            Err(e) => {
                assert!(!e.to_string().contains('\n'));
                noticed += 1;
            }
        }
    }
    println!("{noticed} flips noticed, {harmless} harmless");
    assert!(noticed > 3 * harmless);
}

/// Row 62: entries that lie about their size or are far larger than a scene can be.
#[test]
fn row_62_bombs() {
    let zeros = |n: usize| refusal("canvas/occupancy.u8", move |_| Some(vec![0; n]));
    assert_eq!(
        zeros(50_000_000),
        "entry \"canvas/occupancy.u8\" has the wrong size: expected 640000 voxels, found 50000000"
    );
    // 65 MiB of blanks pack into 64 KiB.
    let mut blanks = vec![b' '; 65 << 20];
    blanks[0] = b'{';
    assert_eq!(
        refusal("scene.json", |_| Some(blanks)),
        format!(
            "the size of scene.json is {}, expected at most {}",
            65 << 20,
            64 << 20
        )
    );
    // The declared size understates the content: the stream is longer than the header says.
    let whole = bytes();
    let declared = 640_000u32.to_le_bytes();
    let mut lied = whole.clone();
    let mut at = 0;
    while let Some(found) = lied[at..].windows(4).position(|w| w == declared) {
        at += found;
        lied[at..at + 4].copy_from_slice(&600_000u32.to_le_bytes());
        at += 4;
    }
    assert!(text_of(loom::from_bytes(&lied)).contains("occupancy.u8"));
    // More voxels of a track than allowed, said in a few bytes.
    let many = refusal("scene.json", |content| {
        let mut json: serde_json::Value = serde_json::from_slice(&content).expect("JSON");
        json["clip"]["tracks"][0]["voxels_size"] = serde_json::json!([65_536, 2]);
        Some(serde_json::to_vec(&json).expect("JSON"))
    });
    assert_eq!(
        many,
        "scene.json: track 11: voxels of 65536 x 2 columns, expected at most 65536"
    );
    // A deep nest of brackets ends in an error, not in the stack's end.
    let text = refusal("scene.json", |_| Some(vec![b'['; 1 << 20]));
    assert!(text.contains("scene.json"), "{text}");
}

/// Row 62: values that no grid or number may have.
#[test]
fn row_62_values() {
    let label = refusal("canvas/occupancy.u8", |mut v| {
        v[(7 * 200 + 3) * 16 + 5] = 18;
        Some(v)
    });
    assert_eq!(
        label,
        "entry \"canvas/occupancy.u8\": voxel [7, 3, 5] holds 18, expected 0 to 17"
    );
    let paint = refusal("canvas/painted.u8", |mut v| {
        v[0] = 254;
        Some(v)
    });
    assert!(
        paint.contains("voxel [0, 0, 0] holds 254, expected 0 to 17 or 255"),
        "{paint}"
    );
    let short = refusal("canvas/layout.u32", |v| Some(v[..4000].to_vec()));
    assert_eq!(
        short,
        "entry \"canvas/layout.u32\" has the wrong size: expected 40000 cells, found 1000"
    );
    let long = refusal("canvas/layout.u32", |mut v| {
        v.extend([0; 4]);
        Some(v)
    });
    assert!(long.contains("expected 40000 cells, found 40001"), "{long}");
    let object_bit = refusal("canvas/layout.u32", |mut v| {
        v[4 * 203 + 1] = 1;
        Some(v)
    });
    assert!(object_bit.contains("cell [1, 3] holds 256"), "{object_bit}");
    let nan = json_refusal(
        "scene.json",
        "\"yaw_rad\":0.12345678901234568",
        "\"yaw_rad\":null",
    );
    assert!(nan.contains("scene.json") && nan.contains("null"), "{nan}");
    let huge = json_refusal(
        "scene.json",
        "\"yaw_rad\":0.12345678901234568",
        "\"yaw_rad\":1e999",
    );
    assert!(huge.contains("number out of range"), "{huge}");
    let flat = json_refusal("scene.json", "[4.6,1.95,1.7]", "[4.6,0.0,1.7]");
    assert!(
        flat.contains("canvas: source: box 4: size_m is [4.6, 0, 1.7], expected above 0"),
        "{flat}"
    );
    let class = json_refusal("scene.json", "\"class\":\"car\"", "\"class\":\"terrain\"");
    assert!(class.contains("class is \"terrain\""), "{class}");
    let mut nowhere = clip();
    nowhere.change_canvas(|f| f.world_from_ego.rotation = glam::DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    let pose = loom::to_bytes(&nowhere).expect_err("no direction").to_string();
    assert!(pose.contains("quaternion of length 0, expected 1"), "{pose}");
    let rig = json_refusal("scene.json", "\"width\":1600", "\"width\":0");
    assert!(rig.contains("rig: camera CAM_FRONT_LEFT: size is 0x900"), "{rig}");
    let twice = json_refusal("scene.json", "\"id\":11,", "\"id\":12,");
    assert_eq!(twice, "entry \"tracks/0000000012.u8\" is missing");
}

#[test]
fn what_is_missing_or_unknown_is_named() {
    for (name, _) in unpack(&bytes()) {
        assert_eq!(refusal(&name, |_| None), format!("entry {name:?} is missing"));
    }
    let mut entries = unpack(&bytes());
    entries.push(("frames/00000/layout.u32".into(), vec![]));
    assert_eq!(
        text_of(loom::from_bytes(&pack(&entries))),
        "entry \"frames/00000/layout.u32\" is not known"
    );
    let key = json_refusal("scene.json", "\"seed\":", "\"sead\":1,\"seed\":");
    assert!(key.contains("unknown field `sead`"), "{key}");
    let key = json_refusal("scene.json", "\"painted\":", "\"colour\":1,\"painted\":");
    assert!(key.contains("unknown field `colour`"), "{key}");
    let key = json_refusal(
        "manifest.json",
        "\"version\":12",
        "\"version\":12,\"made_by\":\"me\"",
    );
    assert!(key.contains("unknown field `made_by`"), "{key}");
    let missing = json_refusal("scene.json", "\"seed\":18446744073709551615,", "");
    assert!(missing.contains("missing field `seed`"), "{missing}");
    let version = json_refusal("manifest.json", "\"version\":12", "\"version\":13,\"new_key\":0");
    assert_eq!(
        version,
        "manifest.json: version is 13, expected 12; open it with the sceneloom that wrote it"
    );
    let format = json_refusal("manifest.json", "\"sceneloom\"", "\"krita\"");
    assert_eq!(
        format,
        "manifest.json: format is \"krita\", expected \"sceneloom\""
    );
    // A zip of another kind.
    let other = pack(&[("word/document.xml".into(), vec![1, 2, 3])]);
    assert_eq!(
        text_of(loom::from_bytes(&other)),
        "entry \"manifest.json\" is missing"
    );
}

#[test]
fn errors_name_the_file_and_an_old_file_survives() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.loom");
    let text = text_of(loom::load(&path));
    assert!(text.starts_with(&path.display().to_string()), "{text}");
    std::fs::write(&path, b"not a zip").expect("written");
    let text = text_of(loom::load(&path));
    assert!(text.contains("a.loom: not a .loom project"), "{text}");
    loom::save(&path, &clip()).expect("saved");
    let good = std::fs::read(&path).expect("there");
    // A scene that cannot be stored is refused before the file is touched.
    let mut broken = clip();
    broken.change_canvas(|f| f.time_s = f64::NAN);
    let text = loom::save(&path, &broken).expect_err("NaN").to_string();
    assert!(
        text.contains("canvas: time_s is NaN, expected a finite number"),
        "{text}"
    );
    let mut broken = clip();
    broken.change_canvas(|f| f.occupancy.set(1, 2, 3, 40));
    let text = loom::save(&path, &broken).expect_err("no such label").to_string();
    assert!(text.contains("voxel [1, 2, 3] holds 40"), "{text}");
    let mut broken = clip();
    broken.change_clip(|clip| clip.length_s = f64::NAN);
    let text = loom::save(&path, &broken).expect_err("no length").to_string();
    assert!(text.contains("clip: a clip of NaN s"), "{text}");
    assert_eq!(std::fs::read(&path).expect("there"), good);
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..Default::default() })]

    /// Any numbers and any voxels come back to the last bit.
    #[test]
    fn round_trip(
        numbers in prop::array::uniform9(-999.0..999.0f64),
        tiny in prop::num::f64::SUBNORMAL,
        voxels in prop::collection::vec((0usize..200, 0usize..200, 0usize..16, 0u8..18), 0..200),
        seed in any::<u64>(),
        name in "\\PC{0,12}",
    ) {
        let b = SceneBox {
            id: BoxId(seed as u32),
            class: Class::Bus,
            center_m: DVec3::new(numbers[0], numbers[1], numbers[2]),
            size_m: DVec3::new(numbers[3], numbers[4], numbers[5]).abs() + 1e-3,
            yaw_rad: numbers[6],
            velocity_mps: DVec2::new(numbers[7], tiny),
            label: Default::default(),
        };
        let mut grid = VoxelGrid::new();
        for (x, y, z, class) in &voxels {
            grid.set(*x, *y, *z, *class);
        }
        let mut frame = Frame::new(BevLayout::default(), [(b.id, b)].into(), grid);
        frame.time_s = numbers[8];
        frame.world_from_ego = Pose::planar(numbers[0] * 1e3, numbers[1], numbers[2]);
        let scene = Scene::single(&name, frame, Arc::new(SensorRig::default()), seed);
        let bytes = loom::to_bytes(&scene).expect("sound");
        assert_same(&loom::from_bytes(&bytes).expect("sound"), &scene);
    }
}

/// Old files are drawn as their prompts were; newer ones have conditions.
#[test]
fn old_files_take_their_conditions_from_the_prompt() {
    let opened = |prompt: &str, version: u32| {
        let path = format!(
            "{}/tests/reference/loom/v{version}.loom",
            env!("CARGO_MANIFEST_DIR")
        );
        let mut entries = unpack(&std::fs::read(path).expect("a reference file"));
        let scene = entries.iter_mut().find(|e| e.0 == "scene.json").expect("there");
        let mut json: serde_json::Value = serde_json::from_slice(&scene.1).expect("JSON");
        let object = json.as_object_mut().expect("an object");
        object.insert("prompt".into(), prompt.into());
        assert_eq!(object.remove("conditions").is_some(), version > 2);
        scene.1 = json.to_string().into_bytes();
        loom::from_bytes(&pack(&entries))
    };
    for (prompt, time, weather) in [
        ("", TimeOfDay::Day, Weather::Clear),
        ("night, rain, downtown", TimeOfDay::Night, Weather::Rain),
        ("a foggy evening", TimeOfDay::Dusk, Weather::Fog),
        ("it is no longer raining", TimeOfDay::Day, Weather::Rain),
    ] {
        for version in [1, 2] {
            let scene = opened(prompt, version).expect("an old file");
            let usual = Conditions::usual(time, weather, scene.seed);
            assert_eq!(scene.conditions, usual, "{prompt}");
            assert_eq!(&*scene.prompt, prompt);
        }
    }
    assert_eq!(
        text_of(opened("night", 3))
            .split(" at line")
            .next()
            .unwrap_or_default(),
        "entry \"scene.json\": missing field `conditions`"
    );
    let damp = json_refusal("scene.json", "\"wetness\":0.3", "\"wetness\":1.3");
    assert_eq!(damp, "scene.json: conditions: wetness is 1.3, expected 0 to 1");
}

/// Background and relief, of the frame and of its source, come back bit for bit; a file of version 1 opens without either.
#[test]
fn background_and_relief_come_back_and_version_1_opens() {
    use scene::background::{Background, Form, LineKind, SceneryLine, Tree, TreeKind};
    use scene::{Relief, Thing, ThingId};
    let mut scene = clip();
    let mut background = Background::default();
    background.add(Form::Tree(Tree {
        position_m: DVec2::new(1.0 / 3.0, -7.1),
        height_m: 6.3,
        crown_radius_m: 1.7,
        kind: TreeKind::Conifer,
    }));
    let points_m = vec![DVec2::new(-3.0, 9.0), DVec2::new(8.0, 0.1 + 0.2)];
    background.insert(Thing {
        id: ThingId(9),
        form: Form::Line(SceneryLine::typical(LineKind::GuardRail, points_m)),
        look: 77,
        placed: true,
    });
    scene.background = Arc::new(background);
    scene.change_canvas(|frame| {
        let extent = scene::Extent::WINDOW;
        frame.layout.relief = Relief::from_fn(extent, |p| 0.031 * p.x - 0.4);
        Arc::make_mut(&mut frame.source).layout.relief = Relief::from_fn(extent, |p| 0.01 * p.y);
    });
    let bytes = loom::to_bytes(&scene).expect("sound");
    let back = loom::from_bytes(&bytes).expect("its own");
    assert_eq!(back.background, scene.background);
    assert_same(&back, &scene);
    assert_eq!(loom::to_bytes(&back).expect("sound"), bytes);

    let old = format!("{}/tests/reference/loom/v1.loom", env!("CARGO_MANIFEST_DIR"));
    let old = loom::load(std::path::Path::new(&old)).expect("version 1 opens");
    assert!(old.background.is_empty() && old.canvas().layout.relief.is_flat());

    // What is not sound is one line.
    let with = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut entries = unpack(&bytes);
        let relief = entries.iter_mut().find(|e| e.0 == "canvas/relief.f32");
        change(&mut relief.expect("there").1);
        text_of(loom::from_bytes(&pack(&entries)))
    };
    assert!(with(&|b| b.truncate(7)).contains("relief.f32"));
    assert!(with(&|b| b[..4].copy_from_slice(&f32::NAN.to_le_bytes())).contains("relief: height NaN"));
    assert!(with(&|b| b[..4].copy_from_slice(&1e6f32.to_le_bytes())).contains("1000000"));
}
