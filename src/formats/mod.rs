//! How a scene travels: one file per exchange format.

pub mod atomic;
pub mod multi_plane;
pub mod npz;
pub mod occ3d;
pub mod opendrive;
pub mod project;
