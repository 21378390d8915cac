//! The analytic solids of boxes in bins on the ground, so that a ray tests only those near it.

use glam::{DVec2, DVec3};

use super::CameraRays;
use scene::solid::Solid;
use scene::{BoxId, Extent, SceneBox};
use world::objects;

/// Edge of a bin, m and columns.
const BIN_M: f64 = 4.0;
const BIN_COLUMNS: usize = 10;

/// Solids of boxes; only those over the grid are seen.
#[derive(Clone, Debug, Default)]
pub struct SolidIndex {
    solids: Vec<(Solid, Option<BoxId>)>,
    groups: Vec<BoxSolids>,
    /// Lower corner of the grid, m.
    low: DVec2,
    /// Bins along x and y.
    along: [usize; 2],
    bins: Vec<Vec<u32>>, // [x][y], indices of groups
}

/// The solids of one box, and a circle on the ground that holds them.
#[derive(Clone, Debug)]
struct BoxSolids {
    solids: std::ops::Range<usize>,
    low: DVec3,
    high: DVec3,
    middle: DVec2,
    radius_m2: f64,
    /// Velocity of the box, m/s.
    velocity: DVec3,
}

/// The boxes that a camera may see, each with the pixels that it may cover.
#[derive(Clone, Debug, Default)]
pub struct InView {
    /// Group and pixel range along u and v.
    groups: Vec<(u32, [f64; 2], [f64; 2])>,
}

/// Where a ray meets a solid.
#[derive(Clone, Copy, Debug)]
pub struct SolidHit<'a> {
    /// Distance, m.
    pub t_m: f64,
    /// Solid that was met.
    pub solid: &'a Solid,
    /// Box that the solid belongs to.
    pub box_id: Option<BoxId>,
    /// Origin of the ray as the solid sees it: moved back where a box moved while a shutter read, m.
    pub origin: DVec3,
}

impl BoxSolids {
    /// True if a ray passes beside the circle.
    #[inline]
    fn beside(&self, origin: DVec3, dir: DVec3) -> bool {
        let (to, flat) = (self.middle - origin.truncate(), dir.truncate());
        to.perp_dot(flat).powi(2) > self.radius_m2 * flat.length_squared()
    }
}

impl InView {
    /// Boxes in a row of pixels with middles at `v`.
    pub fn row(&self, v: f64) -> InView {
        self.only(|_, range| (range[0]..=range[1]).contains(&v))
    }

    /// Boxes in a piece of a row, from `first` to `last` px.
    pub fn piece(&self, first: f64, last: f64) -> InView {
        self.only(|range, _| range[0] <= last && range[1] >= first)
    }

    fn only(&self, keep: impl Fn(&[f64; 2], &[f64; 2]) -> bool) -> InView {
        let some = self.groups.iter().filter(|(_, u, v)| keep(u, v));
        InView {
            groups: some.copied().collect(),
        }
    }
}

impl SolidIndex {
    /// The solids of these boxes over a grid; boxes with a problem are left out.
    pub fn of_boxes<'a>(extent: Extent, boxes: impl Iterator<Item = &'a SceneBox>, seed: u64) -> Self {
        let group = |b: &SceneBox| {
            let mut solids = Vec::new();
            objects::object(b, seed, &mut solids);
            (solids, Some(b.id), b.velocity_mps.extend(0.0))
        };
        Self::new(extent, boxes.filter(|b| b.problem().is_none()).map(group))
    }

    /// Solids that stand still, in groups that lie together, over a grid.
    pub fn of_groups(extent: Extent, groups: impl Iterator<Item = Vec<Solid>>) -> Self {
        Self::new(extent, groups.map(|solids| (solids, None, DVec3::ZERO)))
    }

    /// Groups of solids: their box and its velocity, m/s.
    fn new(extent: Extent, all: impl Iterator<Item = (Vec<Solid>, Option<BoxId>, DVec3)>) -> Self {
        let mut solids: Vec<(Solid, Option<BoxId>)> = Vec::new();
        let mut groups = Vec::new();
        for (some, id, velocity) in all {
            let first = solids.len();
            solids.extend(some.into_iter().map(|s| (s, id)));
            let reach = |s: &Solid| (s.center - s.reach(), s.center + s.reach());
            let parts = || solids[first..].iter().map(|(s, _)| reach(s));
            let low = parts().fold(DVec3::INFINITY, |m, (lo, _)| m.min(lo));
            let high = parts().fold(DVec3::NEG_INFINITY, |m, (_, hi)| m.max(hi));
            if first < solids.len() {
                groups.push(BoxSolids {
                    solids: first..solids.len(),
                    low,
                    high,
                    middle: (low + high).truncate() / 2.0,
                    radius_m2: ((high - low).truncate() / 2.0 + 1e-3).length_squared(),
                    velocity,
                });
            }
        }
        let corner = extent.min_m().truncate();
        let along = [extent.nx(), extent.ny()].map(|n| n.div_ceil(BIN_COLUMNS));
        let mut bins = vec![Vec::new(); along[0] * along[1]];
        for (i, group) in groups.iter().enumerate() {
            let (lo, hi) = (group.low, group.high);
            let span = |axis: usize| {
                let bin = |p: DVec3| ((p[axis] - corner[axis]) / BIN_M).floor();
                let (lo, hi) = (bin(lo).max(0.0), bin(hi).min(along[axis] as f64 - 1.0));
                lo as usize..(hi + 1.0).max(0.0) as usize
            };
            for x in span(0) {
                for y in span(1) {
                    bins[x * along[1] + y].push(i as u32);
                }
            }
        }
        Self {
            solids,
            groups,
            low: corner,
            along,
            bins,
        }
    }

    /// Boxes that may cover a pixel of a camera.
    pub fn in_view(&self, rays: &CameraRays) -> InView {
        let mut groups = Vec::new();
        for (i, group) in self.groups.iter().enumerate() {
            if !rays.is_plain() {
                let radius = (group.high - group.low).length() / 2.0;
                let bounds = rays.bounds((group.low + group.high) / 2.0, radius, group.velocity.length());
                groups.extend(bounds.map(|[low, high]| (i as u32, [low.x, high.x], [low.y, high.y])));
                continue;
            }
            let corners: [DVec3; 8] = std::array::from_fn(|corner| {
                let pick = |axis: usize| {
                    if corner >> axis & 1 == 0 {
                        group.low[axis]
                    } else {
                        group.high[axis]
                    }
                };
                rays.project(DVec3::new(pick(0), pick(1), pick(2)))
            });
            if corners.iter().all(|c| c.z < -1e-6) {
                continue;
            }
            let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            for at in corners {
                // With a corner behind the camera it may be seen anywhere. Written so that NaN comes here too.
                if !(at.z > 0.05 && at.is_finite()) {
                    (lo, hi) = (DVec2::NEG_INFINITY, DVec2::INFINITY);
                    break;
                }
                (lo, hi) = (lo.min(at.truncate()), hi.max(at.truncate()));
            }
            groups.push((i as u32, [lo.x - 1.0, hi.x + 1.0], [lo.y - 1.0, hi.y + 1.0]));
        }
        InView { groups }
    }

    /// The first solid along the ray through the pixel (u, v) of the camera that `view` was made for.
    /// `after_s` is when the pixel is read. Unlike [`Self::cast`] it sees solids beyond the grid's border too.
    #[inline]
    pub fn cast_pixel(
        &self,
        view: &InView,
        (origin, dir): (DVec3, DVec3),
        after_s: f64,
        limit_m: f64,
    ) -> Option<SolidHit<'_>> {
        let (mut best, mut hit) = (limit_m, None);
        for (i, _, _) in &view.groups {
            let group = &self.groups[*i as usize];
            // A box that moved on is met where it was by a ray that began as much farther back.
            let origin = match after_s == 0.0 {
                true => origin,
                false => origin - group.velocity * after_s,
            };
            if group.beside(origin, dir) {
                continue;
            }
            self.enter(group, origin, dir, &mut best, &mut hit);
        }
        hit
    }

    #[inline]
    fn enter<'a>(
        &'a self,
        group: &BoxSolids,
        origin: DVec3,
        dir: DVec3,
        best: &mut f64,
        hit: &mut Option<SolidHit<'a>>,
    ) {
        for (solid, id) in &self.solids[group.solids.clone()] {
            if let Some(t) = solid.enter(origin, dir, best.min(1e9))
                && t < *best
            {
                *best = t;
                *hit = Some(SolidHit {
                    t_m: t,
                    solid,
                    box_id: *id,
                    origin,
                });
            }
        }
    }

    /// The first solid along a ray of the ego frame nearer than `limit_m` (may be infinite). `dir` is a
    /// finite unit vector. Rays that start inside a solid pass out of it unseen.
    pub fn cast(&self, origin: DVec3, dir: DVec3, limit_m: f64) -> Option<SolidHit<'_>> {
        if self.solids.is_empty() {
            return None;
        }
        let (o, d) = ((origin.truncate() - self.low) / BIN_M, dir.truncate() / BIN_M);
        let n = self.along;
        let (mut t0, mut t1) = (0.0f64, limit_m);
        for axis in 0..2 {
            if d[axis] == 0.0 {
                if !(0.0..=n[axis] as f64).contains(&o[axis]) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-o[axis] / d[axis], (n[axis] as f64 - o[axis]) / d[axis]);
            (t0, t1) = (t0.max(a.min(b)), t1.min(a.max(b)));
        }
        let inside = t0 <= t1; // not so for NaN
        if !inside {
            return None;
        }
        let start = |axis: usize| ((o[axis] + d[axis] * t0).max(0.0) as usize).min(n[axis] - 1);
        let mut cell = [start(0), start(1)];
        let mut best = limit_m;
        let mut hit = None;
        for _ in 0..n[0] + n[1] + 2 {
            for &i in &self.bins[cell[0] * n[1] + cell[1]] {
                let group = &self.groups[i as usize];
                if group.beside(origin, dir) {
                    continue;
                }
                self.enter(group, origin, dir, &mut best, &mut hit);
            }
            let next = |axis: usize| {
                if d[axis] == 0.0 {
                    return f64::INFINITY;
                }
                ((cell[axis] + usize::from(d[axis] > 0.0)) as f64 - o[axis]) / d[axis]
            };
            let (tx, ty) = (next(0), next(1));
            let axis = usize::from(ty < tx);
            if best < tx.min(ty) || tx.min(ty) > t1 {
                break;
            }
            let moved = cell[axis].wrapping_add_signed(if d[axis] > 0.0 { 1 } else { -1 });
            if moved >= n[axis] {
                break;
            }
            cell[axis] = moved;
        }
        hit
    }
}
