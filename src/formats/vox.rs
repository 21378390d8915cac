//! MagicaVoxel `.vox` (ephtracy/voxel-model, both specifications): models of at most 256 voxels a side, placed by a graph of
//! nodes, in 255 colours.
//!
//! A voxel of the file is a voxel of 0.4 m. Its axes are those of the ego frame, x forward, y left, z up; its origin is the
//! ego frame's, but for z: the lowest voxels of a map have z = 0. The colours are those of the classes, colour k of class
//! k - 1, and their names are in a `NOTE`.
//!
//! The reader is our own: `dot_vox` 5.2 leaves out names, and is recursive for every chunk within a chunk, so that a
//! file of nested headers alone ends the program.

mod place;
mod read;
mod write;

pub(crate) use place::{VoxMap, place};
pub(crate) use read::VoxFile;
pub(crate) use write::to_bytes;

/// Most voxels along a side of a model.
const LONGEST: usize = 256;
/// Name of the uppermost node of a file that this program wrote: its models cover the whole map.
const OWN_NAME: &str = "sceneloom";

/// Middle of a model of so many voxels along an axis, as `MagicaVoxel` counts: the place of a model is that of its
/// middle.
fn middle(size: i64) -> i64 {
    size / 2
}
