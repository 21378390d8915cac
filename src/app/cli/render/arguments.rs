//! Values of the arguments of `render`: views of the table of camera sources, and the other kinds of output.

use clap::builder::{PossibleValuesParser, TypedValueParser};

use assist::render::kinds;
use sensors::cameras::{self, SourceId, ViewId};

/// Help of `--what`.
pub fn what_help() -> String {
    format!("Comma-separated: {}", kinds().join(", "))
}

/// Reads `--source`: the sources that give classes and depths, by name.
pub fn source() -> impl TypedValueParser<Value = SourceId> {
    let ids = || cameras::sources_of(ViewId::SEMANTIC).into_iter().map(|s| s.id());
    PossibleValuesParser::new(ids().map(SourceId::name))
        .map(move |name| ids().find(|id| id.name() == name).unwrap_or_default())
}

/// `WxH`, each 1 to 8192; see [`cameras::bounds`] for how many pixels in all.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides: Option<Vec<u32>> = text.split('x').map(|v| v.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[w, h]) if (1..=8192).contains(&w) && (1..=8192).contains(&h) => Ok([w, h]),
        _ => Err("expected WxH, each 1 to 8192 pixels".into()),
    }
}
