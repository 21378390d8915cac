//! "A car cuts in" means any car that fits, or a new one; the reader says "the car" for both.

use super::guess::names_noun;
use super::nouns::Noun;
use super::reading::{ActKind, ObjectPhrase, Quantity, Reading};
use super::tokens::Token;

/// Words before a thing that is not a specific one.
const ARTICLES: [&str; 3] = ["a", "an", "another"];
/// Most words from an article to its noun: "a small red car".
const APART: usize = 3;

/// Makes a thing that moves, has an indefinite article and was not named in an earlier act mean any one that fits.
pub(super) fn set_right(reading: &mut Reading, tokens: &[Token]) {
    let mut spoken_of: Vec<Noun> = Vec::new();
    for act in &mut reading.acts {
        match &mut act.what {
            ActKind::Add { things } => spoken_of.extend(things.iter().map(|t| t.noun)),
            ActKind::Replace { things, .. } => spoken_of.extend(things.iter().map(|t| t.noun)),
            ActKind::Go { who, .. } => {
                for thing in who {
                    if is_any(thing) && !spoken_of.contains(&thing.noun) && is_indefinite(thing.noun, tokens)
                    {
                        thing.quantity = Quantity::N(1);
                    }
                    spoken_of.push(thing.noun);
                }
            }
            _ => (),
        }
    }
}

fn is_any(thing: &ObjectPhrase) -> bool {
    let told = thing.id.is_some() || thing.nth.is_some() || thing.pick.is_some() || thing.other;
    !told && matches!(thing.quantity, Quantity::The | Quantity::Unsaid)
}

fn is_indefinite(noun: Noun, tokens: &[Token]) -> bool {
    let Some(first) = tokens.iter().position(|t| names_noun(t, noun)) else {
        return false;
    };
    let before = tokens[..first].iter().rev().take(APART);
    // (the article belongs to another noun)
    before
        .take_while(|t| !t.senses.iter().any(|s| s.kind == "noun"))
        .any(|t| ARTICLES.contains(&t.text.as_str()))
}
