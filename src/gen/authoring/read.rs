//! Files of any format, read with what the networks add: objects in sweeps without labels.

use std::path::Path;
use std::sync::Arc;

use formats::FormatError;
use formats::import::{self, Content, ImportOptions, ImportedScene, Importer};
use nets::perceiver::LidarPerceiver;
use scene::{BoxId, Scene, SensorRig};
use sensors::lidar::recorded::EditableSweep;

/// Reads a file as [`import::read_with`] does; in a sweep without labels objects are found, each a guess. The file of a
/// sweep is kept with the scene, whose LiDAR gets the beams of the sweep.
pub fn file_with(path: &Path, options: ImportOptions) -> Result<(&'static Importer, Content), FormatError> {
    let (importer, content) = import::read_with(path, options)?;
    Ok(match content {
        Content::Scene(loaded) => {
            let is_sweep = loaded.sweep.is_some();
            let mut loaded = with_objects(*loaded).with_recording();
            let pattern = is_sweep.then(|| take_pattern(&mut loaded.scene)).flatten();
            if let Some([beams, columns]) = pattern {
                let note =
                    format!("the LiDAR has {beams} beams and {columns} columns a turn, as the sweep shows");
                loaded.notes.push(note);
            }
            (importer, Content::Scene(Box::new(loaded)))
        }
        other => (importer, other),
    })
}

/// Gives the first LiDAR of a scene the beams of the sweep that it was imported from; their number, and the columns of a turn.
fn take_pattern(scene: &mut Scene) -> Option<[usize; 2]> {
    let first = scene.kept.sweeps.first()?.clone();
    let pattern = EditableSweep::new(first.clone(), &[]).pattern(scene.rig.lidars.first()?)?;
    let told = [pattern.elevations_deg.len(), pattern.columns as usize];
    let mut rig = SensorRig::clone(&scene.rig);
    rig.lidars[0] = pattern;
    if rig.problem().is_some() {
        return None;
    }
    scene.rig = Arc::new(rig);
    let mut before = Scene::clone(&first.before);
    before.rig = scene.rig.clone();
    let before = Arc::new(before);
    for sweep in &mut Arc::make_mut(&mut scene.kept).sweeps {
        Arc::make_mut(sweep).before = before.clone();
    }
    Some(told)
}

/// The scene with the objects that the network finds in its sweep, if it has one.
fn with_objects(mut loaded: ImportedScene) -> ImportedScene {
    let Some(sweep) = loaded.sweep.as_ref().filter(|sweep| !sweep.returns.is_empty()) else {
        return loaded;
    };
    let found = LidarPerceiver::bundled()
        .map_err(|e| e.to_string())
        .and_then(|net| {
            net.objects_of_sweep(&sweep.returns, sweep.sensor_m)
                .map_err(|e| e.to_string())
        });
    match found {
        Ok(objects) => {
            let boxes = objects.iter().map(|found| found.to_box(BoxId(0))).collect();
            loaded.with_objects(boxes)
        }
        Err(problem) => {
            loaded
                .notes
                .push(format!("no objects were looked for: {problem}"));
            loaded
        }
    }
}

#[cfg(test)]
#[path = "recorded_tests.rs"]
mod recorded_tests;
#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
