//! Blocks over the nodes of a graph on the processor: messages along typed edges, and attention that is biased by them and
//! open to a map.

use rayon::prelude::*;

use crate::kernels;
use crate::layers::{Linear, MatrixView, NORM_EPS, matmul};
use crate::ops::{MessageEdge, MessageParts, NodeBlockParts};

/// Rows that go through a layer in one piece.
const PIECE: usize = 32;

/// Applies a round of messages in place over the nodes `h`, see [`Ops::messages`](crate::Ops::messages).
pub(crate) fn messages(round: &MessageParts<Linear>, h: &mut [f32], width: usize, edges: &[MessageEdge]) {
    let n = h.len() / width;
    let y = modulated(h, &vec![0.0; width], &vec![0.0; width]);
    let (source, target) = (round.source.parallel(&y, PIECE), round.target.parallel(&y, PIECE));
    let (mut total, mut count) = (vec![0.0f32; h.len()], vec![0.0f32; n]);
    let mut message = vec![0.0; width];
    for edge in edges {
        let far = round.distance.vector(&edge.distance);
        let (s, t) = (&source[edge.from * width..], &target[edge.to * width..]);
        let r = &round.relation[edge.relation * width..];
        for k in 0..width {
            message[k] = s[k] + t[k] + r[k] + far[k];
        }
        kernels::gelu_all(&mut message);
        let total = &mut total[edge.to * width..][..width];
        total.iter_mut().zip(&message).for_each(|(t, m)| *t += m);
        count[edge.to] += 1.0;
    }
    for (row, n) in total.chunks_exact_mut(width).zip(&count) {
        row.iter_mut().for_each(|v| *v /= n.max(1.0));
    }
    let out = round.out.parallel(&total, PIECE);
    h.iter_mut().zip(&out).for_each(|(h, o)| *h += o);
}

/// Applies a transformer block in place over the nodes `h`, see [`Ops::node_block`](crate::Ops::node_block); an empty
/// `context` is none.
pub(crate) fn block(
    block: &NodeBlockParts<Linear>,
    h: &mut [f32],
    ada: &[f32],
    context: &[f32],
    bias: &[f32],
) {
    let m: Vec<f32> = ada.iter().zip(&block.shift).map(|(a, b)| a + b).collect();
    let width = m.len() / 6;
    let part = |i: usize| &m[i * width..][..width];
    let qkv = block.qkv.parallel(&modulated(h, part(0), part(1)), PIECE);
    let mixed = attention(&qkv, context, bias, width, block.heads);
    add_gated(h, part(2), &block.proj.parallel(&mixed, PIECE));
    let mut hidden = block.fc1.parallel(&modulated(h, part(3), part(4)), PIECE);
    kernels::gelu_all(&mut hidden);
    add_gated(h, part(5), &block.fc2.parallel(&hidden, PIECE));
}

fn modulated(x: &[f32], shift: &[f32], scale: &[f32]) -> Vec<f32> {
    let scale: Vec<f32> = scale.iter().map(|s| 1.0 + s).collect();
    let mut out = vec![0.0; x.len()];
    kernels::norm_rows(x, NORM_EPS, &scale, shift, &mut out);
    out
}

fn add_gated(h: &mut [f32], gate: &[f32], y: &[f32]) {
    for (h, y) in h.chunks_exact_mut(gate.len()).zip(y.chunks_exact(gate.len())) {
        for ((h, y), g) in h.iter_mut().zip(y).zip(gate) {
            *h += g * y;
        }
    }
}

/// Softmax(q k / sqrt(d) + bias) v over the nodes and the context, rows of all heads side by side.
fn attention(qkv: &[f32], context: &[f32], bias: &[f32], width: usize, heads: usize) -> Vec<f32> {
    let (d, n, tokens) = (
        width / heads,
        qkv.len() / (3 * width),
        context.len() / (2 * width),
    );
    let mut out = vec![0.0; n * width];
    if n == 0 {
        return out;
    }
    let (all, scale) = (n + tokens, 1.0 / (d as f32).sqrt());
    let mix = |head: usize| {
        let (mut scores, mut mixed) = (vec![0.0f32; n * all], vec![0.0f32; n * d]);
        let nodes = |part: usize| &qkv[part * width + head * d..];
        let map = |part: usize| &context[part * width + head * d..];
        let (q, keys) = (
            MatrixView::rows(nodes(0), 3 * width),
            MatrixView::columns(nodes(1), 3 * width),
        );
        matmul(&mut scores, all, false, q, keys, [n, n, d]);
        if tokens > 0 {
            let keys = MatrixView::columns(map(0), 2 * width);
            matmul(&mut scores[n..], all, false, q, keys, [n, tokens, d]);
        }
        for (i, scores) in scores.chunks_exact_mut(all).enumerate() {
            scores.iter_mut().for_each(|s| *s *= scale);
            let bias = &bias[(head * n + i) * n..][..n];
            scores.iter_mut().zip(bias).for_each(|(s, b)| *s += b);
            let most = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            scores.iter_mut().for_each(|s| *s = kernels::exp(*s - most));
            let sum: f32 = scores.iter().sum();
            scores.iter_mut().for_each(|s| *s /= sum);
        }
        let values = MatrixView::rows(nodes(2), 3 * width);
        matmul(
            &mut mixed,
            d,
            false,
            MatrixView::rows(&scores, all),
            values,
            [n, d, n],
        );
        if tokens > 0 {
            let (scores, values) = (
                MatrixView::rows(&scores[n..], all),
                MatrixView::rows(map(1), 2 * width),
            );
            matmul(&mut mixed, d, true, scores, values, [n, d, tokens]);
        }
        mixed
    };
    let heads: Vec<Vec<f32>> = (0..heads).into_par_iter().map(mix).collect();
    for (i, out) in out.chunks_exact_mut(width).enumerate() {
        for (out, mixed) in out.chunks_exact_mut(d).zip(&heads) {
            out.copy_from_slice(&mixed[i * d..(i + 1) * d]);
        }
    }
    out
}
