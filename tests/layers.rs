//! The rooms of the house know each other only along the arrows of README.md: reads the `use` lines
//! and paths of every source file and fails, with file and line, on one that runs another way.

use std::path::{Path, PathBuf};

const ROOMS: [&str; 6] = ["app", "editor", "formats", "generation", "scene", "viewport"];

fn may_know(room: &str) -> &'static [&'static str] {
    match room {
        "app" => &["app", "editor", "formats", "generation", "scene", "viewport"],
        "editor" => &["editor", "scene"],
        "formats" => &["formats", "scene"],
        "generation" => &["generation", "scene"],
        "viewport" => &["viewport", "scene"],
        _ => &["scene"],
    }
}

/// Libraries that only some rooms may name.
fn may_use_library(room: &str, library: &str) -> bool {
    match library {
        "egui" | "eframe" | "rfd" | "egui_wgpu" => room == "app",
        "wgpu" => matches!(room, "viewport" | "app"),
        "candle_core" | "candle_nn" => room == "generation",
        _ => true,
    }
}

fn sources(dir: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(dir).expect("a source folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

fn violations(room: &str, name: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap_or("");
        let at = |what: &str| {
            format!(
                "{name}:{}: {room} must not know {what}: {}",
                number + 1,
                line.trim()
            )
        };
        for other in ROOMS {
            let path = format!("crate::{other}");
            let named = code
                .match_indices(&path)
                .any(|(i, _)| !code[i + path.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_'));
            if named && !may_know(room).contains(&other) {
                found.push(at(other));
            }
        }
        for library in [
            "egui",
            "eframe",
            "rfd",
            "egui_wgpu",
            "wgpu",
            "candle_core",
            "candle_nn",
        ] {
            let path = format!("{library}::");
            let named = code
                .match_indices(&path)
                .any(|(i, _)| !code[..i].ends_with(|c: char| c.is_alphanumeric() || c == '_'));
            if named && !may_use_library(room, library) {
                found.push(at(library));
            }
        }
    }
    found
}

#[test]
fn arrows_run_one_way() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    assert!(files.len() > 20, "only {} source files found", files.len());
    let mut found = Vec::new();
    for file in files {
        let inner = file.strip_prefix(&src).expect("inside src");
        let Some(folder) = inner
            .components()
            .next()
            .filter(|_| inner.components().count() > 1)
        else {
            continue; // lib.rs and main.rs are the front door
        };
        let folder = folder.as_os_str().to_string_lossy();
        let room = if folder == "gen" { "generation" } else { &*folder };
        let text = std::fs::read_to_string(&file).expect("a source file");
        found.extend(violations(room, &inner.display().to_string(), &text));
    }
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn a_wrong_arrow_is_seen() {
    assert_eq!(
        violations("scene", "a.rs", "use crate::editor::Document;").len(),
        1
    );
    assert_eq!(violations("editor", "a.rs", "let x = wgpu::Device;").len(), 1);
    assert_eq!(
        violations("editor", "a.rs", "use crate::scene::Scene; // crate::app").len(),
        0
    );
}
