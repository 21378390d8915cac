//! Crossings, stop lines and areas: each is written with the road that is nearest.

use std::fmt::Write as _;

use glam::DVec2;

use super::areas::outlines;
use super::fit::reference;
use super::roads::Road;
use super::strips::{Strip, Strips};
use crate::xml_text::number;
use scene::{BevLayer, BevLayout, PolylineKind};

/// A stop line farther from a lane holds for nobody, m.
const STOP_M: f64 = 3.0;
/// Stations that are looked at first.
const EVERY: usize = 8;

/// A place on a road.
struct Place {
    road: usize,
    s_m: f64,
    t_m: f64,
    away_m: f64,
}

/// The nearest place on any road; roads outside of junctions go before those in them if both are near.
fn nearest(roads: &[Road], p: DVec2) -> Option<Place> {
    let mut best: Option<(f64, Place)> = None;
    for (r, road) in roads.iter().enumerate() {
        let far = |i: &usize| road.reference.at(road.s_m[*i]).position_m.distance_squared(p);
        let n = road.s_m.len();
        let rough = (0..n)
            .step_by(EVERY)
            .chain([n - 1])
            .min_by(|a, b| far(a).total_cmp(&far(b)));
        let around = |i: usize| i.saturating_sub(EVERY)..(i + EVERY).min(n);
        let Some(i) = rough.and_then(|i| around(i).min_by(|a, b| far(a).total_cmp(&far(b)))) else {
            continue;
        };
        let base = road.reference.at(road.s_m[i]);
        let (ahead, way) = (DVec2::from_angle(base.heading_rad), p - base.position_m);
        let s_m = (road.s_m[i] + way.dot(ahead)).clamp(0.0, road.reference.end_s_m());
        let base = road.reference.at(s_m);
        let away_m = base.position_m.distance(p);
        let cost = away_m + if road.junction.is_some() { 10.0 } else { 0.0 };
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            let t_m = DVec2::from_angle(base.heading_rad).perp_dot(p - base.position_m);
            let place = Place {
                road: r,
                s_m,
                t_m,
                away_m,
            };
            best = Some((cost, place));
        }
    }
    best.map(|(_, place)| place)
}

/// An object with an outline, at its middle. `kind` are its attributes and `outline` those of the outline.
fn add_outline(roads: &mut [Road], id: &str, kind: &str, outline: &str, points: &[DVec2], inner: &str) {
    let middle = points.iter().sum::<DVec2>() / points.len() as f64;
    let Some(place) = nearest(roads, middle) else {
        return;
    };
    let road = &mut roads[place.road];
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
         width=\"{}\" height=\"0\">\n        <outline id=\"0\" closed=\"true\" outer=\"true\"{outline}>\n",
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

/// Crossings: those that have outlines, and painted cells in none of them.
pub(super) fn crossings(roads: &mut [Road], layout: &BevLayout) {
    let extent = layout.extent();
    let bit = BevLayer::PedCrossing.bit();
    let mut open: Vec<bool> = layout.cells().iter().map(|c| c & bit != 0).collect();
    let mut all: Vec<Vec<DVec2>> = Vec::new();
    for line in layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::PedCrossing)
    {
        if line.points_m.len() >= 3 && line.points_m.iter().all(|p| p.is_finite()) {
            scene::raster::polygon_cells(extent, &line.points_m, |x, y| open[extent.index(x, y)] = false);
            all.push(line.points_m.clone());
        }
    }
    all.extend(outlines(extent, |c| open[c]));
    for (i, points) in all.iter().enumerate() {
        add_outline(
            roads,
            &format!("crossing{i}"),
            "type=\"crosswalk\" name=\"crosswalk\"",
            "",
            points,
            "",
        );
    }
}

/// Stop lines, as signals for the lanes that they lie across.
pub(super) fn stop_lines(roads: &mut [Road], layout: &BevLayout) {
    let lines = layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::StopLine);
    for (i, line) in lines.enumerate() {
        let (Some(a), Some(b)) = (line.points_m.first(), line.points_m.last()) else {
            continue;
        };
        let middle = a.midpoint(*b);
        if !middle.is_finite() || roads.is_empty() {
            continue;
        }
        let Some(place) = nearest(roads, middle).filter(|p| p.away_m < 40.0) else {
            continue;
        };
        let road = &mut roads[place.road];
        let at = road
            .s_m
            .partition_point(|s| *s < place.s_m)
            .min(road.s_m.len() - 1);
        let strips = &road.strips;
        let away_m = |strip: &usize| {
            let [l, r] = [strip, &(strip + 1)].map(|b| strips.borders_m[*b][at]);
            (place.t_m - l).max(r - place.t_m)
        };
        let lanes = (0..strips.kinds.len()).filter(|s| matches!(strips.kinds[*s], Strip::Lane { .. }));
        let Some(lane) = lanes.min_by(|a, b| away_m(a).total_cmp(&away_m(b))) else {
            continue;
        };
        let Strip::Lane { along, .. } = strips.kinds[lane] else {
            continue;
        };
        if away_m(&lane) > STOP_M {
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

/// Ground that a reader of the roads does not find, with the kind of lane that it would be.
pub(super) fn areas(roads: &mut [Road], layout: &BevLayout, found: &BevLayout) {
    let kinds = [
        (BevLayer::DrivableArea, "driving", "roadSurface"),
        (BevLayer::CarparkArea, "parking", "parkingSpace"),
        (BevLayer::Walkway, "sidewalk", "roadSurface"),
    ];
    let carpark = BevLayer::CarparkArea.bit();
    for (layer, lane, kind) in kinds {
        let bit = layer.bit();
        let missing = |c: usize| {
            let (cell, there) = (layout.cells()[c], found.cells()[c]);
            // What is a car park comes with that.
            let other = bit != carpark && cell & carpark != 0;
            cell & bit != 0 && there & bit == 0 && !other
        };
        for (i, points) in outlines(layout.extent(), missing).iter().enumerate() {
            let attributes = format!("type=\"{kind}\" name=\"{}\"", layer.name());
            let outline = format!(" laneType=\"{lane}\"");
            let inner = match bit == carpark {
                true => "\n        <parkingSpace access=\"all\"/>",
                false => "",
            };
            add_outline(roads, &format!("{lane}{i}"), &attributes, &outline, points, inner);
        }
    }
}

/// A road without any lane: a file without roads is none.
pub(super) fn nowhere(layout: &BevLayout) -> Road {
    let from = layout.extent().min_m().truncate();
    let line = reference(&[from, from + DVec2::X], [None, None]).expect("two points a metre apart");
    Road {
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
