//! Questions with their answers: "Who is blocking the junction? A lorry is." is "a lorry is blocking the junction".

use super::ellipsis::{is_noun, number};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, word};

const WHO: &str = "who|what|who or what|what else|who else|which vehicle|what vehicle|which vehicles|what vehicles|what kind of vehicle|what sort of vehicle|which road user|which road users|and what|and who|so what|so who";
const WHERE: &str = "where is|where are|where was|where were|wheres|and where is|and where are";
const HOW_MANY: &str = "how many|and how many";
const IT_IS: &str =
    "it is|its|that is|thats|it was|that was|those are|these are|they are|there is|there are|theres|well|oh";
const HELPS: &str = "is|are|does|do|was|were|has|have|did";

/// A text whose answers say in full what was asked.
pub fn in_full(tokens: &[Token]) -> Vec<Token> {
    let sentences: Vec<&[Token]> = tokens.split_inclusive(|t| t.kind == TokenKind::Stop).collect();
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < sentences.len() {
        match sentences.get(i + 1).and_then(|a| answered(sentences[i], a)) {
            Some(both) => {
                out.extend(both);
                i += 2;
            }
            None => {
                out.extend_from_slice(sentences[i]);
                i += 1;
            }
        }
    }
    out
}

fn answered(question: &[Token], answer: &[Token]) -> Option<Vec<Token>> {
    let (end, asked) = question.split_last().filter(|(l, _)| l.kind == TokenKind::Stop)?;
    // "what a day!" asks nothing
    let exclaims = asked.first().is_some_and(|t| t.text == "what")
        && asked
            .get(1)
            .is_some_and(|t| matches!(t.text.as_str(), "a" | "an"));
    if exclaims {
        return None;
    }
    if let Some(told) = yes_or_no(asked, answer).or_else(|| placed(asked, end, answer)) {
        return Some(told);
    }
    let stop = answer
        .iter()
        .position(|t| t.kind == TokenKind::Stop)
        .unwrap_or(answer.len());
    let mut from = 0;
    while let Some(n) = begins(&answer[from..stop], IT_IS) {
        from += n + usize::from(answer.get(from + n).is_some_and(|t| t.kind == TokenKind::Comma));
    }
    // what the answer adds after its first phrase stands for itself
    let cut = (from..stop)
        .find(|k| answer[*k].kind != TokenKind::Word && !matches!(answer[*k].kind, TokenKind::Number(_)))
        .unwrap_or(stop);
    let mut said = &answer[from..cut];
    while said.len() > 1 && said.last().is_some_and(|t| HELPS.split('|').any(|h| h == t.text)) {
        said = &said[..said.len() - 1];
    }
    let rest = &answer[cut..];
    let first = said.first()?;
    if let Some(n) = begins(asked, WHERE).filter(|n| asked.len() > *n) {
        let placed = super::rephrase::is_place_word(first)
            || number(first).is_some()
            || begins(said, "in|on|at|to").is_some();
        return placed
            .then(|| {
                [
                    &asked[n..],
                    &[word(asked[n - 1].text.trim_start_matches("wheres"), first)],
                    said,
                    rest,
                ]
                .concat()
            })
            .map(|mut all| {
                if all[asked.len() - n].text.is_empty() {
                    all[asked.len() - n].text = "is".into();
                }
                all
            });
    }
    if let Some(n) = begins(asked, HOW_MANY) {
        let many = number(first).is_some() || matches!(first.text.as_str(), "none" | "no");
        let noun = asked.get(n..).is_some_and(|a| a.iter().take(3).any(is_noun));
        let alone = said.len() <= 2;
        return (many && noun && alone).then(|| [&said[..1], &asked[n..], rest].concat());
    }
    let n = begins(asked, WHO).filter(|n| asked.len() > *n)?;
    let named = said.iter().any(is_noun) || begins(said, "nobody|nothing|no one|noone").is_some();
    let fresh = matches!(
        first.text.as_str(),
        "a" | "an"
            | "the"
            | "another"
            | "nobody"
            | "nothing"
            | "no"
            | "our"
            | "my"
            | "some"
            | "just"
            | "only"
    ) || number(first).is_some();
    (named && fresh && said.len() <= 12).then(|| [said, &asked[n..], rest].concat())
}

/// "Is there a truck? Yes, behind us.": there is a truck, behind us.
fn yes_or_no(asked: &[Token], answer: &[Token]) -> Option<Vec<Token>> {
    let lead = begins(
        asked,
        "is there|are there|is there any|are there any|do we see|do we have|and is there|and are there",
    )?;
    let thing = asked
        .get(lead..)
        .filter(|t| t.iter().any(is_noun) || begins(t, "anything|anyone|anybody").is_some())?;
    if let Some(n) = begins(
        answer,
        "yes|yeah|yep|indeed|sure|yes there is|yes there are|yes indeed",
    ) {
        let comma = answer.get(n).is_some_and(|t| t.kind == TokenKind::Comma);
        // "yes, a bus": what the answer names itself is told by it
        let named = answer.get(n + 1..).is_some_and(|a| a.iter().take(4).any(is_noun));
        return (!named).then(|| {
            let mut out: Vec<Token> = ["there", "is"].map(|w| word(w, &answer[0])).to_vec();
            out.extend_from_slice(thing);
            out.extend_from_slice(
                &answer[n + usize::from(
                    comma && answer.get(n + 1).is_some_and(super::rephrase::is_place_word),
                )..],
            );
            out
        });
    }
    let n = begins(
        answer,
        "no|none|nope|not at all|no there is not|no there isnt|no there are not|no there arent",
    )?;
    let rest = answer.get(n..)?;
    rest.first().is_none_or(|t| t.kind != TokenKind::Word).then(|| {
        let mut out: Vec<Token> = ["there", "is", "no"].map(|w| word(w, &answer[0])).to_vec();
        let article = begins(thing, "a|an|any").unwrap_or(0);
        out.extend_from_slice(&thing[article..]);
        out.extend_from_slice(rest);
        out
    })
}

/// "And to the right? Four cars.": to the right: four cars.
fn placed(asked: &[Token], end: &Token, answer: &[Token]) -> Option<Vec<Token>> {
    const WORDS: &str = "on|in|at|to|the|left|right|behind|ahead|front|of|us|me|side|our|my|lane|pavement|sidewalk|kerb|curb|road|street|hand|oncoming|junction|crossing|zebra|car|park|and";
    let lead = begins(
        asked,
        "and|what about|how about|and what about|and what is|what is",
    )
    .unwrap_or(0);
    let place = asked.get(lead..).filter(|p| !p.is_empty() && p.len() <= 7)?;
    let first = begins(place, "on|in|at|to|behind|ahead").is_some();
    let only = place.iter().all(|t| WORDS.split('|').any(|w| w == t.text));
    let fresh = answer.first().is_some_and(|t| {
        number(t).is_some() || matches!(t.text.as_str(), "a" | "an" | "no" | "nothing" | "nobody")
    });
    (first && only && fresh && lead < asked.len()).then(|| {
        let mark = Token {
            kind: TokenKind::Mark,
            ..word(":", end)
        };
        [place, &[mark], answer].concat()
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn answers_say_what_was_asked() {
        let said = |t: &str| {
            let list: Vec<String> = in_full(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("Who is blocking the junction? A lorry is."),
            "a lorry is blocking the junction ."
        );
        assert_eq!(
            said("What is behind us? A van, and a bus follows it."),
            "behind us : a van , and a bus follows it ."
        );
        assert_eq!(said("Where is the bus? 20 m ahead."), "the bus is 20 m ahead .");
        assert_eq!(
            said("How many cars are parked? Three."),
            "three cars are parked ."
        );
        assert_eq!(said("And to the right? Four cars."), "to the right : four cars .");
        assert_eq!(
            said("Is there a truck? Yes, behind us."),
            "there is a truck behind us ."
        );
        assert_eq!(said("Is there a bus? No."), "there is no bus .");
        assert_eq!(said("What a day! A bus comes."), "what a day . a bus comes .");
    }
}
