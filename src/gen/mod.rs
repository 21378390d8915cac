//! How a scene is generated: worker, networks, sensors, worlds.

pub mod sensors;
