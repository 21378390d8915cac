//! Voxels of Nuplan-Occ: ground is told from what stands on it, since the files call both background.

use std::collections::BTreeMap;

use scene::label_sets::NUPLAN_OCC;
use scene::{Class, DataLabels, VoxelGrid};

use super::{Content, GUESSED, ImportFile, ImportedScene, labelled};
use crate::npy::NpyMatrix;
use crate::npz;
use crate::nuplan_occ::{ARRAY, LATTICE, ego_from_cells};
use crate::voxels::{DataMap, VoxelVotes};

/// Largest list that is unpacked: four numbers of eight bytes for each cell.
const LARGEST: u64 = 32 * 400 * 400 * 32 + 65_536;
/// Label of all that is no object.
const BACKGROUND: u16 = 7;
/// Around the vehicle within this many cells the height of the ground is looked for.
const NEAR: usize = 80;
/// Farthest that ground lies above or below the ground around the vehicle, cells.
const GROUND_REACH: usize = 4;

/// A cell and its label.
type LabelledCell = ([usize; 3], u16);

/// The list of voxels in an archive, as an `.npy` file, if it is one of Nuplan-Occ.
pub(super) fn list_in(archive: &[u8]) -> Option<Vec<u8>> {
    let bytes = npz::entry(archive, ARRAY, LARGEST)?;
    let is_list = NpyMatrix::read(&bytes).is_ok_and(|table| table.columns == 4);
    is_list.then_some(bytes)
}

/// A scene of a list of voxels, see [`list_in`].
pub(super) fn read(source: &ImportFile<'_>, list: &[u8]) -> Result<Content, String> {
    let table = NpyMatrix::read(list)?;
    let mut skipped = BTreeMap::new();
    let cells = cells(&table, &mut skipped)?;
    let bins = ground_bins(&cells)?;
    let pose = ego_from_cells(bins.level);
    let scene = match source.options.resample {
        false => {
            let map = DataMap::new(&LATTICE, &pose)?;
            let mut grid = VoxelGrid::over(map.extent());
            for cell in &cells {
                let [x, y, z] = map.voxel(cell.0);
                grid.set(x, y, z, bins.class(cell).id());
            }
            let labels = cells.iter().map(|(cell, label)| (map.voxel(*cell), *label));
            let free = NUPLAN_OCC.label(Class::Free);
            let labels = DataLabels::new(&NUPLAN_OCC, map.extent(), free, labels);
            let mut scene = labelled(source.name, grid, None);
            scene.change_canvas(|frame| frame.inferred.data_labels = Some(labels));
            scene
        }
        true => labelled(source.name, on_window(&cells, &bins, &mut skipped)?, None),
    };
    let told = format!(
        "voxels taken as Nuplan-Occ, the ground found in layer {} of 32",
        bins.level
    );
    skipped.insert(told, cells.len());
    let guessed = "lowest voxels of background taken as other flat ground";
    skipped.insert(
        guessed.to_owned(),
        cells.iter().filter(|cell| bins.is_ground(cell)).count(),
    );
    Ok(Content::Scene(Box::new(ImportedScene {
        sweep: None,
        scene,
        inferred: &GUESSED,
        skipped,
        notes: Vec::new(),
    })))
}

/// The rows. Errors on one that is no cell.
fn cells(table: &NpyMatrix<'_>, skipped: &mut BTreeMap<String, usize>) -> Result<Vec<LabelledCell>, String> {
    let most = LATTICE.cells();
    if table.rows > most {
        return Err(format!(
            "{} rows, expected at most {most}, one for each cell",
            table.rows
        ));
    }
    let mut out = Vec::with_capacity(table.rows);
    for row in 0..table.rows {
        let values = [0, 1, 2, 3].map(|column| table.get(row, column));
        let sound = |axis: usize| {
            let below = LATTICE.size.get(axis).map_or(f64::from(u16::MAX), |n| *n as f64);
            (0.0..below).contains(&values[axis]) && values[axis].fract() == 0.0
        };
        if let Some(axis) = (0..4).find(|axis| !sound(*axis)) {
            let of = ["x below 400", "y below 400", "z below 32", "a label"][axis];
            let found = values[axis];
            return Err(format!(
                "row {row}, column {axis}: {found}, expected {of} of Nuplan-Occ"
            ));
        }
        let label = values[3] as u16;
        if NUPLAN_OCC.class(label).is_none() {
            *skipped
                .entry("labels above 7, taken as others".to_owned())
                .or_default() += 1;
        }
        let [x, y, z, _] = values.map(|v| v as usize);
        out.push(([x, y, z], label));
    }
    Ok(out)
}

/// The lowest voxels of background in each column, and the bin of most of them around the vehicle.
struct GroundBins {
    lowest: Vec<u8>, // [x][y], u8::MAX where there is none
    level: usize,
}

impl GroundBins {
    /// True for background that is the lowest of its column and near the level of the ground.
    fn is_ground(&self, ([x, y, z], label): &LabelledCell) -> bool {
        *label == BACKGROUND
            && z.abs_diff(self.level) <= GROUND_REACH
            && usize::from(self.lowest[x * LATTICE.size[1] + y]) == *z
    }
}

impl GroundBins {
    /// The class that a cell is shown as.
    fn class(&self, cell: &LabelledCell) -> Class {
        match self.is_ground(cell) {
            true => Class::OtherFlat,
            false => NUPLAN_OCC.shown(cell.1),
        }
    }
}

/// Errors in a list without background.
fn ground_bins(cells: &[LabelledCell]) -> Result<GroundBins, String> {
    let [nx, ny, nz] = LATTICE.size;
    let mut lowest = vec![u8::MAX; nx * ny];
    for ([x, y, z], _) in cells.iter().filter(|(_, label)| *label == BACKGROUND) {
        let at = &mut lowest[x * ny + y];
        *at = (*at).min(*z as u8);
    }
    let mut counts = vec![0usize; nz];
    let near = |at: usize, side: usize| at.abs_diff(side / 2) < NEAR;
    let columns = (0..nx * ny).filter(|i| near(i / ny, nx) && near(i % ny, ny));
    for bin in columns.map(|i| lowest[i]).filter(|bin| *bin != u8::MAX) {
        counts[usize::from(bin)] += 1;
    }
    let level = (0..nz).max_by_key(|bin| (counts[*bin], nz - bin)).unwrap_or(0);
    match counts[level] {
        0 => Err("no voxel of background within 20 m, expected ground around the vehicle".into()),
        _ => Ok(GroundBins { lowest, level }),
    }
}

/// Labels of cells in the voxels of Occ3D.
fn on_window(
    cells: &[LabelledCell],
    bins: &GroundBins,
    skipped: &mut BTreeMap<String, usize>,
) -> Result<VoxelGrid, String> {
    let pose = ego_from_cells(bins.level);
    let mut votes = VoxelVotes::new(&LATTICE, &pose)?;
    for cell in cells {
        votes.add(cell.0, bins.class(cell).id());
    }
    let (voxels, elsewhere) = votes.voxels();
    if elsewhere > 0 {
        skipped.insert("cells above or below the map".to_owned(), elsewhere);
    }
    Ok(voxels.lowered())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::ImportOptions;
    use crate::nuplan_occ;
    use scene::{Lattice, Scene};

    /// A street with a car, a sign and a wall; the ground in a layer.
    fn rows(ground: i32) -> Vec<[i32; 4]> {
        let mut rows = Vec::new();
        for (x, y) in (0..400).flat_map(|x| (150..262).map(move |y| (x, y))) {
            rows.push([x, y, ground, 7]);
        }
        for (x, y, z) in (230..248).flat_map(|x| (206..213).flat_map(move |y| (1..7).map(move |z| (x, y, z))))
        {
            rows.push([x, y, ground + z, 0]);
        }
        for (x, z) in (100..300).flat_map(|x| (1..20).map(move |z| (x, z))) {
            rows.push([x, 260, ground + z, 7]);
        }
        rows.push([220, 190, ground + 3, 5]);
        rows.push([221, 190, ground + 3, 9]);
        rows.sort_unstable();
        rows
    }

    fn archive(rows: &[[i32; 4]]) -> Vec<u8> {
        let npy = npz::npy(&[rows.len(), 4], rows.as_flattened()).expect("memory");
        npz::holding(ARRAY, &npy).expect("memory")
    }

    fn opened(bytes: &[u8], resample: bool) -> Result<Scene, String> {
        let source = ImportFile {
            bytes,
            name: "frame",
            path: None,
            options: ImportOptions {
                resample,
                ..ImportOptions::default()
            },
        };
        match read(&source, &list_in(bytes).ok_or("no list")?)? {
            Content::Scene(found) => Ok(found.scene),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn voxels_come_back_as_they_were_but_for_the_edit() {
        for ground in [4, 12] {
            let rows = rows(ground);
            let mut scene = opened(&archive(&rows), false).expect("read");
            let extent = scene.frame().extent();
            assert_eq!(extent.shape(), [400, 400, 32]);
            let bottom_m = -0.25 * (f64::from(ground) + 0.5);
            assert_eq!(extent.lattice(), Lattice::new(0.25, 32, bottom_m).expect("sound"));
            assert_eq!(scene.frame().boxes.len(), 1, "the car");
            let counts = scene.frame().occupancy.class_counts();
            assert_eq!(counts[usize::from(Class::OtherFlat.id())], 400 * 112);
            assert!(
                nuplan_occ::to_bytes(&scene).expect("written") == archive(&rows),
                "as it was"
            );
            scene.change_canvas(|frame| {
                frame
                    .occupancy
                    .set(220, 190, ground as usize + 3, Class::Pedestrian.id())
            });
            let edited = nuplan_occ::to_bytes(&scene).expect("written");
            let mut expected = rows.clone();
            let sign = expected.iter_mut().find(|row| row[3] == 5).expect("a sign");
            sign[3] = 2;
            assert!(edited == archive(&expected));
        }
    }

    #[test]
    fn in_the_voxels_of_occ3d_the_ground_is_at_its_place() {
        let scene = opened(&archive(&rows(12)), true).expect("read");
        let counts = scene.frame().occupancy.class_counts();
        let flat = counts[usize::from(Class::OtherFlat.id())];
        assert!(flat > 200 * 60, "{flat}");
        let lowest = scene
            .frame()
            .occupancy
            .iter_set()
            .filter(|v| v.3 == Class::OtherFlat.id());
        assert!(lowest.into_iter().all(|v| v.2 == 0));
    }

    #[test]
    fn bad_lists_are_one_line() {
        let with =
            |row: [i32; 4]| opened(&archive(&[&rows(12)[..], &[row]].concat()), false).expect_err("refused");
        assert!(with([400, 0, 0, 7]).ends_with("column 0: 400, expected x below 400 of Nuplan-Occ"));
        assert!(with([0, 0, 32, 7]).contains("column 2: 32"));
        assert!(with([0, 0, -1, 7]).contains("column 2: -1"));
        let line = opened(&archive(&[[5, 5, 5, 0]]), false).expect_err("no ground");
        assert!(line.starts_with("no voxel of background"), "{line}");
    }
}
