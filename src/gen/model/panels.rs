//! Matrix products against a matrix that is cut into panels beforehand: no packing per call, and with
//! AVX-512 a kernel of our own (both rates: `cargo bench --bench networks`). Its numbers are sums over k in rising
//! order, whatever the number of rows, so pieces of a product are bit for bit the whole; through gemm they are as
//! far as gemm makes them so.

use bytemuck::{Pod, Zeroable};

use super::int8::Int8Panels;
use super::layers::{View, matmul};

/// Columns of a panel: three vectors of sixteen.
const PANEL: usize = 3 * LANES;
const LANES: usize = 16;
/// Rows that are computed together: 8 x 3 accumulators leave room in 32 registers.
const ROWS: usize = 8;

/// A cache line: a vector that begins within one is read at once.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([f32; LANES]);

/// What a product is added to.
#[derive(Clone, Copy)]
pub enum Start<'a> {
    /// Nothing.
    Zero,
    /// One number per column.
    Bias(&'a [f32]),
    /// What the output holds.
    Add,
}

/// A matrix `[k][n]`; panel p holds k rows of its 48 columns, the last one of as many sixteens as it needs.
#[derive(Clone)]
pub struct Panels {
    data: Vec<Line>,
    k: usize,
    n: usize,
}

impl Panels {
    /// Of the first `k` rows and `n` columns of `matrix`.
    pub fn new(matrix: View<'_>, k: usize, n: usize) -> Self {
        let mut lines = vec![Line([0.0; LANES]); k * n.div_ceil(LANES)];
        let data: &mut [f32] = bytemuck::cast_slice_mut(&mut lines);
        for first in (0..n).step_by(PANEL) {
            let wide = width(n, first);
            let columns = PANEL.min(n - first);
            for (row, out) in data[first * k..][..wide * k].chunks_exact_mut(wide).enumerate() {
                for (c, v) in out[..columns].iter_mut().enumerate() {
                    *v = matrix.at(row, first + c);
                }
            }
        }
        Self { data: lines, k, n }
    }

    /// The same matrix in eight bits.
    pub fn to_int8(&self) -> Int8Panels {
        let rows: Vec<f32> = (0..self.k)
            .flat_map(|row| (0..self.n).map(move |column| self.at(row, column)))
            .collect();
        Int8Panels::new(View::rows(&rows, self.n), self.k, self.n)
    }

    fn values(&self) -> &[f32] {
        bytemuck::cast_slice(&self.data)
    }

    /// Rows of the matrix.
    pub fn inputs(&self) -> usize {
        self.k
    }

    /// Columns of the matrix.
    pub fn outputs(&self) -> usize {
        self.n
    }

    /// Value (row, column).
    pub fn at(&self, row: usize, column: usize) -> f32 {
        let first = column / PANEL * PANEL;
        self.values()[first * self.k + row * width(self.n, first) + column - first]
    }

    /// out[m x n, rows `out_stride` apart] = `start` + a[m x k] times rows `from_k..from_k + k` of the matrix; the
    /// rows of `a` lie `a_stride` apart and may overlap. One thread.
    #[allow(clippy::too_many_arguments)] // sizes and strides of one product
    pub fn multiply(
        &self,
        a: &[f32],
        a_stride: usize,
        [m, from_k, k]: [usize; 3],
        start: Start<'_>,
        out: &mut [f32],
        out_stride: usize,
    ) {
        if m == 0 || self.n == 0 {
            return;
        }
        assert!(k > 0 && from_k + k <= self.k && (m == 1 || out_stride >= self.n));
        for first in (0..self.n).step_by(PANEL) {
            let wide = width(self.n, first);
            let b = &self.values()[first * self.k + from_k * wide..][..k * wide];
            let start = match start {
                Start::Bias(bias) => Start::Bias(&bias[first..]),
                other => other,
            };
            let columns = PANEL.min(self.n - first);
            product(
                a,
                a_stride,
                b,
                wide,
                [m, columns, k],
                start,
                &mut out[first..],
                out_stride,
            );
        }
    }

    /// For every pair [to, from]: row `to` of `out` += row `from` of `a` times rows `from_k..from_k + k` of the matrix.
    /// No `to` occurs twice. Which pairs stand together changes no bit of a row. One thread.
    pub fn add_pairs(
        &self,
        a: &[f32],
        a_stride: usize,
        pairs: &[[u32; 2]],
        [from_k, k]: [usize; 2],
        out: &mut [f32],
        out_stride: usize,
    ) {
        let last = pairs
            .iter()
            .fold([0, 0], |m: [u32; 2], p| [m[0].max(p[0]), m[1].max(p[1])]);
        if pairs.is_empty() || self.n == 0 {
            return;
        }
        let [to, from] = last.map(|v| v as usize);
        assert!(k > 0 && from_k + k <= self.k && from * a_stride + k <= a.len());
        assert!(to * out_stride + self.n <= out.len() && out_stride >= self.n);
        for first in (0..self.n).step_by(PANEL) {
            let (wide, columns) = (width(self.n, first), PANEL.min(self.n - first));
            let b = &self.values()[first * self.k + from_k * wide..][..k * wide];
            #[cfg(target_arch = "x86_64")]
            if ours() {
                let sizes = avx512::Sizes {
                    a_stride,
                    b_stride: wide,
                    out_stride,
                    n: columns,
                    k,
                };
                // SAFETY: the machine has AVX-512; by the asserts every row of a pair lies inside its slice, and
                // `b` holds k rows of a whole number of sixteens.
                unsafe { avx512::pairs(pairs, &sizes, a.as_ptr(), b.as_ptr(), out[first..].as_mut_ptr()) };
                continue;
            }
            let gathered: Vec<f32> = pairs
                .iter()
                .flat_map(|p| a[p[1] as usize * a_stride..][..k].iter().copied())
                .collect();
            let mut product = vec![0.0; pairs.len() * columns];
            plain(
                &gathered,
                k,
                b,
                wide,
                [pairs.len(), columns, k],
                Start::Zero,
                &mut product,
                columns,
            );
            for (pair, add) in pairs.iter().zip(product.chunks_exact(columns)) {
                let to = &mut out[pair[0] as usize * out_stride + first..][..columns];
                to.iter_mut().zip(add).for_each(|(v, a)| *v += a);
            }
        }
    }
}

/// Columns that the panel beginning at column `first` of `n` takes in memory.
fn width(n: usize, first: usize) -> usize {
    PANEL.min((n - first).next_multiple_of(LANES))
}

/// out[m x n] = start + a[m x k] b[k x n] for at most 48 columns; `b` has rows `b_stride` apart, and at least the
/// next multiple of 16 of n values from the start of every row.
#[allow(clippy::too_many_arguments)] // sizes and strides of one product
pub fn product(
    a: &[f32],
    a_stride: usize,
    b: &[f32],
    b_stride: usize,
    [m, n, k]: [usize; 3],
    start: Start<'_>,
    out: &mut [f32],
    out_stride: usize,
) {
    assert!(m > 0 && k > 0 && (1..=PANEL).contains(&n) && out_stride >= n);
    assert!((m - 1) * a_stride + k <= a.len() && (m - 1) * out_stride + n <= out.len());
    assert!((k - 1) * b_stride + n.next_multiple_of(LANES) <= b.len());
    if let Start::Bias(bias) = start {
        assert!(bias.len() >= n);
    }
    #[cfg(target_arch = "x86_64")]
    if ours() {
        let sizes = avx512::Sizes {
            a_stride,
            b_stride,
            out_stride,
            n,
            k,
        };
        let mut row = 0;
        while row < m {
            let rows = ROWS.min(m - row);
            // SAFETY: the machine has AVX-512; by the asserts rows row..row + rows of `a` and `out`, k rows of
            // `b` up to a whole number of sixteens, and n values of the bias lie inside their slices.
            unsafe {
                avx512::tile(
                    rows,
                    &sizes,
                    a.as_ptr().add(row * a_stride),
                    b.as_ptr(),
                    start,
                    out.as_mut_ptr().add(row * out_stride),
                );
            }
            row += rows;
        }
        return;
    }
    plain(a, a_stride, b, b_stride, [m, n, k], start, out, out_stride);
}

/// True if the machine can run our kernel.
fn ours() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx512f");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// The same through gemm, for machines without AVX-512.
#[allow(clippy::too_many_arguments)] // sizes and strides of one product
fn plain(
    a: &[f32],
    a_stride: usize,
    b: &[f32],
    b_stride: usize,
    [m, n, k]: [usize; 3],
    start: Start<'_>,
    out: &mut [f32],
    out_stride: usize,
) {
    if let Start::Bias(bias) = start {
        for row in out.chunks_mut(out_stride).take(m) {
            row[..n].copy_from_slice(&bias[..n]);
        }
    }
    let add = !matches!(start, Start::Zero);
    let (a, b) = (View::rows(a, a_stride), View::rows(b, b_stride));
    matmul(out, out_stride, add, a, b, [m, n, k]);
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use std::arch::x86_64::{
        __m512, _mm512_fmadd_ps, _mm512_loadu_ps, _mm512_mask_storeu_ps, _mm512_maskz_loadu_ps,
        _mm512_set1_ps, _mm512_setzero_ps,
    };

    use super::{LANES, ROWS, Start};

    pub struct Sizes {
        pub a_stride: usize,
        pub b_stride: usize,
        pub out_stride: usize,
        pub n: usize,
        pub k: usize,
    }

    /// Up to eight rows of a product.
    ///
    /// # Safety
    /// AVX-512F; `rows` of a and out, k of b (to a whole number of sixteens) and n of the bias must be valid.
    #[target_feature(enable = "avx512f")]
    pub unsafe fn tile(
        rows: usize,
        s: &Sizes,
        a: *const f32,
        b: *const f32,
        start: Start<'_>,
        out: *mut f32,
    ) {
        macro_rules! of {
            ($vectors:literal) => {
                match rows {
                    1 => tile_of::<1, $vectors>(s, a, b, start, out),
                    2 => tile_of::<2, $vectors>(s, a, b, start, out),
                    3 => tile_of::<3, $vectors>(s, a, b, start, out),
                    4 => tile_of::<4, $vectors>(s, a, b, start, out),
                    5 => tile_of::<5, $vectors>(s, a, b, start, out),
                    6 => tile_of::<6, $vectors>(s, a, b, start, out),
                    7 => tile_of::<7, $vectors>(s, a, b, start, out),
                    _ => tile_of::<ROWS, $vectors>(s, a, b, start, out),
                }
            };
        }
        // SAFETY: handed on.
        unsafe {
            match s.n.div_ceil(LANES) {
                1 => of!(1),
                2 => of!(2),
                _ => of!(3),
            }
        }
    }

    /// `out[to] += a[from] b` for each pair `[to, from]` of rows.
    ///
    /// # Safety
    /// AVX-512F; the rows of every pair and k rows of b (to a whole number of sixteens) must be valid.
    #[target_feature(enable = "avx512f")]
    pub unsafe fn pairs(pairs: &[[u32; 2]], s: &Sizes, a: *const f32, b: *const f32, out: *mut f32) {
        macro_rules! of {
            ($p:expr, $vectors:literal) => {
                match $p.len() {
                    1 => pairs_of::<1, $vectors>($p, s, a, b, out),
                    2 => pairs_of::<2, $vectors>($p, s, a, b, out),
                    3 => pairs_of::<3, $vectors>($p, s, a, b, out),
                    4 => pairs_of::<4, $vectors>($p, s, a, b, out),
                    5 => pairs_of::<5, $vectors>($p, s, a, b, out),
                    6 => pairs_of::<6, $vectors>($p, s, a, b, out),
                    7 => pairs_of::<7, $vectors>($p, s, a, b, out),
                    _ => pairs_of::<ROWS, $vectors>($p, s, a, b, out),
                }
            };
        }
        for some in pairs.chunks(ROWS) {
            // SAFETY: handed on.
            unsafe {
                match s.n.div_ceil(LANES) {
                    1 => of!(some, 1),
                    2 => of!(some, 2),
                    _ => of!(some, 3),
                }
            }
        }
    }

    #[target_feature(enable = "avx512f")]
    #[inline]
    unsafe fn pairs_of<const R: usize, const V: usize>(
        pairs: &[[u32; 2]],
        s: &Sizes,
        a: *const f32,
        b: *const f32,
        out: *mut f32,
    ) {
        let mask = |v: usize| -> u16 { (0xffff_u32 >> (LANES - (s.n - v * LANES).min(LANES))) as u16 };
        let mut sums: [[__m512; V]; R] = [[_mm512_setzero_ps(); V]; R];
        // SAFETY: the caller's promise; masked loads and stores touch n values of a row.
        unsafe {
            let from: [*const f32; R] = std::array::from_fn(|r| a.add(pairs[r][1] as usize * s.a_stride));
            let to: [*mut f32; R] = std::array::from_fn(|r| out.add(pairs[r][0] as usize * s.out_stride));
            for (to, sums) in to.iter().zip(&mut sums) {
                for (v, sum) in sums.iter_mut().enumerate() {
                    *sum = _mm512_maskz_loadu_ps(mask(v), to.add(v * LANES));
                }
            }
            for k in 0..s.k {
                let row = b.add(k * s.b_stride);
                let mut columns = [_mm512_setzero_ps(); V];
                for (v, c) in columns.iter_mut().enumerate() {
                    *c = _mm512_loadu_ps(row.add(v * LANES));
                }
                for (from, sums) in from.iter().zip(&mut sums) {
                    let value = _mm512_set1_ps(*from.add(k));
                    for (sum, c) in sums.iter_mut().zip(columns) {
                        *sum = _mm512_fmadd_ps(value, c, *sum);
                    }
                }
            }
            for (to, sums) in to.iter().zip(&sums) {
                for (v, sum) in sums.iter().enumerate() {
                    _mm512_mask_storeu_ps(to.add(v * LANES), mask(v), *sum);
                }
            }
        }
    }

    #[target_feature(enable = "avx512f")]
    #[inline]
    unsafe fn tile_of<const R: usize, const V: usize>(
        s: &Sizes,
        a: *const f32,
        b: *const f32,
        start: Start<'_>,
        out: *mut f32,
    ) {
        // Lanes of vector v that belong to the product.
        let mask = |v: usize| -> u16 { (0xffff_u32 >> (LANES - (s.n - v * LANES).min(LANES))) as u16 };
        let mut sums: [[__m512; V]; R] = [[_mm512_setzero_ps(); V]; R];
        // SAFETY: the caller's promise; masked loads and stores touch n values of a row.
        unsafe {
            for (r, sums) in sums.iter_mut().enumerate() {
                for (v, sum) in sums.iter_mut().enumerate() {
                    match start {
                        Start::Zero => {}
                        Start::Bias(bias) => {
                            *sum = _mm512_maskz_loadu_ps(mask(v), bias.as_ptr().add(v * LANES));
                        }
                        Start::Add => {
                            let held = out.add(r * s.out_stride + v * LANES);
                            *sum = _mm512_maskz_loadu_ps(mask(v), held);
                        }
                    }
                }
            }
            for k in 0..s.k {
                let row = b.add(k * s.b_stride);
                let mut columns = [_mm512_setzero_ps(); V];
                for (v, c) in columns.iter_mut().enumerate() {
                    *c = _mm512_loadu_ps(row.add(v * LANES));
                }
                for (r, sums) in sums.iter_mut().enumerate() {
                    let value = _mm512_set1_ps(*a.add(r * s.a_stride + k));
                    for (sum, c) in sums.iter_mut().zip(columns) {
                        *sum = _mm512_fmadd_ps(value, c, *sum);
                    }
                }
            }
            for (r, sums) in sums.iter().enumerate() {
                for (v, sum) in sums.iter().enumerate() {
                    _mm512_mask_storeu_ps(out.add(r * s.out_stride + v * LANES), mask(v), *sum);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, step: f32) -> Vec<f32> {
        (0..n).map(|i| (i as f32 * step).sin()).collect()
    }

    /// Row 17 of the extremes table: odd sizes and wide spread, with our kernel and without, against f64 sums.
    #[test]
    fn row_17_panels() {
        for [m, n, k] in [
            [1, 1, 1],
            [3, 5, 31],
            [17, 50, 33],
            [8, 48, 20_000],
            [2, 17, 100_000],
            [13, 625, 48],
            [25, 144, 192],
        ] {
            let (mut a, b) = (wave(m * k, 0.37), wave(k * n, 0.73));
            for (i, v) in a.iter_mut().enumerate() {
                *v *= [1e18, 1e-18, 1.0, 1e-40][i % 4];
            }
            let bias = wave(n, 0.11);
            let panels = Panels::new(View::rows(&b, n), k, n);
            assert!((0..k * n).all(|i| panels.at(i / n, i % n) == b[i]));
            let mut out = vec![f32::NAN; m * n];
            panels.multiply(&a, k, [m, 0, k], Start::Bias(&bias), &mut out, n);
            let mut twice = out.clone();
            panels.multiply(&a, k, [m, 0, k], Start::Add, &mut twice, n);
            // The way without AVX-512.
            let mut other = vec![f32::NAN; m * n];
            for first in (0..n).step_by(PANEL) {
                let b = &panels.values()[first * k..];
                let (wide, columns) = (width(n, first), PANEL.min(n - first));
                let start = Start::Bias(&bias[first..]);
                plain(&a, k, b, wide, [m, columns, k], start, &mut other[first..], n);
            }
            for (at, found) in out.iter().enumerate() {
                let terms = (0..k).map(|i| f64::from(a[at / n * k + i]) * f64::from(b[i * n + at % n]));
                let (sum, size) = terms.fold((0.0, 0.0), |(s, z), t| (s + t, z + t.abs()));
                // K eps32 sum |a b|: the bias is one more term; products below the least normal number may go.
                let held = f64::from(bias[at % n]);
                let tolerance = (k + 1) as f64 * f64::from(f32::EPSILON) * (size + held.abs()) + 1e-37;
                assert!(
                    (f64::from(*found) - sum - held).abs() <= tolerance,
                    "{m}x{n}x{k} at {at}"
                );
                assert!(
                    (f64::from(other[at]) - sum - held).abs() <= tolerance,
                    "plain, at {at}"
                );
                assert!((f64::from(twice[at]) - 2.0 * sum - held).abs() <= 2.0 * tolerance);
            }
            // A row alone is bit for bit the row among others; a product in two parts of k the whole.
            let mut alone = vec![f32::NAN; n];
            panels.multiply(&a[(m - 1) * k..], k, [1, 0, k], Start::Bias(&bias), &mut alone, n);
            if !ours() {
                continue;
            }
            assert_eq!(alone, out[(m - 1) * n..]);
            if k > 1 {
                let mut parts = vec![f32::NAN; m * n];
                panels.multiply(&a, k, [m, 0, k / 2], Start::Bias(&bias), &mut parts, n);
                panels.multiply(&a[k / 2..], k, [m, k / 2, k - k / 2], Start::Add, &mut parts, n);
                assert_eq!(parts, out);
            }
        }
    }
}
