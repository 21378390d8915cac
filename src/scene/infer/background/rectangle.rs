//! Upright rectangles on the ground around columns, and the cut of a crooked part into several straight ones.

use glam::DVec2;

use super::columns::middle_m;
use crate::Extent;

/// Parts are cut at most this often, one within another.
const DEEPEST: u32 = 6;
/// A cut must save this share of the area.
const WORTH: f64 = 0.88;
/// Cuts are tried this far apart, m.
const STEP_M: f64 = 0.8;

/// A rectangle: along its first side, and across it.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneryRectangle {
    pub middle_m: DVec2,
    /// Half of the length and of the width, m.
    pub half_m: DVec2,
    /// Unit vector of the length.
    pub along: DVec2,
}

impl SceneryRectangle {
    /// The one of least area, by trying headings a degree apart; half a column more on every side than the middles.
    pub fn around(map: Extent, columns: &[usize]) -> Self {
        let points: Vec<DVec2> = columns.iter().map(|c| middle_m(map, *c)).collect();
        let all = (0..90).map(|degree| {
            Self::in_direction(map, &points, DVec2::from_angle(f64::from(degree).to_radians()))
        });
        let least = all.min_by(|a, b| a.area_m2().total_cmp(&b.area_m2()));
        let found = least.unwrap_or(Self {
            middle_m: DVec2::ZERO,
            half_m: DVec2::ZERO,
            along: DVec2::X,
        });
        match found.half_m.x >= found.half_m.y {
            true => found,
            false => Self {
                half_m: DVec2::new(found.half_m.y, found.half_m.x),
                along: found.along.perp(),
                ..found
            },
        }
    }

    /// The one of that heading.
    fn in_direction(map: Extent, points: &[DVec2], along: DVec2) -> Self {
        let local = points
            .iter()
            .map(|p| DVec2::new(p.dot(along), p.dot(along.perp())));
        let (low, high) = local.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let middle = (low + high) / 2.0;
        Self {
            middle_m: along * middle.x + along.perp() * middle.y,
            half_m: (high - low + DVec2::splat(map.voxel_m())) / 2.0,
            along,
        }
    }

    pub fn area_m2(&self) -> f64 {
        4.0 * self.half_m.x * self.half_m.y
    }

    /// A point in the rectangle's own axes, from its middle, m.
    pub fn local(&self, p: DVec2) -> DVec2 {
        let d = p - self.middle_m;
        DVec2::new(d.dot(self.along), d.dot(self.along.perp()))
    }

    /// The point of the ground at own coordinates, m.
    pub fn ground(&self, own: DVec2) -> DVec2 {
        self.middle_m + self.along * own.x + self.along.perp() * own.y
    }

    /// Its corners, counter-clockwise.
    pub fn corners_m(&self) -> Vec<DVec2> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(u, v)| self.ground(DVec2::new(u, v) * self.half_m))
            .to_vec()
    }
}

/// Cuts columns until `fits` takes each part with its rectangle, or no cut saves area.
pub(super) fn split(
    map: Extent,
    columns: Vec<usize>,
    fits: &dyn Fn(&SceneryRectangle, &[usize]) -> bool,
) -> Vec<(SceneryRectangle, Vec<usize>)> {
    let mut out = Vec::new();
    let mut open = vec![(columns, 0)];
    while let Some((columns, depth)) = open.pop() {
        if columns.is_empty() {
            continue;
        }
        let rectangle = SceneryRectangle::around(map, &columns);
        let halves = match depth == DEEPEST || fits(&rectangle, &columns) {
            true => None,
            false => best_cut(map, &rectangle, &columns),
        };
        match halves {
            Some((a, b)) => open.extend([(a, depth + 1), (b, depth + 1)]),
            None => out.push((rectangle, columns)),
        }
    }
    out
}

/// The cut across or along the rectangle whose two parts have least area.
fn best_cut(
    map: Extent,
    rectangle: &SceneryRectangle,
    columns: &[usize],
) -> Option<(Vec<usize>, Vec<usize>)> {
    let own: Vec<DVec2> = columns
        .iter()
        .map(|c| rectangle.local(middle_m(map, *c)))
        .collect();
    let mut best = (rectangle.area_m2() * WORTH, None);
    for axis in 0..2 {
        let half = rectangle.half_m[axis];
        let steps = (2.0 * half / STEP_M) as usize;
        for at in (1..steps).map(|i| -half + i as f64 * STEP_M) {
            let area = |low: bool| {
                let side = own.iter().filter(|p| (p[axis] < at) == low);
                let (min, max) = side.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), p| {
                    (min.min(*p), max.max(*p))
                });
                let size = max - min + DVec2::splat(map.voxel_m());
                if size.x > 0.0 { size.x * size.y } else { 0.0 }
            };
            let both = area(true) + area(false);
            if both < best.0 {
                best = (both, Some((axis, at)));
            }
        }
    }
    let (axis, at) = best.1?;
    let pairs = columns.iter().zip(&own);
    let (a, b): (Vec<_>, Vec<_>) = pairs.partition(|(_, p)| p[axis] < at);
    let columns_of = |list: Vec<(&usize, &DVec2)>| list.into_iter().map(|(c, _)| *c).collect::<Vec<_>>();
    Some((columns_of(a), columns_of(b)))
}
