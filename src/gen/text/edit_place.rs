//! What an edit puts in: its places are found around what stands there already. What "the" was said of, and what is named
//! bare while the scene has it, is the thing that stands there; it is not put in a second time.

use glam::DVec2;

use super::description::{Anchor, Count, Description, ObjectSpec, Stated};
use super::edit::{Editor, Question, TextEdit};
use super::lexicon::{Sense, look_up};
use super::mention::{Mention, Pre};
use super::place::{Placement, place_from};
use super::select::{fitting, of_size, rank, where_is};
use super::to_graph::to_graph;
use super::words::edits::Pick;
use super::words::objects::NOUNS;
use crate::scene::graph::{Locked, Node, RelationKind};
use crate::scene::{BoxId, SceneBox};

/// What came of looking for places.
pub(super) enum Arranged {
    /// An anchor fits several boxes: it was asked back.
    Asked,
    /// The new boxes, what found no place, and the relations that do not hold.
    Placed {
        new: Vec<SceneBox>,
        left_out: Vec<String>,
        unmet: Vec<&'static str>,
    },
}

/// Indices that relations of the objects end in.
fn referred(d: &Description) -> Vec<usize> {
    d.foreground
        .iter()
        .flat_map(|o| o.relations.iter())
        .flat_map(|r| [Some(r.anchor), r.and])
        .flatten()
        .filter_map(|a| match a {
            Anchor::Object(i) => Some(i),
            _ => None,
        })
        .collect()
}

impl Editor<'_> {
    /// Boxes that an anchor of a description may mean; those that stand where it was said to be, if any do.
    pub(super) fn meant(&self, o: &ObjectSpec) -> Vec<SceneBox> {
        let noun = match look_up(&o.noun) {
            Some(Sense::Noun(noun, _)) => Some(noun),
            _ => NOUNS.iter().find(|n| n.classes.first() == Some(&o.class)),
        };
        let Some(noun) = noun else {
            return Vec::new();
        };
        let mut mention = Mention::new(noun, &o.noun, o.count.n > 1, Pre::default(), o.span);
        mention.spec = o.clone();
        mention
            .spec
            .relations
            .retain(|r| !matches!(r.anchor, Anchor::Object(_)) && !matches!(r.and, Some(Anchor::Object(_))));
        let mut ids = fitting(&self.map, &self.boxes, &mention, &[]);
        if ids.is_empty() {
            mention.spec.relations.clear();
            mention.spec.state = None;
            ids = fitting(&self.map, &self.boxes, &mention, &[]);
        }
        let fits = ids.iter().map(|id| self.boxes[id]).collect();
        super::names::plainly(fits, &mention)
    }

    /// Of several boxes those that the text spoke of last, if any; else those of the size that the noun has.
    pub(super) fn likely(&self, fits: Vec<SceneBox>, o: &ObjectSpec) -> Vec<SceneBox> {
        let sized = of_size(&fits, &o.noun, o.size_m);
        let recent: Vec<SceneBox> = sized
            .iter()
            .filter(|b| self.last.contains(&b.id))
            .copied()
            .collect();
        if recent.len() == 1 { recent } else { sized }
    }

    /// "the left lane" of a street with one lane each way is the oncoming one.
    fn lanes_that_are_there(&mut self, d: &mut Description) {
        use crate::scene::graph::LaneRole;
        let has = |role: LaneRole| self.map.points.iter().any(|p| p.role == role);
        if has(LaneRole::Left) || !has(LaneRole::Oncoming) {
            return;
        }
        let mut taken = false;
        for r in d.foreground.iter_mut().flat_map(|o| &mut o.relations) {
            if r.anchor == Anchor::Lane(LaneRole::Left) {
                r.anchor = Anchor::Lane(LaneRole::Oncoming);
                taken = true;
            }
        }
        if taken {
            self.note("no lane on the left goes our way: the oncoming lane is meant");
        }
    }

    /// "an excavator there, and a truck behind the excavator": where the scene has none, the new one is meant.
    fn refer_to_new(&self, d: &mut Description) {
        let refers = referred(d);
        let stands_for = (0..d.foreground.len()).find_map(|i| {
            let o = &d.foreground[i];
            let named = self.definite.contains(&o.span) && refers.contains(&i) && o.relations.is_empty();
            // (what the text itself brings in is nearer than several that could be meant)
            let again = |n: &ObjectSpec| n.noun == o.noun && !self.definite.contains(&n.span);
            let several = self.meant(o).len() > 1 && o.count.n == 1 && d.foreground.iter().any(again);
            if !named || !self.meant(o).is_empty() && !several {
                return None;
            }
            let new = (0..d.foreground.len()).find(|&j| {
                let n = &d.foreground[j];
                j != i
                    && n.class == o.class
                    && !self.definite.contains(&n.span)
                    && !n.relations.iter().any(|r| r.anchor == Anchor::Object(i))
            })?;
            Some((i, new))
        });
        let Some((old, new)) = stands_for else {
            return;
        };
        d.foreground.remove(old);
        let renumber = |a: &mut Anchor| {
            if let Anchor::Object(k) = a {
                let to = if *k == old { new } else { *k };
                *k = to - usize::from(to > old);
            }
        };
        for r in d.foreground.iter_mut().flat_map(|o| &mut o.relations) {
            renumber(&mut r.anchor);
            r.and.iter_mut().for_each(renumber);
        }
    }

    /// Finds places for what a description names; `from` is the box that is moved there, which does not stand in its own way.
    pub(super) fn arrange(&mut self, d: &Description, from: Option<&SceneBox>) -> Arranged {
        let mut d = d.clone();
        d.density = None;
        self.lanes_that_are_there(&mut d);
        self.refer_to_new(&mut d);
        let refers = referred(&d);
        let mut held: Vec<(usize, Vec<SceneBox>)> = Vec::new();
        for i in 0..d.foreground.len() {
            let o = d.foreground[i].clone();
            let beside = i > 0 && !refers.contains(&i); // "two adults with the children"
            let known = self.definite.contains(&o.span);
            if !(known && (refers.contains(&i) || beside)) {
                continue;
            }
            let mut fits = self.meant(&o);
            if fits.is_empty() {
                self.note(format!("no {} is in the scene: one is added", o.noun));
                continue;
            }
            if o.count.n == 1 {
                fits = self.likely(fits, &o);
                // ("next to the nearest cyclist")
                let pick = self.picks.iter().find(|(span, p)| *span == o.span && one_of(*p));
                if let Some((_, pick)) = pick {
                    let cost = |b: &SceneBox| rank(b, *pick);
                    fits.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
                    fits.truncate(1);
                }
                if fits.len() > 1 {
                    self.out.questions.push(Question {
                        text: format!("{} {}: which?", fits.len(), o.noun),
                        phrase: o.noun.clone(),
                        candidates: fits.iter().map(|b| where_is(&self.map, b)).collect(),
                    });
                    return Arranged::Asked;
                }
            } else if !o.count.is_exact() || fits.len() < o.count.n as usize {
                d.foreground[i].count = Count::exactly(fits.len() as u32);
            } else if fits.len() > o.count.n as usize {
                fits.truncate(o.count.n as usize);
            }
            if beside {
                let to = Stated {
                    relation: RelationKind::NextTo,
                    anchor: Anchor::Object(i),
                    and: None,
                    distance_m: None,
                    span: o.span,
                };
                let first = &mut d.foreground[0].relations;
                if !first.iter().any(|r| matches!(r.anchor, Anchor::Object(_))) {
                    first.push(to);
                }
            }
            held.push((i, fits));
        }
        let mut graphed = to_graph(&d, self.seed);
        let mut locked: Vec<u32> = Vec::new();
        let mut stay: Vec<BoxId> = Vec::new();
        for (i, fits) in &held {
            let nodes = graphed.nodes.get(*i).cloned().unwrap_or_default();
            for (node, b) in nodes.iter().zip(fits) {
                if let Some(n) = graphed.graph.nodes.iter_mut().find(|n: &&mut Node| n.id == *node) {
                    n.locked = Some(Locked::Box(*b));
                    locked.push(*node);
                    stay.push(b.id);
                }
            }
        }
        let others: Vec<SceneBox> = self
            .boxes
            .values()
            .filter(|b| !stay.contains(&b.id))
            .copied()
            .collect();
        let placement: Placement = place_from(
            &graphed.graph,
            self.layout,
            self.seed,
            &graphed.sizes_m,
            &others,
            from,
        );
        Arranged::Placed {
            new: placement
                .boxes
                .iter()
                .filter(|b| !locked.contains(&b.id.0))
                .copied()
                .collect(),
            left_out: placement.left_out.into_iter().map(|l| l.1).collect(),
            unmet: placement
                .unmet
                .iter()
                .map(|i| graphed.graph.edges[*i])
                .filter(|e| !locked.contains(&e.from))
                .map(|e| e.relation.name())
                .collect(),
        }
    }

    /// Adds what a description names; what it refers to by "the" may be a box of the scene.
    pub(super) fn add(&mut self, d: &Description) -> bool {
        // Behind a vehicle is in its lane, going its way, if there is room.
        let mut follows = d.clone();
        let mut any = false;
        for o in &mut follows.foreground {
            let drives = (o.class.is_vehicle()
                || matches!(
                    o.class,
                    crate::scene::Class::Motorcycle | crate::scene::Class::Bicycle
                ))
                && o.state != Some(crate::scene::graph::ObjectState::Parked);
            let lane = o.relations.iter().any(|r| matches!(r.anchor, Anchor::Lane(_)));
            for r in o.relations.iter_mut().filter(|_| drives && !lane) {
                if r.relation == RelationKind::Behind && matches!(r.anchor, Anchor::Object(_)) {
                    r.relation = RelationKind::Following;
                    any = true;
                }
            }
        }
        any |= with_whom(&mut follows);
        let tried = match any.then(|| self.arrange(&follows, None)) {
            Some(Arranged::Asked) => return false,
            Some(Arranged::Placed { new, left_out, unmet }) if left_out.is_empty() && unmet.is_empty() => {
                Some((new, left_out, unmet))
            }
            _ => None,
        };
        let (new, left_out, unmet) = match tried {
            Some(found) => found,
            None => match self.arrange(d, None) {
                Arranged::Placed { new, left_out, unmet } => (new, left_out, unmet),
                Arranged::Asked => return false,
            },
        };
        self.last.clear();
        for b in &new {
            let object = SceneBox {
                id: self.next_id(),
                ..*b
            };
            self.last.push(object.id);
            self.push(TextEdit::Add { object });
        }
        if let Some(why) = left_out.first() {
            self.note(format!(
                "{} of {} were placed: {why}",
                new.len(),
                new.len() + left_out.len()
            ));
        }
        if !unmet.is_empty() {
            self.note(format!("not everything said could be met: {}", unmet.join(", ")));
        }
        !new.is_empty()
    }

    /// Puts new boxes where others were taken away: "the bus goes, a tanker comes in its place".
    pub(super) fn add_in_place(&mut self, d: &Description) -> bool {
        let Some(spec) = d.foreground.first() else {
            return false;
        };
        let spots: Vec<SceneBox> = if self.left.is_empty() {
            self.gone.clone()
        } else {
            std::mem::take(&mut self.left)
        };
        let mut rest = spec.count.n as usize;
        self.last.clear();
        for old in spots.iter().take(rest) {
            let id = self.next_id();
            let Some(object) = super::edit_count::in_place_of(old, spec, id) else {
                continue;
            };
            rest -= 1;
            self.last.push(id);
            self.push(TextEdit::Add { object });
        }
        // More than were taken away stand right before and behind them, if there is room.
        while rest > 0
            && let Some(old) = spots.last()
            && let Some(object) = super::edit_count::in_place_of(old, spec, self.next_id())
            && let Some(object) = self
                .clear_of_others(object)
                .filter(|o| o.center_m.distance(old.center_m) < 9.0)
        {
            rest -= 1;
            self.last.push(object.id);
            self.push(TextEdit::Add { object });
        }
        if rest == 0 {
            return true;
        }
        // More than were taken away: the others stand by them, in the same lane or strip.
        let mut spec = spec.clone();
        spec.count = Count::exactly(rest as u32);
        if let Some(old) = spots.first() {
            spec.relations.extend(self.where_it_is(old, spec.span));
        }
        let done = self.last.clone();
        let added = self.add(&Description {
            foreground: vec![spec],
            ..Description::default()
        });
        self.last.extend(done.iter());
        added || !done.is_empty()
    }

    /// "the motorcycle takes its place": what is there already is moved to where others have stood. `None` if it is about
    /// something new.
    pub(super) fn put_in_place(&mut self, c: &super::edit_grammar::Command) -> Option<bool> {
        let m = c.targets.first().filter(|m| m.definite)?;
        let spots = if self.left.is_empty() {
            self.gone.clone()
        } else {
            self.left.clone()
        };
        let ids = match super::select::choose(&self.map, &self.boxes, m, &c.mentions) {
            super::select::Chosen::These(ids) => ids,
            super::select::Chosen::None(_) => return None,
            _ => self.targets(c, false).unwrap_or_default(),
        };
        let Some(old) = spots.get(spots.len() / 2) else {
            self.note(format!("{:?}: where to was not understood", c.text));
            return Some(false);
        };
        if ids.iter().any(|id| spots.iter().any(|s| s.id == *id)) || ids.is_empty() {
            return Some(false);
        }
        let said = c.text.to_lowercase();
        for (k, id) in ids.iter().enumerate() {
            let Some(b) = self.boxes.get(id).copied() else {
                continue;
            };
            let to = if spots.len() < ids.len() { old } else { &spots[k] };
            let to = if ids.len() == 1 { old } else { to };
            let new = SceneBox {
                center_m: to.center_m.truncate().extend(b.center_m.z),
                yaw_rad: to.yaw_rad,
                ..b
            };
            let new = self.clear_of_others(new).unwrap_or(new);
            self.push(TextEdit::Move {
                id: *id,
                center_m: new.center_m,
                yaw_rad: new.yaw_rad,
            });
            // Where something stood it stands, too.
            let says = |list: [&str; 2]| list.iter().any(|w| said.contains(w));
            let stands =
                says(["park", " stand"]) || to.velocity_mps.length() < 0.5 && !says([" driv", " rid"]);
            if stands && b.velocity_mps.length() > 0.5 {
                let object = SceneBox {
                    velocity_mps: DVec2::ZERO,
                    ..new
                };
                self.push(TextEdit::Replace { id: *id, object });
            }
        }
        self.last = ids;
        Some(true)
    }

    /// The strip or lane that a box stands in, as a relation.
    pub(super) fn where_it_is(&self, b: &SceneBox, span: super::tokens::Span) -> Option<Stated> {
        let role = super::holds::role_of(&self.map, b)?;
        Some(Stated {
            relation: RelationKind::On,
            anchor: Anchor::Lane(role),
            and: None,
            distance_m: None,
            span,
        })
    }

    /// Heading and speed of a box that takes the place of another, or is sent elsewhere.
    pub(super) fn pace(class: crate::scene::Class, heading: DVec2, moving: bool) -> DVec2 {
        let speed = match class {
            _ if !moving => 0.0,
            crate::scene::Class::Pedestrian => 1.4,
            crate::scene::Class::Bicycle => 4.0,
            crate::scene::Class::TrafficCone | crate::scene::Class::Barrier => 0.0,
            _ => 8.0,
        };
        heading * speed
    }
}

/// "a woman next to the man on the crossing" is on the crossing, too, if there is room. True if somebody is.
fn with_whom(d: &mut Description) -> bool {
    use crate::scene::graph::LaneRole as L;
    let mut any = false;
    for i in 0..d.foreground.len() {
        let placed = |r: &Stated| matches!(r.anchor, Anchor::Lane(_) | Anchor::Crossing | Anchor::Junction);
        let o = &d.foreground[i];
        let free = o.class == crate::scene::Class::Pedestrian && !o.relations.iter().any(placed);
        let Some(k) = o.relations.iter().find_map(|r| match (r.relation, r.anchor) {
            (RelationKind::NextTo, Anchor::Object(k)) if free => Some(k),
            _ => None,
        }) else {
            continue;
        };
        let there = d.foreground.get(k).and_then(|with| {
            let walks = |r: &&Stated| {
                r.relation == RelationKind::On
                    && matches!(
                        r.anchor,
                        Anchor::Crossing | Anchor::Lane(L::Sidewalk | L::LeftSidewalk | L::RightSidewalk)
                    )
            };
            with.relations
                .iter()
                .find(walks)
                .filter(|_| with.class == crate::scene::Class::Pedestrian)
                .copied()
        });
        any |= there.is_some();
        d.foreground[i].relations.extend(there);
    }
    any
}

/// True if a word picks a certain one.
fn one_of(pick: Pick) -> bool {
    !matches!(pick, Pick::All | Pick::Any | Pick::More)
}
