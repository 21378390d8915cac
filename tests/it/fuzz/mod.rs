//! Every parser on a small corpus (`tests/data/fuzz/<target>/`, written for this suite) and on seeded mutations of valid
//! files: no panic, no hang, errors of one line; and what is accepted is sound. The functions are those of
//! `fuzz/src/targets.rs`, which cargo-fuzz runs for longer. `SCENELOOM_FUZZ_ROUNDS` multiplies the rounds,
//! `SCENELOOM_FUZZ_SEED` chooses others.

use std::io::{Cursor, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use editor::Edit;
use formats::{box_list, loom, occ3d};
use job::GenParams;
use numeric::splitmix::SplitMix64;
use scene::{Class, SensorRig, VoxelGrid};
use zip::write::SimpleFileOptions;

mod mutate;
#[path = "../../../fuzz/src/targets.rs"]
mod targets;

use mutate::damage;

/// An input that takes longer hangs: far above what any needs, also on a crowded machine.
const HANG: Duration = Duration::from_secs(120);

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn file(path: &str) -> Vec<u8> {
    std::fs::read(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

fn env(name: &str, default: u64) -> u64 {
    std::env::var(name)
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(default)
}

/// Ends the process, with a word about the input, if one input takes too long: a hang is a failure.
struct Watch {
    beat: std::sync::Arc<AtomicU64>,
}

impl Watch {
    fn new(target: &'static str) -> Self {
        let beat = std::sync::Arc::new(AtomicU64::new(0));
        let seen = std::sync::Arc::downgrade(&beat);
        std::thread::spawn(move || {
            let mut last = None;
            loop {
                std::thread::sleep(HANG);
                let Some(beat) = seen.upgrade() else { return };
                let now = beat.load(Ordering::Relaxed);
                if last == Some(now) {
                    eprintln!(
                        "fuzz {target}: an input took longer than {HANG:?}; see {}",
                        kept(target).display()
                    );
                    std::process::exit(101);
                }
                last = Some(now);
            }
        });
        Self { beat }
    }
}

fn kept(target: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz_{target}.bin"))
}

/// The corpus of a target, `valid` and mutations of all of them.
fn run(
    target: &'static str,
    valid: Vec<Vec<u8>>,
    rounds: u64,
    also: impl Fn(&[u8], &mut SplitMix64) -> Option<Vec<u8>>,
) {
    let found = targets::ALL.iter().find(|(name, _)| *name == target);
    let (_, test) = found.expect("a target of that name");
    let watch = Watch::new(target);
    let one = |what: &str, bytes: &[u8]| {
        // Kept before it is tried: a stack that ends takes the process with it.
        let _ = std::fs::write(kept(target), bytes);
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| test(bytes))) {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text
                .or(panic.downcast_ref::<&str>().copied())
                .unwrap_or("no message");
            panic!(
                "{target}, {what}: {text}; the input is in {}",
                kept(target).display()
            );
        }
        watch.beat.fetch_add(1, Ordering::Relaxed);
    };
    let mut seeds = valid;
    let folder = root().join("tests/data/fuzz").join(target);
    let mut files: Vec<PathBuf> = match std::fs::read_dir(&folder) {
        Ok(entries) => entries.flatten().map(|e| e.path()).collect(),
        Err(_) => Vec::new(),
    };
    files.sort();
    for path in files {
        let bytes = std::fs::read(&path).expect("a file of the corpus");
        one(&path.display().to_string(), &bytes);
        seeds.push(bytes);
    }
    assert!(!seeds.is_empty(), "{target}: nothing to begin with");
    for (i, bytes) in seeds.iter().enumerate() {
        one(&format!("seed file {i}"), bytes);
    }
    one("nothing", b"");
    let seed = env("SCENELOOM_FUZZ_SEED", 62);
    let rounds = rounds * env("SCENELOOM_FUZZ_ROUNDS", 1);
    for round in 0..rounds {
        let mut dice = SplitMix64::new(seed.wrapping_mul(0x1000_0000_01b3) ^ round.wrapping_mul(0x9e37_79b9));
        let whole = &seeds[dice.below(seeds.len())];
        let bytes = match dice.below(2) {
            0 => also(whole, &mut dice),
            _ => None,
        };
        let bytes = bytes.unwrap_or_else(|| damage(whole, &mut dice));
        one(&format!("seed {seed}, round {round}"), &bytes);
    }
    let _ = std::fs::remove_file(kept(target));
    println!("{target}: {} seed files, {rounds} mutations", seeds.len());
}

fn plain(target: &'static str, valid: Vec<Vec<u8>>, rounds: u64) {
    run(target, valid, rounds, |_, _| None);
}

/// A zip whose entries are damaged before they are packed, so that no checksum tells.
fn repacked(whole: &[u8], dice: &mut SplitMix64) -> Option<Vec<u8>> {
    let mut zip = zip::ZipArchive::new(Cursor::new(whole)).ok()?;
    let victim = dice.below(zip.len());
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for i in 0..zip.len() {
        let mut entry = zip.by_index(i).ok()?;
        let name = entry.name().ok()?.to_string();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).ok()?;
        if i == victim {
            // The first bytes of a large entry matter most.
            let head = bytes.len().min([64, 4096, usize::MAX][dice.below(3)]);
            let rest = bytes.split_off(head);
            bytes = damage(&bytes, dice);
            bytes.extend(rest);
        }
        let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        out.start_file(name, options).ok()?;
        out.write_all(&bytes).ok()?;
    }
    Some(out.finish().ok()?.into_inner())
}

#[test]
fn project_files() {
    run(
        "project",
        vec![
            file("assets/scenes/first_light.loom"),
            file("tests/reference/loom/v4.loom"),
        ],
        220,
        repacked,
    );
}

#[test]
fn point_clouds() {
    let header = |data: &str, points: usize| {
        format!(
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {points}\n\
             HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
        )
    };
    let ascii = header("ascii", 2) + "10.1 -3.1 0.1 4\n-7 3 1.9 11\n";
    let mut binary = header("binary", 3).into_bytes();
    for i in 0..3u8 {
        let numbers = [f32::from(i) * 3.0, -2.5, 0.4];
        binary.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
        binary.push(i);
    }
    plain("pcd", vec![ascii.into_bytes(), binary], 400);
}

/// An npy of nothing but brackets ended the program before headers were checked.
#[test]
fn occ3d_files() {
    let mut grid = VoxelGrid::new();
    (0..60).for_each(|i| grid.set(i * 3, 100, i % 16, (i % 17) as u8));
    let nest = |n: usize| {
        let text = format!("{{'descr': {}'|u1', 'shape': (200, 200, 16)}}\n", "(".repeat(n));
        let mut npy = b"\x93NUMPY\x02\x00".to_vec();
        npy.extend((text.len() as u32).to_le_bytes());
        npy.extend(text.as_bytes());
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        zip.start_file("semantics.npy", SimpleFileOptions::default())
            .expect("an entry");
        zip.write_all(&npy).expect("memory");
        zip.finish().expect("memory").into_inner()
    };
    let valid = vec![occ3d::to_bytes(&grid), nest(10), nest(200_000), nest(3000)];
    run("occ3d", valid, 160, repacked);
}

#[test]
fn opendrive_files() {
    let names = [
        "every_geometry",
        "left_hand_bend",
        "parking_street",
        "straight_two_way",
    ];
    plain(
        "opendrive",
        names.map(|n| file(&format!("assets/roads/{n}.xodr"))).to_vec(),
        250,
    );
}

#[test]
fn box_files() {
    let scene = loom::from_bytes(&file("assets/scenes/first_light.loom")).expect("sound");
    plain(
        "boxes",
        vec![box_list::to_bytes("s", scene.frame(), None, None, None).expect("finite")],
        1500,
    );
}

#[test]
fn rig_files() {
    let rig = serde_json::to_vec(&SensorRig::default()).expect("plain numbers");
    plain("rig", vec![rig, file("assets/rigs/nuscenes.json")], 1200);
}

#[test]
fn settings_files() {
    let settings = app::settings::Settings {
        dock: Some(app::dock::Dock::default().tree().clone()),
        ..Default::default()
    };
    // A tile within itself was walked without end before kept panes were checked.
    let mut endless = settings.clone();
    let tree = endless.dock.as_mut().expect("just set");
    let root = tree.root.expect("a root");
    if let Some(egui_tiles::Tile::Container(c)) = tree.tiles.get_mut(root) {
        c.add_child(root);
    }
    let valid = [settings, endless].map(|s| serde_json::to_vec(&s).expect("plain data"));
    plain("settings", valid.to_vec(), 1500);
}

#[test]
fn edit_lists() {
    let cells: Vec<[usize; 3]> = (0..6).map(|z| [120, 104, z]).collect();
    let list = [
        Edit::PaintVoxels {
            cells,
            class: Class::Manmade,
        },
        Edit::ClearPaint {},
    ];
    let rig = Edit::SetRig { rig: Box::default() };
    let valid = vec![
        serde_json::to_vec(&list).expect("plain data"),
        serde_json::to_vec(&[rig]).expect("plain data"),
    ];
    plain("edits", valid, 600);
}

/// Sessions: the bytes themselves are the random choices.
#[test]
fn edit_sequences() {
    let mut dice = SplitMix64::new(7);
    let valid = (0..30).map(|i| (0..40 * (i + 1)).map(|_| dice.bits() as u8).collect());
    plain("edit_sequence", valid.collect(), 120);
}

#[test]
fn weight_files() {
    let config = |whole: &[u8], dice: &mut SplitMix64| {
        // Only the header is damaged, and its length put right.
        let length = u64::from_le_bytes(whole.get(..8)?.try_into().ok()?) as usize;
        let header = damage(whole.get(8..8 + length)?, dice);
        let mut out = (header.len() as u64).to_le_bytes().to_vec();
        out.extend(header);
        out.extend(&whole[8 + length..]);
        Some(out)
    };
    run(
        "weights",
        vec![file("assets/weights/lidar_flat.safetensors")],
        1500,
        config,
    );
    run(
        "weights",
        vec![file("assets/weights/text.safetensors")],
        60,
        config,
    );
}

#[test]
fn prompts() {
    let text = String::from_utf8(file("tests/words/dev/prompts.jsonl")).expect("UTF-8");
    let prompts = text.lines().step_by(6).filter_map(|l| {
        let value: serde_json::Value = serde_json::from_str(l).ok()?;
        Some(value.get("text")?.as_str()?.as_bytes().to_vec())
    });
    let prompts: Vec<Vec<u8>> = prompts.collect();
    plain("prompt", prompts.clone(), 250);
    plain("text_edit", prompts, 120);
}

#[test]
fn memory_banks() {
    let whole: serde_json::Value = serde_json::from_slice(&file("assets/memory/bank.json")).expect("JSON");
    let mut few = whole.clone();
    few["entries"] = whole["entries"].as_array().expect("a list")[..3].to_vec().into();
    plain("memory", vec![serde_json::to_vec(&few).expect("JSON")], 150);
}

#[test]
fn scene_graphs() {
    let description = words::describe::described(
        "add 2 parked car ( left 1 bus ) and 1 person ( crossing road ) ( ahead ego 12m )",
    );
    let graph = place::to_graph::to_graph(&description.expect("valid"), 1).graph;
    plain(
        "graph",
        vec![serde_json::to_vec(&graph).expect("plain data")],
        150,
    );
}

#[test]
fn command_lines_and_words() {
    plain("arguments", Vec::new(), 600);
    plain("words", Vec::new(), 400);
    plain(
        "params",
        vec![serde_json::to_vec(&GenParams::default()).expect("plain data")],
        3000,
    );
}

#[test]
fn measured_presets() {
    plain("presets", vec![file("assets/trade/presets.json")], 1500);
}

/// Every target is run by a test of this file.
#[test]
fn no_target_is_forgotten() {
    let own = include_str!("mod.rs");
    for (name, _) in targets::ALL {
        assert!(own.contains(&format!("\"{name}\",")), "{name} is not run");
        assert!(
            root().join(format!("fuzz/fuzz_targets/{name}.rs")).exists(),
            "{name} has no target"
        );
    }
}
