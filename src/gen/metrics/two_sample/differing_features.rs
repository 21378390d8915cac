//! The features by which two sets of scenes differ most, as a guide to mending the generator.

use serde::Serialize;

use crate::local::Windows;
use crate::stats::interval;

/// A feature, and the difference of the sets in it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tell {
    /// Name of the feature.
    pub feature: String,
    /// Mean of the first set.
    pub of_x: f64,
    /// Mean of the second set.
    pub of_y: f64,
    /// Difference of the means over scenes in standard errors of that difference.
    pub sigmas: f64,
}

/// The `count` features that differ most, the clearest first. Each scene counts by the mean of its windows. `names`
/// belong to the first features; features beyond them are left out.
pub fn tells(x: &[Windows], y: &[Windows], names: &[String], count: usize) -> Vec<Tell> {
    let of = |set: &[Windows], f: usize| {
        let scene = |w: &Windows| w.iter().map(|row| row[f]).sum::<f64>() / w.len() as f64;
        let means: Vec<f64> = set.iter().filter(|w| !w.is_empty()).map(scene).collect();
        interval(&means)
    };
    let mut all: Vec<Tell> = names
        .iter()
        .enumerate()
        .filter(|(f, _)| x.iter().chain(y).flatten().all(|row| *f < row.len()))
        .map(|(f, name)| {
            let ((of_x, of_x_off), (of_y, of_y_off)) = (of(x, f), of(y, f));
            let off = of_x_off.hypot(of_y_off).max(1e-9);
            Tell {
                feature: name.clone(),
                of_x,
                of_y,
                sigmas: (of_y - of_x) / off,
            }
        })
        .collect();
    all.sort_by(|a, b| b.sigmas.abs().total_cmp(&a.sigmas.abs()));
    all.truncate(count);
    all
}
