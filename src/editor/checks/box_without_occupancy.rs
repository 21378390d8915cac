//! Boxes in whose place no voxel of their class stands.

use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::Edit;
use language::tf;
use scene::draft::{box_bins, box_columns, ground_bin};
use scene::raster::box_cells;
use scene::{SceneBox, VoxelGrid};

pub const NAME: &str = "box_without_occupancy";
/// Voxels this far outside a box still belong to it, m.
const MARGIN_M: f64 = 0.3;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let grid = &context.frame.occupancy;
    for b in &context.boxes {
        let columns = box_columns(grid.extent(), b);
        // A box outside the grid cannot have voxels.
        if columns.is_empty() || voxels(grid, b) > 0 {
            continue;
        }
        let lattice = grid.extent().lattice();
        let cells = columns.iter().flat_map(|&(x, y, layers)| {
            let ground = ground_bin(&context.frame.layout, x, y);
            box_bins(lattice, ground, layers).map(move |z| [x, y, z])
        });
        out.push(Finding {
            check: NAME,
            severity: Severity::Error,
            where_m: b.center_m,
            box_id: Some(b.id),
            time_s: None,
            cells: Vec::new(),
            text: tf!("{thing} has no voxel of its class", thing = name_of(b)),
            fixes: vec![
                Fix {
                    label: "Fill the box with voxels",
                    edits: vec![Edit::PaintVoxels {
                        cells: cells.collect(),
                        class: b.class,
                    }],
                },
                Fix {
                    label: "Remove the box",
                    edits: vec![Edit::RemoveBox { id: b.id }],
                },
            ],
        });
    }
}

/// Voxels of a box's class in the columns of its footprint, up to its top.
pub fn voxels(grid: &VoxelGrid, b: &SceneBox) -> usize {
    let extent = grid.extent();
    let top_m = b.center_m.z + b.size_m.z / 2.0 + extent.voxel_m();
    let mut count = 0;
    box_cells(extent, b, MARGIN_M, |x, y| {
        let column = grid.column(x, y).iter().enumerate();
        count += column
            .filter(|(z, l)| {
                **l == b.class.id()
                    && extent.center(x, y, *z).z <= top_m.max(extent.lattice().bottom_m() + extent.voxel_m())
            })
            .count();
    });
    count
}
