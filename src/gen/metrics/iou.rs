//! Intersection over union of label grids, after Occ3D: free is excluded from the mean, and so is a class that neither
//! grid has. The number of classes present is given with the figure.

use scene::{Class, VoxelGrid, Window};

/// Voxels counted per pair of true and predicted label. Sums over frames, in u64 so that it never saturates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Confusion {
    counts: Vec<u64>, // [truth][prediction]
}

impl Default for Confusion {
    fn default() -> Self {
        Self {
            counts: vec![0; Class::COUNT * Class::COUNT],
        }
    }
}

impl Confusion {
    /// Counts every voxel of a pair of grids.
    pub fn add(&mut self, truth: &VoxelGrid, prediction: &VoxelGrid) {
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                for (t, p) in truth.column(x, y).iter().zip(prediction.column(x, y)) {
                    self.counts[*t as usize * Class::COUNT + *p as usize] += 1;
                }
            }
        }
    }

    /// Adds another count.
    pub fn merge(&mut self, other: &Confusion) {
        self.counts
            .iter_mut()
            .zip(&other.counts)
            .for_each(|(a, b)| *a += b);
    }

    /// IoU of occupied against free space; `None` if nothing is occupied in either.
    pub fn occupied_iou(&self) -> Option<f64> {
        let free = Class::Free as usize;
        let (mut both, mut either) = (0u64, 0u64);
        for t in 0..Class::COUNT {
            for p in 0..Class::COUNT {
                let n = self.counts[t * Class::COUNT + p];
                both += if t != free && p != free { n } else { 0 };
                either += if t != free || p != free { n } else { 0 };
            }
        }
        (either > 0).then(|| both as f64 / either as f64)
    }

    /// IoU of one class; `None` if it is absent from the truth and from the prediction.
    pub fn class_iou(&self, class: Class) -> Option<f64> {
        let c = class as usize;
        let truth: u64 = (0..Class::COUNT).map(|p| self.counts[c * Class::COUNT + p]).sum();
        let prediction: u64 = (0..Class::COUNT).map(|t| self.counts[t * Class::COUNT + c]).sum();
        let both = self.counts[c * Class::COUNT + c];
        let either = truth + prediction - both;
        (either > 0).then(|| both as f64 / either as f64)
    }

    /// Mean IoU over the classes present in the truth, free excluded, and the number of these classes.
    pub fn mean_iou(&self) -> (Option<f64>, usize) {
        let in_truth = |c: &Class| (0..Class::COUNT).any(|p| self.counts[*c as usize * Class::COUNT + p] > 0);
        let present = Class::ALL
            .into_iter()
            .filter(|c| *c != Class::Free)
            .filter(in_truth);
        let ious: Vec<f64> = present.filter_map(|c| self.class_iou(c)).collect();
        let n = ious.len();
        ((n > 0).then(|| ious.iter().sum::<f64>() / n as f64), n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row 58 of the extremes table.
    #[test]
    fn row_58_iou() {
        let mut grid = VoxelGrid::new();
        let mut count = Confusion::default();
        count.add(&grid, &grid);
        assert_eq!((count.occupied_iou(), count.mean_iou()), (None, (None, 0)));
        for i in 0..10 {
            grid.set(i, i, 0, Class::Car.id());
            grid.set(i, i + 20, 0, Class::Terrain.id());
        }
        let mut perfect = Confusion::default();
        perfect.add(&grid, &grid);
        assert_eq!(perfect.mean_iou(), (Some(1.0), 2));
        assert_eq!(perfect.occupied_iou(), Some(1.0));
        // Renaming classes in both grids changes no mean; an absent class stays out.
        let mut wrong = grid.clone();
        wrong.set(0, 0, 0, Class::Terrain.id());
        let mut a = Confusion::default();
        a.add(&grid, &wrong);
        let swap = |g: &VoxelGrid| {
            let swapped = g.to_dense().into_iter().map(|v| match v {
                4 => 14,
                14 => 4,
                v => v,
            });
            VoxelGrid::from_dense(&swapped.collect::<Vec<u8>>()).expect("640,000")
        };
        let mut b = Confusion::default();
        b.add(&swap(&grid), &swap(&wrong));
        assert_eq!(a.mean_iou(), b.mean_iou());
        assert_eq!(a.mean_iou().1, 2);
        assert!((a.class_iou(Class::Car).expect("present") - 0.9).abs() < 1e-12);
        assert_eq!(a.class_iou(Class::Bus), None);
    }

    /// Row 59 of the extremes table: a million frames of 640,000 voxels, by doubling.
    #[test]
    fn row_59_counters() {
        let mut count = Confusion::default();
        count.add(&VoxelGrid::new(), &VoxelGrid::new());
        for _ in 0..20 {
            let same = count.clone();
            count.merge(&same);
        }
        assert_eq!(count.counts.iter().sum::<u64>(), 640_000 << 20);
    }
}
