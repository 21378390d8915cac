//! Walks a road in steps fine enough to draw, and only where it comes near the place of interest.

use glam::DVec2;

use super::XodrRoad;
use super::geometry::CurvePoint;
use super::lanes::{LaneSection, Travel};

/// Longest step along the outermost lane edge, m.
const STEP_M: f64 = 0.5;
/// Shortest step along the reference line, m: where a curve is so tight that this is too long, it is not a road.
const SHORTEST_M: f64 = 0.01;

/// Work that one call may do: cross-sections times lanes, grid cells, corners. It is thirty times the work for the
/// densest window of a large town map; only a file made to be slow ever reaches it.
pub(super) const BUDGET: usize = 1_000_000;

/// The edges of all lanes at one place of a road.
#[derive(Clone, Debug)]
pub(super) struct LaneEdges {
    pub s_m: f64,
    pub base: CurvePoint,
    /// Lateral positions in the plan, from the leftmost edge to the rightmost.
    pub t_m: Vec<f64>,
}

impl LaneEdges {
    /// At `s_m`, by the records that hold there.
    pub fn at(road: &XodrRoad, section: &LaneSection, s_m: f64) -> Self {
        Self::held(road, section, s_m, s_m)
    }

    /// At `s_m`, by the records that hold at `held_m`: at the end of a step that is the step's middle, as
    /// offsets and widths may jump where the next record begins.
    fn held(road: &XodrRoad, section: &LaneSection, s_m: f64, held_m: f64) -> Self {
        let mut t_m = Vec::with_capacity(section.lane_count() + 1);
        section.borders_m(lane_offset(road, s_m, held_m), s_m, held_m, &mut t_m);
        let record = road.reference.record_at(held_m);
        if !road.surface.superelevation.0.is_empty() {
            // Lane widths are measured on the tilted surface, rows in the plan.
            let in_plan = road.surface.tilt_rad(s_m, held_m).cos();
            t_m.iter_mut().for_each(|t| *t *= in_plan);
        }
        Self {
            s_m,
            base: record.at(s_m - record.s_m),
            t_m,
        }
    }

    /// A point between two lane edges, m.
    pub fn between(&self, edge: usize, other: usize) -> DVec2 {
        self.base.offset(0.5 * (self.t_m[edge] + self.t_m[other]))
    }

    /// Width of lane number `lane` from the left, m.
    pub fn width(&self, lane: usize) -> f64 {
        self.t_m[lane] - self.t_m[lane + 1]
    }

    /// Heading of traffic, rad; with the reference line for [`Travel::Both`].
    pub fn heading_rad(&self, travel: Travel) -> f64 {
        match travel {
            Travel::Backward => self.base.heading_rad + std::f64::consts::PI,
            Travel::Forward | Travel::Both => self.base.heading_rad,
        }
    }
}

/// The shift of the lanes at `s_m`, kept finite.
fn lane_offset(road: &XodrRoad, s_m: f64, held_m: f64) -> f64 {
    let offset = road.lane_offset.at(s_m, held_m);
    if offset.is_finite() {
        offset.clamp(-1e4, 1e4)
    } else {
        0.0
    }
}

/// How far the lanes of a section may lie from the reference line, m.
fn reach_m(road: &XodrRoad, section: &LaneSection) -> f64 {
    let (from, to) = (section.start_s_m, section.end_s_m);
    let starts = inside(&road.lane_offset.0, section, |p| p.s_m)
        .iter()
        .map(|p| p.s_m);
    let most = (0..=8)
        .map(|i| from + (to - from) * f64::from(i) / 8.0)
        .chain(starts)
        .map(|s| lane_offset(road, s, s).abs())
        .fold(0.0, f64::max);
    // The widest places are found by sampling, with a margin for places between the samples.
    1.1 * (most + section.reach_m()) + 1.0
}

/// The entries of a sorted list that begin inside a section.
fn inside<'a, T>(list: &'a [T], section: &LaneSection, s_m: impl Fn(&T) -> f64) -> &'a [T] {
    let from = list.partition_point(|x| s_m(x) <= section.start_s_m);
    let to = list.partition_point(|x| s_m(x) < section.end_s_m);
    &list[from..to.max(from)]
}

/// Visits consecutive steps `(from, to)` of one section, skipping steps that cannot come within `radius_m` of
/// `center_m`. A visit that returns a radius sets it anew, so that a search may shrink it. Stops at a budget of 0.
pub(super) fn walk(
    road: &XodrRoad,
    section: &LaneSection,
    center_m: DVec2,
    mut radius_m: f64,
    budget: &mut usize,
    mut visit: impl FnMut(&LaneEdges, &LaneEdges, &mut usize) -> Option<f64>,
) {
    let reach = reach_m(road, section);
    let mut breaks = section.breaks_m();
    breaks.extend(
        inside(road.reference.records(), section, |g| g.s_m)
            .iter()
            .map(|g| g.s_m),
    );
    breaks.extend(
        inside(&road.lane_offset.0, section, |p| p.s_m)
            .iter()
            .map(|p| p.s_m),
    );
    breaks.sort_by(f64::total_cmp);
    let mut stack: Vec<(f64, f64)> = Vec::new();
    for ends in breaks.windows(2).filter(|ends| ends[1] - ends[0] > 1e-9) {
        stack.push((ends[0], ends[1]));
        let mut before: Option<LaneEdges> = None; // not over to the next record
        while let Some((from, to)) = stack.pop() {
            *budget = budget.saturating_sub(1);
            if *budget == 0 {
                return;
            }
            let middle = 0.5 * (from + to);
            let record = road.reference.record_at(middle);
            let here = record.at(middle - record.s_m);
            let run = (to - from) * record.stretch();
            if here.position_m.distance(center_m) - 0.5 * run > radius_m + reach {
                continue;
            }
            if run * (1.0 + here.curvature_per_m.abs() * reach) > STEP_M && to - from > SHORTEST_M {
                stack.push((middle, to));
                stack.push((from, middle));
                continue;
            }
            *budget = budget.saturating_sub(section.lane_count() + 1);
            let start = before
                .take()
                .filter(|row| row.s_m == from)
                .unwrap_or_else(|| LaneEdges::held(road, section, from, middle));
            let end = LaneEdges::held(road, section, to, middle);
            if let Some(closer) = visit(&start, &end, budget) {
                radius_m = closer;
            }
            before = Some(end);
        }
    }
}
