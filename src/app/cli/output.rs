//! Output of the commands: one JSON object, atomic files, one-line errors, PNG pictures.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use serde_json::Value;

use super::Common;
pub use calibration::machine::peak_rss_mb;
use formats::{atomic, png};
use scene::message;

/// Prints the report: as JSON if asked, else the given text; of that, names of a file may move no cursor and set no title.
pub fn report(common: &Common, json: &Value, text: impl FnOnce() -> String) {
    match common.json {
        true => say(&escaped(&json.to_string())),
        false => say(&message::of_lines(&text())),
    }
}

/// JSON in which characters that are hidden are escaped; strings alone hold such.
fn escaped(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match message::is_hidden(c) && c != '\n' {
            // (all of them have one unit of UTF-16)
            true => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            false => out.push(c),
        }
    }
    out
}

/// An error with its causes on one line, see [`scene::message::of_error`].
pub fn one_line(error: &anyhow::Error) -> String {
    scene::message::of_error(error.as_ref())
}

/// Writes a file that the user named, see [`atomic::write`]: an interrupted command leaves the old file whole.
pub fn write_file(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    atomic::write(path, bytes).with_context(|| format!("write {}", path.display()))
}

/// Writes an RGBA8 picture as PNG.
pub fn write_png(path: &Path, width: usize, height: usize, rgba: &[u8]) -> anyhow::Result<()> {
    let bytes = png::rgba(width, height, rgba, &png::Notes::default())
        .with_context(|| format!("encode {}", path.display()))?;
    write_file(path, &bytes)
}

/// Writes a line on stdout, or on stderr where a file went to stdout. If the reader has closed it (`| head`), the error
/// is dropped.
fn say(line: &str) {
    let _ = match atomic::stdout_holds_a_file() {
        true => writeln!(std::io::stderr(), "{line}"),
        false => writeln!(std::io::stdout(), "{line}"),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_speak_to_the_terminal() {
        let name = "a\u{1b}[2J\u{9b}31m\u{202e}b\n\u{7f}c";
        let text = escaped(&serde_json::json!({ "name": name }).to_string());
        assert!(!text.contains(message::is_hidden), "{text}");
        let back: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(back["name"], name);
    }
}
