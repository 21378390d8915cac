//! What stands before or after a command and tells nothing new ("which makes three in total", "wait, no", "so I'm alone there"),
//! and bare notes of where something should be ("motorcycle beside me on the left", "fill up the pavement till five are on it").

use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::lists::HELPERS;
use super::words::{
    find, first_noun, has_noun, is, is_finite, is_place, is_unit, leads, led, number, text, trimmed,
};

/// A text without such ends, before its clauses are parted.
pub fn cut(tokens: Vec<Token>) -> Vec<Token> {
    let tokens = phrased(tokens);
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut ordered = false;
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, std::slice::from_ref(last)),
            _ => (sentence, &[][..]),
        };
        // "exchange the truck for a cyclist; I would like to practise overtaking one"
        if ordered && (begins(body, PURPOSE).is_some() || shows(body)) {
            continue;
        }
        let body = without_tail(without_lead(body));
        let polite = usize::from(is(body.first(), &["please", "kindly"]));
        ordered |= body.get(polite).is_some_and(super::super::rephrase::is_verb);
        out.extend_from_slice(body);
        out.extend_from_slice(stop);
    }
    if out.iter().any(|t| t.kind == TokenKind::Word) {
        out
    } else {
        tokens
    }
}

const LEAD: &str = "we need a bigger crowd here|we need a bigger crowd|i need a bigger crowd|for the level|for this level|for the shot|wait no|no wait|oh no|hmm no|wait|hang on|actually no|sorry no|do one thing|please do one thing|one thing|oh wait|hold on";
const PURPOSE: &str = "i would like to practise|i want to practise|id like to practise|i would like to practice|i want to practice|id like to practice|we want to practise|\
    i want to test|i would like to test|we want to test|i need to test|we need to test|i want to check|we want to check|i want to train|we want to train|\
    i want to demonstrate|i would like to demonstrate|i want to explain|i would like to explain|i want to measure|we want to measure|i want to study|we want to study";

const PHRASES: &[(&str, &str)] = &[
    (
        "go for a stroll|go for a walk|take a stroll|take a walk|have a stroll|have a walk",
        "walk",
    ),
    (
        "goes for a stroll|goes for a walk|takes a stroll|takes a walk",
        "walks",
    ),
    ("clear up the sky|clear the sky|clear the skies", "make it clear"),
    (
        "for my pupils to see|for my students to see|for my class to see|for them to see|for the learner to see|for my pupil to see|for the class to see|for the students to see",
        "",
    ),
    (
        "but this one at|but this one on|but that one at|but that one on|but this time at|but this time on",
        "on",
    ),
    (
        "the very same traffic|the very same scene|the exact same scene|the same traffic",
        "the scene",
    ),
];

const ADD_ONE: &str = "add one|please add one|so add one|put one there|add it|please add it";

/// Phrases in plainer words.
fn phrased(tokens: Vec<Token>) -> Vec<Token> {
    super::super::wording::rewritten(&tokens, |i, out| {
        for (phrases, words) in PHRASES {
            let Some(n) = begins(&tokens[i..], phrases) else {
                continue;
            };
            if words.is_empty() {
                return Some(i + n);
            }
            if *words == "on" && out.last().is_some_and(|t| t.kind == TokenKind::Comma) {
                out.pop();
            }
            out.extend(led(words, &tokens[i], &[]));
            return Some(i + n);
        }
        // "a van is missing on the left; add one": said twice
        let twice = tokens[i].kind == TokenKind::Stop
            && begins(&tokens[i + 1..], ADD_ONE).is_some()
            && out.iter().any(|t| is(Some(t), &["missing", "lacking"]));
        if twice {
            let n = begins(&tokens[i + 1..], ADD_ONE)?;
            let comma = usize::from(tokens.get(i + 1 + n).is_some_and(|t| t.kind == TokenKind::Comma));
            out.push(tokens[i].clone());
            let and = usize::from(is(tokens.get(i + 1 + n + comma), &["and"]));
            return Some(i + 1 + n + comma + and);
        }
        // "two more cars for the cross street": on it
        let given = is(tokens.get(i), &["for"])
            && is(tokens.get(i + 1), &["the", "our", "my"])
            && tokens
                .get(i + 2..)
                .and_then(super::words::longest)
                .is_some_and(|(s, n)| {
                    use super::super::lexicon::Sense;
                    let ends = tokens.get(i + 2 + n).is_none_or(|t| t.kind != TokenKind::Word);
                    ends && matches!(s, Sense::Place(..))
                });
        let fresh = given
            && i > 0
            && super::words::noun_at(&tokens[i - 1..i]).is_some()
            && out
                .iter()
                .rev()
                .take(4)
                .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another", "more"]));
        if fresh {
            out.extend(led("on", &tokens[i], &[]));
            return Some(i + 1);
        }
        // "six cars parked here": in the scene
        let here =
            is(tokens.get(i), &["here"]) && out.last().is_some_and(|t| is(Some(t), &["parked", "standing"]));
        here.then_some(i + 1)
    })
}

/// "the photographs show a single one": what else tells the same.
fn shows(body: &[Token]) -> bool {
    const WITNESS: &[&str] = &[
        "the photographs",
        "the photograph",
        "the photo",
        "the photos",
        "the pictures",
        "the report",
        "the sketch",
        "the footage",
        "the video",
        "the log",
        "the plan",
        "the statement",
        "the drawing",
        "the file",
        "the recording",
        "the police report",
        "the records",
        "the map",
    ];
    leads(body, WITNESS).is_some_and(|n| {
        is(
            body.get(n),
            &[
                "show", "shows", "showed", "says", "say", "mention", "mentions", "has", "have", "confirm",
                "confirms",
            ],
        ) && body[n..]
            .iter()
            .any(|t| is(Some(t), &["one", "it", "that", "so", "this", "them"]))
            && super::words::noun_at(&body[body.len() - 1..]).is_none()
    })
}

fn without_lead(body: &[Token]) -> &[Token] {
    let please = usize::from(is(body.first(), &["please"]));
    let Some(n) = begins(&body[please..], LEAD) else {
        return body;
    };
    let mut rest = &body[please + n..];
    while let Some((_, after)) = rest
        .split_first()
        .filter(|x| matches!(x.0.kind, TokenKind::Comma | TokenKind::Mark))
    {
        rest = after;
    }
    if has_noun(rest) { rest } else { body }
}

/// What follows a comma, or "but", and may be left out up to the end.
const TAILS: &[&str] = &[
    "which makes",
    "making it",
    "making that",
    "that makes",
    "so that makes",
    "distances as they are",
    "distance as it is",
    "distances unchanged",
    "distances stay as they are",
    "distances staying as they are",
    "the distances as they are",
    "with distances as they are",
    "with the distances as they are",
    "doesnt matter which way",
    "doesnt matter which direction",
    "doesnt matter where exactly",
    "does not matter which way",
    "does not matter which direction",
    "it doesnt matter which way",
    "it doesnt matter which direction",
    "no matter which way",
    "no matter which direction",
    "whichever way",
    "in whichever direction",
    "in either direction",
    "either direction",
    "either way",
    "any direction",
    "in any direction",
    "in whatever direction",
    "i dont care which way",
    "i dont mind which way",
    "i dont care which direction",
    "i dont mind which direction",
    "i dont care where exactly",
    "direction doesnt matter",
    "the direction doesnt matter",
    "direction is up to you",
    "direction does not matter",
    "so im alone",
    "so i am alone",
    "so we are alone",
    "so were alone",
    "so that im alone",
    "so that i am alone",
    "so that we are alone",
    "so im all alone",
    "so i am all alone",
    "no longer behind",
    "no longer ahead",
    "no longer in front",
    "no longer on the left",
    "no longer on the right",
    "no longer there",
    "no longer parked",
    "not my left",
    "not my right",
    "not on my left",
    "not on my right",
    "not on the left",
    "not on the right",
    "not our left",
    "not our right",
    "not behind",
    "not ahead",
    "not in front",
    "but leave the",
    "and leave the",
    "so please turn it by 180 degrees",
    "so please turn it around",
    "so please turn it round",
    "so turn it by 180 degrees",
    "so please rotate it by 180 degrees",
];

fn without_tail(body: &[Token]) -> &[Token] {
    let found = (3..body.len()).find(|k| {
        let comma = body[*k].kind == TokenKind::Comma;
        let from = k + usize::from(comma);
        let Some(n) = leads(&body[from..], TAILS).filter(|_| comma || is(body.get(*k), &["but", "and"]))
        else {
            return false;
        };
        let rest = &body[from + n..];
        // "but leave the cyclists alone"; "which makes three of them in total"
        if is(body.get(from + n - 1), &["the"]) {
            return is(rest.last(), &["alone", "be", "unchanged", "untouched"])
                && first_noun(rest).is_some_and(|x| x.1 + 1 == rest.len());
        }
        let makes = is(body.get(from + n - 1), &["makes", "it", "that"]);
        (if makes {
            rest.first().is_some_and(|t| number(t).is_some())
        } else {
            true
        }) && !rest.iter().any(|t| {
            matches!(t.kind, TokenKind::Comma) || is(Some(t), &["and"]) || super::super::rephrase::is_verb(t)
        }) && rest.len() < 8
    });
    let body = &body[..found.unwrap_or(body.len())];
    // "12 metres or so"
    let so = body.len() > 3
        && is(body.get(body.len() - 2), &["or"])
        && is(body.last(), &["so"])
        && is_unit(body.get(body.len() - 3));
    if so { &body[..body.len() - 2] } else { body }
}

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = counted(filled(lined(tokens)), talk);
    let out = by_putting(taken_from(from_to(out, talk), talk), talk);
    let out = not_required(with_closer(towards(out), talk), talk);
    noted(instead_there(nobody_crosses(same_spot(out, talk)), talk), talk)
}

/// "bus behind us instead, 15 m": so far it should be.
fn instead_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let n = tokens.len();
    let metres = n > 5
        && is_unit(tokens.last())
        && number(&tokens[n - 2]).is_some()
        && tokens[n - 3].kind == TokenKind::Comma;
    let Some((_, b)) =
        first_noun(&tokens).filter(|x| x.0 < 2 && metres && is(tokens.get(n - 4), &["instead"]))
    else {
        return tokens;
    };
    let place = &tokens[b..n - 4];
    if talk.fits(&tokens[..b]) != 1 || !is_place(place) || has_noun(place) {
        return tokens;
    }
    let the = if is(tokens.first(), &["the", "that"]) {
        Vec::new()
    } else {
        led("the", &tokens[0], &[])
    };
    [
        &the[..],
        &tokens[..b],
        &led("should be", &tokens[0], &[&tokens[n - 2..], place]),
    ]
    .concat()
}

/// "change motorbike to bicycle, same spot": where it comes to stand anyhow.
fn same_spot(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(k) = (4..tokens.len()).find(|k| {
        tokens[*k].kind == TokenKind::Comma
            && leads(
                &tokens[k + 1..],
                &[
                    "same spot",
                    "same place",
                    "same position",
                    "the same spot",
                    "the same place",
                    "same location",
                ],
            )
            .is_some_and(|n| k + 1 + n == tokens.len())
    }) else {
        return tokens;
    };
    if !is(
        tokens.first(),
        &[
            "change", "convert", "turn", "swap", "replace", "exchange", "switch",
        ],
    ) {
        return tokens;
    }
    let bare = first_noun(&tokens[1..k]).filter(|x| x.0 == 0);
    let (Some((_, b)), true) = (bare, bare.is_some_and(|x| talk.fits(&tokens[1..=x.1]) > 0)) else {
        return tokens[..k].to_vec();
    };
    let to = usize::from(is(tokens.get(1 + b), &["to", "into", "for", "with", "by"]));
    let new = &tokens[1 + b + to..k];
    if to == 0 || first_noun(new).is_none_or(|x| x.0 != 0) {
        return tokens[..k].to_vec();
    }
    led(
        "replace the",
        &tokens[0],
        &[&tokens[1..=b], &led("with a", &tokens[0], &[new])],
    )
}

/// "oncoming car is not required, you may cancel it": it goes.
fn not_required(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const NOT: &[&str] = &[
        "is not required",
        "are not required",
        "is not needed",
        "are not needed",
        "is not wanted",
        "are not wanted",
        "is not necessary",
        "are not necessary",
        "isnt needed",
        "arent needed",
        "is no longer required",
        "are no longer required",
        "is no longer needed",
        "are no longer needed",
        "isnt required",
        "arent required",
    ];
    let Some((k, n)) = find(&tokens, NOT) else {
        return tokens;
    };
    let who = &tokens[..k];
    let bare = first_noun(who).is_some_and(|x| x.0 < 4)
        && !who
            .iter()
            .any(|t| HELPERS.contains(&text(t)) || is(Some(t), &["it", "if", "when"]));
    let rest = trimmed(&tokens[k + n..]);
    let goes = leads(
        rest,
        &[
            "you may",
            "you can",
            "please",
            "kindly",
            "just",
            "you could",
            "so",
        ],
    )
    .unwrap_or(0);
    let gone = is(
        rest.get(goes),
        &["cancel", "remove", "delete", "drop", "take", "erase", "discard"],
    ) && rest.iter().any(|t| is(Some(t), &["it", "them", "him", "her"]))
        && !has_noun(&rest[goes..])
        && rest.len() < goes + 4;
    if !bare || !gone || talk.fits(who) == 0 {
        return tokens;
    }
    let the = if is(who.first(), &["the", "all", "both", "that", "those", "my"]) {
        Vec::new()
    } else {
        led("the", &tokens[0], &[])
    };
    led("remove", &tokens[0], &[&the, who])
}

/// "nobody crosses any more: let all three walk on the pavement": they do something else.
fn nobody_crosses(tokens: Vec<Token>) -> Vec<Token> {
    let lead = leads(
        &tokens,
        &[
            "nobody crosses",
            "no one crosses",
            "nobody is crossing",
            "noone crosses",
            "no one is crossing",
            "nobody waits",
            "nobody is waiting",
        ],
    );
    let Some(n) = lead else { return tokens };
    let more = leads(&tokens[n..], &["any more", "anymore", "now", "any longer"]).unwrap_or(0);
    let rest = &tokens[n + more..];
    let goes_on = rest
        .first()
        .is_some_and(|t| matches!(t.kind, TokenKind::Mark | TokenKind::Comma))
        && is(rest.get(1), &["let", "all", "they", "have", "make"]);
    if !goes_on {
        return tokens;
    }
    let rest = &rest[1..];
    // ("all three": the pedestrians)
    match leads(rest, &["let all", "have all", "all"]) {
        Some(m) if rest.get(m).is_some_and(|t| number(t).is_some()) && !has_noun(&rest[m..]) => {
            [&rest[..m], &led("pedestrians", &rest[m], &[]), &rest[m + 1..]].concat()
        }
        _ => rest.to_vec(),
    }
}

/// "line the left side of the road with three bollards": they stand along it.
fn lined(tokens: Vec<Token>) -> Vec<Token> {
    let Some(k) = tokens
        .iter()
        .position(|t| is(Some(t), &["with"]))
        .filter(|_| is(tokens.first(), &["line", "edge", "border", "flank"]))
    else {
        return tokens;
    };
    let (place, new) = (&tokens[1..k], &tokens[k + 1..]);
    let fresh = new
        .first()
        .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "some"]))
        && has_noun(new);
    if !fresh || has_noun(place) || place.is_empty() {
        return tokens;
    }
    [
        &led("add", &tokens[0], &[new])[..],
        &led("on", &tokens[0], &[place]),
    ]
    .concat()
}

/// "fill up the pavement on the left till five people are on it": five people should be there.
fn filled(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["fill up", "fill"]) else {
        return tokens;
    };
    let Some((k, m)) =
        find(&tokens, &["until there are", "till there are", "until", "till"]).filter(|x| x.0 > n)
    else {
        return tokens;
    };
    let rest = &tokens[k + m..];
    let Some((_, b)) =
        first_noun(rest).filter(|x| x.0 < 3 && rest.first().is_some_and(|t| number(t).is_some()))
    else {
        return tokens;
    };
    let tail = trimmed(&rest[b..]);
    let ends = tail.is_empty()
        || leads(
            tail,
            &[
                "are on it",
                "are in it",
                "stand on it",
                "stand there",
                "are there",
                "are standing on it",
                "on it",
                "in it",
                "there",
                "stand in it",
                "walk on it",
            ],
        )
        .is_some_and(|x| x == tail.len());
    if !ends || has_noun(&tokens[n..k]) {
        return tokens;
    }
    [
        &led("there should be", &tokens[0], &[&rest[..b]])[..],
        &led("on", &tokens[0], &[&tokens[n..k]]),
    ]
    .concat()
}

/// "children count to be increased to six": there should be six children.
fn counted(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let count = leads(&tokens[b..], &["count", "number", "numbers", "quantity", "total"]).unwrap_or(0);
    let Some((k, n)) = find(
        &tokens[b..],
        &[
            "increased to",
            "raised to",
            "reduced to",
            "brought to",
            "brought down to",
            "brought up to",
            "lowered to",
            "decreased to",
            "changed to",
            "set to",
            "cut to",
        ],
    )
    .map(|x| (b + x.0, x.1)) else {
        return tokens;
    };
    let helped = tokens[b + count..k]
        .iter()
        .all(|t| HELPERS.contains(&text(t)) || is(Some(t), &["to", "be", "should", "must", "needs"]));
    let many = tokens.get(k + n).is_some_and(|t| number(t).is_some()) && tokens.len() == k + n + 1;
    if count == 0 || !helped || !many || talk.fits(&tokens[..b]) == 0 {
        return tokens;
    }
    let from = usize::from(is(tokens.first(), &["the"]));
    led(
        "there should be",
        &tokens[0],
        &[&tokens[k + n..], &tokens[from..b]],
    )
}

/// "from three cyclists go down to one": one stays.
fn from_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let n = leads(
        &tokens,
        &["from", "go from", "go down from", "go up from", "come down from"],
    );
    let Some(n) = n.filter(|n| tokens.get(*n).is_some_and(|t| number(t).is_some())) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let rest = &tokens[n + b..];
    let to = leads(
        rest,
        &[
            "go down to",
            "go up to",
            "come down to",
            "get down to",
            "down to",
            "up to",
            "to",
            "go to",
            "reduce to",
            "increase to",
        ],
    );
    let Some(m) = to.filter(|m| rest.len() == m + 1 && number(&rest[*m]).is_some()) else {
        return tokens;
    };
    let np = &tokens[n + 1..n + b];
    if talk.fits(np) == 0 {
        return tokens;
    }
    led("there should be", &tokens[0], &[&rest[m..], np])
}

/// "take the bus from behind and position it 25 m ahead": it is moved there.
fn taken_from(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) =
        first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["take", "pick", "grab", "get"]))
    else {
        return tokens;
    };
    let Some(k) = (b..tokens.len()).find(|k| is(tokens.get(*k), &["and"])) else {
        return tokens;
    };
    let puts = is(
        tokens.get(k + 1),
        &["put", "place", "position", "set", "move", "drop", "park"],
    ) && is(tokens.get(k + 2), &["it", "him", "her", "them"]);
    let from = tokens[b..k]
        .first()
        .is_none_or(|t| is(Some(t), &["from", "out", "away", "off"]));
    if !puts
        || !from
        || !is(tokens.get(1), &["the", "both", "that", "those"])
        || talk.fits(&tokens[1..b]) == 0
    {
        return tokens;
    }
    let verb = if is(tokens.get(k + 1), &["park"]) {
        "park"
    } else {
        "move"
    };
    led(verb, &tokens[0], &[&tokens[1..b], &tokens[k + 3..]])
}

/// "give the player more time by starting the truck at 37 m": put it there.
fn by_putting(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (2..tokens.len()).find(|k| {
        is(tokens.get(*k), &["by"])
            && is(
                tokens.get(k + 1),
                &[
                    "starting", "putting", "placing", "having", "moving", "setting", "keeping",
                ],
            )
            && is(tokens.get(k + 2), &["the", "both", "all"])
    });
    let Some(k) = found else { return tokens };
    let np = &tokens[k + 2..];
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 4) else {
        return tokens;
    };
    if talk.fits(&np[..b]) == 0 || !is_place(&np[b..]) {
        return tokens;
    }
    let at = usize::from(is(np.get(b), &["at"]));
    let place = &np[b + at..];
    let away = if at == 1 && place.len() == 2 {
        led("away", &tokens[k], &[])
    } else {
        Vec::new()
    };
    [&np[..b], &led("should be", &tokens[k], &[place, &away])].concat()
}

/// "from the other direction a car must come towards us": it is put in.
fn towards(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(
        &tokens,
        &[
            "from the other direction",
            "from the opposite direction",
            "from the front",
            "out of the other direction",
        ],
    ) else {
        return tokens;
    };
    let rest = trimmed(&tokens[n..]);
    let Some((_, b)) = first_noun(rest).filter(|x| {
        x.0 < 4
            && rest
                .first()
                .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]))
    }) else {
        return tokens;
    };
    let comes = rest[b..].iter().any(|t| {
        is(
            Some(t),
            &[
                "come",
                "comes",
                "coming",
                "approach",
                "approaches",
                "drive",
                "drives",
            ],
        )
    });
    if !comes {
        return tokens;
    }
    let metres: &[Token] =
        match (b..rest.len()).find(|k| number(&rest[*k]).is_some() && is_unit(rest.get(k + 1))) {
            Some(k) => &rest[k..k + 2],
            None => &[],
        };
    let ahead = if metres.is_empty() {
        Vec::new()
    } else {
        led("ahead", &rest[0], &[])
    };
    led(
        "add",
        &tokens[0],
        &[
            &rest[..b],
            &led("coming towards us", &tokens[0], &[]),
            metres,
            &ahead,
        ],
    )
}

/// "car behind me closer: 8 m": that is how far it is.
fn with_closer(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(colon) = tokens.iter().position(|t| text(t) == ":").filter(|c| *c > 2) else {
        return tokens;
    };
    let words = trimmed(&tokens[..colon]);
    if words.len() < 2 {
        return tokens;
    }
    let way = leads(
        &words[words.len() - 1..],
        &["closer", "nearer", "farther", "further"],
    );
    let metres = tokens.get(colon + 1).is_some_and(|t| number(t).is_some())
        && is_unit(tokens.get(colon + 2))
        && tokens.len() == colon + 3;
    let who = &words[..words.len() - 1];
    let placed = first_noun(who).is_some_and(|x| x.0 < 3 && x.1 < who.len() && is_place(&who[x.1..]));
    if !placed || way.is_none() || !metres || talk.fits(who) != 1 {
        return tokens;
    }
    let the = if is(who.first(), &["the", "that", "my"]) {
        Vec::new()
    } else {
        led("the", &tokens[0], &[])
    };
    [
        &the[..],
        who,
        &led("should keep a distance of", &tokens[0], &[&tokens[colon + 1..]]),
    ]
    .concat()
}

/// "motorcycle beside me on the left", where there is one: it should be there.
fn noted(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let body = trimmed(&tokens);
    // "kids on left sidewalk, bus stays": they move
    let stays = (2..body.len()).find(|k| {
        body[*k].kind == TokenKind::Comma
            && is(body.last(), &["stays", "stay", "remains", "remain"])
            && first_noun(&body[k + 1..]).is_some_and(|x| x.0 < 3 && k + 1 + x.1 + 1 == body.len())
    });
    let body = &body[..stays.unwrap_or(body.len())];
    let the = usize::from(is(body.first(), &["the"]));
    let Some((_, b)) = first_noun(body).filter(|x| x.0 == the && x.1 < body.len()) else {
        return tokens;
    };
    let one = matches!(
        super::super::lexicon::look_up(text(&body[b - 1])),
        Some(super::super::lexicon::Sense::Noun(_, false))
    );
    // ("truck only 14 m ahead")
    let only = usize::from(is(body.get(b), &["only", "just"]));
    let rest = &body[b + only..];
    let place = is_place(rest)
        && !is(
            rest.first(),
            &[
                "to", "away", "off", "out", "back", "forward", "up", "down", "into", "onto", "over",
            ],
        )
        && !has_noun(rest)
        && rest
            .iter()
            .all(|t| matches!(t.kind, TokenKind::Word | TokenKind::Number(_)))
        && !rest.iter().any(|t| {
            HELPERS.contains(&text(t))
                || is_finite(text(t), false)
                || is(Some(t), &["and", "instead", "too", "please"])
        });
    let there = talk.fits(&body[..b]);
    let known = one && there == 1 || stays.is_some() && there > 0;
    if !known || !place || talk.fits(body) > 0 {
        return tokens;
    }
    // ("the cyclist 18 m ahead": told as where, not by how much)
    let metres = number(&rest[0]).is_some() && is_unit(rest.get(1));
    if the == 1 && !metres {
        return tokens;
    }
    led(
        "the",
        &tokens[0],
        &[&body[the..b], &led("should be", &tokens[0], &[rest])],
    )
}
