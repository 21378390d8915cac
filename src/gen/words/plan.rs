//! New things as a description: what is named together, and what it is placed by. Of a scene that is there, anchors are its
//! boxes; without one, they are what was named before.

use super::nouns::Noun;
use super::reading::{Anchor as Said, PaintWish, Place, Quantity, Relation, Thing};
use super::resolve::kind_of;
use super::tokens::Span;
use crate::generation::text::description::{Anchor, Count, ObjectSpec, Stated};
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};
use crate::scene::{Class, SceneBox};

/// Most things of one kind.
pub const MOST_OF_ONE: u32 = 400;
/// Most kinds of things of one reading.
const MOST_SPECS: usize = 200;

/// Finds the boxes of a scene that an anchor means; `Err` after a question.
pub(super) type Find<'f> = dyn FnMut(&Thing) -> Result<Vec<SceneBox>, ()> + 'f;

/// What is to be placed, and what stands already.
#[derive(Default)]
pub(super) struct Plan {
    /// One for each kind that was named; anchors too.
    pub(super) specs: Vec<ObjectSpec>,
    /// The boxes of those that stand already.
    pub(super) held: Vec<Option<Vec<SceneBox>>>,
    /// What was named in each.
    named: Vec<Thing>,
    /// Something asked back.
    pub(super) asked: bool,
}

impl Plan {
    /// Puts new things in, with what they are placed by.
    pub(super) fn add(&mut self, things: &[Thing], find: &mut Find<'_>) {
        let first = self.specs.len();
        let mut own = Vec::new();
        for t in things {
            own.push(self.thing(t, true, find, 0));
        }
        for (k, t) in things.iter().enumerate() {
            let Some(i) = own[k] else { continue };
            let mate = own
                .iter()
                .enumerate()
                .find(|(j, o)| *j != k && o.is_some())
                .and_then(|(_, o)| *o);
            self.group(i, t, mate.filter(|_| own.len() == 2));
        }
        debug_assert!(self.specs.len() >= first);
    }

    fn thing(&mut self, t: &Thing, new: bool, find: &mut Find<'_>, depth: u8) -> Option<usize> {
        if self.specs.len() >= MOST_SPECS || depth > 4 {
            return None;
        }
        let i = self.specs.len();
        self.specs.push(spec_of(t));
        self.held.push(None);
        self.named.push(t.clone());
        if new {
            for p in &t.places {
                self.place(i, p, t.state, find, depth);
            }
        }
        Some(i)
    }

    fn place(&mut self, i: usize, p: &Place, state: Option<ObjectState>, find: &mut Find<'_>, depth: u8) {
        let Some(to) = &p.to else { return };
        if matches!(to, Said::EachOther) {
            return;
        }
        let class = self.specs[i].class;
        let mut metres = p.metres;
        let relation = match (p.relation, to) {
            // (so far away is ahead, where one looks)
            (Relation::At, Said::Ego) => Some(RelationKind::InFrontOf),
            // (what shall be on the pavement as she is)
            (Relation::Like, _) => {
                if let Some(anchor) = self.anchor(to, find, depth) {
                    self.like(i, anchor);
                }
                return;
            }
            (Relation::Oncoming, Said::Ego) if metres.is_some() => {
                self.state(i, RelationKind::InFrontOf, Anchor::Ego, None, metres);
                metres = None;
                Some(RelationKind::OppositeDirection)
            }
            (Relation::Waiting, Said::Lane(_)) => Some(RelationKind::On),
            (relation, to) => kind_of(relation, to, state),
        };
        let Some(relation) = relation else { return };
        let Some(anchor) = self.anchor(to, find, depth) else {
            return;
        };
        let mut and = p.and.as_ref().and_then(|a| self.anchor(a, find, depth));
        if relation == RelationKind::Between && and.is_none() {
            and = Some(match anchor {
                Anchor::Object(j) if self.count_of(j) > 1 => anchor,
                Anchor::Ego => return,
                _ => Anchor::Ego,
            });
        }
        // Behind a driver is in its lane, going its way.
        let drives = (class.is_vehicle() || matches!(class, Class::Motorcycle | Class::Bicycle))
            && state != Some(ObjectState::Parked);
        let lane = self.named[i]
            .places
            .iter()
            .any(|p| matches!(p.to, Some(Said::Lane(_))));
        let relation = match (relation, anchor) {
            (RelationKind::Behind, Anchor::Object(_)) if drives && !lane && metres.is_none() => {
                RelationKind::Following
            }
            (relation, _) => relation,
        };
        self.state(i, relation, anchor, and, metres);
    }

    fn state(
        &mut self,
        i: usize,
        relation: RelationKind,
        anchor: Anchor,
        and: Option<Anchor>,
        distance_m: Option<f64>,
    ) {
        let stated = Stated {
            relation,
            anchor,
            and,
            distance_m,
            span: nowhere(),
        };
        if !self.specs[i].relations.contains(&stated) {
            self.specs[i].relations.push(stated);
        }
    }

    fn count_of(&self, i: usize) -> usize {
        self.held[i]
            .as_ref()
            .map_or(self.specs[i].count.n as usize, Vec::len)
    }

    /// In the lane or strip of an anchor, or beside it where that is not known yet.
    fn like(&mut self, i: usize, anchor: Anchor) {
        let Anchor::Object(j) = anchor else { return };
        let lanes: Vec<Stated> = self.specs[j]
            .relations
            .iter()
            .filter(|r| matches!(r.anchor, Anchor::Lane(_) | Anchor::Crossing) && r.distance_m.is_none())
            .copied()
            .collect();
        if lanes.is_empty() {
            self.state(i, RelationKind::NextTo, anchor, None, None);
        }
        for r in lanes {
            self.state(i, r.relation, r.anchor, None, None);
        }
    }

    fn anchor(&mut self, a: &Said, find: &mut Find<'_>, depth: u8) -> Option<Anchor> {
        Some(match a {
            Said::Ego => Anchor::Ego,
            Said::Crossing => Anchor::Crossing,
            Said::Junction => Anchor::Junction,
            Said::Lane(role) => Anchor::Lane(*role),
            // (of something new, the other side is the far one)
            Said::OtherSide => Anchor::Lane(LaneRole::LeftRoadside),
            Said::OtherLane => Anchor::Lane(LaneRole::Oncoming),
            Said::EachOther => return None,
            Said::Thing(t) => {
                let is_new = matches!(
                    t.quantity,
                    Quantity::N(_) | Quantity::Range(..) | Quantity::Some | Quantity::Many
                ) && t.pick.is_none()
                    && t.nth.is_none();
                if is_new {
                    return self.thing(t, true, find, depth + 1).map(Anchor::Object);
                }
                if let Some(j) = self.named_before(t) {
                    return Some(Anchor::Object(j));
                }
                let boxes = match find(t) {
                    Ok(boxes) => boxes,
                    Err(()) => {
                        self.asked = true;
                        return None;
                    }
                };
                let j = self.thing(t, boxes.is_empty(), find, depth + 1)?;
                if !boxes.is_empty() {
                    self.specs[j].count = Count::exactly(boxes.len() as u32);
                    self.held[j] = Some(boxes);
                }
                Anchor::Object(j)
            }
        })
    }

    /// What was named before by the same noun, the last one: `the bus`, `it`.
    fn named_before(&self, t: &Thing) -> Option<usize> {
        let fits = |i: &usize| {
            let n = &self.named[*i];
            let noun = match t.noun {
                Noun::It | Noun::One | Noun::Thing => true,
                Noun::Vehicle => self.specs[*i].class.is_vehicle(),
                noun => n.noun == noun || noun.is_plain() && noun.classes().contains(&self.specs[*i].class),
            };
            let paint = t.paint.is_none() || t.paint == n.paint;
            let places = t.places.is_empty() || n.places.iter().any(|p| t.places.contains(p));
            noun && paint && places && self.held[*i].is_none() && !t.other
        };
        // (not itself: the last one is being placed)
        (0..self.specs.len().saturating_sub(1)).rev().find(fits)
    }

    /// What is said of a group: in a row, side by side, facing each other.
    fn group(&mut self, i: usize, t: &Thing, mate: Option<usize>) {
        for p in &t.places {
            let each = matches!(p.to, Some(Said::EachOther));
            let relation = match p.relation {
                Relation::InLine => match self.specs[i].class {
                    Class::Pedestrian => RelationKind::Behind,
                    Class::TrafficCone | Class::Barrier => RelationKind::NextTo,
                    _ => RelationKind::Following,
                },
                Relation::SideBySide => RelationKind::NextTo,
                r if each => match kind_of(r, &Said::Ego, None) {
                    Some(kind) => kind,
                    None => continue,
                },
                _ => continue,
            };
            let n = self.specs[i].count.n;
            if n > 1 && n <= 12 && self.specs[i].count.is_exact() {
                self.chain(i, relation, each);
            } else if let Some(j) = mate.filter(|j| each || *j < i) {
                self.state(i, relation, Anchor::Object(j), None, None);
            }
        }
    }

    /// One spec of `n` as `n` of one, each placed by the one before.
    fn chain(&mut self, i: usize, relation: RelationKind, each: bool) {
        let n = self.specs[i].count.n;
        self.specs[i].count = Count::exactly(1);
        let mut before = i;
        for _ in 1..n {
            let mut next = self.specs[i].clone();
            next.relations.retain(|r| {
                r.distance_m.is_none() && !matches!(r.anchor, Anchor::Object(_)) && r.relation != relation
            });
            self.specs.push(next);
            self.held.push(None);
            self.named.push(self.named[i].clone());
            let k = self.specs.len() - 1;
            self.state(k, relation, Anchor::Object(before), None, None);
            if each && before == i {
                self.state(i, relation, Anchor::Object(k), None, None);
            }
            before = k;
        }
    }
}

/// No words of the text.
pub(super) fn nowhere() -> Span {
    Span { start: 0, end: 0 }
}

/// How many things a number means.
pub fn count_of(q: Quantity) -> Count {
    let at_most = |n: u32| n.min(MOST_OF_ONE);
    match q {
        Quantity::N(n) | Quantity::TheN(n) => Count::exactly(at_most(n)),
        Quantity::Range(a, b) => Count::about(at_most(a), at_most(a + (b - a.min(b)) / 2), at_most(b)),
        Quantity::Some => Count::about(2, 3, 6),
        Quantity::Many => Count::about(5, 7, 20),
        Quantity::All | Quantity::Half => Count::about(2, 3, 12),
        Quantity::The | Quantity::Unsaid => Count::exactly(1),
    }
}

/// A thing without its places.
fn spec_of(t: &Thing) -> ObjectSpec {
    let noun = match t.noun {
        // (any vehicle that is added is a car; what shall be anything, too)
        Noun::Vehicle | Noun::Thing | Noun::It | Noun::One => Noun::Car,
        Noun::TwoWheeler => Noun::Bicycle,
        noun => noun,
    };
    ObjectSpec {
        class: noun.classes()[0],
        noun: if noun.is_plain() {
            noun.classes()[0].label()
        } else {
            noun.words()
        },
        count: count_of(t.quantity),
        state: t.state,
        size: t.size,
        color: match t.paint {
            Some(PaintWish::Is(p)) => Some(p.name().into()),
            _ => None,
        },
        attributes: Vec::new(),
        size_m: noun.size_m(),
        relations: Vec::new(),
        span: nowhere(),
    }
}
