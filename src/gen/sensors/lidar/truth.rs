//! Measurements of a real LiDAR in a procedural world: analytic surfaces, range noise, echo strength, lost echoes.
//! Targets: section 3 of `real_statistics.md` (three nuScenes sweeps, one of them labelled by class).

use glam::DVec3;
use rayon::prelude::*;

use crate::beyond::backdrop::Backdrop;
use crate::lidar::material::{Materials, PulseHit, gaussian, range_sigma_m};
use crate::lidar::own_body::{OwnBody, is_blind};
use crate::lidar::{EgoBox, direction_in_sensor};
use scene::solid::Solid;
use scene::{Class, LidarPattern, SensorRig};
use world::draw::{Draw, hash};
use world::{SurfacePoint, World};

/// Outcome of a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Echo {
    /// The pulse came back.
    Return = 0,
    /// It met a surface and was lost: too weak, mirrored away, passed through glass.
    Lost = 1,
    /// The own vehicle was in the way.
    OwnBody = 2,
    /// There was nothing within range.
    Nothing = 3,
}

/// One pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthRay {
    /// Measured distance to the surface, m, noise included, also of a lost echo; 0 if there is none.
    pub range_m: f32,
    /// Class of the surface; free if there is none.
    pub class: Class,
    /// Echo strength, 0 to 255.
    pub intensity: u8,
    /// Cosine of the angle between pulse and surface normal, 0 (grazing) to 1.
    pub cos_incidence: f32,
    /// Outcome of the pulse.
    pub echo: Echo,
    /// Measured distance to the own vehicle, m; 0 if it was not in the way, or if its echo came too early to be timed.
    pub own_body_m: f32,
}

/// Resolution of the range, m (HDL-32E).
pub const RANGE_STEP_M: f64 = 0.002;

/// One revolution through the world, beam-major, with the default vehicle under the sensor. The same arguments give the
/// same sweep on any number of threads.
pub fn sweep(world: &World, pattern: &LidarPattern, seed: u64) -> Vec<TruthRay> {
    let ego_from_sensor = pattern.ego_from_sensor();
    let origin = ego_from_sensor.translation_m;
    let sensor = WorldLidar {
        world,
        materials: Materials::new(world),
        backdrop: pattern.beyond_grid.then(|| Backdrop::of_world(world)),
        body: pattern
            .own_body
            .then(|| OwnBody::new(EgoBox::of_rig(&SensorRig::default()))),
        origin,
        max_range_m: pattern.max_range_m,
    };
    let beam = |(ring, elevation): (usize, &f64)| -> Vec<TruthRay> {
        let mut draw = Draw::new(hash(seed ^ hash(ring as u64)), "pulses");
        let column = |c| {
            let direction =
                ego_from_sensor.rotation * direction_in_sensor(*elevation, pattern.azimuth_rad(c));
            sensor.pulse(direction, &mut draw)
        };
        (0..pattern.columns).map(column).collect()
    };
    let beams: Vec<Vec<TruthRay>> = pattern.elevations_deg.par_iter().enumerate().map(beam).collect();
    beams.concat()
}

/// A LiDAR in a world.
struct WorldLidar<'a> {
    world: &'a World,
    materials: Materials<'a>,
    backdrop: Option<Backdrop>,
    body: Option<OwnBody>,
    origin: DVec3,
    max_range_m: f64,
}

impl WorldLidar<'_> {
    fn pulse(&self, direction: DVec3, draw: &mut Draw) -> TruthRay {
        // Every pulse takes the same number of draws, whatever it meets.
        let (range_noise, strength_noise, fate, detail) =
            (gaussian(draw), gaussian(draw), draw.unit(), draw.unit());
        let mut ray = TruthRay {
            range_m: 0.0,
            class: Class::Free,
            intensity: 0,
            cos_incidence: 0.0,
            echo: Echo::Nothing,
            own_body_m: 0.0,
        };
        let at = |range_m: f64| self.origin + direction * range_m;
        let stepped = |range_m: f64| ((range_m / RANGE_STEP_M).round() * RANGE_STEP_M) as f32;
        let mut answer = |class: Class, surface: &SurfacePoint, solid: Option<&Solid>, range_m: f64| {
            let cosine = surface.normal.dot(direction).abs().clamp(0.0, 1.0);
            let met = PulseHit {
                class,
                surface,
                solid,
                at: at(range_m),
                range_m,
                cosine,
            };
            let material = self.materials.of(&met, detail);
            let lost = self.materials.lost(&material, &met);
            ray = TruthRay {
                range_m: stepped(range_m + range_noise * range_sigma_m(class, range_m)),
                class,
                intensity: self.materials.strength(&material, cosine, strength_noise) as u8,
                cos_incidence: cosine as f32,
                echo: if fate < lost { Echo::Lost } else { Echo::Return },
                own_body_m: 0.0,
            };
        };
        if let Some(hit) = self.world.cast(self.origin, direction, self.max_range_m) {
            let solid = hit.solid.and_then(|i| self.world.solids().get(i as usize));
            let surface = self.world.surface(&hit, at(hit.range_m));
            answer(hit.class, &surface, solid, hit.range_m);
        } else if let Some(backdrop) = &self.backdrop
            && let Some(hit) = backdrop.cast(self.origin, direction, self.max_range_m)
        {
            // Beyond the grid: the town goes on.
            let surface = SurfacePoint {
                normal: hit.normal,
                instance: hit.instance,
                part: hit.part,
            };
            let solid = hit.solid.and_then(|i| backdrop.solid(i));
            answer(hit.class, &surface, solid, hit.range_m);
        }
        if let Some(body) = &self.body
            && let Some(range_m) = body.meets(self.origin, direction)
        {
            ray.echo = Echo::OwnBody;
            if !is_blind(range_m, fate) {
                ray.own_body_m = stepped(range_m + range_noise * range_sigma_m(Class::Others, range_m));
            }
        }
        ray
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_is_repeatable_and_its_surface_is_the_worlds() {
        let (world, pattern) = (World::random(7), &SensorRig::default().lidars[0]);
        let rays = sweep(&world, pattern, 3);
        assert_eq!(rays.len(), 32 * 1084);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let again = pool.expect("a pool").install(|| sweep(&world, pattern, 3));
            assert_eq!(rays, again, "{threads} threads");
        }
        let (pose, backdrop) = (pattern.ego_from_sensor(), Backdrop::of_world(&world));
        let mut surfaces = 0;
        for (i, ray) in rays.iter().enumerate().step_by(7) {
            let (ring, column) = (i / 1084, (i % 1084) as u32);
            let d = pose.rotation
                * direction_in_sensor(pattern.elevations_deg[ring], pattern.azimuth_rad(column));
            let hit = world.cast(pose.translation_m, d, pattern.max_range_m);
            let behind = backdrop.cast(pose.translation_m, d, pattern.max_range_m);
            let beyond = behind.map_or(Class::Free, |b| b.class);
            assert_eq!(hit.map_or(beyond, |h| h.class), ray.class);
            if let Some(hit) = hit {
                surfaces += 1;
                // Noise is bounded by 2 sqrt 3 of its spread.
                assert!((hit.range_m - f64::from(ray.range_m)).abs() < 0.25);
            }
        }
        assert!(surfaces > 1000);
    }
}
