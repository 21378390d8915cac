//! Formats that can be read: one file here and one line of the table each. The window's dialog, files dropped on the window
//! and the command line all use this table.

pub mod boxes;
mod cloud;
pub mod commonroad;
mod commonroad_obstacles;
#[cfg(test)]
mod commonroad_tests;
pub mod glb;
mod importer;
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

use std::path::{Path, PathBuf};

use super::{FormatError, input};
pub use importer::{Content, Importer, Loaded, Source};
use importer::{GUESSED, first_entry_ends, labelled};

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
        FormatError::new(format!(
            "{}: a folder, expected a regular file or a folder of {known}",
            folder.display()
        ))
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
