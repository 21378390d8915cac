//! How a whole is shared out: "half of them", "four per side", "two of each", "the first at 10 m, then at 20 m". Put into
//! numbers and "on each side", which the grammar reads.

use super::description::Anchor;
use super::ellipsis::{digits, ends, is_noun, is_unit, number};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, word};
use crate::scene::Class;
use crate::scene::graph::LaneRole;

/// A text with its shares in numbers.
pub fn counted(tokens: &[Token]) -> Vec<Token> {
    let out = of_which_there_are(&without_times(tokens));
    let out = ranges(&riders_wait(&out));
    let out = in_each_lane(&waited_for(&as_for(&out)));
    let out = replaced(&out, "of which|of whom", "of them");
    let out = of_a_group(&out);
    let out = some_of_so_many(&halves(&out));
    let out = as_many_of_both(&out);
    let out = added_and_taken(&out);
    let out = so_is(&out);
    let out = two_strips(&out);
    let out = per_side(&out);
    one_by_one(&out)
}

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || matches!(
            tokens[i - 1].kind,
            TokenKind::Comma | TokenKind::Stop | TokenKind::Mark
        )
        || matches!(
            tokens[i - 1].text.as_str(),
            "and" | "while" | "but" | "where" | "with"
        )
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

/// "as for pedestrians, I want five": five pedestrians.
fn as_for(tokens: &[Token]) -> Vec<Token> {
    const WANT: &str = "i want|we want|i need|we need|there should be|there are|there must be|i would like|we would like|id like|wed like|let there be|i see|we see|there will be|make it";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = begins(
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
        });
        match found {
            Some((from, comma, want, none)) => {
                out.push(if none {
                    word("no", &tokens[want])
                } else {
                    tokens[want].clone()
                });
                out.extend_from_slice(&tokens[from..comma]);
                i = want + 1;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "taxis that wait for passengers": who is waited for in general is not there.
fn waited_for(tokens: &[Token]) -> Vec<Token> {
    const WAIT: &str = "wait for|waits for|waiting for|waited for|looking for|hoping for";
    const WHAT: &str = "for the road to clear|for the street to clear|for the road to be clear|for the road to be free|for the way to be free|for the lights to change|for the light to change|for the lights to turn green|for the light to turn green|for the traffic lights to change|for the traffic to clear|for the traffic to pass|for the traffic to ease|for a gap|for a gap in the traffic|for a chance to cross|for the green light|for green|for a green light|for the green man|for the signal|for the signal to change|for a break in the traffic|for their turn|for its turn|for his turn|for her turn|for better weather|for a lift";
    const WHOM: &str = "passengers|customers|clients|guests|fares|orders|business|work|riders";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let waits = tokens[..i].iter().rev().take(6).any(|t| {
            matches!(
                t.text.as_str(),
                "waiting" | "waits" | "wait" | "stand" | "stands" | "standing" | "queue" | "queueing"
            )
        });
        if let Some(n) = begins(&tokens[i..], WHAT).filter(|_| waits) {
            i += n;
            continue;
        }
        let n = begins(&tokens[i..], WAIT).filter(|n| {
            begins(&tokens[i + n..], WHOM).is_some_and(|m| {
                ends(tokens.get(i + n + m))
                    || is_noun(&tokens[i + n]) && !is_noun(tokens.get(i + n + m).unwrap_or(&tokens[i]))
            })
        });
        match n {
            Some(n) => {
                out.push(tokens[i].clone());
                i += n + 1;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "two mopeds whose riders are waiting": which are.
fn riders_wait(tokens: &[Token]) -> Vec<Token> {
    let two_wheels = |t: &Token| matches!(look_up(&t.text), Some(Sense::Noun(n, _)) if matches!(n.classes[0], Class::Bicycle | Class::Motorcycle));
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let n = begins(
            &tokens[i..],
            "whose rider|whose riders|whose driver|whose drivers",
        )
        .filter(|_| out.iter().rev().take(2).any(two_wheels));
        match n {
            Some(n) => {
                out.push(word("which", &tokens[i]));
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

/// "a coach in each of the other two lanes": one in the left lane, one in the right lane.
fn in_each_lane(tokens: &[Token]) -> Vec<Token> {
    const EACH: &str = "in each of the other two lanes|in each of the other lanes|in each of the two other lanes|in each of the neighbouring lanes|in each of the neighboring lanes|in each of the adjacent lanes|in each of the lanes beside us|in each of the lanes beside me|in each of the lanes next to us|in each of the lanes next to me|in each neighbouring lane|in each neighboring lane|in each adjacent lane|in both other lanes|in both the other lanes|in both of the other lanes|in both neighbouring lanes|in both neighboring lanes|in both adjacent lanes|in the lanes on both sides of us|in the lanes on both sides of me|in the lanes to both sides of us|in the lanes on either side of us|in the lanes on either side of me|in the lane on each side of us|in the lane on each side of me|in the lane on either side of us|in the lane on either side of me";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
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
        match lead {
            Some((n, np)) => {
                let at = &tokens[i];
                out.extend(["in", "the", "left", "lane", "and"].map(|w| word(w, at)));
                out.extend(np.iter().map(|t| Token {
                    span: at.span,
                    ..t.clone()
                }));
                out.extend(["in", "the", "right", "lane"].map(|w| word(w, at)));
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

/// "the cones, of which there are seven": seven of them.
fn of_which_there_are(tokens: &[Token]) -> Vec<Token> {
    const LEAD: &str = "of which there are|of whom there are|of which i see|of which we see|of which there is|of which i need|of which i want";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let n = begins(&tokens[i..], LEAD).filter(|n| {
            tokens.get(i + n).is_some_and(|t| number(t).is_some()) && ends(tokens.get(i + n + 1))
        });
        match n {
            Some(n) => {
                out.push(tokens[i + n].clone());
                out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
                i += n + 1;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "Of the four cars, two are parked": the four cars, two of them.
fn of_a_group(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let the = tokens
            .get(i + 1)
            .is_some_and(|t| matches!(t.text.as_str(), "the" | "these" | "those" | "my" | "our"));
        let stop = matches!(
            i.checked_sub(1).map(|k| &tokens[k].kind),
            None | Some(TokenKind::Stop)
        );
        let rest = &tokens[i + 1..];
        let group = rest.iter().take(6).take_while(|t| !ends(Some(t))).any(is_noun)
            && rest.iter().take(7).any(|t| t.kind == TokenKind::Comma)
            && rest.get(1).is_some_and(|t| number(t).is_some());
        if !(t.text == "of" && stop && the && group) {
            out.push(t.clone());
        }
    }
    out
}

/// The number of the group that was named last.
fn whole(before: &[Token]) -> Option<u32> {
    (0..before.len()).rev().find_map(|k| {
        let group = before[k + 1..]
            .iter()
            .take(4)
            .take_while(|t| !ends(Some(t)))
            .any(is_noun);
        let unit = before.get(k + 1).is_some_and(is_unit);
        let dozen = (before[k].text == "dozen").then_some(12);
        let half = k > 0 && (before[k - 1].text == "half" || k > 1 && before[k - 2].text == "half");
        let many = dozen.map(|d| if half { d / 2 } else { d }).or(number(&before[k]));
        // "cars, six altogether"
        let total = begins(&before[k + 1..], "altogether|in total|in all|all told|of them").is_some()
            && before[..k].iter().rev().take(3).any(is_noun);
        many.filter(|n| (group || total) && !unit && *n > 1)
    })
}

/// "of the six parked cars": their number, their words, and how many words that is.
fn own_group(rest: &[Token]) -> Option<((u32, &[Token]), usize)> {
    let of = begins(rest, "of the|of these|of those|of my|of our|of all")?;
    let whole = rest.get(of).and_then(number).filter(|n| *n > 1)?;
    let noun = (of + 1..rest.len().min(of + 4)).find(|k| is_noun(&rest[*k]))?;
    let plain = !rest[of..noun].iter().any(|t| ends(Some(t))) && !rest.get(noun + 1).is_some_and(is_noun);
    plain.then(|| ((whole, &rest[of - 1..=noun]), noun + 1))
}

/// "one of the two men crosses, the other waits": the two men, one of them.
fn some_of_so_many(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let many = number(&tokens[i]).filter(|_| opens(tokens, i));
        let own = many.and_then(|m| Some((m, own_group(&tokens[i + 1..]).filter(|g| g.0.0 > m)?)));
        match own {
            Some((_, ((_, noun), len))) => {
                out.extend_from_slice(noun);
                out.push(Token {
                    kind: TokenKind::Comma,
                    ..word(",", &tokens[i])
                });
                out.push(tokens[i].clone());
                out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
                i += 1 + len;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "half of them": so many.
fn halves(tokens: &[Token]) -> Vec<Token> {
    const SHARES: [((u32, u32), &str); 5] = [
        ((1, 2), "one half|a half|half"),
        ((1, 3), "a third|one third"),
        ((1, 4), "a quarter|one quarter|a fourth"),
        ((2, 3), "two thirds|2 thirds"),
        ((3, 4), "three quarters|3 quarters|three fourths"),
    ];
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = SHARES
            .iter()
            .find_map(|(d, said)| begins(&tokens[i..], said).map(|n| (*d, n)));
        let Some(((share, divisor), n)) = found else {
            // "the other half", "the remaining half"
            match begins(
                &tokens[i..],
                "the other half of them|the other half|the remaining half|the second half",
            ) {
                Some(n) if whole(&out).is_some() => {
                    out.extend(["the", "others"].map(|w| word(w, &tokens[i])));
                    i += n;
                }
                _ => {
                    out.push(tokens[i].clone());
                    i += 1;
                }
            }
            continue;
        };
        let rest = &tokens[i + n..];
        // "half of the six cars are parked": six cars, three of them
        if let Some((group, len)) = own_group(rest).filter(|g| opens(tokens, i) && g.0.0 % divisor == 0) {
            let (whole, noun) = group;
            out.extend_from_slice(noun);
            out.push(Token {
                kind: TokenKind::Comma,
                ..word(",", &tokens[i])
            });
            out.push(digits(whole / divisor * share, &tokens[i]));
            out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
            i += n + len;
            continue;
        }
        let of = begins(rest, "of them|of these|of those").unwrap_or(0);
        // "half of the cars", "half the cars"
        let own = begins(rest, "of the|the|of my|of these|of those")
            .filter(|k| of == 0 && rest.get(*k).is_some_and(is_noun))
            .map_or(0, |k| k + 1);
        let next = rest.get(of.max(own));
        let bare = divisor == 2
            && next.is_some_and(|t| {
                matches!(
                    look_up(&t.text),
                    Some(Sense::State(..) | Sense::In | Sense::At | Sense::Rel(_) | Sense::EgoRel(_))
                ) || matches!(t.text.as_str(), "are" | "is" | "of" | "on" | "to")
            })
            && opens(tokens, i);
        let many = whole(&out).filter(|w| w % divisor == 0 && (of + own > 0 || bare));
        match many {
            Some(many) => {
                out.push(digits(many / divisor * share, &tokens[i]));
                out.extend(["of", "them"].map(|w| word(w, &tokens[i])));
                i += n + of.max(own);
            }
            None => {
                out.extend_from_slice(&tokens[i..i + n]);
                i += n;
            }
        }
    }
    out
}

/// "as many buses as trucks: two of each": two of the one, two of the other.
fn as_many_of_both(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let each = (1..sentence.len()).find_map(|i| {
            let n = begins(
                &sentence[i..],
                "of each|of each kind|of each sort|of each type|of either|apiece|of both|each|of both kinds",
            )?;
            let many = number(&sentence[i - 1]).filter(|k| (1..=20).contains(k))?;
            (ends(sentence.get(i + n)) || sentence.get(i + n)?.text == "in").then_some((i, n, many))
        });
        let Some((at, n, many)) = each else {
            out.extend_from_slice(sentence);
            continue;
        };
        // what is counted: nouns in the plural without numbers of their own
        let mut lead = at - 1;
        while lead > 0
            && (ends(Some(&sentence[lead - 1]))
                || matches!(
                    sentence[lead - 1].text.as_str(),
                    "namely" | "that" | "is" | "which" | "exactly" | "with"
                ))
        {
            lead -= 1;
        }
        let plural: Vec<usize> = (0..lead)
            .filter(|k| matches!(look_up(&sentence[*k].text), Some(Sense::Noun(_, true))))
            .collect();
        let open = |k: &usize| !sentence[..*k].iter().rev().take(3).any(|t| number(t).is_some());
        let listed = plural.len() > 1
            && plural.iter().all(open)
            && (plural[0]..lead).all(|k| {
                plural.contains(&k)
                    || ends(Some(&sentence[k]))
                    || matches!(
                        sentence[k].text.as_str(),
                        "and"
                            | "as"
                            | "or"
                            | "plus"
                            | "in"
                            | "this"
                            | "the"
                            | "scene"
                            | "picture"
                            | "here"
                            | "there"
                    )
                    || matches!(
                        look_up(&sentence[k].text),
                        Some(Sense::State(_, false) | Sense::Attribute(_))
                    )
            });
        if !listed {
            out.extend_from_slice(sentence);
            continue;
        }
        let first = begins(
            &sentence[plural[0].saturating_sub(2)..],
            "as many|equally many|just as many",
        )
        .map_or(plural[0], |_| plural[0] - 2);
        out.extend_from_slice(&sentence[..first]);
        for (j, k) in plural.iter().enumerate() {
            if j > 0 {
                out.push(word("and", &sentence[*k]));
            }
            out.push(digits(many, &sentence[*k]));
            out.push(sentence[*k].clone());
        }
        out.extend_from_slice(&sentence[at + n..]);
    }
    out
}

fn is_strip(word: &str) -> bool {
    word == "sides"
        || matches!(
            look_up(word),
            Some(Sense::Place(
                Anchor::Lane(LaneRole::Roadside | LaneRole::Sidewalk),
                _
            ))
        )
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

/// "the truck is parked, and so is the bus" in a word of its own.
fn so_is(tokens: &[Token]) -> Vec<Token> {
    const SO: &str = "so is|so are|so was|so were|so does|so do|so did|so has|so have|so stands|so stand|as is|as are|as does|as do|just as is|likewise is|likewise are";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    let mut named = false;
    while i < tokens.len() {
        named |= is_noun(&tokens[i]);
        let led = opens(tokens, i) && named;
        match begins(&tokens[i..], SO).filter(|n| {
            led && tokens[i + n..]
                .iter()
                .take(5)
                .take_while(|t| !ends(Some(t)))
                .any(is_noun)
        }) {
            Some(n) => {
                out.push(word("soistoo", &tokens[i]));
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

/// "on the two pavements": on both.
fn two_strips(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let two = begins(&tokens[i..], "the two|our two|these two|the 2").filter(|n| {
            tokens
                .get(i + n)
                .is_some_and(|t| t.text.ends_with('s') && is_strip(&t.text))
        });
        match two {
            Some(n) => {
                out.push(word("both", &tokens[i]));
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

/// "on both sides, two each", "four per side": on each side.
fn per_side(tokens: &[Token]) -> Vec<Token> {
    const PER: &str = "per side|a side|each side|to each side|to a side|at each side|along each side|per kerb|per curb|per pavement|per sidewalk|for each side|per edge|either side|each kerb|each pavement|each sidewalk|on each of them|on either of them|to either side|on each one";
    const EACH: &str = "each|apiece|on each|on either|along each|at each|per each";
    const BOTH: &str = "both sides|each side|either side|both kerbs|both curbs|both pavements|both sidewalks|both edges|both footpaths|both shoulders|both verges|left and right|opposite sides|opposite pavements|opposite sidewalks";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    let mut sides = false;
    while i < tokens.len() {
        if tokens[i].kind == TokenKind::Stop && tokens[i].text != ";" {
            sides = false;
        }
        sides |= begins(&tokens[i..], BOTH).is_some();
        // (the number of a noun is no share: "two cars each")
        let counted = out.last().is_some_and(|t| number(t).is_some()) && out.len() > 1;
        let n = begins(&tokens[i..], PER)
            .or_else(|| begins(&tokens[i..], EACH).filter(|n| sides && ends(tokens.get(i + n))))
            .filter(|_| counted);
        match n {
            Some(n) => {
                out.extend(["on", "each", "side"].map(|w| word(w, &tokens[i])));
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

/// "first at 10 m, then at 20 m": one at 10 m, one at 20 m.
fn one_by_one(tokens: &[Token]) -> Vec<Token> {
    let far = |i: usize| {
        let at = begins(&tokens[i..], "at|at about|at roughly|after")?;
        let unit = tokens.get(i + at + 1).is_some_and(is_unit);
        (tokens.get(i + at).is_some_and(|t| number(t).is_some()) && unit).then_some(())
    };
    let lead = |i: usize| {
        begins(
            &tokens[i..],
            "and then|then|and next|next|and finally|finally|and lastly|lastly",
        )
    };
    let first =
        (1..tokens.len()).find(|i| tokens[*i].text == "first" && opens(tokens, *i) && far(i + 1).is_some());
    let Some(first) = first else {
        return tokens.to_vec();
    };
    let then = |i: usize| opens(tokens, i) && lead(i).is_some_and(|n| far(i + n).is_some());
    if !(first..tokens.len()).any(then) {
        return tokens.to_vec();
    }
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let n = if i == first {
            Some(1)
        } else {
            lead(i).filter(|_| i > first && then(i))
        };
        match n {
            Some(n) => {
                out.push(word("one", &tokens[i]));
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

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn shares_in_numbers() {
        let said = |t: &str| {
            let list: Vec<String> = counted(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("six cars: half of them come, the other half go"),
            "six cars : 3 of them come , the others go"
        );
        assert_eq!(
            said("parked cars on both sides, two each"),
            "parked cars on both sides , two on each side"
        );
        assert_eq!(said("four cars, two per side"), "four cars , two on each side");
        assert_eq!(
            said("as many buses as trucks, namely two of each"),
            "2 buses and 2 trucks"
        );
        assert_eq!(said("half a mile ahead"), "half a mile ahead");
        assert_eq!(
            said("cars: first at 10 m, then at 20 m"),
            "cars : one at 10 m , one at 20 m"
        );
    }
}
