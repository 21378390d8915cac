//! Tests of versions: files of every one open, steps lead from the oldest to the present one, a newer one is refused.

use std::io::{Cursor, Read, Write};
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::background::{Background, Form, Tree, TreeKind};
use scene::{
    BevLayer, BevLayout, BoxId, Class, Conditions, Extent, Frame, Relief, Scene, SceneBox, SensorRig,
    TimeOfDay, VoxelGrid, Weather,
};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use super::migrate::{self, Change, Entries, Migration};
use super::*;

/// What the bundled file of a version holds.
fn sample(version: u32) -> Scene {
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
    let mut scene = Scene::single(&name, frame, Arc::new(SensorRig::default()), u64::MAX);
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
        scene.background = Arc::new(background);
    }
    scene
}

fn bundled(version: u32) -> PathBuf {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/reference/loom");
    PathBuf::from(root).join(format!("v{version}.loom"))
}

fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(
        (
            &a.name,
            &a.prompt,
            &a.conditions,
            &a.words,
            &a.rig,
            &a.background,
            a.current,
            a.seed
        ),
        (
            &b.name,
            &b.prompt,
            &b.conditions,
            &b.words,
            &b.rig,
            &b.background,
            b.current,
            b.seed
        )
    );
    assert!(a.frames == b.frames, "a frame differs");
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
        assert!(
            manifest.contains(&format!("\"version\":{version},")),
            "{manifest}"
        );
    }
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

fn unpack(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
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

fn pack(entries: &[(String, Vec<u8>)]) -> Vec<u8> {
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
    let mut entries = unpack(&to_bytes(&sample(1)).expect("sound"));
    for (name, content) in &mut entries {
        let text = |content: &[u8], from, to| {
            let text = String::from_utf8(content.to_vec()).expect("JSON");
            assert!(text.contains(from), "{from}");
            text.replace(from, to).into_bytes()
        };
        match name.as_str() {
            "manifest.json" => *content = text(content, "\"version\":4", "\"version\":0"),
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
    change: Change::Rewrites(|old: &mut dyn Entries| {
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
    let [v1, v2, v3] = migrate::ALL;
    let chain = [FROM_0, v1, v2, v3];
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

#[test]
fn a_map_that_is_none_is_refused_in_one_line() {
    let bytes = to_bytes(&sample(VERSION)).expect("sound");
    for (from, to, line) in [
        (
            "\"columns\":[230,203]",
            "\"columns\":[230,0]",
            "scene.json: frame 0: a map of 230 x 0 columns, expected sides of 1 to 8192",
        ),
        (
            "\"columns\":[230,203]",
            "\"columns\":[8192,8192]",
            "scene.json: frame 0: a map of 8192 x 8192 columns",
        ),
        (
            "\"columns\":[230,203]",
            "\"columns\":[203,203]",
            "entry \"frames/00000/layout.u32\" has the wrong size: expected 41209 cells",
        ),
        (
            "\"from\":[-120,-100]",
            "\"from\":[2147483647,-100]",
            "scene.json: frame 0: a map from column [2147483647, -100]",
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
        "manifest.json: version is 0, expected 4; open it with the sceneloom that wrote it"
    );
    for version in ["5", "4294967298", "18446744073709551615"] {
        let manifest = format!("{{\"format\":\"sceneloom\",\"version\":{version},\"new\":[]}}");
        let bytes = pack(&[("manifest.json".to_owned(), manifest.into_bytes())]);
        let line = from_bytes(&bytes).expect_err("newer").to_string();
        assert!(
            line.starts_with(&format!("manifest.json: version is {version}, expected 4;")),
            "{line}"
        );
    }
}
