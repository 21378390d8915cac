//! What a prompt tells in passing: whose driver stops, whom we follow, who has put something up, what a place holds.

use super::ellipsis::{is_noun, number};
use super::inverted::{is_fresh, opens};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};

/// A prompt that tells it plainly.
pub fn plainly(tokens: &[Token]) -> Vec<Token> {
    let out = led_by_others(&drivers(tokens));
    let out = held_by_place(&without_empty_places(&out));
    put_up(&namely(&whom_we_follow(&out)))
}

/// What leads over to what is meant exactly.
pub(super) const NAMELY: &str = "namely|to wit|viz|that is to say|to be exact|specifically|in the form of|in the shape of|consisting of|made up of|composed of|comprising|which consists of|which consist of|that consists of|which is made up of|which is composed of|which comprises|meaning|that is|i e|ie|in other words|being";

/// "traffic, namely four cars and a truck": what follows lists it.
fn namely(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let before = out.iter().rev().find(|t| t.kind != TokenKind::Comma);
        let sorts = before.is_some_and(|t| {
            matches!(look_up(&t.text), Some(Sense::Noun(n, many)) if n.classes.len() > 2 && many || t.text == "traffic")
        });
        let n = begins(&tokens[i..], NAMELY).filter(|n| sorts && tokens.get(i + n).is_some_and(is_fresh))?;
        while out.last().is_some_and(|t| t.kind == TokenKind::Comma) {
            out.pop();
        }
        out.push(Token {
            kind: TokenKind::Mark,
            ..word(":", &tokens[i])
        });
        Some(i + n)
    })
}

/// "the coach that I am driving behind": which is in front of me.
fn whom_we_follow(tokens: &[Token]) -> Vec<Token> {
    const WE: &str = "i am|im|we are|were|i|we|i have been|we have been|ive been|weve been";
    const DO: &str = "driving|travelling|traveling|riding|stuck|sitting|waiting|cruising|rolling|drive|travel|ride|wait|sit|standing|stand|queueing|queuing|am|are";
    const FOLLOW: [(&str, &str); 2] = [
        (
            "behind|following|follow|trailing|tailing|chasing|trail|tail",
            "in front of me",
        ),
        ("ahead of|in front of|leading", "behind me"),
    ];
    rewritten(tokens, |i, out| {
        let (n, place) = begins(&tokens[i..], "that|which|whom|who")
            .map_or(Some(0), Some)
            .filter(|_| out.last().is_some_and(is_noun))
            .and_then(|that| {
                let we = that + begins(&tokens[i + that..], WE)?;
                let does = we + begins(&tokens[i + we..], DO).unwrap_or(0);
                let (n, place) = FOLLOW.iter().find_map(|(said, place)| {
                    begins(&tokens[i + does..], said).map(|n| (does + n, *place))
                })?;
                // ("... that I am driving behind a truck" goes on)
                let next = tokens.get(i + n);
                let over = next.is_none_or(|t| {
                    t.kind != TokenKind::Word
                        || matches!(
                            t.text.as_str(),
                            "is" | "are"
                                | "has"
                                | "have"
                                | "was"
                                | "at"
                                | "and"
                                | "stops"
                                | "brakes"
                                | "in"
                                | "does"
                        )
                });
                over.then_some((n, place))
            })?;
        out.extend(place.split(' ').map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

fn is_place(t: &Token) -> bool {
    matches!(look_up(&t.text), Some(Sense::Place(..)))
        || matches!(t.text.as_str(), "lane" | "side" | "lot" | "park")
}

/// "a car park holding only motorcycles": with them.
fn held_by_place(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for t in tokens {
        let holds = matches!(
            t.text.as_str(),
            "holding" | "containing" | "housing" | "hosting" | "accommodating" | "featuring"
        );
        let held = matches!(
            t.text.as_str(),
            "holds" | "carries" | "hosts" | "houses" | "accommodates"
        );
        if held && out.last().is_some_and(is_place) {
            out.push(word("has", t));
        } else if holds && out.last().is_some_and(is_place) {
            out.push(word("with", t));
        } else {
            out.push(t.clone());
        }
    }
    out
}

/// "whereas the one on the right is empty": of a lane or pavement that says no more than nothing.
fn without_empty_places(tokens: &[Token]) -> Vec<Token> {
    const EMPTY: &str = "is empty|are empty|is free|are free|is clear|are clear|is deserted|are deserted|is unoccupied|is vacant|remains empty|stays empty|remains free|is completely empty|is quite empty|is entirely empty|is still free|stays free";
    const HEAD: &str = "the one|the other one|the other|the lane|the left lane|the right lane|the left one|the right one|the pavement|the sidewalk|the left pavement|the right pavement|the left sidewalk|the right sidewalk|the footpath|the left kerb|the right kerb|the other pavement|the other sidewalk|the kerb";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let apart = |t: &Token| {
            matches!(t.kind, TokenKind::Comma | TokenKind::Stop | TokenKind::Mark)
                || matches!(t.text.as_str(), "while" | "whereas" | "but" | "and")
        };
        if begins(&tokens[i..], HEAD).is_none() || !out.last().is_some_and(apart) {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        }
        let end = (i + 1..tokens.len())
            .find(|k| apart(&tokens[*k]))
            .unwrap_or(tokens.len());
        let clause = &tokens[i..end];
        let empty =
            (1..clause.len()).any(|k| begins(&clause[k..], EMPTY).is_some_and(|n| k + n == clause.len()));
        if empty && !clause.iter().any(is_noun) {
            while out
                .last()
                .is_some_and(|t| t.kind == TokenKind::Comma || t.kind == TokenKind::Word && apart(t))
            {
                out.pop();
            }
            i = end;
        } else {
            out.push(tokens[i].clone());
            i += 1;
        }
    }
    out
}

/// "a van driver has stopped for them": his van has; who drives is not on foot.
fn drivers(tokens: &[Token]) -> Vec<Token> {
    const DRIVES: &str = "stops|stop|has stopped|have stopped|stopped|brakes|is braking|yields|is yielding|gives way|is giving way|lets|is letting|drives|drive|is driving|are driving|overtakes|overtake|is overtaking|are overtaking|turns|is turning|approaches|is approaching|follows|is following|tailgates|is tailgating|comes towards|is coming towards|cuts in|pulls out|is pulling out|reverses|is reversing|slows down|is slowing down|waits|is waiting|has to wait|must wait|waited";
    const FOOT: &str = "foot|pavement|sidewalk|footpath|walks|walking|kerb";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let t = &tokens[i];
        let who = matches!(t.text.as_str(), "driver" | "drivers" | "motorist" | "motorists");
        let on_foot = || {
            tokens[i + 1..]
                .iter()
                .take_while(|t| !matches!(t.kind, TokenKind::Stop | TokenKind::Comma))
                .any(|t| FOOT.split('|').any(|w| w == t.text))
        };
        let whose = out
            .last()
            .is_some_and(|b| matches!(b.text.as_str(), "whose" | "its" | "their" | "the"));
        let drives = who && begins(&tokens[i + 1..], DRIVES).is_some() && !on_foot() && !whose;
        let vehicle = out.last().is_some_and(
            |b| matches!(look_up(&b.text), Some(Sense::Noun(n, _)) if n.classes[0].is_vehicle()),
        );
        let fresh = out
            .iter()
            .rev()
            .take(3)
            .any(|b| matches!(b.text.as_str(), "a" | "an" | "another" | "one" | "two" | "three"));
        // ("the bus driver waits": the bus, if none was named)
        let kind = out.last().map(|b| b.text.clone());
        let the = out.len() > 1 && out[out.len() - 2].text == "the";
        let fresh = fresh || the && kind.is_some_and(|k| out[..out.len() - 1].iter().all(|b| b.text != k));
        match (drives, vehicle, fresh) {
            (true, true, true) if t.text.ends_with('s') => {
                let many = out.pop().map(|b| super::lexicon::plural(&b.text));
                out.push(word(&many.unwrap_or_default(), t));
            }
            (true, true, true) => {}
            (true, false, true) => out.push(word(if t.text.ends_with('s') { "cars" } else { "car" }, t)),
            _ => out.push(t.clone()),
        }
        i += 1;
    }
    out
}

/// "flanked by two motorbikes, a limousine comes": a limousine comes, flanked by two motorbikes.
fn led_by_others(tokens: &[Token]) -> Vec<Token> {
    const BY: &str = "flanked by|followed by|accompanied by|escorted by|preceded by|chased by|trailed by|pursued by|surrounded by|closely followed by|tailed by|overtaken by|being overtaken by|being followed by";
    let mut out: Vec<Token> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let moved = begins(sentence, BY).and_then(|_| {
            // ("flanked by two motorbikes, one on each side, a car": the last comma before the subject)
            let mut commas = (1..sentence.len().min(20)).filter(|k| sentence[*k].kind == TokenKind::Comma);
            let comma = commas.rfind(|k| {
                let next = sentence.get(k + 1);
                next.is_some_and(is_fresh)
                    && sentence[k + 1..].iter().take(5).any(is_noun)
                    && !sentence[k + 1..]
                        .iter()
                        .take_while(|t| t.kind != TokenKind::Comma)
                        .any(|t| t.text == "each")
            })?;
            let end = sentence.len() - usize::from(sentence.last()?.kind == TokenKind::Stop);
            let apart = Token {
                kind: TokenKind::Comma,
                ..word(",", &sentence[comma])
            };
            Some(
                [
                    &sentence[comma + 1..end],
                    &[apart],
                    &sentence[..comma],
                    &sentence[end..],
                ]
                .concat(),
            )
        });
        out.extend(moved.unwrap_or_else(|| sentence.to_vec()));
    }
    out
}

/// "someone has put up three barriers": there are three.
fn put_up(tokens: &[Token]) -> Vec<Token> {
    const WHO: &str = "someone|somebody|some idiot|some fool|some guy|they|the police|the workers|the builders|the council|people|the firemen|workmen|the road workers|the authorities|the city";
    const PUT: &str = "has put up|have put up|put up|has set up|have set up|set up|has placed|have placed|placed|has erected|have erected|erected|has put|have put|has left|have left|has installed|have installed|has deployed|have deployed|has laid out|have laid out|has put out|have put out|put out|have positioned|has positioned";
    rewritten(tokens, |i, out| {
        let k = begins(&tokens[i..], WHO)
            .filter(|_| opens(tokens, i))
            .and_then(|n| {
                let k = i + n + begins(&tokens[i + n..], PUT)?;
                (number(tokens.get(k)?)? > 1 && tokens[k + 1..].iter().take(4).any(is_noun)).then_some(k)
            })?;
        out.extend(["there", "are"].map(|w| word(w, &tokens[i])));
        Some(k)
    })
}
