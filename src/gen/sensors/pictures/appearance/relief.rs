//! The lie of the land below the kerbs: heights at the middles of columns, blended between them, and where rays may meet them.

use glam::{Vec2, Vec3};

use super::noise::floor;
use scene::appearance::{BLOCK, HIGHEST_M, PER_M, VOXEL_M};
use scene::{BevLayout, Extent};

/// Step along a ray near the ground, m on the map.
const STEP_M: f32 = 0.2;
/// Distance over which the slope of the ground is taken, m: its facets are not seen.
const SLOPE_M: f32 = 0.6;
/// Corrections of the distance to the ground beyond the map.
const CORRECTIONS: usize = 3;

/// Heights of the ground of a map.
pub struct GroundRelief {
    /// Lower corner of the map, m.
    low: Vec2,
    size: [usize; 2],
    /// At the middles of columns, `[x][y]`, m.
    heights: Vec<f32>,
    blocks: [usize; 2],
    /// Lowest and highest of each block of columns and those around it, `[x][y]`, m.
    bounds: Vec<[f32; 2]>,
}

impl GroundRelief {
    /// The relief of a layout; `None` if its ground is level.
    pub fn new(layout: &BevLayout) -> Option<Self> {
        let extent: Extent = layout.extent();
        layout.relief.heights_m()?;
        let size = [extent.nx(), extent.ny()];
        let height = |[x, y]: [usize; 2]| layout.relief.height_m(extent.center(x, y, 0).truncate()) as f32;
        let heights: Vec<f32> = extent.all_columns().map(height).collect();
        let blocks = size.map(|n| n.div_ceil(BLOCK));
        let bounds = (0..blocks[0] * blocks[1]).map(|b| {
            let near = |at: usize, n: usize| (at * BLOCK).saturating_sub(1)..(at * BLOCK + BLOCK + 1).min(n);
            let mut bounds = [f32::INFINITY, f32::NEG_INFINITY];
            for x in near(b / blocks[1], size[0]) {
                for y in near(b % blocks[1], size[1]) {
                    let h = heights[x * size[1] + y];
                    bounds = [bounds[0].min(h), bounds[1].max(h)];
                }
            }
            bounds
        });
        Some(Self {
            low: extent.min_m().truncate().as_vec2(),
            size,
            bounds: bounds.collect(),
            heights,
            blocks,
        })
    }

    /// Words for the graphics card: heights, then the bounds of the blocks.
    pub fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let all = self.heights.iter().chain(self.bounds.as_flattened());
        all.map(|v| v.to_bits())
    }

    /// Lowest height, m.
    pub fn lowest_m(&self) -> f32 {
        self.heights.iter().copied().fold(f32::INFINITY, f32::min)
    }

    /// Height at a point, m; beyond the map that of its border.
    #[inline]
    pub fn at(&self, p: Vec2) -> f32 {
        let size = Vec2::new(self.size[0] as f32, self.size[1] as f32);
        let q = ((p - self.low) * PER_M - 0.5).clamp(Vec2::ZERO, (size - 1.001).max(Vec2::ZERO));
        let c = q.map(floor);
        let f = q - c;
        let ny = self.size[1];
        let i = c.x as usize * ny + c.y as usize;
        let (right, up) = (if self.size[0] > 1 { ny } else { 0 }, usize::from(ny > 1));
        let h = &self.heights;
        let low = h[i] + (h[i + up] - h[i]) * f.y;
        let high = h[i + right] + (h[i + right + up] - h[i + right]) * f.y;
        low + (high - low) * f.x
    }

    /// Slope at a point: how much the ground climbs along x and y.
    pub fn slope(&self, p: Vec2) -> Vec2 {
        let along = |d: Vec2| (self.at(p + d) - self.at(p - d)) / (2.0 * SLOPE_M);
        Vec2::new(along(Vec2::X * SLOPE_M), along(Vec2::Y * SLOPE_M))
    }

    /// The first place along a ray at which `above` is not positive any more, m; it says how far a point of the ray is above
    /// the ground with its kerbs, which are at most [`HIGHEST_M`] high.
    pub fn cast(&self, (o, d): (Vec3, Vec3), limit: f32, above: &impl Fn(f32) -> f32) -> Option<f32> {
        let size = Vec2::new(self.size[0] as f32, self.size[1] as f32) * VOXEL_M;
        let (mut t0, mut t1) = (0.0f32, limit);
        for axis in 0..2 {
            let (lo, hi) = (self.low[axis], self.low[axis] + size[axis]);
            if d[axis].abs() < 1e-9 {
                if !(lo..=hi).contains(&o[axis]) {
                    return self.beyond((o, d), 0.0, limit);
                }
                continue;
            }
            let (a, b) = ((lo - o[axis]) / d[axis], (hi - o[axis]) / d[axis]);
            (t0, t1) = (t0.max(a.min(b)), t1.min(a.max(b)));
        }
        let crosses = t0 < t1;
        if !crosses {
            return self.beyond((o, d), 0.0, limit);
        }
        // From outside the map a ray may meet the ground before it.
        if let Some(before) = self.beyond((o, d), 0.0, t0) {
            return Some(before);
        }
        let flat = d.truncate().length();
        let block_m = BLOCK as f32 * VOXEL_M;
        let (q, qd) = ((o.truncate() - self.low) / block_m, d.truncate() / block_m);
        let start = |a: usize| ((q[a] + qd[a] * (t0 + 1e-4)).max(0.0) as usize).min(self.blocks[a] - 1);
        let (mut cell, mut t, mut was_above) = ([start(0), start(1)], t0, false);
        for _ in 0..self.blocks[0] + self.blocks[1] + 2 {
            let next = |a: usize| match qd[a].abs() < 1e-9 {
                true => f32::INFINITY,
                false => ((cell[a] + usize::from(qd[a] > 0.0)) as f32 - q[a]) / qd[a],
            };
            let (tx, ty) = (next(0), next(1));
            let t_out = tx.min(ty).min(t1);
            let [_, highest] = self.bounds[cell[0] * self.blocks[1] + cell[1]];
            if (o.z + d.z * t).min(o.z + d.z * t_out) > highest + HIGHEST_M {
                was_above = true;
            } else {
                let steps = ((t_out - t) * flat.max(0.2) / STEP_M).ceil().clamp(1.0, 64.0);
                let mut before = t;
                for i in 0..=steps as usize {
                    let at = t + (t_out - t) * i as f32 / steps;
                    if above(at) > 0.0 {
                        (was_above, before) = (true, at);
                    } else if was_above {
                        return Some(refine(before, at, above));
                    }
                }
            }
            if t_out >= t1 {
                break;
            }
            let axis = usize::from(ty < tx);
            let moved = cell[axis].wrapping_add_signed(if qd[axis] > 0.0 { 1 } else { -1 });
            if moved >= self.blocks[axis] {
                break;
            }
            cell[axis] = moved;
            t = t_out;
        }
        self.beyond((o, d), t1, limit)
    }

    /// Where a ray meets the ground beyond the map, farther than `from`, m.
    fn beyond(&self, (o, d): (Vec3, Vec3), from: f32, limit: f32) -> Option<f32> {
        if d.z >= -1e-5 {
            return None;
        }
        let mut t = from;
        for _ in 0..CORRECTIONS {
            t = (self.at((o + d * t).truncate()) - o.z) / d.z;
        }
        (t > from && t < limit).then_some(t)
    }
}

/// Closes in on the place between two where the ground begins.
fn refine(mut out: f32, mut within: f32, above: &impl Fn(f32) -> f32) -> f32 {
    for _ in 0..8 {
        let middle = (out + within) * 0.5;
        match above(middle) <= 0.0 {
            true => within = middle,
            false => out = middle,
        }
    }
    within
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Relief;

    /// From inside the map, from outside over ground that goes on as at the border, and past it.
    #[test]
    fn rays_meet_a_slope_wherever_they_begin() {
        let mut layout = BevLayout::default();
        layout.relief = Relief::from_fn(layout.extent(), |p| p.x * 0.05);
        let relief = GroundRelief::new(&layout).expect("a slope");
        let met = |o: Vec3, d: Vec3| {
            let above = |t: f32| o.z + d.z * t - relief.at((o + d * t).truncate());
            relief.cast((o, d), 200.0, &above).map(|t| o + d * t)
        };
        for (x, z) in [(-60.0, 0.5), (-60.0, 3.0), (0.0, 1.5), (60.0, 4.0)] {
            for way in [
                Vec3::new(1.0, 0.1, -0.1),
                Vec3::new(-1.0, 0.1, -0.1),
                Vec3::new(1.0, 0.0, 0.02),
            ] {
                let (o, d) = (Vec3::new(x, 3.0, z), way.normalize());
                match met(o, d) {
                    Some(p) => assert!((p.z - relief.at(p.truncate())).abs() < 0.02, "{o} {d}: {p}"),
                    None => assert!(d.z > 0.0, "{o} {d}: no ground"),
                }
            }
        }
        // Before the map begins, 40 m from its middle.
        let near = met(Vec3::new(-60.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -0.2).normalize());
        assert!(near.is_some_and(|p| p.x < -54.0), "{near:?}");
    }
}
