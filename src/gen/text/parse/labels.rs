//! Names that reports give to what they tell of: "Vehicle 1, a red hatchback", "the target, a van".

use super::super::description::Anchor;
use super::super::lexicon::Sense;
use super::super::mention::{Frag, Mention, Pre, Prep, apply};
use super::super::tag::Tag;
use super::super::tokens::Span;
use super::super::words::objects::Noun;
use super::Parser;
use crate::scene::Class;
use crate::scene::graph::RelationKind;

impl Parser<'_> {
    /// "Vehicle 1": the number is a name, if it stands after a noun in the singular and no noun or unit follows. True if
    /// it was that.
    pub(super) fn labelled(&mut self, number: f64) -> bool {
        let noun = matches!(self.sense(self.at.wrapping_sub(1)), Some(Sense::Noun(_, false)));
        let small = (1.0..10.0).contains(&number) && number.fract() == 0.0;
        let times =
            self.items[self.at.wrapping_sub(1).min(self.at)].span.end + 1 < self.items[self.at].span.start;
        let next = self.item(self.at + 1);
        let told = next.is_some_and(|n| {
            n.tag == Tag::Comma
                || n.words == "("
                || matches!(
                    n.tag,
                    Tag::Is(Sense::State(_, true) | Sense::Rel(_) | Sense::EgoRel(_) | Sense::In)
                )
                || matches!(
                    n.words.as_str(),
                    "is" | "was" | "has" | "had" | "came" | "comes" | "were"
                )
        });
        let Some(&i) = self.last.last().filter(|_| noun && small && told && !times) else {
            return false;
        };
        let name = format!("{} {number}", self.mentions[i].spec.noun);
        // named before: it is that one
        let old =
            (0..i).find(|k| self.mentions[*k].spec.attributes.contains(&name) && !self.mentions[*k].gone);
        match old {
            Some(old) if i + 1 == self.mentions.len() && !self.mentions[i].is_anchor => {
                self.mentions.pop();
                self.head = vec![old];
                self.last = vec![old];
                self.list = vec![old];
            }
            Some(_) => return false,
            None => {
                let m = &mut self.mentions[i];
                m.uncounted = false;
                m.spec.attributes.push(name);
            }
        }
        self.pre = Pre::default();
        true
    }

    /// "the only other vehicle is an oncoming lorry": what is said of the lorry holds for what it is.
    pub(super) fn adjectives_of_same(&mut self, pre: &Pre, span: Span) {
        let Some(&i) = self.head.last().or(self.last.last()).filter(|_| !self.edits) else {
            return;
        };
        for kinds in pre.attributes.iter().filter_map(|a| a.strip_prefix('\u{1}')) {
            let frag = Frag {
                prep: Prep::Rels(
                    kinds
                        .split(',')
                        .filter_map(|n| RelationKind::ALL.into_iter().find(|k| k.name() == n))
                        .collect(),
                ),
                anchor: Anchor::Ego,
                and: None,
                distance_m: None,
                span,
            };
            apply(&mut self.mentions[i].spec, &frag);
        }
    }

    /// True if this is what a report named first and now describes: ", a red hatchback,".
    pub(in super::super) fn described_as(&mut self, i: usize, noun: &'static Noun, word: &str) -> bool {
        let m: &mut Mention = &mut self.mentions[i];
        let named = m
            .spec
            .attributes
            .iter()
            .any(|a| a.rsplit(' ').next().is_some_and(|n| n.parse::<u8>().is_ok()));
        let fits = m.classes.contains(&noun.classes[0]) && noun.classes.len() == 1;
        // "suspect vehicle, a van, parked on the left"
        let sort = m.bare && !m.plural && m.classes.len() > 1;
        if !(named || m.definite || sort) || !fits {
            return false;
        }
        m.classes = noun.classes;
        m.spec.class = noun.classes[0];
        m.spec.noun = word.to_string();
        m.spec.size_m = noun.size_m;
        true
    }

    /// "witnesses counted five cones": who tells of the scene is not in it. True if it was that.
    pub(in super::super) fn tells(&mut self, noun: &'static Noun) -> bool {
        static SAYING: std::sync::LazyLock<std::collections::HashSet<String>> =
            std::sync::LazyLock::new(|| {
                use super::super::words::verbs::{SAYING, forms};
                let all = SAYING.split('|').map(forms);
                all.flat_map(|f| [f.base, f.s, f.past, f.participle]).collect()
            });
        if noun.classes[0] != Class::Pedestrian {
            return false;
        }
        let mut j = self.at + 1;
        while self
            .item(j)
            .is_some_and(|n| matches!(n.words.as_str(), "has" | "have" | "had"))
        {
            j += 1;
        }
        let items = self.items;
        let words = |k: usize| items.get(k).map_or("", |n| n.words.as_str());
        let one = words(j)
            .trim_start_matches("has ")
            .trim_start_matches("have ")
            .trim_start_matches("had ");
        let two = format!("{one} {}", words(j + 1));
        let said = SAYING.contains(one)
            && self
                .item(j)
                .is_some_and(|n| !matches!(n.tag, Tag::Is(Sense::Noun(..))))
            || SAYING.contains(&two);
        if said {
            // past the verb, and a "that" after it
            self.at = j + usize::from(SAYING.contains(&two));
            if words(self.at + 1) == "that" {
                self.at += 1;
            }
            self.new_clause();
            self.fresh = true;
        }
        said
    }
}
