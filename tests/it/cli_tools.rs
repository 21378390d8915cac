//! `check`, `export` and `diff` on real scenes; exported files are read back by readers that share no code with the
//! writers.

use editor::Apply;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::DVec3;
use serde_json::Value;

use app::open;
use editor::Edit;
use formats::loom;
use scene::{BoxId, Class, Form, Scene, Window};
use sensors::lidar::rolling;

fn sceneloom(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .args(args)
        .output()
        .expect("the built program runs")
}

/// The one JSON object that a command prints, and its exit code.
fn run(args: &[&str]) -> (Value, i32) {
    let output = sceneloom(&[args, &["--json"]].concat());
    let text = String::from_utf8_lossy(&output.stdout);
    let error = String::from_utf8_lossy(&output.stderr);
    let json = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?}: {e}: {text}{error}"));
    (json, output.status.code().expect("an exit code"))
}

fn refused(args: &[&str], needle: &str) {
    let output = sceneloom(args);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert!(
        error.trim_end().lines().count() == 1 && error.contains(needle),
        "{args:?}: {error}"
    );
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }
    fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }
    fn save(&self, name: &str, scene: &Scene) -> String {
        let path = self.path(name);
        loom::save(Path::new(&path), scene).expect("saved");
        path
    }
}

fn world() -> Scene {
    let mut scene = open::from_template("straight", 3).expect("a template");
    scene.prompt = "night, rain".into();
    scene
}

fn apply(scene: &mut Scene, edit: Edit) {
    edit.apply(scene).expect("sound");
}

fn files(report: &Value) -> Vec<PathBuf> {
    let list = report["files"].as_array().expect("a list");
    list.iter()
        .map(|f| PathBuf::from(f.as_str().expect("a path")))
        .collect()
}

fn export(scene: &str, format: &str, out: &str, more: &[&str]) -> Vec<PathBuf> {
    let (report, code) = run(&[&["export", scene, "--format", format, "-o", out], more].concat());
    assert_eq!(code, 0);
    let files = files(&report);
    let bytes: u64 = files.iter().map(|f| f.metadata().expect("written").len()).sum();
    assert_eq!(report["bytes"].as_u64(), Some(bytes));
    files
}

/// A place on bare ground that is far from every box that stands.
fn free_place(scene: &Scene) -> DVec3 {
    let frame = scene.frame();
    let is_ground = |l: &u8| *l == Class::FREE || Class::from_id(*l).is_some_and(Class::is_ground);
    let is_bare = |at: DVec3| {
        let around = (-8..=8).flat_map(|x| (-8..=8).map(move |y| (0.4 * f64::from(x), 0.4 * f64::from(y))));
        around.into_iter().all(|(x, y)| {
            let column = frame.extent().column_at(at.x + x, at.y + y);
            column.is_some_and(|[x, y]| frame.occupancy.column(x, y).iter().all(is_ground))
        })
    };
    let is_far = |at: DVec3| {
        let standing = frame.boxes.values().filter(|b| b.center_m.z < 10.0);
        standing.into_iter().all(|b| b.center_m.distance(at) > 12.0)
    };
    let places =
        (-9..=9).flat_map(|x| (-9..=9).map(move |y| 4.0 * DVec3::new(f64::from(x), f64::from(y), 0.0)));
    let mut free = places.filter(|at| is_far(*at) && is_bare(*at));
    free.next().expect("a free place")
}

#[test]
fn checks_tell_by_exit_code_and_fix() {
    let dir = Folder::new();
    let mut scene = world();
    let path = dir.save("good.loom", &scene);
    let (report, code) = run(&["check", &path]);
    assert_eq!((code, report["errors"].as_u64()), (0, Some(0)), "{report:#}");
    // One box far above free ground, one twice.
    let first = *scene.frame().boxes.values().next().expect("traffic");
    let add = |id: u32, center_m: DVec3| Edit::AddBox {
        class: first.class,
        center_m,
        size_m: first.size_m,
        yaw_deg: first.yaw_rad.to_degrees(),
        velocity_mps: None,
        id: Some(BoxId(id)),
        label: Default::default(),
    };
    apply(&mut scene, add(900, first.center_m));
    let above = free_place(&scene) + DVec3::Z * 20.0;
    apply(&mut scene, add(901, above));
    let path = dir.save("bad.loom", &scene);
    let (report, code) = run(&["check", &path]);
    assert_eq!((code, report["errors"].as_u64()), (1, Some(2)), "{report:#}");
    let findings = report["findings"].as_array().expect("a list");
    let of = |id: u64| {
        findings
            .iter()
            .find(|f| f["box"] == id)
            .unwrap_or_else(|| panic!("{report:#}"))
    };
    assert_eq!(
        (&of(900)["check"], &of(900)["severity"]),
        (&"unsound".into(), &"error".into())
    );
    assert_eq!(of(901)["check"], "out_of_range");
    let x = of(901)["where_m"][0].as_f64().expect("a number");
    assert!((x - above.x).abs() < 1e-3);
    // Repaired in a new file; the old one stays.
    let before = std::fs::read(&path).expect("there");
    let fixed = dir.path("fixed.loom");
    let (report, _) = run(&["check", &path, "--fix", "-o", &fixed]);
    assert!(report["fixed"].as_u64() >= Some(2), "{report:#}");
    assert_eq!(std::fs::read(&path).expect("there"), before);
    let repaired = loom::load(Path::new(&fixed)).expect("a scene");
    assert!(!repaired.frame().boxes.contains_key(&BoxId(900)));
    refused(&["check", &dir.path("none.loom")], "none.loom");
    refused(&["check", &path, "-o", &fixed], "--fix");
}

#[test]
fn occupancy_and_boxes_are_read_by_others() {
    let dir = Folder::new();
    let scene = world();
    let frame = scene.frame();
    let path = dir.save("a.loom", &scene);
    // A folder gets the usual name.
    let written = export(&path, "occ3d", dir.0.path().to_str().expect("UTF-8"), &[]);
    assert_eq!(written[0].file_name().expect("a name"), "labels.npz");
    let file = std::fs::File::open(&written[0]).expect("there");
    let mut zip = zip::ZipArchive::new(file).expect("an archive");
    let array = npyz::NpyFile::new(zip.by_name("semantics.npy").expect("labels")).expect("an array");
    assert_eq!(array.shape(), [200, 200, 16]);
    assert_eq!(array.into_vec::<u8>().expect("bytes"), frame.occupancy.to_dense());

    let written = export(&path, "boxes", &dir.path("boxes.json"), &[]);
    let list: Value = serde_json::from_slice(&std::fs::read(&written[0]).expect("there")).expect("JSON");
    let boxes = list["boxes"].as_array().expect("a list");
    assert_eq!(boxes.len(), frame.boxes.len());
    for (found, b) in boxes.iter().zip(frame.boxes.values()) {
        assert_eq!(
            (&found["id"], &found["class"]),
            (&b.id.0.into(), &b.class.name().into())
        );
        assert_eq!(found["class_id"], b.class.id());
        for axis in 0..3 {
            assert_eq!(found["center_m"][axis], b.center_m[axis]);
            assert_eq!(found["size_m"][axis], b.size_m[axis]);
        }
        let [w, z] = [0, 3].map(|i| found["rotation_wxyz"][i].as_f64().expect("a number"));
        let gap = (2.0 * z.atan2(w) - b.yaw_rad).rem_euclid(std::f64::consts::TAU);
        assert!(gap.min(std::f64::consts::TAU - gap) < 1e-9);
        assert!(found["num_lidar_pts"].is_u64());
    }
    assert!(boxes.iter().any(|b| b["num_lidar_pts"].as_u64() > Some(20)));
}

/// Scalars of a binary little-endian PLY by name of the property, parsed from the header alone.
fn ply(bytes: &[u8]) -> HashMap<String, Vec<f64>> {
    let end = bytes
        .windows(11)
        .position(|w| w == b"end_header\n")
        .expect("a header")
        + 11;
    let header = std::str::from_utf8(&bytes[..end]).expect("text");
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
    let (mut count, mut properties) = (0, Vec::new());
    for line in header.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["element", "vertex", n] => count = n.parse().expect("a number"),
            ["property", kind, name] => properties.push((kind.to_owned(), name.to_owned())),
            _ => {}
        }
    }
    let (mut out, mut at) = (HashMap::<String, Vec<f64>>::new(), end);
    for _ in 0..count {
        for (kind, name) in &properties {
            let (value, size) = match kind.as_str() {
                "float" => (
                    f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"))),
                    4,
                ),
                "ushort" => (
                    f64::from(u16::from_le_bytes(bytes[at..at + 2].try_into().expect("two"))),
                    2,
                ),
                "uchar" => (f64::from(bytes[at]), 1),
                other => panic!("unknown type {other}"),
            };
            out.entry(name.clone()).or_default().push(value);
            at += size;
        }
    }
    assert_eq!(at, bytes.len(), "nothing is left over");
    out
}

#[test]
fn lidar_files_hold_the_sweep() {
    let dir = Folder::new();
    let scene = world();
    let path = dir.save("a.loom", &scene);
    let sweep = rolling::exact(&scene);
    let written = export(&path, "ply", &dir.path("cloud.ply"), &[]);
    let found = ply(&std::fs::read(&written[0]).expect("there"));
    assert_eq!(found["x"].len(), sweep.points.len());
    for (i, p) in sweep.points.iter().enumerate() {
        let at = [found["x"][i], found["y"][i], found["z"][i]];
        assert_eq!(at, p.position_in_ego.map(f64::from));
        assert_eq!(
            [found["ring"][i], found["class"][i]],
            [f64::from(p.ring), f64::from(p.class.id())]
        );
        assert_eq!(found["intensity"][i], f64::from(p.intensity));
    }
    // As the nuScenes devkit reads it: five floats a point, in the sensor's frame, the ground where vehicles stand.
    let written = export(&path, "nuscenes-lidar", &dir.path("top.pcd.bin"), &[]);
    let bytes = std::fs::read(&written[0]).expect("there");
    let floats: Vec<f32> = bytes
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().expect("four")))
        .collect();
    assert_eq!(floats.len(), 5 * sweep.points.len());
    let mount = scene.rig.lidars[0].ego_from_sensor();
    let mut ground = [0; 2];
    for (of, p) in floats.chunks_exact(5).zip(&sweep.points) {
        let in_ego = mount.apply(DVec3::new(of[0].into(), of[1].into(), of[2].into()));
        let before = DVec3::from_array(p.position_in_ego.map(f64::from));
        assert_eq!([of[3], of[4]], [p.intensity, f32::from(p.ring)]);
        let ways = [in_ego, before].map(|at| (at - mount.translation_m).normalize());
        assert!(ways[0].dot(ways[1]) > 1.0 - 1e-6);
        assert!(in_ego.z > before.z - 1e-3, "{in_ego} {before}");
        if p.class.is_ground() {
            ground = [ground[0] + usize::from(in_ego.z.abs() < 0.05), ground[1] + 1];
        }
    }
    assert!(ground[0] * 10 > ground[1] * 8 && ground[1] > 1000, "{ground:?}");
}

/// Chunks of a PNG: type and body.
fn chunks(png: &[u8]) -> Vec<(String, Vec<u8>)> {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let (mut at, mut out) = (8, Vec::new());
    while at < png.len() {
        let length = u32::from_be_bytes(png[at..at + 4].try_into().expect("four")) as usize;
        let kind = String::from_utf8_lossy(&png[at + 4..at + 8]).into_owned();
        out.push((kind, png[at + 8..at + 8 + length].to_vec()));
        at += 12 + length;
    }
    out
}

#[test]
fn camera_maps_and_views_are_pictures_that_say_what_they_show() {
    let dir = Folder::new();
    let scene = world();
    let path = dir.save("a.loom", &scene);
    let size = ["--size", "160x90"];
    let written = export(&path, "semantic", &dir.path("maps"), &size);
    assert_eq!(written.len(), 8);
    let classes: Value =
        serde_json::from_slice(&std::fs::read(dir.path("maps/classes.json")).expect("there")).expect("JSON");
    let mut names = HashMap::new();
    for class in classes["classes"].as_array().expect("a list") {
        let rgb = [0, 1, 2].map(|i| class["rgb"][i].as_u64().expect("a byte") as u8);
        names.insert(rgb, class["name"].as_str().expect("a name").to_owned());
    }
    let bytes = std::fs::read(dir.path("maps/CAM_FRONT_semantic.png")).expect("there");
    let parts = chunks(&bytes);
    assert_eq!(parts[0].1[8..10], [8, 3], "8 bits, palette");
    let text = parts
        .iter()
        .filter(|(kind, _)| kind == "iTXt")
        .map(|(_, b)| String::from_utf8_lossy(b).into_owned());
    assert!(
        text.clone()
            .any(|t| t.starts_with("Prompt") && t.ends_with("night, rain"))
    );
    assert!(text.clone().any(|t| t.starts_with("Seed") && t.ends_with('3')));
    let front = image::load_from_memory(&bytes).expect("a picture").to_rgb8();
    assert_eq!(front.dimensions(), (160, 90));
    // The road lies before the vehicle.
    assert_eq!(names[&front.get_pixel(80, 80).0], "driveable_surface");
    let seen: std::collections::HashSet<&str> = front.pixels().map(|p| names[&p.0].as_str()).collect();
    assert!(seen.len() > 4, "{seen:?}");

    let written = export(&path, "depth", &dir.path("maps"), &size);
    assert_eq!(written.len(), 7);
    let depth = image::open(dir.path("maps/CAM_FRONT_depth_mm.png"))
        .expect("a picture")
        .to_luma16();
    // The camera hangs 1.5 m above the road: the lowest row looks at it some metres ahead.
    let mm = depth.get_pixel(80, 89).0[0];
    assert!((2500..9000).contains(&mm), "{mm} mm");
    assert!(depth.get_pixel(80, 70).0[0] > mm, "farther up is farther away");

    let more = [
        "--view-size",
        "200x120",
        "--transparent",
        "--scale",
        "3",
        "--view",
        "top",
    ];
    let written = export(&path, "view", &dir.path("view.png"), &more);
    let view = image::open(&written[0]).expect("a picture").to_rgba8();
    assert_eq!(view.dimensions(), (200, 120));
    assert!(view.pixels().any(|p| p[3] == 0) && view.pixels().any(|p| p[3] == 255));
    refused(&["export", &path, "--format", "fbx", "-o", "x"], "occ3d");
    refused(&["export", &path, "--format", "ply"], "-o");
    refused(&["export", "--format", "ply", "-o", "x"], "scene");
    refused(
        &["export", &path, "--format", "view", "--view", "behind", "-o", "x"],
        "CAM_FRONT",
    );
    let (list, _) = run(&["export", "--format", "list"]);
    let formats = formats::export::all().len();
    assert_eq!(list["formats"].as_array().map(Vec::len), Some(formats));
}

#[test]
fn differences_are_counted() {
    let dir = Folder::new();
    let a = world();
    let mut b = a.clone();
    let id = *a.frame().boxes.keys().next().expect("traffic");
    apply(&mut b, Edit::RemoveBox { id });
    let removed_voxels = a.frame().occupancy.count_different(&b.frame().occupancy);
    // Far from the box and outside of what the edit inpaints.
    let cells = vec![[3, 3, 9], [3, 3, 10]];
    let changed = cells
        .iter()
        .filter(|c: &&[usize; 3]| a.frame().occupancy.get(c[0], c[1], c[2]) != Class::Barrier.id());
    let painted = changed.count();
    let class = Class::Barrier;
    apply(&mut b, Edit::PaintVoxels { cells, class });
    let (pa, pb) = (dir.save("a.loom", &a), dir.save("b.loom", &b));
    let sheet = dir.path("sheet.png");
    let (report, code) = run(&["diff", &pa, &pb, "-o", &sheet]);
    assert_eq!(code, 0);
    assert_eq!(report["boxes"]["removed"][0]["id"], id.0);
    assert_eq!(report["boxes"]["added"].as_array().map(Vec::len), Some(0));
    assert_eq!(
        report["voxels_changed"].as_u64(),
        Some((removed_voxels + painted) as u64)
    );
    assert_eq!(report["changed_outside_region"].as_u64(), Some(painted as u64));
    assert_eq!(
        report["changed_inside_region"].as_u64(),
        Some(removed_voxels as u64)
    );
    assert_eq!(
        report["voxels"]["barrier"]["gained"].as_u64(),
        Some(painted as u64)
    );
    assert!(report["lidar"]["rays_changed"].is_u64());
    let picture = image::open(&sheet).expect("a picture");
    assert!(picture.width() > 3 * Window::NY as u32);
    // Nothing differs from itself.
    let (report, _) = run(&["diff", &pa, &pa]);
    assert_eq!(report["voxels_changed"], 0);
    assert_eq!(report["layout"]["cells_changed"], 0);
    assert_eq!(report["lidar"]["rays_changed"], 0);
    let mut text = String::new();
    sceneloom(&["diff", &pa, &pb])
        .stdout
        .as_slice()
        .read_to_string(&mut text)
        .expect("text");
    assert!(text.contains("boxes: 0 added, 1 removed, 0 changed"), "{text}");
    // Things beside the road are listed, and their voxels belong to the edit.
    let mut c = a.clone();
    let ids: Vec<_> = c.background.iter().map(|t| t.id).collect();
    let house = c.background.iter().find(|t| matches!(t.form, Form::Building(_)));
    let by_m = 3.0;
    let raise = house.map(|t| Edit::RaiseThings {
        ids: vec![t.id],
        by_m,
    });
    let ids = vec![ids[ids.len() - 1]];
    apply(&mut c, Edit::RemoveThings { ids });
    raise.into_iter().for_each(|edit| apply(&mut c, edit));
    let pc = dir.save("c.loom", &c);
    let (report, _) = run(&["diff", &pa, &pc]);
    assert_eq!(report["things"]["removed"].as_array().map(Vec::len), Some(1));
    assert_eq!(report["changed_outside_region"], 0);
    assert!(report["voxels_changed"].as_u64() > Some(0));
}

/// Two settings on one world against a tiny reference: points, front, presets and the promise about untouched voxels.
#[test]
fn trade_measures_settings_and_refuses_bad_arguments() {
    let folder = Folder::new();
    let [out, plot, presets] = ["t.json", "t.png", "presets.json"].map(|n| folder.path(n));
    let common = ["trade", "--frames", "1", "--repeats", "1", "-o", &out];
    let only = [
        "--parts",
        "edit,vae",
        "--only",
        "2 steps, no fine stage;4 steps, fine stage 8 steps",
        "--reference-steps",
        "4",
    ];
    let files = ["--processes", "2", "--plot", &plot, "--presets", &presets];
    let (report, code) = run(&[&common[..], &only, &files].concat());
    assert_eq!(code, 0);
    let points = report["points"].as_array().expect("points");
    let edits: Vec<_> = points.iter().filter(|p| p["part"] == "edit").collect();
    assert_eq!(edits.len(), 2);
    for p in &edits {
        let zero = Some(0);
        assert_eq!(
            (p["untouched_voxels_changed"].as_u64(), p["failed"].as_u64()),
            (zero, zero)
        );
        assert!(
            p["wall_s"]["median"].as_f64() > Some(0.0) && p["runs"].as_u64() == Some(6),
            "{p}"
        );
    }
    let error = |name: &str| {
        let point = edits.iter().find(|p| p["name"] == name).expect("measured");
        point["error"]["median"].as_f64().expect("a number")
    };
    // The reference has four steps, and more of the fine stage: as many lie nearer to it than two without it.
    assert!(error("4 steps, fine stage 8 steps") < error("2 steps, no fine stage"));
    assert_eq!(report["figures"]["untouched_identical_edit"], true);
    assert_eq!(points.iter().filter(|p| p["part"] == "vae").count(), 2);
    assert!(std::fs::read(&plot).expect("a picture").starts_with(b"\x89PNG"));
    let found: Value = serde_json::from_slice(&std::fs::read(&presets).expect("presets")).expect("json");
    assert_eq!(found["stops"][0]["name"], "draft");
    for (bad, says) in [
        (["--frames", "0"], "expected 1 to 1000"),
        (["--reference-steps", "1001"], "expected 2 to 1000"),
        (["--parts", "edit,paint"], "expected edit"),
    ] {
        refused(&[&["trade", "-o", &out], &bad[..]].concat(), says);
    }
}

/// A building raised, a row of trees deleted and a hedge drawn, by words and by a file of edits: what changes lies where
/// those things stand, and both ways lead to one scene.
#[test]
fn things_beside_the_road_are_edited_by_words_and_by_edits() {
    let dir = Folder::new();
    let [before, worded, edited] = ["a.loom", "words.loom", "edits.loom"].map(|name| dir.path(name));
    let new = [
        "new",
        "--template",
        "straight",
        "--setting",
        "city",
        "--seed",
        "5",
        "-o",
        &before,
    ];
    assert_eq!(run(&new).1, 0);
    let words = "raise the nearest building on the right by two storeys; delete the tree row; \
                 add a hedge along the left side";
    let (report, code) = run(&["prompt", words, "--base", &before, "-o", &worded]);
    assert_eq!(code, 0, "{report:#}");
    let edits = report["edits"].as_array().expect("a list");
    let names = ["raise_things", "remove_things", "add_things"];
    assert!(
        edits.len() == 3 && names.iter().zip(edits).all(|(n, e)| e.get(n).is_some()),
        "{report:#}"
    );
    let (changes, code) = run(&["diff", &before, &worded]);
    assert_eq!((code, changes["changed_outside_region"].as_u64()), (0, Some(0)));
    assert!(changes["voxels_changed"].as_u64() > Some(500), "{changes:#}");
    let counts = ["added", "changed"].map(|what| changes["things"][what].as_array().map(Vec::len));
    assert_eq!(counts, [Some(1), Some(1)]);
    assert!(changes["things"]["removed"].as_array().map(Vec::len) > Some(2));
    let file = dir.path("edits.json");
    std::fs::write(&file, report["edits"].to_string()).expect("written");
    let (report, code) = run(&["edit", &before, "--edits", &file, "--verify", "-o", &edited]);
    assert_eq!(
        (code, report["untouched_voxels_changed"].as_u64()),
        (0, Some(0)),
        "{report:#}"
    );
    let (changes, _) = run(&["diff", &worded, &edited]);
    assert_eq!(changes["voxels_changed"], 0, "{changes:#}");
}

/// Versions are listed, added and taken out; a bad name is one line.
#[test]
fn versions_of_a_file_by_the_command_line() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name).display().to_string();
    let (scene, kept, taken) = (path("a.loom"), path("b.loom"), path("c.loom"));
    run(&["new", "--template", "straight", "--seed", "2", "-o", &scene]);
    let listed = run(&["versions", &scene]).0;
    assert_eq!(listed["versions"], serde_json::json!([]));
    run(&["versions", &scene, "--keep", "plain", "-o", &kept]);
    let edits = path("edits.json");
    std::fs::write(&edits, r#"[{"set_prompt": {"prompt": "snow"}}]"#).expect("written");
    run(&["edit", &kept, "--edits", &edits, "-o", &kept]);
    let listed = run(&["versions", &kept]).0;
    assert_eq!(listed["versions"][0]["name"], "plain");
    assert_eq!(listed["versions"][0]["starred"], true);
    for which in ["plain", "1"] {
        run(&["versions", &kept, "--take", which, "-o", &taken]);
        assert_eq!(
            std::fs::read(&taken).expect("written"),
            std::fs::read(&scene).expect("written"),
            "the version is the scene that it was"
        );
    }
    refused(
        &["versions", &kept, "--take", "other", "-o", &taken],
        "expected a name or 1 to 1",
    );
}

#[test]
fn an_object_of_another_scene_is_placed_with_its_voxels() {
    let folder = Folder::new();
    let scene = world();
    let id = *scene.frame().boxes.keys().next().expect("traffic");
    let [from, to, out] = ["s.loom", "t.loom", "u.loom"].map(|name| folder.path(name));
    folder.save("s.loom", &scene);
    folder.save("t.loom", &world());
    refused(&["place", &from, &to, "-o", &out], "holds");
    refused(
        &["place", &from, &to, "--of", "99999", "-o", &out],
        "box 99999 does not exist",
    );
    assert!(!Path::new(&out).exists());
    let (report, code) = run(&[
        "place",
        &from,
        &to,
        "--of",
        &id.0.to_string(),
        "--at",
        "-20,6",
        "-o",
        &out,
    ]);
    assert_eq!(code, 0, "{report}");
    let placed = open::scene(Path::new(&out)).expect("a scene");
    let new = BoxId(report["box"].as_u64().expect("a number") as u32);
    assert_eq!(placed.frame().boxes.len(), world().frame().boxes.len() + 1);
    let model = |scene: &Scene, id| scene::Model::of(scene, Some(id)).expect("an object").cells;
    assert_eq!(model(&placed, new), model(&scene, id));
    assert!(placed.frame().own_shapes.contains_key(&new));
    // And given to a box that is there.
    let (report, _) = run(&[
        "place",
        &out,
        &to,
        "--of",
        &new.0.to_string(),
        "--to",
        &id.0.to_string(),
        "-o",
        &out,
    ]);
    assert_eq!(report["box"].as_u64(), Some(u64::from(id.0)));
}
