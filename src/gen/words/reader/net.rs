//! The reader's network: transformer with relative position bias, pointer-generator output. Vaswani et al. 2017 (arXiv
//! 1706.03762), Raffel et al. 2020 (arXiv 1910.10683), See et al. 2017 (arXiv 1704.04368).

use serde::Deserialize;

use super::super::lexicon::Lexicon;
use super::symbols::{GRAMS, Input, MOST_NUMBERS};
use nn::kernels;
use nn::layers::{Linear, Norm};
use nn::weights::{WeightFile, WeightsError};

/// Farthest position in either direction that has a bias of its own.
const NEAR: usize = 24;
/// Buckets of values.
const VALUES: usize = 34;

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NetConfig {
    words: usize,
    width: usize,
    heads: usize,
    inner: usize,
    encoder: usize,
    decoder: usize,
}

impl NetConfig {
    pub(super) fn check(&self, words: usize) -> Result<(), String> {
        if self.words != words + 3 {
            return Err(format!("words: expected {}, found {}", words + 3, self.words));
        }
        let sane = (1..=1024).contains(&self.width)
            && (1..=8192).contains(&self.inner)
            && (1..=32).contains(&self.encoder)
            && (1..=32).contains(&self.decoder);
        if !sane || self.heads == 0 || !self.width.is_multiple_of(self.heads) {
            return Err(format!("sizes that no reader has: {self:?}"));
        }
        Ok(())
    }
}

struct Attention {
    q: Linear,
    k: Linear,
    v: Linear,
    o: Linear,
    bias: Vec<f32>, // [heads][2 NEAR + 1]; empty where position does not matter
}

impl Attention {
    fn new(w: &mut WeightFile<'_>, name: &str, c: &NetConfig, near: bool) -> Result<Self, WeightsError> {
        let mut linear =
            |part: &str| Linear::without_bias(w, &format!("{name}.{part}"), c.width, c.width, &[]);
        let (q, k, v, o) = (linear("q")?, linear("k")?, linear("v")?, linear("o")?);
        let bias = match near {
            true => w.take(&format!("{name}.bias"), &[c.heads, 2 * NEAR + 1])?,
            false => Vec::new(),
        };
        Ok(Self { q, k, v, o, bias })
    }

    /// Attention of one query row, at position `at`, over the keys and values of all rows. Adds the output to `x`, and
    /// the attention, mean over heads, to `attention`.
    fn attend(
        &self,
        heads: usize,
        query: &[f32],
        [keys, values]: [&[f32]; 2],
        at: usize,
        x: &mut [f32],
        mut attention: Option<&mut [f32]>,
    ) {
        let width = query.len();
        let (rows, size) = (keys.len() / width, width / heads);
        let q = self.q.vector(query);
        let mut mixed = vec![0.0f32; width];
        let mut scores = vec![0.0f32; rows];
        let scale = 1.0 / (size as f32).sqrt();
        for h in 0..heads {
            let part = h * size..(h + 1) * size;
            let q = &q[part.clone()];
            let mut most = f32::NEG_INFINITY;
            for (j, s) in scores.iter_mut().enumerate() {
                let k = &keys[j * width..][part.clone()];
                let dot: f32 = q.iter().zip(k).map(|(a, b)| a * b).sum();
                *s = dot * scale;
                if !self.bias.is_empty() {
                    let d = (j as isize - at as isize).clamp(-(NEAR as isize), NEAR as isize);
                    *s += self.bias[h * (2 * NEAR + 1) + (d + NEAR as isize) as usize];
                }
                most = most.max(*s);
            }
            let mut sum = 0.0;
            for s in &mut scores {
                *s = kernels::exp(*s - most);
                sum += *s;
            }
            for (j, s) in scores.iter().enumerate() {
                let p = s / sum;
                if let Some(attention) = attention.as_deref_mut() {
                    attention[j] += p / heads as f32;
                }
                let v = &values[j * width..][part.clone()];
                mixed[part.clone()]
                    .iter_mut()
                    .zip(v)
                    .for_each(|(m, v)| *m += p * v);
            }
        }
        x.iter_mut().zip(self.o.vector(&mixed)).for_each(|(x, y)| *x += y);
    }
}

struct ReaderLayer {
    norm: Norm,
    attention: Attention,
    cross: Option<(Norm, Attention)>,
    inner_norm: Norm,
    up: Linear,
    down: Linear,
}

impl ReaderLayer {
    fn new(w: &mut WeightFile<'_>, name: &str, c: &NetConfig, cross: bool) -> Result<Self, WeightsError> {
        let n = |part: &str| format!("{name}.{part}");
        Ok(Self {
            norm: Norm::new(w, &n("norm"), c.width)?,
            attention: Attention::new(w, &n("attention"), c, true)?,
            cross: match cross {
                true => Some((
                    Norm::new(w, &n("cross_norm"), c.width)?,
                    Attention::new(w, &n("cross"), c, false)?,
                )),
                false => None,
            },
            inner_norm: Norm::new(w, &n("inner_norm"), c.width)?,
            up: Linear::new(w, &n("up"), c.width, c.inner, &[])?,
            down: Linear::new(w, &n("down"), c.inner, c.width, &[])?,
        })
    }

    fn through_inner(&self, x: &mut [f32], width: usize) {
        let rows = x.len() / width;
        let mut y = vec![0.0; x.len()];
        self.inner_norm.rows(x, &mut y);
        let mut hidden = vec![0.0; rows * self.up_outputs()];
        self.up.rows(&y, &mut hidden);
        kernels::gelu_all(&mut hidden);
        self.down.rows(&hidden, &mut y);
        x.iter_mut().zip(&y).for_each(|(x, y)| *x += y);
    }

    fn up_outputs(&self) -> usize {
        self.up.outputs()
    }
}

/// The encoded text, which the decoder attends to.
pub(super) struct EncodedText {
    rows: Vec<f32>,
    #[cfg(test)]
    places: usize,
    keys: Vec<Vec<f32>>,   // per decoder layer
    values: Vec<Vec<f32>>, // per decoder layer
}

#[cfg(test)]
impl EncodedText {
    /// The first number of every row.
    pub(super) fn first_numbers(&self) -> impl Iterator<Item = f32> {
        let width = self.rows.len() / self.places;
        self.rows.chunks_exact(width).map(|r| r[0])
    }
}

/// State of the decoder after the symbols so far.
#[derive(Clone)]
pub(super) struct DecoderState {
    keys: Vec<Vec<f32>>,
    values: Vec<Vec<f32>>,
    at: usize,
}

impl DecoderState {
    /// Goes back to the state after `said` symbols, to continue differently.
    pub(super) fn back_to(&mut self, said: usize, net: &Net) {
        let most = said * net.c.width;
        self.keys
            .iter_mut()
            .chain(&mut self.values)
            .for_each(|rows| rows.truncate(most));
        self.at = self.at.min(said);
    }
}

/// The network.
pub(super) struct Net {
    c: NetConfig,
    word: Vec<f32>,
    gram: Vec<f32>,
    sense: Vec<f32>,
    value: Vec<f32>,
    pointer: Vec<f32>,
    encoder: Vec<ReaderLayer>,
    encoder_norm: Norm,
    symbol: Vec<f32>,
    decoder: Vec<ReaderLayer>,
    decoder_norm: Norm,
    say: Linear,
    copy_sense: Linear,
    copy_number: Linear,
    symbols: usize,
}

impl Net {
    pub(super) fn new(w: &mut WeightFile<'_>, c: NetConfig) -> Result<Self, WeightsError> {
        let names: Vec<String> = w.config("symbols")?;
        let (width, symbols) = (c.width, names.len());
        let layers = |w: &mut WeightFile<'_>,
                      part: &str,
                      n: usize,
                      cross: bool|
         -> Result<Vec<ReaderLayer>, WeightsError> {
            (0..n)
                .map(|i| ReaderLayer::new(w, &format!("{part}.{i}"), &c, cross))
                .collect()
        };
        Ok(Self {
            word: w.take("word.weight", &[c.words, width])?,
            gram: w.take("gram.weight", &[GRAMS, width])?,
            sense: w.take("sense.weight", &[Lexicon::bundled().len() + 1, width])?,
            value: w.take("value.weight", &[VALUES, width])?,
            pointer: w.take("pointer.weight", &[MOST_NUMBERS + 1, width])?,
            encoder: layers(w, "encoder", c.encoder, false)?,
            encoder_norm: Norm::new(w, "encoder_norm", width)?,
            symbol: w.take("symbol.weight", &[symbols + 1, width])?,
            decoder: layers(w, "decoder", c.decoder, true)?,
            decoder_norm: Norm::new(w, "decoder_norm", width)?,
            say: Linear::new(w, "say", width, symbols, &[])?,
            copy_sense: Linear::without_bias(w, "copy_sense", width, width, &[])?,
            copy_number: Linear::without_bias(w, "copy_number", width, width, &[])?,
            symbols,
            c,
        })
    }

    fn embed(&self, x: &Input) -> Vec<f32> {
        let width = self.c.width;
        let mut out = vec![0.0f32; x.words.len() * width];
        let add = |row: &mut [f32], table: &[f32], id: usize, scale: f32| {
            row.iter_mut()
                .zip(&table[id * width..][..width])
                .for_each(|(r, t)| *r += t * scale);
        };
        for (i, row) in out.chunks_exact_mut(width).enumerate() {
            add(row, &self.word, x.words[i], 1.0);
            add(row, &self.value, x.values[i], 1.0);
            add(row, &self.pointer, x.pointers[i], 1.0);
            for g in &x.grams[i] {
                add(row, &self.gram, *g, 1.0 / x.grams[i].len() as f32);
            }
            x.senses[i].iter().for_each(|s| add(row, &self.sense, *s, 1.0));
        }
        out
    }

    pub(super) fn encode(&self, input: &Input) -> EncodedText {
        let width = self.c.width;
        let mut x = self.embed(input);
        let mut y = vec![0.0; x.len()];
        let (mut k, mut v) = (y.clone(), y.clone());
        for layer in &self.encoder {
            layer.norm.rows(&x, &mut y);
            layer.attention.k.rows(&y, &mut k);
            layer.attention.v.rows(&y, &mut v);
            for (i, (row, query)) in x.chunks_exact_mut(width).zip(y.chunks_exact(width)).enumerate() {
                layer
                    .attention
                    .attend(self.c.heads, query, [&k, &v], i, row, None);
            }
            layer.through_inner(&mut x, width);
        }
        let mut rows = vec![0.0; x.len()];
        self.encoder_norm.rows(&x, &mut rows);
        let of = |pick: fn(&Attention) -> &Linear| -> Vec<Vec<f32>> {
            let cross = self.decoder.iter().filter_map(|l| l.cross.as_ref());
            cross
                .map(|(_, a)| {
                    let mut out = vec![0.0; rows.len()];
                    pick(a).rows(&rows, &mut out);
                    out
                })
                .collect()
        };
        let (keys, values) = (of(|a| &a.k), of(|a| &a.v));
        EncodedText {
            #[cfg(test)]
            places: input.words.len(),
            rows,
            keys,
            values,
        }
    }

    pub(super) fn begin(&self) -> DecoderState {
        DecoderState {
            keys: vec![Vec::new(); self.decoder.len()],
            values: vec![Vec::new(); self.decoder.len()],
            at: 0,
        }
    }

    /// Probabilities of the symbols after `last` (`None`: of the first symbol), and the attention on each token.
    pub(super) fn next(
        &self,
        state: &mut DecoderState,
        memory: &EncodedText,
        last: Option<usize>,
        input: &Input,
    ) -> (Vec<f32>, Vec<f32>) {
        let width = self.c.width;
        let tokens = memory.rows.len() / width;
        let id = last.unwrap_or(self.symbols);
        let mut x = self.symbol[id * width..][..width].to_vec();
        let mut y = vec![0.0; width];
        let mut attention = vec![0.0f32; tokens];
        for (i, layer) in self.decoder.iter().enumerate() {
            layer.norm.rows(&x, &mut y);
            state.keys[i].extend(layer.attention.k.vector(&y));
            state.values[i].extend(layer.attention.v.vector(&y));
            layer.attention.attend(
                self.c.heads,
                &y,
                [&state.keys[i], &state.values[i]],
                state.at,
                &mut x,
                None,
            );
            if let Some((norm, cross)) = &layer.cross {
                norm.rows(&x, &mut y);
                let last = i + 1 == self.decoder.len();
                cross.attend(
                    self.c.heads,
                    &y,
                    [&memory.keys[i], &memory.values[i]],
                    0,
                    &mut x,
                    last.then_some(&mut attention[..]),
                );
            }
            layer.through_inner(&mut x, width);
        }
        state.at += 1;
        self.decoder_norm.rows(&x, &mut y);
        let mut logits = self.say.vector(&y);
        let scale = (width as f32).powf(-0.5);
        let point = |linear: &Linear, copies: &[Option<usize>]| -> Vec<f32> {
            let q = linear.vector(&y);
            let rows = memory.rows.chunks_exact(width).zip(copies);
            rows.map(|(row, copy)| match copy {
                Some(_) => row.iter().zip(&q).map(|(a, b)| a * b).sum::<f32>() * scale,
                None => f32::NEG_INFINITY,
            })
            .collect()
        };
        logits.extend(point(&self.copy_sense, &input.copy_sense));
        logits.extend(point(&self.copy_number, &input.copy_number));
        let most = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let mut sum = 0.0;
        for l in &mut logits {
            *l = if l.is_finite() {
                kernels::exp(*l - most)
            } else {
                0.0
            };
            sum += *l;
        }
        logits.iter_mut().for_each(|l| *l /= sum);
        let copied = logits.split_off(self.symbols);
        for (k, copies) in [&input.copy_sense, &input.copy_number].into_iter().enumerate() {
            for (i, copy) in copies.iter().enumerate() {
                if let Some(s) = copy {
                    let p = copied[k * tokens + i];
                    logits[*s] += p;
                    // (a copied token counts as attended to)
                    attention[i] = attention[i].max(p);
                }
            }
        }
        (logits, attention)
    }
}
