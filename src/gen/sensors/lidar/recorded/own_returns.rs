//! Returns of an object beyond its box: boxes that were found are often shorter than their objects, and bumpers would stay in the
//! air.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use scene::SceneBox;

/// Distance beyond a box within which returns may be of its object, m.
pub const AROUND_M: f64 = 0.8;
/// Distance between neighbouring returns of one object along an axis, m, and its part of the range where that is more.
const APART_M: f64 = 0.2;
const APART: f64 = 0.015;
/// Distance from the outer edge within which returns show that something goes on, m, and how many of them.
const EDGE_M: f64 = 0.25;
const EDGE_RETURNS: usize = 3;
/// Times as many returns as are in a box that may be its object's beyond it.
const MOST_BEYOND: usize = 3;
/// Height above a box up to which returns may be of its object, m.
pub const ABOVE_M: f64 = 0.3;

/// Records near a box that hang together with those in it, of objects that end near it; none if what hangs together goes on, as a
/// wall or a hedge does. `inside` and `near` are records with their places, m.
pub fn beyond_box(
    b: &SceneBox,
    sensor: DVec3,
    inside: &[(usize, DVec3)],
    near: &[(usize, DVec3)],
) -> Vec<usize> {
    let apart_m = APART_M.max(APART * b.center_m.distance(sensor));
    let cell = |p: DVec3| (p / apart_m).floor().as_i64vec3();
    let mut by_cell: HashMap<_, Vec<usize>> = HashMap::new();
    for (i, (_, p)) in near.iter().enumerate() {
        by_cell.entry(cell(*p)).or_default().push(i);
    }
    let (mut reached, mut waiting) = (HashSet::new(), Vec::new());
    waiting.extend(inside.iter().map(|(_, p)| cell(*p)));
    let mut seen: HashSet<_> = waiting.iter().copied().collect();
    while let Some(at) = waiting.pop() {
        for offset in 0..27 {
            let step = glam::I64Vec3::new(offset / 9 - 1, offset / 3 % 3 - 1, offset % 3 - 1);
            let beside = at + step;
            if let Some(some) = by_cell.get(&beside)
                && seen.insert(beside)
            {
                reached.extend(some.iter().copied());
                waiting.push(beside);
            }
        }
        if let Some(some) = by_cell.get(&at) {
            reached.extend(some.iter().copied());
        }
    }
    let at_edge = |i: &&usize| {
        let beside = b.to_local(near[**i].1).truncate().abs() - b.size_m.truncate() / 2.0;
        beside.max_element() > AROUND_M - EDGE_M
    };
    let goes_on = reached.iter().filter(at_edge).count() > EDGE_RETURNS;
    if goes_on || reached.len() > MOST_BEYOND * inside.len() {
        return Vec::new();
    }
    reached.into_iter().map(|i| near[i].0).collect()
}
