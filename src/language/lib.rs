//! Texts of the interface in the user's language, looked up by their English.
//!
//! `assets/languages/NAME.json` holds them: `{"English": "translation"}`. What a language lacks is shown in English. Words that
//! are typed to change a scene, files, and everything that programs print stay English.

use std::collections::HashMap;
use std::fmt::Display;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The largest file of a language, bytes.
const LARGEST_FILE: u64 = 4 << 20;

/// A language of the interface.
#[derive(Debug)]
pub struct Language {
    /// Its short name (ISO 639-1), that of its file.
    pub code: String,
    /// Its name in the language itself.
    pub name: String,
    texts: HashMap<String, String>,
}

impl Language {
    /// Reads a language from JSON; the text under `""` is its name in the language itself.
    ///
    /// # Errors
    /// One line if it is no object of texts, or if a translation has other `{places}` than its English.
    pub fn read(code: &str, json: &str) -> Result<Self, String> {
        let mut texts: HashMap<String, String> =
            serde_json::from_str(json).map_err(|error| format!("language {code}: {error}"))?;
        let name = texts.remove("").unwrap_or_else(|| code.to_owned());
        for (english, own) in &texts {
            if places(english) != places(own) {
                return Err(format!(
                    "language {code}: {own:?} has other places in braces than {english:?}"
                ));
            }
        }
        Ok(Self {
            code: code.to_owned(),
            name,
            texts,
        })
    }

    /// Its texts by their English.
    pub fn texts(&self) -> impl Iterator<Item = (&str, &str)> {
        self.texts.iter().map(|(english, own)| (&**english, &**own))
    }

    /// A text in this language; English if it lacks it.
    fn text<'a>(&'a self, english: &'a str) -> &'a str {
        self.texts.get(english).map_or(english, |own| own)
    }
}

/// The languages that come with the program: their codes and files.
const BUILT_IN: [(&str, &str); 3] = [
    ("de", include_str!("../../assets/languages/de.json")),
    ("ja", include_str!("../../assets/languages/ja.json")),
    ("zh", include_str!("../../assets/languages/zh.json")),
];

static LANGUAGES: OnceLock<Vec<Language>> = OnceLock::new();

/// Which one is shown: 0 is English, others are one more than their place in the list. The window of a process has one
/// language, and every text asks for it.
static CHOSEN: AtomicUsize = AtomicUsize::new(0);

fn built_in() -> Vec<Language> {
    // A test reads each of them.
    let read = |(code, json): (&str, &str)| Language::read(code, json).ok();
    BUILT_IN.into_iter().filter_map(read).collect()
}

/// All but English, by code.
pub fn all() -> &'static [Language] {
    LANGUAGES.get_or_init(built_in)
}

/// Adds the user's own languages, `FOLDER/CODE.json`; one of a code that is known replaces it. Does nothing when texts were asked
/// for before: a process has one list.
///
/// # Errors
/// One line for each file that cannot be used. The others are taken.
pub fn add_from(folder: &Path) -> Vec<String> {
    if LANGUAGES.get().is_some() {
        return Vec::new();
    }
    let mut languages = built_in();
    let mut errors = Vec::new();
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<_> = files.map(|file| file.path()).collect();
    paths.sort();
    for path in paths {
        let (Some(code), Some("json")) = (
            path.file_stem().and_then(|s| s.to_str()),
            path.extension().and_then(|e| e.to_str()),
        ) else {
            continue;
        };
        let large = std::fs::metadata(&path).is_ok_and(|m| m.len() > LARGEST_FILE);
        let read = match large {
            true => Err(format!("{} is larger than 4 MB", path.display())),
            false => std::fs::read_to_string(&path)
                .map_err(|error| format!("{}: {error}", path.display()))
                .and_then(|json| Language::read(code, &json)),
        };
        match read {
            Ok(language) => {
                languages.retain(|l| l.code != language.code);
                languages.push(language);
            }
            Err(error) => errors.push(error),
        }
    }
    languages.sort_by(|a, b| a.code.cmp(&b.code));
    // (only another window of a test may set it in between)
    drop(LANGUAGES.set(languages));
    errors
}

/// Shows texts in a language from now on; English for a code that there is not.
pub fn choose(code: &str) {
    let at = all().iter().position(|l| l.code == code);
    CHOSEN.store(at.map_or(0, |at| at + 1), Ordering::Relaxed);
}

/// The language that is shown; `None` for English.
pub fn chosen() -> Option<&'static Language> {
    let at = CHOSEN.load(Ordering::Relaxed).checked_sub(1)?;
    all().get(at)
}

/// An English text of the interface in the language that is shown.
pub fn t(english: &str) -> &str {
    chosen().map_or(english, |language| language.text(english))
}

/// A text with `{name}` replaced by values.
pub fn filled(text: &str, values: &[(&str, &dyn Display)]) -> String {
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some((before, name, after)) = next_place(rest) {
        out.push_str(before);
        match values.iter().find(|(known, _)| *known == name) {
            Some((_, value)) => out.push_str(&value.to_string()),
            None => out.push_str(&rest[before.len()..rest.len() - after.len()]),
        }
        rest = after;
    }
    out.push_str(rest);
    out
}

/// The next `{name}`: the text before it, the name, and the text after it.
fn next_place(text: &str) -> Option<(&str, &str, &str)> {
    let mut from = 0;
    loop {
        let open = from + text[from..].find('{')?;
        let close = open + text[open..].find('}')?;
        let name = &text[open + 1..close];
        let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if is_name {
            return Some((&text[..open], name, &text[close + 1..]));
        }
        from = open + 1;
    }
}

/// The names in braces, sorted.
pub fn places(text: &str) -> Vec<&str> {
    let mut out = Vec::new();
    let mut rest = text;
    while let Some((_, name, after)) = next_place(rest) {
        out.push(name);
        rest = after;
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// A text with values in the language that is shown: `tf!("{n} boxes chosen", n = boxes.len())`.
#[macro_export]
macro_rules! tf {
    ($text:literal, $($name:ident = $value:expr),+ $(,)?) => {
        $crate::filled($crate::t($text), &[$((stringify!($name), &$value as &dyn std::fmt::Display)),+])
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_languages_that_come_along_are_sound() {
        for (code, json) in BUILT_IN {
            let language = Language::read(code, json).expect(code);
            assert_ne!(language.name, code, "it says what it calls itself");
            assert!(
                language
                    .texts()
                    .all(|(english, own)| !english.is_empty() && !own.trim().is_empty())
            );
        }
    }

    #[test]
    fn values_go_where_the_language_wants_them() {
        let json = r#"{"": "Test", "{n} of {all}": "von {all} sind es {n}", "Undo": "Rückgängig"}"#;
        let language = Language::read("xx", json).expect("sound");
        let text = language.text("{n} of {all}");
        assert_eq!(filled(text, &[("n", &2), ("all", &"zehn")]), "von zehn sind es 2");
        assert_eq!(language.text("Undo"), "Rückgängig");
        assert_eq!(language.text("Redo"), "Redo");
        assert_eq!(
            tf!("{n} of {all}, {{}} { } {other}", n = 1, all = "x"),
            "1 of x, {{}} { } {other}"
        );
        assert_eq!(filled("{n", &[("n", &1)]), "{n");
    }

    #[test]
    fn unsound_files_are_refused_in_one_line() {
        for (json, part) in [
            ("[1]", "language xx:"),
            (r#"{"a": 1}"#, "language xx:"),
            (r#"{"{n} boxes": "Kisten"}"#, "other places"),
            (r#"{"a": "b""#, "language xx:"),
        ] {
            let error = Language::read("xx", json).expect_err(json);
            assert!(error.contains(part) && !error.contains('\n'), "{error}");
        }
    }
}
