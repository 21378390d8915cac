//! Sensors computed from the voxels: exact and learned LiDAR, radar, camera pictures and maps, and what small networks
//! see in them. Each folder is a room; `docs/architecture.md` says which one may use which.
//!
//! The grid is used as it is: in Occ3D labels the road lies in bin 0 (top face at z = -0.6 m), so LiDAR and cameras see it
//! 0.6 m below the wheels, as in the renderers of the papers.

pub mod bake;
pub mod beyond;
pub mod cameras;
pub mod lidar;
pub mod perceive;
pub mod pictures;
pub mod radar;
pub mod raycast;
pub mod splat;

#[cfg(test)]
mod map_tests;
