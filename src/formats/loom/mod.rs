//! The project file `.loom`: a zip with the whole scene. Equal scenes give equal bytes.
//!
//! | entry | holds |
//! |---|---|
//! | `manifest.json` | `format`, `version` |
//! | `scene.json` | all but the grids: name, prompt, words, seed, rig, background, road network; of the canvas its boxes, polylines and the ego vehicle's pose; of the clip its length, and how objects and the ego vehicle move |
//! | `canvas/layout.u32` | map layers as bits, `[x][y]`, a little-endian word per column |
//! | `canvas/relief.f32` | height of the ground in each column, `[x][y]`, little-endian numbers in m; only if it is not flat |
//! | `canvas/occupancy.u8` | class labels, `[x][y][z]`, a byte per voxel |
//! | `canvas/painted.u8` | painted voxels, 255 where none; only if there are any |
//! | `canvas/unobserved.u16` | voxels that a data set's sensors did not see, a bit each; only if it says; `unobserved.u64` with more than 16 bins |
//! | `canvas/data_labels.u32` | labels of a data set that say more than the class: number of a voxel `[x][y][z]` and label each; only of a scene from a data set |
//! | `canvas/source_layout.u32`, `source_relief.f32`, `source_occupancy.u8` | of the source, only where it differs from the canvas |
//! | `tracks/0000000007.u8` | class labels of a moving object, where it was made, `[x][y][z]`, a byte per voxel |
//! | `kept.json`, `versions/0007.loom` | versions with their names and stars, and what was typed; only if there are any |
//! | `log.json`, `log/<hash>.loom`, `log/results.voxels` | every change since an origin, with its author and the change before it; states and generated voxels by the hash of their bytes; only if anything was changed |
//! | `sweeps.json`, `sweeps/0007`, `sweeps/before.loom` | recorded sweeps: names, times and poses of their files, the files byte for byte, the scene before any edit; only of a scene that was imported from them |
//!
//! The canvas has 200 x 200 columns around the origin of the world frame, unless `scene.json` gives it another `extent`. Its voxels are
//! those of Occ3D unless the extent names another `lattice`.
//!
//! The manifest's version selects what is done first: a file of an older version goes through the steps of [`migrate`],
//! one per version, until it is as a file of this version. A newer version is refused.

mod archive;
mod beside;
mod check;
mod error;
mod header;
mod log;
#[cfg(test)]
mod log_tests;
mod manifest;
pub mod migrate;
mod names;
mod patch_bytes;
mod read;
mod recording;
#[cfg(test)]
mod recording_tests;
#[cfg(test)]
mod tests;
mod write;

use std::io::Cursor;
use std::path::Path;

use scene::Scene;

use super::{atomic, input};
pub use error::ProjectError;
use names::{FORMAT, MANIFEST, SCENE};
pub use names::{LARGEST_FILE, VERSION};
pub use write::{alone_to_bytes, to_bytes};

/// Writes the scene to `path`, whole or not at all; the number of bytes written.
pub fn save(path: &Path, scene: &Scene) -> Result<u64, ProjectError> {
    let bytes = to_bytes(scene).map_err(|e| e.at(path))?;
    atomic::write(path, &bytes).map_err(|e| ProjectError::from(e).at(path))?;
    Ok(bytes.len() as u64)
}

/// Reads the scene at `path`. It carries a fresh revision.
pub fn load(path: &Path) -> Result<Scene, ProjectError> {
    // A large file of another kind is refused before it is read.
    if !input::head(path, 4)?.starts_with(b"PK") {
        return Err(ProjectError::NotAProject("no zip archive".into()).at(path));
    }
    let bytes = input::read(path, LARGEST_FILE)?;
    from_bytes(&bytes).map_err(|e| e.at(path))
}

/// The scene in the bytes of a project file. It carries a fresh revision.
pub fn from_bytes(bytes: &[u8]) -> Result<Scene, ProjectError> {
    read::read(Cursor::new(bytes), &migrate::ALL)
}
