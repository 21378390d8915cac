//! The front: settings that no other setting beats in time and error at once.

use super::interval::Interval;

/// A setting as a point in time and error.
#[derive(Clone, Copy, Debug)]
pub struct TradePoint {
    /// Wall time, s.
    pub wall_s: Interval,
    /// Error, in a unit common to all settings.
    pub error: Interval,
}

impl TradePoint {
    /// True if `self` is no worse in time and error, and better in one of them by more than the intervals.
    fn beats(&self, other: &Self) -> bool {
        let faster = self.wall_s.below(&other.wall_s);
        let nearer = self.error.below(&other.error);
        let (time, error) = (
            self.wall_s.median <= other.wall_s.median,
            self.error.median <= other.error.median,
        );
        (faster && error) || (nearer && time)
    }
}

/// For each setting, true if none beats it. A setting with an infinite error is never on the front.
pub fn front(points: &[TradePoint]) -> Vec<bool> {
    points
        .iter()
        .map(|p| p.error.median.is_finite() && !points.iter().any(|q| q.beats(p)))
        .collect()
}

/// Area between the front and a corner that every useful setting is better than, in log10 of time times error: larger
/// is better. Errors are taken as they are, and times by their logarithm, as the slider shows them.
pub fn hypervolume(points: &[TradePoint], worst_s: f64, worst_error: f64) -> f64 {
    let mut of: Vec<(f64, f64)> = points
        .iter()
        .map(|p| (p.wall_s.median, p.error.median))
        .filter(|(s, e)| *s > 0.0 && *s < worst_s && *e < worst_error)
        .collect();
    of.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let (mut area, mut lowest) = (0.0, worst_error);
    for (s, e) in of {
        if e < lowest {
            area += (worst_s / s).log10() * (lowest - e);
            lowest = e;
        }
    }
    area
}

/// The setting that lies nearest to the best time and the best error at once, both as shares of what the front spans
/// (times by logarithm): the default of a slider. `None` for no points.
pub fn knee(points: &[TradePoint]) -> Option<usize> {
    let log_s = |p: &TradePoint| p.wall_s.median.max(1e-9).ln();
    let span = |of: &dyn Fn(&TradePoint) -> f64| {
        let values = points.iter().map(of);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        (low, (high - low).max(1e-12))
    };
    let error = |p: &TradePoint| p.error.median;
    let ((s0, s), (e0, e)) = (span(&log_s), span(&error));
    let far = |p: &TradePoint| ((log_s(p) - s0) / s).hypot((error(p) - e0) / e);
    (0..points.len()).min_by(|a, b| far(&points[*a]).total_cmp(&far(&points[*b])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: f64, e: f64, half: f64) -> TradePoint {
        let interval = |v: f64| Interval {
            median: v,
            low: v * (1.0 - half),
            high: v * (1.0 + half),
            n: 9,
        };
        TradePoint {
            wall_s: interval(s),
            error: interval(e),
        }
    }

    #[test]
    fn only_clear_losers_leave_the_front() {
        let points = [
            at(0.1, 9.0, 0.05),
            at(0.2, 4.0, 0.05),
            at(0.4, 4.1, 0.05),  // slower and no better
            at(0.21, 4.1, 0.05), // about the same as the second
            at(1.0, 1.0, 0.05),
            at(1.0, f64::INFINITY, 0.05),
        ];
        assert_eq!(front(&points), [true, true, false, true, true, false]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn more_points_never_shrink_the_volume() {
        let points = [at(0.1, 9.0, 0.0), at(0.2, 4.0, 0.0), at(1.0, 1.0, 0.0)];
        let all = hypervolume(&points, 10.0, 10.0);
        for left_out in 0..3 {
            let some: Vec<_> = (0..3).filter(|i| *i != left_out).map(|i| points[i]).collect();
            assert!(hypervolume(&some, 10.0, 10.0) < all);
        }
        let by_hand = 100f64.log10() * 1.0 + 50f64.log10() * 5.0 + 10f64.log10() * 3.0;
        assert!((all - by_hand).abs() < 1e-12);
        assert_eq!(
            hypervolume(&[at(20.0, 1.0, 0.0), at(1.0, f64::NAN, 0.0)], 10.0, 10.0),
            0.0
        );
        assert_eq!(knee(&points), Some(1));
        assert_eq!(knee(&[]), None);
    }
}
