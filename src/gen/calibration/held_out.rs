//! The held-out worlds: nothing was trained on them.

use std::sync::Arc;

use dataset::world_of;
use scene::{Frame, Scene, SensorRig};
use world::voxelize::{Vertical, complete};

/// Seed of the held-out worlds; training uses 1, validation 2.
pub const TEST_SEED: u64 = 3;

/// Held-out world `index` as a scene with complete occupancy and its background as things.
pub fn scene(index: u64) -> Scene {
    let (world, seed) = world_of(TEST_SEED, index, |_| None);
    let mut scene = authoring::open::of_world(&world, "held out");
    scene.seed = seed;
    scene
}

/// Held-out world `index` as a scene without a list of things beside the road; the trade is measured on it.
pub fn bare_scene(index: u64) -> Scene {
    let (world, seed) = world_of(TEST_SEED, index, |_| None);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    Scene::single("held out", frame, Arc::new(SensorRig::default()), seed)
}
