//! Ground: asphalt and its paint, slabs, pavers, grass.

use glam::{IVec3, Vec2, Vec3};

use super::super::noise::{fbm2, ramp, unit3, value2};
use super::super::prepared::Appearance;
use super::{LitSurface, band, gray, visible};
use scene::appearance::{KERB_EDGE_M, KERB_SEEN_M};
use scene::truth::{self, TruthClass};
use scene::{BevLayer, Class, PolylineKind};

impl Appearance {
    pub(super) fn ground_surface(&self, p: Vec3, normal: Vec3, fp: f32) -> LitSurface {
        let a = self.anchor(p).truncate();
        let p2 = p.truncate();
        let g = self.ground.at(p2, a);
        // The edge of the road, softened over a pixel.
        let edge = (fp * 0.5).max(KERB_EDGE_M);
        let road = ((g.inside_road_m + 0.014) / edge * 0.5 + 0.5).clamp(0.0, 1.0);
        let mut s = LitSurface::matt(Vec3::ZERO, normal);
        if road > 0.0 {
            let r = self.road(p2, a, fp, g.inside_road_m);
            s.albedo += r.albedo * road;
            (s.mirror, s.gloss) = (r.mirror * road, r.gloss);
            s.normal = s.normal.lerp(r.normal, road).normalize_or(Vec3::Z);
        }
        if road < 1.0 {
            let rest = (1.0 - g.share[0]).max(1e-3);
            let (walk, flat) = (g.share[1] / rest, g.share[2] / rest);
            let green = green(a, g.share[3] / rest);
            let mut c = Vec3::ZERO;
            if green < 1.0 {
                let paved = if walk >= flat { slabs(a, fp) } else { pavers(a, fp) };
                c += paved * (1.0 - green);
            }
            if green > 0.0 {
                c += grass(a, fp, self.seed) * green;
            }
            // Kerbstones where the pavement meets the road.
            let out = -g.inside_road_m;
            // From afar they are narrower than a pixel, which would make them a bright thread.
            let kerb = ramp(0.21, 0.19, out) * ramp(0.7, 0.4, g.share[3] / rest) * visible(fp, KERB_SEEN_M);
            if kerb > 0.0 {
                let stone = 0.25 + 0.06 * value2(a * 7.0, 43) + 0.04 * value2(a * 1.1, 44);
                let side = ramp(0.8, 0.4, normal.z);
                c = c.lerp(
                    gray(stone) * Vec3::new(1.0, 0.985, 0.95) * (1.0 - 0.25 * side),
                    kerb,
                );
            }
            if self.air.snow > 0.0 {
                let lies = (0.86 + 0.4 * (value2(a * 1.3, 45) - 0.5)).clamp(0.0, 1.0) * self.air.snow;
                let drift = 0.72
                    + 0.13 * value2(a * 0.5, 46)
                    + 0.06 * value2(a * 2.1, 48)
                    + 0.07 * value2(a * 7.0, 47) * visible(fp, 0.14);
                c = c.lerp(
                    gray(drift) * Vec3::new(0.965, 0.985, 1.02),
                    lies * ramp(0.35, 0.75, normal.z),
                );
            }
            c *= 1.0 - 0.30 * self.air.wet;
            c = c.lerp(Vec3::new(0.44, 0.32, 0.18), 0.55 * self.air.dust);
            s.albedo += c * (1.0 - road);
            let shine = 0.025 * self.air.wet * (1.0 - green);
            s.mirror += shine * (1.0 - road);
            s.gloss = s.gloss.max(0.5 * self.air.wet);
        }
        s
    }

    fn road(&self, p: Vec2, a: Vec2, fp: f32, inside_m: f32) -> LitSurface {
        // Asphalt: patches of age, tracks of tyres, oil in the middle, grain, cracks.
        let age = fbm2(a * 0.11, 3, 51);
        let mut tone = 0.088 + 0.035 * (age - 0.5) + 0.012 * (value2(a * 0.9, 52) - 0.5);
        let lane = self.paint.nearest(PolylineKind::LaneCenter, p.as_dvec2());
        let mut on_track = 0.0;
        if let Some(lane) = lane {
            let d = lane.distance_m as f32;
            on_track = track(d);
            tone *= 1.0 - 0.10 * on_track;
            tone *= 1.0 - 0.10 * ramp(0.45, 0.0, d) * value2(a * 0.6, 53);
        }
        let grain = visible(fp, 0.03);
        if grain > 0.0 {
            tone *= 1.0 + grain * (0.55 * (value2(a * 46.0, 54) - 0.5) + 0.4 * (value2(a * 95.0, 55) - 0.5));
        }
        let middle = visible(fp, 0.12);
        tone *= 1.0 + middle * 0.16 * (value2(a * 11.0, 56) - 0.5);
        // Cracks and sealed seams: thin level lines of slow noise.
        let crack = (fbm2(a * 0.42 + 31.0, 4, 57) - 0.5).abs();
        let seam = band(crack * 2.2, 0.008, fp) * ramp(0.52, 0.62, value2(a * 0.13, 58));
        tone *= 1.0 - 0.42 * seam;
        // Dirt in the gutter.
        tone *= 1.0 - 0.28 * ramp(0.5, 0.05, inside_m);
        let mut color = gray(tone) * Vec3::new(1.0, 0.995, 0.985);
        let paint = self.road_paint(p, a, fp);
        let worn = 0.80 + 0.25 * (value2(a * 5.0, 59) - 0.5)
            - 0.28 * ramp(0.60, 0.78, value2(a * 16.0, 60)) * visible(fp, 0.08);
        color = color.lerp(paint.0, (paint.1 * worn).clamp(0.0, 1.0));
        let mut s = LitSurface::matt(color, Vec3::Z);
        s.mirror = 0.012;
        s.gloss = 0.25;
        let air = &self.air;
        if air.wet > 0.0 {
            // A film of water everywhere, standing water in the hollows.
            let hollow = fbm2(a * 0.32 + 7.0, 3, 61) + 0.10 * on_track;
            let puddle = ramp(0.50, 0.60, hollow) * ramp(0.5, 1.0, air.wet);
            s.albedo *= 1.0 - (0.42 + 0.2 * puddle) * air.wet;
            s.mirror = air.wet * (0.018 + 0.012 * puddle);
            s.gloss = 0.72 + 0.26 * puddle;
            let ripple = 0.030 * (1.0 - 0.75 * puddle) * visible(fp, 0.25);
            let w = |salt| value2(a * 6.5, salt) - 0.5;
            s.normal = Vec3::new(w(62) * ripple * 2.0, w(63) * ripple * 2.0, 1.0).normalize();
        }
        if air.snow > 0.0 {
            let lies = self.snow_on_road(a, fp, lane.map(|_| on_track));
            let slush = Vec3::new(0.50, 0.52, 0.56)
                * (0.80 + 0.34 * value2(a * 2.4, 66) + 0.2 * (value2(a * 9.0, 69) - 0.5) * visible(fp, 0.1));
            s.albedo = (s.albedo * 0.75).lerp(slush, lies * 0.93 * air.snow);
            s.mirror = 0.02 * (1.0 - lies);
            s.gloss = 0.6;
        }
        if air.dust > 0.0 {
            let drift = ramp(0.30, 0.75, fbm2(Vec2::new(a.x * 0.25, a.y * 0.9), 4, 67));
            s.albedo = s.albedo.lerp(Vec3::new(0.42, 0.30, 0.17), 0.25 + 0.6 * drift);
            s.mirror = 0.0;
        }
        s
    }

    /// The class of the ground as it is drawn: of the surface that covers more than half of a pixel `fp` m wide.
    pub(in crate::pictures::appearance) fn ground_label(&self, p: Vec3, fp: f32) -> TruthClass {
        let (p2, a) = (p.truncate(), self.anchor(p).truncate());
        let g = self.ground.at(p2, a);
        if g.inside_road_m > -0.014 {
            let (_, cover, id) = self.road_paint(p2, a, fp);
            let lane = || self.paint.nearest(PolylineKind::LaneCenter, p2.as_dvec2());
            let snow = match self.air.snow > 0.0 {
                true => {
                    0.93 * self.air.snow
                        * self.snow_on_road(a, fp, lane().map(|l| track(l.distance_m as f32)))
                }
                false => 0.0,
            };
            return match cover * (1.0 - snow) > 0.5 {
                true => id,
                false => Class::DriveableSurface.id(),
            };
        }
        let rest = (1.0 - g.share[0]).max(1e-3);
        let class = match green(a, g.share[3] / rest) > 0.5 {
            true => Class::Terrain,
            false if g.share[1] >= g.share[2] => Class::Sidewalk,
            false => Class::OtherFlat,
        };
        class.id()
    }

    /// Amount of snow on the road, 0 to 1; `track` is how much of it tyres cleared, `None` off the lanes.
    fn snow_on_road(&self, a: Vec2, fp: f32, track: Option<f32>) -> f32 {
        let clear = track.map_or(0.06, |track| 0.75 * track + 0.14);
        ramp(
            0.30,
            0.62,
            0.62 + 0.55 * (fbm2(a * 0.9, 3, 64) - 0.5)
                + 0.30 * (value2(a * 6.0, 65) - 0.5)
                + 0.26 * visible(fp, 0.12) * (value2(a * 17.0, 70) - 0.5)
                - clear,
        )
    }

    /// Colour, cover and class of the paint on the road.
    fn road_paint(&self, p: Vec2, a: Vec2, fp: f32) -> (Vec3, f32, TruthClass) {
        let paint = &self.paint;
        let (q, white) = (p.as_dvec2(), Vec3::new(0.66, 0.66, 0.63));
        let mut out = (white, 0.0f32, Class::DriveableSurface.id());
        let mut more = |cover: f32, color: Vec3, id: TruthClass| {
            if cover > out.1 {
                out = (color, cover, id);
            }
        };
        let wavy = 0.012 * (value2(a * 3.0, 68) - 0.5);
        let dash = |along: f64| {
            let s = along.rem_euclid(9.0) as f32;
            band((s - 1.5).abs(), 1.5, fp)
        };
        let line = |kind, layer| {
            let near = if paint.allows(layer, q) {
                paint.nearest(kind, q)
            } else {
                None
            };
            near.map(|n| (n.distance_m as f32 + wavy, n.along_m))
        };
        if paint.allows(BevLayer::PedCrossing, q) || paint.is_orphan(BevLayer::PedCrossing, q) {
            let crossing = paint.crossing_at(q);
            let along = crossing.map(|c| c.along.as_vec2());
            if along.is_some() || paint.is_orphan(BevLayer::PedCrossing, q) {
                let s = p.dot(along.unwrap_or(Vec2::Y)).rem_euclid(1.0);
                more(band((s - 0.5).abs(), 0.25, fp), white, CROSSING);
            }
        }
        if let Some((d, along)) = line(PolylineKind::LaneDivider, BevLayer::LaneDivider) {
            more(band(d, 0.075, fp) * dash(along), white, LANE_DIVIDER);
        }
        if let Some((d, _)) = line(PolylineKind::StopLine, BevLayer::StopLine) {
            more(band(d, 0.2, fp), white, truth::STOP_LINE);
        }
        if let Some((d, _)) = line(PolylineKind::RoadDivider, BevLayer::RoadDivider) {
            more(band((d - 0.11).abs(), 0.055, fp), YELLOW, ROAD_DIVIDER);
        }
        for (layer, color, id) in [
            (BevLayer::LaneDivider, white, LANE_DIVIDER),
            (BevLayer::StopLine, white, truth::STOP_LINE),
            (BevLayer::RoadDivider, YELLOW, ROAD_DIVIDER),
        ] {
            if paint.is_orphan(layer, q) {
                out = (color, 1.0, id);
            }
        }
        out
    }
}

/// Classes of paint.
const CROSSING: TruthClass = 17;
const ROAD_DIVIDER: TruthClass = 18;
const LANE_DIVIDER: TruthClass = 19;
/// Paint between opposite directions.
const YELLOW: Vec3 = Vec3::new(0.62, 0.40, 0.045);

/// How much tyres run here, 0 to 1, at a distance from the middle of the lane, m.
fn track(from_middle_m: f32) -> f32 {
    ramp(0.42, 0.1, (from_middle_m - 0.82).abs())
}

/// How green the ground beside the road is, 0 to 1, for a share of terrain of what is no road.
fn green(a: Vec2, terrain: f32) -> f32 {
    let fray = 0.22 * (value2(a * 2.2, 41) - 0.5) + 0.12 * (value2(a * 9.0, 42) - 0.5);
    ramp(0.46, 0.54, terrain + fray)
}

/// Concrete slabs with joints.
fn slabs(a: Vec2, fp: f32) -> Vec3 {
    let q = a / 0.9;
    let cell = q.floor();
    let f = (q - cell - 0.5).abs();
    let tone = unit3(IVec3::new(cell.x as i32, cell.y as i32, 1), 12);
    let joint = band(0.5 - f.max_element(), 0.012, fp / 0.9);
    let stain = value2(a * 0.7, 13) * 0.6 + value2(a * 3.1, 14) * 0.4;
    let grain = visible(fp, 0.03) * (value2(a * 40.0, 15) - 0.5) * 0.14;
    let v = (0.27 + 0.045 * (tone - 0.5) * visible(fp, 0.9) + 0.07 * (stain - 0.5))
        * (1.0 + grain)
        * (1.0 - 0.5 * joint);
    Vec3::new(v * 1.02, v, v * 0.945)
}

/// Small paving stones.
fn pavers(a: Vec2, fp: f32) -> Vec3 {
    let row = (a.y / 0.12).floor();
    let q = Vec2::new(a.x / 0.22 + 0.5 * (row.rem_euclid(2.0)), a.y / 0.12);
    let cell = q.floor();
    let f = (q - cell - 0.5).abs();
    let tone = unit3(IVec3::new(cell.x as i32, cell.y as i32, 2), 16);
    let near = visible(fp, 0.12);
    let joint = band((0.5 - f.max_element()) * 0.15, 0.006, fp);
    let v =
        (0.22 + 0.10 * (tone - 0.5) * near + 0.05 * (value2(a * 0.6, 17) - 0.5)) * (1.0 - 0.5 * joint * near);
    Vec3::new(v * 1.12, v * 0.97, v * 0.84)
}

/// Grass with bare and dry patches.
fn grass(a: Vec2, fp: f32, seed: u32) -> Vec3 {
    let dry = fbm2(a * 0.13, 4, seed ^ 33);
    let base = Vec3::new(0.070, 0.105, 0.026).lerp(Vec3::new(0.155, 0.140, 0.058), ramp(0.42, 0.72, dry));
    let base = base.lerp(
        Vec3::new(0.120, 0.090, 0.058),
        ramp(0.64, 0.74, fbm2(a * 0.35 + 5.0, 3, seed ^ 34)) * 0.8,
    );
    let blades = visible(fp, 0.05) * (value2(a * Vec2::new(55.0, 42.0), 35) - 0.5);
    let tufts = visible(fp, 0.25) * (value2(a * 5.5, 36) - 0.5);
    let waves = value2(a * 0.9, 37) - 0.5;
    base * (1.0 + 0.85 * blades + 0.5 * tufts + 0.35 * waves)
}
