//! How a scene travels: one file per exchange format.

pub mod atomic;
pub mod opendrive;
pub mod project;
