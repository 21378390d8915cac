//! Number of points of a sweep in each box, counted as by the development kits of data sets: faces included.

use std::collections::{BTreeMap, HashMap};

use glam::{DVec2, DVec3};

use crate::{BoxId, SceneBox};

/// Edge of a bin of points on the ground, m.
const BIN_M: f64 = 4.0;

/// Points, sorted into bins on the ground.
#[derive(Clone, Debug, Default)]
pub struct Returns {
    bins: HashMap<[i64; 2], Vec<DVec3>>,
}

impl Returns {
    /// Points in the frame of the boxes, m; points that are not finite are in no box.
    pub fn new(points_m: impl Iterator<Item = DVec3>) -> Self {
        let mut bins: HashMap<[i64; 2], Vec<DVec3>> = HashMap::new();
        for p in points_m.filter(|p| p.is_finite()) {
            bins.entry(bin_of(p.truncate())).or_default().push(p);
        }
        Self { bins }
    }

    /// Number of points in a box; 0 for a box that is not sound.
    pub fn within(&self, b: &SceneBox) -> u32 {
        if b.problem().is_some() {
            return 0;
        }
        let reach = DVec2::splat(b.size_m.truncate().length() / 2.0);
        let middle = b.center_m.truncate();
        let ([x0, y0], [x1, y1]) = (bin_of(middle - reach), bin_of(middle + reach));
        let bins = (x0..=x1).flat_map(|x| (y0..=y1).map(move |y| [x, y]));
        let points = bins.filter_map(|bin| self.bins.get(&bin)).flatten();
        points.filter(|p| b.contains(**p, 0.0)).count() as u32
    }

    /// Number of points in each box that has any.
    pub fn by_box<'a>(&self, boxes: impl Iterator<Item = &'a SceneBox>) -> BTreeMap<BoxId, u32> {
        let counts = boxes.map(|b| (b.id, self.within(b)));
        counts.filter(|(_, n)| *n > 0).collect()
    }
}

fn bin_of(p: DVec2) -> [i64; 2] {
    (p / BIN_M).floor().to_array().map(|v| v as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::SplitMix64;
    use crate::{BoxLabel, Class};

    #[test]
    fn counts_are_those_of_every_point_against_every_box() {
        let mut dice = SplitMix64::new(3);
        let mut unit = || dice.below(1_000_001) as f64 / 1e6 - 0.5;
        let points: Vec<DVec3> = (0..4000)
            .map(|_| DVec3::new(unit() * 40.0, unit() * 40.0, unit() * 4.0))
            .collect();
        let returns = Returns::new(points.iter().copied().chain([DVec3::NAN, DVec3::INFINITY]));
        let mut all = 0;
        for id in 0..40 {
            let b = SceneBox {
                id: BoxId(id),
                class: Class::Car,
                center_m: DVec3::new(unit() * 40.0, unit() * 40.0, 0.5),
                size_m: DVec3::new(1.0 + 20.0 * (unit() + 0.5), 2.0, 1.6),
                yaw_rad: unit() * 9.0,
                velocity_mps: DVec2::ZERO,
                label: BoxLabel::default(),
            };
            let plain = points.iter().filter(|p| b.contains(**p, 0.0)).count();
            assert_eq!(returns.within(&b) as usize, plain);
            assert_eq!(returns.by_box(std::iter::once(&b)).len(), usize::from(plain > 0));
            all += plain;
        }
        assert!(all > 200, "{all}");
    }
}
