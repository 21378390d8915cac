//! What stands beside roads: buildings, trees, hedges, walls, poles, street furniture.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::draw::{Draw, noise};
use super::shapes::Solid;
use crate::scene::{BevLayer, BevLayout, BoxId, Class, GridSpec, PolylineKind, SceneBox};

/// Distance in cells from every cell to the nearest cell that is set, capped at 255 (chamfer 1, 1.4).
pub fn distance_cells(set: impl Fn(usize) -> bool) -> Vec<f32> {
    let (nx, ny) = (GridSpec::NX as i64, GridSpec::NY as i64);
    let mut d: Vec<f32> = (0..GridSpec::COLUMNS)
        .map(|c| if set(c) { 0.0 } else { 255.0 })
        .collect();
    let mut relax = |x: i64, y: i64, steps: [(i64, i64, f32); 4]| {
        let mut best = d[(x * ny + y) as usize];
        for (dx, dy, w) in steps {
            let (px, py) = (x + dx, y + dy);
            if (0..nx).contains(&px) && (0..ny).contains(&py) {
                best = best.min(d[(px * ny + py) as usize] + w);
            }
        }
        d[(x * ny + y) as usize] = best;
    };
    for x in 0..nx {
        for y in 0..ny {
            relax(
                x,
                y,
                [(-1, 0, 1.0), (0, -1, 1.0), (-1, -1, 1.414), (-1, 1, 1.414)],
            );
        }
    }
    for x in (0..nx).rev() {
        for y in (0..ny).rev() {
            relax(x, y, [(1, 0, 1.0), (0, 1, 1.0), (1, 1, 1.414), (1, -1, 1.414)]);
        }
    }
    d
}

struct Site<'a> {
    seed: u64,
    to_paved: Vec<f32>, // cells to the nearest road, car park or sidewalk
    to_road: Vec<f32>,
    to_box: Vec<f32>,
    out: &'a mut Vec<Solid>,
}

/// Appends scenery for the layout; keeps clear of roads, sidewalks and boxes.
pub fn scenery(layout: &BevLayout, boxes: &BTreeMap<BoxId, SceneBox>, seed: u64, out: &mut Vec<Solid>) {
    let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
    let paved = road | BevLayer::Walkway.bit();
    let mut box_cell = vec![false; GridSpec::COLUMNS];
    for b in boxes.values() {
        crate::scene::raster::box_cells(b, 0.0, |x, y| box_cell[x * GridSpec::NY + y] = true);
    }
    let cells = layout.cells();
    let mut site = Site {
        seed,
        to_paved: distance_cells(|c| cells[c] & paved != 0),
        to_road: distance_cells(|c| cells[c] & road != 0),
        to_box: distance_cells(|c| box_cell[c]),
        out,
    };
    let mut draw = Draw::new(seed, "scenery style");
    let (city, green) = (draw.unit(), draw.range(0.15, 1.0));
    site.buildings(city);
    site.trees(green, city);
    site.hedges_and_walls(green);
    site.poles(layout);
}

fn cell_center(c: usize) -> DVec2 {
    GridSpec::center(c / GridSpec::NY, c % GridSpec::NY, 0).truncate()
}

impl Site<'_> {
    fn at(&self, field: &[f32], p: DVec2) -> f32 {
        GridSpec::column_at(p.x, p.y).map_or(0.0, |[x, y]| field[x * GridSpec::NY + y])
    }

    /// True if a disc of `radius_m` is clear of paved ground by `gap_m` and of boxes.
    fn clear(&self, p: DVec2, radius_m: f64, gap_m: f64) -> bool {
        let cells = |m: f64| (m / GridSpec::VOXEL_M) as f32;
        self.at(&self.to_paved, p) > cells(radius_m + gap_m)
            && self.at(&self.to_box, p) > cells(radius_m + 0.4)
    }

    fn buildings(&mut self, city: f64) {
        let mut draw = Draw::new(self.seed, "buildings");
        let setback = draw.range(0.6, 4.0) + (1.0 - city) * 4.0;
        let tries = (260.0 * city) as usize + 30;
        let mut placed: Vec<(DVec2, f64)> = Vec::new();
        for _ in 0..tries {
            let p = DVec2::new(draw.range(-39.0, 39.0), draw.range(-39.0, 39.0));
            let size = DVec2::new(draw.range(6.0, 18.0), draw.range(6.0, 14.0));
            let height = if draw.chance(0.3) {
                draw.range(2.8, 4.6)
            } else {
                draw.range(5.0, 14.0)
            };
            let Some(axis) = self.away_from_road(p) else {
                continue;
            };
            // The facade looks at the road; the half depth must fit behind the setback.
            let room = f64::from(self.at(&self.to_paved, p)) * GridSpec::VOXEL_M;
            let half_depth = size.y / 2.0;
            if room < half_depth + setback || room > half_depth + setback + 9.0 {
                continue;
            }
            let radius = size.length() / 2.0 * 0.85;
            if placed.iter().any(|(q, r)| q.distance(p) < r + radius) {
                continue;
            }
            let footprint = |u: f64, v: f64| p + axis.perp() * (u * size.x / 2.0) + axis * (v * half_depth);
            let corners = [(-1.0, -1.0), (1.0, -1.0), (0.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
            if corners
                .iter()
                .any(|&(u, v)| !self.clear(footprint(u, v), 0.0, 0.8))
            {
                continue;
            }
            placed.push((p, radius));
            let base = p.extend(0.0);
            let body = DVec3::new(size.x, size.y, height);
            self.out
                .push(Solid::block(Class::Manmade, base, body, axis.perp()));
            if height < 7.0 && draw.chance(0.6) {
                // A pitched roof over the eaves.
                let eaves = DVec3::new(size.x + 0.6, size.y + 0.6, draw.range(1.2, 2.5));
                let roof = base + DVec3::Z * height;
                self.out.push(Solid::tapered(
                    Class::Manmade,
                    roof,
                    eaves,
                    DVec2::new(0.9, 0.05),
                    axis.perp(),
                ));
            }
            if draw.chance(0.25) {
                // A porch or canopy towards the road.
                let front = p - axis * (half_depth + 0.6);
                let canopy = DVec3::new(draw.range(2.0, 4.0), 1.4, 0.3);
                self.out.push(Solid::block(
                    Class::Manmade,
                    front.extend(2.6),
                    canopy,
                    axis.perp(),
                ));
            }
        }
    }

    /// Unit vector away from the nearest paved ground, by the gradient of the distance.
    fn away_from_road(&self, p: DVec2) -> Option<DVec2> {
        let h = 1.6;
        let d = |dx: f64, dy: f64| f64::from(self.at(&self.to_paved, p + DVec2::new(dx, dy)));
        let g = DVec2::new(d(h, 0.0) - d(-h, 0.0), d(0.0, h) - d(0.0, -h));
        (g.length() > 0.5).then(|| g.normalize())
    }

    fn inside_solid(&self, p: DVec2, margin: f64) -> bool {
        self.out.iter().any(|s| {
            let r = s.reach();
            s.class == Class::Manmade
                && (p - s.center.truncate())
                    .abs()
                    .cmple(r.truncate() + DVec2::splat(margin))
                    .all()
        })
    }

    fn tree(&mut self, p: DVec2, draw: &mut Draw) {
        let trunk = draw.range(1.6, 3.4);
        let crown = draw.range(1.2, 2.8);
        let base = p.extend(0.0);
        let radius = draw.range(0.14, 0.3);
        self.out.push(Solid::frustum(
            Class::Vegetation,
            base,
            trunk + crown,
            radius,
            radius * 0.6,
        ));
        // Boughs with gaps between them rather than one ball.
        for _ in 0..6 + draw.below(6) {
            let off = DVec3::new(
                draw.range(-1.0, 1.0),
                draw.range(-1.0, 1.0),
                draw.range(-0.4, 1.0),
            );
            let middle = base + DVec3::Z * (trunk + crown * 0.75) + off * (crown * 0.85);
            let radii = DVec3::new(1.0, draw.range(0.7, 1.3), draw.range(0.5, 0.9))
                * (crown * draw.range(0.22, 0.55));
            self.out
                .push(Solid::ellipsoid(Class::Vegetation, middle, radii, 0.45));
        }
    }

    fn trees(&mut self, green: f64, city: f64) {
        let mut draw = Draw::new(self.seed, "trees");
        // Loose trees behind the sidewalk, thicker away from the city.
        for _ in 0..(200.0 * green * (1.3 - city)) as usize + 12 {
            let p = DVec2::new(draw.range(-39.0, 39.0), draw.range(-39.0, 39.0));
            let grove = noise(self.seed, p.x / 18.0, p.y / 18.0) > -0.25;
            if grove && self.clear(p, 0.4, 0.3) && !self.inside_solid(p, 0.8) {
                self.tree(p, &mut draw);
            }
        }
        // Undergrowth: slim shrubs and saplings in patches.
        for _ in 0..(900.0 * green) as usize {
            let p = DVec2::new(draw.range(-39.5, 39.5), draw.range(-39.5, 39.5));
            let patch = noise(self.seed ^ 0x5eed, p.x / 7.0, p.y / 7.0) > 0.1;
            if patch && self.clear(p, 0.2, 0.2) && !self.inside_solid(p, 0.4) {
                let (height, radius) = (draw.range(0.5, 2.6), draw.range(0.12, 0.3));
                let stem = Solid::frustum(Class::Vegetation, p.extend(0.0), height, radius, radius * 0.7);
                self.out.push(stem);
            }
        }
        // An avenue along the kerb: trees in the outer half of the sidewalk.
        if draw.chance(0.5 * green) {
            let spacing = draw.range(7.0, 12.0);
            let mut planted: Vec<DVec2> = Vec::new();
            for c in 0..GridSpec::COLUMNS {
                let on_edge = self.to_paved[c] == 0.0 && (2.0..3.2).contains(&self.to_road[c]);
                let p = cell_center(c);
                let free = planted.iter().all(|q| q.distance(p) > spacing) && self.to_box[c] > 3.0;
                if on_edge && free && !self.inside_solid(p, 0.6) {
                    planted.push(p);
                }
            }
            for p in planted {
                self.tree(p, &mut draw);
            }
        }
    }

    fn hedges_and_walls(&mut self, green: f64) {
        let mut draw = Draw::new(self.seed, "hedges");
        for _ in 0..26 {
            let p = DVec2::new(draw.range(-39.0, 39.0), draw.range(-39.0, 39.0));
            let Some(axis) = self.away_from_road(p) else {
                continue;
            };
            let room = self.at(&self.to_paved, p);
            if !(2.0..14.0).contains(&room) {
                continue;
            }
            let along = axis.perp();
            let is_hedge = draw.chance(0.4 + 0.4 * green);
            let height = if is_hedge {
                draw.range(0.7, 1.6)
            } else {
                draw.range(0.8, 2.2)
            };
            for i in 0..4 + draw.below(9) {
                let q = p + along * (i as f64 * 1.2);
                if !self.clear(q, 0.5, 0.0) || self.inside_solid(q, 0.5) {
                    continue;
                }
                if is_hedge {
                    let radii = DVec3::new(0.9, 0.9, height);
                    self.out
                        .push(Solid::ellipsoid(Class::Vegetation, q.extend(0.0), radii, 0.2));
                } else {
                    let size = DVec3::new(1.25, 0.25, height);
                    self.out
                        .push(Solid::block(Class::Manmade, q.extend(0.0), size, along));
                }
            }
        }
    }

    fn poles(&mut self, layout: &BevLayout) {
        let mut draw = Draw::new(self.seed, "poles");
        let spacing = draw.range(12.0, 25.0);
        let mut stood: Vec<DVec2> = Vec::new();
        let lanes = layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter);
        let near_lane: Vec<DVec2> = lanes.flat_map(|l| l.points_m.iter().copied()).collect();
        for c in (0..GridSpec::COLUMNS).step_by(3) {
            if !(1.2..2.5).contains(&self.to_road[c]) || self.to_box[c] < 2.0 {
                continue;
            }
            let p = cell_center(c);
            if stood.iter().any(|q| q.distance(p) < spacing) || self.inside_solid(p, 0.3) {
                continue;
            }
            stood.push(p);
            let lane = near_lane
                .iter()
                .copied()
                .min_by(|a, b| a.distance(p).total_cmp(&b.distance(p)));
            let toward = lane.map_or(DVec2::X, |l| (l - p).normalize_or(DVec2::X));
            let base = p.extend(0.0);
            match draw.weighted(&[0.43, 0.29, 0.15, 0.13]) {
                0 => {
                    // Street lamp with an arm over the road.
                    let height = draw.range(4.6, 7.0);
                    self.out
                        .push(Solid::frustum(Class::Manmade, base, height, 0.12, 0.08));
                    let arm = DVec3::new(1.8, 0.2, 0.2);
                    let middle = (p + toward * 0.8).extend(height - 0.2);
                    self.out.push(Solid::block(Class::Manmade, middle, arm, toward));
                }
                1 => {
                    // Sign.
                    let height = draw.range(2.2, 3.0);
                    self.out
                        .push(Solid::frustum(Class::Manmade, base, height, 0.05, 0.05));
                    let plate = DVec3::new(0.1, 0.7, 0.7);
                    self.out.push(Solid::block(
                        Class::Manmade,
                        p.extend(height - 0.6),
                        plate,
                        toward.perp(),
                    ));
                }
                2 => {
                    // Bench or shelter.
                    let size = DVec3::new(1.8, 0.6, draw.range(0.5, 2.4));
                    self.out
                        .push(Solid::block(Class::Manmade, base, size, toward.perp()));
                }
                _ => {
                    // Bin, box or bag: what nuScenes calls "others".
                    let height = draw.range(0.6, 1.1);
                    self.out
                        .push(Solid::frustum(Class::Others, base, height, 0.4, 0.4));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_zero_on_the_set_and_grows() {
        let d = distance_cells(|c| c == 100 * GridSpec::NY + 100);
        assert_eq!(d[100 * GridSpec::NY + 100], 0.0);
        assert_eq!(d[100 * GridSpec::NY + 110], 10.0);
        assert!((d[103 * GridSpec::NY + 104] - 5.0).abs() < 0.5);
    }
}
