//! What `render` can be asked for: views of the table of camera sources, and what is no camera's.

use anyhow::bail;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use sensors::cameras::{self, SourceId, ViewId};

/// What can be rendered besides the views of cameras.
const OTHERS: [&str; 4] = ["truth", "lidar", "bev", "view"];

/// Names of everything that can be rendered.
fn kinds() -> String {
    let views = cameras::views().into_iter().map(|v| v.id.name());
    views.chain(OTHERS).collect::<Vec<_>>().join(", ")
}

/// Help of `--what`.
pub fn what_help() -> String {
    format!("Comma-separated: {}", kinds())
}

/// Errors if nothing is asked for, or something unknown.
pub fn check_what(what: &[String]) -> anyhow::Result<()> {
    if what.is_empty() {
        bail!("--what is empty, expected some of {}", kinds());
    }
    let views = cameras::views();
    let known = |name: &str| views.iter().any(|v| v.id.name() == name) || OTHERS.contains(&name);
    if let Some(unknown) = what.iter().find(|w| !known(w)) {
        bail!("--what holds {unknown:?}, expected {}", kinds());
    }
    Ok(())
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
