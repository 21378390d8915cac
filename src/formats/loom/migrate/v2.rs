//! From version 2 to 3.

use serde_json::Value;

use super::super::{ProjectError, SCENE};
use super::{Entries, Migration, MigrationChange, old_prompt};

/// Conditions are a field of the scene; before, the prompt held them in words.
pub(super) const TO_V3: Migration = Migration {
    from: 2,
    what: "time of day, weather, wet ground, visibility and sun as conditions of the scene",
    change: MigrationChange::Rewrites(read_prompt),
};

fn read_prompt(entries: &mut dyn Entries) -> Result<(), ProjectError> {
    let bad = |detail: &str| ProjectError::Json {
        entry: SCENE.into(),
        detail: detail.to_owned(),
    };
    let scene = entries.scene()?;
    let scene = scene.as_object_mut().ok_or_else(|| bad("expected an object"))?;
    let prompt = scene.get("prompt").and_then(Value::as_str);
    let prompt = prompt.ok_or_else(|| bad("missing field `prompt`"))?;
    let seed = scene.get("seed").and_then(Value::as_u64);
    let seed = seed.ok_or_else(|| bad("missing field `seed`"))?;
    let conditions = old_prompt::conditions(prompt, seed);
    let conditions = serde_json::to_value(conditions).map_err(|e| bad(&e.to_string()))?;
    scene.insert("conditions".to_owned(), conditions);
    Ok(())
}
