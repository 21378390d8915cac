//! A text to tokens: words in lower case, numbers and lengths read, typing errors corrected, senses looked up. Twin of
//! `training/words/lexicon.py`.

use std::collections::HashMap;

pub use place::beside_road::TextSpan;

use super::lexicon::{LONGEST_PHRASE, Lexicon, Sense, is_english};

/// Longest text that is read, bytes; the text beyond is reported as not understood.
pub const LONGEST: usize = 20_000;

/// A word, a number, a length or a mark.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    /// The word in lower case, corrected; `<n>` for digits, `<m>` for a length.
    pub text: String,
    /// Bytes of the text.
    pub span: TextSpan,
    /// Value of a number, or of a length in metres.
    pub value: Option<f64>,
    /// The number as it was typed, without regard to its unit.
    pub raw: Option<f64>,
    /// True for a length.
    pub is_length: bool,
    /// True if the value is a speed, km/h.
    pub is_speed: bool,
    /// Senses of the phrase that it belongs to, from the lexicon.
    pub senses: Vec<Sense>,
    /// The word as it was typed, where a typing error was corrected.
    pub typed: Option<String>,
    /// Kinds of things whose names differ from the word by one typing error.
    pub slip_of: Vec<&'static str>,
}

/// Number of tokens at the beginning of a text in which typing errors are corrected: about as many as are read.
const MOST_MENDED: usize = 700;

const ONES: [&str; 20] = [
    "zero",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
];
const TENS: [(&str, f64); 9] = [
    ("twenty", 20.0),
    ("thirty", 30.0),
    ("forty", 40.0),
    ("fourty", 40.0),
    ("fifty", 50.0),
    ("sixty", 60.0),
    ("seventy", 70.0),
    ("eighty", 80.0),
    ("ninety", 90.0),
];

/// The value of a number word.
pub fn number_word(word: &str) -> Option<f64> {
    let one = ONES.iter().position(|w| *w == word).map(|n| n as f64);
    let ten = || TENS.iter().find(|t| t.0 == word).map(|t| t.1);
    one.or_else(ten).or(match word {
        "dozen" => Some(12.0),
        "hundred" => Some(100.0),
        _ => None,
    })
}

fn is_apostrophe(c: char) -> bool {
    matches!(c, '\'' | '’' | '`')
}

fn is_letter(c: char) -> bool {
    c.is_alphabetic()
}

/// Pieces of the text: numbers, words (with an apostrophe in them), marks.
fn pieces(text: &str) -> Vec<(String, TextSpan)> {
    let chars: Vec<(usize, char)> = text.char_indices().collect();
    let at = |i: usize| chars.get(i).map(|c| c.1);
    let end_of = |i: usize| chars.get(i).map_or(text.len(), |c| c.0);
    let mut out = Vec::new();
    let mut i = 0;
    while let Some(c) = at(i) {
        let mut j = i + 1;
        let run = |mut k: usize, test: fn(char) -> bool| {
            while at(k).is_some_and(test) {
                k += 1;
            }
            k
        };
        if c.is_ascii_digit() {
            j = run(j, |c| c.is_ascii_digit());
            if at(j).is_some_and(|c| c == '.' || c == ',') && at(j + 1).is_some_and(|c| c.is_ascii_digit()) {
                j = run(j + 1, |c| c.is_ascii_digit());
            }
        } else if is_letter(c) {
            j = run(j, is_letter);
            if at(j).is_some_and(is_apostrophe) && at(j + 1).is_some_and(is_letter) {
                j = run(j + 1, is_letter);
            }
        } else if c.is_whitespace() {
            i += 1;
            continue;
        }
        let span = TextSpan {
            start: end_of(i),
            end: end_of(j),
        };
        out.push((span.of(text).to_lowercase(), span));
        i = j;
    }
    out
}

/// Words and marks: `'s` separated, hyphens between words removed.
fn words(text: &str) -> Vec<(String, TextSpan)> {
    let mut out: Vec<(String, TextSpan)> = Vec::new();
    for (piece, span) in pieces(text) {
        let Some((head, tail)) = piece
            .split_once(is_apostrophe)
            .filter(|(h, t)| !h.is_empty() && !t.is_empty())
        else {
            out.push((piece, span));
            continue;
        };
        if matches!(tail, "s" | "re" | "ll" | "ve" | "d" | "m") && head != "let" {
            let raw = span.of(text);
            let cut = span.start + raw.find(is_apostrophe).unwrap_or(raw.len());
            out.push((head.to_owned(), TextSpan { end: cut, ..span }));
            out.push((format!("'{tail}"), TextSpan { start: cut, ..span }));
        } else {
            out.push((format!("{head}{tail}"), span));
        }
    }
    let digit = |w: &str| w.starts_with(|c: char| c.is_ascii_digit());
    let hyphen = |i: usize| {
        matches!(out[i].0.as_str(), "-" | "–" | "‑")
            && i > 0
            && i + 1 < out.len()
            && out[i - 1].1.end == out[i].1.start
            && out[i].1.end == out[i + 1].1.start
            && !(digit(&out[i - 1].0) && digit(&out[i + 1].0))
    };
    let keep: Vec<bool> = (0..out.len()).map(|i| !hyphen(i)).collect();
    let mut keep = keep.into_iter();
    out.retain(|_| keep.next().unwrap_or(true));
    out
}

/// Corrects words that are in no list and are not English: to the most frequent word that differs by one typing error.
pub struct Speller {
    rank: HashMap<String, usize>,
    by_length: HashMap<usize, Vec<String>>,
}

impl Speller {
    /// A speller from words by frequency, the most frequent first; those of the lexicon follow.
    pub fn new(common: &[String]) -> Self {
        let rank: HashMap<String, usize> = common.iter().cloned().zip(0..).collect();
        let mut by_length: HashMap<usize, Vec<String>> = HashMap::new();
        let more = Lexicon::bundled()
            .single_words()
            .filter(|w| !rank.contains_key(*w));
        for w in common.iter().cloned().chain(more.map(str::to_owned)) {
            by_length.entry(w.chars().count()).or_default().push(w);
        }
        Self { rank, by_length }
    }

    /// True if a word is in a list, or too short to be corrected.
    pub fn knows(&self, w: &str) -> bool {
        let lexicon = Lexicon::bundled();
        self.rank.contains_key(w)
            || lexicon.senses(w).is_some()
            || number_word(w).is_some()
            || lexicon.unit(w).is_some()
            || is_english(w)
            || w.chars().count() < 3
            || !w.chars().all(char::is_alphabetic)
    }

    /// True if a word is one of the frequent ones.
    pub fn is_common(&self, w: &str) -> bool {
        self.rank.contains_key(w) && w.chars().any(char::is_alphabetic)
    }

    /// The word that was meant.
    pub fn mend(&self, w: &str) -> Option<&str> {
        const LONGEST_WORD: usize = 24;
        let n = w.chars().count();
        if self.knows(w) || n > LONGEST_WORD {
            return None;
        }
        let first = w.chars().next();
        let lists = [n, n + 1, n - 1].into_iter().filter(|n| *n >= 3);
        lists
            .filter_map(|n| self.by_length.get(&n))
            .flatten()
            // (in a word of three letters, only a swap of two counts)
            .filter(|c| is_one_slip(w, c) && (n > 3 || sorted(c) == sorted(w)))
            .min_by_key(|c| {
                let rank = self.rank.get(c.as_str()).copied().unwrap_or(self.rank.len());
                (c.chars().next() != first, rank, c.as_str())
            })
            .map(String::as_str)
    }
}

fn sorted(word: &str) -> Vec<char> {
    let mut letters: Vec<char> = word.chars().collect();
    letters.sort_unstable();
    letters
}

/// True if one insertion, deletion, substitution or swap of neighbours makes `b` of `a`.
pub(super) fn is_one_slip(a: &str, b: &str) -> bool {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    if a == b || a.len().abs_diff(b.len()) > 1 {
        return false;
    }
    let i = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    match a.len().cmp(&b.len()) {
        std::cmp::Ordering::Equal => {
            a[i + 1..] == b[i + 1..]
                || i + 1 < a.len() && a[i] == b[i + 1] && a[i + 1] == b[i] && a[i + 2..] == b[i + 2..]
        }
        std::cmp::Ordering::Greater => a[i + 1..] == b[i..],
        std::cmp::Ordering::Less => a[i..] == b[i + 1..],
    }
}

/// The tokens of a text, of which at most [`LONGEST`] bytes are read.
pub fn tokens(text: &str, speller: Option<&Speller>) -> Vec<Token> {
    let mut end = text.len().min(LONGEST);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    let lexicon = Lexicon::bundled();
    let words = words(&text[..end]);
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < words.len() {
        let (word, span) = &words[i];
        let mut token = Token {
            text: word.clone(),
            span: *span,
            value: None,
            raw: None,
            is_length: false,
            is_speed: false,
            senses: Vec::new(),
            typed: None,
            slip_of: Vec::new(),
        };
        i += 1;
        if word.starts_with(|c: char| c.is_ascii_digit()) {
            token.value = word
                .replace(',', ".")
                .parse()
                .ok()
                .filter(|v: &f64| v.is_finite());
            token.text = "<n>".into();
        } else {
            if out.len() < MOST_MENDED
                && let Some(mended) = speller.and_then(|s| s.mend(word))
            {
                token.typed = Some(std::mem::replace(&mut token.text, mended.to_owned()));
            }
            token.value = number_word(&token.text);
            let tens = TENS.iter().any(|t| t.0 == token.text);
            let ones = |w: &str| ONES[1..10].iter().position(|o| *o == w).map(|n| n as f64 + 1.0);
            if let (true, Some(value), Some(more)) =
                (tens, token.value, words.get(i).and_then(|w| ones(&w.0)))
            {
                token.value = Some(value + more);
                token.span.end = words[i].1.end;
                i += 1;
            }
        }
        token.raw = token.value;
        if let Some(value) = token.value {
            for n in [3, 2, 1] {
                let Some(unit) = words.get(i..i + n) else { continue };
                let unit: Vec<&str> = unit.iter().map(|w| w.0.as_str()).collect();
                let phrase = unit.join(" ");
                let doubtful = phrase == "ms" || phrase == "m" && token.text != "<n>";
                if let Some(unit) = lexicon.unit(&phrase).filter(|_| !doubtful) {
                    token.text = if unit.is_speed { "<v>" } else { "<m>" }.into();
                    (token.is_speed, token.is_length) = (unit.is_speed, !unit.is_speed);
                    token.value = Some(value * unit.times);
                    token.span.end = words[i + n - 1].1.end;
                    i += n;
                    break;
                }
            }
        }
        out.push(token);
    }
    look_up(&mut out, lexicon);
    find_slips(&mut out, lexicon);
    out
}

/// Finds the names that words may be typing errors of. Each word is looked up once: a text may hold the same one a
/// thousand times.
fn find_slips(tokens: &mut [Token], lexicon: &Lexicon) {
    let mut known: HashMap<String, Vec<&'static str>> = HashMap::new();
    for t in tokens.iter_mut().take(MOST_MENDED) {
        // (a number is not a typing error, and an English word is meant as it is)
        let word = t.text.chars().count() > 2 && t.text.chars().all(char::is_alphabetic);
        if !word || is_english(&t.text) {
            continue;
        }
        let slips = known.entry(t.text.clone()).or_insert_with(|| {
            let near = lexicon.nouns_near(&t.text);
            near.filter(|(form, _)| is_one_slip(&t.text, form))
                .map(|(_, symbol)| symbol)
                .collect()
        });
        t.slip_of.clone_from(slips);
    }
}

/// Gives each token the senses of the longest phrase that begins with it or holds it.
fn look_up(tokens: &mut [Token], lexicon: &Lexicon) {
    let mut i = 0;
    while i < tokens.len() {
        let most = LONGEST_PHRASE.min(tokens.len() - i);
        let found = (1..=most).rev().find_map(|n| {
            let phrase: Vec<&str> = tokens[i..i + n].iter().map(|t| t.text.as_str()).collect();
            lexicon.senses(&phrase.join(" ")).map(|s| (n, s))
        });
        match found {
            Some((n, senses)) => {
                for t in &mut tokens[i..i + n] {
                    t.senses.extend_from_slice(senses);
                }
                i += n;
            }
            None => i += 1,
        }
    }
}
