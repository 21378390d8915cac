//! What a real LiDAR would measure of a procedural world: analytic surfaces, range noise, echo strength, lost echoes.
//! Targets: section 3 of `real_statistics.md` (three nuScenes sweeps, one of them labelled by class).

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::backdrop;
use super::lidar::direction_in_sensor;
use crate::generation::world::draw::{Draw, hash, noise};
use crate::generation::world::{Hit, Surface, World};
use crate::scene::solid::{Shape, Solid};
use crate::scene::{BevLayer, Class, GridSpec, LidarPattern};

/// What became of a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Echo {
    /// It came back.
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
    /// What became of it.
    pub echo: Echo,
}

/// Resolution of the range, m (HDL-32E).
pub const RANGE_STEP_M: f64 = 0.002;
/// Height of the sensor above the own roof, m.
const ABOVE_ROOF_M: f64 = 0.24;

/// True if the own roof blocks a direction of the ego frame. Its edge is nearest at the sides: ego hits of real sweeps
/// lie in the front sector and the two rear quarters, and their share by ring gives the spread of the edge.
pub fn meets_own_body(direction_in_ego: DVec3) -> bool {
    let flat = direction_in_ego.truncate().length();
    if direction_in_ego.z >= 0.0 {
        return false;
    }
    let at_roof_m = ABOVE_ROOF_M * flat / -direction_in_ego.z;
    let azimuth_rad = direction_in_ego.y.atan2(direction_in_ego.x);
    at_roof_m < 0.452 + 0.184 * (3.0 * azimuth_rad).cos()
}

/// One revolution through the world, beam-major. The same arguments give the same sweep on any number of threads.
pub fn sweep(world: &World, pattern: &LidarPattern, seed: u64) -> Vec<TruthRay> {
    let ego_from_sensor = pattern.ego_from_sensor();
    let origin = ego_from_sensor.translation_m;
    let materials = Materials::new(world);
    let beam = |(ring, elevation): (usize, &f64)| -> Vec<TruthRay> {
        let mut draw = Draw::new(hash(seed ^ hash(ring as u64)), "pulses");
        let column = |c| {
            let direction =
                ego_from_sensor.rotation * direction_in_sensor(*elevation, pattern.azimuth_rad(c));
            materials.pulse(origin, direction, pattern.max_range_m, &mut draw)
        };
        (0..pattern.columns).map(column).collect()
    };
    let beams: Vec<Vec<TruthRay>> = pattern.elevations_deg.par_iter().enumerate().map(beam).collect();
    beams.concat()
}

/// How a surface answers a pulse.
struct Material {
    /// Echo strength at normal incidence.
    strength: f64,
    /// Relative spread of single echoes.
    spread: f64,
    /// Share of echoes lost whatever the geometry.
    lost: f64,
}

/// Materials of one world.
struct Materials<'a> {
    world: &'a World,
    /// Darkness of this world's roads (wet, worn), in logarithms of the signal.
    road: f64,
}

impl<'a> Materials<'a> {
    fn new(world: &'a World) -> Self {
        let mut draw = Draw::new(world.seed(), "road surface");
        Self {
            world,
            road: 0.8 * gaussian(&mut draw),
        }
    }

    fn pulse(&self, origin: DVec3, direction: DVec3, max_range_m: f64, draw: &mut Draw) -> TruthRay {
        // Every pulse takes the same number of draws, whatever it meets.
        let (range_noise, strength_noise, fate, detail) =
            (gaussian(draw), gaussian(draw), draw.unit(), draw.unit());
        let mut ray = TruthRay {
            range_m: 0.0,
            class: Class::Free,
            intensity: 0,
            cos_incidence: 0.0,
            echo: Echo::Nothing,
        };
        let inside = self.world.cast(origin, direction, max_range_m).map(|hit| {
            let p = origin + direction * hit.range_m;
            (hit, self.world.surface(&hit, p), hit.solid.is_none())
        });
        // Beyond the grid: the town goes on.
        let beyond = || {
            backdrop::cast(self.world, origin, direction, max_range_m).map(|behind| {
                let hit = Hit {
                    range_m: behind.range_m,
                    class: behind.class,
                    solid: None,
                };
                let surface = Surface {
                    normal: behind.normal,
                    instance: behind.instance,
                    part: 0,
                };
                (hit, surface, behind.instance == 0)
            })
        };
        if let Some((hit, surface, is_ground)) = inside.or_else(beyond) {
            let p = origin + direction * hit.range_m;
            let cosine = surface.normal.dot(direction).abs().clamp(0.0, 1.0);
            let solid = hit.solid.and_then(|i| self.world.solids().get(i as usize));
            let material = self.material(hit.class, &surface, solid, p, hit.range_m, detail);
            let dark = if is_ground {
                let patch = noise(self.world.seed() ^ 0xda12, p.x / 3.0, p.y / 3.0);
                self.road + 1.4 * patch
            } else {
                0.5 * (material.strength.max(0.3) / 7.0).ln()
            };
            // Lambert's law and the square of the distance, in logarithms; the slope is that of real roads by ring.
            let signal = cosine.max(1e-3).ln() - 2.0 * (hit.range_m.max(1.0) / 10.0).ln() + dark;
            let weak = 1.0 / (1.0 + (0.6 * signal + 4.1).exp());
            let lost = material.lost + (1.0 - material.lost) * weak;
            let range = hit.range_m + range_noise * range_sigma_m(hit.class, hit.range_m);
            let strength =
                material.strength * (0.75 + 0.25 * cosine) * (material.spread * strength_noise).exp();
            ray = TruthRay {
                range_m: ((range / RANGE_STEP_M).round() * RANGE_STEP_M) as f32,
                class: hit.class,
                intensity: strength.clamp(0.0, 255.0) as u8,
                cos_incidence: cosine as f32,
                echo: if fate < lost { Echo::Lost } else { Echo::Return },
            };
        }
        if meets_own_body(direction) {
            ray.echo = Echo::OwnBody;
        }
        ray
    }

    fn material(
        &self,
        class: Class,
        surface: &Surface,
        solid: Option<&Solid>,
        p: DVec3,
        range_m: f64,
        detail: f64,
    ) -> Material {
        let seed = self.world.seed();
        let mut own = Draw::new(hash(seed ^ u64::from(surface.instance)), "paint");
        let (kind, tone) = (own.unit(), gaussian(&mut own));
        let of = |strength: f64, spread, lost| Material {
            strength,
            spread,
            lost,
        };
        let patch = noise(seed ^ 0x70ad, p.x / 1.5, p.y / 1.5);
        match class {
            Class::DriveableSurface => match self.is_painted(p.truncate()) && detail < 0.45 {
                true => of(26.0, 0.35, 0.004),
                false => of(7.0 * (0.4 * patch + 0.15 * self.road).exp(), 0.25, 0.004),
            },
            Class::Sidewalk => of(13.0 * (0.4 * patch).exp(), 0.25, 0.003),
            Class::OtherFlat => of(12.0 * (0.4 * patch).exp(), 0.25, 0.003),
            Class::Terrain => of(15.0 * (0.5 * patch).exp(), 0.3, 0.01),
            Class::Vegetation => of(11.0 + 16.0 * (range_m / 30.0).min(1.0), 0.32, 0.05),
            Class::Manmade if is_sign(solid) => of(170.0, 0.3, 0.01),
            Class::Manmade => {
                // Windows every three metres along and up a facade: mirrors at a slant, else half transparent.
                let along = p.x * surface.normal.y - p.y * surface.normal.x;
                let tall =
                    solid.is_some_and(|s| s.reach().z > 1.8 && s.reach().truncate().max_element() > 2.5);
                let window = (along / 3.0).rem_euclid(1.0) < 0.4 && (p.z / 3.0 - 0.3).rem_euclid(1.0) < 0.45;
                if tall && window && surface.normal.z.abs() < 0.3 {
                    of(4.0, 0.5, 0.3)
                } else {
                    of(15.0 * (0.8 * tone).exp(), 0.35, 0.015)
                }
            }
            Class::Car => {
                let paint = match kind {
                    k if k < 0.45 => 1.8,
                    k if k < 0.8 => 8.0,
                    _ => 28.0,
                };
                match surface.part {
                    // The cabin is mostly glass, but for the roof.
                    1 if surface.normal.z < 0.8 => of(1.2, 0.6, 0.4),
                    2.. => of(2.0, 0.4, 0.06),
                    _ if detail < 0.006 => of(150.0, 0.2, 0.0), // plates and reflectors
                    _ => of(paint, 0.35, 0.02),
                }
            }
            Class::Truck | Class::Bus | Class::Trailer | Class::ConstructionVehicle => of(
                27.0 * (0.25 * tone).exp(),
                0.25,
                if class == Class::Bus { 0.12 } else { 0.02 },
            ),
            Class::Pedestrian => of(20.0 * (0.5 * tone).exp(), 0.4, 0.05),
            Class::TrafficCone if detail < 0.2 => of(180.0, 0.2, 0.02), // its collar
            Class::TrafficCone => of(17.0, 0.5, 0.03),
            Class::Barrier => of(18.0 * (0.4 * tone).exp(), 0.3, 0.02),
            Class::Motorcycle | Class::Bicycle => of(12.0, 0.6, 0.06),
            Class::Others | Class::Free => of(14.0 * (0.5 * tone).exp(), 0.3, 0.02),
        }
    }

    fn is_painted(&self, p: DVec2) -> bool {
        let painted = BevLayer::PedCrossing.bit()
            | BevLayer::LaneDivider.bit()
            | BevLayer::RoadDivider.bit()
            | BevLayer::StopLine.bit();
        GridSpec::column_at(p.x, p.y)
            .is_some_and(|[x, y]| self.world.layout.cells()[x * GridSpec::NY + y] & painted != 0)
    }
}

/// A thin upright plate: retro-reflective.
fn is_sign(solid: Option<&Solid>) -> bool {
    solid.is_some_and(|s| matches!(s.shape, Shape::Hull { half, .. } if half.x < 0.06 && half.y < 0.4))
}

/// Standard deviation of the measured range by distance, from second differences along real rings.
fn range_sigma_m(class: Class, range_m: f64) -> f64 {
    let far = (range_m - 8.0).max(0.0);
    match class {
        Class::Manmade => 0.0045 + 6e-4 * far,
        _ => 0.0045 + 3e-4 * far,
    }
}

/// About normal: four uniform numbers; bounded, so that no draw is absurd.
fn gaussian(draw: &mut Draw) -> f64 {
    (draw.unit() + draw.unit() + draw.unit() + draw.unit() - 2.0) * 3f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SensorRig;

    fn quantile(values: &mut [f64], q: f64) -> f64 {
        values.sort_by(f64::total_cmp);
        values[((values.len() - 1) as f64 * q) as usize]
    }

    /// Shares, ranges and echo strengths inside what three real sweeps (and their accepted ranges) say.
    #[test]
    fn sweeps_are_like_real_ones() {
        let pattern = &SensorRig::default().lidars[0];
        let rays: Vec<TruthRay> = (40..52)
            .flat_map(|s| sweep(&World::random(s), pattern, s))
            .collect();
        let share = |test: &dyn Fn(&TruthRay) -> bool| {
            rays.iter().filter(|r| test(r)).count() as f64 / rays.len() as f64
        };
        let returned = |r: &TruthRay| r.echo == Echo::Return;
        let none = |r: &TruthRay| matches!(r.echo, Echo::Lost | Echo::Nothing);
        let own = share(&|r| r.echo == Echo::OwnBody);
        println!(
            "return {:.3} none {:.3} own {own:.3}",
            share(&returned),
            share(&none)
        );
        assert!((0.5..0.82).contains(&share(&returned)));
        assert!((0.1..0.33).contains(&share(&none)));
        assert!((0.09..0.125).contains(&own), "{own}");
        let of = |class: Option<Class>, value: fn(&TruthRay) -> f64| -> Vec<f64> {
            let wanted = rays
                .iter()
                .filter(|r| returned(r) && class.is_none_or(|c| c == r.class));
            wanted.map(value).collect()
        };
        let range_p50 = quantile(&mut of(None, |r| f64::from(r.range_m)), 0.5);
        let range_p90 = quantile(&mut of(None, |r| f64::from(r.range_m)), 0.9);
        println!("range {range_p50:.2} {range_p90:.2}");
        assert!((5.5..10.5).contains(&range_p50), "{range_p50}");
        assert!((25.0..40.0).contains(&range_p90), "{range_p90}");
        for (class, low, high) in [
            (None, 8.0, 20.0),
            (Some(Class::DriveableSurface), 5.0, 11.0),
            (Some(Class::Sidewalk), 9.0, 16.0),
            (Some(Class::Manmade), 7.0, 26.0),
            (Some(Class::Vegetation), 12.0, 30.0),
            (Some(Class::Car), 0.5, 9.0),
            (Some(Class::Pedestrian), 8.5, 34.0),
        ] {
            let mut all = of(class, |r| f64::from(r.intensity));
            let (p50, p95) = (quantile(&mut all, 0.5), quantile(&mut all, 0.95));
            println!("{class:?} n {} p50 {p50} p95 {p95}", all.len());
            assert!((low..=high).contains(&p50), "{class:?}: {p50}");
        }
    }

    #[test]
    fn a_sweep_is_repeatable_and_its_surface_is_the_worlds() {
        let (world, pattern) = (World::random(7), &SensorRig::default().lidars[0]);
        let rays = sweep(&world, pattern, 3);
        assert_eq!(rays.len(), 32 * 1084);
        assert_eq!(rays, sweep(&world, pattern, 3));
        let pose = pattern.ego_from_sensor();
        let mut surfaces = 0;
        for (i, ray) in rays.iter().enumerate().step_by(7) {
            let (ring, column) = (i / 1084, (i % 1084) as u32);
            let d = pose.rotation
                * direction_in_sensor(pattern.elevations_deg[ring], pattern.azimuth_rad(column));
            let hit = world.cast(pose.translation_m, d, pattern.max_range_m);
            let behind = backdrop::cast(&world, pose.translation_m, d, pattern.max_range_m);
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
