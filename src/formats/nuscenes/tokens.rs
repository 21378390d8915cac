//! Keys of rows: 32 hexadecimal digits, equal for equal scenes.

use scene::Scene;
use scene::draw::hash;

/// Makes tokens of a scene's seed and name.
#[derive(Clone, Copy, Debug)]
pub struct Tokens {
    base: u64,
}

impl Tokens {
    /// The tokens of a scene.
    pub fn from_scene(scene: &Scene) -> Self {
        Self {
            base: hash(scene.seed ^ of_text(&scene.name)),
        }
    }

    /// The token of row `index` of a table.
    pub fn token(&self, table: &str, index: u64) -> String {
        let high = hash(hash(self.base ^ of_text(table)) ^ index);
        let low = hash(high ^ hash(index));
        format!("{high:016x}{low:016x}")
    }
}

fn of_text(text: &str) -> u64 {
    text.bytes().fold(0, |word, byte| hash(word ^ u64::from(byte)))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn tokens_are_hexadecimal_their_own_and_the_same_again() {
        let scene = crate::table_tests::scene();
        let (a, again) = (Tokens::from_scene(&scene), Tokens::from_scene(&scene));
        let mut seen = BTreeSet::new();
        for table in ["sample", "ego_pose"] {
            for index in 0..1000 {
                let token = a.token(table, index);
                assert_eq!(token, again.token(table, index));
                assert!(token.len() == 32 && token.bytes().all(|b| b.is_ascii_hexdigit()));
                assert!(seen.insert(token), "{table} {index} twice");
            }
        }
        let mut other = scene.clone();
        other.seed += 1;
        assert!(!seen.contains(&Tokens::from_scene(&other).token("sample", 0)));
    }
}
