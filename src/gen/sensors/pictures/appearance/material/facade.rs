//! Facades: walls with windows in bays and storeys, doors, shops, glass fronts and halls. A wall knows its own length, so bays
//! are centred on it and no window comes near a corner. `scenery_material.wgsl` has the same formulas.

use glam::{IVec3, Vec2, Vec3, Vec4};

use super::super::noise::{hash1, ramp, unit, unit3, value2, value3};
use super::super::prepared::Appearance;
use super::super::things::{DrawnObject, ObjectPart, rgb};
use super::{LitSurface, band, gray, visible};

/// Height of a storey, m.
const STOREY_M: f32 = 3.0;
/// Width at the ends of a wall without windows, m.
const CORNER_M: f32 = 0.45;
/// Number of colours of walls; the first are of brick.
pub(super) const WALLS: u32 = 12;
pub(super) const BRICKS: u32 = 4;

/// Colour of a wall.
pub(super) fn wall_color(style: u32) -> Vec3 {
    // Linear; brick, plaster and stone lie around the medians of `materials.json`.
    const COLORS: [[f32; 3]; WALLS as usize] = [
        [0.215, 0.125, 0.085],
        [0.160, 0.090, 0.066],
        [0.285, 0.204, 0.148],
        [0.130, 0.088, 0.072],
        [0.540, 0.510, 0.450],
        [0.420, 0.385, 0.310],
        [0.460, 0.360, 0.230],
        [0.330, 0.285, 0.230],
        [0.300, 0.310, 0.300],
        [0.560, 0.545, 0.510],
        [0.380, 0.270, 0.200],
        [0.225, 0.235, 0.230],
    ];
    Vec3::from(COLORS[style as usize % COLORS.len()])
}

/// From where to where a wall goes along `along`, seen from a point on it, m.
fn span(planes: &[Vec4], n: Vec3, along: Vec3, p: Vec3) -> (f32, f32) {
    let (mut low, mut high) = (-200.0f32, 200.0f32);
    for plane in planes {
        let side = plane.truncate();
        let rate = side.dot(along);
        if rate.abs() < 1e-3 || side.dot(n) > 0.9999 {
            continue;
        }
        let reach = (plane.w - side.dot(p)) / rate;
        match rate > 0.0 {
            true => high = high.min(reach),
            false => low = low.max(reach),
        }
    }
    (low.min(0.0), high.max(0.0))
}

impl Appearance {
    /// A point of a wall. `q` is the point in the noise of its building.
    pub(super) fn walls(
        &self,
        (t, part, walls): (&DrawnObject, &ObjectPart, Vec3),
        p: Vec3,
        n: Vec3,
        q: Vec3,
        fp: f32,
    ) -> LitSurface {
        let along = Vec3::new(-n.y, n.x, 0.0).normalize_or(Vec3::X);
        let (low, high) = match part {
            ObjectPart::Convex(planes) => span(planes, n, along, p),
            _ => (0.0, 0.0),
        };
        let (length, u, v) = (high - low, -low, p.z - t.floor_m);
        let (height, from, kind) = (walls.x, walls.y, walls.z);
        let style = hash1(t.id, 1) % WALLS;
        let hall = kind > 1.5;
        let mut wall = match hall {
            true => wall_color(BRICKS + style % (WALLS - BRICKS)) * 0.8,
            false => wall_color(style),
        };
        let stain = value3(q * 0.35, 14) + 0.5 * value3(q * 1.1, 15) + 0.25 * value3(q * 3.1, 13);
        wall *= 0.74 + 0.30 * stain;
        // Splashes from the ground, and streaks below the eaves.
        wall *= 1.0 - 0.28 * ramp(0.9, 0.0, v) * (0.4 + 0.6 * value3(q * 1.2, 16));
        let streak = value2(
            Vec2::new(q.truncate().dot(along.truncate()) * 2.2, q.z * 0.12),
            12,
        );
        wall *= 1.0 - 0.16 * ramp(2.2, 0.0, height - v) * ramp(0.45, 0.9, streak);
        if hall {
            let rib = ((u / 0.3).fract() - 0.5).abs();
            wall *= 1.0 - 0.22 * visible(fp, 0.16) * ramp(0.30, 0.45, rib);
        } else if style < BRICKS {
            let row = (v / 0.075).floor();
            let x = u / 0.25 + 0.5 * row.rem_euclid(2.0);
            let joint = band(0.5 - (v / 0.075 - row - 0.5).abs(), 0.08, fp / 0.075);
            let tone = unit3(IVec3::new(x.floor() as i32, row as i32, 3), t.id);
            wall *= 1.0 + visible(fp, 0.09) * (0.40 * (tone - 0.5) - 0.16 * joint);
        } else {
            wall *= 1.0 + visible(fp, 0.05) * 0.10 * (value3(q * 24.0, 18) - 0.5);
        }
        let mut out = LitSurface::matt(wall, n);
        if height < 2.4 {
            return out;
        }
        let plinth = ramp(0.5 + fp * 0.5, 0.49 - fp * 0.5, v);
        out.albedo = out
            .albedo
            .lerp(gray(0.16) * (0.8 + 0.4 * stain * 0.6), 0.75 * plinth);
        let cornice = band((height - 0.16 - v).abs(), 0.16, fp);
        out.albedo = out.albedo.lerp(gray(0.36), 0.55 * cornice);
        let bays = Bays::new(length, t.id, kind);
        let row = ((v - from) / STOREY_M).floor();
        if bays.count < 1.0 || row < 0.0 || (row + 1.0) * STOREY_M + from > height + 0.35 {
            return out;
        }
        // Over an arcade there is no ground floor.
        let height = if from > 0.0 { 0.0 } else { height };
        self.bay(&mut out, (t.id, kind), (&bays, u, row), v - from, height, fp);
        out
    }

    /// The window, door, gate or shop front around a point of a wall, if any.
    fn bay(
        &self,
        out: &mut LitSurface,
        (id, kind): (u32, f32),
        (bays, u, row): (&Bays, f32, f32),
        v: f32,
        height: f32,
        fp: f32,
    ) {
        let column = ((u - bays.margin) / bays.pitch)
            .floor()
            .clamp(0.0, bays.count - 1.0);
        let f = Vec2::new(
            u - bays.margin - (column + 0.5) * bays.pitch,
            v - (row + 0.5) * STOREY_M,
        );
        let cell = IVec3::new(column as i32, row as i32, id as i32);
        let ground_floor = row == 0.0 && height > 0.0;
        let (glass_front, hall) = (kind > 0.5 && kind < 1.5, kind > 1.5);
        let shop = ground_floor && !hall && height > 5.0 && hash1(id, 4).is_multiple_of(3);
        let in_the_middle = column == (bays.count / 2.0).floor();
        let door = ground_floor && !shop && !hall && in_the_middle && bays.count > 1.5;
        let gate = ground_floor && hall && (column as u32 + hash1(id, 9)).is_multiple_of(3);
        let (half, middle) = match () {
            () if gate => (Vec2::new((bays.pitch * 0.36).min(1.9), 1.35), -0.13),
            () if hall && ground_floor => return,
            () if hall => (Vec2::new(bays.pitch * 0.42, 0.45), 0.45),
            () if door => (Vec2::new(0.52, 1.08), -0.40),
            () if shop => (Vec2::new(bays.pitch * 0.42, 1.12), -0.22),
            () if glass_front => (Vec2::new(bays.pitch * 0.47, 1.22), 0.0),
            () => (Vec2::new((bays.pitch * 0.29).min(0.72), 0.72), 0.10),
        };
        let q = Vec2::new(f.x.abs(), (f.y - middle).abs());
        let d = (q - half).max_element();
        let trim = match unit(hash1(id, 5)) > 0.4 && !glass_front {
            true => gray(0.52),
            false => gray(0.05),
        };
        let frame = band((d - 0.03).abs(), 0.05, fp);
        out.albedo = out.albedo.lerp(trim, frame * 0.9);
        if !door && !gate && !glass_front {
            let sill = band((f.y - middle + half.y + 0.09).abs(), 0.05, fp) * band(q.x, half.x + 0.1, fp);
            out.albedo = out.albedo.lerp(gray(0.42), sill * 0.8);
        }
        let open = ramp(0.004 + fp * 0.3, -0.004 - fp * 0.3, d);
        if open <= 0.0 {
            return;
        }
        // The reveal shades the upper edge of what is set back.
        let shade = 1.0 - 0.55 * ramp(0.16, 0.02, middle + half.y - f.y);
        if door || gate {
            let colors = [
                rgb(78, 58, 44),
                rgb(54, 62, 56),
                rgb(60, 64, 74),
                rgb(132, 128, 120),
            ];
            let slat = match gate {
                true => ((f.y / 0.28).fract() - 0.5).abs(),
                false => (f.x.abs() - 0.25).abs() * 2.0,
            };
            let leaf = colors[(hash1(id, 10) % 4) as usize]
                * (1.0 - 0.3 * visible(fp, 0.12) * ramp(0.1, 0.02, slat));
            out.albedo = out.albedo.lerp(leaf * shade, open);
            (out.mirror, out.gloss) = (0.03 * open, 0.4);
            return;
        }
        let bars = match shop || glass_front {
            true => band((q.x - half.x / 2.0).abs(), 0.03, fp),
            false => band(f.x.abs(), 0.03, fp).max(band((f.y - middle - 0.25).abs(), 0.025, fp)),
        };
        let blind = unit3(cell, 6);
        let drawn = !shop && f.y - middle > half.y * (1.0 - 2.0 * ramp(0.45, 1.0, blind));
        let inside = match drawn {
            true => gray(0.28) * Vec3::new(1.0, 0.96, 0.88),
            false => gray(0.020),
        };
        out.albedo = out.albedo.lerp(inside.lerp(trim, bars * 0.8) * shade, open);
        out.mirror = 0.085 * open * (1.0 - bars);
        out.gloss = 0.97;
        let lit = unit3(cell, 7);
        if self.air.lamps > 0.0 && lit < 0.38 {
            let warm = Vec3::new(1.0, 0.70, 0.38)
                .lerp(Vec3::new(0.85, 0.92, 1.0), ramp(0.26, 0.3, unit3(cell, 8) * 0.4));
            let room =
                0.55 + 0.45 * (1.0 - q.y / half.y) + 0.25 * (value2(f * 2.5 + cell.x as f32 * 7.0, 9) - 0.5);
            let night = ramp(0.1, 1.0, self.air.lamps);
            let through = if drawn { 0.55 } else { 1.0 };
            // Curtains beside a window; shelves and what lies on them in a shop.
            let goods = value2(
                Vec2::new(f.x * 5.0 + cell.x as f32 * 3.0, (f.y / 0.42).floor() * 7.0),
                11,
            );
            let shelf = ((f.y / 0.42).fract().abs() - 0.5).abs();
            let in_room = match shop {
                true => (0.25 + 0.75 * goods) * (1.0 - 0.6 * ramp(0.40, 0.47, shelf)),
                false => 1.0 - 0.65 * ramp(half.x * 0.55, half.x * 0.8, q.x),
            };
            out.emit = warm * (room * in_room * open * (1.0 - bars) * (0.12 + 0.45 * night) * through);
        }
    }
}

/// Bays of a wall, centred on it.
struct Bays {
    count: f32,
    pitch: f32,
    /// From the end of the wall to the first bay, m.
    margin: f32,
}

impl Bays {
    /// Bays of a wall of some length, of a width that belongs to the building.
    fn new(length: f32, id: u32, kind: f32) -> Self {
        let wish = match kind {
            kind if kind > 1.5 => 4.6,
            kind if kind > 0.5 => 1.5,
            _ => 2.1 + 1.2 * unit(hash1(id, 2)),
        };
        let room = length - 2.0 * CORNER_M;
        let count = (room / wish).floor().max(0.0);
        Self {
            count,
            pitch: room / count.max(1.0),
            margin: CORNER_M,
        }
    }
}
