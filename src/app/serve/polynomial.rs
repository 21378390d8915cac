//! Polynomials of f-theta lenses, and the one that goes the other way.

use numeric::linear::solve;

/// Powers of a fit, without the constant one.
const TERMS: usize = 6;
/// Points of a fit.
const SAMPLES: usize = 512;

/// A fit of the inverse of a function.
pub struct Fit {
    /// By powers, the constant (0) first.
    pub coefficients: Vec<f64>,
    /// Largest error at the points of the fit, in the unit of the inverse's values.
    pub error: f64,
}

/// The value of a polynomial, coefficients by powers, the constant first.
pub fn value(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, k| sum * x + k)
}

/// The polynomial `x = k1 y + … + k6 y^6` of least squares for `y = function(x)`, x from 0 to `most`. Where the function stops
/// growing, the error is infinite.
pub fn inverse(function: impl Fn(f64) -> f64, most: f64) -> Fit {
    let xs: Vec<f64> = (1..=SAMPLES).map(|i| most * i as f64 / SAMPLES as f64).collect();
    let ys: Vec<f64> = xs.iter().map(|x| function(*x)).collect();
    let scale = ys[SAMPLES - 1];
    // Written so that NaN fails too.
    let grows = ys.windows(2).all(|w| w[1] > w[0]) && ys[0] > 0.0 && scale.is_finite();
    let none = || Fit {
        coefficients: vec![0.0; TERMS + 1],
        error: f64::INFINITY,
    };
    if !grows {
        return none();
    }
    // Householder would be finer; with y scaled to 1 and 6 powers, normal equations leave 8 digits.
    let mut rows = vec![vec![0.0; TERMS + 1]; TERMS];
    for (x, y) in xs.iter().zip(&ys) {
        let t = y / scale;
        let powers: [f64; TERMS] = std::array::from_fn(|i| t.powi(i as i32 + 1));
        for (row, p) in rows.iter_mut().zip(powers) {
            for (sum, q) in row.iter_mut().zip(powers.into_iter().chain([*x])) {
                *sum += p * q;
            }
        }
    }
    let Some(solved) = solve(rows) else {
        return none();
    };
    let mut coefficients = vec![0.0];
    coefficients.extend((0..TERMS).map(|i| solved[i] / scale.powi(i as i32 + 1)));
    let off = |(x, y): (&f64, &f64)| (value(&coefficients, *y) - x).abs();
    let error = xs.iter().zip(&ys).map(off).fold(0.0, f64::max);
    Fit { coefficients, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_turned_round() {
        // A wide lens: 1.2 rad at 1000 px.
        let angle_of = [0.0, 1e-3, 2e-8, 1.5e-10];
        let fit = inverse(|r| value(&angle_of, r), 1000.0);
        assert!(fit.error < 0.2, "{}", fit.error);
        for r in [10.0, 400.0, 990.0] {
            let back = value(&fit.coefficients, value(&angle_of, r));
            assert!((back - r).abs() < 0.2, "{r}: {back}");
        }
        assert!(inverse(|r| -r, 10.0).error.is_infinite());
        assert!(inverse(|r| r * f64::NAN, 10.0).error.is_infinite());
        assert!(inverse(|r| (r / 5.0).sin(), 10.0).error.is_infinite());
    }
}
