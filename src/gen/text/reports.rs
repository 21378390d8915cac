//! How reports, forms and notes word things: "said vehicle", "Position: behind us", "Witness: I was ...", "road right side",
//! "passengers, six in number".

use super::ellipsis::{ends, is_noun, number};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, rewritten, word};

/// A prompt without the manners of reports.
pub fn plain(tokens: &[Token]) -> Vec<Token> {
    let tokens = replaced(
        tokens,
        "same lane as ours|same lane as mine|the same lane as ours|the same lane as mine",
        "our lane",
    );
    let out = said_before(&tokens);
    let out = none_there(&lane_is(&fields(&without_speaker(&out))));
    let out = sides_of_road(&out);
    in_number(&out)
}

/// "said vehicle", "the aforementioned van": the one that was named.
fn said_before(tokens: &[Token]) -> Vec<Token> {
    const SAID: &str = "the said|the aforementioned|the aforesaid|the above mentioned|the abovementioned|the above named|the afore mentioned|the before mentioned|the latter|aforementioned|aforesaid";
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], SAID)
            .or_else(|| begins(&tokens[i..], "said"))
            .filter(|n| tokens.get(i + n).is_some_and(is_noun))
            // ("the driver said cars were there": a verb after its subject)
            .filter(|n| {
                *n > 1
                    || out.last().is_none_or(|t| {
                        !is_noun(t) && !matches!(t.text.as_str(), "i" | "he" | "she" | "they" | "it" | "who")
                    })
            })?;
        out.push(word("the", &tokens[i]));
        Some(i + n)
    })
}

/// "Witness: I was behind a bus": who speaks is not in the scene.
fn without_speaker(tokens: &[Token]) -> Vec<Token> {
    const WHO: &str = "witness|the witness|witness one|witness two|first witness|second witness|driver|the driver|ego driver|statement|statement of the driver|statement of the witness|passenger|the passenger|instructor|driving instructor|the instructor|examiner|driving examiner|teacher|pupil|learner|officer|police officer|the officer|caller|dispatcher|reporter|customer|client|tester|test engineer|engineer|narrator|commentator|radio|dispatch|user|me";
    let mut out: Vec<Token> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let n = begins(sentence, WHO).filter(|n| sentence.get(*n).is_some_and(|t| t.text == ":"));
        // ("Driver: none" is a field)
        let speaks = n.filter(|n| {
            let quote = sentence
                .get(n + 1)
                .is_some_and(|t| matches!(t.text.as_str(), "\"" | "“" | "”" | "*"));
            let first = begins(
                &sentence[n + 1..],
                "i|we|my|our|there|the|in|on|behind|ahead|a|an",
            )
            .is_some();
            let us = sentence
                .iter()
                .any(|t| matches!(t.text.as_str(), "i" | "we" | "me" | "us" | "my" | "our"));
            quote || first && us
        });
        out.extend_from_slice(&sentence[speaks.map_or(0, |n| n + 1)..]);
    }
    out
}

/// "1 van. Position: behind us.": what a form says in a field of its own is said of what it named last.
fn fields(tokens: &[Token]) -> Vec<Token> {
    const FIELD: &str = "position|location|place|placement|whereabouts|state|status|heading|direction|distance|orientation|lane|its position|its location|its lane|its heading|its distance|motion|movement|travel direction|direction of travel";
    rewritten(tokens, |i, out| {
        let field = (out
            .last()
            .is_some_and(|t| matches!(t.kind, TokenKind::Stop | TokenKind::Comma)))
        .then(|| begins(&tokens[i..], FIELD))
        .flatten()
        .filter(|n| tokens.get(i + n).is_some_and(|t| t.text == ":"));
        let before = out[..out.len().saturating_sub(1)]
            .rsplit(|t| t.kind == TokenKind::Stop)
            .next()
            .is_some_and(|s| s.iter().any(is_noun));
        let told = field.is_some_and(|n| {
            tokens.get(i + n + 1).is_some_and(|t| {
                super::rephrase::is_place_word(t)
                    || number(t).is_some()
                    || matches!(look_up(&t.text), Some(Sense::State(..) | Sense::Place(..)))
            })
        });
        let n = field.filter(|_| before && told)?;
        if let Some(last) = out.last_mut() {
            *last = Token {
                kind: TokenKind::Comma,
                ..word(",", &tokens[i])
            };
        }
        Some(i + n + 1)
    })
}

/// "My lane: blocked by a fence.": my lane is blocked.
fn lane_is(tokens: &[Token]) -> Vec<Token> {
    const IS: &str = "blocked|closed|obstructed|free|empty|clear|deserted|occupied|taken|crowded|barred|shut";
    let mut out: Vec<Token> = Vec::new();
    let mut opened = 0;
    for (i, t) in tokens.iter().enumerate() {
        let place = t.text == ":"
            && (1..=4).contains(&(out.len() - opened))
            && out.last().is_some_and(|b| {
                matches!(look_up(&b.text), Some(Sense::Place(..))) || b.text.ends_with("lane")
            })
            && tokens
                .get(i + 1)
                .is_some_and(|n| begins(std::slice::from_ref(n), IS).is_some());
        if place {
            let many = out.last().is_some_and(|b| b.text.ends_with('s'));
            out.push(word(if many { "are" } else { "is" }, t));
        } else {
            out.push(t.clone());
        }
        if t.kind == TokenKind::Stop {
            opened = out.len();
        }
    }
    out
}

/// "Vehicle left: none.": no vehicle on the left.
fn none_there(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let colon = sentence
            .iter()
            .position(|t| t.text == ":")
            .filter(|k| (2..=6).contains(k));
        let none = colon.filter(|k| {
            begins(&sentence[k + 1..], "none|nil|zero|0|no|nobody|nothing").is_some()
                && ends(sentence.get(k + 2))
                && is_noun(&sentence[0])
                && !is_noun(&sentence[1])
                && !sentence[..*k].iter().any(|t| t.kind == TokenKind::Comma)
        });
        match none {
            Some(k) => {
                out.push(word("no", &sentence[0]));
                out.push(sentence[0].clone());
                let side = matches!(sentence[1].text.as_str(), "left" | "right")
                    .then(|| ["on", "the"].map(|w| word(w, &sentence[1])));
                out.extend(side.into_iter().flatten());
                out.extend_from_slice(&sentence[1..k]);
                out.extend_from_slice(&sentence[k + 2..]);
            }
            None => out.extend_from_slice(sentence),
        }
    }
    out
}

/// "road right side": the right side of the road.
fn sides_of_road(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let opens = out.last().is_none_or(|t| {
            t.kind != TokenKind::Word
                || matches!(
                    t.text.as_str(),
                    "and" | "on" | "at" | "the" | "is" | "are" | "parked"
                )
        });
        let found = begins(&tokens[i..], "road|street")
            .filter(|_| opens)
            .zip(
                tokens
                    .get(i + 1)
                    .filter(|t| matches!(t.text.as_str(), "left" | "right")),
            )
            .zip(tokens.get(i + 2).filter(|t| {
                matches!(
                    t.text.as_str(),
                    "side" | "edge" | "kerb" | "curb" | "shoulder" | "verge"
                )
            }));
        let Some(((_, side), what)) = found else {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        };
        let led = out
            .iter()
            .rev()
            .take(2)
            .any(|t| matches!(t.text.as_str(), "on" | "at"));
        if !led {
            out.push(word("on", &tokens[i]));
        }
        if out.last().is_none_or(|t| t.text != "the") {
            out.push(word("the", &tokens[i]));
        }
        out.extend([side.clone(), what.clone()]);
        out.extend(["of", "the", "road"].map(|w| word(w, &tokens[i])));
        i += 3;
    }
    out
}

/// "its passengers, six in number, wait": its six passengers.
fn in_number(tokens: &[Token]) -> Vec<Token> {
    let tokens = replaced(tokens, "totalling|totaling|numbering", "of them");
    rewritten(&tokens, |i, out| {
        let comma = out
            .last()
            .is_some_and(|t| t.kind == TokenKind::Comma || t.text == "(");
        let counted = number(&tokens[i]).is_some() && comma;
        let tail = begins(
            tokens.get(i + 1..).unwrap_or(&[]),
            "in number|strong|pieces|pcs|units|altogether|in all",
        )
        .filter(|n| counted && ends(tokens.get(i + 1 + n)));
        let noun = out.len() > 1 && is_noun(&out[out.len() - 2]);
        let n = tail.filter(|_| noun)?;
        out.pop();
        let at = out.len() - 1;
        out.insert(at, tokens[i].clone());
        let closed = tokens
            .get(i + 1 + n)
            .is_some_and(|t| t.kind == TokenKind::Comma || t.text == ")");
        Some(i + 1 + n + usize::from(closed))
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn reports_in_plain_words() {
        let said = |t: &str| {
            let list: Vec<String> = plain(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("A pickup; said vehicle was parked"),
            "a pickup . the vehicle was parked"
        );
        assert_eq!(
            said("1 van. Position: behind us, 9 m."),
            "1 van , behind us , 9 m ."
        );
        assert_eq!(
            said("Witness: \"I was behind a bus.\""),
            "\" i was behind a bus . \""
        );
        assert_eq!(
            said("Road right side parked one van"),
            "on the right side of the road parked one van"
        );
        assert_eq!(
            said("My lane: blocked by a fence."),
            "my lane is blocked by a fence ."
        );
        assert_eq!(said("Vehicle left: none."), "no vehicle on the left .");
        assert_eq!(said("cones (five pieces) stand"), "five cones stand");
        assert_eq!(
            said("its passengers, six in number, wait"),
            "its six passengers wait"
        );
    }
}
