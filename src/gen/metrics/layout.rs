//! Figures of layouts beside those of real drives: spacing, sizes, headings, lane widths
//! (`assets/statistics/layout.json`, which names its origin). Also how much layouts of one graph differ.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::stats::mean_ci95;
use numeric::quantile::quantile;
use scene::raster::box_cells;
use scene::relations::{STANDING_MPS, overlap_m};
use scene::road_map::RoadMap;
use scene::{Class, Extent, SceneBox, Window};

/// Spread of one quantity.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// 5th percentile.
    #[serde(default)]
    pub p5: f64,
    /// Median.
    #[serde(default)]
    pub p50: f64,
    /// 95th percentile.
    #[serde(default)]
    pub p95: f64,
    /// Mean.
    #[serde(default)]
    pub mean: f64,
    /// Number of values.
    #[serde(default)]
    pub n: usize,
}

impl Spread {
    /// The spread of some values; `None` for none.
    pub fn from_values(values: &[f64]) -> Option<Self> {
        (!values.is_empty()).then(|| Self {
            p5: quantile(values, 0.05),
            p50: quantile(values, 0.5),
            p95: quantile(values, 0.95),
            mean: mean_ci95(values).0,
            n: values.len(),
        })
    }
}

/// One quantity of layouts and of real drives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutQuantity {
    /// Name of the quantity.
    pub name: String,
    /// Spread over the layouts.
    pub found: Spread,
    /// Spread over real drives.
    pub real: Spread,
}

/// Values gathered over layouts.
#[derive(Clone, Debug, Default)]
pub struct LayoutFigures {
    values: BTreeMap<String, Vec<f64>>,
    vehicles: usize,
    off_road: usize,
    moving: usize,
    along: usize,
    pairs: usize,
    overlapping: usize,
}

/// Shares that should be near 0 or 1 whatever the layout.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Soundness {
    /// Pairs of boxes that overlap, share of all pairs within 15 m.
    pub overlapping_pairs: f64,
    /// Share of vehicles whose centre is on road or car park.
    pub vehicles_on_road: f64,
    /// Share of moving vehicles within 15 degrees of their lane's direction.
    pub moving_along_lane: f64,
}

impl LayoutFigures {
    /// Takes a layout in.
    pub fn add(&mut self, road: &RoadMap, boxes: &[SceneBox]) {
        let sound: Vec<&SceneBox> = boxes.iter().filter(|b| b.problem().is_none()).collect();
        self.push("boxes_per_frame", sound.len() as f64);
        self.lanes(road);
        for b in &sound {
            self.one(road, b);
        }
        for (i, a) in sound.iter().enumerate() {
            for b in &sound[i + 1..] {
                if a.center_m.distance(b.center_m) < 15.0 {
                    self.pairs += 1;
                    self.overlapping += usize::from(overlap_m(a, b) > 0.0);
                    self.side_by_side(a, b);
                }
            }
        }
        self.gaps(road, &sound);
    }

    fn push(&mut self, name: &str, value: f64) {
        if value.is_finite() {
            self.values.entry(name.to_owned()).or_default().push(value);
        }
    }

    fn one(&mut self, road: &RoadMap, b: &SceneBox) {
        let p = b.center_m.truncate();
        let name = b.class.name();
        for (axis, v) in [
            ("length", b.size_m.x),
            ("width", b.size_m.y),
            ("height", b.size_m.z),
        ] {
            self.push(&format!("{name}.{axis}_m"), v);
        }
        if !b.class.is_vehicle() {
            return;
        }
        self.vehicles += 1;
        self.off_road += usize::from(!road.is_for_vehicles(p));
        let Some(lane) = road.nearest_lane(p) else { return };
        let cosine = lane.direction.dot(b.heading()).clamp(-1.0, 1.0);
        let moving = b.velocity_mps.length() > STANDING_MPS;
        if moving {
            self.moving += 1;
            self.along += usize::from(cosine > 0.9659);
        }
        if b.class == Class::Car {
            if moving {
                self.push("moving_car_offset_m", lane.distance_m);
                self.push("moving_car_heading_deg", cosine.acos().to_degrees());
            } else {
                self.push("standing_car_offset_m", lane.distance_m);
                self.push(
                    "standing_car_heading_mod180_deg",
                    cosine.abs().acos().to_degrees(),
                );
            }
        }
    }

    /// Adds the distance of vehicles side by side: headings within 15 degrees, less than half a length apart along the
    /// heading, 1 to 6 m across.
    fn side_by_side(&mut self, a: &SceneBox, b: &SceneBox) {
        if !(a.class.is_vehicle() && b.class.is_vehicle()) || a.heading().dot(b.heading()) < 0.9659 {
            return;
        }
        let d = (b.center_m - a.center_m).truncate();
        let (along, across) = (a.heading().dot(d).abs(), a.heading().perp_dot(d).abs());
        if along < a.size_m.x.min(b.size_m.x) / 2.0 && (1.0..6.0).contains(&across) {
            self.push("side_by_side_m", across);
        }
    }

    /// Adds the free space to the next vehicle in the same lane, bumper to bumper, m.
    fn gaps(&mut self, road: &RoadMap, boxes: &[&SceneBox]) {
        let mut in_lane: BTreeMap<usize, Vec<(f64, f64)>> = BTreeMap::new();
        for b in boxes.iter().filter(|b| b.class.is_vehicle()) {
            if let Some(lane) = road
                .nearest_lane(b.center_m.truncate())
                .filter(|l| l.distance_m < 1.75)
            {
                in_lane
                    .entry(lane.lane)
                    .or_default()
                    .push((lane.along_m, b.size_m.x));
            }
        }
        for mut row in in_lane.into_values() {
            row.sort_by(|a, b| a.0.total_cmp(&b.0));
            for pair in row.windows(2) {
                let gap = pair[1].0 - pair[0].0 - (pair[0].1 + pair[1].1) / 2.0;
                self.push("bumper_gap_m", gap.max(0.0));
            }
        }
    }

    /// Adds metres of lane, and the distance to the next parallel lane at every fifth metre.
    fn lanes(&mut self, road: &RoadMap) {
        let inside = |p: &DVec2| p.abs().max_element() <= 40.0;
        let metres: usize = road
            .lanes
            .iter()
            .map(|l| l.points_m.iter().filter(|p| inside(p)).count())
            .sum();
        self.push("lane_metres_per_crop", metres as f64);
        for (i, lane) in road.lanes.iter().enumerate() {
            for pair in lane.points_m.windows(2).step_by(5).filter(|w| inside(&w[0])) {
                let direction = (pair[1] - pair[0]).normalize_or_zero();
                let beside = (0..road.lanes.len())
                    .filter(|j| *j != i)
                    .filter_map(|j| road.on_lane(j, pair[0]));
                let parallel =
                    beside.filter(|l| l.direction.dot(direction).abs() > 0.97 && l.distance_m > 2.0);
                let width = parallel.map(|l| l.distance_m).fold(f64::INFINITY, f64::min);
                if width < 7.0 {
                    self.push("lane_width_m", width);
                }
            }
        }
    }

    /// Every quantity that has values and real figures, by name.
    pub fn rows(&self) -> Vec<LayoutQuantity> {
        let real = real_figures();
        let found = self.values.iter().filter_map(|(name, values)| {
            Some(LayoutQuantity {
                name: name.clone(),
                found: Spread::from_values(values)?,
                real: real.get(name)?.clone(),
            })
        });
        found.collect()
    }

    /// Shares of overlaps, of vehicles on road and of vehicles along their lane.
    pub fn soundness(&self) -> Soundness {
        let share = |n: usize, of: usize| n as f64 / of.max(1) as f64;
        Soundness {
            overlapping_pairs: share(self.overlapping, self.pairs),
            vehicles_on_road: 1.0 - share(self.off_road, self.vehicles),
            moving_along_lane: if self.moving == 0 {
                1.0
            } else {
                share(self.along, self.moving)
            },
        }
    }
}

/// Figures of real drives by the names that [`LayoutFigures`] uses.
pub fn real_figures() -> BTreeMap<String, Spread> {
    #[derive(Deserialize)]
    struct LayoutStatistics {
        sizes_m: BTreeMap<String, BTreeMap<String, Spread>>,
        #[serde(flatten)]
        rest: BTreeMap<String, serde_json::Value>,
    }
    let text = assets::statistics::LAYOUT;
    let Ok(file) = serde_json::from_str::<LayoutStatistics>(text) else {
        return BTreeMap::new();
    };
    let mut out = BTreeMap::new();
    for (class, axes) in file.sizes_m {
        for (axis, spread) in axes {
            // The source gives no median of sizes; they are nearly symmetric.
            let p50 = spread.mean;
            out.insert(format!("{class}.{axis}_m"), Spread { p50, ..spread });
        }
    }
    for (name, value) in file.rest {
        if let Ok(spread) = serde_json::from_value::<Spread>(value)
            && spread.n > 0
        {
            out.insert(name, spread);
        }
    }
    out
}

/// Difference between layouts of one graph.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Diversity {
    /// 1 less the intersection over union of the footprints, mean over pairs of layouts.
    pub footprints: f64,
    /// Distance between the places of the same node, m, mean over nodes and pairs.
    pub displacement_m: f64,
    /// Number of pairs of layouts.
    pub pairs: usize,
}

/// Diversity of layouts by node id, one for each seed; all 0 below two.
pub fn diversity(layouts: &[BTreeMap<u32, SceneBox>]) -> Diversity {
    let cells: Vec<BTreeSet<usize>> = layouts
        .iter()
        .map(|boxes| {
            let mut set = BTreeSet::new();
            for b in boxes.values() {
                box_cells(Extent::WINDOW, b, 0.0, |x, y| {
                    set.insert(x * Window::NY + y);
                });
            }
            set
        })
        .collect();
    let (mut footprints, mut displacement, mut nodes, mut pairs) = (0.0, 0.0, 0usize, 0usize);
    for i in 0..layouts.len() {
        for j in i + 1..layouts.len() {
            let both = cells[i].intersection(&cells[j]).count() as f64;
            let any = cells[i].union(&cells[j]).count() as f64;
            footprints += 1.0 - both / any.max(1.0);
            pairs += 1;
            for (id, a) in &layouts[i] {
                if let Some(b) = layouts[j].get(id) {
                    displacement += (a.center_m - b.center_m).truncate().length();
                    nodes += 1;
                }
            }
        }
    }
    Diversity {
        footprints: footprints / pairs.max(1) as f64,
        displacement_m: displacement / nodes.max(1) as f64,
        pairs,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use world::{template, traffic};

    #[test]
    fn procedural_streets_have_rows_and_are_sound() {
        let mut figures = LayoutFigures::default();
        let mut placements = Vec::new();
        for seed in 0..8 {
            let layout = template::layout("straight", 1).expect("listed");
            let boxes = traffic::place(&layout, seed, &traffic::TrafficSpec::NORMAL);
            figures.add(
                &RoadMap::new(&layout),
                &boxes.values().copied().collect::<Vec<_>>(),
            );
            placements.push(boxes.into_iter().map(|(id, b)| (id.0, b)).collect());
        }
        let rows = figures.rows();
        for name in [
            "lane_width_m",
            "bumper_gap_m",
            "moving_car_offset_m",
            "car.length_m",
            "boxes_per_frame",
        ] {
            let row = rows
                .iter()
                .find(|r| r.name == name)
                .unwrap_or_else(|| panic!("{name} is there"));
            assert!(
                row.found.n > 0 && row.real.mean > 0.0 && row.found.p5 <= row.found.p95,
                "{row:?}"
            );
        }
        let width = rows.iter().find(|r| r.name == "lane_width_m").expect("there");
        assert!((3.0..4.0).contains(&width.found.p50), "{width:?}");
        let sound = figures.soundness();
        // Machines of building sites may stand beside the road.
        assert!(
            sound.overlapping_pairs < 0.01 && sound.vehicles_on_road > 0.9,
            "{sound:?}"
        );
        assert!(sound.moving_along_lane > 0.95);
        let spread = diversity(&placements);
        assert!(spread.footprints > 0.5 && spread.pairs == 28, "{spread:?}");
        let same = diversity(&[placements[0].clone(), placements[0].clone()]);
        assert_eq!((same.footprints, same.displacement_m), (0.0, 0.0));
        assert_eq!(diversity(&[]).pairs, 0);
    }
}
