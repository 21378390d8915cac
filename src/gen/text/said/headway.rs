//! Distances that are told with what is wrong about them: "the truck is too close, 22 m would do", "25 m to the bus is too
//! much; 20 would be right", "a distance of 20 m to the bus is what I need", "not 25 m ahead but 17".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::lists::List;
use super::words::{first_noun, has_noun, is, leads, led, number, text, unit_at};
use std::sync::LazyLock;

static TOO: List = LazyLock::new(|| {
    "\
    far|close|near|closely|much|little|few|many|short|long|small|big|large|tight|tightly|distant|nearby|\
    wide|narrow"
        .split('|')
        .collect()
});
/// Words of the part that says how far it should be: nothing else may stand there but the number and its unit.
static ANSWER: List = LazyLock::new(|| {
    "\
    make|it|lets|let|us|have|there|be|would|will|should|must|do|is|are|right|better|fine|ok|okay|good|\
    enough|perfect|ideal|plenty|sufficient|about|say|please|rather|just|only|i|we|want|need|prefer|like|\
    id|the|at|least|that|distance|of|a|to|keep|best|nice|correct|instead|use|needed|required|suffice|\
    nicer|safer|more|realistic|to|me|maybe|perhaps|and|so|wed|reasonable|fit|suit|what|was|meant|\
    thinking|appropriate|acceptable|exactly|set|around"
        .split('|')
        .collect()
});
const GAP: &str = "distance|gap|headway|clearance|spacing|separation|margin|interval|safety distance|following distance|safe distance|minimum distance";
const ROOM: &str = "distance|gap|headway|clearance|spacing|space|room|air|separation";
const FROM: &str = "to|from|with|between us and|between me and|from us to|from me to|towards|between ourselves and|between our car and|behind|ahead of|for";

/// Of a thing they say how far it is; of a number, whether it is right.
const NEAR_FAR: &[&str] = &[
    "far", "close", "near", "closely", "tight", "tightly", "distant", "nearby",
];
static FAIRLY: List = LazyLock::new(|| {
    "\
    too|a bit|a little|a little bit|rather|quite|pretty|somewhat|very|a tad|way"
        .split('|')
        .collect()
});

/// "too close", "a bit short": how many tokens stand before the adjective.
fn too_at(tokens: &[Token]) -> Option<usize> {
    leads(tokens, &FAIRLY).filter(|n| is(tokens.get(*n), &TOO))
}

/// The first number with a unit of length from here: where it stands, and one past its unit.
pub(super) fn measure(tokens: &[Token]) -> Option<(usize, usize)> {
    (0..tokens.len()).find_map(|i| {
        number(&tokens[i])?;
        Some((i, i + 1 + unit_at(&tokens[i + 1..])?))
    })
}

pub(super) fn is_mark(t: &Token) -> bool {
    t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_))
}

/// Tokens of the answer's number, if this is nothing but an answer: "22 m would do", "make it 17".
fn answer(part: &[Token]) -> Option<usize> {
    let mut numbers = (0..part.len()).filter(|i| number(&part[*i]).is_some() && !is(part.get(*i), &["a"]));
    let at = numbers.next()?;
    let unit = unit_at(&part[at + 1..]).unwrap_or(0);
    let plain = part
        .iter()
        .enumerate()
        .all(|(i, t)| (at..=at + unit).contains(&i) || is_mark(t) || ANSWER.contains(&text(t)));
    // ("5 m more" is a step, and "10 more" are things)
    let step = is(part.get(at + unit + 1), &["more", "less", "further", "closer"]);
    (numbers.next().is_none() && plain && !step && !is(part.get(at), &["one"])).then_some(at)
}

const NEARER: &[&str] = &[
    "closer",
    "nearer",
    "further away",
    "farther away",
    "further off",
    "farther off",
    "further",
    "farther",
    "further ahead",
    "farther ahead",
    "further back",
    "farther back",
    "further up",
    "closer to us",
    "nearer to us",
    "closer to me",
    "nearer to me",
    "further away from us",
    "farther away from us",
    "further from us",
    "farther from us",
    "further ahead of us",
    "further behind us",
    "further behind",
];
const AWAY: &[&str] = &[
    "away",
    "from us",
    "away from us",
    "ahead",
    "behind",
    "ahead of us",
    "behind us",
    "in front of us",
    "will do",
    "would do",
    "would be good",
    "please",
    "is enough",
    "is fine",
    "would be right",
    "or so",
];

/// A complaint about a distance and what follows in the next sentence are one sentence.
pub fn joined(mut tokens: Vec<Token>) -> Vec<Token> {
    let mut from = 0;
    for i in 0..tokens.len() {
        if tokens[i].kind != TokenKind::Stop {
            continue;
        }
        let end = (i + 1..tokens.len())
            .find(|k| tokens[*k].kind == TokenKind::Stop)
            .unwrap_or(tokens.len());
        let far = measure(&tokens[from..i]).is_some();
        let complains = (from..i)
            .any(|k| too_at(&tokens[k..]).is_some_and(|n| far || NEAR_FAR.contains(&text(&tokens[k + n]))));
        // "Bring the bus closer. Twenty metres."
        let moved = super::super::rephrase::is_verb(&tokens[from])
            && has_noun(&tokens[from..i])
            && !far
            && (from + 1..i).any(|k| leads(&tokens[k..i], NEARER) == Some(i - k));
        if moved
            && let Some((0, n)) = measure(&tokens[i + 1..end])
            && leads(&tokens[i + 1 + n..end], AWAY).unwrap_or(0) == end - i - 1 - n
        {
            tokens[i].kind = TokenKind::Comma;
            tokens[i].text = ",".into();
        }
        if complains
            && !tokens[from..i].iter().any(|t| t.kind == TokenKind::Comma)
            && answer(&tokens[i + 1..end]).is_some()
        {
            tokens[i].kind = TokenKind::Comma;
            tokens[i].text = ",".into();
        }
        from = i + 1;
    }
    tokens
}

/// A sentence (without its stop) that says plainly how far something should be.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = super::strides::plain(tokens, talk);
    if let Some(new) = too_far(&out, talk)
        .or_else(|| gap_shall(&out, talk))
        .or_else(|| gap_of(&out, talk))
        .or_else(|| metres_to(&out, talk))
        .or_else(|| separated(&out, talk))
    {
        return new;
    }
    out
}

/// "X should keep a distance of so many metres", of one thing of the scene.
fn keeps(np: &[Token], metres: &Token, unit: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let np = super::words::trimmed(np);
    let (a, b) = first_noun(np).filter(|x| x.0 < 5)?;
    let whole =
        b == np.len() || super::words::is_place(&np[b..]) || is(np.get(b), &["that", "which", "who", "in"]);
    let the = !is(
        np.first(),
        &[
            "the", "that", "this", "my", "both", "all", "those", "these", "every",
        ],
    );
    let fresh = is(np.first(), &["a", "an", "another"]) || number(&np[0]).is_some();
    if !whole || fresh || has_noun(&np[b..]) || a > 4 {
        return None;
    }
    let np = if the {
        led("the", metres, &[np])
    } else {
        np.to_vec()
    };
    if talk.fits(&np) == 0 {
        return None;
    }
    let m = led("m", metres, &[]);
    let unit = if unit.is_empty() { &m[..] } else { unit };
    Some(
        [
            &np[..],
            &led(
                "should keep a distance of",
                metres,
                &[std::slice::from_ref(metres), unit],
            ),
        ]
        .concat(),
    )
}

/// "the truck is too close, 22 m would do", "25 m to the bus is too much, make it 20".
fn too_far(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (too, n) = (1..tokens.len()).find_map(|i| too_at(&tokens[i..]).map(|n| (i, n)))?;
    let adj = text(&tokens[too + n]);
    let late = too + n + 1;
    // what the answer is set off by
    let mark = (late..tokens.len()).find(|k| {
        is_mark(&tokens[*k])
            || is(tokens.get(*k), &["and", "so"])
                && number(tokens.get(k + 1).unwrap_or(&tokens[*k])).is_some()
    })?;
    let after = &tokens[mark + 1..];
    let n = answer(after)?;
    let unit = &after[n + 1..n + 1 + unit_at(&after[n + 1..]).unwrap_or(0)];
    let mut head = &tokens[..too];
    while head.last().is_some_and(|t| {
        matches!(
            text(t),
            "far"
                | "much"
                | "way"
                | "a"
                | "bit"
                | "little"
                | "still"
                | "just"
                | "really"
                | "clearly"
                | "is"
                | "are"
                | "seems"
                | "looks"
        )
    }) {
        head = &head[..head.len() - 1];
    }
    // "25 m to the bus", "25 m"
    let told = measure(head).filter(|m| m.0 < 3);
    if let Some((_, end)) = told {
        if let Some(n_from) = begins(&head[end..], FROM) {
            return keeps(&head[end + n_from..], &after[n], unit, talk);
        }
        // "12 m is too close for the truck"
        let of = &tokens[late..mark];
        let gap = leads(of, &["a distance", "a gap", "of a distance", "of a gap"]).unwrap_or(0);
        let rest = gap + begins(&of[gap..], FROM)?;
        return keeps(&of[rest..], &after[n], unit, talk);
    }
    // "the distance to the bus is too small"
    let the = usize::from(is(head.first(), &["the", "our", "my", "this"]));
    if let Some(g) = begins(&head[the..], GAP) {
        let at = the + g;
        let from = at + begins(&head[at..], FROM)?;
        return keeps(&head[from..], &after[n], unit, talk);
    }
    // (too many of them, too long: no distance)
    if !NEAR_FAR.contains(&adj) {
        return None;
    }
    // (a number without a unit after a colon may be anything)
    let verb = |t: &Token| {
        matches!(
            text(t),
            "is" | "are"
                | "follows"
                | "drives"
                | "stands"
                | "rides"
                | "sits"
                | "walks"
                | "waits"
                | "comes"
                | "seems"
                | "has"
                | "stays"
                | "keeps"
        )
    };
    let end = (1..head.len()).find(|k| verb(&head[*k])).unwrap_or(head.len());
    keeps(&head[..end], &after[n], unit, talk)
}

const SHALL: &str = "shall be|should be|is to be|must be|has to be|needs to be|ought to be|shall become|should become|should now be|will be|shall amount to|should read|\
    shall remain|is supposed to be|has to become|must become|must not be less than|should amount to|was|has been|had been";

const MAY_BE: &[&str] = &[
    "may be",
    "can be",
    "could be",
    "should be",
    "must be",
    "has to be",
    "needs to be",
    "must become",
    "may become",
    "should become",
    "might be",
    "ought to be",
];
const CHANGED: [&str; 12] = [
    "smaller",
    "bigger",
    "larger",
    "shorter",
    "longer",
    "greater",
    "wider",
    "less",
    "more",
    "increased",
    "reduced",
    "tighter",
];

/// "the gap to the scooter shall be 20 m, it stays behind us".
fn gap_shall(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let the = usize::from(is(tokens.first(), &["the", "our", "my", "this"]));
    let gap = the + begins(&tokens[the..], GAP)?;
    let from = gap + begins(&tokens[gap..], FROM)?;
    // "... may be smaller: 14 m is good"
    let may = (from + 1..tokens.len().min(from + 6)).find_map(|k| {
        let n = leads(&tokens[k..], MAY_BE)?;
        let adj = k
            + n
            + leads(
                &tokens[k + n..],
                &["a bit", "a little", "somewhat", "much", "slightly"],
            )
            .unwrap_or(0);
        is(tokens.get(adj), &CHANGED).then_some((k, adj + 1))
    });
    if let Some((k, end)) = may
        && tokens.get(end).is_some_and(is_mark)
        && let Some(n) = answer(&tokens[end + 1..])
    {
        let after = &tokens[end + 1..];
        let unit = &after[n + 1..n + 1 + unit_at(&after[n + 1..]).unwrap_or(0)];
        return keeps(&tokens[from..k], &after[n], unit, talk);
    }
    let shall = (from + 1..tokens.len().min(from + 6)).find(|k| begins(&tokens[*k..], SHALL).is_some())?;
    let at = shall + begins(&tokens[shall..], SHALL)?;
    let at = at + leads(&tokens[at..], &["at least", "exactly", "only", "about", "just"]).unwrap_or(0);
    let (a, b) = measure(&tokens[at..]).filter(|m| m.0 == 0)?;
    let rest = super::words::trimmed(&tokens[at + b..]);
    // (that it stays where it is, is no place of its own)
    let he = usize::from(is(rest.first(), &["it", "he", "she", "they"]));
    let stays = leads(
        &rest[he..],
        &[
            "stays",
            "stay",
            "still",
            "remains",
            "remain",
            "is still",
            "continues",
            "keeps driving",
            "keeps following",
        ],
    );
    (rest.is_empty() || stays.is_some() && !has_noun(rest)).then_some(())?;
    keeps(
        &tokens[from..shall],
        &tokens[at + a],
        &tokens[at + a + 1..at + b],
        talk,
    )
}

/// "a distance of 20 m to the bus is what I need", "my pupil should keep a gap of 20 m to the bus".
fn gap_of(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let gap = (0..tokens.len()).find(|i| begins(&tokens[*i..], GAP).is_some())?;
    let of = gap + begins(&tokens[gap..], GAP)?;
    // ("17 m is the distance that I want to the bus")
    let first =
        measure(&tokens[..gap]).filter(|m| m.0 == 0 && is(tokens.get(m.1), &["is", "should", "would"]));
    let ((a, b), rest) = match first {
        Some(m) => {
            let to = (of..tokens.len().min(of + 7)).find(|k| {
                begins(&tokens[*k..], FROM).is_some_and(|n| is(tokens.get(k + n), &["the", "that"]))
            })?;
            (m, to)
        }
        None => {
            is(tokens.get(of), &["of"]).then_some(())?;
            let (a, b) = measure(&tokens[of..]).filter(|m| m.0 < 4)?;
            ((of + a, of + b), of + b)
        }
    };
    let n = begins(&tokens[rest..], FROM)?;
    let lead = &tokens[..gap];
    // whoever learns to drive sits in our car
    let ours = is(lead.first(), &["my", "our"])
        && is(lead.get(1), &["pupil", "student", "learner", "trainee", "driver"]);
    let known = is(tokens.get(rest + n), &["the", "that", "my", "both"]);
    if has_noun(lead) && !ours || !known || lead.len() > 12 {
        return None;
    }
    let np = &tokens[rest + n..];
    let stop = np.iter().position(|t| {
        is_mark(t)
            || matches!(
                text(t),
                "is" | "would"
                    | "should"
                    | "must"
                    | "will"
                    | "seems"
                    | "are"
                    | "please"
                    | "was"
                    | "rather"
                    | "instead"
                    | "not"
                    | "needs"
            )
    });
    let (np, late) = np.split_at(stop.unwrap_or(np.len()));
    let told = is(late.first(), &["is"]) && is(late.get(1), &["what"]);
    if has_noun(late) && !told || late.iter().any(|t| number(t).is_some()) {
        return None;
    }
    keeps(np, &tokens[a], &tokens[a + 1..b], talk)
}

/// "only 9 m should separate us from the bus", "the bus should be separated from us by 9 m".
fn separated(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    const SEPARATE: &str = "separate|separates|separating|should separate|must separate|have to separate|has to separate|shall separate|are to separate|may separate|ought to separate|\
        will separate|should be separating|part|parts|should part|divide|divides|should divide|keep|keeps|should keep|should lie between|lie between";
    const US_FROM: &str = "us from|me from|our car from|my car from|us and|me and|the ego from|our vehicle from|the ego vehicle from|ourselves and";
    const APART: &str = "should be separated from us by|is separated from us by|must be separated from us by|has to be separated from us by|should be separated from me by|is to be separated from us by|\
        is separated from me by|should be parted from us by";
    if let Some((i, n)) = (1..tokens.len()).find_map(|i| begins(&tokens[i..], APART).map(|n| (i, n))) {
        let (a, b) = measure(&tokens[i + n..]).map(|m| (i + n + m.0, i + n + m.1))?;
        let about = tokens[i + n..a].iter().all(|t| ANSWER.contains(&text(t)));
        return (about && b == tokens.len())
            .then(|| keeps(&tokens[..i], &tokens[a], &tokens[a + 1..b], talk))
            .flatten();
    }
    let (a, b) = measure(tokens).filter(|m| m.0 < 5)?;
    let about = tokens[..a]
        .iter()
        .all(|t| ANSWER.contains(&text(t)) || is(Some(t), &["no", "than"]));
    let n = begins(&tokens[b..], SEPARATE).filter(|_| about)?;
    let from = begins(&tokens[b + n..], US_FROM)?;
    keeps(&tokens[b + n + from..], &tokens[a], &tokens[a + 1..b], talk)
}

/// "only 17 m to the bus, not 25", "eight metres less to the bus".
fn metres_to(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let lead = leads(
        tokens,
        &[
            "only",
            "just",
            "no more than",
            "make it",
            "please",
            "at least",
            "exactly",
            "no less than",
            "let there be",
            "there should be",
            "there must be",
            "keep",
            "leave",
            "i want",
            "i need",
            "we need",
            "there should only be",
            "there should be only",
            "there should be just",
            "there ought to be",
            "make that",
            "i would like",
            "id like",
            "another",
            "add another",
            "leave another",
            "give me another",
            "i want another",
            "we need another",
            "put",
            "add",
            "give us",
        ],
    )
    .unwrap_or(0);
    let (a, b) = measure(&tokens[lead..]).filter(|m| m.0 == 0)?;
    let (a, b) = (a + lead, b + lead);
    let another = lead > 0 && is(tokens.get(lead - 1), &["another"]);
    let step = is(tokens.get(b), &["less", "more", "fewer"]);
    let mut from = b + usize::from(step);
    // "ten metres more distance between us and the car"
    from += usize::from(is(tokens.get(from), &["of"]));
    from += begins(&tokens[from..], ROOM).unwrap_or(0);
    let n = begins(&tokens[from..], FROM)
        .filter(|_| !is(tokens.get(from), &["for", "behind", "ahead", "towards"]))?;
    let rest = &tokens[from + n..];
    is(rest.first(), &["the", "that", "my"]).then_some(())?;
    let close = rest
        .iter()
        .position(|t| {
            is_mark(t)
                || matches!(
                    text(t),
                    "not" | "rather" | "instead" | "please" | "now" | "would" | "should" | "is" | "are"
                )
        })
        .unwrap_or(rest.len());
    let (np, late) = rest.split_at(close);
    // what it is not, or that it would be good so
    let not = late
        .iter()
        .any(|t| matches!(text(t), "not" | "instead" | "rather"));
    let numbers = late.iter().filter(|t| number(t).is_some()).count();
    let plain = late.iter().all(|t| {
        is_mark(t)
            || number(t).is_some()
            || ANSWER.contains(&text(t))
            || matches!(text(t), "not" | "than" | "now")
            || unit_at(std::slice::from_ref(t)).is_some()
    });
    if !plain || numbers > usize::from(not) {
        return None;
    }
    if step || another {
        let (_, e) = first_noun(np).filter(|x| x.0 < 4)?;
        let whole = e == np.len() || super::words::is_place(&np[e..]);
        (whole && talk.fits(np) > 0).then_some(())?;
        let way = if another || is(tokens.get(b), &["more"]) {
            "further away"
        } else {
            "closer"
        };
        let way = led(way, &tokens[a], &[]);
        return Some(led("move", &tokens[a], &[np, &tokens[a..b], &way]));
    }
    keeps(np, &tokens[a], &tokens[a + 1..b], talk)
}
