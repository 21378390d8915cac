//! Messages for people: one line of bounded length, whatever the text from a file, a driver or a parser.

use std::error::Error;
use std::fmt::Display;

/// Characters of the longest message.
pub const LONGEST: usize = 300;

/// True for a character that is invisible and changes the text around it: control characters, line separators, and
/// characters that turn the direction of text. Terminals and names get none of them.
pub fn is_hidden(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

/// A text of several lines for a terminal: hidden characters become blanks, except the ends of its lines.
pub fn of_lines(text: &str) -> String {
    text.replace(|c| c != '\n' && is_hidden(c), " ")
}

/// A message as one line of at most [`LONGEST`] characters. Lines are joined by `; `, control characters become spaces.
pub fn one_line(message: &(impl Display + ?Sized)) -> String {
    shortened(&joined(&message.to_string()), LONGEST)
}

/// An error with its causes as one line of at most [`LONGEST`] characters. A cause that its parent has quoted already is
/// left out, and so is a parent with which its cause begins.
pub fn of_error(error: &(dyn Error + 'static)) -> String {
    let mut text = String::new();
    let mut next = Some(error);
    while let Some(cause) = next {
        let line = joined(&cause.to_string());
        if line.starts_with(&text) {
            text = line;
        } else if !text.contains(&line) {
            text = format!("{text}: {line}");
        }
        next = cause.source();
    }
    shortened(&text, LONGEST)
}

/// A piece of a file, made safe to quote: control characters become spaces, and a text of more than `most` characters
/// is cut and ends in `…`.
pub fn quoted(text: &str, most: usize) -> String {
    let plain = |c: char| if is_hidden(c) { ' ' } else { c };
    let mut out: String = text.chars().take(most).map(plain).collect();
    if text.chars().nth(most).is_some() {
        out.push('…');
    }
    out
}

/// A line of at most `most` characters. A longer line loses its middle, because a message begins with the file and ends
/// with the place in it.
pub fn shortened(line: &str, most: usize) -> String {
    let length = line.chars().count();
    if length <= most {
        return line.to_owned();
    }
    let kept = most.saturating_sub(3); // " … " stands for the rest
    let tail = kept / 3;
    let head: String = line.chars().take(kept - tail).collect();
    let end: String = line.chars().skip(length - tail).collect();
    format!("{head} … {end}")
}

/// Lines without their margins, joined.
fn joined(text: &str) -> String {
    let lines = text.lines().map(str::trim).filter(|l| !l.is_empty());
    let line = lines.collect::<Vec<_>>().join("; ");
    match line.contains(is_hidden) {
        true => line.replace(is_hidden, " "),
        false => line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug)]
    struct Said(&'static str, Option<Box<Said>>);

    impl Display for Said {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(self.0)
        }
    }

    impl Error for Said {
        fn source(&self) -> Option<&(dyn Error + 'static)> {
            self.1.as_deref().map(|s| s as _)
        }
    }

    #[test]
    fn a_message_is_one_line_of_bounded_length() {
        assert_eq!(one_line("a\r\n\n  b\tc\n"), "a; b c");
        assert_eq!(one_line(&7), "7");
        let long = format!("begin {} end", "é".repeat(1 << 20));
        let line = one_line(&long);
        assert_eq!(line.chars().count(), LONGEST);
        assert!(line.starts_with("begin é") && line.contains(" … ") && line.ends_with("é end"));
        let fits = "x".repeat(LONGEST);
        assert_eq!(one_line(&fits), fits);
        assert_eq!(shortened("abc", 2), " … ");
        assert_eq!(quoted("ab\ncd", 4), "ab c…");
        assert_eq!(one_line("a\u{1b}[2J\u{9b}b\u{202e}c"), "a [2J b c");
        assert_eq!(of_lines("a\u{1b}b\r\nc\td\u{2066}"), "a b \nc d ");
    }

    #[test]
    fn causes_are_told_once() {
        let chain = |lines: &[&'static str]| {
            let mut error = None;
            for line in lines.iter().rev() {
                error = Some(Box::new(Said(line, error)));
            }
            of_error(&*error.expect("a line"))
        };
        assert_eq!(
            chain(&["read a.json", "no such\nfile"]),
            "read a.json: no such; file"
        );
        assert_eq!(
            chain(&["a.json: cut short (3)", "cut short"]),
            "a.json: cut short (3)"
        );
        assert_eq!(chain(&["a.json", "a.json: cut short"]), "a.json: cut short");
        assert_eq!(chain(&[""]), "");
    }
}
