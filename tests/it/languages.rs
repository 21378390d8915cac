//! Each language has every text of the interface, and none that the interface does not have.

use std::collections::BTreeSet;

use language::{Language, places};

use super::house::{read, root, rust};

/// The English texts that the program looks up: literals in `t("…")` and `tf!("…")`, and texts that travel as data until they
/// are drawn, in `assets/languages/texts.json`.
fn looked_up() -> BTreeSet<String> {
    let mut out = BTreeSet::new();
    for folder in ["src/app", "src/editor"] {
        for path in rust(folder) {
            let text = read(&path);
            let program = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
            for start in ["t(", "tf!("] {
                for (at, _) in program.match_indices(start) {
                    let before = program[..at].chars().next_back().unwrap_or(' ');
                    if before.is_alphanumeric() || before == '_' {
                        continue;
                    }
                    let rest = program[at + start.len()..].trim_start();
                    out.extend(literal(rest));
                }
            }
        }
    }
    out
}

/// The string literal that a text begins with.
fn literal(text: &str) -> Option<String> {
    let mut chars = text.strip_prefix('"')?.chars();
    let mut out = String::new();
    loop {
        match chars.next()? {
            '"' => return Some(out),
            '\\' => match chars.next()? {
                'n' => out.push('\n'),
                // (a line that goes on)
                '\n' => chars = chars.as_str().trim_start().chars(),
                other => out.push(other),
            },
            c => out.push(c),
        }
    }
}

/// Texts that travel as data, by hand: titles of actions, of tools, of panes and the like.
fn as_data() -> BTreeSet<String> {
    let text = read(&root().join("assets/languages/texts.json"));
    serde_json::from_str(&text).expect("a list of texts")
}

fn languages() -> Vec<Language> {
    ["de", "ja", "zh"]
        .map(|code| {
            let text = read(&root().join(format!("assets/languages/{code}.json")));
            Language::read(code, &text).expect("sound")
        })
        .into()
}

#[test]
fn every_language_has_every_text() {
    let mut wanted = looked_up();
    assert!(wanted.len() > 700, "only {} texts were found", wanted.len());
    wanted.extend(as_data());
    for language in languages() {
        let has: BTreeSet<String> = language.texts().map(|(english, _)| english.to_owned()).collect();
        let missing: Vec<_> = wanted.difference(&has).collect();
        let spare: Vec<_> = has.difference(&wanted).collect();
        assert!(missing.is_empty(), "{} lacks {missing:#?}", language.code);
        assert!(
            spare.is_empty(),
            "{} has what nobody looks up: {spare:#?}",
            language.code
        );
    }
}

/// A data text that no source has any more would be translated for nothing. Names of cameras and layers are in the sources with
/// other letters and with a line for a blank, numbered ones without their number.
#[test]
fn texts_that_travel_as_data_are_in_the_sources() {
    let mut sources = String::new();
    for folder in [
        "src/app",
        "src/editor",
        "src/scene",
        "src/gen",
        "src/viewport",
        "src/formats",
    ] {
        for path in rust(folder) {
            // (a literal that goes on in the next line)
            let text = read(&path);
            let mut parts = text.split("\\\n");
            sources.extend(parts.next());
            sources.extend(parts.map(str::trim_start));
        }
    }
    let plain = |text: &str| text.to_lowercase().replace('_', " ");
    let escaped = |text: &str| {
        text.replace('\\', "\\\\")
            .replace('"', "\\\"")
            .replace('\n', "\\n")
    };
    let sources = plain(&sources);
    let is_there = |text: &str| {
        let text = plain(&escaped(text));
        let unnumbered = text.trim_end_matches(|c: char| c.is_ascii_digit());
        sources.contains(&text) || unnumbered.ends_with(' ') && sources.contains(unnumbered)
    };
    let gone: Vec<_> = as_data().into_iter().filter(|text| !is_there(text)).collect();
    assert!(gone.is_empty(), "{gone:#?}");
}

#[test]
fn keys_and_values_stay_in_translations() {
    for language in languages() {
        for (english, own) in language.texts() {
            assert_eq!(places(english), places(own), "{}: {english:?}", language.code);
            for chord in ["Ctrl+", "Shift+", "Alt+"] {
                let count = |text: &str| text.matches(chord).count();
                assert_eq!(
                    count(english),
                    count(own),
                    "{}: {english:?} is {own:?}",
                    language.code
                );
            }
        }
    }
}
