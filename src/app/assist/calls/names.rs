//! Arguments that are one of several names: their schemas list the names, and other values are refused.

use anyhow::bail;
use schemars::{Schema, SchemaGenerator, json_schema};

use scene::message::quoted;
use trade::Presets;
use world::template::TEMPLATES;

/// Errors in one line if a value is none of the names.
pub fn check(key: &str, value: &str, names: &[&str]) -> anyhow::Result<()> {
    if !names.contains(&value) {
        let shown = quoted(value, 60);
        bail!("{key} is {shown:?}, expected one of {}", names.join(", "));
    }
    Ok(())
}

fn one_of(names: &[&str]) -> Schema {
    json_schema!({ "type": "string", "enum": names })
}

/// Kinds of street.
pub fn template(_: &mut SchemaGenerator) -> Schema {
    one_of(&TEMPLATES)
}

/// Presets of the quality slider.
pub fn presets() -> Vec<String> {
    Presets::bundled().all.into_iter().map(|p| p.name).collect()
}

/// Schema of [`presets`]; `null` is allowed too.
pub fn preset(_: &mut SchemaGenerator) -> Schema {
    let names: Vec<Option<String>> = presets().into_iter().map(Some).chain([None]).collect();
    json_schema!({ "type": ["string", "null"], "enum": names })
}

/// Formats that are written. They are examples in the schema: it stays the same where the table grows.
pub fn format(_: &mut SchemaGenerator) -> Schema {
    let ids: Vec<&str> = formats::export::all().iter().map(|f| f.id).collect();
    json_schema!({ "type": "string", "examples": ids })
}

/// Schema of the list of things to render.
pub fn what(_: &mut SchemaGenerator) -> Schema {
    let kinds = crate::render::kinds();
    json_schema!({ "type": "array", "minItems": 1, "items": { "type": "string", "enum": kinds } })
}

/// Names of the sources that classes and depths are rendered from.
pub fn sources() -> Vec<&'static str> {
    use sensors::cameras::{self, SourceId, ViewId};
    let ids = cameras::sources_of(ViewId::SEMANTIC).into_iter().map(|s| s.id());
    ids.map(SourceId::name).collect()
}

/// Schema of [`sources`].
pub fn source(_: &mut SchemaGenerator) -> Schema {
    one_of(&sources())
}

/// Width and height in pixels.
pub fn size(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array",
        "minItems": 2,
        "maxItems": 2,
        "items": { "type": "integer", "minimum": 1, "maximum": LARGEST_SIDE },
    })
}

/// Longest side of a picture, pixels.
const LARGEST_SIDE: u32 = 8192;

/// Errors in one line for a picture without pixels, or with too long a side.
pub fn check_size(size: [u32; 2]) -> anyhow::Result<()> {
    if !size.iter().all(|side| (1..=LARGEST_SIDE).contains(side)) {
        bail!("size is {size:?}, expected two numbers of 1 to {LARGEST_SIDE} pixels");
    }
    Ok(())
}
