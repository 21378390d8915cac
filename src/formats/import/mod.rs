//! Formats that can be read: one file here and one line of the table each. The window's dialog, files dropped on the window
//! and the command line all use this table.

pub mod boxes;
mod cloud;
pub mod commonroad;
mod commonroad_obstacles;
#[cfg(test)]
mod commonroad_tests;
mod drive;
#[cfg(test)]
mod far_tests;
mod foreign;
pub mod glb;
mod imported_drive;
mod imported_sweep;
mod importer;
pub mod kitti;
pub mod lanelet2;
#[cfg(test)]
mod lanelet2_tests;
pub mod las;
pub mod loom;
mod nuplan_occ;
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
use std::sync::Arc;

use scene::message::quoted;

use super::{FormatError, input, sweep_file};
pub use imported_drive::{MomentGround, SweepMoment, TrackedObject};
pub use imported_sweep::ImportedSweep;
pub use importer::{Content, ImportFile, ImportOptions, ImportedScene, Importer, scene_name};
use importer::{GUESSED, first_entry_ends, labelled, on_data_map};

/// Every format that can be read.
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

/// The format of a file: by its first bytes, or by its extension where they are not telling. Errors name the kind of a
/// file that is not read.
pub fn format_of(path: &Path) -> Result<&'static Importer, FormatError> {
    let head = input::head(path, HEAD).map_err(FormatError::new)?;
    recognised(path, &head).map_err(|e| e.at(&path.display()))
}

fn recognised(path: &Path, head: &[u8]) -> Result<&'static Importer, FormatError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let named = |i: &&&Importer| extension.as_deref().is_some_and(|e| i.extensions.contains(&e));
    let mut by_content = all().iter().filter(|i| (i.recognises)(head));
    let by_both = by_content.clone().find(named);
    if let Some(claims) = by_both.or_else(|| by_content.next()) {
        return Ok(claims);
    }
    if let Some(told) = foreign::told(path, head) {
        return Err(told);
    }
    // A file without a name of its own that is text is taken for a road network, whose reader says where it is wrong.
    let is_markup = String::from_utf8_lossy(head).trim_start().starts_with('<');
    let named = all().iter().find(named).copied();
    named
        .or_else(|| is_markup.then_some(&opendrive::IMPORTER))
        .ok_or_else(|| {
            let found = match head.is_empty() {
                true => "an empty file",
                false => "a file of a kind that is not known",
            };
            let extensions: Vec<&str> = extensions();
            FormatError::new(format!("{found}, expected one of .{}", extensions.join(", .")))
        })
}

/// Reads a file of any format.
pub fn read(path: &Path) -> Result<(&'static Importer, Content), FormatError> {
    read_with(path, ImportOptions::default())
}

/// Farthest that a cloud is lifted, m.
pub const FARTHEST_LIFT_M: f64 = 10_000.0;

/// Reads a file as [`read`] does, with wishes. Errors also if a lift is given for a file that is no point cloud, for more than
/// [`FARTHEST_LIFT_M`], and if voxels are to be resampled in a file that has none of a data set.
pub fn read_with(path: &Path, options: ImportOptions) -> Result<(&'static Importer, Content), FormatError> {
    let (importer, path) = match path.is_dir() {
        true => of_folder(path)?,
        false => (format_of(path)?, path.to_owned()),
    };
    if let Some(m) = options.lift_m {
        if !(-FARTHEST_LIFT_M..=FARTHEST_LIFT_M).contains(&m) {
            let line = format!("a lift of {m} m, expected at most {FARTHEST_LIFT_M} m up or down");
            return Err(FormatError::new(line));
        }
        if !CLOUDS.contains(&importer.id) {
            let line = format!("{}, expected a point cloud where a lift is given", importer.title);
            return Err(FormatError::new(line).at(&path.display()));
        }
    }
    if options.resample && !OWN_LATTICE.contains(&importer.id) {
        let line = format!(
            "{}, expected voxels of Occ3D, OpenOccupancy, SurroundOcc, UniScene, SemanticKITTI or Nuplan-Occ where they are to \
             be resampled",
            importer.title
        );
        return Err(FormatError::new(line).at(&path.display()));
    }
    Ok((importer, read_file(importer, &path, options)?))
}

/// Formats of voxels in the lattice of a data set.
const OWN_LATTICE: [&str; 3] = [
    occ3d::IMPORTER.id,
    sparse_npy::IMPORTER.id,
    semantic_kitti::IMPORTER.id,
];

/// Formats of point clouds.
const CLOUDS: [&str; 6] = [
    drive::IMPORTER.id,
    pcd::IMPORTER.id,
    ply::IMPORTER.id,
    las::IMPORTER.id,
    nuscenes_lidar::IMPORTER.id,
    kitti::IMPORTER.id,
];

/// The format of a folder of files, and the file that is read first.
fn of_folder(folder: &Path) -> Result<(&'static Importer, PathBuf), FormatError> {
    let first = |i: &&'static Importer| Some((*i, (i.in_folder?)(folder)?));
    let of_folders = all().iter().filter(|i| i.in_folder.is_some()).map(|i| i.title);
    let known = || of_folders.clone().chain([drive::IMPORTER.title]);
    let sequence = || {
        drive::is_sequence(folder)
            .then(|| first(&&drive::IMPORTER))
            .flatten()
    };
    let known_first = sequence().or_else(|| all().iter().find_map(first));
    let drive = || {
        drive::is_drive(folder)
            .then(|| first(&&drive::IMPORTER))
            .flatten()
    };
    known_first.or_else(drive).ok_or_else(|| {
        let known = known().collect::<Vec<_>>().join(", ");
        let holds = match first_readable(folder) {
            Some(name) => format!(
                "; it holds files that are read one by one, such as {}",
                quoted(&name, 60)
            ),
            None => String::new(),
        };
        FormatError::new(format!(
            "{}: a folder, expected a regular file or a folder of {known}{holds}",
            folder.display()
        ))
    })
}

/// The name of the first file in a folder that could be read by itself.
fn first_readable(folder: &Path) -> Option<String> {
    const MOST: usize = 10_000;
    let extensions = extensions();
    let files = std::fs::read_dir(folder).ok()?.take(MOST).filter_map(|file| {
        let path = file.ok()?.path();
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        let is_readable = extensions.contains(&extension.as_str()) && path.is_file();
        is_readable.then(|| path.file_name().map(|n| n.to_string_lossy().into_owned()))?
    });
    files.min()
}

/// Reads a file of a format.
pub fn read_as(importer: &Importer, path: &Path) -> Result<Content, FormatError> {
    read_file(importer, path, ImportOptions::default())
}

/// Reads a file of a format, voxels of a data set in those of the networks.
#[cfg(test)]
pub(crate) fn read_resampled(importer: &Importer, path: &Path) -> Result<Content, FormatError> {
    let options = ImportOptions {
        resample: true,
        ..ImportOptions::default()
    };
    read_file(importer, path, options)
}

fn read_file(importer: &Importer, path: &Path, options: ImportOptions) -> Result<Content, FormatError> {
    let bytes = input::read(path, importer.largest).map_err(FormatError::new)?;
    let source = ImportFile {
        bytes: &bytes,
        name: &scene_name(path),
        path: Some(path),
        options,
    };
    // A drive is its folder, and names its files itself.
    let named = match importer.id == drive::IMPORTER.id {
        true => path.parent().unwrap_or(path),
        false => path,
    };
    let mut content = (importer.read)(&source).map_err(|e| e.at(&named.display()))?;
    if let Content::Scene(loaded) = &mut content
        && let Some(sweep) = &mut loaded.sweep
        && ![las::IMPORTER.id, drive::IMPORTER.id, nuscenes::IMPORTER.id].contains(&importer.id)
    {
        let name = scan::file_name(Some(path));
        let format = match importer.id {
            sweep_file::KITTI if name.ends_with(".pcd.bin") => sweep_file::NUSCENES,
            id => id,
        };
        sweep.keep(name, format, Arc::new(bytes));
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_goes_before_the_extension() {
        let of = |name: &str, head: &[u8]| recognised(Path::new(name), head).expect(name).id;
        let [loom, npz] = [(loom::IMPORTER.sample)(), (occ3d::IMPORTER.sample)()];
        assert_eq!(of("a.npz", &loom), "loom");
        assert_eq!(of("a", &npz), "occ3d");
        assert_eq!(of("a.loom", &npz), "occ3d");
        // What does not tell goes by its name.
        assert_eq!(of("a.loom", b"cut"), "loom");
        assert_eq!(of("a.NPZ", b"PK"), "occ3d");
        assert_eq!(of("a.PCD", b""), "pcd");
        assert_eq!(of("a.txt", b"<OpenDRIVE>"), "opendrive");
        assert_eq!(of("a.xodr", b"no XML"), "opendrive");
        assert_eq!(of("a", b"<"), "opendrive");
        // What is nobody's is told by what it is, whatever its name says.
        let line = |name: &str, head: &[u8]| {
            recognised(Path::new(name), head)
                .map(|i| i.id)
                .expect_err(name)
                .to_string()
        };
        assert!(line("a.xodr", b"PK\x03\x04").starts_with("a zip archive, which is not read"));
        assert!(line("a.json", b"{\"type\": \"FeatureCollection\"}").starts_with("GeoJSON"));
        assert!(line("", b"").starts_with("an empty file, expected one of .loom, "));
        assert!(
            line("a.dat", b"words")
                .starts_with("a file of a kind that is not known, expected one of .loom, ")
        );
    }

    #[test]
    fn scenes_are_named_after_their_file() {
        assert_eq!(scene_name(Path::new("gts/a1/labels.npz")), "a1");
        assert_eq!(scene_name(Path::new("gts/a1/b.npz")), "b");
        assert_eq!(scene_name(Path::new("labels.npz")), "labels");
        assert_eq!(scene_name(Path::new("..")), "import");
    }
}
