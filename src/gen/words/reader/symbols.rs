//! Input and output of the network as numbers. Twin of `training/words/symbols.py`.

use std::collections::HashMap;

use super::super::lexicon::{Lexicon, Sense};
use super::super::mode::Mode;
use super::super::notation::{self, Prefix};
use super::super::nouns::Noun;
use super::super::tokens::Token;
use nets::text::hash;

/// Buckets of letter triples.
pub(super) const GRAMS: usize = 4096;
/// Numeric tokens that can be pointed at.
pub(super) const MOST_NUMBERS: usize = 8;
/// Most tokens that are read at once.
pub(super) const MOST_TOKENS: usize = 111;
/// Most symbols of a reading.
pub(super) const MOST_SYMBOLS: usize = 160;
/// Symbol that ends a reading.
pub(super) const END: usize = 0;

/// Tokens as the network takes them; the first place is the mode.
pub(super) struct Input {
    pub(super) words: Vec<usize>,
    pub(super) grams: Vec<Vec<usize>>,
    pub(super) senses: Vec<Vec<usize>>,
    pub(super) values: Vec<usize>,
    pub(super) pointers: Vec<usize>,
    /// The symbols that copying a token gives: by its sense, and as a number to point at.
    pub(super) copy_sense: Vec<Option<usize>>,
    pub(super) copy_number: Vec<Option<usize>>,
}

/// Symbols and words by name.
pub(super) struct Symbols {
    names: Vec<String>,
    id: HashMap<String, usize>,
    word: HashMap<String, usize>,
}

impl Symbols {
    /// Fails if the notation of this program has other symbols.
    pub(super) fn new(names: Vec<String>, words: &[String]) -> Result<Self, String> {
        let id: HashMap<String, usize> = names.iter().cloned().zip(0..).collect();
        for needed in ["<end>", ";", "(", ")", "@0", "=0", "#"] {
            if !id.contains_key(needed) {
                return Err(format!("symbol {needed:?} is missing"));
            }
        }
        if names[END] != "<end>" || id.len() != names.len() {
            return Err("symbols are not in order".into());
        }
        let word = words.iter().cloned().zip(3..).collect();
        Ok(Self { names, id, word })
    }

    pub(super) fn name(&self, symbol: usize) -> &str {
        &self.names[symbol]
    }

    pub(super) fn input(&self, tokens: &[Token], mode: Mode) -> Input {
        let lexicon = Lexicon::bundled();
        let mut x = Input {
            words: vec![if mode == Mode::Prompt { 1 } else { 2 }],
            grams: vec![Vec::new()],
            senses: vec![Vec::new()],
            values: vec![0],
            pointers: vec![0],
            copy_sense: vec![None],
            copy_number: vec![None],
        };
        let mut numbers = 0;
        for t in tokens {
            x.words.push(self.word.get(&t.text).copied().unwrap_or(0));
            x.grams.push(if t.text.starts_with('<') {
                Vec::new()
            } else {
                grams(&t.text)
            });
            let mut senses: Vec<usize> = t.senses.iter().map(|s| lexicon.id(s)).collect();
            senses.sort_unstable();
            senses.dedup();
            senses.truncate(4);
            x.senses.push(senses);
            x.values.push(match t.value {
                None => 0,
                Some(v) if v.fract() != 0.0 || v > 31.0 => 33,
                Some(v) => v as usize + 1,
            });
            let points = t.value.is_some() && numbers < MOST_NUMBERS;
            x.pointers.push(if points { numbers + 1 } else { 0 });
            x.copy_number.push(if points {
                self.id.get(&format!("@{numbers}")).copied()
            } else {
                None
            });
            numbers += usize::from(points);
            x.copy_sense.push(match t.value {
                Some(v) if !t.is_length && !t.is_speed && v.fract() == 0.0 && v <= 20.0 => {
                    self.id.get(&(v as u32).to_string()).copied()
                }
                _ => t.senses.iter().find_map(|s| self.of_sense(s)),
            });
        }
        x
    }

    fn of_sense(&self, sense: &Sense) -> Option<usize> {
        match sense.kind {
            "noun" | "paint" | "time" | "weather" | "env" | "density" | "road" | "place" => {
                self.id.get(sense.symbol).copied()
            }
            "ego" => self.id.get("ego").copied(),
            _ => None,
        }
    }

    /// The notation of symbols.
    pub(super) fn line(&self, said: &[usize], tokens: &[Token]) -> String {
        let numbers: Vec<f64> = tokens.iter().filter_map(|t| t.value).take(MOST_NUMBERS).collect();
        let value = |name: &str| {
            let k: usize = name[1..].parse().unwrap_or(0);
            numbers.get(k).copied().unwrap_or(0.0)
        };
        let mut out: Vec<String> = Vec::new();
        for s in said {
            let name = self.name(*s);
            match name.as_bytes() {
                [b'=', _] => out.push(format!("{}", value(name) as u64)),
                [b'@', _] => {
                    let v = value(name);
                    match out.last_mut() {
                        Some(last) if last == "#" => *last = format!("#{}", v as u64),
                        last => {
                            let unit = last.and_then(|last| unit_after(last)).unwrap_or("m");
                            out.push(format!("{}{unit}", (v * 1000.0).round() / 1000.0));
                        }
                    }
                }
                _ if out.last().is_some_and(|last| unit_after(last).is_some()) && is_number(name) => {
                    let unit = out.last().and_then(|last| unit_after(last)).unwrap_or("m");
                    out.push(format!("{}{unit}", name.trim_end_matches('m')));
                }
                _ => out.push(name.to_owned()),
            }
        }
        out.join(" ")
    }

    /// True if a symbol continues the symbols so far to the beginning of a valid reading, or ends them where they are a
    /// whole one.
    pub(super) fn may_follow(
        &self,
        symbol: usize,
        said: &[usize],
        line: &str,
        tokens: &[Token],
        prefix: &Prefix,
    ) -> bool {
        let name = self.name(symbol);
        let last = said.last().map_or("", |s| self.name(*s));
        let numbers = tokens.iter().filter(|t| t.value.is_some()).count();
        let points_at = |n: &str| {
            n[1..]
                .parse::<usize>()
                .is_ok_and(|k| k < numbers.min(MOST_NUMBERS))
        };
        match name.as_bytes() {
            _ if symbol == END => prefix.is_whole && last != "#",
            [b'@' | b'=', _] if !points_at(name) => false,
            [b'@', _] if last == "#" => true,
            _ if last == "#" => false,
            [b'#'] => Noun::of(last).is_some(),
            _ => {
                let mut more = said.to_vec();
                more.push(symbol);
                let next = self.line(&more, tokens);
                debug_assert!(next.starts_with(line) || line.is_empty());
                notation::prefix(&next).is_open
            }
        }
    }
}

/// The unit of a number after a symbol, if it is not metres.
fn unit_after(symbol: &str) -> Option<&'static str> {
    match symbol {
        "from" | "length" => Some("s"),
        "speed" => Some("kmh"),
        _ => None,
    }
}

fn is_number(name: &str) -> bool {
    name.trim_end_matches('m')
        .parse::<f64>()
        .is_ok_and(f64::is_finite)
}

/// Buckets of the letter triples of a word with its ends.
fn grams(word: &str) -> Vec<usize> {
    let letters: Vec<char> = std::iter::once('^')
        .chain(word.chars())
        .chain(std::iter::once('$'))
        .collect();
    let mut out: Vec<usize> = letters
        .windows(3.min(letters.len()))
        .map(|l| {
            let text: String = l.iter().collect();
            1 + hash(&text) as usize % (GRAMS - 1)
        })
        .collect();
    out.sort_unstable();
    out.dedup();
    out
}
