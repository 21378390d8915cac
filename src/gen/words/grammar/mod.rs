//! The compact grammar: plain English sentences to readings. It answers only for sentences that it reads completely: a
//! sentence with a word left over is left to the learned reader.

mod acts;
mod places;
mod table;
#[cfg(test)]
mod tests;
mod things;

use std::cell::Cell;

use super::mode::Mode;
use super::reading::{Act, Reading};
use super::tokens::Token;
use place::beside_road::TextSpan;
use table::PhraseTable;

/// Result of the grammar for a text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plain {
    /// The acts, with their spans.
    pub reading: Reading,
    /// Words that were not read.
    pub left_over: Vec<TextSpan>,
}

impl Plain {
    /// True if every word was read.
    pub fn is_whole(&self) -> bool {
        self.left_over.is_empty() && !self.reading.acts.is_empty()
    }
}

/// Reads tokens.
pub fn read(tokens: &[Token], mode: Mode) -> Plain {
    let mut out = Plain::default();
    let ends = |t: &Token| matches!(t.text.as_str(), "." | ";" | "!" | "?" | ":");
    for sentence in tokens.split(ends).filter(|s| !s.is_empty()) {
        let g = Grammar {
            tokens: sentence,
            table: PhraseTable::bundled(),
            mode,
            deep: Cell::new(0),
        };
        g.sentence(&mut out);
        if !out.left_over.is_empty() {
            break;
        }
    }
    out
}

/// Number of tokens that name something which no act can add: "dog", "traffic light".
pub fn cannot(tokens: &[Token]) -> Option<usize> {
    PhraseTable::bundled().at("cannot", tokens, 0).map(|f| f.1)
}

/// True if a word stands in any phrase of the grammar.
pub fn knows(word: &str) -> bool {
    PhraseTable::bundled().has_word(word)
}

/// One sentence.
struct Grammar<'t> {
    tokens: &'t [Token],
    table: &'static PhraseTable,
    mode: Mode,
    /// Depth of nested exceptions at the current place.
    deep: Cell<u8>,
}

impl Grammar<'_> {
    fn sentence(&self, out: &mut Plain) {
        let mut i = 0;
        while i < self.tokens.len() {
            i = self.skip(i);
            if i >= self.tokens.len() {
                break;
            }
            let act = self.act(i);
            match act {
                Some((what, end)) => {
                    let span = self.span(i, end);
                    out.reading.acts.push(Act {
                        what,
                        span,
                        confidence: 1.0,
                    });
                    i = self.separators(end);
                }
                // (a sentence that is not read to its end is left to the learned reader)
                None => {
                    out.left_over.push(self.tokens[i].span);
                    return;
                }
            }
        }
    }

    fn span(&self, from: usize, to: usize) -> Option<TextSpan> {
        let part = self.tokens.get(from..to)?;
        part.iter().map(|t| t.span).reduce(TextSpan::to)
    }

    fn word(&self, i: usize) -> &str {
        self.tokens.get(i).map_or("", |t| t.text.as_str())
    }

    /// The token after a phrase of a kind, if one begins here.
    fn after(&self, kind: &str, i: usize) -> Option<usize> {
        self.table.at(kind, self.tokens, i).map(|f| f.1)
    }

    fn symbol(&self, kind: &str, i: usize) -> Option<(&'static str, usize)> {
        self.table.at(kind, self.tokens, i)
    }

    /// Skips tokens without meaning.
    fn skip(&self, mut i: usize) -> usize {
        loop {
            let comma = (self.word(i) == ",").then_some(i + 1);
            // (every scene has a street)
            let street = self.after("street", i).filter(|_| self.mode == Mode::Prompt);
            match comma
                .or(street)
                .or(self.after("polite", i))
                .or(self.after("skip", i))
            {
                Some(next) => i = next,
                None => return i,
            }
        }
    }

    fn separators(&self, mut i: usize) -> usize {
        while matches!(
            self.word(i),
            "," | "and" | "then" | "but" | "&" | "+" | "plus" | "while" | "-" | "–" | "(" | ")"
        ) {
            i += 1;
        }
        i
    }

    /// True where a clause may end.
    fn is_end(&self, i: usize) -> bool {
        let i = self.skip(i);
        i >= self.tokens.len() || self.separators(i) > i
    }
}
