//! Files of any format, read with what the networks add: objects in sweeps without labels.

use std::path::Path;

use formats::FormatError;
use formats::import::{self, Content, ImportOptions, ImportedScene, Importer};
use nets::perceiver::LidarPerceiver;
use scene::BoxId;

/// Reads a file as [`import::read_with`] does; in a sweep without labels objects are found, each a guess. The file of a
/// sweep is kept with the scene.
pub fn file_with(path: &Path, options: ImportOptions) -> Result<(&'static Importer, Content), FormatError> {
    let (importer, content) = import::read_with(path, options)?;
    Ok(match content {
        Content::Scene(loaded) => {
            let loaded = with_objects(*loaded).with_recording();
            (importer, Content::Scene(Box::new(loaded)))
        }
        other => (importer, other),
    })
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
#[path = "read_tests.rs"]
mod tests;
