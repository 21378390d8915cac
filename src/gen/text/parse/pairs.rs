//! Several that were named one by one, taken together: "between the two of them", "the two machines", "both cars".

use super::super::description::Anchor;
use super::super::lexicon::Sense;
use super::super::mention::Prep;
use super::super::tokens::Span;
use super::super::words::objects::Noun;
use super::Parser;
use crate::scene::graph::RelationKind;

impl Parser<'_> {
    /// The mentions named last that are so many together, in the order in which they were named; of one kind, if `noun` is given.
    fn together(&self, many: u32, noun: Option<&'static Noun>) -> Option<Vec<usize>> {
        let own = self.targets();
        // a clause that begins with them has no subject of its own yet
        let skip =
            |i: &usize| own.contains(i) && !self.fresh && self.pending.as_ref().is_some_and(|p| !p.fresh);
        let mut sum = 0;
        let mut found = Vec::new();
        for i in (0..self.mentions.len()).rev() {
            let m = &self.mentions[i];
            let fits =
                noun.is_none_or(|n| n.classes.contains(&m.spec.class) && m.classes.len() <= n.classes.len());
            if m.gone || skip(&i) || !fits {
                continue;
            }
            sum += m.spec.count.n;
            found.push(i);
            if sum >= many {
                break;
            }
        }
        found.reverse();
        (sum == many).then_some(found)
    }

    /// Ends the open relation in several, or makes them the subject.
    fn take_together(&mut self, group: &[usize], span: Span) {
        let between = self
            .pending
            .as_ref()
            .is_some_and(|p| p.first.is_none() && p.prep == Prep::Rels(vec![RelationKind::Between]));
        match group {
            [a, b] if between => {
                self.anchor(Anchor::Object(*a), span);
                self.anchor(Anchor::Object(*b), span);
            }
            [.., last] if self.pending.is_some() => self.anchor(Anchor::Object(*last), span),
            _ => {
                self.flush();
                self.head = group.to_vec();
                self.last = group.to_vec();
                self.chain = false;
            }
        }
        self.pre = super::Pre::default();
    }

    /// "the two machines", "both cars", "these three vehicles": those that were named one by one. True if it was that.
    pub(super) fn named_together(&mut self, noun: &'static Noun, plural: bool, span: Span) -> bool {
        let between = self
            .pending
            .as_ref()
            .is_some_and(|p| p.first.is_none() && p.prep == Prep::Rels(vec![RelationKind::Between]));
        let fits = |m: &super::super::mention::Mention| {
            !m.gone && noun.classes.contains(&m.spec.class) && m.classes.len() <= noun.classes.len()
        };
        // "between the machines": the two that were named one by one
        let two = between
            && self.pre.count.is_none()
            && self.pre.article == Some(true)
            && self.mentions.iter().filter(|m| fits(m)).count() == 2
            && self.mentions.iter().all(|m| !fits(m) || m.spec.count.n == 1);
        let Some(many) = self
            .pre
            .count
            .filter(|c| c.is_exact() && c.n > 1)
            .map(|c| c.n)
            .or(two.then_some(2))
        else {
            return false;
        };
        let pointed = self.pre.article == Some(true)
            || (1..=3).any(|k| {
                let word = self.at.checked_sub(k).and_then(|i| self.item(i));
                word.is_some_and(|w| matches!(w.words.as_str(), "both" | "these" | "those" | "all"))
            });
        let plain = self.pre.state.is_none() && self.pre.color.is_none() && self.pre.attributes.is_empty();
        if self.edits || !plural || !pointed || !plain || self.pre.not {
            return false;
        }
        match self.together(many, Some(noun)) {
            Some(group) if group.len() > 1 => {
                self.take_together(&group, span);
                true
            }
            _ => false,
        }
    }

    /// "between the two stands a child", "between them": without a noun. True if it was that.
    pub(super) fn between_them(&mut self, words: &str, span: Span) -> bool {
        let between = self
            .pending
            .as_ref()
            .is_some_and(|p| p.first.is_none() && p.prep == Prep::Rels(vec![RelationKind::Between]));
        let two = matches!(
            words,
            "them"
                | "the two of them"
                | "them both"
                | "the pair of them"
                | "those two"
                | "these"
                | "those"
                | "both"
                | "two"
        );
        if self.edits || !between || !two {
            return false;
        }
        // "between them" may be between those of a larger group
        let Some(group) = self.together(2, None) else {
            return false;
        };
        match group.as_slice() {
            [one] => {
                self.anchor(Anchor::Object(*one), span);
                self.pre = super::Pre::default();
            }
            _ => self.take_together(&group, span),
        }
        true
    }

    /// "between the two": true if no noun follows and it was that.
    pub(super) fn the_two(&mut self, count: u32, span: Span) -> bool {
        let of = self
            .item(self.at + 1)
            .is_some_and(|n| n.words.starts_with("of them") || n.words == "of");
        // "between the two a child stands"
        let another = self
            .item(self.at + 1)
            .is_some_and(|n| matches!(n.words.as_str(), "a" | "an" | "another"));
        if count != 2 || self.noun_ahead(self.at + 1) && !self.finite_next() && !another || of {
            return false;
        }
        self.between_them("two", span)
    }

    /// ", all in our lane": of all that the sentence named so far. True if it was that.
    pub(super) fn all_named(&mut self) -> bool {
        use super::super::tag::Tag;
        let before = self.at.checked_sub(1).and_then(|i| self.item(i)).map(|b| b.tag);
        let apart = matches!(before, Some(Tag::Comma | Tag::Mark | Tag::Is(Sense::And)));
        // "A bus and two cars. All of them come towards us."
        let stop = before == Some(Tag::Stop);
        let mut next = self.at + 1;
        let mut pointed = false;
        while let Some(n) = self.item(next)
            && matches!(
                n.words.as_str(),
                "of them"
                    | "of which"
                    | "of whom"
                    | "are"
                    | "is"
                    | "them"
                    | "these"
                    | "those"
                    | "which"
                    | "whom"
            )
        {
            pointed |= !matches!(n.words.as_str(), "are" | "is");
            next += 1;
        }
        let placed = matches!(
            self.sense(next),
            Some(Sense::In | Sense::At | Sense::Rel(_) | Sense::EgoRel(_) | Sense::State(_, false))
        ) || pointed && matches!(self.sense(next), Some(Sense::State(_, true)));
        let from = if stop { self.sentence_before } else { self.sentence };
        let all: Vec<usize> = (from..self.mentions.len())
            .filter(|i| !self.mentions[*i].gone && !self.mentions[*i].is_anchor)
            .collect();
        if self.edits || !(apart || stop && pointed) || !placed || self.pending.is_some() || all.len() < 2 {
            return false;
        }
        self.last = all;
        self.relative = true;
        self.fresh = false;
        self.chain = false;
        true
    }

    /// "Three cars. All of them are oncoming": those that the sentence before was about. True if it was that.
    pub(super) fn all_again(&mut self) -> bool {
        let of = self
            .item(self.at + 1)
            .is_some_and(|n| matches!(n.words.as_str(), "of them" | "of these" | "of those" | "them" | "these" | "those" | "are" | "were"))
            // "A bus and a van. All oncoming."
            || self.ends(self.at.wrapping_sub(1))
                && matches!(
                    self.sense(self.at + 1),
                    Some(Sense::EgoRel(_) | Sense::Rel(_) | Sense::State(_, false) | Sense::In | Sense::At)
                );
        let open = self.head.is_empty() && self.fronted.is_empty() && self.pending.is_none();
        let there = |i: &usize| !self.mentions[*i].gone && !self.mentions[*i].is_anchor;
        let before: Vec<usize> = if self.before.iter().any(there) {
            self.before.iter().copied().filter(there).collect()
        } else {
            (0..self.mentions.len()).rev().find(there).into_iter().collect()
        };
        let many = before.iter().map(|i| self.mentions[*i].spec.count.n).sum::<u32>() > 1;
        if self.edits || !of || !open || !many || self.noun_ahead(self.at + 2) {
            return false;
        }
        self.at += usize::from(
            self.item(self.at + 1)
                .is_some_and(|n| n.words.starts_with("of") || n.words.starts_with("th")),
        );
        self.last.clone_from(&before);
        self.head = before;
        self.fresh = false;
        self.chain = false;
        true
    }

    /// "we are wedged between two trucks": one ahead, one behind, unless the parts are told one by one. True if it was that.
    pub(super) fn ego_between(&mut self, first: Anchor, second: Option<Anchor>, span: Span) -> bool {
        let (Anchor::Object(a), Some(Anchor::Object(b))) = (first, second) else {
            return false;
        };
        let place = |m: &mut super::super::mention::Mention, kind: RelationKind| {
            m.is_anchor = false;
            let told = m.spec.relations.iter().any(|r| {
                r.anchor == Anchor::Ego
                    && matches!(r.relation, RelationKind::InFrontOf | RelationKind::Behind)
            });
            if !told {
                m.spec.relations.push(super::super::description::Stated {
                    relation: kind,
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: None,
                    span,
                });
            }
        };
        if a != b {
            place(&mut self.mentions[a], RelationKind::InFrontOf);
            place(&mut self.mentions[b], RelationKind::Behind);
            self.head = vec![a, b];
        } else {
            // "..., one in front of us and one behind us" follows
            let parts = self.items[self.at + 1..]
                .iter()
                .take_while(|n| n.tag != super::super::tag::Tag::Stop)
                .any(|n| matches!(n.words.as_str(), "one" | "the first" | "the other"));
            self.mentions[a].is_anchor = false;
            if !parts && self.mentions[a].spec.count.n == 2 {
                let one = super::super::description::Count::exactly(1);
                self.mentions[a].spec.count = one;
                let mut twin = self.mentions[a].clone();
                place(&mut self.mentions[a], RelationKind::InFrontOf);
                place(&mut twin, RelationKind::Behind);
                self.mentions.push(twin);
                self.head = vec![a, self.mentions.len() - 1];
            } else {
                self.head = vec![a];
            }
        }
        self.last = self.head.clone();
        self.list = self.head.clone();
        self.chain = false;
        true
    }

    /// "we are following a third one": one more of what was named last. True if it was that.
    pub(super) fn ego_has_another(&mut self, item: &super::super::tag::Item) -> bool {
        let ego = self.pending.as_ref().is_some_and(|p| p.ego);
        let more = item.words.starts_with("a ") || item.words.starts_with("another");
        let last = (0..self.mentions.len()).rev().find(|i| !self.mentions[*i].gone);
        let Some(last) = last.filter(|_| ego && more && !self.edits) else {
            return false;
        };
        let mut twin = self.mentions[last].clone();
        twin.spec.relations.clear();
        twin.spec.count = super::super::description::Count::exactly(1);
        twin.spec.span = item.span;
        self.mentions.push(twin);
        self.anchor(Anchor::Object(self.mentions.len() - 1), item.span);
        true
    }

    fn finite_next(&self) -> bool {
        matches!(self.sense(self.at + 1), Some(Sense::State(_, true)))
            || self
                .item(self.at + 1)
                .is_some_and(|n| matches!(n.words.as_str(), "is" | "are" | "there is" | "there are"))
    }
}
