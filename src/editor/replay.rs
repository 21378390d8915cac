//! Applies one change of a log to a state: as it was made, or to a state that earlier changes are left out of.

use std::collections::BTreeSet;
use std::sync::Arc;

use scene::op::{Change, Op};
use scene::{Background, BoxId, Edit, EditError, Frame, Scene, Thing, ThingId, VoxelGrid};

/// The state with edits applied; all of them, or an error.
pub(crate) fn edited(scene: &Scene, edits: &[Edit]) -> Result<Scene, EditError> {
    super::arranged::locked(scene, edits)?;
    let mut scene = Scene::clone(scene);
    super::apply::apply_all(edits, &mut scene)?;
    Ok(scene)
}

/// The state with a generated occupancy of [`Scene::for_generation`]'s frame, and with the scenery that came with it.
pub(crate) fn with_result(
    scene: &Scene,
    occupancy: VoxelGrid,
    background: Option<&Arc<Background>>,
) -> Result<Scene, EditError> {
    let mut frame = Frame::clone(scene.for_generation().frame());
    super::apply::adopt(&mut frame, occupancy)?;
    let mut scene = Scene::clone(scene);
    if let Some(background) = background {
        scene.background = background.clone();
    }
    scene.set_generated(frame);
    Ok(scene)
}

/// A state after a change, and the number of voxels of its result that could not be put in.
pub(crate) struct Replayed {
    pub(crate) scene: Scene,
    pub(crate) unmatched: usize,
}

/// The state after a change. Errors in one line if it does not apply to this state, and on [`Change::Without`], which is
/// no change of a state alone.
pub(crate) fn replay(before: &Scene, op: &Op) -> Result<Replayed, String> {
    let mut scene = Scene::clone(before);
    scene.show(op.shown_s);
    let mut unmatched = 0;
    let scene = match &op.change {
        Change::Edits { edits, things_from } => {
            if let Some(first) = things_from {
                Arc::make_mut(&mut scene.background).give_from(*first);
            }
            let mut scene = edited(&scene, edits).map_err(|e| e.to_string())?;
            if things_from.is_some() {
                Arc::make_mut(&mut scene.background).give_from(ThingId(0));
            }
            scene
        }
        Change::Result { patch, background } => {
            let mut occupancy = scene.for_generation().frame().occupancy.clone();
            unmatched = patch
                .apply(&mut occupancy)
                .ok_or_else(|| format!("the result is of a map of {}", patch.extent()))?;
            with_result(&scene, occupancy, background.as_ref()).map_err(|e| e.to_string())?
        }
        Change::Restore(state) => state.scene.at(op.shown_s),
        Change::Without { .. } => return Err("changes that are left out are no change of a state".into()),
    };
    Ok(Replayed { scene, unmatched })
}

/// Edits as the log keeps them: boxes that they added bear the numbers that they got, so that they get no others when
/// something before is left out.
pub(crate) fn numbered(edits: &[Edit], before: &Scene, after: &Scene) -> Change {
    let mut edits = edits.to_vec();
    let mut open: Vec<&mut Option<BoxId>> = edits.iter_mut().filter_map(number_to_give).collect();
    if !open.is_empty() {
        let known = ids(before);
        let new: Vec<BoxId> = ids(after).into_iter().filter(|id| !known.contains(id)).collect();
        if new.len() == open.len() {
            // Numbers are given in increasing order.
            open.iter_mut().zip(new).for_each(|(open, id)| **open = Some(id));
        }
    }
    let things_from = things_from(&edits, before, after);
    Change::Edits {
        edits: edits.into(),
        things_from,
    }
}

/// The number of the first thing that edits add, if they add any.
fn things_from(edits: &[Edit], before: &Scene, after: &Scene) -> Option<ThingId> {
    let adds = |edit: &Edit| matches!(edit, Edit::AddThings { .. } | Edit::DrawScenery { .. });
    let first = edits.iter().position(adds)?;
    // Numbers of things that were taken out before it are given again.
    let mut background = before.background.clone();
    for edit in edits[..first].iter().filter(|edit| edit.is_of_things()) {
        if let Ok(Some(changed)) = super::things::changed(edit, &background) {
            background = Arc::new(changed);
        }
    }
    // Other edits may change things as well: no number below the first that is new is held back.
    let is_new = |thing: &&Thing| before.background.get(thing.id) != Some(*thing);
    let new = after.background.iter().find(is_new)?;
    Some(background.next_id().min(new.id))
}

/// The number of a box that an edit adds without one.
fn number_to_give(edit: &mut Edit) -> Option<&mut Option<BoxId>> {
    match edit {
        Edit::AddBox { id, .. } if id.is_none() => Some(id),
        Edit::At { edit, .. } | Edit::Correct { edit } => number_to_give(edit),
        _ => None,
    }
}

/// All boxes, standing and moving.
fn ids(scene: &Scene) -> BTreeSet<BoxId> {
    let standing = scene.canvas().boxes.keys();
    standing.chain(scene.clip().tracks.keys()).copied().collect()
}

/// Parts of a scene that numbers of later changes refer to: where a change of them is left out, later ones would mean
/// something else.
#[derive(Clone, Copy, Default)]
pub(crate) struct Renumbered {
    roads: bool,
    columns: bool,
}

impl Renumbered {
    /// Notes that a change is left out.
    pub(crate) fn note(&mut self, op: &Op) {
        if let Change::Edits { edits, .. } = &op.change {
            self.roads |= edits.iter().any(|edit| within(edit, &is_of_roads));
            self.columns |= edits.iter().any(|edit| within(edit, &is_of_extent));
        }
    }

    /// The reason why a later change cannot be applied without those.
    pub(crate) fn problem(self, op: &Op) -> Option<&'static str> {
        let Change::Edits { edits, .. } = &op.change else {
            return None;
        };
        let has = |kind: fn(&Edit) -> bool| edits.iter().any(|edit| within(edit, &kind));
        if self.roads && has(is_of_roads) {
            return Some("it is of roads as an earlier change left them");
        }
        if self.columns && has(is_of_cells) {
            return Some("it is of voxels of the map as an earlier change left it");
        }
        None
    }
}

fn is_of_roads(edit: &Edit) -> bool {
    matches!(edit, Edit::ChangeRoads { .. })
}

fn is_of_extent(edit: &Edit) -> bool {
    matches!(edit, Edit::ExtendMap { .. } | Edit::Forecast { .. })
}

fn is_of_cells(edit: &Edit) -> bool {
    matches!(edit, Edit::PaintVoxels { .. } | Edit::UnlockVoxels { .. })
}

/// True if an edit, or the one inside it, is of a kind.
fn within(edit: &Edit, kind: &dyn Fn(&Edit) -> bool) -> bool {
    match edit {
        Edit::At { edit, .. } | Edit::Correct { edit } => within(edit, kind),
        edit => kind(edit),
    }
}
