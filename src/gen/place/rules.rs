//! Constructive placement: every object takes the best free place that its relations allow, the most constrained ones first;
//! several orders are tried and the best is kept. Deterministic per seed. Objects that do not fit are left out and reported.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::cost::{moved_far, off_line, off_measure, off_near, off_thing, turned_where_it_is};
use super::holds::{RelationReference, ego, holds, overlap_m};
use super::lanes::{LaneMap, REACH_M};
pub use super::placement::Placement;
use super::spots::{Spot, is_beside, spots};
use scene::graph::{
    GraphEdge, LaneRole, Locked, NodeKind, ObjectNode, ObjectState, RelationKind, SceneGraph, SizeHint,
};
use scene::raster::box_cells;
use scene::{BevLayer, BevLayout, BoxId, Class, SceneBox};
use world::draw::Draw;

/// Distance beyond "near" from which on a place counts as wholly wrong, m.
const FAR_M: f64 = 9.0;
/// Deviation along the road up to which a stated distance counts as roughly met, m.
const ALONG_M: f64 = 4.0;
/// Orders that are tried while an object is left out or a relation is broken.
const ATTEMPTS: u64 = 5;
/// Boxes beyond this many are not tried: the scene is full long before.
const MOST_BOXES: usize = 300;

/// Boxes for the objects of a graph on a layout.
pub fn place(graph: &SceneGraph, layout: &BevLayout, seed: u64) -> Vec<SceneBox> {
    place_with(graph, layout, seed, &BTreeMap::new(), &[]).boxes
}

/// A placement with usual sizes of nodes (length, width, height, m), around boxes that belong to no node; locked boxes
/// stay.
pub fn place_with(
    graph: &SceneGraph,
    layout: &BevLayout,
    seed: u64,
    sizes_m: &BTreeMap<u32, [f64; 3]>,
    others: &[SceneBox],
) -> Placement {
    place_from(graph, &LaneMap::new(layout), seed, sizes_m, others, None)
}

/// A placement for a box that is moved: of all places that fit, the one nearest to its old place is taken.
pub fn place_from(
    graph: &SceneGraph,
    map: &LaneMap<'_>,
    seed: u64,
    sizes_m: &BTreeMap<u32, [f64; 3]>,
    others: &[SceneBox],
    from: Option<&SceneBox>,
) -> Placement {
    let mut best: Option<Placement> = None;
    for attempt in 0..ATTEMPTS {
        let mut placer = RulePlacer {
            graph,
            map,
            draw: Draw::new(seed.wrapping_add(attempt.wrapping_mul(0x9e37)), "text place"),
            sizes_m,
            placed: BTreeMap::new(),
            others,
            from,
            exact: if attempt == 0 { 0.8 } else { 0.1 },
        };
        let found = placer.run();
        let full = found.boxes.len() > 60; // more orders do not help in a crowd
        if best.as_ref().is_none_or(|b| found.cost() < b.cost()) {
            best = Some(found);
        }
        if full || best.as_ref().is_some_and(|b| b.cost() == 0) {
            break;
        }
    }
    best.unwrap_or_default()
}

/// Nodes with a statement that does not hold for their boxes.
pub fn broken(graph: &SceneGraph, layout: &BevLayout, boxes: &BTreeMap<u32, SceneBox>) -> Vec<u32> {
    let map = LaneMap::new(layout);
    let placer = RulePlacer {
        graph,
        map: &map,
        draw: Draw::new(0, "text place"),
        sizes_m: &BTreeMap::new(),
        placed: boxes.clone(),
        others: &[],
        from: None,
        exact: 0.0,
    };
    let wrong = |e: &&GraphEdge| boxes.get(&e.from).is_some_and(|b| !placer.edge_holds(e, b));
    graph.edges.iter().filter(wrong).map(|e| e.from).collect()
}

struct RulePlacer<'a> {
    graph: &'a SceneGraph,
    map: &'a LaneMap<'a>,
    draw: Draw,
    sizes_m: &'a BTreeMap<u32, [f64; 3]>,
    placed: BTreeMap<u32, SceneBox>,
    others: &'a [SceneBox],
    from: Option<&'a SceneBox>, // old place of the moved box
    exact: f64,                 // cost of a metre of deviation from a stated distance
}

impl RulePlacer<'_> {
    fn run(&mut self) -> Placement {
        let mut out = Placement::default();
        for node in &self.graph.nodes {
            if let Some(Locked::Box(b)) = node.locked {
                self.placed.insert(
                    node.id,
                    SceneBox {
                        id: BoxId(node.id),
                        ..b
                    },
                );
            }
        }
        let mut edges_of: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (i, e) in self.graph.edges.iter().enumerate() {
            edges_of.entry(e.from).or_default().push(i);
        }
        let none = Vec::new();
        let mut full: std::collections::BTreeSet<String> = std::collections::BTreeSet::new();
        for id in self.order(&edges_of) {
            let Some(object) = self.graph.object(id) else {
                continue;
            };
            if self.placed.len() >= MOST_BOXES {
                out.left_out.push((id, "the scene is full".into()));
                continue;
            }
            let edges = edges_of.get(&id).unwrap_or(&none);
            // If an equal object found no room, this one finds none either.
            let kind = format!(
                "{object:?} {:?}",
                edges
                    .iter()
                    .map(|e| (self.graph.edges[*e].relation, self.graph.edges[*e].to))
                    .collect::<Vec<_>>()
            );
            if full.contains(&kind) {
                out.left_out
                    .push((id, "no room is left where it should stand".into()));
                continue;
            }
            match self.best(id, object, edges) {
                Some(b) => {
                    self.placed.insert(id, b);
                }
                None => {
                    full.insert(kind);
                    out.left_out
                        .push((id, "no room is left where it should stand".into()));
                }
            }
        }
        for (i, e) in self.graph.edges.iter().enumerate() {
            if let Some(b) = self.placed.get(&e.from)
                && !self.edge_holds(e, b)
            {
                out.unmet.push(i);
            }
        }
        out.boxes = self.placed.values().copied().collect();
        out
    }

    /// Ids in order of placement: anchors before the nodes that refer to them, then the most constrained and the
    /// longest first.
    fn order(&mut self, edges_of: &BTreeMap<u32, Vec<usize>>) -> Vec<u32> {
        let mut waiting: Vec<(u32, f64)> = Vec::new();
        for (id, o) in self.graph.objects() {
            if self.placed.contains_key(&id) {
                continue;
            }
            let bound = edges_of.get(&id).map_or(0, Vec::len) as f64;
            let distance = edges_of
                .get(&id)
                .is_some_and(|e| e.iter().any(|i| self.graph.edges[*i].distance_m.is_some()));
            let length = o.class.typical_size_m().map_or(1.0, |s| s[0]);
            waiting.push((
                id,
                bound * 3.0 + length / 4.0 + if distance { 6.0 } else { 0.0 } + self.draw.unit() * 2.0,
            ));
        }
        waiting.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut order: Vec<u32> = Vec::new();
        let mut done: std::collections::BTreeSet<u32> = self.placed.keys().copied().collect();
        let objects: std::collections::BTreeSet<u32> = self.graph.objects().map(|o| o.0).collect();
        let mut queue: std::collections::VecDeque<u32> = waiting.iter().map(|w| w.0).collect();
        let mut stuck = 0;
        while let Some(id) = queue.pop_front() {
            let needs = edges_of.get(&id).into_iter().flatten().flat_map(|i| {
                let e = &self.graph.edges[*i];
                [Some(e.to), e.and].into_iter().flatten()
            });
            let ready = needs.filter(|n| objects.contains(n)).all(|n| done.contains(&n));
            if ready || stuck > queue.len() {
                order.push(id);
                done.insert(id);
                stuck = 0;
            } else {
                queue.push_back(id);
                stuck += 1;
            }
        }
        order
    }

    fn target(&self, id: u32) -> Option<RelationReference> {
        Some(match &self.graph.node(id)?.kind {
            NodeKind::Ego => RelationReference::Thing(ego()),
            NodeKind::Object(_) => RelationReference::Thing(*self.placed.get(&id)?),
            NodeKind::Lane { role, .. } => RelationReference::Lane(*role),
            NodeKind::Crossing { .. } => RelationReference::Crossing,
            NodeKind::Junction => RelationReference::Junction,
        })
    }

    /// The two ends of the line between which an object shall be.
    fn line(&self, e: &GraphEdge, first: &Option<RelationReference>) -> Option<[DVec2; 2]> {
        let at = |t: RelationReference| match t {
            RelationReference::Thing(b) if b.id.0 == u32::MAX => Some(DVec2::ZERO),
            RelationReference::Thing(b) => Some(b.center_m.truncate()),
            _ => None,
        };
        let second = self.target(e.and.filter(|_| e.relation == RelationKind::Between)?)?;
        Some([at((*first)?)?, at(second)?])
    }

    fn edge_holds(&self, e: &GraphEdge, b: &SceneBox) -> bool {
        let Some(to) = self.target(e.to) else {
            return false;
        };
        let and = e.and.and_then(|id| match self.target(id)? {
            RelationReference::Thing(b) => Some(b),
            _ => None,
        });
        holds(self.map, e.relation, b, &to, and.as_ref(), e.distance_m)
    }

    fn size(&mut self, id: u32, o: &ObjectNode) -> DVec3 {
        let typical = self
            .sizes_m
            .get(&id)
            .copied()
            .or(o.class.typical_size_m())
            .unwrap_or([1.0; 3]);
        let factor = match o.size {
            Some(SizeHint::Large) => 1.18,
            Some(SizeHint::Small) => 0.85,
            None => 1.0,
        };
        let d = &mut self.draw;
        let spread = DVec3::new(d.range(0.95, 1.05), d.range(0.97, 1.03), d.range(0.95, 1.05));
        DVec3::from_array(typical) * spread * DVec3::new(factor, 1.0 + (factor - 1.0) / 3.0, factor)
    }

    fn speed(&mut self, o: &ObjectNode, spot: &Spot) -> f64 {
        let still = spot.still || matches!(o.state, Some(ObjectState::Parked | ObjectState::Waiting));
        let moves = o.state == Some(ObjectState::Moving) || spot.moves;
        if (still && !spot.moves) || matches!(o.class, Class::TrafficCone | Class::Barrier) {
            return 0.0;
        }
        match o.class {
            Class::Pedestrian if moves => self.draw.range(0.9, 1.8),
            Class::Pedestrian if self.draw.chance(0.5) => self.draw.range(0.7, 1.6),
            Class::Pedestrian => 0.0,
            Class::Bicycle => self.draw.range(2.5, 6.0),
            Class::ConstructionVehicle | Class::Trailer if !moves => 0.0,
            _ if moves || self.draw.chance(0.8) => self.draw.range(3.0, 12.0),
            _ => 0.0,
        }
    }

    fn best(&mut self, id: u32, o: &ObjectNode, edges: &[usize]) -> Option<SceneBox> {
        let size_m = self.size(id, o);
        let stated: Vec<(GraphEdge, Option<RelationReference>)> = edges
            .iter()
            .map(|i| self.graph.edges[*i])
            .map(|e| (e, self.target(e.to)))
            .collect();
        let mut candidates = spots(self.map, o, size_m, &stated, &mut self.draw);
        candidates.extend(self.from.and_then(|old| turned_where_it_is(old, &stated)));
        let siblings: Vec<DVec2> = self.siblings(id, o, edges);
        let simply = edges.is_empty();
        let ranked = self.ranked(o, size_m, &candidates, &stated, &siblings, simply);
        let along = stated.iter().any(|(e, _)| {
            matches!(e.relation, RelationKind::InFrontOf | RelationKind::Behind) && e.distance_m.is_some()
        });
        // An object that shall stand close to the ego vehicle may do so.
        let close = stated.iter().any(|(e, t)| {
            let half_m = if along { size_m.x / 2.0 } else { 0.0 };
            matches!(t, Some(RelationReference::Thing(b)) if b.id.0 == u32::MAX)
                && e.distance_m.is_some_and(|d| d < 8.0_f64.max(half_m + 5.5))
        });
        // An object at the edge of a wide road keeps the stated distance ahead, rather than standing farther ahead.
        let strip = stated.iter().any(|(e, t)| {
            matches!(e.relation, RelationKind::On | RelationKind::ParkedOn)
                && matches!(t, Some(RelationReference::Lane(role)) if is_beside(*role))
        });
        let mut best: Option<(f64, SceneBox)> = None;
        for (cost, i) in ranked {
            if best.as_ref().is_some_and(|b| b.0 <= cost) {
                break;
            }
            let spot = &candidates[i];
            let mut b = SceneBox {
                id: BoxId(id),
                class: o.class,
                center_m: spot.p.extend(size_m.z / 2.0),
                size_m,
                yaw_rad: spot.yaw_rad,
                velocity_mps: DVec2::ZERO,
                label: o.label,
            };
            if !self.fits(&b, o.class, spot, close) {
                continue;
            }
            let speed = if spot.moves { 2.0 } else { 0.0 };
            b.velocity_mps = b.heading() * speed;
            let broken = stated.iter().filter(|(e, _)| !self.edge_holds(e, &b)).count();
            if broken == 0 {
                b.velocity_mps = DVec2::ZERO;
                best = Some((cost, b));
                let speed = self.speed(o, spot);
                if let Some((_, b)) = &mut best {
                    b.velocity_mps = b.heading() * speed;
                }
                break;
            }
            // A place ahead at another distance is nearer to the statement than one behind.
            let wholly = stated
                .iter()
                .filter(|(e, t)| self.misses(e, t, &b, strip))
                .count();
            // (a thing that cannot be near is put as near as possible)
            let off_by = |(e, t): &(GraphEdge, Option<RelationReference>)| {
                let along = || {
                    self.off_along(e, t, &b)
                        .filter(|_| strip && !self.edge_holds(e, &b))
                };
                off_near(e, t, &b).or_else(along)
            };
            let off: f64 = stated.iter().filter_map(off_by).sum();
            let total = cost + 40.0 * (broken + wholly) as f64 + off;
            if best.as_ref().is_none_or(|b| total < b.0) {
                best = Some((total, b));
            }
        }
        // Several in one lane: a place that breaks a statement is not taken if an equal object meets all of them. One
        // that only misses the distance is better than none: "three cars 12 m ahead" are three.
        match best {
            // (if none holds, a wrong place is better than none, and is reported)
            Some((_, b))
                if stated.iter().any(|(e, t)| self.misses(e, t, &b, strip))
                    && self.a_twin_holds(&siblings, o.class, &stated) =>
            {
                None
            }
            Some((_, b)) => Some(b),
            None => None,
        }
    }

    /// Candidates by a rough cost, the least first, so that the costly tests are made only for promising ones.
    /// `simply`: no place was stated.
    fn ranked(
        &mut self,
        o: &ObjectNode,
        size_m: DVec3,
        candidates: &[Spot],
        stated: &[(GraphEdge, Option<RelationReference>)],
        siblings: &[DVec2],
        simply: bool,
    ) -> Vec<(f64, usize)> {
        let blocks = stated.iter().any(|(e, _)| e.relation == RelationKind::Blocking);
        let small = matches!(o.class, Class::TrafficCone | Class::Barrier);
        let between: Vec<[DVec2; 2]> = stated.iter().filter_map(|(e, t)| self.line(e, t)).collect();
        let mut ranked: Vec<(f64, usize)> = Vec::with_capacity(candidates.len());
        for (i, s) in candidates.iter().enumerate() {
            let far = s.p.length();
            let chance = self.draw.unit();
            let mut cost = match self.from {
                Some(old) => s.cost + 0.3 * chance + moved_far(old, s),
                // (described objects are in view ahead, if nothing else was stated)
                None => s.cost + 0.02 * (far - 14.0).abs() + 0.05 * (-s.p.x).clamp(0.0, 25.0) + chance * 1.2,
            };
            cost += self.exact * off_measure(stated, s, size_m);
            cost += between.iter().map(|ends| 0.5 * off_line(*ends, s.p)).sum::<f64>();
            if let Some(near) = siblings.iter().map(|q| q.distance(s.p)).min_by(f64::total_cmp) {
                cost += match o.class {
                    Class::TrafficCone | Class::Barrier => 0.5 * near,
                    _ => 0.02 * near,
                };
            }
            // An object before or behind a thing is close to it.
            cost += stated.iter().map(|(e, t)| off_thing(e, t, s.p)).sum::<f64>();
            // "In a lane" means in its middle rather than at its edge.
            if small {
                cost += stated
                    .iter()
                    .map(|(e, t)| self.off_middle(e, t, s.p))
                    .sum::<f64>();
            }
            // Small things that block a lane stand side by side across it.
            if blocks && small {
                let along = |q: &DVec2| (s.p - *q).dot(DVec2::from_angle(s.yaw_rad)).abs();
                cost += 3.0 * siblings.iter().map(along).min_by(f64::total_cmp).unwrap_or(0.0);
            }
            // ahead or behind means in our lane or near it
            let along = stated.iter().any(|(e, t)| {
                matches!(t, Some(RelationReference::Thing(b)) if b.id.0 == u32::MAX)
                    && matches!(e.relation, RelationKind::InFrontOf | RelationKind::Behind)
            });
            if along && self.from.is_none() {
                let off = self.map.course(s.p).map_or(s.p.y, |c| c.1).abs();
                cost += 0.15 * (off - 3.0).max(0.0);
            }
            // Plain "left" or "right" means beside.
            let beside = stated.iter().any(|(e, t)| {
                let ego = matches!(t, Some(RelationReference::Thing(b)) if b.id.0 == u32::MAX);
                ego && matches!(e.relation, RelationKind::LeftOf | RelationKind::RightOf)
            });
            if beside && s.p.x.abs() > (2.0 * s.p.y.abs()).max(6.3) {
                cost += 1.5 + 0.03 * s.p.x.abs();
            }
            // behind a thing ahead means between it and the ego vehicle
            let beyond = stated.iter().any(|(e, t)| {
                // (a follower of an oncoming vehicle is beyond it)
                let follows = |b: &SceneBox| e.relation == RelationKind::Following && b.heading().x > 0.0;
                matches!(t, Some(RelationReference::Thing(b)) if b.id.0 != u32::MAX
                    && b.center_m.x > 6.0
                    && (e.relation == RelationKind::Behind || follows(b)))
            });
            if beyond && s.p.x < 0.0 {
                // (regardless of the distance to get there)
                cost += if self.from.is_some() { 10.0 } else { 2.0 };
            }
            // an oncoming vehicle has not passed the ego vehicle yet
            let comes = stated.iter().any(|(e, t)| {
                matches!(t, Some(RelationReference::Thing(b)) if b.id.0 == u32::MAX)
                    && e.relation == RelationKind::OppositeDirection
            });
            if comes && s.p.x < 4.0 {
                cost += 2.0;
            }
            if simply && s.p.x < -2.0 {
                cost += 0.8; // without a stated place, ahead is preferred
            }
            ranked.push((cost, i));
        }
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        ranked
    }

    /// True if a statement does not hold even roughly: neither without its distance nor nearly. `strip`: a strip of the
    /// road was named, and distances are measured along it.
    fn misses(&self, e: &GraphEdge, to: &Option<RelationReference>, b: &SceneBox, strip: bool) -> bool {
        let whole = GraphEdge {
            distance_m: None,
            ..*e
        };
        !(self.edge_holds(&whole, b)
            || off_near(e, to, b).is_some_and(|off| off < FAR_M)
            || strip && self.off_along(e, to, b).is_some_and(|off| off < ALONG_M))
    }

    /// Deviation along the road from a stated distance ahead of the ego vehicle or behind it, m, at most 30; in a curve
    /// this is not straight ahead.
    fn off_along(&self, e: &GraphEdge, to: &Option<RelationReference>, b: &SceneBox) -> Option<f64> {
        let ego = matches!(to, Some(RelationReference::Thing(b)) if b.id.0 == u32::MAX);
        let way = match e.relation {
            RelationKind::InFrontOf if ego => 1.0,
            RelationKind::Behind if ego => -1.0,
            _ => return None,
        };
        let (s, off, _) = self.map.course(b.center_m.truncate())?;
        Some(((s * way - e.distance_m?).abs() + 0.2 * (off.abs() - 8.0).max(0.0)).min(30.0))
    }

    fn off_middle(&self, e: &GraphEdge, to: &Option<RelationReference>, p: DVec2) -> f64 {
        use LaneRole as L;
        match to {
            Some(RelationReference::Lane(role @ (L::Ego | L::Left | L::Right | L::Oncoming)))
                if e.relation == RelationKind::On =>
            {
                let lane = self.map.nearest(p).filter(|l| l.role == *role);
                let off = lane.map_or(f64::INFINITY, |l| l.p.distance(p));
                4.0 * (off - 0.9).clamp(0.0, 1.0)
            }
            _ => 0.0,
        }
    }

    fn a_twin_holds(
        &self,
        siblings: &[DVec2],
        class: Class,
        stated: &[(GraphEdge, Option<RelationReference>)],
    ) -> bool {
        let twins = self
            .placed
            .values()
            .filter(|b| b.class == class && siblings.contains(&b.center_m.truncate()));
        twins
            .into_iter()
            .any(|b| stated.iter().all(|(e, _)| self.edge_holds(e, b)))
    }

    /// Places of boxes with the same statements.
    fn siblings(&self, id: u32, o: &ObjectNode, edges: &[usize]) -> Vec<DVec2> {
        let said = |i: &[usize]| {
            i.iter()
                .map(|k| (self.graph.edges[*k].relation, self.graph.edges[*k].to))
                .collect::<Vec<_>>()
        };
        let own = said(edges);
        self.placed
            .iter()
            .filter(|(other, b)| **other != id && b.class == o.class)
            .filter(|(other, _)| {
                let theirs: Vec<usize> = self
                    .graph
                    .edges
                    .iter()
                    .enumerate()
                    .filter(|(_, e)| e.from == **other)
                    .map(|(i, _)| i)
                    .collect();
                said(&theirs) == own
            })
            .map(|(_, b)| b.center_m.truncate())
            .collect()
    }

    fn fits(&self, b: &SceneBox, class: Class, spot: &Spot, close: bool) -> bool {
        let inside = b
            .footprint()
            .iter()
            .all(|c| c.abs().max_element() < REACH_M + 0.6);
        let vehicle = class.is_vehicle() || class == Class::Motorcycle;
        let surface = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
        let walk = BevLayer::Walkway.bit() | BevLayer::PedCrossing.bit();
        let mut on = true;
        let allowed = match class {
            _ if vehicle && spot.anywhere => surface | walk, // left behind on the sidewalk
            _ if vehicle => surface,
            Class::Pedestrian if !spot.anywhere => walk | if spot.on_road { surface } else { 0 },
            Class::Bicycle if !spot.anywhere => surface | walk,
            _ => u32::MAX,
        };
        if allowed != u32::MAX {
            let map = self.map.layout;
            box_cells(map.extent(), b, 0.0, |x, y| on &= map.cell(x, y) & allowed != 0);
        }
        if !(inside && on) {
            return false;
        }
        let margin = |other: Class| match (class, other) {
            (Class::TrafficCone | Class::Barrier, Class::TrafficCone | Class::Barrier) => 0.15,
            (Class::Pedestrian, _) | (_, Class::Pedestrian) => 0.3,
            (Class::TrafficCone | Class::Barrier, _) | (_, Class::TrafficCone | Class::Barrier) => 0.4,
            _ => 0.7,
        };
        let reach = b.size_m.truncate().length() / 2.0;
        let clear = |o: &SceneBox| {
            let far = (o.center_m - b.center_m).truncate().length()
                > reach + o.size_m.truncate().length() / 2.0 + 1.0;
            far || overlap_m(b, o, margin(o.class)) <= 0.0
        };
        let mut keep = ego();
        keep.center_m.x = 1.6;
        keep.size_m = DVec3::new(if close { 4.8 } else { 7.0 }, 2.6, 1.6);
        clear(&keep) && self.placed.values().all(clear) && self.others.iter().all(clear)
    }
}

/// True if the relation ties an object to a lane role that only holds for standing things.
pub fn stands(relation: RelationKind) -> bool {
    matches!(
        relation,
        RelationKind::ParkedOn | RelationKind::WaitingAt | RelationKind::Blocking
    )
}
