//! How a scene is generated: worker, networks, sensors, worlds.

pub mod dataset;
pub mod inversion;
pub mod metrics;
pub mod model;
pub mod region;
pub mod replay;
pub mod rng;
pub mod schedule;
pub mod solver;
pub mod weights;
pub mod world;
