//! Edits that speak of a pedestrian crossing where the map has none: one is put in. A crossing may be taken away, too.

use glam::DVec2;

use super::edit::{EditReading, OpenScene, TextEdit};
use super::holds::{Target, holds, overlap_m};
use super::lanes::LaneMap;
use super::lexicon::Sense;
use super::tag::{Item, Tag, tag};
use super::tokens::{LONGEST, Token, TokenKind, tokens};
use crate::scene::graph::RelationKind;
use crate::scene::raster::draw_polyline;
use crate::scene::{BevLayer, BevLayout, BoxId, BoxLabel, Class, Polyline, PolylineKind, SceneBox};

/// Depth of a crossing along the road, m.
const DEPTH_M: f64 = 3.0;
/// Width of the road that one may span, m.
const SPAN_M: std::ops::RangeInclusive<f64> = 4.0..=26.0;
/// How far ahead along our course it is tried where no metres were said, m.
const TRIED_M: [f64; 12] = [
    12.0, 10.0, 14.0, 8.0, 16.0, 18.0, 20.0, 7.0, 22.0, 25.0, 28.0, 31.0,
];
/// So near to the middle of a junction there is none, m.
const JUNCTION_M: f64 = 9.0;

/// A crossing that is spoken of.
struct Spoken {
    /// Metres ahead, if they were said.
    ahead_m: Option<f64>,
    /// "Paint a zebra crossing": it is to be there whether or not anything stands on it.
    ordered: bool,
}

/// The map with the crossing that a text needs, and the text's reading on it; `None` if it has one, or speaks of none.
pub(super) fn with_crossing(
    text: &str,
    scene: &OpenScene<'_>,
    read: impl Fn(&OpenScene<'_>) -> EditReading,
) -> Option<EditReading> {
    if text.len() > LONGEST {
        return None;
    }
    let spoken = spoken(text)?;
    let map = LaneMap::new(scene.layout);
    let wanted = map.crossings.is_empty() || spoken.ordered && is_elsewhere(&map, spoken.ahead_m);
    if !wanted {
        return None;
    }
    let boxes: Vec<SceneBox> = scene.boxes.values().copied().collect();
    // (over the parking strips too, to the sidewalks, unless somebody is parked there)
    let road = BevLayer::DrivableArea.bit();
    let kerb_to_kerb = road | BevLayer::CarparkArea.bit();
    let at = |m: f64| {
        let wide = outline(&map, m, kerb_to_kerb).filter(|o| is_free(o, &boxes));
        wide.or_else(|| outline(&map, m, road))
    };
    let (ahead_m, outline_m) = match spoken.ahead_m {
        Some(m) => (m, at(m)?),
        None => TRIED_M.iter().find_map(|m| {
            let outline = at(*m).filter(|o| is_free(o, &boxes))?;
            Some((*m, outline))
        })?,
    };
    let line = Polyline {
        kind: PolylineKind::PedCrossing,
        points_m: outline_m.clone(),
    };
    let mut polylines = scene.layout.polylines.to_vec();
    polylines.push(line.clone());
    let mut layout = BevLayout::from_cells(scene.layout.cells().to_vec(), polylines).ok()?;
    draw_polyline(&mut layout, &line);
    let mut reading = read(&OpenScene {
        layout: &layout,
        ..*scene
    });
    if !spoken.ordered && !is_used(&reading, &layout) {
        return None;
    }
    reading.edits.insert(0, TextEdit::Crossing { outline_m });
    let about = |words: &str| spoken_in(&tag(&tokens(words))).is_some();
    for phrase in reading.phrases.iter_mut().filter(|p| about(&p.text)) {
        if phrase.meaning == "nothing" {
            phrase.meaning = "added: 1 changes".into();
        }
    }
    reading
        .notes
        .retain(|n| !(n.contains("was not understood") && about(n)));
    let side = if ahead_m < 0.0 { "behind" } else { "ahead" };
    let what = if map.crossings.is_empty() {
        "the scene had no crossing: one is put in"
    } else {
        "a crossing is put in"
    };
    reading
        .notes
        .push(format!("{what}, {:.0} m {side}", ahead_m.abs()));
    Some(reading)
}

/// "Remove the zebra crossing": the one that is meant goes, or all of them. Only where nothing else was read.
pub(super) fn without_crossing(text: &str, scene: &OpenScene<'_>, reading: &mut EditReading) {
    const ERASE: [&str; 8] = [
        "remove", "delete", "erase", "scrap", "rid", "away", "ditch", "out",
    ];
    let words = tokens(text);
    let items = tag(&words);
    let said = |list: &[&str]| words.iter().any(|t| list.contains(&t.text.as_str()));
    let things = items.iter().any(|i| matches!(i.tag, Tag::Is(Sense::Noun(..))));
    if text.len() > LONGEST
        || !reading.edits.is_empty()
        || !reading.questions.is_empty()
        || things
        || spoken_in(&items).is_none()
        || !said(&ERASE)
        || said(&["not", "never", "dont", "keep"])
    {
        return;
    }
    let map = LaneMap::new(scene.layout);
    let all = said(&["all", "both", "every", "crossings", "crosswalks", "zebras", "any"]);
    let gone: Vec<Vec<DVec2>> = match all {
        true => map.crossings.clone(),
        false => map.crossing().cloned().into_iter().collect(),
    };
    reading.notes.clear();
    if gone.is_empty() {
        reading.notes.push("no crossing is in the scene".into());
    }
    if let Some(phrase) = reading.phrases.first_mut().filter(|_| !gone.is_empty()) {
        phrase.meaning = format!("removed: {} changes", gone.len());
    }
    let erase = |outline_m| TextEdit::EraseCrossing { outline_m };
    reading.edits.extend(gone.into_iter().map(erase));
}

/// True if metres were said where there is no crossing yet.
fn is_elsewhere(map: &LaneMap<'_>, ahead_m: Option<f64>) -> bool {
    const NEAR_M: f64 = 5.0;
    ahead_m.is_some_and(|m| {
        let middle = |c: &Vec<DVec2>| c.iter().sum::<DVec2>() / c.len().max(1) as f64;
        map.crossings
            .iter()
            .all(|c| map.course(middle(c)).is_none_or(|at| (at.0 - m).abs() > NEAR_M))
    })
}

/// The index of the words for a crossing.
fn spoken_in(items: &[Item]) -> Option<usize> {
    use super::description::Anchor;
    let is = |i: &Item| {
        matches!(
            i.tag,
            Tag::Is(Sense::Place(Anchor::Crossing, _) | Sense::Fixed(_, Anchor::Crossing))
        )
    };
    items.iter().position(is)
}

fn spoken(text: &str) -> Option<Spoken> {
    const DENIED: [&str; 12] = [
        "no", "not", "without", "remove", "delete", "erase", "clear", "away", "gone", "leaves", "left", "off",
    ];
    const ORDERS: [&str; 18] = [
        "add", "put", "paint", "place", "insert", "draw", "mark", "lay", "include", "need", "needs", "want",
        "build", "install", "create", "have", "give", "there",
    ];
    let words = tokens(text);
    let items = tag(&words);
    let at = spoken_in(&items)?;
    let start = items[at].span.start;
    // Denied in its own clause.
    let parts =
        |t: &&Token| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)) || t.text == "and";
    let clause = words
        .iter()
        .filter(|t| t.span.start < start)
        .rev()
        .take_while(|t| !parts(t))
        .chain(
            words
                .iter()
                .filter(|t| t.span.start >= start)
                .take_while(|t| !parts(t)),
        );
    if clause.into_iter().any(|t| DENIED.contains(&t.text.as_str())) {
        return None;
    }
    let before: Vec<&str> = words
        .iter()
        .filter(|t| t.span.start < start)
        .map(|t| t.text.as_str())
        .collect();
    let own = items[at].words.split(' ').next().unwrap_or("");
    let article = [
        before.last().copied(),
        before.iter().rev().nth(1).copied(),
        Some(own),
    ];
    let new = article.iter().flatten().any(|w| matches!(*w, "a" | "an" | "new"));
    let leads = before.iter().rev().take(5).any(|w| ORDERS.contains(w));
    let alone = before.len() < 3;
    let metres = items[at + 1..]
        .iter()
        .take(5)
        .enumerate()
        .find_map(|(k, i)| match i.tag {
            Tag::Number(n) => Some((at + 1 + k, n)),
            _ => None,
        });
    // ("a zebra crossing 10 m ahead", not "a zebra crossing with two people")
    let ahead_m = metres.and_then(|(k, n)| {
        let rest = words.iter().filter(|t| t.span.start > items[k].span.start);
        let rest: Vec<&str> = rest.take(4).map(|t| t.text.as_str()).collect();
        let unit = rest
            .first()
            .is_some_and(|w| matches!(*w, "m" | "metres" | "meters" | "metre" | "meter"))
            || text.get(items[k].span.end..).is_some_and(|r| r.starts_with('m'));
        if !unit || !(3.0..=36.0).contains(&n) {
            return None;
        }
        Some(if rest.contains(&"behind") { -n } else { n })
    });
    Some(Spoken {
        ahead_m,
        ordered: new && (leads || alone),
    })
}

/// The outline of a crossing over all that is of the layers `road`, at a distance ahead along our course, m; `None` where it
/// is not of a fitting width, or a junction.
fn outline(map: &LaneMap<'_>, ahead_m: f64, road: u32) -> Option<Vec<DVec2>> {
    let near = |p: DVec2| map.course(p).is_some_and(|c| (c.0 - ahead_m).abs() < 0.75);
    let (p, d) = map.ego_path.iter().copied().find(|(p, _)| near(*p))?;
    if map.junction.is_some_and(|j| j.distance(p) < JUNCTION_M) || p.abs().max_element() > 37.0 {
        return None;
    }
    let reach = |side: f64| {
        let steps = (1..=60).map(|k| f64::from(k) * 0.25);
        steps
            .take_while(|m| map.has(road, p + d.perp() * side * *m))
            .last()
            .unwrap_or(0.0)
    };
    let (left_m, right_m) = (reach(1.0), reach(-1.0));
    if !SPAN_M.contains(&(left_m + right_m)) {
        return None;
    }
    let half = d * (DEPTH_M / 2.0);
    let (l, r) = (p + d.perp() * left_m, p - d.perp() * right_m);
    Some(vec![l - half, r - half, r + half, l + half])
}

/// True if nothing but people is where a crossing would be.
fn is_free(outline_m: &[DVec2], boxes: &[SceneBox]) -> bool {
    let middle = outline_m.iter().sum::<DVec2>() / outline_m.len().max(1) as f64;
    let across = outline_m[0] - outline_m[1];
    let strip = SceneBox {
        id: BoxId(u32::MAX - 1),
        class: Class::Barrier,
        center_m: middle.extend(0.0),
        size_m: glam::DVec3::new(across.length(), DEPTH_M, 1.0),
        yaw_rad: across.to_angle(),
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    };
    boxes
        .iter()
        .filter(|b| b.class != Class::Pedestrian)
        .all(|b| overlap_m(&strip, b, 0.6) <= 0.0)
}

/// True if anything that an edit puts somewhere is on the crossing, or waits at it.
fn is_used(reading: &EditReading, layout: &BevLayout) -> bool {
    let map = LaneMap::new(layout);
    let stands = |b: &SceneBox| {
        [
            RelationKind::On,
            RelationKind::Crossing,
            RelationKind::WaitingAt,
            RelationKind::Near,
        ]
        .iter()
        .any(|r| holds(&map, *r, b, &Target::Crossing, None, None))
    };
    reading.edits.iter().any(|e| match e {
        TextEdit::Add { object } | TextEdit::Replace { object, .. } => stands(object),
        TextEdit::Move { center_m, .. } => map
            .crossing()
            .is_some_and(|c| c.iter().any(|p| p.distance(center_m.truncate()) < 14.0)),
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::super::edit::read_edit;
    use super::*;
    use crate::generation::world::template;

    fn read(text: &str, layout: &BevLayout) -> EditReading {
        let boxes = BTreeMap::new();
        let scene = OpenScene {
            boxes: &boxes,
            layout,
            prompt: "",
        };
        read_edit(text, &scene, 1)
    }

    /// Straight streets with and without a crossing.
    fn streets() -> [BevLayout; 2] {
        let all = || (0..40).map(|seed| template::layout("straight", seed).expect("listed"));
        let has = |l: &BevLayout| !LaneMap::new(l).crossings.is_empty();
        [
            all().find(|l| has(l)).expect("one"),
            all().find(|l| !has(l)).expect("one"),
        ]
    }

    fn painted(reading: &EditReading) -> Vec<&Vec<DVec2>> {
        fn of(e: &TextEdit) -> Option<&Vec<DVec2>> {
            match e {
                TextEdit::Crossing { outline_m } => Some(outline_m),
                _ => None,
            }
        }
        reading.edits.iter().filter_map(of).collect()
    }

    #[test]
    fn a_crossing_is_put_in_where_there_is_none() {
        let [with, without] = streets();
        let text = "Add two pedestrians who are walking over a zebra crossing.";
        let reading = read(text, &without);
        let outline = painted(&reading)[0].clone();
        assert_eq!(reading.edits.len(), 3, "{reading:?}");
        assert!(reading.notes.iter().any(|n| n.contains("is put in")));
        let (low, high) = outline
            .iter()
            .fold((DVec2::MAX, DVec2::MIN), |(a, b), p| (a.min(*p), b.max(*p)));
        for e in &reading.edits[1..] {
            let TextEdit::Add { object } = e else {
                panic!("{e:?}")
            };
            let p = object.center_m.truncate();
            assert!(p.cmpge(low).all() && p.cmple(high).all(), "{p} {outline:?}");
        }
        assert!(painted(&read(text, &with)).is_empty());
    }

    #[test]
    fn an_ordered_crossing_lies_where_it_was_said() {
        let [_, without] = streets();
        for (text, at) in [
            ("Paint a crosswalk 14 m ahead of us.", 14.0),
            ("put in a zebra crossing 10 m ahead", 10.0),
            ("We need a pedestrian crossing 8 m behind us", -8.0),
        ] {
            let reading = read(text, &without);
            let outline = painted(&reading)[0];
            let x = outline.iter().sum::<DVec2>().x / outline.len() as f64;
            assert!((x - at).abs() < 1.5, "{text}: {x}");
        }
        for text in [
            "there is no zebra crossing",
            "remove the crosswalk",
            "a bus ahead",
        ] {
            assert!(painted(&read(text, &without)).is_empty(), "{text}");
        }
    }
}
