//! Differences between a scene and its state before any edit that a sensor would notice: boxes, things, voxels.

use std::collections::{BTreeMap, HashSet};

use glam::{DVec2, DVec3};
use scene::grid::NOT_PAINTED;
use scene::solid::Solid;
use scene::{Background, BoxId, Class, Extent, Frame, Scene, SceneBox, Thing, VoxelGrid};

use super::ground::GroundMap;

/// Distance beyond a box within which returns are its own, m.
pub const BESIDE_M: f64 = 0.15;
/// Height above the ground from which returns are of an object, m.
pub const LOWEST_M: f64 = 0.12;

/// Edits of a scene since its import.
#[derive(Default)]
pub struct SceneChanges {
    /// Boxes of the recording that are not there any more, on the measured ground.
    pub gone: Vec<SceneBox>,
    /// Boxes of the recording that stay, on the measured ground.
    pub kept: Vec<SceneBox>,
    /// Boxes that are new, on the measured ground.
    pub added: Vec<SceneBox>,
    /// Solids of new things.
    pub things: Vec<Vec<Solid>>,
    /// Voxels that are free now and were not.
    pub freed: HashSet<[usize; 3]>,
    /// Voxels that are new; `None` if there are none.
    pub voxels: Option<VoxelGrid>,
    /// Extent of both.
    pub extent: Extent,
}

impl SceneChanges {
    /// The changes of a scene.
    pub fn between(before: &Scene, now: &Scene, ground: &GroundMap) -> Self {
        let (was, is) = (before.frame(), now.frame());
        let mut changes = Self {
            extent: is.extent(),
            ..Self::default()
        };
        let recorded = labelled(was, is);
        for (id, b) in &recorded {
            let old = on_ground(b, was, ground);
            match is.boxes.get(id) {
                None => changes.gone.push(old),
                Some(new) if is_same_place(b, new) => changes.kept.push(old),
                Some(new) => {
                    changes.gone.push(old);
                    changes.added.push(on_ground(new, is, ground));
                }
            }
        }
        let is_new = |b: &&SceneBox| !recorded.contains_key(&b.id) && b.problem().is_none();
        let new = is.boxes.values().filter(is_new);
        changes.added.extend(new.map(|b| on_ground(b, is, ground)));
        let touched = changes.compare_things(before, now, ground);
        changes.compare_voxels(was, is, &touched);
        changes
    }

    /// True if a sensor would notice nothing.
    pub fn is_empty(&self) -> bool {
        let no_objects = self.gone.is_empty() && self.added.is_empty() && self.things.is_empty();
        no_objects && self.freed.is_empty() && self.voxels.is_none()
    }

    /// Notes new things; the columns of things that are new, gone or different.
    fn compare_things(&mut self, before: &Scene, now: &Scene, ground: &GroundMap) -> HashSet<[usize; 2]> {
        let by_id = |background: &Background| -> BTreeMap<_, Thing> {
            background.iter().map(|thing| (thing.id, thing.clone())).collect()
        };
        let (was, is) = (by_id(&before.background), by_id(&now.background));
        let differs = |thing: &&Thing, other: &BTreeMap<_, Thing>| other.get(&thing.id) != Some(*thing);
        let gone = was.values().filter(|t| differs(t, &is));
        let mut touched = HashSet::new();
        let relief = &now.frame().layout.relief;
        let ground_m = |p: DVec2| ground.height_m(p).unwrap_or_else(|| relief.height_m(p));
        for thing in is.values().filter(|t| differs(t, &was)) {
            let mut solids = Vec::new();
            thing.solids(&ground_m, &mut solids);
            self.things.push(solids);
        }
        // Voxels of a new thing are its solids' already.
        for thing in gone {
            let (low, high) = thing.form.bounds_m();
            columns_between(self.extent, low, high, |column| {
                touched.insert(column);
            });
        }
        touched
    }

    /// Notes voxels that were painted, or that differ in columns of which the layout or a thing was edited.
    fn compare_voxels(&mut self, was: &Frame, is: &Frame, touched: &HashSet<[usize; 2]>) {
        let extent = self.extent;
        let (occupancy, painted) = (&is.occupancy, &is.painted);
        let (before, layout) = (was.occupancy.crop(extent), was.layout.crop(extent));
        let cells = layout.cells().iter().zip(is.layout.cells());
        let redrawn: Vec<bool> = cells.map(|(a, b)| a != b).collect();
        let mut new = VoxelGrid::over(extent);
        let mut any_new = false;
        let columns = before.changed_bricks(occupancy).into_iter().flat_map(|brick| {
            let ([x0, y0], [nx, ny]) = before.brick_columns(brick);
            (x0..x0 + nx).flat_map(move |x| (y0..y0 + ny).map(move |y| [x, y]))
        });
        for [x, y] in columns {
            let is_touched = redrawn[extent.index(x, y)] || touched.contains(&[x, y]);
            let (old, now, paint) = (before.column(x, y), occupancy.column(x, y), painted.column(x, y));
            for z in 0..extent.nz() {
                let by_hand = paint[z] != NOT_PAINTED;
                if !by_hand && !is_touched {
                    continue;
                }
                match (stands(old[z]), stands(now[z])) {
                    (true, false) => {
                        self.freed.insert([x, y, z]);
                    }
                    (false, true) if by_hand => {
                        new.set(x, y, z, now[z]);
                        any_new = true;
                    }
                    _ => {}
                }
            }
        }
        self.voxels = any_new.then_some(new);
    }
}

/// True for the label of what stands on the ground.
fn stands(label: u8) -> bool {
    Class::from_id(label).is_some_and(|c| c != Class::Free && !c.is_ground())
}

fn is_same_place(a: &SceneBox, b: &SceneBox) -> bool {
    (a.center_m, a.size_m, a.yaw_rad) == (b.center_m, b.size_m, b.yaw_rad)
}

/// Boxes of a recording: those that were found in it, as a person corrected them since. A correction of an object that was moved
/// before says nothing of the recording.
fn labelled(was: &Frame, is: &Frame) -> BTreeMap<BoxId, SceneBox> {
    let mut boxes = was.boxes.clone();
    for (id, label) in is.inferred.recorded.labels() {
        let was_near = |b: &SceneBox| {
            let known = was.boxes.get(id);
            known.is_none_or(|k| k.center_m.distance(b.center_m) <= k.size_m.length() / 2.0)
        };
        match label {
            Some(b) if was_near(b) => {
                boxes.insert(*id, *b);
            }
            Some(_) => {}
            None => {
                boxes.remove(id);
            }
        }
    }
    boxes
}

/// A box on the measured ground in place of that of the scene.
fn on_ground(b: &SceneBox, frame: &Frame, ground: &GroundMap) -> SceneBox {
    let p = b.center_m.truncate();
    let up_m = ground
        .height_m(p)
        .map_or(0.0, |m| m - frame.layout.relief.height_m(p));
    SceneBox {
        center_m: b.center_m + DVec3::Z * up_m,
        ..*b
    }
}

/// Columns of an extent between two corners.
fn columns_between(extent: Extent, low: DVec2, high: DVec2, mut take: impl FnMut([usize; 2])) {
    let cell = |p: DVec2| extent.to_voxel_units(p.extend(0.0)).truncate().floor();
    let (low, high) = (cell(low).max(DVec2::ZERO), cell(high));
    for x in low.x as usize..((high.x + 1.0).max(0.0) as usize).min(extent.nx()) {
        for y in low.y as usize..((high.y + 1.0).max(0.0) as usize).min(extent.ny()) {
            take([x, y]);
        }
    }
}
