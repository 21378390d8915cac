//! Training and evaluation data from procedural worlds, as safetensors shards.

pub mod layout;
pub mod lidar;
pub mod occupancy;
pub mod perception;
pub mod picture_pairs;
pub mod pictures;
pub mod sensors_pair;
pub mod shard;
pub mod text;

pub use occupancy::{OccupancyFrame, occupancy_frame, world_of};
use occupancy::{VOXELS, voxels};
pub use shard::{DatasetReport, SHARD_FRAMES, Shard, write};
