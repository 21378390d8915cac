//! The seed that the user set for generation.

/// Setting of the seed for generation on request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeedWish {
    /// The seed; the scene's seed if `None`.
    pub value: Option<u64>,
    /// True if each request draws another seed.
    pub another: bool,
}

impl SeedWish {
    /// Largest seed that is drawn.
    pub const MOST: u64 = 999_999;

    /// The seed to use for a scene.
    pub fn seed_for(&self, scene_seed: u64) -> u64 {
        self.value.unwrap_or(scene_seed)
    }

    /// Draws another seed.
    pub fn roll(&mut self) {
        let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let nanos = since.map_or(1, |d| d.as_nanos() as u64);
        // (mixed, since a slow clock gives similar values twice)
        let mixed = nanos.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29) % Self::MOST;
        self.value = match self.value == Some(mixed) {
            true => Some(mixed + 1),
            false => Some(mixed),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_is_the_scenes_own_until_one_is_wanted() {
        let mut seed = SeedWish::default();
        assert_eq!(seed.seed_for(5), 5);
        let mut drawn = std::collections::BTreeSet::new();
        for _ in 0..20 {
            let before = seed.value;
            seed.roll();
            assert_ne!(seed.value, before);
            drawn.insert(seed.seed_for(5));
        }
        assert!(
            drawn.len() > 2 && drawn.iter().all(|n| *n <= SeedWish::MOST),
            "{drawn:?}"
        );
    }
}
