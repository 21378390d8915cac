//! Occ3D-nuScenes labels: `labels.npz` with `semantics`, `mask_lidar`, `mask_camera`, each
//! [200, 200, 16], index `[x][y][z]`, ego frame, 0.4 m, 17 = free; a mask is 0 where nothing was observed. Ours have `recipe` too:
//! the bytes of a JSON text, see [`Recipe`].
//! Also read: an archive with one array, `occ` (UniScene's output) or `arr_0` (submission files); OpenDriveLab's openocc labels
//! and Occ3D-Waymo labels of 0.4 m, which have the same shape and other numbers ([`scene::label_sets`]).

use std::io::{Cursor, Read};
use std::path::Path;

use npyz::{NpyFile, Order};
use thiserror::Error;
use zip::ZipArchive;

use super::input::{self, InputError};
use super::npy;
use super::npz::{self, NpzValues as Npy};
use super::recipe::{self, Recipe};
use scene::label_sets::{OCC3D_WAYMO, OPEN_OCC};
use scene::message::{one_line, quoted, shortened};
use scene::{Class, DataLabels, Extent, LabelSet, VoxelGrid, Window};

/// Names that the labels may have, in order of preference.
const NAMES: [&str; 4] = ["semantics", "occ", "arr_0", WAYMO_LABELS];
/// Masks of the LiDAR and of the cameras.
const MASKS: [&str; 2] = ["mask_lidar", "mask_camera"];
/// Labels and masks in Occ3D-Waymo.
const WAYMO_LABELS: &str = "voxel_label";
const WAYMO_MASKS: [&str; 2] = ["origin_voxel_state", "final_voxel_state"];
/// Largest archive that is read, bytes: the labels and two masks of eight bytes a voxel are 16 MB, other arrays may lie
/// beside them.
pub const LARGEST_FILE: u64 = 256 << 20;
/// Largest array that is unpacked: eight bytes a voxel and a header.
const LARGEST: u64 = 8 * Window::VOXELS as u64 + 65_536;
/// Largest recipe that is read, bytes.
const LARGEST_RECIPE: u64 = 1 << 20;

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
    #[error("no labels: found {found:?}, expected one of semantics, occ, arr_0, voxel_label")]
    NoLabels {
        /// Arrays in the archive.
        found: Vec<String>,
    },
    /// An array that cannot be understood.
    #[error("array {name}: {problem}")]
    Array {
        /// Its name.
        name: String,
        /// The problem: what was found and what was expected.
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

/// A frame as a file holds it.
#[derive(Clone, Debug)]
pub struct Occ3dFile {
    /// The frame, its classes numbered as [`Class`].
    pub frame: Occ3dFrame,
    /// Label set of the file, if it is another than [`Class`].
    pub set: Option<&'static LabelSet>,
    /// Labels of the file that say more than the class.
    pub data_labels: Option<DataLabels>,
    /// How the file came to be, if it says: a [`crate::recipe::Recipe`].
    pub recipe: Option<serde_json::Value>,
    /// Arrays of the file that are not read.
    pub left_out: Vec<String>,
}

/// Reads a frame from the bytes of an npz file.
pub fn read(bytes: &[u8]) -> Result<Occ3dFrame, Occ3dError> {
    read_found(bytes).map(|found| found.frame)
}

/// Reads a frame as [`read`] does, and says what had to be assumed and what was left out.
pub fn read_found(bytes: &[u8]) -> Result<Occ3dFile, Occ3dError> {
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
    let values = bytes_of(&name, array(&mut zip, &name)?)?;
    let set = label_set(&name, &values);
    let data_labels = (set == Some(&OCC3D_WAYMO)).then(|| waymo_labels(&values));
    let labels = classes(&name, values, set)?;
    let masks = match set == Some(&OCC3D_WAYMO) {
        true => WAYMO_MASKS,
        false => MASKS,
    };
    let mut mask = |name: &str| -> Result<Option<Vec<bool>>, Occ3dError> {
        if !found.iter().any(|f| f == name) {
            return Ok(None);
        }
        Ok(Some(match array(&mut zip, name)? {
            LabelValues::Bytes(values) => values.into_iter().map(|v| v != 0).collect(),
            LabelValues::Wide(values) => values.into_iter().map(|v| v != 0).collect(),
        }))
    };
    let frame = Occ3dFrame {
        lidar_observed: mask(masks[0])?,
        camera_observed: mask(masks[1])?,
        labels: VoxelGrid::from_dense(&labels).expect("as many labels as voxels"),
    };
    let recipe = recipe(&mut zip);
    let is_recipe = |other: &String| recipe.is_some() && *other == recipe::NAME;
    let is_read = |other: &String| *other == name || masks.contains(&other.as_str()) || is_recipe(other);
    Ok(Occ3dFile {
        frame,
        set,
        data_labels,
        left_out: found.iter().filter(|other| !is_read(other)).cloned().collect(),
        recipe,
    })
}

/// The array of bytes that holds a recipe as JSON.
fn recipe(zip: &mut ZipArchive<Cursor<&[u8]>>) -> Option<serde_json::Value> {
    let file = zip
        .by_name(&npyz::npz::file_name_from_array_name(recipe::NAME))
        .ok()?;
    if file.size() > LARGEST_RECIPE {
        return None;
    }
    let text = NpyFile::new(file.take(LARGEST_RECIPE)).ok()?;
    if text.len() > LARGEST_RECIPE {
        return None;
    }
    serde_json::from_slice(&text.into_vec::<u8>().ok()?).ok()
}

/// Labels as bytes. Errors on one that is no byte.
fn bytes_of(name: &str, values: LabelValues) -> Result<Vec<u8>, Occ3dError> {
    match values {
        LabelValues::Bytes(labels) => Ok(labels),
        LabelValues::Wide(labels) => {
            let byte = |(i, label): (usize, &i64)| {
                u8::try_from(*label).map_err(|_| wrong_label(name, i, *label, "0 to 17"))
            };
            labels.iter().enumerate().map(byte).collect()
        }
    }
}

fn wrong_label(name: &str, i: usize, found: i64, expected: &str) -> Occ3dError {
    let [x, y, z] = place(i);
    Occ3dError::Array {
        name: quoted(name, 80),
        problem: format!("class {found} at voxel {x}, {y}, {z}, expected {expected}"),
    }
}

/// The voxel with a number in arrays `[x][y][z]`.
fn place(i: usize) -> [usize; 3] {
    [
        i / (Window::NY * Window::NZ),
        i / Window::NZ % Window::NY,
        i % Window::NZ,
    ]
}

/// The label set of an array: that of its name, or the one that its most frequent label tells. Free is by far the most frequent
/// label, so an array without 17 in which more than half of the voxels are 16 is openocc's. `None` for the labels of Occ3D.
fn label_set(name: &str, labels: &[u8]) -> Option<&'static LabelSet> {
    if name == WAYMO_LABELS {
        return Some(&OCC3D_WAYMO);
    }
    let count = |of: u8| labels.iter().filter(|label| **label == of).count();
    let is_openocc = !labels.contains(&Class::FREE) && 2 * count(Class::FREE - 1) > labels.len();
    is_openocc.then_some(&OPEN_OCC)
}

/// The classes of labels. Errors on a label that the set does not have.
fn classes(name: &str, mut labels: Vec<u8>, set: Option<&LabelSet>) -> Result<Vec<u8>, Occ3dError> {
    let class_of = |label: usize| match set {
        Some(set) => set.class(label as u16).map(Class::id),
        None => Class::from_id(label as u8).map(Class::id),
    };
    let class: [Option<u8>; 256] = std::array::from_fn(class_of);
    let found = labels.iter().position(|l| class[usize::from(*l)].is_none());
    if let Some(at) = found {
        let expected = set.map_or_else(|| "0 to 17".to_owned(), LabelSet::numbers);
        return Err(wrong_label(name, at, labels[at].into(), &expected));
    }
    if set.is_some() {
        for label in &mut labels {
            *label = class[usize::from(*label)].unwrap_or(Class::FREE);
        }
    }
    Ok(labels)
}

/// Labels of Occ3D-Waymo on the window. Free is 15 or 23, whichever is more frequent.
fn waymo_labels(labels: &[u8]) -> DataLabels {
    let count = |of: u8| labels.iter().filter(|label| **label == of).count();
    let free = if count(15) > count(23) { 15 } else { 23 };
    let voxels = labels.iter().enumerate();
    let set = voxels.filter(|(_, label)| u16::from(**label) != free);
    let set = set.map(|(i, label)| (place(i), u16::from(*label)));
    DataLabels::new(&OCC3D_WAYMO, Extent::WINDOW, free, set)
}

/// Labels as an npz file with the array `semantics`, compressed; equal labels give equal bytes.
pub fn to_bytes(labels: &VoxelGrid) -> Vec<u8> {
    arrays_to_bytes(labels, [None, None], None)
}

/// A frame as an npz file: labels as [`to_bytes`] writes them, and the masks that the frame has.
pub fn frame_to_bytes(frame: &Occ3dFrame) -> Vec<u8> {
    let masks = [&frame.lidar_observed, &frame.camera_observed];
    arrays_to_bytes(&frame.labels, masks.map(Option::as_deref), None)
}

/// A frame as [`frame_to_bytes`] writes it, and how it came to be: an array `recipe` of the bytes of a JSON text.
pub fn frame_with_recipe_to_bytes(frame: &Occ3dFrame, recipe: &Recipe) -> Vec<u8> {
    let masks = [&frame.lidar_observed, &frame.camera_observed];
    arrays_to_bytes(&frame.labels, masks.map(Option::as_deref), Some(recipe))
}

/// A frame as Occ3D-Waymo keeps it, its labels in that set: those of the file that it came from where no edit changed the class.
pub fn waymo_to_bytes(frame: &Occ3dFrame, data_labels: Option<&DataLabels>) -> Vec<u8> {
    let usual = DataLabels::new(&OCC3D_WAYMO, Extent::WINDOW, 23, []);
    let of_file = data_labels
        .filter(|l| l.set() == &OCC3D_WAYMO)
        .map(|l| l.crop(Extent::WINDOW));
    let labels = of_file.unwrap_or(usual).dense(&frame.labels);
    // (a number above 255, which no file has, would be shown as others)
    let others = OCC3D_WAYMO.label(Class::Others) as u8;
    let labels = labels
        .iter()
        .map(|label| u8::try_from(*label).unwrap_or(others))
        .collect();
    let masks = [&frame.lidar_observed, &frame.camera_observed].map(Option::as_deref);
    npz_of(labels, WAYMO_LABELS, WAYMO_MASKS.into_iter().zip(masks), None)
}

fn arrays_to_bytes(labels: &VoxelGrid, masks: [Option<&[bool]>; 2], recipe: Option<&Recipe>) -> Vec<u8> {
    npz_of(
        labels.to_dense(),
        "semantics",
        MASKS.into_iter().zip(masks),
        recipe,
    )
}

fn npz_of<'a>(
    labels: Vec<u8>,
    name: &'a str,
    masks: impl IntoIterator<Item = (&'a str, Option<&'a [bool]>)>,
    recipe: Option<&Recipe>,
) -> Vec<u8> {
    let array = |name, bytes| npz::Array {
        name,
        shape: &[Window::NX, Window::NY, Window::NZ],
        values: Npy::U8(bytes),
    };
    let mut all = vec![array(name, labels)];
    for (name, mask) in masks {
        all.extend(mask.map(|mask| array(name, mask.iter().map(|seen| u8::from(*seen)).collect())));
    }
    let text = recipe.map(|r| r.to_json().into_bytes()).unwrap_or_default();
    let shape = [text.len()];
    if recipe.is_some() {
        all.push(npz::Array {
            name: recipe::NAME,
            shape: &shape,
            values: Npy::U8(text),
        });
    }
    npz::to_bytes(&all).expect("a mask has a flag per voxel, and memory takes what is written")
}

/// Values of an array: as they lie in the file if they are bytes, which is the usual case and much faster.
enum LabelValues {
    Bytes(Vec<u8>),
    Wide(Vec<i64>),
}

/// One array of the grid's shape, whatever its integer type.
fn array(zip: &mut ZipArchive<Cursor<&[u8]>>, name: &str) -> Result<LabelValues, Occ3dError> {
    // A parser's message may be a drawing of several lines, and may hold content of the file.
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
    let start = npy::values_at(&bytes).map_err(problem)?;
    let npy = NpyFile::new(&bytes[..]).map_err(|e| problem(e.to_string()))?;
    let expected = [Window::NX as u64, Window::NY as u64, Window::NZ as u64];
    if npy.shape() != expected {
        let hint = match npy.shape() {
            [1600, 1600, 64] => ": Occ3D-Waymo at 0.1 m; its files of 0.4 m end in _04.npz",
            _ => "",
        };
        return Err(problem(format!(
            "shape {:?}, expected {expected:?}{hint}",
            npy.shape()
        )));
    }
    if bytes.len() as u64 > LARGEST {
        return Err(problem(format!("more than {LARGEST} bytes")));
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
            .map(LabelValues::Bytes)
            .ok_or_else(|| problem(format!("{found} values, expected {wanted}")));
    }
    macro_rules! read_as {
        ($npy:expr, $($type:ty),+) => {{
            let npy = $npy;
            $(let npy = match npy.try_data::<$type>() {
                Ok(values) => {
                    let all: std::io::Result<Vec<i64>> = values.map(|v| v.map(i64::from)).collect();
                    return all.map(LabelValues::Wide).map_err(|e| problem(e.to_string()));
                }
                Err(npy) => npy,
            };)+
            drop(npy);
        }};
    }
    read_as!(npy, i8, i64, i32, u16, i16, u32);
    Err(problem(format!("type {dtype}, expected integers")))
}

#[cfg(test)]
mod tests;
