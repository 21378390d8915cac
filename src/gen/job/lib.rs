//! Generation: the job, the pipeline that does it, and the worker thread that runs it.

pub mod close_holes;
pub mod composite;
mod contract;
pub mod drive;
pub mod guard;
pub mod inpaint;
pub mod invented;
pub mod keep_clear;
pub mod keep_grounded;
pub mod keep_objects;
pub mod keep_unchanged;
pub mod network_scenery;
pub mod params;
pub mod pipeline;
pub mod product;
pub mod refine;
pub mod region;
pub mod request;
pub mod seen_draft;
pub mod worker;

pub use contract::*;
