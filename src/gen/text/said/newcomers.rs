//! Who is new, in words that would move or hold something: "send a bus along the cross street", "the truck has a worker beside it",
//! "a woman stands there and two more stand on the right one".

use super::super::lexicon::plural;
use super::super::names::singular;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{order, rewritten};
use super::Talk;
use super::topics::singular_of;
use super::words::{first_noun, is, is_finite, is_place, is_unit, leads, led, noun_at, number, text, word};

/// A sentence that says plainly who is new.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = beside_one_of(&more_of_them(&tokens));
    let out = same_way(has_beside_it(out, talk), talk);
    sent(&out, talk)
}

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || tokens[i - 1].kind != TokenKind::Word
        || is(tokens.get(i - 1), &["and", "then", "but", "so", "please", "now"])
}

fn is_fresh(t: Option<&Token>) -> bool {
    is(t, &["a", "an", "another", "some"]) || t.is_some_and(|t| number(t).is_some() && text(t) != "both")
}

/// "behind the bus a car going the same way": the way of the bus, which may come towards us.
fn same_way(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const WAY: &[&str] = &[
        "going the same way",
        "going in the same direction",
        "driving the same way",
        "driving in the same direction",
        "heading the same way",
        "heading in the same direction",
        "travelling the same way",
        "travelling in the same direction",
        "traveling in the same direction",
        "moving in the same direction",
        "moving the same way",
        "riding the same way",
        "riding in the same direction",
        "facing the same way",
        "that goes the same way",
        "that drives the same way",
        "which goes the same way",
        "that is going the same way",
        "coming the same way",
        "in the same direction",
    ];
    let found = (1..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], WAY)?;
        let it = leads(
            &tokens[i + n..],
            &["as it", "as him", "as her", "as they do", "as it does", "too"],
        )
        .unwrap_or(0);
        let end = i + n + it;
        (!is(tokens.get(end), &["as", "like", "that", "we", "i"])).then_some((i, end))
    });
    let Some((i, end)) = found else {
        return tokens;
    };
    // whom it goes with
    let beside = (0..tokens.len()).find_map(|k| {
        let n = leads(
            &tokens[k..],
            &["behind", "after", "following", "in front of", "ahead of"],
        )?;
        is(tokens.get(k + n), &["the", "that"]).then_some(())?;
        let (_, b) = first_noun(&tokens[k + n..]).filter(|x| x.0 < 4)?;
        Some(k + n..k + n + b)
    });
    let Some(np) = beside else {
        return tokens;
    };
    let new = tokens
        .iter()
        .enumerate()
        .any(|(k, t)| !np.contains(&k) && is(Some(t), &["a", "an", "another", "one"]));
    let boxes = talk.boxes_of(&tokens[np]);
    let comes = boxes.len() == 1 && boxes[0].yaw_rad.cos() < -0.7;
    if !(new && comes) {
        return tokens;
    }
    [
        &tokens[..i],
        &led("coming towards us in the oncoming lane", &tokens[i], &[]),
        &tokens[end..],
    ]
    .concat()
}

/// "in front of one of the parked cars": whichever it is, the nearest will do.
fn beside_one_of(tokens: &[Token]) -> Vec<Token> {
    const OF: &[&str] = &[
        "one of the",
        "any of the",
        "any one of the",
        "one of those",
        "one of these",
    ];
    rewritten(tokens, |i, out| {
        let led_by = is(
            out.last(),
            &[
                "of",
                "behind",
                "beside",
                "to",
                "near",
                "before",
                "after",
                "opposite",
                "alongside",
                "by",
            ],
        );
        let n = leads(&tokens[i..], OF).filter(|_| led_by && out.len() > 1)?;
        let (a, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 4)?;
        out.extend(led("the nearest", &tokens[i], &[&tokens[i + n..i + n + a]]));
        out.extend(singular_of(&tokens[i + n + a..i + n + b]));
        Some(i + n + b)
    })
}

/// "send a bus along the cross street", "bring a police car up behind me": whom "the" is not said of comes new.
fn sent(tokens: &[Token], talk: &Talk<'_>) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let verb = opens(tokens, i) && is(tokens.get(i), &["send", "bring"]);
        let from = i + 1 + usize::from(is(tokens.get(i + 1), &["in", "up", "along"]));
        let (_, b) = (verb && is_fresh(tokens.get(from)))
            .then(|| first_noun(&tokens[from..]))?
            .filter(|n| n.0 < 4)?;
        // ("two of the cars" are there; "a car closer to us", too)
        let np = &tokens[from..from + b];
        let rest = from
            + b
            + usize::from(
                is(tokens.get(from + b), &["up", "along", "in"]) && is_place(&tokens[from + b + 1..]),
            );
        let there = number(&np[0]).is_some() && !is(np.first(), &["a", "an"]) && !talk.has_none(np)
            || np.iter().any(|t| is(Some(t), &["of", "the"]))
            || is(
                tokens.get(rest),
                &[
                    "closer", "nearer", "back", "away", "home", "off", "forward", "further", "farther", "out",
                ],
            );
        if there || !is_place(&tokens[rest..]) {
            return None;
        }
        out.extend(led("add", &tokens[i], &[np]));
        Some(rest)
    })
}

/// "the truck has a worker beside it": there is a worker beside the truck.
fn has_beside_it(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const HAS: &[&str] = &[
        "has",
        "have",
        "had",
        "has got",
        "have got",
        "now has",
        "now have",
        "should have",
        "shall have",
        "must have",
    ];
    if !is(tokens.first(), &["the", "both", "my", "that", "these", "those"]) {
        return tokens;
    }
    let Some((_, b)) = first_noun(&tokens).filter(|n| n.0 < 5) else {
        return tokens;
    };
    let Some(n) = leads(&tokens[b..], HAS).filter(|n| is_fresh(tokens.get(b + n))) else {
        return tokens;
    };
    let what = b + n;
    let Some((_, d)) = first_noun(&tokens[what..]).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let place = what + d;
    let end = (place + 1..tokens.len().min(place + 6)).find(|k| {
        is(tokens.get(*k), &["it", "him", "her", "them"])
            && (tokens
                .get(k + 1)
                .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "now"]))
                || is_place(&tokens[k + 1..]))
    });
    let with = is(tokens.get(place), &["with"]);
    let Some(end) = end.filter(|_| {
        with || is_place(&tokens[place..])
            || is(
                tokens.get(place),
                &["standing", "walking", "driving", "riding", "waiting", "parked"],
            )
    }) else {
        return tokens;
    };
    if talk.fits(&tokens[..b]) == 0 {
        return tokens;
    }
    let at = &tokens[place];
    let mut out = led("add", at, &[&tokens[what..place]]);
    if with {
        out.extend(led("next to", at, &[]));
    } else {
        out.extend_from_slice(&tokens[place..end]);
    }
    out.extend_from_slice(&tokens[..b]);
    out.extend_from_slice(&tokens[end + 1..]);
    out
}

/// "a woman stands there and two more stand on the right": two more women.
fn more_of_them(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let joined = i > 0
            && (is(out.last(), &["and", "while", "but"])
                || out.last().is_some_and(|t| t.kind == TokenKind::Comma));
        let many = number(&tokens[i]).filter(|_| joined)?;
        let more = usize::from(is(tokens.get(i + 1), &["more", "others", "other"]));
        let next = &tokens[i + 1 + more..];
        let verb = next
            .first()
            .is_some_and(|t| is_finite(text(t), true) || is(Some(t), &["is", "are"]));
        let placed = verb && (1..next.len().min(4)).any(|k| is_place(&next[k..]));
        let bare = is_place(next) && !is_unit(next.first()) && !is(next.first(), &["by", "off", "out", "to"]);
        // ("one after the other" says only how they stand)
        if !placed && !bare || noun_at(next).is_some() || order(&tokens[i..]).is_some() {
            return None;
        }
        // of the clause before, where its subject is new as well
        let from = out[..out.len() - 1]
            .iter()
            .rposition(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "but", "while"]))
            .map_or(0, |k| k + 1);
        let clause = &out[from..];
        let (a, b) = first_noun(clause).filter(|n| n.0 < 4 && is_fresh(clause.first()))?;
        let noun = clause[a..b].iter().map(text).collect::<Vec<_>>().join(" ");
        let noun = singular(&noun).to_string();
        let several = |one: &str| match one {
            "man" => "men".to_string(),
            "woman" => "women".to_string(),
            "child" => "children".to_string(),
            "person" => "people".to_string(),
            _ => plural(one),
        };
        let noun = if many == 1 { noun } else { several(&noun) };
        out.push(tokens[i].clone());
        if more > 0 {
            out.push(word("more", &tokens[i]));
        }
        out.extend(noun.split(' ').map(|w| word(w, &tokens[i])));
        Some(i + 1 + more)
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    fn said(list: Vec<Token>) -> String {
        list.into_iter().map(|t| t.text).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn newcomers() {
        assert_eq!(
            said(more_of_them(&tokens(
                "a woman stands on the left and two more stand on the right"
            ))),
            "a woman stands on the left and two more women stand on the right"
        );
    }
}
