//! Measures the cost of each speed knob: settings of the knobs run on the same cases, in random turns, against named
//! references.

pub mod calibrate;
pub mod cases;
mod choose;
pub mod edits;
pub mod figures;
pub mod measure;
pub mod plan;
pub mod report;
pub mod sensors;
pub mod settings;
