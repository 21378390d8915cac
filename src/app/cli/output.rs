//! What commands print and write: one JSON object, atomic files, one-line errors, PNG pictures.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use serde_json::Value;

use super::Common;
use formats::png;
pub use judge::machine::peak_rss_mb;

/// Prints the report: as JSON if asked, else the given text.
pub fn report(common: &Common, json: &Value, text: impl FnOnce() -> String) {
    if common.json {
        say(&json.to_string());
    } else {
        say(&text());
    }
}

/// An error with its causes on one line, see [`scene::message::of_error`].
pub fn one_line(error: &anyhow::Error) -> String {
    scene::message::of_error(error.as_ref())
}

/// Writes a file beside its final name and renames it: an interrupted command leaves the old file whole.
pub fn write_file(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let dir = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let write = || -> std::io::Result<()> {
        let mut file = tempfile::NamedTempFile::new_in(dir)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("write {}", path.display()))
}

/// Writes an RGBA8 picture as PNG.
pub fn write_png(path: &Path, width: usize, height: usize, rgba: &[u8]) -> anyhow::Result<()> {
    let bytes = png::rgba(width, height, rgba, &png::Notes::default())
        .with_context(|| format!("encode {}", path.display()))?;
    write_file(path, &bytes)
}

/// A line on stdout. Nobody is left to be told if its reader has closed it (`| head`).
fn say(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}
