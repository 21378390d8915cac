//! Places traffic on a layout: moving and parked vehicles, people, cones, barriers.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::template::offset_line;
use scene::draw::Draw;
use scene::raster::box_cells;
use scene::{BevLayer, BevLayout, BoxId, BoxLabel, Class, Extent, PolylineKind, SceneBox, Window};

/// Least distance of boxes to the rim of the map, m.
const RIM_M: f64 = 0.5;

/// Amount of each kind of traffic, 1 = as on an ordinary city street.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrafficSpec {
    /// Vehicles on lanes and in parking places.
    pub vehicles: f64,
    /// Pedestrians and two-wheelers.
    pub people: f64,
    /// Construction sites: barriers, cones, machines.
    pub works: f64,
}

impl TrafficSpec {
    /// An ordinary street.
    pub const NORMAL: Self = Self {
        vehicles: 1.0,
        people: 1.0,
        works: 1.0,
    };
    /// No traffic.
    pub const EMPTY: Self = Self {
        vehicles: 0.0,
        people: 0.0,
        works: 0.0,
    };
}

struct TrafficPlacer<'a> {
    layout: &'a BevLayout,
    draw: Draw,
    taken: Vec<bool>,
    clearance_m: f64, // around every box
    boxes: BTreeMap<BoxId, SceneBox>,
}

/// Boxes for a layout, drawn from `seed`; none overlap, none stands on the ego vehicle.
pub fn place(layout: &BevLayout, seed: u64, spec: &TrafficSpec) -> BTreeMap<BoxId, SceneBox> {
    let mut p = TrafficPlacer {
        layout,
        draw: Draw::new(seed, "traffic"),
        taken: vec![false; layout.extent().columns()],
        clearance_m: 0.35,
        boxes: BTreeMap::new(),
    };
    p.keep_ego_clear();
    p.driving(spec.vehicles);
    p.parked(spec.vehicles);
    p.works(spec.works);
    p.people(spec.people);
    p.boxes
}

impl TrafficPlacer<'_> {
    fn keep_ego_clear(&mut self) {
        let ego = SceneBox {
            id: BoxId(0),
            class: Class::Car,
            center_m: DVec3::new(1.5, 0.0, 0.8),
            size_m: DVec3::new(7.0, 2.8, 1.6),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: BoxLabel::default(),
        };
        let (extent, taken) = (self.layout.extent(), &mut self.taken);
        box_cells(extent, &ego, 0.0, |x, y| taken[extent.index(x, y)] = true);
    }

    /// Adds the box unless it leaves the grid, overlaps another or `on` refuses a cell of it.
    fn try_add(
        &mut self,
        class: Class,
        at: DVec2,
        yaw_rad: f64,
        speed: f64,
        on: impl Fn(u32) -> bool,
    ) -> bool {
        let typical = DVec3::from_array(class.typical_size_m().expect("an object class"));
        let draw = &mut self.draw;
        let spread = if class.is_vehicle() { 0.1 } else { 0.12 };
        let size_m = typical
            * DVec3::new(
                draw.range(1.0 - spread, 1.0 + spread),
                draw.range(0.95, 1.05),
                draw.range(1.0 - spread, 1.0 + spread),
            );
        let b = SceneBox {
            id: BoxId(self.boxes.len() as u32 + 1),
            class,
            center_m: at.extend(self.layout.relief.height_m(at) + size_m.z / 2.0),
            size_m,
            yaw_rad,
            velocity_mps: DVec2::from_angle(yaw_rad) * speed,
            label: BoxLabel::default(),
        };
        let extent = self.layout.extent();
        let inside = b.footprint().iter().all(|c| self.on_map(*c, RIM_M));
        // Boxes on ground that leaves the grid would not be visible in it.
        let (low, high) = (b.center_m.z - size_m.z / 2.0, b.center_m.z + size_m.z / 2.0);
        if !inside || low < Window::MIN_M[2] || high > Window::MAX_M[2] {
            return false;
        }
        let mut free = true;
        let mut cells = Vec::new();
        box_cells(extent, &b, self.clearance_m, |x, y| {
            free &= !self.taken[extent.index(x, y)];
            cells.push(extent.index(x, y));
        });
        box_cells(extent, &b, 0.0, |x, y| free &= on(self.layout.cell(x, y)));
        if free {
            cells.into_iter().for_each(|c| self.taken[c] = true);
            self.boxes.insert(b.id, b);
        }
        free
    }

    fn driving(&mut self, amount: f64) {
        if amount <= 0.0 {
            return;
        }
        let layout = self.layout;
        let busy = self.draw.range(0.2, 1.0) * amount;
        for lane in layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter)
        {
            // Gaps of 7 m in a queue up to 60 m on an empty road.
            let (free, queue) = (self.draw.range(4.0, 40.0), self.draw.chance(0.1 * amount));
            let gap = if queue { 7.4 } else { 6.5 + free / busy.max(0.05) };
            let mut next = self.draw.range(0.0, gap);
            let mut along = 0.0;
            for pair in lane.points_m.windows(2) {
                let (d, length) = ((pair[1] - pair[0]).normalize_or_zero(), pair[0].distance(pair[1]));
                while next < along + length && d != DVec2::ZERO {
                    let class = [
                        Class::Car,
                        Class::Truck,
                        Class::Bus,
                        Class::Trailer,
                        Class::Motorcycle,
                        Class::Bicycle,
                        Class::ConstructionVehicle,
                    ][self.draw.weighted(&[0.72, 0.13, 0.05, 0.05, 0.03, 0.01, 0.01])];
                    let at = pair[0] + d * (next - along) + d.perp() * self.draw.range(-0.4, 0.4);
                    let (stands, moving) = (self.draw.chance(0.3), self.draw.range(2.0, 14.0));
                    let speed = if stands || queue { 0.0 } else { moving };
                    let yaw = d.to_angle() + self.draw.range(-0.03, 0.03);
                    let road = BevLayer::DrivableArea.bit();
                    self.try_add(class, at, yaw, speed, |cell| cell & road != 0);
                    let spread = self.draw.range(0.5, 1.6);
                    next += gap * if queue { 0.9 + 0.15 * spread } else { spread };
                }
                along += length;
            }
        }
    }

    fn parked(&mut self, amount: f64) {
        let lot = BevLayer::CarparkArea.bit();
        // Along lanes: beside the outermost lane where a parking strip runs.
        let share = self.draw.range(0.2, 0.9) * amount;
        let layout = self.layout;
        for lane in layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter)
        {
            for side in [-1.0, 1.0] {
                let strip = offset_line(&lane.points_m, side * 3.2);
                let mut left = self.draw.range(0.0, 6.0);
                for pair in strip.windows(2) {
                    left -= pair[0].distance(pair[1]);
                    if left <= 0.0 {
                        left = 5.6;
                        let d = (pair[1] - pair[0]).normalize_or(DVec2::X);
                        if self.draw.chance(share) {
                            let class = if self.draw.chance(0.93) {
                                Class::Car
                            } else {
                                Class::Truck
                            };
                            self.try_add(class, pair[0], d.to_angle(), 0.0, |cell| cell & lot != 0);
                        }
                    }
                }
            }
        }
        // In car parks: rows of places at right angles to the nearest road.
        let cells = self.cells_with(lot);
        self.parked_rows(&cells, share);
    }

    /// Bays in double rows with aisles between them, over all car parks; `share` of them are taken.
    fn parked_rows(&mut self, cells: &[usize], share: f64) {
        const BAY_M: DVec2 = DVec2::new(2.6, 5.2);
        const AISLE_M: f64 = 6.0;
        let (Some(first), lot) = (cells.first(), BevLayer::CarparkArea.bit()) else {
            return;
        };
        let extent = self.layout.extent();
        let center = |c: usize| center_m(extent, c);
        let middle = cells.iter().map(|c| center(*c)).sum::<DVec2>() / cells.len() as f64;
        let along = DVec2::from_angle(self.heading_near(middle).unwrap_or(0.0));
        // Rows are counted from one corner of the lot, so that they run the whole of it.
        let origin = center(*first) + along.perp() * self.draw.range(0.0, 3.0);
        let period = 2.0 * BAY_M.y + AISLE_M;
        let usual_m = std::mem::replace(&mut self.clearance_m, 0.1); // doors barely open
        for row in -16..16 {
            for half in [-0.5, 0.5] {
                let v = f64::from(row) * period + half * BAY_M.y;
                for bay in -32..32 {
                    let (taken, jitter) = (self.draw.chance(share), self.draw.range(-0.2, 0.2));
                    let (nose_in, turn) = (self.draw.chance(0.7), self.draw.range(-0.05, 0.05));
                    let at = origin + along * (f64::from(bay) * BAY_M.x) + along.perp() * (v + jitter);
                    if !taken || !self.on_map(at, 1.0) {
                        continue;
                    }
                    let facing = if nose_in == (half > 0.0) { -1.0 } else { 1.0 };
                    let yaw = (along.perp() * facing).to_angle() + turn;
                    self.try_add(Class::Car, at, yaw, 0.0, |cell| cell & lot != 0);
                }
            }
        }
        self.clearance_m = usual_m;
    }

    fn works(&mut self, amount: f64) {
        if !self.draw.chance(0.6 * amount) {
            return;
        }
        let road = BevLayer::DrivableArea.bit();
        let cells: Vec<usize> = self.cells_with(road);
        if cells.is_empty() {
            return;
        }
        let c = cells[self.draw.below(cells.len())];
        let start = center_m(self.layout.extent(), c);
        let yaw = self.heading_near(start).unwrap_or(0.0);
        let d = DVec2::from_angle(yaw);
        let class = if self.draw.chance(0.6) {
            Class::Barrier
        } else {
            Class::TrafficCone
        };
        let step = if class == Class::Barrier { 2.9 } else { 2.2 };
        for i in 0..8 + self.draw.below(18) {
            let turn = if class == Class::Barrier {
                std::f64::consts::FRAC_PI_2
            } else {
                0.0
            };
            let jitter = self.draw.range(-0.15, 0.15);
            self.try_add(
                class,
                start + d * (i as f64 * step) + d.perp() * jitter,
                yaw + turn,
                0.0,
                |cell| cell & road != 0,
            );
        }
        if self.draw.chance(0.35) {
            let side = if self.draw.chance(0.5) { 3.5 } else { -3.5 };
            let at = start + d * self.draw.range(4.0, 12.0) + d.perp() * side;
            self.try_add(Class::ConstructionVehicle, at, yaw, 0.0, |cell| cell & road != 0);
        }
    }

    fn people(&mut self, amount: f64) {
        if amount <= 0.0 {
            return;
        }
        let walk = BevLayer::Walkway.bit() | BevLayer::PedCrossing.bit();
        let cells = self.cells_with(walk);
        if cells.is_empty() {
            return;
        }
        // Equal numbers per 80 m of a long road.
        let windows = (self.layout.extent().columns() as f64 / Window::COLUMNS as f64).max(1.0);
        let busy = (self.draw.unit().powi(2) * 40.0 * amount * windows) as usize + 1;
        // Sometimes a crowd: an event, a stop, a school.
        let crowd = if self.draw.chance(0.12 * amount) {
            12 + self.draw.below(30)
        } else {
            0
        };
        let centre = cells[self.draw.below(cells.len())];
        for i in 0..busy + crowd {
            let any = cells[self.draw.below(cells.len())];
            let p = |c: usize| center_m(self.layout.extent(), c);
            let spread = DVec2::from_angle(self.draw.range(0.0, 6.3)) * self.draw.range(0.3, 6.5);
            let p = if i < busy { p(any) } else { p(centre) + spread };
            let jitter = DVec2::new(self.draw.range(-0.2, 0.2), self.draw.range(-0.2, 0.2));
            let yaw = self.draw.range(-3.1, 3.1);
            let speed = if self.draw.chance(0.6) {
                self.draw.range(0.6, 1.8)
            } else {
                0.0
            };
            let class = [Class::Pedestrian, Class::Bicycle, Class::Motorcycle]
                [self.draw.weighted(&[0.94, 0.03, 0.03])];
            self.try_add(class, p + jitter, yaw, speed, |cell| cell & walk != 0);
        }
    }

    /// True if a point lies on the map and is farther than `rim_m` from its rim.
    fn on_map(&self, p: DVec2, rim_m: f64) -> bool {
        let extent = self.layout.extent();
        let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
        (p - low).min_element() > rim_m && (high - p).min_element() > rim_m
    }

    fn cells_with(&self, bits: u32) -> Vec<usize> {
        let cells = self.layout.cells().iter().enumerate();
        cells
            .filter(|(_, cell)| **cell & bits != 0)
            .map(|(c, _)| c)
            .collect()
    }

    fn heading_near(&self, p: DVec2) -> Option<f64> {
        let lanes = self
            .layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter);
        let segments = lanes.flat_map(|l| l.points_m.windows(2));
        let nearest =
            segments.min_by(|a, b| a[0].distance_squared(p).total_cmp(&b[0].distance_squared(p)))?;
        Some((nearest[1] - nearest[0]).to_angle())
    }
}

/// Centre of a cell, m.
fn center_m(extent: Extent, cell: usize) -> DVec2 {
    let [x, y] = extent.column(cell);
    extent.center(x, y, 0).truncate()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;

    #[test]
    fn boxes_are_sound_apart_and_repeatable() {
        let mut cars = 0;
        for seed in 0..30 {
            let layout = template::any_layout(seed);
            let boxes = place(&layout, seed, &TrafficSpec::NORMAL);
            assert_eq!(boxes, place(&layout, seed, &TrafficSpec::NORMAL));
            let mut owner = vec![None; Window::COLUMNS];
            for b in boxes.values() {
                assert_eq!(b.problem(), None);
                cars += usize::from(b.class == Class::Car);
                box_cells(Extent::WINDOW, b, 0.0, |x, y| {
                    let cell = &mut owner[x * Window::NY + y];
                    assert!(cell.is_none(), "boxes {cell:?} and {:?} overlap", b.id);
                    *cell = Some(b.id);
                });
            }
        }
        assert!(
            (90..1100).contains(&cars),
            "{cars} cars in 30 frames, real: 3 to 37 a frame"
        );
        assert!(place(&template::any_layout(1), 1, &TrafficSpec::EMPTY).is_empty());
    }

    #[test]
    fn traffic_stands_on_the_ground_and_inside_the_grid() {
        let mut seen = 0;
        for seed in 0..6 {
            let mut layout = template::any_layout(seed);
            layout.relief = scene::Relief::from_fn(Extent::WINDOW, |p| 0.12 * p.x);
            for b in place(&layout, seed, &TrafficSpec::NORMAL).values() {
                let low = b.center_m.z - b.size_m.z / 2.0;
                assert!((low - 0.12 * b.center_m.x).abs() < 1e-3, "{b:?}");
                assert!(
                    low >= Window::MIN_M[2] && low + b.size_m.z <= Window::MAX_M[2],
                    "{b:?}"
                );
                seen += usize::from(b.center_m.x.abs() > 5.0);
            }
        }
        assert!(seen > 10, "{seen} boxes on the slope");
    }
}
