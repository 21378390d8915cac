//! People by their names: "Mrs Keller stops in her red car. She waits." is a red car that stops and waits; on foot she is a woman.

use super::ellipsis::is_noun;
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};

fn title(t: &Token) -> Option<&'static str> {
    match t.text.as_str() {
        "mr" | "mister" | "herr" | "monsieur" => Some("man"),
        "mrs" | "ms" | "miss" | "frau" | "madame" => Some("woman"),
        _ => None,
    }
}

fn is_vehicle(t: &Token) -> bool {
    matches!(look_up(&t.text), Some(Sense::Noun(n, _)) if n.classes[0].is_vehicle())
}

/// Where "in her red car" stands: first token, the noun phrase, one past it.
fn in_vehicle(tokens: &[Token]) -> Option<(usize, Vec<Token>, usize)> {
    (0..tokens.len()).find_map(|i| {
        let n = begins(
            &tokens[i..],
            "in his|in her|in their|with his|with her|in a|in an|driving his|driving her|driving a",
        )?;
        let end = (i + n..tokens.len().min(i + n + 4)).find(|k| is_vehicle(&tokens[*k]))?;
        let plain = tokens[i + n..end]
            .iter()
            .all(|t| t.kind == TokenKind::Word && !super::rephrase::is_place_word(t));
        plain.then(|| (i, tokens[i + n..=end].to_vec(), end + 1))
    })
}

/// "a man in his red car": a red car.
fn inside(tokens: &[Token]) -> Vec<Token> {
    const IN: &str = "in his|in her|in their|in a|in an|driving his|driving her|driving a|driving an|at the wheel of a|at the wheel of his|at the wheel of her|who drives a|who is driving a";
    rewritten(tokens, |i, out| {
        let person = out.len() > 1
            && matches!(look_up(&out[out.len() - 1].text), Some(Sense::Noun(n, false)) if n.classes[0] == crate::scene::Class::Pedestrian)
            && matches!(out[out.len() - 2].text.as_str(), "a" | "an" | "another" | "one");
        let (from, end) = begins(&tokens[i..], IN).filter(|_| person).and_then(|n| {
            let end = (i + n..tokens.len().min(i + n + 4)).find(|k| is_vehicle(&tokens[*k]))?;
            // ("in a car park" is a place)
            let whole = !matches!(tokens.get(end + 1), Some(t) if matches!(t.text.as_str(), "park" | "lane" | "stop" | "station" | "bay" | "rank"));
            let plain = tokens[i + n..end]
                .iter()
                .all(|t| t.kind == TokenKind::Word && !super::rephrase::is_place_word(t));
            (plain && whole).then_some((i + n, end + 1))
        })?;
        out.pop();
        out.extend_from_slice(&tokens[from..end]);
        Some(end)
    })
}

/// A prompt in which everybody with a title is what is seen of him.
pub fn seen(tokens: &[Token]) -> Vec<Token> {
    let tokens = &inside(tokens)[..];
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    // who was named last, and as what
    let mut known: Vec<(String, Vec<Token>)> = Vec::new();
    let mut driver: Option<Token> = None;
    let mut skip: Option<(usize, usize)> = None;
    while i < tokens.len() {
        if let Some((_, to)) = skip.filter(|(from, _)| *from == i) {
            skip = None;
            i = to;
            continue;
        }
        let name = tokens
            .get(i + 1)
            .filter(|t| t.kind == TokenKind::Word && !is_noun(t) && !super::rephrase::is_place_word(t));
        if let Some((person, name)) = title(&tokens[i]).zip(name) {
            if let Some((_, was)) = known.iter().find(|k| k.0 == name.text) {
                out.push(word("the", &tokens[i]));
                out.extend_from_slice(was);
            } else {
                let end = (i..tokens.len())
                    .find(|k| tokens[*k].kind == TokenKind::Stop)
                    .unwrap_or(tokens.len());
                let driven = in_vehicle(&tokens[i + 2..end]);
                let what = driven
                    .as_ref()
                    .map_or_else(|| vec![word(person, &tokens[i])], |d| d.1.clone());
                skip = driven.as_ref().map(|d| (i + 2 + d.0, i + 2 + d.2));
                driver = driven.and_then(|d| d.1.last().cloned());
                out.push(word("a", &tokens[i]));
                out.extend_from_slice(&what);
                known.push((name.text.clone(), what.last().cloned().into_iter().collect()));
            }
            i += 2;
            continue;
        }
        // "she waits there", "behind her a bus": the car
        let subject = matches!(tokens[i].text.as_str(), "she" | "he");
        let her = matches!(tokens[i].text.as_str(), "her" | "him")
            && out.last().is_some_and(|t| {
                matches!(
                    t.text.as_str(),
                    "behind"
                        | "of"
                        | "to"
                        | "beside"
                        | "after"
                        | "before"
                        | "for"
                        | "towards"
                        | "past"
                        | "follows"
                )
            })
            && !tokens.get(i + 1).is_some_and(is_noun);
        match driver.as_ref().filter(|_| subject || her) {
            Some(car) => {
                out.push(word("the", &tokens[i]));
                out.push(Token {
                    span: tokens[i].span,
                    ..car.clone()
                });
            }
            None => out.push(tokens[i].clone()),
        }
        i += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn names_are_seen_as_what_they_are() {
        let said = |t: &str| {
            let list: Vec<String> = seen(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("Mrs Keller stops at the zebra in her red car. She waits, and behind her a bus stops."),
            "a red car stops at the zebra . the car waits , and behind the car a bus stops ."
        );
        assert_eq!(
            said("Mr Li walks ahead. A bus follows Mr Li."),
            "a man walks ahead . a bus follows the man ."
        );
        assert_eq!(said("A man in his red car waits"), "a red car waits");
        assert_eq!(said("a man in a car park"), "a man in a car park");
        assert_eq!(said("a man walks with her dog"), "a man walks with her dog");
    }
}
