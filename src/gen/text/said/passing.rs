//! What somebody has done on the way, for where he is: "has passed me and the car", "so that it approaches us", "gets company
//! from two riders", "waits until the children are across", "was tailgating him: 7 m behind me".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::lists::HELPERS;
use super::words::{
    find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed, word,
};

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = company(always_some(tokens), talk);
    let out = oncoming(so_that_it(is_oncoming(&only_that(out))));
    let out = remark_and_where(passed(us_both(out), talk), talk);
    another_in_place(&waits_until(out))
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

/// "there is always some white van around here, so give me one in the oncoming lane": a white van there.
fn always_some(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "there is always",
            "there is usually",
            "there is often",
            "there is mostly",
            "theres always",
            "there was always",
            "you always see",
            "you often see",
            "we always have",
            "i always meet",
            "i always see",
            "one always sees",
            "we usually have",
            "there are always",
        ],
    ) else {
        return tokens;
    };
    let np = &tokens[n..];
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 5 && is(np.first(), &["a", "an", "some", "one"]))
    else {
        return tokens;
    };
    let Some(one) = (n + b..tokens.len()).find(|k| {
        is(tokens.get(*k), &["one"])
            && leads(
                &tokens[k - 1..],
                &[
                    "add one",
                    "put one",
                    "place one",
                    "me one",
                    "us one",
                    "have one",
                    "show one",
                ],
            )
            .is_some()
            && tokens.get(k + 1).is_some_and(|t| !is(Some(t), &["of", "more"]))
    }) else {
        return tokens;
    };
    if has_noun(&tokens[n + b..one]) || has_noun(&tokens[one + 1..]) {
        return tokens;
    }
    led("add a", &tokens[0], &[&np[1..b], &tokens[one + 1..]])
}

/// "the cyclist gets company from two more riders, also behind me": two more riders, behind me.
fn company(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "gets company from",
            "get company from",
            "gets company by",
            "has company from",
            "got company from",
            "has got company from",
            "gets company in the form of",
            "has company in the form of",
            "is given company by",
            "should get company from",
            "gets company :",
            "has company :",
            "has company now :",
            "gets company now :",
            "has got company :",
            "has company again :",
            "gets company ,",
            "is no longer alone :",
            "has company ,",
            "has company now ,",
            "is not alone any more :",
            "gets the company of",
            "has the company of",
            "enjoys the company of",
        ],
    ) else {
        return tokens;
    };
    let whom = &tokens[..i];
    let what = &tokens[i + n..];
    let fresh = what
        .first()
        .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an", "another", "some"]));
    let Some((_, b)) = first_noun(what).filter(|x| fresh && x.0 < 5) else {
        return tokens;
    };
    if talk.fits(whom) == 0 {
        return tokens;
    }
    let mut place = trimmed(&what[b..]);
    while is(place.first(), &["also", "too", "both", "all", "likewise"]) {
        place = trimmed(&place[1..]);
    }
    if place.is_empty() {
        return led("add", &tokens[0], &[what, &led("next to", &tokens[i], &[whom])]);
    }
    if !is_place(place) {
        return tokens;
    }
    // ("right behind it": behind whom it joins)
    let place = rewritten(place, |k, out| {
        is(place.get(k), &["it", "him", "her", "them"]).then(|| {
            out.extend_from_slice(whom);
            k + 1
        })
    });
    led("add", &tokens[0], &[&what[..b], &place])
}

/// "turn the black car round, so that it approaches us in the oncoming lane": where it ends counts.
fn so_that_it(tokens: Vec<Token>) -> Vec<Token> {
    if !is(
        tokens.first(),
        &["turn", "rotate", "spin", "swing", "let", "have"],
    ) {
        return tokens;
    }
    let Some((i, n)) = find(
        &tokens,
        &["so that it", "so it", "such that it", "so that they", "so they"],
    ) else {
        return tokens;
    };
    let comes = leads(
        &tokens[i + n..],
        &[
            "approaches us",
            "approaches me",
            "comes towards us",
            "comes towards me",
            "comes toward us",
            "comes toward me",
            "comes at us",
            "comes at me",
            "drives towards us",
            "drives towards me",
            "is coming towards us",
            "is coming towards me",
            "is approaching us",
            "is approaching me",
            "approach us",
            "approach me",
            "come towards us",
            "come towards me",
            "drive towards us",
            "drive towards me",
            "rides towards us",
            "rides towards me",
            "heads towards us",
            "heads towards me",
        ],
    );
    let Some(comes) = comes else { return tokens };
    let us = usize::from(is(tokens.get(1), &["us"]) && is(tokens.first(), &["let"]));
    let from = 1 + 2 * us;
    let Some((_, b)) = tokens.get(from..i).and_then(first_noun).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let place = &tokens[i + n + comes..];
    let lane = trimmed(place).is_empty() || is_place(place);
    if !lane {
        return tokens;
    }
    let np = &tokens[from..from + b];
    if trimmed(place).is_empty() {
        return [np, &led("should come towards us", &tokens[i], &[])].concat();
    }
    [np, &led("should be", &tokens[i], &[place])].concat()
}

/// "make the black car an oncoming car": it should come towards us.
fn oncoming(tokens: Vec<Token>) -> Vec<Token> {
    let made = is(tokens.first(), &["make", "turn"]) && is(tokens.get(1), &["the", "that", "my"]);
    let Some((a, b)) = first_noun(&tokens[1.min(tokens.len())..]).filter(|x| made && x.0 < 4) else {
        return tokens;
    };
    let mut k = 1 + b;
    k += usize::from(is(tokens.get(k), &["into"]));
    let way = is(tokens.get(k), &["a", "an"]) && is(tokens.get(k + 1), &["oncoming", "approaching"]);
    let kind = tokens.get(k + 2);
    let same = kind.is_some_and(|t| text(t) == text(&tokens[a + 1]) || is(Some(t), &["vehicle", "one"]));
    if !way || !same || tokens.len() > k + 3 {
        return tokens;
    }
    [&tokens[1..1 + b], &led("should come towards us", &tokens[k], &[])].concat()
}

/// "let the bus be oncoming traffic", "the bus is oncoming now": it comes towards us.
fn is_oncoming(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = leads(
            &tokens[i..],
            &[
                "be oncoming traffic",
                "be oncoming",
                "is oncoming",
                "is now oncoming",
                "is oncoming now",
                "becomes oncoming traffic",
                "become oncoming traffic",
                "is now oncoming traffic",
                "are oncoming now",
                "are now oncoming",
                "should be oncoming",
                "becomes oncoming",
            ],
        )?;
        let clause = out
            .iter()
            .rposition(|t| t.kind != TokenKind::Word)
            .map_or(0, |k| k + 1);
        let (_, b) = first_noun(&out[clause..])?;
        let known = out[clause..]
            .iter()
            .any(|t| is(Some(t), &["the", "that", "my", "both"]))
            && clause + b == out.len()
            && ends(tokens.get(i + n));
        known.then(|| {
            let be = is(tokens.get(i), &["be", "become"]);
            out.extend(led(
                if be {
                    "come towards us"
                } else {
                    "should come towards us"
                },
                &tokens[i],
                &[],
            ));
            i + n
        })
    })
}

/// "only the white car changes: it moves to 25 m behind me": it does so, and nothing goes.
fn only_that(tokens: Vec<Token>) -> Vec<Token> {
    let only = is(tokens.first(), &["only", "just"]) && is(tokens.get(1), &["the", "that", "my"]);
    let Some((_, b)) = tokens.get(1..).and_then(first_noun).filter(|x| only && x.0 < 5) else {
        return tokens;
    };
    let verb = leads(
        &tokens[1 + b..],
        &[
            "changes",
            "change",
            "is different",
            "are different",
            "is affected",
            "is to change",
            "should change",
            "is changed",
            "must change",
            "needs changing",
            "needs to change",
            "is concerned",
        ],
    );
    let Some(colon) = verb
        .map(|n| 1 + b + n)
        .filter(|k| ends(tokens.get(*k)) && *k + 2 < tokens.len())
    else {
        return tokens;
    };
    let it = usize::from(is(tokens.get(colon + 1), &["it", "he", "she", "they"]));
    if it == 0 {
        return tokens;
    }
    [&tokens[1..1 + b], &tokens[colon + 2..]].concat()
}

/// "has passed us both, me and the motorbike": me and the motorbike.
fn us_both(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, _| {
        let n = leads(&tokens[i..], &["us both", "both of us", "the two of us"])?;
        let comma = tokens.get(i + n).is_some_and(|t| ends(Some(t)));
        (comma && is(tokens.get(i + n + 1), &["me", "us"]) && is(tokens.get(i + n + 2), &["and"]))
            .then_some(i + n + 1)
    })
}

/// "the white car was tailgating him: 7 metres behind me": what it did leads up to where it is.
fn remark_and_where(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(colon) = tokens.iter().position(|t| text(t) == ":") else {
        return tokens;
    };
    let Some((_, b)) =
        first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["the", "that", "my", "both"]))
    else {
        return tokens;
    };
    let said = tokens.get(b..colon).unwrap_or(&[]);
    let place = trimmed(&tokens[colon + 1..]);
    let metres = place.first().is_some_and(|t| number(t).is_some())
        && place.get(1..).is_some_and(|p| super::words::unit_at(p).is_some())
        && !has_noun(place);
    let told = said
        .first()
        .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false))
        && !has_noun(said)
        && !said.iter().any(|t| is(Some(t), &["not", "no"]))
        && !(0..said.len()).any(|k| is_place(&said[k..]) && !text(&said[k]).ends_with("ing"));
    if !metres || !told || talk.fits(&tokens[..b]) == 0 {
        return tokens;
    }
    [&tokens[..b], &led("should be", &tokens[colon], &[place])].concat()
}

/// True if a name ends here: what follows is said of it.
fn is_noun_end(tokens: &[Token]) -> bool {
    first_noun(tokens).is_some_and(|n| n.1 == tokens.len())
}

/// "has passed me and the car", "has passed the bus": it is ahead of the one that is farther on.
fn passed(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let has = is(tokens.get(i), &["has", "have"]);
        // "just overtook us"
        let past = is(
            tokens.get(i + usize::from(is(tokens.get(i), &["just", "already"]))),
            &["overtook", "passed"],
        );
        (has || past && is_noun_end(out)).then_some(())?;
        let mut k = i + usize::from(has);
        while is(
            tokens.get(k),
            &["just", "already", "now", "since", "both", "meanwhile"],
        ) {
            k += 1;
        }
        k += leads(
            &tokens[k..],
            &[
                "passed",
                "overtook",
                "overtaken",
                "gone past",
                "driven past",
                "ridden past",
                "got past",
            ],
        )?;
        // (who passed is named: "we have passed the bus" tells of us)
        has_noun(out).then_some(())?;
        k += usize::from(is(tokens.get(k), &["both"]));
        let me = is(tokens.get(k), &["me", "us"]);
        let and = me && is(tokens.get(k + 1), &["and"]);
        let np = tokens.get(if me { k + 2 } else { k }..).unwrap_or(&[]);
        let named = is(np.first(), &["the", "that"]) && (and || !me);
        let other = first_noun(np).filter(|x| named && x.0 < 4).map(|x| &np[..x.1]);
        let end = match other {
            Some(np) if and => k + 2 + np.len(),
            Some(np) => k + np.len(),
            None if me => k + 1,
            None => return None,
        };
        if !ends(tokens.get(end)) && !is(tokens.get(end), &["and", "so"]) {
            return None;
        }
        // ("and is 15 m behind us now": where it is counts)
        let now = is(tokens.get(end), &["and"])
            && is(
                tokens.get(end + 1),
                &[
                    "is", "are", "drives", "rides", "now", "walks", "stands", "runs", "follows",
                ],
            )
            && (end + 2..tokens.len().min(end + 5)).any(|k| super::words::is_place(&tokens[k..]));
        if now {
            return Some(end + 1);
        }
        let beyond = other.filter(|np| {
            let boxes = talk.boxes_of(np);
            !me || !boxes.is_empty() && boxes.iter().all(|b| b.center_m.x > 0.0)
        });
        let at = &tokens[i];
        match beyond {
            Some(np) => out.extend(led("should be ahead of", at, &[np])),
            None => {
                let end = word("me", &tokens[end - 1]);
                out.extend(led("should be ahead of", at, &[&[end]]));
            }
        }
        Some(end)
    })
}

/// "waits at the crossing until the children are across": for how long says nothing of where.
fn waits_until(tokens: Vec<Token>) -> Vec<Token> {
    let Some(wait) = tokens.iter().position(|t| {
        is(
            Some(t),
            &[
                "wait", "waits", "waiting", "stop", "stops", "stand", "stands", "hold", "holds", "stay",
                "stays",
            ],
        )
    }) else {
        return tokens;
    };
    let Some(i) = (wait + 2..tokens.len()).find(|k| is(tokens.get(*k), &["until", "till"])) else {
        return tokens;
    };
    let end = (i..tokens.len())
        .find(|k| ends(tokens.get(*k)) || is(tokens.get(*k), &["and"]) && *k > i + 2)
        .unwrap_or(tokens.len());
    let clause = &tokens[i + 1..end];
    // ("until it is behind us" is where it ends)
    let other = has_noun(clause) || is(clause.first(), &["they", "everyone", "everybody", "nobody", "we"]);
    let verb = clause
        .iter()
        .skip(1)
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true));
    if !other || !verb || !(wait + 1..i).any(|k| is_place(&tokens[k..i])) {
        return tokens;
    }
    [&tokens[..i], &tokens[end..]].concat()
}

/// "in its place a fourth barrier stands": another one.
fn another_in_place(tokens: &[Token]) -> Vec<Token> {
    const THERE: &[&str] = &[
        "in its place",
        "in their place",
        "in its stead",
        "in their stead",
        "in their places",
    ];
    rewritten(tokens, |i, out| {
        let after = out.len() > 2 && leads(&out[out.len() - 3..], THERE).is_some();
        let article = after && is(tokens.get(i), &["a", "an"]);
        let nth = tokens.get(i + 1).is_some_and(|t| {
            super::super::foremost::ordinal(text(t)).is_some()
                || is(Some(t), &["sixth", "seventh", "eighth", "new"])
        });
        let from = i + 1 + usize::from(nth);
        let (a, b) = article
            .then(|| first_noun(&tokens[from..]))?
            .filter(|x| x.0 < 3)?;
        // (of a kind that was spoken of: it is no part of those)
        let kind = text(&tokens[from + b - 1]);
        let again = nth || tokens[..i].iter().any(|t| text(t) == kind);
        again.then(|| {
            out.push(word("another", &tokens[i]));
            out.extend_from_slice(&tokens[from..from + a]);
            from + a
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn on_the_way() {
        let said = |list: Vec<Token>| {
            let list: Vec<String> = list.into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said(another_in_place(&tokens(
                "it is gone, and in its place a fourth barrier stands"
            ))),
            "it is gone , and in its place another barrier stands"
        );
        assert_eq!(
            said(waits_until(tokens(
                "the bus waits at the crossing until the kids are across"
            ))),
            "the bus waits at the crossing"
        );
    }
}
