//! Selection of boxes by a rectangle or a lasso on the ground.

use glam::DVec2;

use scene::{BoxId, Frame};

/// Boxes whose centre lies in the upright rectangle between two corners (ego frame, m), by id.
pub fn in_rect(frame: &Frame, a_m: DVec2, b_m: DVec2) -> Vec<BoxId> {
    let (min, max) = (a_m.min(b_m), a_m.max(b_m));
    let inside = |p: DVec2| p.cmpge(min).all() && p.cmple(max).all();
    chosen(frame, inside)
}

/// Boxes whose centre lies in a closed outline (even-odd rule; fewer than three vertices take none), by id.
pub fn in_outline(frame: &Frame, points_m: &[DVec2]) -> Vec<BoxId> {
    chosen(frame, |p| is_inside(points_m, p))
}

fn chosen(frame: &Frame, inside: impl Fn(DVec2) -> bool) -> Vec<BoxId> {
    let boxes = frame.boxes.values();
    boxes
        .filter(|b| inside(b.center_m.truncate()))
        .map(|b| b.id)
        .collect()
}

/// True if a point lies in a closed outline by the even-odd rule; in whatever plane both are given.
pub fn is_inside(outline: &[DVec2], p: DVec2) -> bool {
    if outline.len() < 3 {
        return false;
    }
    let mut inside = false;
    let mut before = outline[outline.len() - 1];
    for &v in outline {
        if (v.y > p.y) != (before.y > p.y) && p.x < (before.x - v.x) * (p.y - v.y) / (before.y - v.y) + v.x {
            inside = !inside;
        }
        before = v;
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_hold_what_is_in_them() {
        // A horseshoe: its gap is outside.
        let u = [
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 6.0],
            [4.0, 6.0],
            [4.0, 2.0],
            [2.0, 2.0],
            [2.0, 6.0],
            [0.0, 6.0],
        ];
        let u = u.map(DVec2::from_array);
        for (p, inside) in [
            ([1.0, 5.0], true),
            ([3.0, 5.0], false),
            ([3.0, 1.0], true),
            ([7.0, 1.0], false),
        ] {
            assert_eq!(is_inside(&u, p.into()), inside, "{p:?}");
        }
        assert!(!is_inside(&u[..2], DVec2::new(1.0, 0.0)));
        assert!(!is_inside(&u, DVec2::NAN) && !is_inside(&[DVec2::NAN; 4], DVec2::ONE));
    }
}
