//! Figures of merit, each with its definition.

pub mod agreement;
pub mod iou;
pub mod occupancy;
pub mod stats;
