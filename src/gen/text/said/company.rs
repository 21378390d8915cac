//! Who comes to whom, and who goes with whom: "two more join the three", "give the cyclists a third companion", "the boy's
//! mother has come", "the man gets on the bus", "the tow truck takes the car away".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::Talk;
use super::lists::MATES;
use super::topics::singular_of;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use crate::scene::Class;

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = keeps_company(tokens);
    let out = same_place(joining(joining_there(out, talk), talk), talk);
    let out = companion(with_those(out, talk), talk);
    let out = kin(out, talk);
    let out = beside_it(as_one(boards(out, talk)));
    takes_away(out, talk)
}

/// "a second man keeps the first one company, right beside him": he stands next to him.
fn keeps_company(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        is(
            tokens.get(i),
            &["keeps", "keep", "keeping", "kept", "bears", "bear"],
        )
        .then_some(())?;
        let company = (i + 2..tokens.len().min(i + 8)).find(|k| is(tokens.get(*k), &["company"]))?;
        Some((i, company))
    });
    let Some((i, company)) = found else {
        return tokens;
    };
    // (where he stands then is told by whom he is with)
    let after = trimmed(&tokens[company + 1..]);
    let again = begins(
        after,
        "right beside him|right beside her|right beside it|beside him|beside her|beside it|next to him|next to her|next to it|right next to him|right next to her|right next to it|at his side|at her side|by his side|by her side|right beside them|beside them|next to them|close to him|close to her",
    );
    let rest = match again {
        Some(n) => &after[n..],
        None => &tokens[company + 1..],
    };
    let whom = led("next to", &tokens[i], &[&tokens[i + 1..company], rest]);
    // ("to keep him company")
    let to = is(tokens.get(i - 1), &["to"]);
    let lead = if to {
        Vec::new()
    } else if is(tokens.get(i), &["keep", "keeping"]) {
        led("standing", &tokens[i], &[])
    } else {
        led("stands", &tokens[i], &[])
    };
    [&tokens[..i - usize::from(to)], &lead, &whom].concat()
}

/// "my son comes by bike: add him as a cyclist": add a cyclist.
fn as_one(tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len()).find(|i| {
        is(
            tokens.get(*i),
            &["add", "put", "insert", "include", "place", "show", "draw"],
        ) && is(tokens.get(i + 1), &["him", "her", "it", "them"])
            && (*i == 0 || mark(&tokens[i - 1]) || is(tokens.get(i - 1), &["so", "and", "please"]))
    });
    let Some(i) = found else {
        return tokens;
    };
    let late = leads(
        &tokens[i + 2..],
        &["in as", "there as", "into the scene as", "as"],
    );
    let Some(new) = late.map(|n| &tokens[i + 2 + n..]) else {
        return tokens;
    };
    let fresh = is(new.first(), &["a", "an", "another"]) || new.first().is_some_and(|t| number(t).is_some());
    // who he is was only told; nothing is asked for before
    let told = is(
        tokens.first(),
        &[
            "my", "our", "his", "her", "a", "an", "here", "this", "that", "there",
        ],
    );
    if fresh && has_noun(new) && (i == 0 || told) {
        return led("add", &tokens[i], &[new]);
    }
    tokens
}

/// "have the car stand on the right with an officer next to it": and add an officer next to it.
fn beside_it(tokens: Vec<Token>) -> Vec<Token> {
    const BESIDE: &[&str] = &[
        "next to",
        "beside",
        "by",
        "near",
        "close to",
        "behind",
        "in front of",
        "ahead of",
        "alongside",
        "right behind",
        "right next to",
        "directly behind",
        "just behind",
        "to the left of",
        "to the right of",
    ];
    let Some(i) = (3..tokens.len()).find(|i| is(tokens.get(*i), &["with"])) else {
        return tokens;
    };
    let new = &tokens[i + 1..];
    let own = is(new.first(), &["its", "his", "her", "their"]);
    let fresh = own || is(new.first(), &["a", "an"]) || new.first().is_some_and(|t| number(t).is_some());
    let Some((_, b)) = first_noun(new).filter(|x| fresh && x.0 < 4) else {
        return tokens;
    };
    let stands = leads(
        &new[b..],
        &["standing", "waiting", "walking", "parked", "driving", "right"],
    )
    .unwrap_or(0);
    let Some(n) = leads(&new[b + stands..], BESIDE) else {
        return tokens;
    };
    let it = b + stands + n;
    let points = is(new.get(it), &["it", "him", "her", "them"]) && new.get(it + 1).is_none_or(mark);
    let moves = is(tokens.first(), &super::lists::MOVES);
    let known = |k: usize| {
        is(
            tokens.get(k),
            &[
                "the", "my", "our", "both", "that", "this", "all", "it", "him", "her", "them",
            ],
        )
    };
    // (what is new has its company by itself)
    let there = known(0) && first_noun(&tokens).is_some_and(|x| x.0 < 5) || moves && known(1);
    if points && there {
        let and = led(if own { "and add a" } else { "and add" }, &tokens[i], &[]);
        return [trimmed(&tokens[..i]), &and, &new[usize::from(own)..]].concat();
    }
    tokens
}

pub(super) fn mark(t: &Token) -> bool {
    matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop)
}

fn class_of(noun: &[Token]) -> Option<Class> {
    match super::words::longest(noun)?.0 {
        Sense::Noun(n, _) => Some(n.classes[0]),
        _ => None,
    }
}

/// "two more children join the three": two more of them.
fn joining(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        let verb = leads(
            &tokens[i..],
            &[
                "join",
                "joins",
                "have joined",
                "has joined",
                "should join",
                "joined",
                "will join",
                "are joining",
                "is joining",
                "shall join",
            ],
        )?;
        let mut k = i + verb;
        k += usize::from(is(tokens.get(k), &["the", "these", "those"]));
        let whom = leads(
            &tokens[k..],
            &[
                "others",
                "other",
                "rest",
                "group",
                "existing ones",
                "ones there",
                "first ones",
                "first one",
                "them",
                "him",
                "her",
                "ones who are there",
                "ones already there",
                "lot",
            ],
        );
        let theirs = is(tokens.get(k), &["his", "her", "their", "its", "both"])
            .then(|| 1 + usize::from(tokens.get(k + 1).is_some_and(|t| number(t).is_some())))
            .filter(|n| is(tokens.get(k + n), &MATES))
            .map(|n| n + 1);
        let whom = whom.or(theirs);
        let number_of = tokens.get(k).is_some_and(|t| number(t).is_some());
        let n = if number_of {
            1 + usize::from(is(tokens.get(k + 1), &["others", "ones"]))
        } else {
            whom?
        };
        tokens
            .get(k + n)
            .is_none_or(|t| mark(t) || is(Some(t), &["and", "so", "already"]) || is_place(&tokens[k + n..]))
            .then_some((i, k + n))
    });
    let Some((i, end)) = found else {
        return tokens;
    };
    let from = tokens[..i]
        .iter()
        .rposition(|t| mark(t) || is(Some(t), &["and", "but"]))
        .map_or(0, |k| k + 1);
    let np = &tokens[from..i];
    let fresh = is(np.first(), &["a", "an", "another"]) || np.first().is_some_and(|t| number(t).is_some());
    let Some((a, b)) = first_noun(np).filter(|x| fresh && x.0 < 4 && x.1 == np.len()) else {
        return tokens;
    };
    if talk.fits(&np[a..b]) == 0 {
        return tokens;
    }
    let one = is(np.first(), &["a", "an"]);
    let more = if one || np.iter().any(|t| matches!(text(t), "more" | "another")) {
        Vec::new()
    } else {
        led("more", &np[0], &[])
    };
    let lead = if one {
        led("another", &np[0], &[])
    } else {
        np[..1].to_vec()
    };
    // ("a third worker" is one more)
    let rest: Vec<Token> = np[1..]
        .iter()
        .filter(|t| super::super::foremost::ordinal(text(t)).is_none())
        .cloned()
        .collect();
    let add = led("add", &tokens[from], &[&lead, &more, &rest]);
    [&tokens[..from], &add, &tokens[end..]].concat()
}

/// "another child on the same sidewalk": more of them come to where the others are anyhow.
fn same_place(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &["on the same", "in the same", "at the same", "along the same"],
    ) else {
        return tokens;
    };
    let strip = is(
        tokens.get(i + n),
        &[
            "sidewalk", "pavement", "side", "kerb", "curb", "roadside", "footpath", "lane", "verge",
            "shoulder", "spot", "place", "corner",
        ],
    );
    let mut end = i + n + 1;
    end += leads(
        &tokens[end.min(tokens.len())..],
        &[
            "of the road",
            "of the street",
            "as them",
            "as they",
            "as the others",
            "as the other",
            "as the rest",
            "as him",
            "as her",
            "as the first",
            "as before",
            "too",
            "as well",
        ],
    )
    .unwrap_or(0);
    let from = tokens[..i].iter().rposition(mark).map_or(0, |k| k + 1);
    let np = &tokens[from..i];
    let more = np.iter().any(|t| {
        is(Some(t), &["more", "another", "further", "additional", "extra"])
            || super::super::foremost::ordinal(text(t)).is_some()
                && is(np.first(), &["a", "an", "add", "put"])
    });
    let there = first_noun(np).is_some_and(|(a, b)| talk.fits(&np[a..b]) > 0);
    if strip && more && there && tokens.get(end).is_none_or(|t| mark(t) || is(Some(t), &["and"])) {
        // (they come where the others are, by name if these are all in one place)
        let lane = is(tokens.get(i + n), &["lane"]);
        let (a, b) = first_noun(np).unwrap_or_default();
        let name = super::lane_of::name_of(&talk.boxes_of(&np[a..b]), talk);
        // (what stands beside the road stands on the strip that is named)
        let walk = is(tokens.get(i + n), &["sidewalk", "pavement", "footpath"]);
        let name = name.map(|name| match name {
            "the right roadside" if walk => "the right sidewalk",
            "the left roadside" if walk => "the left sidewalk",
            other => other,
        });
        if let Some(name) = name.filter(|name| lane == name.ends_with(" lane")) {
            let at = led(if lane { "in" } else { "on" }, &tokens[i], &[]);
            return [&tokens[..i], &at, &led(name, &tokens[i], &[]), &tokens[end..]].concat();
        }
        return [&tokens[..i], &tokens[end..]].concat();
    }
    tokens
}

/// "let a man join the children on the zebra": a man on the zebra.
fn joining_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        let verb = leads(
            &tokens[i..],
            &[
                "join",
                "joins",
                "have joined",
                "has joined",
                "should join",
                "joined",
                "will join",
                "joining",
                "are joining",
                "is joining",
                "shall join",
                "is to join",
                "has just joined",
            ],
        )?;
        let whom = i + verb;
        let pronoun = is(tokens.get(whom), &["them", "him", "her", "it"]);
        let place = if pronoun {
            whom + 1
        } else {
            is(
                tokens.get(whom),
                &["the", "these", "those", "both", "that", "our", "my"],
            )
            .then_some(())?;
            let (_, b) = first_noun(&tokens[whom..]).filter(|x| x.0 < 5)?;
            (talk.fits(&tokens[whom..whom + b]) > 0).then_some(whom + b)?
        };
        let to = place
            + tokens[place..]
                .iter()
                .position(mark)
                .unwrap_or(tokens.len() - place);
        let there = is(tokens.get(place), &["on", "in", "at"])
            && !has_noun(&tokens[place..to])
            && !tokens[place..to].iter().any(|t| is(Some(t), &["and"]));
        there.then_some((i, place))
    });
    let Some((i, place)) = found else { return tokens };
    let from = tokens[..i]
        .iter()
        .rposition(|t| mark(t) || is(Some(t), &["and", "but"]))
        .map_or(0, |k| k + 1);
    let let_ = usize::from(is(tokens.get(from), &["let", "have", "make", "get"]));
    let np = &tokens[from + let_..i];
    let np = if is(np.last(), &["to"]) {
        &np[..np.len() - 1]
    } else {
        np
    };
    let fresh = is(np.first(), &["a", "an", "another", "some", "somebody", "someone"])
        || np.first().is_some_and(|t| number(t).is_some());
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 4) else {
        return tokens;
    };
    // "have the cyclist join the pedestrians on the left sidewalk": he goes there
    if is(np.first(), &["the", "that", "both", "my"]) && b == np.len() && talk.fits(np) > 0 {
        return [
            &tokens[..from],
            np,
            &led("should be", &tokens[i], &[&tokens[place..]]),
        ]
        .concat();
    }
    if !fresh || b != np.len() && !is(np.get(b), &["with", "in", "from"]) {
        return tokens;
    }
    [
        &tokens[..from],
        &led("add", &tokens[from], &[np]),
        &tokens[place..],
    ]
    .concat()
}

/// "put three more pedestrians with the two": three more of them; "the officer joined by two more": two more officers.
fn with_those(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if let Some((i, n)) = super::words::find(&tokens, &["with the", "to the", "beside the", "next to the"])
        && tokens.get(i + n).is_some_and(|t| number(t).is_some())
        && tokens
            .get(i + n + 1)
            .is_none_or(|t| mark(t) || is(Some(t), &["others", "ones", "who", "already", "that"]))
        && is(tokens.first(), &["put", "add", "place", "let", "set"])
        && let Some((a, b)) = first_noun(&tokens[..i])
        && b == i
        && tokens[1..a].iter().any(|t| is(Some(t), &["more", "another"]))
        && talk.fits(&tokens[a..b]) > 0
    {
        let close = (i + n + 1..tokens.len())
            .find(|k| mark(&tokens[*k]))
            .unwrap_or(tokens.len());
        return [&led("add", &tokens[0], &[&tokens[1..i]]), &tokens[close..]].concat();
    }
    let joined = super::words::find(
        &tokens,
        &["joined by", "accompanied by", "supported by", "reinforced by"],
    );
    let Some((i, n)) = joined.filter(|x| x.0 > 1) else {
        return tokens;
    };
    let new = &tokens[i + n..];
    let many = new
        .first()
        .filter(|t| number(t).is_some() || is(Some(t), &["another"]));
    let more = is(new.get(1), &["more", "others"]) || is(new.first(), &["another"]);
    let k = 1 + usize::from(is(new.get(1), &["more", "others"]));
    let Some((a, b)) = super::words::first_noun(&tokens[..i]) else {
        return tokens;
    };
    let known = is(tokens.get(a.wrapping_sub(1)), &["the", "my", "that", "both"])
        || a > 1 && is(tokens.get(a - 2), &["the"]);
    if many.is_none() || !more || !known || !new.get(k).is_none_or(mark) || talk.fits(&tokens[a..b]) == 0 {
        return tokens;
    }
    let mut noun = tokens[a..b].to_vec();
    if let Some(last) = noun.last_mut()
        && number(&new[0]).is_some_and(|n| n > 1)
        && matches!(look_up(text(last)), Some(Sense::Noun(_, false)))
    {
        last.text = super::super::lexicon::plural(&last.text);
    }
    let more = led("more", &tokens[0], &[&noun]);
    led("add", &tokens[0], &[&new[..1], &more, &new[k..]])
}

/// "give the two cyclists a third companion": one more of them.
fn companion(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["give", "get", "bring", "lend", "find"]) else {
        return tokens;
    };
    if !is(tokens.get(n), &["the", "both", "that", "my"]) {
        return tokens;
    }
    let Some((a, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let (noun, rest) = (&tokens[n + a..n + b], &tokens[n + b..]);
    // ("give the man on the left pavement a companion": there, too)
    let new = (2..rest.len().min(9)).find(|j| {
        let counted = is(rest.get(*j), &["a", "an", "another"]) || number(&rest[*j]).is_some();
        counted && (1..3).any(|m| is(rest.get(j + m), &MATES))
    });
    let (there, rest) = match new
        .filter(|j| is_place(rest) && !has_noun(&rest[..*j]) && talk.fits(&tokens[n + a..n + b + j]) > 0)
    {
        Some(j) => rest.split_at(j),
        None => (&rest[..0], rest),
    };
    let many = rest.first().and_then(number).filter(|m| *m > 0);
    let mut k = usize::from(many.is_some() || is(rest.first(), &["a", "an", "another"]));
    while k > 0
        && rest.get(k).is_some_and(|t| {
            super::super::foremost::ordinal(text(t)).is_some() || is(Some(t), &["new", "more"])
        })
    {
        k += 1;
    }
    // "two fellow riders"
    let fellow = usize::from(
        is(rest.get(k), &["fellow"])
            && rest
                .get(k + 1)
                .is_some_and(|t| !mark(t) && !super::words::is_place(&rest[k + 1..])),
    );
    k += fellow;
    // ", who are also ahead of us"
    let also = super::words::leads(&rest[(k + 1).min(rest.len())..], WHO_ALSO).unwrap_or(0);
    let state = usize::from(is(
        rest.get(k + 1 + also),
        &[
            "riding", "driving", "walking", "standing", "waiting", "going", "parked", "coming", "running",
        ],
    ));
    let place = &rest[(k + 1 + also + state).min(rest.len())..];
    let named = fellow > 0 || is(rest.get(k), &MATES);
    let mate = k > 0
        && named
        && (place.first().is_none_or(|t| also == 0 && mark(t)) || super::words::is_place(place));
    if !mate || talk.fits(noun) == 0 {
        return tokens;
    }
    let one = singular_of(noun);
    let add = match many.filter(|m| *m > 1) {
        Some(_) => led(
            "add",
            &tokens[0],
            &[&rest[..1], &led("more", &tokens[0], &[noun])],
        ),
        None => led("add another", &tokens[0], &[&one]),
    };
    let parked = is(rest.get(k + 1 + also), &["parked", "standing", "waiting"]);
    let verb = if parked { &rest[k + 1 + also..][..1] } else { &[] };
    // ("a companion riding beside it")
    let mut at: Vec<Token> = Vec::new();
    for t in place {
        match is(Some(t), &["it", "him", "her", "them"]) {
            true => at.extend_from_slice(&tokens[n..n + b]),
            false => at.push(t.clone()),
        }
    }
    [&add[..], verb, there, &at].concat()
}

const WHO_ALSO: &[&str] = &[
    ", who are also",
    ", who is also",
    "who are also",
    "who is also",
    ", also",
    "also",
    ", who also stand",
    ", who also stands",
    ", who also ride",
    ", who also rides",
    ", who also drive",
    ", both also",
    "who also ride",
    "who also stand",
    ", who are likewise",
    ", both",
    "too ,",
    ", who ride",
    ", who stand",
    ", who are",
    ", all",
];

/// "the boy's mother and father have come, they stand beside him": both are new.
fn kin(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const KIN: &[&str] = &[
        "mother",
        "father",
        "mum",
        "mom",
        "dad",
        "sister",
        "brother",
        "wife",
        "husband",
        "son",
        "daughter",
        "friend",
        "colleague",
        "mate",
        "partner",
        "boyfriend",
        "girlfriend",
        "grandmother",
        "grandfather",
        "uncle",
        "aunt",
        "teacher",
        "boss",
        "neighbour",
        "neighbor",
    ];
    const COME: &[&str] = &[
        "has come",
        "have come",
        "has joined",
        "have joined",
        "has arrived",
        "have arrived",
        "comes",
        "come",
        "joins",
        "join",
        "stands",
        "stand",
        "is there",
        "are there",
        "has turned up",
        "have turned up",
        "should be there",
        "arrives",
        "arrive",
        "waits",
        "wait",
        "has appeared",
        "have appeared",
        "is here",
        "are here",
        "should stand",
        "should be",
        "is",
        "are",
    ];
    if !is(tokens.first(), &["the", "that", "my"]) {
        return tokens;
    }
    // ("boy's" lost its ending)
    let Some(k) = (2..tokens.len().min(5)).find(|k| is(tokens.get(*k), KIN)) else {
        return tokens;
    };
    let owner = &tokens[..k];
    let person = first_noun(owner).is_some_and(|x| x.1 == k || x.0 == 1)
        && class_of(&tokens[1..2]).is_some_and(|c| c == Class::Pedestrian || c == Class::Bicycle);
    let second = is(tokens.get(k + 1), &["and"]) && is(tokens.get(k + 2), KIN);
    let end = if second { k + 3 } else { k + 1 };
    let Some(n) = leads(&tokens[end..], COME) else {
        return tokens;
    };
    if !person || talk.fits(owner) != 1 {
        return tokens;
    }
    let mut who = led("a", &tokens[k], &[&tokens[k..k + 1]]);
    if second {
        who.extend(led("and a", &tokens[k], &[&tokens[k + 2..k + 3]]));
    }
    // where they are, if it is somewhere else than beside
    let rest = &tokens[end + n..];
    let close = rest
        .iter()
        .position(|t| t.kind == TokenKind::Stop)
        .unwrap_or(rest.len());
    let place = trimmed(&rest[..close]);
    let told = super::words::is_place(place)
        && !place.iter().any(|t| {
            is(
                Some(t),
                &["him", "her", "it", "them", "next", "beside", "with", "there"],
            )
        });
    let near = led("next to", &tokens[0], &[owner]);
    led(
        "add",
        &tokens[0],
        &[&who, if told { place } else { &near }, &rest[close..]],
    )
}

/// "the man gets on the bus": he is seen no more; "and they drive off": nor is the bus.
fn boards(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const BOARDS: &[&str] = &[
        "gets on",
        "get on",
        "gets into",
        "get into",
        "gets in",
        "got on",
        "got into",
        "hops into",
        "hops on",
        "hops onto",
        "hop on",
        "hop into",
        "climbs into",
        "climbs aboard",
        "climbs onto",
        "climb into",
        "boards",
        "board",
        "has got on",
        "have got on",
        "has got into",
        "have got into",
        "has boarded",
        "have boarded",
        "has climbed into",
        "have climbed into",
        "has gotten into",
        "have gotten into",
        "has gotten on",
        "steps into",
        "stepped into",
        "has hopped on",
        "has hopped into",
        "has entered",
        "have entered",
        "enters",
        "enter",
        "has stepped into",
        "sit in",
        "sits in",
        "are sitting in",
        "is sitting in",
        "now sit in",
        "now sits in",
        "sit inside",
        "sits inside",
    ];
    const OFF: &[&str] = &[
        "leave",
        "leaves",
        "drive off",
        "drives off",
        "drive away",
        "drives away",
        "are gone",
        "is gone",
        "has left",
        "have left",
        "disappear",
        "disappears",
        "has driven off",
        "have driven off",
        "go",
        "goes",
        "off they go",
        "departs",
        "depart",
        "vanish",
        "vanishes",
    ];
    let found =
        (1..tokens.len()).find_map(|i| {
            let n = leads(&tokens[i..], BOARDS)?;
            is(tokens.get(i + n), &["the", "my", "that"]).then_some(())?;
            let (a, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 4)?;
            let vehicle = class_of(&tokens[i + n + a..]).is_some_and(|c| c.is_vehicle());
            let from = tokens[..i]
                .iter()
                .rposition(|t| mark(t) || is(Some(t), &["and", "but", "let"]))
                .map_or(0, |k| k + 1);
            let who = &tokens[from..i];
            let (_, e) = first_noun(who).filter(|x| x.0 < 5)?;
            let known = is(
                who.first(),
                &["the", "both", "my", "that", "all", "these", "those"],
            ) || is(who.get(1), &["of"]);
            let walks = class_of(&who[e - 1..]).is_some_and(|c| c == Class::Pedestrian);
            (vehicle && known && walks && e == who.len() && talk.fits(&tokens[i + n..i + n + b]) > 0)
                .then_some((from, i, i + n, i + n + b))
        });
    let Some((from, i, bus, end)) = found else {
        return tokens;
    };
    if tokens
        .get(end)
        .is_some_and(|t| !mark(t) && !is(Some(t), &["and", "so", "which", "now"]))
    {
        return tokens;
    }
    let mut out = led("remove", &tokens[from], &[&tokens[from..i]]);
    let mut rest = trimmed(&tokens[end..]);
    let lead = leads(rest, &["they", "it", "both", "both of them", "which", "the two"]).unwrap_or(0);
    let off = leads(&rest[lead..], OFF).map(|n| lead + n).map(|n| {
        n + leads(
            &rest[n..],
            &["together", "with him", "with her", "with them", "too", "as well"],
        )
        .unwrap_or(0)
    });
    if let Some(n) = off.filter(|n| lead > 0 && rest.get(*n).is_none_or(mark)) {
        out.extend(led("and", &tokens[from], &[&tokens[bus..end]]));
        rest = trimmed(&rest[n..]);
    }
    // ("so you only see one")
    let counted = is(tokens[end..].iter().find(|t| !mark(t)), &["so", "now"])
        && !has_noun(rest)
        && rest.iter().any(|t| number(t).is_some());
    if !rest.is_empty() && !counted {
        let mut comma = led(",", &tokens[end - 1], &[rest]);
        comma[0].kind = TokenKind::Comma;
        out.extend(comma);
    }
    [&tokens[..from], &out].concat()
}

/// "the tow truck takes the red car away": the car goes, and the truck, too, if it takes it along.
fn takes_away(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const TAKES: &[&str] = &[
        "takes",
        "take",
        "has taken",
        "have taken",
        "tows",
        "has towed",
        "hauls",
        "has hauled",
        "drags",
        "has dragged",
        "carries",
        "has carried",
        "picks",
        "has picked",
        "collects",
        "has collected",
        "took",
        "towed",
    ];
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], TAKES)?;
        let who = &tokens[..i];
        let (_, e) = first_noun(who).filter(|x| x.0 < 4)?;
        (is(who.first(), &["the", "my", "that"]) && e == i && talk.fits(who) > 0).then_some(())?;
        let what = &tokens[i + n..];
        let known = is(what.first(), &["the", "both", "all", "that", "my"]) || is(what.get(1), &["of"]);
        let (_, b) = first_noun(what).filter(|x| known && x.0 < 6)?;
        let away = leads(
            &what[b..],
            &[
                "away",
                "off",
                "up",
                "along",
                "with it",
                "away with it",
                "along with it",
                "off with it",
                "with him",
                "away with him",
                "with her",
                "with them",
            ],
        )?;
        let end = i + n + b + away;
        tokens
            .get(end)
            .is_none_or(mark)
            .then_some((i, i + n, i + n + b, end))
    });
    let Some((i, from, close, end)) = found else {
        return tokens;
    };
    let along = tokens[close..end].iter().any(|t| is(Some(t), &["with", "along"]));
    let what = &tokens[from..close];
    if !has_noun(what) || look_up(text(&tokens[i])).is_some_and(|s| matches!(s, Sense::Noun(..))) {
        return tokens;
    }
    let mut out = led("remove", &tokens[0], &[what]);
    if along {
        out.extend(led("and", &tokens[0], &[&tokens[..i]]));
    }
    out.extend_from_slice(&tokens[end..]);
    out
}
