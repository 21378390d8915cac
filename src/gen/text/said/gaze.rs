//! Who looks at whom: "the officer has his eyes on the van", "turn her towards the bus", "he has his back to us, that man".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::lists::PRONOUNS;
use super::words::{first_noun, is, led, text, trimmed};

const HAS: &str = "has|have|had|has got|have got|keeps|keep|kept|has had|should have|should keep|must have|must keep|is to have|are to have|shall have";
const STANDS: &str = "stands with|stand with|standing with|is standing with|are standing with|should stand with|must stand with|waits with|wait with|waiting with|is waiting with|are waiting with|sits with|sit with|sitting with|is sitting with|remains with|remain with|poses with";
const WHOSE: &str =
    "his|her|their|its|both his|both her|both their|all their|a watchful|one|a close|a wary|an|a|the";
const EYES: &str = "eyes|eye|gaze|face|faces|sights|look|attention|nose|noses|glance";
const BACK: &str = "back|backs";
const UPON: &str = "on|upon|to|towards|toward|turned to|turned towards|turned toward|fixed on|trained on|glued to|directed at|pointed at|pointing at|pointing to|pointing towards|only on";
const TURNS: &str = "turn|rotate|swivel|spin|orient|orientate|angle|pivot|twist|point|aim|direct";
const TO: &str = "towards|toward|to|at|to face|to look at|facing|so that it faces|so that he faces|so that she faces|so that they face|in the direction of";
const KNOWN: [&str; 8] = ["the", "both", "all", "every", "each", "that", "my", "our"];

/// A sentence that says it in plain words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    turned_to(has_eyes(back_is_to(named_after(tokens, talk))), talk)
}

/// "he looks at the truck, that man": the man does.
fn named_after(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let opens = tokens.first().is_some_and(|t| PRONOUNS.contains(&text(t)));
    let comma = tokens.iter().rposition(|t| t.kind == TokenKind::Comma);
    let Some(k) = comma.filter(|k| opens && *k > 2) else {
        return tokens;
    };
    let np = &tokens[k + 1..];
    let whole = is(
        np.first(),
        &["the", "that", "those", "these", "this", "my", "our"],
    ) && first_noun(np).is_some_and(|x| x.0 < 4 && x.1 == np.len());
    if whole && talk.fits(np) > 0 {
        [np, &tokens[1..k]].concat()
    } else {
        tokens
    }
}

/// "his back is to us": he faces away; "her eyes are on the bus": she faces it.
fn back_is_to(tokens: Vec<Token>) -> Vec<Token> {
    const IS: &str = "is|are|was|were|should be|must be|is turned|are turned|is kept|are fixed|is fixed";
    let found = (0..tokens.len()).find_map(|i| {
        let opens = i == 0
            || tokens[i - 1].kind != TokenKind::Word
            || is(tokens.get(i - 1), &["and", "but", "so", "with"]);
        let who = match tokens.get(i).map(text).filter(|_| opens)? {
            "his" => "he",
            "her" => "she",
            "their" => "they",
            "its" => "it",
            _ => return None,
        };
        let back = begins(&tokens[i + 1..], BACK);
        let k = i + 1 + back.or_else(|| begins(&tokens[i + 1..], EYES))?;
        let k = k + begins(&tokens[k..], IS)?;
        Some((i, who, back.is_some(), k + begins(&tokens[k..], UPON)?))
    });
    match found {
        Some((i, who, back, to)) => {
            let does = if back {
                "should face away from"
            } else {
                "should face"
            };
            [
                &tokens[..i],
                &led(&format!("{who} {does}"), &tokens[i], &[&tokens[to..]]),
            ]
            .concat()
        }
        None => tokens,
    }
}

/// "the policeman has his eyes on the van": he faces it; "they have their backs to us": they face away.
fn has_eyes(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        // (what is new is read as a whole)
        let known = (0..i).rev().find(|k| is(tokens.get(*k), &KNOWN));
        let known = known.is_some_and(|k| first_noun(&tokens[k..i]).is_some_and(|x| k + x.1 == i))
            || i == 1 && PRONOUNS.contains(&text(&tokens[0]));
        let stands = begins(&tokens[i..], STANDS).filter(|_| known);
        let mut k = i + begins(&tokens[i..], HAS).or(stands)?;
        let whose = begins(&tokens[k..], WHOSE)?;
        let own = !is(tokens.get(k), &["a", "an", "one", "the"]);
        k += whose;
        let (n, back) = match (begins(&tokens[k..], EYES), begins(&tokens[k..], BACK)) {
            (Some(n), _) => (n, false),
            (_, Some(n)) if own => (n, true),
            _ => return None,
        };
        k += n;
        let to = k + begins(&tokens[k..], UPON)?;
        let pronoun = is(tokens.get(to), &["us", "me", "it", "him", "her", "them", "each"]);
        let end = match pronoun {
            true => to + 1,
            false => to + first_noun(&tokens[to..]).filter(|x| x.0 < 4)?.1,
        };
        // ("the girl standing with her back to us should go" says only who)
        let ends = tokens
            .get(end)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "now"]));
        (stands.is_none() || ends).then_some((i, to, back))
    });
    match found {
        Some((i, to, back)) => {
            let does = if back {
                "should face away from"
            } else {
                "should face"
            };
            [&tokens[..i], &led(does, &tokens[i], &[&tokens[to..]])].concat()
        }
        None => tokens,
    }
}

/// "turn the worker towards the crane", "point them at it": they face it.
fn turned_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let opens = i == 0
            || tokens[i - 1].kind != TokenKind::Word
            || is(tokens.get(i - 1), &["and", "so", "then", "please", "just"]);
        begins(&tokens[i..], TURNS).filter(|_| opens)?;
        let who = &tokens[i + 1..];
        let pronoun = match who.first().map(text)? {
            "him" => Some("he"),
            "her" => Some("she"),
            "them" => Some("they"),
            "it" => Some("it"),
            _ => None,
        };
        let end = match pronoun {
            Some(_) => 1,
            None => first_noun(who).filter(|x| x.0 < 4 && is(who.first(), &KNOWN))?.1,
        };
        let to = end + begins(&who[end..], TO)?;
        let whom = &who[to..];
        let ends = |t: Option<&Token>| t.is_none_or(|t| t.kind != TokenKind::Word || text(t) == "and");
        // (who and "it" are two)
        let it =
            is(whom.first(), &["it", "him", "her", "them"]) && pronoun != Some("it") && ends(whom.get(1));
        let named = is(whom.first(), &KNOWN)
            && first_noun(whom).is_some_and(|x| {
                x.0 < 4
                    && (ends(whom.get(x.1)) || is(whom.get(x.1), &["instead", "please", "now"]))
                    && talk.fits(&whom[..x.1]) > 0
            });
        let subject = match pronoun {
            Some(word) => led(word, &who[0], &[]),
            None => who[..end].to_vec(),
        };
        (it || named).then(|| (i, subject, i + 1 + to))
    });
    match found {
        Some((i, subject, to)) => {
            let faces = led("should face", &tokens[i], &[&tokens[to..]]);
            [&tokens[..i], &subject, trimmed(&faces)].concat()
        }
        None => tokens,
    }
}
