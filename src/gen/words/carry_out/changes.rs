//! Changes of boxes that stay where they are: another kind, paint, state or heading, or boxes swapped with each other.

use glam::DVec2;

use super::super::nouns::Noun;
use super::super::reading::{ObjectPhrase, Quantity, Traits, Turn};
use super::super::remark::Remark;
use super::super::resolve::{Spare, words_of};
use super::super::stage::Stage;
use super::adds::in_place_of;
use place::holds::overlap_m;
use scene::graph::{LaneRole, ObjectState, SizeHint};
use scene::{BoxId, BoxLabel, SceneBox};

impl Stage<'_> {
    /// Replaces one for one. If a number is stated, surplus boxes are removed and missing ones are put beside the
    /// others.
    pub(super) fn replace(&mut self, who: &[ObjectPhrase], things: &[ObjectPhrase]) {
        let ids = match self.those(who, Spare::Farthest) {
            Some(ids) => ids,
            None => {
                // (the boxes to replace may have been removed by an act before)
                let gone = std::mem::take(&mut self.gone);
                let class = |b: &SceneBox| who.iter().any(|w| w.noun.classes().contains(&b.class));
                let spots: Vec<SceneBox> = gone.into_iter().filter(class).collect();
                if let (Some(t), false) = (things.first(), spots.is_empty()) {
                    let n = super::super::plan::count_of(t.quantity).n as usize;
                    self.put_at(t, &spots, n);
                }
                return;
            }
        };
        let mut left: Vec<BoxId> = ids;
        let mut made = Vec::new();
        for (k, t) in things.iter().enumerate() {
            let wanted = match t.quantity {
                Quantity::N(n) => n as usize,
                Quantity::Range(a, _) => a as usize,
                Quantity::Some | Quantity::Many | Quantity::All | Quantity::Unsaid => left.len(),
                _ => 1,
            };
            let last = k + 1 == things.len();
            let n = wanted.min(left.len());
            let mine: Vec<BoxId> = left.drain(..n).collect();
            for id in &mine {
                self.become_kind(*id, t);
            }
            made.extend(&mine);
            if wanted > n {
                let more = ObjectPhrase {
                    quantity: Quantity::N((wanted - n) as u32),
                    ..t.clone()
                };
                let by = if mine.is_empty() { made.clone() } else { mine };
                self.add_like(&more, &by);
                made.extend(self.last.clone());
            }
            if last {
                for id in left.drain(..) {
                    self.take_box(id);
                }
            }
        }
        self.last = made;
        self.last_noun = things.first().map(|t| t.noun);
    }

    fn become_kind(&mut self, id: BoxId, t: &ObjectPhrase) {
        let Some(old) = self.boxes.get(&id).copied() else {
            return;
        };
        let Some(new) = in_place_of(&old, t, id) else {
            return;
        };
        let object = self.clear_of_others(new).unwrap_or(new);
        let hit = self
            .boxes
            .values()
            .find(|o| o.id != id && overlap_m(&object, o, 0.0) > 0.0);
        if let Some(o) = hit {
            let (id, other) = (id.0, Some(o.id.0));
            self.remark(Remark::Overlaps { id, other });
        }
        self.replace_box(object);
        if !t.places.is_empty() {
            self.moved_to(id, &t.places);
        } else if t.state == Some(ObjectState::Parked)
            && object.class.is_vehicle()
            && !self.does(&object, ObjectState::Parked)
        {
            let role = if object.center_m.y > 1.0 {
                LaneRole::LeftRoadside
            } else {
                LaneRole::RightRoadside
            };
            self.park(id, role);
        }
    }

    pub(super) fn set(&mut self, who: &[ObjectPhrase], traits: &Traits) {
        let Some(ids) = self.those(who, Spare::Nearest) else {
            return;
        };
        let mut paint = traits.paint;
        if let Some(of) = &traits.paint_of {
            paint = self.paint_of(of);
            if paint.is_none() {
                self.remark(Remark::Nobody {
                    what: format!("painted {}", words_of(of)),
                });
                return;
            }
        }
        for id in ids {
            self.set_one(id, traits, paint);
        }
        let everybody =
            |t: &ObjectPhrase| t.noun == Noun::Thing && t.quantity == Quantity::All && t.places.is_empty();
        if traits.state == Some(ObjectState::Waiting) && self.ego_moves && who.iter().any(everybody) {
            self.remark(Remark::WeGoOn);
        }
    }

    /// The paint of a thing that is there now, or was there before the first act.
    fn paint_of(&mut self, of: &ObjectPhrase) -> Option<scene::Paint> {
        let last = self.last.clone();
        let now = self.fitting(of);
        let boxes = match now.is_empty() {
            true => Some(std::mem::replace(&mut self.boxes, self.first.clone())),
            false => None,
        };
        let model = self.that(of, Spare::Nearest).and_then(|ids| ids.first().copied());
        let paint = model
            .and_then(|id| self.boxes.get(&id))
            .and_then(|b| b.label.paint);
        if let Some(boxes) = boxes {
            self.boxes = boxes;
        }
        self.last = last;
        paint
    }

    fn set_one(&mut self, id: BoxId, traits: &Traits, paint: Option<scene::Paint>) {
        let Some(b) = self.boxes.get(&id).copied() else {
            return;
        };
        if paint.is_some() && b.label.paint != paint {
            self.label_box(id, BoxLabel { paint, ..b.label });
        }
        if let Some(size) = traits.size {
            let factor = if size == SizeHint::Large { 1.18 } else { 0.85 };
            let b = self.boxes[&id];
            let base_m = b.center_m.z - b.size_m.z / 2.0;
            let size_m = b.size_m * factor;
            let center_m = b.center_m.truncate().extend(base_m + size_m.z / 2.0);
            self.replace_box(SceneBox {
                size_m,
                center_m,
                ..b
            });
        }
        let Some(state) = traits.state else { return };
        // (a box with a motion keeps it, and its voxels, until the motion is removed)
        if state == ObjectState::Waiting && self.halt_box(id) {
            return;
        }
        let b = self.boxes[&id];
        if state == ObjectState::Parked && b.class.is_vehicle() && !self.does(&b, ObjectState::Parked) {
            // (a parked box stands at the edge of the road, on its own side)
            let role = if b.center_m.y > 1.0 {
                LaneRole::LeftRoadside
            } else {
                LaneRole::RightRoadside
            };
            self.park(id, role);
            return;
        }
        let moves = b.velocity_mps.length() > 0.5;
        let can = Self::pace(b.class) > 0.0;
        if (state == ObjectState::Moving) == moves || !(moves || can) {
            return;
        }
        let speed = if state == ObjectState::Moving {
            Self::pace(b.class)
        } else {
            0.0
        };
        self.replace_box(SceneBox {
            velocity_mps: b.heading() * speed,
            ..b
        });
    }

    pub(super) fn swap(&mut self, one: &ObjectPhrase, other: &ObjectPhrase) {
        let first = self
            .that(one, Spare::Nearest)
            .and_then(|ids| ids.first().copied());
        if let Some(a) = first {
            self.speak_of(&[a], Some(one.noun));
        }
        self.skip = first;
        let second = self
            .that(other, Spare::Nearest)
            .and_then(|ids| ids.first().copied());
        self.skip = None;
        let (Some(a), Some(b)) = (first, second) else {
            return;
        };
        let (Some(one), Some(two)) = (self.boxes.get(&a).copied(), self.boxes.get(&b).copied()) else {
            return;
        };
        let at = |what: &SceneBox, place: &SceneBox| {
            let moves = place.velocity_mps.length() > 0.5;
            let speed = if moves { Self::pace(what.class) } else { 0.0 };
            let base_m = place.center_m.z - place.size_m.z / 2.0;
            SceneBox {
                center_m: place.center_m.truncate().extend(base_m + what.size_m.z / 2.0),
                yaw_rad: place.yaw_rad,
                velocity_mps: DVec2::from_angle(place.yaw_rad) * speed,
                ..*what
            }
        };
        self.boxes.remove(&a);
        self.boxes.remove(&b);
        let first = at(&one, &two);
        let first = self.clear_of_others(first).unwrap_or(first);
        self.boxes.insert(a, first);
        let second = at(&two, &one);
        let second = self.clear_of_others(second).unwrap_or(second);
        self.replace_box(first);
        self.replace_box(second);
        self.last = vec![a, b];
    }

    pub(super) fn turned(&mut self, who: &[ObjectPhrase], turn: &Turn) {
        let Some(ids) = self.those(who, Spare::Nearest) else {
            return;
        };
        if let Turn::To(places) = turn
            && self.grouped(&ids, places)
        {
            return;
        }
        for id in ids {
            let Some(b) = self.boxes.get(&id).copied() else {
                continue;
            };
            let p = b.center_m.truncate();
            let yaw_rad = match turn {
                Turn::Around => {
                    // A driver changes to the lane with that direction.
                    let drives = b.velocity_mps.length() > 0.5 && b.class != scene::Class::Pedestrian;
                    if drives && self.change_direction(id) {
                        continue;
                    }
                    b.yaw_rad + std::f64::consts::PI
                }
                Turn::Left(degrees) => b.yaw_rad + degrees.to_radians(),
                Turn::Along => self.map.nearest(p).map_or(0.0, |l| l.dir.to_angle()),
                Turn::To(places) => {
                    self.moved_to(id, places);
                    continue;
                }
            };
            self.move_box(id, b.center_m, yaw_rad);
        }
    }
}
