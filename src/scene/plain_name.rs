//! Names that become part of a path: the rules that make them safe on every system, whoever wrote the scene they come
//! from.

use crate::message::{is_hidden, quoted};

/// Longest name of a sensor, bytes of UTF-8: it leaves room for endings in the names of its files.
pub const LONGEST: usize = 128;
/// Longest name of a file that systems take, bytes of UTF-8.
pub const LONGEST_OF_FILE: usize = 255;

/// Characters that separate parts of a path, or that names may not have, on some system.
const SEPARATORS: [char; 9] = ['/', '\\', ':', '*', '?', '"', '<', '>', '|'];
/// Names of devices on Windows, with any ending; `COM` and `LPT` have a digit after them.
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "conin$", "conout$"];

/// Reason why a name is not plain. Each is one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotPlain {
    /// No character at all.
    #[error("the name is empty, expected one")]
    Empty,
    /// More bytes than a name may have.
    #[error("the name {name:?} has {found} bytes, expected at most {most}")]
    TooLong {
        /// Its beginning.
        name: String,
        /// Its length, bytes of UTF-8.
        found: usize,
        /// Most bytes that are accepted.
        most: usize,
    },
    /// A character that names may not have.
    #[error(
        "the name {name:?} holds {found:?}, expected a name without / \\ : * ? \" < > | and control characters"
    )]
    Character {
        /// Its beginning.
        name: String,
        /// The first character that is refused.
        found: char,
    },
    /// A dot or a blank at an end of the name: systems drop it, or it hides the file or leads to the folder above.
    #[error("the name {0:?} begins with a dot or blank or ends in one, expected a name without")]
    Edge(String),
    /// Name of a device on Windows.
    #[error("the name {0:?} is that of a device on Windows, expected another")]
    Device(String),
}

/// Errors unless the name of a sensor is plain: one part of a path on every system, with room for an ending.
pub fn check(name: &str) -> Result<(), NotPlain> {
    check_within(name, LONGEST)
}

/// Errors unless a name is one part of a path on every system: not empty, at most [`LONGEST_OF_FILE`] bytes, no separators, no
/// control characters, no dot or blank at its ends (so neither `.` nor `..`), no device of Windows.
pub fn check_file(name: &str) -> Result<(), NotPlain> {
    check_within(name, LONGEST_OF_FILE)
}

fn check_within(name: &str, most: usize) -> Result<(), NotPlain> {
    let shown = || quoted(name, 60);
    if name.is_empty() {
        return Err(NotPlain::Empty);
    }
    if name.len() > most {
        return Err(NotPlain::TooLong {
            name: shown(),
            found: name.len(),
            most,
        });
    }
    if let Some(found) = name.chars().find(|c| is_hidden(*c) || SEPARATORS.contains(c)) {
        return Err(NotPlain::Character { name: shown(), found });
    }
    let is_lost = |c: char| c == '.' || c.is_whitespace();
    if name.starts_with(is_lost) || name.ends_with(is_lost) {
        return Err(NotPlain::Edge(shown()));
    }
    match is_device(name) {
        true => Err(NotPlain::Device(shown())),
        false => Ok(()),
    }
}

/// True for `NUL`, `aux.png`, `COM1` and similar names.
fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or(name).trim_end().to_lowercase();
    let is_numbered = |kind: &str| {
        let number = stem.strip_prefix(kind).unwrap_or_default();
        number.chars().count() == 1 && number.contains(|c: char| c.is_ascii_digit() || "¹²³".contains(c))
    };
    DEVICES.contains(&&*stem) || is_numbered("com") || is_numbered("lpt")
}

/// A name in the form by which files are told apart on systems that ignore the case of letters.
pub fn folded(name: &str) -> String {
    name.to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_one_part_of_a_path_everywhere_is_plain() {
        let long = "x".repeat(LONGEST);
        let fine = [
            "CAM_FRONT",
            "front left",
            "a.b",
            "-x",
            "vorne_größer",
            "前",
            "COM",
            "com10",
            "console",
            "x..y",
            &long,
        ];
        for name in fine {
            assert_eq!(check(name), Ok(()), "{name}");
        }
        assert!(check(&"x".repeat(LONGEST + 1)).is_err());
        assert_eq!(check_file(&"x".repeat(LONGEST_OF_FILE)), Ok(()));
        assert!(check_file(&"x".repeat(LONGEST_OF_FILE + 1)).is_err());
    }

    #[test]
    fn what_leads_elsewhere_or_hides_is_refused_in_one_line() {
        let bad = [
            "",
            ".",
            "..",
            "../x",
            "/x",
            "a/b",
            "a\\b",
            "\\\\server\\x",
            "C:x",
            "C:",
            "x:stream",
            ".x",
            "x.",
            "x ",
            " x",
            "a\nb",
            "a\0b",
            "a\u{1b}[2Jb",
            "a\u{9b}b",
            "a\u{202e}b",
            "a\u{2028}b",
            "a*",
            "a?",
            "a\"b",
            "<b>",
            "a|b",
            "NUL",
            "nul.png",
            "Aux",
            "COM1",
            "lpt9.txt",
            "com¹",
            "CON .x",
            "\u{a0}x",
            "\t",
        ];
        for name in bad {
            let line = check(name).expect_err(name).to_string();
            assert!(
                line.lines().count() == 1 && !line.contains(char::is_control),
                "{line:?}"
            );
            assert!(line.contains("expected") && line.len() < 300, "{line}");
        }
        let line = check(&"é".repeat(1 << 20)).expect_err("long").to_string();
        assert!(
            line.len() < 300 && line.contains("2097152 bytes, expected at most 128"),
            "{line}"
        );
    }
}
