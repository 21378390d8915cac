//! Edits that group, hide and lock objects.

use std::sync::Arc;

use scene::{BoxId, Edit, EditError, Members, Scene};

/// Groups, hides or locks, or the opposite.
pub(super) fn apply(edit: &Edit, scene: &mut Scene) -> Result<(), EditError> {
    let Edit::Arrange { boxes, things, how } = edit else {
        return Ok(());
    };
    let has = |id: &BoxId| scene.canvas().boxes.contains_key(id) || scene.clip().tracks.contains_key(id);
    if let Some(id) = boxes.iter().find(|id| !has(id)) {
        return Err(EditError::UnknownBox { id: *id });
    }
    if let Some(id) = things.iter().find(|id| scene.background.get(**id).is_none()) {
        return Err(EditError::UnknownThing { id: *id });
    }
    let mut arranged = scene.arranged.as_ref().clone();
    arranged.arrange(&Members::of(boxes.iter().copied(), things.iter().copied()), how);
    if arranged != *scene.arranged {
        scene.touch();
        scene.arranged = Arc::new(arranged);
    }
    Ok(())
}

/// Drops objects from the arrangement that no longer exist.
pub(super) fn keep(scene: &mut Scene) {
    if !scene.arranged.is_empty() {
        let mut arranged = scene.arranged.as_ref().clone();
        arranged.keep(scene);
        if arranged != *scene.arranged {
            scene.arranged = Arc::new(arranged);
        }
    }
}
