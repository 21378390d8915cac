//! From what is said of something in the scene to commands: it goes, it becomes something else, it is elsewhere, it turns,
//! it comes nearer, it stays.

use super::super::edit_command::{note_definite, parse, target_part};
use super::super::edit_grammar::{Back, Command, Destination, Turn};
use super::super::edit_moving::metres_at;
use super::super::foremost;
use super::super::lexicon::Sense;
use super::super::lexicon::look_up;
use super::super::tag::{Tag, tag};
use super::super::tokens::{Span, Token};
use super::super::words::edits::Verb;
use super::lists::{BECOMES, MOTION, STAYS, UNTIL};
use super::predicate::{Part, alone, new_kind};
use super::subject::{Kind, Subject};
use super::ways::{arrived, settled, step, times, turned, with_named};
use super::words::{find, first_noun, has_noun, is, led, number, text};
use super::{Piece, Talk};
use crate::scene::graph::{ObjectState, RelationKind};

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
            c.each = joins(&np);
        }
    }
    c
}

/// "the nurse and the child": two that are known.
fn joins(np: &[Token]) -> bool {
    let the = |t: Option<&Token>| {
        is(
            t,
            &[
                "the", "my", "that", "both", "this", "all", "our", "those", "these",
            ],
        )
    };
    (1..np.len())
        .any(|i| is(np.get(i), &["and"]) && the(np.first()) && has_noun(&np[..i]) && has_noun(&np[i + 1..]))
}

/// "the second truck": the ordinal is taken out.
fn without_ordinal(np: &[Token]) -> (Vec<Token>, Option<usize>) {
    let at =
        (1..np.len()).find(|i| foremost::ordinal(text(&np[*i])).is_some() && is(np.get(i - 1), &["the"]));
    match at {
        Some(i) => {
            let mut out = np.to_vec();
            let n = foremost::ordinal(text(&out.remove(i)));
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
        parts[i + 1..].iter().any(|p| {
            !p.not
                && !p.main.is_empty()
                && !only_points(&p.main)
                && !only_faces(&p.main)
                && (super::predicate::places(&p.main) || p.is_gone())
        })
    };
    // "crosses over and now stands on the left sidewalk": where he ends counts
    let crosses = |p: &Part| {
        let over = p.begins(&[
            "crosses over",
            "cross over",
            "crossed over",
            "crosses",
            "crossed",
            "crosses the road",
            "crosses the street",
            "crossed the road",
            "crossed the street",
            "walks across",
            "walked across",
            "walks over",
            "walked over",
            "goes across",
            "goes over",
            "runs across",
            "comes over",
            "walks across the road",
            "walks across the street",
        ]);
        over == Some(p.main.len())
    };
    // "has stepped into our lane and is 10 m ahead of us": the one tells the lane, the other how far
    let adds = |i: usize| {
        let after = &parts[i + 1..];
        let p = &parts[i];
        let far =
            stopped(p) && metres_in(&p.main).is_some() && after.iter().all(|q| metres_in(&q.main).is_none());
        let strip = arrives_on(&p.main)
            && !after.iter().any(|q| names_place(&q.main))
            && after.iter().any(|q| metres_in(&q.main).is_some());
        p.perfect && !p.not && !p.is_gone() && !steps_off(p) && (far || strip)
    };
    let kept: Vec<&Part> = parts
        .iter()
        .enumerate()
        .filter(|(i, p)| !((steps_off(p) && later(*i)) || parts.len() > 1 && keeps_lane(p)))
        .filter(|(i, p)| !(p.begins(&["lets", "let", "allows", "makes room"]).is_some() && later(*i)))
        .filter(|(i, p)| !(crosses(p) && later(*i)))
        .filter(|(i, p)| adds(*i) || !((p.perfect || p.is_gone() || p.not) && later(*i)))
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
            let other = talk.other.filter(|_| matches!(s.kind, Kind::Back(_)))?;
            Some(led(&other.label(), &clause[0], &[]))
        })
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
    if let Some(n) = first.begins(&BECOMES).filter(|n| {
        let new = &first.main[*n..];
        // "changes to our lane behind the bus"
        let the = usize::from(is(new.first(), &["the", "our", "my", "their", "its"]));
        if matches!(
            new.get(the..).and_then(super::words::longest),
            Some((Sense::Place(..), _))
        ) {
            return false;
        }
        let fresh = is(new.first(), &["a", "an", "another", "one"])
            || new
                .first()
                .is_some_and(|t| number(t).is_some() || super::words::noun_at(new).is_some());
        fresh && first_noun(new).is_some_and(|x| x.0 < 5)
            || first.begins(&["turn into", "turns into"]).is_none() && has_noun(new)
    }) {
        return become_of(s, &first.main[n..], clause, talk, noun.clone());
    }
    if first.helped
        && (first.is || caused)
        && let Some(new) = new_kind(&first.main)
    {
        return become_of(s, new, clause, talk, noun.clone());
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
    if first.begins(&STAYS).is_some() && said.len() == 1 && metres_in(&first.main).is_none() {
        return Some(vec![remembered()]);
    }
    let mut main: Vec<Token> = joined(&said);
    if let Some((i, _)) = find(&main, &["back up", "backs up", "backed up", "backing up"]) {
        // ("up" leads forward, "move back" is one word of the lexicon)
        let at = main[i].clone();
        main.drain(i..i + 2);
        main.insert(0, super::words::word("move", &at));
        main.push(super::words::word("backwards", &at));
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
        let drives = |w: &str| matches!(look_up(w), Some(Sense::State(ObjectState::Moving, _)));
        c.state = said
            .iter()
            .any(|p| p.main.iter().any(|t| drives(text(t))))
            .then_some(ObjectState::Moving);
        // who comes towards us drives, and in the lane that leads here
        if turn == Turn::Against {
            c.state = Some(ObjectState::Moving);
        }
        return Some(vec![meant(c)]);
    }
    placed(s, &said, clause, talk, noun)
}

/// "steps off the kerb", "pulls out of its lane": where it no longer is, and nothing of where it goes.
fn steps_off(p: &Part) -> bool {
    let leaves = p
        .begins(&[
            "leaves the",
            "leave the",
            "leaves its",
            "leave its",
            "leaves his",
            "leave his",
            "leaves her",
            "leave her",
            "leave their",
        ])
        .is_some();
    let from = (1..p.main.len().min(4)).find(|i| {
        let rest = &p.main[*i..];
        super::words::leads(
            rest,
            &["off", "out of", "out from", "away from", "down from", "from"],
        )
        .is_some_and(|n| {
            is(
                rest.get(n),
                &[
                    "the", "its", "his", "her", "their", "our", "my", "between", "behind",
                ],
            )
        })
    });
    let goes_to = from.is_some_and(|i| {
        p.main[i + 1..]
            .iter()
            .any(|t| is(Some(t), &["to", "onto", "into", "in", "on"]))
    });
    (leaves || from.is_some()) && !goes_to && metres_in(&p.main).is_none()
}

/// Who has stopped still stands there.
fn stopped(p: &Part) -> bool {
    p.begins(&[
        "stopped",
        "parked",
        "halted",
        "stood",
        "pulled up",
        "come to a stop",
        "come to a halt",
        "stalled",
        "braked",
    ])
    .is_some()
}

/// True if a lane or strip is named.
fn names_place(main: &[Token]) -> bool {
    (0..main.len()).any(|i| matches!(super::words::longest(&main[i..]), Some((Sense::Place(..), _))))
}

/// "into our lane", "onto the left sidewalk".
fn arrives_on(main: &[Token]) -> bool {
    (0..main.len()).any(|i| {
        let the = i + 1 + usize::from(is(main.get(i + 1), &["the", "my", "our"]));
        is(main.get(i), &["into", "onto", "in", "on", "to"])
            && matches!(
                main.get(the..).and_then(super::words::longest),
                Some((Sense::Place(..), _))
            )
    })
}

/// "stays in its lane": what is not said of a box stays as it was anyhow.
fn keeps_lane(p: &Part) -> bool {
    p.begins(&[
        "stay", "stays", "remain", "remains", "keep", "keeps", "keep going", "keeps going", "stay put",
    ])
    .is_some_and(|n| {
        let rest = &p.main[n..];
        let own = super::words::leads(
            rest,
            &[
                "in its", "in his", "in her", "in their", "on its", "on his", "on her", "on their", "to its",
                "to his", "to her", "to their", "in the same", "on the same", "within its", "within their",
            ],
        );
        own.is_some_and(|m| {
            let place = &rest[m + usize::from(is(rest.get(m), &["own", "present", "current"]))..];
            matches!(place, [one] if is(Some(one), &["lane", "sidewalk", "pavement", "side", "kerb", "curb", "roadside", "track", "line", "footpath", "shoulder"]))
        })
    })
}

/// "faces us", "looks at me": how someone is turned says not where he is.
fn only_faces(main: &[Token]) -> bool {
    super::words::leads(main, &super::lists::TURNS).is_some()
        && main.len() < 4
        && is(main.last(), &["us", "me"])
}

/// "blocks it": a verb of something that was named before.
fn only_points(main: &[Token]) -> bool {
    main.len() == 2 && is(main.get(1), &["it", "them", "him", "her"])
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
    if let Some((i, n)) = find(&main, &UNTIL) {
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
    let mut spec = reading.description.foreground.first()?.clone();
    // ("put the bus in the left lane" does not tell it to drive)
    if is(main.first(), &["move"]) && spec.attributes.iter().any(|a| a == "move") {
        spec.state = None;
    }
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
        c.state = spec.state.filter(|s| *s == ObjectState::Moving);
        return Some(vec![Piece::Meant(Box::new(c), noun)]);
    }
    note_definite(&mut c, &mentions);
    // what stands there is looked for, whoever is named
    c.reading.not_understood.extend(reading.not_understood);
    c.anchors = reading.description.foreground;
    c.destination = Some(Destination::Place(Box::new(spec)));
    Some(vec![Piece::Meant(Box::new(c), noun)])
}
