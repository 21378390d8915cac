//! Small turns of prompts in plain words: distances told as a gap, what is about to happen, lights that are on, who drives.

use super::ellipsis::{ends, is_noun, is_unit, number};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, rewritten, word};
use crate::scene::Class;

const ABOUT: &str = "is about to overtake|are about to overtake|about to overtake|is going to overtake|are going to overtake|is preparing to overtake|are preparing to overtake|prepares to overtake|wants to overtake|want to overtake|is trying to overtake|are trying to overtake|tries to overtake|intends to overtake|would like to overtake|is waiting to overtake|cannot overtake|cant overtake|is about to pass|wants to pass|is unable to overtake|is trying to pass";
const REACHED: &str = "has reached|have reached|has just reached|have just reached|has already reached|have already reached|has arrived on|have arrived on|has got to|has stepped onto|have stepped onto|has made it to";
const BUSY: &str = "are busy with|is busy with|busy with|are at work with|at work with|are working with|is working with|working with|are busy at|are operating|is operating";
const LIGHTS: &str = "lights|lamps|headlights|headlamps|indicators|flashers|beacons|beacon|siren|sirens|blinkers|taillights|engine";
const LIT: &str =
    "switched on|turned on|on|flashing|blinking|lit|running|off|switched off|turned off|wailing|going";

const GAPS: &str = "with a gap between them in which|with a space between them in which|with a gap between them where|and in the gap between them|and in the space between them is|and in the gap between them is";

/// A prompt in plain words.
pub fn filled(tokens: &[Token]) -> Vec<Token> {
    let out = replaced(tokens, ABOUT, "is behind");
    let out = replaced(&out, BUSY, "are beside");
    let out = replaced(&out, GAPS, "and between them is");
    let out = its_edge(&behind_our_car(&waits_for_bus(&out)));
    let out = far_from_other(&arrived(&out));
    let out = without_lights(&out);
    let out = rides(&without_who(&out));
    gap(&out)
}

/// "people wait for the bus on the pavement": a bus that nobody named yet is still to come.
fn waits_for_bus(tokens: &[Token]) -> Vec<Token> {
    const WAIT: &str =
        "wait for|waits for|waiting for|waited for|queue for|queueing for|queuing for|are queueing for";
    const WHAT: &str = "the bus|a bus|their bus|his bus|her bus|the tram|a tram|the school bus|the next bus|a taxi|their taxi|the coach|the night bus|a lift";
    rewritten(tokens, |i, out| {
        let found = begins(&tokens[i..], WAIT).and_then(|n| {
            let what = begins(&tokens[i + n..], WHAT)?;
            let noun = &tokens[i + n + what - 1].text;
            let named = out.iter().any(|t| t.text == *noun);
            let who = out.iter().rev().take(4).any(
                |t| matches!(look_up(&t.text), Some(Sense::Noun(k, _)) if k.classes[0] == Class::Pedestrian),
            );
            let next = tokens.get(i + n + what);
            let rests = ends(next)
                || begins(&tokens[i + n + what..], "on|at|in|near|under|behind|beside|next").is_some();
            (!named && who && rests).then_some((n, n + what))
        });
        let (n, all) = found?;
        out.extend_from_slice(&tokens[i..i + n - 1]);
        Some(i + all)
    })
}

/// "one in front of our car and one behind it": behind us.
fn behind_our_car(tokens: &[Token]) -> Vec<Token> {
    const OURS: &str = "our car|my car|our vehicle|my vehicle|the ego vehicle|the ego car|our van|my van|our truck|my truck|our bus|the host vehicle";
    let mut out: Vec<Token> = Vec::new();
    let mut ours = false;
    let mut i = 0;
    while i < tokens.len() {
        let t = &tokens[i];
        if let Some(n) = begins(&tokens[i..], OURS) {
            ours = out
                .last()
                .is_some_and(|b| matches!(b.text.as_str(), "of" | "behind" | "beside" | "to" | "before"));
            out.extend_from_slice(&tokens[i..i + n]);
            i += n;
            continue;
        }
        ours &= !(is_noun(t) || t.kind == TokenKind::Stop);
        let led = out
            .last()
            .is_some_and(|b| matches!(b.text.as_str(), "of" | "behind" | "beside" | "to" | "before"));
        if ours && led && t.text == "it" {
            out.push(word("us", t));
        } else {
            out.push(t.clone());
        }
        i += 1;
    }
    out
}

/// "the road has two taxis at its right edge": at the right edge of the road.
fn its_edge(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let road = out
            .iter()
            .rev()
            .take_while(|t| t.kind != TokenKind::Stop)
            .any(|t| {
                matches!(
                    t.text.as_str(),
                    "road" | "street" | "carriageway" | "highway" | "motorway"
                )
            });
        let n = begins(&tokens[i..], "at its|on its|along its")
            .filter(|_| road)
            .filter(|n| {
                tokens
                    .get(i + n)
                    .is_some_and(|t| matches!(t.text.as_str(), "left" | "right"))
                    && tokens.get(i + n + 1).is_some_and(|t| {
                        matches!(
                            t.text.as_str(),
                            "edge"
                                | "kerb"
                                | "curb"
                                | "shoulder"
                                | "verge"
                                | "roadside"
                                | "pavement"
                                | "sidewalk"
                        )
                    })
            })?;
        out.push(tokens[i].clone());
        out.push(word("the", &tokens[i]));
        Some(i + n)
    })
}

/// "has reached the left pavement": is on it.
fn arrived(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], REACHED);
        let n = n.filter(|n| {
            tokens[i + n..].iter().take(5).any(|t| {
                matches!(look_up(&t.text), Some(Sense::Place(..)))
                    || matches!(t.text.as_str(), "side" | "lane")
            })
        })?;
        let strip = tokens[i + n..].iter().take(5).any(|t| {
            matches!(
                t.text.as_str(),
                "pavement" | "sidewalk" | "footpath" | "kerb" | "curb" | "side" | "lane"
            )
        });
        out.extend(["is", if strip { "on" } else { "at" }].map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

/// "far behind it": behind it; how far is left open.
fn far_from_other(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let other = begins(
            &tokens[i..],
            "far behind|far ahead of|far in front of|a long way behind|a long way ahead of",
        )
        .filter(|n| {
            begins(&tokens[i + n..], "it|them|him|her").is_some()
                || begins(&tokens[i + n..], "the|that|this").is_some()
                    && tokens[i + n + 1..].iter().take(2).any(is_noun)
        });
        let ours = other.is_some_and(|n| {
            tokens[i + n..]
                .iter()
                .take(3)
                .any(|t| matches!(t.text.as_str(), "ego" | "host"))
        });
        let not = out.last().is_some_and(|b| b.text == "not");
        if t.text == "far" && other.is_some() && !ours && !not {
            continue;
        }
        out.push(t.clone());
    }
    out
}

/// "with its rear lights on": says nothing of where it is.
fn without_lights(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, _| {
        let end = begins(
            &tokens[i..],
            "with its|with his|with her|with their|with the|with all|with",
        )
        .and_then(|n| {
            let lamp =
                (i + n..tokens.len().min(i + n + 4)).find(|k| begins(&tokens[*k..], LIGHTS).is_some())?;
            let plain = tokens[i + n..lamp]
                .iter()
                .all(|t| t.kind == TokenKind::Word && !is_noun(t) && !super::rephrase::is_place_word(t));
            let lit = begins(tokens.get(lamp + 1..)?, LIT)?;
            (plain && ends(tokens.get(lamp + 1 + lit))).then_some(lamp + 1 + lit)
        })?;
        Some(end)
    })
}

/// "its driver, a man in a yellow vest, stands": the driver stands.
fn without_who(tokens: &[Token]) -> Vec<Token> {
    let person = |t: &Token| matches!(look_up(&t.text), Some(Sense::Noun(n, false)) if n.classes[0] == Class::Pedestrian);
    rewritten(tokens, |i, out| {
        let led = tokens[i].kind == TokenKind::Comma && out.last().is_some_and(person);
        let end = (led && begins(tokens.get(i + 1..).unwrap_or(&[]), "a|an").is_some())
            .then(|| {
                let who = (i + 2..tokens.len().min(i + 5)).find(|k| person(&tokens[*k]))?;
                let end = (who + 1..tokens.len().min(who + 8)).find(|k| ends(tokens.get(*k)))?;
                let dressed = begins(
                    &tokens[who + 1..end],
                    "in a|in an|wearing a|wearing an|in his|in her|with a|dressed in|in|wearing",
                )
                .is_some();
                let placed = tokens[who + 1..end]
                    .iter()
                    .any(|t| matches!(look_up(&t.text), Some(Sense::Place(..) | Sense::Ego)));
                // the clause goes on with its verb
                (tokens[end].kind == TokenKind::Comma
                    && dressed
                    && !placed
                    && tokens.get(end + 1).is_some_and(|t| {
                        t.text != "and"
                            && !is_noun(t)
                            && !matches!(t.text.as_str(), "a" | "an" | "two" | "three")
                    }))
                .then_some(end + 1)
            })
            .flatten()?;
        Some(end)
    })
}

/// "he cycles 5 m ahead": is cycling; "she walks there", where nobody was named: a woman does.
fn rides(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut people: Vec<&str> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let who = match t.text.as_str() {
            "she" => Some("woman"),
            "he" => Some("man"),
            _ => None,
        };
        let opens = i == 0
            || tokens[i - 1].kind != TokenKind::Word
            || matches!(tokens[i - 1].text.as_str(), "and" | "while");
        let named = || {
            out.iter()
                .any(|t| is_noun(t) && !people.contains(&t.text.as_str()))
        };
        let new = who.filter(|w| opens && !people.contains(w) && !named());
        if let Some(who) = new {
            out.extend(["a", who].map(|w| word(w, t)));
            people.push(who);
            continue;
        }
        let subject = out.last().is_some_and(|b| {
            matches!(
                b.text.as_str(),
                "he" | "she" | "who" | "that" | "man" | "woman" | "it" | "boy" | "girl"
            ) || matches!(look_up(&b.text), Some(Sense::Noun(n, false)) if n.classes[0] == Class::Pedestrian)
        });
        if t.text == "cycles" && subject {
            out.extend(["is", "cycling"].map(|w| word(w, t)));
            continue;
        }
        out.push(t.clone());
    }
    out
}

/// "the distance between us and the bus ahead is 18 m": the bus ahead, at 18 m.
fn gap(tokens: &[Token]) -> Vec<Token> {
    const LEAD: &str = "the distance between us and|the distance between me and|the gap between us and|the gap between me and|the distance from us to|the distance from me to|our distance to|my distance to|the distance to|the gap to|our distance from|the space between us and|the distance between the ego vehicle and|the distance from the ego vehicle to|the gap between the ego vehicle and";
    const AGAIN: &str = "between us and|between me and|that to|the one to|to";
    const IS: &str = "is only about|is only|is about|is roughly|is just|is exactly|is|it is only|it is|amounts to|measures|was|it is about|was only|was about|comes to";
    let mut open = false;
    rewritten(tokens, |i, out| {
        let again = open && i > 0 && (tokens[i - 1].kind != TokenKind::Word || tokens[i - 1].text == "and");
        let (from, verb, metres) = begins(&tokens[i..], LEAD)
            .or_else(|| again.then(|| begins(&tokens[i..], AGAIN)).flatten())
            .and_then(|n| {
                let far = |k: usize| {
                    let is = begins(&tokens[k..], IS)?;
                    let unit = tokens.get(k + is).is_some_and(|t| number(t).is_some())
                        && tokens.get(k + is + 1).is_some_and(is_unit);
                    unit.then_some((k, k + is))
                };
                let end = tokens.len().min(i + n + 10);
                let (verb, metres) = (i + n + 1..end)
                    .take_while(|k| tokens[*k].kind != TokenKind::Stop)
                    .find_map(far)?;
                tokens[i + n..verb]
                    .iter()
                    .any(is_noun)
                    .then_some((i + n, verb, metres))
            })?;
        open = true;
        // ("the car behind it": behind us, for it is our distance)
        let back = begins(&tokens[verb.saturating_sub(2)..verb], "behind it|ahead it").is_some();
        let to = if back && tokens[verb - 2].text == "behind" {
            verb - 1
        } else {
            verb
        };
        // where it is comes after the metres: "the bus 18 m ahead"
        let place = (from..to)
            .rev()
            .take_while(|k| !is_noun(&tokens[*k]))
            .last()
            .unwrap_or(to);
        out.extend_from_slice(&tokens[from..place]);
        out.push(word("is", &tokens[from]));
        out.extend_from_slice(&tokens[metres..metres + 2]);
        if place < to {
            out.extend_from_slice(&tokens[place..to]);
        } else {
            out.push(word("away", &tokens[from]));
        }
        Some(metres + 2)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn plain_words() {
        let said = |t: &str| {
            let list: Vec<String> = filled(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said(
                "The distance between us and the bus ahead is 18 m; between us and the car behind it is only 7 m."
            ),
            "the bus is 18 m ahead . the car is 7 m behind ."
        );
        assert_eq!(said("He is about to overtake a van"), "a man is behind a van");
        assert_eq!(
            said("a truck with its rear lights on, and a bus"),
            "a truck , and a bus"
        );
        assert_eq!(
            said("its driver, a man in a vest, stands there"),
            "its driver stands there"
        );
        assert_eq!(
            said("far behind it a bus, far behind us a van"),
            "behind it a bus , far behind us a van"
        );
        assert_eq!(
            said("a boy has reached the left pavement"),
            "a boy is on the left pavement"
        );
    }
}
