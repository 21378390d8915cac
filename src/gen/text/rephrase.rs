//! Edits said as statements, turned into commands before they are read: "the bus should go" is "remove the bus", "the taxi
//! ought to be a van" is "make the taxi a van", "one pedestrian less" is "keep the pedestrians", with one fewer.

use super::amounts::{arithmetic, counted};
use super::exchange::exchanged;
use super::existence::{nobody, sent_off, there};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::words::edits::VERBS;

/// How a number changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// So many times as many.
    Times(f64),
    /// So many more, or fewer.
    Plus(i64),
}

/// A text after rephrasing: its tokens, the number change of a sentence (by its first token), ordinals taken out.
#[derive(Clone, Debug, Default)]
pub struct Rephrased {
    /// Tokens as commands.
    pub tokens: Vec<Token>,
    /// Start of a sentence in bytes, and its change of number.
    pub changes: Vec<(usize, Change)>,
    /// Byte where an ordinal stood ("the second truck"), and its number from 1; 0 is the last.
    pub ordinals: Vec<(usize, usize)>,
}

const POLITE: &[&[&str]] = &[
    &["could", "you", "please"],
    &["can", "you", "please"],
    &["would", "you", "please"],
    &["could", "you"],
    &["can", "you"],
    &["would", "you"],
    &["will", "you"],
    &["can", "we"],
    &["could", "we"],
    &["how", "about"],
    &["what", "if"],
    &["i", "would", "like", "you", "to"],
    &["id", "like", "you", "to"],
    &["i", "want", "you", "to"],
    &["i", "need", "you", "to"],
    &["i", "would", "like", "to"],
    &["id", "like", "to"],
    &["i", "want", "to"],
    &["we", "need", "to"],
    &["we", "should"],
    &["lets"],
    &["let", "us"],
    &["please"],
    &["now"],
    &["ok"],
    &["okay"],
    &["then"],
    &["also"],
    &["maybe"],
    &["hey"],
    &["go", "ahead", "and"],
    &["try", "to"],
    &["i", "think"],
    &["id", "rather"],
    &["i", "would", "rather"],
    &["i", "d", "rather"],
    &["i", "wish"],
    &["i", "suggest"],
    &["i", "propose"],
    &["id", "prefer", "it", "if"],
    &["i", "would", "prefer", "it", "if"],
    &["i", "prefer", "that"],
    &["it", "would", "be", "better", "if"],
    &["it", "is", "better", "if"],
    &["better", "if"],
    &["would", "you", "mind"],
    &["kindly"],
    &["upon", "closer", "inspection"],
    &["on", "closer", "inspection"],
    &["on", "reflection"],
    &["in", "reality"],
    &["in", "truth"],
    &["in", "fact"],
    &["as", "it", "turns", "out"],
    &["it", "turns", "out", "that"],
    &["it", "turned", "out", "that"],
    &["turns", "out"],
    &["according", "to", "the", "witness"],
    &["according", "to", "witnesses"],
    &["according", "to", "the", "report"],
    &["according", "to", "the", "driver"],
    &["correction"],
    &["rather"],
    &["do"],
    &["next"],
    &["finally"],
    &["afterwards"],
    &["after", "that"],
    &["in", "addition"],
    &["additionally"],
    &["oh"],
    &["and"],
    &["well"],
    &["so"],
    &["but"],
    &["you", "should"],
    &["you", "can"],
    &["you", "may"],
    &["feel", "free", "to"],
    &["be", "so", "kind", "as", "to"],
    &["time", "to"],
    &["id", "love", "to"],
    &["id", "love", "it", "if"],
    &["id", "like", "it", "if"],
    &["i", "want", "it", "so", "that"],
    &["ensure", "that"],
    &["see", "to", "it", "that"],
    &["actually"],
    &["on", "second", "thought"],
    &["on", "second", "thoughts"],
    &["for", "this", "one"],
    &["it", "would", "be", "nice", "if"],
    &["make", "sure", "that"],
    &["make", "sure"],
];
const WISH: &[&[&str]] = &[
    &["i", "would", "like"],
    &["id", "like"],
    &["i", "want"],
    &["i", "need"],
    &["we", "need"],
    &["we", "want"],
    &["i", "wish", "for"],
    &["let", "me", "have"],
    &["can", "i", "have"],
    &["could", "i", "have"],
    &["id", "prefer"],
    &["i", "prefer"],
    &["id", "rather", "have"],
];
const UNWISH: &[&[&str]] = &[
    &["i", "dont", "want"],
    &["i", "do", "not", "want"],
    &["we", "dont", "need"],
    &["i", "dont", "need"],
    &["we", "dont", "want"],
    &["dont", "show"],
    &["do", "not", "show"],
    &["do", "away", "with"],
    &["no", "more"],
    &["enough", "of"],
    &["away", "with"],
    &["off", "with"],
    &["out", "with"],
    &["make", "do", "without"],
];
const MODALS: &[&str] = &[
    "should", "must", "shall", "ought", "needs", "need", "has", "have", "can", "could", "may", "will", "is",
    "are", "was", "were", "wants", "would", "might", "belongs", "goes",
];
const GONE: &[&str] = &[
    "gone",
    "removed",
    "deleted",
    "erased",
    "disappear",
    "vanish",
    "go",
    "away",
    "out",
    "leave",
    "scrapped",
    "dropped",
];

fn starts_with(tokens: &[Token], words: &[&str]) -> bool {
    tokens.len() >= words.len() && tokens.iter().zip(words).all(|(t, w)| t.text == *w)
}

pub fn strip<'a>(mut tokens: &'a [Token], lists: &[&[&str]]) -> &'a [Token] {
    'again: loop {
        for words in lists {
            if tokens.len() > words.len() && starts_with(tokens, words) {
                tokens = &tokens[words.len()..];
                continue 'again;
            }
        }
        return tokens;
    }
}

fn sense(t: &Token) -> Option<Sense> {
    look_up(&t.text)
}

fn number(t: &Token) -> Option<i64> {
    match (&t.kind, sense(t)) {
        (TokenKind::Number(v), _) if v.is_finite() && (0.0..1000.0).contains(v) => Some(v.round() as i64),
        (_, Some(Sense::Count(c))) if c.is_exact() => Some(i64::from(c.n)),
        _ => None,
    }
}

fn ordinal(word: &str) -> Option<usize> {
    Some(match word {
        "first" => 1,
        "second" => 2,
        "third" => 3,
        "fourth" => 4,
        "fifth" => 5,
        "last" => 0,
        _ => return None,
    })
}

fn is_noun(t: &Token) -> bool {
    matches!(sense(t), Some(Sense::Noun(..)))
}

pub(super) fn is_verb(t: &Token) -> bool {
    VERBS.iter().any(|(_, list)| {
        list.split('|')
            .any(|w| w.split(' ').next() == Some(t.text.as_str()))
    })
}

fn is_place_word(t: &Token) -> bool {
    matches!(
        sense(t),
        Some(Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At | Sense::Across)
    )
}

fn word(text: &str, at: &Token) -> Token {
    Token {
        kind: TokenKind::Word,
        text: text.to_string(),
        span: at.span,
    }
}

fn with_verb(verb: &str, at: &Token, rest: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = verb.split(' ').map(|w| word(w, at)).collect();
    out.extend_from_slice(rest);
    out
}

/// Rewrites a text sentence by sentence.
pub fn rephrase(tokens: &[Token]) -> Rephrased {
    let mut out = Rephrased::default();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, Some(last)),
            _ => (sentence, None),
        };
        let put_back = topic(body);
        let body = put_back.as_deref().unwrap_or(body);
        let body = take_ordinals(&take_and_put(&name_people(body)), &mut out);
        if let Some(first) = body.first() {
            let (new, change) = one(&body);
            if let Some(change) = change {
                out.changes
                    .push((new.first().map_or(first.span.start, |t| t.span.start), change));
            }
            out.tokens.extend(new);
        }
        out.tokens.extend(stop.cloned());
    }
    out
}

/// "whatever is behind us, make it a bus" and "the car behind us: drop it": the verb first.
fn topic(body: &[Token]) -> Option<Vec<Token>> {
    let first = body.first()?;
    let open = matches!(
        first.text.as_str(),
        "whatever" | "whoever" | "whichever" | "what" | "anything" | "anyone" | "who"
    );
    let definite = matches!(
        first.text.as_str(),
        "the" | "that" | "this" | "those" | "these" | "both" | "all" | "my"
    );
    if !open && !definite {
        return None;
    }
    let cut = (1..body.len()).find(|i| {
        let mark = body[*i].kind == TokenKind::Comma || body[*i].kind == TokenKind::Mark;
        let next = i + 1 + strip_len(&body[i + 1..]);
        if definite
            && mark
            && body.get(next).is_some_and(is_verb)
            && body.get(next + 1).is_none_or(|t| {
                is_place_word(t) || matches!(t.text.as_str(), "to" | "away" | "out" | "off" | "onto" | "into")
            })
        {
            return true; // "the man on the zebra, kindly shift to the left"
        }
        mark && body.get(i + 1).is_some_and(is_verb)
            && body[i + 1..]
                .iter()
                .take(4)
                .any(|t| matches!(t.text.as_str(), "it" | "them" | "him" | "her" | "that" | "this"))
    })?;
    let mut np: Vec<Token> = Vec::new();
    if open {
        let is = body[..cut].iter().position(|t| {
            matches!(
                t.text.as_str(),
                "is" | "are" | "stands" | "stand" | "sits" | "waits" | "drives" | "comes" | "was"
            )
        })?;
        let people = matches!(first.text.as_str(), "whoever" | "anyone" | "who");
        // "whatever is behind me, delete it": all of it
        let removed = body[cut + 1..].iter().take(3).any(|t| {
            matches!(
                t.text.as_str(),
                "remove" | "delete" | "erase" | "drop" | "clear" | "lose" | "bin" | "rid" | "scrap"
            )
        });
        np.push(word(if removed { "all" } else { "the" }, first));
        np.push(word(
            match (people, removed) {
                (true, true) => "people",
                (true, false) => "person",
                (false, true) => "objects",
                (false, false) => "object",
            },
            first,
        ));
        np.extend_from_slice(&body[is + 1..cut]);
    } else {
        np.extend_from_slice(&body[..cut]);
    }
    let start = cut + 1 + strip_len(&body[cut + 1..]);
    let it = (start..body.len()).find(|i| {
        matches!(
            body[*i].text.as_str(),
            "it" | "them" | "him" | "her" | "that" | "this"
        )
    });
    let Some(it) = it else {
        let verb = body.get(start)?.clone();
        let mut out = vec![verb];
        out.extend(np);
        out.extend_from_slice(&body[start + 1..]);
        return Some(out);
    };
    let mut out = body[start..it].to_vec();
    out.extend(np);
    out.extend_from_slice(&body[it + 1..]);
    Some(out)
}

/// How many polite words begin a clause.
fn strip_len(tokens: &[Token]) -> usize {
    tokens.len() - strip(tokens, POLITE).len()
}

/// "everyone on the pavement" is "all people on the pavement".
fn name_people(body: &[Token]) -> Vec<Token> {
    let mut out = Vec::with_capacity(body.len() + 1);
    for (i, t) in body.iter().enumerate() {
        let person = matches!(t.text.as_str(), "everyone" | "everybody" | "anyone" | "anybody");
        if person && i > 0 {
            out.push(word("all", t));
            out.push(word("people", t));
        } else {
            out.push(t.clone());
        }
    }
    out
}

/// "take the barrier and put it behind me" is "put the barrier behind me"; "it" after a second verb is what was named.
fn take_and_put(body: &[Token]) -> Vec<Token> {
    let Some(first) = body.first() else {
        return Vec::new();
    };
    let verbs: Vec<usize> = (1..body.len())
        .filter(|i| is_verb(&body[*i]) && matches!(body[*i - 1].text.as_str(), "and" | "then" | ","))
        .collect();
    let (Some(&second), true) = (verbs.first(), is_verb(first)) else {
        return body.to_vec();
    };
    let pronoun = body
        .get(second + 1)
        .is_some_and(|t| matches!(t.text.as_str(), "it" | "them" | "him" | "her"));
    if !pronoun {
        return body.to_vec();
    }
    let mut np_end = second;
    while np_end > 1
        && (matches!(body[np_end - 1].text.as_str(), "and" | "then")
            || body[np_end - 1].kind == TokenKind::Comma)
    {
        np_end -= 1;
    }
    let noun = body[1..np_end].iter().position(is_noun).map(|i| i + 1);
    let Some(noun) = noun else {
        return body.to_vec();
    };
    let lift = matches!(first.text.as_str(), "take" | "grab" | "pick" | "lift");
    let mut out: Vec<Token> = if lift { Vec::new() } else { body[..second].to_vec() };
    out.push(body[second].clone());
    out.extend_from_slice(&body[1..=noun]);
    out.extend_from_slice(&body[second + 2..]);
    out
}

/// "the second truck", "the last of the cars": the ordinal goes, its place is kept.
fn take_ordinals(body: &[Token], out: &mut Rephrased) -> Vec<Token> {
    let mut kept = Vec::with_capacity(body.len());
    for (i, t) in body.iter().enumerate() {
        let the = i > 0 && body[i - 1].text == "the";
        let noun = body[i + 1..].iter().take(3).any(is_noun);
        match ordinal(&t.text).filter(|_| the && noun) {
            Some(n) => out.ordinals.push((t.span.start, n)),
            None => kept.push(t.clone()),
        }
    }
    kept
}

/// A clause as a command, and how a number changes by it; `None` if it is one already or none of these.
fn restate(clause: &[Token]) -> Option<(Vec<Token>, Option<Change>)> {
    counted(clause).or_else(|| {
        let found = nobody(clause)
            .or_else(|| exchanged(clause))
            .or_else(|| sent_off(clause))
            .or_else(|| there(clause))?;
        Some((found, None))
    })
}

fn one(body: &[Token]) -> (Vec<Token>, Option<Change>) {
    let mut rest = strip(body, POLITE);
    while let Some((last, before)) = rest.split_last()
        && before.len() > 1
        && (last.kind == TokenKind::Comma
            || matches!(last.text.as_str(), "please" | "thanks" | "ok" | "okay" | "now"))
    {
        rest = before;
    }
    let Some(first) = rest.first() else {
        return (body.to_vec(), None);
    };
    if let Some(list) = UNWISH
        .iter()
        .find(|l| rest.len() > l.len() && starts_with(rest, l))
    {
        let tail = strip(&rest[list.len()..], &[&["any", "more"], &["any"]]);
        let end = tail
            .iter()
            .rposition(|t| !matches!(t.text.as_str(), "please" | "anymore" | "more" | "any"));
        let tail = &tail[..end.map_or(tail.len(), |e| e + 1)];
        // "no more cones" means all of them, as "remove the cones" does
        return (with_verb("remove", first, tail), None);
    }
    // "could the lorry be swapped for a van?"
    let asks = matches!(
        first.text.as_str(),
        "could" | "can" | "should" | "would" | "must" | "may" | "might" | "shall"
    );
    if asks
        && rest.get(1).is_some_and(|t| {
            matches!(
                t.text.as_str(),
                "the" | "both" | "all" | "that" | "those" | "these" | "every"
            )
        })
    {
        return one(&rest[1..]);
    }
    // "leave everything as it is but put a cone there", "change nothing except the weather"
    let all = rest
        .get(1)
        .is_some_and(|t| matches!(t.text.as_str(), "everything" | "all" | "nothing" | "things"));
    let same = rest.get(1).is_some_and(|t| t.text == "nothing")
        || rest
            .iter()
            .take(8)
            .any(|t| matches!(t.text.as_str(), "as" | "else" | "unchanged" | "same" | "alone"));
    if matches!(first.text.as_str(), "leave" | "keep" | "change" | "touch") && all && same {
        let cut = rest.iter().position(|t| {
            t.kind == TokenKind::Comma
                || matches!(
                    t.text.as_str(),
                    "but" | "except" | "and" | "only" | "save" | "just"
                )
        });
        let tail = cut.map_or(&[][..], |k| strip(&rest[k + 1..], POLITE));
        return if tail.is_empty() {
            (Vec::new(), None)
        } else {
            one(tail)
        };
    }
    // "apart from the truck nothing should remain", "only the walkers may stay"
    let lead = [
        &["apart", "from"][..],
        &["except", "for"],
        &["except"],
        &["besides"],
        &["other", "than"],
        &["save", "for"],
        &["bar"],
        &["only"],
        &["just"],
        &["nothing", "but"],
    ]
    .into_iter()
    .find(|l| starts_with(rest, l));
    let stays = rest.iter().position(|t| {
        matches!(
            t.text.as_str(),
            "stay"
                | "stays"
                | "remain"
                | "remains"
                | "kept"
                | "left"
                | "go"
                | "survive"
                | "gone"
                | "disappear"
                | "removed"
        )
    });
    if let (Some(l), Some(_)) = (lead, stays) {
        let np = &rest[l.len()..];
        let end = np.iter().position(|t| {
            t.kind == TokenKind::Comma
                || matches!(
                    t.text.as_str(),
                    "may"
                        | "should"
                        | "can"
                        | "must"
                        | "shall"
                        | "is"
                        | "are"
                        | "will"
                        | "gets"
                        | "get"
                        | "everything"
                        | "nothing"
                        | "stays"
                        | "stay"
                        | "remain"
                        | "remains"
                        | "all"
                        | "has"
                        | "have"
                )
        });
        if let Some(end) = end.filter(|e| np[..*e].iter().any(is_noun)) {
            return (with_verb("keep only", first, &np[..end]), None);
        }
    }
    // "five people, not three", "four cones instead of six"
    let not_n = (1..rest.len()).find(|i| {
        let n = match rest[*i].text.as_str() {
            "not" => 1,
            "instead" | "rather" => 2,
            _ => return false,
        };
        rest.get(i + n).is_some_and(|t| number(t).is_some())
    });
    if let Some(k) = not_n
        && let Some(n) = rest[..k].iter().position(|t| number(t).is_some())
        && rest[n..k].iter().any(is_noun)
    {
        let end = if rest[k - 1].kind == TokenKind::Comma {
            k - 1
        } else {
            k
        };
        return (with_verb("keep exactly", first, &rest[n..end]), None);
    }
    if let Some(found) = restate(rest) {
        return found;
    }
    if let Some((tokens, change)) = arithmetic(rest) {
        return (tokens, Some(change));
    }
    // "I want the bus gone", "I'd like two more people"
    if let Some(list) = WISH.iter().find(|l| rest.len() > l.len() && starts_with(rest, l)) {
        let wish = &rest[list.len()..];
        return (wished(wish, first), None);
    }
    // "everything away except the bus", "all out but the bus"
    if matches!(
        first.text.as_str(),
        "everything" | "all" | "everyone" | "remove" | "delete" | "clear" | "erase" | "take"
    ) {
        let cut = rest.iter().position(|t| {
            matches!(
                t.text.as_str(),
                "except" | "but" | "excluding" | "bar" | "save" | "besides"
            )
        });
        let everything = rest
            .iter()
            .take(cut.unwrap_or(0))
            .any(|t| matches!(t.text.as_str(), "everything" | "all" | "everyone"));
        if let Some(cut) = cut.filter(|_| everything) {
            let nouns = rest[..cut].iter().any(|t| is_noun(t) && t.text != "everything");
            let tail = strip(&rest[cut + 1..], &[&["for"], &["from"]]);
            if !nouns && !tail.is_empty() {
                return (with_verb("keep only", first, tail), None);
            }
        }
    }
    // "have a cyclist follow the bus", "let somebody else join the pedestrian"
    let fresh = rest.get(1).is_some_and(|t| {
        matches!(
            t.text.as_str(),
            "a" | "an" | "another" | "somebody" | "someone" | "some" | "one" | "two" | "three"
        ) || number(t).is_some()
    });
    let does = rest.iter().skip(2).take(6).any(|t| {
        matches!(
            sense(t),
            Some(Sense::State(_, true) | Sense::Rel(_) | Sense::Across)
        ) || is_verb(t)
    });
    if matches!(first.text.as_str(), "let" | "have" | "make" | "get") && fresh && does {
        return (with_verb("add", first, &rest[1..]), None);
    }
    if matches!(first.text.as_str(), "let" | "have" | "make" | "get")
        && rest.len() > 3
        && !matches!(rest[1].text.as_str(), "rid" | "it" | "that")
        && let Some(found) = restate(&rest[1..])
    {
        return found;
    }
    if is_verb(first)
        && first.text != "let"
        && !(first.text == "get" && rest.len() > 2)
        && first.text != "have"
    {
        return (rest.to_vec(), None);
    }
    // "let the cyclist ride behind me", "have the people stand on the right", "get the bus behind me"
    if matches!(first.text.as_str(), "let" | "have" | "get") && rest.len() > 2 && rest[1].text != "rid" {
        let tail = &rest[1..];
        if let Some(found) = restate(tail) {
            return found;
        }
        if matches!(
            tail[0].text.as_str(),
            "the" | "all" | "my" | "both" | "every" | "that"
        ) {
            return (wished(tail, first), None);
        }
        if first.text == "have" {
            return (with_verb("add", first, tail), None);
        }
        return (rest.to_vec(), None);
    }
    (stated(rest).unwrap_or_else(|| rest.to_vec()), None)
}

/// What is wished for: to be gone, elsewhere, something else, or there.
fn wished(wish: &[Token], first: &Token) -> Vec<Token> {
    if let Some(new) = stated_with(wish, first) {
        return new;
    }
    // "four people rather than three"
    let than = (0..wish.len()).find(|i| {
        starts_with(&wish[*i..], &["rather", "than"])
            || starts_with(&wish[*i..], &["instead", "of"])
            || wish[*i].text == "not"
    });
    if let Some(than) = than
        && wish.first().and_then(number).is_some()
        && wish
            .get(than + 1..)
            .is_some_and(|t| t.iter().take(2).any(|t| number(t).is_some()))
    {
        return with_verb("keep exactly", first, &wish[..than]);
    }
    with_verb("add", first, wish)
}

fn stated(rest: &[Token]) -> Option<Vec<Token>> {
    let first = rest.first()?;
    // "one cyclist is enough"
    let last = rest.last()?;
    if number(first).is_some()
        && matches!(
            last.text.as_str(),
            "enough" | "suffices" | "suffice" | "plenty" | "do" | "sufficient" | "only"
        )
    {
        let end = rest.iter().position(|t| {
            matches!(
                t.text.as_str(),
                "is" | "are" | "will" | "would" | "suffices" | "suffice"
            )
        })?;
        return Some(with_verb("keep only", first, &rest[..end]));
    }
    let m = rest.iter().position(|t| MODALS.contains(&t.text.as_str()))?;
    let named = rest[..m]
        .iter()
        .any(|t| is_noun(t) || matches!(t.text.as_str(), "everything" | "everyone"));
    if !named || m == 0 {
        // "there should be six cones" is read as it is
        return None;
    }
    stated_with(rest, first)
}

/// A noun phrase and what shall become of it, as a command.
fn stated_with(rest: &[Token], first: &Token) -> Option<Vec<Token>> {
    let noun = rest
        .iter()
        .position(|t| is_noun(t) || matches!(t.text.as_str(), "everything" | "everyone"))?;
    let definite = rest[..noun].iter().any(|t| {
        matches!(
            t.text.as_str(),
            "the" | "my" | "that" | "all" | "both" | "every" | "this"
        )
    }) || matches!(rest[noun].text.as_str(), "everything" | "everyone");
    // Words of the noun phrase end where a modal or a verb begins.
    let small = [
        "to", "be", "not", "also", "now", "just", "get", "got", "instead", "rather", "please",
    ];
    let modal = (noun..rest.len()).find(|i| MODALS.contains(&rest[*i].text.as_str()));
    let last_word = rest.iter().rposition(|t| {
        !matches!(
            t.text.as_str(),
            "please" | "now" | "instead" | "from" | "here" | "scene"
        )
    })?;
    let gone = GONE.contains(&rest[last_word].text.as_str());
    if gone && definite && last_word > noun {
        let end = modal.unwrap_or(last_word).min(last_word);
        return Some(with_verb("remove", first, &rest[..end]));
    }
    if !definite {
        return None;
    }
    let mut tail_from = match modal {
        Some(m) => m + 1,
        // "let the cyclist ride behind me", "I want the bus behind me"
        None => (noun + 1..rest.len())
            .find(|i| is_place_word(&rest[*i]) || matches!(sense(&rest[*i]), Some(Sense::State(..))))?,
    };
    let np_end = modal.unwrap_or(tail_from);
    while tail_from < rest.len()
        && (small.contains(&rest[tail_from].text.as_str()) || MODALS.contains(&rest[tail_from].text.as_str()))
    {
        tail_from += 1;
    }
    let np = &rest[..np_end];
    let end = (tail_from..rest.len())
        .find(|i| {
            matches!(rest[*i].text.as_str(), "instead" | "please")
                || starts_with(&rest[*i..], &["rather", "than"])
        })
        .unwrap_or(rest.len());
    let tail = rest.get(tail_from..end)?;
    let head = tail.first()?;
    let join = |verb: &str, np: &[Token], tail: &[Token]| {
        let mut out = with_verb(verb, first, np);
        out.extend_from_slice(tail);
        Some(out)
    };
    let article = matches!(head.text.as_str(), "a" | "an");
    if article && tail.iter().any(is_noun) {
        return join("make", np, tail); // "the taxi ought to be a bus"
    }
    if matches!(
        head.text.as_str(),
        "face" | "turn" | "look" | "point" | "rotate" | "spin"
    ) {
        return join("turn", np, tail);
    }
    if matches!(
        head.text.as_str(),
        "moved" | "move" | "shifted" | "pushed" | "placed" | "put"
    ) {
        return join("move", np, &tail[1..]);
    }
    if matches!(sense(head), Some(Sense::State(..))) && tail.get(1).is_some() {
        // "ride behind me", "stand on the right": where is what matters
        let from = tail.iter().position(is_place_word)?;
        return join("move", np, &tail[from..]);
    }
    if is_place_word(head) {
        return join("move", np, tail);
    }
    if number(head).is_some()
        && tail
            .get(1)
            .is_some_and(|t| look_up(&t.text).is_some_and(|s| matches!(s, Sense::Unit(_))))
    {
        return join("move", np, tail);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    fn said(text: &str) -> String {
        let list: Vec<String> = rephrase(&tokens(text))
            .tokens
            .into_iter()
            .map(|t| t.text)
            .collect();
        list.join(" ")
    }

    #[test]
    fn statements_become_commands() {
        assert_eq!(said("The bus should go"), "remove the bus");
        assert_eq!(said("I want the bus gone"), "remove the bus");
        assert_eq!(said("the taxi ought to be a van"), "make the taxi a van");
        assert_eq!(
            said("let the cyclist ride behind me instead"),
            "move the cyclist behind me"
        );
        assert_eq!(said("everything away except the bus"), "keep only the bus");
        assert_eq!(said("could you remove the bus?"), "remove the bus .");
        assert_eq!(said("add a bus behind me"), "add a bus behind me");
        let less = rephrase(&tokens("one pedestrian less"));
        assert_eq!(less.changes, [(less.tokens[0].span.start, Change::Plus(-1))]);
        assert_eq!(
            rephrase(&tokens("double the number of parked cars")).changes[0].1,
            Change::Times(2.0)
        );
        assert_eq!(rephrase(&tokens("remove the second truck")).ordinals.len(), 1);
        assert!(rephrase(&[]).tokens.is_empty());
    }
}
