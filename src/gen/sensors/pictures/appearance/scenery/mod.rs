//! Scenery drawn as the solids that it is made of, at its true height, and its voxels taken out of the field.

mod object;

use std::collections::BTreeSet;

use glam::{DVec2, Vec3};

use super::things::DrawnObject;
use crate::pictures::scenery::{SceneryInput, ShownScenery, ShownThing};
use scene::{Background, Class, ThingId, VoxelGrid};

/// Scenery of a frame.
pub struct DrawnScenery {
    /// Objects to trace.
    pub objects: Vec<DrawnObject>,
    /// Things of which the field draws all or a part.
    pub in_field: Background,
    /// Those of them of which something was cut out.
    pub cut: BTreeSet<ThingId>,
}

impl DrawnScenery {
    /// Draws what can be drawn, and removes its voxels from `standing`, the voxels of the map that stand on the ground.
    pub fn new(input: SceneryInput<'_>, standing: &mut VoxelGrid, seed: u32) -> Self {
        let extent = input.layout.extent();
        let shown = ShownScenery::new(input);
        let goes = shown.stood_for(input.occupancy, input.painted);
        for (i, mask) in goes {
            let [x, y] = extent.column(i);
            for z in (0..extent.nz()).filter(|z| mask >> z & 1 == 1) {
                standing.set(x, y, z, Class::FREE);
            }
        }
        let ground_m = |p: DVec2| input.layout.relief.height_m(p);
        let objects = |shown: &ShownThing| -> Vec<DrawnObject> {
            let Some(cuts) = shown.cuts_m(extent) else {
                return Vec::new();
            };
            let cuts: Vec<[Vec3; 2]> = cuts.iter().map(|cut| cut.map(|p| p.as_vec3())).collect();
            let objects = object::objects(&shown.thing, &ground_m, seed).into_iter();
            objects.map(|object| object.with_cuts(&cuts)).collect()
        };
        let whole = |shown: &&ShownThing| shown.cuts_m(extent).is_some_and(|cuts| cuts.is_empty());
        let whole: BTreeSet<ThingId> = shown.things().iter().filter(whole).map(|s| s.thing.id).collect();
        let cut = |shown: &&ShownThing| shown.cuts_m(extent).is_some_and(|cuts| !cuts.is_empty());
        Self {
            objects: shown.things().iter().flat_map(objects).collect(),
            cut: shown.things().iter().filter(cut).map(|s| s.thing.id).collect(),
            in_field: input
                .background
                .iter()
                .filter(|t| !whole.contains(&t.id))
                .cloned()
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests;
