//! What a folder of training data was made of, so that a run that goes on does not mix two.

use std::path::Path;

use anyhow::{Context, bail};
use serde_json::{Map, Value};

use super::output;

/// The file of it.
const FILE: &str = "recipe.json";

/// Notes the arguments in a folder. Errors if data that were made with others are there.
pub(super) fn claim(dir: &Path, recipe: &Map<String, Value>) -> anyhow::Result<()> {
    let file = dir.join(FILE);
    let before = match std::fs::read(&file) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            std::fs::create_dir_all(dir).with_context(|| dir.display().to_string())?;
            return output::write_file(&file, &serde_json::to_vec_pretty(recipe)?);
        }
        Err(error) => return Err(error).with_context(|| file.display().to_string()),
    };
    let before: Map<String, Value> =
        serde_json::from_slice(&before).with_context(|| file.display().to_string())?;
    for (what, here) in recipe {
        let there = before.get(what).unwrap_or(&Value::Null);
        if there != here {
            bail!(
                "{}: its data were made with {what} {there}, found {here}; expected the same, or another folder",
                dir.display()
            );
        }
    }
    Ok(())
}
