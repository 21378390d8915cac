//! "The red one": the noun that was said of another colour, or last.

use super::lexicon::{Sense, look_up, plural};
use super::names::{paint_of, singular};
use super::tokens::{Token, TokenKind};
use super::wording::word;

/// A colour that boxes may have; "grey" is a sky, too.
pub fn is_colour(t: &Token) -> bool {
    let sense = matches!(
        look_up(&t.text),
        Some(Sense::Color(_) | Sense::Weather(_) | Sense::Time(_))
    );
    sense && paint_of(&t.text).is_some()
}

/// A text with nouns for "one" and "ones" after a colour.
pub fn named(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut skip = 0;
    for (i, t) in tokens.iter().enumerate() {
        if i < skip {
            continue;
        }
        // "the red one of the two cars": the red car
        if t.text == "one"
            && i.checked_sub(1).is_some_and(|k| is_colour(&tokens[k]))
            && tokens.get(i + 1).is_some_and(|t| t.text == "of")
            && tokens
                .get(i + 2)
                .is_some_and(|t| matches!(t.text.as_str(), "the" | "these" | "those" | "our" | "my"))
            && let Some(k) = (i + 3..tokens.len().min(i + 6)).find(|k| is_noun(&tokens[*k]))
        {
            out.push(word(singular(&tokens[k].text), t));
            skip = k + 1;
            continue;
        }
        let many = t.text == "ones";
        if !(many || t.text == "one") || !i.checked_sub(1).is_some_and(|k| is_colour(&tokens[k])) {
            out.push(t.clone());
            continue;
        }
        // "an SUV, a grey one," says more of the same
        let said_more = i > 3
            && tokens[i - 3].kind == TokenKind::Comma
            && matches!(tokens[i - 2].text.as_str(), "a" | "an")
            && is_noun(&tokens[i - 4]);
        if said_more && out.len() > 3 {
            // (noun, comma, article, colour are there already)
            let colour = out.pop().into_iter();
            out.truncate(out.len() - 2);
            let noun = out.pop().into_iter();
            out.extend(colour.chain(noun));
            continue;
        }
        // (people have no colour: "the red one has a new owner, the blue one has not")
        let nouns = || {
            (0..i)
                .rev()
                .filter(|k| is_noun(&tokens[*k]) && !is_person(&tokens[*k]))
        };
        let of_colour = nouns().find(|k| *k > 0 && is_colour(&tokens[k - 1]));
        let noun = match of_colour.or_else(|| nouns().next()) {
            Some(k) => singular(&tokens[k].text).to_owned(),
            None => "vehicle".to_owned(),
        };
        out.push(word(&if many { plural(&noun) } else { noun }, t));
    }
    out
}

fn is_noun(t: &Token) -> bool {
    matches!(look_up(&t.text), Some(Sense::Noun(..)))
}

fn is_person(t: &Token) -> bool {
    matches!(look_up(&t.text), Some(Sense::Noun(n, _)) if n.classes[0] == crate::scene::Class::Pedestrian)
}
