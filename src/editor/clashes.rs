//! Objects that overlap, or collide in the course of the clip, as sentences: for callers that change a scene without
//! looking at it.

use std::collections::HashSet;

use scene::Scene;

use crate::checks::{collisions, overlaps};

/// All overlaps and collisions, as sentences of the checks. Neighbours that are equal are listed once.
pub fn clashes(scene: &Scene) -> Vec<String> {
    let standing = overlaps(scene).into_iter().map(|f| f.text);
    let colliding = collisions(scene).into_iter().map(|c| c.text);
    let mut said = HashSet::new();
    standing
        .chain(colliding)
        .filter(|text| said.insert(text.clone()))
        .collect()
}

/// The overlaps and collisions after a change that were not there before it.
pub fn new_clashes(before: &Scene, after: &Scene) -> Vec<String> {
    let mut out = clashes(after);
    if !out.is_empty() {
        let known = clashes(before);
        out.retain(|c| !known.contains(c));
    }
    out
}
