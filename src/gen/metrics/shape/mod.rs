//! Shapes of one frame in numbers: outlines, parts and roofs of manmade voxels, holes in the ground, crowns and other
//! things without support. Each figure changes when the fault it is named after is put in by hand.

mod holes;
mod manmade;
mod outline;
mod support;

use std::collections::BTreeMap;

use scene::VoxelGrid;

/// Figures of a frame by name. A figure is missing if the frame has nothing to measure it on (no wall, no sidewalk).
pub type ShapeFigures = BTreeMap<&'static str, f64>;

/// Description of each figure, in the order of tables: name, one line.
pub const FIGURES: [(&str, &str); 14] = [
    (
        manmade::EDGE,
        "sides that face a column without manmade, per manmade column",
    ),
    (manmade::PARTS, "connected manmade parts seen from above"),
    (manmade::PART_COLUMNS, "columns of a part, median"),
    (
        manmade::ROOF_STEPS,
        "neighbouring manmade columns with tops of different height, share",
    ),
    (
        outline::STRAIGHT,
        "outline of manmade parts that runs straight for 3.6 m, share",
    ),
    (
        outline::DEVIATION_M,
        "distance of an outline to the line fitted to 3.6 m of it, RMS, m",
    ),
    (
        holes::NAMES[0],
        "holes in the driveable surface, share of its area",
    ),
    (holes::NAMES[1], "holes in other flat ground"),
    (holes::NAMES[2], "holes in the sidewalk"),
    (holes::NAMES[3], "holes in the terrain"),
    (support::CROWNS, "groups of vegetation that rest on nothing"),
    (support::CROWN_SHARE, "vegetation voxels in such groups, share"),
    (
        support::PARTS,
        "groups of voxels that nothing connects to the ground",
    ),
    (support::VOXELS, "voxels of such groups"),
];

/// All figures of a frame.
pub fn shape(grid: &VoxelGrid) -> ShapeFigures {
    let mut out = ShapeFigures::new();
    manmade::figures(grid, &mut out);
    outline::figures(grid, &mut out);
    holes::figures(grid, &mut out);
    support::figures(grid, &mut out);
    out
}

/// Adds a ratio, unless the whole is 0.
fn share(out: &mut ShapeFigures, name: &'static str, part: usize, whole: usize) {
    if whole > 0 {
        out.insert(name, part as f64 / whole as f64);
    }
}

#[cfg(test)]
mod tests;
