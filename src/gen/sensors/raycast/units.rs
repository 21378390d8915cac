//! Voxel units of one map with its corner computed once, for work that is done for every ray.

use glam::{DVec2, DVec3};
use scene::{Extent, Lattice};

/// Voxels in a metre.
const PER_M: f64 = Lattice::OCC3D.per_m();

/// Conversions between m and voxel units, bit for bit those of [`Extent`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Units {
    min_m: DVec3,
    /// Columns along x and y.
    size: DVec2,
    ny: usize,
}

impl Default for Units {
    fn default() -> Self {
        Self::from_extent(Extent::default())
    }
}

impl Units {
    /// The conversions of an extent.
    pub fn from_extent(extent: Extent) -> Self {
        Self {
            min_m: extent.min_m(),
            size: DVec2::new(extent.nx() as f64, extent.ny() as f64),
            ny: extent.ny(),
        }
    }

    /// See [`Extent::to_voxel_units`].
    #[inline]
    pub fn to_voxels(self, p_in_ego: DVec3) -> DVec3 {
        (p_in_ego - self.min_m) * PER_M
    }

    /// See [`Extent::from_voxel_units`].
    #[inline]
    pub fn to_ego(self, u: DVec3) -> DVec3 {
        u / PER_M + self.min_m
    }

    /// Place in arrays `[x][y]` of the column under a point of the ego frame; `None` outside or for NaN.
    #[inline]
    pub fn index_at(self, p: DVec2) -> Option<usize> {
        let u = (p - self.min_m.truncate()) * PER_M;
        let inside = u.cmpge(DVec2::ZERO).all() && u.cmplt(self.size).all();
        inside.then(|| u.x as usize * self.ny + u.y as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_those_of_the_extent() {
        for extent in [
            Extent::WINDOW,
            Extent::new([-151, -107], [480, 321]).expect("sound"),
        ] {
            let units = Units::from_extent(extent);
            for i in 0..20_000 {
                let p = DVec3::new(
                    f64::from(i % 211) * 1.03 - 90.1,
                    f64::from(i / 211) * 2.0 - 80.0,
                    0.3,
                );
                assert_eq!(units.to_voxels(p), extent.to_voxel_units(p));
                assert_eq!(units.to_ego(p), extent.from_voxel_units(p));
                let at = extent.column_at(p.x, p.y).map(|[x, y]| extent.index(x, y));
                assert_eq!(units.index_at(p.truncate()), at, "{p}");
            }
            assert_eq!(units.index_at(DVec2::new(f64::NAN, 0.0)), None);
            assert_eq!(units.index_at(DVec2::new(0.0, f64::INFINITY)), None);
        }
    }
}
