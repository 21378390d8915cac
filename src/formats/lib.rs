//! How a scene travels: one file per exchange format.

pub mod atomic;
pub mod box_list;
pub mod multi_plane;
pub mod npz;
pub mod occ3d;
pub mod opendrive;
pub mod png;
pub mod point_cloud;
pub mod project;
