//! Hidden and locked objects: locks keep objects from edits, and hidden objects are left out of the large views.

use std::sync::Arc;

use scene::{BoxId, Edit, EditError, Members, Scene, ThingId};

use super::apply::apply_all;

/// The box that an edit changes by its number.
pub(crate) fn box_of(edit: &Edit) -> Option<BoxId> {
    match edit {
        Edit::RemoveBox { id }
        | Edit::MoveBox { id, .. }
        | Edit::LabelBox { id, .. }
        | Edit::SetBoxClass { id, .. }
        | Edit::SetShape { id, .. } => Some(*id),
        Edit::SetMotion { id, .. } | Edit::LetMove { id, .. } => *id,
        Edit::Correct { edit } | Edit::At { edit, .. } => box_of(edit),
        _ => None,
    }
}

/// The things that an edit changes by their numbers.
pub(crate) fn things_of(edit: &Edit) -> &[ThingId] {
    match edit {
        Edit::RemoveThings { ids } | Edit::MoveThings { ids, .. } | Edit::RaiseThings { ids, .. } => ids,
        Edit::ChangeThing { id, .. } => std::slice::from_ref(id),
        Edit::Correct { edit } | Edit::At { edit, .. } => things_of(edit),
        _ => &[],
    }
}

/// The first locked object that edits would change, as an error. An edit before may have unlocked it.
pub fn locked(scene: &Scene, edits: &[Edit]) -> Result<(), EditError> {
    let mut arranged = scene.arranged.as_ref().clone();
    for edit in edits {
        if arranged.locked.is_empty() {
            return Ok(());
        }
        if let Edit::Arrange { boxes, things, how } = edit {
            arranged.arrange(&Members::of(boxes.iter().copied(), things.iter().copied()), how);
        }
        if let Some(id) = box_of(edit).filter(|id| arranged.locked.boxes.contains(id)) {
            return Err(EditError::LockedBox { id });
        }
        if let Some(id) = things_of(edit)
            .iter()
            .find(|id| arranged.locked.things.contains(id))
        {
            return Err(EditError::LockedThing { id: *id });
        }
    }
    Ok(())
}

/// Edits without their effect on locked objects, and these objects.
pub fn unlocked(scene: &Scene, edits: Vec<Edit>) -> (Vec<Edit>, Members) {
    let (locked, mut kept) = (&scene.arranged.locked, Members::default());
    if locked.is_empty() {
        return (edits, kept);
    }
    let mut open = Vec::with_capacity(edits.len());
    for mut edit in edits {
        if let Some(id) = box_of(&edit).filter(|id| locked.boxes.contains(id)) {
            kept.boxes.insert(id);
            continue;
        }
        kept.things
            .extend(things_of(&edit).iter().filter(|id| locked.things.contains(id)));
        match &mut edit {
            Edit::RemoveThings { ids } | Edit::MoveThings { ids, .. } | Edit::RaiseThings { ids, .. } => {
                ids.retain(|id| !locked.things.contains(id));
                if !ids.is_empty() {
                    open.push(edit);
                }
            }
            other if things_of(other).iter().any(|id| locked.things.contains(id)) => {}
            _ => open.push(edit),
        }
    }
    (open, kept)
}

/// The scene as the large views show it: without hidden objects and their voxels.
pub fn seen(scene: &Arc<Scene>) -> Arc<Scene> {
    let hidden = &scene.arranged.hidden;
    if hidden.is_empty() {
        return scene.clone();
    }
    let mut seen = Scene::clone(scene);
    let there = hidden
        .boxes
        .iter()
        .filter(|id| scene.frame().boxes.contains_key(id));
    let mut edits: Vec<Edit> = there.map(|id| Edit::RemoveBox { id: *id }).collect();
    if !hidden.things.is_empty() {
        let ids = hidden.things.iter().copied().collect();
        edits.push(Edit::RemoveThings { ids });
    }
    match apply_all(&edits, &mut seen) {
        Ok(()) => Arc::new(seen),
        // (hidden objects exist: a file that names others is refused, and edits drop them)
        Err(_) => scene.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Document;
    use glam::{DVec2, DVec3};
    use scene::background::{Tree, TreeKind};
    use scene::{Arrangement, BevLayout, BoxName, Class, Form, Frame, VoxelGrid};

    fn document() -> Document {
        let layout = BevLayout::default();
        let frame = Frame::new(layout, Default::default(), VoxelGrid::new());
        let mut document = Document::new(Scene::single("t", frame, Default::default(), 1));
        let car = |x: f64| Edit::AddBox {
            class: Class::Car,
            center_m: DVec3::new(x, 0.0, 0.0),
            size_m: DVec3::new(4.4, 1.8, 1.6),
            yaw_deg: 0.0,
            velocity_mps: None,
            id: None,
            label: Default::default(),
        };
        let tree = Form::Tree(Tree {
            position_m: DVec2::new(0.0, 10.0),
            height_m: 6.0,
            crown_radius_m: 1.5,
            kind: TreeKind::Conifer,
        });
        let edits = [
            car(-10.0),
            car(0.0),
            car(10.0),
            Edit::AddThings { forms: vec![tree] },
        ];
        document
            .apply_all("Three cars and a tree", &edits)
            .expect("sound");
        document
    }

    fn arrange(boxes: &[u32], things: &[ThingId], how: Arrangement) -> Edit {
        Edit::Arrange {
            boxes: boxes.iter().map(|id| BoxId(*id)).collect(),
            things: things.to_vec(),
            how,
        }
    }

    fn tree(document: &Document) -> ThingId {
        document.scene().background.iter().next().expect("the tree").id
    }

    #[test]
    fn a_lock_keeps_from_edits_of_every_kind_until_it_is_taken_off() {
        let mut document = document();
        let tree = tree(&document);
        document
            .apply("Lock", &arrange(&[2], &[tree], Arrangement::Lock))
            .expect("there");
        let before = document.scene().clone();
        let id = BoxId(2);
        let turn = Edit::MoveBox {
            id,
            center_m: None,
            yaw_deg: Some(30.0),
            size_m: None,
        };
        let at = Edit::At {
            frame: None,
            time_s: Some(0.0),
            track: None,
            scope: None,
            edit: Box::new(turn.clone()),
        };
        for edit in [
            turn.clone(),
            at,
            Edit::RemoveBox { id },
            Edit::SetBoxClass {
                id,
                class: Class::Bus,
            },
            Edit::SetMotion {
                id: Some(id),
                motion: None,
                from_s: None,
                to_s: None,
            },
        ] {
            assert_eq!(document.apply("x", &edit), Err(EditError::LockedBox { id }));
            assert!(document.preview(&edit).is_err());
        }
        let fell = Edit::RemoveThings { ids: vec![tree] };
        assert_eq!(
            document.apply("x", &fell),
            Err(EditError::LockedThing { id: tree })
        );
        assert_eq!(document.scene().content(), before.content());
        // Of several, the others change.
        let all = vec![Edit::RemoveBox { id: BoxId(1) }, Edit::RemoveBox { id }, fell];
        let (open, kept) = unlocked(&before, all);
        assert_eq!(open, [Edit::RemoveBox { id: BoxId(1) }]);
        assert_eq!(kept, Members::of([id], [tree]));
        document
            .apply_all("x", &[arrange(&[2], &[], Arrangement::Unlock), turn])
            .expect("unlocked first");
    }

    #[test]
    fn what_is_hidden_is_not_seen_and_still_there() {
        let mut document = document();
        let tree = tree(&document);
        let solid = |scene: &Scene| {
            let grid = &scene.frame().occupancy;
            let [nx, ny, nz] = grid.extent().shape();
            let cells = (0..nx).flat_map(|x| (0..ny).flat_map(move |y| (0..nz).map(move |z| (x, y, z))));
            cells
                .filter(|(x, y, z)| grid.get(*x, *y, *z) == Class::Car.id())
                .count()
        };
        let all = solid(document.scene());
        document
            .apply("Hide", &arrange(&[2], &[tree], Arrangement::Hide))
            .expect("there");
        let seen = seen(document.scene());
        assert_eq!(solid(document.scene()), all);
        // Of three cars alike two are seen, give or take how they lie on the grid.
        let share = solid(&seen) as f64 / all as f64;
        assert!((share - 2.0 / 3.0).abs() < 0.02, "{share}");
        assert_eq!((seen.frame().boxes.len(), seen.background.len()), (2, 0));
        document.undo();
        assert!(Arc::ptr_eq(&super::seen(document.scene()), document.scene()));
    }

    #[test]
    fn who_goes_leaves_its_group_and_its_number_means_nothing_to_the_next() {
        let mut document = document();
        let name = BoxName::new("queue");
        document
            .apply("Group", &arrange(&[1, 2, 3], &[], Arrangement::Group { name }))
            .expect("there");
        document
            .apply("Hide", &arrange(&[3], &[], Arrangement::Hide))
            .expect("there");
        document
            .apply("Remove", &Edit::RemoveBox { id: BoxId(3) })
            .expect("there");
        let arranged = &document.scene().arranged;
        assert!(arranged.hidden.is_empty());
        assert_eq!(arranged.groups[0].members, Members::of([BoxId(1), BoxId(2)], []));
        document
            .apply("Remove", &Edit::RemoveBox { id: BoxId(2) })
            .expect("there");
        assert!(document.scene().arranged.is_empty());
        document.undo();
        assert_eq!(document.scene().arranged.groups.len(), 1);
        let missing = arrange(&[9], &[], Arrangement::Lock);
        assert_eq!(
            document.apply("x", &missing),
            Err(EditError::UnknownBox { id: BoxId(9) })
        );
    }
}
