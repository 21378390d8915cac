//! Killed in the middle of a save: the file on disk is a whole scene, old or new, and no more than the work of one
//! interval is lost.

use editor::Apply;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use app::open;
use app::recovery::{Recovery, stale};
use editor::{Document, Edit};
use formats::loom;
use scene::{Class, Scene};

const FOLDER: &str = "SCENELOOM_TEST_FOLDER";
/// Edits between two copies: one takes a hundredth of a second on the child's clock, the interval is one second.
const EDITS_PER_COPY: u64 = 100;
const EDITS_PER_SAVE: u64 = 37;
const KILLS: u64 = 25;

/// Edit number `i`: a prompt to know it by, and voxels, so that every file differs from the one before.
fn edits(i: u64) -> [Edit; 2] {
    let at = |salt: u64| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(salt as u32) % 200) as usize;
    [
        Edit::SetPrompt {
            prompt: i.to_string(),
        },
        Edit::PaintVoxels {
            cells: vec![[at(3), at(17), 5], [at(29), at(41), 9]],
            class: Class::Manmade,
        },
    ]
}

/// The state after `i` edits.
fn after(i: u64) -> Scene {
    let mut scene = open::bundled().expect("bundled");
    for edit in (1..=i).flat_map(edits) {
        edit.apply(&mut scene).expect("sound");
    }
    scene
}

/// Not a test: the process that the test below starts and kills.
#[test]
#[ignore = "runs until it is killed; started by the other test"]
fn child() {
    let Some(folder) = std::env::var_os(FOLDER) else {
        return;
    };
    let folder = Path::new(&folder);
    let user_file = folder.join("user.loom");
    let mut document = Document::new(open::bundled().expect("bundled"));
    let mut recovery = Recovery::start(&folder.join("recovery"), 1.0, || {}).expect("a session");
    for i in 1.. {
        document.apply_all("Edit", &edits(i)).expect("sound");
        recovery.tick(
            &document,
            Some(&user_file),
            scene::Scene::clone,
            i as f64 / EDITS_PER_COPY as f64,
        );
        recovery.wait();
        println!("edit {i}");
        if i % EDITS_PER_SAVE == 0 {
            loom::save(&user_file, document.scene()).expect("saved");
            println!("saved {i}");
        }
    }
}

/// The largest number that follows a word at the start of a line.
fn last(lines: &[String], word: &str) -> u64 {
    let numbers = lines
        .iter()
        .filter_map(|l| l.strip_prefix(word)?.trim().parse().ok());
    numbers.max().unwrap_or(0)
}

fn same(a: &Scene, b: &Scene) -> bool {
    (&a.name, &a.prompt, a.canvas(), a.clip()) == (&b.name, &b.prompt, b.canvas(), b.clip())
}

fn number(scene: &Scene) -> u64 {
    scene.prompt.parse().expect("the number of the edit")
}

#[test]
fn a_killed_process_leaves_whole_files_and_loses_one_interval_at_most() {
    let folder = tempfile::tempdir().expect("a folder");
    let (user_file, root) = (folder.path().join("user.loom"), folder.path().join("recovery"));
    let mut random = 0x1234_5678_9abc_def1u64; // xorshift: another moment each time
    for kill in 0..KILLS {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let mut child = Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "recovery::child", "--ignored", "--nocapture"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("a child");
        let mut out = BufReader::new(child.stdout.take().expect("piped"));
        let mut lines = Vec::new();
        while last(&lines, "saved") < EDITS_PER_SAVE * (1 + random % 6) {
            let mut line = String::new();
            assert!(
                out.read_line(&mut line).expect("text") > 0,
                "the child ended by itself"
            );
            lines.push(line);
        }
        // Long enough to reach into any part of a save.
        std::thread::sleep(Duration::from_micros(random >> 8 & 0xffff));
        child.kill().expect("SIGKILL");
        child.wait().expect("its end");
        let mut rest = String::new();
        out.read_to_string(&mut rest).expect("text");
        lines.extend(rest.lines().map(String::from));
        let (edited, saved) = (last(&lines, "edit"), last(&lines, "saved"));

        let found = loom::load(&user_file).unwrap_or_else(|e| panic!("kill {kill}: {e}"));
        let of = number(&found);
        assert!(
            of == saved || of == saved + EDITS_PER_SAVE,
            "{of} in the file, {saved} was told"
        );
        assert!(
            same(&found, &after(of)),
            "kill {kill}: not the scene that was saved"
        );

        let mut offers = stale(&root);
        assert_eq!(offers.len(), 1, "kill {kill}");
        let offer = offers.remove(0);
        assert_eq!(offer.original.as_deref(), Some(&*user_file));
        let found = loom::load(&offer.file()).unwrap_or_else(|e| panic!("kill {kill}: {e}"));
        let of = number(&found);
        assert!(
            of + EDITS_PER_COPY > edited,
            "kill {kill}: {edited} edits, {of} recovered"
        );
        assert!(
            same(&found, &after(of)),
            "kill {kill}: not the scene that was copied"
        );
        offer.discard();
    }
}
