//! How a scene changes: the document with undo, applying edits, tools, picking, and quality checks.

pub mod apply;
pub mod arrange;
pub mod arranged;
pub mod checks;
pub mod choose;
pub mod clashes;
pub mod document;
pub mod fit;
pub mod fix;
pub mod flood;
pub mod immediate;
mod junction;
pub mod kerb;
pub mod keyframes;
pub mod lanes;
pub mod log;
#[cfg(test)]
mod map_tests;
pub mod measure;
pub mod merge;
pub mod models;
pub mod outline;
pub mod part;
pub mod pick;
pub mod pick_things;
mod reaching;
mod replay;
pub mod roads;
pub mod rows;
mod things;
pub mod tools;
pub mod traffic;
pub mod transform;
pub mod voxel_ops;
pub mod within;

pub use apply::forecast::{Forecast, forecast};
pub use apply::left_standing::left_standing;
pub use apply::off_lane::off_lane;
pub use apply::start::{TrafficStart, remarks, traffic_drives};
pub use apply::{Apply, apply_all};
pub use document::{Document, Stale};
pub use log::{HistoryStep, LeaveOutError, LeftOut, Undone};
pub use part::AcceptedPart;
pub use scene::{Edit, EditError, Shape};
pub use things::columns_between;
