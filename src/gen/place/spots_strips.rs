//! Strips, areas and lines across the road where something may stand: edges, sidewalks, car parks, junctions.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::spots::Gather;
use scene::graph::LaneRole;
use scene::{BevLayer, Class};

impl Gather<'_, '_> {
    /// Adds places at the outer edge of the outermost lanes, in the direction of the lane.
    pub(super) fn edge(&mut self, role: LaneRole) {
        let surface = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
        let half = self.size_m.y / 2.0;
        for i in 0..self.map.points.len() {
            let l = self.map.points[i];
            if l.role == LaneRole::Cross && role != LaneRole::Roadside {
                continue;
            }
            for side in [-1.0, 1.0] {
                let out = l.dir.perp() * side;
                // How far the paved surface extends.
                let mut reach = 0.0;
                while reach < 9.5 && self.map.has(surface, l.p + out * (reach + 0.2)) {
                    reach += 0.2;
                }
                let blocked = reach >= 9.4 || reach < half;
                // Another lane lies between, so this is not the outermost.
                let inner = self.map.points.iter().any(|m| {
                    let d = m.p - l.p;
                    d.length_squared() < 36.0 && d.dot(out) > 2.0 && d.dot(l.dir).abs() < 1.0
                });
                if blocked || inner {
                    continue;
                }
                let left = self.map.course(l.p + out * reach).is_some_and(|c| c.1 > 0.0);
                let wanted = match role {
                    LaneRole::LeftRoadside => left,
                    LaneRole::RightRoadside => !left,
                    _ => true,
                };
                if !wanted {
                    continue;
                }
                let off = (reach - half - 0.15).max(0.0);
                let crosses = matches!(l.role, LaneRole::Cross);
                let old = self.base.cost;
                self.base.cost += if crosses { 0.7 } else { 0.0 };
                let (still, moves) = (self.base.still, self.base.moves);
                if off > 2.0 {
                    // Off the lane objects only stand.
                    (self.base.still, self.base.moves) = (true, false);
                }
                self.push(l.p + out * off, l.dir.to_angle());
                if still && self.either_way {
                    // parked against the traffic, if that facing was stated
                    self.base.cost += 0.5;
                    self.push(l.p + out * off, l.dir.to_angle() + PI);
                }
                (self.base.still, self.base.moves) = (still, moves);
                self.base.cost = old;
            }
        }
        if self.base.anywhere && self.out.is_empty() {
            self.verge();
        }
    }

    /// Adds places across a lane, beside one another, for cones and barriers.
    pub(super) fn across_lane(&mut self, role: LaneRole, class: Class) {
        let roadwide = matches!(role, LaneRole::Road);
        for i in 0..self.map.points.len() {
            let l = self.map.points[i];
            if !(roadwide || l.role == role) || l.p.length() < 5.0 {
                continue;
            }
            let offsets: &[f64] = if class == Class::Barrier {
                &[0.0]
            } else {
                &[0.0, -0.65, 0.65, -1.25, 1.25]
            };
            let behind = if l.p.x < 0.0 { 1.0 } else { 0.0 };
            for off in offsets {
                let old = self.base.cost;
                self.base.cost += behind;
                self.push(l.p + l.dir.perp() * *off, l.dir.to_angle());
                self.base.cost = old;
            }
        }
    }

    /// Adds places on the road, across the lane.
    pub(super) fn crosswise(&mut self, role: LaneRole) {
        for i in 0..self.map.points.len() {
            let l = self.map.points[i];
            if !matches!(role, LaneRole::Road) && l.role != role {
                continue;
            }
            for turn in [FRAC_PI_2, -FRAC_PI_2] {
                for off in [0.0, 1.5, -1.5] {
                    self.push(l.p + l.dir.perp() * off, l.dir.to_angle() + turn);
                }
            }
        }
    }

    pub(super) fn cells(&mut self, bits: u32, step: usize, yaw: impl Fn(DVec2) -> f64) {
        let extent = self.map.layout.extent();
        for x in (0..extent.nx()).step_by(step) {
            for y in (0..extent.ny()).step_by(step) {
                if self.map.layout.cell(x, y) & bits != 0 {
                    let p = extent.center(x, y, 0).truncate();
                    let jitter = DVec2::new(self.draw.range(-0.2, 0.2), self.draw.range(-0.2, 0.2));
                    self.push(p + jitter, yaw(p));
                }
            }
        }
    }

    pub(super) fn walks(&mut self) {
        let from = self.out.len();
        self.cells(BevLayer::Walkway.bit(), 2, |_| 0.0);
        for i in from..self.out.len() {
            let lane = self.map.nearest(self.out[i].p).map_or(0.0, |l| l.dir.to_angle());
            let turn = if self.base.still {
                -FRAC_PI_2
            } else if self.draw.chance(0.5) {
                0.0
            } else {
                PI
            };
            let jitter = self.draw.range(-0.2, 0.2);
            self.out[i].yaw_rad = lane + turn + jitter;
        }
    }

    /// Adds places on the road where the lanes meet; the nearer to the middle, the better.
    pub(super) fn amid_junction(&mut self) {
        let Some(center) = self.map.junction else {
            return;
        };
        let base = self.base;
        self.base.on_road = true;
        for ring in 0..9 {
            for k in 0..12 {
                self.base.cost = base.cost - 1.5 + 0.15 * f64::from(ring);
                let turn = DVec2::from_angle(f64::from(k) * PI / 6.0);
                self.push(center + turn * f64::from(ring), f64::from(k) * PI / 6.0);
            }
        }
        self.base = base;
    }

    pub(super) fn carpark(&mut self) {
        let lot = BevLayer::CarparkArea.bit();
        let from = self.out.len();
        self.cells(lot, 2, |_| 0.0);
        for i in from..self.out.len() {
            let nearest = self.map.nearest(self.out[i].p);
            let lane = nearest.map_or(0.0, |l| l.dir.to_angle());
            let beside = nearest.is_some_and(|l| l.p.distance(self.out[i].p) < 6.5);
            let turn = if beside {
                0.0
            } else {
                FRAC_PI_2 * (1.0 - 2.0 * self.draw.below(2) as f64)
            };
            self.out[i].yaw_rad = lane + turn;
        }
    }

    /// Adds places beside the road where there is no sidewalk.
    pub(super) fn verge(&mut self) {
        for i in 0..self.map.points.len() {
            let l = self.map.points[i];
            for side in [-1.0, 1.0] {
                let mut off = 2.0;
                while off < 14.0
                    && self
                        .map
                        .has(BevLayer::DrivableArea.bit(), l.p + l.dir.perp() * side * off)
                {
                    off += 0.4;
                }
                if off < 14.0 {
                    self.push(l.p + l.dir.perp() * side * (off + 0.8), l.dir.to_angle());
                }
            }
        }
    }
}
