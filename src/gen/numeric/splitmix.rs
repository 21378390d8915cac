//! Sequential random draws: SplitMix64 (Steele, Lea and Flood 2014), tiny, fast, good enough to place trees.
//!
//! [`Draw`] is for the worlds: one small stream per concern, so that a change in one place (one more bush) does not
//! reshuffle another (the cars). [`SplitMix64`] is the bare generator.

use std::cell::Cell;

/// Increment of the state with every number: the golden ratio, odd.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser: flipping one bit of the word flips about half of the bits.
fn finalise(word: u64) -> u64 {
    let mut z = word;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A hash of one word: the first number of the stream that starts from it.
pub fn hash(word: u64) -> u64 {
    finalise(word.wrapping_add(GAMMA))
}

/// The upper 53 bits as a number in 0..1.
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// The bare generator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GAMMA);
        finalise(self.0)
    }

    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        unit(self.bits())
    }

    /// One of 0..n by the remainder, which prefers small numbers by at most n / 2^64; 0 when n is 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }
}

/// Number `index` of the stream of seed 0, counted from 1, uniform in 0..1: a scatter without a state.
pub fn scatter(index: u64) -> f64 {
    unit(finalise(index.wrapping_mul(GAMMA)))
}

/// A stream of draws for one concern.
#[derive(Clone, Debug)]
pub struct Draw(SplitMix64);

impl Draw {
    /// The stream of `seed` for one `concern`; different concerns give unrelated streams.
    pub fn new(seed: u64, concern: &str) -> Self {
        let name = concern.bytes().fold(0u64, |h, b| hash(h ^ u64::from(b)));
        // (one step ahead: worlds and trained networks depend on these exact numbers)
        Self(SplitMix64(hash(seed ^ name).wrapping_add(GAMMA)))
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.bits()
    }

    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0.unit()
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

/// Noise at many places one after another: the corners of the last square of the lattice are kept.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of the reference implementation (Vigna, splitmix64.c) for seed 1234567.
    #[test]
    fn known_answers() {
        let mut stream = SplitMix64::new(1_234_567);
        let found = [0; 5].map(|_| stream.bits());
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(found, expected);
        assert_eq!(hash(1_234_567), expected[0]);
        let mut zero = SplitMix64::new(0);
        assert!((1..20).all(|i| scatter(i) == zero.unit()));
        assert_eq!(SplitMix64::new(3).below(0), 0);
    }

    /// The draws of a concern are those with which worlds were made for the trained networks.
    #[test]
    fn draws_stay_what_they_were() {
        for (seed, concern) in [(0, ""), (7, "cars"), (u64::MAX, "bushes")] {
            let name = concern.bytes().fold(0u64, |h, b| hash(h ^ u64::from(b)));
            let (mut draw, mut state) = (Draw::new(seed, concern), hash(seed ^ name));
            for _ in 0..10 {
                state = state.wrapping_add(GAMMA);
                assert_eq!(draw.bits(), hash(state));
            }
        }
        let mut draw = Draw::new(7, "cars");
        assert_eq!([0; 3].map(|_| draw.bits()), DRAWN);
    }

    /// Numbers from the commit before the generators were merged.
    const DRAWN: [u64; 3] = [
        15_942_172_136_308_383_990,
        11_755_036_119_052_946_428,
        11_092_742_837_334_976_693,
    ];
}
