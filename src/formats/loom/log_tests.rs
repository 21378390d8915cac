//! Tests of what a project file keeps beside its scene. The log: it comes back, equal states are kept once, and a damaged one costs nothing else.

use std::sync::Arc;

use scene::grid::VoxelPatch;
use scene::op::{Author, Change, LoggedState, Op, OpId, OpLog};
use scene::{Class, Edit, Scene};

use super::tests::{assert_same, pack, sample, unpack};
use super::*;

/// A change of every kind, by two authors: edits, a result that joins them, another state, a change left out.
pub(super) fn log() -> OpLog {
    let origin = Arc::new(sample(5));
    let before = origin.canvas().occupancy.clone();
    let mut after = before.clone();
    after.set(7, 8, 9, Class::Vegetation.id());
    after.set(229, 202, 15, Class::Manmade.id());
    let patch = Arc::new(VoxelPatch::between(&before, &after).expect("one map"));
    let edits = [
        Edit::SetPrompt { prompt: "fog".into() },
        Edit::PaintVoxels {
            cells: vec![[1, 2, 3], [4, 5, 6]],
            class: Class::Car,
        },
    ];
    let mut other = sample(5);
    other.prompt = "another".into();
    let changes = [
        (
            "Edit",
            false,
            Change::Edits {
                edits: edits.into(),
                things_from: Some(scene::ThingId(7)),
            },
        ),
        (
            "Edit",
            true,
            Change::Result {
                patch: patch.clone(),
                background: None,
            },
        ),
        (
            "Accept a part",
            false,
            Change::Result {
                patch,
                background: Some(origin.background.clone()),
            },
        ),
        (
            "Go to version",
            false,
            Change::Restore(LoggedState::new(&Arc::new(other))),
        ),
        (
            "Leave out a step",
            false,
            Change::Without {
                ops: vec![OpId(3)],
                is_undo: true,
            },
        ),
    ];
    let op = |(i, (label, joins, change)): (usize, (&'static str, bool, Change))| Op {
        id: OpId(i as u64 + 1),
        parent: (i > 0).then_some(OpId(i as u64)),
        author: if i == 2 { Author::ASSISTANT } else { Author::USER },
        label: label.into(),
        joins,
        shown_s: i as f64 / 3.0,
        change,
    };
    OpLog {
        origin: LoggedState::new(&origin),
        label: "Open".into(),
        ops: changes.into_iter().enumerate().map(op).collect(),
        at: 2,
    }
}

pub(super) fn assert_same_log(a: &OpLog, b: &OpLog) {
    assert!(a.origin.scene.is_same(&b.origin.scene), "the origin differs");
    assert_eq!((a.at, &a.label, a.ops.len()), (b.at, &b.label, b.ops.len()));
    for (a, b) in a.ops.iter().zip(&b.ops) {
        let about = |op: &Op| {
            (
                op.id,
                op.parent,
                op.author.clone(),
                op.label.clone(),
                op.joins,
                op.shown_s,
            )
        };
        assert_eq!(about(a), about(b));
        match (&a.change, &b.change) {
            (
                Change::Edits { edits, things_from },
                Change::Edits {
                    edits: other,
                    things_from: others,
                },
            ) => assert_eq!((edits, things_from), (other, others)),
            (Change::Restore(a), Change::Restore(b)) => assert!(a.scene.is_same(&b.scene)),
            (
                Change::Without { ops, is_undo },
                Change::Without {
                    ops: other,
                    is_undo: others,
                },
            ) => assert_eq!((ops, is_undo), (other, others)),
            (
                Change::Result { patch, background },
                Change::Result {
                    patch: other,
                    background: others,
                },
            ) => assert_eq!((patch, background), (other, others)),
            (a, b) => panic!("{a:?} came back as {b:?}"),
        }
    }
}

fn with_log(log: OpLog) -> Scene {
    let mut scene = sample(9);
    Arc::make_mut(&mut scene.kept).log = Some(Arc::new(log));
    scene
}

#[test]
fn a_log_comes_back_and_equal_states_are_kept_once() {
    let scene = with_log(log());
    let bytes = to_bytes(&scene).expect("sound");
    let again = from_bytes(&bytes).expect("sound");
    assert_same(&again, &scene);
    assert_eq!(
        to_bytes(&again).expect("sound"),
        bytes,
        "equal scenes give equal bytes"
    );
    let names = |bytes: &[u8]| -> Vec<String> { unpack(bytes).into_iter().map(|e| e.0).collect() };
    let ending = |names: &[String], end: &str| {
        let of = |n: &&String| n.starts_with("log/") && n.ends_with(end);
        names.iter().filter(of).count()
    };
    let found = names(&bytes);
    assert_eq!(
        (ending(&found, ".loom"), ending(&found, ".voxels")),
        (2, 1),
        "{found:?}"
    );
    // A state that is a version of the file too is kept as that.
    let mut scene = scene;
    let kept = Arc::make_mut(&mut scene.kept);
    kept.versions[1].loom = log().origin.packed(alone_to_bytes).expect("sound");
    let bytes = to_bytes(&scene).expect("sound");
    assert_eq!(ending(&names(&bytes), ".loom"), 1);
    assert_same(&from_bytes(&bytes).expect("sound"), &scene);
}

/// The entries of a file with a change of them: the scene opens all the same, and a line says why the history does not.
fn problem(change: impl FnOnce(&mut Vec<(String, Vec<u8>)>)) -> String {
    let scene = with_log(log());
    let mut entries = unpack(&to_bytes(&scene).expect("sound"));
    change(&mut entries);
    let opened = from_bytes(&pack(&entries)).expect("the scene is whole");
    assert!(opened.is_same(&scene), "the scene differs");
    assert!(opened.kept.log.is_none(), "the log opens all the same");
    let problem = opened.kept.log_problem.clone().expect("a line").to_string();
    assert!(!problem.contains('\n') && problem.len() < 400, "{problem}");
    // Saving it again leaves the damaged history behind.
    let again = from_bytes(&to_bytes(&opened.clone().without_log()).expect("sound")).expect("sound");
    assert!(again.kept.log_problem.is_none());
    problem
}

#[test]
fn a_damaged_log_costs_the_history_alone() {
    let entry = |entries: &[(String, Vec<u8>)], end: &str| {
        let of = |e: &(String, Vec<u8>)| e.0.ends_with(end) && !e.0.starts_with("versions/");
        entries.iter().position(of).expect("there")
    };
    let mut length = 0;
    problem(|entries| {
        let at = entry(entries, "log.json");
        length = entries[at].1.len();
        entries[at].1.clear();
    });
    for end in (0..length).step_by(61).chain(length - 2..length) {
        let line = problem(|entries| {
            let at = entry(entries, "log.json");
            entries[at].1.truncate(end);
        });
        assert!(line.starts_with("entry \"log.json\""), "{line}");
    }
    for (old, new, expected) in [
        (
            "\"parent\":1",
            "\"parent\":4",
            "follows change 4, which is not before it",
        ),
        (
            "\"parent\":1",
            "\"parent\":2",
            "follows change 2, which is not before it",
        ),
        ("\"id\":3", "\"id\":2", "there twice"),
        ("\"at\":2", "\"at\":9", "step 9 is shown, but there are 4"),
        ("\"at\":2", "\"at\":-1", "log.json"),
        ("\"author\"", "\"maker\"", "unknown field"),
        ("\"set_prompt\"", "\"set_fire\"", "unknown variant"),
        ("\"changes\":[3]", "\"changes\":[5]", "which is not before it"),
        ("\"origin\":\"", "\"origin\":\"../", "is missing"),
    ] {
        let line = problem(|entries| {
            let at = entry(entries, "log.json");
            let text = String::from_utf8(entries[at].1.clone()).expect("JSON");
            assert!(text.contains(old), "{old}: {text}");
            entries[at].1 = text.replacen(old, new, 1).into_bytes();
        });
        assert!(line.contains(expected), "{line}");
    }
    for end in [".voxels", ".loom"] {
        let line = problem(|entries| {
            let at = entry(entries, end);
            entries.remove(at);
        });
        assert!(line.contains("is missing"), "{line}");
        let line = problem(|entries| {
            let at = entry(entries, end);
            entries[at].1.pop();
        });
        let expected = if end == ".loom" {
            "its bytes are others"
        } else {
            "cut short"
        };
        assert!(line.contains(expected), "{line}");
    }
}

/// An author that nobody knows keeps the name, made safe to show.
#[test]
fn a_foreign_author_is_kept() {
    let mut log = log();
    log.ops[0].author = Author(format!("some\nbody{}", "!".repeat(99)).into());
    let again = from_bytes(&to_bytes(&with_log(log)).expect("sound")).expect("sound");
    let log = again.kept.log.clone().expect("a log");
    let name = log.ops[0].author.name();
    assert!(
        name.starts_with("some body!!") && name.chars().count() == Author::LONGEST + 1,
        "{name}"
    );
}

#[test]
fn what_is_kept_is_no_part_of_the_scene() {
    let scene = sample(VERSION);
    let (with, alone) = (
        to_bytes(&scene).expect("sound"),
        alone_to_bytes(&scene).expect("sound"),
    );
    assert!(with.len() > alone.len());
    let mut bare = scene.clone();
    bare.kept = Arc::default();
    assert_eq!(to_bytes(&bare).expect("sound"), alone);
    // Every version opens by itself.
    let back = from_bytes(&with).expect("its own");
    assert_same(
        &from_bytes(&back.kept.versions[1].loom).expect("a version"),
        &sample(2),
    );
    assert_eq!(back.kept.versions[0].title(), "before the rain");
    assert_eq!(back.kept.versions[1].title(), "Add a car");
    // A version that is damaged does not keep the scene from opening; one that is missing or too much is named.
    let mut entries = unpack(&with);
    let at = entries
        .iter()
        .position(|e| e.0 == "versions/0001.loom")
        .expect("there");
    entries[at].1.truncate(100);
    let damaged = from_bytes(&pack(&entries)).expect("the scene is whole");
    assert!(from_bytes(&damaged.kept.versions[1].loom).is_err());
    let line = |entries: &[(String, Vec<u8>)]| from_bytes(&pack(entries)).expect_err("refused").to_string();
    let gone = entries.remove(at);
    assert_eq!(line(&entries), "entry \"versions/0001.loom\" is missing");
    entries.push((gone.0, gone.1.clone()));
    entries.push(("versions/0002.loom".into(), gone.1));
    assert_eq!(line(&entries), "entry \"versions/0002.loom\" is not known");
    entries.pop();
    let at = entries.iter().position(|e| e.0 == "kept.json").expect("there");
    for (bytes, expected) in [
        (b"[".to_vec(), "kept.json"),
        (br#"{"versions":[{"name":3}]}"#.to_vec(), "kept.json"),
        (br#"{"kept":1}"#.to_vec(), "unknown field"),
        (
            format!(r#"{{"typed":[{}""]}}"#, r#""","#.repeat(1000)).into_bytes(),
            "the number of typed lines",
        ),
    ] {
        entries[at].1 = bytes;
        let line = line(&entries);
        assert!(line.contains(expected), "{line}");
    }
}
