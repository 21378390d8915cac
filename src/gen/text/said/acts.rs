//! From what is said of something in the scene to commands: it goes, it becomes something else, it is elsewhere, it turns,
//! it comes nearer, it stays.

use super::super::edit_command::{note_definite, parse, target_part};
use super::super::edit_grammar::{Back, Command, Destination, Turn};
use super::super::edit_moving::{direction, is_turn_word, metres_at, turn_of};
use super::super::lexicon::{Sense, look_up};
use super::super::tag::{Item, Tag, tag};
use super::super::tokens::{Span, Token};
use super::super::words::edits::Verb;
use super::predicate::{Part, alone, new_kind};
use super::subject::{Kind, Subject};
use super::words::{find, first_noun, has_noun, is, is_place, led, number, text};
use super::{Piece, Talk};
use crate::scene::graph::RelationKind;

const BECOMES: &[&str] = &[
    "become",
    "becomes",
    "became",
    "turn into",
    "turns into",
    "turned into",
    "change into",
    "changes into",
    "changed into",
    "changed to",
    "change to",
    "changes to",
    "transformed into",
    "transforms into",
    "transform into",
    "morphs into",
    "morphed into",
    "converted into",
    "converted to",
    "swapped for",
    "swapped with",
    "swapped out for",
    "swapped by",
    "swapped against",
    "exchanged for",
    "exchanged with",
    "exchanged by",
    "exchanged against",
    "replaced by",
    "replaced with",
    "replaced for",
    "substituted by",
    "substituted with",
    "substituted for",
    "traded for",
    "switched for",
    "switched to",
    "switched with",
    "made into",
    "upgraded to",
    "downgraded to",
    "succeeded by",
    "turned out to be",
    "turns out to be",
    "make way for",
    "makes way for",
    "makes room for",
    "make room for",
    "give place to",
    "in fact",
];
const STAYS: &[&str] = &[
    "stay",
    "stays",
    "stayed",
    "remain",
    "remains",
    "remained",
    "keep still",
    "left as",
    "left alone",
    "left where",
    "untouched",
    "unchanged",
    "kept",
    "keep its place",
    "as it is",
    "as they are",
    "as before",
    "fine",
    "ok",
    "okay",
    "good",
    "right where",
    "not touched",
];
const TURNS: &[&str] = &[
    "face",
    "faces",
    "faced",
    "facing",
    "look",
    "looks",
    "looking",
    "point",
    "points",
    "pointed",
    "pointing",
    "turn",
    "turns",
    "turned",
    "turning",
    "rotate",
    "rotates",
    "rotated",
    "spin",
    "spins",
    "spun",
    "swivel",
    "swivels",
    "headed",
    "oriented",
    "orientated",
    "aimed",
    "flipped",
    "reversed",
];
/// Ways to go that a heading follows from.
const OTHER_WAY: &[&str] = &[
    "the other way round",
    "the other way around",
    "the other way",
    "other way",
    "the opposite way",
    "opposite way",
    "in the opposite direction",
    "in the other direction",
    "the opposite direction",
    "the other direction",
    "in reverse direction",
    "the wrong way",
    "against the traffic",
    "in opposite direction",
    "back the way it came",
    "the way it came",
];
const OUR_WAY: &[&str] = &[
    "the same way as i do",
    "the same way as me",
    "the same way as us",
    "the same way as we do",
    "the same way i do",
    "the same way we do",
    "the same way i am",
    "the same way",
    "same way as me",
    "same way as us",
    "same way as i do",
    "in the same direction as i do",
    "in the same direction as me",
    "in the same direction as us",
    "in the same direction as we do",
    "in the same direction",
    "the same direction as me",
    "the same direction as us",
    "my way",
    "our way",
    "in my direction",
    "in our direction",
    "in the direction i drive",
    "away from us like the others",
    "same direction as me",
    "same direction as us",
    "same direction",
];
/// Verbs after which metres and a direction are a way to go, not a place.
pub const MOTION: &[&str] = &[
    "move",
    "moves",
    "moved",
    "shift",
    "shifts",
    "shifted",
    "slide",
    "slides",
    "slid",
    "go",
    "goes",
    "gone",
    "come",
    "comes",
    "came",
    "roll",
    "rolls",
    "rolled",
    "drive",
    "drives",
    "driven",
    "drove",
    "walk",
    "walks",
    "walked",
    "step",
    "steps",
    "stepped",
    "back",
    "backs",
    "backed",
    "pull",
    "pulls",
    "pulled",
    "push",
    "pushed",
    "pushes",
    "nudge",
    "nudged",
    "creep",
    "creeps",
    "advance",
    "advances",
    "advanced",
    "drop",
    "drops",
    "dropped",
    "fall",
    "falls",
    "fallen",
    "set",
    "put",
    "bring",
    "brought",
    "take",
    "taken",
    "send",
    "sent",
    "drag",
    "dragged",
    "reverse",
    "reverses",
    "edge",
    "inch",
    "ride",
    "rides",
    "ridden",
    "swerve",
    "displace",
    "displaced",
    "relocate",
    "relocated",
    "budge",
    "scoot",
    "reposition",
    "repositioned",
    "change",
    "changes",
    "switch",
    "switches",
    "merge",
    "merges",
    "moving",
    "close",
    "closes",
    "place",
    "placed",
];

fn span_of(tokens: &[Token]) -> Span {
    tokens.iter().fold(tokens[0].span, |s, t| s.to(t.span))
}

/// A command about a subject.
fn about(verb: Verb, s: &Subject, clause: &[Token], talk: &Talk<'_>) -> Command {
    let mut c = Command::new(verb, talk.text, span_of(clause));
    match s.kind {
        Kind::Back(back) => c.back = Some(back),
        _ => {
            let (np, nth) = without_ordinal(&s.np);
            c.nth = nth;
            target_part(talk.text, &tag(&np), &mut c);
        }
    }
    c
}

/// "the second truck": the ordinal is taken out.
fn without_ordinal(np: &[Token]) -> (Vec<Token>, Option<usize>) {
    let nth = |w: &str| {
        Some(match w {
            "first" => 1,
            "second" => 2,
            "third" => 3,
            "fourth" => 4,
            "fifth" => 5,
            "last" => 0,
            _ => return None,
        })
    };
    let at = (1..np.len()).find(|i| nth(text(&np[*i])).is_some() && is(np.get(i - 1), &["the"]));
    match at {
        Some(i) => {
            let mut out = np.to_vec();
            let n = nth(text(&out.remove(i)));
            (out, n)
        }
        None => (np.to_vec(), None),
    }
}

/// The commands of a subject and its verb phrases; empty if it stays as it is, `None` if it was not understood.
pub fn acts(
    s: &Subject,
    parts: &[Part],
    caused: bool,
    clause: &[Token],
    talk: &Talk<'_>,
) -> Option<Vec<Piece>> {
    let noun = (!s.noun.is_empty()).then(|| s.noun.clone());
    let meant = |c: Command| Piece::Meant(Box::new(c), noun.clone());
    let remembered = || meant(about(Verb::Note, s, clause, talk));
    // What is over says nothing of now, if now is said, too; a departure that goes on elsewhere is none.
    let later = |i: usize| {
        parts[i + 1..]
            .iter()
            .any(|p| !p.not && !p.main.is_empty() && (super::predicate::places(&p.main) || p.is_gone()))
    };
    let kept: Vec<&Part> = parts
        .iter()
        .enumerate()
        .filter(|(i, p)| !(p.begins(&["lets", "let", "allows", "makes room"]).is_some() && later(*i)))
        .filter(|(i, p)| !((p.perfect || p.is_gone() || p.not) && later(*i)))
        .map(|x| x.1)
        .collect();
    if kept.iter().any(|p| p.is_gone()) {
        return Some(vec![meant(about(Verb::Remove, s, clause, talk))]);
    }
    if kept.iter().all(|p| p.not) {
        // where it is not does not say where it is; who does not move stands
        let stops = kept.iter().any(|p| {
            p.begins(&[
                "moving", "move", "driving", "drive", "riding", "walking", "rolling",
            ])
            .is_some()
        });
        if stops {
            let mut c = about(Verb::Make, s, clause, talk);
            c.state = Some(crate::scene::graph::ObjectState::Waiting);
            return Some(vec![meant(c)]);
        }
        return Some(vec![remembered()]);
    }
    let said: Vec<&Part> = kept.into_iter().filter(|p| !p.not).collect();
    // "has gone over to the digger and stands beside it"
    let named: Option<Vec<Token>> = parts
        .iter()
        .filter_map(|p| first_noun(&p.main).map(|n| p.main[n.0..n.1].to_vec()))
        .next()
        .or_else(|| {
            talk.last
                .as_ref()
                .filter(|l| !s.noun.iter().any(|t| l.contains(text(t))))
                .map(|l| led(l, &clause[0], &[]))
        });
    let resolved: Vec<Part> = said
        .iter()
        .map(|p| Part {
            main: with_named(&p.main, named.as_ref(), s),
            ..(*p).clone()
        })
        .collect();
    let said: Vec<&Part> = resolved.iter().collect();
    let first = *said.first()?;
    if let Some(n) = first.begins(BECOMES).filter(|n| has_noun(&first.main[*n..])) {
        return become_of(s, &first.main[n..], clause, talk, noun.clone());
    }
    if first.helped && first.is || caused && first.helped {
        if let Some(new) = new_kind(&first.main) {
            return become_of(s, new, clause, talk, noun.clone());
        }
    }
    if let Some(n) = alone(&first.main).filter(|_| s.kind == Kind::Known && said.len() == 1) {
        let np: Vec<Token> = s.np.iter().filter(|t| number(t).is_none()).cloned().collect();
        return Some(vec![Piece::Plain(led("keep exactly", &clause[0], &[&[n], &np]))]);
    }
    let distance = first
        .begins(&[
            "keep",
            "keeps",
            "stay",
            "stays",
            "maintain",
            "maintains",
            "hold",
            "holds",
            "leave",
            "leaves",
            "remain",
            "remains",
        ])
        .is_some();
    if let (true, Some((metres, _))) = (distance, metres_in(&first.main)) {
        let mut c = about(Verb::Move, s, clause, talk);
        c.destination = Some(Destination::Range(metres));
        if places_beside(&first.main) {
            return placed(s, &said, clause, talk, noun);
        }
        return Some(vec![meant(c)]);
    }
    if first.begins(STAYS).is_some() && said.len() == 1 && metres_in(&first.main).is_none() {
        return Some(vec![remembered()]);
    }
    let mut main: Vec<Token> = joined(&said);
    if let Some((i, _)) = find(&main, &["back up", "backs up", "backed up", "backing up"]) {
        main[i] = super::words::word("back", &main[i].clone());
        main.remove(i + 1); // "up" leads forward
        if i == 0 {
            main.insert(0, super::words::word("move", &main[0].clone()));
        }
    }
    if let Some(factor) = times(&main) {
        let mut c = about(Verb::Move, s, clause, talk);
        c.destination = Some(Destination::Times(factor));
        return Some(vec![meant(c)]);
    }
    if let Some(destination) = step(&main, caused) {
        let mut c = about(Verb::Move, s, clause, talk);
        c.destination = Some(destination);
        return Some(vec![meant(c)]);
    }
    if let Some(turn) = turned(&main, &said) {
        let mut c = about(Verb::Turn, s, clause, talk);
        c.turn = Some(turn);
        return Some(vec![meant(c)]);
    }
    placed(s, &said, clause, talk, noun)
}

/// "twice as far", "half the distance": how many times as far as now.
pub fn times(main: &[Token]) -> Option<f64> {
    let far = find(
        main,
        &["as far", "the distance", "as close", "as near", "distance"],
    )?;
    let before = &main[..far.0];
    let factor = before.iter().rev().take(3).find_map(|t| {
        Some(match text(t) {
            "twice" | "double" | "doubled" => 2.0,
            "half" | "halve" => 0.5,
            "triple" | "thrice" => 3.0,
            _ => return None,
        })
    })?;
    let near = matches!(
        text(
            &main[far.0 + 1..far.0 + far.1]
                .last()
                .cloned()
                .unwrap_or_else(|| main[far.0].clone())
        ),
        "close" | "near"
    );
    Some(if near { 1.0 / factor } else { factor })
}

/// "beside it" with what "it" is, if something but the subject was named.
fn with_named(main: &[Token], noun: Option<&Vec<Token>>, s: &Subject) -> Vec<Token> {
    let Some(noun) = noun else {
        return main.to_vec();
    };
    let at =
        (1..main.len()).find(|i| is(main.get(*i), &["it", "him", "her", "them"]) && is_place(&main[i - 1..]));
    match at {
        Some(i) if s.noun.first().map(text) != noun.first().map(text) => {
            let mut out = main[..i].to_vec();
            out.extend(led("the", &main[i], &[noun]));
            out.extend_from_slice(&main[i + 1..]);
            out
        }
        _ => main.to_vec(),
    }
}

/// Metres that are no step: "behind us", "ahead of the bus".
fn places_beside(main: &[Token]) -> bool {
    (0..main.len()).any(|i| {
        matches!(
            super::words::longest(&main[i..]),
            Some((Sense::Rel(_) | Sense::EgoRel(_), _))
        ) && !matches!(
            text(&main[i]),
            "left" | "leave" | "leaves" | "keep" | "away" | "hold" | "holds"
        )
    })
}

fn metres_in(main: &[Token]) -> Option<(f64, usize)> {
    let items = tag(main);
    (0..items.len()).find_map(|i| metres_at(&items, i).map(|m| (m.0, i)))
}

fn joined(parts: &[&Part]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for p in parts {
        if let (Some(first), false) = (p.main.first(), out.is_empty()) {
            out.push(super::words::word("and", first));
        }
        out.extend_from_slice(&p.main);
    }
    out
}

fn become_of(
    s: &Subject,
    new: &[Token],
    clause: &[Token],
    talk: &Talk<'_>,
    noun: Option<Vec<Token>>,
) -> Option<Vec<Piece>> {
    let mut c = about(Verb::Replace, s, clause, talk);
    let (reading, mentions) = parse(talk.text, &tag(new));
    c.by = Some(mentions.first()?.clone());
    c.reading.not_understood.extend(reading.not_understood);
    let noun = first_noun(new).map(|n| new[n.0..n.1].to_vec()).or(noun);
    let where_to = c.by.as_ref().is_some_and(|m| !m.spec.relations.is_empty());
    let mut out = vec![Piece::Meant(Box::new(c.clone()), noun.clone())];
    // "should be a bus in the left lane"
    if let (true, Some(by)) = (where_to, c.by.as_ref()) {
        let mut m = Command::new(Verb::Move, talk.text, span_of(clause));
        m.back = Some(Back::Same);
        let spec = reading
            .description
            .foreground
            .first()
            .cloned()
            .unwrap_or_else(|| by.spec.clone());
        m.anchors = reading.description.foreground;
        m.destination = Some(Destination::Place(Box::new(spec)));
        note_definite(&mut m, &mentions);
        out.push(Piece::Meant(Box::new(m), noun));
    }
    Some(out)
}

/// Nearer, farther, so many metres or lanes: a way to go from where it is.
fn step(main: &[Token], caused: bool) -> Option<Destination> {
    let motion = main.first().is_some_and(|t| MOTION.contains(&text(t)));
    if let Some(lanes) = lanes(main, motion) {
        return Some(Destination::Lanes(lanes));
    }
    let items = tag(main);
    let metres = (0..items.len()).find_map(|i| metres_at(&items, i).map(|(m, n)| (i, m, n)));
    // nearer to something else than the ego vehicle is a place by it
    let nearer = [
        "closer",
        "nearer",
        "up closer",
        "closer up",
        "up close",
        "closer by",
        "closer to",
        "nearer to",
        "close to",
    ];
    let farther = [
        "further away",
        "farther away",
        "further off",
        "farther off",
        "further",
        "farther",
        "farther apart",
        "more distant",
        "further out",
        "farther out",
    ];
    let compared = items.iter().position(|i| {
        let w = i.words.as_str();
        nearer[..8].contains(&w)
            || farther.contains(&w)
            || direction(w).is_some() && (w.starts_with("further") || w.starts_with("farther"))
    });
    if let Some(k) = compared {
        let w = items[k].words.as_str();
        let rest = &items[k + 1..];
        let to_other = rest
            .iter()
            .take(4)
            .any(|i| matches!(i.tag, Tag::Is(Sense::Noun(..) | Sense::Place(..))));
        if to_other {
            return None;
        }
        let asked = metres.filter(|m| {
            // "nearer, say 8 metres", "closer: 8 m", "further back, at 20 m"
            m.0 > k
                && items[k + 1..m.0].iter().any(|i| {
                    matches!(i.tag, Tag::Comma | Tag::Mark)
                        || matches!(
                            i.words.as_str(),
                            "say" | "at" | "only" | "to" | "about" | "until" | "just" | "ie"
                        )
                })
        });
        if let Some(m) = asked {
            return Some(Destination::Range(m.1));
        }
        let amount = metres.map(|m| m.1);
        if let Some(direction) = direction(w).or_else(|| rest.first().and_then(|i| direction(&i.words))) {
            return Some(Destination::By {
                direction,
                metres: amount,
            });
        }
        return Some(Destination::Toward {
            away: farther.contains(&w),
            metres: amount,
        });
    }
    // (a place that was named, too, says that the metres are none on the way)
    let placed = metres.is_some_and(|m| {
        items[..m.0]
            .iter()
            .any(|x| matches!(x.tag, Tag::Is(Sense::EgoRel(_))) && !x.words.starts_with("back"))
    });
    let named = placed
        || items.iter().any(|x| {
            matches!(
                x.tag,
                Tag::Is(
                    Sense::Place(..) | Sense::Rel(_) | Sense::Noun(..) | Sense::Fixed(..) | Sense::Pronoun
                )
            )
        });
    if let Some((i, m, n)) = metres.filter(|_| (motion || caused) && !named) {
        let next = items.get(i + n);
        let to_me = items[i + n..]
            .iter()
            .any(|x| matches!(x.tag, Tag::Is(Sense::Ego)));
        let way = next.and_then(|x| direction(&x.words));
        let ends = items[i + n + usize::from(way.is_some())..]
            .iter()
            .all(|x| matches!(x.tag, Tag::Is(Sense::Filler) | Tag::Comma));
        if let (Some(direction), true, true) = (way, ends, motion) {
            return Some(Destination::By {
                direction,
                metres: Some(m),
            });
        }
        // "back it up by 5 m", "move back 5 m"
        let before = i.checked_sub(1).map(|k| items[k].words.as_str());
        let by = before == Some("by");
        let lead = items[..i]
            .iter()
            .rev()
            .take(2 + usize::from(by))
            .find_map(|x| direction(&x.words));
        if let (Some(direction), true, true) = (lead, i + n == items.len() || ends, motion) {
            return Some(Destination::By {
                direction,
                metres: Some(m),
            });
        }
        if motion
            && to_me
            && items[i + n..]
                .iter()
                .any(|x| matches!(x.words.as_str(), "towards" | "toward"))
        {
            return Some(Destination::Toward {
                away: false,
                metres: Some(m),
            });
        }
    }
    if motion && metres.is_none() {
        // "moves forward", "drops back a bit"
        let plain = |x: &Item| {
            matches!(
                x.tag,
                Tag::Is(
                    Sense::Filler
                        | Sense::State(..)
                        | Sense::Verb(_)
                        | Sense::Attribute(_)
                        | Sense::Article(_)
                        | Sense::Count(_)
                        | Sense::Size(_)
                )
            ) || x.tag == Tag::Unknown
                || matches!(x.words.as_str(), "up" | "over" | "on")
        };
        let ways: Vec<_> = items.iter().filter_map(|x| direction(&x.words)).collect();
        let rest = items.iter().all(|x| direction(&x.words).is_some() || plain(x));
        if let ([direction], true) = (ways.as_slice(), rest) {
            let side = items.iter().any(|x| x.words.ends_with(" side"));
            if !side {
                return Some(Destination::By {
                    direction: *direction,
                    metres: None,
                });
            }
        }
    }
    None
}

/// True if the words are a step from where something is: "one lane to the right", "5 m further back".
pub fn is_step(main: &[Token]) -> bool {
    let moved = match main.first() {
        Some(first) => led("move", first, &[main]),
        None => return false,
    };
    let marks = lanes(main, false).is_some()
        || main
            .iter()
            .any(|t| matches!(text(t), "closer" | "nearer" | "further" | "farther"));
    marks && step(&moved, true).is_some()
}

/// "one lane to the right", "over two lanes left", "changes lanes to the left".
fn lanes(main: &[Token], motion: bool) -> Option<i32> {
    let k = main.iter().position(|t| matches!(text(t), "lane" | "lanes"))?;
    let before = k.checked_sub(1).map(|i| &main[i]);
    let counted = before.and_then(|t| number(t).or(matches!(text(t), "a").then_some(1)));
    let changes = before.is_some_and(|t| {
        matches!(
            text(t),
            "change" | "changes" | "switch" | "switches" | "changed" | "switched" | "next" | "changing"
        )
    });
    if counted.is_none() && !(changes && motion) {
        return None;
    }
    let side = main[k + 1..].iter().take(5).find_map(|t| match text(t) {
        "left" | "leftwards" => Some(1),
        "right" | "rightwards" => Some(-1),
        _ => None,
    })?;
    Some(side * counted.unwrap_or(1).clamp(1, 6) as i32)
}

/// How it faces, where no lane or place is said with it.
fn turned(main: &[Token], parts: &[&Part]) -> Option<Turn> {
    let other = find(main, OTHER_WAY);
    let ours = find(main, OUR_WAY);
    let verb = parts.iter().any(|p| p.begins(TURNS).is_some());
    let stripped: Vec<Token> = {
        let cut = other.or(ours);
        let mut t = main.to_vec();
        if let Some((i, n)) = cut {
            t.drain(i..i + n);
        }
        t
    };
    let goes = |w: &str| {
        look_up(w).is_some_and(|s| {
            matches!(
                s,
                Sense::State(..) | Sense::Filler | Sense::Attribute(_) | Sense::And
            )
        })
    };
    // a place besides the direction is where it goes, and the lane says how it faces
    let place = (0..stripped.len()).any(|i| {
        matches!(
            super::words::longest(&stripped[i..]),
            Some((
                Sense::Place(..)
                    | Sense::Noun(..)
                    | Sense::EgoRel(_)
                    | Sense::Rel(_)
                    | Sense::Fixed(..)
                    | Sense::FarSide,
                _
            ))
        ) && !matches!(
            text(&stripped[i]),
            "face"
                | "faces"
                | "facing"
                | "look"
                | "looking"
                | "looks"
                | "point"
                | "pointing"
                | "turned"
                | "towards"
                | "toward"
                | "against"
                | "around"
                | "round"
                | "back"
                | "away"
                | "headed"
                | "to"
                | "backwards"
                | "left"
                | "right"
        ) && !(i > 0
            && is_place(&stripped[i - 1..])
            && matches!(
                text(&stripped[i - 1]),
                "face" | "faces" | "facing" | "towards" | "toward" | "to"
            ))
    });
    let _ = goes;
    if (other.is_some() || ours.is_some()) && !place {
        if ours.is_some() && other.is_none() {
            return Some(Turn::WithEgo);
        }
        // (a turn back and going the other way are one and the same)
        return Some(Turn::By(std::f64::consts::PI));
    }
    if !verb || parts.len() > 1 && place {
        return None;
    }
    // ("turn around" is one word of the lexicon)
    let led_by_turn = main.len() > 1
        && matches!(
            text(&main[0]),
            "turn" | "turns" | "turned" | "spin" | "spins" | "rotate" | "swivel" | "flip" | "face"
        );
    let from = usize::from(led_by_turn && !matches!(text(&main[0]), "face"));
    let items = tag(&main[from..]);
    let ego = items
        .iter()
        .any(|i| matches!(i.tag, Tag::Is(Sense::Ego | Sense::EgoRel(_))));
    let shows = |list: &[&str]| main.iter().any(|t| list.contains(&text(t)));
    if ego
        && shows(&["back", "backs", "rear", "tail"])
        && shows(&["to", "towards", "toward", "on", "at"])
        && !shows(&["face", "front"])
    {
        return Some(Turn::FromEgo);
    }
    if ego
        && shows(&[
            "come",
            "comes",
            "coming",
            "drive",
            "drives",
            "driving",
            "ride",
            "rides",
            "riding",
            "approach",
            "approaches",
            "approaching",
        ])
        && shows(&["towards", "toward", "at", "approaches", "approach", "approaching"])
    {
        return Some(Turn::Against);
    }
    if items.iter().any(|i| {
        is_turn_word(&i.words)
            || matches!(
                i.words.as_str(),
                "towards"
                    | "toward"
                    | "away from"
                    | "away"
                    | "left"
                    | "right"
                    | "to the left"
                    | "to the right"
                    | "backwards"
                    | "facing"
                    | "faces"
                    | "turned towards"
                    | "looking towards"
            )
    }) || items
        .iter()
        .any(|i| matches!(i.tag, Tag::Is(Sense::Ego) | Tag::Is(Sense::EgoRel(_))))
    {
        if place && !items.iter().any(|i| matches!(i.tag, Tag::Is(Sense::Ego))) {
            return None;
        }
        return turn_of(&items, 0);
    }
    None
}

/// Where it shall be, by what the words say of a noun like it.
fn placed(
    s: &Subject,
    said: &[&Part],
    clause: &[Token],
    talk: &Talk<'_>,
    noun: Option<Vec<Token>>,
) -> Option<Vec<Piece>> {
    let mut main = joined(said);
    // "push it back until it is 25 m behind": only where it ends counts
    if let Some((i, n)) = find(
        &main,
        &[
            "until it is",
            "until its",
            "until they are",
            "until he is",
            "until she is",
            "until it stands",
            "until it reaches",
            "until hes",
            "until shes",
            "until theyre",
            "until",
            "till it is",
            "till",
            "so that it is",
            "so that its",
            "so that it stands",
            "so that they are",
            "so that they stand",
            "so that he is",
            "so that she is",
            "so that it",
            "so it is",
            "so its",
            "so that they",
            "so that he",
            "so that she",
            "up to",
        ],
    ) {
        let after = &main[i + n..];
        if super::predicate::places(after) {
            main = after.to_vec();
        }
    }
    main = arrived(main);
    let mut c = about(Verb::Move, s, clause, talk);
    let head = match (&s.noun[..], talk.stand_in(s)) {
        ([], Some(word)) => vec![super::words::word(&word, &clause[0])],
        ([], None) => vec![super::words::word("car", &clause[0])],
        (noun, _) => noun.to_vec(),
    };
    let mut items = tag(&head);
    for i in &mut items {
        if let Tag::Is(Sense::Noun(n, _)) = i.tag {
            i.tag = Tag::Is(Sense::Noun(n, false));
        }
    }
    items.truncate(1);
    let complement = settled(tag(&main));
    items.extend(complement);
    let (reading, mentions) = parse(talk.text, &items);
    let spec = reading.description.foreground.first()?.clone();
    let ways = |r: RelationKind| {
        matches!(
            r,
            RelationKind::SameDirection
                | RelationKind::OppositeDirection
                | RelationKind::Facing
                | RelationKind::FacingAway
        )
    };
    if spec.relations.is_empty() {
        let state = spec.state?;
        if main.first().is_some_and(|t| MOTION.contains(&text(t))) {
            return None; // where to was not understood
        }
        let mut c = about(Verb::Make, s, clause, talk);
        c.state = Some(state);
        return Some(vec![Piece::Meant(Box::new(c), noun)]);
    }
    let only_way = spec.relations.iter().all(|r| {
        ways(r.relation) && r.anchor == super::super::description::Anchor::Ego && r.distance_m.is_none()
    });
    if only_way {
        let mut c = about(Verb::Turn, s, clause, talk);
        c.turn = Some(match spec.relations[0].relation {
            RelationKind::SameDirection => Turn::WithEgo,
            RelationKind::OppositeDirection => Turn::Against,
            RelationKind::Facing => Turn::ToEgo,
            _ => Turn::FromEgo,
        });
        return Some(vec![Piece::Meant(Box::new(c), noun)]);
    }
    note_definite(&mut c, &mentions);
    // what stands there is looked for, whoever is named
    c.reading.not_understood.extend(reading.not_understood);
    c.anchors = reading.description.foreground;
    c.destination = Some(Destination::Place(Box::new(spec)));
    Some(vec![Piece::Meant(Box::new(c), noun)])
}

/// "goes over to the left pavement" ends there, whichever way; "the other side" is that of the street.
fn arrived(mut main: Vec<Token>) -> Vec<Token> {
    // "where the cones are" is next to them
    if let Some(k) = main.iter().position(|t| text(t) == "where")
        && let Some((a, b)) = first_noun(&main[k..])
        && a < 4
        && main[k + b..].iter().all(|t| {
            super::words::HELPERS.contains(&text(t))
                || super::words::is_finite(text(t), true)
                || super::words::ADVERBS.contains(&text(t))
        })
    {
        let np = main[k + 1..k + b].to_vec();
        let next = led("next to", &main[k], &[&np]);
        main.truncate(k);
        main.extend(next);
        return main;
    }
    // "goes from the right lane to the left one"
    if let Some((i, _)) = find(&main, &["from", "out of", "away from"])
        && let Some(goal) =
            (i + 1..main.len()).find(|k| text(&main[*k]) == "to" || super::words::is_goal(&main[*k..]))
    {
        main.drain(i..goal);
    }
    let sides = [
        "to the other side of the road",
        "to the other side of the street",
        "to the opposite side of the road",
        "to the opposite side of the street",
        "to the far side of the road",
        "to the far side of the street",
        "to the other side",
        "to the opposite side",
        "to the far side",
        "on the other side",
        "on the opposite side",
        "over to the other side",
        "on the other side of the road",
        "on the other side of the street",
    ];
    if let Some((i, n)) = find(&main, &sides)
        && !main[i + n..].first().is_some_and(|t| text(t) == "of")
    {
        let over = led("across the street", &main[i], &[]);
        main.splice(i..i + n, over);
        while i > 0 && main.first().is_some_and(|t| text(t) != "across") && main.len() > 3 {
            main.remove(0);
        }
        return main;
    }
    // "comes back towards us"
    let mut i = 1;
    while i < main.len() {
        if text(&main[i]) == "back"
            && is(
                main.get(i + 1),
                &[
                    "to", "towards", "toward", "into", "onto", "in", "on", "at", "here",
                ],
            )
        {
            main.remove(i);
        }
        i += 1;
    }
    let to = (1..main.len().min(5)).find(|i| super::words::is_goal(&main[*i..]));
    let Some(to) = to else {
        return main;
    };
    let way = |t: &Token| {
        let w = text(t);
        MOTION.contains(&w)
            || matches!(
                w,
                "over"
                    | "across"
                    | "up"
                    | "off"
                    | "out"
                    | "right"
                    | "straight"
                    | "back"
                    | "along"
                    | "down"
                    | "on"
                    | "through"
                    | "and"
            )
            || super::words::is_finite(w, true)
                && !matches!(
                    w,
                    "stand"
                        | "stands"
                        | "wait"
                        | "waits"
                        | "park"
                        | "parks"
                        | "next"
                        | "close"
                        | "closes"
                        | "face"
                        | "faces"
                )
            || w.ends_with("ing")
                && matches!(
                    look_up(w),
                    Some(Sense::State(crate::scene::graph::ObjectState::Moving, _))
                )
    };
    let ends = main.get(to + 1..).is_some_and(|rest| {
        (0..rest.len().min(4)).any(|i| {
            matches!(
                super::words::longest(&rest[i..]),
                Some((Sense::Place(..) | Sense::Noun(..), _))
            )
        })
    });
    if main[..to].iter().all(way) && ends {
        let into = main[..to]
            .iter()
            .any(|t| matches!(text(t), "cross" | "crosses" | "crossed" | "crossing"))
            && text(&main[to]) != "to";
        if !into {
            main.drain(..to);
        }
    }
    main
}

/// "to the bus" is next to it, "to the left lane" in it.
fn settled(mut items: Vec<Item>) -> Vec<Item> {
    let mut i = 0;
    while i < items.len() {
        let w = items[i].words.clone();
        if matches!(items[i].tag, Tag::Is(Sense::Verb(_))) {
            items[i].tag = Tag::Is(Sense::Filler);
        }
        // "left roadside": on it
        let starts = items[..i]
            .iter()
            .rev()
            .find(|x| !matches!(x.tag, Tag::Is(Sense::Article(_) | Sense::Filler)))
            .is_none_or(|x| {
                matches!(x.tag, Tag::Comma | Tag::Mark | Tag::Is(Sense::And)) || x.words == "move"
            });
        if starts
            && matches!(items[i].tag, Tag::Is(Sense::Place(..)))
            && let Some(on) = look_up("on")
        {
            let item = Item {
                tag: Tag::Is(on),
                words: "on".into(),
                ..items[i].clone()
            };
            items.insert(i, item);
            i += 1;
        }
        let to = matches!(
            w.as_str(),
            "to" | "over to"
                | "up to"
                | "onto"
                | "into"
                | "on to"
                | "over into"
                | "over onto"
                | "across to"
                | "back to"
                | "towards"
                | "toward"
        );
        if to {
            let next = items[i + 1..].iter().find(|x| {
                !matches!(
                    x.tag,
                    Tag::Is(
                        Sense::Article(_)
                            | Sense::Filler
                            | Sense::Size(_)
                            | Sense::Color(_)
                            | Sense::Attribute(_)
                    )
                )
            });
            let anchor = match next.map(|n| n.tag) {
                Some(Tag::Is(Sense::Place(..))) => Some("on"),
                Some(Tag::Is(Sense::Noun(..) | Sense::Pronoun)) => Some("next to"),
                _ => None,
            };
            if let Some(sense) = anchor.and_then(look_up) {
                items[i].tag = Tag::Is(sense);
                items[i].words = anchor.unwrap_or("on").to_string();
            }
        }
        i += 1;
    }
    items
}

/// "move the bus behind me to the left lane": where the target ends and where to begins, by what the scene has.
pub fn split(tokens: &[Token], talk: &Talk<'_>) -> Option<usize> {
    let noun = first_noun(tokens)?;
    let starts: Vec<usize> = (noun.1..tokens.len())
        .filter(|i| is_place(&tokens[*i..]))
        .collect();
    let goal = starts.iter().copied().find(|i| {
        super::words::is_goal(&tokens[*i..]) || matches!(text(&tokens[*i]), "until" | "till" | "by")
    });
    let first = *starts.first()?;
    if talk.fits(&tokens[..first]) == 1 {
        return Some(first);
    }
    if let Some(goal) = goal {
        return Some(goal);
    }
    // the first place says which, if that leaves one and another place follows
    let mut ends = starts.clone();
    ends.retain(|i| talk.fits(&tokens[..*i]) == 1);
    Some(ends.first().copied().unwrap_or(first))
}
