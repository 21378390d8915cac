//! Voxels of SemanticKITTI: the labels, and beside them the voxels that no scan saw.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use scene::label_sets::SEMANTIC_KITTI;
use scene::{Extent, Scene, SensorRig, Unobserved, VoxelGrid};

use super::{Content, GUESSED, ImportFile, ImportedScene, Importer, labelled, on_data_map};
use crate::semantic_kitti::{BIT_BYTES, CELLS, LATTICE, bit, ego_from_cells, own_map};
use crate::voxels::{DataMap, Physical, VoxelVotes, unobserved};
use crate::{FormatError, Holds};

/// See `semantic_kitti`.
pub const IMPORTER: Importer = Importer {
    id: "semantic-kitti",
    title: "voxels of SemanticKITTI",
    extensions: &["label"],
    holds: &[Holds::Occupancy],
    largest: 2 * CELLS as u64,
    recognises: |_| false, // the files begin with nothing but labels
    in_folder: Some(first_label),
    read: |source| read(source).map_err(FormatError::new),
    #[cfg(test)]
    sample: tests::sample,
};

fn read(source: &ImportFile<'_>) -> Result<Content, String> {
    let rig = SensorRig::default();
    let lidar = rig.lidars.first().ok_or("the usual rig has no LiDAR")?;
    let map = (!source.options.resample).then(|| own_map(lidar)).transpose()?;
    let mut skipped = BTreeMap::new();
    let cells = cells(source.bytes, &mut skipped)?;
    let invalid = beside(source, "invalid")?;
    for extension in ["bin", "occluded"] {
        if beside(source, extension)?.is_some() {
            skipped.insert(format!("file .{extension}, of one scan"), 1);
        }
    }
    let scene = match map {
        Some(map) => as_it_is(source.name, &cells, &map, invalid.as_deref()),
        None => {
            let labels = on_window(&cells, &mut skipped)?;
            let unobserved = invalid.and_then(|bits| mask(labels.extent(), &bits));
            labelled(source.name, labels, unobserved)
        }
    };
    skipped.insert(PLACED.to_owned(), scene.frame().occupancy.count_set());
    Ok(Content::Scene(Box::new(ImportedScene {
        sweep: None,
        scene,
        inferred: &GUESSED,
        skipped,
        notes: Vec::new(),
    })))
}

/// Assumption on where the cells lie, for a person.
const PLACED: &str = "voxels taken around the place of the LiDAR on the nuScenes vehicle";

/// Cells that are not free: numbers of cells and raw ids. Ids that are not known are counted.
fn cells(bytes: &[u8], skipped: &mut BTreeMap<String, usize>) -> Result<Vec<(usize, u16)>, String> {
    if bytes.len() != 2 * CELLS {
        return Err(format!(
            "{} bytes, expected {}: the raw ids of 256 x 256 x 32 voxels of SemanticKITTI, two bytes each",
            bytes.len(),
            2 * CELLS
        ));
    }
    let ids = bytes
        .as_chunks::<2>()
        .0
        .iter()
        .map(|raw| u16::from_le_bytes(*raw));
    let cells: Vec<(usize, u16)> = ids.enumerate().filter(|(_, id)| *id != 0).collect();
    let unknown = cells
        .iter()
        .filter(|(_, id)| SEMANTIC_KITTI.class(*id).is_none())
        .count();
    if unknown > 0 {
        skipped.insert("raw ids that are not known, taken as others".to_owned(), unknown);
    }
    Ok(cells)
}

/// A scene in the cells of the file.
fn as_it_is(name: &str, cells: &[(usize, u16)], map: &DataMap, invalid: Option<&[u8]>) -> Scene {
    let cells: Vec<_> = cells
        .iter()
        .map(|(index, id)| (LATTICE.cell(*index), *id))
        .collect();
    let unobserved = invalid.and_then(|bits| own_mask(map, bits));
    let mut scene = on_data_map(name, map, &cells, &SEMANTIC_KITTI);
    scene.change_canvas(|frame| frame.inferred.unobserved = unobserved);
    scene
}

/// The voxels of a map of the cells that no scan saw.
fn own_mask(map: &DataMap, invalid: &[u8]) -> Option<Unobserved> {
    let extent = map.extent();
    let mut words = vec![0; extent.columns()];
    for cell in (0..CELLS).filter(|cell| bit(invalid, *cell)) {
        let [x, y, z] = map.voxel(LATTICE.cell(cell));
        words[extent.index(x, y)] |= 1 << z;
    }
    Unobserved::from_words(extent, words)
}

/// The labels in the voxels of Occ3D.
fn on_window(cells: &[(usize, u16)], skipped: &mut BTreeMap<String, usize>) -> Result<VoxelGrid, String> {
    let rig = SensorRig::default();
    let lidar = rig.lidars.first().ok_or("the usual rig has no LiDAR")?;
    let pose = ego_from_cells(lidar);
    let mut votes = VoxelVotes::new(&LATTICE, &pose)?;
    for (index, id) in cells {
        votes.add(LATTICE.cell(*index), SEMANTIC_KITTI.shown(*id).id());
    }
    let (voxels, elsewhere) = votes.voxels();
    if elsewhere > 0 {
        skipped.insert("cells above the map".to_owned(), elsewhere);
    }
    Ok(voxels.lowered())
}

/// The labels of a file in the voxels of Occ3D.
#[cfg(test)]
pub(crate) fn labels(bytes: &[u8]) -> Result<VoxelGrid, String> {
    on_window(&cells(bytes, &mut BTreeMap::new())?, &mut BTreeMap::new())
}

/// The file of the same frame with another ending: a bit per cell. `None` if it is not there; errors if it is of
/// another size.
fn beside(source: &ImportFile<'_>, extension: &str) -> Result<Option<Vec<u8>>, String> {
    let name = source.path.map(|path| path.with_extension(extension));
    let name = name.as_deref().and_then(Path::file_name).and_then(|n| n.to_str());
    let Some(name) = name.filter(|name| source.place(name).is_ok_and(|path| path.is_file())) else {
        return Ok(None);
    };
    let bytes = source.beside(name, BIT_BYTES as u64).map_err(|e| e.to_string())?;
    match bytes.len() == BIT_BYTES {
        true => Ok(Some(bytes)),
        false => Err(format!("{name}: {} bytes, expected {BIT_BYTES}", bytes.len())),
    }
}

/// The voxels that no scan saw: a voxel is observed if one of the cells with their middle in it is valid.
fn mask(extent: Extent, invalid: &[u8]) -> Option<Unobserved> {
    let rig = SensorRig::default();
    let pose = ego_from_cells(rig.lidars.first()?);
    let mut observed = vec![0; extent.columns()];
    for cell in (0..CELLS).filter(|cell| !bit(invalid, *cell)) {
        let p = pose.apply(LATTICE.center(LATTICE.cell(cell)));
        if let Some([x, y, z]) = Physical::voxel_at(extent, p) {
            observed[extent.index(x, y)] |= 1 << z;
        }
    }
    unobserved(extent, &observed)
}

/// The first labels of a folder of voxels, of a sequence, or of a data set.
fn first_label(folder: &Path) -> Option<PathBuf> {
    let sorted = |folder: &Path| {
        let entries = std::fs::read_dir(folder).ok();
        let mut paths: Vec<PathBuf> = entries
            .into_iter()
            .flatten()
            .flatten()
            .map(|e| e.path())
            .collect();
        paths.sort();
        paths
    };
    let sequences = sorted(&folder.join("sequences"))
        .into_iter()
        .map(|s| s.join("voxels"));
    let own = folder.ends_with("voxels").then(|| folder.to_path_buf());
    let folders = own.into_iter().chain([folder.join("voxels")]).chain(sequences);
    let is_label = |path: &PathBuf| path.extension().is_some_and(|e| e == "label") && path.is_file();
    folders
        .into_iter()
        .find_map(|folder| sorted(&folder).into_iter().find(is_label))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use scene::Class;

    use super::*;
    use crate::semantic_kitti::packed;

    /// A car of four cells to a side, ahead of the LiDAR to the left, on a strip of road.
    pub(super) fn sample() -> Vec<u8> {
        let mut raw = vec![0u16; CELLS];
        for x in 0..190 {
            (100..160).for_each(|y| raw[LATTICE.index([x, y, 1])] = 40);
        }
        for (x, y) in (100..120).flat_map(|x| (140..150).map(move |y| (x, y))) {
            (2..10).for_each(|z| raw[LATTICE.index([x, y, z])] = 252);
        }
        raw.iter().flat_map(|id| id.to_le_bytes()).collect()
    }

    fn loaded(path: Option<&Path>, bytes: &[u8]) -> Result<ImportedScene, String> {
        let source = ImportFile {
            bytes,
            name: "000000",
            path,
            options: super::super::ImportOptions {
                lift_m: None,
                resample: true,
            },
        };
        match read(&source)? {
            Content::Scene(loaded) => Ok(*loaded),
            other => panic!("expected a scene, not {other:?}"),
        }
    }

    #[test]
    fn a_car_ahead_to_the_left_lands_there() {
        let found = loaded(None, &sample()).expect("read");
        let occupancy = &found.scene.frame().occupancy;
        assert_eq!(occupancy.extent(), Extent::WINDOW);
        // Cells 100 to 120 ahead of a LiDAR at 0.94 m, 12 to 22 of its left: x 20.9 to 24.9, y 2.4 to 4.4 m.
        let at = |x: f64, y: f64, z: f64| {
            let [x, y, z] = Extent::WINDOW.voxel_at(DVec3::new(x, y, z)).expect("inside");
            occupancy.get(x, y, z)
        };
        assert_eq!(at(22.0, 3.4, 1.0), Class::Car.id());
        assert_eq!(at(22.0, -3.4, 1.0), Class::FREE);
        assert_eq!(at(19.0, 3.4, 1.0), Class::FREE);
        // The road lies where Occ3D has it.
        assert_eq!(at(10.0, 0.0, -0.8), Class::DriveableSurface.id());
        let boxes = &found.scene.frame().boxes;
        assert!(
            boxes
                .values()
                .any(|b| b.class == Class::Car && b.center_m.y > 2.0),
            "{boxes:?}"
        );
        assert!(found.scene.frame().inferred.unobserved.is_none());
    }

    #[test]
    fn unknown_ids_and_wrong_sizes_are_told() {
        let mut bytes = sample();
        bytes[..2].copy_from_slice(&7u16.to_le_bytes());
        bytes[2 * LATTICE.index([5, 128, 5])] = 3;
        let found = loaded(None, &bytes).expect("read");
        let unknown = found.skipped.get("raw ids that are not known, taken as others");
        assert_eq!(unknown, Some(&2));
        for cut in [0, 1, bytes.len() / 2, bytes.len() - 1] {
            let line = loaded(None, &bytes[..cut]).expect_err("cut");
            assert!(
                line.starts_with(&format!("{cut} bytes, expected 4194304")),
                "{line}"
            );
        }
    }

    #[test]
    fn what_no_scan_saw_is_read_beside_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let voxels = folder.path().join("sequences/08/voxels");
        std::fs::create_dir_all(&voxels).expect("made");
        let path = voxels.join("000005.label");
        std::fs::write(&path, sample()).expect("written");
        std::fs::write(voxels.join("000007.label"), b"later").expect("written");
        // All but the cells that are less than 10 m ahead.
        let bits: Vec<bool> = (0..CELLS).map(|cell| LATTICE.cell(cell)[0] >= 50).collect();
        std::fs::write(voxels.join("000005.invalid"), packed(&bits)).expect("written");
        for start in [folder.path(), &folder.path().join("sequences/08"), &voxels] {
            assert_eq!(first_label(start).as_ref(), Some(&path), "{}", start.display());
        }
        assert_eq!(first_label(&folder.path().join("sequences")), None);
        let found = loaded(Some(&path), &sample()).expect("read");
        let unobserved = found.scene.frame().inferred.unobserved.clone().expect("a mask");
        let word = |x_m: f64| {
            let [x, y] = Extent::WINDOW.column_at(x_m, 0.2).expect("inside");
            unobserved.words()[Extent::WINDOW.index(x, y)]
        };
        assert_eq!((word(5.0), word(15.0), word(-5.0)), (0, 0xffff, 0xffff));
        std::fs::write(voxels.join("000005.invalid"), b"short").expect("written");
        let line = loaded(Some(&path), &sample()).expect_err("refused");
        assert_eq!(line, "000005.invalid: 5 bytes, expected 262144");
        std::fs::write(voxels.join("000005.invalid"), vec![0; BIT_BYTES + 1]).expect("written");
        assert!(
            loaded(Some(&path), &sample())
                .expect_err("refused")
                .contains("262145 bytes")
        );
    }
}
