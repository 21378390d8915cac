//! Lists that are ordered by distance: "nearest first: a cyclist, then a bus, then a tanker".

use super::description::{Anchor, Stated};
use super::mention::{Frag, Mention, Prep};
use super::parse::Parser;
use super::tag::Item;
use super::tokens::Span;
use crate::scene::graph::{LaneRole as L, RelationKind as R};

/// What says that a list goes from near to far.
pub const NEAR_FIRST: &str = "nearest first|closest first|the nearest first|the closest first|from near to far|from nearest to farthest|from nearest to furthest|from the nearest to the farthest|from the nearest to the furthest|from closest to farthest|from closest to furthest|in order of distance|in order of increasing distance|starting with the nearest|starting with the closest|starting from the nearest|starting nearest|near to far|from close to far|one after the other from near to far";
/// The other way round.
pub const FAR_FIRST: &str = "farthest first|furthest first|the farthest first|the furthest first|from far to near|from farthest to nearest|from furthest to nearest|in order of decreasing distance|starting with the farthest|starting with the furthest|far to near";

/// What says that something is farther on than what was named before it.
const FARTHER: &str = "further ahead|farther ahead|further on|farther on|further up|farther up|further along|further in front|farther in front|further up the road|further down the road|farther down the road|even further ahead";

impl Parser<'_> {
    /// "and further ahead a bus": ahead of what was named ahead of us before.
    pub(super) fn farther_on(&mut self, item: &Item, span: Span) {
        // ("a little further ahead")
        let said = |w: &str| {
            item.words
                .strip_suffix(w)
                .is_some_and(|lead| lead.is_empty() || lead.ends_with(' '))
        };
        if self.edits || !FARTHER.split('|').any(said) {
            return;
        }
        let ahead = |m: &Mention| {
            m.spec
                .relations
                .iter()
                .any(|r| r.anchor == Anchor::Ego && r.relation == R::InFrontOf)
        };
        let own = if self.fronted.is_empty() {
            self.targets()
        } else {
            Vec::new()
        };
        let before = (0..self.mentions.len()).rev().find(|i| {
            !own.contains(i)
                && !self.mentions[*i].gone
                && !self.mentions[*i].is_anchor
                && ahead(&self.mentions[*i])
        });
        let Some(before) = before else {
            return;
        };
        if own.is_empty() {
            self.fronted.push(Frag {
                prep: Prep::Rels(vec![R::InFrontOf]),
                anchor: Anchor::Object(before),
                and: None,
                distance_m: None,
                span,
            });
        }
        for i in own.into_iter().filter(|i| *i > before) {
            self.mentions[i].spec.relations.push(Stated {
                relation: R::InFrontOf,
                anchor: Anchor::Object(before),
                and: None,
                distance_m: None,
                span,
            });
        }
    }

    /// "behind the taxi a bus and then a van": what the one after "then" is behind.
    pub(super) fn after_then(&self, frag: &Frag) -> Option<usize> {
        let along = matches!(&frag.prep, Prep::Rels(k) if matches!(k.as_slice(), [R::Behind | R::InFrontOf | R::Following]));
        let then = (1..=3).any(|k| {
            self.at
                .checked_sub(k)
                .and_then(|i| self.item(i))
                .is_some_and(|i| matches!(i.words.as_str(), "then" | "and then" | "next" | "and next"))
        });
        let before = self.list.len().checked_sub(2).map(|k| self.list[k]);
        before.filter(|_| along && then && !self.edits)
    }

    /// A list ordered by distance begins, or goes on, here.
    pub(super) fn ordered_by(&mut self, words: &str) {
        self.order = Some((words == "nearfirst", None));
    }

    /// The next of such a list: farther on than the one before, or nearer.
    pub(super) fn next_in_order(&mut self, index: usize) {
        let Some((near_first, before)) = self.order else {
            return;
        };
        self.order = Some((near_first, Some(index)));
        let m = &mut self.mentions[index];
        let Some(before) = before.filter(|b| *b != index) else {
            // what is told by distance is seen ahead, if nothing else was said
            let told = m.spec.relations.iter().any(|r| {
                r.anchor == Anchor::Ego
                    && matches!(r.relation, R::InFrontOf | R::Behind | R::OppositeDirection)
            });
            if !told {
                m.spec.relations.push(Stated {
                    relation: R::InFrontOf,
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: None,
                    span: m.spec.span,
                });
            }
            return;
        };
        // seen from something that faces us, what is farther on is behind it
        let faces_us = m.spec.relations.iter().any(|r| {
            matches!(r.anchor, Anchor::Lane(L::LeftRoadside | L::Oncoming))
                || r.relation == R::OppositeDirection
        });
        let behind_us = m
            .spec
            .relations
            .iter()
            .any(|r| r.relation == R::Behind && r.anchor == Anchor::Ego);
        let relation = if near_first ^ faces_us ^ behind_us {
            R::InFrontOf
        } else {
            R::Behind
        };
        m.spec.relations.push(Stated {
            relation,
            anchor: Anchor::Object(before),
            and: None,
            distance_m: None,
            span: m.spec.span,
        });
    }
}
