//! Tokens of 2x2 latent cells: which cells they hold, where they stand, and how a step of the schedule is embedded.

use crate::SIDE;

/// Cells of a token along x and along y.
const PATCH: usize = 2;
/// Tokens along x and along y.
pub(super) const TOKENS_PER_SIDE: usize = SIDE / PATCH;
/// Tokens of a whole map.
pub const TOKENS: usize = TOKENS_PER_SIDE * TOKENS_PER_SIDE;
/// Cells of a token.
pub(super) const PATCH_CELLS: usize = PATCH * PATCH;

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

/// The four cells of a token, in the order of its channels.
pub(super) fn patch(token: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (token / TOKENS_PER_SIDE * PATCH, token % TOKENS_PER_SIDE * PATCH);
    (0..PATCH_CELLS).map(move |i| (x + i / PATCH) * SIDE + y + i % PATCH)
}

/// Fixed positions, `[rows * columns][width]`: the first half of the channels encodes the column, the
/// second half the row, each as [sin | cos] of pos / base^(i / (width / 4)).
pub(crate) fn positions([rows, columns]: [usize; 2], width: usize, base: f64) -> Vec<f32> {
    let quarter = width / 4;
    let mut out = Vec::with_capacity(rows * columns * width);
    for token in 0..rows * columns {
        for pos in [token % columns, token / columns] {
            let angle = |i: usize| pos as f64 / base.powf(i as f64 / quarter as f64);
            out.extend((0..quarter).map(|i| angle(i).sin() as f32));
            out.extend((0..quarter).map(|i| angle(i).cos() as f32));
        }
    }
    out
}

/// [cos | sin] of t * 10000^(-i / half).
pub(crate) fn timestep_embedding(t: f32, numbers: usize) -> Vec<f32> {
    let half = numbers / 2;
    let angle = |i: usize| f64::from(t) * (-(10000f64.ln()) * i as f64 / half as f64).exp();
    let cos = (0..half).map(|i| angle(i).cos() as f32);
    cos.chain((0..half).map(|i| angle(i).sin() as f32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CELLS;
    use crate::golden::{Golden, gap};
    use nn::kernels;
    use nn::layers::Linear;

    fn linear(golden: &Golden, name: &str, inputs: usize) -> Linear {
        Linear::from_parts(
            &golden.f32(&format!("{name}.weight")),
            golden.f32(&format!("{name}.bias")),
            inputs,
        )
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
        assert!(gap(&positions([3, 4], 16, 10000.0), &golden.f64("pos.grid")) < 2e-5);
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
