//! Differences between two states of a scene, in numbers.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use scene::{BevLayer, Class, Frame, Scene, SceneBox};

/// Ids that a list holds at most.
const MOST_IDS: usize = 100;

/// Changes by a call. Of more than 100 boxes the first are named.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ChangeSummary {
    /// Boxes by what became of them.
    pub boxes: ChangeCounts,
    /// Ids of boxes that came.
    pub boxes_added: Vec<u32>,
    /// Ids of boxes that went.
    pub boxes_removed: Vec<u32>,
    /// Ids of boxes that moved, turned, or changed otherwise.
    pub boxes_changed: Vec<u32>,
    /// Things beside the road (buildings, trees, posts) by what became of them.
    pub things: ChangeCounts,
    /// Motions by what became of them; the ego vehicle counts as one.
    pub tracks: ChangeCounts,
    /// Cells of the map, 0.4 x 0.4 m each, in which a layer changed.
    pub layout_cells: usize,
    /// Cells set and cleared, by layer that changed.
    pub layers: BTreeMap<String, Gained>,
    /// Voxels that changed, 0.4 m each way.
    pub voxels: usize,
    /// Voxels gained and lost, by class that changed.
    pub classes: BTreeMap<String, Gained>,
    /// True if the map covers another area than before: then cells and voxels are compared where it lies now.
    pub map_resized: bool,
    /// True if time of day, weather or the prompt changed.
    pub conditions: bool,
    /// True if the length of the scene changed.
    pub length: bool,
    /// True if cameras or LiDARs changed.
    pub rig: bool,
}

/// How many came, went and changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ChangeCounts {
    /// That came.
    pub added: usize,
    /// That went.
    pub removed: usize,
    /// That are otherwise now.
    pub changed: usize,
}

/// How many came and went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Gained {
    /// That came.
    pub gained: usize,
    /// That went.
    pub lost: usize,
}

impl ChangeSummary {
    /// The differences between two states, at the moment that the later one shows.
    pub fn between(before: &Scene, after: &Scene) -> Self {
        if before.content() == after.content() {
            return Self::default();
        }
        let before = &match before.time_s() == after.time_s() {
            true => before.clone(),
            false => before.at(after.time_s()),
        };
        let (a, b) = (before.frame(), after.frame());
        let map_resized = a.extent() != b.extent();
        let a = &a.crop(b.extent());
        let ids = |found: &mut dyn Iterator<Item = u32>| found.take(MOST_IDS).collect::<Vec<u32>>();
        let added = || b.boxes.keys().filter(|id| !a.boxes.contains_key(id));
        let removed = || a.boxes.keys().filter(|id| !b.boxes.contains_key(id));
        let changed = || {
            let differs = |now: &&SceneBox| a.boxes.get(&now.id).is_some_and(|was| was != *now);
            b.boxes.values().filter(differs).map(|now| now.id)
        };
        let voxels = changed_voxels(a, b);
        let (layout_cells, layers) = layers(a, b);
        Self {
            boxes: ChangeCounts {
                added: added().count(),
                removed: removed().count(),
                changed: changed().count(),
            },
            boxes_added: ids(&mut added().map(|id| id.0)),
            boxes_removed: ids(&mut removed().map(|id| id.0)),
            boxes_changed: ids(&mut changed().map(|id| id.0)),
            things: things(before, after),
            tracks: tracks(before, after),
            layout_cells,
            layers,
            voxels: voxels.len(),
            classes: gained_and_lost(a, b, &voxels),
            map_resized,
            conditions: before.conditions != after.conditions || before.prompt != after.prompt,
            length: before.clip().length_s != after.clip().length_s,
            rig: before.rig != after.rig,
        }
    }
}

fn things(before: &Scene, after: &Scene) -> ChangeCounts {
    let (a, b) = (&before.background, &after.background);
    ChangeCounts {
        added: b.iter().filter(|t| a.get(t.id).is_none()).count(),
        removed: a.iter().filter(|t| b.get(t.id).is_none()).count(),
        changed: b
            .iter()
            .filter(|t| a.get(t.id).is_some_and(|was| was != *t))
            .count(),
    }
}

fn tracks(before: &Scene, after: &Scene) -> ChangeCounts {
    let (a, b) = (before.clip(), after.clip());
    let own = |was: bool, is: bool| usize::from(is && !was);
    let moved = b.tracks.iter().filter(|(id, now)| {
        let was = a.tracks.get(id);
        was.is_some_and(|was| was.motion != now.motion || was.there_s != now.there_s)
    });
    let ego_moved = a.ego.is_some() && b.ego.is_some() && a.ego != b.ego;
    ChangeCounts {
        added: b.tracks.keys().filter(|id| !a.tracks.contains_key(id)).count()
            + own(a.ego.is_some(), b.ego.is_some()),
        removed: a.tracks.keys().filter(|id| !b.tracks.contains_key(id)).count()
            + own(b.ego.is_some(), a.ego.is_some()),
        changed: moved.count() + usize::from(ego_moved),
    }
}

/// The number of cells that differ, and the cells that each map layer gained and lost; layers without a change are left
/// out.
fn layers(before: &Frame, after: &Frame) -> (usize, BTreeMap<String, Gained>) {
    let (a, b) = (before.layout.cells(), after.layout.cells());
    let mut layers: BTreeMap<String, Gained> = BTreeMap::new();
    let mut cells = 0;
    for (was, is) in a.iter().zip(b).filter(|(was, is)| was != is) {
        cells += 1;
        for layer in BevLayer::MAP {
            let bit = layer.bit();
            if (was ^ is) & bit != 0 {
                let of = layers.entry(layer.name().to_owned()).or_default();
                match is & bit != 0 {
                    true => of.gained += 1,
                    false => of.lost += 1,
                }
            }
        }
    }
    (cells, layers)
}

/// Voxels that differ between two frames of one extent, as indices `[x, y, z]`, in that order.
pub fn changed_voxels(before: &Frame, after: &Frame) -> Vec<[usize; 3]> {
    let (a, b) = (&before.occupancy, &after.occupancy);
    let mut out = Vec::new();
    for brick in b.changed_bricks(a) {
        let (from, size) = b.brick_columns(brick);
        for x in from[0]..from[0] + size[0] {
            for y in from[1]..from[1] + size[1] {
                let (a, b) = (a.column(x, y), b.column(x, y));
                out.extend((0..a.len()).filter(|z| a[*z] != b[*z]).map(|z| [x, y, z]));
            }
        }
    }
    out.sort_unstable();
    out
}

/// How many of the changed voxels each class gained and lost; classes that did neither are left out.
pub fn gained_and_lost(before: &Frame, after: &Frame, changed: &[[usize; 3]]) -> BTreeMap<String, Gained> {
    let mut counts = [Gained::default(); Class::COUNT];
    for &[x, y, z] in changed {
        if let Some(of) = counts.get_mut(usize::from(after.occupancy.get(x, y, z))) {
            of.gained += 1;
        }
        if let Some(of) = counts.get_mut(usize::from(before.occupancy.get(x, y, z))) {
            of.lost += 1;
        }
    }
    let all = Class::ALL.into_iter().zip(counts);
    all.filter(|(_, of)| *of != Gained::default())
        .map(|(class, of)| (class.name().to_owned(), of))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use editor::{Document, Edit, Shape};
    use glam::{DVec2, DVec3};
    use scene::{BoxLabel, VoxelGrid};

    #[test]
    fn a_change_is_counted_and_its_way_back_is_the_opposite() {
        let frame = Frame::new(Default::default(), Default::default(), VoxelGrid::new());
        let scene = Scene::single("s", frame, Default::default(), 0);
        let mut document = Document::new(scene);
        let before = document.scene().clone();
        let edits = [
            Edit::AddBox {
                class: Class::Car,
                center_m: DVec3::new(8.0, 2.0, 0.8),
                size_m: DVec3::new(4.0, 2.0, 1.6),
                yaw_deg: 0.0,
                velocity_mps: None,
                id: None,
                label: BoxLabel::default(),
            },
            Edit::PaintBev {
                layer: BevLayer::Walkway,
                shape: Shape::Rect {
                    min_m: DVec2::new(-10.0, -10.0),
                    max_m: DVec2::new(-8.0, -8.0),
                },
                value: true,
            },
        ];
        document.apply_all("Both", &edits).expect("sound edits");
        let there = ChangeSummary::between(&before, document.scene());
        assert_eq!((there.boxes.added, there.boxes_added.clone()), (1, vec![1]));
        assert_eq!(there.layout_cells, 25);
        assert_eq!(there.layers["walkway"], Gained { gained: 25, lost: 0 });
        assert!(there.classes["car"].gained > 10 && there.voxels >= there.classes["car"].gained);
        let back = ChangeSummary::between(document.scene(), &before);
        assert_eq!((back.boxes.removed, back.voxels), (1, there.voxels));
        assert_eq!(back.classes["car"].lost, there.classes["car"].gained);
        assert_eq!(ChangeSummary::between(&before, &before), ChangeSummary::default());
    }
}
