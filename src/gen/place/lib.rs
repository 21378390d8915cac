//! Makes boxes on a map from a description, by rules: a scene graph, a road, and the best free place for every object.

pub mod beside_road;
mod cost;
pub mod description;
pub mod holds;
pub mod lanes;
pub mod off;
mod placement;
pub mod road;
pub mod rules;
mod spots;
mod spots_strips;
pub mod to_graph;
