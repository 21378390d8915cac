//! Batches by the program itself: killed and gone on with, in shards, packed; the same bytes each time.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use sha2::{Digest, Sha256};

fn program(plan: &Path, output: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sceneloom"));
    command
        .arg("batch")
        .arg(plan)
        .arg("-o")
        .arg(output)
        .args(more)
        .arg("--json");
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(plan: &Path, output: &Path, more: &[&str]) -> serde_json::Value {
    let done = program(plan, output, more).output().expect("the program");
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{said}");
    serde_json::from_slice(&done.stdout).expect("a report")
}

/// SHA-256 of every file below a folder, by its path.
fn hashes(folder: &Path) -> BTreeMap<String, String> {
    let (mut out, mut open) = (BTreeMap::new(), vec![folder.to_path_buf()]);
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(at).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).expect("below").display().to_string();
            let hash = Sha256::digest(std::fs::read(&path).expect("a file"));
            out.insert(name, hash.iter().map(|b| format!("{b:02x}")).collect());
        }
    }
    out
}

fn plan_in(folder: &Path, json: &str) -> PathBuf {
    let path = folder.join("plan.json");
    std::fs::write(&path, json).expect("written");
    path
}

/// Kills a run as soon as so many variants are there.
fn killed_after(mut child: Child, output: &Path, variants: usize) {
    let there = || {
        let entries = std::fs::read_dir(output).into_iter().flatten().flatten();
        // What is being made stands in a hidden folder.
        let made = entries.filter(|e| !e.file_name().to_string_lossy().starts_with('.'));
        made.filter(|e| e.path().join("variant.json").exists()).count()
    };
    let start = Instant::now();
    while there() < variants && child.try_wait().expect("a process").is_none() {
        assert!(
            start.elapsed() < Duration::from_secs(300),
            "no {variants} variants"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    let _ = child.kill();
    child.wait().expect("ended");
}

const SWEEP: &str = r#"{
  "format": "sceneloom_batch", "version": 1, "seed": 3,
  "base": {"template": "t-junction"},
  "sweep": [
    {"name": "place", "values": [[], {"base": {"template": "straight"}}]},
    {"name": "weather", "values": [{"conditions": {"weather": "rain"}}, {"conditions": {"time": "night", "weather": "clear"}}]},
    {"name": "pedestrians", "values": [{"count": {"class": "pedestrian", "n": 0}}, {"count": {"class": "pedestrian", "n": 4}}]},
    {"name": "seed", "seeds": {"from": 5, "count": 1}}
  ],
  "check": false,
  "write": [{"format": "boxes"}, {"format": "occ3d"}, {"format": "loom"}]
}"#;

#[test]
fn a_batch_that_is_killed_twice_gives_the_bytes_of_one_that_is_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = plan_in(folder.path(), SWEEP);
    let whole = folder.path().join("whole");
    let report = run(&plan, &whole, &[]);
    assert_eq!(
        (&report["variants"], &report["made"], &report["open"]),
        (&8.into(), &8.into(), &0.into())
    );
    let expected = hashes(&whole);
    assert!(expected.contains_key("index.parquet") && expected.contains_key("000007/occ3d/labels.npz"));

    let killed = folder.path().join("killed");
    for variants in [1, 3] {
        killed_after(
            program(&plan, &killed, &[]).spawn().expect("started"),
            &killed,
            variants,
        );
    }
    // What a killed run left half done, and what somebody else's would look like.
    std::fs::create_dir_all(killed.join(".making-000006/occ3d")).expect("made");
    let report = run(&plan, &killed, &[]);
    assert!(
        report["kept"].as_u64() >= Some(3) && report["kept"].as_u64() < Some(8),
        "{report}"
    );
    assert_eq!(hashes(&killed), expected);

    let shards = folder.path().join("shards");
    let second = program(&plan, &shards, &["--shard", "1/2"])
        .spawn()
        .expect("started");
    let first = program(&plan, &shards, &["--shard", "0/2"])
        .output()
        .expect("the program");
    assert!(first.status.success() && second.wait_with_output().expect("ended").status.success());
    assert_eq!(hashes(&shards), expected);

    // Nothing is left to do, and another plan is not mixed in.
    assert_eq!(run(&plan, &shards, &[])["made"], 0);
    std::fs::write(&plan, SWEEP.replace("\"seed\": 3", "\"seed\": 4")).expect("written");
    let other = program(&plan, &shards, &[]).output().expect("the program");
    let line = String::from_utf8_lossy(&other.stderr);
    assert_eq!(other.status.code(), Some(2));
    assert!(
        line.contains("another plan") && line.lines().count() == 1,
        "{line}"
    );
}

/// Clips by the frame, in tars, by two processes: no frame is lost, and a variant that cannot be made stops nothing.
#[test]
fn frames_of_two_processes_are_all_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = plan_in(
        folder.path(),
        r#"{
          "format": "sceneloom_batch", "version": 1, "base": {"template": "straight"},
          "sweep": [
            {"name": "drive", "values": [[{"edits": [{"set_length": {"length_s": 1.9, "rate_hz": 10.0}}, {"let_move": {"template": "follow", "mps": 8.0}}]}]]},
            {"name": "offset", "values": [[], {"offset": {"box": 999999, "by_m": [1.0, 0.0]}}]},
            {"name": "seed", "seeds": {"from": 0, "count": 3}}
          ],
          "write": [{"format": "boxes"}], "frames_hz": 10.0, "pack": 2
        }"#,
    );
    let output = folder.path().join("out");
    let shard = |shard: &str| {
        program(&plan, &output, &["--shard", shard])
            .spawn()
            .expect("started")
    };
    let (a, b) = (shard("0/2"), shard("1/2"));
    for child in [a, b] {
        // Three of six name a box that is not there.
        let done = child.wait_with_output().expect("ended");
        assert_eq!(
            done.status.code(),
            Some(1),
            "{}",
            String::from_utf8_lossy(&done.stderr)
        );
    }
    let names: Vec<String> = std::fs::read_dir(&output)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    assert!(names.iter().any(|n| n == "index.parquet"), "{names:?}");
    let mut frames = 0;
    for tar in names.iter().filter(|n| n.ends_with(".tar")) {
        let mut tar = tar::Archive::new(std::fs::File::open(output.join(tar)).expect("a tar"));
        for entry in tar.entries().expect("entries") {
            let name = entry
                .expect("whole")
                .path()
                .expect("a name")
                .display()
                .to_string();
            frames += usize::from(name.ends_with(".boxes.boxes.json"));
        }
    }
    assert_eq!(frames, 3 * 20);
    let records = std::fs::read_to_string(output.join("shard-000002.json")).expect("records");
    assert!(records.contains("box 999999 does not exist"), "{records}");
}
