//! How a scene is generated: worker, networks, sensors, worlds.

pub mod dataset;
pub mod metrics;
pub mod world;
