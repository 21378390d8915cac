//! The table of templates: what a motion is called, what it asks for, and how it is made.

use glam::DVec2;

use scene::clip::{Path, Speed, Template};
use scene::{BoxId, Class, Clip, Edit, Motion, Moving, Scene, SceneBox};

use super::follow::{self, Driver, Other};
use super::lane_path::{aside, lane_path, lane_through, smooth};
use super::turning::{Turning, turning};
use crate::kerb;
use crate::lanes::nearest_lane;

/// Length of a clip that gets its first motion, s.
const USUAL_LENGTH_S: f64 = 8.0;
/// Braking and starting that nobody minds, m/s².
const EASY: f64 = 2.0;
/// How fast somebody on foot starts, m/s².
const STRIDE: f64 = 3.0;
/// Width of a lane where none is known, m.
const LANE_M: f64 = 3.5;
/// Farthest that a street to turn into is looked for, m.
const TURN_WITHIN_M: f64 = 150.0;
/// Farthest that somebody walks across a road, m.
const WIDEST_M: f64 = 60.0;

/// What is asked of a template.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Which one.
    pub template: Template,
    /// Speed, m/s.
    pub mps: f64,
    /// When what the template is about begins, s.
    pub at_s: f64,
    /// How long a change of lanes takes, s.
    pub over_s: f64,
}

impl Wish {
    /// A usual one for a class: 10 m/s on a road, 1.5 on foot, from the second second on.
    pub fn usual(template: Template, class: Option<Class>) -> Self {
        Self {
            template,
            mps: Template::usual_mps(class),
            at_s: 2.0,
            over_s: 3.0,
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
    let (from, half_length_m) = place(scene, id).ok_or_else(|| match id {
        Some(id) => format!("box {} does not exist in this frame", id.0),
        None => "there is no ego vehicle".to_owned(),
    })?;
    // How far it is turned against us; 0.5 is 60 degrees.
    let along = DVec2::from_angle(from.yaw_rad).dot(DVec2::from_angle(ego(scene).yaw_rad));
    if wish.template == Template::CutIn && along < 0.5 {
        return Err("only an object that goes our way can cut in; this one does not".to_owned());
    }
    let path = path_of(scene, id, &from, half_length_m, wish, length_s)?;
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

/// Where it is now, and half of its length, m.
fn place(scene: &Scene, id: Option<BoxId>) -> Option<(Moving, f64)> {
    match id {
        Some(id) => {
            let b = scene.frame().boxes.get(&id)?;
            Some((Moving::from(b), b.size_m.x / 2.0))
        }
        None => Some((ego(scene), scene.rig.ego_size_m[0] / 2.0)),
    }
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
    half_length_m: f64,
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
            let points_m = lane();
            let driver = Driver::at(mps.max(0.1));
            let others = |time_s: f64| others(scene, id, time_s);
            let start = (0.0, mps);
            let speeds = follow::speeds(&driver, &points_m, start, half_length_m, length_s, others);
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
    // Who is too near to brake in comfort is slower from the start.
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

/// Who else is on the road at a time.
pub(crate) fn others(scene: &Scene, own: Option<BoxId>, time_s: f64) -> Vec<Other> {
    let of = |b: &SceneBox| Other {
        at_m: b.center_m.truncate(),
        velocity_mps: b.velocity_mps,
        half_length_m: b.size_m.x / 2.0,
    };
    let canvas = scene.canvas();
    let standing = canvas
        .boxes
        .values()
        .filter(|b| Some(b.id) != own)
        .map(|b| Other {
            velocity_mps: DVec2::ZERO,
            ..of(b)
        });
    let moving = scene.clip().boxes_at(time_s, canvas);
    let mut out: Vec<Other> = standing.collect();
    out.extend(moving.iter().filter(|b| Some(b.id) != own).map(of));
    if own.is_some() {
        let ego = scene.clip().ego_moving(time_s).unwrap_or_else(|| ego(scene));
        out.push(Other {
            at_m: ego.at_m,
            velocity_mps: ego.velocity_mps,
            half_length_m: scene.rig.ego_size_m[0] / 2.0,
        });
    }
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

/// When the ego vehicle and an object come as near as asked, s: along the line between them, from the front of the one to the
/// rear of the other or the other way round. `None` if they never do.
pub fn time_near(
    clip: &Clip,
    canvas: &scene::Frame,
    id: BoxId,
    gap_m: f64,
    own_length_m: f64,
) -> Option<f64> {
    let relief = &canvas.layout.relief;
    let gap_at = |time_s: f64| {
        let standing = canvas.boxes.get(&id).copied();
        let b = clip.box_at(id, time_s, relief).or(standing)?;
        let ego = clip.ego_at(time_s, &canvas.world_from_ego, relief);
        let between = b.center_m.truncate().distance(ego.translation_m.truncate());
        Some(between - b.size_m.x / 2.0 - own_length_m / 2.0)
    };
    let times = (0..=(clip.length_s / 0.05) as usize).map(|i| i as f64 * 0.05);
    times
        .into_iter()
        .find(|t| gap_at(*t).is_some_and(|gap| gap <= gap_m))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;
    use scene::{BevLayer, BevLayout, Extent, Frame, Polyline, PolylineKind, SensorRig, VoxelGrid};

    use super::*;
    use crate::Apply;

    /// A road of two lanes along x: ours at y = 0, the one to the left at 3.6; a sidewalk beyond y = -4.
    fn scene() -> Scene {
        let extent = Extent::new([-100, -100], [600, 200]).expect("sound");
        let mut layout = BevLayout::over(extent);
        for [x, y] in extent.all_columns() {
            let p = extent.center(x, y, 0);
            layout.set(BevLayer::DrivableArea, x, y, (-4.0..6.0).contains(&p.y));
        }
        let lane = |y: f64| Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![DVec2::new(-40.0, y), DVec2::new(200.0, y)],
        };
        layout.polylines = Arc::new(vec![lane(0.0), lane(3.6)]);
        let object = |id: u32, class, x: f64, y: f64, size: [f64; 3]| SceneBox {
            id: BoxId(id),
            class,
            center_m: DVec3::new(x, y, size[2] / 2.0),
            size_m: size.into(),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let boxes = [
            object(1, Class::Car, -10.0, 3.6, [4.5, 1.9, 1.6]),
            object(2, Class::Car, 40.0, 0.0, [4.5, 1.9, 1.6]),
            object(3, Class::Pedestrian, 25.0, -6.0, [0.6, 0.6, 1.75]),
            object(4, Class::Bus, 20.0, -2.6, [11.0, 2.6, 3.2]),
        ];
        let frame = Frame::new(layout, boxes.map(|b| (b.id, b)).into(), VoxelGrid::over(extent));
        Scene::single("road", frame, Arc::new(SensorRig::default()), 1)
    }

    fn with(scene: &Scene, id: Option<u32>, template: Template, mps: f64) -> Scene {
        let mut scene = scene.clone();
        let wish = Wish {
            mps,
            ..Wish::usual(template, None)
        };
        for edit in motion_of(&scene, id.map(BoxId), &wish).expect("a motion") {
            edit.apply(&mut scene).expect("sound");
        }
        scene
    }

    fn at(scene: &Scene, id: u32, time_s: f64) -> SceneBox {
        scene.at(time_s).frame().boxes[&BoxId(id)]
    }

    #[test]
    fn every_template_does_what_its_name_says() {
        let start = scene();
        let drives = with(&start, Some(1), Template::Drive, 10.0);
        assert_eq!(drives.clip().length_s, USUAL_LENGTH_S);
        assert!((at(&drives, 1, 4.0).center_m.truncate() - DVec2::new(30.0, 3.6)).length() < 1e-6);
        let stops = with(&start, Some(1), Template::Stop, 10.0);
        // 2 s at 10 m/s, then 5 s of braking: 20 + 25 m.
        assert!((at(&stops, 1, 8.0).center_m.x - 35.0).abs() < 1e-6);
        assert_eq!(at(&stops, 1, 7.9).velocity_mps, DVec2::ZERO);
        let cuts = with(&start, Some(1), Template::CutIn, 12.0);
        assert!(
            (at(&cuts, 1, 2.0).center_m.y - 3.6).abs() < 1e-6 && at(&cuts, 1, 5.2).center_m.y.abs() < 1e-6
        );
        assert!(at(&cuts, 1, 3.5).yaw_rad < -0.05, "it steers to the right");
        let mut oncoming = start.clone();
        oncoming.change_canvas(|f| {
            f.boxes.get_mut(&BoxId(1)).expect("there").yaw_rad = std::f64::consts::PI;
        });
        let wish = Wish::usual(Template::CutIn, Some(Class::Car));
        let refused = motion_of(&oncoming, Some(BoxId(1)), &wish).expect_err("it comes towards us");
        assert!(refused.contains("goes our way"), "{refused}");
        let crosses = with(&start, Some(3), Template::Cross, 1.5);
        assert!((at(&crosses, 3, 2.0).center_m.y + 6.0).abs() < 1e-6);
        assert!((at(&crosses, 3, 4.0).center_m.y + 3.375).abs() < 1e-6);
        assert!((at(&crosses, 3, 4.0).yaw_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
        let pulls = with(&start, Some(4), Template::PullOut, 8.0);
        assert!((at(&pulls, 4, 2.0).center_m.truncate() - DVec2::new(20.0, -2.6)).length() < 1e-6);
        assert!(at(&pulls, 4, 8.0).center_m.y.abs() < 0.4 && at(&pulls, 4, 8.0).center_m.x > 40.0);
        let parks = with(&start, Some(2), Template::Park, 5.0);
        let parked = at(&parks, 2, 8.0);
        assert!(
            (-3.5..=-2.0).contains(&parked.center_m.y) && parked.velocity_mps == DVec2::ZERO,
            "{parked:?}"
        );
        let ego = with(&start, None, Template::Follow, 14.0);
        let x = |t: f64| ego.at(t).frame().world_from_ego.translation_m.x;
        // Car 2 stands 40 m ahead: the vehicle comes to a stop behind it.
        assert!(x(8.0) > 20.0 && x(8.0) < 40.0 - 2.25 - 2.04, "{}", x(8.0));
    }

    #[test]
    fn a_follower_keeps_behind_one_who_stops() {
        let stops = with(&scene(), Some(2), Template::Stop, 8.0);
        let both = with(&stops, None, Template::Follow, 14.0);
        for i in 0..=80 {
            let view = both.at(f64::from(i) * 0.1);
            let gap = view.frame().boxes[&BoxId(2)].center_m.x - view.frame().world_from_ego.translation_m.x;
            assert!(gap > 4.5, "{gap} m at {} s", view.time_s());
        }
    }

    #[test]
    fn the_time_of_an_approach_is_found() {
        let drives = with(&scene(), None, Template::Drive, 10.0);
        // Half a bus and half of ourselves are 7.54 m: the middle of the bus is 17.54 m ahead at .25 s.
        let found = time_near(drives.clip(), drives.canvas(), BoxId(4), 10.0, 4.084);
        assert!((found.expect("they meet") - 0.25).abs() < 0.2, "{found:?}");
        assert_eq!(
            time_near(drives.clip(), drives.canvas(), BoxId(99), 10.0, 4.0),
            None
        );
    }

    #[test]
    fn what_cannot_be_is_told_in_one_line() {
        let scene = scene();
        let wish = Wish::usual(Template::Drive, None);
        assert_eq!(
            motion_of(&scene, Some(BoxId(77)), &wish),
            Err("box 77 does not exist in this frame".to_owned())
        );
        for bad in [f64::NAN, -1.0, 1e9] {
            let wish = Wish { mps: bad, ..wish };
            let error = motion_of(&scene, None, &wish).expect_err("no speed");
            assert!(
                error.contains("at most 100 m/s") && !error.contains('\n'),
                "{error}"
            );
        }
    }
}
