//! Features of small windows, hand-made and by random convolutions with fixed weights. They show what pooled features
//! of a whole frame miss. No weights are trained, so figures of different days and models can be compared.

pub mod depth;
pub mod occupancy;
mod random;

/// Feature vectors of the windows of one scene.
pub type Windows = Vec<Vec<f64>>;
