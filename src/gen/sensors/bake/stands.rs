//! Places where the ego vehicle could stand, and the cameras there: the views of a bake.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use glam::{DQuat, DVec2, DVec3};

use scene::{BevLayer, BevLayout, Camera, Frame, Pose, SensorRig};

/// Room that the vehicle keeps from boxes, m.
const CLEAR_M: f64 = 0.4;
/// Headings that are tried at a place.
const HEADINGS: usize = 12;
/// Heights of the cameras that look down on the scene from above, m over the ground.
const ABOVE_M: [f64; 2] = [4.0, 7.5];

/// Places where the vehicle could stand: on the drivable area, reached from `path` within `reach_m`, spread evenly. The
/// poses of the path come first, then each place as far as possible from all before. There are at most `most`; on a map
/// without roads only the path. Poses are in the frame of the scene; headings differ, so that the cameras there look
/// everywhere. `rig` gives the size of the vehicle.
pub fn stands(frame: &Frame, rig: &SensorRig, path: &[Pose], reach_m: f64, most: usize) -> Vec<Pose> {
    let mut chosen: Vec<Pose> = Vec::new();
    let free = reachable(frame, path, reach_m);
    let mut away = vec![f64::INFINITY; free.len()];
    // A long path gives every n-th pose, at most half of the places.
    let step = path.len().div_ceil(most.div_ceil(2).max(1)).max(1);
    for (i, pose) in path.iter().step_by(step).enumerate() {
        // Another vehicle may stand now where this one is at another moment.
        if i > 0 && !is_free(frame, rig, pose) {
            continue;
        }
        shorten(&mut away, &free, pose);
        chosen.push(*pose);
    }
    let base = path.first().copied().unwrap_or(Pose::IDENTITY);
    while chosen.len() < most {
        let farthest = away.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let Some((i, _)) = farthest.filter(|(_, d)| **d >= 1.0) else {
            break;
        };
        // The golden angle spreads headings evenly.
        let first = 2.399_963_2 * chosen.len() as f64;
        let headings = (0..HEADINGS).map(|k| first + TAU * k as f64 / HEADINGS as f64);
        let poses = headings.map(|turn| standing(frame, &base, free[i], turn));
        match poses.into_iter().find(|pose| fits(frame, rig, pose)) {
            Some(pose) => {
                shorten(&mut away, &free, &pose);
                chosen.push(pose);
            }
            None => away[i] = 0.0,
        }
    }
    chosen
}

/// A vehicle on the ground at a place, its heading turned by `turn_rad` from that of `like`. On flat ground it is as
/// high as `like`.
pub fn standing(frame: &Frame, like: &Pose, at_m: DVec2, turn_rad: f64) -> Pose {
    let relief = &frame.layout.relief;
    if relief.is_flat() {
        return Pose {
            rotation: DQuat::from_rotation_z(turn_rad) * like.rotation,
            translation_m: at_m.extend(like.translation_m.z),
        };
    }
    let ahead = like.rotation * DVec3::X;
    relief.pose_on(at_m, ahead.y.atan2(ahead.x) + turn_rad)
}

/// Distances of places to the nearest pose, with one pose more.
fn shorten(away: &mut [f64], places: &[DVec2], pose: &Pose) {
    for (d, p) in away.iter_mut().zip(places) {
        *d = d.min(p.distance(pose.translation_m.truncate()));
    }
}

/// True if the vehicle can stand there: all of it on the drivable area, and no box in the way.
pub fn fits(frame: &Frame, rig: &SensorRig, pose: &Pose) -> bool {
    let extent = frame.layout.extent();
    let is_on_road = |p: DVec2| {
        let column = extent.column_at(p.x, p.y);
        column.is_some_and(|[x, y]| is_road(&frame.layout, x, y))
    };
    body(rig, pose).all(is_on_road) && is_free(frame, rig, pose)
}

/// True if no box is in the way of a vehicle there.
pub fn is_free(frame: &Frame, rig: &SensorRig, pose: &Pose) -> bool {
    body(rig, pose).all(|p| is_clear(frame, p))
}

/// Points all over the vehicle's floor plan.
fn body(rig: &SensorRig, pose: &Pose) -> impl Iterator<Item = DVec2> {
    let (size, middle, pose) = (DVec3::from(rig.ego_size_m), DVec3::from(rig.ego_center_m), *pose);
    let parts = |n: i32| (-n..=n).map(move |i| f64::from(i) / f64::from(2 * n));
    let places = parts(4).flat_map(move |x| parts(2).map(move |y| DVec3::new(x, y, 0.0)));
    places.map(move |p| pose.apply(middle + p * size).truncate())
}

/// Middles of the columns of the drivable area that a vehicle reaches from a path without meeting a box.
fn reachable(frame: &Frame, path: &[Pose], reach_m: f64) -> Vec<DVec2> {
    let layout = &frame.layout;
    let extent = layout.extent();
    let center = |x: usize, y: usize| extent.center(x, y, 0).truncate();
    let near = |p: DVec2| {
        path.iter()
            .any(|s| s.translation_m.truncate().distance(p) <= reach_m)
    };
    let is_free = |x: usize, y: usize| {
        let p = center(x, y);
        let road = is_road(layout, x, y);
        road && near(p) && is_clear(frame, p)
    };
    let mut seen = vec![false; extent.columns()];
    let mut queue = VecDeque::new();
    for pose in path {
        if let Some([x, y]) = extent.column_at(pose.translation_m.x, pose.translation_m.y) {
            queue.push_back([x, y]);
            seen[extent.index(x, y)] = true;
        }
    }
    let mut found = Vec::new();
    while let Some([x, y]) = queue.pop_front() {
        if is_free(x, y) {
            found.push(center(x, y));
        } else if found.len() > path.len() * 40 {
            // Only near the start may the way lead over ground that is not road.
            continue;
        }
        let around = [
            [x.wrapping_sub(1), y],
            [x + 1, y],
            [x, y.wrapping_sub(1)],
            [x, y + 1],
        ];
        for [x, y] in around {
            if extent.holds(x, y) && !seen[extent.index(x, y)] && near(center(x, y)) {
                seen[extent.index(x, y)] = true;
                queue.push_back([x, y]);
            }
        }
    }
    found
}

fn is_road(layout: &BevLayout, x: usize, y: usize) -> bool {
    layout.cell(x, y) & (BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit()) != 0
}

/// True if no box stands at a place or near it.
fn is_clear(frame: &Frame, p: DVec2) -> bool {
    !frame.boxes.values().any(|b| {
        let at = p.extend(b.center_m.z);
        b.contains(at, CLEAR_M)
    })
}

/// The rig's cameras on the vehicle at each of these poses, and above every third of them cameras that look down. `rig`
/// is placed at its `vehicle`.
pub fn views(rig: &SensorRig, stands: &[Pose]) -> Vec<Camera> {
    let mut out = Vec::new();
    for (i, pose) in stands.iter().enumerate() {
        out.extend(rig.standing_at(pose).cameras);
        if i % 3 == 0 {
            for k in 0..3 {
                let mut camera = Camera::new("above", 80.0);
                let turn = DQuat::from_rotation_z(f64::from(k) * 2.094_395_1 + i as f64);
                let down = DQuat::from_rotation_y(0.45);
                let body_from_optical = DQuat::from_xyzw(-0.5, 0.5, -0.5, 0.5);
                let q = pose.rotation * turn * down * body_from_optical;
                camera.rotation_wxyz = [q.w, q.x, q.y, q.z];
                let above = DVec3::Z * ABOVE_M[(i / 3) % ABOVE_M.len()];
                camera.translation_m = (pose.translation_m + above).to_array();
                out.push(camera);
            }
        }
    }
    for camera in &mut out {
        camera.shutter = None; // everything is seen at one instant
    }
    out
}
