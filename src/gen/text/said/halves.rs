//! Sentences of which one half only prepares the other: "the motorcycle is overtaking us: show it beside us", "empty the road;
//! only the bus may stay", "one will do; three are too many", "nobody is behind us yet: add a car", "fill it up, I need ten cars".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::words::{first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

/// A text whose halves are one.
pub fn joined(tokens: Vec<Token>) -> Vec<Token> {
    let tokens = nothing_there(using(uncaptioned(tokens)));
    let mut parts: Vec<Vec<Token>> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let mut rest = sentence;
        // (a comma or a colon parts halves, too)
        let cut = (2..rest.len()).find(|k| {
            (matches!(rest[*k].kind, TokenKind::Comma | TokenKind::Mark))
                && rest.get(k + 1).is_some_and(|t| t.kind == TokenKind::Word)
        });
        if let Some(k) = cut.filter(|k| prepares(&rest[..*k])) {
            parts.push(rest[..=k].to_vec());
            rest = &rest[k + 1..];
        }
        parts.push(rest.to_vec());
    }
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut last: &[Token] = &[];
    let mut i = 0;
    while i < parts.len() {
        let (first, second) = (body(&parts[i]), parts.get(i + 1).map(|p| body(p)));
        if let Some(new) = second.and_then(|s| one_of(first, s)) {
            let stop = &parts[i + 1][body(&parts[i + 1]).len()..];
            out.extend(new);
            out.extend_from_slice(stop);
            last = body(&parts[i + 1]);
            i += 2;
            continue;
        }
        if !(has_noun(last) && (too_many(first) || has_left(last, first))) {
            out.extend_from_slice(&parts[i]);
        }
        last = first;
        i += 1;
    }
    out
}

/// "officer's correction: the lorry stood there": whose words they are says nothing of the scene.
fn uncaptioned(tokens: Vec<Token>) -> Vec<Token> {
    const SAID: [&str; 22] = [
        "correction",
        "remark",
        "comment",
        "request",
        "wish",
        "statement",
        "version",
        "note",
        "amendment",
        "suggestion",
        "demand",
        "feedback",
        "idea",
        "order",
        "task",
        "instruction",
        "proposal",
        "opinion",
        "finding",
        "addition",
        "question",
        "update",
    ];
    let Some(colon) = (2..tokens.len().min(6)).find(|k| text(&tokens[*k]) == ":") else {
        return tokens;
    };
    let words = &tokens[..colon];
    let whose = words
        .iter()
        .any(|t| text(t).ends_with("'s") || text(t).ends_with("s'"))
        || is(words.first(), &["my", "our", "one", "another"]);
    if is(words.last(), &SAID)
        && (whose || has_noun(words))
        && words
            .iter()
            .all(|t| t.kind == TokenKind::Word && number(t).is_none_or(|n| n == 1))
    {
        return tokens[colon + 1..].to_vec();
    }
    tokens
}

/// "have started to use the crossing": they should be on it.
fn using(tokens: Vec<Token>) -> Vec<Token> {
    const USE: &str = "have started to use|has started to use|have begun to use|has begun to use|are using|is using|are now using|is now using|start to use|starts to use|begin to use|begins to use|should use|should be using|are making use of|\
        is making use of|make use of|now use|now uses";
    super::super::wording::rewritten(&tokens, |i, out| {
        let n = super::super::wording::begins(&tokens[i..], USE)?;
        let at = i + n + usize::from(is(tokens.get(i + n), &["the", "this", "that"]));
        is(
            tokens.get(at),
            &["crossing", "zebra", "crosswalk", "sidewalk", "pavement"],
        )
        .then(|| {
            out.extend(led("should be on", &tokens[i], &[]));
            i + n
        })
    })
}

/// "I want to see nothing in front of us, everything behind may stay": nothing in front of us.
fn nothing_there(tokens: Vec<Token>) -> Vec<Token> {
    const WANT: &str = "i want to see|we want to see|i want to have|we want to have|i would like to see|id like to see|i wish to see|i would like to have|id like to have|i want|we want|there should be|there must be";
    let Some(n) = super::super::wording::begins(&tokens, WANT)
        .filter(|n| is(tokens.get(*n), &["nothing", "nobody", "noone"]))
    else {
        return tokens;
    };
    let rest = &tokens[n + 1..];
    let us = leads(
        rest,
        &[
            "in front of us",
            "behind us",
            "ahead of us",
            "in front of me",
            "behind me",
            "ahead of me",
            "ahead",
            "in front",
            "behind",
        ],
    );
    let Some(m) = us else { return tokens };
    let late = trimmed(&rest[m..]);
    let stays = is(late.first(), &["everything", "all", "whatever", "the", "what"])
        && (1..late.len()).any(|k| {
            leads(
                &late[k..],
                &[
                    "may stay",
                    "can stay",
                    "should stay",
                    "stays",
                    "may remain",
                    "can remain",
                    "remains",
                    "is fine",
                    "is ok",
                    "may stay as it is",
                    "stays as it is",
                ],
            )
            .is_some_and(|x| k + x == late.len() || late[k + x].kind == TokenKind::Stop)
        });
    if !(late.is_empty() || stays) {
        return tokens;
    }
    led("remove everything", &tokens[0], &[&rest[..m]])
}

fn body(part: &[Token]) -> &[Token] {
    match part.split_last() {
        Some((t, rest)) if matches!(t.kind, TokenKind::Stop | TokenKind::Comma | TokenKind::Mark) => rest,
        _ => part,
    }
}

fn prepares(first: &[Token]) -> bool {
    cleared(first) || under_way(first).is_some() || missing(first).is_some() || topped_up(first)
}

fn one_of(first: &[Token], second: &[Token]) -> Option<Vec<Token>> {
    only_stays(first, second)
        .or_else(|| shown(first, second))
        .or_else(|| added(first, second))
        .or_else(|| filled(first, second))
        .or_else(|| complained(first, second))
}

/// "the truck is too long; take a van instead": one sentence.
fn complained(first: &[Token], second: &[Token]) -> Option<Vec<Token>> {
    let too = first.iter().any(|t| text(t) == "too")
        && first_noun(first).is_some_and(|x| x.0 < 3)
        && is(first.first(), &["the", "that", "this"]);
    let second = trimmed(second);
    let n = leads(second, &["use", "take", "choose", "pick", "try"]).filter(|_| too && first.len() < 12)?;
    is(second.get(n), &["a", "an"]).then_some(())?;
    // (as they were, with a comma for the stop)
    let comma = Token {
        kind: TokenKind::Comma,
        ..super::words::word(",", &second[0])
    };
    let instead = if is(second.last(), &["instead"]) {
        Vec::new()
    } else {
        led("instead", &second[0], &[])
    };
    Some([first, &[comma], second, &instead].concat())
}

/// "three are too many", said beside how many there shall be.
fn too_many(words: &[Token]) -> bool {
    let Some(n) = words.first().and_then(number) else {
        return false;
    };
    let be = leads(
        &words[1..],
        &["is", "are", "was", "were", "would be", "seems", "seem"],
    )
    .unwrap_or(0);
    let by = usize::from(words.get(1 + be).and_then(number).is_some());
    let ends = |phrases: &[&str]| leads(&words[1 + be + by..], phrases) == Some(words.len() - 1 - be - by);
    n > 0
        && be > 0
        && ends(&[
            "too many",
            "too few",
            "too much",
            "not enough",
            "far too many",
            "way too many",
            "a bit much",
            "more than enough",
            "more than i need",
            "more than we need",
        ])
}

/// "the bus itself goes", where something else has taken its place.
fn has_left(before: &[Token], words: &[Token]) -> bool {
    let taken = before.iter().any(|t| is(Some(t), &["where", "place", "stead"]));
    let itself = words
        .iter()
        .position(|t| is(Some(t), &["itself", "themselves", "himself", "herself"]));
    let itself = itself.or_else(|| is(words.first(), &["it", "they", "he", "she", "those"]).then_some(0));
    let goes = itself.is_some_and(|k| {
        let rest = &words[k + 1..];
        k < 5
            && leads(
                rest,
                &[
                    "goes",
                    "go",
                    "leaves",
                    "leave",
                    "is gone",
                    "are gone",
                    "disappears",
                    "disappear",
                    "drives off",
                    "drives away",
                    "moves off",
                    "has left",
                    "have left",
                    "should go",
                    "is removed",
                    "vanishes",
                    "is out",
                ],
            ) == Some(rest.len())
    });
    taken && goes
}

/// "empty the road", and nothing else.
fn cleared(words: &[Token]) -> bool {
    let words = &words[leads(words, &["please", "now", "just"]).unwrap_or(0)..];
    let n = leads(
        words,
        &[
            "clear the road",
            "empty the road",
            "clear the scene",
            "empty the scene",
            "clear everything",
            "remove everything",
            "delete everything",
            "clear the car park",
            "empty the car park",
            "clear the parking lot",
            "empty the parking lot",
            "remove everybody",
            "remove everyone",
            "empty it",
            "clear it",
            "empty the lot",
            "clear the lot",
            "empty the junction",
            "clear the junction",
            "empty the intersection",
            "clear the intersection",
            "empty the whole road",
            "empty the whole scene",
            "clear the whole scene",
            "empty everything",
            "erase everything",
        ],
    );
    n.is_some_and(|n| {
        trimmed(&words[n..]).is_empty()
            || leads(
                &words[n..],
                &["completely", "entirely", "of everything", "away", "out"],
            ) == Some(words.len() - n)
    })
}

/// "empty the road; only the bus may stay": everything else goes.
fn only_stays(first: &[Token], second: &[Token]) -> Option<Vec<Token>> {
    let second = trimmed(second);
    let only = leads(second, &["only", "just", "nothing but", "none but"]).filter(|_| cleared(first))?;
    let np = &second[only..];
    is(np.first(), &["the", "both", "all", "my", "that", "a", "one"]).then_some(())?;
    let may = (1..np.len()).find_map(|k| {
        let helper = leads(
            &np[k..],
            &[
                "may",
                "should",
                "can",
                "must",
                "shall",
                "is to",
                "are to",
                "is allowed to",
                "will",
                "has to",
                "ought to",
            ],
        )
        .unwrap_or(0);
        let stays = leads(
            &np[k + helper..],
            &[
                "remain", "remains", "stay", "stays", "be left", "be there", "is left", "are left",
                "be kept", "survive", "survives", "left",
            ],
        )?;
        Some((k, k + helper + stays))
    });
    let (end, rest) = may.unwrap_or((np.len(), np.len()));
    let late = trimmed(&np[rest..]);
    let who = &np[..end];
    let named = has_noun(who) && who.iter().all(|t| t.kind == TokenKind::Word);
    let late = if late.is_empty()
        || leads(
            late,
            &[
                "here",
                "there",
                "in the scene",
                "on the road",
                "behind",
                "in it",
                "on it",
            ],
        ) == Some(late.len())
    {
        &[]
    } else {
        is_place(late).then_some(late).filter(|l| !has_noun(l))?
    };
    named.then(|| led("remove everything except", &first[0], &[who, late]))
}

const SHOW: &[&str] = &[
    "show",
    "depict",
    "draw",
    "picture",
    "place",
    "put",
    "set",
    "display",
    "position",
    "please show",
    "please put",
    "so show",
    "so put",
    "so place",
];
const MOVES: &[&str] = &[
    "overtaking",
    "passing",
    "crossing",
    "falling",
    "dropping",
    "turning",
    "braking",
    "catching",
    "coming",
    "changing",
    "merging",
    "pulling",
    "leaving",
    "moving",
    "approaching",
    "reversing",
    "slowing",
    "going",
    "walking",
    "driving",
    "riding",
    "overtaken",
    "passed",
    "crossed",
    "started",
    "begun",
    "moved",
    "turned",
    "caught",
    "changed",
    "pulled",
    "dropped",
    "fallen",
    "reversed",
    "walked",
    "gone",
    "driven",
    "run",
    "reached",
    "stopped",
    "arrived",
];

/// Who is doing something, in a clause that says no more: one past his name.
fn under_way(words: &[Token]) -> Option<usize> {
    let (_, b) =
        first_noun(words).filter(|x| x.0 < 4 && is(words.first(), &["the", "both", "that", "my", "our"]))?;
    let be = leads(
        &words[b..],
        &[
            "is",
            "are",
            "has",
            "have",
            "is now",
            "are now",
            "has just",
            "has now",
            "has already",
            "is just",
            "is already",
            "have just",
            "have now",
            "has been",
            "is about to be",
            "have already",
        ],
    )?;
    (words.len() < b + be + 9 && is(words.get(b + be), MOVES)).then_some(b)
}

/// "the motorcycle is overtaking us: show it right beside us": it should be there.
fn shown(first: &[Token], second: &[Token]) -> Option<Vec<Token>> {
    let b = under_way(first)?;
    let second = trimmed(second);
    let n = leads(second, SHOW)?;
    let pronoun = is(second.get(n), &["it", "him", "her", "them"]);
    let place = second.get(n + 1..)?;
    // (two places of which one is the ego vehicle's side)
    (pronoun && is_place(place) && !place.iter().any(|t| is(Some(t), &["instead", "away"])))
        .then(|| [&first[..b], &led("should be", &second[0], &[place])].concat())
}

const NONE: &[&str] = &[
    "there is",
    "theres",
    "there are",
    "we have",
    "i see",
    "we see",
    "so far there is",
    "so far there are",
    "i can see",
    "still",
    "there is still",
    "there are still",
    "so far",
];
const NOBODY: &[&str] = &[
    "nobody",
    "no one",
    "noone",
    "nothing",
    "no traffic",
    "no vehicles",
    "no vehicle",
    "no cars",
    "no car",
    "no people",
    "no pedestrians",
    "no person",
    "no pedestrian",
    "no oncoming traffic",
    "no oncoming vehicles",
    "no oncoming vehicle",
    "no oncoming cars",
    "no oncoming car",
    "no other traffic",
];

/// Where nobody is as yet; empty if only that nobody comes towards us.
fn missing(words: &[Token]) -> Option<(&[Token], bool)> {
    let n = leads(words, NONE).unwrap_or(0);
    let m = n + leads(&words[n..], NOBODY)?;
    let oncoming = words[n..m].iter().any(|t| text(t) == "oncoming");
    let rest = &words[m..];
    let rest = &rest[leads(
        rest,
        &[
            "is",
            "are",
            "is driving",
            "is standing",
            "is walking",
            "stands",
            "drives",
            "standing",
            "driving",
            "parked",
        ],
    )
    .unwrap_or(0)..];
    let yet = |t: &Token| is(Some(t), &["yet", "so", "far"]);
    let place = match rest.iter().position(yet) {
        Some(k) => {
            let after = &rest[k..];
            if k == 0 {
                trimmed(&after[after.iter().take_while(|t| yet(t)).count()..])
            } else {
                trimmed(&rest[..k])
            }
        }
        // (without "yet" it may be an order)
        None if leads(words, &["so far"]).is_some() || words.iter().any(|t| text(t) == "still") => rest,
        None => return None,
    };
    ((oncoming && place.is_empty() || is_place(place)) && !has_noun(place)).then_some((place, oncoming))
}

/// "there is nobody on the right sidewalk yet: add two children": there.
fn added(first: &[Token], second: &[Token]) -> Option<Vec<Token>> {
    let (place, oncoming) = missing(first)?;
    let second = trimmed(second);
    let n = leads(
        second,
        &[
            "add",
            "put",
            "place",
            "draw",
            "i need",
            "we need",
            "i want",
            "i would like",
            "id like",
            "let us have",
            "please add",
            "please put",
            "lets have",
            "insert",
        ],
    )?;
    let new = &second[n..];
    (is(new.first(), &["a", "an", "another", "one", "some"]) || number(new.first()?).is_some())
        .then_some(())?;
    let (a, b) = first_noun(new).filter(|x| x.0 < 5)?;
    let tail = &new[b..];
    let tail = &tail[usize::from(is(tail.first(), &["there", "here"]))..];
    // a place of its own is where it is: "put one behind us"
    let own = is(tail.first(), &["on", "in", "at", "behind", "beside", "to"]);
    let side = if own { &[][..] } else { place };
    // (what comes towards us is ahead)
    let tail: Vec<Token> = super::super::wording::rewritten(tail, |i, out| {
        let far = oncoming && is(tail.get(i), &["away", "off"]);
        far.then(|| {
            out.extend(led("ahead", &tail[i], &[]));
            i + 1
        })
    });
    let article = &new[..a];
    let ahead = if oncoming {
        led("oncoming", &new[a], &[])
    } else {
        Vec::new()
    };
    let article = match article {
        [t] if oncoming && text(t) == "a" => led("an", t, &[]),
        _ => article.to_vec(),
    };
    Some(
        [
            &led("add", &second[0], &[&article, &ahead, &new[a..b]]),
            side,
            &tail,
        ]
        .concat(),
    )
}

/// "fill it up a bit", "top the cones up".
fn topped_up(words: &[Token]) -> bool {
    is(words.first(), &["fill", "top", "stock", "pack"])
        && words.iter().take(7).any(|t| text(t) == "up")
        && !words
            .iter()
            .any(|t| is(Some(t), &["with", "to", "until"]) || number(t).is_some_and(|n| n > 1))
        && words.len() < 10
}

/// "fill it up a bit, I need ten parked cars": so many in all.
fn filled(first: &[Token], second: &[Token]) -> Option<Vec<Token>> {
    let second = trimmed(second);
    let n = leads(
        second,
        &[
            "i need",
            "we need",
            "i want",
            "we want",
            "i would like",
            "id like",
            "there should be",
            "there must be",
            "make it",
            "it should be",
            "i would like to have",
            "we would like",
        ],
    )
    .filter(|_| topped_up(first))?;
    let n = n + leads(&second[n..], &["to have", "exactly", "at least"]).unwrap_or(0);
    let many = second.get(n).filter(|t| number(t).is_some_and(|m| m > 1))?;
    let of = &second[n + 1..];
    let more = of
        .iter()
        .any(|t| is(Some(t), &["more", "extra", "additional", "new"]));
    let np = if of.is_empty()
        || leads(of, &["of them", "in all", "in total", "altogether", "there"]) == Some(of.len())
    {
        let (a, b) = first_noun(first)?;
        matches!(look_up(text(&first[b - 1])), Some(Sense::Noun(_, true))).then_some(&first[a..b])?
    } else {
        first_noun(of).filter(|x| x.0 < 3)?;
        of
    };
    (!more).then(|| led("keep exactly", &second[0], &[std::slice::from_ref(many), np]))
}
