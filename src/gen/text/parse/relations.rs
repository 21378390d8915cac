//! Prepositions: where a relation begins, what it ends in, of whom it speaks.

use super::super::description::Anchor;
use super::super::lexicon::Sense;
use super::super::mention::{Frag, Pre, Prep, apply};
use super::super::tag::Tag;
use super::super::tokens::Span;
use super::{Parser, Pending};
use crate::scene::Class;
use crate::scene::graph::{LaneRole, RelationKind};

impl Parser<'_> {
    pub(in super::super) fn begin(&mut self, prep: Prep, span: Span) {
        self.flush();
        let not = std::mem::take(&mut self.pre.not) || self.denied;
        if !self.noun_ahead(self.at + 1) || self.pre.says_something() {
            // What stood before the noun that never came belongs to what follows the place.
            if let Some(state) = self.pre.state.take() {
                self.fronted_state = Some(state);
            }
        }
        self.pre = Pre::default();
        let distance_m = self.distance.take().map(|d| d.0);
        let of_last = prep == Prep::Rels(vec![RelationKind::Following]);
        self.pending = Some(Pending {
            prep,
            span,
            first: None,
            fresh: self.fresh && !self.relative,
            anded: self.anded || self.after_and(),
            not,
            finite: self.after_is() && !self.relative,
            // ("we are behind a trailer pulled by a car": the trailer is)
            ego: self.ego_subject && self.head.is_empty() && (self.last.is_empty() || self.fresh || !of_last),
            distance_m,
        });
    }

    pub(in super::super) fn anchor(&mut self, anchor: Anchor, span: Span) {
        let Some(mut p) = self.pending.take() else {
            return;
        };
        let between = p.prep == Prep::Rels(vec![RelationKind::Between]);
        if between && p.first.is_none() {
            let plural = match anchor {
                Anchor::Object(i) => self.mentions.get(i).is_some_and(|m| m.plural),
                _ => false,
            };
            if !plural {
                p.first = Some(anchor);
                p.span = p.span.to(span);
                self.pending = Some(p);
                return;
            }
        }
        if let (true, Some(Anchor::Object(a)), Anchor::Object(b)) = (between, p.first, anchor) {
            self.pair = vec![a, b];
        }
        let (anchor, and) = match p.first {
            Some(first) => (first, Some(anchor)),
            None => (anchor, if between { Some(anchor) } else { None }),
        };
        // "I have to stop for a mother and two children": they are who it is about
        if let (true, Anchor::Object(i), Prep::At, None) = (p.ego, anchor, &p.prep, and)
            && self.mentions[i].is_anchor
        {
            self.mentions[i].is_anchor = false;
            self.head = vec![i];
            self.last = vec![i];
            self.list = vec![i];
            self.chain = true;
            return;
        }
        if p.ego && between && self.ego_between(anchor, and, p.span.to(span)) {
            return;
        }
        if let (true, Anchor::Object(i), Prep::Rels(kinds)) = (p.ego && and.is_none(), anchor, &p.prep) {
            // "I am behind a bus": the bus is in front of the ego vehicle.
            let frag = Frag {
                prep: Prep::Rels(kinds.iter().map(|k| seen_from_other(*k)).collect()),
                anchor: Anchor::Ego,
                and: None,
                distance_m: p.distance_m,
                span: p.span.to(span),
            };
            let drawn = (0..self.mentions.len()).filter(|k| {
                let m = &self.mentions[*k];
                m.spec.class == Class::Trailer
                    && m.spec.relations.iter().any(|r| r.anchor == Anchor::Object(i))
            });
            for k in drawn.collect::<Vec<_>>() {
                apply(&mut self.mentions[k].spec, &frag);
            }
            let m = &mut self.mentions[i];
            m.is_anchor = false;
            apply(&mut m.spec, &frag);
            self.last = vec![i];
            return;
        }
        let frag = Frag {
            prep: p.prep,
            anchor,
            and,
            distance_m: p.distance_m,
            span: p.span.to(span),
        };
        if p.not {
            self.unread(frag.span, Some("where something is not, is not read".into()));
            return;
        }
        // "behind a bus that comes towards us, two cars": the bus comes
        let of_front = match self.fronted.last().map(|f| match (f.anchor, f.and) {
            // "between us and the bus, which is 30 m ahead": the bus is
            (Anchor::Ego, Some(and)) if self.relative => and,
            (anchor, _) => anchor,
        }) {
            Some(Anchor::Object(i))
                if self.head.is_empty() && !p.fresh && !p.ego && frag.anchor != Anchor::Object(i) =>
            {
                Some(i)
            }
            _ => None,
        };
        if let Some(i) = of_front {
            // "between a van and a lorry, both at the kerb, ...": of both
            let whom = if self.relative && self.last.len() == 2 {
                self.last.clone()
            } else {
                vec![i]
            };
            for i in whom {
                apply(&mut self.mentions[i].spec, &frag);
            }
            return;
        }
        let set_off = p.fresh && (p.anded || self.front.is_some()) && self.set_off();
        // "20 m in front of me a car, 20 m behind me another one"
        let another = !self.edits
            && self.item(self.at + 1).is_some_and(|n| {
                n.tag == Tag::Is(Sense::Part(false))
                    && (n.words.starts_with("another") || n.words.starts_with("a "))
            })
            && self.ends(self.at + 2);
        let new_noun = set_off
            || another
            || self.noun_ahead(self.at + 1)
            || self.bare_number(self.at + 1)
            // "to the right stand three"
            || self.bare_number(self.at + 2)
                && (matches!(self.sense(self.at + 1), Some(Sense::State(_, true)))
                    || self.item(self.at + 1).is_some_and(|n| matches!(n.words.as_str(), "is" | "are")))
            || self.inverted_ahead(self.at + 1);
        // "the host trails a truck in its lane"
        let of_last = self.ego_subject && !p.fresh && self.head.is_empty() && !self.last.is_empty();
        if !of_last && (self.head.is_empty() || (p.fresh && new_noun)) {
            if !self.head.is_empty() || !self.chain {
                self.new_clause();
            }
            self.front = Some(frag.anchor);
            self.fronted.push(frag);
            self.chain = true;
            return;
        }
        let targets = if p.fresh || p.finite {
            self.head.clone()
        } else {
            self.targets()
        };
        // "three oncoming cars and a man on the crossing": where the cars are was said.
        let open: Vec<usize> = targets
            .iter()
            .copied()
            .filter(|t| !self.mentions[*t].said_where)
            .collect();
        let targets = if targets.len() > 1 && !open.is_empty() {
            open
        } else {
            targets
        };
        // "let the bus and the car in the right lane trade places": the car is there
        let named = self.edits
            && !p.fresh
            && !p.finite
            && targets.len() > 1
            && targets
                .iter()
                .all(|t| self.mentions[*t].definite && !self.mentions[*t].plural);
        let targets = if named {
            targets[targets.len() - 1..].to_vec()
        } else {
            targets
        };
        // "a jogger passes a parked bus on the right pavement": the jogger is there
        let read = &self.items[..self.items.len().min(self.at + 1)];
        let prep = read.iter().rposition(|i| i.span.start == frag.span.start);
        let at_noun = prep
            .and_then(|k| self.sense(k.checked_sub(1)?))
            .is_some_and(|s| matches!(s, Sense::Noun(..)));
        let pavement = matches!(
            frag.anchor,
            Anchor::Lane(LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk)
        );
        let drives = targets.iter().all(|t| self.mentions[*t].spec.class.is_vehicle());
        let walkers: Vec<usize> = self
            .head
            .iter()
            .copied()
            .filter(|h| {
                let m = &self.mentions[*h];
                m.spec.class == Class::Pedestrian
                    && !m
                        .spec
                        .relations
                        .iter()
                        .any(|r| matches!(r.anchor, Anchor::Lane(_)))
            })
            .collect();
        let targets =
            if pavement && at_noun && drives && !self.edits && !targets.is_empty() && !walkers.is_empty() {
                walkers
            } else {
                targets
            };
        // "two oncoming cars and a man on the pavement": the man is
        let walk = matches!(
            frag.anchor,
            Anchor::Lane(LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk)
        );
        let on_foot = |t: &usize| !self.mentions[*t].spec.class.is_vehicle();
        let mixed = walk && !self.edits && targets.iter().any(on_foot);
        let targets: Vec<usize> = targets
            .into_iter()
            .filter(|t| !mixed || on_foot(t) || self.mentions[*t].spec.relations.is_empty())
            .collect();
        let own = |t: &usize| {
            let me = Anchor::Object(*t);
            frag.anchor == me && frag.and.is_none()
        };
        for t in targets.iter().filter(|t| !own(t)) {
            apply(&mut self.mentions[*t].spec, &frag);
        }
        self.chain = false;
    }

    /// Ends a relation that nothing followed.
    pub(in super::super) fn flush(&mut self) {
        let Some(p) = self.pending.take() else {
            return;
        };
        let span = p.span;
        let default = match (&p.prep, p.first) {
            (_, Some(first)) => Some(first),
            (Prep::Rels(kinds), None) => match kinds.first() {
                // "a bus has stopped at the zebra, and five children are walking over"
                Some(RelationKind::Crossing) if self.last_place == Some(Anchor::Crossing) => {
                    Some(Anchor::Crossing)
                }
                Some(RelationKind::Crossing) => Some(Anchor::Lane(LaneRole::Road)),
                Some(RelationKind::Blocking) => Some(Anchor::Lane(LaneRole::Ego)),
                Some(
                    RelationKind::InFrontOf
                    | RelationKind::Behind
                    | RelationKind::LeftOf
                    | RelationKind::RightOf
                    | RelationKind::Near
                    | RelationKind::NextTo
                    | RelationKind::Across
                    | RelationKind::Following
                    | RelationKind::Facing
                    | RelationKind::OppositeDirection
                    | RelationKind::SameDirection
                    | RelationKind::FarFrom,
                ) => Some(Anchor::Ego),
                _ => None,
            },
            _ => None,
        };
        let words = span.of(self.prompt).to_string();
        match default {
            Some(anchor) => {
                let mut p = p;
                if p.prep == Prep::Rels(vec![RelationKind::Across])
                    && anchor == Anchor::Ego
                    && let Some(left) = self.side_of_other()
                {
                    // "opposite, ...": on the other side than what was named before
                    p.prep = if left { Prep::NearSide } else { Prep::FarSide };
                }
                self.pending = Some(Pending { first: None, ..p });
                if self
                    .pending
                    .as_ref()
                    .is_some_and(|p| p.prep == Prep::Rels(vec![RelationKind::Between]))
                {
                    self.pending = None;
                    self.unread(span, Some("between what?".into()));
                } else {
                    self.anchor(anchor, span);
                }
            }
            None if matches!(p.prep, Prep::In | Prep::At | Prep::Across) => {}
            None => self.unread(span, Some(format!("{words} what?"))),
        }
    }

    pub(super) fn drop_pending(&mut self) {
        if self
            .pending
            .as_ref()
            .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At))
        {
            self.pending = None;
        }
    }

    /// An adjective that says where: "an oncoming truck".
    pub(super) fn fronted_once(&mut self, kinds: &[RelationKind], span: Span) {
        let attributes = std::mem::take(&mut self.pre);
        self.pre = attributes;
        self.pre.cover(span);
        self.pre.attributes.push(format!(
            "\u{1}{}",
            kinds.iter().map(|k| k.name()).collect::<Vec<_>>().join(",")
        ));
    }

    /// Who a relation or a participle right here speaks of.
    pub(in super::super) fn targets(&self) -> Vec<usize> {
        if self.fresh && !self.relative {
            return self.head.clone();
        }
        // What is said of a trailer holds for what draws it.
        match self.last.as_slice() {
            [i] if self.mentions[*i].spec.class == Class::Trailer => {
                match self.mentions[*i].host.or_else(|| {
                    let r = &self.mentions[*i].spec.relations;
                    r.iter().find_map(|r| match (r.relation, r.anchor) {
                        (RelationKind::Following, Anchor::Object(k)) => Some(k),
                        _ => None,
                    })
                }) {
                    Some(host) => vec![*i, host],
                    None => vec![*i],
                }
            }
            last => last.to_vec(),
        }
    }

    /// Who a verb speaks of: finite ones the subject, unless after "which".
    pub(super) fn subjects(&self, finite: bool) -> Vec<usize> {
        if self.relative || !finite {
            self.last.clone()
        } else {
            self.head.clone()
        }
    }
}

/// What the other one is to the first.
fn seen_from_other(kind: RelationKind) -> RelationKind {
    use RelationKind as R;
    match kind {
        R::Behind | R::Following | R::Facing => R::InFrontOf,
        R::InFrontOf | R::FacingAway => R::Behind,
        R::LeftOf => R::RightOf,
        R::RightOf => R::LeftOf,
        other => other,
    }
}
