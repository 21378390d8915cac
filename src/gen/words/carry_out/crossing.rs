//! Crossings that a reading asks for, or needs as a place for something: one is added where the map has none.

use glam::DVec2;

use super::super::reading::{
    ActKind, AnchorPhrase, Destination, Feature, ObjectPhrase, PlacePhrase, Reading, Relation, Turn,
};
use super::super::remark::Remark;
use super::super::stage::Stage;
use place::holds::overlap_m;
use place::lanes::LaneMap;
use scene::raster::draw_polyline;
use scene::{BevLayer, BevLayout, BoxId, BoxLabel, Class, Polyline, PolylineKind, SceneBox};

/// Depth of a crossing along the road, m.
const DEPTH_M: f64 = 3.0;
/// Width of the road that one may span, m.
const SPAN_M: std::ops::RangeInclusive<f64> = 4.0..=26.0;
/// Distances ahead along our course at which a crossing is tried if no metres were stated, m.
const TRIED_M: [f64; 12] = [
    12.0, 10.0, 14.0, 8.0, 16.0, 18.0, 20.0, 7.0, 22.0, 25.0, 28.0, 31.0,
];
/// Distance from the middle of a junction within which there is no crossing, m.
const JUNCTION_M: f64 = 9.0;
/// Distance from the requested place within which an existing crossing is taken for it, m.
const SAME_M: f64 = 5.0;

/// A map with one more crossing.
pub(super) struct WithCrossing {
    pub(super) layout: BevLayout,
    pub(super) outline_m: Vec<DVec2>,
    /// The act that asks for it.
    pub(super) act: usize,
}

/// The map with the crossing that a reading needs; `None` if it has one, or needs none.
pub(super) fn with_crossing(
    reading: &Reading,
    layout: &BevLayout,
    boxes: &[SceneBox],
) -> Option<WithCrossing> {
    let map = LaneMap::new(layout);
    let (act, ahead_m) = reading.acts.iter().enumerate().find_map(|(i, a)| match &a.what {
        ActKind::Has {
            what: Feature::Crossing,
            places,
        } => {
            let ahead_m = metres_of(places);
            (map.crossings.is_empty() || is_elsewhere(&map, ahead_m)).then_some((i, ahead_m))
        }
        what if map.crossings.is_empty() && stands_on_one(what) => Some((i, None)),
        _ => None,
    })?;
    // (over the parking strips too, to the sidewalks, unless somebody is parked there)
    let road = BevLayer::DrivableArea.bit();
    let kerb_to_kerb = road | BevLayer::CarparkArea.bit();
    let at = |m: f64| {
        let wide = outline(&map, m, kerb_to_kerb).filter(|o| is_free(o, boxes));
        wide.or_else(|| outline(&map, m, road))
    };
    let outline_m = match ahead_m {
        Some(m) => at(m)?,
        None => TRIED_M
            .iter()
            .find_map(|m| at(*m).filter(|o| is_free(o, boxes)))?,
    };
    let line = Polyline {
        kind: PolylineKind::PedCrossing,
        points_m: outline_m.clone(),
    };
    let mut polylines = layout.polylines.to_vec();
    polylines.push(line.clone());
    let mut layout = BevLayout::from_cells(layout.cells().to_vec(), polylines).ok()?;
    draw_polyline(&mut layout, &line);
    Some(WithCrossing {
        layout,
        outline_m,
        act,
    })
}

/// Distance ahead in metres (negative: behind) of places that state one.
fn metres_of(places: &[PlacePhrase]) -> Option<f64> {
    let p = places.iter().find(|p| p.metres.is_some())?;
    let m = p.metres.filter(|m| (3.0..=36.0).contains(m))?;
    Some(if p.relation == Relation::Behind { -m } else { m })
}

fn is_elsewhere(map: &LaneMap<'_>, ahead_m: Option<f64>) -> bool {
    ahead_m.is_some_and(|m| {
        let middle = |c: &Vec<DVec2>| c.iter().sum::<DVec2>() / c.len().max(1) as f64;
        let far = |c: &Vec<DVec2>| map.course(middle(c)).is_none_or(|at| (at.0 - m).abs() > SAME_M);
        map.crossings.iter().all(far)
    })
}

/// True if an act puts something on a crossing or beside one.
fn stands_on_one(what: &ActKind) -> bool {
    let placed = |places: &[PlacePhrase]| places.iter().any(|p| p.to == Some(AnchorPhrase::Crossing));
    let things = |list: &[ObjectPhrase]| list.iter().any(|t| placed(&t.places));
    match what {
        ActKind::Add { things: t } | ActKind::Replace { things: t, .. } => things(t),
        ActKind::Move {
            to: Destination::To(places),
            ..
        }
        | ActKind::Turn {
            turn: Turn::To(places),
            ..
        } => placed(places),
        _ => false,
    }
}

impl Stage<'_> {
    /// Adds a remark if the map has a crossing already, or has no room for one.
    pub(super) fn add_crossing(&mut self, places: &[PlacePhrase]) {
        let there = !self.map.crossings.is_empty() && !is_elsewhere(&self.map, metres_of(places));
        if !there && self.crossing_of != Some(self.act) {
            self.remark(Remark::NoCrossing);
        }
    }

    pub(super) fn erase_crossing(&mut self) {
        let crossings = self.map.crossings.clone();
        if crossings.is_empty() {
            self.remark(Remark::Nobody {
                what: "crossing".into(),
            });
        }
        for outline_m in crossings {
            self.clear_crossing(outline_m);
        }
    }
}

/// The outline of a crossing over the layers `road`, at a distance ahead along our course, m; `None` where their width
/// does not fit, and at a junction.
fn outline(map: &LaneMap<'_>, ahead_m: f64, road: u32) -> Option<Vec<DVec2>> {
    let near = |p: DVec2| map.course(p).is_some_and(|c| (c.0 - ahead_m).abs() < 0.75);
    let (p, d) = map.ego_path.iter().copied().find(|(p, _)| near(*p))?;
    if map.junction.is_some_and(|j| j.distance(p) < JUNCTION_M) || p.abs().max_element() > 37.0 {
        return None;
    }
    let reach = |side: f64| {
        let steps = (1..=60).map(|k| f64::from(k) * 0.25);
        steps
            .take_while(|m| map.has(road, p + d.perp() * side * *m))
            .last()
            .unwrap_or(0.0)
    };
    let (left_m, right_m) = (reach(1.0), reach(-1.0));
    if !SPAN_M.contains(&(left_m + right_m)) {
        return None;
    }
    let half = d * (DEPTH_M / 2.0);
    let (l, r) = (p + d.perp() * left_m, p - d.perp() * right_m);
    Some(vec![l - half, r - half, r + half, l + half])
}

/// True if only people stand where a crossing would be.
fn is_free(outline_m: &[DVec2], boxes: &[SceneBox]) -> bool {
    let middle = outline_m.iter().sum::<DVec2>() / outline_m.len().max(1) as f64;
    let across = outline_m[0] - outline_m[1];
    let strip = SceneBox {
        id: BoxId(u32::MAX - 1),
        class: Class::Barrier,
        center_m: middle.extend(0.0),
        size_m: glam::DVec3::new(across.length(), DEPTH_M, 1.0),
        yaw_rad: across.to_angle(),
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    };
    boxes
        .iter()
        .filter(|b| b.class != Class::Pedestrian)
        .all(|b| overlap_m(&strip, b, 0.6) <= 0.0)
}
