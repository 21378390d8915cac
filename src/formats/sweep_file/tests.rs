//! Tests of files of sweeps: the same bytes without edits; with edits, the bytes of all records that no edit touches.

use std::collections::BTreeMap;

use scene::{Class, Provenance, SweepEdits, SyntheticReturn};

use super::*;

const PCD: &str = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity t ring\nSIZE 4 4 4 1 4 2\n\
    TYPE F F F U U U\nCOUNT 1 1 1 1 1 1\nWIDTH 5\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 5\nDATA ";

/// Five records: x, y, z, strength, time, ring.
fn rows() -> Vec<([f32; 3], u8, u32, u16)> {
    (0..5u8)
        .map(|i| {
            let at = [5.0 + f32::from(i), 1.0 / 3.0, -1.7];
            (at, 40 + i, 1000 * u32::from(i), u16::from(i % 2))
        })
        .collect()
}

fn binary_rows() -> Vec<u8> {
    let row = |(at, strength, time, ring): ([f32; 3], u8, u32, u16)| {
        let place = at.iter().flat_map(|v| v.to_le_bytes());
        let rest = time.to_le_bytes().into_iter().chain(ring.to_le_bytes());
        place.chain([strength]).chain(rest).collect::<Vec<u8>>()
    };
    rows().into_iter().flat_map(row).collect()
}

/// Files of every form with the same five returns.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let text = |separator: &str| {
        let row = |(at, strength, time, ring): ([f32; 3], u8, u32, u16)| {
            format!(
                "{:.3} {:.6} {:.1} {strength} {time} {ring}{separator}",
                at[0], at[1], at[2]
            )
        };
        rows().into_iter().map(row).collect::<String>()
    };
    let by_field: Vec<u8> = {
        let rows = rows();
        let axis = |i: usize| {
            rows.iter()
                .flat_map(move |r| r.0[i].to_le_bytes())
                .collect::<Vec<u8>>()
        };
        let strengths = rows.iter().map(|r| r.1).collect();
        let times = rows.iter().flat_map(|r| r.2.to_le_bytes()).collect();
        let rings = rows.iter().flat_map(|r| r.3.to_le_bytes()).collect();
        [axis(0), axis(1), axis(2), strengths, times, rings].concat()
    };
    let scan = |columns: usize| {
        let row = |(at, strength, _, ring): ([f32; 3], u8, u32, u16)| {
            let all = [at[0], at[1], at[2], f32::from(strength), f32::from(ring)];
            all.into_iter()
                .take(columns)
                .flat_map(f32::to_le_bytes)
                .collect::<Vec<u8>>()
        };
        rows().into_iter().flat_map(row).collect::<Vec<u8>>()
    };
    let ply = |format: &str, body: Vec<u8>| {
        let head = format!(
            "ply\nformat {format} 1.0\ncomment of a sensor\nelement vertex 5\nproperty float x\nproperty float y\n\
             property float z\nproperty uchar intensity\nproperty uint t\nproperty ushort ring\nend_header\n"
        );
        [head.into_bytes(), body].concat()
    };
    let big: Vec<u8> = rows()
        .into_iter()
        .flat_map(|(at, strength, time, ring)| {
            let place = at.into_iter().flat_map(f32::to_be_bytes);
            let rest = time.to_be_bytes().into_iter().chain(ring.to_be_bytes());
            place.chain([strength]).chain(rest).collect::<Vec<u8>>()
        })
        .collect();
    let pcd = |form: &str, body: Vec<u8>| [format!("{PCD}{form}\n").into_bytes(), body].concat();
    vec![
        ("a.bin", scan(4)),
        ("a.pcd.bin", scan(5)),
        ("a.pcd", pcd("binary", binary_rows())),
        ("b.pcd", pcd("ascii", text("\n").into_bytes())),
        ("c.pcd", pcd("binary_compressed", packed(&by_field))),
        ("a.ply", ply("binary_little_endian", binary_rows())),
        ("b.ply", ply("binary_big_endian", big)),
        ("c.ply", ply("ascii", text("\r\n").into_bytes())),
    ]
}

fn new(x: f64, like: u32) -> SyntheticReturn {
    SyntheticReturn {
        at_m: DVec3::new(x, -2.25, 0.5),
        strength: 7.0,
        class: Class::Car,
        provenance: Provenance::Added,
        like,
        slot: None,
    }
}

#[test]
fn a_file_without_edits_is_the_same() {
    for (name, bytes) in files() {
        let file = SweepFile::open(format_of(name), &bytes).expect(name);
        let (same, origins) = file.edited(&SweepEdits::default(), &Pose::IDENTITY);
        assert!(same == bytes, "{name}");
        assert_eq!(origins, [Provenance::Recorded; 5], "{name}");
        let returns = file.returns(&Pose::IDENTITY);
        let third = returns[2].expect("a return");
        assert!(
            (third.at_m[0] - 7.0).abs() < 1e-6 && third.strength == 42.0,
            "{name}: {third:?}"
        );
        let has_rings = !name.ends_with("a.bin");
        assert_eq!(
            third.ring,
            if has_rings { 0 } else { RecordedReturn::NO_RING },
            "{name}"
        );
    }
}

#[test]
fn only_records_that_edits_touch_change() {
    let edits = SweepEdits {
        changed: BTreeMap::from([(1, None), (3, Some(new(20.5, 3)))]),
        added: vec![new(30.25, 4)],
    };
    for (name, bytes) in files() {
        let file = SweepFile::open(format_of(name), &bytes).expect(name);
        let (edited, origins) = file.edited(&edits, &Pose::IDENTITY);
        use Provenance::{Added, Recorded};
        assert_eq!(origins, [Recorded, Recorded, Added, Recorded, Added], "{name}");
        let again = SweepFile::open(format_of(name), &edited).expect(name);
        assert_eq!(again.records.count, 5, "{name}");
        let fields = again.records.fields.len();
        let record = |file: &SweepFile<'_>, i: usize| -> Vec<u64> {
            (0..fields).map(|f| file.records.value(i, f).to_bits()).collect()
        };
        for (now, was) in [(0, 0), (1, 2), (3, 4)] {
            assert_eq!(record(&again, now), record(&file, was), "{name}");
        }
        // New ones have their place and strength, and all else of the record that they are like.
        for (now, like, x) in [(2, 3, 20.5), (4, 4, 30.25)] {
            assert_eq!(again.place(now), DVec3::new(x, -2.25, 0.5), "{name}");
            assert_eq!(again.records.value(now, 3), 7.0, "{name}");
            let rest = 4..fields;
            rest.for_each(|f| assert_eq!(again.records.value(now, f), file.records.value(like, f), "{name}"));
        }
        if let RecordOrder::Rows(stride) = file.records.order {
            // Byte for byte, not only by value.
            let row = |records: &Records<'_>, i: usize| records.body[i * stride..][..stride].to_vec();
            assert!(row(&again.records, 1) == row(&file.records, 2), "{name}");
        }
    }
}

#[test]
fn a_record_goes_where_others_are_empty_too() {
    let numbers = [5.0f32, 1.0, -1.7, 0.5, 0.0, 0.0, 0.0, 0.0, 6.0, 1.0, -1.7, 0.25];
    let bytes: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
    let file = SweepFile::open(KITTI, &bytes).expect("a scan");
    assert!(file.returns(&Pose::IDENTITY)[1].is_none());
    let edits = SweepEdits {
        changed: BTreeMap::from([(0, None)]),
        added: Vec::new(),
    };
    let (edited, _) = file.edited(&edits, &Pose::IDENTITY);
    assert_eq!(edited.len(), bytes.len());
    assert!(edited[..16].iter().all(|b| *b == 0) && edited[16..] == bytes[16..]);
}

/// A new return takes the empty record where its ray belongs; without one it comes last, but in an organized cloud it takes one of
/// its row.
#[test]
fn new_returns_take_their_slots() {
    let empty = [0.0f32; 4];
    let full = |x: f32| [x, 1.0, -1.7, 0.5];
    let rows = [full(5.0), empty, full(6.0), full(7.0), empty, full(8.0)];
    let body: Vec<u8> = rows.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let edits = |slot| SweepEdits {
        changed: BTreeMap::new(),
        added: vec![SyntheticReturn { slot, ..new(20.5, 2) }],
    };
    let places = |file: &SweepFile<'_>, edits: &SweepEdits| {
        let (bytes, origins) = file.edited(edits, &Pose::IDENTITY);
        let added = origins.iter().position(|origin| *origin == Provenance::Added);
        (bytes.len(), origins.len(), added)
    };
    let scan = SweepFile::open(KITTI, &body).expect("a scan");
    assert_eq!(places(&scan, &edits(Some(4))), (body.len(), 6, Some(4)));
    assert_eq!(places(&scan, &edits(None)), (body.len() + 16, 7, Some(6)));
    // A slot that is taken, or is none, is not written over.
    assert_eq!(places(&scan, &edits(Some(3))), (body.len() + 16, 7, Some(6)));
    assert_eq!(places(&scan, &edits(Some(99))), (body.len() + 16, 7, Some(6)));
    let head = "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 2\n\
                VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 6\nDATA binary\n";
    let organized = [head.as_bytes(), &body].concat();
    let cloud = SweepFile::open(format_of("a.pcd"), &organized).expect("a cloud");
    assert_eq!(places(&cloud, &edits(None)), (organized.len(), 6, Some(1)));
}

#[test]
fn damaged_files_are_refused_in_one_line() {
    for (name, bytes) in files() {
        for cut in 0..bytes.len() {
            if let Err(error) = SweepFile::open(format_of(name), &bytes[..cut]) {
                assert!(!error.to_string().contains('\n'), "{name}");
            }
        }
    }
    let refused = |name: &str, bytes: &[u8]| SweepFile::open(format_of(name), bytes).map(drop).is_err();
    assert!(refused("a.bin", b"") && refused("a.bin", &[0; 17]) && refused("a.pcd", b"ply"));
}
