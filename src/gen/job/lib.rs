//! Generation: the job, the pipeline that does it, and the worker thread that runs it.

pub mod composite;
mod contract;
pub mod drive;
pub mod guards;
pub mod inpaint;
pub mod invented;
pub mod network_scenery;
pub mod params;
pub mod pipeline;
pub mod refine;
pub mod region;
pub mod request;
pub mod seen_draft;
pub mod worker;

pub use contract::*;
