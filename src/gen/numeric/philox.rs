//! Random draws without a state: every number is a function of (seed, where it is used).
//!
//! Philox4x32-10 of Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3". A draw does not depend on the
//! thread, the order or other draws, so noise stays with its cell.

/// Purpose of a draw. Different purposes never share numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// Noise from which a whole scene is generated.
    Start = 0,
    /// Noise from which a region is inpainted, and which its surroundings show meanwhile.
    Region = 1,
    /// Position of a latent in the encoder's normal distribution.
    Encoder = 2,
    /// Noise that scenery is drawn from.
    Scenery = 3,
    /// Noise that fine latents are refined from.
    Refine = 4,
    /// Noise that camera pictures are painted from.
    Pictures = 5,
}

/// The ten-round Philox block function: four words from four counter words and two key words.
pub fn philox4x32(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    const MUL: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    let (mut c, mut k) = (counter, key);
    for _ in 0..10 {
        let (p, q) = (MUL[0] * u64::from(c[0]), MUL[1] * u64::from(c[2]));
        c = [
            (q >> 32) as u32 ^ c[1] ^ k[0],
            q as u32,
            (p >> 32) as u32 ^ c[3] ^ k[1],
            p as u32,
        ];
        k = [k[0].wrapping_add(WEYL[0]), k[1].wrapping_add(WEYL[1])];
    }
    c
}

/// A uniform number of (0, 1], from the upper 53 bits; never 0, so that its logarithm is finite.
fn open_unit(bits: u64) -> f64 {
    ((bits >> 11) + 1) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Box-Muller from one Philox block.
fn normal_of_bits(u: u64, v: u64) -> f64 {
    let radius = (-2.0 * open_unit(u).ln()).sqrt();
    radius * (std::f64::consts::TAU * open_unit(v)).cos()
}

/// One standard normal number, fixed by the seed, its purpose, latent cell, channel and step.
/// Always finite and below 9 in magnitude.
pub fn normal(seed: u64, stream: Stream, cell: u32, channel: u32, step: u32) -> f64 {
    let key = [seed as u32, (seed >> 32) as u32];
    let [a, b, c, d] = philox4x32([cell, channel, step, stream as u32], key);
    let join = |hi: u32, lo: u32| u64::from(hi) << 32 | u64::from(lo);
    normal_of_bits(join(a, b), join(c, d))
}

/// Standard normal noise `[cells][channels]`, channel last, at step 0.
pub fn normal_field(seed: u64, stream: Stream, cells: usize, channels: usize) -> Vec<f64> {
    (0..cells * channels)
        .map(|i| normal(seed, stream, (i / channels) as u32, (i % channels) as u32, 0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    /// Known answers published with Random123 (`kat_vectors`, philox4x32 10).
    #[test]
    fn philox_known_answers() {
        assert_eq!(
            philox4x32([0; 4], [0; 2]),
            [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]
        );
        assert_eq!(
            philox4x32([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox4x32(
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0]
            ),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    /// Row 28 of the extremes table: any thread count and any order give the same bits.
    #[test]
    fn row_28_counter_based() {
        for seed in [0, 1, u64::MAX] {
            let serial = normal_field(seed, Stream::Start, 2500, 8);
            for threads in [1, 2, 16] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .expect("a pool");
                let parallel: Vec<f64> = pool.install(|| {
                    (0..20_000u32)
                        .into_par_iter()
                        .rev()
                        .map(|i| normal(seed, Stream::Start, i / 8, i % 8, 0))
                        .collect()
                });
                assert!(
                    serial
                        .iter()
                        .zip(parallel.iter().rev())
                        .all(|(a, b)| a.to_bits() == b.to_bits())
                );
            }
        }
        // Every coordinate of the counter and the key matters.
        let base = normal(7, Stream::Start, 1, 2, 3);
        for other in [
            normal(8, Stream::Start, 1, 2, 3),
            normal(7 + (1 << 32), Stream::Start, 1, 2, 3),
            normal(7, Stream::Region, 1, 2, 3),
            normal(7, Stream::Start, 2, 2, 3),
            normal(7, Stream::Start, 1, 3, 3),
            normal(7, Stream::Start, 1, 2, 4),
        ] {
            assert_ne!(base, other);
        }
    }

    /// Standard normal distribution function by integrating the density (Simpson, 1e-12 here).
    fn normal_cdf(x: f64) -> f64 {
        let (n, a) = (400, x.clamp(-9.0, 9.0));
        let h = a / f64::from(n);
        let density = |u: f64| (-0.5 * u * u).exp() / std::f64::consts::TAU.sqrt();
        let inner: f64 = (1..n)
            .map(|i| density(f64::from(i) * h) * if i % 2 == 1 { 4.0 } else { 2.0 })
            .sum();
        0.5 + (density(0.0) + inner + density(a)) * h / 3.0
    }

    /// Row 29 of the extremes table: the lowest and highest bits stay finite, and the numbers are normal
    /// (Kolmogorov-Smirnov, p > 1e-3 means sqrt(n) D < 1.949).
    #[test]
    fn row_29_normals() {
        for (u, v) in [(0, 0), (0, u64::MAX), (u64::MAX, 0), (u64::MAX, u64::MAX)] {
            let z = normal_of_bits(u, v);
            assert!(z.is_finite() && z.abs() < 9.0, "{z}");
        }
        assert!(open_unit(0) > 0.0 && open_unit(u64::MAX) == 1.0);
        for seed in [0, u64::MAX] {
            let mut z = normal_field(seed, Stream::Region, 2500, 8);
            z.sort_by(f64::total_cmp);
            let n = z.len() as f64;
            let d = z.iter().enumerate().fold(0.0f64, |d, (i, z)| {
                let f = normal_cdf(*z);
                d.max((f - i as f64 / n).abs())
                    .max(((i as f64 + 1.0) / n - f).abs())
            });
            assert!(n.sqrt() * d < 1.949, "seed {seed}: sqrt(n) D = {}", n.sqrt() * d);
        }
    }
}
