//! The learned reader: a small encoder-decoder that says a reading in notation, symbol by symbol; only what continues a
//! valid reading can be said. Twin of `training/words/reader.py`.

mod net;
mod symbols;
#[cfg(test)]
mod tests;

use std::sync::{Arc, OnceLock};

use super::notation::{self, Prefix};
use super::reading::Reading;
use super::tokens::{Span, Speller, Token, tokens};
use crate::generation::weights::{WeightFile, WeightsError};
use net::{Net, NetConfig};
use symbols::Symbols;

/// File name of the weights.
pub const FILE: &str = "reader.safetensors";

/// Whether a text makes a scene or changes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A new scene.
    Prompt,
    /// A change of the scene that is there.
    Edit,
}

/// Parts of a long text that are read; what lies beyond is named.
pub const MOST_PARTS: usize = 6;

/// What the network said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    /// The reading; acts bear spans and confidences.
    pub reading: Reading,
    /// Its tokens.
    pub tokens: Vec<Token>,
    /// What lies beyond the longest text that is read.
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
    /// If the file does not hold what its twin writes.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static READER: OnceLock<Arc<LearnedReader>> = OnceLock::new();
        if let Some(reader) = READER.get() {
            return Ok(reader.clone());
        }
        let bytes = include_bytes!("../../../../assets/weights/reader.safetensors");
        let reader = Self::new(WeightFile::parse(FILE, bytes)?)?;
        Ok(READER.get_or_init(|| Arc::new(reader)).clone())
    }

    /// Takes all tensors of the file; its metadata hold sizes, symbols and words.
    ///
    /// # Errors
    ///
    /// If sizes, symbols or senses are not those of this program.
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

    /// Mends slips as the network expects it.
    pub fn speller(&self) -> &Speller {
        &self.speller
    }

    /// Reads a text: whole if it is short, else sentence by sentence, and at most [`MOST_PARTS`] of these.
    pub fn read(&self, text: &str, mode: Mode) -> Said {
        let mut all = tokens(text, Some(&self.speller));
        let ends = parts(&all);
        let read_to = ends.last().copied().unwrap_or(0);
        let mut out = Said::default();
        let mut from = 0;
        for end in ends {
            let reading = self.say(&all[from..end], mode);
            out.reading.acts.extend(reading.acts);
            from = end;
        }
        out.left_out = all.split_off(read_to);
        out.tokens = all;
        out
    }

    /// The reading of a few tokens.
    fn say(&self, all: &[Token], mode: Mode) -> Reading {
        let input = self.symbols.input(all, mode);
        let memory = self.net.encode(&input);
        let mut state = self.net.begin();
        let mut said: Vec<usize> = Vec::new();
        let mut line = String::new();
        let mut acts: Vec<(f64, Vec<usize>)> = vec![(1.0, Vec::new())];
        let mut prefix = Prefix::default();
        while said.len() < symbols::MOST_SYMBOLS {
            let (p, look) = self.net.next(&mut state, &memory, said.last().copied(), &input);
            let mut order: Vec<usize> = (0..p.len()).filter(|i| p[*i] > 1e-6).collect();
            order.sort_by(|a, b| p[*b].total_cmp(&p[*a]));
            let fits = |s: &&usize| self.symbols.may_follow(**s, &said, &line, all, &prefix);
            let Some(symbol) = order.iter().find(fits).copied() else {
                break;
            };
            // (what the look of the network rests on belongs to the act that is being said)
            if let Some(act) = acts.last_mut() {
                act.0 = act.0.min(f64::from(p[symbol]));
                let most = look.iter().skip(1).enumerate().max_by(|a, b| a.1.total_cmp(b.1));
                act.1.extend(most.map(|(i, _)| i));
            }
            if symbol == symbols::END {
                break;
            }
            if self.symbols.name(symbol) == ";" {
                acts.push((1.0, Vec::new()));
            }
            said.push(symbol);
            line = self.symbols.line(&said, all);
            prefix = notation::prefix(&line);
        }
        // (a reading that ran out of room ends with its last whole act)
        let mut reading = notation::parse(&line).unwrap_or_default();
        if reading.acts.is_empty()
            && let Some((whole, _)) = line.rsplit_once(" ; ")
        {
            reading = notation::parse(whole).unwrap_or_default();
        }
        for (act, (p, at)) in reading.acts.iter_mut().zip(&acts) {
            act.confidence = p.clamp(0.0, 1.0);
            let spans = at.iter().filter_map(|i| all.get(*i)).map(|t| t.span);
            act.span = spans.reduce(Span::to);
        }
        reading
    }
}

/// Where the parts of a text end: one part if it is short, else sentences, as many together as fit.
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
