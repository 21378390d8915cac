//! Occ3D-nuScenes labels: `labels.npz` with `semantics`, `mask_lidar`, `mask_camera`, each
//! [200, 200, 16], index `[x][y][z]`, ego frame, 0.4 m, 17 = free; a mask is 0 where nothing was observed.
//! A scene is written with `semantics` alone. Also read: an archive with one array, `occ` (UniScene's output) or `arr_0` (submission files).

use std::io::{Cursor, Read};
use std::path::Path;

use npyz::{NpyFile, Order};
use thiserror::Error;
use zip::ZipArchive;

use super::input::{self, InputError};
use super::npz::{self, Values as Npy};
use scene::message::{one_line, quoted, shortened};
use scene::{Class, VoxelGrid, Window};

/// Names that the labels may have, in order of preference.
const NAMES: [&str; 3] = ["semantics", "occ", "arr_0"];
/// Largest archive that is read, bytes: the labels and two masks of eight bytes a voxel are 16 MB, other arrays may lie
/// beside them.
pub const LARGEST_FILE: u64 = 256 << 20;
/// Largest array that is unpacked: eight bytes a voxel and a header.
const LARGEST: u64 = 8 * Window::VOXELS as u64 + 65_536;
/// Longest header of an array, bytes, and most brackets in it: its parser calls itself for each, and a file of nothing
/// but brackets would end the program.
const LONGEST_HEADER: usize = 4096;
const MOST_BRACKETS: usize = 64;

/// A labelled frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Occ3dFrame {
    /// Class of every voxel.
    pub labels: VoxelGrid,
    /// Voxels that a LiDAR observed, `[x][y][z]`, if the file says.
    pub lidar_observed: Option<Vec<bool>>,
    /// Voxels that a camera observed, if the file says.
    pub camera_observed: Option<Vec<bool>>,
}

/// Why a file is no Occ3D frame.
#[derive(Debug, Error)]
pub enum Occ3dError {
    /// The file could not be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// No zip archive, or a damaged one.
    #[error("not an npz archive: {0}")]
    Archive(String),
    /// None of the known arrays.
    #[error("no labels: found {found:?}, expected one of semantics, occ, arr_0")]
    NoLabels {
        /// Arrays in the archive.
        found: Vec<String>,
    },
    /// An array that cannot be understood.
    #[error("array {name}: {problem}")]
    Array {
        /// Its name.
        name: String,
        /// What was found and what was expected.
        problem: String,
    },
}

/// Names of the arrays in an archive.
fn arrays(zip: &ZipArchive<Cursor<&[u8]>>) -> Vec<String> {
    let files = zip.file_names().filter_map(Result::ok);
    let names = files.filter_map(|f| npyz::npz::array_name_from_file_name(&f).map(str::to_string));
    names.collect()
}

/// Reads a frame from a file.
pub fn load(path: &Path) -> Result<Occ3dFrame, Occ3dError> {
    read(&input::read(path, LARGEST_FILE)?)
}

/// Reads a frame from the bytes of an npz file.
pub fn read(bytes: &[u8]) -> Result<Occ3dFrame, Occ3dError> {
    let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|e| Occ3dError::Archive(one_line(&e)))?;
    let found = arrays(&zip);
    let known = NAMES.into_iter().find(|name| found.iter().any(|f| f == name));
    let name = match (known, found.as_slice()) {
        (Some(name), _) => name.to_string(),
        (None, [only]) => only.clone(),
        // No more than a line holds.
        _ => {
            let found = found.iter().take(6).map(|name| quoted(name, 24)).collect();
            return Err(Occ3dError::NoLabels { found });
        }
    };
    let wrong = |i: usize, found: i64| Occ3dError::Array {
        name: quoted(&name, 80),
        problem: format!(
            "class {found} at voxel {}, {}, {}, expected 0 to {}",
            i / (Window::NY * Window::NZ),
            i / Window::NZ % Window::NY,
            i % Window::NZ,
            Class::FREE
        ),
    };
    let dense: Vec<u8> = match array(&mut zip, &name)? {
        Values::Bytes(labels) => match labels.iter().position(|l| *l > Class::FREE) {
            Some(i) => return Err(wrong(i, labels[i].into())),
            None => labels,
        },
        Values::Wide(labels) => {
            let known = |(i, label): (usize, &i64)| {
                let byte = u8::try_from(*label).ok().filter(|l| *l <= Class::FREE);
                byte.ok_or_else(|| wrong(i, *label))
            };
            labels.iter().enumerate().map(known).collect::<Result<_, _>>()?
        }
    };
    let mut mask = |name: &str| -> Result<Option<Vec<bool>>, Occ3dError> {
        if !found.iter().any(|f| f == name) {
            return Ok(None);
        }
        Ok(Some(match array(&mut zip, name)? {
            Values::Bytes(values) => values.into_iter().map(|v| v != 0).collect(),
            Values::Wide(values) => values.into_iter().map(|v| v != 0).collect(),
        }))
    };
    Ok(Occ3dFrame {
        lidar_observed: mask("mask_lidar")?,
        camera_observed: mask("mask_camera")?,
        labels: VoxelGrid::from_dense(&dense).expect("as many labels as voxels"),
    })
}

/// Labels as an npz file with the array `semantics`, compressed; equal labels give equal bytes.
pub fn to_bytes(labels: &VoxelGrid) -> Vec<u8> {
    arrays_to_bytes(labels, [None, None])
}

/// The same with the masks that the frame has.
pub fn frame_to_bytes(frame: &Occ3dFrame) -> Vec<u8> {
    let masks = [&frame.lidar_observed, &frame.camera_observed];
    arrays_to_bytes(&frame.labels, masks.map(Option::as_deref))
}

fn arrays_to_bytes(labels: &VoxelGrid, masks: [Option<&[bool]>; 2]) -> Vec<u8> {
    let array = |name, bytes| npz::Array {
        name,
        shape: &[Window::NX, Window::NY, Window::NZ],
        values: Npy::U8(bytes),
    };
    let mut all = vec![array("semantics", labels.to_dense())];
    for (name, mask) in ["mask_lidar", "mask_camera"].into_iter().zip(masks) {
        all.extend(mask.map(|mask| array(name, mask.iter().map(|seen| u8::from(*seen)).collect())));
    }
    npz::to_bytes(&all).expect("a mask has a flag per voxel, and memory takes what is written")
}

/// Values of an array: as they lie in the file if they are bytes, which is the usual case and much faster.
enum Values {
    Bytes(Vec<u8>),
    Wide(Vec<i64>),
}

/// One array of the grid's shape, whatever its integer type.
fn array(zip: &mut ZipArchive<Cursor<&[u8]>>, name: &str) -> Result<Values, Occ3dError> {
    // What a parser says may be a drawing of several lines, and holds what the file holds.
    let problem = |problem: String| Occ3dError::Array {
        name: quoted(name, 80),
        problem: shortened(&problem.split_whitespace().collect::<Vec<_>>().join(" "), 200),
    };
    let file = npyz::npz::file_name_from_array_name(name);
    let entry = zip.by_name(&file).map_err(|e| problem(e.to_string()))?;
    // The size that the archive declares may lie: no more than the limit is unpacked.
    let mut bytes = Vec::new();
    entry
        .take(LARGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| problem(e.to_string()))?;
    if bytes.len() as u64 > LARGEST {
        return Err(problem(format!("more than {LARGEST} bytes")));
    }
    let start = check_header(&bytes).map_err(problem)?;
    let npy = NpyFile::new(&bytes[..]).map_err(|e| problem(e.to_string()))?;
    let expected = [Window::NX as u64, Window::NY as u64, Window::NZ as u64];
    if npy.shape() != expected {
        return Err(problem(format!("shape {:?}, expected {expected:?}", npy.shape())));
    }
    if npy.order() != Order::C {
        return Err(problem("Fortran order, expected C order".into()));
    }
    let dtype = npy.dtype().descr();
    if matches!(dtype.as_str(), "'|u1'" | "'|b1'") {
        let values = bytes.get(start..start + Window::VOXELS).map(<[u8]>::to_vec);
        let wanted = Window::VOXELS;
        let found = bytes.len().saturating_sub(start);
        return values
            .map(Values::Bytes)
            .ok_or_else(|| problem(format!("{found} values, expected {wanted}")));
    }
    macro_rules! read_as {
        ($npy:expr, $($type:ty),+) => {{
            let npy = $npy;
            $(let npy = match npy.try_data::<$type>() {
                Ok(values) => {
                    let all: std::io::Result<Vec<i64>> = values.map(|v| v.map(i64::from)).collect();
                    return all.map(Values::Wide).map_err(|e| problem(e.to_string()));
                }
                Err(npy) => npy,
            };)+
            drop(npy);
        }};
    }
    read_as!(npy, i8, i64, i32, u16, i16, u32);
    Err(problem(format!("type {dtype}, expected integers")))
}

/// Where the values begin; errors on a header that numpy would not write: too long, or nested too deeply.
fn check_header(bytes: &[u8]) -> Result<usize, String> {
    // Magic (6), version (2), length (2 bytes in version 1, 4 later), text.
    let (length, start) = match bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (usize::from(u16::from_le_bytes([*a, *b])), 10),
        [_, _, _, _, _, _, _, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 12),
        _ => return Err(format!("{} bytes, expected an npy file", bytes.len())),
    };
    if length > LONGEST_HEADER {
        return Err(format!(
            "a header of {length} bytes, expected at most {LONGEST_HEADER}"
        ));
    }
    let text = bytes[start..].iter().take(length);
    let brackets = text.filter(|b| matches!(b, b'(' | b'[' | b'{')).count();
    match brackets > MOST_BRACKETS {
        true => Err(format!(
            "a header with {brackets} brackets, expected at most {MOST_BRACKETS}"
        )),
        false => Ok(start + length),
    }
}

#[cfg(test)]
mod tests {
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
                "no labels: found [\"a\", \"b\"], expected one of semantics, occ, arr_0",
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
}
