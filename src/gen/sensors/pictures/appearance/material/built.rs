//! Voxels: facades with windows, leaves and bark, and voxels without a material of their own.

use glam::{IVec3, Vec2, Vec3};

use super::super::field::Structure;
use super::super::noise::{hash1, ramp, unit, unit3, value2, value3};
use super::super::prepared::{Appearance, SurfaceHit};
use super::super::things::rgb;
use super::facade::{BRICKS, WALLS, wall_color};
use super::{LitSurface, band, calm, gray, visible};
use scene::Class;
use scene::appearance::TRUNK;

impl Appearance {
    pub(super) fn voxel_surface(&self, hit: &SurfaceHit, label: u8, normal: Vec3, fp: f32) -> LitSurface {
        let a = self.anchor(hit.p);
        let class = Class::from_id(label).unwrap_or(Class::Others);
        let mut s = match class {
            _ if label == TRUNK => {
                let bark = value3(a * Vec3::new(14.0, 14.0, 3.0), 22);
                LitSurface::matt(Vec3::new(0.105, 0.080, 0.058) * (0.55 + 0.9 * bark), normal)
            }
            Class::Vegetation => self.plant(a, normal, fp),
            Class::Manmade => self.structure(hit, a, normal, fp),
            _ => LitSurface::matt(calm(class) * (0.8 + 0.4 * value3(a * 4.0, 21)), normal),
        };
        self.cover(&mut s, hit.p, if class == Class::Vegetation { 0.8 } else { 1.0 });
        s
    }

    fn plant(&self, a: Vec3, normal: Vec3, fp: f32) -> LitSurface {
        let tree = value2(a.truncate() * 0.16, 23);
        let hue = Vec3::new(0.046, 0.082, 0.022).lerp(Vec3::new(0.082, 0.108, 0.030), tree);
        let hue = hue.lerp(Vec3::new(0.030, 0.065, 0.025), value2(a.truncate() * 0.07, 24));
        let fine = visible(fp, 0.10);
        let leaf = value3(a * 9.0, 25) * fine + 0.5 * (1.0 - fine);
        let clump = value3(a * 2.3, 26);
        let mut s = LitSurface::matt(hue * (0.45 + 0.75 * leaf + 0.45 * clump), normal);
        let jitter = Vec3::new(
            value3(a * 13.0, 27) - 0.5,
            value3(a * 13.0, 28) - 0.5,
            value3(a * 13.0, 29) - 0.3,
        );
        s.normal = (normal + jitter * 0.9 * fine).normalize_or(normal);
        s.through = 0.35;
        s
    }

    fn structure(&self, hit: &SurfaceHit, a: Vec3, normal: Vec3, fp: f32) -> LitSurface {
        let Some(structure) = self.field.structure_at(hit.p) else {
            return LitSurface::matt(gray(0.35), normal);
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
            let mut s = LitSurface::matt(paint * (0.9 + 0.2 * value3(a * 5.0, 20)), normal);
            (s.mirror, s.gloss) = (0.03, 0.4);
            if self.air.lamps > 0.0 && lamp && hit.p.z > structure.height_m - 0.55 {
                s.emit = Vec3::new(1.0, 0.74, 0.42) * 3.5 * self.air.lamps;
            }
            return s;
        }
        let mut normal = normal;
        if normal.z > 0.62 {
            let c = gray(0.20) * (0.8 + 0.4 * value2(a.truncate() * 1.2, 19));
            return LitSurface::matt(c, Vec3::Z.lerp(normal, 0.4).normalize());
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

    fn facade(&self, s: &Structure, p: Vec3, at: Vec2, a: Vec3, normal: Vec3, fp: f32) -> LitSurface {
        let style = hash1(s.id, 1) % WALLS;
        let mut wall = wall_color(style);
        let brick = style < BRICKS;
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
        let mut out = LitSurface::matt(wall, normal);
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
}
