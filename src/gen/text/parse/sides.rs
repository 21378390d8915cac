//! Sides of the road that hang on what was named before: "on the other side", "opposite", "nearby", and clauses that
//! begin with a place.

use super::super::description::{Anchor, Count};
use super::super::lexicon::Sense;
use super::super::mention::Prep;
use super::super::tag::{Item, Tag};
use super::super::tokens::Span;
use super::super::words::edits::Verb;
use super::Parser;
use crate::scene::graph::{LaneRole as L, RelationKind as R};

impl Parser<'_> {
    /// On which side of the road what was named before stands, if any: true for the left.
    pub(super) fn side_of_other(&self) -> Option<bool> {
        let own = self.targets();
        let side = |i: usize| {
            self.mentions[i]
                .spec
                .relations
                .iter()
                .find_map(|r| match (r.relation, r.anchor) {
                    (R::LeftOf, Anchor::Ego) => Some(true),
                    (R::RightOf, Anchor::Ego) => Some(false),
                    (_, Anchor::Lane(L::LeftRoadside | L::LeftSidewalk | L::Oncoming)) => Some(true),
                    (_, Anchor::Lane(L::RightRoadside | L::RightSidewalk)) => Some(false),
                    _ => None,
                })
        };
        // at the head of a clause the subject is still that of the one before
        let skip = |i: &usize| own.contains(i) && !self.fresh;
        (0..self.mentions.len())
            .rev()
            .filter(|i| !skip(i) && !self.mentions[*i].gone)
            .find_map(side)
    }

    /// "on the other side": of the road, seen from what was named before; from the ego vehicle, if nothing was.
    pub(super) fn other_side(&self, item: &Item) -> Prep {
        let other = item.words.contains("other") || item.words.contains("opposite");
        if other && !self.edits && self.side_of_other() == Some(true) {
            Prep::NearSide
        } else {
            Prep::FarSide
        }
    }

    /// "and two workers nearby": near what was named before, if anything was.
    pub(super) fn by_other(&self, kinds: &[R], item: &Item) -> Option<usize> {
        let near = kinds == [R::Near] && !item.words.contains("here");
        let own = self.targets();
        let earlier =
            |i: &usize| !own.contains(i) && *i < *own.first().unwrap_or(&0) && !self.mentions[*i].gone;
        let before = self.before.iter().rev().copied().find(earlier);
        before
            .or_else(|| (0..self.mentions.len()).rev().find(earlier))
            .filter(|_| near && !self.edits && !own.is_empty())
    }

    /// "cones on either side, three on the left and three on the right", "cars on both sides, two on each": the parts say
    /// how many. True if it was that.
    pub(super) fn part_by_side(&mut self, count: Count, span: Span) -> bool {
        // "four parked cars, two on each side"
        let twice = |i: &usize| {
            let m = &self.mentions[*i];
            let each = matches!(self.sense(self.at + 1), Some(Sense::BothSides(true)));
            each && count.is_exact()
                && !m.gone
                && (m.uncounted || m.spec.count == Count::exactly(2 * count.n))
        };
        let last = (0..self.mentions.len())
            .rev()
            .find(|i| !self.mentions[*i].is_anchor && self.mentions[*i].plural && !self.mentions[*i].gone);
        let group = (0..self.mentions.len())
            .rev()
            .find(|i| {
                let m = &self.mentions[*i];
                m.both.is_some() && !m.is_anchor && (m.plural || m.gone)
            })
            .or(last.filter(twice));
        let Some(group) = group.filter(|_| !self.edits && self.pending.is_none()) else {
            return false;
        };
        match self.sense(self.at + 1) {
            Some(Sense::BothSides(_)) if !self.mentions[group].gone => {
                let m = &mut self.mentions[group];
                m.spec.count = count;
                m.uncounted = false;
                m.both = Some(true);
                self.at += 1;
            }
            // "on opposite pavements, two on each"
            Some(Sense::In | Sense::At)
                if !self.mentions[group].gone
                    && self.item(self.at + 2).is_some_and(|n| {
                        matches!(n.words.as_str(), "each" | "either" | "each one" | "each of them")
                    })
                    && self.ends(self.at + 3) =>
            {
                let m = &mut self.mentions[group];
                m.spec.count = count;
                m.uncounted = false;
                m.both = Some(true);
                self.at += 2;
            }
            Some(Sense::EgoRel([R::LeftOf] | [R::RightOf])) => {
                let mut part = self.mentions[group].clone();
                part.both = None;
                part.gone = false;
                part.uncounted = false;
                part.plural = count.n > 1;
                part.spec.count = count;
                part.spec.span = span;
                part.spec
                    .relations
                    .retain(|r| !matches!(r.relation, R::LeftOf | R::RightOf));
                self.mentions[group].gone = true;
                self.mentions.push(part);
                let index = self.mentions.len() - 1;
                self.head = vec![index];
                self.last = vec![index];
                self.chain = false;
            }
            _ => return false,
        }
        self.pre = super::Pre::default();
        true
    }

    /// True if a clause with its subject after the verb goes on here: "(behind us) drives a taxi", "(on the right), close
    /// to the bus, stands a man".
    pub(super) fn inverted_ahead(&self, from: usize) -> bool {
        let mut j = from;
        while let Some(item) = self.item(j) {
            match item.tag {
                Tag::Comma | Tag::Unknown => {}
                Tag::Number(_) | Tag::Is(Sense::Count(_))
                    if matches!(self.sense(j + 1), Some(Sense::Unit(_))) =>
                {
                    j += 1;
                }
                Tag::Is(
                    Sense::Rel(_)
                    | Sense::EgoRel(_)
                    | Sense::In
                    | Sense::At
                    | Sense::Place(..)
                    | Sense::Article(true)
                    | Sense::Ego
                    | Sense::FarSide
                    | Sense::Fixed(..)
                    | Sense::Away
                    | Sense::Possessed(_),
                ) => {}
                Tag::Is(Sense::Pronoun) if !matches!(item.words.as_str(), "that" | "they" | "he" | "she") => {
                }
                // a landmark: "close to the bus"
                Tag::Is(Sense::Noun(..))
                    if matches!(self.sense(j.wrapping_sub(1)), Some(Sense::Article(true))) => {}
                Tag::Is(Sense::State(_, true)) => return self.subject_after(j + 1),
                Tag::Is(Sense::Filler) => match item.words.as_str() {
                    // "The second one, right in front of it, is a bus" says what it is
                    "is" | "was" if matches!(self.head.as_slice(), [h] if self.mentions[*h].like) => {
                        return false;
                    }
                    "is" | "are" | "was" | "were" | "there is" | "there are" => {
                        return self.subject_after(j + 1);
                    }
                    "to" | "from" | "the" | "my" | "our" => {}
                    _ => return false,
                },
                _ => return false,
            }
            j += 1;
        }
        false
    }

    /// "Across the street from a bus that is parked there, ...": "that" is the bus.
    pub(super) fn relates_to_front(&mut self) {
        let front = match self.fronted.last() {
            Some(f) if f.and.is_none() => f.anchor,
            _ => return,
        };
        if let (Anchor::Object(i), true, false) =
            (front, self.last.is_empty() && self.head.is_empty(), self.edits)
        {
            self.last = vec![i];
        }
    }

    /// True if the place right here says without a preposition where something stands: "cone ego lane", "car left lane".
    pub(super) fn bare_place(&self, anchor: Anchor) -> bool {
        let place = matches!(anchor, Anchor::Lane(role) if role != L::Road) || anchor == Anchor::Crossing;
        // "has moved over to the right edge of the road"
        let mut k = self.at;
        while k > 0 && matches!(self.sense(k - 1), Some(Sense::Article(true))) {
            k -= 1;
        }
        let word = |k: usize| k.checked_sub(1).and_then(|i| self.item(i));
        let over = word(k).is_some_and(|b| matches!(b.words.as_str(), "to" | "onto"))
            && word(k.saturating_sub(1))
                .is_some_and(|b| matches!(b.tag, Tag::Is(Sense::State(..) | Sense::Verb(Verb::Move))));
        if place && over && !self.last.is_empty() && !self.edits {
            return true;
        }
        let before = self.at.checked_sub(1).and_then(|i| self.item(i));
        let led = before.is_some_and(|b| {
            matches!(
                b.tag,
                Tag::Is(
                    Sense::Noun(..) | Sense::Unit(_) | Sense::EgoRel(_) | Sense::State(_, false) | Sense::Ego
                )
            )
        });
        // "a fire engine, 25 m, same lane as ours"
        let alone = before.is_some_and(|b| b.tag == Tag::Comma)
            && self.ends(self.at + 1)
            && self.item(self.at + 1).is_none_or(|n| n.words != ":");
        let led = led || alone && !self.edits && self.head.len() == 1;
        // "a bus lane bus", "pedestrians crosswalk sign"
        let one_word = self.items[self.at].words.contains(' ') || !matches!(anchor, Anchor::Lane(L::Ego));
        place && led && one_word && !self.last.is_empty() && !self.noun_directly(self.at + 1)
    }

    /// "on both sides": of those named before, or of those to come; `each`: the number is that of one side.
    pub(super) fn both_sides(&mut self, each: bool, span: Span) {
        self.flush();
        let mut targets = self.targets();
        if self.reversed.is_some() {
            targets.truncate(1); // "flanked by two cones on each side"
        }
        // "and on both sides stand two cars"
        // ("on both sides of the street, a row of cones stands")
        let comma = targets.is_empty() && self.item(self.at + 1).is_some_and(|n| n.tag == Tag::Comma);
        let next = self.at + 1 + usize::from(comma);
        if self.fresh && self.noun_ahead(next) && self.reversed.is_none() {
            self.new_clause();
            targets.clear();
        }
        if targets.is_empty() && self.noun_ahead(next) {
            self.fronted_both = Some(each);
        } else if targets.is_empty() {
            self.unread(span, Some("nothing stands before it".into()));
        }
        let apiece = |t: &usize| {
            let spec = &self.mentions[*t].spec;
            spec.count.n == 1 || spec.attributes.iter().any(|a| a == "each")
        };
        let each = each || targets.iter().any(apiece);
        self.chain = false;
        for t in targets {
            self.mentions[t].both = Some(each);
            self.mentions[t].spec.span = self.mentions[t].spec.span.to(span);
        }
    }

    /// True if a new subject begins at item `i`: "a taxi", "two men".
    fn subject_after(&self, i: usize) -> bool {
        let fresh = matches!(
            self.item(i).map(|n| n.tag),
            Some(Tag::Number(_) | Tag::Is(Sense::Article(false) | Sense::Count(_) | Sense::Part(_)))
        );
        fresh && self.noun_ahead(i)
    }
}
