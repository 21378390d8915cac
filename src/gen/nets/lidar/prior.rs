//! Places along a ray where samples are worth their time: inside the cells between eight voxel centres of which at
//! least one is occupied, found by an exact walk (UniScene's prior-guided sampling, section 3.3, without its uniform
//! samples).

use glam::DVec3;

use super::sites::SiteLevel;
use scene::{Class, Window};

/// Cells along each axis: one more than voxels.
const N: [usize; 3] = [Window::NX + 1, Window::NY + 1, Window::NZ + 1];
/// Metres between samples where there are things.
pub const SPACING_M: f64 = 0.2;
/// Density of samples where there is only ground: it is smooth.
const GROUND_DENSITY: f64 = 0.4;
/// How far behind the beginning of a run its first sample lies, m.
const ENTRY_M: f64 = 1e-3;
/// A slower component does not move a ray.
const STILL: f64 = 1e-30;

/// Density of samples by cell.
#[derive(PartialEq)]
pub struct SampleDensity {
    density: Vec<u8>, // [x][y][z]: 0 nothing, 1 ground only, 2 things
}

/// A piece of a ray inside one active cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Start, m from the ray's origin.
    pub from_m: f64,
    /// End, m from the ray's origin.
    pub to_m: f64,
    /// Density of samples in it, 0 to 1.
    pub density: f64,
    /// True if the ray came out of inactive space.
    pub begins_run: bool,
}

/// The active segments of a ray. No closures: what is inlined into a function that is compiled for wide vectors must
/// be written out (see `kernels::vectorised`).
pub struct Walk<'a> {
    density: &'a [u8],
    place: usize,
    /// Steps to the next cell along each axis, wrapping, and the number of cells left.
    steps: [usize; 3],
    left: [usize; 3],
    next: [f64; 3],
    origin: [f64; 3],
    inverse: [f64; 3],
    plane: [f64; 3],
    t: f64,
    leave: f64,
    active_before: bool,
    over: bool,
}

impl Iterator for Walk<'_> {
    type Item = Segment;

    #[inline(always)]
    fn next(&mut self) -> Option<Segment> {
        // Ends: every turn takes one of `left`, or is the last.
        while !self.over {
            let next = self.next;
            let axis = if next[0] <= next[1] && next[0] <= next[2] {
                0
            } else if next[1] <= next[2] {
                1
            } else {
                2
            };
            let (from, end) = (self.t, next[axis].min(self.leave).max(self.t));
            let density = self.density[self.place];
            let begins_run = !self.active_before;
            self.active_before = density > 0;
            self.t = end;
            if next[axis] >= self.leave || self.left[axis] == 0 {
                self.over = true;
            } else {
                self.left[axis] -= 1;
                self.place = self.place.wrapping_add(self.steps[axis]);
                self.plane[axis] += if self.inverse[axis] > 0.0 { 1.0 } else { -1.0 };
                self.next[axis] = (self.plane[axis] - self.origin[axis]) * self.inverse[axis];
            }
            if density > 0 {
                return Some(Segment {
                    from_m: from * Window::VOXEL_M,
                    to_m: end * Window::VOXEL_M,
                    density: if density == 1 { GROUND_DENSITY } else { 1.0 },
                    begins_run,
                });
            }
        }
        None
    }
}

/// Sample positions along a ray, m.
pub struct Samples<'a> {
    walk: Walk<'a>,
    to_m: f64,
    density: f64,
    left: f64,
    due: f64,
}

impl Iterator for Samples<'_> {
    type Item = f32;

    #[inline(always)]
    fn next(&mut self) -> Option<f32> {
        loop {
            if self.due <= self.left {
                self.left -= self.due;
                self.due = SPACING_M;
                return Some((self.to_m - self.left / self.density) as f32);
            }
            self.due -= self.left;
            let segment = self.walk.next()?;
            (self.to_m, self.density, self.left) = (segment.to_m, segment.density, segment.mass());
            if segment.begins_run {
                self.due = SPACING_M;
                return Some((segment.from_m + ENTRY_M) as f32);
            }
        }
    }
}

impl Segment {
    fn mass(&self) -> f64 {
        (self.to_m - self.from_m) * self.density
    }
}

impl SampleDensity {
    /// The cells around these voxels of the grid.
    pub fn new(keys: &[u32], classes: &[u8]) -> Self {
        let mut density = vec![0u8; N[0] * N[1] * N[2]];
        for (key, class) in keys.iter().zip(classes) {
            let [x, y, z] = SiteLevel::place([Window::NX, Window::NY, Window::NZ], *key);
            let kind = if Class::from_id(*class).is_some_and(Class::is_ground) {
                1
            } else {
                2
            };
            for corner in 0..8 {
                let (x, y, z) = (x + corner / 4, y + corner / 2 % 2, z + corner % 2);
                let cell = &mut density[(x * N[1] + y) * N[2] + z];
                *cell = kind.max(*cell);
            }
        }
        Self { density }
    }

    /// True if one of the eight voxels around a cell is occupied.
    #[inline(always)]
    pub fn is_active(&self, [x, y, z]: [usize; 3]) -> bool {
        self.density[(x * N[1] + y) * N[2] + z] > 0
    }

    /// The active segments of a ray between `near_m` and `far_m`, in order. There are none if an input is NaN or the
    /// direction zero.
    #[inline(always)]
    pub fn walk(&self, origin_in_ego: DVec3, direction: DVec3, [near_m, far_m]: [f64; 2]) -> Walk<'_> {
        let unit = Window::VOXEL_M;
        let o = Window::to_voxel_units(origin_in_ego) + 0.5;
        let inverse = |d: f64| if d.abs() < STILL { f64::INFINITY } else { 1.0 / d };
        let inv = DVec3::new(inverse(direction.x), inverse(direction.y), inverse(direction.z));
        let mut walk = Walk {
            density: &self.density,
            place: 0,
            steps: [0; 3],
            left: [0; 3],
            next: [f64::INFINITY; 3],
            origin: o.to_array(),
            inverse: inv.to_array(),
            plane: [0.0; 3],
            t: 0.0,
            leave: 0.0,
            active_before: false,
            over: true,
        };
        let (mut enter, mut leave) = (near_m / unit, far_m / unit);
        if !o.is_finite() || !direction.is_finite() || enter.is_nan() || leave.is_nan() {
            return walk;
        }
        for axis in 0..3 {
            let n = N[axis] as f64;
            if inv[axis].is_infinite() {
                if !(o[axis] >= 0.0 && o[axis] < n) {
                    return walk;
                }
                continue;
            }
            let (a, b) = ((0.0 - o[axis]) * inv[axis], (n - o[axis]) * inv[axis]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        // A direction of zero leaves `leave` at the far end: there is no ray. NaN is no ray either.
        let inside = enter < leave;
        if !inside || !leave.is_finite() || direction == DVec3::ZERO {
            return walk;
        }
        for (axis, stride) in [N[1] * N[2], N[2], 1].into_iter().enumerate() {
            let at = (o[axis] + direction[axis] * enter)
                .floor()
                .clamp(0.0, (N[axis] - 1) as f64);
            let forward = direction[axis] > 0.0;
            walk.place += at as usize * stride;
            walk.steps[axis] = if forward { stride } else { stride.wrapping_neg() };
            walk.left[axis] = if forward {
                N[axis] - 1 - at as usize
            } else {
                at as usize
            };
            if inv[axis].is_finite() {
                walk.plane[axis] = at + f64::from(u8::from(forward));
                walk.next[axis] = (walk.plane[axis] - o[axis]) * inv[axis];
            }
        }
        (walk.t, walk.leave, walk.over) = (enter, leave, false);
        walk
    }

    /// Sample positions (m) in rising order: where a run of active cells begins, then one per [`SPACING_M`] of density.
    #[inline(always)]
    pub fn samples(&self, origin_in_ego: DVec3, direction: DVec3, range_m: [f64; 2]) -> Samples<'_> {
        Samples {
            walk: self.walk(origin_in_ego, direction, range_m),
            to_m: 0.0,
            density: 1.0,
            left: 0.0,
            due: SPACING_M,
        }
    }

    /// `n` samples at equal shares of the ray's density, u = (i + 1/2) / n through the inverse of its distribution:
    /// sorted, inside active cells; none for a ray that meets no active cell.
    pub fn equal_shares(
        &self,
        origin_in_ego: DVec3,
        direction: DVec3,
        range_m: [f64; 2],
        n: usize,
    ) -> Vec<f32> {
        let segments: Vec<Segment> = self.walk(origin_in_ego, direction, range_m).collect();
        let total: f64 = segments.iter().map(Segment::mass).sum();
        let mut out = Vec::with_capacity(n);
        let some = total > 0.0; // not so for NaN
        if !some {
            return out;
        }
        let (mut at, mut before) = (0, 0.0);
        for i in 0..n {
            let wanted = (i as f64 + 0.5) / n as f64 * total;
            while at + 1 < segments.len() && before + segments[at].mass() < wanted {
                before += segments[at].mass();
                at += 1;
            }
            let s = &segments[at];
            let t = s.from_m + (wanted - before) / s.density;
            out.push(t.clamp(s.from_m, s.to_m) as f32);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(voxels: &[[usize; 3]]) -> SampleDensity {
        let mut keys: Vec<u32> = voxels
            .iter()
            .map(|[x, y, z]| ((x * 200 + y) * 16 + z) as u32)
            .collect();
        keys.sort_unstable();
        SampleDensity::new(&keys, &vec![Class::Car.id(); keys.len()])
    }

    /// Row 47 of the extremes table: empty, one voxel, full; one sample and ten thousand.
    #[test]
    fn row_47_prior() {
        let all: Vec<[usize; 3]> = (0..Window::VOXELS)
            .map(|k| [k / 3200, k / 16 % 200, k % 16])
            .collect();
        let (one, full) = ([[120usize, 100, 7]], all);
        let origin = DVec3::new(0.2, 0.2, 1.84);
        for (voxels, hit) in [(&[][..], false), (&one[..], true), (&full[..], true)] {
            let cells = cells(voxels);
            for n in [1, 2, 36, 10_000] {
                for direction in [DVec3::X, DVec3::new(1.0, 0.01, 0.02).normalize()] {
                    let found = cells.equal_shares(origin, direction, [1.0, 70.0], n);
                    assert_eq!(found.len(), if hit { n } else { 0 });
                    assert!(found.is_sorted() && found.iter().all(|t| t.is_finite()));
                    for t in found {
                        // Within one voxel of an occupied centre, along every axis.
                        let p = Window::to_voxel_units(origin + direction * f64::from(t)) - 0.5;
                        let near = voxels.len() > 1
                            || voxels.iter().any(|v| {
                                (p - DVec3::new(v[0] as f64, v[1] as f64, v[2] as f64))
                                    .abs()
                                    .max_element()
                                    <= 1.0 + 1e-5
                            });
                        assert!(near, "{t}");
                    }
                }
            }
        }
        let cells = cells(&one);
        for bad in [
            DVec3::ZERO,
            DVec3::splat(f64::NAN),
            DVec3::new(f64::INFINITY, 0.0, 0.0),
        ] {
            assert!(cells.equal_shares(origin, bad, [1.0, 70.0], 8).is_empty());
            assert!(cells.equal_shares(bad / 0.0, DVec3::X, [1.0, 70.0], 8).is_empty());
        }
    }

    /// The walk against testing the density at many points of each ray.
    #[test]
    fn the_walk_is_exact() {
        let voxels: Vec<[usize; 3]> = (0..600)
            .map(|i| [(i * 7919) % 200, (i * 104_729) % 200, (i * 31) % 16])
            .collect();
        let cells = cells(&voxels);
        for i in 0..300 {
            let (a, e) = (f64::from(i) * 0.021, (f64::from(i % 17) - 8.0) * 0.04);
            let direction = match i {
                0 => DVec3::Y,
                1 => -DVec3::X,
                _ => DVec3::new(a.cos() * e.cos(), a.sin() * e.cos(), e.sin()),
            };
            let origin = DVec3::new(0.3, -0.7, 1.84);
            let segments: Vec<Segment> = cells.walk(origin, direction, [0.0, 80.0]).collect();
            assert!(segments.windows(2).all(|w| w[0].to_m <= w[1].from_m + 1e-9));
            for k in 0..8000 {
                let t = f64::from(k) * 0.01 + 0.005;
                let q = (Window::to_voxel_units(origin + direction * t) + 0.5).floor();
                let inside = (0..3).all(|a| q[a] >= 0.0 && q[a] < N[a] as f64);
                let active =
                    inside && cells.density[(q.x as usize * N[1] + q.y as usize) * N[2] + q.z as usize] > 0;
                let found = segments.iter().any(|s| (s.from_m..s.to_m).contains(&t));
                let at_edge = segments
                    .iter()
                    .any(|s| (s.from_m - t).abs() < 1e-6 || (s.to_m - t).abs() < 1e-6);
                assert!(found == active || at_edge, "ray {i} at {t}");
            }
        }
    }

    #[test]
    fn samples_begin_each_run_and_are_spaced() {
        let cells = cells(&[[110, 100, 7], [130, 100, 7], [131, 100, 7]]);
        // Along the row of centres: the first voxel's cells reach from 3.8 to 4.6 m, the others' from 11.8 to 13 m.
        let origin = DVec3::new(0.0, 0.2, 2.0);
        let found: Vec<f32> = cells.samples(origin, DVec3::X, [1.0, 60.0]).collect();
        let first = found.partition_point(|t| *t < 8.0);
        for (run, [from, to]) in [(&found[..first], [3.8f32, 4.6]), (&found[first..], [11.8, 13.0])] {
            assert!((run[0] - from - 0.001).abs() < 1e-4, "{found:?}");
            for (i, t) in run.iter().enumerate().skip(1) {
                assert!((t - from - 0.2 * i as f32).abs() < 1e-4, "{found:?}");
            }
            let last = run[run.len() - 1];
            assert!(last <= to + 1e-4 && last > to - 0.201, "{found:?}");
        }
    }
}
