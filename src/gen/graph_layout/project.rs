//! Repairs violations of physics or of statements in a placement, and changes nothing else: overlaps, vehicles off the
//! road or outside the map, moving vehicles across their lane, stated relations that do not hold. Every object moves to
//! the nearest sound place; the distance is reported. Deterministic, at most [`ROUNDS`] rounds of [`CANDIDATES`] tries
//! each.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use serde::Serialize;

use scene::graph::{GraphEdge, ObjectState, RelationKind, SceneGraph};
use scene::relations::{PlacedGraph, ego_box, overlap_m};
use scene::road_map::RoadMap;
use scene::{BevLayer, Class, SceneBox};

/// Rounds over all objects.
pub const ROUNDS: usize = 3;
/// Most places that are tried for one object in one round.
pub const CANDIDATES: usize = 3000;
/// Free space that is kept around a box, m.
const MARGIN_M: f64 = 0.1;
/// Half of the map that boxes may cover, m.
const REACH_M: f64 = 39.5;
/// Largest deviation of a moving vehicle's heading from its lane's direction: cosine of 12 degrees.
const ALONG: f64 = 0.978;

/// Move of an object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moved {
    /// Node.
    pub id: u32,
    /// Distance between its first place and its present one, m.
    pub distance_m: f64,
    /// Turn, rad, absolute.
    pub turned_rad: f64,
}

/// Repairs that the projection made, and problems that remain.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Projection {
    /// Objects that were moved or turned, in the order of their ids.
    pub moved: Vec<Moved>,
    /// Objects for which no place was left: they are removed, rather than overlap another.
    pub dropped: Vec<u32>,
    /// Statements that do not hold.
    pub broken: Vec<GraphEdge>,
    /// Number of statements that were judged.
    pub stated: usize,
}

impl Projection {
    /// Mean distance moved over `objects` objects, m.
    pub fn mean_move_m(&self, objects: usize) -> f64 {
        self.moved.iter().map(|m| m.distance_m).sum::<f64>() / objects.max(1) as f64
    }
}

/// Faults of one object at one place; the fewer the better.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Fault {
    physics: usize,
    statements: usize,
}

struct Repair<'a> {
    graph: &'a SceneGraph,
    road: &'a RoadMap,
    boxes: BTreeMap<u32, SceneBox>,
    locked: BTreeSet<u32>,
    /// Statements that name a node.
    about: BTreeMap<u32, Vec<GraphEdge>>,
    /// Faults that a search through all places could not repair: it is not repeated unless they become worse.
    exhausted: BTreeMap<u32, Fault>,
}

/// Repairs `boxes` (by node id) in place. Boxes of `locked` nodes never move; boxes that are not finite count as standing
/// at the ego vehicle's place, and so are moved.
pub fn project(
    graph: &SceneGraph,
    road: &RoadMap,
    boxes: &mut BTreeMap<u32, SceneBox>,
    locked: &BTreeSet<u32>,
) -> Projection {
    let mut clean = BTreeMap::new();
    for (id, b) in boxes.iter() {
        let mut b = *b;
        if !locked.contains(id) && b.problem().is_some() {
            let typical = b.class.typical_size_m().unwrap_or([1.0; 3]).into();
            b = SceneBox {
                size_m: typical,
                ..ego_box()
            };
            (b.id, b.class) = (boxes[id].id, boxes[id].class);
            b.center_m.z = b.size_m.z / 2.0;
        }
        clean.insert(*id, b);
    }
    let given = clean.clone();
    let mut repair = Repair {
        graph,
        road,
        boxes: clean,
        locked: locked.clone(),
        about: about(graph),
        exhausted: BTreeMap::new(),
    };
    let order = repair.order();
    for _ in 0..ROUNDS {
        let mut changed = false;
        for id in &order {
            changed |= repair.settle(*id);
        }
        if !changed {
            break;
        }
    }
    let mut out = Projection::default();
    // The later ones of an overlap give way.
    for id in &order {
        if repair.boxes.get(id).is_some_and(|b| repair.physics(*id, b) > 0) {
            repair.boxes.remove(id);
            out.dropped.push(*id);
        }
    }
    out.dropped.sort_unstable();
    for (id, b) in &repair.boxes {
        let turned = given[id].heading().dot(b.heading()).clamp(-1.0, 1.0).acos();
        let distance_m = (b.center_m - given[id].center_m).truncate().length();
        if distance_m > 1e-6 || turned > 1e-6 {
            let (id, turned_rad) = (*id, turned);
            out.moved.push(Moved {
                id,
                distance_m,
                turned_rad,
            });
        }
    }
    let placed = repair.placed();
    let judged = |e: &&GraphEdge| graph.object(e.from).is_some();
    out.stated = graph.edges.iter().filter(judged).count();
    out.broken = graph
        .edges
        .iter()
        .filter(judged)
        .filter(|e| !placed.satisfied(e))
        .copied()
        .collect();
    *boxes = repair.boxes;
    out
}

fn about(graph: &SceneGraph) -> BTreeMap<u32, Vec<GraphEdge>> {
    let mut out: BTreeMap<u32, Vec<GraphEdge>> = BTreeMap::new();
    for e in &graph.edges {
        let named: BTreeSet<u32> = [Some(e.from), Some(e.to), e.and].into_iter().flatten().collect();
        named
            .into_iter()
            .for_each(|id| out.entry(id).or_default().push(*e));
    }
    out
}

impl Repair<'_> {
    fn placed(&self) -> PlacedGraph<'_> {
        PlacedGraph {
            graph: self.graph,
            boxes: &self.boxes,
            road: self.road,
        }
    }

    /// Free objects: those that others are placed by first, then the larger ones.
    fn order(&self) -> Vec<u32> {
        let mut depth: BTreeMap<u32, usize> = self.boxes.keys().map(|id| (*id, 0)).collect();
        for _ in 0..8 {
            for e in &self.graph.edges {
                for to in [Some(e.to), e.and].into_iter().flatten() {
                    if let (Some(to), Some(from)) = (depth.get(&to).copied(), depth.get_mut(&e.from)) {
                        *from = (*from).max(to + 1).min(8);
                    }
                }
            }
        }
        let mut order: Vec<u32> = self
            .boxes
            .keys()
            .copied()
            .filter(|id| !self.locked.contains(id))
            .collect();
        order.sort_by(|a, b| {
            let area = |id: &u32| self.boxes[id].size_m.x * self.boxes[id].size_m.y;
            depth[a]
                .cmp(&depth[b])
                .then(area(b).total_cmp(&area(a)))
                .then(a.cmp(b))
        });
        order
    }

    fn edges(&self, id: u32) -> impl Iterator<Item = &GraphEdge> {
        self.about
            .get(&id)
            .into_iter()
            .flatten()
            .filter(move |e| e.from == id)
    }

    fn state(&self, id: u32) -> Option<ObjectState> {
        self.graph.object(id).and_then(|o| o.state)
    }

    /// Number of physical faults of a box taken as object `id`.
    fn physics(&self, id: u32, b: &SceneBox) -> usize {
        let corners = b.footprint();
        let outside = corners
            .iter()
            .any(|c| c.is_nan() || c.abs().max_element() > REACH_M);
        let p = b.center_m.truncate();
        let mut off = false;
        let mut turned = false;
        if b.class.is_vehicle() {
            let inner = corners.map(|c| p.lerp(c, 0.85));
            let on = inner.iter().filter(|c| self.road.is_for_vehicles(**c)).count();
            off = on < 4 || !self.road.is_for_vehicles(p);
            turned = self.state(id) == Some(ObjectState::Moving) && !self.is_turned_on_purpose(id) && {
                let lane = self.road.nearest_lane(p).filter(|l| l.distance_m < 2.5);
                lane.is_some_and(|l| l.direction.dot(b.heading()).abs() < ALONG)
            };
        }
        let grown = grown(b);
        let others = self
            .boxes
            .iter()
            .filter(|(other, _)| **other != id)
            .map(|(_, o)| o);
        let ego = ego_box();
        let hits = others.chain([&ego]).filter(|o| overlaps(&grown, o)).count();
        usize::from(outside) + usize::from(off) + usize::from(turned) + hits
    }

    fn is_turned_on_purpose(&self, id: u32) -> bool {
        let odd = [
            RelationKind::Across,
            RelationKind::Crossing,
            RelationKind::Facing,
            RelationKind::FacingAway,
        ];
        self.edges(id).any(|e| odd.contains(&e.relation))
    }

    fn fault(&mut self, id: u32, b: &SceneBox, enough: Fault) -> Fault {
        let physics = self.physics(id, b);
        if physics > enough.physics {
            return Fault {
                physics,
                statements: usize::MAX,
            };
        }
        let old = self.boxes.insert(id, *b);
        let placed = self.placed();
        let about = self.about.get(&id).map_or(&[][..], Vec::as_slice);
        let statements = about.iter().filter(|e| !placed.satisfied(e)).count();
        if let Some(old) = old {
            self.boxes.insert(id, old);
        }
        Fault { physics, statements }
    }

    /// Moves one object to the nearest sound place, or to the least bad one. True if it moved.
    fn settle(&mut self, id: u32) -> bool {
        const NONE: Fault = Fault {
            physics: 0,
            statements: 0,
        };
        let Some(own) = self.boxes.get(&id).copied() else {
            return false;
        };
        let now = self.fault(
            id,
            &own,
            Fault {
                physics: usize::MAX,
                statements: 0,
            },
        );
        let hopeless = now.physics == 0 && self.exhausted.get(&id).is_some_and(|f| now <= *f);
        if now == NONE || hopeless {
            return false;
        }
        let mut best = (now, own);
        'search: for place in self.places(id, &own) {
            for yaw in self.yaws(id, &own, place) {
                let b = SceneBox {
                    center_m: place.extend(own.center_m.z),
                    yaw_rad: yaw,
                    velocity_mps: DVec2::from_angle(yaw) * own.velocity_mps.length(),
                    ..own
                };
                let fault = self.fault(id, &b, best.0);
                if fault < best.0 {
                    best = (fault, b);
                }
                if fault == NONE {
                    break 'search;
                }
            }
        }
        if best.0 != NONE {
            self.exhausted.insert(id, best.0);
        }
        let moved = best.1 != own;
        self.boxes.insert(id, best.1);
        moved
    }

    /// Headings to try at a place, the present one first if it can stay.
    fn yaws(&self, id: u32, own: &SceneBox, place: DVec2) -> Vec<f64> {
        use std::f64::consts::FRAC_PI_2;
        let mut out = Vec::new();
        let lane = self.road.nearest_lane(place).filter(|l| l.distance_m < 6.0);
        let moving = self.state(id) == Some(ObjectState::Moving) && own.class.is_vehicle();
        if let Some(lane) = lane {
            let along = lane.direction.to_angle();
            if moving && !self.is_turned_on_purpose(id) {
                return vec![along];
            }
            out.push(own.yaw_rad);
            if own.class.is_vehicle() || own.class == Class::Motorcycle || own.class == Class::Bicycle {
                out.push(along);
            }
            if self.is_turned_on_purpose(id)
                || self
                    .edges(id)
                    .any(|e| e.relation == RelationKind::OppositeDirection)
            {
                out.extend([along + FRAC_PI_2, along - FRAC_PI_2, along + 2.0 * FRAC_PI_2]);
            }
        } else {
            out.push(own.yaw_rad);
        }
        let placed = self.placed();
        for e in self.edges(id) {
            let Some((other, at)) = placed.thing(e.to) else {
                continue;
            };
            match e.relation {
                RelationKind::Facing => out.push((at - place).to_angle()),
                RelationKind::FacingAway => out.push((place - at).to_angle()),
                RelationKind::SameDirection | RelationKind::Following => out.push(other.yaw_rad),
                RelationKind::OppositeDirection => out.push(other.yaw_rad + 2.0 * FRAC_PI_2),
                RelationKind::Crossing => out.extend([other.yaw_rad + FRAC_PI_2, other.yaw_rad - FRAC_PI_2]),
                _ => {}
            }
        }
        out.retain(|y| y.is_finite());
        out.dedup();
        out
    }

    /// Places to try, the nearest first: rings around the present one, lanes, strips beside them, places that a
    /// statement names, and every second metre of the map.
    fn places(&self, id: u32, own: &SceneBox) -> Vec<DVec2> {
        let from = own.center_m.truncate();
        let mut out = vec![from];
        for ring in 0..12 {
            let radius = 0.25 * 1.45f64.powi(ring);
            for k in 0..16 {
                let angle = std::f64::consts::TAU * (f64::from(k) + 0.5 * f64::from(ring % 2)) / 16.0;
                out.push(from + DVec2::from_angle(angle) * radius);
            }
        }
        let on_lanes = own.class.is_vehicle() || matches!(own.class, Class::Motorcycle | Class::Bicycle);
        if on_lanes || self.edges(id).count() > 0 {
            let side = 1.75 + own.size_m.y / 2.0 + 0.15;
            for lane in &self.road.lanes {
                for pair in lane.points_m.windows(2) {
                    let across = (pair[1] - pair[0]).normalize_or_zero().perp();
                    out.push(pair[0]);
                    if self.state(id) != Some(ObjectState::Moving) {
                        out.extend([pair[0] + across * side, pair[0] - across * side]);
                    }
                }
            }
        }
        let placed = self.placed();
        for e in self.edges(id) {
            let (Some((other, at)), Some(distance)) = (placed.thing(e.to), e.distance_m) else {
                continue;
            };
            let axis = scene::relations::course(&other);
            let d = match e.relation {
                RelationKind::InFrontOf => axis,
                RelationKind::Behind | RelationKind::Following => -axis,
                RelationKind::LeftOf => axis.perp(),
                RelationKind::RightOf => -axis.perp(),
                _ => continue,
            };
            out.extend((-8..=8).map(|k| at + d * distance + d.perp() * f64::from(k) * 0.8));
        }
        for x in -19..=19 {
            for y in -19..=19 {
                let p = DVec2::new(f64::from(x), f64::from(y)) * 2.0;
                let fits = match own.class {
                    Class::Pedestrian => self.road.has(BevLayer::Walkway, p) || self.edges(id).count() > 0,
                    class if class.is_vehicle() => self.road.is_for_vehicles(p),
                    _ => true,
                };
                if fits {
                    out.push(p);
                }
            }
        }
        for crossing in &self.road.crossings {
            let n = crossing.outline_m.len();
            out.push(crossing.center_m);
            out.extend((0..n).map(|i| crossing.center_m.lerp(crossing.outline_m[i], 0.6)));
        }
        out.retain(|p| p.abs().max_element() <= REACH_M);
        out.sort_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)));
        out.truncate(CANDIDATES);
        out
    }
}

fn grown(b: &SceneBox) -> SceneBox {
    SceneBox {
        size_m: b.size_m + MARGIN_M,
        ..*b
    }
}

fn overlaps(grown: &SceneBox, other: &SceneBox) -> bool {
    let reach = (grown.size_m.truncate().length() + other.size_m.truncate().length()) / 2.0;
    let apart = (grown.center_m - other.center_m).truncate().length();
    apart <= reach && overlap_m(grown, other) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use scene::BoxId;
    use scene::graph::{LaneRole, NodeKind, ObjectNode};
    use world::template;

    fn bus(id: u32, x: f64, y: f64, yaw_rad: f64) -> SceneBox {
        SceneBox {
            id: BoxId(id),
            class: Class::Bus,
            center_m: DVec3::new(x, y, 1.7),
            size_m: DVec3::new(11.0, 2.9, 3.4),
            yaw_rad,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    fn street() -> RoadMap {
        RoadMap::new(&template::layout("straight", 3).expect("listed"))
    }

    #[test]
    fn what_is_sound_stays() {
        let (road, mut graph) = (street(), SceneGraph::with_ego());
        let id = graph.add(NodeKind::Object(ObjectNode::new(Class::Bus)));
        graph.relate(id, RelationKind::InFrontOf, SceneGraph::EGO);
        let mut boxes = BTreeMap::from([(id, bus(1, 20.0, 0.0, 0.0))]);
        let before = boxes.clone();
        let report = project(&graph, &road, &mut boxes, &BTreeSet::new());
        assert_eq!(
            (boxes, report.moved.len(), report.broken.len(), report.stated),
            (before, 0, 0, 1)
        );
    }

    #[test]
    fn overlaps_and_broken_statements_are_repaired_and_told() {
        let (road, mut graph) = (street(), SceneGraph::with_ego());
        let ids: Vec<u32> = (0..6)
            .map(|_| graph.add(NodeKind::Object(ObjectNode::new(Class::Bus))))
            .collect();
        let lane = graph.add(NodeKind::Lane {
            role: LaneRole::Oncoming,
            polyline: None,
        });
        for id in &ids[3..] {
            graph.relate(*id, RelationKind::On, lane);
        }
        // All in one place, off the road, one of them not even finite.
        let mut boxes: BTreeMap<u32, SceneBox> =
            ids.iter().map(|id| (*id, bus(*id, 12.0, 30.0, 1.0))).collect();
        boxes.get_mut(&ids[2]).expect("there").center_m.x = f64::NAN;
        let report = project(&graph, &road, &mut boxes, &BTreeSet::new());
        assert!(
            report.dropped.is_empty() && report.broken.is_empty(),
            "{report:?}"
        );
        assert_eq!(report.moved.len(), 6);
        let all: Vec<&SceneBox> = boxes.values().collect();
        for (i, a) in all.iter().enumerate() {
            assert!(road.is_for_vehicles(a.center_m.truncate()));
            assert!(overlap_m(a, &ego_box()) <= 0.0);
            assert!(all[i + 1..].iter().all(|b| overlap_m(a, b) <= 0.0));
        }
    }

    #[test]
    fn forty_buses_in_one_lane_end_and_are_told() {
        let (road, mut graph) = (street(), SceneGraph::with_ego());
        let lane = graph.add(NodeKind::Lane {
            role: LaneRole::Ego,
            polyline: None,
        });
        let mut boxes = BTreeMap::new();
        for _ in 0..40 {
            let id = graph.add(NodeKind::Object(ObjectNode::new(Class::Bus)));
            graph.relate(id, RelationKind::On, lane);
            boxes.insert(id, bus(id, 5.0, 0.0, 0.0));
        }
        let locked = BTreeSet::new();
        let report = project(&graph, &road, &mut boxes, &locked);
        assert!(
            !report.broken.is_empty() && report.broken.len() < 40,
            "{}",
            report.broken.len()
        );
        assert_eq!(boxes.len() + report.dropped.len(), 40);
    }
}
