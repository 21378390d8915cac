//! Fits few keyframes to a motion.

use super::motion::{Key, at_keys};

/// Largest distance between a fitted motion and the poses that it was fitted to, m.
const OFF_M: f64 = 0.12;
/// Largest difference in heading between them, rad.
const OFF_RAD: f64 = 0.02;

/// The keyframes among `poses` (in order of time) that reproduce the others within the limits. The first and the last
/// pose are among them; keys are added where the error is largest, until no pose is out of bounds.
pub(super) fn fitted(poses: &[Key]) -> Vec<Key> {
    let Some(last) = poses.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut chosen = if last == 0 { vec![0] } else { vec![0, last] };
    loop {
        let keys: Vec<Key> = chosen.iter().map(|i| poses[*i]).collect();
        let worst = chosen.array_windows::<2>().filter_map(|[a, b]| {
            let off = |i: usize| (off(&keys, &poses[i]), i);
            let farthest = (a + 1..*b).map(off).max_by(|x, y| x.0.total_cmp(&y.0))?;
            (farthest.0 > 1.0).then_some(farthest)
        });
        let worst: Vec<(f64, usize)> = worst.collect();
        let most = worst.iter().map(|(off, _)| *off).fold(0.0, f64::max);
        if worst.is_empty() {
            return keys;
        }
        // A key changes the slopes at its neighbours, so gaps with a small error may come within bounds without a key
        // of their own.
        chosen.extend(
            worst
                .iter()
                .filter(|(off, _)| *off >= most / 2.0)
                .map(|(_, i)| *i),
        );
        chosen.sort_unstable();
    }
}

/// Distance of a pose from the motion of the keys; 1 is the largest that is allowed.
fn off(keys: &[Key], pose: &Key) -> f64 {
    let Some(found) = at_keys(keys, pose.time_s) else {
        return f64::INFINITY;
    };
    let turn = (found.yaw_rad - pose.yaw_deg.to_radians()).sin().abs();
    (found.at_m.distance(pose.at_m) / OFF_M).max(turn / OFF_RAD)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn poses(at: impl Fn(f64) -> DVec2) -> Vec<Key> {
        let key = |i: u32| Key {
            time_s: f64::from(i) * 0.1,
            at_m: at(f64::from(i) * 0.1),
            yaw_deg: 0.0,
        };
        (0..=80).map(key).collect()
    }

    #[test]
    fn a_steady_drive_is_two_keys_and_a_stop_a_few() {
        assert_eq!(fitted(&[]), Vec::new());
        assert_eq!(fitted(&poses(|t| DVec2::new(10.0 * t, 0.0))).len(), 2);
        let braked = |t: f64| {
            10.0 * t.min(3.0) + 10.0 * (t - 3.0).clamp(0.0, 4.0) - 1.25 * (t - 3.0).clamp(0.0, 4.0).powi(2)
        };
        let stop = poses(|t| DVec2::new(braked(t), 0.0));
        let keys = fitted(&stop);
        assert!((3..=9).contains(&keys.len()), "{} keys", keys.len());
        assert!(stop.iter().all(|p| off(&keys, p) <= 1.0));
    }
}
