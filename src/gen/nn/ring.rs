//! A block of a diffusion transformer over a ring of maps, such as the pictures of the cameras around a vehicle: attention
//! in a map, attention to the maps on its left and right (SyntheOcc, arXiv 2410.00337, equation 5, as one softmax over both),
//! MLP. Fused for the processor.

use rayon::prelude::*;

use crate::Precision;
use crate::layers::{Head, Linear, Norm};
use crate::map::FeatureMap;
use crate::transformer::{Places, TransformerCore, piece_of, shrunk_queries};

/// Parts of a block over a ring of maps ([`Ops::ring_block`](crate::Ops::ring_block)).
pub struct RingBlockParts<L, N> {
    /// Added to what modulates the block: shift, scale and gate of attention, then of the MLP, `[6][width]`.
    pub offset: Vec<f32>,
    /// Queries, keys and values: `width` to `3 width`.
    pub qkv: L,
    /// `width` to `width`.
    pub proj: L,
    /// `width` to `4 width`.
    pub fc1: L,
    /// `4 width` to `width`.
    pub fc2: L,
    /// Weight `[width][3][3]` and bias of a depthwise convolution over the values.
    pub local: (Vec<f32>, Vec<f32>),
    /// Attention to the neighbours, where there is one.
    pub across: Option<AcrossParts<L, N>>,
    /// Attention heads.
    pub heads: usize,
}

/// Parts of attention to the maps on the left and on the right.
pub struct AcrossParts<L, N> {
    /// Norm of the tokens that are attended to.
    pub norm: N,
    /// Added to the keys of the left map, then to those of the right one, `[2][width]`.
    pub side: Vec<f32>,
    /// Queries, keys and values: `width` to `3 width`.
    pub qkv: L,
    /// `width` to `width`.
    pub proj: L,
}

/// A block with its weights.
pub struct RingBlock {
    offset: Vec<f32>,
    body: TransformerCore,
    across: Option<AcrossParts<Linear, Norm>>,
    heads: usize,
}

impl RingBlock {
    /// The block of its parts.
    pub fn new(parts: RingBlockParts<Linear, Norm>) -> Self {
        let layers = [parts.qkv, parts.proj, parts.fc1, parts.fc2];
        Self {
            offset: parts.offset,
            body: TransformerCore::new(layers, Some(parts.local), parts.heads),
            across: parts.across,
            heads: parts.heads,
        }
    }

    /// Applies the block in place over maps of one size, in the order of the ring: the map before one is on its left,
    /// the last one on the left of the first. `ada` has for each of them what modulates it, `[6][width]`.
    pub fn apply(&self, maps: &mut [FeatureMap], ada: &[FeatureMap]) {
        let precision = Precision::F32;
        let ada: Vec<Vec<f32>> = ada
            .iter()
            .map(|told| told.data.iter().zip(&self.offset).map(|(a, b)| a + b).collect())
            .collect();
        maps.par_iter_mut().zip(&ada).for_each(|(map, ada)| {
            let at: Vec<usize> = (0..map.rows * map.columns).collect();
            let places = Places {
                at: &at,
                shape: [map.rows, map.columns],
            };
            let mut keys_values = vec![0.0; 2 * map.data.len()];
            let (x, mlp) = (&mut map.data, self.body.mlp(ada, precision));
            match self.across {
                None => self.body.attend(x, ada, places, &mut keys_values, precision, mlp),
                Some(_) => self
                    .body
                    .attend(x, ada, places, &mut keys_values, precision, |_| ()),
            }
        });
        let Some(across) = &self.across else {
            return;
        };
        self.hear(across, maps);
        maps.par_iter_mut().zip(&ada).for_each(|(map, ada)| {
            let piece = piece_of(map.rows * map.columns) * map.width;
            let mlp = self.body.mlp(ada, precision);
            map.data.par_chunks_mut(piece).for_each(mlp);
        });
    }

    /// Adds to every map its attention to its neighbours.
    fn hear(&self, across: &AcrossParts<Linear, Norm>, maps: &mut [FeatureMap]) {
        let piece = |map: &FeatureMap| piece_of(map.rows * map.columns);
        let project = |map: &FeatureMap| {
            let width = map.width;
            let mut qkv = vec![0.0; 3 * map.data.len()];
            qkv.par_chunks_mut(piece(map) * 3 * width)
                .zip(map.data.par_chunks(piece(map) * width))
                .for_each(|(qkv, x)| {
                    let mut normed = vec![0.0; x.len()];
                    across.norm.rows(x, &mut normed);
                    across.qkv.rows(&normed, qkv);
                });
            qkv
        };
        let qkv: Vec<Vec<f32>> = maps.par_iter().map(project).collect();
        let count = maps.len();
        maps.par_iter_mut().enumerate().for_each(|(i, map)| {
            let (width, piece) = (map.width, piece(map));
            let keys_values = beside(
                across,
                [&qkv[(i + count - 1) % count], &qkv[(i + 1) % count]],
                width,
            );
            let head_width = width / self.heads;
            let head = |h: usize| {
                let at = h * head_width;
                Head::new(&keys_values, 2 * width, head_width, at, width + at)
            };
            let heads: Vec<Head<'_>> = (0..self.heads).into_par_iter().map(head).collect();
            map.data
                .par_chunks_mut(piece * width)
                .zip(qkv[i].par_chunks(piece * 3 * width))
                .for_each(|(x, qkv)| {
                    let mut heard = vec![0.0; x.len()];
                    for (h, head) in heads.iter().enumerate() {
                        let at = h * head_width;
                        let queries = shrunk_queries(qkv, 3 * width, at, head_width);
                        head.attend(&queries, &mut heard[at..], width);
                    }
                    let mut out = vec![0.0; x.len()];
                    across.proj.rows(&heard, &mut out);
                    x.iter_mut().zip(&out).for_each(|(x, y)| *x += y);
                });
        });
    }
}

/// Keys and values of both neighbours, those of the left one first, `[token][keys | values]`.
fn beside(across: &AcrossParts<Linear, Norm>, qkv: [&Vec<f32>; 2], width: usize) -> Vec<f32> {
    let mut rows = Vec::with_capacity((qkv[0].len() + qkv[1].len()) / 3 * 2);
    for (qkv, side) in qkv.into_iter().zip(across.side.chunks_exact(width)) {
        for row in qkv.chunks_exact(3 * width) {
            rows.extend(row[width..2 * width].iter().zip(side).map(|(k, s)| k + s));
            rows.extend_from_slice(&row[2 * width..]);
        }
    }
    rows
}
