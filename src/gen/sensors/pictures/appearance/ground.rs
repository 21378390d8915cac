//! The ground as it is drawn: its classes as smooth fields, so that kerbs run in curves and not in
//! steps of a voxel, with heights, without holes, and without an end at the border of the grid.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::noise::{floor, ramp, value2};
use super::relief::GroundRelief;
use crate::pictures::march::ground::GroundHeightField as Columns;
use scene::appearance::{AppearanceData, AppearanceSection, HIGHEST_M, KERB_M, PER_M};
use scene::{BevLayer, BevLayout, Class, Extent};

/// Width of the blur's kernel in columns: its standard deviation is about 1.2.
const BLURS: usize = 3;

/// Shares of road, sidewalk, other flat ground and terrain, `[x][y]`, each 0..1, adding up to 1.
pub struct SmoothGround {
    /// Kind of ground of each column: place in the shares.
    kind: Vec<usize>,
    /// Lower corner, m.
    low: Vec2,
    /// Columns along x and along y, and the same as numbers.
    size: [usize; 2],
    size_f: Vec2,
    /// Steps in the arrays from a column to the next one along x and along y; 0 where there is none.
    next: [usize; 2],
    share: Vec<[f32; 4]>,
    /// True for columns with nothing but road around, which are level.
    level: Vec<bool>,
    /// Heights below the kerbs; `None` if they are 0 everywhere.
    relief: Option<GroundRelief>,
}

/// The ground at a point.
#[derive(Clone, Copy, Debug)]
pub struct GroundAt {
    /// Shares of road, sidewalk, other flat ground and terrain.
    pub share: [f32; 4],
    /// Distance inside the road from its edge in m, negative outside; good to about 0.4 m.
    pub inside_road_m: f32,
    /// Height, m.
    pub height_m: f32,
}

fn slot(class: u8) -> usize {
    match Class::from_id(class) {
        Some(Class::DriveableSurface) => 0,
        Some(Class::Sidewalk) => 1,
        Some(Class::OtherFlat) => 2,
        _ => 3,
    }
}

impl SmoothGround {
    /// Builds the ground from its labels. A column without one takes the layout's kind of ground, or that of the
    /// nearest column. If these are those of `before`, of the same layout, that is the ground.
    pub fn new(columns: &Columns, layout: &BevLayout, before: Option<&Arc<Self>>) -> Arc<Self> {
        let extent = layout.extent();
        let (n, [nx, ny]) = (extent.columns(), [extent.nx(), extent.ny()]);
        let mut kind: Vec<Option<usize>> = (0..n)
            .map(|i| {
                let [x, y] = extent.column(i);
                let bits = layout.cells()[i];
                let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
                let seen = columns.at(x, y).map(|(class, _)| slot(class));
                seen.or((bits & road != 0).then_some(0))
                    .or((bits & BevLayer::Walkway.bit() != 0).then_some(1))
            })
            .collect();
        let mut queue: VecDeque<usize> = (0..n).filter(|i| kind[*i].is_some()).collect();
        while let Some(i) = queue.pop_front() {
            let [x, y] = extent.column(i);
            for (x, y) in [
                (x.wrapping_sub(1), y),
                (x + 1, y),
                (x, y.wrapping_sub(1)),
                (x, y + 1),
            ] {
                if extent.holds(x, y) && kind[extent.index(x, y)].is_none() {
                    // A column without any takes the kind of its neighbour.
                    kind[extent.index(x, y)] = kind[i];
                    queue.push_back(extent.index(x, y));
                }
            }
        }
        let kind: Vec<usize> = kind.into_iter().map(|k| k.unwrap_or(3)).collect();
        if let Some(same) = before.filter(|before| before.kind == kind) {
            return same.clone();
        }
        let one = |k: usize| std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        let mut share: Vec<[f32; 4]> = kind.iter().map(|k| one(*k)).collect();
        for _ in 0..BLURS {
            for axis in 0..2 {
                share = blurred(extent, &share, axis);
            }
        }
        let level = (0..n)
            .map(|i| {
                let [x, y] = extent.column(i);
                let near = |c: usize, n: usize| c.saturating_sub(3)..(c + 4).min(n);
                near(x, nx).all(|x| near(y, ny).all(|y| share[extent.index(x, y)][0] > 0.99))
            })
            .collect();
        Arc::new(Self {
            kind,
            low: extent.min_m().truncate().as_vec2(),
            size: [nx, ny],
            size_f: Vec2::new(nx as f32, ny as f32),
            next: [if nx > 1 { ny } else { 0 }, usize::from(ny > 1)],
            share,
            level,
            relief: GroundRelief::new(layout),
        })
    }

    /// Height of the ground below its kerbs, m.
    #[inline]
    pub fn base_m(&self, p: Vec2) -> f32 {
        self.relief.as_ref().map_or(0.0, |relief| relief.at(p))
    }

    /// Lowest height of the ground, m.
    pub fn lowest_m(&self) -> f32 {
        self.relief.as_ref().map_or(0.0, GroundRelief::lowest_m)
    }

    /// Packs the ground for the graphics card.
    pub fn pack(&self, out: &mut AppearanceData) {
        out.push(
            AppearanceSection::Share,
            self.share.as_flattened().iter().map(|v| v.to_bits()),
        );
        out.push(AppearanceSection::Level, self.level.iter().map(|l| u32::from(*l)));
        let relief = self.relief.iter().flat_map(GroundRelief::words);
        out.push(
            AppearanceSection::Relief,
            std::iter::once(u32::from(self.relief.is_some())).chain(relief),
        );
    }

    /// True if there is nothing but level road within a metre of a point.
    #[inline]
    pub fn is_level(&self, p: Vec2) -> bool {
        let q = ((p - self.low) * PER_M).clamp(Vec2::ZERO, self.size_f - 0.5);
        self.level[q.x as usize * self.size[1] + q.y as usize]
    }

    fn shares(&self, p: Vec2) -> [f32; 4] {
        let most = (self.size_f - 1.001).max(Vec2::ZERO);
        let q = ((p - self.low) * PER_M - 0.5).clamp(Vec2::ZERO, most);
        let c = q.map(floor);
        let f = q - c;
        let i = c.x as usize * self.size[1] + c.y as usize;
        let [right, up] = self.next;
        let (a, b) = (&self.share[i], &self.share[i + up]);
        let (c, d) = (&self.share[i + right], &self.share[i + right + up]);
        std::array::from_fn(|k| {
            let low = a[k] + (b[k] - a[k]) * f.y;
            let high = c[k] + (d[k] - c[k]) * f.y;
            low + (high - low) * f.x
        })
    }

    /// The ground at a point of the ego frame; beyond the grid its border continues. `anchor` is the same point in the
    /// frame in which textures are anchored.
    #[inline]
    pub fn at(&self, p: Vec2, anchor: Vec2) -> GroundAt {
        let share = self.shares(p);
        // A blurred edge crosses one half with a slope of 1 / (sigma sqrt(2 pi)).
        let inside_road_m = (share[0] - 0.5) * 1.23;
        let up = ramp(-0.008, -0.042, inside_road_m);
        let rest = (1.0 - share[0]).max(1e-3);
        let soft = share[3] / rest;
        let bumps = || 0.05 * value2(anchor * 0.35, 11) - 0.01;
        let height = if up > 0.0 {
            let verge = if soft > 0.02 { 0.06 + bumps() } else { 0.0 };
            let slow = ramp(0.0, -0.35, inside_road_m);
            up * KERB_M * (1.0 - soft) + soft * verge * slow
        } else {
            0.0
        };
        GroundAt {
            share,
            inside_road_m,
            height_m: self.base_m(p) + height,
        }
    }

    /// Where a ray meets the ground, m; the normal follows from [`Self::normal`].
    pub fn cast(&self, o: Vec3, d: Vec3, limit: f32, anchor: &impl Fn(Vec3) -> Vec3) -> Option<f32> {
        if let Some(relief) = &self.relief {
            let above = |t: f32| {
                let p = o + d * t;
                let over = p.z - relief.at(p.truncate());
                // Kerbs count where they can be seen.
                match over > HIGHEST_M || t > 60.0 {
                    true => over,
                    false => p.z - self.at(p.truncate(), anchor(p).truncate()).height_m,
                }
            };
            return relief.cast((o, d), limit, &above);
        }
        if d.z >= -1e-5 {
            return None;
        }
        let (t0, t1) = (((HIGHEST_M - o.z) / d.z).max(0.0), (-o.z / d.z).max(0.0));
        if t0 > limit {
            return None;
        }
        let span = (t1 - t0) * d.truncate().length();
        if t0 >= 60.0
            || span < 2.0 && self.is_level((o + d * t0).truncate()) && self.is_level((o + d * t1).truncate())
        {
            return (t1 < limit).then_some(t1);
        }
        let above = |t: f32| {
            let p = o + d * t;
            match self.is_level(p.truncate()) {
                true => p.z,
                false => p.z - self.at(p.truncate(), anchor(p).truncate()).height_m,
            }
        };
        // The height of a kerb cannot be seen from far away.
        let steps = ((t1 - t0) / 0.12).ceil().clamp(2.0, 14.0);
        let mut before = t0;
        for i in 1..steps as usize {
            let t = t0 + (t1 - t0) * i as f32 / steps;
            if above(t) <= 0.0 {
                let (mut out, mut within) = (before, t);
                for _ in 0..5 {
                    let middle = (out + within) * 0.5;
                    if above(middle) <= 0.0 {
                        within = middle;
                    } else {
                        out = middle;
                    }
                }
                return (within < limit).then_some(within);
            }
            before = t;
        }
        (t1 < limit).then_some(t1)
    }

    /// Normal of the ground.
    pub fn normal(&self, p: Vec3, anchor: &impl Fn(Vec3) -> Vec3) -> Vec3 {
        let slope = self.relief.as_ref().map_or(Vec2::ZERO, |r| r.slope(p.truncate()));
        if self.is_level(p.truncate()) {
            return (-slope).extend(1.0).normalize();
        }
        let h = 0.03;
        let height = |d: Vec3| {
            let q = (p + d).truncate();
            self.at(q, anchor(p + d).truncate()).height_m - self.base_m(q)
        };
        Vec3::new(
            height(-Vec3::X * h) - height(Vec3::X * h) - 2.0 * h * slope.x,
            height(-Vec3::Y * h) - height(Vec3::Y * h) - 2.0 * h * slope.y,
            2.0 * h,
        )
        .normalize()
    }
}

/// One pass of the kernel 1 2 1 along an axis, edges repeated.
fn blurred(extent: Extent, share: &[[f32; 4]], axis: usize) -> Vec<[f32; 4]> {
    let [nx, ny] = [extent.nx(), extent.ny()];
    let at = |x: usize, y: usize| share[extent.index(x, y)];
    (0..share.len())
        .map(|i| {
            let [x, y] = extent.column(i);
            let (a, b) = if axis == 0 {
                (at(x.saturating_sub(1), y), at((x + 1).min(nx - 1), y))
            } else {
                (at(x, y.saturating_sub(1)), at(x, (y + 1).min(ny - 1)))
            };
            let m = share[i];
            std::array::from_fn(|k| (a[k] + 2.0 * m[k] + b[k]) / 4.0)
        })
        .collect()
}
