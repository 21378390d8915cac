//! Scenery that the voxels show: things whose voxels are there, so that their solids can be drawn and cast instead of them.
//! Around a place where something was cut out of a thing its voxels stay; a thing that is mostly missing stays voxels.

mod cut;
mod shapes;

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use rayon::prelude::*;

use cut::{Cut, Missing};
use scene::background::{ColumnLabels, LineKind, in_extent};
use scene::grid::{BRICK, NOT_PAINTED, bricks_along};
use scene::{Background, BevLayout, Class, Extent, Form, Thing, VoxelGrid, VoxelPaint};
pub use shapes::SceneryShapes;

/// Content of a map that scenery is compared with.
#[derive(Clone, Copy)]
pub struct SceneryInput<'a> {
    /// All things.
    pub background: &'a Background,
    /// Labels of the map.
    pub occupancy: &'a VoxelGrid,
    /// Voxels painted by hand, of the same map.
    pub painted: &'a VoxelPaint,
    /// Layout of the same map.
    pub layout: &'a BevLayout,
    /// True if the things were inferred from the voxels: only those that explain them well stand for them.
    pub inferred: bool,
}

/// A thing beside the map.
pub struct ShownThing {
    /// The thing.
    pub thing: Thing,
    columns: Arc<ColumnLabels>,
    cuts: Option<Vec<Cut>>,
}

/// The scenery of a map beside its voxels.
pub struct ShownScenery {
    layout: BevLayout,
    occupancy: VoxelGrid,
    painted: VoxelPaint,
    inferred: bool,
    things: Vec<ShownThing>,
    /// Voxels of the things, by the index of their column; made when they are first asked for.
    masks: OnceLock<Arc<Vec<(usize, ColumnMask)>>>,
}

impl ShownThing {
    /// True if it has columns in one of some bricks, or up to two columns beside them.
    fn touches(&self, extent: Extent, bricks: &[bool]) -> bool {
        let [_, along_y] = bricks_along(extent);
        let beside = |c: usize, n: usize| [c.saturating_sub(2), c, (c + 2).min(n - 1)].map(|c| c / BRICK);
        let holds = |[x, y]: &[usize; 2]| {
            let (xs, ys) = (beside(*x, extent.nx()), beside(*y, extent.ny()));
            xs.iter().any(|x| ys.iter().any(|y| bricks[x * along_y + y]))
        };
        self.columns.keys().any(holds)
    }

    /// True if its solids stand for all of its voxels.
    pub fn is_whole(&self) -> bool {
        self.cuts.as_ref().is_some_and(Vec::is_empty)
    }

    /// True if its solids stand for its voxels but those around a cut.
    pub fn is_cut(&self) -> bool {
        self.cuts.as_ref().is_some_and(|cuts| !cuts.is_empty())
    }

    /// Upright boxes in which its voxels stay, lower and upper corner in m; empty if its solids stand for all of it, `None`
    /// if they stand for nothing.
    pub fn cuts_m(&self, extent: Extent) -> Option<Vec<[DVec3; 2]>> {
        let half = DVec3::splat(extent.voxel_m() / 2.0);
        let corner = |[x, y, z]: [usize; 3], up: f64| extent.center(x, y, z) + half * up;
        let cuts = self.cuts.as_ref()?.iter();
        let top = extent.nz() - 1;
        let upper = |high: [usize; 3]| match high[2] == top {
            // What was cut up to the top of the map goes on above it.
            true => corner(high, 1.0).with_z(1e6),
            false => corner(high, 1.0),
        };
        Some(
            cuts.map(|[low, high]| [corner(*low, -1.0), upper(*high)])
                .collect(),
        )
    }
}

impl ShownScenery {
    /// Compares the things that are made by people and carry no traffic with the voxels of a map. What is the same as in
    /// `before` is taken from there.
    pub fn new(input: SceneryInput<'_>, before: Option<&Self>) -> Self {
        let extent = input.layout.extent();
        let before = before.filter(|b| b.layout == *input.layout && b.inferred == input.inferred);
        let changed = before.map(|b| b.changed_bricks(input));
        let things = in_extent(extent, input.background.iter().filter(|t| is_solid(&t.form)));
        let compare = |thing: Thing| {
            let known = before.and_then(|b| Some(&b.things[b.place(&thing)?]));
            let columns = known.map_or_else(|| Arc::new(thing.columns(input.layout)), |s| s.columns.clone());
            if let (Some(known), Some(changed)) = (known, &changed)
                && !known.touches(extent, changed)
            {
                let cuts = known.cuts.clone();
                return ShownThing { thing, columns, cuts };
            }
            let missing = Missing::new(&columns, input.occupancy, input.painted);
            let cuts = missing.cuts(extent.shape());
            let cuts = cuts.filter(|_| !input.inferred || missing.explains(input.occupancy));
            ShownThing { thing, columns, cuts }
        };
        let things: Vec<ShownThing> = things.into_par_iter().map(compare).collect();
        let same = |a: &ShownThing, b: &ShownThing| a.thing == b.thing && a.cuts == b.cuts;
        let all_same = before
            .filter(|b| b.things.len() == things.len())
            .filter(|b| b.things.iter().zip(&things).all(|(a, b)| same(a, b)));
        Self {
            layout: input.layout.clone(),
            occupancy: input.occupancy.clone(),
            painted: input.painted.clone(),
            inferred: input.inferred,
            masks: all_same.map_or_else(OnceLock::new, |b| b.masks.clone()),
            things,
        }
    }

    /// Place of the same thing among these.
    fn place(&self, thing: &Thing) -> Option<usize> {
        let at = self.things.binary_search_by_key(&thing.id, |s| s.thing.id).ok()?;
        (self.things[at].thing == *thing).then_some(at)
    }

    /// Bricks of the map in which labels or paint are not what they were, true by index.
    fn changed_bricks(&self, input: SceneryInput<'_>) -> Vec<bool> {
        let mut changed = vec![false; input.occupancy.bricks().len()];
        let differ = |b: &usize| *self.occupancy.bricks()[*b] != *input.occupancy.bricks()[*b];
        let labels = input
            .occupancy
            .changed_bricks(&self.occupancy)
            .into_iter()
            .filter(differ);
        for brick in labels.chain(input.painted.changed_bricks(&self.painted)) {
            changed[brick] = true;
        }
        changed
    }

    /// Place among these of a thing that is shown in the same way.
    pub fn place_of_same(&self, shown: &ShownThing) -> Option<usize> {
        let at = self.place(&shown.thing)?;
        (self.things[at].cuts == shown.cuts).then_some(at)
    }

    /// Those alone whose solids stand for all of their voxels.
    pub fn of_whole_things(mut self) -> Self {
        // The others still keep their own voxels.
        for cut in self.things.iter_mut().filter(|s| s.is_cut()) {
            cut.cuts = None;
            self.masks = OnceLock::new();
        }
        self
    }

    /// All of them.
    pub fn things(&self) -> &[ShownThing] {
        &self.things
    }

    /// Voxels that solids stand for, a bit for each bin, beside the index of their column: those of the things, and strays of
    /// their class within a voxel of them, but nothing that was painted, belongs to another thing or lies around a cut.
    pub fn stood_for(&self, occupancy: &VoxelGrid, painted: &VoxelPaint) -> Vec<(usize, u64)> {
        let extent = self.layout.extent();
        let is_made = |label: u8| label == Class::Manmade.id() || label == Class::Others.id();
        let goes = |(i, mask): &(usize, ColumnMask)| {
            let [x, y] = extent.column(*i);
            let wanted = mask.near & !mask.kept | mask.own;
            let (held, painted) = (occupancy.column(x, y), painted.column(x, y));
            let goes = |z: &usize| wanted >> z & 1 == 1 && is_made(held[*z]) && painted[*z] == NOT_PAINTED;
            let bits = (0..held.len()).filter(goes).fold(0, |mask, z| mask | 1 << z);
            (bits != 0).then_some((*i, bits))
        };
        self.masks
            .get_or_init(|| Arc::new(self.masks()))
            .iter()
            .filter_map(goes)
            .collect()
    }

    /// Voxels of the things, by the index of their column.
    fn masks(&self) -> Vec<(usize, ColumnMask)> {
        let extent = self.layout.extent();
        let mut masks: HashMap<usize, ColumnMask> = HashMap::new();
        for ShownThing { columns, cuts, .. } in &self.things {
            for ([x, y], labels) in columns.iter() {
                let bits = |keep: &dyn Fn(usize) -> bool| {
                    let bins = (0..labels.len()).filter(|z| labels[*z] != Class::FREE && keep(*z));
                    bins.fold(0u64, |mask, z| mask | 1 << z)
                };
                let stays = |z: usize| match cuts {
                    None => true,
                    Some(cuts) => cuts.iter().any(|cut| cut::holds(cut, [*x, *y, z])),
                };
                let own = bits(&|z| !stays(z));
                let here = masks.entry(extent.index(*x, *y)).or_default();
                here.own |= own;
                here.kept |= bits(&stays);
                if own == 0 {
                    continue;
                }
                let grown = own | own << 1 | own >> 1;
                for x in x.saturating_sub(1)..=(x + 1).min(extent.nx() - 1) {
                    for y in y.saturating_sub(1)..=(y + 1).min(extent.ny() - 1) {
                        masks.entry(extent.index(x, y)).or_default().near |= grown;
                    }
                }
            }
        }
        let mut masks: Vec<_> = masks.into_iter().collect();
        masks.sort_unstable_by_key(|(i, _)| *i);
        masks
    }
}

/// Voxels of a column, a bit for each bin.
#[derive(Clone, Copy, Default)]
struct ColumnMask {
    /// Those of things that solids stand for.
    own: u64,
    /// Those, and the ones beside them.
    near: u64,
    /// Those of things that stay voxels.
    kept: u64,
}

/// True for forms whose solids stand for their voxels.
fn is_solid(form: &Form) -> bool {
    match form {
        Form::Building(_) | Form::Post(_) => true,
        Form::Line(line) => line.kind != LineKind::Hedge,
        Form::Tree(_) | Form::Shrubs(_) | Form::Bridge(_) => false,
    }
}
