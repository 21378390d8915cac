//! Lets traffic drive: every object that stands but has a velocity goes on along its lane. Objects that would collide
//! stay where they are and are reported.

use std::collections::{BTreeMap, BTreeSet};

use scene::{BoxId, Clip, Edit, Scene};

use super::forecast::{Goer, forecast, goers, together};
use super::off_lane::off_lane;
use crate::checks::{Collision, CollisionPartner, collisions};
use language::tf;

/// Length of a clip that traffic begins, s.
const USUAL_LENGTH_S: f64 = 8.0;
/// After so many rounds, both objects of a pair that collide stay.
const PATIENCE: usize = 12;
/// Reasons that are listed in a message.
const MOST_REASONS: usize = 4;

/// Result of letting traffic drive: the objects that drive off, and those that stay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrafficStart {
    /// The edits, to be applied as one step.
    pub edits: Vec<Edit>,
    /// Objects that drive off.
    pub starts: usize,
    /// Objects that stay where they are, each with the collision that driving would bring.
    pub stays: BTreeMap<BoxId, String>,
}

impl TrafficStart {
    /// The objects that stay and the reasons, in one line for the user; `None` if none stays.
    pub fn said(&self) -> Option<String> {
        if self.stays.is_empty() {
            return None;
        }
        let mut why: Vec<&str> = Vec::new();
        for reason in self.stays.values() {
            if !why.contains(&reason.as_str()) {
                why.push(reason);
            }
        }
        let more = why.len().saturating_sub(MOST_REASONS);
        why.truncate(MOST_REASONS);
        let more = if more > 0 {
            format!("; +{more}")
        } else {
            String::new()
        };
        Some(tf!(
            "{n} of {all} stay where they are; they would come into something: {why}",
            n = self.stays.len(),
            all = self.starts + self.stays.len(),
            why = why.join("; ") + &more
        ))
    }
}

/// Lets every object that has a velocity, but no motion, move from the beginning on, unless it collides with a wall, a
/// standing object, another moving one or the ego vehicle at any time of the clip, by the checks of the editor. A scene
/// of one moment becomes a clip. Errors in one line.
pub fn traffic_drives(scene: &Scene) -> Result<TrafficStart, String> {
    let mut waiting = goers(scene, 0.0);
    waiting.retain(|g| g.id.is_some() && g.motion.is_none());
    let mut first = Vec::new();
    let mut length_s = scene.clip().length_s;
    if length_s == 0.0 {
        length_s = USUAL_LENGTH_S.min(Clip::MAX_LENGTH_S);
        first.push(Edit::SetLength {
            length_s,
            rate_hz: None,
        });
    }
    let mut start = TrafficStart::default();
    for look in 0.. {
        if waiting.is_empty() {
            break;
        }
        let (motions, later) = together(scene, &waiting, &first, (0.0, length_s))?;
        let met = collisions(&later);
        let stays = who_stays(&waiting, &met, look >= PATIENCE);
        if stays.is_empty() {
            start.starts = waiting.len();
            start.edits = first;
            start.edits.extend(motions);
            break;
        }
        waiting.retain(|g| g.id.is_none_or(|id| !stays.contains_key(&id)));
        start.stays.extend(stays);
    }
    Ok(start)
}

/// The objects among `waiting` that should stay, each with the reason; empty if none collides. With `both`, both
/// objects of a colliding pair stay, otherwise one of them.
fn who_stays(waiting: &[Goer], met: &[Collision], both: bool) -> BTreeMap<BoxId, String> {
    let goes: BTreeSet<BoxId> = waiting.iter().filter_map(|g| g.id).collect();
    let mut out: BTreeMap<BoxId, String> = BTreeMap::new();
    let mut pairs: Vec<(BoxId, BoxId, &str)> = Vec::new();
    for m in met {
        let one = m.id.filter(|id| goes.contains(id));
        let other = match m.other {
            CollisionPartner::Box(id) => Some(id).filter(|id| goes.contains(id)),
            CollisionPartner::Ego | CollisionPartner::Wall(_) => None,
        };
        match (one, other) {
            (Some(a), Some(b)) => pairs.push((a, b, &m.text)),
            (Some(id), None) | (None, Some(id)) => {
                out.entry(id).or_insert_with(|| m.text.clone());
            }
            (None, None) => {}
        }
    }
    // (an object that stays for another reason may be no obstacle any more)
    pairs.retain(|(a, b, _)| both || !(out.contains_key(a) || out.contains_key(b)));
    while let Some(&(a, b, text)) = pairs.first() {
        let count = |id: BoxId| pairs.iter().filter(|(a, b, _)| *a == id || *b == id).count();
        // The object with the most collisions stays; of two with as many the one of the larger id.
        let worst = pairs
            .iter()
            .flat_map(|(a, b, _)| [*a, *b])
            .max_by_key(|id| (count(*id), *id))
            .unwrap_or(b);
        let why = |id: BoxId| {
            let of = pairs.iter().find(|(a, b, _)| *a == id || *b == id);
            of.map_or(text, |of| of.2).to_owned()
        };
        if both {
            out.entry(a).or_insert_with(|| why(a));
            out.entry(b).or_insert_with(|| why(b));
            pairs.remove(0);
        } else {
            out.insert(worst, why(worst));
            pairs.retain(|(a, b, _)| *a != worst && *b != worst);
        }
    }
    out
}

/// Remarks for the user on edits that are about to be applied, a line each: the objects that stay where traffic is let
/// drive, the collisions of a forecast, the vehicles that drive where no lane is, and the voxels that stay behind when
/// an inferred box is removed.
pub fn remarks(scene: &Scene, edits: &[Edit]) -> Vec<String> {
    let mut out = super::left_standing::left_standing(scene, edits);
    for (i, edit) in edits.iter().enumerate() {
        if !matches!(
            edit,
            Edit::LetTrafficDrive {} | Edit::Forecast { .. } | Edit::LetMove { .. }
        ) {
            continue;
        }
        let mut before = scene.clone();
        if super::apply_all(&edits[..i], &mut before).is_err() {
            break;
        }
        out.extend(match edit {
            Edit::Forecast { seconds } => forecast(&before, *seconds).ok().and_then(|f| f.said()),
            Edit::LetTrafficDrive {} => traffic_drives(&before).ok().and_then(|start| start.said()),
            edit => off_lane(&before, edit),
        });
    }
    out
}

#[cfg(test)]
#[path = "start_tests.rs"]
mod tests;
