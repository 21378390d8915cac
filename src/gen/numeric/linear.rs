//! Systems of a few linear equations.

/// Solves a system by elimination with the largest pivots. Each row holds the coefficients of an equation, then its right side.
/// `None` if there is no single solution, or a number is not finite.
pub fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    if rows.iter().any(|row| row.len() != n + 1) {
        return None;
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()))?;
        rows.swap(k, pivot);
        let (above, below) = rows.split_at_mut(k + 1);
        let own = &above[k];
        if !own[k].is_finite() || own[k].abs() < 1e-300 {
            return None;
        }
        for row in below {
            let share = row[k] / own[k];
            row[k..]
                .iter_mut()
                .zip(&own[k..])
                .for_each(|(to, from)| *to -= share * from);
        }
    }
    let mut out = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * out[j]).sum();
        out[k] = (rows[k][n] - known) / rows[k][k];
    }
    out.iter().all(|v| v.is_finite()).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_put_in_comes_out() {
        // The first pivot is zero, so rows must be exchanged.
        let rows = vec![
            vec![0.0, 2.0, 1.0, 7.0],
            vec![1.0, 1.0, 1.0, 6.0],
            vec![4.0, -1.0, 2.0, 8.0],
        ];
        let found = solve(rows).expect("a solution");
        for (found, expected) in found.iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(solve(Vec::new()), Some(Vec::new()));
    }

    #[test]
    fn what_has_no_single_solution_has_none() {
        assert_eq!(solve(vec![vec![1.0, 2.0, 3.0], vec![2.0, 4.0, 6.0]]), None);
        assert_eq!(solve(vec![vec![f64::NAN, 1.0]]), None);
        assert_eq!(solve(vec![vec![f64::INFINITY, 1.0]]), None);
        assert_eq!(solve(vec![vec![1.0, f64::NAN]]), None);
        assert_eq!(solve(vec![vec![1e-290, 1e300]]), None, "it would overflow");
        assert_eq!(solve(vec![vec![1.0]]), None, "no right side");
    }
}
