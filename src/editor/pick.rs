//! Picking with the pointer: rays against boxes, voxels and the ground, points against footprints.

use glam::{DVec2, DVec3};

use scene::{BoxId, Class, Extent, Frame, SceneBox, VoxelGrid};

/// A half line in the ego frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PickRay {
    /// Start of the ray, m.
    pub origin_in_ego: DVec3,
    /// Direction of the ray, unit length.
    pub direction_in_ego: DVec3,
}

impl PickRay {
    /// From a point and a direction of any length; `None` for numbers that are not finite or no direction.
    pub fn new(origin_in_ego: DVec3, direction_in_ego: DVec3) -> Option<PickRay> {
        let direction_in_ego = direction_in_ego.try_normalize()?;
        origin_in_ego.is_finite().then_some(PickRay {
            origin_in_ego,
            direction_in_ego,
        })
    }

    /// The point at a distance along the ray.
    pub fn at(&self, distance_m: f64) -> DVec3 {
        self.origin_in_ego + self.direction_in_ego * distance_m
    }
}

/// Part of a line inside the closed box `min..=max`: the parameters at which it enters and leaves (negative behind the
/// origin), `None` if it misses. Kay and Kajiya 1986, with a direction of zero along an axis decided by the position
/// alone, so that 0/0 never arises on the plane of a face.
pub fn slab(origin: DVec3, direction: DVec3, min: DVec3, max: DVec3) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
        if d == 0.0 {
            // Written so that NaN misses too.
            if !(o >= min[axis] && o <= max[axis]) {
                return None;
            }
            continue;
        }
        let (a, b) = ((min[axis] - o) / d, (max[axis] - o) / d);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some((enter, leave))
}

/// Distance in m at which the ray enters a box; 0 from inside.
pub fn ray_box(ray: &PickRay, b: &SceneBox) -> Option<f64> {
    let heading = b.heading();
    let d = ray.direction_in_ego;
    let local = DVec3::new(
        d.x * heading.x + d.y * heading.y,
        d.y * heading.x - d.x * heading.y,
        d.z,
    );
    let reach = b.size_m / 2.0;
    let (enter, leave) = slab(b.to_local(ray.origin_in_ego), local, -reach, reach)?;
    (leave >= 0.0).then_some(enter.max(0.0))
}

/// A voxel met by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelHit {
    /// Its index.
    pub cell: [usize; 3],
    /// Its label value.
    pub label: u8,
    /// Outward normal of the face that the ray went in by: one entry is +1 or -1. A ray that starts
    /// inside gets the face it looks away from most.
    pub normal: [i32; 3],
    /// Distance from the ray's origin, m.
    pub distance_m: f64,
}

impl VoxelHit {
    /// The cell in front of the face, where a voxel would be attached; `None` outside the grid.
    pub fn neighbour(&self, extent: Extent) -> Option<[usize; 3]> {
        let n = extent.shape();
        let mut out = [0; 3];
        for axis in 0..3 {
            let v = self.cell[axis] as i64 + i64::from(self.normal[axis]);
            if v < 0 || v >= n[axis] as i64 {
                return None;
            }
            out[axis] = v as usize;
        }
        Some(out)
    }
}

/// The first voxel along the ray for which `solid(cell, label)` holds; free voxels are never asked.
/// Amanatides and Woo 1987, with crossings computed from the origin each time, so that nothing
/// accumulates, and at most one step per plane of the grid.
pub fn ray_voxels(
    ray: &PickRay,
    grid: &VoxelGrid,
    solid: impl Fn([usize; 3], u8) -> bool,
) -> Option<VoxelHit> {
    let extent = grid.extent();
    let n = extent.shape().map(|n| n as i64);
    let origin = extent.to_voxel_units(ray.origin_in_ego);
    let d = ray.direction_in_ego;
    let size = DVec3::new(n[0] as f64, n[1] as f64, n[2] as f64);
    let (enter, leave) = slab(origin, d, DVec3::ZERO, size)?;
    if leave < 0.0 {
        return None;
    }
    let start = enter.max(0.0);
    let entry = origin + d * start;
    let mut cell = [0i64; 3];
    for axis in 0..3 {
        // On a plane between two cells the ray is about to enter the one it points to.
        let v = entry[axis];
        let floor = if d[axis] < 0.0 { v.ceil() - 1.0 } else { v.floor() };
        cell[axis] = (floor as i64).clamp(0, n[axis] - 1);
    }
    // The face of entry: the plane crossed last, or from inside the one faced most.
    let mut axis_in = (0..3)
        .max_by(|&a, &b| {
            let key = |axis: usize| match enter > 0.0 {
                true if d[axis] == 0.0 => f64::NEG_INFINITY,
                true => ((if d[axis] > 0.0 { 0.0 } else { size[axis] }) - origin[axis]) / d[axis],
                false => d[axis].abs(),
            };
            key(a).total_cmp(&key(b))
        })
        .unwrap_or(2);
    let mut at = start;
    for _ in 0..=n[0] + n[1] + n[2] {
        let here = cell.map(|v| v as usize);
        let label = grid.get(here[0], here[1], here[2]);
        if label != Class::FREE && solid(here, label) {
            let mut normal = [0; 3];
            normal[axis_in] = if d[axis_in] > 0.0 { -1 } else { 1 };
            return Some(VoxelHit {
                cell: here,
                label,
                normal,
                distance_m: at * grid.extent().voxel_m(),
            });
        }
        let next_plane = |axis: usize| match d[axis] {
            0.0 => f64::INFINITY,
            v if v > 0.0 => ((cell[axis] + 1) as f64 - origin[axis]) / v,
            v => (cell[axis] as f64 - origin[axis]) / v,
        };
        let t = [next_plane(0), next_plane(1), next_plane(2)];
        axis_in = if t[0] <= t[1] && t[0] <= t[2] {
            0
        } else if t[1] <= t[2] {
            1
        } else {
            2
        };
        at = t[axis_in].max(at);
        cell[axis_in] += if d[axis_in] > 0.0 { 1 } else { -1 };
        if cell[axis_in] < 0 || cell[axis_in] >= n[axis_in] {
            return None;
        }
    }
    None
}

/// The point where the ray meets the level plane at height `z_m`, if it does in front of its origin.
pub fn ray_ground(ray: &PickRay, z_m: f64) -> Option<DVec3> {
    let (o, d) = (ray.origin_in_ego, ray.direction_in_ego);
    if d.z == 0.0 {
        return None;
    }
    let distance_m = (z_m - o.z) / d.z;
    // NaN misses too; beyond the limit the plane is the horizon.
    (0.0..=1e6).contains(&distance_m).then(|| {
        let p = ray.at(distance_m);
        DVec3::new(p.x, p.y, z_m)
    })
}

/// The nearest thing under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PickHit {
    /// A box, or a voxel that shows it.
    Box {
        /// Its name.
        id: BoxId,
        /// Distance from the ray's origin, m.
        distance_m: f64,
    },
    /// A voxel of no box.
    Voxel(VoxelHit),
    /// The plane z = 0.
    Ground {
        /// Point that is hit, ego frame, m.
        point_in_ego: DVec3,
    },
}

/// The nearest box or voxel, else the ground. Voxels count for the box they show, because they
/// surround it.
pub fn pick(frame: &Frame, ray: &PickRay) -> Option<PickHit> {
    let boxes = frame
        .boxes
        .values()
        .filter_map(|b| Some((ray_box(ray, b)?, b.id)));
    let nearest = boxes.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let voxel = ray_voxels(ray, &frame.occupancy, |_, _| true);
    match (nearest, voxel) {
        (Some((distance_m, id)), v) if v.is_none_or(|v| distance_m <= v.distance_m) => {
            Some(PickHit::Box { id, distance_m })
        }
        (_, Some(v)) => Some(match box_of_voxel(frame, v.cell) {
            Some(id) => PickHit::Box {
                id,
                distance_m: v.distance_m,
            },
            None => PickHit::Voxel(v),
        }),
        _ => ray_ground(ray, 0.0).map(|point_in_ego| PickHit::Ground { point_in_ego }),
    }
}

/// The box that a voxel shows: of its class, and around it. Voxels reach half a metre beyond a box
/// at most, and down to the lowest bin.
pub fn box_of_voxel(frame: &Frame, [x, y, z]: [usize; 3]) -> Option<BoxId> {
    const REACH_M: f64 = 0.5;
    let label = frame.occupancy.get(x, y, z);
    let p = frame.extent().center(x, y, z);
    let candidates = frame.boxes.values().filter(|b| {
        let bottom_m = b.center_m.z - b.size_m.z / 2.0;
        b.class.id() == label && b.contains(DVec3::new(p.x, p.y, p.z.max(bottom_m)), REACH_M)
    });
    let flat_distance = |b: &SceneBox| b.center_m.truncate().distance_squared(p.truncate());
    candidates
        .min_by(|a, b| flat_distance(a).total_cmp(&flat_distance(b)))
        .map(|b| b.id)
}

/// The box whose footprint holds a point of the bird's-eye view (ego frame, m). Of several the
/// highest top wins, then the smaller footprint, then the newer id.
pub fn box_at(frame: &Frame, p_m: DVec2) -> Option<BoxId> {
    let holds = |b: &&SceneBox| b.contains(p_m.extend(b.center_m.z), 0.0);
    let top = |b: &SceneBox| b.center_m.z + b.size_m.z / 2.0;
    let area = |b: &SceneBox| b.size_m.x * b.size_m.y;
    frame
        .boxes
        .values()
        .filter(holds)
        .max_by(|a, b| {
            let by_top = top(a).total_cmp(&top(b));
            by_top.then(area(b).total_cmp(&area(a))).then(a.id.cmp(&b.id))
        })
        .map(|b| b.id)
}

/// A part of a selected box that can be dragged in the bird's-eye view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// The knob ahead of the box: turns it.
    Rotate,
    /// Corner of that index of [`SceneBox::footprint`]: resizes it.
    Corner(usize),
    /// Anywhere inside: moves it.
    Body,
}

/// Distance of the rotate knob from the front of the box, m.
pub const ROTATE_KNOB_M: f64 = 1.2;

/// Place of the rotate knob of a box, ego frame, m.
pub fn rotate_knob(b: &SceneBox) -> DVec2 {
    b.center_m.truncate() + b.heading() * (b.size_m.x / 2.0 + ROTATE_KNOB_M)
}

/// True if a box is large enough on the screen to be resized by its corners: they would cover a smaller one.
pub fn has_corner_handles(b: &SceneBox, tolerance_m: f64) -> bool {
    b.size_m.truncate().min_element() >= 1.2 * tolerance_m
}

/// The handle of a selected box within `tolerance_m` of a point: corners before body before knob. Within the box a corner is
/// a corner for a quarter of the shorter edge at most, so that most of the box is there to move it.
pub fn handle_at(b: &SceneBox, p_m: DVec2, tolerance_m: f64) -> Option<Handle> {
    let inside = b.contains(p_m.extend(b.center_m.z), 0.0);
    let reach_m = match inside {
        true => tolerance_m.min(b.size_m.truncate().min_element() / 4.0),
        false => tolerance_m,
    };
    let corners = b.footprint();
    let nearest = (0..4).min_by(|&i, &j| corners[i].distance(p_m).total_cmp(&corners[j].distance(p_m)));
    match nearest {
        Some(i) if has_corner_handles(b, tolerance_m) && corners[i].distance(p_m) <= reach_m => {
            Some(Handle::Corner(i))
        }
        _ if inside => Some(Handle::Body),
        _ if rotate_knob(b).distance(p_m) <= tolerance_m => Some(Handle::Rotate),
        _ => None,
    }
}

/// Heading in degrees (-180 to 180) that points a box at a point; `None` at its very centre.
pub fn yaw_deg_towards(b: &SceneBox, p_m: DVec2) -> Option<f64> {
    let d = p_m - b.center_m.truncate();
    (d.is_finite() && d.length() > 1e-6).then(|| d.to_angle().to_degrees())
}

/// Centre and size after corner `corner` of the footprint is dragged to a point while the opposite
/// corner stays; edges keep at least 0.1 m. Height and z stay.
pub fn resized_by_corner(b: &SceneBox, corner: usize, p_m: DVec2) -> (DVec3, DVec3) {
    const MIN_EDGE_M: f64 = 0.1;
    let sign = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][corner % 4];
    let sign = DVec2::new(sign.0, sign.1);
    let fixed = -sign * b.size_m.truncate() / 2.0; // opposite corner, box coordinates
    let dragged = b.to_local(p_m.extend(b.center_m.z)).truncate();
    let edges = ((dragged - fixed) * sign).max(DVec2::splat(MIN_EDGE_M));
    let middle = fixed + sign * edges / 2.0;
    (b.to_ego(middle.extend(0.0)), edges.extend(b.size_m.z))
}

#[cfg(test)]
#[path = "pick_tests.rs"]
mod tests;
