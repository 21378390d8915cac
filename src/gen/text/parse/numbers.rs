//! Counts and distances: how many, how far, of what.

use super::super::description::{Anchor, Became, Count, Stated};
use super::super::lexicon::Sense;
use super::super::mention::{Frag, Pre, Prep};
use super::super::tag::Tag;
use super::super::tokens::Span;
use super::super::words::objects::NOUNS;
use super::{Parser, is_directed};
use crate::scene::graph::{LaneRole, RelationKind};

impl Parser<'_> {
    pub(super) fn count(&mut self, count: Count, span: Span) {
        if let Some(Sense::Place(Anchor::Lane(role), _)) = self.sense(self.at + 1)
            && matches!(role, LaneRole::Ego | LaneRole::Road)
            && self.items[self.at + 1].words.starts_with("lane")
            && self.pending.is_none()
        {
            // "two lanes", "four lane road"
            self.at += 1;
            let mut whole = span.to(self.items[self.at].span);
            if let Some(next) = self.item(self.at + 1)
                && matches!(
                    next.tag,
                    Tag::Is(Sense::Place(Anchor::Lane(LaneRole::Road), _) | Sense::RoadKind(..))
                )
            {
                if let Tag::Is(Sense::RoadKind(road, environment)) = next.tag {
                    self.road_kind(road, environment, next.span);
                }
                self.at += 1;
                whole = whole.to(next.span);
            }
            self.d().road.lanes = Some(count.n.clamp(1, 8));
            self.phrase(whole, Became::Road, &format!("{} lanes", count.n));
            self.pre = Pre::default();
            return;
        }
        let count = self.bounded(count);
        if self.items[self.at].words == "both" && self.both_of_them() || self.the_two(count.n, span) {
            return;
        }
        if self.all_of_them(count) || self.part_by_side(count, span) {
            return;
        }
        let next_is_part = !self.noun_ahead(self.at + 1);
        if next_is_part
            && !self.edits
            && matches!(self.sense(self.at.wrapping_sub(1)), Some(Sense::Noun(_, true)))
            && let Some(&i) = self.last.last().filter(|i| self.mentions[**i].uncounted)
        {
            // "barricades four nos. are kept on the left"
            self.mentions[i].spec.count = count;
            self.mentions[i].uncounted = false;
            return;
        }
        let more = matches!(
            self.sense(self.at + 1),
            Some(Sense::Pick(super::super::words::edits::Pick::More))
        );
        let placed = matches!(
            self.sense(self.at + 2),
            Some(
                Sense::In
                    | Sense::At
                    | Sense::Rel(_)
                    | Sense::EgoRel(_)
                    | Sense::FarSide
                    | Sense::State(..)
                    | Sense::Possessed(_)
            )
        );
        if next_is_part
            && !self.edits
            && more
            && placed
            && self.pending.is_none()
            && !self.mentions.is_empty()
        {
            // "six people on the left, two more on the right"
            self.at += 1;
            self.again(count, span);
            return;
        }
        if next_is_part && !self.edits && self.bare_number(self.at) && !self.fronted.is_empty() {
            // "on the left are three cars, and on the right two."
            self.again(count, span);
            return;
        }
        if next_is_part && !self.edits && self.pending.is_none() && self.numbers_last(count, span) {
            return;
        }
        if next_is_part && self.group_behind().is_some() {
            self.part(false, count, span);
            return;
        }
        if next_is_part
            && !self.edits
            && self.pending.is_none()
            && count.is_exact()
            && self.one_more_like_it()
        {
            // "a car in front, one behind"
            self.again(count, span);
            return;
        }
        if next_is_part
            && self.edits
            && matches!(self.items[self.at].words.as_str(), "one")
            && self.pending.is_none()
        {
            // "the one behind me"
            if let Some(noun) = NOUNS.last() {
                self.noun(noun, "object", false, span);
            }
            return;
        }
        if next_is_part {
            // a number of nothing: "a lot of traffic" and the like come as one run
            if !matches!(
                self.sense(self.at + 1),
                Some(
                    Sense::Filler
                        | Sense::Environment(_)
                        | Sense::Place(..)
                        | Sense::Background
                        | Sense::Cannot(_)
                        | Sense::RoadKind(..)
                        | Sense::Pick(_)
                        | Sense::Density(_)
                        | Sense::Size(_)
                        | Sense::Part(_)
                )
            ) && !self.edits
            {
                self.unread(span, Some("a number of what?".into()));
            }
        }
        self.pre.count = Some(count);
        self.pre.cover(span);
    }

    /// "more than four children" are five at least, "fewer than four" three at most.
    fn bounded(&self, count: Count) -> Count {
        let before = self
            .item(self.at.wrapping_sub(1))
            .map_or("", |b| b.words.as_str());
        let counts = count.is_exact() && self.noun_ahead(self.at + 1) && count.n < 100;
        match before {
            "more than" | "over" | "upwards of" | "in excess of" if counts => Count::exactly(count.n + 1),
            "less than" | "fewer than" | "under" if counts && count.n > 1 => Count::exactly(count.n - 1),
            _ => count,
        }
    }

    pub(super) fn try_distance(&mut self, value: f64, span: Span) -> bool {
        let Some(Sense::Unit(m)) = self.sense(self.at + 1) else {
            return false;
        };
        self.at += 1;
        let span = span.to(self.items[self.at].span);
        self.distance_said(value * m, span);
        true
    }

    /// Where the object named before this one is of the ego vehicle, if it was said with metres.
    fn side_of_list(&self, index: usize) -> Option<RelationKind> {
        let before = &self.mentions.get(index.checked_sub(1)?)?.spec.relations;
        let sided = |r: &&Stated| {
            matches!(
                r.relation,
                RelationKind::InFrontOf | RelationKind::Behind | RelationKind::LeftOf | RelationKind::RightOf
            )
        };
        match before.as_slice() {
            [only] if only.anchor == Anchor::Ego && only.distance_m.is_some() && !self.edits => {
                Some(only).filter(sided).map(|r| r.relation)
            }
            _ => None,
        }
    }

    pub(super) fn distance_said(&mut self, metres: f64, span: Span) {
        let back = (1..=2)
            .filter_map(|k| self.sense(self.at.wrapping_sub(1 + k)))
            .collect::<Vec<_>>();
        let metres = match back
            .iter()
            .find_map(|s| if let Sense::Bound(b) = s { Some(*b) } else { None })
        {
            Some(true) => metres * 0.6,
            Some(false) => metres * 1.3,
            None => metres,
        };
        let metres = if metres.is_finite() { metres } else { 1e6 };
        let next = self.item(self.at + 1);
        if next.is_some_and(|n| matches!(n.words.as_str(), "long" | "wide" | "tall" | "high" | "deep")) {
            self.at += 1;
            let to = self.items[self.at].span;
            self.unread(span.to(to), Some("sizes in metres are set in the window".into()));
            return;
        }
        if matches!(next.map(|n| n.tag), Some(Tag::Is(Sense::Away))) {
            self.at += 1;
            if self.anchor_ahead(self.at + 1) && next.is_some_and(|n| n.words.ends_with("from")) {
                self.begin(Prep::Rels(vec![RelationKind::Near]), span);
                if let Some(p) = &mut self.pending {
                    p.distance_m = Some(metres);
                }
                return;
            }
        }
        // "15 m away on the right": how far, and on which side; "15 m to the right" is the offset itself.
        let side_next = matches!(
            self.sense(self.at + 1),
            Some(Sense::EgoRel([RelationKind::LeftOf] | [RelationKind::RightOf]))
        );
        let away = matches!(self.sense(self.at), Some(Sense::Away));
        let targets = self.targets();
        if side_next && away && self.pending.is_none() && !targets.is_empty() {
            for t in targets {
                self.mentions[t].spec.relations.push(Stated {
                    relation: RelationKind::Near,
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: Some(metres),
                    span,
                });
            }
            return;
        }
        let relation_next = matches!(self.sense(self.at + 1), Some(Sense::Rel(_) | Sense::EgoRel(_)))
            || self.item(self.at + 1).is_some_and(|i| i.words == "to");
        if relation_next {
            self.distance = Some((metres, span));
            return;
        }
        if let Some(p) = &mut self.pending
            && !matches!(p.prep, Prep::In | Prep::At)
        {
            p.distance_m = Some(metres);
            return;
        }
        // "12 m ahead a car, 24 m a bus": on the same side
        let fresh = matches!(
            next.map(|n| n.tag),
            Some(Tag::Number(_) | Tag::Is(Sense::Article(false) | Sense::Count(_)))
        );
        if self.fresh && fresh && !self.edits && !self.head.is_empty() && self.noun_ahead(self.at + 1) {
            let theirs = &self.mentions[self.head[0]].spec.relations;
            let side = theirs.iter().find(|r| {
                r.anchor == Anchor::Ego
                    && matches!(
                        r.relation,
                        RelationKind::InFrontOf
                            | RelationKind::Behind
                            | RelationKind::LeftOf
                            | RelationKind::RightOf
                    )
            });
            let side = side.map_or(RelationKind::Near, |r| r.relation);
            self.pending = None;
            self.new_clause();
            self.fronted.push(Frag {
                prep: Prep::Rels(vec![side]),
                anchor: Anchor::Ego,
                and: None,
                distance_m: Some(metres),
                span,
            });
            return;
        }
        // "at 20 m", "at a distance of 20 m": of the relation before
        self.pending = None;
        let targets = self.targets();
        let mut used = false;
        let listed = targets.first().and_then(|t| self.side_of_list(*t));
        for t in targets.iter().copied() {
            let list = &mut self.mentions[t].spec.relations;
            if let Some(r) = list
                .iter_mut()
                .rev()
                .find(|r| r.distance_m.is_none() && is_directed(r.relation))
            {
                let side = matches!(r.relation, RelationKind::LeftOf | RelationKind::RightOf);
                if side && r.anchor == Anchor::Ego && metres > 7.0 {
                    // "parked on the right, at 18 m": no road is so wide, it is so far ahead
                    list.push(Stated {
                        relation: RelationKind::InFrontOf,
                        anchor: Anchor::Ego,
                        and: None,
                        distance_m: Some(metres),
                        span,
                    });
                } else {
                    r.distance_m = Some(metres);
                }
                used = true;
            } else if list
                .iter()
                .all(|r| matches!(r.anchor, Anchor::Lane(_)) && r.distance_m.is_none())
            {
                // "in front of me: a car at 10 m, a truck at 20 m": the side holds for all of the list
                list.push(Stated {
                    relation: listed.unwrap_or(RelationKind::Near),
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: Some(metres),
                    span,
                });
                used = true;
            }
        }
        self.chain &= !used; // what comes next is no longer of one list with these
        if !used && targets.is_empty() {
            if let Some(f) = self.fronted.iter_mut().rev().find(|f| f.distance_m.is_none()) {
                f.distance_m = Some(metres);
            } else {
                self.distance = Some((metres, span));
            }
        }
    }
}
