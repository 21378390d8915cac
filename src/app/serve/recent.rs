//! A few values that were used last.

use std::sync::{Mutex, PoisonError};

/// The values used last, by key; those that were not used for longest go first. A panic elsewhere leaves it usable.
pub struct Recent<K, V> {
    most: usize,
    /// The one used last comes last.
    kept: Mutex<Vec<(K, V)>>,
}

impl<K: PartialEq, V: Clone> Recent<K, V> {
    /// Keeps at most `most` values, at least one.
    pub fn new(most: usize) -> Self {
        Self {
            most: most.max(1),
            kept: Mutex::default(),
        }
    }

    /// The value of a key, if it is kept.
    pub fn get(&self, key: &K) -> Option<V> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let place = kept.iter().position(|(of, _)| of == key)?;
        let found = kept.remove(place);
        let value = found.1.clone();
        kept.push(found);
        Some(value)
    }

    /// Keeps a value.
    pub fn put(&self, key: K, value: V) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|(of, _)| *of != key);
        // Room is made first, so that there are never more.
        let over = (kept.len() + 1).saturating_sub(self.most);
        kept.drain(..over);
        kept.push((key, value));
    }

    /// How many are kept.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_used_for_longest_goes() {
        let recent = Recent::new(2);
        recent.put(1, "one");
        recent.put(2, "two");
        assert_eq!(recent.get(&1), Some("one"));
        recent.put(3, "three");
        assert_eq!(recent.get(&2), None);
        assert_eq!((recent.get(&1), recent.get(&3)), (Some("one"), Some("three")));
        recent.put(3, "again");
        assert_eq!((recent.len(), recent.get(&3)), (2, Some("again")));
    }
}
