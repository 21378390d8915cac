//! Roads and junctions as text.

use std::fmt::Write as _;

use super::connect::WrittenJunction;
use super::limits::SpeedLimitSource;
use super::profile::{CubicRecord, elevation, straight, superelevation};
use super::roads::{End, WrittenRoad};
use super::strips::Strip;
use crate::opendrive::geometry::{CurveShape, Geometry};
use crate::xml_text::{escaped, number};
use scene::{BevLayer, BevLayout, Relief};

/// Widths of lanes are kept to this, m.
const LANE_M: f64 = 0.01;
/// Widths of strips beside them are kept to this, m.
const BESIDE_M: f64 = 0.06;
/// The line between left and right lanes, m.
const CENTER_M: f64 = 0.004;
/// Distances to both sides of a border of lanes at which paint is looked for, m.
const PAINT_M: [f64; 5] = [0.0, -0.2, 0.2, -0.4, 0.4];
/// A painted line, or a gap in one, is not shorter, m.
const PAINT_RUN_M: f64 = 3.0;

/// The header; bounds are those of the map, m.
pub(super) fn header(name: &str, layout: &BevLayout) -> String {
    let (low, high) = (layout.extent().min_m(), layout.extent().max_m());
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<OpenDRIVE>\n  <header revMajor=\"1\" revMinor=\"8\" name=\"{}\" \
         version=\"1.00\" north=\"{}\" south=\"{}\" east=\"{}\" west=\"{}\" vendor=\"Sceneloom {}\"/>\n",
        escaped(name),
        number(high.y),
        number(low.y),
        number(high.x),
        number(low.x),
        env!("CARGO_PKG_VERSION"),
    )
}

/// All roads, then all junctions.
pub(super) fn network(
    roads: &[WrittenRoad],
    junctions: &[WrittenJunction],
    layout: &BevLayout,
    limits: &SpeedLimitSource<'_>,
) -> String {
    let mut out = String::new();
    for r in roads {
        road(&mut out, r, layout, limits);
    }
    for j in junctions {
        junction(&mut out, j);
    }
    out
}

fn road(out: &mut String, road: &WrittenRoad, layout: &BevLayout, limits: &SpeedLimitSource<'_>) {
    let rule = if road.left_hand { "LHT" } else { "RHT" };
    let junction = road.junction.map_or("-1".into(), |j| j.to_string());
    let length = number(road.reference.end_s_m());
    let _ = writeln!(
        out,
        "  <road name=\"\" length=\"{length}\" id=\"{}\" junction=\"{junction}\" rule=\"{rule}\">",
        road.id
    );
    link(out, road);
    limits.write(out, road);
    out.push_str("    <planView>\n");
    for record in road.reference.records() {
        geometry(out, record);
    }
    out.push_str("    </planView>\n");
    heights(out, road, &layout.relief);
    lanes(out, road, layout);
    for (name, list) in [("objects", &road.objects), ("signals", &road.signals)] {
        if !list.is_empty() {
            let _ = writeln!(out, "    <{name}>");
            list.iter().for_each(|element| out.push_str(element));
            let _ = writeln!(out, "    </{name}>");
        }
    }
    out.push_str("  </road>\n");
}

fn link(out: &mut String, road: &WrittenRoad) {
    if road.ends.iter().all(Option::is_none) {
        return;
    }
    out.push_str("    <link>\n");
    for (name, end) in ["predecessor", "successor"].iter().zip(road.ends) {
        let _ = match end {
            Some(End::Road(id, at_end)) => {
                let contact = if at_end { "end" } else { "start" };
                writeln!(
                    out,
                    "      <{name} elementType=\"road\" elementId=\"{id}\" contactPoint=\"{contact}\"/>"
                )
            }
            Some(End::Junction(id)) => {
                writeln!(out, "      <{name} elementType=\"junction\" elementId=\"{id}\"/>")
            }
            None => Ok(()),
        };
    }
    out.push_str("    </link>\n");
}

fn geometry(out: &mut String, record: &Geometry) {
    let start = record.at(0.0);
    let shape = match record.shape() {
        CurveShape::ParamPoly3 { u, v, .. } => {
            let [u, v] = [u, v].map(|k| k.map(number));
            format!(
                "<paramPoly3 aU=\"{}\" bU=\"{}\" cU=\"{}\" dU=\"{}\" aV=\"{}\" bV=\"{}\" cV=\"{}\" dV=\"{}\" \
                 pRange=\"normalized\"/>",
                u[0], u[1], u[2], u[3], v[0], v[1], v[2], v[3]
            )
        }
        // Reference lines are made of these two.
        _ => "<line/>".into(),
    };
    let _ = writeln!(
        out,
        "      <geometry s=\"{}\" x=\"{}\" y=\"{}\" hdg=\"{}\" length=\"{}\">{shape}</geometry>",
        number(record.s_m),
        number(start.position_m.x),
        number(start.position_m.y),
        number(start.heading_rad),
        number(record.length_m),
    );
}

fn records(out: &mut String, indent: &str, name: &str, start: &str, records: &[CubicRecord], origin_m: f64) {
    for record in records {
        let [a, b, c, d] = record.k.map(number);
        let _ = writeln!(
            out,
            "{indent}<{name} {start}=\"{}\" a=\"{a}\" b=\"{b}\" c=\"{c}\" d=\"{d}\"/>",
            number(record.s_m - origin_m)
        );
    }
}

fn heights(out: &mut String, road: &WrittenRoad, relief: &Relief) {
    let lists = [
        ("elevationProfile", "elevation", elevation(road, relief)),
        ("lateralProfile", "superelevation", superelevation(road, relief)),
    ];
    for (profile, name, list) in lists {
        if !list.is_empty() {
            let _ = writeln!(out, "    <{profile}>");
            records(out, "      ", name, "s", &list, 0.0);
            let _ = writeln!(out, "    </{profile}>");
        }
    }
}

fn lanes(out: &mut String, road: &WrittenRoad, layout: &BevLayout) {
    let strips = &road.strips;
    out.push_str("    <lanes>\n");
    let center = &strips.borders_m[strips.center];
    if center.iter().any(|t| *t != 0.0) {
        let list = straight(&road.s_m, center, CENTER_M);
        records(out, "      ", "laneOffset", "s", &list, 0.0);
    }
    out.push_str("      <laneSection s=\"0\">\n");
    let sides = [
        ("left", 0..strips.center),
        ("right", strips.center..strips.kinds.len()),
    ];
    for (name, range) in sides {
        if name == "right" {
            out.push_str("        <center>\n          <lane id=\"0\" type=\"none\" level=\"false\">\n");
            marks(out, road, strips.center, layout);
            out.push_str("          </lane>\n        </center>\n");
        }
        if range.is_empty() {
            continue;
        }
        let _ = writeln!(out, "        <{name}>");
        for strip in range {
            lane(out, road, strip, layout);
        }
        let _ = writeln!(out, "        </{name}>");
    }
    out.push_str("      </laneSection>\n    </lanes>\n");
}

fn lane(out: &mut String, road: &WrittenRoad, strip: usize, layout: &BevLayout) {
    let kind = road.strips.kinds[strip];
    let name = match kind {
        Strip::Lane { .. } => "driving",
        Strip::Between => "restricted",
        // Car parks are written as areas upon it: a simulator drives along a lane of parking, however short a part of it is one.
        Strip::Shoulder | Strip::Parking => "shoulder",
        Strip::Verge => "none",
        Strip::Walkway => "sidewalk",
    };
    let is_lane = matches!(kind, Strip::Lane { .. });
    let direction = match is_lane {
        true if road.two_way => " direction=\"both\"",
        true if road.is_reversed(strip) => " direction=\"reversed\"",
        _ => "",
    };
    let id = road.lane_id(strip);
    let _ = writeln!(
        out,
        "          <lane id=\"{id}\" type=\"{name}\" level=\"false\"{direction}>"
    );
    let links = road.links[strip];
    if links.iter().any(Option::is_some) {
        out.push_str("            <link>\n");
        for (name, id) in ["predecessor", "successor"].iter().zip(links) {
            if let Some(id) = id {
                let _ = writeln!(out, "              <{name} id=\"{id}\"/>");
            }
        }
        out.push_str("            </link>\n");
    }
    let borders = &road.strips.borders_m;
    let width: Vec<f64> = borders[strip]
        .iter()
        .zip(&borders[strip + 1])
        .map(|(l, r)| (l - r).max(0.0))
        .collect();
    let near = if is_lane { LANE_M } else { BESIDE_M };
    let list = straight(&road.s_m, &width, near);
    records(out, "            ", "width", "sOffset", &list, 0.0);
    let outer = if strip < road.strips.center {
        strip
    } else {
        strip + 1
    };
    marks(out, road, outer, layout);
    out.push_str("          </lane>\n");
}

/// The paint on a border of strips.
fn marks(out: &mut String, road: &WrittenRoad, border: usize, layout: &BevLayout) {
    let kinds = &road.strips.kinds;
    let is_lane = |strip: Option<usize>| {
        let kind = strip.and_then(|s| kinds.get(s));
        matches!(kind, Some(Strip::Lane { .. } | Strip::Between))
    };
    let mut list: Vec<(f64, &str)> = vec![(0.0, "none")];
    if is_lane(border.checked_sub(1)) && is_lane(Some(border)) && road.junction.is_none() {
        list = paint(road, border, layout);
    }
    for (s_m, style) in list {
        let width = if style == "none" { "0" } else { "0.12" };
        let _ = writeln!(
            out,
            "            <roadMark sOffset=\"{}\" type=\"{style}\" weight=\"standard\" color=\"standard\" width=\"{width}\"/>",
            number(s_m)
        );
    }
}

/// Style of the paint along a border and where each begins.
fn paint(road: &WrittenRoad, border: usize, layout: &BevLayout) -> Vec<(f64, &'static str)> {
    let extent = layout.extent();
    let look = |i: usize| -> &'static str {
        let base = road.reference.at(road.s_m[i]);
        let t = road.strips.borders_m[border][i];
        let has = |layer: BevLayer| {
            PAINT_M.iter().any(|aside| {
                let p = base.offset(t + aside);
                let column = extent.column_at(p.x, p.y);
                column.is_some_and(|[x, y]| layout.has(layer, x, y))
            })
        };
        if has(BevLayer::RoadDivider) {
            "solid"
        } else if has(BevLayer::LaneDivider) {
            "broken"
        } else {
            "none"
        }
    };
    let mut runs: Vec<(f64, &'static str)> = Vec::new();
    for i in 0..road.s_m.len() {
        let style = look(i);
        if runs.last().is_none_or(|(_, last)| *last != style) {
            runs.push((road.s_m[i], style));
        }
    }
    // A run that is too short is as the one before, or at the start as the one behind.
    let end = road.reference.end_s_m();
    let mut out: Vec<(f64, &'static str)> = Vec::new();
    for (i, (s_m, style)) in runs.iter().enumerate() {
        let until = runs.get(i + 1).map_or(end, |next| next.0);
        let short = until - s_m < PAINT_RUN_M;
        match out.last() {
            Some((_, last)) if short || last == style => {}
            None if short && runs.len() > 1 => {}
            None => out.push((0.0, style)),
            Some(_) => out.push((*s_m, style)),
        }
    }
    if out.is_empty() {
        out.push((0.0, runs.first().map_or("none", |(_, style)| style)));
    }
    out
}

fn junction(out: &mut String, junction: &WrittenJunction) {
    let _ = writeln!(
        out,
        "  <junction name=\"\" id=\"{}\" type=\"default\">",
        junction.id
    );
    for (i, c) in junction.connections.iter().enumerate() {
        let _ = writeln!(
            out,
            "    <connection id=\"{i}\" incomingRoad=\"{}\" connectingRoad=\"{}\" contactPoint=\"start\">\n      \
             <laneLink from=\"{}\" to=\"{}\"/>\n    </connection>",
            c.incoming, c.connecting, c.from, c.to
        );
    }
    out.push_str("  </junction>\n");
}
