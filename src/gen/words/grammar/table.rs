//! The phrases of the grammar, from `assets/words/grammar.txt`.

use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

use super::super::tokens::Token;

/// Most words of a phrase.
const LONGEST: usize = 9;

/// Phrases by kind.
pub(super) struct PhraseTable {
    kinds: HashMap<&'static str, HashMap<&'static str, &'static str>>,
    /// Words of all phrases, except those for things that cannot be done.
    words: HashSet<&'static str>,
}

static TABLE: LazyLock<PhraseTable> = LazyLock::new(|| {
    let mut kinds: HashMap<&str, HashMap<&str, &str>> = HashMap::new();
    let mut words = HashSet::new();
    let text = assets::words::GRAMMAR;
    for (key, phrases) in text
        .lines()
        .filter(|l| !l.starts_with('#'))
        .filter_map(|l| l.split_once(": "))
    {
        let Some((kind, symbol)) = key.split_once(' ') else {
            continue;
        };
        let of = kinds.entry(kind).or_default();
        for phrase in phrases.split(", ") {
            of.entry(phrase).or_insert(symbol);
            if kind != "cannot" {
                words.extend(phrase.split(' '));
            }
        }
    }
    PhraseTable { kinds, words }
});

impl PhraseTable {
    pub(super) fn bundled() -> &'static Self {
        &TABLE
    }

    /// The longest phrase of a kind that begins at a token: its symbol, and the token after it.
    pub(super) fn at(&self, kind: &str, tokens: &[Token], i: usize) -> Option<(&'static str, usize)> {
        self.all_at(kind, tokens, i).next()
    }

    /// All phrases of a kind that begin there, the longest first.
    pub(super) fn all_at(
        &self,
        kind: &str,
        tokens: &[Token],
        i: usize,
    ) -> impl Iterator<Item = (&'static str, usize)> {
        let of = self.kinds.get(kind);
        let most = LONGEST.min(tokens.len().saturating_sub(i));
        let found: Vec<_> = (1..=most)
            .rev()
            .filter_map(|n| {
                let words: Vec<&str> = tokens[i..i + n].iter().map(|t| t.text.as_str()).collect();
                of?.get(words.join(" ").as_str()).map(|s| (*s, i + n))
            })
            .collect();
        found.into_iter()
    }

    /// True if a word stands in any phrase: it is understood, or skipped on purpose.
    pub(super) fn has_word(&self, word: &str) -> bool {
        self.words.contains(word)
    }
}
