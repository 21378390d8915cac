//! Loss of the VAE on slopes: the same worlds on planes of several grades, and files whose columns are put on such
//! planes.

use glam::DVec2;
use serde_json::{Value, json};

use super::per_class;
use dataset::world_of;
use metrics::iou::Confusion;
use nets::OccVae;
use scene::{Class, Extent, Relief, SensorRig, VoxelGrid, Window};
use world::draw::Draw;
use world::voxelize::{Drive, Vertical, labels};
use world::{World, traffic};

/// Grades that are tried, rise over run.
pub(super) const GRADES: [f64; 5] = [0.0, 0.01, 0.02, 0.04, 0.08];

/// Agreement on each of [`GRADES`].
#[derive(Default)]
pub(super) struct Slopes([Confusion; GRADES.len()]);

/// Uphill direction drawn from the seed, a unit vector.
fn uphill(seed: u64) -> DVec2 {
    DVec2::from_angle(Draw::new(seed, "uphill").range(0.0, std::f64::consts::TAU))
}

/// Simulated labels of a held-out world whose ground is one plane.
fn labels_on(grade: f64, seed: u64, index: u64) -> VoxelGrid {
    let (world, seed) = world_of(seed, index, |_| None);
    let up = uphill(seed);
    let mut layout = world.layout;
    layout.relief = Relief::from_fn(Extent::WINDOW, |p| grade * up.dot(p));
    let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
    let world = World::new(layout, boxes, seed);
    let rig = SensorRig::default();
    labels(&world, &rig.lidars[0], &Drive::default(), Vertical::Occ3d, seed)
}

/// A grid with its columns moved up and down to a plane, by whole bins; voxels that leave the grid are lost.
fn tilted(grid: &VoxelGrid, grade: f64, up: DVec2) -> VoxelGrid {
    let mut out = VoxelGrid::new();
    for (x, y) in (0..Window::NX).flat_map(|x| (0..Window::NY).map(move |y| (x, y))) {
        let rise_m = grade * up.dot(Window::center(x, y, 0).truncate());
        let bins = (rise_m / Window::VOXEL_M).round() as isize;
        let from = grid.column(x, y);
        *out.window_column_mut(x, y) = std::array::from_fn(|z| {
            let z = usize::try_from(z as isize - bins).ok();
            z.and_then(|z| from.get(z).copied()).unwrap_or(Class::Free as u8)
        });
    }
    out
}

impl Slopes {
    /// Adds a held-out world.
    pub(super) fn add_world(&mut self, vae: &OccVae, seed: u64, index: u64) -> anyhow::Result<()> {
        for (grade, kept) in GRADES.into_iter().zip(&mut self.0) {
            let truth = labels_on(grade, seed, index);
            kept.add(&truth, &vae.decode(&vae.encode(&truth)?)?);
        }
        Ok(())
    }

    /// Adds labels of a file, tilted here.
    pub(super) fn add_tilted(&mut self, vae: &OccVae, labels: &VoxelGrid, seed: u64) -> anyhow::Result<()> {
        for (grade, kept) in GRADES.into_iter().zip(&mut self.0) {
            let truth = tilted(labels, grade, uphill(seed));
            kept.add(&truth, &vae.decode(&vae.encode(&truth)?)?);
        }
        Ok(())
    }

    /// The largest loss of mIoU on a slope against level ground.
    pub(super) fn worst_loss(&self) -> f64 {
        let miou = |c: &Confusion| c.mean_iou().0.unwrap_or(f64::NAN);
        let level = miou(&self.0[0]);
        self.0[1..].iter().map(|c| level - miou(c)).fold(0.0, f64::max)
    }

    /// mIoU and IoU of each grade.
    pub(super) fn report(&self) -> Value {
        let row = |(grade, kept): (f64, &Confusion)| json!({ "grade_percent": grade * 100.0, "miou": kept.mean_iou().0, "iou": kept.occupied_iou(), "per_class": per_class(kept) });
        json!({
            "rows": GRADES.into_iter().zip(&self.0).map(row).collect::<Vec<_>>(),
            "worst_loss_of_miou": self.worst_loss(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tilting_moves_columns_and_nothing_else() {
        let mut grid = VoxelGrid::new();
        for (x, y) in [(0, 7), (100, 50), (199, 199)] {
            grid.set(x, y, 5, Class::Car as u8);
        }
        assert_eq!(tilted(&grid, 0.0, DVec2::X), grid);
        let found = tilted(&grid, 0.04, DVec2::X);
        // 40 m ahead at 4 % is 1.6 m, four bins.
        for (x, y, z) in [(0, 7, 1), (100, 50, 5), (199, 199, 9)] {
            assert_eq!(found.get(x, y, z), Class::Car as u8, "{x} {y}");
        }
        assert_eq!(found.count_set(), 3);
    }
}
