//! Answers of surfaces to a LiDAR's pulse: strength of the echo and probability that it is lost, by class, paint,
//! place, angle and distance. Targets: section 3 of `real_statistics.md`.

use glam::{DVec2, DVec3};

use scene::background::Facade;
use scene::solid::{Solid, SolidShape};
use scene::{BevLayer, Class, Form};
use world::draw::{Draw, hash, noise};
use world::{SurfacePoint, World};

/// Largest echo strength of surfaces that scatter light; only retro-reflective surfaces report more.
pub const DIFFUSE_MOST: f64 = 100.0;
/// Distance at which ordinary echoes begin to sink under the threshold, m.
const REACH_M: f64 = 66.0;
/// Share of worlds whose roads are wet.
const WET: f64 = 0.2;

/// Answer of a surface to a pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarMaterial {
    /// Echo strength at normal incidence.
    pub strength: f64,
    /// Spread of single echoes, in logarithms.
    pub spread: f64,
    /// Share of echoes lost whatever the geometry.
    pub lost: f64,
    /// Share of the pulse that is mirrored or let through at grazing incidence, as glass and water do.
    pub mirror: f64,
    /// True for retro-reflective surfaces, which send light back to where it came from: signs, plates, collars, vests.
    pub retro: bool,
}

const fn diffuse(strength: f64, spread: f64, lost: f64) -> LidarMaterial {
    LidarMaterial {
        strength,
        spread,
        lost,
        mirror: 0.0,
        retro: false,
    }
}

const fn retro(strength: f64) -> LidarMaterial {
    LidarMaterial {
        strength,
        spread: 0.35,
        lost: 0.005,
        mirror: 0.0,
        retro: true,
    }
}

const fn glass(strength: f64, lost: f64, mirror: f64) -> LidarMaterial {
    LidarMaterial {
        strength,
        spread: 0.6,
        lost,
        mirror,
        retro: false,
    }
}

/// A place that a pulse met.
pub struct PulseHit<'a> {
    /// Class of the surface.
    pub class: Class,
    /// Normal, instance and part of the surface.
    pub surface: &'a SurfacePoint,
    /// The solid; `None` is the ground.
    pub solid: Option<&'a Solid>,
    /// Position, ego frame, m.
    pub at: DVec3,
    /// Distance from the sensor, m.
    pub range_m: f64,
    /// Cosine of the angle between pulse and normal.
    pub cosine: f64,
}

/// Materials of one world.
pub struct Materials<'a> {
    seed: u64,
    /// World whose road paint counts; without one nothing is painted.
    world: Option<&'a World>,
    /// Brightness of all surfaces, and of this world's roads, in logarithms.
    gain: f64,
    road: f64,
    /// Share of light that a wet road mirrors away, 0 where it is dry.
    wet: f64,
}

impl<'a> Materials<'a> {
    /// Materials of a world; its seed decides how bright and wet its roads are.
    pub fn new(world: &'a World) -> Self {
        let mut draw = Draw::new(world.seed(), "road surface");
        let road = gaussian(&mut draw);
        let wet = if draw.chance(WET) {
            draw.range(0.3, 1.0)
        } else {
            0.0
        };
        Self {
            seed: world.seed(),
            world: Some(world),
            gain: 0.1 + 0.22 * gaussian(&mut draw),
            road: 0.8 * road,
            wet,
        }
    }

    /// Materials of a scene without a world behind it: dry, of ordinary brightness, nothing painted.
    pub fn ordinary(seed: u64) -> Materials<'static> {
        Materials {
            seed,
            world: None,
            gain: 0.0,
            road: 0.0,
            wet: 0.0,
        }
    }

    /// Strength of the echo, 0 to 255; `noise` is approximately normal.
    pub fn strength(&self, material: &LidarMaterial, cosine: f64, noise: f64) -> f64 {
        let bright = material.strength * (material.spread * noise).exp();
        match material.retro {
            // Bright whatever the angle, up to the end of the scale.
            true => bright.clamp(DIFFUSE_MOST * 0.6, 255.0),
            false => (bright * self.gain.exp() * (0.75 + 0.25 * cosine)).clamp(0.0, DIFFUSE_MOST),
        }
    }

    /// Share of such echoes that are lost.
    pub fn lost(&self, material: &LidarMaterial, met: &PulseHit) -> f64 {
        let dark = match met.class {
            Class::DriveableSurface => {
                let patch = noise(self.seed ^ 0xda12, met.at.x / 3.0, met.at.y / 3.0);
                self.road + 1.4 * patch
            }
            _ => 0.5 * (material.strength.max(0.3) / 7.0).ln(),
        };
        // Lambert's law and the square of the distance, in logarithms; the slope is that of real roads by ring.
        let signal = met.cosine.max(1e-3).ln() - 2.0 * (met.range_m.max(1.0) / 10.0).ln() + dark;
        // Near the end of its range the sensor's threshold takes over.
        let threshold = (met.range_m / REACH_M).powi(4);
        let weak = match material.retro {
            true => 0.0,
            false => 1.0 / (1.0 + (0.62 * signal + 4.8 - threshold).exp()),
        };
        // Schlick's approximation of Fresnel's law.
        let mirrored = material.mirror * (1.0 - met.cosine).powi(5);
        1.0 - (1.0 - material.lost) * (1.0 - weak) * (1.0 - mirrored.clamp(0.0, 1.0))
    }

    /// The material of a place; `detail` is uniform in 0..1 and stands for detail finer than a solid.
    pub fn of(&self, met: &PulseHit, detail: f64) -> LidarMaterial {
        let (seed, surface, p) = (self.seed, met.surface, met.at);
        let mut own = Draw::new(hash(seed ^ u64::from(surface.instance)), "paint");
        let (kind, tone) = (own.unit(), gaussian(&mut own));
        let patch = noise(seed ^ 0x70ad, p.x / 1.5, p.y / 1.5);
        let of = diffuse;
        match met.class {
            Class::DriveableSurface if self.is_painted(p.truncate()) && detail < 0.6 => of(34.0, 0.4, 0.003),
            Class::DriveableSurface => LidarMaterial {
                mirror: self.wet,
                ..of(
                    8.3 * (0.8 * patch + 0.2 * self.road).exp() * (1.0 - 0.4 * self.wet),
                    0.5,
                    0.004,
                )
            },
            Class::Sidewalk => of(14.5 * (0.6 * patch).exp(), 0.42, 0.002),
            Class::OtherFlat => of(13.0 * (0.6 * patch).exp(), 0.38, 0.003),
            Class::Terrain => of(18.0 * (0.55 * patch).exp(), 0.45, 0.008),
            Class::Vegetation => of(15.0 + 16.0 * (met.range_m / 30.0).min(1.0), 0.36, 0.05),
            Class::Manmade if is_sign(met.solid) => retro(112.0),
            // Reflectors on posts and lamps' plates.
            Class::Manmade if is_post(met.solid) && detail < 0.03 => retro(100.0),
            Class::Manmade => {
                // Windows every three metres along and up a facade: mirrors at a slant, else half transparent.
                let along = p.x * surface.normal.y - p.y * surface.normal.x;
                let tall = met
                    .solid
                    .is_some_and(|s| s.reach().z > 1.8 && s.reach().truncate().max_element() > 2.5);
                let [wide, high] = self.glazed(surface.instance);
                let [window, pane] = [
                    (along / 3.0).rem_euclid(1.0) < wide && (p.z / 3.0 - 0.3).rem_euclid(1.0) < high,
                    surface.normal.z.abs() < 0.3,
                ];
                if tall && window && pane {
                    glass(4.0, 0.1, 1.0)
                } else {
                    // Sheet metal, white plaster, name plates: patches of half a metre.
                    let plate = noise(seed ^ 0x91a7e, along / 0.6, p.z / 0.6) > 0.82;
                    match plate && pane {
                        true => of(48.0, 0.4, 0.005),
                        false => of(15.5 * (0.74 * tone).exp(), 0.42, 0.01),
                    }
                }
            }
            Class::Car => {
                // Black, coloured, white or silver.
                let (paint, lost) = match kind {
                    k if k < 0.4 => (1.8, 0.03),
                    k if k < 0.75 => (8.0, 0.015),
                    _ => (28.0, 0.005),
                };
                match surface.part {
                    // The cabin is mostly glass, but for the roof.
                    1 if surface.normal.z < 0.8 => glass(1.2, 0.1, 1.0),
                    2.. => of(2.0, 0.4, 0.06),
                    _ if detail < 0.012 => retro(105.0), // plates and reflectors
                    _ => LidarMaterial {
                        mirror: 0.25,
                        ..of(paint, 0.45, lost)
                    },
                }
            }
            Class::Truck | Class::Bus | Class::Trailer | Class::ConstructionVehicle => match detail {
                d if d < 0.02 => retro(110.0), // contour marking
                _ => LidarMaterial {
                    // A bus is glass for a good part.
                    mirror: if met.class == Class::Bus { 0.5 } else { 0.1 },
                    ..of(27.0 * (0.25 * tone).exp(), 0.4, 0.015)
                },
            },
            Class::Pedestrian if detail < if kind < 0.1 { 0.2 } else { 0.006 } => retro(105.0), // vests
            Class::Pedestrian => of(20.0 * (0.5 * tone).exp(), 0.5, 0.045),
            Class::TrafficCone if detail < 0.25 => retro(170.0), // its collar
            Class::TrafficCone => of(17.0, 0.6, 0.03),
            Class::Barrier if detail < 0.05 => retro(110.0), // striped sheets
            Class::Barrier => of(20.0 * (0.4 * tone).exp(), 0.45, 0.015),
            Class::Motorcycle | Class::Bicycle if detail < 0.03 => retro(110.0),
            Class::Motorcycle | Class::Bicycle => of(12.0, 0.6, 0.06),
            Class::Others | Class::Free => of(14.0 * (0.5 * tone).exp(), 0.4, 0.02),
        }
    }

    /// Shares of a facade's length and of each storey that are windows.
    fn glazed(&self, instance: u32) -> [f64; 2] {
        let thing = self
            .world
            .zip(World::thing_of(instance))
            .and_then(|(world, id)| world.background.get(id));
        match thing.map(|t| &t.form) {
            Some(Form::Building(b)) if b.facade == Facade::Glass => [0.9, 0.8],
            _ => [0.4, 0.45],
        }
    }

    fn is_painted(&self, p: DVec2) -> bool {
        let painted = BevLayer::PedCrossing.bit()
            | BevLayer::LaneDivider.bit()
            | BevLayer::RoadDivider.bit()
            | BevLayer::StopLine.bit();
        self.world.is_some_and(|world| {
            let column = world.layout.extent().column_at(p.x, p.y);
            column.is_some_and(|[x, y]| world.layout.cell(x, y) & painted != 0)
        })
    }
}

/// A thin upright plate: retro-reflective.
fn is_sign(solid: Option<&Solid>) -> bool {
    solid.is_some_and(|s| matches!(s.shape, SolidShape::Hull { half, .. } if half.x < 0.06 && half.y < 0.4))
}

/// A slim pole.
fn is_post(solid: Option<&Solid>) -> bool {
    solid.is_some_and(|s| matches!(s.shape, SolidShape::Frustum { bottom, .. } if bottom < 0.15))
}

/// Standard deviation of the measured range by distance, from second differences along real rings.
pub fn range_sigma_m(class: Class, range_m: f64) -> f64 {
    let far = (range_m - 8.0).max(0.0);
    match class {
        Class::Manmade => 0.0045 + 6e-4 * far,
        _ => 0.0045 + 3e-4 * far,
    }
}

/// Approximately normal number, made of four uniform ones; bounded, so that no draw is absurd.
pub fn gaussian(draw: &mut Draw) -> f64 {
    (draw.unit() + draw.unit() + draw.unit() + draw.unit() - 2.0) * 3f64.sqrt()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use scene::background::{Building, Roof};
    use scene::{Background, BevLayout};

    /// Half of what meets a wall of glass is mirrored at a slant, a fifth of what meets one with windows.
    #[test]
    fn glass_facades_mirror() {
        let share = |facade| {
            let mut background = Background::default();
            let corners = [[10.0, -8.0], [20.0, -8.0], [20.0, 8.0], [10.0, 8.0]];
            background.add(Form::Building(Building {
                outline_m: corners.map(DVec2::from).to_vec(),
                height_m: 9.0,
                roof: Roof::Flat,
                facade,
            }));
            let world = World::with_background(BevLayout::default(), BTreeMap::new(), background, 4);
            let materials = Materials::new(&world);
            let (mut panes, mut hits) = (0, 0);
            for i in 0..2000 {
                let [across, up] = [
                    f64::from(i % 50) / 50.0 - 0.5,
                    f64::from(i / 50) / 40.0 * 0.5 + 0.05,
                ];
                let dir = DVec3::new(1.0, across, up * 0.8).normalize();
                let origin = DVec3::new(0.0, 0.0, 1.8);
                let Some(hit) = world
                    .cast(origin, dir, 40.0)
                    .filter(|h| h.class == Class::Manmade)
                else {
                    continue;
                };
                let at = origin + dir * hit.range_m;
                let met = PulseHit {
                    class: hit.class,
                    surface: &world.surface(&hit, at),
                    solid: hit.solid.and_then(|i| world.solids().get(i as usize)),
                    at,
                    range_m: hit.range_m,
                    cosine: 0.8,
                };
                hits += 1;
                panes += usize::from(materials.of(&met, 0.5).mirror > 0.5);
            }
            assert!(hits > 500, "{hits}");
            panes as f64 / hits as f64
        };
        let [plain, glass] = [Facade::Plain, Facade::Glass].map(share);
        assert!((0.08..0.35).contains(&plain) && glass > 0.5, "{plain} {glass}");
    }
}
