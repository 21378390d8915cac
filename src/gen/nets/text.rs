//! The text encoder: hashed word and letter n-grams to a unit vector; near vectors mean like scenes. Trained by contrast
//! (InfoNCE) on sentences about the same and other scenes. Twin of training/models/text.py.

use std::sync::{Arc, OnceLock};

use serde::Deserialize;

use nn::ops::OpsError;
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Ops};
use numeric::hash::fnv1a_32;

/// File name of the weights.
pub const FILE: &str = "text.safetensors";
/// Most n-grams of a text that are read.
pub const TOKENS: usize = 192;
/// Rows of the embedding table.
pub const BUCKETS: usize = 4096;
/// Letters of a text that are read: the rest cannot reach [`TOKENS`].
const LETTERS: usize = 2000;

/// FNV-1a of the bytes of a text.
pub fn hash(text: &str) -> u32 {
    fnv1a_32(text.as_bytes())
}

/// Hashed n-grams of a text: words, pairs of neighbouring words, and triples of letters within words; lower case, letters
/// and digits only, at most [`TOKENS`], the words first.
pub fn token_ids(text: &str) -> Vec<u32> {
    let text: String = text.chars().take(LETTERS).flat_map(char::to_lowercase).collect();
    let words: Vec<&str> = text
        .split(|c: char| !c.is_alphanumeric())
        .filter(|w| !w.is_empty())
        .collect();
    let mut grams: Vec<String> = words.iter().map(|w| format!("w:{w}")).collect();
    grams.extend(words.windows(2).map(|w| format!("p:{} {}", w[0], w[1])));
    for word in &words {
        let letters: Vec<char> = std::iter::once('<')
            .chain(word.chars())
            .chain(std::iter::once('>'))
            .collect();
        grams.extend(letters.windows(3).map(|l| l.iter().collect::<String>()));
    }
    grams.truncate(TOKENS);
    let folded = |s: &String| {
        let h = hash(s);
        (h ^ (h >> 15)) % BUCKETS as u32
    };
    grams.iter().map(folded).collect()
}

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextConfig {
    /// Numbers of a vector.
    pub width: usize,
    /// Rows of the table; [`BUCKETS`].
    pub buckets: usize,
}

/// The network, on a backend.
pub struct TextEncoder<B: Ops = Cpu> {
    ops: B,
    width: usize,
    table: B::Table,
    first: B::Linear,
    second: B::Linear,
}

impl TextEncoder {
    /// The weights that ship with the program; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static ENCODER: OnceLock<Arc<TextEncoder>> = OnceLock::new();
        if let Some(encoder) = ENCODER.get() {
            return Ok(encoder.clone());
        }
        let bytes = assets::weights::TEXT;
        let encoder = Self::new(WeightFile::parse(FILE, bytes)?)?;
        Ok(ENCODER.get_or_init(|| Arc::new(encoder)).clone())
    }

    /// Loads the encoder onto the processor. Takes all tensors of the file.
    pub fn new(w: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, w)
    }
}

impl<B: Ops> TextEncoder<B> {
    /// Loads the encoder onto a backend; otherwise as [`TextEncoder::new`].
    pub fn on(ops: B, mut w: WeightFile<'_>) -> Result<Self, WeightsError> {
        let c: TextConfig = w.config("config")?;
        if c.buckets != BUCKETS || !(1..=1024).contains(&c.width) {
            let reason = format!(
                "expected {BUCKETS} buckets and a width up to 1024, found {} and {}",
                c.buckets, c.width
            );
            return Err(w.config_error("config", reason));
        }
        let table = ops.table_from(w.take("table.weight", &[BUCKETS, c.width])?, c.width);
        let out = Self {
            width: c.width,
            table: table.map_err(|e| w.backend_error(e))?,
            first: ops.linear(&mut w, "first", [c.width, c.width], &[])?,
            second: ops.linear(&mut w, "second", [c.width, c.width], &[])?,
            ops,
        };
        w.finish()?;
        Ok(out)
    }

    /// Unit vector of a text; zeros for a text without words. Errors if the backend cannot compute.
    pub fn encode(&self, text: &str) -> Result<Vec<f32>, OpsError> {
        let (ops, ids) = (&self.ops, token_ids(text));
        let nothing = vec![0.0; self.width];
        if ids.is_empty() {
            return Ok(nothing);
        }
        let entries = |_, _| ids.iter().map(|id| *id as usize);
        let sum = ops.bag(&self.table, ops.vector(nothing)?, entries)?;
        let mut sum = ops.download(sum)?.data;
        let scale = 1.0 / (ids.len() as f32).sqrt();
        sum.iter_mut().for_each(|s| *s *= scale);
        let sum = ops.vector(sum)?;
        let hidden = ops.tanh(ops.apply(&self.first, &sum, 1)?)?;
        let out = ops.add(ops.apply(&self.second, &hidden, 1)?, &sum)?;
        let mut out = ops.download(out)?.data;
        let norm = out.iter().map(|v| v * v).sum::<f32>().sqrt().max(1e-12);
        out.iter_mut().for_each(|v| *v /= norm);
        Ok(out)
    }
}

/// Cosine of two unit vectors.
pub fn cosine(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_grams_ignore_case_and_signs_and_bear_anything() {
        assert_eq!(token_ids("Two BUSES, wait!"), token_ids("two buses wait"));
        assert_ne!(token_ids("two buses"), token_ids("two cars"));
        assert!(token_ids("").is_empty() && token_ids("🚗 !?").is_empty());
        assert!(!token_ids("два автобуса").is_empty());
        assert_eq!(token_ids(&"word ".repeat(10_000)).len(), TOKENS);
        assert!(
            token_ids("long words everywhere")
                .iter()
                .all(|id| (*id as usize) < BUCKETS)
        );
    }
}
