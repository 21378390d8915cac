//! What only says that nothing else changes: "everything else as it is", "same thing again, only", "leave the objects alone".

use super::super::tokens::{Token, TokenKind};
use super::words::{begins, find, has_noun, is, leads, trimmed};

const LEADS: &[&str] = &[
    "with",
    "and",
    "but",
    "leave",
    "keep",
    "leaving",
    "keeping",
    "while",
    "let",
    "have",
    "just",
    "please",
    "only",
    "otherwise",
];
const ALL_ELSE: &[&str] = &[
    "everything else",
    "all else",
    "all the rest",
    "the rest",
    "everything",
    "the other things",
    "the objects",
    "all objects",
    "all the objects",
    "all other things",
    "the scene",
    "the rest of the scene",
    "the other objects",
    "it all",
    "all of it",
];
const STAYS: &[&str] = &[
    "as it is",
    "as it was",
    "as is",
    "as they are",
    "just as it is",
    "exactly as it is",
    "just as they are",
    "exactly as they are",
    "the way it is",
    "the way they are",
    "the way it was",
    "untouched",
    "unchanged",
    "alone",
    "the same",
    "exactly the same",
    "in place",
    "where it is",
    "where they are",
    "as before",
    "like it is",
    "like before",
    "the same as before",
    "intact",
    "put",
    "in its place",
    "as it stands",
    "equal",
    "unaltered",
];
const BE: &[&str] = &[
    "is",
    "are",
    "be",
    "being",
    "stays",
    "stay",
    "remains",
    "remain",
    "should",
    "must",
    "shall",
    "to",
    "staying",
    "remaining",
    "may",
    "can",
    "just",
    "exactly",
    "left",
    "kept",
];
const NOTHING: &[&str] = &[
    "nothing else changes",
    "nothing else should change",
    "nothing else changed",
    "nothing else needs to change",
    "nothing else",
    "no other changes",
    "no other change",
    "without changing anything else",
    "without any other changes",
    "otherwise the same",
    "otherwise unchanged",
    "otherwise identical",
    "dont change anything else",
    "do not change anything else",
    "dont touch anything else",
    "do not touch anything else",
    "dont change the objects",
    "do not change the objects",
    "dont touch the objects",
    "do not touch the objects",
    "dont move anything",
    "do not move anything",
    "dont change the rest",
    "dont alter the objects",
    "dont change the cars or people",
    "dont move the objects",
    "dont touch the rest",
    "leave it at that",
    "nobody missing",
    "no one missing",
    "nothing missing",
    "nobody added",
    "nothing added",
    "nothing removed",
    "nobody gone",
    "nothing besides",
    "nothing more",
    "nothing but that",
    "nobody else",
    "no one else",
    "no others",
    "no other",
    "only those",
    "only them",
    "only these",
    "thats all",
    "that is all",
    "thats it",
    "that is it",
    "and thats that",
    "not one more",
    "not one less",
    "no more and no less",
    "no more no less",
    "the objects stay",
    "everything else stays",
];
const SAME: &[&str] = &[
    "the same thing",
    "same thing",
    "the same scene",
    "same scene",
    "the same picture",
    "same picture",
    "the same situation",
    "same situation",
    "the same again",
    "same again",
    "same as before",
    "the same as before",
    "all the same",
    "same layout",
    "the same layout",
    "the same",
];

fn edge(t: Option<&Token>) -> bool {
    t.is_none_or(|t| t.kind != TokenKind::Word)
}

/// "neither the van nor the people should be touched".
fn neither(tokens: &[Token]) -> Option<usize> {
    is(tokens.first(), &["neither"]).then_some(())?;
    let (i, n) = find(
        tokens,
        &[
            "be touched",
            "be changed",
            "be moved",
            "be altered",
            "be affected",
            "change",
            "changes",
            "move",
            "be removed",
            "be harmed",
            "be disturbed",
        ],
    )?;
    let end = i + n;
    (find(&tokens[..i], &["nor"]).is_some() && edge(tokens.get(end))).then_some(end)
}

/// "stays", "remains": what follows says only that nothing changes.
pub fn stands_still(t: &Token) -> bool {
    is(
        Some(t),
        &[
            "stays",
            "stay",
            "stayed",
            "remains",
            "remain",
            "remained",
            "staying",
            "remaining",
        ],
    )
}

/// How many tokens of such a phrase begin here.
fn phrase(tokens: &[Token]) -> Option<usize> {
    if let Some(n) = neither(tokens) {
        return Some(n);
    }
    let mut n = 0;
    while is(tokens.get(n), LEADS) {
        n += 1;
    }
    if let Some(m) = leads(&tokens[n..], NOTHING).filter(|m| edge(tokens.get(n + m))) {
        return Some(n + m);
    }
    let mut k = n + leads(&tokens[n..], ALL_ELSE)?;
    while is(tokens.get(k), BE) {
        k += 1;
    }
    // "but keep everything else"
    let kept = is(
        tokens.get(n.wrapping_sub(1)),
        &["keep", "leave", "let", "keeping", "leaving"],
    ) && leads(
        &tokens[n..],
        &[
            "everything else",
            "all else",
            "all the rest",
            "the rest",
            "the other things",
        ],
    )
    .is_some_and(|m| n + m == k)
        && edge(tokens.get(k));
    if kept {
        return Some(k);
    }
    let stays = leads(&tokens[k..], STAYS).map(|m| k + m).or_else(|| {
        is(
            tokens.get(k.checked_sub(1)?),
            &["stays", "stay", "remains", "remain"],
        )
        .then_some(k)
    })?;
    edge(tokens.get(stays)).then_some(stays)
}

/// The sentence without such phrases; empty if it was nothing else.
pub fn cut(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    let mut cut = false;
    while i < tokens.len() {
        let open = i == 0 || tokens[i - 1].kind != TokenKind::Word || is(tokens.get(i), LEADS);
        match phrase(&tokens[i..]).filter(|_| open) {
            // ("leave everything as it is" may part a list of commands, too)
            Some(n) => {
                cut = true;
                i += n;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    if let Some(n) = leads(&out, SAME) {
        let rest = trimmed(&out[n..]);
        let again = begins(rest, "again").unwrap_or(0);
        let rest = trimmed(&rest[again..]);
        let only = leads(
            rest,
            &["only", "but", "just", "except", "this time", "only this time"],
        );
        if let Some(m) = only {
            return trimmed(&rest[m..]).to_vec();
        }
    }
    if cut {
        // "everything stays as it is, only the lorry becomes a coach"
        let rest = trimmed(&out);
        let only = leads(
            rest,
            &[
                "only that",
                "except that",
                "just that",
                "save that",
                "but that",
                "except",
                "only",
                "just",
                "with the exception that",
                "other than that",
            ],
        )
        .filter(|n| {
            super::words::first_noun(&rest[*n..]).is_some_and(|x| {
                x.0 < 5
                    && rest[n + x.1..].iter().any(|t| {
                        super::words::is_finite(super::words::text(t), true)
                            && !is(Some(t), &["stay", "stays", "remain", "remains"])
                            || is(Some(t), &["should", "must", "is", "shall"])
                    })
            })
        });
        trimmed(&rest[only.unwrap_or(0)..]).to_vec()
    } else {
        tokens.to_vec()
    }
}

/// "leave the car behind me as it is": whom it speaks of.
pub fn stays(tokens: &[Token]) -> Option<&[Token]> {
    const SO: &[&str] = &[
        "as it is",
        "as they are",
        "where it is",
        "where they are",
        "untouched",
        "unchanged",
        "alone",
        "in place",
        "in peace",
        "as it was",
        "where it stands",
        "where they stand",
        "as he is",
        "as she is",
        "where he is",
        "where she is",
        "the way it is",
        "the way they are",
        "be",
        "stay",
        "in its place",
        "in their place",
    ];
    if !is(tokens.first(), &["leave", "keep", "let"]) {
        return None;
    }
    let (i, n) = find(tokens, SO)?;
    (i > 1 && i + n == tokens.len() && has_noun(&tokens[1..i])).then(|| &tokens[1..i])
}
