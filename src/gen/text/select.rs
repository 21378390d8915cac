//! Which boxes of a scene the words mean.

use std::collections::BTreeMap;

use serde::Serialize;

use super::description::Anchor;
use super::holds::{Target, ego, holds};
use super::lanes::LaneMap;
use super::mention::Mention;
use super::words::edits::Pick;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};
use crate::scene::{BevLayer, BoxId, Class, SceneBox};

/// A box that a question names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Its id.
    pub id: BoxId,
    /// Its class.
    pub class: &'static str,
    /// Where it stands, in words.
    pub place: String,
    /// The words that name it alone, if it is no box: they replace those that were asked about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answer: Option<String>,
}

impl Candidate {
    /// What the words that were asked about become if this is the one: `#7`.
    pub fn says(&self) -> String {
        self.answer.clone().unwrap_or_else(|| format!("#{}", self.id.0))
    }
}

/// What a mention means in a scene.
pub enum Chosen {
    /// These.
    These(Vec<BoxId>),
    /// No box fits.
    None(String),
    /// Fewer than were named.
    TooFew {
        /// The words.
        what: String,
        /// That fit.
        found: usize,
        /// That were named.
        wanted: usize,
    },
    /// One is meant and several fit.
    Several {
        /// The words.
        what: String,
        /// All that fit.
        candidates: Vec<Candidate>,
    },
}

/// Where a box is, in words, after what it is called if it has a name or paint: `red taxi, 12 m ahead, 3 m left, parked`.
pub fn where_is(map: &LaneMap<'_>, b: &SceneBox) -> Candidate {
    let (x, y) = (b.center_m.x, b.center_m.y);
    let along = if x >= 0.0 { "ahead" } else { "behind" };
    let across = match y {
        y if y > 0.5 => format!(", {y:.0} m left"),
        y if y < -0.5 => format!(", {:.0} m right", -y),
        _ => String::new(),
    };
    let doing = match b.velocity_mps.length() {
        v if v > 0.5 => ", moving",
        _ if state_of(map, b, ObjectState::Parked) && (b.class.is_vehicle()) => ", parked",
        _ => ", standing",
    };
    let called = if b.label.is_empty() {
        String::new()
    } else {
        format!("{}, ", b.called())
    };
    Candidate {
        id: b.id,
        class: b.class.name(),
        place: format!("{called}{:.0} m {along}{across}{doing}", x.abs()),
        answer: None,
    }
}

/// True if a box may be said to move, to wait or to be parked.
pub fn state_of(map: &LaneMap<'_>, b: &SceneBox, state: ObjectState) -> bool {
    let stands = b.velocity_mps.length() < 0.5;
    let p = b.center_m.truncate();
    match state {
        ObjectState::Moving => !stands,
        ObjectState::Waiting => stands,
        // Parked: standing, and not in the middle of a lane.
        ObjectState::Parked => {
            let off = map.nearest(p).map_or(f64::INFINITY, |l| {
                l.dir.perp_dot(p - l.p).abs().max(l.p.distance(p) - 1.0)
            });
            // (a narrow lane leaves what is parked at its edge little room beside its middle)
            let edge = || off > 0.3 && super::holds::in_role(map, crate::scene::graph::LaneRole::Roadside, p);
            stands && (off > 0.7 || map.has(BevLayer::CarparkArea.bit(), p) || edge())
        }
    }
}

/// Ids of the boxes that fit class, state and relations of a mention.
pub fn fitting(
    map: &LaneMap<'_>,
    boxes: &BTreeMap<BoxId, SceneBox>,
    m: &Mention,
    all: &[Mention],
) -> Vec<BoxId> {
    fitting_deep(map, boxes, m, all, 0)
}

fn fitting_deep(
    map: &LaneMap<'_>,
    boxes: &BTreeMap<BoxId, SceneBox>,
    m: &Mention,
    all: &[Mention],
    depth: u8,
) -> Vec<BoxId> {
    if let Some(id) = m.id {
        return boxes
            .contains_key(&BoxId(id))
            .then_some(BoxId(id))
            .into_iter()
            .collect();
    }
    let side = |kind: RelationKind, b: &SceneBox| match kind {
        // In words a car 30 m ahead in the left lane is on the left.
        RelationKind::LeftOf => Some(b.center_m.y > 1.0),
        RelationKind::RightOf => Some(b.center_m.y < -1.0),
        RelationKind::InFrontOf => Some(b.center_m.x > 3.0 && b.center_m.y.abs() < b.center_m.x.max(3.0)),
        RelationKind::Behind => Some(b.center_m.x < -0.5 && b.center_m.y.abs() < (-b.center_m.x).max(3.0)),
        _ => None,
    };
    // Who is called a rider rides, if anybody in the scene does.
    let rides: &[Class] = &[Class::Motorcycle, Class::Bicycle];
    let rider = m.spec.noun.starts_with("rider") && boxes.values().any(|b| rides.contains(&b.class));
    let classes = if rider { rides } else { m.classes };
    let mut fit: Vec<&SceneBox> = boxes.values().filter(|b| classes.contains(&b.class)).collect();
    fit = super::names::called(fit, m);
    // "vehicles" and the like mean every class of the list, a plain noun its own.
    if let Some(state) = m.spec.state {
        let strict: Vec<&SceneBox> = fit.iter().copied().filter(|b| state_of(map, b, state)).collect();
        // ("the man who stands by the bus" may take a step)
        let loose = strict.is_empty()
            && state == ObjectState::Waiting
            && m.spec.class == Class::Pedestrian
            && !m.spec.relations.is_empty();
        // (who follows drives, also where the scene says of him only that he stands behind)
        let follows = strict.is_empty()
            && state == ObjectState::Moving
            && m.spec
                .relations
                .iter()
                .any(|r| r.relation == RelationKind::Following);
        if !loose && !follows {
            fit = strict;
        }
    }
    for r in &m.spec.relations {
        let targets: Vec<(Target, Option<SceneBox>)> = match r.anchor {
            Anchor::Ego => vec![(Target::Thing(ego()), None)],
            Anchor::Lane(role) => vec![(Target::Lane(role), None)],
            Anchor::Crossing => vec![(Target::Crossing, None)],
            Anchor::Junction => vec![(Target::Junction, None)],
            Anchor::Object(i) if depth < 3 => {
                let others = all
                    .get(i)
                    .map_or_else(Vec::new, |o| fitting_deep(map, boxes, o, all, depth + 1));
                let second = match r.and {
                    Some(Anchor::Object(k)) => all
                        .get(k)
                        .map_or_else(Vec::new, |o| fitting_deep(map, boxes, o, all, depth + 1)),
                    _ => Vec::new(),
                };
                let mut pairs = Vec::new();
                for id in &others {
                    let b = boxes[id];
                    if second.is_empty() {
                        pairs.push((Target::Thing(b), r.and.map(|_| ego())));
                    }
                    pairs.extend(second.iter().map(|s| (Target::Thing(b), Some(boxes[s]))));
                }
                pairs
            }
            Anchor::Object(_) => Vec::new(),
        };
        fit.retain(|b| {
            let to_ego = r.anchor == Anchor::Ego && r.distance_m.is_none();
            match side(r.relation, b).filter(|_| to_ego) {
                Some(held) => held,
                None => targets.iter().any(|(t, and)| {
                    !matches!(t, Target::Thing(o) if o.id == b.id)
                        && (holds(map, r.relation, b, t, and.as_ref(), r.distance_m)
                            // a queue before a junction is at the junction
                            || *t == Target::Junction
                                && r.relation == RelationKind::Near
                                && r.distance_m.is_none()
                                && b.center_m.x > 2.0
                                && map.junction.is_some_and(|c| c.distance(b.center_m.truncate()) < 24.0)
                            // who stands near the stripes waits there
                            || r.relation == RelationKind::WaitingAt
                                && b.velocity_mps.length() < 0.5
                                && holds(map, RelationKind::Near, b, t, None, r.distance_m))
                }),
            }
        });
    }
    fit.into_iter().map(|b| b.id).collect()
}

/// The `nth` box that fits, counted from the ego vehicle outwards; 0 is the last.
pub fn in_order(
    map: &LaneMap<'_>,
    boxes: &BTreeMap<BoxId, SceneBox>,
    m: &Mention,
    all: &[Mention],
    nth: usize,
) -> Chosen {
    let mut fit = fitting(map, boxes, m, all);
    let range = |id: &BoxId| boxes[id].center_m.truncate().length();
    fit.sort_by(|a, b| range(a).total_cmp(&range(b)));
    let index = if nth == 0 {
        fit.len().wrapping_sub(1)
    } else {
        nth - 1
    };
    match fit.get(index) {
        Some(id) => Chosen::These(vec![*id]),
        None if fit.is_empty() => Chosen::None(m.spec.noun.clone()),
        None => Chosen::TooFew {
            what: super::lexicon::plural(&m.spec.noun),
            found: fit.len(),
            wanted: nth,
        },
    }
}

/// Of boxes of one class those that the word means: a van is longer and higher than a taxi. All, if none differs.
pub fn of_size(boxes: &[SceneBox], noun: &str, size_m: Option<[f64; 3]>) -> Vec<SceneBox> {
    let generic = matches!(
        noun,
        "car"
            | "cars"
            | "vehicle"
            | "vehicles"
            | "object"
            | "box"
            | "person"
            | "people"
            | "pedestrian"
            | "pedestrians"
            | "truck"
            | "trucks"
    );
    let first = boxes.first().map(|b| b.class);
    let (Some(class), false) = (
        first.filter(|c| boxes.iter().all(|b| b.class == *c)),
        generic && size_m.is_none(),
    ) else {
        return boxes.to_vec();
    };
    let Some(size) = size_m.or(class.typical_size_m()) else {
        return boxes.to_vec();
    };
    let near = |b: &&SceneBox| {
        (b.size_m.z - size[2]).abs() < 0.12 * size[2] && (b.size_m.x - size[0]).abs() < 0.12 * size[0]
    };
    let fit: Vec<SceneBox> = boxes.iter().filter(near).copied().collect();
    if fit.is_empty() { boxes.to_vec() } else { fit }
}

/// What is picked has the lowest rank: "the nearest" by its distance.
pub fn rank(b: &SceneBox, pick: Pick) -> f64 {
    let p = b.center_m.truncate();
    match pick {
        Pick::Nearest => p.length(),
        Pick::Farthest => -p.length(),
        Pick::Leftmost => -p.y,
        Pick::Rightmost => p.y,
        Pick::Frontmost => -p.x,
        Pick::Rearmost => p.x,
        Pick::Largest => -(b.size_m.x * b.size_m.y * b.size_m.z),
        Pick::Smallest => b.size_m.x * b.size_m.y * b.size_m.z,
        Pick::All | Pick::Any | Pick::More => f64::from(b.id.0),
    }
}

/// Decides: all, a picked one, so many, or a question.
pub fn choose(map: &LaneMap<'_>, boxes: &BTreeMap<BoxId, SceneBox>, m: &Mention, all: &[Mention]) -> Chosen {
    let fit = fitting(map, boxes, m, all);
    let state = m.spec.state.map_or("", |s| match s {
        ObjectState::Moving => "moving ",
        ObjectState::Parked => "parked ",
        ObjectState::Waiting => "standing ",
    });
    let paint = m.spec.color.as_ref().map_or(String::new(), |c| format!("{c} "));
    let what = format!("{state}{paint}{}", m.spec.noun);
    if fit.is_empty() {
        return match m.id {
            Some(id) => Chosen::None(format!("box {id}")),
            None => Chosen::None(what),
        };
    }
    // ("all the kids" spares the grown-ups)
    let fit = match fit.len() {
        0 | 1 => fit,
        _ => {
            let all: Vec<SceneBox> = fit.iter().map(|id| boxes[id]).collect();
            let all = super::names::plainly(all, m);
            of_size(&all, &m.spec.noun, m.spec.size_m)
                .iter()
                .map(|b| b.id)
                .collect()
        }
    };
    if let Some(pick) = m.pick
        && pick != Pick::More
    {
        if pick == Pick::All {
            return Chosen::These(fit);
        }
        let n = if m.uncounted { 1 } else { m.spec.count.n as usize };
        let mut sorted = fit;
        let cost = |id: &BoxId| rank(&boxes[id], pick);
        sorted.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        sorted.truncate(n.max(1));
        return Chosen::These(sorted);
    }
    let n = m.spec.count.n as usize;
    if m.plural && m.uncounted {
        return Chosen::These(fit); // "remove the cars"
    }
    if fit.len() <= n {
        if fit.len() < n && !m.uncounted {
            return Chosen::TooFew {
                what,
                found: fit.len(),
                wanted: n,
            };
        }
        return Chosen::These(fit);
    }
    // "the vehicle in front of us" is the one in our lane
    let before_us = matches!(m.spec.relations.as_slice(), [r] if r.anchor == Anchor::Ego
        && r.distance_m.is_none() && matches!(r.relation, RelationKind::InFrontOf | RelationKind::Behind));
    if before_us && m.definite && !m.plural && n == 1 {
        let ours: Vec<BoxId> = fit
            .iter()
            .copied()
            .filter(|id| super::holds::in_role(map, LaneRole::Ego, boxes[id].center_m.truncate()))
            .collect();
        if let [one] = ours.as_slice() {
            return Chosen::These(vec![*one]);
        }
    }
    Chosen::Several {
        what: if m.plural {
            what
        } else {
            super::lexicon::plural(&what)
        },
        candidates: fit.iter().map(|id| where_is(map, &boxes[id])).collect(),
    }
}
