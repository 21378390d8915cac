//! How a scene is generated: worker, networks, sensors, worlds.

pub mod composite;
pub mod dataset;
pub mod inversion;
pub mod job;
pub mod keep_clear;
pub mod keep_grounded;
pub mod keep_objects;
pub mod metrics;
pub mod model;
pub mod params;
pub mod pipeline;
pub mod placement;
pub mod redraw;
pub mod region;
pub mod replay;
pub mod request;
pub mod rng;
pub mod schedule;
pub mod sensors;
pub mod solver;
pub mod text;
pub mod trade;
pub mod weights;
pub mod words_background;
pub mod worker;
pub mod world;
