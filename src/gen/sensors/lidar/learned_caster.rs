//! A learned sweep that is kept: after an edit the field is updated around it, and only rays that sample there are shot
//! again. The result equals a fresh sweep, ray by ray.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::lidar::learned::{self, Centred, Drops, SEEN};
use crate::lidar::surroundings::{Height, SurroundingHits};
use crate::lidar::{EgoBox, Rays};
use nets::ModelError;
use nets::lidar::field::{LidarRay, RaySampling, SignedDistanceField};
use nets::lidar::update::{Changed, Region};
use nets::lidar::{LearnedRay, LidarNet};
use scene::moved::ColumnShift;
use scene::{Lattice, LidarPattern, LidarSweep, SensorRig, VoxelGrid};

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
    rays: Vec<LidarRay>,
    pattern: LidarPattern,
    shape: Rays,
    around: SurroundingHits,
    field: SignedDistanceField,
    answers: Vec<LearnedRay>,
    shot: Vec<u32>, // rays of the last update, rising
    /// Where the vehicle is on the map, by whole columns.
    from_map: ColumnShift,
}

/// Work of the last update, and the places where some of its rays were sampled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sampled {
    /// Rays shot by the last update.
    pub rays: usize,
    /// All rays.
    pub of: usize,
    /// Pieces of some of those rays in which samples were taken: both ends, ego frame, m.
    pub segments: Vec<[DVec3; 2]>,
    /// Share of the way of those rays, up to what they met, that these pieces make up; 0 without any.
    pub share: f64,
}

impl LearnedCaster {
    /// Shoots every ray of a pattern on a vehicle that drives at `velocity_mps`, without the voxels of
    /// the vehicle itself. Errors if the network's numbers are not finite.
    pub fn new(
        net: Arc<LidarNet>,
        grid: &VoxelGrid,
        pattern: &LidarPattern,
        velocity_mps: DVec3,
        exclude: Option<EgoBox>,
    ) -> Result<Self, ModelError> {
        let field = learned::field(&net, grid, exclude)?;
        let shape = Rays::new(pattern, velocity_mps);
        let rays = learned::rays_of(pattern, &shape);
        let answers = net.shoot(&field, &rays, RaySampling::Prior)?;
        Ok(Self {
            exclude,
            around: SurroundingHits::new(grid, SEEN, pattern, &shape, exclude, Height::Physical),
            pattern: pattern.clone(),
            shape,
            shot: (0..rays.len() as u32).collect(),
            net,
            rays,
            field,
            answers,
            from_map: ColumnShift::default(),
        })
    }

    /// The first LiDAR of a rig on its moving vehicle; `None` if it has none.
    pub fn of_rig(net: Arc<LidarNet>, grid: &VoxelGrid, rig: &SensorRig) -> Result<Option<Self>, ModelError> {
        let centred = Centred::new(rig);
        let (rig, grid) = (&*centred.rig, &centred.grid(grid));
        let Some(pattern) = rig.lidars.first() else {
            return Ok(None);
        };
        let caster = Self::new(net, grid, pattern, rig.velocity_mps(), Some(EgoBox::of_rig(rig)))?;
        Ok(Some(Self {
            from_map: centred.from_map,
            ..caster
        }))
    }

    /// Brings the sweep up to date with `grid`. Errors if the network's numbers are not finite; the sweep is that of the
    /// last grid then.
    pub fn update(&mut self, grid: &VoxelGrid) -> Result<(), ModelError> {
        let grid = &self.from_map.grid(grid);
        let seen = learned::seen(grid, self.exclude);
        self.shot = match self.net.update(&mut self.field, &seen)? {
            Changed::Everywhere => {
                self.answers = self.net.shoot(&self.field, &self.rays, RaySampling::Prior)?;
                (0..self.rays.len() as u32).collect()
            }
            Changed::In(regions) => self.shoot_again(&regions)?,
        };
        self.around.update(grid, SEEN, &self.pattern, &self.shape);
        Ok(())
    }

    fn shoot_again(&mut self, regions: &[Region]) -> Result<Vec<u32>, ModelError> {
        if regions.is_empty() {
            return Ok(Vec::new());
        }
        let boxes: Vec<[DVec3; 2]> = regions.iter().map(reached).collect();
        let rays = self.rays.par_iter().zip(&self.answers).with_min_len(CHUNK);
        let touched = rays.enumerate().filter(|(_, (ray, answer))| {
            let reach = f64::from(answer.met.reach_m) / Lattice::OCC3D.voxel_m() + MARGIN;
            boxes.iter().any(|b| meets(ray, b, reach))
        });
        let again: Vec<usize> = touched.map(|(i, _)| i).collect();
        let rays: Vec<LidarRay> = again.iter().map(|i| self.rays[*i]).collect();
        let answers = self.net.shoot(&self.field, &rays, RaySampling::Prior)?;
        for (i, answer) in again.iter().zip(answers) {
            self.answers[*i] = answer;
        }
        Ok(again.into_iter().map(|i| i as u32).collect())
    }

    /// The points, beam-major.
    pub fn sweep(&self, drops: Drops) -> LidarSweep {
        let columns = self.pattern.columns_in_sector();
        let around = Some(&self.around);
        learned::points(&self.rays, &self.answers, columns, drops, around, self.back_m())
    }

    /// The way back onto the map, m.
    fn back_m(&self) -> DVec3 {
        self.from_map.back().way_m().extend(0.0)
    }

    /// Rays that the last update shot.
    pub fn shot_last(&self) -> usize {
        self.shot.len()
    }

    /// Work of the last update, with the places where up to `most` of its rays, spread evenly, were sampled.
    pub fn sampled(&self, most: usize) -> Sampled {
        let step = self.shot.len().div_ceil(most.max(1)).max(1);
        let (mut segments, mut sampled_m, mut way_m) = (Vec::new(), 0.0, 0.0);
        for &i in self.shot.iter().step_by(step) {
            let (ray, reach_m) = (
                &self.rays[i as usize],
                f64::from(self.answers[i as usize].met.reach_m),
            );
            // NaN for a ray whose result is not known.
            if reach_m.is_nan() || reach_m <= ray.range_m[0] {
                continue;
            }
            way_m += reach_m - ray.range_m[0];
            let at = |t_m: f64| ray.origin + ray.direction * t_m + self.back_m();
            let mut run: Option<[f64; 2]> = None;
            let walk = self
                .field
                .cells
                .walk(ray.origin, ray.direction, [ray.range_m[0], reach_m]);
            for piece in walk {
                run = match run {
                    Some([from_m, _]) if !piece.begins_run => Some([from_m, piece.to_m]),
                    before => {
                        segments.extend(before.map(|run| run.map(at)));
                        Some([piece.from_m, piece.to_m])
                    }
                };
                sampled_m += piece.to_m - piece.from_m;
            }
            segments.extend(run.map(|run| run.map(at)));
        }
        Sampled {
            rays: self.shot.len(),
            of: self.rays.len(),
            segments,
            share: if way_m > 0.0 { sampled_m / way_m } else { 0.0 },
        }
    }
}

/// Corners of the box of all points that the voxels of a region influence, voxel units.
fn reached(region: &Region) -> [DVec3; 2] {
    let corner = |xy: [usize; 2], z: usize, by: f64| DVec3::new(xy[0] as f64, xy[1] as f64, z as f64) + by;
    [
        corner(region.low, 0, -HALO - MARGIN),
        corner(region.high, Lattice::OCC3D.bins(), HALO + MARGIN),
    ]
}

/// True if a ray comes into a box at most `reach` voxels from its origin. Also true for a ray whose result is not known
/// (NaN): it is shot again to no effect.
fn meets(ray: &LidarRay, [low, high]: &[DVec3; 2], reach: f64) -> bool {
    let o = SEEN.to_voxel_units(ray.origin);
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
    use crate::lidar::surroundings::is_own;
    use scene::Class;
    use world::World;
    use world::draw::Draw;
    use world::voxelize::{Vertical, complete};

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
        let (mut least, rays, mut looked) = (usize::MAX, kept.rays.len(), false);
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
            // Samples lie on the rays, up to what those met, and most of the way there is nothing to look at.
            let sampled = kept.sampled(200);
            assert_eq!((sampled.rays, sampled.of), (kept.shot_last(), rays));
            if sampled.rays > 0 {
                assert!((0.0..=1.0).contains(&sampled.share), "{sampled:?}");
                looked |= !sampled.segments.is_empty() && sampled.share < 0.9;
                let far_m = |p: &DVec3| p.distance(kept.rays[0].origin);
                assert!(sampled.segments.iter().flatten().all(|p| far_m(p) < 80.0));
            }
            let fresh = LearnedCaster::of_rig(net.clone(), &grid, &rig)
                .expect("finite")
                .expect("a LiDAR");
            assert_eq!(kept.answers, fresh.answers, "edit {i} at {x0}, {y0}");
            assert_eq!(kept.sweep(Drops::Likely), fresh.sweep(Drops::Likely));
        }
        assert!(looked && least < rays / 3, "{least} of {rays}");
        kept.update(&grid).expect("finite");
        assert_eq!(kept.shot_last(), 0, "nothing changed");
        kept.update(&VoxelGrid::new()).expect("finite");
        let nothing = kept.sweep(Drops::Keep);
        assert!(nothing.points.iter().all(is_own) && kept.shot_last() == rays);
    }
}
