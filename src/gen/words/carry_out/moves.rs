//! Boxes that move. Parts of a place that are not mentioned stay as they were: with only the distance ahead stated the
//! box keeps its lane, with only a lane stated it keeps its distance ahead.

use glam::DVec2;

use super::super::nouns::Noun;
use super::super::plan::PlacementPlan;
use super::super::reading::{AnchorPhrase as Said, Destination, ObjectPhrase, PlacePhrase, Relation, Way};
use super::super::remark::Remark;
use super::super::resolve::Spare;
use super::super::stage::Stage;
use super::destinations::{BoxDestination, CLOSE_M, is_aside};
use place::description::{Anchor, Stated};
use place::holds::{ego, overlap_m};
use place::rules::stands;
use scene::graph::{LaneRole, ObjectState, RelationKind};
use scene::{BoxId, Class, SceneBox};

/// Width of a lane where the map has none, m.
const LANE_M: f64 = 3.5;

impl Stage<'_> {
    pub(super) fn moved(&mut self, who: &[ObjectPhrase], to: &Destination) {
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

    /// Places things in a row, side by side, or facing each other: each by the one before. True if the words asked for
    /// it.
    pub(super) fn grouped(&mut self, ids: &[BoxId], places: &[PlacePhrase]) -> bool {
        let each = |p: &PlacePhrase| p.to == Some(Said::EachOther);
        let of_group =
            |p: &&PlacePhrase| matches!(p.relation, Relation::InLine | Relation::SideBySide) || each(p);
        let Some(group) = places.iter().find(of_group).cloned() else {
            return false;
        };
        if ids.len() < 2 {
            let relation = group.relation;
            self.remark(Remark::PlaceIgnored { relation });
            return true;
        }
        // (the other places apply to the first thing)
        let rest: Vec<PlacePhrase> = places.iter().filter(|p| **p != group).cloned().collect();
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
            let mut other = ObjectPhrase::new(Noun::Thing);
            other.id = Some(by.0);
            let place = PlacePhrase {
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

    /// The boxes that a thing means, other than the moved one.
    pub(super) fn others_of(&mut self, t: &ObjectPhrase, moved: BoxId) -> Option<Vec<BoxId>> {
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
                // Along its lane, if the lane leads to the ego vehicle.
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

    /// Distance to go if none was stated: the first step that ends clear of others.
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
        self.move_box(id, center_m, b.yaw_rad);
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
        self.move_box(b.id, new.center_m, yaw_rad);
    }

    /// Moves a box to the edge of the road.
    pub(super) fn park(&mut self, id: BoxId, role: LaneRole) {
        let place = PlacePhrase {
            relation: Relation::On,
            to: Some(Said::Lane(role)),
            and: None,
            metres: None,
        };
        self.moved_to(id, &[place]);
    }

    /// Moves a box to the lane of the opposite direction; false if there is none.
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
        let place = PlacePhrase {
            relation,
            to: Some(Said::Ego),
            and: None,
            metres: None,
        };
        self.moved_to(id, &[place])
    }

    /// Moves a box to where the places hold, as near to its old place as possible; true if it is there now.
    pub(super) fn moved_to(&mut self, id: BoxId, places: &[PlacePhrase]) -> bool {
        let Some(b) = self.boxes.get(&id).copied() else {
            return false;
        };
        if places.iter().any(|p| p.relation == Relation::There) {
            return self.move_there(&b);
        }
        if let Some(done) = self.only_turned(&b, places) {
            return done;
        }
        let mut plan = PlacementPlan::default();
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
                // (a parked box stays parked on the other side)
                (_, true) if spec.relations.iter().all(sided) => ObjectState::Parked,
                _ => ObjectState::Waiting,
            });
        } else if b.class.is_vehicle() {
            spec.state = Some(ObjectState::Parked);
        }
        let mut found = self.destination(&b, &spec, &plan);
        // (it was there already: then a closer place is meant)
        if found.as_ref().is_some_and(|f| f.moved_m(&b) < 1.0) {
            let mut closer = spec.clone();
            let mut open = false;
            for r in &mut closer.relations {
                if let (RelationKind::InFrontOf | RelationKind::Behind, Anchor::Object(j), None) =
                    (r.relation, r.anchor, r.distance_m)
                    && let Some(other) = plan.held[j - 1].as_ref().and_then(|x| x.first())
                {
                    r.distance_m = Some((b.size_m.x + other.size_m.x) / 2.0 + CLOSE_M);
                    open = true;
                }
            }
            let near = open.then(|| self.destination(&b, &closer, &plan)).flatten();
            found = near.filter(|f| f.unmet.is_empty()).or(found);
        }
        let Some(BoxDestination {
            new,
            unmet,
            parked,
            off,
        }) = found
        else {
            self.remark(Remark::NoRoom { id: id.0 });
            return false;
        };
        if !unmet.is_empty() {
            self.remark(Remark::Unmet {
                relations: unmet.iter().map(|r| r.name()).collect(),
            });
        }
        let said = |m: f64| {
            places
                .iter()
                .any(|p| p.metres.is_some_and(|s| (s - m).abs() < 1e-9))
        };
        let off: Vec<_> = off
            .into_iter()
            .filter(|(_, [asked_m, _])| said(*asked_m))
            .collect();
        self.tell_off(&off);
        let center_m = new.center_m.truncate().extend(b.center_m.z);
        let yaw_rad = new.yaw_rad;
        let still =
            (aside || parked) && b.class.is_vehicle() || spec.relations.iter().any(|r| stands(r.relation));
        let goes = !still && travels && !moves;
        if still && moves || goes {
            let speed = if goes { Self::pace(b.class) } else { 0.0 };
            let velocity_mps = DVec2::from_angle(yaw_rad) * speed;
            self.replace_box(SceneBox {
                center_m,
                yaw_rad,
                velocity_mps,
                ..b
            });
        } else {
            self.move_box(id, center_m, yaw_rad);
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
        self.move_box(b.id, new.center_m, new.yaw_rad);
        true
    }

    /// Turns a box that is only told a direction to face. It stays at its place; `None` if it has to move for that.
    /// False after a question.
    fn only_turned(&mut self, b: &SceneBox, places: &[PlacePhrase]) -> Option<bool> {
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
                // (a driver changes to the lane with that direction)
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
        self.move_box(b.id, b.center_m, way.to_angle());
        Some(true)
    }
}

/// A place at a distance from the ego vehicle, on the side where the box is.
fn range(metres: f64) -> PlacePhrase {
    PlacePhrase {
        relation: Relation::At,
        to: Some(Said::Ego),
        and: None,
        metres: Some(metres),
    }
}
