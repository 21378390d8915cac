//! Measures the program: suites over held-out worlds, trials of edits, the trade of speed for accuracy. The command line
//! (`sceneloom eval`, `sceneloom trade`) and the window (Calibrate, Refine) both use it.

pub mod held_out;
pub mod machine;
pub mod markdown;
pub mod options;
pub mod origin;
pub mod presets;
pub mod suite;
pub mod suites;
pub mod table;
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
