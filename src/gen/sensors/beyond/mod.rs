//! Continuation of a scene beyond the border of its map.

pub mod backdrop;
pub mod border;
mod plots;
pub mod road_exits;
