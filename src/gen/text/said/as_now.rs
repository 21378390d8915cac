//! How many there should be, told by how many there are now: "eight parked cars, twice as many as now", "three cyclists in place of
//! one", "besides the pickup just one of the cars is still there", "same drive with a single car behind us".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::gifts::begins_at;
use super::headway::is_mark;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed};

/// A sentence (without its stop) with the number that is meant.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = one_as_now(tokens, talk);
    let out = nothing_there(enough_with(than_now(as_far_as_now(out)), talk));
    let out = compared(out, talk);
    let out = in_place_of(out, talk);
    let opens = (0..out.len()).filter(|i| begins_at(&out, *i));
    let found = opens
        .into_iter()
        .find_map(|i| still_there(&out[i..], talk).map(|new| [&apart_from_it(&out[..i]), &new[..]].concat()));
    so_many_left(same_with(found.unwrap_or(out)), talk)
}

const WISHES: &str = "there should be|there must be|there must come|there should come|there shall be|there shall come|there have to be|there are|i want|i need|we need|we want|\
    i would like|id like|give me|give us|let there be|make it|make that|show|show me|put|add|let us have|lets have|please|we would like|i would like to have|i would like to see|\
    id like to see|can i have|can we have|could we have|could i have|have|now|let me have|let me see|place|insert|i would rather have|id rather have|we should have|we should see";

fn lead_of(tokens: &[Token]) -> usize {
    let mut n = 0;
    while let Some(k) = begins(&tokens[n..], WISHES) {
        n += k;
    }
    n
}

/// "the cars" of "car" and "cars".
pub(super) fn all_of(noun: &[Token]) -> Vec<Token> {
    let mut out = led("the", &noun[0], &[noun]);
    if let Some(last) = out.last_mut()
        && matches!(look_up(text(last)), Some(Sense::Noun(_, false)))
    {
        let stem = last.text.strip_suffix("man").map(|s| format!("{s}men"));
        last.text = match last.text.as_str() {
            "child" => "children".into(),
            "person" => "people".into(),
            _ => stem.unwrap_or_else(|| super::super::lexicon::plural(&last.text)),
        };
    }
    out
}

fn count(t: Option<&Token>) -> Option<i64> {
    t.filter(|t| !is(Some(t), &["a", "an"])).and_then(number)
}

/// "just as far behind us as before": at the same distance behind us.
fn as_far_as_now(tokens: Vec<Token>) -> Vec<Token> {
    super::super::wording::rewritten(&tokens, |i, out| {
        let lead = begins(
            &tokens[i..],
            "just as far|exactly as far|still as far|as far|equally far|just as close|as close",
        )?;
        let end = (i + lead..tokens.len().min(i + lead + 6)).find_map(|k| {
            let n = begins(
                &tokens[k..],
                "as before|as now|as it is now|as it was|as it is|as it was before|as at present|as currently|as it was so far|as until now",
            )?;
            Some((k, k + n))
        });
        let (k, end) = end?;
        let way = &tokens[i + lead..k];
        if !(way.is_empty() || is_place(way) || is(way.first(), &["away", "off", "from", "to"]))
            || has_noun(way)
        {
            return None;
        }
        out.extend(led("at the same distance", &tokens[i], &[]));
        if is_place(way) && !is(way.first(), &["away", "off", "from", "to"]) {
            out.extend_from_slice(way);
        }
        Some(end)
    })
}

/// "two cars behind us, one at 12 m like now and another at 22": the one that is there is no new one.
fn one_as_now(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const NOW: &str = "like now|as now|as it is now|as before|as it is|as at present|like before|as already there|like it is now|like the one now|where it is now|where it is|as is";
    let one = (3..tokens.len()).find(|k| {
        is(tokens.get(*k), &["one"]) && (is_mark(&tokens[k - 1]) || is(tokens.get(k - 1), &["and", "with"]))
    });
    let found = one.and_then(|k| {
        let now =
            (k + 1..tokens.len().min(k + 9)).find_map(|j| begins(&tokens[j..], NOW).map(|n| (j, j + n)))?;
        let late = tokens.get(now.1..)?;
        let and = late.iter().position(|t| !(is_mark(t) || is(Some(t), &["and"])))?;
        let n = begins(
            &late[and..],
            "another one|another|the other one|the other|a second one|a second|the second|one|a further one",
        )?;
        (and > 0).then_some((k, &tokens[k + 1..now.0], &late[and + n..]))
    });
    let Some((k, old, new)) = found else { return tokens };
    let head = &tokens[..k];
    let head = &head[lead_of(head)..];
    let head = super::words::trimmed(head);
    let two = head.first().is_some_and(|t| number(t) == Some(2));
    let Some((_, b)) = first_noun(head).filter(|x| two && x.0 < 4) else {
        return tokens;
    };
    let noun = &head[1..b];
    // ("and another at twenty-two": metres like the first)
    let at = usize::from(is(new.first(), &["at"]));
    let rest = &new[at..];
    let unit: Vec<Token> = match old.iter().find(|t| super::words::is_unit(Some(t))) {
        Some(u) if rest.len() == 1 && number(&rest[0]).is_some() => vec![u.clone()],
        _ => Vec::new(),
    };
    if talk.fits(noun) == 0 || has_noun(rest) || rest.is_empty() || !is_place(rest) && unit.is_empty() {
        return tokens;
    }
    let one = super::topics::singular_of(noun);
    led("add another", &tokens[0], &[&one, rest, &unit, &head[b..]])
}

/// "10 metres further than now": further.
fn than_now(tokens: Vec<Token>) -> Vec<Token> {
    super::super::wording::rewritten(&tokens, |i, out| {
        let n = begins(
            &tokens[i..],
            "than now|than it is now|than it is|than before|than at present|than it does now|than he is now|than she is now|than they are now|than at the moment|than currently",
        )?;
        let way = is(
            out.last(),
            &[
                "further", "farther", "closer", "nearer", "away", "back", "forward", "ahead",
            ],
        );
        let metres = out.iter().rev().take(4).any(|t| number(t).is_some());
        (way && metres && tokens.get(i + n).is_none_or(is_mark)).then_some(i + n)
    })
}

/// "behind us we have enough with one car", "we can make do with two cones": so many of them stay.
fn enough_with(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const ENOUGH: &[&str] = &[
        "we have enough with",
        "i have enough with",
        "we have enough of",
        "we can make do with",
        "i can make do with",
        "we can do with",
        "we can get by with",
        "we can manage with",
        "i am content with",
        "we are content with",
        "we make do with",
        "im content with",
        "i am satisfied with",
        "we get by with",
        "i can get by with",
        "i can manage with",
        "we will make do with",
        "lets make do with",
        "let us make do with",
        "make do with",
        "it is enough with",
        "i am fine with",
        "im fine with",
        "i am happy with",
        "we would manage with",
    ];
    let Some((k, n)) = find(&tokens, ENOUGH) else {
        return tokens;
    };
    let only = begins(&tokens[k + n..], "only|just").unwrap_or(0);
    let single =
        usize::from(is(tokens.get(k + n + only), &["a"]) && is(tokens.get(k + n + only + 1), &["single"]));
    let one = led(
        "one",
        &tokens[k],
        &[tokens.get(k + n + only + 2..).unwrap_or(&[])],
    );
    let np = if single > 0 {
        &one[..]
    } else {
        &tokens[k + n + only..]
    };
    let Some((many, (_, b))) = count(np.first()).zip(first_noun(np).filter(|x| x.0 < 4)) else {
        return tokens;
    };
    let (place, late) = (trimmed(&tokens[..k]), trimmed(&np[b..]));
    let where_at = if place.is_empty() { late } else { place };
    let plain = where_at.is_empty() || is_place(where_at) && !has_noun(where_at);
    let the = [&all_of(&np[1..b]), where_at].concat();
    if !plain || !(place.is_empty() || late.is_empty()) || talk.fits(&the) as i64 <= many {
        return tokens;
    }
    led(
        "keep only",
        &tokens[0],
        &[&np[..1], &led("of", &tokens[0], &[&the])],
    )
}

/// "on the right lane nothing more": what is there goes.
fn nothing_there(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, n)) = find(
        &tokens,
        &[
            "nothing more",
            "nothing any more",
            "nothing anymore",
            "nothing at all",
            "nothing",
        ],
    )
    .filter(|x| x.0 > 1) else {
        return tokens;
    };
    let late = trimmed(&tokens[k + n..]);
    let polite = late
        .iter()
        .all(|t| is_mark(t) || is(Some(t), &["thanks", "thank", "you", "please"]));
    let place = &tokens[..k];
    let said = place
        .iter()
        .any(|t| is_mark(t) || HELPERS.contains(&text(t)) || is(Some(t), &["there", "see", "want"]));
    if polite && is_place(place) && !has_noun(place) && !said {
        return led("remove everything", &tokens[0], &[place]);
    }
    tokens
}

/// How many there would be, of so many.
fn times(remark: &[Token], now: i64) -> Option<i64> {
    const DOUBLE: &[&str] = &["twice", "double", "two times", "twofold"];
    const TRIPLE: &[&str] = &["three times", "triple", "thrice"];
    const HALF: &[&str] = &["half"];
    if leads(remark, DOUBLE).is_some() {
        return Some(2 * now);
    }
    if leads(remark, TRIPLE).is_some() {
        return Some(3 * now);
    }
    if leads(remark, HALF).is_some() {
        return (now % 2 == 0).then_some(now / 2);
    }
    let n = count(remark.first())?;
    match remark.get(1).map(text)? {
        "more" => Some(now + n),
        "fewer" | "less" => Some(now - n),
        _ => None,
    }
}

/// "eight parked cars, please, twice as many as now": eight in all, if that is so.
fn compared(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = lead_of(&tokens);
    let Some(many) = count(tokens.get(lead)) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[lead + 1..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let noun = &tokens[lead + 1..lead + 1 + b];
    let from = lead + 1 + b;
    let now = talk.fits(&led("the", &tokens[lead], &[noun])) as i64;
    let found = (from..tokens.len()).find(|k| {
        let rest = &tokens[k + 1..];
        let rest = &rest[begins(
            rest,
            "that is|i e|which is|so|thats|exactly|just|meaning|in other words",
        )
        .unwrap_or(0)..];
        let refers = rest.iter().any(|t| {
            matches!(
                text(t),
                "now"
                    | "before"
                    | "present"
                    | "current"
                    | "currently"
                    | "far"
                    | "already"
                    | "today"
                    | "existing"
                    | "moment"
                    | "original"
                    | "originally"
                    | "previously"
            )
        });
        (is_mark(&tokens[*k]) || is(tokens.get(*k), &["so"]))
            && refers
            && !has_noun(rest)
            && times(rest, now) == Some(many)
    });
    match found {
        Some(k) if now > 0 => led("there should be", &tokens[0], &[trimmed(&tokens[lead..k])]),
        _ => tokens,
    }
}

/// "three cyclists in place of one, all of them behind us": three in all, where one is.
fn in_place_of(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = lead_of(&tokens);
    let Some((i, n)) = find(
        &tokens,
        &[
            "in place of",
            "instead of",
            "rather than",
            "where there is",
            "where there are",
            "where now there is",
            "where now there are",
            "where we have",
            "where there was",
            "where there were",
            "where i see",
        ],
    )
    .filter(|x| x.0 > lead + 1) else {
        return tokens;
    };
    let only = begins(
        &tokens[i + n..],
        "the|just|only|just the|only the|just this|this|merely",
    )
    .unwrap_or(0);
    let old = i + n + only;
    let (Some(_), Some(now)) = (count(tokens.get(lead)), count(tokens.get(old))) else {
        return tokens;
    };
    let rest = &tokens[old + 1..];
    let rest = &rest[begins(
        rest,
        "only now|only|now|at the moment|at present|today|so far|right now|currently",
    )
    .unwrap_or(0)..];
    let np = &tokens[lead + 1..i];
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 3) else {
        return tokens;
    };
    // "..., all of them behind us"
    let comma = usize::from(rest.first().is_some_and(is_mark));
    let all = comma
        + begins(
            &rest[comma..],
            "all of them|all|both|both of them|each|each of them|they should all be|all three|all four",
        )
        .unwrap_or(0);
    let late = &rest[all..];
    let place = if late.is_empty() {
        np.get(b..).filter(|p| is_place(p)).unwrap_or(&[])
    } else {
        late
    };
    let here = place.is_empty() || is_place(place) && !has_noun(place);
    let queued = leads(
        &np[b..],
        &[
            "nose to tail",
            "in a row",
            "one behind the other",
            "one after the other",
            "in a line",
            "in line",
            "in a queue",
        ],
    ) == Some(np.len() - b);
    let plain =
        (np[b..].is_empty() || queued || is_place(&np[b..])) && (late.is_empty() || np[b..].is_empty());
    let the = |parts: &[&[Token]]| talk.fits(&led("the", &tokens[lead], parts)) as i64;
    if !(here && plain) || the(&[&np[..b]]) != now && the(&[&np[..b], place]) != now {
        return tokens;
    }
    led(
        "there should be",
        &tokens[0],
        &[&tokens[lead..=lead], &np[..b], place],
    )
}

const BESIDES: &[&str] = &[
    "besides",
    "apart from",
    "next to",
    "other than",
    "except for",
    "except",
    "aside from",
    "in addition to",
    "along with",
    "but for",
    "beside",
    "not counting",
];
const THERE: &[&str] = &[
    "is still there",
    "are still there",
    "is still here",
    "are still here",
    "is left",
    "are left",
    "remains",
    "remain",
    "is there",
    "are there",
    "is still around",
    "are still around",
    "is still parked there",
    "are still parked there",
    "is still present",
    "are still present",
    "still stands there",
    "still stand there",
    "is around",
    "is still standing there",
    "are still standing there",
    "has stayed",
    "have stayed",
    "is here",
    "are here",
    "was still there",
    "were still there",
    "is still parked",
    "are still parked",
    "is left over",
    "are left over",
];

/// What is said before, with a comma for its "and": a statement that a command follows.
fn apart_from_it(before: &[Token]) -> Vec<Token> {
    let mut out = before.to_vec();
    let and = out
        .len()
        .checked_sub(1)
        .filter(|k| is(out.get(*k), &["and"]) && has_noun(before));
    if let Some(k) = and {
        match k.checked_sub(1).filter(|j| is_mark(&out[*j])) {
            Some(_) => out.truncate(k),
            None => {
                out[k].kind = TokenKind::Comma;
                out[k].text = ",".into();
            }
        }
    }
    out
}

/// "besides the pickup just one of the cars is still there": the other cars go.
fn still_there(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let spared =
        leads(tokens, BESIDES).and_then(|n| Some((n, first_noun(&tokens[n..]).filter(|x| x.0 < 4)?.1)));
    let (spared, from) = match spared {
        Some((n, b)) => (Some(&tokens[n..n + b]), n + b),
        None => (None, 0),
    };
    let comma = from + usize::from(spared.is_some() && tokens.get(from).is_some_and(is_mark));
    let there = begins(&tokens[comma..], "there is|there are|i see|we see").unwrap_or(0);
    let only =
        begins(&tokens[comma + there..], "just|only|merely|no more than").map(|n| comma + there + n)?;
    let n = count(tokens.get(only)).filter(|_| there == 0)?;
    let np = &tokens[only + 1..];
    let of = begins(np, "of the|of those|of these").unwrap_or(0);
    let (_, b) = first_noun(&np[of..]).filter(|x| x.0 < 3)?;
    let noun = &np[of..of + b];
    let late = &np[of + b..];
    let the = all_of(noun);
    let boxes = talk.boxes_of(&the);
    let apart = spared.is_none_or(|s| {
        let others = talk.boxes_of(s);
        !others.is_empty()
            && others
                .iter()
                .all(|o| boxes.iter().all(|b| b.center_m != o.center_m))
    });
    let more = boxes.len() as i64 > n;
    if leads(late, THERE) != Some(late.len()) || !apart || !more {
        return None;
    }
    Some(led(
        "keep only",
        &tokens[0],
        &[&tokens[only..=only], &led("of", &tokens[only], &[&the])],
    ))
}

/// "two cones left, one worker": so many of those that are there.
fn so_many_left(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let mut listed = false;
    super::super::wording::rewritten(&tokens, |i, out| {
        begins_at(&tokens, i).then_some(())?;
        // ("a single cone is left")
        let lone = begins(&tokens[i..], "a single|a lone|a sole|a solitary|one single").unwrap_or(0);
        let one = led("one", &tokens[i], &[]);
        let (many, i) = match lone {
            0 => (&tokens[i..=i], i),
            n => (&one[..], i + n - 1),
        };
        let n = count(many.first())?;
        let (_, b) = first_noun(&tokens[i + 1..]).filter(|x| x.0 < 2)?;
        let noun = &tokens[i + 1..=i + b];
        let end = i + 1 + b;
        let left = begins(
            tokens.get(end..)?,
            "left|remaining|is left|are left|remains|remain|is still left|are still left|is left over|are left over",
        )
        .unwrap_or(0);
        // ("one cone is left in our lane": of those there)
        let opens = out.last().is_none_or(|t| is_mark(t) || is(Some(t), &["and"]));
        let place = match tokens.get(end + left).filter(|_| left > 0 && opens) {
            Some(_) if is_place(&tokens[end + left..]) => (end + left..tokens.len())
                .find(|k| is_mark(&tokens[*k]) || is(tokens.get(*k), &["and"]))
                .unwrap_or(tokens.len()),
            _ => end + left,
        };
        let place = &tokens[end + left..place];
        let plain = place.is_empty() || !has_noun(place) && !place.iter().any(|t| number(t).is_some());
        let closes = tokens
            .get(end + left + place.len())
            .is_none_or(|t| is_mark(t) || is(Some(t), &["and"]));
        // ("... left, one worker": the others of a list, too)
        let the = [&all_of(noun), place].concat();
        if !closes || !plain || !(left > 0 || listed) || talk.fits(&the) as i64 <= n {
            return None;
        }
        listed = true;
        out.extend(led(
            "keep only",
            &tokens[i],
            &[many, &led("of", &tokens[i], &[&the])],
        ));
        Some(end + left + place.len())
    })
}

const SAME: &str =
    "same|the same|exactly the same|just the same|again the same|once more the same|once again the same";
const THING: [&str; 33] = [
    "intersection",
    "junction",
    "crossing",
    "roundabout",
    "highway",
    "motorway",
    "bend",
    "curve",
    "lot",
    "crossroads",
    "freeway",
    "scene",
    "thing",
    "drive",
    "picture",
    "situation",
    "place",
    "street",
    "road",
    "setting",
    "ride",
    "again",
    "scenario",
    "layout",
    "shot",
    "view",
    "spot",
    "image",
    "trip",
    "case",
    "moment",
    "constellation",
    "set",
];

/// "same drive by night and with a single car behind us": one in all.
fn same_with(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = begins(&tokens, SAME).filter(|n| is(tokens.get(*n), &THING)) else {
        return tokens;
    };
    let found = (n + 1..tokens.len()).find_map(|k| {
        is(tokens.get(k), &["with"]).then_some(())?;
        let only = begins(&tokens[k + 1..], "just|only|exactly|now|now only|but").unwrap_or(0);
        let from = k + 1 + only;
        let single = begins(&tokens[from..], "a single|one single|just one|only one").unwrap_or(0);
        let counted = single > 0
            || count(tokens.get(from)).is_some()
                && !is(
                    tokens.get(from + 1),
                    &["more", "further", "additional", "extra", "other", "fewer", "less"],
                );
        let one = only > 0 && is(tokens.get(from), &["a", "an"]);
        (counted || one).then_some((k, from, single.max(usize::from(one))))
    });
    let Some((k, from, single)) = found else {
        return tokens;
    };
    let rest = &tokens[from + single..];
    let named = first_noun(rest).is_some_and(|x| x.0 < 4);
    // (nothing but what is there may follow)
    let verbs = rest
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
    if !named || verbs {
        return tokens;
    }
    let mut head = trimmed(&tokens[n + 1..k]).to_vec();
    if !head.is_empty() {
        head.push(Token {
            kind: TokenKind::Comma,
            ..led(",", &tokens[k], &[])[0].clone()
        });
    }
    let one = if single > 0 {
        led("exactly one", &tokens[from], &[])
    } else {
        led("exactly", &tokens[from], &[])
    };
    [&head[..], &led("there should be", &tokens[k], &[&one, rest])].concat()
}
