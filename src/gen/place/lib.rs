//! From a description to boxes on a map by rules: scene graph, road, and the best free place for every object.

pub mod beside_road;
mod cost;
pub mod description;
pub mod holds;
pub mod lanes;
pub mod road;
pub mod rules;
mod spots;
mod spots_strips;
pub mod to_graph;
