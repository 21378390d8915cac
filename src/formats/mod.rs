//! How a scene travels: one file per exchange format.

pub mod atomic;
pub mod occ3d;
pub mod opendrive;
pub mod project;
