//! What surfaces are made of, by class and place: asphalt and paint, slabs and kerbs, grass, facades
//! with windows, leaves and bark, cars from their lamps to their tyres. Colours are linear.

use glam::{IVec3, Vec2, Vec3};

use super::field::Structure;
use super::look::{Hit, Look, What};
use super::noise::{fbm2, hash1, ramp, unit, unit3, value2, value3};
use super::things::{Material, Thing, rgb};
use crate::scene::look::{KERB_EDGE_M, KERB_SEEN_M, TRUNK};
use crate::scene::{BevLayer, Class, PolylineKind};

/// A surface to be lit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Share of light given back in all directions.
    pub albedo: Vec3,
    /// Share mirrored when seen straight on.
    pub mirror: f32,
    /// Sharpness of what is mirrored, 0 to 1.
    pub gloss: f32,
    /// Own light.
    pub emit: Vec3,
    /// Unit normal, ego frame.
    pub normal: Vec3,
    /// Share of light that shines through from behind (leaves).
    pub through: f32,
}

impl Surface {
    fn matt(albedo: Vec3, normal: Vec3) -> Self {
        Self {
            albedo,
            mirror: 0.0,
            gloss: 0.0,
            emit: Vec3::ZERO,
            normal,
            through: 0.0,
        }
    }
}

/// Share of a pattern's contrast left when a pixel covers `footprint` m of it.
#[inline]
fn visible(footprint: f32, feature: f32) -> f32 {
    ramp(feature * 1.4, feature * 0.35, footprint)
}

/// 1 inside a band of half width `half` around 0, softened over a pixel's footprint.
#[inline]
fn band(distance: f32, half: f32, footprint: f32) -> f32 {
    let soft = (footprint * 0.5).max(0.004);
    // A line thinner than a pixel keeps its share of it.
    (((half - distance) / soft * 0.5 + 0.5).clamp(0.0, 1.0) * (half / soft.max(half)).min(1.0))
        .clamp(0.0, 1.0)
}

fn gray(v: f32) -> Vec3 {
    Vec3::splat(v)
}

/// Light of tail lamps: exposed at night just beyond white in red alone, so that they stay red and keep a soft halo.
const TAIL: Vec3 = Vec3::new(1.0, 0.035, 0.02);

impl Look {
    /// The surface at a hit; `footprint` is the width of a pixel on it in m.
    pub(super) fn surface(&self, hit: &Hit, dir: Vec3, footprint: f32) -> Surface {
        let normal = self.normal(hit);
        match hit.what {
            What::Ground => self.ground_surface(hit.p, normal, footprint),
            What::Voxel(label) => self.voxel_surface(hit, label, normal, footprint),
            What::Thing(i, local, material) => {
                let thing = &self.things[i as usize];
                let n = thing.turn(hit.normal);
                let mut s = self.thing_surface(thing, local, n, material, footprint);
                s.normal = if s.normal == n {
                    hit.normal
                } else {
                    thing.turn_back(s.normal)
                };
                self.cover(&mut s, hit.p, 0.75);
                let _ = dir;
                s
            }
        }
    }

    /// Snow, dust and water on a surface; `hold` is how much of them stays.
    fn cover(&self, s: &mut Surface, p: Vec3, hold: f32) {
        let a = self.anchor(p);
        if self.air.snow > 0.0 {
            let n = s.normal.z + 0.35 * (value3(a * 3.0, 31) - 0.5) + 0.15 * (value3(a * 11.0, 32) - 0.5);
            let lies = ramp(0.42, 0.75, n) * hold * self.air.snow;
            s.albedo = s.albedo.lerp(Vec3::new(0.80, 0.83, 0.88), lies);
            s.mirror *= 1.0 - lies;
            s.emit *= 1.0 - lies;
        }
        if self.air.dust > 0.0 {
            let lies = (0.28 + 0.45 * ramp(0.2, 0.9, s.normal.z)) * self.air.dust * hold;
            s.albedo = s.albedo.lerp(Vec3::new(0.46, 0.33, 0.19), lies);
            s.mirror *= 1.0 - lies;
        }
        if self.air.wet > 0.0 && s.mirror < 0.03 {
            s.albedo *= 1.0 - 0.35 * self.air.wet;
            s.mirror = s.mirror.max(0.02 * self.air.wet);
            s.gloss = s.gloss.max(0.35);
        }
    }

    fn ground_surface(&self, p: Vec3, normal: Vec3, fp: f32) -> Surface {
        let a = self.anchor(p).truncate();
        let p2 = p.truncate();
        let g = self.ground.at(p2, a);
        // The edge of the road, softened over a pixel.
        let edge = (fp * 0.5).max(KERB_EDGE_M);
        let road = ((g.inside_road_m + 0.014) / edge * 0.5 + 0.5).clamp(0.0, 1.0);
        let mut s = Surface::matt(Vec3::ZERO, normal);
        if road > 0.0 {
            let r = self.road(p2, a, fp, g.inside_road_m);
            s.albedo += r.albedo * road;
            (s.mirror, s.gloss) = (r.mirror * road, r.gloss);
            s.normal = s.normal.lerp(r.normal, road).normalize_or(Vec3::Z);
        }
        if road < 1.0 {
            let rest = (1.0 - g.share[0]).max(1e-3);
            let (walk, flat) = (g.share[1] / rest, g.share[2] / rest);
            let fray = 0.22 * (value2(a * 2.2, 41) - 0.5) + 0.12 * (value2(a * 9.0, 42) - 0.5);
            let green = ramp(0.46, 0.54, g.share[3] / rest + fray);
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

    fn road(&self, p: Vec2, a: Vec2, fp: f32, inside_m: f32) -> Surface {
        // Asphalt: patches of age, tracks of tyres, oil in the middle, grain, cracks.
        let age = fbm2(a * 0.11, 3, 51);
        let mut tone = 0.088 + 0.035 * (age - 0.5) + 0.012 * (value2(a * 0.9, 52) - 0.5);
        let lane = self.paint.nearest(PolylineKind::LaneCenter, p.as_dvec2());
        let mut track = 0.0;
        if let Some(lane) = lane {
            let d = lane.distance_m as f32;
            track = ramp(0.42, 0.1, (d - 0.82).abs());
            tone *= 1.0 - 0.10 * track;
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
        let mut s = Surface::matt(color, Vec3::Z);
        s.mirror = 0.012;
        s.gloss = 0.25;
        let air = &self.air;
        if air.wet > 0.0 {
            // A film of water everywhere, standing water in the hollows.
            let hollow = fbm2(a * 0.32 + 7.0, 3, 61) + 0.10 * track;
            let puddle = ramp(0.50, 0.60, hollow) * ramp(0.5, 1.0, air.wet);
            s.albedo *= 1.0 - (0.42 + 0.2 * puddle) * air.wet;
            s.mirror = air.wet * (0.018 + 0.012 * puddle);
            s.gloss = 0.72 + 0.26 * puddle;
            let ripple = 0.030 * (1.0 - 0.75 * puddle) * visible(fp, 0.25);
            let w = |salt| value2(a * 6.5, salt) - 0.5;
            s.normal = Vec3::new(w(62) * ripple * 2.0, w(63) * ripple * 2.0, 1.0).normalize();
        }
        if air.snow > 0.0 {
            let clear = if lane.is_some() { 0.75 * track + 0.14 } else { 0.06 };
            let lies = ramp(
                0.30,
                0.62,
                0.62 + 0.55 * (fbm2(a * 0.9, 3, 64) - 0.5)
                    + 0.30 * (value2(a * 6.0, 65) - 0.5)
                    + 0.26 * visible(fp, 0.12) * (value2(a * 17.0, 70) - 0.5)
                    - clear,
            );
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

    /// Colour and cover of what is painted on the road.
    fn road_paint(&self, p: Vec2, a: Vec2, fp: f32) -> (Vec3, f32) {
        let paint = &self.paint;
        let (q, white) = (p.as_dvec2(), Vec3::new(0.66, 0.66, 0.63));
        let mut out = (white, 0.0f32);
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
                out.1 = out.1.max(band((s - 0.5).abs(), 0.25, fp));
            }
        }
        if let Some((d, along)) = line(PolylineKind::LaneDivider, BevLayer::LaneDivider) {
            out.1 = out.1.max(band(d, 0.075, fp) * dash(along));
        }
        if let Some((d, _)) = line(PolylineKind::StopLine, BevLayer::StopLine) {
            out.1 = out.1.max(band(d, 0.2, fp));
        }
        if let Some((d, _)) = line(PolylineKind::RoadDivider, BevLayer::RoadDivider) {
            let double = band((d - 0.11).abs(), 0.055, fp);
            if double > out.1 {
                out = (Vec3::new(0.62, 0.40, 0.045), double);
            }
        }
        for (layer, color) in [
            (BevLayer::LaneDivider, white),
            (BevLayer::StopLine, white),
            (BevLayer::RoadDivider, Vec3::new(0.62, 0.40, 0.045)),
        ] {
            if paint.is_orphan(layer, q) {
                out = (color, 1.0);
            }
        }
        out
    }

    fn voxel_surface(&self, hit: &Hit, label: u8, normal: Vec3, fp: f32) -> Surface {
        let a = self.anchor(hit.p);
        let class = Class::from_id(label).unwrap_or(Class::Others);
        let mut s = match class {
            _ if label == TRUNK => {
                let bark = value3(a * Vec3::new(14.0, 14.0, 3.0), 22);
                Surface::matt(Vec3::new(0.105, 0.080, 0.058) * (0.55 + 0.9 * bark), normal)
            }
            Class::Vegetation => self.plant(a, normal, fp),
            Class::Manmade => self.structure(hit, a, normal, fp),
            _ => Surface::matt(calm(class) * (0.8 + 0.4 * value3(a * 4.0, 21)), normal),
        };
        self.cover(&mut s, hit.p, if class == Class::Vegetation { 0.8 } else { 1.0 });
        s
    }

    fn plant(&self, a: Vec3, normal: Vec3, fp: f32) -> Surface {
        let tree = value2(a.truncate() * 0.16, 23);
        let hue = Vec3::new(0.050, 0.095, 0.022).lerp(Vec3::new(0.115, 0.135, 0.030), tree);
        let hue = hue.lerp(Vec3::new(0.030, 0.065, 0.025), value2(a.truncate() * 0.07, 24));
        let fine = visible(fp, 0.10);
        let leaf = value3(a * 9.0, 25) * fine + 0.5 * (1.0 - fine);
        let clump = value3(a * 2.3, 26);
        let mut s = Surface::matt(hue * (0.45 + 0.75 * leaf + 0.45 * clump), normal);
        let jitter = Vec3::new(
            value3(a * 13.0, 27) - 0.5,
            value3(a * 13.0, 28) - 0.5,
            value3(a * 13.0, 29) - 0.3,
        );
        s.normal = (normal + jitter * 0.9 * fine).normalize_or(normal);
        s.through = 0.35;
        s
    }

    fn structure(&self, hit: &Hit, a: Vec3, normal: Vec3, fp: f32) -> Surface {
        let Some(structure) = self.field.structure_at(hit.p) else {
            return Surface::matt(gray(0.35), normal);
        };
        if structure.thin {
            let lamp = structure.height_m > 3.9;
            let plates = [
                rgb(38, 72, 118),
                rgb(120, 124, 128),
                rgb(36, 88, 66),
                rgb(190, 192, 192),
            ];
            let plate = !lamp && structure.columns > 1 && hit.p.z > structure.height_m - 1.15;
            let paint = if plate {
                plates[structure.id as usize % 4]
            } else {
                gray(if lamp { 0.11 } else { 0.24 })
            };
            let mut s = Surface::matt(paint * (0.9 + 0.2 * value3(a * 5.0, 20)), normal);
            (s.mirror, s.gloss) = (0.03, 0.4);
            if self.air.lamps > 0.0 && lamp && hit.p.z > structure.height_m - 0.55 {
                s.emit = Vec3::new(1.0, 0.74, 0.42) * 3.5 * self.air.lamps;
            }
            return s;
        }
        let mut normal = normal;
        if normal.z > 0.62 {
            let c = gray(0.20) * (0.8 + 0.4 * value2(a.truncate() * 1.2, 19));
            return Surface::matt(c, Vec3::Z.lerp(normal, 0.4).normalize());
        }
        // The wall's own direction instead of the voxels' steps.
        let flat = normal.truncate().normalize_or(Vec2::X);
        let axes = [
            structure.axis,
            structure.axis.perp(),
            -structure.axis,
            -structure.axis.perp(),
        ];
        let wall = axes
            .into_iter()
            .max_by(|x, y| x.dot(flat).total_cmp(&y.dot(flat)))
            .unwrap_or(flat);
        let snapped = wall.dot(flat) > 0.62;
        if snapped {
            normal = wall.extend(0.0).lerp(normal, 0.06).normalize_or(normal);
        }
        let along = if snapped { wall.perp() } else { flat.perp() };
        let u = hit.p.truncate().dot(along);
        self.facade(structure, hit.p, Vec2::new(u, hit.p.z), a, normal, fp)
    }

    fn facade(&self, s: &Structure, p: Vec3, at: Vec2, a: Vec3, normal: Vec3, fp: f32) -> Surface {
        let walls = [
            rgb(198, 186, 164),
            rgb(166, 92, 70),
            rgb(214, 208, 198),
            rgb(150, 146, 140),
            rgb(188, 160, 122),
            rgb(122, 70, 56),
            rgb(176, 178, 180),
            rgb(222, 204, 168),
        ];
        let style = hash1(s.id, 1);
        let mut wall = walls[style as usize % walls.len()];
        let brick = matches!(style as usize % walls.len(), 1 | 5);
        wall *= 0.90 + 0.14 * value3(a * 0.35, 14) + 0.05 * (value3(a * 2.5, 15) - 0.5);
        wall *= 1.0 - 0.25 * ramp(0.9, 0.0, p.z) * (0.4 + 0.6 * value3(a * 1.2, 16));
        if brick {
            let row = (at.y / 0.085).floor();
            let joint = band(((at.y / 0.085) - row - 0.5).abs() - 0.40, 0.1, fp / 0.085);
            let tone = unit3(
                IVec3::new((at.x / 0.26 + 0.5 * (row % 2.0)).floor() as i32, row as i32, 3),
                17,
            );
            wall *= 1.0 + visible(fp, 0.09) * (0.34 * (tone - 0.5) - 0.12 * joint);
        } else {
            wall *= 1.0 + visible(fp, 0.05) * 0.12 * (value3(a * 24.0, 18) - 0.5);
        }
        let mut out = Surface::matt(wall, normal);
        if s.columns < 24 || s.height_m < 2.3 {
            // A wall, a shelter, a bench.
            return out;
        }
        let bay = 1.9 + 1.3 * unit(hash1(s.id, 2));
        let floor_m = 2.9 + 0.4 * unit(hash1(s.id, 3));
        let shop = s.height_m > 5.0 && hash1(s.id, 4).is_multiple_of(3);
        // A plinth below, a cornice under the roof.
        out.albedo *= 1.0 - 0.30 * band((at.y - 0.2).abs(), 0.3, fp);
        let cornice = band((s.height_m - 0.22 - at.y).abs(), 0.16, fp);
        out.albedo = out.albedo.lerp(gray(0.42), 0.6 * cornice);
        let (column, row) = ((at.x / bay).floor(), ((at.y - 0.25) / floor_m).floor());
        let f = Vec2::new(at.x / bay - column - 0.5, (at.y - 0.25) / floor_m - row - 0.5)
            * Vec2::new(bay, floor_m);
        // The top floor needs its whole height.
        if row < 0.0 || (row + 1.0) * floor_m + 0.1 > s.height_m.max(floor_m) {
            return out;
        }
        let ground_floor = row == 0.0;
        let (half, middle) = if ground_floor && shop {
            (Vec2::new(bay * 0.42, 1.05), -0.15)
        } else {
            (Vec2::new((bay * 0.29).min(0.75), 0.72), 0.12)
        };
        let q = Vec2::new(f.x.abs(), (f.y - middle).abs());
        let d = (q - half).max_element();
        // A sill and a frame around the glass, and bars across it.
        let frame = band((d - 0.03).abs(), 0.05, fp);
        let glass = ramp(0.004 + fp * 0.3, -0.004 - fp * 0.3, d);
        let trim = if unit(hash1(s.id, 5)) > 0.4 {
            gray(0.55)
        } else {
            gray(0.10)
        };
        out.albedo = out.albedo.lerp(trim, frame * 0.9);
        let sill = band((f.y - middle + half.y + 0.09).abs(), 0.05, fp) * band(q.x, half.x + 0.1, fp);
        out.albedo = out.albedo.lerp(gray(0.5), sill * 0.7);
        if glass > 0.0 {
            let cell = IVec3::new(column as i32, row as i32, s.id as i32);
            let bars = band(f.x.abs(), 0.03, fp).max(band((f.y - middle - 0.25).abs(), 0.025, fp));
            let blind = unit3(cell, 6);
            let drawn = f.y - middle > half.y * (1.0 - 2.0 * ramp(0.45, 1.0, blind));
            let inside = if drawn {
                gray(0.30) * Vec3::new(1.0, 0.96, 0.88)
            } else {
                gray(0.022)
            };
            let pane = inside.lerp(trim, bars * 0.8);
            out.albedo = out.albedo.lerp(pane, glass);
            out.mirror = 0.085 * glass * (1.0 - bars);
            out.gloss = 0.97;
            let lit = unit3(cell, 7);
            if self.air.lamps > 0.0 && lit < 0.38 {
                let warm = Vec3::new(1.0, 0.70, 0.38)
                    .lerp(Vec3::new(0.85, 0.92, 1.0), ramp(0.26, 0.3, unit3(cell, 8) * 0.4));
                let room = 0.55
                    + 0.45 * (1.0 - q.y / half.y)
                    + 0.25 * (value2(Vec2::new(f.x, f.y) * 2.5 + cell.x as f32 * 7.0, 9) - 0.5);
                let night = ramp(0.1, 1.0, self.air.lamps);
                out.emit = warm
                    * (room * glass * (1.0 - bars) * (0.15 + 0.55 * night) * if drawn { 0.55 } else { 1.0 });
            }
        }
        out
    }

    fn thing_surface(&self, t: &Thing, p: Vec3, n: Vec3, material: Material, fp: f32) -> Surface {
        let s = t.size;
        let mut out = Surface::matt(gray(0.1), n);
        let lamps = if t.lamps { self.air.lamps } else { 0.0 };
        let (x, y, z) = (p.x / s.x, p.y.abs() / (s.y / 2.0), p.z / s.z);
        match material {
            Material::Body => {
                out.albedo = t.paint;
                (out.mirror, out.gloss) = (0.05, 0.96);
                let r = (0.165 * s.z + 0.06).clamp(0.2, 0.42);
                for wheel in [-0.295, 0.3] {
                    let d = Vec2::new(p.x - wheel * s.x, p.z - r).length();
                    if d < r * 1.17 && n.y.abs() > 0.4 && t.class == Class::Car {
                        out.albedo = gray(0.006);
                        out.mirror = 0.0;
                    }
                }
                if z < 0.17 || (z < 0.25 && n.y.abs() > 0.6) {
                    out.albedo = gray(0.012);
                    out.mirror = 0.01;
                }
                if t.class != Class::Car {
                    return out;
                }
                // Gaps of the doors, and their handles.
                if n.y.abs() > 0.6 && z > 0.22 && z < 0.6 {
                    let gap = [0.185, -0.03, -0.225]
                        .iter()
                        .map(|g| (x - g).abs() * s.x)
                        .fold(9.0, f32::min);
                    out.albedo *= 1.0 - 0.75 * band(gap, 0.008, fp);
                    for door in [-0.005, -0.205] {
                        if (x - door).abs() < 0.016 && (z - 0.5).abs() < 0.010 {
                            out.albedo = gray(0.25);
                        }
                    }
                }
                if x > 0.45 && n.x > 0.2 {
                    if y < 0.60 && z > 0.22 && z < 0.40 {
                        out.albedo = gray(0.010 + 0.03 * f32::from(u8::from((p.z * 36.0).fract() > 0.6)));
                        out.mirror = 0.02;
                    }
                    if y < 0.30 && z > 0.25 && z < 0.32 {
                        out.albedo = gray(0.62);
                    }
                }
                let corner = x.abs() > 0.43 && y > 0.50 && n.x.abs() + n.y.abs() > 0.4;
                if x > 0.43 && corner && z > 0.365 && z < 0.455 {
                    out.albedo = gray(0.55);
                    (out.mirror, out.gloss) = (0.08, 0.97);
                    out.emit = Vec3::new(1.0, 0.95, 0.85) * 7.0 * lamps * ramp(0.2, 0.7, n.x);
                }
                if x < -0.455 && y > 0.48 && z > 0.40 && z < 0.535 && n.x < 0.3 {
                    out.albedo = Vec3::new(0.32, 0.008, 0.010);
                    (out.mirror, out.gloss) = (0.06, 0.95);
                    // Brighter towards the bulb in its middle.
                    let aside = ((z - 0.4675) / 0.0675).abs().max((y - 0.74).abs() / 0.26);
                    out.emit = TAIL * (0.03 + lamps * (0.40 + 0.85 * ramp(1.0, 0.25, aside)));
                }
                if x < -0.47 && n.x < -0.5 && y < 0.3 && z > 0.36 && z < 0.44 {
                    out.albedo = gray(0.62);
                    out.mirror = 0.0;
                }
            }
            Material::Cabin => {
                out.albedo = t.paint;
                (out.mirror, out.gloss) = (0.05, 0.96);
                let truck = t.class != Class::Car;
                let (low, high) = if truck { (0.48, 0.76) } else { (0.585, 0.925) };
                let glassy = z > low && z < high && n.z < 0.86;
                let across = 0.93 - 0.21 * ((z - 0.58) / 0.38).clamp(0.0, 1.0);
                let pane = if n.y.abs() > 0.75 {
                    // Side windows between pillars.
                    let pillars: &[f32] = if truck { &[0.9] } else { &[-0.035, -0.225] };
                    pillars.iter().all(|g| (x - g).abs() * s.x > 0.045)
                } else {
                    y < across * 0.94 || truck && y < 0.84
                };
                if glassy && pane {
                    out.albedo = gray(0.012);
                    (out.mirror, out.gloss) = (0.075, 0.99);
                }
                if truck && n.x > 0.5 && z < 0.34 {
                    out.albedo = gray(0.03);
                    if y > 0.58 && z > 0.2 && z < 0.28 {
                        out.albedo = gray(0.5);
                        out.emit = Vec3::new(1.0, 0.95, 0.85) * 7.0 * lamps;
                    }
                }
            }
            Material::Coach => {
                out.albedo = t.paint;
                (out.mirror, out.gloss) = (0.05, 0.93);
                if z < 0.16 {
                    out.albedo = gray(0.02);
                }
                let side = n.y.abs() > 0.6;
                let window = z > 0.40 && z < 0.74 && n.z.abs() < 0.5;
                let post = side && ((p.x / 1.45).fract().abs() - 0.5).abs() > 0.47;
                if window && !post && (side || y < 0.88) {
                    out.albedo = gray(0.014);
                    (out.mirror, out.gloss) = (0.075, 0.99);
                    out.emit = Vec3::new(1.0, 0.86, 0.62) * 0.16 * ramp(0.5, 1.0, self.air.lamps);
                }
                if z > 0.80 && z < 0.90 && n.x > 0.6 && y < 0.7 {
                    out.albedo = gray(0.01);
                    out.emit = Vec3::new(1.0, 0.55, 0.1)
                        * (0.25 + 1.2 * lamps)
                        * f32::from(u8::from(unit3((p * 22.0).floor().as_ivec3(), t.id) > 0.55));
                }
                for wheel in [-0.28, 0.33] {
                    if side && Vec2::new(p.x - wheel * s.x, p.z - 0.48).length() < 0.56 {
                        out.albedo = gray(0.006);
                        out.mirror = 0.0;
                    }
                }
                if n.x.abs() > 0.6 && y > 0.62 && z > 0.17 && z < 0.25 {
                    out.emit = if n.x > 0.0 {
                        Vec3::new(1.0, 0.95, 0.85) * 7.0
                    } else {
                        TAIL * 0.9
                    } * lamps;
                    out.albedo = if n.x > 0.0 {
                        gray(0.5)
                    } else {
                        Vec3::new(0.3, 0.01, 0.01)
                    };
                }
                if n.x > 0.6 && z > 0.30 && z < 0.74 && y < 0.9 {
                    out.albedo = gray(0.014);
                    (out.mirror, out.gloss) = (0.075, 0.99);
                    out.emit = Vec3::ZERO;
                }
            }
            Material::Cargo => {
                let rib = ((p.x / 0.42).fract().abs() - 0.5).abs();
                out.albedo = t.paint * (0.92 + 0.08 * unit(t.id));
                if n.y.abs() > 0.6 {
                    out.albedo *= 1.0 - 0.10 * visible(fp, 0.2) * ramp(0.40, 0.48, rib);
                }
                out.albedo *= 1.0 - 0.25 * ramp(0.55, 0.25, z) * value2(Vec2::new(p.x, p.z) * 2.0, t.id);
                (out.mirror, out.gloss) = (0.03, 0.6);
                if n.x < -0.6 && z < 0.36 && y > 0.68 {
                    out.albedo = Vec3::new(0.3, 0.01, 0.01);
                    out.emit = TAIL * (0.03 + 0.87 * lamps);
                }
                if n.x < -0.6 && y < 0.02 {
                    out.albedo *= 0.4;
                }
            }
            Material::Wheel => {
                out.albedo = gray(0.010);
                if n.y.abs() > 0.7 {
                    // A rim of five spokes inside the tyre.
                    let bike = t.class == Class::Bicycle;
                    let r = if t.class == Class::Car {
                        (0.165 * s.z + 0.06).clamp(0.2, 0.42)
                    } else {
                        p.z.max(0.3)
                    };
                    let near = [-0.295f32, 0.3]
                        .iter()
                        .map(|w| Vec2::new(p.x - w * s.x, p.z - r))
                        .min_by(|a, b| a.length().total_cmp(&b.length()));
                    if let (Some(q), true) = (near, t.class == Class::Car) {
                        let d = q.length() / r;
                        let spoke = (q.to_angle() * 5.0 / std::f32::consts::TAU).fract().abs();
                        if d < 0.70 && (!(0.2..=0.62).contains(&d) || (spoke - 0.5).abs() < 0.30) {
                            out.albedo = gray(0.34);
                            (out.mirror, out.gloss) = (0.10, 0.8);
                        }
                    }
                    if bike {
                        out.albedo = gray(0.04);
                    }
                }
            }
            Material::Dark => out.albedo = gray(0.022),
            Material::Plain(c) => {
                out.albedo = c;
                (out.mirror, out.gloss) = (0.03, 0.5);
            }
            Material::Cloth(c) => {
                let fold = value3(p * Vec3::new(14.0, 14.0, 7.0), t.id);
                out.albedo = c * (0.72 + 0.5 * fold);
            }
            Material::Skin => {
                out.albedo = [rgb(224, 172, 136), rgb(190, 130, 96), rgb(120, 78, 54)][t.id as usize % 3]
            }
            Material::Bands(c) => {
                let banded = if t.class == Class::TrafficCone {
                    (z > 0.42 && z < 0.60) || (z > 0.72 && z < 0.82)
                } else {
                    let wide = if s.y > s.x { p.y } else { p.x };
                    ((wide + p.z * 0.8) / 0.5).rem_euclid(1.0) < 0.5
                };
                out.albedo = if banded { gray(0.75) } else { c };
            }
        }
        out
    }
}

/// Colour of voxels that have no material of their own.
pub(super) fn calm(class: Class) -> Vec3 {
    let [r, g, b] = class.color();
    if class == Class::Others {
        rgb(104, 106, 104)
    } else {
        rgb(r, g, b).lerp(gray(0.2), 0.4)
    }
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
