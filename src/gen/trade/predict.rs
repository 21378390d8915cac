//! Predicts the time of a setting for an edit of a given size, from its times for edits of other sizes.

use serde::{Deserialize, Serialize};

/// Time of an edit of a given size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizedTime {
    /// Tokens that the denoising network computed.
    pub tokens: f64,
    /// Wall time, s.
    pub wall_s: f64,
}

/// Wall time as a fixed part and a part per token: the network's products grow with its tokens; keys, draft and
/// composite do not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Time without any token, s.
    pub fixed_s: f64,
    /// Time per token, s.
    pub per_token_s: f64,
}

impl Cost {
    /// Fits by least squares of relative errors, neither part below 0; `None` without a positive time. Times of a
    /// single size give no slope: then the whole time is fixed.
    pub fn fit(times: &[SizedTime]) -> Option<Self> {
        let usable = times
            .iter()
            .filter(|t| t.wall_s > 0.0 && t.wall_s.is_finite() && t.tokens >= 0.0);
        // Weights 1 / wall^2 make errors relative.
        let mut sums = [0.0; 5];
        for t in usable {
            let w = 1.0 / (t.wall_s * t.wall_s);
            for (sum, v) in
                sums.iter_mut()
                    .zip([1.0, t.tokens, t.tokens * t.tokens, t.wall_s, t.tokens * t.wall_s])
            {
                *sum += w * v;
            }
        }
        let [n, x, xx, y, xy] = sums;
        if n <= 0.0 {
            return None;
        }
        let spread = n * xx - x * x;
        let slope = if spread > 1e-9 * n * xx {
            (n * xy - x * y) / spread
        } else {
            0.0
        };
        let fixed = (y - slope * x) / n;
        Some(if slope < 0.0 {
            Self {
                fixed_s: y / n,
                per_token_s: 0.0,
            }
        } else if fixed < 0.0 {
            Self {
                fixed_s: 0.0,
                per_token_s: xy / xx,
            }
        } else {
            Self {
                fixed_s: fixed,
                per_token_s: slope,
            }
        })
    }

    /// Wall time for so many tokens, s.
    pub fn wall_s(&self, tokens: f64) -> f64 {
        self.fixed_s + self.per_token_s * tokens
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(of: &[(f64, f64)]) -> Vec<SizedTime> {
        of.iter()
            .map(|(tokens, wall_s)| SizedTime {
                tokens: *tokens,
                wall_s: *wall_s,
            })
            .collect()
    }

    #[test]
    fn a_line_is_found_and_extremes_are_survived() {
        let cost = Cost::fit(&times(&[(20.0, 0.12), (60.0, 0.16), (600.0, 0.7)])).expect("a line");
        assert!((cost.fixed_s - 0.1).abs() < 1e-9 && (cost.per_token_s - 0.001).abs() < 1e-12);
        assert!((cost.wall_s(100.0) - 0.2).abs() < 1e-9);
        let one = Cost::fit(&times(&[(35.0, 0.2)])).expect("one size");
        assert!((one.fixed_s - 0.2).abs() < 1e-12 && one.per_token_s == 0.0);
        let falling = Cost::fit(&times(&[(10.0, 0.3), (100.0, 0.1)])).expect("noise");
        assert_eq!(falling.per_token_s, 0.0);
        assert!(falling.fixed_s > 0.1 && falling.fixed_s < 0.3);
        let steep = Cost::fit(&times(&[(10.0, 0.01), (100.0, 1.0)])).expect("steep");
        assert!(steep.fixed_s == 0.0 && steep.per_token_s > 0.0);
        assert_eq!(Cost::fit(&times(&[(1.0, f64::NAN), (2.0, 0.0)])), None);
        assert_eq!(Cost::fit(&[]), None);
    }
}
