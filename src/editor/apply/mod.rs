//! Applies edits: changes the data, and at once puts a rough version into the voxels.

mod arranged;
mod at;
mod box_run;
mod boxes;
mod correct;
mod extend;
pub mod forecast;
pub mod left_standing;
mod let_move;
mod map;
mod motion;
pub mod off_lane;
pub mod start;
mod voxels;

use std::sync::Arc;

use scene::{Edit, EditError, Frame, Scene, Scope, SensorRig};

use super::things;
pub(crate) use voxels::adopt;

/// How many typed texts a scene keeps, and how many letters of each.
const MOST_WORDS: usize = 200;
const LONGEST_WORDS: usize = 2000;

/// Applies edits to a scene.
pub trait Apply {
    /// Applies the edit to the scene's current frame: changes the data and puts a rough version into the voxels (a
    /// correction changes no voxels). On error the scene is as before. An edit that changes nothing keeps the revision.
    /// Of the edits only [`Edit::Correct`] changes the frame's `source`.
    fn apply(&self, scene: &mut Scene) -> Result<(), EditError>;
}

impl Apply for Edit {
    fn apply(&self, scene: &mut Scene) -> Result<(), EditError> {
        match self {
            Self::SetPrompt { prompt } => {
                if scene.prompt.as_ref() != prompt {
                    scene.touch();
                    scene.prompt = prompt.as_str().into();
                }
            }
            Self::SetConditions { conditions } => {
                if let Some(problem) = conditions.problem() {
                    return Err(EditError::BadConditions(problem));
                }
                if scene.conditions != *conditions {
                    scene.touch();
                    scene.conditions = *conditions;
                }
            }
            Self::KeepWords { words } => {
                scene.touch();
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
                    scene.touch();
                    scene.rig = Arc::new(SensorRig::clone(rig));
                }
            }
            Self::ClearScenery { shape } => {
                let extent = scene.canvas().extent();
                let cells = shape.as_ref().map(|s| s.cells(extent)).transpose()?;
                things::clear_scenery(scene, cells.as_deref());
            }
            edit if edit.is_of_things() => {
                if let Some(background) = things::changed(self, &scene.background)? {
                    things::replace_background(scene, background);
                }
            }
            Self::At { .. } => at::apply(self, scene)?,
            Self::SetMotion { .. } | Self::SetLength { .. } | Self::SetShape { .. } => {
                motion::apply(self, scene)?
            }
            Self::Arrange { .. } => arranged::apply(self, scene)?,
            Self::ChangeRoads { change } => crate::roads::apply(scene, change)?,
            Self::ExtendMap { .. } => extend::apply(self, scene)?,
            Self::LetMove { .. } => all_or_nothing(scene, &let_move::let_move(scene, self)?)?,
            Self::Forecast { seconds } => {
                let found = forecast::forecast(scene, *seconds).map_err(EditError::BadMotion)?;
                all_or_nothing(scene, &found.edits)?;
            }
            Self::LetTrafficDrive {} => {
                let start = start::traffic_drives(scene).map_err(EditError::BadMotion)?;
                all_or_nothing(scene, &start.edits)?;
            }
            edit => at::apply_scoped(edit, scene, Scope::default())?,
        }
        arranged::keep(scene);
        Ok(())
    }
}

/// Applies edits in order; on an error the scene is as before.
fn all_or_nothing(scene: &mut Scene, edits: &[Edit]) -> Result<(), EditError> {
    let mut after = scene.clone();
    apply_all(edits, &mut after)?;
    *scene = after;
    Ok(())
}

/// Applies edits in order and stops at the first error. After a run of edits of things, their voxels are drawn once.
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
    arranged::keep(scene);
    Ok(())
}

/// Applies an edit of a frame. Edits of the whole scene do nothing here; [`Apply::apply`] does them.
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
