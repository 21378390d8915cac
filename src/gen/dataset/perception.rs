//! Frames for perception networks: one LiDAR sweep, the boxes around it, and the classes that stand in each column.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use safetensors::tensor::Dtype;

use super::pictures::floats;
use super::{Shard, world_of};
use nets::lidar::LidarNet;
use nets::perceiver::stands::standing;
use scene::{BevLayout, BoxId, Class, Extent, LidarPattern, LidarPoint, SceneBox, SensorRig, VoxelGrid};
use sensors::lidar::direction_in_sensor;
use sensors::lidar::learned::Drops;
use sensors::lidar::truth::{self, Echo};
use sensors::lidar::{self, learned};
use world::World;
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// Largest number of boxes of a frame; unused ones are 0.
pub const BOXES: usize = 128;
/// Step of the coordinates of points, m.
pub const POINT_STEP_M: f64 = 0.005;
/// Distance outside a box up to which a point of its class counts as on it, m.
const MARGIN_M: f64 = 0.3;

/// The program's LiDAR that made a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum SweepSource {
    /// Exact surfaces with the noise, echo strengths and lost echoes of a sensor.
    Surfaces = 0,
    /// The learned LiDAR over the voxels.
    Learned = 1,
    /// The exact LiDAR over the voxels: ground two bins low, no echo strengths.
    Voxels = 2,
}

/// A return of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Position in the ego frame, m.
    pub at_m: DVec3,
    /// Strength of the echo, 0 to 255.
    pub intensity: f32,
    /// Class of the surface that was hit.
    pub class: Class,
}

/// One frame.
pub struct PerceptionFrame {
    /// The LiDAR that made the sweep.
    pub source: SweepSource,
    /// The returns in the window.
    pub points: Vec<Return>,
    /// Boxes whose centre lies in the window, each with the number of returns on it.
    pub boxes: Vec<(SceneBox, usize)>,
    /// See [`standing`].
    pub standing: Vec<u8>,
}

/// Frame `index` of the data set of `seed`; the same arguments give the same frame. A third of the frames come from the
/// learned LiDAR if its weights can be read.
pub fn perception_frame(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> PerceptionFrame {
    let (world, seed) = world_of(seed, index, roads);
    let grid = complete(&world, Vertical::Occ3d);
    swept(&world, &grid, seed)
}

/// A world as one of the program's LiDARs sees it; `grid` holds its voxels.
pub(super) fn swept(world: &World, grid: &VoxelGrid, seed: u64) -> PerceptionFrame {
    let mut draw = Draw::new(seed, "perception");
    let rig = mounted(&mut draw);
    let wanted =
        [SweepSource::Surfaces, SweepSource::Learned, SweepSource::Voxels][draw.weighted(&[0.5, 0.33, 0.17])];
    let (source, points) = match wanted {
        SweepSource::Surfaces => (wanted, surfaces(world, &rig.lidars[0], seed)),
        SweepSource::Voxels => (wanted, voxels(grid, &rig)),
        SweepSource::Learned => match learned_returns(grid, &rig, seed) {
            Some(points) => (wanted, points),
            None => (SweepSource::Voxels, voxels(grid, &rig)),
        },
    };
    PerceptionFrame::new(source, points, &world.boxes, grid)
}

/// The default rig, in every other frame with its LiDAR mounted a little differently.
fn mounted(draw: &mut Draw) -> SensorRig {
    let mut rig = SensorRig::default();
    if draw.chance(0.5) {
        let pattern = &mut rig.lidars[0];
        let [x, y, z] = pattern.translation_m;
        pattern.translation_m = [
            x + draw.range(-0.6, 0.6),
            y + draw.range(-0.5, 0.5),
            z + draw.range(-0.3, 0.4),
        ];
        let turn = DQuat::from_rotation_z(draw.range(-3.2, 3.2))
            * DQuat::from_rotation_x(draw.range(-0.02, 0.02))
            * DQuat::from_rotation_y(draw.range(-0.02, 0.02));
        pattern.rotation_wxyz = [turn.w, turn.x, turn.y, turn.z];
    }
    rig
}

/// Returns of the exact surfaces, those of the vehicle's own roof included.
fn surfaces(world: &World, pattern: &LidarPattern, seed: u64) -> Vec<Return> {
    let pose = pattern.ego_from_sensor();
    let columns = pattern.columns as usize;
    let of = |(i, ray): (usize, &truth::TruthRay)| {
        let direction = direction_in_sensor(
            pattern.elevations_deg[i / columns],
            pattern.azimuth_rad((i % columns) as u32),
        );
        let (range_m, class) = match ray.echo {
            Echo::Return => (ray.range_m, ray.class),
            Echo::OwnBody if ray.own_body_m > 0.0 => (ray.own_body_m, Class::Others),
            _ => return None,
        };
        Some(Return {
            at_m: pose.translation_m + pose.rotation * direction * f64::from(range_m),
            intensity: f32::from(ray.intensity),
            class,
        })
    };
    truth::sweep(world, pattern, seed)
        .iter()
        .enumerate()
        .filter_map(of)
        .collect()
}

fn voxels(grid: &VoxelGrid, rig: &SensorRig) -> Vec<Return> {
    let sweep = lidar::rig_sweep(grid, rig).unwrap_or_default();
    sweep.points.iter().map(of_point).collect()
}

fn learned_returns(grid: &VoxelGrid, rig: &SensorRig, seed: u64) -> Option<Vec<Return>> {
    let net = LidarNet::bundled().ok()?;
    let sweep = learned::rig_sweep(&net, grid, rig, Drops::Drawn(seed)).ok()?;
    Some(sweep.points.iter().map(of_point).collect())
}

fn of_point(point: &LidarPoint) -> Return {
    Return {
        at_m: glam::Vec3::from(point.position_in_ego).as_dvec3(),
        intensity: point.intensity,
        class: point.class,
    }
}

impl PerceptionFrame {
    /// A frame of a sweep in a scene; returns and boxes outside the window are left out.
    pub fn new(
        source: SweepSource,
        mut points: Vec<Return>,
        boxes: &BTreeMap<BoxId, SceneBox>,
        grid: &VoxelGrid,
    ) -> Self {
        let inside = |p: DVec3| Extent::WINDOW.column_at(p.x, p.y).is_some();
        points.retain(|p| p.at_m.is_finite() && inside(p.at_m));
        let count = |b: &SceneBox| {
            let reach = b.size_m.truncate() / 2.0 + MARGIN_M;
            let on =
                |p: &&Return| p.class == b.class && b.to_local(p.at_m).truncate().abs().cmple(reach).all();
            points.iter().filter(on).count()
        };
        let near = boxes.values().filter(|b| inside(b.center_m)).take(BOXES);
        let boxes = near.map(|b| (*b, count(b))).collect();
        Self {
            source,
            points,
            boxes,
            standing: standing(&grid.crop(Extent::WINDOW)),
        }
    }

    /// Arrays of frames, as the trait describes them.
    pub(super) fn columns(frames: &[&Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let most = frames.iter().map(|f| f.points.len()).max().unwrap_or(0);
        let step = |v: f64| ((v / POINT_STEP_M).round() as i16).to_le_bytes();
        let (mut points, mut intensity, mut boxes) = (Vec::new(), Vec::new(), Vec::new());
        for (i, frame) in frames.iter().enumerate() {
            points.extend(frame.points.iter().flat_map(|p| p.at_m.to_array()).flat_map(step));
            points.resize((i + 1) * most * 6, 0);
            intensity.extend(frame.points.iter().map(|p| p.intensity.round() as u8));
            intensity.resize((i + 1) * most, 0);
            for (b, count) in &frame.boxes {
                boxes.extend(b.center_m.to_array());
                boxes.extend(b.size_m.to_array());
                boxes.extend([b.yaw_rad, f64::from(b.class.id()), *count as f64]);
            }
            boxes.resize((i + 1) * BOXES * 9, 0.0);
        }
        let numbers = |of: fn(&Self) -> usize| {
            let bytes = frames.iter().flat_map(|f| (of(f) as i32).to_le_bytes());
            (Dtype::I32, Vec::new(), bytes.collect())
        };
        vec![
            (
                Dtype::U8,
                Vec::new(),
                frames.iter().map(|f| f.source as u8).collect(),
            ),
            numbers(|f| f.points.len()),
            (Dtype::I16, vec![most, 3], points),
            (Dtype::U8, vec![most], intensity),
            numbers(|f| f.boxes.len()),
            (Dtype::F32, vec![BOXES, 9], floats(boxes)),
            (
                Dtype::U8,
                vec![Extent::WINDOW.nx(), Extent::WINDOW.ny()],
                frames.iter().flat_map(|f| f.standing.iter().copied()).collect(),
            ),
        ]
    }
}

impl Shard for PerceptionFrame {
    const ARRAYS: &'static [&'static str] = &[
        "source",
        "returns",
        "points",
        "intensity",
        "box_count",
        "boxes",
        "standing",
    ];

    /// u8 `source` `[N]`; i32 `returns` `[N]`: number of points that are used; i16 `points` `[N,P,3]` (5 mm, ego frame)
    /// and u8 `intensity` `[N,P]`; i32 `box_count` `[N]`; f32 `boxes` `[N,128,9]`: centre, length, width, height (m),
    /// yaw (rad), class and number of returns on it; u8 `standing` `[N,200,200]`.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        Self::columns(&frames.iter().collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_repeatable_and_boxes_that_are_seen_have_returns() {
        let frames: Vec<PerceptionFrame> = (0..6).map(|i| perception_frame(5, i, |_| None)).collect();
        let arrays = PerceptionFrame::arrays(&frames);
        for ((dtype, shape, bytes), name) in arrays.iter().zip(PerceptionFrame::ARRAYS) {
            let bits = frames.len() * shape.iter().product::<usize>() * dtype.bitsize();
            assert_eq!(8 * bytes.len(), bits, "{name}");
        }
        let again = perception_frame(5, 1, |_| None);
        assert_eq!(again.points, frames[1].points);
        let boxes = || frames.iter().flat_map(|f| &f.boxes);
        let hit = boxes().filter(|(_, returns)| *returns > 0).count();
        assert!(2 * hit > boxes().count(), "{hit} of {}", boxes().count());
        assert!(frames.iter().all(|f| f.points.len() > 5000));
    }
}
