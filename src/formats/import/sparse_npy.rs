//! Lists of voxels: OpenOccupancy, SurroundOcc and UniScene. Which of them a file is, its columns tell; the file says neither
//! that nor where the LiDAR is, so both are assumed and told.

use std::collections::BTreeMap;

use scene::label_sets::NUSCENES;
use scene::message::quoted;
use scene::{Class, Scene, SensorRig, VoxelGrid};

use super::{Content, GUESSED, ImportFile, ImportedScene, Importer, labelled, on_data_map};
use crate::npy::NpyMatrix;
use crate::sparse_npy::{OPEN_OCCUPANCY, SparseDataset, ego_from_lidar};
use crate::voxels::{DataMap, VoxelVotes};
use crate::{FormatError, Holds};

/// Labels that readers of these files ignore: noise, and the number that they replace it by.
const IGNORED: [u16; 2] = [0, 255];

/// See `sparse_npy`.
pub const IMPORTER: Importer = Importer {
    id: "sparse-npy",
    title: "lists of voxels of OpenOccupancy, SurroundOcc and UniScene",
    extensions: &["npy"],
    holds: &[Holds::Occupancy],
    largest: 256 << 20,
    recognises: |head| head.starts_with(b"\x93NUMPY"),
    in_folder: None,
    read: |source| read(source).map_err(FormatError::new),
    #[cfg(test)]
    sample: tests::sample,
};

fn read(source: &ImportFile<'_>) -> Result<Content, String> {
    let (table, kind) = table(source.bytes)?;
    let mut skipped = BTreeMap::new();
    let cells = cells(&table, &kind, &mut skipped);
    let scene = match source.options.resample {
        false => as_it_is(source.name, &cells, &kind)?,
        true => labelled(source.name, on_window(&cells, &kind, &mut skipped)?, None),
    };
    if table.columns == 7 {
        skipped.insert("velocities of voxels".to_owned(), table.rows);
    }
    skipped.insert(kind.assumed.to_owned(), table.rows);
    Ok(Content::Scene(Box::new(ImportedScene {
        sweep: None,
        scene,
        inferred: &GUESSED,
        skipped,
        notes: Vec::new(),
    })))
}

/// The table of a file, and the data set that it is of.
fn table(bytes: &[u8]) -> Result<(NpyMatrix<'_>, SparseDataset), String> {
    let table = NpyMatrix::read(bytes)?;
    let (rows, columns) = (table.rows, table.columns);
    if rows == 0 || !matches!(columns, 4 | 7) {
        return Err(format!(
            "{rows} rows of {columns}, expected rows of 4 (three indices and a class) or of 7 (and a velocity)"
        ));
    }
    let kind = kind_of(&table, |row| !is_finite(&table, row))?;
    if rows > kind.lattice.cells() {
        return Err(format!(
            "{rows} rows, expected at most {}, one for each cell",
            kind.lattice.cells()
        ));
    }
    Ok((table, kind))
}

fn is_finite(table: &NpyMatrix<'_>, row: usize) -> bool {
    (0..table.columns).all(|column| table.get(row, column).is_finite())
}

/// Cells and labels of the rows. What is left out or assumed is counted.
fn cells(
    table: &NpyMatrix<'_>,
    kind: &SparseDataset,
    skipped: &mut BTreeMap<String, usize>,
) -> Vec<([usize; 3], u16)> {
    let mut count = |what: &str| *skipped.entry(what.to_owned()).or_default() += 1;
    let indices = |row: usize| [0, 1, 2].map(|column| table.get(row, column) as usize);
    let mut out = Vec::with_capacity(table.rows);
    for row in 0..table.rows {
        if !is_finite(table, row) {
            count("rows that are not finite");
            continue;
        }
        let label = table.get(row, table.columns - 1);
        if !(0.0..=f64::from(u16::MAX)).contains(&label) || label.fract() != 0.0 {
            count("classes that are no whole numbers, taken as others");
            out.push((kind.cell(indices(row)), NUSCENES.label(Class::Others)));
            continue;
        }
        let label = label as u16;
        match NUSCENES.class(label) {
            Some(Class::Free) => {
                count("rows of class 17, free");
                continue;
            }
            Some(_) => {}
            None => count("classes above 17, taken as others"),
        }
        out.push((kind.cell(indices(row)), label));
    }
    out
}

/// A scene in the cells of the file. Noise is kept as others.
fn as_it_is(name: &str, cells: &[([usize; 3], u16)], kind: &SparseDataset) -> Result<Scene, String> {
    let rig = SensorRig::default();
    let lidar = rig.lidars.first().ok_or("the usual rig has no LiDAR")?;
    let map = DataMap::new(&kind.lattice, &ego_from_lidar(lidar))?;
    Ok(on_data_map(name, &map, cells, &NUSCENES))
}

/// Labels of cells in the voxels of Occ3D.
fn on_window(
    cells: &[([usize; 3], u16)],
    kind: &SparseDataset,
    skipped: &mut BTreeMap<String, usize>,
) -> Result<VoxelGrid, String> {
    let rig = SensorRig::default();
    let lidar = rig.lidars.first().ok_or("the usual rig has no LiDAR")?;
    let pose = ego_from_lidar(lidar);
    let mut votes = VoxelVotes::new(&kind.lattice, &pose)?;
    let mut count = |what: &str, n: usize| {
        if n > 0 {
            *skipped.entry(what.to_owned()).or_default() += n;
        }
    };
    for (cell, label) in cells {
        match IGNORED.contains(label) {
            true => count("rows of class 0 or 255, noise", 1),
            false => votes.add(*cell, NUSCENES.shown(*label).id()),
        }
    }
    let (voxels, elsewhere) = votes.voxels();
    if voxels.iter_set().next().is_none() {
        return Err(format!(
            "none of {} rows is a voxel of the map, expected some from -1 to 6.2 m of the ego frame",
            cells.len()
        ));
    }
    count("cells above or below the map", elsewhere);
    let labels = match voxels.is_lowered() {
        true => {
            count("ground below -0.6 m, taken as Occ3D has it", 1);
            voxels.as_it_is()
        }
        false => voxels.lowered(),
    };
    Ok(labels)
}

/// Labels of a file in the voxels of Occ3D.
#[cfg(test)]
fn labels(bytes: &[u8]) -> Result<VoxelGrid, String> {
    let (table, kind) = table(bytes)?;
    let mut skipped = BTreeMap::new();
    on_window(&cells(&table, &kind, &mut skipped), &kind, &mut skipped)
}

/// Which data set a table is of. Errors if its first three columns are no indices of any of them.
fn kind_of(table: &NpyMatrix<'_>, not_finite: impl Fn(usize) -> bool) -> Result<SparseDataset, String> {
    let mut maxima = [0.0; 3];
    for row in (0..table.rows).filter(|row| !not_finite(*row)) {
        for (column, most) in maxima.iter_mut().enumerate() {
            let value = table.get(row, column);
            if value < 0.0 || value.fract() != 0.0 {
                let found = quoted(&value.to_string(), 40);
                return Err(format!(
                    "row {row}, column {column}: {found}, expected the index of a voxel (points are read from .pcd files)"
                ));
            }
            *most = value.max(*most);
        }
    }
    let kind = SparseDataset::of_maxima(maxima.map(|v: f64| v as usize));
    let kind = kind.filter(|kind| table.columns == 4 || *kind == OPEN_OCCUPANCY);
    kind.ok_or_else(|| {
        let [a, b, c] = maxima;
        format!(
            "indices up to {a}, {b}, {c}, expected those of OpenOccupancy (z, y, x below 40, 512, 512), SurroundOcc (x, y, z \
             below 200, 200, 16 or 500, 500, 40) or UniScene (800, 800, 64)"
        )
    })
}

#[cfg(test)]
#[path = "sparse_npy_tests.rs"]
mod tests;
