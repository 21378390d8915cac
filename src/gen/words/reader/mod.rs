//! The learned reader: a small encoder-decoder that outputs a reading in notation, symbol by symbol, restricted to
//! symbols that continue a valid reading. Twin of `training/words/reader.py`.

mod net;
mod symbols;
#[cfg(test)]
mod tests;

use std::sync::{Arc, OnceLock};

use super::account::missing;
use super::grammar;
pub use super::mode::Mode;
use super::notation;
use super::reading::Reading;
use super::tokens::{Speller, Token, tokens};
use net::{DecoderState, EncodedText, Net, NetConfig};
use nn::weights::{WeightFile, WeightsError};
use place::beside_road::TextSpan;
use symbols::{Input, Symbols};

/// File name of the weights.
pub const FILE: &str = "reader.safetensors";

/// Parts of a long text that are read; the text beyond is reported.
pub const MOST_PARTS: usize = 6;

/// Output of the network for a text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReaderOutput {
    /// The reading; its acts have spans and confidences.
    pub reading: Reading,
    /// Its tokens.
    pub tokens: Vec<Token>,
    /// Tokens beyond the longest text that is read.
    pub left_out: Vec<Token>,
}

/// The network with its word list.
pub struct LearnedReader {
    net: Net,
    symbols: Symbols,
    speller: Speller,
}

impl LearnedReader {
    /// The weights that ship with the program; unpacked once.
    ///
    /// # Errors
    ///
    /// If the file differs from the format that its twin writes.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static READER: OnceLock<Arc<LearnedReader>> = OnceLock::new();
        if let Some(reader) = READER.get() {
            return Ok(reader.clone());
        }
        let bytes = assets::weights::READER;
        let reader = Self::new(WeightFile::parse(FILE, bytes)?)?;
        Ok(READER.get_or_init(|| Arc::new(reader)).clone())
    }

    /// Takes all tensors of the file; its metadata hold sizes, symbols and words.
    ///
    /// # Errors
    ///
    /// If sizes, symbols or senses differ from those of this program.
    pub fn new(mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: NetConfig = file.config("config")?;
        let words: Vec<String> = file.config("words")?;
        let names: Vec<String> = file.config("symbols")?;
        let symbols = Symbols::new(names, &words).map_err(|e| file.config_error("symbols", e))?;
        config
            .check(words.len())
            .map_err(|e| file.config_error("config", e))?;
        let net = Net::new(&mut file, config)?;
        file.finish()?;
        Ok(Self {
            net,
            symbols,
            speller: Speller::new(&words),
        })
    }

    /// Corrects typing errors as in the network's training.
    pub fn speller(&self) -> &Speller {
        &self.speller
    }

    /// True if a word has a meaning, or is one of the frequent ones; false for a number.
    pub fn knows(&self, t: &Token) -> bool {
        let is_word = t.value.is_none() && (self.speller.is_common(&t.text) || grammar::knows(&t.text));
        !t.senses.is_empty() || is_word
    }

    /// Reads a text: as a whole if it is short, else sentence by sentence, at most [`MOST_PARTS`] of them.
    pub fn read(&self, text: &str, mode: Mode) -> ReaderOutput {
        let mut all = tokens(text, Some(&self.speller));
        let ends = parts(&all);
        let read_to = ends.last().copied().unwrap_or(0);
        let mut out = ReaderOutput::default();
        let mut from = 0;
        for end in ends {
            let part = &all[from..end];
            // (a part of only unknown words and numbers is not read)
            if part.iter().any(|t| self.knows(t)) {
                out.reading.acts.extend(self.say(text, part, mode).acts);
            }
            from = end;
        }
        out.left_out = all.split_off(read_to);
        out.tokens = all;
        out
    }

    /// The reading of a few tokens: the most likely symbols one by one. If these leave words out, a few alternatives
    /// are tried too, which branch off where the network was least sure.
    fn say(&self, text: &str, all: &[Token], mode: Mode) -> Reading {
        let input = self.symbols.input(all, mode);
        let memory = self.net.encode(&input);
        let mut state = self.net.begin();
        let mut first = Spoken::default();
        self.go_on(&mut first, &mut state, &memory, &input, all);
        let mut best = self.reading(&first, all);
        let left_out = |r: &Reading| missing(text, all, r, &self.speller).len();
        let words = left_out(&best);
        if words == 0 {
            return best;
        }
        let score = |s: &Spoken, words: usize| s.log_p() - PRICE * words as f64;
        let mut best_score = score(&first, words);
        for at in first.least_sure() {
            let Some(rival) = first.said[at].rival else {
                continue;
            };
            let mut other = Spoken {
                said: first.said[..at].to_vec(),
            };
            other.said.push(rival.into());
            // (back to the step that has taken in all symbols before the rival)
            let mut state = state.clone();
            state.back_to(at + 1, &self.net);
            if rival.0 != symbols::END {
                self.go_on(&mut other, &mut state, &memory, &input, all);
            }
            let reading = self.reading(&other, all);
            let other_score = score(&other, left_out(&reading));
            if other_score > best_score {
                (best, best_score) = (reading, other_score);
            }
        }
        best
    }

    /// Completes a line greedily; only symbols that continue a valid reading are taken.
    fn go_on(
        &self,
        spoken: &mut Spoken,
        state: &mut DecoderState,
        memory: &EncodedText,
        input: &Input,
        all: &[Token],
    ) {
        let mut said = spoken.symbols();
        while said.len() < symbols::MOST_SYMBOLS {
            let line = self.symbols.line(&said, all);
            let prefix = notation::prefix(&line);
            let (p, attention) = self.net.next(state, memory, said.last().copied(), input);
            let mut order: Vec<usize> = (0..p.len()).filter(|i| p[*i] > 1e-6).collect();
            order.sort_by(|a, b| p[*b].total_cmp(&p[*a]));
            let fits = |s: &&usize| self.symbols.may_follow(**s, &said, &line, all, &prefix);
            let mut can = order.iter().filter(fits);
            let Some(symbol) = can.next().copied() else { break };
            let sure = p[symbol] > SURE;
            let rival = if sure { None } else { can.next() };
            spoken.said.push(Symbol {
                id: symbol,
                p: f64::from(p[symbol]),
                // (the token with the most attention belongs to the act of this symbol)
                looked_at: attention
                    .iter()
                    .skip(1)
                    .enumerate()
                    .max_by(|a, b| a.1.total_cmp(b.1))
                    .map(|(i, _)| i),
                rival: rival.map(|r| (*r, f64::from(p[*r]))),
            });
            if symbol == symbols::END {
                break;
            }
            said.push(symbol);
        }
    }

    /// The reading of a line; the confidence of an act is that of its least sure symbol.
    fn reading(&self, spoken: &Spoken, all: &[Token]) -> Reading {
        let line = self.symbols.line(&spoken.symbols(), all);
        // (a line that was cut off ends with its last whole act)
        let mut reading = notation::parse(&line).unwrap_or_default();
        if reading.acts.is_empty()
            && let Some((whole, _)) = line.rsplit_once(" ; ")
        {
            reading = notation::parse(whole).unwrap_or_default();
        }
        let acts = spoken.said.split_inclusive(|s| self.symbols.name(s.id) == ";");
        for (act, said) in reading.acts.iter_mut().zip(acts) {
            act.confidence = said.iter().fold(1.0, |least: f64, s| least.min(s.p)).max(0.0);
            let spans = said.iter().filter_map(|s| all.get(s.looked_at?)).map(|t| t.span);
            act.span = spans.reduce(TextSpan::to);
        }
        reading
    }
}

/// Penalty for a word that is left out, in log probability.
const PRICE: f64 = 3.0;
/// Most alternatives that are tried.
const OTHERS: usize = 3;
/// Probability from which on a symbol has no rival.
const SURE: f32 = 0.9;

#[derive(Clone, Copy)]
struct Symbol {
    id: usize,
    p: f64,
    /// The token that the network looked at most.
    looked_at: Option<usize>,
    /// The second likeliest symbol at this place, and its probability.
    rival: Option<(usize, f64)>,
}

impl From<(usize, f64)> for Symbol {
    fn from((id, p): (usize, f64)) -> Self {
        Self {
            id,
            p,
            looked_at: None,
            rival: None,
        }
    }
}

/// A line in the making.
#[derive(Default)]
struct Spoken {
    said: Vec<Symbol>,
}

impl Spoken {
    /// Ids of its symbols, without the end.
    fn symbols(&self) -> Vec<usize> {
        let ids = self.said.iter().map(|s| s.id);
        ids.filter(|id| *id != symbols::END).collect()
    }

    fn log_p(&self) -> f64 {
        self.said.iter().map(|s| s.p.max(1e-9).ln()).sum()
    }

    /// Places with a rival symbol, the least sure first.
    fn least_sure(&self) -> Vec<usize> {
        let mut at: Vec<usize> = (0..self.said.len())
            .filter(|i| self.said[*i].rival.is_some())
            .collect();
        at.sort_by(|a, b| self.said[*a].p.total_cmp(&self.said[*b].p));
        at.truncate(OTHERS);
        at
    }
}

/// Ends of the parts of a text: one part if it is short, else sentences, as many together as fit.
fn parts(all: &[Token]) -> Vec<usize> {
    let mut ends = Vec::new();
    let mut from = 0;
    while from < all.len() && ends.len() < MOST_PARTS {
        let most = all.len().min(from + symbols::MOST_TOKENS);
        let stop = |i: &usize| matches!(all[*i - 1].text.as_str(), "." | ";" | "!" | "?");
        let end = match most == all.len() {
            true => most,
            false => (from + 1..=most).rev().find(stop).unwrap_or(most),
        };
        ends.push(end);
        from = end;
    }
    ends
}
