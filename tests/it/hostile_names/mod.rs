//! Names that a stranger chose, through every way in: nothing is written outside the folder that was named, and what is refused
//! is refused in one line.

mod kept;
mod process;
mod program;
mod targets;

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};

use app::export::{ExportOptions, ExportProgress, export_all};
use assist::render::Rendering;
use editor::{Document, Edit};
use formats::{export, import, loom};
use scene::{Scene, SensorRig};
use serde_json::{Value, json};
use zip::write::SimpleFileOptions;

/// A folder with a place to write into, deep enough that every name which leads upwards ends within it.
pub struct Place {
    dir: tempfile::TempDir,
    before: BTreeMap<PathBuf, Vec<u8>>,
}

impl Place {
    pub fn new() -> Self {
        let dir = tempfile::tempdir().expect("a folder");
        let place = Self {
            dir,
            before: BTreeMap::new(),
        };
        std::fs::create_dir_all(place.out()).expect("made");
        std::fs::create_dir(place.at("elsewhere")).expect("made");
        std::fs::write(place.at("elsewhere/x_semantic.png"), "not ours").expect("written");
        place
    }

    /// A path that is not in the folder.
    pub fn at(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// The folder that is written into.
    pub fn out(&self) -> PathBuf {
        self.at("1/2/3/4/5/out")
    }

    /// Remembers what is there.
    pub fn begin(&mut self) {
        self.before = files_below(self.dir.path());
    }

    /// What was written since; panics if any of it is outside the folder.
    pub fn written(&self) -> Vec<PathBuf> {
        let (now, out) = (files_below(self.dir.path()), self.out());
        let gone: Vec<_> = self
            .before
            .keys()
            .filter(|path| !now.contains_key(*path))
            .collect();
        assert!(gone.is_empty(), "no longer there: {gone:?}");
        let new = now
            .into_iter()
            .filter(|(path, bytes)| self.before.get(path) != Some(bytes));
        let new: Vec<PathBuf> = new.map(|(path, _)| path).collect();
        let outside: Vec<_> = new.iter().filter(|path| !path.starts_with(&out)).collect();
        assert!(outside.is_empty(), "written outside: {outside:?}");
        new
    }
}

/// Every file below a folder with what it holds; links are not followed.
fn files_below(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut found, mut open) = (BTreeMap::new(), vec![folder.to_path_buf()]);
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(at).expect("a folder") {
            let entry = entry.expect("an entry");
            let kind = entry.file_type().expect("a kind");
            match kind.is_dir() {
                true => open.push(entry.path()),
                false if kind.is_file() => {
                    let bytes = std::fs::read(entry.path()).expect("a file");
                    found.insert(entry.path(), bytes);
                }
                false => {
                    found.insert(entry.path(), Vec::new());
                }
            }
        }
    }
    found
}

/// Names that no sensor may have. All that lead somewhere lead into the place.
pub fn hostile(place: &Place) -> Vec<String> {
    let elsewhere = place.at("elsewhere/x").display().to_string();
    let mut names = vec![
        elsewhere.clone(),
        format!("/{elsewhere}"),
        format!("x/../../../{elsewhere}"),
    ];
    for up in 1..=5 {
        names.push(format!("{}x", "../".repeat(up)));
        names.push(format!("a/{}elsewhere/x", "../".repeat(up)));
        names.push(format!("{}x", "..\\".repeat(up)));
    }
    let plain = [
        "",
        ".",
        "..",
        "...",
        "/",
        "//",
        "\\",
        "./x",
        "x/",
        "x/.",
        "a/b",
        "a\\b",
        "a/../b",
        "C:\\x",
        "C:x",
        "\\\\server\\share\\x",
        "file:///x",
        "x:stream",
        "~/x/y",
        ".x",
        ".bashrc",
        "x.",
        "x..",
        "x ",
        " x",
        "\t",
        "\u{a0}",
        "a\nb",
        "a\r\nb",
        "a\0b",
        "\0",
        "\u{1b}]0;x\u{7}",
        "\u{1b}[2J",
        "a\u{9b}31m",
        "a\u{7f}b",
        "a\u{202e}gnp",
        "a\u{2028}b",
        "\u{feff}x",
        "*",
        "a?b",
        "a|b",
        "a\"b",
        "<script>",
        "a>b",
        "NUL",
        "con",
        "aux.png",
        "COM1",
        "lpt9.txt",
        "PRN .x",
        "com²",
        "CONIN$",
    ];
    names.extend(plain.map(str::to_owned));
    names.extend([
        "x".repeat(129),
        "é".repeat(200),
        "../".repeat(4) + &"x".repeat(1 << 16),
    ]);
    names
}

/// The project file of a small scene with a small rig.
pub fn small() -> (Scene, Vec<u8>) {
    let mut scene = app::open::from_template("straight", 3).expect("a template");
    let mut rig = SensorRig::clone(&scene.rig);
    rig.cameras.truncate(1);
    for camera in &mut rig.cameras {
        *camera = camera.resized(32, 18);
    }
    rig.lidars[0].elevations_deg.truncate(2);
    scene.rig = rig.into();
    let bytes = loom::to_bytes(&scene).expect("sound");
    (scene, bytes)
}

/// A project file whose entry is changed by hand, as a stranger's program may.
pub fn changed(loom: &[u8], entry: &str, change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut from = zip::ZipArchive::new(Cursor::new(loom)).expect("a zip");
    let mut to = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for i in 0..from.len() {
        let mut file = from.by_index(i).expect("an entry");
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).expect("bytes");
        let name = file.name().expect("text").into_owned();
        if name == entry {
            let mut value = serde_json::from_slice(&bytes).expect("JSON");
            change(&mut value);
            bytes = value.to_string().into_bytes();
        }
        to.start_file(name, SimpleFileOptions::default())
            .expect("an entry");
        to.write_all(&bytes).expect("written");
    }
    to.finish().expect("a zip").into_inner()
}

fn one_line(line: &str) -> &str {
    let shown: String = line.chars().take(400).collect();
    assert!(
        line.lines().count() == 1 && !line.contains(char::is_control),
        "{shown:?}"
    );
    assert!(line.chars().count() < 600, "{shown}");
    line
}

#[test]
fn scenes_rigs_and_edits_with_such_names_are_refused() {
    let mut place = Place::new();
    let (scene, loom) = small();
    let rig_json = serde_json::to_value(&*scene.rig).expect("JSON");
    let rig_file = place.at("rig.json");
    std::fs::write(&rig_file, "").expect("written");
    place.begin();
    let mut refused = 0;
    for name in hostile(&place) {
        for (kind, word) in [("cameras", "camera 0"), ("lidars", "lidar 0")] {
            let mut rig = rig_json.clone();
            rig[kind][0]["name"] = json!(name);
            let bytes = changed(&loom, "scene.json", |value| value["rig"] = rig.clone());
            let line = loom::from_bytes(&bytes).expect_err(&name).to_string();
            assert!(one_line(&line).contains(word), "{line}");
            let edit: Edit = serde_json::from_value(json!({ "set_rig": { "rig": rig } })).expect("an edit");
            let line = Document::new(scene.clone())
                .apply("Rig", &edit)
                .expect_err(&name)
                .to_string();
            assert!(one_line(&line).contains(word), "{line}");
            std::fs::write(&rig_file, rig.to_string()).expect("written");
            let line = app::open::rig(&rig_file).expect_err(&name).to_string();
            assert!(one_line(&line).contains(word), "{line}");
            refused += 3;
        }
    }
    assert!(refused >= 400, "{refused}");
    std::fs::write(&rig_file, "").expect("written");
    assert_eq!(place.written(), Vec::<PathBuf>::new());
}

/// Should a rig get past the checks, the writers themselves lead nowhere else.
#[test]
fn writers_lead_nowhere_else_whatever_a_rig_says() {
    let mut place = Place::new();
    let (scene, _) = small();
    place.begin();
    let formats: Vec<_> = ["pictures", "truth", "depth", "openlabel", "world-scenario"]
        .iter()
        .map(|id| export::from_id(id).expect("a format"))
        .collect();
    let options = ExportOptions {
        camera_size: [16, 9],
        ..ExportOptions::default()
    };
    let (mut written, mut refused) = (0, 0);
    for name in hostile(&place).into_iter().step_by(7) {
        let mut scene = scene.clone();
        let mut rig = SensorRig::clone(&scene.rig);
        rig.cameras[0].name = name.clone();
        scene.rig = rig.into();
        scene.touch();
        let rendering = Rendering {
            what: vec!["semantic".into(), "truth".into()],
            size: [16, 9],
            source: sensors::cameras::told::ID,
            weather: None,
            time: None,
            preview: true,
            lidar: app::camera_views::LidarModel::Exact,
            paint: None,
        };
        match rendering.write(&scene, &place.out(), &mut |_| Ok(())) {
            Ok(_) => written += 1,
            Err(error) => {
                one_line(&scene::message::of_error(error.as_ref()));
                refused += 1;
            }
        }
        for format in &formats {
            let folder = place.out().join(format.id);
            match export_all(&scene, &[format], &options, &folder, &ExportProgress::default()) {
                Ok(files) => {
                    assert!(
                        files.iter().all(|(path, _)| path.starts_with(&folder)),
                        "{files:?}"
                    );
                    written += 1;
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > 5 && written > 5, "{refused} refused, {written} written");
    place.written();
}

#[test]
fn cameras_of_one_name_are_refused_and_those_that_become_one_get_files_of_their_own() {
    let place = Place::new();
    let (scene, loom) = small();
    let camera = serde_json::to_value(&scene.rig.cameras[0]).expect("JSON");
    let named = |names: &[&str]| {
        let cameras: Vec<Value> = names
            .iter()
            .map(|name| {
                let mut camera = camera.clone();
                camera["name"] = json!(name);
                camera
            })
            .collect();
        changed(&loom, "scene.json", |value| {
            value["rig"]["cameras"] = json!(cameras)
        })
    };
    for names in [["a", "a"], ["CAM", "Cam"], ["Ä", "ä"]] {
        let line = loom::from_bytes(&named(&names)).expect_err("alike").to_string();
        assert!(one_line(&line).contains("cameras 0 and 1 are called"), "{line}");
    }
    // What is harmless opens as it did.
    let names = ["a b", "a_b", "前", "後", "front.left", "-x", "A-B"];
    let scene = loom::from_bytes(&named(&names)).expect("sound");
    assert!(scene.rig.cameras.iter().map(|c| &*c.name).eq(names));
    let options = ExportOptions {
        camera_size: [16, 9],
        ..ExportOptions::default()
    };
    for (id, each) in [("pictures", 1), ("semantic", 1), ("depth", 1), ("truth", 6)] {
        let format = export::from_id(id).expect("a format");
        let folder = place.out().join(id);
        export_all(&scene, &[format], &options, &folder, &ExportProgress::default()).expect(id);
        let pictures = files_below(&folder);
        let of_cameras = pictures
            .keys()
            .filter(|path| path.extension().is_some_and(|e| e != "json"));
        assert_eq!(
            of_cameras.count(),
            each * names.len(),
            "{id}: {:?}",
            pictures.keys()
        );
    }
    // A camera that is called as a file of another is told, and nothing is written over.
    let odd = loom::from_bytes(&named(&["a", "a_class"])).expect("sound");
    let format = export::from_id("truth").expect("a format");
    let folder = place.out().join("odd");
    let line = export_all(&odd, &[format], &options, &folder, &ExportProgress::default()).expect_err("alike");
    assert!(
        one_line(&line.to_string()).contains("two different files would be called a_class.png"),
        "{line}"
    );
    assert!(!folder.exists(), "nothing is written before that is known");
}

#[test]
fn tables_of_recordings_with_such_names_are_refused() {
    let mut place = Place::new();
    let (scene, _) = small();
    let tables = place.at("tables");
    let format = export::from_id("nuscenes").expect("a format");
    let options = ExportOptions {
        camera_size: [16, 9],
        ..ExportOptions::default()
    };
    export_all(&scene, &[format], &options, &tables, &ExportProgress::default()).expect("written");
    let sensors = files_below(&tables)
        .into_keys()
        .find(|path| path.ends_with("sensor.json"))
        .expect("a table");
    let good = std::fs::read_to_string(&sensors).expect("a table");
    import::read(&tables).expect("read");
    place.begin();
    let names: Vec<String> = hostile(&place).into_iter().step_by(3).collect();
    for (name, channel) in names
        .iter()
        .flat_map(|name| [(name, "CAM_FRONT_LEFT"), (name, "LIDAR_TOP")])
    {
        assert!(good.contains(&json!(channel).to_string()), "{good}");
        let bad = good.replace(&json!(channel).to_string(), &json!(name).to_string());
        std::fs::write(&sensors, bad).expect("written");
        let line = import::read(&tables).map(|_| ()).expect_err(name).to_string();
        one_line(&line);
    }
    std::fs::write(&sensors, good).expect("written");
    assert_eq!(place.written(), Vec::<PathBuf>::new());
}
