//! What prompts and edits carry over within a sentence: "one child ahead and two others on the left", "people walk across it",
//! "closed 22 m ahead by three barriers", "I'm stuck in my lane behind a lorry".

use super::lexicon::{Sense, look_up, plural};
use super::said::words::{find, first_noun, is, is_unit, leads, led, number};
use super::tokens::{Token, TokenKind};

/// A text in plainer words.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    let out = after_crash(that_one_another(tokens));
    let out = closed_by(out);
    let out = stuck_behind(out);
    across_it(others(out))
}

fn stop_before(tokens: &[Token], i: usize) -> usize {
    tokens[..i]
        .iter()
        .rposition(|t| t.kind == TokenKind::Stop)
        .map_or(0, |k| k + 1)
}

/// "a car behind me and behind that one another": behind it another car.
fn that_one_another(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "that one another",
            "that one a second",
            "that one there is another",
            "that one is another",
            "that one yet another",
        ],
    )
    .filter(|x| x.0 > 1) else {
        return tokens;
    };
    let from = stop_before(&tokens, i);
    let ends = tokens
        .get(i + n)
        .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["one", "and"]));
    let Some((a, b)) = first_noun(&tokens[from..i]).filter(|_| ends) else {
        return tokens;
    };
    let one = usize::from(is(tokens.get(i + n), &["one"]));
    let more = led("it another", &tokens[i], &[&tokens[from + a..from + b]]);
    [&tokens[..i], &more, &tokens[i + n + one..]].concat()
}

/// "after a crash two cars stand there": two cars stand there.
fn after_crash(tokens: Vec<Token>) -> Vec<Token> {
    const LEADS: &[&str] = &[
        "after a crash",
        "after an accident",
        "after a collision",
        "following a crash",
        "following an accident",
        "following a collision",
        "after a minor crash",
        "after a minor accident",
        "after the crash",
        "after the accident",
        "after the collision",
        "due to a crash",
        "due to an accident",
        "because of a crash",
        "because of an accident",
    ];
    let Some((i, n)) = find(&tokens, LEADS).filter(|x| stop_before(&tokens, x.0) == x.0) else {
        return tokens;
    };
    let comma = usize::from(tokens.get(i + n).is_some_and(|t| t.kind == TokenKind::Comma));
    let rest = &tokens[i + n + comma..];
    if first_noun(rest).is_none_or(|x| x.0 > 4) {
        return tokens;
    }
    [&tokens[..i], rest].concat()
}

/// "closed 22 m ahead by three barriers": closed by three barriers 22 m ahead.
fn closed_by(tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "closed off",
                "closed",
                "blocked off",
                "blocked",
                "obstructed",
                "barred",
                "shut",
                "cordoned off",
            ],
        )?;
        let at = i + n + usize::from(is(tokens.get(i + n), &["about", "at"]));
        (number(tokens.get(at)?).is_some() && is_unit(tokens.get(at + 1))).then_some(())?;
        let by = (at + 2..tokens.len().min(at + 6)).find(|k| is(tokens.get(*k), &["by", "with"]))?;
        let plain = tokens[at + 2..by].iter().all(|t| {
            is(
                Some(t),
                &["ahead", "away", "of", "us", "me", "in", "front", "further", "on"],
            )
        });
        let (_, b) = first_noun(&tokens[by + 1..]).filter(|x| plain && x.0 < 4)?;
        Some((i + n, at, by, by + 1 + b))
    });
    match found {
        Some((from, at, by, end)) => {
            [&tokens[..from], &tokens[by..end], &tokens[at..by], &tokens[end..]].concat()
        }
        None => tokens,
    }
}

/// "I'm stuck in my lane behind a lorry": a lorry ahead of me in my lane.
fn stuck_behind(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "im", "i am", "we are", "were", "i stand", "we stand", "i wait", "we wait",
        ],
    ) else {
        return tokens;
    };
    let stuck = usize::from(is(
        tokens.get(i + n),
        &[
            "stuck", "waiting", "standing", "stopped", "held", "queueing", "queuing", "caught",
        ],
    ));
    let Some(m) = leads(
        &tokens[i + n + stuck..],
        &[
            "in my lane behind",
            "in our lane behind",
            "in our own lane behind",
            "in my own lane behind",
        ],
    ) else {
        return tokens;
    };
    let from = i + n + stuck + m;
    let Some((_, b)) = first_noun(&tokens[from..]).filter(|x| x.0 < 4 && is(tokens.get(from), &["a", "an"]))
    else {
        return tokens;
    };
    let at = led("is ahead of me in my lane", &tokens[i], &[]);
    [&tokens[..i], &tokens[from..from + b], &at, &tokens[from + b..]].concat()
}

/// "one child in our lane and two others on the left": two other children.
fn others(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (1..tokens.len()).find(|i| {
        is(tokens.get(*i), &["others"])
            && number(&tokens[i - 1]).is_some()
            && !(*i > 1 && is(tokens.get(i - 2), &["the", "of", "these", "those"]))
    }) else {
        return tokens;
    };
    let from = stop_before(&tokens, i);
    let Some((a, b)) = first_noun(&tokens[from..i]) else {
        return tokens;
    };
    let mut noun = tokens[from + a..from + b].to_vec();
    if let Some(last) = noun.last_mut()
        && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
    {
        last.text = plural(&last.text);
    }
    let other = led("other", &tokens[i], &[&noun]);
    [&tokens[..i], &other, &tokens[i + 1..]].concat()
}

/// "a bus waits at the zebra because four people walk across it": across the zebra.
fn across_it(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["across it", "over it"]) else {
        return tokens;
    };
    let from = stop_before(&tokens, i);
    let named = find(
        &tokens[from..i],
        &["zebra crossing", "pedestrian crossing", "crosswalk", "zebra"],
    );
    let people = tokens[from..i]
        .iter()
        .rev()
        .take(5)
        .any(|t| matches!(look_up(&t.text), Some(Sense::Noun(k, _)) if k.classes[0] == crate::scene::Class::Pedestrian));
    match named.filter(|_| people) {
        Some((k, m)) => {
            let the = led("the", &tokens[i], &[&tokens[from + k..from + k + m]]);
            [&tokens[..=i], &the, &tokens[i + n..]].concat()
        }
        None => tokens,
    }
}
