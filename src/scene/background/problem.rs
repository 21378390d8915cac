//! Problems of a thing of the background, in one line.

use glam::DVec2;

use super::{Form, Thing};

/// Largest coordinate, m.
const LARGEST_M: f64 = 1e5;
/// Largest height, width or radius, m.
const LARGEST_SIZE_M: f64 = 300.0;
/// Longest side of the box around an outline, m.
const LARGEST_EXTENT_M: f64 = 2000.0;
/// Most vertices of an outline, and of a line.
const MAX_CORNERS: usize = 128;
const MAX_VERTICES: usize = 2000;
/// Smallest outline, m^2.
const SMALLEST_M2: f64 = 0.25;

/// Area inside an outline, m^2, negative if it runs clockwise.
pub(super) fn signed_area_m2(outline_m: &[DVec2]) -> f64 {
    let n = outline_m.len();
    // Relative to a corner: far from the origin the products would cancel.
    let at = |i: usize| outline_m[i % n] - outline_m[0];
    (0..n).map(|i| at(i).perp_dot(at(i + 1)) / 2.0).sum()
}

/// The first two edges of a closed outline that cross or touch although they are not neighbours.
pub fn crossing_edges(outline_m: &[DVec2]) -> Option<(usize, usize)> {
    let n = outline_m.len();
    let edge = |i: usize| (outline_m[i], outline_m[(i + 1) % n]);
    for i in 0..n {
        for j in i + 1..n {
            let neighbours = j == i + 1 || (i == 0 && j == n - 1);
            let ((a, b), (c, d)) = (edge(i), edge(j));
            let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
            let (s1, s2) = (side(a, b, c), side(a, b, d));
            let (s3, s4) = (side(c, d, a), side(c, d, b));
            if !neighbours && s1 * s2 <= 0.0 && s3 * s4 <= 0.0 && (s1 != 0.0 || s2 != 0.0) {
                return Some((i, j));
            }
        }
    }
    None
}

pub(super) fn problem(form: &Form) -> Option<String> {
    let name = form.name();
    let found = match form {
        Form::Building(b) => outline(&b.outline_m).or_else(|| size("height_m", b.height_m, 0.5)),
        Form::Tree(t) => points(std::slice::from_ref(&t.position_m), 1, "position_m")
            .or_else(|| size("height_m", t.height_m, 0.3))
            .or_else(|| size("crown_radius_m", t.crown_radius_m, 0.1)),
        Form::Shrubs(s) => outline(&s.outline_m)
            .or_else(|| size("height_m", s.height_m, 0.1))
            // Written so that NaN fails too.
            .or_else(|| {
                (!(0.0..=2.0).contains(&s.per_m2)).then(|| format!("per_m2 is {}, expected 0 to 2", s.per_m2))
            }),
        Form::Line(l) => points(&l.points_m, 2, "points_m")
            .or_else(|| size("height_m", l.height_m, 0.1))
            .or_else(|| size("width_m", l.width_m, 0.02)),
        Form::Post(p) => points(std::slice::from_ref(&p.position_m), 1, "position_m")
            .or_else(|| size("height_m", p.height_m, 0.1))
            .or_else(|| {
                (!p.yaw_rad.is_finite())
                    .then(|| format!("yaw_rad is {}, expected a finite number", p.yaw_rad))
            }),
        Form::Bridge(b) => points(&b.points_m, 2, "points_m")
            .or_else(|| size("width_m", b.width_m, 0.5))
            .or_else(|| size("thickness_m", b.thickness_m, 0.3))
            .or_else(|| size("height_m", b.height_m, b.thickness_m)),
    };
    found.map(|text| format!("{name}: {text}"))
}

fn size(field: &str, found: f64, least: f64) -> Option<String> {
    // Written so that NaN fails too.
    (!(least..=LARGEST_SIZE_M).contains(&found))
        .then(|| format!("{field} is {found}, expected {least} to {LARGEST_SIZE_M}"))
}

fn points(points_m: &[DVec2], least: usize, field: &str) -> Option<String> {
    if points_m.len() < least || points_m.len() > MAX_VERTICES {
        let found = points_m.len();
        return Some(format!(
            "{field} holds {found} points, expected {least} to {MAX_VERTICES}"
        ));
    }
    // Written so that NaN fails too.
    let within = |p: &&DVec2| !p.abs().cmple(DVec2::splat(LARGEST_M)).all();
    if let Some(p) = points_m.iter().find(within) {
        return Some(format!(
            "{field} holds [{}, {}], expected finite numbers within {LARGEST_M} m",
            p.x, p.y
        ));
    }
    let (min, max) = points_m
        .iter()
        .fold((points_m[0], points_m[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let extent = (max - min).max_element();
    if extent > LARGEST_EXTENT_M {
        return Some(format!(
            "{field} spans {extent} m, expected at most {LARGEST_EXTENT_M} m"
        ));
    }
    (least > 1 && extent < 0.05).then(|| format!("{field} spans {extent} m, expected at least 0.05 m"))
}

fn outline(outline_m: &[DVec2]) -> Option<String> {
    if outline_m.len() < 3 || outline_m.len() > MAX_CORNERS {
        let found = outline_m.len();
        return Some(format!(
            "outline_m holds {found} corners, expected 3 to {MAX_CORNERS}"
        ));
    }
    if let Some(text) = points(outline_m, 3, "outline_m") {
        return Some(text);
    }
    if let Some((i, j)) = crossing_edges(outline_m) {
        return Some(format!("edges {i} and {j} of outline_m cross, expected none to"));
    }
    let area = signed_area_m2(outline_m).abs();
    (area < SMALLEST_M2).then(|| format!("outline_m encloses {area} m2, expected at least {SMALLEST_M2}"))
}

impl Thing {
    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        self.form.problem()
    }
}
