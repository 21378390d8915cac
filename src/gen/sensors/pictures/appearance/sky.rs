//! Sky, sun, air and the skyline beyond the grid, by time and weather. All in the frame in which textures are anchored.

use glam::{IVec3, Vec2, Vec3};

use super::noise::{fbm2, hash1, ramp, unit, unit3, value2};
use scene::{Class, Conditions, TimeOfDay, Weather};

/// Light and air.
#[derive(Clone, Debug)]
pub struct Air {
    /// Direction to the sun or the moon, anchored frame.
    pub to_sun: Vec3,
    /// Its light on a surface that faces it.
    pub sun: Vec3,
    /// Sky straight up.
    pub zenith: Vec3,
    /// Sky above the horizon.
    pub horizon: Vec3,
    /// Light from the sky on a level surface.
    pub ambient: Vec3,
    /// Light that comes back from the ground.
    pub bounce: Vec3,
    /// Share of the sky that clouds cover.
    pub clouds: f32,
    /// Share of light lost per m.
    pub haze_per_m: f32,
    /// Colour of the haze.
    pub haze: Vec3,
    /// How wet the ground is, 0 to 1.
    pub wet: f32,
    /// True while rain falls.
    pub rain: bool,
    /// How much snow lies, 0 to 1.
    pub snow: f32,
    /// How much dust lies, 0 to 1.
    pub dust: f32,
    /// How bright lamps and windows shine, 0 to 1.
    pub lamps: f32,
    /// Factor from light to picture.
    pub exposure: f32,
    seed: u32,
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

impl Air {
    /// The air of these conditions.
    pub fn new(c: &Conditions) -> Self {
        let seed = (c.seed ^ c.seed >> 32) as u32;
        let (elevation_deg, sun, zenith, horizon, ambient, exposure, lamps) = match c.time {
            TimeOfDay::Day => (
                36.0,
                v(4.1, 3.65, 3.0),
                v(0.13, 0.31, 0.78),
                v(0.60, 0.76, 0.97),
                v(0.62, 0.73, 0.92) * 0.86,
                0.68,
                0.0,
            ),
            TimeOfDay::Dawn => (
                11.0,
                v(2.5, 1.75, 1.15),
                v(0.20, 0.34, 0.66),
                v(0.98, 0.76, 0.62),
                v(0.50, 0.54, 0.72),
                0.78,
                0.25,
            ),
            TimeOfDay::Dusk => (
                7.0,
                v(2.6, 1.25, 0.5),
                v(0.15, 0.21, 0.46),
                v(1.05, 0.56, 0.32),
                v(0.46, 0.42, 0.54),
                0.85,
                0.6,
            ),
            TimeOfDay::Night => (
                40.0,
                v(0.022, 0.028, 0.045),
                v(0.003, 0.006, 0.015),
                v(0.026, 0.025, 0.032),
                v(0.027, 0.031, 0.046),
                2.0,
                1.0,
            ),
        };
        let azimuth = 2.45 + (unit(hash1(seed, 4)) - 0.5) * if seed == 0 { 0.0 } else { 5.0 };
        let (azimuth, elevation_deg) = match c.sun {
            Some(sun) => ((sun.azimuth_deg as f32).to_radians(), sun.elevation_deg as f32),
            None => (azimuth, elevation_deg),
        };
        let elevation = f32::to_radians(elevation_deg);
        let mut air = Self {
            to_sun: v(
                azimuth.cos() * elevation.cos(),
                azimuth.sin() * elevation.cos(),
                elevation.sin(),
            ),
            sun,
            zenith,
            horizon,
            ambient,
            bounce: (sun * elevation.sin() + ambient) * 0.16,
            clouds: 0.42,
            haze_per_m: c.lost_per_m() as f32,
            haze: horizon * 0.95,
            wet: c.wetness as f32,
            rain: c.weather == Weather::Rain,
            snow: 0.0,
            dust: 0.0,
            lamps,
            exposure,
            seed,
        };
        air.weather(c.weather);
        air
    }

    /// Takes the sun away behind clouds of this colour, keeping the whole brightness.
    fn cover(&mut self, tint: Vec3, light: f32, sun_left: f32) {
        let grey = |c: Vec3| Vec3::splat(c.dot(v(0.25, 0.5, 0.25)));
        let total = grey(self.sun) * self.to_sun.z + grey(self.ambient);
        self.sun *= sun_left;
        self.ambient = total * tint * light;
        self.horizon = total * tint * light * 0.62;
        self.zenith = total * tint * light * 0.50;
        self.bounce = self.ambient * 0.14;
        self.clouds = 1.0;
        self.haze = self.horizon;
    }

    fn weather(&mut self, weather: Weather) {
        let night = self.lamps >= 1.0;
        match weather {
            Weather::Clear => {}
            Weather::Overcast => {
                // A low sun colours the clouds that hide it.
                let low = self.sun / self.sun.max_element().max(1e-3);
                let tint = v(0.96, 1.0, 1.05) * Vec3::ONE.lerp(low / low.dot(v(0.25, 0.5, 0.25)), 0.22);
                self.cover(if night { v(0.96, 1.0, 1.05) } else { tint }, 0.70, 0.0);
            }
            Weather::Rain => {
                self.cover(v(0.91, 1.0, 1.11), 0.36, 0.0);
                self.lamps = self.lamps.max(0.45);
                self.exposure *= 1.22;
            }
            Weather::Snow => {
                self.cover(v(0.95, 1.0, 1.07), 0.46, 0.0);
                self.snow = 1.0;
                self.lamps = self.lamps.max(0.3);
                self.exposure *= 0.86;
            }
            Weather::Fog => {
                self.cover(v(0.98, 1.0, 1.02), 0.55, 0.0);
                self.haze = self.ambient * 0.58;
                self.lamps = self.lamps.max(0.5);
            }
            Weather::Sandstorm => {
                self.cover(v(1.30, 0.80, 0.38), 0.50, 0.10);
                self.haze = self.ambient * 0.56;
                self.exposure *= 0.80;
                self.dust = 1.0;
                self.lamps = self.lamps.max(0.4);
            }
        }
        if night {
            // Lamps light the air itself.
            let glow = v(0.060, 0.048, 0.036) * (self.haze_per_m * 40.0).min(1.4);
            self.haze += glow;
            self.horizon += glow * 0.8;
            self.zenith += glow * 0.5;
        }
    }

    /// The sky in a direction.
    pub fn sky(&self, d: Vec3) -> Vec3 {
        let up = d.z.max(0.0);
        let mut color = self.horizon.lerp(self.zenith, up.powf(0.55));
        let toward = d.dot(self.to_sun).max(0.0);
        let clear = 1.0 - self.clouds * 0.6;
        color += self.sun * (0.10 * toward.powi(6) + 0.25 * toward.powi(48)) * clear.max(0.0);
        let q = d.truncate() / (up + 0.12);
        if self.clouds < 0.99 {
            let n = fbm2(q * 0.75 + 9.0, 5, self.seed ^ 0xc10d);
            let cover = ramp(1.0 - self.clouds - 0.06, 1.0 - self.clouds + 0.22, n) * ramp(0.0, 0.16, up);
            let thick = fbm2(
                q * 0.75 + 9.0 + self.to_sun.truncate() * 0.22,
                4,
                self.seed ^ 0xc10d,
            );
            let lit = (0.5 + 1.6 * (n - thick)).clamp(0.15, 1.0);
            let white = self.sun * 0.36 * (0.4 + 0.6 * lit) + self.ambient * (0.42 + 0.2 * lit);
            color = color.lerp(white, cover * 0.9);
            if toward > 0.9994 && cover < 0.5 {
                color += self.sun * 12.0 * ramp(0.9994, 0.99965, toward) * (1.0 - 2.0 * cover);
            }
        } else {
            let n = fbm2(q * 0.55 + 4.0, 4, self.seed ^ 0xc10d);
            color *= 0.86 + 0.30 * n;
        }
        if self.lamps >= 1.0 && self.clouds < 0.9 && up > 0.02 {
            let cell = (d * 700.0).floor().as_ivec3();
            let star = unit3(cell, 77);
            if star > 0.9995 {
                color += Vec3::splat(0.16 * unit3(cell, 78)) * ramp(0.05, 0.35, up);
            }
        }
        color
    }

    /// The share of a colour that arrives over `t` m, with the air's own light added.
    #[inline]
    pub fn through(&self, color: Vec3, t: f32, d: Vec3) -> Vec3 {
        let left = (-self.haze_per_m * t).exp();
        let sunward = d.dot(self.to_sun).max(0.0).powi(8);
        let haze = self.haze + self.sun * (0.08 * sunward);
        haze.lerp(color, left)
    }

    /// The skyline on the circle of radius `radius_m` around the grid in the direction of `p` (anchored frame, relative
    /// to the grid's middle, z up from the ground): its colour and class, or `None` above it.
    pub fn skyline(&self, p: Vec3, radius_m: f32, open: f32) -> Option<(Vec3, Class)> {
        let layer = self.seed.wrapping_add(radius_m as u32);
        let around = p.truncate() / p.truncate().length().max(1e-3);
        // Arc length, so that widths are in m.
        let s = around.y.atan2(around.x) * radius_m;
        let plot = (s / 19.0).floor();
        let h = hash1(plot as i32 as u32, layer);
        let scale = radius_m / 75.0;
        let built = unit(h) > 0.45;
        let height = if built {
            let inside = (s / 19.0 - plot - 0.5).abs();
            if inside > 0.44 {
                0.0
            } else {
                0.7 + 3.0 * (2.0 + (3.6 * unit(hash1(h, 1)) * scale.sqrt()).floor())
            }
        } else {
            0.0
        };
        let crown = Vec2::new(s, 0.0);
        let trees = (2.5
            + 5.5 * value2(crown * 0.09 + 3.0, layer ^ 5)
            + 1.6 * value2(crown * 0.5, layer ^ 6)
            + 0.6 * value2(crown * 1.9, layer ^ 7))
            * scale
            * (0.55 + 0.9 * value2(crown * 0.021, layer ^ 8));
        let free = 1.0 - open;
        let lit = |albedo: Vec3, sun: f32| albedo * (self.ambient * 0.62 + self.sun * sun + self.bounce);
        if p.z < trees * free * (0.35 + 0.65 * ramp(0.35, 0.65, value2(crown * 0.045, layer ^ 11))) {
            let leaf = value2(Vec2::new(s, p.z) * 1.4, layer ^ 9) * 0.6
                + value2(Vec2::new(s, p.z) * 0.5, layer ^ 10) * 0.4;
            let albedo = v(0.055, 0.085, 0.032) * (0.55 + 0.9 * leaf);
            return Some((self.whitened(lit(albedo, 0.34), 0.4), Class::Vegetation));
        }
        if built && p.z < height * free {
            let tone = unit(hash1(h, 2));
            let mut albedo = v(0.46, 0.43, 0.39).lerp(v(0.32, 0.27, 0.24), tone);
            let mut emit = Vec3::ZERO;
            let cell = Vec2::new(s / 2.6, p.z / 3.0);
            let f = cell - cell.floor();
            if f.x > 0.28 && f.x < 0.72 && f.y > 0.3 && f.y < 0.8 && p.z < height - 0.9 {
                albedo = v(0.09, 0.11, 0.13);
                let on = unit3(
                    IVec3::new(cell.x.floor() as i32, cell.y.floor() as i32, h as i32),
                    3,
                );
                if on < 0.32 {
                    emit = v(1.0, 0.72, 0.40) * (0.30 * self.lamps * (0.4 + on));
                }
            }
            return Some((lit(albedo, 0.3) + emit, Class::Manmade));
        }
        None
    }

    /// A colour under snow.
    pub fn whitened(&self, color: Vec3, share: f32) -> Vec3 {
        color.lerp(self.ambient * 0.75, share * self.snow)
    }
}
