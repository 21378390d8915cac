//! Boxes in whose place no voxel of their class stands.

use std::ops::Range;

use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::Edit;
use language::tf;
use scene::Frame;
use scene::draft::{box_bins, box_columns, ground_bin};
use scene::raster::box_cells;
use scene::{SceneBox, VoxelGrid};

pub const NAME: &str = "box_without_occupancy";
/// Voxels this far outside a box still belong to it, m.
const MARGIN_M: f64 = 0.3;

/// Bins of a column that the fix fills: from the lowest up where labels let the ground down, else above the ground.
fn bins(frame: &Frame, x: usize, y: usize, layers: usize) -> Range<usize> {
    match frame.extent().lattice().lowered() {
        0 => box_bins(frame.extent().lattice(), ground_bin(&frame.layout, x, y), layers),
        _ => 0..layers,
    }
}

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let grid = &context.frame.occupancy;
    for b in &context.boxes {
        let columns = box_columns(grid.extent(), b);
        // A box outside the grid cannot have voxels.
        if columns.is_empty() || voxels(grid, b) > 0 {
            continue;
        }
        let cells = columns
            .iter()
            .flat_map(|&(x, y, layers)| bins(context.frame, x, y, layers).map(move |z| [x, y, z]));
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
