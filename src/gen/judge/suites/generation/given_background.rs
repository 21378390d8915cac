//! Does generation follow a given background? Compares generated scenes with the world that the background came from.

use serde_json::{Value, json};

use crate::suite::with_interval;
use scene::{Class, VoxelGrid, Window};

/// Classes of the background and their names in the report.
const CLASSES: [(Class, &str); 2] = [(Class::Manmade, "manmade"), (Class::Vegetation, "vegetation")];

/// Figures scene by scene, for each of the classes.
#[derive(Default)]
pub struct Given {
    footprint_iou: [Vec<f64>; 2],
    height_within_a_voxel: [Vec<f64>; 2],
}

/// Highest bin of a class in a column.
fn top(grid: &VoxelGrid, column: usize, class: Class) -> Option<usize> {
    let labels = grid.column(column / Window::NY, column % Window::NY);
    labels.iter().rposition(|l| *l == class.id())
}

/// Two shares: columns with the class in both grids over columns with it in either, and those of the former whose tops
/// differ by at most a voxel.
fn followed(found: &VoxelGrid, truth: &VoxelGrid, class: Class) -> [Option<f64>; 2] {
    let [mut both, mut either, mut level] = [0u64; 3];
    for column in 0..Window::COLUMNS {
        let tops = [top(found, column, class), top(truth, column, class)];
        either += u64::from(tops.iter().any(Option::is_some));
        if let [Some(a), Some(b)] = tops {
            both += 1;
            level += u64::from(a.abs_diff(b) <= 1);
        }
    }
    let share = |part: u64, of: u64| (of > 0).then(|| part as f64 / of as f64);
    [share(both, either), share(level, both)]
}

impl Given {
    /// Adds a scene made from the background of `truth`.
    pub fn add(&mut self, found: &VoxelGrid, truth: &VoxelGrid) {
        for (i, (class, _)) in CLASSES.into_iter().enumerate() {
            let [iou, level] = followed(found, truth, class);
            self.footprint_iou[i].extend(iou);
            self.height_within_a_voxel[i].extend(level);
        }
    }

    /// Means with their intervals.
    pub fn report(&self) -> Value {
        let mut report = json!({});
        for (i, (_, name)) in CLASSES.into_iter().enumerate() {
            report[name] = json!({
                "footprint_iou": with_interval(&self.footprint_iou[i]),
                "height_within_a_voxel": with_interval(&self.height_within_a_voxel[i]),
            });
        }
        report
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn footprint_and_height_are_told_apart() {
        let mut truth = VoxelGrid::new();
        for x in 10..20 {
            (0..6).for_each(|z| truth.set(x, 30, z, Class::Manmade.id()));
        }
        assert_eq!(followed(&truth, &truth, Class::Manmade), [Some(1.0), Some(1.0)]);
        assert_eq!(followed(&truth, &truth, Class::Vegetation), [None, None]);
        let mut found = truth.clone();
        (0..6).for_each(|z| found.set(10, 30, z, Class::FREE)); // a column less
        found.set(11, 30, 6, Class::Manmade.id()); // a voxel higher: allowed
        (4..6).for_each(|z| found.set(12, 30, z, Class::FREE)); // two lower
        found.set(40, 40, 0, Class::Manmade.id()); // a column more
        let [iou, level] = followed(&found, &truth, Class::Manmade).map(|v| v.expect("columns"));
        assert!(
            (iou - 9.0 / 11.0).abs() < 1e-9 && (level - 8.0 / 9.0).abs() < 1e-9,
            "{iou} {level}"
        );
    }
}
