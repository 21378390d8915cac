//! Names and comments of the program: a type's name says what it is without its module, a comment opens with a noun or a
//! verb. Prints the figures; fails above the bars.

use std::collections::BTreeMap;

use crate::house::{read, root, rust};

/// Share of types whose name stands three times or more.
const SHARED_NAMES: f64 = 0.05;
/// Share of comments that open with neither a noun nor a verb.
const NOUNLESS_COMMENTS: f64 = 0.015;
/// Lines with a bare 2.5 or 0.4 outside the grid; the aim is none but colours and weights.
const BARE_LITERALS: usize = 227;
/// Files with an `impl SceneloomApp`; the aim is 6.
const APP_FILES: usize = 28;

/// Words that open a comment without saying what the item is.
const OPENINGS: [&str; 24] = [
    "What",
    "That",
    "Those",
    "This",
    "Who",
    "Whom",
    "Whose",
    "Of",
    "As",
    "Something",
    "Nothing",
    "Nobody",
    "Somebody",
    "Anything",
    "Everything",
    "Both",
    "Or",
    "And",
    "Else",
    "Where",
    "When",
    "All that",
    "The same",
    "It",
];

/// A file's lines up to its tests.
fn program(text: &str) -> Vec<&str> {
    text.split("#[cfg(test)]\nmod tests")
        .next()
        .unwrap_or("")
        .lines()
        .collect()
}

fn is_test(name: &str) -> bool {
    name.split('/').any(|part| {
        let part = part.trim_end_matches(".rs");
        part.starts_with("test")
            || part.ends_with("_test")
            || part.ends_with("_tests")
            || part.contains("tests_")
    })
}

/// Files of the program with their names from the root.
fn sources() -> Vec<(String, String)> {
    let name = |path: &std::path::PathBuf| {
        path.strip_prefix(root())
            .expect("below the root")
            .display()
            .to_string()
    };
    let files = rust("src").into_iter().chain(rust("assets"));
    files
        .filter(|p| !is_test(&name(p)))
        .map(|p| (name(&p), read(&p)))
        .collect()
}

/// The name of a type that a line declares, at any depth; an associated type of a trait is none.
fn declared(line: &str) -> Option<&str> {
    let mut words = line.split_whitespace().peekable();
    if words.peek().is_some_and(|w| w.starts_with("pub")) {
        words.next();
    }
    if words.peek() == Some(&"unsafe") {
        words.next();
    }
    let kind = words.next()?;
    let is_nested_alias = kind == "type" && line.starts_with([' ', '\t']);
    let declares = matches!(kind, "struct" | "enum" | "trait" | "type" | "union") && !is_nested_alias;
    let name = words.next().filter(|_| declares)?;
    let end = name
        .find(|c: char| !c.is_alphanumeric() && c != '_')
        .unwrap_or(name.len());
    Some(&name[..end]).filter(|n| n.starts_with(char::is_uppercase))
}

/// The text of a line that begins a comment of an item or module.
fn opened<'a>(line: &'a str, before: &str) -> Option<&'a str> {
    let is_comment = |l: &str| l.starts_with("///") || l.starts_with("//!");
    let text = line.strip_prefix("/// ").or_else(|| line.strip_prefix("//! "))?;
    (!is_comment(before)).then_some(text)
}

fn opens_without_noun(text: &str) -> bool {
    OPENINGS.iter().any(|opening| {
        text.strip_prefix(opening)
            .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || "-'".contains(c)))
    })
}

fn has_bare_literal(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or("");
    let outside_of_strings: String = code.split('"').step_by(2).collect();
    ["2.5", "0.4"].iter().any(|literal| {
        outside_of_strings.match_indices(literal).any(|(at, _)| {
            let before = outside_of_strings[..at].chars().next_back();
            let after = outside_of_strings[at + 3..].chars().next();
            !before.is_some_and(|c| c.is_alphanumeric() || "._".contains(c))
                && !after.is_some_and(|c| c.is_alphanumeric() || c == '_')
        })
    })
}

#[test]
fn names_say_what_things_are() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, text) in sources() {
        for (number, line) in program(&text).iter().enumerate() {
            if let Some(name) = declared(line) {
                places
                    .entry(name.to_owned())
                    .or_default()
                    .push(format!("{file}:{}", number + 1));
            }
        }
    }
    let all: usize = places.values().map(Vec::len).sum();
    let mut shared: Vec<_> = places.iter().filter(|(_, at)| at.len() >= 3).collect();
    shared.sort_by_key(|(_, at)| std::cmp::Reverse(at.len()));
    let inside: usize = shared.iter().map(|(_, at)| at.len()).sum();
    println!("{inside} of {all} types share their name with two others or more");
    assert!(all > 1500, "{all} types were found");
    let share = inside as f64 / all as f64;
    assert!(share <= SHARED_NAMES, "{:.1} %: {shared:#?}", 100.0 * share);
}

#[test]
fn comments_open_with_what_the_item_is() {
    let (mut all, mut nounless) = (0, Vec::new());
    for (file, text) in sources() {
        let mut before = "";
        for line in program(&text).iter().map(|l| l.trim()) {
            if let Some(comment) = opened(line, before) {
                all += 1;
                if opens_without_noun(comment) {
                    nounless.push(format!("{file}: {comment}"));
                }
            }
            before = line;
        }
    }
    println!(
        "{} of {all} comments open without a noun or a verb",
        nounless.len()
    );
    assert!(all > 10_000, "{all} comments were found");
    let share = nounless.len() as f64 / all as f64;
    assert!(
        share <= NOUNLESS_COMMENTS,
        "{:.1} %: {nounless:#?}",
        100.0 * share
    );
}

#[test]
fn facts_of_the_grid_and_the_app_do_not_spread() {
    let (mut literals, mut apps) = (Vec::new(), Vec::new());
    for (file, text) in sources() {
        let lines = program(&text);
        let of_grid = file.contains("src/scene/grid") || file.contains("lattice");
        if !of_grid {
            literals.extend(
                lines
                    .iter()
                    .filter(|l| has_bare_literal(l))
                    .map(|l| format!("{file}: {}", l.trim())),
            );
        }
        if lines
            .iter()
            .any(|l| l.starts_with("impl") && l.contains(" SceneloomApp "))
        {
            apps.push(file);
        }
    }
    println!(
        "{} lines with a bare 2.5 or 0.4, {} files with impl SceneloomApp",
        literals.len(),
        apps.len()
    );
    assert!(
        literals.len() <= BARE_LITERALS,
        "{}: {literals:#?}",
        literals.len()
    );
    assert!(apps.len() <= APP_FILES, "{}: {apps:#?}", apps.len());
}

#[test]
fn the_measure_sees_what_it_measures() {
    assert_eq!(declared("pub(crate) struct Row<'a> {"), Some("Row"));
    assert_eq!(declared("    enum Inner {"), Some("Inner"));
    assert_eq!(declared("    type Item = u8;"), None);
    assert_eq!(declared("let structure = 3;"), None);
    assert!(opens_without_noun("What is so.") && opens_without_noun("Of a row."));
    assert!(!opens_without_noun("Whatever row.") && !opens_without_noun("Offers a row."));
    assert!(has_bare_literal("let a = x * 0.4;") && !has_bare_literal("let a = 10.4 + 0.45; // 0.4"));
    assert!(!has_bare_literal("say(\"0.4 m\")"));
    assert_eq!(opened("/// A row.", "///"), None);
}

#[test]
fn the_glossary_is_short_and_names_each_term_once() {
    let text = read(&root().join("docs/glossary.md"));
    let row = |l: &str| {
        l.strip_prefix("| ")
            .and_then(|l| l.split_once(" | "))
            .map(|(term, _)| term.to_owned())
    };
    let terms: Vec<String> = text.lines().filter_map(row).filter(|t| t != "term").collect();
    let mut once = terms.clone();
    once.sort();
    once.dedup();
    assert!((100..=150).contains(&terms.len()), "{} terms", terms.len());
    assert_eq!(once.len(), terms.len(), "a term stands twice");
}
