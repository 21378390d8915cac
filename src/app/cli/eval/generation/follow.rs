//! Does what stands beside the road follow the road, or only the seed? Manmade of one seed on two roads, and of one road
//! from two seeds, compared voxel by voxel.

use serde_json::{Value, json};

use crate::app::cli::eval::with_interval;
use crate::generation::metrics::iou::Confusion;
use crate::scene::{Class, VoxelGrid};

/// Scenes of some roads, each from a seed of its own and from one seed for all.
#[derive(Default)]
pub struct Follow {
    own: Vec<VoxelGrid>,
    common: Vec<VoxelGrid>,
}

fn manmade_iou(a: &VoxelGrid, b: &VoxelGrid) -> Option<f64> {
    let mut count = Confusion::default();
    count.add(a, b);
    count.class_iou(Class::Manmade)
}

impl Follow {
    /// One road from both seeds.
    pub fn add(&mut self, own: VoxelGrid, common: VoxelGrid) {
        self.own.push(own);
        self.common.push(common);
    }

    /// Frames taken in.
    pub fn len(&self) -> usize {
        self.own.len()
    }

    /// 1 - IoU of what is occupied from two seeds, road by road.
    pub fn diversity(&self) -> Vec<f64> {
        let pairs = self.own.iter().zip(&self.common);
        let each = pairs.filter_map(|(a, b)| {
            let mut same = Confusion::default();
            same.add(a, b);
            Some(1.0 - same.occupied_iou()?)
        });
        each.collect()
    }

    /// Both figures; null where there are not two roads.
    pub fn report(&self) -> Value {
        let pairs = self.own.iter().zip(&self.common);
        let road: Vec<f64> = pairs.filter_map(|(a, b)| manmade_iou(a, b)).collect();
        // Every pair of neighbours in the order of the roads, each road in two of them.
        let seed: Vec<f64> = self
            .common
            .windows(2)
            .filter_map(|p| manmade_iou(&p[0], &p[1]))
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
