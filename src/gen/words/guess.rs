//! What the network reads where no word of the text names it, "three tractors" for "three deer": things that nobody named
//! are not put in, moved or taken away; of people, who are called by countless words, the reader is unsure.

use super::grammar;
use super::lexicon::{Lexicon, is_english, is_other_thing};
use super::nouns::Noun;
use super::reading::{Anchor, Reading, Thing, What};
use super::tokens::{Span, Token, is_one_slip};
use crate::scene::Class;

/// Words that mean people and name no kind of them.
const SOMEBODY: [&str; 20] = [
    "he",
    "she",
    "him",
    "her",
    "his",
    "they",
    "them",
    "who",
    "whoever",
    "nobody",
    "noone",
    "somebody",
    "someone",
    "anybody",
    "anyone",
    "everybody",
    "everyone",
    "foot",
    "folk",
    "body",
];

/// Takes out of a reading what no word of its text names; answers where the acts stood that lost something.
pub(super) fn take_out_guesses(reading: &mut Reading, tokens: &[Token]) -> Vec<Option<Span>> {
    let mut lost = Vec::new();
    // (beside "three deer" not even people)
    let others = (0..tokens.len()).any(|i| {
        tokens[i].senses.is_empty()
            && (grammar::cannot(&tokens[i..]).is_some() || is_other_thing(&tokens[i].text))
    });
    reading.acts.retain_mut(|act| {
        let named = |t: &Thing| is_named(t, tokens);
        let mut none = Vec::new();
        let is_person = |t: &Thing| !others && t.noun.classes() == [Class::Pedestrian];
        let (new, there): (&mut Vec<Thing>, &[Thing]) = match &mut act.what {
            What::Add { things } => (things, &[]),
            What::Replace { who, things } => (things, who),
            What::Remove { who }
            | What::Keep { who }
            | What::Move { who, .. }
            | What::Turn { who, .. }
            | What::Set { who, .. }
            | What::Count { who, .. } => (&mut none, who),
            _ => return true,
        };
        let before = new.len();
        if !new.iter().chain(there).all(|t| named(t) && anchors(t).all(named)) {
            act.confidence = 0.0;
        }
        new.retain(|t| named(t) || is_person(t));
        let stays = (before == 0 || !new.is_empty()) && there.iter().all(|t| named(t) || is_person(t));
        if !stays || new.len() < before {
            lost.push(act.span);
        }
        stays
    });
    lost
}

/// The things that a thing is placed by.
fn anchors(t: &Thing) -> impl Iterator<Item = &Thing> {
    let of = t.places.iter().flat_map(|p| [p.to.as_ref(), p.and.as_ref()]);
    of.flatten().filter_map(|a| match a {
        Anchor::Thing(t) => Some(&**t),
        _ => None,
    })
}

/// True if a word of the text names the kind of a thing, or is a slip of a word that does.
fn is_named(t: &Thing, tokens: &[Token]) -> bool {
    let general = matches!(
        t.noun,
        Noun::It | Noun::One | Noun::Thing | Noun::Vehicle | Noun::TwoWheeler
    );
    let classes = t.noun.classes();
    let fits = |symbol: &str| {
        // ("person 10": a group)
        let noun = symbol.split(' ').next().and_then(Noun::of);
        noun.is_some_and(|n| n.classes().iter().any(|c| classes.contains(c)))
    };
    general
        || t.id.is_some()
        || tokens.iter().any(|token| {
            // (alone, too: "a bus stands" is no bus stand)
            let alone = Lexicon::bundled().senses(&token.text).unwrap_or_default();
            let senses = token.senses.iter().chain(alone);
            let senses = senses.filter(|s| matches!(s.kind, "noun" | "group"));
            let somebody = classes == [Class::Pedestrian] && SOMEBODY.contains(&token.text.as_str());
            somebody || senses.map(|s| s.symbol).any(fits) || is_slip_of(&token.text, &fits)
        })
}

/// True if one slip of the keys makes the word of one whose noun fits.
fn is_slip_of(word: &str, fits: &dyn Fn(&str) -> bool) -> bool {
    word.chars().count() > 2
        && !is_english(word)
        && Lexicon::bundled()
            .nouns()
            .any(|(form, symbol)| is_one_slip(word, form) && fits(symbol))
}

#[cfg(test)]
mod tests {
    use super::super::notation::{parse, write};
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn what_no_word_names_is_taken_out() {
        for (text, line, left, sure) in [
            (
                "three deer run, leave the tractor",
                "add 3 person ; leave the tractor",
                "leave the tractor",
                true,
            ),
            (
                "a red brick school, and a bus",
                "add 1 red car and 1 bus",
                "add 1 bus",
                false,
            ),
            (
                "two wretches on the left",
                "add 2 person ( left ego )",
                "add 2 person ( left ego )",
                false,
            ),
            (
                "somebody on the left",
                "add 1 person ( left ego )",
                "add 1 person ( left ego )",
                true,
            ),
            ("the tuck and the bsu", "remove the truck and the bus", "", true),
            (
                "the trcuk and the bsu",
                "remove the truck and the bus",
                "remove the truck and the bus",
                true,
            ),
            (
                "a lorry behind a taxi",
                "add 1 truck ( behind 1 taxi )",
                "add 1 truck ( behind 1 taxi )",
                true,
            ),
            ("move it left", "move it by left", "move it by left", true),
            ("a bus stands there", "add 1 bus", "add 1 bus", true),
        ] {
            let mut reading = parse(line).expect("a reading");
            take_out_guesses(&mut reading, &tokens(text, None));
            assert_eq!(write(&reading), left, "{text}");
            assert_eq!(reading.acts.iter().all(|a| a.confidence > 0.0), sure, "{text}");
        }
    }
}
