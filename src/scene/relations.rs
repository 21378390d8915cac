//! Meaning of each relation of a scene graph in metres: one predicate, used to describe scenes, to judge placements and
//! to make training data. Numbers that are not finite satisfy no relation.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::graph::{GraphEdge, LaneRole, Locked, NodeKind, RelationKind, SceneGraph};
use super::road_map::{CrossingArea, HALF_LANE_M, RoadMap, inside, outline_distance_m};
use super::{BevLayer, BoxId, BoxLabel, Class, SceneBox};

/// Highest speed at which an object counts as standing, m/s.
pub const STANDING_MPS: f64 = 0.5;
/// `near`: free space between the two at most this, m.
pub const NEAR_M: f64 = 6.0;
/// `next_to`: free space between the two at most this, m.
pub const NEXT_M: f64 = 3.5;
/// `far_from`: free space at least this, m.
pub const FAR_M: f64 = 20.0;
/// `following` and `blocking`: farthest that the other may be ahead, m.
pub const AHEAD_M: f64 = 40.0;
/// `waiting_at`: farthest before the area, m.
pub const WAIT_M: f64 = 8.0;
/// Radius of a junction, m.
pub const JUNCTION_M: f64 = 10.0;
/// A stated distance holds within this share of it, or within [`DISTANCE_SLACK_M`].
pub const DISTANCE_SHARE: f64 = 0.2;
/// See [`DISTANCE_SHARE`].
pub const DISTANCE_SLACK_M: f64 = 2.0;

/// The ego vehicle as a box; distances to it count from its origin (rear axle), not from this box's centre.
pub fn ego_box() -> SceneBox {
    SceneBox {
        id: BoxId(u32::MAX),
        class: Class::Car,
        center_m: DVec3::new(1.4, 0.0, 0.8),
        size_m: DVec3::new(4.6, 1.95, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    }
}

/// A graph with the places of its objects on a map.
pub struct PlacedGraph<'a> {
    /// The statements.
    pub graph: &'a SceneGraph,
    /// Boxes by node id.
    pub boxes: &'a BTreeMap<u32, SceneBox>,
    /// Map on which the boxes stand.
    pub road: &'a RoadMap,
}

/// Place or object on the map that a statement refers to.
enum RelationTarget<'a> {
    /// An object, or the ego vehicle: its box, and the point that distances count from.
    Thing(SceneBox, DVec2),
    Lane(LaneRole, Option<u32>),
    Area(&'a CrossingArea),
    Junction(DVec2),
}

impl PlacedGraph<'_> {
    /// True if the statement holds. With `distance_m`, the distance must be met too: within the larger of
    /// [`DISTANCE_SLACK_M`] and [`DISTANCE_SHARE`] of it.
    ///
    /// `d` is the vector from the other's centre, `fwd` and `lat` its parts along and across (left) the other's heading:
    /// - `in_front_of` (`behind`): `fwd` beyond its front (rear), `|lat|` at most the larger of 2 m and 0.6 |fwd|. Of an
    ///   area: between it and the ego vehicle or behind it, within 12 m.
    /// - `left_of`, `right_of`: `|lat|` beyond half its width, `|fwd|` at most the larger of half its length + 4 m and
    ///   2 |lat|; of a lane: beyond its border.
    /// - `near`, `next_to`, `far_from`: free space up to [`NEAR_M`], up to [`NEXT_M`], from [`FAR_M`].
    /// - `on`: centre in the lane (1.75 m from its middle), strip or area; of the ego vehicle: of its lane.
    ///   `parked_on`: the same, standing (for lanes within 3.5 m, so that the strip beside it counts).
    /// - `between`: centre within max(2 m, 0.35 of their distance) of the line between two centres, in its inner 80 %.
    /// - `across`: of a lane or the road: on it, at more than 50 degrees to it; else on the other side of the road.
    /// - `blocking`: standing, footprint within 1 m of a lane's middle; of the ego vehicle: of its lane ahead.
    /// - `facing`, `facing_away`: heading within 45 (beyond 135) degrees of the direction to the other.
    /// - `following`: behind it on its course (|lat| up to 2.2 m, 40 m), headings within 30 degrees.
    /// - `crossing`: on the road or a crossing, heading at 40 to 140 degrees to the lane there; of the ego vehicle: ahead
    ///   of it; of a crossing: on it (1 m grown).
    /// - `waiting_at`: standing, up to 8 m from the area and not on it (on the road: before it).
    /// - `same_direction`, `opposite_direction`: headings within 30 (beyond 150) degrees.
    pub fn satisfied(&self, edge: &GraphEdge) -> bool {
        self.check(edge).unwrap_or(false)
    }

    fn check(&self, edge: &GraphEdge) -> Option<bool> {
        let (from, _) = self.thing(edge.from)?;
        let sound = from.problem().is_none();
        let anchor = self.anchor(edge.to)?;
        let holds = match edge.relation {
            RelationKind::Between => {
                let (_, a) = self.thing(edge.to)?;
                let (_, b) = self.thing(edge.and?)?;
                between(from.center_m.truncate(), a, b)
            }
            relation => self.holds(relation, &from, &anchor),
        };
        let near_enough = edge.distance_m.is_none_or(|wanted| {
            let found = self.distance_m(edge.relation, &from, &anchor);
            (found - wanted).abs() <= DISTANCE_SLACK_M.max(DISTANCE_SHARE * wanted)
        });
        Some(sound && holds && near_enough)
    }

    /// Box and reference point of an object or the ego vehicle.
    pub fn thing(&self, id: u32) -> Option<(SceneBox, DVec2)> {
        match &self.graph.node(id)?.kind {
            NodeKind::Ego => Some((ego_box(), DVec2::ZERO)),
            NodeKind::Object(_) => {
                let b = match &self.graph.node(id)?.locked {
                    Some(Locked::Box(b)) => *self.boxes.get(&id).unwrap_or(b),
                    _ => *self.boxes.get(&id)?,
                };
                Some((b, b.center_m.truncate()))
            }
            _ => None,
        }
    }

    fn anchor(&self, id: u32) -> Option<RelationTarget<'_>> {
        Some(match &self.graph.node(id)?.kind {
            NodeKind::Ego | NodeKind::Object(_) => {
                let (b, at) = self.thing(id)?;
                if b.problem().is_some() {
                    return None;
                }
                RelationTarget::Thing(b, at)
            }
            NodeKind::Lane { role, polyline } => RelationTarget::Lane(*role, *polyline),
            NodeKind::Crossing { polyline } => RelationTarget::Area(crossing_of(self.road, *polyline)?),
            NodeKind::Junction => RelationTarget::Junction(*self.road.junctions_m.first()?),
        })
    }

    fn holds(&self, relation: RelationKind, from: &SceneBox, anchor: &RelationTarget<'_>) -> bool {
        let standing = from.velocity_mps.length() <= STANDING_MPS;
        let p = from.center_m.truncate();
        match anchor {
            RelationTarget::Thing(to, at) => self.to_thing(relation, from, to, *at),
            RelationTarget::Lane(role, polyline) => self.to_lane(relation, from, *role, *polyline),
            RelationTarget::Area(_) | RelationTarget::Junction(_) => {
                let (distance, center) = self.area(anchor, p);
                let on = distance <= 0.0;
                let ahead = self.road.ego_direction(center).dot(p - center);
                let lateral = self.road.ego_direction(center).perp_dot(p - center);
                match relation {
                    RelationKind::InFrontOf => !on && ahead < 0.0 && distance <= 12.0,
                    RelationKind::Behind => !on && ahead > 0.0 && distance <= 12.0,
                    RelationKind::LeftOf => !on && lateral > 0.0 && distance <= 12.0,
                    RelationKind::RightOf => !on && lateral < 0.0 && distance <= 12.0,
                    RelationKind::Near => distance <= NEAR_M,
                    RelationKind::NextTo => !on && distance <= NEXT_M,
                    RelationKind::FarFrom => distance >= FAR_M,
                    RelationKind::On => on,
                    RelationKind::ParkedOn => on && standing,
                    RelationKind::Blocking => {
                        standing
                            && from
                                .footprint()
                                .iter()
                                .chain([&p])
                                .any(|c| self.area(anchor, *c).0 <= 0.0)
                    }
                    RelationKind::Crossing => {
                        distance <= 1.0 && (self.crosswise(from) || from.class == Class::Pedestrian)
                    }
                    RelationKind::WaitingAt => {
                        let before = heading(from).dot(center - p) > 0.0;
                        let on_road = self.road.has(BevLayer::DrivableArea, p);
                        let reach = distance - from.size_m.x / 2.0;
                        standing && !on && reach <= WAIT_M && (before || !on_road)
                    }
                    RelationKind::Across => {
                        let side = |p| self.road.along_ego_lane(p).y > self.road.middle_m;
                        side(p) != side(DVec2::ZERO)
                    }
                    RelationKind::Facing => heading(from).dot((center - p).normalize_or_zero()) > 0.707,
                    RelationKind::FacingAway => heading(from).dot((center - p).normalize_or_zero()) < -0.707,
                    _ => false,
                }
            }
        }
    }

    /// Distance to an area (0 or less: on it) and its middle.
    fn area(&self, anchor: &RelationTarget<'_>, p: DVec2) -> (f64, DVec2) {
        match anchor {
            RelationTarget::Area(c) => (outline_distance_m(&c.outline_m, p), c.center_m),
            RelationTarget::Junction(center) => (p.distance(*center) - JUNCTION_M, *center),
            _ => (f64::NAN, p),
        }
    }

    fn to_thing(&self, relation: RelationKind, from: &SceneBox, to: &SceneBox, at: DVec2) -> bool {
        let p = from.center_m.truncate();
        let (axis, d) = (course(to), p - to.center_m.truncate());
        let (fwd, lat) = (axis.dot(d), axis.perp_dot(d));
        let half = to.size_m.truncate() / 2.0;
        let standing = from.velocity_mps.length() <= STANDING_MPS;
        let gap = || gap_m(from, to);
        let cosine = || heading(from).dot(heading(to));
        let toward = || heading(from).dot((at - p).normalize_or_zero());
        match relation {
            RelationKind::InFrontOf => fwd > half.x && lat.abs() <= (0.6 * fwd).max(2.0),
            RelationKind::Behind => -fwd > half.x && lat.abs() <= (0.6 * -fwd).max(2.0),
            RelationKind::LeftOf => lat > half.y && fwd.abs() <= (2.0 * lat).max(half.x + 4.0),
            RelationKind::RightOf => -lat > half.y && fwd.abs() <= (-2.0 * lat).max(half.x + 4.0),
            RelationKind::Near => gap() <= NEAR_M,
            RelationKind::NextTo => gap() <= NEXT_M,
            RelationKind::FarFrom => gap() >= FAR_M,
            RelationKind::On => to.id == ego_box().id && self.road.in_role(LaneRole::Ego, p),
            RelationKind::ParkedOn => {
                standing && to.id == ego_box().id && self.road.in_role(LaneRole::Ego, p)
            }
            RelationKind::Across => {
                let side = |p| self.road.along_ego_lane(p).y > self.road.middle_m;
                side(p) != side(at)
            }
            RelationKind::Blocking => {
                let ahead = fwd > half.x && fwd <= AHEAD_M;
                let lane = self.road.nearest_lane(at).filter(|l| l.distance_m < 2.5);
                let on_course = match lane.filter(|l| l.direction.dot(axis) > 0.5) {
                    Some(lane) => self.covers_lane(from, lane.lane),
                    None => covers(from, |c| axis.perp_dot(c - to.center_m.truncate()), 1.0),
                };
                standing && ahead && on_course
            }
            RelationKind::Facing => toward() > 0.707,
            RelationKind::FacingAway => toward() < -0.707,
            RelationKind::Following => fwd < 0.0 && lat.abs() <= 2.2 && gap() <= AHEAD_M && cosine() > 0.866,
            RelationKind::Crossing => {
                let ahead = fwd > half.x && fwd <= AHEAD_M;
                let angle = heading(from).dot(axis).abs() < 0.766;
                let on = self.road.from_road_m(p) < 0.4 || self.road.has(BevLayer::PedCrossing, p);
                ahead && angle && on && lat.abs() < 15.0
            }
            RelationKind::WaitingAt => standing && gap() <= WAIT_M,
            RelationKind::SameDirection => cosine() > 0.866,
            RelationKind::OppositeDirection => cosine() < -0.866,
            RelationKind::Between => false,
        }
    }

    fn to_lane(
        &self,
        relation: RelationKind,
        from: &SceneBox,
        role: LaneRole,
        polyline: Option<u32>,
    ) -> bool {
        let p = from.center_m.truncate();
        let standing = from.velocity_mps.length() <= STANDING_MPS;
        let lanes = || self.lanes(role, polyline);
        let nearest = || {
            let hits = lanes().filter_map(|i| self.road.on_lane(i, p));
            hits.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
        };
        let on = || match polyline {
            Some(_) => nearest().is_some_and(|l| l.distance_m <= HALF_LANE_M),
            None => self.road.in_role(role, p),
        };
        let direction = || {
            nearest()
                .or_else(|| self.road.nearest_lane(p))
                .map(|l| l.direction)
        };
        let cosine = || direction().map_or(f64::NAN, |d| d.dot(heading(from)));
        let distance = || match (is_strip(role), nearest()) {
            (false, Some(lane)) => (lane.distance_m - HALF_LANE_M).max(0.0),
            _ if on() => 0.0,
            _ => self.strip_distance_m(role, p),
        };
        match relation {
            RelationKind::On => on(),
            RelationKind::ParkedOn => standing && (on() || (!is_strip(role) && distance() <= 1.75)),
            RelationKind::LeftOf => !on() && nearest().is_some_and(|l| l.offset_m > HALF_LANE_M),
            RelationKind::RightOf => !on() && nearest().is_some_and(|l| l.offset_m < -HALF_LANE_M),
            RelationKind::Near => distance() <= NEAR_M,
            RelationKind::NextTo => !on() && distance() <= NEXT_M,
            RelationKind::FarFrom => distance() >= FAR_M,
            RelationKind::Across => on() && cosine().abs() < 0.643,
            RelationKind::Blocking => standing && lanes().any(|i| self.covers_lane(from, i)),
            RelationKind::Crossing => {
                let near = matches!(role, LaneRole::Road) || distance() <= 3.0;
                near && self.crosswise(from)
            }
            RelationKind::WaitingAt => standing && distance() <= WAIT_M,
            RelationKind::SameDirection | RelationKind::Following => cosine() > 0.866,
            RelationKind::OppositeDirection => cosine() < -0.866,
            RelationKind::Facing => {
                nearest().is_some_and(|l| heading(from).dot((l.position_m - p).normalize_or_zero()) > 0.707)
            }
            RelationKind::FacingAway => {
                nearest().is_some_and(|l| heading(from).dot((l.position_m - p).normalize_or_zero()) < -0.707)
            }
            RelationKind::InFrontOf | RelationKind::Behind | RelationKind::Between => false,
        }
    }

    fn lanes(&self, role: LaneRole, polyline: Option<u32>) -> impl Iterator<Item = usize> {
        self.road
            .lanes_of(role)
            .chain(
                0..if polyline.is_some() {
                    self.road.lanes.len()
                } else {
                    0
                },
            )
            .filter(move |i| polyline.is_none_or(|line| self.road.lanes[*i].polyline == line))
    }

    fn strip_distance_m(&self, role: LaneRole, p: DVec2) -> f64 {
        match role {
            LaneRole::Carpark => self.road.from_area_m(1, p).max(0.0),
            LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk => {
                self.road.from_area_m(2, p).max(0.0)
            }
            _ => self.road.from_road_m(p).abs(),
        }
    }

    /// On the road or a crossing, at 40 to 140 degrees to the lane there.
    fn crosswise(&self, from: &SceneBox) -> bool {
        let p = from.center_m.truncate();
        let on = self.road.from_road_m(p) < 0.4 || self.road.has(BevLayer::PedCrossing, p);
        let lane = self.road.nearest_lane(p);
        on && lane.is_some_and(|l| l.direction.dot(heading(from)).abs() < 0.766)
    }

    fn covers_lane(&self, from: &SceneBox, lane: usize) -> bool {
        let near = self.road.on_lane(lane, from.center_m.truncate());
        let Some(near) = near.filter(|l| l.distance_m < from.size_m.truncate().length() / 2.0 + 1.0) else {
            return false;
        };
        // The end of a lane is not one of its sides.
        covers(from, |c| near.direction.perp_dot(c - near.position_m), 1.0)
            && near
                .direction
                .dot(from.center_m.truncate() - near.position_m)
                .abs()
                < 1.0 + from.size_m.x / 2.0
    }

    /// The distance that `distance_m` of a statement refers to.
    fn distance_m(&self, relation: RelationKind, from: &SceneBox, anchor: &RelationTarget<'_>) -> f64 {
        let p = from.center_m.truncate();
        match anchor {
            RelationTarget::Thing(to, at) => {
                let (axis, d) = (course(to), p - *at);
                match relation {
                    RelationKind::InFrontOf | RelationKind::Behind | RelationKind::Following => {
                        axis.dot(d).abs()
                    }
                    RelationKind::LeftOf | RelationKind::RightOf => axis.perp_dot(d).abs(),
                    _ => d.length(),
                }
            }
            RelationTarget::Lane(role, polyline) => {
                let hits = self
                    .lanes(*role, *polyline)
                    .filter_map(|i| self.road.on_lane(i, p));
                let nearest = hits.map(|l| l.distance_m).fold(f64::INFINITY, f64::min);
                if is_strip(*role) {
                    self.strip_distance_m(*role, p)
                } else {
                    nearest
                }
            }
            _ => self.area(anchor, p).0.max(0.0),
        }
    }
}

/// The crossing of that polyline; else the nearest ahead of the ego vehicle, else the nearest.
pub fn crossing_of(road: &RoadMap, polyline: Option<u32>) -> Option<&CrossingArea> {
    match polyline {
        Some(line) => road.crossings.iter().find(|c| c.polyline == line),
        None => {
            let ahead = road
                .crossings
                .iter()
                .find(|c| road.along_ego_lane(c.center_m).x > 0.0);
            ahead.or(road.crossings.first())
        }
    }
}

fn is_strip(role: LaneRole) -> bool {
    !matches!(
        role,
        LaneRole::Ego
            | LaneRole::Left
            | LaneRole::Right
            | LaneRole::Oncoming
            | LaneRole::Cross
            | LaneRole::Road
    )
}

fn heading(b: &SceneBox) -> DVec2 {
    b.heading()
}

/// The heading that left, right, front and behind of a box count from: its own, or the ego vehicle's for things
/// without a course.
pub fn course(b: &SceneBox) -> DVec2 {
    match b.class {
        Class::Pedestrian | Class::TrafficCone | Class::Barrier => DVec2::X,
        _ => b.heading(),
    }
}

fn between(p: DVec2, a: DVec2, b: DVec2) -> bool {
    let d = b - a;
    let length = d.length();
    let t = (p - a).dot(d) / (length * length);
    let off = d.perp_dot(p - a).abs() / length;
    (0.1..=0.9).contains(&t) && off <= (0.35 * length).max(2.0)
}

/// True if the footprint comes within `half_m` of offset 0.
fn covers(b: &SceneBox, offset: impl Fn(DVec2) -> f64, half_m: f64) -> bool {
    let offsets = b.footprint().map(offset);
    let low = offsets.iter().copied().fold(f64::INFINITY, f64::min);
    let high = offsets.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    low <= half_m && high >= -half_m
}

/// Free space between two footprints, m; 0 if they touch or overlap.
pub fn gap_m(a: &SceneBox, b: &SceneBox) -> f64 {
    if overlap_m(a, b) > 0.0 {
        return 0.0;
    }
    let corner = |from: &SceneBox, to: &SceneBox| {
        let outline = to.footprint();
        let distances = from.footprint().map(|c| outline_distance_m(&outline, c));
        distances.into_iter().fold(f64::INFINITY, f64::min)
    };
    corner(a, b).min(corner(b, a))
}

/// How deep two footprints overlap, m: the least shift that would part them (separating axes); 0 or less if apart.
/// Minus infinity for boxes that are not finite.
pub fn overlap_m(a: &SceneBox, b: &SceneBox) -> f64 {
    let d = (b.center_m - a.center_m).truncate();
    let reach = |x: &SceneBox, axis: DVec2| {
        let h = x.heading();
        (x.size_m.x * h.dot(axis).abs() + x.size_m.y * h.perp_dot(axis).abs()) / 2.0
    };
    let axes = [a.heading(), a.heading().perp(), b.heading(), b.heading().perp()];
    let depths = axes.map(|axis| reach(a, axis) + reach(b, axis) - d.dot(axis).abs());
    let least = depths.into_iter().fold(f64::INFINITY, f64::min);
    if depths.iter().all(|v| v.is_finite()) {
        least
    } else {
        f64::NEG_INFINITY
    }
}

/// True if the point lies in the crossing.
pub fn on_crossing(crossing: &CrossingArea, p: DVec2) -> bool {
    inside(&crossing.outline_m, p)
}

#[cfg(test)]
#[path = "relations_tests.rs"]
mod tests;
