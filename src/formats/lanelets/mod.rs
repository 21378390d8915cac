//! Lanelets, the roads of Lanelet2 and CommonRoad: pieces of lane between a left and a right bound. Each becomes a road
//! of one lane in an OpenDRIVE network, so that all code which reads such a network (a place on it, heights, junctions)
//! reads these maps too.

mod junctions;
mod road;
pub(crate) mod utm;

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::opendrive::lanes::{LaneGround, LaneKind};
use crate::opendrive::xml::count;
use crate::opendrive::{RoadNetwork, RoadlessGeometry, Skipped};
use scene::{Polyline, PolylineKind, SceneBox};

/// Points of all bounds together, at most; a city has about a million.
pub(crate) const MOST_POINTS: usize = 4_000_000;

/// Use of a lanelet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Motor traffic.
    Traffic,
    /// People on foot; also for bicycles behind a kerb.
    Walking,
    /// Ground of this kind without traffic.
    Ground(LaneGround),
    /// People who cross a road.
    Crossing,
    /// No use that a scene shows.
    Nothing,
}

/// A piece of lane.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lanelet {
    /// Id in the file.
    pub id: i64,
    /// Left and right bound in driving direction, m; at least two points each.
    pub bounds: [Vec<DVec3>; 2],
    pub use_: Use,
    /// True if it is driven both ways.
    pub two_way: bool,
    /// Ids of the lanelets behind it.
    pub successors: Vec<i64>,
}

/// A bound between two lanelets, painted or not.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Between {
    /// Ids of the lanelets on its two sides.
    pub lanelets: [i64; 2],
    pub points_m: Vec<DVec3>,
    /// True if traffic runs against each other on its two sides.
    pub opposite: bool,
    /// True if there is paint.
    pub painted: bool,
}

/// A map of lanelets.
#[derive(Default)]
pub(crate) struct LaneletMap {
    pub name: String,
    pub lanelets: Vec<Lanelet>,
    /// Bounds that two lanelets with traffic share.
    pub between: Vec<Between>,
    pub stop_lines: Vec<Vec<DVec2>>,
    /// Outlines of ground without lanelets.
    pub areas: Vec<(LaneGround, Vec<DVec2>)>,
    /// Boxes that stand on the roads or drive there, on ground at 0.
    pub boxes: Vec<SceneBox>,
    /// Where the file says that the ego vehicle begins: place in m, heading in rad.
    pub start: Option<(DVec2, f64)>,
    pub skipped: Skipped,
}

impl Lanelet {
    /// From bounds in any direction: they are turned so that both run with the traffic, the left one on the left (as Lanelet2
    /// does). `None` for bounds of fewer than two points that differ.
    pub fn new(id: i64, left: Vec<DVec3>, right: Vec<DVec3>, use_: Use) -> Option<Self> {
        let tidy = |mut points: Vec<DVec3>| {
            points.dedup_by(|a, b| a.distance(*b) < 1e-3);
            (points.len() >= 2).then_some(points)
        };
        let (mut left, mut right) = (tidy(left)?, tidy(right)?);
        let ends = |points: &[DVec3]| [points[0], points[points.len() - 1]].map(|p| p.truncate());
        let ([a, b], [c, d]) = (ends(&left), ends(&right));
        if a.distance(c) + b.distance(d) > a.distance(d) + b.distance(c) {
            right.reverse();
        }
        // Forward along the left bound and back along the right one runs clockwise.
        let ring: Vec<DVec2> = left
            .iter()
            .chain(right.iter().rev())
            .map(|p| p.truncate())
            .collect();
        let twice: f64 = (0..ring.len())
            .map(|i| (ring[i] - ring[0]).perp_dot(ring[(i + 1) % ring.len()] - ring[0]))
            .sum();
        if twice > 0.0 {
            left.reverse();
            right.reverse();
        }
        Some(Self {
            id,
            bounds: [left, right],
            use_,
            two_way: false,
            successors: Vec::new(),
        })
    }

    /// Its outline.
    pub fn outline(&self) -> Vec<DVec2> {
        let [left, right] = &self.bounds;
        left.iter()
            .chain(right.iter().rev())
            .map(|p| p.truncate())
            .collect()
    }
}

/// Lanelets behind one, at most: the widest junctions have a dozen.
const MOST_SUCCESSORS: usize = 64;

/// Gives every lanelet the successors that begin where it ends: both bounds go on in the same points. Those beyond
/// [`MOST_SUCCESSORS`] are left out and counted.
pub(crate) fn link_by_ends(lanelets: &mut [Lanelet], skipped: &mut Skipped) {
    let key = |p: DVec3| [p.x, p.y].map(|v| (v * 1000.0).round() as i64);
    let mut begins: BTreeMap<[[i64; 2]; 2], Vec<i64>> = BTreeMap::new();
    for l in lanelets.iter() {
        let starts = [l.bounds[0][0], l.bounds[1][0]].map(key);
        begins.entry(starts).or_default().push(l.id);
    }
    for l in lanelets {
        let ends = [0, 1].map(|side| key(l.bounds[side][l.bounds[side].len() - 1]));
        let behind = begins.get(&ends).map_or(&[][..], Vec::as_slice);
        l.successors = behind.iter().take(MOST_SUCCESSORS).copied().collect();
        if behind.len() > MOST_SUCCESSORS {
            count(
                skipped,
                format!("lanelet with more than {MOST_SUCCESSORS} behind it"),
            );
        }
    }
}

/// The roads of a map. Errors in one line if no lanelet carries traffic, and for lanelets longer than any is or more than are read.
pub(crate) fn network(map: LaneletMap) -> Result<RoadNetwork, String> {
    let LaneletMap {
        name,
        lanelets,
        between,
        stop_lines,
        areas,
        boxes,
        start,
        mut skipped,
    } = map;
    let becomes_road = |l: &&Lanelet| matches!(l.use_, Use::Traffic | Use::Walking);
    if let Some(problem) = road::problem(lanelets.iter().filter(becomes_road)) {
        return Err(problem);
    }
    let of = junctions::find(&lanelets);
    let mut roads = Vec::new();
    let mut drawn = RoadlessGeometry {
        areas,
        ..RoadlessGeometry::default()
    };
    for l in &lanelets {
        let kind = match l.use_ {
            Use::Traffic => LaneKind::Driving,
            Use::Walking => LaneKind::Sidewalk,
            Use::Ground(ground) => {
                drawn.areas.push((ground, l.outline()));
                continue;
            }
            Use::Crossing => {
                drawn.lines.push(Polyline {
                    kind: PolylineKind::PedCrossing,
                    points_m: l.outline(),
                });
                continue;
            }
            Use::Nothing => continue,
        };
        match road::of_lanelet(l, kind, &of) {
            Some(road) => roads.push(road),
            None => *skipped.entry("lanelet without a length".into()).or_default() += 1,
        }
    }
    if !lanelets.iter().any(|l| l.use_ == Use::Traffic) || roads.is_empty() {
        return Err(format!(
            "no lanelet for traffic among {}, expected at least one",
            lanelets.len()
        ));
    }
    let in_junction = |id: &i64| of.junction_of.contains_key(id);
    for line in between {
        let kind = match (line.opposite, line.painted) {
            (true, _) => PolylineKind::RoadDivider,
            (false, true) => PolylineKind::LaneDivider,
            (false, false) => continue,
        };
        // As on connecting roads of OpenDRIVE.
        if !line.lanelets.iter().all(in_junction) {
            drawn.lines.push(Polyline {
                kind,
                points_m: line.points_m.iter().map(|p| p.truncate()).collect(),
            });
        }
    }
    drawn
        .lines
        .extend(stop_lines.into_iter().map(|points_m| Polyline {
            kind: PolylineKind::StopLine,
            points_m,
        }));
    Ok(RoadNetwork::of_lanelets(
        name,
        roads,
        of.junctions,
        drawn,
        boxes,
        start,
        skipped,
    ))
}

#[cfg(test)]
mod tests;
