//! What stands in each other or meets in the course of the clip, as sentences: for whoever changed a scene and did not look.

use std::collections::HashSet;

use scene::Scene;

use crate::checks::{meetings, overlaps};

/// All of it, as the checks say it, each once.
pub fn clashes(scene: &Scene) -> Vec<String> {
    let standing = overlaps(scene).into_iter().map(|f| f.text);
    let meeting = meetings(scene).into_iter().map(|m| m.text);
    let mut said = HashSet::new();
    standing
        .chain(meeting)
        .filter(|text| said.insert(text.clone()))
        .collect()
}

/// Those of the scene after a change that were not there before it.
pub fn new_clashes(before: &Scene, after: &Scene) -> Vec<String> {
    let mut out = clashes(after);
    if !out.is_empty() {
        let known = clashes(before);
        out.retain(|c| !known.contains(c));
    }
    out
}
