//! Edits of the background by words: the things that are meant, the changes, and the questions.

use std::collections::BTreeMap;

use glam::DVec2;
use serde::Serialize;

use super::place::FreeGround;
use super::targets::{Meant, targets};
use super::wishes::forms;
use super::{Amount, SceneryClause, SceneryKind, Verb};
use place::off::TOLERATED_M;
use scene::Form;
use scene::background::STOREY_M;
use scene::{Background, BevLayout, BoxId, Class, Edit, SceneBox, ThingId};
use world::scenery::RoadsideKind;

/// Change of a height if none is said: number of storeys for a building; the next constant is the share for other
/// things.
const USUAL_STOREYS: f64 = 2.0;
const USUAL_SHARE: f64 = 0.4;
/// Least heights of buildings and of other things after an edit, m.
const LEAST_M: [f64; 2] = [2.5, 0.4];

/// A thing that a question names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThingCandidate {
    /// Its kind.
    pub class: &'static str,
    /// Its place, in words.
    pub place: String,
    /// Its id, or that of the first one of a row.
    pub id: ThingId,
    /// The clause that means it alone; it replaces the one that raised the question.
    pub said: SceneryClause,
}

impl ThingCandidate {
    /// Words that name it alone: `the tree #12`.
    pub fn answer(&self) -> String {
        format!("{}{}", self.said.things(), self.said.place())
    }
}

/// A question: several things fit where one was meant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThingQuestion {
    /// The question: `the tree: 3 fit, which one?`
    pub text: String,
    /// Index of the clause that named it.
    pub clause: usize,
    /// The things that fit.
    pub candidates: Vec<ThingCandidate>,
}

/// Result of the clauses about the background.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ThingOutcome {
    /// Changes, in order; world frame.
    pub edits: Vec<Edit>,
    /// Questions that must be answered first.
    pub questions: Vec<ThingQuestion>,
    /// Changes that were made, one line each.
    pub done: Vec<String>,
    /// Changes that could not be made, one line each.
    pub cannot: Vec<String>,
}

/// The parts of an open scene that edits of its background need.
#[derive(Clone, Copy, Debug)]
pub struct OpenBackground<'a> {
    /// Its things, ego frame.
    pub things: &'a Background,
    /// Map, ego frame.
    pub layout: &'a BevLayout,
    /// Boxes, ego frame.
    pub boxes: &'a BTreeMap<BoxId, SceneBox>,
}

/// True if clauses name barriers of this scene, which are boxes: "the fence".
pub fn means_barriers(said: &[SceneryClause], boxes: &BTreeMap<BoxId, SceneBox>) -> bool {
    boxes.values().any(|b| b.class == Class::Barrier) && said.iter().any(super::may_be_barrier)
}

/// Carries out the clauses one by one, each on the result of the one before.
pub fn carry_out(said: &[SceneryClause], open: &OpenBackground<'_>, seed: u64) -> ThingOutcome {
    let mut out = ThingOutcome::default();
    if said.is_empty() {
        return out;
    }
    let mut now: Background = open.things.iter().filter(|t| in_grid(&t.form)).cloned().collect();
    for (i, s) in said.iter().enumerate() {
        let ground = FreeGround::new(open.layout, open.boxes, &now);
        match one(s, &now, ground, seed.wrapping_add(i as u64)) {
            Ok((edit, n)) => {
                let off = off(s, &edit, &FreeGround::new(open.layout, open.boxes, &now));
                apply(&mut now, &edit, open.things);
                // (a number that was not in the text)
                let counted = n > 1 && s.count.is_none_or(|c| c as usize != n);
                let n = if counted { format!(" ({n})") } else { String::new() };
                let off = off.map(|o| format!(" ({o})")).unwrap_or_default();
                out.done.push(format!("{}{n}{off}", as_command(s)));
                out.edits.extend(edit);
            }
            Err(Stopped::Asked(candidates)) => out.questions.push(ThingQuestion {
                text: format!(
                    "{}{}: {} fit, which one?",
                    s.things(),
                    s.place(),
                    candidates.len()
                ),
                clause: i,
                candidates,
            }),
            Err(Stopped::Cannot(why)) => out.cannot.push(why),
        }
    }
    out
}

/// Distance ahead of the first new thing, if it is not the one that was asked for: "9.2 m in place of 12 m".
fn off(s: &SceneryClause, edits: &[Edit], ground: &FreeGround) -> Option<String> {
    let asked_m = s.place.distance_m.filter(|_| s.place.near.is_none() && !s.row)?;
    let first = edits.iter().find_map(|e| match e {
        Edit::AddThings { forms } => forms.first(),
        _ => None,
    })?;
    let found_m = ground.roads.along_ego_lane(first.middle_m()).x.abs();
    let is_off = (found_m - asked_m).abs() > TOLERATED_M;
    is_off.then(|| format!("{found_m:.1} m in place of {asked_m} m"))
}

/// The clause as a command: in an open scene, a thing that a description mentions is added.
fn as_command(s: &SceneryClause) -> SceneryClause {
    SceneryClause {
        verb: if s.verb == Verb::Have { Verb::Add } else { s.verb },
        ..s.clone()
    }
}

fn in_grid(form: &Form) -> bool {
    let (lo, hi) = form.bounds_m();
    lo.max_element() < 40.0 && hi.min_element() > -40.0
}

enum Stopped {
    Asked(Vec<ThingCandidate>),
    Cannot(String),
}

/// Edits of one clause in the ego frame, in the order in which they are applied, and the number of things that they
/// change.
fn one(
    s: &SceneryClause,
    now: &Background,
    ground: FreeGround,
    seed: u64,
) -> Result<(Vec<Edit>, usize), Stopped> {
    let called = format!("{}{}", s.things(), s.place());
    if matches!(s.verb, Verb::Add | Verb::Have) {
        let forms = forms(s, ground, seed).map_err(Stopped::Cannot)?;
        let n = forms.len();
        return Ok((vec![Edit::AddThings { forms }], n));
    }
    if matches!(s.what, SceneryKind::Place(p) if p != RoadsideKind::Forest) {
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
                _ => format!("{called}: there is none"),
            };
            return Err(Stopped::Cannot(why));
        }
        Meant::These(ids) => ids,
        Meant::Ask(list) => {
            let candidate = |(id, place, said): (ThingId, String, SceneryClause)| ThingCandidate {
                class: now.get(id).map_or("thing", |t| t.form.name()),
                place,
                id,
                said,
            };
            return Err(Stopped::Asked(list.into_iter().map(candidate).collect()));
        }
    };
    let n = ids.len();
    match s.verb {
        Verb::Move => {
            let Some((by, (ahead, left))) = s.by.zip(s.way) else {
                return Err(Stopped::Cannot("say how far and which way".into()));
            };
            let by_m = DVec2::new(ahead, left) * metres(by);
            Ok((
                vec![Edit::MoveThings {
                    ids,
                    by_m,
                    turn_deg: 0.0,
                }],
                n,
            ))
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
                edits.push(Edit::RaiseThings { ids: vec![id], by_m });
            }
            Ok((edits, n))
        }
        _ => Ok((vec![Edit::RemoveThings { ids }], n)),
    }
}

fn metres(amount: Amount) -> f64 {
    match amount {
        Amount::Storeys(n) => n * STOREY_M,
        Amount::Metres(m) => m,
    }
}

/// Applies edits to the things that later clauses look at.
fn apply(now: &mut Background, edits: &[Edit], all: &Background) {
    for edit in edits {
        match edit {
            Edit::RemoveThings { ids } => ids.iter().for_each(|id| {
                now.remove(*id);
            }),
            Edit::AddThings { forms } => {
                for form in forms {
                    // The id that the editor will give it.
                    let id = ThingId(now.next_id().0.max(all.next_id().0));
                    now.insert(scene::Thing {
                        id,
                        form: form.clone(),
                        look: id.0,
                        placed: true,
                    });
                }
            }
            Edit::MoveThings { ids, by_m, .. } => {
                change(now, ids, |form| form.map_points(|p| p + *by_m, 0.0))
            }
            _ => {} // a height changes no place
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
