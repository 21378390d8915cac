//! Ways and places: steps from where something is, how it turns, where words say that it arrives.

use super::super::edit_grammar::{Destination, Turn};
use super::super::edit_moving::{direction, is_turn_word, metres_at, turn_of};
use super::super::lexicon::{Sense, look_up};
use super::super::tag::tag;
use super::super::tag::{Item, Tag};
use super::super::tokens::Token;
use super::Talk;
use super::lists::{ADVERBS, HELPERS, MOTION, OTHER_WAY, OUR_WAY, TURNS};
use super::predicate::Part;
use super::subject::Subject;
use super::words::{find, first_noun, is, is_place, led, number, text};

/// Nearer, farther, so many metres or lanes: a way to go from where it is.
pub fn step(main: &[Token], caused: bool) -> Option<Destination> {
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
pub fn lanes(main: &[Token], motion: bool) -> Option<i32> {
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
pub fn turned(main: &[Token], parts: &[&Part]) -> Option<Turn> {
    let other = find(main, &OTHER_WAY);
    let ours = find(main, &OUR_WAY);
    let verb = parts.iter().any(|p| p.begins(&TURNS).is_some());
    let stripped: Vec<Token> = {
        let cut = other.or(ours);
        let mut t = main.to_vec();
        if let Some((i, n)) = cut {
            t.drain(i..i + n);
        }
        t
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
    if (other.is_some() || ours.is_some()) && !place {
        if ours.is_some() && other.is_none() {
            return Some(Turn::WithEgo);
        }
        // (a turn back and going the other way are one and the same)
        return Some(Turn::By(std::f64::consts::PI));
    }
    // ("stand 8 m ahead, facing me" says where as well)
    let measured = (1..main.len()).any(|i| {
        super::words::unit_at(&main[i..]).is_some_and(|n| {
            number(&main[i - 1]).is_some()
                && matches!(
                    super::words::longest(&main[i + n..]),
                    Some((Sense::EgoRel(_) | Sense::Rel(_), _))
                )
        })
    });
    if !verb || measured || parts.len() > 1 && place {
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
        && shows(&[
            "to", "towards", "toward", "on", "at", "show", "shows", "showing", "shown", "presents", "offers",
        ])
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

/// "goes over to the left pavement" ends there, whichever way; "the other side" is that of the street.
pub fn arrived(mut main: Vec<Token>) -> Vec<Token> {
    // "where the cones are" is next to them
    if let Some(k) = main.iter().position(|t| text(t) == "where")
        && let Some((a, b)) = first_noun(&main[k..])
        && a < 4
        && main[k + b..].iter().all(|t| {
            HELPERS.contains(&text(t)) || super::words::is_finite(text(t), true) || ADVERBS.contains(&text(t))
        })
    {
        let np = main[k + 1..k + b].to_vec();
        let next = led("next to", &main[k], &[&np]);
        main.truncate(k);
        main.extend(next);
        return main;
    }
    // "in behind the truck": in its lane
    if let Some((i, n)) = find(
        &main,
        &["in behind", "in after", "tuck in behind", "slot in behind"],
    ) {
        let following = led("following", &main[i], &[]);
        main.splice(i..i + n, following);
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
        && main[i + n..].first().is_none_or(|t| text(t) != "of")
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
pub fn settled(mut items: Vec<Item>) -> Vec<Item> {
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

/// "beside it" with what "it" is, if something but the subject was named.
pub fn with_named(main: &[Token], noun: Option<&Vec<Token>>, s: &Subject) -> Vec<Token> {
    let Some(noun) = noun else {
        return main.to_vec();
    };
    let at = (1..main.len()).find(|i| {
        let placed = (1..=4.min(*i)).any(|k| is_place(&main[i - k..]));
        is(main.get(*i), &["it", "him", "her", "them"]) && placed
    });
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
