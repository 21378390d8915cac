//! Classifier-free guidance. Ho and Salimans 2022, arXiv 2207.12598.

use super::{Branch, Denoiser, check_length};

/// Classifier-free guidance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guidance {
    /// Weight: 0 = without condition, 1 = the conditional prediction itself, above 1 = exaggerated.
    pub weight: f64,
    /// Rescaling: 0 = none, 1 = scaled back to the spread of the conditional prediction (Lin et al. 2023, section 3.4,
    /// about 0.7 there). Guidance grows the variance as weight squared.
    pub rescale: f64,
}

impl Guidance {
    /// The conditional prediction as it is, one network call.
    pub const NONE: Guidance = Guidance {
        weight: 1.0,
        rescale: 0.0,
    };

    /// Network calls per prediction: weights 0 and 1 need only one branch.
    pub fn calls(&self) -> usize {
        if self.weight == 0.0 || self.weight == 1.0 {
            1
        } else {
            2
        }
    }

    /// The guided prediction.
    pub fn predict<D: Denoiser + ?Sized>(
        &self,
        model: &mut D,
        x: &[f64],
        t: f64,
    ) -> Result<Vec<f64>, D::Error> {
        if self.weight == 0.0 {
            return ask(model, x, t, Branch::Unconditional);
        }
        let conditional = ask(model, x, t, Branch::Conditional)?;
        if self.weight == 1.0 {
            return Ok(conditional);
        }
        let unconditional = ask(model, x, t, Branch::Unconditional)?;
        Ok(self.combine(&conditional, &unconditional))
    }

    /// `u + weight (c - u)`, then rescaled. Weights 0 and 1 return their branch bit for bit.
    pub fn combine(&self, conditional: &[f64], unconditional: &[f64]) -> Vec<f64> {
        if self.weight == 0.0 {
            return unconditional.to_vec();
        }
        if self.weight == 1.0 {
            return conditional.to_vec();
        }
        let pairs = conditional.iter().zip(unconditional);
        let mut guided: Vec<f64> = pairs.map(|(c, u)| u + self.weight * (c - u)).collect();
        if self.rescale != 0.0 {
            let spread = standard_deviation(&guided);
            if spread > 0.0 {
                let back = standard_deviation(conditional) / spread;
                let factor = self.rescale * back + (1.0 - self.rescale);
                guided.iter_mut().for_each(|g| *g *= factor);
            }
        }
        guided
    }
}

fn ask<D: Denoiser + ?Sized>(model: &mut D, x: &[f64], t: f64, branch: Branch) -> Result<Vec<f64>, D::Error> {
    let out = model.predict(x, t, branch)?;
    check_length("the network's prediction", out.len(), x.len())?;
    Ok(out)
}

/// Population standard deviation, two-pass; 0 for an empty slice.
pub fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}
