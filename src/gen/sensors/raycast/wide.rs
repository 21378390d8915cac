//! Eight integers at a time: the few operations that a packet of rays repeats most, with AVX2 where there is, and
//! for any processor. Both give the same bits.

use super::packet::{FRACTION, LANES, MARGIN};

/// The operations.
pub(super) trait Wide: Copy {
    /// Runs `work` with the instructions that this stands for.
    fn run<W: WideKernel>(self, work: W);

    /// Finds the rays that may touch an occupied height of `union`, one bit per ray. A ray climbs from `height` by
    /// `step` a slab, for `slabs` slabs, both ends widened by the margin. Bit 0 of `union` is below the grid, bit 17
    /// above it.
    fn touching(self, height: &[i32; LANES], step: &[i32; LANES], slabs: i32, union: u32) -> u8;

    /// `height` + `slabs` * `step`.
    fn climb(self, height: &mut [i32; LANES], step: &[i32; LANES], slabs: i32);

    /// Least and greatest value.
    fn bounds(self, values: &[i32; LANES]) -> (i32, i32);
}

/// Work to be run with these operations.
pub(super) trait WideKernel {
    /// Runs the work; inlined into code for the instructions of `wide`.
    fn with(self, wide: impl Wide);
}

/// Bits of the heights from `low` to `high`; bit 0 is below the grid, bit 17 above it.
#[inline(always)]
pub(super) fn heights(low: i32, high: i32) -> u32 {
    let bit = |height: i32| ((height >> FRACTION).clamp(-1, 16) + 1) as u32;
    (2u32 << bit(high)) - (1u32 << bit(low))
}

/// Runs `work` with the best instructions of this machine.
pub(super) fn run(work: impl WideKernel) {
    #[cfg(target_arch = "x86_64")]
    if let Some(v3) = pulp::x86::V3::try_new() {
        return v3.run(work);
    }
    Plain.run(work);
}

/// The operations for any processor.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Wide for Plain {
    #[inline(always)]
    fn run<W: WideKernel>(self, work: W) {
        work.with(self);
    }

    #[inline(always)]
    fn touching(self, height: &[i32; LANES], step: &[i32; LANES], slabs: i32, union: u32) -> u8 {
        let mut touching = 0;
        for lane in 0..LANES {
            let (entry, exit) = (height[lane], height[lane] + slabs * step[lane]);
            let passed = heights(entry.min(exit) - MARGIN, entry.max(exit) + MARGIN) & union;
            touching |= u8::from(passed != 0) << lane;
        }
        touching
    }

    #[inline(always)]
    fn climb(self, height: &mut [i32; LANES], step: &[i32; LANES], slabs: i32) {
        for lane in 0..LANES {
            height[lane] += slabs * step[lane];
        }
    }

    #[inline(always)]
    fn bounds(self, values: &[i32; LANES]) -> (i32, i32) {
        let low = values.iter().fold(i32::MAX, |a, b| a.min(*b));
        (low, values.iter().fold(i32::MIN, |a, b| a.max(*b)))
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::__m256i;

    use pulp::cast;
    use pulp::x86::V3;

    use super::*;

    impl Wide for V3 {
        #[inline(always)]
        fn run<W: WideKernel>(self, work: W) {
            struct VectorizedWork<W>(V3, W);
            impl<W: WideKernel> pulp::NullaryFnOnce for VectorizedWork<W> {
                type Output = ();
                #[inline(always)]
                fn call(self) {
                    self.1.with(self.0);
                }
            }
            self.vectorize(VectorizedWork(self, work));
        }

        #[inline(always)]
        fn touching(self, height: &[i32; LANES], step: &[i32; LANES], slabs: i32, union: u32) -> u8 {
            let (i, all) = (self.avx2, |v: i32| self.avx._mm256_set1_epi32(v));
            let (entry, step): (__m256i, __m256i) = (cast(*height), cast(*step));
            let exit = i._mm256_add_epi32(entry, i._mm256_mullo_epi32(step, all(slabs)));
            let low = i._mm256_sub_epi32(i._mm256_min_epi32(entry, exit), all(MARGIN));
            let high = i._mm256_add_epi32(i._mm256_max_epi32(entry, exit), all(MARGIN));
            let bit = |height: __m256i| {
                let cell = i._mm256_srai_epi32::<{ FRACTION as i32 }>(height);
                let held = i._mm256_min_epi32(i._mm256_max_epi32(cell, all(-1)), all(16));
                i._mm256_add_epi32(held, all(1))
            };
            let from = i._mm256_sllv_epi32(all(1), bit(low));
            let past = i._mm256_sllv_epi32(all(2), bit(high));
            let passed = i._mm256_and_si256(i._mm256_sub_epi32(past, from), all(union as i32));
            // Below 2^31, so that "greater than nothing" is "not nothing".
            let met = i._mm256_cmpgt_epi32(passed, all(0));
            self.avx._mm256_movemask_ps(cast(met)) as u8
        }

        #[inline(always)]
        fn climb(self, height: &mut [i32; LANES], step: &[i32; LANES], slabs: i32) {
            let by = self
                .avx2
                ._mm256_mullo_epi32(cast(*step), self.avx._mm256_set1_epi32(slabs));
            *height = cast(self.avx2._mm256_add_epi32(cast(*height), by));
        }

        #[inline(always)]
        fn bounds(self, values: &[i32; LANES]) -> (i32, i32) {
            let (i, all): (_, __m256i) = (self.avx2, cast(*values));
            let fold = |pick: &dyn Fn(__m256i, __m256i) -> __m256i| {
                let v = pick(all, i._mm256_permute2x128_si256::<1>(all, all));
                let v = pick(v, i._mm256_shuffle_epi32::<0b01_00_11_10>(v));
                let v = pick(v, i._mm256_shuffle_epi32::<0b10_11_00_01>(v));
                cast::<__m256i, [i32; LANES]>(v)[0]
            };
            (
                fold(&|a, b| i._mm256_min_epi32(a, b)),
                fold(&|a, b| i._mm256_max_epi32(a, b)),
            )
        }
    }
}
