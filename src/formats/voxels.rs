//! Voxel grids of other data sets: where their cells lie ([`DataCells`]), the ground at its true height ([`Physical`]), and
//! labels taken from one grid to the other ([`cells_of`], [`VoxelVotes`]).

mod data_cells;
mod data_map;
mod physical;
mod resample;

pub(crate) use data_cells::DataCells;
pub(crate) use data_map::DataMap;
pub(crate) use physical::{Physical, unobserved};
pub(crate) use resample::{LabelledCell, VoxelVotes, cells_of};

use scene::{Class, Frame};

use crate::FormatError;

/// The labels of a frame at their true height. Errors on a label that is no class.
pub(crate) fn physical(frame: &Frame) -> Result<Physical, FormatError> {
    check(frame)?;
    Ok(Physical::raised(&frame.occupancy))
}

/// Errors on a label that is no class.
pub(crate) fn check(frame: &Frame) -> Result<(), FormatError> {
    let wrong = frame
        .occupancy
        .iter_set()
        .find(|(.., label)| *label > Class::FREE);
    wrong.map_or(Ok(()), |(x, y, z, label)| {
        let free = Class::FREE;
        Err(FormatError::new(format!(
            "voxel {x}, {y}, {z} holds label {label}, expected 0 to {free}"
        )))
    })
}
