//! Small words: what has, is, where, which, each, there, so.

use super::super::description::Anchor;
use super::super::lexicon::Sense;
use super::super::mention::Prep;
use super::super::tag::{Item, Tag};
use super::Parser;
use crate::scene::graph::LaneRole;

impl Parser<'_> {
    /// One small word; true if it leaves boundaries as they are.
    pub(super) fn small_word(&mut self, item: &Item) -> bool {
        let span = item.span;
        match item.words.as_str() {
            // "an ambulance with two paramedics beside it is parked"
            "it is" if self.pending.is_some() => {
                let it = Item {
                    words: "it".into(),
                    ..item.clone()
                };
                self.pronoun(&it);
                self.back_to_host();
            }
            "is" | "was" if self.pending.is_none() => self.back_to_host(),
            // "the left lane has two cars in it"
            "with" | "has" | "have" | "having" | "holds" | "contains" | "contains only" | "has only"
            | "holds only" | "with only"
                if self.place_has(item) => {}
            // "my lane has been closed off by cones"
            "has" | "have"
                if self
                    .item(self.at + 1)
                    .is_some_and(|n| n.words.starts_with("been")) => {}
            "with" | "has" | "have" | "having" => {
                // "two cars and a man with his back to us": the man has
                let own = self
                    .item(self.at + 1)
                    .is_some_and(|n| matches!(n.words.split(' ').next(), Some("his" | "her" | "its")));
                if own && item.words == "with" && self.last.len() > 1 && !self.edits {
                    self.last.drain(..self.last.len() - 1);
                    self.head.clone_from(&self.last);
                    self.chain = false;
                }
                self.with = true;
                self.topic = None;
            }
            // "a street on which two cars are parked" sets the stage
            "which"
                if !self.edits
                    && self.mentions.is_empty()
                    && self.last_place.is_none()
                    && self
                        .pending
                        .as_ref()
                        .is_some_and(|p| p.first.is_none() && matches!(p.prep, Prep::In | Prep::At)) =>
            {
                self.pending = None;
                self.soft_end();
            }
            // "a bus, behind which two cars wait"
            "which" | "who" | "whom"
                if self.pending.as_ref().is_some_and(|p| p.first.is_none())
                    // "a bus at a zebra on which two children walk": on the zebra
                    && !(self.last_place.is_some()
                        && matches!(
                            self.at.checked_sub(2).and_then(|i| self.sense(i)),
                            Some(Sense::Place(..) | Sense::Fixed(..))
                        ))
                    && self.last.first().or(self.head.first()).is_some() =>
            {
                let host = self.last.first().or(self.head.first()).copied();
                if let (Some(host), Some(p)) = (host, self.pending.as_mut()) {
                    p.fresh = true;
                    self.anchor(Anchor::Object(host), span);
                }
                return false;
            }
            // "a car park in which eight cars stand"
            "which" | "that"
                if self.pending.as_ref().is_some_and(|p| p.first.is_none()) && self.last_place.is_some() =>
            {
                if let (Some(place), Some(p)) = (self.last_place, self.pending.as_mut()) {
                    p.fresh = true;
                    self.anchor(place, span);
                }
                return false;
            }
            "i am" | "im" | "we are" | "i drive" | "we drive" | "i am driving" | "im driving"
            | "we are driving" | "i am on" | "we are on" | "were"
                if self.pending.is_none()
                    && (self.head.is_empty() || self.linked && self.fresh)
                    && !self.edits =>
            {
                if !self.head.is_empty() {
                    self.new_clause();
                }
                self.ego_subject = true;
            }
            "which" | "who" | "that is" | "that are" | "who is" | "who are" | "which is" | "which are"
            | "thats" | "whos" => {
                self.relative = true;
                self.relates_to_front();
                // "between a van and a lorry that are parked"
                let several = item.words.ends_with("are");
                if several && self.pair.len() == 2 && self.last.last() == self.pair.last() {
                    self.last = self.pair.clone();
                }
                // "a mother and two children who ..."
                let class = self.last.last().map(|i| self.mentions[*i].spec.class);
                if self.head.len() > 1
                    && self.list.len() == self.head.len()
                    && self
                        .head
                        .iter()
                        .all(|i| Some(self.mentions[*i].spec.class) == class)
                {
                    self.last = self.head.clone();
                }
            }
            "both of which" | "both of whom" | "all of which" | "all of whom" => {
                self.relative = true;
                if self.pair.len() == 2 {
                    self.last = std::mem::take(&mut self.pair);
                }
            }
            // "the site ahead consists of a digger and two cones"
            "consists of" | "consist of" | "consists out of" | "is made up of" | "comprises" | "comprise"
            | "includes" | "include"
                if !self.edits =>
            {
                self.introduce();
                self.end_list();
            }
            // "... obstructs the crossing; four people wait there"
            "there" | "over there" | "are there" | "is there" | "stand there" | "wait there"
                if self.ends(self.past_too(self.at + 1)) && !self.edits =>
            {
                self.there(span)
            }
            // "on both pavements stand three people each"
            "each"
                if self.ends(self.at + 1) && self.last.iter().any(|i| self.mentions[*i].both.is_some()) =>
            {
                for i in self.last.clone() {
                    self.mentions[i].both = self.mentions[i].both.map(|_| true);
                }
            }
            // "two cars each are parked on both sides"
            "each"
                if !self.edits
                    && matches!(self.sense(self.at.wrapping_sub(1)), Some(Sense::Noun(_, true))) =>
            {
                for i in self.last.clone() {
                    self.mentions[i].spec.attributes.push("each".into());
                }
            }
            // "the truck is parked, and so is the bus"
            "soistoo" => {
                let like = self.head.first().or(self.before.first()).copied();
                self.soft_end();
                self.alike = like;
            }
            "nearfirst" | "farfirst" => self.ordered_by(&item.words),
            // "a fire engine is behind me, so both cars have pulled over"
            "so" | "because" | "since" | "therefore" | "hence"
                if !self.edits
                    && self.noun_ahead(self.at + 1)
                    && (item.words == "because"
                        || self
                            .item(self.at.wrapping_sub(1))
                            .is_some_and(|b| matches!(b.tag, Tag::Comma | Tag::Mark))) =>
            {
                self.soft_end();
            }
            "each" | "every" => self.pre.each = true,
            "it is" | "its" | "its a" if self.head.is_empty() => {
                self.head = self.before.clone();
                self.last = self.before.clone();
                self.chain = false;
            }
            // "a car park where six cars stand"
            "where" => {
                let place = self.topic.take().filter(|(a, _)| {
                    matches!(a, Anchor::Crossing | Anchor::Junction)
                        || matches!(a, Anchor::Lane(role) if !matches!(role, LaneRole::Road | LaneRole::Ego))
                });
                self.end_clause();
                if let Some((place, at)) = place.filter(|_| self.noun_ahead(self.at + 1)) {
                    self.begin(Prep::In, at);
                    self.anchor(place, at);
                }
            }
            _ => {}
        }
        true
    }
}
