//! Something that is there and where it shall be, under a verb that else adds, removes or turns: "show the pickup parked on the
//! right", "chuck the barriers across to the left edge", "reverse the truck until it is behind us"; and what stays as it was.

use super::super::lexicon::Sense;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::gifts::{begins_at, remark};
use super::lists::{OFF_SITE, UNTIL};
use super::words::{first_noun, is, is_goal, is_place, leads, led, longest, number, text};

const SHOWS: &[&str] = &[
    "show",
    "show me",
    "show us",
    "picture",
    "depict",
    "portray",
    "display",
    "initialise",
    "initialize",
    "instantiate",
    "spawn",
    "init",
];
/// What wishes for the same, where a state follows: "I want the truck parked on the left".
const WISHES: &[&str] = &[
    "have",
    "i want",
    "i want to have",
    "i want to see",
    "i would like",
    "i would like to have",
    "i would like to see",
    "id like",
    "id like to have",
    "id like to see",
    "i would rather have",
    "id rather have",
    "i need",
    "i prefer",
    "i would prefer",
    "id prefer",
    "we want",
    "we need",
    "we would like",
    "wed like",
    "let us have",
    "lets have",
    "let me see",
    "could we have",
    "can we have",
    "can i have",
    "could i have",
    "could you have",
];
const THROWS: &[&str] = &[
    "chuck", "throw", "toss", "fling", "sling", "kick", "dump", "lift", "haul", "tow", "heave", "cart",
    "boot", "sweep", "pluck", "yank", "lob", "bundle", "hoist", "fetch",
];
const BACKS: &[&str] = &["reverse", "back", "back up", "roll", "wheel", "coast"];
const WHOLE: &[&str] = &[
    "the", "both", "all", "that", "those", "these", "my", "our", "every",
];

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = still_so(in_ours(set_there(tokens)), talk);
    let out = shown(seen(out, talk), talk);
    let out = side_by_metres(abreast(had_doing(lifted(thrown(out, talk)), talk)), talk);
    past(until(out, talk), talk)
}

/// "it left its lane: show it in ours": in our lane.
fn in_ours(tokens: Vec<Token>) -> Vec<Token> {
    let lane = tokens.iter().position(|t| is(Some(t), &["lane", "lanes"]));
    super::super::wording::rewritten(&tokens, |i, out| {
        let ours = is(tokens.get(i), &["ours", "mine"]) && is(out.last(), &["in", "into", "on", "onto"]);
        (ours && lane.is_some_and(|l| l < i)).then(|| {
            out.extend(led("our lane", &tokens[i], &[]));
            i + 1
        })
    })
}

/// "set one cone between the two barriers": put it there, and do not make it so many.
fn set_there(mut tokens: Vec<Token>) -> Vec<Token> {
    let lead = leads(&tokens, &["and", "then", "please", "also", "now"]).unwrap_or(0);
    let fresh = is(tokens.get(lead), &["set"])
        && tokens
            .get(lead + 1)
            .is_some_and(|t| is(Some(t), &["a", "an", "another"]) || number(t).is_some());
    let np = tokens
        .get(lead + 1..)
        .and_then(first_noun)
        .filter(|x| fresh && x.0 < 4);
    if let Some((_, b)) = np {
        let place = &tokens[lead + 1 + b..];
        if is_place(place) && !is(place.first(), &["to", "up", "off", "out", "back", "down", "by"]) {
            tokens[lead].text = "put".into();
        }
    }
    tokens
}

/// Where the words end that name something known, which begin at `from`.
fn known(tokens: &[Token], from: usize) -> Option<usize> {
    let np = tokens.get(from..)?;
    // ("two of the cones" are there, too)
    let part = usize::from(np.first().is_some_and(|t| number(t).is_some()) && is(np.get(1), &["of"])) * 2;
    let (_, b) = first_noun(np).filter(|n| n.0 < 5 && is(np.get(part), WHOLE))?;
    Some(from + b)
}

fn opens_with(tokens: &[Token], i: usize, verbs: &[&str]) -> Option<usize> {
    leads(&tokens[i..], verbs).filter(|_| begins_at(tokens, i))
}

/// "show the pickup parked on the right roadside": it should be there.
fn shown(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let wish = opens_with(&tokens, i, WISHES);
        let from = i + opens_with(&tokens, i, SHOWS).or(wish)?;
        let it = is(tokens.get(from), &["it", "him", "her", "them"]);
        let end = if it { from + 1 } else { known(&tokens, from)? };
        let state = usize::from(matches!(
            tokens.get(end..).and_then(longest),
            Some((Sense::State(..), 1))
        ));
        let place = tokens.get(end + state..)?;
        // ("have her stand beside it" is a command of its own)
        let wished = state > 0
            && !it
            && tokens
                .get(end)
                .is_some_and(|t| text(t).ends_with("ing") || text(t).ends_with("ed"));
        let sure = (it || talk.tells(&tokens[from..end])) && (wish.is_none() || wished);
        (is_place(place) && !is(place.first(), &["out", "off", "up"]) && sure).then_some((i, from, end))
    });
    match found {
        Some((i, from, end)) => [
            &tokens[..i],
            &tokens[from..end],
            &led("should be", &tokens[i], &[&tokens[end..]]),
        ]
        .concat(),
        None => tokens,
    }
}

/// "show the pickup from the back", "show the bus": it is there, and stays as it is.
fn seen(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let end = opens_with(&tokens, 0, &["show", "show me", "show us", "display"])
        .and_then(|from| Some((from, known(&tokens, from)?)));
    let Some((from, end)) = end.filter(|x| talk.fits(&tokens[x.0..x.1]) > 0) else {
        return tokens;
    };
    let rest = &tokens[end..];
    let view = rest.is_empty()
        || leads(
            rest,
            &[
                "from the back",
                "from behind",
                "from the front",
                "from above",
                "from the side",
                "please",
                "again",
                "to me",
            ],
        ) == Some(rest.len());
    if view { remark(&tokens[from..end]) } else { tokens }
}

/// "chuck the barriers across to the right edge of the road": moved there, not thrown away.
fn thrown(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let from = i + opens_with(&tokens, i, THROWS)?;
        let end = known(&tokens, from)?;
        let way = leads(
            &tokens[end..],
            &[
                "across",
                "over",
                "back",
                "straight",
                "right",
                "all the way",
                "down",
                "up",
                "off the road",
                "off the street",
                "out of the way",
                "out of our lane",
                "off our lane",
                "out of my lane",
            ],
        )
        .unwrap_or(0);
        let goal = &tokens[end + way..];
        let strip =
            (1..goal.len().min(6)).any(|k| matches!(longest(&goal[k..]), Some((Sense::Place(..), _))));
        // ("tow it to the garage" is gone)
        let off = goal.iter().take(5).any(|t| OFF_SITE.contains(&text(t)));
        // ("fetch one of the lads over to the digger")
        let thing = is(tokens.get(i), &["fetch"]) && first_noun(goal).is_some_and(|n| n.0 < 4);
        let strip = strip || thing;
        (is_goal(goal) && strip && !off && talk.fits(&tokens[from..end]) > 0).then_some((
            i,
            from,
            end,
            end + way,
        ))
    });
    match found {
        Some((i, from, end, goal)) => [
            &tokens[..i],
            &led("move", &tokens[i], &[&tokens[from..end]]),
            &tokens[goal..],
        ]
        .concat(),
        None => tokens,
    }
}

/// "lift the cones": they are taken up.
fn lifted(mut tokens: Vec<Token>) -> Vec<Token> {
    for i in 0..tokens.len() {
        let end = is(tokens.get(i), &["lift"])
            .then(|| known(&tokens, i + 1))
            .flatten()
            .filter(|_| begins_at(&tokens, i));
        let closes =
            |t: Option<&Token>| t.is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "but"]));
        if end.is_some_and(|end| closes(tokens.get(end))) {
            tokens[i].text = "remove".into();
        }
    }
    tokens
}

/// "reverse the truck until it's behind us": where it ends counts.
fn until(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let from = i + opens_with(&tokens, i, BACKS)?;
        let end = known(&tokens, from)?;
        let way = (end..tokens.len().min(end + 4)).find(|k| leads(&tokens[*k..], &UNTIL).is_some())?;
        let goal = way + leads(&tokens[way..], &UNTIL)?;
        (tokens.get(goal..).is_some_and(is_place) && talk.fits(&tokens[from..end]) > 0)
            .then_some((i, from, end, goal))
    });
    match found {
        Some((i, from, end, goal)) => [
            &tokens[..i],
            &tokens[from..end],
            &led("should be", &tokens[i], &[&tokens[goal..]]),
        ]
        .concat(),
        None => tokens,
    }
}

/// "..., still in its own lane", "..., same kerb": what is not said of something stays as it was anyhow.
fn still_so(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const STRIPS: &[&str] = &[
        "lane", "kerb", "curb", "side", "sidewalk", "pavement", "roadside", "edge", "verge", "shoulder",
        "footpath", "row",
    ];
    let found = (3..tokens.len()).find_map(|i| {
        (tokens[i - 1].kind == TokenKind::Comma || is(tokens.get(i - 1), &["but", "and"])).then_some(())?;
        let end = (i..tokens.len())
            .find(|k| tokens[*k].kind == TokenKind::Comma || is(tokens.get(*k), &["and", "but", "while"]))
            .unwrap_or(tokens.len());
        let rest = &tokens[i..end];
        let still = is(rest.first(), &["still"]) && rest.len() > 1 && rest.len() < 9;
        let same = leads(
            rest,
            &["same", "the same", "on the same", "in the same", "at the same"],
        )
        .is_some_and(|n| n + 1 == rest.len() && is(rest.get(n), STRIPS));
        // ("still coming towards us" may be new)
        let there = is(rest.get(1), &["in", "on", "at"]) || rest.get(1).is_some_and(|t| number(t).is_some());
        let own = still
            && (there && is_place(&rest[1..])
                || matches!(longest(&rest[1..]), Some((Sense::State(..), n)) if n == 1 && rest.len() == 2))
            && first_noun(rest).is_none();
        (own || same).then_some((i, end, own))
    });
    // ("stands in our lane now, still 20 m ahead": as far as before, elsewhere)
    if let Some((i, end, _)) = found
        && is(tokens.get(i), &["still"])
        && tokens[i..end].iter().any(|t| number(t).is_some())
        && first_noun(&tokens[..i]).is_some_and(|n| (n.1..i).any(|k| is_place(&tokens[k..i])))
    {
        return [&tokens[..i], &tokens[i + 1..]].concat();
    }
    let Some((i, end, own)) = found else {
        return tokens;
    };
    // who is spoken of is there already
    let (from, b) = match first_noun(&tokens[..i]) {
        Some(n) => n,
        None if own
            && tokens[..i]
                .iter()
                .any(|t| is(Some(t), &["it", "him", "her", "them"])) =>
        {
            (0, 0)
        }
        None => return tokens,
    };
    let fresh = tokens[..from]
        .iter()
        .any(|t| is(Some(t), &["a", "an", "another", "some", "more"]) || number(t).is_some());
    // ("..., same place" is said of what takes it)
    let replaces = tokens[..i].iter().any(|t| {
        is(
            Some(t),
            &["replace", "swap", "into", "becomes", "change", "exchange"],
        )
    });
    if fresh || replaces && !own || b > 0 && talk.fits(&tokens[from..b]) == 0 {
        return tokens;
    }
    let link = tokens[..i]
        .iter()
        .rev()
        .take_while(|t| t.kind == TokenKind::Comma || is(Some(t), &["but", "and"]))
        .count();
    [&tokens[..i - link], &tokens[end..]].concat()
}

/// "the cyclist should be past the bus", "beyond the cones": ahead of them, or behind what is turned to us.
fn past(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        let the =
            i > 0 && is(tokens.get(i), &["past"]) && is(tokens.get(i + 1), &["the", "that", "both", "all"]);
        let stands = the
            && (is(
                tokens.get(i - 1),
                &["be", "is", "are", "already", "now", "well", "just"],
            ) || super::words::noun_at(&tokens[i - 1..i]).is_some());
        let far = leads(
            &tokens[i..],
            &[
                "beyond",
                "on the far side of",
                "at the far side of",
                "to the far side of",
            ],
        );
        let np = i + far.or(stands.then_some(1))?;
        let end = known(&tokens, np)?;
        let boxes = talk.boxes_of(&tokens[np..end]);
        let first = boxes.first()?;
        // (seen from us what is beyond something behind us is farther back)
        let back = first.center_m.x < 0.0 && far.is_some();
        let behind = (first.yaw_rad.cos() < 0.0) != back;
        Some((i, np, if behind { "behind" } else { "ahead of" }))
    });
    match found {
        Some((i, np, rel)) => [&tokens[..i], &led(rel, &tokens[i], &[&tokens[np..]])].concat(),
        None => tokens,
    }
}

/// "take the bicycle from the sidewalk and have it ride in our lane": it should ride there.
fn had_doing(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const TAKES: &[&str] = &[
        "take", "get", "bring", "fetch", "pull", "lift", "grab", "remove", "pick",
    ];
    const FROM: &[&str] = &["from", "off", "out of"];
    const HAS: &[&str] = &["have", "let", "make"];
    let found = (0..tokens.len()).find_map(|i| {
        let from = i + opens_with(&tokens, i, TAKES)?;
        let end = known(&tokens, from)?;
        let away = end + leads(&tokens[end..], FROM)?;
        let and = (away + 1..tokens.len().min(away + 7)).find(|k| is(tokens.get(*k), &["and"]))?;
        let it = and + 1 + leads(tokens.get(and + 1..)?, HAS)?;
        is(tokens.get(it), &["it", "him", "her", "them"]).then_some(())?;
        // (what comes from one of several places must still be told by it)
        let does = tokens
            .get(it + 1)
            .is_some_and(|t| super::words::is_finite(text(t), true));
        let goes_on = (it + 2..tokens.len()).any(|k| is_place(&tokens[k..]));
        let place = is_place(&led("on", &tokens[i], &[&tokens[away..and]]));
        let all = place && talk.tells(&tokens[from..end]);
        (does && goes_on && all).then_some((i, from, end, it + 1))
    });
    match found {
        Some((i, from, end, does)) => [
            &tokens[..i],
            &tokens[from..end],
            &led("should", &tokens[i], &[&tokens[does..]]),
        ]
        .concat(),
        None => tokens,
    }
}

/// "place the bus directly to our left": beside us.
fn abreast(tokens: Vec<Token>) -> Vec<Token> {
    const CLOSE: &[&str] = &[
        "directly",
        "immediately",
        "right",
        "straight",
        "just",
        "exactly",
        "precisely",
    ];
    const SIDE: &[(&str, &str)] = &[
        ("to our left", "left"),
        ("to the left of us", "left"),
        ("on our left", "left"),
        ("to my left", "left"),
        ("on my left", "left"),
        ("at our left", "left"),
        ("to the left of me", "left"),
        ("to our right", "right"),
        ("to the right of us", "right"),
        ("on our right", "right"),
        ("to my right", "right"),
        ("on my right", "right"),
        ("at our right", "right"),
        ("to the right of me", "right"),
    ];
    super::super::wording::rewritten(&tokens, |i, out| {
        let close = leads(&tokens[i..], CLOSE)?;
        let (n, side) = SIDE
            .iter()
            .find_map(|(words, side)| Some((leads(&tokens[i + close..], &[words])?, *side)))?;
        let end = i + close + n;
        let hand = leads(tokens.get(end..)?, &["hand side", "side", "flank"]).unwrap_or(0);
        // ("5 m directly to our left" is no one beside us; "delete the car directly to our left" says which)
        let measured = out.last().is_some_and(|t| super::words::is_unit(Some(t)));
        let puts = out.iter().any(|t| {
            is(
                Some(t),
                &[
                    "put", "place", "move", "bring", "set", "position", "should", "is", "are", "drives",
                    "rides", "stands", "shift", "draw", "send", "add", "must", "be", "have", "want", "need",
                    "comes", "let",
                ],
            )
        });
        (!measured && puts && super::words::has_noun(out)).then(|| {
            out.extend(led(&format!("beside us on our {side}"), &tokens[i], &[]));
            end + hand
        })
    })
}

/// "a barrier behind the cones, 20 m ahead of us": what the metres say is behind them as we see it.
fn side_by_metres(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const AHEAD: &[&str] = &[
        "ahead of us",
        "in front of us",
        "ahead of me",
        "in front of me",
        "ahead",
    ];
    const BACK: &[&str] = &["behind us", "behind me"];
    let metres = (0..tokens.len()).find_map(|i| {
        let m = number(&tokens[i])? as f64;
        let unit = super::words::unit_at(tokens.get(i + 1..)?)?;
        let rest = &tokens[i + 1 + unit..];
        let far = if leads(rest, AHEAD).is_some_and(|n| n > 1 || !is(rest.get(1), &["of"])) {
            m
        } else if leads(rest, BACK).is_some() {
            -m
        } else {
            return None;
        };
        Some(far)
    });
    let Some(far) = metres else {
        return tokens;
    };
    super::super::wording::rewritten(&tokens, |i, out| {
        let rel = leads(&tokens[i..], &["behind", "in front of", "ahead of", "before"])?;
        // ("5 m behind the cones" counts from them)
        let counted = out.last().is_some_and(|t| super::words::is_unit(Some(t)));
        let np = i + rel;
        let end = known(&tokens, np).filter(|_| !counted)?;
        let boxes = talk.boxes_of(&tokens[np..end]);
        let front = boxes.first()?.yaw_rad.cos();
        let behind = is(tokens.get(i), &["behind"]);
        let wanted = if behind == (front > 0.0) { -1.0 } else { 1.0 };
        let against = boxes.iter().all(|b| (far - b.center_m.x) * wanted < -1.0);
        against.then(|| {
            out.extend(led(if behind { "ahead of" } else { "behind" }, &tokens[i], &[]));
            np
        })
    })
}
