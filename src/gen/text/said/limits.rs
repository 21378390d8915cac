//! How many there are to be: "no more than one", "three, not just one", "there are two now", "half the cones", "one for each".

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::frame::unwrapped;
use super::words::{find, first_noun, is, is_place, leads, led, number, text, trimmed, word};

/// "there shouldn't be more than one parked car": exactly one, if there are more.
pub(super) fn no_more_than(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "more than",
            "over",
            "at most",
            "no more than",
            "not more than",
            "a maximum of",
        ],
    ) else {
        return tokens;
    };
    let denied = is(tokens.get(i), &["no", "not", "at"])
        || tokens[..i]
            .iter()
            .any(|t| text(t).ends_with("nt") || matches!(text(t), "not" | "never" | "no"));
    let be = tokens[..i]
        .iter()
        .any(|t| matches!(text(t), "be" | "want" | "have" | "need" | "like" | "are" | "is"))
        || tokens[i + n..]
            .iter()
            .any(|t| matches!(text(t), "should" | "may" | "must" | "stay" | "remain"));
    let Some(many) = tokens.get(i + n).and_then(number).filter(|_| denied && be) else {
        return tokens;
    };
    let rest = &tokens[i + n + 1..];
    let Some((_, b)) = first_noun(rest).filter(|x| x.0 < 4) else {
        return tokens;
    };
    if talk.fits(&rest[..b]) <= many.max(0) as usize {
        return tokens;
    }
    let end = (b..rest.len())
        .find(|k| {
            rest[*k].kind != TokenKind::Word
                || is(
                    rest.get(*k),
                    &["and", "should", "may", "must", "here", "there", "any"],
                )
        })
        .unwrap_or(rest.len());
    led(
        "keep exactly",
        &tokens[0],
        &[&tokens[i + n..=i + n], &rest[..end]],
    )
}

/// "there are two women now": two in all.
pub(super) fn now_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "there are",
            "there is",
            "now there are",
            "now there is",
            "there are now",
            "there is now",
            "we now have",
            "now we have",
        ],
    ) else {
        return tokens;
    };
    let now = tokens.iter().any(|t| text(t) == "now");
    let many = tokens.get(n).and_then(number);
    let rest: Vec<Token> = tokens[n..].iter().filter(|t| text(t) != "now").cloned().collect();
    let bare = first_noun(&rest)
        .is_some_and(|x| x.0 < 4 && trimmed(&rest[x.1..]).is_empty() && talk.fits(&rest[x.0..x.1]) > 0);
    match many.filter(|_| now && bare) {
        Some(_) => led("keep exactly", &tokens[0], &[&rest]),
        None => tokens,
    }
}

/// "cut the queue to a single person": so many of them are kept.
pub(super) fn group_cut(tokens: Vec<Token>) -> Vec<Token> {
    const GROUP: &[&str] = &[
        "queue", "line", "row", "crowd", "group", "column", "bunch", "file", "crew", "lot", "gang", "string",
        "stack", "convoy",
    ];
    let found = (0..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "cut",
                "cut down",
                "cut back",
                "reduce",
                "thin",
                "thin out",
                "trim",
                "shrink",
                "whittle",
                "whittle down",
                "slim",
                "slim down",
                "pare",
                "pare down",
                "bring",
                "bring down",
                "shorten",
                "limit",
                "get",
                "downsize",
            ],
        )?;
        is(tokens.get(i + n), &["the", "that", "this", "our"]).then_some(())?;
        is(tokens.get(i + n + 1), GROUP).then_some(())?;
        let mut k = i + n + 2;
        let mut of = None;
        if is(tokens.get(k), &["of"]) {
            let (a, b) = first_noun(&tokens[k + 1..]).filter(|x| x.0 < 3)?;
            of = Some(k + 1 + a..k + 1 + b);
            k += 1 + b;
        }
        k += leads(&tokens[k..], &["down", "out", "back"]).unwrap_or(0);
        is(tokens.get(k), &["to"]).then_some(())?;
        k += 1 + usize::from(is(tokens.get(k + 1), &["just", "only", "a", "exactly"]));
        // ("to a single person")
        let single = is(tokens.get(k), &["single"]);
        (single || tokens.get(k).is_some_and(|t| number(t).is_some())).then_some(())?;
        let noun = match first_noun(tokens.get(k + 1..)?).filter(|x| x.0 < 3) {
            Some((_, b)) => k + 1..k + 1 + b,
            None => of?,
        };
        let end = noun.end.max(k + 1);
        Some((i, k, noun, end))
    });
    // "the crew consists of five workers"
    let found = found.or_else(|| {
        is(tokens.first(), &["the", "that", "this", "our"]).then_some(())?;
        is(tokens.get(1), GROUP).then_some(())?;
        let n = leads(
            &tokens[2..],
            &[
                "consists of",
                "is made up of",
                "numbers",
                "should consist of",
                "should number",
                "should have",
                "now has",
            ],
        )?;
        let k = 2 + n + usize::from(is(tokens.get(2 + n), &["just", "only", "exactly"]));
        tokens.get(k).filter(|t| number(t).is_some())?;
        let (_, b) = first_noun(tokens.get(k + 1..)?).filter(|x| x.0 < 3)?;
        (!is(tokens.get(k + 1), &["more"])).then_some((0, k, k + 1..k + 1 + b, k + 1 + b))
    });
    let Some((i, k, noun, end)) = found else {
        return tokens;
    };
    let many = if is(tokens.get(k), &["single"]) {
        word("one", &tokens[k])
    } else {
        tokens[k].clone()
    };
    [
        &tokens[..i],
        &led("keep exactly", &tokens[i], &[&[many], &tokens[noun]]),
        &tokens[end..],
    ]
    .concat()
}

/// "half the cones": half as many.
pub(super) fn half_of(tokens: Vec<Token>) -> Vec<Token> {
    if super::words::leads(
        &tokens,
        &[
            "only half as many",
            "just half as many",
            "only half the number of",
        ],
    )
    .is_some()
    {
        return tokens[1..].to_vec();
    }
    let Some(n) = leads(
        &tokens,
        &[
            "half the",
            "half of the",
            "only half the",
            "just half the",
            "only half of the",
        ],
    ) else {
        return tokens;
    };
    let bare = first_noun(&tokens[n..]).is_some_and(|x| x.0 < 3 && n + x.1 == tokens.len());
    if bare {
        led("half as many", &tokens[0], &[&tokens[n..]])
    } else {
        tokens
    }
}

/// "we need three barriers in our lane, not just one": exactly three there.
pub(super) fn so_many_not(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(&tokens, &["not", "instead of", "rather than", "and not"]).filter(|x| x.0 > 2)
    else {
        return tokens;
    };
    let from = i + n + usize::from(is(tokens.get(i + n), &["only", "just", "the"]));
    let closes = tokens.get(from).is_some_and(|t| number(t).is_some())
        && tokens.get(from + 1).is_none_or(|t| t.kind != TokenKind::Word);
    let before = trimmed(&tokens[..i]);
    let (inner, _) = unwrapped(before);
    let counted = inner.first().is_some_and(|t| number(t).is_some());
    let placed = first_noun(inner)
        .is_some_and(|x| x.0 < 4 && is_place(&inner[x.1..]) && talk.fits(&inner[x.0..x.1]) > 0);
    if !(closes && counted && placed) {
        return tokens;
    }
    led("keep exactly", &tokens[0], &[inner, &tokens[from + 1..]])
}

/// "put one cone behind each of the parked cars": as many as there are cars.
pub(super) fn for_each(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let tokens = each_gets(tokens);
    if !tokens.first().is_some_and(is_verb) {
        return tokens;
    }
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "each of the",
                "each one of the",
                "every one of the",
                "each of these",
                "each of those",
                "each",
                "every",
            ],
        )?;
        let led = is(
            tokens.get(i - 1),
            &[
                "behind", "of", "beside", "to", "near", "before", "by", "after", "ahead",
            ],
        ) && !is(tokens.get(i - 1), &["for"]);
        let (_, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 4)?;
        led.then_some((i, n, b))
    });
    let Some((i, n, b)) = found else {
        return tokens;
    };
    let many = talk.fits(&tokens[i + n..i + n + b]);
    let Some(one) = (1..i)
        .find(|k| is(tokens.get(*k), &["a", "an", "one", "another"]))
        .filter(|k| *k < 3)
    else {
        return tokens;
    };
    if many < 2 {
        return tokens;
    }
    let mut out = tokens[..one].to_vec();
    out.push(Token {
        kind: TokenKind::Number(many as f64),
        text: many.to_string(),
        span: tokens[one].span,
    });
    out.extend_from_slice(&tokens[one + 1..i]);
    out.extend(led(&format!("the {many}"), &tokens[i], &[]).into_iter().map(
        |t| match t.text.parse::<f64>() {
            Ok(v) => Token {
                kind: TokenKind::Number(v),
                ..t
            },
            Err(_) => t,
        },
    ));
    let noun = &tokens[i + n..i + n + b];
    let mut many_noun = noun.to_vec();
    if let Some(last) = many_noun.last_mut()
        && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
    {
        last.text = super::super::lexicon::plural(&last.text);
    }
    out.extend(many_noun);
    out.extend_from_slice(&tokens[i + n + b..]);
    out
}

/// "each worker gets a cone beside him": put a cone beside each worker.
fn each_gets(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["each of the", "every one of the", "each", "every"]) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let end = n + b;
    let Some(v) = leads(
        &tokens[end..],
        &[
            "gets",
            "should get",
            "receives",
            "should have",
            "must have",
            "needs",
            "has",
            "is given",
            "should be given",
            "must get",
            "shall have",
            "shall get",
            "ought to have",
        ],
    ) else {
        return tokens;
    };
    let new = &tokens[end + v..];
    let Some((_, e)) =
        first_noun(new).filter(|x| x.0 < 4 && is(new.first(), &["a", "an", "one", "another", "its", "his"]))
    else {
        return tokens;
    };
    let place = &new[e..];
    let it = place
        .iter()
        .position(|t| matches!(text(t), "it" | "him" | "her" | "them"));
    let at = match it {
        Some(k) if is_place(place) && k < 5 => place[..k].to_vec(),
        None if trimmed(place).is_empty() => led("next to", &tokens[0], &[]),
        _ => return tokens,
    };
    let after = it.map_or(&[][..], |k| &place[k + 1..]);
    led(
        "put a",
        &tokens[0],
        &[
            &new[1..e],
            &at,
            &led("each of the", &tokens[0], &[&tokens[n..end]]),
            after,
        ],
    )
}

/// "1 worker to the ego lane": so many of those that are there go.
pub(super) fn sent(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // "buses to the left lane"
    if let Some((0, b)) = first_noun(&tokens)
        && super::words::is_goal(&tokens[b..])
        && !is_verb(&tokens[0])
        && talk.fits(&tokens[..b]) > 0
    {
        return led("move the", &tokens[0], &[&tokens]);
    }
    let counted = tokens.first().is_some_and(|t| number(t).is_some());
    let Some((a, b)) = first_noun(&tokens).filter(|n| counted && n.0 < 4) else {
        return tokens;
    };
    let to = is(tokens.get(b), &["to", "onto", "into"]) && super::words::is_goal(&tokens[b..]);
    let many = number(&tokens[0]).unwrap_or(0).max(0) as usize;
    let found = talk.fits(&tokens[1..b]);
    if !to || a < 1 || found < many || many == 0 {
        return tokens;
    }
    let lead = if found > many { "move any" } else { "move the" };
    led(lead, &tokens[0], &[&tokens])
}

/// "three trucks should be coming towards us, not cars": in the place of those.
pub(super) fn not_those(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &["not", "and not", "but not", "instead of", "rather than"],
    )
    .filter(|x| x.0 > 2) else {
        return tokens;
    };
    let old = &tokens[i + n..];
    let counted = tokens
        .first()
        .is_some_and(|t| number(t).is_some() || matches!(text(t), "a" | "an"));
    let (Some((a, b)), Some((c, d))) = (first_noun(&tokens[..i]).filter(|x| x.0 < 4), first_noun(old)) else {
        return tokens;
    };
    let plain = c == 0 && matches!(look_up(text(&old[d - 1])), Some(Sense::Noun(_, true)));
    let closes = old
        .get(d)
        .is_none_or(|t| t.kind != TokenKind::Word || text(t) == "and");
    let same = tokens[a..b].iter().map(text).eq(old[c..d].iter().map(text));
    let said = &tokens[b..i];
    let helper = said.iter().any(|t| {
        matches!(
            text(t),
            "should" | "must" | "shall" | "are" | "is" | "be" | "ought"
        )
    });
    if !(counted && plain && closes && !same && helper) || talk.fits(&old[..d]) == 0 {
        return tokens;
    }
    let mut out = led("remove all the", &tokens[0], &[&old[..d]]);
    out.push(word("and", &tokens[0]));
    out.extend(led("add", &tokens[0], &[&tokens[..b]]));
    out.extend(
        trimmed(said)
            .iter()
            .filter(|t| {
                !matches!(
                    text(t),
                    "should" | "must" | "shall" | "are" | "is" | "be" | "ought" | "to"
                )
            })
            .cloned(),
    );
    out.extend_from_slice(&old[d..]);
    out
}
