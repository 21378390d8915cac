//! Crossings, stop lines and areas: each is written with the road that is nearest.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

use glam::DVec2;

use super::areas::outlines;
use super::fit::reference;
use super::roads::WrittenRoad;
use super::strips::{Strip, Strips};
use crate::xml_text::number;
use scene::background::PostKind;
use scene::{Background, BevLayer, BevLayout, Form, PolylineKind};

/// Largest distance of a stop line from a lane, m.
const STOP_M: f64 = 3.0;
/// Largest distance of a stop line from the middle of its road, m.
const STOP_ROAD_M: f64 = 40.0;
/// Largest distance of a sign or light from the middle of a road, m.
const SIGNAL_ROAD_M: f64 = 40.0;
/// Height of the part at the top of a post, m: the plate of a sign, the housing of lights.
const SIGN_M: f64 = 0.6;
const LIGHT_M: f64 = 1.0;
/// Stations that are looked at first.
const EVERY: usize = 8;
/// Distance that is added to that of a road in a junction, m.
const IN_JUNCTION_M: f64 = 10.0;

/// Roads that get objects.
pub(super) struct OnRoads<'a> {
    roads: &'a mut [WrittenRoad],
    stations: Vec<(usize, usize, DVec2)>, // every few metres: road, station, place
}

/// A place on a road.
struct RoadPosition {
    road: usize,
    s_m: f64,
    t_m: f64,
    away_m: f64,
}

impl<'a> OnRoads<'a> {
    pub fn new(roads: &'a mut [WrittenRoad]) -> Self {
        let of_road = |(r, road): (usize, &WrittenRoad)| {
            let n = road.s_m.len();
            let some = (0..n).step_by(EVERY).chain([n - 1]);
            let placed = some.map(|i| (r, i, road.reference.at(road.s_m[i]).position_m));
            placed.collect::<Vec<_>>()
        };
        Self {
            stations: roads.iter().enumerate().flat_map(of_road).collect(),
            roads,
        }
    }

    /// The nearest place on any road; roads outside of junctions come before roads in them if both are near.
    fn nearest(&self, p: DVec2) -> Option<RoadPosition> {
        let cost = |(r, _, at): &(usize, usize, DVec2)| {
            let more_m = self.roads[*r].junction.map_or(0.0, |_| IN_JUNCTION_M);
            at.distance(p) + more_m
        };
        let rough = self.stations.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
        let (r, i, _) = *rough;
        let road = &self.roads[r];
        let far = |i: &usize| road.reference.at(road.s_m[*i]).position_m.distance_squared(p);
        let around = i.saturating_sub(EVERY)..(i + EVERY).min(road.s_m.len());
        let i = around.min_by(|a, b| far(a).total_cmp(&far(b)))?;
        let base = road.reference.at(road.s_m[i]);
        let (ahead, way) = (DVec2::from_angle(base.heading_rad), p - base.position_m);
        let s_m = (road.s_m[i] + way.dot(ahead)).clamp(0.0, road.reference.end_s_m());
        let base = road.reference.at(s_m);
        Some(RoadPosition {
            road: r,
            s_m,
            t_m: DVec2::from_angle(base.heading_rad).perp_dot(p - base.position_m),
            away_m: base.position_m.distance(p),
        })
    }

    /// An object with an outline, at its middle. `kind` are its attributes, `lane` those of its outline, `inner` what it holds
    /// besides.
    fn add(&mut self, id: &str, points: &[DVec2], [kind, lane, inner]: [&str; 3]) {
        let middle = points.iter().sum::<DVec2>() / points.len() as f64;
        let Some(place) = self.nearest(middle) else {
            return;
        };
        let road = &mut self.roads[place.road];
        let base = road.reference.at(place.s_m);
        let origin = base.offset(place.t_m);
        let back = DVec2::from_angle(-base.heading_rad);
        let local: Vec<DVec2> = points.iter().map(|p| back.rotate(*p - origin)).collect();
        let low = local.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = local.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let size = (high - low).max(DVec2::splat(0.01));
        // One outline without a list around it, as in OpenDRIVE 1.4: 1.8 allows it, and more readers know it.
        let mut text = format!(
            "      <object id=\"{id}\" {kind} s=\"{}\" t=\"{}\" zOffset=\"0\" hdg=\"0\" orientation=\"none\" length=\"{}\" \
             width=\"{}\" height=\"0\">\n        <outline id=\"0\" closed=\"true\" outer=\"true\"{lane}>\n",
            number(place.s_m),
            number(place.t_m),
            number(size.x),
            number(size.y),
        );
        for (i, p) in local.iter().enumerate() {
            let _ = writeln!(
                text,
                "          <cornerLocal id=\"{i}\" u=\"{}\" v=\"{}\" z=\"0\" height=\"0\"/>",
                number(p.x),
                number(p.y)
            );
        }
        let _ = writeln!(text, "        </outline>{inner}\n      </object>");
        road.objects.push(text);
    }

    /// Crossings: those that have outlines, and painted cells that are in none of these.
    pub fn crossings(&mut self, layout: &BevLayout) {
        let extent = layout.extent();
        let bit = BevLayer::PedCrossing.bit();
        let mut open: Vec<bool> = layout.cells().iter().map(|c| c & bit != 0).collect();
        let mut all: Vec<Vec<DVec2>> = Vec::new();
        let lines = layout.polylines.iter();
        for line in lines.filter(|l| l.kind == PolylineKind::PedCrossing) {
            if line.points_m.len() >= 3 && line.points_m.iter().all(|p| p.is_finite()) {
                let points = &line.points_m;
                scene::raster::polygon_cells(extent, points, |x, y| open[extent.index(x, y)] = false);
                all.push(points.clone());
            }
        }
        all.extend(outlines(extent, |c| open[c]));
        for (i, points) in all.iter().enumerate() {
            let kind = "type=\"crosswalk\" name=\"crosswalk\"";
            self.add(&format!("crossing{i}"), points, [kind, "", ""]);
        }
    }

    /// Stop lines, as signals for the lanes that they lie across.
    pub fn stop_lines(&mut self, layout: &BevLayout) {
        let lines = layout.polylines.iter();
        for (i, line) in lines.filter(|l| l.kind == PolylineKind::StopLine).enumerate() {
            let ends = line.points_m.first().zip(line.points_m.last());
            let middle = ends.map(|(a, b)| a.midpoint(*b)).filter(|m| m.is_finite());
            let place = middle.and_then(|m| self.nearest(m));
            let Some(place) = place.filter(|p| p.away_m < STOP_ROAD_M) else {
                continue;
            };
            let road = &mut self.roads[place.road];
            let at = road.s_m.partition_point(|s| *s < place.s_m);
            let at = at.min(road.s_m.len() - 1);
            let strips = &road.strips;
            let away_m = |strip: usize| {
                let [l, r] = [strip, strip + 1].map(|b| strips.borders_m[b][at]);
                (place.t_m - l).max(r - place.t_m)
            };
            let lanes = strips
                .kinds
                .iter()
                .enumerate()
                .filter_map(|(strip, kind)| match kind {
                    Strip::Lane { along, .. } => Some((away_m(strip), *along)),
                    _ => None,
                });
            let Some((away_m, along)) = lanes.min_by(|a, b| a.0.total_cmp(&b.0)) else {
                continue;
            };
            if away_m > STOP_M {
                continue;
            }
            let orientation = if along { "+" } else { "-" };
            road.signals.push(format!(
                "      <signal id=\"stop{i}\" name=\"stop line\" s=\"{}\" t=\"{}\" zOffset=\"0\" dynamic=\"no\" \
                 orientation=\"{orientation}\" country=\"DE\" type=\"294\" subtype=\"-1\"/>\n",
                number(place.s_m),
                number(place.t_m),
            ));
        }
    }

    /// Signs and traffic lights, each with the road that is nearest.
    pub fn signals(&mut self, background: &Background) {
        for thing in background.iter() {
            let Form::Post(post) = &thing.form else {
                continue;
            };
            let (name, dynamic, kind, own_m) = match post.kind {
                PostKind::TrafficLight => ("traffic light", "yes", "1000001", LIGHT_M),
                PostKind::Sign => ("sign", "no", "-1", SIGN_M),
                _ => continue,
            };
            let Some(place) = self.nearest(post.position_m).filter(|p| p.away_m < SIGNAL_ROAD_M) else {
                continue;
            };
            let road = &mut self.roads[place.road];
            // A signal for who drives along the road looks back at them.
            let turn_rad = (post.yaw_rad - road.reference.at(place.s_m).heading_rad).rem_euclid(TAU);
            let against = (FRAC_PI_2..3.0 * FRAC_PI_2).contains(&turn_rad);
            let (orientation, offset_rad) = match against {
                true => ("+", turn_rad - PI),
                false => ("-", (turn_rad + PI).rem_euclid(TAU) - PI),
            };
            let own_m = own_m.min(post.height_m);
            road.signals.push(format!(
                "      <signal id=\"thing{}\" name=\"{name}\" s=\"{}\" t=\"{}\" zOffset=\"{}\" hOffset=\"{}\" dynamic=\"{dynamic}\" \
                 orientation=\"{orientation}\" country=\"OpenDRIVE\" type=\"{kind}\" subtype=\"-1\" height=\"{}\" width=\"{own_m}\"/>\n",
                thing.id.0,
                number(place.s_m),
                number(place.t_m),
                number(post.height_m - own_m),
                number(offset_rad),
                number(own_m),
            ));
        }
    }

    /// Ground that a reader of the roads does not find, with the kind of lane that it would be.
    pub fn areas(&mut self, layout: &BevLayout, found: &BevLayout) {
        let carpark = BevLayer::CarparkArea.bit();
        for (layer, lane, kind, inner) in [
            (BevLayer::DrivableArea, "driving", "roadSurface", ""),
            (
                BevLayer::CarparkArea,
                "parking",
                "parkingSpace",
                "\n        <parkingSpace access=\"all\"/>",
            ),
            (BevLayer::Walkway, "sidewalk", "roadSurface", ""),
        ] {
            let bit = layer.bit();
            let missing = |c: usize| {
                let (cell, there) = (layout.cells()[c], found.cells()[c]);
                // The drivable area of a car park is added with the car park.
                let other = bit != carpark && cell & carpark != 0;
                cell & bit != 0 && there & bit == 0 && !other
            };
            let attributes = format!("type=\"{kind}\" name=\"{}\"", layer.name());
            let of_outline = format!(" laneType=\"{lane}\"");
            for (i, points) in outlines(layout.extent(), missing).iter().enumerate() {
                self.add(&format!("{lane}{i}"), points, [&attributes, &of_outline, inner]);
            }
        }
    }
}

/// A road without any lane: a file needs at least one road.
pub(super) fn nowhere(layout: &BevLayout) -> WrittenRoad {
    let from = layout.extent().min_m().truncate();
    let line = reference(&[from, from + DVec2::X], [None, None]).expect("two points a metre apart");
    WrittenRoad {
        id: 1,
        junction: None,
        s_m: vec![0.0, line.end_s_m()],
        reference: line,
        strips: Strips {
            kinds: vec![Strip::Verge],
            borders_m: vec![vec![0.0; 2], vec![-0.1; 2]],
            center: 0,
        },
        ends: [None; 2],
        links: vec![[None; 2]],
        two_way: false,
        left_hand: false,
        bundle: None,
        objects: Vec::new(),
        signals: Vec::new(),
    }
}
