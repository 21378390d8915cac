//! Names that are texts: of scenes, rigs and versions. They reach terminals, tables and XML, and no path.

use app::export::{ExportOptions, ExportProgress, export_all};
use formats::{export, loom};
use scene::message::is_hidden;
use serde_json::json;

use super::process::run;
use super::{Place, changed, hostile, one_line, small};

#[test]
fn names_of_scenes_are_lines_and_lead_no_export_out() {
    let mut place = Place::new();
    let (_, loom) = small();
    place.begin();
    let formats: Vec<_> = ["boxes", "opendrive", "openscenario", "world-scenario"]
        .iter()
        .map(|id| export::from_id(id).expect("a format"))
        .collect();
    let options = ExportOptions::default();
    for (i, name) in hostile(&place).into_iter().enumerate() {
        let bytes = changed(&loom, "scene.json", |value| value["name"] = json!(name));
        let scene = loom::from_bytes(&bytes).unwrap_or_else(|e| panic!("{name:?}: {e}"));
        assert!(
            !scene.name.contains(is_hidden) && scene.name.chars().count() <= 201,
            "{:?}",
            scene.name
        );
        if i % 6 == 0 {
            let folder = place.out().join(i.to_string());
            let files = export_all(&scene, &formats, &options, &folder, &ExportProgress::default());
            for (path, _) in files.unwrap_or_else(|e| panic!("{name:?}: {e}")) {
                assert!(path.starts_with(&folder), "{}", path.display());
                let text = std::fs::read(&path).expect("a file");
                let is_text = path.extension().is_some_and(|e| e == "xodr" || e == "xosc");
                assert!(!is_text || !text.contains(&0x1b), "{}", path.display());
            }
        }
    }
    place.written();
}

#[test]
fn names_of_rigs_with_control_characters_are_refused() {
    let (_, loom) = small();
    for name in ["\u{1b}[2J", "a\nb", "a\u{9b}b", &"x".repeat(300)] {
        let bytes = changed(&loom, "scene.json", |value| value["rig"]["name"] = json!(name));
        let line = loom::from_bytes(&bytes).expect_err(name).to_string();
        assert!(one_line(&line).contains("the rig is called"), "{line}");
    }
}

#[test]
fn names_of_versions_move_no_cursor() {
    let place = Place::new();
    let (mut scene, _) = small();
    let packed = loom::alone_to_bytes(&scene).expect("sound");
    let version = scene::KeptVersion {
        name: "NAME".into(),
        label: "LABEL".into(),
        note: "0.4 s\n{}".into(),
        starred: true,
        loom: packed.into(),
    };
    scene.kept = std::sync::Arc::new(scene::ProjectHistory {
        versions: vec![version],
        typed: Vec::new(),
        ..Default::default()
    });
    let bytes = changed(&loom::to_bytes(&scene).expect("sound"), "kept.json", |value| {
        let version = &mut value["versions"][0];
        version["name"] = json!("\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m\u{202e}../../x");
        version["note"] = json!("\u{1b}[1A 0.4 s\n{\"a\": 1}");
    });
    let file = place.at("scene.loom");
    std::fs::write(&file, bytes).expect("written");
    let file = file.display().to_string();
    for more in [&[][..], &["--json"]] {
        let args = [&["versions", &file][..], more].concat();
        let (code, said, error) = run(&args);
        assert_eq!(code, 0, "{error}");
        assert!(
            said.contains("owned") && !said.contains(|c| c != '\n' && is_hidden(c)),
            "{said:?}"
        );
    }
}
