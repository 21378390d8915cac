//! Applies edits: the authored data, and at once a rough version in the voxels.

mod at;
mod box_run;
mod boxes;
mod correct;
mod map;
mod voxels;

use std::sync::Arc;

use scene::{Edit, EditError, Frame, Scene, SensorRig};

use super::things;
pub(crate) use voxels::adopt;

/// Texts of words that a scene keeps, and letters of each.
const MOST_WORDS: usize = 200;
const LONGEST_WORDS: usize = 2000;

/// Applies edits to a scene.
pub trait Apply {
    /// Applies the change to the scene's current frame: the authored data and, at once, a rough
    /// version in the voxels (a correction leaves them). All or nothing: on error the scene is as before. A change that
    /// changes nothing leaves the revision as it is. The frame's `source` is touched by
    /// [`Edit::AdoptResult`] and [`Edit::Correct`] only.
    fn apply(&self, scene: &mut Scene) -> Result<(), EditError>;
}

impl Apply for Edit {
    fn apply(&self, scene: &mut Scene) -> Result<(), EditError> {
        match self {
            Self::SetPrompt { prompt } => {
                if scene.prompt.as_ref() != prompt {
                    scene.rev = scene::SceneRev::fresh();
                    scene.prompt = prompt.as_str().into();
                }
            }
            Self::SetConditions { conditions } => {
                if let Some(problem) = conditions.problem() {
                    return Err(EditError::BadConditions(problem));
                }
                if scene.conditions != *conditions {
                    scene.rev = scene::SceneRev::fresh();
                    scene.conditions = *conditions;
                }
            }
            Self::KeepWords { words } => {
                scene.rev = scene::SceneRev::fresh();
                let kept = Arc::make_mut(&mut scene.words);
                kept.push(words.chars().take(LONGEST_WORDS).collect());
                let over = kept.len().saturating_sub(MOST_WORDS);
                kept.drain(..over);
            }
            Self::SetRig { rig } => {
                if let Some(problem) = rig.problem() {
                    return Err(EditError::BadRig(problem));
                }
                if *scene.rig != **rig {
                    scene.rev = scene::SceneRev::fresh();
                    scene.rig = Arc::new(SensorRig::clone(rig));
                }
            }
            Self::ClearScenery { shape } => {
                let extent = scene.frame().extent();
                let cells = shape.as_ref().map(|s| s.cells(extent)).transpose()?;
                things::clear_scenery(scene, cells.as_deref());
            }
            edit if edit.is_of_things() => {
                if let Some(background) = things::changed(self, &scene.background)? {
                    things::replace_background(scene, background);
                }
            }
            Self::At { .. } => at::apply(self, scene)?,
            edit => {
                // A frame is a few hundred pointers; working on a copy makes "all or nothing" certain.
                let mut frame = Frame::clone(scene.frame());
                apply_to(edit, &mut frame)?;
                if frame != **scene.frame() {
                    *scene.frame_mut() = frame;
                }
            }
        }
        Ok(())
    }
}

/// Applies edits in order; an error stops there. Things that are changed one after another are drawn once, at the end.
pub fn apply_all(edits: &[Edit], scene: &mut Scene) -> Result<(), EditError> {
    let goes_on =
        |a: &Edit, b: &Edit| a.is_of_things() && b.is_of_things() || a.is_of_a_box() && b.is_of_a_box();
    for run in edits.chunk_by(goes_on) {
        if run[0].is_of_a_box() {
            box_run::apply(run, scene)?;
            continue;
        }
        if !run[0].is_of_things() {
            run.iter().try_for_each(|edit| edit.apply(scene))?;
            continue;
        }
        let mut background = None;
        for edit in run {
            let before = background.as_ref().unwrap_or(&*scene.background);
            background = things::changed(edit, before)?.or(background);
        }
        if let Some(background) = background {
            things::replace_background(scene, background);
        }
    }
    Ok(())
}

/// Applies an edit of a frame; one of the scene ([`Apply::apply`]) does nothing here.
fn apply_to(edit: &Edit, frame: &mut Frame) -> Result<(), EditError> {
    let parts = [boxes::apply, map::apply, voxels::apply, correct::apply];
    for apply in parts {
        if apply(edit, frame)? {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
