//! Quantiles and medians, with one definition for every figure.
//!
//! An empty list has no quantile: NaN. A NaN among the values counts as greater than every number (a negative NaN as
//! less), so a few of them shift a quantile by their ranks only.

/// Sorted values, for several quantiles of the same list.
#[derive(Clone, Debug, Default)]
pub struct Sorted(Vec<f64>);

impl Sorted {
    /// Sorts the values.
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        Self(values)
    }

    /// The values in rising order.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// The smallest value that at least the share `q` of the values do not exceed (nearest rank); `q` is clamped to 0
    /// to 1. It is one of the values; NaN for an empty list, or if `q` is NaN.
    pub fn quantile(&self, q: f64) -> f64 {
        if q.is_nan() {
            return f64::NAN;
        }
        let rank = (q.clamp(0.0, 1.0) * self.0.len() as f64).ceil() as usize;
        self.0.get(rank.max(1) - 1).copied().unwrap_or(f64::NAN)
    }

    /// The middle value, or the mean of the two middle ones (so for an even number of values it differs from
    /// `quantile(0.5)`, which is the lower of the two). NaN for an empty list.
    pub fn median(&self) -> f64 {
        match self.0.len() {
            0 => f64::NAN,
            n if n % 2 == 1 => self.0[n / 2],
            n => (self.0[n / 2 - 1] + self.0[n / 2]) / 2.0,
        }
    }
}

/// [`Sorted::quantile`] of values in any order.
pub fn quantile(values: &[f64], q: f64) -> f64 {
    Sorted::new(values.iter().copied()).quantile(q)
}

/// [`Sorted::median`] of values in any order.
pub fn median(values: &[f64]) -> f64 {
    Sorted::new(values.iter().copied()).median()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[3.0, 1.0, 2.0, 10.0]), 2.5);
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let sorted = Sorted::new(hundred.iter().copied());
        for (q, value) in [
            (0.0, 1.0),
            (0.005, 1.0),
            (0.5, 50.0),
            (0.95, 95.0),
            (1.0, 100.0),
            (7.0, 100.0),
            (-1.0, 1.0),
        ] {
            assert_eq!((quantile(&hundred, q), sorted.quantile(q)), (value, value), "{q}");
        }
        assert_eq!(sorted.median(), 50.5);
        assert_eq!(
            (quantile(&[7.0], 0.0), quantile(&[7.0], 1.0), median(&[7.0])),
            (7.0, 7.0, 7.0)
        );
    }

    #[test]
    fn nothing_and_nan() {
        assert!(median(&[]).is_nan() && quantile(&[], 0.5).is_nan());
        assert!(quantile(&[1.0, 2.0], f64::NAN).is_nan());
        let some = [f64::NAN, 1.0, f64::INFINITY, 2.0];
        assert_eq!(
            (quantile(&some, 0.5), quantile(&some, 0.75)),
            (2.0, f64::INFINITY)
        );
        assert!(quantile(&some, 1.0).is_nan());
        assert_eq!(median(&[f64::NAN, 1.0, 2.0]), 2.0);
        assert_eq!(quantile(&[-f64::NAN, 1.0], 1.0), 1.0);
        // Zero has two signs, and keeps them.
        assert!(quantile(&[0.0, -0.0], 0.0).is_sign_negative());
    }
}
