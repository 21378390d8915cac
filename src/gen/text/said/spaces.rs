//! Room between and on places: "increase the distance to the car behind to 20 m", "the crossing should be empty".

use super::super::lexicon::Sense;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, replaced, rewritten};
use super::Talk;
use super::gifts::begins_at;
use super::words::{find, first_noun, has_noun, is, is_unit, leads, led, longest, number, text, trimmed};
use crate::scene::Class;

/// "increase the distance to the car behind to 20 m", "reduce the gap to the bus by 5 m".
pub(super) fn distance_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "the distance to",
            "the gap to",
            "the distance from us to",
            "the gap between us and",
            "the distance between us and",
            "the spacing to",
            "the distance from me to",
            "the gap between me and",
            "the distance between me and",
            "our distance to",
            "our distance from",
            "the distance from",
            "the headway to",
            "my distance to",
            "my distance from",
            "the distance of",
        ],
    ) else {
        return tokens;
    };
    let from = i + n;
    let Some((_, b)) = first_noun(&tokens[from..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let step = (from + b..tokens.len()).find(|k| {
        is(tokens.get(*k), &["to", "by", "at", "is", "of", "down", "up"])
            && tokens.get(k + 1).is_some_and(|t| number(t).is_some())
            && is_unit(tokens.get(k + 2))
            || is(tokens.get(*k), &["should", "must"])
    });
    let Some(step) = step else {
        return tokens;
    };
    let Some(metres) =
        (step..tokens.len()).find(|k| number(&tokens[*k]).is_some() && is_unit(tokens.get(k + 1)))
    else {
        return tokens;
    };
    let mut np = tokens[from..step].to_vec();
    if is(np.last(), &["behind", "ahead"]) {
        np.extend(led(
            if text(&np[np.len() - 1]) == "ahead" {
                "of us"
            } else {
                "us"
            },
            &tokens[i],
            &[],
        ));
    }
    if talk.fits(&np) == 0 {
        return tokens;
    }
    let lead = &tokens[..i];
    let wider = lead.iter().any(|t| {
        matches!(
            text(t),
            "increase" | "raise" | "widen" | "lengthen" | "extend" | "enlarge" | "grow"
        )
    });
    let start = (0..i).rev().find(|k| begins_at(&tokens, *k)).unwrap_or(0);
    let far = &tokens[metres..metres + 2];
    let out = if is(tokens.get(step), &["by"]) {
        let way = led(if wider { "further away" } else { "closer" }, &tokens[i], &[]);
        led("move", &tokens[i], &[&np, far, &way])
    } else {
        [&np[..], &led("should keep a distance of", &tokens[i], &[far])].concat()
    };
    [&tokens[..start], &out, &tokens[metres + 2..]].concat()
}

const CROSSINGS: &[&str] = &[
    "the crossing",
    "the zebra",
    "the zebra crossing",
    "the pedestrian crossing",
    "the crosswalk",
];

/// "so empty the pavement": who is on it goes.
fn empties(mut tokens: Vec<Token>) -> Vec<Token> {
    for i in 0..tokens.len() {
        let verb = is(tokens.get(i), &["empty", "depopulate", "evacuate"]) && begins_at(&tokens, i);
        let frees = verb || is(tokens.get(i), &["clear", "free", "vacate"]) && begins_at(&tokens, i);
        if let Some(new) = frees.then(|| car_park_emptied(&tokens, i)).flatten() {
            return new;
        }
        // ("clear the crossing": those who walk there)
        let on = frees
            .then(|| leads(&tokens[i + 1..], CROSSINGS).map(|n| i + 1 + n))
            .flatten()
            .filter(|end| {
                tokens.get(*end).is_none_or(|t| {
                    t.kind != TokenKind::Word || is(Some(t), &["and", "now", "please", "completely"])
                })
            });
        if let Some(end) = on {
            let all = led("remove all the objects on", &tokens[i], &[&tokens[i + 1..end]]);
            return [&tokens[..i], &all, &tokens[end..]].concat();
        }
        let the = is(tokens.get(i + 1), &["the", "our", "my", "both"]);
        let place = tokens.get(i + 2..).and_then(longest);
        if let (true, true, Some((Sense::Place(..), n))) = (verb, the, place)
            && tokens
                .get(i + 2 + n)
                .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "of"]))
        {
            tokens[i].text = "clear".into();
        }
    }
    tokens
}

/// "empty two of the parking spaces", "clear the car park": so many of the parked ones go, or all.
fn car_park_emptied(tokens: &[Token], i: usize) -> Option<Vec<Token>> {
    const PARKS: &[&str] = &[
        "the car park",
        "the parking lot",
        "the whole car park",
        "the entire car park",
        "the parking area",
        "the whole parking lot",
        "the entire parking lot",
        "all the parking spaces",
        "all parking spaces",
        "all the spaces",
        "all the bays",
    ];
    let up = i + 1 + usize::from(is(tokens.get(i + 1), &["up", "out"]));
    if let Some(n) = leads(&tokens[up..], PARKS) {
        let ends = tokens
            .get(up + n)
            .is_none_or(|t| t.kind == TokenKind::Comma || is(Some(t), &["and", "completely"]));
        let spares = tokens[up + n..]
            .iter()
            .any(|t| is(Some(t), &["except", "but", "apart", "save", "of"]));
        let all = led("remove all the parked vehicles", &tokens[i], &[&tokens[up + n..]]);
        return (ends && !spares).then(|| [&tokens[..i], &all].concat());
    }
    let many = tokens.get(up).filter(|t| number(t).is_some())?;
    let of = leads(&tokens[up + 1..], &["of the"]).unwrap_or(0);
    let mut k = up + 1 + of;
    while is(tokens.get(k), &["parking", "car", "occupied", "taken", "filled"]) {
        k += 1;
    }
    is(
        tokens.get(k),
        &["space", "spaces", "bay", "bays", "spot", "spots", "slot", "slots"],
    )
    .then_some(())?;
    let any = led("remove any", &tokens[i], &[std::slice::from_ref(many)]);
    let parked = led("of the parked vehicles", &tokens[i], &[&tokens[k + 1..]]);
    Some([&tokens[..i], &any, &parked].concat())
}

/// "fill two more spaces with cars": two more are parked.
pub(super) fn spaces_filled(tokens: Vec<Token>) -> Vec<Token> {
    const FOUND: &str = "has found a space|has found a parking space|has found a spot|has found a parking spot|has found a bay|\
        found a space|found a parking space|has taken a space|takes a space|takes a parking space|has taken a parking space";
    let tokens = replaced(&tokens, FOUND, "is parked in the car park");
    let found = (0..tokens.len()).find_map(|i| {
        (is(tokens.get(i), &["fill", "occupy", "use"]) && begins_at(&tokens, i)).then_some(())?;
        let up = i + 1 + usize::from(is(tokens.get(i + 1), &["up"]));
        number(tokens.get(up)?)?;
        let of = leads(&tokens[up + 1..], &["of the"]).unwrap_or(0);
        let mut k = up + 1 + of;
        while is(
            tokens.get(k),
            &[
                "more",
                "other",
                "further",
                "additional",
                "free",
                "empty",
                "vacant",
                "parking",
                "car",
                "remaining",
            ],
        ) {
            k += 1;
        }
        is(
            tokens.get(k),
            &[
                "space", "spaces", "bay", "bays", "spot", "spots", "slot", "slots", "place", "places",
            ],
        )
        .then_some(())?;
        is(tokens.get(k + 1), &["with", "by"]).then_some(())?;
        let article = usize::from(is(tokens.get(k + 2), &["a", "an", "one"]));
        let from = k + 2 + article;
        let (_, b) = first_noun(tokens.get(from..)?).filter(|n| n.0 < 3)?;
        let each = usize::from(is(tokens.get(from + b), &["each"]));
        Some((i, up, from, from + b, from + b + each))
    });
    match found {
        Some((i, many, from, to, end)) => [
            &tokens[..i],
            &led("add", &tokens[i], &[&tokens[many..=many]]),
            &led("more parked", &tokens[i], &[&tokens[from..to]]),
            &led("in the car park", &tokens[i], &[]),
            &tokens[end..],
        ]
        .concat(),
        None => tokens,
    }
}

/// "the left-hand row loses one car": of those that are parked there.
fn row_loses(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const LOSES: &[&str] = &[
        "loses",
        "lost",
        "has lost",
        "should lose",
        "is to lose",
        "must lose",
        "gives up",
        "has to lose",
    ];
    let found = is(tokens.first(), &["the"])
        .then(|| (2..tokens.len().min(6)).find_map(|k| leads(&tokens[k..], LOSES).map(|n| (k, k + n))))
        .flatten();
    let Some((k, many)) = found.filter(|x| tokens.get(x.1).is_some_and(|t| number(t).is_some())) else {
        return tokens;
    };
    let lead = &tokens[..k];
    let row = is(lead.last(), &["row", "line"]) && is(lead.get(1), &["left", "right"]);
    let place = match longest(&lead[1..]) {
        _ if row => led(
            "on the",
            &tokens[1],
            &[&tokens[1..2], &led("roadside", &tokens[1], &[])],
        ),
        Some((Sense::Place(..), n)) if n + 1 == lead.len() => led(
            if is(lead.last(), &["lane"]) { "in" } else { "on" },
            &tokens[0],
            &[lead],
        ),
        _ => return tokens,
    };
    let Some((_, b)) = first_noun(&tokens[many + 1..]).filter(|n| n.0 < 3) else {
        return tokens;
    };
    let np = [&tokens[many + 1..many + 1 + b], &place[..]].concat();
    if talk.fits(&np) == 0 {
        return tokens;
    }
    led(
        "remove any",
        &tokens[0],
        &[&tokens[many..=many], &np, &tokens[many + 1 + b..]],
    )
}

/// "slip a fourth car into the left-hand row": parked at that edge, where others are.
pub(super) fn into_row(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let tokens = row_loses(tokens, talk);
    rewritten(&tokens, |i, out| {
        let n = leads(
            &tokens[i..],
            &[
                "into the",
                "in the",
                "to the",
                "onto the",
                "inside the",
                "within the",
            ],
        )?;
        let side = tokens.get(i + n).filter(|t| is(Some(t), &["left", "right"]))?;
        let hand = usize::from(is(tokens.get(i + n + 1), &["hand"]));
        let row = i + n + 1 + hand;
        is(tokens.get(row), &["row", "line"]).then_some(())?;
        let of = leads(&tokens[row + 1..], &["of"]).unwrap_or(0);
        let noun = match of {
            0 => 0,
            _ => of + first_noun(&tokens[row + 2..]).filter(|x| x.0 < 3)?.1,
        };
        let edge = led("roadside", side, &[]);
        let there = [&led("on the", side, &[std::slice::from_ref(side)])[..], &edge].concat();
        let parked = led("all parked vehicles", side, &[&there]);
        (talk.fits(&parked) > 0).then_some(())?;
        out.extend(there);
        Some(row + 1 + noun)
    })
}

/// "the crossing is empty now", "our lane must be free of cones": who is there goes.
pub(super) fn emptied(tokens: Vec<Token>) -> Vec<Token> {
    let tokens = empties(tokens);
    let body = trimmed(&tokens);
    let the = usize::from(is(body.first(), &["the", "our", "my"]));
    let Some((Sense::Place(..), n)) = body.get(the..).and_then(longest) else {
        return tokens;
    };
    let place = &body[..the + n];
    let mut k = the + n;
    while is(
        body.get(k),
        &[
            "is",
            "are",
            "should",
            "must",
            "has",
            "have",
            "needs",
            "need",
            "ought",
            "shall",
            "to",
            "be",
            "now",
            "also",
            "completely",
            "totally",
            "entirely",
            "all",
            "absolutely",
            "again",
            "will",
            "stay",
            "remain",
            "kept",
        ],
    ) {
        k += 1;
    }
    if k == the + n
        || !is(
            body.get(k),
            &[
                "empty",
                "deserted",
                "vacant",
                "unoccupied",
                "clear",
                "free",
                "cleared",
                "emptied",
            ],
        )
    {
        return tokens;
    }
    let mut rest = &body[k + 1..];
    let of = leads(rest, &["of all", "of any", "of", "from"]);
    rest = &rest[of.unwrap_or(0)..];
    let late = find(rest, &["now", "again", "any more", "please", "at last"]);
    let what = trimmed(&rest[..late.map_or(rest.len(), |x| x.0)]);
    // (what is to be done for it is said)
    if late.is_some_and(|(k, n)| !trimmed(&rest[k + n..]).is_empty())
        || what.iter().any(|t| t.kind == TokenKind::Comma)
    {
        return tokens;
    }
    // ("my lane is free" is a remark)
    let wish = body[the + n..k].iter().any(|t| {
        matches!(
            text(t),
            "should" | "must" | "to" | "be" | "shall" | "needs" | "now"
        )
    }) || is(body.get(k), &["empty", "deserted", "vacant"]);
    let whole = of.is_some() == has_noun(what) && (of.is_some() || what.is_empty());
    if !wish || !whole {
        return tokens;
    }
    let lane = place.iter().any(|t| {
        matches!(
            text(t),
            "lane" | "lanes" | "junction" | "intersection" | "roundabout" | "carpark"
        )
    });
    let at = led(if lane { "in" } else { "on" }, &body[0], &[place]);
    match of {
        Some(_) => led("remove all the", &body[0], &[what, &at]),
        None => led("remove all the objects", &body[0], &[&at]),
    }
}

/// "clear the zebra: nobody is crossing now, both people are on the right sidewalk": they are not gone, but there.
pub(super) fn crossed(tokens: Vec<Token>) -> Vec<Token> {
    const EMPTIES: &str = "clear the|empty the|free the|vacate the";
    const NOBODY: &str = "nobody|no one|noone|there is nobody|there is no one|theres nobody|theres no one|none of them|no pedestrian|no person|no people|\
        there are no people|there are no pedestrians|no pedestrians|neither of them|neither";
    const WHERE: &[&str] = &[
        "crossing",
        "zebra",
        "crosswalk",
        "road",
        "street",
        "roadway",
        "carriageway",
    ];
    const THEY: &str = "both|the two|the three|the four|all|all the|all of them|both of them|they|the";
    const SIDES: &[&str] = &[
        "sidewalk", "pavement", "footpath", "footway", "walkway", "kerb", "curb", "side",
    ];
    let person = |np: &[Token]| {
        let (a, b) = first_noun(np).filter(|x| x.0 < 5)?;
        matches!(longest(&np[a..b]), Some((Sense::Noun(n, _), _)) if n.classes[0] == Class::Pedestrian)
            .then_some(b)
    };
    let ends = |t: &Token| !matches!(t.kind, TokenKind::Word | TokenKind::Number(_));
    let mut out: Vec<Token> = Vec::new();
    let mut cleared = false;
    let mut i = 0;
    while i < tokens.len() {
        let opens = i == 0 || ends(&tokens[i - 1]);
        let close = (i..tokens.len())
            .find(|k| ends(&tokens[*k]))
            .unwrap_or(tokens.len());
        let clause = &tokens[i..close];
        let where_ = clause.iter().any(|t| is(Some(t), WHERE));
        let clears = begins(clause, EMPTIES).is_some() && where_ && clause.len() < 6;
        let nobody = begins(clause, NOBODY).is_some()
            && clause.len() < 11
            && (where_ || cleared || is(clause.get(2), &["crossing"]));
        // ("nobody is on it now", after what is to be clear)
        cleared = false;
        if !(opens && (clears || nobody) && close < tokens.len()) {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        }
        // what follows may say the same once more before it says where they are
        let from = close + 1 + usize::from(is(tokens.get(close + 1), &["and", "because", "since", "as"]));
        let next = (from..tokens.len())
            .find(|k| ends(&tokens[*k]))
            .unwrap_or(tokens.len());
        let rest = &tokens[from.min(next)..next];
        let again = clears && begins(rest, NOBODY).is_some() && rest.len() < 11;
        let they = begins(rest, THEY)
            .is_some_and(|n| person(rest).is_some() || n == 1 && is(rest.first(), &["they", "both"]));
        let told = if is(rest.first(), &["they", "all"]) || begins(rest, "both of them|all of them").is_some()
        {
            0
        } else {
            person(rest).unwrap_or(0)
        };
        let there = rest[told.min(rest.len())..].iter().any(|t| is(Some(t), SIDES));
        if again {
            cleared = true;
            i = from;
        } else if they && there {
            // ("they" are the people who were named)
            if is(rest.first(), &["they"]) || begins(rest, "both of them|all of them").is_some() {
                let n = begins(rest, "both of them|all of them").unwrap_or(1);
                out.extend(led("the pedestrians", &rest[0], &[]));
                i = from + n;
            } else {
                i = from;
            }
        } else {
            out.extend_from_slice(&tokens[i..=close]);
            i = close + 1;
        }
    }
    out
}
