//! Measures the cost of each speed knob: settings of the knobs run on the same cases, in random turns, against named
//! references. `sceneloom trade` and the window (Calibrate, Refine) use it; suites of quality share its trials and worlds.

pub mod calibrate;
pub mod cases;
mod choose;
pub mod edits;
pub mod figures;
pub mod held_out;
pub mod machine;
pub mod measure;
pub mod plan;
pub mod report;
pub mod sensors;
pub mod settings;
pub mod trials;

/// Receives how far a measurement is.
pub trait MeasurementProgress: Sync {
    /// `step` of `steps` of `stage` are done.
    fn at(&self, stage: &str, step: usize, steps: usize);
}

/// Implementation that ignores progress.
impl MeasurementProgress for () {
    fn at(&self, _: &str, _: usize, _: usize) {}
}
