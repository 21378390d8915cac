//! The house as docs/architecture.md describes it: who knows whom, how long files are, which licences are used, and that a
//! reader finds things where the document says.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

const DOCUMENT: &str = include_str!("../../docs/architecture.md");

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn files(folder: &str, named: &dyn Fn(&str) -> bool) -> Vec<PathBuf> {
    let (mut found, mut open) = (Vec::new(), vec![root().join(folder)]);
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
            if path.is_dir() {
                open.push(path);
            } else if name.is_some_and(|n| named(&n)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

pub fn rust(folder: &str) -> Vec<PathBuf> {
    files(folder, &|name| name.ends_with(".rs"))
}

/// Rooms by name: their folder, and the rooms that their program code depends on.
fn rooms() -> BTreeMap<String, (String, Vec<String>)> {
    let workspace = read(&root().join("Cargo.toml"));
    let path_of = |line: &str| -> Option<(String, String)> {
        let (name, rest) = line.split_once(" = { package = \"sceneloom-")?;
        let path = rest.split_once("path = \"")?.1.split_once('"')?.0;
        Some((name.to_owned(), path.to_owned()))
    };
    let folders: BTreeMap<String, String> = workspace.lines().filter_map(path_of).collect();
    let mut rooms = BTreeMap::new();
    for (name, folder) in &folders {
        let manifest = read(&root().join(folder).join("Cargo.toml"));
        let dependencies = manifest.split("[dependencies]").nth(1).unwrap_or("");
        let dependencies = dependencies.split("\n[").next().unwrap_or("");
        let named = |line: &str| line.split(['.', ' ', '=']).next().unwrap_or("").to_owned();
        let known = dependencies
            .lines()
            .map(named)
            .filter(|n| folders.contains_key(n));
        rooms.insert(name.clone(), (folder.clone(), known.collect()));
    }
    assert!(rooms.len() > 15, "rooms of the workspace: {rooms:?}");
    rooms
}

/// The last column of a room's row in docs/architecture.md, as a set of names.
fn knows(room: &str) -> BTreeSet<String> {
    let opening = format!("| {room} | `");
    let row = DOCUMENT.lines().find(|l| l.starts_with(&opening));
    let row = row.unwrap_or_else(|| panic!("docs/architecture.md has no row {room}"));
    let last = row.trim_end_matches([' ', '|']).rsplit('|').next().unwrap_or("");
    let names = last.split(',').map(|n| n.trim().to_owned());
    names.filter(|n| n != "–").collect()
}

#[test]
fn rooms_know_only_whom_they_may() {
    for (name, (folder, known)) in rooms() {
        assert!(
            DOCUMENT.contains(&format!("| {name} | `{folder}/`")),
            "docs/architecture.md does not name {name} in {folder}"
        );
        let listed = knows(&name);
        let of_its_own = |n: &&String| !matches!(n.as_str(), "scene" | "numeric");
        let depends: BTreeSet<String> = known.iter().filter(of_its_own).cloned().collect();
        assert_eq!(listed, depends, "docs/architecture.md, column *knows* of {name}");
        // The rooms that open and change scenes may know those that do.
        let opens_scenes = matches!(&*name, "authoring" | "calibration" | "judge" | "serve");
        for other in known {
            let may = match (&*name, &*other) {
                ("cli", _) => true,
                (_, "cli" | "serve") => false,
                ("assist", _) => true,
                (_, "assist") => false,
                ("app", _) => true,
                (_, "app") => false,
                ("assets" | "numeric" | "language", _) => false,
                ("runtime", other) => other == "scene",
                (_, "language") => matches!(name.as_str(), "editor" | "widgets"),
                ("scene", other) => matches!(other, "assets" | "numeric"),
                ("editor" | "formats" | "viewport", other) => matches!(other, "scene" | "assets" | "numeric"),
                (_, "editor" | "formats") => opens_scenes,
                ("widgets", "viewport") => true,
                (_, "viewport") => false,
                _ => true,
            };
            assert!(may, "{name} must not know {other}");
        }
    }
}

/// Rooms of `sensors` that a line of code names by `crate::`.
fn named_rooms(line: &str) -> Vec<String> {
    let after = |(at, found): (usize, &str)| {
        let rest = &line[at + found.len()..];
        match rest.strip_prefix('{') {
            None => vec![rest],
            Some(list) => list.split(',').map(str::trim).collect(),
        }
    };
    let word = |text: &str| {
        text.split(|c: char| !c.is_alphanumeric() && c != '_')
            .next()
            .map(str::to_owned)
    };
    line.match_indices("crate::")
        .flat_map(after)
        .filter_map(word)
        .collect()
}

#[test]
fn rooms_of_the_sensors_use_only_those_above_them() {
    let row = |line: &str| {
        let (name, rest) = line.strip_prefix("| `sensors/")?.split_once("/` |")?;
        let uses = rest.trim_end_matches([' ', '|']).rsplit('|').next()?;
        let uses = uses.split(',').map(|n| n.trim().to_owned()).filter(|n| n != "–");
        Some((name.to_owned(), uses.collect::<BTreeSet<String>>()))
    };
    let table: Vec<(String, BTreeSet<String>)> = DOCUMENT.lines().filter_map(row).collect();
    assert!(table.len() >= 8, "{table:?}");
    let mut above = BTreeSet::new();
    for (room, uses) in &table {
        assert!(uses.is_subset(&above), "{room} uses a room below it in the table");
        let mut found = BTreeSet::new();
        for path in rust(&format!("src/gen/sensors/{room}")) {
            let name = path.display().to_string();
            let text = read(&path);
            let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or("");
            if !name.contains("test") {
                found.extend(code.lines().flat_map(named_rooms));
            }
        }
        found.retain(|other| other != room);
        assert_eq!(*uses, found, "docs/architecture.md, sensors/{room}");
        above.insert(room.clone());
    }
    let folders = std::fs::read_dir(root().join("src/gen/sensors")).expect("a folder");
    let folders = folders.flatten().filter(|entry| entry.path().is_dir()).count();
    assert_eq!(folders, table.len(), "every folder has its row");
    assert_eq!(named_rooms("use crate::{lidar::a, splat};"), ["lidar", "splat"]);
}

/// Files of the rooms that work on maps of any extent which may name the networks' window: they talk to the networks, or
/// show what those did.
const MAY_NAME_THE_WINDOW: [&str; 7] = [
    "src/app/canvas.rs",
    "src/app/cli/region_arg.rs",
    "src/app/marks.rs",
    "src/app/panes/modelled.rs",
    "src/gen/sensors/lidar/learned.rs",
    "src/gen/sensors/perceive/sweep.rs",
    "src/gen/sensors/perceive/voxels.rs",
];

#[test]
fn rooms_that_work_on_maps_name_no_window() {
    let of_window = |line: &str| {
        line.contains("Extent::WINDOW")
            || ["N", "COLUMNS", "V", "M", "center", "column_at", "to_", "from_"]
                .iter()
                .any(|name| line.contains(&format!("Window::{name}")))
    };
    let rooms = [
        "app",
        "editor",
        "viewport",
        "gen/place",
        "gen/sensors",
        "gen/words",
    ];
    let (mut named, mut wrong) = (BTreeSet::new(), Vec::new());
    for path in rooms.iter().flat_map(|room| rust(&format!("src/{room}"))) {
        let name = path
            .strip_prefix(root())
            .expect("below the root")
            .display()
            .to_string();
        let text = read(&path);
        let code = text.split("#[cfg(test)]").next().unwrap_or("");
        let is_test = name.contains("test");
        if is_test || !code.lines().any(of_window) {
            continue;
        }
        match MAY_NAME_THE_WINDOW.contains(&name.as_str()) {
            true => drop(named.insert(name)),
            false => wrong.push(name),
        }
    }
    assert!(
        wrong.is_empty(),
        "use the extent of the frame, layout or grid: {wrong:?}"
    );
    assert_eq!(
        named.len(),
        MAY_NAME_THE_WINDOW.len(),
        "shorten the list: {named:?}"
    );
}

#[test]
fn files_are_short_and_the_shell_is_small() {
    const LONGEST: usize = 600;
    let lines = |path: &PathBuf| read(path).lines().count();
    for folder in ["src", "tests", "benches", "fuzz", "training", "assets"] {
        for path in rust(folder) {
            let found = lines(&path);
            assert!(
                found <= LONGEST,
                "{}: {found} lines, at most {LONGEST}",
                path.display()
            );
        }
    }
    let mut all: Vec<usize> = rust("src").iter().map(lines).collect();
    all.sort_unstable();
    let median = all[all.len() / 2];
    println!(
        "{} files, median {median} lines, {} in all",
        all.len(),
        all.iter().sum::<usize>()
    );
    assert!(median <= 200, "{median}");
    let shell: usize = rust("src/app").iter().map(lines).sum();
    println!("src/app: {shell} lines");
}

#[test]
fn documents_are_short_and_their_links_lead_somewhere() {
    let readme = read(&root().join("README.md"));
    assert!(readme.len() <= 9000, "README.md has {} bytes", readme.len());
    let mut documents = files("docs", &|name| name.ends_with(".md"));
    documents.extend(files("tests", &|name| name.ends_with(".md")));
    documents.extend([root().join("README.md"), root().join("training/README.md")]);
    for document in documents {
        let text = read(&document);
        for link in text.split("](").skip(1).filter_map(|t| t.split_once(')')) {
            let target = link.0.split('#').next().unwrap_or("");
            if target.is_empty() || target.contains("://") || target.contains(char::is_whitespace) {
                continue;
            }
            let path = document.parent().expect("a folder").join(target);
            assert!(path.exists(), "{}: {target} is not there", document.display());
        }
    }
}

/// Licences of all libraries that are built on this system, against the list in deny.toml. An expression is met if one of
/// its alternatives consists of listed licences.
#[test]
fn licences_are_permissive() {
    let metadata = metadata();
    let allowed = read(&root().join("deny.toml"));
    let is_allowed = |one: &str| allowed.contains(&format!("\"{one}\""));
    let packages = metadata["packages"].as_array().expect("packages");
    assert!(packages.len() > 300, "{}", packages.len());
    for package in packages {
        let name = &package["name"];
        let text = package["license"].as_str().unwrap_or("none").replace('/', " OR ");
        let met = text.split(" AND ").all(|part| {
            let part = part.trim().trim_start_matches('(').trim_end_matches(')');
            part.split(" OR ").any(|one| is_allowed(one.trim()))
        });
        assert!(met, "{name} is under {text}");
    }
}

/// Every library that this system links into the program stands in the notices with its version, and so does the data of others.
#[test]
fn notices_name_all_that_is_inside() {
    let metadata = metadata();
    let notices = assets::licences::NOTICES;
    let list = |value: &serde_json::Value| value.as_array().cloned().unwrap_or_default();
    let mut ahead: Vec<String> = Vec::new();
    let mut named = BTreeMap::new();
    for package in list(&metadata["packages"]) {
        let id = package["id"].as_str().expect("an id").to_owned();
        if package["name"] == "sceneloom" {
            ahead.push(id.clone());
        }
        let name = format!(
            "{} {}",
            package["name"].as_str().unwrap_or(""),
            package["version"].as_str().unwrap_or("")
        );
        named.insert(id, (name, package["source"].is_string()));
    }
    let nodes = list(&metadata["resolve"]["nodes"]);
    let mut seen = BTreeSet::new();
    while let Some(id) = ahead.pop() {
        if !seen.insert(id.clone()) {
            continue;
        }
        let node = nodes.iter().find(|n| n["id"] == id.as_str()).expect("a node");
        for dependency in list(&node["deps"]) {
            if list(&dependency["dep_kinds"]).iter().any(|k| k["kind"].is_null()) {
                ahead.push(dependency["pkg"].as_str().expect("an id").to_owned());
            }
        }
    }
    let linked: Vec<&String> = seen
        .iter()
        .filter_map(|id| named[id].1.then_some(&named[id].0))
        .collect();
    assert!(linked.len() > 300, "{}", linked.len());
    for name in linked {
        assert!(
            notices.contains(&format!("  {name}: ")),
            "{name} is missing: run assets/licences/make.py"
        );
    }
    for data in [
        "SCOWL",
        "WordNet",
        "Noto Sans CJK",
        "esmini",
        "H.264",
        "Cisco Systems",
    ] {
        assert!(notices.contains(data), "{data}");
    }
}

/// What `cargo metadata` says of this workspace on this system.
fn metadata() -> serde_json::Value {
    let output = std::process::Command::new(env!("CARGO"))
        .current_dir(root())
        .args(["metadata", "--format-version", "1", "--offline", "--locked"])
        .args(["--filter-platform", "x86_64-unknown-linux-gnu"])
        .output()
        .expect("cargo");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Ten lines that a reader of docs/architecture.md is asked to find, and the folder that the answer is. Somebody who had
/// read nothing else named the folder of each (see docs/architecture.md, at the end).
const TEN: [(&str, &str); 10] = [
    ("pub enum Edit {", "src/scene/"),
    ("pub fn commit_drag(", "src/editor/"),
    ("pub struct DdimStep", "src/gen/diffusion/"),
    ("pub type GenWorker", "src/gen/job/"),
    ("pub struct Int8Matrix", "src/gen/nn/"),
    ("pub struct OccVae<", "src/gen/nets/"),
    ("pub trait CameraSource", "src/gen/sensors/"),
    ("pub struct Reading {", "src/gen/words/"),
    ("pub fn frechet", "src/gen/metrics/"),
    ("pub trait Pane", "src/app/panes/"),
];

#[test]
fn ten_lines_are_where_the_document_says() {
    for (line, folder) in TEN {
        let room = folder.trim_end_matches('/');
        assert!(
            DOCUMENT.contains(room),
            "docs/architecture.md does not name {folder}"
        );
        let holds = |path: &&PathBuf| read(path).contains(line);
        let everywhere: Vec<PathBuf> = rust("src").iter().filter(holds).cloned().collect();
        assert!(!everywhere.is_empty(), "{line} is nowhere");
        for path in everywhere {
            assert!(
                path.starts_with(root().join(room)),
                "{line} is in {}, expected {folder}",
                path.display()
            );
        }
    }
}
