//! Training frames of the learned LiDAR: a world's voxels, and the measurements of a LiDAR on its surfaces.

use glam::{DQuat, DVec3};
use safetensors::tensor::Dtype;

use super::{Shard, VOXELS, voxels, world_of};
use scene::{BevLayout, LidarPattern, SensorRig, VoxelGrid};
use sensors::lidar::truth::{self, RANGE_STEP_M, TruthRay};
use world::draw::Draw;
use world::voxelize::{Drive, Vertical, complete, labels};

/// One training frame.
pub struct LidarFrame {
    /// Every voxel of the world, in the vertical convention of labels.
    pub dense: VoxelGrid,
    /// Labels from a simulated labelling drive through the world.
    pub labels: VoxelGrid,
    /// The sensor: HDL-32E. Every other frame has it mounted as in nuScenes, the others slightly varied.
    pub pattern: LidarPattern,
    /// Its sweep, beam-major.
    pub rays: Vec<TruthRay>,
}

/// Frame `index` of the data set of `seed`; the same arguments give the same frame.
pub fn lidar_frame(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> LidarFrame {
    let (world, seed) = world_of(seed, index, roads);
    let rig = SensorRig::default();
    let mut pattern = rig.lidars[0].clone();
    let mut draw = Draw::new(seed, "lidar mount");
    if draw.chance(0.5) {
        let [x, y, z] = pattern.translation_m;
        pattern.translation_m = [
            x + draw.range(-0.6, 0.6),
            y + draw.range(-0.5, 0.5),
            z + draw.range(-0.4, 0.5),
        ];
        let turn = DQuat::from_rotation_z(draw.range(-3.2, 3.2))
            * DQuat::from_rotation_x(draw.range(-0.02, 0.02))
            * DQuat::from_rotation_y(draw.range(-0.02, 0.02));
        pattern.rotation_wxyz = [turn.w, turn.x, turn.y, turn.z];
    }
    LidarFrame {
        dense: complete(&world, Vertical::Occ3d),
        labels: labels(&world, &rig.lidars[0], &Drive::default(), Vertical::Occ3d, seed),
        rays: truth::sweep(&world, &pattern, seed),
        pattern,
    }
}

impl Shard for LidarFrame {
    const ARRAYS: &'static [&'static str] = &[
        "dense",
        "labels",
        "range",
        "intensity",
        "echo",
        "class",
        "incidence",
        "origin",
        "rotation",
        "elevations",
    ];

    /// u8 `dense`, `labels` `[N,200,200,16]`; per ray `[N,32,1084]` u16 `range` (2 mm, 0 without surface), u8
    /// `intensity`, `echo` (0 return, 1 lost, 2 own body, 3 nothing), `class`, `incidence` (255ths of the cosine); f32
    /// `origin` `[N,3]` (m) and `rotation` `[N,3,3]` (rows) of the sensor in the ego frame, `elevations` `[N,32]` (degrees).
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let beams = frames.first().map_or(0, |f| f.pattern.elevations_deg.len());
        let columns = frames.first().map_or(0, |f| f.pattern.columns as usize);
        let rays = || frames.iter().flat_map(|f| &f.rays);
        let bytes = |value: fn(&TruthRay) -> u8| -> (Dtype, Vec<usize>, Vec<u8>) {
            (Dtype::U8, vec![beams, columns], rays().map(value).collect())
        };
        let range = rays().flat_map(|r| {
            let steps = (f64::from(r.range_m) / RANGE_STEP_M).round().clamp(0.0, 65535.0);
            (steps as u16).to_le_bytes()
        });
        let floats = |shape: &[usize], values: &mut dyn Iterator<Item = f64>| {
            let data = values.flat_map(|v| (v as f32).to_le_bytes()).collect();
            (Dtype::F32, shape.to_vec(), data)
        };
        let rows = |f: &Self| {
            let rotation = f.pattern.ego_from_sensor().rotation;
            let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| rotation * axis);
            (0..9).map(move |i| columns[i % 3][i / 3])
        };
        vec![
            (
                Dtype::U8,
                VOXELS.to_vec(),
                voxels(frames.iter().map(|f| &f.dense)),
            ),
            (
                Dtype::U8,
                VOXELS.to_vec(),
                voxels(frames.iter().map(|f| &f.labels)),
            ),
            (Dtype::U16, vec![beams, columns], range.collect()),
            bytes(|r| r.intensity),
            bytes(|r| r.echo as u8),
            bytes(|r| r.class.id()),
            bytes(|r| (r.cos_incidence * 255.0).round() as u8),
            floats(&[3], &mut frames.iter().flat_map(|f| f.pattern.translation_m)),
            floats(&[3, 3], &mut frames.iter().flat_map(rows)),
            floats(
                &[beams],
                &mut frames
                    .iter()
                    .flat_map(|f| f.pattern.elevations_deg.iter().copied()),
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::write;
    use super::*;
    use crate::SHARD_FRAMES;

    #[test]
    fn shards_are_repeatable_and_kept() {
        let small = |i: usize| -> std::io::Result<LidarFrame> {
            let mut frame = lidar_frame(5, i as u64 % 2, |_| None);
            frame.dense = VoxelGrid::new(); // 640 kB a frame less
            Ok(frame)
        };
        let folder = tempfile::tempdir().expect("a folder");
        let report = write(folder.path(), 2, small, |_| true).expect("written");
        assert_eq!((report.frames, report.resumed_shards), (2, 0));
        let path = folder.path().join("shard_00000.safetensors");
        let first = std::fs::read(&path).expect("a shard");
        let again = write(folder.path(), SHARD_FRAMES.min(2), small, |_| true).expect("kept");
        assert_eq!((again.bytes, again.resumed_shards), (0, 1));
        std::fs::remove_file(&path).expect("there");
        write(folder.path(), 2, small, |_| true).expect("written again");
        assert_eq!(std::fs::read(&path).expect("a shard"), first);
    }
}
