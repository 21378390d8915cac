//! Lanes near a place: their middle lines, in driving direction.

use glam::DVec2;

use scene::{BevLayout, PolylineKind};

/// A piece of a lane's middle line near a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LanePiece {
    /// Nearest point of it, m.
    pub point_m: DVec2,
    /// Distance to it, m.
    pub distance_m: f64,
    /// Driving direction, rad.
    pub heading_rad: f64,
}

/// Pieces within `reach_m` of a place, in the order of the layout's lines.
pub fn near(layout: &BevLayout, p: DVec2, reach_m: f64) -> Vec<LanePiece> {
    let lanes = layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    let pieces = lanes.flat_map(|l| l.points_m.windows(2)).filter_map(|pair| {
        let (a, d) = (pair[0], pair[1] - pair[0]);
        let length_squared = d.length_squared();
        // Written so that NaN fails too.
        if !(length_squared > 0.0 && length_squared.is_finite()) {
            return None;
        }
        let point_m = a + d * ((p - a).dot(d) / length_squared).clamp(0.0, 1.0);
        let distance_m = p.distance(point_m);
        (distance_m <= reach_m).then(|| LanePiece {
            point_m,
            distance_m,
            heading_rad: d.to_angle(),
        })
    });
    pieces.collect()
}

/// The nearest piece; of several as near, the first.
pub fn nearest(layout: &BevLayout, p: DVec2, reach_m: f64) -> Option<LanePiece> {
    let pieces = near(layout, p, reach_m);
    pieces
        .into_iter()
        .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

/// The angle between two headings, 0 to 180 degrees.
pub fn gap_deg(a_rad: f64, b_rad: f64) -> f64 {
    let gap = (a_rad - b_rad).to_degrees().rem_euclid(360.0);
    gap.min(360.0 - gap)
}
