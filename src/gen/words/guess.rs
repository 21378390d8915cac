//! Guesses of the network that no word of the text supports, such as "three tractors" for "three deer". Things that
//! were not named are not added, moved or removed. Acts on people, who have countless names, are marked as unsure.

use super::grammar;
use super::lexicon::{Lexicon, is_other_thing};
use super::notation;
use super::nouns::Noun;
use super::reading::{ActKind, AnchorPhrase, ObjectPhrase, Reading};
use super::tokens::Token;
use place::beside_road::TextSpan;
use scene::Class;

/// Words for people that name no kind of person.
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

/// Removes from a reading the things that no word of its text names. Returns the spans of the acts that lost something.
pub(super) fn take_out_guesses(reading: &mut Reading, tokens: &[Token]) -> Vec<Option<TextSpan>> {
    let mut lost = Vec::new();
    // In a text with a word for something that no scene holds ("three deer next to the bus"), a kind is read at most
    // once for each word that names it.
    let foreign = (0..tokens.len()).any(|i| is_foreign(&tokens[i..]));
    let line = notation::write(reading);
    let is_extra = |t: &ObjectPhrase, among: usize| {
        let fits = |symbol: &str| fits(symbol, t.noun);
        let read = line.split(' ').filter(|s| fits(s)).count();
        let names: Vec<bool> = tokens.iter().map(|t| names(t, &fits)).collect();
        // (words of one phrase name it once; "five cars, one of them red" are two things of one word)
        let first = |i: &usize| *i == 0 || tokens[*i].senses != tokens[*i - 1].senses;
        let named = (0..names.len()).filter(|i| names[*i] && first(i)).count();
        foreign && !is_general(t) && read + 1 > named + among
    };
    reading.acts.retain_mut(|act| {
        let named = |t: &ObjectPhrase| is_named(t, tokens);
        let mut none = Vec::new();
        let is_person = |t: &ObjectPhrase| !foreign && t.noun.classes() == [Class::Pedestrian];
        let (new, there): (&mut Vec<ObjectPhrase>, &[ObjectPhrase]) = match &mut act.what {
            ActKind::Add { things } => (things, &[]),
            ActKind::Replace { who, things } => (things, who),
            ActKind::Remove { who }
            | ActKind::Keep { who }
            | ActKind::Move { who, .. }
            | ActKind::Turn { who, .. }
            | ActKind::Set { who, .. }
            | ActKind::Go { who, .. }
            | ActKind::Count { who, .. } => (&mut none, who),
            _ => return true,
        };
        let before = new.len();
        if !new.iter().chain(there).all(|t| named(t) && anchors(t).all(named)) {
            act.confidence = 0.0;
        }
        let nouns: Vec<Noun> = new.iter().map(|t| t.noun).collect();
        let among = |t: &ObjectPhrase| nouns.iter().filter(|n| fits(n.name(), t.noun)).count();
        new.retain(|t| named(t) && !is_extra(t, among(t)) || is_person(t));
        let stays = (before == 0 || !new.is_empty()) && there.iter().all(|t| named(t) || is_person(t));
        if !stays || new.len() < before {
            lost.push(act.span);
        }
        stays
    });
    lost
}

/// The things that a thing is placed by.
fn anchors(t: &ObjectPhrase) -> impl Iterator<Item = &ObjectPhrase> {
    let of = t.places.iter().flat_map(|p| [p.to.as_ref(), p.and.as_ref()]);
    of.flatten().filter_map(|a| match a {
        AnchorPhrase::Thing(t) => Some(&**t),
        _ => None,
    })
}

/// True if the tokens begin with a word for something that no scene holds.
fn is_foreign(tokens: &[Token]) -> bool {
    let t = &tokens[0];
    t.senses.is_empty() && (grammar::cannot(tokens).is_some() || is_other_thing(&t.text))
}

/// True for a thing that any word may mean.
fn is_general(t: &ObjectPhrase) -> bool {
    let general = matches!(
        t.noun,
        Noun::It | Noun::One | Noun::Thing | Noun::Vehicle | Noun::TwoWheeler
    );
    general || t.id.is_some()
}

/// True if a symbol is a noun of the same class; `person 10` is a group.
fn fits(symbol: &str, noun: Noun) -> bool {
    let of = symbol.split(' ').next().and_then(Noun::of);
    of.is_some_and(|n| n.classes().iter().any(|c| noun.classes().contains(c)))
}

/// True if a token names the kind of a noun.
pub(super) fn names_noun(token: &Token, noun: Noun) -> bool {
    names(token, &|symbol: &str| fits(symbol, noun))
}

/// True if a token names a noun for which `fits` is true.
fn names(token: &Token, fits: &dyn Fn(&str) -> bool) -> bool {
    // (also by itself: "a bus stands" is not a bus stand)
    let alone = Lexicon::bundled().senses(&token.text).unwrap_or_default();
    let senses = token.senses.iter().chain(alone);
    let mut senses = senses.filter(|s| matches!(s.kind, "noun" | "group"));
    senses.any(|s| fits(s.symbol)) || token.slip_of.iter().any(|s| fits(s))
}

/// True if a word of the text, or a word with a typing error, names the kind of a thing.
fn is_named(t: &ObjectPhrase, tokens: &[Token]) -> bool {
    let people = t.noun.classes() == [Class::Pedestrian];
    let somebody = |token: &Token| people && SOMEBODY.contains(&token.text.as_str());
    is_general(t)
        || tokens
            .iter()
            .any(|token| somebody(token) || names(token, &|s| fits(s, t.noun)))
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
            (
                "three deer next to the bus",
                "add 3 bus ( next_to the bus )",
                "",
                true,
            ),
            (
                "a dog by the bus, a bus behind it",
                "add 1 bus ( behind the bus )",
                "add 1 bus ( behind the bus )",
                true,
            ),
            (
                "a red brick school, no cars",
                "add 1 red car ; no car",
                "no car",
                true,
            ),
            ("a bus stands there", "add 1 bus", "add 1 bus", true),
        ] {
            let mut reading = parse(line).expect("a reading");
            take_out_guesses(&mut reading, &tokens(text, None));
            assert_eq!(write(&reading), left, "{text}");
            assert_eq!(reading.acts.iter().all(|a| a.confidence > 0.0), sure, "{text}");
        }
    }
}
