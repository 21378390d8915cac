//! Numbers of boxes: so many are kept, those too many go, those too few come; one kind in the place of another.

use glam::DVec3;

use super::description::{Anchor, Count, Description, ObjectSpec, Stated};
use super::edit::{Editor, TextEdit};
use super::edit_grammar::Command;
use super::holds::{overlap_m, role_of};
use super::rephrase::Change;
use super::select::{Chosen, choose};
use crate::scene::graph::RelationKind;
use crate::scene::{BoxId, Class, SceneBox};

impl Editor<'_> {
    pub(super) fn take_absent(&mut self, d: &Description) {
        self.take_absent_but(d, &[]);
    }

    /// Takes away what shall not be there, except these.
    pub(super) fn take_absent_but(&mut self, d: &Description, spared: &[BoxId]) {
        for a in &d.absent {
            let ids: Vec<BoxId> = self
                .boxes
                .values()
                .filter(|b| a.classes.contains(&b.class) && !spared.contains(&b.id))
                .filter(|b| a.state.is_none_or(|s| super::select::state_of(&self.map, b, s)))
                .map(|b| b.id)
                .collect();
            ids.iter().for_each(|id| self.push(TextEdit::Remove { id: *id }));
        }
    }

    pub(super) fn keep_only(&mut self, ids: &[BoxId]) {
        let others: Vec<BoxId> = self
            .boxes
            .keys()
            .filter(|id| !ids.contains(id))
            .copied()
            .collect();
        others
            .iter()
            .for_each(|id| self.push(TextEdit::Remove { id: *id }));
        self.last = ids.to_vec();
    }

    /// The boxes that a mention fits, children apart from adults where the scene has both.
    fn those_meant(&self, m: &super::mention::Mention, c: &Command) -> Vec<BoxId> {
        let mut m = m.clone();
        // (people at a place are counted there, walking or not)
        if m.spec.class == Class::Pedestrian && !m.spec.relations.is_empty() {
            m.spec.state = None;
        }
        let m = &m;
        let ids = super::select::fitting(&self.map, &self.boxes, m, &c.mentions);
        let boxes: Vec<SceneBox> = ids.iter().map(|id| self.boxes[id]).collect();
        super::select::of_size(&boxes, &m.spec.noun, m.spec.size_m)
            .iter()
            .map(|b| b.id)
            .collect()
    }

    /// "only two cars": removes the farthest or adds.
    pub(super) fn keep(&mut self, c: &Command) {
        if c.change.is_none() && c.targets.iter().any(super::mention::means_all) {
            return; // "keep everything"
        }
        // "keep only the van and the woman", "keep only the cars and the cones"
        let named = |m: &super::mention::Mention| m.definite || m.uncounted && m.plural;
        if c.change.is_none() && c.targets.len() > 1 && c.targets.iter().any(named) {
            let mut stay = Vec::new();
            for m in &c.targets {
                if m.uncounted && m.plural {
                    stay.extend(self.those_meant(m, c));
                    continue;
                }
                match choose(&self.map, &self.boxes, m, &c.mentions) {
                    Chosen::These(ids) => stay.extend(ids),
                    _ => {
                        self.note(format!("{:?}: which are to stay was not clear", c.text));
                        return;
                    }
                }
            }
            self.keep_only(&stay);
            return;
        }
        // all else goes only where that is said: "only the bus", "keep the bus"
        let said = c.text.to_lowercase();
        let said = said.trim_start_matches(|ch: char| !ch.is_alphabetic());
        let keeps = c.only
            || [
                "keep", "leave", "retain", "preserve", "save", "spare", "only", "just", "let", "stick",
            ]
            .iter()
            .any(|w| said.starts_with(w) || said.contains(&format!(" {w} ")));
        for m in &c.targets {
            let fitting = self.those_meant(m, c);
            let wanted = match c.change {
                Some(Change::Times(f)) => (fitting.len() as f64 * f).round() as usize,
                Some(Change::Plus(n)) => (fitting.len() as i64 + n).max(0) as usize,
                None => m.spec.count.n as usize,
            };
            if c.change.is_none() && m.definite && !m.plural {
                // "keep only the bus"
                if !keeps {
                    self.note(format!(
                        "{:?}: what should become of it was not understood",
                        c.text
                    ));
                    continue;
                }
                match choose(&self.map, &self.boxes, m, &c.mentions) {
                    Chosen::These(ids) => self.keep_only(&ids),
                    _ => self.note(format!("{:?}: which is to stay was not clear", c.text)),
                }
                continue;
            }
            if c.change.is_none() && m.uncounted && m.plural {
                // "only cars", "keep the cars"; "raise the cars" says not how many
                if !keeps {
                    self.note(format!("{:?}: how many was not understood", c.text));
                    continue;
                }
                self.keep_only(&fitting);
                continue;
            }
            // "leave only the two cars": nothing else stays
            if c.only && c.change.is_none() && m.definite && !m.uncounted && fitting.len() == wanted {
                self.keep_only(&fitting);
                continue;
            }
            if fitting.len() > wanted {
                let mut by_range: Vec<(f64, BoxId)> = fitting
                    .iter()
                    .map(|id| (self.boxes[id].center_m.truncate().length(), *id))
                    .collect();
                by_range.sort_by(|a, b| b.0.total_cmp(&a.0));
                for (_, id) in by_range.iter().take(fitting.len() - wanted) {
                    self.push(TextEdit::Remove { id: *id });
                }
                self.last = fitting
                    .iter()
                    .filter(|id| self.boxes.contains_key(id))
                    .copied()
                    .collect();
                self.note(format!("the {} farthest were removed", fitting.len() - wanted));
            } else if fitting.len() < wanted {
                let mut spec = m.spec.clone();
                spec.count = Count::exactly((wanted - fitting.len()) as u32);
                self.like_the_others(&mut spec, &fitting);
                let foreground = match side_by_side(said).then(|| self.beside_those(&spec)) {
                    Some(pair) => pair,
                    None => self.with_those_named(spec, c),
                };
                let d = Description {
                    foreground,
                    ..Description::default()
                };
                self.add(&d);
            }
        }
    }

    /// "three workers near the barriers": with the barriers that are there.
    fn with_those_named(&self, spec: ObjectSpec, c: &Command) -> Vec<ObjectSpec> {
        let points = |o: &ObjectSpec| {
            let at = |a: Anchor| matches!(a, Anchor::Object(_));
            o.relations.iter().any(|r| at(r.anchor) || r.and.is_some_and(at))
        };
        let mut all = c.reading.description.foreground.clone();
        let own = all.iter().position(|o| o.span == spec.span);
        let there = |o: &ObjectSpec| o.span == spec.span || self.definite.contains(&o.span);
        match own.filter(|_| points(&spec) && all.iter().all(there)) {
            Some(i) => {
                all[i] = spec;
                all
            }
            None => vec![spec],
        }
    }

    /// "two cyclists side by side", where one is there: the other beside him.
    fn beside_those(&mut self, spec: &ObjectSpec) -> Vec<ObjectSpec> {
        let there = ObjectSpec {
            count: Count::exactly(1),
            relations: Vec::new(),
            state: None,
            // (of no words of the text)
            span: super::tokens::Span {
                start: usize::MAX,
                end: usize::MAX,
            },
            ..spec.clone()
        };
        self.definite.push(there.span);
        let mut new = spec.clone();
        new.relations.push(Stated {
            relation: RelationKind::NextTo,
            anchor: Anchor::Object(1),
            and: None,
            distance_m: None,
            span: spec.span,
        });
        vec![new, there]
    }

    /// More of a kind stand where all of that kind stand, if nothing else was said.
    pub(super) fn like_the_others(&self, spec: &mut ObjectSpec, others: &[BoxId]) {
        use super::holds::{Target, holds};
        // (where all of them are on a zebra crossing, more are)
        let crosses = |id: &BoxId| {
            let on = |b| holds(&self.map, RelationKind::On, b, &Target::Crossing, None, None);
            self.boxes.get(id).is_some_and(on)
        };
        if spec.class == Class::Pedestrian && !others.is_empty() && others.iter().all(crosses) {
            if spec.relations.is_empty() {
                spec.relations.push(Stated {
                    relation: RelationKind::On,
                    anchor: Anchor::Crossing,
                    and: None,
                    distance_m: None,
                    span: spec.span,
                });
            }
            return;
        }
        let roles: Vec<_> = others
            .iter()
            .map(|id| role_of(&self.map, &self.boxes[id]))
            .collect();
        use crate::scene::graph::LaneRole;
        let all_alike = roles
            .first()
            .copied()
            .flatten()
            .filter(|r| roles.iter().all(|x| *x == Some(*r)));
        // where some are parked in a car park, more are
        let lot = roles
            .contains(&Some(LaneRole::Carpark))
            .then_some(LaneRole::Carpark);
        let parked = spec.state == Some(crate::scene::graph::ObjectState::Parked);
        let Some(role) = all_alike.or(lot.filter(|_| parked)) else {
            return;
        };
        // "on the sidewalk" is the one where they are
        let wide = |r: &Stated| {
            use crate::scene::graph::LaneRole as L;
            matches!(
                (r.anchor, role),
                (Anchor::Lane(L::Sidewalk), L::LeftSidewalk | L::RightSidewalk)
                    | (Anchor::Lane(L::Roadside), L::LeftRoadside | L::RightRoadside)
            )
        };
        if let Some(r) = spec.relations.iter_mut().find(|r| wide(r)) {
            r.anchor = Anchor::Lane(role);
        }
        if !spec.relations.is_empty() {
            return;
        }
        spec.relations.push(Stated {
            relation: RelationKind::On,
            anchor: Anchor::Lane(role),
            and: None,
            distance_m: None,
            span: spec.span,
        });
    }

    /// One for one; where both sides are counted, those too many go and those too few are added.
    pub(super) fn replace_all(&mut self, ids: &[BoxId], c: &Command) {
        let all = c.targets.first().is_some_and(|m| m.uncounted && m.plural);
        // "replace each barrier by two cones"
        let per_each = c
            .targets
            .first()
            .is_some_and(|m| m.pick == Some(super::words::edits::Pick::All) && !m.plural && m.uncounted);
        let wanted = match &c.by {
            Some(by) if per_each && !by.uncounted => by.spec.count.n as usize * ids.len(),
            Some(by) if !by.uncounted && (!all || by.spec.count.n > 1 || said_one(&c.text)) => {
                by.spec.count.n as usize
            }
            _ => ids.len(),
        };
        let old = ids.first().and_then(|id| self.boxes.get(id)).copied();
        for id in ids.iter().skip(wanted.max(1)) {
            self.push(TextEdit::Remove { id: *id });
        }
        for id in ids.iter().take(wanted.max(1)) {
            self.replace(*id, c);
        }
        if let Some(by) = c.by.as_ref().filter(|_| wanted > ids.len()) {
            let mut spec = by.spec.clone();
            spec.count = Count::exactly((wanted - ids.len()) as u32);
            spec.relations
                .retain(|r| !matches!(r.anchor, super::description::Anchor::Object(_)));
            // more than were there stand by the first: in its strip, on its side of the ego vehicle
            if let Some(old) = old.filter(|_| spec.relations.is_empty()) {
                spec.relations.extend(self.where_it_is(&old, spec.span));
                let side = if old.center_m.x > 0.0 {
                    RelationKind::InFrontOf
                } else {
                    RelationKind::Behind
                };
                if old.center_m.x.abs() > 6.0 {
                    spec.relations.push(Stated {
                        relation: side,
                        anchor: Anchor::Ego,
                        and: None,
                        distance_m: None,
                        span: spec.span,
                    });
                }
            } else {
                self.like_the_others(&mut spec, ids);
            }
            let parked = spec.relations.iter().any(|r| {
                use crate::scene::graph::LaneRole as L;
                matches!(
                    r.anchor,
                    Anchor::Lane(L::LeftRoadside | L::RightRoadside | L::Carpark)
                )
            });
            if parked && spec.state.is_none() && spec.class.is_vehicle() {
                spec.state = Some(crate::scene::graph::ObjectState::Parked);
            }
            self.add(&Description {
                foreground: vec![spec],
                ..Description::default()
            });
        }
    }

    pub(super) fn replace(&mut self, id: BoxId, c: &Command) {
        let (Some(b), Some(by)) = (self.boxes.get(&id).copied(), &c.by) else {
            self.note(format!("{:?}: replaced by what?", c.text));
            return;
        };
        let Some(new) = in_place_of(&b, &by.spec, id) else {
            return;
        };
        // A longer one may need a step along its course.
        let new = match self.clear_of_others(new) {
            Some(clear) => {
                let step = clear.center_m.truncate().distance(new.center_m.truncate());
                if step > 0.0 {
                    self.note(format!(
                        "box {} stands {step:.1} m further along, clear of others",
                        id.0
                    ));
                }
                clear
            }
            None => new,
        };
        let hit = self
            .boxes
            .values()
            .find(|o| o.id != id && overlap_m(&new, o, 0.0) > 0.0);
        if let Some(o) = hit {
            let text = format!("the larger box {} now overlaps box {}", id.0, o.id.0);
            self.note(text);
        }
        self.push(TextEdit::Replace { id, object: new });
    }
}

/// "two cyclists side by side".
fn side_by_side(words: &str) -> bool {
    [
        "side by side",
        "next to each other",
        "next to one another",
        "beside each other",
        "beside one another",
        "abreast",
        "shoulder to shoulder",
    ]
    .iter()
    .any(|w| words.contains(w))
}

/// "by a single truck": one for all of them.
fn said_one(words: &str) -> bool {
    let words = words.to_lowercase();
    // ("no cyclists, but a scooter": for all of them; "a scooter rides where the cyclists are")
    [
        "single",
        "just one",
        "only one",
        " one ",
        ", but a ",
        " where the ",
    ]
    .iter()
    .any(|w| words.contains(w))
}

/// A box of another kind where one stands or stood.
pub(super) fn in_place_of(old: &SceneBox, spec: &ObjectSpec, id: BoxId) -> Option<SceneBox> {
    let size_m = DVec3::from_array(spec.size_m.or(spec.class.typical_size_m())?);
    let center_m = old
        .center_m
        .truncate()
        .extend(old.center_m.z - old.size_m.z / 2.0 + size_m.z / 2.0);
    let moves = old.velocity_mps.length();
    let most = match spec.class {
        Class::TrafficCone | Class::Barrier => 0.0,
        Class::Pedestrian => 2.0,
        Class::Bicycle => 6.0,
        _ => moves,
    };
    Some(SceneBox {
        id,
        class: spec.class,
        size_m,
        center_m,
        velocity_mps: old.velocity_mps * (most.min(moves) / moves.max(0.1)),
        label: super::names::label_of(spec),
        ..*old
    })
}
