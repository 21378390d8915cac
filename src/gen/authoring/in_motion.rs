//! Motion that words ask for in a new scene.

use super::prompting::Laid;
use editor::{Apply, Edit};
use scene::clip::{Manoeuvre, Template};
use scene::{BoxId, Class, Clip, Scene};

/// Start of a manoeuvre from which on a scene is made longer, s.
const LATE_S: f64 = 3.0;
/// Time for which a manoeuvre is seen after it begins, s.
const SEEN_S: f64 = 5.0;

/// Sets everything in motion that the words ask for, and the ego vehicle with it. Returns the motions that are not
/// possible, in words.
pub(crate) fn set_in_motion(scene: &mut Scene, laid: &Laid) -> Vec<String> {
    let d = &laid.description;
    let length = d.length_s.map(|length_s| Edit::SetLength {
        length_s: length_s.min(Clip::MAX_LENGTH_S),
        rate_hz: None,
    });
    let moving = d.foreground.iter().zip(&laid.graphed.nodes);
    let moving = moving.filter_map(|(o, nodes)| Some((o, nodes, o.motion?)));
    let objects: Vec<(BoxId, Class, Manoeuvre)> = moving
        .flat_map(|(o, nodes, how)| nodes.iter().map(move |id| (BoxId(*id), o.class, how)))
        .collect();
    if objects.is_empty() && d.ego_motion.is_none() && length.is_none() {
        return Vec::new();
    }
    // A manoeuvre that begins late makes the scene longer.
    let latest_s = objects
        .iter()
        .filter_map(|(_, _, how)| how.from_s)
        .fold(0.0, f64::max);
    let length = length.or((latest_s > LATE_S).then(|| Edit::SetLength {
        length_s: (latest_s + SEEN_S).min(Clip::MAX_LENGTH_S),
        rate_hz: None,
    }));
    let ego = match (d.ego_motion, objects.is_empty()) {
        (None, true) => None,
        (how, _) => Some(Edit::let_move(
            &how.unwrap_or(Manoeuvre::from_template(Template::Follow)),
            None,
            None,
        )),
    };
    let edits = objects
        .iter()
        .map(|(id, class, how)| Edit::let_move(how, Some(*id), Some(*class)));
    // The ego vehicle first, so that others know when it comes near; and again at the end, so that it takes them into
    // account.
    let all = length.into_iter().chain(ego.clone()).chain(edits).chain(ego);
    let mut cannot = Vec::new();
    for edit in all {
        let known = match &edit {
            Edit::LetMove { id: Some(id), .. } => scene.frame().boxes.contains_key(id),
            _ => true,
        };
        // (objects without a place are reported elsewhere)
        if known && let Err(error) = edit.apply(scene) {
            cannot.push(error.to_string());
        }
    }
    cannot.dedup();
    cannot
}
