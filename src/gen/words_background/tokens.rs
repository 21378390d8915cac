//! A prompt to words, numbers and marks, each with the bytes it came from.

pub use crate::generation::words::tokens::Span;

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub enum TokenKind {
    /// A word in lower case, without apostrophes.
    Word,
    /// A number, as digits.
    Number(f64),
    /// A comma.
    Comma,
    /// The end of a sentence: . ; ! ? and line breaks.
    Stop,
    /// A colon, a dash, a bracket, a slash.
    Mark,
    /// Anything else: emoji and the like.
    Symbol,
}

/// A word, a number or a mark.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// In lower case.
    pub text: String,
    /// Where it stood.
    pub span: Span,
}

/// Longest prompt that is read, bytes. What lies beyond is named as not understood.
pub const LONGEST: usize = 20_000;

fn is_word(c: char) -> bool {
    c.is_alphabetic() || matches!(c, '\'' | '’' | '`')
}

/// The end of a name with two underscores or more that begins at `i`; `i` if there is none.
fn identifier(chars: &[(usize, char)], i: usize) -> usize {
    let mut j = i;
    let mut lines = 0;
    while let Some((_, c)) = chars.get(j)
        && (c.is_alphanumeric() || *c == '_')
    {
        lines += usize::from(*c == '_');
        j += 1;
    }
    if lines >= 2 { j } else { i }
}

/// A word for one that is only spoken or typed so.
fn plain(word: &str) -> Option<&'static str> {
    Some(match word {
        "em" => "them",
        "n" => "and",
        "u" => "you",
        "ur" => "your",
        "thru" => "through",
        "w" => "with",
        "cos" | "cuz" | "coz" => "because",
        "tho" => "though",
        _ => return None,
    })
}

/// Words that a full stop shortens.
fn shortened(word: &str) -> bool {
    matches!(
        word,
        "ped"
            | "peds"
            | "veh"
            | "approx"
            | "appr"
            | "ca"
            | "min"
            | "max"
            | "incl"
            | "excl"
            | "opp"
            | "dist"
            | "mtr"
            | "mtrs"
            | "nos"
            | "resp"
            | "eg"
            | "ie"
            | "vs"
            | "pcs"
            | "pc"
            | "nr"
            | "cyc"
            | "constr"
    )
}

/// True if the sentence goes on: with a small letter, a digit or a comma.
fn goes_on(rest: &[(usize, char)]) -> bool {
    let next = rest.iter().map(|c| c.1).find(|c| *c != ' ');
    next.is_some_and(|c| c.is_lowercase() || c.is_ascii_digit() || c == ',')
        && rest.first().is_some_and(|c| c.1 != '\n')
}

/// Splits a prompt. Hyphens and underscores part words; `20m` is a number and a word; `2x` a number.
pub fn tokens(prompt: &str) -> Vec<Token> {
    let chars: Vec<(usize, char)> = prompt.char_indices().take_while(|(i, _)| *i < LONGEST).collect();
    let end_of = |i: usize| {
        chars
            .get(i)
            .map_or(chars.last().map_or(0, |(at, c)| at + c.len_utf8()), |c| c.0)
    };
    let signs = chars.iter().any(|(_, c)| *c == '+');
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < chars.len() {
        let c = chars[i].1;
        let short = out.last().is_some_and(|t| shortened(&t.text));
        let mut j = i + 1;
        let digit = |k: usize| chars.get(k).is_some_and(|(_, c)| c.is_ascii_digit());
        let mut push = |kind, text: String, i: usize, j: usize| {
            let span = Span {
                start: chars[i].0,
                end: end_of(j),
            };
            out.push(Token { kind, text, span });
        };
        if c.is_ascii_digit() || (c == '.' && digit(j)) {
            let mut text = String::from(c);
            while j < chars.len() {
                let d = chars[j].1;
                // "1,000" and "2.5" go on; "2, 3" and "2." do not.
                let thousand = d == ',' && digit(j + 1) && digit(j + 2) && digit(j + 3) && !digit(j + 4);
                if d.is_ascii_digit() || (d == '.' && digit(j + 1) && !text.contains('.')) {
                    text.push(d);
                } else if !thousand {
                    break;
                }
                j += 1;
            }
            let value = text.parse().unwrap_or(f64::INFINITY);
            // "2x cars" counts, and so does "cars x2".
            let times = chars.get(j).is_some_and(|(_, c)| matches!(c, 'x' | '×'))
                && !chars
                    .get(j + 1)
                    .is_some_and(|(_, c)| is_word(*c) || c.is_ascii_digit());
            push(TokenKind::Number(value), text, i, j);
            j += usize::from(times);
        } else if matches!(c, 'x' | '×') && digit(j) {
            // the x of x2
        } else if is_word(c) && identifier(&chars, i) > i {
            // "AEB_night_ped_07" is a name
            j = identifier(&chars, i);
            let text = chars[i..j].iter().map(|(_, c)| *c).collect();
            push(TokenKind::Symbol, text, i, j);
        } else if is_word(c) {
            while j < chars.len() && is_word(chars[j].1) {
                j += 1;
            }
            let text: String = chars[i..j]
                .iter()
                .flat_map(|(_, c)| c.to_lowercase())
                .filter(|c| !matches!(c, '\'' | '’' | '`'))
                .collect();
            // "the truck's nose", "the truck's parked": the truck
            let own = ["'s", "’s", "`s"].iter().any(|e| {
                chars[i..j]
                    .iter()
                    .rev()
                    .take(2)
                    .map(|(_, c)| *c)
                    .eq(e.chars().rev())
            });
            let whole = matches!(
                text.as_str(),
                "its"
                    | "thats"
                    | "theres"
                    | "lets"
                    | "whos"
                    | "whats"
                    | "heres"
                    | "wheres"
                    | "hes"
                    | "shes"
                    | "hows"
                    | "whens"
            );
            let text = match text.strip_suffix('s').filter(|_| own && !whole) {
                Some(stem) => stem.to_string(),
                None => text,
            };
            if !text.is_empty() {
                let text = plain(&text).map_or(text, str::to_string);
                push(TokenKind::Word, text, i, j);
            }
        } else {
            match c {
                ',' | '，' | '、' | '&' => push(TokenKind::Comma, ",".into(), i, j),
                '+' => push(TokenKind::Comma, "+".into(), i, j),
                '.' if short && goes_on(&chars[j..]) => {}
                '.' | ';' | '!' | '?' | '\n' | '。' | '！' | '？' => {
                    push(TokenKind::Stop, ".".into(), i, j)
                }
                ':' | '(' | ')' | '/' | '—' | '–' | '[' | ']' | '"' | '“' | '”' | '#' | '|' | '*' | '=' =>
                {
                    let mark = if c == '=' { ':' } else { c };
                    push(TokenKind::Mark, mark.into(), i, j);
                }
                '-' | '_' => {
                    // Between spaces it parts clauses, inside a word it parts words.
                    let spaced =
                        i > 0 && chars[i - 1].1 == ' ' && chars.get(i + 1).is_some_and(|c| c.1 == ' ');
                    // "+ 2 cars\n- pedestrians": a sign
                    let sign = signs && (i == 0 || matches!(chars[i - 1].1, '\n' | ' ' | ','));
                    if spaced || sign {
                        push(TokenKind::Mark, "-".into(), i, j);
                    }
                }
                '\u{200d}' | '\u{fe0f}' | '\u{fe0e}' => {}
                c if c.is_whitespace() || c.is_control() => {}
                c => push(TokenKind::Symbol, c.into(), i, j),
            }
        }
        i = j;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_marks() {
        let texts = |p: &str| tokens(p).into_iter().map(|t| t.text).collect::<Vec<_>>();
        assert_eq!(
            texts("Don't, T-junction 20m"),
            ["dont", ",", "t", "junction", "20", "m"]
        );
        assert_eq!(
            texts("2x cars x5 1,000 2, 3"),
            ["2", "cars", "5", "1000", "2", ",", "3"]
        );
        assert_eq!(texts("2.5 m. 🚗"), ["2.5", "m", ".", "🚗"]);
        let prompt = "Zwölf 夜 cars";
        let last = tokens(prompt).pop().expect("a token");
        assert_eq!(last.span.of(prompt), "cars");
        assert!(tokens("").is_empty());
        assert_eq!(tokens(&"9".repeat(400))[0].kind, TokenKind::Number(f64::INFINITY));
    }
}
