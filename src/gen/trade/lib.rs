//! The trade of speed for accuracy. Each setting of the knobs has a time and an error against a named reference, both
//! with intervals. Settings that no other setting beats in both form the front; the presets of the quality slider lie
//! on it. `calibration` makes the measurements; docs/trade.md has the results.

mod front;
mod interval;
mod predict;
mod presets;

pub use front::{TradePoint, front, hypervolume, knee};
pub use interval::{Interval, bootstrap_median};
pub use predict::{Cost, SizedTime};
pub use presets::{Preset, PresetKnobs, Presets};
