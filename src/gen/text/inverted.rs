//! Prompts whose words stand in another order, or that say in a relative clause what a plain one says: "parked behind that is
//! a van", "the children it is waiting for", "some fool has parked his van", "he shows us his back".

use super::ellipsis::{is_noun, number};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, word};

/// A prompt in plain order.
pub fn ordered(tokens: &[Token]) -> Vec<Token> {
    let out = replaced(
        tokens,
        "around is|about is|present is|in sight is|to be seen is",
        "is",
    );
    let out = replaced(
        &out,
        "nothing but|nothing except|nothing other than|nothing more than",
        "only",
    );
    let out = pointing_back(&led_by_others(&drivers(&out)));
    let out = whom_we_follow(&held_by_place(&without_empty_places(&out)));
    let out = participle_first(&out);
    let out = crossed_over(&out);
    let out = beyond(&out);
    let out = without_contact_clause(&out);
    let out = way_of_another(&out);
    let out = lets_go(&parker(&put_up(&out)));
    let out = labels(&out);
    let out = shown(&out);
    let out = watched_from(&out);
    let out = namely(&out);
    let out = replaced(
        &out,
        "namely|to wit|viz|that is to say|specifically|to be exact",
        "which is",
    );
    let out = replaced(
        &out,
        "nothing else on wheels|nothing on wheels|nothing else that moves|no other traffic|nothing else drives|nothing else on the road",
        "no other vehicles",
    );
    replaced(
        &out,
        "besides us|besides me|apart from us|apart from me|aside from us|aside from me|besides ours|besides mine|besides my own|besides our own|apart from ours|apart from mine|apart from my own|aside from ours|in addition to ours|not counting mine|not counting ours|not counting my own",
        "",
    )
}

/// "traffic, namely four cars and a truck": what follows lists it.
fn namely(tokens: &[Token]) -> Vec<Token> {
    const NAMELY: &str = "namely|to wit|viz|that is to say|to be exact|specifically|in the form of|in the shape of|consisting of|made up of|composed of|comprising|which consists of|which consist of|that consists of|which is made up of|which is composed of|which comprises|meaning|that is|i e|ie|in other words|being";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let before = out.iter().rev().find(|t| t.kind != TokenKind::Comma);
        let sorts = before.is_some_and(|t| {
            matches!(look_up(&t.text), Some(Sense::Noun(n, many)) if n.classes.len() > 2 && many || t.text == "traffic")
        });
        let n = begins(&tokens[i..], NAMELY).filter(|n| sorts && tokens.get(i + n).is_some_and(is_fresh));
        match n {
            Some(n) => {
                while out.last().is_some_and(|t| t.kind == TokenKind::Comma) {
                    out.pop();
                }
                out.push(Token {
                    kind: TokenKind::Mark,
                    ..word(":", &tokens[i])
                });
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

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || matches!(
            tokens[i - 1].kind,
            TokenKind::Comma | TokenKind::Stop | TokenKind::Mark
        )
        || matches!(tokens[i - 1].text.as_str(), "and" | "while" | "but")
}

fn is_fresh(t: &Token) -> bool {
    matches!(t.text.as_str(), "a" | "an" | "another") || number(t).is_some()
}

/// "a van driver has stopped for them": his van has; who drives is not on foot.
fn drivers(tokens: &[Token]) -> Vec<Token> {
    const DRIVES: &str = "stops|stop|has stopped|have stopped|stopped|brakes|is braking|yields|is yielding|gives way|is giving way|lets|is letting|drives|drive|is driving|are driving|overtakes|overtake|is overtaking|are overtaking|turns|is turning|approaches|is approaching|follows|is following|tailgates|is tailgating|comes towards|is coming towards|cuts in|pulls out|is pulling out|reverses|is reversing|slows down|is slowing down";
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
        let drives = who && begins(&tokens[i + 1..], DRIVES).is_some() && !on_foot();
        let vehicle = out.last().is_some_and(
            |b| matches!(look_up(&b.text), Some(Sense::Noun(n, _)) if n.classes[0].is_vehicle()),
        );
        let fresh = out
            .iter()
            .rev()
            .take(3)
            .any(|b| matches!(b.text.as_str(), "a" | "an" | "another" | "one" | "two" | "three"));
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
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = begins(&tokens[i..], "that|which|whom|who")
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
            });
        match found {
            Some((n, place)) => {
                out.extend(place.split(' ').map(|w| word(w, &tokens[i])));
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

/// "flanked by two motorbikes, a limousine comes": a limousine comes, flanked by two motorbikes.
fn led_by_others(tokens: &[Token]) -> Vec<Token> {
    const BY: &str = "flanked by|followed by|accompanied by|escorted by|preceded by|chased by|trailed by|pursued by|surrounded by|closely followed by|tailed by|overtaken by|being overtaken by|being followed by";
    let mut out: Vec<Token> = Vec::new();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let moved = begins(sentence, BY).and_then(|_| {
            // ("flanked by two motorbikes, one on each side, a car": the last comma before the subject)
            let mut commas = (1..sentence.len().min(20)).filter(|k| sentence[*k].kind == TokenKind::Comma);
            let comma = commas
                .rfind(|k| {
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

/// "behind that a van": behind it.
fn pointing_back(tokens: &[Token]) -> Vec<Token> {
    let mut out = tokens.to_vec();
    for i in 1..tokens.len() {
        let that = matches!(tokens[i].text.as_str(), "that" | "this");
        let led = matches!(
            tokens[i - 1].text.as_str(),
            "behind" | "of" | "beside" | "after" | "before" | "to" | "near" | "following"
        );
        let next = tokens.get(i + 1).is_none_or(|t| {
            t.kind != TokenKind::Word
                || is_fresh(t)
                || matches!(
                    t.text.as_str(),
                    "is" | "are" | "there" | "stands" | "comes" | "and" | "again" | "waits"
                )
        });
        if that && led && next {
            out[i].text = "it".into();
        }
    }
    out
}

/// "a bus has stopped at the zebra, and two children are walking over": over the zebra.
fn crossed_over(tokens: &[Token]) -> Vec<Token> {
    let zebra = |t: &Token| matches!(t.text.as_str(), "zebra" | "crosswalk" | "stripes" | "crossing");
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        out.push(t.clone());
        let over = matches!(t.text.as_str(), "over" | "across")
            && tokens
                .get(i + 1)
                .is_none_or(|n| matches!(n.kind, TokenKind::Comma | TokenKind::Stop));
        let walks = i > 0
            && matches!(
                tokens[i - 1].text.as_str(),
                "walking"
                    | "walks"
                    | "walk"
                    | "going"
                    | "goes"
                    | "running"
                    | "runs"
                    | "hurrying"
                    | "hurries"
                    | "strolling"
            );
        if over && walks && tokens[..i].iter().any(zebra) {
            out.pop();
            out.extend(["across", "the", "zebra"].map(|w| word(w, t)));
        }
    }
    out
}

/// "beyond the cones": farther on than they are.
fn beyond(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let rest = &tokens[i + 1..];
        let article = begins(rest, "the|that|those|these|this").unwrap_or(0);
        let named = rest.get(article).is_some_and(is_noun) || begins(rest, "them|it|him|her").is_some();
        if t.text == "beyond" && named {
            out.extend(["further", "on", "than"].map(|w| word(w, t)));
        } else {
            out.push(t.clone());
        }
    }
    out
}

/// "parked in front of that is a roller" is "in front of that is a parked roller".
fn participle_first(tokens: &[Token]) -> Vec<Token> {
    let mut out = tokens.to_vec();
    for i in 0..tokens.len() {
        let state = matches!(
            tokens[i].text.as_str(),
            "parked" | "standing" | "waiting" | "stopped" | "sitting" | "walking"
        );
        let placed = (1..=5.min(tokens.len() - i - 1)).any(|n| {
            let words: Vec<&str> = tokens[i + 1..=i + n].iter().map(|t| t.text.as_str()).collect();
            matches!(
                look_up(&words.join(" ")),
                Some(Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At | Sense::Possessed(_))
            )
        });
        if !state || !opens(tokens, i) || !placed {
            continue;
        }
        let verb = (i + 2..tokens.len().min(i + 14))
            .take_while(|k| !matches!(tokens[*k].kind, TokenKind::Comma | TokenKind::Stop))
            .find(|k| matches!(tokens[*k].text.as_str(), "is" | "are" | "was" | "were"));
        if let Some(k) = verb.filter(|k| tokens.get(k + 1).is_some_and(is_fresh)) {
            let state = out.remove(i);
            out.insert(k + 1, state);
            break;
        }
    }
    out
}

/// "the children it is waiting for are walking over": a clause without a pronoun of its own says nothing of where they are.
fn without_contact_clause(tokens: &[Token]) -> Vec<Token> {
    let be = |t: Option<&Token>| {
        t.is_some_and(|t| matches!(t.text.as_str(), "is" | "are" | "was" | "were" | "has" | "have"))
    };
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let subject = matches!(tokens[i].text.as_str(), "it" | "he" | "she" | "they");
        let led = out.last().is_some_and(is_noun);
        let doing = be(tokens.get(i + 1)) && tokens.get(i + 2).is_some_and(|t| t.text.ends_with("ing"));
        let prep = tokens
            .get(i + 3)
            .is_some_and(|t| matches!(t.text.as_str(), "for" | "to" | "at" | "on" | "with" | "behind"));
        if subject && led && doing && prep && be(tokens.get(i + 4)) {
            i += 4;
            continue;
        }
        out.push(tokens[i].clone());
        i += 1;
    }
    out
}

/// "the lane ahead of it": the lane, and ahead of it.
fn way_of_another(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let lane = i > 0 && matches!(tokens[i - 1].text.as_str(), "lane" | "road" | "way" | "street");
        let of = begins(&tokens[i..], "ahead of|in front of").filter(|_| lane);
        let mine =
            of.is_some_and(|n| begins(&tokens[i + n..], "me|us|my|our|the ego|ego|the host").is_some());
        if of.is_some() && !mine && i + 2 < tokens.len() {
            out.push(Token {
                kind: TokenKind::Comma,
                ..word(",", t)
            });
        }
        out.push(t.clone());
    }
    out
}

/// "some fool has parked his van there": a van is parked; who parked it is not there, if nothing more is said of him.
fn parker(tokens: &[Token]) -> Vec<Token> {
    const WHO: &str = "some fool|some idiot|some moron|some jerk|some genius|some clown|some joker|some maniac|some driver|some guy|some bloke|some motorist|a fool|an idiot|somebody|someone|a driver|a motorist|its driver|the driver|the owner|its owner|some fellow|some person|some dimwit|some twit|some lunatic";
    const LEFT: &str = "has parked|have parked|parked|has left|left|has abandoned|abandoned|has dumped|dumped|has ditched|has double parked|has stuck|has put|put|has leaving";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let whole = begins(&tokens[i..], WHO).and_then(|n| {
            let verb = begins(&tokens[i + n..], LEFT)?;
            let k = i + n + verb;
            // ("somebody left a trailer standing there": what is left there is told, not who left it)
            let his = tokens
                .get(k)
                .is_some_and(|t| matches!(t.text.as_str(), "his" | "her" | "their" | "a" | "an" | "the"));
            let noun = (k + 1..tokens.len().min(k + 5)).find(|j| is_noun(&tokens[*j]))?;
            let more = tokens.get(noun + 1..).is_some_and(|rest| {
                rest.iter()
                    .take_while(|t| !matches!(t.kind, TokenKind::Stop))
                    .zip(rest.iter().skip(1))
                    .any(|(a, b)| {
                        a.text == "and"
                            && matches!(
                                b.text.as_str(),
                                "is" | "stands" | "walks" | "now" | "has" | "he" | "she"
                            )
                    })
            });
            (his && !more).then_some((k, noun))
        });
        match whole {
            Some((his, noun)) => {
                out.push(word("a", &tokens[i]));
                out.extend_from_slice(&tokens[his + 1..=noun]);
                let stands = tokens.get(noun + 1).is_some_and(|t| {
                    matches!(
                        t.text.as_str(),
                        "standing" | "parked" | "abandoned" | "lying" | "unattended" | "waiting" | "behind"
                    )
                });
                let state: &[&str] = if stands { &["is"] } else { &["is", "parked"] };
                out.extend(state.iter().map(|w| word(w, &tokens[i])));
                i = noun + 1;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "someone has put up three barriers": there are three.
fn put_up(tokens: &[Token]) -> Vec<Token> {
    const WHO: &str = "someone|somebody|some idiot|some fool|some guy|they|the police|the workers|the builders|the council|people|the firemen|workmen|the road workers|the authorities|the city";
    const PUT: &str = "has put up|have put up|put up|has set up|have set up|set up|has placed|have placed|placed|has erected|have erected|erected|has put|have put|has left|have left|has installed|have installed|has deployed|have deployed|has laid out|have laid out|has put out|have put out|put out|have positioned|has positioned";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let whole = begins(&tokens[i..], WHO)
            .filter(|_| opens(tokens, i))
            .and_then(|n| {
                let k = i + n + begins(&tokens[i + n..], PUT)?;
                (number(tokens.get(k)?)? > 1 && tokens[k + 1..].iter().take(4).any(is_noun)).then_some(k)
            });
        match whole {
            Some(k) => {
                out.extend(["there", "are"].map(|w| word(w, &tokens[i])));
                i = k;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "a lorry lets two girls go over the zebra": it waits for two girls who go over it.
fn lets_go(tokens: &[Token]) -> Vec<Token> {
    const LETS: &str = "lets|is letting|has let|allows|is allowing|let|permits";
    const GO: &str = "go|pass|cross|walk|come|run|get|step|stroll|hurry";
    let mut out = tokens.to_vec();
    for i in 1..tokens.len() {
        let Some(n) = begins(&tokens[i..], LETS).filter(|_| is_noun(&tokens[i - 1])) else {
            continue;
        };
        let verb = (i + n + 1..tokens.len().min(i + n + 6)).find(|k| begins(&tokens[*k..], GO).is_some());
        let Some(k) = verb.filter(|k| tokens[i + n..*k].iter().any(is_noun)) else {
            continue;
        };
        let to = usize::from(tokens[k - 1].text == "to");
        let mut new = tokens[..i].to_vec();
        new.extend(["waits", "for"].map(|w| word(w, &tokens[i])));
        new.extend_from_slice(&tokens[i + n..k - to]);
        new.push(word("who", &tokens[k]));
        new.extend_from_slice(&tokens[k..]);
        out = new;
        break;
    }
    out
}

/// "Rear: a van", "range 20 m": labels of a list in words.
fn labels(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let colon = tokens.get(i + 1).is_some_and(|t| t.text == ":");
        let label = match t.text.as_str() {
            "rear" | "back" => Some("behind me"),
            "front" => Some("in front of me"),
            _ => None,
        };
        if let Some(label) = label.filter(|_| colon && opens(tokens, i)) {
            out.extend(label.split(' ').map(|w| word(w, t)));
            continue;
        }
        let measure = matches!(t.text.as_str(), "range" | "distance" | "headway" | "gap") && opens(tokens, i);
        let from = i + 1 + usize::from(colon);
        let metres = tokens
            .get(from)
            .is_some_and(|n| matches!(n.kind, TokenKind::Number(_)))
            && tokens
                .get(from + 1)
                .is_some_and(|u| matches!(look_up(&u.text), Some(Sense::Unit(_))));
        if measure && metres && !colon {
            out.push(word("at", t));
            continue;
        }
        out.push(t.clone());
    }
    out
}

/// "shows us its back", "has its front to me": how it faces.
fn shown(tokens: &[Token]) -> Vec<Token> {
    const SHOWS: &str = "shows|show|showing|turns|turn|turning|presents|presenting|offers|has|have|having|with|points|pointing";
    let front = |w: &str| {
        matches!(
            w,
            "front"
                | "nose"
                | "face"
                | "bonnet"
                | "hood"
                | "headlights"
                | "headlamps"
                | "grille"
                | "fronts"
                | "faces"
        )
    };
    let back = |w: &str| {
        matches!(
            w,
            "back" | "rear" | "tail" | "backs" | "taillights" | "boot" | "backside"
        )
    };
    let me = |t: Option<&Token>| t.is_some_and(|t| matches!(t.text.as_str(), "me" | "us"));
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let found = begins(&tokens[i..], SHOWS).and_then(|n| {
            let mut k = i + n;
            let mut ego = me(tokens.get(k));
            k += usize::from(ego);
            let own = tokens
                .get(k)
                .is_some_and(|t| matches!(t.text.as_str(), "its" | "his" | "her" | "their"));
            let part = tokens.get(k + 1)?.text.clone();
            k += 2;
            if !ego {
                let turned = begins(&tokens[k..], "turned").unwrap_or(0);
                let to = begins(&tokens[k + turned..], "to|towards|toward|at|on")?;
                ego = me(tokens.get(k + turned + to));
                k += turned + to + 1;
            }
            let way = if front(&part) {
                "facing"
            } else if back(&part) {
                "facing away from"
            } else {
                return None;
            };
            (own && ego).then_some((way, k))
        });
        match found {
            Some((way, end)) => {
                out.extend(way.split(' ').map(|w| word(w, &tokens[i])));
                out.push(word("me", &tokens[i]));
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

/// "watches from the pavement", "directs the traffic from the centre": who looks on is there.
fn watched_from(tokens: &[Token]) -> Vec<Token> {
    const DIRECTS: &str = "directing the traffic|directing traffic|directs the traffic|directs traffic|regulating the traffic|regulating traffic|regulates the traffic|regulates traffic|controlling the traffic|controlling traffic|controls the traffic|waving traffic through|waving the traffic through|guiding the traffic|guiding traffic";
    let tokens = replaced(tokens, DIRECTS, "standing");
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let watches = i > 0
            && matches!(
                tokens[i - 1].text.as_str(),
                "watching"
                    | "watch"
                    | "watches"
                    | "looking"
                    | "look"
                    | "looks"
                    | "on"
                    | "standing"
                    | "waving"
                    | "waves"
                    | "observing"
                    | "observe"
                    | "shouting"
                    | "calling"
                    | "staring"
            );
        if t.text == "from"
            && watches
            && tokens
                .get(i + 1)
                .is_some_and(|n| matches!(n.text.as_str(), "the" | "a" | "my" | "our"))
        {
            let centre = tokens
                .get(i + 2)
                .is_some_and(|n| matches!(n.text.as_str(), "middle" | "centre" | "center"));
            out.push(word(if centre { "in" } else { "on" }, t));
        } else {
            out.push(t.clone());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn words_in_plain_order() {
        let said = |t: &str| {
            let list: Vec<String> = ordered(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("and parked in front of that is a van"),
            "and in front of it is a parked van"
        );
        assert_eq!(
            said("the children it is waiting for are walking"),
            "the children are walking"
        );
        assert_eq!(
            said("some fool has parked his van on the pavement"),
            "a van is parked on the pavement"
        );
        assert_eq!(said("Rear: a van, range 20 m"), "behind me : a van , at 20 m");
        assert_eq!(said("the other shows me its front"), "the other facing me");
        assert_eq!(
            said("it blocks the lane ahead of it"),
            "it blocks the lane , ahead of it"
        );
    }
}
