//! Recolouring by text: "paint the taxi blue", "the red car should be white", "change the colour of the bus to green".

use super::edit::{Editor, TextEdit};
use super::edit_grammar::Command;
use super::lexicon::Sense;
use super::names::paint_of;
use super::tag::{Item, Tag};
use super::words::edits::Verb;
use crate::scene::{BoxId, BoxLabel, Paint};

/// The words of a colour, also those that may mean a sky ("grey") or a time.
fn is_colour(item: &Item) -> bool {
    match item.tag {
        Tag::Is(Sense::Color(_)) => true,
        Tag::Is(Sense::Weather(_) | Sense::Time(_)) => paint_of(&item.words).is_some(),
        _ => false,
    }
}

/// The colour that a command gives, and its words without it: what stays before the noun tells which one is meant.
/// `None` if it gives none.
pub(super) fn given(items: &[Item], verb: Verb) -> Option<(String, Vec<Item>)> {
    if !matches!(verb, Verb::Paint | Verb::Make | Verb::Turn | Verb::Replace) {
        return None;
    }
    let word = |i: usize| items.get(i).map_or("", |x| x.words.as_str());
    let is_noun = |i: usize| {
        matches!(
            items[i].tag,
            Tag::Is(Sense::Noun(..) | Sense::Pronoun | Sense::Works)
        )
    };
    let is_colour_word =
        |i: usize| matches!(word(i), "colour" | "color" | "paint" | "paintwork" | "paint job");
    // (a colour before a noun is that of the noun)
    let before_noun = |i: usize| {
        let mut k = i + 1;
        while k < items.len()
            && (is_colour(&items[k]) || matches!(items[k].tag, Tag::Is(Sense::Attribute(_) | Sense::Size(_))))
        {
            k += 1;
        }
        k < items.len() && matches!(items[k].tag, Tag::Is(Sense::Noun(..)))
    };
    let k = (0..items.len())
        .rev()
        .find(|&k| is_colour(&items[k]) && !before_noun(k))?;
    if verb == Verb::Make
        && !items[..k]
            .iter()
            .enumerate()
            .any(|(i, x)| is_noun(i) || x.words == "it" || x.words == "them")
    {
        return None; // "make it grey and rainy" speaks of the sky where nothing else was named
    }
    let mut from = k;
    while from > 0
        && (matches!(
            word(from - 1),
            "to" | "in"
                | "into"
                | "as"
                | "a"
                | "an"
                | "be"
                | "being"
                | "become"
                | "coloured"
                | "colored"
                | "completely"
                | "all"
                | "instead"
                | "bright"
                | "dark"
                | "light"
                | "from"
        ) || is_colour(&items[from - 1]) && from == k
            || is_colour_word(from - 1))
    {
        from -= 1;
    }
    let mut rest: Vec<Item> = items[..from].to_vec();
    let mut to = k + 1;
    if to < items.len() && is_colour_word(to) {
        to += 1;
    }
    rest.extend_from_slice(&items[to..]);
    // "(change) the colour of the bus", "the bus's colour"
    if let Some(c) = rest
        .iter()
        .position(|x| matches!(x.words.as_str(), "colour" | "color" | "paint"))
    {
        let of = rest.get(c + 1).is_some_and(|x| x.words == "of");
        let article = c > 0 && matches!(rest[c - 1].words.as_str(), "the");
        rest.drain(if article && of { c - 1 } else { c }..if of { c + 2 } else { c + 1 });
    }
    Some((items[k].words.clone(), rest))
}

impl Editor<'_> {
    /// Paints boxes in what the words call a colour; true if that is a paint.
    pub(super) fn paint(&mut self, ids: &[BoxId], words: &str) -> bool {
        let Some(paint) = paint_of(words) else {
            let names: Vec<&str> = Paint::ALL.iter().map(|p| p.name()).collect();
            self.note(format!(
                "{words} is no paint of boxes, expected one of {}",
                names.join(", ")
            ));
            return false;
        };
        for id in ids {
            let Some(b) = self.boxes.get(id).filter(|b| b.label.paint != Some(paint)) else {
                continue;
            };
            let label = BoxLabel {
                paint: Some(paint),
                ..b.label
            };
            self.push(TextEdit::Label { id: *id, label });
        }
        true
    }

    /// "paint the bus red": true if something was meant and is red now.
    pub(super) fn recolour(&mut self, c: &Command) -> bool {
        let Some(words) = c.color.clone() else {
            self.note(format!("{:?}: which colour was not understood", c.text));
            return false;
        };
        self.targets(c, false).is_some_and(|ids| self.paint(&ids, &words))
    }
}
