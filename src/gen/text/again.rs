//! What a sentence leaves out because it was said before: "and two on the right", "six of them", "people on bikes",
//! "roadworks on the right: a digger and three men".

use super::description::Count;
use super::lexicon::Sense;
use super::mention::{Mention, Pre, Prep, apply};
use super::parse::Parser;
use super::tag::Tag;
use super::tokens::Span;
use super::words::edits::Pick;
use super::words::objects::Noun;
use crate::scene::Class;
use crate::scene::graph::ObjectState;

impl Parser<'_> {
    /// True if the clause ends before item `i`.
    pub(super) fn ends(&self, i: usize) -> bool {
        self.item(i)
            .is_none_or(|n| matches!(n.tag, Tag::Stop | Tag::Comma | Tag::Mark))
    }

    /// True if item `i` is a number that ends its clause.
    pub(super) fn bare_number(&self, i: usize) -> bool {
        let number = self
            .item(i)
            .is_some_and(|n| matches!(n.tag, Tag::Number(_) | Tag::Is(Sense::Count(_))));
        number && self.ends(i + 1) && self.mentions.iter().any(|m| !m.gone && !m.is_anchor)
    }

    /// "a motorbike and, behind it, a truck": true if a comma and a new noun phrase follow.
    pub(super) fn set_off(&self) -> bool {
        // "beyond them, 35 metres from me, a digger"
        let mut i = self.at + 1;
        let number = |n: &super::tag::Item| matches!(n.tag, Tag::Number(_) | Tag::Is(Sense::Count(_)));
        if self.item(i + 1).is_some_and(number) && matches!(self.sense(i + 2), Some(Sense::Unit(_))) {
            let end = (i + 3..i + 7).find(|k| self.item(*k).is_some_and(|n| n.tag == Tag::Comma));
            i = end.unwrap_or(i);
        }
        self.item(i).is_some_and(|n| n.tag == Tag::Comma)
            && matches!(
                self.item(i + 1).map(|n| n.tag),
                Some(Tag::Is(Sense::Article(false) | Sense::Count(_)) | Tag::Number(_))
            )
            && self.noun_ahead(i + 1)
    }

    /// True if "and" and a comma stand right before.
    pub(super) fn after_and(&self) -> bool {
        let word = |k: usize| self.at.checked_sub(k).and_then(|i| self.item(i));
        word(1).is_some_and(|n| n.tag == Tag::Comma) && word(2).is_some_and(|n| n.tag == Tag::Is(Sense::And))
    }

    /// "cones block the lane, four in total": the number of what was named last. True if it was that.
    pub(super) fn numbers_last(&mut self, count: Count, span: Span) -> bool {
        let mut end = self.at + 1;
        let mut total = false;
        while let Some(n) = self.item(end)
            && matches!(
                n.words.as_str(),
                "in total" | "total" | "altogether" | "in all" | "all told" | "of them"
            )
        {
            total = true;
            end += 1;
        }
        let lead = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|n| matches!(n.tag, Tag::Comma | Tag::Mark) || n.words == "of");
        if !self.ends(end) || !(total || lead) || !self.fronted.is_empty() {
            return false;
        }
        let last = (0..self.mentions.len())
            .rev()
            .find(|&i| !self.mentions[i].gone && !self.mentions[i].is_anchor);
        let Some(m) = last.map(|i| &mut self.mentions[i]) else {
            return false;
        };
        let many = m.plural || m.spec.count.n > 1;
        // ("a line of taxis, eight of them": how many was not said)
        if !many || !m.uncounted && m.spec.count.is_exact() {
            return false;
        }
        m.spec.count = count;
        m.spec.span = m.spec.span.to(span);
        m.uncounted = false;
        self.pre = Pre::default();
        self.at = end - 1;
        true
    }

    /// True if the noun right here is said "in total".
    pub(super) fn in_total(&self) -> bool {
        let total = |k: usize| {
            self.item(k).is_some_and(|n| {
                matches!(
                    n.words.as_str(),
                    "in total"
                        | "total"
                        | "altogether"
                        | "in all"
                        | "all told"
                        | "overall"
                        | "all in all"
                        | "all together"
                        | "in sum"
                        | "making"
                        | "that makes"
                        | "makes"
                        | "together"
                        | "sum"
                )
            })
        };
        total(self.at + 1) || (1..=4).any(|k| self.at >= k && total(self.at - k))
    }

    /// "4 cars, 2 motorbikes and a bus, 7 vehicles altogether": the sum of what was named. True if it was that.
    pub(super) fn restates(&mut self, noun: &'static Noun, pre: &Pre) -> bool {
        let Some(n) = pre.count.filter(|c| c.is_exact()).map(|c| c.n) else {
            return false;
        };
        let sum: u32 = self
            .mentions
            .iter()
            .filter(|m| !m.gone && noun.classes.contains(&m.spec.class))
            .map(|m| m.spec.count.n)
            .sum();
        let same = sum == n && n > 0;
        if same
            && self
                .item(self.at + 1)
                .is_some_and(|i| i.words.contains("total") || i.words.contains("all"))
        {
            self.at += 1;
        }
        same
    }

    /// "a roadblock of five barriers": only what it is made of is counted. True if it was that.
    pub(super) fn holds_others(&mut self, noun: &'static Noun, pre: &Pre) -> bool {
        let of = self.item(self.at + 1).is_some_and(|n| n.words == "of");
        let counted = matches!(
            self.item(self.at + 2).map(|n| n.tag),
            Some(Tag::Number(_) | Tag::Is(Sense::Count(_)))
        );
        let same = self.items[self.at..]
            .iter()
            .skip(3)
            .take(3)
            .find_map(|n| match n.tag {
                Tag::Is(Sense::Noun(other, _)) => Some(other.classes[0] == noun.classes[0]),
                _ => None,
            });
        of && counted
            && pre.count.is_none_or(|c| c.n == 1)
            && same == Some(true)
            && self.noun_ahead(self.at + 2)
    }

    /// As many more of what was named last, elsewhere.
    pub(super) fn again(&mut self, count: Count, span: Span) {
        let last = (0..self.mentions.len())
            .rev()
            .find(|&i| !self.mentions[i].gone && !self.mentions[i].is_anchor);
        let Some(last) = last else {
            return;
        };
        self.flush();
        let mut twin = self.mentions[last].clone();
        twin.spec.relations.clear();
        // what was said of a group that is counted one by one holds for each
        if let Some(group) = self.enumerated {
            let theirs = self.mentions[group].spec.relations.iter();
            twin.spec.relations = theirs.filter(|r| r.distance_m.is_none()).copied().collect();
        }
        twin.spec.attributes.retain(|a| a != "in total");
        twin.spec.count = count;
        twin.spec.span = span;
        twin.plural = count.n > 1;
        twin.uncounted = false;
        for frag in &self.fronted {
            apply(&mut twin.spec, frag);
        }
        self.mentions.push(twin);
        let index = self.mentions.len() - 1;
        self.head = vec![index];
        self.last = vec![index];
        self.chain = false;
        self.pre = Pre::default();
    }

    /// "a man on a bike", "two people riding scooters": one thing, what they ride. True if it was that.
    pub(super) fn rides(&mut self, noun: &'static Noun, word: &str, pre: &Pre) -> bool {
        if !matches!(noun.classes[0], Class::Bicycle | Class::Motorcycle) || pre.article == Some(true) {
            return false;
        }
        let mut before = self.at;
        let describes = |k: usize| {
            matches!(
                self.sense(k),
                Some(
                    Sense::Article(_)
                        | Sense::Pronoun
                        | Sense::Attribute(_)
                        | Sense::Color(_)
                        | Sense::Size(_)
                )
            ) || self
                .item(k)
                .is_some_and(|i| matches!(i.words.as_str(), "his" | "their" | "her" | "its"))
        };
        while before > 0 && describes(before - 1) {
            before -= 1;
        }
        let lead = before
            .checked_sub(1)
            .and_then(|i| self.item(i))
            .map_or("", |i| i.words.as_str());
        let riding = matches!(lead, "riding" | "rides" | "ride" | "is riding" | "are riding");
        let on = matches!(lead, "on")
            && self
                .pending
                .as_ref()
                .is_some_and(|p| p.prep == Prep::In && !p.not);
        let people: Vec<usize> = self.last.clone();
        let of_class = |class: Class| {
            !people.is_empty()
                && people
                    .iter()
                    .all(|i| self.mentions[*i].spec.class == class && !self.mentions[*i].is_anchor)
        };
        // "two bikers on their motorcycles" are named already
        let named = of_class(noun.classes[0]) && before < self.at;
        if !((of_class(Class::Pedestrian) || named) && (riding || on)) {
            return false;
        }
        self.pending = None;
        for i in people {
            let m: &mut Mention = &mut self.mentions[i];
            m.classes = noun.classes;
            m.spec.class = noun.classes[0];
            m.spec.noun = word.to_string();
            m.spec.size_m = noun.size_m;
            m.spec.state = m.spec.state.or(Some(ObjectState::Moving));
        }
        true
    }

    /// "seven vehicles, all cars": says which. True if it was that.
    pub(super) fn says_which(&mut self, noun: &'static Noun, word: &str, plural: bool, pre: &Pre) -> bool {
        if !plural
            || pre.pick != Some(Pick::All)
            || pre.count.is_some()
            || self.edits
            || self.pending.is_some()
        {
            return false;
        }
        let Some(&last) = self.last.last().or(self.head.last()).or(self.before.last()) else {
            return false;
        };
        let m = &mut self.mentions[last];
        if m.classes.len() < 3 || !m.classes.contains(&noun.classes[0]) || noun.classes.len() > 1 {
            return false;
        }
        m.classes = noun.classes;
        m.spec.class = noun.classes[0];
        m.spec.noun = word.to_string();
        m.spec.size_m = noun.size_m;
        true
    }

    /// Where "both" points: to two that were named right before, or to a group of two. True if it was that.
    pub(super) fn both_of_them(&mut self) -> bool {
        if self.edits || self.pending.is_some() || self.noun_ahead(self.at + 1) {
            return false;
        }
        let there: Vec<usize> = (0..self.mentions.len())
            .rev()
            .filter(|i| !self.mentions[*i].gone)
            .take(2)
            .collect();
        let both = match there.as_slice() {
            [a, ..] if self.mentions[*a].spec.count.n == 2 => vec![*a],
            [a, b] if self.mentions[*a].spec.count.n == 1 && self.mentions[*b].spec.count.n == 1 => {
                vec![*b, *a]
            }
            _ => return false,
        };
        if self
            .item(self.at + 1)
            .is_some_and(|n| matches!(n.words.as_str(), "of them" | "of which" | "of whom"))
        {
            self.at += 1;
        }
        // "a van and a bus; both come towards us": the subject of the new clause
        if self.head.is_empty() && self.fronted.is_empty() {
            self.head.clone_from(&both);
        } else {
            self.relative = true;
        }
        self.last = both;
        self.fresh = false;
        self.chain = false;
        true
    }

    /// "and all three come towards us": those named last, if they are so many. True if it was that.
    pub(super) fn all_of_them(&mut self, count: Count) -> bool {
        if self.edits
            || self.pending.is_some()
            || self.pre.pick != Some(Pick::All)
            || self.noun_ahead(self.at + 1)
        {
            return false;
        }
        let mut sum = 0;
        let mut found = Vec::new();
        for i in (0..self.mentions.len()).rev().filter(|i| !self.mentions[*i].gone) {
            sum += self.mentions[i].spec.count.n;
            found.push(i);
            if sum >= count.n {
                break;
            }
        }
        if sum != count.n || !count.is_exact() {
            return false;
        }
        if self
            .item(self.at + 1)
            .is_some_and(|n| matches!(n.words.as_str(), "of them" | "of which" | "of whom"))
        {
            self.at += 1;
        }
        found.reverse();
        self.flush();
        self.pre = Pre::default();
        self.last.clone_from(&found);
        self.head = found;
        self.fresh = false;
        self.chain = false;
        true
    }

    /// "the lead vehicle is a Tesla", "Vehicle 1: bus": says what was named before. True if it was that.
    pub(super) fn is_that(&mut self, noun: &'static Noun, word: &str, pre: &Pre) -> bool {
        if self.edits
            || self.pending.is_some()
            || !self.fronted.is_empty()
            || pre.count.is_some_and(|c| c.n > 1)
        {
            return false;
        }
        let mut before = self.at;
        while before > 0
            && matches!(
                self.sense(before - 1),
                Some(
                    Sense::Article(false)
                        | Sense::Color(_)
                        | Sense::Size(_)
                        | Sense::Attribute(_)
                        | Sense::State(_, false)
                        | Sense::Noun(_, false)
                )
            )
            || before > 1
                && self
                    .item(before - 1)
                    .is_some_and(|b| super::parse::is_prenominal(&b.words))
        {
            before -= 1;
        }
        let lead = before
            .checked_sub(1)
            .and_then(|i| self.item(i))
            .map_or("", |i| i.words.as_str());
        let article = pre.article == Some(false);
        // "the pedestrian, an adult male, stood there"
        let set_apart = lead == ","
            && article
            && self.item(self.at + 1).is_some_and(|n| n.tag == Tag::Comma)
            && matches!(
                before.checked_sub(2).and_then(|i| self.item(i)).map(|i| i.tag),
                Some(Tag::Is(Sense::Noun(..)) | Tag::Number(_))
            );
        if let Some(&i) = self.head.last().filter(|_| set_apart)
            && self.described_as(i, noun, word)
        {
            return true;
        }
        // "three of them are trucks"
        let sorted = matches!(lead, "are" | "were" | "being" | "of them")
            && pre.count.is_none()
            && pre.article.is_none();
        let is = matches!(
            lead,
            "is" | "are"
                | "was"
                | "being"
                | "which is"
                | "that is"
                | "of them"
                | "of which"
                | "one of them"
                | "one of which"
        ) && article
            || lead == ":"
            || sorted;
        let Some(&i) = self.head.last().or(self.last.last()).filter(|_| is) else {
            return false;
        };
        let m = &mut self.mentions[i];
        // "the only soul to be seen is a cyclist"
        let rides = matches!(noun.classes[0], Class::Bicycle | Class::Motorcycle)
            && matches!(word.rsplit(' ').next(), Some(w) if w.ends_with("ist") || w.ends_with("rider") || w.ends_with("biker"));
        if is_to_be(lead) && rides && m.spec.class == Class::Pedestrian && m.spec.count.n == 1 {
            m.mounts(noun.classes[0]);
            m.spec.noun = word.to_string();
            return true;
        }
        // "The first one is a van. The second one is a bus."
        let told = m.like && m.spec.class.is_vehicle() && noun.classes[0].is_vehicle();
        if told && noun.classes.len() == 1 && is_to_be(lead) && article {
            m.classes = noun.classes;
            m.spec.class = noun.classes[0];
            m.spec.noun = word.to_string();
            m.spec.size_m = noun.size_m;
            m.like = false;
            return true;
        }
        if noun.classes.len() > 1 || !m.classes.contains(&noun.classes[0]) {
            return false;
        }
        if m.classes.len() > 1 && (m.spec.count.n == 1 || sorted) && m.classes.len() < 10 {
            m.classes = noun.classes;
            m.spec.class = noun.classes[0];
            m.spec.noun = word.to_string();
            m.spec.size_m = noun.size_m;
            return true;
        }
        // "the nearest one being a Golf"
        m.classes.len() == 1 && lead != ":"
    }

    /// "in front of the car", where no car was named: the ego vehicle.
    pub(super) fn is_ego_car(&self, index: usize) -> bool {
        let m = &self.mentions[index];
        let plain = m.definite
            && !m.plural
            && m.uncounted
            && m.spec.state.is_none()
            && m.spec.color.is_none()
            && m.spec.attributes.is_empty();
        let other = self.mentions[..index]
            .iter()
            .any(|o| o.classes.iter().any(|c| m.classes.contains(c)));
        plain
            && !other
            && !self.edits
            && matches!(m.spec.noun.as_str(), "car" | "vehicle" | "automobile" | "motor")
    }

    /// "a car in front, one behind": true if a number without a noun means one more of what was named last.
    pub(super) fn one_more_like_it(&self) -> bool {
        let told = matches!(
            self.sense(self.at + 1),
            Some(
                Sense::Rel(_)
                    | Sense::EgoRel(_)
                    | Sense::In
                    | Sense::At
                    | Sense::FarSide
                    | Sense::State(_, false)
            )
        );
        let last = (0..self.mentions.len())
            .rev()
            .find(|&i| !self.mentions[i].gone && !self.mentions[i].is_anchor);
        told && self.group_behind().is_none()
            && last.is_some_and(|i| !self.mentions[i].spec.relations.is_empty())
    }
}

fn is_to_be(word: &str) -> bool {
    matches!(word, "is" | "was" | "being" | "which is" | "that is")
}
