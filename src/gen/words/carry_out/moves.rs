//! Boxes that move. What is not said of a box stays as it was: told only how far ahead it shall be it keeps its lane, told
//! only a lane it keeps level.

use glam::DVec2;

use super::super::nouns::Noun;
use super::super::plan::Plan;
use super::super::reading::{Anchor as Said, Destination, Place, Relation, Thing, Way};
use super::super::remark::Remark;
use super::super::resolve::{Spare, kind_of};
use super::super::stage::Stage;
use crate::generation::place::description::{Anchor, ObjectSpec, Stated};
use crate::generation::place::holds::{ego, overlap_m, role_of};
use crate::generation::place::rules::stands;
use crate::generation::words::text_edit::TextEdit;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};
use crate::scene::{BevLayer, BoxId, Class, SceneBox};

/// Width of a lane where the map does not say, m.
const LANE_M: f64 = 3.5;

impl Stage<'_> {
    pub(super) fn moved(&mut self, who: &[Thing], to: &Destination) {
        let Some(ids) = self.those(who, Spare::Nearest) else {
            return;
        };
        if let Destination::To(places) = to
            && self.grouped(&ids, places)
        {
            return;
        }
        for id in &ids {
            let Some(b) = self.boxes.get(id).copied() else {
                continue;
            };
            match to {
                Destination::By { way, metres } => self.move_by(&b, *way, *metres),
                Destination::Lanes(n) => self.change_lane(&b, *n),
                Destination::Times(n) => {
                    let p = b.center_m.truncate().abs();
                    let place = range(p.max_element() * n.clamp(0.0, 100.0));
                    self.moved_to(*id, &[place]);
                }
                Destination::To(places) => {
                    self.moved_to(*id, places);
                }
            }
        }
        self.last = ids;
    }

    /// Things in a row, side by side, or facing each other: each by the one before; true if that was said.
    pub(super) fn grouped(&mut self, ids: &[BoxId], places: &[Place]) -> bool {
        let each = |p: &Place| p.to == Some(Said::EachOther);
        let of_group = |p: &&Place| matches!(p.relation, Relation::InLine | Relation::SideBySide) || each(p);
        let Some(group) = places.iter().find(of_group).cloned() else {
            return false;
        };
        if ids.len() < 2 {
            let relation = group.relation;
            self.remark(Remark::PlaceIgnored { relation });
            return true;
        }
        // (the other places are those of the first)
        let rest: Vec<Place> = places.iter().filter(|p| **p != group).cloned().collect();
        if !rest.is_empty() {
            self.moved_to(ids[0], &rest);
        }
        for (k, id) in ids.iter().enumerate() {
            let (relation, by) = match group.relation {
                Relation::InLine if k > 0 => (Relation::Behind, ids[k - 1]),
                Relation::SideBySide if k > 0 => (Relation::NextTo, ids[k - 1]),
                Relation::InLine | Relation::SideBySide => continue,
                Relation::Near | Relation::NextTo if k == 0 => continue,
                relation => (relation, if k == 0 { ids[1] } else { ids[k - 1] }),
            };
            let mut other = Thing::new(Noun::Thing);
            other.id = Some(by.0);
            let place = Place {
                relation,
                to: Some(Said::Thing(Box::new(other))),
                and: None,
                metres: None,
            };
            self.moved_to(*id, &[place]);
        }
        self.last = ids.to_vec();
        true
    }

    /// The boxes that a thing means, other than the one that is moved.
    fn others_of(&mut self, t: &Thing, moved: BoxId) -> Option<Vec<BoxId>> {
        let (spoken, noun) = (self.last.clone(), self.last_noun);
        self.skip = Some(moved);
        let ids = self.that(t, Spare::Nearest);
        self.skip = None;
        (self.last, self.last_noun) = (spoken, noun);
        ids
    }

    fn move_by(&mut self, b: &SceneBox, way: Way, metres: Option<f64>) {
        let p = b.center_m.truncate();
        let direction = match way {
            Way::Left => DVec2::Y,
            Way::Right => -DVec2::Y,
            Way::Forward => DVec2::X,
            Way::Back => -DVec2::X,
            Way::Nearer | Way::Away => {
                // Along its lane, if that leads to the ego vehicle.
                let out = p.normalize_or(DVec2::X);
                let lane = self.map.nearest(p).filter(|l| l.p.distance(p) < 4.5);
                let out = lane
                    .map(|l| if l.dir.dot(out) < 0.0 { -l.dir } else { l.dir })
                    .filter(|d| d.dot(out) > 0.7)
                    .unwrap_or(out);
                if way == Way::Away { out } else { -out }
            }
        };
        let metres = match metres {
            Some(m) => m,
            None => self.free_step(b, direction),
        };
        let most = if way == Way::Nearer {
            (p.length() - 4.0).max(0.0)
        } else {
            f64::INFINITY
        };
        self.step(b, direction * metres.min(most));
    }

    /// How far to go where no distance was said: the first step that ends clear of others.
    fn free_step(&mut self, b: &SceneBox, direction: DVec2) -> f64 {
        let free = [3.5, 5.0, 7.0, 2.0, 10.5].into_iter().find(|m| {
            let new = SceneBox {
                center_m: b.center_m + (direction * *m).extend(0.0),
                ..*b
            };
            let apart = |o: &SceneBox| overlap_m(&new, o, 0.2) <= 0.0;
            apart(&ego()) && self.boxes.values().all(|o| o.id == b.id || apart(o))
        });
        let metres = free.unwrap_or(3.5);
        self.remark(Remark::DefaultStep { metres });
        metres
    }

    fn step(&mut self, b: &SceneBox, by: DVec2) {
        let (id, center_m) = (b.id, b.center_m + by.extend(0.0));
        if !center_m.is_finite() || center_m.truncate().abs().max_element() > 40.0 {
            self.remark(Remark::Outside { id: id.0 });
            return;
        }
        let new = SceneBox { center_m, ..*b };
        let hit = self
            .boxes
            .values()
            .find(|o| o.id != id && overlap_m(&new, o, 0.0) > 0.0);
        if let Some(o) = hit {
            let other = Some(o.id.0);
            self.remark(Remark::Overlaps { id: id.0, other });
        } else if overlap_m(&new, &ego(), 0.0) > 0.0 {
            self.remark(Remark::Overlaps {
                id: id.0,
                other: None,
            });
        }
        self.push(TextEdit::Move {
            id,
            center_m,
            yaw_rad: b.yaw_rad,
        });
    }

    fn change_lane(&mut self, b: &SceneBox, lanes: i32) {
        let p = b.center_m.truncate();
        let axis = self.map.course(p).map_or(DVec2::X, |c| c.2);
        let wanted = p + axis.perp() * LANE_M * f64::from(lanes);
        let side = f64::from(lanes.signum());
        let to = self
            .map
            .points
            .iter()
            .filter(|l| l.role != LaneRole::Cross && axis.perp_dot(l.p - p) * side > 1.5)
            .filter(|l| l.p.distance(wanted) < 2.6)
            .min_by(|a, b| {
                a.p.distance_squared(wanted)
                    .total_cmp(&b.p.distance_squared(wanted))
            })
            .copied();
        let Some(to) = to else {
            self.remark(Remark::NoLane { id: b.id.0 });
            return;
        };
        let yaw_rad = to.dir.to_angle();
        let new = SceneBox {
            center_m: to.p.extend(b.center_m.z),
            yaw_rad,
            ..*b
        };
        let new = self.clear_of_others(new).unwrap_or(new);
        self.push(TextEdit::Move {
            id: b.id,
            center_m: new.center_m,
            yaw_rad,
        });
    }

    /// To the edge of the road.
    pub(super) fn park(&mut self, id: BoxId, role: LaneRole) {
        let place = Place {
            relation: Relation::On,
            to: Some(Said::Lane(role)),
            and: None,
            metres: None,
        };
        self.moved_to(id, &[place]);
    }

    /// To the lane that leads the other way; false if there is none.
    pub(super) fn change_direction(&mut self, id: BoxId) -> bool {
        let Some(b) = self.boxes.get(&id).copied() else {
            return false;
        };
        let with_us = b.heading().x > 0.0;
        let role = if with_us {
            LaneRole::Oncoming
        } else {
            LaneRole::Ego
        };
        if !self.map.points.iter().any(|p| p.role == role) {
            return false;
        }
        let relation = if with_us {
            Relation::Oncoming
        } else {
            Relation::SameWay
        };
        let place = Place {
            relation,
            to: Some(Said::Ego),
            and: None,
            metres: None,
        };
        self.moved_to(id, &[place])
    }

    /// Where the places hold, as near to where it was as can be; true if it is there now.
    pub(super) fn moved_to(&mut self, id: BoxId, places: &[Place]) -> bool {
        let Some(b) = self.boxes.get(&id).copied() else {
            return false;
        };
        if places.iter().any(|p| p.relation == Relation::There) {
            return self.move_there(&b);
        }
        if let Some(done) = self.only_turned(&b, places) {
            return done;
        }
        let mut plan = Plan::default();
        let mut spec = self.as_spec(&b);
        let Some(relations) = self.relations(&b, places, &mut plan) else {
            return false;
        };
        spec.relations = relations;
        if spec.relations.is_empty() {
            return false;
        }
        let aside = spec.relations.iter().any(is_aside);
        let moves = b.velocity_mps.length() > 0.5;
        let travels = spec.relations.iter().any(|r| {
            matches!(
                r.relation,
                RelationKind::OppositeDirection | RelationKind::SameDirection | RelationKind::Following
            )
        });
        if !aside {
            let sided = |r: &Stated| matches!(r.relation, RelationKind::LeftOf | RelationKind::RightOf);
            let parked = self.does(&b, ObjectState::Parked) && b.class.is_vehicle();
            spec.state = Some(match (moves || travels && b.class.is_vehicle(), parked) {
                (true, _) => ObjectState::Moving,
                // (what is parked stays so on the other side)
                (_, true) if spec.relations.iter().all(sided) => ObjectState::Parked,
                _ => ObjectState::Waiting,
            });
        } else if b.class.is_vehicle() {
            spec.state = Some(ObjectState::Parked);
        }
        let gone = self.boxes.remove(&id);
        let mut found: Option<(SceneBox, Vec<RelationKind>, bool)> = None;
        for tried in self.with_inertia(&b, &spec, moves) {
            let mut specs = vec![tried.clone()];
            specs.extend(plan.specs.iter().cloned());
            let mut held = vec![None];
            held.extend(plan.held.iter().cloned());
            let a = self.arrange(&specs, &held, Some(&b));
            if let Some(new) = a.new.first() {
                let good = a.unmet.is_empty() && a.left_out.is_empty();
                if good || found.is_none() {
                    found = Some((*new, a.unmet, tried.state == Some(ObjectState::Parked)));
                }
                if good {
                    break;
                }
            }
        }
        self.boxes.extend(gone.map(|b| (b.id, b)));
        let Some((new, unmet, parked)) = found else {
            self.remark(Remark::NoRoom { id: id.0 });
            return false;
        };
        if !unmet.is_empty() {
            self.remark(Remark::Unmet {
                relations: unmet.iter().map(|r| r.name()).collect(),
            });
        }
        let center_m = new.center_m.truncate().extend(b.center_m.z);
        let yaw_rad = new.yaw_rad;
        let still =
            (aside || parked) && b.class.is_vehicle() || spec.relations.iter().any(|r| stands(r.relation));
        let goes = !still && travels && !moves;
        if still && moves || goes {
            let speed = if goes { Self::pace(b.class) } else { 0.0 };
            let velocity_mps = DVec2::from_angle(yaw_rad) * speed;
            self.push(TextEdit::Replace {
                id,
                object: SceneBox {
                    center_m,
                    yaw_rad,
                    velocity_mps,
                    ..b
                },
            });
        } else {
            self.push(TextEdit::Move {
                id,
                center_m,
                yaw_rad,
            });
        }
        true
    }

    fn move_there(&mut self, b: &SceneBox) -> bool {
        let Some(spot) = self.gone.first().copied() else {
            self.remark(Remark::NoSpot);
            return false;
        };
        let new = SceneBox {
            center_m: spot.center_m.truncate().extend(b.center_m.z),
            yaw_rad: spot.yaw_rad,
            ..*b
        };
        let new = self.clear_of_others(new).unwrap_or(new);
        self.push(TextEdit::Move {
            id: b.id,
            center_m: new.center_m,
            yaw_rad: new.yaw_rad,
        });
        true
    }

    /// Who is only told where to look stays where he is; what stands is only turned. `None`: it has to move.
    fn only_turned(&mut self, b: &SceneBox, places: &[Place]) -> Option<bool> {
        let [place] = places else { return None };
        let p = b.center_m.truncate();
        let drives = b.velocity_mps.length() > 0.5 && b.class != Class::Pedestrian;
        let way = match (place.relation, &place.to) {
            (Relation::Facing | Relation::FacingAway, Some(to)) => {
                let at = match to {
                    Said::Ego => DVec2::ZERO,
                    Said::Thing(t) => {
                        let Some(ids) = self.others_of(t, b.id) else {
                            return Some(false);
                        };
                        self.boxes.get(ids.first()?)?.center_m.truncate()
                    }
                    Said::Crossing => self
                        .map
                        .crossing()
                        .map(|c| c.iter().sum::<DVec2>() / c.len() as f64)?,
                    Said::Junction => self.map.junction?,
                    _ => return None,
                };
                if place.relation == Relation::Facing {
                    at - p
                } else {
                    p - at
                }
            }
            (Relation::Oncoming | Relation::SameWay, Some(Said::Ego)) => {
                let along = self
                    .map
                    .nearest(p)
                    .map_or(DVec2::X, |l| if l.dir.x < 0.0 { -l.dir } else { l.dir });
                let way = if place.relation == Relation::SameWay {
                    along
                } else {
                    -along
                };
                // (a driver changes to the lane that leads there)
                let wrong = self
                    .map
                    .nearest(p)
                    .is_some_and(|l| l.dir.x.abs() > 0.5 && l.dir.dot(way) < 0.0);
                if drives && wrong {
                    return None;
                }
                way
            }
            _ => return None,
        };
        if way.length() < 1e-6 {
            return Some(false);
        }
        self.push(TextEdit::Move {
            id: b.id,
            center_m: b.center_m,
            yaw_rad: way.to_angle(),
        });
        Some(true)
    }

    /// Places as relations of a box; anchors that are boxes go to the plan, after the box itself. `None` after a question.
    fn relations(&mut self, b: &SceneBox, places: &[Place], plan: &mut Plan) -> Option<Vec<Stated>> {
        let mut out = Vec::new();
        let mut state = |relation, anchor, and, distance_m| {
            out.push(Stated {
                relation,
                anchor,
                and,
                distance_m,
            });
        };
        for place in places {
            let Some(to) = &place.to else {
                let relation = place.relation;
                self.remark(Remark::PlaceIgnored { relation });
                continue;
            };
            // (each anchor takes the index after those before; the moved box itself is 0)
            let mut anchor = |stage: &mut Self, a: &Said| -> Option<Anchor> {
                Some(match a {
                    Said::Ego => Anchor::Ego,
                    Said::Crossing => Anchor::Crossing,
                    Said::Junction => Anchor::Junction,
                    Said::Lane(role) => Anchor::Lane(*role),
                    Said::OtherSide | Said::OtherLane => {
                        Anchor::Lane(stage.opposite(b, a == &Said::OtherLane))
                    }
                    Said::EachOther => return None,
                    Said::Thing(t) => {
                        let ids = stage.others_of(t, b.id)?;
                        let boxes: Vec<SceneBox> =
                            ids.iter().filter_map(|id| stage.boxes.get(id).copied()).collect();
                        let first = boxes.first()?;
                        let mut spec = stage.as_spec(first);
                        spec.count.n = boxes.len() as u32;
                        plan.specs.push(spec);
                        plan.held.push(Some(boxes));
                        Anchor::Object(plan.specs.len())
                    }
                })
            };
            let first = anchor(self, to)?;
            let second = match &place.and {
                Some(a) => Some(anchor(self, a)?),
                None if place.relation == Relation::Between => Some(match first {
                    Anchor::Object(j) if plan.held[j - 1].as_ref().is_some_and(|x| x.len() > 1) => first,
                    _ => Anchor::Ego,
                }),
                None => None,
            };
            match (place.relation, first) {
                (Relation::At, Anchor::Ego) => {
                    let (relation, m) = (ego_side(b), place.metres);
                    state(relation, Anchor::Ego, None, m);
                }
                (Relation::Like, Anchor::Object(j)) => {
                    let model = plan.held[j - 1].as_ref().and_then(|x| x.first());
                    match model.and_then(|m| role_of(&self.map, m)) {
                        Some(role) => state(RelationKind::On, Anchor::Lane(role), None, None),
                        None => state(RelationKind::NextTo, first, None, None),
                    }
                }
                (Relation::Oncoming, Anchor::Ego) if place.metres.is_some() => {
                    state(RelationKind::InFrontOf, Anchor::Ego, None, place.metres);
                    state(RelationKind::OppositeDirection, Anchor::Ego, None, None);
                }
                (Relation::Waiting, Anchor::Lane(_)) => state(RelationKind::On, first, None, place.metres),
                (relation, _) => {
                    if let Some(kind) = kind_of(relation, to, None) {
                        state(kind, first, second, place.metres);
                    }
                }
            }
        }
        Some(out)
    }

    /// The lane or strip on the other side of the road, or the other lane.
    fn opposite(&self, b: &SceneBox, lane: bool) -> LaneRole {
        use LaneRole as L;
        let has = |role: L| self.map.points.iter().any(|p| p.role == role);
        match role_of(&self.map, b) {
            Some(L::LeftRoadside) if !lane => L::RightRoadside,
            Some(L::RightRoadside) if !lane => L::LeftRoadside,
            Some(L::LeftSidewalk) if !lane => L::RightSidewalk,
            Some(L::RightSidewalk) if !lane => L::LeftSidewalk,
            Some(L::Ego) if lane && has(L::Left) => L::Left,
            Some(L::Ego) if lane && has(L::Right) => L::Right,
            Some(L::Left | L::Right | L::Oncoming) => L::Ego,
            _ if b.class == Class::Pedestrian && b.center_m.y > 0.0 => L::RightSidewalk,
            _ if b.class == Class::Pedestrian => L::LeftSidewalk,
            _ => L::Oncoming,
        }
    }

    /// What was said with what was not said kept: most of it first, the bare words last.
    fn with_inertia(&self, b: &SceneBox, spec: &ObjectSpec, moves: bool) -> Vec<ObjectSpec> {
        use RelationKind as R;
        let mut out = Vec::new();
        let mut keep = |more: Stated| {
            let mut kept = spec.clone();
            kept.relations.push(more);
            out.push(kept);
        };
        let lane = |role| Stated {
            relation: R::On,
            anchor: Anchor::Lane(role),
            and: None,
            distance_m: None,
        };
        // Turned against the traffic it belongs to another lane; else the lane stays.
        let sideways = spec.relations.iter().any(|r| match r.relation {
            R::InFrontOf | R::Behind => {
                !matches!(r.anchor, Anchor::Ego | Anchor::Crossing | Anchor::Junction)
            }
            R::Near | R::WaitingAt | R::FarFrom => matches!(r.anchor, Anchor::Lane(_) | Anchor::Object(_)),
            R::Facing | R::FacingAway => false,
            _ => true,
        });
        // (past the ego vehicle it does not keep to the lane that comes towards it)
        let flips = spec.relations.iter().any(|r| match (r.relation, r.anchor) {
            (R::Behind, Anchor::Ego) => b.center_m.x > 0.0,
            (R::InFrontOf, Anchor::Ego) => b.center_m.x < 0.0,
            _ => false,
        });
        if !sideways
            && let Some(role) = role_of(&self.map, b)
            && !(role == LaneRole::Cross || role == LaneRole::Oncoming && flips)
        {
            keep(lane(role));
        }
        // Behind the truck is in its lane, and goes its way.
        let after = spec.relations.iter().position(|r| {
            r.relation == R::Behind
                && matches!(r.anchor, Anchor::Object(_))
                && !matches!(b.class, Class::Pedestrian | Class::TrafficCone | Class::Barrier)
        });
        if let Some(i) = after {
            let mut follows = spec.clone();
            follows.relations[i].relation = R::Following;
            out.push(follows);
        }
        // (told only a lane or a side it stays level)
        let level = spec.relations.iter().all(|r| {
            matches!(r.anchor, Anchor::Lane(_))
                || matches!(r.relation, R::OppositeDirection | R::SameDirection)
        });
        if level && b.center_m.x.abs() > 5.0 {
            let relation = if b.center_m.x > 0.0 {
                R::InFrontOf
            } else {
                R::Behind
            };
            let mut kept = spec.clone();
            kept.relations.push(Stated {
                relation,
                anchor: Anchor::Ego,
                and: None,
                distance_m: None,
            });
            out.push(kept);
        }
        out.push(spec.clone());
        // (who stands may drive there, where only driving fits; in a car park a space is where no lane is)
        out.push(ObjectSpec {
            state: None,
            ..spec.clone()
        });
        if !moves && b.class.is_vehicle() && self.layout.count(BevLayer::CarparkArea) > 200 {
            out.push(ObjectSpec {
                state: Some(ObjectState::Parked),
                ..spec.clone()
            });
        }
        out
    }
}

/// So far from the ego vehicle, on the side where it is.
fn range(metres: f64) -> Place {
    Place {
        relation: Relation::At,
        to: Some(Said::Ego),
        and: None,
        metres: Some(metres),
    }
}

fn ego_side(b: &SceneBox) -> RelationKind {
    match b.center_m.truncate() {
        p if p.x.abs() < p.y.abs() && p.y > 0.0 => RelationKind::LeftOf,
        p if p.x.abs() < p.y.abs() => RelationKind::RightOf,
        p if p.x > 0.0 => RelationKind::InFrontOf,
        _ => RelationKind::Behind,
    }
}

/// At the edge of the road, where nothing drives.
fn is_aside(r: &Stated) -> bool {
    use LaneRole as L;
    let strip = matches!(
        r.anchor,
        Anchor::Lane(L::Roadside | L::LeftRoadside | L::RightRoadside | L::Carpark)
    );
    strip && matches!(r.relation, RelationKind::On | RelationKind::ParkedOn)
}
