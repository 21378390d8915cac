//! The lattice of a map: edge of its voxels, number of bins above one another, height of the lowest, and how far its labels
//! let the ground down. Whatever knows 0.4 m or 16 bins asks it.

use std::fmt;

/// Voxels that a map is made of. Lengths are kept in whole millimetres, so that lattices compare exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Lattice {
    voxel_mm: u16,
    bins: u8,
    bottom_mm: i32,
    lowered: u8,
}

impl Default for Lattice {
    fn default() -> Self {
        Self::OCC3D
    }
}

impl fmt::Display for Lattice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bins of {} m", self.bins, self.voxel_m())
    }
}

impl Lattice {
    /// The lattice of Occ3D-nuScenes, in which the networks work: 16 bins of 0.4 m from 1 m below the ego frame's ground,
    /// which lies two bins lower in its labels than it is.
    pub const OCC3D: Self = Self {
        voxel_mm: 400,
        bins: 16,
        bottom_mm: -1000,
        lowered: 2,
    };
    /// Most bins by which labels may let the ground down.
    pub const MAX_LOWERED: usize = 8;
    /// Most bins above one another.
    pub const MAX_BINS: usize = 64;
    /// Edge of voxels, m.
    pub const VOXEL_M: std::ops::RangeInclusive<f64> = 0.05..=2.0;
    /// Largest height of the lowest bin above or below the ego frame's ground, m.
    pub const FARTHEST_BOTTOM_M: f64 = 100.0;

    /// A lattice whose labels are where things are. Errors in one line on a number that is not finite or out of range.
    pub fn new(voxel_m: f64, bins: usize, bottom_m: f64) -> Result<Self, String> {
        let mm = (voxel_m * 1000.0).round();
        if !Self::VOXEL_M.contains(&voxel_m) || (mm - voxel_m * 1000.0).abs() > 1e-3 {
            let (least, most) = (Self::VOXEL_M.start(), Self::VOXEL_M.end());
            return Err(format!(
                "voxels of {voxel_m} m, expected {least} to {most} m in whole millimetres"
            ));
        }
        if !(1..=Self::MAX_BINS).contains(&bins) {
            return Err(format!(
                "{bins} bins above one another, expected 1 to {}",
                Self::MAX_BINS
            ));
        }
        const FARTHEST: f64 = Lattice::FARTHEST_BOTTOM_M;
        if !(-FARTHEST..=FARTHEST).contains(&bottom_m) {
            return Err(format!(
                "a lowest bin at {bottom_m} m, expected a height within {} m",
                Self::FARTHEST_BOTTOM_M
            ));
        }
        Ok(Self {
            voxel_mm: mm as u16,
            bins: bins as u8,
            bottom_mm: (bottom_m * 1000.0).round() as i32,
            lowered: 0,
        })
    }

    /// This lattice with labels that let the ground down by a number of bins. Errors in one line on more than
    /// [`MAX_LOWERED`](Self::MAX_LOWERED).
    pub fn lowered_by(self, bins: usize) -> Result<Self, String> {
        if bins > Self::MAX_LOWERED {
            let most = Self::MAX_LOWERED;
            return Err(format!("ground let down by {bins} bins, expected at most {most}"));
        }
        Ok(Self {
            lowered: bins as u8,
            ..self
        })
    }

    /// Edge of a voxel, m.
    #[inline]
    pub const fn voxel_m(&self) -> f64 {
        self.voxel_mm as f64 / 1000.0
    }

    /// Voxels in one metre: 2.5 for 0.4 m. Exact for edges such as 0.2, 0.25, 0.4 and 0.5 m, which are not all exact
    /// themselves.
    #[inline]
    pub const fn per_m(&self) -> f64 {
        1000.0 / self.voxel_mm as f64
    }

    /// Bins above one another.
    #[inline]
    pub const fn bins(&self) -> usize {
        self.bins as usize
    }

    /// Height of the lowest voxel's bottom in the ego frame, m.
    #[inline]
    pub const fn bottom_m(&self) -> f64 {
        self.bottom_mm as f64 / 1000.0
    }

    /// Height of the highest voxel's top in the ego frame, m.
    #[inline]
    pub const fn top_m(&self) -> f64 {
        (self.bottom_mm as f64 + self.bins as f64 * self.voxel_mm as f64) / 1000.0
    }

    /// Bins by which labels let the ground, and what stands on it, down: 2 in Occ3D-nuScenes, 0 where labels are where
    /// things are.
    #[inline]
    pub const fn lowered(&self) -> usize {
        self.lowered as usize
    }

    /// Height at which labels have the surface of ground at z = 0 of the ego frame, m: -0.6 in Occ3D.
    pub fn ground_top_m(&self) -> f64 {
        let bins = (self.ground_bin(0.0) + 1) as f64 * f64::from(self.voxel_mm);
        (f64::from(self.bottom_mm) + bins) / 1000.0
    }

    /// Bits of a column's word, one per bin.
    #[inline]
    pub const fn all_bins(&self) -> u64 {
        u64::MAX >> (64 - self.bins as u32)
    }

    /// Bin that holds a height of the ego frame, cut to the lattice; 0 for NaN.
    pub fn bin(&self, height_m: f64) -> usize {
        let z = (height_m - self.bottom_m()) * self.per_m();
        z.floor().clamp(0.0, (self.bins - 1) as f64) as usize
    }

    /// Bin that labels put ground of this height into: [`bin`](Self::bin), lowered.
    pub fn ground_bin(&self, height_m: f64) -> usize {
        self.bin(height_m).saturating_sub(self.lowered())
    }

    /// Lowest bin of what stands on ground in a bin, cut to the lattice: the ground's own where labels let it down, in Occ3D
    /// things take the place of the ground; the one above it where labels are where things are.
    pub fn foot_bin(&self, ground_bin: usize) -> usize {
        let above = usize::from(self.lowered() == 0);
        (ground_bin + above).min(self.bins() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_known_lattices_are_exact() {
        let a = Lattice::OCC3D;
        assert_eq!(
            (a.voxel_m(), a.per_m(), a.bottom_m(), a.top_m()),
            (0.4, 2.5, -1.0, 5.4)
        );
        assert_eq!((a.bin(0.0), a.ground_bin(0.0), a.bin(1e9)), (2, 0, 15));
        assert_eq!((a.bin(f64::NAN), a.bin(-1e9), a.all_bins()), (0, 0, 0xffff));
        let b = Lattice::new(0.2, 40, -5.0).expect("OpenOccupancy");
        assert_eq!((b.voxel_m(), b.per_m(), b.top_m()), (0.2, 5.0, 3.0));
        assert_eq!((b.bin(0.0), b.ground_bin(0.0)), (25, 25));
        assert_eq!((a.foot_bin(0), b.foot_bin(25), b.foot_bin(39)), (0, 26, 39));
        assert_eq!((a.ground_top_m(), b.ground_top_m()), (-0.6, 0.2));
        let high = Lattice::new(0.25, 64, -4.0).expect("as high as can be");
        assert_eq!((high.all_bins(), high.top_m()), (u64::MAX, 12.0));
    }

    #[test]
    fn what_is_no_lattice_is_refused_in_one_line() {
        for (voxel_m, bins, bottom_m) in [
            (0.0, 16, -1.0),
            (f64::NAN, 16, -1.0),
            (-0.4, 16, -1.0),
            (1e9, 16, -1.0),
            (1.0 / 3.0, 16, -1.0),
            (0.4, 0, -1.0),
            (0.4, 65, -1.0),
            (0.4, 1_000_000_000, -1.0),
            (0.4, 16, f64::NAN),
            (0.4, 16, f64::INFINITY),
            (0.4, 16, -101.0),
        ] {
            let problem = Lattice::new(voxel_m, bins, bottom_m).expect_err("no lattice");
            assert!(
                problem.lines().count() == 1 && problem.contains("expected"),
                "{problem}"
            );
        }
    }
}
