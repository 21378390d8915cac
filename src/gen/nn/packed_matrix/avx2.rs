//! The kernel for AVX2 with fused multiply-add: the sums of AVX-512's, in the same order.

use std::arch::x86_64::{__m256, _mm256_broadcast_ss, _mm256_fmadd_ps, _mm256_loadu_ps, _mm256_storeu_ps};

use super::{InitialSum, LANES, Sizes};

/// Rows that are computed together: 6 x 2 accumulators leave room in 16 registers.
const ROWS: usize = 6;
/// Numbers of a vector; two vectors make a sixteen.
const HALF: usize = LANES / 2;

/// `m` rows of a product.
///
/// # Safety
/// AVX2 and FMA; m rows of a and out, k of b (to a whole number of sixteens) and n of the bias must be valid.
#[target_feature(enable = "avx2,fma")]
pub unsafe fn rows(m: usize, s: &Sizes, a: *const f32, b: *const f32, start: InitialSum<'_>, out: *mut f32) {
    for row in (0..m).step_by(ROWS) {
        let at = |r: usize| [row + r, row + r];
        // SAFETY: handed on, for these rows.
        unsafe { some(ROWS.min(m - row), at, s, a, b, start, out) };
    }
}

/// `out[to] += a[from] b` for each pair `[to, from]` of rows.
///
/// # Safety
/// AVX2 and FMA; the rows of every pair and k rows of b (to a whole number of sixteens) must be valid.
#[target_feature(enable = "avx2,fma")]
pub unsafe fn pairs(pairs: &[[u32; 2]], s: &Sizes, a: *const f32, b: *const f32, out: *mut f32) {
    for pairs in pairs.chunks(ROWS) {
        let at = |r: usize| pairs[r].map(|row| row as usize);
        // SAFETY: handed on, for these rows.
        unsafe { some(pairs.len(), at, s, a, b, InitialSum::Add, out) };
    }
}

/// Up to six rows; `at` gives the row of `out` and that of `a`.
#[target_feature(enable = "avx2,fma")]
#[inline]
unsafe fn some(
    rows: usize,
    at: impl Fn(usize) -> [usize; 2],
    s: &Sizes,
    a: *const f32,
    b: *const f32,
    start: InitialSum<'_>,
    out: *mut f32,
) {
    macro_rules! of {
        ($rows:literal) => {{
            // SAFETY: the caller's promise.
            let from: [*const f32; $rows] = std::array::from_fn(|r| unsafe { a.add(at(r)[1] * s.a_stride) });
            // SAFETY: the same.
            let to: [*mut f32; $rows] = std::array::from_fn(|r| unsafe { out.add(at(r)[0] * s.out_stride) });
            // SAFETY: handed on.
            unsafe { tile(s, from, b, start, to) }
        }};
    }
    match rows {
        1 => of!(1),
        2 => of!(2),
        3 => of!(3),
        4 => of!(4),
        5 => of!(5),
        _ => of!(6),
    }
}

/// Rows `from` of a times b, into rows `to`, sixteen columns at a time.
#[target_feature(enable = "avx2,fma")]
#[inline]
unsafe fn tile<const R: usize>(
    s: &Sizes,
    from: [*const f32; R],
    b: *const f32,
    start: InitialSum<'_>,
    to: [*mut f32; R],
) {
    for first in (0..s.n).step_by(LANES) {
        let columns = LANES.min(s.n - first);
        let mut rows = [[0.0_f32; LANES]; R];
        // SAFETY: n values of the bias and of every row are valid, of which these are `columns`; k rows of b are to a
        // whole number of sixteens.
        unsafe {
            for (row, to) in rows.iter_mut().zip(&to) {
                let held = match start {
                    InitialSum::Zero => continue,
                    InitialSum::Bias(bias) => bias.as_ptr().add(first),
                    InitialSum::Add => to.add(first).cast_const(),
                };
                row.as_mut_ptr().copy_from_nonoverlapping(held, columns);
            }
            let mut sums: [[__m256; 2]; R] = rows
                .each_ref()
                .map(|r| [_mm256_loadu_ps(r.as_ptr()), _mm256_loadu_ps(r.as_ptr().add(HALF))]);
            for k in 0..s.k {
                let b = b.add(k * s.b_stride + first);
                let columns = [_mm256_loadu_ps(b), _mm256_loadu_ps(b.add(HALF))];
                for (from, sums) in from.iter().zip(&mut sums) {
                    let value = _mm256_broadcast_ss(&*from.add(k));
                    sums[0] = _mm256_fmadd_ps(value, columns[0], sums[0]);
                    sums[1] = _mm256_fmadd_ps(value, columns[1], sums[1]);
                }
            }
            for ((row, sums), to) in rows.iter_mut().zip(&sums).zip(&to) {
                _mm256_storeu_ps(row.as_mut_ptr(), sums[0]);
                _mm256_storeu_ps(row.as_mut_ptr().add(HALF), sums[1]);
                to.add(first).copy_from_nonoverlapping(row.as_ptr(), columns);
            }
        }
    }
}
