//! Measures the trade of speed for accuracy: settings of the knobs run on the same cases, in random turns, against
//! named references. The command line (`sceneloom trade`), the window's Calibrate and its Refine share it.

pub mod calibrate;
pub mod cases;
pub mod edits;
pub mod load;
pub mod plot;
pub mod sensors;
pub mod settings;
