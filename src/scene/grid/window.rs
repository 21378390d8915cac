//! The networks' window as constants: the frame of Occ3D.

use glam::DVec3;

use super::{Extent, Lattice};

/// Geometry of what the networks read and write: 200 x 200 x 16 voxels of 0.4 m in the ego frame. Code that works on
/// maps takes an [`Extent`] instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window;

impl Window {
    /// Voxels along x (forward).
    pub const NX: usize = 200;
    /// Voxels along y (left).
    pub const NY: usize = 200;
    /// Voxels along z (up).
    pub const NZ: usize = Lattice::OCC3D.bins();
    /// Edge of a voxel, m.
    pub const VOXEL_M: f64 = Lattice::OCC3D.voxel_m();
    /// Lower corner in the ego frame, m.
    pub const MIN_M: [f64; 3] = [-40.0, -40.0, Lattice::OCC3D.bottom_m()];
    /// Upper corner in the ego frame, m.
    pub const MAX_M: [f64; 3] = [40.0, 40.0, Lattice::OCC3D.top_m()];
    /// Voxels in all.
    pub const VOXELS: usize = Self::NX * Self::NY * Self::NZ;
    /// Columns in all.
    pub const COLUMNS: usize = Self::NX * Self::NY;

    /// See [`Extent::voxel_at`].
    #[inline]
    pub fn voxel_at(p_in_ego: DVec3) -> Option<[usize; 3]> {
        Extent::WINDOW.voxel_at(p_in_ego)
    }

    /// See [`Extent::column_at`].
    #[inline]
    pub fn column_at(x_m: f64, y_m: f64) -> Option<[usize; 2]> {
        Extent::WINDOW.column_at(x_m, y_m)
    }

    /// See [`Extent::to_voxel_units`].
    #[inline]
    pub fn to_voxel_units(p_in_ego: DVec3) -> DVec3 {
        Extent::WINDOW.to_voxel_units(p_in_ego)
    }

    /// See [`Extent::from_voxel_units`].
    #[inline]
    pub fn from_voxel_units(u: DVec3) -> DVec3 {
        Extent::WINDOW.from_voxel_units(u)
    }

    /// See [`Extent::center`].
    #[inline]
    pub fn center(x: usize, y: usize, z: usize) -> DVec3 {
        Extent::WINDOW.center(x, y, z)
    }
}

const _: () = {
    assert!(Window::NX == Extent::WINDOW.nx() && Window::NY == Extent::WINDOW.ny());
    assert!(Window::MIN_M[0] * 2.5 == Extent::WINDOW.from()[0] as f64);
};
