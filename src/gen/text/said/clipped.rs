//! Notes that name something known and where it shall be, without a verb: "truck at 18 m rather than at 30", "motorcycle: same
//! lane, but 12 m in front of us", "motorcycle much closer, 10 metres", "kids on the left sidewalk, all four"; and groups that part.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::brief_places::strip_of;
use super::words::{
    find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text, trimmed, unit_at,
};

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = no_but(
        fronted(there_instead(for_whom(super::mistaken::whose(tokens)))),
        talk,
    );
    let out = parted(more_of_them(picked_first(out)), talk);
    let out = same_as(beside_them(out, talk), talk);
    let out = grown(stopped_following(led_up_to(out, talk), talk), talk);
    let out = other_kind(so_many_here(place_before(out)), talk);
    noted(&out, talk).unwrap_or(out)
}

/// "we want to be tailgated: bus at 7 m": the bus that is there.
fn led_up_to(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(colon) = (3..tokens.len()).find(|k| text(&tokens[*k]) == ":") else {
        return tokens;
    };
    let (lead, rest) = (&tokens[..colon], &tokens[colon + 1..]);
    let fresh = lead
        .iter()
        .any(|t| is(Some(t), &["more", "another", "add", "new", "also", "need"]));
    let Some((np, b)) = known(rest, talk).filter(|_| !has_noun(lead) && !fresh) else {
        return tokens;
    };
    let far = is(rest.get(b), &["at"]) && measure(&rest[b + 1..]).is_some_and(|m| b + 1 + m == rest.len());
    if !far || talk.fits(&np) != 1 {
        return tokens;
    }
    [
        &np[..],
        &led(
            "should be",
            &rest[b],
            &[&rest[b + 1..], &away(&np, &rest[b], talk)],
        ),
    ]
    .concat()
}

/// Where a noun ends that names what is there, alone or with what describes it, and with its article.
fn known(tokens: &[Token], talk: &Talk<'_>) -> Option<(Vec<Token>, usize)> {
    let (a, b) = first_noun(tokens).filter(|n| n.0 < 4)?;
    let the = usize::from(is(tokens.first(), &["the", "both", "all", "that", "those"]));
    let described = tokens[the.min(a)..a].iter().all(|t| {
        matches!(
            look_up(text(t)),
            Some(Sense::Color(_) | Sense::State(_, false) | Sense::Size(_) | Sense::Attribute(_))
        ) || the > 0 && (is(Some(t), &["the"]) || number(t).is_some())
    });
    let many = matches!(look_up(text(&tokens[b - 1])), Some(Sense::Noun(_, true)));
    let np = if the > 0 {
        tokens[..b].to_vec()
    } else {
        led("the", &tokens[0], &[&tokens[..b]])
    };
    let fits = talk.fits(&np);
    (described && (fits == 1 || many && fits > 1)).then_some((np, b))
}

fn measure(tokens: &[Token]) -> Option<usize> {
    number(tokens.first()?)?;
    Some(1 + unit_at(&tokens[1..])?)
}

/// On which side of the ego vehicle it is anyhow, where only a distance is told.
fn away(np: &[Token], at: &Token, talk: &Talk<'_>) -> Vec<Token> {
    let boxes = talk.boxes_of(np);
    let beside = boxes.iter().any(|b| b.center_m.x.abs() < b.center_m.y.abs());
    let side = |ahead: bool| boxes.iter().all(|b| (b.center_m.x > 0.0) == ahead);
    let words = match () {
        () if beside => "away",
        () if side(true) => "ahead of us",
        () if side(false) => "behind us",
        () => "away",
    };
    // (and it stays in its lane)
    let lanes: Vec<_> = boxes
        .iter()
        .map(|b| super::super::holds::role_of(talk.map, b))
        .collect();
    let same = lanes.iter().all(|s| *s == lanes[0] && s.is_some());
    let strip = strip_of(np, talk)
        .filter(|s| same && words != "away" && s.ends_with("lane"))
        .map_or_else(Vec::new, |s| led(s, at, &[]));
    [led(words, at, &[]), strip].concat()
}

const NOT_THERE: &[&str] = &[
    "instead of",
    "rather than",
    "not",
    "and not",
    "in place of",
    "as opposed to",
];
const DEGREE: &[&str] = &[
    "much",
    "a lot",
    "a little",
    "a bit",
    "slightly",
    "somewhat",
    "far",
    "way",
    "considerably",
    "even",
    "quite a bit",
    "a good deal",
    "a tad",
    "a touch",
];
const NEARER: &[&str] = &[
    "closer",
    "nearer",
    "further away",
    "farther away",
    "further off",
    "farther off",
    "further",
    "farther",
    "closer up",
    "closer in",
    "further out",
    "farther out",
    "closer to us",
    "nearer to us",
    "closer to me",
    "nearer to me",
    "further away from us",
    "farther away from us",
    "further from us",
    "farther from us",
];
const SAME: &[&str] = &[
    "same lane",
    "same distance",
    "same side",
    "same sidewalk",
    "same spot",
    "same edge",
    "same position",
    "same place",
];
const ALL_OF: &[&str] = &[
    "both",
    "all",
    "both of them",
    "all of them",
    "every one of them",
    "the whole group",
    "the lot",
    "the lot of them",
];

/// What is noted of something known, as what it should be.
fn noted(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let (np, b) = known(tokens, talk)?;
    let rest = &tokens[b..];
    if rest
        .iter()
        .any(|t| super::lists::HELPERS.contains(&text(t)) || is_finite(text(t), false))
    {
        return None;
    }
    let to = |place: &[Token]| Some([&np[..], &led("should be", &tokens[0], &[place])].concat());
    // "motorcycle: same lane, but 12 m in front of us"
    if let Some(n) = rest
        .first()
        .filter(|t| text(t) == ":")
        .and_then(|_| leads(&rest[1..], SAME))
    {
        let place = trimmed(&rest[1 + n..]);
        let place = &place[leads(place, &["only", "just", "but only", "but just"]).unwrap_or(0)..];
        let strip = strip_of(&np, talk).filter(|_| is(rest.get(2), &["lane", "side", "sidewalk", "edge"]));
        // (a goal of its own is no distance)
        let far = measure(place).is_some();
        if !is_place(place) || has_noun(place) || place.iter().any(|t| t.kind == TokenKind::Comma) {
            return None;
        }
        let away = if measure(place) == Some(place.len()) {
            away(&np, &place[0], talk)
        } else {
            Vec::new()
        };
        return match strip {
            Some(strip) if far && away.is_empty() => to(&[&led(strip, &place[0], &[]), place].concat()),
            _ => to(&[place, &away].concat()),
        };
    }
    // "motorcycle much closer, 10 metres"
    let degree = leads(rest, DEGREE).unwrap_or(0);
    if let Some(n) = leads(&rest[degree..], NEARER) {
        let tail = trimmed(&rest[degree + n..]);
        let tail = &tail[leads(tail, &["at", "to", "say", "to about", ":"]).unwrap_or(0)..];
        let m = measure(tail)?;
        return match tail.get(m) {
            None => to(&[tail, &away(&np, &tail[0], talk)].concat()),
            Some(_) if leads(&tail[m..], &["away", "off"]) == Some(tail.len() - m) => {
                to(&[&tail[..m], &away(&np, &tail[0], talk)].concat())
            }
            Some(_) if is_place(&tail[m..]) || is(tail.get(m), &["ahead", "behind"]) => to(tail),
            Some(_) => None,
        };
    }
    // "truck at 18 m rather than at 30", "... on the right edge instead of the left"
    let not = (2..rest.len()).find_map(|k| leads(&rest[k..], NOT_THERE).map(|n| (k, k + n)));
    if let Some((k, from)) = not {
        let place = trimmed(&rest[..k]);
        let old = &rest[from..];
        let old = &old[usize::from(is(old.first(), &["at", "to", "on", "in"]))..];
        let far = number(old.first()?).is_some() && (old.len() == 1 || measure(old) == Some(old.len()));
        let side =
            leads(old, &["the left", "the right", "left", "right"]).is_some_and(|n| n + 1 >= old.len());
        let at = usize::from(is(place.first(), &["at", "to"]));
        let m = measure(&place[at..]);
        if !(far && m.is_some() || side && is_place(place))
            || has_noun(place)
            || place
                .iter()
                .any(|t| t.kind != TokenKind::Word && number(t).is_none())
        {
            return to(&several_parts(&np, rest, talk)?);
        }
        let Some(m) = m else { return to(place) };
        let after = &place[at + m..];
        let after = &after[usize::from(is(after.first(), &["and"]))..];
        let away = if after.is_empty() {
            away(&np, &place[0], talk)
        } else {
            Vec::new()
        };
        return to(&[&place[at..at + m], &away, after].concat());
    }
    // "cones on the left instead, along the left edge of the road": the last of them is meant
    let instead = (1..rest.len()).find(|k| is(rest.get(*k), &["instead"]) && !is(rest.get(k + 1), &["of"]));
    if let Some(k) = instead {
        let (place, late) = (trimmed(&rest[..k]), trimmed(&rest[k + 1..]));
        let place = if late.is_empty() { place } else { late };
        let plain = is_place(place) && !has_noun(rest) && !place.iter().any(|t| t.kind == TokenKind::Comma);
        return if plain && !is(rest.first(), &[":"]) {
            to(place)
        } else {
            None
        };
    }
    if let Some(place) = several_parts(&np, rest, talk) {
        return to(&place);
    }
    // "kids on the left sidewalk, all four"
    let comma = rest.iter().rposition(|t| t.kind == TokenKind::Comma)?;
    let last = &rest[comma + 1..];
    let all = leads(last, ALL_OF) == Some(last.len())
        || last.len() > 1
            && is(last.first(), &["all"])
            && number(&last[1]).is_some()
            && (last.len() == 2 || leads(&last[2..], &["of them"]) == Some(last.len() - 2));
    let place = &rest[..comma];
    (all && talk.fits(&np) > 1
        && is_place(place)
        && !has_noun(place)
        && !place.iter().any(|t| t.kind == TokenKind::Comma))
    .then_some(())?;
    to(place)
}

/// "behind us now, 20 m, left lane still", "in front of us rather than behind, 20 m away", "at 35 m, not 25": where it should be,
/// in parts, of which some may only tell where it is not.
fn several_parts(np: &[Token], rest: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    const SMALL: &[&str] = &[
        "now", "still", "then", "again", "please", "instead", "and", "but", "as", "before",
    ];
    // ("fire engine, 12 m behind us" is a new one)
    if is(rest.first(), &[","])
        || has_noun(rest)
        || talk.fits(np) != 1
        || rest.iter().any(|t| t.kind == TokenKind::Stop)
    {
        return None;
    }
    let (mut far, mut way, mut strip) = (Vec::new(), Vec::new(), Vec::new());
    let mut parts = 0;
    for part in rest.split(|t| t.kind == TokenKind::Comma || text(t) == ":") {
        // (where it is not)
        let not = (0..part.len()).find_map(|k| leads(&part[k..], NOT_THERE).map(|n| (k, k + n)));
        let told = match not {
            Some((k, from)) => {
                let old = &part[from..];
                let at = usize::from(is(old.first(), &["at", "to"]));
                let place = old.first().is_some_and(|t| number(t).is_some())
                    || measure(&old[at..]).is_some()
                    || is_place(old)
                    || is(old.first(), &["behind", "ahead", "in", "left", "right", "the"]);
                place.then_some(())?;
                &part[..k]
            }
            None => part,
        };
        parts += 1 + usize::from(not.is_some());
        let mut told: Vec<Token> = told.iter().filter(|t| !is(Some(t), SMALL)).cloned().collect();
        let at = usize::from(is(told.first(), &["at"]));
        if let Some(m) = measure(&told[at..]) {
            far.is_empty().then_some(())?;
            far = told[at..at + m].to_vec();
            told.drain(..at + m);
            if leads(&told, &["away", "off", "away from us", "from us", "distance"]) == Some(told.len()) {
                told.clear();
            }
        }
        if told.is_empty() {
            continue;
        }
        // ("left lane", "same lane")
        if leads(&told, SAME) == Some(told.len()) {
            strip = led(strip_of(np, talk)?, &told[0], &[]);
            continue;
        }
        let lane = |t: Option<&Token>| {
            is(
                t,
                &["lane", "sidewalk", "pavement", "edge", "roadside", "shoulder"],
            )
        };
        if lane(told.last())
            && is(
                told.first(),
                &["left", "right", "our", "my", "middle", "oncoming", "the"],
            )
        {
            strip = led(
                "in",
                &told[0].clone(),
                &[&led("the", &told[0].clone(), &[]), &told],
            );
            strip = strip
                .into_iter()
                .enumerate()
                .filter(|(i, t)| *i != 1 || !is(told.first(), &["our", "my", "the"]) || text(t) != "the")
                .map(|x| x.1)
                .collect();
            continue;
        }
        let plain = told.iter().all(|t| t.kind == TokenKind::Word) && is_place(&told);
        let goes = is(
            told.first(),
            &[
                "to", "by", "until", "over", "out", "off", "away", "back", "onto", "into",
            ],
        );
        (plain && !goes).then_some(())?;
        if lane(told.last()) && strip.is_empty() {
            strip = told;
        } else {
            way.is_empty().then_some(())?;
            way = told;
        }
    }
    // (one place alone is read well as it is)
    (parts > 1 && !(far.is_empty() && way.is_empty() && strip.is_empty())).then_some(())?;
    if way.is_empty() && !far.is_empty() {
        let mut side = away(np, &rest[0], talk);
        if !strip.is_empty() {
            side.truncate(
                side.iter()
                    .position(|t| is(Some(t), &["in"]))
                    .unwrap_or(side.len()),
            );
        }
        way = side;
    }
    Some([far, way, strip].concat())
}

/// "have a road roller there instead of the excavator": that is where.
fn there_instead(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, _| {
        let here = i > 1
            && is(tokens.get(i), &["there", "here"])
            && super::words::noun_at(&tokens[i - 1..i]).is_some();
        let instead = here
            && leads(
                &tokens[i + 1..],
                &["instead of", "rather than", "in place of", "in lieu of", "than"],
            )
            .is_some();
        instead.then_some(i + 1)
    })
}

/// "for my learners I would rather have ...": what for changes nothing.
fn for_whom(tokens: Vec<Token>) -> Vec<Token> {
    let n = leads(
        &tokens,
        &[
            "for my",
            "for our",
            "for the",
            "for this",
            "for these",
            "for a",
            "for",
        ],
    );
    let Some(n) = n.filter(|n| tokens.len() > n + 4) else {
        return tokens;
    };
    // (what the scene can hold, or a time of day, is more than that)
    let end = (n + 1..n + 4).find(|k| {
        tokens[*k].kind == TokenKind::Comma
            || leads(
                &tokens[*k..],
                &["i", "we", "id", "wed", "could", "can", "let us", "lets", "please"],
            )
            .is_some()
    });
    match end {
        Some(k)
            if tokens[n..k]
                .iter()
                .all(|t| t.kind == TokenKind::Word && look_up(text(t)).is_none()) =>
        {
            tokens[k + usize::from(tokens[k].kind == TokenKind::Comma)..].to_vec()
        }
        _ => tokens,
    }
}

const STEAD: &[&str] = &[
    "in its stead",
    "in their stead",
    "in its place",
    "in their place",
    "instead",
    "there",
    "there instead",
    "in its spot",
    "in his place",
    "in his stead",
    "in her place",
    "in her stead",
    "in the same place",
    "in the same spot",
];

/// "no motorcycle, but two bicycles in its stead": these for that.
fn no_but(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["no", "not the", "no more"]) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[n..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let (old, rest) = (&tokens[n..n + b], &tokens[n + b..]);
    let new = trimmed(rest);
    let linked = rest.len() > new.len();
    let Some((a, e)) = first_noun(new).filter(|x| x.0 < 4 && x.0 > 0) else {
        return tokens;
    };
    let counted = new[..a]
        .iter()
        .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another"]));
    let there = leads(&new[e..], STEAD).is_some_and(|m| m == new.len() - e)
        || rest.last().is_some_and(|t| text(t) == "instead") && e == new.len();
    if !(linked && counted && there && talk.fits(&led("the", &tokens[0], &[old])) > 0) {
        return tokens;
    }
    let many = matches!(look_up(text(&old[b - 1])), Some(Sense::Noun(_, true)));
    if many && is(new.first(), &["a", "an"]) {
        // (one for all of them)
        return led(
            "replace all the",
            &tokens[0],
            &[old, &led("with one", &new[0], &[&new[1..e]])],
        );
    }
    led(
        if many { "replace all the" } else { "replace the" },
        &tokens[0],
        &[old, &led("with", &new[0], &[&new[..e]])],
    )
}

const WISHES: &[&str] = &[
    "i need",
    "we need",
    "i want",
    "we want",
    "i would like",
    "id like",
    "we would like",
    "add",
    "put",
    "place",
    "there should be",
    "there must be",
    "there is",
    "there shall be",
    "please add",
    "please put",
    "i would like to have",
    "id like to have",
    "i want to have",
    "draw",
    "park",
    "there has to be",
    "there needs to be",
];

/// "opposite the truck, on the right edge, I need a parked car": where comes last.
fn fronted(tokens: Vec<Token>) -> Vec<Token> {
    if !is_place(&tokens) {
        return tokens;
    }
    let commas: Vec<usize> = (0..tokens.len())
        .filter(|i| tokens[*i].kind == TokenKind::Comma)
        .take(3)
        .collect();
    let [a, b] = commas[..] else { return tokens };
    let (one, two, rest) = (&tokens[..a], &tokens[a + 1..b], &tokens[b + 1..]);
    let Some(n) = leads(rest, WISHES) else {
        return tokens;
    };
    let fresh =
        is(rest.get(n), &["a", "an", "another", "some"]) || rest.get(n).is_some_and(|t| number(t).is_some());
    let whole = first_noun(&rest[n..]).is_some_and(|x| x.0 < 4 && n + x.1 == rest.len());
    // (one of them tells beside what, the other where)
    let place = is_place(two)
        && !(has_noun(one) && has_noun(two))
        && is(two.first(), &["on", "in", "at"]) != is(one.first(), &["on", "in", "at"]);
    if !(fresh && whole && place) {
        return tokens;
    }
    let (strip, beside) = if has_noun(one) { (two, one) } else { (one, two) };
    [rest, strip, beside].concat()
}

const WHATEVER: &[&str] = &[
    "whatever",
    "whoever",
    "everything that",
    "everything which",
    "everyone who",
    "everybody who",
    "anything that",
    "anyone who",
    "anybody who",
    "all that",
    "every vehicle that",
    "all vehicles that",
    "all people who",
    "everybody that",
    "everyone that",
];

/// "whatever is parked, remove it": remove whatever is parked.
fn picked_first(tokens: Vec<Token>) -> Vec<Token> {
    let Some(n) = leads(&tokens, WHATEVER) else {
        return tokens;
    };
    let Some(comma) = (n + 1..tokens.len().min(n + 12))
        .find(|k| tokens[*k].kind == TokenKind::Comma || text(&tokens[*k]) == ":")
    else {
        return tokens;
    };
    let rest = &tokens[comma + 1..];
    let rest = &rest[usize::from(is(rest.first(), &["please", "just"]))..];
    let removes =
        is(rest.first(), &["remove", "delete", "erase"]) || leads(rest, &["take", "clear"]).is_some();
    let ends = rest.len() == 2
        || leads(
            rest.get(2..).unwrap_or_default(),
            &["away", "out", "please", "from the scene"],
        )
        .is_some_and(|m| m + 2 == rest.len());
    if !(removes && is(rest.get(1), &["it", "them", "him", "that", "all"]) && ends) {
        return tokens;
    }
    led("remove", &tokens[0], &[&tokens[..comma]])
}

/// "two more vans, both in the left lane": they are to come.
fn more_of_them(tokens: Vec<Token>) -> Vec<Token> {
    let counted = tokens.first().is_some_and(|t| number(t).is_some()) && is(tokens.get(1), &["more"]);
    let noun = counted
        .then(|| first_noun(&tokens[2..]))
        .flatten()
        .filter(|x| x.0 < 3);
    let Some((_, b)) = noun else { return tokens };
    let rest = &tokens[2 + b..];
    let verb = rest.iter().any(|t| {
        super::lists::HELPERS.contains(&text(t))
            || is_finite(text(t), true)
            || is(Some(t), &["than", "please", "instead"])
    });
    let each = rest
        .iter()
        .position(|t| t.kind == TokenKind::Comma)
        .is_some_and(|k| is(rest.get(k + 1), &["both", "all", "one", "each", "two"]));
    if verb || !each {
        return tokens;
    }
    led("add", &tokens[0], &[&tokens])
}

/// "put one more child beside the two": beside the two children.
fn beside_them(mut tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(the) = tokens
        .len()
        .checked_sub(2)
        .filter(|k| is(tokens.get(*k), &["the"]) && *k > 2)
    else {
        return tokens;
    };
    let many = number(&tokens[the + 1]).filter(|n| *n > 1);
    let beside = ["beside", "to", "with", "near", "behind", "by"].contains(&text(&tokens[the - 1]));
    let noun = first_noun(&tokens[..the]).map(|(a, b)| tokens[a..b].to_vec());
    let (Some(n), Some(noun), true) = (many, noun, beside) else {
        return tokens;
    };
    let Some(Sense::Noun(known, _)) = noun.last().and_then(|t| look_up(text(t))) else {
        return tokens;
    };
    let same = talk
        .boxes
        .values()
        .filter(|b| known.classes.contains(&b.class))
        .count();
    if i64::try_from(same).is_ok_and(|s| s == n) {
        let name = super::super::lexicon::plural(
            &super::topics::singular_of(&noun)
                .iter()
                .map(text)
                .collect::<Vec<_>>()
                .join(" "),
        );
        let at = tokens[the + 1].clone();
        tokens.extend(led(&name, &at, &[]));
    }
    tokens
}

/// "on the same sidewalk as the man": on the one where he stands.
fn same_as(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &["on the same", "in the same", "at the same", "to the same"],
        )?;
        let strip = is(
            tokens.get(i + n),
            &[
                "sidewalk", "pavement", "edge", "roadside", "kerb", "curb", "lane", "shoulder",
            ],
        );
        let as_np = i
            + n
            + 1
            + leads(
                tokens.get(i + n + 1..)?,
                &["as", "as that of", "of the road as", "of the street as"],
            )?;
        let (_, b) = first_noun(&tokens[as_np..]).filter(|x| x.0 < 4)?;
        let np = &tokens[as_np..as_np + b];
        (strip && is(np.first(), &["the", "that", "both"])).then_some(())?;
        Some((i, as_np + b, strip_of(np, talk)?))
    });
    match found {
        Some((i, end, strip)) => [&tokens[..i], &led(strip, &tokens[i], &[]), &tokens[end..]].concat(),
        None => tokens,
    }
}

/// "the motorcyclist has given up following us": he is gone.
fn stopped_following(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const NO_MORE: &[&str] = &[
        "has given up following",
        "has stopped following",
        "gave up following",
        "stopped following",
        "has quit following",
        "no longer follows",
        "is no longer following",
        "does not follow",
        "doesnt follow",
        "is not following",
        "isnt following",
        "has stopped tailing",
        "no longer tails",
        "have stopped following",
        "no longer follow",
        "are no longer following",
        "has stopped chasing",
    ];
    let found = find(&tokens, NO_MORE).filter(|x| is(tokens.get(x.0 + x.1), &["us", "me"]));
    let Some((k, n)) = found else { return tokens };
    let rest = trimmed(&tokens[k + n + 1..]);
    let still =
        rest.is_empty() || leads(rest, &["any more", "anymore", "any longer", "at all"]) == Some(rest.len());
    if !still || first_noun(&tokens[..k]).is_none_or(|x| x.1 != k || x.0 > 3) || talk.fits(&tokens[..k]) == 0
    {
        return tokens;
    }
    led("remove", &tokens[0], &[&tokens[..k]])
}

/// "the pair on the sidewalk should become a trio", "the two people become four": so many in all.
fn grown(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const BECOME: &[&str] = &[
        "should become",
        "becomes",
        "become",
        "must become",
        "should grow to",
        "grows to",
        "grow to",
        "has become",
        "have become",
        "should grow into",
        "turns into",
        "turn into",
        "should be turned into",
        "has grown to",
        "have grown to",
    ];
    const GROUPS: [(&str, i64); 6] = [
        ("pair", 2),
        ("couple", 2),
        ("duo", 2),
        ("trio", 3),
        ("quartet", 4),
        ("foursome", 4),
    ];
    let Some((k, n)) =
        find(&tokens, BECOME).filter(|x| x.0 > 1 && is(tokens.first(), &["the", "those", "both", "these"]))
    else {
        return tokens;
    };
    let new = trimmed(&tokens[k + n..]);
    let new = &new[leads(new, &["a group of", "a", "a crowd of", "a queue of", "a row of"]).unwrap_or(0)..];
    let [last] = new else { return tokens };
    let many = number(last).or_else(|| GROUPS.iter().find(|g| g.0 == text(last)).map(|g| g.1));
    let np = &tokens[1..k];
    // ("the pair on the sidewalk" are people)
    let group = is(
        np.first(),
        &["pair", "couple", "duo", "trio", "quartet", "foursome", "group"],
    );
    let (who, place) = if group {
        let of = leads(&np[1..], &["of people", "of pedestrians"]).unwrap_or(0);
        (led("people", &tokens[0], &[]), &np[1 + of..])
    } else {
        match first_noun(np).filter(|x| x.0 < 3) {
            Some((a, b)) => (np[a..b].to_vec(), &np[b..]),
            None => return tokens,
        }
    };
    if !(place.is_empty() || is_place(place)) {
        return tokens;
    }
    let Some(many) = many.filter(|m| *m > 1 && talk.fits(&led("the", &tokens[0], &[&who, place])) > 0) else {
        return tokens;
    };
    let mut out = led("keep exactly", &tokens[0], &[new, &who, place]);
    out[2].kind = TokenKind::Number(many as f64);
    out[2].text = many.to_string();
    out
}

/// "in our lane there should be a bus ahead of us, not a car": said of what is there.
fn place_before(tokens: Vec<Token>) -> Vec<Token> {
    let lane = leads(
        &tokens,
        &[
            "in our lane",
            "in my lane",
            "on our side",
            "in the left lane",
            "in the right lane",
            "in the oncoming lane",
            "behind us",
            "ahead of us",
            "in front of us",
        ],
    );
    let Some(n) = lane else { return tokens };
    let rest = trimmed(&tokens[n..]);
    let there = leads(
        rest,
        &[
            "there should be",
            "there must be",
            "there has to be",
            "there ought to be",
            "there should have been",
            "i want",
            "i need",
            "we need",
        ],
    )
    .is_some();
    let not = (4..rest.len()).any(|k| {
        rest[k].kind == TokenKind::Comma
            && leads(&rest[k + 1..], &["not a", "not an", "and not a", "and not an"]).is_some()
    });
    let placed = first_noun(rest).is_some_and(|x| is_place(&rest[x.1..]));
    if !(there && not) {
        return tokens;
    }
    if placed {
        return rest.to_vec();
    }
    let Some((_, b)) = first_noun(rest) else {
        return tokens;
    };
    [&rest[..b], &tokens[..n], &rest[b..]].concat()
}

/// "at least twelve cars must be parked here": so many in all.
fn so_many_here(tokens: Vec<Token>) -> Vec<Token> {
    let n = leads(
        &tokens,
        &[
            "at least",
            "exactly",
            "no fewer than",
            "not fewer than",
            "a total of",
        ],
    )
    .unwrap_or(0);
    let Some(many) = tokens.get(n).filter(|t| number(t).is_some_and(|m| m > 1)) else {
        return tokens;
    };
    let np = &tokens[n + 1..];
    let Some((_, b)) = first_noun(np).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let rest = &np[b..];
    let Some(m) = leads(
        rest,
        &[
            "must be",
            "should be",
            "have to be",
            "need to be",
            "ought to be",
            "shall be",
            "are to be",
            "must stand",
            "should stand",
        ],
    ) else {
        return tokens;
    };
    let state = &rest[m..];
    let parked = leads(state, &["parked"]).unwrap_or(0);
    let here = leads(
        &state[parked..],
        &[
            "here",
            "there",
            "in here",
            "in the scene",
            "in the picture",
            "in total",
            "in all",
            "altogether",
        ],
    ) == Some(state.len() - parked);
    if is(np.first(), &["more", "other", "of"]) || !(here && state.len() > parked) {
        return tokens;
    }
    led(
        "there should be exactly",
        &tokens[0],
        &[std::slice::from_ref(many), &state[..parked], &np[..b]],
    )
}

/// "the bus takes up too much space, take a minivan instead": that for this.
fn other_kind(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(comma) =
        (3..tokens.len()).find(|k| matches!(tokens[*k].kind, TokenKind::Comma | TokenKind::Mark))
    else {
        return tokens;
    };
    let (lead, rest) = (&tokens[..comma], &tokens[comma + 1..]);
    let too = lead
        .iter()
        .any(|t| is(Some(t), &["too", "not", "doesnt", "isnt", "wrong"]));
    let Some((_, b)) =
        first_noun(lead).filter(|x| x.0 < 4 && too && is(lead.first(), &["the", "that", "this"]))
    else {
        return tokens;
    };
    let rest = &rest[leads(rest, &["so", "please", "better", "so please", "rather"]).unwrap_or(0)..];
    let Some(n) = leads(
        rest,
        &[
            "use",
            "take",
            "choose",
            "pick",
            "try",
            "have",
            "give me",
            "put",
            "lets have",
            "let us have",
            "lets use",
            "let us use",
            "show",
            "i want",
            "id like",
            "i would like",
        ],
    ) else {
        return tokens;
    };
    let new = &rest[n..];
    let Some((_, e)) = first_noun(new).filter(|x| x.0 < 4 && is(new.first(), &["a", "an"])) else {
        return tokens;
    };
    let instead = leads(&new[e..], STEAD) == Some(new.len() - e);
    let uses = e == new.len() && is(rest.first(), &["use", "take", "choose", "pick", "try"]);
    // ("the bus is not alone, take a car" is another matter)
    if !(instead || uses && lead.iter().any(|t| text(t) == "too")) || talk.fits(&lead[..b]) != 1 {
        return tokens;
    }
    led(
        "replace",
        &tokens[0],
        &[&lead[..b], &led("with", &new[0], &[&new[..e]])],
    )
}

const PARTS: &[&str] = &[
    "separate",
    "split",
    "split up",
    "divide",
    "distribute",
    "spread",
    "spread out",
    "send",
    "put",
    "place",
    "move",
    "part",
    "set",
    "share out",
    "break up",
];
const ON_EACH: &[&str] = &[
    "one on each sidewalk",
    "one on each side of the road",
    "one on each side of the street",
    "one on each side",
    "one on either side",
    "one on either sidewalk",
    "one each on both sidewalks",
    "one on each pavement",
    "one on either side of the road",
    "one on either side of the street",
    "one to each side of the road",
    "one to each sidewalk",
    "one at each edge of the road",
    "one on each edge of the road",
    "one at each kerb",
];

/// "separate the two pedestrians, one on each sidewalk", "split them up: two on the left sidewalk, one on the right".
fn parted(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(v) = leads(&tokens, PARTS) else {
        return tokens;
    };
    let np = &tokens[v..];
    if !is(np.first(), &["the", "both", "those"]) {
        return tokens;
    }
    let Some((a, b)) = first_noun(np).filter(|x| x.0 < 4) else {
        return tokens;
    };
    let noun = &np[a..b];
    let parts = usize::from(is(np.get(b), &["up", "out"]));
    let rest = trimmed(&np[b + parts..]);
    let rest = &rest[leads(
        rest,
        &[
            "to different sides",
            "to both sides",
            "onto both sides",
            "over both sides",
            "apart",
        ],
    )
    .unwrap_or(0)..];
    let rest = trimmed(rest);
    let many = talk.fits(&np[..b]);
    let bare = !is(tokens.first(), &["send", "put", "place", "move", "set"])
        || np[b..].iter().any(|t| t.kind != TokenKind::Word);
    if let Some(n) = leads(rest, ON_EACH).filter(|n| *n == rest.len() && many == 2) {
        let on_foot = talk
            .boxes_of(&np[..b])
            .iter()
            .all(|x| x.class == crate::scene::Class::Pedestrian);
        let edge = is(rest.get(n - 1), &["kerb"]) || rest[..n].iter().any(|t| text(t) == "edge") || !on_foot;
        let strip = if edge { "roadside" } else { "sidewalk" };
        return one_each((noun, strip), &tokens[0], talk);
    }
    // "two on the left sidewalk, one on the right"
    let sides: Vec<&[Token]> = rest
        .split(|t| t.kind == TokenKind::Comma || is(Some(t), &["and"]))
        .filter(|p| !p.is_empty())
        .collect();
    let [one, two] = sides[..] else { return tokens };
    let side = |p: &[Token]| -> Option<(i64, bool, Option<String>)> {
        let n = number(p.first()?)?;
        let on = leads(&p[1..], &["on the", "to the", "onto the", "at the"])?;
        let left = is(p.get(1 + on), &["left"]);
        (left || is(p.get(1 + on), &["right"])).then_some(())?;
        let strip = p
            .get(2 + on)
            .map(text)
            .filter(|s| *s != "one")
            .map(str::to_string);
        (p.len() <= 3 + on
            && strip
                .as_deref()
                .is_none_or(|s| matches!(s, "sidewalk" | "roadside" | "edge" | "pavement" | "kerb")))
        .then_some((n, left, strip))
    };
    let (Some(x), Some(y)) = (side(one), side(two)) else {
        return tokens;
    };
    let (Some(strip), true) = (
        x.2.clone().or(y.2.clone()),
        bare && x.1 != y.1 && usize::try_from(x.0 + y.0).is_ok_and(|s| s == many),
    ) else {
        return tokens;
    };
    let (left, right) = if x.1 { (x.0, y.0) } else { (y.0, x.0) };
    apart((noun, &strip), (left, right), &tokens[0], talk).unwrap_or(tokens)
}

/// Who stands on one side already stays: so many of those on the one side go to the other, if all are there.
fn apart(
    (noun, strip): (&[Token], &str),
    (left, right): (i64, i64),
    at: &Token,
    talk: &Talk<'_>,
) -> Option<Vec<Token>> {
    let on = |side: &str| led(&format!("on the {side} {strip}"), at, &[]);
    let there =
        |side: &str| i64::try_from(talk.boxes_of(&led("the", at, &[noun, &on(side)])).len()).unwrap_or(0);
    let (n, side) = match left + right {
        all if there("left") == all => (right, "right"),
        all if there("right") == all => (left, "left"),
        _ => return None,
    };
    let mut out = led(
        "move one of the",
        at,
        &[noun, &led(&format!("to the {side} {strip}"), at, &[])],
    );
    if n > 1 {
        out[1].kind = TokenKind::Number(n as f64);
        out[1].text = n.to_string();
    }
    Some(out)
}

/// One of two on each side.
fn one_each((noun, strip): (&[Token], &str), at: &Token, talk: &Talk<'_>) -> Vec<Token> {
    apart((noun, strip), (1, 1), at, talk).unwrap_or_else(|| {
        let one = led(
            "put one of the",
            at,
            &[noun, &led(&format!("on the left {strip}"), at, &[])],
        );
        [
            one,
            led(&format!("and the other one on the right {strip}"), at, &[]),
        ]
        .concat()
    })
}
