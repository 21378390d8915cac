//! A layout extruded simply to voxels: ground by class, boxes by a rough profile of their class. It is what an edit
//! shows at once, and a condition of the diffusion transformer. Weights were trained with exactly this rule: changing
//! it requires new training.

use std::ops::Range;

use glam::DVec3;

use super::raster::box_cells;
use super::{BevLayer, BevLayout, Class, Extent, Lattice, SceneBox, VoxelGrid};

/// Class of the ground under a layout cell (bits of [`BevLayer`]): road and car park are driveable
/// surface, sidewalk and crossings beside the road are sidewalk, all else is terrain.
pub fn ground_class(cell: u32) -> Class {
    let has = |layer: BevLayer| cell & layer.bit() != 0;
    if has(BevLayer::DrivableArea) || has(BevLayer::CarparkArea) {
        Class::DriveableSurface
    } else if has(BevLayer::Walkway) || has(BevLayer::PedCrossing) {
        Class::Sidewalk
    } else {
        Class::Terrain
    }
}

/// Columns of a map and heights that a box occupies by the rough profile of its class, as
/// (x, y, number of voxels from bin 0 upward; at least 1), in the vertical convention of the labels:
/// objects reach down to the ground ([`box_bins`]), their tops stay where they are.
pub fn box_columns(extent: Extent, b: &SceneBox) -> Vec<(usize, usize, usize)> {
    let bottom_z = b.center_m.z - b.size_m.z / 2.0;
    let mut out = Vec::new();
    box_cells(extent, b, 0.0, |x, y| {
        let p = extent.center(x, y, 0);
        let local = b.to_local(DVec3::new(p.x, p.y, b.center_m.z));
        let along = local.x / b.size_m.x; // -0.5 rear to 0.5 front
        let share = match b.class {
            // Bonnet and boot are lower than the cabin.
            Class::Car if !(-0.42..=0.26).contains(&along) => 0.58,
            // The arm in front of the body.
            Class::ConstructionVehicle if along > 0.18 => 0.85,
            Class::Motorcycle | Class::Bicycle if !(-0.25..=0.25).contains(&along) => 0.5,
            _ => 1.0,
        };
        let top_m = bottom_z + share * b.size_m.z;
        // A layer counts once a sixth of it is filled.
        let top = extent.to_voxel_units(DVec3::new(0.0, 0.0, top_m)).z - 1.0 / 6.0;
        // A box floating above the ground still shows at least one voxel; NaN shows none.
        if top.is_finite() {
            let layers = (top.floor() + 1.0).clamp(1.0, extent.nz() as f64);
            out.push((x, y, layers as usize));
        }
    });
    out
}

/// Bins of a column that a box fills which stands on ground in a bin and reaches up to a number of layers
/// ([`box_columns`]); at least one.
pub fn box_bins(lattice: Lattice, ground: usize, layers: usize) -> Range<usize> {
    match lattice.lowered() {
        0 => {
            let foot = lattice.foot_bin(ground);
            foot..layers.max(foot + 1)
        }
        _ => ground.min(layers - 1)..layers,
    }
}

/// Draws the draft of a box into a grid, from the ground under it up.
pub fn stamp_box(grid: &mut VoxelGrid, b: &SceneBox) {
    let bottom_m = b.center_m.z - b.size_m.z / 2.0;
    let (extent, lattice) = (grid.extent(), grid.extent().lattice());
    let ground = lattice.ground_bin(bottom_m);
    for (x, y, layers) in box_columns(extent, b) {
        grid.column_mut(x, y)[box_bins(lattice, ground, layers)].fill(b.class.id());
    }
}

/// Bin that the ground of a layout lies in at a column, in the convention of its lattice: 0 without relief in the labels
/// of Occ3D.
pub fn ground_bin(layout: &BevLayout, x: usize, y: usize) -> usize {
    layout.extent().lattice().ground_bin(layout.relief.column_m(x, y))
}

/// The draft of a whole frame: ground in the bin of its height in every column, objects on it, or in its place where
/// labels let the ground down.
pub fn draft<'a>(layout: &BevLayout, boxes: impl Iterator<Item = &'a SceneBox>) -> VoxelGrid {
    let extent = layout.extent();
    let mut grid = VoxelGrid::over(extent);
    for [x, y] in extent.all_columns() {
        grid.column_mut(x, y)[ground_bin(layout, x, y)] = ground_class(layout.cell(x, y)).id();
    }
    for b in boxes {
        for (x, y, layers) in box_columns(extent, b) {
            let bins = box_bins(extent.lattice(), ground_bin(layout, x, y), layers);
            grid.column_mut(x, y)[bins].fill(b.class.id());
        }
    }
    grid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BoxId;
    use glam::DVec2;

    #[test]
    fn ground_and_a_car() {
        let mut layout = BevLayout::default();
        layout.set(BevLayer::DrivableArea, 100, 100, true);
        layout.set(BevLayer::Walkway, 100, 101, true);
        let car = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(10.0, 0.0, 0.85),
            size_m: DVec3::new(4.6, 1.95, 1.7),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let grid = draft(&layout, [&car].into_iter());
        assert_eq!(grid.get(100, 100, 0), Class::DriveableSurface.id());
        assert_eq!(grid.get(100, 101, 0), Class::Sidewalk.id());
        assert_eq!(grid.get(0, 0, 0), Class::Terrain.id());
        let columns = box_columns(Extent::WINDOW, &car);
        assert!((44..70).contains(&columns.len()), "{} columns", columns.len());
        let tallest = columns.iter().map(|c| c.2).max();
        assert_eq!(tallest, Some(7)); // top at 1.7 m: bin 6 is filled to 0.3 m
        assert_eq!(grid.get(125, 100, 6), Class::Car.id());
        assert_eq!(grid.get(125, 100, 7), Class::FREE);
    }

    #[test]
    fn boxes_stand_on_ground_where_labels_are_where_things_are() {
        let lattice = Lattice::new(0.2, 40, -3.2).expect("sound");
        let extent = Extent::over(lattice, [-50, -50], [100, 100]).expect("sound");
        let layout = BevLayout::over(extent);
        let cone = SceneBox {
            id: BoxId(1),
            class: Class::TrafficCone,
            center_m: DVec3::new(2.1, 0.1, 0.4),
            size_m: DVec3::new(0.4, 0.4, 0.8),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let grid = draft(&layout, [&cone].into_iter());
        let [x, y] = extent.column_at(2.1, 0.1).expect("on the map");
        let classes: Vec<u8> = (15..21).map(|z| grid.get(x, y, z)).collect();
        let (ground, cone_id) = (Class::Terrain.id(), Class::TrafficCone.id());
        assert_eq!(
            classes,
            [Class::FREE, ground, cone_id, cone_id, cone_id, Class::FREE]
        );
        // One that is lower than the ground's voxel still shows one.
        assert_eq!(box_bins(lattice, 16, 1), 17..18);
        assert_eq!(box_bins(Lattice::OCC3D, 0, 5), 0..5);
    }
}
