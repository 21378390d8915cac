//! A street that is drawn along the middle of its carriageway.

use glam::DVec2;

use scene::roads::{LaneKind, RoadChange, RoadLane, curve};

/// Lanes and widths of a street.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Street {
    /// Lanes in the direction in which it is drawn, right of the line that parts the directions.
    pub forward: usize,
    /// Lanes against it; 0 makes it one-way.
    pub backward: usize,
    /// Width of a lane, m.
    pub lane_m: f64,
    /// Width of the walkway on either side, m; 0 means none.
    pub walk_m: f64,
}

impl Default for Street {
    fn default() -> Self {
        Self {
            forward: 1,
            backward: 1,
            lane_m: 3.5,
            walk_m: 0.0,
        }
    }
}

impl Street {
    /// Most lanes of one direction.
    pub const MAX_LANES: usize = 6;
    /// Limits of the width of a lane, m.
    pub const LANE_M: std::ops::RangeInclusive<f64> = 2.0..=6.0;

    /// Width of the carriageway, m.
    pub fn width_m(&self) -> f64 {
        (self.forward + self.backward) as f64 * self.lane_m
    }

    /// The change that lays it along the middle of its carriageway (world frame, m); `None` for fewer than two distinct
    /// points, or no lane.
    pub fn along(&self, middle_m: &[DVec2]) -> Option<RoadChange> {
        let middle_m = curve::distinct(middle_m);
        if middle_m.len() < 2 || self.forward + self.backward == 0 {
            return None;
        }
        let side = |count: usize| {
            let drive = RoadLane {
                kind: LaneKind::Drive,
                width_m: self.lane_m,
            };
            let walk = RoadLane {
                kind: LaneKind::Walk,
                width_m: self.walk_m,
            };
            let mut lanes = vec![drive; count];
            if self.walk_m >= *scene::Road::LANE_M.start() {
                lanes.push(walk);
            }
            lanes
        };
        let left_m = (self.forward as f64 - self.backward as f64) * self.lane_m / 2.0;
        Some(RoadChange::Add {
            points_m: curve::beside(&middle_m, left_m),
            left: side(self.backward),
            right: side(self.forward),
            limit_kph: None,
        })
    }
}
