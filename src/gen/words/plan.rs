//! New things as a description: things that are named together, and the anchors that they are placed by. In an open
//! scene, anchors are its boxes; without one, they are things named before.

use super::nouns::Noun;
use super::reading::{AnchorPhrase as Said, ObjectPhrase, PaintWish, PlacePhrase, Quantity, Relation};
use super::resolve::kind_of;
use place::description::{Anchor, Count, ObjectSpec, Stated};
use place::to_graph::MOST_OF_ONE;
use scene::graph::{LaneRole, ObjectState, RelationKind};
use scene::{BoxLabel, Class, SceneBox};

/// Most kinds of things of one reading.
const MOST_SPECS: usize = 200;

/// The scene that new things are added to.
pub(super) trait AnchorResolver {
    /// The boxes that an anchor means; `Err` after a question.
    fn find(&mut self, t: &ObjectPhrase) -> Result<Vec<SceneBox>, ()>;
    /// The lane or strip that a box of it is in.
    fn role(&self, b: &SceneBox) -> Option<LaneRole>;
    /// The noun of the thing that was named last.
    fn last_noun(&self) -> Option<Noun>;
}

/// A site without a scene: all anchors are named in the text.
pub(super) struct Nowhere;

impl AnchorResolver for Nowhere {
    fn find(&mut self, _: &ObjectPhrase) -> Result<Vec<SceneBox>, ()> {
        Ok(Vec::new())
    }
    fn role(&self, _: &SceneBox) -> Option<LaneRole> {
        None
    }
    fn last_noun(&self) -> Option<Noun> {
        None
    }
}

/// Things to be placed, and boxes that stand already.
#[derive(Default)]
pub(super) struct PlacementPlan {
    /// One spec for each kind that was named, anchors included.
    pub(super) specs: Vec<ObjectSpec>,
    /// Boxes of the specs that stand already.
    pub(super) held: Vec<Option<Vec<SceneBox>>>,
    /// Thing that each spec was named by.
    pub(super) named: Vec<ObjectPhrase>,
    /// Act that named each spec, and index of the thing in the act.
    pub(super) from: Vec<(usize, usize)>,
    /// Act and thing that are being added now.
    pub(super) at: (usize, usize),
    /// True if a question was asked.
    pub(super) asked: bool,
    /// True if a driver placed behind another follows it, if it can.
    pub(super) follows: bool,
}

impl PlacementPlan {
    /// Adds new things, with the anchors that they are placed by.
    pub(super) fn add(&mut self, things: &[ObjectPhrase], site: &mut dyn AnchorResolver) {
        let mut own = Vec::new();
        for (k, t) in things.iter().enumerate() {
            self.at.1 = k;
            own.push(self.thing(t, true, site, 0));
        }
        for (k, t) in things.iter().enumerate() {
            let Some(i) = own[k] else { continue };
            self.at.1 = k;
            let mate = own
                .iter()
                .enumerate()
                .find(|(j, o)| *j != k && o.is_some())
                .and_then(|(_, o)| *o);
            self.group(i, t, mate.filter(|_| own.len() == 2));
        }
    }

    fn thing(
        &mut self,
        t: &ObjectPhrase,
        new: bool,
        site: &mut dyn AnchorResolver,
        depth: u8,
    ) -> Option<usize> {
        if self.specs.len() >= MOST_SPECS || depth > 4 {
            return None;
        }
        let i = self.specs.len();
        let mut t = t.clone();
        if t.noun == Noun::One {
            // ("a yellow truck, and a black one")
            let before = self.named.last().map(|n| n.noun);
            t.noun = before.or(site.last_noun()).unwrap_or(Noun::Car);
        }
        let t = &t;
        self.specs.push(spec_of(t));
        self.held.push(None);
        self.from.push(self.at);
        self.named.push(t.clone());
        if new {
            for p in &t.places {
                self.place(i, p, t.state, site, depth);
            }
        }
        Some(i)
    }

    fn place(
        &mut self,
        i: usize,
        p: &PlacePhrase,
        state: Option<ObjectState>,
        site: &mut dyn AnchorResolver,
        depth: u8,
    ) {
        let Some(to) = &p.to else { return };
        if matches!(to, Said::EachOther) {
            return;
        }
        let class = self.specs[i].class;
        let mut metres = p.metres;
        let relation = match (p.relation, to) {
            // (a mere distance is meant ahead)
            (Relation::At, Said::Ego) => Some(RelationKind::InFrontOf),
            // ("on the pavement, as she is")
            (Relation::Like, _) => {
                if let Some(anchor) = self.anchor(i, to, site, depth) {
                    self.like(i, anchor, site);
                }
                return;
            }
            (Relation::Oncoming, Said::Ego) if metres.is_some() => {
                self.state(i, RelationKind::InFrontOf, Anchor::Ego, None, metres);
                metres = None;
                Some(RelationKind::OppositeDirection)
            }
            (Relation::Waiting, Said::Lane(_)) => Some(RelationKind::On),
            (Relation::Crossing, Said::Junction) => {
                self.state(
                    i,
                    RelationKind::Crossing,
                    Anchor::Lane(LaneRole::Road),
                    None,
                    None,
                );
                Some(RelationKind::Near)
            }
            (Relation::On, Said::Lane(role)) if is_kerb(*role) && class.is_vehicle() && state.is_none() => {
                // (a thing at the kerb is parked there)
                self.specs[i].state = Some(ObjectState::Parked);
                Some(RelationKind::ParkedOn)
            }
            (relation, to) => kind_of(relation, to, state),
        };
        let Some(relation) = relation else { return };
        let Some(anchor) = self.anchor(i, to, site, depth) else {
            return;
        };
        if let (Said::Thing(t), Anchor::Object(j)) = (to, anchor)
            && t.quantity == Quantity::Each
        {
            // (the graph assigns them to the anchors in turn)
            let n = self.specs[i].count.n.saturating_mul(self.count_of(j) as u32);
            self.specs[i].count = Count::exactly(n.min(MOST_OF_ONE));
        }
        let mut and = p.and.as_ref().and_then(|a| self.anchor(i, a, site, depth));
        if relation == RelationKind::Between && and.is_none() {
            and = Some(match anchor {
                Anchor::Object(j) if self.count_of(j) > 1 => anchor,
                Anchor::Ego => return,
                _ => Anchor::Ego,
            });
        }
        // Behind a driver means in its lane and in its direction.
        let drives = (class.is_vehicle() || matches!(class, Class::Motorcycle | Class::Bicycle))
            && state != Some(ObjectState::Parked);
        let lane = self.named[i]
            .places
            .iter()
            .any(|p| matches!(p.to, Some(Said::Lane(_))));
        let relation = match (relation, anchor) {
            (RelationKind::Behind, Anchor::Object(_))
                if self.follows && drives && !lane && metres.is_none() =>
            {
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

    /// Places a thing in the lane or strip of an anchor, or beside the anchor where that is unknown.
    fn like(&mut self, i: usize, anchor: Anchor, site: &dyn AnchorResolver) {
        let Anchor::Object(j) = anchor else { return };
        let mut lanes: Vec<(RelationKind, Anchor)> = self.specs[j]
            .relations
            .iter()
            .filter(|r| matches!(r.anchor, Anchor::Lane(_) | Anchor::Crossing) && r.distance_m.is_none())
            .map(|r| (r.relation, r.anchor))
            .collect();
        let held = self.held[j].as_ref().and_then(|b| b.first());
        lanes.extend(
            held.and_then(|b| site.role(b))
                .map(|role| (RelationKind::On, Anchor::Lane(role))),
        );
        if lanes.is_empty() {
            self.state(i, RelationKind::NextTo, anchor, None, None);
        }
        for (relation, lane) in lanes {
            self.state(i, relation, lane, None, None);
        }
    }

    fn anchor(&mut self, i: usize, a: &Said, site: &mut dyn AnchorResolver, depth: u8) -> Option<Anchor> {
        Some(match a {
            Said::Ego => Anchor::Ego,
            Said::Crossing => Anchor::Crossing,
            Said::Junction => Anchor::Junction,
            Said::Lane(role) => Anchor::Lane(*role),
            // (for a new thing the other side is the far one)
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
                    return self.thing(t, true, site, depth + 1).map(Anchor::Object);
                }
                if let Some(j) = self.named_before(i, t) {
                    return Some(Anchor::Object(j));
                }
                let boxes = match site.find(t) {
                    Ok(boxes) => boxes,
                    Err(()) => {
                        self.asked = true;
                        return None;
                    }
                };
                let j = self.thing(t, boxes.is_empty(), site, depth + 1)?;
                if !boxes.is_empty() {
                    self.specs[j].count = Count::exactly(boxes.len() as u32);
                    self.held[j] = Some(boxes);
                }
                Anchor::Object(j)
            }
        })
    }

    /// The last spec named before that fits the thing: `the bus`, `it`.
    fn named_before(&self, of: usize, t: &ObjectPhrase) -> Option<usize> {
        if t.id.is_some() || t.pick.is_some() || t.nth.is_some() {
            return None;
        }
        let fits = |i: &usize| {
            let n = &self.named[*i];
            let same_traits =
                (t.state.is_none() || t.state == n.state) && (t.size.is_none() || t.size == n.size);
            let noun = match t.noun {
                Noun::It | Noun::One | Noun::Thing => true,
                Noun::Vehicle => self.specs[*i].class.is_vehicle(),
                noun => n.noun == noun || noun.is_plain() && noun.classes().contains(&self.specs[*i].class),
            };
            let paint = t.paint.is_none() || t.paint == n.paint;
            let places = t.places.is_empty() || n.places.iter().any(|p| t.places.contains(p));
            noun && paint && same_traits && places && self.held[*i].is_none() && !t.other
        };
        (0..self.specs.len()).rev().filter(|i| *i != of).find(fits)
    }

    /// Adds places to a thing.
    pub(super) fn also_at(&mut self, i: usize, places: &[PlacePhrase], site: &mut dyn AnchorResolver) {
        let state = self.named[i].state;
        for p in places {
            self.place(i, p, state, site, 1);
            self.named[i].places.push(p.clone());
        }
    }

    /// The thing that a spec was named by.
    pub(super) fn thing_of(&self, i: usize) -> &ObjectPhrase {
        &self.named[i]
    }

    /// Applies the places of a group: in a row, side by side, facing each other.
    fn group(&mut self, i: usize, t: &ObjectPhrase, mate: Option<usize>) {
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

    /// Splits a spec of `n` things into `n` specs of one, each placed by the one before.
    fn chain(&mut self, i: usize, relation: RelationKind, each: bool) {
        let n = self.specs[i].count.n;
        self.specs[i].count = Count::exactly(1);
        let mut before = i;
        for _ in 1..n {
            let mut next = self.specs[i].clone();
            next.relations.retain(|r| {
                let beside = matches!(r.relation, RelationKind::NextTo | RelationKind::Near);
                let far = r.distance_m.is_none() || relation == RelationKind::NextTo;
                far && (beside || !matches!(r.anchor, Anchor::Object(_))) && r.relation != relation
            });
            self.specs.push(next);
            self.held.push(None);
            self.from.push(self.at);
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

fn is_kerb(role: LaneRole) -> bool {
    matches!(
        role,
        LaneRole::Roadside | LaneRole::LeftRoadside | LaneRole::RightRoadside
    )
}

/// The count that a quantity means.
pub fn count_of(q: Quantity) -> Count {
    let at_most = |n: u32| n.min(MOST_OF_ONE);
    match q {
        Quantity::N(n) | Quantity::TheN(n) => Count::exactly(at_most(n)),
        Quantity::Range(a, b) => Count::about(at_most(a), at_most(a + (b - a.min(b)) / 2), at_most(b)),
        Quantity::Some => Count::about(2, 3, 6),
        Quantity::Many => Count::about(5, 7, 20),
        Quantity::All | Quantity::Each | Quantity::Half => Count::about(2, 3, 12),
        Quantity::The | Quantity::Unsaid => Count::exactly(1),
    }
}

/// The spec of a thing without its places.
fn spec_of(t: &ObjectPhrase) -> ObjectSpec {
    let noun = match t.noun {
        // (a vehicle or thing of no stated kind is added as a car)
        Noun::Vehicle | Noun::Thing | Noun::It | Noun::One => Noun::Car,
        Noun::TwoWheeler => Noun::Bicycle,
        noun => noun,
    };
    ObjectSpec {
        class: noun.classes()[0],
        count: count_of(t.quantity),
        state: t.state,
        size: t.size,
        label: label_of(t),
        size_m: noun.size_m(),
        relations: Vec::new(),
        motion: None,
    }
}

/// The name and paint that a thing gives a box.
pub(super) fn label_of(t: &ObjectPhrase) -> BoxLabel {
    BoxLabel {
        name: t.noun.label(),
        paint: match t.paint {
            Some(PaintWish::Is(p)) => Some(p),
            _ => None,
        },
    }
}
