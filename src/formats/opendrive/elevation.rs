//! Height of a road's surface (ASAM OpenDRIVE 1.4 to 1.8): elevation along it, superelevation and crossfall across it,
//! and the height of single lanes.

use super::lanes::{Cubics, Lane, LaneSection, SideLanes};
use super::sampling::LaneEdges;

/// Elevations beyond this are cut, m: above and below every road there is.
pub const MOST_ELEVATION_M: f64 = 1e4;
/// Steeper tilts are cut, rad.
const MOST_TILT_RAD: f64 = 1.4;
/// Higher lanes are cut, m.
const MOST_LANE_HEIGHT_M: f64 = 100.0;
/// A lane raised by no more than this is a kerb. Worlds draw kerbs by themselves, so the relief leaves them out, m.
const KERB_M: f64 = 0.25;

/// How the surface of a road lies; without records it is flat at 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceProfile {
    /// Height of the reference line over `s`, m.
    pub elevation: Cubics,
    /// Tilt about the reference line over `s`, rad; positive where the left side is higher.
    pub superelevation: Cubics,
    /// Fall from the reference line outward over `s` on the left side, rad (OpenDRIVE 1.4).
    pub crossfall_left: Cubics,
    /// Fall from the reference line outward over `s` on the right side, rad (OpenDRIVE 1.4).
    pub crossfall_right: Cubics,
}

impl SurfaceProfile {
    /// True if no record lifts or tilts the road.
    pub fn is_flat(&self) -> bool {
        let all = [
            &self.elevation,
            &self.superelevation,
            &self.crossfall_left,
            &self.crossfall_right,
        ];
        all.iter().all(|c| c.0.iter().all(|p| p.k == [0.0; 4]))
    }

    /// Height of the reference line at `s_m` by the records that hold at `held_m`, m; finite and bounded.
    pub fn elevation_m(&self, s_m: f64, held_m: f64) -> f64 {
        bounded(self.elevation.at(s_m, held_m), MOST_ELEVATION_M)
    }

    /// Tilt at `s_m` by the records that hold at `held_m`, rad; finite and bounded.
    pub fn tilt_rad(&self, s_m: f64, held_m: f64) -> f64 {
        bounded(self.superelevation.at(s_m, held_m), MOST_TILT_RAD)
    }

    /// Height of the surface `offset_m` to the left of the reference line, measured in the plan, lanes not raised, m.
    pub fn height_m(&self, s_m: f64, held_m: f64, offset_m: f64) -> f64 {
        let crossfall = match offset_m > 0.0 {
            true => &self.crossfall_left,
            false => &self.crossfall_right,
        };
        let fall_rad = bounded(crossfall.at(s_m, held_m), MOST_TILT_RAD);
        let height = self.elevation_m(s_m, held_m) + offset_m * self.tilt_rad(s_m, held_m).tan()
            - offset_m.abs() * fall_rad.tan();
        bounded(height, MOST_ELEVATION_M)
    }

    /// Where the records of one of the profiles begin, m.
    pub fn breaks_m(&self) -> impl Iterator<Item = f64> {
        [
            &self.elevation,
            &self.superelevation,
            &self.crossfall_left,
            &self.crossfall_right,
        ]
        .into_iter()
        .flat_map(|c| c.0.iter().map(|p| p.s_m))
    }
}

/// One record of the height of a lane; it holds until the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneHeight {
    /// Start of the record, from the start of the section, m.
    pub s_m: f64,
    /// Height of the lane's inner edge above the surface of the road, m.
    pub inner_m: f64,
    /// Height of its outer edge, m.
    pub outer_m: f64,
}

impl Lane {
    /// Height of the inner and outer edge above the surface of the road `ds_m` after the start of the section, m.
    pub fn height_m(&self, ds_m: f64) -> [f64; 2] {
        let after = self.heights.partition_point(|h| h.s_m <= ds_m);
        match self.heights.get(after.max(1) - 1) {
            Some(h) => [h.inner_m, h.outer_m].map(|m| bounded(m, MOST_LANE_HEIGHT_M)),
            None => [0.0; 2],
        }
    }

    /// True if it is raised or lowered by more than a kerb somewhere.
    pub(super) fn leaves_surface(&self) -> bool {
        let mut edges = self.heights.iter().flat_map(|h| [h.inner_m, h.outer_m]);
        edges.any(|m| beyond_kerb(m) != 0.0)
    }
}

/// Height of the left and right edge of every lane of a row, left to right, m; kerbs left out.
pub(super) fn edge_heights_m(
    surface: &SurfaceProfile,
    section: &LaneSection,
    row: &LaneEdges,
    held_m: f64,
) -> Vec<[f64; 2]> {
    let center = section.center_index();
    let edge = |i: usize| surface.height_m(row.s_m, held_m, row.t_m[i]);
    let raised = |side: &SideLanes, lane: &Lane| {
        lane.height_m(held_m - side.origin_s_m)
            .map(|m| beyond_kerb(bounded(m, MOST_LANE_HEIGHT_M)))
    };
    let lanes = section.lanes_left_to_right().enumerate();
    lanes
        .map(|(i, lane)| {
            let (left, right) = match i < center {
                true => {
                    let [inner, outer] = raised(&section.left, lane);
                    (outer, inner)
                }
                false => {
                    let [inner, outer] = raised(&section.right, lane);
                    (inner, outer)
                }
            };
            [edge(i) + left, edge(i + 1) + right]
        })
        .collect()
}

/// The part of a lane's height that exceeds a kerb, m.
fn beyond_kerb(height_m: f64) -> f64 {
    height_m.signum() * (height_m.abs() - KERB_M).max(0.0)
}

/// Cut to a magnitude; 0 for NaN.
fn bounded(value: f64, most: f64) -> f64 {
    match value.is_nan() {
        true => 0.0,
        false => value.clamp(-most, most),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::opendrive::lanes::CubicPiece;

    fn cubics(pieces: &[(f64, [f64; 4])]) -> Cubics {
        Cubics(pieces.iter().map(|&(s_m, k)| CubicPiece { s_m, k }).collect())
    }

    #[test]
    fn heights_are_those_computed_by_hand() {
        let surface = SurfaceProfile {
            elevation: cubics(&[
                (0.0, [10.0, 0.02, 0.0, 0.0]),
                (50.0, [11.0, 0.02, -0.001, 0.00001]),
            ]),
            superelevation: cubics(&[(20.0, [0.05, 0.0, 0.0, 0.0])]),
            crossfall_right: cubics(&[(0.0, [0.02, 0.0, 0.0, 0.0])]),
            ..SurfaceProfile::default()
        };
        assert!(!surface.is_flat());
        // 10 + 0.02 * 30
        assert!((surface.elevation_m(30.0, 30.0) - 10.6).abs() < 1e-12);
        // 11 + 0.02 * 40 - 0.001 * 1600 + 0.00001 * 64000
        assert!((surface.elevation_m(90.0, 90.0) - 10.84).abs() < 1e-12);
        // The records before and after a joint.
        assert!((surface.elevation_m(50.0, 49.0) - 11.0).abs() < 1e-12);
        // Left: 4 tan 0.05 higher. Right: as much lower, and 4 tan 0.02 more by the crossfall.
        assert!((surface.height_m(30.0, 30.0, 4.0) - (10.6 + 4.0 * 0.050_041_708_375_538_79)).abs() < 1e-12);
        let right = 10.6 - 4.0 * 0.050_041_708_375_538_79 - 4.0 * 0.020_002_667_093_402_424;
        assert!((surface.height_m(30.0, 30.0, -4.0) - right).abs() < 1e-12);
    }

    #[test]
    fn wild_profiles_stay_finite() {
        let wild = cubics(&[
            (-5.0, [f64::MAX, -f64::MAX, f64::MAX, f64::MAX]),
            (0.0, [1e300; 4]),
        ]);
        let surface = SurfaceProfile {
            elevation: wild.clone(),
            superelevation: wild.clone(),
            crossfall_left: wild.clone(),
            crossfall_right: wild,
        };
        for s in [-1e9, -5.0, 0.0, 1.0, 1e6] {
            for t in [-1e3, 0.0, 1e3] {
                assert!(surface.height_m(s, s, t).abs() <= MOST_ELEVATION_M, "{s} {t}");
            }
        }
    }

    #[test]
    fn kerbs_are_no_relief_and_terraces_are() {
        assert_eq!(beyond_kerb(0.12), 0.0);
        assert_eq!(beyond_kerb(-0.2), 0.0);
        assert!((beyond_kerb(1.25) - 1.0).abs() < 1e-12);
        assert!((beyond_kerb(-1.25) + 1.0).abs() < 1e-12);
    }
}
