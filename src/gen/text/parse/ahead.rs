//! What comes next in the sentence: a noun phrase, an anchor, the rest of a list.

use super::super::lexicon::Sense;
use super::super::tag::{Item, Tag};
use super::super::words::places;
use super::{Parser, is_color, is_prenominal};

impl Parser<'_> {
    /// True if a noun phrase begins at item `i`.
    pub(in super::super) fn noun_ahead(&self, i: usize) -> bool {
        for j in i..(i + 10).min(self.items.len()) {
            let item = &self.items[j];
            match item.tag {
                Tag::Is(Sense::Noun(..) | Sense::Works) => return true,
                Tag::Is(
                    Sense::Article(_)
                    | Sense::Count(_)
                    | Sense::State(_, false)
                    | Sense::Size(_)
                    | Sense::Color(_)
                    | Sense::Attribute(_)
                    | Sense::Pick(_)
                    | Sense::Part(_)
                    | Sense::Not,
                ) => {}
                Tag::Is(Sense::Weather(_) | Sense::Time(_)) if is_color(&item.words) => {}
                Tag::Is(Sense::EgoRel(_)) if is_prenominal(&item.words) => {}
                // "in the car park stand two cars"
                Tag::Is(Sense::State(_, true)) if j == i => {}
                Tag::Is(Sense::Filler)
                    if matches!(
                        item.words.as_str(),
                        "of" | "about"
                            | "exactly"
                            | "only"
                            | "just"
                            | "other"
                            | "there is"
                            | "theres"
                            | "there"
                            | "there are"
                            | "is"
                            | "are"
                            | "my"
                            | "another"
                            | "have"
                            | "has"
                            | "we have"
                            | "i have"
                    ) => {}
                Tag::Number(_) if !matches!(self.sense(j + 1), Some(Sense::Unit(_))) => {}
                Tag::Unknown => {}
                _ => return false,
            }
        }
        false
    }

    /// Past "too" and the like.
    pub(super) fn past_too(&self, i: usize) -> usize {
        let too = self
            .item(i)
            .is_some_and(|n| matches!(n.words.as_str(), "too" | "also" | "as well" | "now" | "already"));
        i + usize::from(too)
    }

    /// True if something that a relation can end in begins at item `i`.
    pub(super) fn anchor_ahead(&self, i: usize) -> bool {
        let mut j = i;
        while matches!(
            self.sense(j),
            Some(Sense::Article(_) | Sense::Filler | Sense::Size(_) | Sense::Attribute(_))
        ) {
            j += 1;
        }
        matches!(
            self.sense(j),
            Some(Sense::Ego | Sense::Pronoun | Sense::Place(..) | Sense::Part(_))
        ) || self.noun_ahead(j)
    }

    /// True if a place, the ego vehicle or something that points back begins at item `i`.
    pub(super) fn place_ahead(&self, i: usize) -> bool {
        let mut j = i;
        while matches!(
            self.sense(j),
            Some(
                Sense::Article(_) | Sense::Filler | Sense::Size(_) | Sense::Attribute(_) | Sense::Density(_)
            )
        ) {
            j += 1;
        }
        matches!(
            self.sense(j),
            Some(Sense::Place(..) | Sense::RoadKind(..) | Sense::Pronoun | Sense::Part(_) | Sense::Width(_))
        )
    }

    /// True if a preposition or a participle takes nothing: "drives past", "the lane is blocked".
    pub(super) fn stands_alone(&self, item: &Item) -> bool {
        let adverb = matches!(
            item.words.as_str(),
            "past"
                | "after"
                | "before"
                | "beyond"
                | "around"
                | "round"
                | "near"
                | "face"
                | "watch"
                | "mark"
                | "ring"
        );
        let participle = item.words.split(' ').next().is_some_and(|w| w.ends_with("ed"));
        (adverb || participle) && !self.anchor_ahead(self.at + 1)
            || participle && !item.words.contains(' ') && self.after_is()
    }

    pub(super) fn after_is(&self) -> bool {
        let before = self.item(self.at.wrapping_sub(1)).map(|i| i.words.as_str());
        matches!(
            before,
            Some("it is" | "is" | "are" | "was" | "were" | "looks" | "being" | "been")
        )
    }

    /// True if a list of denied things goes on after a comma: "no cars, buses or people".
    pub(super) fn list_goes_on(&self) -> bool {
        let mut j = self.at + 1;
        while let Some(item) = self.item(j) {
            match item.tag {
                Tag::Is(Sense::Or) => return true,
                Tag::Is(Sense::Noun(_, true))
                | Tag::Comma
                | Tag::Is(Sense::State(_, false) | Sense::Color(_)) => j += 1,
                _ => return false,
            }
        }
        false
    }

    pub(super) fn takes_object(&self, item: &Item) -> bool {
        let listed = |words: &str| {
            places::RELATIONS
                .iter()
                .any(|(_, l)| l.split('|').any(|w| w.trim() == words))
        };
        // "somewhere behind us"
        let bare = || {
            super::super::words::phrases::ADVERBS
                .split('|')
                .filter_map(|a| item.words.strip_prefix(a)?.strip_prefix(' '))
                .any(listed)
        };
        listed(&item.words) || bare()
    }

    pub(super) fn noun_directly(&self, i: usize) -> bool {
        for j in i..(i + 6).min(self.items.len()) {
            match self.items[j].tag {
                Tag::Is(Sense::Noun(..)) => return true,
                Tag::Is(Sense::Size(_) | Sense::Color(_) | Sense::Attribute(_) | Sense::State(_, false)) => {}
                Tag::Is(Sense::Weather(_) | Sense::Time(_)) if is_color(&self.items[j].words) => {}
                _ => return false,
            }
        }
        false
    }

    pub(super) fn noun_next(&self) -> bool {
        let noun = |i: usize| {
            self.item(i)
                .is_some_and(|n| n.words.is_ascii() && matches!(n.tag, Tag::Is(Sense::Noun(..))))
        };
        // "a tram-replacement bus"
        let joined = self.item(self.at + 1).is_some_and(|n| n.tag == Tag::Unknown)
            && (self.pre.article.is_some() || self.pre.count.is_some())
            && noun(self.at + 2);
        noun(self.at + 1) || joined
    }

    pub(super) fn history_last(&self) -> Option<&usize> {
        self.last.last()
    }
}
