//! Who speaks and who is to see it: "mum says it is a bus", "my pupil shall see two cyclists", "I run a crane, so put one there".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::words::{find, first_noun, is, is_finite, led, text};

const SAYS: &str = "says|said|thinks|thought|reckons|reckoned|claims|claimed|insists|insisted|swears|swore|tells me|tells us|told me|told us|believes|believed|is sure|was sure|is certain|was certain|points out|pointed out|writes|wrote|keeps saying|keeps telling me|remembers|remembered";
const SEES: &str = "shall see|should see|must see|is to see|are to see|wants to see|want to see|has to see|have to see|needs to see|need to see|would like to see|ought to see|shall have|shall meet|should meet|is to meet|should encounter|shall encounter|is supposed to see|are supposed to see";
const HAS: &str = "i run|i own|i drive|i operate|i work with|i work on|we run|we own|we drive|we operate|i am in charge of|im in charge of|i hire out|we hire out|i rent out|we rent out|i sell|we sell|i work for|i teach";

/// A sentence without them.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    shown_to(own_trade(told_by(tokens)), talk)
}

fn comma(t: Option<&Token>) -> bool {
    t.is_some_and(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark))
}

/// "mum says it's a bus": it is.
fn told_by(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len().min(5)).find_map(|i| Some(i + begins(&tokens[i..], SAYS)?));
    let Some(end) = found else {
        return tokens;
    };
    let who = &tokens[..end];
    let plain = who.iter().all(|t| t.kind == TokenKind::Word)
        && !is(who.first(), &["it", "there", "what", "that", "i", "we"]);
    let end = end
        + usize::from(comma(tokens.get(end)) || is(tokens.get(end), &["that"]))
        + usize::from(comma(tokens.get(end)) && is(tokens.get(end + 1), &["that"]));
    // (what is said is a whole sentence)
    let rest = &tokens[end.min(tokens.len())..];
    let whole = is(rest.first(), &["its", "theres", "hes", "shes", "theyre", "thats"])
        || is(
            rest.first(),
            &[
                "it", "there", "he", "she", "they", "the", "a", "an", "that", "this", "both", "all", "two",
                "three", "one",
            ],
        ) && rest[1..]
            .iter()
            .any(|t| is_finite(text(t), true) || super::lists::HELPERS.contains(&text(t)));
    if plain && whole { rest.to_vec() } else { tokens }
}

/// "I run a crane, so put one there": what he runs is no part of the scene.
fn own_trade(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = begins(&tokens, HAS) else {
        return tokens;
    };
    let so = find(
        &tokens,
        &["so", "therefore", "thats why", "which is why", "hence"],
    )
    .filter(|x| x.0 > n && x.0 < n + 9 && comma(tokens.get(x.0 - 1)));
    match so {
        Some((i, so)) if first_noun(&tokens[n..i]).is_some_and(|x| x.0 < 4) => {
            let from = i + so + usize::from(comma(tokens.get(i + so)));
            tokens[from..].to_vec()
        }
        _ => tokens,
    }
}

/// "my pupil shall see two cyclists ahead": they should be there.
fn shown_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len().min(5)).find_map(|i| Some((i, i + begins(&tokens[i..], SEES)?)));
    let Some((i, end)) = found else {
        return tokens;
    };
    let who = &tokens[..i];
    let viewer = is(
        who.first(),
        &[
            "my", "our", "the", "we", "i", "you", "they", "every", "each", "all",
        ],
    ) && talk.fits(who) == 0;
    let thing = first_noun(&tokens[end..]).is_some_and(|x| x.0 < 5)
        && tokens.get(end).is_some_and(|t| {
            super::words::number(t).is_some() || is(Some(t), &["a", "an", "another", "some", "only", "just"])
        });
    if viewer && thing {
        led("there should be", &tokens[0], &[&tokens[end..]])
    } else {
        tokens
    }
}
