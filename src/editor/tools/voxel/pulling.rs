//! A face of voxels that is pulled out or pushed in.

use glam::DVec3;

use crate::Edit;
use crate::pick::{PickRay, VoxelHit};
use crate::tools::Hand;
use crate::tools::rays::along_axis;
use crate::voxel_ops::{self, VoxelIndex};
use scene::{Class, Frame};

/// The edit of a face pulled as far as the pointer is.
pub(super) fn pulled(
    ray: &PickRay,
    frame: &Frame,
    hand: &Hand,
    first: &VoxelHit,
    face: &[VoxelIndex],
) -> Option<Edit> {
    let ([x, y, z], voxel_m) = (first.cell, frame.extent().voxel_m());
    let normal = DVec3::from_array(first.normal.map(f64::from));
    let surface_m = frame.extent().center(x, y, z) + normal * (voxel_m / 2.0);
    let way_m = along_axis(ray, surface_m, normal)?;
    let layers = (way_m / voxel_m).round() as i32;
    let cells = voxel_ops::extrude(&frame.occupancy, face, first.normal, layers);
    let cells = voxel_ops::only(
        &frame.occupancy,
        hand.both_sides(frame.extent(), cells),
        layers > 0,
    );
    let class = match layers > 0 {
        true => Class::from_id(first.label)?,
        false => Class::Free,
    };
    (!cells.is_empty()).then_some(Edit::PaintVoxels { cells, class })
}
