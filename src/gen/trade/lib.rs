//! The trade of speed for accuracy: what a setting of the knobs costs and how far its result lies from a named
//! reference, with intervals; the front of those settings that nothing beats; the presets of the quality slider.
//! Protocol: `design/numerics.md`, section 6. What is measured, and how, is up to `app::trade`.

mod front;
mod interval;
mod predict;
mod presets;

pub use front::{TradePoint, front, hypervolume, knee};
pub use interval::{Interval, bootstrap_median};
pub use predict::{Cost, SizedTime};
pub use presets::{Preset, PresetKnobs, Presets};
