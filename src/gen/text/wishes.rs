//! What is wished of something in the scene, as a command: to be gone, elsewhere, something else.

use super::lexicon::{Sense, look_up};
use super::rephrase::{is_noun, is_place_word, number, sense, starts_with, with_verb};
use super::tokens::Token;

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

/// How a speaker begins a wish.
pub const SPEAKER: &[&[&str]] = &[
    &["i", "would", "like", "to", "see"],
    &["id", "like", "to", "see"],
    &["i", "want", "to", "see"],
    &["i", "would", "like", "to", "have"],
    &["id", "like", "to", "have"],
    &["i", "want", "to", "have"],
    &["i", "would", "rather", "have"],
    &["id", "rather", "have"],
    &["id", "rather", "see"],
    &["i", "would", "like"],
    &["id", "like"],
    &["i", "would", "prefer"],
    &["id", "prefer"],
    &["i", "prefer"],
    &["i", "want"],
    &["we", "want"],
    &["i", "need"],
    &["we", "need"],
    &["i", "wish", "for"],
    &["let", "me", "have"],
    &["can", "i", "have"],
    &["could", "i", "have"],
];

/// What is wished for: to be gone, elsewhere, something else, or there.
pub fn wished(wish: &[Token], first: &Token) -> Vec<Token> {
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

pub fn stated(rest: &[Token]) -> Option<Vec<Token>> {
    let first = rest.first()?;
    // "one cyclist is enough"
    let last = rest.last()?;
    if number(first).is_some()
        && !rest
            .iter()
            .any(|t| matches!(t.text.as_str(), "not" | "isnt" | "arent" | "hardly" | "never"))
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
pub fn stated_with(rest: &[Token], first: &Token) -> Option<Vec<Token>> {
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
