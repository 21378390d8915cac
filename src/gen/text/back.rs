//! Words of a command that point back to the command before: "swap the truck for a digger, then put two cones behind it".

use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::words::edits::Verb;

fn nouns(tokens: &[Token]) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let n = (1..=4.min(tokens.len() - i)).rev().find(|n| {
            let run: Vec<&str> = tokens[i..i + n].iter().map(|t| t.text.as_str()).collect();
            matches!(look_up(&run.join(" ")), Some(Sense::Noun(noun, _)) if noun.classes.len() < 8)
        });
        match n {
            Some(n) => {
                out.push((i, i + n));
                i += n;
            }
            None => i += 1,
        }
    }
    out
}

/// What a later "it" means after this command: what came in the place of something, else what it is about.
pub fn named(tokens: &[Token], verb: Option<Verb>) -> Option<Vec<Token>> {
    let all = nouns(tokens);
    let (from, to) = match verb {
        Some(Verb::Replace) => all.last(),
        _ => all.first(),
    }?;
    Some(tokens[*from..*to].to_vec())
}

fn is_number(t: &Token) -> bool {
    matches!(t.kind, TokenKind::Number(_))
        || matches!(look_up(&t.text), Some(Sense::Count(c)) if c.is_exact())
}

/// The tokens with "it", "them" and "another one" as what was named before.
pub fn resolved(tokens: &[Token], verb_words: usize, before: Option<&Vec<Token>>) -> Vec<Token> {
    let Some(noun) = before else {
        return tokens.to_vec();
    };
    let own = nouns(tokens);
    let mut out = tokens.to_vec();
    let the = |at: &Token| Token {
        kind: TokenKind::Word,
        text: "the".into(),
        span: at.span,
    };
    let here = |at: &Token| -> Vec<Token> {
        noun.iter()
            .map(|t| Token {
                span: at.span,
                ..t.clone()
            })
            .collect()
    };
    let pronoun = (verb_words..tokens.len())
        .find(|i| matches!(tokens[*i].text.as_str(), "it" | "him" | "her" | "them"));
    if let Some(i) = pronoun {
        let first = own.first().is_none_or(|n| i < n.0);
        // "turn it to night" is about the scene
        let scene = own.is_empty()
            && tokens[i].text == "it"
            && tokens[i + 1..]
                .iter()
                .any(|t| matches!(look_up(&t.text), Some(Sense::Time(_) | Sense::Weather(_))));
        if (first || own.len() == 1) && !scene {
            let mut new = vec![the(&tokens[i])];
            new.extend(here(&tokens[i]));
            out.splice(i..=i, new);
        }
        return out;
    }
    if !own.is_empty() {
        return out;
    }
    // "take one off", "another one on the left", "two more behind me"
    let unit = |i: usize| {
        tokens
            .get(i)
            .is_some_and(|t| matches!(look_up(&t.text), Some(Sense::Unit(_))))
    };
    let number = (verb_words..tokens.len())
        .find(|i| (is_number(&tokens[*i]) || tokens[*i].text == "another") && !unit(i + 1));
    if let Some(i) = number {
        let mut to = i + 1;
        while tokens.get(to).is_some_and(|t| {
            matches!(
                t.text.as_str(),
                "more" | "one" | "of" | "them" | "others" | "extra" | "additional"
            )
        }) {
            to += 1;
        }
        let kept: Vec<Token> = tokens[i..to]
            .iter()
            .filter(|t| {
                !matches!(t.text.as_str(), "of" | "them")
                    && (t.text != "one" || is_number(&tokens[i]) && tokens[i].text == "one")
            })
            .cloned()
            .collect();
        let mut new = kept;
        new.extend(here(&tokens[i]));
        out.splice(i..to, new);
    }
    out
}
