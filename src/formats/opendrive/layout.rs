//! Cuts a bird's-eye-view layout out of a road network.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use super::lanes::{LaneGround, LaneKind, LaneSection, Travel};
use super::levels::RoadLevels;
use super::lines::{Follower, SectionLines, clipped};
use super::objects::ObjectKind;
use super::relief;
use super::sampling::{BUDGET, LaneEdges, walk};
use super::things::SceneryCollector;
use super::xml::{Skipped, count};
use super::{RoadNetwork, RoadlessGeometry, XodrRoad, tidy};
use super::{cost, decks};
use scene::raster::{draw_polyline, polygon_cells};
use scene::{Background, BevLayer, BevLayout, BoxId, Extent, Form, Polyline, PolylineKind, SceneBox, Window};

/// The map that is cut out, and where it lies in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapCut {
    /// The ego vehicle's place in the file.
    pub at_m: DVec2,
    /// Unit vector; rotating by it turns file axes to ego axes.
    pub ego_from_file: DVec2,
    /// In the ego frame.
    pub extent: Extent,
}

impl MapCut {
    /// From the ego vehicle to the farthest corner, m.
    pub fn radius_m(&self) -> f64 {
        let (low, high) = self.bounds_m();
        low.abs().max(high.abs()).length()
    }

    /// Lower and upper corner, ego frame, m.
    pub fn bounds_m(&self) -> (DVec2, DVec2) {
        (self.extent.min_m().truncate(), self.extent.max_m().truncate())
    }

    /// True if a point of the ego frame lies on it or within `reach_m` of it; false for NaN.
    pub fn holds(&self, p: DVec2, reach_m: f64) -> bool {
        self.meets(p - reach_m, p + reach_m)
    }

    /// True if a rectangle of the ego frame lies partly on it.
    pub fn meets(&self, min: DVec2, max: DVec2) -> bool {
        let (low, high) = self.bounds_m();
        max.cmpgt(low).all() && min.cmplt(high).all()
    }

    /// The parts of a line of the ego frame that lie on it or within `reach_m` of it.
    pub fn clipped(&self, points: &[DVec2], reach_m: f64) -> Vec<Vec<DVec2>> {
        let (low, high) = self.bounds_m();
        clipped(points, (low - reach_m, high + reach_m))
    }

    /// How much may be drawn on it.
    fn budget(&self) -> usize {
        BUDGET * self.extent.columns().div_ceil(Window::COLUMNS)
    }

    pub fn to_ego(self, p: DVec2) -> DVec2 {
        self.ego_from_file.rotate(p - self.at_m)
    }

    pub fn heading_to_ego(self, heading_rad: f64) -> f64 {
        heading_rad + self.ego_from_file.to_angle()
    }
}

/// A layout, and facts about the roads that went into it.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutImport {
    /// Ego at the origin, x forward.
    pub layout: BevLayout,
    /// Roads with ground inside the window.
    pub road_count: usize,
    /// Lane centres inside the window; a lane that goes on from one road to the next counts once for each.
    pub lane_count: usize,
    /// Pedestrian crossings inside the window.
    pub crossing_count: usize,
    /// Share of the cells that is drivable, 0 to 1.
    pub drivable_share: f64,
    /// Columns that are drivable although no traffic lane lies there, by the kind of lane: `shoulder`, `stop`,
    /// `restricted`, `biking`. The nuScenes map counts them as drivable; a road's own rules do not.
    pub drivable_beside_traffic: BTreeMap<String, usize>,
    /// Scenery that the file puts beside the road, and roads that cross above the ground, in the ego frame.
    pub background: Background,
    /// How many of these things are bridges.
    pub bridge_count: usize,
    /// Boxes that stand or drive on the roads of the map, by the file, in the ego frame.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    /// True if the layout is the one that Sceneloom wrote the file from, to the last cell, and not made of the roads.
    pub is_own: bool,
    /// Parts of the file that the import does not have, counted by kind.
    pub skipped: Skipped,
    in_junction: Vec<bool>, // columns
}

impl LayoutImport {
    /// The layout without the lanes that lead through junctions: traffic is seeded on the other lanes, as vehicles do
    /// not wait there.
    pub fn without_lanes_of_junctions(&self) -> BevLayout {
        let extent = self.layout.extent();
        let stays = |line: &&Polyline| {
            let middle = line.points_m.get(line.points_m.len() / 2);
            let column = middle.and_then(|m| extent.column_at(m.x, m.y));
            let within = column.is_some_and(|[x, y]| self.in_junction[extent.index(x, y)]);
            line.kind != PolylineKind::LaneCenter || !within
        };
        let mut layout = self.layout.clone();
        layout.polylines = Arc::new(self.layout.polylines.iter().filter(stays).cloned().collect());
        layout
    }
}

/// The grid while it is drawn.
struct LayoutRaster {
    window: MapCut,
    levels: Option<RoadLevels>, // none if every road is flat
    layout: BevLayout,
    named: Vec<bool>,                  // cells on which some lane lies, drivable or not
    in_junction: Vec<bool>,            // cells on which a connecting road lies
    traffic: Vec<bool>,                // cells on which a traffic lane lies
    beside: Vec<Option<&'static str>>, // kind of the drivable lane without traffic that lies there
    lines: Vec<Polyline>,
    budget: usize,
}

impl RoadNetwork {
    /// The 80 x 80 m around `at_m` (file frame), seen by an ego vehicle that looks along `heading_rad`.
    ///
    /// The relief is that of the roads, relative to the ego's ground; where roads cross above one another, one of them is a bridge.
    /// Layers in the sense of the nuScenes map: drivable area is everything paved that is connected
    /// to a traffic lane; stop lines, crossings and dividers are also kept as polylines.
    pub fn to_layout(&self, at_m: DVec2, heading_rad: f64) -> LayoutImport {
        self.to_layout_over(Extent::WINDOW, at_m, heading_rad)
    }

    /// The layout that [`Self::to_layout`] makes, over a map of another extent.
    pub fn to_layout_over(&self, extent: Extent, at_m: DVec2, heading_rad: f64) -> LayoutImport {
        let window = MapCut {
            at_m,
            ego_from_file: DVec2::from_angle(-heading_rad),
            extent,
        };
        let columns = extent.columns();
        let is_somewhere = at_m.is_finite() && heading_rad.is_finite();
        let levels = match is_somewhere {
            true => RoadLevels::survey(self, &window),
            false => None,
        };
        let mut canvas = LayoutRaster {
            window,
            levels,
            layout: BevLayout::over(extent),
            named: vec![false; columns],
            in_junction: vec![false; columns],
            traffic: vec![false; columns],
            beside: vec![None; columns],
            lines: Vec::new(),
            budget: window.budget(),
        };
        let mut skipped = self.skipped.clone();
        let mut road_count = 0;
        if is_somewhere {
            for (index, road) in self.roads.iter().enumerate() {
                road_count += usize::from(canvas.road(index, road, self.marks_known));
                canvas.objects(index, road, &mut skipped);
            }
            canvas.drawn(&self.drawn);
        } else {
            count(&mut skipped, "window at no finite place");
        }
        canvas.pave_gaps();
        canvas.roads_cover_walkways();
        canvas.draw_lines();
        let mut forms = Vec::new();
        if is_somewhere {
            forms = canvas.things(self, &mut skipped);
        }
        let mut bridge_count = 0;
        if let Some(levels) = &canvas.levels {
            let (relief, file_from_ego_m) = relief::over(extent, &levels.known_m);
            let bridges = decks::bridges(self, &window, levels, &relief, file_from_ego_m, &mut skipped);
            bridge_count = bridges.len();
            forms.extend(bridges);
            let lowered = (extent != Extent::WINDOW)
                .then(|| relief::levelled(&relief))
                .flatten();
            if lowered.is_some() {
                count(&mut skipped, "hills that are lowered to what a map can show");
            }
            canvas.layout.relief = lowered.unwrap_or(relief);
        }
        let mut background = Background::default();
        forms.into_iter().for_each(|form| {
            background.add_as(form, true);
        });
        if canvas.budget == 0 {
            count(&mut skipped, "roads beyond the drawing budget");
        }
        let drivable_beside_traffic = canvas.beside_traffic();
        let in_junction = std::mem::take(&mut canvas.in_junction);
        let mut layout = canvas.layout;
        layout.polylines = canvas.lines.into();
        let own = self.own_layout(extent, at_m, heading_rad);
        let is_own = own.is_some();
        if let Some(own) = own {
            layout = own;
        } else if self.own.is_some() {
            count(
                &mut skipped,
                "sceneloom's rows for another place or map (its roads are read)",
            );
        }
        let of_kind = |kind| layout.polylines.iter().filter(|l| l.kind == kind).count();
        let (lane_count, crossing_count) = (
            of_kind(PolylineKind::LaneCenter),
            of_kind(PolylineKind::PedCrossing),
        );
        LayoutImport {
            boxes: self.boxes_on(&window, &layout),
            is_own,
            road_count,
            lane_count,
            crossing_count,
            drivable_beside_traffic,
            drivable_share: layout.count(BevLayer::DrivableArea) as f64 / columns as f64,
            background,
            bridge_count,
            skipped,
            layout,
            in_junction,
        }
    }
}

impl RoadNetwork {
    /// The map that Sceneloom wrote the file from, if the ego vehicle is where it was then: at the origin, looking along x.
    pub fn own_extent(&self, at_m: DVec2, heading_rad: f64) -> Option<Extent> {
        let is_origin = at_m == DVec2::ZERO && heading_rad == 0.0;
        self.own.as_ref().filter(|_| is_origin).map(|own| own.extent())
    }

    /// The boxes of the file that stand on a map, on its ground.
    fn boxes_on(&self, window: &MapCut, layout: &BevLayout) -> BTreeMap<BoxId, SceneBox> {
        let moved = self.boxes.iter().map(|b| {
            let at = window.to_ego(b.center_m.truncate());
            let mut b = *b;
            b.center_m = at.extend(b.center_m.z + layout.relief.height_m(at));
            b.yaw_rad = window.heading_to_ego(b.yaw_rad);
            b.velocity_mps = window.ego_from_file.rotate(b.velocity_mps);
            b
        });
        let on_map = moved.filter(|b| window.holds(b.center_m.truncate(), 0.0) && b.problem().is_none());
        on_map.map(|b| (b.id, b)).collect()
    }

    /// The layout that Sceneloom wrote the file from, if it covers this map.
    fn own_layout(&self, extent: Extent, at_m: DVec2, heading_rad: f64) -> Option<BevLayout> {
        let whole = self.own_extent(at_m, heading_rad)?;
        let covers = whole
            .overlap(&extent)
            .is_some_and(|o| o.size == [extent.nx(), extent.ny()]);
        covers.then(|| self.own.as_ref().map(|own| own.layout().crop(extent)))?
    }
}

impl LayoutRaster {
    fn to_ego(&self, p: DVec2) -> DVec2 {
        self.window.to_ego(p)
    }

    fn is_on_ground(&self, road: usize, s_m: f64) -> bool {
        self.levels.as_ref().is_none_or(|l| l.off(road, s_m).is_none())
    }

    fn fill(&mut self, area_in_ego: &[DVec2], layers: &[BevLayer], in_junction: bool) -> bool {
        let extent = self.window.extent;
        self.budget = self
            .budget
            .saturating_sub(cost::of_scan(extent, area_in_ego.len()));
        // An area that is left out is counted with the roads beyond the budget.
        if self.budget == 0 {
            return false;
        }
        let mut cells = Vec::new();
        polygon_cells(extent, area_in_ego, |x, y| cells.push((x, y)));
        self.budget = self.budget.saturating_sub(cells.len() / 8);
        for (x, y) in &cells {
            self.named[extent.index(*x, *y)] = true;
            self.in_junction[extent.index(*x, *y)] |= in_junction;
            for layer in layers {
                self.layout.set(*layer, *x, *y, true);
            }
        }
        !cells.is_empty()
    }

    /// Draws the lines that were found, as far as a budget of their own goes.
    fn draw_lines(&mut self) {
        let extent = self.window.extent;
        let mut budget = self.window.budget();
        for line in &self.lines {
            budget = budget.saturating_sub(cost::of_line(extent, line));
            match budget {
                0 => self.budget = 0,
                _ => draw_polyline(&mut self.layout, line),
            }
        }
    }

    fn note_kind(&mut self, area_in_ego: &[DVec2], kind: LaneKind) {
        let (traffic, beside) = (&mut self.traffic, &mut self.beside);
        let extent = self.window.extent;
        polygon_cells(extent, area_in_ego, |x, y| {
            let c = extent.index(x, y);
            traffic[c] |= kind.carries_traffic();
            beside[c] = beside[c].or(kind.beside_traffic());
        });
    }

    /// Columns that are drivable and on no traffic lane, by kind.
    fn beside_traffic(&self) -> BTreeMap<String, usize> {
        let mut out = BTreeMap::new();
        for (c, kind) in self.beside.iter().enumerate() {
            let [x, y] = self.window.extent.column(c);
            let drivable = self.layout.has(BevLayer::DrivableArea, x, y);
            if let Some(kind) = kind.filter(|_| drivable && !self.traffic[c]) {
                *out.entry(kind.to_owned()).or_default() += 1;
            }
        }
        out
    }

    /// Draws the lanes of a road; true if any ground of it is in the window.
    fn road(&mut self, index: usize, road: &XodrRoad, marks_known: bool) -> bool {
        let mut follower = Follower::default();
        let mut seen = false;
        for section in &road.sections {
            let mut grounds = None;
            let mut budget = self.budget;
            let (at_m, radius_m) = (self.window.at_m, self.window.radius_m());
            walk(road, section, at_m, radius_m, &mut budget, |from, to, budget| {
                if !self.is_on_ground(index, 0.5 * (from.s_m + to.s_m)) {
                    return None;
                }
                let grounds = grounds.get_or_insert_with(|| section.grounds());
                self.budget = *budget;
                seen |= self.strips(section, from, to, grounds, road.junction.is_some());
                let lines = SectionLines {
                    section,
                    grounds,
                    in_junction: road.junction.is_some(),
                    marks_known,
                    limit_at: &|s_m| road.limit_at(s_m),
                };
                follower.step(&lines.tracks(from, to), from, to, &mut self.budget);
                *budget = self.budget;
                None
            });
            self.budget = budget;
        }
        for (kind, points) in follower.finish() {
            let points: Vec<DVec2> = points.iter().map(|p| self.to_ego(*p)).collect();
            let parts = self.window.clipped(&points, 0.0).into_iter();
            self.lines
                .extend(parts.map(|points_m| Polyline { kind, points_m }));
        }
        seen
    }

    /// One step of every lane, as quads that share their corners: neighbours leave no cell between them.
    fn strips(
        &mut self,
        section: &LaneSection,
        from: &LaneEdges,
        to: &LaneEdges,
        grounds: &[LaneGround],
        in_junction: bool,
    ) -> bool {
        let edge = |row: &LaneEdges, i: usize| self.to_ego(row.between(i, i));
        let edges: Vec<[DVec2; 2]> = (0..from.t_m.len())
            .map(|i| [edge(from, i), edge(to, i)])
            .collect();
        let mut seen = false;
        let lanes = section.lanes_left_to_right().zip(grounds);
        for ((lane, ground), sides) in lanes.zip(edges.windows(2)) {
            let quad = [sides[0][0], sides[0][1], sides[1][1], sides[1][0]];
            seen |= self.fill(&quad, ground.layers(), in_junction);
            if *ground == LaneGround::Road {
                self.note_kind(&quad, lane.kind);
            }
        }
        seen
    }

    fn objects(&mut self, index: usize, road: &XodrRoad, skipped: &mut Skipped) {
        for object in &road.objects {
            if matches!(object.kind, ObjectKind::Standing(_)) || !self.is_on_ground(index, object.s_m) {
                continue;
            }
            if let ObjectKind::StopLine { against_line } = object.kind {
                let line = road
                    .section_at(object.s_m)
                    .and_then(|s| stop_line(road, s, object.s_m, against_line));
                match line {
                    Some(line) => {
                        let points: Vec<DVec2> = line.iter().map(|p| self.to_ego(*p)).collect();
                        self.lines
                            .extend(
                                self.window
                                    .clipped(&points, 0.0)
                                    .into_iter()
                                    .map(|points_m| Polyline {
                                        kind: PolylineKind::StopLine,
                                        points_m,
                                    }),
                            );
                    }
                    None => count(skipped, "stop line without a lane"),
                }
                continue;
            }
            let mut areas = Vec::new();
            let mut budget = self.budget;
            object.outlines_m(&road.reference, &mut budget, skipped, |area| {
                let area: Vec<DVec2> = area.iter().map(|p| self.to_ego(*p)).collect();
                let min = area.iter().copied().fold(DVec2::INFINITY, DVec2::min);
                let max = area.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
                if self.window.meets(min, max) {
                    areas.push(area);
                }
            });
            self.budget = budget;
            for area in areas {
                match object.kind {
                    ObjectKind::Parking => {
                        self.fill(&area, LaneGround::Carpark.layers(), false);
                    }
                    ObjectKind::Area(ground) => {
                        self.fill(&area, ground.layers(), false);
                    }
                    _ => self.lines.push(Polyline {
                        kind: PolylineKind::PedCrossing,
                        points_m: area,
                    }),
                }
            }
        }
    }

    /// Draws the lines and areas on the ground that belong to no road.
    fn drawn(&mut self, drawn: &RoadlessGeometry) {
        let to_ego = |canvas: &Self, points: &[DVec2]| -> Vec<DVec2> {
            points.iter().map(|p| canvas.to_ego(*p)).collect()
        };
        for (ground, outline) in &drawn.areas {
            let area = to_ego(self, outline);
            self.fill(&area, ground.layers(), false);
        }
        for line in &drawn.lines {
            let points = to_ego(self, &line.points_m);
            if line.kind == PolylineKind::PedCrossing {
                let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
                let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
                if self.window.meets(low, high) {
                    self.lines.push(Polyline {
                        kind: line.kind,
                        points_m: points,
                    });
                }
                continue;
            }
            let parts = self.window.clipped(&points, 0.0).into_iter();
            self.lines.extend(parts.map(|points_m| Polyline {
                kind: line.kind,
                points_m,
            }));
        }
    }

    /// Forms of the scenery beside the roads; the layout must be finished.
    fn things(&mut self, network: &RoadNetwork, skipped: &mut Skipped) -> Vec<Form> {
        let mut things = SceneryCollector {
            window: self.window,
            layout: &self.layout,
            forms: Vec::new(),
            budget: self.budget,
        };
        for (index, road) in network.roads.iter().enumerate() {
            for object in &road.objects {
                things.object(road, object, &|s_m| self.is_on_ground(index, s_m), skipped);
            }
        }
        self.budget = things.budget;
        things.forms
    }

    /// Joints between roads and cracks in junctions become drivable.
    fn pave_gaps(&mut self) {
        let bit = BevLayer::DrivableArea.bit();
        let mut drivable: Vec<bool> = self.layout.cells().iter().map(|c| c & bit != 0).collect();
        let extent = self.window.extent;
        tidy::close_gaps(extent, &mut drivable, &self.named);
        tidy::fill_junction_holes(extent, &mut drivable, &self.named, &self.in_junction);
        for (i, _) in drivable.iter().enumerate().filter(|(_, d)| **d) {
            let [x, y] = extent.column(i);
            self.layout.set(BevLayer::DrivableArea, x, y, true);
        }
    }

    /// In a junction the walkway of one connecting road lies under the lanes of another.
    fn roads_cover_walkways(&mut self) {
        for [x, y] in self.window.extent.all_columns() {
            if self.layout.has(BevLayer::DrivableArea, x, y) {
                self.layout.set(BevLayer::Walkway, x, y, false);
            }
        }
    }
}

/// The ends of a stop line: across all traffic lanes of one direction.
fn stop_line(
    road: &XodrRoad,
    section: &LaneSection,
    s_m: f64,
    against_line: Option<bool>,
) -> Option<[DVec2; 2]> {
    let row = LaneEdges::at(road, section, s_m);
    let holds = |travel: Travel| match against_line {
        None => true,
        Some(against) => travel == Travel::Both || (travel == Travel::Backward) == against,
    };
    let mut lanes = section
        .lanes_left_to_right()
        .enumerate()
        .filter(|(i, lane)| lane.kind.carries_traffic() && holds(lane.travel) && row.width(*i) > 0.4)
        .map(|(i, _)| i);
    let first = lanes.next()?;
    let last = lanes.last().unwrap_or(first);
    Some([row.between(first, first), row.between(last + 1, last + 1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shoulder and stop lane beside the traffic are drivable and are said to be; what a verge parts from it is neither.
    #[test]
    fn drivable_lanes_without_traffic_are_said() {
        let lane = |id: i32, kind: &str, width: f64| {
            format!(
                r#"<lane id="{id}" type="{kind}"><width sOffset="0" a="{width}" b="0" c="0" d="0"/></lane>"#
            )
        };
        let network = |right: &str| {
            let text = format!(
                r#"<OpenDRIVE><header revMajor="1" revMinor="6"/><road name="" length="200" id="1" junction="-1">
                <planView><geometry s="0" x="0" y="0" hdg="0" length="200"><line/></geometry></planView>
                <lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right>{right}</right></laneSection>
                </lanes></road></OpenDRIVE>"#
            );
            super::super::read(text.as_bytes()).expect("roads")
        };
        let layout = |right: &str| network(right).to_layout(DVec2::new(100.0, -2.0), 0.0);
        let plain = layout(&lane(-1, "driving", 4.0));
        assert!(plain.drivable_beside_traffic.is_empty());
        let wide = [
            lane(-1, "driving", 4.0),
            lane(-2, "shoulder", 2.0),
            lane(-3, "stop", 4.0),
            lane(-4, "none", 2.0),
            lane(-5, "shoulder", 2.0),
        ];
        let found = layout(&wide.concat());
        let columns = |m: f64| (m / Window::VOXEL_M * Window::NX as f64) as usize;
        let expected = [("shoulder", columns(2.0)), ("stop", columns(4.0))].map(|(k, n)| (k.to_owned(), n));
        assert_eq!(found.drivable_beside_traffic, expected.into());
        let more = found.layout.count(BevLayer::DrivableArea) - plain.layout.count(BevLayer::DrivableArea);
        assert_eq!(more, columns(6.0));
    }
}
