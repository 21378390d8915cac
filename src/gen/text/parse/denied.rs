//! What is said not to be there after it was named: "pedestrians: none", "cars are not allowed".

use super::super::lexicon::Sense;
use super::super::tag::Tag;
use super::super::tokens::Span;
use super::Parser;

impl Parser<'_> {
    /// "pedestrians: none", "buses: 0": takes back what was named `back` items before. True if it was that.
    pub(in super::super) fn none_of_it(&mut self, back: usize, span: Span) -> bool {
        let named = matches!(
            self.at.checked_sub(back).and_then(|i| self.sense(i)),
            Some(Sense::Noun(..))
        );
        let Some(&i) = self.last.last().filter(|_| named && self.ends(self.at + 1)) else {
            return false;
        };
        if !self.mentions[i].uncounted || self.mentions[i].is_anchor {
            return false;
        }
        self.mentions[i].gone = true;
        let (classes, whole) = (
            self.mentions[i].classes.to_vec(),
            self.mentions[i].spec.span.to(span),
        );
        self.absent(classes, None, whole);
        self.head.retain(|h| *h != i);
        self.last.retain(|h| *h != i);
        true
    }

    /// True if what follows only says that something is not there: "(are not) allowed", "(are not) to be seen".
    pub(in super::super) fn refused(&self, i: usize) -> bool {
        let words: Vec<&str> = self.items[i.min(self.items.len())..]
            .iter()
            .take_while(|n| !matches!(n.tag, Tag::Stop | Tag::Comma | Tag::Mark))
            .map(|n| n.words.as_str())
            .collect();
        let said = words.join(" ");
        let there = [
            "allowed",
            "permitted",
            "present",
            "wanted",
            "needed",
            "visible",
            "here",
            "there",
            "around",
            "in sight",
            "to be seen",
            "admitted",
            "to be found",
            "included",
            "in the scene",
            "in view",
            "seen",
            "shown",
            "desired",
            "required",
            "welcome",
            "part of the scene",
            "part of this",
            "about",
        ];
        there
            .iter()
            .any(|w| said == *w || said == format!("{w} here") || said == format!("{w} there"))
    }

    /// "cars and buses are there none": takes the list back. True if it was that.
    pub(in super::super) fn none_of_these(&mut self, span: Span) -> bool {
        let verb = (0..=2).any(|k| {
            let before = self.at.checked_sub(k).and_then(|i| self.item(i));
            before.is_some_and(|b| {
                matches!(
                    b.words.as_str(),
                    "is" | "are"
                        | "were"
                        | "was"
                        | "is there"
                        | "are there"
                        | "there are"
                        | "is not"
                        | "are not"
                )
            })
        });
        let all = self.head.clone();
        let open = |i: &usize| {
            self.mentions[*i].uncounted && self.mentions[*i].plural && !self.mentions[*i].is_anchor
        };
        if !verb || all.is_empty() || !all.iter().all(open) {
            return false;
        }
        for i in all {
            self.mentions[i].gone = true;
            let (classes, whole) = (
                self.mentions[i].classes.to_vec(),
                self.mentions[i].spec.span.to(span),
            );
            self.absent(classes, None, whole);
        }
        self.head.clear();
        self.last.clear();
        true
    }
}
