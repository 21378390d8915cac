//! What a sentence of commands begins with: whom it is about before the verb, ordinals, "everyone", "take it and put it".

use super::rephrase::{Rephrased, is_noun, is_place_word, is_verb, strip, word};
use super::tokens::{Token, TokenKind};

/// Words of politeness before a command.
pub const POLITE: &[&[&str]] = &[
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

/// "whatever is behind us, make it a bus" and "the car behind us: drop it": the verb first.
pub fn topic(body: &[Token]) -> Option<Vec<Token>> {
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
pub fn name_people(body: &[Token]) -> Vec<Token> {
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
pub fn take_and_put(body: &[Token]) -> Vec<Token> {
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
pub fn take_ordinals(body: &[Token], out: &mut Rephrased) -> Vec<Token> {
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

pub(super) fn ordinal(word: &str) -> Option<usize> {
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
