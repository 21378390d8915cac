//! Formats that can be read: one file here and one line of the table each. The window's dialog, files dropped on the window
//! and the command line all use this table.

pub mod boxes;
mod cloud;
pub mod commonroad;
mod commonroad_obstacles;
#[cfg(test)]
mod commonroad_tests;
pub mod glb;
pub mod kitti;
pub mod lanelet2;
#[cfg(test)]
mod lanelet2_tests;
pub mod las;
pub mod loom;
pub mod nuscenes;
pub mod nuscenes_lidar;
pub mod occ3d;
pub mod opendrive;
pub mod pcd;
pub mod picture;
pub mod ply;
mod scan;
pub mod semantic_kitti;
pub mod sparse_npy;
pub mod vox;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use scene::{Extent, Frame, Inferred, Scene, SensorRig, Unobserved, VoxelGrid, infer};

use super::opendrive::RoadNetwork;
use super::recipe::Recipe;
use super::{FormatError, Holds, input};

/// Every format that can be read. A file that no other format recognises is read as the last one.
const TABLE: &[&Importer] = &[
    &loom::IMPORTER,
    &occ3d::IMPORTER,
    &sparse_npy::IMPORTER,
    &semantic_kitti::IMPORTER,
    &vox::IMPORTER,
    &pcd::IMPORTER,
    &ply::IMPORTER,
    &las::IMPORTER,
    &nuscenes_lidar::IMPORTER,
    &kitti::IMPORTER,
    &boxes::IMPORTER,
    &picture::IMPORTER,
    &glb::IMPORTER,
    &nuscenes::IMPORTER,
    &lanelet2::IMPORTER,
    &commonroad::IMPORTER,
    &opendrive::IMPORTER,
];

/// Bytes from which a format is recognised.
const HEAD: u64 = 1024;

/// A format that is read.
pub struct Importer {
    /// Name in reports.
    pub id: &'static str,
    /// Name for a person, in the plural.
    pub title: &'static str,
    /// Extensions without the dot, in small letters.
    pub extensions: &'static [&'static str],
    /// What a file holds.
    pub holds: &'static [Holds],
    /// Largest file that is read, bytes.
    pub largest: u64,
    /// True for the first bytes of such a file.
    pub recognises: fn(head: &[u8]) -> bool,
    /// The file to begin with in a folder of several, where the format keeps its files in one.
    pub in_folder: Option<fn(&Path) -> Option<PathBuf>>,
    /// Reads the bytes of a file. Errors in one line, without the file's name.
    pub read: fn(&Source<'_>) -> Result<Content, FormatError>,
    /// A small file, for the tests of the table.
    #[cfg(test)]
    pub sample: fn() -> Vec<u8>,
}

/// A file to be read.
pub struct Source<'a> {
    /// Everything in it.
    pub bytes: &'a [u8],
    /// Name of the scene to be made.
    pub name: &'a str,
    /// Where the file is, for formats of several files; `None` for bytes alone.
    pub path: Option<&'a Path>,
}

impl Source<'_> {
    /// Everything in a file beside this one: `relative` is a path from this file's folder, with `/` between names. Errors if
    /// it has more than `limit` bytes, is not there or cannot be read.
    pub fn beside(&self, relative: &str, limit: u64) -> Result<Vec<u8>, FormatError> {
        let path = self.place(relative)?;
        input::read(&path, limit).map_err(FormatError::new)
    }

    /// Where a file beside this one would be. Errors for bytes alone, and for an absolute path.
    pub fn place(&self, relative: &str) -> Result<PathBuf, FormatError> {
        let folder = self.path.and_then(Path::parent);
        let folder = folder
            .ok_or_else(|| FormatError::new(format!("{relative}: read from memory, not from a folder")))?;
        match Path::new(relative).is_absolute() {
            true => Err(FormatError::new(format!(
                "{relative}: an absolute path, expected one beside the file"
            ))),
            false => Ok(folder.join(relative)),
        }
    }
}

/// What a file held.
#[derive(Debug)]
pub enum Content {
    /// A scene.
    Scene(Box<Loaded>),
    /// Roads: a scene lies somewhere on them, and the user says where.
    Roads(Box<RoadNetwork>),
    /// Words and parameters that a scene can be made of again.
    Recipe(Box<Recipe>),
}

/// A scene, and what was left out of it.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// What of it is a guess, for a person: `layout`, `boxes`, `background`.
    pub inferred: &'static [&'static str],
    /// What the file holds and the scene does not, counted by kind.
    pub skipped: BTreeMap<String, usize>,
}

/// Every format that is read.
pub fn all() -> &'static [&'static Importer] {
    TABLE
}

/// Every extension, for a dialog.
pub fn extensions() -> Vec<&'static str> {
    all().iter().flat_map(|i| i.extensions).copied().collect()
}

/// The formats in a sentence: `Sceneloom scenes (.loom), …`.
pub fn in_words() -> String {
    let one = |i: &&Importer| match i.extensions {
        [] => format!("{} (a folder)", i.title),
        extensions => format!("{} (.{})", i.title, extensions.join(", .")),
    };
    all().iter().map(one).collect::<Vec<_>>().join(", ")
}

/// The format of a file: by its first bytes, and by its extension where those say nothing. A file that nobody claims is
/// taken for a road network, whose reader says what is wrong with it.
pub fn format_of(path: &Path) -> Result<&'static Importer, FormatError> {
    let head = input::head(path, HEAD).map_err(FormatError::new)?;
    Ok(recognised(path, &head))
}

fn recognised(path: &Path, head: &[u8]) -> &'static Importer {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let named = |i: &&&Importer| extension.as_deref().is_some_and(|e| i.extensions.contains(&e));
    let mut by_content = all().iter().filter(|i| (i.recognises)(head));
    let by_both = by_content.clone().find(named);
    by_both
        .or_else(|| by_content.next())
        .or_else(|| all().iter().find(named))
        .unwrap_or(&TABLE[TABLE.len() - 1])
}

/// Reads a file of any format.
pub fn read(path: &Path) -> Result<(&'static Importer, Content), FormatError> {
    if path.is_dir() {
        let (importer, path) = of_folder(path)?;
        return Ok((importer, read_as(importer, &path)?));
    }
    let importer = format_of(path)?;
    Ok((importer, read_as(importer, path)?))
}

/// The format of a folder of files, and the file that is read first.
fn of_folder(folder: &Path) -> Result<(&'static Importer, PathBuf), FormatError> {
    let first = |i: &&'static Importer| Some((*i, (i.in_folder?)(folder)?));
    let known = || all().iter().filter(|i| i.in_folder.is_some()).map(|i| i.title);
    all().iter().find_map(first).ok_or_else(|| {
        let known = known().collect::<Vec<_>>().join(", ");
        let known = if known.is_empty() { "a file" } else { &known };
        FormatError::new(format!("{}: a folder, expected {known}", folder.display()))
    })
}

/// Reads a file of a format.
pub fn read_as(importer: &Importer, path: &Path) -> Result<Content, FormatError> {
    let bytes = input::read(path, importer.largest).map_err(FormatError::new)?;
    let source = Source {
        bytes: &bytes,
        name: &scene_name(path),
        path: Some(path),
    };
    (importer.read)(&source).map_err(|e| e.at(&path.display()))
}

/// What a scene from this file is called: as the file, or as its folder where data sets name the folder after the frame and
/// the file `labels`.
pub fn scene_name(path: &Path) -> String {
    let stem = path.file_stem().map(|s| s.to_string_lossy());
    let folder = path
        .parent()
        .and_then(Path::file_name)
        .map(|s| s.to_string_lossy());
    match (stem, folder) {
        (Some(stem), Some(folder)) if stem == "labels" => folder.into_owned(),
        (Some(stem), _) => stem.into_owned(),
        (None, _) => "import".to_owned(),
    }
}

/// A scene from labels: their voxels as they are; layout, boxes and background are inferred, of a larger map in the networks'
/// window.
fn labelled(name: &str, labels: VoxelGrid, unobserved: Option<Unobserved>) -> Scene {
    let window = labels.crop(Extent::WINDOW);
    let (layout, boxes) = (infer::layout(&window), infer::boxes(&window));
    let background = infer::background(&window, &layout);
    let layout = layout.crop(labels.extent());
    let inferred = Inferred {
        layout: true,
        boxes: boxes.keys().copied().collect(),
        background: !background.is_empty(),
        unobserved,
    };
    let frame = Frame {
        inferred,
        ..Frame::new(layout, boxes, labels)
    };
    let mut scene = Scene::single(name, frame, Arc::new(SensorRig::default()), 0);
    scene.background = Arc::new(background);
    scene
}

/// Everything that [`labelled`] guesses.
const GUESSED: [&str; 3] = ["layout", "boxes", "background"];

/// True for a zip archive whose first entry's name ends in this.
fn first_entry_ends(head: &[u8], ending: &str) -> bool {
    let local_header = head.starts_with(b"PK\x03\x04");
    let length = head
        .get(26..28)
        .map_or(0, |b| usize::from(u16::from_le_bytes([b[0], b[1]])));
    let name = head.get(30..30 + length).unwrap_or_default();
    local_header && name.ends_with(ending.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_goes_before_the_extension() {
        let of = |name: &str, head: &[u8]| recognised(Path::new(name), head).id;
        let [loom, npz] = [(loom::IMPORTER.sample)(), (occ3d::IMPORTER.sample)()];
        assert_eq!(of("a.npz", &loom), "loom");
        assert_eq!(of("a", &npz), "occ3d");
        assert_eq!(of("a.loom", &npz), "occ3d");
        // What does not tell goes by its name, and what has no name is a road.
        assert_eq!(of("a.loom", b"cut"), "loom");
        assert_eq!(of("a.NPZ", b"PK"), "occ3d");
        assert_eq!(of("a.PCD", b""), "pcd");
        assert_eq!(of("a.txt", b"<OpenDRIVE>"), "opendrive");
        assert_eq!(of("", b""), "opendrive");
    }

    #[test]
    fn scenes_are_named_after_their_file() {
        assert_eq!(scene_name(Path::new("gts/a1/labels.npz")), "a1");
        assert_eq!(scene_name(Path::new("gts/a1/b.npz")), "b");
        assert_eq!(scene_name(Path::new("labels.npz")), "labels");
        assert_eq!(scene_name(Path::new("..")), "import");
    }
}
