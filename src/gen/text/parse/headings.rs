//! Headings, lists after a colon, and places that have something: "Wrong-way driver: a car comes", "the left lane has two cars".

use super::super::description::Anchor;
use super::super::lexicon::Sense;
use super::super::mention::{Mention, Prep};
use super::super::tag::Tag;
use super::super::tokens::Span;
use super::Parser;

impl Parser<'_> {
    /// "Wrong-way driver: a car comes at us": a bare noun before a colon is a heading.
    pub(in super::super) fn heading(&mut self) {
        let listed = matches!(
            self.item(self.at + 1).map(|n| n.tag),
            Some(Tag::Number(_) | Tag::Is(Sense::Article(_) | Sense::Count(_)))
        );
        let plain = |m: &Mention| m.uncounted && m.bare && !m.plural;
        // (what a sentence before says the place of is no heading)
        let own = self.sentence.min(self.mentions.len());
        let placed = self.mentions[..own].iter().any(|m| !m.spec.relations.is_empty());
        if listed && !placed && self.mentions.iter().all(plain) {
            for m in &mut self.mentions {
                m.gone = true;
            }
            self.head.clear();
            self.last.clear();
        }
        // "Vehicles: one bus, ...": the list names them itself
        let nouns_follow = listed
            && self.items[self.at + 1..]
                .iter()
                .take(6)
                .find_map(|n| match n.tag {
                    Tag::Is(Sense::Noun(noun, _)) => Some(noun),
                    Tag::Is(Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At) | Tag::Stop => None,
                    _ => None,
                })
                .is_some_and(|noun| {
                    self.head.last().is_some_and(|i| {
                        let m = &self.mentions[*i];
                        m.uncounted
                            && (m.bare || m.definite)
                            && m.plural
                            && m.classes.contains(&noun.classes[0])
                    })
                })
            && self.items[self.at + 1..]
                .iter()
                .take_while(|n| !matches!(n.tag, Tag::Is(Sense::Noun(..))))
                .all(|n| {
                    !matches!(
                        n.tag,
                        Tag::Is(Sense::In | Sense::At | Sense::Rel(_) | Sense::EgoRel(_)) | Tag::Comma
                    )
                });
        if nouns_follow && let Some(&i) = self.head.last() {
            self.mentions[i].gone = true;
            self.head.clear();
            self.last.clear();
            self.list.clear();
        }
        // ("the ego vehicle in the middle lane: ..." says where we are)
        let clause = self.items[..self.at.min(self.items.len())]
            .iter()
            .rev()
            .take_while(|n| !matches!(n.tag, Tag::Stop | Tag::Comma));
        let subject = clause
            .filter(|n| !matches!(n.tag, Tag::Is(Sense::Article(_))))
            .last();
        let ours = subject.is_some_and(|n| matches!(n.tag, Tag::Is(Sense::Ego)));
        // "Left pavement: two ladies."
        if let Some((anchor, span)) = self.topic.filter(|_| {
            !ours
                && self.head.is_empty()
                && self.pending.is_none()
                && (listed || self.noun_ahead(self.at + 1))
        }) && matches!(anchor, Anchor::Lane(_))
            && !matches!(anchor, Anchor::Lane(crate::scene::graph::LaneRole::Road))
        {
            self.topic = None;
            let frag = super::super::mention::Frag {
                prep: Prep::In,
                anchor,
                and: None,
                distance_m: None,
                span,
            };
            self.headed = vec![frag.clone()];
            self.fronted.push(frag);
            self.chain = true;
        }
    }

    /// After "consists of": what follows is a list of its own.
    pub(in super::super) fn end_list(&mut self) {
        if !self.listed.is_empty() {
            self.head.clear();
            self.chain = true;
        }
    }

    /// What follows a colon stands where what is before it was said to be.
    pub(in super::super) fn introduce(&mut self) {
        let Some(&first) = self.head.first() else {
            return;
        };
        if !self.noun_ahead(self.at + 1) || self.bare_number(self.at + 1) {
            return;
        }
        self.listed = self.mentions[first]
            .spec
            .relations
            .iter()
            .filter(|r| r.anchor != Anchor::Object(first))
            .copied()
            .collect();
    }

    /// "the left lane has two cars": what follows stands there. True if it was that.
    pub(in super::super) fn place_has(&mut self, item: &super::super::tag::Item) -> bool {
        use crate::scene::graph::LaneRole as L;
        let Some((anchor, span)) = self
            .topic
            .filter(|_| self.head.is_empty() && self.pending.is_none())
        else {
            return false;
        };
        let fits = match anchor {
            Anchor::Lane(L::Road | L::Cross) | Anchor::Ego | Anchor::Object(_) => false,
            Anchor::Junction => item.words != "with",
            _ => true,
        };
        if !fits || !self.noun_ahead(self.at + 1) {
            return false;
        }
        self.topic = None;
        self.begin(
            if anchor == Anchor::Junction {
                Prep::At
            } else {
                Prep::In
            },
            span,
        );
        self.anchor(anchor, span);
        true
    }

    /// "there" at the end of a clause: at the place that was named last.
    pub(in super::super) fn there(&mut self, span: Span) {
        let Some(place) = self.last_place else {
            return;
        };
        let placed = |i: &usize| {
            let of_place = |a: Anchor| !matches!(a, Anchor::Ego | Anchor::Object(_));
            self.mentions[*i]
                .spec
                .relations
                .iter()
                .any(|r| of_place(r.anchor))
        };
        if self.head.is_empty() || self.pending.is_some() || self.head.iter().any(placed) {
            return;
        }
        let lane = matches!(place, Anchor::Lane(_));
        self.begin(if lane { Prep::In } else { Prep::At }, span);
        self.anchor(place, span);
    }
}
