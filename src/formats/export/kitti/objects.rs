//! Objects in the picture of the front camera: KITTI's `label_2`.
//!
//! A line is: type, truncated (share of the rectangle beyond the picture), occluded (0 seen, 1 partly, 2 largely hidden), alpha
//! (the angle it is seen at), rectangle (left, top, right, bottom in px, cut to the picture), height, width, length in m, the
//! middle of the underside in the level camera frame in m, rotation about that frame's y axis (object development kit,
//! `readme.txt`). Objects that are hidden or beside the picture are left out, and so are barriers and cones, which KITTI has
//! no name for.

use std::fmt::Write;

use glam::{DVec2, DVec3};
use scene::{Class, Frame, SceneBox, Window};

use super::camera::FrontCamera;

/// Farthest object, m.
const FARTHEST_M: f64 = 100.0;
/// Lowest rectangle, px.
const LEAST_PX: f64 = 4.0;
/// Places along each edge of a box at which it is tested whether something stands in front.
const PROBES: usize = 4;
/// Step along a line of sight, and how much of it before the object is its own, m.
const STEP_M: f64 = 0.2;
const OWN_M: f64 = 0.5;
/// Shares of hidden places from which an object is partly, largely, wholly hidden.
const PARTLY: f64 = 0.15;
const LARGELY: f64 = 0.5;
const WHOLLY: f64 = 0.95;

/// KITTI's name for a class of objects.
fn name(class: Class) -> Option<&'static str> {
    Some(match class {
        Class::Car => "Car",
        Class::Truck => "Truck",
        Class::Pedestrian => "Pedestrian",
        Class::Bicycle => "Cyclist",
        Class::Bus | Class::Trailer | Class::ConstructionVehicle | Class::Motorcycle => "Misc",
        _ => return None,
    })
}

/// The lines of a frame in its ego frame, boxes in the order of their ids.
pub(super) fn to_text(frame: &Frame, camera: &FrontCamera) -> String {
    let mut out = String::new();
    for b in frame.boxes.values() {
        if let Some(line) = name(b.class).and_then(|name| line(name, b, frame, camera)) {
            out += &line;
        }
    }
    out
}

/// Corners of a box in the ego frame; the bits of their number are front, left, top.
fn corners_in_ego(b: &SceneBox) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let side = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
        b.to_ego(b.size_m * DVec3::new(side(0), side(1), side(2)))
    })
}

fn line(name: &str, b: &SceneBox, frame: &Frame, camera: &FrontCamera) -> Option<String> {
    let rect_from_ego = camera.ego_from_rect.inverse();
    let underside = rect_from_ego.apply(b.center_m - DVec3::Z * (b.size_m.z / 2.0));
    if underside.z <= 0.0 || underside.length() > FARTHEST_M {
        return None;
    }
    let [low, high] = camera.rectangle(&corners_in_ego(b).map(|c| rect_from_ego.apply(c)))?;
    let last = camera.size - DVec2::ONE;
    let (left_top, right_bottom) = (low.clamp(DVec2::ZERO, last), high.clamp(DVec2::ZERO, last));
    let area = |size: DVec2| size.x * size.y;
    let seen = right_bottom - left_top;
    if seen.x < 1.0 || seen.y < LEAST_PX {
        return None;
    }
    let truncated = (1.0 - area(seen) / area(high - low)).clamp(0.0, 1.0);
    let occluded = match hidden(b, frame, camera) {
        share if share >= WHOLLY => return None,
        share if share >= LARGELY => 2,
        share if share >= PARTLY => 1,
        _ => 0,
    };
    let heading = rect_from_ego.rotation * b.heading().extend(0.0);
    let rotation_y = f64::atan2(-heading.z, heading.x);
    let alpha = wrapped(rotation_y - f64::atan2(underside.x, underside.z));
    let mut out = String::new();
    let written = writeln!(
        out,
        "{name} {truncated:.2} {occluded} {alpha:.4} {:.2} {:.2} {:.2} {:.2} {:.4} {:.4} {:.4} {:.4} {:.4} {:.4} {rotation_y:.4}",
        left_top.x,
        left_top.y,
        right_bottom.x,
        right_bottom.y,
        b.size_m.z,
        b.size_m.y,
        b.size_m.x,
        underside.x,
        underside.y,
        underside.z,
    );
    written.ok().map(|()| out)
}

/// An angle between -pi and pi, rad.
fn wrapped(angle_rad: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    (angle_rad + turn / 2.0).rem_euclid(turn) - turn / 2.0
}

/// Share of the places of a box in the picture that are hidden by something in front; 1 if no place is in the picture.
fn hidden(b: &SceneBox, frame: &Frame, camera: &FrontCamera) -> f64 {
    let eye = camera.ego_from_rect.translation_m;
    let rect_from_ego = camera.ego_from_rect.inverse();
    let (mut all, mut blocked) = (0, 0);
    for i in 0..PROBES * PROBES * PROBES {
        let place = [i % PROBES, i / PROBES % PROBES, i / PROBES / PROBES];
        let share = place.map(|n| (n as f64 + 0.5) / PROBES as f64 - 0.5);
        let at = b.to_ego(b.size_m * DVec3::from_array(share));
        let Some(pixel) = camera.pixel(rect_from_ego.apply(at)) else {
            continue;
        };
        if pixel.min_element() < 0.0 || pixel.cmpge(camera.size).any() {
            continue;
        }
        all += 1;
        blocked += usize::from(is_blocked(eye, at, b, frame));
    }
    if all == 0 {
        1.0
    } else {
        f64::from(blocked as u32) / f64::from(all)
    }
}

/// True if a voxel that is no ground, not of the box and not at the eye lies on the way.
fn is_blocked(eye: DVec3, at: DVec3, b: &SceneBox, frame: &Frame) -> bool {
    let (way, extent) = (at - eye, frame.extent());
    let steps = (way.length() / STEP_M) as usize;
    (3..steps).any(|i| {
        let p = eye + way * (i as f64 / steps as f64);
        let Some([x, y, z]) = extent.voxel_at(p) else {
            return false;
        };
        let class = Class::from_id(frame.occupancy.get(x, y, z)).unwrap_or(Class::Free);
        class != Class::Free && !class.is_ground() && !b.contains(p, OWN_M.max(Window::VOXEL_M))
    })
}
