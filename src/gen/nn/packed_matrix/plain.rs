//! The kernel for all other machines: as the compiler makes it.

use super::{InitialSum, PANEL, Sizes};

/// `m` rows of a product.
///
/// # Safety
/// m rows of `a` and `out`, k of `b` and n values of the bias are valid.
pub unsafe fn rows(m: usize, s: &Sizes, a: *const f32, b: *const f32, start: InitialSum<'_>, out: *mut f32) {
    for row in 0..m {
        // SAFETY: the caller's promise, for this row.
        let (a, out) = unsafe {
            let a = std::slice::from_raw_parts(a.add(row * s.a_stride), s.k);
            (
                a,
                std::slice::from_raw_parts_mut(out.add(row * s.out_stride), s.n),
            )
        };
        let mut sums = [0.0; PANEL];
        match start {
            InitialSum::Zero => {}
            InitialSum::Bias(bias) => sums[..s.n].copy_from_slice(&bias[..s.n]),
            InitialSum::Add => sums[..s.n].copy_from_slice(out),
        }
        for (k, value) in a.iter().enumerate() {
            // SAFETY: row k of b.
            let b = unsafe { std::slice::from_raw_parts(b.add(k * s.b_stride), s.n) };
            sums.iter_mut().zip(b).for_each(|(sum, b)| *sum += value * b);
        }
        out.copy_from_slice(&sums[..s.n]);
    }
}

/// `out[to] += a[from] b` for each pair `[to, from]` of rows.
///
/// # Safety
/// As for [`rows`], of the rows of every pair.
pub unsafe fn pairs(pairs: &[[u32; 2]], s: &Sizes, a: *const f32, b: *const f32, out: *mut f32) {
    for [to, from] in pairs.iter().map(|p| p.map(|row| row as usize)) {
        // SAFETY: handed on, for this row.
        unsafe {
            rows(
                1,
                s,
                a.add(from * s.a_stride),
                b,
                InitialSum::Add,
                out.add(to * s.out_stride),
            )
        };
    }
}
