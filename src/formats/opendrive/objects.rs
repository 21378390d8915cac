//! Objects on the road or beside it, and their outlines in the file's frame.

use glam::DVec2;

use super::geometry::ReferenceLine;
use super::lanes::LaneGround;
use super::standing::RoadsideObject;
use super::xml::{Skipped, count};

/// The kinds of object that a scene shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectKind {
    /// Pedestrian crossing.
    Crossing,
    /// Parking space.
    Parking,
    /// Where traffic halts.
    StopLine {
        /// Traffic it holds for: true against the reference line, false along it, `None` both.
        against_line: Option<bool>,
    },
    /// Ground of the kind of lane that its outline names.
    Area(LaneGround),
    /// An object that stands beside the road.
    Standing(RoadsideObject),
}

/// Corners of one outline.
#[derive(Clone, Debug, PartialEq)]
pub enum OutlineCorners {
    /// (u, v) in the object's own frame, m.
    Local(Vec<[f64; 2]>),
    /// (s, t) along the road, m.
    Road(Vec<[f64; 2]>),
}

/// A row of copies.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeat {
    /// Where the row begins, m.
    pub s_m: f64,
    /// Its length, m.
    pub run_m: f64,
    /// From one copy to the next, m; 0 for one object as long as the row.
    pub distance_m: f64,
    /// Lateral position at start and end; the object's own if absent.
    pub t_m: Option<[f64; 2]>,
    /// Length of the copies at start and end.
    pub length_m: Option<[f64; 2]>,
    /// Width of the copies at start and end.
    pub width_m: Option<[f64; 2]>,
    /// Height of the copies at start and end.
    pub height_m: Option<[f64; 2]>,
    /// Height of their feet above the road at start and end.
    pub lift_m: Option<[f64; 2]>,
}

/// A crossing, a parking space, a stop line, an area, or an object that stands beside the road.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadObject {
    /// Its kind.
    pub kind: ObjectKind,
    /// Position along the road, m.
    pub s_m: f64,
    /// Lateral position, left positive, m.
    pub t_m: f64,
    /// Turn against the road, rad.
    pub heading_rad: f64,
    /// Length (along u) and width (along v), m; 0 if not given.
    pub size_m: [f64; 2],
    /// Height, m; 0 if not given.
    pub height_m: f64,
    /// Radius, m; 0 if it is not round.
    pub radius_m: f64,
    /// Height of its foot above the road, m.
    pub lift_m: f64,
    /// Width of its last marking, m: an outline of two corners is a line of this width.
    pub line_width_m: Option<f64>,
    /// Outlines; empty if the object is its length by its width.
    pub outlines: Vec<OutlineCorners>,
    /// Rows of copies; empty for the object alone.
    pub repeats: Vec<Repeat>,
}

/// One copy: where it stands and how large it is.
pub(super) struct Copy {
    pub s_m: f64,
    pub t_m: f64,
    pub size_m: [f64; 2],
    pub height_m: f64,
    pub lift_m: f64,
}

/// Copies of one row that are drawn, at most.
const MOST_COPIES: usize = 10_000;

impl RoadObject {
    /// The object alone, its rows left aside.
    pub(super) fn alone(&self) -> Copy {
        Copy {
            s_m: self.s_m,
            t_m: self.t_m,
            size_m: self.size_m,
            height_m: self.height_m,
            lift_m: self.lift_m,
        }
    }

    /// Visits every copy. At a `budget` of 0 the rest of a row is left out and counted; visits take from it.
    pub(super) fn copies(
        &self,
        budget: &mut usize,
        skipped: &mut Skipped,
        mut visit: impl FnMut(&Copy, &mut usize, &mut Skipped),
    ) {
        if self.repeats.is_empty() {
            return visit(&self.alone(), budget, skipped);
        }
        for row in &self.repeats {
            let copies = row.copies();
            if copies > MOST_COPIES {
                count(skipped, "object repeated more than 10000 times");
            }
            for i in 0..copies.min(MOST_COPIES) {
                if *budget == 0 {
                    return count(skipped, "object beyond the drawing budget");
                }
                visit(&row.copy(self, i), budget, skipped);
            }
        }
    }

    /// The corners of a copy's outlines, m, in the file's frame; those of its length by its width without outlines.
    pub(super) fn areas_m(&self, reference: &ReferenceLine, copy: &Copy) -> Vec<Vec<DVec2>> {
        let base = reference.at(copy.s_m);
        let origin = base.offset(copy.t_m);
        let axis = DVec2::from_angle(base.heading_rad + self.heading_rad);
        let place = |[u, v]: [f64; 2]| origin + axis.rotate(DVec2::new(u, v));
        let road = |[s, t]: [f64; 2]| {
            reference
                .at(s + copy.s_m - self.s_m)
                .offset(t + copy.t_m - self.t_m)
        };
        let mut areas: Vec<Vec<DVec2>> = Vec::new();
        for corners in &self.outlines {
            areas.push(match corners {
                OutlineCorners::Local(list) => list.iter().copied().map(place).collect(),
                OutlineCorners::Road(list) => list.iter().copied().map(road).collect(),
            });
        }
        if areas.is_empty() {
            let [u, v] = copy.size_m.map(|size| size / 2.0);
            areas.push([[-u, -v], [u, -v], [u, v], [-u, v]].map(place).to_vec());
        }
        areas
    }

    /// Visits the outline of every copy, m, in the file's frame. `budget` goes down by one for each corner; at zero the
    /// rest of a row is left out. Left-out copies and outlines without an area are counted.
    pub(super) fn outlines_m(
        &self,
        reference: &ReferenceLine,
        budget: &mut usize,
        skipped: &mut Skipped,
        mut visit: impl FnMut(Vec<DVec2>),
    ) {
        self.copies(budget, skipped, |copy, budget, skipped| {
            for mut area in self.areas_m(reference, copy) {
                if let ([a, b], Some(width)) = (&area[..], self.line_width_m) {
                    // Two corners are a line; its marking says how wide the area around it is.
                    let side = (*b - *a).normalize_or_zero().perp() * (width / 2.0);
                    area = vec![*a - side, *b - side, *b + side, *a + side];
                }
                *budget = budget.saturating_sub(area.len());
                if area.len() >= 3 && area.iter().all(|p| p.is_finite()) && shoelace_m2(&area).abs() > 1e-3 {
                    visit(area);
                } else {
                    count(skipped, "object without an area");
                }
            }
        });
    }
}

impl Repeat {
    fn copies(&self) -> usize {
        if self.distance_m > 0.0 {
            ((self.run_m / self.distance_m + 1e-6).floor() + 1.0).min(1e9) as usize
        } else {
            1
        }
    }

    fn copy(&self, of: &RoadObject, i: usize) -> Copy {
        let ds = i as f64 * self.distance_m.max(0.0);
        let share = if self.run_m > 0.0 { ds / self.run_m } else { 0.0 };
        let mut copy = self.along(of, share);
        copy.s_m = self.s_m + ds;
        if self.distance_m <= 0.0 && of.outlines.is_empty() {
            // One object over the whole row: its length is the row's.
            copy.s_m += self.run_m / 2.0;
            copy.size_m[0] = self.run_m;
        }
        copy
    }

    /// A copy at a share of the row from its start.
    pub(super) fn along(&self, of: &RoadObject, share: f64) -> Copy {
        // Written so that NaN is the start.
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        let between = |ends: Option<[f64; 2]>, own: f64| ends.map_or(own, |[a, b]| a + (b - a) * share);
        Copy {
            s_m: self.s_m + share * self.run_m,
            t_m: between(self.t_m, of.t_m),
            size_m: [
                between(self.length_m, of.size_m[0]),
                between(self.width_m, of.size_m[1]),
            ],
            height_m: between(self.height_m, of.height_m),
            lift_m: between(self.lift_m, of.lift_m),
        }
    }
}

/// Area inside an outline, m2, negative if it runs clockwise.
pub(super) fn shoelace_m2(points: &[DVec2]) -> f64 {
    let origin = points[0];
    let twice: f64 = points
        .iter()
        .zip(points.iter().cycle().skip(1))
        .map(|(a, b)| (*a - origin).perp_dot(*b - origin))
        .sum();
    0.5 * twice
}
