//! Questions: most change nothing, "how would it look at night?" does.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::Token;
use super::frame::unwrapped;
use super::words::{first_noun, is, leads, led, text};
use super::{Piece, Talk, remembered};

/// "why is the cyclist in front of me?" changes nothing; who it speaks of is remembered.
pub(super) fn question(body: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let (inner, _) = unwrapped(body);
    let first = inner.first()?;
    let asks = matches!(
        text(first),
        "why"
            | "where"
            | "wheres"
            | "who"
            | "whos"
            | "whose"
            | "when"
            | "is"
            | "are"
            | "does"
            | "do"
            | "did"
            | "was"
            | "were"
            | "has"
            | "have"
            | "which"
    ) || text(first) == "how" && !is(inner.get(1), &["about"])
        || text(first) == "what" && !is(inner.get(1), &["if", "about"]);
    let begun = matches!(
        text(&body[0]),
        "why" | "where" | "wheres" | "who" | "whos" | "does" | "is" | "are" | "did"
    );
    // "how would the street look at midday?": so it shall
    let looks = (text(first) == "how" || text(first) == "what")
        && body
            .iter()
            .any(|t| matches!(text(t), "look" | "looks" | "like" | "appear" | "be"));
    if looks
        && let Some(at) = (1..body.len())
            .find(|i| matches!(look_up(text(&body[*i])), Some(Sense::Weather(_) | Sense::Time(_))))
    {
        let from = (0..at)
            .rev()
            .find(|i| is(body.get(*i), &["at", "in", "by", "with", "during", "on", "under"]))
            .map_or(at, |i| i + 1);
        return Some(vec![Piece::Plain(led("make it", &body[0], &[&body[from..]]))]);
    }
    if !(asks || begun)
        || is(body.get(1), &["not", "dont"])
        || leads(
            body,
            &[
                "is it possible",
                "is there any way",
                "is there a way",
                "have the",
                "have a",
                "do you mind",
                "do you think you could",
            ],
        )
        .is_some()
    {
        return None;
    }
    let mut out = Vec::new();
    if let Some((a, b)) = first_noun(body) {
        let lead = (0..a)
            .rev()
            .take_while(|i| matches!(text(&body[*i]), "the" | "my" | "that" | "this"))
            .last()
            .or((talk.fits(&body[a..b]) > 0).then_some(a));
        if let Some(lead) = lead {
            out.push(remembered(&body[lead..b], talk));
        }
    }
    Some(out)
}
