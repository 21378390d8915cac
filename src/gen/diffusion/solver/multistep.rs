//! Solvers that remember: DPM-Solver++(2M), Lu et al. 2022, arXiv 2211.01095, algorithm 2; UniPC of order
//! two with B(h) = e^h - 1, Zhao et al. 2023, arXiv 2302.04867; O-BELM, Wang et al. 2024, arXiv
//! 2410.07273, whose steps can be undone exactly (see [`crate::inversion`]).
//!
//! All of them work number by number: a region can be solved while the rest replays stored states.

use serde::{Deserialize, Serialize};

use super::{DdimStep, Prediction, SolverError, clean_estimate};
use crate::schedule::{NoiseLevel, ScheduleError};

/// How a prediction becomes the next state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SolverKind {
    /// First order.
    #[default]
    Ddim,
    /// Second order in the half log SNR, from the last two clean estimates.
    DpmPp2M,
    /// Second order, corrects each state once the prediction there is known.
    UniPc,
    /// Second order, exactly invertible. Its noisiest level must have some signal left.
    OBelm,
}

impl SolverKind {
    /// All of them.
    pub const ALL: [SolverKind; 4] = [Self::Ddim, Self::DpmPp2M, Self::UniPc, Self::OBelm];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ddim => "ddim",
            Self::DpmPp2M => "dpmpp2m",
            Self::UniPc => "unipc",
            Self::OBelm => "obelm",
        }
    }
}

impl std::str::FromStr for SolverKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|s| s.name() == name);
        known.ok_or_else(|| format!("expected {}", Self::ALL.map(Self::name).join(", ")))
    }
}

/// Largest weight of the last clean estimate in a DPM-Solver++ step, 1/(2r): a step that is much longer
/// than the one before it extrapolates wildly (row 8 of the extremes table).
const LARGEST_EXTRAPOLATION: f64 = 10.0;

/// Half the log of the signal-to-noise ratio, log(alpha / sigma); infinite at the two ends.
fn half_log_snr(level: &NoiseLevel) -> f64 {
    0.5 * level.log_alpha_bar - level.sigma.ln()
}

/// Walks down a list of levels; keeps what the method needs of the steps before.
#[derive(Clone, Debug)]
pub struct Stepper<'a> {
    kind: SolverKind,
    prediction: Prediction,
    levels: &'a [NoiseLevel],
    /// Clean estimates of the last two levels, newest last.
    clean: Vec<Vec<f64>>,
    /// The state that the last step left from (UniPC: corrected).
    before: Vec<f64>,
    last_order: usize,
}

impl<'a> Stepper<'a> {
    /// For `levels` from noise to data.
    pub fn new(kind: SolverKind, prediction: Prediction, levels: &'a [NoiseLevel]) -> Self {
        Self {
            kind,
            prediction,
            levels,
            clean: Vec::new(),
            before: Vec::new(),
            last_order: 0,
        }
    }

    /// Passes a state that is followed by a known one, so that no prediction is needed there (O-BELM).
    pub fn pass(&mut self, x: &[f64]) {
        self.before = x.to_vec();
    }

    /// The state at level `k + 1`, from the state `x` at level `k` and the prediction for it. To be
    /// called once for each k from 0 upwards.
    pub fn advance(&mut self, k: usize, x: &[f64], predicted: &[f64]) -> Result<Vec<f64>, SolverError> {
        let (from, to) = (&self.levels[k], &self.levels[k + 1]);
        let ddim = DdimStep::new(self.prediction, from, to)?;
        if self.kind == SolverKind::Ddim || from.log_alpha_bar == to.log_alpha_bar {
            return Ok(ddim.apply_all(x, predicted));
        }
        if self.kind == SolverKind::OBelm {
            let next = match k.checked_sub(1) {
                None => ddim.apply_all(x, predicted),
                Some(back) => {
                    let step = ObelmStep::new([&self.levels[back], from, to])?;
                    let states = self.before.iter().zip(x).zip(predicted);
                    states
                        .map(|((before, x), p)| {
                            step.forward(*before, *x, noise(self.prediction, from, *x, *p))
                        })
                        .collect()
                }
            };
            self.before = x.to_vec();
            return Ok(next);
        }
        let pairs = x.iter().zip(predicted);
        let clean: Vec<f64> = pairs
            .map(|(x, p)| clean_estimate(self.prediction, from, *x, *p))
            .collect();
        let next = if self.kind == SolverKind::DpmPp2M {
            self.dpmpp(k, x, &clean)
        } else {
            self.unipc(k, x, &clean)
        };
        self.clean.push(clean);
        if self.clean.len() > 2 {
            self.clean.remove(0);
        }
        Ok(next)
    }

    /// sigma_to / sigma_from x - alpha_to expm1(-h) D, D extrapolated from the last two clean estimates;
    /// plain at the first and the last step.
    fn dpmpp(&self, k: usize, x: &[f64], clean: &[f64]) -> Vec<f64> {
        let (from, to) = (&self.levels[k], &self.levels[k + 1]);
        let h = half_log_snr(to) - half_log_snr(from);
        let (keep, push) = (to.sigma / from.sigma, -to.alpha * (-h).exp_m1());
        let last = k + 2 == self.levels.len();
        match self.clean.last().filter(|_| !last) {
            None => lines(x, clean, |x, m| keep * x + push * m),
            Some(old) => {
                let h_before = half_log_snr(from) - half_log_snr(&self.levels[k - 1]);
                let weight = (0.5 * h / h_before).min(LARGEST_EXTRAPOLATION);
                let drive: Vec<f64> = lines(clean, old, |m, old| m + weight * (m - old));
                lines(x, &drive, |x, d| keep * x + push * d)
            }
        }
    }

    fn unipc(&mut self, k: usize, x: &[f64], clean: &[f64]) -> Vec<f64> {
        let corrected = if k == 0 {
            x.to_vec()
        } else {
            self.corrected(k, clean)
        };
        let (from, to) = (&self.levels[k], &self.levels[k + 1]);
        let h = half_log_snr(to) - half_log_snr(from);
        let (keep, push) = (to.sigma / from.sigma, -to.alpha * (-h).exp_m1());
        let mut next = lines(&corrected, clean, |x, m| keep * x + push * m);
        let order = if k == 0 || k + 2 == self.levels.len() {
            1
        } else {
            2
        };
        if order == 2 {
            let r = (half_log_snr(&self.levels[k - 1]) - half_log_snr(from)) / h;
            let old = &self.clean[self.clean.len() - 1];
            for ((next, old), m) in next.iter_mut().zip(old).zip(clean) {
                *next += push * 0.5 * (old - m) / r;
            }
        }
        self.before = corrected;
        self.last_order = order;
        next
    }

    /// The state at level `k` once more, now that the clean estimate there is known.
    fn corrected(&self, k: usize, clean: &[f64]) -> Vec<f64> {
        let (from, to) = (&self.levels[k - 1], &self.levels[k]);
        let last = &self.clean[self.clean.len() - 1];
        let hh = -(half_log_snr(to) - half_log_snr(from));
        let keep = to.sigma / from.sigma;
        let push = -to.alpha * hh.exp_m1();
        let b = weights_of(hh);
        let (older, of_older, of_new) = if self.last_order == 1 {
            (last, 0.0, 0.5)
        } else {
            let r = (half_log_snr(&self.levels[k - 2]) - half_log_snr(from)) / -hh;
            // rho_0 + rho_1 = b_0 and r rho_0 + rho_1 = b_1; r is minus infinity after a start from
            // pure noise.
            let rho = (b[0] - b[1]) / (1.0 - r);
            (&self.clean[self.clean.len() - 2], rho / r, b[0] - rho)
        };
        let mut out = lines(&self.before, last, |x, m| keep * x + push * m);
        for (i, out) in out.iter_mut().enumerate() {
            let extra = of_older * (older[i] - last[i]) + of_new * (clean[i] - last[i]);
            *out += push * extra;
        }
        out
    }
}

fn lines(a: &[f64], b: &[f64], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| f(*a, *b)).collect()
}

/// phi_2 / (e^h - 1) and 2 phi_3 / (e^h - 1) with phi_2 = (e^h - 1)/h - 1 and phi_3 = phi_2 / h - 1/2:
/// the right-hand side of UniPC's corrector, h <= 0. Series near 0, where the differences cancel.
pub fn weights_of(h: f64) -> [f64; 2] {
    let (phi_2, phi_3) = if h.abs() < 1e-2 {
        // phi_2 = sum h^n / (n+1)!, phi_3 = sum h^n / (n+2)!, n from 1.
        let mut terms = (0.0, 0.0);
        let (mut power, mut factorial) = (1.0, 1.0);
        for n in 1..=8 {
            power *= h;
            factorial *= f64::from(n) + 1.0;
            terms.0 += power / factorial;
            terms.1 += power / (factorial * (f64::from(n) + 2.0));
        }
        terms
    } else {
        let phi_2 = h.exp_m1() / h - 1.0;
        (phi_2, phi_2 / h - 0.5)
    };
    let e = h.exp_m1();
    if e == 0.0 {
        return [0.5, 1.0 / 3.0]; // the limits
    }
    [phi_2 / e, 2.0 * phi_3 / e]
}

/// The noise that a prediction implies.
pub fn noise(prediction: Prediction, level: &NoiseLevel, x: f64, predicted: f64) -> f64 {
    match prediction {
        Prediction::Epsilon => predicted,
        Prediction::V => level.sigma * x + level.alpha * predicted,
    }
}

/// One O-BELM step over three levels: with y = x / alpha and s = sigma / alpha,
/// y2 = r^2 y0 + (1 - r^2) y1 + (s2 - s1)(1 + r) noise(y1), r = (s2 - s1) / (s1 - s0).
/// Linear in y0, so it can be solved for y0.
#[derive(Clone, Copy, Debug)]
pub struct ObelmStep {
    alphas: [f64; 3],
    r: f64,
    h: f64,
}

impl ObelmStep {
    /// For three levels that follow each other, noisiest first. Errors if two of them are equal.
    pub fn new(levels: [&NoiseLevel; 3]) -> Result<Self, ScheduleError> {
        if let Some(bare) = levels.iter().find(|l| l.alpha == 0.0) {
            return Err(ScheduleError::NoSignal { t: bare.t });
        }
        let s = levels.map(|l| l.sigma / l.alpha);
        let h = s[2] - s[1];
        Ok(Self {
            alphas: levels.map(|l| l.alpha),
            r: h / (s[1] - s[0]),
            h,
        })
    }

    fn forward(&self, before: f64, x: f64, noise: f64) -> f64 {
        let [a0, a1, a2] = self.alphas;
        let rr = self.r * self.r;
        a2 * (rr * (before / a0) + (1.0 - rr) * (x / a1) + self.h * (1.0 + self.r) * noise)
    }

    /// The state at the first level, from those at the two that follow.
    pub fn backward(&self, next: f64, x: f64, noise: f64) -> f64 {
        let [a0, a1, a2] = self.alphas;
        let rr = self.r * self.r;
        a0 * ((next / a2 - (1.0 - rr) * (x / a1) - self.h * (1.0 + self.r) * noise) / rr)
    }
}
