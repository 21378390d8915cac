//! The kernel for AVX-512.

use std::arch::x86_64::{
    __m512, _mm512_fmadd_ps, _mm512_loadu_ps, _mm512_mask_storeu_ps, _mm512_maskz_loadu_ps, _mm512_set1_ps,
    _mm512_setzero_ps,
};

use super::{InitialSum, LANES, Sizes};

/// Rows that are computed together: 8 x 3 accumulators leave room in 32 registers.
const ROWS: usize = 8;

/// `m` rows of a product.
///
/// # Safety
/// AVX-512F; m rows of a and out, k of b (to a whole number of sixteens) and n of the bias must be valid.
#[target_feature(enable = "avx512f")]
pub unsafe fn rows(m: usize, s: &Sizes, a: *const f32, b: *const f32, start: InitialSum<'_>, out: *mut f32) {
    for row in (0..m).step_by(ROWS) {
        // SAFETY: handed on, for these rows.
        unsafe {
            let (a, out) = (a.add(row * s.a_stride), out.add(row * s.out_stride));
            tile(ROWS.min(m - row), s, a, b, start, out);
        }
    }
}

/// Up to eight rows of a product.
///
/// # Safety
/// As for [`rows`].
#[target_feature(enable = "avx512f")]
unsafe fn tile(rows: usize, s: &Sizes, a: *const f32, b: *const f32, start: InitialSum<'_>, out: *mut f32) {
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
    start: InitialSum<'_>,
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
                    InitialSum::Zero => {}
                    InitialSum::Bias(bias) => {
                        *sum = _mm512_maskz_loadu_ps(mask(v), bias.as_ptr().add(v * LANES));
                    }
                    InitialSum::Add => {
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
