//! Where one sentence of an edit is two: "turn the bus around, and remove the pedestrians". Many turns of speech are known by how a
//! sentence begins or ends, so two plain clauses that neither share words nor point at each other are read one after the other.

use super::super::lexicon::{Sense, look_up};
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::lists::{HELPERS, NEGATED};
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, noun_at, number, text};

/// Words that point at what the other clause says, or share it: such a sentence is read as a whole.
const SHARED: &[&str] = &[
    "it",
    "its",
    "itself",
    "he",
    "him",
    "his",
    "she",
    "her",
    "they",
    "them",
    "their",
    "theirs",
    "hers",
    "there",
    "one",
    "ones",
    "once",
    "other",
    "others",
    "another",
    "rest",
    "else",
    "same",
    "too",
    "instead",
    "so",
    "likewise",
    "both",
    "each",
    "either",
    "respectively",
    "former",
    "latter",
    "whose",
    "whom",
    "where",
    "if",
    "unless",
    "until",
    "because",
    "since",
    "like",
    "first",
    "second",
    "third",
    "last",
    "such",
    "only",
    "everything",
    "everyone",
    "everybody",
    "nothing",
    "nobody",
    "however",
    "again",
    "vice",
    "between",
    "remaining",
    "equally",
    "alike",
    "copy",
    "copies",
    "duplicate",
];

/// What a sentence may begin with before its first clause.
const POLITE: &[&str] = &[
    "only", "please", "kindly", "now", "then", "ok", "okay", "and", "just", "also", "next", "finally",
];

/// Verbs of commands that nothing but a command begins with when an object follows.
pub(super) const ORDERS: &[&str] = &[
    "add",
    "remove",
    "delete",
    "erase",
    "put",
    "place",
    "move",
    "shift",
    "turn",
    "rotate",
    "make",
    "replace",
    "swap",
    "take",
    "get",
    "clear",
    "drop",
    "bring",
    "send",
    "double",
    "halve",
    "insert",
    "exchange",
    "change",
    "set",
    "let",
    "have",
    "give",
    "push",
    "pull",
    "slide",
    "park",
    "paint",
    "reduce",
    "increase",
    "include",
    "spawn",
    "station",
    "position",
    "relocate",
    "lose",
    "kill",
    "wipe",
    "throw",
    "kick",
    "convert",
    "discard",
    "eliminate",
    "keep",
    "leave",
    "stick",
    "drive",
    "steer",
    "lead",
    "show",
    "build",
    "create",
    "switch",
];

/// How a wish begins.
const WANTS: &[&str] = &[
    "i want",
    "i need",
    "we need",
    "we want",
    "i would like",
    "id like",
    "id rather",
    "id prefer",
    "i would rather",
    "i would prefer",
    "there is",
    "there are",
    "there should be",
    "there must be",
    "give me",
    "gimme",
    "no",
    "id be happier",
    "id be happy",
    "id be glad",
    "id be fine",
    "id be better off",
    "i would be happier",
    "i would be happy",
    "i would be glad",
    "i would be fine",
    "wed be happier",
    "wed be happy",
    "wed be fine",
    "we would be happy",
    "we would be fine",
    "im missing",
    "i am missing",
    "i miss",
    "i do not need",
    "i dont need",
    "we do not need",
    "we dont need",
    "i do not want",
    "i dont want",
    "we no longer need",
    "i no longer need",
    "i can do without",
    "i could do without",
    "my class must see",
    "i would have expected",
    "we could use",
    "i could use",
    "i wish for",
    "i prefer",
    "wed like",
    "we would like",
];

/// Commands as nouns.
const NOMINAL: &[&str] = &[
    "removal of",
    "deletion of",
    "addition of",
    "insertion of",
    "relocation of",
    "replacement of",
    "transformation of",
    "conversion of",
    "rotation of",
    "lane change of",
    "lane change for",
    "increase of",
    "an increase of",
    "a decrease of",
    "decrease of",
    "reduction of",
    "a reduction of",
    "exchange of",
    "repositioning of",
    "a move of",
    "placement of",
];

fn is_link(t: &Token) -> bool {
    t.kind == TokenKind::Comma
        || is(
            Some(t),
            &["and", "then", "also", "please", "additionally", "plus"],
        )
}

/// The tokens with a full stop wherever a sentence falls apart into clauses that each stand alone.
pub fn apart(mut tokens: Vec<Token>) -> Vec<Token> {
    let mut from = 0;
    while from < tokens.len() {
        let end = (from..tokens.len())
            .find(|i| tokens[*i].kind == TokenKind::Stop)
            .unwrap_or(tokens.len());
        match boundary(&tokens[from..end]) {
            Some((a, b)) => {
                let stop = Token {
                    kind: TokenKind::Stop,
                    text: ".".into(),
                    span: tokens[from + a].span,
                };
                tokens.splice(from + a..from + b, [stop]);
                from += a + 1;
            }
            None => from = end + 1,
        }
    }
    without_complaint(tokens)
}

/// "Turn the bus round. It's facing the wrong way." is one turn.
fn without_complaint(tokens: Vec<Token>) -> Vec<Token> {
    let mut turned = false;
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let complains = leads(sentence, HE_IS).is_some()
            && sentence.len() < 10
            && !has_noun(sentence)
            && find(sentence, &["wrong way", "wrong direction"]).is_some();
        if !(turned && complains) {
            out.extend_from_slice(sentence);
        }
        turned = is(sentence.first(), TURNS) && orders_something(sentence);
    }
    out
}

const TURNS: &[&str] = &["turn", "rotate", "spin", "flip", "swing"];

/// The first link in a sentence with a clause of its own on both sides: its first token and one past its last.
fn boundary(sentence: &[Token]) -> Option<(usize, usize)> {
    let odd = |t: &Token| matches!(t.kind, TokenKind::Mark | TokenKind::Symbol);
    let odd = sentence.iter().any(odd);
    if sentence.len() > 60 {
        return None;
    }
    (1..sentence.len()).find_map(|a| {
        // "turn the motorcycle round: it's coming the wrong way": what for
        let reason = text(&sentence[a]) == ":"
            && is(sentence.first(), TURNS)
            && leads(&sentence[a + 1..], HE_IS).is_some();
        if reason && orders_something(&sentence[..a]) && !has_noun(&sentence[a + 1..]) {
            return Some((a, a + 1));
        }
        if !is_link(&sentence[a]) || is_link(&sentence[a - 1]) {
            return None;
        }
        let b = (a..sentence.len()).find(|k| !is_link(&sentence[*k]))?;
        let (left, right) = (&sentence[..a], &sentence[b..]);
        // ("only one of the children is left, and the bus is gone")
        let only = 2 * usize::from(is(left.first(), &["only"]) && left.len() > 3 && is(left.get(2), &["of"]));
        // ("two on the zebra are too few, let's have five": of what was named)
        let few = find(left, &["too few", "too many", "not enough"]).is_some() && !has_noun(right);
        let plain = !odd && !few && !left[only..].iter().any(holds) && !right.iter().any(shares);
        let told_apart = stands_alone(left) && opens(right) && !(points(left) || points(right));
        // "and then", "and also", "and please": nothing but a clause follows
        let joins = |words: &[&str]| sentence[a..b].iter().any(|t| is(Some(t), words));
        let strong = b - a > 1 && (joins(&["then", "also", "plus"]) || joins(&["please"]) && joins(&["and"]))
            || is(sentence.get(a), &["then"]);
        let there = find(
            right,
            &[
                "in that lane",
                "at that spot",
                "in that spot",
                "on that side",
                "in that place",
                "at that place",
            ],
        )
        .is_some();
        let follows = strong
            && !there
            && !few
            && a > 1
            && (opens(right) || acts(right))
            && !right.iter().any(|t| is(Some(t), LOOSE));
        // "the bus shrinks to a car, and I'd be happier with rain": so begins nothing but a clause
        let and = sentence[a..b].iter().any(|t| is(Some(t), &["and", "then"]));
        let wish = leads(right, WANTS).is_some() && !is(right.first(), &["no"]);
        let order =
            is(right.first(), ORDERS) && right.get(1).is_some_and(is_determiner) && orders_something(right);
        let begun = and
            && plain
            && a > 1
            && (wish || order)
            && !is(left.first(), LEANING)
            && !(points(left) || points(right));
        // "the truck at 20 m, and at night"; "night, rain, and two people there": the sky is a matter of its own
        let (dark, rest) = (sky(left), sky(right));
        let all_sky = super::parting::only_sky(left) && super::parting::only_sky(right);
        let mood = !odd
            && dark != rest
            && !all_sky
            && (rest && sentence[a].kind == TokenKind::Comma || dark && !is(left.first(), LEANING))
            && !(points(left) || points(right));
        (a > 1 && plain && told_apart || follows || begun || mood).then_some((a, b))
    })
}

const HE_IS: &[&str] = &[
    "its",
    "it is",
    "he is",
    "hes",
    "she is",
    "shes",
    "theyre",
    "they are",
    "it should",
    "he should",
    "it must",
];

/// "night", "at night", "in the rain": so short that nothing else is said.
fn sky(part: &[Token]) -> bool {
    const SMALL: &[&str] = &["at", "in", "the", "by", "a", "with", "it", "is", "make"];
    part.len() < 4
        && super::parting::only_sky(part)
        && part.iter().all(|t| {
            is(Some(t), SMALL) || matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)))
        })
}

/// A clause that begins so leans on the next.
const LEANING: &[&str] = &[
    "when", "if", "once", "after", "before", "while", "without", "instead", "rather", "in", "on", "at",
    "for", "as", "since", "because", "although", "though", "with", "to", "between",
];

/// Of the words that join clauses those that do so from the first: "put it where the truck is" is complete.
fn holds(t: &Token) -> bool {
    const FREE: &[&str] = &[
        "it", "its", "them", "him", "her", "he", "she", "they", "his", "their", "where", "instead", "same",
        "too", "again", "first", "second", "third", "last", "such", "other", "another", "like", "there",
    ];
    shares(t) && !is(Some(t), FREE)
}

/// Words that need the clause before in one sentence, whatever joins them.
const LOOSE: &[&str] = &[
    "respectively",
    "vice",
    "former",
    "latter",
    "likewise",
    "alike",
    "either",
    "each",
];

/// True if something is done here: somewhere a verb, or a command as a noun.
fn acts(clause: &[Token]) -> bool {
    let verb = |t: &Token| {
        let w = text(t);
        HELPERS.contains(&w) || NEGATED.contains(&w) || is_finite(w, false) && !w.ends_with("ed")
    };
    let noun = has_noun(clause)
        || clause
            .iter()
            .any(|t| is(Some(t), &["it", "them", "him", "her", "he", "she", "they"]));
    leads(clause, NOMINAL).is_some()
        || metres_for(clause)
        || clause.iter().any(|t| text(t) == ">") && has_noun(clause)
        || is(clause.first(), &["not"]) && has_noun(clause)
        || super::parting::only_sky(clause)
        || clause.len() > 2
            && noun
            && (clause.iter().any(verb)
                || clause.first().is_some_and(|t| {
                    is_verb(t)
                        && clause
                            .get(1)
                            .is_some_and(|n| is_determiner(n) || is(Some(n), &["it", "them", "him", "her"]))
                }))
        || is(clause.last(), &["gone", "out", "away"])
            && first_noun(clause).is_some_and(|n| n.0 < 3 && n.1 + 1 == clause.len())
}

fn shares(t: &Token) -> bool {
    is(Some(t), SHARED)
}

/// "remove that and ...", "in its place", "which is gone": words that stand for what the other clause names.
fn points(clause: &[Token]) -> bool {
    // ("the car that waits", "the woman who walks" only say which)
    let which = |k: usize| {
        k > 1
            && super::words::noun_at(&clause[k - 1..k]).is_some()
            && !is(clause.get(k + 1), &["should", "must"])
    };
    let says_which = clause.first().is_some_and(is_verb);
    (0..clause.len()).any(|k| {
        is(clause.get(k), &["that", "who", "which"]) && !(says_which && which(k))
            || is(clause.get(k), &["place"])
                && !is(clause.get(k + 1), &["a", "an", "the", "two", "three", "of"])
            || is(clause.get(k), &["neither"]) && k > 0
    })
}

/// True if these words are a whole clause: a command with its object, a subject with its verb, "no cars".
fn stands_alone(clause: &[Token]) -> bool {
    let polite = clause.iter().take_while(|t| is(Some(t), POLITE)).count();
    let clause = &clause[polite..];
    let orders = orders_something(clause) || orders_surely(clause) || changes_number(clause);
    let sky = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
    let styles = clause.first().is_some_and(is_verb) && clause.iter().any(sky);
    let neither = is(clause.first(), &["neither"]) && clause.iter().any(|t| HELPERS.contains(&text(t)));
    let wants = leads(clause, WANTS).is_some() && has_noun(clause);
    orders || wants || styles || neither || place_then_order(clause) || says(clause) || other_clause(clause)
}

/// "ten metres further ahead with the bus", "20 m to the truck is too little".
fn metres_for(clause: &[Token]) -> bool {
    let metres = clause.first().is_some_and(|t| number(t).is_some()) && super::words::is_unit(clause.get(1));
    let with = find(clause, &["with the", "with both", "for the"]).is_some_and(|x| x.0 < 6);
    let gap =
        is(clause.get(2), &["to", "between"]) && clause.iter().any(|t| is(Some(t), &["is", "are", "isnt"]));
    metres && has_noun(clause) && (with || gap)
}

/// "motorcycle 15 metres behind me".
fn noted(clause: &[Token]) -> bool {
    first_noun(clause).is_some_and(|n| {
        n.0 == 0
            && clause.get(n.1).is_some_and(|t| number(t).is_some())
            && super::words::is_unit(clause.get(n.1 + 1))
            && clause.get(n.1 + 2..).is_some_and(is_place)
            && !has_noun(&clause[n.1..])
    })
}

/// "truck out, excavator in".
fn out_first(clause: &[Token]) -> bool {
    first_noun(clause).is_some_and(|n| {
        n.0 < 3
            && is(clause.get(n.1), &["out", "off", "gone", "away"])
            && clause.get(n.1 + 1).is_some_and(|t| t.kind == TokenKind::Comma)
    })
}

/// Clauses of other kinds: "removal of the bus", "bus stops 15 m ahead", "what stands there should be a truck", "on the left
/// a van has stopped", "motorcycle gone".
fn other_clause(clause: &[Token]) -> bool {
    let says_so = |t: &Token| {
        let w = text(t);
        HELPERS.contains(&w) || NEGATED.contains(&w) || is_finite(w, false) && !w.ends_with("ed")
    };
    let nominal = leads(clause, NOMINAL).is_some() && has_noun(clause);
    let what = is(clause.first(), &["what", "whats", "whatever", "whoever"])
        && clause
            .iter()
            .any(|t| is(Some(t), &["should", "must", "was", "is", "ought", "has"]))
        && has_noun(clause);
    let placed = is_place(clause)
        && clause.first().is_some_and(|t| number(t).is_none())
        && (1..clause.len().saturating_sub(2)).any(|k| {
            !clause[..k].iter().any(|t| is(Some(t), &["and", "but"]))
                && is(clause.get(k), &["a", "an", "the", "two", "three", "four"])
                && first_noun(&clause[k..])
                    .is_some_and(|n| n.0 > 0 && n.0 < 4 && clause.get(k + n.1).is_some_and(says_so))
        });
    let bare = first_noun(clause)
        .is_some_and(|n| n.0 == 0 && clause.len() > n.1 + 1 && clause.get(n.1).is_some_and(says_so));
    let gone = is(clause.last(), &["gone", "out", "away"])
        && first_noun(clause).is_some_and(|n| n.0 < 3 && n.1 + 1 == clause.len());
    nominal || noted(clause) || metres_for(clause) || out_first(clause) || what || placed || bare || gone
}

/// "in front of the bus, put a motorcycle", "in place of the truck I would prefer a bus".
fn place_then_order(clause: &[Token]) -> bool {
    let instead = leads(clause, &["in place of", "in lieu of", "in the place of"]);
    if !is_place(clause) && instead.is_none() {
        return false;
    }
    let Some((_, b)) = first_noun(clause).filter(|n| n.0 < 6) else {
        return false;
    };
    let from = b + usize::from(clause.get(b).is_some_and(|t| t.kind == TokenKind::Comma));
    let rest = &clause[from.min(clause.len())..];
    orders_something(rest)
        || instead.is_some()
            && (leads(rest, WANTS).is_some() || is(rest.first(), &["a", "an", "two", "three", "comes"]))
            && has_noun(rest)
}

/// "two fewer pedestrians", "half the cones", "not a single barrier should be left".
fn changes_number(clause: &[Token]) -> bool {
    let fewer = clause.first().is_some_and(|t| number(t).is_some())
        && (is(clause.get(1), &["fewer", "less", "more"]) || is(clause.last(), &["fewer", "less", "more"]));
    let share = leads(
        clause,
        &[
            "half the",
            "half of the",
            "twice the",
            "double the",
            "not a single",
            "not one",
            "three times the",
        ],
    );
    (fewer || share.is_some()) && has_noun(clause)
}

fn is_determiner(t: &Token) -> bool {
    is(
        Some(t),
        &[
            "the", "a", "an", "all", "every", "my", "our", "some", "any", "half", "no", "this", "these",
            "those", "twice",
        ],
    ) || number(t).is_some()
}

/// "remove the bus", "take away two cars", "make half the cones barriers".
pub(super) fn orders_something(clause: &[Token]) -> bool {
    let Some(first) = clause.first() else {
        return false;
    };
    if !is(Some(first), ORDERS)
        || !is_verb(first)
            && !is(
                Some(first),
                &["have", "let", "station", "lose", "double", "halve"],
            )
    {
        return false;
    }
    let off = usize::from(is(
        clause.get(1),
        &["away", "off", "out", "up", "down", "over", "in"],
    )) + 2 * usize::from(is(clause.get(1), &["rid"]));
    let object = &clause[(1 + off).min(clause.len())..];
    let whoever = is(
        object.first(),
        &[
            "each",
            "both",
            "every",
            "everybody",
            "everyone",
            "everything",
            "nothing",
            "nobody",
            "another",
        ],
    );
    let named = whoever || object.first().is_some_and(is_determiner) || noun_at(object).is_some();
    named && first_noun(object).is_some_and(|n| n.0 < 6) && !is_place(object)
}

/// The same with any verb, of which what follows tells that it is none of a noun: "sweep two of the cones aside".
fn orders_surely(clause: &[Token]) -> bool {
    let verb = clause
        .first()
        .is_some_and(|t| is_verb(t) || is(Some(t), &["shorten", "enlarge", "extend", "stop", "trim", "use"]));
    let object = clause.get(1).is_some_and(|t| {
        is(
            Some(t),
            &["the", "all", "every", "half", "both", "a", "an", "another"],
        ) || number(t).is_some()
    });
    verb && object && first_noun(&clause[1..]).is_some_and(|n| n.0 < 6)
}

/// A subject with its verb: "the bus should be yellow", "two pedestrians wait on the left".
pub(super) fn says(clause: &[Token]) -> bool {
    let Some((a, b)) = first_noun(clause).filter(|n| n.0 < 5) else {
        return false;
    };
    if !clause.first().is_some_and(is_determiner)
        || clause[..a]
            .iter()
            .any(|t| is_place(std::slice::from_ref(t)) && number(t).is_none())
    {
        return false;
    }
    // ("my lane is blocked by a barrier")
    if is(clause.first(), &["the", "my", "our"])
        && (1..clause.len().min(4)).any(|k| HELPERS.contains(&text(&clause[k])))
    {
        return true;
    }
    // (its place may stand before the verb)
    let fresh = is(clause.first(), &["a", "an", "some"]) || number(&clause[0]).is_some();
    let near = clause.len().min(b + if fresh { 1 } else { 7 });
    // ("the two pedestrians get a companion")
    let several = matches!(look_up(text(&clause[b - 1])), Some(Sense::Noun(_, true)));
    let verb = (b..near).find(|k| {
        let w = text(&clause[*k]);
        HELPERS.contains(&w)
            || NEGATED.contains(&w)
            || is_finite(w, several && *k == b)
                && !w.ends_with("ed")
                && !matches!(w, "put" | "set" | "kept" | "left" | "cut")
    });
    verb.is_some_and(|k| k + 1 < clause.len() || is_finite(text(&clause[k]), false))
}

/// "switch the weather to rain", "make it snow".
fn orders_sky(clause: &[Token]) -> bool {
    let sky = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
    let of_it = leads(
        &clause[1..],
        &[
            "the weather",
            "the time",
            "the sky",
            "the light",
            "it to",
            "the hour",
            "the season",
            "the scene",
            "the clock",
        ],
    )
    .is_some();
    is(clause.first(), ORDERS) && of_it && !has_noun(clause) && clause.iter().any(sky)
}

/// True if a clause of its own begins here and goes on to the end.
fn opens(clause: &[Token]) -> bool {
    if clause.len() < 2 {
        return false;
    }
    let absent = is(clause.first(), &["no"]) && first_noun(clause).is_some_and(|n| n.0 < 3);
    let number_changes = changes_number(clause);
    let wants = leads(clause, WANTS).is_some() && has_noun(clause);
    // ("the weather" and the light are told with what they are said of)
    let sky = clause
        .iter()
        .any(|t| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_))));
    // "it is night", "the time is night"
    let told = leads(
        clause,
        &[
            "the time is",
            "the weather is",
            "it is",
            "the sky is",
            "the hour is",
        ],
    )
    .is_some()
        && super::parting::only_sky(clause);
    let styled = orders_sky(clause) || told;
    absent
        || styled
        || place_then_order(clause)
        || number_changes
        || wants
        || orders_something(clause)
        || orders_surely(clause)
        || other_clause(clause) && !sky
        || says(clause) && !sky && find(clause, &["while", "but"]).is_none()
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn clauses_that_stand_alone() {
        let said = |t: &str| {
            let list: Vec<String> = apart(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("turn the bus around, and also no pedestrians please"),
            "turn the bus around . no pedestrians please"
        );
        assert_eq!(
            said("delete a parked car and then the bus should be yellow"),
            "delete a parked car . the bus should be yellow"
        );
        for whole in [
            "remove the bus and the truck",
            "take the barrier and put it behind me",
            "the bus and the truck should go",
            "one stays and one crosses",
            "put a cone between the bus and the truck",
        ] {
            assert_eq!(said(whole), whole);
        }
    }
}
