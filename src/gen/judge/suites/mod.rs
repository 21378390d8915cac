//! The suites, one folder or file each.

pub mod downstream;
pub mod editing;
pub mod forecast;
pub mod gaussians;
pub mod generation;
pub mod layout;
pub mod lidar;
pub mod map;
pub mod near;
mod near_edits;
pub mod pictures;
pub mod splat;
pub mod vae;
pub mod world;
