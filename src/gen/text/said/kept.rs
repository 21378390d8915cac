//! Some of a group are kept and the others go, said as two: "of the three pedestrians keep one on the right and erase the other
//! two". Read one after the other the second would take what was never spoken of.

use super::super::lexicon::{Sense, look_up, plural};
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::some_of::{bare_np, removes};
use super::words::{first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

const KEEPS: &[&str] = &["keep", "leave", "retain", "spare", "preserve", "save"];
const OTHERS: &[&str] = &[
    "the other",
    "the others",
    "the other one",
    "the other ones",
    "the rest",
    "the rest of them",
    "the remaining",
    "the remaining ones",
    "the remaining one",
    "the second",
    "the third",
    "the fourth",
    "the fifth",
    "the second one",
    "the third one",
    "the fourth one",
];
const GO: &[&str] = &[
    "go",
    "goes",
    "leave",
    "leaves",
    "disappear",
    "disappears",
    "vanish",
    "vanishes",
    "removed",
    "deleted",
    "erased",
    "gone",
];
const BETWEEN: &[&str] = &[
    "can", "may", "should", "shall", "must", "have", "has", "to", "be", "is", "are", "away", "out", "off",
    "please", "now", "then", "from", "the", "scene", "picture",
];

/// A sentence that says how many of a group stay.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((close, end)) = others_go(&tokens) else {
        return so_leave(tokens, talk);
    };
    let head = trimmed(&tokens[..close]);
    match group_first(head).or_else(|| number_first(head)) {
        Some((many, np, place)) if talk.fits(&np) > 0 => {
            let kept = kept(&many, &np, &place, talk);
            [&kept[..], &tokens[end..]].concat()
        }
        _ => tokens,
    }
}

/// "and erase the other two", "and the other one should go": where it begins and ends.
fn others_go(tokens: &[Token]) -> Option<(usize, usize)> {
    (3..tokens.len()).find_map(|i| {
        let link = tokens[i].kind == TokenKind::Comma || is(tokens.get(i), &["and", "but", "while"]);
        link.then_some(())?;
        let mut k = i + 1;
        while is(tokens.get(k), &["and", "but", "then", "please"]) {
            k += 1;
        }
        let orders = removes(tokens.get(k)) || is(tokens.get(k), &["get", "throw", "do"]);
        if orders {
            k += 1;
            while is(tokens.get(k), &["out", "away", "off", "rid", "of", "with"]) {
                k += 1;
            }
        }
        k += leads(&tokens[k..], OTHERS)?;
        k += usize::from(tokens.get(k).is_some_and(|t| number(t).is_some()));
        k += usize::from(is(tokens.get(k), &["ones"]));
        let from = k;
        while is(tokens.get(k), BETWEEN) || is(tokens.get(k), GO) {
            k += 1;
        }
        let goes = orders || tokens[from..k].iter().any(|t| is(Some(t), GO));
        let closed = tokens
            .get(k)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and"]));
        (goes && closed).then_some((i, k))
    })
}

/// "two of the parked cars are away, so leave only three": three of them.
fn so_leave(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let few = tokens.first().is_some_and(|t| number(t).is_some()) && is(tokens.get(1), &["of"]);
    let Some((_, b)) = first_noun(&tokens).filter(|x| few && x.0 < 7) else {
        return tokens;
    };
    let np = bare_np(&tokens[2..b]);
    let found = (b + 1..tokens.len()).find_map(|i| {
        let link = tokens[i].kind == TokenKind::Comma || is(tokens.get(i), &["so", "and", ":"]);
        let mut k = i + 1;
        while is(tokens.get(k), &["so", "and", "please", "therefore", "just"]) {
            k += 1;
        }
        let keeps = link && is(tokens.get(k), KEEPS);
        k += 1 + usize::from(is(tokens.get(k + 1), &["only", "just", "exactly"]));
        let many = tokens.get(k).filter(|t| keeps && number(t).is_some())?;
        let rest = &tokens[k + 1..];
        let closed = rest
            .iter()
            .all(|t| is(Some(t), &["of", "them", "there", "please", "in", "place", "here"]));
        closed.then(|| many.clone())
    });
    // (those of which all these are: "parked" may not be said of each of them)
    let a = first_noun(&np).map_or(0, |x| x.0);
    let sum = |many: &Token| number(&tokens[0]).unwrap_or(0) + number(many).unwrap_or(0);
    let np = match &found {
        Some(many) if talk.fits(&np) as i64 != sum(many) && talk.fits(&np[a..]) as i64 == sum(many) => {
            np[a..].to_vec()
        }
        _ => np,
    };
    match found.filter(|many| talk.fits(&np) as i64 >= number(many).unwrap_or(0)) {
        Some(many) => led("keep exactly", &tokens[0], &[&[many], &np]),
        None => tokens,
    }
}

type Kept = (Token, Vec<Token>, Vec<Token>);

/// "of the three pedestrians keep one on the right sidewalk", "of the three pedestrians two may stay".
fn group_first(head: &[Token]) -> Option<Kept> {
    let n = leads(head, &["of", "out of", "from", "among", "from among"])?;
    is(head.get(n), &["the", "these", "those", "my", "our", "all"]).then_some(())?;
    let (_, b) = first_noun(&head[n..]).filter(|x| x.0 < 5)?;
    let mut from = n + b;
    // (where the group is told from others: "the cars on the right keep one")
    let verb = (from..head.len()).find(|k| {
        is(head.get(*k), KEEPS) || head[*k].kind == TokenKind::Comma || number(&head[*k]).is_some()
    })?;
    let np = bare_np(&head[n..verb]);
    from = verb;
    while head.get(from).is_some_and(|t| t.kind == TokenKind::Comma)
        || is(head.get(from), &["please", "only", "just"])
        || is(head.get(from), KEEPS)
    {
        from += 1;
    }
    let many = head.get(from).filter(|t| number(t).is_some())?.clone();
    let rest = trimmed(&head[from + 1..]);
    let stays = leads(
        rest,
        &[
            "may stay",
            "can stay",
            "should stay",
            "must stay",
            "shall stay",
            "stays",
            "stay",
            "remains",
            "remain",
            "may remain",
            "can remain",
            "should remain",
            "is to stay",
            "are to stay",
            "of them",
        ],
    )
    .unwrap_or(0);
    placed(&rest[stays..]).map(|place| (many, np, place))
}

/// "keep one of the three pedestrians", "leave two of the cones in our lane".
fn number_first(head: &[Token]) -> Option<Kept> {
    is(head.first(), KEEPS).then_some(())?;
    let only = usize::from(is(head.get(1), &["only", "just"]));
    let many = head.get(1 + only).filter(|t| number(t).is_some())?.clone();
    let of = 2 + only;
    // "spare one pedestrian"
    if let Some((a, b)) = head.get(of..).and_then(first_noun).filter(|x| x.0 < 3)
        && !is(head.get(of), &["of", "more"])
    {
        let np = one_of_many(&head[of..of + a], &head[of + a..of + b]);
        return placed(&head[of + b..]).map(|place| (many, np, place));
    }
    let group = is(head.get(of), &["of"]) && is(head.get(of + 1), &["the", "these", "those", "my", "our"]);
    let np = group.then(|| &head[of + 1..])?;
    let (_, b) = first_noun(np).filter(|x| x.0 < 5)?;
    placed(&np[b..]).map(|place| (many, bare_np(&np[..b]), place))
}

/// "parked car": in the plural, as a group is named.
fn one_of_many(lead: &[Token], noun: &[Token]) -> Vec<Token> {
    let mut out = [lead, noun].concat();
    if let Some(last) = out.last_mut()
        && matches!(look_up(text(last)), Some(Sense::Noun(_, false)))
    {
        last.text = plural(text(last));
    }
    out
}

/// Nothing or a place: what else is said is not read here.
fn placed(rest: &[Token]) -> Option<Vec<Token>> {
    let rest = trimmed(rest);
    let place = rest.is_empty() || is_place(rest) && !has_noun(rest);
    (place && !rest.iter().any(|t| t.kind == TokenKind::Comma)).then(|| rest.to_vec())
}

/// So many of the group, those at the place first.
fn kept(many: &Token, np: &[Token], place: &[Token], talk: &Talk<'_>) -> Vec<Token> {
    let all = talk.fits(np);
    let there = [np, place].concat();
    let fit = if place.is_empty() { all } else { talk.fits(&there) };
    let count = number(many).unwrap_or(0);
    let at = &np[0];
    if fit < all && fit as i64 == count {
        let the = led("except the", at, &[&there]);
        return led("remove all the", at, &[np, &the]);
    }
    let keep = led("keep exactly", at, &[std::slice::from_ref(many), np]);
    if place.is_empty() || fit == all {
        return keep;
    }
    let it = if text(many) == "one" || count == 1 {
        "and put it"
    } else {
        "and put them"
    };
    [keep, led(it, at, &[place])].concat()
}
