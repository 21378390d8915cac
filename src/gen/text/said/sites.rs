//! Roadworks that end: "the roadworks are finished", "clear away the construction site", "remove everything that belongs to them".

use super::super::tokens::Token;
use super::Talk;
use super::some_of::removes;
use super::words::{is, leads, trimmed, word};
use crate::scene::Class;

/// A sentence in which they end.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = belonging(tokens, talk);
    finished(&out).unwrap_or(out)
}

/// "no roadworks", where these words stand.
fn none(tokens: &[Token]) -> Vec<Token> {
    let last = &tokens[tokens.len() - 1];
    vec![word("no", &tokens[0]), word("roadworks", last)]
}

/// "remove everything that belongs to them", of roadworks: not everything there is.
fn belonging(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let site = talk.boxes.values().any(|b| {
        matches!(
            b.class,
            Class::ConstructionVehicle | Class::TrafficCone | Class::Barrier
        )
    });
    let n = leads(
        &tokens[1.min(tokens.len())..],
        &[
            "everything that belongs to them",
            "everything that belongs to it",
            "everything belonging to them",
            "everything belonging to it",
            "everything that goes with them",
            "everything that goes with it",
            "all that belongs to them",
            "all that belongs to it",
            "everything that belongs to the roadworks",
            "everything belonging to the roadworks",
            "everything that belongs to the construction site",
        ],
    );
    match n {
        Some(n) if site && removes(tokens.first()) && trimmed(&tokens[n + 1..]).is_empty() => none(&tokens),
        _ => tokens,
    }
}

/// "the roadworks are finished, remove everything that belongs to them": they go.
pub fn finished(tokens: &[Token]) -> Option<Vec<Token>> {
    const SITES: &[&str] = &[
        "roadworks",
        "road works",
        "works",
        "construction site",
        "construction work",
        "construction works",
        "building site",
        "roadwork",
        "road work",
        "work zone",
        "repairs",
    ];
    // "remove the roadworks": all that they are made of
    let off = leads(
        tokens,
        &[
            "remove",
            "delete",
            "erase",
            "clear",
            "clear away",
            "take away",
            "take out",
            "get rid of",
            "drop",
            "do away with",
            "clear up",
            "end",
            "finish",
        ],
    );
    if let Some(n) = off
        && is(tokens.get(n), &["the", "those", "these", "all"])
        && leads(&tokens[n + 1..], SITES).is_some_and(|m| trimmed(&tokens[n + 1 + m..]).is_empty())
    {
        return Some(none(tokens));
    }
    let the = usize::from(is(tokens.first(), &["the", "those", "these", "all"]));
    let n = leads(tokens.get(the..).unwrap_or(&[]), SITES).filter(|_| the > 0)?;
    let over = leads(
        &tokens[the + n..],
        &[
            "are finished",
            "is finished",
            "are over",
            "is over",
            "are done",
            "is done",
            "have finished",
            "has finished",
            "are completed",
            "is completed",
            "have been completed",
            "has been completed",
            "have ended",
            "has ended",
            "are complete",
            "is complete",
            "have been finished",
            "has been finished",
            "are gone",
            "is gone",
            "has been cleared",
            "have been cleared",
            "has closed",
            "is closed",
        ],
    );
    let end = over.map(|m| the + n + m)?;
    let rest = trimmed(&tokens[end..]);
    let all = removes(rest.first())
        && leads(
            &rest[1..],
            &["everything", "all", "it", "them", "whatever", "away", "the lot"],
        )
        .is_some()
        && rest.len() < 8;
    (rest.is_empty() || all).then(|| none(tokens))
}
