//! Two moments of a drive as six cameras see them, and hints for each pixel from the voxels alone: training data of the
//! network that draws pictures.

use glam::DVec2;
use safetensors::tensor::Dtype;

use super::pictures::{DEPTH_STEP_M, floats, intrinsic, is_free, map_from_camera, place_of, rendered};
use super::{Shard, VOXELS, voxels, world_of};
use scene::{
    Background, BevLayout, Camera, CameraTruth, Conditions, Extent, Frame, PolylineKind, Pose, SensorRig,
    TimeOfDay, VoxelGrid, Weather, Window,
};
pub use sensors::pictures::appearance::Quality;
use sensors::pictures::appearance::light_direction;
use sensors::pictures::picture_hints::{HintedFrame, PictureHints};
use world::World;
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// Number of moments of a frame.
pub const MOMENTS: usize = 2;
/// Range of the distance that the vehicle drives from one moment to the next, m.
const WAY_M: [f64; 2] = [0.5, 2.5];
/// Distance between two places that are tried, m.
const STEP_M: f64 = 1.0;
/// Largest distance of the wanted place from the middle of the map, along x and y, m.
const AROUND_M: f64 = 12.0;
/// Size and quality of pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Width and height, px.
    pub size_px: [u32; 2],
    /// One sample a pixel, or four where it differs from its neighbours.
    pub quality: Quality,
}

/// Pictures, truth and hints of the cameras at one moment.
pub struct PictureMoment {
    /// Picture of each camera, sRGB, three bytes a pixel.
    pub rgb: Vec<Vec<u8>>,
    /// Truth about the pixels of each camera.
    pub truth: Vec<CameraTruth>,
    /// Hints for the pixels of each camera, from the voxels alone.
    pub told: Vec<PictureHints>,
    /// Direction of sun or moon for each camera, a unit vector in the optical frame.
    pub sun: Vec<[f32; 3]>,
}

/// Two moments of a drive through a world that stands still.
pub struct PicturePair {
    /// Every voxel of the world, in the vertical convention of labels.
    pub dense: VoxelGrid,
    /// Light and weather.
    pub conditions: Conditions,
    /// The moments, the earlier one first.
    pub moments: [PictureMoment; MOMENTS],
}

/// Frame `index` of the data set of `seed`; the same arguments give the same frame.
pub fn picture_pair(
    seed: u64,
    index: u64,
    look: Look,
    roads: impl Fn(u64) -> Option<BevLayout>,
) -> PicturePair {
    let (world, seed) = world_of(seed, index, roads);
    let frame = frame_of(&world);
    let teller = HintedFrame::new(&frame);
    let mut draw = Draw::new(seed, "picture pairs");
    let conditions = conditions_of(&mut draw, seed);
    let poses = poses(&frame, &mut draw);
    PicturePair {
        moments: poses.map(|pose| {
            let rig = SensorRig::default().standing_at(&pose);
            seen((&frame, &world.background), &teller, &conditions, &rig, look)
        }),
        dense: frame.occupancy,
        conditions,
    }
}

/// Recorded pictures of six cameras at a moment.
pub struct Recorded<'a> {
    /// The frame that was recorded around them.
    pub frame: &'a Frame,
    /// The cameras in the frame of the map, clockwise, the front one second.
    pub rig: &'a SensorRig,
    /// Their pictures at the size that is asked for, sRGB, three bytes a pixel.
    pub rgb: Vec<Vec<u8>>,
}

/// Two moments of a recorded drive. The truth about its pixels is not known: it is taken from the program's own
/// renderer at the same poses. All values are in the window around the vehicle at the first moment.
pub fn recorded_pair(
    taken: [Recorded<'_>; MOMENTS],
    conditions: Conditions,
    size_px: [u32; 2],
) -> PicturePair {
    let look = Look {
        size_px,
        quality: Quality::Preview,
    };
    let first = taken[0].frame;
    let at_m = first.world_from_ego.translation_m;
    let half = Extent::WINDOW.nx() as i32 / 2;
    let around = [at_m.x, at_m.y].map(|v| (v / Window::VOXEL_M).round() as i32 - half);
    let window = Extent::new(around, [Extent::WINDOW.nx(), Extent::WINDOW.ny()]).unwrap_or(Extent::WINDOW);
    let middle_m = (window.min_m() + window.max_m()).truncate() / 2.0;
    let dense = first.occupancy.crop(window);
    let moments = taken.map(|taken| {
        let teller = HintedFrame::new(taken.frame);
        let bare = Background::default();
        let mut seen = seen((taken.frame, &bare), &teller, &conditions, taken.rig, look);
        seen.rgb = taken.rgb;
        for truth in &mut seen.truth {
            truth.camera.translation_m[0] -= middle_m.x;
            truth.camera.translation_m[1] -= middle_m.y;
        }
        seen
    });
    PicturePair {
        dense,
        conditions,
        moments,
    }
}

fn frame_of(world: &World) -> Frame {
    Frame::new(
        world.layout.clone(),
        world.boxes.clone(),
        complete(world, Vertical::Occ3d),
    )
}

/// Random light and weather of a frame.
pub(super) fn conditions_of(draw: &mut Draw, seed: u64) -> Conditions {
    let time = TimeOfDay::ALL[draw.weighted(&[0.16, 0.46, 0.16, 0.22])];
    let weather = Weather::ALL[draw.weighted(&[0.32, 0.18, 0.2, 0.14, 0.1, 0.06])];
    Conditions::usual(time, weather, seed)
}

fn seen(
    frame: (&Frame, &Background),
    teller: &HintedFrame<'_>,
    conditions: &Conditions,
    rig: &SensorRig,
    look: Look,
) -> PictureMoment {
    let (rgb, truth) = rendered(frame, rig, conditions, (look.size_px, look.quality));
    let to_sun = light_direction(conditions).as_dvec3();
    let sun = |camera: &Camera| {
        let local = camera.ego_from_camera().rotation.inverse() * to_sun;
        local.as_vec3().to_array()
    };
    PictureMoment {
        rgb,
        truth,
        told: rig.cameras.iter().map(|c| teller.of(c, look.size_px)).collect(),
        sun: rig.cameras.iter().map(sun).collect(),
    }
}

/// Two free poses on a lane, near a random place around the middle of the map: the poses of the pictures. Without a
/// free pair, two poses near the middle.
pub fn poses(frame: &Frame, draw: &mut Draw) -> [Pose; MOMENTS] {
    let wanted = DVec2::new(draw.unit() - 0.5, draw.unit() - 0.5) * (2.0 * AROUND_M);
    let way_m = WAY_M[0] + (WAY_M[1] - WAY_M[0]) * draw.unit();
    let layout = &frame.layout;
    let lanes = layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    let pairs = lanes.flat_map(|lane| {
        let length: f64 = lane.points_m.windows(2).map(|p| p[0].distance(p[1])).sum();
        let steps = ((length - way_m) / STEP_M).max(0.0) as usize;
        (0..steps).filter_map(move |i| {
            let from = along(&lane.points_m, i as f64 * STEP_M)?;
            Some([from, along(&lane.points_m, i as f64 * STEP_M + way_m)?])
        })
    });
    let free = pairs.filter(|pair| pair.iter().all(|(at, yaw)| is_free(frame, *at, *yaw)));
    let far = |pair: &[(DVec2, f64); MOMENTS]| pair[0].0.distance_squared(wanted);
    let nearest = free.min_by(|a, b| far(a).total_cmp(&far(b)));
    let pair = nearest.unwrap_or([(DVec2::ZERO, 0.0), (DVec2::X * way_m, 0.0)]);
    pair.map(|(at, yaw)| match layout.relief.is_flat() {
        true => Pose::planar(at.x, at.y, yaw),
        false => layout.relief.pose_on(at, yaw),
    })
}

/// Place and heading on a line at distance `way_m` from its start, m; `None` beyond its end.
fn along(points_m: &[DVec2], mut way_m: f64) -> Option<(DVec2, f64)> {
    for pair in points_m.windows(2) {
        let piece = pair[1] - pair[0];
        let length = piece.length();
        if way_m <= length && length > 0.0 {
            return Some((pair[0] + piece * (way_m / length), piece.to_angle()));
        }
        way_m -= length;
    }
    None
}

impl Shard for PicturePair {
    const ARRAYS: &'static [&'static str] = &[
        "rgb",
        "class",
        "told_class",
        "told_depth",
        "told_facing",
        "intrinsic",
        "map_from_camera",
        "sun",
        "dense",
        "conditions",
    ];

    /// For two moments and six cameras: u8 `rgb` `[N,2,6,h,w,3]`, `class` `[N,2,6,h,w]` (the truth, see
    /// [`scene::truth`]), `told_class` (render ids), u16 `told_depth` (cm, 0 none) and u8 `told_facing` as in
    /// [`PictureHints`], f32 `intrinsic` `[N,2,6,3,3]` (px), `map_from_camera` `[N,2,6,4,4]` and `sun` `[N,2,6,3]`; u8
    /// `dense` `[N,200,200,16]`; u8 `conditions` `[N,2]`: time of day and weather by their place in the lists.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let moments = || frames.iter().flat_map(|f| &f.moments);
        let first = moments().next().and_then(|m| m.truth.first());
        let [h, w] = first.map_or([0, 0], |t| [t.height, t.width]);
        let cameras = moments().next().map_or(0, |m| m.truth.len());
        let with = |last: &[usize]| [&[MOMENTS, cameras], last].concat();
        let truths = || moments().flat_map(|m| &m.truth);
        let told = || moments().flat_map(|m| &m.told);
        let depth = |m: &f32| (m / DEPTH_STEP_M).round().clamp(0.0, 65535.0) as u16;
        let classes = truths().flat_map(|t| t.pixels.iter().map(|p| p.class));
        let depths = told().flat_map(|t| &t.depth_m);
        let suns = moments().flat_map(|m| m.sun.iter().flatten());
        let plane = [h, w];
        vec![
            (
                Dtype::U8,
                with(&[h, w, 3]),
                moments().flat_map(|m| m.rgb.iter().flatten().copied()).collect(),
            ),
            (Dtype::U8, with(&plane), classes.collect()),
            (
                Dtype::U8,
                with(&plane),
                told().flat_map(|t| t.class.iter().copied()).collect(),
            ),
            (
                Dtype::U16,
                with(&plane),
                depths.flat_map(|d| depth(d).to_le_bytes()).collect(),
            ),
            (
                Dtype::U8,
                with(&plane),
                told().flat_map(|t| t.facing.iter().copied()).collect(),
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
                Dtype::F32,
                with(&[3]),
                floats(suns.map(|v| f64::from(*v)).collect()),
            ),
            (
                Dtype::U8,
                VOXELS.to_vec(),
                voxels(frames.iter().map(|f| &f.dense)),
            ),
            (
                Dtype::U8,
                vec![2],
                frames.iter().flat_map(|f| place_of(&f.conditions)).collect(),
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const SMALL: Look = Look {
        size_px: [64, 36],
        quality: Quality::Full,
    };

    #[test]
    fn pairs_come_with_what_the_voxels_tell() {
        let pairs: Vec<PicturePair> = (0..2).map(|i| picture_pair(4, i, SMALL, |_| None)).collect();
        let arrays = PicturePair::arrays(&pairs);
        assert_eq!(arrays.len(), PicturePair::ARRAYS.len());
        for ((dtype, shape, bytes), name) in arrays.iter().zip(PicturePair::ARRAYS) {
            let bits = pairs.len() * shape.iter().product::<usize>() * dtype.bitsize();
            assert_eq!(8 * bytes.len(), bits, "{name}");
        }
        assert_eq!(arrays[0].1, [2, 6, 36, 64, 3]);
        let again = picture_pair(4, 1, SMALL, |_| None);
        assert!(again.moments[1].rgb == pairs[1].moments[1].rgb);
        assert!(again.moments[0].told == pairs[1].moments[0].told);
    }

    /// The vehicle drives as far as it should, and voxels tell nearly what the pictures show, at nearly the same distance.
    #[test]
    fn what_is_told_is_what_is_shown() {
        let (mut same, mut all, mut near) = (0, 0, 0);
        for pair in (2..6).map(|i| picture_pair(4, i, SMALL, |_| None)) {
            let at = |m: &PictureMoment| DVec3::from(m.truth[0].camera.translation_m);
            let way_m = at(&pair.moments[0]).distance(at(&pair.moments[1]));
            assert!((0.3..2.8).contains(&way_m), "{way_m} m");
            for moment in &pair.moments {
                for (truth, told) in moment.truth.iter().zip(&moment.told) {
                    for (i, pixel) in truth.pixels.iter().enumerate() {
                        if told.depth_m[i] > 0.0 && pixel.depth_m > 0.0 {
                            all += 1;
                            same += usize::from(told.class[i] == pixel.class);
                            near += usize::from((told.depth_m[i] / pixel.depth_m - 1.0).abs() < 0.15);
                        }
                    }
                }
            }
        }
        let share = |n: usize| n as f64 / all as f64;
        assert!(
            share(same) > 0.75 && share(near) > 0.75,
            "{} {}",
            share(same),
            share(near)
        );
    }

    #[test]
    fn a_line_is_walked_along() {
        let line = [DVec2::ZERO, DVec2::new(3.0, 0.0), DVec2::new(3.0, 4.0)];
        assert_eq!(along(&line, 2.0), Some((DVec2::new(2.0, 0.0), 0.0)));
        let (at, yaw) = along(&line, 5.0).expect("on the second piece");
        assert!(at.distance(DVec2::new(3.0, 2.0)) < 1e-9 && (yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        assert_eq!(along(&line, 7.5), None);
    }
}
