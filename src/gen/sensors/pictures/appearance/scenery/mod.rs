//! Scenery drawn as the solids that it is made of. A thing whose voxels are there is drawn whole, at its true height, and its
//! voxels are taken out of the field. Around a place where something was cut out of it the field draws what is left; a thing
//! that is mostly missing stays in the field.

mod cut;
mod object;

use std::collections::BTreeSet;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::things::DrawnObject;
use cut::{Cut, Missing, Voxel};
use scene::background::{ColumnLabels, LineKind, in_extent};
use scene::grid::NOT_PAINTED;
use scene::{Background, BevLayout, Class, Form, Thing, ThingId, VoxelGrid, VoxelPaint};

/// Scenery of a frame.
pub struct DrawnScenery {
    /// Objects to trace.
    pub objects: Vec<DrawnObject>,
    /// Things of which the field draws all or a part.
    pub in_field: Background,
}

/// Voxels that scenery is compared with.
pub struct SceneryInput<'a> {
    /// All things.
    pub background: &'a Background,
    /// Labels of the map.
    pub occupancy: &'a VoxelGrid,
    /// Voxels painted by hand, of the same map.
    pub painted: &'a VoxelPaint,
    /// Layout of the same map.
    pub layout: &'a BevLayout,
}

/// A thing beside the map.
struct Compared<'a> {
    thing: &'a Thing,
    columns: ColumnLabels,
    /// Where something is cut out of it; `None` if the field draws all of it.
    cuts: Option<Vec<Cut>>,
}

impl SceneryInput<'_> {
    /// Draws what can be drawn, and removes its voxels from `standing`, the voxels of the map that stand on the ground.
    pub fn draw(&self, standing: &mut VoxelGrid, seed: u32) -> DrawnScenery {
        let extent = self.layout.extent();
        let things = in_extent(extent, self.background.iter().filter(|t| is_solid(&t.form)));
        let compared: Vec<Compared<'_>> = things.par_iter().map(|thing| self.compare(thing)).collect();
        self.remove(&compared, standing);
        let ground_m = |p: DVec2| self.layout.relief.height_m(p);
        let whole = |c: &&Compared<'_>| c.cuts.as_ref().is_some_and(Vec::is_empty);
        let whole: BTreeSet<ThingId> = compared.iter().filter(whole).map(|c| c.thing.id).collect();
        let objects = compared.iter().filter_map(|c| Some((c.thing, c.cuts.as_ref()?)));
        let objects = objects.flat_map(|(thing, cuts)| {
            let corner = |v: Voxel, up: f64| {
                let half = DVec3::splat(extent.voxel_m() / 2.0);
                (extent.center(v[0], v[1], v[2]) + half * up).as_vec3()
            };
            let cuts: Vec<[Vec3; 2]> = cuts
                .iter()
                .map(|[a, b]| [corner(*a, -1.0), corner(*b, 1.0)])
                .collect();
            object::objects(thing, &ground_m, seed)
                .into_iter()
                .map(move |object| object.with_cuts(&cuts))
        });
        DrawnScenery {
            objects: objects.collect(),
            in_field: self
                .background
                .iter()
                .filter(|t| !whole.contains(&t.id))
                .cloned()
                .collect(),
        }
    }

    fn compare<'a>(&self, thing: &'a Thing) -> Compared<'a> {
        let columns = thing.columns(self.layout);
        let missing = Missing::new(&columns, self.occupancy, self.painted);
        let cuts = missing.cuts(self.layout.extent().shape());
        Compared { thing, columns, cuts }
    }

    /// Removes the voxels of the things that are drawn, and strays of their class within a voxel of them, but nothing that
    /// was painted, belongs to another thing or lies around a cut.
    fn remove(&self, compared: &[Compared<'_>], standing: &mut VoxelGrid) {
        let extent = standing.extent();
        let mut own = vec![0u32; extent.columns()];
        let (mut near, mut kept) = (own.clone(), own.clone());
        for Compared { columns, cuts, .. } in compared {
            for ([x, y], labels) in columns {
                let bits = |keep: &dyn Fn(usize) -> bool| {
                    let bins = (0..labels.len()).filter(|z| labels[*z] != Class::FREE && keep(*z));
                    bins.fold(0u32, |mask, z| mask | 1 << z)
                };
                let is_cut = |z: usize| match cuts {
                    None => true,
                    Some(cuts) => cuts.iter().any(|cut| cut::holds(cut, [*x, *y, z])),
                };
                let (mask, stays) = (bits(&|z| !is_cut(z)), bits(&is_cut));
                kept[extent.index(*x, *y)] |= stays;
                own[extent.index(*x, *y)] |= mask;
                let grown = mask | mask << 1 | mask >> 1;
                for x in x.saturating_sub(1)..=(x + 1).min(extent.nx() - 1) {
                    for y in y.saturating_sub(1)..=(y + 1).min(extent.ny() - 1) {
                        near[extent.index(x, y)] |= grown;
                    }
                }
            }
        }
        let is_made = |label: u8| label == Class::Manmade.id() || label == Class::Others.id();
        for [x, y] in extent
            .all_columns()
            .filter(|[x, y]| near[extent.index(*x, *y)] != 0)
        {
            let i = extent.index(x, y);
            let (held, painted) = (*standing.window_column(x, y), self.painted.column(x, y));
            let goes = |z: usize| {
                is_made(held[z]) && painted[z] == NOT_PAINTED && (near[i] & !kept[i] | own[i]) >> z & 1 == 1
            };
            for z in (0..held.len()).filter(|z| goes(*z)) {
                standing.set(x, y, z, Class::FREE);
            }
        }
    }
}

/// True for forms that are drawn as solids: what is made by people and does not carry traffic.
fn is_solid(form: &Form) -> bool {
    match form {
        Form::Building(_) | Form::Post(_) => true,
        Form::Line(line) => line.kind != LineKind::Hedge,
        Form::Tree(_) | Form::Shrubs(_) | Form::Bridge(_) => false,
    }
}

#[cfg(test)]
mod tests;
