//! How things are listed and numbered: "1 x pedestrian", "as for cars, I want two", "10 to 20 m", "+ 2 cars, - pedestrians",
//! "a coach in each of the other lanes", "so is the bus".

use super::ellipsis::{digits, ends, is_noun, is_unit, number};
use super::lexicon::{Sense, look_up};
use super::shares::opens;
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};
use crate::scene::Class;

/// A text with its lists in plain words.
pub fn plain(tokens: &[Token]) -> Vec<Token> {
    let out = as_for(&without_times(tokens));
    let out = ranges(&riders_wait(&in_each_lane(&waited_for(&out))));
    so_is(&added_and_taken(&out))
}

/// "1 x pedestrian": one.
fn without_times(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for t in tokens {
        let times = t.text == "x" && out.last().is_some_and(|b| number(b).is_some());
        if !times {
            out.push(t.clone());
        }
    }
    // "one (1) truck"
    let mut i = 0;
    while i + 3 < out.len() {
        let said = |t: &Token| number(t).or((t.text == "zero").then_some(0));
        let same = said(&out[i]).is_some() && said(&out[i]) == said(&out[i + 2]);
        if same && out[i + 1].text == "(" && out[i + 3].text == ")" {
            out.drain(i + 1..i + 4);
        }
        i += 1;
    }
    out
}

/// "as for pedestrians, I want five": five pedestrians.
fn as_for(tokens: &[Token]) -> Vec<Token> {
    const WANT: &str = "i want|we want|i need|we need|there should be|there are|there must be|i would like|we would like|id like|wed like|let there be|i see|we see|there will be|make it";
    rewritten(tokens, |i, out| {
        let (from, comma, want, none) = begins(
            &tokens[i..],
            "as for|as to|as regards|regarding|concerning|as far as",
        )
        .and_then(|n| {
            let the = usize::from(tokens.get(i + n)?.text == "the");
            let from = i + n + the;
            let comma =
                (from + 1..tokens.len().min(from + 4)).find(|k| tokens[*k].kind == TokenKind::Comma)?;
            let want = comma + 1 + begins(&tokens[comma + 1..], WANT)?;
            let many = tokens.get(want)?;
            let none = matches!(many.text.as_str(), "none" | "nobody" | "zero");
            let noun = tokens[from..comma].iter().any(is_noun);
            (noun && (none || number(many).is_some()) && ends(tokens.get(want + 1)))
                .then_some((from, comma, want, none))
        })?;
        out.push(if none {
            word("no", &tokens[want])
        } else {
            tokens[want].clone()
        });
        out.extend_from_slice(&tokens[from..comma]);
        Some(want + 1)
    })
}

/// "10 to 20 m ahead": 15 m; "from 5 to 25 m ahead" is all along there.
fn ranges(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let from = begins(
            &tokens[i..],
            "from|between|anywhere from|somewhere between|anywhere between|about",
        )
        .unwrap_or(0);
        let range = tokens.get(i + from).and_then(number).and_then(|a| {
            let to = i + from + 1;
            let hyphen = tokens.get(to).is_some_and(|t| {
                matches!(t.kind, TokenKind::Number(_)) && tokens[to - 1].span.end + 1 == t.span.start
            }) && matches!(tokens[to - 1].kind, TokenKind::Number(_));
            let n = usize::from(!hyphen && begins(&tokens[to..], "to|and|or|till|until").is_some());
            let b = tokens
                .get(to + n)
                .and_then(number)
                .filter(|b| *b > a && (hyphen || n == 1))?;
            let unit = tokens.get(to + n + 1).filter(|t| is_unit(t))?;
            let between = tokens[i].text.ends_with("between");
            let and = tokens[to].text == "and";
            (and == between || hyphen).then(|| ((a + b).div_ceil(2), unit.clone(), to + n + 2))
        });
        match range {
            Some((_, _, end)) if from > 0 && tokens[i].text == "from" => i = end,
            Some((mean, unit, end)) => {
                out.push(digits(mean, &tokens[i]));
                out.push(unit);
                i = end;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "+ 2 cars, + 1 bus, - pedestrians": in a list with plus signs a minus says what is not there.
fn added_and_taken(tokens: &[Token]) -> Vec<Token> {
    let sign = |i: usize, sign: &str| tokens[i].text == sign && tokens[i].kind != TokenKind::Word;
    if !(0..tokens.len()).any(|i| sign(i, "+") && opens(tokens, i)) {
        return tokens.to_vec();
    }
    let mut out: Vec<Token> = Vec::new();
    for i in 0..tokens.len() {
        if sign(i, "-") && opens(tokens, i) {
            out.push(word("no", &tokens[i]));
        } else if !(sign(i, "+") && opens(tokens, i)) {
            out.push(tokens[i].clone());
        }
    }
    out
}

/// "a coach in each of the other two lanes": one in the left lane, one in the right lane.
fn in_each_lane(tokens: &[Token]) -> Vec<Token> {
    const EACH: &str = "in each of the other two lanes|in each of the other lanes|in each of the two other lanes|in each of the neighbouring lanes|in each of the neighboring lanes|in each of the adjacent lanes|in each of the lanes beside us|in each of the lanes beside me|in each of the lanes next to us|in each of the lanes next to me|in each neighbouring lane|in each neighboring lane|in each adjacent lane|in both other lanes|in both the other lanes|in both of the other lanes|in both neighbouring lanes|in both neighboring lanes|in both adjacent lanes|in the lanes on both sides of us|in the lanes on both sides of me|in the lanes to both sides of us|in the lanes on either side of us|in the lanes on either side of me|in the lane on each side of us|in the lane on each side of me|in the lane on either side of us|in the lane on either side of me";
    rewritten(tokens, |i, out| {
        // who is there: "a coach", "two parked cars"
        let beside = || {
            let a = begins(
                &tokens[i..],
                "in each lane|in each of the lanes|in both lanes|in both of the lanes|in the lanes|in the two lanes|in either lane|in each one of the lanes|in the lane|in every lane",
            )?;
            let b = begins(
                &tokens[i + a..],
                "beside|next to|alongside|adjacent to|on either side of|on both sides of|to either side of|on each side of|neighbouring|to both sides of|bordering",
            )?;
            let one = begins(&tokens[i..], "in the lane").is_some();
            let sided = begins(
                &tokens[i + a..],
                "beside|next to|alongside|adjacent to|neighbouring|bordering",
            )
            .is_some();
            let c = begins(
                &tokens[i + a + b..],
                "mine|ours|us|me|my lane|our lane|my own|our own|my own lane|our own lane",
            )?;
            (!(one && sided)).then_some(a + b + c)
        };
        let lead = begins(&tokens[i..], EACH).or_else(beside).and_then(|n| {
            let from = (0..out.len()).rev().take(5).find(|k| {
                number(&out[*k]).is_some() || matches!(out[*k].text.as_str(), "a" | "an" | "one")
            })?;
            let np = &out[from..];
            let plain =
                np.iter().filter(|t| is_noun(t)).count() == 1 && np.iter().all(|t| t.kind != TokenKind::Stop);
            plain.then(|| (n, np.to_vec()))
        });
        let (n, np) = lead?;
        let at = &tokens[i];
        out.extend(["in", "the", "left", "lane", "and"].map(|w| word(w, at)));
        out.extend(np.iter().map(|t| Token {
            span: at.span,
            ..t.clone()
        }));
        out.extend(["in", "the", "right", "lane"].map(|w| word(w, at)));
        Some(i + n)
    })
}

/// "the truck is parked, and so is the bus" in a word of its own.
fn so_is(tokens: &[Token]) -> Vec<Token> {
    const SO: &str = "so is|so are|so was|so were|so does|so do|so did|so has|so have|so stands|so stand|as is|as are|as does|as do|just as is|likewise is|likewise are";
    let mut named = false;
    rewritten(tokens, |i, out| {
        named |= is_noun(&tokens[i]);
        let led = opens(tokens, i) && named;
        let n = begins(&tokens[i..], SO).filter(|n| {
            led && tokens[i + n..]
                .iter()
                .take(5)
                .take_while(|t| !ends(Some(t)))
                .any(is_noun)
        })?;
        out.push(word("soistoo", &tokens[i]));
        Some(i + n)
    })
}

/// "taxis that wait for passengers": who is waited for in general is not there.
fn waited_for(tokens: &[Token]) -> Vec<Token> {
    const WAIT: &str = "wait for|waits for|waiting for|waited for|looking for|hoping for";
    const WHAT: &str = "for the road to clear|for the street to clear|for the road to be clear|for the road to be free|for the way to be free|for the lights to change|for the light to change|for the lights to turn green|for the light to turn green|for the traffic lights to change|for the traffic to clear|for the traffic to pass|for the traffic to ease|for a gap|for a gap in the traffic|for a chance to cross|for the green light|for green|for a green light|for the green man|for the signal|for the signal to change|for a break in the traffic|for their turn|for its turn|for his turn|for her turn|for better weather|for a lift";
    const WHOM: &str = "passengers|customers|clients|guests|fares|orders|business|work|riders";
    rewritten(tokens, |i, out| {
        let waits = tokens[..i].iter().rev().take(6).any(|t| {
            matches!(
                t.text.as_str(),
                "waiting" | "waits" | "wait" | "stand" | "stands" | "standing" | "queue" | "queueing"
            )
        });
        if let Some(n) = begins(&tokens[i..], WHAT).filter(|_| waits) {
            return Some(i + n);
        }
        let n = begins(&tokens[i..], WAIT).filter(|n| {
            begins(&tokens[i + n..], WHOM).is_some_and(|m| {
                ends(tokens.get(i + n + m))
                    || is_noun(&tokens[i + n]) && !is_noun(tokens.get(i + n + m).unwrap_or(&tokens[i]))
            })
        })?;
        out.push(tokens[i].clone());
        Some(i + n + 1)
    })
}

/// "two mopeds whose riders are waiting": which are.
fn riders_wait(tokens: &[Token]) -> Vec<Token> {
    let two_wheels = |t: &Token| matches!(look_up(&t.text), Some(Sense::Noun(n, _)) if matches!(n.classes[0], Class::Bicycle | Class::Motorcycle));
    rewritten(tokens, |i, out| {
        let n = begins(
            &tokens[i..],
            "whose rider|whose riders|whose driver|whose drivers",
        )
        .filter(|_| out.iter().rev().take(2).any(two_wheels))?;
        out.push(word("which", &tokens[i]));
        Some(i + n)
    })
}
