//! Importers: the description of a format that is read, and code that several readers share.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use scene::resample::voxels_in;
use scene::{
    Class, DataLabels, Extent, Frame, Inferred, LabelSet, Lattice, Scene, SensorRig, Unobserved, VoxelGrid,
    infer,
};

use super::imported_sweep::ImportedSweep;
use crate::opendrive::RoadNetwork;
use crate::recipe::Recipe;
use crate::voxels::DataMap;
use crate::{FormatError, Holds, input};

/// A format that is read.
pub struct Importer {
    /// Name in reports.
    pub id: &'static str,
    /// Name for a person, in the plural.
    pub title: &'static str,
    /// Extensions without the dot, in small letters.
    pub extensions: &'static [&'static str],
    /// Kinds of content in a file.
    pub holds: &'static [Holds],
    /// Largest file that is read, bytes.
    pub largest: u64,
    /// True for the first bytes of such a file.
    pub recognises: fn(head: &[u8]) -> bool,
    /// The file to begin with in a folder of several, where the format keeps its files in one.
    pub in_folder: Option<fn(&Path) -> Option<PathBuf>>,
    /// Reads the bytes of a file. Errors in one line, without the file's name.
    pub read: fn(&ImportFile<'_>) -> Result<Content, FormatError>,
    /// A small file, for the tests of the table.
    #[cfg(test)]
    pub sample: fn() -> Vec<u8>,
}

/// A file to be read.
pub struct ImportFile<'a> {
    /// Content of the file.
    pub bytes: &'a [u8],
    /// Name of the scene to be made.
    pub name: &'a str,
    /// Where the file is, for formats of several files; `None` for bytes alone.
    pub path: Option<&'a Path>,
    /// Wishes of the user.
    pub options: ImportOptions,
}

/// Wishes of a user as to how a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Height by which a point cloud is lifted, m; `None` to take it from the ground.
    pub lift_m: Option<f64>,
    /// True to take voxels of a data set to those of the networks, 0.4 m and 16 bins, in place of its own.
    pub resample: bool,
}

impl ImportFile<'_> {
    /// Reads a file beside this one: `relative` is a path from this file's folder, with `/` between names. Errors as
    /// [`ImportFile::place`] does, and if the file has more than `limit` bytes, is not there or cannot be read.
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

/// Content that was read from a file.
#[derive(Debug)]
pub enum Content {
    /// A scene.
    Scene(Box<ImportedScene>),
    /// Roads: a scene lies somewhere on them, and the user says where.
    Roads(Box<RoadNetwork>),
    /// Words and parameters that a scene can be made of again.
    Recipe(Box<Recipe>),
}

/// A scene, and what was left out of it.
#[derive(Debug)]
pub struct ImportedScene {
    /// The scene.
    pub scene: Scene,
    /// Guessed parts of the scene, for a person: `layout`, `boxes`, `background`.
    pub inferred: &'static [&'static str],
    /// Parts of the file that the scene does not have, counted by kind.
    pub skipped: BTreeMap<String, usize>,
    /// Notes on changes that were made without being asked for, a line each, for a person.
    pub notes: Vec<String>,
    /// The sweep that it is of; see [`ImportedScene::with_tracked`] and [`ImportedScene::with_recording`].
    pub sweep: Option<ImportedSweep>,
}

/// Name of a scene from this file: that of the file, or of its folder where data sets name the folder after the frame
/// and the file `labels`. `import` for a path without a name.
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

/// A scene from labels: the voxels are kept, layout, boxes and background are inferred. Things beside the road, and all on a
/// larger map of Occ3D's voxels, are inferred in the networks' window only.
pub(crate) fn labelled(name: &str, labels: VoxelGrid, unobserved: Option<Unobserved>) -> Scene {
    // Things are looked for in the voxels that their rules are made for.
    let known = voxels_in(&labels, labels.extent().in_lattice(Lattice::OCC3D));
    let window = known.crop(Extent::WINDOW);
    let layout = infer::layout(&window);
    let background = infer::background(&window, &layout);
    let (layout, boxes) = match labels.extent().lattice() == Lattice::OCC3D {
        true => (layout.crop(labels.extent()), infer::boxes(&window)),
        false => (infer::layout(&labels), infer::boxes(&labels)),
    };
    let inferred = Inferred {
        layout: true,
        boxes: boxes.keys().copied().collect(),
        background: !background.is_empty(),
        unobserved,
        ..Inferred::default()
    };
    let frame = Frame {
        inferred,
        ..Frame::new(layout, boxes, labels)
    };
    let mut scene = Scene::single(name, frame, Arc::new(SensorRig::default()), 0);
    scene.background = Arc::new(background);
    scene
}

/// A scene of cells and their labels on a data set's own map, whose origin is below the LiDAR: the vehicle and its sensors are
/// moved so that the LiDAR is there; see [`labelled`]. Labels that say more than a class stay beside it.
pub(crate) fn on_data_map(
    name: &str,
    map: &DataMap,
    cells: &[([usize; 3], u16)],
    set: &'static LabelSet,
) -> Scene {
    let mut grid = VoxelGrid::over(map.extent());
    for (cell, label) in cells {
        let [x, y, z] = map.voxel(*cell);
        grid.set(x, y, z, set.shown(*label).id());
    }
    let labels = cells.iter().map(|(cell, label)| (map.voxel(*cell), *label));
    let data_labels = DataLabels::new(set, map.extent(), set.label(Class::Free), labels);
    let mut scene = labelled(name, grid, None);
    scene.change_canvas(|frame| frame.inferred.data_labels = Some(data_labels));
    let rig = Arc::make_mut(&mut scene.rig);
    let [x_m, y_m, _] = rig.lidars.first().map_or([0.0; 3], |lidar| lidar.translation_m);
    let cameras = rig.cameras.iter_mut().map(|camera| &mut camera.translation_m);
    let lidars = rig.lidars.iter_mut().map(|lidar| &mut lidar.translation_m);
    let radars = rig.radars.iter_mut().map(|radar| &mut radar.translation_m);
    for at in cameras.chain(lidars).chain(radars).chain([&mut rig.ego_center_m]) {
        at[0] -= x_m;
        at[1] -= y_m;
    }
    scene
}

/// Puts the first LiDAR of a scene's rig at a place in the ego frame, m.
pub(crate) fn of_sensor(scene: &mut Scene, at_m: DVec3) {
    if let Some(lidar) = Arc::make_mut(&mut scene.rig).lidars.first_mut() {
        lidar.translation_m = at_m.to_array();
    }
}

/// The parts of a scene that [`labelled`] guesses.
pub(crate) const GUESSED: [&str; 3] = ["layout", "boxes", "background"];

/// True for a zip archive whose first entry's name ends in this.
pub(crate) fn first_entry_ends(head: &[u8], ending: &str) -> bool {
    let local_header = head.starts_with(b"PK\x03\x04");
    let length = head
        .get(26..28)
        .map_or(0, |b| usize::from(u16::from_le_bytes([b[0], b[1]])));
    let name = head.get(30..30 + length).unwrap_or_default();
    local_header && name.ends_with(ending.as_bytes())
}
