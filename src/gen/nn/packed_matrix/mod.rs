//! Matrix products against a matrix that is cut into panels beforehand: no packing per call (rates: `cargo bench
//! --bench networks`). Every number is a sum over k in rising order, whatever the number of rows, so pieces of a product
//! are bit for bit the whole. AVX-512 and AVX2 give the same bits; other machines, which do not fuse, others.
//! (The gemm crate does not promise this: its sums depend on the number of rows and on the sizes of the caches.)

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod plain;

use bytemuck::{Pod, Zeroable};

use super::int8::Int8Matrix;
use super::view::MatrixView;

/// Columns of a panel: three vectors of sixteen.
pub(super) const PANEL: usize = 3 * LANES;
pub(super) const LANES: usize = 16;

/// A cache line: a vector that begins within one is read at once.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct CacheLine([f32; LANES]);

/// Start value of a product's sums.
#[derive(Clone, Copy)]
pub enum InitialSum<'a> {
    /// Zero.
    Zero,
    /// One number per column.
    Bias(&'a [f32]),
    /// Values that the output holds.
    Add,
}

/// A matrix `[k][n]`; panel p holds k rows of its 48 columns, the last one of as many sixteens as it needs.
#[derive(Clone)]
pub struct PackedMatrix {
    data: Vec<CacheLine>,
    k: usize,
    n: usize,
}

impl PackedMatrix {
    /// Packs the first `k` rows and `n` columns of `matrix`.
    pub fn new(matrix: MatrixView<'_>, k: usize, n: usize) -> Self {
        let mut lines = vec![CacheLine([0.0; LANES]); k * n.div_ceil(LANES)];
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

    /// The matrix in eight bits.
    pub fn to_int8(&self) -> Int8Matrix {
        let rows: Vec<f32> = (0..self.k)
            .flat_map(|row| (0..self.n).map(move |column| self.at(row, column)))
            .collect();
        Int8Matrix::new(MatrixView::rows(&rows, self.n), self.k, self.n)
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
        start: InitialSum<'_>,
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
                InitialSum::Bias(bias) => InitialSum::Bias(&bias[first..]),
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
            let sizes = Sizes {
                a_stride,
                b_stride: wide,
                out_stride,
                n: columns,
                k,
            };
            // SAFETY: by the asserts every row of a pair lies inside its slice, and `b` holds k rows of a whole number
            // of sixteens.
            unsafe { Kernel::best().pairs(pairs, &sizes, a.as_ptr(), b.as_ptr(), out[first..].as_mut_ptr()) };
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
    start: InitialSum<'_>,
    out: &mut [f32],
    out_stride: usize,
) {
    assert!(m > 0 && k > 0 && (1..=PANEL).contains(&n) && out_stride >= n);
    assert!((m - 1) * a_stride + k <= a.len() && (m - 1) * out_stride + n <= out.len());
    assert!((k - 1) * b_stride + n.next_multiple_of(LANES) <= b.len());
    if let InitialSum::Bias(bias) = start {
        assert!(bias.len() >= n);
    }
    let sizes = Sizes {
        a_stride,
        b_stride,
        out_stride,
        n,
        k,
    };
    // SAFETY: by the asserts m rows of `a` and `out`, k rows of `b` up to a whole number of sixteens, and n values of the
    // bias lie inside their slices.
    unsafe { Kernel::best().rows(m, &sizes, a.as_ptr(), b.as_ptr(), start, out.as_mut_ptr()) };
}

/// Strides and sizes of a product of at most [`PANEL`] columns.
struct Sizes {
    a_stride: usize,
    b_stride: usize,
    out_stride: usize,
    n: usize,
    k: usize,
}

/// Which instructions a product is computed with.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kernel {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    Plain,
}

impl Kernel {
    /// The fastest that this machine can run.
    fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f") {
                return Self::Avx512;
            }
            if Self::has_avx2() {
                return Self::Avx2;
            }
        }
        Self::Plain
    }

    #[cfg(target_arch = "x86_64")]
    fn has_avx2() -> bool {
        std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
    }

    /// `m` rows of a product.
    ///
    /// # Safety
    /// The machine has the kernel's instructions; m rows of `a` and `out`, k of `b` (to a whole number of sixteens) and n
    /// values of the bias are valid.
    unsafe fn rows(
        self,
        m: usize,
        s: &Sizes,
        a: *const f32,
        b: *const f32,
        start: InitialSum<'_>,
        out: *mut f32,
    ) {
        // SAFETY: handed on.
        unsafe {
            match self {
                #[cfg(target_arch = "x86_64")]
                Self::Avx512 => avx512::rows(m, s, a, b, start, out),
                #[cfg(target_arch = "x86_64")]
                Self::Avx2 => avx2::rows(m, s, a, b, start, out),
                Self::Plain => plain::rows(m, s, a, b, start, out),
            }
        }
    }

    /// `out[to] += a[from] b` for each pair `[to, from]` of rows.
    ///
    /// # Safety
    /// As for [`rows`](Self::rows), of the rows of every pair.
    unsafe fn pairs(self, pairs: &[[u32; 2]], s: &Sizes, a: *const f32, b: *const f32, out: *mut f32) {
        // SAFETY: handed on.
        unsafe {
            match self {
                #[cfg(target_arch = "x86_64")]
                Self::Avx512 => avx512::pairs(pairs, s, a, b, out),
                #[cfg(target_arch = "x86_64")]
                Self::Avx2 => avx2::pairs(pairs, s, a, b, out),
                Self::Plain => plain::pairs(pairs, s, a, b, out),
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
            let packed = PackedMatrix::new(MatrixView::rows(&b, n), k, n);
            assert!((0..k * n).all(|i| packed.at(i / n, i % n) == b[i]));
            let mut out = vec![f32::NAN; m * n];
            packed.multiply(&a, k, [m, 0, k], InitialSum::Bias(&bias), &mut out, n);
            let mut twice = out.clone();
            packed.multiply(&a, k, [m, 0, k], InitialSum::Add, &mut twice, n);
            let plain = by(Kernel::Plain, &packed, &a, m, &bias);
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
                    (f64::from(plain[at]) - sum - held).abs() <= tolerance,
                    "plain, at {at}"
                );
                assert!((f64::from(twice[at]) - 2.0 * sum - held).abs() <= 2.0 * tolerance);
            }
            // A row alone is bit for bit the row among others; a product in two parts of k the whole.
            let mut alone = vec![f32::NAN; n];
            packed.multiply(
                &a[(m - 1) * k..],
                k,
                [1, 0, k],
                InitialSum::Bias(&bias),
                &mut alone,
                n,
            );
            assert_eq!(alone, out[(m - 1) * n..]);
            if k > 1 {
                let mut parts = vec![f32::NAN; m * n];
                packed.multiply(&a, k, [m, 0, k / 2], InitialSum::Bias(&bias), &mut parts, n);
                packed.multiply(
                    &a[k / 2..],
                    k,
                    [m, k / 2, k - k / 2],
                    InitialSum::Add,
                    &mut parts,
                    n,
                );
                assert_eq!(parts, out);
            }
            assert_eq!(
                by(Kernel::Plain, &packed, &a[(m - 1) * k..], 1, &bias),
                plain[(m - 1) * n..]
            );
            #[cfg(target_arch = "x86_64")]
            if Kernel::has_avx2() {
                assert_eq!(
                    by(Kernel::Avx2, &packed, &a, m, &bias),
                    out,
                    "the bits of AVX-512"
                );
            }
        }
    }

    /// Rows that are added by pairs are those of the product, with every kernel.
    #[test]
    fn row_17_pairs() {
        let (rows, k, n) = (23, 40, 70);
        let (a, b, before) = (wave(rows * k, 0.37), wave(k * n, 0.73), wave(rows * n, 0.21));
        let packed = PackedMatrix::new(MatrixView::rows(&b, n), k, n);
        let pairs: Vec<[u32; 2]> = (0..rows as u32 - 2)
            .map(|i| [i, (i * 7 + 3) % rows as u32])
            .collect();
        let mut found = before.clone();
        packed.add_pairs(&a, k, &pairs, [0, k], &mut found, n);
        let mut expected = before.clone();
        for [to, from] in pairs.iter().map(|p| p.map(|v| v as usize)) {
            packed.multiply(
                &a[from * k..],
                k,
                [1, 0, k],
                InitialSum::Add,
                &mut expected[to * n..],
                n,
            );
        }
        assert_eq!(found, expected);
        assert_eq!(found[(rows - 2) * n..], before[(rows - 2) * n..]);
        for kernel in kernels() {
            let mut out = before[..n.min(PANEL)].to_vec();
            let (columns, wide) = (out.len(), width(n, 0));
            let sizes = Sizes {
                a_stride: k,
                b_stride: wide,
                out_stride: columns,
                n: columns,
                k,
            };
            // SAFETY: one row of each, of these lengths; the machine has the kernel.
            unsafe {
                kernel.pairs(
                    &[[0, 3]],
                    &sizes,
                    a.as_ptr(),
                    packed.values().as_ptr(),
                    out.as_mut_ptr(),
                )
            };
            let close = out.iter().zip(&found).all(|(o, f)| (o - f).abs() < 1e-5);
            assert!(close, "{kernel:?}");
        }
    }

    /// The kernels that this machine can run.
    fn kernels() -> Vec<Kernel> {
        let mut all = vec![Kernel::Plain];
        #[cfg(target_arch = "x86_64")]
        if Kernel::has_avx2() {
            all.push(Kernel::Avx2);
        }
        if !all.contains(&Kernel::best()) {
            all.push(Kernel::best());
        }
        all
    }

    /// bias + a times the packed matrix, by one kernel.
    fn by(kernel: Kernel, packed: &PackedMatrix, a: &[f32], m: usize, bias: &[f32]) -> Vec<f32> {
        let (k, n) = (packed.inputs(), packed.outputs());
        let mut out = vec![f32::NAN; m * n];
        assert!(a.len() >= m * k && bias.len() >= n);
        for first in (0..n).step_by(PANEL) {
            let (b, start) = (&packed.values()[first * k..], InitialSum::Bias(&bias[first..]));
            let sizes = Sizes {
                a_stride: k,
                b_stride: width(n, first),
                out_stride: n,
                n: PANEL.min(n - first),
                k,
            };
            // SAFETY: the lengths were just asserted, a panel holds k rows, and the machine has the kernel.
            unsafe {
                kernel.rows(
                    m,
                    &sizes,
                    a.as_ptr(),
                    b.as_ptr(),
                    start,
                    out[first..].as_mut_ptr(),
                )
            };
        }
        out
    }
}
