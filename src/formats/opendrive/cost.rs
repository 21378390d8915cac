//! Costs of drawing on a map, in the units of a budget: next to nothing for what roads have, much for what was made to
//! be slow.

use glam::DVec2;

use scene::{Extent, Polyline, PolylineKind, Window};

/// Cost of going along an outline or a line of so many points on every row of a map.
pub(super) fn of_scan(extent: Extent, points: usize) -> usize {
    /// Points of a strip of lane or of a crossing; only those beyond are counted.
    const FEW: usize = 16;
    points
        .saturating_sub(FEW)
        .saturating_mul(extent.nx().max(extent.ny()))
        / 256
}

/// Cost of drawing a line.
pub(super) fn of_line(extent: Extent, line: &Polyline) -> usize {
    let scan = of_scan(extent, line.points_m.len());
    match line.kind {
        PolylineKind::LaneCenter => 0,
        PolylineKind::PedCrossing => scan + columns_around(extent, line) / 8,
        _ => scan,
    }
}

/// Columns of the rectangle around a line, as many as the map has at most.
fn columns_around(extent: Extent, line: &Polyline) -> usize {
    let low = line.points_m.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = line
        .points_m
        .iter()
        .copied()
        .fold(DVec2::NEG_INFINITY, DVec2::max);
    let most = DVec2::new(extent.nx() as f64, extent.ny() as f64);
    let sides = ((high - low) / Window::VOXEL_M).clamp(DVec2::ZERO, most);
    (sides.x * sides.y) as usize
}
