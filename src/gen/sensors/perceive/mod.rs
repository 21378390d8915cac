//! Predictions of small networks for the sensors of a scene, compared with what stands there.

pub mod pictures;
pub mod sweep;
pub mod voxels;
