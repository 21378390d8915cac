//! Frames with camera pictures and the truth about each pixel, for networks that read or draw pictures.

use glam::{DMat4, DVec2, DVec3};
use safetensors::tensor::Dtype;

use super::{Shard, VOXELS, voxels, world_of};
use scene::{
    Background, BevLayout, Camera, CameraTruth, Class, Conditions, Extent, Frame, PolylineKind, Pose,
    SceneBox, SensorRig, TimeOfDay, VoxelGrid, Weather, raster,
};
use sensors::pictures::appearance::{Appearance, Quality};
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// Distance between two places that are tried on a lane, m.
const STEP_M: f64 = 2.0;
/// Distance from the rear axle to the vehicle's middle, and free distance to a box around it, m.
const MIDDLE_M: f64 = 1.4;
const REACH_M: f64 = 5.5;
/// Unit of stored depths, m; a stored 0 means no depth.
pub(super) const DEPTH_STEP_M: f32 = 0.01;

/// One frame: a world under some light and weather, seen by the six cameras of the default rig from a free place on a lane.
pub struct PictureFrame {
    /// Every voxel of the world, in the vertical convention of labels.
    pub dense: VoxelGrid,
    /// Map layers and boxes as bits of each column.
    pub bev: Vec<u32>,
    /// Light and weather.
    pub conditions: Conditions,
    /// Picture of each camera, sRGB, three bytes a pixel.
    pub rgb: Vec<Vec<u8>>,
    /// Truth about the pixels of each camera.
    pub truth: Vec<CameraTruth>,
}

/// Frame `index` of the data set of `seed` at a size in pixels; the same arguments give the same frame.
pub fn picture_frame(
    seed: u64,
    index: u64,
    size_px: [u32; 2],
    roads: impl Fn(u64) -> Option<BevLayout>,
) -> PictureFrame {
    let (world, seed) = world_of(seed, index, roads);
    let frame = Frame::new(
        world.layout.clone(),
        world.boxes.clone(),
        complete(&world, Vertical::Occ3d),
    );
    let rig = SensorRig::default().standing_at(&ego_pose(&frame));
    let mut draw = Draw::new(seed, "pictures");
    let time = TimeOfDay::ALL[draw.weighted(&[0.15, 0.5, 0.15, 0.2])];
    let weather = Weather::ALL[draw.weighted(&[0.4, 0.2, 0.2, 0.08, 0.08, 0.04])];
    let conditions = Conditions::usual(time, weather, seed);
    let (rgb, truth) = rendered(
        (&frame, &world.background),
        &rig,
        &conditions,
        (size_px, Quality::Full),
    );
    PictureFrame {
        bev: raster::bev_channels(&frame.layout, frame.boxes.values()),
        dense: frame.occupancy,
        conditions,
        rgb,
        truth,
    }
}

/// Pictures of the cameras of a rig, sRGB, three bytes a pixel, and the truth about their pixels, at a size in pixels. Scenery is
/// drawn as the things that it is.
pub(super) fn rendered(
    (frame, background): (&Frame, &Background),
    rig: &SensorRig,
    conditions: &Conditions,
    (size_px, quality): ([u32; 2], Quality),
) -> (Vec<Vec<u8>>, Vec<CameraTruth>) {
    let appearance = Appearance::with_things(frame, background, rig, conditions);
    let of = |camera: &Camera| {
        let (image, truth) = appearance.render_truth(camera, size_px, quality, &frame.boxes, None);
        let rgb = image.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]);
        (rgb.collect(), truth)
    };
    rig.cameras.iter().map(of).unzip()
}

/// The free pose on a lane that is nearest to the middle of the map; the middle if there is none.
fn ego_pose(frame: &Frame) -> Pose {
    let layout = &frame.layout;
    let lanes = layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    let places = lanes.flat_map(|lane| {
        lane.points_m.windows(2).flat_map(|pair| {
            let (from, way) = (pair[0], pair[1] - pair[0]);
            let steps = (way.length() / STEP_M).ceil().max(1.0) as usize;
            (0..steps).map(move |i| (from + way * (i as f64 / steps as f64), way.to_angle()))
        })
    });
    let free = places.filter(|(at, yaw)| is_free(frame, *at, *yaw));
    let nearest = free.min_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()));
    nearest.map_or(Pose::IDENTITY, |(at, yaw)| match layout.relief.is_flat() {
        true => Pose::planar(at.x, at.y, yaw),
        false => layout.relief.pose_on(at, yaw),
    })
}

/// True if a vehicle has room there: no box within reach, and only ground in its footprint.
pub(super) fn is_free(frame: &Frame, at: DVec2, yaw: f64) -> bool {
    let (ahead, extent) = (DVec2::from_angle(yaw), frame.extent());
    let is_near = |b: &SceneBox| {
        let reach = (b.size_m.truncate().length() + REACH_M) / 2.0;
        b.center_m.truncate().distance(at + ahead * MIDDLE_M) < reach
    };
    let foot = (-1..=4).flat_map(|x| (-1..=1).map(move |y| (f64::from(x), f64::from(y))));
    let is_ground = |(x, y): (f64, f64)| {
        let p = at + ahead * x + ahead.perp() * y;
        let Some([i, j]) = extent.column_at(p.x, p.y) else {
            return false;
        };
        let ground =
            |label: &u8| *label == Class::FREE || Class::from_id(*label).is_some_and(Class::is_ground);
        frame.occupancy.column(i, j).iter().all(ground)
    };
    !frame.boxes.values().any(is_near) && foot.into_iter().all(is_ground)
}

impl Shard for PictureFrame {
    const ARRAYS: &'static [&'static str] = &[
        "rgb",
        "class",
        "instance",
        "depth",
        "normal",
        "intrinsic",
        "map_from_camera",
        "dense",
        "bev",
        "conditions",
    ];

    /// For each camera u8 `rgb` `[N,6,h,w,3]`, `class` `[N,6,h,w]` (see [`scene::truth`]), u16 `instance` (box id, 0
    /// none) and `depth` (cm along the optical axis, 0 none), i8 `normal` `[N,6,h,w,3]` (127ths, optical frame), f32
    /// `intrinsic` `[N,6,3,3]` (px) and `map_from_camera` `[N,6,4,4]`; u8 `dense` `[N,200,200,16]`, i32 `bev`
    /// `[N,200,200]`; u8 `conditions` `[N,2]`: time of day and weather by their place in the lists.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let first = frames.first().and_then(|f| f.truth.first());
        let [h, w] = first.map_or([0, 0], |t| [t.height, t.width]);
        let cameras = frames.first().map_or(0, |f| f.truth.len());
        let image = vec![cameras, h, w];
        let truths = || frames.iter().flat_map(|f| &f.truth);
        let pixels = || truths().flat_map(|t| &t.pixels);
        let depth = |m: f32| (m / DEPTH_STEP_M).round().clamp(0.0, 65535.0) as u16;
        let instance = |id: u32| u16::try_from(id).unwrap_or(u16::MAX);
        let with = |last: &[usize]| [vec![cameras], last.to_vec()].concat();
        vec![
            (
                Dtype::U8,
                [image.clone(), vec![3]].concat(),
                frames
                    .iter()
                    .flat_map(|f| f.rgb.iter().flatten().copied())
                    .collect(),
            ),
            (Dtype::U8, image.clone(), pixels().map(|p| p.class).collect()),
            (
                Dtype::U16,
                image.clone(),
                pixels()
                    .flat_map(|p| instance(p.instance).to_le_bytes())
                    .collect(),
            ),
            (
                Dtype::U16,
                image.clone(),
                pixels().flat_map(|p| depth(p.depth_m).to_le_bytes()).collect(),
            ),
            (
                Dtype::I8,
                [image, vec![3]].concat(),
                pixels()
                    .flat_map(|p| p.normal_in_camera.map(|v| ((v * 127.0).round() as i8) as u8))
                    .collect(),
            ),
            (
                Dtype::F32,
                with(&[3, 3]),
                floats(truths().flat_map(intrinsic).collect()),
            ),
            (
                Dtype::F32,
                with(&[4, 4]),
                floats(truths().flat_map(map_from_camera).collect()),
            ),
            (
                Dtype::U8,
                VOXELS.to_vec(),
                voxels(frames.iter().map(|f| &f.dense)),
            ),
            (
                Dtype::I32,
                vec![Extent::WINDOW.nx(), Extent::WINDOW.ny()],
                frames
                    .iter()
                    .flat_map(|f| f.bev.iter().flat_map(|v| v.to_le_bytes()))
                    .collect(),
            ),
            (
                Dtype::U8,
                vec![2],
                frames.iter().flat_map(|f| place_of(&f.conditions)).collect(),
            ),
        ]
    }
}

/// Values as f32, little-endian.
pub(super) fn floats(values: Vec<f64>) -> Vec<u8> {
    let bytes = |v: f64| (v as f32).to_le_bytes();
    values.into_iter().flat_map(bytes).collect()
}

/// Time of day and weather by their place in the lists.
pub(super) fn place_of(conditions: &Conditions) -> [u8; 2] {
    let time = TimeOfDay::ALL.iter().position(|t| *t == conditions.time);
    let weather = Weather::ALL.iter().position(|w| *w == conditions.weather);
    [time, weather].map(|i| i.unwrap_or_default() as u8)
}

/// Row-major 3 x 3, px.
pub(super) fn intrinsic(truth: &CameraTruth) -> [f64; 9] {
    let ([fx, fy], [cx, cy]) = (truth.camera.focal_px, truth.camera.center_px);
    [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
}

/// Row-major 4 x 4.
pub(super) fn map_from_camera(truth: &CameraTruth) -> [f64; 16] {
    let [w, x, y, z] = truth.camera.rotation_wxyz;
    let rotation = glam::DQuat::from_xyzw(x, y, z, w);
    let at = DVec3::from(truth.camera.translation_m);
    DMat4::from_rotation_translation(rotation, at)
        .transpose()
        .to_cols_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_with_their_truth() {
        let frames: Vec<PictureFrame> = (0..2).map(|i| picture_frame(4, i, [64, 36], |_| None)).collect();
        let arrays = PictureFrame::arrays(&frames);
        assert_eq!(arrays.len(), PictureFrame::ARRAYS.len());
        for ((dtype, shape, bytes), name) in arrays.iter().zip(PictureFrame::ARRAYS) {
            let bits = 2 * shape.iter().product::<usize>() * dtype.bitsize();
            assert_eq!(8 * bytes.len(), bits, "{name}");
        }
        assert_eq!(arrays[0].1, [6, 36, 64, 3]);
        let again = picture_frame(4, 1, [64, 36], |_| None);
        assert!(again.rgb == frames[1].rgb && again.conditions == frames[1].conditions);
        // The road ahead is road, near below the picture's middle, and its normal points up.
        let front = frames[0]
            .truth
            .iter()
            .find(|t| t.camera.name == "CAM_FRONT")
            .expect("a front camera");
        let below = front.pixels[33 * 64 + 32];
        assert!(
            below.class > 0 && below.depth_m > 1.0 && below.depth_m < 60.0,
            "{below:?}"
        );
    }

    /// Seed 3 has a building in the middle of its first map.
    #[test]
    fn the_vehicle_stands_on_a_lane_and_in_nothing() {
        for i in 0..6 {
            let frame = picture_frame(3, i, [64, 36], |_| None);
            for truth in &frame.truth {
                let near = truth
                    .pixels
                    .iter()
                    .filter(|p| p.depth_m > 0.0 && p.depth_m < 0.8)
                    .count();
                assert!(
                    near < 64 * 36 / 20,
                    "frame {i}, {}: {near} pixels before the lens",
                    truth.camera.name
                );
            }
        }
        let at = |camera: &scene::Camera| DVec3::from(camera.translation_m).truncate();
        let moved = picture_frame(3, 0, [16, 9], |_| None);
        assert!(at(&moved.truth[1].camera).distance(at(&SensorRig::default().cameras[1])) > 1.0);
    }
}
