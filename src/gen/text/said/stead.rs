//! One thing for another, said in passing: "red car out, motorbike in", "where the bus is now I want to see a tanker", "an
//! ambulance follows us in place of the police car", "I would rather have barriers than cones".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, trimmed};

/// A sentence in which the one is replaced with the other.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let tokens = turned_both(tokens);
    in_and_out(&tokens, talk)
        .or_else(|| where_now(&tokens, talk))
        .or_else(|| follows_instead(&tokens, talk))
        .or_else(|| rather_than(&tokens, talk))
        .unwrap_or(tokens)
}

/// "replace the car with a bus".
fn replaced(old: &[Token], new: &[Token], rest: &[Token]) -> Vec<Token> {
    let at = &old[0];
    let the = !is(
        old.first(),
        &["the", "both", "all", "that", "those", "these", "my"],
    );
    let old = if the { led("the", at, &[old]) } else { old.to_vec() };
    led("replace", at, &[&old, &led("with", at, &[new]), rest])
}

/// True if the rest only says that number and place stay what they were: "the same number at the same edge of the road".
fn as_it_was(rest: &[Token]) -> bool {
    let rest = trimmed(rest);
    rest.is_empty()
        || leads(
            rest,
            &[
                "the same number",
                "same number",
                "the same amount",
                "same amount",
                "just as many",
                "as many",
                "equally many",
                "the same place",
                "same place",
                "in the same place",
                "at the same place",
                "in the same places",
                "same places",
                "same spots",
            ],
        )
        .is_some()
            && !rest
                .iter()
                .any(|t| is(Some(t), &["more", "then", "remove", "add", "put", "twice"]))
}

/// "red car out, parked motorbike in at its place", "cones away, barriers instead, the same number".
fn in_and_out(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (_, b) = first_noun(tokens).filter(|x| x.0 < 4)?;
    let out = b + leads(&tokens[b..], &["out", "away", "gone", "off", "out of it"])?;
    let old = &tokens[..b];
    let known = talk.fits(&led("the", &tokens[0], &[old])) > 0 || talk.fits(old) > 0;
    (known && !is(tokens.first(), &["a", "an", "no", "take", "put"])).then_some(())?;
    let link = tokens[out..]
        .iter()
        .take_while(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "then"]))
        .count();
    let new = &tokens[out + link..];
    let (_, e) = first_noun(new).filter(|x| link > 0 && x.0 < 4)?;
    is(new.first(), &["the", "no", "both", "all"])
        .eq(&false)
        .then_some(())?;
    let late = &new[e..];
    let n = usize::from(is(late.first(), &["in"]));
    let n = n + begins(
        &late[n..],
        "instead|in its place|at its place|in their place|at their place|on its place|in its stead|in their stead|in his place|in her place|for it|for them|there instead|in the same place|at the same place|in its spot",
    )
    .or((n == 1).then_some(0))?;
    as_it_was(&late[n..]).then(|| replaced(old, &new[..e], &[]))
}

/// "where there is the bus now, I want to see a tanker".
fn where_now(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    is(tokens.first(), &["where"]).then_some(())?;
    let n = 1 + leads(
        &tokens[1..],
        &[
            "there is",
            "theres",
            "there was",
            "there are",
            "you see",
            "we see",
            "i see",
            "we have",
            "i have",
            "now there is",
        ],
    )
    .unwrap_or(0);
    let comma = tokens.iter().position(|t| t.kind == TokenKind::Comma)?;
    let clause = &tokens[n..comma.max(n)];
    let (_, b) = first_noun(clause).filter(|x| x.0 < 4)?;
    is(clause.first(), &["the", "that", "those", "these", "my", "both"]).then_some(())?;
    let late = &clause[b..];
    // (a place of its own says which one; what the clause tells else is not this)
    let only = late.iter().all(|t| {
        is(
            Some(t),
            &[
                "is",
                "are",
                "now",
                "right",
                "at",
                "the",
                "moment",
                "stands",
                "currently",
                "drives",
                "parked",
                "standing",
                "driving",
                "was",
                "stood",
                "still",
                "sits",
                "waits",
                "present",
            ],
        )
    });
    let new = &tokens[comma + 1..];
    let ask = leads(
        new,
        &[
            "i want to see",
            "id like to see",
            "i would like to see",
            "i want",
            "i want to have",
            "id like",
            "i would like",
            "i need",
            "put",
            "place",
            "show",
            "show me",
            "there should be",
            "there shall be",
            "there must be",
            "let there be",
            "we want",
            "we need",
        ],
    )?;
    let new = &new[ask..];
    let (_, e) = first_noun(new).filter(|x| x.0 < 4)?;
    let fresh = is(new.first(), &["a", "an", "some"]) || super::words::number(new.first()?).is_some();
    let rest = &new[e..];
    let rest = if is(rest.first(), &["instead"]) {
        &rest[1..]
    } else {
        rest
    };
    let ends = rest
        .first()
        .is_none_or(|t| t.kind == TokenKind::Comma || is(Some(t), &["and"]));
    (only && fresh && ends && talk.fits(&clause[..b]) > 0).then(|| replaced(&clause[..b], &new[..e], rest))
}

const FOLLOWS: &str = "follow|follows|chase|chases|tail|tails|trail|trails|pursue|pursues|following|chasing|tailing|trailing|be following|be chasing|be behind|drive behind|ride behind|is following|is chasing|is behind|drives behind|rides behind|drive ahead of|drive in front of|ride ahead of|ride in front of|drives ahead of|drives in front of|precede|precedes|lead|leads";

/// "let an ambulance chase us in place of the police car".
fn follows_instead(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let from = leads(
        tokens,
        &["let", "have", "make", "i want", "id like", "i would like"],
    )
    .unwrap_or(0);
    let body = &tokens[from..];
    is(body.first(), &["a", "an"]).then_some(())?;
    let (_, b) = first_noun(body).filter(|x| x.0 < 4)?;
    let helper = leads(
        &body[b..],
        &[
            "is to",
            "should",
            "must",
            "shall",
            "has to",
            "will",
            "to",
            "ought to",
            "should now",
            "now",
        ],
    )
    .unwrap_or(0);
    let verb = b + helper;
    let us = verb + begins(&body[verb..], FOLLOWS)?;
    is(body.get(us), &["us", "me"]).then_some(())?;
    let rest = &body[us + 1..];
    let n = leads(
        rest,
        &[
            "in place of",
            "instead of",
            "in lieu of",
            "in the place of",
            "rather than",
        ],
    )?;
    let old = trimmed(&rest[n..]);
    let (_, e) = first_noun(old).filter(|x| x.0 < 4)?;
    let whole = e == old.len() || is_place(&old[e..]) && !has_noun(&old[e..]);
    (whole && is(old.first(), &["the", "that", "my"]) && talk.fits(old) > 0)
        .then(|| replaced(old, &body[..b], &[]))
}

/// "I'd rather have barriers than cones, the same number of them".
fn rather_than(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "have",
            "id rather have",
            "id rather see",
            "i would rather have",
            "i would rather see",
            "id sooner have",
            "id like to have",
            "rather",
            "see",
            "i prefer to see",
        ],
    )?;
    let new = &tokens[n..];
    let (_, b) = first_noun(new).filter(|x| x.0 < 3)?;
    let than = b + leads(&new[b..], &["than", "rather than"])?;
    let old = &new[than..];
    let (_, e) = first_noun(old).filter(|x| x.0 < 3)?;
    let all = led("the", &tokens[0], &[&old[..e]]);
    let fits = talk.fits(&all) > 0 || talk.fits(&old[..e]) > 0;
    let fresh = !is(new.first(), &["the", "more", "fewer", "less", "another"]);
    // ("a van than a bus": the bus)
    let old = &old[usize::from(is(old.first(), &["a", "an"]))..e];
    let rest = trimmed(&tokens[n + than + e..]);
    // ("and close to the digger as well": told anew)
    let near = rest.iter().position(|t| is(Some(t), &["and"])).filter(|k| {
        let place = &rest[k + 1..];
        is_place(place)
            && has_noun(place)
            && as_it_was(&rest[..*k])
            && is(place.last(), &["well", "too", "again"])
    });
    let count = talk.boxes_of(&all).len();
    if let (Some(k), true) = (near, fits && fresh && count > 1) {
        let end = rest.len() - if is(rest.last(), &["well"]) { 2 } else { 1 };
        let at = &tokens[0];
        let many = Token {
            kind: TokenKind::Number(count as f64),
            ..super::words::word(&count.to_string(), at)
        };
        let add = led(
            "and add",
            at,
            &[std::slice::from_ref(&many), &new[..b], &rest[k + 1..end]],
        );
        return Some(led("remove", at, &[&all, &add]));
    }
    (fits && fresh && as_it_was(rest)).then(|| replaced(old, &new[..b], &[]))
}

/// "turn the snow into rain and the cyclist into a moped rider": turned is the other, too.
fn turned_both(tokens: Vec<Token>) -> Vec<Token> {
    const TURNS: &[&str] = &["turn", "change", "make", "transform", "convert"];
    if !is(tokens.first(), TURNS) {
        return tokens;
    }
    let Some(first) = find(&tokens, &["into", "to"]).filter(|x| x.0 > 1 && x.0 < 6) else {
        return tokens;
    };
    rewritten(&tokens, |i, out| {
        let the = is(tokens.get(i + 1), &["the", "that", "both", "all", "those", "my"]);
        (i > first.0 && is(tokens.get(i), &["and"]) && the).then_some(())?;
        let (_, b) = first_noun(&tokens[i + 1..]).filter(|x| x.0 < 4)?;
        let link = &tokens[first.0];
        (tokens.get(i + 1 + b)?.text == link.text).then_some(())?;
        let sky = !has_noun(&tokens[1..first.0]);
        sky.then(|| {
            out.push(Token {
                kind: TokenKind::Comma,
                ..super::words::word(",", &tokens[i])
            });
            out.extend(led(&tokens[0].text, &tokens[i], &[]));
            i + 1
        })
    })
}
