//! Reads and writes files: `.loom` projects ([`loom`]), a table of formats that can be read ([`import`]) and a table of
//! formats that can be written ([`export`]).

pub mod atomic;
pub mod box_list;
pub mod calibration;
#[cfg(test)]
mod clip_tests;
#[cfg(test)]
mod cut_tests;
pub mod error;
pub mod export;
pub mod glb;
pub mod import;
pub mod input;
pub mod jpeg;
pub mod kitti;
mod lanelets;
pub mod las;
pub mod loom;
mod lzf;
pub mod model;
mod moments;
pub mod multi_plane;
mod npy;
pub mod npz;
mod nuplan_occ;
pub mod nuscenes;
mod nuscenes_radar;
pub mod occ3d;
pub mod opendrive;
pub mod openscenario;
pub mod out_folder;
pub mod physical;
pub mod png;
#[cfg(test)]
mod points_tests;
pub mod recipe;
mod semantic_kitti;
pub mod sensor_names;
mod sparse_npy;
pub mod sweep_file;
pub mod table;
#[cfg(test)]
mod table_tests;
mod target;
pub mod video;
mod vox;
mod voxels;
pub mod world_scenario;
mod xml_text;

pub use error::FormatError;

/// Kind of content in a file of a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holds {
    /// All of a scene.
    Scene,
    /// Roads with lanes, of any extent.
    Roads,
    /// The class of every voxel of a frame.
    Occupancy,
    /// The boxes of a frame.
    Boxes,
    /// Points of a LiDAR sweep.
    Points,
    /// A picture, or a map of one value per pixel.
    Pictures,
}
