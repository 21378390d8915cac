//! How far and in which way: "forward to 30 m", "by another 10 m", "twice as far", "push it 8 m away".

use super::super::tokens::{Token, TokenKind};
use super::words::{find, first_noun, is, is_unit, led, number, text, word};

/// "make the cyclist twice as far away": it should be so.
pub(super) fn far_times(tokens: Vec<Token>) -> Vec<Token> {
    let made = is(tokens.first(), &["make", "put", "set", "place", "move"]);
    let times = find(
        &tokens,
        &[
            "twice as far",
            "half as far",
            "three times as far",
            "double as far",
            "twice as close",
            "half as close",
        ],
    );
    match times.filter(|(i, _)| made && first_noun(&tokens[1..*i]).is_some_and(|n| 1 + n.1 == *i)) {
        Some((i, _)) => {
            let be = led("should be", &tokens[i], &[&tokens[i..]]);
            [&tokens[1..i], &be[..]].concat()
        }
        None => tokens,
    }
}

/// "push it 8 m away": by so much, not to there.
pub(super) fn pushed_away(tokens: Vec<Token>) -> Vec<Token> {
    let verb = tokens.iter().position(|t| {
        matches!(
            text(t),
            "push" | "move" | "shift" | "shove" | "pull" | "drag" | "nudge" | "send" | "drive"
        )
    });
    let found = verb.and_then(|v| {
        (v + 2..tokens.len()).find(|k| {
            is(tokens.get(*k), &["away"])
                && is_unit(tokens.get(k - 1))
                && tokens.get(k - 2).is_some_and(|t| number(t).is_some())
                && !is(tokens.get(k.wrapping_sub(3)), &["at", "to", "until", "is", "of"])
                && (tokens.get(k + 1).is_none_or(|t| t.kind != TokenKind::Word)
                    || is(tokens.get(k + 1), &["from", "and", "please"])
                        && !is(tokens.get(k + 2), &["the", "a", "it", "him", "her", "them"]))
        })
    });
    match found {
        Some(k) => {
            let mut out = tokens[..k].to_vec();
            out.push(word("further", &tokens[k]));
            out.extend_from_slice(&tokens[k..]);
            out
        }
        None => tokens,
    }
}

/// "by another 10 metres": by 10 metres.
pub(super) fn another_so_far(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let more = matches!(text(t), "another" | "further" | "extra")
            && tokens.get(i + 1).is_some_and(|n| number(n).is_some())
            && is_unit(tokens.get(i + 2));
        if !more {
            out.push(t.clone());
        }
    }
    out
}

/// "forward to thirty metres": so far away, not by so much.
pub(super) fn to_so_far(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let way = is(
            tokens.get(i),
            &[
                "forward",
                "forwards",
                "back",
                "backwards",
                "out",
                "up",
                "on",
                "ahead",
                "away",
                "in",
                "down",
            ],
        );
        let to = is(tokens.get(i + 1), &["to"])
            && tokens.get(i + 2).is_some_and(|t| number(t).is_some())
            && is_unit(tokens.get(i + 3));
        if way
            && to
            && !tokens[i + 4..]
                .iter()
                .take(2)
                .any(|t| is(Some(t), &["left", "right"]))
        {
            out.extend(led("at a distance of", &tokens[i], &[&tokens[i + 2..i + 4]]));
            i += 4;
        } else {
            out.push(tokens[i].clone());
            i += 1;
        }
    }
    out
}
