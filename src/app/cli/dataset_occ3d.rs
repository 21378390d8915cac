//! `sceneloom dataset occ3d`: simulated labels as files that whatever reads Occ3D reads.

use std::path::Path;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use rayon::prelude::*;

use dataset::{DatasetReport, world_of};
use formats::occ3d::{self, Occ3dFrame};
use formats::out_folder::OutFolder;
use scene::{BevLayout, SensorRig};
use world::voxelize::{Drive, Vertical, labelled};

/// Frames between two reports.
const CHUNK: usize = 8;

/// Labels of frame `index` of the data set of `seed` with the masks of what LiDAR and cameras observed.
fn frame(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> Occ3dFrame {
    let (world, seed) = world_of(seed, index, roads);
    let found = labelled(
        &world,
        &SensorRig::default(),
        &Drive::default(),
        Vertical::Occ3d,
        seed,
    );
    Occ3dFrame {
        labels: found.grid,
        lidar_observed: Some(found.by_lidar),
        camera_observed: Some(found.by_camera),
    }
}

/// Writes `NNNNN/labels.npz` for every frame into `dir`; those that are there already are kept.
pub fn write(
    dir: &Path,
    frames: usize,
    seed: u64,
    roads: impl Fn(u64) -> Option<BevLayout> + Sync,
    progress: impl Fn(usize),
) -> anyhow::Result<DatasetReport> {
    let (bytes, kept) = (AtomicU64::new(0), AtomicUsize::new(0));
    let all: Vec<usize> = (0..frames).collect();
    for some in all.chunks(CHUNK) {
        progress(some[0]);
        some.par_iter().try_for_each(|i| -> anyhow::Result<()> {
            if dir.join(format!("{i:05}/labels.npz")).exists() {
                kept.fetch_add(1, Ordering::Relaxed);
                return Ok(());
            }
            let found = occ3d::frame_to_bytes(&frame(seed, *i as u64, &roads));
            bytes.fetch_add(found.len() as u64, Ordering::Relaxed);
            OutFolder::make(dir)?.write(&format!("{i:05}/labels.npz"), &found)?;
            Ok(())
        })?;
    }
    Ok(DatasetReport {
        frames,
        bytes: bytes.into_inner(),
        resumed_shards: kept.into_inner(),
    })
}
