//! Things without support: crowns without a trunk, and voxels of any class that are not connected to the ground.

use super::{ShapeFigures, share};
use crate::components::{around, components, flat, place, spread};
use scene::{Class, VoxelGrid, Window};

/// Groups of vegetation (26 neighbours, [`SMALLEST_CROWN`] voxels or more) in which no voxel stands on another class.
pub const CROWNS: &str = "crowns_without_trunk";
/// Share of all vegetation voxels that are in such groups.
pub const CROWN_SHARE: &str = "vegetation_without_trunk";
/// Groups of voxels (26 neighbours) that are connected neither to ground nor to the lowest bin.
pub const PARTS: &str = "unsupported_parts";
/// Voxels of such groups.
pub const VOXELS: &str = "unsupported_voxels";

/// Number of voxels from which a group of leaves counts as a crown.
const SMALLEST_CROWN: usize = 4;

/// True if the group touches a side of the grid: something outside may then hold it.
fn at_side(group: &[usize]) -> bool {
    group.iter().any(|at| {
        let [x, y, _] = place(*at);
        x == 0 || y == 0 || x + 1 == Window::NX || y + 1 == Window::NY
    })
}

pub fn figures(grid: &VoxelGrid, out: &mut ShapeFigures) {
    let labels = flat(grid);
    let leaf = Class::Vegetation.id();
    let is_ground = |l: u8| Class::from_id(l).is_some_and(Class::is_ground);
    // A plant replaces the ground's own voxel, in the bin that the ground lies in.
    let in_ground =
        |at: usize| around(at).any(|near| place(near)[2] == place(at)[2] && is_ground(labels[near]));
    let rests = |at: usize| {
        at.is_multiple_of(Window::NZ) || ![leaf, Class::FREE].contains(&labels[at - 1]) || in_ground(at)
    };
    let (mut crowns, mut loose, mut leaves) = (0, 0, 0);
    for group in components(labels.iter().map(|l| *l == leaf).collect()) {
        leaves += group.len();
        if group.len() >= SMALLEST_CROWN && !group.iter().any(|at| rests(*at)) && !at_side(&group) {
            crowns += 1;
            loose += group.len();
        }
    }
    out.insert(CROWNS, f64::from(crowns));
    share(out, CROWN_SHARE, loose, leaves);

    let occupied = |at: &usize| labels[*at] != Class::FREE;
    let ground = |at: &usize| at.is_multiple_of(Window::NZ) || is_ground(labels[*at]);
    let start = (0..labels.len()).filter(occupied).filter(ground).collect();
    let mut left: Vec<bool> = (0..labels.len()).map(|at| occupied(&at)).collect();
    spread(&mut left, start);
    let hanging: Vec<_> = components(left).into_iter().filter(|g| !at_side(g)).collect();
    out.insert(PARTS, hanging.len() as f64);
    out.insert(VOXELS, hanging.iter().map(Vec::len).sum::<usize>() as f64);
}
