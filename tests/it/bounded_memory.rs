//! Row 62 of the extremes table: a file, sound or not, costs at most twice the memory of what it holds (and a scene's own
//! grids). The peak of the process is read from Linux, so the test runs itself again in a process of its own.

use std::io::{Cursor, Write};

use crate::peak_memory::peak_growth;

use editor::{Document, Edit, Shape};
use formats::{box_list, loom, occ3d, opendrive};
use glam::DVec2;
use nets::occ_dit::OccDit;
use nn::weights::WeightFile;
use scene::{BevLayer, SensorRig};
use zip::write::SimpleFileOptions;

const MIB: usize = 1 << 20;
/// What a scene needs whatever is in its file, and the allocator.
const OWN: usize = 24 * MIB;

fn zipped(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        out.start_file(*name, SimpleFileOptions::default())
            .expect("memory");
        out.write_all(bytes).expect("memory");
    }
    out.finish().expect("memory").into_inner()
}

fn npy(header: &str, length: usize) -> Vec<u8> {
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((header.len() as u16).to_le_bytes());
    out.extend(header.as_bytes());
    out.resize(length, 0);
    out
}

#[test]
fn row_62_memory() {
    let program = std::env::current_exe().expect("this test program");
    let alone = std::process::Command::new(program)
        .args([
            "--exact",
            "bounded_memory::row_62_memory_alone",
            "--ignored",
            "--nocapture",
        ])
        .output()
        .expect("a process");
    let text = String::from_utf8_lossy(&alone.stdout);
    println!("{text}");
    let errors = String::from_utf8_lossy(&alone.stderr);
    assert!(alone.status.success() && text.contains("1 passed"), "{errors}");
}

#[test]
#[ignore = "row_62_memory runs it in a process of its own"]
fn row_62_memory_alone() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = std::fs::read(root.join("assets/scenes/first_light.loom")).expect("the bundled scene");
    let dit = std::fs::read(root.join("assets/weights/occ_dit.safetensors")).expect("the shipped weights");
    let check = |what: &str, holds: usize, work: &dyn Fn()| {
        work(); // what is made once is made now
        let Some(grown) = peak_growth(work) else {
            return println!("{what}: this system does not tell a process's peak memory");
        };
        println!(
            "{what}: holds {:.1} MiB, peak {:.1} MiB",
            holds as f64 / MIB as f64,
            grown as f64 / MIB as f64
        );
        assert!(
            grown <= 2 * holds + OWN,
            "{what}: {} MiB for {} MiB",
            grown / MIB,
            holds / MIB
        );
    };
    check("project", 2 * MIB, &|| {
        drop(loom::from_bytes(&scene).expect("sound"))
    });
    let blanks = vec![b' '; 60 * MIB];
    let bomb = zipped(&[
        (
            "manifest.json",
            br#"{"format":"sceneloom","version":1,"frames":1}"#,
        ),
        ("scene.json", &blanks),
    ]);
    assert!(bomb.len() < MIB);
    check("project of blanks", blanks.len(), &|| {
        drop(loom::from_bytes(&bomb).expect_err("blanks"))
    });
    let shape = "{'descr': '|u1', 'fortran_order': False, 'shape': (200, 200, 16), }\n";
    let huge = zipped(&[("semantics.npy", &npy(shape, 800 * MIB))]);
    check("labels of 800 MiB", huge.len(), &|| {
        drop(occ3d::read(&huge).expect_err("too long"))
    });
    let wide = "{'descr': '|u1', 'fortran_order': False, 'shape': (200000, 200000, 160000), }\n";
    let lies = zipped(&[("semantics.npy", &npy(wide, 1000))]);
    check("labels that promise much", lies.len(), &|| {
        drop(occ3d::read(&lies).expect_err("a lie"))
    });
    let numbers = 2 * dit.len(); // f16 in the file, f32 in memory
    check("weights", numbers, &|| {
        drop(OccDit::new(WeightFile::parse("w", &dit).expect("sound")).expect("sound"));
    });
    let header = br#"{"a":{"dtype":"F32","shape":[1099511627776],"data_offsets":[0,4398046511104]}}"#;
    let mut promise = (header.len() as u64).to_le_bytes().to_vec();
    promise.extend(header);
    check("weights that promise 4 TiB", promise.len(), &|| {
        assert!(WeightFile::parse("w", &promise).is_err());
    });
    let nest = "<OpenDRIVE>".repeat(300_000);
    check("a nest of elements", nest.len(), &|| {
        drop(opendrive::read(nest.as_bytes()).expect_err("no end"))
    });
    let boxes = vec![b'['; 8 * MIB];
    check("a nest of lists", boxes.len(), &|| {
        drop(box_list::read(&boxes).expect_err("no boxes"))
    });
    let mut rig = SensorRig::default();
    rig.lidars[0].columns = 65_535;
    rig.lidars[0].elevations_deg = (0..1024).map(|i| f64::from(i) * 0.05 - 25.0).collect();
    let line = rig.problem().expect("67 million rays are refused");
    assert!(line.contains("rays"), "{line}");
    // A wide stroke of many points: every segment covers the map.
    let points_m: Vec<DVec2> = (0..3000)
        .map(|i| DVec2::new(f64::from(i % 2) * 70.0 - 35.0, 1.0))
        .collect();
    let shape = Shape::Line {
        points_m,
        width_m: 1e6,
    };
    let stroke = Edit::PaintBev {
        layer: BevLayer::Walkway,
        shape,
        value: true,
    };
    check("a wide stroke", 3000 * 16, &|| {
        let mut document = Document::new(loom::from_bytes(&scene).expect("sound"));
        document.apply("Paint", &stroke).expect("sound");
    });
}
