//! Returns on the shapes of boxes and scenery: rays are cast through voxels of 0.4 m, which stick out of the boxes that they stand
//! for. Here a return on a box's voxels becomes the return on the box's solids, those that pictures show, and lies
//! within the box.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::lidar::{EgoBox, look_through};
use crate::pictures::march::solids::SolidIndex;
use crate::pictures::scenery::SceneryShapes;
use crate::raycast::ColumnMasks;
use scene::raster::box_cells;
use scene::solid::Solid;
use scene::{
    BoxId, Class, Extent, Frame, Lattice, LidarPattern, LidarPoint, LidarSweep, SceneBox, SensorRig,
    VoxelGrid,
};
use world::objects;

/// Distance beside or above a box within which the middle of a voxel may be its own, m.
const BESIDE_M: f64 = 0.5;
/// Least depth of a return within its box, m: no rounding puts it outside.
const WITHIN_M: f64 = 1e-3;
/// Largest distance behind its place at which a return of the network may belong, m: voxels stick out by less.
const BEHIND_M: f64 = 1.5;
/// Largest depth below its box at which an echo of the network may belong to it, m.
const BELOW_M: f64 = 0.4;
/// Distance beyond a point at which the voxel that it lies on is looked up, m.
const INTO_M: f64 = 1e-3;
/// Most voxels of boxes that a ray goes through.
const MOST_VOXELS: usize = 256;
/// Step out of a voxel, in voxels.
const OUT: f64 = 1e-6;
/// Rays that one thread works on in a row.
const RAYS: usize = 512;

/// Puts the returns of boxes where their rays meet the boxes' solids, in a sweep of the first LiDAR of a rig that
/// stands in the frame's coordinates. A ray that passes the solids of a box goes on to what is behind. A return is left
/// out if the ray finds nothing there, or if it is an echo of the network, whose strength there is unknown. A return
/// from behind the solids of a box moves onto them. Boxes whose voxels are their own, and classes without solids, keep
/// their voxels as far as they are within the box. `seed` is the scene's: it varies the solids. Returns of an exact sweep on
/// the voxels of scenery become those on its solids in the same way.
pub fn onto_shapes(
    sweep: &mut LidarSweep,
    frame: &Frame,
    rig: &SensorRig,
    seed: u64,
    scenery: Option<&SceneryShapes>,
) {
    place(sweep, (frame, scenery), rig, seed, None);
}

/// Places returns as [`onto_shapes`] does, with the masks of the frame's voxels, those in the own vehicle left out; the
/// masks are made here if `None`.
pub(super) fn place(
    sweep: &mut LidarSweep,
    (frame, scenery): (&Frame, Option<&SceneryShapes>),
    rig: &SensorRig,
    seed: u64,
    known: Option<&ColumnMasks>,
) {
    let Some(pattern) = rig.lidars.first() else { return };
    let boxes: Vec<&SceneBox> = frame.boxes.values().filter(|b| b.problem().is_none()).collect();
    let scenery = scenery.filter(|_| !sweep.physical);
    if boxes.is_empty() && scenery.is_none() || sweep.points.is_empty() {
        return;
    }
    let shapes = ShapedBoxes::new(frame, &boxes, scenery, seed);
    let physical = sweep.physical;
    let masks = (!physical).then(|| match known {
        Some(masks) => Cow::Borrowed(masks),
        None => {
            let mut masks = ColumnMasks::from_grid(&frame.occupancy);
            look_through(&mut masks, EgoBox::of_rig(rig));
            Cow::Owned(masks)
        }
    });
    let (at, velocity) = (pattern.ego_from_sensor().translation_m, rig.velocity_mps());
    let placed = |point: &LidarPoint| {
        let origin = at - velocity * pattern.before_end_s(point.azimuth.into());
        let way = DVec3::from_array(point.position_in_ego.map(f64::from)) - origin;
        let Some(direction) = way.try_normalize() else {
            return Some(*point);
        };
        let ray = ReturnRay {
            origin,
            direction,
            met_m: way.length(),
        };
        let met = match &masks {
            Some(masks) => shapes.exact(&ray, point, (&**masks, &frame.occupancy), pattern),
            None => shapes.learned(&ray, point),
        };
        let (range_m, class) = match met {
            ReturnPlacement::Same => return Some(*point),
            ReturnPlacement::Nothing => return None,
            ReturnPlacement::At(range_m, class) => (range_m, class),
        };
        (range_m >= pattern.min_range_m && range_m <= pattern.max_range_m).then(|| LidarPoint {
            position_in_ego: (origin + direction * range_m).as_vec3().to_array(),
            range_m: range_m as f32,
            class,
            ..*point
        })
    };
    sweep.points = sweep
        .points
        .par_iter()
        .with_min_len(RAYS)
        .filter_map(placed)
        .collect();
}

/// A ray and its length up to the hit, m.
struct ReturnRay {
    origin: DVec3,
    direction: DVec3,
    met_m: f64,
}

/// New place of a return.
enum ReturnPlacement {
    Same,
    Nothing,
    /// Its range, m, and the class there.
    At(f64, Class),
}

/// The boxes of a frame and their solids.
struct ShapedBoxes<'a> {
    extent: Extent,
    boxes: Vec<Shaped<'a>>,
    by_id: HashMap<BoxId, usize>,
    /// Boxes whose voxels may stand over a column.
    columns: HashMap<usize, Vec<usize>>,
    solids: SolidIndex,
    /// Classes of the boxes, one bit each.
    classes: u32,
    scenery: Option<&'a SceneryShapes>,
}

struct Shaped<'a> {
    of: &'a SceneBox,
    /// True if solids stand for its voxels.
    solid: bool,
}

/// Owner of a voxel.
enum VoxelOwner<'a> {
    /// A box that solids stand for: the voxel is looked through.
    Solids,
    /// A box that its voxels stand for, within the box.
    Voxels(&'a SceneBox),
}

impl<'a> ShapedBoxes<'a> {
    fn new(frame: &Frame, boxes: &[&'a SceneBox], scenery: Option<&'a SceneryShapes>, seed: u64) -> Self {
        let extent = frame.extent();
        let mut parts: Vec<Solid> = Vec::new();
        let mut has_solids = |b: &SceneBox| {
            parts.clear();
            objects::object(b, seed, &mut parts);
            !parts.is_empty() && !frame.own_shapes.contains_key(&b.id)
        };
        let boxes: Vec<Shaped<'_>> = boxes
            .iter()
            .map(|b| Shaped {
                of: b,
                solid: has_solids(b),
            })
            .collect();
        let mut columns: HashMap<usize, Vec<usize>> = HashMap::new();
        for (i, b) in boxes.iter().enumerate() {
            box_cells(extent, b.of, BESIDE_M, |x, y| {
                columns.entry(extent.index(x, y)).or_default().push(i);
            });
        }
        let solid = boxes.iter().filter(|b| b.solid).map(|b| b.of);
        Self {
            extent,
            by_id: boxes.iter().enumerate().map(|(i, b)| (b.of.id, i)).collect(),
            columns,
            solids: SolidIndex::of_boxes(extent, solid, seed),
            classes: boxes.iter().fold(0, |bits, b| bits | 1 << b.of.class.id()),
            boxes,
            scenery,
        }
    }

    /// Owner of a voxel that was met at a height, m. `None` if this is more than `below_m` below the box: there labels
    /// go down to their ground.
    fn owner(&self, [x, y, z]: [usize; 3], label: u8, met_m: f64, below_m: f64) -> Option<VoxelOwner<'_>> {
        if self.scenery.is_some_and(|s| s.stands_for([x, y, z], met_m)) {
            return Some(VoxelOwner::Solids);
        }
        if label >= Class::FREE || self.classes >> label & 1 == 0 {
            return None;
        }
        let middle_m = self.extent.center(x, y, z).z;
        let over = self
            .columns
            .get(&self.extent.index(x, y))?
            .iter()
            .map(|i| &self.boxes[*i]);
        let mut own = over.filter(|b| {
            let (low_m, high_m) = (
                b.of.center_m.z - b.of.size_m.z / 2.0,
                b.of.center_m.z + b.of.size_m.z / 2.0,
            );
            b.of.class.id() == label && met_m >= low_m - below_m && middle_m < high_m + BESIDE_M
        });
        let first = own.next()?;
        match std::iter::once(first).chain(own).find(|b| !b.solid) {
            Some(b) => Some(VoxelOwner::Voxels(b.of)),
            None => Some(VoxelOwner::Solids),
        }
    }

    /// Hit of a ray on a solid, nearer than `limit_m`: distance, m, and class.
    fn on_solid(&self, ray: &ReturnRay, limit_m: f64) -> Option<(f64, Class)> {
        let on_box = self.on_box(ray, limit_m);
        let limit_m = on_box.map_or(limit_m, |(range_m, _)| range_m);
        let scenery = self
            .scenery
            .and_then(|s| s.cast(ray.origin, ray.direction, limit_m));
        scenery.map(|hit| (hit.t_m, hit.solid.class)).or(on_box)
    }

    /// Hit of a ray on a solid of a box within that box, nearer than `limit_m`: distance, m, and class.
    fn on_box(&self, ray: &ReturnRay, limit_m: f64) -> Option<(f64, Class)> {
        let hit = self.solids.cast(ray.origin, ray.direction, limit_m)?;
        let b = self.boxes[*self.by_id.get(&hit.box_id?)?].of;
        let [from, to] = through(b, ray)?;
        Some((hit.t_m.clamp(from, to), hit.solid.class))
    }

    fn exact(
        &self,
        ray: &ReturnRay,
        point: &LidarPoint,
        (masks, grid): (&ColumnMasks, &VoxelGrid),
        pattern: &LidarPattern,
    ) -> ReturnPlacement {
        let origin = self.extent.to_voxel_units(ray.origin);
        let at = ray.origin + ray.direction * (ray.met_m + INTO_M);
        let voxel = self.voxel_at(at);
        let is_own = voxel.is_some_and(|v| self.owner(v, point.class.id(), at.z, 0.0).is_some());
        if !is_own {
            let solid = self.on_solid(ray, ray.met_m);
            return solid.map_or(ReturnPlacement::Same, |(range_m, class)| {
                ReturnPlacement::At(range_m, class)
            });
        }
        // Voxels behind the solid need not be looked through.
        let solid = self.on_solid(ray, pattern.max_range_m);
        let limit_m = solid.map_or(pattern.max_range_m, |(range_m, _)| range_m);
        let max_t = limit_m / Lattice::OCC3D.voxel_m();
        let (mut from, mut behind) = (0.0, None);
        for _ in 0..MOST_VOXELS {
            let start = origin + ray.direction * from;
            let Some((t, voxel)) = masks.cast_in_voxels(start, ray.direction, max_t - from) else {
                break;
            };
            let (t, label) = (from + t, grid.get(voxel[0], voxel[1], voxel[2]));
            let out = left_at(origin, ray.direction, voxel);
            let met_m = ray.origin.z + ray.direction.z * (t * Lattice::OCC3D.voxel_m() + INTO_M);
            match self.owner(voxel, label, met_m, 0.0) {
                None => {
                    behind = Some((t * Lattice::OCC3D.voxel_m(), label));
                    break;
                }
                Some(VoxelOwner::Voxels(b)) => {
                    if let Some([near_m, far_m]) = through(b, ray)
                        && near_m <= out * Lattice::OCC3D.voxel_m()
                        && far_m >= t * Lattice::OCC3D.voxel_m()
                    {
                        behind = Some(((t * Lattice::OCC3D.voxel_m()).clamp(near_m, far_m), label));
                        break;
                    }
                }
                Some(VoxelOwner::Solids) => {}
            }
            from = out.max(t) + OUT;
        }
        let behind = behind.filter(|(range_m, _)| *range_m < limit_m);
        let behind = behind.map(|(range_m, label)| (range_m, Class::from_id(label).unwrap_or(Class::Others)));
        let met = behind.or(solid);
        met.map_or(ReturnPlacement::Nothing, |(range_m, class)| {
            ReturnPlacement::At(range_m, class)
        })
    }

    fn learned(&self, ray: &ReturnRay, point: &LidarPoint) -> ReturnPlacement {
        let at = ray.origin + ray.direction * (ray.met_m + INTO_M);
        let owner = self
            .voxel_at(at)
            .and_then(|v| self.owner(v, point.class.id(), at.z, BELOW_M));
        let limit_m = match owner {
            Some(_) => ray.met_m + BEHIND_M,
            None => ray.met_m,
        };
        if let Some(VoxelOwner::Voxels(b)) = owner {
            let within =
                through(b, ray).filter(|[near, far]| *near <= limit_m && *far >= ray.met_m - BEHIND_M);
            return within.map_or(ReturnPlacement::Nothing, |[near, far]| {
                ReturnPlacement::At(ray.met_m.clamp(near, far), point.class)
            });
        }
        match (self.on_solid(ray, limit_m), owner) {
            (Some((range_m, class)), _) => ReturnPlacement::At(range_m, class),
            (None, Some(_)) => ReturnPlacement::Nothing,
            (None, None) => ReturnPlacement::Same,
        }
    }

    fn voxel_at(&self, p: DVec3) -> Option<[usize; 3]> {
        let [x, y] = self.extent.column_at(p.x, p.y)?;
        let z = self.extent.to_voxel_units(p).z;
        (z >= 0.0 && z < Lattice::OCC3D.bins() as f64).then_some([x, y, z as usize])
    }
}

/// Distances between which a ray is in a box, at least [`WITHIN_M`] from its faces, m; `None` if it passes the box, or
/// if the box is thinner than that.
fn through(b: &SceneBox, ray: &ReturnRay) -> Option<[f64; 2]> {
    within(b, ray.origin, ray.direction, WITHIN_M)
}

/// Distances between which a ray is in a box, at least `inside_m` from its faces, m; `None` as in [`through`].
pub(super) fn within(b: &SceneBox, origin: DVec3, direction: DVec3, inside_m: f64) -> Option<[f64; 2]> {
    let (from, to) = (b.to_local(origin), b.to_local(origin + direction));
    let (way, half) = (to - from, b.size_m / 2.0 - DVec3::splat(inside_m));
    let (mut near, mut far) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        if way[axis].abs() < 1e-12 {
            if from[axis].abs() > half[axis] {
                return None;
            }
            continue;
        }
        let ends = [-half[axis], half[axis]].map(|side| (side - from[axis]) / way[axis]);
        (near, far) = (near.max(ends[0].min(ends[1])), far.min(ends[0].max(ends[1])));
    }
    (half.min_element() > 0.0 && near <= far).then_some([near, far])
}

/// Distance along a ray at which it leaves a voxel, voxel units.
fn left_at(origin: DVec3, direction: DVec3, voxel: [usize; 3]) -> f64 {
    let side = |axis: usize| match direction[axis] {
        d if d > 0.0 => (voxel[axis] as f64 + 1.0 - origin[axis]) / d,
        d if d < 0.0 => (voxel[axis] as f64 - origin[axis]) / d,
        _ => f64::INFINITY,
    };
    side(0).min(side(1)).min(side(2))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use crate::lidar;
    use scene::clip::{ObjectVoxels, OwnShape};
    use scene::{BevLayout, BoxLabel, Pose};

    /// A road of ground voxels with these boxes as their drafts have them, and a wall behind.
    fn frame(boxes: &[SceneBox]) -> Frame {
        let mut grid = VoxelGrid::new();
        for [x, y] in Extent::WINDOW.all_columns() {
            grid.set(x, y, 0, Class::DriveableSurface.id());
            if x == 170 {
                (1..14).for_each(|z| grid.set(x, y, z, Class::Manmade.id()));
            }
        }
        for b in boxes {
            for (x, y, layers) in scene::draft::box_columns(grid.extent(), b) {
                (0..layers).for_each(|z| grid.set(x, y, z, b.class.id()));
            }
        }
        let boxes: BTreeMap<_, _> = boxes.iter().map(|b| (b.id, *b)).collect();
        Frame::new(BevLayout::default(), boxes, grid)
    }

    fn thing(id: u32, class: Class, at: [f64; 2], size_m: [f64; 3], yaw_rad: f64) -> SceneBox {
        SceneBox {
            id: BoxId(id),
            class,
            center_m: DVec3::new(at[0], at[1], size_m[2] / 2.0),
            size_m: size_m.into(),
            yaw_rad,
            velocity_mps: glam::DVec2::ZERO,
            label: BoxLabel::default(),
        }
    }

    fn boxes() -> Vec<SceneBox> {
        vec![
            thing(1, Class::Car, [9.3, 2.1], [4.4, 1.8, 1.6], 0.3),
            thing(2, Class::Truck, [15.2, -3.4], [8.1, 2.6, 3.3], -0.2),
            thing(3, Class::Pedestrian, [5.1, -1.3], [0.7, 0.6, 1.75], 1.0),
            thing(4, Class::Bicycle, [6.3, 5.2], [1.7, 0.6, 1.4], 2.0),
        ]
    }

    /// How many returns of things above the ground are outside of every box, and how many there are.
    fn outside(sweep: &LidarSweep, frame: &Frame) -> [usize; 2] {
        let of_things = sweep.points.iter().filter(|p| {
            let [x, y, z] = p.position_in_ego;
            let own = p.class == Class::Others && x.hypot(y) < 3.0;
            !own && z > 0.0 && frame.boxes.values().any(|b| b.class == p.class)
        });
        of_things.fold([0, 0], |[out, all], p| {
            let at = DVec3::from_array(p.position_in_ego.map(f64::from));
            let inside = frame.boxes.values().any(|b| b.contains(at, 0.0));
            [out + usize::from(!inside), all + 1]
        })
    }

    #[test]
    fn returns_of_boxes_are_in_their_boxes_and_rays_past_them_go_on() {
        let (frame, rig) = (frame(&boxes()), SensorRig::default());
        let voxels = lidar::rig_sweep(&frame.occupancy, &rig).expect("a LiDAR");
        let [out, all] = outside(&voxels, &frame);
        println!("outside of their boxes: {out} of {all} as voxels");
        assert!(out * 5 > all && all > 300, "{out} of {all}: voxels stick out");
        let mut sweep = voxels.clone();
        onto_shapes(&mut sweep, &frame, &rig, 1, None);
        let [out, after] = outside(&sweep, &frame);
        assert_eq!(out, 0);
        assert!(after * 2 > all, "{after} of {all} are left");
        // What went past a box reached the road or the wall behind: next to nothing is lost.
        assert!(sweep.points.len() * 100 > voxels.points.len() * 99);
        let walls = |s: &LidarSweep| s.points.iter().filter(|p| p.class == Class::Manmade).count();
        assert!(walls(&sweep) > walls(&voxels));
        // Rays stay rays.
        let at = DVec3::from_array(rig.lidars[0].translation_m);
        for p in &sweep.points {
            let range_m = (DVec3::from_array(p.position_in_ego.map(f64::from)) - at).length();
            assert!((range_m - f64::from(p.range_m)).abs() < 1e-3);
        }
        let key = |p: &LidarPoint| (p.ring, p.azimuth);
        assert!(sweep.points.windows(2).all(|w| key(&w[0]) < key(&w[1])));
        // Without boxes everything stays.
        let bare = Frame {
            boxes: BTreeMap::new(),
            ..frame.clone()
        };
        let mut same = voxels.clone();
        onto_shapes(&mut same, &bare, &rig, 1, None);
        assert_eq!(same, voxels);
    }

    #[test]
    fn echoes_of_the_network_are_in_their_boxes_or_gone() {
        let (frame, rig) = (frame(&boxes()), SensorRig::default());
        let mut sweep = lidar::rig_sweep(&frame.occupancy, &rig).expect("a LiDAR");
        sweep.physical = true;
        let before = outside(&sweep, &frame);
        onto_shapes(&mut sweep, &frame, &rig, 1, None);
        let after = outside(&sweep, &frame);
        assert!(before[0] > 0 && after[0] == 0, "{before:?} {after:?}");
        assert!(after[1] * 2 > before[1]);
    }

    #[test]
    fn a_vehicle_elsewhere_on_the_map_sees_the_same() {
        let (frame, rig) = (frame(&boxes()), SensorRig::default());
        let mut here = lidar::rig_sweep(&frame.occupancy, &rig).expect("a LiDAR");
        onto_shapes(&mut here, &frame, &rig, 1, None);
        // From the other side of the car, where the vehicle stands turned round.
        let there = rig.standing_at(&Pose::planar(26.0, 1.0, std::f64::consts::PI));
        let mut seen = lidar::rig_sweep(&frame.occupancy, &there).expect("a LiDAR");
        onto_shapes(&mut seen, &frame, &there, 1, None);
        assert_eq!(outside(&seen, &frame)[0], 0);
        let cars = |s: &LidarSweep| s.points.iter().filter(|p| p.class == Class::Car).count();
        assert!(
            cars(&here) > 100 && cars(&seen) > 20,
            "{} {}",
            cars(&here),
            cars(&seen)
        );
    }

    #[test]
    fn what_has_voxels_of_its_own_keeps_those_in_its_box() {
        let (mut frame, rig) = (frame(&boxes()[..1]), SensorRig::default());
        let voxels = lidar::rig_sweep(&frame.occupancy, &rig).expect("a LiDAR");
        let made = frame.boxes[&BoxId(1)];
        let own = OwnShape {
            made,
            voxels: ObjectVoxels::empty(),
        };
        frame.own_shapes = Arc::new([(made.id, own)].into());
        for physical in [false, true] {
            let mut sweep = voxels.clone();
            sweep.physical = physical;
            onto_shapes(&mut sweep, &frame, &rig, 1, None);
            assert_eq!(outside(&sweep, &frame)[0], 0);
            // What lay within the box is where it was.
            let inside = |p: &&LidarPoint| {
                let at = DVec3::from_array(p.position_in_ego.map(f64::from));
                p.class == Class::Car && made.contains(at, -0.01)
            };
            let key = |p: &LidarPoint| (p.ring, p.azimuth);
            let after: BTreeMap<_, _> = sweep.points.iter().map(|p| (key(p), p.range_m)).collect();
            let kept: Vec<_> = voxels.points.iter().filter(inside).collect();
            assert!(kept.len() > 20, "{}", kept.len());
            for p in kept {
                assert!((after[&key(p)] - p.range_m).abs() < 1e-4);
            }
        }
    }
}
