//! What is measured on: scenes with one edit each.

use std::sync::Arc;

use crate::cli::trials::Trial;
use dataset::world_of;
use editor::Document;
use scene::{Frame, Scene, SensorRig};
use world::voxelize::{Vertical, complete};

/// Seed of the held-out worlds: that of `eval`.
pub const TEST_SEED: u64 = 3;
/// Kinds of edits per scene: a small one, one that brings something new, a large one.
pub const KINDS: [&str; 3] = ["remove", "add", "road"];

/// A scene before and after an edit.
#[derive(Clone)]
pub struct Case {
    /// `world 3, remove`.
    pub name: String,
    /// The scene before.
    pub before: Arc<Scene>,
    /// The same with the edit, not yet regenerated.
    pub after: Arc<Scene>,
}

/// Held-out world `index` with complete occupancy.
pub fn held_out(index: u64) -> Scene {
    let (world, seed) = world_of(TEST_SEED, index, |_| None);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    Scene::single("held out", frame, Arc::new(SensorRig::default()), seed)
}

/// One case of every kind that suits the scene.
pub fn of_scene(scene: &Scene, name: &str, seed: u64) -> Vec<Case> {
    let before = Arc::new(scene.clone());
    let case = |kind: &&str| {
        let trial = Trial::propose(kind, scene.frame(), seed)?;
        let mut document = Document::new(scene.clone());
        document.apply("Edit", &trial.edit).ok()?;
        Some(Case {
            name: format!("{name}, {kind}"),
            before: before.clone(),
            after: document.scene().clone(),
        })
    };
    KINDS.iter().filter_map(case).collect()
}
