//! Speed limits along the lanes of a layout, found by place.

use std::collections::HashMap;

use glam::DVec2;

use super::{BevLayout, PolylineKind};

/// Distance beyond the map up to which lines are followed, m.
const AROUND_M: f64 = 100.0;
/// Side of a cell of the index, m.
const CELL_M: f64 = 8.0;

/// The lines of a layout that carry speed limits, indexed by place.
#[derive(Clone, Debug, Default)]
pub struct SpeedLimits {
    segments: Vec<([DVec2; 2], u32)>, // ends, mm/s
    cells: HashMap<[i64; 2], Vec<usize>>,
}

impl SpeedLimits {
    /// The limits of a layout. Vertices that are not finite, or far beyond the map, are left out.
    pub fn from_layout(layout: &BevLayout) -> Self {
        let mut out = Self::default();
        let extent = layout.extent();
        let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
        let (low, high) = (low - AROUND_M, high + AROUND_M);
        for line in layout.polylines.iter() {
            let PolylineKind::SpeedLimit { mm_per_s } = line.kind else {
                continue;
            };
            for ends in line.points_m.windows(2) {
                let near = |p: &DVec2| p.is_finite() && p.cmpge(low).all() && p.cmple(high).all();
                if ends.iter().all(near) {
                    out.add([ends[0], ends[1]], mm_per_s);
                }
            }
        }
        out
    }

    fn add(&mut self, ends: [DVec2; 2], mm_per_s: u32) {
        let index = self.segments.len();
        self.segments.push((ends, mm_per_s));
        let steps = (ends[0].distance(ends[1]) / (0.5 * CELL_M)).ceil().max(1.0);
        for i in 0..=steps as usize {
            let cell = cell(ends[0].lerp(ends[1], i as f64 / steps));
            let held = self.cells.entry(cell).or_default();
            if held.last() != Some(&index) {
                held.push(index);
            }
        }
    }

    /// The limit of the nearest line within `reach_m` (at most half a cell of the index, 4 m) of a place, m/s.
    pub fn at_mps(&self, at_m: DVec2, reach_m: f64) -> Option<f64> {
        let [x, y] = cell(at_m);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        let near = around.filter_map(|c| self.cells.get(&c)).flatten();
        let found = near.map(|i| {
            let (ends, mm_per_s) = self.segments[*i];
            (distance_m(ends, at_m), mm_per_s)
        });
        let nearest = found.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest
            .filter(|(away_m, _)| *away_m <= reach_m)
            .map(|(_, mm_per_s)| f64::from(mm_per_s) / 1000.0)
    }
}

fn cell(p: DVec2) -> [i64; 2] {
    [p.x, p.y].map(|v| (v / CELL_M).floor() as i64)
}

fn distance_m([a, b]: [DVec2; 2], p: DVec2) -> f64 {
    let along = b - a;
    let length2 = along.length_squared();
    let t = if length2 > 0.0 {
        (p - a).dot(along) / length2
    } else {
        0.0
    };
    p.distance(a + along * t.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Polyline;

    fn limit(kph: f64, points: &[[f64; 2]]) -> Polyline {
        Polyline {
            kind: PolylineKind::SpeedLimit {
                mm_per_s: (kph / 0.0036).round() as u32,
            },
            points_m: points.iter().map(|p| DVec2::from(*p)).collect(),
        }
    }

    #[test]
    fn the_nearest_limit_counts_and_only_near_its_line() {
        let mut layout = BevLayout::default();
        let lines = [
            limit(50.0, &[[-38.0, 0.0], [0.0, 0.0], [0.0, 0.0], [38.0, 0.0]]),
            limit(30.0, &[[-38.0, 3.5], [38.0, 3.5]]),
            limit(80.0, &[[f64::NAN, 0.0], [1e12, 0.0]]),
        ];
        layout.polylines = lines.to_vec().into();
        let limits = SpeedLimits::from_layout(&layout);
        let kph = |x: f64, y: f64| limits.at_mps(DVec2::new(x, y), 2.0).map(|v| (v * 3.6).round());
        assert_eq!(kph(10.3, 1.0), Some(50.0));
        assert_eq!(kph(-30.0, 2.5), Some(30.0));
        assert_eq!(kph(5.0, -1.99), Some(50.0));
        assert_eq!(kph(5.0, -2.1), None);
        assert_eq!(kph(f64::NAN, 0.0), None);
        assert_eq!(SpeedLimits::default().at_mps(DVec2::ZERO, 2.0), None);
    }
}
