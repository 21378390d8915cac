//! Latent diffusion transformer for occupancy: predicts v from a noisy latent, a timestep and a
//! condition (mask, context, draft, layout). adaLN-Zero blocks of Peebles and Xie, arXiv 2212.09748,
//! over 625 tokens of 2x2 cells, with a depthwise convolution over the values (LePE, arXiv 2107.00652).
//! Twin of `training/models/occ_dit.py`.

use rayon::prelude::*;
use serde::Deserialize;

use super::column_heights::{ColumnHeights, GROUPS};
use super::{CELLS, CHANNELS, LATENT, ModelError, SIDE, check_finite, check_length};
use nn::Precision;
use nn::int8_attention::Int8Head;
use nn::kernels;
use nn::layers::{Head, Linear, NORM_EPS};
use nn::weights::{WeightFile, WeightsError};
use scene::GridSpec;
use scene::raster::HEADINGS;

const PATCH: usize = 2;
const TOKENS_PER_SIDE: usize = SIDE / PATCH;
pub(super) const TOKENS: usize = TOKENS_PER_SIDE * TOKENS_PER_SIDE;
const PATCH_CELLS: usize = PATCH * PATCH;
const COLUMNS: usize = GridSpec::NX / SIDE;
const LAYERS: usize = 18;
/// Layout channels of a cell: one per column and layer, `(dx * 4 + dy) * 18 + layer`.
const LAYOUT: usize = COLUMNS * COLUMNS * LAYERS;
/// Mean cosine and sine of headings in a cell.
const HEADING: usize = 2;
/// Columns of a cell.
const CELL_COLUMNS: usize = COLUMNS * COLUMNS;
/// Of a group of the background in a cell: mask, base and top in each column.
const STANDING: usize = 3 * CELL_COLUMNS;
/// Mask, context, draft, layout, heading; whether the groups of the background are given, and what they are; whether the
/// ground's height is given, and that in each column.
const CONDITION: usize = 1 + 2 * CHANNELS + LAYOUT + HEADING + GROUPS + GROUPS * STANDING + 1 + CELL_COLUMNS;
/// Numbers given by name.
const NAMED: usize = 4;
/// Neighbours that a value is mixed with, itself among them.
const NEAR: usize = 9;
/// Most tokens that are worked on in one piece.
const PIECE: usize = 80;
/// Fewest: small sets are spread over the cores too.
const SMALL_PIECE: usize = 16;

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DitConfig {
    /// Numbers per latent cell; 8.
    pub latent: usize,
    /// Channels of a token.
    pub width: usize,
    /// Blocks.
    pub depth: usize,
    /// Attention heads.
    pub heads: usize,
    /// Numbers of the timestep embedding.
    pub frequencies: usize,
    /// Blocks convolve their values.
    pub local: bool,
}

impl DitConfig {
    fn check(&self) -> Result<(), String> {
        if self.latent != CHANNELS {
            Err(format!("latent: expected {CHANNELS}, found {}", self.latent))
        } else if !(1..=4096).contains(&self.width) || !self.width.is_multiple_of(4) {
            Err(format!(
                "width: expected a multiple of 4 up to 4096, found {}",
                self.width
            ))
        } else if !(1..=256).contains(&self.depth) {
            Err(format!("depth: expected 1 to 256, found {}", self.depth))
        } else if self.heads == 0 || !self.width.is_multiple_of(self.heads) {
            Err(format!(
                "heads: expected a divisor of {}, found {}",
                self.width, self.heads
            ))
        } else if !(2..=4096).contains(&self.frequencies) || !self.frequencies.is_multiple_of(2) {
            Err(format!(
                "frequencies: expected an even number up to 4096, found {}",
                self.frequencies
            ))
        } else {
            Ok(())
        }
    }
}

/// What a scene is generated from.
#[derive(Clone, Debug, PartialEq)]
pub struct DitCondition {
    /// Bits of the 18 layers, `[x][y]`, 200x200.
    pub bev: Vec<u32>,
    /// Headings of objects as [`headings`](scene::raster::headings) gives them, `[x][y]`, 200x200.
    pub heading: Vec<u8>,
    /// Vegetation, building, clutter, completeness where they are given (`Density`), 0 to 1.
    pub named: [Option<f32>; NAMED],
    /// Latent of the layout extruded naively, with the background where it is given, 50x50x8.
    pub draft_latent: Vec<f32>,
    /// Per group of the background: 1 where `columns` holds it and nothing else of it is to stand there, 0 where the network
    /// invents it, 50x50. Where both are 1 the draft holds them too.
    pub given: Vec<[f32; GROUPS]>,
    /// Background and ground of each column, 200x200.
    pub columns: Vec<ColumnHeights>,
    /// The ground's height is given.
    pub ground: bool,
    /// 1 where a cell is to be generated, 0 where it is kept, 50x50.
    pub mask: Vec<f32>,
    /// Latent of what is kept, 50x50x8; 0 where the mask is 1.
    pub context: Vec<f32>,
}

/// What of a condition depends on neither state nor time, for some of the tokens.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// Which tokens, in rising order.
    tokens: Vec<usize>,
    /// `[token][width]`.
    embedded: Vec<f32>,
    /// Draft latent, 50x50x8.
    draft: Vec<f32>,
    /// Where all of the background is given, 50x50.
    given: Vec<f32>,
    /// What the named numbers add to the embedded time, `[width]`.
    named: Vec<f32>,
}

impl Prepared {
    /// Number of tokens that are computed.
    pub fn tokens(&self) -> usize {
        self.tokens.len()
    }
}

/// Keys and values of every token in every block at one state: what tokens that are not computed show to
/// those that are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeysValues(Vec<Vec<f32>>); // [block][token][keys | values]

impl KeysValues {
    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.0.iter().map(|block| 4 * block.len()).sum()
    }
}

/// The tokens that hold a cell of the mask, and those up to `halo` tokens around them, in rising order.
pub fn tokens_of(cells: &[bool], halo: usize) -> Vec<usize> {
    let mut wanted = vec![false; TOKENS];
    for token in (0..TOKENS).filter(|token| patch(*token).any(|c| cells[c])) {
        let (x, y) = (token / TOKENS_PER_SIDE, token % TOKENS_PER_SIDE);
        let last = TOKENS_PER_SIDE - 1;
        for x in x.saturating_sub(halo)..=(x + halo).min(last) {
            for y in y.saturating_sub(halo)..=(y + halo).min(last) {
                wanted[x * TOKENS_PER_SIDE + y] = true;
            }
        }
    }
    (0..TOKENS).filter(|token| wanted[*token]).collect()
}

/// What becomes of the blocks between the first and the last: what they add to the tokens changes slowly from one
/// step to the next (Delta-DiT, 2406.01125).
pub enum Middle<'a> {
    /// They are computed.
    Computed,
    /// They are computed, and what they added is kept here.
    Kept(&'a mut Vec<f32>),
    /// What they added at an earlier step is added again; they are computed if that is of other tokens.
    Reused(&'a [f32]),
}

enum AnyHead<'a> {
    F32(Head<'a>),
    Int8(Int8Head),
}

struct Block {
    ada: Linear,
    qkv: Linear,
    proj: Linear,
    fc1: Linear,
    fc2: Linear,
    local: Option<Local>,
}

/// A depthwise 3x3 convolution over the map of tokens.
struct Local {
    weight: Vec<f32>, // [neighbour][width]
    bias: Vec<f32>,
}

/// The network with its weights.
pub struct OccDit {
    config: DitConfig,
    embed_x: Linear,
    embed_condition: Linear,
    time1: Linear,
    time2: Linear,
    named1: Linear,
    named2: Linear,
    blocks: Vec<Block>,
    final_ada: Linear,
    last: Linear,
    /// Gates of the noisy latent and of the draft per channel: the linear part of the answer.
    skip: Linear,
    /// What is added to them where the background is given.
    skip_given: Linear,
    positions: Vec<f32>, // [token][width]
}

impl OccDit {
    /// Takes all tensors of the file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn new(mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: DitConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (w, width) = (&mut file, config.width);
        let block = |w: &mut WeightFile<'_>, i: usize| {
            let local = match config.local {
                true => Some(Local::new(w, &format!("blocks.{i}.local"), width)?),
                false => None,
            };
            let mut linear = |name: &str, inputs, outputs| {
                Linear::new(w, &format!("blocks.{i}.{name}"), inputs, outputs, &[])
            };
            Ok(Block {
                local,
                ada: linear("ada", width, 6 * width)?,
                qkv: linear("qkv", width, 3 * width)?,
                proj: linear("proj", width, width)?,
                fc1: linear("fc1", width, 4 * width)?,
                fc2: linear("fc2", 4 * width, width)?,
            })
        };
        let dit = Self {
            embed_x: Linear::new(w, "embed_x", PATCH_CELLS * CHANNELS, width, &[])?,
            embed_condition: Linear::without_bias(w, "embed_condition", PATCH_CELLS * CONDITION, width, &[])?,
            time1: Linear::new(w, "time1", config.frequencies, width, &[])?,
            time2: Linear::new(w, "time2", width, width, &[])?,
            named1: Linear::new(w, "named1", 2 * NAMED + 1, width, &[])?,
            named2: Linear::new(w, "named2", width, width, &[])?,
            blocks: (0..config.depth)
                .map(|i| block(w, i))
                .collect::<Result<_, WeightsError>>()?,
            final_ada: Linear::new(w, "final_ada", width, 2 * width, &[])?,
            last: Linear::new(w, "final", width, PATCH_CELLS * CHANNELS, &[])?,
            skip: Linear::new(w, "skip", width, 2 * CHANNELS, &[])?,
            skip_given: Linear::new(w, "skip_given", width, 2 * CHANNELS, &[])?,
            positions: positions(TOKENS_PER_SIDE, TOKENS_PER_SIDE, width),
            config,
        };
        file.finish()?;
        Ok(dit)
    }

    /// Sizes of the network.
    pub fn config(&self) -> &DitConfig {
        &self.config
    }

    /// The condition without all that is asked for, for guidance: what training shows one time in fourteen.
    pub fn null_condition(&self, condition: &DitCondition) -> DitCondition {
        DitCondition {
            bev: vec![0; condition.bev.len()],
            heading: vec![0; condition.heading.len()],
            named: [None; NAMED],
            draft_latent: vec![0.0; condition.draft_latent.len()],
            given: vec![[0.0; GROUPS]; condition.given.len()],
            ground: false,
            ..condition.clone()
        }
    }

    /// Embeds a condition for all tokens, once per job.
    pub fn prepare(&self, condition: &DitCondition) -> Result<Prepared, ModelError> {
        self.prepare_some(condition, (0..TOKENS).collect())
    }

    /// The same for some tokens, in rising order: only they are computed.
    pub fn prepare_some(&self, condition: &DitCondition, tokens: Vec<usize>) -> Result<Prepared, ModelError> {
        check_length("layout", condition.bev.len(), GridSpec::COLUMNS)?;
        check_length("headings", condition.heading.len(), GridSpec::COLUMNS)?;
        check_finite("named numbers", &condition.named.map(|n| n.unwrap_or(0.0)))?;
        check_length("draft latent", condition.draft_latent.len(), LATENT)?;
        check_length("given background", condition.given.len(), CELLS)?;
        check_finite("given background", condition.given.as_flattened())?;
        check_length("columns", condition.columns.len(), GridSpec::COLUMNS)?;
        check_length("mask", condition.mask.len(), CELLS)?;
        check_length("context", condition.context.len(), LATENT)?;
        check_finite("draft latent", &condition.draft_latent)?;
        check_finite("mask", &condition.mask)?;
        check_finite("context", &condition.context)?;
        let row = PATCH_CELLS * CONDITION;
        let mut features = vec![0.0; tokens.len() * row];
        features
            .par_chunks_mut(row)
            .zip(&tokens)
            .for_each(|(values, token)| {
                for (cell, values) in patch(*token).zip(values.chunks_exact_mut(CONDITION)) {
                    condition.cell_features(cell, values);
                }
            });
        let mut embedded = self.embed_condition.parallel(&features, piece_of(tokens.len()));
        let width = self.config.width;
        for (row, token) in embedded.chunks_exact_mut(width).zip(&tokens) {
            let position = &self.positions[token * width..][..width];
            row.iter_mut().zip(position).for_each(|(e, p)| *e += p);
        }
        let told = condition.named.map(|n| f32::from(u8::from(n.is_some())));
        let values = condition.named.map(|n| n.unwrap_or(0.0));
        let drafted = f32::from(u8::from(condition.draft_latent.iter().any(|v| *v != 0.0)));
        let mut named = self.named1.vector(&[&values[..], &told[..], &[drafted]].concat());
        named.iter_mut().for_each(|v| *v = kernels::silu(*v));
        Ok(Prepared {
            tokens,
            embedded,
            draft: condition.draft_latent.clone(),
            given: condition.given.iter().map(|g| g.iter().product()).collect(),
            named: self.named2.vector(&named),
        })
    }

    /// v for the state `x` (50x50x8) at training step `t` (0 to 999, fractions allowed), for all tokens.
    pub fn forward(&self, x: &[f32], t: f32, condition: &Prepared) -> Result<Vec<f32>, ModelError> {
        check_length("tokens", condition.tokens.len(), TOKENS)?;
        self.forward_some(x, t, condition, &mut KeysValues::default())
    }

    /// v at the tokens of `condition`, 0 elsewhere. The other tokens are seen through `keys_values`, where
    /// the computed tokens leave theirs; if it is empty, all tokens must be computed, and it is filled.
    pub fn forward_some(
        &self,
        x: &[f32],
        t: f32,
        condition: &Prepared,
        keys_values: &mut KeysValues,
    ) -> Result<Vec<f32>, ModelError> {
        self.forward_in(x, t, condition, keys_values, Precision::F32, Middle::Computed)
    }

    /// The same with the blocks' products in the precision asked for, and the middle blocks computed or not.
    pub fn forward_in(
        &self,
        x: &[f32],
        t: f32,
        condition: &Prepared,
        keys_values: &mut KeysValues,
        precision: Precision,
        mut middle: Middle<'_>,
    ) -> Result<Vec<f32>, ModelError> {
        check_length("state", x.len(), LATENT)?;
        check_finite("state", x)?;
        if !(0.0..1000.0).contains(&t) {
            return Err(ModelError::Timestep(t));
        }
        let (width, places) = (self.config.width, &condition.tokens);
        check_length("condition", condition.embedded.len(), places.len() * width)?;
        if keys_values.0.is_empty() {
            check_length("tokens", places.len(), TOKENS)?;
            keys_values.0 = vec![vec![0.0; TOKENS * 2 * width]; self.blocks.len()];
        }
        check_length("keys and values", keys_values.0.len(), self.blocks.len())?;
        check_length("keys and values", keys_values.0[0].len(), TOKENS * 2 * width)?;
        let mut time = self.time1.vector(&timestep_embedding(t, self.config.frequencies));
        time.iter_mut().for_each(|v| *v = kernels::silu(*v));
        let mut time = self.time2.vector(&time);
        for (t, named) in time.iter_mut().zip(&condition.named) {
            *t = kernels::silu(*t + named);
        }

        let cells = || places.iter().flat_map(|token| patch(*token));
        let patches: Vec<f32> = cells()
            .flat_map(|cell| &x[cell * CHANNELS..][..CHANNELS])
            .copied()
            .collect();
        let piece = piece_of(places.len());
        let mut tokens = self.embed_x.parallel(&patches, piece);
        tokens
            .iter_mut()
            .zip(&condition.embedded)
            .for_each(|(t, c)| *t += c);
        let modulations: Vec<Vec<f32>> = self.blocks.par_iter().map(|b| b.ada.vector(&time)).collect();
        let last = self.blocks.len() - 1;
        let mut before = Vec::new();
        for (i, ((block, ada), keys_values)) in self
            .blocks
            .iter()
            .zip(&modulations)
            .zip(&mut keys_values.0)
            .enumerate()
        {
            match &mut middle {
                Middle::Reused(added) if i == 1 && added.len() == tokens.len() && last > 1 => {
                    tokens.iter_mut().zip(&**added).for_each(|(t, a)| *t += a);
                }
                Middle::Kept(_) if i == 1 => before.clone_from(&tokens),
                Middle::Kept(added) if i == last && last > 1 => {
                    added.clear();
                    added.extend(tokens.iter().zip(&before).map(|(t, b)| t - b));
                }
                _ => {}
            }
            let skipped = matches!(&middle, Middle::Reused(added) if added.len() == tokens.len());
            if !skipped || i == 0 || i == last {
                block.apply(
                    &mut tokens,
                    ada,
                    self.config.heads,
                    places,
                    keys_values,
                    precision,
                );
            }
        }
        let ada = self.final_ada.vector(&time);
        let (shift, scale) = ada.split_at(width);
        let scale: Vec<f32> = scale.iter().map(|s| 1.0 + s).collect();
        let mut normed = vec![0.0; tokens.len()];
        kernels::norm_rows(&tokens, NORM_EPS, &scale, shift, &mut normed);
        let patches = self.last.parallel(&normed, piece);
        let gates = self.skip.vector(&time);
        let added = self.skip_given.vector(&time);
        let mut out = vec![0.0; LATENT];
        for (cell, values) in cells().zip(patches.chunks_exact(CHANNELS)) {
            let given = condition.given[cell];
            let gate = |i: usize| gates[i] + given * added[i];
            for (c, value) in values.iter().enumerate() {
                let at = cell * CHANNELS + c;
                out[at] = value + gate(c) * x[at] + gate(CHANNELS + c) * condition.draft[at];
            }
        }
        check_finite("predicted v", &out)?;
        Ok(out)
    }
}

impl DitCondition {
    /// What is said of one cell, in the order of [`CONDITION`].
    fn cell_features(&self, cell: usize, values: &mut [f32]) {
        values[0] = self.mask[cell];
        let of = |latent: &[f32], to: &mut [f32]| to.copy_from_slice(&latent[cell * CHANNELS..][..CHANNELS]);
        of(&self.context, &mut values[1..][..CHANNELS]);
        of(&self.draft_latent, &mut values[1 + CHANNELS..][..CHANNELS]);
        let (layout, rest) = values[1 + 2 * CHANNELS..].split_at_mut(LAYOUT);
        let (heading, rest) = rest.split_at_mut(HEADING);
        let (given, rest) = rest.split_at_mut(GROUPS);
        let (standing, ground) = rest.split_at_mut(GROUPS * STANDING);
        given.copy_from_slice(&self.given[cell]);
        ground[0] = f32::from(u8::from(self.ground));
        let bins = |n: u8| f32::from(n) / GridSpec::NZ as f32;
        let [mut cos_sum, mut sin_sum] = [0.0; 2];
        for (column, layers) in layout.chunks_exact_mut(LAYERS).enumerate() {
            let x = cell / SIDE * COLUMNS + column / COLUMNS;
            let y = cell % SIDE * COLUMNS + column % COLUMNS;
            let bits = self.bev[x * GridSpec::NY + y];
            for (layer, value) in layers.iter_mut().enumerate() {
                *value = (bits >> layer & 1) as f32;
            }
            let heights = &self.columns[x * GridSpec::NY + y];
            for (group, [base, top]) in heights.standing.iter().enumerate() {
                if *top > 0 {
                    let known = given[group];
                    let told = [known, bins(base.saturating_sub(1)) * known, bins(*top) * known];
                    for (number, value) in told.into_iter().enumerate() {
                        standing[group * STANDING + number * CELL_COLUMNS + column] = value;
                    }
                }
            }
            ground[1 + column] = bins(heights.ground) * ground[0];
            let code = self.heading[x * GridSpec::NY + y];
            if code > 0 {
                let angle = f32::from(code - 1) * (std::f32::consts::TAU / f32::from(HEADINGS));
                cos_sum += angle.cos();
                sin_sum += angle.sin();
            }
        }
        let columns = CELL_COLUMNS as f32;
        heading.copy_from_slice(&[cos_sum / columns, sin_sum / columns]);
    }
}

/// Tokens in a piece of work; depends on nothing but their number.
fn piece_of(tokens: usize) -> usize {
    tokens.div_ceil(4).clamp(SMALL_PIECE, PIECE)
}

impl Block {
    /// In place over some tokens of one sequence, which stand at `places` of it. `keys_values` holds those
    /// of the whole sequence; these tokens' own are renewed first. `ada` is shift, scale, gate for
    /// attention, then the same for the MLP.
    fn apply(
        &self,
        tokens: &mut [f32],
        ada: &[f32],
        heads: usize,
        places: &[usize],
        keys_values: &mut [f32],
        precision: Precision,
    ) {
        let width = ada.len() / 6;
        let part = |i: usize| &ada[i * width..][..width];
        let scale = |i: usize| part(i).iter().map(|s| 1.0 + s).collect::<Vec<f32>>();
        let (scale1, scale2) = (scale(1), scale(4));
        let piece_tokens = piece_of(places.len());

        let mut qkv = vec![0.0; places.len() * 3 * width];
        qkv.par_chunks_mut(piece_tokens * 3 * width)
            .zip(tokens.par_chunks(piece_tokens * width))
            .for_each(|(qkv, x)| {
                let mut normed = vec![0.0; x.len()];
                kernels::norm_rows(x, NORM_EPS, &scale1, part(0), &mut normed);
                self.qkv.rows_in(precision, &normed, qkv);
            });
        for (row, place) in qkv.chunks_exact(3 * width).zip(places) {
            keys_values[place * 2 * width..][..2 * width].copy_from_slice(&row[width..]);
        }
        let keys_values = &*keys_values;
        let head_width = width / heads;
        let heads: Vec<AnyHead<'_>> = (0..heads)
            .into_par_iter()
            .map(|h| {
                let (at, stride) = (h * head_width, 2 * width);
                match precision {
                    Precision::F32 => {
                        AnyHead::F32(Head::new(keys_values, stride, head_width, at, width + at))
                    }
                    Precision::Int8 => {
                        AnyHead::Int8(Int8Head::new(keys_values, stride, head_width, at, width + at))
                    }
                }
            })
            .collect();
        let shrink = 1.0 / (head_width as f32).sqrt();
        tokens
            .par_chunks_mut(piece_tokens * width)
            .zip(qkv.par_chunks(piece_tokens * 3 * width))
            .enumerate()
            .for_each(|(piece, (x, qkv))| {
                let mut attended = vec![0.0; x.len()];
                let mut queries = Vec::with_capacity(x.len() / heads.len());
                for (h, head) in heads.iter().enumerate() {
                    let at = h * head_width;
                    queries.clear();
                    for row in qkv.chunks_exact(3 * width) {
                        queries.extend(row[at..][..head_width].iter().map(|q| q * shrink));
                    }
                    match head {
                        AnyHead::F32(head) => head.attend(&queries, &mut attended[at..], width),
                        AnyHead::Int8(head) => head.attend(&queries, &mut attended[at..], width),
                    }
                }
                if let Some(local) = &self.local {
                    let rows = attended.chunks_exact_mut(width);
                    for (row, place) in rows.zip(&places[piece * piece_tokens..]) {
                        local.add_at(*place, keys_values, row);
                    }
                }
                let mut out = vec![0.0; x.len()];
                self.proj.rows_in(precision, &attended, &mut out);
                kernels::add_gated(x, part(2), &out);
                kernels::norm_rows(x, NORM_EPS, &scale2, part(3), &mut attended);
                let mut hidden = vec![0.0; 4 * x.len()];
                self.fc1.rows_in(precision, &attended, &mut hidden);
                match precision {
                    Precision::F32 => kernels::gelu_all(&mut hidden),
                    Precision::Int8 => kernels::gelu_all_roughly(&mut hidden),
                }
                self.fc2.rows_in(precision, &hidden, &mut out);
                kernels::add_gated(x, part(5), &out);
            });
    }
}

impl Local {
    fn new(w: &mut WeightFile<'_>, name: &str, width: usize) -> Result<Self, WeightsError> {
        let weight = w.take(&format!("{name}.weight"), &[width, 1, 3, 3])?;
        Ok(Self {
            weight: (0..NEAR * width)
                .map(|i| weight[i % width * NEAR + i / width])
                .collect(),
            bias: w.take(&format!("{name}.bias"), &[width])?,
        })
    }

    /// Adds to `row` what the values around the token at `place` give; beyond the map there is nothing.
    fn add_at(&self, place: usize, keys_values: &[f32], row: &mut [f32]) {
        let width = row.len();
        row.iter_mut().zip(&self.bias).for_each(|(r, b)| *r += b);
        let [x, y] = [place / TOKENS_PER_SIDE, place % TOKENS_PER_SIDE];
        for (near, weight) in self.weight.chunks_exact(width).enumerate() {
            let (x, y) = (x + near / 3, y + near % 3); // one too far each
            if (1..=TOKENS_PER_SIDE).contains(&x) && (1..=TOKENS_PER_SIDE).contains(&y) {
                let token = (x - 1) * TOKENS_PER_SIDE + y - 1;
                let values = &keys_values[(2 * token + 1) * width..][..width];
                for ((r, v), w) in row.iter_mut().zip(values).zip(weight) {
                    *r += v * w;
                }
            }
        }
    }
}

/// The four cells of a token, in the order of its channels.
fn patch(token: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (token / TOKENS_PER_SIDE * PATCH, token % TOKENS_PER_SIDE * PATCH);
    (0..PATCH_CELLS).map(move |i| (x + i / PATCH) * SIDE + y + i % PATCH)
}

/// Fixed positions, `[rows * columns][width]`: the first half of the channels encodes the column, the
/// second half the row, each as [sin | cos] of pos / 10000^(i / (width / 4)).
fn positions(rows: usize, columns: usize, width: usize) -> Vec<f32> {
    let quarter = width / 4;
    let mut out = Vec::with_capacity(rows * columns * width);
    for token in 0..rows * columns {
        for pos in [token % columns, token / columns] {
            let angle = |i: usize| pos as f64 / 10000f64.powf(i as f64 / quarter as f64);
            out.extend((0..quarter).map(|i| angle(i).sin() as f32));
            out.extend((0..quarter).map(|i| angle(i).cos() as f32));
        }
    }
    out
}

/// [cos | sin] of t * 10000^(-i / half).
pub(super) fn timestep_embedding(t: f32, numbers: usize) -> Vec<f32> {
    let half = numbers / 2;
    let angle = |i: usize| f64::from(t) * (-(10000f64.ln()) * i as f64 / half as f64).exp();
    let cos = (0..half).map(|i| angle(i).cos() as f32);
    cos.chain((0..half).map(|i| angle(i).sin() as f32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden::{Golden, gap};

    const WIDTH: usize = 16;
    const HEADS: usize = 4;

    fn linear(golden: &Golden, name: &str, inputs: usize) -> Linear {
        Linear::from_parts(
            &golden.f32(&format!("{name}.weight")),
            golden.f32(&format!("{name}.bias")),
            inputs,
        )
    }

    fn block(golden: &Golden, ada: Linear) -> Block {
        Block {
            ada,
            qkv: linear(golden, "dit.qkv", WIDTH),
            proj: linear(golden, "dit.proj", WIDTH),
            fc1: linear(golden, "dit.fc1", WIDTH),
            fc2: linear(golden, "dit.fc2", 4 * WIDTH),
            local: None,
        }
    }

    /// Runs the block over sequences of `length` tokens: x [2][..][length][16], c [2][16].
    fn run(block: &Block, x: &[f32], c: &[f32], length: usize) -> Vec<f32> {
        let mut out = x.to_vec();
        for (half, c) in out.chunks_exact_mut(x.len() / 2).zip(c.chunks_exact(WIDTH)) {
            let time: Vec<f32> = c.iter().map(|v| kernels::silu(*v)).collect();
            let places: Vec<usize> = (0..length).collect();
            for sequence in half.chunks_exact_mut(length * WIDTH) {
                let mut keys_values = vec![f32::NAN; length * 2 * WIDTH];
                block.apply(
                    sequence,
                    &block.ada.vector(&time),
                    HEADS,
                    &places,
                    &mut keys_values,
                    Precision::F32,
                );
            }
        }
        out
    }

    /// Tolerance of nn.json: 2e-5 of the largest value.
    #[test]
    fn adaln_zero_block_against_torch() {
        let golden = Golden::nn();
        let (x, c) = (golden.f32("dit.x"), golden.f32("dit.c"));
        let ours = block(&golden, linear(&golden, "dit.ada", WIDTH));
        assert!(gap(&run(&ours, &x, &c, 12), &golden.f64("dit.spatial")) < 2e-5);
        // One token each: the first one of every sequence of the first frame.
        let single: Vec<f32> = x
            .chunks_exact(3 * 12 * WIDTH)
            .flat_map(|b| b[..WIDTH].to_vec())
            .collect();
        assert!(gap(&run(&ours, &single, &c, 1), &golden.f64("dit.single_token")) < 2e-5);
        // Zero modulation gates both branches off: x comes back bit for bit.
        let zero = Linear::from_parts(&vec![0.0; 6 * WIDTH * WIDTH], vec![0.0; 6 * WIDTH], WIDTH);
        assert_eq!(run(&block(&golden, zero), &x, &c, 12), x);
    }

    #[test]
    fn tokens_of_a_mask() {
        let mut cells = vec![false; CELLS];
        assert!(tokens_of(&cells, 3).is_empty());
        cells[3 * SIDE + 4] = true; // row 3, column 4: token (1, 2)
        assert_eq!(tokens_of(&cells, 0), [TOKENS_PER_SIDE + 2]);
        assert_eq!(tokens_of(&cells, 1).len(), 9);
        cells = vec![false; CELLS];
        cells[CELLS - 1] = true;
        assert_eq!(tokens_of(&cells, 2).len(), 9);
        assert_eq!(tokens_of(&[true; CELLS], 0).len(), TOKENS);
    }

    #[test]
    fn embeddings_against_torch() {
        let golden = Golden::nn();
        assert!(gap(&positions(3, 4, 16), &golden.f64("pos.grid")) < 2e-5);
        let (first, second) = (linear(&golden, "time.fc1", 32), linear(&golden, "time.fc2", 16));
        let (mut sinusoid, mut mlp) = (Vec::new(), Vec::new());
        for t in golden.f32("time.t") {
            let embedded = timestep_embedding(t, 32);
            let mut hidden = first.vector(&embedded);
            hidden.iter_mut().for_each(|v| *v = kernels::silu(*v));
            mlp.extend(second.vector(&hidden));
            sinusoid.extend(embedded);
        }
        assert!(gap(&sinusoid, &golden.f64("time.sinusoid32")) < 2e-5);
        assert!(gap(&mlp, &golden.f64("time.mlp")) < 2e-5);
    }

    #[test]
    fn patches_hold_every_cell_once() {
        let mut cells: Vec<usize> = (0..TOKENS).flat_map(patch).collect();
        assert_eq!(cells[..8], [0, 1, 50, 51, 2, 3, 52, 53]);
        cells.sort_unstable();
        assert_eq!(cells, (0..CELLS).collect::<Vec<_>>());
    }
}
