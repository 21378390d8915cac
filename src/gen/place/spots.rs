//! Places that an object of a class may take: along lanes, at their edge, on sidewalks, crossings and car parks, and
//! around the things that it is placed by.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use super::holds::{RelationReference, course};
use super::lanes::{LaneMap, REACH_M};
use super::rules::stands;
use scene::graph::{GraphEdge, LaneRole, ObjectNode, ObjectState, RelationKind};
use scene::{BevLayer, Class};
use world::draw::Draw;

/// A place to try.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// Centre, m.
    pub p: DVec2,
    /// Heading.
    pub yaw_rad: f64,
    /// Cost for being unusual, in the unit of the placer.
    pub cost: f64,
    /// True if an object here stands still.
    pub still: bool,
    /// True if an object here moves.
    pub moves: bool,
    /// True if people may be on the road here.
    pub on_road: bool,
    /// True if any ground will do.
    pub anywhere: bool,
}

pub(super) struct Gather<'a, 'b> {
    pub(super) map: &'a LaneMap<'a>,
    pub(super) size_m: DVec3,
    pub(super) draw: &'b mut Draw,
    pub(super) out: Vec<Spot>,
    pub(super) base: Spot,
    against: bool,               // it drives towards the ego
    with: bool,                  // it drives in the ego's direction
    own_way: bool,               // traffic of the ego's direction is meant
    pub(super) either_way: bool, // its facing was stated: parked, it may face against the traffic
}

/// Places for an object, with its statements (whose targets are placed already).
pub fn spots(
    map: &LaneMap<'_>,
    o: &ObjectNode,
    size_m: DVec3,
    stated: &[(GraphEdge, Option<RelationReference>)],
    draw: &mut Draw,
) -> Vec<Spot> {
    let said = |kind: RelationKind| stated.iter().any(|(e, _)| e.relation == kind);
    let lane_role = stated.iter().find_map(|(e, t)| match t {
        Some(RelationReference::Lane(role))
            if matches!(
                e.relation,
                RelationKind::On
                    | RelationKind::ParkedOn
                    | RelationKind::Crossing
                    | RelationKind::Blocking
                    | RelationKind::Across
            ) =>
        {
            Some((e.relation, *role))
        }
        _ => None,
    });
    let still =
        o.state.is_some_and(|s| s != ObjectState::Moving) || stated.iter().any(|(e, _)| stands(e.relation));
    let moves = o.state == Some(ObjectState::Moving) || said(RelationKind::Crossing);
    let mut g = Gather {
        map,
        size_m,
        draw,
        out: Vec::new(),
        base: Spot {
            p: DVec2::ZERO,
            yaw_rad: 0.0,
            cost: 0.0,
            still,
            moves: moves && !still,
            on_road: false,
            anywhere: false,
        },
        // (an object ahead in the ego's lane that faces the ego vehicle stands against the traffic)
        against: said(RelationKind::OppositeDirection)
            || said(RelationKind::Facing) && said(RelationKind::InFrontOf),
        with: said(RelationKind::SameDirection),
        either_way: [
            RelationKind::Facing,
            RelationKind::FacingAway,
            RelationKind::OppositeDirection,
            RelationKind::SameDirection,
        ]
        .into_iter()
        .any(said),
        own_way: (said(RelationKind::InFrontOf)
            || said(RelationKind::Behind)
            || said(RelationKind::Blocking))
            && !said(RelationKind::OppositeDirection)
            && !said(RelationKind::Facing),
    };
    let near_thing = stated.iter().any(|(e, t)| {
        matches!(t, Some(RelationReference::Thing(b)) if b.id.0 != u32::MAX)
            && !matches!(
                e.relation,
                RelationKind::FarFrom | RelationKind::Facing | RelationKind::FacingAway
            )
    });
    match o.class {
        Class::Pedestrian => g.people(lane_role, stated, near_thing),
        Class::TrafficCone | Class::Barrier => g.small(o.class, lane_role, stated, near_thing),
        _ => g.vehicle(o, lane_role, stated, near_thing),
    }
    let mut out = g.out;
    // The stated facing.
    for (e, t) in stated {
        let toward = match e.relation {
            RelationKind::Facing => 0.0,
            RelationKind::FacingAway => PI,
            _ => continue,
        };
        let Some(RelationReference::Thing(b)) = t else {
            continue;
        };
        if o.class == Class::Pedestrian {
            let at = if b.id.0 == u32::MAX {
                DVec2::ZERO
            } else {
                b.center_m.truncate()
            };
            out.iter_mut()
                .for_each(|s| s.yaw_rad = (at - s.p).to_angle() + toward);
        }
    }
    out.retain(|s| s.p.abs().max_element() < REACH_M);
    out
}

/// Strips on either side of the road: its edges and the sidewalks.
pub(super) fn is_beside(role: LaneRole) -> bool {
    is_roadside(role)
        || matches!(
            role,
            LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk
        )
}

/// Roles beside the lanes.
pub(super) fn is_roadside(role: LaneRole) -> bool {
    matches!(
        role,
        LaneRole::Roadside | LaneRole::LeftRoadside | LaneRole::RightRoadside
    )
}

fn is_walk(role: LaneRole) -> bool {
    matches!(
        role,
        LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk
    )
}

impl Gather<'_, '_> {
    pub(super) fn push(&mut self, p: DVec2, yaw_rad: f64) {
        self.out.push(Spot {
            p,
            yaw_rad,
            ..self.base
        });
    }

    fn people(
        &mut self,
        lane_role: Option<(RelationKind, LaneRole)>,
        stated: &[(GraphEdge, Option<RelationReference>)],
        near_thing: bool,
    ) {
        let said = |kind: RelationKind| stated.iter().any(|(e, _)| e.relation == kind);
        let things = stated
            .iter()
            .any(|(_, t)| matches!(t, Some(RelationReference::Thing(_))));
        let crossing = said(RelationKind::Crossing)
            || stated.iter().any(|(e, t)| {
                matches!(t, Some(RelationReference::Crossing)) && e.relation == RelationKind::On
            });
        match lane_role {
            _ if crossing => self.crossing_people(),
            Some((RelationKind::On | RelationKind::Blocking | RelationKind::ParkedOn, role))
                if !is_walk(role) =>
            {
                self.base.on_road = true;
                self.lanes(role, true);
            }
            _ => self.walks(),
        }
        let on_junction = |(e, t): &(GraphEdge, Option<RelationReference>)| {
            matches!(t, Some(RelationReference::Junction)) && e.relation == RelationKind::On
        };
        if stated.iter().any(on_junction) {
            self.amid_junction();
        }
        if (near_thing || things) && !crossing {
            self.base.anywhere = near_thing;
            self.base.on_road = true;
            self.base.cost += 1.5;
            self.around(stated);
            self.base.cost -= 1.5;
        }
        if self.out.is_empty() {
            // No sidewalk here: the verge will do.
            self.base.anywhere = true;
            self.verge();
        }
    }

    /// Cones and barriers.
    fn small(
        &mut self,
        class: Class,
        lane_role: Option<(RelationKind, LaneRole)>,
        stated: &[(GraphEdge, Option<RelationReference>)],
        near_thing: bool,
    ) {
        let said = |kind: RelationKind| stated.iter().any(|(e, _)| e.relation == kind);
        self.base.still = true;
        self.base.moves = false;
        match lane_role {
            Some((
                RelationKind::Blocking | RelationKind::On | RelationKind::ParkedOn | RelationKind::Across,
                role,
            )) if !is_walk(role) && !is_roadside(role) && role != LaneRole::Carpark => {
                self.across_lane(role, class);
            }
            Some((_, role)) if is_walk(role) => {
                self.base.anywhere = true;
                self.walks();
            }
            Some((_, role)) => self.edge(role),
            None => {
                if said(RelationKind::Blocking) {
                    self.across_lane(LaneRole::Ego, class);
                } else {
                    self.edge(LaneRole::Roadside);
                    self.base.cost = 0.8;
                    self.across_lane(LaneRole::Road, class);
                    self.base.cost = 0.0;
                }
            }
        }
        if near_thing || self.out.is_empty() {
            self.base.anywhere = true;
            self.around(stated);
        }
    }

    fn vehicle(
        &mut self,
        o: &ObjectNode,
        lane_role: Option<(RelationKind, LaneRole)>,
        stated: &[(GraphEdge, Option<RelationReference>)],
        near_thing: bool,
    ) {
        let parked =
            o.state == Some(ObjectState::Parked) || lane_role.is_some_and(|r| r.0 == RelationKind::ParkedOn);
        let two_wheels = matches!(o.class, Class::Bicycle | Class::Motorcycle);
        let across =
            lane_role.is_some_and(|(r, _)| matches!(r, RelationKind::Crossing | RelationKind::Across));
        match lane_role {
            Some((_, LaneRole::Carpark)) => self.carpark(),
            Some((_, role)) if is_roadside(role) => self.edge(role),
            Some((_, role)) if is_walk(role) && o.class == Class::Bicycle => self.walks(),
            // Left behind on the sidewalk, along the road.
            Some((relation, role)) if is_walk(role) => {
                (self.base.still, self.base.moves, self.base.anywhere) = (true, false, true);
                let map = self.map;
                self.cells(BevLayer::Walkway.bit(), 2, |p| {
                    map.nearest(p).map_or(0.0, |l| l.dir.to_angle())
                });
                self.base.anywhere = false;
                if relation == RelationKind::ParkedOn {
                    self.edge(LaneRole::Roadside); // half on it will do
                }
            }
            Some((_, role)) if across => {
                self.crosswise(role);
                self.lanes(LaneRole::Cross, false);
            }
            Some((RelationKind::ParkedOn, role)) => {
                self.lanes(role, false);
                self.edge(LaneRole::Roadside);
            }
            Some((relation, role)) => {
                self.lanes(role, false);
                if relation == RelationKind::Blocking {
                    // A bus across the road blocks it too.
                    self.base.cost += 1.0;
                    self.crosswise(role);
                    self.base.cost -= 1.0;
                }
            }
            None if parked => {
                // (parking spaces are used first, if there are any)
                let lot = self.map.layout.count(BevLayer::CarparkArea) > 200;
                let (edge, spaces) = if lot { (0.8, 0.0) } else { (0.0, 0.4) };
                self.base.cost += edge;
                self.edge(LaneRole::Roadside);
                self.base.cost += spaces - edge;
                self.carpark();
                self.base.cost += 0.4 - spaces;
                if stated
                    .iter()
                    .any(|(e, _)| !matches!(e.relation, RelationKind::ParkedOn | RelationKind::On))
                {
                    self.base.cost += 1.6;
                    self.lanes(LaneRole::Road, false);
                    self.base.cost -= 1.6;
                }
                self.base.cost -= 0.4;
            }
            None => {
                self.lanes(LaneRole::Road, false);
                if two_wheels || o.state == Some(ObjectState::Waiting) || o.state.is_none() {
                    self.base.cost += 1.5;
                    self.edge(LaneRole::Roadside);
                    self.base.cost -= 1.5;
                }
            }
        }
        if stated.iter().any(|(e, _)| e.relation == RelationKind::WaitingAt) {
            self.lanes(LaneRole::Road, false);
            self.keep_out_of_junctions();
        }
        let measured = stated.iter().any(|(e, _)| {
            e.distance_m.is_some()
                && matches!(
                    e.relation,
                    RelationKind::LeftOf | RelationKind::RightOf | RelationKind::Near
                )
        });
        if (near_thing || measured && self.base.still) && (parked || two_wheels || self.base.still) {
            self.base.cost += 2.0;
            self.around(stated);
            self.base.cost -= 2.0;
        }
    }

    /// Makes places in junctions and on crossings costly: an object that waits keeps them free.
    fn keep_out_of_junctions(&mut self) {
        const NEAR_M: f64 = 4.5;
        let half_m = self.size_m.x / 2.0;
        for s in &mut self.out {
            let along = DVec2::from_angle(s.yaw_rad);
            let stripes = |t: f64| {
                self.map
                    .has(BevLayer::PedCrossing.bit(), s.p + along * (half_m * t))
            };
            if [-1.0, -0.5, 0.0, 0.5, 1.0].into_iter().any(stripes) {
                s.cost += 4.0;
            }
            let in_the_way = self
                .map
                .points
                .iter()
                .any(|l| l.p.distance_squared(s.p) < NEAR_M * NEAR_M && l.dir.dot(along).abs() < 0.7);
            s.cost += if in_the_way { 4.0 } else { 0.0 };
        }
    }

    /// Along lanes, in their direction.
    fn lanes(&mut self, role: LaneRole, people: bool) {
        let from = self.out.len();
        self.lanes_of(role, people);
        if self.own_way {
            // "ahead" and "behind" mean our side of the road unless more was said.
            for s in &mut self.out[from..] {
                s.cost += if s.yaw_rad.cos() < -0.3 { 4.0 } else { 0.0 };
            }
        }
    }

    fn lanes_of(&mut self, role: LaneRole, people: bool) {
        let roadwide = matches!(role, LaneRole::Road);
        for i in 0..self.map.points.len() {
            let l = self.map.points[i];
            if !roadwide && l.role != role {
                continue;
            }
            // Traffic keeps to its lane; the ego's lane is kept free if nothing else was stated.
            let extra = if roadwide && l.role == LaneRole::Ego && l.p.length() < 9.0 {
                1.5
            } else {
                0.0
            };
            let across = self.draw.range(-0.25, 0.25);
            let wrong_way = self.against
                && matches!(l.role, LaneRole::Ego | LaneRole::Left | LaneRole::Right)
                && l.role == role
                // overtaking
                || self.with && l.role == LaneRole::Oncoming && role == LaneRole::Oncoming;
            let yaw = l.dir.to_angle()
                + if wrong_way { PI } else { 0.0 }
                + if people {
                    self.draw.range(-PI, PI)
                } else {
                    self.draw.range(-0.02, 0.02)
                };
            let old = self.base.cost;
            self.base.cost += extra;
            self.push(l.p + l.dir.perp() * across, yaw);
            if people {
                for off in [-1.2, 1.2] {
                    self.push(l.p + l.dir.perp() * off, yaw);
                }
            }
            self.base.cost = old;
        }
        if matches!(role, LaneRole::Road) && self.map.points.is_empty() {
            self.cells(BevLayer::DrivableArea.bit(), 2, |_| 0.0);
        }
    }

    fn crossing_people(&mut self) {
        self.base.on_road = true;
        const SIDE_ROAD_M: f64 = 4.0;
        let old = self.base.cost;
        // On a crossing if there is one, preferably one of our road; else straight across the road.
        for outline in &self.map.crossings {
            let mid = outline.iter().sum::<DVec2>() / outline.len() as f64;
            let of_ours = self.map.course(mid).is_none_or(|c| c.1.abs() < SIDE_ROAD_M);
            self.base.cost = old + if of_ours { 0.0 } else { 2.0 };
            let long = outline
                .iter()
                .zip(outline.iter().cycle().skip(1))
                .map(|(a, b)| *b - *a)
                .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                .unwrap_or(DVec2::Y);
            let axis = long.normalize_or(DVec2::Y);
            for k in -6..=6 {
                for w in [-0.9, 0.0, 0.9] {
                    let p = mid + axis * (long.length() / 2.0 * f64::from(k) / 7.0) + axis.perp() * w;
                    for turn in [0.0, PI] {
                        self.push(p, axis.to_angle() + turn);
                    }
                }
            }
        }
        self.base.cost = old + 1.0;
        for i in 0..self.map.points.len() {
            let l = self.map.points[i];
            for turn in [FRAC_PI_2, -FRAC_PI_2] {
                for off in [-1.3, 0.0, 1.3] {
                    self.push(l.p + l.dir.perp() * off, l.dir.to_angle() + turn);
                }
            }
        }
        self.base.cost = old;
    }

    /// Around the things that were named.
    fn around(&mut self, stated: &[(GraphEdge, Option<RelationReference>)]) {
        for (e, t) in stated {
            let Some(RelationReference::Thing(b)) = t else {
                continue;
            };
            let center = b.center_m.truncate();
            let axis = course(b);
            let half = b.size_m / 2.0;
            let own = self.size_m / 2.0;
            let yaw =
                if b.class == Class::Pedestrian || matches!(b.class, Class::TrafficCone | Class::Barrier) {
                    self.map.nearest(center).map_or(0.0, |l| l.dir.to_angle())
                } else {
                    axis.to_angle()
                };
            for along in [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0] {
                for extra in [0.6, 1.2, 2.0, 3.0, 4.5] {
                    let (fx, fy) = (half.x + own.x + extra, half.y + own.y + extra);
                    for p in [
                        center + axis * fx + axis.perp() * along * 0.5,
                        center - axis * fx + axis.perp() * along * 0.5,
                        center + axis.perp() * fy + axis * along,
                        center - axis.perp() * fy + axis * along,
                    ] {
                        self.push(p, yaw);
                    }
                }
            }
            if let (RelationKind::Between, Some(other)) = (e.relation, e.and) {
                let _ = other;
            }
            if let Some(d) = e.distance_m {
                let origin = if b.id.0 == u32::MAX { DVec2::ZERO } else { center };
                for k in 0..48 {
                    let turn = DVec2::from_angle(f64::from(k) * PI / 24.0);
                    self.push(origin + turn * d.min(80.0), yaw);
                }
            }
        }
        let things: Vec<DVec2> = stated
            .iter()
            .filter(|(e, _)| e.relation == RelationKind::Between)
            .filter_map(|(_, t)| match t {
                Some(RelationReference::Thing(b)) => Some(b.center_m.truncate()),
                _ => None,
            })
            .collect();
        if let Some(a) = things.first() {
            for k in 0..80 {
                let turn = DVec2::from_angle(f64::from(k) * PI / 8.0);
                self.push(*a + turn * (1.0 + f64::from(k) * 0.3), 0.0);
            }
        }
    }
}
