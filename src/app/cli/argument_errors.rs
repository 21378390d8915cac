//! Wrong arguments in one line: what was found, what was expected, and where it helps the likely meaning.

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Longest line, characters: a typed argument may be long.
const LONGEST: usize = 400;
/// Longest hint within that line, characters.
const LONGEST_HINT: usize = 120;

/// The message about wrong arguments: one line that begins with `sceneloom: `. A hint in brackets at its end tells the
/// likely meaning, or where to look. Help and version are given as they are.
pub(super) fn message(error: &clap::Error) -> String {
    if !error.use_stderr() {
        return error.to_string();
    }
    let hint = hint(error).map_or(String::new(), |hint| format!(" ({})", short(&hint, LONGEST_HINT)));
    let line = short(&format!("sceneloom: {}", what(error)), LONGEST - LONGEST_HINT);
    format!("{line}{hint}\n")
}

/// The error in words: what was found, and what was expected.
fn what(error: &clap::Error) -> String {
    let one = |kind| context(error, kind).map(|all| all.join(", "));
    let arg = one(ContextKind::InvalidArg).unwrap_or_else(|| "an argument".into());
    let value = one(ContextKind::InvalidValue).unwrap_or_default();
    let found = |n: &str| format!("{arg}: found {n} values, expected ");
    let number = |kind| one(kind).unwrap_or_else(|| "other".into());
    match error.kind() {
        ErrorKind::InvalidValue => {
            let valid = one(ContextKind::ValidValue).filter(|v| !v.is_empty());
            match (value.is_empty(), valid) {
                (false, Some(valid)) => format!("{arg}: found {value:?}, expected one of {valid}"),
                (false, None) => format!("{arg}: found {value:?}, expected another value"),
                (true, Some(valid)) => format!("{arg}: found no value, expected one of {valid}"),
                (true, None) => format!("{arg}: found no value, expected one"),
            }
        }
        ErrorKind::ValueValidation => {
            let why = std::error::Error::source(error).map(|e| e.to_string());
            let why = why.unwrap_or_else(|| "expected another value".into());
            format!("{arg}: found {value:?}: {why}")
        }
        ErrorKind::UnknownArgument => format!("found {arg}, expected an option or argument that is known"),
        ErrorKind::InvalidSubcommand => {
            let name = one(ContextKind::InvalidSubcommand).unwrap_or_default();
            match one(ContextKind::ValidSubcommand) {
                Some(valid) => format!("found the command {name:?}, expected one of {valid}"),
                None => format!("found the command {name:?}, expected a known one"),
            }
        }
        ErrorKind::MissingSubcommand | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            match one(ContextKind::ValidSubcommand) {
                Some(valid) => format!("found no command, expected one of {valid}"),
                None => "found too few arguments, expected a command or what it needs".into(),
            }
        }
        ErrorKind::MissingRequiredArgument => format!("found too few arguments, expected {arg}"),
        ErrorKind::ArgumentConflict => match one(ContextKind::PriorArg) {
            Some(prior) if prior == arg => format!("{arg}: found more than once, expected once"),
            Some(prior) => format!("found {arg} beside {prior}, expected one of them"),
            None => format!("found {arg} beside others, expected one of them"),
        },
        ErrorKind::NoEquals => format!("{arg}: found no equals sign, expected {arg}=VALUE"),
        ErrorKind::TooManyValues => format!("{arg}: found one value too many, {value:?}, expected fewer"),
        ErrorKind::TooFewValues => format!(
            "{}{}",
            found(&number(ContextKind::ActualNumValues)),
            number(ContextKind::MinValues)
        ),
        ErrorKind::WrongNumberOfValues => format!(
            "{}{}",
            found(&number(ContextKind::ActualNumValues)),
            number(ContextKind::ExpectedNumValues)
        ),
        _ => {
            let text = error.to_string();
            let first = text.lines().next().unwrap_or("wrong arguments");
            first.trim_start_matches("error: ").to_owned()
        }
    }
}

/// The hint: the likely meaning, or where to look.
fn hint(error: &clap::Error) -> Option<String> {
    let meant = [
        ContextKind::SuggestedArg,
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedValue,
    ];
    if let Some(names) = meant.into_iter().find_map(|kind| context(error, kind)) {
        return Some(format!("did you mean {}?", names.join(" or ")));
    }
    let usage = context(error, ContextKind::Usage)?.join(" ");
    let command = usage.split_whitespace().skip_while(|w| *w != "sceneloom");
    let is_name = |w: &&str| w.chars().all(|c| c.is_ascii_lowercase() || c == '-') && !w.starts_with('-');
    let names: Vec<&str> = command.take_while(is_name).collect();
    (!names.is_empty()).then(|| format!("see {} --help", names.join(" ")))
}

/// A piece of context that clap keeps with an error, as texts; `None` if there is none of that kind.
fn context(error: &clap::Error, kind: ContextKind) -> Option<Vec<String>> {
    match error.get(kind)? {
        ContextValue::String(text) => Some(vec![text.clone()]),
        ContextValue::Strings(all) if !all.is_empty() => Some(all.clone()),
        ContextValue::StyledStr(text) => Some(vec![text.to_string()]),
        ContextValue::StyledStrs(all) if !all.is_empty() => {
            Some(all.iter().map(ToString::to_string).collect())
        }
        ContextValue::Number(n) => Some(vec![n.to_string()]),
        _ => None,
    }
}

/// The text on one line of so many characters at most.
fn short(text: &str, longest: usize) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let clean = |c: char| if c.is_control() { '?' } else { c };
    let mut cut: String = line.chars().map(clean).take(longest).collect();
    if line.chars().count() > longest {
        cut.push('…');
    }
    cut
}

#[cfg(test)]
mod tests {
    use clap::{Command, CommandFactory, Parser};

    use super::*;
    use crate::Cli;

    /// The message for a command line that must be refused.
    fn refused(words: &[String]) -> String {
        let Err(error) = Cli::try_parse_from(words) else {
            panic!("accepted: {words:?}");
        };
        assert_eq!(error.exit_code(), 2, "{words:?}");
        let text = message(&error);
        let lines: Vec<&str> = text.lines().collect();
        assert!(text.ends_with('\n') && lines.len() == 1, "{words:?}: {text}");
        assert!(lines[0].starts_with("sceneloom: "), "{words:?}: {text}");
        assert!(
            lines[0].contains("expected") || lines[0].contains("found"),
            "{words:?}: {text}"
        );
        // With the brackets and two signs of what was cut.
        assert!(text.trim_end().chars().count() <= LONGEST + 5, "{text}");
        text
    }

    /// Every command with the words that lead to it.
    fn all(command: &Command, path: &[String], out: &mut Vec<(Vec<String>, Command)>) {
        out.push((path.to_vec(), command.clone()));
        for sub in command.get_subcommands().filter(|c| c.get_name() != "help") {
            let path = [path, &[sub.get_name().to_owned()]].concat();
            all(sub, &path, out);
        }
    }

    #[test]
    fn wrong_arguments_of_every_command_are_one_line() {
        let mut root = Cli::command();
        root.build();
        let mut commands = Vec::new();
        all(&root, &["sceneloom".to_owned()], &mut commands);
        assert!(commands.len() > 16, "{} commands", commands.len());
        let mut tried = 0;
        for (path, command) in &commands {
            let with = |more: &[&str]| -> Vec<String> {
                let more = more.iter().map(|w| (*w).to_owned());
                path.iter().cloned().chain(more).collect()
            };
            let long = "x".repeat(1 << 13);
            let mut lines = vec![
                with(&["--no-such-option"]),
                with(&["--no-such-option=a\nb\nc"]),
                with(&[&format!("--{long}")]),
                with(&["-Q"]),
            ];
            if command.get_arguments().any(|a| a.is_required_set()) {
                lines.push(with(&[]));
            }
            for arg in command.get_arguments().filter(|a| a.get_action().takes_values()) {
                let Some(name) = arg.get_long() else { continue };
                // An option without its value.
                lines.push(with(&[&format!("--{name}")]));
                if !arg.get_possible_values().is_empty() {
                    lines.push(with(&[&format!("--{name}=no such value\nat all")]));
                }
            }
            for line in &lines {
                refused(line);
            }
            tried += lines.len();
        }
        assert!(tried > 100, "{tried} command lines");
    }

    #[test]
    fn the_line_says_what_was_found_and_expected() {
        let text = |line: &str| {
            let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
            refused(&words)
        };
        let size = text("sceneloom render a.loom -o b --size 3by4");
        assert!(
            size.contains("--size <WxH>: found \"3by4\"") && size.contains("expected WxH"),
            "{size}"
        );
        let lidar = text("sceneloom render a.loom -o b --lidar exakt");
        assert!(
            lidar.contains("found \"exakt\", expected one of recorded, exact, learned"),
            "{lidar}"
        );
        assert!(lidar.contains("(did you mean exact?)"), "{lidar}");
        let unknown = text("sceneloom check a.loom --fixx");
        assert!(
            unknown.contains("found --fixx") && unknown.contains("(did you mean --fix"),
            "{unknown}"
        );
        let missing = text("sceneloom check a.loom --fix");
        assert!(missing.contains("expected --output <S.loom>"), "{missing}");
        assert!(missing.contains("(see sceneloom check --help)"), "{missing}");
        let twice = text("sceneloom check a.loom --json --json");
        assert!(twice.contains("more than once"), "{twice}");
        // Help is no error.
        let help = Cli::try_parse_from(["sceneloom", "check", "--help"])
            .err()
            .expect("help");
        assert_eq!(help.exit_code(), 0);
        assert!(message(&help).lines().count() > 5);
    }
}
