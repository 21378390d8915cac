//! Tells which roads lie on the ground, and how high it is under them. Where two roads cross at different heights one
//! of them is the ground: the ego vehicle's own road if it is one of them, else the lower one.

use std::collections::HashMap;

use glam::DVec2;

use super::elevation::edge_heights_m;
use super::lanes::{LaneGround, LaneSection};
use super::layout::MapCut;
use super::sampling::{BUDGET, LaneEdges, walk};
use super::{RoadEnd, RoadNetwork, XodrRoad};
use scene::Window;
use scene::raster::polygon_cells;

/// Two surfaces farther apart than this are a bridge and the road below it, m.
const CLEARANCE_M: f64 = 3.0;
/// A bridge reaches this far beyond the road that it crosses, m.
const ABUTMENT_M: f64 = 3.0;
/// Two bridges of one road that are closer together are one, m.
const JOIN_M: f64 = 15.0;
/// Roads on the ground that differ by more than this do not say how high it is, m.
const AGREE_M: f64 = 0.1;
/// Two visits of one road to a cell are one if they differ by less than this, m.
const SAME_M: f64 = 2.0;

/// Roads above one another in one column, at most: only a file made to be slow has more.
const MOST_LAYERS: usize = 64;

/// How a stretch of road that is not on the ground lies to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Off {
    /// Above it: a bridge.
    Carried,
    /// Below it: left out.
    Hidden,
}

/// A stretch of road that is not on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub road: usize,
    pub off: Off,
    pub from_s_m: f64,
    pub to_s_m: f64,
}

/// The roads in a window by height.
pub(super) struct RoadLevels {
    /// By road, then along it.
    pub stretches: Vec<Stretch>,
    /// Height of the road surface per column of the grid in the file's frame, m; `None` beside roads.
    pub known_m: Vec<Option<f64>>,
}

/// One road in one column.
struct Cover {
    road: usize,
    from_s_m: f64,
    to_s_m: f64,
    sum_m: f64,
    count: f64,
}

impl Cover {
    fn height_m(&self) -> f64 {
        self.sum_m / self.count
    }
}

impl RoadLevels {
    /// Levels of the roads around the ego vehicle; `None` if every road of the file is flat.
    pub fn survey(network: &RoadNetwork, window: &MapCut) -> Option<Self> {
        if network.roads.iter().all(is_flat) {
            return None;
        }
        let covers = covers(network, window);
        let mut stretches = stretches(network, window, &covers);
        merge(&mut stretches);
        let mut out = Self {
            stretches,
            known_m: Vec::new(),
        };
        out.known_m = covers.iter().map(|column| out.agreed_m(column)).collect();
        Some(out)
    }

    /// How a place of a road lies to the ground, if it is not on it.
    pub fn off(&self, road: usize, s_m: f64) -> Option<Off> {
        let from = self.stretches.partition_point(|s| s.road < road);
        let of_road = self.stretches[from..].iter().take_while(|s| s.road == road);
        let mut at = of_road.filter(|s| s.from_s_m <= s_m && s_m <= s.to_s_m);
        at.next().map(|s| s.off)
    }

    /// The height that the roads on the ground agree on.
    fn agreed_m(&self, column: &[Cover]) -> Option<f64> {
        let on_ground = |c: &&Cover| self.off(c.road, 0.5 * (c.from_s_m + c.to_s_m)).is_none();
        let heights: Vec<f64> = column.iter().filter(on_ground).map(Cover::height_m).collect();
        if heights.is_empty() {
            return None;
        }
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (high - low <= AGREE_M).then(|| heights.iter().sum::<f64>() / heights.len() as f64)
    }
}

fn is_flat(road: &XodrRoad) -> bool {
    let lanes = || road.sections.iter().flat_map(LaneSection::lanes_left_to_right);
    road.surface.is_flat() && !lanes().any(|lane| lane.leaves_surface())
}

/// Edges of the ground that a road brings with it: from its leftmost to its rightmost lane that is paved or walked on.
pub(super) fn body_edges(grounds: &[LaneGround]) -> Option<[usize; 2]> {
    let made = |g: &LaneGround| *g != LaneGround::Other;
    Some([
        grounds.iter().position(made)?,
        grounds.iter().rposition(made)? + 1,
    ])
}

/// The roads in every column.
fn covers(network: &RoadNetwork, window: &MapCut) -> Vec<Vec<Cover>> {
    let mut covers: Vec<Vec<Cover>> = (0..window.extent.columns()).map(|_| Vec::new()).collect();
    let extent = window.extent;
    let mut budget = BUDGET * extent.columns().div_ceil(Window::COLUMNS);
    for (index, road) in network.roads.iter().enumerate() {
        for section in &road.sections {
            let mut body = None;
            let (at_m, radius_m) = (window.at_m, window.radius_m());
            walk(road, section, at_m, radius_m, &mut budget, |from, to, budget| {
                let [first, last] = (*body.get_or_insert_with(|| body_edges(&section.grounds())))?;
                let held_m = 0.5 * (from.s_m + to.s_m);
                let [near, far] = [from, to].map(|row| edge_heights_m(&road.surface, section, row, held_m));
                let lanes = near.iter().zip(&far).enumerate();
                for (lane, (near, far)) in lanes.take(last).skip(first) {
                    let patch = Patch::new(window, [from, to], lane, [*near, *far]);
                    polygon_cells(extent, &patch.corners_m(), |x, y| {
                        *budget = budget.saturating_sub(1);
                        let height_m = patch.height_m(extent.center(x, y, 0).truncate());
                        add(
                            &mut covers[extent.index(x, y)],
                            index,
                            [from.s_m, to.s_m],
                            height_m,
                        );
                    });
                }
                None
            });
        }
    }
    covers
}

fn add(column: &mut Vec<Cover>, road: usize, [from_s_m, to_s_m]: [f64; 2], height_m: f64) {
    let same = |c: &&mut Cover| {
        let apart_m = (from_s_m - c.to_s_m).max(c.from_s_m - to_s_m);
        c.road == road && apart_m < SAME_M && (c.height_m() - height_m).abs() < SAME_M
    };
    let layers = column.len();
    match column.iter_mut().find(same) {
        Some(cover) => {
            cover.from_s_m = cover.from_s_m.min(from_s_m);
            cover.to_s_m = cover.to_s_m.max(to_s_m);
            cover.sum_m += height_m;
            cover.count += 1.0;
        }
        None if layers >= MOST_LAYERS => {}
        None => column.push(Cover {
            road,
            from_s_m,
            to_s_m,
            sum_m: height_m,
            count: 1.0,
        }),
    }
}

/// One step of one lane: its corners in the ego frame and the height at each.
struct Patch {
    near_m: [DVec2; 2], // left, right
    far_m: [DVec2; 2],
    near_heights_m: [f64; 2],
    far_heights_m: [f64; 2],
}

impl Patch {
    fn new(window: &MapCut, rows: [&LaneEdges; 2], lane: usize, heights_m: [[f64; 2]; 2]) -> Self {
        let ends = |row: &LaneEdges| [lane, lane + 1].map(|i| window.to_ego(row.between(i, i)));
        Self {
            near_m: ends(rows[0]),
            far_m: ends(rows[1]),
            near_heights_m: heights_m[0],
            far_heights_m: heights_m[1],
        }
    }

    fn corners_m(&self) -> [DVec2; 4] {
        [self.near_m[0], self.near_m[1], self.far_m[1], self.far_m[0]]
    }

    /// Blended between the corners.
    fn height_m(&self, p: DVec2) -> f64 {
        let share = |from: DVec2, to: DVec2| {
            let d = to - from;
            match d.length_squared() {
                l if l > 0.0 => ((p - from).dot(d) / l).clamp(0.0, 1.0),
                _ => 0.5,
            }
        };
        let middle = |m: &[DVec2; 2]| 0.5 * (m[0] + m[1]);
        let along = share(middle(&self.near_m), middle(&self.far_m));
        let edge = |i: usize| self.near_m[i].lerp(self.far_m[i], along);
        let across = share(edge(0), edge(1));
        let height = |i: usize| self.near_heights_m[i] * (1.0 - along) + self.far_heights_m[i] * along;
        height(0) * (1.0 - across) + height(1) * across
    }
}

/// Stretches of roads that are not on the ground, where roads cross at different heights.
fn stretches(network: &RoadNetwork, window: &MapCut, covers: &[Vec<Cover>]) -> Vec<Stretch> {
    let ego = EgoRoad::find(network, window, covers);
    let mut out = Vec::new();
    for column in covers.iter().filter(|c| c.len() > 1) {
        let lowest = column.iter().map(Cover::height_m).fold(f64::INFINITY, f64::min);
        let ground_m = ego.as_ref().and_then(|e| e.height_m(column)).unwrap_or(lowest);
        for cover in column {
            let above_m = cover.height_m() - ground_m;
            if above_m.abs() > CLEARANCE_M {
                out.push(Stretch {
                    road: cover.road,
                    off: if above_m > 0.0 { Off::Carried } else { Off::Hidden },
                    from_s_m: cover.from_s_m - ABUTMENT_M,
                    to_s_m: cover.to_s_m + ABUTMENT_M,
                });
            }
        }
    }
    out
}

/// Joins stretches that overlap or nearly do.
fn merge(stretches: &mut Vec<Stretch>) {
    stretches.sort_by(|a, b| {
        let kind = |s: &Stretch| (s.road, s.off == Off::Hidden);
        kind(a).cmp(&kind(b)).then(a.from_s_m.total_cmp(&b.from_s_m))
    });
    stretches.dedup_by(|next, before| {
        let joins =
            (next.road, next.off) == (before.road, before.off) && next.from_s_m - before.to_s_m < JOIN_M;
        if joins {
            before.to_s_m = before.to_s_m.max(next.to_s_m);
        }
        joins
    });
}

/// The road that the ego vehicle stands on, and the roads that continue it.
struct EgoRoad {
    height_m: f64,
    is_own: Vec<bool>,
}

impl EgoRoad {
    fn find(network: &RoadNetwork, window: &MapCut, covers: &[Vec<Cover>]) -> Option<Self> {
        let extent = window.extent;
        let [x, y] = extent.column_at(0.0, 0.0)?;
        // A joint may leave the very column empty.
        let near = |n: usize, most: usize| n.saturating_sub(1)..=(n + 1).min(most - 1);
        let around = near(x, extent.nx()).flat_map(|x| near(y, extent.ny()).map(move |y| extent.index(x, y)));
        let mut here: Vec<&Cover> = around.flat_map(|c| &covers[c]).collect();
        // The one that runs most as the ego looks; the lower one of two that run alike.
        let alike = |c: &Cover| {
            let s_m = 0.5 * (c.from_s_m + c.to_s_m);
            let heading_rad = network.roads[c.road].reference.at(s_m).heading_rad;
            let along = window
                .ego_from_file
                .rotate(DVec2::from_angle(heading_rad))
                .x
                .abs();
            (along * 4.0).round()
        };
        here.sort_by(|a, b| {
            let order = alike(b).total_cmp(&alike(a));
            order.then(a.height_m().total_cmp(&b.height_m()))
        });
        let cover = here.first()?;
        Some(Self {
            height_m: cover.height_m(),
            is_own: continued(network, cover.road),
        })
    }

    /// Height of the ego's road in a column that it covers.
    fn height_m(&self, column: &[Cover]) -> Option<f64> {
        let own = column.iter().filter(|c| self.is_own[c.road]);
        own.map(Cover::height_m)
            .min_by(|a, b| (a - self.height_m).abs().total_cmp(&(b - self.height_m).abs()))
    }
}

/// The roads that one continues into, without a junction between.
fn continued(network: &RoadNetwork, first: usize) -> Vec<bool> {
    let by_id: HashMap<&str, usize> = network
        .roads
        .iter()
        .enumerate()
        .map(|(i, r)| (r.id.as_str(), i))
        .collect();
    let mut is_own = vec![false; network.roads.len()];
    let mut open = vec![first];
    while let Some(i) = open.pop() {
        if std::mem::replace(&mut is_own[i], true) {
            continue;
        }
        let ends = [&network.roads[i].predecessor, &network.roads[i].successor];
        for end in ends.into_iter().flatten() {
            if let RoadEnd::Road(id) = end {
                open.extend(by_id.get(id.as_str()));
            }
        }
    }
    is_own
}
