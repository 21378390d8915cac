//! Tests of the reader of LAS and LAZ.

use std::io::Cursor;

use glam::DVec2;
use laz::{LasZipCompressor, LazVlrBuilder};

use super::*;
use crate::export::las::to_bytes;
use crate::import::{GUESSED, ImportedScene};
use crate::las::record_length;
use crate::points_tests::{point, sweep};

/// A car, a tree and a road, as this program writes them.
pub(super) fn sample() -> Vec<u8> {
    own(false)
}

fn own(is_packed: bool) -> Vec<u8> {
    let points = [
        ([12.1, 4.1, 0.5], Class::Car),
        ([-20.0, -8.0, 3.0], Class::Vegetation),
        ([5.0, 0.0, -0.8], Class::DriveableSurface),
        ([90.0, 0.0, 0.0], Class::Sidewalk),
    ];
    let points = points.map(|(at, class)| point(DVec3::from_array(at), class));
    to_bytes(&sweep(points.to_vec()), is_packed, &|_: DVec2| 0.0).expect("near")
}

/// A file of another program: coordinates in steps of 1 cm from an offset, classifications of the standard.
struct Foreign {
    format: u8,
    minor: u8,
    offset_m: [f64; 3],
    points: Vec<([i32; 3], u8)>,
}

impl Foreign {
    /// What stands around a place far from the origin: road, wall, noise, unclassified, two in one voxel.
    fn street(format: u8) -> Self {
        Self {
            format,
            minor: if format < 6 { 2 } else { 4 },
            offset_m: [690_000.0, 5_333_000.0, 500.0],
            points: (0..200)
                .map(|i| ([(i - 100) * 20, (i % 7) * 20, 1200], 11))
                .chain((0..40).map(|i| ([(i - 20) * 40, 1000, 1200 + 10 * i], 6)))
                .chain([
                    ([0, 0, 1300], 7),
                    ([1010, -310, 1300], 2),
                    ([1012, -312, 1305], 2),
                ])
                .collect(),
        }
    }

    fn records(&self) -> Vec<u8> {
        let length = record_length(self.format).expect("a format");
        let mut out = Vec::new();
        for (at, class) in &self.points {
            let mut record = vec![0; length];
            for (i, v) in at.iter().enumerate() {
                record[4 * i..4 * i + 4].copy_from_slice(&v.to_le_bytes());
            }
            record[if self.format < 6 { 15 } else { 16 }] = *class;
            record[14] = 0x11;
            out.extend(record);
        }
        out
    }

    fn header(&self, body: usize, records: u32, is_packed: bool) -> Vec<u8> {
        let long = self.minor == 4;
        let mut out = vec![0; if long { 375 } else { 227 }];
        let length = out.len() as u16;
        let mut put = |at: usize, bytes: &[u8]| out[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, b"LASF");
        put(24, &[1, self.minor]);
        put(58, b"another program");
        put(94, &length.to_le_bytes());
        put(96, &(body as u32).to_le_bytes());
        put(100, &records.to_le_bytes());
        put(104, &[self.format | if is_packed { 0x80 } else { 0 }]);
        put(
            105,
            &(record_length(self.format).expect("a format") as u16).to_le_bytes(),
        );
        let count = self.points.len();
        match long {
            true => put(247, &(count as u64).to_le_bytes()),
            false => put(107, &(count as u32).to_le_bytes()),
        }
        for i in 0..3 {
            put(131 + 8 * i, &0.01f64.to_le_bytes());
            put(155 + 8 * i, &self.offset_m[i].to_le_bytes());
        }
        out
    }

    fn plain(&self) -> Vec<u8> {
        let header = self.header(0, 0, false).len();
        [self.header(header, 0, false), self.records()].concat()
    }

    fn packed(&self) -> Vec<u8> {
        let vlr = LazVlrBuilder::default()
            .with_point_format(self.format, 0)
            .expect("known");
        let vlr = vlr.with_fixed_chunk_size(64).build();
        let mut data = Vec::new();
        vlr.write_to(&mut data).expect("memory");
        let mut record = vec![0; 54];
        record[2..16].copy_from_slice(b"laszip encoded");
        record[18..20].copy_from_slice(&22204u16.to_le_bytes());
        record[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
        let header = self.header(0, 1, true).len();
        let body = header + record.len() + data.len();
        let out = [self.header(body, 1, true), record, data].concat();
        let mut to = Cursor::new(out);
        to.set_position(body as u64);
        let mut packer = LasZipCompressor::new(to, vlr).expect("sound");
        packer.compress_many(&self.records()).expect("memory");
        packer.done().expect("memory");
        packer.into_inner().into_inner()
    }
}

fn loaded(bytes: &[u8]) -> Result<ImportedScene, LasError> {
    let source = ImportFile {
        bytes,
        name: "cloud",
        path: None,
        options: Default::default(),
    };
    match read_around(&source, None)? {
        Content::Scene(loaded) => Ok(*loaded),
        other => panic!("{other:?}: expected a scene"),
    }
}

fn refused(bytes: &[u8]) -> String {
    loaded(bytes).map(drop).expect_err("refused").to_string()
}

fn at(loaded: &ImportedScene, at: [f64; 3]) -> u8 {
    let [x, y, z] = Window::voxel_at(DVec3::from_array(at)).expect("on the map");
    loaded.scene.frame().occupancy.get(x, y, z)
}

#[test]
fn a_car_ahead_to_the_left_lands_there_packed_or_not() {
    for is_packed in [false, true] {
        let found = loaded(&own(is_packed)).expect("sound");
        assert_eq!(at(&found, [12.1, 4.1, 0.5]), Class::Car.id());
        assert_eq!(at(&found, [-20.0, -8.0, 3.0]), Class::Vegetation.id());
        assert_eq!(found.scene.frame().occupancy.count_set(), 3);
        assert_eq!(found.skipped, [("points beside the map".to_owned(), 1)].into());
        assert_eq!(found.inferred, GUESSED);
    }
}

/// Every point format, packed or not, and the middle of what it holds becomes the origin.
#[test]
fn a_surveyed_street_is_moved_to_the_origin() {
    for format in 0..=10 {
        let street = Foreign::street(format);
        for bytes in [street.plain(), street.packed()] {
            let found = loaded(&bytes).unwrap_or_else(|e| panic!("format {format}: {e}"));
            // The middle is at 690000, 5333005, the ground 512 m high, there in the lowest bin.
            assert_eq!(
                at(&found, [-10.0, -4.5, -0.8]),
                Class::DriveableSurface.id(),
                "format {format}"
            );
            assert_eq!(at(&found, [4.0, 5.0, 3.0]), Class::Manmade.id());
            // Other ground, 1 m above the road, is lowered with it.
            assert_eq!(at(&found, [10.1, -8.1, 0.3]), Class::Terrain.id());
            let offset = "offset of x 690000.00, y 5333005.00, z 512.00 m, subtracted from every point";
            assert_eq!(found.skipped.get(offset), Some(&1), "{:?}", found.skipped);
            assert_eq!(found.skipped.get("points of noise"), Some(&1));
        }
    }
    let street = Foreign::street(7);
    let source = ImportFile {
        bytes: &street.plain(),
        name: "cloud",
        path: None,
        options: Default::default(),
    };
    let there = DVec3::new(690_010.0, 5_333_000.0, 512.0);
    let Ok(Content::Scene(found)) = read_around(&source, Some(there)) else {
        panic!("a scene");
    };
    assert_eq!(at(&found, [-20.0, 0.1, -0.8]), Class::DriveableSurface.id());
}

#[test]
fn clouds_around_the_origin_stay_where_they_are() {
    let mut street = Foreign::street(0);
    street.offset_m = [0.0, 0.0, -12.0];
    let found = loaded(&street.plain()).expect("sound");
    assert_eq!(at(&found, [-10.0, 0.5, -0.8]), Class::DriveableSurface.id());
    assert!(
        !found.skipped.keys().any(|k| k.starts_with("offset")),
        "{:?}",
        found.skipped
    );
    // The same on a hill: only the height is subtracted.
    street.offset_m = [0.0, 0.0, 300.0];
    let found = loaded(&street.plain()).expect("sound");
    assert_eq!(at(&found, [-10.0, 0.5, -0.8]), Class::DriveableSurface.id());
    assert!(
        found
            .skipped
            .contains_key("offset of x 0.00, y 0.00, z 312.00 m, subtracted from every point")
    );
}

#[test]
fn withheld_points_and_unclassified_ones() {
    let mut street = Foreign::street(6);
    street.points.iter_mut().for_each(|(_, class)| *class = 1);
    let mut bytes = street.plain();
    bytes[375 + 15] = 0x04;
    let found = loaded(&bytes).expect("sound");
    assert_eq!(found.skipped.get("points withheld"), Some(&1));
    assert_eq!(found.inferred[0], "classes");
    let users: Vec<u8> = {
        street.points[0].1 = 77;
        street.plain()
    };
    let found = loaded(&users).expect("sound");
    assert_eq!(
        found.skipped.get("classifications of users (64 to 255)"),
        Some(&1)
    );
}

#[test]
fn what_is_wrong_is_named() {
    let with = |at: usize, bytes: &[u8]| {
        let mut file = sample();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        refused(&file)
    };
    for (at, bytes, expected) in [
        (0, &b"LAZF"[..], "the signature is \"LAZF\", expected LASF"),
        (25, &[5], "the version is 1.5, expected 1.0 to 1.4"),
        (94, &[1, 0], "the size of the header is 1, expected 375 to"),
        (
            96,
            &[255; 4],
            "the start of the points is 4294967295, expected 375",
        ),
        (
            100,
            &[255; 4],
            "the number of records is 4294967295, expected at most",
        ),
        (104, &[11], "the point format is 11, expected 0 to 10"),
        (104, &[0x86], "the record of LASzip is not there"),
        (105, &[29, 0], "the length of a point is 29, expected at least 30"),
        (107, &[255; 4], "4 points, expected 4294967295 as in the header"),
        (247, &[255; 8], "4 points, expected 18446744073709551615"),
        (131, &[0; 8], "scale and offset is"),
        (155, &[255; 8], "scale and offset is"),
        (
            395,
            &[255; 2],
            "a record is longer than the bytes before the points",
        ),
    ] {
        let line = with(at, bytes);
        assert!(line.starts_with(expected), "{line}, expected {expected}");
    }
    let mut laz = own(true);
    laz[247..255].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(refused(&laz).starts_with("the number of points is 18446744073709551615, expected at most"));
}

/// A chunk that says to hold layers of 4 GB, in each of its sizes, and a chunk of many points.
#[test]
fn layers_of_any_size_are_checked_before_they_are_read() {
    for format in 6..=10 {
        let street = Foreign::street(format);
        let bytes = street.packed();
        let body = u32::from_le_bytes(bytes[96..100].try_into().expect("four")) as usize;
        let sizes = body + 8 + record_length(format).expect("a format");
        for size in 0..10 {
            let mut damaged = bytes.clone();
            damaged[sizes + 4 * size..sizes + 4 * size + 4].copy_from_slice(&[255; 4]);
            let line = refused(&damaged);
            assert!(
                line.starts_with("LAZ, point 0: a chunk of layers longer"),
                "{line}"
            );
        }
    }
}

#[test]
fn every_cut_is_refused() {
    let street = Foreign::street(6);
    for bytes in [
        own(false),
        own(true),
        street.packed(),
        Foreign::street(3).packed(),
    ] {
        let body = u32::from_le_bytes(bytes[96..100].try_into().expect("four")) as usize;
        for cut in (0..body + 9).chain((body + 9..bytes.len()).step_by(7)) {
            // The table of chunks at the end of LAZ is not needed.
            if let Err(error) = loaded(&bytes[..cut]) {
                assert!(!error.to_string().contains('\n'));
            } else {
                assert!(
                    cut > body + 40 && bytes[104] & 0x80 != 0,
                    "cut at {cut} of {}",
                    bytes.len()
                );
            }
        }
    }
}

/// Damaged points of every format are an error or other points, and never make the decompressor panic.
#[test]
fn damaged_laz_does_no_harm() {
    let mut draw = 7u64;
    let mut below = |n: usize| {
        draw = draw
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (draw >> 33) as usize % n
    };
    for format in 0..=10 {
        let bytes = Foreign::street(format).packed();
        let body = u32::from_le_bytes(bytes[96..100].try_into().expect("four")) as usize;
        for _ in 0..60 {
            let mut damaged = bytes.clone();
            for _ in 0..=below(5) {
                let at = body + below(bytes.len() - body);
                damaged[at] = below(256) as u8;
            }
            let header = LasHeader::read(&damaged).expect("the header is whole");
            if let Err(error) = points::each(&header, &damaged, |_| {}) {
                let line = error.to_string();
                assert!(
                    !line.contains("gave up") && !line.contains('\n'),
                    "format {format}: {line}"
                );
            }
        }
    }
}
