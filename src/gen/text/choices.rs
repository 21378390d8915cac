//! What is denied only to say what holds: "not on the right but on the left", "not one cyclist but two", "none of the three
//! cars is on the left; all of them stand on the right".

use super::ellipsis::{ends, is_noun, number};
use super::lexicon::{Sense, look_up, plural};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};

/// What a phrase begins with, so far as a choice is concerned.
#[derive(PartialEq)]
enum Kind {
    Place,
    Thing,
    State,
}

fn kind(t: &Token) -> Option<Kind> {
    if super::rephrase::is_place_word(t) || matches!(t.text.as_str(), "to" | "from" | "towards") {
        return Some(Kind::Place);
    }
    if matches!(t.text.as_str(), "a" | "an" | "the" | "my" | "our") || number(t).is_some() || is_noun(t) {
        return Some(Kind::Thing);
    }
    matches!(look_up(&t.text), Some(Sense::State(..))).then_some(Kind::State)
}

/// A prompt that says only what holds.
pub fn made(tokens: &[Token]) -> Vec<Token> {
    not_but(&none_of(&not_only(tokens)))
}

/// "not only a bus but also a truck": a bus and a truck.
fn not_only(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut open = false;
    let mut i = 0;
    while i < tokens.len() {
        open &= tokens[i].kind != TokenKind::Stop;
        if let Some(n) = begins(&tokens[i..], "not only|not just|not merely").filter(|n| {
            tokens[i + n..]
                .iter()
                .take(16)
                .take_while(|t| t.kind != TokenKind::Stop)
                .any(|t| t.text == "but")
        }) {
            open = true;
            i += n;
            continue;
        }
        match begins(&tokens[i..], "but also|but as well|but|also").filter(|_| open) {
            Some(n) => {
                if tokens[i].text == "but" {
                    while out.last().is_some_and(|t| t.kind == TokenKind::Comma) {
                        out.pop();
                    }
                    out.push(word("and", &tokens[i]));
                    open = false;
                }
                i += n;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "not X but Y": Y.
fn not_but(tokens: &[Token]) -> Vec<Token> {
    const FARTHEST: usize = 9;
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let but = (tokens[i].text == "not")
            .then(|| {
                let from = i + 1;
                let near = tokens.len().min(from + FARTHEST);
                let but = (from..near)
                    .take_while(|k| tokens[*k].kind != TokenKind::Stop)
                    .find(|k| tokens[*k].text == "but")?;
                let inner = but - usize::from(tokens[but - 1].kind == TokenKind::Comma);
                let plain = tokens[from..inner].iter().all(|t| t.kind != TokenKind::Comma);
                let chosen = kind(tokens.get(but + 1)?)?;
                // "not parked on the left but on the right": parked, and on the right
                let kept = (from..inner).find(|k| kind(&tokens[*k]).as_ref() == Some(&chosen))?;
                let state = tokens[from..kept].iter().all(|t| kind(t) == Some(Kind::State));
                (inner > from && plain && state).then_some((kept, but))
            })
            .flatten();
        let Some((kept, but)) = but else {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        };
        let denied = &tokens[kept..but];
        out.extend_from_slice(&tokens[i + 1..kept]);
        i = but + 1;
        // "not one cyclist but two": two cyclists
        let many = tokens.get(i).and_then(number);
        let bare = tokens.get(i + 1).is_none_or(|t| {
            ends(Some(t))
                || !is_noun(t) && !matches!(look_up(&t.text), Some(Sense::State(_, false) | Sense::Color(_)))
        });
        let noun = denied.iter().rev().find(|t| is_noun(t)).filter(|_| bare);
        if let (Some(n), Some(noun)) = (many, noun) {
            out.push(tokens[i].clone());
            let single = super::names::singular(&noun.text).to_string();
            out.push(word(&if n == 1 { single } else { plural(&single) }, &tokens[i]));
            i += 1;
        }
    }
    out
}

/// "none of the three cars is on the left": there are three cars.
fn none_of(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let clause = begins(
            &tokens[i..],
            "none of the|none of these|none of those|not one of the|not a single one of the",
        )
        .and_then(|n| {
            let end = (i + n..tokens.len()).find(|k| ends(tokens.get(*k)) || tokens[*k].text == "but")?;
            let verb = (i + n..end).find(|k| {
                begins(
                    &tokens[*k..],
                    "is|are|was|were|stands|stand|has|have|drives|drive|waits|wait|walks|walk",
                )
                .is_some()
            })?;
            // who they are is told, and where they are comes next
            let next = &tokens[end..tokens.len().min(end + 3)];
            let goes_on = next.iter().any(|t| {
                matches!(
                    t.text.as_str(),
                    "all" | "they" | "each" | "every" | "instead" | "rather" | "both" | "but"
                )
            });
            (tokens[i + n..verb].iter().any(is_noun) && goes_on).then_some((i + n, verb, end))
        });
        let (from, verb, end) = clause?;
        out.extend(["there", "are"].map(|w| word(w, &tokens[i])));
        out.extend_from_slice(&tokens[from..verb]);
        Some(end)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn what_holds() {
        let said = |t: &str| {
            let list: Vec<String> = made(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("The lorry is parked not on the right but on the left."),
            "the lorry is parked on the left ."
        );
        assert_eq!(
            said("There is not one cyclist but two."),
            "there is two cyclists ."
        );
        assert_eq!(said("It is not a van, but a bus."), "it is a bus .");
        assert_eq!(
            said("It is not parked on the left but on the right."),
            "it is parked on the right ."
        );
        assert_eq!(said("not only a van but also a bus"), "a van and a bus");
        assert_eq!(said("not far away but a bus"), "not far away but a bus");
        assert_eq!(
            said("None of the three parked cars is on the left; all of them stand there."),
            "there are three parked cars . all of them stand there ."
        );
    }
}
