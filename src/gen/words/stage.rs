//! The scene while a reading is carried out: the current boxes, the things named last, and the outcome so far.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde::Serialize;

use super::nouns::Noun;
use super::remark::Remark;
use place::holds::{in_role, overlap_m, role_of};
use place::lanes::LaneMap;
use scene::clip::Manoeuvre;
use scene::graph::{LaneRole, ObjectState};
use scene::roads::{RoadChange, RoadWish};
use scene::{
    BevLayer, BevLayout, BoxId, BoxLabel, Class, Clip, Conditions, Edit, Polyline, PolylineKind, SceneBox,
    Shape,
};

/// The parts of an open scene that words need.
#[derive(Clone, Copy, Debug)]
pub struct OpenScene<'a> {
    /// Boxes by id, ego frame.
    pub boxes: &'a BTreeMap<BoxId, SceneBox>,
    /// Map.
    pub layout: &'a BevLayout,
    /// Its style in words: `night, rain`.
    pub prompt: &'a str,
    /// Its light and air.
    pub conditions: Conditions,
    /// Moving objects; without it nothing moves.
    pub clip: Option<&'a Clip>,
    /// True if the ego vehicle moves.
    pub ego_moves: bool,
    /// Length of the scene, s; 0 for one moment.
    pub length_s: f64,
}

/// A box that a question names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Its id.
    pub id: BoxId,
    /// Its class.
    pub class: &'static str,
    /// Its place, in words.
    pub place: String,
}

/// A question: several things fit where one was meant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Question {
    /// The question: `3 parked cars: which?`
    pub text: String,
    /// The act of the reading that asks, and the thing in it (in the order of the line): an answer puts an id there.
    pub act: usize,
    /// The thing in notation.
    pub thing: String,
    /// The boxes that fit.
    pub candidates: Vec<Candidate>,
}

/// Changes that an act made.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Done {
    /// Boxes that it added.
    pub added: Vec<BoxId>,
    /// Boxes that it removed, as they were.
    pub removed: Vec<SceneBox>,
    /// Boxes that it changed.
    pub changed: Vec<BoxId>,
    /// True if it changed other parts of the scene: conditions, a crossing.
    pub scene: bool,
}

impl Done {
    /// True if nothing changed.
    pub fn is_nothing(&self) -> bool {
        self.added.is_empty() && self.removed.is_empty() && self.changed.is_empty() && !self.scene
    }
}

/// Result of a reading.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReadingOutcome {
    /// Changes, in order.
    pub edits: Vec<Edit>,
    /// Questions that must be answered first; the edits are not applied before.
    pub questions: Vec<Question>,
    /// Remarks on requests that could not be met as stated, by act.
    pub remarks: Vec<(usize, Remark)>,
    /// Changes that each act made.
    pub done: Vec<Done>,
}

/// A scene that acts work on, one after the other.
pub struct Stage<'a> {
    pub(super) map: LaneMap<'a>,
    pub(super) layout: &'a BevLayout,
    pub(super) boxes: BTreeMap<BoxId, SceneBox>,
    /// Boxes as they were before the first act.
    pub(super) first: &'a BTreeMap<BoxId, SceneBox>,
    pub(super) prompt: String,
    pub(super) conditions: Conditions,
    pub(super) ego_moves: bool,
    pub(super) clip: Option<&'a Clip>,
    pub(super) length_s: f64,
    /// Manoeuvres that earlier acts gave to boxes.
    pub(super) does: BTreeMap<BoxId, Manoeuvre>,
    pub(super) seed: u64,
    pub(super) act: usize,
    /// Boxes that some act of the text states to stay.
    pub(super) stays: std::collections::BTreeSet<BoxId>,
    /// The act whose crossing was added before the first act.
    pub(super) crossing_of: Option<usize>,
    /// The box that is being moved: no other thing of its act can mean it.
    pub(super) skip: Option<BoxId>,
    /// Boxes that were named last, and their noun.
    pub(super) last: Vec<BoxId>,
    pub(super) last_noun: Option<Noun>,
    /// The group that those boxes were taken from: "the others" are the rest of it.
    pub(super) group: Vec<BoxId>,
    /// Boxes that were removed last: their places are "there".
    pub(super) gone: Vec<SceneBox>,
    pub(super) out: ReadingOutcome,
}

impl<'a> Stage<'a> {
    pub(super) fn new(scene: &OpenScene<'a>, seed: u64) -> Self {
        Self {
            map: LaneMap::new(scene.layout),
            layout: scene.layout,
            boxes: scene.boxes.clone(),
            first: scene.boxes,
            prompt: scene.prompt.to_owned(),
            conditions: scene.conditions,
            ego_moves: scene.ego_moves,
            clip: scene.clip,
            length_s: scene.length_s,
            does: BTreeMap::new(),
            seed,
            act: 0,
            stays: std::collections::BTreeSet::new(),
            crossing_of: None,
            skip: None,
            last: Vec::new(),
            last_noun: None,
            group: Vec::new(),
            gone: Vec::new(),
            out: ReadingOutcome::default(),
        }
    }

    pub(super) fn remark(&mut self, remark: Remark) {
        let entry = (self.act, remark);
        if !self.out.remarks.contains(&entry) {
            self.out.remarks.push(entry);
        }
    }

    pub(super) fn done(&mut self) -> &mut Done {
        while self.out.done.len() <= self.act {
            self.out.done.push(Done::default());
        }
        &mut self.out.done[self.act]
    }

    pub(super) fn take_box(&mut self, id: BoxId) {
        let Some(b) = self.boxes.remove(&id) else { return };
        self.gone.push(b);
        self.done().removed.push(b);
        self.out.edits.push(Edit::RemoveBox { id });
    }

    /// Adds a box; its id is free.
    pub(super) fn add_box(&mut self, b: SceneBox) {
        self.boxes.insert(b.id, b);
        self.done().added.push(b.id);
        self.out.edits.push(b.into());
    }

    /// Moves and turns a box; its speed stays and follows the new heading.
    pub(super) fn move_box(&mut self, id: BoxId, center_m: DVec3, yaw_rad: f64) {
        let Some(b) = self.boxes.get_mut(&id) else { return };
        let speed = b.velocity_mps.length();
        b.center_m = center_m;
        b.yaw_rad = yaw_rad;
        b.velocity_mps = DVec2::from_angle(yaw_rad) * speed;
        self.done().changed.push(id);
        self.out.edits.push(Edit::MoveBox {
            id,
            center_m: Some(center_m),
            yaw_deg: Some(yaw_rad.to_degrees()),
            size_m: None,
        });
    }

    /// Replaces the box of the same id.
    pub(super) fn replace_box(&mut self, b: SceneBox) {
        self.boxes.insert(b.id, b);
        self.done().changed.push(b.id);
        self.out.edits.push(Edit::RemoveBox { id: b.id });
        self.out.edits.push(b.into());
    }

    /// Stops a box that moves in the course of time; false if it does not move.
    pub(super) fn halt_box(&mut self, id: BoxId) -> bool {
        let track = self.clip.and_then(|clip| clip.tracks.get(&id));
        if track.is_none_or(|t| t.stands()) {
            return false;
        }
        if let Some(b) = self.boxes.get_mut(&id) {
            b.velocity_mps = DVec2::ZERO;
        }
        self.done().changed.push(id);
        self.out.edits.push(Edit::SetMotion {
            id: Some(id),
            motion: None,
            from_s: None,
            to_s: None,
        });
        true
    }

    pub(super) fn label_box(&mut self, id: BoxId, label: BoxLabel) {
        let Some(b) = self.boxes.get_mut(&id) else { return };
        b.label = label;
        self.done().changed.push(id);
        self.out.edits.push(Edit::LabelBox { id, label });
    }

    /// Paints a pedestrian crossing with these corners, ego frame, m.
    pub(super) fn paint_crossing(&mut self, outline_m: Vec<DVec2>) {
        self.done().scene = true;
        let lines = vec![Polyline {
            kind: PolylineKind::PedCrossing,
            points_m: outline_m,
        }];
        self.out.edits.push(Edit::AddPolylines { lines });
    }

    pub(super) fn clear_crossing(&mut self, points_m: Vec<DVec2>) {
        self.done().scene = true;
        self.out.edits.push(Edit::PaintBev {
            layer: BevLayer::PedCrossing,
            shape: Shape::Polygon { points_m },
            value: false,
        });
    }

    /// Adds a change of the road that the ego vehicle stands on; ego frame.
    pub(super) fn wish_of_road(&mut self, wish: RoadWish) {
        self.done().scene = true;
        let change = RoadChange::Wish {
            at_m: DVec2::ZERO,
            heading_deg: 0.0,
            wish,
        };
        self.out.edits.push(Edit::ChangeRoads { change });
    }

    /// Sets light and air.
    pub(super) fn set_conditions(&mut self, conditions: Conditions) {
        self.conditions = conditions;
        self.done().scene = true;
        self.out.edits.push(Edit::SetConditions { conditions });
    }

    /// Replaces the text that describes the style.
    pub(super) fn restyle(&mut self, prompt: String) {
        self.prompt.clone_from(&prompt);
        self.done().scene = true;
        self.out.edits.push(Edit::SetPrompt { prompt });
    }

    pub(super) fn next_id(&self) -> BoxId {
        let last = self.boxes.keys().chain(self.first.keys()).max();
        let gone = self.gone.iter().map(|b| b.id).max();
        BoxId(last.copied().max(gone).map_or(1, |id| id.0.saturating_add(1)))
    }

    /// The box, or the box moved a few metres along its course, where it hits nothing.
    pub(super) fn clear_of_others(&self, b: SceneBox) -> Option<SceneBox> {
        let ego = place::holds::ego();
        let hits = |n: &SceneBox| {
            let other = |o: &SceneBox| o.id != b.id && overlap_m(n, o, 0.2) > 0.0;
            self.boxes.values().any(other) || overlap_m(n, &ego, 0.2) > 0.0
        };
        (0..40)
            .map(|k| f64::from((k + 1) / 2) * if k % 2 == 0 { 0.5 } else { -0.5 })
            .map(|step| SceneBox {
                center_m: b.center_m + (b.heading() * step).extend(0.0),
                ..b
            })
            .find(|tried| !hits(tried) && tried.center_m.truncate().abs().max_element() < 38.0)
    }

    /// A box with its place in words, for a question: `red taxi, 12 m ahead, 3 m left, parked`.
    pub(super) fn candidate(&self, b: &SceneBox) -> Candidate {
        let (x, y) = (b.center_m.x, b.center_m.y);
        let along = if x >= 0.0 { "ahead" } else { "behind" };
        let across = match y {
            y if y > 0.5 => format!(", {y:.0} m left"),
            y if y < -0.5 => format!(", {:.0} m right", -y),
            _ => String::new(),
        };
        let doing = match b.velocity_mps.length() {
            v if v > 0.5 => ", moving",
            _ if b.class.is_vehicle() && self.does(b, ObjectState::Parked) => ", parked",
            _ => ", standing",
        };
        let called = match b.label.is_empty() {
            true => String::new(),
            false => format!("{}, ", b.called()),
        };
        Candidate {
            id: b.id,
            class: b.class.name(),
            place: format!("{called}{:.0} m {along}{across}{doing}", x.abs()),
        }
    }

    /// True if a box counts as moving, waiting or parked.
    pub(super) fn does(&self, b: &SceneBox, state: ObjectState) -> bool {
        let stands = b.velocity_mps.length() < 0.5;
        let p = b.center_m.truncate();
        match state {
            ObjectState::Moving => !stands,
            ObjectState::Waiting => stands,
            // Standing, and not in the middle of a lane.
            ObjectState::Parked => {
                let off = self.map.nearest(p).map_or(f64::INFINITY, |l| {
                    l.dir.perp_dot(p - l.p).abs().max(l.p.distance(p) - 1.0)
                });
                let edge = || off > 0.3 && in_role(&self.map, LaneRole::Roadside, p);
                stands && (off > 0.7 || self.map.has(BevLayer::CarparkArea.bit(), p) || edge())
            }
        }
    }

    /// The lane or strip that a box counts to.
    pub(super) fn role_of(&self, id: BoxId) -> Option<LaneRole> {
        role_of(&self.map, self.boxes.get(&id)?)
    }

    /// Speed at which objects of a class move, m/s.
    pub(super) fn pace(class: Class) -> f64 {
        match class {
            Class::Pedestrian => 1.4,
            Class::Bicycle => 4.5,
            Class::TrafficCone | Class::Barrier => 0.0,
            _ => 8.0,
        }
    }
}
