//! Steps and distances in roundabout words: "8 m back towards us", "pull forward by ten metres", "gain 5 m", "put it 30 m ahead",
//! "not 25 m ahead but 17".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, replaced, rewritten};
use super::Talk;
use super::headway::{is_mark, measure};
use super::lists::List;
use super::words::{find, first_noun, has_noun, is, leads, led, number, text, unit_at};
use std::sync::LazyLock;

/// A sentence (without its stop) with its steps in plain words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(
        &tokens,
        "i would have expected|i expected|we expected|we would have expected|id have expected|id expect|i would expect|i had expected",
        "i want",
    );
    of_us(forward(towards(not_but(gained(out))), talk))
}

/// "8 m back towards us", "back in our direction by 8 m": 8 m closer.
fn towards(tokens: Vec<Token>) -> Vec<Token> {
    const US: &str = "towards us|toward us|towards me|toward me|towards the ego vehicle|toward the ego vehicle|\
        towards our car|towards my car|in our direction|in my direction|in the direction of us|to us|to me|our way|\
        in the direction of the ego vehicle|towards ego|toward ego|in the ego direction|in the direction of our car";
    rewritten(&tokens, |i, out| {
        let by = usize::from(is(tokens.get(i), &["by"]));
        // (metres first, or the way first)
        let far = |k: usize| measure(&tokens[k..]).filter(|m| m.0 == 0).map(|m| k + m.1);
        let way = |k: usize| {
            let back = usize::from(is(
                tokens.get(k),
                &["back", "closer", "nearer", "over", "further", "up"],
            ));
            begins(tokens.get(k + back..)?, US).map(|n| k + back + n)
        };
        let closes = |k: usize| {
            tokens
                .get(k)
                .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "please", "now", "so"]))
        };
        let (metres, end) = match far(i + by) {
            Some(k) => (&tokens[i + by..k], way(k)?),
            None => {
                let k = way(i)?;
                let by = k + usize::from(is(tokens.get(k), &["by", "for"]));
                let k = far(by)?;
                (&tokens[by..k], k)
            }
        };
        // ("so that it faces 8 m towards us" is nothing that anybody says)
        closes(end).then_some(())?;
        out.extend_from_slice(metres);
        out.extend(led("closer", &tokens[i], &[]));
        Some(end)
    })
}

/// "let the taxi gain ten metres", "give the taxi a lead of 25 m": so far on, so far ahead.
fn gained(tokens: Vec<Token>) -> Vec<Token> {
    const GAINS: &[&str] = &[
        "gain",
        "gains",
        "gained",
        "gain another",
        "gains another",
        "has gained",
        "make up",
        "pull away by",
    ];
    let out = rewritten(&tokens, |i, out| {
        let n = leads(&tokens[i..], GAINS).filter(|_| has_noun(out))?;
        let (a, b) = measure(&tokens[i + n..]).filter(|m| m.0 == 0)?;
        let end = i + n + b;
        let closes = tokens
            .get(end)
            .is_none_or(|t| is_mark(t) || is(Some(t), &["and", "on"]));
        closes.then(|| {
            out.extend(led("move", &tokens[i], &[&tokens[i + n + a..end]]));
            out.extend(led("further ahead", &tokens[i], &[]));
            let us = leads(&tokens[end..], &["on us", "on me"]).unwrap_or(0);
            end + us
        })
    });
    let lead = find(
        &out,
        &["a lead of", "a head start of", "the lead of", "a headway of"],
    );
    let Some((i, n)) = lead.filter(|_| is(out.first(), &["give", "the", "that", "let", "allow", "grant"]))
    else {
        return out;
    };
    let from = usize::from(is(out.first(), &["give", "let", "allow", "grant"]));
    let Some((_, b)) = first_noun(&out[from..i]).filter(|x| x.0 < 4) else {
        return out;
    };
    match measure(&out[i + n..]).filter(|m| m.0 == 0 && i + n + m.1 == out.len()) {
        Some(_) => [
            &out[from..from + b],
            &led("should be", &out[i], &[&out[i + n..]]),
            &led("ahead of us", &out[i], &[]),
        ]
        .concat(),
        None => out,
    }
}

/// "pull forward by ten metres", "moves up 5 m": so far the way it faces.
fn forward(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const GOES: &str = "pull|pulls|pulled|move|moves|moved|drive|drives|drove|driven|roll|rolls|rolled|go|goes|went|gone|come|comes|came|walk|walks|walked|ride|rides|rode|ridden|advance|advances|advanced|edge|creep|inch|step|steps|stepped|run|runs";
    const ON: &str = "forward by|forward for|forward|forwards by|forwards|ahead by|ahead for|ahead|up by|up|on by|on for|on|onward|onwards by|onwards|along for|along by|further on by|further on";
    rewritten(&tokens, |i, out| {
        begins(&tokens[i..], GOES)?;
        let n = 1 + begins(&tokens[i + 1..], ON)?;
        let n = n + usize::from(is(tokens.get(i + n), &["another", "about"]));
        let (a, b) = measure(&tokens[i + n..]).filter(|m| m.0 == 0)?;
        let end = i + n + b;
        let closes = tokens
            .get(end)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "please", "now", "so"]));
        let (x, y) = first_noun(out)?;
        closes.then_some(())?;
        let the = x - usize::from(x > 0);
        let against = talk.only(&out[the..y]).is_some_and(|b| b.heading().x < -0.5);
        out.push(tokens[i].clone());
        out.extend_from_slice(&tokens[i + n + a..end]);
        out.extend(led(
            if against { "further back" } else { "further ahead" },
            &tokens[i],
            &[],
        ));
        Some(end)
    })
}

/// "put it 30 m ahead", "truck: 30 m ahead", "I'd expect the truck 30 m ahead": ahead of us, and no step.
fn of_us(tokens: Vec<Token>) -> Vec<Token> {
    static PUTS: List = LazyLock::new(|| {
        "\
        put|place|set|want|expect|expected|need|like|have|position|:|prefer"
            .split('|')
            .collect()
    });
    let steps = is(
        tokens.first(),
        &[
            "move", "shift", "push", "pull", "bring", "drive", "send", "take", "get", "make",
        ],
    ) || tokens
        .iter()
        .any(|t| is(Some(t), &["further", "farther", "more", "another", "moves", "by"]));
    let puts = tokens.iter().position(|t| PUTS.contains(&text(t)));
    let Some(puts) = puts.filter(|_| !steps) else {
        return tokens;
    };
    rewritten(&tokens, |i, out| {
        let (a, b) = measure(&tokens[i..]).filter(|m| m.0 == 0 && i > puts)?;
        let way = match text(tokens.get(i + b)?) {
            "ahead" => "ahead of us",
            "behind" => "behind us",
            _ => return None,
        };
        let closes = tokens
            .get(i + b + 1)
            .is_none_or(|t| is_mark(t) || is(Some(t), &["and", "please", "now", "instead"]));
        closes.then(|| {
            out.extend_from_slice(&tokens[i + a..i + b]);
            out.extend(led(way, &tokens[i], &[]));
            i + b + 1
        })
    })
}

/// "must not be 25 m ahead but only 17": must be 17 m ahead.
fn not_but(tokens: Vec<Token>) -> Vec<Token> {
    // "30 m ahead, not 20"
    let late = (3..tokens.len()).find(|i| {
        is(tokens.get(*i), &["not", "instead", "rather"])
            && leads(&tokens[*i..], &["not", "and not", "instead of", "rather than"]).is_some_and(|n| {
                tokens.get(i + n).is_some_and(|t| number(t).is_some())
                    && i + n + 1 + unit_at(&tokens[i + n + 1..]).unwrap_or(0) == tokens.len()
            })
            && measure(&tokens[..*i]).is_some_and(|m| super::words::is_place(&tokens[m.1..*i]))
    });
    if let Some(late) = late {
        return super::words::trimmed(&tokens[..late]).to_vec();
    }
    let found = (0..tokens.len()).find_map(|i| {
        let not = is(tokens.get(i), &["not", "mustnt", "shouldnt", "isnt"]).then_some(i)?;
        let (a, b) = measure(&tokens[not + 1..]).filter(|m| m.0 < 3)?;
        let (a, b) = (not + 1 + a, not + 1 + b);
        let but = (b..tokens.len().min(b + 8)).find(|k| is(tokens.get(*k), &["but"]))?;
        let k = but
            + 1
            + leads(
                &tokens[but + 1..],
                &["only", "just", "rather", "at least", "instead"],
            )
            .unwrap_or(0);
        number(tokens.get(k)?)?;
        let unit = unit_at(&tokens[k + 1..]).unwrap_or(0);
        let rest = &tokens[k + 1 + unit..];
        let ends = rest.is_empty() || unit == 0 && super::words::is_place(rest) && but == b;
        ends.then_some((not, a, b, but, k, unit))
    });
    let Some((not, a, b, but, k, unit)) = found else {
        return tokens;
    };
    let helper = match text(&tokens[not]) {
        "mustnt" => led("must", &tokens[not], &[]),
        "shouldnt" => led("should", &tokens[not], &[]),
        "isnt" => led("should be", &tokens[not], &[]),
        _ => Vec::new(),
    };
    [
        &tokens[..not],
        &helper,
        &tokens[not + 1..a],
        std::slice::from_ref(&tokens[k]),
        &tokens[a + 1..b],
        &tokens[b..but],
        &tokens[k + 1 + unit..],
    ]
    .concat()
}
