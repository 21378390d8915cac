//! Roads that leave the grid: where, how wide, in which direction they go on.

use glam::DVec2;

use crate::beyond::border::{Border, Covered, DEPTHS, GridSide, SIDES};
use scene::{Class, Lattice, Polyline, PolylineKind};

/// Least and largest width of a road, cells: narrower ground is no road, wider ground is a road along the edge.
const LEAST: usize = 7;
const MOST: usize = 90;
/// Largest distance of a lane's last vertex from the edge at which the lane ends there, m.
const AT_EDGE_M: f64 = 2.5;
/// Length of lane that gives its direction, m.
const TANGENT_M: f64 = 6.0;
/// Least cosine between a road that leaves the grid and the normal of the side.
const LEAST_COSINE: f64 = 0.3;
/// Widest sidewalk, cells.
const MOST_WALK: usize = 15;

/// A road that leaves the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// Middle of the road at the edge, m.
    pub at: DVec2,
    /// Direction in which it goes: a unit vector, outward.
    pub heading: DVec2,
    /// Half its width, m.
    pub half_m: f64,
    /// Width of the sidewalk on its right and left, m.
    pub walk_m: [f64; 2],
}

impl Exit {
    /// Distance along the road from the edge, and to its left, m.
    pub fn local(&self, p: DVec2) -> DVec2 {
        let d = p - self.at;
        DVec2::new(d.dot(self.heading), self.heading.perp_dot(d))
    }

    /// The point so far along and to the left.
    pub fn point(&self, along_m: f64, left_m: f64) -> DVec2 {
        self.at + self.heading * along_m + self.heading.perp() * left_m
    }

    /// Distance from the middle to the outer edge of the sidewalk on the right or left, m.
    pub fn reach_m(&self, left: bool) -> f64 {
        self.half_m + self.walk_m[usize::from(left)]
    }

    /// Road or sidewalk, if the point is on either.
    pub fn ground(&self, p: DVec2) -> Option<Class> {
        let q = self.local(p);
        // At a slant the road begins before its middle leaves the grid.
        if q.x < -2.0 * self.half_m {
            return None;
        }
        match q.y.abs() {
            side if side <= self.half_m => Some(Class::DriveableSurface),
            side if side <= self.reach_m(q.y > 0.0) => Some(Class::Sidewalk),
            _ => None,
        }
    }
}

/// The roads that leave the grid. Lanes give the direction; without any, the road's course over its last eight metres
/// does.
pub fn exits(border: &Border, lines: &[Polyline]) -> Vec<Exit> {
    let ends: Vec<[DVec2; 2]> = lines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter)
        .flat_map(|l| lane_ends(&l.points_m))
        .collect();
    let (extent, covered) = (border.extent(), border.covered());
    let mut out = Vec::new();
    for side in SIDES {
        for run in runs(border, side, 0) {
            let cells = run[1] - run[0];
            if !(LEAST..=MOST).contains(&cells) {
                continue;
            }
            let (a, b) = (side.point(extent, 0, run[0]), side.point(extent, 0, run[1] - 1));
            let wide = 0.5 * Lattice::OCC3D.voxel_m();
            let at = (a + b) / 2.0 + side.normal() * wide;
            let near = |p: DVec2| p.distance(at) < (cells as f64 / 2.0 + 2.0) * Lattice::OCC3D.voxel_m();
            let lanes = ends
                .iter()
                .filter(|[p, _]| near(*p) && inside_m(covered, *p, side) < AT_EDGE_M);
            let along: DVec2 = lanes.map(|[_, direction]| *direction).sum();
            let heading = along
                .try_normalize()
                .or_else(|| course(border, side, run))
                .filter(|h| h.dot(side.normal()) > LEAST_COSINE)
                .unwrap_or(side.normal());
            let cosine = heading.dot(side.normal());
            // Right and left of the heading, in the order of the cells along the side.
            let walks = [
                walk(border, side, run[0], false),
                walk(border, side, run[1], true),
            ];
            let low_is_left = heading.perp_dot(a - at) > 0.0;
            let walk_m = if low_is_left { [walks[1], walks[0]] } else { walks };
            out.push(Exit {
                at,
                heading,
                half_m: cells as f64 * wide * cosine,
                walk_m: walk_m.map(|cells| cells as f64 * Lattice::OCC3D.voxel_m() * cosine),
            });
        }
    }
    out
}

/// How far a point lies inside a side, m.
fn inside_m(covered: Covered, p: DVec2, side: GridSide) -> f64 {
    match side.high {
        true => covered.high[side.axis] - p[side.axis],
        false => p[side.axis] - covered.low[side.axis],
    }
}

/// Ends of a lane with the unit vectors that lead out of it.
fn lane_ends(points: &[DVec2]) -> Vec<[DVec2; 2]> {
    let end = |mut back: Box<dyn Iterator<Item = DVec2> + '_>| -> Option<[DVec2; 2]> {
        let last = back.next()?;
        let before = back.find(|p| p.distance(last) >= TANGENT_M)?;
        Some([last, (last - before).try_normalize()?])
    };
    let forth = end(Box::new(points.iter().rev().copied()));
    let back = end(Box::new(points.iter().copied()));
    [forth, back].into_iter().flatten().collect()
}

/// Half-open runs of road along a side at a depth.
fn runs(border: &Border, side: GridSide, depth: usize) -> Vec<[usize; 2]> {
    let mut out: Vec<[usize; 2]> = Vec::new();
    for along in 0..side.cells(border.extent()) {
        if border.ground(side, depth, along) != Class::DriveableSurface {
            continue;
        }
        match out.last_mut() {
            // A gap of a cell or two is a manhole or a divider.
            Some(run) if along <= run[1] + 2 => run[1] = along + 1,
            _ => out.push([along, along + 1]),
        }
    }
    out
}

/// Direction of a road from its middle at several depths; `None` where its width changes, as in a junction.
fn course(border: &Border, side: GridSide, run: [usize; 2]) -> Option<DVec2> {
    let middle = |depth: usize, run: [usize; 2]| {
        let point = |along: usize| side.point(border.extent(), DEPTHS[depth], along);
        (point(run[0]) + point(run[1] - 1)) / 2.0
    };
    let (mut last, mut from) = (run, None);
    for depth in 1..DEPTHS.len() {
        let met = runs(border, side, depth)
            .into_iter()
            .find(|r| r[0] < last[1] && last[0] < r[1])?;
        let (was, is) = (run[1] - run[0], met[1] - met[0]);
        if is * 3 > was * 4 || was * 3 > is * 4 {
            break;
        }
        from = Some(middle(depth, met));
        last = met;
    }
    (middle(0, run) - from?).try_normalize()
}

/// Cells of sidewalk beside the end of a run.
fn walk(border: &Border, side: GridSide, end: usize, upward: bool) -> usize {
    let at = |i: usize| match upward {
        true => Some(end + i).filter(|a| *a < side.cells(border.extent())),
        false => end.checked_sub(i + 1),
    };
    (0..MOST_WALK)
        .take_while(|i| at(*i).is_some_and(|a| border.ground(side, 0, a) == Class::Sidewalk))
        .count()
}
