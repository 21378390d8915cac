//! Tests of reading and writing frames.

use super::*;
use std::io::Write;
use zip::write::SimpleFileOptions;

/// An npz of arrays given as (name, dtype, shape, bytes).
fn npz(arrays: &[(&str, &str, &str, Vec<u8>)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, dtype, shape, bytes) in arrays {
        zip.start_file(format!("{name}.npy"), SimpleFileOptions::default())
            .expect("an entry");
        let header = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}");
        let padded = format!("{header:<117}\n");
        zip.write_all(b"\x93NUMPY\x01\x00").expect("a header");
        zip.write_all(&(padded.len() as u16).to_le_bytes())
            .expect("a header");
        zip.write_all(padded.as_bytes()).expect("a header");
        zip.write_all(bytes).expect("data");
    }
    zip.finish().expect("an archive").into_inner()
}

const SHAPE: &str = "(200, 200, 16)";

fn labels() -> Vec<u8> {
    let mut dense = vec![Class::FREE; Window::VOXELS];
    dense[(3 * 200 + 7) * 16 + 2] = 4;
    dense
}

#[test]
fn reads_labels_and_masks_of_any_integer_type() {
    let wide = |v: &[u8]| -> Vec<u8> { v.iter().flat_map(|l| i64::from(*l).to_le_bytes()).collect() };
    let mut mask = vec![0; Window::VOXELS];
    mask[5] = 1;
    let frame = read(&npz(&[
        ("mask_lidar", "|b1", SHAPE, mask.clone()),
        ("semantics", "|u1", SHAPE, labels()),
    ]))
    .expect("a frame");
    assert_eq!(frame.labels.get(3, 7, 2), 4);
    assert_eq!(frame.labels.count_set(), 1);
    assert_eq!(frame.camera_observed, None);
    let observed = frame.lidar_observed.expect("a mask");
    assert_eq!(observed.iter().position(|o| *o), Some(5));
    for name in ["occ", "arr_0", "whatever"] {
        let same = read(&npz(&[(name, "<i8", SHAPE, wide(&labels()))])).expect("a frame");
        assert_eq!(same.labels, frame.labels);
    }
}

#[test]
fn what_is_written_is_read() {
    let labels = VoxelGrid::from_dense(&labels()).expect("labels");
    let bytes = to_bytes(&labels);
    assert_eq!(bytes, to_bytes(&labels));
    assert_eq!(read(&bytes).expect("a frame").labels, labels);
    let masks = [3, 7].map(|n| Some((0..Window::VOXELS).map(|i| i % n == 0).collect()));
    let [lidar_observed, camera_observed] = masks;
    let frame = Occ3dFrame {
        labels: labels.clone(),
        lidar_observed,
        camera_observed,
    };
    assert_eq!(read(&frame_to_bytes(&frame)).expect("a frame"), frame);
}

#[test]
fn bad_files_give_one_line() {
    let message = |bytes: &[u8]| read(bytes).expect_err("refused").to_string();
    let mut wrong = labels();
    wrong[16] = 23;
    for (bytes, expected) in [
        (
            npz(&[("semantics", "|u1", "(10, 10, 16)", vec![0; 1600])]),
            "array semantics: shape [10, 10, 16], expected [200, 200, 16]",
        ),
        (
            npz(&[("semantics", "|u1", SHAPE, wrong)]),
            "array semantics: class 23 at voxel 0, 1, 0, expected 0 to 17",
        ),
        (
            npz(&[("semantics", "<f4", SHAPE, vec![0; 4 * Window::VOXELS])]),
            "array semantics: type '<f4', expected integers",
        ),
        (
            npz(&[("a", "|u1", SHAPE, labels()), ("b", "|u1", SHAPE, labels())]),
            "no labels: found [\"a\", \"b\"], expected one of semantics, occ, arr_0, voxel_label",
        ),
    ] {
        assert_eq!(message(&bytes), expected);
    }
    let whole = npz(&[("semantics", "|u1", SHAPE, labels())]);
    for cut in [0, 10, whole.len() / 2, whole.len() - 5] {
        let line = message(&whole[..cut]);
        assert!(!line.is_empty() && !line.contains('\n'), "{line}");
    }
    let short = npz(&[("semantics", "|u1", SHAPE, vec![0; 99])]);
    assert!(message(&short).starts_with("array semantics: "));
    let huge = npz(&[("semantics", "|u1", SHAPE, vec![0; LARGEST as usize + 500])]);
    assert!(message(&huge).contains("more than"));
    // Headers that numpy would not write: a nest, one that is too long, one that is no Python.
    for (shape, expected) in [
        (format!("{}200{}", "(".repeat(70), ")".repeat(70)), "brackets"),
        (" ".repeat(5000), "a header of"),
        ("((200,".to_owned(), "could not parse"),
    ] {
        let line = message(&npz(&[("semantics", "|u1", &shape, labels())]));
        assert!(line.contains(expected) && !line.contains('\n'), "{line}");
    }
}
