//! Splits a text into words, numbers and marks: the tokens of [`words`](crate), with lengths as number and unit.

use super::super::measure::{MeasuredQuantity, measures};
use place::beside_road::TextSpan;

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TokenKind {
    /// A word in lower case.
    Word,
    /// A number.
    Number(f64),
    /// A comma, or a word that stands for one.
    Comma,
    /// The end of a sentence: . ; ! ? and line breaks.
    Stop,
    /// A number of a unit that no thing beside the road has: "30 km/h".
    Idle,
    /// Any other mark.
    Mark,
}

/// A word, a number or a mark.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    /// Kind.
    pub kind: TokenKind,
    /// Its text in lower case.
    pub text: String,
    /// Its place in the text.
    pub span: TextSpan,
}

/// The tokens of a text.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut end = 0;
    let all = super::super::tokens::tokens(text, None);
    let mut numbers = measures(&all).into_iter().peekable();
    for (i, t) in all.iter().enumerate() {
        let mut span = t.span;
        while numbers.peek().is_some_and(|m| m.to <= i) {
            numbers.next();
        }
        let measure = numbers.peek().filter(|m| m.from <= i);
        let kind = measure.map_or(MeasuredQuantity::Count, |m| m.kind);
        let is_own = matches!(
            kind,
            MeasuredQuantity::Count | MeasuredQuantity::Length | MeasuredQuantity::Storeys
        );
        if let Some(m) = measure.filter(|_| !is_own) {
            if m.from < i {
                continue;
            }
            span = m.span(&all);
        }
        let mut push = |kind, text: &str| {
            out.push(Token {
                kind,
                text: text.to_owned(),
                span,
            });
        };
        if text.get(end..span.start).is_some_and(|gap| gap.contains('\n')) {
            push(TokenKind::Stop, ".");
        }
        end = span.end;
        match (t.value, t.text.as_str()) {
            // ("one more", "one of")
            (Some(_), _) if kind == MeasuredQuantity::Speed => push(TokenKind::Idle, "km/h"),
            (Some(_), _) if !is_own => push(TokenKind::Mark, "unit"),
            (Some(_), "one") => push(TokenKind::Word, "one"),
            (Some(n), word) => {
                push(TokenKind::Number(n), word);
                if t.is_length {
                    push(TokenKind::Word, "m");
                }
            }
            (None, "'s") => {}
            (None, "," | "，" | "、" | "&" | "+") => push(TokenKind::Comma, ","),
            (None, "." | ";" | "!" | "?" | "。" | "！" | "？") => push(TokenKind::Stop, "."),
            (None, word) if word.starts_with(char::is_alphabetic) => push(TokenKind::Word, word),
            (None, mark) => push(TokenKind::Mark, mark),
        }
    }
    out
}
