//! What colour something shall have, as a command: "the bus should be yellow", "give the taxi a blue coat of paint".

use super::super::coloured_ones::is_colour;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::HELPERS;
use super::some_of::bare_np;
use super::words::{begins, find, first_noun, has_noun, is, led, number, text};

/// Words between what is painted and its colour.
const BECOMES: [&str; 40] = [
    "may be",
    "can be",
    "could be",
    "might be",
    "should all be",
    "should both be",
    "should be",
    "must be",
    "shall be",
    "has to be",
    "have to be",
    "needs to be",
    "need to be",
    "ought to be",
    "is to be",
    "are to be",
    "to be",
    "is supposed to be",
    "would look better in",
    "looks better in",
    "should become",
    "becomes",
    "become",
    "turns",
    "turn",
    "should turn",
    "should have been",
    "has become",
    "have become",
    "has turned",
    "is",
    "are",
    "will be",
    "gets",
    "get",
    "should get",
    "be",
    "comes in",
    "shall become",
    "must become",
];

/// Words around a colour that say no more.
const BESIDE: [&str; 22] = [
    "now",
    "instead",
    "please",
    "all",
    "both",
    "painted",
    "repainted",
    "recoloured",
    "recolored",
    "coloured",
    "colored",
    "in",
    "a",
    "completely",
    "entirely",
    "rather",
    "bright",
    "dark",
    "light",
    "colour",
    "color",
    "one",
];

fn paints(np: &[Token], colour: &[Token]) -> Vec<Token> {
    // "two of the cars": any two
    let some = np.len() > 3 && number(&np[0]).is_some() && text(&np[1]) == "of";
    let any = if some {
        led("any", &np[0], &[&np[..1], bare_np(&np[2..]).as_slice()])
    } else {
        np.to_vec()
    };
    led("paint", &np[0], &[&any, &led("in", &colour[0], &[colour])])
}

/// A clause as "paint ... in ...", if it gives a colour to something that is there.
pub fn painted(clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    // "instead of red, the car should be white"
    let clause = match begins(clause, "instead of").or_else(|| begins(clause, "rather than")) {
        Some(n) if clause.get(n).is_some_and(is_colour) => super::words::trimmed(&clause[n + 1..]),
        _ => clause,
    };
    let (wished, mood) = super::frame::unwrapped(clause);
    made(clause, talk)
        .or_else(|| mood.framed.then(|| wished_in(wished, talk)).flatten())
        .or_else(|| given(clause, talk))
        .or_else(|| becomes(clause, talk))
}

/// "(I would like) the car behind me in red"
fn wished_in(clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let [np @ .., within, colour] = clause else {
        return None;
    };
    let known = is_colour(colour)
        && is(Some(within), &["in"])
        && is(np.first(), &["the", "that", "my", "both", "all"]);
    (known && has_noun(np) && talk.fits(np) > 0).then(|| paints(np, std::slice::from_ref(colour)))
}

/// "make the car behind me red", "have both cars painted white"
fn made(clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    if !is(
        clause.first(),
        &[
            "make", "turn", "have", "get", "let", "want", "like", "paint", "colour", "color",
        ],
    ) {
        return None;
    }
    let clause = without_others(&clause[1..]);
    let k = clause
        .iter()
        .rposition(is_colour)
        .filter(|k| k + 1 == clause.len())?;
    let around = |t: &Token| {
        is(Some(t), &BESIDE) || is_colour(t) || matches!(text(t), "to" | "be" | "into" | "become" | "turn")
    };
    let np = &clause[..clause[..k].iter().rposition(|t| !around(t))? + 1];
    let known = has_noun(np)
        && first_noun(np).is_some_and(|n| n.0 < 6)
        && !np.iter().any(|t| HELPERS.contains(&text(t)));
    (known && talk.fits(np) > 0).then(|| paints(np, &clause[k..]))
}

/// Without words after the colour, and without the colours that it shall not have: "white, not red", "not blue but red".
fn without_others(clause: &[Token]) -> Vec<Token> {
    let mut out = clause.to_vec();
    let tails: [&[&str]; 4] = [
        &["from", "now", "on"],
        &["from", "here", "on"],
        &["for", "a", "change"],
        &["this", "time"],
    ];
    for tail in tails {
        let at = out.len().saturating_sub(tail.len());
        if out[at..].iter().map(text).eq(tail.iter().copied()) {
            out.truncate(at);
        }
    }
    while is(
        out.last(),
        &["now", "instead", "please", "too", "again", "though", "as", "well"],
    ) {
        out.pop();
    }
    if let Some((i, n)) = find(
        &out,
        &["rather than", "instead of", "and not", "not", "no longer"],
    ) && i > 0
        && out.get(i + n).is_some_and(is_colour)
    {
        let but = (i + n..out.len()).find(|k| text(&out[*k]) == "but" || out[*k].kind == TokenKind::Comma);
        match but.filter(|b| *b + 1 < out.len()) {
            Some(b) => drop(out.drain(i..=b)),
            None => out.truncate(i),
        }
    }
    super::words::trimmed(&out).to_vec()
}

/// "the bus should be yellow", "both cars are to be painted black"
fn becomes(clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let clause = &without_others(clause)[..];
    let k = clause
        .iter()
        .rposition(is_colour)
        .filter(|k| k + 1 == clause.len())?;
    let mut from = k;
    while from > 0 && (is(clause.get(from - 1), &BESIDE) || is_colour(&clause[from - 1])) {
        from -= 1;
    }
    let helper = (1..from)
        .rev()
        .find(|i| super::words::leads(&clause[*i..from], &BECOMES) == Some(from - i))?;
    let helper = (1..=helper)
        .find(|i| super::words::leads(&clause[*i..from], &BECOMES) == Some(from - i))
        .unwrap_or(helper);
    let np = &clause[..helper];
    let pronoun = is(np.first(), &["it", "they", "them", "this", "that"]) && np.len() == 1;
    let known = has_noun(np) && !np.iter().any(|t| HELPERS.contains(&text(t))) && talk.fits(np) > 0;
    let np_of = match pronoun {
        true if talk.last.is_some() => super::words::led("it", &np[0], &[]),
        true => return None,
        false => np.to_vec(),
    };
    (pronoun || known).then(|| paints(&np_of, &clause[k..]))
}

/// "give the taxi a new coat of paint: blue", "give the bus a red livery"
fn given(clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    const COATS: [&str; 12] = [
        "coat of paint",
        "coats of paint",
        "paint job",
        "paint",
        "colour",
        "color",
        "livery",
        "lick of paint",
        "finish",
        "respray",
        "paintwork",
        "coat",
    ];
    if !is(clause.first(), &["give", "gets", "get"]) {
        return None;
    }
    let (coat, n) = find(clause, &COATS)?;
    let colour = clause.iter().rposition(is_colour)?;
    let article = (1..coat.min(colour))
        .rev()
        .find(|i| is(clause.get(*i), &["a", "an", "some", "another", "new"]))?;
    let np = super::words::trimmed(&clause[1..article]);
    let after = colour + 1 == clause.len() || colour < coat && coat + n == clause.len();
    (after && has_noun(np) && talk.fits(np) > 0).then(|| paints(np, &clause[colour..=colour]))
}

/// "whatever is red", "everything red": all red vehicles.
pub fn whatever(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = tokens
        .iter()
        .position(|t| matches!(text(t), "whatever" | "everything" | "anything"))
    else {
        return tokens;
    };
    let mut k = i + 1;
    while is(tokens.get(k), &["that", "which", "is", "thats", "are"]) {
        k += 1;
    }
    let colour = tokens.get(k).is_some_and(is_colour)
        && tokens
            .get(k + 1)
            .is_none_or(|t| first_noun(std::slice::from_ref(t)).is_none());
    if !colour {
        return tokens;
    }
    let all = led(
        "all",
        &tokens[i],
        &[&tokens[k..=k], &led("vehicles", &tokens[k], &[])],
    );
    [&tokens[..i], &all, &tokens[k + 1..]].concat()
}

/// Two things, each with its colour after it: "paint the cars white" and "the bus orange".
pub fn paired(before: &[Token], after: &[Token]) -> bool {
    let link = |t: &Token| t.kind == TokenKind::Comma || matches!(text(t), "and" | "but");
    let after = &after[..after.iter().position(link).unwrap_or(after.len())];
    [before, after].iter().all(|part| {
        let after_noun = first_noun(part).is_some_and(|n| n.1 < part.len());
        after_noun && part.last().is_some_and(is_colour)
    })
}

/// "(paint the cars white) and the bus orange": the verb again.
pub fn goes_on(clause: &[Token], before: &[Token]) -> bool {
    let painted = is(
        before.first(),
        &[
            "paint", "repaint", "recolour", "recolor", "colour", "color", "make", "turn", "respray",
        ],
    ) && before.iter().any(is_colour);
    painted
        && clause.last().is_some_and(is_colour)
        && has_noun(clause)
        && !is(clause.first(), &["paint", "make", "turn"])
}
