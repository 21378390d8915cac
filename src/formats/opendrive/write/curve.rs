//! A smooth way between two lanes.

use glam::DVec2;

use super::chains::STEP_M;
use super::fit::wrapped;
use super::roads::Contact;

/// Turns beyond this go back, rad.
pub(super) const BACK_RAD: f64 = 2.6;

/// A smooth way from one place and heading to another; `None` if it would turn back or wind.
pub(super) fn curve(from: Contact, to: Contact) -> Option<Vec<DVec2>> {
    let way = to.at_m - from.at_m;
    let turn = wrapped(to.heading_rad - from.heading_rad);
    let [out, back] = [from, to].map(|c| DVec2::from_angle(c.heading_rad));
    if way.dot(out) < 0.0 || way.dot(back) < 0.0 || way.length() < 1.0 || turn.abs() > BACK_RAD {
        return None;
    }
    // Hermite's cubic with the speed of a circle of that turn.
    let speed = way.length() / (turn / 4.0).cos().powi(2);
    let count = (way.length() / STEP_M).ceil().max(4.0) as usize * 2;
    let at = |i: usize| {
        let p = i as f64 / count as f64;
        let (p2, p3) = (p * p, p * p * p);
        from.at_m * (2.0 * p3 - 3.0 * p2 + 1.0)
            + out * (speed * (p3 - 2.0 * p2 + p))
            + to.at_m * (3.0 * p2 - 2.0 * p3)
            + back * (speed * (p3 - p2))
    };
    Some((0..=count).map(at).collect())
}
