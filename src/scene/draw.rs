//! Seeded random draws of a world: one small stream per concern, so that a change in one place
//! (one more bush) does not reshuffle another (the cars).

use std::cell::Cell;

/// A SplitMix64 stream (Steele, Lea and Flood 2014): tiny, fast, good enough to place trees.
#[derive(Clone, Debug)]
pub struct Draw(u64);

/// The SplitMix64 finaliser: a hash of one word.
pub fn hash(word: u64) -> u64 {
    let mut z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Draw {
    /// The stream of `seed` for one `concern`; different concerns give unrelated streams.
    pub fn new(seed: u64, concern: &str) -> Self {
        let name = concern.bytes().fold(0u64, |h, b| hash(h ^ u64::from(b)));
        Self(hash(seed ^ name))
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        hash(self.0)
    }

    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in `from..to`.
    pub fn range(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// True with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// One of 0..n; 0 when n is 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n.saturating_sub(1))
    }

    /// An index drawn in proportion to the weights.
    pub fn weighted(&mut self, weights: &[f64]) -> usize {
        let mut at = self.unit() * weights.iter().sum::<f64>();
        for (i, w) in weights.iter().enumerate() {
            at -= w;
            if at < 0.0 {
                return i;
            }
        }
        weights.len().saturating_sub(1)
    }
}

/// Smooth noise in -1..1 with features of about one unit: bilinear blend of hashed lattice values.
pub fn noise(seed: u64, x: f64, y: f64) -> f64 {
    Noise::new(seed).at(x, y)
}

/// The same noise for many places one after another: the corners of the last square of the lattice are kept.
pub struct Noise {
    seed: u64,
    square: Cell<([f64; 2], [f64; 4])>,
}

impl Noise {
    /// The noise of a seed.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            square: Cell::new(([f64::NAN; 2], [0.0; 4])),
        }
    }

    /// Its value at a place.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let (fx, fy) = (x.floor(), y.floor());
        let (mut of, mut corners) = self.square.get();
        if of != [fx, fy] {
            let corner = |dx: i64, dy: i64| {
                let (ix, iy) = ((fx as i64).wrapping_add(dx), (fy as i64).wrapping_add(dy));
                let h = hash(self.seed ^ hash(ix as u64 ^ hash(iy as u64)));
                (h >> 11) as f64 / (1u64 << 52) as f64 - 1.0
            };
            (of, corners) = ([fx, fy], [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)]);
            self.square.set((of, corners));
        }
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (smooth(x - fx), smooth(y - fy));
        let low = corners[0] * (1.0 - u) + corners[1] * u;
        let high = corners[2] * (1.0 - u) + corners[3] * u;
        low * (1.0 - v) + high * v
    }
}
