//! The height of the ground: one number per column of the map, metres above z = 0 of the ego frame.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::{Extent, Pose};

/// Height of the ground over the grid. Flat ground takes no memory; a snapshot copies a pointer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Relief {
    heights: Option<Heights>, // none is flat
}

#[derive(Clone, Debug, PartialEq)]
struct Heights {
    extent: Extent,
    m: Arc<Vec<f32>>, // [x][y]
}

impl Relief {
    /// Heights beyond this are refused, m.
    pub const LIMIT_M: f32 = 200.0;

    /// Ground at z = 0 everywhere.
    pub const FLAT: Self = Self { heights: None };

    /// From heights at the centres of the columns of a map, `[x][y]`, in m of the ego frame.
    /// Errors in one line on another count, a number that is not finite or one beyond [`LIMIT_M`](Self::LIMIT_M).
    pub fn from_heights(extent: Extent, heights_m: Vec<f32>) -> Result<Self, String> {
        if heights_m.len() != extent.columns() {
            return Err(format!(
                "relief: {} heights, expected {}",
                heights_m.len(),
                extent.columns()
            ));
        }
        if let Some(i) = heights_m
            .iter()
            .position(|h| h.is_nan() || h.abs() > Self::LIMIT_M)
        {
            let [x, y] = extent.column(i);
            return Err(format!(
                "relief: height {} in column ({x}, {y}), expected a number within {} m",
                heights_m[i],
                Self::LIMIT_M
            ));
        }
        let flat = heights_m.iter().all(|h| *h == 0.0);
        Ok(Self {
            heights: (!flat).then(|| Heights {
                extent,
                m: Arc::new(heights_m),
            }),
        })
    }

    /// A relief from a height at every point of the ground, m. Heights that are not finite count as 0; the others are
    /// clamped to the limit.
    pub fn from_fn(extent: Extent, height_m: impl Fn(DVec2) -> f64) -> Self {
        let heights = extent.all_columns().map(|[x, y]| {
            let p = extent.center(x, y, 0).truncate();
            let h = height_m(p) as f32;
            let h = if h.is_finite() { h } else { 0.0 };
            h.clamp(-Self::LIMIT_M, Self::LIMIT_M)
        });
        Self::from_heights(extent, heights.collect()).unwrap_or_default()
    }

    /// True if the ground is at z = 0 everywhere.
    pub fn is_flat(&self) -> bool {
        self.heights.is_none()
    }

    /// Heights at the centres of the columns, `[x][y]`, m; `None` if flat.
    pub fn heights_m(&self) -> Option<&[f32]> {
        self.heights.as_ref().map(|h| h.m.as_slice())
    }

    /// Which part of the ground it covers; `None` if flat.
    pub fn extent(&self) -> Option<Extent> {
        self.heights.as_ref().map(|h| h.extent)
    }

    /// The part of it that lies in another extent; where this one has no columns, the ground continues level.
    pub fn crop(&self, extent: Extent) -> Self {
        match &self.heights {
            Some(h) if h.extent != extent => Self::from_fn(extent, |p| self.height_m(p)),
            _ => self.clone(),
        }
    }

    /// These heights over another extent of the same size.
    pub(crate) fn relabelled(&self, extent: Extent) -> Self {
        Self {
            heights: self.heights.as_ref().map(|h| Heights {
                extent,
                m: h.m.clone(),
            }),
        }
    }

    /// Takes over the heights of another relief wherever both have columns. The extents are those of the layouts: a flat
    /// relief has none of its own.
    pub fn paste(&mut self, extent: Extent, other: &Self, of: Extent) {
        if self.is_flat() && other.is_flat() {
            return;
        }
        let all = |relief: &Self, extent: Extent| match relief.heights_m() {
            Some(heights) => heights.to_vec(),
            None => vec![0.0; extent.columns()],
        };
        let mut heights = all(self, extent);
        extent.paste(&mut heights, &of, &all(other, of));
        *self = Self::from_heights(extent, heights).unwrap_or_default();
    }

    /// Width of a column, m; that of Occ3D where the ground is flat.
    fn column_m_wide(&self) -> f64 {
        self.extent().unwrap_or_default().voxel_m()
    }

    /// True if both hold their heights in the same memory, or both are flat.
    pub fn shares(&self, other: &Self) -> bool {
        match (&self.heights, &other.heights) {
            (Some(a), Some(b)) => Arc::ptr_eq(&a.m, &b.m),
            (a, b) => a.is_none() && b.is_none(),
        }
    }

    /// Height at the centre of a column, m. Panics outside the grid.
    pub fn column_m(&self, x: usize, y: usize) -> f64 {
        match &self.heights {
            Some(h) => f64::from(h.m[h.extent.index(x, y)]),
            None => 0.0,
        }
    }

    /// Sets the height of one column of a map, m; the caller keeps it finite and within the limit.
    pub fn set(&mut self, extent: Extent, x: usize, y: usize, height_m: f32) {
        if self.is_flat() && height_m == 0.0 {
            return;
        }
        let heights = self.heights.get_or_insert_with(|| Heights {
            extent,
            m: Arc::new(vec![0.0; extent.columns()]),
        });
        Arc::make_mut(&mut heights.m)[extent.index(x, y)] = height_m;
    }

    /// Height at a point of the ego frame, m: bilinear between column centres, continued level outside the grid; 0 for NaN.
    pub fn height_m(&self, p: DVec2) -> f64 {
        let Some(Heights { extent, m }) = &self.heights else {
            return 0.0;
        };
        let u = extent.to_voxel_units(p.extend(0.0)).truncate() - DVec2::splat(0.5);
        if u.is_nan() {
            return 0.0;
        }
        let last = [extent.nx() - 1, extent.ny() - 1];
        let (x, y) = (u.x.clamp(0.0, last[0] as f64), u.y.clamp(0.0, last[1] as f64));
        let (x0, y0) = (
            (x as usize).min(last[0].saturating_sub(1)),
            (y as usize).min(last[1].saturating_sub(1)),
        );
        let (tx, ty) = (x - x0 as f64, y - y0 as f64);
        // A map one column wide has no next one.
        let at = |i: usize, j: usize| f64::from(m[extent.index(i.min(last[0]), j.min(last[1]))]);
        let low = at(x0, y0) * (1.0 - tx) + at(x0 + 1, y0) * tx;
        let high = at(x0, y0 + 1) * (1.0 - tx) + at(x0 + 1, y0 + 1) * tx;
        low * (1.0 - ty) + high * ty
    }

    /// Distance along a ray at which it meets the ground, in lengths of `dir`, at most `limit` of them. `None` if it
    /// does not meet the ground, if it begins below it, and for NaN. Outside the grid the ground continues level.
    pub fn met_by(&self, origin: DVec3, dir: DVec3, limit: f64) -> Option<f64> {
        if self.is_flat() {
            let t = -origin.z / dir.z;
            return (t >= 0.0 && t <= limit).then_some(t);
        }
        let above_m = |t: f64| {
            let p = origin + dir * t;
            p.z - self.height_m(p.truncate())
        };
        let unit = 1.0 / dir.length();
        let mut gap_m = above_m(0.0);
        if !(gap_m >= 0.0 && unit.is_finite() && limit.is_finite()) {
            return None;
        }
        let mut t = 0.0;
        while t < limit {
            // A step of half the height above the ground: within a voxel no ground rises more steeply than a wall, and
            // a wall is met.
            let next = (t + unit * (gap_m / 2.0).max(self.column_m_wide() / 2.0)).min(limit);
            gap_m = above_m(next);
            if gap_m < 0.0 {
                let (mut near, mut far) = (t, next);
                for _ in 0..20 {
                    let middle = (near + far) / 2.0;
                    if above_m(middle) < 0.0 {
                        far = middle;
                    } else {
                        near = middle;
                    }
                }
                return Some(near);
            }
            t = next;
        }
        None
    }

    /// Upward unit normal of the ground at a point of the ego frame.
    pub fn normal(&self, p: DVec2) -> DVec3 {
        if self.is_flat() {
            return DVec3::Z;
        }
        let h = self.column_m_wide();
        let dx = self.height_m(p + DVec2::X * h) - self.height_m(p - DVec2::X * h);
        let dy = self.height_m(p + DVec2::Y * h) - self.height_m(p - DVec2::Y * h);
        DVec3::new(-dx, -dy, 2.0 * h).normalize_or(DVec3::Z)
    }

    /// Pose of a vehicle that stands on the ground at a point, its heading turned by `yaw_rad`: it pitches and rolls with
    /// the ground.
    pub fn pose_on(&self, p: DVec2, yaw_rad: f64) -> Pose {
        if self.is_flat() {
            return Pose::planar(p.x, p.y, yaw_rad);
        }
        let up = self.normal(p);
        let ahead = DVec2::from_angle(yaw_rad).extend(0.0);
        let left = up.cross(ahead).normalize_or(DVec3::Y);
        let rotation = DQuat::from_mat3(&DMat3::from_cols(left.cross(up), left, up));
        Pose {
            rotation,
            translation_m: p.extend(self.height_m(p)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lattice;

    #[test]
    fn rays_meet_the_ground_where_it_is() {
        let origin = DVec3::new(0.0, 0.0, 1.5);
        let down = DVec3::new(1.0, 0.0, -0.1);
        assert_eq!(Relief::FLAT.met_by(origin, down, 100.0), Some(15.0));
        assert_eq!(Relief::FLAT.met_by(origin, down, 10.0), None);
        assert_eq!(Relief::FLAT.met_by(origin, DVec3::X, 100.0), None);
        // On a grade of 5 % it is met at 1.5 = (0.1 + 0.05) t.
        let grade = Relief::from_fn(Extent::WINDOW, |p| 0.05 * p.x);
        let t = grade.met_by(origin, down, 100.0).expect("ground ahead");
        assert!((t - 10.0).abs() < 1e-3, "{t}");
        assert_eq!(
            grade.met_by(DVec3::new(10.0, 0.0, 0.2), down, 100.0),
            None,
            "it begins below"
        );
        for bad in [f64::NAN, f64::INFINITY, 0.0] {
            assert_eq!(grade.met_by(origin, DVec3::splat(bad), 100.0), None);
        }
        // A wall 3 m high, a column thick, is not jumped over.
        let wall = Relief::from_fn(Extent::WINDOW, |p| {
            if (20.0..20.5).contains(&p.x) { 3.0 } else { 0.01 }
        });
        let t = wall
            .met_by(origin, DVec3::new(1.0, 0.0, -0.01), 100.0)
            .expect("a wall");
        assert!((19.0..20.6).contains(&t), "{t}");
    }

    #[test]
    fn a_slope_is_read_back_between_and_beyond_the_columns() {
        let relief = Relief::from_fn(Extent::WINDOW, |p| 0.05 * p.x - 0.02 * p.y);
        for p in [DVec2::ZERO, DVec2::new(12.34, -7.0), DVec2::new(-39.7, 39.7)] {
            assert!(
                (relief.height_m(p) - (0.05 * p.x - 0.02 * p.y)).abs() < 1e-5,
                "{p}"
            );
        }
        let edge = relief.height_m(DVec2::new(39.8, 0.0));
        assert!((relief.height_m(DVec2::new(500.0, 0.0)) - edge).abs() < 1e-6);
        assert_eq!(relief.height_m(DVec2::NAN), 0.0);
        let n = relief.normal(DVec2::ZERO);
        assert!(
            (n - DVec3::new(-0.05, 0.02, 1.0).normalize()).length() < 1e-5,
            "{n}"
        );
        let pose = relief.pose_on(DVec2::new(4.0, 1.0), 0.3);
        assert!((pose.apply(DVec3::Z) - pose.translation_m - n).length() < 1e-5);
        let ahead = pose.apply(DVec3::X) - pose.translation_m;
        assert!((ahead.y.atan2(ahead.x) - 0.3).abs() < 1e-2, "{ahead}");
    }

    #[test]
    fn flat_ground_is_free_and_bad_heights_are_refused() {
        assert!(
            Relief::from_heights(Extent::WINDOW, vec![0.0; Extent::WINDOW.columns()])
                .expect("sound")
                .is_flat()
        );
        assert!(Relief::from_heights(Extent::WINDOW, vec![0.0; 7]).is_err());
        let mut heights = vec![0.0; Extent::WINDOW.columns()];
        heights[9] = f32::NAN;
        assert!(Relief::from_heights(Extent::WINDOW, heights.clone()).is_err());
        heights[9] = 1e6;
        let error = Relief::from_heights(Extent::WINDOW, heights).expect_err("too high");
        assert!(error.contains("column (0, 9)"), "{error}");
        assert!(Relief::from_fn(Extent::WINDOW, |_| f64::NAN).is_flat());
    }

    #[test]
    fn the_ego_road_is_in_bin_0_and_a_rise_climbs() {
        assert_eq!(Lattice::OCC3D.ground_bin(0.0), 0);
        assert_eq!(Lattice::OCC3D.ground_bin(0.45), 1);
        assert_eq!(Lattice::OCC3D.ground_bin(2.0), 5);
        assert_eq!(Lattice::OCC3D.ground_bin(-30.0), 0);
        assert_eq!(Lattice::OCC3D.ground_bin(90.0), 13);
    }
}
