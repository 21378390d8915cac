//! Forecast of a scene after its end: moving objects keep moving along their lanes and behind the vehicle ahead, the
//! ego vehicle too, and the map grows to where the ego vehicle comes.

use std::collections::BTreeSet;

use glam::DVec2;
use language::tf;

use scene::clip::{Path, Speed};
use scene::{BoxId, Class, Clip, Edit, Key, Motion, Moving, Scene};

use super::apply_all;
use crate::checks::collisions;
use crate::reaching::{reaching, sights_m};
use crate::traffic::everybody::Everybody;
use crate::traffic::follow::{Driver, VehicleBody, follow};
use crate::traffic::lane_path::lane_path;
use crate::traffic::template;

/// Objects slower than this do not go on, m/s.
const MOVES_MPS: f64 = 0.3;
/// Time between keyframes that are added, s.
const STEP_S: f64 = 0.5;
/// Rounds in which all objects adapt to each other: a vehicle that brakes makes the next one behind it brake, and each
/// round reaches one vehicle more.
const ROUNDS: usize = 4;
/// Collisions that are listed in a message.
const MOST_TOLD: usize = 4;
/// Length of a path beyond the distance driven on it, m.
const BEYOND_M: f64 = 20.0;

/// Continuation of a scene: the edits, and the collisions that they bring.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// The edits, to be applied as one step.
    pub edits: Vec<Edit>,
    /// Objects that go on.
    pub objects: usize,
    /// New collisions in these seconds, as sentences of the checks.
    pub meets: Vec<String>,
}

impl Forecast {
    /// The new collisions in one line for the user; `None` if there are none.
    pub fn said(&self) -> Option<String> {
        let first: Vec<&str> = self.meets.iter().take(MOST_TOLD).map(String::as_str).collect();
        let more = self.meets.len().saturating_sub(MOST_TOLD);
        let more = if more > 0 {
            format!("; +{more}")
        } else {
            String::new()
        };
        (!first.is_empty()).then(|| {
            tf!(
                "What goes on comes into something: {why}",
                why = first.join("; ") + &more
            )
        })
    }
}

/// Continues the scene by `seconds`. Errors in one line.
pub fn forecast(scene: &Scene, seconds: f64) -> Result<Forecast, String> {
    let from_s = scene.clip().length_s;
    let to_s = from_s + seconds;
    // Written so that NaN fails too.
    if !(seconds > 0.0 && to_s <= Clip::MAX_LENGTH_S) {
        return Err(format!(
            "{seconds} s more after {from_s} s, expected more than 0 and at most {} s in all",
            Clip::MAX_LENGTH_S
        ));
    }
    let mut edits = vec![Edit::SetLength {
        length_s: to_s,
        rate_hz: None,
    }];
    let goers = goers(scene, from_s);
    if goers.is_empty() {
        return Err("nothing moves at the end of the scene: let something move first".to_owned());
    }
    let (motions, later) = together(scene, &goers, &edits, (from_s, to_s))?;
    let known: BTreeSet<String> = collisions(scene).into_iter().map(|c| c.text).collect();
    let mut meets: Vec<String> = collisions(&later).into_iter().map(|c| c.text).collect();
    meets.retain(|text| !known.contains(text));
    edits.extend(motions);
    edits.extend(room_for_us(&later, from_s));
    Ok(Forecast {
        edits,
        objects: goers.iter().filter(|g| g.id.is_some()).count(),
        meets,
    })
}

/// Edits that let these move on from a time to another, each with regard to the others; and the scene after `first` and
/// these edits.
pub(super) fn together(
    scene: &Scene,
    goers: &[Goer],
    first: &[Edit],
    (from_s, to_s): (f64, f64),
) -> Result<(Vec<Edit>, Scene), String> {
    let set = |goer: &Goer, motion| Edit::SetMotion {
        id: goer.id,
        motion: Some(motion),
        from_s: goer.there_s[0],
        to_s: goer.there_s[1],
    };
    let motions = |others: Option<&Scene>| -> Vec<Edit> {
        // (where everybody is at each moment is worked out once, not once for each of them)
        let everybody = others.map(|later| Everybody::from_scene(later, from_s, to_s - from_s));
        let motion = |g: &Goer| set(g, g.goes_on(scene, everybody.as_ref(), (from_s, to_s)));
        goers.iter().map(motion).collect()
    };
    // First all go on at their present speed, so that the followers then find the others moving.
    let mut later = scene.clone();
    let mut found = motions(None);
    let all: Vec<Edit> = first.iter().chain(&found).cloned().collect();
    apply_all(&all, &mut later).map_err(|e| e.to_string())?;
    for _ in 1..ROUNDS {
        found = motions(Some(&later));
        // (objects that already have a motion only get another one)
        apply_all(&found, &mut later).map_err(|e| e.to_string())?;
    }
    Ok((found, later))
}

/// The edit that makes the map reach where the ego vehicle comes after `from_s`, with as much map around it as there
/// was until then; `None` if it does already. Other objects may leave the map.
pub(super) fn room_for_us(scene: &Scene, from_s: f64) -> Option<Edit> {
    let relief = &scene.canvas().layout.relief;
    let still = scene.canvas().world_from_ego;
    let way = |to_s: f64| -> Vec<DVec2> {
        let times = (0..=(to_s / STEP_S).ceil() as usize).map(|i| (i as f64 * STEP_S).min(to_s));
        let pose = |t| scene.clip().ego_at(t, &still, relief).translation_m.truncate();
        times.map(pose).collect()
    };
    let extent = scene.canvas().extent();
    let sights = sights_m(extent, way(from_s).into_iter());
    reaching(extent, way(scene.clip().length_s).into_iter(), sights)
}

/// An object that moves at the end of the clip, or the ego vehicle (no id).
pub(super) struct Goer {
    pub(super) id: Option<BoxId>,
    now: Moving,
    class: Option<Class>,
    body: VehicleBody,
    there_s: [Option<f64>; 2],
    pub(super) motion: Option<Motion>,
}

/// All objects that move at a time, the ego vehicle first.
pub(super) fn goers(scene: &Scene, from_s: f64) -> Vec<Goer> {
    let (clip, end) = (scene.clip(), scene.at(from_s));
    let mut out = Vec::new();
    let pose = end.frame().world_from_ego;
    let ahead = (pose.rotation * glam::DVec3::X).truncate();
    let still = Moving {
        velocity_mps: ahead
            * if clip.length_s > 0.0 {
                0.0
            } else {
                scene.rig.ego_speed_mps
            },
        ..Moving::still(pose.translation_m.truncate(), ahead.to_angle())
    };
    out.push(Goer {
        id: None,
        now: clip.ego_moving(from_s).unwrap_or(still),
        class: None,
        body: template::body_of_ego(scene),
        there_s: [None; 2],
        motion: clip.ego.clone(),
    });
    for b in end.frame().boxes.values() {
        let track = clip.tracks.get(&b.id);
        out.push(Goer {
            id: Some(b.id),
            now: Moving::from(b),
            class: Some(b.class),
            body: template::body_of(b),
            there_s: track.map_or([None; 2], |t| t.there_s),
            motion: track.map(|t| t.motion.clone()),
        });
    }
    let attached = |g: &Goer| matches!(g.motion, Some(Motion::Attached { .. }));
    out.retain(|g| g.now.velocity_mps.length() > MOVES_MPS && !attached(g));
    out
}

impl Goer {
    /// Its motion up to `to_s`; `everybody` gives the positions of all objects from `from_s` on, `None` keeps the
    /// present speed.
    fn goes_on(
        &self,
        scene: &Scene,
        everybody: Option<&Everybody<'_>>,
        (from_s, to_s): (f64, f64),
    ) -> Motion {
        let mps = self.now.velocity_mps.length();
        let reach_m = mps * (to_s - from_s) * 1.3 + BEYOND_M;
        let way = match self.class {
            // People go where they look.
            Some(Class::Pedestrian) => {
                let heading = self.now.velocity_mps.normalize_or_zero();
                vec![self.now.at_m, self.now.at_m + heading * reach_m]
            }
            _ => lane_path(&scene.canvas().layout, &self.now, reach_m),
        };
        let speeds = match everybody {
            Some(everybody) => self.careful_speeds(everybody, &way, (from_s, to_s)),
            None => vec![Speed { time_s: from_s, mps }],
        };
        let on = Path {
            points_m: way,
            start_m: 0.0,
            speeds,
            rear_first: false,
        };
        match &self.motion {
            None => Motion::Path(on),
            Some(Motion::Path(path)) if !path.rear_first => Motion::Path(joined(path, &on, from_s)),
            Some(motion) => Motion::Keys(keyed(motion, &on, (from_s, to_s))),
        }
    }

    fn careful_speeds(
        &self,
        everybody: &Everybody<'_>,
        way: &[DVec2],
        (from_s, to_s): (f64, f64),
    ) -> Vec<Speed> {
        let mps = self.now.velocity_mps.length();
        if self.class == Some(Class::Pedestrian) {
            return vec![Speed { time_s: from_s, mps }];
        }
        let others = |t: f64| everybody.others(self.id, t);
        let found = follow(
            &Driver::at(mps.max(2.0)),
            way,
            (0.0, mps),
            &self.body,
            to_s - from_s,
            others,
        );
        let at = |s: Speed| Speed {
            time_s: from_s + s.time_s,
            ..s
        };
        found.speeds.into_iter().map(at).collect()
    }
}

/// A path, and from `from_s` on another one that begins where it is then.
fn joined(path: &Path, on: &Path, from_s: f64) -> Path {
    let (along_m, _) = path.along(from_s);
    let mut points_m = vec![path.points_m[0]];
    let mut way_m = 0.0;
    for pair in path.points_m.windows(2) {
        way_m += pair[0].distance(pair[1]);
        if way_m >= along_m {
            break;
        }
        points_m.push(pair[1]);
    }
    points_m.extend(&on.points_m);
    points_m.dedup();
    let mut speeds: Vec<Speed> = path
        .speeds
        .iter()
        .copied()
        .filter(|s| s.time_s < from_s - 1e-6)
        .collect();
    speeds.extend(&on.speeds);
    Path {
        points_m,
        speeds,
        ..path.clone()
    }
}

/// Keyframes of a motion up to `from_s`, then of a path.
fn keyed(motion: &Motion, on: &Path, (from_s, to_s): (f64, f64)) -> Vec<Key> {
    let mut keys: Vec<Key> = match motion {
        Motion::Keys(keys) => keys
            .iter()
            .copied()
            .filter(|k| k.time_s <= from_s + 1e-6)
            .collect(),
        _ => Vec::new(),
    };
    let mut last_deg = keys.last().map_or(0.0, |k| k.yaw_deg);
    let steps = ((to_s - from_s) / STEP_S).ceil().max(1.0) as usize;
    let first = usize::from(keys.last().is_some_and(|k| (k.time_s - from_s).abs() < 1e-6));
    for i in first..=steps {
        let time_s = from_s + (to_s - from_s) * i as f64 / steps as f64;
        let at = on.at(time_s);
        // The nearer way around, as the headings before.
        let turn = (at.yaw_rad.to_degrees() - last_deg + 180.0).rem_euclid(360.0) - 180.0;
        last_deg += turn;
        keys.push(Key {
            time_s,
            at_m: at.at_m,
            yaw_deg: last_deg,
        });
    }
    keys
}

#[cfg(test)]
#[path = "forecast_tests.rs"]
mod tests;
