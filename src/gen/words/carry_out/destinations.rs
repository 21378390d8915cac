//! Destination of a box that moves, as relations, and the parts of its old place that are kept because they were not
//! mentioned.

use super::super::plan::PlacementPlan;
use super::super::reading::{AnchorPhrase as Said, PlacePhrase, Relation};
use super::super::remark::Remark;
use super::super::resolve::kind_of;
use super::super::stage::Stage;
use place::description::{Anchor, ObjectSpec, Stated};
use place::holds::role_of;
use scene::graph::{LaneRole, ObjectState, RelationKind};
use scene::{BevLayer, Class, SceneBox};

/// The gap between two things that stand close behind each other, m.
pub(super) const CLOSE_M: f64 = 4.5;

/// Destination of a box.
pub(super) struct BoxDestination {
    pub(super) new: SceneBox,
    /// Stated relations that do not hold there.
    pub(super) unmet: Vec<RelationKind>,
    pub(super) parked: bool,
    /// Distances that differ from the ones asked for: relation, and distance asked for and found, m.
    pub(super) off: Vec<(RelationKind, [f64; 2])>,
}

impl BoxDestination {
    /// Distance from the old place of the box, m.
    pub(super) fn moved_m(&self, b: &SceneBox) -> f64 {
        (self.new.center_m - b.center_m).truncate().length()
    }
}

impl Stage<'_> {
    /// The place that fits `spec` and is nearest to the box's old place, with most of the unmentioned relations kept.
    pub(super) fn destination(
        &mut self,
        b: &SceneBox,
        spec: &ObjectSpec,
        plan: &PlacementPlan,
    ) -> Option<BoxDestination> {
        let gone = self.boxes.remove(&b.id);
        let mut found: Option<BoxDestination> = None;
        for tried in self.with_inertia(b, spec, b.velocity_mps.length() > 0.5) {
            let mut specs = vec![tried.clone()];
            specs.extend(plan.specs.iter().cloned());
            let mut held = vec![None];
            held.extend(plan.held.iter().cloned());
            let a = self.arrange(&specs, &held, Some(b));
            let Some(new) = a.new.first() else { continue };
            let good = a.unmet.is_empty() && a.left_out.is_empty();
            if good || found.is_none() {
                found = Some(BoxDestination {
                    new: *new,
                    unmet: a.unmet,
                    off: a.off,
                    parked: tried.state == Some(ObjectState::Parked),
                });
            }
            if good {
                break;
            }
        }
        self.boxes.extend(gone.map(|b| (b.id, b)));
        found
    }

    /// Places as relations of a box. Anchors that are boxes are added to the plan, after the box itself. `None` after a
    /// question.
    pub(super) fn relations(
        &mut self,
        b: &SceneBox,
        places: &[PlacePhrase],
        plan: &mut PlacementPlan,
    ) -> Option<Vec<Stated>> {
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
    pub(super) fn opposite(&self, b: &SceneBox, lane: bool) -> LaneRole {
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

    /// Specs to try in turn: the stated relations with unmentioned ones (such as the lane) kept, the most complete
    /// first, then the stated ones alone.
    pub(super) fn with_inertia(&self, b: &SceneBox, spec: &ObjectSpec, moves: bool) -> Vec<ObjectSpec> {
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
        // If it is turned against the traffic it belongs to another lane; else the lane stays.
        let sideways = spec.relations.iter().any(|r| match r.relation {
            R::InFrontOf | R::Behind => {
                !matches!(r.anchor, Anchor::Ego | Anchor::Crossing | Anchor::Junction)
            }
            R::Near | R::WaitingAt | R::FarFrom => matches!(r.anchor, Anchor::Lane(_) | Anchor::Object(_)),
            R::Facing | R::FacingAway => false,
            _ => true,
        });
        // (a box moved past the ego vehicle does not stay in the oncoming lane)
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
        // "Behind the truck" means in its lane and in its direction.
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
        // (with only a lane or a side stated, the distance ahead stays)
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
        // (a standing box may drive there, where only driving fits; in a car park, spaces are off the lanes)
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

fn ego_side(b: &SceneBox) -> RelationKind {
    match b.center_m.truncate() {
        p if p.x.abs() < p.y.abs() && p.y > 0.0 => RelationKind::LeftOf,
        p if p.x.abs() < p.y.abs() => RelationKind::RightOf,
        p if p.x > 0.0 => RelationKind::InFrontOf,
        _ => RelationKind::Behind,
    }
}

/// True for a place at the edge of the road, off the driving lanes.
pub(super) fn is_aside(r: &Stated) -> bool {
    use LaneRole as L;
    let strip = matches!(
        r.anchor,
        Anchor::Lane(L::Roadside | L::LeftRoadside | L::RightRoadside | L::Carpark)
    );
    strip && matches!(r.relation, RelationKind::On | RelationKind::ParkedOn)
}
