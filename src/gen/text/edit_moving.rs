//! Where a command moves its target, and how it turns it.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::edit_command::{note_definite, parse, target_part, words};
use super::edit_grammar::{Command, Destination, Turn};
use super::lexicon::{Sense, look_up};
use super::tag::{Item, Tag};
use crate::scene::graph::RelationKind;

pub(super) fn direction(words: &str) -> Option<DVec2> {
    Some(match words {
        "left"
        | "to the left"
        | "to my left"
        | "leftwards"
        | "leftward"
        | "to our left"
        | "to the left side"
        | "to the left hand side" => DVec2::Y,
        "right"
        | "to the right"
        | "to my right"
        | "rightwards"
        | "rightward"
        | "to our right"
        | "to the right side"
        | "to the right hand side" => DVec2::NEG_Y,
        "forward"
        | "forwards"
        | "ahead"
        | "further ahead"
        | "farther ahead"
        | "up"
        | "to the front"
        | "further forward"
        | "up ahead"
        | "further on"
        | "further along"
        | "further up the road"
        | "further down the road"
        | "further up the street"
        | "further down the street"
        | "up the road"
        | "down the road"
        | "up the street"
        | "down the street"
        | "farther up the road"
        | "farther down the road"
        | "farther along"
        | "farther on" => DVec2::X,
        "back" | "backwards" | "backward" | "down" | "to the rear" | "further back" | "to the back"
        | "rearwards" | "further behind" => DVec2::NEG_X,
        _ => return None,
    })
}

pub(super) fn metres_at(items: &[Item], i: usize) -> Option<(f64, usize)> {
    let unit = |k: usize| match items.get(k).map(|x| x.tag) {
        Some(Tag::Is(Sense::Unit(m))) => Some(m),
        _ => None,
    };
    match items.get(i)?.tag {
        Tag::Number(v) => unit(i + 1).map(|m| (v * m, 2)),
        Tag::Is(Sense::Count(count)) => unit(i + 1).map(|m| (f64::from(count.n) * m, 2)),
        Tag::Is(Sense::Fraction(share)) => unit(i + 1).map(|m| (share * m, 2)),
        Tag::Is(Sense::Article(false)) => unit(i + 1).map(|m| (m, 2)),
        _ => None,
    }
}

pub(super) fn moving(text: &str, items: &[Item], after_noun: usize, c: &mut Command) {
    let mut metres = None;
    let mut dir: Option<DVec2> = None;
    let mut toward: Option<bool> = None;
    let mut cut = items.len();
    let mut place_from = None;
    let mut i = after_noun;
    while i < items.len() {
        let w = items[i].words.as_str();
        if let Some((m, n)) = metres_at(items, i) {
            // "20 m ahead of the bus" is a place, "3 m left" a step; both begin here.
            metres = Some(m);
            cut = cut.min(i);
            let next = items.get(i + n);
            let of_ego = next.is_some_and(|x| {
                matches!(x.tag, Tag::Is(Sense::EgoRel(_)))
                    && [" me", " us", " of the ego"].iter().any(|t| x.words.ends_with(t))
            });
            if of_ego || next.is_some_and(|x| matches!(x.tag, Tag::Is(Sense::Rel(_)))) {
                place_from.get_or_insert(i);
                break;
            }
            i += n;
            continue;
        }
        let side = w.ends_with(" side") && metres.is_none() && metres_at(items, i + 1).is_none();
        if side && direction(w).is_some() {
            // "to the left side" is a place
            cut = cut.min(i);
            place_from = Some(i);
            break;
        }
        if let Some(d) = direction(w) {
            let ends = items[i + 1..].iter().all(|x| {
                matches!(
                    x.tag,
                    Tag::Is(
                        Sense::Filler
                            | Sense::Unit(_)
                            | Sense::Count(_)
                            | Sense::Article(_)
                            | Sense::At
                            | Sense::Fraction(_)
                    ) | Tag::Number(_)
                        | Tag::Comma
                )
            });
            if ends {
                dir = Some(d);
                cut = cut.min(i);
            }
        } else if matches!(
            w,
            "closer" | "nearer" | "closer to" | "nearer to" | "towards" | "toward"
        ) || (w == "close to" && i > after_noun)
        {
            toward = Some(false);
            cut = cut.min(i);
        } else if matches!(
            w,
            "away from"
                | "away"
                | "farther away"
                | "further away"
                | "further"
                | "farther"
                | "further off"
                | "farther off"
        ) {
            toward = Some(true);
            cut = cut.min(i);
        } else if matches!(w, "to" | "onto" | "into" | "on to" | "over to") && cut == items.len() {
            cut = i;
            place_from = Some(i);
            break;
        }
        i += 1;
    }
    if cut == items.len() && place_from.is_none() {
        // "move the bus behind the truck": what is said of it is where it goes.
        let from = (after_noun..items.len()).find(|k| {
            matches!(
                items[*k].tag,
                Tag::Is(
                    Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At | Sense::FarSide | Sense::Across
                )
            )
        });
        if let Some(k) = from {
            cut = k;
            place_from = Some(k);
        }
    }
    target_part(text, &items[..cut], c);
    c.destination = match (place_from, dir, toward) {
        (Some(from), ..) => destination(text, items, after_noun, from, c),
        (None, Some(direction), _) => Some(Destination::By { direction, metres }),
        (None, None, Some(away)) => Some(Destination::Toward { away, metres }),
        _ => None,
    };
}

fn destination(
    text: &str,
    items: &[Item],
    after_noun: usize,
    from: usize,
    c: &mut Command,
) -> Option<Destination> {
    let noun = items.get(after_noun.checked_sub(1)?)?.clone();
    let noun = Item {
        tag: match noun.tag {
            Tag::Is(Sense::Noun(n, _)) => Tag::Is(Sense::Noun(n, false)),
            _ => look_up("car").map_or(Tag::Unknown, Tag::Is),
        },
        ..noun
    };
    let mut rest: Vec<Item> = items[from..].to_vec();
    if matches!(rest.first().map(|i| i.words.as_str()), Some("to" | "over to")) {
        rest.remove(0);
        let place_first = rest
            .iter()
            .find(|i| !matches!(i.tag, Tag::Is(Sense::Article(_) | Sense::Filler)));
        if place_first.is_some_and(|i| matches!(i.tag, Tag::Is(Sense::Place(..) | Sense::Noun(..)))) {
            let anchor = if place_first.is_some_and(|i| matches!(i.tag, Tag::Is(Sense::Noun(..)))) {
                "next to"
            } else {
                "on"
            };
            rest.insert(
                0,
                Item {
                    tag: look_up(anchor).map_or(Tag::Unknown, Tag::Is),
                    words: anchor.into(),
                    span: items[from].span,
                    read_as: None,
                },
            );
        }
    }
    let mut whole = vec![noun];
    whole.extend(rest);
    let (reading, mentions) = parse(text, &whole);
    note_definite(c, &mentions);
    c.reading.not_understood.extend(reading.not_understood);
    let spec = reading.description.foreground.first()?.clone();
    if !spec.relations.iter().any(|r| super::edit::places_it(r.relation)) {
        return None;
    }
    c.anchors = reading.description.foreground;
    Some(Destination::Place(Box::new(spec)))
}

/// "face the other way"
fn turned_back(list: &[&str]) -> bool {
    let said = list.join(" ");
    [
        "other way",
        "opposite way",
        "other direction",
        "opposite direction",
        "wrong way",
        "reverse direction",
    ]
    .iter()
    .any(|w| said.contains(w))
}

pub(super) fn is_turn_word(w: &str) -> bool {
    matches!(
        w,
        "around"
            | "round"
            | "clockwise"
            | "counterclockwise"
            | "anticlockwise"
            | "degrees"
            | "degree"
            | "deg"
            | "°"
            | "face"
            | "facing"
            | "looking at"
            | "about"
            | "backwards"
            | "counter"
            | "look"
            | "point"
            | "the other way"
            | "opposite direction"
            | "in the opposite direction"
            | "in the other direction"
    )
}

/// How the words after the noun turn it.
pub(super) fn turn_of(items: &[Item], after_noun: usize) -> Option<Turn> {
    let list = words(items);
    let rest = &list[after_noun.min(list.len())..];
    let at = |w: &str| rest.iter().position(|x| *x == w);
    let degrees = items.iter().enumerate().skip(after_noun).find_map(|(k, i)| {
        let next = items.get(k + 1).map(|n| n.words.as_str());
        let is = matches!(next, Some("degrees" | "degree" | "deg" | "°"));
        match i.tag {
            Tag::Number(v) if is => Some(v),
            Tag::Is(Sense::Count(n)) if is => Some(f64::from(n.n)),
            _ => None,
        }
    });
    let right = rest
        .iter()
        .any(|w| matches!(*w, "right" | "to the right" | "rightwards"))
        || (at("clockwise").is_some() && at("counter").is_none() && at("anti").is_none());
    let left = rest.iter().any(|w| {
        matches!(
            *w,
            "left" | "to the left" | "leftwards" | "counterclockwise" | "anticlockwise"
        )
    });
    let our_way = items
        .iter()
        .skip(after_noun)
        .any(|i| i.tag == Tag::Is(Sense::EgoRel(&[RelationKind::SameDirection])));
    let ego = items
        .iter()
        .skip(after_noun)
        .any(|i| matches!(i.tag, Tag::Is(Sense::Ego)));
    let away = rest.iter().any(|w| w.contains("away"));
    match (degrees, left, right) {
        (Some(d), _, true) => Some(Turn::By(-d.to_radians())),
        (Some(d), ..) if d.is_finite() => Some(Turn::By(d.to_radians())),
        _ if our_way => Some(Turn::WithEgo),
        _ if ego && away => Some(Turn::FromEgo),
        _ if ego => Some(Turn::ToEgo),
        _ if rest
            .iter()
            .any(|w| matches!(*w, "around" | "round" | "about" | "backwards"))
            || turned_back(&list) =>
        {
            Some(Turn::By(PI))
        }
        (_, true, _) => Some(Turn::By(FRAC_PI_2)),
        (_, _, true) => Some(Turn::By(-FRAC_PI_2)),
        _ if rest.iter().any(|w| matches!(*w, "straight" | "along")) => Some(Turn::WithLane),
        _ => None,
    }
}

pub(super) fn turning(text: &str, items: &[Item], after_noun: usize, c: &mut Command) {
    c.turn = turn_of(items, after_noun);
    let cut = items
        .iter()
        .enumerate()
        .skip(after_noun)
        .find(|(_, i)| {
            let w = i.words.as_str();
            is_turn_word(w)
                || i.tag == Tag::Is(Sense::EgoRel(&[RelationKind::SameDirection]))
                || matches!(
                    w,
                    "by" | "to"
                        | "left"
                        | "right"
                        | "to the left"
                        | "to the right"
                        | "so"
                        | "towards"
                        | "toward"
                        | "away from"
                        | "away"
                        | "straight"
                        | "along"
                        | "facing away from"
                        | "looking towards"
                        | "pointing at"
                )
                || matches!(i.tag, Tag::Number(_))
        })
        .map_or(items.len(), |(k, _)| k);
    target_part(text, &items[..cut], c);
}
