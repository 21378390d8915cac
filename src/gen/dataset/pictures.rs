//! Frames with camera pictures and the truth about each pixel, for networks that see or make pictures.

use glam::{DMat4, DVec3};
use safetensors::tensor::Dtype;

use super::{Shard, VOXELS, voxels, world_of};
use scene::{
    BevLayout, CameraTruth, Conditions, Extent, Frame, SensorRig, TimeOfDay, VoxelGrid, Weather, raster,
};
use sensors::appearance::{Appearance, Quality};
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// Steps of a depth, m; 0 where there is none.
const DEPTH_STEP_M: f32 = 0.01;

/// One frame: a world under some light and weather, seen by the six cameras of the default rig.
pub struct PictureFrame {
    /// Every voxel of the world, in the vertical convention of labels.
    pub dense: VoxelGrid,
    /// Map layers and boxes as bits of each column.
    pub bev: Vec<u32>,
    /// Light and air.
    pub conditions: Conditions,
    /// Of each camera, sRGB, three bytes a pixel.
    pub rgb: Vec<Vec<u8>>,
    /// Of each camera.
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
    let rig = SensorRig::default();
    let mut draw = Draw::new(seed, "pictures");
    let time = TimeOfDay::ALL[draw.weighted(&[0.15, 0.5, 0.15, 0.2])];
    let weather = Weather::ALL[draw.weighted(&[0.4, 0.2, 0.2, 0.08, 0.08, 0.04])];
    let conditions = Conditions::usual(time, weather, seed);
    let appearance = Appearance::new(&frame, &rig, &conditions);
    let seen = rig
        .cameras
        .iter()
        .map(|camera| appearance.render_truth(camera, size_px, Quality::Full, &frame.boxes, None));
    let (rgb, truth) = seen
        .map(|(image, truth)| {
            let rgb = image.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]);
            (rgb.collect(), truth)
        })
        .unzip();
    PictureFrame {
        bev: raster::bev_channels(&frame.layout, frame.boxes.values()),
        dense: frame.occupancy,
        conditions,
        rgb,
        truth,
    }
}

impl Shard for PictureFrame {
    const ARRAYS: &'static [&'static str] = &[
        "rgb",
        "class",
        "instance",
        "depth",
        "normal",
        "intrinsic",
        "ego_from_camera",
        "dense",
        "bev",
        "conditions",
    ];

    /// Of each camera u8 `rgb` `[N,6,h,w,3]`, `class` `[N,6,h,w]` (see [`scene::truth`]), u16 `instance` (box id, 0 none) and
    /// `depth` (cm along the optical axis, 0 none), i8 `normal` `[N,6,h,w,3]` (127ths, optical frame), f32 `intrinsic`
    /// `[N,6,3,3]` (px) and `ego_from_camera` `[N,6,4,4]`; u8 `dense` `[N,200,200,16]`, i32 `bev` `[N,200,200]`; u8
    /// `conditions` `[N,2]`: time of day and weather by their place in the lists.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let first = frames.first().and_then(|f| f.truth.first());
        let [h, w] = first.map_or([0, 0], |t| [t.height, t.width]);
        let cameras = frames.first().map_or(0, |f| f.truth.len());
        let image = vec![cameras, h, w];
        let truths = || frames.iter().flat_map(|f| &f.truth);
        let pixels = || truths().flat_map(|t| &t.pixels);
        let floats = |values: Vec<f64>| {
            values
                .into_iter()
                .flat_map(|v| (v as f32).to_le_bytes())
                .collect()
        };
        let depth = |m: f32| (m / DEPTH_STEP_M).round().clamp(0.0, 65535.0) as u16;
        let instance = |id: u32| u16::try_from(id).unwrap_or(u16::MAX);
        let with = |last: &[usize]| [vec![cameras], last.to_vec()].concat();
        let place = |f: &Self| {
            let time = TimeOfDay::ALL.iter().position(|t| *t == f.conditions.time);
            let weather = Weather::ALL.iter().position(|w| *w == f.conditions.weather);
            [time, weather].map(|i| i.unwrap_or_default() as u8)
        };
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
                floats(truths().flat_map(ego_from_camera).collect()),
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
            (Dtype::U8, vec![2], frames.iter().flat_map(place).collect()),
        ]
    }
}

/// Row-major 3 x 3, px.
fn intrinsic(truth: &CameraTruth) -> [f64; 9] {
    let ([fx, fy], [cx, cy]) = (truth.camera.focal_px, truth.camera.center_px);
    [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
}

/// Row-major 4 x 4.
fn ego_from_camera(truth: &CameraTruth) -> [f64; 16] {
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
}
