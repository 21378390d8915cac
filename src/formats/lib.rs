//! Reads and writes files: `.loom` projects ([`loom`]), a table of formats that can be read ([`import`]) and a table of
//! formats that can be written ([`export`]).

pub mod atomic;
pub mod box_list;
pub mod error;
pub mod export;
pub mod import;
pub mod input;
mod lanelets;
pub mod loom;
pub mod multi_plane;
pub mod npz;
pub mod occ3d;
pub mod opendrive;
pub mod openscenario;
pub mod png;
#[cfg(test)]
mod table_tests;
pub mod video;
mod xml_text;

pub use error::FormatError;

/// What a file of a format holds.
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
