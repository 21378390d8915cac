//! Matrix products in eight bits: rows of the input and columns of the matrix are scaled to -127..=127 and summed up
//! exactly as integers, so the answer has the same bits on every machine, with AVX-512 VNNI or without. The error is
//! that of rounding alone: at most half a step of each factor (`row_17_int8_products`). docs/trade.md has what it
//! saves and costs, measured by `sceneloom trade`.

use bytemuck::{Pod, Zeroable};

use super::view::MatrixView;
use crate::vectorised;

/// Columns of a vector of 32-bit sums.
const LANES: usize = 16;
/// Vectors of a panel.
const VECTORS: usize = 3;
/// Rows that are computed together.
const ROWS: usize = 8;
/// Products that one instruction adds up.
const GROUP: usize = 4;
/// Adding 1.5 * 2^23 rounds to the nearest whole number, ties to even; it then stands in the low bits.
const ROUND: f32 = 12_582_912.0;
/// Most rows of the matrix for which no sum can leave 32 bits: 2^31 / (255 * 127).
const MOST_INPUTS: usize = 65_000;

/// Four rows of sixteen columns, column after column.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Int8Tile([i8; GROUP * LANES]);

/// A matrix `[k][n]` in eight bits; panels of 48 columns, each holding its rows in fours.
pub struct Int8Matrix {
    data: Vec<Int8Tile>,
    k: usize,
    n: usize,
    /// Value of one step in each column.
    scales: Vec<f32>,
    /// 128 times the sum of each column: inputs are stored 128 too high.
    offsets: Vec<i32>,
}

impl Int8Matrix {
    /// Quantises the first `k` rows and `n` columns of `matrix`, which are finite.
    pub fn new(matrix: MatrixView<'_>, k: usize, n: usize) -> Self {
        assert!(k <= MOST_INPUTS);
        let groups = k.div_ceil(GROUP);
        let mut data = vec![Int8Tile([0; GROUP * LANES]); groups * n.div_ceil(LANES)];
        let (mut scales, mut offsets) = (vec![0.0; n], vec![0; n]);
        for column in 0..n {
            let largest = (0..k).fold(0.0f32, |m, row| m.max(matrix.at(row, column).abs()));
            scales[column] = largest / 127.0;
            let inverse = if largest > 0.0 { 127.0 / largest } else { 0.0 };
            for row in 0..k {
                let q = (matrix.at(row, column) * inverse).round_ties_even() as i8;
                offsets[column] += 128 * i32::from(q);
                let at = place(column, row / GROUP, groups, n);
                data[at].0[column % LANES * GROUP + row % GROUP] = q;
            }
        }
        Self {
            data,
            k,
            n,
            scales,
            offsets,
        }
    }

    /// The transpose of rows of `width` values, `stride` apart: each row becomes a column with its own scale.
    pub fn of_columns(rows: &[f32], stride: usize, width: usize) -> Self {
        let n = rows.len().div_ceil(stride);
        let (groups, mut quantised) = (width.div_ceil(GROUP), vec![0u8; width.next_multiple_of(GROUP)]);
        let mut data = vec![Int8Tile([0; GROUP * LANES]); groups * n.div_ceil(LANES)];
        let (mut scales, mut offsets) = (vec![0.0; n], vec![0; n]);
        for (token, row) in rows.chunks(stride).enumerate() {
            quantise_rows(&row[..width], width, &mut quantised, &mut scales[token..=token]);
            let mut sum = 0;
            for (group, four) in quantised.chunks_exact(GROUP).enumerate() {
                let at = place(token, group, groups, n);
                for (to, q) in data[at].0[token % LANES * GROUP..][..GROUP].iter_mut().zip(four) {
                    *to = q.wrapping_sub(128) as i8;
                    sum += i32::from(*to);
                }
            }
            offsets[token] = 128 * sum;
        }
        Self {
            data,
            k: width,
            n,
            scales,
            offsets,
        }
    }

    /// Rows of `width` values, `stride` apart, each column with its own scale.
    pub fn of_rows(rows: &[f32], stride: usize, width: usize) -> Self {
        let k = rows.len().div_ceil(stride);
        assert!(k <= MOST_INPUTS);
        let groups = k.div_ceil(GROUP);
        let mut data = vec![Int8Tile([0; GROUP * LANES]); groups * width.div_ceil(LANES)];
        let mut largest = vec![0.0f32; width];
        let mut bad = vec![false; width];
        for row in rows.chunks(stride) {
            for ((m, bad), v) in largest.iter_mut().zip(&mut bad).zip(row) {
                *m = if v.abs() > *m { v.abs() } else { *m };
                *bad |= !v.is_finite();
            }
        }
        let inverse: Vec<f32> = largest
            .iter()
            .zip(&bad)
            .map(|(m, bad)| if *m > 0.0 && !bad { 127.0 / m } else { 0.0 })
            .collect();
        let scales = largest
            .iter()
            .zip(&bad)
            .map(|(m, bad)| if *bad { f32::NAN } else { m / 127.0 });
        let scales = scales.collect();
        let mut four = vec![[0i8; GROUP]; width];
        for (group, rows) in rows.chunks(GROUP * stride).enumerate() {
            four.fill([0; GROUP]);
            for (r, row) in rows.chunks(stride).enumerate() {
                for ((four, v), inverse) in four.iter_mut().zip(row).zip(&inverse) {
                    four[r] = (v * inverse + ROUND).to_bits() as u8 as i8;
                }
            }
            for (columns, from) in four.chunks(LANES).enumerate() {
                let line = &mut data[place(columns * LANES, group, groups, width)].0;
                for (to, four) in line.chunks_exact_mut(GROUP).zip(from) {
                    to.copy_from_slice(four);
                }
            }
        }
        Self {
            data,
            k,
            n: width,
            scales,
            offsets: vec![0; width], // mixed by weights that are not negative: nothing is stored too high
        }
    }

    /// Rows of the matrix.
    pub fn inputs(&self) -> usize {
        self.k
    }

    /// Columns of the matrix.
    pub fn outputs(&self) -> usize {
        self.n
    }

    /// Offsets and scales of some columns.
    pub fn of(&self, first: usize, columns: usize) -> (&[i32], &[f32]) {
        (
            &self.offsets[first..][..columns],
            &self.scales[first..][..columns],
        )
    }

    /// Exact sums of up to eight rows (each a whole number of fours), given out panel by panel: its first column, its
    /// number of columns, a row of sums for each row.
    pub fn sums(&self, rows: &[u8], count: usize, mut each: impl FnMut(usize, usize, &[Wide])) {
        let groups = self.k.div_ceil(GROUP);
        assert!(count <= ROWS);
        let mut sums = [[0i32; VECTORS * LANES]; ROWS];
        for first in (0..self.n).step_by(VECTORS * LANES) {
            let columns = (self.n - first).min(VECTORS * LANES);
            let vectors = columns.div_ceil(LANES);
            let lines = &self.data[first / LANES * groups..][..vectors * groups];
            tile(rows, groups, lines, vectors, &mut sums[..count]);
            each(first, columns, &sums[..count]);
        }
    }

    /// Rows of `x` (`k` values each) to rows of `out` (`n` values each), plus a bias per column. One thread. A row with
    /// a value that is not finite gives NaN.
    pub fn multiply(&self, x: &[f32], bias: &[f32], out: &mut [f32]) {
        let (padded, rows) = (self.k.next_multiple_of(GROUP), x.len() / self.k);
        assert!(x.len() == rows * self.k && out.len() == rows * self.n && bias.len() == self.n);
        let mut quantised = vec![0u8; rows * padded];
        let mut scales = vec![0.0; rows];
        quantise_rows(x, self.k, &mut quantised, &mut scales);
        for row in (0..rows).step_by(ROWS) {
            let count = ROWS.min(rows - row);
            self.sums(
                &quantised[row * padded..][..count * padded],
                count,
                |first, columns, sums| {
                    let (offsets, of_columns) = self.of(first, columns);
                    let bias = &bias[first..][..columns];
                    for (r, sums) in sums.iter().enumerate() {
                        let out = &mut out[(row + r) * self.n + first..][..columns];
                        scaled(&sums[..columns], offsets, of_columns, scales[row + r], bias, out);
                    }
                },
            );
        }
    }
}

/// Sums of a row over the columns of a panel.
pub type Wide = [i32; VECTORS * LANES];

/// Place of the line of a column and a group of rows.
fn place(column: usize, group: usize, groups: usize, n: usize) -> usize {
    let panel = column / (VECTORS * LANES);
    let first = panel * VECTORS;
    let vectors = (n.div_ceil(LANES) - first).min(VECTORS);
    first * groups + group * vectors + (column / LANES - first)
}

vectorised! {
    /// Quantises every row of `k` values to whole numbers around 128, rows padded to fours with 128; `scales` gets the
    /// value of a step.
    pub fn quantise_rows(x: &[f32], k: usize, out: &mut [u8], scales: &mut [f32]) {
        let padded = k.next_multiple_of(GROUP);
        for ((x, out), scale) in x.chunks_exact(k).zip(out.chunks_exact_mut(padded)).zip(scales) {
            // Magnitudes compare as their bits do, and numbers that are not finite have larger bits than any other.
            let magnitude = |v: f32| v.to_bits() & 0x7fff_ffff;
            let mut largest = [0u32; LANES];
            let chunks = x.chunks_exact(LANES);
            for v in chunks.remainder() {
                largest[0] = largest[0].max(magnitude(*v));
            }
            for chunk in chunks {
                for (m, v) in largest.iter_mut().zip(chunk) {
                    *m = (*m).max(magnitude(*v));
                }
            }
            let largest = f32::from_bits(largest.into_iter().fold(0, u32::max));
            let bad = !largest.is_finite();
            *scale = if bad { f32::NAN } else { largest / 127.0 };
            let inverse = if largest > 0.0 && !bad { 127.0 / largest } else { 0.0 };
            let (values, rest) = out.split_at_mut(k);
            for (q, v) in values.iter_mut().zip(x) {
                *q = ((v * inverse + ROUND).to_bits() as u8).wrapping_add(128);
            }
            rest.fill(128);
        }
    }
}

vectorised! {
    /// Converts the sums of one row to numbers.
    pub fn scaled(sums: &[i32], offsets: &[i32], columns: &[f32], row: f32, bias: &[f32], out: &mut [f32]) {
        for ((((o, s), offset), c), b) in out.iter_mut().zip(sums).zip(offsets).zip(columns).zip(bias) {
            *o = (*s - offset) as f32 * (row * c) + b;
        }
    }
}

/// True if the machine adds four products of bytes in one instruction.
pub fn fast_here() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx512vnni");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Sums of up to eight rows against one panel.
fn tile(a: &[u8], groups: usize, lines: &[Int8Tile], vectors: usize, sums: &mut [[i32; VECTORS * LANES]]) {
    assert!(a.len() == sums.len() * groups * GROUP && lines.len() == groups * vectors && vectors <= VECTORS);
    #[cfg(target_arch = "x86_64")]
    if fast_here() {
        // SAFETY: the machine has AVX-512 VNNI; the assert gives every row `groups` fours and every group its lines.
        unsafe { vnni::tile(a, groups, lines, vectors, sums) };
        return;
    }
    plain_tile(a, groups, lines, vectors, sums);
}

fn plain_tile(
    a: &[u8],
    groups: usize,
    lines: &[Int8Tile],
    vectors: usize,
    sums: &mut [[i32; VECTORS * LANES]],
) {
    for (row, sums) in a.chunks_exact(groups * GROUP).zip(sums) {
        sums.fill(0);
        for (four, lines) in row.chunks_exact(GROUP).zip(lines.chunks_exact(vectors)) {
            for (line, sums) in lines.iter().zip(sums.chunks_exact_mut(LANES)) {
                for (sum, b) in sums.iter_mut().zip(line.0.chunks_exact(GROUP)) {
                    *sum += four
                        .iter()
                        .zip(b)
                        .map(|(a, b)| i32::from(*a) * i32::from(*b))
                        .sum::<i32>();
                }
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod vnni {
    use std::arch::x86_64::{
        __m512i, _mm512_dpbusd_epi32, _mm512_load_si512, _mm512_set1_epi32, _mm512_setzero_si512,
        _mm512_storeu_si512,
    };

    use super::{GROUP, Int8Tile, LANES, ROWS, VECTORS};

    /// # Safety
    /// AVX-512F and VNNI; `a` holds `sums.len()` (1 to 8) rows of `groups` fours, `lines` `groups` times `vectors` lines.
    #[target_feature(enable = "avx512f,avx512vnni")]
    pub unsafe fn tile(
        a: &[u8],
        groups: usize,
        lines: &[Int8Tile],
        vectors: usize,
        sums: &mut [[i32; VECTORS * LANES]],
    ) {
        macro_rules! of {
            ($vectors:literal) => {
                match sums.len() {
                    1 => tile_of::<1, $vectors>(a, groups, lines, sums),
                    2 => tile_of::<2, $vectors>(a, groups, lines, sums),
                    3 => tile_of::<3, $vectors>(a, groups, lines, sums),
                    4 => tile_of::<4, $vectors>(a, groups, lines, sums),
                    5 => tile_of::<5, $vectors>(a, groups, lines, sums),
                    6 => tile_of::<6, $vectors>(a, groups, lines, sums),
                    7 => tile_of::<7, $vectors>(a, groups, lines, sums),
                    _ => tile_of::<ROWS, $vectors>(a, groups, lines, sums),
                }
            };
        }
        // SAFETY: handed on.
        unsafe {
            match vectors {
                1 => of!(1),
                2 => of!(2),
                _ => of!(3),
            }
        }
    }

    #[target_feature(enable = "avx512f,avx512vnni")]
    #[inline]
    unsafe fn tile_of<const R: usize, const V: usize>(
        a: &[u8],
        groups: usize,
        lines: &[Int8Tile],
        sums: &mut [[i32; VECTORS * LANES]],
    ) {
        let mut held: [[__m512i; V]; R] = [[_mm512_setzero_si512(); V]; R];
        let (a, lines) = (a.as_ptr(), lines.as_ptr());
        // SAFETY: the caller's promise: row r has `groups` fours, group g its V lines, `sums` R rows of 48 numbers.
        unsafe {
            for g in 0..groups {
                let mut columns = [_mm512_setzero_si512(); V];
                for (v, c) in columns.iter_mut().enumerate() {
                    *c = _mm512_load_si512(lines.add(g * V + v).cast());
                }
                for (r, held) in held.iter_mut().enumerate() {
                    let four = a.add((r * groups + g) * GROUP).cast::<i32>().read_unaligned();
                    let four = _mm512_set1_epi32(four);
                    for (sum, c) in held.iter_mut().zip(columns) {
                        *sum = _mm512_dpbusd_epi32(*sum, four, c);
                    }
                }
            }
            for (sums, held) in sums.iter_mut().zip(&held) {
                for (v, sum) in held.iter().enumerate() {
                    _mm512_storeu_si512(sums.as_mut_ptr().add(v * LANES).cast(), *sum);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, step: f32) -> Vec<f32> {
        (0..n)
            .map(|i| (i as f32 * step).sin() * (1.0 + (i % 7) as f32))
            .collect()
    }

    /// Row 17, for the eight-bit product: odd sizes and a wide spread; the error against f64 is that of rounding each
    /// factor to half a step, the portable sums are the same integers, and a row alone is the row among others.
    #[test]
    fn row_17_int8_products() {
        for [m, n, k] in [
            [1, 1, 1],
            [3, 5, 31],
            [9, 48, 33],
            [11, 113, 192],
            [80, 768, 192],
            [2, 3, 65_000],
        ] {
            let (mut x, w, bias) = (wave(m * k, 0.37), wave(k * n, 0.73), wave(n, 0.2));
            x.iter_mut()
                .enumerate()
                .for_each(|(i, v)| *v *= [1e9, 1.0, 1e-9, 1e-40][i / k % 4]);
            let packed = Int8Matrix::new(MatrixView::rows(&w, n), k, n);
            let mut out = vec![f32::NAN; m * n];
            packed.multiply(&x, &bias, &mut out);
            let largest = |v: &mut dyn Iterator<Item = f32>| f64::from(v.fold(0.0f32, |m, v| m.max(v.abs())));
            for row in 0..m {
                let x = &x[row * k..][..k];
                let step_x = largest(&mut x.iter().copied()) / 254.0;
                for column in 0..n {
                    let w = |i: usize| f64::from(w[i * n + column]);
                    let step_w = largest(&mut (0..k).map(|i| w(i) as f32)) / 254.0;
                    let truth: f64 = (0..k).map(|i| f64::from(x[i]) * w(i)).sum();
                    let bound: f64 = (0..k)
                        .map(|i| step_x * w(i).abs() + step_w * f64::from(x[i]).abs() + step_x * step_w)
                        .sum();
                    let found = f64::from(out[row * n + column]) - f64::from(bias[column]);
                    let rounding = 1e-5 * (truth.abs() + bound + f64::from(bias[column]).abs()) + 1e-37;
                    assert!(
                        (found - truth).abs() <= bound + rounding,
                        "{m}x{n}x{k}: {found}, expected {truth}"
                    );
                }
            }
            let mut alone = vec![f32::NAN; n];
            packed.multiply(&x[(m - 1) * k..], &bias, &mut alone);
            assert_eq!(alone, out[(m - 1) * n..]);
        }
    }

    #[test]
    fn the_portable_sums_are_the_same() {
        for (rows, groups, vectors) in [(1, 1, 1), (8, 48, 3), (5, 7, 2)] {
            let a: Vec<u8> = (0..rows * groups * GROUP).map(|i| (i * 37 % 256) as u8).collect();
            let lines: Vec<Int8Tile> = (0..groups * vectors)
                .map(|i| Int8Tile(std::array::from_fn(|j| ((i * 64 + j) * 91 % 255) as u8 as i8)))
                .collect();
            let mut found = vec![[0; VECTORS * LANES]; rows];
            let mut plain = found.clone();
            tile(&a, groups, &lines, vectors, &mut found);
            plain_tile(&a, groups, &lines, vectors, &mut plain);
            assert!(found == plain && found[0][0] != 0);
        }
    }

    /// Row 16, for eight bits: what is not finite stays so, zeros stay zeros.
    #[test]
    fn row_16_int8_inputs() {
        let packed = Int8Matrix::new(MatrixView::rows(&[0.0, 1.0, 0.0, -2.0], 2), 2, 2);
        let mut out = [9.0; 8];
        packed.multiply(
            &[0.0, 0.0, f32::NAN, 1.0, f32::INFINITY, 1.0, 3e38, 0.0],
            &[0.5, 0.25],
            &mut out,
        );
        assert_eq!(out[..2], [0.5, 0.25]);
        assert!(out[2..6].iter().all(|v| v.is_nan()));
        assert!(out[6] == 0.5 && (out[7] / 3e38 - 1.0).abs() < 0.01);
    }
}
