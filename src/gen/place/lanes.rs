//! The lanes, strips and areas of a layout, by their roles for the ego vehicle.

use glam::DVec2;

use scene::graph::LaneRole;
use scene::{BevLayer, BevLayout, PolylineKind};

/// A point in the middle of a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneSample {
    /// Place in the ego frame, m.
    pub p: DVec2,
    /// Unit vector in driving direction.
    pub dir: DVec2,
    /// Role of the lane at this point.
    pub role: LaneRole,
}

/// A layout with the roles of its lanes.
pub struct LaneMap<'a> {
    /// The layout.
    pub layout: &'a BevLayout,
    /// Points at every metre of every lane inside the grid.
    pub points: Vec<LaneSample>,
    /// The course of the ego vehicle, every metre, from behind to ahead.
    pub ego_path: Vec<(DVec2, DVec2)>,
    /// Index of its point that is nearest to the ego vehicle.
    ego_at: usize,
    /// Outlines of crossings.
    pub crossings: Vec<Vec<DVec2>>,
    /// Middle of the nearest junction.
    pub junction: Option<DVec2>,
    /// Indices of the points by squares of the plane, because the nearest one is looked up thousands of times.
    squares: Vec<Vec<u32>>,
}

/// Side of a square, m, and number of squares along one axis.
const SQUARE_M: f64 = 5.0;
const SQUARES: i64 = 18;

fn square(v: f64) -> i64 {
    ((v / SQUARE_M).floor() as i64 + SQUARES / 2).clamp(0, SQUARES - 1)
}

/// Farthest distance of boxes from the middle, m.
pub const REACH_M: f64 = 39.0;

fn resample(points: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let mut out = Vec::new();
    let mut left = 0.0;
    for pair in points.windows(2) {
        let d = pair[1] - pair[0];
        let length = d.length();
        if !(length.is_finite() && length > 1e-6) || length > 1e4 {
            continue;
        }
        let dir = d / length;
        while left < length {
            out.push((pair[0] + dir * left, dir));
            left += 1.0;
        }
        left -= length;
    }
    out.retain(|(p, _)| p.abs().max_element() <= 45.0);
    out
}

impl<'a> LaneMap<'a> {
    /// Reads a layout. Without lane lines the ego vehicle's course is taken as straight.
    pub fn new(layout: &'a BevLayout) -> Self {
        let lanes: Vec<Vec<(DVec2, DVec2)>> = layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter)
            .map(|l| resample(&l.points_m))
            .filter(|l| l.len() > 1)
            .collect();
        let ego_path = ego_path(&lanes);
        let mut map = Self {
            layout,
            points: Vec::new(),
            ego_at: nearest_of(&ego_path, DVec2::ZERO),
            ego_path,
            crossings: layout
                .polylines
                .iter()
                .filter(|l| l.kind == PolylineKind::PedCrossing && l.points_m.len() > 2)
                .map(|l| l.points_m.clone())
                .filter(|l| l.iter().any(|p| p.abs().max_element() < REACH_M))
                .collect(),
            junction: None,
            squares: vec![Vec::new(); (SQUARES * SQUARES) as usize],
        };
        map.points = lanes
            .iter()
            .flatten()
            .filter(|(p, _)| p.abs().max_element() <= REACH_M)
            .map(|&(p, dir)| LaneSample {
                p,
                dir,
                role: map.role_at(p, dir),
            })
            .collect();
        if lanes.is_empty() {
            let on = |p: &DVec2| map.has(BevLayer::DrivableArea.bit(), *p);
            map.points = map
                .ego_path
                .iter()
                .filter(|(p, _)| on(p))
                .map(|&(p, dir)| LaneSample {
                    p,
                    dir,
                    role: LaneRole::Ego,
                })
                .collect();
        }
        for (i, l) in map.points.iter().enumerate() {
            map.squares[(square(l.p.x) * SQUARES + square(l.p.y)) as usize].push(i as u32);
        }
        map.junction = map.find_junction();
        map
    }

    fn role_at(&self, p: DVec2, dir: DVec2) -> LaneRole {
        let Some((along, across, axis)) = self.course(p) else {
            return LaneRole::Road;
        };
        let _ = along;
        let cosine = axis.dot(dir);
        if cosine > 0.82 {
            match across {
                d if d.abs() < 1.3 => LaneRole::Ego,
                d if (0.0..5.6).contains(&d) => LaneRole::Left,
                d if (-5.6..0.0).contains(&d) => LaneRole::Right,
                _ => LaneRole::Road,
            }
        } else if cosine < -0.82 {
            if across.abs() < 22.0 {
                LaneRole::Oncoming
            } else {
                LaneRole::Road
            }
        } else {
            LaneRole::Cross
        }
    }

    /// Coordinates of a point along the ego vehicle's course: metres ahead along it, metres left of it, its direction
    /// there.
    pub fn course(&self, p: DVec2) -> Option<(f64, f64, DVec2)> {
        let at = nearest_of(&self.ego_path, p);
        let (q, dir) = *self.ego_path.get(at)?;
        Some((at as f64 - self.ego_at as f64, dir.perp_dot(p - q), dir))
    }

    /// True if any of the layers is set at the point.
    pub fn has(&self, bits: u32, p: DVec2) -> bool {
        self.layout
            .extent()
            .column_at(p.x, p.y)
            .is_some_and(|[x, y]| self.layout.cell(x, y) & bits != 0)
    }

    /// The nearest lane point.
    pub fn nearest(&self, p: DVec2) -> Option<&LaneSample> {
        let (x, y) = (square(p.x), square(p.y));
        let mut best: Option<(f64, u32)> = None;
        for ring in 0..SQUARES {
            // points farther out than this ring are at least this far away
            let beyond = (ring - 1).max(0) as f64 * SQUARE_M;
            if best.is_some_and(|b| b.0.sqrt() < beyond) {
                break;
            }
            for a in (x - ring).max(0)..=(x + ring).min(SQUARES - 1) {
                for b in (y - ring).max(0)..=(y + ring).min(SQUARES - 1) {
                    if (a - x).abs().max((b - y).abs()) != ring {
                        continue;
                    }
                    for &i in &self.squares[(a * SQUARES + b) as usize] {
                        let found = (self.points[i as usize].p.distance_squared(p), i);
                        let nearer = best.is_none_or(|b| {
                            found.0.total_cmp(&b.0).then(found.1.cmp(&b.1)) == std::cmp::Ordering::Less
                        });
                        if nearer {
                            best = Some(found);
                        }
                    }
                }
            }
        }
        best.map(|b| &self.points[b.1 as usize])
    }

    fn find_junction(&self) -> Option<DVec2> {
        let path: Vec<DVec2> = self.ego_path.iter().map(|p| p.0).collect();
        let met: Vec<DVec2> = self
            .points
            .iter()
            .filter(|c| c.role == LaneRole::Cross && c.p.x > -10.0)
            .filter(|c| path.iter().any(|p| p.distance(c.p) < 4.0))
            .map(|c| c.p)
            .collect();
        let first = met
            .iter()
            .copied()
            .min_by(|a, b| a.length().total_cmp(&b.length()))?;
        let near: Vec<DVec2> = met.into_iter().filter(|p| p.distance(first) < 14.0).collect();
        Some(near.iter().sum::<DVec2>() / near.len() as f64)
    }

    /// The crossing that is meant if none is named: the nearest ahead, else the nearest.
    pub fn crossing(&self) -> Option<&Vec<DVec2>> {
        let mid = |c: &Vec<DVec2>| c.iter().sum::<DVec2>() / c.len() as f64;
        let cost = |c: &Vec<DVec2>| {
            let m = mid(c);
            m.length() + if m.x > 0.0 { 0.0 } else { 200.0 }
        };
        self.crossings.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))
    }
}

/// Index of the point of a path that is nearest to `p`, the first of several; an edit asks for thousands of places.
fn nearest_of(path: &[(DVec2, DVec2)], p: DVec2) -> usize {
    let (mut at, mut least) = (0, f64::INFINITY);
    for (i, (q, _)) in path.iter().enumerate() {
        let d = q.distance_squared(p);
        if d < least {
            (at, least) = (i, d);
        }
    }
    at
}

/// Chains the lanes that the ego vehicle's lane belongs to.
fn ego_path(lanes: &[Vec<(DVec2, DVec2)>]) -> Vec<(DVec2, DVec2)> {
    let straight = || {
        (-40..=40)
            .map(|x| (DVec2::new(f64::from(x), 0.0), DVec2::X))
            .collect()
    };
    let cost = |lane: &Vec<(DVec2, DVec2)>| {
        lane.iter()
            .map(|(p, d)| p.length() + if d.x > 0.7 { 0.0 } else { 50.0 })
            .fold(f64::INFINITY, f64::min)
    };
    let Some(own) = lanes
        .iter()
        .min_by(|a, b| cost(a).total_cmp(&cost(b)))
        .filter(|l| cost(l) < 4.0)
    else {
        return straight();
    };
    let mut path = own.clone();
    for _ in 0..6 {
        let (end, dir) = path[path.len() - 1];
        let next = lanes
            .iter()
            .filter(|l| l[0].0.distance(end) < 2.5 && l[0].1.dot(dir) > 0.85)
            .max_by(|a, b| a[0].1.dot(dir).total_cmp(&b[0].1.dot(dir)));
        let (start, dir) = path[0];
        let back = lanes
            .iter()
            .filter(|l| l[l.len() - 1].0.distance(start) < 2.5 && l[l.len() - 1].1.dot(dir) > 0.85)
            .max_by(|a, b| a[a.len() - 1].1.dot(dir).total_cmp(&b[b.len() - 1].1.dot(dir)));
        if next.is_none() && back.is_none() {
            break;
        }
        if let Some(next) = next {
            path.extend(next);
        }
        if let Some(back) = back {
            path.splice(0..0, back.iter().copied());
        }
        if path.len() > 400 {
            break;
        }
    }
    // Straight on to the border, so that "ahead" always exists.
    let (end, dir) = path[path.len() - 1];
    path.extend(
        (1..=80)
            .map(|i| (end + dir * f64::from(i), dir))
            .take_while(|(p, _)| p.abs().max_element() < 41.0),
    );
    path
}
