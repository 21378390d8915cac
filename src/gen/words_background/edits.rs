//! Edits of the background by words: which things they mean, what comes, and what is asked back.

use std::collections::BTreeMap;

use glam::DVec2;
use serde::Serialize;

use super::place::Ground;
use super::targets::{Meant, targets};
use super::wishes::{forms, name};
use super::{Amount, Said, Taken, Verb, What, take};
use crate::scene::Form;
use crate::scene::background::STOREY_M;
use crate::scene::{Background, BevLayout, BoxId, Class, Pose, SceneBox, ThingId};

/// Change of a height if none is said: a building by storeys, other things by this share of theirs.
const USUAL_STOREYS: f64 = 2.0;
const USUAL_SHARE: f64 = 0.4;
/// Buildings and other things are not made lower than this, m.
const LEAST_M: [f64; 2] = [2.5, 0.4];

/// One change of the background; world frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ThingEdit {
    /// New things.
    Add {
        /// What and where.
        forms: Vec<Form>,
    },
    /// Things go.
    Remove {
        /// Which.
        ids: Vec<ThingId>,
    },
    /// Things become higher, or lower.
    Raise {
        /// Which.
        ids: Vec<ThingId>,
        /// By how much, m.
        by_m: f64,
    },
    /// Things move.
    Move {
        /// Which.
        ids: Vec<ThingId>,
        /// How far, m.
        by_m: DVec2,
    },
}

/// A thing that a question names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThingCandidate {
    /// Its kind.
    pub class: &'static str,
    /// Where it stands, in words.
    pub place: String,
    /// The words that name it alone; they replace those that were asked about.
    pub answer: String,
}

/// Things that fit where one was meant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThingQuestion {
    /// `tree: 3 fit, which one?`
    pub text: String,
    /// The words that named it, as they stand in the text.
    pub phrase: String,
    /// The things that fit.
    pub candidates: Vec<ThingCandidate>,
}

/// What a text says of the background.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ThingReading {
    /// Changes, in order.
    pub edits: Vec<ThingEdit>,
    /// What must be answered first.
    pub questions: Vec<ThingQuestion>,
    /// What was done, one line each.
    pub done: Vec<String>,
    /// What could not be done, with the words, one line each.
    pub cannot: Vec<String>,
    /// The text with spaces for what was taken; empty if nothing is left to read.
    pub rest: String,
}

/// An open scene, as far as edits of its background need it.
#[derive(Clone, Copy, Debug)]
pub struct OpenBackground<'a> {
    /// Its things, world frame.
    pub things: &'a Background,
    /// Where the ego vehicle stands.
    pub world_from_ego: Pose,
    /// Map, ego frame.
    pub layout: &'a BevLayout,
    /// Boxes, ego frame.
    pub boxes: &'a BTreeMap<BoxId, SceneBox>,
}

/// Takes what a text says of the background, and leaves the rest.
pub fn read_edit(text: &str, open: &OpenBackground<'_>, seed: u64) -> ThingReading {
    let Taken { mut said, rest } = take(text, true);
    // "Fence" and "guard rail" name barriers too, which are boxes.
    let has_barriers = open.boxes.values().any(|b| b.class == Class::Barrier);
    let is_barrier = |s: &Said| has_barriers && super::read::may_be_barrier(s);
    if said.is_empty() || said.iter().any(is_barrier) {
        return ThingReading {
            rest: text.to_owned(),
            ..ThingReading::default()
        };
    }
    let mut out = ThingReading::default();
    if rest.chars().any(char::is_alphanumeric) {
        out.rest = rest;
    }
    let mut now = open.things.in_frame(&open.world_from_ego.inverse());
    now = now.iter().filter(|t| in_grid(&t.form)).cloned().collect();
    for (i, s) in said.drain(..).enumerate() {
        let ground = Ground::new(open.layout, open.boxes, &now);
        let words = s.span.of(text);
        match carry_out(&s, &now, ground, seed.wrapping_add(i as u64)) {
            Ok((edit, meaning)) => {
                apply(&mut now, &edit, open.things);
                out.done.push(meaning);
                out.edits.extend(in_world(edit, &open.world_from_ego));
            }
            Err(Stopped::Asked(question)) => out.questions.push(ThingQuestion {
                phrase: s.target.of(text).to_owned(),
                ..question
            }),
            Err(Stopped::Cannot(why)) => out.cannot.push(format!("\u{201c}{words}\u{201d}: {why}")),
        }
    }
    out
}

fn in_grid(form: &Form) -> bool {
    let (lo, hi) = form.bounds_m();
    lo.max_element() < 40.0 && hi.min_element() > -40.0
}

enum Stopped {
    Asked(ThingQuestion),
    Cannot(String),
}

/// Edits in the ego frame, in the order that they are applied, and what was done in words.
fn carry_out(
    s: &Said,
    now: &Background,
    ground: Ground,
    seed: u64,
) -> Result<(Vec<ThingEdit>, String), Stopped> {
    let called = name(s);
    if matches!(s.verb, Verb::Add | Verb::Have) {
        let forms = forms(s, ground, seed).map_err(Stopped::Cannot)?;
        let meaning = format!(
            "adds {} {}",
            forms.len(),
            if forms.len() == 1 { "thing" } else { "things" }
        );
        return Ok((vec![ThingEdit::Add { forms }], meaning));
    }
    if matches!(s.what, What::Place(p) if p != crate::generation::world::scenery::Setting::Forest) {
        return Err(Stopped::Cannot(format!(
            "{called}: a kind of place is no single thing; name buildings, trees or fences"
        )));
    }
    let ids = match targets(s, now, &ground) {
        Meant::These(ids) if ids.is_empty() => {
            let why = match (
                s.place.near,
                ground.roads.crossings.is_empty(),
                ground.roads.junctions_m.is_empty(),
            ) {
                (Some(super::NearTo::Crossing), true, _) => "there is no crossing in this scene".to_owned(),
                (Some(super::NearTo::Junction), _, true) => "there is no junction in this scene".to_owned(),
                _ if s.row => format!("no row of three or more along the road is there ({called})"),
                _ => format!("no {called} is there"),
            };
            return Err(Stopped::Cannot(why));
        }
        Meant::These(ids) => ids,
        Meant::Ask(list) => {
            let class = now.get(list[0].0).map_or("thing", |t| t.form.name());
            let candidates: Vec<ThingCandidate> = list
                .into_iter()
                .map(|(_, place, answer)| ThingCandidate { class, place, answer })
                .collect();
            return Err(Stopped::Asked(ThingQuestion {
                text: format!("{called}: {} fit, which one?", candidates.len()),
                phrase: String::new(),
                candidates,
            }));
        }
    };
    let n = ids.len();
    let counted = format!("{n} {}", if n == 1 { "thing" } else { "things" });
    match s.verb {
        Verb::Move => {
            let Some((by, (ahead, left))) = s.by.zip(s.way) else {
                return Err(Stopped::Cannot("say how far and which way".into()));
            };
            let by_m = DVec2::new(ahead, left) * metres(by);
            Ok((vec![ThingEdit::Move { ids, by_m }], format!("moves {counted}")))
        }
        Verb::Raise | Verb::Lower => {
            let sign = if s.verb == Verb::Raise { 1.0 } else { -1.0 };
            let mut edits = Vec::new();
            for id in ids {
                let Some(thing) = now.get(id) else { continue };
                let is_building = matches!(thing.form, Form::Building(_));
                let height = thing.form.height_m();
                let by_m = match (s.height, s.by) {
                    (Some(to), _) => metres(to) - height,
                    (None, Some(by)) => sign * metres(by),
                    (None, None) if is_building => sign * USUAL_STOREYS * STOREY_M,
                    (None, None) => sign * USUAL_SHARE * height,
                };
                let least = LEAST_M[usize::from(!is_building)];
                if height + by_m < least {
                    let what = thing.form.name();
                    return Err(Stopped::Cannot(format!(
                        "{what} #{} is {height:.1} m high and cannot become {:.1} m lower",
                        id.0, -by_m
                    )));
                }
                edits.push(ThingEdit::Raise { ids: vec![id], by_m });
            }
            Ok((edits, format!("changes the height of {counted}")))
        }
        _ => Ok((vec![ThingEdit::Remove { ids }], format!("removes {counted}"))),
    }
}

fn metres(amount: Amount) -> f64 {
    match amount {
        Amount::Storeys(n) => n * STOREY_M,
        Amount::Metres(m) => m,
    }
}

/// What later clauses find.
fn apply(now: &mut Background, edits: &[ThingEdit], all: &Background) {
    for edit in edits {
        match edit {
            ThingEdit::Remove { ids } => ids.iter().for_each(|id| {
                now.remove(*id);
            }),
            ThingEdit::Add { forms } => {
                for form in forms {
                    // The id that the editor will give it.
                    let id = ThingId(now.next_id().0.max(all.next_id().0));
                    now.insert(crate::scene::Thing {
                        id,
                        form: form.clone(),
                        look: id.0,
                    });
                }
            }
            ThingEdit::Move { ids, by_m } => change(now, ids, |form| form.map_points(|p| p + *by_m, 0.0)),
            ThingEdit::Raise { .. } => {}
        }
    }
}

fn change(now: &mut Background, ids: &[ThingId], mut change: impl FnMut(&mut Form)) {
    for id in ids {
        if let Some(mut thing) = now.get(*id).cloned() {
            change(&mut thing.form);
            now.insert(thing);
        }
    }
}

fn in_world(edits: Vec<ThingEdit>, world_from_ego: &Pose) -> Vec<ThingEdit> {
    let turned = |by: DVec2| {
        (world_from_ego.apply(by.extend(0.0)) - world_from_ego.apply(glam::DVec3::ZERO)).truncate()
    };
    let one = |edit| match edit {
        ThingEdit::Add { forms } => ThingEdit::Add {
            forms: forms.iter().map(|f| f.in_frame(world_from_ego)).collect(),
        },
        ThingEdit::Move { ids, by_m } => ThingEdit::Move {
            ids,
            by_m: turned(by_m),
        },
        same => same,
    };
    edits.into_iter().map(one).collect()
}
