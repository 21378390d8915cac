//! What the words of a command say of how far a second reading of it may be trusted.

use crate::generation::text::description::{Anchor, ObjectSpec, Stated};
use crate::generation::text::lexicon::{Sense, look_up};
use crate::scene::Class;
use crate::scene::graph::RelationKind;

/// How a noun is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Article {
    Definite,
    Indefinite,
    Bare,
}

/// Words that make a command more than a description.
const MORE: &[&str] = &[
    "than", "from", "no", "not", "nobody", "never", "without", "except", "but", "further", "farther",
    "closer", "nearer", "was", "were", "had", "times", "twice", "half", "double", "each", "every", "either",
    "neither",
];

/// Words that bring in one more of what is there.
const ADDS: &[&str] = &[
    "another",
    "copy",
    "copies",
    "duplicate",
    "clone",
    "more",
    "one",
    "second",
    "third",
    "fourth",
    "too",
    "also",
    "companion",
    "colleague",
    "colleagues",
    "fellow",
    "mate",
    "mates",
    "twin",
    "friend",
    "friends",
    "partner",
    "additional",
    "extra",
    "further",
    "new",
    "two",
    "three",
    "four",
    "five",
    "joins",
    "joined",
    "join",
    "company",
];

/// Turns that tell of a place by what is not named there.
const ELSEWHERE: &[&str] = &[
    "beyond",
    "far side",
    "other side",
    "'s lane",
    "one of the",
    "that lane",
    "this lane",
    "that side",
];

/// Words that deny, or tell of before.
const DENIES: &[&str] = &["was", "were", "no", "not", "never", "nobody"];

/// What the words of a command allow.
pub(super) struct Trust {
    /// They tell where things are by pronouns, by others ("on the same side as the others"), which the second reading does
    /// not know, or by "beyond".
    pub elsewhere: bool,
    /// They only describe: nothing is compared, denied or told of before.
    pub plain: bool,
    /// Something is denied.
    pub denied: bool,
    /// Some of several are picked out.
    pub only: bool,
    /// One more of what is there comes in.
    pub adds: bool,
}

impl Trust {
    /// Of the words of a command.
    pub fn of(words: &str) -> Self {
        let lower = words.to_lowercase();
        let any = |list: &[&str]| {
            lower
                .split(|c: char| !c.is_alphanumeric())
                .any(|w| list.contains(&w))
        };
        Self {
            elsewhere: ELSEWHERE.iter().any(|w| lower.contains(w))
                || lower.contains("the same ") && lower.contains(" as ")
                || points_back(&lower),
            plain: !any(MORE),
            denied: any(DENIES),
            only: any(&["only", "just", "keep", "except", "but"]),
            adds: any(ADDS),
        }
    }
}

/// Classes that the noun of an object may mean.
pub(super) fn classes(spec: &ObjectSpec) -> Vec<Class> {
    match look_up(&spec.noun) {
        Some(Sense::Noun(noun, _)) => noun.classes.to_vec(),
        _ => vec![spec.class],
    }
}

/// True where a place is told by a pronoun, which this reading does not know.
fn points_back(lower: &str) -> bool {
    let w: Vec<&str> = lower
        .split(|c: char| !c.is_alphanumeric())
        .filter(|w| !w.is_empty())
        .collect();
    let leads = |w: &str| {
        matches!(
            w,
            "near"
                | "behind"
                | "beside"
                | "to"
                | "with"
                | "by"
                | "at"
                | "around"
                | "before"
                | "after"
                | "in"
                | "on"
        )
    };
    let pronoun = |w: &str| {
        matches!(
            w,
            "it" | "him" | "her" | "them" | "one" | "itself" | "his" | "its" | "their"
        )
    };
    // ("add one in the oncoming lane": of a kind that was named before)
    let alone = |p: &[&str]| {
        matches!(p[0], "add" | "put" | "place" | "need" | "want" | "have")
            && p[1] == "one"
            && (leads(p[2]) || matches!(p[2], "ahead" | "next" | "between" | "there" | "here" | "please"))
    };
    w.windows(2).any(|p| leads(p[0]) && pronoun(p[1])) || w.windows(3).any(alone)
}

/// How an object is named in the words that it was read from.
pub(super) fn article(words: &str, spec: &ObjectSpec) -> Article {
    let own = spec.span.of(words).to_lowercase();
    let before = words.get(..spec.span.start).unwrap_or("").to_lowercase();
    let word = |w: Option<&str>| {
        w.unwrap_or("")
            .trim_matches(|c: char| !c.is_alphanumeric())
            .to_string()
    };
    let (first, last) = (
        word(own.split_whitespace().next()),
        word(before.split_whitespace().next_back()),
    );
    let is = |list: &[&str]| list.contains(&first.as_str()) || list.contains(&last.as_str());
    // ("some fool has left the trailer": the article next to the noun tells)
    if own.contains(" the ") {
        return Article::Definite;
    }
    let of = ["of the", "of our", "of those", "of these", "of my"];
    if of
        .iter()
        .any(|w| before.trim_end().ends_with(w) || own.contains(w))
    {
        return Article::Definite;
    }
    if is(&[
        "the", "that", "this", "these", "those", "our", "my", "his", "her", "its", "their", "both", "all",
    ]) {
        Article::Definite
    } else if is(&[
        "a", "an", "another", "one", "two", "three", "four", "five", "six", "second", "third", "more", "some",
    ]) || own.starts_with(|c: char| c.is_ascii_digit())
    {
        Article::Indefinite
    } else {
        Article::Bare
    }
}

/// False for what only seems to be said of us: "next to it", "behind the existing one".
pub(super) fn is_plain(words: &str, r: &Stated) -> bool {
    let said = r.span.of(words).to_lowercase();
    let ours = said
        .split(|c: char| !c.is_alphanumeric())
        .any(|w| matches!(w, "me" | "us" | "our" | "ours" | "my" | "ego" | "we" | "i"));
    let loose = matches!(
        r.relation,
        RelationKind::NextTo
            | RelationKind::Near
            | RelationKind::FarFrom
            | RelationKind::Following
            | RelationKind::Facing
            | RelationKind::FacingAway
            | RelationKind::SameDirection
    );
    // ("behind the existing one": of something else that was not found)
    let next = words
        .get(r.span.end..)
        .unwrap_or("")
        .split_whitespace()
        .next()
        .unwrap_or("")
        .to_lowercase();
    let place = said.contains("ahead") || said.contains("left") || said.contains("right");
    let other = !place
        && matches!(
            next.as_str(),
            "the"
                | "that"
                | "this"
                | "it"
                | "him"
                | "her"
                | "them"
                | "one"
                | "a"
                | "an"
                | "his"
                | "its"
                | "their"
        );
    let halved = r.relation == RelationKind::Between && r.and.is_none();
    // ("the bays are parked full" blocks nothing)
    let blocks = ["block", "obstruct", "in the way", "middle", "bar"];
    let idle =
        r.relation == RelationKind::Blocking && !blocks.iter().any(|w| words.to_lowercase().contains(w));
    !halved && !idle && !(r.anchor == Anchor::Ego && !ours && (loose || other))
}
