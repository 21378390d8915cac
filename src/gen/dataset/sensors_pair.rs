//! One moment as a LiDAR and six cameras see it, with every voxel of the world: training data of the network that tells
//! voxels from these sensors.

use safetensors::tensor::Dtype;

use super::perception::{PerceptionFrame, swept};
use super::picture_pairs::{Look, conditions_of};
use super::pictures::{floats, intrinsic, map_from_camera, rendered};
use super::{Shard, VOXELS, voxels, world_of};
use scene::{BevLayout, CameraTruth, Frame, SensorRig, VoxelGrid};
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// One frame.
pub struct SensorsPair {
    /// Sweep of the LiDAR.
    pub sweep: PerceptionFrame,
    /// Picture of each camera, sRGB, three bytes a pixel.
    pub rgb: Vec<Vec<u8>>,
    /// The cameras, and the truth about their pixels.
    pub truth: Vec<CameraTruth>,
    /// Every voxel of the world, in the vertical convention of labels.
    pub dense: VoxelGrid,
}

/// Frame `index` of the data set of `seed`; the same arguments give the same frame.
pub fn sensors_pair(
    seed: u64,
    index: u64,
    look: Look,
    roads: impl Fn(u64) -> Option<BevLayout>,
) -> SensorsPair {
    let (world, seed) = world_of(seed, index, roads);
    let dense = complete(&world, Vertical::Occ3d);
    let sweep = swept(&world, &dense, seed);
    let conditions = conditions_of(&mut Draw::new(seed, "sensors pair"), seed);
    let frame = Frame::new(world.layout, world.boxes, dense);
    let (rgb, truth) = rendered(
        (&frame, &world.background),
        &SensorRig::default(),
        &conditions,
        (look.size_px, look.quality),
    );
    SensorsPair {
        sweep,
        rgb,
        truth,
        dense: frame.occupancy,
    }
}

impl Shard for SensorsPair {
    const ARRAYS: &'static [&'static str] = &[
        "source",
        "returns",
        "points",
        "intensity",
        "box_count",
        "boxes",
        "standing",
        "rgb",
        "intrinsic",
        "map_from_camera",
        "dense",
    ];

    /// The arrays of [`PerceptionFrame`], then u8 `rgb` `[N,6,h,w,3]`, f32 `intrinsic` `[N,6,3,3]` (px), `map_from_camera`
    /// `[N,6,4,4]` and u8 `dense` `[N,200,200,16]`.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let mut arrays = PerceptionFrame::columns(&frames.iter().map(|f| &f.sweep).collect::<Vec<_>>());
        let first = frames.first().and_then(|f| f.truth.first());
        let [h, w] = first.map_or([0, 0], |t| [t.height, t.width]);
        let cameras = frames.first().map_or(0, |f| f.truth.len());
        let truths = || frames.iter().flat_map(|f| &f.truth);
        let rgb = frames.iter().flat_map(|f| f.rgb.iter().flatten().copied());
        arrays.extend([
            (Dtype::U8, vec![cameras, h, w, 3], rgb.collect()),
            (
                Dtype::F32,
                vec![cameras, 3, 3],
                floats(truths().flat_map(intrinsic).collect()),
            ),
            (
                Dtype::F32,
                vec![cameras, 4, 4],
                floats(truths().flat_map(map_from_camera).collect()),
            ),
            (
                Dtype::U8,
                VOXELS.to_vec(),
                voxels(frames.iter().map(|f| &f.dense)),
            ),
        ]);
        arrays
    }
}

#[cfg(test)]
mod tests {
    use sensors::pictures::appearance::Quality;

    use super::*;

    #[test]
    fn a_frame_holds_what_both_sensors_see_and_repeats() {
        let look = Look {
            size_px: [32, 18],
            quality: Quality::Preview,
        };
        let frames: Vec<SensorsPair> = (0..2).map(|i| sensors_pair(5, i, look, |_| None)).collect();
        let arrays = SensorsPair::arrays(&frames);
        assert_eq!(arrays.len(), SensorsPair::ARRAYS.len());
        for ((dtype, shape, bytes), name) in arrays.iter().zip(SensorsPair::ARRAYS) {
            let bits = frames.len() * shape.iter().product::<usize>() * dtype.bitsize();
            assert_eq!(8 * bytes.len(), bits, "{name}");
        }
        assert_eq!(arrays[7].1, [6, 18, 32, 3]);
        let again = sensors_pair(5, 1, look, |_| None);
        assert!(again.rgb == frames[1].rgb && again.sweep.points == frames[1].sweep.points);
        assert!(frames.iter().all(|f| f.sweep.points.len() > 5000));
    }
}
