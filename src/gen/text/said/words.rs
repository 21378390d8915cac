//! Words by what they do in a sentence: helpers, denials, finite verbs, the head of a noun phrase.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::words::edits::VERBS;
use super::super::words::verbs::{DOING, RELATING, forms};
use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

/// Finite forms: of the third person, and the base form for several and after "let".
static FINITE: LazyLock<(HashSet<String>, HashSet<String>)> = LazyLock::new(|| {
    let (mut third, mut base) = (HashSet::new(), HashSet::new());
    let more = "keep/kept|cut in|become/became|turn|change|stay|remain|go/went/gone|come/came/come|have/had|\
                swap|trade|exchange|switch|disappear|vanish|leave/left|make/made|take/took/taken|give/gave/given|\
                put/put|start|begin/began/begun|park|look|point|block|wait|stop|fall/fell/fallen|reach|join|hang/hung|get/got|drop|shift|move|bounce|dip|scram|set/set|lose/lost|belong|return";
    let all = DOING
        .iter()
        .map(|d| d.1)
        .chain(RELATING.iter().map(|r| r.1))
        .flat_map(|l| l.split('|'))
        .chain(more.split('|'));
    for entry in all {
        let f = forms(entry.trim());
        let first = |s: &str| s.split(' ').next().unwrap_or(s).to_string();
        third.insert(first(&f.s));
        if f.past != f.base && !matches!(first(&f.past).as_str(), "left" | "hung" | "wound") {
            third.insert(first(&f.past));
        }
        base.insert(first(&f.base));
        base.insert(first(&f.participle));
    }
    // prepositions, adjectives and nouns that are verbs, too
    for word in ["left", "hung", "wound"] {
        base.remove(word);
    }
    for word in ["near", "like", "face", "back", "bus", "round", "lines"] {
        third.remove(word);
        if word != "face" {
            base.remove(word);
        }
    }
    (third, base)
});

/// True for a finite verb; base forms count where `base` allows them.
pub fn is_finite(word: &str, base: bool) -> bool {
    FINITE.0.contains(word) || base && FINITE.1.contains(word)
}

/// Commands by their forms in the past and in -ing.
static COMMANDS: LazyLock<HashMap<String, &'static str>> = LazyLock::new(|| {
    let mut map = HashMap::new();
    for (_, list) in VERBS {
        for word in list.split('|').filter(|w| !w.contains(' ')) {
            let f = forms(word);
            map.entry(f.past).or_insert(word);
            map.entry(f.ing).or_insert(word);
        }
    }
    for (past, word) in [
        ("took", "take"),
        ("taking", "take"),
        ("brought", "bring"),
        ("put", "put"),
        ("putting", "put"),
        ("got", "get"),
        ("made", "make"),
        ("making", "make"),
        ("drove", "drive"),
        ("spun", "spin"),
        ("swung", "swing"),
        ("slid", "slide"),
        ("gave", "give me"),
        ("left", "leave"),
        ("kept", "keep"),
        ("threw", "throw"),
        ("taken", "take"),
        ("thrown", "throw"),
        ("driven", "drive"),
        ("given", "give me"),
        ("shown", "show"),
        ("swept", "sweep"),
        ("drawn", "draw"),
        ("lost", "lose"),
        ("done", "do"),
        ("removing", "remove"),
        ("getting", "get"),
    ] {
        map.insert(past.to_string(), word);
    }
    map
});

/// The command of a past form or an -ing form: "removed", "moving".
pub fn command_of(word: &str) -> Option<&'static str> {
    COMMANDS.get(word).copied().filter(|c| *c != word)
}

pub fn text(t: &Token) -> &str {
    t.text.as_str()
}

pub fn is(t: Option<&Token>, list: &[&str]) -> bool {
    t.is_some_and(|t| list.contains(&t.text.as_str()))
}

/// True if the tokens begin with these words.
pub fn begins(tokens: &[Token], words: &str) -> Option<usize> {
    let mut n = 0;
    for w in words.split(' ') {
        if tokens.get(n).is_none_or(|t| t.text != w) {
            return None;
        }
        n += 1;
    }
    Some(n)
}

/// How many tokens the longest of these phrases takes at the start.
pub fn leads(tokens: &[Token], phrases: &[&str]) -> Option<usize> {
    phrases.iter().filter_map(|p| begins(tokens, p)).max()
}

/// Where one of the phrases stands first, and how many tokens it has.
pub fn find(tokens: &[Token], phrases: &[&str]) -> Option<(usize, usize)> {
    (0..tokens.len()).find_map(|i| leads(&tokens[i..], phrases).map(|n| (i, n)))
}

pub fn number(t: &Token) -> Option<i64> {
    match (&t.kind, look_up(text(t))) {
        (TokenKind::Number(v), _) if v.is_finite() && (0.0..1000.0).contains(v) => Some(v.round() as i64),
        (_, Some(Sense::Count(c))) if c.is_exact() => Some(i64::from(c.n)),
        _ => None,
    }
}

pub fn is_unit(t: Option<&Token>) -> bool {
    t.is_some_and(|t| matches!(look_up(text(t)), Some(Sense::Unit(_))))
}

/// How many tokens a unit of length takes here: "m", "car lengths".
pub fn unit_at(tokens: &[Token]) -> Option<usize> {
    (1..=2.min(tokens.len())).rev().find(|n| {
        let words: Vec<&str> = tokens[..*n].iter().map(text).collect();
        matches!(look_up(&words.join(" ")), Some(Sense::Unit(_)))
    })
}

/// The longest run from here that the lexicon knows.
pub fn longest(tokens: &[Token]) -> Option<(Sense, usize)> {
    (1..=6.min(tokens.len())).rev().find_map(|n| {
        let run = &tokens[..n];
        if !run.iter().all(|t| matches!(t.kind, TokenKind::Word)) {
            return None;
        }
        let words: Vec<&str> = run.iter().map(text).collect();
        look_up(&words.join(" ")).map(|s| (s, n))
    })
}

/// One past the noun that begins here.
pub fn noun_at(tokens: &[Token]) -> Option<usize> {
    if unit_at(tokens).is_some() {
        return None; // "car lengths"
    }
    // "car park" is a place
    if matches!(longest(tokens), Some((Sense::Place(..), n)) if n > 1) {
        return None;
    }
    (1..=4.min(tokens.len())).rev().find(|n| {
        let run = &tokens[..*n];
        let words: Vec<&str> = run.iter().map(text).collect();
        run.iter().all(|t| t.kind == TokenKind::Word)
            && matches!(look_up(&words.join(" ")), Some(Sense::Noun(..)))
    })
}

/// True if "to", "onto" or "into" a place or thing begins here: "to the left pavement", not "to the left of it".
pub fn is_goal(tokens: &[Token]) -> bool {
    if !is(tokens.first(), &["to", "onto", "into"]) {
        return false;
    }
    let from = 1 + usize::from(is(tokens.get(1), &["the", "my", "our", "a", "that"]));
    if matches!(tokens.get(from..).and_then(longest), Some((Sense::Place(..), _))) {
        return true;
    }
    !matches!(longest(tokens), Some((Sense::Rel(_) | Sense::EgoRel(_), n)) if n > 1)
}

/// The first noun with those that follow it directly: first token and one past the last.
pub fn first_noun(tokens: &[Token]) -> Option<(usize, usize)> {
    let from = (0..tokens.len()).find(|i| noun_at(&tokens[*i..]).is_some())?;
    let mut end = from + noun_at(&tokens[from..])?;
    while let Some(n) = tokens.get(end..).and_then(noun_at) {
        end += n;
    }
    Some((from, end))
}

pub fn has_noun(tokens: &[Token]) -> bool {
    first_noun(tokens).is_some()
}

/// True if a place, a direction or a distance begins here.
pub fn is_place(tokens: &[Token]) -> bool {
    let Some(first) = tokens.first() else {
        return false;
    };
    if number(first).is_some() && is(tokens.get(1), &["lane", "lanes"]) {
        return true; // "one lane to the left"
    }
    if number(first).is_some() && (is_unit(tokens.get(1)) || tokens.get(1..).and_then(unit_at).is_some()) {
        return true;
    }
    if matches!(
        text(first),
        "to" | "onto"
            | "into"
            | "until"
            | "till"
            | "over"
            | "back"
            | "forward"
            | "forwards"
            | "backwards"
            | "closer"
            | "nearer"
            | "further"
            | "farther"
            | "away"
            | "up"
            | "down"
            | "left"
            | "right"
            | "by"
            | "off"
            | "out"
            | "half"
            | "halfway"
            | "along"
    ) {
        return true;
    }
    matches!(
        longest(tokens),
        Some((
            Sense::Rel(_)
                | Sense::EgoRel(_)
                | Sense::In
                | Sense::At
                | Sense::Across
                | Sense::FarSide
                | Sense::Fixed(..)
                | Sense::Possessed(_)
                | Sense::BothSides(_),
            _
        ))
    )
}

pub fn word(w: &str, at: &Token) -> Token {
    Token {
        kind: TokenKind::Word,
        text: w.to_string(),
        span: at.span,
    }
}

/// Words, then the tokens.
pub fn led(words: &str, at: &Token, parts: &[&[Token]]) -> Vec<Token> {
    let mut out: Vec<Token> = words.split(' ').map(|w| word(w, at)).collect();
    parts.iter().for_each(|p| out.extend_from_slice(p));
    out
}

/// Small words and marks cut off both ends.
pub fn trimmed(mut tokens: &[Token]) -> &[Token] {
    let small = |t: &Token| {
        matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop)
            || matches!(
                text(t),
                "and"
                    | "then"
                    | "but"
                    | "please"
                    | "pls"
                    | "plz"
                    | "thanks"
                    | "so"
                    | "also"
                    | "ok"
                    | "okay"
                    | "now"
                    | "while"
                    | "whereas"
            )
    };
    while let Some((first, rest)) = tokens.split_first()
        && small(first)
    {
        tokens = rest;
    }
    while let Some((last, rest)) = tokens.split_last()
        && (small(last) || text(last) == "instead" && rest.len() > 2)
    {
        tokens = rest;
    }
    tokens
}
