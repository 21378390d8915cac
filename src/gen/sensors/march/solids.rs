//! The analytic solids of boxes in bins on the ground, so that a ray tests only those near it.

use glam::{DVec2, DVec3};

use crate::generation::world::{objects, shapes::Solid};
use crate::scene::{BoxId, SceneBox};

const BIN_M: f64 = 4.0;
const BINS: usize = 20;
const HALF_M: f64 = 40.0;

/// Solids of boxes; only what lies over the grid is seen.
#[derive(Clone, Debug, Default)]
pub struct SolidIndex {
    solids: Vec<(Solid, BoxId)>,
    bins: Vec<Vec<u32>>, // [x][y]
}

/// Where a ray meets a solid.
#[derive(Clone, Copy, Debug)]
pub struct SolidHit<'a> {
    /// Distance, m.
    pub t_m: f64,
    /// What was met.
    pub solid: &'a Solid,
    /// Whose it is.
    pub box_id: Option<BoxId>,
}

impl SolidIndex {
    /// The solids of these boxes; boxes with a problem are left out.
    pub fn of_boxes<'a>(boxes: impl Iterator<Item = &'a SceneBox>, seed: u64) -> Self {
        let mut solids = Vec::new();
        let mut some = Vec::new();
        for b in boxes.filter(|b| b.problem().is_none()) {
            objects::object(b, seed, &mut some);
            solids.extend(some.drain(..).map(|s| (s, b.id)));
        }
        let mut bins = vec![Vec::new(); BINS * BINS];
        let bin = |v: f64| ((v + HALF_M) / BIN_M).floor();
        for (i, (s, _)) in solids.iter().enumerate() {
            let (lo, hi) = (s.center - s.reach(), s.center + s.reach());
            let last = BINS as f64 - 1.0;
            let span = |lo: f64, hi: f64| {
                let (lo, hi) = (bin(lo).max(0.0), bin(hi).min(last));
                lo as usize..(hi + 1.0).max(0.0) as usize
            };
            for x in span(lo.x, hi.x) {
                for y in span(lo.y, hi.y) {
                    bins[x * BINS + y].push(i as u32);
                }
            }
        }
        Self { solids, bins }
    }

    /// The first solid along a ray of the ego frame nearer than `limit_m` (may be infinite). `dir` is a
    /// finite unit vector. Rays that start inside a solid pass out of it unseen.
    pub fn cast(&self, origin: DVec3, dir: DVec3, limit_m: f64) -> Option<SolidHit<'_>> {
        if self.solids.is_empty() {
            return None;
        }
        let (o, d) = (
            (origin.truncate() + DVec2::splat(HALF_M)) / BIN_M,
            dir.truncate() / BIN_M,
        );
        let (mut t0, mut t1) = (0.0f64, limit_m);
        for axis in 0..2 {
            if d[axis] == 0.0 {
                if !(0.0..=BINS as f64).contains(&o[axis]) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-o[axis] / d[axis], (BINS as f64 - o[axis]) / d[axis]);
            (t0, t1) = (t0.max(a.min(b)), t1.min(a.max(b)));
        }
        if !(t0 <= t1) {
            return None;
        }
        let start = |axis: usize| ((o[axis] + d[axis] * t0).max(0.0) as usize).min(BINS - 1);
        let mut cell = [start(0), start(1)];
        let mut best = limit_m;
        let mut hit = None;
        for _ in 0..2 * BINS + 2 {
            for &i in &self.bins[cell[0] * BINS + cell[1]] {
                let (solid, id) = &self.solids[i as usize];
                if let Some(t) = solid.enter(origin, dir, best.min(1e9))
                    && t < best
                {
                    best = t;
                    hit = Some(SolidHit {
                        t_m: t,
                        solid,
                        box_id: Some(*id),
                    });
                }
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
            if moved >= BINS {
                break;
            }
            cell[axis] = moved;
        }
        hit
    }
}
