//! Turns of speech that other rules would take for more than they say: "except for the coach all vehicles may go", "the other
//! two ride on", "not five cones, three", "behind the taxi nobody", "the car's owner has driven it away".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::words::{find, first_noun, has_noun, is, is_place, is_unit, leads, led, number, text, trimmed};

const SUN: &str = "rain over|sun out|snow over|fog gone|rain gone|snow gone|the rain over|the sun out";

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // ("let it snow over the street" is no end of it)
    let over = find(&tokens, &["rain over", "snow over"]).is_some_and(|x| {
        is(
            tokens.get(x.0 + x.1),
            &["the", "our", "my", "this", "that", "all"],
        )
    });
    let out = if over {
        tokens
    } else {
        replaced(&tokens, SUN, "clear weather")
    };
    let out = just_verb(out);
    let out = fronted_exception(out);
    let out = others_go_on(out);
    let out = not_so_many(out, talk);
    let out = nobody_there(out, talk);
    let out = driven_off(out, talk);
    let out = distance_between(out, talk);
    let out = beside_the_others(out, talk);
    away_and_over(all_gone_but(out), talk)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

/// "just double the cones": nothing else goes.
fn just_verb(mut tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len()).find(|i| {
        let verb = is(
            tokens.get(i + 1),
            &[
                "double", "triple", "halve", "add", "move", "remove", "delete", "turn", "replace", "swap",
                "put", "make", "shift", "change", "bring", "send",
            ],
        );
        is(tokens.get(*i), &["just", "only", "simply"])
            && verb
            && (*i == 0 || ends(tokens.get(i - 1)) || is(tokens.get(i - 1), &["and", "but", "please", "no"]))
    });
    if let Some(i) = found {
        tokens.remove(i);
    }
    tokens
}

/// "except for the coach all vehicles are to go": all vehicles except the coach.
fn fronted_exception(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "except for",
            "except",
            "apart from",
            "but for",
            "save for",
            "aside from",
            "with the exception of",
            "other than",
        ],
    ) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..])
        .filter(|x| x.0 < 4 && is(tokens.get(n), &["the", "my", "that", "those", "these"]))
    else {
        return tokens;
    };
    let Some(all) = (n + b..tokens.len().min(n + b + 8))
        .find(|k| is(tokens.get(*k), &["all", "every", "each", "both", "no"]))
    else {
        return tokens;
    };
    let except = &tokens[n..all];
    let Some((a, e)) = first_noun(&tokens[all..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let whole = is(
        tokens.get(all + a),
        &["objects", "things", "everything", "everyone", "everybody"],
    );
    if whole || is(tokens.get(all), &["no"]) {
        return tokens;
    }
    let but = led("except", &tokens[0], &[trimmed(except)]);
    [&tokens[all..all + e], &but, &tokens[all + e..]].concat()
}

/// "the other two ride on", "the others stay": nothing changes for them.
fn others_go_on(tokens: Vec<Token>) -> Vec<Token> {
    const GO: &[&str] = &[
        "ride on",
        "drive on",
        "walk on",
        "go on",
        "carry on",
        "rides on",
        "drives on",
        "walks on",
        "goes on",
        "carries on",
        "keep going",
        "keeps going",
        "keep riding",
        "keep driving",
        "keep walking",
        "keeps riding",
        "keeps driving",
        "keeps walking",
        "continue",
        "continues",
        "keep on",
        "stay on course",
        "go straight on",
        "go on as before",
        "continue as before",
        "do not",
        "does not",
        "dont",
        "doesnt",
    ];
    let found = (2..tokens.len()).find_map(|i| {
        (ends(tokens.get(i - 1)) || is(tokens.get(i - 1), &["and", "while", "but"])).then_some(())?;
        let n = leads(
            &tokens[i..],
            &[
                "the other two",
                "the other three",
                "the other four",
                "the other one",
                "the others",
                "the other",
                "the rest",
            ],
        )?;
        let m = leads(&tokens[i + n..], GO)?;
        ends(tokens.get(i + n + m)).then_some((i - 1, i + n + m))
    });
    match found {
        Some((from, end)) if has_noun(&tokens[..from]) => {
            let lead = usize::from(from > 0 && ends(tokens.get(from - 1)));
            [&tokens[..from - lead], &tokens[end..]].concat()
        }
        _ => tokens,
    }
}

/// "not five cones, three": three.
fn not_so_many(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !is(tokens.first(), &["not"]) || tokens.get(1).is_none_or(|t| number(t).is_none()) {
        return tokens;
    }
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 5) else {
        return tokens;
    };
    let mut k = b;
    while ends(tokens.get(k)) && k < tokens.len() || is(tokens.get(k), &["but", "just", "only", "rather"]) {
        k += 1;
    }
    let many = tokens.get(k).filter(|t| number(t).is_some());
    match many {
        Some(many) if k > b && ends(tokens.get(k + 1)) && talk.fits(&tokens[2..b]) > 0 => led(
            "keep exactly",
            &tokens[0],
            &[std::slice::from_ref(many), &tokens[2..b], &tokens[k + 1..]],
        ),
        _ => tokens,
    }
}

/// "behind the taxi nobody, in front of it a bus": a remark, and what is asked for.
fn nobody_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = (2..tokens.len())
        .find(|i| is(tokens.get(*i), &["nobody", "nothing", "noone"]) && ends(tokens.get(i + 1)))
    else {
        return tokens;
    };
    let place = &tokens[..i];
    if !is_place(place) || place.iter().any(|t| t.kind != TokenKind::Word) {
        return tokens;
    }
    let objects = led("objects", &tokens[0], &[place]);
    let rest = trimmed(&tokens[i + 1..]);
    // ("in front of it a bus": of what was named)
    let mut rest = rest.to_vec();
    if let (Some(k), Some((a, b))) = (rest.iter().position(|t| text(t) == "it"), first_noun(place)) {
        rest.splice(k..=k, led("the", &tokens[0], &[&place[a..b]]));
    }
    // (who is meant to go, if anybody is there, is not sure)
    if talk.fits(&objects) == 0 || !rest.is_empty() {
        rest
    } else {
        tokens
    }
}

/// "the white car's owner has come back and driven it away": the car goes.
fn driven_off(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(k) =
        (2..tokens.len().min(6)).find(|k| is(tokens.get(*k), &["owner", "driver", "rider", "owners"]))
    else {
        return tokens;
    };
    let of = is(tokens.get(k + 1), &["of"]);
    let np = if of {
        let Some((_, b)) = first_noun(&tokens[k + 2..]).filter(|x| x.0 < 4) else {
            return tokens;
        };
        &tokens[k + 2..k + 2 + b]
    } else {
        &tokens[..k]
    };
    let vehicle = first_noun(np).is_some_and(|x| x.1 == np.len() || x.0 < 3) && talk.fits(np) > 0;
    let off = find(
        &tokens[k..],
        &[
            "driven it away",
            "driven it off",
            "drove it away",
            "drove it off",
            "taken it away",
            "taken it home",
            "ridden it away",
            "driven it home",
            "drives it away",
            "drives it off",
            "drives it home",
            "driven away",
            "driven off",
            "taken it with him",
            "taken it with her",
            "moved it away",
        ],
    );
    let Some((i, n)) = off.filter(|_| vehicle && is(np.first(), &["the", "my", "that", "both"])) else {
        return tokens;
    };
    if !ends(tokens.get(k + i + n)) {
        return tokens;
    }
    [&led("remove", &tokens[0], &[np])[..], &tokens[k + i + n..]].concat()
}

/// "put some more distance between us and the coach, say 30 m": it is 30 m away.
fn distance_between(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "distance between us and",
            "space between us and",
            "room between us and",
            "distance between me and",
            "space between me and",
            "distance to",
            "space to",
            "room to",
        ],
    ) else {
        return tokens;
    };
    let more = tokens[..i]
        .iter()
        .any(|t| is(Some(t), &["more", "some", "extra"]));
    let less = tokens[..i].iter().any(|t| is(Some(t), &["less"]));
    let np = &tokens[i + n..];
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 4 && is(np.first(), &["the", "my", "that", "both"]))
    else {
        return tokens;
    };
    if !(more || less) || talk.fits(&np[..b]) == 0 || has_noun(&np[b..]) {
        return tokens;
    }
    match (b..np.len()).find(|k| number(&np[*k]).is_some() && is_unit(np.get(k + 1))) {
        Some(k) => [
            &np[..b],
            &led("should keep a distance of", &tokens[0], &[&np[k..]])[..],
        ]
        .concat(),
        None => led(
            "move",
            &tokens[0],
            &[
                &np[..b],
                &led(if less { "closer" } else { "further away" }, &tokens[0], &[]),
            ],
        ),
    }
}

/// "a third car has parked behind the other two": one more of them.
fn beside_the_others(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let ordinal = tokens
        .get(1)
        .is_some_and(|t| super::super::foremost::ordinal(text(t)).is_some());
    if !is(tokens.first(), &["a", "an"]) || !ordinal {
        return tokens;
    }
    let Some((a, b)) = first_noun(&tokens).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let Some((i, n)) = find(
        &tokens,
        &[
            "behind the other",
            "beside the other",
            "next to the other",
            "with the other",
            "alongside the other",
            "after the other",
            "by the other",
            "near the other",
            "behind the others",
            "beside the others",
            "next to the others",
            "with the others",
        ],
    ) else {
        return tokens;
    };
    let mut end = i + n;
    while tokens
        .get(end)
        .is_some_and(|t| number(t).is_some() || is(Some(t), &["ones", "one"]))
    {
        end += 1;
    }
    if i < b || i > b + 4 || !ends(tokens.get(end)) || talk.fits(&tokens[a..b]) == 0 {
        return tokens;
    }
    [
        &led("add another", &tokens[0], &[&tokens[2..b]])[..],
        &tokens[end..],
    ]
    .concat()
}

/// "all gone but the van": only the van stays.
fn all_gone_but(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "all gone but",
            "all gone except",
            "all gone except for",
            "all gone apart from",
            "everything gone but",
            "everything gone except",
            "everything gone except for",
            "all away but",
            "all away except",
            "everything away but",
        ],
    ) else {
        return tokens;
    };
    let np = &tokens[i + n..];
    if has_noun(&tokens[..i]) || !is(np.first(), &["the", "my", "that", "both"]) {
        return tokens;
    }
    led("keep only", &tokens[0], &[np])
}

/// "cones away from the left, over to the right edge": there they go.
fn away_and_over(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((a, b)) = first_noun(&tokens).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let Some(n) = leads(&tokens[b..], &["away from", "off", "out of", "from"]) else {
        return tokens;
    };
    let verb = super::super::rephrase::is_verb(&tokens[0]) && a > 0;
    let Some(k) = (b + n..tokens.len().min(b + n + 7)).find(|k| {
        is(tokens.get(*k), &["to", "onto", "into"])
            && (ends(tokens.get(k - 1))
                || is(tokens.get(k - 1), &["over", "and"])
                || super::words::is_goal(&tokens[*k..]))
    }) else {
        return tokens;
    };
    if verb
        || has_noun(&tokens[b + n..])
        || talk.fits(&tokens[..b]) == 0
        || is(tokens.first(), &["a", "an", "another", "no"])
    {
        return tokens;
    }
    let the = if is(tokens.first(), &["the", "both", "all", "my"]) {
        tokens[..b].to_vec()
    } else {
        led("the", &tokens[0], &[&tokens[..b]])
    };
    led("move", &tokens[0], &[&the, &tokens[k..]])
}
