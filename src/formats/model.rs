//! A single object out of a file of any format that holds a scene: a glTF model, a MagicaVoxel shape, a box of a project.

use std::path::Path;

use scene::{BoxId, Model};

use crate::FormatError;
use crate::import::{self, Content};

/// Reads an object; `id` names the box where a file holds several. Errors in one line as [`import::read`] does, for a file
/// without objects, and for several where none is named.
pub fn read(path: &Path, id: Option<BoxId>) -> Result<Model, FormatError> {
    let (importer, content) = import::read(path)?;
    let Content::Scene(loaded) = content else {
        return Err(FormatError::new(format!("{}, expected a model", importer.title)).at(&path.display()));
    };
    Model::of(&loaded.scene, id).map_err(|problem| FormatError::new(problem).at(&path.display()))
}
