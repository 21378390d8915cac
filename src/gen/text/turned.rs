//! Clauses that say in another order what a plain one says: "followed at 10 m by a van", "by two cars is the bus followed",
//! "it has a car right behind it", "one to the left of it, another to the right".

use super::ellipsis::{ends, is_noun, is_unit, number};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};

const DONE: &str =
    "followed|preceded|overtaken|trailed|tailed|chased|accompanied|escorted|flanked|pursued|tailgated|led";

/// A prompt whose clauses are turned round.
pub fn round(tokens: &[Token]) -> Vec<Token> {
    let out = of_so_many(tokens);
    let out = among_them(&in_between(&out));
    let out = nearer_than(&out);
    let out = by_whom_first(&out);
    let out = followed_so_far(&out);
    let out = has_beside_it(&out);
    nearest_of_all(&side_again(&out))
}

/// "a bus, a truck and a motorcycle ahead, the motorcycle being the nearest of the three": the others are farther on.
fn nearest_of_all(tokens: &[Token]) -> Vec<Token> {
    const BE: &str = "being|is|was|with";
    const NEAREST: &str = "the nearest|the closest|nearest|closest|the nearest one|the closest one|nearest to us|closest to us|the nearest to us|the closest to us|nearest to me|closest to me";
    const FARTHEST: &str = "the farthest|the furthest|farthest|furthest|the most distant|the farthest away|the furthest away|farthest away|furthest away";
    const OF: &str = "of the two|of the three|of the four|of them|of all|of these|of those|of them all|of the lot|of all three|of the group";
    let mut out: Vec<Token> = Vec::new();
    let mut from = 0;
    let mut i = 0;
    while i < tokens.len() {
        if tokens[i].kind == TokenKind::Stop {
            from = i + 1;
        }
        let aside = (tokens[i].text == "the" && out.last().is_some_and(|t| t.kind == TokenKind::Comma))
            .then(|| {
                let noun = tokens.get(i + 1).filter(|t| is_noun(t))?;
                let be = begins(tokens.get(i + 2..)?, BE)?;
                let k = i + 2 + be;
                let near = begins(tokens.get(k..)?, NEAREST);
                let n = near.or_else(|| begins(tokens.get(k..)?, FARTHEST))?;
                let of = begins(tokens.get(k + n..)?, OF).unwrap_or(0);
                ends(tokens.get(k + n + of)).then_some((noun, near.is_some(), k + n + of))
            })
            .flatten();
        let Some((noun, near, end)) = aside else {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        };
        let ahead = tokens[from..i]
            .iter()
            .any(|t| matches!(t.text.as_str(), "ahead" | "front" | "before"));
        let ours = |k: usize| k > 0 && matches!(tokens[k - 1].text.as_str(), "ego" | "host" | "my" | "our");
        let others: Vec<&Token> = (from..i)
            .filter(|k| is_noun(&tokens[*k]) && tokens[*k].text != noun.text && !ours(*k))
            .map(|k| &tokens[k])
            .collect();
        let told = tokens[from..i].iter().any(|t| is_noun(t) && t.text == noun.text);
        if ahead && told && !others.is_empty() {
            let mut nearer = vec![noun];
            let mut farther = others;
            if !near {
                std::mem::swap(&mut nearer, &mut farther);
            }
            for (k, far) in farther.iter().enumerate() {
                if k > 0 {
                    out.push(word("and", &tokens[i]));
                }
                out.extend([
                    word("the", &tokens[i]),
                    Token {
                        span: tokens[i].span,
                        ..(*far).clone()
                    },
                ]);
            }
            out.extend(["further", "on", "than", "the"].map(|w| word(w, &tokens[i])));
            out.extend(nearer.last().map(|t| Token {
                span: tokens[i].span,
                ..(*t).clone()
            }));
        } else {
            out.pop();
        }
        i = end;
    }
    out
}

/// "a family of four walks": four people; "a group of four cars" names them.
fn of_so_many(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(
            &tokens[i..],
            "a family of|a group of|a party of|the family of|a crowd of|a team of|a gang of|a queue of",
        )
        .filter(|n| {
            let many = tokens.get(i + n).is_some_and(|t| number(t).is_some());
            let named = tokens.get(i + n + 1).is_some_and(|t| t.text == "of")
                || tokens[i + n..]
                    .iter()
                    .skip(1)
                    .take(3)
                    .take_while(|t| t.kind == TokenKind::Word && !super::rephrase::is_place_word(t))
                    .any(is_noun);
            many && !named
        })?;
        out.push(tokens[i + n].clone());
        out.push(word("people", &tokens[i]));
        Some(i + n + 1)
    })
}

/// "in between, on the road: one worker": between them.
fn in_between(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], "in between").filter(|n| {
            let next = tokens.get(i + n);
            let alone = ends(next)
                || next.is_some_and(|t| {
                    matches!(
                        t.text.as_str(),
                        "is" | "are" | "stands" | "stand" | "there" | "walks" | "a" | "an" | "waits" | ":"
                    ) && !tokens[i + n..].iter().take(8).any(|t| t.text == "and")
                });
            alone && i > 0
        })?;
        out.extend(["between", "them"].map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

/// "five people, among them two children, wait": two of them children.
fn among_them(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let led = out.last().is_some_and(|t| t.kind == TokenKind::Comma);
        let n = begins(
            &tokens[i..],
            "among them|amongst them|among whom|among which|including",
        )
        .filter(|_| {
            led && out
                .iter()
                .rev()
                .skip(1)
                .take(3)
                .any(|t| number(t).is_some_and(|n| n > 1))
        })
        .filter(|n| {
            tokens
                .get(i + n)
                .is_some_and(|t| number(t).is_some() || matches!(t.text.as_str(), "a" | "an"))
        })
        .filter(|n| {
            let list = tokens[i + n..]
                .iter()
                .take_while(|t| t.kind == TokenKind::Word || matches!(t.kind, TokenKind::Number(_)));
            tokens.get(i + n + 1).is_some_and(is_noun) && !list.clone().any(|t| t.text == "and")
        })?;
        let one = matches!(tokens[i + n].text.as_str(), "a" | "an");
        out.push(if one {
            word("one", &tokens[i])
        } else {
            tokens[i + n].clone()
        });
        out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
        if one {
            out.push(tokens[i + n].clone());
        }
        Some(i + n + 1)
    })
}

/// "the taxi is nearer to us than the bus": behind it, where both are ahead of us.
fn nearer_than(tokens: &[Token]) -> Vec<Token> {
    const NEARER: &str = "nearer to us than|closer to us than|nearer to me than|closer to me than|nearer than|closer than|nearer to the ego vehicle than|closer to the ego vehicle than|less far away than|not as far away as";
    const FARTHER: &str = "farther away from us than|further away from us than|farther from us than|further from us than|farther away than|further away than|farther from me than|further from me than|farther than|further than";
    let thing = |i: usize| {
        let article = begins(&tokens[i..], "the|a|an|that|this").unwrap_or(0);
        article > 0 && tokens[i + article..].iter().take(2).any(is_noun)
    };
    let turned = tokens.iter().enumerate().any(|(i, t)| {
        t.text == "oncoming" || begins(&tokens[i..], "behind us|behind me|towards us|towards me").is_some()
    });
    rewritten(tokens, |i, out| {
        let (n, by) = begins(&tokens[i..], NEARER)
            .map(|n| (n, "behind"))
            .or_else(|| begins(&tokens[i..], FARTHER).map(|n| (n, "in front of")))
            .filter(|(n, _)| {
                thing(i + n)
                    && !turned
                    && out.last().is_some_and(|t| {
                        matches!(
                            t.text.as_str(),
                            "is" | "are" | "was" | "were" | "stands" | "drives" | "being"
                        )
                    })
            })?;
        out.extend(by.split(' ').map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

/// "By two cars is the bus followed": the bus is followed by two cars.
fn by_whom_first(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let turned = begins(sentence, "by").and_then(|_| {
            let be =
                (2..sentence.len().min(14)).find(|k| begins(&sentence[*k..], "is|are|was|were").is_some())?;
            let done = (be + 2..sentence.len().min(be + 8)).find(|k| {
                begins(&sentence[*k..], DONE).is_some()
                    || begins(&sentence[*k..], "blocked|closed|occupied|surrounded").is_some()
            })?;
            let named = sentence[1..be].iter().any(is_noun) && ends(sentence.get(done + 1));
            named.then(|| {
                [
                    &sentence[be + 1..done],
                    &sentence[be..=be],
                    &sentence[done..=done],
                    &sentence[..be],
                    &sentence[done + 1..],
                ]
                .concat()
            })
        });
        out.extend(turned.unwrap_or_else(|| sentence.to_vec()));
    }
    out
}

/// "followed at 10 m by a van": by a van at 10 m; "followed closely by": followed by.
fn followed_so_far(tokens: &[Token]) -> Vec<Token> {
    const HOW: &str = "closely|immediately|directly|shortly|slowly|at once|in turn|hard|at a short distance|at some distance|at a distance|at a safe distance|tightly|patiently|at close range|on the left|on the right|from behind|in the same lane|in its lane|in our lane";
    const LEAD: &str =
        "at a distance of|at a distance of about|at about|at roughly|at|with a gap of|by|after";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        out.push(tokens[i].clone());
        i += 1;
        if begins(&tokens[i - 1..], DONE).is_none() {
            continue;
        }
        let lead = begins(&tokens[i..], LEAD).unwrap_or(0);
        let far = tokens.get(i + lead).is_some_and(|t| number(t).is_some())
            && tokens.get(i + lead + 1).is_some_and(is_unit);
        let (from, n) = if far {
            let late = begins(
                &tokens[i + lead + 2..],
                "behind|later|back|behind it|further back|distance",
            )
            .unwrap_or(0);
            (i + lead, lead + 2 + late)
        } else {
            (i, begins(&tokens[i..], HOW).unwrap_or(0))
        };
        if n == 0 || tokens.get(i + n).is_none_or(|t| t.text != "by") {
            continue;
        }
        let by = i + n;
        let end = (by + 1..tokens.len())
            .find(|k| {
                ends(tokens.get(*k))
                    || matches!(
                        tokens[*k].text.as_str(),
                        "and" | "which" | "that" | "who" | "while"
                    )
            })
            .unwrap_or(tokens.len());
        out.extend_from_slice(&tokens[by..end]);
        if far {
            out.push(word("at", &tokens[from]));
            out.extend_from_slice(&tokens[from..from + 2]);
        } else if begins(
            &tokens[i..],
            "in the same lane|in its lane|in our lane|on the left|on the right",
        )
        .is_some()
        {
            out.extend_from_slice(&tokens[i..by]);
        }
        i = end;
    }
    out
}

/// "it has a car right behind it": right behind it is a car.
fn has_beside_it(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let (from, place, end) =
            begins(&tokens[i..], "it has|it had|he has|she has|they have").and_then(|n| {
                let end = (i + n..tokens.len().min(i + 16))
                    .find(|k| ends(tokens.get(*k)))
                    .unwrap_or(tokens.len().min(i + 16));
                let clause = &tokens[i + n..end];
                let back = clause
                    .last()
                    .is_some_and(|t| matches!(t.text.as_str(), "it" | "him" | "her" | "them"));
                let noun = clause.iter().position(is_noun)?;
                let place = clause.get(noun + 1..)?;
                let placed = place.iter().any(super::rephrase::is_place_word) && !place.iter().any(is_noun);
                (back && placed && place.len() <= 7).then_some((i + n, i + n + noun + 1, end))
            })?;
        out.extend_from_slice(&tokens[place..end]);
        out.push(word("is", &tokens[i]));
        out.extend_from_slice(&tokens[from..place]);
        Some(end)
    })
}

/// "one stands to the left of it, another one to the right": of it again.
fn side_again(tokens: &[Token]) -> Vec<Token> {
    const SIDE: &str = "to the left of|to the right of|on the left of|on the right of|left of|right of|on the left side of|on the right side of|in front of|ahead of";
    const AGAIN: &str = "to the left|to the right|on the left|on the right|to its left|to its right|on the left side|on the right side";
    const OTHER: &str = "another one|another|the other one|the other|one|two|three|a second one|a second|the second|the second one|two others";
    let mut of: Vec<Token> = Vec::new();
    rewritten(tokens, |i, out| {
        if tokens[i].kind == TokenKind::Stop {
            of.clear();
        }
        if let Some(n) = begins(&tokens[i..], SIDE) {
            of.clear();
            let what = tokens.get(i + n..).unwrap_or(&[]);
            let end = (1..what.len().min(6))
                .find(|k| ends(what.get(*k)) || what[*k].text == "and")
                .unwrap_or(0);
            let thing = what
                .first()
                .is_some_and(|t| matches!(t.text.as_str(), "it" | "them" | "him" | "her"))
                || what[..end].last().is_some_and(is_noun)
                    && what
                        .first()
                        .is_some_and(|t| matches!(t.text.as_str(), "the" | "this" | "that" | "these"));
            let ours = what[..end]
                .iter()
                .any(|t| matches!(look_up(&t.text), Some(Sense::Ego | Sense::Place(..))));
            if thing && !ours {
                of = what[..end].to_vec();
            }
            out.extend_from_slice(&tokens[i..i + n]);
            return Some(i + n);
        }
        let (n, side) = begins(&tokens[i..], OTHER)
            .filter(|_| !of.is_empty())
            .and_then(|n| {
                let stands = begins(
                    &tokens[i + n..],
                    "stands|stand|is|are|waits|wait|walks|drives|rides",
                )
                .unwrap_or(0);
                let side = begins(&tokens[i + n + stands..], AGAIN)?;
                let after = i + n + stands + side;
                ends(tokens.get(after)).then_some((n + stands, side))
            })?;
        out.extend_from_slice(&tokens[i..i + n + side]);
        out.push(word("of", &tokens[i]));
        // what it was of may have been named with "the": a pronoun would mean what came last
        out.extend(of.iter().map(|t| Token {
            span: tokens[i].span,
            ..t.clone()
        }));
        Some(i + n + side)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn clauses_turned_round() {
        let said = |t: &str| {
            let list: Vec<String> = round(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("By two cars is the bus followed, in our lane."),
            "the bus is followed by two cars , in our lane ."
        );
        assert_eq!(
            said("a bus followed at 10 m by a van"),
            "a bus followed by a van at 10 m"
        );
        assert_eq!(
            said("a bus closely followed closely by a van"),
            "a bus closely followed by a van"
        );
        assert_eq!(
            said("and it has a car right behind it."),
            "and right behind it is a car ."
        );
        assert_eq!(
            said("one stands to the left of them, another one to the right."),
            "one stands to the left of them , another one to the right of them ."
        );
    }
}
