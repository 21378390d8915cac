//! Drives through procedural worlds with realistic traffic: training and test data of the temporal networks.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use safetensors::tensor::Dtype;

use super::large::{occupancy_over, scenery_over};
use dataset::shard::Shard;
use editor::Apply;
use editor::lanes::nearest_lane;
use editor::traffic::{Template, Wish, motion_of};
use scene::clip::{Path, Speed};
use scene::draw::Draw;
use scene::{
    Background, BevLayout, BoxId, Class, Edit, Extent, Frame, Motion, Pose, Scene, SceneBox, SensorRig,
    VoxelGrid, Window, draft, raster,
};
use world::draw::hash;
use world::terrain::Terrain;
use world::{template, traffic};

/// Frames of a drive.
pub const FRAMES: usize = 8;
/// Time between two of them, s: that of labelled frames of public data sets.
pub const STEP_S: f64 = 0.5;
/// Distance from the middle of a lane within which a vehicle drives in the lane, m; parked vehicles stand farther from
/// it.
const IN_LANE_M: f64 = 1.0;

/// A frame of a drive, along the axes of its ego vehicle.
pub struct DriveFrame {
    /// Every voxel of the world.
    pub dense: VoxelGrid,
    /// Map layers.
    pub layout: BevLayout,
    /// Objects.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    /// Place of the vehicle on the ground of the first frame: x and y in m, heading in rad.
    pub pose: [f64; 3],
}

/// A drive: in data sets [`FRAMES`] frames.
pub struct Drive(pub Vec<DriveFrame>);

/// Most frames of a drive.
const MOST_FRAMES: usize = 32;
/// Columns by which the view of a vehicle grows with each frame, at 15 m/s.
const COLUMNS_PER_FRAME: usize = 19;

/// The map of a drive: the window and the ground that comes into view, at 15 m/s and around a bend.
fn map(frames: usize) -> Extent {
    let more = frames.saturating_sub(FRAMES) * COLUMNS_PER_FRAME;
    let size = [440 + more, 360 + more];
    Extent::new([-150, -180 - (more / 2) as i32], size).unwrap_or(Extent::WINDOW)
}

/// The world of drive `index` of the data set of `seed` as a clip. `roads` as for
/// [`world_of`](dataset::world_of).
pub fn drive_scene(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> Scene {
    drive_scene_of(seed, index, FRAMES, roads)
}

/// The scene of [`drive_scene`] with a given number of frames, 2 to 32. Drives of different lengths have different
/// contents.
pub fn drive_scene_of(
    seed: u64,
    index: u64,
    frames: usize,
    roads: impl Fn(u64) -> Option<BevLayout>,
) -> Scene {
    let frames = frames.clamp(2, MOST_FRAMES);
    let seed = hash(hash(seed ^ 0xd41_7e5) ^ index);
    let mut near = roads(seed).unwrap_or_else(|| template::any_layout(seed));
    near.relief = match near.relief.is_flat() {
        true => Terrain::drawn(seed).relief(&near, seed),
        false => near.relief,
    };
    let layout = near.crop_continued(map(frames));
    let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
    let (background, _) = scenery_over(&layout, &boxes, Background::default(), seed);
    let occupancy = occupancy_over(&layout, &boxes, &background, seed);
    let frame = Frame::new(layout, boxes, occupancy);
    let mut scene = Scene::single("drive", frame, SensorRig::default().into(), seed);
    let length_s = (frames - 1) as f64 * STEP_S;
    let edits = [Edit::SetLength {
        length_s,
        rate_hz: Some(1.0 / STEP_S),
    }];
    edits.iter().for_each(|edit| apply(&mut scene, edit));
    let mut draw = Draw::new(seed, "drive");
    let mps = match draw.chance(0.15) {
        true => 0.0,
        false => draw.range(3.0, 14.0),
    };
    let boxes: Vec<SceneBox> = scene.canvas().boxes.values().copied().collect();
    let in_lane: Vec<(SceneBox, f64)> = boxes
        .iter()
        .filter_map(|b| Some((*b, lane_speed(&scene, b, &mut draw)?)))
        .collect();
    // All vehicles drive first, so that followers then find the others moving.
    drive(&mut scene, None, Template::Drive, mps, &mut draw);
    for (b, mps) in &in_lane {
        drive(&mut scene, Some(b.id), Template::Drive, *mps, &mut draw);
    }
    drive(&mut scene, None, Template::Follow, mps, &mut draw);
    for (b, mps) in &in_lane {
        let kinds = [Template::Follow, Template::Stop, Template::CutIn, Template::Park];
        let kind = kinds[draw.weighted(&[0.82, 0.08, 0.05, 0.05])];
        drive(&mut scene, Some(b.id), kind, *mps, &mut draw);
    }
    for b in &boxes {
        if in_lane.iter().all(|(other, _)| other.id != b.id) {
            beside_the_lanes(&mut scene, b, &mut draw);
        }
    }
    scene
}

/// The desired speed of a vehicle in a lane, m/s; two thirds of the standing ones want to drive too. `None` for all
/// other boxes.
fn lane_speed(scene: &Scene, b: &SceneBox, draw: &mut Draw) -> Option<f64> {
    if !b.class.is_vehicle() {
        return None;
    }
    nearest_lane(&scene.canvas().layout, b.center_m.truncate(), IN_LANE_M)?;
    let mps = b.velocity_mps.length();
    match mps > 0.0 {
        true => Some(mps),
        false => draw.chance(0.66).then(|| draw.range(3.0, 12.0)),
    }
}

/// Makes a box beside the lanes move as usual for its kind: pedestrians walk on, or across the road; now and then a
/// parked vehicle drives off.
fn beside_the_lanes(scene: &mut Scene, b: &SceneBox, draw: &mut Draw) {
    let mps = b.velocity_mps.length();
    if b.class.is_vehicle() {
        if draw.chance(0.03) {
            let mps = draw.range(3.0, 8.0);
            drive(scene, Some(b.id), Template::PullOut, mps, draw);
        }
    } else if mps > 0.0 && b.class == Class::Pedestrian && draw.chance(0.12) {
        drive(scene, Some(b.id), Template::Cross, mps.max(1.0), draw);
    } else if mps > 0.0 {
        let from = b.center_m.truncate();
        let path = Path {
            points_m: vec![from, from + DVec2::from_angle(b.yaw_rad) * 60.0],
            start_m: 0.0,
            speeds: vec![Speed { time_s: 0.0, mps }],
            rear_first: false,
        };
        let motion = Edit::SetMotion {
            id: Some(b.id),
            motion: Some(Motion::Path(path)),
            from_s: None,
            to_s: None,
        };
        apply(scene, &motion);
    }
}

/// Gives a box a motion by template, if the place allows it.
fn drive(scene: &mut Scene, id: Option<BoxId>, template: Template, mps: f64, draw: &mut Draw) {
    let wish = Wish {
        template,
        mps,
        at_s: draw.range(0.0, 2.0),
        over_s: draw.range(2.0, 3.5),
        gap_m: None,
        keeps_up: false,
    };
    for edit in motion_of(scene, id, &wish).into_iter().flatten() {
        apply(scene, &edit);
    }
}

fn apply(scene: &mut Scene, edit: &Edit) {
    // A motion that is not possible there is left out.
    let _ = edit.apply(scene);
}

/// The frames of a clip at [`STEP_S`], each along the axes of its ego vehicle. Heights are those of the map.
pub fn frames_of(scene: &Scene) -> Drive {
    let frame = |i: usize| {
        let view = scene.at(i as f64 * STEP_S);
        let pose = view.frame().world_from_ego;
        let yaw_rad = (pose.rotation * DVec3::X).truncate().to_angle();
        let at_m = pose.translation_m.truncate();
        let mut still = view.still();
        still.change_canvas(|canvas| canvas.world_from_ego = Pose::planar(at_m.x, at_m.y, yaw_rad));
        let in_ego = still.in_ego();
        let seen = in_ego.frame().crop(Extent::WINDOW);
        DriveFrame {
            dense: seen.occupancy,
            layout: seen.layout,
            boxes: seen.boxes,
            pose: [at_m.x, at_m.y, yaw_rad],
        }
    };
    let frames = (scene.clip().length_s / STEP_S).round() as usize + 1;
    Drive((0..frames).map(frame).collect())
}

impl Shard for Drive {
    const ARRAYS: &'static [&'static str] = &["dense", "draft", "bev", "heading", "pose"];

    /// u8 `dense` and `draft` `[N,8,200,200,16]`, i32 `bev` and u8 `heading` `[N,8,200,200]`, f32 `pose` `[N,8,3]`.
    fn arrays(drives: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let frames = || drives.iter().flat_map(|drive| &drive.0);
        let columns = vec![FRAMES, Window::NX, Window::NY];
        let grid = [columns.clone(), vec![Window::NZ]].concat();
        let draft = frames().flat_map(|f| draft::draft(&f.layout, f.boxes.values()).to_dense());
        let bev = frames().flat_map(|f| raster::bev_channels(&f.layout, f.boxes.values()));
        let heading = frames().flat_map(|f| raster::headings(Extent::WINDOW, f.boxes.values()));
        let pose = frames().flat_map(|f| f.pose);
        vec![
            (
                Dtype::U8,
                grid.clone(),
                frames().flat_map(|f| f.dense.to_dense()).collect(),
            ),
            (Dtype::U8, grid, draft.collect()),
            (
                Dtype::I32,
                columns.clone(),
                bev.flat_map(u32::to_le_bytes).collect(),
            ),
            (Dtype::U8, columns, heading.collect()),
            (
                Dtype::F32,
                vec![FRAMES, 3],
                pose.flat_map(|v| (v as f32).to_le_bytes()).collect(),
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Standing objects have the same voxels in every frame, seen from elsewhere; moving objects move.
    #[test]
    fn a_drive_shows_one_world() {
        let scene = drive_scene(9, 1, |_| None);
        let drive = frames_of(&scene);
        assert_eq!(drive.0.len(), FRAMES);
        let way_m = |f: &DriveFrame| f.pose[0].hypot(f.pose[1]);
        assert!(drive.0.windows(2).all(|pair| way_m(&pair[1]) >= way_m(&pair[0])));
        assert!(!scene.clip().tracks.is_empty(), "nothing moves");
        let standing: Vec<_> = scene.canvas().boxes.keys().collect();
        let (first, last) = (&drive.0[0], &drive.0[FRAMES - 1]);
        let moved = first.boxes.iter().filter(|(id, b)| {
            let now = last.boxes.get(id).map(|b| b.velocity_mps);
            !standing.contains(id) && now.is_some() && b.velocity_mps.length() > 0.0
        });
        assert!(moved.count() > 0);
        let again = Drive::arrays(&[frames_of(&drive_scene(9, 1, |_| None))]);
        let here = Drive::arrays(&[drive]);
        assert!(again.iter().zip(&here).all(|(a, b)| a.2 == b.2));
        assert_eq!(here[0].2.len(), FRAMES * Window::VOXELS);
        assert_eq!(here[4].1, [FRAMES, 3]);
    }
}
