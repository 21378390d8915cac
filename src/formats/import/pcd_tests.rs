//! Tests of the reader of point clouds.

use super::*;
use crate::import::{GUESSED, ImportedScene};
use scene::{Class, Window};

/// Three points in two voxels and one beside the map, with labels.
pub(super) fn sample() -> Vec<u8> {
    b"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity label\nSIZE 4 4 4 4 1\n\
      TYPE F F F F U\nCOUNT 1 1 1 1 1\nWIDTH 5\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 5\nDATA ascii\n\
      10.1 -3.1 0.1 12 4\n10.2 -3.1 0.1 9 4\n10.15 -3.1 0.1 9 0\n10.1 -3.1 0.9 9 200\n500 0 0 1 4\n"
        .to_vec()
}

fn binary(points: &[([f64; 3], u16)], promised: usize) -> Vec<u8> {
    let mut out = format!(
        "VERSION .7\nFIELDS label z pad x y\nSIZE 2 4 1 8 4\nTYPE U F I F F\nCOUNT 1 1 3 1 1\nWIDTH {promised}\nHEIGHT 1\n\
         VIEWPOINT 0 0 1.8 1 0 0 0\nDATA binary\n"
    )
    .into_bytes();
    for ([x, y, z], label) in points {
        out.extend(label.to_le_bytes());
        out.extend((*z as f32).to_le_bytes());
        out.extend([7; 3]);
        out.extend(x.to_le_bytes());
        out.extend((*y as f32).to_le_bytes());
    }
    out
}

fn loaded(bytes: &[u8]) -> Result<ImportedScene, FormatError> {
    match read(&ImportFile {
        bytes,
        name: "cloud",
        path: None,
        options: Default::default(),
    })? {
        Content::Scene(loaded) => Ok(*loaded),
        other => panic!("a cloud is a scene, not {other:?}"),
    }
}

#[test]
fn a_cloud_becomes_voxels_with_the_class_of_most_points() {
    let found = loaded(&sample()).expect("sound");
    let grid = &found.scene.frame().occupancy;
    let at = |x, y, z| {
        let [x, y, z] = Window::voxel_at(DVec3::new(x, y, z)).expect("on the map");
        grid.get(x, y, z)
    };
    assert_eq!(
        (at(10.1, -3.1, 0.1), at(10.1, -3.1, 0.9)),
        (Class::Car.id(), Class::Others.id())
    );
    assert_eq!((grid.count_set(), &*found.scene.name), (2, "cloud"));
    let skipped: Vec<(&str, usize)> = found.skipped.iter().map(|(k, n)| (k.as_str(), *n)).collect();
    assert_eq!(
        skipped,
        [
            ("field intensity", 1),
            ("labels without a class, taken as others", 1),
            ("points beside the map", 1)
        ]
    );
    assert_eq!(found.inferred, GUESSED);
}

#[test]
fn fields_come_in_any_order_and_type() {
    let points = [
        ([39.9, -39.9, 5.3], 16),
        ([-0.1, 0.1, -0.9], 11),
        ([f64::NAN, 0.0, 0.0], 3),
    ];
    let found = loaded(&binary(&points, 3)).expect("sound");
    let grid = &found.scene.frame().occupancy;
    assert_eq!(
        (grid.get(199, 0, 15), grid.get(99, 100, 0), grid.count_set()),
        (16, 11, 2)
    );
    for what in ["points that are not finite", "field pad", "viewpoint"] {
        assert_eq!(found.skipped.get(what), Some(&1), "{what}");
    }
}

/// Written by pypcd4 1.5.1: six times four points, packed by LZF.
const PACKED: &[u8] = b"VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 24\nHEIGHT 1\n\
    VIEWPOINT 0.0 0.0 0.0 1.0 0.0 0.0 0.0\nPOINTS 24\nDATA binary_compressed\n\
    :\x00\x00\x008\x01\x00\x00\x0c\x9a\x99!A33#Aff\"A\x9a \x0b@\x03\xe0C\x0f\x03ffF\xc0\xe0S\x03\x03\xcd\xcc\xcc=\
    \xc0\x03\x03fff?\xc0\x0b@\x07\xe0;\x0f\x03\x04\x04\x00\t\xe0\n\x03\x00\t";

#[test]
fn compressed_points_are_read() {
    let found = loaded(PACKED).expect("sound");
    let grid = &found.scene.frame().occupancy;
    let at = |z| {
        let [x, y, z] = Window::voxel_at(DVec3::new(10.1, -3.1, z)).expect("on the map");
        grid.get(x, y, z)
    };
    assert_eq!((at(0.1), at(0.9), grid.count_set()), (4, 9, 2));
    assert!(found.skipped.is_empty(), "{:?}", found.skipped);
}

#[test]
fn compressed_points_that_lie_are_refused() {
    let data = PACKED.len() - 58 - 8;
    let with = |at: usize, bytes: &[u8]| {
        let mut file = PACKED.to_vec();
        file[data + at..data + at + bytes.len()].copy_from_slice(bytes);
        loaded(&file).map(drop).expect_err("refused").to_string()
    };
    let begins = "binary_compressed: 58 bytes for";
    assert!(with(0, &[59]).starts_with(&format!("{begins} 59 that unpack to 312")));
    assert!(with(4, &[255; 4]).starts_with(&format!("{begins} 58 that unpack to 4294967295")));
    assert!(with(0, &[1, 0, 0, 0]).starts_with(&format!("{begins} 1 that unpack to 312")));
    assert_eq!(
        with(4, &[57]),
        "binary_compressed: 313 bytes unpacked, expected 24 points of 13 bytes"
    );
    assert_eq!(
        with(8, &[0x20]),
        "binary_compressed: damaged data, expected 312 bytes packed by LZF"
    );
    for cut in data..PACKED.len() {
        assert!(loaded(&PACKED[..cut]).is_err(), "{cut}");
    }
}

#[test]
fn without_labels_the_shape_tells() {
    let text = String::from_utf8(sample())
        .expect("text")
        .replace(" label\n", " ring\n");
    let found = loaded(text.as_bytes()).expect("sound");
    // One low thing.
    let counts = found.scene.frame().occupancy.class_counts();
    assert_eq!((counts[usize::from(Class::Others.id())], counts[4]), (1, 0));
    assert_eq!(found.inferred, ["classes", "layout", "boxes", "background"]);
}

#[test]
fn what_is_wrong_is_named() {
    let text = String::from_utf8(sample()).expect("text");
    let line = |bytes: &[u8]| loaded(bytes).map(drop).expect_err("refused").to_string();
    for (from, to, expected) in [
        (
            "DATA ascii",
            "DATA zipped",
            "header, DATA: zipped, expected ascii, binary or binary_compressed",
        ),
        ("DATA ascii\n", "", "header, DATA: no such line"),
        ("POINTS 5", "POINTS 9", "5 points, expected 9 as in the header"),
        (
            "POINTS 5",
            "POINTS 99999999999999999999",
            "header, POINTS: 99999999999999999999",
        ),
        (
            "FIELDS x y z",
            "FIELDS x q z",
            "header, FIELDS: no such field, expected y",
        ),
        (
            "SIZE 4 4",
            "SIZE 4 3",
            "header, TYPE: F of 3 bytes, expected F of 4 or 8",
        ),
        ("SIZE 4 4 4 4 1\n", "", "header, SIZE: no such line"),
        (
            "10.1 -3.1 0.1 12 4",
            "10.1 -3.1 0,1 12 4",
            "point 0: field z is \"0,1\", expected a number",
        ),
        (
            "10.1 -3.1 0.1 12 4",
            "10.1 -3.1",
            "point 0: field z is \"\", expected a number",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let changed = text.replacen(from, to, 1);
        let found = line(changed.as_bytes());
        assert!(found.starts_with(expected), "{found}");
    }
    assert_eq!(
        line(&binary(&[([0.0; 3], 1)], 1 << 40)),
        "1 points, expected 1099511627776 as in the header"
    );
    assert!(line(&binary(&[([100.0; 3], 1)], 1)).starts_with("none of 1 points lies on the map"));
    assert!(line(b"").contains("DATA"));
}
