//! Voxels that a small network predicts from the LiDAR sweep and the camera pictures of a scene, compared with those
//! that are there: boxes that it misses, and things that it sees where there are none.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::lidar::rolling;
use crate::perceive::pictures::{LEAST_PX, MISSED_BELOW, Perceived};
use crate::perceive::sweep::{LEAST_RETURNS, near};
use crate::pictures::appearance::{Appearance, CameraImage};
use crate::pictures::painter::PaintError;
use crate::splat::project::SplatCamera;
use nets::perceiver::against::returns_on;
use nets::sensor_occupancy::{SensorOccupancy, UNSEEN};
use scene::raster::box_cells;
use scene::resample::voxels_in;
use scene::truth::TruthClass;
use scene::{
    BoxId, BoxLabel, Camera, Class, Extent, Lattice, LidarSweep, Pose, Scene, SceneBox, VoxelGrid, Window,
};

/// A box of fewer voxels is too small to be missed.
pub const LEAST_VOXELS: usize = 2;
/// Least number of connected voxels that count as a thing where there is none.
pub const LEAST_GHOST: usize = 6;
/// Least distance at which a camera shows a voxel, m.
const NEAR_M: f64 = 0.5;
/// Distance from a box within which a predicted thing belongs to it, columns.
const BESIDE: usize = 2;

/// Sensors that the network uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hears {
    /// LiDAR and cameras.
    #[default]
    Both,
    /// The LiDAR alone.
    Lidar,
    /// The cameras alone.
    Cameras,
}

/// Predictions from a scene's sensors, compared with the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelReport {
    /// Predicted voxels in the window around the vehicle, in the vehicle's frame.
    pub voxels: VoxelGrid,
    /// Intersection over union of the solid voxels, predicted and true, in the columns within 1.2 m of a return.
    pub iou: f64,
    /// Share of the voxels solid in both whose class is predicted correctly.
    pub right: f64,
    /// Boxes that a sensor sees well enough to be judged, missed ones first, then the largest first.
    pub boxes: Vec<SeenInVoxels>,
    /// Things where there are none, the largest first.
    pub ghosts: Vec<Ghost>,
    /// Map from the vehicle.
    pub map_from_vehicle: Pose,
}

/// A box of the scene among the voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenInVoxels {
    /// The box.
    pub id: BoxId,
    /// Voxels that are its own; 0 if neither LiDAR nor cameras see enough of it to judge it.
    pub voxels: usize,
    /// Share of them that are predicted to be a thing.
    pub share: f64,
}

impl SeenInVoxels {
    /// True if there is enough of it to be judged.
    pub fn is_judged(&self) -> bool {
        self.voxels >= LEAST_VOXELS
    }

    /// True if there is enough of it to be judged and the network does not predict a thing there.
    pub fn is_missed(&self) -> bool {
        self.is_judged() && self.share < MISSED_BELOW
    }
}

/// A thing that is predicted where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ghost {
    /// A box on the map around its voxels, of the predicted class.
    pub thing: SceneBox,
    /// Number of its voxels.
    pub voxels: usize,
}

/// Input of the network from the sensors of a scene.
pub struct PerceptionInput {
    /// Returns in the vehicle's frame with their echo strengths.
    returns: Vec<[f32; 4]>,
    painted: Vec<u8>,
    sweep: LidarSweep,
    /// Pixels of each box in the camera that shows most of it.
    pixels: BTreeMap<BoxId, usize>,
    /// Share of the pixels whose class the segmenter predicts correctly, mean over the cameras.
    pub pixels_right: f64,
}

impl PerceptionInput {
    /// Sweeps and draws a scene. Errors if the segmenter cannot be read.
    pub fn from_scene(scene: &Scene) -> Result<Self, PaintError> {
        Self::seeing(scene, None)
    }

    /// Sweeps a scene whose cameras see learned pictures, in the order of the rig, by
    /// [`Painter`](crate::pictures::painter::Painter). Errors also if they are of another size.
    pub fn of_pictures(scene: &Scene, pictures: &[Arc<CameraImage>]) -> Result<Self, PaintError> {
        Self::seeing(scene, Some(pictures))
    }

    fn seeing(scene: &Scene, pictures: Option<&[Arc<CameraImage>]>) -> Result<Self, PaintError> {
        let placed = scene.for_sensors();
        let sweep = rolling::of_voxels(&placed);
        let to_vehicle = scene.frame().world_from_ego.inverse();
        let returns = sweep.points.iter().map(|point| {
            let at = to_vehicle.apply(glam::Vec3::from(point.position_in_ego).as_dvec3());
            let [x, y, z] = at.as_vec3().to_array();
            [x, y, z, point.intensity]
        });
        let appearance = Appearance::with_things(
            placed.frame(),
            &placed.background,
            &placed.rig,
            &placed.conditions,
        );
        let look = |(i, camera): (usize, &Camera)| {
            let seen = Perceived::of(&appearance, placed.frame(), camera)?;
            match pictures.and_then(|pictures| pictures.get(i)) {
                Some(picture) => seen.with_picture(CameraImage::clone(picture)),
                None => Ok(seen),
            }
        };
        let cameras = placed.rig.cameras.par_iter().enumerate();
        let seen: Result<Vec<Perceived>, PaintError> = cameras.map(look).collect();
        let seen = seen?;
        let mut pixels: BTreeMap<BoxId, usize> = BTreeMap::new();
        for thing in seen.iter().flat_map(Perceived::boxes) {
            let most = pixels.entry(thing.id).or_default();
            *most = thing.visible_px.max(*most);
        }
        let shown = scene.rig.cameras.iter().zip(&seen);
        let shown: Vec<CameraClasses<'_>> = shown
            .map(|(camera, seen)| CameraClasses {
                camera,
                size_px: [seen.image.width, seen.image.height],
                classes: &seen.classes,
            })
            .collect();
        Ok(Self {
            returns: returns.collect(),
            painted: painted(&shown),
            sweep,
            pixels,
            pixels_right: seen.iter().map(Perceived::right).sum::<f64>() / seen.len().max(1) as f64,
        })
    }

    /// Voxels that the network predicts from the chosen sensors, in the vehicle's frame. Errors if the network cannot
    /// be read.
    pub fn voxels(&self, hears: Hears) -> Result<VoxelGrid, PaintError> {
        let network = |e: &dyn std::fmt::Display| PaintError::Network(e.to_string());
        let net = SensorOccupancy::bundled().map_err(|e| network(&e))?;
        let returns = self.returns.iter().filter(|_| hears != Hears::Cameras).copied();
        let told = match hears {
            Hears::Lidar => net.voxels(returns, &vec![UNSEEN; Window::VOXELS]),
            _ => net.voxels(returns, &self.painted),
        };
        told.map_err(|e| network(&e))
    }
}

/// Classes that a camera shows.
pub struct CameraClasses<'a> {
    /// The camera, in the vehicle's frame.
    pub camera: &'a Camera,
    /// Width and height of the picture, px.
    pub size_px: [usize; 2],
    /// Class of each pixel.
    pub classes: &'a [TruthClass],
}

/// Classes that cameras show at the middle of each voxel of the window around the vehicle, `[x][y][16]`. The camera
/// that sees the voxel nearest to its axis counts; on a tie the first one. Twin of `painted` in
/// `training/models/sensor_occupancy.py`.
pub fn painted(shown: &[CameraClasses<'_>]) -> Vec<u8> {
    let views = shown.iter().map(|s| {
        let [w, h] = s.size_px;
        (SplatCamera::new(s.camera, w as u32, h as u32, 1.0), s)
    });
    let views: Vec<_> = views.collect();
    let at = |place: DVec3| {
        let (mut best, mut class) = (0.0, UNSEEN);
        for (view, shown) in &views {
            let p = view.to_camera(place);
            let straight = p.z / p.length();
            let Some(seen) = view
                .project(place, 0.0, NEAR_M, f64::INFINITY)
                .filter(|_| straight > best)
            else {
                continue;
            };
            let [u, v] = seen.mean_px.map(f64::floor);
            let [w, h] = shown.size_px;
            if u >= 0.0 && v >= 0.0 && u < w as f64 && v < h as f64 {
                (best, class) = (straight, shown.classes[v as usize * w + u as usize]);
            }
        }
        class
    };
    let column = |i: usize| {
        let [x, y] = [i / Window::NY, i % Window::NY];
        (0..Window::NZ).map(move |z| (x, y, z))
    };
    (0..Window::COLUMNS)
        .into_par_iter()
        .flat_map_iter(|i| column(i).map(|(x, y, z)| at(Window::center(x, y, z))))
        .collect()
}

/// Looks at a scene's LiDAR and cameras. Errors if a network cannot be read.
pub fn report(scene: &Scene, hears: Hears) -> Result<VoxelReport, PaintError> {
    let heard = PerceptionInput::from_scene(scene)?;
    report_of(scene, &heard, hears)
}

/// The report of a scene whose input is gathered already.
pub fn report_of(scene: &Scene, heard: &PerceptionInput, hears: Hears) -> Result<VoxelReport, PaintError> {
    let voxels = heard.voxels(hears)?;
    let map_from_vehicle = scene.frame().world_from_ego;
    let scene = &*scene.in_lattice(Lattice::OCC3D);
    let around = scene.in_ego();
    let truth = around.frame().occupancy.crop(Extent::WINDOW);
    let near = near(&heard.sweep, &map_from_vehicle);
    let [mut both, mut either, mut right] = [0usize; 3];
    for (i, _) in near.iter().enumerate().filter(|(_, near)| **near) {
        let (x, y) = (i / Window::NY, i % Window::NY);
        for (told, true_) in voxels.column(x, y).iter().zip(truth.column(x, y)) {
            let solid = [told, true_].map(|l| *l != Class::FREE);
            both += usize::from(solid == [true; 2]);
            either += usize::from(solid != [false; 2]);
            right += usize::from(solid == [true; 2] && told == true_);
        }
    }
    let share = |n: usize, of: usize| if of == 0 { 1.0 } else { n as f64 / of as f64 };
    let inside = |b: &&SceneBox| Window::column_at(b.center_m.x, b.center_m.y).is_some();
    let boxes = around.frame().boxes.values().filter(inside);
    let mut boxes: Vec<SeenInVoxels> = boxes
        .map(|b| seen(b, scene, heard, [&truth, &voxels]))
        .filter(SeenInVoxels::is_judged)
        .collect();
    boxes.sort_by_key(|b| (!b.is_missed(), std::cmp::Reverse(b.voxels)));
    Ok(VoxelReport {
        iou: share(both, either),
        right: share(right, both),
        boxes,
        ghosts: ghosts(&truth, &voxels, scene),
        voxels,
        map_from_vehicle,
    })
}

/// Result for one box; `None` if it is not in the window.
pub fn sight(scene: &Scene, id: BoxId) -> Result<Option<SeenInVoxels>, PaintError> {
    let scene = &*scene.in_lattice(Lattice::OCC3D);
    let around = scene.in_ego();
    let inside = |b: &&SceneBox| Window::column_at(b.center_m.x, b.center_m.y).is_some();
    let Some(b) = around.frame().boxes.get(&id).filter(inside) else {
        return Ok(None);
    };
    let heard = PerceptionInput::from_scene(scene)?;
    let truth = around.frame().occupancy.crop(Extent::WINDOW);
    Ok(Some(seen(
        b,
        scene,
        &heard,
        [&truth, &heard.voxels(Hears::Both)?],
    )))
}

/// Result for a box of the vehicle's frame, from true and predicted voxels.
fn seen(
    b: &SceneBox,
    scene: &Scene,
    heard: &PerceptionInput,
    [truth, told]: [&VoxelGrid; 2],
) -> SeenInVoxels {
    let returns = scene
        .frame()
        .boxes
        .get(&b.id)
        .map_or(0, |b| returns_on(b, &heard.sweep));
    let pixels = heard.pixels.get(&b.id).copied().unwrap_or(0);
    let (mut voxels, mut found) = (0, 0);
    if returns >= LEAST_RETURNS || pixels >= LEAST_PX {
        box_cells(Extent::WINDOW, b, 0.0, |x, y| {
            for (label, told) in truth.column(x, y).iter().zip(told.column(x, y)) {
                if *label == b.class.id() {
                    voxels += 1;
                    found += usize::from(is_thing(*told));
                }
            }
        });
    }
    SeenInVoxels {
        id: b.id,
        voxels,
        share: found as f64 / voxels.max(1) as f64,
    }
}

/// Connected voxels of predicted things, farther than 0.8 m from any true thing and from the own vehicle.
fn ghosts(truth: &VoxelGrid, told: &VoxelGrid, scene: &Scene) -> Vec<Ghost> {
    let (map_from_vehicle, vehicle) = (&scene.frame().world_from_ego, &scene.rig);
    let own = |x: usize, y: usize| {
        let at = Window::center(x, y, 0);
        let [length, width, _] = vehicle.ego_size_m;
        let beside_m = BESIDE as f64 * Window::VOXEL_M;
        (at.x - vehicle.ego_center_m[0]).abs() < length / 2.0 + beside_m
            && at.y.abs() < width / 2.0 + beside_m
    };
    let things =
        |grid: &VoxelGrid, x: usize, y: usize| grid.column(x, y).iter().filter(|l| is_thing(**l)).count();
    let reach = |v: usize, side: usize, by: usize| v.saturating_sub(by)..(v + by + 1).min(side);
    let around = |x: usize, y: usize, by: usize| {
        reach(x, Window::NX, by).flat_map(move |x| reach(y, Window::NY, by).map(move |y| (x, y)))
    };
    let stray = |x: usize, y: usize| {
        things(told, x, y) > 0 && !own(x, y) && around(x, y, BESIDE).all(|(x, y)| things(truth, x, y) == 0)
    };
    let columns = (0..Window::COLUMNS).into_par_iter();
    let mut open: Vec<bool> = columns.map(|i| stray(i / Window::NY, i % Window::NY)).collect();
    let mut out = Vec::new();
    for first in 0..open.len() {
        if !std::mem::take(&mut open[first]) {
            continue;
        }
        let (mut next, mut classes) = (vec![first], [0usize; Class::COUNT]);
        let (mut low, mut high) = (DVec3::MAX, DVec3::MIN);
        while let Some(i) = next.pop() {
            let (x, y) = (i / Window::NY, i % Window::NY);
            for (z, label) in told
                .column(x, y)
                .iter()
                .enumerate()
                .filter(|(_, l)| is_thing(**l))
            {
                classes[usize::from(*label)] += 1;
                let middle = Window::center(x, y, z);
                (low, high) = (low.min(middle), high.max(middle));
            }
            for (x, y) in around(x, y, 1) {
                let beside = x * Window::NY + y;
                if std::mem::take(&mut open[beside]) {
                    next.push(beside);
                }
            }
        }
        let voxels: usize = classes.iter().sum();
        let most = (0..Class::COUNT).max_by_key(|c| classes[*c]).unwrap_or_default();
        if let (Some(class), true) = (Class::from_id(most as u8), voxels >= LEAST_GHOST) {
            out.push(Ghost {
                thing: around_ghost(class, (low + high) / 2.0, high - low, map_from_vehicle),
                voxels,
            });
        }
    }
    out.sort_by_key(|g| std::cmp::Reverse(g.voxels));
    out
}

/// A box on the map from the middle of its voxels in the vehicle's frame and the distances between the outer ones, m.
fn around_ghost(class: Class, center_m: DVec3, apart_m: DVec3, map_from_vehicle: &Pose) -> SceneBox {
    let there = SceneBox {
        id: BoxId(0),
        class,
        center_m,
        size_m: apart_m + DVec3::splat(Window::VOXEL_M),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    };
    there.in_frame(map_from_vehicle)
}

/// Classes of boxes: barrier to truck.
fn is_thing(label: u8) -> bool {
    Class::from_id(label).is_some_and(Class::is_object)
}

/// Copies voxels around a vehicle onto a map: each column of the map takes the column of the window in which its middle
/// lies, at the same height.
pub fn on_map(voxels: &VoxelGrid, extent: Extent, map_from_vehicle: &Pose) -> VoxelGrid {
    let of_networks = extent.in_lattice(Lattice::OCC3D);
    if of_networks != extent {
        return voxels_in(&on_map(voxels, of_networks, map_from_vehicle), extent);
    }
    let mut out = VoxelGrid::over(extent);
    let to_vehicle = map_from_vehicle.inverse();
    for x in 0..extent.nx() {
        for y in 0..extent.ny() {
            let at = extent.center(x, y, 0);
            let there = to_vehicle.apply(DVec3::new(at.x, at.y, map_from_vehicle.translation_m.z));
            if let Some([i, j]) = Window::column_at(there.x, there.y) {
                let column = voxels.column(i, j);
                if column.iter().any(|l| *l != Class::FREE) {
                    out.column_mut(x, y).copy_from_slice(column);
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use safetensors::SafeTensors;
    use scene::{Frame, SensorRig};
    use world::World;
    use world::voxelize::{Vertical, complete};

    fn scene() -> Scene {
        let world = World::random(3);
        let grid = complete(&world, Vertical::Occ3d);
        let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
        Scene::single("t", frame, std::sync::Arc::default(), 1)
    }

    /// Pictures of the default rig that any language makes alike, put on voxels as the twin does.
    #[test]
    fn voxels_are_painted_as_the_twin_paints_them() {
        let path = "../../../training/weights/sensor_occupancy/golden.safetensors";
        let bytes = std::fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)).expect("the golden");
        let file = SafeTensors::deserialize(&bytes).expect("a safetensors file");
        let expected = file.tensor("painted").expect("a tensor").data().to_vec();
        let number = |i: u64| {
            let h = (i * 2_654_435_761 + 6 * 40_503 + 12_345) % (1 << 32);
            let h = (h ^ (h >> 15)) * 2_246_822_519 % (1 << 32);
            let u = (h as f64 / 4_294_967_296.0 * 3.5 - 1.75) as f32;
            (((u + 1.75) / 3.5 * 23.0).floor() as u8).min(21)
        };
        let rig = SensorRig::default();
        let px = 256 * 144;
        let classes: Vec<u8> = (0..(rig.cameras.len() * px) as u64).map(number).collect();
        let shown: Vec<CameraClasses<'_>> = rig
            .cameras
            .iter()
            .zip(classes.chunks_exact(px))
            .map(|(camera, classes)| CameraClasses {
                camera,
                size_px: [256, 144],
                classes,
            })
            .collect();
        let found = painted(&shown);
        let every = (0..Window::NX).step_by(8).flat_map(|x| {
            (0..Window::NY)
                .step_by(8)
                .flat_map(move |y| (x * Window::NY + y) * Window::NZ..(x * Window::NY + y + 1) * Window::NZ)
        });
        let found: Vec<u8> = every.map(|i| found[i]).collect();
        assert_eq!(found.len(), expected.len());
        let same = found.iter().zip(&expected).filter(|(a, b)| a == b).count();
        // A middle on the edge of a pixel may fall into the next one.
        assert!(1000 * same >= 999 * found.len(), "{same} of {}", found.len());
    }

    #[test]
    fn both_sensors_tell_most_of_what_is_there() {
        let scene = scene();
        let heard = PerceptionInput::from_scene(&scene).expect("the shipped networks");
        let both = report_of(&scene, &heard, Hears::Both).expect("the shipped network");
        let blind = PerceptionInput {
            returns: Vec::new(),
            painted: vec![UNSEEN; Window::VOXELS],
            ..heard
        };
        let none = report_of(&scene, &blind, Hears::Both).expect("the shipped network");
        assert!(both.iou > 0.4 && both.right > 0.7, "{} {}", both.iou, both.right);
        assert!(both.iou > none.iou + 0.1, "{} {}", both.iou, none.iou);
        let missed = both.boxes.iter().filter(|b| b.is_missed()).count();
        assert!(3 * missed <= both.boxes.len(), "{missed} of {}", both.boxes.len());
        assert!(both.boxes.is_sorted_by_key(|b| !b.is_missed()));
        let id = both.boxes.last().expect("a box").id;
        let alone = sight(&scene, id)
            .expect("the shipped network")
            .expect("in the window");
        assert_eq!(Some(&alone), both.boxes.last());
        assert_eq!(sight(&scene, BoxId(9999)).expect("a network"), None);
    }

    #[test]
    fn what_stands_where_nothing_is_counts_as_one() {
        let (truth, mut told) = (VoxelGrid::new(), VoxelGrid::new());
        for (x, y) in [(10, 10), (11, 11), (101, 100), (102, 100)] {
            (1..4).for_each(|z| told.set(x, y, z, Class::Car.id()));
        }
        told.set(60, 60, 1, Class::Car.id());
        told.set(12, 12, 1, Class::Truck.id());
        told.set(90, 90, 1, Class::Manmade.id());
        let mut map = scene();
        map.change_canvas(|canvas| canvas.world_from_ego = Pose::planar(100.0, 0.0, 0.0));
        // One is the own vehicle, another too small.
        let found = ghosts(&truth, &told, &map);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!((found[0].thing.class, found[0].voxels), (Class::Car, 7));
        let thing = found[0].thing;
        assert!((thing.center_m.x - (100.0 + Window::center(11, 0, 0).x)).abs() < 1e-9);
        assert!(thing.size_m.distance(DVec3::new(1.2, 1.2, 1.2)) < 1e-9);
        let mut near = truth.clone();
        near.set(12, 10, 0, Class::Pedestrian.id());
        assert_eq!(ghosts(&near, &told, &map), []);
    }

    #[test]
    fn what_is_told_lies_around_the_vehicle_on_the_map() {
        let mut told = VoxelGrid::new();
        told.set(150, 100, 3, Class::Car.id());
        let pose = Pose::planar(200.0, 40.0, std::f64::consts::FRAC_PI_2);
        let extent = Extent::new([0, 0], [800, 400]).expect("an extent");
        let map = on_map(&told, extent, &pose);
        assert_eq!(map.count_set(), 1);
        let (x, y, z, label) = map.iter_set().next().expect("a voxel");
        let expected = pose.apply(Window::center(150, 100, 3));
        let found = extent.center(x, y, z);
        assert!(
            found.truncate().distance(expected.truncate()) < 0.4,
            "{found} {expected}"
        );
        assert_eq!((z, label), (3, Class::Car.id()));
    }
}
