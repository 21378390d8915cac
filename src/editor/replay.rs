//! Applies one change of a log to a state: as it was made, or to a state that earlier changes are left out of.

use std::sync::Arc;

use scene::op::{Change, Op};
use scene::{Background, Edit, EditError, Frame, Scene, VoxelGrid};

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
        Change::Edits(edits) => edited(&scene, edits).map_err(|e| e.to_string())?,
        Change::Result { patch, background } => {
            let mut occupancy = scene.for_generation().frame().occupancy.clone();
            unmatched = patch
                .apply(&mut occupancy)
                .ok_or_else(|| format!("the result is of a map of {}", patch.extent()))?;
            with_result(&scene, occupancy, background.as_ref()).map_err(|e| e.to_string())?
        }
        Change::Restore(state) => state.scene.at(op.shown_s),
        Change::Without(_) => return Err("changes that are left out are no change of a state".into()),
    };
    Ok(Replayed { scene, unmatched })
}
