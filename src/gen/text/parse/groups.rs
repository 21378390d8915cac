//! Parts of groups and pronouns: "one on the left and the other on the right", "behind it".

use super::super::description::{Anchor, Count};
use super::super::lexicon::Sense;
use super::super::mention::{Pre, Prep, apply};
use super::super::tag::{Item, Tag};
use super::super::tokens::Span;
use super::{Parser, is_color};
use crate::scene::Class;
use crate::scene::graph::RelationKind;

impl Parser<'_> {
    /// A group that a number without a noun can be a part of.
    pub(in super::super) fn group_behind(&self) -> Option<usize> {
        let next = self.item(self.at + 1)?;
        let told = matches!(
            next.tag,
            Tag::Is(
                Sense::Rel(_)
                    | Sense::EgoRel(_)
                    | Sense::In
                    | Sense::At
                    | Sense::State(..)
                    | Sense::Color(_)
                    | Sense::FarSide
                    | Sense::Fixed(..)
                    | Sense::Pronoun
                    | Sense::Not
            )
        ) || (matches!(next.tag, Tag::Number(_) | Tag::Is(Sense::Count(_)))
            && matches!(self.sense(self.at + 2), Some(Sense::Unit(_))))
            || matches!(next.words.as_str(), "of them" | "of" | "is" | "are" | "to")
            || matches!(
                (next.tag, is_color(&next.words)),
                (Tag::Is(Sense::Weather(_)), true)
            );
        if !told {
            return None;
        }
        (0..self.mentions.len())
            .rev()
            .find(|&i| !self.mentions[i].gone && self.mentions[i].plural && !self.mentions[i].is_anchor)
    }

    /// "one on the left and the other on the right"
    pub(super) fn part(&mut self, all: bool, count: Count, span: Span) {
        if self.noun_ahead(self.at + 1) && !all {
            return; // "the other car", "another bus"
        }
        let whole = (0..self.mentions.len())
            .rev()
            .find(|&i| !self.mentions[i].gone && self.mentions[i].plural && !self.targets().contains(&i));
        let of_them = self.item(self.at + 1).is_some_and(|i| i.words.starts_with("of"))
            || self.items[self.at].words.ends_with("of them")
            || self.items[self.at].words.ends_with("of which");
        if let (Some(whole), true, true) = (whole, of_them, self.pending.is_some()) {
            // "between two of them", "next to one of them"
            self.anchor(Anchor::Object(whole), span);
            return;
        }
        // "two cars ahead and a third behind us" names one more
        let said = span.of(self.prompt).to_lowercase();
        let nth = [
            "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth",
        ]
        .iter()
        .position(|w| said.starts_with(&format!("a {w}")) || said.starts_with(&format!("an {w}")))
        .map(|k| k as u32 + 1);
        let last = (0..self.mentions.len())
            .rev()
            .find(|&i| !self.mentions[i].gone && !self.mentions[i].is_anchor);
        let more = last.is_some_and(|i| {
            let m = &self.mentions[i];
            // ("five vans, two of them white, ... a sixth")
            let rest = self.whole.filter(|w| Some(*w) != last && !self.mentions[*w].gone);
            let many = m.spec.count.n + rest.map_or(0, |w| self.mentions[w].spec.count.n);
            !self.edits
                && (nth == Some(m.spec.count.n) || nth == Some(many))
                && !m.spec.relations.is_empty()
                && many > 1
        });
        if more && self.pending.is_none() {
            if self
                .item(self.at + 1)
                .is_some_and(|i| matches!(i.words.as_str(), "one"))
            {
                self.at += 1;
            }
            self.again(Count::exactly(1), span);
            return;
        }
        // "ten cones, five on the left and five on the right": of the same ten
        let rest_of = |w: &usize| {
            let m = &self.mentions[*w];
            // (in an edit the group may be in the scene: its parts are told apart there)
            let there = self.edits && m.definite;
            !(all || there || m.gone)
                && (m.spec.relations.is_empty() || m.spec.count.n == count.n && !self.elsewhere(*w))
                && m.spec.count.is_exact()
                && m.spec.count.n >= count.n
        };
        let open_whole = self.whole.filter(rest_of);
        let whole = open_whole.or(self.whole.filter(|w| all && !self.mentions[*w].gone));
        let parent = whole.or_else(|| {
            (0..self.mentions.len()).rev().find(|&i| {
                !self.mentions[i].gone
                    && !self.mentions[i].is_anchor
                    && (self.mentions[i].plural || self.mentions[i].spec.count.n > 1)
            })
        });
        if matches!(
            self.item(self.at + 1).map(|i| i.words.as_str()),
            Some("one" | "ones")
        ) {
            self.at += 1; // "the first one"
        }
        // "three barriers ... A worker stands on the left, another one on the right": another worker
        let lone = self.head.first().or(self.before.first()).copied().filter(|s| {
            let m = &self.mentions[*s];
            said.starts_with("another")
                && self.whole.is_none()
                && m.spec.count.n == 1
                && !m.gone
                && !m.is_anchor
                && !m.definite
                && !m.spec.relations.is_empty()
        });
        let parent = parent.filter(|p| self.edits || lone.is_none_or(|s| s < *p));
        let Some(parent) = parent else {
            let single = self.last.first().or(self.before.first()).copied();
            if self.pending.is_none()
                && single.is_some_and(|i| !self.mentions[i].gone && !self.mentions[i].is_anchor)
                && (said.starts_with("another")
                    || said.starts_with("a ")
                    // "the nearest car is 10 m ahead, the next one 20 m ahead"
                    || !self.edits
                        && ["the next", "the last", "the second", "the third", "the fourth", "the other", "the farthest", "the furthest"]
                            .iter()
                            .any(|w| said.starts_with(w))
                        && single.is_some_and(|i| !self.mentions[i].spec.relations.is_empty()))
            {
                // "a car on the left and another on the right"
                let mut twin = self.mentions[single.unwrap_or(0)].clone();
                twin.spec.relations.clear();
                twin.spec.span = span;
                twin.spec.count = Count::exactly(1);
                twin.like = true;
                for frag in &self.fronted {
                    apply(&mut twin.spec, frag);
                }
                self.mentions.push(twin);
                let index = self.mentions.len() - 1;
                self.flush();
                self.head = vec![index];
                self.last = vec![index];
                self.chain = false;
                return;
            }
            return;
        };
        self.flush();
        let left = self.mentions[parent].spec.count;
        let of_them = self.item(self.at + 1).is_some_and(|i| i.words.starts_with("of"))
            || self.items[self.at].words.ends_with("of them")
            || self.items[self.at].words.ends_with("of which");
        let open = self.mentions[parent].uncounted || !left.is_exact();
        if of_them && open && (self.ends(self.at + 2) || !self.edits && count.n >= left.n && !all) {
            // "cones along the edge, six of them"
            self.mentions[parent].spec.count = count;
            self.mentions[parent].uncounted = false;
            return;
        }
        // "two buses ahead, one behind", "parked cars: 3 on the left, 2 on the right"
        let other = said.starts_with("the other") || said.starts_with("other");
        if !all
            && !of_them
            && !other
            && !self.edits
            && (self.enumerated.is_some() || open_whole.is_none() && self.elsewhere(parent))
        {
            self.again(count, span);
            return;
        }
        if !all
            && !of_them
            && !self.edits
            && (self.mentions[parent].uncounted && self.mentions[parent].bare
                || !left.is_exact() && count.n > 1)
            && (self.mentions[parent].spec.relations.is_empty() || self.after_mark())
        {
            // "People: two on the left, ...", "cars flank me: one on my left, ..." counts them one after another
            self.enumerated = Some(parent);
            self.again(count, span);
            self.mentions[parent].gone = true;
            return;
        }
        // "two are crossing, three are still waiting": the rest of the five
        let rest_of_group = self.whole == Some(parent) && count.n == left.n && left.is_exact();
        if !all
            && !of_them
            && !self.edits
            && !rest_of_group
            && count.n > 1
            && count.n >= left.n
            && !self.mentions[parent].spec.relations.is_empty()
        {
            // "two cars on the left and two on the right"
            self.again(count, span);
            return;
        }
        let n = if all { left.n } else { count.n.min(left.n) };
        let mut part = self.mentions[parent].clone();
        part.spec.count = if left.is_exact() || !all {
            Count::exactly(n)
        } else {
            left
        };
        part.plural = n > 1;
        part.spec.span = span;
        part.spec.attributes.retain(|a| a != "in total");
        self.mentions.push(part);
        let index = self.mentions.len() - 1;
        // "four cars, two of them red, are parked": what follows is said of all of them
        let aside = !self.edits
            && self.chain
            && self
                .item(self.at.wrapping_sub(1))
                .is_some_and(|b| b.tag == Tag::Comma)
            && self.head == [parent];
        self.aside = aside.then_some((parent, index));
        self.whole = Some(parent);
        let rest = left.n - n;
        let parent_spec = &mut self.mentions[parent].spec;
        parent_spec.count = Count {
            min: left.min.saturating_sub(n),
            n: rest,
            max: left.max.saturating_sub(n),
        };
        self.mentions[parent].gone = rest == 0;
        self.head = vec![index];
        self.last = vec![index];
        self.chain = false;
        self.pre = Pre::default();
    }

    /// After the comma that ends ", two of them red,": the subject goes on with its verb.
    pub(super) fn past_aside(&mut self) {
        let Some((whole, part)) = self
            .aside
            .filter(|a| self.last == [a.1] && self.mentions.len() == a.1 + 1)
        else {
            self.aside = None;
            return;
        };
        let verb = match self.item(self.at + 1).map(|n| n.tag) {
            Some(Tag::Is(Sense::State(_, true))) => true,
            Some(Tag::Is(Sense::Filler)) => self
                .item(self.at + 1)
                .is_some_and(|n| matches!(n.words.as_str(), "is" | "are" | "was" | "were" | "have" | "has")),
            Some(Tag::Is(Sense::Rel(_) | Sense::EgoRel(_))) => self.item(self.at + 1).is_some_and(|n| {
                super::super::words::verbs::RELATING
                    .iter()
                    .flat_map(|r| r.1.split('|'))
                    .any(|v| super::super::words::verbs::forms(v.trim()).base == n.words)
            }),
            _ => false,
        };
        if !verb {
            return;
        }
        self.aside = None;
        self.flush();
        self.head = [whole, part]
            .into_iter()
            .filter(|i| !self.mentions[*i].gone)
            .collect();
        self.last.clone_from(&self.head);
        self.list.clone_from(&self.head);
    }

    /// True if a colon or a dash stands right before.
    fn after_mark(&self) -> bool {
        self.item(self.at.wrapping_sub(1))
            .is_some_and(|b| b.tag == Tag::Mark && matches!(b.words.as_str(), ":" | "-" | "—" | "–" | "("))
    }

    /// A verb in the singular after those that something has speaks of what has them.
    pub(super) fn back_to_host(&mut self) {
        let Some(&i) = self.last.last() else {
            return;
        };
        let m = &self.mentions[i];
        let host = m.host.filter(|h| {
            // ("a bus with a cyclist on its right is waiting": the bus is)
            let beside = m.spec.relations.iter().any(|r| r.anchor == Anchor::Object(*h));
            (m.spec.count.n > 1 || beside) && self.mentions[*h].spec.count.n == 1
        });
        if let Some(host) = host {
            self.flush();
            self.head = vec![host];
            self.last = vec![host];
            self.fresh = true;
            self.chain = false;
        }
    }

    /// True if what comes next says another place than the group has: they are others.
    fn elsewhere(&self, group: usize) -> bool {
        use crate::scene::graph::{LaneRole as L, RelationKind as R};
        let own = &self.mentions[group].spec.relations;
        let opposite = |k: R| match k {
            R::LeftOf => Some(R::RightOf),
            R::RightOf => Some(R::LeftOf),
            R::InFrontOf => Some(R::Behind),
            R::Behind => Some(R::InFrontOf),
            _ => None,
        };
        let next = (self.at + 1..self.items.len().min(self.at + 6)).find_map(|i| match self.sense(i) {
            Some(Sense::EgoRel(kinds)) => Some(kinds.iter().any(|k| {
                opposite(*k).is_some_and(|o| own.iter().any(|r| r.anchor == Anchor::Ego && r.relation == o))
            })),
            Some(Sense::Place(Anchor::Lane(role), _)) => Some(own.iter().any(|r| match r.anchor {
                Anchor::Lane(L::Road | L::Roadside | L::Sidewalk) => false,
                Anchor::Lane(own) => matches!(r.relation, R::On | R::ParkedOn) && own != role,
                _ => false,
            })),
            _ => None,
        });
        next.unwrap_or(false)
    }

    pub(super) fn pronoun(&mut self, item: &Item) -> bool {
        if matches!(item.words.as_str(), "that" | "this" | "those" | "these")
            && (matches!(self.sense(self.at + 1), Some(Sense::Noun(..)))
                // "at this intersection"
                || matches!(item.words.as_str(), "this" | "these")
                    && !self.edits
                    && matches!(self.sense(self.at + 1), Some(Sense::Place(..) | Sense::RoadKind(..) | Sense::Environment(_))))
        {
            self.pre.article = Some(true); // "that car"
            self.pre.cover(item.span);
            return true;
        }
        if matches!(item.words.as_str(), "that") {
            self.relative = true;
            self.relates_to_front();
        }
        // "on her bike", "behind his van": whose it is, the noun says what
        let whose = matches!(item.words.as_str(), "his" | "her" | "their" | "its");
        if whose && !self.edits && self.noun_directly(self.at + 1) {
            return true;
        }
        if self.between_them(&item.words, item.span) {
            return false;
        }
        // "four children standing with her"
        let with = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|b| b.words == "with");
        let someone = matches!(item.words.as_str(), "him" | "her" | "them");
        if with && someone && self.pending.is_none() && !self.edits && !self.last.is_empty() {
            self.begin(Prep::Rels(vec![RelationKind::NextTo]), item.span);
        }
        if self.pending.is_some() {
            let targets = self.targets();
            let skip = |i: &usize| targets.contains(i) || self.mentions[*i].gone;
            let antecedent = match item.words.as_str() {
                "that" | "this" => None,
                // "it" is one thing.
                "it" if self.ego_named => {
                    let kin = |i: &usize| {
                        targets
                            .iter()
                            .any(|t| self.mentions[*t].spec.noun == self.mentions[*i].spec.noun)
                    };
                    let one = |i: &usize| !skip(i) && !kin(i) && self.mentions[*i].spec.count.n == 1;
                    let subject = self.head.iter().chain(&self.before).copied().find(one);
                    subject.or_else(|| (0..self.mentions.len()).rev().find(one))
                }
                _ => {
                    // "it" is no person.
                    let person = |i: &usize| self.mentions[*i].spec.class == Class::Pedestrian;
                    let thing = (0..self.mentions.len()).any(|i| !skip(&i) && !person(&i));
                    let skip = |i: &usize| skip(i) || thing && item.words == "it" && person(i);
                    let host = targets.first().and_then(|t| self.mentions[*t].host);
                    let subject = self.head.iter().chain(&self.before).copied().find(|i| !skip(i));
                    host.or(subject)
                        .or_else(|| (0..self.mentions.len()).rev().find(|i| !skip(i)))
                }
            };
            let fresh = self.pending.as_ref().is_some_and(|p| p.fresh);
            let anded = self.pending.as_ref().is_some_and(|p| p.anded);
            let antecedent = if fresh && (self.noun_ahead(self.at + 1) || (anded && self.set_off())) {
                self.head.first().or(self.before.first()).copied().or(antecedent)
            } else {
                antecedent
            };
            // "left of me a car, right of it a van": of the same
            let of_front = self
                .front
                .filter(|f| {
                    fresh && self.noun_ahead(self.at + 1) && matches!(f, Anchor::Ego | Anchor::Object(_))
                })
                .filter(|_| {
                    self.pending.as_ref().is_some_and(|p| match &p.prep {
                        Prep::Rels(kinds) => {
                            kinds.contains(&RelationKind::LeftOf) || kinds.contains(&RelationKind::RightOf)
                        }
                        _ => false,
                    })
                });
            let placed_in = self
                .pending
                .as_ref()
                .is_some_and(|p| {
                    // "stands in the oncoming lane and obstructs it"
                    matches!(p.prep, Prep::In) || p.prep == Prep::Rels(vec![RelationKind::Blocking])
                })
                .then_some(self.last_place)
                .flatten();
            // (one stands on a crossing or in a car park, not on a thing)
            let holds = matches!(
                placed_in,
                Some(Anchor::Crossing | Anchor::Junction | Anchor::Lane(_))
            );
            // "five to the left of my car and five to the right of it": no group is "it"
            let ego_it = item.words == "it"
                && !holds
                && !self.edits
                && self
                    .mentions
                    .iter()
                    .all(|m| m.gone || m.spec.count.n > 1 || m.spec.class == Class::Pedestrian)
                && self
                    .mentions
                    .iter()
                    .any(|m| m.spec.relations.iter().any(|r| r.anchor == Anchor::Ego));
            let antecedent = antecedent.filter(|_| !(self.ego_topic && item.words == "it"));
            if antecedent.is_none() && item.words == "it" && (self.ego_named || ego_it) {
                self.ego_topic = true;
            }
            match antecedent {
                _ if self.ego_topic && item.words == "it" => self.anchor(Anchor::Ego, item.span),
                _ if ego_it => self.anchor(Anchor::Ego, item.span),
                _ if of_front.is_some() => self.anchor(of_front.unwrap_or(Anchor::Ego), item.span),
                _ if placed_in.is_some() && item.words == "it" && (holds || self.fronted.is_empty()) => {
                    self.anchor(placed_in.unwrap_or(Anchor::Ego), item.span);
                }
                Some(i) => self.anchor(Anchor::Object(i), item.span),
                None if item.words == "that" => return true,
                // "a zebra crossing is 20 m ahead; a car waits at it"
                None if item.words == "it"
                    && matches!(self.last_place, Some(Anchor::Crossing | Anchor::Junction))
                    && self.pending.as_ref().is_some_and(|p| p.prep == Prep::At) =>
                {
                    self.anchor(self.last_place.unwrap_or(Anchor::Crossing), item.span);
                }
                None if self.ego_named || self.ego_subject => self.anchor(Anchor::Ego, item.span),
                None if self.fronted.iter().any(|f| f.anchor == Anchor::Ego) => {
                    self.anchor(Anchor::Ego, item.span)
                }
                // "the left lane has two cars in it"
                None if !self.fronted.is_empty()
                    && self
                        .pending
                        .as_ref()
                        .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At)) =>
                {
                    self.pending = None;
                }
                None => {
                    let span = self.pending.take().map_or(item.span, |p| p.span.to(item.span));
                    self.unread(span, Some("what it points to was not named".into()));
                }
            }
            return false;
        }
        if self.head.is_empty()
            && matches!(
                item.words.as_str(),
                "it" | "they" | "he" | "she" | "these" | "those"
            )
        {
            self.head = self.before.clone();
            self.last = self.before.clone();
            self.chain = false;
        }
        true
    }
}
