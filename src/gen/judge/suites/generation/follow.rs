//! Does the scenery follow the road, or only the seed? Manmade voxels of one seed on two roads, and of one road from
//! two seeds, are compared voxel by voxel.

use serde_json::{Value, json};

use crate::suite::with_interval;
use metrics::iou::Confusion;
use scene::{BevLayer, BevLayout, Class, VoxelGrid, Window};

/// Scenes of some roads: each from a seed of its own, and from one seed common to all.
#[derive(Default)]
pub struct Follow {
    unpaved: Vec<Vec<bool>>,
    own: Vec<VoxelGrid>,
    common: Vec<VoxelGrid>,
}

/// Columns beside road, car park and walkway, `[x][y]`.
fn unpaved(layout: &BevLayout) -> Vec<bool> {
    let paved = [
        BevLayer::DrivableArea,
        BevLayer::CarparkArea,
        BevLayer::Walkway,
        BevLayer::PedCrossing,
    ];
    let bits: u32 = paved.into_iter().map(BevLayer::bit).sum();
    layout.cells().iter().map(|cell| cell & bits == 0).collect()
}

/// IoU of the manmade voxels in the columns that are unpaved on both roads: leaving roads free earns nothing.
fn manmade_iou(a: &VoxelGrid, b: &VoxelGrid, free: [&[bool]; 2]) -> Option<f64> {
    let (mut both, mut either) = (0u64, 0u64);
    for c in (0..Window::COLUMNS).filter(|c| free[0][*c] && free[1][*c]) {
        let column = |grid: &VoxelGrid| *grid.window_column(c / Window::NY, c % Window::NY);
        for (a, b) in column(a).into_iter().zip(column(b)) {
            let [a, b] = [a, b].map(|l| l == Class::Manmade.id());
            both += u64::from(a && b);
            either += u64::from(a || b);
        }
    }
    (either > 0).then(|| both as f64 / either as f64)
}

impl Follow {
    /// Adds a road, generated from its own seed and from the common one.
    pub fn add(&mut self, layout: &BevLayout, own: VoxelGrid, common: VoxelGrid) {
        self.unpaved.push(unpaved(layout));
        self.own.push(own);
        self.common.push(common);
    }

    /// Frames taken in.
    pub fn len(&self) -> usize {
        self.own.len()
    }

    /// 1 - IoU of the occupied voxels from two seeds, road by road.
    pub fn diversity(&self) -> Vec<f64> {
        let pairs = self.own.iter().zip(&self.common);
        let each = pairs.filter_map(|(a, b)| {
            let mut same = Confusion::default();
            same.add(a, b);
            Some(1.0 - same.occupied_iou()?)
        });
        each.collect()
    }

    /// The two figures; null if there are fewer than two roads.
    pub fn report(&self) -> Value {
        let free = |i: usize, j: usize| [self.unpaved[i].as_slice(), self.unpaved[j].as_slice()];
        let road: Vec<f64> = (0..self.len())
            .filter_map(|i| manmade_iou(&self.own[i], &self.common[i], free(i, i)))
            .collect();
        // Every pair of neighbours in the order of the roads, so a road is in up to two pairs.
        let seed: Vec<f64> = (1..self.len())
            .filter_map(|i| manmade_iou(&self.common[i - 1], &self.common[i], free(i - 1, i)))
            .collect();
        if seed.is_empty() || road.is_empty() {
            return Value::Null;
        }
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        json!({
            "same_seed_other_road_manmade_iou": with_interval(&seed),
            "same_road_other_seed_manmade_iou": with_interval(&road),
            "follows_the_road": mean(&road) > mean(&seed),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of houses beside the road, or at a place that the seed chooses, whatever the road.
    fn scene(road: usize, seed: usize, follows: bool) -> (BevLayout, VoxelGrid) {
        let (mut layout, mut grid) = (BevLayout::default(), VoxelGrid::new());
        for x in 0..Window::NX {
            for y in 0..20 {
                layout.set(BevLayer::DrivableArea, x, road + y, true);
                let house = if follows { road + 24 } else { seed } + y;
                if house < road || house >= road + 20 {
                    grid.column_mut(x, house)[..9].fill(Class::Manmade.id());
                }
            }
        }
        (layout, grid)
    }

    #[test]
    fn what_follows_the_road_is_told_from_what_follows_the_seed() {
        for follows in [true, false] {
            let mut follow = Follow::default();
            for (i, road) in [60, 80, 100].into_iter().enumerate() {
                let (layout, own) = scene(road, 10 + 3 * i, follows);
                follow.add(&layout, own, scene(road, 150, follows).1);
            }
            let report = follow.report();
            assert_eq!(report["follows_the_road"], follows, "{report}");
            let other = if follows {
                "same_road_other_seed"
            } else {
                "same_seed_other_road"
            };
            assert_eq!(report[format!("{other}_manmade_iou")]["mean"], 1.0);
        }
        assert_eq!(Follow::default().report(), Value::Null);
    }
}
