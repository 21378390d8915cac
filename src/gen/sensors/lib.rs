//! Sensors computed from the voxels: exact LiDAR ray cast, splatted camera maps, their colours.
//!
//! The grid is used as it is: in Occ3D labels the road lies in bin 0 (top face at z = -0.6 m), so LiDAR and cameras see it
//! 0.6 m below the wheels, as in the renderers of the papers.

pub mod appearance;
pub mod backdrop;
pub mod bake;
pub mod border;
pub mod cameras;
pub mod caster;
pub mod cloud;
pub mod color;
pub mod learned;
pub mod learned_caster;
pub mod lidar;
pub mod march;
pub mod material;
pub mod mpi;
pub mod observed;
pub mod order;
pub mod own_body;
pub mod painter;
pub mod perceived;
pub mod perceived_sweep;
pub mod perceived_voxels;
pub mod perspective;
pub mod picture_hints;
mod plots;
pub mod project;
pub mod radar;
pub mod raycast;
pub mod rays;
pub mod road_exits;
pub mod rolling;
pub mod shaped;
pub mod splat;
pub mod surroundings;
mod texture;
mod tile;
pub mod truth;
mod units;

#[cfg(test)]
mod map_tests;
