//! Ground for new things that words ask for: beside the road, clear of other things.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use glam::DVec2;

use super::{SideOf, Where};
use scene::raster::{box_cells, disc_cells, line_cells, polygon_cells};
use scene::road_map::RoadMap;
use scene::{Background, BevLayer, BevLayout, BoxId, Extent, Form, SceneBox};
use world::scenery::distance_cells;

/// Distance from the border of the grid at which things end, m.
const BORDER_M: f64 = 0.6;

/// A scene's ground with room for new things; all in the ego frame.
pub struct FreeGround {
    extent: Extent,
    /// Lanes, crossings and junctions.
    pub roads: RoadMap,
    to_paved: Vec<f32>,
    taken: Vec<bool>,
    own: OnceCell<Vec<DVec2>>, // of each column: way along the ego lane, and offset to its left; slow, so on demand
}

impl FreeGround {
    /// The ground of a scene with things in the ego frame.
    pub fn new(layout: &BevLayout, boxes: &BTreeMap<BoxId, SceneBox>, things: &Background) -> Self {
        let paved = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit() | BevLayer::Walkway.bit();
        let roads = RoadMap::new(layout);
        let extent = layout.extent();
        let mut out = Self {
            extent,
            own: OnceCell::new(),
            roads,
            to_paved: distance_cells(extent, |c| layout.cells()[c] & paved != 0),
            taken: vec![false; extent.columns()],
        };
        for b in boxes.values() {
            box_cells(extent, b, extent.voxel_m(), |x, y| {
                out.taken[extent.index(x, y)] = true
            });
        }
        for thing in things.iter() {
            out.take(&thing.form);
        }
        out
    }

    /// Marks the ground of a form as taken.
    pub fn take(&mut self, form: &Form) {
        let (extent, taken) = (self.extent, &mut self.taken);
        let take = |x: usize, y: usize| taken[extent.index(x, y)] = true;
        match form {
            Form::Building(b) => polygon_cells(extent, &b.outline_m, take),
            Form::Line(l) => line_cells(extent, &l.points_m, l.width_m / 2.0 + 0.2, take),
            Form::Bridge(b) => line_cells(extent, &b.points_m, b.width_m / 2.0, take),
            Form::Tree(t) => disc_cells(extent, t.position_m, 1.0, take),
            Form::Post(p) => disc_cells(extent, p.position_m, 0.6, take),
            // Other things may grow or stand among shrubs.
            Form::Shrubs(_) => {}
        }
    }

    fn own(&self) -> &[DVec2] {
        let all = || (0..self.extent.columns()).map(|c| self.roads.along_ego_lane(self.middle_m(c)));
        self.own.get_or_init(|| all().collect())
    }

    /// Distance from paved ground, m.
    pub fn paved_m(&self, p: DVec2) -> f64 {
        self.extent.column_at(p.x, p.y).map_or(0.0, |[x, y]| {
            f64::from(self.to_paved[self.extent.index(x, y)]) * self.extent.voxel_m()
        })
    }

    /// True inside the map, at least that far from its sides and a little more.
    fn is_within(&self, p: DVec2, margin_m: f64) -> bool {
        let (min, max) = (self.extent.min_m().truncate(), self.extent.max_m().truncate());
        let margin_m = margin_m + BORDER_M;
        p.cmpgt(min + margin_m).all() && p.cmplt(max - margin_m).all()
    }

    fn middle_m(&self, c: usize) -> DVec2 {
        let [x, y] = self.extent.column(c);
        self.extent.center(x, y, 0).truncate()
    }

    fn is_free(&self, x: usize, y: usize, gap_m: f64) -> bool {
        let c = self.extent.index(x, y);
        !self.taken[c] && f64::from(self.to_paved[c]) * self.extent.voxel_m() > gap_m
    }

    /// True if a disc is free and off the paved ground.
    pub fn has_room(&self, p: DVec2, radius_m: f64) -> bool {
        let mut free = self.is_within(p, radius_m);
        disc_cells(self.extent, p, radius_m, |x, y| free &= self.is_free(x, y, 0.3));
        free
    }

    /// True if an outline is free, off the paved ground and in the grid.
    pub fn has_room_for(&self, outline_m: &[DVec2]) -> bool {
        let mut free = outline_m.iter().all(|p| self.is_within(*p, 0.0));
        polygon_cells(self.extent, outline_m, |x, y| free &= self.is_free(x, y, 0.4));
        free
    }

    /// True if a point fits the clause: its side, ahead or behind, and the place that it is near to.
    pub fn fits(&self, place: &Where, p: DVec2) -> bool {
        let own = self.roads.along_ego_lane(p);
        let side = match place.side {
            Some(SideOf::Left) => own.y > 0.0,
            Some(SideOf::Right) => own.y < 0.0,
            None => true,
        };
        let ahead = match place.ahead {
            Some(true) => own.x > 0.0,
            Some(false) => own.x < 0.0,
            None => true,
        };
        side && ahead && super::targets::is_near(&self.roads, place, &[p])
    }

    /// The free place that fits best: at the stated distance along the road, and as near to `from_paved_m` from the
    /// paved ground as possible.
    pub fn place(
        &self,
        place: &Where,
        along_m: f64,
        from_paved_m: f64,
        fits: &dyn Fn(DVec2) -> bool,
    ) -> Option<DVec2> {
        let all = self.own();
        let mut order: Vec<(f64, usize)> = (0..self.extent.columns())
            .filter(|c| !self.taken[*c])
            .filter_map(|c| {
                let paved = f64::from(self.to_paved[c]) * self.extent.voxel_m();
                let own = all[c];
                // Prefers places beside the ego's road to places beside one that leads away from it.
                let cost = (own.x - along_m).abs() * 2.0 + own.y.abs() * 0.25 + (paved - from_paved_m).abs();
                (paved > 0.3 && cost < 60.0).then_some((cost, c))
            })
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let found = order.iter().find(|(_, c)| {
            let p = self.middle_m(*c);
            self.fits(place, p) && fits(p)
        });
        found.map(|(_, c)| self.middle_m(*c))
    }

    /// Lines beside the ego's road at a distance from its paved ground, in order along it; gaps where there is no room.
    pub fn lines(&self, place: &Where, side: SideOf, from_paved_m: f64) -> Vec<Vec<DVec2>> {
        const STEP_M: f64 = 1.6;
        let place = Where {
            side: Some(side),
            ..*place
        };
        let mut at: BTreeMap<i64, (f64, DVec2)> = BTreeMap::new();
        let all = self.own();
        for (c, own) in all.iter().enumerate() {
            let p = self.middle_m(c);
            let paved = f64::from(self.to_paved[c]) * self.extent.voxel_m();
            let wrong_side = (own.y > 0.0) != (side == SideOf::Left);
            if wrong_side
                || (paved - from_paved_m).abs() > 0.3
                || !self.has_room(p, 0.3)
                || !self.fits(&place, p)
            {
                continue;
            }
            let slot = (own.x / STEP_M).round() as i64;
            let best = at.entry(slot).or_insert((f64::INFINITY, p));
            if own.y.abs() < best.0 {
                *best = (own.y.abs(), p);
            }
        }
        let mut out: Vec<Vec<(i64, f64, DVec2)>> = Vec::new();
        for (slot, (offset, p)) in at {
            let goes_on = out
                .last()
                .and_then(|l| l.last())
                .is_some_and(|(s, o, _)| slot - s <= 2 && (offset - o).abs() < 2.5);
            match out.last_mut().filter(|_| goes_on) {
                Some(line) => line.push((slot, offset, p)),
                None => out.push(vec![(slot, offset, p)]),
            }
        }
        out.retain(|l| l.len() >= 3);
        out.into_iter()
            .map(|l| l.into_iter().map(|(.., p)| p).collect())
            .collect()
    }
}
