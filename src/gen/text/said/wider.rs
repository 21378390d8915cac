//! Sentences that say what is wanted by way of something else: "would it be possible for the van to be a pickup", "apart from the
//! trucks nothing should be there", "cones would be better than barriers", "all people but one go to the left sidewalk".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::lists::HELPERS;
use super::words::{
    find, first_noun, has_noun, is, is_goal, is_place, leads, led, longest, number, text, trimmed,
};

const FOR: &[&str] = &[
    "would it be possible for",
    "is it possible for",
    "could it be possible for",
    "could it be arranged for",
    "it is time for",
    "its time for",
    "id like for",
    "i would like for",
    "i want for",
    "is there a way for",
    "would it be ok for",
    "it would be nice for",
    "it would be good for",
    "it would be better for",
];
const WHATEVER: &str = "whatever is|whatever stands|whatever drives|whatever is standing|whatever is driving|everything that is|everything that stands|everything that drives|anything that is|all that is|anything thats|everything thats|whatevers";
const EXCEPT: &[&str] = &[
    "apart from",
    "except for",
    "besides",
    "other than",
    "aside from",
    "save for",
    "but for",
    "with the exception of",
];

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = asked_for(tokens);
    let out = would_do(rather(out, talk));
    let out = whatever_there(out);
    let out = into_it(out);
    let out = but_for(out);
    let out = better_than(out, talk);
    let out = all_but_go(out, talk);
    let out = plus_minus(out);
    let out = once_there(out, talk);
    more_of_the(out)
}

/// "would it be possible for the van to be a pickup": the van should be a pickup.
fn asked_for(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, FOR) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let to = (n + b..tokens.len().min(n + b + 8)).find(|k| {
        is(tokens.get(*k), &["to"])
            && tokens.get(k + 1).is_some_and(|t| {
                is_verb(t) || super::words::is_finite(text(t), true) || HELPERS.contains(&text(t))
            })
    });
    match to {
        Some(k) => [&tokens[n..k], &led("should", &tokens[k], &[]), &tokens[k + 1..]].concat(),
        None => tokens,
    }
}

/// "rather than a bus, a lorry should be in the right lane": the lorry for the bus.
fn rather(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["rather than", "instead of", "in place of"]) else {
        return tokens;
    };
    let a = is(tokens.get(n), &["a", "an"]);
    let Some((c, b)) = first_noun(&tokens[n..]).filter(|x| a && x.0 < 4) else {
        return tokens;
    };
    let comma = n + b + usize::from(tokens.get(n + b).is_some_and(|t| t.kind == TokenKind::Comma));
    let wish = leads(
        &tokens[comma..],
        &[
            "i want",
            "i would like",
            "id like",
            "there should be",
            "there must be",
            "we need",
            "i need",
            "put",
            "use",
            "show",
            "make it",
            "let there be",
            "i would prefer",
            "id prefer",
        ],
    )
    .unwrap_or(0);
    let new = &tokens[comma + wish..];
    let Some((_, e)) = first_noun(new).filter(|x| is(new.first(), &["a", "an"]) && x.0 < 4) else {
        return tokens;
    };
    let rest: Vec<Token> = new[e..]
        .iter()
        .filter(|t| !HELPERS.contains(&text(t)) && !is(Some(t), &["there", "instead"]))
        .cloned()
        .collect();
    let old = &tokens[n + 1..n + b];
    let there = [old, &rest[..]].concat();
    let whole = if is_place(&rest) && talk.fits(&there) == 1 {
        &there[..]
    } else {
        old
    };
    let plain = rest.is_empty() || is_place(&rest) && !has_noun(&rest);
    if c == 0 || !plain || talk.fits(whole) != 1 {
        return tokens;
    }
    led(
        "replace the",
        &tokens[0],
        &[whole, &led("with", &tokens[0], &[&new[..e]])],
    )
}

/// "I'd drop the motorcycle": drop it.
fn would_do(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "id",
            "i would",
            "we would",
            "wed",
            "i will",
            "ill",
            "i suggest we",
            "i propose we",
            "is there a way to",
            "is there any way to",
            "is there a chance to",
            "would you be able to",
            "are you able to",
            "would there be a way to",
            "any chance to",
        ],
    ) else {
        return tokens;
    };
    let orders = is(
        tokens.get(n),
        &[
            "drop", "remove", "delete", "put", "add", "move", "replace", "swap", "turn", "place", "take",
            "exchange", "erase", "change", "scrap", "shift", "park", "bring", "set",
        ],
    );
    let known = is(
        tokens.get(n + 1),
        &[
            "the", "a", "an", "all", "both", "it", "them", "that", "those", "one", "another", "every", "out",
            "away",
        ],
    ) || tokens.get(n + 1).is_some_and(|t| number(t).is_some());
    // "to get a trailer behind the pickup"
    if is(tokens.get(n), &["get", "have", "see"]) && is(tokens.get(n + 1), &["a", "an", "another"]) && n > 2 {
        return led("add", &tokens[n], &[&tokens[n + 1..]]);
    }
    if orders && known {
        tokens[n..].to_vec()
    } else {
        tokens
    }
}

/// "remove whatever is in the oncoming lane": all the objects there.
fn whatever_there(tokens: Vec<Token>) -> Vec<Token> {
    let removes = tokens
        .iter()
        .take(3)
        .any(|t| super::some_of::removes(Some(t)) || is(Some(t), &["rid", "ditch", "wipe", "away", "sweep"]));
    if !removes {
        return tokens;
    }
    let new = replaced(&tokens, WHATEVER, "all the objects");
    let at = find(&new, &["all the objects"]);
    match at {
        Some((i, n)) if new.len() != tokens.len() || is_place(&new[i + n..]) => {
            if is_place(&new[i + n..]) {
                new
            } else {
                tokens
            }
        }
        _ => tokens,
    }
}

/// "clear the oncoming lane and put a lorry into it": into the lane.
fn into_it(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (3..tokens.len()).find(|i| {
        is(tokens.get(*i), &["it"])
            && is(tokens.get(i - 1), &["into", "in", "on", "onto"])
            && tokens.get(i + 1).is_none_or(|t| t.kind != TokenKind::Word)
    }) else {
        return tokens;
    };
    let mut place = None;
    let mut k = 0;
    while k < i - 1 {
        let n = match longest(&tokens[k..i - 1]) {
            Some((Sense::Place(..), n)) => {
                place = Some((k, n));
                n
            }
            _ => 1,
        };
        k += n;
    }
    let Some((k, n)) = place else {
        return tokens;
    };
    // a thing that was named later is meant, if it is in the same clause
    let link = tokens[k + n..i]
        .iter()
        .any(|t| text(t) == "and" || t.kind == TokenKind::Comma);
    if !link {
        return tokens;
    }
    let the = led("the", &tokens[i], &[&tokens[k..k + n]]);
    [&tokens[..i], &the, &tokens[i + 1..]].concat()
}

/// "apart from the two trucks there shouldn't be anything on the road": only those stay.
fn but_for(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, EXCEPT) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let Some((i, m)) = find(
        &tokens[n + b..],
        &[
            "there should be nothing",
            "there shouldnt be anything",
            "there should not be anything",
            "there must be nothing",
            "there must not be anything",
            "nothing should be",
            "nothing should remain",
            "nothing should stay",
            "nothing must be",
            "i want nothing",
            "i dont want anything",
            "i do not want anything",
            "i want to see nothing",
            "there is to be nothing",
            "nothing is to",
            "nothing may",
            "the road should be empty",
            "the street should be empty",
            "the scene should be empty",
            "the road must be empty",
            "everything should",
            "everything must",
            "everything can",
            "everything has to",
            "nothing is left",
            "nothing is needed",
            "i need nothing",
            "everything goes",
            "nothing remains",
            "nothing stays",
            "there shall be nothing",
        ],
    ) else {
        return tokens;
    };
    let np = trimmed(&tokens[n..n + b + i]);
    // ("everything should stay" says the opposite)
    let rest = &tokens[n + b + i + m..];
    let all = is(tokens.get(n + b + i), &["everything"]);
    let goes = rest.iter().any(|t| {
        matches!(
            text(t),
            "go" | "gone"
                | "disappear"
                | "vanish"
                | "removed"
                | "deleted"
                | "leave"
                | "away"
                | "out"
                | "erased"
        )
    }) || is(tokens.get(n + b + i + m - 1), &["goes"]);
    if all != goes || has_noun(rest) {
        return tokens;
    }
    led("keep only", &tokens[0], &[np])
}

/// "cones would be more suitable than barriers": cones for barriers.
fn better_than(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "would be better than",
            "would be nicer than",
            "would be more suitable than",
            "would be preferable to",
            "are better than",
            "is better than",
            "would be more realistic than",
            "would fit better than",
            "would suit better than",
            "are preferable to",
            "would be more fitting than",
            "would be more appropriate than",
            "would be more useful than",
            "makes more sense than",
            "make more sense than",
            "would make more sense than",
            "would look better than",
            "would do better than",
        ],
    ) else {
        return tokens;
    };
    let (new, old) = (&tokens[..i], trimmed(&tokens[i + n..]));
    let Some((a, b)) = first_noun(new).filter(|x| x.0 < 4 && x.1 == new.len()) else {
        return tokens;
    };
    let Some((c, d)) = first_noun(old).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let counted = new[..a]
        .iter()
        .any(|t| number(t).is_some() && !is(Some(t), &["a", "an"]))
        && old[..c].iter().any(|t| number(t).is_some());
    if counted || talk.fits(&old[c..d]) == 0 {
        return tokens;
    }
    let many = matches!(look_up(text(&old[d - 1])), Some(Sense::Noun(_, true)));
    let end = if is_place(&old[d..]) { old.len() } else { d };
    let lead = if many { "replace all the" } else { "replace the" };
    led(
        lead,
        &tokens[0],
        &[&old[c..end], &led("with", &tokens[i], &[&new[..b]])],
    )
}

/// "all people but one go to the left sidewalk": so many of them are moved there.
fn all_but_go(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let from = usize::from(is(
        tokens.first(),
        &["let", "have", "make", "move", "send", "put"],
    ));
    if !is(tokens.get(from), &["all", "every"]) {
        return tokens;
    }
    let Some((_, b)) = first_noun(&tokens[from..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let np_end = from + b;
    let Some(n) = leads(
        &tokens[np_end..],
        &["but", "except for", "except", "apart from", "bar", "save"],
    ) else {
        return tokens;
    };
    let Some(few) = tokens.get(np_end + n).and_then(number) else {
        return tokens;
    };
    let mut k = np_end + n + 1;
    k += leads(&tokens[k..], &["of them", "of those"]).unwrap_or(0);
    while tokens.get(k).is_some_and(|t| HELPERS.contains(&text(t))) {
        k += 1;
    }
    let goes = is(
        tokens.get(k),
        &[
            "go", "goes", "walk", "walks", "move", "moves", "cross", "run", "runs", "change", "come",
            "drive", "ride", "step", "stand", "switch",
        ],
    );
    let place = &tokens[k + usize::from(goes)..];
    let over = usize::from(is(place.first(), &["over", "across"]));
    let goal = is_goal(&place[over..])
        || !goes && is_place(place) && from == 1
        || is(tokens.get(k), &["stand"]) && is_place(place);
    let np: Vec<Token> = tokens[from + 1..np_end]
        .iter()
        .filter(|t| !is(Some(t), &["the", "of"]))
        .cloned()
        .collect();
    let left = talk.fits(&np).saturating_sub(few.max(0) as usize);
    if !goal || left == 0 {
        return tokens;
    }
    let digit = Token {
        kind: TokenKind::Number(left as f64),
        text: left.to_string(),
        span: tokens[from].span,
    };
    led("move any", &tokens[0], &[&[digit], &np, place])
}

/// "people minus two, cyclists plus one".
fn plus_minus(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut from = 0;
    let mut found = false;
    for i in 0..=tokens.len() {
        if tokens
            .get(i)
            .is_some_and(|t| t.kind != TokenKind::Comma && !is(Some(t), &["and"]))
        {
            continue;
        }
        let part = &tokens[from..i];
        let sign = part
            .iter()
            .position(|t| matches!(text(t), "minus" | "plus" | "less"));
        let sum = sign.filter(|k| {
            first_noun(&part[..*k]).is_some_and(|x| x.0 < 3 && x.1 == *k)
                && part.len() == k + 2
                && number(&part[k + 1]).is_some()
        });
        match sum {
            Some(k) => {
                found = true;
                let skip = usize::from(is(part.first(), &["the"]));
                let np = &part[skip..k];
                if text(&part[k]) == "plus" {
                    out.extend(led(
                        "add",
                        &part[0],
                        &[&part[k + 1..], &led("more", &part[0], &[np])],
                    ));
                } else {
                    out.extend(part[k + 1..].iter().cloned());
                    out.extend_from_slice(np);
                    out.extend(led("fewer", &part[0], &[]));
                }
            }
            None => out.extend_from_slice(part),
        }
        if let Some(link) = tokens.get(i) {
            let mut link = link.clone();
            // each sum is a command of its own
            if sum.is_some() && link.kind == TokenKind::Comma {
                link.text = "and".into();
                link.kind = TokenKind::Word;
            }
            out.push(link);
        }
        from = i + 1;
    }
    if found { out } else { tokens }
}

/// "there used to be two buses, now there is none".
fn once_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "there used to be",
            "there were once",
            "there was once",
            "there once was",
            "there once were",
            "there were",
            "there was",
            "we used to have",
        ],
    ) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let close = (n + b..tokens.len())
        .find(|k| tokens[*k].kind != TokenKind::Word || is(tokens.get(*k), &["but", "and"]))
        .unwrap_or(tokens.len());
    let np = &tokens[n + a..close];
    let denied = tokens[n..n + a]
        .iter()
        .any(|t| matches!(text(t), "no" | "not" | "never"));
    if denied || talk.fits(np) == 0 {
        return tokens;
    }
    let rest = trimmed(&tokens[close..]);
    let k = leads(
        rest,
        &[
            "now there is",
            "now there are",
            "there is now",
            "there are now",
            "now we have",
            "there is",
            "there are",
            "now",
        ],
    )
    .unwrap_or(0);
    let rest = trimmed(&rest[k..]);
    let rest = &rest[usize::from(is(rest.first(), &["only", "just"]))..];
    if is(rest.first(), &["none", "nothing"])
        || leads(rest, &["no longer any", "no more", "not any more"]).is_some()
    {
        return led("remove all the", &tokens[0], &[np]);
    }
    match rest
        .first()
        .filter(|t| number(t).is_some() && first_noun(rest).is_none())
    {
        Some(many) => led("keep exactly", &tokens[0], &[std::slice::from_ref(many), np]),
        None if rest.is_empty() => super::gifts::remark(np),
        None => tokens,
    }
}

/// The noun as it stands after the number.
fn of_number(np: &[Token], many: &Token) -> Vec<Token> {
    if number(many) == Some(1) {
        super::topics::singular_of(np)
    } else {
        np.to_vec()
    }
}

/// "one more of the people and one less of the cars".
fn more_of_the(tokens: Vec<Token>) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let way = is(tokens.get(i + 1), &["more", "less", "fewer"]) && number(&tokens[i]).is_some();
        let of = tokens
            .get(i + 2..)
            .and_then(|t| leads(t, &["of the", "of those", "of these"]));
        let np = of.filter(|_| way).and_then(|n| {
            first_noun(&tokens[i + 2 + n..])
                .filter(|x| x.0 < 3)
                .map(|x| (n, x.1))
        });
        match np {
            Some((n, b)) => {
                let np = &tokens[i + 2 + n..i + 2 + n + b];
                if is(tokens.get(i + 1), &["more"]) {
                    let add =
                        i == 0 || is(tokens.get(i - 1), &["and"]) || tokens[i - 1].kind == TokenKind::Comma;
                    if add {
                        out.extend(led("add", &tokens[i], &[]));
                    }
                    out.extend_from_slice(&tokens[i..i + 2]);
                    out.extend(of_number(np, &tokens[i]));
                } else {
                    out.push(tokens[i].clone());
                    out.extend(of_number(np, &tokens[i]));
                    out.extend(led("fewer", &tokens[i], &[]));
                }
                i += 2 + n + b;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}
