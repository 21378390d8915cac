//! Voxels that stay behind when a box that was fitted to them is removed: one object in labels may have become several
//! boxes, as a crane does, and the others stay.

use std::collections::BTreeSet;

use language::{t, tf};
use scene::{Class, Edit, Frame, Scene, SceneBox, support};

use super::apply_all;

/// Voxels this far outside a box still belong to it, m.
const MARGIN_M: f64 = 0.6;
/// Fewer voxels that stay are noise of labels.
const LEAST_VOXELS: usize = 4;
/// Boxes that are named.
const MOST_NAMED: usize = 8;

/// Remarks on the boxes that the edits remove, a line each: the voxels of their class that were connected to theirs and
/// stay, and the boxes that hold these voxels. Only boxes inferred from voxels get a remark.
pub fn left_standing(scene: &Scene, edits: &[Edit]) -> Vec<String> {
    let frame = scene.frame();
    let removed = edits.iter().filter_map(|edit| match edit {
        Edit::RemoveBox { id } if frame.inferred.boxes.contains(id) => frame.boxes.get(id),
        _ => None,
    });
    let removed: Vec<&SceneBox> = removed.collect();
    let mut after = scene.clone();
    if removed.is_empty() || apply_all(edits, &mut after).is_err() {
        return Vec::new();
    }
    let after = after.frame();
    if after.extent() != frame.extent() {
        return Vec::new();
    }
    let classes: BTreeSet<Class> = removed.iter().map(|b| b.class).collect();
    let mut out = Vec::new();
    for class in classes {
        let of_class = frame.occupancy.iter_set().filter(|(.., l)| *l == class.id());
        let cells = of_class.map(|(x, y, z, _)| [x, y, z]).collect();
        for mut piece in support::groups(frame.extent(), cells) {
            let holds = |b: &SceneBox| {
                let mut centers = piece.iter().map(|&[x, y, z]| frame.extent().center(x, y, z));
                b.class == class && centers.any(|p| b.contains(p, MARGIN_M))
            };
            let Some(gone) = removed.iter().find(|b| holds(b)) else {
                continue;
            };
            let name = name_of(gone);
            piece.retain(|&[x, y, z]| after.occupancy.get(x, y, z) == class.id());
            if piece.len() >= LEAST_VOXELS {
                out.push(told(&name, &piece, class, after));
            }
        }
    }
    out
}

fn told(gone: &str, left: &[[usize; 3]], class: Class, after: &Frame) -> String {
    let holds = |b: &&SceneBox| {
        let mut centers = left.iter().map(|&[x, y, z]| after.extent().center(x, y, z));
        b.class == class && centers.any(|p| b.contains(p, MARGIN_M))
    };
    let boxes: Vec<String> = after.boxes.values().filter(holds).map(name_of).collect();
    let named = boxes[..boxes.len().min(MOST_NAMED)].join(", ");
    match boxes.is_empty() {
        true => tf!(
            "{n} voxels that touched {thing} stay, in no box: they may be a part of it",
            n = left.len(),
            thing = gone
        ),
        false => tf!(
            "{n} voxels that touched {thing} stay, in {boxes}: they may be one object",
            n = left.len(),
            thing = gone,
            boxes = named
        ),
    }
}

fn name_of(b: &SceneBox) -> String {
    format!("{} {}", t(&b.class.label()), b.id.0)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use scene::{BevLayout, BoxId, Extent, SensorRig, VoxelGrid, infer};

    use super::*;
    use crate::remarks;

    /// Labels of a crane of 30 m with a boom to the side, and of a single machine 20 m away; boxes as an import infers them.
    fn site() -> Scene {
        let mut labels = VoxelGrid::new();
        let machine = Class::ConstructionVehicle.id();
        let mut fill = |xs: std::ops::Range<usize>, ys: std::ops::Range<usize>| {
            for x in xs {
                for y in ys.clone() {
                    (1..8).for_each(|z| labels.set(x, y, z, machine));
                }
            }
        };
        fill(60..135, 98..106);
        fill(120..128, 106..130);
        fill(80..90, 150..156);
        for x in 0..Extent::WINDOW.nx() {
            (0..Extent::WINDOW.ny()).for_each(|y| labels.set(x, y, 0, Class::DriveableSurface.id()));
        }
        let boxes = infer::boxes(&labels);
        let mut frame = Frame::new(BevLayout::default(), boxes, labels);
        frame.inferred.boxes = frame.boxes.keys().copied().collect();
        Scene::single("site", frame, Arc::new(SensorRig::default()), 0)
    }

    #[test]
    fn a_crane_of_several_boxes_is_told_when_one_is_removed() {
        let scene = site();
        let single = |b: &SceneBox| b.center_m.y > 15.0;
        let (alone, crane): (Vec<&SceneBox>, Vec<&SceneBox>) =
            scene.frame().boxes.values().partition(|b| single(b));
        assert!(crane.len() > 1 && alone.len() == 1, "{crane:?} {alone:?}");
        let remove = |id: BoxId| [Edit::RemoveBox { id }];
        let said = remarks(&scene, &remove(crane[0].id));
        assert_eq!(said.len(), 1, "{said:?}");
        let others = crane[1..].iter().map(|b| name_of(b));
        assert!(others.clone().any(|name| said[0].contains(&name)), "{said:?}");
        assert!(
            said[0].contains(&format!("touched {} stay, in ", name_of(crane[0]))),
            "{said:?}"
        );
        // What stands alone goes as a whole, and a box that somebody made says nothing.
        assert_eq!(remarks(&scene, &remove(alone[0].id)), Vec::<String>::new());
        let mut own = scene.clone();
        own.change_canvas(|canvas| canvas.inferred.boxes.clear());
        assert_eq!(remarks(&own, &remove(crane[0].id)), Vec::<String>::new());
        // All of its boxes removed together leave no more than the rim that no box holds.
        let all: Vec<Edit> = crane.iter().map(|b| Edit::RemoveBox { id: b.id }).collect();
        assert!(
            remarks(&scene, &all)
                .iter()
                .all(|line| line.contains("in no box"))
        );
    }
}
