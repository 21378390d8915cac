//! "Nobody moves any more": moving things shall stand. It removes none of them.

use super::account::{Missing, Why};
use super::lexicon::LONGEST_PHRASE;
use super::mode::Mode;
use super::nouns::Noun;
use super::reading::{Act, ActKind, ObjectPhrase, Quantity, Reading, Traits};
use super::tokens::Token;
use place::beside_road::TextSpan;
use scene::graph::ObjectState;

/// Words for nobody and nothing.
const NOBODY: [&[&str]; 7] = [
    &["nobody"],
    &["noone"],
    &["nothing"],
    &["none"],
    &["no", "one"],
    &["no", "body"],
    &["not", "one"],
];
/// Words for moving.
const MOVES: [&str; 25] = [
    "move", "moves", "moving", "drive", "drives", "driving", "walk", "walks", "walking", "ride", "rides",
    "riding", "run", "runs", "running", "go", "goes", "going", "travel", "travels", "roll", "rolls",
    "rolling", "budge", "stir",
];
/// Words that may stand between the subject and the verb of moving.
const BETWEEN: [&str; 16] = [
    "is", "are", "be", "being", "should", "shall", "must", "may", "can", "will", "else", "of", "them",
    "here", "now", "there",
];
/// Most words between them.
const APART: usize = 4;

/// Things that shall stop: their noun (`None` for all of them), and the tokens from the first up to, but not including,
/// the second.
struct Halt {
    who: Option<Noun>,
    at: (usize, usize),
}

fn find(tokens: &[Token]) -> Option<Halt> {
    let word = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    (0..tokens.len()).find_map(|i| {
        let nobody = NOBODY
            .iter()
            .find(|words| words.iter().enumerate().all(|(k, w)| word(i + k) == *w));
        let (who, end) = match nobody {
            // ("none of the cars moves")
            Some(words) if word(i + words.len()) == "of" => {
                let from = i + words.len() + 1;
                let from = from + usize::from(matches!(word(from), "the" | "these" | "those"));
                match noun_at(tokens, from) {
                    Some((noun, end)) => (Some(noun), end),
                    None => (None, from),
                }
            }
            Some(words) => (None, i + words.len()),
            None if word(i) == "no" => {
                let (noun, end) = noun_at(tokens, i + 1)?;
                (Some(noun), end)
            }
            None => return None,
        };
        let verb = (end..end + APART)
            .take_while(|k| *k == end || BETWEEN.contains(&word(*k - 1)))
            .find(|k| MOVES.contains(&word(*k)))?;
        // ("nobody goes there" says that nobody is there)
        let mut to = verb + 1;
        for over in [["any", "more"], ["any", "longer"]] {
            if [word(to), word(to + 1)] == over {
                to += 2;
            }
        }
        to += usize::from(matches!(word(to), "anymore" | "now"));
        let ends = to >= tokens.len() || matches!(word(to), "." | "," | ";" | "!" | "?" | "and" | "but");
        ends.then_some(Halt { who, at: (i, to) })
    })
}

fn noun_at(tokens: &[Token], i: usize) -> Option<(Noun, usize)> {
    let most = LONGEST_PHRASE.min(tokens.len().saturating_sub(i));
    (1..=most).rev().find_map(|n| {
        let words: Vec<&str> = tokens[i..i + n].iter().map(|t| t.text.as_str()).collect();
        let senses = super::lexicon::Lexicon::bundled().senses(&words.join(" "))?;
        let s = senses.iter().find(|s| s.kind == "noun")?;
        Some((Noun::of(s.symbol)?, i + n))
    })
}

/// Corrects the acts that a reading made of it. In words for a new scene, where it cannot be carried out, returns the
/// words as missing.
pub(super) fn set_right(reading: &mut Reading, text: &str, tokens: &[Token], mode: Mode) -> Option<Missing> {
    let halt = find(tokens)?;
    let span = tokens[halt.at.0].span.to(tokens[halt.at.1 - 1].span);
    // (the reader may take "nobody" for no person, no vehicle or nothing)
    let is_anybody = |n: Noun| {
        let general = matches!(
            n,
            Noun::Vehicle | Noun::TwoWheeler | Noun::Thing | Noun::It | Noun::One
        );
        general || n.classes() == Noun::Person.classes()
    };
    let of_it = |act: &Act| {
        let who = match &act.what {
            ActKind::No { who } | ActKind::Remove { who } => who,
            _ => return false,
        };
        let here = act
            .span
            .is_none_or(|s: TextSpan| s.start < span.end && s.end > span.start);
        let fits = |t: &ObjectPhrase| match halt.who {
            Some(noun) => t.noun.classes().iter().any(|c| noun.classes().contains(c)),
            None => is_anybody(t.noun),
        };
        here && who.iter().all(fits)
    };
    reading.acts.retain(|act| !of_it(act));
    if mode == Mode::Prompt {
        return Some(Missing {
            span,
            words: span.of(text).to_owned(),
            why: Why::NotCarriedOut,
        });
    }
    let waits = |act: &Act| match &act.what {
        ActKind::Set { traits, .. } => traits.state == Some(ObjectState::Waiting),
        _ => false,
    };
    if !reading.acts.iter().any(waits) {
        let thing = ObjectPhrase::new(halt.who.unwrap_or(Noun::Thing)).with(Quantity::All);
        let traits = Traits {
            state: Some(ObjectState::Waiting),
            ..Traits::default()
        };
        reading.acts.push(Act {
            what: ActKind::Set {
                who: vec![thing],
                traits,
            },
            span: Some(span),
            confidence: 1.0,
        });
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::notation::{parse, write};
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn who_moves_no_more_is_not_taken_away() {
        for (text, line, wanted) in [
            ("nobody moves any more", "no person", "set all thing waiting"),
            (
                "nobody moves any more",
                "remove the person",
                "set all thing waiting",
            ),
            ("no one is driving now", "", "set all thing waiting"),
            ("nothing moves", "no thing", "set all thing waiting"),
            ("no cars move any longer", "no car", "set all car waiting"),
            (
                "none of the cars is moving",
                "remove all car",
                "set all car waiting",
            ),
            (
                "remove the bus, and nobody moves",
                "remove the bus ; no person",
                "remove the bus ; set all thing waiting",
            ),
            // This says that nobody is there, which is a different request.
            (
                "nobody on the crossing",
                "no person ( on crossing )",
                "no person ( on crossing )",
            ),
            ("no cars", "no car", "no car"),
            (
                "remove whoever moves",
                "remove all moving person",
                "remove all moving person",
            ),
        ] {
            let mut reading = parse(line).expect("a reading");
            set_right(&mut reading, text, &tokens(text, None), Mode::Edit);
            assert_eq!(write(&reading), wanted, "{text}");
        }
        let mut reading = parse("add 1 bus ; no person").expect("a reading");
        let text = "a bus, nobody moves";
        let named = set_right(&mut reading, text, &tokens(text, None), Mode::Prompt).expect("named");
        assert_eq!(
            (write(&reading).as_str(), named.words.as_str()),
            ("add 1 bus", "nobody moves")
        );
    }
}
