//! Scenery drawn as the solids that it is made of, at its true height, and its voxels taken out of the field.

mod object;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DVec2, Vec3};

use super::things::DrawnObject;
use crate::pictures::scenery::{SceneryInput, ShownScenery, ShownThing};
use scene::{Background, Class, ThingId, VoxelGrid};

/// Scenery of a frame.
pub struct DrawnScenery {
    shown: ShownScenery,
    /// The objects of each thing that is shown.
    objects: Vec<Arc<Vec<DrawnObject>>>,
    /// Things of which the field draws all or a part.
    pub in_field: Background,
    /// Those of them of which something was cut out.
    pub cut: BTreeSet<ThingId>,
}

impl DrawnScenery {
    /// Draws what can be drawn, and removes its voxels from `standing`, the voxels of the map that stand on the ground. What is
    /// the same as in `before`, of the same layout and seed, is taken from there.
    pub fn new(input: SceneryInput<'_>, standing: &mut VoxelGrid, seed: u32, before: Option<&Self>) -> Self {
        let extent = input.layout.extent();
        let shown = ShownScenery::new(input, before.map(|b| &b.shown));
        let goes = shown.stood_for(input.occupancy, input.painted);
        for (i, mask) in goes {
            let [x, y] = extent.column(i);
            let column = standing.column_mut(x, y).iter_mut().enumerate();
            column
                .filter(|(z, _)| mask >> z & 1 == 1)
                .for_each(|(_, label)| *label = Class::FREE);
        }
        let ground_m = |p: DVec2| input.layout.relief.height_m(p);
        let objects = |thing: &ShownThing| -> Arc<Vec<DrawnObject>> {
            let known = before.and_then(|b| Some(b.objects[b.shown.place_of_same(thing)?].clone()));
            known.unwrap_or_else(|| {
                let Some(cuts) = thing.cuts_m(extent) else {
                    return Arc::default();
                };
                let cuts: Vec<[Vec3; 2]> = cuts.iter().map(|cut| cut.map(|p| p.as_vec3())).collect();
                let objects = object::objects(&thing.thing, &ground_m, seed).into_iter();
                Arc::new(objects.map(|object| object.with_cuts(&cuts)).collect())
            })
        };
        let is_whole = |shown: &&ShownThing| shown.is_whole();
        let whole: BTreeSet<ThingId> = shown
            .things()
            .iter()
            .filter(is_whole)
            .map(|s| s.thing.id)
            .collect();
        let cut = |shown: &&ShownThing| shown.is_cut();
        Self {
            objects: shown.things().iter().map(objects).collect(),
            cut: shown.things().iter().filter(cut).map(|s| s.thing.id).collect(),
            in_field: input
                .background
                .iter()
                .filter(|t| !whole.contains(&t.id))
                .cloned()
                .collect(),
            shown,
        }
    }

    /// Objects to trace.
    pub fn objects(&self) -> impl Iterator<Item = &DrawnObject> {
        self.objects.iter().flat_map(|of_thing| of_thing.iter())
    }
}

#[cfg(test)]
mod tests;
