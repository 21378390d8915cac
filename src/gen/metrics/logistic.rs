//! Logistic regression by Newton's method, and the area under the ROC curve: measures how much of an outcome a trivial
//! predictor can tell.

use numeric::linear::solve;

/// Weight of the penalty on coefficients: keeps the coefficient of a class that was never lost finite.
const RIDGE: f64 = 1e-2;
const STEPS: usize = 25;

/// Coefficients of a fit: their product with the features gives the log odds.
#[derive(Clone, Debug, PartialEq)]
pub struct Logistic(Vec<f64>);

impl Logistic {
    /// Fits rows of equal length to outcomes. One feature should be constant. `None` without rows, for rows of
    /// different length and for numbers that are not finite.
    pub fn fit(rows: &[Vec<f64>], outcomes: &[bool]) -> Option<Self> {
        let n = rows.first()?.len();
        let sound = |row: &Vec<f64>| row.len() == n && row.iter().all(|v| v.is_finite());
        if rows.len() != outcomes.len() || !rows.iter().all(sound) {
            return None;
        }
        let mut weights = vec![0.0; n];
        for _ in 0..STEPS {
            let mut gradient: Vec<f64> = weights.iter().map(|w| -RIDGE * w).collect();
            let mut curvature = vec![vec![0.0; n]; n];
            for (row, outcome) in rows.iter().zip(outcomes) {
                let p = sigmoid(dot(&weights, row));
                let gap = f64::from(u8::from(*outcome)) - p;
                let weight = (p * (1.0 - p)).max(1e-9);
                for (i, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
                    gradient[i] += gap * a;
                    for (to, b) in curvature[i].iter_mut().zip(row) {
                        *to += weight * a * b;
                    }
                }
            }
            for (i, row) in curvature.iter_mut().enumerate() {
                row[i] += RIDGE;
            }
            for (row, g) in curvature.iter_mut().zip(&gradient) {
                row.push(*g);
            }
            let step = solve(curvature)?;
            // Far from the optimum a whole step may overshoot.
            let largest = step.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            let scale = (4.0 / largest.max(4.0)).min(1.0);
            for (w, s) in weights.iter_mut().zip(&step) {
                *w += scale * s;
            }
            if largest < 1e-9 {
                break;
            }
        }
        weights.iter().all(|w| w.is_finite()).then_some(Self(weights))
    }

    /// Probability that the outcome is true.
    pub fn probability(&self, row: &[f64]) -> f64 {
        sigmoid(dot(&self.0, row))
    }
}

/// Area under the ROC curve: probability that a true outcome scores higher than a false one, with ties counted half.
/// NaN if either kind is missing.
pub fn auc(scores: &[f64], outcomes: &[bool]) -> f64 {
    let mut order: Vec<(f64, bool)> = scores.iter().copied().zip(outcomes.iter().copied()).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut below, mut wins, mut yes) = (0.0, 0.0, 0.0);
    for tied in order.chunk_by(|a, b| a.0 == b.0) {
        let hits = tied.iter().filter(|(_, outcome)| *outcome).count() as f64;
        let misses = tied.len() as f64 - hits;
        wins += hits * (below + misses / 2.0);
        below += misses;
        yes += hits;
    }
    wins / (yes * below)
}

fn sigmoid(v: f64) -> f64 {
    1.0 / (1.0 + (-v).exp())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use world::draw::Draw;

    #[test]
    fn known_odds_are_found_again() {
        let mut draw = Draw::new(1, "logistic");
        let (mut rows, mut outcomes) = (Vec::new(), Vec::new());
        for _ in 0..20_000 {
            let (x, kind) = (draw.range(-2.0, 2.0), f64::from(u8::from(draw.chance(0.3))));
            rows.push(vec![1.0, x, kind]);
            outcomes.push(draw.chance(sigmoid(-1.0 + 1.5 * x - 0.7 * kind)));
        }
        let fit = Logistic::fit(&rows, &outcomes).expect("a fit");
        for (found, real) in fit.0.iter().zip([-1.0, 1.5, -0.7]) {
            assert!((found - real).abs() < 0.1, "{found} {real}");
        }
        let scores: Vec<f64> = rows.iter().map(|r| fit.probability(r)).collect();
        let found = auc(&scores, &outcomes);
        assert!((0.8..0.9).contains(&found), "{found}");
        let blind: Vec<f64> = rows.iter().map(|_| draw.unit()).collect();
        assert!((auc(&blind, &outcomes) - 0.5).abs() < 0.02);
        assert_eq!(auc(&vec![0.3; rows.len()], &outcomes), 0.5);
        assert!(auc(&[0.1, 0.2], &[true, true]).is_nan());
        assert_eq!(auc(&[0.1, 0.2], &[false, true]), 1.0);
        assert_eq!(Logistic::fit(&[vec![1.0, f64::NAN]], &[true]), None);
        assert_eq!(Logistic::fit(&[], &[]), None);
        // An outcome that never happens, and a feature that is always zero.
        let fit = Logistic::fit(&[vec![1.0, 0.0], vec![1.0, 0.0]], &[false, false]);
        assert!(fit.is_some_and(|f| f.probability(&[1.0, 0.0]) < 0.1));
    }
}
