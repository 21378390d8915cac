//! Sentences in two halves of which one only leads up to the other: "the residents complained about the van, so take it away",
//! "change places: the car behind us, the bus ahead of us", "they haven't set off yet: they still stand on the left", "move the
//! bus across, I want it parked on the left", "... so correct the distance"; and who has not come yet.

use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::gifts::{begins_at, remark};
use super::headway::is_mark;
use super::some_of::removes;
use super::words::{first_noun, has_noun, is, is_place, leads, led, noun_at, number, text, trimmed};

/// A sentence (without its stop) as what it asks for.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let tokens = fellow_of(does_sky(tokens));
    let out = without_fix(our_car(side_named(and_with(tokens)), talk));
    let out = not_come(not_yet(out, talk), talk);
    let out = moved_where(complained(out, talk), talk);
    turned_to(exchanged(out, talk), talk)
}

const FACES: &str = "face|faces|is facing|are facing|looks at|look at|is looking at|are looking at|looks towards|look towards|looks toward|points at|point at|points towards|\
    point towards|is pointed at|looks to|looks straight at|faces towards";

/// "turn the worker until he faces the excavator", "rotate the bus to face us": it should face it.
fn turned_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(verb) = begins(&tokens, "turn|rotate|spin|swivel|pivot") else {
        return tokens;
    };
    let np = &tokens[verb..];
    let Some((_, b)) = first_noun(np)
        .filter(|x| x.0 < 4 && is(np.first(), &["the", "both", "all", "that", "those", "these"]))
    else {
        return tokens;
    };
    let round = b + begins(&np[b..], "around|round|about").unwrap_or(0);
    let Some(n) = begins(
        &np[round..],
        "until|till|so that|so|to|such that|in such a way that",
    )
    .map(|n| round + n) else {
        return tokens;
    };
    let he = n + usize::from(is(np.get(n), &["it", "he", "she", "they"]));
    let Some(at) = begins(&np[he..], FACES).map(|k| he + k) else {
        return tokens;
    };
    if talk.fits(&np[..b]) == 0 || at == np.len() {
        return tokens;
    }
    [&np[..b], &led("should face", &tokens[0], &[&np[at..]])].concat()
}

/// "They have not left yet. They are still on the left sidewalk." is one sentence.
pub fn joined(mut tokens: Vec<Token>) -> Vec<Token> {
    let mut from = 0;
    for i in 0..tokens.len() {
        if tokens[i].kind != TokenKind::Stop {
            continue;
        }
        let denied = tokens[from..i].iter().any(|t| NOT.contains(&text(t)));
        let yet = is(tokens[from..i].last(), &["yet"]);
        let he = is(tokens.get(i + 1), &["it", "he", "she", "they"]);
        let still = (i + 2..tokens.len().min(i + 4)).any(|k| is(tokens.get(k), &["still"]));
        if denied && yet && he && still {
            tokens[i].kind = TokenKind::Comma;
            tokens[i].text = ",".into();
        }
        from = i + 1;
    }
    tokens
}

/// "Only the woman stays. Delete the man.": of the two.
pub fn of_two(tokens: Vec<Token>) -> Vec<Token> {
    use super::super::lexicon::{Sense, look_up};
    const STAYS: &str = "stays|remains|is left|should stay|is to stay|may stay|can stay|should remain|stay|remain|are left|should be left|is staying";
    const GOES: &str = "goes|go|must go|is gone|are gone|leaves|disappears|should go|can go|has to go|is out|disappear|leave|may go";
    let parts: Vec<(usize, usize)> = {
        let mut from = 0;
        let mut out = Vec::new();
        for i in 0..=tokens.len() {
            let link = tokens
                .get(i)
                .is_none_or(|t| is_mark(t) || is(Some(t), &["and", "so"]));
            if link {
                out.push((from, i));
                from = i + 1;
            }
        }
        out
    };
    let class = |t: &[Token]| {
        let (a, b) = first_noun(t).filter(|x| x.0 < 4)?;
        match look_up(text(&t[b - 1])) {
            Some(Sense::Noun(noun, _)) => Some((noun.classes[0], a, b)),
            _ => None,
        }
    };
    let only = |p: &[Token]| {
        let n = begins(p, "only|just")?;
        let (c, _, b) = class(&p[n..]).filter(|_| is(p.get(n), &["the"]))?;
        let late = &p[n + b..];
        (begins(late, STAYS) == Some(late.len())).then_some(c)
    };
    let gone = |p: &[Token]| {
        let n = usize::from(removes(p.first()));
        let (c, _, b) = class(&p[n..]).filter(|_| is(p.get(n), &["the"]))?;
        let late = &p[n + b..];
        (late.is_empty() && n > 0 || begins(late, GOES) == Some(late.len()) && n == 0).then_some(c)
    };
    for pair in parts.windows(2) {
        let (a, b) = (&tokens[pair[0].0..pair[0].1], &tokens[pair[1].0..pair[1].1]);
        let same = |x: Option<_>, y: Option<_>| x.is_some() && x == y;
        if same(only(a), gone(b)) {
            return [&tokens[..pair[0].0], &tokens[pair[1].0..]].concat();
        }
        if same(gone(a), only(b)) {
            return [&tokens[..pair[0].1], &tokens[pair[1].1..]].concat();
        }
    }
    tokens
}

/// "do daytime", "go for a snowy night".
fn does_sky(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let n = i + begins(
            &tokens[i..],
            "do|go for|go with|try|lets do|lets go for|lets try|let us do",
        )
        .filter(|_| begins_at(&tokens, i))?;
        let the = usize::from(is(tokens.get(n), &["a", "an", "the", "some"]));
        let end = (n..tokens.len())
            .find(|k| is_mark(&tokens[*k]))
            .unwrap_or(tokens.len());
        let sky = &tokens[n..end];
        (sky.len() > the && sky.len() < 6 && !has_noun(sky) && super::parting::only_sky(sky)).then(|| {
            out.extend(led("make it", &tokens[i], &[]));
            n
        })
    })
}

/// "the scooter fellow": the scooter.
fn fellow_of(tokens: Vec<Token>) -> Vec<Token> {
    const WHO: [&str; 9] = [
        "fellow", "guy", "chap", "dude", "bloke", "wala", "wallah", "walla", "lad",
    ];
    rewritten(&tokens, |i, _| {
        let who = i > 0 && is(tokens.get(i), &WHO) && noun_at(&tokens[i - 1..]) == Some(1);
        (who && tokens
            .get(i + 1)
            .is_none_or(|t| noun_at(std::slice::from_ref(t)).is_none()))
        .then_some(i + 1)
    })
}

const OUR_SIDE: &str = "on our side of the street|on our side of the road|on our side|on my side of the street|on my side of the road|on my side|on the other side of the street|\
    on the other side of the road|on the other side|on the far side|on the opposite side|on the opposite side of the road|on the opposite side of the street|on the near side";

/// "on our side of the street, on the right sidewalk": there.
fn side_named(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, _| {
        let n = i + begins(&tokens[i..], OUR_SIDE)?;
        let comma = tokens.get(n).is_some_and(is_mark);
        let strip = begins(
            &tokens[(n + 1).min(tokens.len())..],
            "on the right sidewalk|on the left sidewalk|on the right roadside|on the left roadside|at the right roadside|\
            at the left roadside|on the right side of the road|on the left side of the road|on the right|on the left|in the oncoming lane|in our lane",
        );
        (comma && strip.is_some()).then_some(n + 1)
    })
}

/// "remove the truck and with its trailer too", once "do away with" is "remove".
fn and_with(tokens: Vec<Token>) -> Vec<Token> {
    if !removes(tokens.first()) {
        return tokens;
    }
    rewritten(&tokens, |i, out| {
        let with = is(tokens.get(i), &["with"]) && is(out.last(), &["and"]);
        let named = is(
            tokens.get(i + 1),
            &["the", "its", "their", "his", "her", "all", "both"],
        );
        (with && named).then_some(i + 1)
    })
}

const SIDE_OF: &str = "in front of|ahead of|behind|to the left of|to the right of|left of|right of|next to|beside|away from|from";

/// "8 m in front of the car", where no car is: the car is ours.
fn our_car(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let n = i + begins(&tokens[i..], SIDE_OF)?;
        let the = is(tokens.get(n), &["the"]) && is(tokens.get(n + 1), &["car", "vehicle"]);
        let closes = tokens
            .get(n + 2)
            .is_none_or(|t| is_mark(t) || is(Some(t), &["so", "and", "but", "now", "please"]));
        // (one that the text brings in would be meant)
        let new = tokens
            .windows(2)
            .any(|w| is(w.first(), &["a", "another", "one"]) && is(w.get(1), &["car", "vehicle"]));
        let ours = the && closes && !new && noun_at(&tokens[n + 1..]) == Some(1);
        (ours && talk.has_none(&tokens[n..n + 2])).then(|| {
            out.extend_from_slice(&tokens[i..n]);
            out.extend(led("us", &tokens[n], &[]));
            n + 2
        })
    })
}

const FIX: &str = "correct|fix|adjust|amend|change|update|rectify|alter|modify|put right|set right";
const FIXED: &str = "that|it|this|them|him|her|accordingly|the distance|the position|the gap|the place|the scene|the picture|the sketch|the drawing|\
    the layout|the spacing|the number|the error|the mistake|the lane|the side|its position|its place|her position|his position|their position";

/// "the bus was 12 m ahead, so correct the distance": what is right was said.
fn without_fix(tokens: Vec<Token>) -> Vec<Token> {
    let cut = (4..tokens.len()).find_map(|k| {
        let n = begins(&tokens[k..], FIX).filter(|_| begins_at(&tokens, k))?;
        let object = k + n + begins(&tokens[k + n..], FIXED)?;
        let tail = tokens[object..]
            .iter()
            .all(|t| is(Some(t), &["please", "accordingly", "for", "me", "now"]));
        tail.then_some(k)
    });
    let Some(k) = cut else { return tokens };
    let mut head = &tokens[..k];
    while let Some((last, rest)) = head.split_last()
        && (is_mark(last)
            || is(
                Some(last),
                &["so", "and", "please", "then", "kindly", "just", "now"],
            ))
    {
        head = rest;
    }
    let Some((_, b)) = first_noun(head) else {
        return tokens;
    };
    // (it must be said how it should be)
    let told = (b..head.len()).any(|i| is_place(&head[i..])) && head.len() < k;
    if told { head.to_vec() } else { tokens }
}

const NOT: [&str; 11] = [
    "not", "hasnt", "havent", "hadnt", "isnt", "arent", "didnt", "wasnt", "werent", "never", "cannot",
];

/// "the children haven't set off yet: they are still standing on the left sidewalk": there they should be.
fn not_yet(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let Some(yet) = (b..tokens.len().min(b + 9)).find(|k| is(tokens.get(*k), &["yet"])) else {
        return tokens;
    };
    let denied = tokens[b..yet].iter().any(|t| NOT.contains(&text(t)));
    if !denied || has_noun(&tokens[b..yet]) && !is_mark(&tokens[yet - 1]) {
        return tokens;
    }
    let rest = trimmed(&tokens[yet + 1..]);
    let he = is(rest.first(), &["it", "he", "she", "they"]);
    let Some(still) = (1..rest.len().min(3)).find(|k| he && is(rest.get(*k), &["still"])) else {
        return tokens;
    };
    let place = &rest[still + 1..];
    let np = &tokens[..b];
    let told = (0..place.len().min(4)).any(|k| is_place(&place[k..]));
    if !told || talk.fits(np) == 0 {
        return tokens;
    }
    let be = if still == 2 {
        led("should be", &rest[0], &[])
    } else {
        Vec::new()
    };
    [np, &be, place].concat()
}

const COME: &[&str] = &[
    "arrived",
    "come",
    "turned up",
    "shown up",
    "appeared",
    "got there",
    "been there",
    "reached the scene",
    "arrived on the scene",
    "arrived at the scene",
    "been on the scene",
    "got here",
    "entered the scene",
    "driven up",
    "arrived there",
    "arrived here",
    "come along",
    "been around",
    "been present",
    "joined us",
    "been on site",
    "on the scene",
    "on site",
    "around",
    "present",
    "showed up",
    "come here",
];

/// "the ambulance had not arrived yet": it is not there.
fn not_come(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) =
        first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["the", "my", "that", "both", "all"]))
    else {
        return tokens;
    };
    let said = &tokens[b..];
    let denied = said.iter().any(|t| NOT.contains(&text(t)));
    let yet = said.iter().any(|t| is(Some(t), &["yet", "still"]));
    let small = [
        "has", "have", "had", "is", "are", "was", "were", "yet", "still", "even", "at", "all", "then", "by",
    ];
    let words: Vec<&str> = said
        .iter()
        .map(text)
        .filter(|w| !NOT.contains(w) && !small.contains(w))
        .collect();
    let come = COME.contains(&words.join(" ").as_str());
    if denied && yet && come && talk.fits(&tokens[..b]) > 0 {
        return led("remove", &tokens[0], &[&tokens[..b]]);
    }
    tokens
}

const COMPLAINS: &str = "complained about|complain about|have complained about|has complained about|complains about|asked about|ask about|are fed up with|is fed up with|\
    are annoyed by|is annoyed by|are annoyed about|are annoyed with|object to|objected to|objects to|have objected to|are worried about|is worried about|grumbled about|\
    moaned about|moan about|protested against|protest against|called about|rang about|wrote about|are angry about|is angry about|are unhappy with|is unhappy with|hate|hates|\
    do not like|dont like|doesnt like|does not like|cant stand|cannot stand|keep complaining about|keeps complaining about|are complaining about|is complaining about|\
    have been complaining about|has been complaining about|are unhappy about|is unhappy about|disliked|dislike|dislikes|hated|filed a complaint about|have asked about|phoned about";

/// "the residents complained about the van, so take it away": the van goes, whoever complained.
fn complained(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len().min(6)).find_map(|k| begins(&tokens[k..], COMPLAINS).map(|n| (k, k + n)));
    let Some((k, from)) = found.filter(|_| !is(tokens.first(), &["i", "we", "you"])) else {
        return tokens;
    };
    let np = &tokens[from..];
    let Some((_, b)) = first_noun(np).filter(|x| {
        x.0 < 4
            && is(
                np.first(),
                &["the", "that", "those", "both", "all", "these", "this"],
            )
    }) else {
        return tokens;
    };
    let link = (b..np.len())
        .find(|i| is_mark(&np[*i]) || is(np.get(*i), &["so", "and"]))
        .unwrap_or(np.len());
    let who = &np[..link];
    if tokens[..k].iter().any(is_mark) || link > b + 5 || talk.fits(who) == 0 {
        return tokens;
    }
    let rest = trimmed(&np[link..]);
    if rest.is_empty() {
        return remark(who);
    }
    match rest
        .iter()
        .position(|t| is(Some(t), &["it", "them", "him", "her"]))
    {
        Some(i) if !has_noun(&rest[..i]) => [&rest[..i], who, &rest[i + 1..]].concat(),
        _ => tokens,
    }
}

const MOVES: &str = "move|shift|bring|put|pull|push|send|take|get|relocate|reposition";
const WAY: &str = "across|over|away|around|round|elsewhere|aside|along|somewhere else|up|back|a bit|a little|out of the way|out|off|to another place|to a different place";
const WANTS: &str = "i want|i need|we need|we want|i would like|id like|we would like|id prefer|i prefer|i would prefer|id rather have|i would rather have|i would rather see|\
    id rather see|i wish|i would love|id love|we prefer|i would sooner have|i would like to have|i would like to see|id like to have|id like to see|i want to have|i want to see";

/// "move the bus across, I want it parked on the left side of the road": there it should be.
fn moved_where(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let please = usize::from(is(tokens.first(), &["please"]));
    let Some(verb) = begins(&tokens[please..], MOVES) else {
        return tokens;
    };
    let np = &tokens[please + verb..];
    let Some((_, b)) = first_noun(np)
        .filter(|x| x.0 < 4 && is(np.first(), &["the", "that", "both", "all", "those", "these"]))
    else {
        return tokens;
    };
    let way = b + begins(&np[b..], WAY).unwrap_or(0);
    let link = np
        .get(way)
        .is_some_and(|t| is_mark(t) || is(Some(t), &["because", "as", "since", "and"]));
    let rest = trimmed(np.get(way + 1..).unwrap_or(&[]));
    let Some(n) = begins(rest, WANTS).filter(|n| link && is(rest.get(*n), &["it", "them", "him", "her"]))
    else {
        return tokens;
    };
    let place = &rest[n + 1..];
    let place = &place[begins(place, "to be|to stand|to go|to drive|to ride|to wait|to come").unwrap_or(0)..];
    let told = (0..place.len().min(3)).any(|k| is_place(&place[k..]));
    if !told || talk.fits(&np[..b]) == 0 {
        return tokens;
    }
    [&np[..b], &led("should be", &rest[0], &[place])].concat()
}

const EXCHANGE: &str = "change places|swap places|swap them|switch them|swap them round|swap them over|trade places|exchange them|switch places|switch them round|the other way round|\
    the other way around|vice versa|now reversed|reversed|reverse them|reverse that|exchange places|swap|switch|swap over|swapped|reverse the order|swap positions|change positions|\
    switch positions|just the other way round|do it the other way round|make it the other way round|i want it the other way round|i want them swapped|exchange their places|\
    swap their places|swap the two|swap these two|switch around|swap around|switch them around|swap them around|interchange them|switch the two|trade positions|exchange positions|\
    swap it round|swap it around|turn it round|turn it around|now the other way round|it should be the other way round|it is the other way round|swap sides|change sides|\
    change their places|switch their places|reverse their positions|swap their positions|switch their positions|wrong way round|the wrong way round|swop them|swop places";

/// One of the two: who, and where he should be.
fn who_where<'t>(part: &'t [Token], talk: &Talk<'_>) -> Option<(Vec<Token>, &'t [Token])> {
    let part = trimmed(part);
    let (a, b) = first_noun(part).filter(|x| x.0 < 3)?;
    let own = is(part.first(), &["the", "that", "my"]);
    if part[..a]
        .iter()
        .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]))
    {
        return None;
    }
    let np = if own {
        part[..b].to_vec()
    } else {
        led("the", &part[0], &[&part[..b]])
    };
    let rest = &part[b..];
    let rest = &rest[begins(
        rest,
        "should be|goes|is|now|belongs|should go|comes|drives|moves|must be|has to be|stands",
    )
    .unwrap_or(0)..];
    (is_place(rest) && !has_noun(rest) && talk.boxes_of(&np).len() == 1).then_some((np, rest))
}

/// "switch them: the garbage truck in front of us, the red car behind us".
fn exchanged(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = begins(&tokens, "no|please|now|ok|just|and|then").unwrap_or(0);
    let Some(n) = begins(&tokens[lead..], EXCHANGE).map(|n| n + lead) else {
        return tokens;
    };
    if !tokens.get(n).is_some_and(is_mark) {
        return tokens;
    }
    let rest = &tokens[n + 1..];
    let parts: Vec<&[Token]> = rest
        .split(|t| is_mark(t) || is(Some(t), &["and", "while"]))
        .filter(|p| !trimmed(p).is_empty())
        .collect();
    let [one, two] = parts.as_slice() else {
        return tokens;
    };
    let (Some((a, at)), Some((b, to))) = (who_where(one, talk), who_where(two, talk)) else {
        return tokens;
    };
    let x = |np: &[Token]| talk.boxes_of(np).first().map_or(0.0, |b| b.center_m.x);
    let side = |place: &[Token]| match leads(
        place,
        &[
            "ahead of us",
            "in front of us",
            "ahead of me",
            "in front of me",
            "ahead",
            "in front",
        ],
    ) {
        Some(_) => 1.0,
        None if leads(place, &["behind us", "behind me", "behind"]).is_some() => -1.0,
        None => 0.0,
    };
    let opposite = side(at) * side(to) < 0.0 && x(&a) * side(at) < 0.0 && x(&b) * side(to) < 0.0;
    if opposite {
        return led("swap", &tokens[0], &[&a, &led("and", &tokens[0], &[&b])]);
    }
    let put = |np: &[Token], place: &[Token]| led("put", &tokens[0], &[np, place]);
    [put(&a, at), led("and", &tokens[0], &[&put(&b, to)])].concat()
}
