//! Picking of background things: under the pointer, in a rectangle, behind a voxel. All points are in the world frame,
//! m, as things are, unless a name says otherwise.

use glam::DVec2;

use scene::{Background, Class, Form, Frame, Thing, ThingId};

use super::choose::is_inside;

/// Radius around a post's place within which the post is picked, m.
const POST_M: f64 = 0.5;
/// Voxels reach this far beyond the thing that they show, m.
const VOXEL_REACH_M: f64 = 0.9;

/// Distance of a point from the footprint of a form, m; 0 inside.
pub fn distance_m(form: &Form, p_m: DVec2) -> f64 {
    let to_edges = |points: &[DVec2], closed: bool| {
        let wrap = points.first().filter(|_| closed);
        let ends: Vec<DVec2> = points.iter().chain(wrap).copied().collect();
        let pieces = ends.windows(2).map(|e| to_segment(p_m, e[0], e[1]));
        pieces.fold(f64::INFINITY, f64::min)
    };
    let of_area = |outline: &[DVec2]| match is_inside(outline, p_m) {
        true => 0.0,
        false => to_edges(outline, true),
    };
    match form {
        Form::Building(b) => of_area(&b.outline_m),
        Form::Shrubs(s) => of_area(&s.outline_m),
        Form::Line(l) => (to_edges(&l.points_m, false) - l.width_m / 2.0).max(0.0),
        Form::Bridge(b) => (to_edges(&b.points_m, false) - b.width_m / 2.0).max(0.0),
        Form::Tree(t) => (p_m.distance(t.position_m) - t.crown_radius_m).max(0.0),
        Form::Post(p) => (p_m.distance(p.position_m) - POST_M).max(0.0),
    }
}

/// Distance of a point from a segment, m.
fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let d = b - a;
    let t = ((p - a).dot(d) / d.length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + d * t)
}

/// Size of a footprint by which the smaller of two is taken, m^2.
fn area_m2(form: &Form) -> f64 {
    let (min, max) = form.bounds_m();
    let length = |points: &[DVec2]| points.windows(2).map(|p| p[0].distance(p[1])).sum::<f64>();
    match form {
        Form::Line(l) => length(&l.points_m) * l.width_m,
        Form::Bridge(b) => length(&b.points_m) * b.width_m,
        _ => (max - min).element_product(),
    }
}

/// The thing whose footprint holds a point, the smallest of several; else the nearest within `reach_m`.
pub fn thing_at(background: &Background, p_m: DVec2, reach_m: f64) -> Option<ThingId> {
    if !p_m.is_finite() {
        return None;
    }
    let near = background.iter().filter_map(|t| {
        let (min, max) = t.form.bounds_m();
        let around = DVec2::splat(reach_m + POST_M);
        let outside = p_m.cmplt(min - around).any() || p_m.cmpgt(max + around).any();
        let distance = (!outside).then(|| distance_m(&t.form, p_m))?;
        (distance <= reach_m).then_some((distance, area_m2(&t.form), t.id))
    });
    near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(b.2.cmp(&a.2)))
        .map(|(_, _, id)| id)
}

/// Things whose middle `inside` takes, by id.
pub fn things_in(background: &Background, inside: impl Fn(DVec2) -> bool) -> Vec<ThingId> {
    let taken = background.iter().filter(|t| inside(t.form.middle_m()));
    taken.map(|t| t.id).collect()
}

/// The thing that a voxel of a frame shows: of its class, around it and not much lower than it.
pub fn thing_of_voxel(frame: &Frame, background: &Background, [x, y, z]: [usize; 3]) -> Option<ThingId> {
    let class = Class::from_id(frame.occupancy.get(x, y, z)).filter(|c| *c != Class::Free)?;
    let center = frame.extent().center(x, y, z);
    let p_m = center.truncate();
    let above_m = center.z - frame.layout.relief.height_m(center.truncate());
    let may = |t: &&Thing| {
        // The deck of a bridge is road or sidewalk; benches and bins have a class of their own.
        let alike = t.form.class() == class || matches!(t.form, Form::Bridge(_)) && !class.is_object();
        let (min, max) = t.form.bounds_m();
        let reach = DVec2::splat(VOXEL_REACH_M);
        let here = p_m.cmpge(min - reach).all() && p_m.cmple(max + reach).all();
        alike && here && above_m <= roof_m(&t.form) + VOXEL_REACH_M
    };
    let measured = background.iter().filter(may).filter_map(|t| {
        let distance = distance_m(&t.form, p_m);
        let reach = VOXEL_REACH_M + overhang_m(&t.form);
        (distance <= reach).then_some((distance, area_m2(&t.form), t.id))
    });
    measured
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(b.2.cmp(&a.2)))
        .map(|(_, _, id)| id)
}

/// How far its voxels reach beyond its footprint, m: crowns are footprints already.
fn overhang_m(form: &Form) -> f64 {
    match form {
        Form::Tree(_) | Form::Line(_) | Form::Bridge(_) => 0.0,
        _ => form.overhang_m(),
    }
}

/// How high it can be, m above the ground: a roof stands on the walls.
fn roof_m(form: &Form) -> f64 {
    match form {
        Form::Building(b) => b.height_m + 8.0,
        Form::Bridge(b) => b.height_m + 1.5,
        other => other.height_m(),
    }
}

/// Corner of an outline or line within `reach_m` of a point, by its index in [`Form::points_m`].
pub fn corner_at(form: &Form, p_m: DVec2, reach_m: f64) -> Option<usize> {
    if matches!(form, Form::Tree(_) | Form::Post(_)) {
        return None;
    }
    let points = form.points_m().into_iter().enumerate();
    let near = points.filter(|(_, q)| q.distance(p_m) <= reach_m);
    near.min_by(|a, b| a.1.distance(p_m).total_cmp(&b.1.distance(p_m)))
        .map(|(i, _)| i)
}

/// The form with one of its points elsewhere.
pub fn with_corner(form: &Form, index: usize, at_m: DVec2) -> Form {
    let (mut out, mut i) = (form.clone(), 0);
    out.map_points(
        |p| {
            i += 1;
            if i - 1 == index { at_m } else { p }
        },
        0.0,
    );
    out
}

#[cfg(test)]
#[path = "pick_things_tests.rs"]
mod tests;
