//! Motions dragged on the map: a keyframe is moved, or a path is bent.

use glam::DVec2;

use crate::Edit;
use crate::lanes::nearest_lane;
use crate::tools::{Act, HANDLE_REACH, Hand, Modifiers, ReadonlyContext, Response};
use language::tf;
use scene::clip::Path;
use scene::{BoxId, Clip, Frame, Motion, Scene};

/// Spacing of the knots along a path, m.
const KNOTS_EVERY_M: f64 = 10.0;
/// Least distance along the path, to either side of the dragged place, within which the path bends with it, m.
const BEND_M: f64 = 15.0;
/// Largest spacing of the points of a bent part of a path, m.
const STEP_M: f64 = 1.0;
/// Distance within which a lane catches a knot, m.
const CATCH_M: f64 = 2.0;

/// Handle of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Knot {
    /// A keyframe, by its index.
    Key(usize),
    /// A place of a path, by its distance along the path, m.
    Along(f64),
}

/// A drag of a motion in progress.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MotionDrag {
    id: Option<BoxId>,
    knot: Knot,
    start: Motion,
    start_m: DVec2,
}

impl MotionDrag {
    /// The drag of the nearest knot within `reach_m` of a place, of the only chosen object or, with an empty selection,
    /// of the ego vehicle; `None` if there is none. The caller looks whether the object itself is there.
    pub(super) fn held(scene: &Scene, hand: &Hand, at_m: DVec2, reach_m: f64) -> Option<Self> {
        let (id, motion) = editable(scene.clip(), hand)?;
        let knots = knots(motion).into_iter();
        let near = knots.filter(|(_, p)| p.distance(at_m) <= reach_m);
        let (knot, start_m) = near.min_by(|a, b| a.1.distance(at_m).total_cmp(&b.1.distance(at_m)))?;
        let start = motion.clone();
        Some(Self {
            id,
            knot,
            start,
            start_m,
        })
    }

    /// Edits that move the knot to another place.
    pub(super) fn edits(&self, scene: &Scene, hand: &Hand, to_m: DVec2, held: Modifiers) -> Vec<Edit> {
        let (to_m, yaw_rad) = snapped(scene.frame(), hand, to_m, held);
        let motion = match (&self.start, self.knot) {
            (Motion::Keys(keys), Knot::Key(i)) => {
                let mut keys = keys.clone();
                let Some(key) = keys.get_mut(i) else {
                    return Vec::new();
                };
                key.at_m = to_m;
                if let Some(yaw_rad) = yaw_rad {
                    key.yaw_deg = nearest_turn(key.yaw_deg, yaw_rad.to_degrees());
                }
                Motion::Keys(keys)
            }
            (Motion::Path(path), Knot::Along(along_m)) => {
                Motion::Path(bent(path, along_m, to_m - self.start_m))
            }
            _ => return Vec::new(),
        };
        let track = self.id.and_then(|id| scene.clip().tracks.get(&id));
        let [from_s, to_s] = track.map_or([None; 2], |t| t.there_s);
        vec![Edit::SetMotion {
            id: self.id,
            motion: Some(motion),
            from_s,
            to_s,
        }]
    }

    /// The name of the undo step.
    pub(super) fn label(&self) -> &'static str {
        match self.knot {
            Knot::Key(_) => "Move keyframe",
            Knot::Along(_) => "Bend path",
        }
    }

    /// The text beside the pointer.
    pub(super) fn text(&self) -> String {
        match (&self.start, self.knot) {
            (Motion::Keys(keys), Knot::Key(i)) => {
                let time_s = keys.get(i).map_or(0.0, |k| k.time_s);
                tf!("keyframe at {time} s", time = format!("{time_s:.1}"))
            }
            (_, Knot::Along(along_m)) => {
                tf!("{length} m along the path", length = format!("{along_m:.0}"))
            }
            _ => String::new(),
        }
    }

    /// Shows it as far as it is dragged.
    pub(super) fn preview(&self, scene: &Scene, hand: &Hand, to_m: DVec2, held: Modifiers) -> Response {
        let edits = self.edits(scene, hand, to_m, held);
        match edits.is_empty() {
            true => Response::none(),
            false => Response::act(Act::Preview(edits)),
        }
    }
}

/// Places of the knots to draw, m.
pub(super) fn knots_m(sight: &ReadonlyContext<'_>) -> Vec<DVec2> {
    let Some((_, motion)) = editable(sight.scene.clip(), sight.hand) else {
        return Vec::new();
    };
    knots(motion).into_iter().map(|(_, p)| p).collect()
}

/// True if a knot is under the pointer.
pub(super) fn is_over_knot(sight: &ReadonlyContext<'_>, at_m: DVec2) -> bool {
    let reach_m = HANDLE_REACH / sight.view.scale();
    !sight.hand.outlines() && MotionDrag::held(sight.settled, sight.hand, at_m, reach_m).is_some()
}

/// The motion of the one thing that is chosen; with nothing chosen the ego vehicle's.
fn editable<'a>(clip: &'a Clip, hand: &Hand) -> Option<(Option<BoxId>, &'a Motion)> {
    let id = match hand.chosen()[..] {
        [] if hand.things.chosen.is_empty() => None,
        [id] => Some(id),
        _ => return None,
    };
    Some((id, clip.motion(id)?))
}

fn knots(motion: &Motion) -> Vec<(Knot, DVec2)> {
    match motion {
        Motion::Keys(keys) => {
            let keys = keys.iter().enumerate();
            keys.map(|(i, k)| (Knot::Key(i), k.at_m)).collect()
        }
        Motion::Path(path) => {
            let pieces = (path.length_m() / KNOTS_EVERY_M).round().clamp(1.0, 1e4) as usize;
            let along_m = |i: usize| path.length_m() * i as f64 / pieces as f64;
            let all = (0..=pieces).map(along_m);
            all.map(|at| (Knot::Along(at), path.point(at))).collect()
        }
        Motion::Attached { .. } => Vec::new(),
    }
}

/// A path whose point at `along_m` moves by `by_m`; points near it follow smoothly.
fn bent(path: &Path, along_m: f64, by_m: DVec2) -> Path {
    let mut points_m: Vec<DVec2> = Vec::with_capacity(path.points_m.len() + 64);
    let mut passed_m = 0.0;
    // A long move bends more of the path, so that the path does not turn sharply.
    let reach_m = BEND_M.max(2.5 * by_m.length());
    let moved = |at_m: DVec2, passed_m: f64| {
        let apart = ((passed_m - along_m).abs() / reach_m).min(1.0);
        at_m + by_m * (0.5 + 0.5 * (apart * std::f64::consts::PI).cos())
    };
    for pair in path.points_m.windows(2) {
        let length_m = pair[0].distance(pair[1]);
        let near = passed_m < along_m + reach_m && passed_m + length_m > along_m - reach_m;
        let room = Motion::MAX_POINTS.saturating_sub(points_m.len() + path.points_m.len());
        let pieces = match near {
            true => ((length_m / STEP_M).ceil() as usize).clamp(1, room.max(1)),
            false => 1,
        };
        let piece = |i: usize| {
            let share = i as f64 / pieces as f64;
            moved(pair[0].lerp(pair[1], share), passed_m + share * length_m)
        };
        points_m.extend((0..pieces).map(piece));
        passed_m += length_m;
    }
    if let Some(last) = path.points_m.last() {
        points_m.push(moved(*last, passed_m));
    }
    Path {
        points_m,
        ..path.clone()
    }
}

/// A place snapped as moves of boxes are, with the heading of the lane that caught it.
fn snapped(frame: &Frame, hand: &Hand, to_m: DVec2, held: Modifiers) -> (DVec2, Option<f64>) {
    let snap = hand.snap(held.ctrl);
    if snap.lane
        && !held.alt
        && let Some(lane) = nearest_lane(&frame.layout, to_m, CATCH_M)
    {
        return (lane.at_m, Some(lane.yaw_rad));
    }
    let step_m = snap.grid_m.filter(|step| *step > 0.0);
    (step_m.map_or(to_m, |step| (to_m / step).round() * step), None)
}

/// The heading of a lane, degrees, along the lane or against it, in the turn nearest to the heading before: a keyframe
/// does not spin round, and a vehicle that drives the wrong way goes on doing so.
fn nearest_turn(was_deg: f64, lane_deg: f64) -> f64 {
    lane_deg + ((was_deg - lane_deg) / 180.0).round() * 180.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::clip::Speed;
    use scene::{Key, Polyline, PolylineKind};

    use crate::tools::testing::{NONE, Table};
    use crate::tools::{ToolDef, select};

    fn path(points_m: &[[f64; 2]]) -> Path {
        Path {
            points_m: points_m.iter().map(|p| DVec2::from(*p)).collect(),
            start_m: 0.0,
            speeds: vec![Speed {
                time_s: 0.0,
                mps: 5.0,
            }],
            rear_first: false,
        }
    }

    #[test]
    fn a_path_bends_near_where_it_is_taken_and_stays_elsewhere() {
        let straight = path(&[[0.0, 0.0], [100.0, 0.0]]);
        let bent = bent(&straight, 50.0, DVec2::new(0.0, 3.0));
        assert!((bent.point(50.1).y - 3.0).abs() < 0.1, "{}", bent.point(50.1));
        for p in &bent.points_m {
            let apart = (p.x - 50.0).abs();
            assert!((0.0..=3.0).contains(&p.y));
            assert!(apart < BEND_M || p.y == 0.0, "{p}");
        }
        // No corner: neighbouring pieces turn little.
        for three in bent.points_m.windows(3) {
            let turn = (three[1] - three[0]).angle_to(three[2] - three[1]);
            assert!(turn.abs() < 0.1, "{turn}");
        }
        assert_eq!(bent.problem(), None);
        let still = self::bent(&straight, 0.0, DVec2::ZERO);
        assert!((still.length_m() - 100.0).abs() < 1e-9);
    }

    #[test]
    fn a_path_of_as_many_points_as_there_may_be_can_be_bent() {
        let points: Vec<[f64; 2]> = (0..Motion::MAX_POINTS).map(|i| [i as f64 * 0.05, 0.0]).collect();
        assert_eq!(bent(&path(&points), 100.0, DVec2::Y).problem(), None);
        let points: Vec<[f64; 2]> = (0..Motion::MAX_POINTS).map(|i| [i as f64 * 1.5, 0.0]).collect();
        let bent = bent(&path(&points[..600]), 100.0, DVec2::Y);
        assert_eq!(bent.problem(), None);
    }

    #[test]
    fn keyframes_are_dragged_and_caught_by_lanes() {
        let mut table = Table::new();
        let key = |time_s: f64, x: f64| Key {
            time_s,
            at_m: DVec2::new(x, 0.0),
            yaw_deg: 0.0,
        };
        table.scene.change_clip(|clip| {
            clip.length_s = 4.0;
            clip.ego = Some(Motion::Keys(vec![key(0.0, 0.0), key(2.0, 10.0), key(4.0, 20.0)]));
        });
        table.scene.change_canvas(|frame| {
            std::sync::Arc::make_mut(&mut frame.layout.polylines).push(Polyline {
                kind: PolylineKind::LaneCenter,
                points_m: vec![DVec2::new(-40.0, 6.0), DVec2::new(40.0, 6.0)],
            });
        });
        let def: &ToolDef = &select::DEF;
        let mut tool = (def.make)();
        let moved = |table: &mut Table, tool: &mut dyn crate::tools::Tool, from: [f64; 2], to: [f64; 2]| {
            assert!(table.press(tool, from[0], from[1], NONE).holds);
            let shown = table.drag(tool, to[0], to[1]);
            let ended = table.release(tool, to[0], to[1]);
            (shown.acts, ended.acts)
        };
        table.hand.snap_lane = true;
        let (shown, ended) = moved(&mut table, &mut *tool, [10.0, 0.0], [12.0, 5.0]);
        let [Act::Preview(edits)] = &shown[..] else {
            panic!("{shown:?}");
        };
        let [
            Edit::SetMotion {
                id: None,
                motion: Some(Motion::Keys(keys)),
                ..
            },
        ] = &edits[..]
        else {
            panic!("{edits:?}");
        };
        assert_eq!(keys[1].at_m, DVec2::new(12.0, 6.0));
        assert_eq!((keys[0].at_m.x, keys[2].at_m.x), (0.0, 20.0));
        assert_eq!(ended, [Act::Commit("Move keyframe".into())]);
        // A click moves nothing.
        let (shown, ended) = moved(&mut table, &mut *tool, [10.0, 0.0], [10.1, 0.0]);
        assert!(shown.is_empty() && ended.is_empty(), "{shown:?} {ended:?}");
        // Nothing is taken where there is no knot.
        table.press(&mut *tool, 5.0, 0.0, NONE);
        assert!(table.drag(&mut *tool, 8.0, 3.0).acts.is_empty());
    }

    #[test]
    fn against_the_lane_stays_against_the_lane() {
        assert_eq!(nearest_turn(180.0, 2.0), 182.0);
        assert_eq!(nearest_turn(355.0, 2.0), 362.0);
        assert_eq!(nearest_turn(-10.0, 2.0), 2.0);
    }
}
