//! What comes into the scene and what is left behind: "bring a police car up behind me" where there is none, "I have just passed
//! the cyclist", "I am 10 m ahead of the truck".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::gifts::begins_at;
use super::words::{first_noun, is, is_place, is_unit, leads, led, number, text, trimmed};

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    passed(seen_from(brought(tokens, talk), talk), talk)
}

/// "bring a police car up behind me", where there is none: it is put in.
fn brought(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        (is(
            tokens.get(i),
            &["bring", "send", "drive", "roll", "move", "steer", "pull"],
        ) && begins_at(&tokens, i))
        .then_some(())?;
        let way = |k: usize| {
            let n = leads(
                tokens.get(k..)?,
                &["up", "in", "over", "along", "forward", "on", "here"],
            )?;
            // ("in behind me", but not "in my lane")
            let next = tokens.get(k + n);
            let goes_on = next.is_none_or(|t| t.kind != TokenKind::Word)
                || is(next, &["a", "an", "another"])
                || is(
                    next,
                    &[
                        "behind",
                        "ahead",
                        "beside",
                        "next",
                        "in",
                        "on",
                        "to",
                        "at",
                        "between",
                        "alongside",
                    ],
                )
                || next.is_some_and(|t| number(t).is_some());
            goes_on.then_some(n)
        };
        let particle = way(i + 1).unwrap_or(0);
        let np = tokens.get(i + 1 + particle..)?;
        let new = is(np.first(), &["a", "an", "another"]) || np.first().is_some_and(|t| number(t).is_some());
        let (_, b) = first_noun(np).filter(|x| new && x.0 < 4)?;
        // ("two of the lads" are there, whatever they are called)
        let of = is(np.get(1), &["of"]) && is(np.get(2), &["the", "those", "these", "our", "my"]);
        (!of && talk.has_none(&np[..b])).then_some(())?;
        let end = i + 1 + particle + b;
        let after = way(end).unwrap_or(0);
        let mut rest = end + after;
        // ("up to the left edge of the road" is at it)
        let to = leads(&tokens[rest..], &["to", "into", "onto", "up to", "over to"])
            .filter(|n| !is(tokens.get(rest + n + 1), &["left", "right"]) || is_strip(&tokens[rest + n..]));
        let at = to.map(|n| {
            rest += n;
            led(
                if is_lane(&tokens[rest..]) { "in" } else { "on" },
                &tokens[i],
                &[],
            )
        });
        (at.is_some() || tokens.get(rest..).is_some_and(is_place)).then(|| {
            let add = led("add", &tokens[i], &[&np[..b]]);
            [&tokens[..i], &add, &at.unwrap_or_default(), &tokens[rest..]].concat()
        })
    });
    found.unwrap_or(tokens)
}

/// A strip or lane is named before anything else.
fn is_strip(tokens: &[Token]) -> bool {
    tokens.iter().take(4).any(|t| {
        matches!(
            text(t),
            "lane"
                | "edge"
                | "kerb"
                | "curb"
                | "sidewalk"
                | "pavement"
                | "roadside"
                | "shoulder"
                | "footpath"
                | "verge"
        )
    })
}

fn is_lane(tokens: &[Token]) -> bool {
    tokens.iter().take(4).any(|t| {
        matches!(
            text(t),
            "lane" | "lanes" | "junction" | "intersection" | "roundabout"
        )
    })
}

/// The words for who drives the ego vehicle, with what is done: one past them.
fn ego_does(tokens: &[Token], verbs: &[&str]) -> Option<usize> {
    let i = leads(
        tokens,
        &["i", "we", "ive", "weve", "the ego vehicle", "the ego car"],
    )?;
    let mut k = i;
    while is(
        tokens.get(k),
        &["have", "has", "had", "just", "now", "already", "only"],
    ) {
        k += 1;
    }
    leads(&tokens[k..], verbs).map(|n| k + n)
}

fn known(np: &[Token], talk: &Talk<'_>) -> Option<usize> {
    let the = is(
        np.first(),
        &["the", "that", "both", "this", "those", "these", "all"],
    );
    let (_, b) = first_noun(np).filter(|x| the && x.0 < 4)?;
    (talk.fits(&np[..b]) > 0).then_some(b)
}

/// "I have just passed the cyclist, so he is now 10 m behind me": the cyclist is there.
fn passed(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const PASS: &[&str] = &[
        "passed",
        "overtaken",
        "overtook",
        "went past",
        "gone past",
        "driven past",
        "drove past",
        "got past",
        "left behind",
        "come past",
        "pulled past",
    ];
    let from = leads(&tokens, &["now", "meanwhile", "by now", "in the meantime"]).unwrap_or(0);
    let Some(n) = ego_does(&tokens[from..], PASS).map(|n| from + n) else {
        return tokens;
    };
    let Some(b) = known(&tokens[n..], talk) else {
        return tokens;
    };
    let np = &tokens[n..n + b];
    let mut k = n + b;
    while tokens.get(k).is_some_and(|t| t.kind == TokenKind::Comma)
        || is(tokens.get(k), &["so", "and", "which", "who", "that"])
    {
        k += 1;
    }
    let rest = &tokens[k..];
    if rest.is_empty() {
        let many = is(np.first(), &["both", "those", "these", "all"]);
        let behind = led(
            if many { "are behind me" } else { "is behind me" },
            &tokens[0],
            &[],
        );
        return [np, &behind].concat();
    }
    let again = leads(rest, &["it", "he", "she", "they", "this one", "that one"]).unwrap_or(0);
    let is_now = is(
        rest.get(again),
        &["is", "are", "should", "must", "has", "drives", "rides", "follows"],
    ) || leads(rest, &["hes", "shes", "its", "theyre"]).is_some();
    if !is_now {
        return tokens;
    }
    let short = usize::from(again == 0 && leads(rest, &["hes", "shes", "its", "theyre"]).is_some());
    let verb = led("is", &tokens[0], &[]);
    [np, &verb[..short], &rest[again.max(short)..]].concat()
}

/// "I am 10 m ahead of the truck": the truck is 10 m behind me.
fn seen_from(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let from = leads(&tokens, &["now", "then", "meanwhile", "by now"]).unwrap_or(0);
    let Some(mut n) = leads(
        &tokens[from..],
        &["i am", "we are", "im", "i should be", "we should be"],
    )
    .map(|n| from + n) else {
        return tokens;
    };
    while is(tokens.get(n), &["now", "just", "only", "about", "driving"]) {
        n += 1;
    }
    let metres = if tokens.get(n).is_some_and(|t| number(t).is_some()) && is_unit(tokens.get(n + 1)) {
        2
    } else {
        0
    };
    let at = n + metres;
    let way = leads(&tokens[at..], &["ahead of", "in front of", "behind", "after"]);
    let Some((m, b)) = way.and_then(|m| Some((m, known(&tokens[at + m..], talk)?))) else {
        return tokens;
    };
    let end = at + m + b;
    if metres == 0 || !trimmed(&tokens[end..]).is_empty() {
        return tokens;
    }
    let behind = is(tokens.get(at), &["ahead", "in"]);
    let is_ = led("should be", &tokens[0], &[&tokens[n..at]]);
    let there = led(if behind { "behind me" } else { "ahead of me" }, &tokens[0], &[]);
    [&tokens[at + m..end], &is_, &there].concat()
}
