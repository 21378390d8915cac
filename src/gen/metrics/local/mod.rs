//! Features of small windows, by hand and by random convolutions with fixed weights: what pooled features of a whole
//! frame do not see. No weights are trained, so figures of different days and models compare.

pub mod depth;
pub mod occupancy;
mod random;

/// Feature vectors of the windows of one scene.
pub type Windows = Vec<Vec<f64>>;
