//! Several boxes at once: copied, pasted, mirrored, turned, set down. Each function makes the
//! edits of one undo step; boxes that are not in the frame are left out.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use scene::{Arrangement, BoxId, Frame, Motion, Moving, Scene, SceneBox};

use super::Edit;
use super::lanes::nearest_lane;

/// Farthest lane that a box follows, m.
pub const LANE_REACH_M: f64 = 6.0;

/// Edits that add boxes, and the names that these get.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Added {
    /// One for each box.
    pub edits: Vec<Edit>,
    /// Names of the boxes, in the same order.
    pub ids: Vec<BoxId>,
    /// Names of those that they are copies of, in the same order.
    pub of: Vec<BoxId>,
}

impl Added {
    /// Lets the copies move and be grouped as those that they are copies of.
    pub fn with(mut self, ties: &Ties) -> Self {
        for (id, of) in self.ids.iter().zip(&self.of) {
            let Some((motion, there_s, from)) = ties.motions.get(of) else {
                continue;
            };
            let to = self.edits.iter().find_map(|edit| placed(edit, *id));
            if let Some((at_m, yaw_rad)) = to {
                let to = Moving {
                    at_m,
                    yaw_rad,
                    ..*from
                };
                self.edits.push(Edit::SetMotion {
                    id: Some(*id),
                    motion: Some(motion.carried(from, &to)),
                    from_s: there_s[0],
                    to_s: there_s[1],
                });
            }
        }
        for group in &ties.groups {
            let copies = self.ids.iter().zip(&self.of).filter(|(_, of)| group.contains(of));
            let boxes: Vec<BoxId> = copies.map(|(id, _)| *id).collect();
            if boxes.len() > 1 {
                let how = Arrangement::Group {
                    name: Default::default(),
                };
                self.edits.push(Edit::Arrange {
                    boxes,
                    things: Vec::new(),
                    how,
                });
            }
        }
        self
    }
}

/// Place and heading, rad, of the new box of an edit; `None` if the edit adds another box or none.
fn placed(edit: &Edit, new: BoxId) -> Option<(DVec2, f64)> {
    match edit {
        Edit::AddBox {
            id: Some(id),
            center_m,
            yaw_deg,
            ..
        } if *id == new => Some((center_m.truncate(), yaw_deg.to_radians())),
        _ => None,
    }
}

/// Motions and groups of boxes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ties {
    /// How a box moves, when it is there, and where it is at the moment that is shown.
    motions: BTreeMap<BoxId, (Motion, [Option<f64>; 2], Moving)>,
    /// Boxes in a group with each other.
    groups: Vec<Vec<BoxId>>,
}

impl Ties {
    /// Reads the motions and groups of these boxes.
    pub fn from_selection(scene: &Scene, ids: &[BoxId]) -> Self {
        let motion = |id: &BoxId| {
            let track = scene.clip().tracks.get(id).filter(|t| !t.stands())?;
            let now = scene.clip().moving(*id, scene.time_s())?;
            Some((*id, (track.motion.clone(), track.there_s, now)))
        };
        let groups = scene.arranged.groups.iter().map(|g| {
            let chosen = ids.iter().filter(|id| g.members.boxes.contains(id));
            chosen.copied().collect()
        });
        Self {
            motions: ids.iter().filter_map(motion).collect(),
            groups: groups.collect(),
        }
    }
}

/// Copied boxes, to be put down elsewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clipboard {
    /// The boxes when they were copied.
    pub boxes: Vec<SceneBox>,
    /// Voxels of those that have their own, as [`Edit::SetShape`] takes them.
    pub shapes: BoxVoxels,
    /// Their motions and groups.
    pub ties: Ties,
}

/// Voxels of boxes that have their own.
pub type BoxVoxels = BTreeMap<BoxId, Vec<[i32; 3]>>;

impl Clipboard {
    /// The boxes of those names that are there.
    pub fn from_selection(scene: &Scene, ids: &[BoxId]) -> Self {
        Self {
            boxes: boxes_of(scene.frame(), ids),
            shapes: shapes_of(scene.frame(), ids),
            ties: Ties::from_selection(scene, ids),
        }
    }
}

pub(super) fn shapes_of(frame: &Frame, ids: &[BoxId]) -> BoxVoxels {
    let own = ids
        .iter()
        .filter_map(|id| Some((*id, frame.own_shapes.get(id)?.cells())));
    own.collect()
}

/// Point about which several boxes turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Pivot {
    /// Each about its own centre.
    #[default]
    Own,
    /// All about the middle between them.
    Middle,
}

/// The boxes of those names that are there, in the order of the names.
pub fn boxes_of(frame: &Frame, ids: &[BoxId]) -> Vec<SceneBox> {
    ids.iter().filter_map(|id| frame.boxes.get(id).copied()).collect()
}

/// Middle of the upright rectangle around the centres, ego frame, m; `None` without boxes.
pub fn middle_m(boxes: &[SceneBox]) -> Option<DVec3> {
    let centers = || boxes.iter().map(|b| b.center_m);
    let (low, high) = (centers().reduce(DVec3::min)?, centers().reduce(DVec3::max)?);
    Some((low + high) / 2.0)
}

/// Takes boxes out.
pub fn remove(frame: &Frame, ids: &[BoxId]) -> Vec<Edit> {
    let there = ids.iter().filter(|id| frame.boxes.contains_key(id));
    there.map(|id| Edit::RemoveBox { id: *id }).collect()
}

/// Shifts boxes in the ego frame, m.
pub fn shift(frame: &Frame, ids: &[BoxId], step_m: DVec3) -> Vec<Edit> {
    let moved = boxes_of(frame, ids).into_iter();
    moved.map(|b| place(&b, b.center_m + step_m, None)).collect()
}

/// Turns boxes counter-clockwise, degrees.
pub fn turn(frame: &Frame, ids: &[BoxId], degrees: f64, pivot: Pivot) -> Vec<Edit> {
    let boxes = boxes_of(frame, ids);
    turned(&boxes, degrees, pivot)
}

/// Like [`turn`], for boxes that are given by value.
pub fn turned(boxes: &[SceneBox], degrees: f64, pivot: Pivot) -> Vec<Edit> {
    let Some(middle_m) = middle_m(boxes) else {
        return Vec::new();
    };
    let by = DVec2::from_angle(degrees.to_radians());
    let turn = |b: &SceneBox| {
        let yaw_deg = Some(wrapped_deg(b.yaw_rad.to_degrees() + degrees));
        let center_m = (pivot == Pivot::Middle && boxes.len() > 1).then(|| {
            let arm = (b.center_m - middle_m).truncate();
            (middle_m.truncate() + by.rotate(arm)).extend(b.center_m.z)
        });
        Edit::MoveBox {
            id: b.id,
            center_m,
            yaw_deg,
            size_m: None,
        }
    };
    boxes.iter().map(turn).collect()
}

/// An angle within -180 to 180 degrees.
pub fn wrapped_deg(degrees: f64) -> f64 {
    let turned = degrees.rem_euclid(360.0);
    if turned > 180.0 { turned - 360.0 } else { turned }
}

/// Copies boxes beside themselves: all to the left of the first one's heading, clear of each other.
pub fn duplicate(frame: &Frame, ids: &[BoxId]) -> Added {
    let boxes = boxes_of(frame, ids);
    let shift_m = beside_m(&boxes);
    let copies = boxes.into_iter().map(|b| SceneBox {
        center_m: b.center_m + shift_m,
        ..b
    });
    add(frame, copies.collect(), &shapes_of(frame, ids))
}

/// A step to the left of the first box's heading that clears all of them, m.
fn beside_m(boxes: &[SceneBox]) -> DVec3 {
    let Some(first) = boxes.first() else {
        return DVec3::ZERO;
    };
    let left = first.heading().perp();
    let across = |p: DVec2| p.dot(left);
    let corners = || boxes.iter().flat_map(|b| b.footprint()).map(across);
    let extent_m = corners().fold(f64::NEG_INFINITY, f64::max) - corners().fold(f64::INFINITY, f64::min);
    (left * (extent_m + 0.6)).extend(0.0)
}

/// Puts the boxes of a clipboard down with the middle of them at a point of the ground, or beside where they were.
pub fn paste(frame: &Frame, clipboard: &Clipboard, at_m: Option<DVec2>) -> Added {
    let Some(middle_m) = middle_m(&clipboard.boxes) else {
        return Added::default();
    };
    let shift_m = match at_m.filter(|p| p.is_finite()) {
        Some(at_m) => (at_m - middle_m.truncate()).extend(0.0),
        None => beside_m(&clipboard.boxes),
    };
    let copies = clipboard.boxes.iter().map(|b| SceneBox {
        center_m: b.center_m + shift_m,
        ..*b
    });
    add(frame, copies.collect(), &clipboard.shapes).with(&clipboard.ties)
}

/// Mirrors boxes about the ego x axis. With `keep_direction` one that changes sides is turned by 180 degrees,
/// so that it drives with the traffic of its new side.
pub fn mirror(frame: &Frame, ids: &[BoxId], keep_direction: bool) -> Vec<Edit> {
    let boxes = boxes_of(frame, ids);
    let pairs = boxes.iter().map(|b| (b, mirrored(b, keep_direction)));
    pairs.flat_map(|(old, new)| replace(old, &new)).collect()
}

/// Adds mirrored copies instead.
pub fn mirror_copy(frame: &Frame, ids: &[BoxId], keep_direction: bool) -> Added {
    let boxes = boxes_of(frame, ids);
    let mut shapes = shapes_of(frame, ids);
    for [_, left, _] in shapes.values_mut().flatten() {
        *left = -1 - *left;
    }
    let copies = boxes.iter().map(|b| mirrored(b, keep_direction));
    add(frame, copies.collect(), &shapes)
}

fn mirrored(b: &SceneBox, keep_direction: bool) -> SceneBox {
    const ON_THE_AXIS_M: f64 = 0.05;
    let turns = keep_direction && b.center_m.y.abs() > ON_THE_AXIS_M;
    let (half_turn, sign) = if turns { (180.0, -1.0) } else { (0.0, 1.0) };
    SceneBox {
        center_m: DVec3::new(b.center_m.x, -b.center_m.y + 0.0, b.center_m.z),
        yaw_rad: wrapped_deg(half_turn - b.yaw_rad.to_degrees()).to_radians(),
        velocity_mps: DVec2::new(b.velocity_mps.x, -b.velocity_mps.y) * sign,
        ..*b
    }
}

/// Lets boxes stand on the ground.
pub fn drop_to_ground(frame: &Frame, ids: &[BoxId]) -> Vec<Edit> {
    let boxes = boxes_of(frame, ids).into_iter();
    boxes
        .map(|b| place(&b, standing(frame, &b, b.center_m.truncate()), None))
        .collect()
}

/// Puts boxes on the middle of their nearest lane, in its direction, on the ground. A box further than
/// [`LANE_REACH_M`] from any lane is only set down.
pub fn to_lane(frame: &Frame, ids: &[BoxId]) -> Vec<Edit> {
    let boxes = boxes_of(frame, ids).into_iter();
    let edit = |b: SceneBox| {
        let at_m = b.center_m.truncate();
        match nearest_lane(&frame.layout, at_m, LANE_REACH_M) {
            Some(lane) => {
                let yaw_deg = wrapped_deg(lane.yaw_rad.to_degrees());
                place(&b, standing(frame, &b, lane.at_m), Some(yaw_deg))
            }
            None => place(&b, standing(frame, &b, at_m), None),
        }
    };
    boxes.map(edit).collect()
}

/// Centre of a box that stands on the ground at a point, m.
pub fn standing(frame: &Frame, b: &SceneBox, at_m: DVec2) -> DVec3 {
    at_m.extend(frame.layout.relief.height_m(at_m) + b.size_m.z / 2.0)
}

fn place(b: &SceneBox, center_m: DVec3, yaw_deg: Option<f64>) -> Edit {
    Edit::MoveBox {
        id: b.id,
        center_m: Some(center_m),
        yaw_deg,
        size_m: None,
    }
}

/// The edits that make one box another of the same name, its velocity included.
fn replace(old: &SceneBox, new: &SceneBox) -> Vec<Edit> {
    if old.velocity_mps == new.velocity_mps {
        return vec![place(old, new.center_m, Some(new.yaw_rad.to_degrees()))];
    }
    vec![Edit::RemoveBox { id: old.id }, add_edit(new, Some(old.id))]
}

/// The edits that let a box go so fast (m/s): one that stands in the scene has that speed from then on, along its heading or the way
/// it moves; one on a path is at that speed now and as much faster or slower on all of it. `None` where keyframes or another object
/// say how fast it is, and where a path is at a stop.
pub fn with_speed(scene: &Scene, id: BoxId, mps: f64) -> Option<Vec<Edit>> {
    /// Slower is a stop, m/s.
    const STOP_MPS: f64 = 0.05;
    let Some(track) = scene.clip().tracks.get(&id) else {
        let b = scene.frame().boxes.get(&id)?;
        let way = b.velocity_mps.try_normalize().unwrap_or(b.heading());
        let new = SceneBox {
            velocity_mps: way * mps,
            ..*b
        };
        return Some(replace(b, &new));
    };
    let Motion::Path(path) = &track.motion else {
        return None;
    };
    let now_mps = path.along(scene.time_s()).1.abs();
    if now_mps < STOP_MPS {
        return None;
    }
    let mut path = path.clone();
    path.speeds.iter_mut().for_each(|s| s.mps *= mps / now_mps);
    let [from_s, to_s] = track.there_s;
    Some(vec![Edit::SetMotion {
        id: Some(id),
        motion: Some(Motion::Path(path)),
        from_s,
        to_s,
    }])
}

fn add_edit(b: &SceneBox, id: Option<BoxId>) -> Edit {
    Edit::AddBox {
        class: b.class,
        center_m: b.center_m,
        size_m: b.size_m,
        yaw_deg: b.yaw_rad.to_degrees(),
        velocity_mps: (b.velocity_mps != DVec2::ZERO).then_some(b.velocity_mps),
        id,
        label: b.label,
    }
}

/// The edit that adds a box like this one under the next name that is free.
pub fn adding(b: &SceneBox) -> Edit {
    add_edit(b, None)
}

/// Adds boxes under names that are free, with the voxels that those of their old names have; those for which no name is left
/// are left out.
pub fn add(frame: &Frame, boxes: Vec<SceneBox>, shapes: &BoxVoxels) -> Added {
    let highest = frame.boxes.keys().next_back().map_or(0, |id| id.0);
    let above = (highest..u32::MAX).map(|id| BoxId(id + 1));
    let gaps = (1..highest).map(BoxId).filter(|id| !frame.boxes.contains_key(id));
    let mut added = Added::default();
    for (b, id) in boxes.iter().zip(above.chain(gaps)) {
        added.edits.push(add_edit(b, Some(id)));
        if let Some(cells) = shapes.get(&b.id) {
            let cells = cells.clone();
            added.edits.push(Edit::SetShape { id, cells });
        }
        added.ids.push(id);
        added.of.push(b.id);
    }
    added
}

#[cfg(test)]
#[path = "arrange_tests.rs"]
pub(crate) mod tests;
