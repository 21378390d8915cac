//! Labels of one grid on the cells of another, by the places of their middles.

use std::cmp::Reverse;

use glam::DVec3;
use scene::{Class, Extent, Lattice, Pose, Window};

use super::{DataCells, Physical};

/// A cell of a lattice and its class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct LabelledCell {
    /// Along x, y, z.
    pub at: [u16; 3],
    /// Label value of [`Class`].
    pub class: u8,
}

/// The cells of a lattice that are not free, sorted by place. A cell no larger than a voxel has the class of the voxel that
/// holds its middle. A larger one has the most frequent class of the voxels that are not free and have their middle in it; if
/// there is none, that of the voxel that holds its own middle.
pub(crate) fn cells_of(
    physical: &Physical,
    lattice: &DataCells,
    ego_from_lattice: &Pose,
) -> Vec<LabelledCell> {
    let extent = physical.extent();
    let finer = lattice.cell_m <= Window::VOXEL_M;
    let overlap = Overlap::new(lattice, ego_from_lattice);
    let mut found = Vec::new();
    let mut votes = Vec::new();
    for (x, y, z, class) in physical.iter_set() {
        let center = extent.center(x, y, z);
        if !finer && let Some(cell) = lattice.cell_at(overlap.lattice_from_ego.apply(center)) {
            votes.push(cell_of(cell, class));
        }
        overlap.cells(center, |cell, p_in_ego| {
            if Physical::voxel_at(extent, p_in_ego) == Some([x, y, z]) {
                found.push(cell_of(cell, class));
            }
        });
    }
    votes.sort_unstable();
    let mut winners: Vec<LabelledCell> = votes.chunk_by(|a, b| a.at == b.at).filter_map(winner).collect();
    found.retain(|cell| winners.binary_search_by_key(&cell.at, |w| w.at).is_err());
    found.append(&mut winners);
    found.sort_unstable();
    found
}

fn cell_of(at: [usize; 3], class: u8) -> LabelledCell {
    LabelledCell {
        at: at.map(|v| v as u16),
        class,
    }
}

/// The most frequent class of sorted votes on one place; of equally many the lowest, "others" last.
fn winner(votes: &[LabelledCell]) -> Option<LabelledCell> {
    let of_one = votes.chunk_by(|a, b| a.class == b.class);
    let best = of_one.max_by_key(|v| {
        let class = v[0].class;
        (v.len(), class != Class::Others.id(), Reverse(class))
    });
    best.map(|v| v[0])
}

/// Cells whose middle may lie in a voxel.
struct Overlap<'a> {
    lattice: &'a DataCells,
    ego_from_lattice: &'a Pose,
    lattice_from_ego: Pose,
    /// Half of a voxel along the lattice's axes, in cells.
    reach: DVec3,
}

impl<'a> Overlap<'a> {
    fn new(lattice: &'a DataCells, ego_from_lattice: &'a Pose) -> Self {
        let lattice_from_ego = ego_from_lattice.inverse();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| (lattice_from_ego.rotation * axis).abs());
        Self {
            lattice,
            ego_from_lattice,
            lattice_from_ego,
            reach: (axes[0] + axes[1] + axes[2]) * (Window::VOXEL_M / 2.0 / lattice.cell_m),
        }
    }

    /// Visits the cells whose middle lies in the box around a voxel with this middle, with their own middle, both in m of the
    /// ego frame.
    fn cells(&self, center_in_ego: DVec3, mut visit: impl FnMut([usize; 3], DVec3)) {
        let at = self.lattice.to_cells(self.lattice_from_ego.apply(center_in_ego)) - 0.5;
        let (low, high) = ((at - self.reach).ceil(), (at + self.reach).floor());
        let range = |axis: usize| {
            let end = (high[axis] + 1.0).clamp(0.0, self.lattice.size[axis] as f64) as usize;
            (low[axis].max(0.0) as usize)..end
        };
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    let cell = [x, y, z];
                    visit(cell, self.ego_from_lattice.apply(self.lattice.center(cell)));
                }
            }
        }
    }
}

/// Cells of a lattice that are to become voxels.
pub(crate) struct VoxelVotes<'a> {
    lattice: &'a DataCells,
    ego_from_lattice: &'a Pose,
    extent: Extent,
    /// Cells no larger than a voxel: each vote is a voxel and a class in one number.
    votes: Vec<u32>,
    /// Larger cells: the class of each.
    coarse: Vec<u8>,
    elsewhere: usize,
}

/// Classes that a number can hold beside its voxel.
const CLASSES: u32 = 32;

impl<'a> VoxelVotes<'a> {
    /// Holds no cells yet. Errors in one line if the lattice lies nowhere near the ego vehicle.
    pub fn new(lattice: &'a DataCells, ego_from_lattice: &'a Pose) -> Result<Self, String> {
        let corners = lattice.corners_m().map(|corner| ego_from_lattice.apply(corner));
        let low = corners.iter().fold(corners[0], |low, c| low.min(*c));
        let high = corners.iter().fold(corners[0], |high, c| high.max(*c));
        let columns = |v: f64| (v * Lattice::OCC3D.per_m()).floor() as i32;
        let from = [low.x, low.y].map(columns);
        let size = [high.x, high.y].map(columns);
        let size = [0, 1].map(|axis| (size[axis] - from[axis] + 1) as usize);
        let is_coarse = lattice.cell_m > Window::VOXEL_M;
        Ok(Self {
            lattice,
            ego_from_lattice,
            extent: Extent::new(from, size)?,
            votes: Vec::new(),
            coarse: vec![Class::FREE; if is_coarse { lattice.cells() } else { 0 }],
            elsewhere: 0,
        })
    }

    /// Adds a cell of the lattice that is not free.
    pub fn add(&mut self, cell: [usize; 3], class: u8) {
        if !self.coarse.is_empty() {
            self.coarse[self.lattice.index(cell)] = class;
            return;
        }
        match self.voxel_of(cell) {
            Some(voxel) => self.votes.push(voxel * CLASSES + u32::from(class)),
            None => self.elsewhere += 1,
        }
    }

    /// The voxel that holds the middle of a cell, as one number.
    fn voxel_of(&self, cell: [usize; 3]) -> Option<u32> {
        let p = self.ego_from_lattice.apply(self.lattice.center(cell));
        let [x, y, z] = Physical::voxel_at(self.extent, p)?;
        Some((self.extent.index(x, y) * Physical::NZ + z) as u32)
    }

    /// The voxels, and the number of cells that lie in no voxel. A voxel has the most frequent class of the cells with
    /// their middle in it; where cells are larger than voxels, that of the cell that holds its own middle. The map
    /// covers the networks' window, and more only if cells beyond it are set.
    pub fn voxels(self) -> (Physical, usize) {
        match self.coarse.is_empty() {
            true => self.by_votes(),
            false => self.by_middles(),
        }
    }

    fn by_middles(mut self) -> (Physical, usize) {
        let mut out = Physical::over(self.extent);
        let lattice_from_ego = self.ego_from_lattice.inverse();
        let mut is_used = vec![false; self.coarse.len()];
        for [x, y] in self.extent.all_columns() {
            for z in 0..Physical::NZ {
                let at = lattice_from_ego.apply(self.extent.center(x, y, z));
                if let Some(cell) = self.lattice.cell_at(at) {
                    let index = self.lattice.index(cell);
                    is_used[index] = true;
                    out.column_mut(x, y)[z] = self.coarse[index];
                }
            }
        }
        let is_lost = |(class, is_used): (&u8, &bool)| *class != Class::FREE && !is_used;
        self.elsewhere += self
            .coarse
            .iter()
            .zip(&is_used)
            .filter(|cell| is_lost(*cell))
            .count();
        (out.snug(), self.elsewhere)
    }

    fn by_votes(mut self) -> (Physical, usize) {
        let mut out = Physical::over(self.extent);
        self.votes.sort_unstable();
        for of_voxel in self.votes.chunk_by(|a, b| a / CLASSES == b / CLASSES) {
            let of_one = of_voxel.chunk_by(|a, b| a == b);
            let best = of_one.max_by_key(|v| {
                let class = v[0] % CLASSES;
                (v.len(), class != u32::from(Class::Others.id()), Reverse(class))
            });
            let Some(best) = best.map(|v| v[0]) else { continue };
            let voxel = (best / CLASSES) as usize;
            let [x, y] = self.extent.column(voxel / Physical::NZ);
            out.column_mut(x, y)[voxel % Physical::NZ] = (best % CLASSES) as u8;
        }
        (out.snug(), self.elsewhere)
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::table_tests::random_scene;

    const FINE: DataCells = DataCells {
        size: [512, 512, 40],
        cell_m: 0.2,
        min_m: [-51.2, -51.2, -5.0],
    };
    const COARSE: DataCells = DataCells {
        size: [200, 200, 16],
        cell_m: 0.5,
        min_m: [-50.0, -50.0, -5.0],
    };

    /// Turned to the right and slightly tilted, on a roof.
    fn sensor() -> Pose {
        Pose {
            rotation: DQuat::from_rotation_z(-1.56) * DQuat::from_rotation_x(0.01),
            translation_m: DVec3::new(0.94, 0.02, 1.84),
        }
    }

    fn back(lattice: &DataCells, pose: &Pose, cells: &[LabelledCell]) -> Physical {
        let mut all = VoxelVotes::new(lattice, pose).expect("around the vehicle");
        for cell in cells {
            all.add(cell.at.map(usize::from), cell.class);
        }
        all.voxels().0
    }

    /// Through cells of half the size every voxel comes back that has a cell's middle in it, and no other.
    #[test]
    fn finer_cells_lose_nothing_but_what_lies_beyond_them() {
        let pose = sensor();
        for seed in 0..20 {
            let physical = Physical::raised(&random_scene(seed).frame().occupancy);
            let cells = cells_of(&physical, &FINE, &pose);
            assert!(
                cells.windows(2).all(|pair| pair[0].at < pair[1].at),
                "sorted, each once"
            );
            let again = back(&FINE, &pose, &cells);
            assert_eq!(again.extent(), Extent::WINDOW);
            for [x, y] in Extent::WINDOW.all_columns() {
                for z in 0..Physical::NZ {
                    let (before, after) = (physical.column(x, y)[z], again.column(x, y)[z]);
                    if before == after {
                        continue;
                    }
                    assert_eq!(after, Class::FREE, "seed {seed}: {x}, {y}, {z}");
                    // Nothing but the top of the lattice is in reach of a map.
                    let p = pose.inverse().apply(Extent::WINDOW.center(x, y, z));
                    assert!(p.z > 3.0 - 0.45, "seed {seed}: {p}");
                }
            }
            assert!(again.iter_set().count() > 1000);
        }
    }

    /// Through larger cells every voxel comes back as something, and what is around it may become something too.
    #[test]
    fn coarser_cells_leave_nothing_out() {
        let pose = sensor();
        for seed in 0..20 {
            let physical = Physical::raised(&random_scene(seed).frame().occupancy);
            let cells = cells_of(&physical, &COARSE, &pose);
            assert!(cells.windows(2).all(|pair| pair[0].at < pair[1].at));
            let again = back(&COARSE, &pose, &cells);
            for (x, y, z, _) in physical.iter_set() {
                let p = pose.inverse().apply(Extent::WINDOW.center(x, y, z));
                let [ax, ay] = [0, 1].map(|a| (Extent::WINDOW.from()[a] - again.extent().from()[a]) as usize);
                let after = again.column(x + ax, y + ay)[z];
                assert!(after != Class::FREE || p.z >= 3.0, "seed {seed}: {p}");
            }
            // And nothing appears farther off than the diagonal of a cell.
            let grown = again.iter_set().count() as f64 / physical.iter_set().count() as f64;
            assert!((0.8..4.0).contains(&grown), "{grown}");
        }
    }

    #[test]
    fn the_most_frequent_class_wins_and_others_yields() {
        let pose = Pose::IDENTITY;
        let class = |classes: &[u8]| {
            let mut all = VoxelVotes::new(&FINE, &pose).expect("around the vehicle");
            // Eight cells of the voxel at 0..0.4 m on each axis, if its z begins at -0.2 m.
            for (i, class) in classes.iter().enumerate() {
                all.add([256 + (i & 1), 256 + (i >> 1 & 1), 24 + (i >> 2)], *class);
            }
            let (voxels, elsewhere) = all.voxels();
            assert_eq!(elsewhere, 0);
            let found: Vec<_> = voxels.iter_set().collect();
            assert_eq!(found.len(), 1, "{found:?}");
            let (x, y, z, class) = found[0];
            assert_eq!([x, y, z], [100, 100, 2]);
            class
        };
        assert_eq!(class(&[4, 4, 11, 11, 11]), 11);
        assert_eq!(class(&[4, 11]), 4);
        assert_eq!(class(&[0, 11]), 11);
        assert_eq!(class(&[0]), 0);
    }
}
