//! The table of templates: names, parameters, and how each motion is made.

use glam::DVec2;

use scene::clip::{Path, Speed, Template};
use scene::{BoxId, Class, Clip, Edit, Motion, Moving, Scene, SceneBox, SensorRig, relations};

use super::follow::{Driver, Other, VehicleBody, ahead_of, can, follow};
use super::gap::{ego_box, ego_box_of};
use super::lane_path::{aside, lane_path, lane_through, smooth};
use super::turning::{Turning, turning};
use crate::kerb;
use crate::lanes::nearest_lane;

/// Length of a clip that gets its first motion, s.
const USUAL_LENGTH_S: f64 = 8.0;
/// Comfortable braking and starting, m/s².
const EASY: f64 = 2.0;
/// Acceleration of a pedestrian, m/s².
const STRIDE: f64 = 3.0;
/// Width of a lane where none is known, m.
const LANE_M: f64 = 3.5;
/// Farthest that a street to turn into is looked for, m.
const TURN_WITHIN_M: f64 = 150.0;
/// Distance within which a vehicle ahead is looked for, m.
const LEADER_WITHIN_M: f64 = 300.0;
/// Farthest way of a pedestrian across a road, m.
const WIDEST_M: f64 = 60.0;

/// Parameters of a template.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// The template.
    pub template: Template,
    /// Speed, m/s.
    pub mps: f64,
    /// Time at which the template's manoeuvre begins, s.
    pub at_s: f64,
    /// How long a change of lanes takes, s.
    pub over_s: f64,
    /// Gap that a follower keeps to the vehicle ahead, bumper to bumper, m; `None` for as much as its speed needs.
    pub gap_m: Option<f64>,
    /// True if a follower goes faster than `mps` where the vehicle ahead does.
    pub keeps_up: bool,
}

impl Wish {
    /// A usual one for a class: 10 m/s on a road, 1.5 on foot, from the second second on.
    pub fn usual(template: Template, class: Option<Class>) -> Self {
        Self {
            template,
            mps: Template::usual_mps(class),
            at_s: 2.0,
            over_s: 3.0,
            gap_m: None,
            keeps_up: true,
        }
    }
}

/// Edits that let an object, or (`None`) the ego vehicle, move as wished from where it is at the moment that is shown.
/// Errors in one line.
pub fn motion_of(scene: &Scene, id: Option<BoxId>, wish: &Wish) -> Result<Vec<Edit>, String> {
    let sound = wish.mps.is_finite() && wish.at_s.is_finite() && wish.over_s.is_finite();
    if !sound || !(0.0..=Path::MAX_MPS).contains(&wish.mps) || wish.over_s <= 0.0 {
        return Err(format!(
            "{} m/s at {} s over {} s, expected finite numbers and at most {} m/s",
            wish.mps,
            wish.at_s,
            wish.over_s,
            Path::MAX_MPS
        ));
    }
    let clip = scene.clip();
    let length_s = if clip.length_s > 0.0 {
        clip.length_s
    } else {
        USUAL_LENGTH_S
    };
    let (from, body) = place(scene, id).ok_or_else(|| match id {
        Some(id) => format!("box {} does not exist in this frame", id.0),
        None => "there is no ego vehicle".to_owned(),
    })?;
    if let Some(gap_m) = wish.gap_m.filter(|m| !(0.0..=1000.0).contains(m)) {
        return Err(format!("gap_m is {gap_m}, expected 0 to 1000 m"));
    }
    // How far it is turned against us; 0.5 is 60 degrees.
    let along = DVec2::from_angle(from.yaw_rad).dot(DVec2::from_angle(ego(scene).yaw_rad));
    if wish.template == Template::CutIn && along < 0.5 {
        return Err("only an object that goes our way can cut in; this one does not".to_owned());
    }
    let path = path_of(scene, id, &from, &body, wish, length_s)?;
    let mut edits = Vec::new();
    if clip.length_s == 0.0 {
        edits.push(Edit::SetLength {
            length_s,
            rate_hz: None,
        });
    }
    edits.push(Edit::SetMotion {
        id,
        motion: Some(Motion::Path(path)),
        from_s: None,
        to_s: None,
    });
    Ok(edits)
}

/// The current place and the body of a box, or of the ego vehicle.
fn place(scene: &Scene, id: Option<BoxId>) -> Option<(Moving, VehicleBody)> {
    match id {
        Some(id) => {
            let b = scene.frame().boxes.get(&id)?;
            Some((Moving::from(b), body_of(b)))
        }
        None => Some((ego(scene), body_of_ego(scene))),
    }
}

/// The body of a box, which is led by its middle.
pub(crate) fn body_of(b: &SceneBox) -> VehicleBody {
    VehicleBody {
        front_m: b.size_m.x / 2.0,
        half_width_m: b.size_m.y / 2.0,
    }
}

/// The body of the ego vehicle, which is led by its rear axle.
pub(crate) fn body_of_ego(scene: &Scene) -> VehicleBody {
    VehicleBody {
        front_m: scene.rig.ego_center_m[0] + scene.rig.ego_size_m[0] / 2.0,
        half_width_m: scene.rig.ego_size_m[1] / 2.0,
    }
}

/// Speed of the vehicle ahead on an object's lane at the moment that is shown, m/s; `None` if none is ahead.
pub(crate) fn leader_mps(scene: &Scene, id: Option<BoxId>) -> Option<f64> {
    let (from, body) = place(scene, id)?;
    let points_m = lane_path(&scene.frame().layout, &from, LEADER_WITHIN_M);
    let (leader, _, way) = ahead_of(&points_m, 0.0, &body, &others(scene, id, scene.time_s()))?;
    Some(leader.body.velocity_mps.dot(way))
}

/// Speeds of a follower along a path. Errors in one line if the vehicle ahead gets away.
fn following(
    scene: &Scene,
    id: Option<BoxId>,
    points_m: &[DVec2],
    (body, wish, length_s): (&VehicleBody, &Wish, f64),
) -> Result<Vec<Speed>, String> {
    let class = id.and_then(|id| scene.frame().boxes.get(&id)).map(|b| b.class);
    let who = id.map_or("the ego vehicle".to_owned(), |id| format!("box {}", id.0));
    let others = |time_s: f64| others(scene, id, time_s);
    let (top_mps, acceleration) = can(class);
    let mut driver = Driver {
        keeps_m: wish.gap_m,
        ..Driver::at(wish.mps.max(0.1))
    };
    let leader = ahead_of(points_m, 0.0, body, &others(0.0)).map(|(other, ..)| other.id);
    let mut fastest_mps = 0.0;
    if let (true, Some(leader)) = (wish.keeps_up, leader) {
        let speed = |t: f64| {
            let all = others(t);
            let found = all.iter().find(|o| o.id == leader);
            found.map_or(0.0, |o| o.body.velocity_mps.length())
        };
        let steps = (length_s / 0.5).ceil().clamp(1.0, 1200.0) as usize;
        fastest_mps = (0..=steps).map(|i| speed(i as f64 * 0.5)).fold(0.0, f64::max);
        // (faster than them, or a gap that opened would never close)
        driver.catching_up_mps = (fastest_mps * 1.3 + 1.0).min(top_mps);
        driver.acceleration = acceleration;
    }
    if wish.gap_m.is_some() && leader.is_none() {
        return Err(format!(
            "{who} keeps no distance: nobody is ahead of it on its way"
        ));
    }
    let found = follow(&driver, points_m, (0.0, wish.mps), body, length_s, others);
    if let (true, Some([first_m, last_m])) = (wish.keeps_up, found.gap_m) {
        let most_m = wish.gap_m.map_or(first_m, |gap_m| first_m.max(gap_m));
        let (needs_m, most_mps) = (
            driver.headway_s * fastest_mps * 1.5 + driver.gap_m,
            driver.catching_up_mps,
        );
        if last_m > most_m.max(needs_m) + 1.0 && fastest_mps > 0.9 * most_mps {
            return Err(format!(
                "{who} cannot follow: whoever is ahead goes up to {:.0} km/h, it at most {:.0} km/h: {first_m:.0} m would become {last_m:.0} m",
                fastest_mps * 3.6,
                most_mps * 3.6
            ));
        }
    }
    Ok(found.speeds)
}

/// An object, or (`None`) the ego vehicle, as it is at the moment that is shown; `None` if it is not there.
pub fn shown(scene: &Scene, id: Option<BoxId>) -> Option<Moving> {
    match id {
        Some(id) => scene.frame().boxes.get(&id).map(Moving::from),
        None => scene
            .clip()
            .ego_moving(scene.time_s())
            .or_else(|| Some(ego(scene))),
    }
}

/// The ego vehicle at the moment that is shown.
fn ego(scene: &Scene) -> Moving {
    let pose = scene.frame().world_from_ego;
    let ahead = (pose.rotation * glam::DVec3::X).truncate();
    Moving::still(pose.translation_m.truncate(), ahead.to_angle())
}

fn path_of(
    scene: &Scene,
    id: Option<BoxId>,
    from: &Moving,
    body: &VehicleBody,
    wish: &Wish,
    length_s: f64,
) -> Result<Path, String> {
    let layout = &scene.frame().layout;
    let reach_m = wish.mps * length_s + 10.0;
    let (mps, at_s) = (wish.mps, wish.at_s.max(0.0));
    let path = |points_m: Vec<DVec2>, speeds: Vec<Speed>| Path {
        points_m,
        start_m: 0.0,
        speeds,
        rear_first: false,
    };
    let steady = vec![speed(0.0, mps)];
    let lane = || lane_path(layout, from, reach_m);
    Ok(match wish.template {
        Template::Drive => path(lane(), steady),
        Template::Follow => {
            // (as far as it comes if it has to keep up)
            let class = id.and_then(|id| scene.frame().boxes.get(&id)).map(|b| b.class);
            let far_m = (can(class).0 * length_s).min(LEADER_WITHIN_M) + wish.mps * length_s;
            let points_m = lane_path(layout, from, reach_m.max(far_m));
            let speeds = following(scene, id, &points_m, (body, wish, length_s))?;
            path(points_m, speeds)
        }
        Template::Stop => path(
            lane(),
            easing(&[(0.0, mps), (at_s, mps), (at_s + mps / EASY, 0.0)]),
        ),
        Template::CutIn => {
            let points_m = lane();
            let shift_m = into_our_lane(scene, id, from);
            let (start_m, end_m) = (mps * at_s, mps * (at_s + wish.over_s));
            let left = |along_m: f64| shift_m * smooth((along_m - start_m) / (end_m - start_m).max(1.0));
            path(aside(&points_m, left), steady)
        }
        Template::Cross => path(
            across(scene, from),
            easing(&[(at_s, 0.0), (at_s + mps / STRIDE, mps)]),
        ),
        Template::PullOut => {
            let starts = [(0.0, 0.0), (at_s, 0.0), (at_s + mps / EASY, mps)];
            path(lane(), easing(&starts))
        }
        Template::Park => {
            let stop_s = at_s + (2.0 * mps / EASY).max(wish.over_s);
            let braked_m = mps * (stop_s - at_s) / 2.0;
            let points_m = lane();
            let start_m = mps * at_s;
            let aside_m = -to_the_side_m(scene, &points_m, start_m + braked_m);
            let left = |along_m: f64| aside_m * smooth((along_m - start_m) / braked_m.max(1.0));
            let speeds = easing(&[(0.0, mps), (at_s, mps), (stop_s, 0.0)]);
            path(aside(&points_m, left), speeds)
        }
        Template::TurnLeft | Template::TurnRight => {
            let left = wish.template == Template::TurnLeft;
            let own_m = lane_path(layout, from, TURN_WITHIN_M);
            let turning = turning(layout, &own_m, left, reach_m).ok_or_else(|| {
                let side = if left { "left" } else { "right" };
                format!("no street leads off to the {side} within {TURN_WITHIN_M} m of its way")
            })?;
            let speeds = around_the_corner(&turning, mps);
            path(turning.points_m, speeds)
        }
    })
}

/// Speeds that slow down before a corner and pick up behind it.
fn around_the_corner(turning: &Turning, mps: f64) -> Vec<Speed> {
    let [begin_m, end_m] = turning.corner_m;
    let slow = turning.mps.min(mps).max(0.1);
    // A vehicle that is too near to brake in comfort is slower from the start.
    let first = mps.min((slow * slow + 2.0 * EASY * begin_m).sqrt());
    let braked_m = (first * first - slow * slow) / (2.0 * EASY);
    let brake_s = (begin_m - braked_m) / first.max(0.1);
    let corner_s = brake_s + (first - slow) / EASY;
    let out_s = corner_s + (end_m - begin_m) / slow;
    easing(&[
        (0.0, first),
        (brake_s, first),
        (corner_s, slow),
        (out_s, slow),
        (out_s + (mps - slow) / EASY, mps),
    ])
}

fn speed(time_s: f64, mps: f64) -> Speed {
    Speed { time_s, mps }
}

/// Speeds at times, those of the same time left out but for the last.
fn easing(list: &[(f64, f64)]) -> Vec<Speed> {
    let mut out: Vec<Speed> = Vec::with_capacity(list.len());
    for &(time_s, mps) in list {
        out.retain(|s| s.time_s < time_s);
        out.push(speed(time_s, mps));
    }
    out
}

/// The other road users at a time.
pub(crate) fn others(scene: &Scene, own: Option<BoxId>, time_s: f64) -> Vec<Other> {
    let mut all = everybody_at(scene, time_s);
    all.retain(|o| o.id != own);
    all
}

/// All road users at a time, the ego vehicle too.
pub(crate) fn everybody_at(scene: &Scene, time_s: f64) -> Vec<Other> {
    let of = |b: &SceneBox| Other {
        id: Some(b.id),
        body: *b,
    };
    let canvas = scene.canvas();
    let standing = canvas.boxes.values().map(|b| {
        of(&SceneBox {
            velocity_mps: DVec2::ZERO,
            ..*b
        })
    });
    let mut out: Vec<Other> = standing.collect();
    out.extend(scene.clip().boxes_at(time_s, canvas).iter().map(of));
    out.push(Other {
        id: None,
        body: ego_box(scene, time_s),
    });
    out
}

/// How far to its left something must go to come into the lane of the ego vehicle, m; the next lane towards the middle of
/// the road where that is no change of lanes.
fn into_our_lane(scene: &Scene, id: Option<BoxId>, from: &Moving) -> f64 {
    let layout = &scene.frame().layout;
    let ours = lane_through(layout, &ego(scene), 150.0, 300.0);
    let found = id.and_then(|_| scene::road_map::project(&ours, from.at_m));
    let aside_m = found.map(|p| {
        let same_way = p.direction.dot(DVec2::from_angle(from.yaw_rad)) >= 0.0;
        if same_way { -p.offset_m } else { p.offset_m }
    });
    let is_a_change = |m: &f64| (1.5..=9.0).contains(&m.abs());
    aside_m.filter(is_a_change).unwrap_or_else(|| {
        // The side on which there is a lane of the same direction.
        let left = DVec2::from_angle(from.yaw_rad).perp() * LANE_M;
        let same_way = |p: DVec2| {
            nearest_lane(layout, p, 1.5)
                .is_some_and(|l| DVec2::from_angle(l.yaw_rad).dot(DVec2::from_angle(from.yaw_rad)) > 0.5)
        };
        if same_way(from.at_m - left) && !same_way(from.at_m + left) {
            -LANE_M
        } else {
            LANE_M
        }
    })
}

/// How far the side of the road is to the right of a path where something parks, m: just inside the kerb.
fn to_the_side_m(scene: &Scene, points_m: &[DVec2], along_m: f64) -> f64 {
    let at_m = scene::road_map::at_along(points_m, along_m);
    let ahead_m = scene::road_map::at_along(points_m, along_m + 1.0);
    let right = -(ahead_m - at_m).normalize_or_zero().perp();
    let layout = &scene.frame().layout;
    let on_road = |m: &f64| kerb::is_roadway(layout, at_m + right * *m);
    let edge = (0..40).map(|i| f64::from(i) * 0.2).take_while(on_road).last();
    edge.map_or(LANE_M * 0.7, |m| (m - 1.1).max(0.0))
}

/// Straight across the road from a place, to just beyond its other side.
fn across(scene: &Scene, from: &Moving) -> Vec<DVec2> {
    let layout = &scene.frame().layout;
    let way = DVec2::from_angle(kerb::toward_road(layout, from.at_m));
    let on_road = |m: f64| kerb::is_roadway(layout, from.at_m + way * m);
    let steps = (0..(WIDEST_M / 0.5) as usize).map(|i| i as f64 * 0.5);
    let mut entered = false;
    let mut end_m = LANE_M * 3.0;
    for m in steps {
        match (on_road(m), entered) {
            (true, _) => entered = true,
            (false, true) => {
                end_m = m + 1.5;
                break;
            }
            (false, false) => {}
        }
    }
    vec![from.at_m, from.at_m + way * end_m]
}

/// The time at which the ego vehicle and an object come as near as asked, s: the free distance between the two, bumper
/// to bumper where one is behind the other. `None` if they never do.
pub fn time_near(clip: &Clip, canvas: &scene::Frame, rig: &SensorRig, id: BoxId, gap_m: f64) -> Option<f64> {
    let relief = &canvas.layout.relief;
    let gap_at = |time_s: f64| {
        let standing = canvas.boxes.get(&id).copied();
        let b = clip.box_at(id, time_s, relief).or(standing)?;
        Some(relations::gap_m(&ego_box_of(clip, canvas, rig, time_s), &b))
    };
    let times = (0..=(clip.length_s / 0.05) as usize).map(|i| i as f64 * 0.05);
    times
        .into_iter()
        .find(|t| gap_at(*t).is_some_and(|gap| gap <= gap_m))
}

#[cfg(test)]
#[path = "template_tests.rs"]
mod tests;
