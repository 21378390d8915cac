//! Cases of the trade: scenes with one edit each.

use std::sync::Arc;

use crate::trials::Trial;
use editor::Document;
use scene::Scene;

/// Kinds of edits per scene: a small one, one that adds an object, a large one.
pub const KINDS: [&str; 3] = ["remove", "add", "road"];

/// A scene before and after an edit.
#[derive(Clone)]
pub struct Case {
    /// `world 3, remove`.
    pub name: String,
    /// The scene before.
    pub before: Arc<Scene>,
    /// The scene with the edit, not yet regenerated.
    pub after: Arc<Scene>,
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
