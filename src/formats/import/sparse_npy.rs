//! Lists of voxels: OpenOccupancy, SurroundOcc and UniScene. Which of them a file is, its columns tell; the file says neither
//! that nor where the LiDAR is, so both are assumed and told.

use std::collections::BTreeMap;

use scene::message::quoted;
use scene::{Class, Scene, SensorRig, VoxelGrid};

use super::{Content, GUESSED, ImportFile, ImportedScene, Importer, labelled, on_data_map};
use crate::npy::NpyMatrix;
use crate::sparse_npy::{OPEN_OCCUPANCY, SparseDataset, ego_from_lidar};
use crate::voxels::{DataMap, VoxelVotes};
use crate::{FormatError, Holds};

/// Classes that readers of these files ignore: noise, and the number that they replace it by.
const IGNORED: [f64; 2] = [0.0, 255.0];

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
    let (scene, skipped) = match source.options.as_it_is {
        true => as_it_is(source)?,
        false => {
            let (labels, skipped) = labels(source.bytes)?;
            (labelled(source.name, labels, None), skipped)
        }
    };
    Ok(Content::Scene(Box::new(ImportedScene {
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
    Ok((table, kind))
}

fn is_finite(table: &NpyMatrix<'_>, row: usize) -> bool {
    (0..table.columns).all(|column| table.get(row, column).is_finite())
}

/// A scene in the cells of the file, and what was assumed and left out. Noise, class 0, is kept as others.
fn as_it_is(source: &ImportFile<'_>) -> Result<(Scene, BTreeMap<String, usize>), String> {
    let (table, kind) = table(source.bytes)?;
    let rig = SensorRig::default();
    let lidar = rig.lidars.first().ok_or("the usual rig has no LiDAR")?;
    let map = DataMap::new(&kind.lattice, &ego_from_lidar(lidar), lidar)?;
    let mut grid = VoxelGrid::over(map.extent());
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    let mut count = |what: &str| *skipped.entry(what.to_owned()).or_default() += 1;
    for row in 0..table.rows {
        if !is_finite(&table, row) {
            count("rows that are not finite");
            continue;
        }
        let label = table.get(row, table.columns - 1);
        let class = match label {
            v if v == f64::from(Class::FREE) => {
                count("rows of class 17, free");
                continue;
            }
            255.0 => {
                count("rows of class 255, noise");
                continue;
            }
            v if (0.0..f64::from(Class::FREE)).contains(&v) && v.fract() == 0.0 => v as u8,
            _ => {
                count("classes above 17, taken as others");
                Class::Others.id()
            }
        };
        let cell = kind.cell([0, 1, 2].map(|column| table.get(row, column) as usize));
        let [x, y, z] = map.voxel(cell);
        grid.set(x, y, z, class);
    }
    if table.columns == 7 {
        skipped.insert("velocities of voxels".to_owned(), table.rows);
    }
    skipped.insert(kind.assumed.to_owned(), table.rows);
    Ok((on_data_map(source.name, grid), skipped))
}

/// The labels that a file holds, and what was assumed and left out.
fn labels(bytes: &[u8]) -> Result<(VoxelGrid, BTreeMap<String, usize>), String> {
    let (table, kind) = table(bytes)?;
    let (rows, columns) = (table.rows, table.columns);
    let not_finite = |row: usize| !is_finite(&table, row);
    let rig = SensorRig::default();
    let lidar = rig.lidars.first().ok_or("the usual rig has no LiDAR")?;
    let pose = ego_from_lidar(lidar);
    let mut cells = VoxelVotes::new(&kind.lattice, &pose)?;
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    let mut count = |what: &str, n: usize| {
        if n > 0 {
            *skipped.entry(what.to_owned()).or_default() += n;
        }
    };
    for row in 0..rows {
        if not_finite(row) {
            count("rows that are not finite", 1);
            continue;
        }
        let cell = kind.cell([0, 1, 2].map(|column| table.get(row, column) as usize));
        let label = table.get(row, columns - 1);
        if IGNORED.contains(&label) {
            count("rows of class 0 or 255, noise", 1);
            continue;
        }
        let known = (1.0..f64::from(Class::FREE)).contains(&label) && label.fract() == 0.0;
        match known {
            true => cells.add(cell, label as u8),
            false if label == f64::from(Class::FREE) => count("rows of class 17, free", 1),
            false => {
                count("classes above 17, taken as others", 1);
                cells.add(cell, Class::Others.id());
            }
        }
    }
    let (voxels, elsewhere) = cells.voxels();
    if voxels.iter_set().next().is_none() {
        return Err(format!(
            "none of {rows} rows is a voxel of the map, expected some from -1 to 6.2 m of the ego frame"
        ));
    }
    count("cells above or below the map", elsewhere);
    if columns == 7 {
        count("velocities of voxels", rows);
    }
    count(kind.assumed, rows);
    let labels = match voxels.is_lowered() {
        true => {
            count("ground below -0.6 m, taken as Occ3D has it", 1);
            voxels.as_it_is()
        }
        false => voxels.lowered(),
    };
    Ok((labels, skipped))
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
