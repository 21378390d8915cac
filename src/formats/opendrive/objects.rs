//! What lies on the road, and its outlines in the file's frame.

use glam::DVec2;

use super::geometry::ReferenceLine;
use super::xml::{Skipped, count};

/// The kinds of object that a layout shows.
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
}

/// Corners of one outline.
#[derive(Clone, Debug, PartialEq)]
pub enum Corners {
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
}

/// A crossing, a parking space or a stop line.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadObject {
    /// What it is.
    pub kind: ObjectKind,
    /// Position along the road, m.
    pub s_m: f64,
    /// Lateral position, left positive, m.
    pub t_m: f64,
    /// Turn against the road, rad.
    pub heading_rad: f64,
    /// Length (along u) and width (along v), m; 0 if not given.
    pub size_m: [f64; 2],
    /// Width of its last marking, m: what an outline of two corners means as an area.
    pub line_width_m: Option<f64>,
    /// Outlines; empty if the object is its length by its width.
    pub outlines: Vec<Corners>,
    /// Rows of copies; empty for the object alone.
    pub repeats: Vec<Repeat>,
}

/// One copy: where it stands and how large it is.
struct Copy {
    s_m: f64,
    t_m: f64,
    size_m: [f64; 2],
}

/// Copies of one row that are drawn, at most.
const MOST_COPIES: usize = 10_000;

impl RoadObject {
    /// Visits the outline of every copy, m, in the file's frame. `budget` goes down by one for each
    /// corner; at zero the rest of a row is left out and counted, as is what has no area.
    pub(super) fn outlines_m(
        &self,
        reference: &ReferenceLine,
        budget: &mut usize,
        skipped: &mut Skipped,
        mut visit: impl FnMut(Vec<DVec2>),
    ) {
        let mut one = |copy: &Copy, budget: &mut usize, skipped: &mut Skipped| {
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
                    Corners::Local(list) => list.iter().copied().map(place).collect(),
                    Corners::Road(list) => list.iter().copied().map(road).collect(),
                });
            }
            if areas.is_empty() {
                let [u, v] = copy.size_m.map(|size| size / 2.0);
                areas.push([[-u, -v], [u, -v], [u, v], [-u, v]].map(place).to_vec());
            }
            for mut area in areas {
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
        };
        if self.repeats.is_empty() {
            let alone = Copy {
                s_m: self.s_m,
                t_m: self.t_m,
                size_m: self.size_m,
            };
            return one(&alone, budget, skipped);
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
                one(&row.copy(self, i), budget, skipped);
            }
        }
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
        let along = if self.run_m > 0.0 {
            (ds / self.run_m).min(1.0)
        } else {
            0.0
        };
        let between = |ends: Option<[f64; 2]>, own: f64| ends.map_or(own, |[a, b]| a + (b - a) * along);
        let mut size_m = [
            between(self.length_m, of.size_m[0]),
            between(self.width_m, of.size_m[1]),
        ];
        let mut s_m = self.s_m + ds;
        if self.distance_m <= 0.0 && of.outlines.is_empty() {
            // One object over the whole row: its length is the row's.
            s_m += self.run_m / 2.0;
            size_m[0] = self.run_m;
        }
        Copy {
            s_m,
            t_m: between(self.t_m, of.t_m),
            size_m,
        }
    }
}

fn shoelace_m2(points: &[DVec2]) -> f64 {
    let origin = points[0];
    let twice: f64 = points
        .iter()
        .zip(points.iter().cycle().skip(1))
        .map(|(a, b)| (*a - origin).perp_dot(*b - origin))
        .sum();
    0.5 * twice
}
