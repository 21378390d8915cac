//! Boxes that an edit moves, turns or exchanges. What is not said of a box stays as it was: told only how far ahead it
//! shall be it keeps its lane, told only a lane it keeps level.

use glam::DVec2;

use super::description::{Anchor, Description, ObjectSpec, Stated};
use super::edit::{Editor, TextEdit};
use super::edit_grammar::{Command, Destination, Turn};
use super::edit_place::Arranged;
use super::holds::{ego, overlap_m, role_of};
use super::tokens::Span;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};
use crate::scene::{BoxId, Class, SceneBox};

/// Width of a lane where the map does not say, m.
const LANE_M: f64 = 3.5;

impl Editor<'_> {
    /// A new place for one box: by metres, by lanes, or where a relation holds.
    pub(super) fn shift(&mut self, id: BoxId, c: &Command) {
        let Some(b) = self.boxes.get(&id).copied() else {
            return;
        };
        match &c.destination {
            Some(Destination::By { direction, metres }) => {
                let metres = metres.unwrap_or_else(|| self.free_step(&b, *direction));
                self.step(&b, *direction * metres);
            }
            Some(Destination::Toward { away, metres }) => {
                let p = b.center_m.truncate();
                let metres = metres.unwrap_or(3.5);
                let step = if *away {
                    metres
                } else {
                    -metres.min((p.length() - 4.0).max(0.0))
                };
                // Along its lane, if that leads to the ego vehicle.
                let way = p.normalize_or(DVec2::X);
                let lane = self.map.nearest(p).filter(|l| l.p.distance(p) < 4.5);
                let way = lane
                    .map(|l| if l.dir.dot(way) < 0.0 { -l.dir } else { l.dir })
                    .filter(|d| d.dot(way) > 0.7)
                    .unwrap_or(way);
                self.step(&b, way * step);
            }
            Some(Destination::Range(metres)) => {
                let spec = range(&b, *metres, c.span);
                self.move_to_place(&b, &spec, c);
            }
            Some(Destination::Times(factor)) => {
                let p = b.center_m.truncate();
                let now = if p.x.abs() < p.y.abs() {
                    p.y.abs()
                } else {
                    p.x.abs()
                };
                let spec = range(&b, now * factor, c.span);
                self.move_to_place(&b, &spec, c);
            }
            Some(Destination::Lanes(n)) => self.change_lane(&b, *n),
            Some(Destination::Place(spec)) => {
                let mut spec = spec.as_ref().clone();
                let said = c.text.to_lowercase();
                // "the opposite kerb" is the one that it does not stand at
                let opposite = ["opposite", "other", "far"].iter().any(|w| {
                    [
                        "kerb", "curb", "pavement", "sidewalk", "side", "roadside", "footpath", "edge",
                        "verge",
                    ]
                    .iter()
                    .any(|s| said.contains(&format!("{w} {s}")))
                });
                // What stands at the edge of the road stands at the other edge there.
                let over = ["other side", "opposite side", "far side", "across the"]
                    .iter()
                    .any(|w| said.contains(w));
                let aside = b.class.is_vehicle()
                    && super::select::state_of(&self.map, &b, ObjectState::Parked)
                    || matches!(
                        role_of(&self.map, &b),
                        Some(LaneRole::LeftRoadside | LaneRole::RightRoadside)
                    ) && b.velocity_mps.length() < 0.5;
                let over = over || opposite;
                if over && aside {
                    for r in &mut spec.relations {
                        if r.anchor == Anchor::Lane(LaneRole::Oncoming) {
                            r.anchor = Anchor::Lane(LaneRole::LeftRoadside);
                        }
                    }
                }
                let mut named = false;
                for r in spec.relations.iter_mut().filter(|_| opposite) {
                    let before = r.anchor;
                    r.anchor = match (r.anchor, b.center_m.y > 0.0) {
                        (Anchor::Lane(LaneRole::Roadside), false) => Anchor::Lane(LaneRole::LeftRoadside),
                        (Anchor::Lane(LaneRole::Sidewalk), false) => Anchor::Lane(LaneRole::LeftSidewalk),
                        (Anchor::Lane(LaneRole::Roadside), true) => Anchor::Lane(LaneRole::RightRoadside),
                        (Anchor::Lane(LaneRole::Sidewalk), true) => Anchor::Lane(LaneRole::RightSidewalk),
                        (other, _) => other,
                    };
                    named |= r.anchor != before;
                }
                // The other side is that on which it is not (a little left in its lane is no side).
                if b.center_m.y > 1.0
                    && !named
                    && [
                        "opposite",
                        "other side",
                        "far side",
                        "across the",
                        "other pavement",
                        "other sidewalk",
                        "other kerb",
                        "other curb",
                    ]
                    .iter()
                    .any(|w| said.contains(w))
                {
                    spec.relations.iter_mut().for_each(mirrored);
                }
                self.move_to_place(&b, &spec, c);
            }
            None => self.note(format!("{:?}: where to was not understood", c.text)),
        }
    }

    /// How far to go where no distance was said: the first step that ends clear of others.
    fn free_step(&mut self, b: &SceneBox, direction: DVec2) -> f64 {
        let free = [3.5, 7.0, 5.0, 10.5, 2.0].into_iter().find(|m| {
            let new = SceneBox {
                center_m: b.center_m + (direction * *m).extend(0.0),
                ..*b
            };
            let apart = |o: &SceneBox| overlap_m(&new, o, 0.2) <= 0.0;
            apart(&ego()) && self.boxes.values().all(|o| o.id == b.id || apart(o))
        });
        let metres = free.unwrap_or(3.5);
        self.note(format!("no distance was said: moved by {metres} m"));
        metres
    }

    /// Moves a box by a vector.
    fn step(&mut self, b: &SceneBox, by: DVec2) {
        let center_m = b.center_m + by.extend(0.0);
        let id = b.id;
        if center_m.truncate().abs().max_element() > 40.0 {
            self.note(format!(
                "box {} would leave the scene, which reaches 40 m from the ego vehicle: not moved",
                id.0
            ));
            return;
        }
        let new = SceneBox { center_m, ..*b };
        let hit = self
            .boxes
            .values()
            .find(|o| o.id != id && overlap_m(&new, o, 0.0) > 0.0);
        if let Some(o) = hit {
            let text = format!("box {} now overlaps box {} ({})", id.0, o.id.0, o.class.label());
            self.note(text);
        } else if overlap_m(&new, &ego(), 0.0) > 0.0 {
            self.note(format!("box {} now overlaps the ego vehicle", id.0));
        }
        self.push(TextEdit::Move {
            id,
            center_m,
            yaw_rad: b.yaw_rad,
        });
    }

    /// So many lanes to the left of where it is, as the ego vehicle sees it; to the right if negative.
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
            self.note(format!("no lane is there for box {}: not moved", b.id.0));
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

    /// The box, or the same a few metres along its course, where it hits nothing.
    pub(super) fn clear_of_others(&self, b: SceneBox) -> Option<SceneBox> {
        let hits = |n: &SceneBox| {
            self.boxes
                .values()
                .any(|o| o.id != b.id && overlap_m(n, o, 0.2) > 0.0)
                || overlap_m(n, &ego(), 0.2) > 0.0
        };
        (0..40)
            .map(|k| f64::from((k + 1) / 2) * if k % 2 == 0 { 0.5 } else { -0.5 })
            .map(|step| SceneBox {
                center_m: b.center_m + (b.heading() * step).extend(0.0),
                ..b
            })
            .find(|tried| !hits(tried) && tried.center_m.truncate().abs().max_element() < 38.0)
    }

    /// Where the relations hold, as near to where it was as can be.
    fn move_to_place(&mut self, b: &SceneBox, spec: &ObjectSpec, c: &Command) {
        let said = c.text.to_lowercase();
        let mut spec = spec.clone();
        let aside = spec.relations.iter().any(is_aside);
        let parks = said.contains("park") || aside;
        let moves = b.velocity_mps.length() > 0.5;
        let told = spec.state;
        if spec.state.is_none() && !aside {
            let at_edge = matches!(
                role_of(&self.map, b),
                Some(LaneRole::LeftRoadside | LaneRole::RightRoadside | LaneRole::Carpark)
            );
            let sided = spec
                .relations
                .iter()
                .all(|r| matches!(r.relation, RelationKind::LeftOf | RelationKind::RightOf));
            spec.state = Some(if moves {
                ObjectState::Moving
            } else if at_edge && sided && b.class.is_vehicle() {
                ObjectState::Parked // what is parked stays so on the other side
            } else {
                ObjectState::Waiting
            });
        }
        spec.size_m = Some(b.size_m.to_array());
        spec.size = None;
        let gone = self.boxes.remove(&b.id);
        let mut found = None;
        let mut tries = self.with_inertia(b, &spec);
        if told.is_none() {
            // (who stands may drive there, where only driving fits)
            let free = ObjectSpec {
                state: None,
                ..spec.clone()
            };
            tries.push(free);
        }
        // (in a car park, who stands finds a space where no lane is)
        let stood = !moves && b.class.is_vehicle() && spec.state != Some(ObjectState::Parked);
        if stood && !aside && self.layout.count(crate::scene::BevLayer::CarparkArea) > 200 {
            let parked = ObjectSpec {
                state: Some(ObjectState::Parked),
                ..spec.clone()
            };
            tries.push(parked);
        }
        for tried in &tries {
            let d = Description {
                foreground: c.with_anchors(tried, b.class),
                ..Description::default()
            };
            match self.arrange(&d, Some(b)) {
                Arranged::Asked => {
                    self.boxes.extend(gone.map(|b| (b.id, b)));
                    return;
                }
                Arranged::Placed { new, left_out, unmet } => {
                    if let Some(new) = new.first() {
                        let good = unmet.is_empty() && left_out.is_empty();
                        if good || found.is_none() {
                            found = Some((*new, unmet, tried.state == Some(ObjectState::Parked)));
                        }
                        if good {
                            break;
                        }
                    }
                }
            }
        }
        self.boxes.extend(gone.map(|b| (b.id, b)));
        let Some((new, unmet, parked)) = found else {
            self.note(format!("box {} finds no room there: not moved", b.id.0));
            return;
        };
        if !unmet.is_empty() {
            self.note(format!("not everything said could be met: {}", unmet.join(", ")));
        }
        let center_m = new.center_m.truncate().extend(b.center_m.z);
        let id = b.id;
        let yaw_rad = new.yaw_rad;
        self.push(TextEdit::Move {
            id,
            center_m,
            yaw_rad,
        });
        // What stands at the roadside does not drive; what was told to drive does.
        let stands = (parks || parked) && b.class.is_vehicle()
            || matches!(told, Some(ObjectState::Parked | ObjectState::Waiting))
            || spec.relations.iter().any(|r| super::place::stands(r.relation));
        let goes = told == Some(ObjectState::Moving);
        if stands && moves || goes && !moves && !stands {
            let object = SceneBox {
                center_m,
                yaw_rad,
                velocity_mps: Self::pace(b.class, DVec2::from_angle(yaw_rad), goes && !stands),
                ..*b
            };
            self.push(TextEdit::Replace { id, object });
        }
    }

    /// What was said with what was not said kept: most of it first, the bare words last.
    fn with_inertia(&self, b: &SceneBox, spec: &ObjectSpec) -> Vec<ObjectSpec> {
        use RelationKind as R;
        let mut spec = spec.clone();
        let ego_side = spec
            .relations
            .iter()
            .position(|r| r.anchor == Anchor::Ego && matches!(r.relation, R::LeftOf | R::RightOf));
        let range = spec
            .relations
            .iter()
            .find(|r| r.anchor == Anchor::Ego && r.relation == R::Near)
            .and_then(|r| r.distance_m);
        let lengthwise = |r: &Stated| matches!(r.relation, R::InFrontOf | R::Behind | R::Following);
        let mut out = Vec::new();
        // "on our left, 6 m from us" is right beside.
        if let (Some(i), Some(d), false) = (ego_side, range, spec.relations.iter().any(lengthwise))
            && spec.relations[i].distance_m.is_none()
        {
            let mut beside = spec.clone();
            beside.relations[i].distance_m = Some(d);
            out.push(beside);
        }
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
            let mut kept = spec.clone();
            kept.relations.push(Stated {
                relation: R::On,
                anchor: Anchor::Lane(role),
                and: None,
                distance_m: None,
                span: spec.span,
            });
            out.push(kept);
        }
        // (what was parked and drives before us now drives in our lane)
        let parked = super::select::state_of(&self.map, b, ObjectState::Parked);
        let before_us =
            |r: &Stated| r.anchor == Anchor::Ego && matches!(r.relation, R::InFrontOf | R::Behind);
        if !sideways
            && parked
            && spec.state == Some(ObjectState::Moving)
            && b.class.is_vehicle()
            && spec.relations.iter().any(before_us)
        {
            let mut ours = spec.clone();
            ours.relations.push(Stated {
                relation: R::On,
                anchor: Anchor::Lane(LaneRole::Ego),
                and: None,
                distance_m: None,
                span: spec.span,
            });
            out.insert(0, ours);
        }
        // Behind the truck is in its lane, and goes its way.
        let after = spec.relations.iter().position(|r| {
            r.relation == R::Behind
                && matches!(r.anchor, Anchor::Object(_))
                && b.class != Class::Pedestrian
                && !matches!(b.class, Class::TrafficCone | Class::Barrier)
        });
        if let Some(i) = after {
            let mut follows = spec.clone();
            follows.relations[i].relation = R::Following;
            out.push(follows);
        }
        spec.relations.dedup();
        out.push(spec);
        out
    }

    /// Exchanges the places of two boxes: each takes the other's place, heading and whether it moves.
    pub(super) fn swap(&mut self, a: BoxId, b: BoxId) {
        let (Some(one), Some(two)) = (self.boxes.get(&a).copied(), self.boxes.get(&b).copied()) else {
            return;
        };
        let (first, second) = (self.boxes.remove(&a), self.boxes.remove(&b));
        let at = |what: &SceneBox, place: &SceneBox| {
            let moves = place.velocity_mps.length() > 0.5;
            let yaw_rad = place.yaw_rad;
            SceneBox {
                center_m: place.center_m.truncate().extend(what.center_m.z),
                yaw_rad,
                velocity_mps: Self::pace(what.class, DVec2::from_angle(yaw_rad), moves),
                ..*what
            }
        };
        let (one, two) = (at(&one, &two), at(&two, &one));
        let one = self.clear_of_others(one).unwrap_or(one);
        self.boxes.insert(a, one);
        let two = self.clear_of_others(two).unwrap_or(two);
        self.boxes.extend(first.map(|x| (x.id, x)));
        self.boxes.extend(second.map(|x| (x.id, x)));
        self.push(TextEdit::Replace { id: a, object: one });
        self.push(TextEdit::Replace { id: b, object: two });
    }

    /// Turns a box where it stands.
    pub(super) fn turn(&mut self, id: BoxId, c: &Command) {
        let Some(b) = self.boxes.get(&id).copied() else {
            return;
        };
        let p = b.center_m.truncate();
        let along = |with_ego: bool| {
            self.map.nearest(p).map_or(0.0, |l| {
                let back = with_ego && l.dir.x < 0.0;
                if back { -l.dir } else { l.dir }.to_angle()
            })
        };
        let yaw_rad = match c.turn {
            Some(Turn::By(rad)) => b.yaw_rad + rad,
            Some(Turn::ToEgo) => (-p).to_angle(),
            Some(Turn::FromEgo) => p.to_angle(),
            Some(Turn::WithLane) => along(false),
            Some(way @ (Turn::WithEgo | Turn::Against)) => {
                let with = way == Turn::WithEgo;
                let against_lane = self
                    .map
                    .nearest(p)
                    .is_some_and(|l| l.dir.x.abs() > 0.5 && (l.dir.x > 0.0) != with);
                // A driver changes to the lane that leads there; what was parked and shall drive leaves the edge of the road.
                let pulls_out = c.state == Some(ObjectState::Moving)
                    && super::select::state_of(&self.map, &b, ObjectState::Parked);
                let drives =
                    (b.velocity_mps.length() > 0.5 || c.state == Some(ObjectState::Moving)) && against_lane;
                if (drives || pulls_out) && b.class != Class::Pedestrian {
                    let relation = if with {
                        RelationKind::SameDirection
                    } else {
                        RelationKind::OppositeDirection
                    };
                    let mut spec = range(&b, 0.0, c.span);
                    spec.relations[0].relation = relation;
                    spec.relations[0].distance_m = None;
                    if pulls_out {
                        spec.state = Some(ObjectState::Moving);
                        let lane = if with { LaneRole::Ego } else { LaneRole::Oncoming };
                        spec.relations.push(Stated {
                            relation: RelationKind::On,
                            anchor: Anchor::Lane(lane),
                            ..spec.relations[0]
                        });
                    }
                    self.move_to_place(&b, &spec, c);
                    return;
                }
                let yaw = along(true);
                if with { yaw } else { yaw + std::f64::consts::PI }
            }
            None => {
                self.note(format!("{:?}: how far to turn was not understood", c.text));
                return;
            }
        };
        self.push(TextEdit::Move {
            id,
            center_m: b.center_m,
            yaw_rad,
        });
    }
}

/// So far from the ego vehicle, on the side where it is now.
fn range(b: &SceneBox, metres: f64, span: Span) -> ObjectSpec {
    let p = b.center_m.truncate();
    let relation = match p {
        p if p.x.abs() < p.y.abs() && p.y > 0.0 => RelationKind::LeftOf,
        p if p.x.abs() < p.y.abs() => RelationKind::RightOf,
        p if p.x > 0.0 => RelationKind::InFrontOf,
        _ => RelationKind::Behind,
    };
    ObjectSpec {
        class: b.class,
        noun: b.class.label(),
        count: super::description::Count::exactly(1),
        state: None,
        size: None,
        color: None,
        attributes: Vec::new(),
        size_m: None,
        relations: vec![Stated {
            relation,
            anchor: Anchor::Ego,
            and: None,
            distance_m: Some(metres),
            span,
        }],
        span,
    }
}

/// At the edge of the road, where nothing drives.
fn is_aside(r: &Stated) -> bool {
    let strip = matches!(
        r.anchor,
        Anchor::Lane(
            LaneRole::Roadside | LaneRole::LeftRoadside | LaneRole::RightRoadside | LaneRole::Carpark
        )
    );
    strip && matches!(r.relation, RelationKind::On | RelationKind::ParkedOn)
}

/// Left for right.
fn mirrored(r: &mut Stated) {
    use Anchor::Lane;
    if r.relation == RelationKind::LeftOf {
        r.relation = RelationKind::RightOf;
    }
    r.anchor = match r.anchor {
        Lane(LaneRole::LeftSidewalk) => Lane(LaneRole::RightSidewalk),
        Lane(LaneRole::LeftRoadside) => Lane(LaneRole::RightRoadside),
        Lane(LaneRole::Oncoming) => Lane(LaneRole::Ego),
        other => other,
    };
}
