//! Clauses that state what shall become of something, turned into commands: "the bus has left", "both taxis are to be
//! replaced by vans", "a tram instead of the truck", "reduce the pedestrians by one", "there is one car too many".

use super::lexicon::{Sense, look_up};
use super::rephrase::Change;
use super::tokens::{Token, TokenKind};
use super::words::edits::{VERBS, Verb};
use super::words::verbs::forms;
use std::collections::HashMap;
use std::sync::LazyLock;

/// Past participles of the commands: "removed", "taken away".
static PARTICIPLES: LazyLock<HashMap<String, Verb>> = LazyLock::new(|| {
    let mut map = HashMap::new();
    for (verb, list) in VERBS {
        for word in list.split('|') {
            map.entry(forms(word).participle).or_insert(*verb);
        }
    }
    for (word, verb) in [
        ("taken away", Verb::Remove),
        ("taken out", Verb::Remove),
        ("taken off", Verb::Remove),
        ("thrown out", Verb::Remove),
        ("gotten rid of", Verb::Remove),
        ("got rid of", Verb::Remove),
        ("cut out", Verb::Remove),
        ("put", Verb::Move),
        ("set", Verb::Move),
        ("placed", Verb::Move),
        ("positioned", Verb::Move),
        ("brought", Verb::Move),
        ("sent", Verb::Move),
        ("driven", Verb::Move),
        ("spun", Verb::Turn),
        ("swung", Verb::Move),
        ("slid", Verb::Move),
    ] {
        map.insert(word.to_string(), verb);
    }
    map
});

const HELPERS: &[&str] = &[
    "has",
    "have",
    "had",
    "is",
    "are",
    "was",
    "were",
    "be",
    "been",
    "being",
    "to",
    "should",
    "must",
    "shall",
    "ought",
    "needs",
    "need",
    "can",
    "could",
    "may",
    "will",
    "would",
    "might",
    "gets",
    "get",
    "got",
    "now",
    "just",
    "already",
    "also",
    "please",
    "then",
    "simply",
    "better",
    "supposed",
    "meant",
    "both",
    "all",
    "completely",
    "finally",
    "rather",
    "instead",
    "suddenly",
    "meanwhile",
    "currently",
    "so",
];
const NEGATED: &[&str] = &[
    "shouldnt", "mustnt", "isnt", "arent", "wasnt", "werent", "doesnt", "dont", "cant", "cannot", "wont",
    "neednt", "hasnt", "havent", "not", "never",
];
const GONE: &[&str] = &[
    "no longer",
    "not there",
    "gone",
    "missing",
    "away",
    "leave",
    "leaves",
    "left",
    "leaving",
    "depart",
    "departs",
    "departed",
    "departing",
    "disappear",
    "disappears",
    "disappeared",
    "vanish",
    "vanishes",
    "vanished",
    "drive off",
    "drives off",
    "drove off",
    "driven off",
    "drive away",
    "drives away",
    "drove away",
    "driven away",
    "pull away",
    "pulls away",
    "pulled away",
    "pull off",
    "pulls off",
    "pulled off",
    "walk away",
    "walks away",
    "walked away",
    "walk off",
    "walks off",
    "walked off",
    "go away",
    "goes away",
    "went away",
    "go home",
    "goes home",
    "went home",
    "gone home",
    "go",
    "move on",
    "moves on",
    "moved on",
    "move away",
    "moved away",
    "rides off",
    "rode off",
    "ride off",
    "ridden off",
    "rolled away",
    "rolls away",
    "towed away",
    "towed",
    "unnecessary",
    "superfluous",
    "redundant",
    "unwanted",
    "obsolete",
    "surplus",
    "out of the scene",
    "out of the picture",
    "off the road",
    "off the street",
    "out of here",
    "history",
    "cleared away",
    "cleared",
    "taken",
    "exit",
    "exits",
    "exited",
    "clear off",
    "clears off",
    "withdrawn",
    "retired",
    "scrapped",
    "dismissed",
    "absent",
    "out of the way",
    "carted off",
    "carted away",
    "hauled away",
    "hauled off",
];
const BECOMES: &[&str] = &[
    "become",
    "becomes",
    "became",
    "turn into",
    "turns into",
    "turned into",
    "change into",
    "changes into",
    "changed into",
    "changed to",
    "change to",
    "changes to",
    "transformed into",
    "transforms into",
    "morphs into",
    "morphed into",
    "converted into",
    "converted to",
    "swapped for",
    "swapped with",
    "swapped out for",
    "swapped by",
    "swapped against",
    "exchanged for",
    "exchanged with",
    "exchanged by",
    "exchanged against",
    "replaced by",
    "replaced with",
    "replaced for",
    "substituted by",
    "substituted with",
    "substituted for",
    "traded for",
    "switched for",
    "switched to",
    "switched with",
    "made into",
    "transfigured into",
    "upgraded to",
    "downgraded to",
    "succeeded by",
];
const INSTEAD: &[&[&str]] = &[
    &["instead", "of"],
    &["in", "place", "of"],
    &["in", "the", "place", "of"],
    &["in", "lieu", "of"],
    &["rather", "than"],
    &["in", "exchange", "for"],
    &["as", "a", "replacement", "for"],
    &["as", "a", "substitute", "for"],
    &["as", "replacement", "for"],
    &["to", "replace"],
    &["replacing"],
];
const WISHES: &[&[&str]] = &[
    &["i", "would", "like", "to", "see"],
    &["id", "like", "to", "see"],
    &["i", "want", "to", "see"],
    &["i", "would", "like", "to", "have"],
    &["id", "like", "to", "have"],
    &["i", "want", "to", "have"],
    &["i", "would", "like"],
    &["id", "like"],
    &["i", "want"],
    &["i", "need"],
    &["we", "need"],
    &["we", "want"],
    &["i", "would", "prefer"],
    &["id", "prefer"],
    &["i", "prefer"],
    &["id", "rather", "have"],
    &["id", "rather", "see"],
    &["i", "would", "rather", "have"],
    &["put"],
    &["place"],
    &["add"],
    &["insert"],
    &["show"],
    &["give", "me"],
    &["have"],
    &["use"],
    &["show", "me"],
    &["there", "should", "be"],
    &["there", "must", "be"],
    &["there", "shall", "be"],
    &["let", "there", "be"],
    &["there", "is"],
    &["there", "are"],
    &["make", "it"],
    &["make", "that"],
    &["we", "should", "have"],
    &["we", "should", "see"],
    &["drop"],
    &["set"],
    &["stick"],
];

fn text(t: &Token) -> &str {
    t.text.as_str()
}

fn is_noun(t: &Token) -> bool {
    matches!(look_up(text(t)), Some(Sense::Noun(..)))
}

/// The first noun, which may be of several words: its first token, and one past its last.
fn noun_in(tokens: &[Token]) -> Option<(usize, usize)> {
    (0..tokens.len()).find_map(|i| {
        (1..=4.min(tokens.len() - i)).rev().find_map(|n| {
            let run = tokens[i..i + n].iter().map(text).collect::<Vec<_>>().join(" ");
            let plain = tokens[i..i + n].iter().all(|t| t.kind == TokenKind::Word);
            (plain && matches!(look_up(&run), Some(Sense::Noun(..)))).then_some((i, i + n))
        })
    })
}

fn has_noun(tokens: &[Token]) -> bool {
    noun_in(tokens).is_some()
}

fn number(t: &Token) -> Option<i64> {
    match (&t.kind, look_up(text(t))) {
        (TokenKind::Number(v), _) if v.is_finite() && (0.0..1000.0).contains(v) => Some(v.round() as i64),
        (_, Some(Sense::Count(c))) if c.is_exact() => Some(i64::from(c.n)),
        _ => None,
    }
}

fn begins_with(tokens: &[Token], words: &[&str]) -> bool {
    tokens.len() >= words.len() && tokens.iter().zip(words).all(|(t, w)| text(t) == *w)
}

/// True if the tokens begin with the words of a phrase; how many those are.
fn leads(tokens: &[Token], phrases: &[&str]) -> Option<usize> {
    phrases
        .iter()
        .filter(|p| {
            let words: Vec<&str> = p.split(' ').collect();
            begins_with(tokens, &words)
        })
        .map(|p| p.split(' ').count())
        .max()
}

fn command(verb: &str, at: &Token, parts: &[&[Token]]) -> Vec<Token> {
    let mut out: Vec<Token> = verb
        .split(' ')
        .map(|w| Token {
            kind: TokenKind::Word,
            text: w.to_string(),
            span: at.span,
        })
        .collect();
    parts.iter().for_each(|p| out.extend_from_slice(p));
    out
}

fn by(at: &Token) -> Token {
    command("with", at, &[]).remove(0)
}

fn unwished(tokens: &[Token]) -> &[Token] {
    let skip = WISHES
        .iter()
        .filter(|w| begins_with(tokens, w))
        .map(|w| w.len())
        .max();
    &tokens[skip.unwrap_or(0).min(tokens.len())..]
}

/// Cuts small words and commas off both ends.
fn trimmed(mut tokens: &[Token]) -> &[Token] {
    let small = |t: &Token| {
        t.kind == TokenKind::Comma
            || matches!(
                text(t),
                "and" | "then" | "but" | "please" | "instead" | "now" | "so" | "there" | "also"
            )
    };
    while let Some((first, rest)) = tokens.split_first()
        && small(first)
        && text(first) != "there"
    {
        tokens = rest;
    }
    while let Some((last, rest)) = tokens.split_last()
        && small(last)
    {
        tokens = rest;
    }
    tokens
}

/// The end of the noun phrase that begins a clause, if it is a definite one: one past its noun.
fn subject(tokens: &[Token]) -> Option<usize> {
    let first = tokens.first()?;
    // "bicycle change to scooter"
    let bare = noun_in(tokens).filter(|n| n.0 == 0 && leads(&tokens[n.1..], BECOMES).is_some());
    if let Some((_, end)) = bare {
        return Some(end);
    }
    let definite = matches!(
        text(first),
        "it" | "they"
            | "he"
            | "she"
            | "the"
            | "both"
            | "all"
            | "my"
            | "that"
            | "this"
            | "these"
            | "those"
            | "every"
            | "each"
            | "any"
            | "everyone"
            | "everybody"
            | "everything"
            | "our"
    ) || number(first).is_some() && tokens.get(1).is_some_and(|t| text(t) == "of");
    if !definite {
        return None;
    }
    if matches!(
        text(first),
        "everyone" | "everybody" | "everything" | "it" | "they" | "he" | "she"
    ) {
        return Some(1);
    }
    let (noun, mut end) = noun_in(tokens).filter(|n| n.0 < 8)?;
    let blocked = tokens[..noun].iter().any(|t| {
        HELPERS.contains(&text(t)) && !matches!(text(t), "both" | "all") || t.kind == TokenKind::Comma
    });
    if blocked {
        return None;
    }
    // "delivery van", "police car"
    while tokens.get(end).is_some_and(is_noun) {
        end += 1;
    }
    Some(end)
}

/// A definite noun phrase and what has become of it, or shall.
fn stated(clause: &[Token]) -> Option<Vec<Token>> {
    let first = clause.first()?;
    let noun_end = subject(clause)?;
    // What is said of the noun may stand between: "the car on the left has gone".
    // "two of the three parked cars": any two
    let some = clause.get(1).is_some_and(|t| text(t) == "of") && number(first).is_some();
    let skip = clause
        .iter()
        .skip(2)
        .position(|t| !matches!(text(t), "the" | "my" | "those" | "these" | "our") && number(t).is_none())
        .unwrap_or(0);
    let few: Vec<Token> = if some {
        command("any", first, &[&clause[..1], &clause[2 + skip..]])
    } else {
        Vec::new()
    };
    for from in noun_end..clause.len().min(noun_end + 8) {
        // "any" comes before, "of the three" is left out
        let np = if some {
            few.get(..from.saturating_sub(skip)).unwrap_or(&[])
        } else {
            &clause[..from]
        };
        let mut k = from;
        let mut helped = false;
        let mut not = false;
        while let Some(t) = clause.get(k)
            && (HELPERS.contains(&text(t)) || NEGATED.contains(&text(t)))
        {
            helped |= HELPERS.contains(&text(t));
            if clause.get(k + 1).is_some_and(|t| text(t) == "going")
                && clause.get(k + 2).is_some_and(|t| text(t) == "to")
            {
                k += 1;
            }
            not |= NEGATED.contains(&text(t));
            k += 1;
        }
        let tail = &clause[k..];
        if not && tail.first().is_some_and(is_place_word) {
            return Some(command("make", first, &[np])); // where it should not be does not say where to
        }
        if not {
            let there = tail.is_empty()
                || leads(
                    tail,
                    &[
                        "there",
                        "here",
                        "in the scene",
                        "belong",
                        "needed",
                        "necessary",
                        "wanted",
                        "required",
                        "exist",
                        "around",
                        "stay",
                        "remain",
                        "anymore",
                        "any more",
                        "present",
                        "appear",
                    ],
                )
                .is_some();
            return there.then(|| command("remove", first, &[np]));
        }
        if leads(tail, GONE).is_some()
            && (helped
                || !matches!(
                    tail.first().map(text),
                    Some("left" | "go" | "away" | "taken" | "cleared")
                ))
        {
            let turned = matches!(tail.get(1).map(text), Some("lane" | "side" | "hand")); // "should be left of me"
            if let Some(more) = likewise(tail) {
                return Some(command("remove", first, &[np, &command("and", first, &[]), more]));
            }
            let goes_to = text(&tail[0]) == "go"
                && tail.len() > 1
                && !matches!(text(&tail[1]), "away" | "home" | "please" | "now")
                || tail.get(1).is_some_and(|t| matches!(text(t), "of" | "to")) && text(&tail[0]) == "left";
            if !turned && !goes_to {
                return Some(command("remove", first, &[np]));
            }
        }
        if let Some(n) = leads(tail, BECOMES)
            && has_noun(&tail[n..])
        {
            return Some(command("replace", first, &[np, &[by(first)], &tail[n..]]));
        }
        if helped {
            let words: Vec<String> = (1..=3)
                .rev()
                .filter(|n| tail.len() >= *n)
                .map(|n| tail[..n].iter().map(text).collect::<Vec<_>>().join(" "))
                .collect();
            let found = words
                .iter()
                .find_map(|w| PARTICIPLES.get(w).map(|v| (*v, w.split(' ').count())));
            if let Some((verb, n)) = found {
                let verb = match verb {
                    Verb::Remove | Verb::Clear => "remove",
                    Verb::Move | Verb::Add => "move",
                    Verb::Turn => "turn",
                    Verb::Replace => "replace",
                    Verb::Paint => "paint",
                    Verb::Keep | Verb::Make | Verb::Swap | Verb::Note => return None,
                };
                if let (Some(more), "remove") = (likewise(tail), verb) {
                    return Some(command("remove", first, &[np, &command("and", first, &[]), more]));
                }
                if verb == "move" && tail.len() == n {
                    return None;
                }
                return Some(command(verb, first, &[np, &tail[n..]]));
            }
        }
        // "the car behind should keep 30 m distance"
        let keeps = tail
            .first()
            .is_some_and(|t| matches!(text(t), "keep" | "keeps" | "stay" | "stays" | "hold" | "leave"));
        if keeps
            && tail.len() > 2
            && number(&tail[1]).is_some()
            && matches!(look_up(text(&tail[2])), Some(Sense::Unit(_)))
        {
            let back = np.iter().any(|t| matches!(text(t), "back" | "behind" | "rear"));
            return Some(command(
                "move",
                first,
                &[
                    np,
                    &tail[1..3],
                    &command(if back { "behind us" } else { "in front of us" }, first, &[]),
                ],
            ));
        }
        let turned = [
            "opposite direction",
            "other direction",
            "other way",
            "opposite way",
            "reverse direction",
        ];
        let said: String = tail.iter().map(text).collect::<Vec<_>>().join(" ");
        let goes = tail.first().is_some_and(|t| {
            matches!(
                text(t),
                "drive"
                    | "drives"
                    | "go"
                    | "goes"
                    | "head"
                    | "heads"
                    | "face"
                    | "faces"
                    | "travel"
                    | "travels"
                    | "travelling"
                    | "traveling"
                    | "moving"
                    | "moves"
                    | "move"
                    | "rolling"
                    | "riding"
                    | "rides"
                    | "drove"
                    | "went"
                    | "came"
                    | "headed"
                    | "travelled"
                    | "come"
                    | "comes"
                    | "driving"
                    | "going"
                    | "heading"
                    | "facing"
                    | "point"
                    | "points"
                    | "look"
                    | "looks"
            )
        });
        let ours = [
            "our way",
            "my way",
            "same way",
            "same direction",
            "our direction",
            "my direction",
        ];
        if goes && ours.iter().any(|w| said.contains(w)) {
            return Some(command(
                "rotate",
                first,
                &[np, &command("going my way", first, &[])],
            ));
        }
        if goes && turned.iter().any(|w| said.contains(w)) {
            return Some(command("rotate", first, &[np, &command("around", first, &[])]));
        }
        if goes
            && [
                "towards me",
                "toward me",
                "towards us",
                "toward us",
                "at me",
                "at us",
            ]
            .iter()
            .any(|w| said.ends_with(w))
        {
            return Some(command(
                "rotate",
                first,
                &[np, &command("to face me", first, &[])],
            ));
        }
        // "the car pull over and park on the right": where it ends up
        let acts = (1..=3.min(tail.len())).rev().any(|n| {
            let run = tail[..n].iter().map(text).collect::<Vec<_>>().join(" ");
            matches!(look_up(&run), Some(Sense::State(..)))
        });
        if acts
            && !tail.is_empty()
            && tail.iter().any(|t| {
                matches!(
                    text(t),
                    "park"
                        | "parks"
                        | "stop"
                        | "stops"
                        | "wait"
                        | "waits"
                        | "stand"
                        | "stands"
                        | "over"
                        | "sit"
                        | "sits"
                )
            })
            && let Some(p) = (1..tail.len()).find(|i| {
                (1..=3.min(tail.len() - i)).any(|n| {
                    let run = tail[*i..i + n].iter().map(text).collect::<Vec<_>>().join(" ");
                    matches!(
                        look_up(&run),
                        Some(Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At)
                    ) && text(&tail[*i]) != "over"
                })
            })
        {
            return Some(command("move", first, &[np, &tail[p..]]));
        }
        if helped
            || !clause
                .get(from)
                .is_some_and(|t| is_place_word(t) || from > noun_end)
        {
            return None;
        }
    }
    None
}

/// "..., and likewise the barriers"
fn likewise(tail: &[Token]) -> Option<&[Token]> {
    let k = tail.iter().position(|t| matches!(text(t), "and" | "as"))?;
    let mut rest = &tail[k + 1..];
    while rest.first().is_some_and(|t| {
        matches!(
            text(t),
            "likewise"
                | "also"
                | "so"
                | "do"
                | "does"
                | "is"
                | "are"
                | "too"
                | "with"
                | "should"
                | "must"
                | "as"
                | "well"
                | "equally"
                | "similarly"
        )
    }) {
        rest = &rest[1..];
    }
    let definite = rest.first().is_some_and(|t| {
        matches!(
            text(t),
            "the" | "both" | "all" | "every" | "that" | "those" | "these"
        )
    });
    let plain = rest
        .iter()
        .all(|t| !HELPERS.contains(&text(t)) || matches!(text(t), "both" | "all"));
    (definite && plain && has_noun(rest)).then_some(rest)
}

fn is_place_word(t: &Token) -> bool {
    matches!(
        look_up(text(t)),
        Some(
            Sense::Rel(_)
                | Sense::EgoRel(_)
                | Sense::In
                | Sense::At
                | Sense::Across
                | Sense::Article(_)
                | Sense::Place(..)
                | Sense::State(..)
        )
    ) || matches!(text(t), "on" | "to" | "left" | "right")
}

/// One thing for another: "a tram instead of the truck", "where the truck is, put a digger".
fn exchanged(clause: &[Token]) -> Option<Vec<Token>> {
    let first = clause.first()?;
    let replace = |old: &[Token], new: &[Token]| {
        let (old, new) = (trimmed(old), trimmed(unwished(trimmed(new))));
        let both = has_noun(old) && has_noun(new);
        let fresh = new
            .first()
            .is_some_and(|t| matches!(text(t), "a" | "an" | "another") || number(t).is_some() || is_noun(t));
        (both && fresh).then(|| command("replace", first, &[old, &[by(first)], new]))
    };
    if matches!(text(first), "substitute" | "swap")
        && clause
            .get(1)
            .is_some_and(|t| matches!(text(t), "a" | "an" | "in") || number(t).is_some())
    {
        let k = clause.iter().position(|t| text(t) == "for")?;
        let new = if text(&clause[1]) == "in" {
            &clause[2..k.max(2)]
        } else {
            &clause[1..k]
        };
        return replace(&clause[k + 1..], new);
    }
    if text(first) == "where" {
        let is = clause.iter().position(|t| {
            matches!(
                text(t),
                "is" | "are" | "was" | "were" | "stands" | "stood" | "stand" | "sits" | "used" | "waits"
            )
        })?;
        let mut rest = &clause[is + 1..];
        while rest.first().is_some_and(|t| {
            !matches!(
                text(t),
                "a" | "an" | "i" | "id" | "we" | "put" | "place" | "there" | "add" | "show"
            ) && number(t).is_none()
        }) {
            rest = &rest[1..];
        }
        return replace(&clause[1..is], rest);
    }
    if let Some(k) = clause.iter().position(|t| text(t) == "where").filter(|k| *k > 1) {
        let is = clause[k..].iter().position(|t| {
            matches!(
                text(t),
                "is" | "are" | "was" | "were" | "stands" | "stood" | "stand" | "sits" | "used" | "now"
            )
        })? + k;
        return replace(&clause[k + 1..is], &clause[..k]);
    }
    let (k, n) = (0..clause.len()).find_map(|k| {
        INSTEAD
            .iter()
            .find(|w| begins_with(&clause[k..], w))
            .map(|w| (k, w.len()))
    })?;
    let old = &clause[k + n..];
    if k == 0 {
        // "instead of the truck(,) I'd like a bus"
        let noun = old.iter().position(is_noun)?;
        let cut = (noun + 1..old.len()).find(|i| {
            old[*i].kind == TokenKind::Comma
                || WISHES.iter().any(|w| begins_with(&old[*i..], w))
                || matches!(text(&old[*i]), "a" | "an")
                || number(&old[*i]).is_some()
        })?;
        return replace(&old[..cut], &old[cut..]);
    }
    let definite = old.first().is_some_and(|t| {
        matches!(
            text(t),
            "the" | "that" | "this" | "my" | "both" | "all" | "every" | "one" | "those" | "these"
        )
    });
    let new = trimmed(unwished(trimmed(&clause[..k])));
    let moves = new
        .first()
        .is_some_and(|t| matches!(text(t), "the" | "move" | "both" | "all"));
    if !definite || moves {
        return None;
    }
    replace(old, new)
}

/// Numbers: "reduce the cars by one", "cut the cones down to two", "there is one car too many", "remove all but one of them".
fn counted(clause: &[Token]) -> Option<(Vec<Token>, Option<Change>)> {
    let first = clause.first()?;
    let plain = |tokens: &[Token]| -> Vec<Token> {
        let skip = [
            "the", "number", "of", "count", "amount", "total", "quantity", "how", "many", "there", "are",
            "up", "down",
        ];
        let from = tokens.iter().position(|t| !skip.contains(&text(t))).unwrap_or(0);
        let end = tokens
            .iter()
            .rposition(|t| !matches!(text(t), "up" | "down" | "back" | "from" | "in" | "number"))
            .map_or(tokens.len(), |e| e + 1);
        tokens.get(from..end).unwrap_or(&[]).to_vec()
    };
    let less = matches!(
        text(first),
        "reduce"
            | "lower"
            | "decrease"
            | "cut"
            | "diminish"
            | "drop"
            | "shrink"
            | "bring"
            | "take"
            | "trim"
            | "thin"
            | "scale"
            | "lessen"
            | "get"
            | "pare"
            | "whittle"
            | "narrow"
            | "limit"
            | "restrict"
            | "cap"
    );
    let more = matches!(
        text(first),
        "increase"
            | "raise"
            | "bump"
            | "grow"
            | "boost"
            | "up"
            | "bring"
            | "get"
            | "take"
            | "augment"
            | "expand"
            | "extend"
            | "push"
            | "set"
            | "make"
            | "change"
            | "adjust"
            | "turn"
    );
    if less || more {
        let last = clause.len().checked_sub(1)?;
        let tail = (1..clause.len())
            .rev()
            .take(5)
            .find(|k| matches!(text(&clause[*k]), "by" | "to"));
        if let Some(k) = tail {
            let n = clause[k + 1..].iter().find_map(number);
            let noun_before = has_noun(&clause[1..k]);
            let noun_after = has_noun(&clause[k + 1..])
                || clause[k + 1..]
                    .iter()
                    .any(|t| matches!(look_up(text(t)), Some(Sense::Unit(_) | Sense::Place(..))));
            let small =
                |t: &Token| matches!(text(t), "just" | "only" | "exactly" | "a" | "single" | "merely");
            let at_once = clause[k + 1..]
                .iter()
                .find(|t| !small(t))
                .is_some_and(|t| number(t).is_some())
                && text(&clause[k - 1]) != "next";
            let fits = at_once && k < last && noun_before && !noun_after && clause[k + 1..].len() <= 4;
            if let (Some(n), true) = (n, fits) {
                let np = plain(&clause[1..k]);
                if text(&clause[k]) == "by"
                    && !matches!(
                        text(first),
                        "bring" | "get" | "take" | "set" | "make" | "change" | "turn" | "push" | "adjust"
                    )
                {
                    let n = if more { n } else { -n };
                    return Some((command("keep the", first, &[&np]), Some(Change::Plus(n))));
                }
                let moves = clause[k + 1..]
                    .iter()
                    .any(|t| matches!(text(t), "degrees" | "left" | "right"));
                if text(&clause[k]) == "to" && !moves {
                    let number = clause[k + 1..].iter().find(|t| number(t).is_some()).cloned()?;
                    return Some((command("keep exactly", first, &[&[number], &np]), None));
                }
            }
        }
    }
    // "there is one car too many", "two cars too few"
    if let Some(k) = clause
        .windows(2)
        .position(|w| text(&w[0]) == "too" && matches!(text(&w[1]), "many" | "few" | "much"))
    {
        let n = clause[..k]
            .iter()
            .find_map(|t| number(t).or(matches!(text(t), "a" | "an").then_some(1)))?;
        let noun = clause[..k].iter().position(is_noun)?;
        let from = clause[..noun]
            .iter()
            .rposition(|t| number(t).is_some() || matches!(text(t), "a" | "an"))
            .map_or(0, |f| f + 1);
        let n = if text(&clause[k + 1]) == "few" { n } else { -n };
        return Some((
            command("keep the", first, &[&clause[from..k]]),
            Some(Change::Plus(n)),
        ));
    }
    // "all but one of the parked cars", "all the cars but one", "all except two cones"
    let removing = super::words::edits::VERBS.iter().any(|(v, l)| {
        matches!(v, Verb::Remove | Verb::Clear)
            && l.split('|').any(|w| w.split(' ').next() == Some(text(first)))
    });
    if removing && let Some(all) = clause.iter().position(|t| matches!(text(t), "all" | "every")) {
        let but = (all + 1..clause.len())
            .find(|k| matches!(text(&clause[*k]), "but" | "except" | "save" | "bar"))?;
        let n_at = (but + 1..clause.len().min(but + 4)).find(|k| number(&clause[*k]).is_some())?;
        let before: Vec<Token> = clause[all + 1..but]
            .iter()
            .filter(|t| !matches!(text(t), "the" | "of" | "my"))
            .cloned()
            .collect();
        let after: Vec<Token> = clause[n_at + 1..]
            .iter()
            .filter(|t| !matches!(text(t), "of" | "the" | "them" | "my"))
            .cloned()
            .collect();
        let np = if has_noun(&before) { before } else { after };
        if has_noun(&np) {
            return Some((
                command("keep exactly", first, &[&[clause[n_at].clone()], &np]),
                None,
            ));
        }
    }
    None
}

/// What there should be, or should not: "there ought to be four cones", "the street shouldn't have any taxis".
fn there(clause: &[Token]) -> Option<Vec<Token>> {
    let first = clause.first()?;
    let mut k = 0;
    let mut not = false;
    let mut should = false;
    let mut owns = false;
    // Words before a noun: "the scene should not show any more ..."
    while let Some(t) = clause.get(k) {
        match text(t) {
            w if NEGATED.contains(&w) => not = true,
            "should" | "must" | "shall" | "ought" | "needs" | "need" | "has" | "supposed" | "want" => {
                should = true
            }
            "contain" | "have" | "show" | "include" | "hold" | "feature" | "contains" | "shows" | "holds" => {
                owns = true
            }
            "there" | "to" | "be" | "is" | "are" | "i" | "we" | "you" | "the" | "this" | "it" | "scene"
            | "picture" | "image" | "street" | "road" | "view" | "id" | "like" | "would" | "rather"
            | "see" | "now" | "please" | "any" | "longer" | "more" | "a" | "total" | "of" | "in" | "all"
            | "altogether" | "lets" | "let" => {}
            _ => break,
        }
        k += 1;
    }
    let rest = &clause[k..];
    let existential = clause[..k].iter().any(|t| text(t) == "there");
    if !has_noun(rest) {
        return None;
    }
    let no = rest.first().is_some_and(|t| matches!(text(t), "no" | "zero"));
    if (not && (existential || owns) && !no) || (existential && no) {
        let rest = if no { &rest[1..] } else { rest };
        let rest = if rest
            .first()
            .is_some_and(|t| matches!(text(t), "more" | "longer" | "any"))
        {
            &rest[1..]
        } else {
            rest
        };
        return Some(command("remove", first, &[trimmed(rest)]));
    }
    // The article belongs to what is wished for.
    let total = clause[..k].iter().any(|t| text(t) == "total");
    if (existential && should || total) && number(&rest[0]).is_some() {
        let more = rest
            .get(1)
            .is_some_and(|t| matches!(text(t), "more" | "additional" | "extra" | "further"));
        return Some(command(if more { "add" } else { "keep exactly" }, first, &[rest]));
    }
    None
}

/// "get the bus out of here"
fn sent_off(clause: &[Token]) -> Option<Vec<Token>> {
    let first = clause.first()?;
    if !matches!(
        text(first),
        "get"
            | "take"
            | "clear"
            | "chase"
            | "throw"
            | "kick"
            | "drive"
            | "haul"
            | "send"
            | "tow"
            | "move"
            | "bring"
            | "cart"
            | "pull"
    ) {
        return None;
    }
    let noun = noun_in(clause)?.1 - 1;
    let tails: &[&[&str]] = &[
        &["out", "of", "here"],
        &["out", "of", "the", "scene"],
        &["out", "of", "the", "picture"],
        &["out", "of", "my", "way"],
        &["out", "of", "the", "way"],
        &["out", "of", "our", "way"],
        &["off", "the", "road"],
        &["off", "the", "street"],
        &["off", "the", "map"],
        &["out", "of", "my", "sight"],
        &["out", "of", "sight"],
        &["out", "of", "view"],
        &["away", "from", "here"],
        &["from", "the", "scene"],
        &["out", "of", "the", "view"],
        &["off", "the", "scene"],
        &["out", "of", "the", "image"],
        &["off"],
        &["away"],
        &["out"],
        &["home"],
        &["off", "the", "carriageway"],
        &["off", "the", "tarmac"],
    ];
    let end = trimmed(clause).len();
    let k = (noun + 1..end).find(|k| {
        tails
            .iter()
            .any(|t| begins_with(&clause[*k..], t) && k + t.len() == end)
    })?;
    Some(command("remove", first, &[&clause[1..k]]))
}

/// A clause as a command, and how a number changes by it; `None` if it is one already or none of these.
pub fn restate(clause: &[Token]) -> Option<(Vec<Token>, Option<Change>)> {
    if let Some(found) = counted(clause) {
        return Some(found);
    }
    if let Some(first) = clause.first()
        && (matches!(text(first), "nobody" | "noone") || begins_with(clause, &["no", "one"]))
    {
        // "nobody should be on the crossing"
        let from = if text(first) == "no" { 2 } else { 1 };
        let rest: Vec<Token> = clause[from..]
            .iter()
            .filter(|t| !HELPERS.contains(&text(t)))
            .cloned()
            .collect();
        return Some((command("remove all people", first, &[&rest]), None));
    }
    exchanged(clause)
        .or_else(|| sent_off(clause))
        .or_else(|| there(clause))
        .or_else(|| stated(clause))
        .map(|tokens| (tokens, None))
}

/// Where a new statement begins inside a sentence: "the van leaves, and both cyclists are replaced by mopeds".
pub fn clauses(sentence: &[Token]) -> Vec<&[Token]> {
    let mut out = Vec::new();
    let mut from = 0;
    let mut i = 1;
    while i < sentence.len() {
        let link = sentence[i].kind == TokenKind::Comma
            || sentence[i].kind == TokenKind::Mark
            || matches!(text(&sentence[i]), "and" | "but" | "while" | "then" | "whereas");
        if link && i > from {
            let mut next = i + 1;
            while sentence.get(next).is_some_and(|t| {
                t.kind == TokenKind::Comma
                    || matches!(
                        text(t),
                        "and" | "then" | "but" | "also" | "while" | "finally" | "so"
                    )
            }) {
                next += 1;
            }
            // A statement shows itself at once; so a long sentence costs no more than many short ones.
            let rest = &sentence[next.min(sentence.len())..(next + 40).min(sentence.len())];
            let states = stated(rest).is_some()
                || there(rest).is_some() && rest.first().is_some_and(|t| text(t) == "there");
            let spoken = sentence[from..i].iter().any(is_noun)
                && !begins_with(&sentence[from..], &["instead"])
                && text(&sentence[from]) != "where";
            if states && spoken {
                out.push(&sentence[from..i]);
                from = next;
                i = next;
            }
        }
        i += 1;
    }
    out.push(&sentence[from..]);
    out
}
