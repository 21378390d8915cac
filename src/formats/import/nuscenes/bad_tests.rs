//! Folders that are damaged: one line, or a scene with less in it; never a panic.

use std::panic::catch_unwind;

use scene::draw::SplitMix64;
use scene::message::LONGEST;

use super::tests::{foreign, read, written};
use super::*;
use crate::clip_tests::clip_scene;

fn outcome(folder: &Path) -> Option<String> {
    let read = catch_unwind(|| read(folder).map(drop)).unwrap_or_else(|_| panic!("it panics"));
    let line = read.err()?.to_string();
    let sound = !line.is_empty() && line.chars().count() <= LONGEST && !line.contains(char::is_control);
    assert!(sound, "{line:?}");
    Some(line)
}

fn tables(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder.join("v1.0-mini")).expect("tables");
    let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    paths
}

#[test]
fn tables_that_are_cut_or_missing_are_one_line() {
    let folder = written(&crate::table_tests::scene());
    for path in tables(folder.path()) {
        let (whole, name) = (std::fs::read(&path).expect("there"), path.display());
        let unread = ["visibility", "log.json", "splits.json"];
        let needed = !unread.iter().any(|t| name.to_string().contains(t));
        for cut in [0, 1, whole.len() / 3, whole.len() - 3] {
            std::fs::write(&path, &whole[..cut]).expect("written");
            let line = outcome(folder.path());
            assert_eq!(line.is_some(), needed, "{name} cut at {cut}: {line:?}");
        }
        std::fs::remove_file(&path).expect("removed");
        let optional = ["attribute", "lidarseg", "map"]
            .iter()
            .any(|t| name.to_string().contains(t));
        let line = outcome(folder.path());
        assert_eq!(line.is_some(), needed && !optional, "{name} missing: {line:?}");
        std::fs::write(&path, &whole).expect("written");
    }
    assert_eq!(outcome(folder.path()), None);
}

#[test]
fn damaged_bytes_and_numbers_do_no_harm() {
    let mut dice = SplitMix64::new(11);
    for folder in [written(&clip_scene(2)), foreign()] {
        for path in tables(folder.path()) {
            let whole = std::fs::read(&path).expect("there");
            for _ in 0..12 {
                let mut damaged = whole.clone();
                for _ in 0..=dice.below(3) {
                    let at = dice.below(damaged.len());
                    damaged[at] = dice.below(256) as u8;
                }
                std::fs::write(&path, &damaged).expect("written");
                outcome(folder.path());
            }
            let text = String::from_utf8(whole.clone()).expect("text");
            for (from, to) in [
                ("0.", "1e308"),
                ("1", "-1"),
                ("5", "9e99"),
                ("\"", "\"../"),
                (".", ".0e-"),
            ] {
                std::fs::write(&path, text.replace(from, to)).expect("written");
                outcome(folder.path());
            }
            std::fs::write(&path, whole).expect("written");
        }
        assert_eq!(outcome(folder.path()), None);
    }
}

#[test]
fn what_a_table_claims_is_checked() {
    let folder = foreign();
    let change = |table: &str, from: &str, to: &str| {
        let path = folder.path().join(format!("v1.0-mini/{table}.json"));
        let whole = std::fs::read_to_string(&path).expect("there");
        assert!(whole.contains(from), "{table}: {from}");
        std::fs::write(&path, whole.replace(from, to)).expect("written");
        let line = outcome(folder.path());
        std::fs::write(&path, whole).expect("written");
        line.unwrap_or_else(|| panic!("{table}: {from} to {to} is read"))
    };
    let line = change("ego_pose", "1010.0", "1e300");
    assert!(line.contains("expected within 10000000 m"), "{line}");
    let line = change("ego_pose", "614.8", "9999.0");
    assert!(line.contains("a map of"), "{line}");
    let line = change("ego_pose", "\"a2\"", "\"zz\"");
    assert!(line.contains("ego pose a2: not in ego_pose.json"), "{line}");
    let line = change("sample", "1532402928147847", "9223372036854775807");
    assert!(line.contains("expected at most 600"), "{line}");
    let line = change("sample", "\"s1\"", "\"s3\"");
    assert!(line.contains("0 samples"), "{line}");
    let line = change(
        "sample_data",
        "\"sample_token\": \"b\"",
        "\"sample_token\": \"c\"",
    );
    assert!(line.contains("no sensor's data"), "{line}");
    let line = change("scene", "[", "[[");
    assert!(line.contains("expected"), "{line}");
    let long = "x".repeat(1 << 20);
    let line = change(
        "sample_annotation",
        "\"translation\": [",
        &format!("\"translation\": [{long:?},"),
    );
    assert!(
        line.starts_with("sample_annotation.json") || line.contains("sample_annotation"),
        "{line}"
    );
}

#[test]
fn a_folder_without_tables_is_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let line = outcome(folder.path()).expect("nothing there");
    assert!(
        line.contains("a folder, expected") && line.contains("nuScenes"),
        "{line}"
    );
    // The folder of the tables itself will do.
    let whole = foreign();
    assert!(read(&whole.path().join("v1.0-mini")).is_ok());
    // From memory alone there are no other tables.
    let alone = ImportFile {
        bytes: b"[{\"token\": \"a\"}]",
        name: "a",
        path: None,
        options: Default::default(),
    };
    let line = read_scene(&alone).expect_err("alone").to_string();
    assert!(line.contains("read from memory"), "{line}");
}
