//! A learned sweep that is kept: after an edit the field is brought up to date around it, and only rays that sample
//! there are shot again. The result is that of a fresh sweep, ray by ray.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::learned::{self, Drops};
use super::lidar::EgoBox;
use crate::generation::model::ModelError;
use crate::generation::model::lidar::field::{Field, Ray, Sampling};
use crate::generation::model::lidar::update::{Changed, Region};
use crate::generation::model::lidar::{LearnedRay, LidarNet};
use crate::scene::{GridSpec, LidarPattern, LidarSweep, SensorRig, VoxelGrid};

/// A voxel's numbers reach half a voxel beyond it, as far as the neighbours' centres.
const HALO: f64 = 0.5;
/// Widens regions and reaches by far more than rounding of f32 positions, voxels.
const MARGIN: f64 = 1e-3;
/// Rays that are tested in a row.
const CHUNK: usize = 1024;

/// One LiDAR, the field that it saw last and what each ray met.
pub struct LearnedCaster {
    net: Arc<LidarNet>,
    exclude: Option<EgoBox>,
    rays: Vec<Ray>,
    columns: u32,
    field: Field,
    answers: Vec<LearnedRay>,
    shot: usize,
}

impl LearnedCaster {
    /// Shoots every ray of a pattern on a vehicle that drives straight ahead at `ego_speed_mps`, without the voxels of
    /// the vehicle itself. Errors if the network's numbers are not finite.
    pub fn new(
        net: Arc<LidarNet>,
        grid: &VoxelGrid,
        pattern: &LidarPattern,
        ego_speed_mps: f64,
        exclude: Option<EgoBox>,
    ) -> Result<Self, ModelError> {
        let field = learned::field(&net, grid, exclude)?;
        let rays = learned::rays(pattern, ego_speed_mps);
        let answers = net.shoot(&field, &rays, Sampling::Prior);
        Ok(Self {
            exclude,
            columns: pattern.columns_in_sector(),
            shot: rays.len(),
            net,
            rays,
            field,
            answers,
        })
    }

    /// The first LiDAR of a rig on its moving vehicle; `None` if it has none.
    pub fn of_rig(net: Arc<LidarNet>, grid: &VoxelGrid, rig: &SensorRig) -> Result<Option<Self>, ModelError> {
        let ego = Some(EgoBox::of_rig(rig));
        let new = |pattern| Self::new(net, grid, pattern, rig.ego_speed_mps, ego);
        rig.lidars.first().map(new).transpose()
    }

    /// Brings the sweep up to date with `grid`. Errors if the network's numbers are not finite; the sweep is that of the
    /// last grid then.
    pub fn update(&mut self, grid: &VoxelGrid) -> Result<(), ModelError> {
        let seen = learned::seen(grid, self.exclude);
        self.shot = match self.net.update(&mut self.field, &seen)? {
            Changed::Everywhere => {
                self.answers = self.net.shoot(&self.field, &self.rays, Sampling::Prior);
                self.rays.len()
            }
            Changed::In(regions) => self.shoot_again(&regions),
        };
        Ok(())
    }

    fn shoot_again(&mut self, regions: &[Region]) -> usize {
        if regions.is_empty() {
            return 0;
        }
        let boxes: Vec<[DVec3; 2]> = regions.iter().map(reached).collect();
        let rays = self.rays.par_iter().zip(&self.answers).with_min_len(CHUNK);
        let touched = rays.enumerate().filter(|(_, (ray, answer))| {
            let reach = f64::from(answer.met.reach_m) / GridSpec::VOXEL_M + MARGIN;
            boxes.iter().any(|b| meets(ray, b, reach))
        });
        let again: Vec<usize> = touched.map(|(i, _)| i).collect();
        let rays: Vec<Ray> = again.iter().map(|i| self.rays[*i]).collect();
        let answers = self.net.shoot(&self.field, &rays, Sampling::Prior);
        for (i, answer) in again.iter().zip(answers) {
            self.answers[*i] = answer;
        }
        again.len()
    }

    /// The points, beam-major.
    pub fn sweep(&self, drops: Drops) -> LidarSweep {
        learned::points(&self.rays, &self.answers, self.columns, drops)
    }

    /// Rays that the last update shot.
    pub fn shot_last(&self) -> usize {
        self.shot
    }
}

/// Corners of all points that the voxels of a region have a say in, voxel units.
fn reached(region: &Region) -> [DVec3; 2] {
    let corner = |xy: [usize; 2], z: usize, by: f64| DVec3::new(xy[0] as f64, xy[1] as f64, z as f64) + by;
    [
        corner(region.low, 0, -HALO - MARGIN),
        corner(region.high, GridSpec::NZ, HALO + MARGIN),
    ]
}

/// True if a ray comes into a box at most `reach` voxels from its origin. Also for a ray of which nothing is known
/// (NaN): it is shot again to no effect.
fn meets(ray: &Ray, [low, high]: &[DVec3; 2], reach: f64) -> bool {
    let o = GridSpec::to_voxel_units(ray.origin);
    let inverse = ray
        .direction
        .to_array()
        .map(|d| if d == 0.0 { 1e300 } else { 1.0 / d });
    let inverse = DVec3::from_array(inverse);
    let (a, b) = ((*low - o) * inverse, (*high - o) * inverse);
    let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element().min(reach));
    let beside = near > far;
    !beside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generation::world::World;
    use crate::generation::world::draw::Draw;
    use crate::generation::world::voxelize::{Vertical, complete};
    use crate::scene::Class;

    /// Boxes of voxels come and go at random places, one after another: each time every ray is that of a fresh sweep,
    /// and few were shot.
    #[test]
    fn a_kept_sweep_is_a_fresh_one() {
        let net = LidarNet::bundled().expect("the shipped weights");
        let mut rig = SensorRig::default();
        rig.lidars[0].columns = 360;
        rig.ego_speed_mps = 8.0;
        let mut grid = complete(&World::random(8), Vertical::Occ3d);
        let mut kept = LearnedCaster::of_rig(net.clone(), &grid, &rig)
            .expect("finite")
            .expect("a LiDAR");
        let mut draw = Draw::new(3, "edits");
        let (mut least, rays) = (usize::MAX, kept.rays.len());
        for i in 0..8 {
            let (x0, y0) = (draw.below(190), draw.below(194));
            let label = if i % 3 == 2 { Class::FREE } else { Class::Car.id() };
            for (x, y, z) in
                (x0..x0 + 9).flat_map(|x| (y0..y0 + 5).flat_map(move |y| (1..6).map(move |z| (x, y, z))))
            {
                grid.set(x, y, z, label);
            }
            kept.update(&grid).expect("finite");
            least = least.min(kept.shot_last());
            let fresh = LearnedCaster::of_rig(net.clone(), &grid, &rig)
                .expect("finite")
                .expect("a LiDAR");
            assert_eq!(kept.answers, fresh.answers, "edit {i} at {x0}, {y0}");
            assert_eq!(kept.sweep(Drops::Likely), fresh.sweep(Drops::Likely));
        }
        assert!(least < rays / 3, "{least} of {rays}");
        kept.update(&grid).expect("finite");
        assert_eq!(kept.shot_last(), 0, "nothing changed");
        kept.update(&VoxelGrid::new()).expect("finite");
        assert!(kept.sweep(Drops::Keep).points.is_empty() && kept.shot_last() == rays);
    }
}
