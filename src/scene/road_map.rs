//! A layout as a driver reads it: whole lanes and their roles for the ego vehicle, crossings, junctions, distances to
//! kerbs. All code that places boxes on a layout, or judges their places, uses it.

use std::sync::OnceLock;

use glam::DVec2;

use super::distance::{nearest_source, signed_distance_m};
use super::graph::LaneRole;
use super::{BevLayer, BevLayout, Extent, PolylineKind};

/// Half of the width that is assumed for a lane, m.
pub const HALF_LANE_M: f64 = 1.75;
/// Reach of the strip beside the road from the road's border, m (a parking strip and a little).
pub const ROADSIDE_M: f64 = 2.8;
/// Distance between the samples of a lane, m.
const STEP_M: f64 = 1.0;

/// A lane, joined of the layout's pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    /// Its role for the ego vehicle.
    pub role: LaneRole,
    /// Index of its first piece among the layout's polylines.
    pub polyline: u32,
    /// Middle of the lane in driving direction, a point at every metre or so, within the grid.
    pub points_m: Vec<DVec2>,
}

/// The nearest place on a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LanePoint {
    /// Index into [`RoadMap::lanes`].
    pub lane: usize,
    /// Place on the middle of the lane, ego frame, m.
    pub position_m: DVec2,
    /// Unit vector of the driving direction.
    pub direction: DVec2,
    /// Distance from the given point, m.
    pub distance_m: f64,
    /// Signed distance from the lane, m: positive to its left.
    pub offset_m: f64,
    /// Distance along the lane, m.
    pub along_m: f64,
}

/// A crossing.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossingArea {
    /// Index among the layout's polylines.
    pub polyline: u32,
    /// Its outline.
    pub outline_m: Vec<DVec2>,
    /// Mean of its corners.
    pub center_m: DVec2,
}

/// Lanes, areas and distances of a layout.
#[derive(Clone, Debug)]
pub struct RoadMap {
    /// Lanes, in the order of the layout's polylines.
    pub lanes: Vec<Lane>,
    /// Index of the lane that the ego vehicle drives in.
    pub ego_lane: Option<usize>,
    /// Crossings, the nearest to the ego vehicle first.
    pub crossings: Vec<CrossingArea>,
    /// Places where lanes of different directions cross, the nearest to the ego vehicle first.
    pub junctions_m: Vec<DVec2>,
    /// Border between the ego's side of the road and the other side, as an offset from the ego lane (left is positive),
    /// m.
    pub middle_m: f64,
    extent: Extent,
    cells: Vec<u32>,
    distance_m: [OnceLock<Vec<f32>>; AREAS.len()], // computed on first use
    nearest: Option<Vec<u32>>,                     // cell with the nearest lane sample
    sample_of: Vec<(u32, u32)>,                    // lane and point of a cell's sample
}

/// Layers whose borders are measured.
const AREAS: [BevLayer; 4] = [
    BevLayer::DrivableArea,
    BevLayer::CarparkArea,
    BevLayer::Walkway,
    BevLayer::PedCrossing,
];

impl RoadMap {
    /// Reads a layout. Points that are not finite are dropped.
    pub fn new(layout: &BevLayout) -> Self {
        let extent = layout.extent();
        let mut lanes = joined(layout);
        let ego_lane = ego_lane(&lanes);
        let axis: Vec<DVec2> = match ego_lane {
            Some(i) => lanes[i].points_m.clone(),
            None => (-40..=40).map(|x| DVec2::new(f64::from(x), 0.0)).collect(),
        };
        let middle_m = assign_roles(&mut lanes, ego_lane, &axis);
        let mut sample_of = vec![(u32::MAX, 0); extent.columns()];
        for (i, lane) in lanes.iter().enumerate() {
            for (k, p) in lane.points_m.iter().enumerate() {
                if let Some([x, y]) = extent.column_at(p.x, p.y) {
                    sample_of[extent.index(x, y)] = (i as u32, k as u32);
                }
            }
        }
        let nearest = nearest_source(extent, |c| sample_of[c].0 != u32::MAX);
        let mut crossings: Vec<CrossingArea> = Vec::new();
        for (i, line) in layout.polylines.iter().enumerate() {
            let sound = line.points_m.len() >= 3 && line.points_m.iter().all(|p| p.is_finite());
            if line.kind == PolylineKind::PedCrossing && sound {
                let center_m = line.points_m.iter().sum::<DVec2>() / line.points_m.len() as f64;
                crossings.push(CrossingArea {
                    polyline: i as u32,
                    outline_m: line.points_m.clone(),
                    center_m,
                });
            }
        }
        crossings.retain(|c| is_within(extent, c.center_m, 0.0));
        crossings.sort_by(|a, b| a.center_m.length().total_cmp(&b.center_m.length()));
        let junctions_m = junctions(extent, &lanes);
        Self {
            lanes,
            ego_lane,
            crossings,
            junctions_m,
            middle_m,
            extent,
            cells: layout.cells().to_vec(),
            distance_m: Default::default(),
            nearest,
            sample_of,
        }
    }

    fn column(&self, p: DVec2) -> Option<usize> {
        let [x, y] = self.extent.column_at(p.x, p.y)?;
        Some(self.extent.index(x, y))
    }

    /// True if the layer is set under the point; false outside the grid.
    pub fn has(&self, layer: BevLayer, p: DVec2) -> bool {
        self.column(p).is_some_and(|c| self.cells[c] & layer.bit() != 0)
    }

    /// True on ground that vehicles may stand on: road or car park.
    pub fn is_for_vehicles(&self, p: DVec2) -> bool {
        self.has(BevLayer::DrivableArea, p) || self.has(BevLayer::CarparkArea, p)
    }

    /// Distance to the border of the drivable area, m: negative on it. 1000 m outside the grid.
    pub fn from_road_m(&self, p: DVec2) -> f64 {
        self.from_area_m(0, p)
    }

    /// Distance to the border of an area (0 road, 1 car park, 2 walkway, 3 crossing), m: negative inside.
    pub fn from_area_m(&self, area: usize, p: DVec2) -> f64 {
        let (Some(cell), Some(kept)) = (self.column(p), self.distance_m.get(area)) else {
            return 1000.0;
        };
        let bit = AREAS[area].bit();
        let distances = kept.get_or_init(|| signed_distance_m(self.extent, |c| self.cells[c] & bit != 0));
        f64::from(distances[cell])
    }

    /// The nearest place on any lane, found through the nearest sample: exact to a few decimetres.
    /// `None` outside the grid or without lanes.
    pub fn nearest_lane(&self, p: DVec2) -> Option<LanePoint> {
        let cell = self.nearest.as_ref()?[self.column(p)?];
        let (lane, point) = self.sample_of[cell as usize];
        let points = &self.lanes[lane as usize].points_m;
        let (from, to) = (
            (point as usize).saturating_sub(2),
            (point as usize + 3).min(points.len()),
        );
        project(&points[from..to], p).map(|hit| LanePoint {
            lane: lane as usize,
            along_m: hit.along_m + from as f64 * STEP_M,
            ..hit
        })
    }

    /// The nearest place on one lane; `None` if there is no such lane or the point is not finite.
    pub fn on_lane(&self, lane: usize, p: DVec2) -> Option<LanePoint> {
        let hit = project(&self.lanes.get(lane)?.points_m, p)?;
        Some(LanePoint { lane, ..hit })
    }

    /// Coordinates beside the ego lane: distance along it (m, 0 at the ego vehicle's nearest place) and offset (left is
    /// positive). Without an ego lane, the ego frame's own x and y.
    pub fn along_ego_lane(&self, p: DVec2) -> DVec2 {
        let here = |lane| Some((self.on_lane(lane, DVec2::ZERO)?, self.on_lane(lane, p)?));
        match self.ego_lane.and_then(here) {
            Some((origin, hit)) => DVec2::new(hit.along_m - origin.along_m, hit.offset_m),
            None => p,
        }
    }

    /// Direction of the ego lane beside a point.
    pub fn ego_direction(&self, p: DVec2) -> DVec2 {
        let hit = self.ego_lane.and_then(|lane| self.on_lane(lane, p));
        hit.map_or(DVec2::X, |hit| hit.direction)
    }

    /// Lanes of a role.
    pub fn lanes_of(&self, role: LaneRole) -> impl Iterator<Item = usize> {
        let fits = move |found: LaneRole| found == role || role == LaneRole::Road;
        (0..self.lanes.len()).filter(move |i| fits(self.lanes[*i].role))
    }

    /// True if the point is in a lane or strip of that role.
    pub fn in_role(&self, role: LaneRole, p: DVec2) -> bool {
        let left = || self.along_ego_lane(p).y > 0.0;
        let roadside = || {
            (-ROADSIDE_M..=ROADSIDE_M).contains(&self.from_road_m(p))
                && self.nearest_lane(p).is_none_or(|l| l.distance_m > 0.8)
        };
        let walkway = || self.has(BevLayer::Walkway, p);
        match role {
            LaneRole::Road => self.has(BevLayer::DrivableArea, p),
            LaneRole::Carpark => self.has(BevLayer::CarparkArea, p),
            LaneRole::Sidewalk => walkway(),
            LaneRole::LeftSidewalk => walkway() && left(),
            LaneRole::RightSidewalk => walkway() && !left(),
            LaneRole::Roadside => roadside(),
            LaneRole::LeftRoadside => roadside() && left(),
            LaneRole::RightRoadside => roadside() && !left(),
            lane => self.lanes_of(lane).any(|i| {
                self.on_lane(i, p)
                    .is_some_and(|hit| hit.distance_m <= HALF_LANE_M)
            }),
        }
    }
}

/// True if the point lies in a closed outline (even-odd rule).
pub fn inside(outline_m: &[DVec2], p: DVec2) -> bool {
    let mut odd = false;
    for (i, a) in outline_m.iter().enumerate() {
        let b = outline_m[(i + 1) % outline_m.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            odd = !odd;
        }
    }
    odd
}

/// Distance from a point to an outline's area, m: 0 inside.
pub fn outline_distance_m(outline_m: &[DVec2], p: DVec2) -> f64 {
    if inside(outline_m, p) {
        return 0.0;
    }
    let n = outline_m.len();
    (0..n)
        .filter_map(|i| project(&[outline_m[i], outline_m[(i + 1) % n]], p))
        .map(|hit| hit.distance_m)
        .fold(f64::INFINITY, f64::min)
}

/// The nearest place on a line; `None` without a segment or for NaN.
pub fn project(points_m: &[DVec2], p: DVec2) -> Option<LanePoint> {
    let mut best: Option<LanePoint> = None;
    let mut along = 0.0;
    for pair in points_m.windows(2) {
        let d = pair[1] - pair[0];
        let length = d.length();
        if length > 1e-9 && length.is_finite() {
            let direction = d / length;
            let t = (p - pair[0]).dot(direction).clamp(0.0, length);
            let position_m = pair[0] + direction * t;
            let distance_m = p.distance(position_m);
            // Written so that NaN is never taken.
            if distance_m < best.map_or(f64::INFINITY, |b| b.distance_m) {
                let side = direction.perp_dot(p - position_m);
                best = Some(LanePoint {
                    lane: 0,
                    position_m,
                    direction,
                    distance_m,
                    offset_m: distance_m.copysign(side),
                    along_m: along + t,
                });
            }
            along += length;
        }
    }
    best
}

/// The line with a point at every step, from its start to its end.
pub fn resampled(points_m: &[DVec2], count: usize) -> Vec<DVec2> {
    let total: f64 = points_m.windows(2).map(|w| w[0].distance(w[1])).sum();
    (0..count)
        .map(|i| at_along(points_m, total * i as f64 / (count.max(2) - 1) as f64))
        .collect()
}

/// The point at a distance along a line, m, clamped to its ends; NaN for an empty line.
pub fn at_along(points_m: &[DVec2], along_m: f64) -> DVec2 {
    let mut left = along_m;
    for pair in points_m.windows(2) {
        let length = pair[0].distance(pair[1]);
        if left <= length && length > 0.0 {
            return pair[0].lerp(pair[1], (left / length).max(0.0));
        }
        left -= length;
    }
    points_m.last().copied().unwrap_or(DVec2::NAN)
}

/// Lanes made of pieces: pieces are joined where one ends and another continues in its direction.
fn joined(layout: &BevLayout) -> Vec<Lane> {
    const GAP_M: f64 = 1.2;
    const LEAST_COSINE: f64 = 0.9;
    let mut pieces: Vec<(u32, Vec<DVec2>)> = Vec::new();
    for (i, line) in layout.polylines.iter().enumerate() {
        let sound = line.points_m.iter().all(|p| p.is_finite()) && line.points_m.len() >= 2;
        if line.kind == PolylineKind::LaneCenter && sound {
            for run in line.points_m.split(|p| p.abs().max_element() > 46.0) {
                if run.len() >= 2 {
                    pieces.push((i as u32, run.to_vec()));
                }
            }
        }
    }
    let start = |p: &[DVec2]| (p[0], (p[1] - p[0]).normalize_or_zero());
    let end = |p: &[DVec2]| {
        let n = p.len();
        (p[n - 1], (p[n - 1] - p[n - 2]).normalize_or_zero())
    };
    // The best successor of each piece; each piece succeeds only one.
    let mut links: Vec<(f64, usize, usize)> = Vec::new();
    for (a, (_, pa)) in pieces.iter().enumerate() {
        for (b, (_, pb)) in pieces.iter().enumerate() {
            let ((p, d), (q, e)) = (end(pa), start(pb));
            if a != b && p.distance(q) < GAP_M && d.dot(e) > LEAST_COSINE {
                links.push((p.distance(q) + 4.0 * (1.0 - d.dot(e)), a, b));
            }
        }
    }
    links.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut next, mut previous) = (vec![None; pieces.len()], vec![None; pieces.len()]);
    for (_, a, b) in links {
        if next[a].is_none() && previous[b].is_none() {
            (next[a], previous[b]) = (Some(b), Some(a));
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut lanes = Vec::new();
    // Chains from their first piece; the remaining pieces form rings.
    let firsts = (0..pieces.len()).filter(|i| previous[*i].is_none());
    for first in firsts.chain(0..pieces.len()).collect::<Vec<_>>() {
        let (mut points, mut at) = (Vec::new(), Some(first));
        while let Some(i) = at.filter(|i| !used[*i]) {
            used[i] = true;
            points.extend_from_slice(&pieces[i].1);
            at = next[i];
        }
        let total: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        if total > 2.0 {
            lanes.push(Lane {
                role: LaneRole::Road,
                polyline: pieces[first].0,
                points_m: resampled(&points, (total / STEP_M).ceil() as usize + 1),
            });
        }
    }
    lanes.sort_by_key(|l| l.polyline);
    lanes
}

fn ego_lane(lanes: &[Lane]) -> Option<usize> {
    const NEAR_M: f64 = 2.5;
    let fits = |(i, lane): (usize, &Lane)| {
        let hit = project(&lane.points_m, DVec2::ZERO)?;
        let length = lane.points_m.len() as f64;
        let turned = hit.direction.x.clamp(-1.0, 1.0).acos();
        // Prefers a lane that continues ahead to one that turns off.
        (hit.distance_m < NEAR_M && hit.direction.x > 0.7)
            .then_some((hit.distance_m + turned - 0.01 * length.min(80.0), i))
    };
    let found = lanes.iter().enumerate().filter_map(fits);
    found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, i)| i)
}

/// Sets the roles and returns the border between the two sides of the road.
fn assign_roles(lanes: &mut [Lane], ego: Option<usize>, axis: &[DVec2]) -> f64 {
    const BESIDE_M: f64 = 25.0;
    let (mut left, mut right) = (Vec::new(), Vec::new()); // of the same direction: offset and index
    let mut oncoming: Vec<f64> = Vec::new();
    for (i, lane) in lanes.iter_mut().enumerate() {
        let (mut along, mut against, mut across, mut offsets) = (0, 0, 0, Vec::new());
        for pair in lane.points_m.windows(2) {
            if let Some(hit) = project(axis, pair[0])
                && hit.distance_m < BESIDE_M
            {
                let cosine = (pair[1] - pair[0]).normalize_or_zero().dot(hit.direction);
                match cosine {
                    c if c > 0.7 => along += 1,
                    c if c < -0.7 => against += 1,
                    _ => across += 1,
                }
                offsets.push((hit.distance_m.min(pair[0].length()), hit.offset_m));
            }
        }
        offsets.sort_by(|a, b| a.1.total_cmp(&b.1));
        let offset = offsets.get(offsets.len() / 2).map_or(f64::NAN, |o| o.1);
        lane.role = if Some(i) == ego {
            LaneRole::Ego
        } else if along > against && along > across {
            let list = if offset > 0.0 { &mut left } else { &mut right };
            list.push((offset.abs(), i));
            LaneRole::Road
        } else if against > along && against > across {
            oncoming.push(offset);
            LaneRole::Oncoming
        } else if across > 0 {
            LaneRole::Cross
        } else {
            LaneRole::Road
        };
    }
    // The next lane beside the ego's: the one between 2 and 5.5 m away.
    for (list, role) in [(&left, LaneRole::Left), (&right, LaneRole::Right)] {
        for (offset, i) in list {
            if (1.8..5.6).contains(offset) {
                lanes[*i].role = role;
            }
        }
    }
    let last_left = left
        .iter()
        .map(|l| l.0)
        .filter(|o| *o < BESIDE_M)
        .fold(0.0, f64::max);
    let nearest_oncoming = oncoming.iter().copied().filter(|o| *o > last_left);
    match nearest_oncoming.fold(f64::INFINITY, f64::min) {
        first if first.is_finite() => (last_left + first) / 2.0,
        _ => last_left + HALF_LANE_M,
    }
}

/// True if the point is inside a map and at least that far from its sides.
fn is_within(extent: Extent, p: DVec2, margin_m: f64) -> bool {
    let (min, max) = (extent.min_m().truncate(), extent.max_m().truncate());
    p.cmpgt(min + margin_m).all() && p.cmplt(max - margin_m).all()
}

/// Places where lanes of different directions cross, at most one within 15 m, the nearest first.
fn junctions(extent: Extent, lanes: &[Lane]) -> Vec<DVec2> {
    const STRIDE: usize = 3;
    const APART_M: f64 = 15.0;
    let segments: Vec<(usize, DVec2, DVec2)> = lanes
        .iter()
        .enumerate()
        .flat_map(|(i, lane)| {
            let thin: Vec<DVec2> = lane.points_m.iter().copied().step_by(STRIDE).collect();
            thin.windows(2).map(|w| (i, w[0], w[1])).collect::<Vec<_>>()
        })
        .filter(|(_, a, _)| is_within(extent, *a, 2.0))
        .collect();
    let mut places: Vec<(DVec2, f64)> = Vec::new(); // sum and count
    for (k, (i, a, b)) in segments.iter().enumerate() {
        for (j, c, d) in &segments[k + 1..] {
            if i == j || a.distance_squared(*c) > 64.0 {
                continue;
            }
            let (u, v) = (*b - *a, *d - *c);
            let det = u.perp_dot(v);
            if det.abs() < 0.5 * u.length() * v.length() {
                continue; // less than 30 degrees apart
            }
            let (s, t) = ((*c - *a).perp_dot(v) / det, (*c - *a).perp_dot(u) / det);
            if (0.0..1.0).contains(&s) && (0.0..1.0).contains(&t) {
                let p = *a + u * s;
                match places
                    .iter_mut()
                    .find(|(sum, n)| (*sum / *n).distance(p) < APART_M)
                {
                    Some((sum, n)) => (*sum, *n) = (*sum + p, *n + 1.0),
                    None => places.push((p, 1.0)),
                }
            }
        }
    }
    let mut found: Vec<DVec2> = places.into_iter().map(|(sum, n)| sum / n).collect();
    found.sort_by(|a, b| a.length().total_cmp(&b.length()));
    found
}
