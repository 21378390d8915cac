//! Tests of the reader of PLY.

use super::*;
use crate::import::{GUESSED, ImportedScene};
use scene::{Class, Window};

/// Three points in two voxels, one beside the map and one without a number, with labels; a face after them.
pub(super) fn sample() -> Vec<u8> {
    b"ply\nformat ascii 1.0\ncomment a few points\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
      property uchar red\nproperty uchar class\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
      10.1 -3.1 0.1 12 4\n10.2 -3.1 0.1 9 4\n10.15 -3.1 0.1 9 0\n500 0 0 1 4\nnan 0 0 1 4\n3 0 1 2\n"
        .to_vec()
}

/// The same vertices as bytes, fields in another order and of other types, after an element with a list.
fn binary(is_big: bool) -> Vec<u8> {
    let name = if is_big { "big" } else { "little" };
    let mut out = format!(
        "ply\r\nformat binary_{name}_endian 1.0\r\nelement marker 2\r\nproperty list ushort double values\r\n\
         property int8 kind\r\nelement vertex 3\r\nproperty int16 Label\r\nproperty float64 z\r\n\
         property list uint8 float32 weights\r\nproperty float32 y\r\nproperty float64 x\r\nend_header\r\n"
    )
    .into_bytes();
    macro_rules! put {
        ($value:expr) => {
            match is_big {
                true => out.extend($value.to_be_bytes()),
                false => out.extend($value.to_le_bytes()),
            }
        };
    }
    for length in [0u16, 3] {
        put!(length);
        for i in 0..length {
            put!(f64::from(i));
        }
        put!(-1i8);
    }
    for (i, (label, [x, y, z])) in [
        (16i16, [39.9, -39.9, 5.3]),
        (11, [-0.1, 0.1, -0.9]),
        (4, [f64::INFINITY, 0.0, 0.0]),
    ]
    .into_iter()
    .enumerate()
    {
        put!(label);
        put!(z);
        out.push(i as u8);
        for w in 0..i {
            put!(w as f32);
        }
        put!(y as f32);
        put!(x);
    }
    out
}

fn loaded(bytes: &[u8]) -> Result<ImportedScene, FormatError> {
    match (IMPORTER.read)(&ImportFile {
        bytes,
        name: "cloud",
        path: None,
        options: Default::default(),
    })? {
        Content::Scene(loaded) => Ok(*loaded),
        other => panic!("{other:?}: expected a scene"),
    }
}

fn refused(bytes: &[u8]) -> String {
    loaded(bytes).map(drop).expect_err("refused").to_string()
}

#[test]
fn a_car_ahead_to_the_right_lands_there() {
    let found = loaded(&sample()).expect("sound");
    let grid = &found.scene.frame().occupancy;
    let [x, y, z] = Window::voxel_at(DVec3::new(10.1, -3.1, 0.1)).expect("on the map");
    assert_eq!((grid.get(x, y, z), grid.count_set()), (Class::Car.id(), 1));
    let skipped: Vec<(&str, usize)> = found.skipped.iter().map(|(k, n)| (k.as_str(), *n)).collect();
    assert_eq!(
        skipped,
        [
            ("element face", 1),
            ("points beside the map", 1),
            ("points that are not finite", 1),
            ("property red", 1),
        ]
    );
    assert_eq!(found.inferred, GUESSED);
}

#[test]
fn both_byte_orders_any_order_of_properties_and_lists_are_read() {
    for is_big in [false, true] {
        let found = loaded(&binary(is_big)).expect("sound");
        let grid = &found.scene.frame().occupancy;
        assert_eq!(
            (grid.get(199, 0, 15), grid.get(99, 100, 0), grid.count_set()),
            (16, 11, 2)
        );
        for (what, count) in [
            ("points that are not finite", 1),
            ("property weights", 1),
            ("element marker", 2),
        ] {
            assert_eq!(found.skipped.get(what), Some(&count), "{what}");
        }
    }
}

#[test]
fn gaussians_are_points_and_that_is_said() {
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                property float f_dc_0\nproperty float opacity\nproperty float scale_0\nproperty float rot_0\nend_header\n\
                5 5 1 0 0 0 1\n-5 5 1 0 0 0 1\n";
    let found = loaded(text.as_bytes()).expect("sound");
    assert_eq!(found.scene.frame().occupancy.count_set(), 2);
    assert_eq!(found.inferred[0], "classes");
    let (what, count) = found.skipped.first_key_value().expect("said");
    assert!(what.contains("Gaussians") && *count == 2, "{what}");
}

#[test]
fn what_is_wrong_is_named() {
    let text = String::from_utf8(sample()).expect("text");
    for (from, to, expected) in [
        ("ply\n", "pli\n", "header, line 1: pli, expected ply"),
        (
            "format ascii 1.0",
            "format ascii 2.0",
            "header, line 2: format ascii 2.0, expected",
        ),
        (
            "format ascii",
            "format wide",
            "header, line 2: format wide 1.0, expected ascii",
        ),
        (
            "format ascii 1.0\n",
            "",
            "header, line 11: end_header, expected a line format",
        ),
        (
            "vertex 5",
            "vertex 99999999999",
            "header, line 4: element vertex 99999999999, expected",
        ),
        (
            "vertex 5",
            "vertex -1",
            "header, line 4: element vertex -1, expected",
        ),
        ("vertex 5", "vertex 9", "vertex 5: property z is 2"),
        (
            "property float x",
            "property long x",
            "header, line 5: property long x, expected",
        ),
        (
            "property float x",
            "property list float x",
            "header, line 5: property list float x, expected",
        ),
        ("float y", "float q", "no property y of the element vertex"),
        (
            "element vertex",
            "element point",
            "no property x of the element vertex",
        ),
        (
            "-3.1 0.1 12",
            "-3,1 0.1 12",
            "vertex 0: property y is -3,1, expected a number",
        ),
        (
            "end_header\n",
            "",
            "header, line 12: 10.1 -3.1 0.1 12 4, expected format",
        ),
        (
            "10.1 -3.1 0.1 12 4\n10.2 -3.1 0.1 9 4\n10.15 -3.1",
            "91 0 0 0 4\n92 0 0 0 4\n93 0",
            "none of 5 points lies on the map",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let line = refused(text.replacen(from, to, 1).as_bytes());
        let begins = expected.starts_with("vertex 5") || line.starts_with(expected);
        assert!(begins, "{line}, expected {expected}");
    }
    assert!(refused(b"").contains("no end"));
}

/// A list that says to be longer than the file, and elements of no bytes, cost nothing.
#[test]
fn huge_claims_are_refused_at_once() {
    let header = |list: &str, count: usize| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement a {count}\n{list}element vertex 1\nproperty float x\n\
             property float y\nproperty float z\nend_header\n"
        )
        .into_bytes()
    };
    let long = [
        header("property list uint double v\n", 1),
        vec![255; 4],
        vec![0; 12],
    ]
    .concat();
    assert!(refused(&long).starts_with("a 0 of 1 is not there"));
    let negative = [
        header("property list int double v\n", 1),
        vec![255; 4],
        vec![0; 12],
    ]
    .concat();
    assert!(refused(&negative).starts_with("a 0 of 1 is not there"));
    let place = [1.0f32, 0.0, 0.0].map(|v| v.to_le_bytes()).concat();
    let nothing = [header("", 100), place].concat();
    assert_eq!(
        loaded(&nothing)
            .expect("sound")
            .scene
            .frame()
            .occupancy
            .count_set(),
        1
    );
}

#[test]
fn every_cut_is_refused() {
    for bytes in [sample(), binary(false), binary(true)] {
        for cut in 0..bytes.len() {
            // Without what follows the points the file is whole enough.
            let text = String::from_utf8_lossy(&bytes[..cut]).into_owned();
            match loaded(&bytes[..cut]) {
                Err(error) => assert!(!error.to_string().contains('\n')),
                Ok(_) => assert!(text.contains("nan 0 0 1 4"), "cut at {cut}"),
            }
        }
    }
}
