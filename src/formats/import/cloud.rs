//! Points with labels into voxels: what every format of point clouds needs.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::{Class, VoxelGrid, Window};

/// Points on the map, each as its voxel and class in one number.
#[derive(Default)]
pub(super) struct Cloud {
    voxels: Vec<u32>,
    not_finite: usize,
    elsewhere: usize,
    unknown: usize,
}

/// Classes that a number can hold beside its voxel.
const CLASSES: u32 = 32;

impl Cloud {
    /// One point, in m in the ego frame, and its label if it has one.
    pub(super) fn add(&mut self, at: DVec3, label: Option<f64>) {
        if !at.is_finite() {
            self.not_finite += 1;
            return;
        }
        let Some([x, y, z]) = Window::voxel_at(at) else {
            self.elsewhere += 1;
            return;
        };
        let class = match label {
            Some(label) if (0.0..f64::from(Class::FREE)).contains(&label) && label.fract() == 0.0 => {
                label as u32
            }
            Some(_) => {
                self.unknown += 1;
                u32::from(Class::Others.id())
            }
            None => u32::from(Class::Others.id()),
        };
        let voxel = (x * Window::NY + y) * Window::NZ + z;
        self.voxels.push(voxel as u32 * CLASSES + class);
    }

    /// True if no point lies on the map.
    pub(super) fn is_empty(&self) -> bool {
        self.voxels.is_empty()
    }

    /// Each voxel by the vote of its points; of equally many the lowest class, "others" last.
    pub(super) fn grid(mut self) -> VoxelGrid {
        self.voxels.sort_unstable();
        let mut grid = VoxelGrid::new();
        for points in self.voxels.chunk_by(|a, b| a / CLASSES == b / CLASSES) {
            let votes = points.chunk_by(|a, b| a == b);
            let winner = votes.max_by_key(|v| {
                let class = v[0] % CLASSES;
                (
                    v.len(),
                    class != u32::from(Class::Others.id()),
                    std::cmp::Reverse(class),
                )
            });
            let Some(winner) = winner else { continue };
            let voxel = (winner[0] / CLASSES) as usize;
            let (x, y, z) = (
                voxel / (Window::NY * Window::NZ),
                voxel / Window::NZ % Window::NY,
                voxel % Window::NZ,
            );
            grid.set(x, y, z, (winner[0] % CLASSES) as u8);
        }
        grid
    }

    /// Points that are not in the grid, or not with their label, counted by kind.
    pub(super) fn skipped(&self) -> BTreeMap<String, usize> {
        let counts = [
            ("points that are not finite", self.not_finite),
            ("points beside the map", self.elsewhere),
            ("labels above 16, taken as others", self.unknown),
        ];
        let some = counts.into_iter().filter(|(_, n)| *n > 0);
        some.map(|(what, n)| (what.to_owned(), n)).collect()
    }
}
