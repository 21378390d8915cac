//! Observations of a labelling drive: voxels that its rays went through, and voxels that cameras see.

use glam::DVec3;
use rayon::prelude::*;

use scene::{Camera, Class, Optics, Pose, SensorRig, VoxelGrid, Window};

/// Voxels that rays went through before they ended; one bit each.
#[derive(Clone, Default)]
pub(super) struct Passed(Vec<u64>);

impl Passed {
    /// Marks the voxels between two points, without the last one.
    pub(super) fn walk(&mut self, from: DVec3, to: DVec3) {
        let mut last = None;
        voxels_between(from, to, |voxel| {
            if let Some(before) = last.replace(voxel) {
                self.mark(before);
            }
            true
        });
    }

    fn mark(&mut self, voxel: usize) {
        if self.0.is_empty() {
            self.0 = vec![0; Window::VOXELS.div_ceil(64)];
        }
        self.0[voxel / 64] |= 1 << (voxel % 64);
    }

    /// Adds the voxels that another sweep went through.
    pub(super) fn join(&mut self, other: &Self) {
        self.0.resize(self.0.len().max(other.0.len()), 0);
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a |= b);
    }

    /// True if a ray went through this voxel, `(x * NY + y) * NZ + z`.
    pub(super) fn has(&self, voxel: usize) -> bool {
        self.0
            .get(voxel / 64)
            .is_some_and(|word| word >> (voxel % 64) & 1 == 1)
    }
}

/// Calls `visit` with the index of each voxel of the grid along a segment, in order, until it returns false.
fn voxels_between(from: DVec3, to: DVec3, mut visit: impl FnMut(usize) -> bool) {
    let (a, b) = (Window::to_voxel_units(from), Window::to_voxel_units(to));
    let d = b - a;
    let inverse = d.recip();
    let size = DVec3::new(Window::NX as f64, Window::NY as f64, Window::NZ as f64);
    // The part of the segment inside the grid.
    let (near, far) = ((-a) * inverse, (size - a) * inverse);
    let mut range = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        if d[axis] != 0.0 {
            range.0 = range.0.max(near[axis].min(far[axis]));
            range.1 = range.1.min(near[axis].max(far[axis]));
        } else if a[axis] < 0.0 || a[axis] >= size[axis] {
            return;
        }
    }
    if range.0 >= range.1 {
        return;
    }
    let start = a + d * range.0;
    let mut cell = [0_i64; 3];
    let mut next = DVec3::INFINITY;
    let bounds = [Window::NX as i64, Window::NY as i64, Window::NZ as i64];
    for axis in 0..3 {
        // On the upper face of the grid a ray that goes down enters the last voxel.
        cell[axis] = (start[axis].floor() as i64).clamp(0, bounds[axis] - 1);
        if d[axis] != 0.0 {
            let edge = cell[axis] + i64::from(d[axis] > 0.0);
            next[axis] = (edge as f64 - a[axis]) * inverse[axis];
        }
    }
    let step = inverse.abs();
    loop {
        let voxel = (cell[0] as usize * Window::NY + cell[1] as usize) * Window::NZ + cell[2] as usize;
        if !visit(voxel) {
            return;
        }
        let axis = (0..3).min_by(|i, j| next[*i].total_cmp(&next[*j])).unwrap_or(0);
        if next[axis] >= range.1 {
            return;
        }
        cell[axis] += if d[axis] > 0.0 { 1 } else { -1 };
        if !(0..bounds[axis]).contains(&cell[axis]) {
            return;
        }
        next[axis] += step[axis];
    }
}

/// The voxels that both the LiDAR observed and a camera sees: the middle of a side that faces the camera lies in its
/// picture and nothing is in front of it. (Occ3D's own masks see somewhat deeper into thin things.)
pub(super) fn seen_by_cameras(grid: &VoxelGrid, by_lidar: &[bool], rig: &SensorRig) -> Vec<bool> {
    let solid: Vec<bool> = grid.to_dense().iter().map(|l| *l != Class::FREE).collect();
    let views: Vec<MountedCamera<'_>> = rig.cameras.iter().map(MountedCamera::new).collect();
    let sees = |voxel: usize| {
        let column = voxel / Window::NZ;
        let center = Window::center(column / Window::NY, column % Window::NY, voxel % Window::NZ);
        views.iter().any(|view| {
            let towards = (view.at - center).signum() * Window::VOXEL_M * 0.501;
            let sides = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| center + axis * towards);
            sides.iter().any(|p| {
                let mut free = view.holds(*p);
                if free {
                    voxels_between(view.at, *p, |i| {
                        free = i == voxel || !solid[i];
                        free && i != voxel
                    });
                }
                free
            })
        })
    };
    let observed = by_lidar.par_iter().enumerate();
    observed.map(|(voxel, lidar)| *lidar && sees(voxel)).collect()
}

/// A camera at its mount.
struct MountedCamera<'a> {
    camera: &'a Camera,
    optics: Optics,
    camera_from_ego: Pose,
    at: DVec3,
}

impl<'a> MountedCamera<'a> {
    fn new(camera: &'a Camera) -> Self {
        let ego_from_camera = camera.ego_from_camera();
        Self {
            camera,
            optics: Optics::new(camera),
            camera_from_ego: ego_from_camera.inverse(),
            at: ego_from_camera.translation_m,
        }
    }

    /// True if a point of the ego frame lies in the picture.
    fn holds(&self, p: DVec3) -> bool {
        let q = self.camera_from_ego.apply(p);
        let (width, height) = (f64::from(self.camera.width), f64::from(self.camera.height));
        let inside = |p: glam::DVec2| (0.0..width).contains(&p.x) && (0.0..height).contains(&p.y);
        self.optics.project(q).is_some_and(inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;
    use crate::voxelize::{Drive, Vertical, labelled, labels};

    #[test]
    fn walks_are_unbroken_and_end_where_they_should() {
        let centers = [[3, 7, 2], [150, 30, 12], [3, 7, 9], [199, 199, 0], [0, 0, 15]];
        for a in centers {
            for b in centers {
                let at = |[x, y, z]: [usize; 3]| Window::center(x, y, z);
                let mut met = Vec::new();
                voxels_between(at(a), at(b), |i| {
                    met.push([
                        i / Window::NZ / Window::NY,
                        i / Window::NZ % Window::NY,
                        i % Window::NZ,
                    ]);
                    true
                });
                assert_eq!((met[0], met[met.len() - 1]), (a, b));
                let apart = |p: &[[usize; 3]]| (0..3).map(|k| p[0][k].abs_diff(p[1][k])).sum::<usize>();
                assert!(met.windows(2).all(|p| apart(p) == 1), "{a:?} {b:?}");
            }
        }
        // From far outside, through the grid, and past it.
        let count = |a: DVec3, b: DVec3| {
            let mut n = 0;
            voxels_between(a, b, |_| {
                n += 1;
                true
            });
            n
        };
        assert_eq!(
            count(DVec3::new(-100.0, 0.1, 1.1), DVec3::new(100.0, 0.1, 1.1)),
            Window::NX
        );
        assert_eq!(
            count(DVec3::new(-100.0, 50.0, 1.0), DVec3::new(100.0, 50.0, 1.0)),
            0
        );
        assert_eq!(count(DVec3::new(1.0, 1.0, 99.0), DVec3::new(1.0, 1.0, 98.0)), 0);
    }

    #[test]
    fn masks_are_those_of_a_drive() {
        let world = World::random(7);
        let rig = SensorRig::default();
        let found = labelled(&world, &rig, &Drive::default(), Vertical::Occ3d, 7);
        assert_eq!(
            found.grid,
            labels(&world, &rig.lidars[0], &Drive::default(), Vertical::Occ3d, 7)
        );
        let dense = found.grid.to_dense();
        let share = |mask: &[bool], free: bool| {
            let of = dense
                .iter()
                .zip(mask)
                .filter(|(l, _)| (**l == Class::FREE) == free);
            let (n, seen) = of.fold((0.0, 0.0), |(n, s), (_, m)| {
                (n + 1.0, s + f64::from(u8::from(*m)))
            });
            seen / n
        };
        // The one real frame whose masks are known has .92 and .59 of its occupied voxels: its cameras see deeper than the
        // first voxel on their way, ours do not.
        assert!((0.8..1.0).contains(&share(&found.by_lidar, false)));
        assert!((0.1..0.8).contains(&share(&found.by_camera, false)));
        assert!((0.02..0.5).contains(&share(&found.by_lidar, true)));
        assert!(found.by_camera.iter().zip(&found.by_lidar).all(|(c, l)| !c || *l));
        // Without cameras nothing is seen by them, and the LiDAR's observations are unchanged.
        let blind = SensorRig {
            cameras: Vec::new(),
            ..rig
        };
        let none = labelled(&world, &blind, &Drive::default(), Vertical::Occ3d, 7);
        assert!(!none.by_camera.contains(&true) && none.by_lidar == found.by_lidar);
    }
}
