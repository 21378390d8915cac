//! The ground that scenery is put on: distances to areas that must stay clear, and the cells that are taken.

use std::collections::BTreeMap;

use glam::DVec2;

use super::setting::{RoadsideStyle, Style};
use scene::raster::{box_cells, disc_cells, line_cells, polygon_cells};
use scene::road_map::RoadMap;
use scene::{Background, BevLayer, BevLayout, BoxId, Extent, Form, SceneBox, Window};

/// Distance in cells from every cell of a map to the nearest cell that is set, capped at 255 (chamfer 1, 1.4).
pub fn distance_cells(extent: Extent, set: impl Fn(usize) -> bool) -> Vec<f32> {
    const FAR: f32 = 255.0;
    const DIAGONAL: f32 = 1.414;
    let (nx, ny) = (extent.nx(), extent.ny());
    // A border of cells that are never nearest saves tests in the loops.
    let row = ny + 2;
    let mut d = vec![2.0 * FAR; (nx + 2) * row];
    for x in 0..nx {
        for y in 0..ny {
            d[(x + 1) * row + y + 1] = if set(x * ny + y) { 0.0 } else { FAR };
        }
    }
    let mut passed = vec![0.0f32; row];
    // Forwards from the row before, then backwards from the row after.
    for x in 1..=nx {
        let (before, here) = d.split_at_mut(x * row);
        let before = &before[(x - 1) * row..];
        let here = &mut here[..row];
        for (y, out) in passed.iter_mut().enumerate().take(ny + 1).skip(1) {
            let diagonal = before[y - 1].min(before[y + 1]) + DIAGONAL;
            *out = here[y].min(before[y] + 1.0).min(diagonal);
        }
        for y in 1..=ny {
            here[y] = passed[y].min(here[y - 1] + 1.0);
        }
    }
    for x in (1..=nx).rev() {
        let (here, after) = d.split_at_mut((x + 1) * row);
        let here = &mut here[x * row..];
        let after = &after[..row];
        for (y, out) in passed.iter_mut().enumerate().take(ny + 1).skip(1) {
            let diagonal = after[y - 1].min(after[y + 1]) + DIAGONAL;
            *out = here[y].min(after[y] + 1.0).min(diagonal);
        }
        for y in (1..=ny).rev() {
            here[y] = passed[y].min(here[y + 1] + 1.0);
        }
    }
    (0..nx)
        .flat_map(|x| d[(x + 1) * row + 1..][..ny].iter().copied())
        .collect()
}

/// A layout with room for scenery.
pub(super) struct ScenerySite<'a> {
    pub seed: u64,
    pub layout: &'a BevLayout,
    style: &'a Style,
    roads: RoadMap,
    to_paved: Vec<f32>, // cells to the nearest road, car park or sidewalk
    to_road: Vec<f32>,
    to_box: Vec<f32>,
    taken: Vec<bool>, // by things
    pub out: Background,
}

impl<'a> ScenerySite<'a> {
    pub fn new(
        layout: &'a BevLayout,
        boxes: &BTreeMap<BoxId, SceneBox>,
        style: &'a Style,
        seed: u64,
    ) -> Self {
        let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
        let paved = road | BevLayer::Walkway.bit();
        let mut box_cell = vec![false; Window::COLUMNS];
        for b in boxes.values() {
            box_cells(Extent::WINDOW, b, 0.0, |x, y| box_cell[x * Window::NY + y] = true);
        }
        let cells = layout.cells();
        Self {
            seed,
            layout,
            style,
            roads: RoadMap::new(layout),
            to_paved: distance_cells(Extent::WINDOW, |c| cells[c] & paved != 0),
            to_road: distance_cells(Extent::WINDOW, |c| cells[c] & road != 0),
            to_box: distance_cells(Extent::WINDOW, |c| box_cell[c]),
            taken: vec![false; Window::COLUMNS],
            out: Background::default(),
        }
    }

    /// The side of the ego's road that a point lies on.
    pub fn side(&self, p: DVec2) -> &RoadsideStyle {
        match self.roads.along_ego_lane(p).y >= 0.0 {
            true => &self.style.left,
            false => &self.style.right,
        }
    }

    fn at(field: &[f32], p: DVec2) -> f64 {
        // Blended between cell centres, so that lines at a distance run straight.
        let u = Window::to_voxel_units(p.extend(0.0)).truncate() - DVec2::splat(0.5);
        let limit = |v: f64, n: usize| v.clamp(0.0, (n - 1) as f64);
        let (x, y) = (limit(u.x, Window::NX), limit(u.y, Window::NY));
        let (x0, y0) = ((x as usize).min(Window::NX - 2), (y as usize).min(Window::NY - 2));
        let (tx, ty) = (x - x0 as f64, y - y0 as f64);
        let f = |i: usize, j: usize| f64::from(field[i * Window::NY + j]);
        let low = f(x0, y0) * (1.0 - tx) + f(x0 + 1, y0) * tx;
        let high = f(x0, y0 + 1) * (1.0 - tx) + f(x0 + 1, y0 + 1) * tx;
        (low * (1.0 - ty) + high * ty) * Window::VOXEL_M
    }

    /// Distance to the nearest road, car park or sidewalk, m.
    pub fn paved_m(&self, p: DVec2) -> f64 {
        Self::at(&self.to_paved, p)
    }

    /// Distance of a cell to the nearest road, car park or sidewalk, m.
    pub fn cell_to_paved_m(&self, cell: usize) -> f64 {
        f64::from(self.to_paved[cell]) * Window::VOXEL_M
    }

    /// Distance to the nearest road or car park, m.
    pub fn road_m(&self, p: DVec2) -> f64 {
        Self::at(&self.to_road, p)
    }

    /// Distance to the nearest box, m.
    pub fn box_m(&self, p: DVec2) -> f64 {
        Self::at(&self.to_box, p)
    }

    /// Direction towards the nearest lane, for lamps and signs.
    pub fn toward_lane(&self, p: DVec2) -> DVec2 {
        let lane = self.roads.nearest_lane(p);
        lane.map_or(DVec2::X, |l| (l.position_m - p).normalize_or(DVec2::X))
    }

    /// Unit vector away from the nearest paved ground, by the gradient of the distance.
    pub fn away(&self, p: DVec2) -> Option<DVec2> {
        let h = 1.8;
        let d = |dx: f64, dy: f64| self.paved_m(p + DVec2::new(dx, dy));
        let g = DVec2::new(d(h, 0.0) - d(-h, 0.0), d(0.0, h) - d(0.0, -h));
        (g.length() > 0.8).then(|| g.normalize())
    }

    /// True if no cell within a disc is taken and boxes are further away.
    pub fn free(&self, p: DVec2, radius_m: f64) -> bool {
        if self.box_m(p) < radius_m + 0.4 {
            return false;
        }
        let mut free = true;
        disc_cells(Extent::WINDOW, p, radius_m, |x, y| {
            free &= !self.taken[x * Window::NY + y]
        });
        free
    }

    /// True if no cell of an outline is taken, paved within `gap_m`, or near a box. Parts outside the grid count as free.
    pub fn free_outline(&self, outline_m: &[DVec2], gap_m: f64) -> bool {
        let mut free = true;
        let gap = (gap_m / Window::VOXEL_M) as f32;
        polygon_cells(Extent::WINDOW, outline_m, |x, y| {
            let c = x * Window::NY + y;
            free &= !self.taken[c] && self.to_paved[c] > gap && self.to_box[c] > 2.0;
        });
        free
    }

    /// Adds a thing and marks its ground, grown by a margin, as taken.
    pub fn put(&mut self, form: Form, margin_m: f64) {
        let taken = &mut self.taken;
        let mut take = |x: usize, y: usize| taken[x * Window::NY + y] = true;
        match &form {
            Form::Building(b) => {
                let n = b.outline_m.len();
                polygon_cells(Extent::WINDOW, &b.outline_m, &mut take);
                let ring: Vec<DVec2> = (0..=n).map(|i| b.outline_m[i % n]).collect();
                line_cells(Extent::WINDOW, &ring, margin_m, &mut take);
            }
            Form::Shrubs(s) => polygon_cells(Extent::WINDOW, &s.outline_m, &mut take),
            Form::Line(l) => line_cells(Extent::WINDOW, &l.points_m, l.width_m / 2.0 + margin_m, &mut take),
            Form::Bridge(b) => line_cells(Extent::WINDOW, &b.points_m, b.width_m / 2.0 + margin_m, &mut take),
            Form::Tree(t) => disc_cells(Extent::WINDOW, t.position_m, margin_m, &mut take),
            Form::Post(p) => disc_cells(Extent::WINDOW, p.position_m, margin_m, &mut take),
        }
        self.out.add(form);
    }
}
