//! Wishes in roundabout words: "give the worker two colleagues", "without the van it would be better", "increase the distance to
//! the car behind to 20 m", "the crossing should be empty", "as many barriers as there are cones".

use super::super::lexicon::{Sense, look_up, plural};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, replaced, rewritten};
use super::Talk;
use super::lists::HELPERS;
use super::spaces::{distance_to, emptied, into_row, spaces_filled};
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

const MAKE_DO: &str = "can do with just|could do with just|get by with|get along with|make do with|manage with|settle for|be content with|make do with just";
const IN_TRUTH: &str = "in reality|in truth|as a matter of fact|in actual fact|strictly speaking";
const NONE: &str = "i want to see none of them|i want to see none|i want none of them|i want none|i would like none|id like none|we want none|we need none|i need none|let there be none|there should be none|there must be none|make it none";
const MOVING: &str = "whatever moves|everything that moves|anything that moves|all that moves|everything that is moving|anything that is moving|everything moving|whatever is moving|all that is moving|everything in motion|anything in motion";

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(&content_with(tokens), MAKE_DO, "keep only");
    let out = replaced(&out, IN_TRUTH, "");
    let out = replaced(&out, NONE, "remove them");
    let out = replaced(&out, MOVING, "all moving objects");
    let out = seen(so_many(out, talk), talk);
    let out = given(out, talk);
    let out = better_with(without(out, talk));
    let out = distance_to(out, talk);
    let out = emptied(into_row(spaces_filled(out), talk));
    let out = every_second(by_half(out));
    as_many_as(out, talk)
}

/// "I'd be happy with just one oncoming car": so many are kept.
fn content_with(tokens: Vec<Token>) -> Vec<Token> {
    const CONTENT: &str = "happy with|content with|satisfied with|fine with|okay with|ok with|pleased with";
    rewritten(&tokens, |i, out| {
        let n = begins(&tokens[i..], CONTENT)?;
        let only = usize::from(is(tokens.get(i + n), &["just", "only"]));
        // ("happy with one of them" is said of whom)
        let many = tokens.get(i + n + only).is_some_and(|t| number(t).is_some())
            && first_noun(&tokens[i + n..]).is_some_and(|x| x.0 < 5)
            && !is(tokens.get(i + n + only + 1), &["of"]);
        let adverb = usize::from(is(out.last(), &["quite", "perfectly", "perfect", "very", "also"]));
        let be = out.len().checked_sub(adverb + 1)?;
        let wishes = is(out.get(be), &["be", "im", "am", "were", "are"])
            && out[..be].iter().all(|t| {
                is(
                    Some(t),
                    &[
                        "i", "we", "id", "wed", "would", "will", "could", "ill", "well", "and", "but", "so",
                    ],
                )
            });
        // ("happy with a tram instead of the bus" wants one)
        let new = only == 0 && is(tokens.get(i + n), &["a", "an", "another"]);
        (wishes && (many || new)).then_some(())?;
        // (everything before only says who is)
        let link = out[..be]
            .iter()
            .take_while(|t| is(Some(t), &["and", "but", "so"]))
            .count();
        out.truncate(link);
        out.extend(led(if new { "add" } else { "keep only" }, &tokens[i], &[]));
        Some(i + n + only)
    })
}

/// What is only spoken of.
pub(super) fn remark(np: &[Token]) -> Vec<Token> {
    let the = if is(
        np.first(),
        &["the", "both", "all", "that", "this", "my", "those", "these"],
    ) {
        "leave"
    } else {
        "leave the"
    };
    led(the, &np[0], &[np, &led("alone", &np[0], &[])])
}

pub(super) fn begins_at(tokens: &[Token], i: usize) -> bool {
    i == 0
        || !matches!(tokens[i - 1].kind, TokenKind::Word | TokenKind::Number(_))
        || is(
            tokens.get(i - 1),
            &["and", "then", "but", "so", "please", "now", "also", "just"],
        )
}

fn is_fresh(t: Option<&Token>) -> bool {
    is(t, &["a", "an", "another", "some"]) || t.is_some_and(|t| number(t).is_some())
}

/// "we don't need so many people": which are too many.
fn so_many(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "we dont need so many",
            "i dont need so many",
            "we do not need so many",
            "i do not need so many",
            "we dont need that many",
            "i dont need that many",
            "i dont want so many",
            "we dont want so many",
            "i dont want that many",
            "not so many",
            "we dont need this many",
            "there are so many",
            "why are there so many",
            "why so many",
        ],
    ) else {
        return tokens;
    };
    let np = &tokens[n..];
    match first_noun(np).filter(|x| x.0 < 3 && (x.1 == np.len() || is_place(&np[x.1..]))) {
        Some(_) if talk.fits(np) > 0 && !np.iter().any(|t| t.kind != TokenKind::Word) => remark(np),
        _ => tokens,
    }
}

/// "I see four pedestrians, ...", where there are four: a remark.
fn seen(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "i see",
            "we see",
            "i can see",
            "we can see",
            "i count",
            "right now there are",
            "currently there are",
            "at the moment there are",
            "i have",
            "we have",
            "there are",
            "there is",
        ],
    ) else {
        return tokens;
    };
    let Some(many) = tokens.get(n).and_then(number) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let close = (n + b..tokens.len())
        .find(|k| tokens[*k].kind != TokenKind::Word || is(tokens.get(*k), &["but", "and"]));
    // (alone it says only what is meant next)
    let Some(close) = close.filter(|c| c + 2 < tokens.len()) else {
        let np = &tokens[n + 1..];
        let now = np
            .iter()
            .any(|t| matches!(text(t), "now" | "more" | "only" | "just"));
        let same = close.is_none() && !now && many > 1 && talk.fits(np) == many.max(0) as usize;
        return if same { remark(np) } else { tokens };
    };
    let np = &tokens[n + 1..close];
    if talk.fits(np) != many.max(0) as usize {
        return tokens;
    }
    let rest = trimmed(&tokens[close..]);
    // what follows speaks of them
    let it = rest
        .iter()
        .position(|t| matches!(text(t), "them" | "they" | "those"));
    match it {
        Some(k) => [&rest[..k], &led("the", &rest[k], &[np]), &rest[k + 1..]].concat(),
        None => {
            // "I count four cars but I need seven"
            let k = rest.iter().take(5).position(|t| number(t).is_some());
            let ends = k.is_some_and(|k| {
                rest.get(k + 1)
                    .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["please", "instead", "of"]))
            });
            match k.filter(|_| ends && !has_noun(rest)) {
                Some(k) => led("keep exactly", &tokens[0], &[&rest[k..=k], np]),
                None if has_noun(rest) => rest.to_vec(),
                None if rest.iter().all(|t| number(t).is_none()) => remark(np),
                None => tokens,
            }
        }
    }
}

/// "give the worker two colleagues": two more beside him; "give the jogger some company" alone says nothing more.
fn given(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = (0..tokens.len()).find(|i| {
        is(tokens.get(*i), &["give", "get", "bring", "lend", "assign"])
            && (is(tokens.get(i + 1), &["the", "both", "that", "my", "each"])
                || is(tokens.get(i + 1), &["him", "her", "them"])
                    && talk.last.is_some()
                    && is_fresh(tokens.get(i + 2)))
            && begins_at(&tokens, *i)
    }) else {
        return tokens;
    };
    // "give him a colleague": him who was named
    if is(tokens.get(i + 1), &["him", "her", "them"]) {
        let named = first_noun(&tokens[..i]).map(|x| tokens[x.0..x.1].to_vec());
        let Some(who) = named.or_else(|| talk.last.as_ref().map(|l| led(l, &tokens[i], &[]))) else {
            return tokens;
        };
        let the = led("the", &tokens[i], &[&who]);
        let again = [&tokens[..=i], &the, &tokens[i + 2..]].concat();
        return given(again, talk);
    }
    let Some((_, b)) = first_noun(&tokens[i + 1..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let to = i + 1 + b;
    let np = &tokens[i + 1..to];
    if talk.fits(np) == 0 {
        return tokens;
    }
    let rest = &tokens[to..];
    let company = leads(
        rest,
        &[
            "some company",
            "company",
            "a bit of company",
            "some support",
            "some help",
            "a hand",
            "a helping hand",
        ],
    );
    if let Some(n) = company {
        let more = trimmed(&rest[n..]);
        let more = if is(more.first(), &[":"]) {
            trimmed(&more[1..])
        } else {
            more
        };
        if has_noun(more) {
            return [&tokens[..i], more].concat();
        }
        // "add three more": of those
        if let Some(k) = more
            .iter()
            .position(|t| number(t).is_some() || is(Some(t), &["another"]))
        {
            let k = k + 1 + usize::from(is(more.get(k + 1), &["more", "one"]));
            let mut noun = super::some_of::bare_np(np);
            if let Some(last) = noun.last_mut() {
                last.text = plural(&last.text);
            }
            return [&tokens[..i], &more[..k], &noun, &more[k..]].concat();
        }
        return tokens;
    }
    let Some((_, e)) = first_noun(rest).filter(|x| x.0 < 4 && is_fresh(rest.first())) else {
        return tokens;
    };
    let new = &rest[..e];
    let tail = &rest[e..];
    let told = is(trimmed(tail).first(), &["who", "that", "which"]);
    // "a teacher, who stands with them": beside them
    let with = super::words::find(
        trimmed(tail),
        &[
            "with them",
            "beside them",
            "next to them",
            "with him",
            "with her",
            "beside him",
            "beside her",
        ],
    );
    if told && with.is_some_and(|x| x.0 < 4) {
        let skip = usize::from(
            tail.first()
                .is_some_and(|t| t.kind == super::super::tokens::TokenKind::Comma),
        );
        let end = (skip + 1..tail.len())
            .find(|k| tail[*k].kind == super::super::tokens::TokenKind::Comma || is(tail.get(*k), &["and"]))
            .unwrap_or(tail.len());
        return [
            &tokens[..i],
            &led("add", &tokens[i], &[new, &led("next to", &tokens[i], &[np])]),
            &tail[end..],
        ]
        .concat();
    }
    // "two colleagues on the same sidewalk": there
    if super::words::leads(
        tail,
        &[
            "on the same",
            "in the same",
            "at the same",
            "on the other",
            "on the opposite",
        ],
    )
    .is_some()
    {
        let same = is(tail.get(2), &["same"])
            .then(|| super::brief_places::strip_of(np, talk))
            .flatten();
        if let (Some(strip), true) = (same, tail.len() < 5) {
            return [
                &tokens[..i],
                &led("add", &tokens[i], &[new, &led(strip, &tokens[i], &[])]),
            ]
            .concat();
        }
        return [&tokens[..i], &led("add", &tokens[i], &[new, tail])].concat();
    }
    if told
        || is_place(tail)
        || tail
            .first()
            .is_some_and(|t| t.kind == TokenKind::Word && !is(Some(t), &["and", "too", "please"]))
    {
        return tokens;
    }
    let trailer = is(new.last(), &["trailer", "caravan"]);
    let at = led(if trailer { "behind" } else { "next to" }, &tokens[i], &[np]);
    let add = led("add", &tokens[i], &[new, &at]);
    [&tokens[..i], &add, tail].concat()
}

/// "without the van behind us the scene would be better", "the street at night, without the people": they go.
fn without(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = (0..tokens.len()).find(|i| {
        is(tokens.get(*i), &["without", "minus", "sans"])
            && is(
                tokens.get(i + 1),
                &["the", "that", "those", "these", "any", "all", "both", "my", "our"],
            )
            && (*i == 0
                || tokens[i - 1].kind != TokenKind::Word
                || is(tokens.get(i - 1), &["but", "and", "only", "just"]))
    }) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[i + 1..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let noun = i + 1 + b;
    let close = (noun..tokens.len())
        .find(|k| {
            tokens[*k].kind != TokenKind::Word
                || is(tokens.get(*k), &["it", "this", "id", "i", "we", "and", "would"])
                || leads(
                    &tokens[*k..],
                    &[
                        "the scene",
                        "the picture",
                        "the street",
                        "the whole",
                        "the situation",
                        "the road",
                        "the view",
                    ],
                )
                .is_some_and(|n| tokens.get(k + n).is_some_and(|t| HELPERS.contains(&text(t))))
        })
        .unwrap_or(tokens.len());
    let any = usize::from(is(tokens.get(i + 1), &["any"]));
    let np = &tokens[i + 1 + any..close];
    if talk.fits(np) == 0 {
        return tokens;
    }
    let remove = led(
        if any == 1 { "remove all the" } else { "remove" },
        &tokens[i],
        &[np],
    );
    let before = trimmed(&tokens[..i]);
    let after = trimmed(&tokens[close..]);
    // what follows only says that it is better so
    let praise = !has_noun(after)
        || after.iter().any(|t| {
            matches!(
                text(t),
                "better" | "nicer" | "prefer" | "perfect" | "cleaner" | "best" | "simpler"
            )
        });
    // "without the bus, please, and at night"
    let style = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
    if i == 0 && after.iter().any(style) && !has_noun(after) {
        let sky = after.iter().position(style).unwrap_or(0);
        let from = after[..sky]
            .iter()
            .rposition(|t| !is(Some(t), &["at", "in", "by", "with"]))
            .map_or(0, |k| k + 1);
        return [&remove[..], &led("and make it", &tokens[i], &[&after[from..]])].concat();
    }
    if i == 0 {
        return match (
            praise,
            is(tokens.get(close), &["and"]) || tokens[close..].iter().any(|t| text(t) == "and"),
        ) {
            (true, _) => remove,
            (false, true) => [&remove[..], &led("and", &tokens[0], &[after])].concat(),
            _ => tokens,
        };
    }
    if !after.is_empty()
        && !is(tokens.get(close), &["and"])
        && tokens.get(close).is_some_and(|t| t.kind == TokenKind::Word)
    {
        return tokens;
    }
    let and = led("and", &tokens[i], &[&remove]);
    [before, &and, &tokens[close..]].concat()
}

/// "I would feel safer with a guard on the sidewalk": one is wanted.
fn better_with(tokens: Vec<Token>) -> Vec<Token> {
    const BETTER: &[&str] = &[
        "better",
        "safer",
        "happier",
        "calmer",
        "nicer",
        "easier",
        "more comfortable",
        "more at ease",
        "more realistic",
        "livelier",
        "more interesting",
        "more lively",
        "perfect",
        "complete",
        "more secure",
        "much better",
        "much safer",
        "a lot better",
        "even better",
        "far better",
        "more convincing",
        "prettier",
        "fuller",
        "less empty",
    ];
    let Some((i, n)) = find(&tokens, BETTER).filter(|x| (2..7).contains(&x.0)) else {
        return tokens;
    };
    let with = i + n;
    let wishes = tokens[..i].iter().any(|t| {
        is(
            Some(t),
            &["would", "id", "wed", "itd", "feel", "be", "might", "could"],
        )
    });
    let new = &tokens[(with + 1).min(tokens.len())..];
    if wishes
        && !has_noun(&tokens[..i])
        && is(tokens.get(with), &["with"])
        && is_fresh(new.first())
        && has_noun(new)
    {
        return led("add", &tokens[0], &[new]);
    }
    tokens
}

/// "reduce the cones by half": halve them.
fn by_half(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find(|i| {
        is(tokens.get(*i), &["half"])
            && is(tokens.get(i - 1), &["by", "to", "in"])
            && tokens
                .get(i + 1)
                .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "please"]))
    });
    let Some(i) = found else {
        return tokens;
    };
    let Some(v) = (0..i - 1).rev().find(|k| {
        is(
            tokens.get(*k),
            &[
                "reduce", "cut", "decrease", "lower", "bring", "shrink", "trim", "thin",
            ],
        ) && begins_at(&tokens, *k)
    }) else {
        return tokens;
    };
    let end = if is(tokens.get(i - 2), &["down", "back"]) {
        i - 2
    } else {
        i - 1
    };
    let skip = leads(
        &tokens[v + 1..end],
        &[
            "down the number of",
            "the number of",
            "down",
            "the amount of",
            "out",
        ],
    )
    .unwrap_or(0);
    let np = &tokens[v + 1 + skip..end];
    if first_noun(np).is_none_or(|x| x.0 > 3) {
        return tokens;
    }
    let the = usize::from(is(np.first(), &["the"]));
    [
        &tokens[..v],
        &led("half the number of", &tokens[v], &[&np[the..]]),
        &tokens[i + 1..],
    ]
    .concat()
}

/// "every second cone": half of the cones.
fn every_second(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "every second one of the",
            "every other one of the",
            "every second",
            "every other",
            "each second",
        ],
    ) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let mut np = tokens[i + n..i + n + b].to_vec();
    if let Some(last) = np.last_mut()
        && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
        && a < 3
    {
        last.text = plural(&last.text);
    }
    let half = led("half of the", &tokens[i], &[&np]);
    [&tokens[..i], &half, &tokens[i + n + b..]].concat()
}

/// "as many barriers as there are cones": so many.
fn as_many_as(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &["as many", "just as many", "exactly as many", "the same number of"],
        )?;
        let times = i > 0 && is(tokens.get(i - 1), &["twice", "times", "half", "double", "thrice"]);
        let (_, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 3 && !times)?;
        let as_ = i + n + b;
        let (k, m) = find(
            &tokens[as_..],
            &["as there are", "as we have", "as there is", "as"],
        )
        .filter(|x| x.0 < 6)?;
        let from = as_ + k + m;
        let (c, d) = first_noun(&tokens[from..]).filter(|x| x.0 < 4)?;
        Some((i, n, as_ + k, from, c, from + d))
    });
    let Some((i, n, as_, from, c, end)) = found else {
        return tokens;
    };
    let many = talk.fits(&tokens[from + c..end]);
    if many == 0 || many > 40 {
        return tokens;
    }
    let digit = Token {
        kind: TokenKind::Number(many as f64),
        text: many.to_string(),
        span: tokens[i].span,
    };
    // "I want as many motorcycles as cars": so many in all
    let wish = [
        "i want",
        "we want",
        "i need",
        "we need",
        "there should be",
        "there must be",
        "let there be",
        "i would like",
        "id like",
        "make it",
        "there are",
        "there shall be",
    ];
    let whole = leads(&tokens, super::some_of::WISHES) == Some(i)
        && !is(tokens.first(), &["add", "insert"])
        && talk.fits(&tokens[i + n..as_]) > 0;
    if whole || leads(&tokens[..i], &wish) == Some(i) {
        return led(
            "keep exactly",
            &tokens[0],
            &[&[digit], &tokens[i + n..as_], &tokens[end..]],
        );
    }
    [&tokens[..i], &[digit], &tokens[i + n..as_], &tokens[end..]].concat()
}
