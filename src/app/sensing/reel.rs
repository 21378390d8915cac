//! Results for moments of a clip that were made while it played: the next time they are shown at once.

use std::collections::BTreeMap;

/// Most memory that they take, bytes: some 1,000 pictures of 240 x 135 px.
const MOST_BYTES: usize = 256 << 20;

/// A moment of a clip, in microseconds.
pub(super) type Moment = i64;

/// The moment at a time, s.
pub(super) fn moment(time_s: f64) -> Moment {
    (time_s * 1e6).round() as Moment
}

/// Results of type `V` of the moments of one scene, for several sensors each. `K` is what decides them besides moment and sensor;
/// results of another key take the place of all.
pub(super) struct Reel<K, V> {
    key: Option<K>,
    kept: BTreeMap<(Moment, usize), (V, usize)>,
    bytes: usize,
    most_bytes: usize,
}

impl<K, V> Default for Reel<K, V> {
    fn default() -> Self {
        Self {
            key: None,
            kept: BTreeMap::new(),
            bytes: 0,
            most_bytes: MOST_BYTES,
        }
    }
}

impl<K: PartialEq, V: Clone> Reel<K, V> {
    /// The result of a sensor at a moment.
    pub fn get(&self, key: &K, at: Moment, sensor: usize) -> Option<&V> {
        let kept = self.kept.get(&(at, sensor));
        kept.filter(|_| self.key.as_ref() == Some(key))
            .map(|(value, _)| value)
    }

    /// Keeps a result of so many bytes. Where there is no room, moments farthest from this one go first.
    pub fn put(&mut self, key: K, (at, sensor): (Moment, usize), value: V, bytes: usize) {
        if self.key.as_ref() != Some(&key) {
            *self = Self {
                key: Some(key),
                most_bytes: self.most_bytes,
                ..Self::default()
            };
        }
        if let Some((_, before)) = self.kept.insert((at, sensor), (value, bytes)) {
            self.bytes -= before;
        }
        self.bytes += bytes;
        while self.bytes > self.most_bytes && self.kept.len() > 1 {
            let ends = [self.kept.keys().next(), self.kept.keys().next_back()];
            let Some(farthest) = ends
                .into_iter()
                .flatten()
                .max_by_key(|(m, _)| m.abs_diff(at))
                .copied()
            else {
                return;
            };
            if let Some((_, freed)) = self.kept.remove(&farthest) {
                self.bytes -= freed;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_another_scene_are_never_given_and_far_moments_go_first() {
        let mut reel = Reel {
            most_bytes: 50,
            ..Reel::default()
        };
        for (i, second) in [0.0, 0.1, 0.2, 0.3, 0.4].into_iter().enumerate() {
            reel.put("scene", (moment(second), 1), i, 10);
        }
        assert_eq!(reel.get(&"scene", moment(0.1 + 0.2), 1), Some(&3));
        assert_eq!(reel.get(&"other", moment(0.3), 1), None);
        assert_eq!(reel.get(&"scene", moment(0.3), 0), None);
        reel.put("scene", (moment(0.3), 0), 9, 20);
        let left = [0.0, 0.1, 0.2, 0.3, 0.4].map(|s| reel.get(&"scene", moment(s), 1).copied());
        assert_eq!(left, [None, None, Some(2), Some(3), Some(4)]);
        // The same again takes the place of what was there.
        reel.put("scene", (moment(0.3), 0), 8, 20);
        assert_eq!((reel.get(&"scene", moment(0.3), 0), reel.bytes), (Some(&8), 50));
        reel.put("other", (moment(0.3), 1), 5, 10);
        assert_eq!((reel.get(&"scene", moment(0.3), 1), reel.bytes), (None, 10));
    }
}
