//! The layout of a scene as the elements of a world scenario.

use glam::{DVec2, DVec3};
use scene::road_map::{HALF_LANE_M, RoadMap};
use scene::{BevLayer, BevLayout, PolylineKind, Pose, Scene};

use super::boundary::borders;
use super::on_ground;

/// Largest distance between points of a line, m, so that it follows the ground.
const STEP_M: f64 = 2.0;
/// Slope by which crossings are tilted.
const TILT: f64 = 1e-3;
/// How far around a point of a lane's edge its marking is looked for, m.
const NEAR_M: f64 = 0.8;

/// How a line on the road looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marking {
    /// Between opposite directions: two yellow lines, solid, as our own pictures have them.
    Divider,
    /// Between lanes of one direction: white, long dashes.
    LaneDivider,
}

impl Marking {
    /// Colour and style in the tables.
    pub(crate) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Divider => ("YELLOW", "SOLID_GROUP"),
            Self::LaneDivider => ("WHITE", "LONG_DASHED_SINGLE"),
        }
    }
}

/// Mark on the edge of a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LaneEdgeMark {
    Line(Marking),
    Boundary,
    Nothing,
}

impl LaneEdgeMark {
    /// Colour and style in the tables.
    pub(crate) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Line(Marking::Divider) => ("YELLOW", "SOLID"),
            Self::Line(Marking::LaneDivider) => ("WHITE", "DASHED"),
            Self::Boundary => ("UNKNOWN", "ROAD_BOUNDARY"),
            Self::Nothing => ("UNKNOWN", "VIRTUAL"),
        }
    }
}

/// An edge of a lane with the mark on each of its segments.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rail {
    pub(crate) points_m: Vec<DVec3>,
    pub(crate) edges: Vec<LaneEdgeMark>,
}

/// The elements of a scene's map, in the frame of the scenario, m.
#[derive(Debug, Default)]
pub(crate) struct ScenarioMap {
    /// Left and right edge of each lane, in driving direction.
    pub(crate) lanes: Vec<[Rail; 2]>,
    pub(crate) lines: Vec<(Marking, Vec<DVec3>)>,
    pub(crate) boundaries: Vec<Vec<DVec3>>,
    /// Outlines; the first corner is not repeated.
    pub(crate) crossings: Vec<Vec<DVec3>>,
    pub(crate) stop_lines: Vec<Vec<DVec3>>,
}

/// Tilts a crossing along x by a millimetre a metre more than it is: the public renderer cuts it into triangles by y and z alone, where
/// one on level ground is a line.
fn tilt(corners: &mut [DVec3]) {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let along: f64 = corners.iter().map(|c| (c.x - middle.x) * (c.z - middle.z)).sum();
    let slope = if along < 0.0 { -TILT } else { TILT };
    for corner in corners {
        corner.z += slope * (corner.x - middle.x);
    }
}

impl ScenarioMap {
    /// The map of a scene. Points that are not finite are left out.
    pub(crate) fn from_scene(scene: &Scene, scenario_from_world: &Pose) -> Self {
        let layout = &scene.canvas().layout;
        let lifted = |line: &[DVec2]| -> Vec<DVec3> {
            let dense = dense(line);
            dense
                .into_iter()
                .map(|p| on_ground(scene, scenario_from_world, p))
                .collect()
        };
        let mut out = Self::default();
        for line in layout.polylines.iter() {
            let points_m: Vec<DVec2> = line.points_m.iter().copied().filter(|p| p.is_finite()).collect();
            let least = if line.kind == PolylineKind::PedCrossing {
                3
            } else {
                2
            };
            if points_m.len() < least {
                continue;
            }
            match line.kind {
                PolylineKind::RoadDivider => out.lines.push((Marking::Divider, lifted(&points_m))),
                PolylineKind::LaneDivider => out.lines.push((Marking::LaneDivider, lifted(&points_m))),
                PolylineKind::StopLine => out.stop_lines.push(lifted(&points_m)),
                PolylineKind::PedCrossing => {
                    let corners = points_m.iter().map(|p| on_ground(scene, scenario_from_world, *p));
                    let mut corners: Vec<DVec3> = corners.collect();
                    tilt(&mut corners);
                    out.crossings.push(corners);
                }
                PolylineKind::LaneCenter | PolylineKind::SpeedLimit { .. } => {}
            }
        }
        let bits = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
        let cells = layout.cells();
        for border in borders(layout.extent(), |i| cells[i] & bits != 0) {
            let mut points_m = border.points_m;
            if border.is_closed {
                points_m.extend(points_m.first().copied());
            }
            out.boundaries.push(lifted(&points_m));
        }
        for lane in RoadMap::new(layout).lanes {
            if lane.points_m.len() < 2 {
                continue;
            }
            out.lanes.push([HALF_LANE_M, -HALF_LANE_M].map(|offset_m| {
                let points = beside(&thinned(&lane.points_m), offset_m);
                let edges = points.windows(2).map(|w| edge(layout, (w[0] + w[1]) / 2.0));
                Rail {
                    edges: edges.collect(),
                    points_m: points
                        .iter()
                        .map(|p| on_ground(scene, scenario_from_world, *p))
                        .collect(),
                }
            }));
        }
        out
    }
}

/// A line with points at most [`STEP_M`] apart.
fn dense(line: &[DVec2]) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = line.first().copied().into_iter().collect();
    for pair in line.windows(2) {
        let parts = (pair[0].distance(pair[1]) / STEP_M).ceil().clamp(1.0, 10_000.0) as usize;
        out.extend((1..=parts).map(|i| pair[0].lerp(pair[1], i as f64 / parts as f64)));
    }
    out
}

/// Every second point of a line, and its last.
fn thinned(line: &[DVec2]) -> Vec<DVec2> {
    let last = line.len().saturating_sub(1);
    let kept = line.iter().enumerate().filter(|(i, _)| i % 2 == 0 || *i == last);
    kept.map(|(_, p)| *p).collect()
}

/// A line `offset_m` to the left of another, m.
fn beside(line: &[DVec2], offset_m: f64) -> Vec<DVec2> {
    let direction = |i: usize| {
        let (from, to) = (i.saturating_sub(1), (i + 1).min(line.len() - 1));
        (line[to] - line[from]).try_normalize().unwrap_or(DVec2::X)
    };
    (0..line.len())
        .map(|i| line[i] + direction(i).perp() * offset_m)
        .collect()
}

/// The mark on a lane's edge at a point, told by the layers around it.
fn edge(layout: &BevLayout, at_m: DVec2) -> LaneEdgeMark {
    let extent = layout.extent();
    let reach = (NEAR_M * extent.lattice().per_m()).round() as i64;
    let Some([x, y]) = extent.column_at(at_m.x, at_m.y) else {
        return LaneEdgeMark::Nothing;
    };
    let around = (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| (x as i64 + i, y as i64 + j)));
    let cells = around.filter_map(|(i, j)| {
        let (i, j) = (usize::try_from(i).ok()?, usize::try_from(j).ok()?);
        extent.holds(i, j).then(|| layout.cell(i, j))
    });
    let (mut divider, mut lane_divider, mut off_road) = (false, false, false);
    for cell in cells {
        divider |= cell & BevLayer::RoadDivider.bit() != 0;
        lane_divider |= cell & BevLayer::LaneDivider.bit() != 0;
        off_road |= cell & (BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit()) == 0;
    }
    match () {
        () if divider => LaneEdgeMark::Line(Marking::Divider),
        () if lane_divider => LaneEdgeMark::Line(Marking::LaneDivider),
        () if off_road => LaneEdgeMark::Boundary,
        () => LaneEdgeMark::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area of the triangle of the first three corners, seen along x, m2.
    fn area(corners: &[DVec3]) -> f64 {
        let [a, b, c] = [0, 1, 2].map(|i| DVec2::new(corners[i].y, corners[i].z));
        (b - a).perp_dot(c - a).abs()
    }

    #[test]
    fn no_crossing_is_a_line_seen_along_x() {
        for slope in [
            DVec2::ZERO,
            DVec2::new(1e-3, 0.0),
            DVec2::new(-1e-3, 0.0),
            DVec2::new(0.0, 0.05),
        ] {
            let corner = |x: f64, y: f64| DVec3::new(x, y, slope.dot(DVec2::new(x, y)));
            let mut corners = [
                corner(20.0, 5.0),
                corner(20.0, -2.0),
                corner(23.0, -2.0),
                corner(23.0, 5.0),
            ];
            let before = corners;
            tilt(&mut corners);
            assert!(area(&corners) > 0.02, "{slope}: {}", area(&corners));
            for (a, b) in before.iter().zip(&corners) {
                assert!((a.z - b.z).abs() <= 0.002 && a.truncate() == b.truncate());
            }
        }
    }
}
